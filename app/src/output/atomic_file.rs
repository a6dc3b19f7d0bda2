//! Atomic writes: a file appears under its name only when it is complete.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use super::path::is_stdout;

/// Written beside its final place under a temporary name, and renamed when complete. Dropped before that, it leaves
/// nothing; a file that was there before stays as it was.
///
/// The standard output, which is called `-`, is written to as it is.
#[derive(Debug)]
pub struct AtomicFile(Target);

#[derive(Debug)]
enum Target {
    File { path: PathBuf, temporary: PathBuf, file: BufWriter<File>, complete: bool },
    Stdout(BufWriter<io::Stdout>),
}

impl AtomicFile {
    /// Begins a file.
    ///
    /// # Errors
    /// If the directory cannot be written, or `path` names no file.
    pub fn create(path: &Path) -> io::Result<Self> {
        if is_stdout(path) {
            return Ok(Self(Target::Stdout(BufWriter::new(io::stdout()))));
        }
        let name = path.file_name().filter(|_| !path.is_dir()).ok_or(io::ErrorKind::IsADirectory)?;
        let temporary =
            path.with_file_name(format!(".{}.{}.tmp", name.to_string_lossy(), std::process::id()));
        let file = BufWriter::new(File::create(&temporary)?);
        Ok(Self(Target::File { path: path.to_owned(), temporary, file, complete: false }))
    }

    fn target(&mut self) -> &mut dyn Write {
        match &mut self.0 {
            Target::File { file, .. } => file,
            Target::Stdout(stdout) => stdout,
        }
    }

    /// Puts the file in its place.
    ///
    /// # Errors
    /// If what was buffered cannot be written, or the file not renamed.
    pub fn finish(mut self) -> io::Result<()> {
        self.target().flush()?;
        if let Target::File { path, temporary, file, complete } = &mut self.0 {
            // the rename must not become durable before the contents
            file.get_ref().sync_all()?;
            fs::rename(temporary, path)?;
            *complete = true;
        }
        Ok(())
    }
}

impl Write for AtomicFile {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        self.target().write(buffer)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.target().flush()
    }
}

impl Drop for AtomicFile {
    fn drop(&mut self) {
        if let Target::File { temporary, complete: false, .. } = &self.0 {
            // an error cannot be reported here
            let _ = fs::remove_file(temporary);
        }
    }
}
