//! Radiance 1 everywhere: chromatic, heterogeneous, glass-bounded and nested media.

use crate::blur::Blur;
use crate::{Measured, Way, common};
use tyndall_testkit::corpus::{Case, Furnace, furnace, furnace_room};
use tyndall_testkit::random::Random;
use tyndall_testkit::ztest::sidak;

/// Where a straight ray runs, and through what: the share of its light that a blur loses because it looks for light
/// behind boundaries is an integral over it.
struct Run {
    origin: [f64; 3],
    direction: [f64; 3],
    length: f64,
}

fn along([a, b, c]: [f64; 3], t: f64, [x, y, z]: [f64; 3]) -> [f64; 3] {
    [a + t * x, b + t * y, c + t * z]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = v.iter().map(|x| x * x).sum::<f64>().sqrt();
    v.map(|x| x / length)
}

/// An offset distributed as the blur is, of radius 1, around a ray along `e` for light from everywhere.
fn offset(blur: Blur, e: [f64; 3], random: &mut Random) -> [f64; 3] {
    let mut direction = || unit([random.normal(), random.normal(), random.normal()]);
    let (light, other) = (direction(), direction());
    let axis = match blur {
        Blur::Ball => other,
        Blur::AcrossQuery => unit(cross(e, other)),
        Blur::AcrossBeam => unit(cross(light, other)),
        Blur::CommonNormal => unit(cross(e, light)),
    };
    let dimension = blur.dimension();
    // Epanechnikov's distance by rejection: density proportional to x^(d-1) (1 - x^2).
    let distance = loop {
        let x = random.f64();
        if random.f64() < x.powi(dimension - 1) * (1.0 - x * x) {
            break x;
        }
    };
    axis.map(|x| x * distance)
}

impl Run {
    /// Light that a blur of that radius does not see, where `medium` gives the number of the medium and the extinction at
    /// a place.
    fn lost(&self, blur: Blur, radius: f64, medium: &impl Fn([f64; 3]) -> (u32, f64)) -> f64 {
        const STEPS: u32 = 200_000;
        let mut random = Random::new(5);
        let step = self.length / f64::from(STEPS);
        let (mut depth, mut lost) = (0.0, 0.0);
        for i in 0..STEPS {
            let x = along(self.origin, (f64::from(i) + 0.5) * step, self.direction);
            let (here, sigma) = medium(x);
            let there = medium(along(x, radius, offset(blur, self.direction, &mut random))).0;
            if there != here {
                lost += (-depth - 0.5 * sigma * step).exp() * sigma * step;
            }
            depth += sigma * step;
        }
        lost
    }
}

/// The camera's ray from (1, 0.7, 5) to (0.2, 0.1, 0) within the box [-1, 1]^3, bent by an index of refraction.
fn through_the_box(ior: f64) -> Run {
    let d = unit([-0.8, -0.6, -5.0]);
    let origin = along([1.0, 0.7, 5.0], 4.0 / -d[2], d);
    let (x, y) = (d[0] / ior, d[1] / ior);
    let direction = [x, y, -(1.0 - x * x - y * y).sqrt()];
    Run { origin, direction, length: 2.0 / -direction[2] }
}

fn in_box(x: [f64; 3]) -> bool {
    x.iter().all(|c| c.abs() < 1.0)
}

fn in_ball(x: [f64; 3]) -> bool {
    x.iter().map(|c| c * c).sum::<f64>() < 0.25
}

/// The lens of the furnace as a ball of another medium.
fn nested() -> Case {
    let mut case = furnace("nested", Furnace { lens: true, ..Furnace::default() });
    let (from, until) = ("<bsdf type=\"dielectric\">", "</bsdf><ref name=\"exterior\" id=\"fog\"/>");
    let start = case.xml.find(from).unwrap();
    let end = start + case.xml[start..].find(until).unwrap() + until.len();
    let boundary = "<bsdf type=\"null\"/><ref name=\"exterior\" id=\"fog\"/><ref name=\"interior\" id=\"core\"/>";
    case.xml.replace_range(start..end, boundary);
    let core = "<medium type=\"homogeneous\" id=\"core\"><rgb name=\"sigma_t\" value=\"0.5, 1, 0.2\"/>\
                <float name=\"scale\" value=\"4\"/><rgb name=\"albedo\" value=\"1\"/>\
                <phase type=\"hg\"><float name=\"g\" value=\"0.4\"/></phase></medium>";
    let at = case.xml.find("<shape").unwrap();
    case.xml.insert_str(at, core);
    case
}

const WAYS: [(&str, &str, f64); 6] = [
    ("bre", "", 0.1),
    ("beam-beam-2d-query", "short", 0.1),
    ("point-beam-2d", "long", 0.05),
    ("beam-beam-2d-beam", "long", 0.05),
    ("beam-beam-1d", "short", 0.05),
    ("beam-beam-1d", "long", 0.05),
];

/// Renders the furnace with some ways; `lost` is the light that a blur of a radius loses, per channel. The standard error is
/// at most one per cent; for more than a few ways it is aimed at half of that, as first passes of forward scattering look
/// better than they are.
fn check(case: &Case, ways: &[(&str, &str, f64)], lost: impl Fn(Blur, f64) -> [f64; 3]) {
    let precision = 0.01;
    let aim = if ways.len() > 2 { 0.5 } else { 0.8 };
    let scene = common::scene(case, true);
    for (seed, (name, extent, radius)) in (1..).zip(ways) {
        let way = Way::find(name, extent);
        let mut set = way.parameters(*radius, -1);
        set.push(("photons", way.photons().to_string()));
        set.push(("surface_radius", "0.15".into()));
        let truth = lost(way.blur, *radius).map(|lost| 1.0 - lost);
        let found = Measured::precisely(&scene, way.name, &set, seed, truth, aim * precision);
        let what = format!("{} {}, {:.2} % lost", case.name, way.title(), 100.0 * (1.0 - truth[1]));
        found.assert(&what, truth, precision, sidak(0.01, 200));
    }
}

fn boxed(sigma: [f64; 3], ior: f64) -> impl Fn(Blur, f64) -> [f64; 3] {
    move |blur, radius| sigma.map(|s| through_the_box(ior).lost(blur, radius, &|x| (u32::from(in_box(x)), s)))
}

#[test]
fn walls_that_are_nothing() {
    let ways = [("beam-beam-1d", "long", 0.05), ("bre", "", 0.1)];
    check(&furnace("isotropic", Furnace::default()), &ways, boxed([1.0; 3], 1.0));
    let chromatic = [3.0, 1.0, 0.3];
    let case = furnace("chromatic", Furnace { sigma_t: chromatic, ..Furnace::default() });
    check(&case, &ways[..1], boxed(chromatic, 1.0));
}

/// Nothing is lost at walls: the common normal lies in them to within the ray's slope.
#[test]
fn a_room_whose_walls_glow() {
    let nothing = |_, _| [0.0; 3];
    check(&furnace_room(0.5), &[("beam-beam-1d", "short", 0.05)], nothing);
}

/// Every way in every furnace: `cargo test --release -p tyndall-formats --test photons -- --ignored --nocapture
/// every_way`, half an hour, or with a furnace's name for one.
mod every_way {
    use super::*;

    #[test]
    #[ignore = "up to eight minutes"]
    fn isotropic() {
        check(&furnace("isotropic", Furnace::default()), &WAYS, boxed([1.0; 3], 1.0));
    }

    #[test]
    #[ignore = "up to eight minutes"]
    fn chromatic() {
        let sigma_t = [3.0, 1.0, 0.3];
        check(&furnace("chromatic", Furnace { sigma_t, ..Furnace::default() }), &WAYS, boxed(sigma_t, 1.0));
    }

    #[test]
    #[ignore = "up to eight minutes"]
    fn glass() {
        check(&furnace("glass", Furnace { glass: true, ..Furnace::default() }), &WAYS, boxed([1.0; 3], 1.5));
    }

    #[test]
    #[ignore = "up to eight minutes"]
    fn forward() {
        check(&furnace("forward", Furnace { g: 0.7, ..Furnace::default() }), &WAYS, boxed([1.0; 3], 1.0));
    }

    /// The density at the front face, which the camera meets first, and at the back.
    #[test]
    #[ignore = "up to eight minutes"]
    fn ramp() {
        let ramp = |blur, radius| {
            let density = |z: f64| {
                let voxels = [0.05, 0.1, 0.4, 1.0, 0.6, 0.0, 0.0, 0.3];
                let u = ((z + 1.0) * 4.0 - 0.5).clamp(0.0, 7.0);
                let (i, f) = ((u as usize).min(6), u - u.floor());
                let f = if u >= 7.0 { 1.0 } else { f };
                3.0 * (voxels[i] * (1.0 - f) + voxels[i + 1] * f)
            };
            [through_the_box(1.0).lost(blur, radius, &|x| (u32::from(in_box(x)), density(x[2]))); 3]
        };
        check(&furnace("ramp", Furnace { ramp: true, ..Furnace::default() }), &WAYS, ramp);
    }

    #[test]
    #[ignore = "up to eight minutes"]
    fn nests() {
        let lost = |blur, radius| {
            [2.0, 4.0, 0.8].map(|core| {
                let medium = |x| if in_ball(x) { (2, core) } else { (u32::from(in_box(x)), 1.0) };
                through_the_box(1.0).lost(blur, radius, &medium)
            })
        };
        check(&nested(), &WAYS, lost);
    }
}
