//! Checkpoints: all that is needed to resume a run, bit for bit.
//!
//! Three files: the checkpoint itself, with the plan of the run, its current state, and what it has recorded so far; beside it the
//! [`Journal`], the rows that are to be written: they are put into the trajectory when the run ends, so that the trajectory's file is the same
//! however often the run was interrupted; and a [`Lock`], so that one process at a time has both. Checkpoint and journal carry the same random
//! identity, and a checksum of every byte. They are read on a disk that may lose what was not synced, and may flip bits.

mod journal;
mod lock;

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use self::journal::Journal;
pub(crate) use self::journal::Mark;
use self::lock::Lock;
use crate::cli::program;
use crate::error::Error;
use crate::output::path::{followed, sync_directory};
use crate::output::{AtomicFile, Replace, random};

/// What checkpoint files begin with; the number is the version of the format.
const MAGIC: &[u8] = b"coadjoint checkpoint 2\n";
/// What those of all versions begin with.
const ANY: &[u8] = b"coadjoint checkpoint ";

/// What tells a run from all others, also of the same plan.
pub(crate) type Identity = [u8; 16];

/// The files of a run that can be resumed, held by this process alone.
#[derive(Debug)]
pub(crate) struct Store {
    path: PathBuf,
    identity: Identity,
    journal: Journal,
    // released last
    _lock: Lock,
}

/// The content of a checkpoint file.
#[derive(Debug, Serialize, Deserialize)]
struct Saved<T> {
    identity: Identity,
    mark: Mark,
    content: T,
}

impl Store {
    /// Begins the files of a run, with what is needed to start it, and rows of this width.
    ///
    /// # Errors
    /// If any of them is there, or cannot be written.
    pub(crate) fn begin(path: &Path, width: usize, content: &impl Serialize) -> Result<Self, Error> {
        let failure = |source| Error::Write { path: path.to_owned(), source };
        let path = &followed(path).map_err(failure)?;
        let lock = Lock::acquire(beside(path, "lock"))?;
        if fs::symlink_metadata(path).is_ok() {
            let is_ours = fs::read(path).is_ok_and(|content| content.starts_with(ANY));
            let name = path.display();
            return Err(Error::Input(match is_ours {
                true => format!("{name} exists already: `{} resume {name}` resumes it", program()),
                false => format!("{name} exists already, and is no checkpoint"),
            }));
        }
        let identity = [random().to_le_bytes(), random().to_le_bytes()].concat();
        let identity = identity.try_into().unwrap_or_default();
        let rows = beside(path, "rows");
        if fs::symlink_metadata(&rows).is_ok() {
            return Err(Error::Input(format!(
                "{} exists already, without its checkpoint: to start again, remove it first",
                rows.display()
            )));
        }
        // the checkpoint first: without its journal it can be resumed, from the start
        save(path, Replace::Nothing, &Saved { identity, mark: Mark::default(), content })?;
        let begun = Journal::create(rows, width, identity);
        let journal = begun.inspect_err(|_| {
            // without a journal it is of no use
            let _ = fs::remove_file(path);
        })?;
        Ok(Self { path: path.to_owned(), identity, journal, _lock: lock })
    }

    /// Opens the files of a run that was interrupted. All that will be read of them is verified. The width of rows is found from the content, which
    /// may also be refused.
    ///
    /// # Errors
    /// If they are in use, cannot be read, are of another version of the program, or not what was written.
    pub(crate) fn open<T: for<'a> Deserialize<'a>>(
        path: &Path,
        width: impl FnOnce(&T) -> Result<usize, Error>,
    ) -> Result<(Self, T), Error> {
        let unreadable = |source| Error::Read { path: path.to_owned(), source };
        let path = &followed(path).map_err(unreadable)?;
        // a lock is made only beside what is there
        fs::metadata(path).map_err(unreadable)?;
        let lock = Lock::acquire(beside(path, "lock"))?;
        let Saved { identity, mark, content } = load(path)?;
        let width = width(&content)?;
        let journal = Journal::open(beside(path, "rows"), width, identity, &mark)?;
        Ok((Self { path: path.to_owned(), identity, journal, _lock: lock }, content))
    }

    /// Adds a row to the journal.
    ///
    /// # Errors
    /// If it cannot be written.
    pub(crate) fn row(&mut self, row: &[f64]) -> Result<(), Error> {
        self.journal.row(row)
    }

    /// Saves what the run is to be resumed with, together with all rows so far.
    ///
    /// # Errors
    /// If it cannot be written.
    pub(crate) fn save(&mut self, content: &impl Serialize) -> Result<(), Error> {
        let mark = self.journal.sync()?;
        save(&self.path, Replace::Anything, &Saved { identity: self.identity, mark, content })
    }

    /// Passes all rows to `show`, from the first on.
    ///
    /// # Errors
    /// If they are not what was written, or `show` fails.
    pub(crate) fn replay(&mut self, show: &mut dyn FnMut(&[f64]) -> Result<(), Error>) -> Result<(), Error> {
        self.journal.replay(show)
    }

    /// Removes all files: the run is complete, and its output written.
    pub(crate) fn remove(self) {
        // the checkpoint first: a journal alone is never taken for a run; what remains is harmless
        let _ = fs::remove_file(&self.path);
        let _ = sync_directory(&self.path);
        let _ = fs::remove_file(beside(&self.path, "rows"));
    }
}

/// The file of a checkpoint with this ending.
pub(crate) fn beside(checkpoint: &Path, ending: &str) -> PathBuf {
    let mut name = checkpoint.as_os_str().to_owned();
    name.push(".");
    name.push(ending);
    PathBuf::from(name)
}

fn save(path: &Path, replace: Replace, content: &impl Serialize) -> Result<(), Error> {
    let write = || -> io::Result<()> {
        let payload = postcard::to_stdvec(content).map_err(io::Error::other)?;
        let mut file = AtomicFile::begin(path, replace)?;
        file.write_all(MAGIC)?;
        file.write_all(&crc32fast::hash(&payload).to_le_bytes())?;
        file.write_all(&payload)?;
        file.finish()
    };
    write().map_err(|source| Error::Write { path: path.to_owned(), source })
}

fn load<T: for<'a> Deserialize<'a>>(path: &Path) -> Result<T, Error> {
    let content = fs::read(path).map_err(|source| Error::Read { path: path.to_owned(), source })?;
    let refuse = |what: &str| Error::Damaged { path: path.to_owned(), what: what.to_owned() };
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
