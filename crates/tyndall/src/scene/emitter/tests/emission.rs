//! Light that leaves emitters carries their power and arrives where emitter sampling says.

use super::*;
use crate::Spectrum;
use crate::math::{Frame, warp};
use crate::scene::emitter::{Emission, Emitter, EmitterId};
use std::f64::consts::{PI, TAU};
use tyndall_testkit::chi2;
use tyndall_testkit::quadrature::integrate;
use tyndall_testkit::ztest::{Moments, sidak, two_sided_p};

const TESTS: usize = 80;

fn emit(lights: &Lights, random: &mut Random) -> Option<Emission> {
    let choice = random.f32();
    lights.sample_emission(choice, Vec2::from_array(random.f32x2()), Vec2::from_array(random.f32x2()))
}

/// Emitters, and emitting shapes with their sampling weights.
fn lit(emitters: &[EmitterDesc], shapes: &[(Form, TextureDesc, f32)]) -> Lights {
    let descs: Vec<_> = shapes
        .iter()
        .map(|(_, radiance, weight)| AreaEmitterDesc { radiance: radiance.clone(), sampling_weight: *weight })
        .collect();
    let areas = (0..).zip(&descs).map(|(shape, desc)| ("shape", shape, desc));
    let forms: Vec<_> = shapes.iter().map(|(form, ..)| *form).collect();
    Lights::new(emitters, areas, geometry(&forms)).unwrap()
}

fn lamp(form: Form, radiance: TextureDesc) -> Lights {
    lit(&[], &[(form, radiance, 1.0)])
}

/// One emitter around a shape that does not emit, with the centre and the radius of the sphere around it.
fn around(form: Form, kind: EmitterKind) -> (Lights, Vec3, f32) {
    let bounds = geometry(&[form]).bounds();
    let lights = lights(&[emitter(kind, rotation())], &[(form, [0.0; 3])]);
    (lights, bounds.centre(), 0.5 * bounds.extent().length())
}

fn slab() -> Form {
    Form::Parallelogram(Vec3::new(-1.0, -0.5, 1.0), Vec3::new(2.0, 0.0, 0.3), Vec3::new(0.1, -1.5, 0.4))
}

/// Depends on the first texture coordinate only: bright up to a half, dim beyond.
fn halves() -> TextureDesc {
    TextureDesc::Checkerboard {
        color0: Box::new(TextureDesc::Constant([8.0, 2.0, 1.0])),
        color1: Box::new(TextureDesc::Constant([0.0, 1.0, 0.5])),
        to_uv: Transform::scale([1.0, 0.0, 1.0]),
    }
}

/// Four rows of pixels without interpolation.
fn stripes() -> TextureDesc {
    let pixels = vec![[4.0, 0.0, 1.0], [1.0, 2.0, 0.0], [0.0, 1.0, 3.0], [2.0, 5.0, 0.0]];
    let image = Arc::new(ImageDesc { width: 1, height: 4, pixels });
    TextureDesc::Bitmap { image, filter: Filter::Nearest, wrap: Wrap::Clamp, to_uv: Transform::IDENTITY }
}

fn mean_pixel(image: &ImageDesc) -> [f64; 3] {
    [0, 1, 2].map(|c| image.pixels.iter().map(|p| f64::from(p[c])).sum::<f64>() / image.pixels.len() as f64)
}

fn spot(cutoff_angle: f32, beam_width: f32, texture: Option<TextureDesc>) -> EmitterKind {
    EmitterKind::Spot { intensity: [2.0, 3.0, 4.0], cutoff_angle, beam_width, texture }
}

fn projector() -> EmitterKind {
    EmitterKind::Projector { irradiance: bitmap(picture(5, 4)), scale: 2.5, fov_x: 60.0, aspect: 1.25 }
}

fn envmap() -> EmitterKind {
    EmitterKind::Envmap { image: picture(8, 5), scale: 1.5 }
}

/// The mean flux of light paths and the stated power are `truth`, W.
#[track_caller]
fn assert_power(lights: &Lights, truth: [f64; 3]) {
    let mut random = Random::new(31);
    let mut flux = [Moments::default(); 3];
    for _ in 0..200_000 {
        let rgb = emit(lights, &mut random).map_or([0.0; 3], |e| e.flux.to_rgb());
        flux.iter_mut().zip(rgb).for_each(|(moments, f)| moments.push(f64::from(f)));
    }
    for (c, truth) in truth.into_iter().enumerate() {
        assert!(flux[c].standard_error() <= 0.01 * truth, "{:?}", flux[c]);
        // Without any noise only rounding is left.
        let exact = (flux[c].mean() - truth).abs() <= 1e-4 * truth;
        let p = two_sided_p(flux[c].z(truth));
        assert!(exact || p >= sidak(SIGNIFICANCE, 3 * TESTS), "channel {c}: {:?} is not {truth}", flux[c]);
        let stated = f64::from(lights.power()[c]);
        assert!((stated / truth - 1.0).abs() < 0.01 || stated == truth, "channel {c}: {stated} is not {truth}");
    }
}

#[test]
fn power_of_area_lights() {
    let radiance = [1.0, 2.0, 3.0];
    let Form::Parallelogram(_, a, b) = slab() else { return };
    let ball = Form::Sphere(Vec3::new(1.0, 2.0, -0.5), 0.5);
    let areas = [
        (slab(), f64::from(a.cross(b).length())),
        (Form::Rectangle, 4.0),
        (ball, PI),
        (Form::Shell(Vec3::ONE, 1.5), 9.0 * PI),
        (Form::Disk, PI),
        (Form::Tube, PI),
        (Form::Cube, 24.0),
    ];
    for (form, area) in areas {
        assert_power(&lamp(form, TextureDesc::Constant(radiance)), [1.0, 2.0, 3.0].map(|l| l * PI * area));
    }
    // Textures: the last two are not even over the area.
    let image = picture(5, 4);
    assert_power(&lamp(Form::Rectangle, bitmap(image.clone())), mean_pixel(&image).map(|l| 4.0 * PI * l));
    assert_power(&lamp(Form::Disk, halves()), [2.0, 1.25, 0.625].map(|l| PI * PI * l));
    let (polar, middle) = (0.5 - 0.125_f64.sqrt(), 0.125_f64.sqrt());
    let mean = [4.0 * polar + middle + 2.0 * polar, 3.0 * middle + 5.0 * polar, polar + 3.0 * middle];
    assert_power(&lamp(ball, stripes()), mean.map(|l| PI * PI * l));
}

#[test]
fn power_of_points() {
    assert_power(&lights(&[point([1.0, 2.0, 3.0], 2.0)], &[]), [8.0 * PI; 3]);
    for (cutoff, beam) in [(40.0, 20.0), (30.0, 30.0), (90.0, 0.0), (120.0, 90.0), (180.0, 135.0), (0.02, 0.01)] {
        let [c, b] = [cutoff, beam].map(|a: f32| f64::from(a).to_radians());
        let falling = |angle: f64| (c - angle) / (c - b) * angle.sin();
        let rim = if cutoff > beam { integrate(&falling, b, c, 1e-16) } else { 0.0 };
        let solid_angle = TAU * (2.0 * (0.5 * b).sin().powi(2) + rim);
        let lights = lights(&[emitter(spot(cutoff, beam, None), look_at())], &[]);
        assert_power(&lights, [2.0, 3.0, 4.0].map(|i| i * solid_angle));
    }
    let image = picture(5, 4);
    let size = (30_f64.to_radians().tan() * 2.0).powi(2) / 1.25;
    let lights = lights(&[emitter(projector(), look_at())], &[]);
    assert_power(&lights, mean_pixel(&image).map(|e| 2.5 * PI * size * e));
}

#[test]
fn power_of_textured_spots() {
    let lights = lights(&[emitter(spot(50.0, 20.0, Some(bitmap(picture(5, 4)))), look_at())], &[]);
    let Emitter::Spot(spot) = &lights.emitters()[0] else { return };
    let frame = Frame::from_normal(-Vec3::new(1.0, 2.0, 3.0).normalize());
    let n = 600;
    let step = 50_f64.to_radians() / f64::from(n);
    let mut sum = [0.0; 3];
    for (i, j) in (0..n * n).map(|k| (k / n, k % n)) {
        let (sin, cos) = (step * (f64::from(i) + 0.5)).sin_cos();
        let (sin_phi, cos_phi) = (TAU * (f64::from(j) + 0.5) / f64::from(n)).sin_cos();
        let direction = frame.to_world(Vec3::new((sin * cos_phi) as f32, (sin * sin_phi) as f32, cos as f32));
        for (total, channel) in sum.iter_mut().zip(spot.intensity(direction).to_rgb()) {
            *total += f64::from(channel) * sin * step * TAU / f64::from(n);
        }
    }
    assert_power(&lights, sum);
}

#[test]
fn power_from_infinity() {
    let through = |radius: f32| PI * f64::from(radius).powi(2);
    let (lights, _, radius) = around(slab(), EmitterKind::Directional { irradiance: [1.0, 2.0, 0.0] });
    assert_power(&lights, [1.0, 2.0, 0.0].map(|e| e * through(radius)));
    let (lights, _, radius) = around(slab(), EmitterKind::Constant { radiance: [1.0, 2.0, 0.0] });
    assert_power(&lights, [1.0, 2.0, 0.0].map(|l| 4.0 * PI * l * through(radius)));
    for image in [picture(8, 5), picture(3, 2), picture(4, 1)] {
        let (lights, _, radius) = around(slab(), EmitterKind::Envmap { image, scale: 1.5 });
        let mut sum = [0.0; 3];
        let n = 1 << 10;
        for (i, j) in (0..n * n).map(|k| (k / n, k % n)) {
            let u = Vec2::new((i as f32 + 0.5) / n as f32, (j as f32 + 0.5) / n as f32);
            let seen = lights.radiance_escape(warp::square_to_sphere(u)).to_rgb();
            sum.iter_mut().zip(seen).for_each(|(total, l)| *total += f64::from(l) * 4.0 * PI / f64::from(n * n));
        }
        assert_power(&lights, sum.map(|fluence| fluence * through(radius)));
    }
}

/// A round receiver.
#[derive(Clone, Copy)]
struct Patch {
    centre: Vec3,
    normal: Vec3,
    radius: f32,
}

impl Patch {
    fn new(centre: [f32; 3], normal: [f32; 3], radius: f32) -> Self {
        Self { centre: Vec3::from_array(centre), normal: Vec3::from_array(normal).normalize(), radius }
    }

    /// Whether the ray arrives at the front.
    fn receives(&self, ray: &Ray) -> bool {
        let cos = ray.direction.dot(self.normal);
        let t = (self.centre - ray.origin).dot(self.normal) / cos;
        cos < 0.0 && t > 0.0 && ray.at(t).distance(self.centre) < self.radius
    }

    /// The mean irradiance from counted light paths is that from emitter sampling.
    #[track_caller]
    fn assert(&self, lights: &Lights) {
        let mix = |s: Spectrum| 0.2 * f64::from(s[0]) + 0.3 * f64::from(s[1]) + 0.5 * f64::from(s[2]);
        let area = PI * f64::from(self.radius).powi(2);
        let frame = Frame::from_normal(self.normal);
        let mut random = Random::new(32);
        let [mut counted, mut sampled] = [Moments::default(); 2];
        for _ in 0..800_000 {
            let light = emit(lights, &mut random).filter(|e| self.receives(&e.ray));
            counted.push(light.map_or(0.0, |e| mix(e.flux) / area));
        }
        for _ in 0..200_000 {
            let at = self.radius * warp::square_to_disk(Vec2::from_array(random.f32x2()));
            let seen = sample(lights, self.centre + frame.to_world(at.extend(0.0)), &mut random);
            let cos = |s: &EmitterSample| f64::from(s.direction.dot(self.normal).max(0.0) / s.pdf.0);
            sampled.push(seen.map_or(0.0, |s| mix(s.radiance) * cos(&s)));
        }
        assert!(counted.standard_error() < 0.01 * counted.mean(), "{counted:?}");
        assert!(sampled.standard_error() < 0.01 * sampled.mean(), "{sampled:?}");
        let z = counted.two_sample_z(&sampled);
        assert!(two_sided_p(z) >= sidak(SIGNIFICANCE, TESTS), "{counted:?} {sampled:?} z = {z}");
    }
}

#[test]
fn arrives_from_area_lights() {
    let above = Patch::new([0.3, 0.2, 1.0], [-0.2, 0.1, -1.0], 0.8);
    above.assert(&lamp(Form::Rectangle, bitmap(picture(5, 4))));
    above.assert(&lamp(Form::Disk, halves()));
    let beside = Patch::new([2.0, -1.0, 0.7], [-1.0, 0.6, 0.1], 0.8);
    beside.assert(&lamp(Form::Sphere(Vec3::new(0.2, 0.0, 0.5), 0.9), stripes()));
    beside.assert(&lamp(Form::Tube, halves()));
    Patch::new([2.5, -1.0, 0.7], [-1.0, 0.6, 0.1], 0.8).assert(&lamp(Form::Cube, TextureDesc::grey(1.0)));
    // Inside a sphere that emits inwards; a texture breaks the symmetry.
    Patch::new([0.2, 0.1, -0.3], [-1.0, 0.6, 0.1], 0.5).assert(&lamp(Form::Shell(Vec3::ZERO, 1.0), stripes()));
}

#[test]
fn arrives_from_points() {
    let patch = Patch::new([0.2, 0.1, 0.0], [1.0, 2.0, 2.0], 1.2);
    patch.assert(&lights(&[point([1.0, 2.0, 1.0], 2.0)], &[]));
    let kinds = [
        spot(25.0, 10.0, None),
        spot(40.0, 40.0, None),
        spot(120.0, 20.0, None),
        spot(30.0, 12.0, Some(bitmap(picture(5, 4)))),
        projector(),
    ];
    for kind in kinds {
        patch.assert(&lights(&[emitter(kind, look_at())], &[]));
    }
}

#[test]
fn arrives_from_infinity() {
    let kinds = || {
        let one = Arc::new(ImageDesc { width: 2, height: 1, pixels: vec![[1.0; 3], [0.0; 3]] });
        let directional = EmitterKind::Directional { irradiance: [1.0, 2.0, 0.0] };
        let constant = EmitterKind::Constant { radiance: [1.0, 2.0, 0.0] };
        [directional, constant, envmap(), EmitterKind::Envmap { image: one, scale: 1.0 }]
    };
    let far = Form::Parallelogram(Vec3::new(1e4, -2e4, 3e3), Vec3::X, Vec3::new(0.0, 0.3, 0.8));
    for form in [slab(), far] {
        for kind in kinds() {
            let (lights, centre, radius) = around(form, kind);
            // Out to the rim of the sphere.
            for normal in [[0.3, -0.5, -1.0], [-1.0, 0.2, 0.1]] {
                let out = Patch::new([0.0; 3], normal, 0.0).normal;
                Patch { centre: centre + 0.9 * radius * out, normal: out, radius: 0.43 * radius }.assert(&lights);
                Patch { centre: centre - 0.9 * radius * out, normal: out, radius: 0.43 * radius }.assert(&lights);
            }
        }
    }
}

#[test]
fn arrives_from_many() {
    let emitters = [
        EmitterDesc { sampling_weight: 3.0, ..emitter(spot(40.0, 10.0, None), look_at()) },
        emitter(EmitterKind::Constant { radiance: [0.1, 0.0, 0.3] }, Transform::IDENTITY),
        EmitterDesc { sampling_weight: 0.5, ..emitter(envmap(), rotation()) },
        emitter(EmitterKind::Directional { irradiance: [1.0; 3] }, look_at()),
        point([0.0, 0.0, 2.0], 0.7),
        EmitterDesc { sampling_weight: 0.0, ..point([0.0, 0.0, 3.0], 100.0) },
    ];
    let shapes = [
        (Form::Rectangle, bitmap(picture(5, 4)), 2.0),
        (Form::Sphere(Vec3::new(0.0, 0.0, 2.5), 0.4), stripes(), 1.0),
        (Form::Disk, TextureDesc::grey(0.0), 1.0),
    ];
    let lights = lit(&emitters, &shapes);
    Patch::new([0.3, 0.2, 1.0], [0.2, 0.1, 1.0], 0.5).assert(&lights);
    Patch::new([0.3, 0.2, 1.0], [-0.2, 0.1, -1.0], 0.5).assert(&lights);
}

#[test]
fn emitters_are_chosen_by_power() {
    let emitters = [
        EmitterDesc { sampling_weight: 3.0, ..point([0.0; 3], 1.0) },
        point([0.0; 3], 0.0),
        EmitterDesc { sampling_weight: 0.0, ..point([0.0; 3], 9.0) },
        point([0.0; 3], 2.0),
    ];
    let lights = lit(&emitters, &[(Form::Rectangle, TextureDesc::grey(1.0), 1.0)]);
    assert!((lights.power()[0] / (12.0 * 4.0 + 4.0) - std::f32::consts::PI).abs() < 1e-5);
    let expected = [0.5, 0.0, 0.0, 1.0 / 3.0, 1.0 / 6.0];
    let mut counts = [0; 5];
    let n = 1 << 16;
    for i in 0..n {
        let choice = (i as f32 + 0.5) / n as f32;
        let emission = lights.sample_emission(choice, Vec2::splat(0.3), Vec2::splat(0.4)).unwrap();
        let id = emission.emitter.0 as usize;
        assert!((emission.selection - expected[id]).abs() < 1e-6, "{emission:?}");
        counts[id] += 1;
    }
    assert!(counts.iter().zip(expected).all(|(count, p)| (*count as f32 - p * n as f32).abs() <= 2.0), "{counts:?}");
    let dark = lit(&emitters[1..2], &[]);
    assert!(dark.sample_emission(0.5, Vec2::ZERO, Vec2::ZERO).is_none() && dark.power().is_black());
}

/// Directions follow `pdf`, which is what samples say.
#[track_caller]
fn assert_directions(lights: &Lights, pdf: impl Fn(Vec3) -> f64) {
    let draw = |choice, u| lights.sample_emission(choice, Vec2::new(0.3, 0.8), Vec2::from_array(u));
    let mut random = Random::new(33);
    for _ in 0..10_000 {
        let Some(e) = draw(0.5, random.f32x2()) else { continue };
        let expected = pdf(e.ray.direction);
        assert!((f64::from(e.direction_density.0) / expected - 1.0).abs() < 2e-3, "{e:?} {expected}");
    }
    let direction = |choice, u| draw(choice, u).map(|e| e.ray.direction.to_array());
    chi2::sphere(direction, |d| pdf(Vec3::from_array(d)), 200_000, 34).assert(SIGNIFICANCE, TESTS);
}

#[test]
fn directions() {
    assert_directions(&lamp(Form::Rectangle, TextureDesc::grey(1.0)), |d| f64::from(d.z.max(0.0)) / PI);
    assert_directions(&lights(&[point([0.0; 3], 1.0)], &[]), |_| 0.25 / PI);
    let (lights, ..) = around(slab(), envmap());
    assert_directions(&lights, |d| f64::from(lights.pdf_escape(-d).0));
}

/// Where a spot's light leaves: over one minus the cosine, as a part of that at the cutoff, and the azimuth.
#[test]
fn directions_of_spots() {
    let frame = Frame::from_normal(-Vec3::new(1.0, 2.0, 3.0).normalize());
    for (cutoff, beam) in [(50.0, 20.0), (35.0, 0.0), (150.0, 60.0), (30.0, 30.0)] {
        let [outer, inner] = [cutoff, beam].map(|a: f32| 1.0 - f64::from(a).to_radians().cos());
        let falls = cutoff <= 90.0;
        let total = (inner + (outer - inner) * if falls { 0.5 } else { 1.0 }) / outer;
        let density =
            |x: f64| if falls && x * outer > inner { (1.0 - x) * outer / (outer - inner) } else { 1.0 } / total;
        let lights = lights(&[emitter(spot(cutoff, beam, None), look_at())], &[]);
        let in_cone = |u| {
            let e = lights.sample_emission(0.5, Vec2::ZERO, Vec2::from_array(u))?;
            let d = frame.to_local(e.ray.direction);
            let x = (1.0 - d.z) / outer as f32;
            let expected = density(f64::from(x)) / (TAU * outer);
            // Near the cutoff rounding of the direction shows.
            let error = (f64::from(e.direction_density.0) - expected).abs();
            assert!(error < 1e-4 * TAU.recip() / outer, "{e:?} {expected}");
            Some([x.min(1.0), (d.y.atan2(d.x) / std::f32::consts::TAU).rem_euclid(1.0)])
        };
        chi2::square(in_cone, |[x, _]| density(f64::from(x)), 200_000, 39).assert(SIGNIFICANCE, TESTS);
    }
}

#[test]
fn pictures_are_projected_evenly() {
    let irradiance = TextureDesc::grey(1.0);
    let kind = EmitterKind::Projector { irradiance, scale: 1.0, fov_x: 60.0, aspect: 1.25 };
    let lights = lights(&[emitter(kind, Transform::IDENTITY)], &[]);
    let half = 30_f32.to_radians().tan() * Vec2::new(1.0, 0.8);
    let on_picture = |u| {
        let e = lights.sample_emission(0.5, Vec2::ZERO, Vec2::from_array(u))?;
        let d = e.ray.direction;
        let density = f64::from(e.direction_density.0 * d.z.powi(3) * 4.0 * half.x * half.y);
        assert!((density - 1.0).abs() < 1e-5, "{e:?}");
        Some((0.5 + 0.5 * Vec2::new(d.x, d.y) / (d.z * half)).clamp(Vec2::ZERO, Vec2::ONE).to_array())
    };
    chi2::square(on_picture, |_| 1.0, 100_000, 35).assert(SIGNIFICANCE, TESTS);
}

#[test]
fn positions() {
    let lights = lamp(Form::Rectangle, TextureDesc::grey(1.0));
    let on_square = |u| {
        let e = lights.sample_emission(0.5, Vec2::from_array(u), Vec2::splat(0.3))?;
        assert!((e.position_density.0 - 0.25).abs() < 1e-6 && e.normal == Vec3::Z);
        let p = e.ray.origin;
        Some((0.5 + 0.5 * Vec2::new(p.x, p.y)).clamp(Vec2::ZERO, Vec2::ONE).to_array())
    };
    chi2::square(on_square, |_| 1.0, 100_000, 36).assert(SIGNIFICANCE, TESTS);
    let (lights, centre, radius) = around(slab(), EmitterKind::Directional { irradiance: [1.0; 3] });
    let on_disk = |u| {
        let e = lights.sample_emission(0.5, Vec2::from_array(u), Vec2::splat(0.3))?;
        assert!(e.delta_direction && !e.delta_position);
        let p = Frame::from_normal(e.ray.direction).to_local(e.ray.origin - centre);
        let r2 = Vec2::new(p.x, p.y).length_squared() * std::f32::consts::PI * e.position_density.0;
        assert!(e.position_density.0 * std::f32::consts::PI * radius * radius < 1.0);
        Some([r2.min(1.0), (p.y.atan2(p.x) / std::f32::consts::TAU).rem_euclid(1.0)])
    };
    chi2::square(on_disk, |_| 1.0, 100_000, 37).assert(SIGNIFICANCE, TESTS);
}

#[test]
fn starts() {
    let mut random = Random::new(38);
    // Just off the surface: no ray meets the shape that it leaves.
    let away = Vec3::new(1e4, -2e4, 3e3);
    let far = Form::Parallelogram(away, Vec3::new(1.0, 0.2, 0.0), Vec3::new(0.0, 0.3, 0.8));
    for form in [slab(), far, Form::Sphere(away, 0.5), Form::Disk, Form::Tube, Form::Cube] {
        let (lights, shapes) = (lamp(form, TextureDesc::grey(1.0)), geometry(&[form]));
        for _ in 0..20_000 {
            let Some(e) = emit(&lights, &mut random) else { continue };
            assert!(!shapes.occluded(&e.ray, f32::INFINITY), "{e:?}");
            assert!(e.ray.direction.dot(e.normal) > 0.0 && (e.ray.direction.length() - 1.0).abs() < 1e-5);
        }
    }
    // Not through the wall of a sphere that emits inwards.
    let (lights, shapes) = (lamp(Form::Shell(away, 0.5), TextureDesc::grey(1.0)), geometry(&[Form::Shell(away, 0.5)]));
    for _ in 0..20_000 {
        let Some(e) = emit(&lights, &mut random) else { continue };
        let hits: Vec<_> = hits(&shapes, e.ray).collect();
        assert!(hits.len() == 1 && hits[0].position.distance(e.ray.origin) < 1.01, "{e:?}");
    }
    // Outside the sphere, even where that is small and far away.
    for form in [slab(), far] {
        for kind in [EmitterKind::Directional { irradiance: [1.0; 3] }, envmap()] {
            let (lights, centre, radius) = around(form, kind);
            for _ in 0..20_000 {
                let Some(e) = emit(&lights, &mut random) else { continue };
                let out = e.ray.origin.as_dvec3() - centre.as_dvec3();
                assert!(out.length() > f64::from(radius) && out.dot(e.ray.direction.as_dvec3()) < 0.0, "{e:?}");
                assert!(e.normal == Vec3::ZERO && e.emitter == EmitterId(0));
            }
        }
    }
}
