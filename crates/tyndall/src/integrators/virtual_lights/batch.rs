//! Lights that wait to be connected, until there are enough of them to fill all lanes.

use super::VirtualLights;
use crate::Spectrum;
use crate::estimators::edges::{Junction, Junctions, Manner, Source};
use crate::estimators::ray_pair::EightRays;
use crate::estimators::turns::Phases;
use crate::math::Sampler;
use crate::math::lanes::{Row, WIDTH};
use crate::photons::{Attenuation, Beam};
use crate::scene::Scene;
use crate::scene::desc::MediumId;
use crate::walk::{FromLight, Vertex};

/// A point light.
#[derive(Clone, Copy, Debug)]
pub(super) struct PointLight {
    junction: Junction,
    scatterings: u32,
    /// The vertex of the light paths.
    vertex: u32,
}

impl PointLight {
    pub(super) fn new(scene: &Scene, vertex: &Vertex, index: u32) -> Self {
        let junction = Junction::new::<FromLight>(scene, vertex);
        Self { junction, scatterings: vertex.scatterings, vertex: index }
    }

    pub(super) fn manner(&self) -> Manner {
        self.junction.manner
    }

    pub(super) fn vertex(&self) -> usize {
        self.vertex as usize
    }
}

/// A ray light.
#[derive(Clone, Copy, Debug)]
pub(super) struct RayLight {
    /// At its start, with the flux scattered per metre if that is the same all along.
    start: Junction,
    /// Metres.
    length: f32,
    scatterings: u32,
    medium: MediumId,
    even: bool,
    /// The beam of the light paths.
    beam: u32,
}

impl RayLight {
    /// `None` outside of media.
    pub(super) fn new(scene: &Scene, beam: &Beam, index: u32) -> Option<Self> {
        let medium = beam.tag.medium()?;
        let even = beam.attenuation == Attenuation::Rate(0.0);
        let even = scene.medium(medium).constants().filter(|_| even);
        let flux = even.map_or(Spectrum::ZERO, |[_, sigma_s]| beam.flux.unpack() * sigma_s);
        let start = Junction::in_medium(scene, medium, beam.origin, beam.direction, flux);
        let scatterings = beam.tag.scatterings();
        Some(Self { start, length: beam.length, scatterings, medium, even: even.is_some(), beam: index })
    }

    pub(super) fn beam(&self) -> usize {
        self.beam as usize
    }
}

/// Up to eight lights of one manner, each for one sample of its pair.
pub(super) struct Batch<'a> {
    /// Point lights; of rays the points are still to be chosen.
    pub(super) lights: Junctions<'a>,
    /// Ray lights.
    pub(super) rays: EightRays,
    beams: [Option<(&'a Beam, MediumId)>; WIDTH],
    /// Whether the flux is the same all along each ray light.
    even: bool,
    /// Random numbers, stratified and not.
    pub(super) u: [Row; 2],
    /// How many lights there are.
    pub(super) count: usize,
    /// The reciprocals of the expected numbers of samples.
    pub(super) weight: Row,
}

impl<'a> Batch<'a> {
    fn new() -> Self {
        let zero = Row([0.0; WIDTH]);
        Self {
            lights: Junctions::none(),
            rays: EightRays::default(),
            beams: [None; WIDTH],
            even: true,
            u: [zero; 2],
            count: 0,
            weight: zero,
        }
    }

    /// Adds a light in the lane it answers with.
    #[inline(always)]
    fn push(&mut self, light: &Junction, source: Source<'a>, weight: f32, u: [f32; 2]) -> usize {
        let lane = self.count & (WIDTH - 1);
        self.lights.set(lane, light, source);
        (self.u[0].0[lane], self.u[1].0[lane]) = (u[0], u[1]);
        self.weight.0[lane] = weight;
        self.count += 1;
        lane
    }

    /// The ray lights in use and their media.
    #[inline(always)]
    pub(super) fn beams(&self) -> impl Iterator<Item = (&'a Beam, MediumId)> {
        self.beams[..self.count].iter().copied().flatten()
    }

    /// Phase functions of the ray lights.
    pub(super) fn phases<'s>(&self, scene: &'s Scene) -> Phases<'s> {
        let first = self.beams[0].map_or(MediumId(0), |(_, medium)| medium);
        let phase = |medium| scene.medium(medium).phase();
        if self.beams().all(|(_, medium)| medium == first) {
            return Phases::Same(phase(first));
        }
        Phases::Each(self.beams.map(|light| phase(light.map_or(first, |(_, medium)| medium))))
    }

    /// Rates at which the ray lights dim along their rays, 1/m.
    pub(super) fn rates(&self, scene: &Scene) -> Row {
        Row(self.beams.map(|light| {
            light.map_or(0.0, |(beam, medium)| match beam.attenuation {
                Attenuation::Rate(rate) => rate,
                Attenuation::Survivors => 0.0,
                Attenuation::Transmittance => scene.medium(medium).sigma_t(beam.origin).min_channel(),
            })
        }))
    }

    /// Makes point lights of the ray lights, at distances `s` that were chosen with densities `pdf` (1/m).
    #[inline]
    pub(super) fn place(&mut self, scene: &Scene, s: &Row, pdf: &Row) {
        if self.even {
            [self.lights.position, self.lights.throughput] = self.lights.after(s, Spectrum::ZERO, pdf);
            return;
        }
        for lane in 0..self.count {
            let Some((beam, medium)) = self.beams[lane] else { continue };
            let (s, pdf) = (s.0[lane], pdf.0[lane]);
            let (position, flux) = beam.scattered(scene.medium(medium), s);
            self.lights.put(lane, position, if pdf > 0.0 { flux / pdf } else { Spectrum::ZERO });
        }
    }

    /// Connects what is there, if it is time.
    #[inline(always)]
    fn flush(&mut self, now: bool, sampler: &mut Sampler, connect: &mut impl FnMut(&mut Batch, &mut Sampler)) {
        if now && self.count > 0 {
            connect(self, sampler);
            (self.count, self.even) = (0, true);
        }
    }
}

impl VirtualLights {
    /// Tells `connect` of all point lights that a query visits and `counts` lets in, batch by batch, each for so many samples.
    #[inline(always)]
    pub(super) fn visit_points(
        &self,
        (lights, samples): (u32, u32),
        sampler: &mut Sampler,
        counts: impl Fn(u32) -> bool,
        mut connect: impl FnMut(&mut Batch, &mut Sampler),
    ) {
        let mut batch = Batch::new();
        let shift = sampler.rng().f32();
        let step = 1.0 / samples as f32;
        self.points.visit(lights, shift, |i, weight| {
            let light = &self.lights[i];
            if !counts(light.scatterings) {
                return;
            }
            batch.flush(batch.lights.manner() != light.manner(), sampler, &mut connect);
            let source = Source::Vertex(&self.paths.vertices[light.vertex()]);
            let shift = sampler.rng().f32();
            for sample in 0..samples {
                batch.push(&light.junction, source, weight * step, [(sample as f32 + shift) * step, 0.0]);
                batch.flush(batch.count == WIDTH, sampler, &mut connect);
            }
        });
        batch.flush(true, sampler, &mut connect);
    }

    /// The same of ray lights.
    #[inline(always)]
    pub(super) fn visit_rays(
        &self,
        scene: &Scene,
        lights: u32,
        sampler: &mut Sampler,
        counts: impl Fn(u32) -> bool,
        mut connect: impl FnMut(&mut Batch, &mut Sampler),
    ) {
        let mut batch = Batch::new();
        let shift = sampler.rng().f32();
        let samples = self.options.samples;
        let step = 1.0 / samples as f32;
        self.rays.visit(lights, shift, |i, weight| {
            let light = &self.ray_lights[i];
            if !counts(light.scatterings) {
                return;
            }
            batch.flush(batch.lights.manner() != light.start.manner, sampler, &mut connect);
            let (beam, medium) = (&self.paths.beams[light.beam()], light.medium);
            let source = Source::Phase(scene.medium(medium).phase());
            let shift = sampler.rng().f32();
            for sample in 0..samples {
                let u = [(sample as f32 + shift) * step, sampler.rng().f32()];
                let lane = batch.push(&light.start, source, weight * step, u);
                batch.rays.set(lane, &beam.ray(), light.length);
                batch.even &= light.even;
                batch.beams[lane] = Some((beam, medium));
                batch.flush(batch.count == WIDTH, sampler, &mut connect);
            }
        });
        batch.flush(true, sampler, &mut connect);
    }
}
