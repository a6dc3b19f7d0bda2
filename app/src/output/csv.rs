//! A trajectory as CSV.

use std::fmt::Write as _;
use std::io;

use super::{AtomicFile, Write};
use crate::conservation::ConservationReport;
use crate::entry::Entry;

pub(super) struct Csv {
    writer: csv::Writer<AtomicFile>,
    field: String,
}

impl Csv {
    pub(super) fn new(file: AtomicFile, entry: &Entry) -> io::Result<Self> {
        let mut writer = csv::Writer::from_writer(file);
        writer.write_record(entry.columns())?;
        Ok(Self { writer, field: String::new() })
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

    fn finish(self: Box<Self>, _: &ConservationReport) -> io::Result<()> {
        self.writer.into_inner().map_err(|error| error.into_error())?.finish()
    }
}
