//! What a walk meets.

use super::Flight;
use crate::Spectrum;
use crate::math::{PerSolidAngle, Ray, Vec3};
use crate::scene::desc::MediumId;
use crate::scene::shape::SurfacePoint;

/// A straight piece of a leg inside one medium, from its start to the next surface.
#[derive(Debug)]
pub struct Segment<'a> {
    /// The piece starts at the ray's origin.
    pub ray: &'a Ray,
    /// Distance to the next surface, metres; possibly infinite. Where the flight ends before it and the sink does not
    /// [look beyond](super::Sink::looks_beyond), any distance beyond the flight's.
    pub length: f32,
    /// The medium.
    pub medium: MediumId,
    /// Throughput at the start.
    pub throughput: Spectrum,
    /// Scattering events so far.
    pub scatterings: u32,
    /// Number of the leg; 0 leaves the sensor or the emitter.
    pub leg: u32,
    /// What the walk did here.
    pub flight: Flight,
}

/// A surface that a leg meets, index-matched or not.
#[derive(Debug)]
pub struct SurfaceHit<'a> {
    /// The point.
    pub point: &'a SurfacePoint,
    /// Direction of travel.
    pub direction: Vec3,
    /// Throughput on arrival.
    pub throughput: Spectrum,
    /// Scattering events so far.
    pub scatterings: u32,
}

/// A walk that left the scene.
#[derive(Debug)]
pub struct Escape {
    /// Direction of travel.
    pub direction: Vec3,
    /// Throughput on leaving.
    pub throughput: Spectrum,
    /// Scattering events so far.
    pub scatterings: u32,
}

/// What scatters at a vertex.
#[derive(Clone, Copy, Debug)]
pub enum Scattering {
    /// The medium.
    Medium {
        /// The medium.
        medium: MediumId,
    },
    /// A surface.
    Surface {
        /// The point.
        point: SurfacePoint,
        /// Medium on the side of arrival.
        medium: Option<MediumId>,
    },
}

/// A vertex of the walk: a point where light scatters.
#[derive(Clone, Copy, Debug)]
pub struct Vertex {
    /// Position, metres.
    pub position: Vec3,
    /// Direction of travel on arrival.
    pub direction: Vec3,
    /// Throughput on arrival; in a medium it contains `sigma_s / p` of the flight.
    pub throughput: Spectrum,
    /// Scattering events before this one.
    pub scatterings: u32,
    /// Number of the leg that ends here.
    pub leg: u32,
    /// What scatters.
    pub scattering: Scattering,
}

/// How a walk goes on from a vertex.
#[derive(Clone, Copy, Debug)]
pub struct Onward {
    /// Unit direction of travel.
    pub direction: Vec3,
    /// Density of the direction; `None` for a delta distribution.
    pub pdf: Option<PerSolidAngle>,
    /// Refractive index of the side entered divided by that of the side left; 1 unless refracted.
    pub eta: f32,
}
