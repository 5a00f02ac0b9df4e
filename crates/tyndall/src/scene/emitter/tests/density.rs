//! Samples follow the densities that are claimed for them.

use super::*;
use tyndall_testkit::chi2::{self, Chi2Outcome};

const TESTS: usize = 8;
const SAMPLES: usize = 200_000;

fn chi2_of(emitters: &[EmitterDesc], shapes: &[(Form, Rgb)], x: Vec3) -> Chi2Outcome {
    let lights = lights(emitters, shapes);
    let stand_in = StandIn(shapes.iter().map(|(form, _)| *form).collect());
    chi2::sphere(
        |choice, u| lights.sample(x, choice, Vec2::from_array(u)).map(|s| s.direction.to_array()),
        |d| pdf(&lights, &stand_in, x, Vec3::from_array(d)),
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
}

fn quad_faces(x: Vec3) -> bool {
    let Form::Parallelogram(p, a, b) = quad() else { return false };
    (x - p).dot(a.cross(b)) > 0.0
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
    let value = |p: usize| 1.0 + (p % width * 2 / width) as f32 * 0.0 + (p / width) as f32 / height as f32;
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
            id => lights.pdf_hit(x, &stand_in::surface(id - 3, s.position, s.normal)).0,
        };
        assert!((s.pdf.0 / expected - 1.0).abs() < 1e-3, "{s:?} {expected}");
        assert_eq!(s.delta, s.emitter.0 == 2);
        assert!((x + s.direction * s.distance).distance(s.position) < 1e-4 * (1.0 + s.distance));
    }
    assert!(seen.iter().all(|&n| n > 100), "{seen:?}");
}
