//! `tyndall image merge`: one picture from renders with different seeds.

use super::{check_sizes, colours, read};
use crate::console::Console;
use crate::failure::Failure;
use crate::output::Target;
use std::path::{Path, PathBuf};
use tyndall_formats::image::{Layer, Picture};
use tyndall_report::merge::{mean, variance_of_mean};

/// A render to be merged.
struct Input {
    path: PathBuf,
    picture: Picture,
    pixels: Vec<[f32; 3]>,
    variance: Option<Vec<[f32; 3]>>,
    samples: u64,
}

/// Reads, merges and writes.
pub(super) fn run(paths: &[PathBuf], output: &Path) -> Result<(), Failure> {
    let target = Target::plain(output)?;
    if !target.keeps_layers() {
        return Err(Failure::usage("renders are merged to an .exr: only that keeps how many samples they hold"));
    }
    let inputs = paths.iter().map(|path| Input::read(path)).collect::<Result<Vec<_>, _>>()?;
    check(&inputs)?;
    target.write(&merge(&inputs)?)
}

impl Input {
    fn read(path: &Path) -> Result<Self, Failure> {
        let picture = read(path)?;
        let pixels = colours(path, &picture)?;
        let variance = picture.layer("variance").and_then(Layer::to_rgb);
        let samples = picture.attribute("samples").and_then(|text| text.parse().ok()).filter(|n| *n > 0);
        let samples = samples.ok_or_else(|| {
            Failure::other(format_args!("{} does not say how many samples it holds: it is no render", path.display()))
        })?;
        Ok(Self { path: path.to_owned(), picture, pixels, variance, samples })
    }

    /// The variance, where there are enough samples for one.
    fn known_variance(&self) -> Option<&Vec<[f32; 3]>> {
        self.variance.as_ref().filter(|_| self.samples > 1)
    }

    /// The seeds that went into it.
    fn seeds(&self) -> impl Iterator<Item = &str> {
        self.picture.attribute("seed").unwrap_or_default().split([',', ' ']).filter(|word| !word.is_empty())
    }
}

/// Refuses what cannot be averaged; warns of what should perhaps not be.
fn check(inputs: &[Input]) -> Result<(), Failure> {
    let (first, rest) = inputs.split_first().expect("the command line asks for two");
    for (i, input) in rest.iter().enumerate() {
        check_sizes((&first.path, &first.picture), (&input.path, &input.picture))?;
        for other in &inputs[..=i] {
            if let Some(seed) = input.seeds().find(|seed| other.seeds().any(|s| s == *seed)) {
                let (a, b) = (other.path.display(), input.path.display());
                return Err(Failure::other(format_args!(
                    "{a} and {b} have the same seed {seed}, so the same samples: render one with another --seed"
                )));
            }
        }
    }
    for name in ["scene", "integrator", "parameters", "defines"] {
        let other = rest.iter().find(|input| input.picture.attribute(name) != first.picture.attribute(name));
        if let Some(other) = other {
            let (a, b) = (first.path.display(), other.path.display());
            Console::NORMAL.warning(format_args!("{a} and {b} differ in the metadata `{name}`"));
        }
    }
    let known = inputs.iter().filter(|i| i.known_variance().is_some()).count();
    if (1..inputs.len()).contains(&known) {
        Console::NORMAL.warning("not all of the pictures have a variance of two samples or more: there will be none");
    }
    Ok(())
}

/// The picture of all samples together.
fn merge(inputs: &[Input]) -> Result<Picture, Failure> {
    let weighted = |values: fn(&Input) -> Option<&Vec<[f32; 3]>>| -> Option<Vec<(&[f32], f64)>> {
        inputs.iter().map(|i| Some((values(i)?.as_flattened(), i.samples as f64))).collect()
    };
    let rgb = |values: Vec<f32>| values.as_chunks::<3>().0.to_vec();
    let means = weighted(|i| Some(&i.pixels)).expect("all have pixels");
    let first = &inputs[0].picture;
    let pixels = rgb(mean(&means).map_err(Failure::other)?);
    let mut merged = Picture::from_rgb(first.width, first.height, &pixels);
    if let Some(variances) = weighted(Input::known_variance) {
        let variance = rgb(variance_of_mean(&variances).map_err(Failure::other)?);
        merged.layers.push(Layer::from_rgb("variance", &variance));
    }
    merged.attributes = attributes(inputs);
    Ok(merged)
}

/// What the first picture says, with the sums of samples and seconds and the list of seeds.
fn attributes(inputs: &[Input]) -> Vec<(String, String)> {
    let samples: u64 = inputs.iter().map(|i| i.samples).sum();
    let seconds = |i: &Input| i.picture.attribute("seconds").and_then(|text| text.parse::<f64>().ok());
    let seconds: f64 = inputs.iter().filter_map(seconds).sum();
    let seeds = inputs.iter().flat_map(Input::seeds).collect::<Vec<_>>().join(", ");
    let mut attributes = inputs[0].picture.attributes.clone();
    for (name, value) in &mut attributes {
        match name.as_str() {
            "samples" => *value = samples.to_string(),
            "seconds" => *value = format!("{seconds:.3}"),
            "seed" => value.clone_from(&seeds),
            _ => {}
        }
    }
    attributes
}

#[cfg(test)]
mod tests {
    use super::*;

    fn input(samples: &[f32], seed: &str) -> Input {
        let n = samples.len() as f64;
        let mean = samples.iter().map(|x| f64::from(*x)).sum::<f64>() / n;
        let squares = samples.iter().map(|x| (f64::from(*x) - mean).powi(2)).sum::<f64>();
        let variance = if n > 1.0 { squares / (n * (n - 1.0)) } else { 0.0 };
        let pixels = vec![[mean as f32; 3]];
        let variance = vec![[variance as f32; 3]];
        let mut picture = Picture::from_rgb(1, 1, &pixels);
        let attributes = [("samples", samples.len().to_string()), ("seed", seed.into()), ("seconds", "1.5".into())];
        picture.attributes = attributes.map(|(name, value)| (name.into(), value)).into();
        picture.layers.push(Layer::from_rgb("variance", &variance));
        Input { path: "x".into(), picture, pixels, variance: Some(variance), samples: samples.len() as u64 }
    }

    #[test]
    fn merging_weights_by_samples() {
        let all = [1.0, 4.0, 2.5, 0.5, 7.0, 3.0];
        let whole = input(&all, "0");
        let inputs = [input(&all[..4], "0"), input(&all[4..], "1")];
        let merged = merge(&inputs).unwrap();
        let value = |layer: &str| merged.layer(layer).and_then(Layer::to_rgb).unwrap()[0][1];
        assert!((value("") - whole.pixels[0][1]).abs() < 1e-6);
        let variance = |i: usize| inputs[i].variance.as_ref().unwrap()[0][1];
        let expected = (4.0f32 / 6.0).powi(2) * variance(0) + (2.0f32 / 6.0).powi(2) * variance(1);
        assert!((value("variance") / expected - 1.0).abs() < 1e-6);
        assert_eq!(merged.attribute("samples"), Some("6"));
        assert_eq!(merged.attribute("seconds"), Some("3.000"));
        assert_eq!(merged.attribute("seed"), Some("0, 1"));
    }

    #[test]
    fn one_sample_has_no_variance() {
        let merged = merge(&[input(&[1.0, 2.0], "0"), input(&[3.0], "1")]).unwrap();
        assert!(merged.layer("variance").is_none());
        assert!((merged.layer("").and_then(Layer::to_rgb).unwrap()[0][0] - 2.0).abs() < 1e-6);
    }

    #[test]
    fn the_same_seed_is_refused() {
        let result = check(&[input(&[1.0], "0"), input(&[2.0], "3, 1"), input(&[2.0], "1")]);
        assert!(matches!(result, Err(Failure::Other(message)) if message.contains("same seed 1")));
        assert!(check(&[input(&[1.0], "0"), input(&[2.0], "1")]).is_ok());
    }
}
