//! A report with everything in it, about pictures made up on the spot.

use tyndall_report::agreement::Agreement;
use tyndall_report::flip::{self, PIXELS_PER_DEGREE};
use tyndall_report::metrics::Metric;
use tyndall_report::report::{Inset, Machine, Method, Pictures, Point, Quantity, Reference, Report, Run, Scene, page};
use tyndall_report::split::{Noise, Split};
use tyndall_report::summary::{Figure, PowerLaw};
use tyndall_report::{View, split};

const WIDTH: usize = 96;
const HEIGHT: usize = 64;
/// The reference in the middle.
const CENTRE: [f32; 3] = [2.0, 0.5, 0.25];

type Pixels = Vec<[f32; 3]>;

/// A ball that glows in the middle of a gradient.
fn reference() -> Pixels {
    let pixel = |i: usize| {
        let (x, y) = ((i % WIDTH) as f32 / WIDTH as f32 - 0.5, (i / WIDTH) as f32 / HEIGHT as f32 - 0.5);
        let r = (x * x * 2.25 + y * y).sqrt();
        if r < 0.12 {
            return CENTRE;
        }
        let fog = 0.25 / (1.0 + 18.0 * r * r);
        [0.05 + fog, 0.07 + 0.8 * fog + 0.05 * (0.5 - y), 0.12 + 0.6 * fog + 0.12 * (0.5 - y)]
    };
    (0..WIDTH * HEIGHT).map(pixel).collect()
}

/// The reference times `scale` with noise.
fn render(seed: u32, noise: f32, scale: f32) -> Pixels {
    let mut state = seed.wrapping_mul(747_796_405).wrapping_add(1);
    let mut uniform = move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as f32 / (1 << 24) as f32
    };
    reference().into_iter().map(|p| p.map(|v| v * scale * (1.0 + noise * (uniform() - 0.5)).max(0.0))).collect()
}

fn view(pixels: &Pixels) -> View<'_> {
    View::new(WIDTH, HEIGHT, pixels).unwrap()
}

/// What the page should show in the middle of the reference at an exposure, clipped and sRGB-encoded.
pub fn shown_centre(stops: f32) -> [i64; 3] {
    CENTRE.map(|v| {
        let x = f64::from((v * stops.exp2()).clamp(0.0, 1.0));
        let encoded = if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 };
        (encoded * 255.0).round() as i64
    })
}

fn method(name: &str, noise: f32, scale: f32, expected: &Pixels, pictures: &mut Pictures) -> Method {
    let renders: Vec<Pixels> = (1..4).map(|seed| render(seed, noise, scale)).collect();
    let errors: Vec<f64> = renders.iter().map(|r| Metric::RelMse.mean(view(r), view(expected)).unwrap()).collect();
    let point = |k: i32| {
        let seconds = 0.25 * f64::from(1 << k);
        let noisy = render(9, noise * 2f32.powi(6 - k).sqrt(), scale);
        let error = |m: Metric| m.mean(view(&noisy), view(expected)).unwrap();
        let errors = [(Quantity::RelMse.key(), error(Metric::RelMse)), (Quantity::Mape.key(), error(Metric::Mape))];
        Point { seconds: seconds + 0.1, render_seconds: seconds, samples: 4 << k, errors: errors.into() }
    };
    let curve: Vec<Point> = (0..7).map(point).collect();
    let views: Vec<View> = renders.iter().map(view).collect();
    let parts = split::Reference { picture: view(expected), halves: None };
    let figure = |values: &[f64]| Figure::new(values.to_vec()).unwrap();
    let map = flip::map(views[0], view(expected), PIXELS_PER_DEGREE).unwrap();
    Method {
        name: name.into(),
        description: format!("{name} max_depth=16"),
        runs: (1..4)
            .map(|repeat| Run { repeat, command: format!("tyndall render ball.xml -i {name}"), ..Run::default() })
            .collect(),
        figures: [
            (Quantity::RelMse.key(), figure(&errors)),
            (Quantity::RobustRelMse.key(), figure(&errors)),
            (Quantity::Flip.key(), figure(&[map.iter().sum::<f64>() / map.len() as f64])),
            (Quantity::Seconds.key(), figure(&[16.2, 16.0, 16.5])),
            (Quantity::Efficiency.key(), figure(&errors.iter().map(|e| 1.0 / e / 16.0).collect::<Vec<_>>())),
            (Quantity::Samples.key(), figure(&[256.0])),
            (Quantity::Memory.key(), figure(&[3.4e8])),
        ]
        .into(),
        split: Some(Split::of(&views, Noise::Scatter, &parts).unwrap()),
        slope: PowerLaw::fit(curve.iter().map(|p| [p.render_seconds, p.errors["relmse"]])),
        curve,
        picture: Some(pictures.add_colours(WIDTH, &renders[0])),
        flip: Some(pictures.add_map(WIDTH, &map)),
        ..Method::default()
    }
}

fn scene(name: &str, pictures: &mut Pictures) -> Scene {
    let expected = reference();
    let agreement = Agreement { mean_square: 0.97, beyond_three: 0.002, of_means: 0.4, agree: true };
    let failed = Method {
        name: "broken".into(),
        failure: Some("exit code 1: error: no such thing".into()),
        runs: vec![Run { repeat: 1, ..Run::default() }],
        ..Method::default()
    };
    let methods = vec![
        method("noisy", 0.9, 1.0, &expected, pictures),
        method("better", 0.3, 1.0, &expected, pictures),
        method("biased", 0.12, 0.8, &expected, pictures),
        failed,
    ];
    let about = Reference {
        source: "`volpath`".into(),
        picture: Some(pictures.add_colours(WIDTH, &expected)),
        own_error: Some(1.2e-5),
        aim: Some(1.5e-5),
        samples: Some(40_000),
        seconds: Some(320.0),
        agreement: Some(agreement),
        ..Reference::default()
    };
    Scene {
        name: name.into(),
        file: "ball.xml".into(),
        width: WIDTH,
        height: HEIGHT,
        variables: vec![("density".into(), "0.5".into())],
        reference: Some(about),
        methods,
        insets: vec![Inset { x: 40, y: 20, width: 24, height: 18 }],
        equal_error: Some(0.02),
    }
}

/// The page of the report.
pub fn page() -> String {
    let mut pictures = Pictures::default();
    let report = Report {
        title: "Fog, \"smoke\" & <mirrors>".into(),
        program: "tyndall 0.1.0".into(),
        created: "2026-01-01T00:00:00Z".into(),
        machine: Machine { processor: "Some Processor 9000".into(), threads: 8, system: "linux x86_64".into() },
        budget: "16 s each".into(),
        repeats: 3,
        command: "tyndall compare ball.xml --with noisy,better,biased --time 16s --repeat 3".into(),
        scenes: ["ball in fog", "empty room"].map(|name| scene(name, &mut pictures)).into(),
        quantities: Quantity::ALL.map(Quantity::describe).into(),
        grid: None,
    };
    page::page(&report, &pictures)
}
