//! Merging and joining together against path tracing, and against photon beams where path tracing finds nothing.

use crate::common::{integrator, scene};
use crate::reciprocity;
use std::path::Path;
use tyndall::{Rendering, Scene, Settings};
use tyndall_formats::mitsuba;
use tyndall_testkit::corpus::Case;

/// Mean over the picture and all channels, and its standard error from `batches` renders of different seeds. (Pixels share
/// the light paths of a pass.)
fn picture_mean(scene: &Scene, name: &str, set: &[(&str, &str)], passes: u32, batches: u64) -> (f64, f64) {
    let set: Vec<_> = set.iter().map(|(k, v)| (*k, v.to_string())).collect();
    let means: Vec<f64> = (0..batches)
        .map(|seed| {
            let settings =
                Settings { integrator: Some(integrator(name, &set)), seed: Some(1 + seed), ..Settings::default() };
            let mut rendering = Rendering::new(scene, &settings).unwrap_or_else(|e| panic!("{name}: {e}"));
            rendering.add_passes(passes).unwrap();
            assert_eq!(rendering.rare_events().non_finite, 0, "{name}");
            let picture = rendering.picture();
            picture.as_slice().iter().map(|v| f64::from(*v)).sum::<f64>() / picture.as_slice().len() as f64
        })
        .collect();
    let n = batches as f64;
    let mean = means.iter().sum::<f64>() / n;
    let variance = means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean, (variance / n).sqrt())
}

/// Within three standard errors and half a per cent, which the blur may add.
fn agree(what: &str, (mean, sigma): (f64, f64), (truth, of_truth): (f64, f64)) {
    let (off, noise) = (mean / truth - 1.0, sigma.hypot(of_truth) / truth);
    println!("{what}: {:+.2} +- {:.2} %", 100.0 * off, 100.0 * noise);
    assert!(off.abs() < 0.005 + 3.0 * noise, "{what}: {:+.2} +- {:.2} %", 100.0 * off, 100.0 * noise);
}

const PHOTONS: [(&str, &str); 4] =
    [("photons", "3000"), ("beams", "600"), ("radius", "0.03"), ("surface_radius", "0.03")];

#[test]
fn pictures_of_path_tracing() {
    for (name, scene) in reciprocity::scenes() {
        if !["pinhole", "spot", "constant", "rough glass"].contains(&name) {
            continue;
        }
        let depth = ("max_depth", "5");
        let truth = picture_mean(&scene, "volpath", &[depth], 64, 8);
        for techniques in ["bpt,surf,pp3d,bp2d,bb1d", "bpt,surf", "bpt,bb1d"] {
            let set = [&[depth, ("techniques", techniques)], &PHOTONS[..]].concat();
            agree(&format!("{name}, {techniques}"), picture_mean(&scene, "upbp", &set, 24, 8), truth);
        }
    }
}

/// A scene of the references as a smaller picture.
fn reference(name: &str) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/references").join(name);
    let mut desc = mitsuba::read(&path, &mitsuba::Options::default()).unwrap_or_else(|e| panic!("{name}: {e}")).scene;
    (desc.film.width, desc.film.height) = (24, 24);
    Scene::build(&desc).unwrap_or_else(|e| panic!("{name}: {e}"))
}

#[test]
fn heterogeneous_and_nested_media() {
    for name in ["grid.xml", "grid-colour.xml", "glass-in-fog.xml"] {
        let scene = reference(name);
        let depth = ("max_depth", "6");
        let truth = picture_mean(&scene, "volpath", &[depth], 128, 8);
        let set = [&[depth], &PHOTONS[..]].concat();
        agree(name, picture_mean(&scene, "upbp", &set, 32, 8), truth);
    }
}

/// White fog in white light, seen through three screens that let half of it pass: whether a walk gets to the fog is left to chance.
#[test]
fn fog_behind_screens() {
    let screen = |z: f32| {
        format!(
            r#"<shape type="rectangle"><transform name="to_world"><scale value="2"/><translate z="{z}"/></transform>
            <bsdf type="mask"><float name="opacity" value="0.5"/>
            <bsdf type="twosided"><bsdf type="diffuse"><rgb name="reflectance" value="1"/></bsdf></bsdf></bsdf></shape>"#
        )
    };
    let screens = [2.0, 2.5, 3.0].map(screen).concat();
    let xml = format!(
        r#"<scene version="3.0.0"><integrator type="volpath"/>
        <sensor type="perspective"><float name="fov" value="20"/>
        <transform name="to_world"><lookat origin="0, 0, 6" target="0, 0, 0" up="0, 1, 0"/></transform>
        <film type="hdrfilm"><integer name="width" value="8"/><integer name="height" value="8"/></film></sensor>
        <medium type="homogeneous" id="fog"><rgb name="sigma_t" value="1"/><rgb name="albedo" value="1"/></medium>
        <shape type="cube"><bsdf type="null"/><ref name="interior" id="fog"/></shape>{screens}
        <emitter type="constant"><rgb name="radiance" value="1"/></emitter></scene>"#
    );
    let case = Case { name: "screens".into(), xml, files: vec![], radiance: [1.0; 3], error: 0.0 };
    let found = picture_mean(&scene(&case, false), "upbp", &[&[("max_depth", "-1")], &PHOTONS[..]].concat(), 96, 8);
    agree("fog behind screens", found, (1.0, 0.0));
}

/// A point light, glass and fog: what path tracing cannot find, merging can.
/// Walls that are smooth and rough mirrors at once, and glass: walks go on by smooth mirrors and leave copies at each.
#[test]
fn mirrors_smooth_and_rough() {
    let walls = r#"<bsdf type="blendbsdf"><float name="weight" value="0.5"/>
        <bsdf type="roughconductor"><float name="alpha" value="0.3"/><rgb name="specular_reflectance" value="0.7"/></bsdf>
        <bsdf type="conductor"><rgb name="specular_reflectance" value="0.7"/></bsdf></bsdf>"#;
    let text = format!(
        r#"<scene version="3.0.0"><sensor type="perspective"><float name="fov" value="60"/>
            <transform name="to_world"><lookat origin="0, 0, 0.9" target="0, 0, 0" up="0, 1, 0"/></transform>
            <film type="hdrfilm"><integer name="width" value="16"/><integer name="height" value="16"/>
            <rfilter type="box"/></film></sensor>
        <shape type="cube"><boolean name="flip_normals" value="true"/>{walls}</shape>
        <shape type="sphere"><float name="radius" value="0.3"/><bsdf type="dielectric"/></shape>
        <shape type="rectangle"><transform name="to_world"><scale value="0.6"/><rotate x="1" angle="90"/>
            <translate y="0.95"/></transform><emitter type="area"><rgb name="radiance" value="1"/></emitter></shape></scene>"#
    );
    let loaded = mitsuba::read_str(&text, Path::new("."), &mitsuba::Options::default()).unwrap();
    let scene = Scene::build(&loaded.scene).unwrap();
    let depth = ("max_depth", "7");
    let truth = picture_mean(&scene, "volpath", &[depth], 256, 8);
    agree("mirrors", picture_mean(&scene, "vcm", &[&[depth], &PHOTONS[..]].concat(), 48, 8), truth);
}

#[test]
fn caustics_are_those_of_photon_beams() {
    let scene = reciprocity::glass_in_fog();
    let depth = ("max_depth", "5");
    let ppb = [depth, ("photons", "2000"), ("radius", "0.02"), ("surface_radius", "0.03")];
    let truth = picture_mean(&scene, "ppb", &ppb, 48, 8);
    let set = [&[depth], &PHOTONS[..]].concat();
    agree("glass in fog", picture_mean(&scene, "upbp", &set, 48, 8), truth);
}
