//! Warps of the unit square and interval, each with its density.

use super::{PerSolidAngle, Vec2, Vec3};
use std::f32::consts::{FRAC_1_PI, FRAC_PI_2, FRAC_PI_4, PI};

/// Uniform on the unit disk (Shirley and Chiu 1997, concentric map). Density 1/pi per area.
#[inline(always)]
pub fn square_to_disk(u: Vec2) -> Vec2 {
    let p = 2.0 * u - Vec2::ONE;
    let (r, phi) = if p.x == 0.0 && p.y == 0.0 {
        (0.0, 0.0)
    } else if p.x.abs() > p.y.abs() {
        (p.x, FRAC_PI_4 * (p.y / p.x))
    } else {
        (p.y, FRAC_PI_2 - FRAC_PI_4 * (p.x / p.y))
    };
    let (sin, cos) = phi.sin_cos();
    Vec2::new(r * cos, r * sin)
}

/// Cosine-weighted on the hemisphere about +z. Density [`cosine_hemisphere_pdf`].
#[inline(always)]
pub fn square_to_cosine_hemisphere(u: Vec2) -> Vec3 {
    let p = square_to_disk(u);
    Vec3::new(p.x, p.y, (1.0 - p.length_squared()).max(0.0).sqrt())
}

/// Density of [`square_to_cosine_hemisphere`]: `cos / pi`, zero below the horizon.
#[inline(always)]
pub fn cosine_hemisphere_pdf(cos: f32) -> PerSolidAngle {
    PerSolidAngle(cos.max(0.0) * FRAC_1_PI)
}

/// Uniform on the unit sphere. Density 1/(4 pi).
#[inline(always)]
pub fn square_to_sphere(u: Vec2) -> Vec3 {
    let z = 1.0 - 2.0 * u.x;
    let r = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = (2.0 * PI * u.y).sin_cos();
    Vec3::new(r * cos, r * sin, z)
}

/// Uniform in the cone about +z of half angle `acos(cos_max)`. Density [`cone_pdf`].
#[inline(always)]
pub fn square_to_cone(u: Vec2, cos_max: f32) -> Vec3 {
    let z = 1.0 - u.x * (1.0 - cos_max);
    let r = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = (2.0 * PI * u.y).sin_cos();
    Vec3::new(r * cos, r * sin, z)
}

/// Density of [`square_to_cone`] inside the cone.
#[inline(always)]
pub fn cone_pdf(cos_max: f32) -> PerSolidAngle {
    PerSolidAngle(1.0 / (2.0 * PI * (1.0 - cos_max)))
}

/// Barycentric coordinates `(b1, b2)` uniform on a triangle. Density 1/area.
#[inline(always)]
pub fn square_to_triangle(u: Vec2) -> Vec2 {
    let root = (1.0 - u.x).max(0.0).sqrt();
    Vec2::new(1.0 - root, u.y * root)
}
