//! Bringing light and camera together.

pub mod equiangular;
pub mod transport;
