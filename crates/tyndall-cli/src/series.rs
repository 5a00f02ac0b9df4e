//! Pictures at doubling times within one rendering.

use crate::failure::Failure;
use crate::output::Target;
use crate::statistics::Moment;
use std::path::{Path, PathBuf};
use tyndall::render::Rendering;
use tyndall_formats::image::Picture;

/// No picture before: a group of passes is hardly shorter.
const FIRST: f64 = 0.03;

/// Keeps pictures in a folder.
pub(crate) struct Series {
    folder: PathBuf,
    /// The next is kept when this much rendering time has passed; `None` until the first is there.
    next: Option<f64>,
    kept: Vec<Moment>,
}

impl Series {
    /// In `folder`, which is made. With a budget of time the times are its halves, quarters and so on, so that several
    /// renderings are sampled at the same times.
    pub(crate) fn new(folder: &Path, budget: Option<f64>) -> Result<Self, Failure> {
        std::fs::create_dir_all(folder)
            .map_err(|error| Failure::other(format_args!("cannot make the folder {}: {error}", folder.display())))?;
        let mut next = budget;
        while let Some(time) = next.as_mut().filter(|time| **time > FIRST) {
            *time /= 2.0;
        }
        Ok(Self { folder: folder.to_owned(), next, kept: Vec::new() })
    }

    /// Keeps the picture if it is time.
    pub(crate) fn observe(&mut self, rendering: &Rendering) -> Result<(), Failure> {
        let seconds = rendering.seconds();
        let mut next = self.next.unwrap_or(seconds);
        if seconds < next {
            return Ok(());
        }
        while next <= seconds {
            next *= 2.0;
        }
        self.next = Some(next);
        let picture = rendering.picture();
        let file = format!("{:03}.exr", self.kept.len());
        let picture = Picture::from_rgb(picture.width as usize, picture.height as usize, &picture.pixels);
        Target::plain(&self.folder.join(&file))?.write(&picture)?;
        self.kept.push(Moment { file, samples: rendering.passes(), render_seconds: seconds });
        Ok(())
    }

    /// What was kept.
    pub(crate) fn kept(self) -> Vec<Moment> {
        self.kept
    }
}
