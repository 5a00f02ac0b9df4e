//! Random scenes: valid ones keep their numbers, damaged ones end in an error.

use proptest::prelude::*;
use std::path::Path;
use tyndall::scene::desc::*;
use tyndall_formats::mitsuba::{Options, SceneError, read_str};

fn parse(text: &str) -> Result<SceneDesc, SceneError> {
    read_str(text, Path::new("."), &Options::default()).map(|loaded| loaded.scene)
}

const SCENE: &str = r##"<?xml version="1.0" encoding="utf-8"?>
<!-- a comment: größe -->
<scene version="3.0.0">
    <default name="spp" value="16"/>
    <integrator type="moment"><integrator type="volpath"><integer name="max_depth" value="8"/></integrator></integrator>
    <sensor type="thinlens">
        <float name="fov" value="40"/><float name="aperture_radius" value="0.1"/><string name="fov_axis" value="smaller"/>
        <transform name="to_world"><lookat origin="0, 1, 4" target="0, 0, 0" up="0, 1, 0"/></transform>
        <film type="hdrfilm"><integer name="width" value="64"/><integer name="height" value="48"/><rfilter type="box"/></film>
        <sampler type="independent"><integer name="sample_count" value="$spp"/></sampler>
    </sensor>
    <medium type="homogeneous" id="fog">
        <rgb name="sigma_t" value="0.1 0.2, 0.3"/><spectrum name="albedo" value="400:0.1, 700:0.9"/>
        <phase type="blendphase"><float name="weight" value="0.5"/><phase type="hg"/><phase type="tabphase"><string name="values" value="1 2 3"/></phase></phase>
    </medium>
    <bsdf type="roughconductor" id="metal"><string name="material" value="Cu"/><float name="alpha" value="0.2"/></bsdf>
    <texture type="checkerboard" id="tiles"><transform name="to_uv"><scale x="4" y="4"/></transform></texture>
    <bsdf type="twosided" id="floor"><bsdf type="diffuse"><ref name="reflectance" id="tiles"/></bsdf></bsdf>
    <shape type="shapegroup" id="group"><shape type="cylinder"><point name="p1" value="0 0 2"/><ref id="metal"/></shape></shape>
    <shape type="instance"><ref id="group"/><transform name="to_world"><rotate y="1" angle="30"/></transform></shape>
    <shape type="cube" id="größe"><ref name="interior" id="fog"/><bsdf type="null"/></shape>
    <shape type="rectangle"><ref id="floor"/><emitter type="area"><rgb name="radiance" value="#ff8000"/></emitter></shape>
    <emitter type="spot"><spectrum name="intensity" value="3"/><float name="cutoff_angle" value="30"/></emitter>
    <alias id="metal" as="copper"/>
</scene>
"##;

#[test]
fn the_undamaged_scene_is_valid() {
    let scene = parse(SCENE).unwrap_or_else(|e| panic!("{}", e.report()));
    assert_eq!((scene.shapes.len(), scene.bsdfs.len(), scene.media.len(), scene.emitters.len()), (3, 4, 1, 1));
}

/// Reads what may be damaged; an error must be able to show itself.
fn survive(text: &str) {
    if let Err(error) = parse(text) {
        let (line, column) = error.position();
        assert!(line >= 1 && column >= 1);
        assert!(error.report().starts_with(&error.to_string()));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn numbers_survive(
        center in prop::array::uniform3(-1e6f64..1e6), radius in 1e-6f64..1e6, rgb in prop::array::uniform3(0f32..=1.0),
        matrix in prop::array::uniform9(-5f64..5.0), g in -0.99f32..0.99, scale in 0f32..1e5, size in 1u32..4000,
        seed in 0u64..1 << 62, radiance in prop::array::uniform3(0f32..1e6),
    ) {
        let m = matrix;
        let [x, y, z] = center;
        let text = format!(
            "<scene version='3.0.0'>
             <sensor type='perspective'><film type='hdrfilm'><integer name='width' value='{size}'/></film>
               <sampler type='independent'><integer name='seed' value='{seed}'/></sampler></sensor>
             <medium type='homogeneous'><rgb name='albedo' value='{} {} {}'/><float name='scale' value='{scale}'/>
               <phase type='hg'><float name='g' value='{g}'/></phase></medium>
             <shape type='sphere'><point name='center' x='{x}' y='{y}' z='{z}'/><float name='radius' value='{radius:e}'/>
               <transform name='to_world'><matrix value='{} {} {} {x}  {} {} {} {y}  {} {} {} {z}  0 0 0 1'/></transform>
               <emitter type='area'><rgb name='radiance' value='{}, {}, {}'/></emitter></shape>
             </scene>",
            rgb[0], rgb[1], rgb[2], m[0], m[1], m[2], m[3], m[4], m[5], m[6], m[7], m[8], radiance[0], radiance[1], radiance[2],
        );
        let scene = parse(&text).unwrap_or_else(|e| panic!("{}", e.report()));
        prop_assert_eq!(scene.film.width, size);
        prop_assert_eq!(scene.sampler.seed, seed);
        let medium = &scene.media[0];
        prop_assert_eq!(medium.scale, scale);
        prop_assert!(matches!(medium.phase, PhaseDesc::HenyeyGreenstein { g: found } if found == g), "phase");
        prop_assert!(matches!(medium.albedo, VolumeDesc::Constant { value, .. } if value == rgb), "albedo");
        let shape = &scene.shapes[0];
        prop_assert!(matches!(shape.geometry, GeometryDesc::Sphere { center: c, radius: r } if c == center && r == radius), "geometry");
        prop_assert_eq!(
            shape.to_world.rows(),
            [[m[0], m[1], m[2], x], [m[3], m[4], m[5], y], [m[6], m[7], m[8], z], [0.0, 0.0, 0.0, 1.0]]
        );
        let emission = shape.emission.as_ref().unwrap();
        prop_assert!(matches!(emission.radiance, TextureDesc::Constant(found) if found == radiance), "radiance");
    }

    #[test]
    fn truncated_scenes_end_in_errors(at in 0..SCENE.len()) {
        survive(&SCENE[..SCENE.floor_char_boundary(at)]);
    }

    #[test]
    fn damaged_scenes_do_not_panic(damage in prop::collection::vec((0..SCENE.len(), any::<u8>(), 0usize..3), 1..6)) {
        let mut bytes = SCENE.as_bytes().to_vec();
        for (at, byte, kind) in damage {
            let at = at.min(bytes.len() - 1);
            match kind {
                0 => bytes[at] = byte,
                1 => { bytes.remove(at); }
                _ => bytes.insert(at, byte),
            }
        }
        survive(&String::from_utf8_lossy(&bytes));
    }

    #[test]
    fn exchanged_words_do_not_panic(a in 0usize..400, b in 0usize..400) {
        // Values and names at each other's places make well-formed files with nonsense in them.
        let mut words: Vec<&str> = SCENE.split('"').collect();
        let odd = |i: usize| (i % (words.len() / 2)) * 2 + 1;
        let (a, b) = (odd(a), odd(b));
        words.swap(a, b);
        survive(&words.join("\""));
    }

    #[test]
    fn garbage_does_not_panic(text in "\\PC{0,200}", value in "\\PC{0,40}") {
        survive(&text);
        let value = value.replace(['<', '&', '\''], "");
        survive(&SCENE.replace("\"0.2\"", &format!("'{value}'")));
        survive(&SCENE.replace("\"#ff8000\"", &format!("'#{value}'")));
        survive(&SCENE.replace("\"400:0.1, 700:0.9\"", &format!("'{value}'")));
        survive(&SCENE.replace("\"16\"", &format!("'{value}$spp\\$$'")));
    }
}
