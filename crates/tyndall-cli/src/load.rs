//! Scenes: from a file to what can be rendered.

use crate::args::SceneFile;
use crate::console::Console;
use crate::failure::Failure;
use tyndall::scene::Scene;
use tyndall::scene::desc::{FilmDesc, SceneDesc, ShapeDesc};
use tyndall_formats::mitsuba::{self, Loaded};

/// Reads a scene; warnings are said.
pub(crate) fn load(file: &SceneFile, console: Console) -> Result<Loaded, Failure> {
    let options = mitsuba::Options { defines: file.define.clone() };
    let loaded = mitsuba::read(&file.path, &options).map_err(|error| Failure::scene(&error))?;
    for warning in &loaded.warnings {
        console.warning(warning);
    }
    Ok(loaded)
}

/// Builds a scene; what a user should know about it is said.
pub(crate) fn build(desc: &SceneDesc, console: Console) -> Result<Scene, Failure> {
    let scene = Scene::build(desc).map_err(Failure::other)?;
    if desc.emitters.is_empty() && !shapes(desc).any(|shape| shape.emission.is_some()) {
        console.warning("the scene has no emitter: the picture will be black");
    }
    for note in scene.notes() {
        console.warning(note);
    }
    Ok(scene)
}

/// All shapes, those of groups once.
pub(crate) fn shapes(desc: &SceneDesc) -> impl Iterator<Item = &ShapeDesc> {
    desc.shapes.iter().chain(desc.shape_groups.iter().flatten())
}

/// The film with another size, whose crop is then gone, and another crop.
pub(crate) fn film(film: FilmDesc, size: Option<[u32; 2]>, crop: Option<[u32; 4]>) -> Result<FilmDesc, Failure> {
    let mut film = film;
    if let Some([width, height]) = size {
        film = FilmDesc { width, height, crop: None, ..film };
    }
    if let Some([x, y, width, height]) = crop {
        let inside = |start: u32, length: u32, whole: u32| u64::from(start) + u64::from(length) <= u64::from(whole);
        if !inside(x, width, film.width) || !inside(y, height, film.height) {
            let (w, h) = (film.width, film.height);
            return Err(Failure::usage(format_args!(
                "the crop {x},{y},{width},{height} leaves the film of {w}x{h} pixels"
            )));
        }
        film.crop = crop;
    }
    Ok(film)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn size_and_crop() {
        let scene = FilmDesc { width: 100, height: 50, crop: Some([1, 2, 3, 4]), ..Default::default() };
        assert_eq!(film(scene, None, None).unwrap(), scene);
        let resized = film(scene, Some([40, 30]), None).unwrap();
        assert_eq!((resized.width, resized.height, resized.crop), (40, 30, None));
        assert_eq!(film(scene, None, Some([90, 0, 10, 50])).unwrap().crop, Some([90, 0, 10, 50]));
        assert!(film(scene, None, Some([91, 0, 10, 50])).is_err());
        assert!(film(scene, Some([40, 30]), Some([0, 0, 41, 1])).is_err());
        assert!(film(scene, None, Some([u32::MAX, 0, 2, 1])).is_err());
    }
}
