//! The progress of a run: a bar on a terminal, otherwise a line from time to time.

use std::io::{self, IsTerminal, Write as _};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// The time between two plain lines.
const PAUSE: Duration = Duration::from_secs(2);

/// The progress of one run, on standard error.
#[derive(Debug)]
pub struct Progress {
    bar: ProgressBar,
    /// The time of the last plain line; none where there is a bar, or nothing is to be shown.
    last: Option<Instant>,
}

impl Progress {
    /// Begins to show the progress of something that is done in these units.
    pub fn new(label: &str, total: u64, unit: &'static str, quiet: bool) -> Self {
        // a bar hides itself where standard error is no terminal
        let target = if quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        let last = (!quiet && !io::stderr().is_terminal()).then(Instant::now);
        Self { bar: bar(label, total, unit, target), last }
    }

    /// Shows how many units are done.
    pub fn show(&mut self, index: u64) {
        self.bar.set_position(index);
        let Some(last) = self.last.filter(|last| last.elapsed() > PAUSE) else { return };
        let (label, unit, total) = (self.bar.message(), self.bar.prefix(), self.bar.length().unwrap_or(0));
        let percent = 100 * u128::from(index.min(total)) / u128::from(total.max(1));
        self.last = Some(last + last.elapsed());
        // the run goes on even if standard error is closed
        let _ = writeln!(io::stderr(), "{label}: {unit} {index} of {total} ({percent} %)");
    }
}

fn bar(label: &str, total: u64, unit: &'static str, target: ProgressDrawTarget) -> ProgressBar {
    let template = "{msg} {wide_bar} {percent:>3} %  {per_sec}  {eta} left";
    // a template of ours has no mistakes
    let style = ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
    let bar = ProgressBar::with_draw_target(Some(total), target).with_style(style.progress_chars("█░"));
    bar.with_message(label.to_owned()).with_prefix(unit)
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

#[cfg(test)]
mod tests {
    use std::sync::{Arc, Mutex};

    use indicatif::TermLike;

    use super::*;

    /// A terminal of this width, and what was written to it.
    #[derive(Clone, Debug)]
    struct Terminal(u16, Arc<Mutex<Vec<String>>>);

    impl TermLike for Terminal {
        fn width(&self) -> u16 {
            self.0
        }

        fn move_cursor_up(&self, _: usize) -> io::Result<()> {
            Ok(())
        }

        fn move_cursor_down(&self, _: usize) -> io::Result<()> {
            Ok(())
        }

        fn move_cursor_right(&self, _: usize) -> io::Result<()> {
            Ok(())
        }

        fn move_cursor_left(&self, _: usize) -> io::Result<()> {
            Ok(())
        }

        fn write_line(&self, line: &str) -> io::Result<()> {
            self.write_str(line)
        }

        fn write_str(&self, text: &str) -> io::Result<()> {
            self.1.lock().expect("no panic").push(text.to_owned());
            Ok(())
        }

        fn clear_line(&self) -> io::Result<()> {
            Ok(())
        }

        fn flush(&self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_bar_fits_its_terminal() {
        for columns in [60, 80, 200] {
            let terminal = Terminal(columns, Arc::default());
            let target = ProgressDrawTarget::term_like_with_hz(Box::new(terminal.clone()), 255);
            let bar = bar("heavy_top", 2000, "step", target);
            for index in [0, 1, 1000, 2000] {
                bar.set_position(index);
                bar.tick();
            }
            let written = terminal.1.lock().expect("no panic").clone();
            for line in &written {
                assert!(line.chars().count() <= columns.into(), "{columns}: {line}");
            }
            let is_half = |line: &String| {
                line.starts_with("heavy_top █")
                    && line.contains("░  50 %")
                    && line.trim_end().ends_with(" left")
            };
            assert!(written.iter().any(is_half), "{written:?}");
        }
    }
}
