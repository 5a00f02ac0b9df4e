//! Bounds of what a set of emitters can send: the currency of the light tree.

use crate::math::angle::angle_of;
use crate::math::{Aabb, Ray, Vec3};
use std::f32::consts::PI;

/// Smallest share of a group's intensity that a point in its penumbra is granted.
const PENUMBRA: f32 = 1e-3;
/// Slack of the test whether a point lies outside the cone of emission, as a cosine: covers rounding.
const SLACK: f32 = 1e-4;
/// Smallest squared distance, m^2: keeps the importance finite at a point light.
const NEAR: f32 = 1e-12;

/// Where a group of finite emitters is, which way it faces and how bright it is (Conty Estevez and Kulla 2018, section 4).
#[derive(Clone, Copy, Debug)]
pub struct LightBound {
    /// Box around all points that emit.
    pub bounds: Aabb,
    /// Sum of the largest radiant intensities times sampling weights, W/sr.
    pub intensity: f32,
    /// Axis of the cone of normals, a unit vector.
    pub axis: Vec3,
    /// Half angle of the cone of normals, radians; pi for all directions.
    pub theta_o: f32,
    /// Largest angle between a normal and the light that leaves there, radians.
    pub theta_e: f32,
}

impl LightBound {
    /// A point that sends light everywhere.
    pub fn omnidirectional(position: Vec3, intensity: f32) -> Self {
        Self { bounds: Aabb { min: position, max: position }, intensity, axis: Vec3::Z, theta_o: PI, theta_e: 0.0 }
    }

    /// The bound of both groups.
    pub fn union(&self, other: &Self) -> Self {
        let (axis, theta_o) = cone_union((self.axis, self.theta_o), (other.axis, other.theta_o));
        Self {
            bounds: self.bounds.union(other.bounds),
            intensity: self.intensity + other.intensity,
            axis,
            theta_o,
            theta_e: self.theta_e.max(other.theta_e),
        }
    }

    /// Solid-angle measure of the directions that the group lights, weighted by the cosine beyond the normals (Conty
    /// Estevez and Kulla 2018, equation 1).
    pub fn orientation_measure(&self) -> f32 {
        let (o, w) = (self.theta_o, (self.theta_o + self.theta_e).min(PI));
        let (sin_o, cos_o) = o.sin_cos();
        2.0 * PI * (1.0 - cos_o) + 0.5 * PI * (2.0 * w * sin_o - (o - 2.0 * w).cos() - 2.0 * o * sin_o + cos_o)
    }
}

/// The cone around two cones, each an axis and a half angle.
pub fn cone_union(a: (Vec3, f32), b: (Vec3, f32)) -> (Vec3, f32) {
    let (wide, narrow) = if a.1 >= b.1 { (a, b) } else { (b, a) };
    let between = angle_between(wide.0, narrow.0);
    if (between + narrow.1).min(PI) <= wide.1 {
        return wide;
    }
    let theta = 0.5 * (wide.1 + between + narrow.1);
    let pivot = wide.0.cross(narrow.0);
    if theta >= PI || !(pivot.length_squared() > 1e-12) {
        return (wide.0, PI);
    }
    let (sin, cos) = (theta - wide.1).sin_cos();
    let axis = wide.0 * cos + pivot.normalize().cross(wide.0) * sin;
    (axis.normalize(), theta)
}

/// Angle between two unit vectors, radians, accurate near 0 and pi.
pub fn angle_between(a: Vec3, b: Vec3) -> f32 {
    2.0 * (a - b).length().atan2((a + b).length())
}

/// A [`LightBound`] compiled for evaluation.
#[derive(Clone, Copy, Debug)]
pub struct Importance {
    centre: Vec3,
    /// Squared radius of the sphere around the box, m^2.
    radius2: f32,
    axis: Vec3,
    intensity: f32,
    cos_o: f32,
    sin_o: f32,
    cos_e: f32,
}

impl From<&LightBound> for Importance {
    fn from(bound: &LightBound) -> Self {
        let (sin_o, cos_o) = bound.theta_o.sin_cos();
        Self {
            centre: bound.bounds.centre(),
            radius2: bound.bounds.extent().length_squared() * 0.25,
            axis: bound.axis,
            intensity: bound.intensity,
            cos_o,
            sin_o,
            cos_e: bound.theta_e.cos(),
        }
    }
}

impl Importance {
    /// Estimate of the fluence that the group causes at `x`: intensity, cosine and inverse square of the distance. Zero
    /// only where no emitter of the group can send light.
    #[inline]
    pub fn at_point(&self, x: Vec3) -> f32 {
        let to_x = x - self.centre;
        let d2 = to_x.length_squared();
        if d2 <= self.radius2.max(NEAR) {
            return self.intensity / self.radius2.max(NEAR);
        }
        let cos = self.axis.dot(to_x) / d2.sqrt();
        self.intensity * self.facing(cos, d2) / d2
    }

    /// Estimate of the fluence integrated along `ray` over `[0, t_max]`, for a finite `t_max`: the inverse square integrates
    /// to an angle over the distance of the line (Kulla and Fajardo 2012). Zero only where no emitter of the group can
    /// send light.
    #[inline]
    pub fn along_segment(&self, ray: &Ray, t_max: f32) -> f32 {
        let to_centre = self.centre - ray.origin;
        let delta = to_centre.dot(ray.direction);
        let line2 = (to_centre - ray.direction * delta).length_squared();
        let height2 = line2.max(self.radius2).max(NEAR);
        let height = height2.sqrt();
        let angle = angle_of(height2 - delta * (t_max - delta), height * t_max);
        let t_near = delta.clamp(0.0, t_max);
        let near2 = line2 + (t_near - delta) * (t_near - delta);
        if near2 <= self.radius2.max(NEAR) {
            return self.intensity * angle / height;
        }
        // The largest cosine to the axis over the arc of directions from the centre to the segment: at an end, or where
        // the arc passes the axis, which it does when the cosine rises at the start and falls at the end.
        // The start is not at the centre: it would have been near.
        let start = -to_centre * to_centre.length_recip();
        let end = (ray.at(t_max) - self.centre).normalize_or_zero();
        let across = (end - start * start.dot(end)).normalize_or_zero();
        let (a, b) = (self.axis.dot(start), self.axis.dot(across));
        let passes = b > 0.0 && b * start.dot(end) < a * across.dot(end);
        let cos = if passes { (a * a + b * b).sqrt() } else { a.max(self.axis.dot(end)) };
        self.intensity * self.facing(cos, near2) * angle / height
    }

    /// Bound of the cosine at which a receiver is seen, at squared distance `d2` outside the sphere, when the direction to
    /// it makes an angle of cosine `cos` with the axis. Zero outside the cone of emission.
    #[inline(always)]
    fn facing(&self, cos: f32, d2: f32) -> f32 {
        let sin = (1.0 - cos * cos).max(0.0).sqrt();
        let (cos_o, sin_o) = (self.cos_o, self.sin_o);
        let sin2_u = self.radius2 / d2;
        let (sin_u, cos_u) = (sin2_u.sqrt(), (1.0 - sin2_u).max(0.0).sqrt());
        let (cos, sin) = subtract_angles(cos, sin, cos_o, sin_o);
        let (cos, _) = subtract_angles(cos, sin, cos_u, sin_u);
        if cos < self.cos_e - SLACK { 0.0 } else { cos.max(PENUMBRA) }
    }
}

/// Cosine and sine of `max(a - b, 0)` for two angles in [0, pi].
#[inline(always)]
fn subtract_angles(cos_a: f32, sin_a: f32, cos_b: f32, sin_b: f32) -> (f32, f32) {
    if cos_a >= cos_b { (1.0, 0.0) } else { (cos_a * cos_b + sin_a * sin_b, sin_a * cos_b - cos_a * sin_b) }
}
