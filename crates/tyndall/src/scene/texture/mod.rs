//! Colour over a surface, compiled for look-ups.
//!
//! Conventions (those of Mitsuba 3): `v = 0` is the first row of a picture, pixel `(i, j)` covers
//! `[i, i + 1] x [j, j + 1]` divided by the resolution and has its centre in the middle, `to_uv` acts on the surface's
//! uv as on a point of the plane z = 0.

mod bitmap;
mod uv_map;

#[cfg(test)]
mod tests;

pub use bitmap::Bitmap;
pub use uv_map::UvMap;

use crate::Spectrum;
use crate::math::Vec2;
use crate::scene::desc::TextureDesc;
use crate::scene::shape::{AreaPoint, Mesh, SurfacePoint};

/// Where a texture is looked up.
#[derive(Clone, Copy, Debug)]
pub struct TexturePoint<'a> {
    /// Texture coordinates.
    pub uv: Vec2,
    /// The mesh the point lies on, if it is one.
    pub mesh: Option<&'a Mesh>,
    /// Index of the triangle in the mesh.
    pub triangle: u32,
    /// Barycentric coordinates of the triangle's second and third vertex.
    pub barycentrics: Vec2,
}

impl<'a> TexturePoint<'a> {
    /// The look-up at a point of a surface, which lies on `mesh` if it lies on a mesh.
    #[inline(always)]
    pub fn new(surface: &SurfacePoint, mesh: Option<&'a Mesh>) -> Self {
        Self { uv: surface.uv, mesh, triangle: surface.triangle, barycentrics: surface.barycentrics }
    }

    /// The look-up at a point of an emitting shape, which lies on `mesh` if it lies on a mesh.
    #[inline(always)]
    pub fn on_emitter(point: &AreaPoint, mesh: Option<&'a Mesh>) -> Self {
        Self { uv: point.uv, mesh, triangle: point.triangle, barycentrics: point.barycentrics }
    }

    /// A look-up by texture coordinates alone, away from any mesh.
    #[inline(always)]
    pub fn at_uv(uv: Vec2) -> Self {
        Self { uv, mesh: None, triangle: 0, barycentrics: Vec2::ZERO }
    }
}

/// Why a texture cannot be compiled.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TextureError {
    /// The picture has no pixels, or not `width * height` of them.
    #[error("a bitmap of {width} x {height} pixels holds {found} values")]
    PixelCount {
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
        /// Pixels stored.
        found: usize,
    },
    /// A value is infinite or not a number.
    #[error("a texture value is not finite")]
    NotFinite,
    /// The matrix of `to_uv` has infinite entries or entries that are not numbers.
    #[error("to_uv is not finite")]
    Transform,
}

/// Colour over a surface.
#[derive(Clone, Debug)]
pub enum Texture {
    /// The same everywhere.
    Constant {
        /// The colour.
        value: Spectrum,
        /// The mean of its channels.
        grey: f32,
    },
    /// A picture.
    Bitmap(Bitmap),
    /// Two textures in a 2x2 pattern over the unit square.
    Checkerboard(Box<Checkerboard>),
    /// Data stored with the mesh.
    MeshAttribute {
        /// The attribute's name, with `vertex_` or `face_`.
        name: Box<str>,
        /// Factor.
        scale: f32,
    },
}

/// Two textures in a 2x2 pattern over the unit square.
#[derive(Clone, Debug)]
pub struct Checkerboard {
    colors: [Texture; 2],
    to_uv: UvMap,
}

impl Checkerboard {
    /// 0 in the cells on the diagonal from the origin, else 1.
    #[inline]
    fn parity(&self, uv: Vec2) -> usize {
        let uv = self.to_uv.point(uv);
        let cell = uv - uv.floor();
        usize::from((cell.x > 0.5) != (cell.y > 0.5))
    }
}

impl Texture {
    /// The same value in every channel, everywhere.
    pub fn grey(value: f32) -> Self {
        Self::Constant { value: Spectrum::grey(value), grey: value }
    }

    /// Checks a description and makes it ready for look-ups.
    pub fn compile(desc: &TextureDesc) -> Result<Self, TextureError> {
        match desc {
            TextureDesc::Constant(rgb) => {
                let value = Spectrum::from_rgb(*rgb);
                if !value.is_finite() {
                    return Err(TextureError::NotFinite);
                }
                let grey = if value.is_grey() { rgb[0] } else { value.mean() };
                Ok(Self::Constant { value, grey })
            }
            TextureDesc::Bitmap { image, filter, wrap, to_uv } => {
                Bitmap::new(image.clone(), *filter, *wrap, UvMap::new(to_uv)?).map(Self::Bitmap)
            }
            TextureDesc::Checkerboard { color0, color1, to_uv } => Ok(Self::Checkerboard(Box::new(Checkerboard {
                colors: [Self::compile(color0)?, Self::compile(color1)?],
                to_uv: UvMap::new(to_uv)?,
            }))),
            TextureDesc::MeshAttribute { name, scale } if scale.is_finite() => {
                Ok(Self::MeshAttribute { name: name.as_str().into(), scale: *scale })
            }
            TextureDesc::MeshAttribute { .. } => Err(TextureError::NotFinite),
        }
    }

    /// The colour. A missing mesh attribute is black.
    #[inline]
    pub fn eval(&self, point: &TexturePoint) -> Spectrum {
        match self {
            Self::Constant { value, .. } => *value,
            Self::Bitmap(bitmap) => bitmap.eval(point.uv),
            Self::Checkerboard(board) => board.colors[board.parity(point.uv)].eval(point),
            Self::MeshAttribute { name, scale } => attribute(name, point) * *scale,
        }
    }

    /// One number: the luminance of a picture or an attribute, the mean of the channels of a constant.
    ///
    /// A checkerboard answers with its other colour here, as Mitsuba 3 does, so that masks and roughnesses agree.
    #[inline]
    pub fn eval_grey(&self, point: &TexturePoint) -> f32 {
        match self {
            Self::Constant { grey, .. } => *grey,
            Self::Bitmap(bitmap) => bitmap.eval(point.uv).luminance(),
            Self::Checkerboard(board) => board.colors[1 - board.parity(point.uv)].eval_grey(point),
            Self::MeshAttribute { name, scale } => attribute(name, point).luminance() * *scale,
        }
    }

    /// Derivative by u and v of the grey value. Zero but for pictures with linear interpolation.
    #[inline]
    pub fn gradient(&self, point: &TexturePoint) -> Vec2 {
        match self {
            Self::Bitmap(bitmap) => bitmap.gradient(point.uv),
            _ => Vec2::ZERO,
        }
    }

    /// The mean over the unit square before `to_uv`; an attribute, not being known here, counts as its scale.
    pub fn mean(&self) -> Spectrum {
        match self {
            Self::Constant { value, .. } => *value,
            Self::Bitmap(bitmap) => bitmap.mean(),
            Self::Checkerboard(board) => (board.colors[0].mean() + board.colors[1].mean()) * 0.5,
            Self::MeshAttribute { scale, .. } => Spectrum::grey(*scale),
        }
    }

    /// The mean of [`Self::eval_grey`].
    pub fn mean_grey(&self) -> f32 {
        match self {
            Self::Constant { grey, .. } => *grey,
            Self::Bitmap(bitmap) => bitmap.mean().luminance(),
            Self::Checkerboard(board) => (board.colors[0].mean_grey() + board.colors[1].mean_grey()) * 0.5,
            Self::MeshAttribute { scale, .. } => *scale,
        }
    }

    /// Whether the value depends on the point.
    pub fn varies(&self) -> bool {
        !matches!(self, Self::Constant { .. })
    }

    /// Whether the texture is the same number everywhere in every channel.
    pub fn is_constant(&self, expected: f32) -> bool {
        matches!(self, Self::Constant { value, .. } if *value == Spectrum::grey(expected))
    }
}

/// The mesh's attribute at the point; black where there is none.
#[inline(never)]
fn attribute(name: &str, point: &TexturePoint) -> Spectrum {
    point.mesh.and_then(|mesh| mesh.attribute(name, point.triangle, point.barycentrics)).unwrap_or(Spectrum::ZERO)
}
