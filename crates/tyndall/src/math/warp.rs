//! Warps of the unit square and interval, each with its density.

use super::angle::{sin_cos_near_zero, sin_cos_of_turn};
use super::{PerSolidAngle, Vec2, Vec3};
use std::f32::consts::{FRAC_1_PI, FRAC_PI_4, PI};
use std::hint::select_unpredictable;

/// Uniform on the unit disk (Shirley and Chiu 1997, concentric map). Density 1/pi per area.
#[inline(always)]
pub fn square_to_disk(u: Vec2) -> Vec2 {
    let p = 2.0 * u - Vec2::ONE;
    // The angle is counted from the nearer axis.
    let flat = p.x.abs() > p.y.abs();
    let (along, across) = select_unpredictable(flat, (p.x, p.y), (p.y, p.x));
    let ratio = if along == 0.0 { 0.0 } else { across / along };
    let (sin, cos) = sin_cos_near_zero(FRAC_PI_4 * ratio);
    let (along, across) = (along * cos, along * sin);
    select_unpredictable(flat, Vec2::new(along, across), Vec2::new(across, along))
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
    let (sin, cos) = sin_cos_of_turn(u.y);
    Vec3::new(r * cos, r * sin, z)
}

/// Uniform in the cone about +z of half angle `acos(cos_max)`. Density [`cone_pdf`].
#[inline(always)]
pub fn square_to_cone(u: Vec2, cos_max: f32) -> Vec3 {
    let z = 1.0 - u.x * (1.0 - cos_max);
    let r = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = sin_cos_of_turn(u.y);
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
