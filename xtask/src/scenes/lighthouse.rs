//! A lighthouse, its rock, and the sky at dusk.

use super::mesh::{Mesh, scale};
use super::noise::turbulence;
use super::revolved::Revolved;

/// Radius of the tower at a height in metres: 5 at its foot, 2.6 below the gallery.
fn radius(y: f64) -> f64 {
    2.4 + 2.6 * (1.0 - y / 30.0).powi(2) + 0.2 * (1.0 - y / 30.0)
}

/// One of seven bands of the tower, up to 28 metres.
fn band(i: usize) -> Mesh {
    let points: Vec<_> = (0..=4).map(|k| 4.0 * i as f64 + f64::from(k)).map(|y| [radius(y), y]).collect();
    Revolved::pieces(&points)
}

/// White bands, and the gallery around the lamp.
pub(super) fn white() -> Mesh {
    let gallery = [[2.4, 28.0], [3.6, 28.8], [3.6, 29.2], [3.5, 29.3], [0.0, 29.3]];
    let parapet = [[1.9, 29.3], [1.9, 30.1], [0.0, 30.1]];
    [0, 2, 4, 6].into_iter().fold(Revolved::pieces(&gallery).with(&Revolved::pieces(&parapet)), |m, i| m.with(&band(i)))
}

/// Red bands, and the roof.
pub(super) fn red() -> Mesh {
    let roof = [[0.0, 33.0], [2.2, 33.0], [2.3, 33.2], [1.5, 34.2], [0.4, 34.9], [0.35, 35.6], [0.0, 35.8]];
    [1, 3, 5].into_iter().fold(Revolved::pieces(&roof), |mesh, i| mesh.with(&band(i)))
}

/// A rock of about radius one.
pub(super) fn rock() -> Mesh {
    Mesh::star(4, |p| 1.0 + 0.35 * turbulence(scale(1.6, p)))
}

/// An environment map (PFM): orange at the horizon of the west, deep blue above.
pub(super) fn sky() -> Vec<u8> {
    const SIZE: [usize; 2] = [64, 64];
    let mut bytes = format!("PF\n{} {}\n-1.0\n", SIZE[0], SIZE[1]).into_bytes();
    // rows of a PFM go up from the lowest
    for row in 0..SIZE[1] {
        let height = ((row as f64 + 0.5) / SIZE[1] as f64 - 0.5) * std::f64::consts::PI;
        for column in 0..SIZE[0] {
            // the west is in the middle of the map
            let away = ((column as f64 + 0.5) / SIZE[0] as f64 - 0.5) * std::f64::consts::TAU;
            let glow = (0.5 + 0.5 * away.cos()).powi(2) * (-height.abs() / 0.17).exp();
            let band = (-height.abs() / 0.45).exp();
            let dusk = [0.62 * glow + 0.030 * band, 0.25 * glow + 0.038 * band, 0.09 * glow + 0.07 * band];
            for (add, night) in dusk.into_iter().zip([0.006, 0.011, 0.03]) {
                bytes.extend(((add + night) as f32).to_le_bytes());
            }
        }
    }
    bytes
}
