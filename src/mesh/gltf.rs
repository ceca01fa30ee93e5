//! Reads glTF 2.0, as text with its buffers (.gltf) or in one binary file (.glb).
//!
//! Taken over: the default scene's nodes with their transforms, triangles in lists, strips and fans, indexed or
//! plain; of materials the base colour (factor and texture, the mean over each triangle) and the emission; and
//! the lamps of `KHR_lights_punctual`. Skins, morphs, animations, metal and gloss are not: surfaces here stand
//! still and are diffuse. Everything that will be stored is counted, and every range checked, before it is read.

mod accessor;
mod container;
mod uri;

use std::borrow::Cow;

use glam::{DMat4, DVec3, Vec2};
use gltf::khr_lights_punctual::Kind;
use gltf::mesh::Mode;
use gltf::{Document, Node, Primitive, Semantic};

use super::job::{Job, LONGEST, Parts, shortened};
use super::lamp::{Lamp, LampKind};
use super::texture::{self, TextureId};
use super::{MOST_TRIANGLES, MOST_VERTICES, Material, is_usable};
use crate::system::file::FileError;

/// The most nodes that may stand within each other.
const DEEPEST: usize = 256;

/// Reads a glTF file's bytes, in either form.
pub(super) fn read(bytes: &[u8], job: &mut Job) -> Result<Parts, FileError> {
    let (document, binary) = container::open(bytes, job)?;
    job.progress(0.1);
    let scene = document.default_scene().or(document.scenes().next());
    let placed = match &scene {
        Some(scene) => placed(scene.nodes(), &document, job)?,
        None => return Err(job.fault("it has no scene", "give a file with a scene that has nodes")),
    };
    let buffers = buffers(&document, binary, job)?;
    job.progress(0.3);
    let textures = textures(&document, &buffers, job)?;
    let mut parts = Parts { materials: materials(&document, &textures), ..Parts::default() };
    check_counts(&placed, job)?;
    for (i, (node, matrix)) in placed.iter().enumerate() {
        let place = |primitive: usize| format!("nodes[{}], primitive {primitive}", node.index());
        for primitive in node.mesh().iter().flat_map(|mesh| mesh.primitives()) {
            let reader = Reader { buffers: &buffers, textures: &textures, matrix: *matrix };
            reader
                .add(&primitive, &mut parts, job)
                .map_err(|(what, remedy)| job.fault(format!("{}: {what}", place(primitive.index())), remedy))?;
        }
        parts.lamps.extend(node.light().and_then(|light| lamp(&light, matrix)));
        job.progress(0.3 + 0.7 * (i + 1) as f64 / placed.len() as f64);
    }
    Ok(parts)
}

/// The nodes of a scene, each with the transform from its coordinates to the scene's.
fn placed<'a>(
    roots: impl Iterator<Item = Node<'a>>,
    document: &'a Document,
    job: &Job,
) -> Result<Vec<(Node<'a>, DMat4)>, FileError> {
    let mut met = vec![false; document.nodes().len()];
    let mut placed = Vec::new();
    let mut ahead: Vec<(Node, DMat4, usize)> = roots.map(|node| (node, DMat4::IDENTITY, 0)).collect();
    ahead.reverse();
    while let Some((node, above, depth)) = ahead.pop() {
        if std::mem::replace(&mut met[node.index()], true) || depth > DEEPEST {
            let what = format!("nodes[{}] stands in more than one place, in itself, or too deep", node.index());
            return Err(job.fault(what, format!("nodes form a tree, at most {DEEPEST} deep")));
        }
        let own = node.transform().matrix().map(|column| column.map(f64::from));
        let matrix = above * DMat4::from_cols_array_2d(&own);
        if !matrix.is_finite() {
            let what = format!("the transform of nodes[{}] is not finite", node.index());
            return Err(job.fault(what, "write finite numbers"));
        }
        let children: Vec<Node> = node.children().collect();
        ahead.extend(children.into_iter().rev().map(|child| (child, matrix, depth + 1)));
        placed.push((node, matrix));
    }
    Ok(placed)
}

/// Refuses a scene of too many triangles before any is read.
fn check_counts(placed: &[(Node, DMat4)], job: &Job) -> Result<(), FileError> {
    let (mut triangles, mut vertices) = (0usize, 0usize);
    for (node, _) in placed {
        for primitive in node.mesh().iter().flat_map(|mesh| mesh.primitives()) {
            let positions = primitive.get(&Semantic::Positions).map_or(0, |positions| positions.count());
            let corners = primitive.indices().map_or(positions, |indices| indices.count());
            let more = if primitive.mode() == Mode::Triangles { corners / 3 } else { corners };
            triangles = triangles.saturating_add(more);
            vertices = vertices.saturating_add(positions);
        }
        if triangles > MOST_TRIANGLES || vertices > MOST_VERTICES {
            let what = format!("with nodes[{}] it comes to more than {MOST_TRIANGLES} triangles", node.index());
            return Err(job.fault(what, "take a coarser mesh"));
        }
    }
    Ok(())
}

/// The bytes of every buffer.
fn buffers<'a>(document: &Document, binary: Option<&'a [u8]>, job: &Job) -> Result<Vec<Cow<'a, [u8]>>, FileError> {
    let mut left = LONGEST;
    let mut all = Vec::new();
    for buffer in document.buffers() {
        let bytes = match buffer.source() {
            gltf::buffer::Source::Bin => Cow::Borrowed(binary.ok_or_else(|| {
                let what = format!("buffers[{}] stands in a binary part that is not there", buffer.index());
                job.fault(what, "give it a uri, or write the file as .glb")
            })?),
            gltf::buffer::Source::Uri(uri) => Cow::Owned(uri::bytes(uri, left, job)?),
        };
        if bytes.len() < buffer.length() {
            let what = format!(
                "buffers[{}] holds {} bytes where {} are promised: it is cut off",
                buffer.index(),
                bytes.len(),
                buffer.length()
            );
            return Err(job.fault(what, "export the mesh again"));
        }
        if let Cow::Owned(bytes) = &bytes {
            left = left.saturating_sub(bytes.len() as u64);
        }
        all.push(bytes);
    }
    Ok(all)
}

/// By material its base colour's texture.
fn textures(document: &Document, buffers: &[Cow<[u8]>], job: &mut Job) -> Result<Vec<Paint>, FileError> {
    let mut by_image: Vec<Option<Option<TextureId>>> = vec![None; document.images().len()];
    let mut paints = Vec::new();
    for material in document.materials() {
        let Some(info) = material.pbr_metallic_roughness().base_color_texture() else {
            paints.push(Paint::default());
            continue;
        };
        let image = info.texture().source();
        let texture = match by_image[image.index()] {
            Some(known) => known,
            None => {
                let texture = match image.source() {
                    gltf::image::Source::View { view, .. } => {
                        let bytes = accessor::view_bytes(&view, buffers).ok_or_else(|| {
                            let what = format!("images[{}] lies outside its buffer", image.index());
                            job.fault(what, "export the mesh again")
                        })?;
                        let path = job.path;
                        Some(job.textures.add(bytes, path)?)
                    }
                    gltf::image::Source::Uri { uri, .. } if uri::is_data(uri) => {
                        let bytes = uri::bytes(uri, texture::LONGEST, job)?;
                        let path = job.path;
                        Some(job.textures.add(&bytes, path)?)
                    }
                    gltf::image::Source::Uri { uri, .. } => job.texture_in_file(&uri::decoded(uri))?,
                };
                by_image[image.index()] = Some(texture);
                texture
            }
        };
        paints.push(Paint { texture, set: info.tex_coord(), lost: texture.is_none() });
    }
    Ok(paints)
}

/// What a material's colour comes from besides its factor.
#[derive(Clone, Copy, Default)]
struct Paint {
    texture: Option<TextureId>,
    /// The set of texture coordinates.
    set: u32,
    /// Its texture is not there.
    lost: bool,
}

/// The materials, and a grey one behind them for what has none.
fn materials(document: &Document, paints: &[Paint]) -> Vec<Material> {
    let share = |part: f32| if part >= 0.0 { f64::from(part.min(1.0)) } else { 0.0 };
    let made = document.materials().zip(paints).map(|(material, paint)| {
        let [red, green, blue, _] = material.pbr_metallic_roughness().base_color_factor();
        let name = material.name().unwrap_or("").to_owned();
        let grey = Material::grey(name);
        let albedo = if paint.lost { grey.albedo } else { [red, green, blue].map(share) };
        Material { albedo, emission: material.emissive_factor().map(share), ..grey }
    });
    made.chain([Material::grey("")]).collect()
}

/// The lamp that a node carries; `None` where it gives no light.
fn lamp(light: &gltf::khr_lights_punctual::Light, matrix: &DMat4) -> Option<Lamp> {
    let power = light.color().map(|c| f64::from(c) * f64::from(light.intensity()));
    let direction = matrix.transform_vector3(DVec3::NEG_Z).try_normalize().unwrap_or(DVec3::NEG_Z);
    let kind = match light.kind() {
        Kind::Directional => LampKind::Sun,
        Kind::Point => LampKind::Point,
        Kind::Spot { inner_cone_angle, outer_cone_angle } => {
            LampKind::Spot { inner: inner_cone_angle.into(), outer: outer_cone_angle.into() }
        }
    };
    let name = shortened(light.name().unwrap_or(""));
    let position = matrix.transform_point3(DVec3::ZERO).to_array();
    let lit = power.iter().all(|p| p.is_finite() && *p >= 0.0) && power.iter().any(|p| *p > 0.0);
    lit.then_some(Lamp { name, kind, position, direction: direction.to_array(), power })
}

/// Reads the primitives of one node.
struct Reader<'a> {
    buffers: &'a [Cow<'a, [u8]>],
    textures: &'a [Paint],
    matrix: DMat4,
}

impl Reader<'_> {
    /// Adds a primitive's triangles.
    fn add(&self, primitive: &Primitive, parts: &mut Parts, job: &mut Job) -> Result<(), (String, &'static str)> {
        let mode = primitive.mode();
        if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
            job.note("points and lines were left out");
            return Ok(());
        }
        let Some(positions) = primitive.get(&Semantic::Positions) else {
            return Err(("it has no positions".into(), "give every primitive a POSITION"));
        };
        let first = parts.vertices.len();
        let positions = accessor::vectors::<3>(&positions, self.buffers)?;
        for (i, p) in positions.iter().enumerate() {
            let vertex = self.matrix.transform_point3(DVec3::from_array(p.map(f64::from))).as_vec3();
            if !is_usable(vertex) {
                let [x, y, z] = p;
                let what = format!("vertex {i}, ({x}, {y}, {z}), cannot stand in a scene");
                return Err((what, "write finite numbers up to 1e9"));
            }
            parts.vertices.push(vertex);
        }
        let count = positions.len();
        let corners: Vec<u32> = match primitive.indices() {
            Some(indices) => accessor::indices(&indices, self.buffers, count)?,
            None => (0..count as u32).collect(),
        };
        let material = primitive.material().index();
        let paint = material.and_then(|m| self.textures.get(m)).copied().unwrap_or_default();
        let material = material.unwrap_or(parts.materials.len() - 1);
        let albedo = parts.materials[material].albedo;
        let places: Vec<[f32; 2]> = match (paint.texture, primitive.get(&Semantic::TexCoords(paint.set))) {
            (Some(_), Some(places)) => accessor::vectors::<2>(&places, self.buffers)?,
            _ => Vec::new(),
        };
        // The origin of glTF's textures is the upper left corner.
        let place = |corner: u32| places.get(corner as usize).map(|[u, v]| Vec2::new(*u, 1.0 - v));
        for triangle in (0..accessor::triangle_count(mode, corners.len())).map(|i| accessor::triangle(mode, i)) {
            let corners = triangle.map(|c| corners[c]);
            parts.triangles.push(corners.map(|c| first as u32 + c));
            parts.made_of.push(material as u32);
            parts.tints.push(job.textures.tint(paint.texture, corners.map(place), albedo));
        }
        Ok(())
    }
}
