//! Pictures.

use super::{TextureError, UvMap};
use crate::Spectrum;
use crate::math::Vec2;
use crate::scene::desc::{Filter, ImageDesc, Wrap};
use std::sync::Arc;

/// A picture with its interpolation, shared with the description it came from.
#[derive(Clone, Debug)]
pub struct Bitmap {
    image: Arc<ImageDesc>,
    resolution: Vec2,
    filter: Filter,
    wrap: Wrap,
    to_uv: UvMap,
    mean: Spectrum,
}

impl Bitmap {
    /// Checks the picture.
    pub fn new(image: Arc<ImageDesc>, filter: Filter, wrap: Wrap, to_uv: UvMap) -> Result<Self, TextureError> {
        let (width, height, found) = (image.width, image.height, image.pixels.len());
        // Column and row numbers must fit 32 bits with room for one more.
        let fits = |n: usize| n > 0 && n < i32::MAX as usize;
        if !fits(width) || !fits(height) || width.checked_mul(height) != Some(found) {
            return Err(TextureError::PixelCount { width, height, found });
        }
        let mut sum = [0.0_f64; 3];
        for pixel in &image.pixels {
            for (total, &value) in sum.iter_mut().zip(pixel) {
                *total += f64::from(value);
            }
        }
        let mean = Spectrum::from_rgb(sum.map(|total| (total / found as f64) as f32));
        if !mean.is_finite() {
            return Err(TextureError::NotFinite);
        }
        Ok(Self { resolution: Vec2::new(width as f32, height as f32), image, filter, wrap, to_uv, mean })
    }

    /// The interpolated colour.
    #[inline]
    pub fn eval(&self, uv: Vec2) -> Spectrum {
        let position = self.to_uv.point(uv) * self.resolution;
        match self.filter {
            Filter::Nearest => {
                let cell = position.floor();
                self.pixel(self.column(cell.x), self.row(cell.y))
            }
            Filter::Linear => {
                let ([a, b, c, d], w) = self.corners(position);
                a.lerp(b, w.x).lerp(c.lerp(d, w.x), w.y)
            }
        }
    }

    /// Derivative by u and v of the luminance; zero without interpolation.
    #[inline]
    pub fn gradient(&self, uv: Vec2) -> Vec2 {
        if self.filter == Filter::Nearest {
            return Vec2::ZERO;
        }
        let (corners, w) = self.corners(self.to_uv.point(uv) * self.resolution);
        let [a, b, c, d] = corners.map(Spectrum::luminance);
        let slope = Vec2::new((b - a) * (1.0 - w.y) + (d - c) * w.y, (c - a) * (1.0 - w.x) + (d - b) * w.x);
        self.to_uv.pull_back(slope * self.resolution)
    }

    /// The mean of all pixels.
    pub fn mean(&self) -> Spectrum {
        self.mean
    }

    /// The four pixels whose centres surround a position in pixels, and the weight of the farther ones.
    #[inline(always)]
    fn corners(&self, position: Vec2) -> ([Spectrum; 4], Vec2) {
        let position = position - Vec2::splat(0.5);
        let cell = position.floor();
        let (x0, x1) = (self.column(cell.x), self.column(cell.x + 1.0));
        let (y0, y1) = (self.row(cell.y), self.row(cell.y + 1.0));
        ([self.pixel(x0, y0), self.pixel(x1, y0), self.pixel(x0, y1), self.pixel(x1, y1)], position - cell)
    }

    #[inline(always)]
    fn column(&self, x: f32) -> usize {
        wrap(self.wrap, x, self.image.width)
    }

    #[inline(always)]
    fn row(&self, y: f32) -> usize {
        wrap(self.wrap, y, self.image.height)
    }

    #[inline(always)]
    fn pixel(&self, x: usize, y: usize) -> Spectrum {
        Spectrum::from_rgb(self.image.pixels[y * self.image.width + x])
    }
}

/// The whole number `x` brought into `0..n`.
#[inline(always)]
fn wrap(mode: Wrap, x: f32, n: usize) -> usize {
    // The cast saturates and turns NaN into 0, so every input gives a valid pixel.
    let (x, n) = (x as i32, n as i32);
    let wrapped = match mode {
        Wrap::Repeat => x.rem_euclid(n),
        Wrap::Clamp => x.clamp(0, n - 1),
        Wrap::Mirror => {
            let inside = x.rem_euclid(n);
            if x.div_euclid(n) & 1 == 0 { inside } else { n - 1 - inside }
        }
    };
    wrapped as usize
}
