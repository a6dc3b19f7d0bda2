//! Files: trajectories as CSV, JSON or Parquet, each written whole or not at all.

mod atomic_file;
mod csv;
mod guard;
mod json;
#[cfg(feature = "parquet")]
mod parquet;
pub(crate) mod path;

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

pub use self::atomic_file::AtomicFile;
pub(crate) use self::atomic_file::{Replace, random, remove_temporaries};
pub use self::guard::{Claim, Guard};
pub(crate) use self::json::invariants;
use crate::conservation::ConservationReport;
use crate::entry::Entry;
use crate::error::Error;
use crate::provenance::{self, Origin};

/// How a trajectory is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Format {
    /// Comments that begin with `#` and say what made it, a header naming each column, then a line per sample.
    Csv,
    /// One object: system, parameters, columns, rows, invariants.
    Json,
    /// Columns of doubles, for tables of many millions of rows; in programs that are built with the feature `parquet`.
    Parquet,
}

impl Format {
    /// The extension of such files.
    pub fn extension(self) -> &'static str {
        match self {
            Format::Csv => "csv",
            Format::Json => "json",
            Format::Parquet => "parquet",
        }
    }
}

impl Format {
    /// The format of files with this extension.
    pub(crate) fn of_extension(extension: &str) -> Option<Self> {
        clap::ValueEnum::value_variants()
            .iter()
            .copied()
            .find(|format: &Self| format.extension() == extension)
    }
}

/// A file format being written.
trait Write {
    /// Adds a row: time, the state's components, energy.
    fn row(&mut self, row: &[f64]) -> io::Result<()>;
    /// Ends the file and puts it in its place.
    fn finish(self: Box<Self>, conservation: &ConservationReport, interrupted: Option<u64>)
    -> io::Result<()>;
}

/// A trajectory being written; dropped before it is finished, it leaves no file.
pub(crate) struct TrajectoryWriter {
    path: PathBuf,
    writer: Box<dyn Write>,
}

impl TrajectoryWriter {
    /// Begins a trajectory; `-` is the standard output.
    ///
    /// # Errors
    /// If the file cannot be created.
    pub(crate) fn create(
        path: &Path,
        format: Format,
        entry: &'static Entry,
        guard: &Guard,
    ) -> Result<Self, Error> {
        let writer = || -> io::Result<Box<dyn Write>> {
            let file = AtomicFile::begin(path, Replace::Guarded(guard.clone()))?;
            Ok(match format {
                Format::Csv => Box::new(csv::Csv::new(file, entry, guard.origin())?),
                Format::Json => Box::new(json::Json::new(file, entry, guard.origin())?),
                #[cfg(feature = "parquet")]
                Format::Parquet => Box::new(parquet::Parquet::new(file, entry, guard.origin())?),
                #[cfg(not(feature = "parquet"))]
                Format::Parquet => {
                    let missing = "this program was built without `--features parquet`";
                    return Err(io::Error::new(io::ErrorKind::Unsupported, missing));
                }
            })
        };
        match writer() {
            Ok(writer) => Ok(Self { path: path.to_owned(), writer }),
            Err(source) => Err(failure(path, source)),
        }
    }

    /// Adds a row: time, the state's components, energy.
    ///
    /// # Errors
    /// If it cannot be written.
    pub(crate) fn row(&mut self, row: &[f64]) -> Result<(), Error> {
        self.writer.row(row).map_err(|source| failure(&self.path, source))
    }

    /// Puts the file in its place and tells where; with the number of steps, if the run was interrupted.
    ///
    /// # Errors
    /// If the rest cannot be written.
    pub(crate) fn finish(
        self,
        conservation: &ConservationReport,
        interrupted: Option<u64>,
    ) -> Result<PathBuf, Error> {
        match self.writer.finish(conservation, interrupted) {
            Ok(()) => Ok(self.path),
            Err(source) => Err(failure(&self.path, source)),
        }
    }
}

/// That nobody reads the standard output is no error.
fn failure(path: &Path, source: io::Error) -> Error {
    if path::is_stdout(path) {
        Error::Console(source)
    } else {
        Error::Write { path: path.to_owned(), source }
    }
}

impl std::fmt::Debug for TrajectoryWriter {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("TrajectoryWriter").field("path", &self.path).finish_non_exhaustive()
    }
}

/// Reads a text of at most a megabyte: what is given for a text by mistake may have no end.
///
/// # Errors
/// If it cannot be read, is longer, or is no UTF-8.
pub(crate) fn read_text(path: &Path) -> Result<String, Error> {
    const MOST: u64 = 1 << 20;
    let read = || {
        let mut text = String::new();
        File::open(path)?.take(MOST + 1).read_to_string(&mut text)?;
        if text.len() as u64 > MOST {
            return Err(io::Error::new(io::ErrorKind::FileTooLarge, "it is longer than a megabyte"));
        }
        Ok(text)
    };
    read().map_err(|source| Error::Read { path: path.to_owned(), source })
}

/// Makes a directory and those above it, where they are missing.
///
/// # Errors
/// If that cannot be done.
pub(crate) fn make_directory(directory: &Path) -> Result<(), Error> {
    std::fs::create_dir_all(directory).map_err(|source| Error::Write { path: directory.to_owned(), source })
}

/// A file in a directory; or standard output, where `-` stands for the directory.
pub(crate) fn file_in(directory: &Path, name: &str) -> PathBuf {
    if path::is_stdout(directory) { directory.to_owned() } else { directory.join(name) }
}

/// A table as CSV, with what made it in front.
pub(crate) fn table(run: &Origin, records: &[Vec<String>]) -> Vec<u8> {
    let mut table = provenance::comment(run).into_bytes();
    for record in records {
        csv::write_record(&mut table, record);
    }
    if let Some(steps) = run.interrupted() {
        table.extend(provenance::interruption(steps, run.steps()).into_bytes());
    }
    table
}

/// Writes a file, whole or not at all, in the place of what is there.
///
/// # Errors
/// If that cannot be done.
pub(crate) fn write_bytes(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    let write = || {
        let mut file = AtomicFile::create(path)?;
        io::Write::write_all(&mut file, bytes)?;
        file.finish()
    };
    write().map_err(|source| Error::Write { path: path.to_owned(), source })
}
