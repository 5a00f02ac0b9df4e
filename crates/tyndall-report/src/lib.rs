//! Error metrics of images, and the comparison report.

pub mod agreement;
mod blocks;
pub mod flip;
pub mod hdr_flip;
pub mod merge;
pub mod metrics;
pub mod report;
pub mod split;
pub mod summary;
mod view;

pub use view::{MetricError, View};
