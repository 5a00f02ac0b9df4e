//! Points for equiangular sampling.

use super::*;
use crate::scene::emitter::EmitterId;
use tyndall_testkit::ztest::Moments;

fn scene() -> (Lights, Ray, f32) {
    let emitters =
        [point([1.0, 1.0, 0.0], 2.0), emitter(EmitterKind::Constant { radiance: [0.1; 3] }, Transform::IDENTITY)];
    let shapes = [
        (Form::Parallelogram(Vec3::new(2.0, 1.5, 0.0), Vec3::X * 1.3, Vec3::Z), [1.0; 3]),
        (Form::Sphere(Vec3::new(-1.0, -1.0, 0.5), 0.4), [3.0; 3]),
    ];
    (lights(&emitters, &shapes), Ray { origin: Vec3::new(-3.0, 0.0, 0.0), direction: Vec3::X }, 6.0)
}

#[test]
fn finds_the_same_light_as_sampling_at_the_point() {
    let (lights, ray, t_max) = scene();
    let x = ray.at(4.0);
    let mut random = Random::new(21);
    let contribution = |s: EmitterSample| {
        // A lobe, so that directions matter too.
        let lobe = 1.0 + s.direction.dot(Vec3::new(0.6, 0.8, 0.0));
        if s.emitter == EmitterId(1) { 0.0 } else { f64::from(lobe * s.radiance[0] / s.pdf.0) }
    };
    let mut by_segment = Moments::default();
    let mut by_point = Moments::default();
    for _ in 0..100_000 {
        let y = lights.sample_for_segment(&ray, t_max, random.f32(), Vec2::from_array(random.f32x2())).unwrap();
        by_segment.push(lights.incident(x, &y).map_or(0.0, contribution));
        by_point.push(sample(&lights, x, &mut random).map_or(0.0, contribution));
    }
    let z = by_segment.two_sample_z(&by_point);
    assert!(tyndall_testkit::ztest::two_sided_p(z) > SIGNIFICANCE, "{by_segment:?} {by_point:?}");
}

#[test]
fn every_density_is_known_to_the_other_technique() {
    let (lights, ray, t_max) = scene();
    let mut random = Random::new(22);
    let mut seen = [0; 4];
    for _ in 0..5_000 {
        let x = ray.at(t_max * random.f32());
        let y = lights.sample_for_segment(&ray, t_max, random.f32(), Vec2::from_array(random.f32x2())).unwrap();
        let Some(s) = lights.incident(x, &y) else { continue };
        seen[s.emitter.0 as usize] += 1;
        let again = lights.segment_pdf(&ray, t_max, x, s.emitter, s.position, s.normal).0;
        assert!((s.pdf.0 / again - 1.0).abs() < 1e-4, "{s:?} {again}");
        // A hit of the same point has the density that `pdf_light_point` says.
        if !s.delta {
            let hit = surface(s.emitter.0 - 2, s.position, s.normal);
            assert_eq!(lights.pdf_light_point(x, &y), lights.pdf_hit(x, &hit));
        } else {
            assert_eq!(lights.pdf_light_point(x, &y).0, lights.point_selection_pdf(x, s.emitter));
        }
    }
    assert!(seen[0] > 100 && seen[2] > 100 && seen[3] > 100, "{seen:?}");
    assert_eq!(lights.segment_selection_pdf(&ray, t_max, EmitterId(1)), 0.0);
}
