//! `tyndall render`.

use crate::args;
use crate::checkpoint::Checkpoints;
use crate::choice;
use crate::console::{Console, Level};
use crate::failure::Failure;
use crate::interrupt;
use crate::load::{self, build};
use crate::output::Target;
use crate::progress::{Progress, quantity, time};
use crate::pyramid::Pyramid;
use crate::series::Series;
use crate::statistics::{Moment, Statistics, peak_memory};
use std::ops::ControlFlow;
use std::path::Path;
use std::process::ExitCode;
use std::time::{Duration, Instant};
use tyndall::integrators::IntegratorInfo;
use tyndall::render::{self, Budget, Rendering, Settings};
use tyndall::scene::desc::SceneDesc;
use tyndall_formats::image::{Layer, Picture};

/// More samples than this share that are not finite are worth a warning.
const NON_FINITE_BUDGET: f64 = 1e-6;

/// Renders a scene to a picture.
pub(crate) fn run(args: &args::Render) -> Result<ExitCode, Failure> {
    let level = match (args.quiet, args.verbose) {
        (true, _) => Level::Quiet,
        (_, true) => Level::Verbose,
        _ => Level::Normal,
    };
    let console = Console { level };
    let started = Instant::now();
    // Everything on the command line is looked at before anything takes long.
    let info = args.integrator.as_deref().map(choice::find).transpose()?;
    let outputs = Outputs::new(args)?;
    let desc = describe(args, info, console)?;
    let load = started.elapsed();

    let budget = budget(args, &desc);
    let mut checkpoints = (args.checkpoint.is_some() || args.resume || args.keep_checkpoint)
        .then(|| Checkpoints::new(outputs.picture.path(), &desc, args.checkpoint));
    let started = Instant::now();
    let scene = build(&desc, console)?;
    // What it loaded is in the scene by now.
    drop(desc);

    let settings = Settings { threads: args.threads.map(|n| n as usize), ..Settings::default() };
    let mut rendering = Rendering::new(&scene, &settings).map_err(Failure::other)?;
    let pyramid = Pyramid::begin(args, &mut rendering)?;
    let setup = [load, started.elapsed()];
    let budget = if args.measuring.include_load { without(budget, setup[0] + setup[1]) } else { budget };
    for warning in rendering.warnings() {
        console.warning(warning);
    }
    if let Some(checkpoints) = checkpoints.as_ref().filter(|_| args.resume) {
        checkpoints.resume(&mut rendering, console)?;
        if matches!(budget, Budget::Passes(total) if total < rendering.passes()) {
            console.warning("that is more than asked for: it is written as it is");
        }
    }
    let (width, height) = scene.picture_size();
    let pixels = f64::from(width) * f64::from(height);
    // Before the line that says so: whoever reads it may press Ctrl-C.
    interrupt::watch(console.level > Level::Quiet);
    let (name, seed, threads) = (&rendering.integrator().name, rendering.seed(), rendering.threads());
    console.say(format_args!("rendering {width}x{height} pixels with {name}, seed {seed}, {threads} threads"));
    let mut series = series(args, budget)?;
    let interrupted = spend(&mut rendering, budget, pixels, checkpoints.as_mut(), series.as_mut(), console)?;
    outputs.write(&rendering, args)?;
    if let Some(pyramid) = &pyramid {
        pyramid.write(&rendering, &args.scene, console)?;
    }
    if let Some(checkpoints) = &mut checkpoints {
        if interrupted || args.keep_checkpoint { checkpoints.write(&rendering)? } else { checkpoints.remove()? }
    }
    if let Some(path) = &args.measuring.statistics {
        let kept = series.map_or_else(Vec::new, Series::kept);
        let statistics = Statistics { interrupted, ..statistics(&rendering, setup, kept) };
        crate::state::write(path, &statistics)?;
    }
    report(&rendering, pixels, &outputs, interrupted, console);
    Ok(if interrupted { interrupt::EXIT_CODE.into() } else { ExitCode::SUCCESS })
}

/// The scene of a file with what the command line changes.
fn describe(
    args: &args::Render,
    info: Option<&'static IntegratorInfo>,
    console: Console,
) -> Result<SceneDesc, Failure> {
    let loaded = load::load(&args.scene, console)?;
    let integrator = choice::choose(&loaded, info, &args.set, console)?;
    let mut desc = SceneDesc { integrator, ..loaded.scene };
    desc.film = load::film(desc.film, args.size, args.crop)?;
    desc.sampler.seed = args.seed.unwrap_or(desc.sampler.seed);
    console.detail(format_args!("integrator {}: {}", desc.integrator.name, choice::parameters(&desc.integrator)));
    Ok(desc)
}

fn budget(args: &args::Render, desc: &SceneDesc) -> Budget {
    match (args.time, args.error) {
        (Some(time), _) => Budget::Time(time),
        (_, Some(error)) => Budget::Error(error),
        _ => Budget::Passes(args.spp.unwrap_or(desc.sampler.sample_count)),
    }
}

/// What is left of a time; at least one pass is rendered in any case.
fn without(budget: Budget, setup: Duration) -> Budget {
    match budget {
        Budget::Time(time) => Budget::Time(time.saturating_sub(setup).max(Duration::from_millis(1))),
        other => other,
    }
}

fn series(args: &args::Render, budget: Budget) -> Result<Option<Series>, Failure> {
    let time = match budget {
        Budget::Time(time) => Some(time.as_secs_f64()),
        _ => None,
    };
    args.measuring.series.as_deref().map(|folder| Series::new(folder, time)).transpose()
}

fn statistics(rendering: &Rendering, setup: [Duration; 2], series: Vec<Moment>) -> Statistics {
    let [load_seconds, build_seconds] = setup.map(|d| d.as_secs_f64());
    let counts = rendering.counts();
    Statistics {
        integrator: rendering.integrator().name.clone(),
        parameters: choice::parameters(rendering.integrator()),
        seed: rendering.seed(),
        threads: rendering.threads(),
        samples: rendering.passes(),
        load_seconds,
        build_seconds,
        render_seconds: rendering.seconds(),
        light_paths: counts.light_paths,
        photons: counts.photons,
        connections: counts.connections,
        capped: counts.capped,
        non_finite: rendering.rare_events().non_finite,
        peak_memory: peak_memory(None),
        interrupted: false,
        series,
    }
}

/// Spends the budget; whether it was interrupted.
fn spend(
    rendering: &mut Rendering,
    budget: Budget,
    pixels: f64,
    mut checkpoints: Option<&mut Checkpoints>,
    mut series: Option<&mut Series>,
    console: Console,
) -> Result<bool, Failure> {
    let mut progress = Progress::new(console, pixels);
    let mut interrupted = false;
    let run = rendering.run(budget, |rendering, state| {
        progress.show(&state);
        if let Some(checkpoints) = &mut checkpoints
            && let Err(error) = checkpoints.tick(rendering)
        {
            // The picture may still find its place.
            console.warning(format_args!("no checkpoint: {error}"));
        }
        if let Some(series) = &mut series
            && let Err(error) = series.observe(rendering)
        {
            console.warning(format_args!("a picture of the series is missing: {error}"));
        }
        interrupted = interrupt::requested() && state.fraction < 1.0;
        if interrupted { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    progress.end();
    run.map_err(Failure::other)?;
    Ok(interrupted)
}

/// Says what there is now.
fn report(rendering: &Rendering, pixels: f64, outputs: &Outputs, interrupted: bool, console: Console) {
    let samples = rendering.passes();
    let total = f64::from(samples) * pixels;
    let strange = rendering.rare_events().non_finite as f64;
    if strange > NON_FINITE_BUDGET * total {
        console.warning(format_args!("{strange} of {} were not finite and count as black", quantity(total, "samples")));
    }
    let (how, seconds) = (if interrupted { "interrupted: " } else { "" }, time(rendering.seconds()));
    console.say(format_args!("{how}wrote {outputs} with {samples} samples per pixel after {seconds}"));
}

/// The files of a picture.
struct Outputs {
    picture: Target,
    preview: Option<Target>,
}

impl Outputs {
    /// Chosen and checked before rendering.
    fn new(args: &args::Render) -> Result<Self, Failure> {
        let default =
            || Path::new(args.scene.path.file_stem().unwrap_or("picture".as_ref())).with_added_extension("exr");
        let path = args.output.clone().unwrap_or_else(default);
        let picture = Target::new(&path, &args.encoding, !args.no_preview)?;
        if args.variance && !picture.keeps_layers() {
            return Err(Failure::usage("--variance is for .exr: other formats have no layers"));
        }
        let preview = (picture.keeps_layers() && !args.no_preview).then(|| picture.preview()).transpose()?;
        Ok(Self { picture, preview })
    }

    /// Writes all of them.
    fn write(&self, rendering: &Rendering, args: &args::Render) -> Result<(), Failure> {
        let render::Picture { width, height, pixels, variance, .. } = rendering.picture();
        let mut picture = Picture::from_rgb(width as usize, height as usize, &pixels);
        if args.variance {
            picture.layers.push(Layer::from_rgb("variance", &variance));
        }
        picture.attributes = metadata(rendering, &args.scene);
        [Some(&self.picture), self.preview.as_ref()].into_iter().flatten().try_for_each(|target| target.write(&picture))
    }
}

impl std::fmt::Display for Outputs {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}", self.picture.path().display())?;
        self.preview.as_ref().map_or(Ok(()), |preview| write!(f, " and {}", preview.path().display()))
    }
}

/// What an .exr says about itself. Equal renders differ in `seconds` only.
pub(crate) fn metadata(rendering: &Rendering, scene: &args::SceneFile) -> Vec<(String, String)> {
    let desc = rendering.integrator();
    let defines = scene.define.iter().map(|(name, value)| format!("{name}={value}")).collect::<Vec<_>>().join(" ");
    let name = scene.path.file_name().unwrap_or_default().to_string_lossy();
    let entries = [
        ("scene", name.into_owned()),
        ("defines", defines),
        ("integrator", desc.name.clone()),
        ("parameters", choice::parameters(desc)),
        ("seed", rendering.seed().to_string()),
        ("samples", rendering.passes().to_string()),
        ("seconds", format!("{:.3}", rendering.seconds())),
        ("renderer", concat!("tyndall ", env!("CARGO_PKG_VERSION")).into()),
    ];
    entries.into_iter().filter(|(_, value)| !value.is_empty()).map(|(name, value)| (name.into(), value)).collect()
}
