//! The picture: reconstruction filters.

pub mod filter;
pub mod pixels;

pub use filter::FilterSampler;
