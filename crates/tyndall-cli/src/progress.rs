//! How far a rendering is: a bar on a terminal, a line now and then elsewhere.

use crate::console::{Console, Level};
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::time::{Duration, Instant};
use tyndall::render;

/// Between two lines where there is no terminal.
const INTERVAL: Duration = Duration::from_secs(10);
/// Steps of the bar.
const STEPS: u64 = 1000;

/// Shows how far a rendering is.
pub(crate) struct Progress {
    console: Console,
    pixels: f64,
    bar: Option<ProgressBar>,
    last_line: Instant,
}

impl Progress {
    /// For a picture of so many pixels.
    pub(crate) fn new(console: Console, pixels: f64) -> Self {
        let bar = (console.level >= Level::Normal && std::io::stderr().is_terminal()).then(|| {
            let style = ProgressStyle::with_template("{wide_bar} {percent:>3} % {msg}");
            ProgressBar::new(STEPS).with_style(style.expect("a template that is tested"))
        });
        Self { console, pixels, bar, last_line: Instant::now() }
    }

    /// Shows the state.
    pub(crate) fn show(&mut self, state: &render::Progress) {
        if let Some(bar) = &self.bar {
            bar.set_position((state.fraction * STEPS as f64) as u64);
            bar.set_message(describe(state, self.pixels));
        } else if self.last_line.elapsed() >= INTERVAL {
            self.last_line = Instant::now();
            self.console.say(format_args!("{:3.0} %, {}", state.fraction * 100.0, describe(state, self.pixels)));
        }
    }

    /// Takes the bar away.
    pub(crate) fn end(self) {
        if let Some(bar) = self.bar {
            bar.finish_and_clear();
        }
    }
}

/// `12 samples per pixel, 3.1 Msamples/s, error 0.05, 12 s left`.
fn describe(state: &render::Progress, pixels: f64) -> String {
    let rate = f64::from(state.passes) * pixels / state.seconds.max(1e-9);
    let error = state.error.map(|error| format!(", error {error:.3}")).unwrap_or_default();
    let left = state.remaining().map(|seconds| format!(", {} left", time(seconds))).unwrap_or_default();
    format!("{} samples per pixel, {}{error}{left}", state.passes, quantity(rate, "samples/s"))
}

/// `2.5 s`, `12 s`, `3 min 20 s`, `2 h 5 min`.
pub(crate) fn time(seconds: f64) -> String {
    let whole = seconds.round() as u64;
    match whole {
        0..10 => format!("{seconds:.1} s"),
        10..60 => format!("{whole} s"),
        60..3600 => format!("{} min {} s", whole / 60, whole % 60),
        _ => format!("{} h {} min", whole / 3600, whole % 3600 / 60),
    }
}

/// `850 B`, `12.3 kB`, `1.2 MB`.
pub(crate) fn quantity(number: f64, unit: &str) -> String {
    match number {
        n if n < 1e3 => format!("{n:.0} {unit}"),
        n if n < 1e6 => format!("{:.1} k{unit}", n / 1e3),
        n if n < 1e9 => format!("{:.1} M{unit}", n / 1e6),
        n => format!("{:.1} G{unit}", n / 1e9),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_and_quantities() {
        assert_eq!(time(2.54), "2.5 s");
        assert_eq!(time(12.4), "12 s");
        assert_eq!(time(59.9), "1 min 0 s");
        assert_eq!(time(200.0), "3 min 20 s");
        assert_eq!(time(7500.0), "2 h 5 min");
        assert_eq!(quantity(850.0, "B"), "850 B");
        assert_eq!(quantity(12_300.0, "B"), "12.3 kB");
        assert_eq!(quantity(1.2e6, "B"), "1.2 MB");
    }

    #[test]
    fn a_line() {
        let state = render::Progress { passes: 4, seconds: 2.0, fraction: 0.25, error: Some(0.05) };
        assert_eq!(describe(&state, 1000.0), "4 samples per pixel, 2.0 ksamples/s, error 0.050, 6.0 s left");
    }

    #[test]
    fn the_template_is_valid() {
        assert!(ProgressStyle::with_template("{wide_bar} {percent:>3} % {msg}").is_ok());
    }
}
