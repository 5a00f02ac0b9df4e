//! FLIP against numbers of the authors' own program (flip-evaluator 1.7) for the same pictures.

use tyndall_report::{View, flip};

/// Linear values of an encoded one.
fn linear(encoded: f64) -> f32 {
    let x = encoded.clamp(0.0, 1.0);
    (if x <= 0.04045 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }) as f32
}

/// A picture of ramps, waves and squares, and a disturbed one.
fn pictures(width: usize, height: usize) -> [Vec<[f32; 3]>; 2] {
    let mut pictures = [Vec::new(), Vec::new()];
    for row in 0..height {
        for column in 0..width {
            let (x, y) = (column as f64, row as f64);
            let squares = ((column / 8 + row / 8) % 2) as f64;
            let a = [
                ((column * 7 + row * 3) % 64) as f64 / 63.0,
                0.5 + 0.5 * (x * 0.3).sin() * (y * 0.2).cos(),
                squares * 0.8 + 0.1,
            ];
            let hash = ((column * 31 + row * 17) % 11) as f64;
            let b = [a[0] + 0.1 * (x * 0.9 + y).sin(), a[1] + 0.05 * (y * 1.7).cos(), a[2] + (hash - 5.0) / 40.0];
            pictures[0].push(a.map(linear));
            pictures[1].push(b.map(linear));
        }
    }
    pictures
}

fn near(found: f64, expected: f64) {
    assert!((found - expected).abs() < 2e-5, "{found} {expected}");
}

#[test]
fn the_authors_numbers() {
    type Case = (usize, usize, f64, f64, [f64; 4]);
    let cases: [Case; 6] = [
        (48, 40, flip::PIXELS_PER_DEGREE, 0.110_865_33, [0.241_014_57, 0.121_925_29, 0.258_165_63, 0.081_942_82]),
        (48, 40, 20.0, 0.267_510_5, [0.346_525_3, 0.198_012_87, 0.331_540_58, 0.172_760_32]),
        (64, 32, flip::PIXELS_PER_DEGREE, 0.110_274_17, [0.241_014_57, 0.062_069_517, 0.154_964_19, 0.086_090_77]),
        (64, 32, 20.0, 0.266_843_5, [0.346_525_3, 0.173_398_17, 0.221_720_01, 0.024_238_247]),
        (5, 7, flip::PIXELS_PER_DEGREE, 0.174_096_87, [0.248_169_65, 0.095_078_24, 0.250_193_72, 0.153_474_33]),
        (5, 7, 20.0, 0.276_331_96, [0.346_525_3, 0.271_691_35, 0.234_104_62, 0.152_721_52]),
    ];
    for (width, height, pixels_per_degree, mean, samples) in cases {
        let [a, b] = pictures(width, height);
        let (a, b) = (View::new(width, height, &a).unwrap(), View::new(width, height, &b).unwrap());
        near(flip::mean(b, a, pixels_per_degree).unwrap(), mean);
        let map = flip::map(b, a, pixels_per_degree).unwrap();
        let at = |row: usize, column: usize| map[row * width + column];
        let found = [at(0, 0), at(height / 2, width / 2), at(height - 1, width - 1), at(1, width - 2)];
        found.iter().zip(samples).for_each(|(&found, expected)| near(found, expected));
        assert_eq!(flip::mean(a, a, pixels_per_degree).unwrap(), 0.0);
    }
}

#[test]
fn plain_colours() {
    let cases = [
        ([0.0; 3], [1.0; 3], 0.967_390_95),
        ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], 0.986_664),
        ([0.5; 3], [0.55, 0.5, 0.5], 0.149_689_94),
        ([0.0, 1.0, 0.0], [0.0, 0.0, 1.0], 1.0),
    ];
    for (a, b, expected) in cases {
        let (a, b) = (vec![a.map(linear); 256], vec![b.map(linear); 256]);
        let (a, b) = (View::new(16, 16, &a).unwrap(), View::new(16, 16, &b).unwrap());
        // Plain pictures have no features; in the authors' single precision these come out as a rounding error, whose
        // root is added to the exponent.
        let found = flip::mean(a, b, flip::PIXELS_PER_DEGREE).unwrap();
        let rounding = f64::abs(expected - f64::powf(expected, 1.0 + f64::from(f32::EPSILON).sqrt()));
        assert!((found - expected).abs() < 1e-6 + 1.1 * rounding, "{found} {expected}");
    }
}

#[test]
fn a_white_dot_on_black() {
    let black = vec![[0.0; 3]; 33 * 33];
    let mut dot = black.clone();
    dot[16 * 33 + 16] = [1.0; 3];
    let (a, b) = (View::new(33, 33, &black).unwrap(), View::new(33, 33, &dot).unwrap());
    let map = flip::map(b, a, flip::PIXELS_PER_DEGREE).unwrap();
    for (row, column, expected) in [(16, 16, 0.864_906_5), (16, 17, 0.763_490_7), (16, 20, 0.018_017_03), (10, 10, 0.0)]
    {
        near(map[row * 33 + column], expected);
    }
}
