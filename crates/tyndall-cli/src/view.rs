//! `tyndall view`: the report's viewer for any pictures.

use crate::args::View;
use crate::compare::Loaded;
use crate::console::Console;
use crate::failure::Failure;
use std::path::Path;
use tyndall_formats::file::write_atomically;
use tyndall_report::flip::{self, PIXELS_PER_DEGREE};
use tyndall_report::metrics::Metric;
use tyndall_report::report::{Method, Pictures, Quantity, Reference, Report, Scene, page};
use tyndall_report::summary::Figure;

/// Writes the page and opens it.
pub(crate) fn run(args: &View) -> Result<(), Failure> {
    let reference = args.reference.as_deref().map(read).transpose()?;
    let pictures = args.pictures.iter().map(read).collect::<Result<Vec<_>, _>>()?;
    if let Some(reference) = &reference
        && let Some(i) = pictures.iter().position(|p| size(p) != size(reference))
    {
        let ([w, h], [rw, rh]) = (size(&pictures[i]), size(reference));
        let path = args.pictures[i].display();
        return Err(Failure::other(format_args!("{path} has {w}x{h} pixels, the reference {rw}x{rh}")));
    }
    let mut embedded = Pictures::default();
    let names = names(&args.pictures.iter().map(|path| path.as_path()).collect::<Vec<_>>());
    let mut scenes: Vec<Scene> = Vec::new();
    for (picture, name) in pictures.iter().zip(names) {
        let [width, height] = size(picture);
        let known = scenes.iter().position(|scene| (scene.width, scene.height) == (width, height));
        let at = known.unwrap_or_else(|| {
            let name = format!("{width} × {height}");
            scenes.push(Scene { name, width, height, ..Scene::default() });
            scenes.len() - 1
        });
        scenes[at].methods.push(method(name, picture, reference.as_ref(), &mut embedded)?);
    }
    if let (Some(reference), Some(path)) = (&reference, &args.reference) {
        let picture = Some(embedded.add_colours(reference.width, &reference.pixels));
        let source = path.display().to_string();
        scenes[0].reference = Some(Reference { source, picture, ..Reference::default() });
    }
    let report = Report {
        title: args.title.clone().unwrap_or_else(|| "Pictures".into()),
        program: concat!("tyndall ", env!("CARGO_PKG_VERSION")).into(),
        scenes,
        quantities: Quantity::ALL.map(Quantity::describe).into(),
        ..Report::default()
    };
    write_atomically(&args.output, page::page(&report, &embedded).as_bytes()).map_err(Failure::other)?;
    Console::NORMAL.say(format_args!("wrote {}", args.output.display()));
    if !args.no_open
        && let Err(error) = open::that_detached(&args.output)
    {
        Console::NORMAL.warning(format_args!("no browser could be started: {error}"));
    }
    Ok(())
}

fn read(path: impl AsRef<Path>) -> Result<Loaded, Failure> {
    Loaded::any(path.as_ref()).map_err(Failure::other)
}

fn size(picture: &Loaded) -> [usize; 2] {
    [picture.width, picture.height]
}

fn method(
    name: String,
    picture: &Loaded,
    reference: Option<&Loaded>,
    embedded: &mut Pictures,
) -> Result<Method, Failure> {
    let shown = Some(embedded.add_colours(picture.width, &picture.pixels));
    let mut method = Method { name, picture: shown, ..Method::default() };
    if let Some(reference) = reference {
        let (a, b) = (picture.view(), reference.view());
        let map = flip::map(a, b, PIXELS_PER_DEGREE).map_err(Failure::other)?;
        method.flip = Some(embedded.add_map(picture.width, &map));
        let error = Metric::RelMse.mean(a, b).map_err(Failure::other)?;
        if let Some(figure) = Figure::new(vec![error]) {
            method.figures.insert(Quantity::RelMse.key(), figure);
        }
    }
    Ok(method)
}

/// Short names that tell the files apart: the stem, or the whole path where two have the same.
fn names(paths: &[&Path]) -> Vec<String> {
    let stem = |path: &Path| path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let stems: Vec<String> = paths.iter().map(|path| stem(path)).collect();
    let mut names: Vec<String> = Vec::new();
    for (path, stem) in paths.iter().zip(&stems) {
        let unique = stems.iter().filter(|other| *other == stem).count() == 1;
        let mut name = if unique { stem.clone() } else { path.display().to_string() };
        while names.contains(&name) {
            name += " (again)";
        }
        names.push(name);
    }
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_tell_files_apart() {
        let paths = ["x/a.exr", "y/a.exr", "y/b.exr", "y/b.exr"].map(Path::new);
        assert_eq!(names(&paths), ["x/a.exr", "y/a.exr", "y/b.exr", "y/b.exr (again)"]);
    }
}
