//! Triangle meshes, compiled to world space.

use crate::Spectrum;
use crate::math::{Vec2, Vec3};

/// A triangle mesh in world space (or in the space of its shape group).
#[derive(Debug, Default)]
pub struct Mesh {
    /// Vertex positions, metres.
    pub positions: Vec<Vec3>,
    /// Unit vertex normals: empty or one per position. Already turned when the shape flips its normals.
    pub normals: Vec<Vec3>,
    /// Texture coordinates: empty or one per position.
    pub uvs: Vec<Vec2>,
    /// Three positions each. Already reordered so that the cross product of the edges is the geometric normal.
    pub triangles: Vec<[u32; 3]>,
    /// Named data.
    pub attributes: Vec<Attribute>,
}

/// Named data of a mesh.
#[derive(Debug)]
pub struct Attribute {
    /// Full name, `vertex_...` or `face_...`.
    pub name: Box<str>,
    /// One value per triangle instead of one per vertex.
    pub per_face: bool,
    /// The values; grey ones repeat their channel.
    pub values: Vec<Spectrum>,
}

impl Mesh {
    /// The interpolated attribute, if the mesh has it.
    pub fn attribute(&self, name: &str, triangle: u32, barycentrics: Vec2) -> Option<Spectrum> {
        let attribute = self.attributes.iter().find(|a| &*a.name == name)?;
        if attribute.per_face {
            return Some(attribute.values[triangle as usize]);
        }
        let [a, b, c] = self.triangles[triangle as usize].map(|i| attribute.values[i as usize]);
        Some(a * (1.0 - barycentrics.x - barycentrics.y) + b * barycentrics.x + c * barycentrics.y)
    }
}
