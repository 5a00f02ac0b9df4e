//! The camera's walk, connected with lights.

use super::batch::Batch;
use super::{Options, VirtualLights, wanted};
use crate::Spectrum;
use crate::estimators::edges::{Edges, Junction, Junctions, Source};
use crate::estimators::ray_pair::EightRays;
use crate::estimators::turns::{Distances, PairTurns, Pairs, Phases};
use crate::math::lanes::{Level, Row, WIDTH};
use crate::math::{Ray, Sampler, Vec2, Vec3};
use crate::scene::Scene;
use crate::walk::{FromCamera, Onward, Profile, Scattering, Segment, Sink, Start, Vertex, walk};
use std::cell::Cell;

/// The start of a camera's walk at the film position.
#[inline]
pub(super) fn start(scene: &Scene, film: Vec2, sampler: &mut Sampler) -> Start {
    let camera = scene.sensor.sample_ray(film, sampler.rng().vec2());
    Start::seen(scene, &camera)
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

    /// Light of the batch that is scattered at `camera`, times the number of light paths.
    #[inline]
    fn connect(&self, batch: &Batch, camera: &Junctions, sampler: &mut Sampler) -> Spectrum {
        let radius = self.lights.radius;
        let mut u = [Row([0.0; WIDTH]); 2];
        if radius > 0.0 {
            let rng = sampler.rng();
            (0..batch.count).for_each(|lane| u.iter_mut().for_each(|row| row.0[lane] = rng.f32()));
        }
        self.connections.set(self.connections.get() + batch.count as u64);
        let Batch { lights, count, weight, .. } = batch;
        let clamp = self.lights.options.clamp;
        Edges { light: lights, camera, radius, u: &u, clamp, count: *count, weight }.radiance(self.scene, sampler.rng())
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
    /// The point at distance `t` (metres) and the throughput on arrival there, if it was chosen with density `pdf` (1/m);
    /// `profile` is that of the ray.
    #[inline(always)]
    fn at(&self, scene: &Scene, profile: &Profile, t: f32, pdf: f32) -> (Vec3, Spectrum) {
        let medium = scene.medium(self.segment.medium);
        let position = self.ray.at(t);
        let sigma_s = medium.sigma_s(position) * medium.phase().extinction_factor(position, self.ray.direction);
        (position, self.segment.throughput * profile.at(t) * sigma_s / pdf)
    }

    /// The vertex there.
    #[inline]
    pub(super) fn vertex(&self, scene: &Scene, profile: &Profile, t: f32, pdf: f32) -> Vertex {
        let Segment { medium, scatterings, leg, .. } = *self.segment;
        let (position, throughput) = self.at(scene, profile, t, pdf);
        let scattering = Scattering::Medium { medium };
        Vertex { position, direction: self.ray.direction, throughput, scatterings, leg, scattering }
    }

    /// Eight junctions at its start, with the throughput that is scattered per metre there if that is the same everywhere.
    fn start<'s>(&self, scene: &'s Scene) -> Junctions<'s> {
        let Segment { medium: id, throughput, .. } = *self.segment;
        let medium = scene.medium(id);
        let throughput = medium.constants().map_or(Spectrum::ZERO, |[_, sigma_s]| throughput * sigma_s);
        let junction = Junction::in_medium(scene, id, self.ray.origin, self.ray.direction, throughput);
        Junctions::all(&junction, Source::Phase(medium.phase()))
    }
}

impl Seeker<'_> {
    /// The junctions at distances `t` of the stretch that begins with `start`, chosen with densities `pdf` (1/m).
    #[inline]
    fn on_stretch<'s>(&self, stretch: &Stretch, start: &Junctions<'s>, t: &Row, pdf: &Row) -> Junctions<'s> {
        let mut camera = *start;
        if let Some([sigma_t, _]) = self.scene.medium(stretch.segment.medium).constants() {
            [camera.position, camera.throughput] = start.after(t, sigma_t, pdf);
            return camera;
        }
        for lane in 0..WIDTH {
            let (t, pdf) = (t.0[lane], pdf.0[lane]);
            let (position, throughput) = match pdf > 0.0 {
                true => stretch.at(self.scene, self.profile, t, pdf),
                false => (stretch.ray.origin, Spectrum::ZERO),
            };
            camera.put(lane, position, throughput);
        }
        camera
    }

    /// Light of rays, scattered on the stretch.
    #[inline]
    fn rays_to_stretch(
        &self,
        batch: &mut Batch,
        stretch: &Stretch,
        start: &Junctions,
        sampler: &mut Sampler,
    ) -> Spectrum {
        let sigma_t = self.profile.uniform().map_or(0.0, |uniform| uniform.sigma_t.min_channel());
        let here = stretch.segment.medium;
        let depth = sigma_t * stretch.length;
        let turns =
            batch.beams().any(|(_, medium)| self.lights.turns_matter([medium, here], depth)).then(|| PairTurns {
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
        // The density of both belongs to the camera's.
        batch.place(self.scene, &s, &Row([1.0; WIDTH]));
        self.connect(batch, &self.on_stretch(stretch, start, &t, &pdf), sampler)
    }

    /// Light of rays, scattered at a vertex.
    #[inline]
    fn rays_to_vertex(&self, batch: &mut Batch, camera: &Junctions, sampler: &mut Sampler) -> Spectrum {
        let matters = batch.beams().any(|(_, medium)| self.lights.turns_matter([medium; 2], 0.0));
        let turns = matters.then(|| (batch.phases(self.scene), batch.rates(self.scene)));
        let [s, pdf] = Level::dispatch(Distances {
            points: &camera.position,
            rays: &batch.rays,
            radius: self.lights.radius,
            turns: turns.as_ref().map(|(phases, rates)| (phases, rates)),
            u: &batch.u[0],
        });
        batch.place(self.scene, &s, &pdf);
        self.connect(batch, camera, sampler)
    }

    /// Light of `count` lights of each kind (0: of all), scattered at the camera's vertex, times the number of light paths.
    pub(super) fn gather(&self, vertex: &Vertex, count: u32, sampler: &mut Sampler) -> Spectrum {
        let lights = self.lights;
        let counts = |scatterings| self.counts(scatterings, vertex.scatterings);
        let camera = Junctions::all(&Junction::new::<FromCamera>(self.scene, vertex), Source::Vertex(vertex));
        let mut sum = Spectrum::ZERO;
        lights.visit_points((count, 1), sampler, counts, |batch, sampler| sum += self.connect(batch, &camera, sampler));
        lights.visit_rays(self.scene, count, sampler, counts, |batch, sampler| {
            sum += self.rays_to_vertex(batch, &camera, sampler);
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
        let start = stretch.start(self.scene);
        let counts = |scatterings| self.counts(scatterings, before);
        let Options { lights: number, samples, .. } = lights.options;
        let mut sum = Spectrum::ZERO;
        let rays = EightRays::all(&ray, length);
        lights.visit_points((number, samples), sampler, counts, |batch, sampler| {
            let (points, radius, u) = (&batch.lights.position, lights.radius, &batch.u[0]);
            let [t, pdf] = Level::dispatch(Distances { points, rays: &rays, radius, turns: None, u });
            sum += self.connect(batch, &self.on_stretch(&stretch, &start, &t, &pdf), sampler);
        });
        lights.visit_rays(self.scene, number, sampler, counts, |batch, sampler| {
            sum += self.rays_to_stretch(batch, &stretch, &start, sampler);
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
