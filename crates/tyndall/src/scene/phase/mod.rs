//! Phase functions: how a medium turns light at a scattering event.
//!
//! Directions are unit propagation directions: `d_in` travels to the point, `d_out` leaves it. The cosine of a model is
//! `dot(d_in, d_out)`, so 1 is straight on and a positive mean cosine is forward scattering. Every model is normalised
//! over the sphere of `d_out`, and its sampler has exactly the density of its value.

mod blend;
mod henyey_greenstein;
mod isotropic;
mod rayleigh;
mod sggx;
mod tabulated;

pub use blend::Blend;
pub use henyey_greenstein::HenyeyGreenstein;
pub use sggx::Sggx;
pub use tabulated::Tabulated;

use crate::math::angle::sin_cos_of_turn;
use crate::math::{Frame, PerSolidAngle, Vec2, Vec3};
use crate::scene::desc::PhaseDesc;
use crate::scene::medium::VolumeError;

/// Why a phase function cannot be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PhaseError {
    /// The mean cosine is out of range.
    #[error("mean cosine g is {0}, expected a number between -1 and 1, both excluded")]
    MeanCosine(f32),
    /// A table has fewer than two values.
    #[error("the table has {0} value(s), expected at least two")]
    TableTooShort(usize),
    /// A table value is negative or not finite.
    #[error("table value {index} is {value}, expected a finite number that is not negative")]
    TableValue {
        /// Position in the table, from 0.
        index: usize,
        /// What stands there.
        value: f32,
    },
    /// A table holds nothing but zeros.
    #[error("all values of the table are zero")]
    TableEmpty,
    /// The share of a blend is out of range.
    #[error("blend weight is {0}, expected a number from 0 to 1")]
    Weight(f32),
    /// The microflakes have no grid of matrices.
    #[error("the microflake matrix is a constant colour, expected a grid with six channels (xx, yy, zz, xy, xz, yz)")]
    MatrixConstant,
    /// A microflake matrix is not positive definite.
    #[error("the microflake matrix of voxel ({}, {}, {}) is not positive definite: xx, yy, zz, xy, xz, yz = {matrix:?}", .voxel[0], .voxel[1], .voxel[2])]
    MatrixSingular {
        /// Voxel along x, y, z.
        voxel: [usize; 3],
        /// xx, yy, zz, xy, xz, yz.
        matrix: [f32; 6],
    },
    /// The volume of the microflake matrix is wrong.
    #[error("microflake matrix: {0}")]
    Volume(#[from] VolumeError),
}

/// A phase function, ready to evaluate.
#[derive(Clone, Debug)]
pub enum Phase {
    /// 1/(4 pi).
    Isotropic,
    /// Henyey and Greenstein 1941.
    HenyeyGreenstein(HenyeyGreenstein),
    /// Rayleigh.
    Rayleigh,
    /// Piecewise linear in the cosine.
    Tabulated(Tabulated),
    /// Specular microflakes.
    Sggx(Box<Sggx>),
    /// Two functions in fixed shares.
    Blend(Box<Blend>),
}

impl Phase {
    /// Checks and compiles a description.
    pub fn compile(desc: &PhaseDesc) -> Result<Self, PhaseError> {
        Ok(match desc {
            PhaseDesc::Isotropic => Self::Isotropic,
            PhaseDesc::HenyeyGreenstein { g } => Self::HenyeyGreenstein(HenyeyGreenstein::new(*g)?),
            PhaseDesc::Rayleigh => Self::Rayleigh,
            PhaseDesc::Tabulated { values } => Self::Tabulated(Tabulated::new(values)?),
            PhaseDesc::Sggx { matrix } => Self::Sggx(Box::new(Sggx::new(matrix)?)),
            PhaseDesc::Blend { weight, first, second } => {
                Self::Blend(Box::new(Blend::new(*weight, Self::compile(first)?, Self::compile(second)?)?))
            }
        })
    }

    /// Value at `x`, 1/sr; also the density with which [`Phase::sample`] chooses `d_out`.
    #[inline(always)]
    pub fn eval(&self, x: Vec3, d_in: Vec3, d_out: Vec3) -> f32 {
        match self {
            Self::Isotropic => isotropic::VALUE,
            Self::HenyeyGreenstein(model) => model.eval(d_in, d_out),
            _ => self.eval_other(x, d_in, d_out),
        }
    }

    #[inline(never)]
    fn eval_other(&self, x: Vec3, d_in: Vec3, d_out: Vec3) -> f32 {
        match self {
            Self::Isotropic => isotropic::VALUE,
            Self::HenyeyGreenstein(model) => model.eval(d_in, d_out),
            Self::Rayleigh => rayleigh::eval(d_in.dot(d_out)),
            Self::Tabulated(model) => model.eval(d_in.dot(d_out)),
            Self::Sggx(model) => model.eval(x, d_in, d_out),
            Self::Blend(model) => model.eval(x, d_in, d_out),
        }
    }

    /// The mean cosine of a function of Henyey and Greenstein, 0 of the isotropic one; `None` of any other.
    #[inline(always)]
    pub fn henyey_greenstein(&self) -> Option<f32> {
        match self {
            Self::Isotropic => Some(0.0),
            Self::HenyeyGreenstein(model) => Some(model.g()),
            _ => None,
        }
    }

    /// Value at the cosine between both directions, 1/sr. Of microflakes, for which more than the cosine counts, a rough mean.
    fn at_cosine(&self, cos: f32) -> f32 {
        match self {
            Self::Isotropic | Self::Sggx(_) => isotropic::VALUE,
            Self::HenyeyGreenstein(model) => model.at_cosine(cos),
            Self::Rayleigh => rayleigh::eval(cos),
            Self::Tabulated(model) => model.eval(cos),
            Self::Blend(model) => model.at_cosine(cos),
        }
    }

    /// Multiplies each of `values` by a number proportional to the value at the cosine beside it: for tables of densities. Of
    /// microflakes, for which more than the cosine counts, always the same.
    #[inline]
    pub fn scale_table(&self, cosines: &[f32], values: &mut [f32]) {
        match self {
            Self::Isotropic | Self::Sggx(_) => {}
            Self::HenyeyGreenstein(model) => {
                values.iter_mut().zip(cosines).for_each(|(value, cos)| *value *= model.at_cosine(*cos));
            }
            other => values.iter_mut().zip(cosines).for_each(|(value, cos)| *value *= other.at_cosine(*cos)),
        }
    }

    /// How far from even: the integral of the squared value over the sphere in units of that of isotropic scattering. Of
    /// blends an upper bound; of microflakes, which depend on direction and place, 1.
    pub fn contrast(&self) -> f32 {
        match self {
            Self::Isotropic | Self::Sggx(_) => 1.0,
            Self::HenyeyGreenstein(model) => model.contrast(),
            Self::Rayleigh => 1.05,
            Self::Tabulated(model) => model.contrast(),
            Self::Blend(model) => model.contrast(),
        }
    }

    /// A direction with the density of the value, and that density. `u1` chooses among blended functions, `u2` the
    /// direction; all in [0, 1).
    #[inline(always)]
    pub fn sample(&self, x: Vec3, d_in: Vec3, u1: f32, u2: Vec2) -> (Vec3, PerSolidAngle) {
        match self {
            Self::Isotropic => isotropic::sample(u2),
            Self::HenyeyGreenstein(model) => model.sample(d_in, u2),
            _ => self.sample_other(x, d_in, u1, u2),
        }
    }

    #[inline(never)]
    fn sample_other(&self, x: Vec3, d_in: Vec3, u1: f32, u2: Vec2) -> (Vec3, PerSolidAngle) {
        match self {
            Self::Isotropic => isotropic::sample(u2),
            Self::HenyeyGreenstein(model) => model.sample(d_in, u2),
            Self::Rayleigh => rayleigh::sample(d_in, u2),
            Self::Tabulated(model) => model.sample(d_in, u2),
            Self::Sggx(model) => model.sample(x, d_in, u2),
            Self::Blend(model) => model.sample(x, d_in, u1, u2),
        }
    }

    /// Factor of `sigma_t` and `sigma_s` for light travelling along `d` at `x`: the projected area of microflakes, 1 for
    /// every other function, blends that contain microflakes included (as in Mitsuba 3).
    #[inline(always)]
    pub fn extinction_factor(&self, x: Vec3, d: Vec3) -> f32 {
        match self {
            Self::Sggx(model) => model.projected_area(x, d),
            _ => 1.0,
        }
    }

    /// Upper bound of [`Phase::extinction_factor`] over all of space along `d`; exact where the flakes are the same
    /// everywhere.
    #[inline(always)]
    pub fn max_extinction_factor(&self, d: Vec3) -> f32 {
        match self {
            Self::Sggx(model) => model.max_projected_area(d),
            _ => 1.0,
        }
    }

    /// Upper bound of the value, 1/sr, everywhere and for all directions between which the cosine is `cos[0]` to `cos[1]`.
    #[inline]
    pub fn ceiling(&self, cos: [f32; 2]) -> f32 {
        match self {
            Self::Isotropic => isotropic::VALUE,
            Self::HenyeyGreenstein(model) => model.ceiling(cos),
            // The function is convex.
            Self::Rayleigh => rayleigh::eval(cos[0]).max(rayleigh::eval(cos[1])),
            Self::Tabulated(model) => model.ceiling(cos),
            Self::Sggx(model) => model.ceiling(),
            Self::Blend(model) => model.ceiling(cos),
        }
    }

    /// Whether [`Phase::extinction_factor`] is other than 1.
    #[inline(always)]
    pub fn is_anisotropic_medium(&self) -> bool {
        matches!(self, Self::Sggx(_))
    }
}

/// The direction at an angle of the given cosine and sine to `axis`, turned about it by `2 pi u`.
#[inline(always)]
fn deflect(axis: Vec3, cos: f32, sin: f32, u: f32) -> Vec3 {
    let (sin_phi, cos_phi) = sin_cos_of_turn(u);
    Frame::from_normal(axis).to_world(Vec3::new(sin * cos_phi, sin * sin_phi, cos))
}

#[cfg(test)]
mod tests;
