use super::*;
use crate::math::Rng;
use crate::math::lanes::{Kernel, Level};
use std::collections::BTreeSet;

fn random_boxes(count: usize, seed: u64, scale: f32) -> Vec<Aabb> {
    let mut rng = Rng::keyed(seed, 0, 0);
    let mut vec3 = |s: f32| Vec3::new(rng.f32() - 0.5, rng.f32() - 0.5, rng.f32() - 0.5) * s;
    (0..count)
        .map(|i| {
            let c = vec3(20.0);
            // Some flat, some points.
            let mut e = vec3(scale).abs();
            e[i % 3] *= (i % 5 != 0) as u32 as f32;
            if i % 11 == 0 {
                e = Vec3::ZERO;
            }
            Aabb { min: c - e, max: c + e }
        })
        .collect()
}

fn random_ray(rng: &mut Rng) -> Ray {
    let mut vec3 = || Vec3::new(rng.f32() - 0.5, rng.f32() - 0.5, rng.f32() - 0.5);
    let (origin, mut direction) = (vec3() * 30.0, vec3());
    if rng.f32() < 0.3 {
        direction[(rng.bits() % 3) as usize] = if rng.f32() < 0.5 { 0.0 } else { -0.0 };
    }
    Ray { origin, direction: direction.normalize() }
}

/// The leaves visited, in order.
struct Visited<'a> {
    bvh: &'a Bvh,
    query: Query,
}

#[derive(Clone, Copy)]
enum Query {
    Nearest(Ray, f32),
    Along(Ray, f32),
    Overlapping(Aabb),
}

impl Kernel for Visited<'_> {
    type Output = Vec<u32>;
    #[inline(always)]
    fn run<L: Lanes>(self) -> Vec<u32> {
        let mut leaves = Vec::new();
        let mut visit = |leaf: u32, t_max: f32| {
            leaves.push(leaf);
            t_max
        };
        match self.query {
            Query::Nearest(ray, t_max) => self.bvh.nearest::<L>(&ray, t_max, &mut visit),
            Query::Along(ray, t_max) => self.bvh.along::<L>(&ray, t_max, &mut visit),
            Query::Overlapping(region) => self.bvh.overlapping::<L>(region, &mut visit),
        }
        leaves
    }
}

fn visited(bvh: &Bvh, query: Query) -> Vec<u32> {
    let mut results = Level::available().iter().map(|level| level.run(Visited { bvh, query }));
    let first = results.next().unwrap();
    assert!(results.all(|r| r == first), "levels differ");
    first
}

/// Whether the ray touches the closed box, in double precision.
fn touches(b: &Aabb, ray: &Ray, t_max: f32) -> bool {
    let (mut t0, mut t1) = (0.0_f64, t_max as f64);
    for i in 0..3 {
        let (lo, hi) = (b.min[i] as f64 - ray.origin[i] as f64, b.max[i] as f64 - ray.origin[i] as f64);
        let d = ray.direction[i] as f64;
        if d == 0.0 {
            if lo > 0.0 || hi < 0.0 {
                return false;
            }
        } else {
            t0 = t0.max((lo / d).min(hi / d));
            t1 = t1.min((lo / d).max(hi / d));
        }
    }
    t0 <= t1
}

fn items(bvh: &Bvh, leaves: &[u32]) -> BTreeSet<u32> {
    leaves.iter().flat_map(|l| bvh.order()[bvh.leaf(*l)].iter().copied()).collect()
}

#[test]
fn no_box_on_the_way_is_missed_and_few_others_are_visited() {
    for (count, scale) in [(1, 1.0), (7, 1.0), (9, 3.0), (300, 1.0), (5000, 0.3)] {
        let boxes = random_boxes(count, count as u64, scale);
        let bvh = Bvh::build(&boxes);
        let mut rng = Rng::keyed(1, 2, count as u64);
        for i in 0..300 {
            let ray = random_ray(&mut rng);
            let t_max = if i % 3 == 0 { f32::INFINITY } else { 30.0 * rng.f32() };
            for query in [Query::Nearest(ray, t_max), Query::Along(ray, t_max)] {
                let leaves = visited(&bvh, query);
                let seen = items(&bvh, &leaves);
                for (j, b) in boxes.iter().enumerate() {
                    assert!(!touches(b, &ray, t_max) || seen.contains(&(j as u32)), "{b:?} {ray:?}");
                }
                // Only leaves whose own box is met, give or take the slack.
                for leaf in leaves {
                    let around =
                        bvh.order()[bvh.leaf(leaf)].iter().fold(Aabb::EMPTY, |b, i| b.union(boxes[*i as usize]));
                    let pad = Vec3::splat(1e-4);
                    assert!(touches(&Aabb { min: around.min - pad, max: around.max + pad }, &ray, t_max));
                }
            }
        }
    }
}

#[test]
fn rays_in_the_planes_of_faces_meet_the_box() {
    let unit = Aabb { min: Vec3::ZERO, max: Vec3::ONE };
    let bvh = Bvh::build(&[unit]);
    for zero in [0.0, -0.0] {
        for x in [0.0, 1.0] {
            for backward in [1.0, -1.0] {
                let origin = Vec3::new(x, 0.5, 0.5 - 5.0 * backward);
                let ray = Ray { origin, direction: Vec3::new(zero, zero, backward) };
                assert_eq!(visited(&bvh, Query::Nearest(ray, f32::INFINITY)), [0]);
                let edge = Ray { origin: Vec3::new(x, x, origin.z), ..ray };
                assert_eq!(visited(&bvh, Query::Along(edge, 10.0)), [0]);
                let beside = Ray { origin: Vec3::new(2.0 * x - 0.5, 0.5, origin.z), ..ray };
                assert!(visited(&bvh, Query::Nearest(beside, f32::INFINITY)).is_empty());
            }
        }
    }
}

#[test]
fn nearer_boxes_come_first() {
    let boxes: Vec<_> = (0..1000).map(|i| Vec3::splat(i as f32)).map(|c| Aabb { min: c, max: c + 0.5 }).collect();
    let bvh = Bvh::build(&boxes);
    let ray = Ray { origin: Vec3::splat(-1.0), direction: Vec3::ONE.normalize() };
    let leaves = visited(&bvh, Query::Nearest(ray, f32::INFINITY));
    let firsts: Vec<_> = leaves.iter().map(|l| *items(&bvh, &[*l]).first().unwrap()).collect();
    assert!(firsts.is_sorted() && firsts.len() == bvh.leaf_count());
}

#[test]
fn overlapping_boxes_are_visited() {
    let boxes = random_boxes(3000, 5, 0.5);
    let bvh = Bvh::build(&boxes);
    let mut rng = Rng::keyed(6, 0, 0);
    for i in 0..200 {
        let c = random_ray(&mut rng).origin;
        let region = Aabb { min: c, max: c + (i % 2) as f32 };
        let seen = items(&bvh, &visited(&bvh, Query::Overlapping(region)));
        for (j, b) in boxes.iter().enumerate() {
            assert!(b.intersection(region).is_empty() || seen.contains(&(j as u32)));
        }
        assert!(seen.len() < 600);
    }
}

#[test]
fn every_item_is_in_one_leaf() {
    let line = (0..5000).map(|i| Vec3::X * 2.0_f32.powf(i as f32 / 25.0 - 100.0));
    let inputs = [
        vec![],
        random_boxes(8, 1, 1.0),
        random_boxes(10_000, 2, 1.0),
        vec![Aabb { min: Vec3::ONE, max: Vec3::splat(2.0) }; 1000],
        vec![Aabb { min: Vec3::ONE, max: Vec3::ONE }; 17],
        // Each split takes little off such a row: depth must stay bounded.
        line.map(|p| Aabb { min: p, max: p }).collect(),
    ];
    for boxes in inputs {
        let bvh = Bvh::build(&boxes);
        let mut seen = vec![0; boxes.len()];
        for leaf in 0..bvh.leaf_count() as u32 {
            assert!((1..=8).contains(&bvh.leaf(leaf).len()));
            bvh.order()[bvh.leaf(leaf)].iter().for_each(|i| seen[*i as usize] += 1);
        }
        assert!(seen.iter().all(|n| *n == 1));
        fn depth(bvh: &Bvh, child: u32) -> usize {
            if child & LEAF != 0 {
                return 0;
            }
            let node = &bvh.nodes[child as usize];
            (0..8).filter(|i| node.planes[0].0[*i] < f32::INFINITY).map(|i| depth(bvh, node.children[i])).max().unwrap()
                + 1
        }
        assert!(boxes.is_empty() || depth(&bvh, 0) <= MAX_DEPTH);
        let everywhere = Aabb { min: Vec3::NEG_INFINITY, max: Vec3::INFINITY };
        assert_eq!(items(&bvh, &visited(&bvh, Query::Overlapping(everywhere))).len(), boxes.len());
    }
}

#[test]
fn costly_items_are_set_apart() {
    let cube = |(x, r): (f32, f32)| Aabb { min: Vec3::X * x - r, max: Vec3::X * x + r };
    let mut boxes = [(0.0, 3.0); 8].map(cube);
    (boxes[4], boxes[5]) = (cube((-0.5, 2.4)), cube((0.5, 2.5)));
    let alone = |bvh: &Bvh| {
        (0..bvh.leaf_count() as u32).filter(|l| [[4], [5]].iter().any(|a| bvh.order()[bvh.leaf(*l)] == *a)).count()
    };
    assert_eq!(alone(&Bvh::build(&boxes)), 0);
    assert_eq!(alone(&Bvh::build_with_costs(&boxes, |i| if i == 4 || i == 5 { 8 } else { 1 })), 2);
}

/// Six flat walls and two blocks within: every ray meets few of them.
#[test]
fn few_items_get_the_best_tree() {
    let wall = |axis: usize, at: f32| {
        let mut wall = Aabb { min: Vec3::splat(-1.0), max: Vec3::ONE };
        (wall.min[axis], wall.max[axis]) = (at, at);
        wall
    };
    let block = |x: f32| Aabb { min: Vec3::new(x, -1.0, -0.3), max: Vec3::new(x + 0.5, 0.0, 0.3) };
    let mut boxes: Vec<Aabb> = (0..3).flat_map(|axis| [wall(axis, -1.0), wall(axis, 1.0)]).collect();
    boxes.extend([block(-0.7), block(0.2)]);
    let thrice: Vec<Aabb> = boxes.iter().flat_map(|b| [*b; 3]).collect();
    let bvh = Bvh::build(&thrice);
    assert_eq!(bvh.leaf_count(), boxes.len());
    let up = Ray { origin: Vec3::new(0.0, 0.5, 0.0), direction: Vec3::new(0.1, 1.0, 0.1).normalize() };
    assert_eq!(visited(&bvh, Query::Nearest(up, f32::INFINITY)).len(), 1);
}

#[test]
fn empty_boxes_are_left_out() {
    let full = Aabb { min: Vec3::ZERO, max: Vec3::ONE };
    let nan = Aabb { min: Vec3::NAN, max: Vec3::ONE };
    let bvh = Bvh::build(&[Aabb::EMPTY, full, nan]);
    assert_eq!(bvh.order(), [1]);
    let nothing = Bvh::build(&[Aabb::EMPTY]);
    let ray = Ray { origin: Vec3::ZERO, direction: Vec3::X };
    assert!(visited(&nothing, Query::Nearest(ray, 1.0)).is_empty() && nothing.bounds().is_empty());
}

#[test]
fn a_visitor_can_stop_and_shorten() {
    let boxes = random_boxes(2000, 9, 2.0);
    let bvh = Bvh::build(&boxes);
    let ray = Ray { origin: Vec3::splat(-15.0), direction: Vec3::ONE.normalize() };
    let mut visits = 0;
    let mut stop = |_: u32, _: f32| {
        visits += 1;
        Bvh::STOP
    };
    bvh.nearest::<crate::math::lanes::Portable>(&ray, 1e9, &mut stop);
    bvh.along::<crate::math::lanes::Portable>(&ray, 1e9, &mut stop);
    let region = bvh.bounds();
    bvh.overlapping::<crate::math::lanes::Portable>(region, &mut stop);
    assert_eq!(visits, 3);
}

#[test]
fn the_tree_does_not_depend_on_the_number_of_threads() {
    let boxes = random_boxes(150_000, 3, 0.1);
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| format!("{:?}", Bvh::build(&boxes)))
    };
    assert!(with(1) == with(3));
}
