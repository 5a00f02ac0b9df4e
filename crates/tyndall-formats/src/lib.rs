//! Scene, mesh, grid and image files.

pub mod file;
pub mod grid;
pub mod image;
pub mod mesh;
pub mod mitsuba;

pub use file::FileError;
