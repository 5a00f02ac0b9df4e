//! Participating media: what attenuates and scatters light between surfaces.

mod grid;
mod heterogeneous;
mod homogeneous;
mod majorant;
mod volume;

pub use grid::{Grid, Voxel};
pub use heterogeneous::Heterogeneous;
pub use homogeneous::Homogeneous;
pub use majorant::{CellWalk, MajorantGrid, Segment};
pub use volume::{Volume, VolumeError};

use crate::Spectrum;
use crate::math::Vec3;
use crate::scene::desc::{MediumDesc, MediumKind};
use crate::scene::phase::{Phase, PhaseError};

/// Why a medium cannot be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MediumError {
    /// The factor of the extinction is out of range.
    #[error("scale is {0}, expected a finite number that is not negative")]
    Scale(f32),
    /// The extinction is wrong.
    #[error("sigma_t: {0}")]
    SigmaT(VolumeError),
    /// The albedo is wrong.
    #[error("albedo: {0}")]
    Albedo(VolumeError),
    /// A homogeneous medium has a grid of extinctions.
    #[error("sigma_t of a homogeneous medium is a grid, expected a constant (or a heterogeneous medium)")]
    VaryingExtinction,
    /// The extinction overflows.
    #[error("scale times sigma_t is too large for single precision")]
    Overflow,
    /// The phase function is wrong.
    #[error("phase function: {0}")]
    Phase(#[from] PhaseError),
}

/// A participating medium, ready to evaluate.
#[derive(Clone, Debug)]
pub struct Medium {
    kind: Extinction,
    phase: Phase,
    sample_emitters: bool,
}

/// The coefficients of a medium, by how they vary.
#[derive(Clone, Debug)]
pub enum Extinction {
    /// The same everywhere.
    Homogeneous(Homogeneous),
    /// From a volume, in its box.
    Heterogeneous(Heterogeneous),
}

impl Medium {
    /// Checks and compiles a description.
    pub fn compile(desc: &MediumDesc) -> Result<Self, MediumError> {
        if !(desc.scale.is_finite() && desc.scale >= 0.0) {
            return Err(MediumError::Scale(desc.scale));
        }
        let kind = match desc.kind {
            MediumKind::Homogeneous => Extinction::Homogeneous(Homogeneous::compile(desc)?),
            MediumKind::Heterogeneous => Extinction::Heterogeneous(Heterogeneous::compile(desc)?),
        };
        Ok(Self { kind, phase: Phase::compile(&desc.phase)?, sample_emitters: desc.sample_emitters })
    }

    /// The coefficients, to be matched once a flight.
    #[inline(always)]
    pub fn kind(&self) -> &Extinction {
        &self.kind
    }

    /// The phase function.
    #[inline(always)]
    pub fn phase(&self) -> &Phase {
        &self.phase
    }

    /// Whether light is sampled at scattering events.
    #[inline(always)]
    pub fn sample_emitters(&self) -> bool {
        self.sample_emitters
    }

    /// Extinction at `x`, 1/m, without the phase function's [`Phase::extinction_factor`].
    #[inline]
    pub fn sigma_t(&self, x: Vec3) -> Spectrum {
        match &self.kind {
            Extinction::Homogeneous(medium) => medium.sigma_t(),
            Extinction::Heterogeneous(medium) => medium.sigma_t(x),
        }
    }

    /// Share of the extinction that scatters at `x`.
    #[inline]
    pub fn albedo(&self, x: Vec3) -> Spectrum {
        match &self.kind {
            Extinction::Homogeneous(medium) => medium.albedo(x),
            Extinction::Heterogeneous(medium) => medium.albedo(x),
        }
    }

    /// Scattering at `x`, 1/m, without the phase function's [`Phase::extinction_factor`].
    #[inline]
    pub fn sigma_s(&self, x: Vec3) -> Spectrum {
        self.sigma_t(x) * self.albedo(x)
    }

    /// Extinction and scattering, 1/m, of a medium that has the same everywhere and in all directions.
    #[inline]
    pub fn constants(&self) -> Option<[Spectrum; 2]> {
        let Extinction::Homogeneous(model) = &self.kind else { return None };
        let albedo = model.constant_albedo().filter(|_| !self.phase.is_anisotropic_medium())?;
        Some([model.sigma_t(), model.sigma_t() * albedo])
    }

    /// Whether the extinction has three equal channels everywhere.
    #[inline]
    pub fn is_grey(&self) -> bool {
        match &self.kind {
            Extinction::Homogeneous(medium) => medium.is_grey(),
            Extinction::Heterogeneous(medium) => medium.is_grey(),
        }
    }

    /// Upper bound of every channel of the extinction anywhere, 1/m.
    #[inline]
    pub fn max_sigma_t(&self) -> f32 {
        match &self.kind {
            Extinction::Homogeneous(medium) => medium.sigma_t().max_channel(),
            Extinction::Heterogeneous(medium) => medium.majorants().max(),
        }
    }

    /// The stretches of the ray `o + t d` within `[0, t_max]` on which there can be extinction, from near to far, with
    /// bounds of it.
    #[inline]
    pub fn segments(&self, o: Vec3, d: Vec3, t_max: f32) -> Segments<'_> {
        match &self.kind {
            Extinction::Homogeneous(medium) => {
                let sigma_t = medium.sigma_t();
                let (majorant, minorant) = (sigma_t.max_channel(), sigma_t.min_channel());
                let whole = Segment { t0: 0.0, t1: t_max, majorant, minorant };
                Segments::Whole((majorant > 0.0 && t_max > 0.0).then_some(whole))
            }
            Extinction::Heterogeneous(medium) => Segments::Cells(medium.majorants().segments(o, d, t_max)),
        }
    }
}

/// The segments of one ray through a medium: an iterator without allocation.
#[derive(Clone, Debug)]
pub enum Segments<'a> {
    /// One segment, or none left.
    Whole(Option<Segment>),
    /// Cells of a majorant grid.
    Cells(CellWalk<'a>),
}

impl Iterator for Segments<'_> {
    type Item = Segment;

    #[inline]
    fn next(&mut self) -> Option<Segment> {
        match self {
            Self::Whole(segment) => segment.take(),
            Self::Cells(walk) => walk.next(),
        }
    }
}

/// The albedo of a description.
fn albedo(desc: &MediumDesc) -> Result<Volume, MediumError> {
    Volume::compile(&desc.albedo, 1.0, 1.0).map_err(MediumError::Albedo)
}

#[cfg(test)]
mod tests;
