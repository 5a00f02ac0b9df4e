//! What area emitters need to know of the shapes.

use crate::math::{Aabb, PerArea, PerSolidAngle, Vec2, Vec3};
use crate::scene::shape::Mesh;

/// A point on an emitting shape.
#[derive(Clone, Copy, Debug)]
pub struct ShapePoint {
    /// Position, metres.
    pub position: Vec3,
    /// Unit geometric normal.
    pub normal: Vec3,
    /// Texture coordinates.
    pub uv: Vec2,
    /// Index of the triangle in its mesh; 0 for other shapes.
    pub triangle: u32,
    /// Barycentric coordinates of the second and third vertex of the triangle.
    pub barycentrics: Vec2,
}

/// Shapes that can be sampled.
pub trait EmissiveShapes {
    /// The mesh behind a shape, if it is one.
    fn mesh(&self, shape: u32) -> Option<&Mesh>;
    /// Area, m^2.
    fn area(&self, shape: u32) -> f32;
    /// Box around the shape.
    fn bounds(&self, shape: u32) -> Aabb;
    /// Axis and half angle (radians) of a cone around the geometric normals.
    fn normals(&self, shape: u32) -> (Vec3, f32);
    /// A point on the shape, with its density.
    fn sample_area(&self, shape: u32, u: Vec2) -> (ShapePoint, PerArea);
    /// A point on the shape chosen for a receiver at `from`, with its density there.
    fn sample_from(&self, shape: u32, from: Vec3, u: Vec2) -> Option<(ShapePoint, PerSolidAngle)>;
    /// Density of [`EmissiveShapes::sample_from`] at a point of the shape.
    fn pdf_from(&self, shape: u32, from: Vec3, position: Vec3, normal: Vec3) -> PerSolidAngle;
}
