//! A point with a cone.

use super::bound::LightBound;
use super::error::{EmitterProblem, colour, conformal, number, texture};
use crate::Spectrum;
use crate::math::{Aabb, Affine, Transform, Vec2, Vec3};
use crate::scene::desc::{Rgb, TextureDesc};
use crate::scene::texture::{Texture, TexturePoint};

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
            Some(texture) => {
                let half_width = d.z * self.cutoff.tan();
                let uv = 0.5 * (Vec2::ONE + Vec2::new(d.x, d.y) / half_width);
                self.intensity * texture.eval(&TexturePoint::at_uv(uv)) * factor
            }
        }
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
