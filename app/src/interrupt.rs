//! Ctrl-C: the first ends a run cleanly, what was computed is written; the second ends the program.

use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering};

/// The exit code of programs that Ctrl-C ended, by convention.
pub(crate) const EXIT_CODE: u8 = 130;

static REQUESTED: AtomicBool = AtomicBool::new(false);
static LISTENING: Once = Once::new();

/// Installs the handler of Ctrl-C.
pub(crate) fn listen() {
    LISTENING.call_once(|| {
        let handler = || {
            if REQUESTED.swap(true, Ordering::Relaxed) {
                std::process::exit(EXIT_CODE.into());
            }
        };
        // without a handler Ctrl-C ends the program at once: not worth failing for
        let _ = ctrlc::set_handler(handler);
    });
}

/// Whether the run should end.
#[inline]
pub(crate) fn requested() -> bool {
    REQUESTED.load(Ordering::Relaxed)
}
