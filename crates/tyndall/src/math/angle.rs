//! Angles.

use std::f32::consts::{FRAC_PI_2, PI};

/// Sine and cosine of an angle in [-pi/4, pi/4], to a unit in the last place (the series of Cephes, Moshier 1989).
#[inline(always)]
pub fn sin_cos_near_zero(x: f32) -> (f32, f32) {
    let square = x * x;
    let sin = x + x * square * (-1.666_665_5e-1 + square * (8.332_161e-3 - square * 1.951_529_6e-4));
    let rest = 4.166_664_6e-2 + square * (-1.388_731_6e-3 + square * 2.443_315_7e-5);
    (sin, 1.0 - 0.5 * square + square * square * rest)
}

/// Sine and cosine of `2 pi u` for `u` in [0, 1], to a unit in the last place.
#[inline(always)]
pub fn sin_cos_of_turn(u: f32) -> (f32, f32) {
    let quarter = (4.0 * u + 0.5) as u32;
    let (sin, cos) = sin_cos_near_zero((4.0 * u - quarter as f32) * FRAC_PI_2);
    // Swapped in odd quarters; the sine is negative in the quarters 2 and 3, the cosine in 1 and 2.
    let (sin, cos) = if quarter & 1 == 1 { (cos, sin) } else { (sin, cos) };
    let negate = |x: f32, by: u32| f32::from_bits(x.to_bits() ^ (by & 2) << 30);
    (negate(sin, quarter), negate(cos, quarter + 1))
}

/// Coefficients of `atan(r) / r` by powers of `r^2`, interpolated at the Chebyshev nodes of `r^2` in [0, 1].
const ARC: [f32; 9] = [
    1.0,
    -0.333_333_22,
    0.199_986_82,
    -0.142_570_45,
    0.108_657_59,
    -0.080_096_82,
    0.048_914_32,
    -0.020_026_747,
    0.003_866_738_9,
];

/// The angle of the vector (x, y), radians in [-pi, pi]: as `y.atan2(x)` to 4e-7, but without a call, for places where
/// many are needed. Zeros count as positive, whatever their sign.
#[inline(always)]
pub fn angle_of(x: f32, y: f32) -> f32 {
    let (a, b) = (y.abs(), x.abs());
    let (small, large) = if a < b { (a, b) } else { (b, a) };
    // Infinities may be equal, and so may zeros.
    let r = match small < large {
        true => small / large,
        false => f32::from(u8::from(large > 0.0)),
    };
    let square = r * r;
    let arc = r * ARC.iter().rev().fold(0.0, |sum, c| sum * square + c);
    let arc = if a > b { FRAC_PI_2 - arc } else { arc };
    let arc = if x < 0.0 { PI - arc } else { arc };
    if y < 0.0 { -arc } else { arc }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sines_and_cosines_agree_with_double_precision() {
        let worst = (0..=1_000_000_u32).map(|i| {
            let u = i as f32 * 1e-6;
            let ((sin, cos), truth) = (sin_cos_of_turn(u), (std::f64::consts::TAU * f64::from(u)).sin_cos());
            (f64::from(sin) - truth.0).abs().max((f64::from(cos) - truth.1).abs())
        });
        let worst = worst.fold(0.0, f64::max);
        assert!(worst < 1.2e-7, "{worst}");
    }

    #[test]
    fn agrees_with_double_precision() {
        let mut ends =
            vec![(0.0, 0.0), (1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0), (1e-30, 1e-30), (1e30, -1e-30)];
        ends.push((f32::INFINITY, f32::INFINITY));
        ends.push((-3.0, f32::INFINITY));
        let around = (0..1_000_000).map(|i| {
            let (sin, cos) = (i as f32 * 1e-5).sin_cos();
            (cos * (1.0 + i as f32), sin * (1.0 + i as f32))
        });
        for (x, y) in ends.into_iter().chain(around) {
            let truth = f64::from(y).atan2(f64::from(x));
            assert!((f64::from(angle_of(x, y)) - truth).abs() < 4e-7, "({x}, {y})");
        }
    }
}
