//! Blur kernels of density estimation, normalised in one, two or three dimensions (Silverman 1986).

use std::f32::consts::PI;

/// The shape of a radially symmetric kernel, zero beyond its radius.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Kernel {
    /// The same everywhere.
    Constant,
    /// `1 - x^2`.
    #[default]
    Epanechnikov,
    /// `(1 - x^2)^2`.
    Biweight,
}

impl Kernel {
    /// All kernels with their names.
    pub const NAMES: [(&'static str, Self); 3] =
        [("constant", Self::Constant), ("epanechnikov", Self::Epanechnikov), ("biweight", Self::Biweight)];

    /// The kernel of that name.
    pub fn named(name: &str) -> Option<Self> {
        Self::NAMES.iter().find(|(known, _)| *known == name).map(|(_, kernel)| *kernel)
    }

    /// Value in 1/m^`DIMENSION` for `squared` = (distance / radius)^2 and the radius in metres; zero from `squared` = 1 on.
    #[inline(always)]
    pub fn value<const DIMENSION: usize>(self, squared: f32, radius: f32) -> f32 {
        const { assert!(1 <= DIMENSION && DIMENSION <= 3) }
        if squared >= 1.0 {
            return 0.0;
        }
        let rest = 1.0 - squared;
        let (norms, shape) = match self {
            Self::Constant => ([0.5, 1.0 / PI, 0.75 / PI], 1.0),
            Self::Epanechnikov => ([0.75, 2.0 / PI, 1.875 / PI], rest),
            Self::Biweight => ([0.9375, 3.0 / PI, 3.28125 / PI], rest * rest),
        };
        let mut volume = radius;
        for _ in 1..DIMENSION {
            volume *= radius;
        }
        norms[DIMENSION - 1] * shape / volume
    }

    /// Extent of a blur of that dimension and radius: length (m), area (m^2) or volume (m^3).
    pub fn extent(dimension: usize, radius: f32) -> f32 {
        match dimension {
            1 => 2.0 * radius,
            2 => PI * radius * radius,
            _ => 4.0 / 3.0 * PI * radius * radius * radius,
        }
    }

    /// Second moment along one axis in units of the squared radius: a blur of radius r adds `m r^2 / 2` times the
    /// Laplacian over the blurred dimensions.
    pub fn second_moment(self, dimension: usize) -> f32 {
        let moments = match self {
            Self::Constant => [1.0 / 3.0, 1.0 / 4.0, 1.0 / 5.0],
            Self::Epanechnikov => [1.0 / 5.0, 1.0 / 6.0, 1.0 / 7.0],
            Self::Biweight => [1.0 / 7.0, 1.0 / 8.0, 1.0 / 9.0],
        };
        moments[dimension - 1]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Integral of `K x^power` over the ball of radius 2, by the midpoint rule over shells, and the same along one axis.
    fn moments<const D: usize>(kernel: Kernel) -> (f64, f64) {
        let (n, radius) = (20_000, 2.0);
        let (mut mass, mut second) = (0.0, 0.0);
        for i in 0..n {
            let x = (f64::from(i) + 0.5) / f64::from(n);
            let r = x * radius;
            let shell = [2.0, std::f64::consts::TAU * r, 2.0 * std::f64::consts::TAU * r * r][D - 1];
            let k = f64::from(kernel.value::<D>((x * x) as f32, radius as f32)) * shell * radius / f64::from(n);
            mass += k;
            second += k * x * x / D as f64;
        }
        (mass, second)
    }

    #[test]
    fn kernels_integrate_to_one_and_have_their_second_moments() {
        for (name, kernel) in Kernel::NAMES {
            for (d, (mass, second)) in (1..).zip([moments::<1>(kernel), moments::<2>(kernel), moments::<3>(kernel)]) {
                assert!((mass - 1.0).abs() < 1e-5, "{name} in {d} dimensions: {mass}");
                assert!((second - f64::from(kernel.second_moment(d))).abs() < 1e-5, "{name} in {d}: {second}");
            }
            assert_eq!(kernel.value::<2>(1.0, 1.0), 0.0);
        }
    }
}
