//! An isotropic point.

use super::bound::LightBound;
use super::emission::Departure;
use super::error::{EmitterProblem, colour};
use crate::Spectrum;
use crate::math::{PerSolidAngle, Transform, Vec2, Vec3, warp};
use crate::scene::desc::Rgb;
use std::f32::consts::PI;

/// A point that sends the same radiant intensity everywhere.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// Position, metres.
    pub position: Vec3,
    /// Radiant intensity, W/sr.
    pub intensity: Spectrum,
}

impl Point {
    /// The point at the origin of `to_world`.
    pub fn new(intensity: Rgb, to_world: &Transform) -> Result<Self, EmitterProblem> {
        Ok(Self { position: position(to_world)?, intensity: colour("intensity", intensity)? })
    }

    /// Where it is and how bright.
    pub fn bound(&self) -> LightBound {
        LightBound::omnidirectional(self.position, self.intensity.mean())
    }

    /// Light that leaves in a direction uniform on the sphere.
    #[inline]
    pub fn emit(&self, u: Vec2) -> Departure {
        let density = PerSolidAngle(0.25 / PI);
        Departure { direction: warp::square_to_sphere(u), flux: self.power(), density }
    }

    /// Power, W.
    #[inline]
    pub fn power(&self) -> Spectrum {
        4.0 * PI * self.intensity
    }
}

/// The origin of `to_world`, in world space.
fn position(to_world: &Transform) -> Result<Vec3, EmitterProblem> {
    let position = Vec3::from_array(to_world.point([0.0; 3]).map(|c| c as f32));
    if position.is_finite() { Ok(position) } else { Err(EmitterProblem::Transform { found: to_world.rows().into() }) }
}
