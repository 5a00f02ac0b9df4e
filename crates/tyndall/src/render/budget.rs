//! When a rendering is done.

use super::Rendering;
use std::time::Duration;

/// When to stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Budget {
    /// After this many passes in total.
    Passes(u32),
    /// After this much rendering time in total; at least one pass.
    Time(Duration),
    /// At this estimated relative error (see [`super::Picture::relative_error`]); at least [`Budget::FIRST_ESTIMATE`]
    /// passes.
    Error(f64),
}

impl Budget {
    /// Passes before the error is estimated.
    pub const FIRST_ESTIMATE: u32 = 16;

    /// How far `rendering` is.
    pub(super) fn progress(&self, rendering: &Rendering) -> Progress {
        let error = match self {
            Self::Error(_) if rendering.passes >= Self::FIRST_ESTIMATE => Some(rendering.picture().relative_error()),
            _ => None,
        };
        let seconds = rendering.seconds();
        let fraction = match *self {
            Self::Passes(total) => f64::from(rendering.passes) / f64::from(total.max(1)),
            Self::Time(total) => seconds / total.as_secs_f64().max(1e-9),
            // The error falls with the square root of the work.
            Self::Error(target) => error.map_or(0.0, |error| (target / error.max(1e-30)).powi(2)),
        };
        Progress { passes: rendering.passes, seconds, fraction: fraction.clamp(0.0, 1.0), error }
    }
}

/// How far a rendering is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Passes done.
    pub passes: u32,
    /// Rendering time so far.
    pub seconds: f64,
    /// Share of the budget that is spent, in [0, 1].
    pub fraction: f64,
    /// Estimated relative error, where the budget asks for it.
    pub error: Option<f64>,
}

impl Progress {
    /// Estimate of the remaining rendering time, seconds; `None` before there is anything to go by.
    pub fn remaining(&self) -> Option<f64> {
        (self.fraction > 0.0).then(|| self.seconds * (1.0 - self.fraction) / self.fraction)
    }
}

/// Sizes of groups of passes: long enough to be efficient, short enough for an observer.
pub(super) struct Group {
    size: u32,
    last: Option<(u32, f64)>,
}

/// Aim for the duration of a group, seconds.
const GROUP_SECONDS: f64 = 0.25;

impl Group {
    /// Starts with a single pass.
    pub(super) fn new() -> Self {
        Self { size: 1, last: None }
    }

    /// Passes of the next group; `None` when the budget is spent.
    pub(super) fn next(&mut self, budget: &Budget, rendering: &Rendering) -> Option<u32> {
        if let Some((passes, seconds)) = self.last {
            let spent = rendering.seconds() - seconds;
            let per_pass = spent / f64::from((rendering.passes - passes).max(1));
            // Grow by at most four: the first pass is slower than the rest.
            let wanted = (GROUP_SECONDS / per_pass.max(1e-9)).min(f64::from(self.size) * 4.0);
            self.size = (wanted as u32).clamp(1, 1 << 16);
        }
        self.last = Some((rendering.passes, rendering.seconds()));
        match *budget {
            Budget::Passes(total) => {
                let left = total.saturating_sub(rendering.passes);
                (left > 0).then(|| self.size.min(left))
            }
            Budget::Time(total) => {
                let left = total.as_secs_f64() - rendering.seconds();
                if rendering.passes == 0 {
                    return Some(1);
                }
                let per_pass = rendering.seconds() / f64::from(rendering.passes);
                // The last pass is begun only if at least half of it fits.
                let fitting = (left / per_pass + 0.5) as u32;
                (left > 0.0 && fitting > 0).then(|| self.size.min(fitting))
            }
            Budget::Error(target) => {
                if rendering.passes < Budget::FIRST_ESTIMATE {
                    return Some(Budget::FIRST_ESTIMATE - rendering.passes);
                }
                (rendering.picture().relative_error() > target).then_some(self.size)
            }
        }
    }
}
