//! Files: trajectories as CSV, JSON or Parquet, each written whole or not at all.

mod atomic_file;
mod csv;
mod json;
#[cfg(feature = "parquet")]
mod parquet;
pub(crate) mod path;

use std::io;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

pub use self::atomic_file::AtomicFile;
pub(crate) use self::json::{by_name, invariants, run as described};
use self::path::is_stdout;
use crate::conservation::ConservationReport;
use crate::entry::Entry;
use crate::error::Error;
use crate::simulation::{Job, Method, Order, Setup};

/// How a trajectory is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Format {
    /// A header naming each column, then a line per sample.
    Csv,
    /// One object: system, parameters, columns, rows, invariants.
    Json,
    /// Columns of doubles, for tables of many millions of rows.
    #[cfg(feature = "parquet")]
    Parquet,
}

impl Format {
    /// The extension of such files.
    pub fn extension(self) -> &'static str {
        match self {
            Format::Csv => "csv",
            Format::Json => "json",
            #[cfg(feature = "parquet")]
            Format::Parquet => "parquet",
        }
    }
}

/// A file format being written.
trait Write {
    /// Adds a row: time, the state's components, energy.
    fn row(&mut self, row: &[f64]) -> io::Result<()>;
    /// Ends the file and puts it in its place.
    fn finish(self: Box<Self>, conservation: &ConservationReport) -> io::Result<()>;
}

/// A trajectory being written; dropped before it is finished, it leaves no file.
pub struct Trajectory {
    path: PathBuf,
    writer: Box<dyn Write>,
}

impl Trajectory {
    /// Begins `<directory>/<system>-<retraction>.<extension>`, making the directory if need be. The name of a method that is not the
    /// standard one stands before the retraction's.
    ///
    /// # Errors
    /// If the file cannot be created.
    pub fn create(
        directory: &Path,
        format: Format,
        entry: &'static Entry,
        setup: &Setup,
        job: &Job,
    ) -> Result<Self, Error> {
        let path = file_in(directory, &format!("{}.{}", name(entry, job), format.extension()))?;
        let writer = || -> io::Result<Box<dyn Write>> {
            let file = AtomicFile::create(&path)?;
            Ok(match format {
                Format::Csv => Box::new(csv::Csv::new(file, entry)?),
                Format::Json => Box::new(json::Json::new(file, entry, setup, job)?),
                #[cfg(feature = "parquet")]
                Format::Parquet => Box::new(parquet::Parquet::new(file, entry, setup, job)?),
            })
        };
        match writer() {
            Ok(writer) => Ok(Self { path, writer }),
            Err(source) => Err(write_error(&path, source)),
        }
    }

    /// Adds a row: time, the state's components, energy.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn row(&mut self, row: &[f64]) -> Result<(), Error> {
        self.writer.row(row).map_err(|source| write_error(&self.path, source))
    }

    /// Puts the file in its place and tells where.
    ///
    /// # Errors
    /// If the rest cannot be written.
    pub fn finish(self, conservation: &ConservationReport) -> Result<PathBuf, Error> {
        match self.writer.finish(conservation) {
            Ok(()) => Ok(self.path),
            Err(source) => Err(write_error(&self.path, source)),
        }
    }
}

impl std::fmt::Debug for Trajectory {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Trajectory").field("path", &self.path).finish_non_exhaustive()
    }
}

/// What the files of a run are called: `heavy_top-cayley`, `heavy_top-midpoint-order4-cayley`, `heavy_top-rk4`.
pub fn name(entry: &Entry, job: &Job) -> String {
    let mut name = entry.name.to_owned();
    if job.method != Method::Standard {
        name += &format!("-{}", job.method.stem());
    }
    if job.order != Order::Two {
        name += &format!("-order{}", job.order.number());
    }
    if job.method.classical().is_none() {
        name += &format!("-{}", job.retraction.name());
    }
    name
}

/// Makes a directory and those above it, where they are missing.
///
/// # Errors
/// If that cannot be done.
pub fn make_directory(directory: &Path) -> Result<(), Error> {
    std::fs::create_dir_all(directory).map_err(|source| Error::Write { path: directory.to_owned(), source })
}

/// A file in a directory, which is made if need be; or standard output, where `-` stands for the directory.
///
/// # Errors
/// If the directory cannot be made.
pub(crate) fn file_in(directory: &Path, name: &str) -> Result<PathBuf, Error> {
    if is_stdout(directory) {
        return Ok(directory.to_owned());
    }
    make_directory(directory)?;
    Ok(directory.join(name))
}

/// What went wrong where: nobody who reads standard output is no error of a file.
fn write_error(path: &Path, source: io::Error) -> Error {
    if is_stdout(path) { Error::Console(source) } else { Error::Write { path: path.to_owned(), source } }
}

/// Writes a table as CSV, whole or not at all.
///
/// # Errors
/// If it cannot be written.
pub(crate) fn write_table(path: &Path, records: impl Iterator<Item = Vec<String>>) -> Result<(), Error> {
    let written = || -> io::Result<()> {
        let mut file = AtomicFile::create(path)?;
        let mut writer = ::csv::Writer::from_writer(&mut file);
        for record in records {
            writer.write_record(record)?;
        }
        writer.flush()?;
        drop(writer);
        file.finish()
    };
    written().map_err(|source| write_error(path, source))
}

/// Writes a text, whole or not at all.
///
/// # Errors
/// If that cannot be done.
pub fn write_text(path: &Path, text: &str) -> Result<(), Error> {
    write_bytes(path, text.as_bytes())
}

/// Writes a file, whole or not at all.
///
/// # Errors
/// If that cannot be done.
pub fn write_bytes(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    let write = || {
        let mut file = AtomicFile::create(path)?;
        io::Write::write_all(&mut file, bytes)?;
        file.finish()
    };
    write().map_err(|source| Error::Write { path: path.to_owned(), source })
}
