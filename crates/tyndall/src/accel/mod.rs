//! Acceleration structures over anything with bounds.

mod build;
pub mod bvh;
pub mod curve;
pub mod triangle;

pub use bvh::{Bvh, Visit};
pub use curve::CurveBuilder;
pub use triangle::{TrianglePacket, TriangleRay};
