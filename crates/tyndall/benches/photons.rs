//! Rates of photon queries: how many stretches of a ray a second of one core visits, all overlaps included.
//!
//!     cargo bench --bench photons
//!
//! Best of five runs on one thread. The hierarchy along the curve stands beside the one by the surface-area heuristic, of
//! the same boxes, to show what its quick building costs.

use std::hint::black_box;
use std::time::Instant;
use tyndall::Spectrum;
use tyndall::accel::{Bvh, CurveBuilder, Visit};
use tyndall::estimators::Merge;
use tyndall::estimators::merge::{BeamBeam1D, BeamPoint2D, BeamProbe};
use tyndall::math::lanes::{Kernel, Lanes, Level};
use tyndall::math::octahedral::Octahedral;
use tyndall::math::{Aabb, Ray, Rng, Vec3, kernels, warp};
use tyndall::photons::{Attenuation, Beam, BeamRadius, Beams, Flux, Origin, Photon, Points, Store, Tag};

const QUERIES: u64 = 20_000;

fn in_cube(rng: &mut Rng) -> Vec3 {
    2.0 * Vec3::new(rng.f32(), rng.f32(), rng.f32()) - 1.0
}

/// Visits what a probe meets: counts it alone, or takes the kernel of each as well.
struct Count<'a, M: Merge, const KERNEL: bool> {
    merge: &'a M,
    store: &'a M::Store,
    probe: &'a M::Probe,
    rng: Rng,
    hits: u64,
    sum: f32,
}

impl<M: Merge, const KERNEL: bool> Visit for Count<'_, M, KERNEL> {
    const ANNOUNCES: bool = true;

    #[inline(always)]
    fn announce(&self, leaf: u32) {
        self.store.announce(leaf);
    }

    #[inline(always)]
    fn leaf<L: Lanes>(&mut self, leaf: u32, t_max: f32) -> f32 {
        let mut lanes = self.merge.touches::<L>(self.probe, self.store.block(leaf));
        if !KERNEL {
            self.hits += u64::from(lanes.count_ones());
            return t_max;
        }
        while lanes != 0 {
            let lane = lanes.trailing_zeros() as usize & 7;
            lanes &= lanes - 1;
            if let Some(meet) = self.merge.meet(self.probe, self.store, leaf, lane, &mut self.rng) {
                self.hits += 1;
                self.sum += meet.weight;
            }
        }
        t_max
    }
}

struct Query<'a, 'b, M: Merge, const KERNEL: bool>(&'a mut Count<'b, M, KERNEL>, BeamProbe);

impl<M: Merge<Probe = BeamProbe>, const KERNEL: bool> Kernel for Query<'_, '_, M, KERNEL> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        self.0.store.bvh().along::<L>(&self.1.ray, self.1.length, self.0);
    }
}

/// Only the leaves.
struct Leaves(u64);

impl Visit for Leaves {
    const ANNOUNCES: bool = true;

    #[inline(always)]
    fn leaf<L: Lanes>(&mut self, _leaf: u32, t_max: f32) -> f32 {
        self.0 += 1;
        t_max
    }
}

struct Traverse<'a>(&'a Bvh, BeamProbe, &'a mut Leaves);

impl Kernel for Traverse<'_> {
    type Output = ();
    #[inline(always)]
    fn run<L: Lanes>(self) {
        self.0.along::<L>(&self.1.ray, self.1.length, self.2);
    }
}

fn probe(i: u64) -> BeamProbe {
    let mut rng = Rng::keyed(7, 7, i);
    let (origin, direction) = (in_cube(&mut rng), warp::square_to_sphere(rng.vec2()));
    BeamProbe { ray: Ray { origin, direction }, length: 0.5 }
}

/// Runs five times; prints thousands of queries per second.
fn best(what: &str, mut run: impl FnMut() -> f64) {
    let mut best = f64::INFINITY;
    let mut per_query = 0.0;
    for _ in 0..5 {
        let started = Instant::now();
        per_query = run();
        best = best.min(started.elapsed().as_secs_f64());
    }
    println!("{what:44} {:7.0} k queries/s, {per_query:.1} each", QUERIES as f64 / best * 1e-3);
}

fn queries<M: Merge<Probe = BeamProbe>, const KERNEL: bool>(what: &str, merge: &M, store: &M::Store) {
    best(what, || {
        let mut hits = 0;
        for i in 0..QUERIES {
            let probe = probe(i);
            let rng = Rng::keyed(1, 1, i);
            let mut count = Count::<M, KERNEL> { merge, store, probe: &probe, rng, hits: 0, sum: 0.0 };
            Level::dispatch(Query(&mut count, probe));
            hits += count.hits;
            black_box(count.sum);
        }
        hits as f64 / QUERIES as f64
    });
}

fn leaves(what: &str, bvh: &Bvh) {
    best(what, || {
        let mut leaves = Leaves(0);
        (0..QUERIES).for_each(|i| Level::dispatch(Traverse(bvh, probe(i), &mut leaves)));
        leaves.0 as f64 / QUERIES as f64
    });
}

fn timed<T>(what: &str, work: impl FnOnce() -> T) -> T {
    let started = Instant::now();
    let result = work();
    println!("{what:44} {:7.3} s", started.elapsed().as_secs_f64());
    result
}

fn main() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    pool.install(|| {
        let kernel = kernels::Kernel::Epanechnikov;
        let photons: Vec<Photon> = (0..1_000_000)
            .map(|i| {
                let mut rng = Rng::keyed(1, 2, i);
                Photon {
                    position: in_cube(&mut rng),
                    radius: 0.01,
                    flux: Flux::new(Spectrum::ONE),
                    direction: Octahedral::new(Vec3::X),
                    tag: Tag::new(None, 0, Origin::Direct),
                }
            })
            .collect();
        let mut points = Points::default();
        timed("1 M points, first build", || points.rebuild(&photons));
        timed("1 M points, build again", || points.rebuild(&photons));
        println!("{:44} {:7.1} bytes a point", "", points.memory_bytes() as f64 / photons.len() as f64);
        queries::<_, false>("1 M points, radius 0.01, length 0.5", &BeamPoint2D { kernel }, &points);
        queries::<_, true>("   and the kernel of each", &BeamPoint2D { kernel }, &points);
        let cube = |p: Vec3, r: f32| Aabb { min: p - r, max: p + r };
        let boxes: Vec<Aabb> = photons.iter().map(|p| cube(p.position, p.radius)).collect();
        let mut curve = Bvh::default();
        CurveBuilder::default().rebuild(&mut curve, boxes.len(), |i| boxes[i]);
        leaves("   leaves only, along the curve", &curve);
        let heuristic = timed("   build by surface-area heuristic", || Bvh::build(&boxes));
        leaves("   leaves only, surface-area heuristic", &heuristic);
        drop((photons, points, boxes, curve, heuristic));

        let beams: Vec<Beam> = (0..100_000)
            .map(|i| {
                let mut rng = Rng::keyed(3, 4, i);
                Beam {
                    origin: in_cube(&mut rng),
                    direction: warp::square_to_sphere(rng.vec2()),
                    length: -0.3 * (1.0 - rng.f32()).ln(),
                    flux: Flux::new(Spectrum::ONE),
                    attenuation: Attenuation::Rate(0.0),
                    tag: Tag::new(None, 0, Origin::Direct),
                    width: Default::default(),
                }
            })
            .collect();
        let mut store = Beams::default();
        timed("100 k beams, first build", || store.rebuild(&beams, BeamRadius::Fixed(0.003)));
        timed("100 k beams, build again", || store.rebuild(&beams, BeamRadius::Fixed(0.003)));
        let (each, bytes) = (store.piece_count() as f64 / 1e5, store.memory_bytes() as f64 / 1e5);
        println!("{:44} {each:7.1} pieces and {bytes:.0} bytes a beam", "");
        queries::<_, false>("100 k beams, radius 0.003, length 0.5", &BeamBeam1D { kernel }, &store);
        queries::<_, true>("   and the kernel of each", &BeamBeam1D { kernel }, &store);
    });
}
