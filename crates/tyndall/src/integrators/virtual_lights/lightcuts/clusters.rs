//! Binary trees of clusters: of virtual lights, and of the points of a pixel that they light.

use crate::math::{Aabb, Rng, Vec3};
use crate::scene::emitter::bound::{angle_between, cone_union};

/// What scatters at the members of a cluster: surfaces, or the medium of that number plus one.
pub(super) const SURFACE: u32 = 0;

/// A vertex of a walk, as far as clusters ask. Along the unit vector `w` it scatters at most `weight peak shape(w)`, with the
/// shape `max(cos, floor)` of the angle between `w` and the axis on surfaces, and the phase function of that cosine in media.
#[derive(Clone, Copy, Debug)]
pub(super) struct Member {
    /// Position, metres.
    pub(super) position: Vec3,
    /// Unit normal on surfaces, direction of arrival in media.
    pub(super) axis: Vec3,
    /// What members are chosen in proportion to, positive.
    pub(super) weight: f32,
    pub(super) peak: f32,
    pub(super) floor: f32,
    pub(super) class: u32,
    /// Number of the vertex.
    pub(super) index: u32,
}

/// A cluster; its first child follows it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    /// Box around the members, metres.
    pub(super) bounds: Aabb,
    /// Cone around the members' axes.
    pub(super) axis: Vec3,
    pub(super) cos: f32,
    pub(super) sin: f32,
    /// Sum of the members' weights.
    pub(super) weight: f32,
    /// Largest of the members'.
    pub(super) peak: f32,
    pub(super) floor: f32,
    pub(super) class: u32,
    /// Place of the first member, and how many there are.
    first: u32,
    pub(super) count: u32,
    /// The second child; leaves have none.
    second: u32,
}

impl Node {
    const EMPTY: Self = Self {
        bounds: Aabb::EMPTY,
        axis: Vec3::Z,
        cos: 1.0,
        sin: 0.0,
        weight: 0.0,
        peak: 0.0,
        floor: 0.0,
        class: SURFACE,
        first: 0,
        count: 0,
        second: 0,
    };

    fn leaf(member: &Member, first: u32) -> Self {
        let Member { position, axis, weight, peak, floor, class, .. } = *member;
        let bounds = Aabb { min: position, max: position };
        Self { bounds, axis, cos: 1.0, sin: 0.0, weight, peak, floor, class, first, count: 1, second: 0 }
    }

    fn around(a: &Self, b: &Self, second: u32) -> Self {
        let (axis, angle) = cone([a, b].map(|node| (node.axis, node.sin.atan2(node.cos))));
        let (sin, cos) = angle.sin_cos();
        Self {
            bounds: a.bounds.union(b.bounds),
            axis,
            cos,
            // That of pi is rounded.
            sin: sin.max(0.0),
            weight: a.weight + b.weight,
            peak: a.peak.max(b.peak),
            floor: a.floor.max(b.floor),
            class: a.class,
            first: a.first,
            count: a.count + b.count,
            second,
        }
    }

    #[inline(always)]
    pub(super) fn is_leaf(&self) -> bool {
        self.count == 1
    }
}

/// Axes nearer to each other are put into one cone without turning it: their plane is lost in rounding.
const PARALLEL: f32 = 1e-3;

/// The cone around two, each an axis and a half angle.
fn cone([a, b]: [(Vec3, f32); 2]) -> (Vec3, f32) {
    let (wide, narrow) = if a.1 >= b.1 { (a, b) } else { (b, a) };
    let between = if wide.0 == narrow.0 { 0.0 } else { angle_between(wide.0, narrow.0) };
    if between < PARALLEL { (wide.0, wide.1.max(between + narrow.1)) } else { cone_union(a, b) }
}

/// Depth from which on clusters are cut in the middle of their members, wherever these are.
const DEEP: u32 = 64;

/// Clusters of more members are cut by two threads.
const LARGE: usize = 4096;

/// Distance, in units of the size of all, that parts members as much as unit vectors apart do.
const TURN: f32 = 1.0 / 16.0;

/// Members in clusters, a tree for each class. The trees depend on the members alone.
#[derive(Debug, Default)]
pub(super) struct Clusters {
    pub(super) members: Vec<Member>,
    pub(super) nodes: Vec<Node>,
    pub(super) roots: Vec<u32>,
    /// Sums of the weights of the members before each, and of all.
    cumulative: Vec<f64>,
}

impl Clusters {
    /// Bytes for each member.
    pub(super) const BYTES: usize = size_of::<Member>() + 2 * size_of::<Node>() + size_of::<f64>();

    /// Builds the trees anew. Memory is re-used.
    pub(super) fn rebuild(&mut self, members: impl Iterator<Item = Member>) {
        self.members.clear();
        self.members.extend(members);
        self.members.sort_unstable_by_key(|member| (member.class, member.index));
        self.nodes.clear();
        self.nodes.resize(2 * self.members.len(), Node::EMPTY);
        self.roots.clear();
        let (mut first, mut node) = (0, 0);
        for members in self.members.chunk_by_mut(|a, b| a.class == b.class) {
            let count = members.len();
            let extent = Aabb::from_points(members.iter().map(|member| member.position)).extent();
            let nodes = &mut self.nodes[node..node + 2 * count - 1];
            grow(members, nodes, [first as u32, node as u32], TURN * extent.length(), 0);
            self.roots.push(node as u32);
            first += count;
            node += 2 * count - 1;
        }
        self.nodes.truncate(node);
        let mut sum = 0.0;
        self.cumulative.clear();
        self.cumulative.push(0.0);
        self.cumulative.extend(self.members.iter().map(|member| {
            sum += f64::from(member.weight);
            sum
        }));
    }

    pub(super) fn is_empty(&self) -> bool {
        self.members.is_empty()
    }

    #[inline(always)]
    pub(super) fn node(&self, node: u32) -> &Node {
        &self.nodes[node as usize]
    }

    /// The two parts of a cluster that is no leaf.
    #[inline(always)]
    pub(super) fn children(&self, node: u32) -> [u32; 2] {
        [node + 1, self.node(node).second]
    }

    /// A member of the cluster chosen in proportion to its weight: the number of its vertex, and the probability.
    #[inline]
    pub(super) fn choose(&self, node: u32, rng: &mut Rng) -> (u32, f32) {
        let Node { first, count, .. } = *self.node(node);
        if count == 1 {
            return (self.members[first as usize].index, 1.0);
        }
        let (first, end) = (first as usize, (first + count) as usize);
        let (below, above) = (self.cumulative[first], self.cumulative[end]);
        let x = below + f64::from(rng.bits()) * (1.0 / 4_294_967_296.0) * (above - below);
        let chosen = first + self.cumulative[first + 1..end].partition_point(|sum| *sum <= x);
        let probability = (self.cumulative[chosen + 1] - self.cumulative[chosen]) / (above - below);
        (self.members[chosen].index, probability as f32)
    }
}

/// Makes `nodes` the tree over `members`, which are put into its order. `place` is that of the first member and of the
/// first node.
fn grow(members: &mut [Member], nodes: &mut [Node], place: [u32; 2], turn: f32, depth: u32) {
    let [first, node] = place;
    if let [member] = members {
        nodes[0] = Node::leaf(member, first);
        return;
    }
    let large = members.len() > LARGE;
    let middle = if depth < DEEP { split(members, turn) } else { members.len() / 2 };
    let (a, b) = members.split_at_mut(middle);
    let (head, rest) = nodes.split_at_mut(1);
    let (nodes_a, nodes_b) = rest.split_at_mut(2 * middle - 1);
    let second = node + 2 * middle as u32;
    let places = [[first, node + 1], [first + middle as u32, second]];
    let mut grow_a = || grow(a, nodes_a, places[0], turn, depth + 1);
    let mut grow_b = || grow(b, nodes_b, places[1], turn, depth + 1);
    if large {
        rayon::join(grow_a, grow_b);
    } else {
        grow_a();
        grow_b();
    }
    head[0] = Node::around(&nodes_a[0], &nodes_b[0], second);
}

/// Reorders `members` and returns the size of the first part: those on one side of the middle of the longest side of the box
/// around positions and axes.
fn split(members: &mut [Member], turn: f32) -> usize {
    let positions = Aabb::from_points(members.iter().map(|member| member.position));
    let axes = Aabb::from_points(members.iter().map(|member| member.axis));
    let (across, around) = (positions.extent(), axes.extent() * turn);
    let by_axis = around.max_element() > across.max_element();
    let (extent, bounds) = if by_axis { (around, axes) } else { (across, positions) };
    let axis = (0..3).fold(0, |best, i| if extent[i] > extent[best] { i } else { best });
    let (middle, side) = (bounds.centre()[axis], if by_axis { |m: &Member| m.axis } else { |m: &Member| m.position });
    let (mut size, mut end) = (0, members.len());
    while size < end {
        if side(&members[size])[axis] < middle {
            size += 1;
        } else {
            end -= 1;
            members.swap(size, end);
        }
    }
    if size == 0 || size == members.len() { members.len() / 2 } else { size }
}
