//! The picture: reconstruction filters, sums of samples, and light that is added anywhere.

pub mod filter;
pub mod layers;
pub mod pixels;
pub mod splats;

pub use filter::FilterSampler;
pub use splats::Splats;
