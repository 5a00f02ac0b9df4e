//! `jis`: volumetric path tracing with joint importance sampling of two scattering events.
//!
//! On a segment through a homogeneous medium an emitter's point d is chosen, and with it at once a point b on the segment
//! and a point c in the medium around, by [`crate::estimators::joint`]. Light of d that is scattered at c and b is found so
//! with the density `q p(d) p(b | d) p(w | b, d) p(c | b, w, d)`, and by the walk with `p_flight(b) p_phase(w)` times the
//! densities of its own techniques at c; the balance heuristic weighs all of them. `q` counts samples that are added to
//! those of the walk, which goes on as it would without.
//!
//! The line from b to c ends at the first surface, index-matched or not: c is in the medium of b. What the walk finds beyond
//! has the weight that it had.

use super::{Options, SampledFlight, Stretch, Tracer, Volpath, common};
use crate::estimators::equiangular::Equiangular;
use crate::estimators::joint::Approach;
use crate::integrators::components::Components;
use crate::integrators::{IntegratorInfo, ParameterInfo, ParameterKind};
use crate::math::{PerSolidAngle, Ray, Sampler, Vec3};
use crate::scene::emitter::EmitterId;
use crate::walk::Segment;

/// The parameter of `volpath`.
pub(super) const PARAMETER: ParameterInfo = ParameterInfo {
    name: "joint",
    kind: ParameterKind::Boolean,
    default: "false",
    unit: "",
    description: "Whether two scattering events are sampled jointly as well, as `jis` does, where equiangular sampling is used.",
};

/// The registry's entry.
pub const INFO: IntegratorInfo = IntegratorInfo {
    name: "jis",
    aliases: &[],
    summary: "Volumetric path tracing with joint importance sampling of double scattering.",
    source: "Georgiev, Krivanek, Hachisuka, Nowrouzezahrai and Jarosz 2013",
    parameters: &[
        common::MAX_DEPTH,
        common::RR_DEPTH,
        common::HIDE_EMITTERS,
        Components::PARAMETER,
        super::EQUIANGULAR_LEGS,
    ],
    make: |parameters| Ok(Box::new(Volpath::new(Options { joint: true, ..Options::read(parameters, true)? }))),
};

/// A vertex of the walk that joint sampling could have chosen as b.
#[derive(Clone, Copy)]
pub(super) struct Bend {
    flight: SampledFlight,
    /// Density of the direction in which the walk went on.
    phase: PerSolidAngle,
}

impl Bend {
    /// At the end of `flight`, if there was one.
    #[inline(always)]
    pub(super) fn at(flight: Option<SampledFlight>, phase: Option<PerSolidAngle>) -> Option<Self> {
        let flight = flight.filter(|flight| flight.joint > 0.0)?;
        Some(Self { flight, phase: phase? })
    }
}

impl Tracer<'_> {
    /// Density with which joint sampling finds `bend`, the distance `t` on the first `length` metres of the ray from there, and
    /// the emitter's point `target` seen from the end, in units of the density with which the walk found the bend and the
    /// ray.
    #[inline]
    pub(super) fn joint_density(
        &self,
        bend: &Bend,
        ray: &Ray,
        length: f32,
        t: f32,
        emitter: EmitterId,
        target: Vec3,
        normal: Vec3,
    ) -> f32 {
        let Bend { flight, phase } = bend;
        let light = self.scene.lights.segment_pdf(&flight.ray, flight.length, ray.at(t), emitter, target, normal);
        let first = Approach::new(&flight.ray, flight.length, target).density(flight.distance);
        let onward = self.joints[flight.medium.0].onward(ray, length, target);
        let chosen = flight.joint * light.0 * first.0 * onward.direction(*phase).0 * onward.density(t).0;
        chosen / (flight.density.0 * phase.0)
    }

    /// Adds, with the probability `share`, light that is scattered twice: last on `segment`, and before around it.
    #[inline]
    pub(super) fn connect_jointly(&mut self, segment: &Segment, stretch: &Stretch, share: f32, sampler: &mut Sampler) {
        let mut history = self.history;
        history.scatter(true, false);
        if segment.scatterings + 3 > self.options.rules.max_depth
            || !self.options.components.has(history.lit_straight(true))
        {
            return;
        }
        let rng = sampler.rng();
        let choice = rng.f32();
        if choice >= share {
            return;
        }
        let (scene, ray, length) = (self.scene, segment.ray, stretch.length);
        let (medium, joint) = (scene.medium(segment.medium), &self.joints[segment.medium.0]);
        let Some(point) = scene.lights.sample_for_segment(ray, length, choice / share, rng.vec2()) else { return };

        let approach = Approach::new(ray, length, point.position);
        let t = approach.sample(rng.f32());
        let b = ray.at(t);
        let direction =
            joint.sample_direction(medium.phase(), b, ray.direction, point.position, rng.f32(), rng.vec2());
        let onward = Ray { origin: b, direction };
        let hit = scene.geometry.intersect(&onward, f32::INFINITY);
        if hit.is_none() && scene.is_bounded(segment.medium) {
            return;
        }
        let reach = hit.map_or(f32::INFINITY, |hit| hit.t);
        let Some(beyond) = self.stretch(segment.medium, &onward, reach, segment.leg + 1) else { return };
        let sampling = joint.onward(&onward, beyond.length, point.position);
        let s = sampling.sample(rng.f32());
        let c = onward.at(s);
        let Some(light) = scene.lights.incident(c, &point) else { return };

        // In units of the throughput divided by the density of the flight to b, which heroes do not depend on.
        let (flown_b, transmittance) = stretch.uniform.collision(segment.throughput, t);
        let at_b = segment.throughput * transmittance * stretch.uniform.sigma_t * stretch.model.albedo(b);
        let (flown_c, transmittance) = beyond.uniform.collision(at_b, s);
        let phase_b = PerSolidAngle(medium.phase().eval(b, ray.direction, direction));
        let phase_c = PerSolidAngle(medium.phase().eval(c, direction, light.direction));
        let at_c = at_b * transmittance * beyond.uniform.sigma_t * beyond.model.albedo(c);
        let scattered = at_c * (phase_b.0 * phase_c.0);
        if scattered.is_black() {
            return;
        }
        let Some((arriving, survival)) = self.connect(c, &light, Some(segment.medium), sampler) else { return };

        // Densities of b per length, of c per solid angle and length, and of the emitter per solid angle.
        let pair = share * approach.density(t).0 * sampling.direction(phase_b).0 * sampling.density(s).0;
        let walked = flown_b.0 * phase_b.0;
        let share_c = super::EQUIANGULAR_SHARE * beyond.lit;
        let by_emitter = (1.0 - share_c) * flown_c.0 * scene.lights.pdf_light_point(c, &point).0;
        let by_phase = if light.delta { 0.0 } else { flown_c.0 * phase_c.0 * survival };
        let from_c = scene.lights.segment_pdf(&onward, beyond.length, c, light.emitter, light.position, light.normal);
        let equiangular = Equiangular::new(&onward, beyond.length, point.position).density(s);
        let by_equiangular = share_c * from_c.0 * equiangular.0;
        let chosen = pair * light.pdf.0;
        let weight = chosen / (chosen + walked * (by_emitter + by_phase + by_equiangular));
        self.radiance += scattered * arriving * (weight / pair);
    }
}
