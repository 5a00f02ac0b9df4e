//! Reconstruction filters by importance sampling (Ernst, Stamminger and Greiner 2006).
//!
//! Every sample belongs to one pixel and is moved off its centre with the density of the filter: the plain mean of a
//! pixel's samples is then the filtered picture. Filters are products of one profile along x and y.

use crate::math::Vec2;
use std::f64::consts::PI;

/// Reconstruction filters; sizes in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs, reason = "the parameters are those of the literature")]
pub enum ReconstructionFilter {
    Box,
    Tent { radius: f32 },
    Gaussian { stddev: f32 },
    Mitchell { b: f32, c: f32 },
    CatmullRom,
    Lanczos { lobes: u32 },
}

impl Default for ReconstructionFilter {
    fn default() -> Self {
        Self::Gaussian { stddev: 0.5 }
    }
}

/// Nodes of a table per pixel of a filter's radius.
const NODES_PER_PIXEL: f64 = 256.0;
/// Greatest radius of a filter, pixels.
const MAX_RADIUS: f64 = 64.0;

/// Why a filter cannot be sampled.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum FilterError {
    /// The filter has no extent, or too much.
    #[error("the filter reaches {0} pixels, expected more than 0 and at most 64")]
    Radius(f64),
    /// The parameters of a cubic filter are not finite.
    #[error("the filter has B = {b} and C = {c}, expected finite numbers")]
    Cubic {
        /// B.
        b: f32,
        /// C.
        c: f32,
    },
}

/// Draws positions in the density of a filter.
#[derive(Clone, Debug)]
pub struct FilterSampler {
    profile: Profile,
    filter: ReconstructionFilter,
    radius: f32,
    /// Integral along an axis, pixels.
    integral: f64,
}

#[derive(Clone, Debug)]
enum Profile {
    Box,
    Tent { radius: f32 },
    Table(Table),
}

impl FilterSampler {
    /// A sampler of `filter`.
    pub fn new(filter: ReconstructionFilter) -> Result<Self, FilterError> {
        let radius = radius(filter);
        if !(0.0 < radius && radius <= MAX_RADIUS) {
            return Err(FilterError::Radius(radius));
        }
        let profile = match filter {
            ReconstructionFilter::Box => Profile::Box,
            ReconstructionFilter::Tent { radius } => Profile::Tent { radius },
            ReconstructionFilter::Mitchell { b, c } if !(b.is_finite() && c.is_finite()) => {
                return Err(FilterError::Cubic { b, c });
            }
            _ => Profile::Table(Table::new(|x| value(filter, x), radius)),
        };
        let integral = match &profile {
            Profile::Box => 1.0,
            Profile::Tent { radius } => f64::from(*radius),
            Profile::Table(table) => 2.0 * table.integral,
        };
        Ok(Self { profile, filter, radius: radius as f32, integral })
    }

    /// Half its width, pixels.
    #[inline]
    pub fn radius(&self) -> f32 {
        self.radius
    }

    /// The filter along one axis at `offset` from the pixel's centre, 1/pixel; it integrates to one.
    #[inline]
    pub fn value(&self, offset: f32) -> f32 {
        (value(self.filter, f64::from(offset.abs())) / self.integral) as f32
    }

    /// Along one axis: a pixel whose filter takes in the `position` of the film, in pixels, chosen with `u` in [0, 1), and
    /// the weight of what is added there: the filter's value over the probability of the choice.
    #[inline]
    pub fn choose_pixel(&self, position: f32, u: f32) -> (i64, f32) {
        if let Profile::Box = self.profile {
            return (position.floor() as i64, 1.0);
        }
        let first = (position - 0.5 - self.radius).ceil() as i64;
        let last = (position - 0.5 + self.radius).floor() as i64;
        let value = |pixel: i64| self.value(position - 0.5 - pixel as f32);
        let total: f32 = (first..=last).map(|pixel| value(pixel).abs()).sum();
        let mut rest = u * total;
        for pixel in first..=last {
            let value = value(pixel);
            if rest < value.abs() {
                return (pixel, total.copysign(value));
            }
            rest -= value.abs();
        }
        // Between the pixels of a filter narrower than they are, or by rounding.
        (first, 0.0)
    }

    /// An offset from the pixel's centre, in pixels, and the sample's weight. `u` in [0, 1)^2.
    ///
    /// Along each axis the offset has the density `|f| / integral of |f|` and grows with u; the weight is the product of
    /// `sign(f) * integral of |f| / integral of f`, so its mean is 1.
    #[inline]
    pub fn sample(&self, u: Vec2) -> (Vec2, f32) {
        let v = 2.0 * u - Vec2::ONE;
        match &self.profile {
            Profile::Box => (0.5 * v, 1.0),
            Profile::Tent { radius } => {
                let distance = |v: f32| *radius * (1.0 - (1.0 - v.abs()).sqrt()).copysign(v);
                (Vec2::new(distance(v.x), distance(v.y)), 1.0)
            }
            Profile::Table(table) => {
                let (x, weight_x) = table.sample(v.x.abs());
                let (y, weight_y) = table.sample(v.y.abs());
                (Vec2::new(x.copysign(v.x), y.copysign(v.y)), weight_x * weight_y)
            }
        }
    }
}

/// A filter's profile from its centre outwards: linear between nodes, which include its zeros.
#[derive(Clone, Debug)]
struct Table {
    nodes: Vec<Node>,
    /// Integral of |f| divided by the integral of f.
    weight: f32,
    /// Integral of f from the centre outwards.
    integral: f64,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    /// Distance from the centre, pixels.
    x: f32,
    /// Value, any scale.
    f: f32,
    /// Part of the integral of |f| within x.
    cumulative: f32,
}

impl Table {
    fn new(f: impl Fn(f64) -> f64, radius: f64) -> Self {
        let intervals = (NODES_PER_PIXEL * radius).ceil().max(NODES_PER_PIXEL) as usize;
        let mut points = Vec::with_capacity(intervals + 8);
        for i in 0..=intervals {
            let x = radius * i as f64 / intervals as f64;
            let y = f(x);
            if let Some(&(x_before, y_before)) = points.last()
                && y_before * y < 0.0
            {
                points.push((zero(&f, x_before, x), 0.0));
            }
            points.push((x, y));
        }
        let area = |pair: &[(f64, f64)]| 0.5 * (pair[1].0 - pair[0].0) * (pair[0].1 + pair[1].1);
        let (mut whole, mut absolute) = (0.0, vec![0.0]);
        for pair in points.windows(2) {
            whole += area(pair);
            absolute.push(absolute[absolute.len() - 1] + area(pair).abs());
        }
        let sum = absolute[absolute.len() - 1];
        let node = |(&(x, f), &c): (&(f64, f64), &f64)| Node { x: x as f32, f: f as f32, cumulative: (c / sum) as f32 };
        Self { nodes: points.iter().zip(&absolute).map(node).collect(), weight: (sum / whole) as f32, integral: whole }
    }

    /// A distance from the centre and its weight.
    #[inline]
    fn sample(&self, v: f32) -> (f32, f32) {
        let i = self.nodes.partition_point(|node| node.cumulative <= v).clamp(1, self.nodes.len() - 1) - 1;
        let (a, b) = (self.nodes[i], self.nodes[i + 1]);
        // Solve f_a t + (f_b - f_a) t^2 / 2 = share (f_a + f_b) / 2 for |f|, in the form without cancellation.
        let share = ((v - a.cumulative) / (b.cumulative - a.cumulative)).clamp(0.0, 1.0);
        let (fa, fb) = (a.f.abs(), b.f.abs());
        let target = share * (fa + fb);
        let root = (fa * fa + target * (fb - fa)).max(0.0).sqrt();
        let t = if target > 0.0 { (target / (fa + root)).min(1.0) } else { 0.0 };
        (a.x + t * (b.x - a.x), self.weight.copysign(self.weight * (a.f + b.f)))
    }
}

/// The zero of `f` between `a` and `b`, where it has different signs.
fn zero(f: impl Fn(f64) -> f64, mut a: f64, mut b: f64) -> f64 {
    for _ in 0..60 {
        let middle = 0.5 * (a + b);
        if f(a) * f(middle) > 0.0 {
            a = middle;
        } else {
            b = middle;
        }
    }
    0.5 * (a + b)
}

/// Half the width of a filter, pixels.
fn radius(filter: ReconstructionFilter) -> f64 {
    match filter {
        ReconstructionFilter::Box => 0.5,
        ReconstructionFilter::Tent { radius } => f64::from(radius),
        ReconstructionFilter::Gaussian { stddev } => 4.0 * f64::from(stddev),
        ReconstructionFilter::Mitchell { .. } | ReconstructionFilter::CatmullRom => 2.0,
        ReconstructionFilter::Lanczos { lobes } => f64::from(lobes),
    }
}

/// The profile at the distance `x` from the centre, in pixels; any scale.
fn value(filter: ReconstructionFilter, x: f64) -> f64 {
    let radius = radius(filter);
    if x > radius {
        return 0.0;
    }
    match filter {
        ReconstructionFilter::Box => 1.0,
        ReconstructionFilter::Tent { .. } => 1.0 - x / radius,
        // Lowered to be zero at the edge.
        ReconstructionFilter::Gaussian { stddev } => {
            let bell = |x: f64| (-0.5 * (x / f64::from(stddev)).powi(2)).exp();
            bell(x) - bell(radius)
        }
        ReconstructionFilter::Mitchell { b, c } => cubic(f64::from(b), f64::from(c), x),
        ReconstructionFilter::CatmullRom => cubic(0.0, 0.5, x),
        ReconstructionFilter::Lanczos { .. } => sinc(x) * sinc(x / radius),
    }
}

/// The family of cubic filters of Mitchell and Netravali (1988), eq. 8.
fn cubic(b: f64, c: f64, x: f64) -> f64 {
    let (x2, x3) = (x * x, x * x * x);
    let six_times = if x < 1.0 {
        (12.0 - 9.0 * b - 6.0 * c) * x3 + (-18.0 + 12.0 * b + 6.0 * c) * x2 + (6.0 - 2.0 * b)
    } else {
        (-b - 6.0 * c) * x3 + (6.0 * b + 30.0 * c) * x2 + (-12.0 * b - 48.0 * c) * x + (8.0 * b + 24.0 * c)
    };
    six_times / 6.0
}

/// `sin(pi x) / (pi x)`.
fn sinc(x: f64) -> f64 {
    if x.abs() < 1e-6 { 1.0 } else { (PI * x).sin() / (PI * x) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ReconstructionFilter::{Box, CatmullRom, Gaussian, Lanczos, Mitchell, Tent};
    use tyndall_testkit::chi2;
    use tyndall_testkit::quadrature::integrate;

    const THIRD: f32 = 1.0 / 3.0;

    const ALL: [ReconstructionFilter; 9] = [
        Box,
        Tent { radius: 1.5 },
        Gaussian { stddev: 0.5 },
        Gaussian { stddev: 0.05 },
        Mitchell { b: THIRD, c: THIRD },
        Mitchell { b: 0.0, c: 0.75 },
        CatmullRom,
        Lanczos { lobes: 1 },
        Lanczos { lobes: 3 },
    ];

    /// Integral of the profile's `part` (itself, or its size) over both sides, interval by interval between its kinks.
    fn integral(filter: ReconstructionFilter, part: fn(f64) -> f64) -> f64 {
        let n = 32;
        let edge = |i: usize| radius(filter) * i as f64 / n as f64;
        2.0 * (0..n).map(|i| integrate(&|x| part(value(filter, x)), edge(i), edge(i + 1), 1e-10)).sum::<f64>()
    }

    #[test]
    fn profiles_agree_with_mitsuba() {
        // `rfilter.eval` of Mitsuba 3.9.1 at these distances.
        let at = [0.0, 0.1, 0.3, 0.49, 0.7, 0.99, 1.2, 1.45, 1.7, 1.9, 2.3, 2.6];
        #[rustfmt::skip]
        let rows = [
            (Box, 1e-6, [1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
            (Tent { radius: 1.5 }, 1e-6, [1.0, 0.9333333, 0.8, 0.6733333, 0.5333333, 0.34, 0.1999999, 0.0333333, 0.0, 0.0, 0.0, 0.0]),
            // Mitsuba replaces the exponential by a polynomial that is off by up to 4e-4.
            (Gaussian { stddev: 0.5 }, 5e-4, [0.9992471, 0.9795333, 0.8350478, 0.6185594, 0.3749484, 0.1404498, 0.0558084, 0.0145659, 0.0027441, 0.0003879, 0.0, 0.0]),
            (Gaussian { stddev: 0.7 }, 5e-4, [0.9992545, 0.9891481, 0.9118458, 0.7825716, 0.6064305, 0.3674788, 0.229634, 0.1166718, 0.0520734, 0.024787, 0.0041885, 0.0006754]),
            (Mitchell { b: THIRD, c: THIRD }, 1e-6, [0.888889, 0.8700556, 0.740389, 0.5459461, 0.3090556, 0.0607044, -0.0142223, -0.0361318, -0.0194999, -0.0029442, 0.0, 0.0]),
            (Mitchell { b: 0.0, c: 0.75 }, 1e-6, [1.0, 0.97875, 0.83125, 0.6068363, 0.32625, 0.0076488, -0.096, -0.1020935, -0.04725, -0.0067497, 0.0, 0.0]),
            (CatmullRom, 1e-6, [1.0, 0.9765, 0.8155, 0.5762235, 0.2895, 0.0051985, -0.0640001, -0.0680625, -0.0314999, -0.0045002, 0.0, 0.0]),
            (Lanczos { lobes: 3 }, 1e-6, [1.0, 0.9818348, 0.8443431, 0.6211713, 0.3358103, 0.008385, -0.1180006, -0.1425968, -0.0832311, -0.0237699, 0.0311053, 0.0173938]),
        ];
        for (filter, tolerance, expected) in rows {
            for (x, expected) in at.into_iter().zip(expected) {
                let found = value(filter, x);
                assert!((found - expected).abs() < tolerance, "{filter:?} at {x}: {found} {expected}");
            }
        }
    }

    #[test]
    fn offsets_follow_the_size_of_the_profile() {
        for (seed, filter) in ALL.into_iter().enumerate() {
            let sampler = FilterSampler::new(filter).unwrap();
            let (sum, r) = (integral(filter, f64::abs), radius(filter));
            for axis in 0..2 {
                let outcome = chi2::interval(
                    |u| {
                        Some(f64::from(
                            sampler.sample(if axis == 0 { Vec2::new(u, 0.3) } else { Vec2::new(0.7, u) }).0[axis],
                        ))
                    },
                    |x| value(filter, x.abs()).abs() / sum,
                    -r,
                    r,
                    50_000,
                    seed as u64,
                );
                assert!((outcome.integral - 1.0).abs() < 1e-5, "{filter:?}: {outcome:?}");
                assert!(outcome.passes(0.01, 2 * ALL.len()), "{filter:?}: {outcome:?}");
            }
        }
    }

    #[test]
    fn estimates_are_those_of_the_normalised_filter() {
        // One axis at a time by the midpoint rule, the other held where the weight is positive.
        let n = 200_000;
        for filter in ALL {
            let sampler = FilterSampler::new(filter).unwrap();
            let scale = integral(filter, f64::abs) / integral(filter, |f| f);
            let held = sampler.sample(Vec2::splat(0.5)).1;
            assert!((f64::from(held) - scale * scale).abs() < 1e-4, "{filter:?}: {held} {scale}");
            let (mut weights, mut cosines) = (0.0, 0.0);
            for i in 0..n {
                let (offset, weight) = sampler.sample(Vec2::new((i as f32 + 0.5) / n as f32, 0.5));
                let weight = f64::from(weight) / scale / f64::from(n);
                weights += weight;
                cosines += weight * (2.0 * f64::from(offset.x)).cos();
            }
            let r = radius(filter);
            let edge = |i: usize| r * i as f64 / 32.0;
            let expected: f64 = (0..32)
                .map(|i| integrate(&|x| value(filter, x) * (2.0 * x).cos(), edge(i), edge(i + 1), 1e-10))
                .sum::<f64>()
                * 2.0
                / integral(filter, |f| f);
            assert!((weights - 1.0).abs() < 1e-4, "{filter:?}: mean weight {weights}");
            assert!((cosines - expected).abs() < 1e-4, "{filter:?}: {cosines} {expected}");
        }
    }

    #[test]
    fn extreme_random_numbers_stay_in_the_filter() {
        let ends = [0.0, f32::EPSILON / 2.0, 0.5, 1.0 - f32::EPSILON / 2.0];
        for filter in ALL {
            let sampler = FilterSampler::new(filter).unwrap();
            for (a, b) in ends.into_iter().flat_map(|a| ends.map(|b| (a, b))) {
                let (offset, weight) = sampler.sample(Vec2::new(a, b));
                assert!(f64::from(offset.abs().max_element()) <= radius(filter), "{filter:?}: {offset}");
                assert!(weight.is_finite(), "{filter:?}: {weight}");
            }
        }
    }

    #[test]
    fn wrong_parameters_are_errors() {
        for filter in [
            Tent { radius: 0.0 },
            Tent { radius: -1.0 },
            Tent { radius: f32::NAN },
            Gaussian { stddev: 0.0 },
            Gaussian { stddev: f32::INFINITY },
            Lanczos { lobes: 0 },
            Lanczos { lobes: 1000 },
        ] {
            assert!(matches!(FilterSampler::new(filter), Err(FilterError::Radius(_))), "{filter:?}");
        }
        assert!(matches!(FilterSampler::new(Mitchell { b: f32::NAN, c: 0.0 }), Err(FilterError::Cubic { .. })));
    }
}
