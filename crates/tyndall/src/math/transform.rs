//! Affine and projective transforms of scene descriptions, and their compiled form.

use super::{Aabb, Vec3};
use glam::{Affine3A, DMat4, DVec3, DVec4, Mat3A};

/// A 4x4 matrix in double precision acting on column vectors.
///
/// Scene descriptions hold these; [`Affine`] is the compiled form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform(DMat4);

impl Default for Transform {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl Transform {
    /// Leaves everything where it is.
    pub const IDENTITY: Self = Self(DMat4::IDENTITY);

    /// From four rows.
    pub fn from_rows(rows: [[f64; 4]; 4]) -> Self {
        Self(DMat4::from_cols_array_2d(&rows).transpose())
    }

    /// The four rows.
    pub fn rows(&self) -> [[f64; 4]; 4] {
        self.0.transpose().to_cols_array_2d()
    }

    /// Moves by `offset` metres.
    pub fn translate(offset: [f64; 3]) -> Self {
        Self(DMat4::from_translation(DVec3::from_array(offset)))
    }

    /// Scales each axis.
    pub fn scale(factors: [f64; 3]) -> Self {
        Self(DMat4::from_scale(DVec3::from_array(factors)))
    }

    /// Rotates by `degrees` about `axis`, counter-clockwise when the axis points at the viewer. `None` for a zero axis.
    pub fn rotate(axis: [f64; 3], degrees: f64) -> Option<Self> {
        let axis = DVec3::from_array(axis).try_normalize()?;
        Some(Self(DMat4::from_axis_angle(axis, degrees.to_radians())))
    }

    /// Camera to world: the frame at `origin` whose +z looks at `target` and whose +x points left of the picture, as
    /// in Mitsuba. `None` when the directions are degenerate.
    pub fn look_at(origin: [f64; 3], target: [f64; 3], up: [f64; 3]) -> Option<Self> {
        let origin = DVec3::from_array(origin);
        let forward = (DVec3::from_array(target) - origin).try_normalize()?;
        let left = DVec3::from_array(up).cross(forward).try_normalize()?;
        let up = forward.cross(left);
        Some(Self(DMat4::from_cols(left.extend(0.0), up.extend(0.0), forward.extend(0.0), origin.extend(1.0))))
    }

    /// First `self`, then `next`.
    pub fn then(&self, next: &Transform) -> Self {
        Self(next.0 * self.0)
    }

    /// The inverse, if there is one.
    pub fn inverse(&self) -> Option<Self> {
        let determinant = self.0.determinant();
        if determinant == 0.0 || !determinant.is_finite() {
            return None;
        }
        let inverse = self.0.inverse();
        inverse.is_finite().then_some(Self(inverse))
    }

    /// Whether every entry is finite.
    pub fn is_finite(&self) -> bool {
        self.0.is_finite()
    }

    /// Whether the last row is (0, 0, 0, 1).
    pub fn is_affine(&self) -> bool {
        self.0.row(3) == DVec4::W
    }

    /// The transformed point, divided by its homogeneous coordinate.
    pub fn point(&self, p: [f64; 3]) -> [f64; 3] {
        self.0.project_point3(DVec3::from_array(p)).to_array()
    }

    /// The transformed vector (no translation).
    pub fn vector(&self, v: [f64; 3]) -> [f64; 3] {
        self.0.transform_vector3(DVec3::from_array(v)).to_array()
    }

    /// The compiled form. `None` when the transform is not affine, not finite or not invertible.
    pub fn compile(&self) -> Option<Affine> {
        if !self.is_affine() {
            return None;
        }
        let inverse = self.inverse()?;
        let forward = Affine3A::from_mat4(self.0.as_mat4());
        let inverse = Affine3A::from_mat4(inverse.0.as_mat4());
        (forward.is_finite() && inverse.is_finite()).then(|| Affine {
            forward,
            inverse,
            normal: inverse.matrix3.transpose(),
        })
    }
}

/// An invertible affine transform in single precision, with its inverse.
#[derive(Clone, Copy, Debug)]
pub struct Affine {
    forward: Affine3A,
    inverse: Affine3A,
    normal: Mat3A,
}

impl Affine {
    /// The transformed point.
    #[inline(always)]
    pub fn point(&self, p: Vec3) -> Vec3 {
        self.forward.transform_point3(p)
    }

    /// The transformed vector.
    #[inline(always)]
    pub fn vector(&self, v: Vec3) -> Vec3 {
        self.forward.transform_vector3(v)
    }

    /// The transformed normal (inverse transpose), not normalised.
    #[inline(always)]
    pub fn normal(&self, n: Vec3) -> Vec3 {
        self.normal * n
    }

    /// The point transformed back.
    #[inline(always)]
    pub fn inverse_point(&self, p: Vec3) -> Vec3 {
        self.inverse.transform_point3(p)
    }

    /// The vector transformed back.
    #[inline(always)]
    pub fn inverse_vector(&self, v: Vec3) -> Vec3 {
        self.inverse.transform_vector3(v)
    }

    /// The box around the transformed box.
    pub fn bounds(&self, bounds: Aabb) -> Aabb {
        Aabb::from_points(bounds.corners().map(|c| self.point(c)))
    }

    /// Whether the transform turns right-handed frames into left-handed ones.
    pub fn flips_handedness(&self) -> bool {
        self.forward.matrix3.determinant() < 0.0
    }

    /// The factor of a uniform scale with rotation or reflection; `None` when axes scale differently or shear.
    pub fn uniform_scale(&self) -> Option<f32> {
        let m = self.forward.matrix3;
        let s = m.x_axis.length();
        let near = |a: f32, b: f32| (a - b).abs() <= 1e-4 * s;
        let orthogonal = [m.x_axis.dot(m.y_axis), m.y_axis.dot(m.z_axis), m.z_axis.dot(m.x_axis)];
        (near(m.y_axis.length(), s) && near(m.z_axis.length(), s) && orthogonal.iter().all(|d| d.abs() <= 1e-4 * s * s))
            .then_some(s)
    }
}
