//! Grids of smoke.

use super::noise::turbulence;

/// The grid of smoke-plume.xml.
pub(super) fn plume_grid() -> Vec<u8> {
    volume(PLUME, plume)
}

/// The grid of the peers' smoke.
pub(super) fn puff_grid() -> Vec<u8> {
    volume([64; 3], puff)
}

/// A `.vol` file over the unit cube: `density` at the voxel centres, its largest value scaled to one.
fn volume(size: [usize; 3], density: fn([f64; 3]) -> f64) -> Vec<u8> {
    let [nx, ny, nz] = size;
    let centre = |i: usize, n: usize| (i as f64 + 0.5) / n as f64;
    let mut voxels = Vec::with_capacity(nx * ny * nz);
    for z in 0..nz {
        for y in 0..ny {
            voxels.extend((0..nx).map(|x| density([centre(x, nx), centre(y, ny), centre(z, nz)])));
        }
    }
    let most = voxels.iter().copied().fold(0.0, f64::max);
    let mut bytes = b"VOL\x03".to_vec();
    for n in [1, nx, ny, nz, 1] {
        bytes.extend((n as i32).to_le_bytes());
    }
    for x in [0.0f32, 0.0, 0.0, 1.0, 1.0, 1.0] {
        bytes.extend(x.to_le_bytes());
    }
    bytes.extend(voxels.iter().flat_map(|v| ((v / most) as f32).to_le_bytes()));
    bytes
}

/// Voxels of the plume: 229 kB.
const PLUME: [usize; 3] = [32, 56, 32];

/// A plume that rises, leans, widens and breaks up, in the unit cube.
fn plume([x, y, z]: [f64; 3]) -> f64 {
    let (px, py, pz) = (2.0 * x - 1.0, 3.5 * y, 2.0 * z - 1.0);
    let swirl = 0.06 + 0.08 * py;
    let wx = px + swirl * turbulence([1.7 * px, 1.4 * py - 3.0, 1.7 * pz]);
    let wz = pz + swirl * turbulence([1.7 * px + 40.0, 1.4 * py, 1.7 * pz]);
    let (cx, cz) = (0.05 * (1.3 * py).sin() * py, 0.04 * (1.7 * py + 1.0).sin() * py);
    let width = 0.24 + 0.15 * py;
    let r = (wx - cx).hypot(wz - cz) / width;
    let billow = 0.62 + 0.75 * turbulence([3.1 * wx, 2.3 * py - 2.0, 3.1 * wz]);
    let edge = ((1.0 - x).min(x).min(1.0 - z).min(z) / 0.06).clamp(0.0, 1.0);
    let ends = (py / 0.1).min((3.5 - py) / 1.2).clamp(0.0, 1.0);
    let thin = 1.0 / (1.0 + 0.5 * py);
    ((1.15 - r * r).max(0.0) * billow - 0.08).max(0.0) * edge * ends * thin
}

/// A rounder puff, in the unit cube.
fn puff([x, y, z]: [f64; 3]) -> f64 {
    let (cx, cz) = (0.5 + 0.08 * (4.0 * y).sin(), 0.5 + 0.06 * (5.0 * y).cos());
    let r = (x - cx).hypot(z - cz) / (0.12 + 0.28 * y);
    let fall = (1.4 - 1.4 * r).clamp(0.0, 1.0) * (y / 0.08).min(1.0) * ((1.0 - y) / 0.15).min(1.0);
    (fall * (0.5 + 0.45 * turbulence([5.0 * x, 5.0 * y, 5.0 * z])) - 0.08).max(0.0)
}
