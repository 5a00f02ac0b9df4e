//! A ball with bumps.

use super::mesh::{Mesh, scale};
use super::noise::ripples;
use std::f64::consts::PI;

/// A ball of radius one, give or take a few hundredths.
pub(super) fn ball() -> Mesh {
    const WAVES: usize = 24;
    // wave vectors in all directions, at the golden angle from each other
    let wave = |i: usize| {
        let z = 1.0 - (2 * i + 1) as f64 / WAVES as f64;
        let (sin, cos) = (PI * (3.0 - 5.0f64.sqrt()) * i as f64).sin_cos();
        let r = (1.0 - z * z).sqrt();
        scale(9.0 + 6.0 * (0.618 * i as f64).fract(), [r * cos, z, r * sin])
    };
    Mesh::star(5, |p| 1.0 + 0.5 * ripples(p, (0..WAVES).map(wave)))
}
