//! The picture: reconstruction filters.

pub mod filter;

pub use filter::FilterSampler;
