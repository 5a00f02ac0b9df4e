//! Bringing light and camera together.
//!
//! Light's walks leave data (points, beams, planes), the camera's walks supply queries (points, beams). An estimator
//! says where one meets the other; what then happens is written once, here and in [`transport`]. With the dimensions Q of
//! the query, D of the datum and J of the blur, `Q + D + J - 3` one-dimensional integrals are left to be sampled (on
//! surfaces 2 stands for 3). A negative number means unresolved delta functions: such a pair does not compile.

pub mod cells;
pub mod connect;
pub mod edges;
pub mod equiangular;
pub mod gather;
pub mod joint;
pub mod merge;
pub mod pair;
pub mod query;
pub mod ray_pair;
pub mod transport;
pub mod turns;

pub use gather::gather;
pub use merge::{Meet, Merge};
pub use query::{BeamQuery, PointQuery, Query, SurfaceQuery};
