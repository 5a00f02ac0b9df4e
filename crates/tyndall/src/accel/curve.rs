//! Building the hierarchy quickly: items sorted along a space-filling curve, eight at a time.
//!
//! Neighbours on the Hilbert curve are neighbours in space, so that consecutive items make tight boxes, and consecutive boxes
//! too (Lauterbach et al. 2009 with the Morton curve). Runs of the curve are then halved across their longest extents, which
//! makes leaves rounder than the curve does. The tree is complete: no search, no leaf but the last one with a lane left over.
//! It suits many small items of like size; the surface-area heuristic suits everything, at several times the time.

use super::bvh::{Bvh, LEAF, Node};
use crate::math::lanes::WIDTH;
use crate::math::{Aabb, Vec3};
use rayon::prelude::*;

/// Bits of the curve for each axis: finer cells than those of as many items as there may be, spread evenly.
const BITS: u32 = 12;
/// Bits below the curve's for the number of an item.
const ITEM_BITS: u32 = 64 - 3 * BITS;

/// Items for a thread to take at a time.
const CHUNK: usize = 4096;

/// Consecutive items on the curve to arrange by halving, a power of the width.
const HALVED: usize = WIDTH.pow(3);

/// Memory for building, to be used again.
#[derive(Debug, Default)]
pub struct CurveBuilder {
    /// Places on the curve, with the items' numbers in the low bits.
    keys: Vec<u64>,
    boxes: Vec<Aabb>,
}

impl CurveBuilder {
    /// Memory held, bytes.
    pub fn memory_bytes(&self) -> usize {
        self.keys.capacity() * size_of::<u64>() + self.boxes.capacity() * size_of::<Aabb>()
    }

    /// Makes `bvh` the hierarchy of `count` boxes, each asked for by its number, several times. Empty boxes are left out.
    /// Memory is re-used. The result does not depend on the number of threads.
    ///
    /// # Panics
    /// With more than 2^28 boxes.
    pub fn rebuild(&mut self, bvh: &mut Bvh, count: usize, bounds: impl Fn(usize) -> Aabb + Sync) {
        assert!(count <= 1 << ITEM_BITS, "too many items for one hierarchy");
        let items = || (0..count).into_par_iter().with_min_len(CHUNK);
        let all = items().map(&bounds).filter(|b| !b.is_empty()).reduce(|| Aabb::EMPTY, Aabb::union);
        bvh.nodes.clear();
        bvh.order.clear();
        bvh.starts.clear();
        bvh.starts.push(0);
        bvh.bounds = (!all.is_empty()).then_some(all);
        if all.is_empty() {
            return;
        }
        bvh.largest = all.min.abs().max(all.max.abs()).max_element();

        // One scale for all axes, so that the curve's cells are cubes.
        let scale = ((1u32 << BITS) as f32 * 0.999_99 / all.extent().max_element()).min(f32::MAX);
        self.keys.clear();
        let key = |i: usize| {
            let b = bounds(i);
            let cell = (b.centre() - all.min) * scale;
            let place = hilbert([cell.x as u32, cell.y as u32, cell.z as u32]);
            (!b.is_empty()).then_some(place << ITEM_BITS | i as u64)
        };
        self.keys.par_extend(items().filter_map(key));
        // All keys are different: any sort gives the same order.
        self.keys.par_sort_unstable();
        bvh.order.par_extend(self.keys.par_iter().map(|key| (key & ((1 << ITEM_BITS) - 1)) as u32));
        bvh.order.par_chunks_mut(HALVED).for_each(|items| halve(items, &bounds));

        let count = bvh.order.len();
        let leaves = count.div_ceil(WIDTH);
        bvh.starts.extend((1..=leaves).map(|leaf| (leaf * WIDTH).min(count) as u32));
        self.boxes.clear();
        let leaf_box = |items: &[u32]| items.iter().fold(Aabb::EMPTY, |a, &i| a.union(bounds(i as usize)));
        self.boxes.par_extend(bvh.order.par_chunks(WIDTH).map(leaf_box));
        self.stack(bvh, leaves);
    }

    /// Makes `bvh` the hierarchy of the same items as `other`, which has been made here, in the same leaves with other boxes.
    pub fn rebuild_like(&mut self, bvh: &mut Bvh, other: &Bvh, leaf_box: impl Fn(usize) -> Aabb + Send + Sync) {
        bvh.nodes.clear();
        bvh.order.clone_from(&other.order);
        bvh.starts.clone_from(&other.starts);
        bvh.bounds = None;
        let leaves = other.leaf_count();
        if leaves == 0 {
            return;
        }
        self.boxes.clear();
        self.boxes.par_extend((0..leaves).into_par_iter().with_min_len(CHUNK / WIDTH).map(leaf_box));
        let all = self.boxes.par_iter().copied().reduce(|| Aabb::EMPTY, Aabb::union);
        bvh.bounds = Some(all);
        bvh.largest = all.min.abs().max(all.max.abs()).max_element();
        self.stack(bvh, leaves);
    }

    /// The nodes over so many leaves, whose boxes are at hand.
    fn stack(&mut self, bvh: &mut Bvh, leaves: usize) {
        let mut levels = vec![(0, leaves)];
        while levels.last().is_some_and(|(_, len)| *len > WIDTH) {
            let (start, len) = levels[levels.len() - 1];
            let next = self.boxes.len();
            for first in (start..start + len).step_by(WIDTH) {
                let last = (first + WIDTH).min(start + len);
                let joined = self.boxes[first..last].iter().fold(Aabb::EMPTY, |a, b| a.union(*b));
                self.boxes.push(joined);
            }
            levels.push((next, self.boxes.len() - next));
        }
        // Nodes from the root down; the children of level l are the boxes of level l.
        bvh.nodes.push(Node::empty());
        let mut first_node = 0;
        for (depth, &(start, len)) in levels.iter().enumerate().rev() {
            let parents = len.div_ceil(WIDTH);
            let next = first_node + parents;
            if depth > 0 {
                bvh.nodes.resize_with(next + len, Node::empty);
            }
            let boxes = &self.boxes[start..start + len];
            let fill = |(i, (node, boxes)): (usize, (&mut Node, &[Aabb]))| {
                for (lane, b) in boxes.iter().enumerate() {
                    let child = i * WIDTH + lane;
                    node.set(lane, *b, if depth > 0 { (next + child) as u32 } else { child as u32 | LEAF });
                }
            };
            let nodes = &mut bvh.nodes[first_node..next];
            nodes.par_iter_mut().zip(boxes.par_chunks(WIDTH)).with_min_len(CHUNK / WIDTH).enumerate().for_each(fill);
            first_node = next;
        }
    }
}

/// Orders items so that every run of 8, 16, 32, ... is one side of a cut across the longest extent of its parent's centres.
fn halve(items: &mut [u32], bounds: &impl Fn(usize) -> Aabb) {
    let mut places = [(Vec3::ZERO, 0); HALVED];
    let places = &mut places[..items.len()];
    for (place, &item) in places.iter_mut().zip(&*items) {
        *place = (bounds(item as usize).centre(), item);
    }
    halve_places(places);
    for (item, place) in items.iter_mut().zip(places) {
        *item = place.1;
    }
}

fn halve_places(places: &mut [(Vec3, u32)]) {
    if places.len() <= WIDTH {
        return;
    }
    let half = places.len().next_power_of_two() / 2;
    let (min, max) = places.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(a, b), (p, _)| (a.min(*p), b.max(*p)));
    let axis = (max - min).max_position();
    places.select_nth_unstable_by(half, |a, b| a.0[axis].total_cmp(&b.0[axis]).then(a.1.cmp(&b.1)));
    let (left, right) = places.split_at_mut(half);
    halve_places(left);
    halve_places(right);
}

/// The place of a cell along the Hilbert curve (Skilling 2004), without branches: coordinates have no pattern to predict.
#[inline]
fn hilbert(cell: [u32; 3]) -> u64 {
    let mut x = cell.map(|c| c.min((1 << BITS) - 1));
    // From the coarsest sub-cubes to the finest, undo what the curve does in them: reflect or exchange axes.
    for level in (1..BITS).rev() {
        let below = (1 << level) - 1;
        for axis in 0..3 {
            let reflect = (x[axis] >> level & 1).wrapping_neg();
            let swap = (x[0] ^ x[axis]) & below & !reflect;
            x[axis] ^= swap;
            x[0] ^= swap | (below & reflect);
        }
    }
    // Gray code.
    x[1] ^= x[0];
    x[2] ^= x[1];
    let flip = (1..BITS).fold(0, |flip, level| flip ^ ((1 << level) - 1) & (x[2] >> level & 1).wrapping_neg());
    let [a, b, c] = x.map(|axis| spread(axis ^ flip));
    a << 2 | b << 1 | c
}

/// Two zeros before every bit.
#[inline(always)]
fn spread(x: u32) -> u64 {
    let mut x = u64::from(x) & 0xffff;
    x = (x | x << 16) & 0x0000_0000_ff00_00ff;
    x = (x | x << 8) & 0x0000_00f0_0f00_f00f;
    x = (x | x << 4) & 0x0000_0c30_c30c_30c3;
    (x | x << 2) & 0x0000_2492_4924_9249
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::Visit;
    use crate::math::lanes::{Kernel, Lanes, Level};
    use crate::math::{Ray, Rng, Vec3, warp};

    #[test]
    fn the_curve_visits_every_cell_and_steps_to_a_neighbour() {
        // The first 16^3 cells are a sub-cube of the curve.
        let n = 16u32;
        let mut cells: Vec<(u64, [i64; 3])> =
            (0..n * n * n).map(|i| [i % n, i / n % n, i / n / n]).map(|c| (hilbert(c), c.map(i64::from))).collect();
        cells.sort_unstable();
        for (i, (key, _)) in cells.iter().enumerate() {
            assert_eq!(*key, i as u64);
        }
        for pair in cells.windows(2) {
            let step: i64 = (0..3).map(|k| (pair[0].1[k] - pair[1].1[k]).abs()).sum();
            assert_eq!(step, 1, "{pair:?}");
        }
    }

    struct Collect<'a>(&'a Bvh, Vec<u32>);

    impl Visit for Collect<'_> {
        fn leaf<L: Lanes>(&mut self, leaf: u32, t_max: f32) -> f32 {
            self.1.extend(&self.0.order()[self.0.leaf(leaf)]);
            t_max
        }
    }

    struct Along<'a>(&'a Bvh, Ray, f32);

    impl Kernel for Along<'_> {
        type Output = Vec<u32>;
        fn run<L: Lanes>(self) -> Vec<u32> {
            let mut found = Collect(self.0, Vec::new());
            self.0.along::<L>(&self.1, self.2, &mut found);
            found.1.sort_unstable();
            found.1
        }
    }

    #[test]
    fn rays_find_every_box_they_meet() {
        let mut builder = CurveBuilder::default();
        let mut bvh = Bvh::default();
        for count in [0, 1, 7, 8, 9, 64, 65, 513, 5000] {
            let mut rng = Rng::keyed(3, count, 0);
            let mut point = || Vec3::new(rng.f32(), rng.f32(), rng.f32()) * 10.0 - 3.0;
            let mut boxes: Vec<Aabb> = (0..count)
                .map(|i| {
                    let (centre, half) = (point(), 0.02 * point().abs());
                    // Some coincide.
                    let centre = if i % 5 == 0 { Vec3::ONE } else { centre };
                    Aabb { min: centre - half, max: centre + half }
                })
                .collect();
            if count > 9 {
                boxes[3] = Aabb::EMPTY;
            }
            builder.rebuild(&mut bvh, boxes.len(), |i| boxes[i]);
            assert_eq!(bvh.order().len(), boxes.iter().filter(|b| !b.is_empty()).count());
            for i in 0..200 {
                let mut rng = Rng::keyed(4, count, i);
                let direction = warp::square_to_sphere(rng.vec2());
                let ray = Ray { origin: Vec3::ONE + 0.1 * warp::square_to_sphere(rng.vec2()), direction };
                let found = Level::dispatch(Along(&bvh, ray, 5.0));
                assert!(found.windows(2).all(|p| p[0] < p[1]), "an item is visited twice");
                for (j, b) in (0..).zip(&boxes) {
                    let (a, c) = ((b.min - ray.origin) / direction, (b.max - ray.origin) / direction);
                    let (near, far) = (a.min(c).max_element().max(0.0), a.max(c).min_element().min(5.0));
                    assert!(!(near < far) || b.is_empty() || found.contains(&j), "box {j} of {count} is missed");
                }
            }
        }
    }

    #[test]
    fn the_same_leaves_with_other_boxes() {
        let (mut builder, [mut first, mut again]) = (CurveBuilder::default(), [Bvh::default(), Bvh::default()]);
        for count in [0, 1, 8, 9, 65, 5000] {
            let place = |i: usize| {
                let mut rng = Rng::keyed(2, count, i as u64);
                Vec3::new(rng.f32(), rng.f32(), rng.f32())
            };
            let boxes = |half: f32| move |i: usize| Aabb { min: place(i) - half, max: place(i) + half };
            builder.rebuild(&mut first, count as usize, boxes(0.01));
            let leaf_box = |half: f32| {
                let first = &first;
                move |leaf: usize| {
                    let items = first.leaf(leaf as u32).map(|at| first.order()[at] as usize);
                    items.map(boxes(half)).fold(Aabb::EMPTY, Aabb::union)
                }
            };
            builder.rebuild_like(&mut again, &first, leaf_box(0.01));
            assert_eq!(format!("{first:?}"), format!("{again:?}"));
            builder.rebuild_like(&mut again, &first, leaf_box(0.5));
            let meant = (0..count as usize).map(boxes(0.5)).fold(Aabb::EMPTY, Aabb::union);
            assert!(count == 0 || again.bounds() == meant, "{:?} is not {meant:?}", again.bounds());
        }
    }

    #[test]
    fn threads_do_not_matter() {
        let boxes: Vec<Aabb> = (0..20_000)
            .map(|i| {
                let mut rng = Rng::keyed(1, 1, i);
                let p = Vec3::new(rng.f32(), rng.f32(), rng.f32());
                Aabb { min: p, max: p + 0.01 }
            })
            .collect();
        let build = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let mut bvh = Bvh::default();
            pool.install(|| CurveBuilder::default().rebuild(&mut bvh, boxes.len(), |i| boxes[i]));
            format!("{bvh:?}")
        };
        let one = build(1);
        assert!(one == build(2) && one == build(3));
    }
}
