//! The estimators that merge: each a file, each saying where a query meets a datum and how much that weighs.

mod beam_beam_1d;
mod beam_beam_2d;
mod beam_beam_3d;
mod beam_plane_0d;
mod beam_point_2d;
mod beam_point_3d;
mod point_beam_2d;
mod point_beam_3d;
mod point_point_3d;
mod surface_point_2d;
#[cfg(test)]
mod tests;

pub use beam_beam_1d::BeamBeam1D;
pub use beam_beam_2d::{BeamBeam2DAboutBeam, BeamBeam2DAboutQuery};
pub use beam_beam_3d::BeamBeam3D;
pub use beam_plane_0d::BeamPlane0D;
pub use beam_point_2d::BeamPoint2D;
pub use beam_point_3d::BeamPoint3D;
pub use point_beam_2d::PointBeam2D;
pub use point_beam_3d::PointBeam3D;
pub use point_point_3d::PointPoint3D;
pub use surface_point_2d::SurfacePoint2D;

use crate::math::lanes::{Lanes, Mask};
use crate::math::triples::{Lines, along, cross, dot, load, minus, splat};
use crate::math::{Ray, Rng, Vec3};
use crate::photons::{BeamBlock, Store};

/// Where a query meets a datum.
#[derive(Clone, Copy, Debug)]
pub struct Meet {
    /// Distance along the query, metres; 0 for points.
    pub t: f32,
    /// Coordinates on the datum, metres.
    pub s: [f32; 2],
    /// Kernel, Jacobian and the inverse density of what was sampled.
    pub weight: f32,
}

/// A stretch of a camera's ray.
#[derive(Clone, Copy, Debug)]
pub struct BeamProbe {
    /// The ray.
    pub ray: Ray,
    /// Its length, metres, finite.
    pub length: f32,
}

/// A point seen by the camera.
#[derive(Clone, Copy, Debug)]
pub struct PointProbe {
    /// Position, metres.
    pub position: Vec3,
}

/// A point on a surface seen by the camera.
#[derive(Clone, Copy, Debug)]
pub struct SurfaceProbe {
    /// Position, metres.
    pub position: Vec3,
    /// Unit normal.
    pub normal: Vec3,
}

/// An estimator by merging.
pub trait Merge {
    /// The geometry of its queries.
    type Probe;
    /// Its data.
    type Store: Store;
    /// Dimension of the blur.
    const BLUR: u32;
    /// Whether what lies between the datum's bend and the meeting point must be looked through.
    const SHADOWED: bool = false;

    /// The lanes that may meet, as bits: all that do, and hardly any that do not.
    fn touches<L: Lanes>(&self, probe: &Self::Probe, block: &<Self::Store as Store>::Block) -> u32;

    /// Where the datum in a lane meets the query; residual integrals are sampled with `rng`.
    fn meet(&self, probe: &Self::Probe, store: &Self::Store, leaf: u32, lane: usize, rng: &mut Rng) -> Option<Meet>;
}

/// The stretch of a line inside a ball: `offset` leads from the line's start to the centre. In metres along the line, cut
/// to `[from, until]`.
#[inline(always)]
fn chord(offset: Vec3, direction: Vec3, radius: f32, from: f32, until: f32) -> Option<(f32, f32)> {
    let middle = offset.dot(direction);
    let rest = radius * radius - (offset - middle * direction).length_squared();
    cut(middle, rest, 1.0, from, until)
}

/// `middle -+ sqrt(rest) / slope`, cut to `[from, until]`; `None` when nothing is left.
#[inline(always)]
fn cut(middle: f32, rest: f32, slope: f32, from: f32, until: f32) -> Option<(f32, f32)> {
    if !(rest > 0.0) {
        return None;
    }
    let half = rest.sqrt() / slope;
    let (low, high) = ((middle - half).max(from), (middle + half).min(until));
    (low < high).then_some((low, high))
}

/// Where two lines are closest.
struct Closest {
    /// Distance along the first, metres.
    t: f32,
    /// Distance along the second, metres.
    s: f32,
    /// Distance between the lines, squared, m^2.
    distance2: f32,
    /// Sine of the angle between them, squared; never zero.
    sin2: f32,
    /// Their cross product, first times second.
    normal: Vec3,
}

impl Closest {
    /// Unit vector along the common normal.
    #[inline(always)]
    fn across(&self) -> Vec3 {
        self.normal / self.sin2.sqrt()
    }
}

/// Feet of `offset`s on lines through the origin: distances along the unit vectors `direction`, and which of them are
/// less than `radius` away. A negative radius is less than every distance.
#[inline(always)]
fn feet<L: Lanes>(offset: [L; 3], direction: [L; 3], radius: L) -> (L, L::Mask) {
    let t = dot(offset, direction);
    let across = along(offset, L::splat(0.0).sub(t), direction);
    (t, dot(across, across).lt(radius.mul(radius.abs())))
}

/// Where the lines of a ray and of eight beams are closest, all multiplied by the square of the sine between them.
struct Approach<L> {
    /// Distance along the ray.
    t: L,
    /// Distance along the beam.
    s: L,
    sin2: L,
    /// Squared radius minus squared distance; positive where the lines are near each other.
    rest: L,
    /// A hundred-thousandth of the piece's end: the division that decides may round either way.
    slack: L,
}

#[inline(always)]
fn approach<L: Lanes>(probe: &BeamProbe, block: &BeamBlock) -> Approach<L> {
    let v = minus(load(&block.origin), splat(probe.ray.origin));
    let Lines { t, s, sin2, across } = Lines::<L>::new(splat(probe.ray.direction), v, load(&block.direction));
    let radius = L::load(&block.radius);
    Approach {
        t,
        s,
        sin2,
        rest: radius.mul(radius.abs()).mul(sin2).sub(across.mul(across)),
        slack: L::splat(1e-5).mul(L::load(&block.s1)).mul(sin2),
    }
}

/// The pieces of beams of which some point may lie within their radius of some point of the ray.
#[inline(always)]
fn lines_touch<L: Lanes>(probe: &BeamProbe, block: &BeamBlock) -> u32 {
    let Approach { t, s, sin2, rest, slack } = approach::<L>(probe, block);
    // Half the chord times the squared sine, whose square is the rest.
    let half = rest.max(L::splat(0.0)).sqrt();
    let slack = half.add(slack);
    let on_ray = L::splat(0.0).le(t.add(half)).and(t.sub(half).le(L::splat(probe.length).mul(sin2)));
    let on_beam = L::load(&block.s0).mul(sin2).le(s.add(slack)).and(s.sub(slack).le(L::load(&block.s1).mul(sin2)));
    L::splat(0.0).lt(rest).and(on_ray).and(on_beam).bits()
}

/// Sine squared below which two lines count as parallel: the beams between are lost, a share of the directions of
/// 1e-12.
const PARALLEL: f32 = 1e-12;

/// Where two rays' lines are closest; `None` when they are parallel. Neither numerator nor denominator is the cosine, so
/// perpendicular lines are as good as others.
#[inline(always)]
fn closest(first: &Ray, second: &Ray) -> Option<Closest> {
    let (e, b) = (first.direction, second.direction);
    let v = second.origin - first.origin;
    let normal = e.cross(b);
    let sin2 = normal.length_squared();
    if sin2 < PARALLEL {
        return None;
    }
    let (cos, ve, vb) = (e.dot(b), v.dot(e), v.dot(b));
    let across = v.dot(normal);
    Some(Closest {
        t: (ve - cos * vb) / sin2,
        s: (cos * ve - vb) / sin2,
        distance2: across * across / sin2,
        sin2,
        normal,
    })
}
