//! The camera's walk, connected with lights.

use super::{VirtualLights, kept, wanted};
use crate::Spectrum;
use crate::estimators::connect::{join, join_ball};
use crate::estimators::equiangular::Equiangular;
use crate::estimators::ray_pair::{PairSample, RayPair};
use crate::estimators::turns::{TurningPair, Turns, TurnsOnRay};
use crate::math::{PerLength, Ray, Sampler, Vec2};
use crate::photons::{Attenuation, Beam};
use crate::scene::Scene;
use crate::scene::desc::MediumId;
use crate::walk::{FromCamera, Onward, Profile, Scattering, Segment, Sink, Start, Vertex, walk};

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
    radiance: Spectrum,
}

impl<'a> Seeker<'a> {
    /// Radiance arriving at the film position (pixels of the whole film), one sample.
    #[inline]
    pub(super) fn radiance(
        lights: &'a VirtualLights,
        scene: &'a Scene,
        profile: &'a mut Profile,
        film: Vec2,
        sampler: &mut Sampler,
    ) -> Spectrum {
        let mut seeker = Self::new(lights, scene, profile);
        walk::<FromCamera, _>(scene, start(scene, film, sampler), &lights.options.camera_rules, sampler, &mut seeker);
        seeker.radiance / lights.options.photons as f32
    }

    pub(super) fn new(lights: &'a VirtualLights, scene: &'a Scene, profile: &'a mut Profile) -> Self {
        Self { lights, scene, profile, radiance: Spectrum::ZERO }
    }

    /// Light from `light` that scatters at `camera`, times the number of light paths.
    #[inline]
    fn join(&self, light: &Vertex, camera: &Vertex, sampler: &mut Sampler) -> Spectrum {
        let radius = self.lights.radius;
        let joined = match radius > 0.0 {
            true => {
                let u = Vec2::new(sampler.rng().f32(), sampler.rng().f32());
                join_ball(self.scene, light, camera, radius, u, sampler.rng())
            }
            false => join(self.scene, light, camera, sampler.rng()),
        };
        let Some(joined) = joined else { return Spectrum::ZERO };
        light.throughput * camera.throughput * joined.value * kept(self.lights.options.clamp, joined.spread)
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

    /// The rate at which light of a beam dims along it, 1/m.
    #[inline]
    fn rate_along(&self, light: &Beam, medium: MediumId) -> f32 {
        match light.attenuation {
            Attenuation::Rate(rate) => rate,
            Attenuation::Survivors => 0.0,
            Attenuation::Transmittance => self.scene.medium(medium).sigma_t(light.origin).min_channel(),
        }
    }

    /// Light of a ray, scattered on the stretch.
    #[inline]
    fn ray_to_stretch(&self, light: &Beam, stretch: &Stretch, sampler: &mut Sampler) -> Spectrum {
        let Some(medium) = light.tag.medium() else { return Spectrum::ZERO };
        let pair = RayPair::new(&stretch.ray, stretch.length, &light.ray(), light.length, self.lights.radius);
        let dims = self.profile.uniform().map_or(0.0, |uniform| uniform.sigma_t.min_channel());
        let here = stretch.segment.medium;
        if !self.lights.turns_matter([medium, here], dims * stretch.length) {
            return self.pairs(light, stretch, sampler, |u| pair.sample(u));
        }
        let [at_light, on_ray] = [medium, here].map(|id| self.scene.medium(id).phase());
        let turns = Turns { on_ray, at_point: Some((at_light, light.direction)), along: dims, between: dims };
        let pair = TurningPair::new(pair, turns, self.rate_along(light, medium));
        self.pairs(light, stretch, sampler, |u| pair.sample(u))
    }

    /// The same, with the pairs of points that `sample` chooses.
    #[inline(always)]
    fn pairs(
        &self,
        light: &Beam,
        stretch: &Stretch,
        sampler: &mut Sampler,
        sample: impl Fn([f32; 2]) -> PairSample,
    ) -> Spectrum {
        self.stratified(sampler, |u, samples, sampler| {
            let PairSample { s, t, pdf } = sample([u, sampler.rng().f32()]);
            let (t, density) = (t.min(stretch.length), pdf * samples);
            match light.vertex(self.scene, s) {
                Some(from) if density > 0.0 => self.join(&from, &self.vertex_at(stretch, t, density), sampler),
                _ => Spectrum::ZERO,
            }
        })
    }

    /// Light of a ray, scattered at a vertex.
    #[inline]
    fn ray_to_vertex(&self, light: &Beam, camera: &Vertex, sampler: &mut Sampler) -> Spectrum {
        let Some(medium) = light.tag.medium() else { return Spectrum::ZERO };
        let ray = light.ray();
        let angles = Equiangular::softened(&ray, light.length, camera.position, self.lights.radius);
        if !self.lights.turns_matter([medium; 2], 0.0) {
            return self.distances(light, camera, sampler, |u| {
                let s = angles.sample(u);
                (s, angles.density(s))
            });
        }
        let on_ray = self.scene.medium(medium).phase();
        let turns = Turns { on_ray, at_point: None, along: self.rate_along(light, medium), between: 0.0 };
        let distances = TurnsOnRay::new(&turns, &ray, camera.position, angles);
        self.distances(light, camera, sampler, |u| distances.sample(u))
    }

    /// The same, from the distances that `sample` chooses on light's ray.
    #[inline(always)]
    fn distances(
        &self,
        light: &Beam,
        camera: &Vertex,
        sampler: &mut Sampler,
        sample: impl Fn(f32) -> (f32, PerLength),
    ) -> Spectrum {
        self.stratified(sampler, |u, samples, sampler| {
            let (s, density) = sample(u);
            match light.vertex(self.scene, s.min(light.length)) {
                Some(from) if density.0 > 0.0 => self.join(&from, camera, sampler) / (density.0 * samples),
                _ => Spectrum::ZERO,
            }
        })
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
        let shift = sampler.rng().f32();
        lights.rays.visit(count, shift, |i, weight| {
            let light = &lights.paths.beams[i];
            if self.counts(light.tag.scatterings(), before) {
                sum += self.ray_to_vertex(light, vertex, sampler) * weight;
            }
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
        let shift = sampler.rng().f32();
        lights.rays.visit(lights.options.lights, shift, |i, weight| {
            let light = &lights.paths.beams[i];
            if self.counts(light.tag.scatterings(), before) {
                sum += self.ray_to_stretch(light, &stretch, sampler) * weight;
            }
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
