//! Joint importance sampling of two scattering events on the camera's walk.
//!
//! Weights come in two steps. Emitter sampling from the walk has its weight against all other techniques, as ever. What it
//! then gives is shared with joint sampling of its last two vertices, by the densities of the two alone: the
//! other techniques know nothing of joint sampling, whose density depends on more of the path than they carry.

use super::camera::CameraPath;
use crate::Spectrum;
use crate::estimators::joint::Joint;
use crate::estimators::pair::{Bend, Pair, Stretch};
use crate::math::{PerSolidAngle, Sampler};
use crate::mis::Recorder;
use crate::scene::Scene;
use crate::scene::emitter::EmitterSample;
use crate::walk::{Onward, Scattering, Segment, Vertex};

/// What the camera's walk remembers.
pub(super) struct Pairing<'a> {
    /// By medium; none where two points are not sampled jointly.
    joints: &'a [Joint],
    /// The flight to the current vertex, its direction onward unknown.
    flight: Option<Bend>,
    /// The bend from which the current segment leaves.
    bend: Option<Bend>,
}

impl<'a> Pairing<'a> {
    pub(super) fn new(joints: &'a [Joint]) -> Self {
        Self { joints, flight: None, bend: None }
    }

    /// The walk meets a surface.
    pub(super) fn leave(&mut self) {
        self.bend = None;
        self.flight = None;
    }

    /// The walk goes on from a vertex.
    pub(super) fn depart(&mut self, onward: &Onward) {
        self.bend = self.flight.take().zip(onward.pdf).map(|(flight, phase)| Bend { phase, ..flight });
    }

    /// Share of emitter sampling at the vertex of what it and joint sampling give.
    pub(super) fn share_of_walk(&self, scene: &Scene, light: &EmitterSample) -> f32 {
        let (Some(bend), Some(flight)) = (&self.bend, &self.flight) else { return 1.0 };
        if !scene.lights.is_finite(light.emitter) {
            return 1.0;
        }
        let joint = &self.joints[bend.medium.0];
        let (emitter, target, normal) = (light.emitter, light.position, light.normal);
        let jointly = bend.jointly(scene, joint, &flight.ray, flight.length, flight.distance, emitter, target, normal);
        let walked = flight.flown.0 * light.pdf.0;
        walked / (walked + jointly)
    }
}

impl<R: Recorder> CameraPath<'_, '_, R> {
    /// Adds light that is scattered twice: last on `segment`, and before around it.
    pub(super) fn add_pair(&mut self, segment: &Segment, sampler: &mut Sampler) {
        self.pairing.flight = None;
        if self.pairing.joints.is_empty() {
            return;
        }
        let (scene, ray) = (self.scene, segment.ray);
        let Some(stretch) = Stretch::along(scene, segment.medium, ray, segment.length) else { return };
        let (medium, Stretch { length, lit, opaque, .. }) = (segment.medium, stretch);
        let distance = segment.flight.distance;
        self.pairing.flight = segment.flight.density.map(|flown| {
            let phase = PerSolidAngle(0.0);
            Bend { ray: *ray, length, medium, distance, flown, phase, lit, opaque }
        });
        if segment.scatterings + 3 > self.options.rules.max_depth {
            return;
        }
        let joint = &self.pairing.joints[medium.0];
        let Some(pair) = Pair::sample(scene, joint, segment, &stretch, sampler) else { return };

        // The walk as if it had come to both points.
        let scattering = Scattering::Medium { medium };
        let Segment { scatterings, leg, .. } = *segment;
        let (position, direction, throughput) = (ray.at(pair.distance), ray.direction, Spectrum::ONE);
        let b = Vertex { position, direction, throughput, scatterings, leg, scattering };
        let (position, direction, throughput) = (pair.c(), pair.onward.direction, pair.throughput);
        let c = Vertex { position, direction, throughput, scatterings: scatterings + 1, leg: leg + 1, scattering };
        let mut account = self.account.clone();
        account.edge.pass(scene.medium(medium), ray, pair.distance);
        account.arrive(&b);
        account.depart(&b, &Onward { direction, pdf: Some(pair.phase[0]), eta: 1.0 });
        account.edge.pass(scene.medium(medium), &pair.onward, pair.along);
        let end = account.arrive(&c);

        let chosen = pair.density * pair.light.pdf.0;
        let walked = pair.walked() * scene.lights.pdf_light_point(position, &pair.point).0;
        self.add_lit(&c, &end, &pair.light, chosen / (chosen + walked), sampler);
    }
}
