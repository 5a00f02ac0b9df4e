//! The free-flight loop, the random walk and what it tells its sinks.

pub mod flight;
pub mod passage;
pub mod profile;
pub mod record;
pub mod sink;
#[allow(clippy::module_inception, reason = "the walk is the noun of this room")]
pub mod walk;

pub use flight::{Flight, fly};
pub use passage::{Passage, passage};
pub use profile::Profile;
pub use record::{Escape, Onward, Scattering, Segment, SurfaceHit, Vertex};
pub use sink::Sink;
pub use walk::{FromCamera, FromLight, Media, Mode, Rules, Start, walk};
