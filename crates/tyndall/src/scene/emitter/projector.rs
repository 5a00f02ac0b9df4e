//! A picture projected from a point.

use super::bound::LightBound;
use super::emission::{Departure, textured_power};
use super::error::{EmitterProblem, conformal, number, texture};
use crate::Spectrum;
use crate::math::{Aabb, Affine, PerSolidAngle, Transform, Vec2, Vec3};
use crate::scene::desc::TextureDesc;
use crate::scene::texture::{Texture, TexturePoint};
use std::f32::consts::PI;

/// A picture projected from a point along +z, upright and with its first column at +x.
///
/// A plane at right angles at distance 1 m receives the irradiance `pi * scale * texture`, so that a white diffuse
/// screen there shows the picture itself (the meaning it has in Mitsuba 3).
#[derive(Debug)]
pub struct Projector {
    /// Position, metres.
    pub position: Vec3,
    irradiance: Texture,
    scale: f32,
    /// Half the size of the picture at distance 1.
    half_size: Vec2,
    to_world: Affine,
}

impl Projector {
    /// `fov_x` in degrees, `aspect` width divided by height.
    pub fn new(
        irradiance: &TextureDesc,
        scale: f32,
        fov_x: f32,
        aspect: f32,
        to_world: &Transform,
    ) -> Result<Self, EmitterProblem> {
        number("scale", scale, "at least 0", |s| s >= 0.0)?;
        number("fov", fov_x, "in (0, 180)", |a| a > 0.0 && a < 180.0)?;
        number("aspect", aspect, "above 0", |a| a > 0.0)?;
        let to_world = conformal(to_world)?;
        let half_width = (0.5 * fov_x.to_radians()).tan();
        Ok(Self {
            position: to_world.point(Vec3::ZERO),
            irradiance: texture("irradiance", irradiance)?,
            scale: PI * scale,
            half_size: Vec2::new(half_width, half_width / aspect),
            to_world,
        })
    }

    /// Radiant intensity towards the unit vector `direction`, W/sr.
    #[inline]
    pub fn intensity(&self, direction: Vec3) -> Spectrum {
        let d = self.to_world.inverse_vector(direction).normalize();
        let at = Vec2::new(d.x, d.y) / (d.z * self.half_size);
        if !(d.z > 0.0 && at.abs().max_element() <= 1.0) {
            return Spectrum::ZERO;
        }
        let uv = 0.5 * (Vec2::ONE - at);
        self.irradiance.eval(&TexturePoint::at_uv(uv)) * (self.scale / (d.z * d.z * d.z))
    }

    /// Light that leaves towards a point uniform on the picture.
    #[inline]
    pub fn emit(&self, u: Vec2) -> Departure {
        let d = ((2.0 * u - Vec2::ONE) * self.half_size).extend(1.0).normalize();
        let texture = self.irradiance.eval(&TexturePoint::at_uv(Vec2::ONE - u));
        Departure {
            direction: self.to_world.vector(d).normalize(),
            flux: texture * (self.scale * self.area()),
            density: PerSolidAngle(1.0 / (self.area() * d.z * d.z * d.z)),
        }
    }

    /// Density with which [`Projector::emit`] finds the unit vector `direction`.
    #[inline]
    pub fn density(&self, direction: Vec3) -> PerSolidAngle {
        let d = self.to_world.inverse_vector(direction).normalize();
        let inside = d.z > 0.0 && (Vec2::new(d.x, d.y) / (d.z * self.half_size)).abs().max_element() <= 1.0;
        PerSolidAngle(if inside { 1.0 / (self.area() * d.z * d.z * d.z) } else { 0.0 })
    }

    /// Power, W.
    pub fn power(&self) -> Spectrum {
        let white = Spectrum::grey(self.scale * self.area());
        textured_power(&self.irradiance, white, |u| self.emit(u).flux)
    }

    /// Area of the picture at distance 1.
    #[inline]
    fn area(&self) -> f32 {
        4.0 * self.half_size.x * self.half_size.y
    }

    /// Where it is, how bright and whither.
    pub fn bound(&self) -> LightBound {
        LightBound {
            bounds: Aabb { min: self.position, max: self.position },
            intensity: self.irradiance.mean().mean() * self.scale,
            axis: self.to_world.vector(Vec3::Z).normalize(),
            theta_o: self.half_size.length().atan(),
            theta_e: 0.0,
        }
    }
}
