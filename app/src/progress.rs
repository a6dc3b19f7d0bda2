//! The progress of a run: a bar on a terminal, otherwise a line from time to time.

use std::io::{self, IsTerminal, Write};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

/// Reading the clock costs more than a step: it is read once in this many.
const INTERVAL: u64 = 1024;
/// Between two plain lines.
const PAUSE: Duration = Duration::from_secs(2);

/// The progress of one run, on standard error.
pub(crate) struct Progress {
    label: String,
    total: u64,
    display: Display,
}

enum Display {
    Bar(ProgressBar),
    Lines { last: Instant },
}

impl Progress {
    /// Begins to show the progress of a run of `total` steps.
    pub(crate) fn new(label: &str, total: u64) -> Self {
        let display = if io::stderr().is_terminal() {
            Display::Bar(bar(label, total))
        } else {
            Display::Lines { last: Instant::now() }
        };
        Self { label: label.to_owned(), total, display }
    }

    /// Tells how many steps have been taken.
    #[inline]
    pub(crate) fn at(&mut self, index: u64) {
        if index.is_multiple_of(INTERVAL) {
            self.show(index);
        }
    }

    /// As [`at`](Self::at), without the interval.
    pub(crate) fn show(&mut self, index: u64) {
        match &mut self.display {
            Display::Bar(bar) => bar.set_position(index),
            Display::Lines { last } if last.elapsed() > PAUSE => {
                *last = Instant::now();
                let percent = 100 * u128::from(index) / u128::from(self.total.max(1));
                // the run goes on even if standard error is closed
                let _ =
                    writeln!(io::stderr(), "{}: step {index} of {} ({percent} %)", self.label, self.total);
            }
            Display::Lines { .. } => {}
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

fn bar(label: &str, total: u64) -> ProgressBar {
    let bar = ProgressBar::new(total);
    let template = "{msg:24} {bar:32} {human_pos}/{human_len} steps  {per_sec}  {eta} left";
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar.set_message(label.to_owned());
    bar
}
