//! Ctrl-C: the first ends the rendering in order, the second the program at once.

use crate::console::error_line;
use std::sync::atomic::{AtomicBool, Ordering};

/// The exit code of a program that was interrupted.
pub(crate) const EXIT_CODE: u8 = 130;

static REQUESTED: AtomicBool = AtomicBool::new(false);

/// From now on, the first Ctrl-C only makes [`requested`] true.
pub(crate) fn watch(say: bool) {
    // Fails only if there is a handler already; then Ctrl-C ends the program as always.
    let _ = ctrlc::set_handler(move || {
        if REQUESTED.swap(true, Ordering::SeqCst) {
            std::process::exit(i32::from(EXIT_CODE));
        }
        if say {
            error_line("\nstopping after the current passes; press Ctrl-C again to stop at once");
        }
    });
}

/// Whether Ctrl-C was pressed.
pub(crate) fn requested() -> bool {
    REQUESTED.load(Ordering::SeqCst)
}
