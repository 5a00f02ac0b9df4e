//! The surface of the sea.

use super::mesh::Mesh;
use super::noise::ripples;

/// Waves around y = 0 over [-8.1, 8.1] x [-8.1, 8.1], facing up.
pub(super) fn surface() -> Mesh {
    const SIDE: usize = 101;
    const WAVES: usize = 12;
    // waves of 1.2 to 4 metres that run within 75 degrees of the x axis
    let wave = |i: usize| {
        let length = 1.2 * (4.0f64 / 1.2).powf(i as f64 / (WAVES - 1) as f64);
        let (sin, cos) = (150.0 * ((0.618 * i as f64).fract() - 0.5)).to_radians().sin_cos();
        let k = std::f64::consts::TAU / length;
        [k * cos, 0.0, k * sin]
    };
    Mesh::grid(SIDE, SIDE, [false, false], |i, j| {
        let [x, z] = [i, j].map(|n| 8.1 * (2.0 * n as f64 / (SIDE - 1) as f64 - 1.0));
        // -z so that columns cross rows upwards
        [x, 0.6 * ripples([x, 0.0, -z], (0..WAVES).map(wave)), -z]
    })
}
