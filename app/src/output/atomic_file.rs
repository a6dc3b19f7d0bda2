//! Atomic writes: a file appears under its name only when it is complete.

use std::fs::{self, File, OpenOptions};
use std::hash::{BuildHasher, RandomState};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use super::guard::Guard;
use super::path::{followed, is_special, is_stdout, sync_directory};

/// What temporary files end with.
const TEMPORARY: &str = ".coadjoint-tmp";

/// Those that are being written, so that a program that is made to end at once can remove them.
static TEMPORARIES: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Written beside its final place under a temporary name, and renamed when complete. Dropped before that, it leaves
/// nothing; a file that was there before stays as it was.
///
/// Through a symbolic link the file it leads to is written. Devices and pipes, and the standard output, which is called `-`, are written to as they
/// are.
#[derive(Debug)]
pub struct AtomicFile {
    path: PathBuf,
    sink: BufWriter<Sink>,
    /// Where it is written until it is complete; none where it is written in its place.
    temporary: Option<PathBuf>,
    replace: Replace,
}

/// What may be replaced by a file.
#[derive(Clone, Debug)]
pub(crate) enum Replace {
    /// Whatever is there.
    Anything,
    /// Nothing.
    Nothing,
    /// What is allowed by the guard.
    Guarded(Guard),
}

#[derive(Debug)]
enum Sink {
    File(File),
    Stdout(io::Stdout),
}

impl AtomicFile {
    /// Begins a file that replaces what is there.
    ///
    /// # Errors
    /// If the directory cannot be written, or `path` names no file.
    pub fn create(path: &Path) -> io::Result<Self> {
        Self::begin(path, Replace::Anything)
    }

    /// Begins a file.
    ///
    /// # Errors
    /// As [`create`](Self::create).
    pub(crate) fn begin(path: &Path, replace: Replace) -> io::Result<Self> {
        if is_stdout(path) {
            return Ok(Self::in_place(path.to_owned(), Sink::Stdout(io::stdout())));
        }
        let path = followed(path)?;
        if is_special(&path) {
            let file = OpenOptions::new().write(true).open(&path)?;
            return Ok(Self::in_place(path, Sink::File(file)));
        }
        if path.is_dir() {
            return Err(io::ErrorKind::IsADirectory.into());
        }
        let (temporary, file) = loop {
            let temporary = path.with_file_name(temporary_name(&path, &format!("{:08x}", random() as u32))?);
            match File::create_new(&temporary) {
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
                file => break (temporary, file?),
            }
        };
        // shows others that it is being written; where there are no locks it is shown to be left behind, no more
        let _ = file.try_lock();
        TEMPORARIES.lock().unwrap_or_else(PoisonError::into_inner).push(temporary.clone());
        let sink = BufWriter::new(Sink::File(file));
        Ok(Self { path, sink, temporary: Some(temporary), replace })
    }

    fn in_place(path: PathBuf, sink: Sink) -> Self {
        Self { path, sink: BufWriter::new(sink), temporary: None, replace: Replace::Anything }
    }

    /// Puts the file in its place. What may not be replaced and came there meanwhile stays; the file is then kept under its temporary name.
    ///
    /// # Errors
    /// If what was buffered cannot be written, or the file not renamed.
    pub fn finish(mut self) -> io::Result<()> {
        self.sink.flush()?;
        let (Sink::File(file), Some(temporary)) = (self.sink.get_ref(), &self.temporary) else {
            return Ok(());
        };
        // the rename must not become durable before the contents
        file.sync_all()?;
        if let Err(refused) = self.put(temporary) {
            if refused.kind() == io::ErrorKind::AlreadyExists {
                forget(temporary);
                let kept = format!("{refused}; what was to be written is in {}", temporary.display());
                self.temporary = None;
                return Err(io::Error::new(refused.kind(), kept));
            }
            return Err(refused);
        }
        forget(temporary);
        self.temporary = None;
        sync_directory(&self.path)
    }

    /// Renames it, if its place is free or may be taken: a link takes no place that is taken, a rename does. So what comes there between the
    /// guard's look and the rename, both within microseconds, is lost.
    fn put(&self, temporary: &Path) -> io::Result<()> {
        if !matches!(self.replace, Replace::Anything) {
            match fs::hard_link(temporary, &self.path) {
                Ok(()) => {
                    // under its other name it is complete: what remains of this one is harmless
                    let _ = fs::remove_file(temporary);
                    return Ok(());
                }
                // there are file systems without links
                Err(_) if !self.path.exists() => {}
                Err(_) => match &self.replace {
                    Replace::Guarded(guard) => guard
                        .check(&self.path)
                        .map_err(|error| io::Error::new(io::ErrorKind::AlreadyExists, error.to_string()))?,
                    _ => return Err(io::ErrorKind::AlreadyExists.into()),
                },
            }
        }
        fs::rename(temporary, &self.path)
    }
}

impl Write for AtomicFile {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        self.sink.write(buffer)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.sink.flush()
    }
}

impl Write for Sink {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        match self {
            Sink::File(file) => file.write(buffer),
            Sink::Stdout(stdout) => stdout.write(buffer),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Sink::File(file) => file.flush(),
            Sink::Stdout(stdout) => stdout.flush(),
        }
    }
}

impl Drop for AtomicFile {
    fn drop(&mut self) {
        if let Some(temporary) = &self.temporary {
            // an error cannot be reported here
            let _ = fs::remove_file(temporary);
            forget(temporary);
        }
    }
}

/// `.NAME.RANDOM.coadjoint-tmp`
fn temporary_name(path: &Path, random: &str) -> io::Result<String> {
    let name = path.file_name().ok_or(io::ErrorKind::IsADirectory)?;
    Ok(format!(".{}.{random}{TEMPORARY}", name.to_string_lossy()))
}

fn forget(temporary: &Path) {
    TEMPORARIES.lock().unwrap_or_else(PoisonError::into_inner).retain(|path| path != temporary);
}

/// Removes all files that are being written: the program is about to end.
pub(crate) fn remove_temporaries() {
    for path in TEMPORARIES.lock().unwrap_or_else(PoisonError::into_inner).drain(..) {
        let _ = fs::remove_file(path);
    }
}

/// Temporary files that another process began for the same name, and that nobody writes any more: it was killed.
pub(crate) fn left_behind(path: &Path) -> Vec<PathBuf> {
    let ours = |path: &Path| Some((temporary_name(path, "").ok()?, path.parent()?.to_owned()));
    let Some((name, mut directory)) = followed(path).ok().as_deref().and_then(ours) else {
        return Vec::new();
    };
    if directory.as_os_str().is_empty() {
        directory.push(".");
    }
    let begins = name.strip_suffix(TEMPORARY).unwrap_or(&name);
    let is_left = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        name.starts_with(begins)
            && name.ends_with(TEMPORARY)
            && File::open(path).is_ok_and(|file| file.try_lock_shared().is_ok())
    };
    let entries = fs::read_dir(directory).into_iter().flatten().flatten();
    entries.map(|entry| entry.path()).filter(is_left).collect()
}

/// A random number: std takes the keys of its hash tables from the system, others in each process.
pub(crate) fn random() -> u64 {
    RandomState::new().hash_one(std::process::id())
}
