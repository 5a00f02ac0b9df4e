//! Sets of points that the tests of grid and tree share.

use crate::math::{Rng, Vec3, warp};

pub(super) fn uniform(count: usize, seed: u64) -> Vec<Vec3> {
    let mut rng = Rng::keyed(seed, 0, 0);
    (0..count).map(|_| Vec3::new(rng.f32(), rng.f32(), rng.f32())).collect()
}

/// Balls of very different density.
pub(super) fn clustered(count: usize, seed: u64) -> Vec<Vec3> {
    let mut rng = Rng::keyed(seed, 1, 0);
    let centres = uniform(7, seed);
    (0..count)
        .map(|i| centres[i % 7] + 0.1_f32.powi(1 + i as i32 % 3) * rng.f32() * warp::square_to_sphere(rng.vec2()))
        .collect()
}

/// Every kind of set that has its difficulty, with its name and a radius that suits it.
pub(super) fn all() -> Vec<(&'static str, Vec<Vec3>, f32)> {
    let lattice = |i: usize| Vec3::new((i % 13) as f32, (i / 13 % 13) as f32, (i / 169) as f32);
    let moved = |by: Vec3, scale: f32| uniform(1500, 5).into_iter().map(move |p| by + scale * p);
    vec![
        ("nothing", vec![], 0.1),
        ("one", uniform(1, 1), 0.1),
        ("eight", uniform(8, 1), 0.3),
        ("nine", uniform(9, 1), 0.3),
        ("seventeen", uniform(17, 2), 0.3),
        ("few", uniform(300, 3), 0.15),
        ("uniform", uniform(20_000, 4), 0.06),
        ("uniform, small radius", uniform(5000, 4), 0.003),
        ("clustered", clustered(20_000, 5), 0.004),
        ("coincident", vec![Vec3::new(0.3, -0.2, 7.0); 1000], 0.1),
        ("coincident in pairs", uniform(1000, 6).into_iter().flat_map(|p| [p, p]).collect(), 0.1),
        ("along x", uniform(3000, 7).into_iter().map(|p| Vec3::X * p.x).collect(), 0.003),
        ("along z", uniform(3000, 7).into_iter().map(|p| Vec3::Z * p.x).collect(), 0.003),
        ("diagonal", uniform(3000, 8).into_iter().map(|p| Vec3::splat(p.x - 0.5)).collect(), 0.003),
        ("plane", uniform(5000, 9).into_iter().map(|p| Vec3::new(p.x, p.y, 0.25)).collect(), 0.02),
        ("tilted plane", uniform(5000, 9).into_iter().map(|p| Vec3::new(p.x, p.y, p.x + p.y)).collect(), 0.02),
        ("lattice", (0..2197).map(lattice).collect(), 2.0),
        (
            "spiral of all scales",
            (0..2000).map(|i| Vec3::new(1.0, -0.5, 0.1) * 1.05_f32.powi(i - 1200)).collect(),
            0.01,
        ),
        ("far apart", moved(Vec3::ZERO, 1.0).chain(moved(Vec3::new(1e6, -1e5, 3e4), 100.0)).collect(), 0.1),
        ("far away", moved(Vec3::splat(1e4), 1.0).collect(), 0.1),
        ("radius lost", moved(Vec3::new(3e7, -3e7, 1e7), 100.0).collect(), 1.0),
    ]
}

/// Points to ask about: of the set, beside it, and far from it.
pub(super) fn queries(positions: &[Vec3], radius: f32) -> Vec<Vec3> {
    let mut rng = Rng::keyed(99, 0, 0);
    let mut queries = uniform(20, 98);
    queries.extend([Vec3::ZERO, Vec3::splat(1e9), Vec3::new(-1e30, 0.0, 1e30), Vec3::splat(f32::MAX)]);
    for _ in 0..if positions.is_empty() { 0 } else { 100 } {
        let p = positions[rng.bits() as usize % positions.len()];
        queries.push(p);
        queries.push(p + 2.0 * radius * rng.f32() * warp::square_to_sphere(rng.vec2()));
        // On the boundary, as well as it can be met.
        queries.push(p + radius * warp::square_to_sphere(rng.vec2()));
        queries.push(p + radius * [Vec3::X, Vec3::NEG_Y, Vec3::Z][rng.bits() as usize % 3]);
    }
    queries
}

/// As users compute it, in lanes or not.
pub(super) fn squared(a: Vec3, b: Vec3) -> f32 {
    let d = a - b;
    d.x * d.x + d.y * d.y + d.z * d.z
}

/// Points that are not finite, in every way.
pub(super) fn not_finite() -> Vec<Vec3> {
    let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
    (0..64)
        .map(|i| Vec3::from_array([i & 3, i >> 2 & 3, i >> 4].map(|k| *bad.get(k).unwrap_or(&0.5))))
        .take(63)
        .collect()
}

pub(super) fn with_threads<T: Send>(threads: usize, run: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(run)
}
