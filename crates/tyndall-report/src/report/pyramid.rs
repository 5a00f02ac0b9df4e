//! The page of a pyramid of techniques: two scenes, weighted and unweighted, whose methods are the techniques, and how these
//! lie in a grid.

use super::{Method, Pictures, Report, Scene, page};
use crate::View;
use serde::Serialize;
use tyndall::mis::{Merging, Technique};
use tyndall::render::TechniquePicture;

/// Pixels of all pictures together, at most about so many: larger pictures are reduced for the page.
const PAGE_PIXELS: usize = 4 << 20;

/// How the methods of each scene lie in a grid: pyramids of rows of pictures.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Grid {
    pyramids: Vec<Pyramid>,
    /// The methods to look at first.
    first: [usize; 2],
    /// The exposure to begin with, stops.
    exposure: f64,
    /// What a reader should know.
    note: String,
}

/// A pyramid: joins, or merges of one kind.
#[derive(Clone, Debug, Default, Serialize)]
struct Pyramid {
    heading: String,
    /// Part of the picture's light.
    share: f64,
    rows: Vec<Row>,
}

/// Techniques for paths of one length, more and more of whose vertices are light's.
#[derive(Clone, Debug, Default, Serialize)]
struct Row {
    name: String,
    /// Part of the picture's light.
    share: f64,
    cells: Vec<Cell>,
}

/// A picture of the grid.
#[derive(Clone, Debug, Default, Serialize)]
struct Cell {
    method: usize,
    label: String,
    /// Part of the whole picture's light; of the unweighted picture, in parts of the light of all paths of that length.
    shares: [Option<f64>; 2],
}

/// What a technique adds, in numbers, for `pyramid.json`.
#[derive(Clone, Debug, Serialize)]
pub struct Part {
    /// Name of the technique, that of its files.
    pub name: String,
    /// `join`, `merge` or `longer`.
    pub kind: &'static str,
    /// Depth of its paths.
    pub depth: Option<u32>,
    /// Vertices of light's walk, the emitter among them.
    pub s: Option<u32>,
    /// Vertices of the camera's walk, the lens among them; a vertex that is merged counts for both.
    pub t: Option<u32>,
    /// What is merged.
    pub merging: Option<&'static str>,
    /// What it does, one sentence.
    pub description: String,
    /// Mean radiance of the weighted picture, W/(m^2 sr).
    pub mean_weighted: [f64; 3],
    /// Mean radiance of the unweighted picture; `None` for techniques taken together.
    pub mean_unweighted: Option<[f64; 3]>,
    /// Luminance of the weighted picture over that of the whole picture.
    pub share: f64,
}

/// A pyramid in the making.
pub struct PyramidPage {
    report: Report,
    pictures: Pictures,
    whole: f64,
    reduction: usize,
    parts: Vec<Part>,
}

impl PyramidPage {
    /// Of a picture with that many techniques. `report` has title, program, command and so on; no scenes.
    pub fn new(report: Report, whole: View, techniques: usize) -> Self {
        let (width, height) = (whole.width(), whole.height());
        let pixels = width * height * (2 * techniques + 1);
        let reduction = (1..).find(|n| pixels / (n * n) <= PAGE_PIXELS).unwrap_or(1);
        let scene = |name: &str| Scene {
            name: name.into(),
            width: width.div_ceil(reduction),
            height: height.div_ceil(reduction),
            ..Scene::default()
        };
        let scenes = vec![scene("weighted"), scene("unweighted")];
        let luminance = luminance(mean(whole.pixels()));
        let exposure = usual_exposure(whole.pixels());
        let note = match reduction {
            1 => String::new(),
            n => format!("The page shows 1/{n} of {width} × {height} pixels; the .exr files have all of them."),
        };
        let grid = Grid { exposure, note, ..Grid::default() };
        let mut page = Self {
            report: Report { scenes, grid: Some(grid), ..report },
            pictures: Pictures::default(),
            whole: luminance,
            reduction,
            parts: Vec::new(),
        };
        let picture = Some(page.embed(width, whole.pixels()));
        for scene in &mut page.report.scenes {
            let description = "all techniques together".into();
            scene.methods.push(Method { name: "picture".into(), description, picture, ..Method::default() });
        }
        page
    }

    /// Adds a technique, in the order of [`tyndall::Rendering::pyramid`]. Its pictures are as wide as the whole.
    pub fn add(&mut self, width: usize, found: &TechniquePicture) {
        let TechniquePicture { technique, weighted, alone } = found;
        let together = *technique == Technique::Longer;
        let (mean_weighted, mean_alone) = (mean(weighted), mean(alone));
        let part = Part {
            mean_weighted,
            mean_unweighted: (!together).then_some(mean_alone),
            share: luminance(mean_weighted) / self.whole.max(f64::MIN_POSITIVE),
            ..describe(*technique)
        };
        let shown = [Some(self.embed(width, weighted)), (!together).then(|| self.embed(width, alone))];
        for (scene, picture) in self.report.scenes.iter_mut().zip(shown) {
            let (name, description) = (part.name.clone(), part.description.clone());
            scene.methods.push(Method { name, description, picture, ..Method::default() });
        }
        self.parts.push(part);
    }

    /// The techniques added.
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// The page.
    pub fn finish(mut self) -> String {
        let grid = self.report.grid.take().unwrap_or_default();
        self.report.grid = Some(arrange(grid, &self.parts));
        page::page(&self.report, &self.pictures)
    }

    fn embed(&mut self, width: usize, pixels: &[[f32; 3]]) -> usize {
        let (width, pixels) = reduce(width, pixels, self.reduction);
        self.pictures.add_colours(width, &pixels)
    }
}

/// The grid of all parts; method 0 is the whole picture.
fn arrange(grid: Grid, parts: &[Part]) -> Grid {
    let share = |parts: &[&(usize, &Part)]| parts.iter().map(|(_, part)| part.share).sum::<f64>();
    let numbered: Vec<(usize, &Part)> = parts.iter().enumerate().map(|(index, part)| (index + 1, part)).collect();
    let mut depths: Vec<Option<u32>> = parts.iter().map(|part| part.depth).collect();
    depths.dedup();
    let row = |depth: Option<u32>, merging: Option<&str>| {
        let of_depth: Vec<_> = numbered.iter().filter(|(_, part)| part.depth == depth).collect();
        let light: f64 = of_depth.iter().map(|(_, part)| luminance(part.mean_weighted)).sum();
        let chosen: Vec<_> = of_depth.into_iter().filter(|(_, part)| part.merging == merging).collect();
        let cell = |(method, part): &(usize, &Part)| Cell {
            method: *method,
            label: part.s.zip(part.t).map_or(part.kind.into(), |(s, t)| format!("s={s} t={t}")),
            shares: [
                Some(part.share),
                part.mean_unweighted.map(|mean| luminance(mean) / light).filter(|x| x.is_finite()),
            ],
        };
        let name = depth.map_or("longer".into(), |depth| format!("depth {depth}"));
        Row { name, share: share(&chosen), cells: chosen.into_iter().map(cell).collect() }
    };
    let pyramid = |heading: String, merging: Option<&str>| {
        let rows = depths.iter().map(|depth| row(*depth, merging)).filter(|row| !row.cells.is_empty()).collect();
        let all: Vec<_> = numbered.iter().filter(|(_, part)| part.merging == merging).collect();
        Pyramid { heading, share: share(&all), rows }
    };
    let mut joins = pyramid("Joined by an edge: s vertices from the light, t from the camera".into(), None);
    let whole = Cell { method: 0, label: "picture".into(), shares: [None, None] };
    joins.rows.insert(0, Row { name: "all".into(), share: 1.0, cells: vec![whole] });
    let lit = |name: &str| {
        let mut of_kind = parts.iter().filter(|part| part.merging == Some(name));
        of_kind.any(|part| luminance(part.mean_unweighted.unwrap_or_default()) > 0.0)
    };
    let merges = Merging::ALL.into_iter().filter(|merging| lit(merging.name()));
    let merges = merges.map(|m| pyramid(format!("{}: merging {}", m.name(), merged(m)), Some(m.name())));
    let largest = numbered.iter().max_by(|(_, a), (_, b)| a.share.total_cmp(&b.share));
    Grid { pyramids: [joins].into_iter().chain(merges).collect(), first: [0, largest.map_or(0, |(i, _)| *i)], ..grid }
}

/// What is merged, in words.
fn merged(merging: Merging) -> &'static str {
    match merging {
        Merging::Surface => "points on surfaces",
        Merging::PointPoint => "points near collisions of the camera's walk",
        Merging::BeamPoint => "points near the camera's ray",
        Merging::BeamBeam => "photon beams near the camera's ray",
    }
}

/// A technique without numbers.
fn describe(technique: Technique) -> Part {
    let (kind, s, t, merging, description) = match technique {
        Technique::Join { light, camera } => {
            let how = match (light, camera) {
                (0, _) => "the camera's walk runs into an emitter".into(),
                (1, _) => format!("an emitter is sampled from vertex {camera} of the camera's walk"),
                (_, 1) => format!("vertex {light} of light's walk is joined with the lens"),
                _ => format!("vertex {light} of light's walk is joined with vertex {camera} of the camera's"),
            };
            ("join", Some(light), Some(camera), None, how)
        }
        Technique::Merge { merging, light, camera } => {
            let how = format!(
                "merging {}: vertex {light} of light's walk is vertex {camera} of the camera's",
                merged(merging)
            );
            ("merge", Some(light), Some(camera), Some(merging.name()), how)
        }
        Technique::Longer => ("longer", None, None, None, "all longer paths, however they are found".into()),
    };
    Part {
        name: technique.to_string(),
        kind,
        depth: technique.depth(),
        s,
        t,
        merging,
        description,
        mean_weighted: [0.0; 3],
        mean_unweighted: None,
        share: 0.0,
    }
}

fn mean(pixels: &[[f32; 3]]) -> [f64; 3] {
    let n = pixels.len().max(1) as f64;
    std::array::from_fn(|c| pixels.iter().map(|p| f64::from(p[c])).sum::<f64>() / n)
}

fn luminance(rgb: [f64; 3]) -> f64 {
    0.212_671 * rgb[0] + 0.715_16 * rgb[1] + 0.072_169 * rgb[2]
}

/// Stops at which the bright parts are just not clipped.
fn usual_exposure(pixels: &[[f32; 3]]) -> f64 {
    let mut values: Vec<f32> = pixels.iter().map(|p| p[0].max(p[1]).max(p[2])).collect();
    values.sort_unstable_by(f32::total_cmp);
    let bright = f64::from(values[(values.len() * 97 / 100).min(values.len() - 1)]);
    if bright > 0.0 { ((0.9 / bright).log2() * 10.0).round().clamp(-100.0, 100.0) / 10.0 } else { 0.0 }
}

/// Means of blocks of `n` x `n` pixels, with the columns that result.
fn reduce(width: usize, pixels: &[[f32; 3]], n: usize) -> (usize, Vec<[f32; 3]>) {
    let height = pixels.len() / width;
    let columns = width.div_ceil(n);
    let block = |i: usize| {
        let (x, y) = (i % columns * n, i / columns * n);
        let rows = (y..height.min(y + n)).map(|y| &pixels[y * width + x..y * width + width.min(x + n)]);
        let block: Vec<[f32; 3]> = rows.flatten().copied().collect();
        mean(&block).map(|c| c as f32)
    };
    (columns, (0..columns * height.div_ceil(n)).map(block).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(technique: Technique, weighted: f32, alone: f32) -> TechniquePicture {
        let grey = |value: f32| vec![[value; 3]; 6];
        TechniquePicture { technique, weighted: grey(weighted), alone: grey(alone) }
    }

    #[test]
    fn techniques_lie_in_rows() {
        let join = |light, camera| Technique::Join { light, camera };
        let beams = |light, camera| Technique::Merge { merging: Merging::BeamBeam, light, camera };
        let points = Technique::Merge { merging: Merging::BeamPoint, light: 2, camera: 2 };
        let whole = [[1.0; 3]; 6];
        let mut page = PyramidPage::new(Report::default(), View::new(3, 2, &whole).unwrap(), 9);
        for (technique, weighted, alone) in [
            (join(0, 2), 0.25, 0.25),
            (join(0, 3), 0.0, 0.0),
            (join(1, 2), 0.5, 1.0),
            (join(2, 1), 0.0, 0.5),
            (points, 0.0, 0.0),
            (beams(2, 2), 0.125, 0.75),
            (beams(2, 3), 0.0, 0.0),
            (beams(3, 2), 0.0, 0.0),
            (Technique::Longer, 0.125, 0.0),
        ] {
            page.add(3, &picture(technique, weighted, alone));
        }
        let names: Vec<&str> = page.parts().iter().map(|part| part.name.as_str()).collect();
        assert_eq!(names[1..6], ["d2-s0-t3", "d2-s1-t2", "d2-s2-t1", "d2-bp2d-s2-t2", "d2-bb1d-s2-t2"]);
        assert!((page.parts()[2].share - 0.5).abs() < 1e-6);
        let grid = arrange(Grid::default(), page.parts());
        let rows = |i: usize| -> Vec<(&str, usize)> {
            grid.pyramids[i].rows.iter().map(|row| (row.name.as_str(), row.cells.len())).collect()
        };
        assert_eq!(rows(0), [("all", 1), ("depth 1", 1), ("depth 2", 3), ("longer", 1)]);
        assert_eq!(rows(1), [("depth 2", 1), ("depth 3", 2)]);
        assert_eq!((grid.pyramids.len(), grid.first), (2, [0, 3]), "what is black is not shown");
        // 0.625 of the light has depth 2; alone the technique claims 1.
        let shares = grid.pyramids[0].rows[2].cells[1].shares.map(Option::unwrap);
        assert!((shares[0] - 0.5).abs() < 1e-6 && (shares[1] - 1.6).abs() < 1e-6, "{shares:?}");
        let longer = &grid.pyramids[0].rows[3].cells[0];
        assert_eq!(longer.shares[1], None, "techniques taken together have no picture of their own");
        let html = page.finish();
        assert!(html.contains("\"pyramids\":[") && html.contains("id=\"picture-17\""));
    }

    #[test]
    fn large_pictures_are_reduced() {
        let pixels: Vec<[f32; 3]> = (0..15).map(|i| [i as f32, 1.0, 0.0]).collect();
        let (width, small) = reduce(5, &pixels, 2);
        assert_eq!((width, small.len()), (3, 6));
        assert_eq!([small[0], small[2], small[5]], [[3.0, 1.0, 0.0], [6.5, 1.0, 0.0], [14.0, 1.0, 0.0]]);
        assert_eq!(reduce(5, &pixels, 1), (5, pixels));
    }
}
