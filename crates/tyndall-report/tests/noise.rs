//! Agreement and the split of errors on made-up noise, where the answers are known.

use tyndall_report::View;
use tyndall_report::agreement::{Agreement, Estimate};
use tyndall_report::split::{Noise, Reference, Split};

const WIDTH: usize = 96;
const HEIGHT: usize = 64;
const SAMPLES: u32 = 16;

/// Independent uniform numbers (splitmix64).
struct Random(u64);

impl Random {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }
}

fn truth(i: usize) -> f64 {
    0.3 + 0.25 * ((i % WIDTH) as f64 * 0.1).sin()
}

/// A render of exponential samples about the truth times `scale`, with the variance that it sees.
fn render(seed: u64, scale: f64) -> [Vec<[f32; 3]>; 2] {
    let mut random = Random(seed << 32);
    let mut pixel = |i: usize| {
        let channel = |_| {
            let samples: Vec<f64> = (0..SAMPLES).map(|_| -truth(i) * scale * (1.0 - random.uniform()).ln()).collect();
            let n = f64::from(SAMPLES);
            let mean = samples.iter().sum::<f64>() / n;
            let squares = samples.iter().map(|x| (x - mean).powi(2)).sum::<f64>();
            (mean as f32, (squares / (n - 1.0) / n) as f32)
        };
        [0, 1, 2].map(channel)
    };
    let pixels: Vec<[(f32, f32); 3]> = (0..WIDTH * HEIGHT).map(&mut pixel).collect();
    [pixels.iter().map(|p| p.map(|c| c.0)).collect(), pixels.iter().map(|p| p.map(|c| c.1)).collect()]
}

fn view(pixels: &[[f32; 3]]) -> View<'_> {
    View::new(WIDTH, HEIGHT, pixels).unwrap()
}

fn agreement(a: &[Vec<[f32; 3]>; 2], b: &[Vec<[f32; 3]>; 2]) -> Agreement {
    let [a, b] = [a, b].map(|r| Estimate { picture: view(&r[0]), variance: view(&r[1]), samples: SAMPLES });
    Agreement::of(a, b).unwrap().unwrap()
}

#[test]
fn other_seeds_agree_and_other_pictures_do_not() {
    let first = render(1, 1.0);
    for seed in 2..8 {
        let found = agreement(&first, &render(seed, 1.0));
        assert!(found.agree && (0.8..1.2).contains(&found.mean_square), "{found:?}");
    }
    // A fiftieth brighter: far below the noise of a pixel, but seen in the mean.
    let brighter = agreement(&first, &render(9, 1.02));
    assert!(!brighter.agree && brighter.of_means < -4.0, "{brighter:?}");
    // Half as bright again: seen by the pixels.
    let wrong = agreement(&first, &render(10, 1.5));
    assert!(!wrong.agree && wrong.mean_square > 1.5, "{wrong:?}");
    let same = agreement(&first, &first);
    assert!(same.agree && same.mean_square == 0.0);
}

#[test]
fn too_few_samples_are_not_tested() {
    let [picture, variance] = render(1, 1.0);
    let estimate = Estimate { picture: view(&picture), variance: view(&variance), samples: 2 };
    assert_eq!(Agreement::of(estimate, estimate).unwrap(), None);
}

/// The mean of the halves, and them.
fn reference() -> [Vec<[f32; 3]>; 3] {
    let [a, b] = [100, 101].map(|seed| render(seed, 1.0)[0].clone());
    let mean = a.iter().zip(&b).map(|(a, b)| [0, 1, 2].map(|c| 0.5 * (a[c] + b[c]))).collect();
    [mean, a, b]
}

/// What the split should find: the variance of one render and the square of its bias.
fn expected(scale: f64) -> [f64; 2] {
    let mean = |f: &dyn Fn(usize) -> f64| {
        (0..WIDTH * HEIGHT).map(|i| f(i) / (truth(i).powi(2) + 1e-3)).sum::<f64>() / (WIDTH * HEIGHT) as f64
    };
    [mean(&|i| (truth(i) * scale).powi(2) / f64::from(SAMPLES)), mean(&|i| (truth(i) * (scale - 1.0)).powi(2))]
}

#[test]
fn bias_and_variance_come_apart() {
    let [mean, a, b] = reference();
    let reference = Reference { picture: view(&mean), halves: Some([view(&a), view(&b)]) };
    for (scale, biased) in [(1.0, false), (1.15, true), (0.85, true)] {
        let renders: Vec<_> = (1..5).map(|seed| render(seed, scale)).collect();
        let views: Vec<View> = renders.iter().map(|r| view(&r[0])).collect();
        let [variance, bias] = expected(scale);
        let several = Split::of(&views, Noise::Scatter, &reference).unwrap();
        let single = Split::of(&views[..1], Noise::Variance(view(&renders[0][1])), &reference).unwrap();
        for found in [several, single] {
            assert_eq!(found.significant, biased, "{found:?}");
            let tolerance = 4.0 * found.bias_error + 0.1 * bias;
            assert!((found.bias_squared - bias).abs() < tolerance, "{found:?}, expected {bias}");
            assert!((found.variance / variance - 1.0).abs() < 0.15, "{found:?}, expected {variance}");
        }
        assert_eq!((several.renders, single.renders), (4, 1));
    }
}

#[test]
fn a_reference_without_halves_has_no_error_of_its_own() {
    let [mean, ..] = reference();
    let reference = Reference { picture: view(&mean), halves: None };
    assert_eq!(reference.own_error(), 0.0);
    assert!(Split::of(&[view(&mean)], Noise::Scatter, &reference).is_err());
}
