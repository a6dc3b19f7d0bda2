//! A lock: one process at a time.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use crate::error::Error;

/// What lock files hold, so that no stranger's file is taken for one.
const CONTENT: &[u8] = b"coadjoint lock\n";

/// Held until it is dropped; a process that is killed holds it no more, whatever of the file remains.
#[derive(Debug)]
pub(crate) struct Lock {
    path: PathBuf,
    // open as long as the lock is held
    _file: File,
}

impl Lock {
    /// Takes a lock, without waiting.
    ///
    /// # Errors
    /// If another process has it, or a file that is no lock is in its place.
    pub(crate) fn acquire(path: PathBuf) -> Result<Self, Error> {
        let failure = |source| Error::Write { path: path.clone(), source };
        loop {
            let file = open(&path).map_err(failure)?;
            match file.try_lock() {
                Ok(()) => {}
                Err(TryLockError::WouldBlock) => return Err(Error::InUse { path: path.with_extension("") }),
                Err(TryLockError::Error(error)) if error.kind() == io::ErrorKind::Unsupported => {
                    // the run goes on even if standard error is closed
                    let _ = writeln!(
                        io::stderr(),
                        "note: this file system has no locks: see to it that {} is used by one run alone",
                        path.with_extension("").display()
                    );
                }
                Err(TryLockError::Error(source)) => return Err(failure(source)),
            }
            // whoever had it may have removed the file before it was locked here
            if is_at(&file, &path) {
                return Ok(Self { path, _file: file });
            }
        }
    }
}

impl Drop for Lock {
    fn drop(&mut self) {
        // while it is held; a file that remains is harmless
        let _ = fs::remove_file(&self.path);
    }
}

fn open(path: &Path) -> io::Result<File> {
    match OpenOptions::new().read(true).write(true).create_new(true).open(path) {
        Ok(mut file) => {
            file.write_all(CONTENT)?;
            Ok(file)
        }
        Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
            let file = OpenOptions::new().read(true).write(true).open(path)?;
            let mut content = Vec::new();
            Read::by_ref(&mut &file).take(CONTENT.len() as u64 + 1).read_to_end(&mut content)?;
            // that of a process that was killed may be cut short
            if file.metadata()?.is_file() && CONTENT.starts_with(&content) {
                Ok(file)
            } else {
                Err(io::Error::new(io::ErrorKind::AlreadyExists, "it is no lock of this program"))
            }
        }
        Err(error) => Err(error),
    }
}

#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let identity = |at: fs::Metadata| (at.dev(), at.ino());
    match (file.metadata(), fs::metadata(path)) {
        (Ok(file), Ok(at)) => identity(file) == identity(at),
        _ => false,
    }
}

#[cfg(not(unix))]
fn is_at(_: &File, path: &Path) -> bool {
    path.exists()
}
