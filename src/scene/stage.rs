//! A mesh in its volume with its lights: what a document's scene resolves to.
//!
//! Making one reads the mesh, casts the shadow maps and clips triangles to cells. [`Cache`] keeps each of these as long
//! as what it was made from is the same: a light that moves makes its own map again and nothing else, a mesh that has
//! not changed is neither read nor clipped again, and scenes of one mesh share it.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::SystemTime;

use glam::DVec3;

use super::MOST_CELLS;
use super::emitter::{self, Emitter, Injected};
use super::error::{Fault, SceneError};
use super::file;
use super::mesh_scene::{Camera, Light, LightKind, MeshScene};
use super::placement::Placement;
use super::shadow_map::ShadowMap;
use super::voxels::Voxels;
use crate::mesh::read::{self, Files, Lamp, LampKind, Unread};
use crate::mesh::{Bvh, Mesh};
use crate::system::file::{self as files, FileError};

/// The most texels that the shadow maps of a scene may have together.
pub const MOST_TEXELS: usize = 1 << 23;

/// A mesh as it was read, ready for rays.
#[derive(Debug)]
pub struct Model {
    /// Tells it apart from every other one.
    number: u64,
    /// The mesh.
    pub mesh: Mesh,
    /// Rays through it.
    pub bvh: Bvh,
    /// The lamps that its file brings along.
    pub lamps: Vec<Lamp>,
    /// What could be helped in its files, a line each.
    pub notes: Vec<String>,
}

/// A mesh in its volume with its lights.
#[derive(Clone, Debug)]
pub struct Stage {
    /// The mesh.
    pub model: Arc<Model>,
    /// Where the volume lies.
    pub placement: Placement,
    /// The lights that shine, those of the mesh's file behind the document's.
    pub lights: Vec<Light>,
    /// By light, its shadow map.
    pub maps: Vec<Arc<ShadowMap>>,
    /// What surfaces that glow by themselves send.
    pub glowing: Vec<Emitter>,
    /// What lies in the volume.
    pub injected: Arc<Injected>,
    /// The cells that the mesh's surface passes through.
    pub voxels: Arc<Voxels>,
    /// The same for cells half a side further along every axis: what stands between the cells of fuzzy occlusion.
    pub between: Arc<Voxels>,
    /// Who looks at it.
    pub camera: Camera,
}

impl PartialEq for Stage {
    fn eq(&self, other: &Self) -> bool {
        let mesh = Arc::ptr_eq(&self.model, &other.model) || self.model.mesh == other.model.mesh;
        mesh && (self.placement, &self.lights, self.camera) == (other.placement, &other.lights, other.camera)
            && self.injected == other.injected
    }
}

impl Stage {
    /// Makes a scene for a volume of side `size`; files are looked for in `folder`, the preset's own. `progress` is
    /// told how much of the mesh is read, 0 to 1.
    ///
    /// # Errors
    /// A mesh that cannot be read, and a scene that is too large.
    pub fn new(
        scene: &MeshScene,
        size: usize,
        folder: &Path,
        cache: &Cache,
        progress: &mut dyn FnMut(f64),
    ) -> Result<Stage, SceneError> {
        let model = cache.model(&scene.mesh, folder, progress)?;
        let mesh = &model.mesh;
        let placement = Placement::new(scene.volume, mesh.bounds(), size);
        let of_file = model.lamps.iter().filter(|_| scene.lamps_of_file).map(light_of);
        let lights: Vec<Light> = scene.lights.iter().filter(|light| light.enabled).cloned().chain(of_file).collect();
        let side = scene.shadow_map;
        let faces = |light: &Light| if matches!(light.kind, LightKind::Point { .. }) { 6 } else { 1 };
        if lights.iter().map(faces).sum::<usize>() * side * side > MOST_TEXELS {
            let what = format!("the shadow maps come to more than {MOST_TEXELS} texels");
            return Err(Fault::new(what, "use smaller ones, or fewer lights").field("shadow_map").into());
        }
        // The sun needs to light only what is both in the volume and in the mesh's box.
        let ([low, high], [first, last]) = (placement.bounds(), mesh.bounds());
        let lit = [low.max(first), high.min(last).max(low.max(first))];
        let maps: Vec<Arc<ShadowMap>> = lights.iter().map(|light| cache.map(light, side, &model, lit)).collect();
        let glowing = emitter::glowing(mesh, &placement);
        let emitters: Vec<Emitter> =
            maps.iter().flat_map(|map| map.texels()).map(Emitter::of).chain(glowing.clone()).collect();
        let injected = Arc::new(emitter::inject(&emitters, &placement, scene.injection));
        let camera = scene.camera.unwrap_or_else(|| facing(mesh.bounds()));
        let voxels = cache.voxels(&model, &placement)?;
        let between = cache.voxels(&model, &placement.moved(0.5))?;
        Ok(Stage { model, placement, lights, maps, glowing, injected, voxels, between, camera })
    }

    /// The virtual point lights: of each light's map, and of surfaces that glow.
    pub fn emitters(&self) -> impl Iterator<Item = Emitter> + '_ {
        self.maps.iter().flat_map(|map| map.texels()).map(Emitter::of).chain(self.glowing.iter().copied())
    }
}

impl Emitter {
    /// The virtual point light of a texel.
    fn of(texel: &super::shadow_map::Texel) -> Self {
        Emitter { position: texel.position, normal: texel.normal, flux: texel.flux }
    }
}

/// The document's light for a lamp of a file.
fn light_of(lamp: &Lamp) -> Light {
    let (position, direction) = (lamp.position, lamp.direction);
    match lamp.kind {
        LampKind::Point => Light::point(position, lamp.power),
        LampKind::Sun => Light::sun(direction, lamp.power),
        LampKind::Spot { inner, outer } => {
            let angle = outer.to_degrees().clamp(0.1, 80.0);
            let blend = (1.0 - inner.to_degrees() / angle).clamp(0.0, 1.0);
            Light { kind: LightKind::Spot { position, direction, angle, blend }, ..Light::point(position, lamp.power) }
        }
    }
}

/// A camera before a mesh: from its −z side a little above its middle, far enough to see all of it.
fn facing([low, high]: [DVec3; 2]) -> Camera {
    let (middle, size) = ((low + high) / 2.0, high - low);
    let from = middle + DVec3::new(0.0, 0.1 * size.y, -0.5 * size.z - 1.4 * size.max_element());
    Camera { from: from.to_array(), to: middle.to_array(), up: [0.0, 1.0, 0.0], fov: 40.0 }
}

/// The files of a preset's folder.
struct InFolder<'a>(&'a Path);

impl Files for InFolder<'_> {
    fn read(&self, path: &Path, limit: u64) -> Result<Vec<u8>, Unread> {
        let refused = |what: String, remedy: String| Unread::Refused { what, remedy };
        file::check_relative(path).map_err(|fault| refused(fault.what, fault.remedy))?;
        let found = self.0.join(path);
        if !found.try_exists().unwrap_or(true) {
            return Err(Unread::Missing);
        }
        files::read_bytes(&found, limit).map_err(|error| refused(error.what, error.remedy))
    }
}

/// What scenes are made from, kept between one and the next.
#[derive(Debug, Default)]
pub struct Cache(Mutex<Kept>);

#[derive(Debug, Default)]
struct Kept {
    models: Vec<(ModelKey, Arc<Model>)>,
    maps: Vec<(MapKey, Arc<ShadowMap>)>,
    voxels: Vec<(VoxelKey, Arc<Voxels>)>,
}

/// A mesh's file with the time of its last change and its length; libraries and textures count as part of it.
type ModelKey = (PathBuf, Option<SystemTime>, u64);
/// How many meshes were read.
static MODELS: AtomicU64 = AtomicU64::new(0);

/// A light's map, by the number of its mesh.
type MapKey = (u64, Light, usize, [DVec3; 2]);
type VoxelKey = (u64, Placement);

/// How many meshes, maps and volumes are kept.
const KEPT: [usize; 3] = [4, 32, 8];

impl Cache {
    fn model(&self, path: &Path, folder: &Path, progress: &mut dyn FnMut(f64)) -> Result<Arc<Model>, SceneError> {
        let found = folder.join(path);
        let about = std::fs::metadata(&found).ok();
        let key = (found, about.as_ref().and_then(|a| a.modified().ok()), about.map_or(0, |a| a.len()));
        if let Some(model) = find(&self.kept().models, &key) {
            return Ok(model);
        }
        let loaded = read::read(path, &InFolder(folder), progress).map_err(|fault| told(fault, folder))?;
        let bvh = Bvh::new(&loaded.mesh);
        let number = MODELS.fetch_add(1, Ordering::Relaxed);
        let model = Arc::new(Model { number, mesh: loaded.mesh, bvh, lamps: loaded.lamps, notes: loaded.notes });
        keep(&mut self.kept().models, key, &model, KEPT[0]);
        Ok(model)
    }

    fn map(&self, light: &Light, side: usize, model: &Model, lit: [DVec3; 2]) -> Arc<ShadowMap> {
        // Only the sun's map depends on what it lights.
        let extent = if matches!(light.kind, LightKind::Sun { .. }) { lit } else { [DVec3::ZERO; 2] };
        let key = (model.number, light.clone(), side, extent);
        if let Some(map) = find(&self.kept().maps, &key) {
            return map;
        }
        let map = Arc::new(ShadowMap::new(light, side, &model.mesh, &model.bvh, lit));
        keep(&mut self.kept().maps, key, &map, KEPT[1]);
        map
    }

    fn voxels(&self, model: &Model, placement: &Placement) -> Result<Arc<Voxels>, SceneError> {
        let key = (model.number, *placement);
        if let Some(voxels) = find(&self.kept().voxels, &key) {
            return Ok(voxels);
        }
        let voxels = Voxels::new(&model.mesh, placement, MOST_CELLS).ok_or_else(|| {
            let what = format!("the mesh's surface passes through more than {MOST_CELLS} cells");
            Fault::new(what, "use a smaller volume").field("mesh")
        })?;
        let voxels = Arc::new(voxels);
        keep(&mut self.kept().voxels, key, &voxels, KEPT[2]);
        Ok(voxels)
    }

    fn kept(&self) -> std::sync::MutexGuard<'_, Kept> {
        // What is kept is whole whenever the lock is free, whoever panicked with it.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn find<K: PartialEq, V>(kept: &[(K, Arc<V>)], key: &K) -> Option<Arc<V>> {
    kept.iter().find(|(known, _)| known == key).map(|(_, value)| Arc::clone(value))
}

/// Keeps a value, in place of the oldest where there are `most`.
fn keep<K, V>(kept: &mut Vec<(K, Arc<V>)>, key: K, value: &Arc<V>, most: usize) {
    if kept.len() >= most {
        kept.remove(0);
    }
    kept.push((key, Arc::clone(value)));
}

/// A mesh's fault as a scene's: with the file's whole path.
fn told(fault: FileError, folder: &Path) -> SceneError {
    FileError { file: folder.join(&fault.file), ..fault }.into()
}
