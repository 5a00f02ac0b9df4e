//! Media whose extinction varies and ends at a box.

use super::{MajorantGrid, MediumError, Volume, albedo, volume};
use crate::Spectrum;
use crate::math::{Aabb, Vec3};
use crate::scene::desc::MediumDesc;

/// Extinction from a volume, zero outside the axis-aligned box around the volume's transformed unit cube.
#[derive(Clone, Debug)]
pub struct Heterogeneous {
    sigma_t: Volume,
    albedo: Volume,
    bounds: Aabb,
    majorants: MajorantGrid,
}

impl Heterogeneous {
    pub(super) fn compile(desc: &MediumDesc) -> Result<Self, MediumError> {
        let sigma_t = Volume::compile(&desc.sigma_t, desc.scale, f32::MAX).map_err(MediumError::SigmaT)?;
        let bounds = volume::bounds(&desc.sigma_t).map_err(MediumError::SigmaT)?;
        let majorants = MajorantGrid::new(&sigma_t, bounds);
        if !majorants.max().is_finite() {
            return Err(MediumError::Overflow);
        }
        Ok(Self { sigma_t, albedo: albedo(desc)?, bounds, majorants })
    }

    /// Extinction at `x`, `scale` applied, 1/m; zero outside [`Heterogeneous::bounds`].
    #[inline]
    pub fn sigma_t(&self, x: Vec3) -> Spectrum {
        if self.bounds.contains(x) { self.sigma_t.at(x) } else { Spectrum::ZERO }
    }

    /// Share of the extinction that scatters at `x`.
    #[inline]
    pub fn albedo(&self, x: Vec3) -> Spectrum {
        self.albedo.at(x)
    }

    /// Whether the extinction has three equal channels everywhere.
    #[inline]
    pub fn is_grey(&self) -> bool {
        self.sigma_t.is_grey()
    }

    /// The box outside which there is no extinction.
    #[inline(always)]
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// Local bounds of the extinction.
    #[inline(always)]
    pub fn majorants(&self) -> &MajorantGrid {
        &self.majorants
    }
}
