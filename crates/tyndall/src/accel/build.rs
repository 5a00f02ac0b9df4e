//! Building the hierarchy: the binary tree of the surface-area heuristic, opened eight children at a time.

use super::bvh::{Bvh, FREE_DEPTH, LEAF, Node, REFINE_DEPTH};
use super::refine::{FEW, refine};
use crate::math::lanes::WIDTH;
use crate::math::{Aabb, Vec3};
use rayon::prelude::*;

const BINS: usize = 16;
/// Leaves are split into lanes left over where that takes the expected cost below this share.
const LEAF_SPLIT: f32 = 0.8;
/// Ranges of more items are built by several threads ...
const PARALLEL_BUILD: usize = 4096;
/// ... and ranges of more items are also binned by several threads.
const PARALLEL_BIN: usize = 65536;

/// An item while the tree is built.
#[derive(Clone, Copy)]
pub(super) struct Item {
    pub(super) bounds: Aabb,
    pub(super) index: u32,
    /// Cost, in eighths of a packet of eight.
    pub(super) cost: u32,
}

impl Item {
    /// Twice the centre.
    #[inline(always)]
    pub(super) fn centre(&self) -> Vec3 {
        self.bounds.min + self.bounds.max
    }
}

/// Consecutive items that stay together.
#[derive(Clone, Copy)]
struct Cluster {
    first: usize,
    len: usize,
    bounds: Aabb,
    centres: Aabb,
    /// Whether it may be worth splitting.
    open: bool,
}

/// A subtree before it is written down.
pub(super) enum Tree {
    Leaf { len: usize },
    Inner(Vec<(Aabb, Tree)>),
}

pub(super) fn build(bounds: &[Aabb], cost: impl Fn(usize) -> u32) -> Bvh {
    assert!(bounds.len() < LEAF as usize, "too many items for one hierarchy");
    // Adding zero turns -0 into 0: the union of boxes then does not depend on the order, sign bits included.
    let clean = |b: &Aabb| Aabb { min: b.min + Vec3::ZERO, max: b.max + Vec3::ZERO };
    let mut items: Vec<Item> = bounds
        .iter()
        .enumerate()
        .filter(|(_, b)| !b.is_empty())
        .map(|(i, b)| Item { bounds: clean(b), index: i as u32, cost: cost(i) })
        .collect();
    if items.is_empty() {
        return Bvh::default();
    }
    let root = Cluster {
        first: 0,
        len: items.len(),
        bounds: items.iter().fold(Aabb::EMPTY, |b, i| b.union(i.bounds)),
        centres: items.iter().fold(Aabb::EMPTY, |b, i| b.include(i.centre())),
        open: true,
    };
    let tree = grow(&mut items, root, 0);
    let order = items.iter().map(|i| i.index).collect();
    drop(items);
    let largest = root.bounds.min.abs().max(root.bounds.max.abs()).max_element();
    let mut bvh = Bvh { nodes: Vec::new(), order, starts: vec![0], bounds: Some(root.bounds), largest };
    write_down(&tree, &mut bvh);
    bvh.nodes.shrink_to_fit();
    bvh.starts.shrink_to_fit();
    bvh
}

/// Appends the subtree, depth first; returns its reference.
fn write_down(tree: &Tree, bvh: &mut Bvh) -> u32 {
    match tree {
        Tree::Leaf { len } => {
            let leaf = bvh.starts.len() as u32 - 1;
            bvh.starts.push(bvh.starts[leaf as usize] + *len as u32);
            leaf | LEAF
        }
        Tree::Inner(children) => {
            let node = bvh.nodes.len();
            bvh.nodes.push(Node::empty());
            for (lane, (bounds, child)) in children.iter().enumerate() {
                let child = write_down(child, bvh);
                bvh.nodes[node].set(lane, *bounds, child);
            }
            node as u32
        }
    }
}

/// Builds the subtree over `items`, which are those of `cluster`.
fn grow(items: &mut [Item], cluster: Cluster, depth: usize) -> Tree {
    if items.len() <= WIDTH && depth > 0 {
        return Tree::Leaf { len: items.len() };
    }
    if items.len() <= FEW && depth < REFINE_DEPTH {
        return refine(items, depth == 0);
    }
    let mut clusters = vec![Cluster { first: 0, ..cluster }];
    while clusters.len() < WIDTH {
        // Open the largest box, leaves last; the first one of equals.
        let mut widest: Option<(usize, (bool, f32))> = None;
        for (i, c) in clusters.iter().enumerate().filter(|(_, c)| c.open) {
            let size = (c.len > WIDTH, c.bounds.half_area());
            if widest.is_none_or(|(_, w)| size > w) {
                widest = Some((i, size));
            }
        }
        let Some((at, _)) = widest else { break };
        let opened = clusters[at];
        let part = &mut items[opened.first..][..opened.len];
        let parts = if opened.len > WIDTH { Some(split(part, opened, depth)) } else { split_leaf(part, opened) };
        match parts {
            Some((left, right)) => {
                clusters[at] = left;
                clusters.insert(at + 1, right);
            }
            None => clusters[at].open = false,
        }
    }
    let mut rest = items;
    let mut parts = Vec::with_capacity(clusters.len());
    for cluster in clusters {
        let (part, tail) = rest.split_at_mut(cluster.len);
        parts.push((part, cluster));
        rest = tail;
    }
    let below = |(part, cluster): (&mut [Item], Cluster)| (cluster.bounds, grow(part, cluster, depth + 1));
    let parallel = parts.iter().map(|(part, _)| part.len()).sum::<usize>() > PARALLEL_BUILD;
    Tree::Inner(match parallel {
        true => parts.into_par_iter().map(below).collect(),
        false => parts.into_iter().map(below).collect(),
    })
}

/// Splits a cluster of more than eight items in two and sorts the items accordingly.
fn split(items: &mut [Item], cluster: Cluster, depth: usize) -> (Cluster, Cluster) {
    let plane = if depth < FREE_DEPTH { Grid::new(cluster.centres).best_plane(items) } else { None };
    let middle = match plane {
        Some(plane) => partition(items, |item| plane.left(item)),
        None => halve(items, cluster.centres),
    };
    let (left, right) = items.split_at(middle);
    (summary(left, cluster.first), summary(right, cluster.first + middle))
}

/// The expected cost of visits to a leaf, or to as many packets.
#[inline(always)]
fn cost(bounds: Aabb, eighths: u64) -> f32 {
    bounds.half_area() * eighths.div_ceil(WIDTH as u64) as f32
}

/// Splits a leaf where a lane is left for it, if its parts are much cheaper.
fn split_leaf(items: &mut [Item], cluster: Cluster) -> Option<(Cluster, Cluster)> {
    let plane = Grid::new(cluster.centres).best_plane(items)?;
    if !(plane.cost < LEAF_SPLIT * cost(cluster.bounds, items.iter().map(|i| u64::from(i.cost)).sum())) {
        return None;
    }
    let middle = partition(items, |item| plane.left(item));
    let (left, right) = items.split_at(middle);
    Some((summary(left, cluster.first), summary(right, cluster.first + middle)))
}

fn summary(items: &[Item], first: usize) -> Cluster {
    let (mut bounds, mut centres) = (Aabb::EMPTY, Aabb::EMPTY);
    for item in items {
        bounds = bounds.union(item.bounds);
        centres = centres.include(item.centre());
    }
    Cluster { first, len: items.len(), bounds, centres, open: true }
}

/// Moves the items that satisfy `left` to the front; returns how many they are.
fn partition(items: &mut [Item], left: impl Fn(&Item) -> bool) -> usize {
    let (mut low, mut high) = (0, items.len());
    loop {
        while low < high && left(&items[low]) {
            low += 1;
        }
        while low < high && !left(&items[high - 1]) {
            high -= 1;
        }
        if low >= high {
            return low;
        }
        high -= 1;
        items.swap(low, high);
        low += 1;
    }
}

/// Splits at the median along the widest axis, at a multiple of eight.
fn halve(items: &mut [Item], centres: Aabb) -> usize {
    let middle = (items.len() / 2).next_multiple_of(WIDTH);
    let axis = centres.extent().max_position();
    items.select_nth_unstable_by(middle, |a, b| {
        a.centre()[axis].total_cmp(&b.centre()[axis]).then(a.index.cmp(&b.index))
    });
    middle
}

/// The bins over the centres of a cluster.
#[derive(Clone, Copy)]
struct Grid {
    origin: Vec3,
    scale: Vec3,
}

#[derive(Clone, Copy)]
struct Bin {
    bounds: Aabb,
    /// Sum of its items'.
    cost: u64,
}

/// The plane before a bin of a grid.
struct Plane {
    grid: Grid,
    axis: usize,
    bin: usize,
    cost: f32,
}

impl Plane {
    #[inline(always)]
    fn left(&self, item: &Item) -> bool {
        self.grid.bin(item, self.axis) < self.bin
    }
}

type Bins = [[Bin; BINS]; 3];
const NO_BINS: Bins = [[Bin { bounds: Aabb::EMPTY, cost: 0 }; BINS]; 3];

impl Grid {
    fn new(centres: Aabb) -> Self {
        let extent = centres.extent();
        // An axis without extent gets scale 0: everything in one bin, no plane.
        let scale = extent.to_array().map(|e| if e > 0.0 { (BINS as f32 * 0.99999 / e).min(f32::MAX) } else { 0.0 });
        Self { origin: centres.min, scale: Vec3::from_array(scale) }
    }

    #[inline(always)]
    fn bin(&self, item: &Item, axis: usize) -> usize {
        let x = (item.centre()[axis] - self.origin[axis]) * self.scale[axis];
        (x as usize).min(BINS - 1)
    }

    fn fill(&self, items: &[Item]) -> Bins {
        let mut bins = NO_BINS;
        for item in items {
            for (axis, bins) in bins.iter_mut().enumerate() {
                let bin = &mut bins[self.bin(item, axis)];
                bin.bounds = bin.bounds.union(item.bounds);
                bin.cost += u64::from(item.cost);
            }
        }
        bins
    }

    fn fill_parallel(&self, items: &[Item]) -> Bins {
        let merge = |mut a: Bins, b: Bins| {
            for (a, b) in a.as_flattened_mut().iter_mut().zip(b.as_flattened()) {
                a.bounds = a.bounds.union(b.bounds);
                a.cost += b.cost;
            }
            a
        };
        items.par_chunks(PARALLEL_BIN / 4).map(|chunk| self.fill(chunk)).reduce(|| NO_BINS, merge)
    }

    /// The cheapest plane; `None` when all centres share one bin.
    fn best_plane(self, items: &[Item]) -> Option<Plane> {
        let bins = if items.len() > PARALLEL_BIN { self.fill_parallel(items) } else { self.fill(items) };
        let mut best: Option<Plane> = None;
        for (axis, bins) in bins.iter().enumerate() {
            let mut right_costs = [0.0; BINS];
            let (mut bounds, mut right) = (Aabb::EMPTY, [0; BINS]);
            let mut eighths = 0;
            for i in (1..BINS).rev() {
                bounds = bounds.union(bins[i].bounds);
                eighths += bins[i].cost;
                right[i] = eighths;
                right_costs[i] = cost(bounds, eighths);
            }
            let (mut bounds, mut eighths) = (Aabb::EMPTY, 0);
            for i in 1..BINS {
                bounds = bounds.union(bins[i - 1].bounds);
                eighths += bins[i - 1].cost;
                if eighths == 0 || right[i] == 0 {
                    continue;
                }
                let cost = cost(bounds, eighths) + right_costs[i];
                if best.as_ref().is_none_or(|b| cost < b.cost) {
                    best = Some(Plane { grid: self, axis, bin: i, cost });
                }
            }
        }
        best
    }
}
