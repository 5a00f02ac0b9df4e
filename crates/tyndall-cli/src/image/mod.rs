//! `tyndall image`: what can be done with finished pictures.

mod diff;
mod info;
mod merge;

use crate::args::{Encoding, Image};
use crate::failure::Failure;
use crate::output::Target;
use std::path::Path;
use tyndall_formats::image::{Layer, Picture, read_picture};

/// Runs one of the commands.
pub(crate) fn run(args: &Image) -> Result<(), Failure> {
    match args {
        Image::Info { file } => info::run(file),
        Image::Convert { input, output, encoding } => convert(input, output, encoding),
        Image::Diff { picture, reference, metric, output } => diff::run(picture, reference, metric, output.as_deref()),
        Image::Merge { inputs, output } => merge::run(inputs, output),
    }
}

fn convert(input: &Path, output: &Path, encoding: &Encoding) -> Result<(), Failure> {
    let target = Target::new(output, encoding, false)?;
    target.write(&read(input)?)
}

fn read(path: &Path) -> Result<Picture, Failure> {
    read_picture(path).map_err(Failure::other)
}

/// The colours of the main layer.
fn colours(path: &Path, picture: &Picture) -> Result<Vec<[f32; 3]>, Failure> {
    let pixels = picture.layer("").and_then(Layer::to_rgb);
    pixels.ok_or_else(|| {
        Failure::other(format_args!("{} has no main layer of the channels R, G, B or Y", path.display()))
    })
}

/// Fails unless both pictures have as many pixels.
fn check_sizes(a: (&Path, &Picture), b: (&Path, &Picture)) -> Result<(), Failure> {
    let size = |picture: &Picture| (picture.width, picture.height);
    if size(a.1) == size(b.1) {
        return Ok(());
    }
    let text = |(path, picture): (&Path, &Picture)| {
        format!("{} has {}x{} pixels", path.display(), picture.width, picture.height)
    };
    Err(Failure::other(format_args!("the sizes differ: {}, {}", text(a), text(b))))
}
