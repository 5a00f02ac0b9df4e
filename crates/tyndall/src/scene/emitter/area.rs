//! A shape that emits.

use super::bound::LightBound;
use super::emission::textured_power;
use super::error::{EmitterProblem, texture};
use super::shapes;
use crate::Spectrum;
use crate::math::Vec3;
use crate::scene::desc::AreaEmitterDesc;
use crate::scene::shape::Geometry;
use crate::scene::texture::{Texture, TexturePoint};
use std::f32::consts::{FRAC_PI_2, PI};

/// A shape that emits on the side of its geometric normal, the same radiance in all directions.
#[derive(Debug)]
pub struct Area {
    /// Index of the shape.
    pub shape: u32,
    radiance: Texture,
    bound: LightBound,
}

impl Area {
    /// The emission of `shape`.
    pub fn new(desc: &AreaEmitterDesc, shape: u32, geometry: &Geometry) -> Result<Self, EmitterProblem> {
        let area = geometry.area(shape);
        if !(area > 0.0 && area.is_finite()) {
            return Err(EmitterProblem::ShapeArea { found: area });
        }
        let radiance = texture("radiance", &desc.radiance)?;
        let (axis, theta_o) = shapes::normals(geometry.form(shape));
        // A closed convex shape shows a quarter of its area on average (Cauchy), a flat one all of it to the front.
        let shown = if theta_o < FRAC_PI_2 { area } else { 0.25 * area };
        let bound = LightBound {
            bounds: geometry.form(shape).bounds(),
            intensity: radiance.mean().mean() * shown,
            axis,
            theta_o,
            theta_e: FRAC_PI_2,
        };
        Ok(Self { shape, radiance, bound })
    }

    /// Where it is, how bright and whither.
    pub fn bound(&self) -> LightBound {
        self.bound
    }

    /// Power, W.
    pub fn power(&self, geometry: &Geometry) -> Spectrum {
        let white = Spectrum::grey(PI * geometry.area(self.shape));
        textured_power(&self.radiance, white, |u| {
            let point = geometry.sample_area(self.shape, u);
            let radiance =
                |(point, _)| self.radiance.eval(&TexturePoint::on_emitter(&point, geometry.mesh(self.shape)));
            white * point.map_or(Spectrum::ZERO, radiance)
        })
    }

    /// Radiance that leaves a point of the shape towards the unit vector `direction`, W/(m^2 sr).
    #[inline]
    pub fn radiance(&self, point: &TexturePoint, normal: Vec3, direction: Vec3) -> Spectrum {
        if direction.dot(normal) > 0.0 { self.radiance.eval(point) } else { Spectrum::ZERO }
    }
}
