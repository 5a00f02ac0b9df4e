//! Specular microflakes (Heitz, Dupuy, Crassin and Dachsbacher 2015, "The SGGX Microflake Distribution").
//!
//! The flakes' normals are those of an ellipsoid with projected area `sigma(d) = sqrt(d^T S d)`. With `S = L L^T` the
//! ellipsoid is the unit sphere seen through L: normals are `L y` of sphere points y, and a flake is seen from w in
//! proportion to the cosine between y and `L^T w`.

use super::PhaseError;
use crate::math::{Frame, PerSolidAngle, Vec2, Vec3, warp};
use crate::scene::desc::VolumeDesc;
use crate::scene::medium::{Grid, Voxel};
use glam::Vec3A;
use std::f32::consts::FRAC_1_PI;
use std::ops::{Add, Mul};

/// Microflakes that mirror, with matrices S in world space that vary over a grid.
#[derive(Clone, Debug)]
pub struct Sggx {
    field: Field,
    /// Square root of the largest eigenvalue anywhere.
    max_area: f32,
    /// Upper bound of the value anywhere, 1/sr.
    ceiling: f32,
}

#[derive(Clone, Debug)]
enum Field {
    Same(Matrix),
    Varying(Box<Grid<Matrix>>),
}

impl Sggx {
    /// Flakes from a grid with the six channels xx, yy, zz, xy, xz, yz.
    pub fn new(matrix: &VolumeDesc) -> Result<Self, PhaseError> {
        let VolumeDesc::Grid { grid, to_world, filter, wrap } = matrix else { return Err(PhaseError::MatrixConstant) };
        let compiled = Grid::compile(grid, to_world, *filter, *wrap, Matrix::from_channels)?;
        let mut max_eigenvalue = 0.0_f64;
        let (mut min_eigenvalue, mut min_determinant) = (f64::INFINITY, f64::INFINITY);
        for (i, values) in grid.values.chunks_exact(6).enumerate() {
            let values: [f32; 6] = std::array::from_fn(|c| values[c]);
            if !is_positive_definite(values.map(f64::from)) {
                let [nx, ny, _] = grid.size;
                return Err(PhaseError::MatrixSingular { voxel: [i % nx, i / nx % ny, i / nx / ny], matrix: values });
            }
            let matrix = values.map(f64::from);
            max_eigenvalue = max_eigenvalue.max(largest_eigenvalue(matrix));
            min_eigenvalue = min_eigenvalue.min(-largest_eigenvalue(matrix.map(|x| -x)));
            min_determinant = min_determinant.min(determinant(matrix));
        }
        // Of mixtures, the largest eigenvalue is at most that of the parts, the least and the determinant at least.
        let ceiling = 0.25 * std::f64::consts::FRAC_1_PI * max_eigenvalue * max_eigenvalue
            / (min_determinant.max(0.0) * min_eigenvalue.max(0.0)).sqrt();
        let first = Matrix::from_channels(&grid.values[..6]);
        let same = grid.values.chunks_exact(6).all(|v| v == &grid.values[..6]);
        Ok(Self {
            field: if same { Field::Same(first) } else { Field::Varying(Box::new(compiled)) },
            max_area: (max_eigenvalue.sqrt() * (1.0 + 1e-6)) as f32,
            ceiling: (ceiling * (1.0 + 1e-4)) as f32,
        })
    }

    #[inline]
    fn matrix(&self, x: Vec3) -> Matrix {
        match &self.field {
            Field::Same(matrix) => *matrix,
            Field::Varying(grid) => grid.at(x),
        }
    }

    /// Projected area of the flakes at `x` along `d`, relative to their number density.
    #[inline]
    pub fn projected_area(&self, x: Vec3, d: Vec3) -> f32 {
        self.matrix(x).projected_area(d)
    }

    /// Upper bound of the projected area along `d` anywhere.
    #[inline]
    pub fn max_projected_area(&self, d: Vec3) -> f32 {
        match &self.field {
            Field::Same(matrix) => matrix.projected_area(d),
            Field::Varying(_) => self.max_area,
        }
    }

    /// Upper bound of the value for all directions anywhere, 1/sr: infinite where the flakes are too flat to tell.
    pub fn ceiling(&self) -> f32 {
        self.ceiling
    }

    /// Value, 1/sr: `D(h) / (4 sigma(d_in))` with the half vector h.
    pub fn eval(&self, x: Vec3, d_in: Vec3, d_out: Vec3) -> f32 {
        let root = self.matrix(x).root();
        let h = d_out - d_in;
        let length_squared = h.length_squared();
        if length_squared == 0.0 {
            // Straight on no half vector exists; this is a single direction.
            return 0.0;
        }
        root.value(d_in, length_squared / root.solve(h).length_squared())
    }

    /// A direction with the density of the value: a visible flake mirrors the light.
    pub fn sample(&self, x: Vec3, d_in: Vec3, u: Vec2) -> (Vec3, PerSolidAngle) {
        let root = self.matrix(x).root();
        let towards = -d_in;
        let axis = root.apply_transposed(towards).normalize();
        let n = root.apply(Frame::from_normal(axis).to_world(warp::square_to_cosine_hemisphere(u)));
        let length_squared = n.length_squared();
        let d_out = ((2.0 * n.dot(towards) / length_squared) * n - towards).normalize();
        (d_out, PerSolidAngle(root.value(d_in, length_squared)))
    }
}

/// A symmetric matrix: the diagonal and (xy, xz, yz).
#[derive(Clone, Copy, Debug)]
struct Matrix {
    diagonal: Vec3A,
    rest: Vec3A,
}

impl Matrix {
    fn from_channels(values: &[f32]) -> Self {
        Self {
            diagonal: Vec3A::new(values[0], values[1], values[2]),
            rest: Vec3A::new(values[3], values[4], values[5]),
        }
    }

    #[inline]
    fn projected_area(&self, d: Vec3) -> f32 {
        let squares = self.diagonal.dot(Vec3A::from(d * d));
        let products = self.rest.dot(Vec3A::new(d.x * d.y, d.x * d.z, d.y * d.z));
        (squares + 2.0 * products).max(0.0).sqrt()
    }

    /// The lower triangular L with `L L^T = S` (Cholesky). Voxels are positive definite, so mixtures of them are.
    #[inline]
    fn root(&self) -> Root {
        let [xx, yy, zz] = self.diagonal.to_array();
        let [xy, xz, yz] = self.rest.to_array();
        let l_xx = xx.sqrt();
        let l_yx = xy / l_xx;
        let l_zx = xz / l_xx;
        let l_yy = (yy - l_yx * l_yx).max(f32::MIN_POSITIVE).sqrt();
        let l_zy = (yz - l_zx * l_yx) / l_yy;
        let l_zz = (zz - l_zx * l_zx - l_zy * l_zy).max(f32::MIN_POSITIVE).sqrt();
        Root { xx: l_xx, yx: l_yx, zx: l_zx, yy: l_yy, zy: l_zy, zz: l_zz }
    }
}

impl Add for Matrix {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { diagonal: self.diagonal + other.diagonal, rest: self.rest + other.rest }
    }
}

impl Mul<f32> for Matrix {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: f32) -> Self {
        Self { diagonal: self.diagonal * factor, rest: self.rest * factor }
    }
}

impl Voxel for Matrix {
    const CHANNELS: usize = 6;
}

/// A lower triangular matrix L.
struct Root {
    xx: f32,
    yx: f32,
    zx: f32,
    yy: f32,
    zy: f32,
    zz: f32,
}

impl Root {
    #[inline]
    fn apply(&self, v: Vec3) -> Vec3 {
        Vec3::new(self.xx * v.x, self.yx * v.x + self.yy * v.y, self.zx * v.x + self.zy * v.y + self.zz * v.z)
    }

    #[inline]
    fn apply_transposed(&self, v: Vec3) -> Vec3 {
        Vec3::new(self.xx * v.x + self.yx * v.y + self.zx * v.z, self.yy * v.y + self.zy * v.z, self.zz * v.z)
    }

    /// The v with `L v = w`.
    #[inline]
    fn solve(&self, w: Vec3) -> Vec3 {
        let x = w.x / self.xx;
        let y = (w.y - self.yx * x) / self.yy;
        Vec3::new(x, y, (w.z - self.zx * x - self.zy * y) / self.zz)
    }

    /// Value of the phase function where `1 / (h^T S^-1 h)` is `stretch`, h being the unit half vector.
    #[inline]
    fn value(&self, d_in: Vec3, stretch: f32) -> f32 {
        let area = self.apply_transposed(d_in).length();
        0.25 * FRAC_1_PI * stretch * stretch / (self.xx * self.yy * self.zz * area)
    }
}

/// Whether xx, yy, zz, xy, xz, yz are positive definite by a margin that single precision can tell from singular.
fn is_positive_definite([xx, yy, zz, xy, xz, yz]: [f64; 6]) -> bool {
    let tiny = 1e-6 * xx.max(yy).max(zz);
    let pivot_y = yy - xy * xy / xx;
    let pivot_z = zz - xz * xz / xx - (yz - xz * xy / xx).powi(2) / pivot_y;
    xx > tiny && pivot_y > tiny && pivot_z > tiny
}

/// The determinant of xx, yy, zz, xy, xz, yz.
fn determinant([xx, yy, zz, xy, xz, yz]: [f64; 6]) -> f64 {
    xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz)
}

/// The largest eigenvalue of a symmetric matrix (Smith 1961, trigonometric solution of the cubic).
fn largest_eigenvalue([xx, yy, zz, xy, xz, yz]: [f64; 6]) -> f64 {
    let mean = (xx + yy + zz) / 3.0;
    let (a, b, c) = (xx - mean, yy - mean, zz - mean);
    let spread = ((a * a + b * b + c * c + 2.0 * (xy * xy + xz * xz + yz * yz)) / 6.0).sqrt();
    if spread == 0.0 {
        return mean;
    }
    let angle = (determinant([a, b, c, xy, xz, yz]) / (2.0 * spread.powi(3))).clamp(-1.0, 1.0).acos() / 3.0;
    mean + 2.0 * spread * angle.cos()
}
