//! Trajectories as CSV, JSON or Parquet, and tables of texts.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::NewFile;
use super::json::{Json, invariants};
#[cfg(feature = "parquet")]
use super::parquet::Parquet;
use super::run_json::FileOrigin;
use serde_json::{Map, Value};

use crate::catalogue::Entry;
use crate::error::{Error, FileError};
use crate::record::ConservationReport;
use crate::setup::Format;

/// A format of trajectories.
pub(super) trait Rows {
    /// Adds a row: a number for each column.
    fn row(&mut self, row: &[f64]) -> io::Result<()>;
    /// Ends the file with what is known of the run, by name.
    fn finish(self: Box<Self>, known: &Map<String, Value>) -> io::Result<NewFile>;
}

/// A trajectory being written; dropped before it is finished, it leaves no file.
pub(crate) struct TrajectoryWriter {
    path: PathBuf,
    rows: Box<dyn Rows>,
}

impl TrajectoryWriter {
    /// Begins a trajectory with these columns; `-` is the standard output.
    ///
    /// # Errors
    /// If the file cannot be created.
    pub(crate) fn create(
        path: &Path,
        format: Format,
        columns: Vec<String>,
        origin: &FileOrigin,
    ) -> Result<Self, Error> {
        let rows = rows_file(NewFile::begin(path)?, format, columns, origin);
        let rows = rows.map_err(|source| failure(path, source))?;
        Ok(Self { path: path.to_owned(), rows })
    }

    /// Adds a row: a number for each column.
    ///
    /// # Errors
    /// If it cannot be written.
    pub(crate) fn row(&mut self, row: &[f64]) -> Result<(), Error> {
        self.rows.row(row).map_err(|source| failure(&self.path, source))
    }

    /// Ends the file, to be put in its place; with the number of steps, if the run was interrupted.
    ///
    /// # Errors
    /// If the rest cannot be written.
    pub(crate) fn finish(
        self,
        entry: &Entry,
        conservation: &ConservationReport,
        interrupted: Option<u64>,
    ) -> Result<(PathBuf, NewFile), Error> {
        let finish = || {
            let mut known = Map::from_iter([("invariants".to_owned(), invariants(entry, conservation))]);
            known.extend(interrupted.map(|steps| ("interrupted".to_owned(), steps.into())));
            let mut file = self.rows.finish(&known)?;
            file.flush()?;
            Ok(file)
        };
        let file = finish().map_err(|source| failure(&self.path, source))?;
        Ok((self.path, file))
    }
}

/// Begins a table with these columns in a file; a column `member` is of integers where the format has them.
pub(super) fn rows_file(
    file: NewFile,
    format: Format,
    columns: Vec<String>,
    origin: &FileOrigin,
) -> io::Result<Box<dyn Rows>> {
    Ok(match format {
        Format::Csv => Box::new(Csv::new(file, columns)?),
        Format::Json => Box::new(Json::new(file, &columns, origin)?),
        #[cfg(feature = "parquet")]
        Format::Parquet => Box::new(Parquet::new(file, &columns, origin)?),
        #[cfg(not(feature = "parquet"))]
        // [checked](Format::checked) before
        Format::Parquet => return Err(io::ErrorKind::Unsupported.into()),
    })
}

/// That nobody reads the standard output is no error.
fn failure(path: &Path, source: io::Error) -> Error {
    if super::is_stdout(path) { Error::Console(source) } else { FileError::write(path)(source).into() }
}

/// A header and numbers.
struct Csv {
    file: NewFile,
    /// Whether the first column is of members' numbers.
    has_members: bool,
}

impl Csv {
    fn new(mut file: NewFile, columns: Vec<String>) -> io::Result<Self> {
        let has_members = columns.first().is_some_and(|name| name == "member");
        file.write_all(&table(&[columns]))?;
        Ok(Self { file, has_members })
    }
}

impl Rows for Csv {
    fn row(&mut self, row: &[f64]) -> io::Result<()> {
        match row {
            [member, rest @ ..] if self.has_members => {
                write!(self.file, "{member},")?;
                write_row(&mut self.file, rest)
            }
            _ => write_row(&mut self.file, row),
        }
    }

    fn finish(self: Box<Self>, _: &Map<String, Value>) -> io::Result<NewFile> {
        Ok(self.file)
    }
}

/// Writes numbers as a line of CSV, each as the shortest text that reads back as the same.
pub(super) fn write_row(to: &mut impl Write, row: &[f64]) -> io::Result<()> {
    for (k, value) in row.iter().enumerate() {
        write!(to, "{}{value:?}", if k > 0 { "," } else { "" })?;
    }
    to.write_all(b"\n")
}

/// Writes records as CSV; texts that would end a field or a line are quoted.
pub fn table(records: &[Vec<String>]) -> Vec<u8> {
    let mut writer = csv::WriterBuilder::new().flexible(true).from_writer(Vec::new());
    // writing to memory does not fail
    let _ = records.iter().try_for_each(|record| writer.write_record(record));
    writer.into_inner().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_that_would_end_a_field_are_quoted() {
        let record = |fields: &[&str]| {
            let fields = fields.iter().map(|&field| field.to_owned()).collect();
            String::from_utf8(table(&[fields])).expect("UTF-8")
        };
        assert_eq!(record(&["time", "|γ|²", ""]), "time,|γ|²,\n");
        assert_eq!(
            record(&["#1", "a,b", "say \"no\"", "two\nlines"]),
            "#1,\"a,b\",\"say \"\"no\"\"\",\"two\nlines\"\n"
        );
        let mut row = Vec::new();
        write_row(&mut row, &[0.1, -1e-300, f64::NAN]).expect("in memory");
        assert_eq!(row, b"0.1,-1e-300,NaN\n");
    }
}
