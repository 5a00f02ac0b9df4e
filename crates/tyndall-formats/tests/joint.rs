//! Joint importance sampling against closed forms and against path tracing.

mod common;

use common::{agrees, integrator, max_depth, mean, scene};
use tyndall::render::Picture;
use tyndall::{Rendering, Settings};
use tyndall_testkit::corpus::{self, CHROMATIC, Case, Infinite, infinite, ramp_volume};
use tyndall_testkit::ztest::{Moments, sidak, two_sided_p};

#[test]
fn whole_corpus() {
    let cases = corpus::all();
    for case in &cases {
        let set = [("max_depth", max_depth(case)), ("rr_depth", "5".into())];
        let (mean, error) = mean(&scene(case, false), integrator("jis", &set), 1 << 18, case.radiance, 0.005);
        for c in 0..3 {
            let truth = case.radiance[c];
            let (off, noise) = (100.0 * (mean[c] / truth - 1.0), 100.0 * error[c] / truth);
            let line = format!("{}, channel {c}: {off:+.2} +- {noise:.2} %", case.name);
            println!("{line}");
            assert!(error[c] <= 0.01 * truth, "{line}: no test");
            assert!(agrees(mean[c], error[c].hypot(case.error), truth, sidak(0.01, 3 * cases.len())), "{line}");
        }
    }
}

/// Light scattered twice alone, where joint sampling has the largest part.
#[test]
fn double_scattering() {
    let orders = |n, p: &Infinite| infinite("double", &Infinite { orders: Some(n), ..p.clone() });
    let near = Infinite { h: 0.1, ..Infinite::default() };
    let cases: Vec<_> = [Infinite::default(), near, CHROMATIC]
        .iter()
        .map(|p| {
            let (both, single) = (orders(2, p), orders(1, p));
            let truth = [0, 1, 2].map(|c| both.radiance[c] - single.radiance[c]);
            (both, truth, 0.0)
        })
        .collect();
    // The answers for Henyey-Greenstein are those of 10^9 random walks.
    let forward = |g, truth: f64| {
        let p = Infinite { g, albedo: [1.0; 3], ..Infinite::default() };
        (orders(1, &p), [truth; 3], 0.001 * truth)
    };
    let cases = [cases, vec![forward(0.5, 3.7948e-3), forward(0.8, 5.606e-3), forward(-0.5, 2.4443e-3)]].concat();
    for (case, truth, uncertain) in &cases {
        let set = [("max_depth", "3".to_string()), ("components", "multiple".into())];
        let (mean, error) = mean(&scene(case, false), integrator("jis", &set), 1 << 18, *truth, 0.002);
        for c in 0..3 {
            let (off, noise) = (100.0 * (mean[c] / truth[c] - 1.0), 100.0 * error[c] / truth[c]);
            let line = format!("{}, channel {c}: {off:+.2} +- {noise:.2} %", case.name);
            println!("{line}");
            assert!(error[c] <= 0.003 * truth[c], "{line}: no test");
            assert!(agrees(mean[c], error[c].hypot(*uncertain), truth[c], sidak(0.01, 3 * cases.len())), "{line}");
        }
    }
}

const PHASES: [&str; 5] = [
    r#"<phase type="isotropic"/>"#,
    r#"<phase type="hg"><float name="g" value="0.7"/></phase>"#,
    r#"<phase type="rayleigh"/>"#,
    r#"<phase type="tabphase"><string name="values" value="0.3, 0.0, 0.5, 2.0"/></phase>"#,
    r#"<phase type="blendphase"><float name="weight" value="0.3"/><phase type="isotropic"/><phase type="hg"><float name="g" value="-0.6"/></phase></phase>"#,
];

const GREY: &str =
    r#"<rgb name="sigma_t" value="1"/><float name="scale" value="1.5"/><rgb name="albedo" value="0.9"/>"#;
const COLOURED: &str = r#"<rgb name="sigma_t" value="1, 0.4, 0.1"/><float name="scale" value="2"/><rgb name="albedo" value="0.9, 0.7, 0.95"/>"#;

/// A cube of that wall full of fog, a small lamp and a floor in it.
fn room(name: &str, fog: &str, phase: &str, wall: &str, more: &str) -> Case {
    let xml = format!(
        r#"<scene version="3.0.0">
    <integrator type="volpath"><integer name="max_depth" value="6"/></integrator>
    <sensor type="perspective">
        <float name="fov" value="36"/>
        <transform name="to_world"><lookat origin="0.4, 1.2, 5" target="0, 0, 0" up="0, 1, 0"/></transform>
        <film type="hdrfilm"><integer name="width" value="12"/><integer name="height" value="12"/><rfilter type="box"/></film>
    </sensor>
    <medium type="homogeneous" id="fog">{fog}{phase}</medium>
    <shape type="cube">{wall}<ref name="interior" id="fog"/></shape>
    <shape type="sphere">
        <point name="center" x="0.3" y="0.2" z="0.2"/><float name="radius" value="0.25"/>
        <emitter type="area"><rgb name="radiance" value="10, 9, 8"/></emitter>
    </shape>
    <shape type="rectangle">
        <transform name="to_world"><scale value="0.8"/><rotate x="1" angle="-90"/><translate y="-0.7"/></transform>
        <bsdf type="twosided"><bsdf type="diffuse"/></bsdf>
    </shape>
    {more}
</scene>"#
    );
    Case { name: name.into(), xml, files: vec![("ramp.vol", ramp_volume())], radiance: [1.0; 3], error: 0.0 }
}

const NOTHING: &str = r#"<bsdf type="null"/>"#;
const GLASS: &str = r#"<bsdf type="dielectric"/>"#;

/// A smaller cube of another medium.
fn inner(medium: &str) -> String {
    format!(
        r#"{medium}
    <shape type="cube">
        <transform name="to_world"><scale value="0.4"/><translate x="-0.4" y="-0.1" z="0.3"/></transform>
        <bsdf type="null"/><ref name="interior" id="other"/><ref name="exterior" id="fog"/>
    </shape>"#
    )
}

const RAMP: &str = r#"<medium type="heterogeneous" id="other">
        <volume type="gridvolume" name="sigma_t">
            <string name="filename" value="ramp.vol"/>
            <transform name="to_world"><translate x="-0.5" y="-0.5" z="-0.5"/><scale value="0.8"/><translate x="-0.4" y="-0.1" z="0.3"/></transform>
        </volume>
        <float name="scale" value="4"/><rgb name="albedo" value="0.9"/>
    </medium>"#;
const DENSE: &str = r#"<medium type="homogeneous" id="other"><float name="sigma_t" value="5"/><rgb name="albedo" value="0.95"/></medium>"#;

/// Emitters of every kind.
const LAMPS: &str = r#"<emitter type="constant"><rgb name="radiance" value="0.2"/></emitter>
    <emitter type="spot">
        <rgb name="intensity" value="4"/><transform name="to_world"><lookat origin="-2, 2, 1" target="0, 0, 0" up="0, 1, 0"/></transform>
    </emitter>
    <emitter type="directional"><rgb name="irradiance" value="0.3"/><vector name="direction" x="0.2" y="-1" z="-0.3"/></emitter>"#;

fn rooms() -> Vec<Case> {
    let mut rooms: Vec<_> =
        (0..).zip(PHASES).map(|(i, phase)| room(&format!("phase {i}"), GREY, phase, NOTHING, "")).collect();
    rooms.extend([
        room("chromatic", COLOURED, PHASES[0], NOTHING, ""),
        room("chromatic forward", COLOURED, PHASES[1], NOTHING, ""),
        room("glass", GREY, PHASES[0], GLASS, ""),
        room("heterogeneous inside", GREY, PHASES[0], NOTHING, &inner(RAMP)),
        room("dense inside", COLOURED, PHASES[1], NOTHING, &inner(DENSE)),
        room("lamps", GREY, PHASES[1], NOTHING, LAMPS),
    ]);
    rooms
}

/// Means of the picture by every seed, and seconds of a pass on one processor (Linux).
fn seeds(case: &Case, name: &str, set: &[(&str, &str)], batches: u64, passes: u32) -> (Vec<Picture>, f64) {
    let scene = scene(case, false);
    let set: Vec<_> = set.iter().map(|(k, v)| (*k, v.to_string())).collect();
    let mut seconds = 0.0;
    let picture = |seed| {
        let settings = Settings { integrator: Some(integrator(name, &set)), seed: Some(1 + seed), threads: Some(1) };
        let mut rendering = Rendering::new(&scene, &settings).unwrap();
        // The first pass prepares.
        rendering.add_passes(1).unwrap();
        let start = processor_seconds();
        rendering.add_passes(passes - 1).unwrap();
        seconds += processor_seconds() - start;
        assert_eq!(rendering.rare_events().non_finite, 0, "{name}");
        rendering.picture()
    };
    let pictures = (0..batches).map(picture).collect();
    (pictures, seconds / batches as f64 / f64::from(passes - 1))
}

/// Time that the processors spent on this program.
fn processor_seconds() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    // In hundredths of a second, the eleventh and twelfth after the name.
    let ticks = stat.rsplit(')').next().unwrap_or("").split_whitespace().skip(11).take(2);
    ticks.filter_map(|t| t.parse::<f64>().ok()).sum::<f64>() / 100.0
}

/// Mean over the picture, and its error, per channel.
fn whole(case: &Case, name: &str, set: &[(&str, &str)]) -> [Moments; 3] {
    let (pictures, _) = seeds(case, name, set, 40, 65);
    [0, 1, 2].map(|c| {
        let mut moments = Moments::default();
        for picture in &pictures {
            moments.push(picture.pixels.iter().map(|p| f64::from(p[c])).sum::<f64>() / picture.pixels.len() as f64);
        }
        moments
    })
}

/// Every second room from `first`: tests run side by side.
fn check_rooms(first: usize) {
    let rooms = rooms();
    // The lamp seen directly would be most of the noise.
    let common = [("max_depth", "6"), ("hide_emitters", "true")];
    for case in rooms.iter().skip(first).step_by(2) {
        let truth = whole(case, "volpath", &common);
        for (name, set) in [("jis", &[][..]), ("bdpt", &[("joint", "true")])] {
            let found = whole(case, name, &[&common, set].concat());
            for c in 0..3 {
                let (truth, found) = (truth[c], found[c]);
                let noise = 100.0 * found.standard_error().hypot(truth.standard_error()) / truth.mean();
                let off = 100.0 * (found.mean() / truth.mean() - 1.0);
                let line = format!("{name}, {}, channel {c}: {off:+.2} +- {noise:.2} %", case.name);
                println!("{line}");
                assert!(noise < 1.2, "{line}: no test");
                assert!(two_sided_p(found.two_sample_z(&truth)) > sidak(0.01, 6 * rooms.len()), "{line}");
            }
        }
    }
}

#[test]
fn even_rooms_of_path_tracing() {
    check_rooms(0);
}

#[test]
fn odd_rooms_of_path_tracing() {
    check_rooms(1);
}

/// A point light in fog, seen from outside.
fn glow(name: &str, extinction: f64, phase: &str, lamp: &str) -> Case {
    let xml = format!(
        r#"<scene version="3.0.0">
    <integrator type="volpath"/>
    <sensor type="perspective">
        <float name="fov" value="30"/>
        <transform name="to_world"><lookat origin="0.4, 0.7, 5" target="0, 0, 0" up="0, 1, 0"/></transform>
        <film type="hdrfilm"><integer name="width" value="24"/><integer name="height" value="24"/><rfilter type="box"/></film>
    </sensor>
    <medium type="homogeneous" id="fog"><float name="sigma_t" value="{extinction}"/><rgb name="albedo" value="0.95"/>{phase}</medium>
    <shape type="cube"><bsdf type="null"/><ref name="interior" id="fog"/></shape>
    {lamp}
</scene>"#
    );
    Case { name: name.into(), xml, files: vec![], radiance: [1.0; 3], error: 0.0 }
}

/// Mean over the pixels of the variance of a pass relative to the squared mean, and seconds of a pass.
fn cost(case: &Case, name: &str, set: &[(&str, &str)]) -> (f64, f64) {
    let passes = 64;
    let (pictures, seconds) = seeds(case, name, set, 48, passes);
    let pixels = pictures[0].pixels.len();
    let relative = |i: usize| {
        let mut moments = Moments::default();
        pictures.iter().for_each(|picture| moments.push(picture.pixels[i][1].into()));
        moments.variance() / moments.mean().powi(2).max(1e-30)
    };
    ((0..pixels).map(relative).sum::<f64>() / pixels as f64 * f64::from(passes), seconds)
}

/// Variance times time against path tracing: `cargo test --release -p tyndall-formats --test joint -- --ignored --nocapture`.
#[test]
#[ignore = "a measurement"]
fn efficiency() {
    let point = r#"<emitter type="point"><point name="position" x="0.2" y="0.1" z="0"/><rgb name="intensity" value="1"/></emitter>"#;
    let double = [("max_depth", "3"), ("components", "multiple")];
    let deep = [("max_depth", "-1")];
    let ray =
        |name: &str, h, g| infinite(name, &Infinite { h, g, albedo: [1.0; 3], orders: Some(1), ..Infinite::default() });
    let cases: [(Case, &[(&str, &str)]); 9] = [
        (ray("ray at 0.5, twice", 0.5, 0.0), &double),
        (ray("ray at 0.1, twice", 0.1, 0.0), &double),
        (ray("ray at 0.5, g 0.8, twice", 0.5, 0.8), &double),
        (glow("thin, twice", 0.3, PHASES[0], point), &double),
        (glow("thin, all", 0.3, PHASES[0], point), &deep),
        (glow("thin g 0.7, twice", 0.3, PHASES[1], point), &double),
        (glow("thin g 0.7, all", 0.3, PHASES[1], point), &deep),
        (glow("dense, twice", 5.0, PHASES[0], point), &double),
        (glow("dense, all", 5.0, PHASES[0], point), &deep),
    ];
    for (case, set) in cases {
        // `bdpt` gives all components only.
        for name in if set.len() == 1 { &["volpath", "bdpt"][..] } else { &["volpath"] } {
            let joint = [set, &[("joint", "true")]].concat();
            let ((v, t), (w, s)) = (cost(&case, name, set), cost(&case, name, &joint));
            println!(
                "{:36} {name:8} {v:9.3} {:8.1} us, joint {w:9.3} {:8.1} us: variance {:6.2}, time {:5.2}, efficiency {:6.2}",
                case.name,
                1e6 * t,
                1e6 * s,
                v / w,
                s / t,
                v * t / (w * s)
            );
        }
    }
}
