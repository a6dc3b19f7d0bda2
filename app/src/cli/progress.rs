//! The progress of a run: a bar on a terminal, otherwise a line from time to time.

use std::io::{self, IsTerminal, Write as _};
use std::time::{Duration, Instant};

use crate::units::{rate_in_words, seconds_in_words};

/// Between two plain lines.
const PAUSE: Duration = Duration::from_secs(2);
/// Between two looks of a bar.
const BLINK: Duration = Duration::from_millis(100);
/// Columns of a terminal that does not tell.
const COLUMNS: usize = 80;

/// The progress of one run, on standard error.
pub struct Progress {
    label: String,
    unit: &'static str,
    total: u64,
    begin: Instant,
    /// When it was shown last.
    last: Instant,
    display: Display,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Display {
    Bar,
    Lines,
    Nothing,
}

impl Progress {
    /// Begins to show the progress of something that is done in so many units.
    pub fn new(label: &str, total: u64, unit: &'static str, quiet: bool) -> Self {
        let display = if quiet {
            Display::Nothing
        } else if io::stderr().is_terminal() {
            Display::Bar
        } else {
            Display::Lines
        };
        let begin = Instant::now();
        Self { label: label.to_owned(), unit, total, begin, last: begin, display }
    }

    /// Shows how many units are done.
    pub fn show(&mut self, index: u64) {
        let text = match self.display {
            Display::Bar if self.last.elapsed() > BLINK => {
                let columns = terminal_size::terminal_size_of(io::stderr())
                    .map_or(COLUMNS, |(terminal_size::Width(columns), _)| columns.into());
                // the cursor goes back to the beginning of the line
                format!("\r{}{CLEAR}", self.bar(index, self.begin.elapsed().as_secs_f64(), columns))
            }
            Display::Lines if self.last.elapsed() > PAUSE => {
                let Self { label, unit, total, .. } = &*self;
                format!("{label}: {unit} {index} of {total} ({} %)\n", self.percent(index))
            }
            _ => return,
        };
        self.last = Instant::now();
        // the run goes on even if standard error is closed
        let _ = io::stderr().write_all(text.as_bytes());
    }

    fn percent(&self, index: u64) -> u128 {
        100 * u128::from(index.min(self.total)) / u128::from(self.total.max(1))
    }

    /// A bar as wide as what a terminal of so many columns leaves for it: `heavy_top ████░░░░  50 %  1.2 million steps/s  3 s left`
    fn bar(&self, index: u64, seconds: f64, columns: usize) -> String {
        let Self { label, unit, total, .. } = self;
        let rate = index as f64 / seconds;
        let left = match index {
            0 => "…".to_owned(),
            _ => seconds_in_words(total.saturating_sub(index) as f64 / rate),
        };
        let after = format!(" {:>3} %  {} {unit}s/s  {left} left", self.percent(index), rate_in_words(rate));
        // the last column stays empty: a terminal might go on to the next line
        let room = columns.saturating_sub(label.chars().count() + after.chars().count() + 2);
        let full = (room as u128 * self.percent(index) / 100) as usize;
        let line = format!("{label} {}{}{after}", "█".repeat(full), "░".repeat(room - full));
        line.chars().take(columns.saturating_sub(1)).collect()
    }
}

/// What clears the rest of a terminal's line.
const CLEAR: &str = "\x1b[K";

impl Drop for Progress {
    fn drop(&mut self) {
        if self.display == Display::Bar {
            let _ = write!(io::stderr(), "\r{CLEAR}");
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bar_fits_its_terminal() {
        let progress = Progress::new("heavy_top", 2000, "step", false);
        for columns in [0, 1, 20, 60, 80, 200] {
            for index in [0, 1, 1000, 2000, 3000] {
                let bar = progress.bar(index, 0.5, columns);
                let width = bar.chars().count();
                assert!(width < columns.max(1), "{columns}: {bar}");
                assert!(columns < 80 || width == columns - 1, "{columns}: {bar}");
            }
        }
        let bar = progress.bar(1000, 0.5, 80);
        assert!(bar.starts_with("heavy_top █") && bar.contains("░  50 %") && bar.ends_with(" left"), "{bar}");
        let [full, empty] = ['█', '░'].map(|part| bar.matches(part).count());
        assert!(full > 5 && (full..=full + 1).contains(&empty), "{bar}");
        assert!(progress.bar(0, 0.0, 80).contains("… left"));
    }
}
