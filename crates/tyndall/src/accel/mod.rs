//! Acceleration structures over anything with bounds.

mod build;
pub mod bvh;
mod refine;
pub mod triangle;

pub use bvh::{Bvh, Visit};
pub use triangle::{TrianglePacket, TriangleRay};
