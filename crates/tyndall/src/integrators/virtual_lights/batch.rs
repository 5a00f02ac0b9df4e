//! Ray lights that wait to be connected, until there are enough of them to fill all lanes.

use super::VirtualLights;
use crate::estimators::ray_pair::LightRays;
use crate::estimators::turns::Phases;
use crate::math::Sampler;
use crate::math::lanes::{Row, WIDTH};
use crate::photons::{Attenuation, Beam};
use crate::scene::Scene;
use crate::scene::desc::MediumId;

/// Up to eight ray lights, each for one sample of its pair.
pub(super) struct Batch<'a> {
    pub(super) rays: LightRays,
    /// Random numbers, stratified and not.
    pub(super) u: [Row; 2],
    count: usize,
    lights: [Option<(&'a Beam, MediumId)>; WIDTH],
    /// The reciprocal of the expected number of samples.
    weights: Row,
}

impl<'a> Batch<'a> {
    fn new() -> Self {
        let zero = Row([0.0; WIDTH]);
        Self { rays: LightRays::default(), u: [zero; 2], count: 0, lights: [None; WIDTH], weights: zero }
    }

    fn push(&mut self, light: &'a Beam, medium: MediumId, weight: f32, u: [f32; 2]) {
        let lane = self.count & (WIDTH - 1);
        self.rays.set(lane, &light.ray(), light.length);
        (self.u[0].0[lane], self.u[1].0[lane]) = (u[0], u[1]);
        self.lights[lane] = Some((light, medium));
        self.weights.0[lane] = weight;
        self.count += 1;
    }

    /// The lanes in use: light and weight.
    pub(super) fn lights(&self) -> impl Iterator<Item = (&'a Beam, f32)> {
        let lights = self.lights[..self.count].iter().zip(self.weights.0);
        lights.filter_map(|(light, weight)| light.map(|(beam, _)| (beam, weight)))
    }

    /// Media of the lights in use.
    pub(super) fn media(&self) -> impl Iterator<Item = MediumId> {
        self.lights[..self.count].iter().flatten().map(|(_, medium)| *medium)
    }

    /// Their phase functions.
    pub(super) fn phases<'s>(&self, scene: &'s Scene) -> Phases<'s> {
        let first = self.lights[0].map_or(MediumId(0), |(_, medium)| medium);
        let phase = |medium| scene.medium(medium).phase();
        if self.media().all(|medium| medium == first) {
            return Phases::Same(phase(first));
        }
        Phases::Each(self.lights.map(|light| phase(light.map_or(first, |(_, medium)| medium))))
    }

    /// Rates at which the lights dim along their rays, 1/m.
    pub(super) fn rates(&self, scene: &Scene) -> Row {
        Row(self.lights.map(|light| {
            light.map_or(0.0, |(beam, medium)| match beam.attenuation {
                Attenuation::Rate(rate) => rate,
                Attenuation::Survivors => 0.0,
                Attenuation::Transmittance => scene.medium(medium).sigma_t(beam.origin).min_channel(),
            })
        }))
    }
}

impl VirtualLights {
    /// Tells `connect` of all ray lights that a query visits and `counts` lets in, batch by batch.
    #[inline(always)]
    pub(super) fn visit_rays(
        &self,
        lights: u32,
        sampler: &mut Sampler,
        counts: impl Fn(u32) -> bool,
        mut connect: impl FnMut(&Batch, &mut Sampler),
    ) {
        let mut batch = Batch::new();
        let shift = sampler.rng().f32();
        let samples = self.options.samples;
        let step = 1.0 / samples as f32;
        self.rays.visit(lights, shift, |i, weight| {
            let light = &self.paths.beams[i];
            let Some(medium) = light.tag.medium().filter(|_| counts(light.tag.scatterings())) else { return };
            let shift = sampler.rng().f32();
            for sample in 0..samples {
                let u = [(sample as f32 + shift) * step, sampler.rng().f32()];
                batch.push(light, medium, weight * step, u);
                if batch.count == WIDTH {
                    connect(&batch, sampler);
                    batch.count = 0;
                }
            }
        });
        if batch.count > 0 {
            connect(&batch, sampler);
        }
    }
}
