//! Cameras.
//!
//! A camera looks along +z of its frame; +x points left in the picture and +y up. Its importance is 1: the value of a
//! pixel is the mean radiance of the rays through it.

use crate::math::{Affine, Ray, Vec2, Vec3, warp};
use crate::scene::desc::{FilmDesc, SensorDesc, SensorKind};

/// Why a camera cannot be built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SensorError {
    /// `to_world` cannot be inverted.
    #[error("to_world of the sensor is not an invertible affine transform")]
    Transform,
    /// `to_world` of a perspective camera scales.
    #[error("to_world of the sensor scales lengths, which a perspective camera does not allow")]
    Scaled,
    /// The field of view is out of range.
    #[error("field of view is {0} degrees, expected a number between 0 and 180, both excluded")]
    FieldOfView(f32),
    /// The clipping planes are out of order.
    #[error("near_clip is {near} and far_clip {far}, expected 0 < near_clip < far_clip, both finite")]
    Clip {
        /// Near plane.
        near: f32,
        /// Far plane.
        far: f32,
    },
    /// The film has no pixels.
    #[error("the film has {width} x {height} pixels")]
    Film {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// The radius of the lens is out of range.
    #[error("aperture radius is {0}, expected a finite number greater than 0")]
    Aperture(f32),
    /// The distance of the plane in focus is out of range.
    #[error("focus distance is {0}, expected a finite number greater than 0")]
    Focus(f32),
    /// The principal point is not a number.
    #[error("principal point offset is ({}, {}), expected finite numbers", .0[0], .0[1])]
    PrincipalPoint([f32; 2]),
}

/// A ray of a camera.
#[derive(Clone, Copy, Debug)]
pub struct CameraRay {
    /// Starts on the near clipping plane: nothing nearer is seen, and no medium attenuates before it.
    pub ray: Ray,
    /// Distance to the far clipping plane along the ray, metres.
    pub t_max: f32,
}

/// Where a point appears in the picture.
#[derive(Clone, Copy, Debug)]
pub struct Projection {
    /// Position on the whole film, in pixels from its top left corner; may lie outside the film.
    pub film_position: Vec2,
    /// The ray that sees the point: what [`Sensor::sample_ray`] gives for this position and point of the lens.
    pub ray: CameraRay,
    /// Distance of the point along the ray, metres; at most its `t_max`.
    pub distance: f32,
    /// Pixels that a small surface at the point, at right angles to the ray, covers per area, 1/m^2. An intensity
    /// (W/sr) that leaves the point towards the camera adds this much of itself to the picture.
    pub pixels_per_area: f32,
}

/// Density of a camera's rays in the directions or places where it is one sample for each pixel.
#[derive(Clone, Copy, Debug)]
pub struct RayDensity {
    /// The point of the lens that the ray comes from, metres.
    pub lens: Vec3,
    /// Density of the direction at the lens, 1/sr; per area across the ray (1/m^2) where all rays are parallel.
    pub density: f32,
    /// Whether all rays are parallel.
    pub parallel: bool,
}

/// A camera, ready to make rays.
#[derive(Clone, Debug)]
pub struct Sensor {
    to_world: Affine,
    near: f32,
    far: f32,
    /// Position in the camera's frame of the film's corner (0, 0), on the plane z = 1 (any plane when orthographic).
    corner: Vec2,
    /// Change of that position by one pixel; the picture's axes run against the frame's.
    pixel: Vec2,
    lens: Lens,
}

#[derive(Clone, Copy, Debug)]
enum Lens {
    Pinhole,
    Thin { radius: f32, focus: f32 },
    Orthographic,
}

impl Sensor {
    /// Checks and compiles a description.
    pub fn compile(desc: &SensorDesc, film: &FilmDesc) -> Result<Self, SensorError> {
        let to_world = desc.to_world.compile().ok_or(SensorError::Transform)?;
        let (near, far) = (desc.near_clip, desc.far_clip);
        if !(0.0 < near && near < far && far.is_finite()) {
            return Err(SensorError::Clip { near, far });
        }
        if film.width == 0 || film.height == 0 {
            return Err(SensorError::Film { width: film.width, height: film.height });
        }
        let (half_width, principal_point, lens) = match desc.kind {
            SensorKind::Perspective { fov_x, principal_point } => (half_width(fov_x)?, principal_point, Lens::Pinhole),
            SensorKind::ThinLens { fov_x, aperture_radius, focus_distance } => {
                if !(aperture_radius > 0.0 && aperture_radius.is_finite()) {
                    return Err(SensorError::Aperture(aperture_radius));
                }
                if !(focus_distance > 0.0 && focus_distance.is_finite()) {
                    return Err(SensorError::Focus(focus_distance));
                }
                (half_width(fov_x)?, [0.0; 2], Lens::Thin { radius: aperture_radius, focus: focus_distance })
            }
            SensorKind::Orthographic => (1.0, [0.0; 2], Lens::Orthographic),
        };
        if !principal_point.iter().all(|offset| offset.is_finite()) {
            return Err(SensorError::PrincipalPoint(principal_point));
        }
        if !matches!(lens, Lens::Orthographic) && !to_world.uniform_scale().is_some_and(|s| (s - 1.0).abs() < 5e-4) {
            return Err(SensorError::Scaled);
        }
        let size = Vec2::new(film.width as f32, film.height as f32);
        // Pixels are square, so the width alone sets their size.
        let pixel = Vec2::splat(-2.0 * half_width / size.x);
        let corner = -pixel * size * (Vec2::splat(0.5) - Vec2::from(principal_point));
        Ok(Self { to_world, near, far, corner, pixel, lens })
    }

    /// The ray through a position of the whole film, in pixels from its top left corner. `u_lens` in [0, 1)^2 chooses
    /// the point on a thin lens.
    #[inline]
    pub fn sample_ray(&self, film_position: Vec2, u_lens: Vec2) -> CameraRay {
        let p = self.corner + self.pixel * film_position;
        match self.lens {
            Lens::Pinhole => self.ray(Vec2::ZERO, p),
            Lens::Thin { radius, focus } => {
                let start = radius * warp::square_to_disk(u_lens);
                self.ray(start, p - start / focus)
            }
            Lens::Orthographic => self.ray(p, Vec2::ZERO),
        }
    }

    /// The ray from `start` on the plane z = 0 that moves by `slope` over z = 1, both in the camera's frame.
    #[inline]
    fn ray(&self, start: Vec2, slope: Vec2) -> CameraRay {
        let origin = self.to_world.point((start + self.near * slope).extend(self.near));
        let direction = self.to_world.vector(slope.extend(1.0)).normalize();
        CameraRay { ray: Ray { origin, direction }, t_max: (self.far - self.near) * slope.extend(1.0).length() }
    }

    /// How densely rays like `ray`, which the camera made, lie when every pixel takes one sample.
    #[inline]
    pub fn ray_density(&self, ray: &Ray) -> RayDensity {
        let pixels = 1.0 / (self.pixel.x * self.pixel.y);
        match self.lens {
            Lens::Orthographic => {
                let sides = self.to_world.vector(Vec3::X).cross(self.to_world.vector(Vec3::Y));
                RayDensity { lens: ray.origin, density: pixels / sides.dot(ray.direction).abs(), parallel: true }
            }
            Lens::Pinhole | Lens::Thin { .. } => {
                let slant = 1.0 / self.to_world.inverse_vector(ray.direction).z;
                let lens = ray.origin - self.near * slant * ray.direction;
                RayDensity { lens, density: pixels * slant * slant * slant, parallel: false }
            }
        }
    }

    /// Where `x` appears through the point of the lens that `u_lens` chooses; `None` when it lies outside the clipping
    /// planes.
    #[inline]
    pub fn project(&self, x: Vec3, u_lens: Vec2) -> Option<Projection> {
        let local = self.to_world.inverse_point(x);
        let (flat, z) = (local.truncate(), local.z);
        // Pixels per area of the plane z = 1 (of any plane when orthographic).
        let density = 1.0 / (self.pixel.x * self.pixel.y);
        let (p, ray, pixels_per_area) = match self.lens {
            Lens::Orthographic => {
                let sides = self.to_world.vector(Vec3::X).cross(self.to_world.vector(Vec3::Y));
                let ray = self.ray(flat, Vec2::ZERO);
                (flat, ray, density / sides.dot(ray.ray.direction).abs())
            }
            Lens::Pinhole | Lens::Thin { .. } => {
                let (start, shift) = match self.lens {
                    Lens::Thin { radius, focus } => {
                        let start = radius * warp::square_to_disk(u_lens);
                        (start, start / focus)
                    }
                    _ => (Vec2::ZERO, Vec2::ZERO),
                };
                let slope = (flat - start) / z;
                // The plane at z is z^2 larger, and inclined to the ray.
                (slope + shift, self.ray(start, slope), density * slope.extend(1.0).length() / (z * z))
            }
        };
        let distance = (x - ray.ray.origin).dot(ray.ray.direction);
        let film_position = (p - self.corner) / self.pixel;
        (z > 0.0 && distance >= 0.0 && distance <= ray.t_max).then_some(Projection {
            film_position,
            ray,
            distance,
            pixels_per_area,
        })
    }

    /// Centre of the lens of a perspective camera, metres; the middle of the frame of an orthographic one.
    pub fn position(&self) -> Vec3 {
        self.to_world.point(Vec3::ZERO)
    }

    /// Unit direction in which the camera looks.
    pub fn direction(&self) -> Vec3 {
        self.to_world.vector(Vec3::Z).normalize()
    }
}

/// Half the width of the picture on the plane z = 1.
fn half_width(fov_x: f32) -> Result<f32, SensorError> {
    if 0.0 < fov_x && fov_x < 180.0 {
        Ok((0.5 * f64::from(fov_x).to_radians()).tan() as f32)
    } else {
        Err(SensorError::FieldOfView(fov_x))
    }
}

#[cfg(test)]
mod tests;
