//! Nothing of others is replaced unasked: all files of a run are looked at before it starts.

use std::io;
use std::path::{MAIN_SEPARATOR, Path, PathBuf};

use serde_json::{Value, json};

use super::path::{is_special, is_stdout, resolved};
use super::run_json::{Beside, FileOrigin, RunJson, Status};
use super::write::{NewFile, make_directory_of};
use crate::error::FileError;

/// Lets files replace those of the same origin, and others where that was asked for.
#[derive(Clone, Debug)]
pub struct OverwriteGuard {
    origin: FileOrigin,
    force: bool,
    error_estimate: Option<String>,
    ended: Option<Value>,
}

/// A file of a command, and what it is to it.
#[derive(Clone, Debug)]
pub struct PlannedFile {
    /// `the page`, `the trajectory`
    pub what: &'static str,
    /// Its place.
    pub path: PathBuf,
    /// Whether it is written under the guard; else it is read, or is new.
    pub written: bool,
}

/// The files that were put in their places, and those that stay as they are.
#[derive(Debug, Default)]
pub(crate) struct Written {
    pub(crate) files: Vec<PathBuf>,
    /// Complete ones, whose places those of an interrupted run do not take.
    pub(crate) kept: Vec<PathBuf>,
}

impl OverwriteGuard {
    /// Guards files of this origin.
    pub fn new(origin: FileOrigin, force: bool) -> Self {
        Self { origin, force, error_estimate: None, ended: None }
    }

    /// Says in words beside the files how large the error of the trajectory is.
    pub(crate) fn with_error_estimate(self, words: Option<String>) -> Self {
        Self { error_estimate: words, ..self }
    }

    /// Says beside the files after how many steps, and when, a condition ended the run.
    pub(crate) fn with_end(self, end: Option<(u64, f64)>) -> Self {
        Self { ended: end.map(|(steps, time)| json!({ "steps": steps, "time": time })), ..self }
    }

    /// Tells what makes the files.
    pub(crate) fn origin(&self) -> &FileOrigin {
        &self.origin
    }

    /// Checks that a file may be put here.
    fn check(&self, path: &Path) -> Result<(), FileError> {
        if self.force || is_stdout(path) || is_special(path) {
            return Ok(());
        }
        let taken = |path: &Path, made: String| Err(FileError::Taken(path.to_owned(), made));
        let stranger = || "was not made by this program".to_owned();
        let (beside, found) = RunJson::beside(path)?;
        match found {
            Beside::Nothing if path.is_file() => taken(path, stranger()),
            Beside::Nothing => Ok(()),
            Beside::Foreign => taken(&beside, stranger()),
            Beside::Ours(found) if found.origin == self.origin => match path.is_file() && !found.has(path) {
                true => taken(path, stranger()),
                false => Ok(()),
            },
            Beside::Ours(found) if found.is_of_files_beside(&beside) => {
                let place = if path.is_file() { path } else { &beside };
                taken(place, self.origin.difference(&found.origin))
            }
            Beside::Ours(_) => Ok(()),
        }
    }

    /// Looks at all files of a run before it starts: no two are one, none takes the place of another run's or of a
    /// stranger's, all can be written.
    ///
    /// # Errors
    /// If any of that is not so.
    pub fn check_all(&self, files: &[PlannedFile]) -> Result<(), FileError> {
        let is_directory = |file: &&PlannedFile| file.path.to_string_lossy().ends_with(['/', MAIN_SEPARATOR]);
        if let Some(PlannedFile { path, .. }) = files.iter().find(is_directory) {
            return Err(FileError::write(path)(io::ErrorKind::IsADirectory.into()));
        }
        let places: Vec<PathBuf> = files.iter().map(|file| resolved(&file.path)).collect();
        for (i, file) in files.iter().enumerate() {
            // into a device as much goes as one likes
            let other = (0..i).find(|&j| places[i] == places[j] && !is_special(&places[i]));
            if let Some(other) = other {
                return Err(FileError::Shared(file.path.clone(), [files[other].what, file.what]));
            }
        }
        let written = || files.iter().filter(|file| file.written).map(|file| &file.path);
        let beside: Vec<PathBuf> = written().map(|path| resolved(path).with_extension("run.json")).collect();
        if let Some((file, _)) = files.iter().zip(&places).find(|(_, place)| beside.contains(place)) {
            return Err(FileError::Shared(file.path.clone(), [file.what, "what says how it was made"]));
        }
        written().try_for_each(|path| self.check(path))?;
        for path in written().filter(|path| !is_stdout(path) && !is_special(path)) {
            make_directory_of(&super::path::followed(path).map_err(FileError::write(path))?)?;
            // dropped at once: it can be written
            NewFile::begin(path)?;
        }
        Ok(())
    }

    /// Writes files with these contents, and what made them beside them.
    ///
    /// # Errors
    /// If one cannot be written, or another file came in its place.
    pub fn write_all(&self, contents: &[(PathBuf, Vec<u8>)]) -> Result<(), FileError> {
        let begun = |(path, content): &(PathBuf, Vec<u8>)| Ok((path.clone(), NewFile::with(path, content)?));
        let files = contents.iter().map(begun).collect::<Result<Vec<_>, FileError>>()?;
        self.put(files, Status::Complete).map(|_| ())
    }

    /// Puts complete files in their places, and what made them beside them.
    ///
    /// # Errors
    /// If one cannot be put there, or another file came in its place.
    pub(crate) fn put(&self, files: Vec<(PathBuf, NewFile)>, status: Status) -> Result<Written, FileError> {
        let mut written = Written::default();
        let mut kept = Vec::new();
        for (path, file) in files {
            match status != Status::Complete && self.is_complete(&path)? {
                true => written.kept.push(path),
                false => kept.push((path, file)),
            }
        }
        let is_free = |path: &Path| !path.exists() || self.check(path).is_ok();
        // what is killed here leaves no file whose origin is not known, and none that is said to be more than it is
        self.note(kept.iter().map(|(path, _)| path.as_path()).filter(|path| is_free(path)), Status::Begun)?;
        let mut places = Vec::new();
        for (path, file) in kept {
            file.finish(path.exists() && is_free(&path))?;
            places.push(path);
        }
        self.note(places.iter().map(PathBuf::as_path), status)?;
        written.files = places.into_iter().filter(|path| !is_stdout(path)).collect();
        Ok(written)
    }

    /// Tells whether the file of the same run is here, complete.
    fn is_complete(&self, path: &Path) -> Result<bool, FileError> {
        let (_, found) = RunJson::beside(path)?;
        let is_whole = |found: &RunJson| found.origin == self.origin && found.is_complete(path);
        Ok(path.is_file() && matches!(found, Beside::Ours(found) if is_whole(&found)))
    }

    /// Notes the status of files beside them. What is there and begun again is as it was.
    fn note<'p>(&self, paths: impl Iterator<Item = &'p Path>, status: Status) -> Result<(), FileError> {
        for path in paths.filter(|path| !is_stdout(path) && !is_special(path)) {
            let (beside, found) = RunJson::beside(path)?;
            let mut json = match found {
                Beside::Ours(found) if found.origin == self.origin => found,
                _ => RunJson::of(self.origin.clone()),
            };
            if status == Status::Complete {
                json.error_estimate.clone_from(&self.error_estimate);
                json.ended.clone_from(&self.ended);
            }
            if status != Status::Begun || !json.has(path) || !path.exists() {
                json.set(path, status);
                NewFile::with(&beside, json.text().as_bytes())?.finish(true)?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What came into a file's place while it was made stays, and is not said to be of the run.
    #[test]
    fn what_came_meanwhile_stays() {
        let directory = tempfile::tempdir().expect("writable");
        let path = directory.path().join("a.csv");
        let guard = OverwriteGuard::new(FileOrigin::of_command("test"), false);
        let planned = PlannedFile { what: "the table", path: path.clone(), written: true };
        guard.check_all(std::slice::from_ref(&planned)).expect("nothing is there");
        let file = NewFile::with(&path, b"ours").expect("writable");
        std::fs::write(&path, "mine").expect("writable");
        let refused =
            guard.put(vec![(path.clone(), file)], Status::Complete).expect_err("another file is there");
        let message = refused.to_string();
        assert!(message.contains("what was to be written is in "), "{message}");
        assert_eq!(std::fs::read(&path).expect("there"), b"mine");
        assert!(guard.check(&path).is_err());
        let kept = message.rsplit_once(" is in ").map(|(_, kept)| kept.to_owned()).expect("a path");
        assert_eq!(std::fs::read(kept).expect("kept"), b"ours");

        std::fs::remove_file(&path).expect("there");
        for status in [Status::Interrupted(3), Status::Complete] {
            let file = NewFile::with(&path, b"ours").expect("writable");
            guard.put(vec![(path.clone(), file)], status).expect("its own place");
        }
        assert_eq!(std::fs::read(&path).expect("there"), b"ours");
        // the beginning of a run does not take the place of all of it
        let file = NewFile::with(&path, b"our").expect("writable");
        let written = guard.put(vec![(path.clone(), file)], Status::Interrupted(3)).expect("it stays");
        assert_eq!((written.files.len(), written.kept), (0, vec![path.clone()]));
        // nor is a file that is gone said to be whole while another one is put there
        std::fs::remove_file(&path).expect("there");
        guard.note(std::iter::once(path.as_path()), Status::Begun).expect("writable");
        let Beside::Ours(found) = RunJson::beside(&path).expect("readable").1 else { panic!("it is there") };
        assert!(found.has(&path) && !found.is_complete(&path));
    }
}
