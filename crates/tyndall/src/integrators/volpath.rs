//! `volpath`: volumetric path tracing.
//!
//! One random walk from the camera; at every vertex an emitter is sampled. On a flight through a homogeneous medium the
//! emitter's point may come first and the distance near it second. Three techniques find single scattering, weighted
//! by the balance heuristic over their joint densities of distance and direction; a coin of probability `q` decides
//! between the first and the third before the flight (one-sample model, Veach 1997, section 9.2.4):
//!
//! - free flight, then an emitter: `(1 - q) p_flight(t) p_light(w)`;
//! - free flight, then the phase function hits the emitter: `p_flight(t) p_phase(w) P`, `P` the probability of arriving;
//! - a point on an emitter, then the distance by equiangular sampling: `q p_equiangular(t | y) p_segment(y)`.
//!
//! Light that is scattered twice on its way to the ray can be found by one more, [`joint`].

pub mod common;
pub mod joint;

use super::components::{Components, History};
use super::parameters::{ParameterError, Parameters};
use super::{Integrator, IntegratorInfo, Job, ParameterInfo, RareEvents, path, sample_pixels};
use crate::Spectrum;
use crate::estimators::equiangular::Equiangular;
use crate::estimators::joint::Joint;
use crate::estimators::pair::{Bend, Stretch};
use crate::estimators::transport::{Response, connect, departure, respond, samples_emitters};
use crate::film::Splats;
use crate::film::pixels::PixelSum;
use crate::math::{PerLength, PerSolidAngle, Ray, Sampler, Vec2, Vec3};
use crate::photons::TraceError;
use crate::scene::Scene;
use crate::scene::desc::MediumId;
use crate::scene::emitter::{EmitterId, EmitterSample};
use crate::walk::{
    Escape, FromCamera, Media, Onward, Rules, Scattering, Segment, Sink, Start, SurfaceHit, Vertex, walk,
};

/// Probability of equiangular sampling on a flight that is sure to end in the medium, if all emitters are at finite
/// distances.
const EQUIANGULAR_SHARE: f32 = 0.5;

/// Largest probability of surviving Russian roulette, as in Mitsuba.
pub(super) const RR_CAP: f32 = 0.95;

const EQUIANGULAR_LEGS: ParameterInfo = ParameterInfo {
    name: "equiangular_legs",
    kind: super::ParameterKind::Integer,
    default: "-1",
    unit: "",
    description: "Number of first legs of a path on which equiangular sampling is used; -1 is all, 0 is none.",
};

/// The registry's entry.
pub const INFO: IntegratorInfo = IntegratorInfo {
    name: "volpath",
    aliases: &["volpathmis"],
    summary: "Volumetric path tracing with emitter, phase-function, BSDF and equiangular sampling.",
    source: "Kajiya and von Herzen 1984; Lafortune and Willems 1996; Kulla and Fajardo 2012; Miller et al. 2019",
    parameters: &[
        common::MAX_DEPTH,
        common::RR_DEPTH,
        common::HIDE_EMITTERS,
        Components::PARAMETER,
        EQUIANGULAR_LEGS,
        joint::JOINT,
        ParameterInfo {
            name: "use_spectral_mis",
            kind: super::ParameterKind::Boolean,
            default: "true",
            unit: "",
            description: "Accepted from scene files; chromatic media are always sampled with spectral MIS.",
        },
    ],
    make: |parameters| Ok(Box::new(Volpath::new(Options::read(parameters, true)?))),
};

/// Choices of the path tracer.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    rules: Rules,
    hide_emitters: bool,
    equiangular_legs: u32,
    /// Whether two points are sampled jointly as well.
    joint: bool,
    components: Components,
    /// A bound on 1/d^2 over the edge of length d between the first two vertices: light over it counts with the part that
    /// the bound cuts off. 0: with all.
    bound: f32,
}

/// A count with -1 for "no limit".
pub(super) fn depth(parameters: &Parameters, name: &'static str) -> Result<u32, ParameterError> {
    match parameters.integer(name) {
        -1 => Ok(u32::MAX - 2),
        n => u32::try_from(n)
            .ok()
            .filter(|n| *n < u32::MAX - 2)
            .ok_or_else(|| parameters.out_of_range(name, "-1 (no limit) or a whole number from 0")),
    }
}

impl Options {
    /// From the parameters of a registry entry.
    pub(super) fn read(parameters: &Parameters, media: bool) -> Result<Self, ParameterError> {
        let rr_depth = u32::try_from(parameters.integer("rr_depth")).ok().filter(|d| *d > 0);
        let rr_depth = rr_depth.ok_or_else(|| parameters.out_of_range("rr_depth", "a whole number from 1"))?;
        let media_rule = if media { Media::Scatter } else { Media::Absent };
        Ok(Self {
            rules: Rules { max_depth: depth(parameters, "max_depth")?, rr_depth, rr_cap: RR_CAP, media: media_rule },
            hide_emitters: parameters.boolean("hide_emitters"),
            equiangular_legs: if media { depth(parameters, "equiangular_legs")? } else { 0 },
            joint: parameters.declares("joint") && parameters.boolean("joint"),
            components: if media { Components::read(parameters)? } else { Components::ALL },
            bound: 0.0,
        })
    }

    /// Emitters seen directly.
    pub(super) fn emitted(hide_emitters: bool) -> Self {
        Self {
            rules: Rules { max_depth: 1, rr_depth: 5, rr_cap: RR_CAP, media: Media::Scatter },
            hide_emitters,
            equiangular_legs: 0,
            joint: false,
            components: Components::ALL,
            bound: 0.0,
        }
    }

    /// Beside a method that gives the other components, and of light over the edge between the first two vertices what is
    /// below `bound` (1/m^2).
    pub(super) fn beside(parameters: &Parameters, components: Components, bound: f32) -> Result<Self, ParameterError> {
        let rr_depth = parameters.count("rr_depth", 1, "a whole number from 1")?;
        let max_depth = depth(parameters, "max_depth")?;
        Ok(Self {
            rules: Rules { max_depth, rr_depth, rr_cap: RR_CAP, media: Media::Scatter },
            hide_emitters: parameters.boolean("hide_emitters"),
            equiangular_legs: u32::MAX,
            joint: false,
            components,
            bound,
        })
    }

    /// The same with another bound (1/m^2).
    pub(super) fn bounded(self, bound: f32) -> Self {
        Self { bound, ..self }
    }

    /// Direct light of surfaces.
    pub(super) fn direct(parameters: &Parameters) -> Self {
        Self {
            rules: Rules { max_depth: 2, rr_depth: 5, rr_cap: RR_CAP, media: Media::Absent },
            hide_emitters: parameters.boolean("hide_emitters"),
            equiangular_legs: 0,
            joint: false,
            components: Components::ALL,
            bound: 0.0,
        }
    }
}

/// The integrator.
pub struct Volpath {
    options: Options,
    /// By medium; none where two points are not sampled jointly.
    joints: Vec<Joint>,
}

impl Volpath {
    /// A path tracer with these choices.
    pub(super) fn new(options: Options) -> Self {
        Self { options, joints: Vec::new() }
    }
}

impl Integrator for Volpath {
    fn warnings(&self, scene: &Scene) -> Vec<String> {
        if self.options.rules.media == Media::Absent {
            path::warnings(scene)
        } else {
            scene.hidden_caustics().into_iter().collect()
        }
    }

    fn prepare(&mut self, scene: &Scene, _: u64, _: u32) -> Result<u32, TraceError> {
        if self.options.joint && self.joints.is_empty() {
            self.joints = Joint::of_media(scene);
        }
        Ok(u32::MAX)
    }

    fn render(&self, scene: &Scene, job: &Job, pixels: &mut [PixelSum], _: &mut Splats) -> RareEvents {
        sample_pixels(scene, job, pixels, |sample, sampler| self.radiance(scene, sample.film, sampler))
    }
}

impl Volpath {
    /// Radiance arriving at the film position (pixels of the whole film), one sample.
    #[inline]
    pub(super) fn radiance(&self, scene: &Scene, film: Vec2, sampler: &mut Sampler) -> Spectrum {
        let camera = scene.sensor.sample_ray(film, sampler.vec2());
        let mut tracer = Tracer {
            scene,
            options: &self.options,
            joints: &self.joints,
            radiance: Spectrum::ZERO,
            last: Last { position: camera.ray.origin, pdf: None, survival: 1.0, sampled: None, bend: None },
            flight: None,
            bend: None,
            equiangular: false,
            history: History::START,
            share: 1.0,
        };
        walk::<FromCamera, _>(scene, Start::seen(scene, &camera), &self.options.rules, sampler, &mut tracer);
        tracer.radiance
    }
}

/// The segment on which the latest collision was sampled, for the densities of techniques that begin with the emitter.
#[derive(Clone, Copy)]
struct SampledFlight {
    ray: Ray,
    length: f32,
    medium: MediumId,
    distance: f32,
    density: PerLength,
    /// Probability of equiangular sampling.
    share: f32,
    /// As in [`Stretch`].
    lit: f32,
    opaque: f32,
}

impl SampledFlight {
    /// The end of the flight where the walk went on with that density.
    #[inline(always)]
    fn bend(&self, phase: PerSolidAngle) -> Bend {
        let &Self { ray, length, medium, distance, density: flown, lit, opaque, .. } = self;
        Bend { ray, length, medium, distance, flown, phase, lit, opaque }
    }
}

/// What the weights of multiple importance sampling need to know of the last vertex.
#[derive(Clone, Copy)]
struct Last {
    position: Vec3,
    /// Density of the direction; `None` where no emitter was sampled as well: the camera, or a delta distribution.
    pdf: Option<PerSolidAngle>,
    /// Probability of having come so far since, as in `Passage::survival`.
    survival: f32,
    /// The flight that led to it, if the last vertex is one that equiangular sampling could have chosen.
    sampled: Option<SampledFlight>,
    /// The bend from which that flight came, if joint sampling could have chosen both.
    bend: Option<Bend>,
}

/// The sink that turns a walk into radiance.
struct Tracer<'a> {
    scene: &'a Scene,
    options: &'a Options,
    /// By medium; none where two points are not sampled jointly.
    joints: &'a [Joint],
    radiance: Spectrum,
    last: Last,
    /// The bend from which the current segment leaves, if joint sampling could have chosen it and what follows.
    bend: Option<Bend>,
    /// The flight that led to the current vertex, if equiangular sampling could have been used on it, and whether it was.
    flight: Option<SampledFlight>,
    equiangular: bool,
    history: History,
    /// The part of the light over the edge between the first two vertices that counts.
    share: f32,
}

impl Tracer<'_> {
    /// The part of the light that counts if the next vertex lies at `position`.
    #[inline(always)]
    fn share_to(&self, position: Vec3) -> f32 {
        if self.options.bound == 0.0 || !self.history.leaves_first() {
            return self.share;
        }
        (1.0 - self.options.bound * self.last.position.distance_squared(position)).max(0.0)
    }

    /// Whether emission seen after `scatterings` events counts.
    #[inline(always)]
    fn counts(&self, scatterings: u32) -> bool {
        self.options.components.has(self.history.ends_at_emitter())
            && scatterings < self.options.rules.max_depth
            && !(self.options.hide_emitters && scatterings == 0)
    }

    /// Density with which techniques that begin with the emitter find the flight's end and the emitter's point `target`
    /// seen from there, relative to the density of the flight: equiangular sampling, and joint sampling of `bend` and the
    /// flight's end.
    #[inline(always)]
    fn emitter_first_ratio(
        &self,
        flight: &SampledFlight,
        bend: &Option<Bend>,
        emitter: EmitterId,
        target: Vec3,
        normal: Vec3,
    ) -> f32 {
        let SampledFlight { ray, length, distance, density, share, .. } = flight;
        let light = self.scene.lights.segment_pdf(ray, *length, ray.at(*distance), emitter, target, normal);
        let equiangular = share * light.0 * Equiangular::new(ray, *length, target).density(*distance).0 / density.0;
        match bend {
            None => equiangular,
            Some(bend) => {
                equiangular + self.jointly(bend, ray, *length, *distance, emitter, target, normal) / density.0
            }
        }
    }

    /// Weight of light that the walk found by itself, against the densities of the other techniques.
    #[inline(always)]
    fn hit_weight(&self, light: PerSolidAngle, emitter_first: f32) -> f32 {
        match self.last.pdf {
            None => 1.0,
            Some(pdf) => {
                let walked = pdf.0 * self.last.survival;
                let direct = self.last.sampled.map_or(1.0, |flight| 1.0 - flight.share);
                walked / (walked + direct * light.0 + emitter_first)
            }
        }
    }

    /// Light from the sampled emitter through `response`, without weight: `None` when nothing arrives.
    #[inline(always)]
    fn connect(
        &self,
        origin: Vec3,
        light: &EmitterSample,
        medium: Option<MediumId>,
        sampler: &mut Sampler,
    ) -> Option<(Spectrum, f32)> {
        let media = self.options.rules.media != Media::Absent;
        let (arriving, survival) = connect(self.scene, origin, light, medium, media, sampler.rng())?;
        Some((arriving / light.pdf.0, survival))
    }
}

impl Sink for Tracer<'_> {
    #[inline]
    fn looks_beyond(&self, leg: u32) -> bool {
        leg < self.options.equiangular_legs
    }

    #[inline]
    fn segment(&mut self, segment: &Segment, sampler: &mut Sampler) {
        self.last.survival *= segment.flight.survival(self.scene.medium(segment.medium), segment.ray);
        self.flight = None;
        self.equiangular = false;
        if segment.leg >= self.options.equiangular_legs {
            return;
        }
        let ray = segment.ray;
        let Some(stretch) = Stretch::along(self.scene, segment.medium, ray, segment.length) else { return };
        let Stretch { model, uniform, length, lit, opaque } = stretch;
        let share = EQUIANGULAR_SHARE * lit;
        if let Some(density) = segment.flight.density {
            let distance = segment.flight.distance;
            let medium = segment.medium;
            self.flight = Some(SampledFlight { ray: *ray, length, medium, distance, density, share, lit, opaque });
        }
        if !self.joints.is_empty() {
            self.connect_jointly(segment, &stretch, sampler);
        }
        if segment.scatterings + 2 > self.options.rules.max_depth
            || !self.options.components.has(self.history.lit_straight(true))
        {
            return;
        }
        let (choice, u) = (sampler.f32(), sampler.f32());
        if choice >= share {
            return;
        }
        self.equiangular = true;
        let choice = choice / share;
        let Some(point) = self.scene.lights.sample_for_segment(ray, length, choice, sampler.vec2()) else { return };
        let equiangular = Equiangular::new(ray, length, point.position);
        let t = equiangular.sample(u);
        let position = ray.at(t);
        let Some(light) = self.scene.lights.incident(position, &point) else { return };
        let (flown, transmittance) = uniform.collision(segment.throughput, t);
        let medium = self.scene.medium(segment.medium);
        let phase = PerSolidAngle(medium.phase().eval(position, ray.direction, light.direction));
        let scattered = segment.throughput * transmittance * uniform.sigma_t * model.albedo(position) * phase.0;
        if scattered.is_black() {
            return;
        }
        let Some((arriving, survival)) = self.connect(position, &light, Some(segment.medium), sampler) else { return };
        // Densities per length and solid angle at `position`.
        let chosen = share * light.pdf.0 * equiangular.density(t).0;
        let by_emitter = (1.0 - share) * flown.0 * self.scene.lights.pdf_light_point(position, &point).0;
        let by_phase = if light.delta { 0.0 } else { flown.0 * phase.0 * survival };
        let (emitter, target, normal) = (light.emitter, light.position, light.normal);
        let jointly = match &self.bend {
            None => 0.0,
            Some(bend) => self.jointly(bend, ray, length, t, emitter, target, normal),
        };
        let weight = chosen / (chosen + by_emitter + by_phase + jointly);
        self.radiance += scattered * arriving * (self.share_to(position) * weight / (share * equiangular.density(t).0));
    }

    #[inline]
    fn surface(&mut self, hit: &SurfaceHit) {
        self.bend = None;
        if !self.counts(hit.scatterings) || !self.scene.is_emitter(hit.point.shape) {
            return;
        }
        let emitted = self.scene.lights.radiance_surface(hit.point, hit.direction);
        if emitted.is_black() {
            return;
        }
        let weight = match self.last.pdf {
            None => 1.0,
            Some(_) => {
                let lights = &self.scene.lights;
                let light = lights.pdf_hit(self.last.position, hit.point);
                let emitter_first = match (&self.last.sampled, lights.of_shape(hit.point.shape)) {
                    (Some(flight), Some(emitter)) => {
                        let (target, normal) = (hit.point.position, hit.point.normal);
                        self.emitter_first_ratio(flight, &self.last.bend, emitter, target, normal)
                    }
                    _ => 0.0,
                };
                self.hit_weight(light, emitter_first)
            }
        };
        self.radiance += hit.throughput * emitted * (self.share * weight);
    }

    #[inline]
    fn escape(&mut self, escape: &Escape) {
        if !self.counts(escape.scatterings) {
            return;
        }
        let emitted = self.scene.lights.radiance_escape(escape.direction);
        if emitted.is_black() {
            return;
        }
        let weight = match self.last.pdf {
            None => 1.0,
            Some(_) => self.hit_weight(self.scene.lights.pdf_escape(escape.direction), 0.0),
        };
        self.radiance += escape.throughput * emitted * (self.share * weight);
    }

    #[inline]
    fn vertex(&mut self, vertex: &Vertex, sampler: &mut Sampler) {
        // The flight through the medium that ends here, if it shares its direct light with equiangular sampling.
        let medium = matches!(vertex.scattering, Scattering::Medium { .. });
        let flight = self.flight.filter(|_| medium);
        if !samples_emitters(self.scene, vertex)
            || (flight.is_some() && self.equiangular)
            || !self.options.components.has(self.history.lit_straight(medium))
        {
            return;
        }
        let Some(light) = self.scene.lights.sample(vertex.position, sampler.f32(), sampler.vec2()) else { return };
        let Response { value, pdf } = respond(self.scene, vertex, light.direction);
        if value.is_black() {
            return;
        }
        let (origin, medium) = departure(self.scene, vertex, light.direction);
        let Some((arriving, survival)) = self.connect(origin, &light, medium, sampler) else { return };
        let walked = if light.delta { 0.0 } else { pdf.0 * survival };
        let direct = flight.map_or(1.0, |flight| 1.0 - flight.share);
        let emitter_first = match &flight {
            Some(flight) if self.scene.lights.is_finite(light.emitter) => {
                self.emitter_first_ratio(flight, &self.bend, light.emitter, light.position, light.normal)
            }
            _ => 0.0,
        };
        let weight = light.pdf.0 / (direct * light.pdf.0 + walked + emitter_first);
        self.radiance += vertex.throughput * value * arriving * (self.share_to(vertex.position) * weight);
    }

    #[inline]
    fn scattered(&mut self, vertex: &Vertex, onward: &Onward) -> bool {
        let pdf = onward.pdf;
        let medium = matches!(vertex.scattering, Scattering::Medium { .. });
        if pdf.is_some() {
            self.share = self.share_to(vertex.position);
        }
        let sampled = self.flight.take().filter(|_| medium);
        self.last = Last {
            position: vertex.position,
            pdf: pdf.filter(|_| samples_emitters(self.scene, vertex)),
            survival: 1.0,
            sampled,
            bend: self.bend.take(),
        };
        if !self.joints.is_empty() {
            self.bend = sampled.zip(pdf).map(|(flight, phase)| flight.bend(phase));
        }
        self.history.scatter(medium, pdf.is_none());
        self.share > 0.0 && self.options.components.has(self.history.reachable())
    }
}
