//! Spheres, disks and cylinders. They are met one by one, so they can afford double precision.

use crate::math::angle::angle_of;
use crate::math::{Aabb, Ray, Vec2};
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// A sphere in world space.
#[derive(Clone, Debug)]
pub struct Sphere {
    /// Centre, metres.
    pub center: DVec3,
    /// Radius, metres.
    pub radius: f64,
    /// The object's axes in world space: unit vectors, the third towards the pole v = 0.
    pub axes: [DVec3; 3],
    /// 1 when the normal points outwards, -1 inwards.
    pub side: f64,
}

/// A disk or, under a non-uniform scale, an ellipse in world space.
#[derive(Clone, Debug)]
pub struct Disk {
    /// Centre, metres.
    pub center: DVec3,
    /// Where the object's x and y axes end, from the centre, metres.
    pub axes: [DVec3; 2],
    /// Dual to the axes: products with an offset in the plane are its object coordinates.
    pub dual: [DVec3; 2],
    /// Unit normal.
    pub normal: DVec3,
}

/// An open tube in world space.
#[derive(Clone, Debug)]
pub struct Cylinder {
    /// The end where v = 0, metres.
    pub base: DVec3,
    /// Unit vectors: where u = 0, u = 1/4, and along the axis.
    pub axes: [DVec3; 3],
    /// Radius, metres.
    pub radius: f64,
    /// Length, metres.
    pub length: f64,
    /// 1 when the normal points outwards, -1 inwards.
    pub side: f64,
}

/// A surface point before rounding.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// Position, metres.
    pub position: DVec3,
    /// Unit normal.
    pub normal: DVec3,
    /// Texture coordinates.
    pub uv: DVec2,
    /// Derivative of the position by u, metres.
    pub dp_du: DVec3,
    /// Derivative of the position by v, metres.
    pub dp_dv: DVec3,
}

/// The angle of (x, y) over a full turn, in [0, 1). Texture coordinates need no more than single precision.
fn turn(x: f64, y: f64) -> f64 {
    let u = f64::from(angle_of(x as f32, y as f32)) / TAU;
    if u < 0.0 { u + 1.0 } else { u }
}

fn round_up(bounds: (DVec3, DVec3)) -> Aabb {
    let pad = (bounds.0.abs().max(bounds.1.abs())) * f32::EPSILON as f64;
    Aabb { min: (bounds.0 - pad).as_vec3(), max: (bounds.1 + pad).as_vec3() }
}

/// The roots of `a t^2 - 2 b t + c`, the smaller first, without cancellation (Haines et al. 2019, eq. 5), given the
/// discriminant `b^2 - a c` however it was computed.
#[inline(always)]
fn roots(a: f64, b: f64, c: f64, discriminant: f64) -> Option<(f64, f64)> {
    if !(discriminant >= 0.0) {
        return None;
    }
    let q = b + discriminant.sqrt().copysign(b);
    let (t0, t1) = if q == 0.0 { (0.0, 0.0) } else { (c / q, q / a) };
    Some(if t0 < t1 { (t0, t1) } else { (t1, t0) })
}

#[inline(always)]
fn within(t: f64, t_max: f32) -> bool {
    let rounded = t as f32;
    rounded > 0.0 && rounded < t_max
}

impl Sphere {
    /// The box around it.
    pub fn bounds(&self) -> Aabb {
        round_up((self.center - self.radius, self.center + self.radius))
    }

    /// Area, m^2.
    pub fn area(&self) -> f64 {
        4.0 * PI * self.radius * self.radius
    }

    /// The first distance in (0, t_max) at which the ray meets the sphere.
    #[inline(always)]
    pub fn meet(&self, ray: &Ray, t_max: f32) -> Option<f32> {
        let d = ray.direction.as_dvec3();
        let f = self.center - ray.origin.as_dvec3();
        let a = d.length_squared();
        let b = f.dot(d);
        let r2 = self.radius * self.radius;
        // The distance of the line from the centre, rather than b^2 - a c: exact to rounding for far spheres too.
        let discriminant = a * (r2 - (f - (b / a) * d).length_squared());
        let (t0, t1) = roots(a, b, f.length_squared() - r2, discriminant)?;
        [t0, t1].into_iter().find(|t| within(*t, t_max)).map(|t| t as f32)
    }

    /// The surface point in the direction `out` from the centre.
    pub fn point(&self, out: DVec3) -> Point {
        let n = out.try_normalize().unwrap_or(self.axes[2]);
        let [x, y, z] = self.axes.map(|a| a.dot(n));
        let [ex, ey, ez] = self.axes;
        let rho = (x * x + y * y).sqrt();
        let (cos, sin) = if rho > 0.0 { (x / rho, y / rho) } else { (1.0, 0.0) };
        Point {
            position: self.center + self.radius * n,
            normal: self.side * n,
            uv: DVec2::new(turn(x, y), f64::from(angle_of(z as f32, rho as f32)) / PI),
            dp_du: TAU * self.radius * (x * ey - y * ex),
            dp_dv: PI * self.radius * (z * (cos * ex + sin * ey) - rho * ez),
        }
    }
}

impl Disk {
    /// The box around it.
    pub fn bounds(&self) -> Aabb {
        let [x, y] = self.axes;
        let reach = (x * x + y * y).map(f64::sqrt);
        round_up((self.center - reach, self.center + reach))
    }

    /// Area, m^2.
    pub fn area(&self) -> f64 {
        PI * self.axes[0].cross(self.axes[1]).length()
    }

    /// The distance in (0, t_max) at which the ray meets the disk.
    #[inline(always)]
    pub fn meet(&self, ray: &Ray, t_max: f32) -> Option<f32> {
        let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        let t = (self.center - o).dot(self.normal) / d.dot(self.normal);
        let offset = o + t * d - self.center;
        let local = DVec2::new(self.dual[0].dot(offset), self.dual[1].dot(offset));
        (within(t, t_max) && local.length_squared() <= 1.0).then_some(t as f32)
    }

    /// The surface point of object coordinates `local`.
    pub fn point(&self, local: DVec2) -> Point {
        let r = local.length();
        let axis = if r > 0.0 { local / r } else { DVec2::X };
        let [ex, ey] = self.axes;
        Point {
            position: self.center + local.x * ex + local.y * ey,
            normal: self.normal,
            uv: DVec2::new(r, turn(local.x, local.y)),
            dp_du: axis.x * ex + axis.y * ey,
            dp_dv: TAU * (local.x * ey - local.y * ex),
        }
    }

    /// Object coordinates of the foot of `p` in the disk's plane.
    pub fn local(&self, p: DVec3) -> DVec2 {
        let offset = p - self.center;
        DVec2::new(self.dual[0].dot(offset), self.dual[1].dot(offset))
    }
}

impl Cylinder {
    /// The box around it.
    pub fn bounds(&self) -> Aabb {
        let [x, y, z] = self.axes;
        let reach = self.radius * (x * x + y * y).map(f64::sqrt);
        let end = self.base + self.length * z;
        round_up((self.base.min(end) - reach, self.base.max(end) + reach))
    }

    /// Area, m^2.
    pub fn area(&self) -> f64 {
        TAU * self.radius * self.length
    }

    /// The first distance in (0, t_max) at which the ray meets the tube.
    #[inline(always)]
    pub fn meet(&self, ray: &Ray, t_max: f32) -> Option<f32> {
        let axis = self.axes[2];
        let (o, d) = (self.base - ray.origin.as_dvec3(), ray.direction.as_dvec3());
        let across = |v: DVec3| v - axis.dot(v) * axis;
        let (f, e) = (across(o), across(d));
        let a = e.length_squared();
        let b = f.dot(e);
        let r2 = self.radius * self.radius;
        let discriminant = a * (r2 - (f - (b / a) * e).length_squared());
        let (t0, t1) = roots(a, b, f.length_squared() - r2, discriminant)?;
        let on_tube = |t: f64| (0.0..=self.length).contains(&(t * d - o).dot(axis));
        [t0, t1].into_iter().find(|t| within(*t, t_max) && on_tube(*t)).map(|t| t as f32)
    }

    /// The surface point at the angle of (x, y) and at `z` metres from the base.
    pub fn point(&self, x: f64, y: f64, z: f64) -> Point {
        let [ex, ey, ez] = self.axes;
        let r = (x * x + y * y).sqrt();
        let (cos, sin) = if r > 0.0 { (x / r, y / r) } else { (1.0, 0.0) };
        let out = cos * ex + sin * ey;
        Point {
            position: self.base + self.radius * out + z * ez,
            normal: self.side * out,
            uv: DVec2::new(turn(x, y), z / self.length),
            dp_du: TAU * self.radius * (cos * ey - sin * ex),
            dp_dv: self.length * ez,
        }
    }

    /// The surface point nearest to `p`.
    pub fn nearest(&self, p: DVec3) -> Point {
        let [x, y, z] = self.axes.map(|a| a.dot(p - self.base));
        self.point(x, y, z.clamp(0.0, self.length))
    }
}

impl Point {
    /// A point with that normal and nothing else.
    pub(super) fn facing(position: DVec3, normal: DVec3) -> Self {
        let normal = normal.normalize_or_zero();
        Self { position, normal, uv: DVec2::ZERO, dp_du: DVec3::ZERO, dp_dv: DVec3::ZERO }
    }

    /// Texture coordinates in single precision, still below 1 where they were.
    pub fn uv(&self) -> Vec2 {
        self.uv.as_vec2().min(Vec2::ONE)
    }
}
