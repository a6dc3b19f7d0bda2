//! A trajectory as CSV: what made it in comments, `#`, then a header and the rows.

use std::io::{self, Write as _};

use super::{AtomicFile, Write};
use crate::conservation::ConservationReport;
use crate::entry::Entry;
use crate::provenance::{Origin, comment, interruption};

pub(super) struct Csv {
    file: AtomicFile,
    line: Vec<u8>,
    steps: u64,
}

impl Csv {
    pub(super) fn new(mut file: AtomicFile, entry: &Entry, run: &Origin) -> io::Result<Self> {
        file.write_all(comment(run).as_bytes())?;
        let mut line = Vec::new();
        write_record(&mut line, &entry.columns());
        file.write_all(&line)?;
        Ok(Self { file, line, steps: run.steps() })
    }
}

impl Write for Csv {
    fn row(&mut self, row: &[f64]) -> io::Result<()> {
        self.line.clear();
        for (k, value) in row.iter().enumerate() {
            if k > 0 {
                self.line.push(b',');
            }
            // the shortest text that reads back as the same number
            write!(self.line, "{value:?}")?;
        }
        self.line.push(b'\n');
        self.file.write_all(&self.line)
    }

    fn finish(mut self: Box<Self>, _: &ConservationReport, interrupted: Option<u64>) -> io::Result<()> {
        if let Some(steps) = interrupted {
            self.file.write_all(interruption(steps, self.steps).as_bytes())?;
        }
        self.file.finish()
    }
}

/// Adds a line of texts; those that would end a field or a line are quoted.
pub(super) fn write_record(to: &mut Vec<u8>, fields: &[String]) {
    for (k, field) in fields.iter().enumerate() {
        if k > 0 {
            to.push(b',');
        }
        // a first field that begins like a comment would be taken for one
        if field.contains([',', '"', '\n', '\r']) || (k == 0 && field.starts_with('#')) {
            to.extend(format!("\"{}\"", field.replace('"', "\"\"")).into_bytes());
        } else {
            to.extend(field.as_bytes());
        }
    }
    to.push(b'\n');
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_that_would_end_a_field_are_quoted() {
        let record = |fields: &[&str]| {
            let mut line = Vec::new();
            write_record(&mut line, &fields.iter().map(|&field| field.to_owned()).collect::<Vec<_>>());
            String::from_utf8(line).expect("UTF-8")
        };
        assert_eq!(record(&["time", "|γ|²", ""]), "time,|γ|²,\n");
        assert_eq!(
            record(&["#1", "a,b", "say \"no\"", "two\nlines"]),
            "\"#1\",\"a,b\",\"say \"\"no\"\"\",\"two\nlines\"\n"
        );
    }
}
