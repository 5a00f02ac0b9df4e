//! Affine maps of texture coordinates.

use super::TextureError;
use crate::math::{Transform, Vec2};

/// An affine map of the plane of texture coordinates.
#[derive(Clone, Copy, Debug)]
pub struct UvMap {
    u: Vec2,
    v: Vec2,
    offset: Vec2,
}

impl UvMap {
    /// The part of a transform that acts within the plane z = 0.
    pub fn new(transform: &Transform) -> Result<Self, TextureError> {
        let [x, y, ..] = transform.rows();
        let map = Self {
            u: Vec2::new(x[0] as f32, y[0] as f32),
            v: Vec2::new(x[1] as f32, y[1] as f32),
            offset: Vec2::new(x[3] as f32, y[3] as f32),
        };
        let finite = map.u.is_finite() && map.v.is_finite() && map.offset.is_finite();
        finite.then_some(map).ok_or(TextureError::Transform)
    }

    /// The mapped point.
    #[inline(always)]
    pub fn point(&self, uv: Vec2) -> Vec2 {
        self.u * uv.x + self.v * uv.y + self.offset
    }

    /// The gradient before the map of a function whose gradient after the map is given.
    #[inline(always)]
    pub fn pull_back(&self, gradient: Vec2) -> Vec2 {
        Vec2::new(self.u.dot(gradient), self.v.dot(gradient))
    }
}
