//! What exists: shapes, BSDFs, media, phase functions, emitters, sensors, textures.

pub mod bsdf;
pub mod desc;
pub mod emitter;
pub mod medium;
pub mod phase;
pub mod sensor;
pub mod shape;
pub mod texture;

pub use desc::SceneDesc;
