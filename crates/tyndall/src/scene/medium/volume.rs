//! Functions of space: constants and grids of one or three channels.

use super::Grid;
use crate::Spectrum;
use crate::math::{Aabb, Vec3};
use crate::scene::desc::VolumeDesc;

/// Why a volume cannot be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum VolumeError {
    /// `to_world` cannot be inverted.
    #[error("to_world is not an invertible affine transform")]
    Transform,
    /// An axis has no samples, or too many.
    #[error("the grid has {} x {} x {} samples, expected 1 to 1048576 along each axis", .0[0], .0[1], .0[2])]
    Size([usize; 3]),
    /// The grid has the wrong number of channels.
    #[error("the grid has {found} channel(s), expected {expected}")]
    Channels {
        /// What the grid has.
        found: usize,
        /// What is needed here (1 where 1 and 3 both are).
        expected: usize,
    },
    /// The grid's values do not fit its size.
    #[error("the grid has {found} values, expected {} x {} x {} samples of {channels} channel(s)", .size[0], .size[1], .size[2])]
    Length {
        /// Number of values.
        found: usize,
        /// Samples along x, y, z.
        size: [usize; 3],
        /// Values a sample.
        channels: usize,
    },
    /// A value is not a number or infinite.
    #[error("value {index} is {value}, expected a finite number")]
    NotFinite {
        /// Position in the values.
        index: usize,
        /// What stands there.
        value: f32,
    },
    /// A value is out of range.
    #[error("value {index} is {value}, expected a number from {min} to {max}")]
    Range {
        /// Position in the values.
        index: usize,
        /// What stands there.
        value: f32,
        /// Smallest allowed value.
        min: f32,
        /// Largest allowed value.
        max: f32,
    },
}

/// A function of space, defined everywhere.
#[derive(Clone, Debug)]
pub enum Volume {
    /// The same everywhere.
    Constant(Spectrum),
    /// A grid with one channel.
    Grey(Box<Grid<f32>>),
    /// A grid with three channels.
    Colour(Box<Grid<Spectrum>>),
}

impl Volume {
    /// Checks a description whose values must lie in `0..=max`, and compiles it with every value times `factor`.
    pub fn compile(desc: &VolumeDesc, factor: f32, max: f32) -> Result<Self, VolumeError> {
        let in_range = |values: &[f32]| match values.iter().position(|v| !(0.0..=max).contains(v)) {
            Some(index) if values[index].is_finite() => {
                Err(VolumeError::Range { index, value: values[index], min: 0.0, max })
            }
            Some(index) => Err(VolumeError::NotFinite { index, value: values[index] }),
            None => Ok(()),
        };
        match desc {
            VolumeDesc::Constant { value, to_world } => {
                to_world.compile().ok_or(VolumeError::Transform)?;
                in_range(value)?;
                Ok(Self::Constant(Spectrum::from_rgb(*value) * factor))
            }
            VolumeDesc::Grid { grid, to_world, filter, wrap } => {
                let volume = if grid.channels == 3 {
                    let read = |v: &[f32]| Spectrum::new(v[0], v[1], v[2]) * factor;
                    Self::Colour(Box::new(Grid::compile(grid, to_world, *filter, *wrap, read)?))
                } else {
                    Self::Grey(Box::new(Grid::compile(grid, to_world, *filter, *wrap, |v| v[0] * factor)?))
                };
                in_range(&grid.values)?;
                Ok(volume)
            }
        }
    }

    /// Value at `x`.
    #[inline]
    pub fn at(&self, x: Vec3) -> Spectrum {
        match self {
            Self::Constant(value) => *value,
            Self::Grey(grid) => Spectrum::grey(grid.at(x)),
            Self::Colour(grid) => grid.at(x),
        }
    }

    /// Whether the channels are equal everywhere.
    pub fn is_grey(&self) -> bool {
        match self {
            Self::Constant(value) => value.is_grey(),
            Self::Grey(_) => true,
            Self::Colour(_) => false,
        }
    }
}

/// The box around the transformed unit cube of a volume.
pub(super) fn bounds(desc: &VolumeDesc) -> Result<Aabb, VolumeError> {
    let (VolumeDesc::Constant { to_world, .. } | VolumeDesc::Grid { to_world, .. }) = desc;
    let to_world = to_world.compile().ok_or(VolumeError::Transform)?;
    Ok(to_world.bounds(Aabb { min: Vec3::ZERO, max: Vec3::ONE }))
}
