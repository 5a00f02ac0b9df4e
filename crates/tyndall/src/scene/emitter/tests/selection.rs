//! The choice among many emitters.

use super::*;
use crate::scene::emitter::EmitterId;
use tyndall_testkit::ztest::Moments;

fn unit(random: &mut Random) -> Vec3 {
    Vec3::from_array([0; 3].map(|_| random.normal() as f32)).normalize()
}

fn within(random: &mut Random, size: f32) -> Vec3 {
    Vec3::from_array([0; 3].map(|_| (2.0 * random.f32() - 1.0) * size))
}

/// 300 finite emitters of all kinds, some infinite ones.
fn crowd() -> Lights {
    let mut random = Random::new(11);
    let mut emitters = vec![
        emitter(EmitterKind::Constant { radiance: [0.01; 3] }, Transform::IDENTITY),
        emitter(EmitterKind::Directional { irradiance: [0.1; 3] }, look_at()),
        emitter(EmitterKind::Envmap { image: picture(8, 4), scale: 0.02 }, rotation()),
    ];
    for i in 0..100 {
        let p = within(&mut random, 5.0).to_array().map(f64::from);
        let target = within(&mut random, 5.0).to_array().map(f64::from);
        let kind = match i % 4 {
            0 | 1 => EmitterKind::Point { intensity: [random.f32(); 3] },
            2 => EmitterKind::Spot { intensity: [1.0; 3], cutoff_angle: 40.0, beam_width: 20.0, texture: None },
            _ => EmitterKind::Projector { irradiance: bitmap(picture(5, 4)), scale: 0.3, fov_x: 60.0, aspect: 1.25 },
        };
        let to_world = Transform::look_at(p, target, [0.1, 1.0, 0.2]).unwrap();
        emitters.push(emitter(kind, to_world));
    }
    let mut shapes = Vec::new();
    for i in 0..200 {
        let p = within(&mut random, 5.0);
        let form = if i % 3 == 0 {
            Form::Sphere(p, 0.05 + 0.2 * random.f32())
        } else {
            Form::Parallelogram(p, unit(&mut random) * 0.3, unit(&mut random) * (0.1 + random.f32()))
        };
        shapes.push((form, [random.f32() * 3.0; 3]));
    }
    lights(&emitters, &shapes)
}

/// Rays and the lengths of their segments.
fn segment(random: &mut Random) -> (Ray, f32) {
    (Ray { origin: within(random, 6.0), direction: unit(random) }, 8.0 * random.f32() + 1e-3)
}

#[test]
fn probabilities_sum_to_one() {
    let lights = crowd();
    let ids = || (0..lights.emitters().len() as u32).map(EmitterId);
    let mut random = Random::new(12);
    for _ in 0..300 {
        let x = within(&mut random, 7.0);
        let sum: f64 = ids().map(|id| f64::from(lights.point_selection_pdf(x, id))).sum();
        assert!((sum - 1.0).abs() < 1e-4, "{sum} at {x}");
        let (ray, t_max) = segment(&mut random);
        let sum: f64 = ids().map(|id| f64::from(lights.segment_selection_pdf(&ray, t_max, id))).sum();
        assert!((sum - 1.0).abs() < 1e-4, "{sum} on {ray:?}");
        let sum: f64 = ids().map(|id| f64::from(lights.segment_selection_pdf(&ray, f32::INFINITY, id))).sum();
        assert!((sum - 1.0).abs() < 1e-4, "{sum} on {ray:?}");
    }
}

#[test]
fn emitters_are_chosen_as_often_as_stated() {
    let lights = crowd();
    let mut random = Random::new(13);
    let (x, (ray, t_max)) = (within(&mut random, 4.0), segment(&mut random));
    let mut counts = vec![[0_u32; 2]; lights.emitters().len()];
    let n = 1 << 18;
    for i in 0..n {
        let choice = (i as f32 + 0.5) / n as f32;
        let (id, selection) = lights.select(x, choice).unwrap();
        assert!((selection / lights.point_selection_pdf(x, id) - 1.0).abs() < 1e-4);
        counts[id.0 as usize][0] += 1;
        let y = lights.sample_for_segment(&ray, t_max, choice, Vec2::ZERO).unwrap();
        assert!((y.selection / lights.segment_selection_pdf(&ray, t_max, y.emitter) - 1.0).abs() < 1e-4);
        counts[y.emitter.0 as usize][1] += 1;
    }
    // Equidistant numbers: each count is right to within a few of the intervals' ends.
    for (id, [at_point, on_segment]) in (0..).map(EmitterId).zip(counts) {
        let near = |count: u32, p: f32| (count as f32 - p * n as f32).abs() <= 4.0;
        assert!(near(at_point, lights.point_selection_pdf(x, id)), "{id:?}");
        assert!(near(on_segment, lights.segment_selection_pdf(&ray, t_max, id)), "{id:?}");
    }
}

#[test]
fn whatever_lights_a_point_can_be_chosen() {
    let lights = crowd();
    let mut random = Random::new(14);
    let mut lit = 0;
    for _ in 0..500 {
        let (ray, t_max) = segment(&mut random);
        let x = ray.at(t_max * random.f32());
        for (id, light) in (0..).map(EmitterId).zip(lights.emitters()) {
            let Some(y) = lights.point_on(id, Vec2::from_array(random.f32x2())) else { continue };
            if lights.incident(x, &y).is_some_and(|s| !s.radiance.is_black()) {
                lit += 1;
                assert!(lights.point_selection_pdf(x, id) > 1e-9, "{light:?} at {x}");
                assert!(lights.segment_selection_pdf(&ray, t_max, id) > 1e-9, "{light:?} on {ray:?} to {t_max}");
            }
        }
    }
    assert!(lit > 10_000);
}

/// Fluence of all emitters one by one against that of the choice.
#[test]
fn the_choice_is_unbiased() {
    let lights = crowd();
    let mut random = Random::new(15);
    let x = Vec3::new(0.5, -1.0, 2.0);
    let chosen: Moments = (0..400_000)
        .map(|_| sample(&lights, x, &mut random).map_or(0.0, |s| f64::from(s.radiance[0] / s.pdf.0)))
        .collect();
    let mut truth = Moments::default();
    for _ in 0..2_000 {
        let finite = (0..).map(EmitterId).take(lights.emitters().len()).filter_map(|id| {
            let y = lights.point_on(id, Vec2::from_array(random.f32x2()))?;
            lights.incident(x, &y).map(|s| f64::from(s.radiance[0] / s.pdf.0))
        });
        let finite: f64 = finite.sum();
        let d = unit(&mut random);
        let escaped = f64::from(lights.radiance_escape(d)[0]) * 4.0 * std::f64::consts::PI;
        truth.push(finite + escaped + f64::from(0.1_f32));
    }
    let z = chosen.two_sample_z(&truth);
    assert!(tyndall_testkit::ztest::two_sided_p(z) > SIGNIFICANCE, "{chosen:?} {truth:?} z = {z}");
}

#[test]
fn clusters_are_found() {
    // 150 lamps near each of two places: near one, the tree beats the uniform choice by orders of magnitude.
    let mut random = Random::new(16);
    let emitters: Vec<_> = (0..300)
        .map(|i| {
            let place = if i % 2 == 0 { Vec3::splat(-4.0) } else { Vec3::splat(4.0) };
            point((place + within(&mut random, 0.5)).to_array().map(f64::from), 1.0 + random.f32())
        })
        .collect();
    let lights = lights(&emitters, &[]);
    let x = Vec3::new(4.0, 4.0, 3.2);
    let brute: Vec<f64> = (0..)
        .map(EmitterId)
        .take(300)
        .map(|id| {
            let y = lights.point_on(id, Vec2::ZERO).unwrap();
            f64::from(lights.incident(x, &y).unwrap().radiance[0])
        })
        .collect();
    let truth: f64 = brute.iter().sum();
    let uniform = brute.iter().map(|e| e * e * 300.0).sum::<f64>() - truth * truth;
    let chosen: Moments = (0..20_000)
        .map(|_| sample(&lights, x, &mut random).map_or(0.0, |s| f64::from(s.radiance[0] / s.pdf.0)))
        .collect();
    chosen.assert(truth, SIGNIFICANCE, 1);
    assert!(chosen.variance() < uniform / 20.0, "{} {uniform}", chosen.variance());
}

#[test]
fn weights_matter() {
    let heavy = EmitterDesc { sampling_weight: 3.0, ..point([1.0, 0.0, 0.0], 1.0) };
    let never = EmitterDesc { sampling_weight: 0.0, ..point([0.0, 1.0, 0.0], 1.0) };
    let lights = lights(&[heavy, point([-1.0, 0.0, 0.0], 1.0), never], &[]);
    let probabilities = [0, 1, 2].map(|id| lights.point_selection_pdf(Vec3::ZERO, EmitterId(id)));
    assert_eq!(probabilities, [0.75, 0.25, 0.0]);
}
