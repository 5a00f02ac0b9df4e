//! `tyndall image`.

use crate::{Folder, magic, red};

/// Two renders with different seeds.
fn renders() -> Folder {
    let folder = Folder::with_scene();
    folder.succeed("render ball.xml -q --no-preview --variance --spp 8 -o a.exr");
    folder.succeed("render ball.xml -q --no-preview --variance --spp 24 --seed 1 -o b.exr");
    folder
}

#[test]
fn info() {
    let folder = renders();
    let (out, _) = folder.succeed("image info b.exr");
    assert!(out.starts_with("b.exr: 20x14 pixels\n"), "{out}");
    for expected in
        ["main layer\n  R   min ", "variance\n", "samples     24\n", "seed        1\n", "scene       ball.xml\n"]
    {
        assert!(out.contains(expected), "{expected}\n{out}");
    }
}

#[test]
fn convert() {
    let folder = renders();
    folder.succeed("image convert a.exr a.pfm");
    assert_eq!(red(&folder.picture("a.pfm")), red(&folder.picture("a.exr")));
    folder.succeed("image convert a.exr half.exr --half");
    let (a, half) = (folder.picture("a.exr"), folder.picture("half.exr"));
    assert_eq!((a.attributes, a.layers.len()), (half.attributes, half.layers.len()));
    folder.succeed("image convert a.exr a.png --exposure 1 --tonemap reinhard");
    assert_eq!(&magic(&folder.path("a.png"))[1..], b"PNG");
    assert!(folder.fail("image convert a.exr b.pfm --exposure 1", 2).contains("--exposure"));
    assert!(folder.fail("image convert ball.xml b.pfm", 1).contains("ball.xml"));
}

#[test]
fn diff() {
    let folder = renders();
    let (out, _) = folder.succeed("image diff a.exr b.exr");
    for name in ["relMSE ", "MAPE ", "MSE ", "PSNR ", "FLIP "] {
        assert!(out.contains(name), "{out}");
    }
    let number = |words: &str| folder.succeed(words).0.trim().parse::<f64>().unwrap();
    assert_eq!(number("image diff a.exr a.exr --metric relmse"), 0.0);
    assert_eq!(number("image diff a.exr a.exr --metric psnr"), f64::INFINITY);
    let mse = number("image diff a.exr b.exr --metric MSE -o map.pfm");
    let map = folder.picture("map.pfm");
    let mean = red(&map).iter().map(|x| f64::from(*x)).sum::<f64>() / (20.0 * 14.0);
    assert!(mse > 0.0 && (mean / mse - 1.0).abs() < 1e-5, "{mean} {mse}");
    folder.succeed("image diff a.exr b.exr -o map.png");
    folder.succeed("render ball.xml -q --no-preview --spp 1 --size 8x8 -o small.exr");
    assert!(folder.fail("image diff a.exr small.exr", 1).contains("small.exr has 8x8 pixels"));
}

#[test]
fn merge() {
    let folder = renders();
    folder.succeed("image merge a.exr b.exr -o merged.exr");
    let [a, b, merged] = ["a.exr", "b.exr", "merged.exr"].map(|name| folder.picture(name));
    for (i, value) in red(&merged).iter().enumerate() {
        let expected = 0.25 * red(&a)[i] + 0.75 * red(&b)[i];
        assert!((value - expected).abs() <= 1e-6 * expected.max(1.0));
    }
    let [a, b, merged_variance] = [&a, &b, &merged].map(|p| p.layer("variance").unwrap().channel("G").unwrap());
    assert!(merged_variance.iter().any(|x| *x > 0.0));
    for (i, value) in merged_variance.iter().enumerate() {
        let expected = (a[i] + 9.0 * b[i]) / 16.0;
        assert!((value - expected).abs() <= 1e-5 * expected);
    }
    assert_eq!(merged.attribute("samples"), Some("32"));
    assert_eq!(merged.attribute("seed"), Some("0, 1"));

    assert!(folder.fail("image merge a.exr a.exr -o c.exr", 1).contains("the same seed 0"));
    assert!(folder.fail("image merge a.exr merged.exr -o c.exr", 1).contains("the same seed 0"));
    assert!(folder.fail("image merge a.exr b.exr -o c.png", 2).contains(".exr"));
    folder.succeed("render ball.xml -q --no-preview --seed 2 --size 8x8 -o small.exr");
    assert!(folder.fail("image merge a.exr small.exr -o c.exr", 1).contains("the sizes differ"));
    folder.succeed("image convert a.exr a.pfm");
    assert!(folder.fail("image merge b.exr a.pfm -o c.exr", 1).contains("how many samples"));
    assert!(!folder.path("c.exr").exists());
}
