//! Pearson's chi-square test of a sampler against the density that it claims.
//!
//! The domain is cut into cells, finer where pilot samples (not used again) crowd, so that a narrow lobe is seen with as
//! much resolution as a wide one. The density is integrated over each cell; samples that the sampler declines (`None`)
//! are a cell of their own, whose probability is what the density lacks to one.

use crate::quadrature::{Rect, integrate};
use crate::random::Random;
use crate::ztest::sidak;
use statrs::function::gamma::gamma_ur;
use std::f64::consts::{PI, TAU};

/// What came out of a test.
#[derive(Clone, Copy, Debug)]
pub struct Chi2Outcome {
    /// Sum of (observed - expected)^2 / expected over the (pooled) cells.
    pub statistic: f64,
    /// Number of (pooled) cells less one.
    pub dof: usize,
    /// Probability of a statistic at least so large if the sampler follows the density.
    pub p_value: f64,
    /// Integral of the density over the domain: one, less the probability of `None`.
    pub integral: f64,
    /// Fraction of the samples that were `None` (or outside the domain).
    pub declined: f64,
}

impl Chi2Outcome {
    /// Whether the density holds no more than all mass and the p-value is above the significance, Šidák-corrected for the
    /// number of `tests` made together: above `1 - (1 - significance)^(1 / tests)`.
    pub fn passes(&self, significance: f64, tests: usize) -> bool {
        self.integral <= 1.0 + 1e-3 && self.p_value >= sidak(significance, tests)
    }

    /// Panics with the figures unless [`Chi2Outcome::passes`].
    #[track_caller]
    pub fn assert(&self, significance: f64, tests: usize) {
        assert!(self.passes(significance, tests), "the sampler does not follow its density: {self:?}");
    }
}

/// Tests a sampler of directions against its density per solid angle.
///
/// `sample` takes a number for discrete choices and a pair for the direction, all uniform on [0, 1), and returns a unit
/// vector or nothing; `pdf` is the density it claims [1/sr], without the probability of `None`.
pub fn sphere(
    mut sample: impl FnMut(f32, [f32; 2]) -> Option<[f32; 3]>,
    pdf: impl Fn([f32; 3]) -> f64,
    samples: usize,
    seed: u64,
) -> Chi2Outcome {
    let draw = |random: &mut Random| {
        let choice = random.f32();
        sample(choice, random.f32x2()).map(|d| {
            let [x, y, z] = d.map(f64::from);
            let length = (x * x + y * y + z * z).sqrt();
            assert!((length - 1.0).abs() < 1e-3, "not a unit vector: {d:?}");
            [z / length, y.atan2(x).rem_euclid(TAU)]
        })
    };
    let density = |cos: f64, phi: f64| {
        let sin = (1.0 - cos * cos).max(0.0).sqrt();
        pdf([(sin * phi.cos()) as f32, (sin * phi.sin()) as f32, cos as f32])
    };
    plane(draw, density, Rect { min: [-1.0, 0.0], max: [1.0, 2.0 * PI] }, [8, 16], samples, seed)
}

/// Tests a sampler of the unit square against its density per area.
pub fn square(
    mut sample: impl FnMut([f32; 2]) -> Option<[f32; 2]>,
    pdf: impl Fn([f32; 2]) -> f64,
    samples: usize,
    seed: u64,
) -> Chi2Outcome {
    let draw = |random: &mut Random| sample(random.f32x2()).map(|p| p.map(f64::from));
    let density = |x: f64, y: f64| pdf([x as f32, y as f32]);
    plane(draw, density, Rect { min: [0.0, 0.0], max: [1.0, 1.0] }, [8, 8], samples, seed)
}

/// Tests a sampler of the interval [a, b] against its density per length; `b` may be infinite.
///
/// What falls outside the interval counts as `None`.
pub fn interval(
    mut sample: impl FnMut(f32) -> Option<f64>,
    pdf: impl Fn(f64) -> f64,
    a: f64,
    b: f64,
    samples: usize,
    seed: u64,
) -> Chi2Outcome {
    // an infinite interval is folded onto [0, 1) by u = t / (1 + t), t = x - a
    let infinite = b.is_infinite();
    let fold = |x: f64| if infinite { (x - a) / (1.0 + (x - a)) } else { x };
    let (lo, hi) = if infinite { (0.0, 1.0) } else { (a, b) };
    let density = |u: f64| {
        if infinite {
            let rest = 1.0 - u;
            if rest > 0.0 { pdf(a + u / rest) / (rest * rest) } else { 0.0 }
        } else {
            pdf(u)
        }
    };
    let mut random = Random::new(seed);
    let mut draw = || sample(random.f32()).map(fold).filter(|u| (lo..=hi).contains(u));

    let mut edges: Vec<f64> = {
        let mut pilot: Vec<f64> = (0..PILOTS).filter_map(|_| draw()).collect();
        pilot.sort_by(f64::total_cmp);
        let even = (0..=16).map(|i| lo + (hi - lo) * f64::from(i) / 16.0);
        even.chain(pilot.iter().copied().step_by((PILOTS / CROWD).max(1))).collect()
    };
    edges.sort_by(f64::total_cmp);
    edges.dedup();
    let cells = edges.len() - 1;
    let expected: Vec<f64> = edges.windows(2).map(|e| integrate(&density, e[0], e[1], CELL_TOLERANCE)).collect();
    let mut observed = vec![0usize; cells];
    let mut declined = 0;
    for _ in 0..samples {
        match draw() {
            Some(u) => observed[edges.partition_point(|&e| e <= u).clamp(1, cells) - 1] += 1,
            None => declined += 1,
        }
    }
    pearson(expected.into_iter().zip(observed).collect(), declined, samples)
}

/// Number of samples that only choose the cells.
const PILOTS: usize = 8192;
/// A cell is split while it holds more than this part of the pilots.
const CROWD: usize = 64;
/// Absolute error allowed in the probability of a cell of the plane ...
const TOLERANCE: f64 = 2e-7;
/// ... and of an interval: above the noise of densities in single precision, which no subdivision gets rid of.
const CELL_TOLERANCE: f64 = 1e-8;

/// A cell: its extent, and the first of its four quarters where it was split.
struct Cell {
    rect: Rect,
    quarters: Option<usize>,
}

fn plane(
    mut draw: impl FnMut(&mut Random) -> Option<[f64; 2]>,
    density: impl Fn(f64, f64) -> f64,
    domain: Rect,
    grid: [usize; 2],
    samples: usize,
    seed: u64,
) -> Chi2Outcome {
    let mut random = Random::new(seed);
    let inside = |p: &[f64; 2]| (0..2).all(|k| (domain.min[k]..=domain.max[k]).contains(&p[k]));
    let step = [0, 1].map(|k| (domain.max[k] - domain.min[k]) / grid[k] as f64);
    let at = |k: usize, i: usize| domain.min[k] + step[k] * i as f64;
    let mut cells: Vec<Cell> = (0..grid[0] * grid[1])
        .map(|i| (i % grid[0], i / grid[0]))
        .map(|(i, j)| Rect { min: [at(0, i), at(1, j)], max: [at(0, i + 1), at(1, j + 1)] })
        .map(|rect| Cell { rect, quarters: None })
        .collect();
    let root = |p: &[f64; 2]| {
        let [i, j] = [0, 1].map(|k| (((p[k] - domain.min[k]) / step[k]) as usize).min(grid[k] - 1));
        i + grid[0] * j
    };

    let mut crowds = vec![Vec::new(); cells.len()];
    for p in (0..PILOTS).filter_map(|_| draw(&mut random)).filter(inside) {
        crowds[root(&p)].push(p);
    }
    let mut queue: Vec<(usize, Vec<[f64; 2]>, u32)> = crowds.into_iter().enumerate().map(|(i, c)| (i, c, 0)).collect();
    while let Some((cell, crowd, depth)) = queue.pop() {
        if crowd.len() <= PILOTS / CROWD || depth == 16 {
            continue;
        }
        let first = cells.len();
        let rect = cells[cell].rect;
        cells[cell].quarters = Some(first);
        cells.extend(rect.quarters().map(|rect| Cell { rect, quarters: None }));
        let mut parts = [const { Vec::new() }; 4];
        for p in crowd {
            parts[quarter(&rect, &p)].push(p);
        }
        queue.extend(parts.into_iter().enumerate().map(|(i, part)| (first + i, part, depth + 1)));
    }

    let mut observed = vec![0usize; cells.len()];
    let mut declined = 0;
    for _ in 0..samples {
        let Some(p) = draw(&mut random).filter(inside) else {
            declined += 1;
            continue;
        };
        let mut cell = root(&p);
        while let Some(first) = cells[cell].quarters {
            cell = first + quarter(&cells[cell].rect, &p);
        }
        observed[cell] += 1;
    }
    let leaves = cells.iter().zip(&observed).filter(|(cell, _)| cell.quarters.is_none());
    pearson(leaves.map(|(cell, &n)| (cell.rect.integrate(&density, TOLERANCE), n)).collect(), declined, samples)
}

fn quarter(rect: &Rect, p: &[f64; 2]) -> usize {
    let centre = rect.centre();
    usize::from(p[0] >= centre[0]) + 2 * usize::from(p[1] >= centre[1])
}

/// The statistic over (probability, count) of each cell, the smallest cells pooled until at least 5 samples are expected.
fn pearson(mut cells: Vec<(f64, usize)>, declined: usize, samples: usize) -> Chi2Outcome {
    let integral: f64 = cells.iter().map(|cell| cell.0).sum();
    assert!(cells.iter().all(|cell| cell.0 >= 0.0), "a density is negative or not a number");
    cells.push(((1.0 - integral).max(0.0), declined));
    cells.sort_by(|a, b| a.0.total_cmp(&b.0));
    let n = samples as f64;
    let (mut statistic, mut count) = (0.0, 0);
    let mut pool = (0.0, 0.0);
    for (probability, seen) in cells {
        pool = (pool.0 + n * probability, pool.1 + seen as f64);
        if pool.0 >= 5.0 {
            statistic += (pool.1 - pool.0) * (pool.1 - pool.0) / pool.0;
            count += 1;
            pool = (0.0, 0.0);
        }
    }
    let dof = usize::max(count, 1) - 1;
    // one cell leaves nothing to compare but the total: the test then says only whether that is right
    let p_value = match dof {
        0 => f64::from((integral - 1.0).abs() < 1e-3 && declined == 0),
        _ if statistic > 0.0 => gamma_ur(0.5 * dof as f64, 0.5 * statistic),
        _ => 1.0,
    };
    Chi2Outcome { statistic, dof, p_value, integral, declined: declined as f64 / n }
}

#[cfg(test)]
mod tests {
    use super::*;

    const N: usize = 100_000;

    fn uniform(u: [f32; 2]) -> [f32; 3] {
        let z = 1.0 - 2.0 * u[0];
        let (r, phi) = ((1.0 - z * z).max(0.0).sqrt(), std::f32::consts::TAU * u[1]);
        [r * phi.cos(), r * phi.sin(), z]
    }

    /// Henyey-Greenstein about an oblique axis, in double precision.
    fn lobe(g: f64, u: [f32; 2]) -> [f32; 3] {
        let t = (1.0 - g * g) / (1.0 - g + 2.0 * g * f64::from(u[0]));
        let c = (1.0 + g * g - t * t) / (2.0 * g);
        let (s, phi) = ((1.0 - c * c).max(0.0).sqrt(), TAU * f64::from(u[1]));
        // axis (0.6, 0, 0.8)
        let (x, y) = (s * phi.cos(), s * phi.sin());
        [(0.8 * x + 0.6 * c) as f32, y as f32, (-0.6 * x + 0.8 * c) as f32]
    }

    fn lobe_pdf(g: f64, d: [f32; 3]) -> f64 {
        let [x, y, z] = d.map(f64::from);
        let c = (0.6 * x + 0.8 * z) / (x * x + y * y + z * z).sqrt();
        (1.0 - g * g) / (4.0 * PI * (1.0 + g * g - 2.0 * g * c).powf(1.5))
    }

    #[test]
    fn passes_what_is_right() {
        let tests = 6;
        sphere(|_, u| Some(uniform(u)), |_| 0.25 / PI, N, 1).assert(0.01, tests);
        for g in [-0.5, 0.7, 0.95, 0.99] {
            let outcome = sphere(|_, u| Some(lobe(g, u)), |d| lobe_pdf(g, d), N, 2);
            assert!((outcome.integral - 1.0).abs() < 1e-4, "{g} {outcome:?}");
            assert!(outcome.dof > 50, "{g} {outcome:?}");
            outcome.assert(0.01, tests);
        }
        square(|u| Some([u[0].sqrt(), u[1]]), |p| 2.0 * f64::from(p[0]), N, 3).assert(0.01, tests);
    }

    #[test]
    fn fails_what_is_wrong() {
        assert!(!sphere(|_, u| Some(lobe(0.7, u)), |_| 0.25 / PI, N, 1).passes(0.01, 1));
        assert!(!sphere(|_, u| Some(lobe(0.7, u)), |d| lobe_pdf(0.68, d), N, 1).passes(0.01, 1));
        assert!(!sphere(|_, u| Some(lobe(0.99, u)), |d| lobe_pdf(0.988, d), N, 1).passes(0.01, 1));
        assert!(!sphere(|_, u| Some(uniform(u)), |_| 0.26 / PI, N, 1).passes(0.01, 1));
        let hemisphere = |u| uniform(u).map(f32::abs);
        assert!(!sphere(|_, u| Some(hemisphere(u)), |_| 0.25 / PI, N, 1).passes(0.01, 1));
        assert!(!square(|u| Some([u[0].sqrt(), u[1]]), |_| 1.0, N, 1).passes(0.01, 1));
    }

    #[test]
    fn counts_declined_samples_as_missing_mass() {
        let upper = |_, u| Some(uniform(u)).filter(|d: &[f32; 3]| d[2] > 0.3);
        let density = |below: f64| move |d: [f32; 3]| if d[2] > 0.3 { 0.25 / PI } else { below };
        let outcome = sphere(upper, density(0.0), N, 5);
        assert!((outcome.integral - 0.35).abs() < 1e-3 && (outcome.declined - 0.65).abs() < 0.01);
        outcome.assert(0.01, 1);
        assert!(!sphere(upper, density(0.25 / PI), N, 5).passes(0.01, 1));
    }

    #[test]
    fn tests_an_interval() {
        let flight = |limit: f64| move |u: f32| Some(-(1.0 - f64::from(u)).ln()).filter(|t| *t < limit);
        interval(flight(f64::INFINITY), |t| (-t).exp(), 0.0, f64::INFINITY, N, 1).assert(0.01, 2);
        interval(flight(1.5), |t| (-t).exp(), 0.0, 1.5, N, 1).assert(0.01, 2);
        let wrong = |t: f64| 1.03 * (-1.03 * t).exp();
        assert!(!interval(flight(f64::INFINITY), wrong, 0.0, f64::INFINITY, N, 1).passes(0.01, 1));
        assert!(!interval(flight(1.5), |t| (-t).exp() / (1.0 - (-1.5f64).exp()), 0.0, 1.5, N, 1).passes(0.01, 1));
    }

    #[test]
    fn p_values_are_uniform() {
        // 400 p-values of a right sampler: Kolmogorov-Smirnov at the 0.1 % level is 1.95 / sqrt(400)
        let mut p: Vec<f64> =
            (0..400).map(|seed| interval(|u| Some(f64::from(u)), |_| 1.0, 0.0, 1.0, 4000, seed).p_value).collect();
        p.sort_by(f64::total_cmp);
        let distance = p.iter().enumerate().map(|(i, p)| (p - (i as f64 + 0.5) / 400.0).abs()).fold(0.0, f64::max);
        assert!(distance < 0.0975, "{distance}");
    }
}
