//! One render of one method on one scene, in a process of its own, kept in a folder of its own.

use super::child;
use super::experiment::{Budget, Experiment, Kind, Method};
use super::picture::{Loaded, relative_error};
use super::record::{Moment, Record};
use super::subject::Subject;
use super::template::{Template, Values};
use crate::failure::Failure;
use crate::{fingerprint, state, statistics};
use std::ffi::OsString;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// The first stop on the way to an error, seconds.
const FIRST_STOP: f64 = 0.5;
/// Another renderer is ended after so many times its budget, and a minute.
const PATIENCE: u32 = 10;
/// Samples per pixel grow by this between trials of another renderer.
const GROWTH: u32 = 4;
/// A render of another renderer that took less of its time than this is done again with more samples.
const SHORT: f64 = 0.8;
/// But not for ever.
const MOST_TRIALS: usize = 12;

/// What is rendered.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Contender<'a> {
    pub(crate) experiment: &'a Experiment,
    pub(crate) subject: &'a Subject,
    /// Index of the method.
    pub(crate) method: usize,
    /// From 0.
    pub(crate) repeat: u32,
}

impl Contender<'_> {
    fn method(&self) -> &Method {
        &self.experiment.methods[self.method]
    }

    fn seed(&self) -> u64 {
        self.subject.seed.wrapping_add(u64::from(self.repeat))
    }

    /// `OUTPUT/runs/box/vpm-1-0123456789abcdef`: the hash is of everything that the render depends on.
    fn folder(&self) -> PathBuf {
        let e = self.experiment;
        let budget = format!("{:?} {:?} {}", e.budget, e.limit, e.threads);
        let seed = self.seed().to_string();
        let scene = self.subject.hash.to_string();
        let hash = fingerprint::of_words([scene.as_str(), &self.subject.descriptions[self.method], &budget, &seed]);
        let name = format!("{}-{}-{hash:016x}", slug(&self.method().name), self.repeat + 1);
        e.output.join("runs").join(slug(&self.subject.name)).join(name)
    }

    /// The picture of a moment.
    pub(crate) fn picture(&self, file: &str) -> PathBuf {
        self.folder().join(file)
    }

    /// The finished render, if there is one.
    pub(crate) fn finished(&self) -> Result<Option<Record>, Failure> {
        let record: Option<Record> = state::read(&self.folder().join(Record::FILE))?;
        Ok(record.filter(|record| record.failure.is_none()))
    }

    /// Renders. Whatever goes wrong with the method is in the record; an error is of the comparison itself.
    ///
    /// `samples` are what the first repeat of another renderer came to, `reference` is needed for equal error.
    pub(crate) fn run(&self, samples: Option<u64>, reference: Option<&Loaded>) -> Result<Record, Failure> {
        let folder = self.folder();
        let mut progress: Vec<Moment> = state::read(&folder.join("progress.json"))?.unwrap_or_default();
        if progress.is_empty() {
            renew(&folder)?;
        }
        let result = match (&self.method().kind, self.experiment.budget) {
            (Kind::Integrator { .. }, Budget::Error(error)) => {
                self.up_to_error(&folder, &mut progress, error, reference)
            }
            (Kind::Integrator { .. }, budget) => self.once(&folder, budget),
            (Kind::External(template), budget) => {
                self.other_renderer(&folder, template, budget, samples, &mut progress, reference)
            }
        };
        let record = match result {
            Ok(record) => record,
            Err(Problem::Method(message)) => Record::failed(message, self.command(), self.has_seed()),
            Err(Problem::Comparison(failure)) => return Err(failure),
        };
        state::write(&folder.join(Record::FILE), &record)?;
        Ok(record)
    }

    fn has_seed(&self) -> Option<u64> {
        match &self.method().kind {
            Kind::External(template) if !template.has_seed() => None,
            _ => Some(self.seed()),
        }
    }

    /// The words of `tyndall render` up to the budget; `scene` is its path.
    fn words(&self, scene: &Path) -> Vec<OsString> {
        let mut words: Vec<OsString> = vec!["render".into(), scene.into()];
        let mut add = |key: &str, value: String| words.extend([key.into(), value.into()]);
        self.subject.define.iter().for_each(|(name, value)| add("-D", format!("{name}={value}")));
        if let Kind::Integrator { info, set } = &self.method().kind {
            add("-i", info.name.into());
            set.iter().for_each(|(key, value)| add("--set", format!("{key}={value}")));
        }
        if let Some([width, height]) = self.experiment.size {
            add("--size", format!("{width}x{height}"));
        }
        add("--seed", self.seed().to_string());
        add("--threads", self.experiment.threads.to_string());
        words
    }

    /// What a person would type.
    fn command(&self) -> String {
        let name = format!("{}-{}-{}.exr", slug(&self.subject.name), slug(&self.method().name), self.repeat + 1);
        let words = match &self.method().kind {
            Kind::Integrator { .. } => {
                let budget = match self.experiment.budget {
                    Budget::Time(time) => {
                        vec!["--time".into(), seconds_word(time.as_secs_f64()), "--include-load".into()]
                    }
                    Budget::Samples(n) => vec!["--spp".into(), n.to_string().into()],
                    Budget::Error(_) => vec!["--time".into(), seconds_word(self.experiment.limit.as_secs_f64())],
                };
                let end = ["-o".into(), name.into()];
                [vec!["tyndall".into()], self.words(&self.subject.shown), budget, end.into()].concat()
            }
            Kind::External(template) => {
                let spp = match self.experiment.budget {
                    Budget::Samples(n) => n,
                    _ => 1,
                };
                template.fill(&self.values(&self.subject.shown, Path::new(&name), spp))
            }
        };
        shown(&words)
    }

    fn values<'b>(&'b self, scene: &'b Path, out: &'b Path, spp: u32) -> Values<'b> {
        Values {
            scene,
            out,
            spp,
            seed: self.seed(),
            threads: self.experiment.threads,
            size: self.subject.size,
            define: &self.subject.define,
        }
    }

    /// A render with a budget of time or samples, looked at in passing.
    fn once(&self, folder: &Path, budget: Budget) -> Result<Record, Problem> {
        let budget: Vec<OsString> = match budget {
            Budget::Time(time) => vec!["--time".into(), seconds_word(time.as_secs_f64()), "--include-load".into()],
            Budget::Samples(n) => vec!["--spp".into(), n.to_string().into()],
            Budget::Error(_) => unreachable!("errors are approached in stops"),
        };
        let more = ["--series", "series"].map(OsString::from);
        let found = self.render(folder, [budget, more.into()].concat())?;
        let setup = found.load_seconds + found.build_seconds;
        let moment = |file: String, samples: u32, render_seconds: f64| Moment {
            file,
            samples: samples.into(),
            seconds: setup + render_seconds,
            render_seconds,
        };
        let series = found.series.iter().filter(|m| m.samples < found.samples);
        let mut moments: Vec<Moment> =
            series.map(|m| moment(format!("series/{}", m.file), m.samples, m.render_seconds)).collect();
        moments.push(moment(Record::PICTURE.into(), found.samples, found.render_seconds));
        Ok(self.record(&found, moments, child::warnings(&folder.join("log.txt"))))
    }

    fn record(&self, found: &statistics::Statistics, moments: Vec<Moment>, warnings: Vec<String>) -> Record {
        Record {
            failure: None,
            seed: Some(self.seed()),
            command: self.command(),
            seconds: found.load_seconds + found.build_seconds + found.render_seconds,
            load: Some(found.load_seconds),
            build: Some(found.build_seconds),
            render: Some(found.render_seconds),
            samples: found.samples.into(),
            light_paths: found.light_paths,
            photons: found.photons,
            memory: found.peak_memory,
            warnings,
            moments,
        }
    }

    /// Runs `tyndall render` to `picture.exr`.
    fn render(&self, folder: &Path, more: Vec<OsString>) -> Result<statistics::Statistics, Problem> {
        let program = std::env::current_exe()
            .map_err(|error| Failure::other(format_args!("cannot find this program's own file: {error}")))?;
        let end = ["--variance", "--no-preview", "--statistics", "statistics.json", "-o", Record::PICTURE];
        let words =
            [vec![program.into_os_string()], self.words(&self.subject.path), more, end.map(OsString::from).into()]
                .concat();
        let ended = child::run(&words, folder, &folder.join("log.txt"), None)?;
        if let Some(failure) = ended.failure {
            return Err(Problem::Method(failure));
        }
        let found: Option<statistics::Statistics> = state::read(&folder.join("statistics.json"))?;
        let mut found = found.ok_or_else(|| Problem::Method("wrote no statistics".into()))?;
        found.peak_memory = found.peak_memory.or(ended.memory);
        Loaded::read(&folder.join(Record::PICTURE), self.subject.size).map_err(Problem::Method)?;
        Ok(found)
    }

    /// Renders on and on, looking at the error whenever the time has doubled.
    fn up_to_error(
        &self,
        folder: &Path,
        progress: &mut Vec<Moment>,
        error: f64,
        reference: Option<&Loaded>,
    ) -> Result<Record, Problem> {
        let reference = reference.ok_or_else(|| Problem::Method("there is no reference to measure against".into()))?;
        let limit = self.experiment.limit.as_secs_f64();
        let mut light = [0, 0];
        loop {
            let last = progress.last().map_or(FIRST_STOP / 2.0, |moment| moment.render_seconds);
            let stop = (2.0 * last).min(limit);
            let words = ["--time".into(), seconds_word(stop), "--resume".into(), "--keep-checkpoint".into()];
            let found = self.render(folder, words.into())?;
            light = [light[0] + found.light_paths, light[1] + found.photons];
            let file = format!("stop-{}.exr", progress.len());
            std::fs::copy(folder.join(Record::PICTURE), folder.join(&file))
                .map_err(|e| Failure::other(format_args!("cannot write {file}: {e}")))?;
            progress.push(Moment {
                file,
                samples: found.samples.into(),
                seconds: found.load_seconds + found.build_seconds + found.render_seconds,
                render_seconds: found.render_seconds,
            });
            state::write(&folder.join("progress.json"), progress)?;
            let picture = Loaded::read(&folder.join(Record::PICTURE), self.subject.size).map_err(Problem::Method)?;
            let reached = relative_error(&picture, reference)? <= error;
            if reached || stop >= limit {
                let mut warnings = child::warnings(&folder.join("log.txt"));
                if !reached {
                    warnings.push(format!("did not come to a relative error of {error} in {limit} s"));
                }
                let [light_paths, photons] = light;
                return Ok(Record { light_paths, photons, ..self.record(&found, progress.clone(), warnings) });
            }
        }
    }

    /// Another renderer: a few short trials tell its rate, then one render has the budget. The trials are the points of its
    /// curve.
    fn other_renderer(
        &self,
        folder: &Path,
        template: &Template,
        budget: Budget,
        samples: Option<u64>,
        progress: &mut Vec<Moment>,
        reference: Option<&Loaded>,
    ) -> Result<Record, Problem> {
        let mut run = |spp: u32, file: &str| self.external(folder, template, spp, file);
        let mut warnings = Vec::new();
        let spp = match (budget, samples) {
            (Budget::Samples(n), _) => n,
            (_, Some(n)) => u32::try_from(n).unwrap_or(u32::MAX),
            (Budget::Time(time), None) => loop {
                if let Some(spp) = fitting(progress, time.as_secs_f64()) {
                    break spp;
                }
                self.trial(folder, progress, &mut run)?;
            },
            (Budget::Error(error), None) => loop {
                let last = progress.last().cloned();
                if let Some(last) = last {
                    let reference =
                        reference.ok_or_else(|| Problem::Method("there is no reference to measure against".into()))?;
                    let picture = Loaded::read(&folder.join(&last.file), self.subject.size).map_err(Problem::Method)?;
                    let reached = relative_error(&picture, reference)? <= error;
                    if !reached && last.seconds * f64::from(GROWTH) > self.experiment.limit.as_secs_f64() {
                        warnings.push(format!("did not come to a relative error of {error}"));
                        break u32::try_from(last.samples).unwrap_or(u32::MAX);
                    }
                    if reached {
                        break u32::try_from(last.samples).unwrap_or(u32::MAX);
                    }
                }
                self.trial(folder, progress, &mut run)?;
            },
        };
        let (seconds, memory, command) = run(spp, Record::PICTURE)?;
        if let (Budget::Time(time), None) = (budget, samples)
            && seconds < SHORT * time.as_secs_f64()
            && progress.len() < MOST_TRIALS
        {
            // The rate was wrong, on a busy machine say: what was meant as the last render is one more trial.
            let file = format!("trial-{}.exr", progress.len());
            std::fs::rename(folder.join(Record::PICTURE), folder.join(&file))
                .map_err(|error| Failure::other(format_args!("cannot write {file}: {error}")))?;
            progress.push(Moment { file, samples: spp.into(), seconds, render_seconds: seconds });
            state::write(&folder.join("progress.json"), progress)?;
            return self.other_renderer(folder, template, budget, samples, progress, reference);
        }
        let mut moments = progress.clone();
        moments.retain(|moment| moment.samples < u64::from(spp));
        let file = Record::PICTURE.to_owned();
        moments.push(Moment { file, samples: spp.into(), seconds, render_seconds: seconds });
        Ok(Record {
            seed: self.has_seed(),
            command,
            seconds,
            samples: spp.into(),
            memory,
            warnings,
            moments,
            ..Record::default()
        })
    }

    /// The next of the short renders.
    fn trial(
        &self,
        folder: &Path,
        progress: &mut Vec<Moment>,
        run: &mut impl FnMut(u32, &str) -> Result<(f64, Option<u64>, String), Problem>,
    ) -> Result<(), Problem> {
        let spp = progress.last().map_or(1, |last| last.samples as u32 * GROWTH);
        let file = format!("trial-{}.exr", progress.len());
        let (seconds, ..) = run(spp, &file)?;
        progress.push(Moment { file, samples: spp.into(), seconds, render_seconds: seconds });
        state::write(&folder.join("progress.json"), progress)?;
        Ok(())
    }

    /// Runs the template; the time, the memory and what a person would type.
    fn external(
        &self,
        folder: &Path,
        template: &Template,
        spp: u32,
        file: &str,
    ) -> Result<(f64, Option<u64>, String), Problem> {
        let out = std::path::absolute(folder.join(file))
            .map_err(|error| Failure::other(format_args!("{}: {error}", folder.display())))?;
        let words = template.fill(&self.values(&self.subject.path, &out, spp));
        let limit = match self.experiment.budget {
            Budget::Time(time) => time * PATIENCE + Duration::from_secs(60),
            _ => self.experiment.limit,
        };
        let ended = child::run(&words, folder, &folder.join("log.txt"), Some(limit))?;
        if let Some(failure) = ended.failure {
            return Err(Problem::Method(failure));
        }
        if !out.is_file() {
            return Err(Problem::Method(format!(
                "ended well, but wrote no picture to {{out}} at {spp} samples per pixel"
            )));
        }
        Loaded::read(&out, self.subject.size).map_err(Problem::Method)?;
        let name = format!("{}-{}-{}.exr", slug(&self.subject.name), slug(&self.method().name), self.repeat + 1);
        let command = shown(&template.fill(&self.values(&self.subject.shown, Path::new(&name), spp)));
        Ok((ended.seconds, ended.memory, command))
    }
}

/// Samples per pixel that fill a time, once the trials tell: the last of them has to take an eighth of it.
fn fitting(trials: &[Moment], time: f64) -> Option<u32> {
    let last = trials.last()?;
    if last.seconds >= 0.9 * time {
        return Some(last.samples as u32);
    }
    let before = trials.len().checked_sub(2).map(|i| &trials[i])?;
    let grown = last.seconds - before.seconds;
    if last.seconds < time / 8.0 || grown <= 0.02 * time {
        return None;
    }
    let rate = (last.samples - before.samples) as f64 / grown;
    let spp = last.samples as f64 + (time - last.seconds) * rate;
    Some(spp.clamp(1.0, f64::from(u32::MAX)) as u32)
}

/// What can go wrong.
#[derive(Debug)]
enum Problem {
    /// The method: a row says so, the rest goes on.
    Method(String),
    /// The comparison itself.
    Comparison(Failure),
}

impl From<Failure> for Problem {
    fn from(failure: Failure) -> Self {
        Self::Comparison(failure)
    }
}

/// An empty folder.
fn renew(folder: &Path) -> Result<(), Failure> {
    let fail = |error: std::io::Error| Failure::other(format_args!("{}: {error}", folder.display()));
    if folder.exists() {
        std::fs::remove_dir_all(folder).map_err(fail)?;
    }
    std::fs::create_dir_all(folder).map_err(fail)
}

/// A name that any file system takes.
pub(crate) fn slug(name: &str) -> String {
    let mut slug = String::new();
    for c in name.chars() {
        if c.is_alphanumeric() || c == '_' {
            slug.push(c);
        } else if !slug.ends_with('-') {
            slug.push('-');
        }
    }
    let slug = slug.trim_matches('-');
    if slug.is_empty() { "unnamed".into() } else { slug.to_owned() }
}

/// Words as a shell takes them.
pub(crate) fn shown(words: &[OsString]) -> String {
    let mut text = String::new();
    for word in words {
        let word = word.to_string_lossy();
        let quoted = shlex::try_quote(&word).unwrap_or_else(|_| word.clone());
        let _ = write!(text, "{}{quoted}", if text.is_empty() { "" } else { " " });
    }
    text
}

/// `1.5s`, to the millisecond.
pub(super) fn seconds_word(seconds: f64) -> OsString {
    format!("{}s", (seconds * 1e3).round() / 1e3).into()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trial(samples: u64, seconds: f64) -> Moment {
        Moment { samples, seconds, ..Moment::default() }
    }

    #[test]
    fn samples_fill_the_time() {
        // Two seconds to start, ten samples a second.
        let trials: Vec<Moment> = [1, 4, 16, 64].map(|n| trial(n, 2.0 + n as f64 / 10.0)).into();
        assert_eq!(fitting(&trials[..1], 30.0), None);
        assert_eq!(fitting(&trials[..2], 30.0), None);
        assert_eq!(fitting(&trials, 30.0), Some(280));
        assert_eq!(fitting(&trials[..1], 2.0), Some(1));
    }

    #[test]
    fn names_of_folders() {
        assert_eq!(slug("a b/c..d"), "a-b-c-d");
        assert_eq!(slug("../"), "unnamed");
        assert_eq!(slug("größe_1"), "größe_1");
    }
}
