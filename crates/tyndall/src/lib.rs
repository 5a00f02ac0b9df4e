//! A renderer for participating media.

pub mod accel;
pub mod film;
pub mod math;
pub mod scene;
mod spectrum;

pub use scene::desc::SceneDesc;
pub use spectrum::Spectrum;
