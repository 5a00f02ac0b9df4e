//! Grids of samples.

pub mod vol;
