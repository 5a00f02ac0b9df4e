//! A point with a cone.

use super::bound::LightBound;
use super::emission::{Departure, textured_power};
use super::error::{EmitterProblem, colour, conformal, number, texture};
use crate::Spectrum;
use crate::math::{Aabb, Affine, PerSolidAngle, Transform, Vec2, Vec3};
use crate::scene::desc::{Rgb, TextureDesc};
use crate::scene::texture::{Texture, TexturePoint};
use std::f64::consts::TAU;

/// A point with a cone about +z: full intensity up to the beam width, then linear in the angle down to the cutoff.
#[derive(Debug)]
pub struct Spot {
    /// Position, metres.
    pub position: Vec3,
    intensity: Spectrum,
    /// Half angles, radians.
    cutoff: f32,
    beam: f32,
    /// Factor, over the square around the cone's section: uv is 1/2 on the axis, 0 and 1 at the cutoff.
    texture: Option<Texture>,
    to_world: Affine,
}

impl Spot {
    /// Radiant intensity on the axis (W/sr), half angles in degrees.
    pub fn new(
        intensity: Rgb,
        cutoff_angle: f32,
        beam_width: f32,
        factor: Option<&TextureDesc>,
        to_world: &Transform,
    ) -> Result<Self, EmitterProblem> {
        match factor {
            Some(_) => number("cutoff_angle", cutoff_angle, "in (0, 90) with a texture", |a| a > 0.0 && a < 90.0)?,
            None => number("cutoff_angle", cutoff_angle, "in (0, 180]", |a| a > 0.0 && a <= 180.0)?,
        };
        number("beam_width", beam_width, "in [0, cutoff_angle]", |a| a >= 0.0 && a <= cutoff_angle)?;
        let to_world = conformal(to_world)?;
        Ok(Self {
            position: to_world.point(Vec3::ZERO),
            intensity: colour("intensity", intensity)?,
            cutoff: cutoff_angle.to_radians(),
            beam: beam_width.to_radians(),
            texture: factor.map(|t| texture("texture", t)).transpose()?,
            to_world,
        })
    }

    /// Radiant intensity towards the unit vector `direction`, W/sr.
    #[inline]
    pub fn intensity(&self, direction: Vec3) -> Spectrum {
        let d = self.to_world.inverse_vector(direction);
        let angle = d.x.hypot(d.y).atan2(d.z);
        if angle > self.cutoff {
            return Spectrum::ZERO;
        }
        let factor = if angle > self.beam { (self.cutoff - angle) / (self.cutoff - self.beam) } else { 1.0 };
        match &self.texture {
            None => self.intensity * factor,
            Some(texture) => self.intensity * self.look_up(texture, d) * factor,
        }
    }

    /// The texture towards the local vector `d`.
    #[inline]
    fn look_up(&self, texture: &Texture, d: Vec3) -> Spectrum {
        let half_width = d.z * self.cutoff.tan();
        let uv = 0.5 * (Vec2::ONE + Vec2::new(d.x, d.y) / half_width);
        texture.eval(&TexturePoint::at_uv(uv))
    }

    /// Light that leaves in a direction of the cone.
    ///
    /// The density is even up to the beam width. Then it falls linearly in the cosine to zero at the cutoff, which keeps
    /// the intensity over the density within a factor of two; only cones wider than a hemisphere, where it would not, are
    /// even to the end.
    #[inline]
    pub fn emit(&self, u: Vec2) -> Departure {
        let (beam, cutoff) = (f64::from(self.beam), f64::from(self.cutoff));
        let Cone { inner, outer, falls, rim } = self.cone();
        let x = f64::from(u.x) * (inner + rim);
        let (fall, density, factor) = if x < inner {
            (x, 1.0, 1.0)
        } else {
            let rest = 1.0 - (x - inner) / rim;
            let height = if falls { rest.sqrt() } else { rest };
            let fall = outer - height * (outer - inner);
            let angle = 2.0 * (0.5 * fall).sqrt().min(1.0).asin();
            let factor = ((cutoff - angle) / (cutoff - beam)).clamp(0.0, 1.0);
            (fall, if falls { height } else { 1.0 }, factor)
        };
        let sin = (fall * (2.0 - fall)).max(0.0).sqrt();
        let (sin_phi, cos_phi) = (TAU * f64::from(u.y)).sin_cos();
        let d = Vec3::new((sin * cos_phi) as f32, (sin * sin_phi) as f32, (1.0 - fall) as f32);
        let solid_angle = TAU * (inner + rim) / density;
        let texture = self.texture.as_ref().map_or(Spectrum::ONE, |texture| self.look_up(texture, d));
        Departure {
            direction: self.to_world.vector(d).normalize(),
            flux: self.intensity * texture * (factor * solid_angle) as f32,
            density: PerSolidAngle((1.0 / solid_angle) as f32),
        }
    }

    /// Density with which [`Spot::emit`] finds the unit vector `direction`.
    #[inline]
    pub fn density(&self, direction: Vec3) -> PerSolidAngle {
        let Cone { inner, outer, falls, rim } = self.cone();
        let d = self.to_world.inverse_vector(direction);
        let angle = d.x.hypot(d.y).atan2(d.z);
        if angle > self.cutoff {
            return PerSolidAngle(0.0);
        }
        let fall = fall(f64::from(angle));
        let height = if fall > inner && falls { (outer - fall) / (outer - inner) } else { 1.0 };
        PerSolidAngle((height / (TAU * (inner + rim))) as f32)
    }

    #[inline]
    fn cone(&self) -> Cone {
        let (inner, outer) = (fall(f64::from(self.beam)), fall(f64::from(self.cutoff)));
        let falls = outer <= 1.0;
        Cone { inner, outer, falls, rim: if falls { 0.5 * (outer - inner) } else { outer - inner } }
    }

    /// Power, W.
    pub fn power(&self) -> Spectrum {
        // The integral of the intensity is 2 pi (1 - (sin c - sin b) / (c - b)), here without a difference of sines.
        let (beam, cutoff) = (f64::from(self.beam), f64::from(self.cutoff));
        let (middle, half) = (0.5 * (cutoff + beam), 0.5 * (cutoff - beam));
        let sinc = if half > 0.0 { half.sin() / half } else { 1.0 };
        let solid_angle = TAU * (2.0 * (0.5 * middle).sin().powi(2) + middle.cos() * (1.0 - sinc));
        let white = self.intensity * solid_angle as f32;
        self.texture.as_ref().map_or(white, |texture| textured_power(texture, white, |u| self.emit(u).flux))
    }

    /// Where it is, how bright and whither.
    pub fn bound(&self) -> LightBound {
        let mean = self.texture.as_ref().map_or(Spectrum::ONE, Texture::mean);
        LightBound {
            bounds: Aabb { min: self.position, max: self.position },
            intensity: (self.intensity * mean).mean(),
            axis: self.to_world.vector(Vec3::Z).normalize(),
            theta_o: self.beam,
            theta_e: self.cutoff - self.beam,
        }
    }
}

/// How directions are chosen, by one minus their cosine.
struct Cone {
    /// Up to here all alike ...
    inner: f64,
    /// ... and up to here less and less.
    outer: f64,
    /// Whether the density falls linearly between the two.
    falls: bool,
    /// Extent of the part between in units of the density inside.
    rim: f64,
}

/// One minus the cosine of an angle, which keeps narrow cones accurate.
#[inline]
fn fall(angle: f64) -> f64 {
    2.0 * (0.5 * angle).sin().powi(2)
}
