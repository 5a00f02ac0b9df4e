//! THE random walk.

use super::{Escape, Scattering, Segment, Sink, SurfaceHit, Vertex, fly};
use crate::Spectrum;
use crate::math::{PerSolidAngle, Ray, Sampler, Vec3};
use crate::scene::Scene;
use crate::scene::bsdf::{SurfaceContext, Transport};
use crate::scene::desc::MediumId;

/// Where a walk begins.
#[derive(Clone, Copy, Debug)]
pub struct Start {
    /// The first ray.
    pub ray: Ray,
    /// Nothing beyond this distance is met by the first leg, metres; possibly infinite.
    pub length: f32,
    /// Medium around the start.
    pub medium: Option<MediumId>,
    /// Initial throughput.
    pub throughput: Spectrum,
}

/// When a walk ends, and what it sees.
#[derive(Clone, Copy, Debug)]
pub struct Rules {
    /// Largest depth: 1 is emission seen directly, each real scattering adds one.
    pub max_depth: u32,
    /// Russian roulette starts beyond this depth.
    pub rr_depth: u32,
    /// Whether there are media; without them index-matched boundaries are surfaces like any other.
    pub media: bool,
}

/// Follows one path through the scene and tells `sink` what it meets.
///
/// A *leg* leads from one vertex to the next through any number of index-matched boundaries, which change the medium and
/// nothing else. Russian roulette survives with probability `min(max(throughput) eta^2, 0.95)`.
#[inline]
pub fn walk<S: Sink>(scene: &Scene, start: Start, rules: &Rules, sampler: &mut Sampler, sink: &mut S) {
    let mut ray = start.ray;
    let mut reach = start.length;
    let mut medium = start.medium.filter(|_| rules.media);
    let mut throughput = start.throughput;
    let mut scatterings = 0;
    let mut eta = 1.0;
    let mut leg = 0;
    loop {
        sampler.start_leg(leg);
        let vertex = loop {
            let hit = scene.geometry.intersect(&ray, reach);
            let length = hit.as_ref().map_or(reach, |hit| hit.t);
            if let Some(inside) = medium {
                let u = sampler.vec2();
                let flight = fly(scene.medium(inside), &ray, length, throughput, u, sampler.rng());
                let segment = Segment { ray: &ray, length, medium: inside, throughput, scatterings, leg, flight };
                sink.segment(&segment, sampler);
                throughput *= flight.weight;
                if flight.collided {
                    break Vertex {
                        position: ray.at(flight.distance),
                        direction: ray.direction,
                        throughput,
                        scatterings,
                        leg,
                        scattering: Scattering::Medium { medium: inside },
                    };
                }
            }
            let Some(hit) = hit else {
                sink.escape(&Escape { direction: ray.direction, throughput, scatterings });
                return;
            };
            let point = scene.geometry.surface(&ray, &hit);
            sink.surface(&SurfaceHit { point: &point, direction: ray.direction, throughput, scatterings });
            if rules.media && scene.is_index_matched(point.shape) {
                medium = scene.medium_towards(&point, ray.direction, medium);
                ray.origin = point.leave(ray.direction);
                reach -= length;
                continue;
            }
            break Vertex {
                position: point.position,
                direction: ray.direction,
                throughput,
                scatterings,
                leg,
                scattering: Scattering::Surface { point, medium },
            };
        };

        // Emission beyond this vertex has at least depth scatterings + 2.
        let exhausted = scatterings + 2 > rules.max_depth;
        if !exhausted {
            sink.vertex(&vertex, sampler);
        }
        let scattered = match &vertex.scattering {
            Scattering::Medium { .. } if exhausted => None,
            Scattering::Medium { medium } => {
                let phase = scene.medium(*medium).phase();
                let (direction, pdf) = phase.sample(vertex.position, vertex.direction, sampler.f32(), sampler.vec2());
                ray = Ray { origin: vertex.position, direction };
                Some(Scattered { weight: Spectrum::ONE, pdf: Some(pdf), null: false, eta: 1.0 })
            }
            Scattering::Surface { point, medium: arrival } => {
                let context = scene.surface_context(point);
                let scattered = scatter_surface(scene, &context, &vertex, sampler, rules);
                scattered.filter(|(_, s)| !exhausted || s.null).map(|(direction, s)| {
                    if rules.media {
                        medium = scene.medium_towards(point, direction, *arrival);
                    }
                    ray = Ray { origin: point.leave(direction), direction };
                    s
                })
            }
        };
        let Some(scattered) = scattered else { return };
        throughput *= scattered.weight;
        if throughput.is_black() {
            return;
        }
        reach = f32::INFINITY;
        leg += 1;
        if scattered.null {
            continue;
        }
        sink.scattered(&vertex, ray.direction, scattered.pdf);
        eta *= scattered.eta;
        scatterings += 1;
        if scatterings > rules.rr_depth {
            let survival = (throughput.max_channel() * eta * eta).min(0.95);
            if sampler.f32() >= survival {
                return;
            }
            throughput = throughput / survival;
        }
    }
}

/// The outcome of a scattering event.
struct Scattered {
    weight: Spectrum,
    /// `None` for a delta distribution.
    pdf: Option<PerSolidAngle>,
    /// Passed straight through without scattering.
    null: bool,
    /// Relative refractive index of the crossing.
    eta: f32,
}

/// Samples the BSDF at a surface vertex.
#[inline(always)]
fn scatter_surface(
    scene: &Scene,
    context: &SurfaceContext,
    vertex: &Vertex,
    sampler: &mut Sampler,
    rules: &Rules,
) -> Option<(Vec3, Scattered)> {
    let Scattering::Surface { point, .. } = &vertex.scattering else { return None };
    let wo = point.shading.to_local(-vertex.direction);
    let (lobe, u) = (sampler.f32(), sampler.vec2());
    let sample = scene.bsdfs.sample(scene.bsdf_of(point.shape), context, wo, Transport::Radiance, lobe, u)?;
    let null = sample.event.null && rules.media;
    let direction = if sample.event.null { vertex.direction } else { point.shading.to_world(sample.wi) };
    let pdf = (!sample.event.delta).then_some(sample.pdf);
    Some((direction, Scattered { weight: sample.weight, pdf, null, eta: sample.event.eta }))
}
