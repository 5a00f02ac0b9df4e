//! The free-flight loop, the random walk and what it tells its sinks.

pub mod flight;
pub mod passage;
pub mod record;
pub mod sink;
#[allow(clippy::module_inception, reason = "the walk is the noun of this room")]
pub mod walk;

pub use flight::{Flight, fly};
pub use passage::{Passage, passage};
pub use record::{Escape, Scattering, Segment, SurfaceHit, Vertex};
pub use sink::Sink;
pub use walk::{Rules, Start, walk};
