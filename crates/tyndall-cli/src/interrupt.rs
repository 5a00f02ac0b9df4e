//! Ctrl-C: the first ends the rendering in order, the second the program at once.

use crate::console::error_line;
use std::sync::atomic::{AtomicU8, Ordering};

/// The exit code of a program that was interrupted.
pub(crate) const EXIT_CODE: u8 = 130;

/// Nothing to save yet.
const IDLE: u8 = 0;
/// Rendering: the picture so far is worth writing.
const RENDERING: u8 = 1;
/// Asked to stop.
const STOPPING: u8 = 2;

static STATE: AtomicU8 = AtomicU8::new(IDLE);

/// From now on, the first Ctrl-C only makes [`requested`] true.
pub(crate) fn watch(say: bool) {
    STATE.store(RENDERING, Ordering::SeqCst);
    // Fails only if there is a handler already; then Ctrl-C ends the program as always.
    let _ = ctrlc::set_handler(move || {
        if STATE.swap(STOPPING, Ordering::SeqCst) != RENDERING {
            std::process::exit(i32::from(EXIT_CODE));
        }
        if say {
            error_line("\nstopping after the current passes; press Ctrl-C again to stop at once");
        }
    });
}

/// Whether Ctrl-C was pressed.
pub(crate) fn requested() -> bool {
    STATE.load(Ordering::SeqCst) == STOPPING
}
