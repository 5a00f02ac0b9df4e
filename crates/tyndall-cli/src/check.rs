//! `tyndall check`: what is in a scene.

use crate::args::Check;
use crate::choice;
use crate::console::{Console, print};
use crate::failure::Failure;
use crate::load::{build, load, shapes};
use crate::progress::quantity;
use std::collections::{BTreeMap, HashMap};
use std::fmt::Write;
use std::path::Path;
use std::sync::Arc;
use tyndall::scene::Scene;
use tyndall::scene::desc::{
    EmitterKind, FilmDesc, GeometryDesc, MediumDesc, MediumKind, PhaseDesc, ReconstructionFilter, Rgb, SceneDesc,
    SensorDesc, SensorKind, VolumeDesc,
};

/// Reads and builds a scene, prints a summary, says what a user should know.
pub(crate) fn run(args: &Check) -> Result<(), Failure> {
    let console = Console::NORMAL;
    let loaded = load(&args.scene, console)?;
    let integrator = choice::make(&loaded.scene.integrator, &loaded)?;
    let desc = loaded.scene;
    let scene = build(&desc, console)?;
    for warning in integrator.warnings(&scene) {
        console.warning(warning);
    }
    print(&summary(&args.scene.path, &desc, &scene))
}

fn summary(path: &Path, desc: &SceneDesc, scene: &Scene) -> String {
    let mut text = format!("{}\n", path.display());
    let mut line = |what: &str, value: String| _ = writeln!(text, "{what:<11} {value}");
    line("shapes", describe_shapes(desc));
    line("media", desc.media.len().to_string());
    for medium in &desc.media {
        line("", format!("`{}`: {}", medium.name, describe_medium(medium)));
    }
    line("emitters", describe_emitters(desc));
    line("camera", describe_sensor(&desc.sensor));
    if let Some(medium) = scene.camera_medium {
        line("", format!("inside the medium `{}`", desc.media[medium.0].name));
    }
    line("film", describe_film(&desc.film));
    line("sampler", format!("{} samples per pixel, seed {}", desc.sampler.sample_count, desc.sampler.seed));
    line("integrator", format!("{} {}", desc.integrator.name, choice::parameters(&desc.integrator)));
    let (geometry, pictures) = (scene.geometry.memory_bytes() as f64, picture_bytes(desc) as f64);
    let (geometry, pictures) = (quantity(geometry, "B"), quantity(pictures, "B"));
    line("memory", format!("{geometry} of geometry, {pictures} of grids and environment maps"));
    text
}

/// How many of each name: `3 rectangle, 1 sphere`.
fn tally<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let mut counts = BTreeMap::new();
    for name in names {
        *counts.entry(name).or_insert(0u32) += 1;
    }
    counts.iter().map(|(name, count)| format!("{count} {name}")).collect::<Vec<_>>().join(", ")
}

/// A number with what it counts in brackets, if any.
fn counted(count: usize, details: &str) -> String {
    if details.is_empty() { count.to_string() } else { format!("{count} ({details})") }
}

fn describe_shapes(desc: &SceneDesc) -> String {
    let kind = |geometry: &GeometryDesc| match geometry {
        GeometryDesc::Mesh(_) => "mesh",
        GeometryDesc::Sphere { .. } => "sphere",
        GeometryDesc::Rectangle => "rectangle",
        GeometryDesc::Disk => "disk",
        GeometryDesc::Cube => "cube",
        GeometryDesc::Cylinder { .. } => "cylinder",
        GeometryDesc::Instance(_) => "instance",
    };
    let triangles: usize = shapes(desc).map(|shape| triangles(&shape.geometry)).sum();
    let details = tally(shapes(desc).map(|shape| kind(&shape.geometry)));
    let groups = match desc.shape_groups.len() {
        0 => String::new(),
        n => format!(", {n} groups"),
    };
    format!("{}{groups}, {triangles} triangles", counted(shapes(desc).count(), &details))
}

fn triangles(geometry: &GeometryDesc) -> usize {
    if let GeometryDesc::Mesh(mesh) = geometry { mesh.triangles.len() } else { 0 }
}

fn describe_medium(medium: &MediumDesc) -> String {
    let kind = match medium.kind {
        MediumKind::Homogeneous => "homogeneous",
        MediumKind::Heterogeneous => "heterogeneous",
    };
    let (sigma_t, albedo) = (describe_volume(&medium.sigma_t, medium.scale), describe_volume(&medium.albedo, 1.0));
    format!("{kind}, sigma_t {sigma_t} 1/m, albedo {albedo}, {}", describe_phase(&medium.phase))
}

fn describe_volume(volume: &VolumeDesc, scale: f32) -> String {
    match volume {
        VolumeDesc::Constant { value, .. } => describe_rgb(value.map(|x| x * scale)),
        VolumeDesc::Grid { grid, .. } => {
            let [x, y, z] = grid.size;
            let fold = |f: fn(f32, f32) -> f32, start| grid.values.iter().copied().fold(start, f) * scale;
            let (min, max) = (fold(f32::min, f32::INFINITY), fold(f32::max, f32::NEG_INFINITY));
            format!("a grid of {x}x{y}x{z} from {} to {}", significant(min), significant(max))
        }
    }
}

fn describe_rgb([r, g, b]: Rgb) -> String {
    let [r, g, b] = [r, g, b].map(significant);
    if r == g && g == b { r.to_string() } else { format!("({r} {g} {b})") }
}

/// Rounded to six digits, what is left of a number that went through `f32`.
fn significant(x: f32) -> f64 {
    format!("{x:.5e}").parse().unwrap_or(f64::from(x))
}

fn describe_phase(phase: &PhaseDesc) -> String {
    match phase {
        PhaseDesc::Isotropic => "isotropic".into(),
        PhaseDesc::HenyeyGreenstein { g } => format!("Henyey-Greenstein g {g}"),
        PhaseDesc::Rayleigh => "Rayleigh".into(),
        PhaseDesc::Tabulated { values } => format!("tabulated at {} cosines", values.len()),
        PhaseDesc::Sggx { .. } => "SGGX microflakes".into(),
        PhaseDesc::Blend { weight, first, second } => {
            format!("{} of {} and {} of {}", 1.0 - weight, describe_phase(first), weight, describe_phase(second))
        }
    }
}

fn describe_emitters(desc: &SceneDesc) -> String {
    let kind = |kind: &EmitterKind| match kind {
        EmitterKind::Point { .. } => "point",
        EmitterKind::Spot { .. } => "spot",
        EmitterKind::Directional { .. } => "directional",
        EmitterKind::Constant { .. } => "constant",
        EmitterKind::Envmap { .. } => "envmap",
        EmitterKind::Projector { .. } => "projector",
    };
    let areas = shapes(desc).filter(|shape| shape.emission.is_some()).map(|_| "area");
    let names: Vec<&str> = areas.chain(desc.emitters.iter().map(|emitter| kind(&emitter.kind))).collect();
    counted(names.len(), &tally(names.iter().copied()))
}

fn describe_sensor(sensor: &SensorDesc) -> String {
    let kind = match sensor.kind {
        SensorKind::Perspective { fov_x, .. } => format!("perspective, {} degrees wide", significant(fov_x)),
        SensorKind::ThinLens { fov_x, aperture_radius, focus_distance } => {
            format!("thin lens of radius {aperture_radius} m, {fov_x} degrees wide, in focus at {focus_distance} m")
        }
        SensorKind::Orthographic => "orthographic".into(),
    };
    // To a tenth of a millimetre; adding zero removes the sign of a negative one.
    let [x, y, z] = sensor.to_world.point([0.0; 3]).map(|x| (x * 1e4).round() / 1e4 + 0.0);
    format!("{kind}, at ({x} {y} {z})")
}

fn describe_film(film: &FilmDesc) -> String {
    let crop = film.crop.map(|[x, y, w, h]| format!(", of which {w}x{h} at {x},{y}")).unwrap_or_default();
    format!("{}x{} pixels{crop}, {}", film.width, film.height, describe_filter(film.filter))
}

fn describe_filter(filter: ReconstructionFilter) -> String {
    match filter {
        ReconstructionFilter::Box => "box filter".into(),
        ReconstructionFilter::Tent { radius } => format!("tent filter of radius {radius}"),
        ReconstructionFilter::Gaussian { stddev } => format!("Gaussian filter of deviation {stddev}"),
        ReconstructionFilter::Mitchell { b, c } => format!("Mitchell filter with B {b} and C {c}"),
        ReconstructionFilter::CatmullRom => "Catmull-Rom filter".into(),
        ReconstructionFilter::Lanczos { lobes } => format!("Lanczos filter of {lobes} lobes"),
    }
}

/// Bytes of grids and environment maps, each once.
fn picture_bytes(desc: &SceneDesc) -> usize {
    let mut bytes = HashMap::new();
    for volume in desc.media.iter().flat_map(|medium| [&medium.sigma_t, &medium.albedo]) {
        if let VolumeDesc::Grid { grid, .. } = volume {
            bytes.insert(Arc::as_ptr(grid).cast::<()>(), size_of_val(&grid.values[..]));
        }
    }
    for emitter in &desc.emitters {
        if let EmitterKind::Envmap { image, .. } = &emitter.kind {
            bytes.insert(Arc::as_ptr(image).cast(), size_of_val(&image.pixels[..]));
        }
    }
    bytes.values().sum()
}
