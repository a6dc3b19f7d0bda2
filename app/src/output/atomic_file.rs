//! Atomic writes: a file appears under its name only when it is complete.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// Written beside its final place under a temporary name, and renamed when complete. Dropped before that, it leaves
/// nothing; a file that was there before stays as it was.
#[derive(Debug)]
pub struct AtomicFile {
    path: PathBuf,
    temporary: PathBuf,
    file: BufWriter<File>,
    complete: bool,
}

impl AtomicFile {
    /// Begins a file.
    ///
    /// # Errors
    /// If the directory cannot be written, or `path` names no file.
    pub fn create(path: &Path) -> io::Result<Self> {
        let name = path.file_name().filter(|_| !path.is_dir()).ok_or(io::ErrorKind::IsADirectory)?;
        let temporary =
            path.with_file_name(format!(".{}.{}.tmp", name.to_string_lossy(), std::process::id()));
        let file = BufWriter::new(File::create(&temporary)?);
        Ok(Self { path: path.to_owned(), temporary, file, complete: false })
    }

    /// Puts the file in its place.
    ///
    /// # Errors
    /// If what was buffered cannot be written, or the file not renamed.
    pub fn finish(mut self) -> io::Result<()> {
        self.file.flush()?;
        // the rename must not become durable before the contents
        self.file.get_ref().sync_all()?;
        fs::rename(&self.temporary, &self.path)?;
        self.complete = true;
        Ok(())
    }
}

impl Write for AtomicFile {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        self.file.write(buffer)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Drop for AtomicFile {
    fn drop(&mut self) {
        if !self.complete {
            // an error cannot be reported here
            let _ = fs::remove_file(&self.temporary);
        }
    }
}
