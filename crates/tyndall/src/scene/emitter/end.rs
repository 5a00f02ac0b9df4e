//! The light's end of a path: how densely light paths start there, and emitter sampling finds it.

use super::{Constant, Emission, Emitter, EmitterId, EmitterSample, Lights};
use crate::math::{PerSolidAngle, Vec3};
use crate::scene::shape::SurfacePoint;
use std::f32::consts::{FRAC_1_PI, PI};

/// Where a path starts, and in which direction.
#[derive(Clone, Copy, Debug)]
pub struct LightEnd {
    /// The emitter; `None` for everything at infinity that is not a single direction.
    pub emitter: Option<EmitterId>,
    /// Position, metres; without meaning at infinity.
    pub position: Vec3,
    /// Unit normal of an area light; zero for others.
    pub normal: Vec3,
    /// Unit direction of travel.
    pub direction: Vec3,
}

/// How densely light paths start at an end. The place of an end at infinity is its direction.
#[derive(Clone, Copy, Debug)]
pub struct EndDensity {
    /// Density of the place, 1/m^2 or 1/sr; the probability of an emitter that is a single point or direction.
    pub place: f32,
    /// Density of the onward ray: 1/sr, or 1/m^2 across parallel rays.
    pub onward: f32,
    /// Whether the rays of the place are parallel.
    pub parallel: bool,
    /// Whether walks can run into the place: it is no single point or direction.
    pub hittable: bool,
    /// Cosine at an area light; 1 for others.
    pub cos: f32,
}

impl LightEnd {
    /// Of a light path.
    pub fn of_emission(emission: &Emission, lights: &Lights) -> Self {
        let (position, direction) = (emission.ray.origin, emission.ray.direction);
        Self { emitter: lights.single(emission.emitter), position, normal: emission.normal, direction }
    }

    /// Of a sampled emitter.
    pub fn of_sample(sample: &EmitterSample, lights: &Lights) -> Self {
        let emitter = lights.single(sample.emitter);
        Self { emitter, position: sample.position, normal: sample.normal, direction: -sample.direction }
    }

    /// Of an emitting surface that a camera's walk along `direction` runs into.
    pub fn of_hit(point: &SurfacePoint, direction: Vec3, lights: &Lights) -> Self {
        let emitter = lights.of_shape(point.shape);
        Self { emitter, position: point.position, normal: point.normal, direction: -direction }
    }

    /// Of a camera's walk that leaves the scene along `direction`.
    pub fn of_escape(direction: Vec3) -> Self {
        Self { emitter: None, position: Vec3::ZERO, normal: Vec3::ZERO, direction: -direction }
    }
}

impl Lights {
    /// The emitter, unless it stands for all surroundings together.
    fn single(&self, emitter: EmitterId) -> Option<EmitterId> {
        let is_around = matches!(self.emitters()[emitter.0 as usize], Emitter::Constant(_) | Emitter::Envmap(_));
        (!is_around).then_some(emitter)
    }

    /// How densely [`Lights::sample_emission`] starts paths like this.
    pub fn end_density(&self, end: &LightEnd) -> EndDensity {
        let point = |place, onward: PerSolidAngle| EndDensity {
            place,
            onward: onward.0,
            parallel: false,
            hittable: false,
            cos: 1.0,
        };
        let from_infinity = |place, hittable| EndDensity {
            place,
            onward: self.emission.disk_density().0,
            parallel: true,
            hittable,
            cos: 1.0,
        };
        let Some(id) = end.emitter else { return from_infinity(self.surroundings_density(-end.direction), true) };
        let selection = self.emission.probability(id);
        match &self.emitters()[id.0 as usize] {
            Emitter::Area(area) => {
                let cos = end.direction.dot(end.normal).max(0.0);
                let place = selection * self.geometry.area_pdf(area.shape).0;
                EndDensity { place, onward: cos * FRAC_1_PI, parallel: false, hittable: true, cos }
            }
            Emitter::Point(_) => point(selection, PerSolidAngle(0.25 / PI)),
            Emitter::Spot(spot) => point(selection, spot.density(end.direction)),
            Emitter::Projector(projector) => point(selection, projector.density(end.direction)),
            Emitter::Directional(_) | Emitter::Constant(_) | Emitter::Envmap(_) => from_infinity(selection, false),
        }
    }

    /// Density with which light paths come from the direction `out` (pointing out of the scene), over all surroundings.
    fn surroundings_density(&self, out: Vec3) -> f32 {
        let density = |(id, emitter): (u32, &Emitter)| match emitter {
            Emitter::Constant(_) => self.emission.probability(EmitterId(id)) * Constant::PDF.0,
            Emitter::Envmap(map) => self.emission.probability(EmitterId(id)) * map.pdf(out).0,
            _ => 0.0,
        };
        (0..).zip(self.emitters()).map(density).sum()
    }

    /// Density with which [`Lights::sample`] at `x` finds the end, in the measure of [`EndDensity::place`].
    pub fn sampled_density(&self, x: Vec3, end: &LightEnd) -> f32 {
        let Some(id) = end.emitter else { return self.pdf_escape(-end.direction).0 };
        match &self.emitters()[id.0 as usize] {
            Emitter::Area(area) => {
                let distance = x.distance(end.position);
                let pdf = self.pdf_point(x, area.shape, end.position, end.normal);
                pdf.to_area(distance, end.direction.dot(end.normal)).0
            }
            _ => self.point_selection_pdf(x, id),
        }
    }
}
