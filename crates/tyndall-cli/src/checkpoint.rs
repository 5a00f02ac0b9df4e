//! The file that a rendering continues from.
//!
//! It lies beside the picture as `PICTURE.checkpoint` and is replaced as a whole, so that it is complete at any moment.
//! It carries a fingerprint of everything that the picture depends on except the budget: a rendering can be continued
//! with more samples.

use crate::console::Console;
use crate::failure::Failure;
use crate::fingerprint::of_scene;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use tyndall::render::Rendering;
use tyndall::scene::desc::SceneDesc;
use tyndall_formats::file::write_atomically;

/// Without `--checkpoint`.
const DEFAULT_INTERVAL: Duration = Duration::from_secs(60);

/// The checkpoints of one rendering.
pub(crate) struct Checkpoints {
    path: PathBuf,
    fingerprint: u64,
    interval: Duration,
    last: Instant,
}

impl Checkpoints {
    /// For the picture `output` of `desc`, which has to name the integrator and the seed in use.
    pub(crate) fn new(output: &Path, desc: &SceneDesc, interval: Option<Duration>) -> Self {
        let mut path = output.as_os_str().to_owned();
        path.push(".checkpoint");
        Self {
            path: path.into(),
            fingerprint: of_scene(desc),
            interval: interval.unwrap_or(DEFAULT_INTERVAL),
            last: Instant::now(),
        }
    }

    /// Continues from the checkpoint if there is one.
    pub(crate) fn resume(&self, rendering: &mut Rendering, console: Console) -> Result<(), Failure> {
        let path = self.path.display();
        let bytes = match std::fs::read(&self.path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == ErrorKind::NotFound => {
                console.say(format_args!("there is no {path} to continue from: starting anew"));
                return Ok(());
            }
            Err(error) => return Err(Failure::other(format_args!("{path}: cannot be read: {error}"))),
        };
        rendering.resume(&bytes, self.fingerprint).map_err(|error| {
            Failure::other(format_args!("{path}: {error}; remove it or leave out --resume to start anew"))
        })?;
        console.say(format_args!("continuing from {path} at {} samples per pixel", rendering.passes()));
        Ok(())
    }

    /// Writes a checkpoint if it is time for one.
    pub(crate) fn tick(&mut self, rendering: &Rendering) -> Result<(), Failure> {
        if self.last.elapsed() < self.interval { Ok(()) } else { self.write(rendering) }
    }

    /// Writes a checkpoint.
    pub(crate) fn write(&mut self, rendering: &Rendering) -> Result<(), Failure> {
        write_atomically(&self.path, &rendering.checkpoint(self.fingerprint)).map_err(Failure::other)?;
        self.last = Instant::now();
        Ok(())
    }

    /// Removes the checkpoint of a finished picture.
    pub(crate) fn remove(&self) -> Result<(), Failure> {
        match std::fs::remove_file(&self.path) {
            Err(error) if error.kind() != ErrorKind::NotFound => {
                Err(Failure::other(format_args!("{}: cannot be removed: {error}", self.path.display())))
            }
            _ => Ok(()),
        }
    }
}
