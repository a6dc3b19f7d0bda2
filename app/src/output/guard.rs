//! Nothing is replaced unasked: all files of a run are looked at before it starts.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::atomic_file::{AtomicFile, Replace, left_behind};
use super::make_directory;
use super::path::{followed, is_special, is_stdout, resolved};
use crate::error::Error;
use crate::provenance::{self, Provenance};

/// Lets a file replace that of the same run, and others where that was asked for.
#[derive(Clone, Debug)]
pub(crate) struct Guard {
    run: Arc<Provenance>,
    force: bool,
}

/// A file of a run, and what it is to it.
#[derive(Clone, Debug)]
pub(crate) struct Claim {
    /// `--html`, `the trajectory`
    pub(crate) what: &'static str,
    /// Where.
    pub(crate) path: PathBuf,
    /// Whether it is written; else it is read, or has a lock of its own.
    pub(crate) written: bool,
}

impl Guard {
    /// Of the files of a run.
    pub(crate) fn new(run: Provenance, force: bool) -> Self {
        Self { run: Arc::new(run), force }
    }

    /// What made the files.
    pub(crate) fn run(&self) -> &Provenance {
        &self.run
    }

    /// Whether a file may be put here.
    ///
    /// # Errors
    /// If a file is there that is not of the same run.
    pub(crate) fn check(&self, path: &Path) -> Result<(), Error> {
        if self.force || is_stdout(path) || !path.is_file() {
            return Ok(());
        }
        let found = provenance::read(path).map_err(|source| Error::Read { path: path.to_owned(), source })?;
        let made = match found.map(|found| self.run.differences(&found)) {
            None => "was not made by this program".to_owned(),
            Some(differences) if differences.is_empty() => return Ok(()),
            Some(differences) => format!("is of a run with another {}", differences.join(", ")),
        };
        Err(Error::Taken { path: path.to_owned(), made })
    }

    /// Whether the file of the same run is here, complete.
    pub(crate) fn is_complete(&self, path: &Path) -> bool {
        let found = provenance::read(path).ok().flatten();
        found.is_some_and(|found| found.interrupted.is_none() && self.run.differences(&found).is_empty())
    }

    /// Looks at all files of a run before it starts: no two are one, none takes the place of another run's or of a stranger's, all can be
    /// written. The answer is what was left behind beside them by processes that were killed.
    ///
    /// # Errors
    /// If any of that is not so.
    pub(crate) fn check_all(&self, claims: &[Claim]) -> Result<Vec<PathBuf>, Error> {
        let places: Vec<PathBuf> = claims.iter().map(|claim| resolved(&claim.path)).collect();
        for (i, claim) in claims.iter().enumerate() {
            // into a device as much goes as one likes
            let other = (0..i).find(|&j| places[i] == places[j] && !is_special(&places[i]));
            if let Some(other) = other {
                let (path, both) = (claim.path.clone(), [claims[other].what, claim.what]);
                return Err(Error::Collision { path, both });
            }
        }
        let written = || claims.iter().filter(|claim| claim.written).map(|claim| &claim.path);
        for path in written() {
            self.check(path)?;
        }
        for path in written().filter(|path| !is_stdout(path) && !is_special(path)) {
            let failure = |source| Error::Write { path: path.clone(), source };
            let place = followed(path).map_err(failure)?;
            if let Some(directory) = place.parent().filter(|directory| !directory.as_os_str().is_empty()) {
                make_directory(directory)?;
            }
            // dropped at once: it can be written
            AtomicFile::begin(path, Replace::Nothing).map_err(failure)?;
        }
        Ok(claims.iter().flat_map(|claim| left_behind(&claim.path)).collect())
    }

    /// Writes a file, whole or not at all.
    ///
    /// # Errors
    /// If that cannot be done, or another file is in its place.
    pub(crate) fn write(&self, path: &Path, content: &[u8]) -> Result<(), Error> {
        let write = || {
            let mut file = AtomicFile::begin(path, Replace::Guarded(self.clone()))?;
            std::io::Write::write_all(&mut file, content)?;
            file.finish()
        };
        write().map_err(|source| Error::Write { path: path.to_owned(), source })
    }
}
