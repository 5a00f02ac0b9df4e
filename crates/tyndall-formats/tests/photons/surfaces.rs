//! Density estimation on surfaces.

use crate::{Measured, common};
use tyndall_testkit::corpus::furnace_room;
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
