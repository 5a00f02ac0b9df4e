//! A cut through all pairs of lights and points: pairs of clusters that together are all of them (Walter et al. 2006).

use super::bounds::Bounds;
use super::clusters::Clusters;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// A cluster of lights and a cluster of points.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    /// Bound of what the lights give by way of the points; 0 where one light gives to one point.
    error: f32,
    pub(super) light: u32,
    pub(super) point: u32,
}

impl PartialEq for Pair {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Pair {}

impl PartialOrd for Pair {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Pair {
    fn cmp(&self, other: &Self) -> Ordering {
        let key = |pair: &Self| (pair.light, pair.point);
        self.error.total_cmp(&other.error).then_with(|| key(self).cmp(&key(other)))
    }
}

/// What there is to choose from.
#[derive(Clone, Copy, Debug)]
pub(super) struct Graph<'a> {
    pub(super) lights: &'a Clusters,
    pub(super) points: &'a Clusters,
    pub(super) bounds: &'a Bounds<'a>,
}

/// A cut. It depends on the clusters and their bounds alone, not on what any light gives.
#[derive(Debug, Default)]
pub(super) struct Cut {
    /// Pairs that can be refined, the largest bound first.
    open: BinaryHeap<Pair>,
    /// Pairs of a light and a point, and pairs that give nothing to tell.
    closed: Vec<Pair>,
}

impl Cut {
    /// Becomes the coarsest cut. Memory is re-used.
    pub(super) fn start(&mut self, graph: &Graph) {
        self.open.clear();
        self.closed.clear();
        for &light in &graph.lights.roots {
            for &point in &graph.points.roots {
                self.push(graph.pair(light, point));
            }
        }
    }

    fn push(&mut self, pair: Pair) {
        if pair.error > 0.0 {
            self.open.push(pair);
        } else {
            self.closed.push(pair);
        }
    }

    /// Refines until no bound is above `threshold`, or there are `most` pairs.
    pub(super) fn refine(&mut self, graph: &Graph, threshold: f32, most: usize) {
        while self.len() < most
            && let Some(pair) = self.open.peek().copied()
            && pair.error > threshold
        {
            self.open.pop();
            for part in graph.parts(&pair) {
                self.push(part);
            }
        }
    }

    /// The largest bound.
    pub(super) fn error(&self) -> f32 {
        self.open.peek().map_or(0.0, |pair| pair.error)
    }

    pub(super) fn len(&self) -> usize {
        self.open.len() + self.closed.len()
    }

    /// All pairs, in an order that depends on the cut alone.
    pub(super) fn pairs(&self) -> impl Iterator<Item = &Pair> {
        self.closed.iter().chain(self.open.iter())
    }
}

impl Graph<'_> {
    fn pair(&self, light: u32, point: u32) -> Pair {
        let (lights, points) = (self.lights.node(light), self.points.node(point));
        let exact = lights.is_leaf() && points.is_leaf();
        Pair { error: if exact { 0.0 } else { self.bounds.of(lights, points) }, light, point }
    }

    /// The two pairs that `pair` becomes when its lights or its points are parted: those whose bounds are smaller together; where
    /// they are equal, the clusters of the larger box.
    #[inline]
    fn parts(&self, pair: &Pair) -> [Pair; 2] {
        let &Pair { light, point, .. } = pair;
        let (lights, points) = (self.lights.node(light), self.points.node(point));
        let by_lights = || self.lights.children(light).map(|child| self.pair(child, point));
        let by_points = || self.points.children(point).map(|child| self.pair(light, child));
        if points.is_leaf() {
            return by_lights();
        }
        if lights.is_leaf() {
            return by_points();
        }
        let (a, b) = (by_lights(), by_points());
        let sum = |[first, second]: &[Pair; 2]| first.error + second.error;
        let larger = lights.bounds.extent().length() >= points.bounds.extent().length();
        match sum(&a).total_cmp(&sum(&b)) {
            Ordering::Less => a,
            Ordering::Greater => b,
            Ordering::Equal => {
                if larger {
                    a
                } else {
                    b
                }
            }
        }
    }
}
