//! The scenes in `scenes/`.

use std::path::Path;
use tyndall::Scene;
use tyndall::math::Vec3;
use tyndall_formats::mitsuba;

/// Each can be read and built without a warning, and its camera stands in the medium that it names, or in none.
#[test]
fn scenes_are_sound() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|e| e != "xml") {
            continue;
        }
        let name = path.display();
        let loaded = mitsuba::read(&path, &mitsuba::Options::default()).unwrap_or_else(|e| panic!("{}", e.report()));
        assert!(loaded.warnings.is_empty(), "{name}: {:?}", loaded.warnings);
        let sensor = &loaded.scene.sensor;
        let scene = Scene::build(&loaded.scene).unwrap_or_else(|e| panic!("{name}: {e}"));
        let camera = sensor.to_world.point([0.0; 3]).map(|x| x as f32);
        assert_eq!(scene.medium_at(Vec3::from_array(camera)), sensor.medium, "{name}");
        count += 1;
    }
    assert!(count >= 11, "{count} scenes");
}
