//! Density estimation on surfaces.

use crate::whole_scenes::picture_mean;
use crate::{Measured, common};
use tyndall_testkit::corpus::{Case, furnace_room};
use tyndall_testkit::ztest::sidak;

/// Radiance 1 in an empty room, four fifths of it over at least two bounces.
#[test]
fn an_empty_room_whose_walls_glow() {
    let mut case = furnace_room(0.8);
    for reference in ["<ref name=\"exterior\" id=\"fog\"/>", "<ref id=\"fog\"/>"] {
        case.xml = case.xml.replace(reference, "");
    }
    let scene = common::scene(&case, true);
    let ways: [(&str, &[(&str, &str)]); 2] = [("photonmap", &[]), ("ppm", &[("alpha", "0.95")])];
    for (seed, (name, more)) in (1..).zip(ways) {
        let mut set = vec![("photons", "2000".to_string()), ("surface_radius", "0.2".to_string())];
        set.extend(more.iter().map(|(key, value)| (*key, value.to_string())));
        let found = Measured::precisely(&scene, name, &set, seed, [1.0; 3], 0.007);
        found.assert(&format!("empty room, {name}"), [1.0; 3], 0.01, sidak(0.01, 2));
    }
}

/// A ball of rough metal over a lit floor, at its rim: the few photons of grazing directions outweigh all others there.
#[test]
fn what_is_seen_in_rough_metal() {
    let xml = r#"<scene version="3.0.0">
        <integrator type="path"><integer name="max_depth" value="3"/></integrator>
        <sensor type="perspective">
            <float name="fov" value="1"/>
            <transform name="to_world"><lookat origin="0, 1.5, 6" target="0.943, 1, 0" up="0, 1, 0"/></transform>
            <film type="hdrfilm">
                <integer name="width" value="8"/><integer name="height" value="8"/><rfilter type="box"/>
            </film>
        </sensor>
        <shape type="sphere">
            <point name="center" x="0" y="1" z="0"/>
            <bsdf type="roughconductor"><float name="alpha" value="0.2"/></bsdf>
        </shape>
        <shape type="rectangle">
            <transform name="to_world"><scale value="20"/><rotate x="1" angle="-90"/></transform>
        </shape>
        <shape type="sphere">
            <point name="center" x="-3" y="6" z="-3"/><float name="radius" value="0.5"/>
            <emitter type="area"><rgb name="radiance" value="40"/></emitter>
        </shape>
    </scene>"#;
    let case = Case { name: "metal".into(), xml: xml.into(), files: Vec::new(), radiance: [0.0; 3], error: 0.0 };
    let scene = common::scene(&case, false);
    let set = [("components", "indirect"), ("max_depth", "3"), ("photons", "5000")];
    let truth = picture_mean(&scene, "volpath", &set[..2], 256, 8);
    let found = picture_mean(&scene, "pbre", &set, 256, 8);
    for c in 0..3 {
        let (off, sigma) = (found[c].0 / truth[c].0 - 1.0, found[c].1.hypot(truth[c].1) / truth[c].0);
        println!("rough metal, channel {c}: {:+.2} +- {:.2} %", 100.0 * off, 100.0 * sigma);
        assert!(sigma < 0.01 && off.abs() < 3.0 * sigma + 0.005, "{off} +- {sigma}");
    }
}
