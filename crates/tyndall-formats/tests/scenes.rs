//! What scene files mean.

use std::path::Path;
use tyndall::scene::desc::*;
use tyndall_formats::mitsuba::{Loaded, Options, SceneError, read, read_str};

fn folder() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/broken"))
}

fn try_scene(content: &str) -> Result<Loaded, SceneError> {
    read_str(&format!("<scene version=\"3.0.0\">\n{content}\n</scene>"), folder(), &Options::default())
}

fn scene(content: &str) -> SceneDesc {
    try_scene(content).unwrap_or_else(|e| panic!("{}", e.report())).scene
}

fn old_scene(content: &str) -> SceneDesc {
    read_str(&format!("<scene version=\"0.6.0\">\n{content}\n</scene>"), folder(), &Options::default())
        .unwrap_or_else(|e| panic!("{}", e.report()))
        .scene
}

fn close(found: [f32; 3], expected: [f32; 3], tolerance: f32) {
    for (f, e) in found.iter().zip(expected) {
        assert!((f - e).abs() <= tolerance * e.abs().max(1.0), "{found:?}, expected {expected:?}");
    }
}

fn close_points(found: [f64; 3], expected: [f64; 3]) {
    close(found.map(|v| v as f32), expected.map(|v| v as f32), 1e-6);
}

fn reflectance(content: &str) -> Rgb {
    match &scene(&format!("<bsdf type='diffuse'>{content}</bsdf>")).bsdfs[0] {
        BsdfDesc::Diffuse { reflectance: TextureDesc::Constant(rgb) } => *rgb,
        other => panic!("{other:?}"),
    }
}

fn intensity(content: &str) -> Rgb {
    match scene(&format!("<emitter type='point'>{content}</emitter>")).emitters[0].kind {
        EmitterKind::Point { intensity } => intensity,
        ref other => panic!("{other:?}"),
    }
}

fn constant(volume: &VolumeDesc) -> Rgb {
    match volume {
        VolumeDesc::Constant { value, .. } => *value,
        other => panic!("{other:?}"),
    }
}

#[test]
fn an_empty_scene_has_the_defaults() {
    let loaded = try_scene("").unwrap();
    assert_eq!(loaded.scene.film, FilmDesc::default());
    assert_eq!(loaded.scene.sampler, SamplerDesc::default());
    assert_eq!(loaded.scene.integrator, IntegratorDesc::default());
    assert_eq!(
        loaded.warnings[0].to_string(),
        "<text>:1:1: no sensor: the default camera stands at the origin and looks along +z"
    );
}

#[test]
fn colours_depend_on_what_they_colour() {
    // The numbers are those of Mitsuba 3.9.1, variant scalar_rgb.
    let list = "value='400:0, 500:0.3, 600:0.8, 700:1.1'";
    close(intensity(&format!("<spectrum name='intensity' {list}/>")), [1.126_87, 0.488_194, 0.088_034_3], 1e-3);
    close(reflectance(&format!("<spectrum name='reflectance' {list}/>")), [0.970_898, 0.510_187, 0.108_601], 1e-3);
    let steep = "value='400:0, 500:0.3, 600:1.8, 700:3.1'";
    close(reflectance(&format!("<spectrum name='reflectance' {steep}/>")), [1.0, 0.901_256, 0.037_140_6], 1e-3);
    close(intensity("<spectrum name='intensity' value='0.5'/>"), [0.602_397, 0.474_146, 0.454_458], 1e-5);
    assert_eq!(reflectance("<spectrum name='reflectance' value='0.5'/>"), [0.5; 3]);
    assert_eq!(intensity("<float name='intensity' value='0.5'/>"), [0.5; 3]);
    assert_eq!(intensity("<rgb name='intensity' value='1, 2 3'/>"), [1.0, 2.0, 3.0]);
    assert_eq!(intensity("<rgb name='intensity' value='#ff0033'/>"), [1.0, 0.0, 0.2]);
    close(intensity("<srgb name='intensity' value='0.5'/>"), [0.214_041; 3], 1e-5);
    assert_eq!(intensity(""), [1.0; 3]);
}

#[test]
fn spectrum_plugins() {
    let plugin = |kind: &str, content: &str| {
        intensity(&format!("<spectrum name='intensity' type='{kind}'>{content}</spectrum>"))
    };
    assert_eq!(plugin("d65", "<rgb name='color' value='.2 .3 4'/><float name='scale' value='2'/>"), [0.4, 0.6, 8.0]);
    assert_eq!(plugin("uniform", "<float name='value' value='0.5'/>"), [0.5; 3]);
    assert_eq!(plugin("rawconstant", "<vector name='value' value='.5 .6 .7'/>"), [0.5, 0.6, 0.7]);
    assert_eq!(
        plugin("srgb", "<rgb name='color' value='.5 .6 1.7'/><boolean name='unbounded' value='true'/>"),
        [0.5, 0.6, 1.7]
    );
    let expected = [1.126_87, 0.488_194, 0.088_034_3];
    let values = "<string name='values' value='0, .3, .8, 1.1'/>";
    close(
        plugin("irregular", &format!("<string name='wavelengths' value='400,500,600,700'/>{values}")),
        expected,
        1e-3,
    );
    let range = "<float name='wavelength_min' value='400'/><float name='wavelength_max' value='700'/>";
    close(plugin("regular", &format!("{range}{values}")), expected, 1e-3);
    let hot = plugin("blackbody", "<float name='temperature' value='5000'/>");
    assert!(hot[0] > hot[1] && hot[1] > hot[2] && hot[2] > 0.0, "{hot:?}");
}

#[test]
fn metals_and_glass_by_name() {
    let desc = scene(
        "<bsdf type='conductor'><string name='material' value='Au'/></bsdf><bsdf type='dielectric'><string name='int_ior' value='Water'/></bsdf>",
    );
    let BsdfDesc::Conductor { eta: TextureDesc::Constant(eta), k: TextureDesc::Constant(k), .. } = &desc.bsdfs[0]
    else {
        panic!()
    };
    close(*eta, [0.143_036, 0.375_307, 1.442_05], 1e-5);
    close(*k, [3.983, 2.385_56, 1.603_36], 1e-5);
    let BsdfDesc::Dielectric { int_ior, ext_ior, .. } = &desc.bsdfs[1] else { panic!() };
    assert_eq!((*int_ior, *ext_ior), (1.333, 1.000_277));
}

#[test]
fn fields_of_view_match_mitsuba() {
    let fov = |content: &str, width: u32, height: u32| {
        let film = format!(
            "<film type='hdrfilm'><integer name='width' value='{width}'/><integer name='height' value='{height}'/></film>"
        );
        match scene(&format!("<sensor type='perspective'>{content}{film}</sensor>")).sensor.kind {
            SensorKind::Perspective { fov_x, .. } => fov_x,
            other => panic!("{other:?}"),
        }
    };
    // Mitsuba 3.9.1 for films of 300x200 and 200x300.
    for (axis, wide, tall) in [
        ("x", 40.0, 40.0),
        ("y", 57.265_14, 27.278_078),
        ("diagonal", 33.696_983, 22.828_518),
        ("smaller", 57.265_14, 40.0),
        ("larger", 40.0, 27.278_078),
    ] {
        let content = format!("<float name='fov' value='40'/><string name='fov_axis' value='{axis}'/>");
        assert!((fov(&content, 300, 200) - wide).abs() < 1e-4, "{axis}");
        assert!((fov(&content, 200, 300) - tall).abs() < 1e-4, "{axis}");
    }
    assert!((fov("", 300, 200) - 39.597_752).abs() < 1e-4);
    assert!((fov("", 200, 300) - 26.991_467).abs() < 1e-4);
    assert!((fov("<string name='focal_length' value='35mm'/>", 300, 200) - 54.432_224).abs() < 1e-4);
}

#[test]
fn transforms_apply_in_order() {
    let point = |content: &str, p| {
        scene(&format!("<shape type='sphere'><transform name='to_world'>{content}</transform></shape>")).shapes[0]
            .to_world
            .point(p)
    };
    close_points(point("<scale value='2'/><translate x='1'/>", [1.0, 1.0, 1.0]), [3.0, 2.0, 2.0]);
    close_points(point("<translate x='1'/><scale x='2'/>", [1.0, 1.0, 1.0]), [4.0, 1.0, 1.0]);
    close_points(point("<rotate y='1' angle='90'/>", [1.0, 0.0, 0.0]), [0.0, 0.0, -1.0]);
    close_points(point("<matrix value='1 0 0 0 2 0 0 0 3'/>", [1.0, 1.0, 1.0]), [1.0, 2.0, 3.0]);
    close_points(point("<matrix value='1 0 0 4 0 1 0 5 0 0 1 6 0 0 0 1'/>", [0.0; 3]), [4.0, 5.0, 6.0]);
    close_points(point("<lookat origin='1 2 3' target='1 2 7' up='0 1 0'/>", [0.0, 0.0, 1.0]), [1.0, 2.0, 4.0]);
    // Without up, as Mitsuba 3.9.1 has it.
    close_points(point("<lookat origin='0,0,0' target='1,0,0'/>", [1.0, 2.0, 3.0]), [3.0, -1.0, -2.0]);
}

#[test]
fn definitions_substitute_the_longest_name() {
    let text = "<scene version='3.0.0'><default name='r' value='2'/><default name='rr' value='3'/>
        <default name='twice' value='$r$r'/>
        <shape type='sphere' id='a\\$b'><float name='radius' value='$rr'/></shape>
        <shape type='sphere'><float name='radius' value='$twice'/></shape></scene>";
    let radii = |defines: &[(&str, &str)]| {
        let defines = defines.iter().map(|(n, v)| (n.to_string(), v.to_string())).collect();
        let desc = read_str(text, folder(), &Options { defines }).unwrap().scene;
        assert_eq!(desc.shapes[0].name, "a$b");
        let radius = |shape: &ShapeDesc| match shape.geometry {
            GeometryDesc::Sphere { radius, .. } => radius,
            ref other => panic!("{other:?}"),
        };
        desc.shapes.iter().map(radius).collect::<Vec<f64>>()
    };
    assert_eq!(radii(&[]), [3.0, 22.0]);
    assert_eq!(radii(&[("rr", "5"), ("r", "1")]), [5.0, 11.0]);
}

#[test]
fn shared_objects_are_read_once() {
    let desc = scene(
        "<shape type='sphere'><ref id='b'/><ref name='interior' id='m'/></shape>
         <shape type='cube'><ref name='bsdf' id='a'/><ref name='exterior' id='m'/></shape>
         <bsdf type='diffuse' id='a'/><alias id='a' as='b'/>
         <medium type='homogeneous' id='m'/>",
    );
    assert_eq!((desc.bsdfs.len(), desc.media.len()), (1, 1));
    assert_eq!(desc.shapes[0].bsdf, desc.shapes[1].bsdf);
    assert_eq!(desc.shapes[0].interior, Some(MediumId(0)));
    assert_eq!(desc.shapes[1].exterior, Some(MediumId(0)));
    assert_eq!((desc.shapes[0].exterior, desc.shapes[1].interior), (None, None));
}

#[test]
fn instances_place_groups() {
    let desc = scene(
        "<shape type='instance'><ref id='g'/><transform name='to_world'><translate x='1'/></transform></shape>
         <shape type='shapegroup' id='g'><shape type='sphere'/><shape type='cube'/></shape>
         <shape type='instance'><ref id='g'/></shape>",
    );
    assert_eq!((desc.shape_groups.len(), desc.shape_groups[0].len(), desc.shapes.len()), (1, 2, 2));
    assert!(desc.shapes.iter().all(|s| matches!(s.geometry, GeometryDesc::Instance(ShapeGroupId(0)))));
}

#[test]
fn media_and_phases() {
    let loaded = try_scene(
        "<medium type='homogeneous' id='fog'><rgb name='sigma_t' value='1 2 3'/><float name='scale' value='2'/>
           <phase type='blendphase'><float name='weight' value='0.3'/><phase type='hg'/><phase type='rayleigh'/></phase></medium>
         <medium type='heterogeneous'><volume name='sigma_t' type='constvolume'><float name='value' value='9'/>
           <transform name='to_world'><translate x='1'/></transform></volume></medium>",
    )
    .unwrap();
    let [fog, smoke] = loaded.scene.media.as_slice() else { panic!() };
    assert_eq!((fog.name.as_str(), fog.kind, fog.scale), ("fog", MediumKind::Homogeneous, 2.0));
    assert_eq!((constant(&fog.sigma_t), constant(&fog.albedo)), ([1.0, 2.0, 3.0], [0.75; 3]));
    let PhaseDesc::Blend { weight, first, .. } = &fog.phase else { panic!() };
    assert_eq!(*weight, 0.3);
    assert!(matches!(**first, PhaseDesc::HenyeyGreenstein { g } if g == 0.8));
    assert_eq!((smoke.kind, constant(&smoke.sigma_t)), (MediumKind::Heterogeneous, [9.0; 3]));
    assert!(matches!(smoke.phase, PhaseDesc::Isotropic));
    let warning = loaded.warnings.iter().find(|w| w.message.contains("extinction")).unwrap();
    assert_eq!((warning.line, warning.column), (2, 64));
}

#[test]
fn grids_take_their_box_when_asked() {
    let files = tempfile::tempdir().unwrap();
    let mut bytes = b"VOL\x03".to_vec();
    for number in [1i32, 1, 1, 2, 1] {
        bytes.extend(number.to_le_bytes());
    }
    for number in [-1.0f32, -2.0, -3.0, 1.0, 2.0, 5.0, 0.25, 0.75] {
        bytes.extend(number.to_le_bytes());
    }
    std::fs::write(files.path().join("a.vol"), bytes).unwrap();
    let corner = |version: &str, content: &str| {
        let name = if version.starts_with('0') { "density" } else { "sigma_t" };
        let text = format!(
            "<scene version='{version}'><medium type='heterogeneous'><float name='albedo' value='0.5'/>
             <volume type='gridvolume' name='{name}'><string name='filename' value='a.vol'/>{content}</volume></medium></scene>"
        );
        let desc =
            read_str(&text, files.path(), &Options::default()).unwrap_or_else(|e| panic!("{}", e.report())).scene;
        assert_eq!(desc.media[0].kind, MediumKind::Heterogeneous);
        let VolumeDesc::Grid { to_world, grid, wrap, .. } = &desc.media[0].sigma_t else { panic!() };
        assert_eq!((grid.values.as_slice(), *wrap), ([0.25, 0.75].as_slice(), Wrap::Clamp));
        [to_world.point([0.0; 3]), to_world.point([1.0; 3])]
    };
    assert_eq!(corner("3.0.0", ""), [[0.0; 3], [1.0; 3]]);
    let boxed = "<boolean name='use_grid_bbox' value='true'/><transform name='to_world'><scale value='2'/></transform>";
    assert_eq!(corner("3.0.0", boxed), [[-2.0, -4.0, -6.0], [2.0, 4.0, 10.0]]);
    assert_eq!(corner("0.6.0", ""), [[-1.0, -2.0, -3.0], [1.0, 2.0, 5.0]]);
    let corners = "<point name='min' x='0' y='0' z='0'/><point name='max' x='3' y='3' z='3'/>";
    assert_eq!(corner("0.5.0", corners), [[0.0; 3], [3.0; 3]]);
}

#[test]
fn files_of_version_0_6_are_translated() {
    let desc = old_scene(
        "<integrator type='volpath_simple'><integer name='maxDepth' value='7'/></integrator>
         <sensor type='perspective'><string name='fovAxis' value='x'/><float name='nearClip' value='2'/>
           <transform name='toWorld'><lookAt origin='0,0,1' target='0,0,0' up='0,1,0'/></transform>
           <film type='ldrfilm'><integer name='width' value='10'/><boolean name='banner' value='false'/></film>
           <sampler type='ldsampler'><integer name='sampleCount' value='9'/></sampler></sensor>
         <medium type='homogeneous'><rgb name='sigmaS' value='1 2 0'/><spectrum name='sigmaA' value='1, 0, 0'/></medium>
         <medium type='homogeneous'><float name='sigmaT' value='4'/><float name='albedo' value='.5'/></medium>
         <medium type='heterogeneous'><string name='method' value='woodcock'/><float name='scale' value='3'/>
           <volume type='constvolume' name='density'><float name='value' value='2'/></volume>
           <volume type='constvolume' name='albedo'><rgb name='value' value='.1 .2 .3'/></volume></medium>
         <bsdf type='diffuse'><texture type='checkerboard' name='diffuseReflectance'>
           <float name='uscale' value='3'/><float name='voffset' value='.5'/></texture></bsdf>
         <bsdf type='dielectric'><float name='intIOR' value='1.4'/></bsdf>",
    );
    assert_eq!(desc.integrator.name, "volpath_simple");
    assert_eq!(desc.integrator.parameters, [("max_depth".to_string(), ParameterValue::Integer(7))]);
    assert_eq!((desc.sensor.near_clip, desc.film.width, desc.sampler.sample_count), (2.0, 10, 9));
    let [first, second, third] = desc.media.as_slice() else { panic!() };
    assert_eq!((constant(&first.sigma_t), constant(&first.albedo)), ([2.0, 2.0, 0.0], [0.5, 1.0, 0.0]));
    assert_eq!((constant(&second.sigma_t), constant(&second.albedo)), ([4.0; 3], [0.5; 3]));
    // Constant volumes had no box.
    assert_eq!((third.kind, third.scale, constant(&third.sigma_t)), (MediumKind::Homogeneous, 3.0, [2.0; 3]));
    let BsdfDesc::Diffuse { reflectance: TextureDesc::Checkerboard { to_uv, .. } } = &desc.bsdfs[0] else { panic!() };
    assert_eq!(to_uv.point([1.0, 1.0, 0.0]), [3.0, 1.5, 0.0]);
    assert!(matches!(desc.bsdfs[1], BsdfDesc::Dielectric { int_ior: 1.4, .. }));
}

#[test]
fn wrapping_integrators_are_unwrapped() {
    let desc = scene(
        "<integrator type='aov'><string name='aovs' value='d:depth'/><integrator type='moment'><integrator type='upbp'>
         <float name='radius' value='0.5'/><boolean name='mis' value='true'/></integrator></integrator></integrator>",
    );
    assert_eq!(desc.integrator.name, "upbp");
    let expected =
        [("radius".to_string(), ParameterValue::Float(0.5)), ("mis".to_string(), ParameterValue::Boolean(true))];
    assert_eq!(desc.integrator.parameters, expected);
}

#[test]
fn how_mitsuba_should_work_is_left_out() {
    let settings = |timeout: &str| {
        format!(
            "<integer name='samples_per_pass' value='16'/><integer name='block_size' value='32'/>
             <float name='timeout' value='{timeout}'/>"
        )
    };
    let read = |timeout: &str| {
        let (outer, inner) = (settings("-1"), settings(timeout));
        let text = format!(
            "<integrator type='moment'>{outer}<integrator type='volpath'>{inner}
             <integer name='max_depth' value='7'/></integrator></integrator>"
        );
        let loaded = try_scene(&text).unwrap();
        assert_eq!(loaded.scene.integrator.parameters, [("max_depth".to_string(), ParameterValue::Integer(7))]);
        loaded.warnings.into_iter().map(|w| w.message).collect::<Vec<_>>()
    };
    assert!(read("-1").iter().all(|w| !w.contains("timeout")));
    assert_eq!(read("30").iter().filter(|w| w.contains("timeout 30")).count(), 1);

    let text = "<integrator type='direct'><integer name='emitter_samples' value='4'/>
         <integer name='bsdf_samples' value='1'/></integrator>";
    let loaded = try_scene(text).unwrap();
    assert!(loaded.scene.integrator.parameters.is_empty());
    let warnings: Vec<_> = loaded.warnings.iter().filter(|w| w.message.contains("_samples")).collect();
    assert!(matches!(warnings[..], [w] if w.message.starts_with("emitter_samples 4 ") && w.line == 2), "{warnings:?}");
}

#[test]
fn both_sides_of_a_surface_only_reflect() {
    // What Mitsuba takes and refuses.
    for (nested, accepted) in [
        ("<bsdf type='principled'/>", true),
        ("<bsdf type='principled'><float name='spec_trans' value='0'/></bsdf>", true),
        ("<bsdf type='principled'><float name='spec_trans' value='0.5'/></bsdf>", false),
        ("<bsdf type='principledthin'/>", false),
        ("<bsdf type='mask'><float name='opacity' value='1'/><bsdf type='diffuse'/></bsdf>", false),
        ("<bsdf type='bumpmap'><texture type='checkerboard'/><bsdf type='dielectric'/></bsdf>", false),
        ("<bsdf type='diffuse'/><bsdf type='conductor'/>", true),
        ("<bsdf type='diffuse'/><bsdf type='null'/>", false),
        ("<bsdf type='twosided'><bsdf type='plastic'/></bsdf>", true),
    ] {
        let found = try_scene(&format!("<bsdf type='twosided'>{nested}</bsdf>"));
        assert_eq!(found.is_ok(), accepted, "{nested}");
        assert!(accepted || found.unwrap_err().message().contains("transmits light"), "{nested}");
    }
}

#[test]
fn the_medium_of_an_area_emitter_is_no_news() {
    let light = |medium: &str| {
        format!(
            "<medium type='homogeneous' id='a'/><shape type='sphere'><emitter type='area'>{medium}</emitter></shape>"
        )
    };
    let (with, without) = (try_scene(&light("<ref id='a'/>")).unwrap(), try_scene(&light("")).unwrap());
    assert_eq!(with.warnings, without.warnings);
    assert_eq!(with.scene.media.len(), 1);
}

#[test]
fn old_media_without_an_albedo_take_the_default() {
    let desc = old_scene(
        "<medium type='homogeneous'><float name='sigmaT' value='4'/></medium>
         <medium type='heterogeneous'><volume type='constvolume' name='density'><float name='value' value='2'/></volume>
         </medium>",
    );
    let [first, second] = desc.media.as_slice() else { panic!() };
    assert_eq!((constant(&first.sigma_t), constant(&first.albedo)), ([4.0; 3], [0.75; 3]));
    assert_eq!((constant(&second.sigma_t), constant(&second.albedo)), ([2.0; 3], [0.75; 3]));
}

#[test]
fn meshes_are_shared_flipped_and_flattened() {
    let files = tempfile::tempdir().unwrap();
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0.25\nvt 1 0.25\nvt 0 1\nf 1/1 2/2 3/3\n";
    std::fs::write(files.path().join("a.obj"), obj).unwrap();
    let file = "<string name='filename' value='a.obj'/>";
    let text = format!(
        "<scene version='3.0.0'><shape type='obj'>{file}</shape><shape type='obj'>{file}</shape>
         <shape type='obj'>{file}<boolean name='face_normals' value='true'/><boolean name='flip_tex_coords' value='false'/></shape></scene>"
    );
    let path = files.path().join("a.xml");
    std::fs::write(&path, text).unwrap();
    let desc = read(&path, &Options::default()).unwrap().scene;
    let meshes: Vec<_> = desc
        .shapes
        .iter()
        .map(|shape| match &shape.geometry {
            GeometryDesc::Mesh(mesh) => mesh.clone(),
            other => panic!("{other:?}"),
        })
        .collect();
    assert!(std::sync::Arc::ptr_eq(&meshes[0], &meshes[1]));
    assert_eq!((meshes[0].uvs[0], meshes[2].uvs[0]), ([0.0, 0.75], [0.0, 0.25]));
    assert_eq!((meshes[0].normals.len(), meshes[2].normals.len()), (3, 0));
}

#[test]
fn reports_show_the_line() {
    let error = try_scene("    <shape type='sphere'>\n\t<float name='radus' value='1'/></shape>").unwrap_err();
    let expected = "<text>:3:15: unknown parameter \"radus\" of shape \"sphere\"
  |
3 |  <float name='radus' value='1'/></shape>
  |               ^^^^^
help: did you mean \"radius\"? known parameters: center, radius, to_world, flip_normals, silhouette_sampling_weight
";
    assert_eq!(error.report(), expected);
    use miette::Diagnostic;
    let label = error.labels().unwrap().next().unwrap();
    let excerpt = error.source_code().unwrap().read_span(label.inner(), 0, 0).unwrap();
    assert_eq!(excerpt.data(), b"radus");
}

#[test]
fn bombs_do_not_go_off() {
    let nested = "<bsdf type='twosided'>".repeat(200_000);
    assert!(try_scene(&nested).is_err());
    let closed = nested + &"</bsdf>".repeat(200_000);
    assert!(try_scene(&closed).unwrap_err().message().contains("64 deep"));
    let mut laughs = String::from("<default name='a0_' value='ha'/>");
    let mut textures = String::from("<texture type='checkerboard' id='t0'/>");
    for i in 1..40 {
        let before = i - 1;
        laughs += &format!("<default name='a{i}_' value='$a{before}_$a{before}_'/>");
        let colours = format!("<ref name='color0' id='t{before}'/><ref name='color1' id='t{before}'/>");
        textures += &format!("<texture type='checkerboard' id='t{i}'>{colours}</texture>");
    }
    assert!(try_scene(&laughs).unwrap_err().message().contains("substituted"));
    assert!(try_scene(&textures).unwrap_err().message().contains("referred to more than"));
}
