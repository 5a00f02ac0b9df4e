//! Parallel light.

use super::error::{EmitterProblem, colour};
use crate::Spectrum;
use crate::math::{Transform, Vec3};
use crate::scene::desc::Rgb;

/// Parallel light from infinitely far.
#[derive(Clone, Copy, Debug)]
pub struct Directional {
    /// Unit direction of travel.
    pub direction: Vec3,
    /// Irradiance of a surface at right angles, W/m^2.
    pub irradiance: Spectrum,
}

impl Directional {
    /// Light that travels along +z of `to_world`.
    pub fn new(irradiance: Rgb, to_world: &Transform) -> Result<Self, EmitterProblem> {
        let along = Vec3::from_array(to_world.vector([0.0, 0.0, 1.0]).map(|c| c as f32));
        let direction =
            along.try_normalize().ok_or_else(|| EmitterProblem::Transform { found: to_world.rows().into() })?;
        Ok(Self { direction, irradiance: colour("irradiance", irradiance)? })
    }

    /// Fluence rate that it causes, W/m^2.
    pub fn fluence(&self) -> Spectrum {
        self.irradiance
    }
}
