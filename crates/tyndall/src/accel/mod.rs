//! Acceleration structures, over bounds or positions alone. All are built by several threads, and the result does not
//! depend on their number.
//!
//! - [`Bvh`] over anything with bounds: along rays, nearest first or not, and overlapping boxes.
//! - [`Grid`] over points: all within one radius, the same for all queries. Several times faster than the tree.
//! - [`KdTree`] over points: the k nearest, into a re-usable heap of [`Neighbours`].
//!
//! `Bvh` and `Grid` answer with an order of the items: users arrange their own data by it, in packets of eight, and
//! are given leaves or ranges to visit. `KdTree` keeps the positions itself and answers with indices. `Grid` and `KdTree`
//! are rebuilt in place. A gather with the grid, in lanes:
//!
//! ```
//! use tyndall::accel::{Grid, grid, prefetch};
//! use tyndall::math::Vec3;
//! use tyndall::math::lanes::{Kernel, Lanes, Level, Mask, Row, WIDTH};
//!
//! /// How many points there are within the radius of `x`.
//! struct Count<'a> {
//!     grid: &'a Grid,
//!     rows: &'a [[Row; 3]],
//!     x: Vec3,
//!     radius: f32,
//! }
//!
//! impl Kernel for Count<'_> {
//!     type Output = u32;
//!     #[inline(always)]
//!     fn run<L: Lanes>(self) -> u32 {
//!         let near = self.grid.near(self.x);
//!         near.iter().for_each(|range| prefetch(&self.rows[grid::rows(range)]));
//!         let mut count = 0;
//!         for range in near.iter() {
//!             for row in grid::rows(range.clone()) {
//!                 let [x, y, z] = &self.rows[row];
//!                 let dx = L::load(x).sub(L::splat(self.x.x));
//!                 let dy = L::load(y).sub(L::splat(self.x.y));
//!                 let dz = L::load(z).sub(L::splat(self.x.z));
//!                 let squared = dx.mul(dx).add(dy.mul(dy)).add(dz.mul(dz));
//!                 let within = squared.le(L::splat(self.radius * self.radius)).bits();
//!                 count += (within & grid::lanes(range.clone(), row)).count_ones();
//!             }
//!         }
//!         count
//!     }
//! }
//!
//! let positions: Vec<Vec3> = (0..100).map(|i| Vec3::X * i as f32).collect();
//! let mut grid = Grid::default();
//! grid.rebuild(&positions, 2.5);
//! let mut rows = vec![[Row([0.0; WIDTH]); 3]; positions.len().div_ceil(WIDTH)];
//! for (i, point) in grid.order().iter().enumerate() {
//!     let position = positions[*point as usize].to_array();
//!     (0..3).for_each(|axis| rows[i / WIDTH][axis].0[i % WIDTH] = position[axis]);
//! }
//! let count = Level::dispatch(Count { grid: &grid, rows: &rows, x: Vec3::X * 50.0, radius: 2.5 });
//! assert_eq!(count, 5);
//! ```

mod build;
pub mod bvh;
pub mod curve;
pub mod grid;
pub mod kdtree;
mod neighbours;
#[cfg(test)]
mod point_sets;
mod prefetch;
mod refine;
mod stack;
pub mod triangle;

pub use bvh::{Bvh, Visit};
pub use curve::CurveBuilder;
pub use grid::Grid;
pub use kdtree::KdTree;
pub use neighbours::Neighbours;
pub use prefetch::prefetch;
pub use triangle::{TrianglePacket, TriangleRay};

/// Gives a buffer that length. One that is too small is replaced, not grown: growing may take twice what is needed.
fn resize<T>(buffer: &mut Vec<T>, len: usize, fill: impl FnMut() -> T) {
    if buffer.capacity() < len {
        *buffer = Vec::new();
        buffer.reserve_exact(len);
    }
    buffer.resize_with(len, fill);
}
