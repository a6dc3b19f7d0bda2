//! Nothing is replaced unasked: all files of a run are looked at before it starts.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::atomic_file::{AtomicFile, Replace, left_behind};
use super::make_directory;
use super::path::{followed, is_special, is_stdout, resolved};
use crate::error::Error;
use crate::provenance::{self, Origin};

/// Lets a file replace one of the same origin, and others where that was asked for.
#[derive(Clone, Debug)]
pub struct Guard {
    origin: Arc<Origin>,
    /// Whether a file of the same origin is the same file.
    repeats: bool,
    force: bool,
}

/// A file of a run, and what it is to it.
#[derive(Clone, Debug)]
pub struct Claim {
    /// `--html`, `the trajectory`
    pub what: &'static str,
    /// Where.
    pub path: PathBuf,
    /// Whether it is written; else it is read, or has a lock of its own.
    pub written: bool,
}

impl Guard {
    /// Of files of this origin.
    pub fn new(origin: Origin, force: bool) -> Self {
        Self { origin: Arc::new(origin), repeats: true, force }
    }

    /// The same, where no two files are the same although their origin is: measured times, what people edit.
    #[must_use]
    pub fn unrepeatable(self) -> Self {
        Self { repeats: false, ..self }
    }

    /// What makes the files.
    pub fn origin(&self) -> &Origin {
        &self.origin
    }

    /// Whether a file may be put here.
    ///
    /// # Errors
    /// If a file is there that is not of the same run.
    pub(crate) fn check(&self, path: &Path) -> Result<(), Error> {
        if self.force || is_stdout(path) || !path.is_file() {
            return Ok(());
        }
        let made = match self.repeats {
            true => self.other(path).map_err(|source| Error::Read { path: path.to_owned(), source })?,
            false => Some("would be lost".to_owned()),
        };
        made.map_or(Ok(()), |made| Err(Error::Taken { path: path.to_owned(), made }))
    }

    /// What a file is, if it is of another origin.
    fn other(&self, path: &Path) -> std::io::Result<Option<String>> {
        let found = provenance::read(path)?;
        Ok(match found.map(|found| (self.origin.differences(&found), found)) {
            None => Some("was not made by this program".to_owned()),
            Some((differences, _)) if differences.is_empty() => None,
            Some((differences, found)) => Some(match found.command() {
                Some(command) if command != self.origin.command().unwrap_or_default() => {
                    format!("was made by `{command}`")
                }
                _ => format!("is of a run with another {}", differences.join(", ")),
            }),
        })
    }

    /// Whether the file of the same run is here, complete.
    pub(crate) fn is_complete(&self, path: &Path) -> bool {
        let found = provenance::read(path).ok().flatten();
        found.is_some_and(|found| found.interrupted().is_none() && self.origin.differences(&found).is_empty())
    }

    /// Looks at all files of a run before it starts: no two are one, none takes the place of another run's or of a stranger's, all can be
    /// written. The answer is what was left behind beside them by processes that were killed.
    ///
    /// # Errors
    /// If any of that is not so.
    pub fn check_all(&self, claims: &[Claim]) -> Result<Vec<PathBuf>, Error> {
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
    pub fn write(&self, path: &Path, content: &[u8]) -> Result<(), Error> {
        let write = || {
            let mut file = AtomicFile::begin(path, Replace::Guarded(self.clone()))?;
            std::io::Write::write_all(&mut file, content)?;
            file.finish()
        };
        write().map_err(|source| Error::Write { path: path.to_owned(), source })
    }
}
