//! `tyndall compare`: methods on scenes at equal time, samples or error.
//!
//! One render at a time, each in a process of its own. The repeats are the outer loop and the methods the inner one, so that a
//! machine that is busy for a while disturbs all methods alike. What is finished is kept, and the same command goes on.

mod arguments;
mod child;
mod contender;
mod experiment;
mod file;
mod machine;
mod measure;
mod picture;
mod record;
mod reference;
mod subject;
mod template;

use crate::console::{Console, Level};
use crate::failure::Failure;
use crate::interrupt;
use crate::progress::time;
pub(crate) use arguments::Compare;
use contender::{Contender, shown};
use experiment::{Budget, Experiment, ReferenceChoice};
use measure::Repeats;
pub(crate) use picture::Loaded;
use reference::{Halves, Reference};
use std::ffi::OsString;
use std::path::Path;
use std::process::ExitCode;
use subject::Subject;
use tyndall_formats::file::write_atomically;
use tyndall_report::report::{Pictures, Quantity, Report, csv, latex, page};

/// Runs or continues a comparison.
pub(crate) fn run(args: &Compare) -> Result<ExitCode, Failure> {
    let console = Console { level: if args.quiet { Level::Quiet } else { Level::Normal } };
    let experiment = Experiment::new(args)?;
    // All scenes with all methods, before anything takes long.
    let subjects = experiment.scenes.iter().map(|entry| Subject::new(entry, &experiment));
    let subjects = subjects.collect::<Result<Vec<_>, _>>()?;
    let given = subjects.iter().zip(&experiment.scenes).map(|(subject, entry)| match &entry.reference {
        ReferenceChoice::File(path) => Reference::read(path, subject).map(Some),
        _ => Ok(None),
    });
    let given = given.collect::<Result<Vec<_>, _>>()?;
    std::fs::create_dir_all(&experiment.output)
        .map_err(|error| Failure::other(format_args!("{}: {error}", experiment.output.display())))?;
    interrupt::watch(false);

    let mut report = Report {
        title: experiment.title.clone(),
        program: concat!("tyndall ", env!("CARGO_PKG_VERSION")).into(),
        created: machine::now(),
        machine: machine::describe(experiment.threads),
        budget: experiment.budget.to_string(),
        repeats: experiment.repeat,
        command: own_command(),
        scenes: Vec::new(),
        quantities: Quantity::ALL.map(Quantity::describe).into(),
        grid: None,
    };
    let mut pictures = Pictures::default();
    for ((subject, entry), given) in subjects.iter().zip(&experiment.scenes).zip(given) {
        console.say(format_args!("{}, {}x{} pixels", subject.name, subject.size[0], subject.size[1]));
        let (methods, reference, problem) = compare(&experiment, subject, &entry.reference, given, console)?;
        console.say("  measuring");
        let scene = measure::scene(entry, subject, &experiment, &methods, reference, problem, &mut pictures)?;
        report.scenes.push(scene);
        // Also after each scene: a long experiment can be looked at.
        write(&report, &pictures, &experiment.output)?;
    }
    summary(&report, console);
    console.say(format_args!("wrote {}", experiment.output.join("index.html").display()));
    Ok(ExitCode::SUCCESS)
}

type Found<'a> = (Vec<Repeats<'a>>, Option<Reference>, Option<String>);

/// Renders one scene by all methods, and its reference where one has to be.
fn compare<'a>(
    experiment: &'a Experiment,
    subject: &'a Subject,
    choice: &ReferenceChoice,
    given: Option<Reference>,
    console: Console,
) -> Result<Found<'a>, Failure> {
    let halves = reference::is_automatic(choice).then(|| Halves::new(experiment, subject));
    if let Budget::Error(error) = experiment.budget {
        // Errors are looked at while rendering: the reference comes first.
        let reference = match halves {
            Some(halves) => halves.refine(|_| Ok(Some(error * error)), console)?,
            None => given.ok_or_else(|| "there is no reference".into()),
        };
        let measured = reference.as_ref().ok().map(|reference| &reference.picture);
        let methods = contenders(experiment, subject, measured, console)?;
        return Ok(match reference {
            Ok(reference) => (methods, Some(reference), None),
            Err(message) => (methods, None, Some(message)),
        });
    }
    let methods = contenders(experiment, subject, None, console)?;
    let Some(halves) = halves else { return Ok((methods, given, None)) };
    let best = |reference: &Reference| measure::best_error(&methods, reference);
    let reference = halves.refine(best, console)?;
    Ok(match reference {
        Ok(reference) => (methods, Some(reference), None),
        Err(message) => (methods, None, Some(message)),
    })
}

/// Renders what is not there yet.
fn contenders<'a>(
    experiment: &'a Experiment,
    subject: &'a Subject,
    reference: Option<&Loaded>,
    console: Console,
) -> Result<Vec<Repeats<'a>>, Failure> {
    let mut methods: Vec<Repeats> = experiment.methods.iter().map(|_| Vec::new()).collect();
    for repeat in 0..experiment.repeat {
        for (method, repeats) in methods.iter_mut().enumerate() {
            let contender = Contender { experiment, subject, method, repeat };
            let name = format!("  {} {}/{}", experiment.methods[method].name, repeat + 1, experiment.repeat);
            let record = match contender.finished()? {
                Some(record) => {
                    console.say(format_args!("{name}: was finished"));
                    record
                }
                None => {
                    let first = repeats.iter().find(|(_, record)| record.failure.is_none());
                    let record = contender.run(first.map(|(_, record)| record.samples), reference)?;
                    match &record.failure {
                        Some(message) => console.warning(format_args!("{}: failed: {message}", name.trim())),
                        None => console.say(format_args!(
                            "{name}: {} samples per pixel in {}",
                            record.samples,
                            time(record.seconds)
                        )),
                    }
                    record
                }
            };
            repeats.push((contender, record));
            if interrupt::requested() {
                return Err(Failure::Interrupted);
            }
        }
    }
    Ok(methods)
}

/// All files of the report, each at once or not at all.
fn write(report: &Report, pictures: &Pictures, folder: &Path) -> Result<(), Failure> {
    let files = [
        ("index.html", page::page(report, pictures)),
        ("report.json", report.json()),
        ("report.csv", csv(report)),
        ("report.tex", latex(report)),
    ];
    let write = |(name, text): &(&str, String)| write_atomically(&folder.join(name), text.as_bytes());
    files.iter().try_for_each(write).map_err(Failure::other)
}

/// A line for every method of every scene.
fn summary(report: &Report, console: Console) {
    for scene in &report.scenes {
        console.say(format_args!("{}", scene.name));
        for method in &scene.methods {
            let figure = |q: Quantity| method.figures.get(q.key()).map(|f| f.median);
            let text = match (&method.failure, figure(Quantity::RelMse), figure(Quantity::Seconds)) {
                (Some(message), ..) => format!("failed: {message}"),
                (None, Some(error), Some(seconds)) => {
                    let biased = if method.split.is_some_and(|split| split.significant) { ", biased" } else { "" };
                    format!("relMSE {error:.3e} in {}{biased}", time(seconds))
                }
                (None, _, seconds) => time(seconds.unwrap_or(0.0)),
            };
            console.say(format_args!("  {:16} {text}", method.name));
        }
    }
}

/// What was typed.
pub(crate) fn own_command() -> String {
    let arguments: Vec<OsString> = std::env::args_os().skip(1).collect();
    shown(&[vec!["tyndall".into()], arguments].concat())
}
