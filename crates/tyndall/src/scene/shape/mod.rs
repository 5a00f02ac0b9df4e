//! Shapes: what a ray can hit, and what is known of the point it hits.

pub mod mesh;
pub mod surface;

pub use mesh::Mesh;
pub use surface::SurfacePoint;
