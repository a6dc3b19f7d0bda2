//! A file that appears under its name only when it is complete.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// Written beside its final place under a passing name, and renamed when complete. Dropped before that, it leaves
/// nothing; a file that was there before stays as it was.
#[derive(Debug)]
pub(crate) struct WholeFile {
    path: PathBuf,
    passing: PathBuf,
    file: BufWriter<File>,
    complete: bool,
}

impl WholeFile {
    /// Begins a file.
    ///
    /// # Errors
    /// If the directory cannot be written, or `path` names no file.
    pub(crate) fn create(path: &Path) -> io::Result<Self> {
        let name = path.file_name().filter(|_| !path.is_dir()).ok_or(io::ErrorKind::IsADirectory)?;
        let passing = path.with_file_name(format!(".{}.{}.tmp", name.to_string_lossy(), std::process::id()));
        let file = BufWriter::new(File::create(&passing)?);
        Ok(Self { path: path.to_owned(), passing, file, complete: false })
    }

    /// Puts the file in its place.
    ///
    /// # Errors
    /// If what was buffered cannot be written, or the file not renamed.
    pub(crate) fn finish(mut self) -> io::Result<()> {
        self.file.flush()?;
        // the rename must not become durable before the contents
        self.file.get_ref().sync_all()?;
        fs::rename(&self.passing, &self.path)?;
        self.complete = true;
        Ok(())
    }
}

impl Write for WholeFile {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        self.file.write(buffer)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Drop for WholeFile {
    fn drop(&mut self) {
        if !self.complete {
            // there is nobody left to tell
            let _ = fs::remove_file(&self.passing);
        }
    }
}
