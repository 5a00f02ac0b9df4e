//! The textbook versions, against which ours are measured.

use std::collections::BinaryHeap;
use tyndall::math::Vec3;

/// A dense grid over the unit cube with cells of two radii.
pub struct ScalarGrid {
    radius: f32,
    side: usize,
    starts: Vec<u32>,
    points: Vec<Vec3>,
}

impl ScalarGrid {
    pub fn build(positions: &[Vec3], radius: f32) -> Self {
        let side = (0.5 / radius).ceil() as usize;
        let mut grid = Self { radius, side, starts: vec![0; side * side * side + 1], points: positions.to_vec() };
        for p in positions {
            let cell = grid.place(grid.cell(*p));
            grid.starts[cell] += 1;
        }
        let mut sum = 0;
        for start in &mut grid.starts {
            sum += *start;
            *start = sum;
        }
        for p in positions {
            let cell = grid.place(grid.cell(*p));
            grid.starts[cell] -= 1;
            grid.points[grid.starts[cell] as usize] = *p;
        }
        grid
    }

    fn cell(&self, p: Vec3) -> [usize; 3] {
        (p * (0.5 / self.radius)).to_array().map(|t| (t.max(0.0) as usize).min(self.side - 1))
    }

    fn place(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.side + y) * self.side + x
    }

    /// Number of points within the radius, and the sum of their squared distances.
    pub fn gather(&self, x: Vec3) -> (u32, f32) {
        let (low, high) = (self.cell(x - self.radius), self.cell(x + self.radius));
        let (mut count, mut sum) = (0, 0.0);
        for z in low[2]..=high[2] {
            for y in low[1]..=high[1] {
                for x_cell in low[0]..=high[0] {
                    let cell = self.place([x_cell, y, z]);
                    for p in &self.points[self.starts[cell] as usize..self.starts[cell + 1] as usize] {
                        let squared = x.distance_squared(*p);
                        if squared <= self.radius * self.radius {
                            count += 1;
                            sum += squared;
                        }
                    }
                }
            }
        }
        (count, sum)
    }
}

/// A balanced tree with a point in every node.
pub struct ScalarTree {
    nodes: Vec<(Vec3, u32, usize)>,
}

impl ScalarTree {
    pub fn build(positions: &[Vec3]) -> Self {
        let mut nodes: Vec<_> = positions.iter().enumerate().map(|(i, p)| (*p, i as u32, 0)).collect();
        Self::halve(&mut nodes);
        Self { nodes }
    }

    fn halve(nodes: &mut [(Vec3, u32, usize)]) {
        if nodes.len() < 2 {
            return;
        }
        let low = nodes.iter().fold(Vec3::INFINITY, |b, n| b.min(n.0));
        let high = nodes.iter().fold(Vec3::NEG_INFINITY, |b, n| b.max(n.0));
        let axis = (high - low).max_position();
        let middle = nodes.len() / 2;
        nodes.select_nth_unstable_by(middle, |a, b| a.0[axis].total_cmp(&b.0[axis]));
        nodes[middle].2 = axis;
        Self::halve(&mut nodes[..middle]);
        Self::halve(&mut nodes[middle + 1..]);
    }

    /// Bits of squared distances and indices of the `k` nearest.
    pub fn nearest(&self, x: Vec3, k: usize, found: &mut BinaryHeap<(u32, u32)>) {
        found.clear();
        Self::search(&self.nodes, x, k, found);
    }

    fn search(nodes: &[(Vec3, u32, usize)], x: Vec3, k: usize, found: &mut BinaryHeap<(u32, u32)>) {
        if nodes.is_empty() {
            return;
        }
        let middle = nodes.len() / 2;
        let (p, index, axis) = nodes[middle];
        let offset = x[axis] - p[axis];
        let (near, far) = match offset < 0.0 {
            true => (&nodes[..middle], &nodes[middle + 1..]),
            false => (&nodes[middle + 1..], &nodes[..middle]),
        };
        Self::search(near, x, k, found);
        let key = (x.distance_squared(p).to_bits(), index);
        if found.len() < k {
            found.push(key);
        } else if key < *found.peek().unwrap() {
            *found.peek_mut().unwrap() = key;
        }
        if found.len() < k || (offset * offset).to_bits() <= found.peek().unwrap().0 {
            Self::search(far, x, k, found);
        }
    }
}
