//! Elementary functions over lanes, to a few units in the last place of `f32`.
//!
//! Made of operations that are exact at every level, so that they too give the same bits everywhere.

use super::lanes::Lanes;

/// The polynomial with these coefficients, the constant one first.
#[inline(always)]
fn polynomial<L: Lanes, const N: usize>(x: L, coefficients: [f32; N]) -> L {
    let mut sum = L::splat(coefficients[N - 1]);
    for i in (0..N - 1).rev() {
        sum = sum.mul(x).add(L::splat(coefficients[i]));
    }
    sum
}

/// `exp(x)`; beyond [-87, 88] the value there.
#[inline(always)]
pub fn exp<L: Lanes>(x: L) -> L {
    // ln 2 in two parts, of which the first times a whole number is exact.
    const HIGH: f32 = 0.693_359_4;
    const LOW: f32 = -2.121_944_4e-4;
    let x = x.max(L::splat(-87.0)).min(L::splat(88.0));
    let power = x.mul(L::splat(std::f32::consts::LOG2_E)).add(L::splat(0.5)).floor();
    let rest = x.sub(power.mul(L::splat(HIGH))).sub(power.mul(L::splat(LOW)));
    let series = polynomial(rest, [1.0, 1.0, 1.0 / 2.0, 1.0 / 6.0, 1.0 / 24.0, 1.0 / 120.0, 1.0 / 720.0, 1.0 / 5040.0]);
    series.mul(power.power_of_two())
}

/// `exp(x) - 1` for `x` not negative, up to 88, with a small relative error near zero too.
#[inline(always)]
pub fn exp_minus_one<L: Lanes>(x: L) -> L {
    let series = polynomial(x, [1.0, 1.0 / 2.0, 1.0 / 6.0, 1.0 / 24.0, 1.0 / 120.0, 1.0 / 720.0, 1.0 / 5040.0]);
    x.mul(series).select(x.lt(L::splat(0.5)), exp(x).sub(L::splat(1.0)))
}

/// `ln(1 + difference / least)` of `difference` not negative and `least` positive, both normal, with a small relative error
/// where the quotient is small too.
#[inline(always)]
pub fn ln_quotient<L: Lanes>(difference: L, least: L) -> L {
    let one = L::splat(1.0);
    let quotient = difference.add(least).div(least);
    let (mantissa, exponent) = quotient.mantissa_and_exponent();
    // Mantissas in [1/sqrt 2, sqrt 2] keep the series below short.
    let large = L::splat(std::f32::consts::SQRT_2).lt(mantissa);
    let mantissa = mantissa.mul(L::splat(0.5)).select(large, mantissa);
    let exponent = exponent.add(one).select(large, exponent);
    let by_mantissa = mantissa.sub(one).div(mantissa.add(one));
    let by_difference = difference.div(difference.add(least).add(least));
    let near = exponent.abs().lt(L::splat(0.5));
    let z = by_difference.select(near, by_mantissa);
    let series = polynomial(z.mul(z), [2.0, 2.0 / 3.0, 2.0 / 5.0, 2.0 / 7.0, 2.0 / 9.0]);
    z.mul(series).add(exponent.mul(L::splat(std::f32::consts::LN_2)))
}

/// Sine and cosine of angles in [0, pi].
#[inline(always)]
pub fn sin_cos<L: Lanes>(angle: L) -> (L, L) {
    // From the right angle: the sine is the cosine of the rest, the cosine less its sine. Half a turn in two parts.
    let rest = L::splat(std::f32::consts::FRAC_PI_2).sub(angle).add(L::splat(-4.371_139e-8));
    let square = rest.mul(rest);
    let sin = polynomial(
        square,
        [1.0, -1.0 / 2.0, 1.0 / 24.0, -1.0 / 720.0, 1.0 / 40320.0, -1.0 / 3_628_800.0, 1.0 / 479_001_600.0],
    );
    let cos = polynomial(
        square,
        [1.0, -1.0 / 6.0, 1.0 / 120.0, -1.0 / 5040.0, 1.0 / 362_880.0, -1.0 / 39_916_800.0, 1.0 / 6_227_020_800.0],
    );
    (sin, rest.mul(cos))
}

/// Sine and cosine of `u` whole turns, `u` in [0, 1].
#[inline(always)]
pub fn sin_cos_of_turn<L: Lanes>(u: L) -> (L, L) {
    let rest = L::splat(1.0).sub(u);
    let (sin, cos) = sin_cos(u.min(rest).mul(L::splat(std::f32::consts::TAU)));
    (L::splat(0.0).sub(sin).select(rest.lt(u), sin), cos)
}

/// The angle in [0, pi] of the point (`x`, `y`), `y` positive.
#[inline(always)]
pub fn angle<L: Lanes>(y: L, x: L) -> L {
    let one = L::splat(1.0);
    let (along, flat) = (x.abs(), y.lt(x.abs()));
    // The slope from the nearer axis, and from the diagonal if that is nearer: the series is short there.
    let slope = y.min(along).div(y.max(along));
    let far = L::splat(0.414_213_57).lt(slope);
    let z = slope.sub(one).div(slope.add(one)).select(far, slope);
    let square = z.mul(z);
    // The polynomial nearest to atan(z) / z, to 2e-8.
    let series = polynomial(square, [0.999_999_98, -0.333_327_97, 0.199_744_05, -0.138_514_78, 0.079_849_63]);
    let offset = L::splat(std::f32::consts::FRAC_PI_4).select(far, L::splat(0.0));
    let from_axis = z.mul(series).add(offset);
    let upright = L::splat(std::f32::consts::FRAC_PI_2).sub(from_axis);
    let first = from_axis.select(flat, upright);
    let left = x.lt(L::splat(0.0));
    L::splat(std::f32::consts::PI).sub(first).select(left, first)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::lanes::{Kernel, Level, Row, WIDTH};

    /// All functions of two rows.
    struct All(Row, Row);

    impl Kernel for All {
        type Output = [Row; 8];

        #[inline(always)]
        fn run<L: Lanes>(self) -> [Row; 8] {
            let (a, b) = (L::load(&self.0), L::load(&self.1));
            let positive = b.max(L::splat(1e-30));
            let turn = a.abs().min(L::splat(std::f32::consts::PI));
            let (sin, cos) = sin_cos(turn);
            let (sin_u, cos_u) = sin_cos_of_turn(a.abs().min(L::splat(1.0)));
            let (quotient, angle) = (ln_quotient(a.abs(), positive), angle(positive, a));
            [exp(a), quotient, sin, cos, angle, exp_minus_one(a.abs()), sin_u, cos_u].map(|x| x.store())
        }
    }

    #[test]
    fn functions_have_small_errors_and_the_same_bits_everywhere() {
        let numbers: Vec<f32> =
            (0..200).map(|i| 1.13_f32.powi(i - 100) * if i % 2 == 0 { 1.0 } else { 0.97 }).collect();
        let mut worst = [0.0_f64; 8];
        for sign in [1.0, -1.0] {
            for (i, a) in numbers.iter().enumerate() {
                for chunk in numbers.chunks_exact(WIDTH) {
                    let a = sign * a;
                    let rows = (Row([a; WIDTH]), Row(std::array::from_fn(|lane| chunk[lane])));
                    let mut answers = Level::available().iter().map(|level| level.run(All(rows.0, rows.1)));
                    let found = answers.next().unwrap();
                    assert!(answers.all(|other| other == found), "the levels differ at {i}");
                    for (lane, b) in chunk.iter().enumerate() {
                        let (a, b) = (f64::from(a), f64::from(*b));
                        let turn = a.abs().min(f64::from(std::f32::consts::PI));
                        let expected = [
                            a.clamp(-87.0, 88.0).exp(),
                            (a.abs() / b).ln_1p(),
                            turn.sin(),
                            turn.cos(),
                            b.atan2(a),
                            a.abs().min(88.0).exp_m1(),
                            (a.abs().min(1.0) * std::f64::consts::TAU).sin(),
                            (a.abs().min(1.0) * std::f64::consts::TAU).cos(),
                        ];
                        for k in 0..8 {
                            // Sine and cosine err by their largest value, the others by their own.
                            let unit = if matches!(k, 2 | 3 | 6 | 7) { 1.0 } else { expected[k] };
                            worst[k] = worst[k].max((f64::from(found[k].0[lane]) - expected[k]).abs() / unit);
                        }
                    }
                }
            }
        }
        println!("errors of exp, ln, sin, cos, angle, exp - 1, sin and cos of turns: {worst:?}");
        let allowed = [3e-7, 4e-7, 2e-7, 2e-7, 4e-7, 4e-7, 4e-7, 4e-7];
        assert!((0..8).all(|k| worst[k] < allowed[k]), "{worst:?}");
    }
}
