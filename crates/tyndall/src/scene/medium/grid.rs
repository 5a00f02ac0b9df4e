//! Look-ups in a grid of samples.

use super::VolumeError;
use crate::math::{Affine, Transform, Vec3};
use crate::scene::desc::{Filter, GridDesc, Wrap};
use std::ops::{Add, Mul};

/// What a grid stores.
pub trait Voxel: Copy + Add<Output = Self> + Mul<f32, Output = Self> {
    /// Numbers a voxel takes in a [`GridDesc`].
    const CHANNELS: usize;
}

impl Voxel for f32 {
    const CHANNELS: usize = 1;
}

impl Voxel for crate::Spectrum {
    const CHANNELS: usize = 3;
}

/// Most samples along an axis: positions in voxels keep three binary digits behind the point.
const MAX_SIZE: usize = 1 << 20;

/// Samples at `(i + 0.5) / n` of the unit cube, placed in the world.
///
/// The samples are stored with a border of one voxel that already obeys the wrap mode, so an interpolation never has to
/// ask where its neighbours are.
#[derive(Clone, Debug)]
pub struct Grid<T> {
    voxels: Vec<T>,
    /// Samples along x, y, z, without the border.
    size: Vec3,
    stride_y: usize,
    stride_z: usize,
    to_world: Affine,
    filter: Filter,
    wrap: Wrap,
}

impl<T: Voxel> Grid<T> {
    /// Checks a grid and copies it, each voxel through `read` (which gets [`Voxel::CHANNELS`] numbers).
    pub fn compile(
        desc: &GridDesc,
        to_world: &Transform,
        filter: Filter,
        wrap: Wrap,
        read: impl Fn(&[f32]) -> T,
    ) -> Result<Self, VolumeError> {
        let to_world = to_world.compile().ok_or(VolumeError::Transform)?;
        check(desc, T::CHANNELS)?;
        let [nx, ny, nz] = desc.size;
        let mut voxels = Vec::with_capacity((nx + 2) * (ny + 2) * (nz + 2));
        for z in 0..nz + 2 {
            let z = wrapped(z as i64 - 1, nz, wrap);
            for y in 0..ny + 2 {
                let first = (z * ny + wrapped(y as i64 - 1, ny, wrap)) * nx * T::CHANNELS;
                let row = &desc.values[first..first + nx * T::CHANNELS];
                let border = |x: i64| read(&row[wrapped(x, nx, wrap) * T::CHANNELS..][..T::CHANNELS]);
                voxels.push(border(-1));
                voxels.extend(row.chunks_exact(T::CHANNELS).map(&read));
                voxels.push(border(nx as i64));
            }
        }
        let (stride_y, stride_z) = (nx + 2, (nx + 2) * (ny + 2));
        let size = Vec3::new(nx as f32, ny as f32, nz as f32);
        Ok(Self { voxels, size, stride_y, stride_z, to_world, filter, wrap })
    }

    /// The value at a point of the world; beyond the unit cube the grid goes on by its wrap mode.
    #[inline]
    pub fn at(&self, x: Vec3) -> T {
        let local = self.to_world.inverse_point(x);
        let folded = match self.wrap {
            Wrap::Clamp => local,
            Wrap::Repeat => local - local.floor(),
            Wrap::Mirror => Vec3::ONE - (Vec3::ONE - (local - 2.0 * (0.5 * local).floor())).abs(),
        };
        // From here on every coordinate is in [0, n]; not-a-number falls to 0.
        let position = folded.max(Vec3::ZERO).min(Vec3::ONE) * self.size;
        match self.filter {
            Filter::Linear => self.linear(position),
            Filter::Nearest => self.nearest(position),
        }
    }

    #[inline(always)]
    fn linear(&self, position: Vec3) -> T {
        // Border included, voxel i has its centre at i, the smallest coordinate is 0.5 and the largest n + 0.5.
        let p = position + Vec3::splat(0.5);
        // SAFETY: `at` leaves coordinates in [0, n], n at most `MAX_SIZE`.
        let [x, y, z] = p.to_array().map(|p| unsafe { p.to_int_unchecked::<i32>() });
        let f = p - Vec3::new(x as f32, y as f32, z as f32);
        let first = z as usize * self.stride_z + y as usize * self.stride_y + x as usize;
        debug_assert!(first + self.stride_z + self.stride_y + 1 < self.voxels.len(), "a corner beyond the border");
        // SAFETY: each index is at most n, its neighbour at most n + 1, and the stored size is n + 2.
        let corner = |offset: usize| unsafe { *self.voxels.get_unchecked(first + offset) };
        let mix = |a: T, b: T, t: f32| a * (1.0 - t) + b * t;
        let row = |offset: usize| mix(corner(offset), corner(offset + 1), f.x);
        let layer = |offset: usize| mix(row(offset), row(offset + self.stride_y), f.y);
        mix(layer(0), layer(self.stride_z), f.z)
    }

    #[inline(always)]
    fn nearest(&self, position: Vec3) -> T {
        let p = position.min(self.size - Vec3::splat(0.5));
        let index = (p.z as usize + 1) * self.stride_z + (p.y as usize + 1) * self.stride_y + p.x as usize + 1;
        self.voxels[index]
    }

    /// Calls `visit` with every voxel that a look-up at a point of the unit cube's coordinates within `centre` +-
    /// `half` can depend on, rounding errors of `slack` voxels included.
    pub fn visit_support(&self, centre: Vec3, half: Vec3, slack: f32, mut visit: impl FnMut(T)) {
        let axis = |i: usize| {
            let n = self.size[i];
            let (low, high) = ((centre[i] - half[i]) * n - slack, (centre[i] + half[i]) * n + slack);
            let (first, last) = match self.filter {
                Filter::Linear => ((low - 0.5).floor() as i64, (high - 0.5).floor() as i64 + 1),
                Filter::Nearest => (low.floor() as i64, high.floor() as i64),
            };
            let n = n as usize;
            let (first, last) = match self.wrap {
                // Clamping keeps the order, so the ends are enough.
                Wrap::Clamp => (wrapped(first, n, Wrap::Clamp) as i64, wrapped(last, n, Wrap::Clamp) as i64),
                _ if last - first >= 2 * n as i64 => (0, n as i64 - 1),
                _ => (first, last),
            };
            (first..=last).map(move |i| wrapped(i, n, self.wrap))
        };
        let columns: Vec<usize> = axis(0).collect();
        for z in axis(2) {
            for y in axis(1) {
                let row = (z + 1) * self.stride_z + (y + 1) * self.stride_y + 1;
                columns.iter().for_each(|x| visit(self.voxels[row + x]));
            }
        }
    }

    /// Samples along x, y, z.
    pub fn size(&self) -> Vec3 {
        self.size
    }

    /// Unit cube to world.
    pub fn to_world(&self) -> &Affine {
        &self.to_world
    }
}

/// The index in `0..n` that stands for index `i`.
fn wrapped(i: i64, n: usize, wrap: Wrap) -> usize {
    let n = n as i64;
    let inside = match wrap {
        Wrap::Clamp => i.clamp(0, n - 1),
        Wrap::Repeat => i.rem_euclid(n),
        Wrap::Mirror => {
            let i = i.rem_euclid(2 * n);
            i.min(2 * n - 1 - i)
        }
    };
    inside as usize
}

fn check(desc: &GridDesc, channels: usize) -> Result<(), VolumeError> {
    let [nx, ny, nz] = desc.size;
    if desc.size.iter().any(|n| !(1..=MAX_SIZE).contains(n)) {
        return Err(VolumeError::Size(desc.size));
    }
    if desc.channels != channels {
        return Err(VolumeError::Channels { found: desc.channels, expected: channels });
    }
    let expected = nx.checked_mul(ny).and_then(|n| n.checked_mul(nz)).and_then(|n| n.checked_mul(channels));
    if expected != Some(desc.values.len()) {
        return Err(VolumeError::Length { found: desc.values.len(), size: desc.size, channels });
    }
    match desc.values.iter().position(|v| !v.is_finite()) {
        Some(index) => Err(VolumeError::NotFinite { index, value: desc.values[index] }),
        None => Ok(()),
    }
}
