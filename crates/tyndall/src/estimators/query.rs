//! What the camera asks: along a ray, at a point, on a surface.

use super::merge::{BeamProbe, Meet, PointProbe, SurfaceProbe};
use super::transport::respond_to_light;
use crate::Spectrum;
use crate::accel::{Bvh, Visit};
use crate::math::lanes::Lanes;
use crate::math::{Aabb, Ray, Rng, Vec3};
use crate::photons::Tag;
use crate::scene::Scene;
use crate::scene::desc::MediumId;
use crate::scene::medium::Medium;
use crate::walk::{Profile, Vertex, passage};

/// Which data a query wants.
#[derive(Clone, Copy, Debug)]
pub struct Filter {
    /// Most scatterings of the light before it meets the query.
    pub max_scatterings: u32,
    /// The origins wanted, as in [`Tag::origin_bit`].
    pub origins: u32,
}

impl Filter {
    #[inline(always)]
    fn accepts(&self, tag: Tag) -> bool {
        tag.scatterings() <= self.max_scatterings && tag.origin_bit() & self.origins != 0
    }
}

/// A question of the camera and its physics.
pub trait Query {
    /// Dimension: 0 for points, 1 for beams.
    const DIMENSION: u32;
    /// Dimension of the space in which light and query meet: 3 in media, 2 on surfaces.
    const SPACE: u32 = 3;
    /// Its geometry.
    type Probe;

    /// The geometry.
    fn probe(&self) -> &Self::Probe;
    /// Visits the leaves that may hold data within reach.
    fn traverse<L: Lanes>(&self, bvh: &Bvh, visit: &mut impl Visit);
    /// Whether the datum counts.
    fn accepts(&self, tag: Tag) -> bool;
    /// The point at distance `t`.
    fn position(&self, t: f32) -> Vec3;
    /// The scene, and the medium in it; `None` on surfaces.
    fn place(&self) -> (&Scene, Option<MediumId>);
    /// What the camera sees of light of unit flux density that arrives at distance `t` along `direction`: throughput,
    /// transmittance, phase function or BSDF.
    fn respond(&self, t: f32, direction: Vec3) -> Spectrum;

    /// Weight against other techniques of the datum number `datum`, met at `x`, its light travelling along `direction`.
    #[inline(always)]
    fn weigh(&self, _datum: u32, _meet: &Meet, _x: Vec3, _direction: Vec3) -> f32 {
        1.0
    }

    /// Told what a datum with this tag and this weight adds.
    #[inline(always)]
    fn met(&self, _tag: Tag, _seen: Spectrum, _weight: f32) {}

    /// The medium; `None` on surfaces.
    #[inline(always)]
    fn medium(&self) -> Option<&Medium> {
        let (scene, medium) = self.place();
        medium.map(|id| scene.medium(id))
    }

    /// Transmittance of `length` metres from `bend` along `direction`; zero when something stands between.
    fn look_through(&self, bend: Vec3, direction: Vec3, length: f32, rng: &mut Rng) -> Spectrum {
        let (scene, medium) = self.place();
        let ray = Ray { origin: bend, direction };
        passage(scene, ray, length, medium, true, rng).map_or(Spectrum::ZERO, |p| p.transmittance)
    }
}

/// A stretch of the camera's ray inside one medium.
pub struct BeamQuery<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// The medium.
    pub medium: MediumId,
    /// The stretch.
    pub probe: BeamProbe,
    /// Throughput at its start.
    pub throughput: Spectrum,
    /// Transmittance along it.
    pub profile: &'a Profile,
    /// The data wanted.
    pub filter: Filter,
}

impl Query for BeamQuery<'_> {
    const DIMENSION: u32 = 1;
    type Probe = BeamProbe;

    #[inline(always)]
    fn probe(&self) -> &BeamProbe {
        &self.probe
    }

    #[inline(always)]
    fn traverse<L: Lanes>(&self, bvh: &Bvh, visit: &mut impl Visit) {
        bvh.along::<L>(&self.probe.ray, self.probe.length, visit);
    }

    #[inline(always)]
    fn accepts(&self, tag: Tag) -> bool {
        tag.is_in(self.medium) && self.filter.accepts(tag)
    }

    #[inline(always)]
    fn position(&self, t: f32) -> Vec3 {
        self.probe.ray.at(t)
    }

    #[inline(always)]
    fn place(&self) -> (&Scene, Option<MediumId>) {
        (self.scene, Some(self.medium))
    }

    #[inline(always)]
    fn respond(&self, t: f32, direction: Vec3) -> Spectrum {
        let phase = self.scene.medium(self.medium).phase();
        let value = phase.eval(self.probe.ray.at(t), direction, -self.probe.ray.direction);
        self.throughput * self.profile.at(t) * value
    }
}

/// A point inside a medium that the camera sees.
pub struct PointQuery<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// The medium.
    pub medium: MediumId,
    /// The point.
    pub probe: PointProbe,
    /// Direction of the camera's ray.
    pub direction: Vec3,
    /// Throughput at the point, multiplied by the length of ray it stands for.
    pub throughput: Spectrum,
    /// The data wanted.
    pub filter: Filter,
}

impl Query for PointQuery<'_> {
    const DIMENSION: u32 = 0;
    type Probe = PointProbe;

    #[inline(always)]
    fn probe(&self) -> &PointProbe {
        &self.probe
    }

    #[inline(always)]
    fn traverse<L: Lanes>(&self, bvh: &Bvh, visit: &mut impl Visit) {
        let position = self.probe.position;
        bvh.overlapping::<L>(Aabb { min: position, max: position }, visit);
    }

    #[inline(always)]
    fn accepts(&self, tag: Tag) -> bool {
        tag.is_in(self.medium) && self.filter.accepts(tag)
    }

    #[inline(always)]
    fn position(&self, _t: f32) -> Vec3 {
        self.probe.position
    }

    #[inline(always)]
    fn place(&self) -> (&Scene, Option<MediumId>) {
        (self.scene, Some(self.medium))
    }

    #[inline(always)]
    fn respond(&self, _t: f32, direction: Vec3) -> Spectrum {
        let phase = self.scene.medium(self.medium).phase();
        self.throughput * phase.eval(self.probe.position, direction, -self.direction)
    }
}

/// A point on a surface that the camera sees.
pub struct SurfaceQuery<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// The point.
    pub probe: SurfaceProbe,
    /// The camera's vertex there; its throughput counts.
    pub vertex: &'a Vertex,
    /// The data wanted.
    pub filter: Filter,
}

impl Query for SurfaceQuery<'_> {
    const DIMENSION: u32 = 0;
    const SPACE: u32 = 2;
    type Probe = SurfaceProbe;

    #[inline(always)]
    fn probe(&self) -> &SurfaceProbe {
        &self.probe
    }

    #[inline(always)]
    fn traverse<L: Lanes>(&self, bvh: &Bvh, visit: &mut impl Visit) {
        let position = self.probe.position;
        bvh.overlapping::<L>(Aabb { min: position, max: position }, visit);
    }

    #[inline(always)]
    fn accepts(&self, tag: Tag) -> bool {
        self.filter.accepts(tag)
    }

    #[inline(always)]
    fn position(&self, _t: f32) -> Vec3 {
        self.probe.position
    }

    #[inline(always)]
    fn place(&self) -> (&Scene, Option<MediumId>) {
        (self.scene, None)
    }

    #[inline(always)]
    fn respond(&self, _t: f32, direction: Vec3) -> Spectrum {
        self.vertex.throughput * respond_to_light(self.scene, self.vertex, direction)
    }
}
