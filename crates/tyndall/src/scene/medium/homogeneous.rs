//! Media with the same extinction everywhere.

use super::{MediumError, Volume, albedo};
use crate::Spectrum;
use crate::math::Vec3;
use crate::scene::desc::{MediumDesc, VolumeDesc};

/// Constant extinction without bounds; the albedo may vary.
#[derive(Clone, Debug)]
pub struct Homogeneous {
    sigma_t: Spectrum,
    is_grey: bool,
    albedo: Volume,
}

impl Homogeneous {
    pub(super) fn compile(desc: &MediumDesc) -> Result<Self, MediumError> {
        let VolumeDesc::Constant { .. } = desc.sigma_t else { return Err(MediumError::VaryingExtinction) };
        let volume = Volume::compile(&desc.sigma_t, desc.scale, f32::MAX).map_err(MediumError::SigmaT)?;
        let sigma_t = volume.at(Vec3::ZERO);
        if !sigma_t.is_finite() {
            return Err(MediumError::Overflow);
        }
        Ok(Self { sigma_t, is_grey: sigma_t.is_grey(), albedo: albedo(desc)? })
    }

    /// Extinction, `scale` applied, 1/m.
    #[inline(always)]
    pub fn sigma_t(&self) -> Spectrum {
        self.sigma_t
    }

    /// Scattering at `x`, 1/m.
    #[inline(always)]
    pub fn sigma_s(&self, x: Vec3) -> Spectrum {
        self.sigma_t * self.albedo.at(x)
    }

    /// Share of the extinction that scatters at `x`.
    #[inline(always)]
    pub fn albedo(&self, x: Vec3) -> Spectrum {
        self.albedo.at(x)
    }

    /// That share, if it is the same everywhere.
    #[inline]
    pub fn constant_albedo(&self) -> Option<Spectrum> {
        if let Volume::Constant(albedo) = self.albedo { Some(albedo) } else { None }
    }

    /// Whether the extinction has three equal channels.
    #[inline(always)]
    pub fn is_grey(&self) -> bool {
        self.is_grey
    }

    /// Transmittance over `distance` metres, possibly infinite.
    #[inline(always)]
    pub fn transmittance(&self, distance: f32) -> Spectrum {
        // 0 * infinity is not a number, which `max` turns into no extinction.
        if self.is_grey {
            Spectrum::grey((-(self.sigma_t[0] * distance).max(0.0)).exp())
        } else {
            self.sigma_t.map(|sigma_t| (-(sigma_t * distance).max(0.0)).exp())
        }
    }
}
