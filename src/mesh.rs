//! Triangles and what they are made of: the mesh of a scene, its readers, and rays through it.
//!
//! A mesh knows nothing of cells and light. Its surfaces are two-sided and diffuse: a triangle has an albedo
//! and an emission, and both sides have the same. Lengths are metres, and y is up by habit alone.
//!
//! Corners are held in single precision, 6·10⁻⁸ of a coordinate; whatever is computed from them (areas,
//! normals, where a ray meets a surface) is computed in double precision from those corners.
//!
//! [`read::read`] reads `.obj` with its `.mtl`, `.gltf` and `.glb`; [`Bvh`] answers what a ray meets.

pub mod cut;
pub mod read;

mod bvh;
mod gltf;
mod job;
mod lamp;
mod obj;
mod polygon;
mod texture;

use glam::{DVec3, Vec3};

pub use bvh::{Bvh, Hit};

/// The most triangles that a mesh may have.
pub const MOST_TRIANGLES: usize = 10_000_000;
/// The most vertices that a mesh may have.
pub const MOST_VERTICES: usize = 3 * MOST_TRIANGLES;
/// The largest coordinate that a vertex may have, in metres.
pub const FARTHEST: f32 = 1e9;

/// What a surface is made of, both sides alike.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Its name in the file; empty where it has none.
    pub name: String,
    /// The share of red, green and blue light that it sends back, each 0 to 1, linear.
    pub albedo: [f64; 3],
    /// The radiance that it emits by itself in red, green and blue, W/(m²·sr), each ≥ 0.
    pub emission: [f64; 3],
}

impl Material {
    /// A grey material that emits nothing: what takes the place of one that is missing.
    pub fn grey(name: impl Into<String>) -> Self {
        Material { name: name.into(), albedo: [0.5; 3], emission: [0.0; 3] }
    }
}

/// Triangles with their materials. It holds at least one triangle, and each has an area.
///
/// ```
/// use glam::Vec3;
/// use lpv_lab::mesh::{Material, Mesh};
///
/// let corners = vec![Vec3::ZERO, Vec3::X * 2.0, Vec3::Y];
/// let mesh = Mesh::new(corners, vec![[0, 1, 2]], vec![0], vec![Material::grey("paper")]).unwrap();
/// assert_eq!((mesh.len(), mesh.area(0)), (1, 1.0));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    vertices: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    /// By triangle, its material.
    made_of: Vec<u32>,
    materials: Vec<Material>,
    /// By triangle, its own albedo in place of its material's; empty where no material has a texture.
    tints: Vec<[f32; 3]>,
    bounds: [DVec3; 2],
}

impl Mesh {
    /// A mesh of these vertices, of triangles as numbers of vertices, and by triangle the number of its
    /// material. Triangles without an area are dropped.
    ///
    /// # Errors
    /// Tells in a few words what is wrong: a number out of range, a vertex that is not finite or beyond
    /// [`FARTHEST`], too many triangles, or none with an area.
    pub fn new(
        vertices: Vec<Vec3>,
        triangles: Vec<[u32; 3]>,
        made_of: Vec<u32>,
        materials: Vec<Material>,
    ) -> Result<Mesh, String> {
        Mesh::tinted(vertices, triangles, made_of, materials, Vec::new()).map(|(mesh, _)| mesh)
    }

    /// The same with an albedo for each triangle, or for none; gives how many triangles were dropped too.
    fn tinted(
        vertices: Vec<Vec3>,
        mut triangles: Vec<[u32; 3]>,
        mut made_of: Vec<u32>,
        materials: Vec<Material>,
        mut tints: Vec<[f32; 3]>,
    ) -> Result<(Mesh, usize), String> {
        if triangles.len() > MOST_TRIANGLES || vertices.len() > MOST_VERTICES {
            return Err(format!("the mesh has more than {MOST_TRIANGLES} triangles"));
        }
        if made_of.len() != triangles.len() || !(tints.is_empty() || tints.len() == triangles.len()) {
            return Err("not every triangle has a material".into());
        }
        if let Some(i) = vertices.iter().position(|v| !is_usable(*v)) {
            return Err(format!("vertex {i} is not finite or lies beyond {FARTHEST:e} m"));
        }
        let known = |t: &[u32; 3]| t.iter().all(|v| (*v as usize) < vertices.len());
        if let Some(i) = triangles.iter().position(|t| !known(t)) {
            return Err(format!("triangle {i} has a vertex that is not there"));
        }
        if let Some(i) = made_of.iter().position(|m| *m as usize >= materials.len()) {
            return Err(format!("triangle {i} has a material that is not there"));
        }
        let before = triangles.len();
        let kept: Vec<bool> = triangles.iter().map(|t| has_area(t.map(|v| vertices[v as usize].as_dvec3()))).collect();
        let keep = |i: &mut usize| {
            *i += 1;
            kept[*i - 1]
        };
        let (mut a, mut b, mut c) = (0, 0, 0);
        triangles.retain(|_| keep(&mut a));
        made_of.retain(|_| keep(&mut b));
        tints.retain(|_| keep(&mut c));
        if triangles.is_empty() {
            return Err("the mesh has no triangle with an area".into());
        }
        let corners = triangles.iter().flatten().map(|v| vertices[*v as usize].as_dvec3());
        let bounds = corners.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)]);
        let dropped = before - triangles.len();
        Ok((Mesh { vertices, triangles, made_of, materials, tints, bounds }, dropped))
    }

    /// The number of triangles, at least one.
    #[allow(clippy::len_without_is_empty)]
    pub fn len(&self) -> usize {
        self.triangles.len()
    }

    /// The vertices, in metres.
    pub fn vertices(&self) -> &[Vec3] {
        &self.vertices
    }

    /// The triangles, as numbers of vertices.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The materials, whether a triangle has them or not.
    pub fn materials(&self) -> &[Material] {
        &self.materials
    }

    /// The corners of a triangle, in metres.
    pub fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles[triangle].map(|v| self.vertices[v as usize].as_dvec3())
    }

    /// The material of a triangle.
    pub fn material(&self, triangle: usize) -> &Material {
        &self.materials[self.made_of[triangle] as usize]
    }

    /// The share of each colour that a triangle sends back: its material's, or the mean of its texture over it.
    pub fn albedo(&self, triangle: usize) -> [f64; 3] {
        self.tints.get(triangle).map_or(self.material(triangle).albedo, |tint| tint.map(f64::from))
    }

    /// The radiance that a triangle emits by itself, both sides alike, W/(m²·sr).
    pub fn emission(&self, triangle: usize) -> [f64; 3] {
        self.material(triangle).emission
    }

    /// The unit normal of a triangle's front: from there its corners run counter-clockwise.
    pub fn normal(&self, triangle: usize) -> DVec3 {
        across(self.corners(triangle)).normalize()
    }

    /// The area of a triangle, one side of it, in m².
    pub fn area(&self, triangle: usize) -> f64 {
        across(self.corners(triangle)).length() / 2.0
    }

    /// The area of all triangles, one side of each, in m².
    pub fn total_area(&self) -> f64 {
        (0..self.len()).map(|i| self.area(i)).sum()
    }

    /// The corners of the smallest box around the triangles: the smallest and the largest x, y and z.
    pub fn bounds(&self) -> [DVec3; 2] {
        self.bounds
    }

    /// The bytes that it takes.
    pub fn bytes(&self) -> u64 {
        let each = |n: usize, size: usize| (n * size) as u64;
        let triangles = each(self.triangles.len(), size_of::<[u32; 3]>() + size_of::<u32>());
        each(self.vertices.len(), size_of::<Vec3>()) + triangles + each(self.tints.len(), size_of::<[f32; 3]>())
    }
}

/// Whether a vertex can stand in a mesh.
fn is_usable(vertex: Vec3) -> bool {
    // A comparison with NaN is false.
    vertex.abs().to_array().iter().all(|c| *c <= FARTHEST)
}

/// The vector across a triangle, twice its area long.
fn across([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a)
}

/// Whether a triangle has an area and with it a normal: less than 10⁻¹² of its longest side's square is none.
fn has_area(corners @ [a, b, c]: [DVec3; 3]) -> bool {
    let longest = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
    across(corners).length() > 1e-12 * longest
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let corners = [[0.0, 0.0], [3.0, 0.0], [3.0, 2.0], [0.0, 2.0], [1.0, 0.0]];
        (corners.map(|[x, z]| Vec3::new(x, 1.0, z)).to_vec(), vec![[0, 1, 2], [0, 4, 1], [0, 2, 3]])
    }

    #[test]
    fn areas_normals_and_bounds_are_those_of_the_triangles_that_have_an_area() {
        let (vertices, triangles) = square();
        let materials = vec![Material::grey("a"), Material::grey("b")];
        let tints = vec![[0.1; 3], [0.2; 3], [0.3; 3]];
        let (mesh, dropped) = Mesh::tinted(vertices, triangles, vec![0, 0, 1], materials, tints).unwrap();
        assert_eq!((mesh.len(), dropped), (2, 1));
        assert_eq!((mesh.total_area(), mesh.area(1)), (6.0, 3.0));
        assert_eq!(mesh.normal(0), DVec3::NEG_Y);
        assert_eq!(mesh.material(1).name, "b");
        assert_eq!(mesh.albedo(1), [f64::from(0.3f32); 3]);
        assert_eq!(mesh.bounds(), [DVec3::new(0.0, 1.0, 0.0), DVec3::new(3.0, 1.0, 2.0)]);
    }

    #[test]
    fn what_cannot_be_a_mesh_is_refused() {
        let (vertices, triangles) = square();
        let build = |vertices: &[Vec3], triangles: &[[u32; 3]], made_of: u32| {
            let made_of = vec![made_of; triangles.len()];
            Mesh::new(vertices.to_vec(), triangles.to_vec(), made_of, vec![Material::grey("")])
        };
        assert!(build(&vertices, &triangles, 0).is_ok());
        assert!(build(&vertices, &triangles, 1).is_err());
        assert!(build(&vertices, &[[0, 1, 5]], 0).is_err());
        assert!(build(&vertices, &[[0, 4, 1]], 0).is_err());
        for bad in [f32::NAN, f32::INFINITY, -2e9] {
            let mut vertices = vertices.clone();
            vertices[3].y = bad;
            assert!(build(&vertices, &triangles, 0).is_err(), "{bad}");
        }
    }
}
