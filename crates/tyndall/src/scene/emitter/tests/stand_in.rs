//! Parallelograms and spheres.

use crate::math::{Aabb, Frame, PerArea, PerSolidAngle, Ray, Vec2, Vec3, warp};
use crate::scene::emitter::shapes::{EmissiveShapes, ShapePoint};
use crate::scene::shape::{Mesh, SurfacePoint};
use std::f32::consts::PI;

#[derive(Clone, Copy, Debug)]
pub enum Form {
    /// Corner and two edges; the normal is their cross product.
    Parallelogram(Vec3, Vec3, Vec3),
    /// Centre and radius.
    Sphere(Vec3, f32),
}

#[derive(Debug)]
pub struct StandIn(pub Vec<Form>);

fn at(position: Vec3, normal: Vec3, uv: Vec2) -> ShapePoint {
    ShapePoint { position, normal, uv, triangle: 0, barycentrics: Vec2::ZERO }
}

impl EmissiveShapes for StandIn {
    fn mesh(&self, _: u32) -> Option<&Mesh> {
        None
    }

    fn area(&self, shape: u32) -> f32 {
        match self.0[shape as usize] {
            Form::Parallelogram(_, a, b) => a.cross(b).length(),
            Form::Sphere(_, r) => 4.0 * PI * r * r,
        }
    }

    fn bounds(&self, shape: u32) -> Aabb {
        match self.0[shape as usize] {
            Form::Parallelogram(p, a, b) => Aabb::from_points([p, p + a, p + b, p + a + b]),
            Form::Sphere(c, r) => Aabb { min: c - r, max: c + r },
        }
    }

    fn normals(&self, shape: u32) -> (Vec3, f32) {
        match self.0[shape as usize] {
            Form::Parallelogram(_, a, b) => (a.cross(b).normalize(), 0.0),
            Form::Sphere(..) => (Vec3::Z, PI),
        }
    }

    fn sample_area(&self, shape: u32, u: Vec2) -> (ShapePoint, PerArea) {
        let density = PerArea(1.0 / self.area(shape));
        match self.0[shape as usize] {
            Form::Parallelogram(p, a, b) => (at(p + a * u.x + b * u.y, a.cross(b).normalize(), u), density),
            Form::Sphere(c, r) => {
                let normal = warp::square_to_sphere(u);
                (at(c + normal * r, normal, u), density)
            }
        }
    }

    fn sample_from(&self, shape: u32, from: Vec3, u: Vec2) -> Option<(ShapePoint, PerSolidAngle)> {
        match self.0[shape as usize] {
            Form::Sphere(c, r) if from.distance(c) > r => {
                let cos_max = (1.0 - (r / from.distance(c)).powi(2)).sqrt();
                let d = Frame::from_normal((c - from).normalize()).to_world(warp::square_to_cone(u, cos_max));
                let along = (c - from).dot(d);
                let half_chord = (r * r - (c - from - along * d).length_squared()).max(0.0).sqrt();
                let position = from + (along - half_chord) * d;
                Some((at(position, (position - c) / r, u), warp::cone_pdf(cos_max)))
            }
            _ => {
                let (point, _) = self.sample_area(shape, u);
                Some((point, self.pdf_from(shape, from, point.position, point.normal)))
            }
        }
    }

    fn pdf_from(&self, shape: u32, from: Vec3, position: Vec3, normal: Vec3) -> PerSolidAngle {
        match self.0[shape as usize] {
            Form::Sphere(c, r) if from.distance(c) > r => warp::cone_pdf((1.0 - (r / from.distance(c)).powi(2)).sqrt()),
            _ => {
                let to = position - from;
                PerArea(1.0 / self.area(shape)).to_solid_angle(to.length(), to.normalize().dot(normal))
            }
        }
    }
}

impl StandIn {
    /// The shapes that `ray` meets, each once, not sorted.
    pub fn hits(&self, ray: &Ray) -> impl Iterator<Item = SurfacePoint> {
        (0..).zip(&self.0).filter_map(|(shape, form)| {
            let (position, normal) = match *form {
                Form::Parallelogram(p, a, b) => {
                    let n = a.cross(b);
                    let t = (p - ray.origin).dot(n) / ray.direction.dot(n);
                    let inside = ray.at(t) - p;
                    let u = inside.cross(b).dot(n) / n.length_squared();
                    let v = a.cross(inside).dot(n) / n.length_squared();
                    let hit = t > 0.0 && u >= 0.0 && v >= 0.0 && u <= 1.0 && v <= 1.0;
                    hit.then_some((ray.at(t), n.normalize()))?
                }
                Form::Sphere(c, r) => {
                    let along = (c - ray.origin).dot(ray.direction);
                    let h2 = r * r - (c - ray.origin - along * ray.direction).length_squared();
                    let (near, far) = (along - h2.max(0.0).sqrt(), along + h2.max(0.0).sqrt());
                    let t = if near > 0.0 { near } else { far };
                    (h2 >= 0.0 && t > 0.0).then(|| (ray.at(t), (ray.at(t) - c) / r))?
                }
            };
            Some(surface(shape, position, normal))
        })
    }
}

/// A point of a shape without texture coordinates.
pub fn surface(shape: u32, position: Vec3, normal: Vec3) -> SurfacePoint {
    SurfacePoint {
        position,
        normal,
        shading: Frame::from_normal(normal),
        uv: Vec2::ZERO,
        dp_du: Vec3::X,
        dp_dv: Vec3::Y,
        shape,
        triangle: 0,
        barycentrics: Vec2::ZERO,
        epsilon: 1e-5,
    }
}
