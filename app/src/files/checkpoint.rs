//! Checkpoints: all that is needed to resume a run, bit for bit.
//!
//! Two files: the checkpoint itself, with the plan of the run, its current state, and what it has recorded so far; and
//! beside it the rows of the trajectory as CSV, which go into the trajectory's file when the run ends or is
//! interrupted. The checkpoint says how many bytes of the rows belong to it, and their checksum. Whoever runs has a
//! lock on the rows.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, BufRead, BufReader, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::NewFile;
use super::path::{followed, read_file};
use super::table::{table, write_row};
use crate::error::{Error, FileError, SetupError};

/// The beginning of checkpoint files; the number is the version of the format.
const MAGIC: &[u8] = b"coadjoint checkpoint 5\n";
/// The beginning of those of all versions.
const ANY: &[u8] = b"coadjoint checkpoint ";

/// No checkpoint is longer.
const MOST: u64 = 1 << 30;

/// The files of a run that can be resumed, held by this process alone.
#[derive(Debug)]
pub(crate) struct CheckpointStore {
    path: PathBuf,
    /// Locked.
    rows: BufWriter<File>,
    mark: Mark,
}

/// The end of the rows that belong to a checkpoint.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
struct Mark {
    bytes: u64,
    /// Their checksum.
    sum: u32,
}

impl Write for Mark {
    /// Adds rows.
    fn write(&mut self, rows: &[u8]) -> io::Result<usize> {
        let mut hasher = crc32fast::Hasher::new_with_initial(self.sum);
        hasher.update(rows);
        *self = Self { bytes: self.bytes + rows.len() as u64, sum: hasher.finalize() };
        Ok(rows.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl CheckpointStore {
    /// Begins the files of a run, with what is needed to start it, and the names of the rows' columns.
    ///
    /// # Errors
    /// If any of them is there, or cannot be written.
    pub(crate) fn begin(path: &Path, columns: Vec<String>, content: &impl Serialize) -> Result<Self, Error> {
        let path = &followed(path).map_err(FileError::write(path))?;
        let name = path.display();
        let taken = |reason: String| Err(SetupError::new(reason).into());
        if fs::symlink_metadata(path).is_ok() {
            return taken(match read_file(path, MOST).is_ok_and(|content| content.starts_with(ANY)) {
                true => format!("{name} exists already: `resume {name}` resumes it"),
                false => format!("{name} exists already, and is no checkpoint"),
            });
        }
        let place = rows_of(path);
        let created = OpenOptions::new().read(true).write(true).create_new(true).open(&place);
        let file = match created {
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
                let rows = place.display();
                return taken(format!(
                    "{rows} exists already, without its checkpoint: to start again, remove it first"
                ));
            }
            created => created.map_err(FileError::write(&place))?,
        };
        let begun = locked(path, &file).and_then(|()| {
            let mut store = Self { path: path.clone(), rows: BufWriter::new(file), mark: Mark::default() };
            store.write(&table(&[columns]))?;
            store.save_in(content, false)?;
            Ok(store)
        });
        begun.inspect_err(|_| {
            // without a checkpoint they are of no use
            let _ = fs::remove_file(&place);
        })
    }

    /// Opens the files of a run that was interrupted, and verifies them.
    ///
    /// # Errors
    /// If they are in use, cannot be read, are of another version of the program, or not what was written.
    pub(crate) fn open<T: for<'a> Deserialize<'a>>(path: &Path) -> Result<(Self, T), Error> {
        let path = &followed(path).map_err(FileError::read(path))?;
        let place = rows_of(path);
        let opened = OpenOptions::new().read(true).write(true).open(&place);
        if opened.is_err() {
            // of a file that is not there, or is no checkpoint, its rows are not missed
            load::<T>(path)?;
        }
        let mut file = opened.map_err(FileError::read(&place))?;
        locked(path, &file)?;
        let (mark, content) = load(path)?;
        let mut found = Mark::default();
        io::copy(&mut (&file).take(mark.bytes), &mut found).map_err(FileError::read(&place))?;
        if found != mark {
            let what = "is damaged, or of another run: the run cannot be resumed";
            return Err(FileError::damaged(&place, what).into());
        }
        // what comes later is that of steps which will be taken again
        let end = file.set_len(mark.bytes).and_then(|()| file.seek(SeekFrom::End(0)));
        end.map_err(FileError::write(&place))?;
        Ok((Self { path: path.clone(), rows: BufWriter::new(file), mark }, content))
    }

    fn write(&mut self, bytes: &[u8]) -> Result<(), FileError> {
        self.mark
            .write_all(bytes)
            .and_then(|()| self.rows.write_all(bytes))
            .map_err(FileError::write(&rows_of(&self.path)))
    }

    /// Adds a row.
    ///
    /// # Errors
    /// If it cannot be written.
    pub(crate) fn row(&mut self, row: &[f64]) -> Result<(), FileError> {
        let mut line = Vec::new();
        write_row(&mut line, row).map_err(FileError::write(&rows_of(&self.path)))?;
        self.write(&line)
    }

    /// Saves what the run is to be resumed with, together with all rows so far.
    ///
    /// # Errors
    /// If it cannot be written.
    pub(crate) fn save(&mut self, content: &impl Serialize) -> Result<(), FileError> {
        self.save_in(content, true)
    }

    fn save_in(&mut self, content: &impl Serialize, may_replace: bool) -> Result<(), FileError> {
        let synced = self.rows.flush().and_then(|()| self.rows.get_ref().sync_data());
        synced.map_err(FileError::write(&rows_of(&self.path)))?;
        let payload = postcard::to_stdvec(&(self.mark, content)).map_err(io::Error::other);
        let payload = payload.map_err(FileError::write(&self.path))?;
        let sum = crc32fast::hash(&payload).to_le_bytes();
        NewFile::with(&self.path, &[MAGIC, &sum, &payload].concat())?.finish(may_replace)
    }

    /// Passes all rows to `show`, from the first on.
    ///
    /// # Errors
    /// If they cannot be read, or `show` fails.
    pub(crate) fn replay(&mut self, mut show: impl FnMut(&[f64]) -> Result<(), Error>) -> Result<(), Error> {
        let place = rows_of(&self.path);
        self.rows.flush().map_err(FileError::write(&place))?;
        let mut file = self.rows.get_ref();
        file.seek(SeekFrom::Start(0)).map_err(FileError::read(&place))?;
        let mut numbers = Vec::new();
        for line in BufReader::new(file).lines().skip(1) {
            numbers.clear();
            for number in line.map_err(FileError::read(&place))?.split(',') {
                let wrong = |_| FileError::damaged(&place, "is damaged: the run cannot be resumed");
                numbers.push(number.parse::<f64>().map_err(wrong)?);
            }
            show(&numbers)?;
        }
        file.seek(SeekFrom::End(0)).map_err(FileError::read(&place))?;
        Ok(())
    }

    /// Removes all files: the run is complete, and its output written.
    pub(crate) fn remove(self) {
        // the checkpoint first: rows alone are never taken for a run; what remains is harmless
        // a checkpoint that stays needs its rows
        if fs::remove_file(&self.path).is_ok() {
            let _ = fs::remove_file(rows_of(&self.path));
        }
    }
}

/// Names the file of a checkpoint's rows.
pub(crate) fn rows_of(checkpoint: &Path) -> PathBuf {
    let mut name = checkpoint.as_os_str().to_owned();
    name.push(".rows");
    name.into()
}

/// Locks the rows of a checkpoint, as long as they are open.
fn locked(checkpoint: &Path, rows: &File) -> Result<(), Error> {
    match rows.try_lock() {
        Err(TryLockError::WouldBlock) => Err(FileError::InUse(checkpoint.to_owned()).into()),
        // where there are no locks, people see to it
        Err(TryLockError::Error(error)) if error.kind() != io::ErrorKind::Unsupported => {
            Err(FileError::write(&rows_of(checkpoint))(error).into())
        }
        _ => Ok(()),
    }
}

fn load<T: for<'a> Deserialize<'a>>(path: &Path) -> Result<(Mark, T), FileError> {
    let content = read_file(path, MOST).map_err(FileError::read(path))?;
    let rest = content
        .strip_prefix(MAGIC)
        .ok_or_else(|| FileError::damaged(path, "is not a checkpoint of this version of coadjoint"))?;
    let damaged = || FileError::damaged(path, "is a damaged checkpoint");
    let (sum, payload) = rest.split_first_chunk::<4>().ok_or_else(damaged)?;
    if u32::from_le_bytes(*sum) != crc32fast::hash(payload) {
        return Err(damaged());
    }
    postcard::from_bytes(payload).map_err(|_| damaged())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The files of a run that was interrupted after three rows of two numbers, which are removed.
    fn interrupted(test: &str, third: f64) -> (PathBuf, Vec<u8>, Vec<u8>) {
        let path = std::env::temp_dir().join(format!("coadjoint-{test}-{}.ck", std::process::id()));
        let mut store =
            CheckpointStore::begin(&path, vec!["a".to_owned(), "b".to_owned()], &7_u32).expect("writable");
        for row in [[1.0, -2.5e-300], [3.0, f64::NAN], [5.0, third]] {
            store.row(&row).expect("writable");
            store.save(&8_u32).expect("writable");
        }
        let (checkpoint, rows) = (fs::read(&path).expect("there"), fs::read(rows_of(&path)).expect("there"));
        store.remove();
        (path, checkpoint, rows)
    }

    /// Resumes a run with these files: its content and its rows.
    fn resumed(path: &Path, checkpoint: &[u8], rows: &[u8]) -> Result<(u32, Vec<f64>), String> {
        fs::write(path, checkpoint).expect("writable");
        fs::write(rows_of(path), rows).expect("writable");
        let mut numbers = Vec::new();
        let read = CheckpointStore::open(path).and_then(|(mut store, content)| {
            store.replay(|row| {
                numbers.extend_from_slice(row);
                Ok(())
            })?;
            Ok(content)
        });
        let _ = fs::remove_file(path);
        let _ = fs::remove_file(rows_of(path));
        read.map(|content| (content, numbers)).map_err(|error| error.to_string())
    }

    #[test]
    fn every_flipped_bit_and_every_cut_is_found() {
        let (path, checkpoint, rows) = interrupted("bits", 6.0);
        let (content, numbers) = resumed(&path, &checkpoint, &rows).expect("what was written");
        assert_eq!((content, &numbers[..3], numbers[5]), (8, &[1.0, -2.5e-300, 3.0][..], 6.0));
        assert!(numbers[3].is_nan());
        for (file, other) in [(&checkpoint, &rows), (&rows, &checkpoint)] {
            let is_checkpoint = file == &checkpoint;
            let resumed = |file: &[u8]| match is_checkpoint {
                true => resumed(&path, file, other),
                false => resumed(&path, other, file),
            };
            for bit in 0..8 * file.len() {
                let mut flipped = file.clone();
                flipped[bit / 8] ^= 1 << (bit % 8);
                assert!(resumed(&flipped).is_err(), "bit {bit} of {is_checkpoint}");
            }
            for length in 0..file.len() {
                assert!(resumed(&file[..length]).is_err(), "cut to {length} bytes");
            }
        }
        // what comes after the mark is that of steps which will be taken again
        let longer = [&rows[..], b"7.0,8."].concat();
        assert_eq!(resumed(&path, &checkpoint, &longer).map(|(_, numbers)| numbers.len()), Ok(6));
    }

    #[test]
    fn rows_of_another_run_do_not_count() {
        let (path, checkpoint, rows) = interrupted("other", 6.0);
        let (_, other_checkpoint, other_rows) = interrupted("another", 6.5);
        assert!(resumed(&path, &checkpoint, &other_rows).is_err());
        assert!(resumed(&path, &other_checkpoint, &rows).is_err());
        let message = resumed(&path, b"system = \"heavy_top\"", &rows).expect_err("no checkpoint");
        assert!(message.contains("is not a checkpoint"), "{message}");
    }

    #[test]
    fn nothing_of_others_is_taken_for_a_checkpoint() {
        let path = std::env::temp_dir().join(format!("coadjoint-begun-{}.ck", std::process::id()));
        let begin = || CheckpointStore::begin(&path, Vec::new(), &0_u32).map_err(|error| error.to_string());
        fs::write(rows_of(&path), "of others").expect("writable");
        assert!(begin().expect_err("rows are there").contains("without its checkpoint"));
        assert_eq!(fs::read(rows_of(&path)).expect("there"), b"of others");
        fs::remove_file(rows_of(&path)).expect("there");
        let store = begin().expect("free");
        assert!(begin().expect_err("it is there").contains("resumes it"));
        let opened = CheckpointStore::open::<u32>(&path).map(|_| ()).map_err(|error| error.to_string());
        assert!(opened.expect_err("held").contains("is in use by another run"));
        store.remove();
        assert!(!path.exists() && !rows_of(&path).exists());
    }
}
