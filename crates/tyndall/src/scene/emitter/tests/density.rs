//! Samples follow the densities that are claimed for them.

use super::*;
use crate::math::warp;
use tyndall_testkit::chi2::{self, Chi2Outcome};
use tyndall_testkit::ztest::{Moments, two_sided_p};

const TESTS: usize = 14;
const SAMPLES: usize = 200_000;

fn chi2_of(emitters: &[EmitterDesc], shapes: &[(Form, Rgb)], x: Vec3) -> Chi2Outcome {
    let lights = lights(emitters, shapes);
    let shapes = geometry(&shapes.iter().map(|(form, _)| *form).collect::<Vec<_>>());
    chi2::sphere(
        |choice, u| lights.sample(x, choice, Vec2::from_array(u)).map(|s| s.direction.to_array()),
        |d| pdf(&lights, &shapes, x, Vec3::from_array(d)),
        SAMPLES,
        1,
    )
}

fn quad() -> Form {
    Form::Parallelogram(Vec3::new(-1.0, -0.5, 1.0), Vec3::new(2.0, 0.0, 0.3), Vec3::new(0.1, -1.5, 0.4))
}

#[test]
fn area_lights() {
    let x = Vec3::new(0.3, -0.2, 0.1);
    assert!(quad_faces(x));
    chi2_of(&[], &[(quad(), [1.0; 3])], x).assert(SIGNIFICANCE, TESTS);
    chi2_of(&[], &[(Form::Sphere(Vec3::new(1.0, 2.0, -0.5), 0.9), [1.0; 3])], x).assert(SIGNIFICANCE, TESTS);
    // From inside and from outside of a shell that emits inwards, and from inside a sphere that does not.
    let (near, far) = (Vec3::new(0.3, 0.5, 0.1), Vec3::new(2.0, -1.0, 0.5));
    let shell = Form::Shell(Vec3::ZERO, 1.0);
    chi2_of(&[], &[(shell, [1.0; 3])], near).assert(SIGNIFICANCE, TESTS);
    chi2_of(&[], &[(shell, [1.0; 3])], far).assert(SIGNIFICANCE, TESTS);
    assert!(chi2_of(&[], &[(Form::Sphere(Vec3::ZERO, 1.0), [1.0; 3])], near).integral < 1e-6);
}

#[test]
fn other_shapes() {
    let x = Vec3::new(0.8, -1.5, 2.0);
    for form in [Form::Disk, Form::Cube] {
        chi2_of(&[], &[(form, [1.0; 3])], x).assert(SIGNIFICANCE, TESTS);
    }
}

fn quad_faces(x: Vec3) -> bool {
    let Form::Parallelogram(p, a, b) = quad() else { return false };
    (x - p).dot(a.cross(b)) > 0.0
}

#[test]
fn tubes() {
    // Chosen by area, the density has a pole at the silhouette. Its reciprocal has none: the mean is the solid angle.
    let x = Vec3::new(0.8, -1.5, 2.0);
    let (lights, shapes) = (lights(&[], &[(Form::Tube, [1.0; 3])]), geometry(&[Form::Tube]));
    let mut random = Random::new(4);
    let mut sampled = Moments::default();
    let mut seen = Moments::default();
    for _ in 0..100_000 {
        sampled.push(sample(&lights, x, &mut random).map_or(0.0, |s| 1.0 / f64::from(s.pdf.0)));
        let direction = warp::square_to_sphere(Vec2::from_array(random.f32x2()));
        let front = hits(&shapes, Ray { origin: x, direction }).any(|p| p.normal.dot(direction) < 0.0);
        seen.push(if front { 4.0 * std::f64::consts::PI } else { 0.0 });
    }
    let z = sampled.two_sample_z(&seen);
    assert!(two_sided_p(z) > SIGNIFICANCE / TESTS as f64, "{sampled:?} {seen:?} z = {z}");
}

#[test]
fn constant() {
    chi2_of(&[emitter(EmitterKind::Constant { radiance: [1.0; 3] }, Transform::IDENTITY)], &[], Vec3::ONE)
        .assert(SIGNIFICANCE, TESTS);
}

#[test]
fn envmaps() {
    let envmap = |image| emitter(EmitterKind::Envmap { image, scale: 2.0 }, rotation());
    chi2_of(&[envmap(picture(8, 5))], &[], Vec3::ONE).assert(SIGNIFICANCE, TESTS);
    chi2_of(&[envmap(picture(1, 1))], &[], Vec3::ONE).assert(SIGNIFICANCE, TESTS);
    // Black but for one pixel: only its four patches are sampled.
    let mut sun = ImageDesc { width: 9, height: 6, pixels: vec![[0.0; 3]; 54] };
    sun.pixels[2 * 9 + 8] = [5.0, 1.0, 0.0];
    chi2_of(&[envmap(Arc::new(sun))], &[], Vec3::ONE).assert(SIGNIFICANCE, TESTS);
}

#[test]
fn mixture_of_everything() {
    let emitters = [
        emitter(EmitterKind::Constant { radiance: [0.5; 3] }, Transform::IDENTITY),
        emitter(EmitterKind::Envmap { image: picture(7, 4), scale: 1.0 }, rotation()),
    ];
    let shapes = [(quad(), [3.0; 3]), (Form::Sphere(Vec3::new(1.0, 2.0, -0.5), 0.9), [1.0, 0.0, 0.0])];
    chi2_of(&emitters, &shapes, Vec3::new(0.3, -0.2, 0.1)).assert(SIGNIFICANCE, TESTS);
}

#[test]
fn the_density_of_the_envmap_matches_its_radiance() {
    // Smooth picture: the ratio of radiance to density hardly varies.
    let (width, height) = (64, 33);
    let value = |p: usize| 1.0 + (p / width) as f32 / height as f32;
    let image = Arc::new(ImageDesc { width, height, pixels: (0..width * height).map(|p| [value(p); 3]).collect() });
    let lights = lights(&[emitter(EmitterKind::Envmap { image, scale: 3.0 }, rotation())], &[]);
    let mut random = Random::new(2);
    for _ in 0..10_000 {
        let s = sample(&lights, Vec3::ZERO, &mut random).unwrap();
        let weight = s.radiance[0] / s.pdf.0;
        assert!((weight / (3.0 * 1.5 * 4.0 * std::f32::consts::PI) - 1.0).abs() < 0.02, "{weight}");
    }
}

#[test]
fn hits_have_the_density_of_samples() {
    let emitters = [
        emitter(EmitterKind::Constant { radiance: [0.5; 3] }, Transform::IDENTITY),
        emitter(EmitterKind::Envmap { image: picture(7, 4), scale: 1.0 }, rotation()),
        point([0.0, 3.0, 0.0], 2.0),
    ];
    let forms = [quad(), Form::Sphere(Vec3::new(1.0, 2.0, -0.5), 0.9)];
    let lights = lights(&emitters, &forms.map(|f| (f, [1.0; 3])));
    let mut random = Random::new(3);
    let mut seen = [0; 5];
    for _ in 0..20_000 {
        let x = Vec3::from_array([0; 3].map(|_| 4.0 * random.f32() - 2.0));
        let Some(s) = sample(&lights, x, &mut random) else { continue };
        seen[s.emitter.0 as usize] += 1;
        let expected = match s.emitter.0 {
            0 | 1 => lights.pdf_escape(s.direction).0,
            2 => lights.point_selection_pdf(x, s.emitter),
            id => lights.pdf_hit(x, &surface(id - 3, s.position, s.normal)).0,
        };
        assert!((s.pdf.0 / expected - 1.0).abs() < 1e-3, "{s:?} {expected}");
        assert_eq!(s.delta, s.emitter.0 == 2);
        assert!((x + s.direction * s.distance).distance(s.position) < 1e-4 * (1.0 + s.distance));
    }
    assert!(seen.iter().all(|&n| n > 100), "{seen:?}");
}
