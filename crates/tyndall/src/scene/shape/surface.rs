//! The point where a ray meets a surface.

use crate::math::{Frame, Vec2, Vec3};

/// A point on a surface with its local geometry, in world space.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePoint {
    /// Position, metres.
    pub position: Vec3,
    /// Unit geometric normal, after `flip_normals`; separates interior from exterior.
    pub normal: Vec3,
    /// Shading frame; its normal lies on the side of the geometric normal.
    pub shading: Frame,
    /// Texture coordinates.
    pub uv: Vec2,
    /// Derivative of the position by u, metres.
    pub dp_du: Vec3,
    /// Derivative of the position by v, metres.
    pub dp_dv: Vec3,
    /// Index of the shape in the scene.
    pub shape: u32,
    /// Index of the triangle in its mesh; 0 for other shapes.
    pub triangle: u32,
    /// Barycentric coordinates of the second and third vertex of the triangle.
    pub barycentrics: Vec2,
    /// Bound of the rounding error of `position`, metres: new rays start this far off the surface.
    pub epsilon: f32,
}

impl SurfacePoint {
    /// The start of a ray that leaves towards `direction`, moved off the surface to the right side.
    #[inline(always)]
    pub fn leave(&self, direction: Vec3) -> Vec3 {
        let offset = if direction.dot(self.normal) < 0.0 { -self.epsilon } else { self.epsilon };
        self.position + offset * self.normal
    }
}
