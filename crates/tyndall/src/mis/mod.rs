//! Weights over a set of techniques: the balance heuristic (Veach and Guibas 1995) from what both walks carry.
//!
//! A path found by one technique could have been found by others. What the walks carry (see [`crate::walk::terms`]) sums
//! up their densities on either side of the place where this one joins both walks; here the sums are put together.

pub mod recorder;
pub mod technique;
pub mod weighed;

pub use recorder::{Record, Recorder};
pub use technique::{Catalogue, Technique};
pub use weighed::{Weighed, Weigher};

use crate::estimators::connect::{Join, Sight};
use crate::estimators::transport::Turn;
use crate::math::{PerSolidAngle, Vec3};
use crate::scene::emitter::EndDensity;
use crate::walk::{Arrival, Corner, Edge, Effort, End, FromCamera, FromLight, Leg, Merges};

/// Weight of the connection of two vertices that both walks have found.
#[inline]
pub fn weigh_join(effort: &Effort, light: &End, camera: &End, join: &Join) -> f32 {
    let Join { direction, spread, light: turn_l, camera: turn_c, edge, .. } = join;
    let onward_l = light.arrival.depart::<FromLight>(effort, &light.corner, *direction, Some(0.0), turn_l.reverse.0);
    let onward_c =
        camera.arrival.depart::<FromCamera>(effort, &camera.corner, -*direction, Some(0.0), turn_c.reverse.0);
    let [before, mirrored] = onward_l.before::<FromLight>(edge);
    let before = turn_c.pdf.0 * spread * if camera.corner.merges.mirror { mirrored } else { before };
    let after = turn_l.pdf.0 * spread * onward_c.before::<FromCamera>(&edge.reversed())[0];
    let connect = camera.corner.merges.connect * effort.connect * effort.join;
    connect / (connect + before + after)
}

/// Weight of the connection of a vertex of light's walk with the lens.
#[inline]
pub fn weigh_sight(effort: &Effort, light: &End, sight: &Sight) -> f32 {
    let Sight { direction, light: turn, edge, lens, .. } = sight;
    // The vertex is the first one of the camera's walk.
    let corner = Corner { merges: light.corner.merges.first(), ..light.corner };
    let onward = light.arrival.depart::<FromLight>(effort, &corner, *direction, Some(0.0), turn.reverse.0);
    let spread = if lens.parallel { 1.0 } else { 1.0 / lens.lens.distance_squared(light.corner.position) };
    let lens_effort = corner.merges.connect * effort.lens;
    lens_effort / (lens_effort + lens.density * spread * onward.before_lens(effort, edge))
}

/// An emitter as sampled from a vertex, or as a walk runs into it.
#[derive(Clone, Copy, Debug)]
pub struct Lit {
    /// How densely light paths start there.
    pub density: EndDensity,
    /// Density with which it is sampled from the camera's vertex, in the measure of the place.
    pub sampled: f32,
}

/// Weight of an emitter sampled from a vertex of the camera's walk, which turns by `turn` into `direction` and gets there
/// through `edge` over the squared distance `distance2`.
#[inline]
pub fn weigh_sampled(
    effort: &Effort,
    lit: &Lit,
    camera: &End,
    direction: Vec3,
    turn: &Turn,
    edge: &Edge,
    distance2: f32,
) -> f32 {
    let Lit { density, sampled } = lit;
    let Merges { connect, direct, .. } = camera.corner.merges;
    let onward = camera.arrival.depart::<FromCamera>(effort, &camera.corner, direction, Some(0.0), turn.reverse.0);
    let spread = if density.parallel { 1.0 } else { 1.0 / distance2 };
    let after = density.onward * spread * onward.before::<FromCamera>(edge)[0];
    let hit = if density.hittable { turn.pdf.0 * density.cos * spread * edge.survival } else { 0.0 };
    let own = direct * connect * sampled;
    own / (own + direct * camera.corner.merges.hits() * hit + density.place * after)
}

/// Weight of an emitter that the camera's walk runs into at the end of `leg`, with `spread` that of the leg; 1 at
/// infinity.
#[inline]
pub fn weigh_hit(lit: &Lit, leg: &Leg, edge: &Edge, spread: f32) -> f32 {
    let Lit { density, sampled } = lit;
    let Arrival { connected, before, .. } =
        Leg { join: 1.0, ..*leg }.arrive::<FromCamera>(edge, spread, density.cos, false);
    let Leg { hits, direct, .. } = *leg;
    direct * hits / (direct * (hits + sampled * connected) + density.place * density.onward * before)
}

/// Where a datum of light and a query of the camera meet.
#[derive(Clone, Copy, Debug)]
pub struct Meeting {
    /// What light's walk carries there.
    pub light: Arrival,
    /// What the camera's walk carries there.
    pub camera: Arrival,
    /// Density with which light's walk would go on along the camera's ray.
    pub onward: PerSolidAngle,
    /// Density with which the camera's walk would go on along light's ray.
    pub back: PerSolidAngle,
    /// Sine of the angle between both.
    pub sin: f32,
    /// What is merged here, as the camera's walk says.
    pub merges: Merges,
}

/// A technique that merges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Merging {
    /// Points on surfaces.
    Surface,
    /// Points in media.
    PointPoint,
    /// Camera beams and points.
    BeamPoint,
    /// Beams.
    BeamBeam,
}

impl Merging {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Surface, Self::PointPoint, Self::BeamPoint, Self::BeamBeam];

    /// The name among parameters.
    pub fn name(self) -> &'static str {
        match self {
            Self::Surface => "surf",
            Self::PointPoint => "pp3d",
            Self::BeamPoint => "bp2d",
            Self::BeamBeam => "bb1d",
        }
    }
}

/// Weight of a merge.
#[inline]
pub fn weigh_merge(technique: Merging, meeting: &Meeting) -> f32 {
    let Meeting { light, camera, onward, back, sin, merges } = meeting;
    let Merges { share, surface, point_point, .. } = *merges;
    // In units of the density of both walks colliding at the place.
    let beam_point = merges.beam_point * camera.covered;
    let beam_beam = merges.beam_beam * sin * camera.covered * light.covered;
    let in_medium = point_point + beam_point + beam_beam;
    let (own, all) = match technique {
        Merging::Surface => (surface, surface),
        Merging::PointPoint => (point_point, in_medium),
        Merging::BeamPoint => (beam_point, in_medium),
        Merging::BeamBeam => (beam_beam, in_medium),
    };
    let before = light.behind(merges, back.0);
    let after = camera.behind(merges, onward.0);
    share * own / (share * all + before + after)
}
