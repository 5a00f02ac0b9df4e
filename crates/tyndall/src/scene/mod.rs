//! What exists: shapes, BSDFs, media, phase functions, emitters, sensors, textures.

pub mod desc;
pub mod medium;
pub mod phase;
pub mod sensor;
pub mod shape;

pub use desc::SceneDesc;
