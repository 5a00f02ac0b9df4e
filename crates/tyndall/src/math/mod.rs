//! Vectors, frames, transforms, warps, random numbers and measures.

pub mod angle;
pub mod bounds;
pub mod frame;
pub mod functions;
pub mod kernels;
pub mod lanes;
pub mod measure;
pub mod octahedral;
pub mod polyline;
pub mod random;
pub mod ray;
pub mod sampler;
pub mod sobol;
pub mod transform;
pub(crate) mod triples;
pub mod warp;

pub use bounds::Aabb;
pub use frame::Frame;
pub use glam::{Vec2, Vec3};
pub use kernels::Kernel;
pub use measure::{PerArea, PerLength, PerSolidAngle, PerVolume};
pub use random::Rng;
pub use ray::Ray;
pub use sampler::Sampler;
pub use transform::{Affine, Transform};
