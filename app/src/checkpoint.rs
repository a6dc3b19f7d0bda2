//! Checkpoint files: all that is needed to resume a run, bit for bit.
//!
//! A checkpoint file holds the plan of the run, its current state, and what it has recorded so far. Beside it lies the journal, the rows that
//! are to be written: they are put into the trajectory when the run ends, so that the trajectory's file is the same however often the run was
//! interrupted.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufReader, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::error::Error;
use crate::output::AtomicFile;

/// The magic bytes of checkpoint files; the number is the version of the format.
const MAGIC: &[u8] = b"coadjoint checkpoint 1\n";

/// Writes a checkpoint file atomically.
///
/// # Errors
/// If it cannot be written.
pub(crate) fn save(path: &Path, content: &impl Serialize) -> Result<(), Error> {
    let write = || -> io::Result<()> {
        let payload = postcard::to_stdvec(content).map_err(io::Error::other)?;
        let mut file = AtomicFile::create(path)?;
        file.write_all(MAGIC)?;
        file.write_all(&crc32fast::hash(&payload).to_le_bytes())?;
        file.write_all(&payload)?;
        file.finish()
    };
    write().map_err(|source| Error::Write { path: path.to_owned(), source })
}

/// Reads a checkpoint.
///
/// # Errors
/// If it cannot be read, is not a checkpoint file of this version of the program, or is damaged.
pub(crate) fn load<T: for<'a> Deserialize<'a>>(path: &Path) -> Result<T, Error> {
    let content = fs::read(path).map_err(|source| Error::Read { path: path.to_owned(), source })?;
    let refuse = |reason: &str| Error::Input(format!("{} {reason}", path.display()));
    let rest = content
        .strip_prefix(MAGIC)
        .ok_or_else(|| refuse("is not a checkpoint of this version of coadjoint"))?;
    let damaged = || refuse("is a damaged checkpoint");
    let (sum, payload) = rest.split_first_chunk::<4>().ok_or_else(damaged)?;
    if u32::from_le_bytes(*sum) != crc32fast::hash(payload) {
        return Err(damaged());
    }
    postcard::from_bytes(payload).map_err(|_| damaged())
}

/// The rows of a run that may be interrupted, as raw numbers in the order in which they came.
#[derive(Debug)]
pub(crate) struct Journal {
    path: PathBuf,
    file: BufWriter<File>,
    width: usize,
    rows: u64,
}

impl Journal {
    /// Where the journal of a checkpoint lies.
    pub(crate) fn beside(checkpoint: &Path) -> PathBuf {
        let mut name = checkpoint.as_os_str().to_owned();
        name.push(".rows");
        PathBuf::from(name)
    }

    /// Creates a journal with rows of this width.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub(crate) fn create(path: PathBuf, width: usize) -> Result<Self, Error> {
        match File::create(&path) {
            Ok(file) => Ok(Self { path, file: BufWriter::new(file), width, rows: 0 }),
            Err(source) => Err(Error::Write { path, source }),
        }
    }

    /// Opens a journal with so many rows; later rows are discarded.
    ///
    /// # Errors
    /// If the file is not there, cannot be written, or has fewer rows.
    pub(crate) fn resume(path: PathBuf, width: usize, rows: u64) -> Result<Self, Error> {
        let length = rows.saturating_mul(width as u64 * 8);
        let open = || -> io::Result<Option<File>> {
            let mut file = OpenOptions::new().read(true).write(true).open(&path)?;
            if file.metadata()?.len() < length {
                return Ok(None);
            }
            file.set_len(length)?;
            file.seek(SeekFrom::End(0))?;
            Ok(Some(file))
        };
        match open() {
            Ok(Some(file)) => Ok(Self { path, file: BufWriter::new(file), width, rows }),
            Ok(None) => Err(Error::Input(format!(
                "{} has fewer rows than its checkpoint says: it belongs to another run",
                path.display()
            ))),
            Err(source) => Err(Error::Read { path, source }),
        }
    }

    /// Adds a row.
    ///
    /// # Errors
    /// If it cannot be written.
    pub(crate) fn row(&mut self, row: &[f64]) -> Result<(), Error> {
        for value in row {
            self.file.write_all(&value.to_le_bytes()).map_err(|source| self.failure(source))?;
        }
        self.rows += 1;
        Ok(())
    }

    /// Flushes all rows to the disk, and returns how many there are.
    ///
    /// # Errors
    /// If they cannot be written.
    pub(crate) fn sync(&mut self) -> Result<u64, Error> {
        let sync = self.file.flush().and_then(|()| self.file.get_ref().sync_data());
        sync.map_err(|source| self.failure(source))?;
        Ok(self.rows)
    }

    /// Passes all rows to `show`, from the first on.
    ///
    /// # Errors
    /// If they cannot be read, or `show` fails.
    pub(crate) fn replay(&mut self, mut show: impl FnMut(&[f64]) -> Result<(), Error>) -> Result<(), Error> {
        self.sync()?;
        let unreadable = |source| Error::Read { path: self.path.clone(), source };
        let mut file = BufReader::new(File::open(&self.path).map_err(unreadable)?);
        let mut row = vec![0.0; self.width];
        for _ in 0..self.rows {
            for value in &mut row {
                let mut bytes = [0; 8];
                file.read_exact(&mut bytes).map_err(unreadable)?;
                *value = f64::from_le_bytes(bytes);
            }
            show(&row)?;
        }
        Ok(())
    }

    fn failure(&self, source: io::Error) -> Error {
        Error::Write { path: self.path.clone(), source }
    }
}

/// Removes a checkpoint and its journal: the run is complete.
pub(crate) fn remove(checkpoint: &Path) {
    // a file that remains is harmless
    let _ = fs::remove_file(checkpoint);
    let _ = fs::remove_file(Journal::beside(checkpoint));
}
