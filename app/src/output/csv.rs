//! A trajectory as CSV: what made it in comments, `#`, then a header and the rows.

use std::fmt::Write as _;
use std::io::{self, Write as _};

use super::{AtomicFile, Write};
use crate::conservation::ConservationReport;
use crate::entry::Entry;
use crate::provenance::{Provenance, comment, interruption};

pub(super) struct Csv {
    writer: csv::Writer<AtomicFile>,
    field: String,
    steps: u64,
}

impl Csv {
    pub(super) fn new(mut file: AtomicFile, entry: &Entry, run: &Provenance) -> io::Result<Self> {
        file.write_all(comment(run).as_bytes())?;
        let mut writer = csv::Writer::from_writer(file);
        writer.write_record(entry.columns())?;
        Ok(Self { writer, field: String::new(), steps: run.steps })
    }

    fn number(&mut self, value: f64) -> io::Result<()> {
        self.field.clear();
        // the shortest text that reads back as the same number
        write!(self.field, "{value:?}").map_err(io::Error::other)?;
        Ok(self.writer.write_field(&self.field)?)
    }
}

impl Write for Csv {
    fn row(&mut self, row: &[f64]) -> io::Result<()> {
        for &value in row {
            self.number(value)?;
        }
        Ok(self.writer.write_record(None::<&[u8]>)?)
    }

    fn finish(self: Box<Self>, _: &ConservationReport, interrupted: Option<u64>) -> io::Result<()> {
        let mut file = self.writer.into_inner().map_err(|error| error.into_error())?;
        if let Some(steps) = interrupted {
            file.write_all(interruption(steps, self.steps).as_bytes())?;
        }
        file.finish()
    }
}
