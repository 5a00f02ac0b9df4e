//! The camera's walk through photons.

use super::{Estimator, PhotonMapping, Scratch, Selection};
use crate::Spectrum;
use crate::estimators::gather::Gathered;
use crate::estimators::merge::{
    BeamBeam1D, BeamBeam2DAboutBeam, BeamBeam2DAboutQuery, BeamBeam3D, BeamPlane0D, BeamPoint2D, BeamPoint3D,
    BeamProbe, PointBeam2D, PointBeam3D, PointPoint3D, PointProbe, SurfacePoint2D, SurfaceProbe,
};
use crate::estimators::query::Filter;
use crate::estimators::transport::{Response, connect, departure, respond};
use crate::estimators::{BeamQuery, PointQuery, Query, SurfaceQuery, gather};
use crate::integrators::components::Components;
use crate::math::{PerSolidAngle, Sampler, Vec2, Vec3};
use crate::photons::Origin;
use crate::scene::Scene;
use crate::walk::{Escape, FromCamera, Onward, Scattering, Segment, Sink, Start, SurfaceHit, Vertex, walk};

/// Bits of origins, as in `Tag::origin_bit`.
const STRAIGHT: u32 = 1 << Origin::Direct as u32;
const SPECULAR: u32 = 1 << Origin::Specular as u32;
const SCATTERED: u32 = 1 << Origin::Scattered as u32;

/// The sink that turns a camera's walk into radiance.
pub(super) struct Gatherer<'a> {
    mapping: &'a PhotonMapping,
    scene: &'a Scene,
    scratch: &'a mut Scratch,
    /// Gathered radiance times the number of light paths.
    gathered: Spectrum,
    /// Other radiance.
    radiance: Spectrum,
    /// Whether all scattering so far was at smooth mirrors and glass.
    specular: bool,
    /// The last vertex; `None` at the camera and after a smooth mirror or glass.
    last: Option<Last>,
    /// Whether the walk only goes on to see whether an emitter comes next.
    ends: bool,
}

/// A vertex from which the walk went on though it is no smooth mirror or glass.
#[derive(Clone, Copy)]
struct Last {
    position: Vec3,
    /// Density of the direction.
    pdf: PerSolidAngle,
    /// Whether light that comes there straight from an emitter is wanted.
    wants_direct: bool,
}

impl<'a> Gatherer<'a> {
    /// Radiance arriving at the film position (pixels of the whole film), one sample.
    #[inline]
    pub(super) fn radiance(
        mapping: &'a PhotonMapping,
        scene: &'a Scene,
        scratch: &'a mut Scratch,
        film: Vec2,
        sampler: &mut Sampler,
    ) -> Spectrum {
        let camera = scene.sensor.sample_ray(film, sampler.vec2());
        let start = Start::seen(scene, &camera);
        let black = Spectrum::ZERO;
        let mut gatherer = Gatherer {
            mapping,
            scene,
            scratch,
            gathered: black,
            radiance: black,
            specular: true,
            last: None,
            ends: false,
        };
        walk::<FromCamera, _>(scene, start, &mapping.options.camera_rules, sampler, &mut gatherer);
        gatherer.radiance + gatherer.gathered / mapping.options.photons as f32
    }

    /// Whether `component` is wanted, of light seen over mirrors and glass; of other light, whether indirect light is.
    #[inline(always)]
    fn wants(&self, component: Components) -> bool {
        let component = if self.specular { component } else { Components::INDIRECT };
        self.mapping.options.components.has(component)
    }

    /// The origins among `parts` whose component is wanted.
    #[inline(always)]
    fn origins(&self, parts: [(u32, Components); 2]) -> u32 {
        parts.iter().filter(|(_, component)| self.wants(*component)).fold(0, |bits, (origin, _)| bits | origin)
    }

    #[inline(always)]
    fn filter(&self, scatterings: u32, origins: u32) -> Filter {
        let max_depth = self.mapping.options.camera_rules.max_depth;
        Filter { max_scatterings: (max_depth - 2).saturating_sub(scatterings), origins }
    }

    /// Whether the walk goes on from a surface that is not smooth glass.
    #[inline(always)]
    fn follows(&self, shape: u32) -> bool {
        !self.scene.is_diffuse(shape)
            || self.scene.is_glossy(shape)
            || (self.mapping.options.final_gather && self.specular)
    }

    /// Light emitted at the end of a leg; `by_emitter` is the density with which an emitter is sampled there.
    #[inline(always)]
    fn add_emitted(&mut self, scatterings: u32, seen: Spectrum, by_emitter: impl Fn(Vec3) -> PerSolidAngle) {
        let options = &self.mapping.options;
        if scatterings >= options.camera_rules.max_depth || (options.hide_emitters && scatterings == 0) {
            return;
        }
        if self.specular {
            if self.wants(Components::EMITTED) {
                self.radiance += seen;
            }
        } else if let Some(Last { position, pdf, wants_direct: true }) = self.last {
            self.radiance += seen * (pdf.0 / (pdf.0 + by_emitter(position).0));
        }
    }

    /// Light straight from an emitter to a surface.
    fn add_direct(&mut self, vertex: &Vertex, sampler: &mut Sampler) {
        let (choice, u) = (sampler.f32(), sampler.vec2());
        let Some(light) = self.scene.lights.sample(vertex.position, choice, u) else { return };
        let Response { value, pdf } = respond(self.scene, vertex, light.direction);
        if value.is_black() {
            return;
        }
        let (origin, medium) = departure(self.scene, vertex, light.direction);
        let Some((arriving, _)) = connect(self.scene, origin, &light, medium, true, sampler.rng()) else { return };
        let walked = if light.delta { 0.0 } else { pdf.0 };
        self.radiance += vertex.throughput * value * arriving / (light.pdf.0 + walked);
    }

    /// Light gathered on a stretch of a ray.
    fn gather_in_medium(&mut self, query: &BeamQuery, sampler: &mut Sampler) -> Option<Gathered> {
        let mapping = self.mapping;
        let kernel = mapping.options.kernel;
        let rng = sampler.rng();
        let (points, beams) = (&mapping.points, &mapping.beams);
        Some(match mapping.options.estimator? {
            Estimator::BeamPoint2D => gather(&BeamPoint2D { kernel }, query, points, rng),
            Estimator::BeamPoint3D => gather(&BeamPoint3D { kernel }, query, points, rng),
            Estimator::BeamBeam3D => gather(&BeamBeam3D { kernel }, query, beams, rng),
            Estimator::BeamBeam2DAboutBeam => gather(&BeamBeam2DAboutBeam { kernel }, query, beams, rng),
            Estimator::BeamBeam2DAboutQuery => gather(&BeamBeam2DAboutQuery { kernel }, query, beams, rng),
            Estimator::BeamBeam1D => gather(&BeamBeam1D { kernel }, query, beams, rng),
            Estimator::BeamPlane0D => {
                let first = gather(&BeamBeam1D { kernel }, query, beams, rng);
                let more = gather(&BeamPlane0D, query, &mapping.planes, rng);
                Gathered { radiance: first.radiance + more.radiance, count: first.count + more.count }
            }
            marching => self.march(marching, query, sampler),
        })
    }

    /// Light gathered at points along a stretch of a ray.
    fn march(&mut self, estimator: Estimator, query: &BeamQuery, sampler: &mut Sampler) -> Gathered {
        let mapping = self.mapping;
        let kernel = mapping.options.kernel;
        let BeamProbe { ray, length } = query.probe;
        let steps = mapping.options.steps;
        let step = length / steps as f32;
        let shift = if mapping.options.jitter { sampler.f32() } else { 0.5 };
        let rng = sampler.rng();
        let mut sum = Gathered { radiance: Spectrum::ZERO, count: 0 };
        for i in 0..steps {
            let t = (i as f32 + shift) * step;
            let at = PointQuery {
                scene: query.scene,
                medium: query.medium,
                probe: PointProbe { position: ray.at(t) },
                direction: ray.direction,
                throughput: query.throughput * query.profile.at(t) * step,
                filter: query.filter,
            };
            let found = match estimator {
                Estimator::PointPoint3D if let Selection::Nearest(k) = mapping.options.selection => {
                    self.gather_nearest(&at, k)
                }
                Estimator::PointPoint3D => gather(&PointPoint3D { kernel }, &at, &mapping.points, rng),
                Estimator::PointBeam3D => gather(&PointBeam3D { kernel }, &at, &mapping.beams, rng),
                _ => gather(&PointBeam2D { kernel }, &at, &mapping.beams, rng),
            };
            sum.radiance += found.radiance;
            sum.count += found.count;
        }
        sum
    }
}

impl Gatherer<'_> {
    /// Light of the `k` photons nearest to a point, blurred over the ball through the last of them, which every kernel is
    /// zero at: without a blur of its own it makes up for the ball having been chosen by it.
    fn gather_nearest(&mut self, at: &PointQuery, k: u32) -> Gathered {
        let PhotonMapping { tree, paths, options, .. } = self.mapping;
        let found = &mut self.scratch.neighbours;
        tree.nearest(at.probe.position, k as usize, f32::MAX, found);
        let mut sum = Gathered { radiance: Spectrum::ZERO, count: 0 };
        let Some(reach2) = found.farthest().filter(|r| *r > 0.0) else { return sum };
        for (squared, index) in found.iter() {
            let photon = &paths.points[index as usize];
            if at.accepts(photon.tag) {
                let weight = options.kernel.value::<3>(squared / reach2, reach2.sqrt());
                sum.radiance += at.respond(0.0, photon.direction.unpack()) * photon.flux.unpack() * weight;
                sum.count += 1;
            }
        }
        sum
    }
}

impl Sink for Gatherer<'_> {
    fn segment(&mut self, segment: &Segment, sampler: &mut Sampler) {
        let max_depth = self.mapping.options.camera_rules.max_depth;
        let origins = self.origins([(STRAIGHT | SPECULAR, Components::SINGLE), (SCATTERED, Components::MULTIPLE)]);
        if self.ends || self.mapping.options.estimator.is_none() || origins == 0 || segment.scatterings + 2 > max_depth
        {
            return;
        }
        let mut profile = std::mem::take(&mut self.scratch.profile);
        if let Some((ray, length)) = profile.trace_segment(self.scene, segment, sampler.rng()) {
            let query = BeamQuery {
                scene: self.scene,
                medium: segment.medium,
                probe: BeamProbe { ray, length },
                throughput: segment.throughput,
                profile: &profile,
                filter: self.filter(segment.scatterings, origins),
            };
            if let Some(found) = self.gather_in_medium(&query, sampler) {
                self.gathered += found.radiance;
            }
        }
        self.scratch.profile = profile;
    }

    fn surface(&mut self, hit: &SurfaceHit) {
        if !self.scene.is_emitter(hit.point.shape) {
            return;
        }
        let lights = &self.scene.lights;
        let emitted = lights.radiance_surface(hit.point, hit.direction);
        if !emitted.is_black() {
            self.add_emitted(hit.scatterings, hit.throughput * emitted, |from| lights.pdf_hit(from, hit.point));
        }
    }

    fn escape(&mut self, escape: &Escape) {
        let lights = &self.scene.lights;
        let emitted = lights.radiance_escape(escape.direction);
        if !emitted.is_black() {
            self.add_emitted(escape.scatterings, escape.throughput * emitted, |_| lights.pdf_escape(escape.direction));
        }
    }

    fn vertex(&mut self, vertex: &Vertex, sampler: &mut Sampler) {
        let Scattering::Surface { point, .. } = &vertex.scattering else { return };
        if self.ends || !self.scene.is_smooth(point.shape) {
            return;
        }
        let followed = self.follows(point.shape);
        if self.wants(Components::DIRECT) {
            self.add_direct(vertex, sampler);
        }
        // Where the walk goes on, it brings all light but that which only light's walk can find.
        let scattered = if followed { 0 } else { SCATTERED };
        let origins = self.origins([(SPECULAR, Components::CAUSTIC), (scattered, Components::INDIRECT)]);
        if origins != 0 {
            let query = SurfaceQuery {
                scene: self.scene,
                probe: SurfaceProbe { position: point.position, normal: point.normal },
                vertex,
                filter: self.filter(vertex.scatterings, origins),
            };
            let merge = SurfacePoint2D { kernel: self.mapping.options.kernel };
            self.gathered += gather(&merge, &query, &self.mapping.surfaces, sampler.rng()).radiance;
        }
    }

    fn scattered(&mut self, vertex: &Vertex, onward: &Onward) -> bool {
        if self.ends {
            return false;
        }
        let Some(pdf) = onward.pdf else {
            self.last = None;
            return true;
        };
        let Scattering::Surface { point, .. } = &vertex.scattering else { return false };
        let wants_direct = self.wants(Components::DIRECT);
        self.ends = !self.follows(point.shape);
        self.last = Some(Last { position: vertex.position, pdf, wants_direct });
        self.specular = false;
        // What lies beyond is indirect light.
        wants_direct || (!self.ends && self.mapping.options.components.has(Components::INDIRECT))
    }
}
