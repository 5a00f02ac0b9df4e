//! A binary tree over the finite emitters (Conty Estevez and Kulla 2018), walked by importance.

use super::bound::{Importance, LightBound};
use crate::math::Vec3;

/// Buckets a split is tried at, along each axis.
const BUCKETS: usize = 12;
/// Beyond this depth the tree splits in the middle, so that a trail of bits fits 64.
const DEEP: u32 = 32;

/// A node; the first child follows its parent.
#[derive(Clone, Copy, Debug)]
struct Node {
    importance: Importance,
    /// Index of the second child, or the emitter when `leaf`.
    link: u32,
    leaf: bool,
}

/// The tree. Every emitter is one leaf.
#[derive(Debug, Default)]
pub struct LightTree {
    nodes: Vec<Node>,
    /// By emitter: the turns from the root to its leaf, the first in the lowest bit; `None` for emitters not in the tree.
    trails: Vec<Option<u64>>,
}

impl LightTree {
    /// The tree over `(emitter, bound)`; emitters of zero intensity stay outside. `count` is the number of all emitters.
    pub fn new(bounds: &[(u32, LightBound)], count: usize) -> Self {
        let mut tree = Self { nodes: Vec::with_capacity(2 * bounds.len()), trails: vec![None; count] };
        let mut items: Vec<_> = bounds.iter().filter(|(_, bound)| bound.intensity > 0.0).copied().collect();
        if !items.is_empty() {
            tree.build(&mut items, 0, 0);
        }
        tree
    }

    /// Whether no emitter is in the tree.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    fn build(&mut self, items: &mut [(u32, LightBound)], trail: u64, depth: u32) -> LightBound {
        let index = self.nodes.len();
        if let [(emitter, bound)] = items {
            self.nodes.push(Node { importance: (&*bound).into(), link: *emitter, leaf: true });
            self.trails[*emitter as usize] = Some(trail);
            return *bound;
        }
        let middle = if depth < DEEP { split(items) } else { items.len() / 2 };
        let (first, second) = items.split_at_mut(middle);
        // The parent's bound is known only after its children: hold its place.
        self.nodes.push(Node { importance: (&first[0].1).into(), link: 0, leaf: false });
        let a = self.build(first, trail, depth + 1);
        let link = self.nodes.len() as u32;
        let b = self.build(second, trail | 1 << depth, depth + 1);
        let bound = a.union(&b);
        self.nodes[index] = Node { importance: (&bound).into(), link, leaf: false };
        bound
    }

    /// An emitter chosen by `importance` with the number `u`, and the probability of that choice. `None` in an empty tree.
    #[inline]
    pub fn select(&self, importance: impl Fn(&Importance) -> f32, mut u: f32) -> Option<(u32, f32)> {
        let mut index = 0;
        let mut probability = 1.0;
        loop {
            let node = self.nodes.get(index)?;
            if node.leaf {
                return Some((node.link, probability));
            }
            let second = node.link as usize;
            let p = self.first_share(index, second, &importance);
            if u < p {
                u /= p;
                probability *= p;
                index += 1;
            } else {
                u = (u - p) / (1.0 - p);
                probability *= 1.0 - p;
                index = second;
            }
            u = u.min(1.0 - f32::EPSILON);
        }
    }

    /// Probability that [`LightTree::select`] chooses `emitter`.
    #[inline]
    pub fn probability(&self, importance: impl Fn(&Importance) -> f32, emitter: u32) -> f32 {
        let Some(mut trail) = self.trails[emitter as usize] else { return 0.0 };
        let mut index = 0;
        let mut probability = 1.0;
        while !self.nodes[index].leaf {
            let second = self.nodes[index].link as usize;
            let p = self.first_share(index, second, &importance);
            (index, probability) =
                if trail & 1 == 0 { (index + 1, probability * p) } else { (second, probability * (1.0 - p)) };
            trail >>= 1;
        }
        probability
    }

    /// Probability of the first child. Children without importance (nothing there can be lit) share evenly, so that the
    /// probabilities of all emitters sum to one.
    #[inline(always)]
    fn first_share(&self, index: usize, second: usize, importance: &impl Fn(&Importance) -> f32) -> f32 {
        let a = importance(&self.nodes[index + 1].importance);
        let b = importance(&self.nodes[second].importance);
        if a + b > 0.0 { a / (a + b) } else { 0.5 }
    }
}

/// Reorders `items` and returns the size of the first part: the cheapest bucket split by the surface area orientation
/// heuristic (Conty Estevez and Kulla 2018, equation 2), or the middle when the emitters do not lie apart.
fn split(items: &mut [(u32, LightBound)]) -> usize {
    let centres = crate::math::Aabb::from_points(items.iter().map(|(_, b)| b.bounds.centre()));
    let extent = centres.extent();
    let bucket = |b: &LightBound, axis: usize| {
        let at = (b.bounds.centre()[axis] - centres.min[axis]) / extent[axis];
        ((at * BUCKETS as f32) as usize).min(BUCKETS - 1)
    };
    let mut best: Option<(f32, usize, usize)> = None;
    for axis in (0..3).filter(|&axis| extent[axis] > 0.0) {
        let mut buckets: [Option<LightBound>; BUCKETS] = [None; BUCKETS];
        for (_, bound) in items.iter() {
            join(&mut buckets[bucket(bound, axis)], bound);
        }
        // Thin boxes are regularised: cutting across the longest side is cheapest.
        let stretch = extent.max_element() / extent[axis];
        let mut after = [0.0; BUCKETS];
        let mut group = None;
        for i in (1..BUCKETS).rev() {
            buckets[i].iter().for_each(|b| join(&mut group, b));
            after[i] = group.as_ref().map_or(0.0, cost);
        }
        let mut group = None;
        for i in 1..BUCKETS {
            buckets[i - 1].iter().for_each(|b| join(&mut group, b));
            let both = stretch * (group.as_ref().map_or(0.0, cost) + after[i]);
            if best.is_none_or(|(least, ..)| both < least) {
                best = Some((both, axis, i));
            }
        }
    }
    let Some((_, axis, at)) = best else { return items.len() / 2 };
    items.sort_by_key(|(_, bound)| bucket(bound, axis) >= at);
    // The first and the last bucket hold at least one emitter each, so neither part is empty.
    items.partition_point(|(_, bound)| bucket(bound, axis) < at)
}

fn join(group: &mut Option<LightBound>, bound: &LightBound) {
    *group = Some(group.map_or(*bound, |g| g.union(bound)));
}

fn cost(bound: &LightBound) -> f32 {
    let e = bound.bounds.extent();
    // The diagonal keeps flat and thin groups from costing nothing.
    let area = e.dot(Vec3::new(e.y, e.z, e.x)) + e.length_squared();
    bound.intensity * bound.orientation_measure() * area
}
