//! The progress of a run: a bar on a terminal, otherwise a line from time to time.

use std::io::{self, IsTerminal, Write as _};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressState, ProgressStyle};

use crate::report::{rate_in_words, seconds_in_words};

/// Reading the clock costs more than a step: it is read once in this many.
const INTERVAL: u64 = 1024;
/// Between two plain lines.
const PAUSE: Duration = Duration::from_secs(2);

/// Whether no progress is shown.
static SILENT: AtomicBool = AtomicBool::new(false);

/// Shows no progress from now on.
pub(crate) fn silence() {
    SILENT.store(true, Ordering::Relaxed);
}

/// The progress of one run, on standard error.
pub struct Progress {
    label: String,
    unit: &'static str,
    total: u64,
    display: Display,
}

enum Display {
    Bar(ProgressBar),
    Lines { last: Instant },
    Nothing,
}

impl Progress {
    /// Begins to show the progress of a run of `total` steps.
    pub fn new(label: &str, total: u64) -> Self {
        Self::of(label, total, "step")
    }

    /// Begins to show the progress of something that is done in so many units.
    pub fn of(label: &str, total: u64, unit: &'static str) -> Self {
        let display = if SILENT.load(Ordering::Relaxed) {
            Display::Nothing
        } else if io::stderr().is_terminal() {
            Display::Bar(bar(label, total, unit))
        } else {
            Display::Lines { last: Instant::now() }
        };
        Self { label: label.to_owned(), unit, total, display }
    }

    /// Tells how many steps have been taken.
    #[inline]
    pub(crate) fn at(&mut self, index: u64) {
        if index.is_multiple_of(INTERVAL) {
            self.show(index);
        }
    }

    /// Tells at once how many steps have been taken.
    pub fn show(&mut self, index: u64) {
        match &mut self.display {
            Display::Bar(bar) => bar.set_position(index),
            Display::Lines { last } if last.elapsed() > PAUSE => {
                *last = Instant::now();
                let percent = 100 * u128::from(index) / u128::from(self.total.max(1));
                let Self { label, unit, total, .. } = self;
                // the run goes on even if standard error is closed
                let _ = writeln!(io::stderr(), "{label}: {unit} {index} of {total} ({percent} %)");
            }
            Display::Lines { .. } | Display::Nothing => {}
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Display::Bar(bar) = &self.display {
            bar.finish_and_clear();
        }
    }
}

impl std::fmt::Debug for Progress {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Progress")
            .field("label", &self.label)
            .field("total", &self.total)
            .finish_non_exhaustive()
    }
}

/// A bar as wide as what the terminal leaves for it.
fn bar(label: &str, total: u64, unit: &'static str) -> ProgressBar {
    let bar = ProgressBar::new(total);
    let template = "{msg} {wide_bar} {percent:>3} %  {rate}  {left} left";
    if let Ok(style) = ProgressStyle::with_template(template) {
        // writing to a line of text does not fail
        let rate = move |state: &ProgressState, line: &mut dyn std::fmt::Write| {
            let _ = write!(line, "{} {unit}s/s", rate_in_words(state.per_sec()));
        };
        let left = |state: &ProgressState, line: &mut dyn std::fmt::Write| {
            let _ = match state.pos() {
                0 => write!(line, "…"),
                _ => write!(line, "{}", seconds_in_words(state.eta().as_secs_f64())),
            };
        };
        bar.set_style(style.with_key("rate", rate).with_key("left", left));
    }
    bar.set_message(label.to_owned());
    bar
}
