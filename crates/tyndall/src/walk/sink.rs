//! Who listens to a walk.

use super::{Escape, Onward, Segment, Start, SurfaceHit, Vertex};
use crate::math::Sampler;

/// Receives what a walk meets, in order. Every method does nothing unless implemented.
pub trait Sink {
    /// Whether the walk, where it first meets smooth glass, goes on through it and tells [`Sink::fork`] of its reflection, in place of
    /// choosing one of both, and asks for [`Sink::copies`].
    const FORKS: bool = false;

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

    /// How many walks go on from a surface, this one and those that [`Sink::fork`] is told of. Null scattering and smooth mirrors
    /// among them are for the sink to leave out.
    fn copies(&self) -> u32 {
        1
    }

    /// Another walk would start at `vertex`.
    fn fork(&mut self, _vertex: &Vertex, _onward: &Onward, _start: Start) {}

    /// The walk left the scene.
    fn escape(&mut self, _escape: &Escape) {}
}
