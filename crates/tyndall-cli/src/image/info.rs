//! `tyndall image info`.

use super::read;
use crate::console::print;
use crate::failure::Failure;
use std::fmt::Write;
use std::path::Path;
use tyndall_formats::image::{Layer, Picture};

/// Prints what is in a picture.
pub(super) fn run(path: &Path) -> Result<(), Failure> {
    print(&describe(path, &read(path)?))
}

fn describe(path: &Path, picture: &Picture) -> String {
    let mut text = format!("{}: {}x{} pixels\n", path.display(), picture.width, picture.height);
    for layer in &picture.layers {
        let name = if layer.name.is_empty() { "main layer" } else { &layer.name };
        let _ = writeln!(text, "\n{name}");
        for channel in &layer.channels {
            let _ = writeln!(text, "  {:<4}{}", channel.name, range(&channel.values));
        }
        text += &negative(layer);
    }
    if !picture.attributes.is_empty() {
        text += "\nmetadata\n";
    }
    let width = picture.attributes.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    for (name, value) in &picture.attributes {
        let _ = writeln!(text, "  {name:width$}  {value}");
    }
    text
}

/// `min 0, mean 0.5, max 1`, over the finite values.
fn range(values: &[f32]) -> String {
    let finite = || values.iter().copied().filter(|x| x.is_finite());
    let count = finite().count();
    let strange = match values.len() - count {
        0 => String::new(),
        n => format!(", {n} not finite"),
    };
    if count == 0 {
        return format!("no finite values{strange}");
    }
    let (min, max) = finite().fold((f32::INFINITY, f32::NEG_INFINITY), |(min, max), x| (min.min(x), max.max(x)));
    let mean = finite().map(f64::from).sum::<f64>() / count as f64;
    format!("min {min:.6}, mean {mean:.6}, max {max:.6}{strange}")
}

/// A line on negative values, which no render has.
fn negative(layer: &Layer) -> String {
    let count: usize = layer.channels.iter().map(|c| c.values.iter().filter(|x| **x < 0.0).count()).sum();
    if count == 0 { String::new() } else { format!("  {count} values are negative\n") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges() {
        assert_eq!(range(&[1.0, 3.0]), "min 1.000000, mean 2.000000, max 3.000000");
        assert_eq!(range(&[f32::NAN, 3.0]), "min 3.000000, mean 3.000000, max 3.000000, 1 not finite");
        assert_eq!(range(&[f32::NAN]), "no finite values, 1 not finite");
    }
}
