//! Functions that look random.

use super::mesh::{Vector, dot};

/// Value noise in [-1, 1]: random at the integer points, smoothly blended between.
pub(super) fn noise(p: Vector) -> f64 {
    let corner = |x: i64, y: i64, z: i64| {
        let mut h = (x.wrapping_mul(0x9e37_79b1) ^ y.wrapping_mul(0x85eb_ca6b) ^ z.wrapping_mul(0xc2b2_ae35)) as u64;
        h = (h ^ (h >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        h = (h ^ (h >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((h ^ (h >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    let cell = p.map(f64::floor);
    let [u, v, w] = [0, 1, 2].map(|k| {
        let t = p[k] - cell[k];
        t * t * t * (t * (6.0 * t - 15.0) + 10.0)
    });
    let [x, y, z] = cell.map(|c| c as i64);
    let mut sum = 0.0;
    for (i, j, k) in (0..8).map(|c| (c & 1, (c >> 1) & 1, c >> 2)) {
        let side = |bit: i64, t: f64| if bit == 1 { t } else { 1.0 - t };
        sum += side(i, u) * side(j, v) * side(k, w) * corner(x + i, y + j, z + k);
    }
    sum
}

/// Five octaves of [`noise`].
pub(super) fn turbulence(p: Vector) -> f64 {
    (0..5).map(|octave| 0.5f64.powi(octave) * noise(p.map(|x| x * 2f64.powi(octave) + 17.3 * f64::from(octave)))).sum()
}

/// Plane waves with these wave vectors, added up. All bend the surface alike: their second derivatives have amplitude one.
pub(super) fn ripples(p: Vector, waves: impl Iterator<Item = Vector>) -> f64 {
    waves.enumerate().map(|(i, k)| (dot(k, p) + 2.4 * i as f64).sin() / dot(k, k)).sum()
}
