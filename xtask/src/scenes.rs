//! `cargo xtask scenes`: the side files of the scenes, computed.

use std::f64::consts::TAU;
use std::io;
use std::path::Path;

/// Writes every side file under `scenes/`.
pub(crate) fn write(root: &Path) -> io::Result<()> {
    let scenes = root.join("scenes");
    std::fs::write(scenes.join("smoke-plume.vol"), volume(PLUME, plume))?;
    for (name, surface) in glass_of_milk() {
        std::fs::write(scenes.join(name), surface.ply())?;
    }
    peers(root)
}

/// Writes the grid of the peers' smoke, too large to be kept.
pub(crate) fn peers(root: &Path) -> io::Result<()> {
    std::fs::write(root.join("scenes/peers/density64.vol"), volume([64; 3], puff))
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

/// Value noise in [-1, 1]: random at the integer points, smoothly blended between.
fn noise(p: [f64; 3]) -> f64 {
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
fn turbulence(p: [f64; 3]) -> f64 {
    (0..5).map(|octave| 0.5f64.powi(octave) * noise(p.map(|x| x * 2f64.powi(octave) + 17.3 * f64::from(octave)))).sum()
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

/// A surface of revolution about the y axis: one (radius, height, normal) after another along the profile.
struct Revolved {
    profile: Vec<([f64; 2], [f64; 2])>,
}

/// Steps around the axis.
const AROUND: usize = 72;

impl Revolved {
    /// Binary little-endian PLY with vertex normals; faces wind such that their normals agree with those.
    fn ply(&self) -> Vec<u8> {
        let mut vertices: Vec<u8> = Vec::new();
        for ([r, y], [nr, ny]) in &self.profile {
            for i in 0..AROUND {
                let (sin, cos) = (TAU * i as f64 / AROUND as f64).sin_cos();
                for value in [r * cos, *y, r * sin, nr * cos, *ny, nr * sin] {
                    vertices.extend((value as f32).to_le_bytes());
                }
            }
        }
        let mut faces: Vec<[usize; 3]> = Vec::new();
        for row in 0..self.profile.len() - 1 {
            let (p, q) = (&self.profile[row], &self.profile[row + 1]);
            // the geometric normal of a step (dr, dy) along the profile is (dy, -dr), for the winding (a, b, c) below
            let (dr, dy) = (q.0[0] - p.0[0], q.0[1] - p.0[1]);
            let outwards = dy * (p.1[0] + q.1[0]) - dr * (p.1[1] + q.1[1]) > 0.0;
            for i in 0..AROUND {
                let j = (i + 1) % AROUND;
                let [a, b] = [i, j].map(|i| row * AROUND + i);
                let [d, c] = [a, b].map(|v| v + AROUND);
                // on the axis a quadrilateral is a triangle
                let halves = [(q.0[0] > 0.0, [a, d, c]), (p.0[0] > 0.0, [a, c, b])];
                for (_, [x, y, z]) in halves.into_iter().filter(|half| half.0) {
                    faces.push(if outwards { [x, y, z] } else { [x, z, y] });
                }
            }
        }
        let mut bytes = format!(
            "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
             property float nx\nproperty float ny\nproperty float nz\nelement face {}\n\
             property list uchar int vertex_indices\nend_header\n",
            self.profile.len() * AROUND,
            faces.len()
        )
        .into_bytes();
        bytes.extend(vertices);
        for face in faces {
            bytes.push(3);
            face.iter().for_each(|&v| bytes.extend((v as i32).to_le_bytes()));
        }
        bytes
    }
}

/// The three interfaces of a glass of milk, in centimetres; they meet in one circle, with the same vertices.
fn glass_of_milk() -> [(&'static str, Revolved); 3] {
    let outer = |y: f64| 3.0 + 0.07 * y;
    let inner = |y: f64| outer(y) - 0.22;
    let (height, level, floor) = (12.0, 9.0, 0.9);
    let slant = |side: f64| {
        let n = 1.0f64.hypot(0.07);
        [side / n, -side * 0.07 / n]
    };
    // quarter circle of `steps` from angle a0 to a1 around a centre, the normal pointing away from it (or to it)
    let arc = |[r, y]: [f64; 2], radius: f64, a0: f64, a1: f64, steps: usize, side: f64| {
        (0..=steps).map(move |i| {
            let (sin, cos) = (a0 + (a1 - a0) * i as f64 / steps as f64).to_radians().sin_cos();
            ([r + radius * cos, y + radius * sin], [side * cos, side * sin])
        })
    };
    let lean = 0.07f64.atan().to_degrees();

    // from the middle of the underside, round the foot, up the outside, over the rim, down to the milk
    let mut air = vec![([0.0, 0.0], [0.0, -1.0]), ([1.5, 0.0], [0.0, -1.0])];
    air.extend(arc([outer(0.0) - 0.35, 0.35], 0.35, -90.0, -lean, 6, 1.0));
    air.extend((1..8).map(|i| 0.6 + (height - 0.6) * f64::from(i) / 8.0).map(|y| ([outer(y), y], slant(1.0))));
    air.extend(arc([0.5 * (outer(height) + inner(height)), height], 0.11, -lean, 180.0 - lean, 8, 1.0));
    air.extend(
        (0..=4)
            .map(|i| height - 0.1 - (height - 0.1 - level) * f64::from(i) / 4.0)
            .map(|y| ([inner(y), y], slant(-1.0))),
    );

    // from the circle down the inside to the middle of the bottom
    let corner = 0.8;
    let mut side: Vec<_> = (0..8)
        .map(|i| level - (level - floor - corner) * f64::from(i) / 8.0)
        .map(|y| ([inner(y), y], slant(1.0)))
        .collect();
    side.extend(arc([inner(floor + corner) - corner, floor + corner], corner, -lean, -90.0, 8, 1.0));
    side.push(([0.0, floor], [0.0, -1.0]));

    // the surface, flat, with a meniscus that climbs the wall
    let rim = inner(level);
    let meniscus = |r: f64| 0.12 * (-(rim - r) / 0.13).exp();
    let top = [0.0, 0.4, 0.7, 0.85, 0.91, 0.94, 0.96, 0.975, 0.99, 1.0].map(|s| {
        let r: f64 = s * rim;
        let n = [-meniscus(r) / 0.13, 1.0];
        let length = n[0].hypot(n[1]);
        ([r, level - meniscus(rim) + meniscus(r)], n.map(|c| c / length))
    });
    [
        ("milk-glass-air.ply", Revolved { profile: air }),
        ("milk-glass-side.ply", Revolved { profile: side }),
        ("milk-glass-top.ply", Revolved { profile: top.to_vec() }),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The committed files are what the generator writes, but for last digits of sines and exponentials.
    #[test]
    fn files_are_up_to_date() {
        let same = |name: &str, bytes: Vec<u8>| {
            let kept = std::fs::read(crate::root().join("scenes").join(name)).unwrap();
            let different = kept.iter().zip(&bytes).filter(|(a, b)| a != b).count();
            assert!(kept.len() == bytes.len() && different * 50 < kept.len(), "{name}: run cargo xtask scenes");
        };
        same("smoke-plume.vol", volume(PLUME, plume));
        glass_of_milk().into_iter().for_each(|(name, surface)| same(name, surface.ply()));
    }

    /// The interfaces share the circle where they meet.
    #[test]
    fn milk_meets_glass() {
        let [air, side, top] = glass_of_milk().map(|(_, surface)| surface.profile);
        let meeting = air.last().unwrap().0;
        assert_eq!(meeting, side[0].0);
        let near = top.last().unwrap().0;
        assert!((meeting[0] - near[0]).abs() < 1e-12 && (meeting[1] - near[1]).abs() < 1e-12);
    }
}
