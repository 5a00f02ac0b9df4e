//! A latitude-longitude picture around the scene.
//!
//! The radiance is bilinear between pixels: columns lie at `(i + 1/2) / width` of the circle and wrap round, rows at
//! `j / (height - 1)` of the way from the zenith to the nadir, as in Mitsuba 3. The density is bilinear in the azimuth
//! and the *cosine* of the polar angle between the same pixels: it is thus per solid angle without any sine, is zero
//! only where the radiance is, and differs from the radiance's shape only by how the cosine bends within a row.

use super::error::{EmitterProblem, conformal, number};
use crate::Spectrum;
use crate::math::{Affine, PerSolidAngle, Transform, Vec2, Vec3};
use crate::scene::desc::ImageDesc;
use std::f32::consts::{PI, TAU};
use std::sync::Arc;

/// A picture around the scene, +y up.
#[derive(Debug)]
pub struct Envmap {
    image: Arc<ImageDesc>,
    /// Factor of the pixels.
    scale: f32,
    to_world: Affine,
    /// Cosine of the polar angle at the rows of pixels (twice the same row if there is one only).
    cosines: Vec<f32>,
    /// Probability of the patches of pixels above a row.
    row_cdf: Vec<f32>,
    /// For each row of patches, probability of those before a column.
    column_cdf: Vec<f32>,
    /// Integral of the density's weight over the sphere.
    total: f32,
    fluence: Spectrum,
}

impl Envmap {
    /// The picture, its pixels multiplied by `scale`.
    pub fn new(image: &Arc<ImageDesc>, scale: f32, to_world: &Transform) -> Result<Self, EmitterProblem> {
        let (width, height) = (image.width, image.height);
        if width == 0 || height == 0 || width.checked_mul(height) != Some(image.pixels.len()) {
            return Err(EmitterProblem::Picture { width, height, pixels: image.pixels.len() });
        }
        number("scale", scale, "at least 0", |s| s >= 0.0)?;
        if let Some(&found) = image.pixels.iter().find(|p| !p.iter().all(|c| c.is_finite() && *c >= 0.0)) {
            return Err(EmitterProblem::Colour { parameter: "a pixel", found });
        }
        let patches = (height - 1).max(1);
        let mut envmap = Self {
            image: image.clone(),
            scale,
            to_world: conformal(to_world)?,
            cosines: (0..=patches).map(|j| (std::f64::consts::PI * j as f64 / patches as f64).cos() as f32).collect(),
            row_cdf: Vec::with_capacity(patches + 1),
            column_cdf: Vec::with_capacity(patches * (width + 1)),
            total: 0.0,
            fluence: fluence(image, scale),
        };
        let mut rows = vec![0.0];
        for j in 0..patches {
            let mut columns = vec![0.0];
            for i in 0..width {
                let [a, b, c, d] = envmap.corners(i, j);
                columns.push(columns[i] + 0.25 * f64::from(a + b + c + d));
            }
            let height = f64::from(envmap.cosines[j] - envmap.cosines[j + 1]);
            rows.push(rows[j] + columns[width] * height);
            envmap.column_cdf.extend(normalised(&columns));
        }
        envmap.row_cdf.extend(normalised(&rows));
        envmap.total = (rows[patches] * std::f64::consts::TAU / width as f64) as f32;
        Ok(envmap)
    }

    /// Fluence rate that it causes, W/m^2.
    pub fn fluence(&self) -> Spectrum {
        self.fluence
    }

    /// Radiance that arrives along a ray leaving the scene towards `direction`.
    #[inline]
    pub fn radiance(&self, direction: Vec3) -> Spectrum {
        let at = self.locate(direction);
        let [a, b, c, d] = self.pixels(at.column, at.row).map(|p| Spectrum::from_rgb(self.image.pixels[p]));
        a.lerp(b, at.across).lerp(c.lerp(d, at.across), at.down) * self.scale
    }

    /// A direction out of the scene, from the density [`Envmap::pdf`]. Only for maps that are not black.
    #[inline]
    pub fn sample(&self, u: Vec2) -> Vec3 {
        let width = self.image.width;
        let (row, v) = pick(&self.row_cdf, u.y);
        let (column, u) = pick(&self.column_cdf[row * (width + 1)..][..width + 1], u.x);
        let [a, b, c, d] = self.corners(column, row);
        let down = sample_linear(v, a + b, c + d);
        let across = sample_linear(u, a + (c - a) * down, b + (d - b) * down);
        let cos = self.cosines[row] + (self.cosines[row + 1] - self.cosines[row]) * down;
        let sin = (1.0 - cos * cos).max(0.0).sqrt();
        let (sin_phi, cos_phi) = ((column as f32 + 0.5 + across) * (TAU / width as f32)).sin_cos();
        self.to_world.vector(Vec3::new(sin * sin_phi, cos, -sin * cos_phi)).normalize()
    }

    /// Density of [`Envmap::sample`].
    #[inline]
    pub fn pdf(&self, direction: Vec3) -> PerSolidAngle {
        if self.total == 0.0 {
            return PerSolidAngle(0.0);
        }
        let at = self.locate(direction);
        let [a, b, c, d] = self.corners(at.column, at.row);
        let down =
            ((self.cosines[at.row] - at.cos) / (self.cosines[at.row] - self.cosines[at.row + 1])).clamp(0.0, 1.0);
        let above = a + (b - a) * at.across;
        let below = c + (d - c) * at.across;
        PerSolidAngle((above + (below - above) * down) / self.total)
    }

    /// The patch of pixels that `direction` falls into.
    #[inline]
    fn locate(&self, direction: Vec3) -> Place {
        let d = self.to_world.inverse_vector(direction).normalize();
        let (width, patches) = (self.image.width, self.row_cdf.len() - 1);
        // In [0, width): half a column to the left of the azimuth, wrapped round.
        let x = (d.x.atan2(-d.z) * (1.0 / TAU) - 0.5 / width as f32).rem_euclid(1.0) * width as f32;
        // Not acos, which is inaccurate near the poles.
        let y = d.x.hypot(d.z).atan2(d.y) * (1.0 / PI) * patches as f32;
        let (column, row) = ((x as usize).min(width - 1), (y as usize).min(patches - 1));
        Place { column, row, across: (x - column as f32).min(1.0), down: (y - row as f32).min(1.0), cos: d.y }
    }

    /// Indices of the pixels around a patch: above left, above right, below left, below right.
    #[inline(always)]
    fn pixels(&self, column: usize, row: usize) -> [usize; 4] {
        let width = self.image.width;
        let right = if column + 1 < width { column + 1 } else { 0 };
        let (above, below) = (row * width, (row + 1).min(self.image.height - 1) * width);
        [above + column, above + right, below + column, below + right]
    }

    /// Weights of the pixels around a patch.
    #[inline(always)]
    fn corners(&self, column: usize, row: usize) -> [f32; 4] {
        self.pixels(column, row).map(|p| Spectrum::from_rgb(self.image.pixels[p]).mean())
    }
}

/// Integral of the radiance over the sphere, exact: over the azimuth a pixel counts by its width, over the polar angle by
/// the sine times its tent.
fn fluence(image: &ImageDesc, scale: f32) -> Spectrum {
    let patches = (image.height - 1).max(1);
    let step = std::f64::consts::PI / patches as f64;
    let row_sum = |j: usize, c: usize| {
        let row = &image.pixels[j * image.width..][..image.width];
        row.iter().map(|pixel| f64::from(pixel[c])).sum::<f64>()
    };
    let mut sum = [0.0; Spectrum::CHANNELS];
    for j in 0..patches {
        let [(sin0, cos0), (sin1, cos1)] = [j, j + 1].map(|j| (step * j as f64).sin_cos());
        let below = (sin1 - sin0) / step - cos1;
        let above = cos0 - cos1 - below;
        for (c, sum) in sum.iter_mut().enumerate() {
            *sum += above * row_sum(j, c) + below * row_sum((j + 1).min(image.height - 1), c);
        }
    }
    let factor = f64::from(scale) * std::f64::consts::TAU / image.width as f64;
    Spectrum::from_rgb(sum.map(|sum| (sum * factor) as f32))
}

/// A position in the picture.
struct Place {
    column: usize,
    row: usize,
    /// Fraction of the patch to the left.
    across: f32,
    /// Fraction of the patch's polar angle above.
    down: f32,
    /// Cosine of the polar angle.
    cos: f32,
}

/// Running sums divided by the last; all zero when that is.
fn normalised(sums: &[f64]) -> impl Iterator<Item = f32> {
    let total = sums[sums.len() - 1];
    let factor = if total > 0.0 { 1.0 / total } else { 0.0 };
    sums.iter().map(move |s| (s * factor) as f32)
}

/// The interval of `cdf` (ascending from 0 to 1) around `u`, and where in it `u` lies.
#[inline]
fn pick(cdf: &[f32], u: f32) -> (usize, f32) {
    let i = cdf.partition_point(|&c| c <= u).clamp(1, cdf.len() - 1) - 1;
    let width = cdf[i + 1] - cdf[i];
    let within = if width > 0.0 { (u - cdf[i]) / width } else { 0.5 };
    (i, within.clamp(0.0, 1.0 - f32::EPSILON))
}

/// A number of [0, 1] with density proportional to the line from `a` at 0 to `b` at 1.
#[inline]
fn sample_linear(u: f32, a: f32, b: f32) -> f32 {
    let denominator = a + (a * a + (b * b - a * a) * u).max(0.0).sqrt();
    if denominator > 0.0 { (u * (a + b) / denominator).min(1.0) } else { u }
}
