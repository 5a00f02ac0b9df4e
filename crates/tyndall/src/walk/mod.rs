//! The free-flight loop, the random walk and what it tells its sinks.

pub mod account;
pub mod density;
pub mod edge;
pub mod flight;
pub mod passage;
pub mod profile;
pub mod record;
pub mod reverse;
pub mod sink;
pub mod terms;
#[allow(clippy::module_inception, reason = "the walk is the noun of this room")]
pub mod walk;

pub use account::Account;
pub use density::{LightDensity, Place};
pub use edge::Edge;
pub use flight::{Flight, fly};
pub use passage::{Passage, edge_passage, passage, passage_from};
pub use profile::Profile;
pub use record::{Escape, Onward, Scattering, Segment, SurfaceHit, Vertex};
pub use reverse::{corner, reverse_pdf};
pub use sink::Sink;
pub use terms::{Arrival, Corner, Effort, End, Leg, Merges};
pub use walk::{FromCamera, FromLight, Media, Mode, Rules, Start, walk};
