//! Pictures written and read back.

use std::path::PathBuf;
use tyndall_formats::image::{self, Channel, Layer, Picture, ToneMap, WriteOptions};

fn random(n: usize, seed: u64) -> Vec<f32> {
    let mut rng = tyndall::math::Rng::keyed(seed, 0, 0);
    (0..n).map(|_| rng.f32() * 4.0).collect()
}

/// Three layers, sizes that fill no block, texts that need more than ASCII.
fn picture() -> Picture {
    let (width, height) = (37, 41);
    let channel = |name: &str, seed| Channel { name: name.into(), values: random(width * height, seed) };
    let layer = |name: &str, channels| Layer { name: name.into(), channels };
    Picture {
        width,
        height,
        layers: vec![
            layer("", vec![channel("R", 1), channel("G", 2), channel("B", 3), channel("A", 4)]),
            layer("single.depth2", vec![channel("Y", 5)]),
            layer("variance", vec![channel("R", 6), channel("G", 7), channel("B", 8)]),
        ],
        attributes: vec![
            ("a name longer than thirty-one bytes".into(), "x".into()),
            ("empty".into(), String::new()),
            ("tyndall.scene".into(), "nebel über dem Tal\nzweite Zeile".into()),
        ],
    }
}

fn folder() -> (tempfile::TempDir, impl Fn(&str) -> PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().to_owned();
    (folder, move |name| path.join(name))
}

#[test]
fn exr_keeps_everything() {
    let (_folder, path) = folder();
    let picture = picture();
    image::write(&path("a.exr"), &picture, &WriteOptions::default()).unwrap();
    assert_eq!(image::read_picture(&path("a.exr")).unwrap(), picture);
    let metadata = image::metadata(&path("a.exr")).unwrap();
    assert_eq!((metadata.width, metadata.height), (37, 41));
    assert_eq!(metadata.attributes, picture.attributes);
    assert_eq!(image::read(&path("a.exr"), false).unwrap().pixels, picture.layers[0].to_rgb().unwrap());
}

#[test]
fn exr_of_half_floats_is_near() {
    let (_folder, path) = folder();
    let picture = picture();
    image::write(&path("a.exr"), &picture, &WriteOptions { half: true, ..WriteOptions::default() }).unwrap();
    let found = image::read_picture(&path("a.exr")).unwrap();
    assert_eq!(found.layers.len(), 3);
    for (a, b) in found.layers.iter().zip(&picture.layers) {
        for (a, b) in a.channels.iter().zip(&b.channels) {
            assert_eq!(a.name, b.name);
            assert!(a.values.iter().zip(&b.values).all(|(x, y)| (x - y).abs() <= y * 0.5f32.powi(11)));
        }
    }
}

#[test]
fn exr_of_one_colour_and_values_that_are_not_finite() {
    let (_folder, path) = folder();
    let mut picture = Picture::from_rgb(64, 33, &[[0.25; 3]; 64 * 33]);
    picture.layers[0].channels[1].values[5] = f32::INFINITY;
    image::write(&path("a.exr"), &picture, &WriteOptions::default()).unwrap();
    assert!(std::fs::metadata(path("a.exr")).unwrap().len() < 1500, "not deflated");
    assert_eq!(image::read_picture(&path("a.exr")).unwrap(), picture);
}

#[test]
fn the_same_picture_gives_the_same_bytes_whatever_the_order() {
    let (_folder, path) = folder();
    let mut picture = picture();
    for ending in ["exr", "png", "pfm", "hdr"] {
        let (a, b) = (path(&format!("a.{ending}")), path(&format!("b.{ending}")));
        image::write(&a, &picture, &WriteOptions::default()).unwrap();
        picture.attributes.reverse();
        picture.layers.reverse();
        image::write(&b, &picture, &WriteOptions::default()).unwrap();
        assert!(std::fs::read(a).unwrap() == std::fs::read(b).unwrap(), "{ending}");
    }
    // Nothing else is left in the folder.
    assert_eq!(std::fs::read_dir(path("a.exr").parent().unwrap()).unwrap().count(), 8);
}

#[test]
fn pfm_keeps_colours_and_hdr_nearly() {
    let (_folder, path) = folder();
    let picture = picture();
    let expected = picture.layers[0].to_rgb().unwrap();
    image::write(&path("a.pfm"), &picture, &WriteOptions::default()).unwrap();
    assert_eq!(image::read(&path("a.pfm"), false).unwrap().pixels, expected);
    image::write(&path("a.hdr"), &picture, &WriteOptions::default()).unwrap();
    for (a, b) in image::read(&path("a.hdr"), false).unwrap().pixels.iter().zip(&expected) {
        let largest = b.iter().fold(0.0f32, |m, &x| m.max(x));
        assert!(a.iter().zip(b).all(|(x, y)| (x - y).abs() <= largest / 128.0), "{a:?} {b:?}");
    }
}

#[test]
fn png_is_exposed_and_encoded() {
    let (_folder, path) = folder();
    let picture = Picture::from_rgb(3, 1, &[[0.0, 0.25, 1.0], [2.0, -1.0, f32::NAN], [0.107_93; 3]]);
    let options = WriteOptions { exposure: 1.0, ..WriteOptions::default() };
    image::write(&path("a.png"), &picture, &options).unwrap();
    let found = image::read(&path("a.png"), true).unwrap();
    let bytes: Vec<u8> = found.pixels.as_flattened().iter().map(|x| (x * 255.0).round() as u8).collect();
    assert_eq!(bytes, [0, 188, 255, 255, 0, 0, 128, 128, 128]);
}

#[test]
fn tone_maps_rise_from_nought_to_one() {
    for map in [ToneMap::Clamp, ToneMap::Reinhard, ToneMap::Filmic] {
        let mut last = 0.0;
        for i in 0..2000 {
            let y = map.apply(1e-4 * 1.012f32.powi(i));
            assert!((last - 1e-6..=1.0).contains(&y), "{map:?} {i} {y}");
            last = y;
        }
        assert_eq!((map.apply(0.0), map.apply(-1.0), map.apply(f32::NAN)), (0.0, 0.0, 0.0));
        assert_eq!(map.apply(f32::INFINITY), 1.0);
        assert!((map.apply(f32::MAX) - 1.0).abs() < 1e-6);
    }
    assert!((ToneMap::Filmic.apply(0.18) - 0.18).abs() < 1e-6);
    assert!((ToneMap::Filmic.apply(1.0) - 0.8).abs() < 1e-6);
    assert!((ToneMap::Filmic.apply(1e-5) / 1e-5 - 0.5).abs() < 1e-3);
}

#[test]
fn what_cannot_be_written_says_why() {
    let (_folder, path) = folder();
    let message = |name: &str, picture: &Picture| {
        let error = image::write(&path(name), picture, &WriteOptions::default()).unwrap_err();
        assert_eq!(error.path, path(name));
        error.message
    };
    let picture = picture();
    assert_eq!(message("a.gif", &picture), "found the ending 'gif', expected exr, png, hdr or pfm");
    let mut short = picture.clone();
    short.layers[0].channels[0].values.pop();
    assert_eq!(message("a.exr", &short), "cannot be written: the picture has channels of another size, or no pixels");
    let mut twice = picture.clone();
    twice.attributes.push(("empty".into(), String::new()));
    assert_eq!(message("a.exr", &twice), "cannot be written: the picture has empty twice");
    let mut reserved = picture.clone();
    reserved.attributes.push(("lineOrder".into(), String::new()));
    assert_eq!(
        message("a.exr", &reserved),
        "cannot be written: the picture has the attribute lineOrder, which OpenEXR itself uses"
    );
    let main_less = Picture { layers: picture.layers[1..].to_vec(), ..picture };
    assert_eq!(
        message("a.png", &main_less),
        "cannot be written: the picture has no main layer of the channels R, G, B or Y"
    );
    assert!(message("missing/a.exr", &main_less).starts_with("cannot be written: No such file or directory"));
}
