//! The camera's walk, connected with lights.

use super::{VirtualLights, kept, wanted};
use crate::Spectrum;
use crate::estimators::connect::{join, join_ball};
use crate::estimators::equiangular::Equiangular;
use crate::estimators::ray_pair::{PairSample, RayPair};
use crate::math::{Ray, Sampler, Vec2};
use crate::photons::Beam;
use crate::scene::Scene;
use crate::walk::{FromCamera, Onward, Profile, Scattering, Segment, Sink, Start, Vertex, walk};

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
        let lens = Vec2::new(sampler.rng().f32(), sampler.rng().f32());
        let camera = scene.sensor.sample_ray(film, lens);
        let start =
            Start { ray: camera.ray, length: camera.t_max, medium: scene.camera_medium, throughput: Spectrum::ONE };
        let mut seeker = Seeker { lights, scene, profile, radiance: Spectrum::ZERO };
        walk::<FromCamera, _>(scene, start, &lights.options.camera_rules, sampler, &mut seeker);
        seeker.radiance / lights.options.photons as f32
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
        let t = distances.sample(sampler.rng().f32()).min(stretch.length);
        self.join(light, &self.vertex_at(stretch, t, distances.density(t).0), sampler)
    }

    /// Light of a ray, scattered on the stretch.
    #[inline]
    fn ray_to_stretch(&self, light: &Beam, stretch: &Stretch, sampler: &mut Sampler) -> Spectrum {
        let pair = RayPair::new(&stretch.ray, stretch.length, &light.ray(), light.length, self.lights.radius);
        let samples = self.lights.options.samples;
        let shift = sampler.rng().f32();
        let mut sum = Spectrum::ZERO;
        for i in 0..samples {
            let u = [(i as f32 + shift) / samples as f32, sampler.rng().f32()];
            let PairSample { s, t, pdf } = pair.sample(u);
            let Some(from) = light.vertex(self.scene, s) else { continue };
            let density = pdf * samples as f32;
            if density > 0.0 {
                sum += self.join(&from, &self.vertex_at(stretch, t, density), sampler);
            }
        }
        sum
    }

    /// Light of a ray, scattered at a vertex.
    #[inline]
    fn ray_to_vertex(&self, light: &Beam, camera: &Vertex, sampler: &mut Sampler) -> Spectrum {
        let distances = Equiangular::softened(&light.ray(), light.length, camera.position, self.lights.radius);
        let samples = self.lights.options.samples;
        let shift = sampler.rng().f32();
        let mut sum = Spectrum::ZERO;
        for i in 0..samples {
            let s = distances.sample((i as f32 + shift) / samples as f32).min(light.length);
            let density = distances.density(s).0 * samples as f32;
            if let Some(from) = light.vertex(self.scene, s) {
                sum += self.join(&from, camera, sampler) / density;
            }
        }
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
        let lights = self.lights;
        let before = vertex.scatterings;
        let mut sum = Spectrum::ZERO;
        let shift = sampler.rng().f32();
        lights.points.visit(lights.options.lights, shift, |i, weight| {
            let light = &lights.paths.vertices[i];
            if self.counts(light.scatterings, before) {
                sum += self.join(light, vertex, sampler) * weight;
            }
        });
        let shift = sampler.rng().f32();
        lights.rays.visit(lights.options.lights, shift, |i, weight| {
            let light = &lights.paths.beams[i];
            if self.counts(light.tag.scatterings(), before) {
                sum += self.ray_to_vertex(light, vertex, sampler) * weight;
            }
        });
        self.radiance += sum;
    }

    fn scattered(&mut self, _vertex: &Vertex, onward: &Onward) -> bool {
        onward.pdf.is_none()
    }
}
