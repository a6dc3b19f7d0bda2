//! What a command tells: words for people, or one JSON object for programs; notes beside them.

use std::io::{self, Write};

use clap::Args;
use serde_json::Value;

use crate::error::Error;
use crate::progress;
use crate::report::wrapped;

/// How a command tells what it found.
#[derive(Clone, Copy, Debug, Default, Args)]
pub struct Telling {
    /// Print one JSON object and nothing else; notes go to standard error
    #[arg(long)]
    pub json: bool,
    /// Print errors alone: no progress, notes or table
    #[arg(short, long)]
    pub quiet: bool,
}

/// Where a command tells it.
pub struct Console<'a> {
    stdout: &'a mut dyn Write,
    stderr: io::Stderr,
    nowhere: io::Sink,
    telling: Telling,
    /// Whether standard output is taken by data, so that words have to go elsewhere.
    is_taken: bool,
    notes: Vec<String>,
}

impl Telling {
    /// Tells on standard output; on standard error where the first one is taken by data.
    ///
    /// # Errors
    /// If both data and a JSON object are to be written to standard output.
    pub fn on<'a>(&self, stdout: &'a mut dyn Write, is_taken: bool) -> Result<Console<'a>, Error> {
        if self.json && is_taken {
            return Err(Error::Input(
                "`--json` prints a summary, `--out -` data: standard output takes one of them".to_owned(),
            ));
        }
        if self.quiet {
            progress::silence();
        }
        let (stderr, nowhere) = (io::stderr(), io::sink());
        Ok(Console { stdout, stderr, nowhere, telling: *self, is_taken, notes: Vec::new() })
    }
}

impl Console<'_> {
    /// For words.
    pub fn words(&mut self) -> &mut dyn Write {
        match (self.telling, self.is_taken) {
            (Telling { quiet: true, .. } | Telling { json: true, .. }, _) => &mut self.nowhere,
            (_, true) => &mut self.stderr,
            (_, false) => self.stdout,
        }
    }

    /// Tells something that is not what was asked for, but should be known.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn note(&mut self, note: String) -> Result<(), Error> {
        let line = wrapped(&format!("note: {note}"), 78).join("\n  ") + "\n";
        self.notes.push(note);
        match (self.telling, self.is_taken) {
            (Telling { quiet: true, .. }, _) => {}
            // the run goes on even if standard error is closed
            (Telling { json: true, .. }, _) | (_, true) => drop(self.stderr.write_all(line.as_bytes())),
            (_, false) => {
                self.stdout.write_all(line.as_bytes())?;
                self.stdout.flush()?;
            }
        }
        Ok(())
    }

    /// All notes so far.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Prints a JSON object, if one was asked for.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn object(&mut self, object: impl FnOnce() -> Value) -> Result<(), Error> {
        if self.telling.json {
            writeln!(self.stdout, "{:#}", object())?;
        }
        Ok(())
    }
}

impl std::fmt::Debug for Console<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Console").field("telling", &self.telling).finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_and_objects_exclude_each_other() {
        for (telling, is_taken, expected) in [
            (Telling::default(), false, "note: n\nwords\n"),
            (Telling::default(), true, ""),
            (Telling { json: true, quiet: false }, false, "1\n"),
            (Telling { json: true, quiet: true }, false, "1\n"),
            (Telling { json: false, quiet: true }, false, ""),
        ] {
            let mut printed = Vec::new();
            let mut console = telling.on(&mut printed, is_taken).expect("allowed");
            console.note("n".to_owned()).expect("writable");
            writeln!(console.words(), "words").expect("writable");
            console.object(|| 1.into()).expect("writable");
            assert_eq!(console.notes(), ["n"]);
            assert_eq!(String::from_utf8(printed).expect("UTF-8"), expected, "{telling:?}");
        }
        let taken = Telling { json: true, quiet: false }.on(&mut io::sink(), true).map(|_| ());
        assert!(taken.is_err());
    }
}
