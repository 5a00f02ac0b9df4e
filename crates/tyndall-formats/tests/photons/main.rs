//! Photon estimators: against closed forms with the blur's bias in them, against furnaces, and as passes are added.

#[path = "../common/mod.rs"]
mod common;

mod blur;
mod closed_forms;
mod components;
mod furnaces;
mod progressive;
mod surfaces;
mod whole_scenes;

use blur::Blur;
use tyndall::{Rendering, Scene, Settings};
use tyndall_testkit::ztest::two_sided_p;

/// A way to gather in media.
#[derive(Clone, Copy)]
pub struct Way {
    /// Integrator.
    pub name: &'static str,
    /// Its parameter `estimator`, or nothing.
    pub estimator: &'static str,
    /// Its parameter `extent`, or nothing.
    pub extent: &'static str,
    /// What it blurs.
    pub blur: Blur,
}

const fn way(name: &'static str, estimator: &'static str, extent: &'static str, blur: Blur) -> Way {
    Way { name, estimator, extent, blur }
}

/// Every one, beams short and long.
pub const WAYS: [Way; 18] = [
    way("vpm", "", "", Blur::Ball),
    way("bre", "", "", Blur::AcrossQuery),
    way("beams", "point-point-3d", "", Blur::Ball),
    way("beams", "beam-point-3d", "", Blur::Ball),
    way("beams", "point-beam-3d", "short", Blur::Ball),
    way("beams", "point-beam-3d", "long", Blur::Ball),
    way("beams", "point-beam-2d", "short", Blur::AcrossBeam),
    way("beams", "point-beam-2d", "long", Blur::AcrossBeam),
    way("beams", "beam-beam-3d", "short", Blur::Ball),
    way("beams", "beam-beam-3d", "long", Blur::Ball),
    way("beams", "beam-beam-2d-beam", "short", Blur::AcrossBeam),
    way("beams", "beam-beam-2d-beam", "long", Blur::AcrossBeam),
    way("beams", "beam-beam-2d-query", "short", Blur::AcrossQuery),
    way("beams", "beam-beam-2d-query", "long", Blur::AcrossQuery),
    way("beams", "beam-beam-1d", "short", Blur::CommonNormal),
    way("beams", "beam-beam-1d", "long", Blur::CommonNormal),
    way("planes", "", "short", Blur::CommonNormal),
    way("planes", "", "long", Blur::CommonNormal),
];

impl Way {
    /// The one with that integrator or estimator, and extent.
    pub fn find(name: &str, extent: &str) -> Self {
        let is = |way: &&Way| (way.name == name || way.estimator == name) && way.extent == extent;
        *WAYS.iter().find(is).unwrap_or_else(|| panic!("no {name} {extent}"))
    }

    /// Name for messages.
    pub fn title(&self) -> String {
        [self.name, self.estimator, self.extent].into_iter().filter(|w| !w.is_empty()).collect::<Vec<_>>().join(" ")
    }

    /// Parameters that choose it.
    pub fn parameters(&self, radius: f64, max_depth: i32) -> Vec<(&'static str, String)> {
        let mut set = vec![("radius", radius.to_string()), ("max_depth", max_depth.to_string())];
        let mut choose = |name: &'static str, value: &str| {
            if !value.is_empty() {
                set.push((name, value.into()));
            }
        };
        choose("estimator", self.estimator);
        choose("extent", self.extent);
        if self.name == "bre" {
            choose("neighbours", "0");
        }
        if self.name == "vpm" || self.estimator.starts_with("point") {
            choose("steps", "200");
        }
        set
    }

    /// Light paths that take a few milliseconds.
    pub fn photons(&self) -> u32 {
        if self.extent.is_empty() { 20_000 } else { 4000 }
    }
}

/// Mean and its standard error, per channel.
#[derive(Clone, Copy, Debug)]
pub struct Measured {
    /// The mean.
    pub mean: [f64; 3],
    /// Its standard error.
    pub sigma: [f64; 3],
}

impl Measured {
    /// Of the one pixel, after so many passes.
    pub fn after(scene: &Scene, name: &str, set: &[(&str, String)], seed: u64, passes: u32) -> Self {
        let integrator = common::integrator(name, set);
        let settings = Settings { integrator: Some(integrator), seed: Some(seed), ..Settings::default() };
        let mut rendering = Rendering::new(scene, &settings).unwrap_or_else(|e| panic!("{name}: {e}"));
        rendering.add_passes(passes).unwrap();
        assert_eq!(rendering.rare_events().non_finite, 0, "{name}");
        let picture = rendering.picture();
        let n = picture.pixels.len() as f64;
        let mean = [0, 1, 2].map(|c| picture.pixels.iter().map(|p| f64::from(p[c])).sum::<f64>() / n);
        let sigma = [0, 1, 2].map(|c| picture.variance.iter().map(|v| f64::from(v[c])).sum::<f64>().sqrt() / n);
        Self { mean, sigma }
    }

    /// With as many passes as `precision` times `truth` needs: a few passes of another seed tell how many, since a
    /// number that hung on the passes themselves would bias their mean.
    pub fn precisely(
        scene: &Scene,
        name: &str,
        set: &[(&str, String)],
        seed: u64,
        truth: [f64; 3],
        precision: f64,
    ) -> Self {
        const PILOT: u32 = 48;
        let pilot = Self::after(scene, name, set, seed ^ 0x5eed_0000, PILOT);
        let more = (0..3).map(|c| pilot.sigma[c] / (precision * truth[c])).fold(0.0, f64::max);
        let passes = (f64::from(PILOT) * 1.2 * more * more).ceil().clamp(48.0, 1e6) as u32;
        Self::after(scene, name, set, seed, passes)
    }

    /// Deviations from `truth`, per cent.
    pub fn report(&self, what: &str, truth: [f64; 3]) {
        let column = |c: usize| {
            let percent = 100.0 / truth[c];
            format!("{:+.2} +- {:.2}", (self.mean[c] - truth[c]) * percent, self.sigma[c] * percent)
        };
        println!("{what}: {} %", [0, 1, 2].map(column).join(", "));
    }

    /// Panics unless the standard errors are at most `precision` and the means agree with the truth at that level.
    #[track_caller]
    pub fn assert(&self, what: &str, truth: [f64; 3], precision: f64, level: f64) {
        self.report(what, truth);
        for c in 0..3 {
            let (mean, sigma, truth) = (self.mean[c], self.sigma[c], truth[c]);
            assert!(sigma <= precision * truth, "{what}: {mean} +- {sigma} is no test of {truth}");
            assert!(two_sided_p((mean - truth) / sigma) > level, "{what}, channel {c}: {mean} +- {sigma}, not {truth}");
        }
    }
}
