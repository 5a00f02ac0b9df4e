//! What exists: shapes, BSDFs, media, phase functions, emitters, sensors, textures.

pub mod bsdf;
pub mod desc;
pub mod emitter;
pub mod shape;
pub mod texture;

pub use desc::SceneDesc;
