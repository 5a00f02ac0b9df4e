//! Unit vectors in 32 bits (Meyer et al. 2010, octahedral map).

use super::Vec3;
use std::hint::select_unpredictable;

const STEPS: f32 = 32767.0;

/// A unit vector as two 16-bit coordinates on the unfolded octahedron; the angle is off by at most 6.5e-5 radians.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Octahedral(u32);

impl Octahedral {
    /// The nearest representable direction, or close to it.
    #[inline]
    pub fn new(v: Vec3) -> Self {
        let p = v / (v.x.abs() + v.y.abs() + v.z.abs());
        // Which half it is, nobody can predict.
        let (x, y) = select_unpredictable(p.z >= 0.0, (p.x, p.y), fold(p.x, p.y));
        // As `round`, which is a call on plain machines, but for the last digit before a half.
        let quantise = |c: f32| (c * STEPS + 0.5_f32.copysign(c)) as i16 as u16 as u32;
        Self(quantise(x) | quantise(y) << 16)
    }

    /// The unit vector.
    #[inline]
    pub fn unpack(self) -> Vec3 {
        let [x, y] = [self.0 as u16, (self.0 >> 16) as u16].map(|c| f32::from(c as i16) / STEPS);
        let z = 1.0 - x.abs() - y.abs();
        let (x, y) = if z >= 0.0 { (x, y) } else { fold(x, y) };
        Vec3::new(x, y, z).normalize()
    }
}

/// The lower half of the octahedron, folded out over the corners of the square.
#[inline]
fn fold(x: f32, y: f32) -> (f32, f32) {
    ((1.0 - y.abs()).copysign(x), (1.0 - x.abs()).copysign(y))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Rng, warp};

    #[test]
    fn the_angle_is_kept() {
        let axes = [Vec3::X, Vec3::Y, Vec3::Z].into_iter().flat_map(|a| [a, -a]);
        let random = (0..100_000).map(|i| warp::square_to_sphere(Rng::keyed(1, 2, i).vec2()));
        for v in axes.chain(random) {
            let back = Octahedral::new(v).unpack();
            assert!((back - v).length() < 6.5e-5 && (back.length() - 1.0).abs() < 1e-6, "{v} became {back}");
        }
    }
}
