//! From finished renders to the figures of the report.

use super::contender::Contender;
use super::experiment::{Experiment, Kind, SceneEntry};
use super::picture::Loaded;
use super::record::Record;
use super::reference::Reference;
use super::subject::Subject;
use crate::failure::Failure;
use std::collections::BTreeMap;
use tyndall_report::agreement::{Agreement, Estimate};
use tyndall_report::flip::PIXELS_PER_DEGREE;
use tyndall_report::metrics::{Metric, peak, psnr};
use tyndall_report::report::{self, Inset, Pictures, Point, Quantity};
use tyndall_report::split::{Noise, Split};
use tyndall_report::summary::{Figure, PowerLaw, time_to_reach};
use tyndall_report::{MetricError, View, flip, hdr_flip};

/// The repeats of one method on one scene.
pub(crate) type Repeats<'a> = Vec<(Contender<'a>, Record)>;

/// The smallest relMSE of any contender beyond the reference's own noise; `None` where all failed.
pub(crate) fn best_error(methods: &[Repeats], reference: &Reference) -> Result<Option<f64>, Failure> {
    let mut best: Option<f64> = None;
    for (contender, _) in methods.iter().flatten().filter(|(_, record)| record.failure.is_none()) {
        let picture = load(contender, Record::PICTURE)?;
        let error = Metric::RelMse.mean(picture.view(), reference.picture.view()).map_err(Failure::other)?;
        let error = (error - reference.own_error()).max(0.0);
        best = Some(best.map_or(error, |b| b.min(error)));
    }
    Ok(best)
}

fn load(contender: &Contender, file: &str) -> Result<Loaded, Failure> {
    Loaded::read(&contender.picture(file), contender.subject.size).map_err(Failure::other)
}

/// Everything about a scene.
pub(crate) fn scene(
    entry: &SceneEntry,
    subject: &Subject,
    experiment: &Experiment,
    methods: &[Repeats],
    reference: Option<Reference>,
    problem: Option<String>,
    pictures: &mut Pictures,
) -> Result<report::Scene, Failure> {
    let [width, height] = subject.size.map(|n| n as usize);
    let found = methods.iter().enumerate().map(|(i, repeats)| {
        let about = &experiment.methods[i];
        let mut method = report::Method {
            name: about.name.clone(),
            description: subject.descriptions[i].clone(),
            external: matches!(about.kind, Kind::External(_)),
            ..Default::default()
        };
        measure(&mut method, repeats, reference.as_ref(), pictures)?;
        Ok(method)
    });
    let mut methods = found.collect::<Result<Vec<_>, Failure>>()?;
    let equal_error = equal_error(&mut methods);
    let reference = match (reference, problem) {
        (Some(mut reference), _) => {
            reference.about.picture = Some(pictures.add_colours(width, &reference.picture.pixels));
            Some(reference.about)
        }
        (None, Some(warning)) => {
            Some(report::Reference { source: "none".into(), warnings: vec![warning], ..Default::default() })
        }
        (None, None) => None,
    };
    Ok(report::Scene {
        name: entry.name.clone(),
        file: entry.path.display().to_string(),
        width,
        height,
        variables: subject.define.clone(),
        reference,
        methods,
        insets: entry.insets.iter().map(|&[x, y, width, height]| Inset { x, y, width, height }).collect(),
        equal_error,
    })
}

/// Figures of all repeats, and pictures of the first.
fn measure(
    method: &mut report::Method,
    repeats: &Repeats,
    reference: Option<&Reference>,
    pictures: &mut Pictures,
) -> Result<(), Failure> {
    let mut done: Vec<(&Contender, &Record, Loaded)> = Vec::new();
    for (contender, record) in repeats {
        let mut run = report::Run {
            repeat: contender.repeat + 1,
            seed: record.seed,
            command: record.command.clone(),
            failure: record.failure.clone(),
            ..Default::default()
        };
        if record.failure.is_none() {
            let picture = load(contender, Record::PICTURE)?;
            run.figures = figures(contender, record, &picture, reference).map_err(Failure::other)?;
            done.push((contender, record, picture));
        }
        method.runs.push(run);
        method
            .warnings
            .extend(record.warnings.iter().filter(|w| !method.warnings.contains(w)).cloned().collect::<Vec<_>>());
    }
    let failures: Vec<&str> = repeats.iter().filter_map(|(_, record)| record.failure.as_deref()).collect();
    let Some((contender, record, first)) = done.first() else {
        method.failure = failures.first().map(|message| (*message).to_owned());
        return Ok(());
    };
    if let Some(message) = failures.first() {
        method.warnings.push(format!("{} of {} repeats failed: {message}", failures.len(), repeats.len()));
    }
    for quantity in Quantity::ALL {
        let values = method.runs.iter().filter_map(|run| run.figures.get(quantity.key()).copied()).collect();
        if let Some(figure) = Figure::new(values) {
            method.figures.insert(quantity.key(), figure);
        }
    }
    method.picture = Some(pictures.add_colours(first.width, &first.pixels));
    method.agreement = agreement(&done)?;
    let Some(reference) = reference else {
        return Ok(());
    };
    let view = reference.picture.view();
    let map = flip::map(first.view(), view, PIXELS_PER_DEGREE).map_err(Failure::other)?;
    method.flip = Some(pictures.add_map(first.width, &map));
    method.curve = curve(contender, record, view)?;
    method.slope = PowerLaw::fit(method.curve.iter().map(|p| [p.render_seconds, p.errors[Quantity::RelMse.key()]]));
    let distinct = done.iter().enumerate().all(|(i, (.., p))| done[..i].iter().all(|(.., q)| q.pixels != p.pixels));
    let views: Vec<View> = done.iter().map(|(.., picture)| picture.view()).collect();
    let parts = reference.parts();
    let split = match (&views[..], first.variance_view()) {
        ([_, _, ..], _) if distinct => Some(Split::of(&views, Noise::Scatter, &parts)),
        ([_], Some(variance)) if record.samples > 1 => Some(Split::of(&views, Noise::Variance(variance), &parts)),
        _ => None,
    };
    if !distinct {
        let warning =
            "its repeats are the same picture, so bias and noise cannot be told apart; a {seed} in its command would";
        method.warnings.push(warning.into());
    }
    method.split = split.transpose().map_err(Failure::other)?;
    Ok(())
}

/// The first two repeats against each other.
fn agreement(done: &[(&Contender, &Record, Loaded)]) -> Result<Option<Agreement>, Failure> {
    let mut estimates = done.iter().filter_map(|(_, record, picture)| {
        let samples = u32::try_from(record.samples).unwrap_or(u32::MAX);
        picture.variance_view().map(|variance| Estimate { picture: picture.view(), variance, samples })
    });
    match (estimates.next(), estimates.next()) {
        (Some(a), Some(b)) => Agreement::of(a, b).map_err(Failure::other),
        _ => Ok(None),
    }
}

type Figures = BTreeMap<&'static str, f64>;

fn figures(
    contender: &Contender,
    record: &Record,
    picture: &Loaded,
    reference: Option<&Reference>,
) -> Result<Figures, MetricError> {
    let mut figures = Figures::new();
    let mut add = |quantity: Quantity, value: Option<f64>| {
        value.filter(|v| v.is_finite()).map(|value| figures.insert(quantity.key(), value));
    };
    if let Some(reference) = reference {
        let (view, expected) = (picture.view(), reference.picture.view());
        let relative = Metric::RelMse.mean(view, expected)?;
        add(Quantity::Psnr, Some(psnr(view, expected, peak(expected))?));
        add(Quantity::Flip, Some(flip::mean(view, expected, PIXELS_PER_DEGREE)?));
        add(Quantity::HdrFlip, Some(hdr_flip::mean(view, expected, PIXELS_PER_DEGREE)?));
        add(Quantity::Efficiency, Some(1.0 / (relative * record.seconds)));
        for (key, error) in errors(view, expected)? {
            figures.insert(key, error);
        }
    }
    let mut add = |quantity: Quantity, value: Option<f64>| {
        value.filter(|v| v.is_finite()).map(|value| figures.insert(quantity.key(), value));
    };
    let pixels = contender.subject.size.iter().map(|&n| f64::from(n)).product::<f64>();
    let render = record.render.unwrap_or(record.seconds).max(1e-9);
    add(Quantity::Seconds, Some(record.seconds));
    add(Quantity::Load, record.load);
    add(Quantity::Build, record.build);
    add(Quantity::Render, record.render);
    add(Quantity::Samples, Some(record.samples as f64));
    add(Quantity::SampleRate, Some(record.samples as f64 * pixels / render));
    let some = |n: u64| (n > 0).then_some(n as f64);
    add(Quantity::LightPaths, some(record.light_paths));
    add(Quantity::Photons, some(record.photons));
    add(Quantity::PhotonRate, some(record.photons).map(|n| n / render));
    add(Quantity::Memory, record.memory.map(|bytes| bytes as f64));
    Ok(figures)
}

/// The errors that are followed over time.
fn errors(picture: View, reference: View) -> Result<Figures, MetricError> {
    let error = |quantity: Quantity| match quantity {
        Quantity::RelMse => Metric::RelMse.mean(picture, reference),
        Quantity::RobustRelMse => Metric::RelMse.robust_mean(picture, reference),
        Quantity::Mape => Metric::Mape.mean(picture, reference),
        _ => Metric::Smape.mean(picture, reference),
    };
    Quantity::OVER_TIME.into_iter().map(|quantity| Ok((quantity.key(), error(quantity)?))).collect()
}

fn curve(contender: &Contender, record: &Record, reference: View) -> Result<Vec<Point>, Failure> {
    let point = |moment: &super::record::Moment| {
        let picture = load(contender, &moment.file)?;
        Ok(Point {
            seconds: moment.seconds,
            render_seconds: moment.render_seconds,
            samples: moment.samples,
            errors: errors(picture.view(), reference).map_err(Failure::other)?,
        })
    };
    record.moments.iter().map(point).collect()
}

/// The largest error that all came to; each method's time to it becomes a figure.
fn equal_error(methods: &mut [report::Method]) -> Option<f64> {
    let key = Quantity::RelMse.key();
    let last = |method: &report::Method| method.curve.last().map(|point| point.errors[key]);
    let target =
        methods.iter().filter_map(last).fold(None, |worst: Option<f64>, e| Some(worst.map_or(e, |w| w.max(e))))?;
    for method in methods.iter_mut() {
        let curve: Vec<[f64; 2]> = method.curve.iter().map(|p| [p.seconds, p.errors[key]]).collect();
        // Who was below it at the first look came there at the latest then.
        let first = curve.first().filter(|p| p[1] <= target).map(|p| p[0]);
        if let Some(figure) = first.or_else(|| time_to_reach(&curve, target)).and_then(|t| Figure::new(vec![t])) {
            method.figures.insert(Quantity::TimeToEqual.key(), figure);
        }
    }
    Some(target)
}
