//! Emitters: what sends light, how much of it arrives at a point, and how to choose where to look for it.

pub mod area;
pub mod bound;
pub mod constant;
pub mod directional;
pub mod emission;
pub mod end;
pub mod envmap;
pub mod error;
pub mod lights;
pub mod point;
pub mod projector;
pub mod shapes;
pub mod spot;
pub mod tree;

pub use area::Area;
pub use constant::Constant;
pub use directional::Directional;
pub use emission::Emission;
pub use end::{EndDensity, LightEnd};
pub use envmap::Envmap;
pub use error::EmitterError;
pub use lights::{EmitterSample, LightPoint, Lights};
pub use point::Point;
pub use projector::Projector;
pub use spot::Spot;

use crate::math::Vec3;
use crate::scene::desc::{EmitterDesc, EmitterKind};
use bound::LightBound;
use error::EmitterProblem;

#[cfg(test)]
mod tests;

/// Index of an emitter among [`Lights`]: first those of the description's list, then the shapes that emit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct EmitterId(pub u32);

/// Any emitter.
#[derive(Debug)]
pub enum Emitter {
    /// A shape that emits.
    Area(Area),
    /// An isotropic point.
    Point(Point),
    /// A point with a cone.
    Spot(Spot),
    /// A picture projected from a point.
    Projector(Projector),
    /// Parallel light.
    Directional(Directional),
    /// The same radiance from everywhere.
    Constant(Constant),
    /// A picture around the scene.
    Envmap(Envmap),
}

/// How far away an emitter is.
enum Reach {
    /// Somewhere in the scene.
    Finite(LightBound),
    /// Infinitely far; fluence rate that it causes, W/m^2.
    Infinite(f32),
}

impl Emitter {
    fn new(desc: &EmitterDesc) -> Result<Self, EmitterProblem> {
        let to_world = &desc.to_world;
        Ok(match &desc.kind {
            EmitterKind::Point { intensity } => Self::Point(Point::new(*intensity, to_world)?),
            EmitterKind::Spot { intensity, cutoff_angle, beam_width, texture } => {
                Self::Spot(Spot::new(*intensity, *cutoff_angle, *beam_width, texture.as_ref(), to_world)?)
            }
            EmitterKind::Directional { irradiance } => Self::Directional(Directional::new(*irradiance, to_world)?),
            EmitterKind::Constant { radiance } => Self::Constant(Constant::new(*radiance)?),
            EmitterKind::Envmap { image, scale } => Self::Envmap(Envmap::new(image, *scale, to_world)?),
            EmitterKind::Projector { irradiance, scale, fov_x, aspect } => {
                Self::Projector(Projector::new(irradiance, *scale, *fov_x, *aspect, to_world)?)
            }
        })
    }

    fn reach(&self) -> Reach {
        match self {
            Self::Area(area) => Reach::Finite(area.bound()),
            Self::Point(point) => Reach::Finite(point.bound()),
            Self::Spot(spot) => Reach::Finite(spot.bound()),
            Self::Projector(projector) => Reach::Finite(projector.bound()),
            Self::Directional(directional) => Reach::Infinite(directional.fluence().mean()),
            Self::Constant(constant) => Reach::Infinite(constant.fluence().mean()),
            Self::Envmap(envmap) => Reach::Infinite(envmap.fluence().mean()),
        }
    }

    /// Position of an emitter that is a point, metres.
    #[inline]
    pub fn position(&self) -> Option<Vec3> {
        match self {
            Self::Point(point) => Some(point.position),
            Self::Spot(spot) => Some(spot.position),
            Self::Projector(projector) => Some(projector.position),
            _ => None,
        }
    }
}
