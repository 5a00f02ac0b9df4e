//! Light tracing and path tracing make the same picture.

use std::path::Path;
use tyndall::scene::desc::{IntegratorDesc, ParameterValue};
use tyndall::{Rendering, Scene, Settings};
use tyndall_formats::mitsuba;
use tyndall_testkit::ztest::{self, Picture};

const FILM: &str = r#"<film type="hdrfilm"><integer name="width" value="24"/><integer name="height" value="24"/>
    <rfilter type="FILTER"/></film>"#;

const FLOOR: &str = r#"<shape type="rectangle"><transform name="to_world"><scale value="3"/><rotate x="1" angle="-90"/>
        <translate y="-1"/></transform><bsdf type="diffuse"><rgb name="reflectance" value="0.7, 0.5, 0.3"/></bsdf></shape>"#;

const LAMP: &str = r#"<shape type="rectangle"><transform name="to_world"><scale value="0.7"/><rotate x="1" angle="90"/>
        <translate x="0.5" y="2.5" z="0.3"/></transform><bsdf type="diffuse"><rgb name="reflectance" value="0"/></bsdf>
        <emitter type="area"><rgb name="radiance" value="6, 5, 4"/></emitter></shape>"#;

const PERSPECTIVE: &str = r#"type="perspective"><float name="fov" value="40"/>"#;

/// A scene seen from the front; the eye stands in the medium `inside`.
fn scene(camera: &str, filter: &str, inside: &str, parts: &str) -> Scene {
    scene_in(Path::new("."), camera, filter, inside, parts)
}

/// With files in `folder`.
fn scene_in(folder: &Path, camera: &str, filter: &str, inside: &str, parts: &str) -> Scene {
    let film = FILM.replace("FILTER", filter);
    let text = format!(
        r#"<scene version="3.0.0"><sensor {camera}
            <transform name="to_world"><lookat origin="0.3, 0.6, 4.5" target="0, -0.1, 0" up="0, 1, 0"/></transform>
            {film}{inside}</sensor>{parts}</scene>"#
    );
    // Media come first: the camera may refer to them.
    let loaded =
        mitsuba::read_str(&text, folder, &mitsuba::Options::default()).unwrap_or_else(|e| panic!("{}", e.report()));
    Scene::build(&loaded.scene).unwrap_or_else(|e| panic!("{e}"))
}

/// Mean, variance of one sample.
fn render(scene: &Scene, name: &str, max_depth: i64, passes: u32, seed: u64) -> (Vec<f32>, Vec<f32>) {
    let parameters = vec![("max_depth".to_string(), ParameterValue::Integer(max_depth))];
    let integrator = Some(IntegratorDesc { name: name.into(), parameters });
    let mut rendering = Rendering::new(scene, &Settings { integrator, seed: Some(seed), threads: None }).unwrap();
    rendering.add_passes(passes).unwrap();
    assert_eq!(rendering.rare_events().non_finite, 0);
    let picture = rendering.picture();
    let variance = picture.variance.as_flattened().iter().map(|v| v * passes as f32).collect();
    (picture.as_slice().to_vec(), variance)
}

const BOTH: [(&str, u32); 2] = [("ptracer", 2048), ("bdpt", 384)];

/// Methods, each with a number of passes, against path tracing.
fn compare(what: &str, scene: &Scene, max_depth: i64, methods: &[(&str, u32)]) {
    let (mean, variance) = render(scene, "volpath", max_depth, 2048, 1);
    for &(name, passes) in methods {
        let (found, spread) = render(scene, name, max_depth, passes, 2);
        let outcome = ztest::pictures(
            &Picture { mean: &found, variance: &spread, samples: f64::from(passes) },
            &Picture { mean: &mean, variance: &variance, samples: 2048.0 },
            24,
            3,
        );
        let ratio = found.iter().sum::<f32>() / mean.iter().sum::<f32>();
        println!("{what}, {name}: {ratio:.4} of the light, {outcome:.2?}");
        assert!(outcome.passes(), "{what}, {name}: {outcome:.2?}");
    }
}

const FOG: &str = r#"<medium type="homogeneous" id="fog"><rgb name="sigma_t" value="0.3, 0.6, 0.9"/>
    <rgb name="albedo" value="0.9, 0.8, 0.7"/><phase type="hg"><float name="g" value="0.6"/></phase></medium>"#;

const BOX: &str = r#"<shape type="cube"><transform name="to_world"><scale value="0.95"/></transform><bsdf type="null"/>
    <ref name="interior" id="fog"/></shape>"#;

const INSIDE: &str = r#"<ref id="fog"/>"#;

/// A double pyramid whose normals are those of a ball.
const PYRAMIDS: &str = "v 1 0 0\nv -1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nv 0 0 -1\n\
    vn 1 0 0\nvn -1 0 0\nvn 0 1 0\nvn 0 -1 0\nvn 0 0 1\nvn 0 0 -1\n\
    f 1//1 3//3 5//5\nf 3//3 2//2 5//5\nf 2//2 4//4 5//5\nf 4//4 1//1 5//5\n\
    f 3//3 1//1 6//6\nf 2//2 3//3 6//6\nf 4//4 2//2 6//6\nf 1//1 4//4 6//6\n";

/// Cameras and filters.
const CAMERAS: [(&str, &str, &str); 4] = [
    ("pinhole", PERSPECTIVE, "box"),
    ("pinhole, gaussian", PERSPECTIVE, "gaussian"),
    (
        "thin lens",
        r#"type="thinlens"><float name="fov" value="40"/><float name="aperture_radius" value="0.2"/>
            <float name="focus_distance" value="3"/>"#,
        "box",
    ),
    ("orthographic", r#"type="orthographic">"#, "tent"),
];

const EMITTERS: [(&str, &str); 5] = [
    (
        "point",
        r#"<emitter type="point"><point name="position" x="1" y="2" z="1.5"/><rgb name="intensity" value="9, 8, 7"/></emitter>"#,
    ),
    (
        "spot",
        r#"<emitter type="spot"><transform name="to_world"><lookat origin="1, 3, 2" target="0, -0.5, 0" up="0, 1, 0"/></transform>
            <rgb name="intensity" value="20, 30, 20"/><float name="cutoff_angle" value="25"/></emitter>"#,
    ),
    (
        "directional",
        r#"<emitter type="directional"><vector name="direction" x="-0.4" y="-1" z="-0.6"/>
            <rgb name="irradiance" value="2, 3, 4"/></emitter>"#,
    ),
    ("constant", r#"<emitter type="constant"><rgb name="radiance" value="0.4, 0.5, 0.6"/></emitter>"#),
    (
        "sphere",
        r#"<shape type="sphere"><point name="center" x="1" y="1.6" z="1"/><float name="radius" value="0.2"/>
            <emitter type="area"><rgb name="radiance" value="40, 30, 20"/></emitter></shape>"#,
    ),
];

/// A ball that shows in the middle, with the BSDF and the media given.
fn ball(inner: &str) -> String {
    format!(
        r#"<shape type="sphere"><point name="center" x="0" y="-0.3" z="0.5"/><float name="radius" value="0.6"/>{inner}</shape>"#
    )
}

const ROUGH_METAL: &str = r#"<bsdf type="roughconductor"><float name="alpha" value="0.4"/></bsdf>"#;

fn of_camera(camera: &str, filter: &str) -> Scene {
    scene(camera, filter, "", &format!("{FLOOR}{LAMP}{}", ball(ROUGH_METAL)))
}

fn of_emitter(emitter: &str) -> Scene {
    let ball = ball(r#"<bsdf type="diffuse"/>"#);
    scene(PERSPECTIVE, "box", "", &format!("{FOG}{BOX}{FLOOR}{ball}{emitter}"))
}

fn inside() -> Scene {
    let room = r#"<shape type="sphere"><float name="radius" value="9"/><bsdf type="null"/><ref name="interior" id="fog"/></shape>"#;
    scene(PERSPECTIVE, "box", INSIDE, &format!("{FOG}{room}{FLOOR}{LAMP}"))
}

const ROUGH: &str = r#"<float name="alpha" value="0.3"/>"#;

/// A ball of fog in glass; `more` are parameters of the glass.
fn glass(kind: &str, more: &str) -> Scene {
    let inner = format!(
        r#"<bsdf type="{kind}"><float name="int_ior" value="1.5"/>{more}</bsdf><ref name="interior" id="fog"/>"#
    );
    scene(PERSPECTIVE, "box", "", &format!("{FOG}{FLOOR}{LAMP}{}", ball(&inner)))
}

/// A glass ball in fog, lit by a spot.
pub fn glass_in_fog() -> Scene {
    let glass =
        ball(r#"<bsdf type="dielectric"><float name="int_ior" value="1.5"/></bsdf><ref name="exterior" id="fog"/>"#);
    let spot = EMITTERS[1].1;
    let fog = BOX.replace("0.95", "2.9");
    scene(PERSPECTIVE, "box", "", &format!("{FOG}{fog}{FLOOR}{glass}{spot}"))
}

/// All scenes, with names.
pub fn scenes() -> Vec<(&'static str, Scene)> {
    let mut scenes: Vec<_> = CAMERAS.map(|(name, camera, filter)| (name, of_camera(camera, filter))).into();
    scenes.extend(EMITTERS.map(|(name, emitter)| (name, of_emitter(emitter))));
    scenes.extend([
        ("inside", inside()),
        ("rough glass", glass("roughdielectric", ROUGH)),
        ("glass", glass("dielectric", "")),
    ]);
    scenes
}

#[test]
fn cameras() {
    for (name, camera, filter) in CAMERAS {
        compare(name, &of_camera(camera, filter), 4, &BOTH);
    }
}

#[test]
fn emitters() {
    for (name, emitter) in EMITTERS {
        compare(name, &of_emitter(emitter), 4, &BOTH);
    }
}

#[test]
fn inside_a_medium() {
    // Light tracing has no finite variance: light is scattered right before the lens.
    compare("inside", &inside(), 5, &BOTH[1..]);
}

/// Rough glass bends and squeezes light.
#[test]
fn rough_glass() {
    compare("rough glass", &glass("roughdielectric", ROUGH), 6, &BOTH);
}

/// Where the normals that shade are not those of the surface, what light's walk carries is not what the camera's does.
#[test]
fn shading_normals() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("pyramids.obj"), PYRAMIDS).unwrap();
    let diffuse = r#"<bsdf type="twosided"><bsdf type="diffuse"/></bsdf>"#.to_string();
    let glass = format!(r#"<bsdf type="roughdielectric"><float name="int_ior" value="1.3"/>{ROUGH}</bsdf>"#);
    for (what, bsdf) in [("diffuse", diffuse), ("rough metal", ROUGH_METAL.to_string()), ("rough glass", glass)] {
        let pyramids = format!(
            r#"<shape type="obj"><string name="filename" value="pyramids.obj"/>
                <transform name="to_world"><scale value="0.8"/><rotate y="1" angle="20"/></transform>{bsdf}</shape>"#
        );
        let scene = scene_in(folder.path(), PERSPECTIVE, "box", "", &format!("{FLOOR}{LAMP}{pyramids}"));
        // What light's walk finds through this glass by itself is rare and bright: no test pixel by pixel.
        let methods = if what == "rough glass" { &BOTH[1..] } else { &BOTH[..] };
        compare(&format!("smooth pyramids, {what}"), &scene, 5, methods);
    }
}

/// Maps turn the normals that shade away from those of the mesh, more than viewers on the far side of them can follow.
#[test]
fn bump_and_normal_maps() {
    let folder = tempfile::tempdir().unwrap();
    let wave = |x: u32, y: u32, phase: f32| (0.9 * x as f32 + phase).sin() * (0.7 * y as f32 + 0.3).cos();
    let byte = |c: f32| (127.5 + 127.5 * c).round() as u8;
    // All lean to one side: what the maps add and take away must not cancel.
    let heights =
        image::GrayImage::from_fn(16, 16, |x, y| image::Luma([byte(0.11 * x as f32 - 0.85 + 0.1 * wave(x, y, 0.0))]));
    let normals = image::RgbImage::from_fn(16, 16, |x, y| {
        let (a, b) = (0.6 + 0.2 * wave(x, y, 0.0), 0.3 * wave(y, x, 1.0));
        image::Rgb([byte(a), byte(b), byte((1.0 - a * a - b * b).max(0.1).sqrt())])
    });
    heights.save(folder.path().join("heights.png")).unwrap();
    normals.save(folder.path().join("normals.png")).unwrap();
    let texture = |name: &str| {
        format!(
            r#"<texture type="bitmap"><string name="filename" value="{name}.png"/><boolean name="raw" value="true"/></texture>"#
        )
    };
    let (heights, normals) = (texture("heights"), texture("normals"));
    let diffuse = r#"<bsdf type="diffuse"><rgb name="reflectance" value="0.9, 0.8, 0.7"/></bsdf>"#;
    let glass = format!(r#"<bsdf type="roughdielectric"><float name="int_ior" value="1.3"/>{ROUGH}</bsdf>"#);
    let plain =
        r#"<boolean name="flip_invalid_normals" value="false"/><boolean name="use_shadowing_function" value="false"/>"#;
    let cases = [
        ("bumps", format!(r#"<bsdf type="bumpmap">{heights}<float name="scale" value="0.2"/>{diffuse}</bsdf>"#)),
        ("normals", format!(r#"<bsdf type="normalmap">{normals}{diffuse}</bsdf>"#)),
        ("normals, plain", format!(r#"<bsdf type="normalmap">{normals}{plain}{diffuse}</bsdf>"#)),
        ("normals on rough metal", format!(r#"<bsdf type="normalmap">{normals}{ROUGH_METAL}</bsdf>"#)),
        ("normals on rough glass", format!(r#"<bsdf type="normalmap">{normals}{glass}</bsdf>"#)),
    ];
    // Hardly anything but the slope is lit: the floor has its light from there.
    let spot = EMITTERS[1].1.replace("25", "11");
    for (what, bsdf) in cases {
        let slope = r#"<transform name="to_world"><scale value="0.9"/><rotate x="1" angle="-60"/><translate y="-0.4"/></transform>"#;
        let parts = format!(r#"{FLOOR}{spot}<shape type="rectangle">{slope}{bsdf}</shape>"#);
        let scene = scene_in(folder.path(), PERSPECTIVE, "box", "", &parts);
        // As in `shading_normals`.
        let methods = if what.ends_with("glass") { &BOTH[1..] } else { &BOTH[..] };
        compare(what, &scene, 5, methods);
    }
}
