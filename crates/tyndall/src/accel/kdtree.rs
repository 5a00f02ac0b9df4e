//! The k-d tree for the k nearest points (Bentley 1975; leaves as buckets: Friedman, Bentley, Finkel 1977).
//!
//! Points are halved along the widest axis until one or two packets of eight are left, all full but the last one of the
//! tree. Three such levels make one node: the tight boxes of its eight children, tested in lanes. The tree is complete, so
//! that places of children and of packets follow from numbers.

use super::neighbours::Neighbours;
use super::prefetch::prefetch;
use super::resize;
use super::stack::Stack;
use crate::math::lanes::{Kernel, Lanes, Level, Mask, Row, WIDTH};
use crate::math::{Aabb, Vec3};
use rayon::prelude::*;
use std::ops::Range;

/// A k-d tree of points. Memory: at most 20 bytes a point (and 400 in all), for the most points so far.
#[derive(Debug, Default)]
pub struct KdTree {
    packets: Vec<Packet>,
    nodes: Vec<Node>,
    /// The logarithm of the number of leaves: how often points were halved.
    halvings: u32,
}

/// Eight points; unused lanes, and points that are not finite, are infinitely far away.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
struct Packet {
    position: [Row; 3],
    index: [u32; WIDTH],
}

/// A point while the tree is built, in the memory of the packets.
#[derive(Clone, Copy)]
#[repr(C)]
struct Item {
    position: [f32; 3],
    index: u32,
}

const _: () = assert!(size_of::<Packet>() == WIDTH * size_of::<Item>() && align_of::<Packet>() >= align_of::<Item>());

/// The boxes of eight children. The root may have less: then its first lanes are empty boxes.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
struct Node {
    low: [Row; 3],
    high: [Row; 3],
}

/// Ranges of more points are built by several threads.
const PARALLEL: usize = 4096;
/// 2^31 points make 2^28 packets and 2^27 leaves, three halvings a level; each level leaves at most seven children
/// waiting, and the last one may put down eight.
const STACK: usize = 7 * 27 / 3 + WIDTH;

impl KdTree {
    /// Builds the tree. Points with coordinates that are not finite are never found. The result does not depend on the
    /// number of threads. Memory is taken only where there are more points than ever before.
    ///
    /// # Panics
    /// With 2^31 points or more.
    pub fn rebuild(&mut self, positions: &[Vec3]) {
        assert!(positions.len() < 1 << 31, "too many points for one tree");
        let packets = positions.len().div_ceil(WIDTH);
        self.halvings = packets.div_ceil(2).max(1).next_power_of_two().ilog2();
        resize(&mut self.packets, packets, || Packet { position: [Row([0.0; WIDTH]); 3], index: [0; WIDTH] });
        let items = Packet::items(&mut self.packets);
        items.par_chunks_mut(PARALLEL).enumerate().for_each(|(chunk, items)| {
            for (i, item) in items.iter_mut().enumerate() {
                let index = chunk * PARALLEL + i;
                let position =
                    positions.get(index).filter(|p| p.is_finite()).map_or([f32::INFINITY; 3], |p| (*p).into());
                *item = Item { position, index: index as u32 };
            }
        });
        Halving { packets, halvings: self.halvings, level: 0, number: 0 }.sort(items);
        self.packets.par_iter_mut().with_min_len(PARALLEL / WIDTH).for_each(Packet::transpose);
        self.enclose();
    }

    /// How many children the root has; all other nodes have eight.
    #[inline(always)]
    fn root_width(&self) -> usize {
        2 << ((self.halvings + 2) % 3)
    }

    /// The number of a node's child. Leaves are numbered after all nodes.
    #[inline(always)]
    fn child(&self, node: usize, lane: usize) -> usize {
        // Nodes are numbered level by level. With eight children everywhere, node n would have the children from
        // 8 n + 1 on; the root's missing ones shift all numbers by the same amount.
        8 * node + lane + 1 + self.root_width() - 8
    }

    /// The packets of a leaf.
    #[inline(always)]
    fn leaf(&self, leaf: usize) -> Range<usize> {
        Halving::packets(self.packets.len(), self.halvings, leaf)
    }

    /// How many nodes there are above a level of nodes.
    fn above(&self, level: u32) -> usize {
        match level {
            0 => 0,
            _ => 1 + self.root_width() * ((1 << (3 * (level - 1))) - 1) / 7,
        }
    }

    /// Fills the nodes, from the leaves up.
    fn enclose(&mut self) {
        let levels = self.halvings.div_ceil(3);
        let count = self.above(levels);
        let mut nodes = std::mem::take(&mut self.nodes);
        resize(&mut nodes, count, || Node::EMPTY);
        for level in (0..levels).rev() {
            let (first, end) = (self.above(level), self.above(level + 1));
            let (upper, lower) = nodes.split_at_mut(end);
            let missing = if level == 0 { WIDTH - self.root_width() } else { 0 };
            upper[first..].par_iter_mut().with_min_len(64).enumerate().for_each(|(i, node)| {
                *node = Node::EMPTY;
                for lane in missing..WIDTH {
                    let child = self.child(first + i, lane);
                    let bounds = match child.checked_sub(count) {
                        Some(leaf) => {
                            self.packets[self.leaf(leaf)].iter().fold(Aabb::EMPTY, |b, p| b.union(p.bounds()))
                        }
                        None => lower[child - end].bounds(),
                    };
                    node.set(lane, bounds);
                }
            });
        }
        self.nodes = nodes;
    }

    /// Memory held, bytes.
    pub fn memory_bytes(&self) -> usize {
        size_of::<Packet>() * self.packets.capacity() + size_of::<Node>() * self.nodes.capacity()
    }

    /// Finds the `k` points nearest to `x` among those whose distance is at most `max_radius`, in metres; all of them
    /// where there are less than `k`. Of points at the same distance those of lower index come first, so that the answer
    /// depends on the points alone. Distances whose squares overflow are too far.
    pub fn nearest(&self, x: Vec3, k: usize, max_radius: f32, found: &mut Neighbours) {
        let reach = if max_radius >= 0.0 { max_radius * max_radius } else { -1.0 };
        found.start(k, reach.min(f32::MAX));
        if k > 0 && reach >= 0.0 && x.is_finite() && !self.packets.is_empty() {
            Level::dispatch(Nearest { tree: self, x, found });
        }
    }

    /// The distance of the `k`-th nearest point, in metres, or `max_radius` where less than `k` points are within it. A
    /// point of the tree that asks about itself wants `k + 1`.
    pub fn kth_distance(&self, x: Vec3, k: usize, max_radius: f32, scratch: &mut Neighbours) -> f32 {
        self.nearest(x, k, max_radius, scratch);
        match scratch.farthest() {
            Some(squared) if scratch.len() == k => squared.sqrt(),
            _ => max_radius,
        }
    }
}

impl Packet {
    /// The same memory as points one after the other.
    fn items(packets: &mut [Self]) -> &mut [Item] {
        // SAFETY: eight items fill a packet, its alignment suffices for them, and both are numbers without padding, for
        // which any bits do.
        unsafe { std::slice::from_raw_parts_mut(packets.as_mut_ptr().cast(), packets.len() * WIDTH) }
    }

    /// Makes rows of what was written as items.
    fn transpose(&mut self) {
        let mut rows = *self;
        for (lane, item) in Self::items(std::slice::from_mut(self)).iter().enumerate() {
            for (row, coordinate) in rows.position.iter_mut().zip(item.position) {
                row.0[lane] = coordinate;
            }
            rows.index[lane] = item.index;
        }
        *self = rows;
    }

    /// The box around its points.
    fn bounds(&self) -> Aabb {
        let [x, y, z] = &self.position;
        let points = (0..WIDTH).map(|lane| Vec3::new(x.0[lane], y.0[lane], z.0[lane]));
        Aabb::from_points(points.filter(|p| p.is_finite()))
    }

    /// Squared distances from `x`.
    #[inline(always)]
    fn squared<L: Lanes>(&self, x: &[L; 3]) -> L {
        let (dx, dy) = (L::load(&self.position[0]).sub(x[0]), L::load(&self.position[1]).sub(x[1]));
        let dz = L::load(&self.position[2]).sub(x[2]);
        dx.mul(dx).add(dy.mul(dy)).add(dz.mul(dz))
    }
}

/// A range of points that is to be halved until leaves are left.
#[derive(Clone, Copy)]
struct Halving {
    /// Of the whole tree.
    packets: usize,
    /// Of the whole tree.
    halvings: u32,
    level: u32,
    /// Among the ranges of its level.
    number: usize,
}

impl Halving {
    /// The packets of range `number` where `packets` are divided into `2^level` ranges.
    #[inline(always)]
    fn packets(packets: usize, level: u32, number: usize) -> Range<usize> {
        let start = |number: usize| ((number as u64 * packets as u64) >> level) as usize;
        start(number)..start(number + 1)
    }

    fn sort(self, items: &mut [Item]) {
        if self.level == self.halvings {
            return;
        }
        let finite = |b: Aabb, i: &Item| if i.position[0] < f32::INFINITY { b.include(i.position.into()) } else { b };
        let axis = items.iter().fold(Aabb::EMPTY, finite).extent().max_position();
        let [left, right] = [0, 1].map(|side| Self { level: self.level + 1, number: 2 * self.number + side, ..self });
        let middle = WIDTH * Self::packets(self.packets, left.level, left.number).len();
        items.select_nth_unstable_by(middle, |a, b| a.position[axis].total_cmp(&b.position[axis]));
        let (low, high) = items.split_at_mut(middle);
        if low.len() > PARALLEL {
            rayon::join(|| left.sort(low), || right.sort(high));
        } else {
            left.sort(low);
            right.sort(high);
        }
    }
}

impl Node {
    const EMPTY: Self = Self { low: [Row([f32::INFINITY; WIDTH]); 3], high: [Row([f32::NEG_INFINITY; WIDTH]); 3] };

    fn set(&mut self, lane: usize, bounds: Aabb) {
        for axis in 0..3 {
            self.low[axis].0[lane] = bounds.min[axis];
            self.high[axis].0[lane] = bounds.max[axis];
        }
    }

    /// The box around the children.
    fn bounds(&self) -> Aabb {
        let least = |row: Row| row.0.into_iter().fold(f32::INFINITY, f32::min);
        let largest = |row: Row| row.0.into_iter().fold(f32::NEG_INFINITY, f32::max);
        Aabb { min: self.low.map(least).into(), max: self.high.map(largest).into() }
    }

    /// How far a coordinate is from the boxes.
    #[inline(always)]
    fn outside<L: Lanes>(&self, x: &[L; 3], axis: usize) -> L {
        let (low, high) = (L::load(&self.low[axis]), L::load(&self.high[axis]));
        low.sub(x[axis]).max(x[axis].sub(high)).max(L::splat(0.0))
    }

    /// Squared distances from `x`: computed as those of points, they are never larger than those of points within.
    #[inline(always)]
    fn squared<L: Lanes>(&self, x: &[L; 3]) -> L {
        let (dx, dy, dz) = (self.outside(x, 0), self.outside(x, 1), self.outside(x, 2));
        dx.mul(dx).add(dy.mul(dy)).add(dz.mul(dz))
    }
}

/// The search: depth first, nearer boxes first.
struct Nearest<'a> {
    tree: &'a KdTree,
    x: Vec3,
    found: &'a mut Neighbours,
}

impl Kernel for Nearest<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { tree, x, found } = self;
        let x = [L::splat(x.x), L::splat(x.y), L::splat(x.z)];
        let mut stack = Stack::<u64, STACK>::new();
        let mut waiting = 0;
        let mut current = 0;
        loop {
            if let Some(node) = tree.nodes.get(current) {
                let squared = node.squared(&x);
                let mut hits = squared.le(L::splat(found.reach())).bits();
                let squared = squared.store().0;
                let base = waiting;
                while hits != 0 {
                    let lane = hits.trailing_zeros() as usize;
                    hits &= hits - 1;
                    // Squares are not negative: their bits sort as they do.
                    let child = tree.child(current, lane);
                    stack.insert(base, waiting, (squared[lane & 7].to_bits() as u64) << 32 | child as u64);
                    waiting += 1;
                    match tree.nodes.get(child) {
                        Some(node) => prefetch(std::slice::from_ref(node)),
                        None => prefetch(&tree.packets[tree.leaf(child - tree.nodes.len())]),
                    }
                }
            } else {
                for packet in &tree.packets[tree.leaf(current - tree.nodes.len())] {
                    let squared = packet.squared(&x);
                    let mut hits = squared.le(L::splat(found.reach())).bits();
                    let squared = squared.store().0;
                    while hits != 0 {
                        let lane = hits.trailing_zeros() as usize;
                        hits &= hits - 1;
                        found.offer(squared[lane & 7], packet.index[lane & 7]);
                    }
                }
            }
            current = loop {
                if waiting == 0 {
                    return;
                }
                waiting -= 1;
                let key = stack.get(waiting);
                if f32::from_bits((key >> 32) as u32) <= found.reach() {
                    break key as u32 as usize;
                }
            };
        }
    }
}

#[cfg(test)]
#[path = "kdtree_tests.rs"]
mod tests;
