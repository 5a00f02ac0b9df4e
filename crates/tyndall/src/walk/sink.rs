//! Who listens to a walk.

use super::{Escape, Onward, Segment, SurfaceHit, Vertex};
use crate::math::Sampler;

/// Receives what a walk meets, in order. Every method does nothing unless implemented.
pub trait Sink {
    /// A piece of a leg inside a medium. Called after the flight was sampled, before its outcome.
    fn segment(&mut self, _segment: &Segment, _sampler: &mut Sampler) {}

    /// Whether the segments of leg number `leg` must have their whole length, even where the flight ends before it.
    fn looks_beyond(&self, _leg: u32) -> bool {
        true
    }

    /// A surface, index-matched or not.
    fn surface(&mut self, _hit: &SurfaceHit) {}

    /// A point where light scatters.
    fn vertex(&mut self, _vertex: &Vertex, _sampler: &mut Sampler) {}

    /// The walk would go on from `vertex`. Answers whether it does.
    fn scattered(&mut self, _vertex: &Vertex, _onward: &Onward) -> bool {
        true
    }

    /// The walk left the scene.
    fn escape(&mut self, _escape: &Escape) {}
}
