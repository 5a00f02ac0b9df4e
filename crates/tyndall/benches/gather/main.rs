//! A million points in the unit cube: all within a radius that holds 32 of them, and the 32 nearest. Rates of textbook
//! versions in the same run are printed with ours, for uniform and for clustered points.

mod scalar;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use scalar::{ScalarGrid, ScalarTree};
use std::collections::BinaryHeap;
use std::hint::black_box;
use std::time::{Duration, Instant};
use tyndall::accel::{Grid, KdTree, Neighbours, grid, prefetch};
use tyndall::math::lanes::{Kernel, Lanes, Level, Mask, Row, WIDTH};
use tyndall::math::{Rng, Vec3, warp};

const POINTS: usize = 1_000_000;
const NEAREST: usize = 32;
const QUERIES: usize = 50_000;

fn uniform(count: usize, seed: u64) -> Vec<Vec3> {
    let mut rng = Rng::keyed(seed, 0, 0);
    (0..count).map(|_| Vec3::new(rng.f32(), rng.f32(), rng.f32())).collect()
}

/// Balls of radius up to 0.1, denser towards their centres.
fn clustered(count: usize, seed: u64) -> Vec<Vec3> {
    let centres = uniform(100, 7);
    let mut rng = Rng::keyed(seed, 1, 0);
    (0..count)
        .map(|_| {
            let centre = centres[rng.bits() as usize % centres.len()];
            let offset = 0.1 * rng.f32() * rng.f32() * warp::square_to_sphere(rng.vec2());
            (centre + offset).clamp(Vec3::ZERO, Vec3::ONE)
        })
        .collect()
}

/// The radius within which the given queries find `NEAREST` points on average, by bisection.
fn radius(tree: &KdTree, queries: &[Vec3]) -> f32 {
    let mut found = Neighbours::default();
    let (mut low, mut high) = (0.0, 0.2);
    for _ in 0..16 {
        let middle = 0.5 * (low + high);
        let count = |x: &Vec3| {
            tree.nearest(*x, 100 * NEAREST, middle, &mut found);
            found.len()
        };
        let mean = queries.iter().step_by(100).map(count).sum::<usize>() as f32 / (queries.len() / 100) as f32;
        if mean < NEAREST as f32 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

/// Positions in sorted order, in rows.
struct Rows {
    grid: Grid,
    rows: Vec<[Row; 3]>,
    radius: f32,
}

impl Rows {
    fn new(positions: &[Vec3], radius: f32) -> Self {
        let mut grid = Grid::default();
        grid.rebuild(positions, radius);
        let mut rows = vec![[Row([f32::NAN; WIDTH]); 3]; positions.len().div_ceil(WIDTH)];
        for (i, point) in grid.order().iter().enumerate() {
            for axis in 0..3 {
                rows[i / WIDTH][axis].0[i % WIDTH] = positions[*point as usize][axis];
            }
        }
        Self { grid, rows, radius }
    }
}

/// Number of points within the radius, and the sum of their squared distances.
struct Gather<'a>(&'a Rows, Vec3);

impl Kernel for Gather<'_> {
    type Output = (u32, f32);

    #[inline(always)]
    fn run<L: Lanes>(self) -> (u32, f32) {
        let Self(Rows { grid, rows, radius }, x) = self;
        let [qx, qy, qz] = [L::splat(x.x), L::splat(x.y), L::splat(x.z)];
        let limit = L::splat(radius * radius);
        let (mut count, mut sum) = (0, 0.0);
        let near = grid.near(x);
        for range in near.iter() {
            prefetch(&rows[grid::rows(range)]);
        }
        for range in near.iter() {
            for row in grid::rows(range.clone()) {
                let [px, py, pz] = &rows[row];
                let (dx, dy, dz) = (L::load(px).sub(qx), L::load(py).sub(qy), L::load(pz).sub(qz));
                let squared = dx.mul(dx).add(dy.mul(dy)).add(dz.mul(dz));
                let mut hits = squared.le(limit).bits() & grid::lanes(range.clone(), row);
                count += hits.count_ones();
                let squared = squared.store().0;
                // Hits are taken one by one, as photons are.
                while hits != 0 {
                    sum += squared[hits.trailing_zeros() as usize & 7];
                    hits &= hits - 1;
                }
            }
        }
        (count, sum)
    }
}

/// Time of both on all queries: the sum over short batches of the best of several alternating runs of each, so that
/// other work on the machine does not count.
fn race(queries: &[Vec3], mut ours: impl FnMut(Vec3), mut theirs: impl FnMut(Vec3)) -> (Duration, Duration) {
    let mut sums = (Duration::ZERO, Duration::ZERO);
    for batch in queries.chunks(1000) {
        let mut best = (Duration::MAX, Duration::MAX);
        for _ in 0..3 {
            let start = Instant::now();
            batch.iter().for_each(|x| ours(*x));
            let middle = Instant::now();
            batch.iter().for_each(|x| theirs(*x));
            best = (best.0.min(middle - start), best.1.min(middle.elapsed()));
        }
        sums = (sums.0 + best.0, sums.1 + best.1);
    }
    sums
}

fn report(what: &str, queries: usize, (ours, theirs): (Duration, Duration)) {
    let rate = |time: Duration| queries as f64 / time.as_secs_f64() * 1e-3;
    println!(
        "{what}: {:.0} k queries/s, textbook {:.0}, ratio {:.2}",
        rate(ours),
        rate(theirs),
        theirs.as_secs_f64() / ours.as_secs_f64()
    );
}

/// The best of several, of both.
fn race_builds(mut ours: impl FnMut(), mut theirs: impl FnMut()) -> (Duration, Duration) {
    race(&[Vec3::ZERO], |_| ours(), |_| theirs())
}

fn compare(name: &str, positions: &[Vec3], queries: &[Vec3]) {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    let mut tree = KdTree::default();
    tree.rebuild(positions);
    let radius = radius(&tree, queries);
    let mut grid = Grid::default();
    let builds = pool.install(|| {
        [
            ("grid", race_builds(|| grid.rebuild(positions, radius), || drop(ScalarGrid::build(positions, radius)))),
            ("tree", race_builds(|| tree.rebuild(positions), || drop(ScalarTree::build(positions)))),
        ]
    });
    for (what, (ours, theirs)) in builds {
        println!(
            "{name}, build of {what} on one thread: {:.0} ms, textbook {:.0} ms",
            ours.as_secs_f64() * 1e3,
            theirs.as_secs_f64() * 1e3
        );
    }
    let bytes = |bytes: usize| bytes as f64 / positions.len() as f64;
    println!("{name}, bytes a point: grid {:.1}, tree {:.1}", bytes(grid.memory_bytes()), bytes(tree.memory_bytes()));

    let rows = Rows::new(positions, radius);
    let scalar = ScalarGrid::build(positions, radius);
    let inside: u32 = queries.iter().map(|x| Level::dispatch(Gather(&rows, *x)).0).sum();
    assert_eq!(inside, queries.iter().map(|x| scalar.gather(*x).0).sum::<u32>());
    let (mut covered, mut ranges) = (0, 0);
    for x in queries {
        rows.grid.visit(*x, |range| {
            covered += range.len();
            ranges += 1;
        });
    }
    let each = |count: usize| count as f64 / queries.len() as f64;
    let [inside, covered, ranges] = [inside as usize, covered, ranges].map(each);
    println!("{name}, radius {radius:.4}: {inside:.1} points within, {covered:.1} covered by {ranges:.1} ranges");
    let times = race(
        queries,
        |x| {
            black_box(Level::dispatch(Gather(&rows, x)));
        },
        |x| {
            black_box(scalar.gather(x));
        },
    );
    report(&format!("{name}, fixed radius"), queries.len(), times);

    let scalar = ScalarTree::build(positions);
    let (mut found, mut heap) = (Neighbours::default(), BinaryHeap::new());
    let times = race(
        queries,
        |x| tree.nearest(x, NEAREST, f32::INFINITY, &mut found),
        |x| scalar.nearest(x, NEAREST, &mut heap),
    );
    report(&format!("{name}, {NEAREST} nearest"), queries.len(), times);
}

fn gather(criterion: &mut Criterion) {
    let sets = [
        ("uniform", uniform(POINTS, 1), uniform(QUERIES, 2)),
        ("clustered", clustered(POINTS, 1), clustered(QUERIES, 2)),
    ];
    for (name, positions, queries) in &sets {
        compare(name, positions, queries);
    }
    let mut group = criterion.benchmark_group("million_points");
    group.sample_size(10).throughput(Throughput::Elements(QUERIES as u64));
    for (name, positions, queries) in &sets {
        let mut tree = KdTree::default();
        tree.rebuild(positions);
        let rows = Rows::new(positions, radius(&tree, queries));
        group.bench_function(format!("{name}/radius"), |b| {
            b.iter(|| queries.iter().map(|x| Level::dispatch(Gather(&rows, *x)).1).sum::<f32>());
        });
        let mut found = Neighbours::default();
        group.bench_function(format!("{name}/nearest"), |b| {
            b.iter(|| queries.iter().map(|x| tree.kth_distance(*x, NEAREST, f32::INFINITY, &mut found)).sum::<f32>());
        });
    }
}

criterion_group!(benches, gather);
criterion_main!(benches);
