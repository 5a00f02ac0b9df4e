//! Error metrics of images.

pub mod flip;
pub mod merge;
pub mod metrics;
mod view;

pub use view::{MetricError, View};
