//! Files that appear under their names when they are complete.

use std::fs::{File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use tempfile::NamedTempFile;

use super::path::{followed, is_special, is_stdout};
use crate::error::FileError;
use crate::page::Page;
use crate::picture::{Figure, Kind};

/// The ending of files that are being written.
pub(super) const TEMPORARY: &str = ".coadjoint-tmp";

/// Those that were begun: a program that is made to end at once removes them, since it drops nothing.
static BEGUN: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// A file that is written beside its place, and put there when it is complete; dropped before, it leaves nothing.
///
/// Through a symbolic link the file it leads to is written. Devices and pipes, and the standard output, `-`, are
/// written to as they are.
#[derive(Debug)]
pub(crate) struct NewFile {
    path: PathBuf,
    sink: BufWriter<Sink>,
}

#[derive(Debug)]
enum Sink {
    Temporary(NamedTempFile),
    Special(File),
    Stdout(io::Stdout),
}

impl NewFile {
    /// Begins a file.
    ///
    /// # Errors
    /// If the directory cannot be written, or `path` names no file.
    pub(crate) fn begin(path: &Path) -> Result<Self, FileError> {
        let begin = || {
            if is_stdout(path) {
                return Ok((path.to_owned(), Sink::Stdout(io::stdout())));
            }
            let place = followed(path)?;
            if is_special(&place) {
                let file = OpenOptions::new().write(true).open(&place)?;
                return Ok((place, Sink::Special(file)));
            }
            let name = place.file_name().filter(|_| !place.is_dir()).ok_or(io::ErrorKind::IsADirectory)?;
            let directory = place.parent().filter(|directory| !directory.as_os_str().is_empty());
            let directory = directory.unwrap_or(Path::new("."));
            // said before the name of the temporary file would be
            if !directory.is_dir() {
                let message = format!("there is no directory {}", directory.display());
                return Err(io::Error::new(io::ErrorKind::NotFound, message));
            }
            let prefix = format!(".{}.", name.to_string_lossy());
            let mut builder = tempfile::Builder::new();
            builder.prefix(&prefix).suffix(TEMPORARY);
            #[cfg(unix)]
            builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
            let file = builder.tempfile_in(directory)?;
            BEGUN.lock().unwrap_or_else(PoisonError::into_inner).push(file.path().to_owned());
            Ok((place, Sink::Temporary(file)))
        };
        let (path, sink) = begin().map_err(FileError::write(path))?;
        Ok(Self { path, sink: BufWriter::new(sink) })
    }

    /// Writes a whole file, which is not in its place yet.
    ///
    /// # Errors
    /// If it cannot be written.
    pub(crate) fn with(path: &Path, content: &[u8]) -> Result<Self, FileError> {
        let mut file = Self::begin(path)?;
        let written = file.write_all(content).and_then(|()| file.flush());
        written.map(|()| file).map_err(FileError::write(path))
    }

    /// Puts the file in its place. What came there meanwhile and may not be replaced stays; this file then keeps its
    /// temporary name.
    ///
    /// # Errors
    /// If what was buffered cannot be written, or the file not renamed.
    pub(crate) fn finish(self, may_replace: bool) -> Result<(), FileError> {
        let Self { path, sink } = self;
        let finish = || {
            let Sink::Temporary(file) = sink.into_inner().map_err(io::IntoInnerError::into_error)? else {
                return Ok(());
            };
            // the rename must not become durable before the contents
            file.as_file().sync_all()?;
            let put = if may_replace { file.persist(&path) } else { file.persist_noclobber(&path) };
            let Err(refused) = put else { return Ok(()) };
            if refused.error.kind() != io::ErrorKind::AlreadyExists {
                return Err(refused.error);
            }
            let (_, kept) = refused.file.keep()?;
            let message = format!("{}; what was to be written is in {}", refused.error, kept.display());
            Err(io::Error::new(io::ErrorKind::AlreadyExists, message))
        };
        finish().map_err(FileError::write(&path))
    }
}

impl Write for NewFile {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        self.sink.write(buffer)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.sink.flush()
    }
}

impl Sink {
    fn writer(&mut self) -> &mut dyn Write {
        match self {
            Sink::Temporary(file) => file,
            Sink::Special(file) => file,
            Sink::Stdout(stdout) => stdout,
        }
    }
}

impl Write for Sink {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        self.writer().write(buffer)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.writer().flush()
    }
}

/// Removes all files that are not in their places: the program is about to end.
pub(crate) fn remove_unfinished() {
    for path in BEGUN.lock().unwrap_or_else(PoisonError::into_inner).drain(..) {
        let _ = std::fs::remove_file(path);
    }
}

/// Checks that a new file would replace nothing, unless it may.
///
/// # Errors
/// If a file is there.
pub fn check_new(path: &Path, force: bool) -> Result<(), FileError> {
    if force || is_stdout(path) || !path.is_file() {
        return Ok(());
    }
    Err(FileError::Taken(path.to_owned(), "would be lost".to_owned()))
}

/// Writes a file, whole or not at all, that replaces nothing unless it may.
///
/// # Errors
/// If it cannot be written, or a file is there.
pub fn write_new(path: &Path, content: &[u8], force: bool) -> Result<(), FileError> {
    check_new(path, force)?;
    NewFile::with(path, content)?.finish(force)
}

/// Makes the directory of a file and those above it, where they are missing.
///
/// # Errors
/// If that cannot be done.
pub(crate) fn make_directory_of(path: &Path) -> Result<(), FileError> {
    match path.parent().filter(|directory| !directory.as_os_str().is_empty()) {
        Some(file) if file.exists() && !file.is_dir() => {
            Err(io::ErrorKind::NotADirectory.into()).map_err(FileError::write(file))
        }
        Some(directory) => std::fs::create_dir_all(directory).map_err(FileError::write(directory)),
        None => Ok(()),
    }
}

impl Page {
    /// Writes the page as HTML, and the directory that it is in. A file that is there is replaced.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), FileError> {
        make_directory_of(path)?;
        NewFile::with(path, self.to_html().as_bytes())?.finish(true)
    }
}

impl Figure {
    /// Writes `<stem>.svg` and, with the feature `png`, `<stem>.png`, and tells where.
    ///
    /// # Errors
    /// If the picture cannot be written.
    pub fn write(&self, stem: &Path) -> Result<Vec<PathBuf>, FileError> {
        let write = |kind: &Kind| {
            // what stands behind a point in the stem is no extension: `figure-1.1`
            let mut name = stem.as_os_str().to_owned();
            name.push(format!(".{}", kind.extension()));
            let path = PathBuf::from(name);
            NewFile::with(&path, &self.picture(*kind))?.finish(true)?;
            Ok(path)
        };
        Kind::ALL.iter().map(write).collect()
    }
}
