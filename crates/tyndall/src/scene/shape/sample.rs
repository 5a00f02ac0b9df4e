//! Points on shapes, for emitters.

use super::geometry::rounding;
use super::quadric::{Point, Sphere};
use super::{Form, Geometry, Mesh};
use crate::math::random::more_bits;
use crate::math::{PerArea, PerSolidAngle, Vec2, Vec3, warp};
use glam::DVec3;
use std::f64::consts::TAU;
use std::hint::select_unpredictable;

/// A point on an emitting shape: what emission asks for, and no more.
#[derive(Clone, Copy, Debug)]
pub struct AreaPoint {
    /// Position, metres.
    pub position: Vec3,
    /// Unit geometric normal.
    pub normal: Vec3,
    /// Texture coordinates.
    pub uv: Vec2,
    /// Index of the triangle in its mesh; 0 for other shapes.
    pub triangle: u32,
    /// Barycentric coordinates of the second and third vertex of the triangle.
    pub barycentrics: Vec2,
}

/// A triangle of an emitting mesh.
#[derive(Debug)]
pub(super) struct Patch {
    corner: Vec3,
    /// From the first corner to the others, metres.
    edges: [Vec3; 2],
    /// Unit normal.
    normal: Vec3,
    /// Texture coordinates of the first corner, and from it to the others.
    uv: Vec2,
    uv_edges: [Vec2; 2],
}

impl Patch {
    pub(super) fn new(mesh: &Mesh, triangle: usize) -> Self {
        let [a, b, c] = mesh.corners(triangle);
        let (ab, ac) = (b - a, c - a);
        let normal = ab.cross(ac).try_normalize();
        let [ta, tb, tc] = match mesh.uvs.is_empty() {
            true => [Vec2::ZERO, Vec2::X, Vec2::Y],
            false => mesh.triangles[triangle].map(|i| mesh.uvs[i as usize]),
        };
        Self {
            corner: a,
            edges: [ab, ac],
            // Squares of tiny edges underflow in single precision.
            normal: normal.unwrap_or_else(|| ab.as_dvec3().cross(ac.as_dvec3()).normalize_or_zero().as_vec3()),
            uv: ta,
            uv_edges: [tb - ta, tc - ta],
        }
    }

    #[inline(always)]
    fn point(&self, triangle: u32, barycentrics: Vec2) -> AreaPoint {
        let Self { corner, edges: [ab, ac], normal, uv, uv_edges: [tab, tac] } = *self;
        AreaPoint {
            position: corner + barycentrics.x * ab + barycentrics.y * ac,
            normal,
            uv: uv + barycentrics.x * tab + barycentrics.y * tac,
            triangle,
            barycentrics,
        }
    }
}

impl From<Point> for AreaPoint {
    fn from(point: Point) -> Self {
        Self {
            position: point.position.as_vec3(),
            normal: point.normal.as_vec3(),
            uv: point.uv(),
            triangle: 0,
            barycentrics: Vec2::ZERO,
        }
    }
}

/// A direction towards a sphere.
#[derive(Clone, Copy, Debug)]
pub struct SphereSample {
    /// The point where the direction meets the sphere.
    pub point: AreaPoint,
    /// Unit direction.
    pub direction: Vec3,
    /// Distance to the point, metres.
    pub distance: f32,
    /// Density of the direction.
    pub pdf: PerSolidAngle,
}

/// Running sums of triangle areas, m^2.
pub(super) fn cumulative_areas(mesh: &Mesh) -> Vec<f64> {
    let mut sum = 0.0;
    (0..mesh.triangles.len())
        .map(|i| {
            sum += mesh.triangle_area(i);
            sum
        })
        .collect()
}

impl Geometry {
    /// Area of a shape, m^2. Zero for instances; members of groups are measured in their group's space.
    pub fn area(&self, shape: u32) -> f32 {
        self.shapes[shape as usize].area as f32
    }

    /// Density of [`Geometry::sample_area`]; zero for shapes without area.
    pub fn area_pdf(&self, shape: u32) -> PerArea {
        self.shapes[shape as usize].area_pdf
    }

    /// A point uniform over the area of a shape of the scene, with its density. `None` for instances, for meshes whose
    /// description has no emission, and for those without area.
    #[inline(always)]
    pub fn sample_area(&self, shape: u32, u: Vec2) -> Option<(AreaPoint, PerArea)> {
        let point = match self.form(shape) {
            Form::Mesh(_) => {
                let (triangle, u) = self.choose_triangle(shape, u)?;
                let patch = &self.shapes[shape as usize].patches[triangle as usize];
                patch.point(triangle, warp::square_to_triangle(u))
            }
            Form::Sphere(sphere) => sphere.point(sphere.axes_times(warp::square_to_sphere(u))).into(),
            Form::Disk(disk) => disk.point(warp::square_to_disk(u).as_dvec2()).into(),
            Form::Cylinder(cylinder) => {
                let (sin, cos) = (TAU * u.x as f64).sin_cos();
                cylinder.point(cos, sin, u.y as f64 * cylinder.length).into()
            }
            Form::Instance(_) => return None,
        };
        Some((point, self.area_pdf(shape)))
    }

    /// The start of a ray that leaves an emitting shape at `point`, moved off the surface to the side of the normal like
    /// [`SurfacePoint::leave`](super::SurfacePoint::leave).
    #[inline(always)]
    pub fn leave_emitter(&self, shape: u32, point: &AreaPoint) -> Vec3 {
        let mut position = point.position.as_dvec3();
        if let Form::Mesh(mesh) = self.form(shape) {
            position = mesh.meet(point.triangle, point.barycentrics, rounding(position)).0.position;
        }
        position.as_vec3() + rounding(position) as f32 * point.normal
    }

    /// A triangle of an emitting mesh with probability proportional to its area, and the number that is left of `u`.
    #[inline(always)]
    fn choose_triangle(&self, shape: u32, u: Vec2) -> Option<(u32, Vec2)> {
        let cumulative = &self.shapes[shape as usize].cumulative;
        let total = cumulative.last().copied().filter(|area| *area > 0.0)?;
        // 24 random bits are used up by the choice among many triangles.
        let x = if cumulative.len() > 64 { more_bits(u.x, u.y) } else { u.x as f64 };
        let x = x * total;
        let index = cumulative.partition_point(|sum| *sum <= x).min(cumulative.len() - 1);
        let below = select_unpredictable(index == 0, 0.0, cumulative[index.saturating_sub(1)]);
        let rest = ((x - below) / (cumulative[index] - below)).clamp(0.0, 1.0);
        Some((index as u32, Vec2::new(rest as f32, u.y)))
    }

    /// A direction uniform over the solid angle of a sphere seen from `from`. `None` for other shapes and when `from` is
    /// not outside the sphere.
    pub fn sample_sphere_solid_angle(&self, shape: u32, from: Vec3, u: Vec2) -> Option<SphereSample> {
        let Form::Sphere(sphere) = self.form(shape) else { return None };
        let cone = Cone::new(sphere, from)?;
        // Uniform in the cosine; 1 - cos rather than cos, which would be 1 for small spheres.
        let fall = u.x as f64 * cone.fall;
        let sin2 = (fall * (2.0 - fall)).max(0.0);
        let cos = 1.0 - fall;
        let frame = crate::math::Frame::from_normal(cone.axis.as_vec3());
        let (sin_phi, cos_phi) = (TAU * u.y as f64).sin_cos();
        let across = cos_phi * frame.s.as_dvec3() + sin_phi * frame.t.as_dvec3();
        let across = (across - across.dot(cone.axis) * cone.axis).normalize();
        let direction = cos * cone.axis + sin2.sqrt() * across;
        // The near end of the chord.
        let half_chord = (sphere.radius * sphere.radius - cone.distance * cone.distance * sin2).max(0.0).sqrt();
        let distance = cone.distance * cos - half_chord;
        let point = sphere.point(from.as_dvec3() + distance * direction - sphere.center);
        Some(SphereSample {
            point: point.into(),
            direction: direction.as_vec3(),
            distance: distance as f32,
            pdf: cone.pdf(),
        })
    }

    /// Density of [`Geometry::sample_sphere_solid_angle`] for every direction that meets the sphere; `None` where there
    /// is none.
    pub fn sphere_solid_angle_pdf(&self, shape: u32, from: Vec3) -> Option<PerSolidAngle> {
        let Form::Sphere(sphere) = self.form(shape) else { return None };
        Some(Cone::new(sphere, from)?.pdf())
    }
}

/// The cone of directions from a point to a sphere.
struct Cone {
    axis: DVec3,
    /// To the centre, metres.
    distance: f64,
    /// One minus the cosine of the half angle.
    fall: f64,
}

impl Cone {
    fn new(sphere: &Sphere, from: Vec3) -> Option<Self> {
        let offset = sphere.center - from.as_dvec3();
        let distance = offset.length();
        if !(distance > sphere.radius) {
            return None;
        }
        let sin2 = (sphere.radius / distance) * (sphere.radius / distance);
        Some(Self { axis: offset / distance, distance, fall: sin2 / (1.0 + (1.0 - sin2).sqrt()) })
    }

    fn pdf(&self) -> PerSolidAngle {
        PerSolidAngle((1.0 / (TAU * self.fall)) as f32)
    }
}

impl Sphere {
    fn axes_times(&self, v: Vec3) -> DVec3 {
        let DVec3 { x, y, z } = v.as_dvec3();
        x * self.axes[0] + y * self.axes[1] + z * self.axes[2]
    }
}
