//! Merging of the camera's walk with the data of light's.

use super::stores::Stores;
use crate::Spectrum;
use crate::estimators::merge::{
    BeamBeam1D, BeamPoint2D, BeamProbe, PointPoint3D, PointProbe, SurfacePoint2D, SurfaceProbe,
};
use crate::estimators::query::Filter;
use crate::estimators::transport::turn;
use crate::estimators::{BeamQuery, Meet, PointQuery, SurfaceQuery, gather};
use crate::math::{Kernel, PerSolidAngle, Ray, Sampler, Vec3};
use crate::mis::{Meeting, Merging, Recorder, Technique, Weighed, Weigher, weigh_merge};
use crate::photons::Tag;
use crate::scene::Scene;
use crate::scene::desc::MediumId;
use crate::walk::{Account, Arrival, End, FromCamera, Leg, Merges, Profile, Scattering, Segment, Vertex, flight};

/// Data of all origins.
const ALL: u32 = u32::MAX;

/// Merges one camera path.
pub(super) struct Merger<'a, R> {
    pub(super) scene: &'a Scene,
    pub(super) stores: &'a Stores,
    pub(super) kernel: Kernel,
    pub(super) max_depth: u32,
    pub(super) profile: &'a mut Profile,
    pub(super) record: &'a R,
    /// One over the probability that the walk has gone on.
    pub(super) boost: f32,
}

/// Weighs what a query meets, and has it recorded.
struct Scales<'a, R, W> {
    record: &'a R,
    merging: Merging,
    /// Scatterings of the camera's walk before.
    scatterings: u32,
    /// What one light path counts.
    per_path: f32,
    weight: W,
}

impl<R: Recorder, W: Fn(u32, &Meet, Vec3, Vec3) -> f32> Weigher for Scales<'_, R, W> {
    #[inline(always)]
    fn weigh(&self, datum: u32, meet: &Meet, x: Vec3, direction: Vec3) -> f32 {
        (self.weight)(datum, meet, x, direction)
    }

    #[inline(always)]
    fn met(&self, tag: Tag, seen: Spectrum, weight: f32) {
        let (light, camera) = (tag.scatterings() + 2, self.scatterings + 2);
        let technique = Technique::Merge { merging: self.merging, light, camera };
        let weighted = seen * self.per_path;
        // What others find infinitely better is left out of both.
        self.record.add(technique, weighted, if weight > 0.0 { weighted / weight } else { Spectrum::ZERO });
    }
}

/// Both walks at a place in a medium.
#[inline(always)]
fn meeting(
    scene: &Scene,
    medium: MediumId,
    x: Vec3,
    light: Arrival,
    camera: Arrival,
    merges: Merges,
    d: [Vec3; 2],
) -> Meeting {
    let phase = scene.medium(medium).phase();
    let [by_light, by_camera] = d;
    Meeting {
        light,
        camera,
        onward: PerSolidAngle(phase.eval(x, by_light, -by_camera)),
        back: PerSolidAngle(phase.eval(x, by_camera, -by_light)),
        sin: by_light.cross(by_camera).length(),
        merges,
    }
}

impl<R: Recorder> Merger<'_, R> {
    #[inline(always)]
    fn filter(&self, scatterings: u32) -> Option<Filter> {
        let max_scatterings = self.max_depth.checked_sub(scatterings + 2)?;
        Some(Filter { max_scatterings, origins: ALL })
    }

    /// Along a stretch of a medium that the walk is about to pass.
    pub(super) fn along(
        &mut self,
        segment: &Segment,
        account: &Account<FromCamera>,
        sampler: &mut Sampler,
    ) -> Spectrum {
        let Self { scene, stores, kernel, record, .. } = *self;
        let (effort, scatterings) = (&stores.effort, segment.scatterings);
        let set = stores.set(account.leg.first);
        let mut radiance = Spectrum::ZERO;
        let Some(filter) = self.filter(scatterings) else { return radiance };
        if effort.beam_point + effort.beam_beam == 0.0 {
            return radiance;
        }
        let medium = scene.medium(segment.medium);
        let Some((near, far)) = flight::reach(medium, segment.ray, segment.length) else { return radiance };
        let ray = Ray { origin: segment.ray.at(near), direction: segment.ray.direction };
        self.profile.trace(medium, &ray, far - near, sampler.rng());
        let beam = || BeamQuery {
            scene,
            medium: segment.medium,
            probe: BeamProbe { ray, length: far - near },
            throughput: segment.throughput,
            profile: self.profile,
            filter,
        };
        let Account { leg, edge, .. } = account;
        let camera_at = |t: f32| {
            let mut edge = *edge;
            edge.pass(medium, segment.ray, near + t);
            let spread = Leg::spread(leg, ray.at(t));
            leg.arrive::<FromCamera>(&edge, spread, 1.0, true)
        };
        let weigh = |technique, light: Arrival, t: f32, x: Vec3, direction: Vec3| {
            let merges = effort.in_medium(medium, x).at_end_of(leg);
            let met = meeting(scene, segment.medium, x, light, camera_at(t), merges, [direction, ray.direction]);
            weigh_merge(technique, &met)
        };
        if effort.beam_point > 0.0 {
            let terms = &set.points.point_terms;
            let query = Weighed {
                query: beam(),
                weigher: Scales {
                    record,
                    merging: Merging::BeamPoint,
                    scatterings,
                    per_path: self.boost / set.paths[0],
                    weight: |datum: u32, meet: &Meet, x: Vec3, direction: Vec3| {
                        weigh(Merging::BeamPoint, terms[datum as usize], meet.t, x, direction)
                    },
                },
            };
            let found = gather(&BeamPoint2D { kernel }, &query, &set.for_beams, sampler.rng());
            radiance += found.radiance * (self.boost / set.paths[0]);
        }
        if effort.beam_beam > 0.0 {
            let terms = &set.beams.beam_terms;
            let query = Weighed {
                query: beam(),
                weigher: Scales {
                    record,
                    merging: Merging::BeamBeam,
                    scatterings,
                    per_path: self.boost / set.paths[1],
                    weight: |datum: u32, meet: &Meet, x: Vec3, direction: Vec3| {
                        let light = terms[datum as usize].arrive(scene, effort, segment.medium, x);
                        weigh(Merging::BeamBeam, light, meet.t, x, direction)
                    },
                },
            };
            let found = gather(&BeamBeam1D { kernel }, &query, &set.arranged_beams, sampler.rng());
            radiance += found.radiance * (self.boost / set.paths[1]);
        }
        radiance
    }

    /// At a vertex.
    pub(super) fn at(&self, vertex: &Vertex, end: &End, sampler: &mut Sampler) -> Spectrum {
        let Self { scene, stores, kernel, record, .. } = *self;
        let set = stores.set(end.merges_all);
        let (effort, scatterings, per_path) = (&stores.effort, vertex.scatterings, self.boost / set.paths[0]);
        let Some(filter) = self.filter(scatterings) else { return Spectrum::ZERO };
        let found = match &vertex.scattering {
            Scattering::Medium { medium } if effort.point_point > 0.0 => {
                let inside = scene.medium(*medium);
                let sigma_s = inside.sigma_s(vertex.position)
                    * inside.phase().extinction_factor(vertex.position, vertex.direction);
                // The flux of a point has been scattered already: the camera's flight only counts its transmittance.
                let throughput = vertex.throughput.over(sigma_s);
                let terms = &set.points.point_terms;
                let query = Weighed {
                    query: PointQuery {
                        scene,
                        medium: *medium,
                        probe: PointProbe { position: vertex.position },
                        direction: vertex.direction,
                        throughput,
                        filter,
                    },
                    weigher: Scales {
                        record,
                        merging: Merging::PointPoint,
                        scatterings,
                        per_path,
                        weight: |datum: u32, _: &Meet, x: Vec3, direction: Vec3| {
                            let light = terms[datum as usize];
                            let End { corner, arrival, .. } = end;
                            let turn = [direction, vertex.direction];
                            let met = meeting(scene, *medium, x, light, *arrival, corner.merges, turn);
                            weigh_merge(Merging::PointPoint, &met)
                        },
                    },
                };
                gather(&PointPoint3D { kernel }, &query, &set.for_points, sampler.rng())
            }
            Scattering::Surface { point, .. } if end.corner.merges.surface > 0.0 => {
                let terms = &set.points.surface_terms;
                let query = Weighed {
                    query: SurfaceQuery {
                        scene,
                        probe: SurfaceProbe { position: point.position, normal: point.normal },
                        vertex,
                        filter,
                    },
                    weigher: Scales {
                        record,
                        merging: Merging::Surface,
                        scatterings,
                        per_path,
                        weight: |datum: u32, _: &Meet, _: Vec3, direction: Vec3| {
                            let turn = turn::<FromCamera>(scene, vertex, -direction);
                            let (onward, back) = (turn.reverse, turn.pdf);
                            let light = terms[datum as usize];
                            let End { corner, arrival, .. } = *end;
                            let merges = corner.merges;
                            let met = Meeting { light, camera: arrival, onward, back, sin: 0.0, merges };
                            weigh_merge(Merging::Surface, &met)
                        },
                    },
                };
                gather(&SurfacePoint2D { kernel }, &query, &set.on_surfaces, sampler.rng())
            }
            _ => return Spectrum::ZERO,
        };
        found.radiance * per_path
    }
}
