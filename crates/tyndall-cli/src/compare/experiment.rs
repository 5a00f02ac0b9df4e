//! What is compared: scenes by methods, a budget, a reference. From the command line or from a file.

use super::arguments::Compare;
use super::file;
use super::template::Template;
use crate::choice;
use crate::failure::Failure;
use crate::progress::time;
use std::path::{Path, PathBuf};
use std::time::Duration;
use tyndall::integrators::IntegratorInfo;

/// Without a budget.
const DEFAULT_TIME: Duration = Duration::from_secs(30);
/// The longest render on the way to an error.
const DEFAULT_LIMIT: Duration = Duration::from_secs(600);
/// An automatic reference may take so many times the budget.
const REFERENCE_BUDGETS: u32 = 40;

/// A comparison.
#[derive(Debug)]
pub(crate) struct Experiment {
    pub(crate) title: String,
    pub(crate) budget: Budget,
    pub(crate) limit: Duration,
    pub(crate) repeat: u32,
    pub(crate) seed: Option<u64>,
    pub(crate) threads: usize,
    pub(crate) size: Option<[u32; 2]>,
    pub(crate) reference_method: Option<&'static IntegratorInfo>,
    pub(crate) reference_limit: Duration,
    pub(crate) reference_cache: PathBuf,
    pub(crate) scenes: Vec<SceneEntry>,
    pub(crate) methods: Vec<Method>,
    pub(crate) output: PathBuf,
}

/// What every method is given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Budget {
    Time(Duration),
    Samples(u32),
    /// The square root of relMSE.
    Error(f64),
}

/// A scene of a comparison.
#[derive(Clone, Debug)]
pub(crate) struct SceneEntry {
    pub(crate) name: String,
    pub(crate) path: PathBuf,
    pub(crate) define: Vec<(String, String)>,
    pub(crate) reference: ReferenceChoice,
    pub(crate) insets: Vec<[u32; 4]>,
}

/// What errors are measured against.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum ReferenceChoice {
    Auto,
    None,
    File(PathBuf),
}

/// A method of a comparison.
#[derive(Clone, Debug)]
pub(crate) struct Method {
    pub(crate) name: String,
    pub(crate) kind: Kind,
    /// Where it was asked for, to begin messages with: `experiment.toml:12:8: ` or nothing.
    pub(crate) place: String,
}

/// Who renders.
#[derive(Clone, Debug)]
pub(crate) enum Kind {
    Integrator { info: &'static IntegratorInfo, set: Vec<(String, String)> },
    External(Template),
}

impl std::fmt::Display for Budget {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Time(duration) => write!(f, "{} each", time(duration.as_secs_f64())),
            Self::Samples(n) => write!(f, "{n} samples per pixel each"),
            Self::Error(error) => write!(f, "to a relative error of {error}"),
        }
    }
}

impl ReferenceChoice {
    /// `auto`, `none` or a file, which is looked for from `folder`.
    pub(crate) fn new(text: &str, folder: &Path) -> Self {
        match text {
            "auto" => Self::Auto,
            "none" => Self::None,
            path => Self::File(folder.join(path)),
        }
    }
}

impl Method {
    /// An integrator by its name.
    pub(crate) fn integrator(name: &str, integrator: &str) -> Result<Self, Failure> {
        let kind = Kind::Integrator { info: choice::find(integrator)?, set: Vec::new() };
        Ok(Self { name: name.to_owned(), kind, place: String::new() })
    }
}

impl Experiment {
    /// From the command line, and the file if there is one.
    pub(crate) fn new(args: &Compare) -> Result<Self, Failure> {
        let is_file = args.source.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml"));
        let mut given = if is_file { file::read(&args.source)? } else { file::Given::default() };
        if !is_file {
            let define = args.define.clone();
            let name = args.source.file_stem().unwrap_or("scene".as_ref()).to_string_lossy().into_owned();
            let path = args.source.clone();
            given.scenes.push(SceneEntry { name, path, define, reference: ReferenceChoice::Auto, insets: Vec::new() });
        } else if !args.define.is_empty() {
            given.scenes.iter_mut().for_each(|scene| scene.define.extend(args.define.iter().cloned()));
        }
        add_methods(&mut given.methods, args)?;
        if let Some(text) = &args.reference {
            let choice = ReferenceChoice::new(text, Path::new(""));
            if matches!(choice, ReferenceChoice::File(_)) && given.scenes.len() > 1 {
                return Err(Failure::usage(
                    "--reference FILE is for one scene; a file with several names one for each",
                ));
            }
            given.scenes.iter_mut().for_each(|scene| scene.reference = choice.clone());
        }
        given.scenes.iter_mut().for_each(|scene| scene.insets.extend(&args.inset));
        check(&given)?;

        let budget = match (args.time, args.samples, args.error) {
            (Some(time), ..) => Budget::Time(time),
            (_, Some(samples), _) => Budget::Samples(samples),
            (.., Some(error)) => Budget::Error(error),
            _ => given.budget.unwrap_or(Budget::Time(DEFAULT_TIME)),
        };
        if matches!(budget, Budget::Error(_)) && given.scenes.iter().any(|s| s.reference == ReferenceChoice::None) {
            return Err(Failure::usage("equal error needs a reference to measure it against, and there is `none`"));
        }
        let limit = args.limit.or(given.limit).unwrap_or(DEFAULT_LIMIT);
        let usual_limit = match budget {
            Budget::Time(time) => time * REFERENCE_BUDGETS,
            _ => limit,
        };
        let reference_method = args.reference_method.as_deref().map(choice::find).transpose()?;
        let stem = args.source.file_stem().unwrap_or("report".as_ref()).to_string_lossy();
        let usual_output = || if is_file { args.source.with_extension("report") } else { "report".into() };
        let output = args.output.clone().or(given.output).unwrap_or_else(usual_output);
        let threads = args.threads.or(given.threads).map(|n| n as usize);
        Ok(Self {
            title: args.title.clone().or(given.title).unwrap_or_else(|| format!("Comparison: {stem}")),
            budget,
            limit,
            repeat: args.repeat.or(given.repeat).unwrap_or(1),
            seed: args.seed.or(given.seed),
            threads: threads.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from)),
            size: args.size.or(given.size),
            reference_method: reference_method.or(given.reference_method),
            reference_limit: args.reference_limit.or(given.reference_limit).unwrap_or(usual_limit),
            reference_cache: args.reference_cache.clone().unwrap_or_else(|| output.join("references")),
            scenes: given.scenes,
            methods: given.methods,
            output,
        })
    }
}

/// The methods of the command line, which come after those of a file, and parameters for all.
fn add_methods(methods: &mut Vec<Method>, args: &Compare) -> Result<(), Failure> {
    for word in args.with.iter().map(|word| word.trim()).filter(|word| !word.is_empty()) {
        let (name, integrator) = word.split_once('=').unwrap_or((word, word));
        methods.push(Method::integrator(name, integrator)?);
    }
    for (name, command) in &args.external {
        let template =
            Template::new(command).map_err(|message| Failure::usage(format_args!("--external {name}: {message}")))?;
        methods.push(Method { name: name.clone(), kind: Kind::External(template), place: String::new() });
    }
    for (key, value) in &args.set {
        let Some((name, key)) = key.split_once('.') else {
            return Err(Failure::usage(format_args!(
                "--set {key}={value}: expected METHOD.KEY=VALUE, such as bre.photons=1e6"
            )));
        };
        let names: Vec<String> = methods.iter().map(|m| m.name.clone()).collect();
        let method = methods.iter_mut().find(|method| method.name == name);
        match method.map(|method| &mut method.kind) {
            Some(Kind::Integrator { set, .. }) => set.push((key.to_owned(), value.clone())),
            Some(Kind::External(_)) => {
                return Err(Failure::usage(format_args!(
                    "--set {name}.{key}: `{name}` is a command, its parameters belong there"
                )));
            }
            None => return Err(Failure::unknown("method", name, names.iter().map(String::as_str))),
        }
    }
    Ok(())
}

/// Something to compare, and names that tell apart.
fn check(given: &file::Given) -> Result<(), Failure> {
    if given.methods.is_empty() {
        return Err(Failure::usage("expected methods to compare: --with NAMES, --external, or in the file"));
    }
    if given.scenes.is_empty() {
        return Err(Failure::usage("the file has no [[scene]] to compare on"));
    }
    let twice =
        |names: Vec<&str>| names.iter().enumerate().find(|(i, n)| names[..*i].contains(n)).map(|(_, n)| n.to_string());
    if let Some(name) = twice(given.methods.iter().map(|m| m.name.as_str()).collect()) {
        return Err(Failure::usage(format_args!(
            "two methods are called `{name}`: give one another name, as in --with other={name}"
        )));
    }
    if let Some(name) = twice(given.scenes.iter().map(|s| s.name.as_str()).collect()) {
        return Err(Failure::usage(format_args!("two scenes are called `{name}`: give one another name")));
    }
    Ok(())
}
