//! Lightcuts against closed forms and against the sum over all lights.

mod common;

use common::{agrees, furnaces_of_all_kinds, integrator, max_depth, mean, scene};
use std::ops::ControlFlow;
use tyndall::{Budget, Rendering, Scene, Settings};
use tyndall_testkit::corpus::{Case, Furnace, Infinite, furnace, furnace_room, infinite};
use tyndall_testkit::ztest::sidak;

/// One pixel, and every pass its own light paths: passes are independent.
fn check(set: &[(&str, &str)], case: &Case, truth: [f64; 3], precision: f64) {
    let mut set: Vec<_> = set.iter().map(|(k, v)| (*k, v.to_string())).collect();
    if set.iter().all(|(key, _)| *key != "max_depth") {
        set.push(("max_depth", max_depth(case)));
    }
    let (mean, error) = mean(&scene(case, true), integrator("lightcuts", &set), 1 << 17, truth, 0.9 * precision);
    for c in 0..3 {
        let (found, truth) = (mean[c], truth[c]);
        let line = format!("{set:?}, {}, channel {c}: {found} +- {}, expected {truth}", case.name, error[c]);
        println!("{line} ({:+.2} +- {:.2} %)", 100.0 * (found / truth - 1.0), 100.0 * error[c] / truth);
        assert!(error[c] <= precision * truth, "{line}: no test");
        assert!(agrees(found, error[c], truth, sidak(0.01, 100)), "{line}");
    }
}

/// All lights, and clusters of them.
const KINDS: [&[(&str, &str)]; 2] = [
    &[("photons", "20"), ("samples", "1"), ("error", "0"), ("max_cut", "0")],
    &[("photons", "200"), ("samples", "2"), ("max_cut", "200")],
];

/// Light scattered twice, alone: what virtual lights themselves give.
const TWICE: [(&str, &str); 2] = [("components", "multiple"), ("max_depth", "3")];

#[test]
fn double_scattering() {
    let orders = |n| infinite("double", &Infinite { orders: Some(n), ..Infinite::default() });
    let (both, single) = (orders(2).radiance, orders(1).radiance);
    let truth = [0, 1, 2].map(|c| both[c] - single[c]);
    for kind in KINDS {
        check(&[kind, &TWICE[..]].concat(), &orders(1), truth, 0.01);
    }
}

/// Light of a point source scattered twice with asymmetry `g`, and seen along the ray (2, 0.5): the answers are those of 10^9
/// random walks.
#[test]
fn anisotropic_double_scattering() {
    for (g, truth) in [(0.5, 3.7948e-3), (-0.5, 2.4443e-3)] {
        let case = infinite("forward", &Infinite { g, albedo: [1.0; 3], ..Infinite::default() });
        for kind in KINDS {
            check(&[kind, &TWICE[..]].concat(), &case, [truth; 3], 0.01);
        }
    }
}

#[test]
fn chromatic_triple_scattering() {
    let case = infinite("triple", &Infinite { orders: Some(3), ..tyndall_testkit::corpus::CHROMATIC });
    for kind in KINDS {
        check(kind, &case, case.radiance, 0.01);
    }
}

#[test]
fn furnaces() {
    for case in furnaces_of_all_kinds() {
        for kind in KINDS {
            check(kind, &case, case.radiance, 0.015);
        }
    }
}

/// However coarse the cut, the mean is right.
#[test]
fn coarse_cuts() {
    let set = [("photons", "100"), ("samples", "3"), ("error", "0.5"), ("max_cut", "100")];
    for case in [furnace("forward", Furnace { g: 0.7, ..Furnace::default() }), furnace_room(0.5)] {
        check(&set, &case, case.radiance, 0.01);
    }
}

/// A room with a lamp, full of thin smoke, on a few pixels.
const ROOM: &str = r#"<scene version="3.0.0">
    <integrator type="volpath"/>
    <sensor type="perspective">
        <float name="fov" value="40"/>
        <transform name="to_world"><lookat origin="0, 0, 4" target="0, 0, 0" up="0, 1, 0"/></transform>
        <film type="hdrfilm">
            <integer name="width" value="16"/><integer name="height" value="16"/><rfilter type="box"/>
        </film>
    </sensor>
    <medium type="homogeneous" id="smoke">
        <float name="sigma_t" value="0.3"/><rgb name="albedo" value="0.9, 0.8, 0.7"/>
        <phase type="hg"><float name="g" value="0.4"/></phase>
    </medium>
    <bsdf type="twosided" id="white"><bsdf type="diffuse"><rgb name="reflectance" value="0.7, 0.6, 0.5"/></bsdf></bsdf>
    <shape type="cube"><ref id="white"/><boolean name="flip_normals" value="true"/></shape>
    <shape type="sphere">
        <point name="center" x="0.2" y="-0.5" z="0.1"/><float name="radius" value="0.4"/><ref id="white"/>
    </shape>
    <shape type="rectangle">
        <transform name="to_world"><scale value="0.3"/><rotate x="1" angle="90"/><translate y="0.98"/></transform>
        <emitter type="area"><rgb name="radiance" value="20, 18, 15"/></emitter>
    </shape>
    <shape type="cube">
        <transform name="to_world"><scale value="1.01"/></transform>
        <bsdf type="null"/><ref name="interior" id="smoke"/>
    </shape>
</scene>"#;

/// The room seen from inside.
fn room() -> Scene {
    let xml = ROOM.replace("0, 0, 4", "0, 0, 0.98").replace(r#"value="40""#, r#"value="80""#);
    scene(&Case { name: "room".into(), xml, files: Vec::new(), radiance: [0.0; 3], error: 0.0 }, false)
}

fn render(scene: &Scene, passes: u32, set: &[(&str, &str)]) -> Vec<[f32; 3]> {
    let set: Vec<_> = set.iter().map(|(k, v)| (*k, v.to_string())).collect();
    let settings = Settings { integrator: Some(integrator("lightcuts", &set)), ..Settings::default() };
    let mut rendering = Rendering::new(scene, &settings).unwrap();
    rendering.run(Budget::Passes(passes), |_, _| ControlFlow::Continue(())).unwrap();
    rendering.picture().pixels
}

/// What is left where clusters are refined to their members is the sum over all of them.
#[test]
fn a_bound_near_zero_is_the_sum_over_all_lights() {
    let scene = room();
    let [all, refined] = ["0", "1e-30"]
        .map(|error| render(&scene, 1, &[("photons", "30"), ("samples", "2"), ("max_cut", "0"), ("error", error)]));
    for (all, refined) in all.iter().zip(&refined) {
        for c in 0..3 {
            assert!((all[c] - refined[c]).abs() <= 2e-5 * all[c], "{all:?} {refined:?}");
        }
    }
}

/// The same lights and points, in clusters and all. The bound is that of a pair in one pass, and a share of the largest channel.
#[test]
fn nearly_all_pixels_are_within_the_bound() {
    let scene = room();
    let set = [("photons", "300"), ("max_cut", "0")];
    let [all, cut] = ["0", "0.02"].map(|error| render(&scene, 16, &[&set[..], &[("error", error)]].concat()));
    let mut errors: Vec<f32> = std::iter::zip(&all, &cut)
        .map(|(all, cut)| (0..3).map(|c| (all[c] - cut[c]).abs()).fold(0.0, f32::max) / all[0].max(all[1]).max(all[2]))
        .collect();
    errors.sort_by(f32::total_cmp);
    let wrong = errors.iter().filter(|error| **error > 0.02).count();
    println!("{wrong} of {} pixels differ by more than 2 %, half of them by {}", all.len(), errors[all.len() / 2]);
    assert!(wrong * 100 <= all.len(), "{wrong} of {}", all.len());
}
