use super::*;
use crate::math::{Rng, Transform};
use crate::scene::desc::{Filter, GridDesc, VolumeDesc, Wrap};
use std::sync::Arc;
use tyndall_testkit::chi2;

const FLAKES: [f32; 6] = [0.5, 0.8, 1.2, 0.1, -0.2, 0.15];

fn hg(g: f32) -> PhaseDesc {
    PhaseDesc::HenyeyGreenstein { g }
}

fn table() -> PhaseDesc {
    PhaseDesc::Tabulated { values: vec![0.5, 1.0, 0.25, 2.0] }
}

fn flakes(size: [usize; 3], values: Vec<f32>) -> PhaseDesc {
    let grid = Arc::new(GridDesc { size, channels: 6, values, bounds: [[0.0; 3], [1.0; 3]] });
    let matrix = VolumeDesc::Grid { grid, to_world: Transform::IDENTITY, filter: Filter::Linear, wrap: Wrap::Clamp };
    PhaseDesc::Sggx { matrix }
}

fn blend(weight: f32, first: PhaseDesc, second: PhaseDesc) -> PhaseDesc {
    PhaseDesc::Blend { weight, first: Box::new(first), second: Box::new(second) }
}

fn compile(desc: &PhaseDesc) -> Phase {
    Phase::compile(desc).unwrap()
}

fn unit(rng: &mut Rng) -> Vec3 {
    crate::math::warp::square_to_sphere(rng.vec2())
}

/// Every model, some at hard parameters.
fn all() -> Vec<(&'static str, PhaseDesc)> {
    let varying = [FLAKES, [1.0, 0.2, 0.1, 0.3, 0.0, 0.05]].concat();
    vec![
        ("isotropic", PhaseDesc::Isotropic),
        ("hg 0", hg(0.0)),
        ("hg 5e-4", hg(5e-4)),
        ("hg 0.6", hg(0.6)),
        ("hg -0.9", hg(-0.9)),
        ("hg 0.98", hg(0.98)),
        ("rayleigh", PhaseDesc::Rayleigh),
        ("tabulated", table()),
        (
            "tabulated with gaps",
            PhaseDesc::Tabulated { values: vec![0.0, 0.0, 3.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0] },
        ),
        ("sggx", flakes([1, 1, 1], FLAKES.to_vec())),
        ("sggx flat", flakes([1, 1, 1], vec![0.02, 0.02, 1.0, 0.0, 0.0, 0.0])),
        ("sggx fibre", flakes([1, 1, 1], vec![1.0, 1.0, 0.05, 0.0, 0.0, 0.0])),
        ("sggx varying", flakes([2, 1, 1], varying)),
        ("blend", blend(0.3, hg(0.6), PhaseDesc::Rayleigh)),
        ("nested blend", blend(0.7, blend(0.2, hg(-0.5), table()), blend(1.0, PhaseDesc::Isotropic, hg(0.8)))),
    ]
}

#[test]
fn samples_follow_the_value() {
    let d_in = Vec3::new(0.48, -0.6, 0.64);
    let x = Vec3::new(0.6, 0.5, 0.5);
    let models = all();
    for (seed, (name, desc)) in models.iter().enumerate() {
        let phase = compile(desc);
        let outcome = chi2::sphere(
            |u1, u2| Some(phase.sample(x, d_in, u1, Vec2::from(u2)).0.to_array()),
            |d| f64::from(phase.eval(x, d_in, Vec3::from(d))),
            60_000,
            seed as u64,
        );
        assert!((outcome.integral - 1.0).abs() < 3e-4, "{name}: {outcome:?}");
        assert!(outcome.passes(0.01, models.len()), "{name}: {outcome:?}");
    }
}

#[test]
fn sampled_density_is_the_value() {
    let mut rng = Rng::keyed(1, 0, 0);
    for (name, desc) in all() {
        let phase = compile(&desc);
        for _ in 0..2000 {
            let (x, d_in) = (Vec3::new(rng.f32(), rng.f32(), rng.f32()), unit(&mut rng));
            let (d_out, pdf) = phase.sample(x, d_in, rng.f32(), rng.vec2());
            let value = phase.eval(x, d_in, d_out);
            assert!((d_out.length() - 1.0).abs() < 1e-5, "{name}: {d_out}");
            assert!((value - pdf.0).abs() < 2e-3 * value.max(0.01), "{name}: {value} {pdf:?}");
        }
    }
}

#[test]
fn extreme_random_numbers_give_finite_directions() {
    let ends = [0.0, f32::EPSILON / 2.0, 0.5, 1.0 - f32::EPSILON / 2.0];
    let mut models = all();
    for g in [1.0 - f32::EPSILON / 2.0, 1e-30, -0.999_999] {
        models.push(("hg at the ends", hg(g)));
    }
    for (name, desc) in models {
        let phase = compile(&desc);
        for (a, b, c) in ends.iter().flat_map(|&a| ends.iter().flat_map(move |&b| ends.map(|c| (a, b, c)))) {
            let (d_out, pdf) = phase.sample(Vec3::ZERO, Vec3::Z, a, Vec2::new(b, c));
            assert!(d_out.is_normalized(), "{name}: {d_out} at {a} {b} {c}");
            assert!(pdf.0.is_finite() && pdf.0 >= 0.0, "{name}: {pdf:?} at {a} {b} {c}");
        }
    }
}

#[test]
fn mean_cosine_is_g() {
    let d_in = Vec3::new(0.0, 0.6, -0.8);
    for g in [0.0, 1e-4, 2e-3, 0.3, 0.8, 0.99, -0.2, -0.75] {
        let phase = compile(&hg(g));
        let n = 4000;
        // The cosine is a monotone function of u.x: the midpoint rule integrates it.
        let sum: f64 = (0..n)
            .map(|i| phase.sample(Vec3::ZERO, d_in, 0.0, Vec2::new((i as f32 + 0.5) / n as f32, 0.3)).0)
            .map(|d_out| f64::from(d_in.dot(d_out)))
            .sum();
        assert!((sum / f64::from(n) - f64::from(g)).abs() < 2e-5, "{g}: {}", sum / f64::from(n));
    }
}

#[test]
fn contrast_is_the_mean_value() {
    for (name, desc) in all().into_iter().filter(|(name, _)| !name.contains("sggx")) {
        let phase = compile(&desc);
        // Samples have the density of the value, so its mean over them is the integral of its square.
        let n = 1024;
        let numbers = (0..n * n).map(|i| [(i % n) as f32 + 0.5, (i / n) as f32 + 0.5].map(|k| k / n as f32));
        let values = numbers.map(|[a, b]| phase.sample(Vec3::ZERO, Vec3::Z, a, Vec2::new(b, 0.3)).1.0);
        let mean = values.map(f64::from).sum::<f64>() / f64::from(n * n) * 4.0 * std::f64::consts::PI;
        let (found, blend) = (f64::from(phase.contrast()), name.contains("blend"));
        assert!(found > 0.995 * mean && (blend || found < 1.005 * mean), "{name}: {found} {mean}");
    }
}

/// Up to a factor, which is the same for all cosines.
#[test]
fn tables_are_scaled_by_the_value() {
    let cosines: Vec<f32> = (0..=20).map(|i| i as f32 / 10.0 - 1.0).collect();
    for (name, desc) in all().into_iter().filter(|(name, _)| !name.contains("sggx")) {
        let phase = compile(&desc);
        let mut values = vec![2.0; cosines.len()];
        phase.scale_table(&cosines, &mut values);
        assert!(values.iter().any(|value| *value > 0.0));
        let value = |cos: f32| phase.eval(Vec3::ZERO, Vec3::Z, Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos));
        let [scaled, true_values] = [values.iter().sum::<f32>(), cosines.iter().map(|cos| value(*cos)).sum()];
        for (cos, found) in cosines.iter().zip(&values) {
            let expected = scaled / true_values * value(*cos);
            assert!((found - expected).abs() <= 1e-3 * expected, "{name}, {cos}: {found} {expected}");
        }
    }
}

#[test]
fn blends_choose_by_their_weights() {
    // Peaks forwards and backwards that hold all but a ten-thousandth of their light in their hemisphere.
    let inner = blend(0.25, hg(0.9999), hg(-0.9999));
    let phase = compile(&blend(0.3, hg(0.9999), inner));
    let n = 10_000;
    let backwards = (0..n)
        .map(|i| phase.sample(Vec3::ZERO, Vec3::Z, (i as f32 + 0.5) / n as f32, Vec2::new(0.5, 0.5)).0)
        .filter(|d| d.z < 0.0)
        .count();
    assert_eq!(backwards, 750);
}

#[test]
fn henyey_greenstein_near_one_keeps_its_digits() {
    // At an angle far below what a cosine in single precision can tell from 0.
    let (g, angle) = (0.9999_f32, 1e-4_f32);
    let value = compile(&hg(g)).eval(Vec3::ZERO, Vec3::Z, Vec3::new(angle.sin(), 0.0, angle.cos()));
    let g = f64::from(g);
    let expected =
        (1.0 - g * g) / (4.0 * std::f64::consts::PI * ((1.0 - g).powi(2) + g * f64::from(angle).powi(2)).powf(1.5));
    assert!((f64::from(value) / expected - 1.0).abs() < 1e-4, "{value} {expected}");
}

#[test]
fn values_agree_with_mitsuba() {
    // d_in, d_out, and the values of hg 0.6, hg -0.4, rayleigh, the table, the blend and the flakes in Mitsuba 3.9.1.
    #[rustfmt::skip]
    let rows = [
        ([0.3635366, 0.8642995, 0.3476026], [-0.7905712, 0.5492417, 0.2707968], [0.04927407, 0.04100381, 0.06441043, 0.0294484, 0.05381498, 0.03114589]),
        ([-0.6163616, 0.6670579, 0.4184879], [0.4732901, 0.04573437, 0.8797186], [0.03725875, 0.04808683, 0.06036566, 0.04819445, 0.04419082, 0.02176484]),
        ([-0.8226903, -0.1819861, -0.5385738], [0.8969774, 0.05949747, -0.4380542], [0.01834365, 0.1029704, 0.07537991, 0.08263691, 0.03545453, 0.03407748]),
        ([-0.9498845, -0.3124444, 0.009891352], [-0.1657718, 0.7783637, 0.6055325], [0.02899791, 0.05824127, 0.06006261, 0.06824973, 0.03831732, 0.09641287]),
        ([-0.8193359, -0.5708756, -0.05281759], [-0.8108305, 0.4103084, 0.4173739], [0.06272609, 0.0368845, 0.06962124, 0.0426056, 0.06479464, 0.1267938]),
    ];
    let models = [
        hg(0.6),
        hg(-0.4),
        PhaseDesc::Rayleigh,
        table(),
        blend(0.3, hg(0.6), PhaseDesc::Rayleigh),
        flakes([1, 1, 1], FLAKES.to_vec()),
    ];
    for (d_in, d_out, expected) in rows {
        for (desc, expected) in models.iter().zip(expected) {
            let value = compile(desc).eval(Vec3::ZERO, Vec3::from(d_in), Vec3::from(d_out));
            assert!((value - expected).abs() < 2e-5 * expected, "{desc:?}: {value} {expected}");
        }
    }
}

#[test]
fn projected_area_is_that_of_the_matrix() {
    let phase = compile(&flakes([1, 1, 1], FLAKES.to_vec()));
    for (d, expected) in [(Vec3::X, 0.707_106_77), (Vec3::Y, 0.894_427_2), (Vec3::new(0.6, 0.0, 0.8), 0.869_482_6)] {
        assert!((phase.extinction_factor(Vec3::ZERO, d) - expected).abs() < 1e-6);
        assert_eq!(phase.extinction_factor(Vec3::ZERO, -d), phase.max_extinction_factor(d));
    }
    assert_eq!(compile(&hg(0.3)).extinction_factor(Vec3::ZERO, Vec3::X), 1.0);

    let phase = compile(&flakes([2, 1, 1], [FLAKES, [1.0, 0.2, 0.1, 0.3, 0.0, 0.05]].concat()));
    let mut rng = Rng::keyed(3, 0, 0);
    let mut largest = 0.0_f32;
    for _ in 0..5000 {
        let d = unit(&mut rng);
        let area = phase.extinction_factor(Vec3::new(rng.f32(), 0.5, 0.5), d);
        assert!(area <= phase.max_extinction_factor(d));
        largest = largest.max(area / phase.max_extinction_factor(d));
    }
    assert!(largest > 0.98, "the bound is loose: {largest}");
}

#[test]
fn flakes_are_reciprocal() {
    // sigma(d_in) f(d_in -> d_out) = sigma(d_out) f(-d_out -> -d_in)
    let phase = compile(&flakes([1, 1, 1], FLAKES.to_vec()));
    let mut rng = Rng::keyed(4, 0, 0);
    for _ in 0..100 {
        let (a, b) = (unit(&mut rng), unit(&mut rng));
        let there = phase.extinction_factor(Vec3::ZERO, a) * phase.eval(Vec3::ZERO, a, b);
        let back = phase.extinction_factor(Vec3::ZERO, b) * phase.eval(Vec3::ZERO, -b, -a);
        assert!((there - back).abs() < 1e-4 * there, "{there} {back}");
    }
}

#[test]
fn wrong_parameters_are_errors() {
    let error = |desc: PhaseDesc| Phase::compile(&desc).unwrap_err();
    for g in [1.0, -1.0, 1.5, f32::NAN] {
        assert!(matches!(error(hg(g)), PhaseError::MeanCosine(_)));
    }
    let tabulated = |values: &[f32]| error(PhaseDesc::Tabulated { values: values.to_vec() });
    assert_eq!(tabulated(&[1.0]), PhaseError::TableTooShort(1));
    assert_eq!(tabulated(&[1.0, -2.0, 1.0]), PhaseError::TableValue { index: 1, value: -2.0 });
    assert!(matches!(tabulated(&[1.0, 1.0, f32::NAN]), PhaseError::TableValue { index: 2, .. }));
    assert_eq!(tabulated(&[0.0, 0.0]), PhaseError::TableEmpty);
    for weight in [-0.1, 1.1, f32::NAN] {
        assert!(matches!(error(blend(weight, hg(0.0), hg(0.0))), PhaseError::Weight(_)));
    }
    assert!(matches!(error(blend(0.5, hg(0.0), hg(2.0))), PhaseError::MeanCosine(_)));
    assert_eq!(
        error(flakes([1, 2, 1], [FLAKES, [1.0, 1.0, 1.0, 1.0, 0.0, 0.0]].concat())),
        PhaseError::MatrixSingular { voxel: [0, 1, 0], matrix: [1.0, 1.0, 1.0, 1.0, 0.0, 0.0] }
    );
    assert!(matches!(error(flakes([1, 1, 1], vec![0.0; 6])), PhaseError::MatrixSingular { .. }));
    assert!(matches!(error(flakes([1, 1, 1], vec![1.0, -1.0, 1.0, 0.0, 0.0, 0.0])), PhaseError::MatrixSingular { .. }));
    assert!(matches!(error(flakes([1, 1, 2], FLAKES.to_vec())), PhaseError::Volume(VolumeError::Length { .. })));
    assert_eq!(error(PhaseDesc::Sggx { matrix: VolumeDesc::constant([1.0; 3]) }), PhaseError::MatrixConstant);
}

#[test]
fn ceilings_are_above_all_values() {
    for (seed, (name, desc)) in all().into_iter().enumerate() {
        let phase = compile(&desc);
        let mut rng = Rng::keyed(9, seed as u64, 0);
        for _ in 0..20_000 {
            let (d_in, x) = (unit(&mut rng), Vec3::new(rng.f32(), rng.f32(), rng.f32()));
            let d_out = if rng.f32() < 0.5 { unit(&mut rng) } else { phase.sample(x, d_in, rng.f32(), rng.vec2()).0 };
            // Not the product, which has no digits left in a peak.
            let cos = match d_in.dot(d_out) > 0.0 {
                true => 1.0 - 0.5 * (d_out - d_in).length_squared(),
                false => 0.5 * (d_out + d_in).length_squared() - 1.0,
            };
            let value = phase.eval(x, d_in, d_out);
            for range in [[cos, cos], [cos - 0.3 * rng.f32(), cos + 0.3 * rng.f32()], [-1.0, 1.0]] {
                let ceiling = phase.ceiling(range.map(|c| c.clamp(-1.0, 1.0)));
                assert!(value <= ceiling * 1.001, "{name} at {cos} in {range:?}: {value} above {ceiling}");
            }
        }
    }
}
