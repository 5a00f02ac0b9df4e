//! Local bounds of the extinction, and the walk of a ray through them (Amanatides and Woo 1987).

use super::{Grid, Volume, Voxel};
use crate::Spectrum;
use crate::math::{Aabb, Vec3};

/// Most cells along an axis.
const MAX_CELLS: f32 = 32.0;
/// Voxels a cell should span along an axis.
const VOXELS_PER_CELL: f32 = 4.0;
/// Voxels by which a cell's bounds reach beyond its faces, for the rounding of points and cells.
const SLACK: f32 = 0.1;
/// Relative widening of the bounds, for the rounding of an interpolation.
const ROUNDING: f32 = 8.0 * f32::EPSILON;
/// A direction component below this never leaves its cell.
const PARALLEL: f32 = 1e-20;

/// Smallest and largest extinction in the cells of a coarse grid over a medium's box.
///
/// Each cell takes in every voxel that an interpolation inside it can touch, so the bounds are rigorous.
#[derive(Clone, Debug)]
pub struct MajorantGrid {
    bounds: Aabb,
    /// Cells along x, y, z.
    size: [usize; 3],
    /// Edges of a cell, metres.
    cell: Vec3,
    cells: Vec<Cell>,
    max: f32,
}

/// Bounds of the extinction over all channels, 1/m.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Cell {
    majorant: f32,
    minorant: f32,
}

/// A stretch of a ray with bounds of the extinction on it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// Start along the ray, metres.
    pub t0: f32,
    /// End along the ray, metres; greater than `t0`.
    pub t1: f32,
    /// No channel of the extinction is greater, 1/m. Not zero.
    pub majorant: f32,
    /// No channel of the extinction is smaller, 1/m.
    pub minorant: f32,
}

impl MajorantGrid {
    /// The bounds of `sigma_t` in the box.
    pub(super) fn new(sigma_t: &Volume, bounds: Aabb) -> Self {
        match sigma_t {
            Volume::Constant(value) => {
                let cell = Cell { majorant: value.max_channel(), minorant: value.min_channel() };
                let (size, edges) = ([1; 3], bounds.extent());
                Self { bounds, size, cell: edges, cells: vec![cell], max: cell.majorant }
            }
            Volume::Grey(grid) => Self::of_grid(grid, bounds, |v| (v, v)),
            Volume::Colour(grid) => Self::of_grid(grid, bounds, |v: Spectrum| (v.min_channel(), v.max_channel())),
        }
    }

    fn of_grid<T: Voxel>(grid: &Grid<T>, bounds: Aabb, range: impl Fn(T) -> (f32, f32)) -> Self {
        let extent = bounds.extent();
        let columns = [Vec3::X, Vec3::Y, Vec3::Z].map(|axis| grid.to_world().inverse_vector(axis).abs());
        let size: [usize; 3] = std::array::from_fn(|i| {
            let voxels = (columns[i] * grid.size() * extent[i]).max_element();
            (voxels / VOXELS_PER_CELL).ceil().clamp(1.0, MAX_CELLS) as usize
        });
        let cell = extent / Vec3::from_array(size.map(|n| n as f32));
        let half = 0.5 * (columns[0] * cell.x + columns[1] * cell.y + columns[2] * cell.z);
        let mut cells = Vec::with_capacity(size.iter().product());
        for z in 0..size[2] {
            for y in 0..size[1] {
                for x in 0..size[0] {
                    let middle = Vec3::new(x as f32, y as f32, z as f32) + Vec3::splat(0.5);
                    let centre = grid.to_world().inverse_point(bounds.min + middle * cell);
                    let (mut min, mut max) = (f32::INFINITY, 0.0_f32);
                    grid.visit_support(centre, half, SLACK, |voxel| {
                        let (low, high) = range(voxel);
                        min = min.min(low);
                        max = max.max(high);
                    });
                    cells.push(Cell { majorant: max * (1.0 + ROUNDING), minorant: min * (1.0 - ROUNDING) });
                }
            }
        }
        let max = cells.iter().fold(0.0_f32, |max, cell| max.max(cell.majorant));
        Self { bounds, size, cell, cells, max }
    }

    /// The largest majorant, 1/m.
    #[inline(always)]
    pub fn max(&self) -> f32 {
        self.max
    }

    /// Cells along x, y, z.
    pub fn size(&self) -> [usize; 3] {
        self.size
    }

    /// The stretches of the ray `o + t d` within `[0, t_max]` on which there can be extinction, from near to far.
    #[inline]
    pub fn segments(&self, o: Vec3, d: Vec3, t_max: f32) -> CellWalk<'_> {
        let mut walk = CellWalk {
            cells: &self.cells,
            cell: 0,
            start: 0.0,
            t: 0.0,
            end: f32::NEG_INFINITY,
            faces: [f32::INFINITY; 3],
            widths: [0.0; 3],
            steps: [0; 3],
            left: [0; 3],
        };
        let (mut near, mut far) = (0.0_f32, t_max);
        for i in 0..3 {
            if d[i].abs() < PARALLEL {
                if !(self.bounds.min[i] <= o[i] && o[i] <= self.bounds.max[i]) {
                    return walk;
                }
            } else {
                let a = (self.bounds.min[i] - o[i]) / d[i];
                let b = (self.bounds.max[i] - o[i]) / d[i];
                near = near.max(a.min(b));
                far = far.min(a.max(b));
            }
        }
        if !(near < far) {
            return walk;
        }
        walk.start = near;
        walk.t = near;
        walk.end = far;
        let strides = [1, self.size[0] as isize, (self.size[0] * self.size[1]) as isize];
        for i in 0..3 {
            let inside = o[i] + near * d[i] - self.bounds.min[i];
            let last = self.size[i] - 1;
            let index = ((inside / self.cell[i]) as usize).min(last);
            walk.cell += index * strides[i] as usize;
            if d[i].abs() < PARALLEL {
                continue;
            }
            let forward = d[i] > 0.0;
            let face = (index + usize::from(forward)) as f32 * self.cell[i];
            walk.left[i] = (if forward { last - index } else { index }) as u32;
            walk.steps[i] = if forward { strides[i] } else { -strides[i] };
            walk.widths[i] = self.cell[i] / d[i].abs();
            if walk.left[i] > 0 {
                walk.faces[i] = (face - inside) / d[i];
            }
        }
        walk
    }
}

/// The segments of one ray through a [`MajorantGrid`]: an iterator without allocation.
#[derive(Clone, Debug)]
pub struct CellWalk<'a> {
    cells: &'a [Cell],
    /// Index of the current cell.
    cell: usize,
    /// Where the ray enters the box.
    start: f32,
    /// Where the ray enters the current cell.
    t: f32,
    /// Where the walk ends.
    end: f32,
    /// Distance from `start` to the next face of each axis; infinite in the last cell.
    faces: [f32; 3],
    /// Distance from face to face of each axis.
    widths: [f32; 3],
    /// Change of `cell` across a face of each axis.
    steps: [isize; 3],
    /// Cells beyond the current one along each axis.
    left: [u32; 3],
}

impl Iterator for CellWalk<'_> {
    type Item = Segment;

    #[inline]
    fn next(&mut self) -> Option<Segment> {
        while self.t < self.end {
            let Cell { majorant, minorant } = self.cells[self.cell];
            let [x, y, z] = self.faces;
            let i = if x < y && x < z {
                0
            } else if y < z {
                1
            } else {
                2
            };
            let t0 = self.t;
            // A ray that starts on a face can find that face behind it by a rounding error: an empty stretch.
            let t1 = (self.start + self.faces[i]).max(t0).min(self.end);
            self.t = t1;
            if self.left[i] > 0 {
                self.cell = self.cell.wrapping_add_signed(self.steps[i]);
                self.left[i] -= 1;
                self.faces[i] = if self.left[i] > 0 { self.faces[i] + self.widths[i] } else { f32::INFINITY };
            }
            if t0 < t1 && majorant > 0.0 {
                return Some(Segment { t0, t1, majorant, minorant });
            }
        }
        None
    }
}
