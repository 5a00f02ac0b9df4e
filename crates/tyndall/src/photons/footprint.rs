//! Photon differentials: the footprint that a light path shares with its neighbours.

use super::Width;
use crate::math::{Frame, PerSolidAngle, Vec3};
use crate::scene::emitter::Emission;
use crate::scene::shape::{Geometry, SurfacePoint};
use std::f32::consts::PI;

/// Where two neighbours of a path are and whither they go, relative to it (Igehy 1999; Schjoth et al. 2007): half the axes
/// of an ellipse.
#[derive(Clone, Copy, Debug, Default)]
pub struct Footprint {
    /// Offsets of the position, metres.
    position: [Vec3; 2],
    /// Offsets of the unit direction.
    direction: [Vec3; 2],
}

/// Half the axes of a disc of given area across a direction.
fn disc(across: &Frame, area: f32) -> [Vec3; 2] {
    let radius = (area / PI).sqrt();
    [across.s * radius, across.t * radius]
}

impl Footprint {
    /// Of one of `paths` paths: each gets its share of the emitter's area, of its directions, or of both, the square root
    /// of the number for each.
    pub fn emitted(emission: &Emission, paths: u32) -> Self {
        let paths = paths as f32 * emission.selection;
        let both = !emission.delta_position && !emission.delta_direction;
        let share = if both { paths.sqrt() } else { paths };
        let across = Frame::from_normal(emission.ray.direction);
        let mut footprint = Self::default();
        if !emission.delta_position {
            let on = if emission.normal == Vec3::ZERO { across } else { Frame::from_normal(emission.normal) };
            footprint.position = disc(&on, 1.0 / (share * emission.position_density.0));
        }
        if !emission.delta_direction {
            footprint.direction = disc(&across, (1.0 / (share * emission.direction_density.0)).min(PI));
        }
        footprint
    }

    /// The width of a beam that starts here.
    pub fn width(&self) -> Width {
        Width { start: self.position, slope: self.direction }
    }

    /// After `length` metres.
    pub fn travel(&mut self, length: f32) {
        for (position, direction) in self.position.iter_mut().zip(self.direction) {
            *position += length * direction;
        }
    }

    /// From a collision in a medium, or from a rough surface, into a direction of density `pdf`: where the neighbours are
    /// stays, and the directions are shared out anew among `paths`.
    pub fn scatter(&mut self, direction: Vec3, pdf: PerSolidAngle, paths: u32) {
        let area = (1.0 / (paths as f32 * pdf.0)).min(PI);
        self.direction = disc(&Frame::from_normal(direction), area);
    }

    /// At a smooth surface, from direction `d_in` to `d_out`; `eta` is the index of the side entered divided by that of the
    /// side left, 1 for reflection (Igehy 1999, eqs. 10-17).
    pub fn bounce(&mut self, geometry: &Geometry, point: &SurfacePoint, d_in: Vec3, d_out: Vec3, eta: f32) {
        let n = point.shading.n;
        let side = if d_in.dot(n) > 0.0 { -1.0 } else { 1.0 };
        let n = n * side;
        let (cos_in, cos_out) = (d_in.dot(n), d_out.dot(n));
        if cos_in.abs() < 1e-4 || cos_out.abs() < 1e-4 {
            return;
        }
        let reflected = cos_out > 0.0;
        let ratio = 1.0 / eta;
        for (position, direction) in self.position.iter_mut().zip(&mut self.direction) {
            // Where the neighbour meets the tangent plane.
            *position -= d_in * (position.dot(n) / cos_in);
            let dn = geometry.normal_change(point, *position) * side;
            let change = direction.dot(n) + d_in.dot(dn);
            *direction = if reflected {
                *direction - 2.0 * (cos_in * dn + change * n)
            } else {
                let mu = ratio * cos_in - cos_out;
                let dmu = (ratio - ratio * ratio * cos_in / cos_out) * change;
                ratio * *direction - (mu * dn + dmu * n)
            };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SceneDesc;
    use crate::math::Ray;
    use crate::scene::Scene;
    use crate::scene::desc::{GeometryDesc, ShapeDesc};

    /// A ray through a glass ball, followed by hand: reflected or refracted twice.
    fn follow(scene: &Scene, ray: Ray, mut each: impl FnMut(&SurfacePoint, f32, Vec3, Vec3, f32)) -> Ray {
        let mut ray = ray;
        for eta in [1.5, 1.0 / 1.5] {
            let hit = scene.geometry.intersect(&ray, f32::INFINITY).unwrap();
            let point = scene.geometry.surface(&ray, &hit);
            let n = if ray.direction.dot(point.normal) > 0.0 { -point.normal } else { point.normal };
            let cos = -ray.direction.dot(n);
            let cos_out = (1.0 - (1.0 - cos * cos) / (eta * eta)).sqrt();
            let out = (ray.direction / eta + (cos / eta - cos_out) * n).normalize();
            each(&point, hit.t, ray.direction, out, eta);
            ray = Ray { origin: point.leave(out), direction: out };
        }
        ray
    }

    #[test]
    fn neighbours_are_where_the_footprint_says() {
        let mut desc = SceneDesc::default();
        desc.shapes.push(ShapeDesc::new("ball", GeometryDesc::Sphere { center: [0.0; 3], radius: 1.0 }));
        let scene = Scene::build(&desc).unwrap();
        let origin = Vec3::new(0.3, 0.2, -4.0);
        let direction = Vec3::new(0.02, 0.05, 1.0).normalize();
        let across = Frame::from_normal(direction);
        let step = 1e-2;
        let mut footprint = Footprint { position: [Vec3::ZERO; 2], direction: [across.s * step, across.t * step] };
        let end = follow(&scene, Ray { origin, direction }, |point, t, d_in, d_out, eta| {
            footprint.travel(t);
            footprint.bounce(&scene.geometry, point, d_in, d_out, eta);
        });
        footprint.travel(2.0);
        for (i, axis) in [across.s, across.t].into_iter().enumerate() {
            let at = |sign: f32| {
                let d = (direction + sign * step * axis).normalize();
                let ray = follow(&scene, Ray { origin, direction: d }, |_, _, _, _, _| ());
                // Where it meets the plane across the central ray.
                let plane = end.at(2.0);
                ray.at((plane - ray.origin).dot(end.direction) / ray.direction.dot(end.direction))
            };
            let measured = 0.5 * (at(1.0) - at(-1.0));
            let predicted = footprint.position[i] - end.direction * end.direction.dot(footprint.position[i]);
            let error = (measured - predicted).length() / measured.length();
            assert!(error < 0.01, "axis {i}: {measured} measured, {predicted} predicted");
        }
    }
}
