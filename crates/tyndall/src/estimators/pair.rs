//! Joint importance sampling in a scene: two points at which light of an emitter is scattered, one on a segment of the
//! camera's walk and one around.
//!
//! Both lie in one homogeneous medium, and no surface, index-matched or not, is between them. The walk finds the same
//! points by free flight and phase function; what it needs to weigh that is a [`Bend`].

use super::joint::Joint;
use crate::Spectrum;
use crate::math::{PerLength, PerSolidAngle, Ray, Sampler, Vec3};
use crate::scene::Scene;
use crate::scene::desc::MediumId;
use crate::scene::emitter::{EmitterId, EmitterSample, LightPoint};
use crate::scene::medium::{Extinction, Homogeneous};
use crate::walk::Segment;
use crate::walk::flight::Uniform;

/// A segment in a homogeneous medium whose light emitters at finite distances may send.
#[derive(Clone, Copy, Debug)]
pub struct Stretch<'a> {
    /// The medium.
    pub model: &'a Homogeneous,
    /// Its extinction along the segment.
    pub uniform: Uniform,
    /// Length up to the next surface, or to where the medium has become opaque, metres.
    pub length: f32,
    /// Probability that light is scattered on it, times the share of emitters at finite distances.
    pub lit: f32,
    /// Distance at which the medium has become opaque, metres.
    pub opaque: f32,
}

/// Optical depth between the start of a segment and an emitter's point up to which every point gets joint samples.
const NEAR: f32 = 3.0;
/// Optical depth beyond which none does.
const FAR: f32 = 9.0;

/// Share of the joint samples for light of `target` that are taken on a segment from `origin`: all nearby, and fewer where light
/// of two scatterings is dim whichever way it takes.
#[inline]
fn nearness(origin: Vec3, target: Vec3, opaque: f32) -> f32 {
    let depth = origin.distance(target) * (Uniform::OPAQUE / opaque);
    if depth < FAR { (NEAR - depth).min(0.0).exp() } else { 0.0 }
}

impl<'a> Stretch<'a> {
    /// The first `length` metres of `ray`; `None` where there is nothing to sample.
    #[inline(always)]
    pub fn along(scene: &'a Scene, medium: MediumId, ray: &Ray, length: f32) -> Option<Self> {
        let medium = scene.medium(medium);
        let Extinction::Homogeneous(model) = medium.kind() else { return None };
        if !medium.sample_emitters() || !scene.lights.any_finite() {
            return None;
        }
        let uniform = Uniform::along(model, medium.phase(), ray);
        // A segment that leaves the scene is cut where the medium has become opaque.
        let opaque = uniform.opaque_distance();
        let length = length.min(opaque);
        let scattered = 1.0 - uniform.transmittance(length).mean();
        let lit = scattered * scene.lights.finite_share();
        (lit > 0.0).then_some(Self { model, uniform, length, lit, opaque })
    }
}

/// A vertex where the camera's walk turned, as the nearer of two points that joint sampling could have chosen.
#[derive(Clone, Copy, Debug)]
pub struct Bend {
    /// The segment on which it lies, and its length as a [`Stretch`].
    pub ray: Ray,
    /// Metres.
    pub length: f32,
    /// The medium of both.
    pub medium: MediumId,
    /// Where the vertex lies on the segment, metres.
    pub distance: f32,
    /// Density of the flight that ended there.
    pub flown: PerLength,
    /// Density of the direction in which the walk went on.
    pub phase: PerSolidAngle,
    /// [`Stretch::lit`] of the segment.
    pub lit: f32,
    /// [`Stretch::opaque`] of the segment, metres.
    pub opaque: f32,
}

impl Bend {
    /// Density with which joint sampling finds the bend, the distance `t` on the first `length` metres of the ray from
    /// there, and the emitter's point `target` seen from the end, in units of the density with which the walk finds the
    /// bend and the ray: per length and solid angle.
    #[inline]
    pub fn jointly(
        &self,
        scene: &Scene,
        joint: &Joint,
        ray: &Ray,
        length: f32,
        t: f32,
        emitter: EmitterId,
        target: Vec3,
        normal: Vec3,
    ) -> f32 {
        let share = self.lit * nearness(self.ray.origin, target, self.opaque);
        if share == 0.0 {
            return 0.0;
        }
        let light = scene.lights.segment_pdf(&self.ray, self.length, ray.at(t), emitter, target, normal);
        let approach = joint.approach(&self.ray, self.length, target).density(self.distance);
        let onward = joint.onward(ray, length, target);
        let chosen = share * light.0 * approach.0 * onward.direction(self.phase).0 * onward.density(t).0;
        chosen / (self.flown.0 * self.phase.0)
    }
}

/// Two points at which light is scattered, and where it comes from.
#[derive(Clone, Copy, Debug)]
pub struct Pair<'a> {
    /// Distance of the nearer point, b, on the segment, metres.
    pub distance: f32,
    /// The ray from b to the other point, c, and what there is along it.
    pub onward: Ray,
    /// The stretch of that ray.
    pub beyond: Stretch<'a>,
    /// Distance from b to c, metres.
    pub along: f32,
    /// The point on an emitter, chosen for the segment ...
    pub point: LightPoint,
    /// ... and its light at c.
    pub light: EmitterSample,
    /// Densities with which flights from the start of the segment end at b, and flights from b at c.
    pub flown: [PerLength; 2],
    /// Value and density of the phase function at b and c.
    pub phase: [PerSolidAngle; 2],
    /// Density of b, the direction from it, and c: per length squared and solid angle. The probability of joint sampling is
    /// in it, the emitter's density is not.
    pub density: f32,
    /// Throughput of the segment on arrival at c, which contains `sigma_s` but not the phase function there, over that
    /// density.
    pub throughput: Spectrum,
}

impl<'a> Pair<'a> {
    /// Two points for `segment`, whose stretch is given, as often as light is scattered on it; `None` otherwise, and where
    /// nothing arrives.
    #[inline]
    pub fn sample(
        scene: &'a Scene,
        joint: &Joint,
        segment: &Segment,
        stretch: &Stretch,
        sampler: &mut Sampler,
    ) -> Option<Self> {
        let choice = sampler.f32();
        if choice >= stretch.lit {
            return None;
        }
        let (ray, phase) = (segment.ray, scene.medium(segment.medium).phase());
        let point = scene.lights.sample_for_segment(ray, stretch.length, choice / stretch.lit, sampler.vec2())?;
        let nearness = nearness(ray.origin, point.position, stretch.opaque);
        if sampler.f32() >= nearness {
            return None;
        }
        let approach = joint.approach(ray, stretch.length, point.position);
        let distance = approach.sample(sampler.f32());
        let b = ray.at(distance);
        let direction = joint.sample_direction(phase, b, ray.direction, point.position, sampler.f32(), sampler.vec2());
        let onward = Ray { origin: b, direction };
        let hit = scene.geometry.intersect(&onward, f32::INFINITY);
        if hit.is_none() && scene.is_bounded(segment.medium) {
            return None;
        }
        let reach = hit.map_or(f32::INFINITY, |hit| hit.t);
        let beyond = Stretch::along(scene, segment.medium, &onward, reach)?;
        let sampling = joint.onward(&onward, beyond.length, point.position);
        let along = sampling.sample(sampler.f32());
        let c = onward.at(along);
        let light = scene.lights.incident(c, &point)?;

        // Heroes do not depend on the scale of the throughput: it need not be divided by the density of the flight to b.
        let (flown_b, transmittance) = stretch.uniform.collision(segment.throughput, distance);
        let at_b = segment.throughput * transmittance * stretch.uniform.sigma_t * stretch.model.albedo(b);
        let (flown_c, transmittance) = beyond.uniform.collision(at_b, along);
        let at_c = at_b * transmittance * beyond.uniform.sigma_t * beyond.model.albedo(c);
        let turn_b = PerSolidAngle(phase.eval(b, ray.direction, direction));
        let turn_c = PerSolidAngle(phase.eval(c, direction, light.direction));
        let density = stretch.lit
            * nearness
            * approach.density(distance).0
            * sampling.direction(turn_b).0
            * sampling.density(along).0;
        let throughput = at_c * (turn_b.0 / density);
        let (flown, phase) = ([flown_b, flown_c], [turn_b, turn_c]);
        let pair = Self { distance, onward, beyond, along, point, light, flown, phase, density, throughput };
        (!throughput.is_black()).then_some(pair)
    }

    /// The farther point, metres.
    #[inline]
    pub fn c(&self) -> Vec3 {
        self.onward.at(self.along)
    }

    /// Density with which the walk finds both points.
    #[inline]
    pub fn walked(&self) -> f32 {
        self.flown[0].0 * self.phase[0].0 * self.flown[1].0
    }
}
