//! What light's walks leave behind: points, beams and planes, indexed for the camera's queries.
//!
//! Data are traced into plain vectors in the order of the light paths, then arranged by a [`Bvh`] into
//! structure-of-arrays leaf blocks: what a query tests lies in rows of eight, what a hit needs besides is kept apart.

mod arranged;
pub mod beam;
pub mod footprint;
pub mod packed;
pub mod plane;
pub mod point;
pub mod radii;
pub mod terms;
pub mod trace;

pub use beam::{Attenuation, Beam, BeamBlock, BeamRadius, Beams, Width};
pub use packed::{Flux, Origin, Tag};
pub use plane::{Plane, PlaneBlock, Planes};
pub use point::{Photon, PointBlock, Points};
pub use terms::BeamTerms;
pub use trace::{Extent, LightPaths, TraceError, Tracing, Wanted};

use crate::Spectrum;
use crate::accel::{Bvh, prefetch};
use crate::math::Vec3;
use crate::scene::medium::Medium;

/// Light that a datum sends to a place.
#[derive(Clone, Copy, Debug)]
pub struct Arriving {
    /// Unit direction of travel.
    pub direction: Vec3,
    /// Flux ready to be scattered: multiplied by a blur of dimension J and by a phase function it is a radiance times
    /// the number of light paths.
    pub flux: Spectrum,
}

/// Data of one kind, indexed.
pub trait Store: Sync {
    /// Dimension of a datum: 0 for points, 1 for beams, 2 for planes.
    const DIMENSION: u32;
    /// Eight data, as far as a query's test needs them.
    type Block;

    /// The hierarchy; its leaves are the blocks.
    fn bvh(&self) -> &Bvh;
    /// The block of a leaf.
    fn block(&self, leaf: u32) -> &Self::Block;
    /// Asks for the memory of a block that is needed soon.
    #[inline(always)]
    fn announce(&self, leaf: u32) {
        prefetch(std::slice::from_ref(self.block(leaf)));
    }
    /// Number of the datum in the order in which light paths left them.
    fn index(&self, leaf: u32, lane: usize) -> u32;
    /// What decides whether a datum counts.
    fn tag(&self, leaf: u32, lane: usize) -> Tag;
    /// Light of the datum at its own coordinates `s`, scattered at `x`; `medium` is the one around, `None` on surfaces.
    fn arriving(&self, leaf: u32, lane: usize, s: [f32; 2], x: Vec3, medium: Option<&Medium>) -> Arriving;
}
