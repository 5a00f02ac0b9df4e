//! The lower end of the hierarchy: the best tree of wide nodes over a few items.
//!
//! A binary tree is grown down to single items by a full sweep of the surface-area heuristic. Dynamic programming then
//! decides which of its subtrees become leaves and which of its nodes become wide ones, so that the expected cost of
//! a ray is the least (Ylitie, Karras and Laine 2017, "Efficient Incoherent Ray Traversal on GPUs Through Compressed
//! Wide BVHs").

use super::build::{Item, Tree};
use crate::math::Aabb;
use crate::math::lanes::WIDTH;

/// As many items are few. Trees over them have fewer levels than that.
pub(super) const FEW: usize = 64;
/// Cost of a visit to a node, in visits to a packet.
const NODE: f32 = 0.5;

/// A node of the binary tree.
struct Binary {
    bounds: Aabb,
    len: usize,
    children: Option<Box<[Binary; 2]>>,
    /// Whether it is a leaf where it is a single child.
    leaf: bool,
    /// How many children of a wide node that is made of it come from its first half.
    share: usize,
    /// The same by the number of children it may be, less one; 0 where fewer are as good.
    shares: [usize; WIDTH],
    /// The least cost by the number of children it may be, less one.
    costs: [f32; WIDTH],
}

/// How likely boxes are met: a ray from outside meets them by their surface, one that starts among them by their volume
/// as well, which tells whether it starts inside (Steiner's formula).
#[derive(Clone, Copy)]
struct Measure {
    per_volume: f32,
}

impl Measure {
    /// For rays that start in `space` and fly as far as it is wide: its volume over half its area.
    fn within(space: Aabb) -> Self {
        let per_volume = space.half_area() / volume(space);
        Self { per_volume: if per_volume.is_finite() { per_volume } else { 0.0 } }
    }

    #[inline(always)]
    fn of(self, bounds: Aabb) -> f32 {
        bounds.half_area() + self.per_volume * volume(bounds)
    }

    /// The expected cost of visits to a leaf.
    #[inline(always)]
    fn packets(self, bounds: Aabb, eighths: u64) -> f32 {
        self.of(bounds) * eighths.div_ceil(WIDTH as u64) as f32
    }
}

#[inline(always)]
fn volume(bounds: Aabb) -> f32 {
    bounds.extent().element_product()
}

/// The best subtree over `items`, up to [`FEW`] of them, which it reorders. Never a leaf. `whole` where there are no
/// others: then rays start among them.
pub(super) fn refine(items: &mut [Item], whole: bool) -> Tree {
    let space = items.iter().fold(Aabb::EMPTY, |b, i| b.union(i.bounds));
    let measure = if whole { Measure::within(space) } else { Measure { per_volume: 0.0 } };
    let root = Binary::new(items, measure);
    if !root.leaf {
        return root.wide();
    }
    let mut parts = Vec::new();
    root.place(WIDTH, &mut parts);
    Tree::Inner(parts)
}

impl Binary {
    fn new(items: &mut [Item], measure: Measure) -> Self {
        let bounds = items.iter().fold(Aabb::EMPTY, |b, i| b.union(i.bounds));
        let len = items.len();
        let packet = measure.packets(bounds, items.iter().map(|i| u64::from(i.cost)).sum());
        let mut node =
            Self { bounds, len, children: None, leaf: true, share: 0, shares: [0; WIDTH], costs: [packet; WIDTH] };
        if len == 1 {
            return node;
        }
        let middle = halve(items, measure);
        let (left, right) = items.split_at_mut(middle);
        let children = Box::new([Self::new(left, measure), Self::new(right, measure)]);
        let best = |count: usize| {
            let both = |k: usize| children[0].costs[k - 1] + children[1].costs[count - k - 1];
            (2..count).fold((both(1), 1), |best, k| if both(k) < best.0 { (both(k), k) } else { best })
        };
        let (below, share) = best(WIDTH);
        let wide = NODE * measure.of(bounds) + below;
        node.share = share;
        node.leaf = len <= WIDTH && !(wide < packet);
        node.costs[0] = if node.leaf { packet } else { wide };
        for count in 2..=WIDTH {
            let (cost, share) = best(count);
            // Equal costs, of boxes without area: flat trees are better than deep ones.
            let better = cost < node.costs[count - 2] || (cost == node.costs[count - 2] && !node.leaf);
            node.shares[count - 1] = if better { share } else { 0 };
            node.costs[count - 1] = if better { cost } else { node.costs[count - 2] };
        }
        node.children = Some(children);
        node
    }

    /// The wide node made of this one.
    fn wide(&self) -> Tree {
        let mut parts = Vec::with_capacity(WIDTH);
        for (child, count) in self.children.iter().flat_map(|c| c.iter()).zip([self.share, WIDTH - self.share]) {
            child.place(count, &mut parts);
        }
        Tree::Inner(parts)
    }

    /// Appends what becomes of this node where it may be up to `count` children.
    fn place(&self, count: usize, parts: &mut Vec<(Aabb, Tree)>) {
        let share = self.shares[count - 1];
        match &self.children {
            Some(children) if share > 0 => {
                children[0].place(share, parts);
                children[1].place(count - share, parts);
            }
            _ if count > 1 => self.place(count - 1, parts),
            _ => parts.push((self.bounds, if self.leaf { Tree::Leaf { len: self.len } } else { self.wide() })),
        }
    }
}

/// Sorts the items so that the cheapest split is after the first few; returns how many.
fn halve(items: &mut [Item], measure: Measure) -> usize {
    // Least cost, then nearest to the middle; the place and the axis.
    let mut best = (f32::INFINITY, usize::MAX, items.len() / 2, 2);
    let sort = |items: &mut [Item], axis: usize| {
        items.sort_unstable_by(|a, b| a.centre()[axis].total_cmp(&b.centre()[axis]).then(a.index.cmp(&b.index)));
    };
    for axis in 0..3 {
        sort(items, axis);
        let mut after = [0.0; FEW];
        let (mut bounds, mut eighths) = (Aabb::EMPTY, 0);
        for (item, after) in items.iter().zip(&mut after).skip(1).rev() {
            bounds = bounds.union(item.bounds);
            eighths += item.cost;
            *after = measure.of(bounds) * eighths as f32;
        }
        let (mut bounds, mut eighths) = (Aabb::EMPTY, 0);
        for i in 1..items.len() {
            bounds = bounds.union(items[i - 1].bounds);
            eighths += items[i - 1].cost;
            let cost = measure.of(bounds) * eighths as f32 + after[i];
            let aside = (2 * i).abs_diff(items.len());
            if (cost, aside) < (best.0, best.1) {
                best = (cost, aside, i, axis);
            }
        }
    }
    let (.., middle, axis) = best;
    if axis != 2 {
        sort(items, axis);
    }
    middle
}
