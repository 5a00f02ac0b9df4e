//! `tyndall render --pyramid`.

use crate::{Folder, red};
use serde_json::Value;

fn listing(folder: &Folder, name: &str) -> Value {
    let text = std::fs::read_to_string(folder.path(name).join("pyramid.json")).unwrap();
    serde_json::from_str(&text).unwrap()
}

#[test]
fn pictures_of_all_techniques_with_a_list_and_a_page() {
    let folder = Folder::with_scene();
    let words = "render ball.xml -i upbp --set photons=300 --set radius=0.2 --spp 3 --seed 4";
    let err = folder.succeed(&format!("{words} --pyramid deep/p --pyramid-depth 3")).1;
    assert!(err.contains("wrote deep/p/index.html with 21 techniques"), "{err}");
    let list = listing(&folder, "deep/p");
    assert_eq!((&list["integrator"], &list["samples"]), (&"upbp".into(), &3.into()));
    let techniques = list["techniques"].as_array().unwrap();
    // One, three and four joins; four kinds of merges at one and at two vertices; and all longer paths.
    assert_eq!(techniques.len(), 1 + 3 + 4 + 4 * (1 + 2) + 1);
    let beams = techniques.iter().find(|t| t["name"] == "d3-bb1d-s2-t3").unwrap();
    for (key, expected) in [("kind", "merge"), ("merging", "bb1d"), ("weighted", "d3-bb1d-s2-t3-weighted.exr")] {
        assert_eq!(beams[key], expected);
    }
    assert_eq!((&beams["depth"], &beams["s"], &beams["t"]), (&3.into(), &2.into(), &3.into()));
    let shares: f64 = techniques.iter().map(|t| t["share"].as_f64().unwrap()).sum();
    assert!((shares - 1.0).abs() < 1e-4, "{shares}");

    // What is listed is there, and adds up to the picture, which is that of a render without.
    let mut sum = vec![0.0; 20 * 14];
    for technique in techniques {
        let file = |key: &str| technique[key].as_str().map(|name| folder.picture(&format!("deep/p/{name}")));
        let picture = file("weighted").unwrap();
        assert_eq!(picture.attribute("technique"), technique["name"].as_str());
        assert_eq!(picture.attribute("integrator"), Some("upbp"));
        sum.iter_mut().zip(red(&picture)).for_each(|(sum, value)| *sum += value);
        assert_eq!(file("unweighted").is_none(), technique["name"] == "longer");
    }
    folder.succeed(&format!("{words} --no-preview -o plain.exr"));
    assert!(folder.timeless("plain.exr") == folder.timeless("ball.exr"));
    for (sum, expected) in sum.iter().zip(red(&folder.picture("plain.exr"))) {
        assert!((sum - expected).abs() <= 1e-5 * (1.0 + expected), "{sum} is not {expected}");
    }
    let page = std::fs::read_to_string(folder.path("deep/p/index.html")).unwrap();
    assert!(page.contains("<title>ball: the pyramid of upbp</title>") && page.contains("d3-bb1d-s2-t3"));
    let files = std::fs::read_dir(folder.path("deep/p")).unwrap().count();
    assert_eq!(files, 2 * 21 - 1 + 2, "nothing else lies in the folder");
}

#[test]
fn light_paths_are_counted() {
    let folder = Folder::with_scene();
    folder.succeed("render ball.xml -i bdpt --spp 2 --pyramid p --statistics s.json");
    let statistics = std::fs::read_to_string(folder.path("s.json")).unwrap();
    let statistics: Value = serde_json::from_str(&statistics).unwrap();
    assert_eq!(statistics["light_paths"], 2 * 20 * 14);
    assert!(statistics["photons"].as_u64().unwrap() > 0);
}
