//! The same radiance from everywhere.

use super::error::{EmitterProblem, colour};
use crate::Spectrum;
use crate::math::{PerSolidAngle, Vec2, Vec3, warp};
use crate::scene::desc::Rgb;
use std::f32::consts::PI;

/// A uniform sphere around the scene.
#[derive(Clone, Copy, Debug)]
pub struct Constant {
    /// Radiance, W/(m^2 sr).
    pub radiance: Spectrum,
}

impl Constant {
    /// Density of [`Constant::sample`].
    pub const PDF: PerSolidAngle = PerSolidAngle(1.0 / (4.0 * PI));

    /// The emitter of that radiance.
    pub fn new(radiance: Rgb) -> Result<Self, EmitterProblem> {
        Ok(Self { radiance: colour("radiance", radiance)? })
    }

    /// A direction out of the scene, uniform on the sphere.
    #[inline]
    pub fn sample(u: Vec2) -> Vec3 {
        warp::square_to_sphere(u)
    }

    /// Fluence rate that it causes, W/m^2.
    pub fn fluence(&self) -> Spectrum {
        4.0 * PI * self.radiance
    }
}
