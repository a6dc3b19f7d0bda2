//! Where a command prints: words for people, or one JSON object for programs; notes beside them.

use std::io::{self, Write};
use std::path::PathBuf;

use clap::Args;
use serde_json::Value;

use super::progress::Progress;
use crate::error::{Error, SetupError};
use crate::units::{printable, wrapped};

/// How a command prints what it found.
#[derive(Clone, Copy, Debug, Default, Args)]
pub struct OutputMode {
    /// Print one JSON object and nothing else; notes go to standard error
    #[arg(long)]
    pub json: bool,
    /// Print errors alone: no progress, notes or table
    #[arg(short, long)]
    pub quiet: bool,
}

/// Where a command prints it.
pub struct Console<'a> {
    stdout: &'a mut dyn Write,
    stderr: io::Stderr,
    nowhere: io::Sink,
    mode: OutputMode,
    /// Whether standard output is taken by data, so that words have to go elsewhere.
    is_taken: bool,
    pub(super) notes: Vec<String>,
}

impl OutputMode {
    /// Prints on standard output; on standard error where the first one is taken by data.
    ///
    /// # Errors
    /// If both data and a JSON object are to be written to standard output.
    pub fn on<'a>(&self, stdout: &'a mut dyn Write, is_taken: bool) -> Result<Console<'a>, Error> {
        if self.json && is_taken {
            let reason = "`--json` prints a summary, `--out -` data: standard output takes one of them";
            return Err(SetupError::new(reason).into());
        }
        let (stderr, nowhere) = (io::stderr(), io::sink());
        Ok(Console { stdout, stderr, nowhere, mode: *self, is_taken, notes: Vec::new() })
    }
}

impl Console<'_> {
    /// Prints words for people.
    pub fn words(&mut self) -> &mut dyn Write {
        match (self.mode, self.is_taken) {
            (OutputMode { quiet: true, .. } | OutputMode { json: true, .. }, _) => &mut self.nowhere,
            (_, true) => &mut self.stderr,
            (_, false) => self.stdout,
        }
    }

    /// Prints what was not asked for, but should be known.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn note(&mut self, note: String) -> Result<(), Error> {
        let line = wrapped(&format!("note: {}", printable(&note)), 78).join("\n  ") + "\n";
        self.notes.push(note);
        match (self.mode, self.is_taken) {
            (OutputMode { quiet: true, .. }, _) => {}
            // the run goes on even if standard error is closed
            (OutputMode { json: true, .. }, _) | (_, true) => drop(self.stderr.write_all(line.as_bytes())),
            (_, false) => {
                self.stdout.write_all(line.as_bytes())?;
                self.stdout.flush()?;
            }
        }
        Ok(())
    }

    /// Begins to show the progress of something that is done in these units.
    pub fn progress(&self, label: &str, total: u64, unit: &'static str) -> Progress {
        Progress::new(label, total, unit, self.mode.quiet)
    }

    /// Prints a JSON object, if one was asked for.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn object(&mut self, object: impl FnOnce() -> Value) -> Result<(), Error> {
        if self.mode.json {
            writeln!(self.stdout, "{:#}", object())?;
        }
        Ok(())
    }

    /// Prints a JSON object with notes and files, if asked for.
    ///
    /// # Errors
    /// If it cannot be written.
    pub(crate) fn summary(
        &mut self,
        written: &[PathBuf],
        object: impl FnOnce() -> Value,
    ) -> Result<(), Error> {
        let notes = self.notes.clone();
        self.object(|| {
            let mut object = object();
            object["notes"] = notes.into();
            object["written"] = written.iter().map(|path| path.display().to_string()).collect();
            object
        })
    }

    /// Says which files were written.
    ///
    /// # Errors
    /// If it cannot be said.
    pub(crate) fn wrote(&mut self, written: &[PathBuf]) -> Result<(), Error> {
        written.iter().try_for_each(|path| Ok(writeln!(self.words(), "wrote {}", path.display())?))
    }
}

impl std::fmt::Debug for Console<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Console").field("mode", &self.mode).finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_and_objects_exclude_each_other() {
        for (mode, is_taken, expected) in [
            (OutputMode::default(), false, "note: n\nwords\n"),
            (OutputMode::default(), true, ""),
            (OutputMode { json: true, quiet: false }, false, "1\n"),
            (OutputMode { json: true, quiet: true }, false, "1\n"),
            (OutputMode { json: false, quiet: true }, false, ""),
        ] {
            let mut printed = Vec::new();
            let mut console = mode.on(&mut printed, is_taken).expect("allowed");
            console.note("n".to_owned()).expect("writable");
            writeln!(console.words(), "words").expect("writable");
            console.object(|| 1.into()).expect("writable");
            assert_eq!(console.notes, ["n"]);
            assert_eq!(String::from_utf8(printed).expect("UTF-8"), expected, "{mode:?}");
        }
        let taken = OutputMode { json: true, quiet: false }.on(&mut io::sink(), true).map(|_| ());
        assert!(taken.is_err());
    }
}
