//! What can be wrong with an emitter.

use crate::Spectrum;
use crate::math::{Affine, Transform};
use crate::scene::desc::{Rgb, TextureDesc};
use crate::scene::texture::{Texture, TextureError};

/// An emitter that cannot be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("emitter \"{emitter}\": {problem}")]
pub struct EmitterError {
    /// The emitter's name.
    pub emitter: String,
    /// What is wrong.
    pub problem: EmitterProblem,
}

/// What is wrong with an emitter.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EmitterProblem {
    /// A number out of its range.
    #[error("{parameter} is {found}, expected {expected}")]
    Number {
        /// Name of the parameter.
        parameter: &'static str,
        /// Its value.
        found: f32,
        /// The range it should lie in.
        expected: &'static str,
    },
    /// A colour with a negative or non-finite channel.
    #[error("{parameter} is {found:?}, expected finite channels, none negative")]
    Colour {
        /// Name of the parameter.
        parameter: &'static str,
        /// Its value.
        found: Rgb,
    },
    /// A picture without pixels, or with more or fewer than its size says.
    #[error("the picture has {pixels} pixels, expected {width} x {height}, at least one")]
    Picture {
        /// Columns it claims.
        width: usize,
        /// Rows it claims.
        height: usize,
        /// Pixels it has.
        pixels: usize,
    },
    /// A transform that is not a rotation, reflection, translation or uniform scale.
    #[error("to_world is {found:?}, expected an invertible transform that keeps angles")]
    Transform {
        /// Its rows.
        found: Box<[[f64; 4]; 4]>,
    },
    /// A shape that cannot emit.
    #[error("the area of the shape is {found}, expected a finite positive number")]
    ShapeArea {
        /// Its area, m^2.
        found: f32,
    },
    /// A texture that cannot be compiled.
    #[error(transparent)]
    Texture(#[from] TextureError),
}

/// `value`, if it is a number that `holds` accepts.
pub fn number(
    parameter: &'static str,
    value: f32,
    expected: &'static str,
    holds: impl Fn(f32) -> bool,
) -> Result<f32, EmitterProblem> {
    if value.is_finite() && holds(value) {
        Ok(value)
    } else {
        Err(EmitterProblem::Number { parameter, found: value, expected })
    }
}

/// The spectrum of `rgb`, if it is finite and nowhere negative.
pub fn colour(parameter: &'static str, rgb: Rgb) -> Result<Spectrum, EmitterProblem> {
    if rgb.iter().all(|c| c.is_finite() && *c >= 0.0) {
        Ok(Spectrum::from_rgb(rgb))
    } else {
        Err(EmitterProblem::Colour { parameter, found: rgb })
    }
}

/// The compiled texture, if it is nowhere negative.
pub fn texture(parameter: &'static str, desc: &TextureDesc) -> Result<Texture, EmitterProblem> {
    nonnegative(parameter, desc)?;
    Ok(Texture::compile(desc)?)
}

fn nonnegative(parameter: &'static str, desc: &TextureDesc) -> Result<(), EmitterProblem> {
    match desc {
        TextureDesc::Constant(rgb) => colour(parameter, *rgb).map(drop),
        TextureDesc::Bitmap { image, .. } => image.pixels.iter().try_for_each(|p| colour(parameter, *p).map(drop)),
        TextureDesc::Checkerboard { color0, color1, .. } => {
            nonnegative(parameter, color0).and_then(|()| nonnegative(parameter, color1))
        }
        TextureDesc::MeshAttribute { scale, .. } => number("scale", *scale, "at least 0", |s| s >= 0.0).map(drop),
    }
}

/// The compiled form of a transform that keeps angles.
pub fn conformal(to_world: &Transform) -> Result<Affine, EmitterProblem> {
    let affine = to_world.compile().filter(|a| a.uniform_scale().is_some_and(|s| s > 0.0));
    affine.ok_or_else(|| EmitterProblem::Transform { found: to_world.rows().into() })
}
