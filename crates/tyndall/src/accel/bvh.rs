//! The bounding volume hierarchy: eight boxes a node, up to eight items a leaf.
//!
//! [`Bvh::build`] sees boxes only. It answers with an order of the items and with leaves, each a range of at most eight
//! consecutive items in that order: a user keeps one structure-of-arrays packet a leaf, indexed by the leaf's number.

use super::build;
use super::prefetch::prefetch;
use super::refine::FEW;
use super::stack::Stack;
use crate::math::lanes::{Lanes, Mask, Row, WIDTH};
use crate::math::{Aabb, Ray, Vec3};
use std::ops::Range;

/// A bounding volume hierarchy.
#[derive(Debug, Default)]
pub struct Bvh {
    pub(super) nodes: Vec<Node>,
    /// Item numbers, leaf by leaf.
    pub(super) order: Vec<u32>,
    /// Where each leaf starts in `order`, and its length at last.
    pub(super) starts: Vec<u32>,
    pub(super) bounds: Option<Aabb>,
    /// The largest coordinate of the bounds, sign dropped.
    pub(super) largest: f32,
}

/// Eight boxes (rows: smallest x, y, z, largest x, y, z) and what is in them. Unused lanes hold empty boxes.
#[derive(Debug)]
#[repr(C, align(64))]
pub(super) struct Node {
    pub(super) planes: [Row; 6],
    /// A node, or a leaf when [`LEAF`] is set.
    pub(super) children: [u32; WIDTH],
}

pub(super) const LEAF: u32 = 1 << 31;

/// Nodes deeper than this halve their number of packets with each level, ...
pub(super) const FREE_DEPTH: usize = 32;
/// ... and only above this one may their subtrees have any shape, ...
pub(super) const REFINE_DEPTH: usize = 16;
/// ... and 2^31 items make 2^28 packets, so that no path is longer than this.
const MAX_DEPTH: usize = if FREE_DEPTH + 28 > REFINE_DEPTH + FEW { FREE_DEPTH + 28 } else { REFINE_DEPTH + FEW };
/// Each level leaves at most seven children waiting; the last one may put down eight.
const STACK: usize = 7 * MAX_DEPTH + WIDTH;

/// Leaves that wait for their memory.
const ANNOUNCED: usize = 16;

/// What happens at a leaf.
///
/// Closures are visitors too. For the fastest code implement the trait with an `#[inline(always)]` method and do the
/// work in lanes.
pub trait Visit {
    /// Visits the leaf of that number; returns the distance beyond which nothing is wanted any more: `t_max` itself, a
    /// smaller one, or [`Bvh::STOP`].
    fn leaf<L: Lanes>(&mut self, leaf: u32, t_max: f32) -> f32;

    /// Whether what is met soon shall be asked for early: worth it for data larger than the caches.
    const ANNOUNCES: bool = false;

    /// The leaf will be visited soon: [`prefetch`] what the visit reads.
    #[inline(always)]
    fn announce(&self, _leaf: u32) {}
}

impl<F: FnMut(u32, f32) -> f32> Visit for F {
    #[inline(always)]
    fn leaf<L: Lanes>(&mut self, leaf: u32, t_max: f32) -> f32 {
        self(leaf, t_max)
    }
}

impl Bvh {
    /// The answer of a visitor that has seen enough.
    pub const STOP: f32 = f32::NEG_INFINITY;

    /// Builds the hierarchy by binned surface-area heuristic (Wald 2007), with the cost of items counted in packets of
    /// eight. Empty boxes are left out. The result does not depend on the number of threads.
    ///
    /// # Panics
    /// With 2^31 boxes or more.
    pub fn build(bounds: &[Aabb]) -> Self {
        Self::build_with_costs(bounds, |_| 1)
    }

    /// As [`Bvh::build`], with items of different cost, in eighths of a packet of eight: 1 for one of a packet, 8 or so
    /// for one that is visited alone.
    pub fn build_with_costs(bounds: &[Aabb], cost: impl Fn(usize) -> u32) -> Self {
        build::build(bounds, cost)
    }

    /// The items (indices into the boxes given to [`Bvh::build`]), leaf by leaf.
    pub fn order(&self) -> &[u32] {
        &self.order
    }

    /// How many leaves there are.
    pub fn leaf_count(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// Where the leaf's items are in [`Bvh::order`]: one to eight of them.
    #[inline(always)]
    pub fn leaf(&self, leaf: u32) -> Range<usize> {
        self.starts[leaf as usize] as usize..self.starts[leaf as usize + 1] as usize
    }

    /// The box around everything.
    pub fn bounds(&self) -> Aabb {
        self.bounds.unwrap_or(Aabb::EMPTY)
    }

    /// Memory held, bytes.
    pub fn memory_bytes(&self) -> usize {
        size_of_val(&*self.nodes) + size_of_val(&*self.order) + size_of_val(&*self.starts)
    }

    /// Gives up the item order, once the user has arranged the items by it.
    pub fn forget_order(&mut self) {
        self.order = Vec::new();
    }

    /// Visits the leaves whose boxes meet the ray within `[0, t_max]`, nearer boxes first, until the visitor stops.
    ///
    /// The direction need not be a unit vector. No box that the ray touches is missed, be it flat, or the ray parallel
    /// to its faces or inside of one: boxes are widened by a few units in the last place of the largest coordinate of
    /// the ray's start and of the hierarchy.
    #[inline(always)]
    pub fn nearest<L: Lanes>(&self, ray: &Ray, t_max: f32, visit: &mut impl Visit) {
        if self.nodes.is_empty() {
            return;
        }
        let slab = Slab::<L>::new(ray, self.largest);
        let mut t_max = t_max.min(f32::MAX);
        let mut stack = Stack::<u64, STACK>::new();
        let mut waiting = 0;
        let mut current = 0;
        loop {
            if current & LEAF != 0 {
                t_max = visit.leaf::<L>(current & !LEAF, t_max);
            } else {
                let node = self.node(current);
                let (near, mut hits) = slab.meet(node, t_max);
                if hits != 0 {
                    let lane = hits.trailing_zeros() as usize;
                    hits &= hits - 1;
                    if hits == 0 {
                        current = node.children[lane & 7];
                        continue;
                    }
                    let near = near.store().0;
                    // Distances are not negative: their bits sort as they do.
                    let key = |lane: usize| (near[lane & 7].to_bits() as u64) << 32 | node.children[lane & 7] as u64;
                    let mut nearest = key(lane);
                    let base = waiting;
                    while hits != 0 {
                        let next = key(hits.trailing_zeros() as usize);
                        hits &= hits - 1;
                        let farther = nearest.max(next);
                        nearest = nearest.min(next);
                        stack.insert(base, waiting, farther);
                        waiting += 1;
                    }
                    current = nearest as u32;
                    continue;
                }
            }
            current = loop {
                if waiting == 0 {
                    return;
                }
                waiting -= 1;
                let key = stack.get(waiting);
                if f32::from_bits((key >> 32) as u32) <= t_max {
                    break key as u32;
                }
            };
        }
    }

    /// Visits the leaves whose boxes meet the ray within `[0, t_max]`, in no particular order, until the visitor stops.
    /// A smaller answer than `t_max` shortens the rest of the search. Otherwise as [`Bvh::nearest`].
    #[inline(always)]
    pub fn along<L: Lanes>(&self, ray: &Ray, t_max: f32, visit: &mut impl Visit) {
        if self.nodes.is_empty() {
            return;
        }
        let slab = Slab::<L>::new(ray, self.largest);
        self.any::<L, _>(t_max.min(f32::MAX), &slab, visit);
    }

    /// Visits the leaves whose boxes overlap the closed box `region` (a point is a box without extent), in no
    /// particular order, until the visitor answers [`Bvh::STOP`]. The visitor's `t_max` is infinite.
    #[inline(always)]
    pub fn overlapping<L: Lanes>(&self, region: Aabb, visit: &mut impl Visit) {
        if self.nodes.is_empty() {
            return;
        }
        let region = Region::<L> { low: splat(row(region.min).0), high: splat(row(region.max).0) };
        self.any::<L, _>(f32::INFINITY, &region, visit);
    }

    /// Depth-first over the children that `probe` meets, until a leaf answers with a negative distance. Leaves that are
    /// announced wait for a few others to be found, while their memory comes.
    #[inline(always)]
    fn any<L: Lanes, V: Visit>(&self, mut t_max: f32, probe: &impl Probe, visit: &mut V) {
        let mut stack = Stack::<u32, STACK>::new();
        stack.set(0, 0);
        let mut waiting = 1;
        let mut announced = [0; ANNOUNCED];
        let (mut oldest, mut newest) = (0, 0);
        while waiting > 0 {
            waiting -= 1;
            let current = stack.get(waiting);
            if !V::ANNOUNCES && current & LEAF != 0 {
                t_max = visit.leaf::<L>(current & !LEAF, t_max);
                if t_max < 0.0 {
                    return;
                }
                continue;
            }
            let node = self.node(current);
            let mut hits = probe.hits(node, t_max);
            while hits != 0 {
                let child = node.children[hits.trailing_zeros() as usize & 7];
                hits &= hits - 1;
                if V::ANNOUNCES && child & LEAF != 0 {
                    if newest - oldest == ANNOUNCED {
                        t_max = visit.leaf::<L>(announced[oldest % ANNOUNCED], t_max);
                        if t_max < 0.0 {
                            return;
                        }
                        oldest += 1;
                    }
                    visit.announce(child & !LEAF);
                    announced[newest % ANNOUNCED] = child & !LEAF;
                    newest += 1;
                    continue;
                }
                if V::ANNOUNCES {
                    prefetch(std::slice::from_ref(self.node(child)));
                }
                stack.set(waiting, child);
                waiting += 1;
            }
        }
        while oldest != newest && t_max >= 0.0 {
            t_max = visit.leaf::<L>(announced[oldest % ANNOUNCED], t_max);
            oldest += 1;
        }
    }

    #[inline(always)]
    fn node(&self, index: u32) -> &Node {
        debug_assert!((index as usize) < self.nodes.len());
        // SAFETY: the root exists where there are nodes at all, and `children` name nodes of this hierarchy.
        unsafe { self.nodes.get_unchecked(index as usize) }
    }
}

/// What is looked for in boxes. (No closure: those over lanes may fail to be inlined, and then are slow.)
trait Probe {
    /// The boxes that are met, nearer than `t_max`, as bits.
    fn hits(&self, node: &Node, t_max: f32) -> u32;
}

impl<L: Lanes> Probe for Slab<L> {
    #[inline(always)]
    fn hits(&self, node: &Node, t_max: f32) -> u32 {
        self.meet(node, t_max).1
    }
}

/// A box.
struct Region<L> {
    low: [L; 3],
    high: [L; 3],
}

impl<L: Lanes> Probe for Region<L> {
    #[inline(always)]
    fn hits(&self, node: &Node, _: f32) -> u32 {
        node.overlap(&self.low, &self.high)
    }
}

/// Three numbers, each in all lanes.
#[inline(always)]
fn splat<L: Lanes>([x, y, z, ..]: [f32; WIDTH]) -> [L; 3] {
    [L::splat(x), L::splat(y), L::splat(z)]
}

/// A vector in the first lanes.
#[inline(always)]
fn row(v: Vec3) -> Row {
    Row([v.x, v.y, v.z, 1.0, 1.0, 1.0, 1.0, 1.0])
}

/// Where the rows of planes are through which a ray enters and leaves, by axis, in bytes from the first one; by the axes
/// along which the ray goes backward, as bits.
static ROWS: [([usize; 3], [usize; 3]); WIDTH] = {
    const ROW: usize = size_of::<Row>();
    let mut rows = [([0, ROW, 2 * ROW], [3 * ROW, 4 * ROW, 5 * ROW]); WIDTH];
    let mut backward = 0;
    while backward < WIDTH {
        let mut axis = 0;
        while axis < 3 {
            if backward >> axis & 1 == 1 {
                rows[backward] = {
                    let (mut enter, mut exit) = rows[backward];
                    (enter[axis], exit[axis]) = (exit[axis], enter[axis]);
                    (enter, exit)
                };
            }
            axis += 1;
        }
        backward += 1;
    }
    rows
};

/// A ray made ready for slab tests (Kay and Kajiya 1986).
struct Slab<L: Lanes> {
    /// As in [`ROWS`].
    enter: [usize; 3],
    exit: [usize; 3],
    /// The origin, moved so that entries are early, ...
    enter_origin: [L; 3],
    /// ... and exits late.
    exit_origin: [L; 3],
    inverse: [L; 3],
}

impl<L: Lanes> Slab<L> {
    #[inline(always)]
    fn new(ray: &Ray, largest: f32) -> Self {
        // Eight half-units in the last place of the largest number met, coordinate differences included. The slab
        // distances below have an error of three (relative, so no more than three of the way), and triangle tests have
        // a few of the distance.
        let start = ray.origin.abs().max_element();
        let slack = L::splat((2.0 * start + largest) * (8.0 * 0.5 * f32::EPSILON));
        let zero = L::splat(0.0);
        let origin = L::load(&row(ray.origin));
        let inverse = L::splat(1.0).div(L::load(&row(ray.direction)));
        let backward = inverse.lt(zero);
        let by = zero.sub(slack).select(backward, slack);
        let (enter, exit) = ROWS[(backward.bits() & 7) as usize];
        Self {
            enter,
            exit,
            enter_origin: splat(origin.add(by).store().0),
            exit_origin: splat(origin.sub(by).store().0),
            inverse: splat(inverse.store().0),
        }
    }

    /// Where the ray passes the planes through which it enters.
    #[inline(always)]
    fn entry(&self, node: &Node, axis: usize) -> L {
        // SAFETY: `enter` holds the places of the rows 0 to 5.
        let row = unsafe { &*node.planes.as_ptr().byte_add(self.enter[axis]) };
        L::load(row).sub(self.enter_origin[axis]).mul(self.inverse[axis])
    }

    /// Where the ray passes the planes through which it leaves.
    #[inline(always)]
    fn leaving(&self, node: &Node, axis: usize) -> L {
        // SAFETY: `exit` holds the places of the rows 0 to 5.
        let row = unsafe { &*node.planes.as_ptr().byte_add(self.exit[axis]) };
        L::load(row).sub(self.exit_origin[axis]).mul(self.inverse[axis])
    }

    /// Where the ray enters the boxes, and which of them it meets within `[0, t_max]`.
    #[inline(always)]
    fn meet(&self, node: &Node, t_max: f32) -> (L, u32) {
        // A ray in the plane of a face gives 0 * infinity; standing on the left that NaN is dropped, and the slab
        // counts as met.
        let (x, y, z) = (self.entry(node, 0), self.entry(node, 1), self.entry(node, 2));
        let t0 = x.max(y.max(z.max(L::splat(0.0))));
        let (x, y, z) = (self.leaving(node, 0), self.leaving(node, 1), self.leaving(node, 2));
        let t1 = x.min(y.min(z.min(L::splat(t_max))));
        (t0, t0.le(t1).bits())
    }
}

impl Node {
    /// Which boxes overlap the one between `low` and `high`.
    #[inline(always)]
    fn overlap<L: Lanes>(&self, low: &[L; 3], high: &[L; 3]) -> u32 {
        let mut overlap = low[0].le(L::load(&self.planes[3])).and(L::load(&self.planes[0]).le(high[0]));
        for axis in 1..3 {
            let [from, to] = [axis, axis + 3].map(|i| &self.planes[i]);
            overlap = overlap.and(low[axis].le(L::load(to))).and(L::load(from).le(high[axis]));
        }
        overlap.bits()
    }

    /// A node without children.
    pub(super) fn empty() -> Self {
        let (low, high) = (Row([f32::INFINITY; WIDTH]), Row([f32::NEG_INFINITY; WIDTH]));
        Self { planes: [low, low, low, high, high, high], children: [LEAF; WIDTH] }
    }

    /// Fills a lane.
    pub(super) fn set(&mut self, lane: usize, bounds: Aabb, child: u32) {
        let Vec3 { x, y, z } = bounds.min;
        let high = bounds.max;
        for (row, plane) in self.planes.iter_mut().zip([x, y, z, high.x, high.y, high.z]) {
            row.0[lane] = plane;
        }
        self.children[lane] = child;
    }
}

#[cfg(test)]
#[path = "bvh_tests.rs"]
mod tests;
