//! Rays.

use super::Vec3;

/// The half line `origin + t * direction`, `t >= 0`.
#[derive(Clone, Copy, Debug)]
pub struct Ray {
    /// Start, in metres.
    pub origin: Vec3,
    /// Unit direction.
    pub direction: Vec3,
}

impl Ray {
    /// The point at distance `t`.
    #[inline(always)]
    pub fn at(&self, t: f32) -> Vec3 {
        self.origin + t * self.direction
    }

    /// The ray from one point towards another, which must not be the same.
    #[inline]
    pub fn between(from: Vec3, to: Vec3) -> Self {
        Self { origin: from, direction: (to - from).normalize() }
    }
}
