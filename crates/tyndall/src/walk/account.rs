//! Keeping what weights need while a walk goes on.

use super::reverse::{corner, reverse_pdf};
use super::{Edge, Effort, End, Leg, Mode, Onward, Segment, Vertex};
use crate::math::{Ray, Vec3};
use crate::scene::Scene;
use crate::scene::bsdf::Transport;
use crate::scene::emitter::{Emission, EndDensity, LightEnd};
use std::marker::PhantomData;

/// What a walk carries for the weights of multiple importance sampling. Sinks tell it what the walk does.
#[derive(Clone, Debug)]
pub struct Account<'a, M> {
    scene: &'a Scene,
    effort: &'a Effort,
    /// The leg on which the walk is.
    pub leg: Leg,
    /// The way since its start.
    pub edge: Edge,
    /// The emitter, on light's first leg.
    first: Option<(LightEnd, EndDensity)>,
    here: Option<End>,
    mode: PhantomData<M>,
}

impl<'a, M: Mode> Account<'a, M> {
    /// Of light's walk.
    #[inline]
    pub fn of_light(scene: &'a Scene, effort: &'a Effort, emission: &Emission) -> Self {
        let end = LightEnd::of_emission(emission, &scene.lights);
        let density = scene.lights.end_density(&end);
        let leg = Leg::from_emitter(effort, &density, emission.ray.origin);
        Self { scene, effort, leg, edge: Edge::START, first: Some((end, density)), here: None, mode: PhantomData }
    }

    /// Of the camera's walk along `ray`.
    #[inline]
    pub fn of_camera(scene: &'a Scene, effort: &'a Effort, ray: &Ray) -> Self {
        let leg = Leg::from_lens(effort, &scene.sensor.ray_density(ray));
        Self { scene, effort, leg, edge: Edge::START, first: None, here: None, mode: PhantomData }
    }

    /// The emitter, on light's first leg.
    #[inline]
    pub fn emitter(&self) -> Option<&(LightEnd, EndDensity)> {
        self.first.as_ref()
    }

    /// The leg if it ended at `position`.
    #[inline]
    pub fn leg_to(&self, position: Vec3) -> Leg {
        match &self.first {
            Some((end, density)) => {
                self.leg.lit(self.effort, density, self.scene.lights.sampled_density(position, end))
            }
            None => self.leg,
        }
    }

    /// The walk passes a stretch of a medium, up to the end of its flight.
    #[inline]
    pub fn pass(&mut self, segment: &Segment) {
        self.edge.pass(self.scene.medium(segment.medium), segment.ray, segment.flight.distance);
    }

    /// The walk comes to a vertex.
    #[inline]
    pub fn arrive(&mut self, vertex: &Vertex) -> End {
        let mut corner = corner(self.scene, self.effort, vertex);
        let leg = self.leg_to(vertex.position);
        corner.merges = corner.merges.at_end_of(&leg);
        let (cos, spread) = (corner.cos(vertex.direction), leg.spread(vertex.position));
        let arrival = leg.arrive::<M>(&self.edge, spread, cos, corner.in_medium());
        let merges_all = leg.first || leg.reflected && !corner.in_medium();
        let end = End { corner, arrival, first: leg.first, merges_all };
        self.here = Some(end);
        end
    }

    /// How many walks come here for each that is to go on: of many camera's walks, those that scatter by chance for the first
    /// time.
    #[inline]
    pub fn boost(&self, onward: &Onward) -> f32 {
        let here = self.here.as_ref().filter(|end| end.first && onward.pdf.is_some());
        here.map_or(1.0, |end| end.corner.merges.connect)
    }

    /// How many walks are to go on from here.
    #[inline]
    pub fn copies(&self) -> u32 {
        let here = self.here.as_ref().filter(|end| end.first);
        here.map_or(1, |end| (1.0 / end.corner.merges.connect).round() as u32)
    }

    /// The walk goes on from the vertex.
    #[inline]
    pub fn depart(&mut self, vertex: &Vertex, onward: &Onward) {
        let Some(End { corner, arrival, .. }) = self.here.take() else { return };
        let direction = onward.direction;
        let reverse = onward.pdf.map_or(1.0, |_| reverse_pdf::<M>(self.scene, vertex, direction).0);
        let leg = arrival.depart::<M>(self.effort, &corner, direction, onward.pdf.map(|pdf| pdf.0), reverse);
        self.leg = match M::TRANSPORT {
            Transport::Radiance => leg.following(&self.leg, &corner, onward.pdf.is_some()),
            Transport::Importance => leg,
        };
        self.edge = Edge::START;
        self.first = None;
    }
}
