//! Orthonormal frames.

use super::Vec3;

/// A right-handed orthonormal frame; local z is the normal.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// Local x axis in world space.
    pub s: Vec3,
    /// Local y axis in world space.
    pub t: Vec3,
    /// Local z axis in world space.
    pub n: Vec3,
}

impl Frame {
    /// Some frame around the unit vector `n` (Duff et al. 2017, "Building an Orthonormal Basis, Revisited").
    #[inline(always)]
    pub fn from_normal(n: Vec3) -> Self {
        let sign = 1.0_f32.copysign(n.z);
        let a = -1.0 / (sign + n.z);
        let b = n.x * n.y * a;
        Self {
            s: Vec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x),
            t: Vec3::new(b, sign + n.y * n.y * a, -n.y),
            n,
        }
    }

    /// The frame around the unit vector `n` whose x axis lies as near as possible to `tangent`.
    #[inline(always)]
    pub fn from_normal_and_tangent(n: Vec3, tangent: Vec3) -> Self {
        let s = tangent - n * n.dot(tangent);
        let length_squared = s.length_squared();
        // Nearly parallel, or no tangent at all.
        if !(length_squared > 1e-10 * tangent.length_squared()) {
            return Self::from_normal(n);
        }
        let s = s * length_squared.sqrt().recip();
        Self { s, t: n.cross(s), n }
    }

    /// World to local coordinates.
    #[inline(always)]
    pub fn to_local(&self, v: Vec3) -> Vec3 {
        Vec3::new(v.dot(self.s), v.dot(self.t), v.dot(self.n))
    }

    /// Local to world coordinates.
    #[inline(always)]
    pub fn to_world(&self, v: Vec3) -> Vec3 {
        self.s * v.x + self.t * v.y + self.n * v.z
    }
}
