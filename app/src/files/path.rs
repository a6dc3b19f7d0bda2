//! Paths as the file system takes them.

use std::fs;
use std::io::{self, Read as _};
use std::path::{Component, Path, PathBuf};

/// Links followed before they count as a circle.
const LINKS: usize = 40;

/// Tells whether a path means the standard output.
pub(crate) fn is_stdout(path: &Path) -> bool {
    path == Path::new("-")
}

/// Follows symbolic links at the end of a path, to what is there or not.
///
/// # Errors
/// If they lead round in a circle.
pub(crate) fn followed(path: &Path) -> io::Result<PathBuf> {
    let mut path = path.to_owned();
    // what the system shows as a link to a pipe leads nowhere as a path
    if is_special(&path) {
        return Ok(path);
    }
    for _ in 0..LINKS {
        let Ok(to) = fs::read_link(&path) else { return Ok(path) };
        path = path.parent().unwrap_or(Path::new("")).join(to);
    }
    Err(io::Error::other("too many symbolic links"))
}

/// Tells whether something is there that is neither a file nor a directory: a device or a pipe.
pub(crate) fn is_special(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|at| !at.is_file() && !at.is_dir())
}

/// Reads a file of at most this length: what is given for one by mistake may have no end, or never begin.
///
/// # Errors
/// If it is longer, no file, or cannot be read.
pub(crate) fn read_file(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    if is_special(path) {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "it is a device or a pipe, not a file"));
    }
    let mut content = Vec::new();
    fs::File::open(path)?.take(most + 1).read_to_end(&mut content)?;
    if content.len() as u64 > most {
        return Err(io::Error::new(io::ErrorKind::FileTooLarge, format!("it is longer than {most} bytes")));
    }
    Ok(content)
}

/// Finds the one path of a file, there or not, however it is named: absolute, without links and `..`.
pub(crate) fn resolved(path: &Path) -> PathBuf {
    let path = followed(path).unwrap_or_else(|_| path.to_owned());
    let absolute = std::path::absolute(&path).unwrap_or(path);
    let there = absolute.ancestors().find_map(|above| {
        let real = above.canonicalize().ok()?;
        Some((real, absolute.strip_prefix(above).ok()?))
    });
    let Some((mut real, missing)) = there else { return absolute };
    for component in missing.components() {
        match component {
            Component::ParentDir => {
                real.pop();
            }
            Component::CurDir => {}
            component => real.push(component),
        }
    }
    real
}
