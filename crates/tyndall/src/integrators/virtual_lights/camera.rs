//! The camera's walk, connected with lights.

use super::batch::Batch;
use super::{VirtualLights, lit, wanted};
use crate::Spectrum;
use crate::estimators::connect::Way;
use crate::estimators::equiangular::Equiangular;
use crate::estimators::turns::{Distances, PairTurns, Pairs, Phases};
use crate::math::lanes::Level;
use crate::math::{Ray, Sampler, Vec2};
use crate::scene::Scene;
use crate::walk::{FromCamera, Onward, Profile, Scattering, Segment, Sink, Start, Vertex, walk};
use std::cell::Cell;

/// The start of a camera's walk at the film position.
#[inline]
pub(super) fn start(scene: &Scene, film: Vec2, sampler: &mut Sampler) -> Start {
    let camera = scene.sensor.sample_ray(film, sampler.rng().vec2());
    Start { ray: camera.ray, length: camera.t_max, medium: scene.camera_medium, throughput: Spectrum::ONE }
}

/// The sink that connects the camera's walk, dimmed by media, over smooth mirrors and glass up to the first other surface.
pub(super) struct Seeker<'a> {
    lights: &'a VirtualLights,
    scene: &'a Scene,
    profile: &'a mut Profile,
    /// Edges so far.
    connections: &'a Cell<u64>,
    radiance: Spectrum,
}

impl<'a> Seeker<'a> {
    /// Radiance arriving at the film position (pixels of the whole film), one sample.
    #[inline]
    pub(super) fn radiance(
        lights: &'a VirtualLights,
        scene: &'a Scene,
        profile: &'a mut Profile,
        connections: &'a Cell<u64>,
        film: Vec2,
        sampler: &mut Sampler,
    ) -> Spectrum {
        let mut seeker = Self::new(lights, scene, profile, connections);
        walk::<FromCamera, _>(scene, start(scene, film, sampler), &lights.options.camera_rules, sampler, &mut seeker);
        seeker.radiance / lights.options.photons as f32
    }

    pub(super) fn new(
        lights: &'a VirtualLights,
        scene: &'a Scene,
        profile: &'a mut Profile,
        connections: &'a Cell<u64>,
    ) -> Self {
        Self { lights, scene, profile, connections, radiance: Spectrum::ZERO }
    }

    /// Light from `light` that scatters at `camera`, times the number of light paths.
    #[inline]
    fn join(&self, light: &Vertex, camera: &Vertex, sampler: &mut Sampler) -> Spectrum {
        let radius = self.lights.radius;
        let way = match radius > 0.0 {
            true => {
                let u = Vec2::new(sampler.rng().f32(), sampler.rng().f32());
                Way::from_ball(light.position, camera.position, radius, u)
            }
            false => Way::new(light.position, camera.position),
        };
        self.connections.set(self.connections.get() + 1);
        lit(self.scene, way, light, camera, self.lights.options.clamp, sampler.rng())
    }

    /// Whether light scattered `scatterings` times may scatter at a light and at a camera's vertex with that many before.
    #[inline(always)]
    fn counts(&self, scatterings: u32, before: u32) -> bool {
        scatterings.saturating_add(before).saturating_add(3) <= self.lights.options.camera_rules.max_depth
    }
}

/// A camera's ray inside a medium.
pub(super) struct Stretch<'a> {
    pub(super) segment: &'a Segment<'a>,
    pub(super) ray: Ray,
    /// Metres.
    pub(super) length: f32,
}

impl Stretch<'_> {
    /// The vertex at distance `t` (metres), if it was chosen with density `pdf` (1/m); `profile` is that of the ray.
    #[inline]
    pub(super) fn vertex(&self, scene: &Scene, profile: &Profile, t: f32, pdf: f32) -> Vertex {
        let Segment { medium, scatterings, leg, throughput, .. } = *self.segment;
        let direction = self.ray.direction;
        let position = self.ray.at(t);
        let inside = scene.medium(medium);
        let sigma_s = inside.sigma_s(position) * inside.phase().extinction_factor(position, direction);
        let throughput = throughput * profile.at(t) * sigma_s / pdf;
        Vertex { position, direction, throughput, scatterings, leg, scattering: Scattering::Medium { medium } }
    }
}

impl Seeker<'_> {
    /// The vertex at distance `t` of the stretch, if it was chosen with density `pdf` (1/m).
    #[inline]
    fn vertex_at(&self, stretch: &Stretch, t: f32, pdf: f32) -> Vertex {
        stretch.vertex(self.scene, self.profile, t, pdf)
    }

    /// Light of a point, scattered on the stretch.
    #[inline]
    fn point_to_stretch(&self, light: &Vertex, stretch: &Stretch, sampler: &mut Sampler) -> Spectrum {
        let distances = Equiangular::softened(&stretch.ray, stretch.length, light.position, self.lights.radius);
        self.stratified(sampler, |u, samples, sampler| {
            let t = distances.sample(u).min(stretch.length);
            self.join(light, &self.vertex_at(stretch, t, distances.density(t).0 * samples), sampler)
        })
    }

    /// The sum over the samples of a pair: `add` is told the next of equal steps in [0, 1) and the number of samples.
    #[inline(always)]
    fn stratified(&self, sampler: &mut Sampler, add: impl Fn(f32, f32, &mut Sampler) -> Spectrum) -> Spectrum {
        let samples = self.lights.options.samples;
        let shift = sampler.rng().f32();
        let step = 1.0 / samples as f32;
        (0..samples).map(|i| add((i as f32 + shift) * step, samples as f32, sampler)).sum()
    }

    /// Light of rays, scattered on the stretch.
    #[inline]
    fn rays_to_stretch(&self, batch: &Batch, stretch: &Stretch, sampler: &mut Sampler) -> Spectrum {
        let sigma_t = self.profile.uniform().map_or(0.0, |uniform| uniform.sigma_t.min_channel());
        let here = stretch.segment.medium;
        let depth = sigma_t * stretch.length;
        let turns = batch.media().any(|medium| self.lights.turns_matter([medium, here], depth)).then(|| PairTurns {
            on_camera: Phases::Same(self.scene.medium(here).phase()),
            at_light: batch.phases(self.scene),
            rates: batch.rates(self.scene),
            sigma_t,
        });
        let [s, t, pdf] = Level::dispatch(Pairs {
            camera: stretch.ray,
            length: stretch.length,
            lights: &batch.rays,
            radius: self.lights.radius,
            turns: turns.as_ref(),
            u: &batch.u,
        });
        let mut sum = Spectrum::ZERO;
        for (lane, (light, weight)) in batch.lights().enumerate() {
            if let Some(from) = light.vertex(self.scene, s.0[lane])
                && pdf.0[lane] > 0.0
            {
                sum += self.join(&from, &self.vertex_at(stretch, t.0[lane], pdf.0[lane]), sampler) * weight;
            }
        }
        sum
    }

    /// Light of rays, scattered at a vertex.
    #[inline]
    fn rays_to_vertex(&self, batch: &Batch, camera: &Vertex, sampler: &mut Sampler) -> Spectrum {
        let matters = batch.media().any(|medium| self.lights.turns_matter([medium; 2], 0.0));
        let turns = matters.then(|| (batch.phases(self.scene), batch.rates(self.scene)));
        let [s, pdf] = Level::dispatch(Distances {
            point: camera.position,
            lights: &batch.rays,
            radius: self.lights.radius,
            turns: turns.as_ref().map(|(phases, rates)| (phases, rates)),
            u: &batch.u[0],
        });
        let mut sum = Spectrum::ZERO;
        for (lane, (light, weight)) in batch.lights().enumerate() {
            if let Some(from) = light.vertex(self.scene, s.0[lane])
                && pdf.0[lane] > 0.0
            {
                sum += self.join(&from, camera, sampler) * (weight / pdf.0[lane]);
            }
        }
        sum
    }

    /// Light of `count` lights of each kind (0: of all), scattered at the camera's vertex, times the number of light paths.
    pub(super) fn gather(&self, vertex: &Vertex, count: u32, sampler: &mut Sampler) -> Spectrum {
        let lights = self.lights;
        let before = vertex.scatterings;
        let mut sum = Spectrum::ZERO;
        let shift = sampler.rng().f32();
        lights.points.visit(count, shift, |i, weight| {
            let light = &lights.paths.vertices[i];
            if self.counts(light.scatterings, before) {
                sum += self.join(light, vertex, sampler) * weight;
            }
        });
        let counts = |scatterings| self.counts(scatterings, before);
        lights.visit_rays(count, sampler, counts, |batch, sampler| {
            sum += self.rays_to_vertex(batch, vertex, sampler);
        });
        sum
    }
}

impl Sink for Seeker<'_> {
    fn segment(&mut self, segment: &Segment, sampler: &mut Sampler) {
        let before = segment.scatterings;
        let scattering = Scattering::Medium { medium: segment.medium };
        if !self.counts(0, before) || !wanted(self.lights.options.components, &scattering) {
            return;
        }
        let Some((ray, length)) = self.profile.trace_segment(self.scene, segment, sampler.rng()) else { return };
        let lights = self.lights;
        let stretch = Stretch { segment, ray, length };
        let mut sum = Spectrum::ZERO;
        let shift = sampler.rng().f32();
        lights.points.visit(lights.options.lights, shift, |i, weight| {
            let light = &lights.paths.vertices[i];
            if self.counts(light.scatterings, before) {
                sum += self.point_to_stretch(light, &stretch, sampler) * weight;
            }
        });
        let counts = |scatterings| self.counts(scatterings, before);
        lights.visit_rays(lights.options.lights, sampler, counts, |batch, sampler| {
            sum += self.rays_to_stretch(batch, &stretch, sampler);
        });
        self.radiance += sum;
    }

    fn vertex(&mut self, vertex: &Vertex, sampler: &mut Sampler) {
        let Scattering::Surface { point, .. } = &vertex.scattering else { return };
        if !self.scene.is_smooth(point.shape) || !wanted(self.lights.options.components, &vertex.scattering) {
            return;
        }
        self.radiance += self.gather(vertex, self.lights.options.lights, sampler);
    }

    fn scattered(&mut self, _vertex: &Vertex, onward: &Onward) -> bool {
        onward.pdf.is_none()
    }
}
