//! Joint importance sampling against closed forms and against path tracing.

mod common;

use common::{agrees, integrator, mean, scene};
use tyndall_testkit::corpus::{self, CHROMATIC, Case, Infinite, infinite, ramp_volume};
use tyndall_testkit::ztest::sidak;

/// The parameter of the scene's own integrator.
fn max_depth(case: &Case) -> String {
    let name = r#"name="max_depth" value=""#;
    let at = case.xml.find(name).unwrap() + name.len();
    case.xml[at..].split('"').next().unwrap().into()
}

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
            assert!(error[c] <= 0.004 * truth[c], "{line}: no test");
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

const GREY: &str = r#"<rgb name="sigma_t" value="1"/><float name="scale" value="1.5"/><rgb name="albedo" value="0.9"/>"#;
const COLOURED: &str = r#"<rgb name="sigma_t" value="1, 0.4, 0.1"/><float name="scale" value="3"/><rgb name="albedo" value="0.9, 0.7, 0.95"/>"#;

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
        <point name="center" x="0.3" y="0.2" z="0.2"/><float name="radius" value="0.15"/>
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

/// Mean over the picture, and its error, per channel.
fn picture(case: &Case, name: &str, depth: &str) -> ([f64; 3], [f64; 3]) {
    let scene = scene(case, false);
    mean(&scene, integrator(name, &[("max_depth", depth.into())]), 1 << 11, [0.0; 3], 0.0)
}

#[test]
fn rooms_of_path_tracing() {
    let rooms = rooms();
    for case in &rooms {
        for depth in ["3", "8"] {
            let (truth, of_truth) = picture(case, "volpath", depth);
            let (found, error) = picture(case, "jis", depth);
            for c in 0..3 {
                let sigma = error[c].hypot(of_truth[c]);
                let (off, noise) = (100.0 * (found[c] / truth[c] - 1.0), 100.0 * sigma / truth[c]);
                let ratio = (error[c] / of_truth[c]).powi(2);
                let line = format!("{}, depth {depth}, channel {c}: {off:+.3} +- {noise:.3} %", case.name);
                println!("{line}, variance {ratio:.2} of that of volpath");
                assert!(noise < 0.5, "{line}: no test");
                assert!(agrees(found[c], sigma, truth[c], sidak(0.01, 6 * rooms.len())), "{line}");
            }
        }
    }
}
