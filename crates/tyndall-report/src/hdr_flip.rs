//! HDR-FLIP: FLIP of a picture of high dynamic range, the worst over all exposures that show something of it (Andersson et
//! al. 2021).

use crate::flip;
use crate::view::{MetricError, View};
use rayon::prelude::*;

/// The curve of the authors' choice, a fit to that of the ACES by Narkowicz, as a quotient of quadratics; the input is
/// scaled by 0.6.
const NUMERATOR: [f64; 3] = [0.6 * 0.6 * 2.51, 0.6 * 0.03, 0.0];
const DENOMINATOR: [f64; 3] = [0.6 * 0.6 * 2.43, 0.6 * 0.59, 0.14];
/// What the curve shows as this is the brightest that is well exposed (section 3).
const BRIGHTEST: f64 = 0.85;

/// The exposures at which a reference is looked at, in stops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exposures {
    /// The lowest: the brightest pixel is well exposed.
    pub start: f64,
    /// The highest: the median pixel is as bright as the brightest was.
    pub stop: f64,
    /// How many, evenly spaced from start to stop.
    pub count: u32,
}

impl Exposures {
    /// Those of a reference (section 3). A black one has a single exposure.
    pub fn of(reference: View) -> Self {
        let luminance = |p: &[f32; 3]| {
            0.212_656 * f64::from(p[0].max(0.0))
                + 0.715_158 * f64::from(p[1].max(0.0))
                + 0.072_186 * f64::from(p[2].max(0.0))
        };
        let mut values: Vec<f64> = reference.pixels().iter().map(luminance).collect();
        values.sort_unstable_by(f64::total_cmp);
        // Of an even number the upper one, as the authors' program has it.
        let (brightest, median) = (values[values.len() - 1], values[values.len() / 2]);
        if brightest <= 0.0 {
            return Self { start: 0.0, stop: 0.0, count: 1 };
        }
        let well_exposed = inverse_curve(BRIGHTEST);
        let start = (well_exposed / brightest).log2();
        // Half of the picture is black: the exposure would be without end.
        let stop = (well_exposed / median.max(f64::from(f32::EPSILON))).log2();
        Self { start, stop, count: (stop - start).ceil().max(2.0) as u32 }
    }

    fn all(self) -> Vec<f64> {
        let step = (self.stop - self.start) / f64::from((self.count - 1).max(1));
        (0..self.count).map(|i| self.start + f64::from(i) * step).collect()
    }
}

/// The error of every pixel, in [0, 1].
pub fn map(picture: View, reference: View, pixels_per_degree: f64) -> Result<Vec<f64>, MetricError> {
    picture.check_same_size(&reference)?;
    let at = |stops: f64| {
        let (a, b) = (exposed(picture, stops), exposed(reference, stops));
        let view = |pixels| View::new(picture.width(), picture.height(), pixels);
        flip::map(view(&a)?, view(&b)?, pixels_per_degree)
    };
    let maps = Exposures::of(reference).all().into_par_iter().map(at).collect::<Result<Vec<_>, _>>()?;
    let worst = |i: usize| maps.iter().map(|map| map[i]).fold(0.0, f64::max);
    Ok((0..picture.pixels().len()).map(worst).collect())
}

/// The mean of the map.
pub fn mean(picture: View, reference: View, pixels_per_degree: f64) -> Result<f64, MetricError> {
    let errors = map(picture, reference, pixels_per_degree)?;
    Ok(errors.iter().sum::<f64>() / errors.len() as f64)
}

fn exposed(view: View, stops: f64) -> Vec<[f32; 3]> {
    let factor = stops.exp2();
    let shown = |x: f32| curve(f64::from(x.max(0.0)) * factor).clamp(0.0, 1.0) as f32;
    view.pixels().iter().map(|p| p.map(shown)).collect()
}

fn curve(x: f64) -> f64 {
    let quadratic = |k: [f64; 3]| (k[0] * x + k[1]) * x + k[2];
    quadratic(NUMERATOR) / quadratic(DENOMINATOR)
}

/// What the curve maps to `y`: the larger root.
fn inverse_curve(y: f64) -> f64 {
    let [a, b, c] = [0, 1, 2].map(|i| NUMERATOR[i] - y * DENOMINATOR[i]);
    (-b + (b * b - 4.0 * a * c).sqrt()) / (2.0 * a)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_and_its_inverse() {
        assert!((curve(inverse_curve(BRIGHTEST)) - BRIGHTEST).abs() < 1e-12);
    }

    #[test]
    fn black_and_half_black_references() {
        let black = vec![[0.0; 3]; 64];
        let mut dot = black.clone();
        dot[9] = [1.0; 3];
        let (black, dot) = (View::new(8, 8, &black).unwrap(), View::new(8, 8, &dot).unwrap());
        assert_eq!(mean(black, black, 67.0).unwrap(), 0.0);
        assert!(mean(dot, black, 67.0).unwrap() > 0.0);
        assert!(Exposures::of(dot).count < 40);
        assert!(mean(black, dot, 67.0).unwrap() > 0.0);
    }
}
