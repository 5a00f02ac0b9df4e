//! THE random walk.

use super::{Escape, Flight, Onward, Scattering, Segment, Sink, SurfaceHit, Vertex, flight, fly};
use crate::Spectrum;
use crate::math::{PerSolidAngle, Ray, Sampler, Vec2, Vec3};
use crate::scene::Scene;
use crate::scene::bsdf::{SurfaceContext, Transport};
use crate::scene::desc::MediumId;
use crate::scene::emitter::Emission;
use crate::scene::sensor::CameraRay;
use crate::scene::shape::SurfacePoint;

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
    /// The throughput that roulette takes for one.
    pub unit: f32,
    /// Scattering events before.
    pub scatterings: u32,
    /// Number of the first leg.
    pub leg: u32,
}

impl Start {
    /// Of a walk with this throughput along a ray.
    #[inline]
    pub fn new(ray: Ray, length: f32, medium: Option<MediumId>, throughput: Spectrum) -> Self {
        Self { ray, length, medium, throughput, unit: throughput.max_channel(), scatterings: 0, leg: 0 }
    }

    /// Of a light path.
    #[inline]
    pub fn emitted(emission: &Emission) -> Self {
        Self::new(emission.ray, f32::INFINITY, emission.medium, emission.flux)
    }

    /// Of a camera path.
    #[inline]
    pub fn seen(scene: &Scene, camera: &CameraRay) -> Self {
        Self::new(camera.ray, camera.t_max, scene.camera_medium, Spectrum::ONE)
    }
}

/// Which end of light's path a walk starts from.
pub trait Mode {
    /// What the walk carries.
    const TRANSPORT: Transport;
}

/// Walks from the camera carry radiance.
#[derive(Clone, Copy, Debug)]
pub struct FromCamera;

/// Walks from an emitter carry flux.
#[derive(Clone, Copy, Debug)]
pub struct FromLight;

impl Mode for FromCamera {
    const TRANSPORT: Transport = Transport::Radiance;
}

impl Mode for FromLight {
    const TRANSPORT: Transport = Transport::Importance;
}

/// Scatterings after which ...
pub const LONG: u32 = 10_000;
/// ... the roulette ends a walk wherever it is.
pub const LONG_CAP: f32 = 0.99;

/// Walks that pass media for certain go on by roulette if they bring less than this.
const FAINT: f32 = 1e-4;

/// What media do to a walk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Media {
    /// Nothing: there are none, and index-matched boundaries are surfaces like any other.
    Absent,
    /// They scatter it.
    Scatter,
    /// They dim it and let it pass.
    Attenuate,
    /// They let it pass until it has been scattered by chance, not only by smooth mirrors and glass, and scatter it then.
    AttenuateFirst,
}

/// When a walk ends, and what it sees.
#[derive(Clone, Copy, Debug)]
pub struct Rules {
    /// Largest depth: 1 is emission seen directly, each real scattering adds one.
    pub max_depth: u32,
    /// Russian roulette starts beyond this depth.
    pub rr_depth: u32,
    /// Largest probability of surviving a turn of the roulette. With 1, and from depth 0 on, absorption is analogue:
    /// the throughput keeps its first value.
    pub rr_cap: f32,
    /// What media do.
    pub media: Media,
}

/// Follows one path through the scene and tells `sink` what it meets.
///
/// A *leg* leads from one vertex to the next through any number of index-matched boundaries, which change the medium and
/// nothing else. Russian roulette survives with probability `min(max(throughput) eta^2, rr_cap)`, the throughput counted
/// in units of the first one and `eta` only for radiance, whose value refraction changes without loss. Beyond [`LONG`]
/// scatterings it survives with probability [`LONG_CAP`] at most, so that walks end even where nothing absorbs.
#[inline(always)]
pub fn walk<M: Mode, S: Sink>(scene: &Scene, start: Start, rules: &Rules, sampler: &mut Sampler, sink: &mut S) {
    let mut ray = start.ray;
    let mut reach = start.length;
    let media = rules.media != Media::Absent;
    let mut medium = start.medium.filter(|_| media);
    let mut throughput = start.throughput;
    let unit = start.unit;
    let mut scatterings = start.scatterings;
    let mut eta = 1.0;
    let mut leg = start.leg;
    let mut passing = matches!(rules.media, Media::Attenuate | Media::AttenuateFirst);
    loop {
        sampler.start_leg(leg);
        let vertex = loop {
            // Where a flight through the medium ends is often known before what it meets, and then less is to be met.
            let (mut u, mut ahead) = (Vec2::ZERO, f32::INFINITY);
            if !passing && let Some(inside) = medium {
                u = sampler.vec2();
                ahead = flight::ahead(scene.medium(inside), &ray, throughput, u);
            }
            let sought = if sink.looks_beyond(leg) { reach } else { reach.min(ahead) };
            let mut hit = scene.geometry.intersect(&ray, sought);
            if hit.is_none()
                && reach == f32::INFINITY
                && let Some(inside) = medium
                && scene.ends_before(inside, ray.at(sought))
            {
                // A collision so close to a boundary that it was rounded to the other side has left the medium.
                if sought < reach {
                    hit = scene.geometry.intersect(&ray, reach);
                }
                medium = medium.filter(|_| hit.is_some());
            }
            let length = hit.as_ref().map_or(reach, |hit| hit.t);
            if let Some(inside) = medium {
                let flight = if passing {
                    attenuate(scene, inside, &ray, length, sampler)
                } else {
                    fly(scene.medium(inside), &ray, length, ahead, throughput, u, sampler.rng())
                };
                let segment = Segment { ray: &ray, length, medium: inside, throughput, scatterings, leg, flight };
                sink.segment(&segment, sampler);
                throughput *= flight.weight;
                if passing {
                    // Of what hardly passes the medium, little is followed.
                    let survival = throughput.max_channel() / (unit * FAINT);
                    if survival < 1.0 {
                        if sampler.rng().f32() >= survival {
                            return;
                        }
                        throughput = throughput / survival;
                    }
                }
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
            if media && scene.is_index_matched(point.shape) {
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
            Scattering::Medium { .. } if exhausted => return,
            Scattering::Medium { medium } => {
                let phase = scene.medium(*medium).phase();
                let (direction, pdf) = phase.sample(vertex.position, vertex.direction, sampler.f32(), sampler.vec2());
                ray = Ray { origin: vertex.position, direction };
                Scattered { direction, weight: Spectrum::ONE, pdf: Some(pdf), null: false, eta: 1.0 }
            }
            Scattering::Surface { point, medium: arrival } => {
                let context = scene.surface_context(point);
                let (lobe, u) = (sampler.f32(), sampler.vec2());
                let forks = (S::FORKS && scatterings == 0 && !exhausted)
                    .then(|| scene.bsdfs.forks(scene.bsdf_of(point.shape), point.shading.to_local(-vertex.direction)))
                    .flatten();
                let fork = |sink: &mut S, lobe: f32, u: Vec2, share: f32, leg: u32| {
                    let scattered = scatter_surface::<M>(scene, &context, &vertex, lobe, u, media);
                    let Some(Scattered { direction, weight, pdf, eta, .. }) = scattered else { return };
                    let start = Start {
                        ray: Ray { origin: point.leave(direction), direction },
                        length: f32::INFINITY,
                        medium: if media { scene.medium_towards(point, direction, *arrival) } else { medium },
                        throughput: throughput * weight * share,
                        unit,
                        scatterings: scatterings + 1,
                        leg,
                    };
                    sink.fork(&vertex, &Onward { direction, pdf, eta }, start);
                };
                if let Some(reflected) = forks {
                    fork(sink, 0.0, u, reflected, leg + 1);
                    throughput *= 1.0 - reflected;
                } else if S::FORKS && !exhausted {
                    let copies = sink.copies();
                    for i in 1..copies {
                        // The first decisions of all copies are spread evenly, the later ones are independent.
                        let by = i as f32 / copies as f32;
                        let turned = |u: f32| (u + by).fract().min(1.0 - f32::EPSILON);
                        fork(sink, turned(lobe), u.map(turned), 1.0, Sampler::INDEPENDENT_LEG.max(leg + 1));
                    }
                }
                let lobe = forks.unwrap_or(lobe);
                let Some(scattered) = scatter_surface::<M>(scene, &context, &vertex, lobe, u, media) else { return };
                if exhausted && !scattered.null {
                    return;
                }
                if media {
                    medium = scene.medium_towards(point, scattered.direction, *arrival);
                }
                ray = Ray { origin: point.leave(scattered.direction), direction: scattered.direction };
                scattered
            }
        };
        throughput *= scattered.weight;
        if throughput.is_black() {
            return;
        }
        reach = f32::INFINITY;
        leg += 1;
        if scattered.null {
            continue;
        }
        let onward = Onward { direction: scattered.direction, pdf: scattered.pdf, eta: scattered.eta };
        if !sink.scattered(&vertex, &onward) {
            return;
        }
        passing &= rules.media == Media::Attenuate || onward.pdf.is_none();
        if M::TRANSPORT == Transport::Radiance {
            eta *= scattered.eta;
        }
        scatterings += 1;
        if scatterings > rules.rr_depth.min(LONG) {
            let cap = if scatterings > LONG { rules.rr_cap.min(LONG_CAP) } else { rules.rr_cap };
            let survival = (throughput.max_channel() / unit * eta * eta).min(cap);
            if sampler.f32() >= survival {
                return;
            }
            throughput = throughput / survival;
        }
    }
}

/// The outcome of a scattering event.
struct Scattered {
    direction: Vec3,
    weight: Spectrum,
    /// `None` for a delta distribution.
    pdf: Option<PerSolidAngle>,
    /// Passed straight through without scattering.
    null: bool,
    /// Relative refractive index of the crossing.
    eta: f32,
}

/// The flight that passes the medium.
#[inline]
fn attenuate(scene: &Scene, medium: MediumId, ray: &Ray, length: f32, sampler: &mut Sampler) -> Flight {
    let (weight, _) = flight::transmittance(scene.medium(medium), ray, length, sampler.rng());
    Flight { distance: length, collided: false, weight, density: None }
}

/// Samples the BSDF at a surface vertex.
#[inline(always)]
fn scatter_surface<M: Mode>(
    scene: &Scene,
    context: &SurfaceContext,
    vertex: &Vertex,
    lobe: f32,
    u: Vec2,
    media: bool,
) -> Option<Scattered> {
    let Scattering::Surface { point, .. } = &vertex.scattering else { return None };
    let wo = point.shading.to_local(-vertex.direction);
    let sample = scene.bsdfs.sample(scene.bsdf_of(point.shape), context, wo, M::TRANSPORT, lobe, u)?;
    let null = sample.event.null && media;
    if sample.event.null {
        return Some(Scattered { direction: vertex.direction, weight: sample.weight, pdf: None, null, eta: 1.0 });
    }
    let direction = point.shading.to_world(sample.wi);
    let weight = match M::TRANSPORT {
        Transport::Radiance => sample.weight,
        Transport::Importance => {
            sample.weight * adjoint_correction(point, wo.z, sample.wi.z, vertex.direction, direction)
        }
    };
    let pdf = (!sample.event.delta).then_some(sample.pdf);
    Some(Scattered { direction, weight, pdf, null, eta: sample.event.eta })
}

/// What a BSDF times the cosine of the outgoing direction is multiplied by when light is followed: with shading normals
/// the density of light on a surface depends on the geometric cosine and its scattering on the shading one (Veach 1997,
/// eq. 5.19). `cos_in` and `cos_out` are cosines to the shading normal of the directions of travel `d_in` and `d_out`.
#[inline(always)]
fn adjoint_correction(point: &SurfacePoint, cos_in: f32, cos_out: f32, d_in: Vec3, d_out: Vec3) -> f32 {
    let denominator = d_in.dot(point.normal) * cos_out;
    if denominator == 0.0 { 0.0 } else { (cos_in * d_out.dot(point.normal) / denominator).abs() }
}
