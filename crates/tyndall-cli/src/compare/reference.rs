//! What errors are measured against: a picture that is given, or one that is rendered in two independent halves until its own
//! noise is small beside the contenders' errors.
//!
//! The halves live in a folder named by a hash of scene and method. They keep their checkpoints, so that a later comparison
//! with better contenders goes on where this one stopped.

use super::child;
use super::contender::{seconds_word, shown, slug};
use super::experiment::{Experiment, ReferenceChoice};
use super::picture::Loaded;
use super::subject::Subject;
use crate::console::Console;
use crate::failure::Failure;
use crate::progress::time;
use crate::statistics::Statistics;
use crate::{fingerprint, state};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use tyndall_report::agreement::{Agreement, Estimate};
use tyndall_report::{merge, report, split};

/// Seeds of the halves: far from those of contenders, which count from the scene's own.
const SEEDS: [u64; 2] = [0x7265_6661, 0x7265_6662];
/// A half's first chunk, seconds; never more than a twentieth of the limit.
const FIRST_CHUNK: f64 = 5.0;
/// The reference's error is to be this much smaller than the best contender's.
const SHARE: f64 = 0.1;

/// A reference in use.
#[derive(Debug)]
pub(crate) struct Reference {
    pub(crate) picture: Loaded,
    pub(crate) halves: Option<[Loaded; 2]>,
    /// For the report; its picture is added there.
    pub(crate) about: report::Reference,
}

impl Reference {
    /// For the split of errors.
    pub(crate) fn parts(&self) -> split::Reference<'_> {
        let halves = self.halves.as_ref().map(|[a, b]| [a.view(), b.view()]);
        split::Reference { picture: self.picture.view(), halves }
    }

    /// Its own relMSE, as far as known.
    pub(crate) fn own_error(&self) -> f64 {
        self.about.own_error.unwrap_or(0.0)
    }

    /// A picture that was given.
    pub(crate) fn read(path: &Path, subject: &Subject) -> Result<Self, Failure> {
        let picture = Loaded::read(path, subject.size).map_err(Failure::other)?;
        let source = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        Ok(Self { picture, halves: None, about: report::Reference { source, ..Default::default() } })
    }
}

/// A reference in the making.
#[derive(Debug)]
pub(crate) struct Halves<'a> {
    experiment: &'a Experiment,
    subject: &'a Subject,
    folder: PathBuf,
}

impl<'a> Halves<'a> {
    /// Of a scene; nothing is rendered yet.
    pub(crate) fn new(experiment: &'a Experiment, subject: &'a Subject) -> Self {
        let words = [subject.hash.to_string(), subject.reference_method.join(" ")];
        let hash = fingerprint::of_words(words.iter().map(String::as_str));
        let folder = experiment.reference_cache.join(format!("{}-{hash:016x}", slug(&subject.name)));
        Self { experiment, subject, folder }
    }

    /// Renders in chunks until the noise of both halves together is a tenth of what `best` says that the best contender's
    /// relMSE is, or the limit is spent.
    pub(crate) fn refine(
        &self,
        best: impl Fn(&Reference) -> Result<Option<f64>, Failure>,
        console: Console,
    ) -> Result<Result<Reference, String>, Failure> {
        std::fs::create_dir_all(&self.folder)
            .map_err(|error| Failure::other(format_args!("{}: {error}", self.folder.display())))?;
        let limit = self.experiment.reference_limit.as_secs_f64() / 2.0;
        let mut each = FIRST_CHUNK.min(limit / 10.0).max(0.05).max(self.done()?);
        loop {
            console.say(format_args!(
                "  reference by {}: two halves of {}",
                self.subject.reference_method[0],
                time(each)
            ));
            for half in 0..2 {
                if let Err(message) = self.render(half, each)? {
                    return Ok(Err(message));
                }
            }
            let mut reference = self.read()?;
            let (own, aim) = (reference.own_error(), best(&reference)?.map(|error| SHARE * error));
            reference.about.aim = aim;
            let Some(aim) = aim.filter(|aim| own > *aim) else {
                return Ok(Ok(reference));
            };
            if each >= 0.999 * limit {
                let warning = format!(
                    "the reference's own relMSE {own:.2e} is above the {aim:.2e} aimed at after {}: allow more with \
                     --reference-limit",
                    time(2.0 * limit)
                );
                reference.about.warnings.push(warning);
                return Ok(Ok(reference));
            }
            // Noise falls with the time; a little more than needed, and not much more than known.
            let factor = if aim > 0.0 { (1.1 * own / aim).clamp(1.5, 4.0) } else { 4.0 };
            each = (each * factor).min(limit);
        }
    }

    /// Rendering time that both halves have.
    fn done(&self) -> Result<f64, Failure> {
        let statistics = [0, 1].map(|half| self.statistics(half));
        let [a, b] = statistics;
        Ok(a?.map_or(0.0, |s| s.render_seconds).min(b?.map_or(0.0, |s| s.render_seconds)))
    }

    fn statistics(&self, half: usize) -> Result<Option<Statistics>, Failure> {
        state::read(&self.folder.join(format!("half-{half}.json")))
    }

    /// The words of a half's command up to its files.
    fn words(&self, half: usize, seconds: f64, scene: &Path) -> Vec<OsString> {
        let mut words: Vec<OsString> = vec!["render".into(), scene.into()];
        let mut add = |key: &str, value: OsString| words.extend([key.into(), value]);
        self.subject.define.iter().for_each(|(name, value)| add("-D", format!("{name}={value}").into()));
        add("-i", (&self.subject.reference_method[0]).into());
        if let Some([width, height]) = self.experiment.size {
            add("--size", format!("{width}x{height}").into());
        }
        add("--seed", SEEDS[half].to_string().into());
        add("--threads", self.experiment.threads.to_string().into());
        add("--time", seconds_word(seconds));
        words
    }

    /// Goes on with a half until it has `seconds` of rendering time.
    fn render(&self, half: usize, seconds: f64) -> Result<Result<(), String>, Failure> {
        // The last pass is begun only if half of it fits.
        if self.statistics(half)?.is_some_and(|s| s.render_seconds >= 0.999 * seconds) {
            return Ok(Ok(()));
        }
        let program = std::env::current_exe()
            .map_err(|error| Failure::other(format_args!("cannot find this program's own file: {error}")))?;
        let names = [format!("half-{half}.json"), format!("half-{half}.exr")];
        let end = ["--resume", "--keep-checkpoint", "--checkpoint", "20s", "--variance", "--no-preview"];
        let files = ["--statistics", &names[0], "-o", &names[1]];
        let end = end.iter().chain(&files).map(OsString::from);
        let words = [vec![program.into_os_string()], self.words(half, seconds, &self.subject.path)].concat();
        let words: Vec<OsString> = words.into_iter().chain(end).collect();
        let ended = child::run(&words, &self.folder, &self.folder.join(format!("half-{half}.txt")), None)?;
        Ok(ended.failure.map_or(Ok(()), |message| Err(format!("the reference could not be rendered: {message}"))))
    }

    /// Both halves as one.
    fn read(&self) -> Result<Reference, Failure> {
        let half = |half: usize| {
            Loaded::read(&self.folder.join(format!("half-{half}.exr")), self.subject.size).map_err(Failure::other)
        };
        let halves = [half(0)?, half(1)?];
        let known = |half: usize| self.statistics(half).map(Option::unwrap_or_default);
        let statistics = [known(0)?, known(1)?];
        let weights = statistics.each_ref().map(|s| f64::from(s.samples.max(1)));
        let values = [0, 1].map(|i| (halves[i].pixels.as_flattened(), weights[i]));
        let mean = merge::mean(&values).map_err(Failure::other)?;
        let picture = Loaded { pixels: mean.as_chunks::<3>().0.to_vec(), variance: None, ..halves[0].clone() };
        let estimate = |i: usize| {
            let (picture, samples) = (halves[i].view(), statistics[i].samples);
            halves[i].variance_view().map(|variance| Estimate { picture, variance, samples })
        };
        let agreement = match (estimate(0), estimate(1)) {
            (Some(a), Some(b)) => Agreement::of(a, b).map_err(Failure::other)?,
            _ => None,
        };
        let commands = [0, 1].map(|half| {
            let words = self.words(half, statistics[half].render_seconds, &self.subject.shown);
            let out = ["-o".into(), format!("{}-reference-{half}.exr", slug(&self.subject.name)).into()];
            shown(&[vec!["tyndall".into()], words, out.into()].concat())
        });
        let about = report::Reference {
            source: format!("`{}`, {}", self.subject.reference_method[0], self.subject.reference_method[1]),
            commands: commands.into(),
            samples: Some(statistics.iter().map(|s| u64::from(s.samples)).sum()),
            seconds: Some(statistics.iter().map(|s| s.render_seconds).sum()),
            agreement,
            warnings: self.subject.reference_note.iter().cloned().collect(),
            ..Default::default()
        };
        let mut reference = Reference { picture, halves: Some(halves), about };
        reference.about.own_error = Some(reference.parts().own_error());
        Ok(reference)
    }
}

/// Whether a reference has to be rendered.
pub(crate) fn is_automatic(choice: &ReferenceChoice) -> bool {
    *choice == ReferenceChoice::Auto
}
