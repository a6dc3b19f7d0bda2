//! Shards: what is known of those members of an ensemble that have been run, as a file, and a directory of such files.
//!
//! A shard begins with two lines of text, the format and the manifest: what it is a part of. Behind them stand a
//! checksum, the blocks that are done, and their tally. It is replaced as a whole whenever it grows. Rows of members
//! stand in a directory beside the shards, a file a block.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, BufRead as _, BufReader, Read as _};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::json;

use super::NewFile;
use super::path::read_file;
use super::run_json::FileOrigin;
use super::table::rows_file;
use crate::error::{Error, FileError, SetupError};
use crate::setup::Format;
use crate::simulate::ensemble::{Block, Bytes, EnsembleSpec, Tally};

/// The beginning of shards; the number is the version of the format.
const MAGIC: &str = "coadjoint shard 1";
/// The ending of their names.
const SHARD: &str = "shard";
/// No shard is longer.
const MOST: u64 = 1 << 32;
/// What is said of other files.
const STRANGE: &str = "is no shard of an ensemble, or of another version of the program";
/// What is known of a directory of rows; a name that readers of such directories leave out.
const ABOUT: &str = "_manifest.json";
/// What is locked by whoever uses all shards of a directory, and shared by those that have one each.
const LOCK: &str = "all.lock";

/// What blocks are a part of.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Manifest {
    /// What makes the ensemble's files.
    pub(crate) origin: FileOrigin,
    /// Members of a block.
    pub(crate) block: u64,
    /// Which rows are written, if any.
    pub(crate) rows: Option<Rows>,
}

/// The rows of members that are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Rows {
    pub(crate) looks: RowLooks,
    pub(crate) format: Format,
}

/// At which looks rows are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "lowercase")]
pub(crate) enum RowLooks {
    /// A row for each member: at the end
    End,
    /// A row for each member whenever the members are looked at
    All,
}

/// Numbers of blocks, as ranges in ascending order that do not touch.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Done(Vec<(u64, u64)>);

/// Some of an ensemble's blocks that are done, and what is known of their members.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Shard {
    pub(crate) done: Done,
    pub(crate) tally: Tally,
    /// How long the steps took, s.
    pub(crate) seconds: f64,
    /// How many members were stepped side by side.
    pub(crate) width: usize,
}

#[derive(Serialize, Deserialize)]
struct Saved {
    done: Done,
    tally: Bytes,
    seconds: f64,
    width: usize,
}

impl Done {
    /// Adds a block.
    pub(crate) fn add(&mut self, block: u64) {
        // they come one after the other for the most part
        match self.0.last_mut() {
            Some((_, end)) if *end == block => *end += 1,
            _ => _ = self.merge(&Self(vec![(block, block + 1)])),
        }
    }

    /// Adds others; tells the first one that was there already.
    pub(crate) fn merge(&mut self, other: &Self) -> Option<u64> {
        self.0.extend(&other.0);
        self.0.sort_unstable();
        let mut twice = None;
        self.0.dedup_by(|(start, end), (_, before)| {
            if *start < *before && twice.is_none() {
                twice = Some(*start);
            }
            let touches = *start <= *before;
            *before = if touches { (*before).max(*end) } else { *before };
            touches
        });
        twice
    }

    /// Counts them.
    pub(crate) fn count(&self) -> u64 {
        self.0.iter().map(|(start, end)| end - start).sum()
    }

    pub(crate) fn has(&self, block: u64) -> bool {
        self.0.iter().any(|(start, end)| (*start..*end).contains(&block))
    }

    /// Those below a bound that are not done, in order.
    pub(crate) fn left(&self, count: u64) -> impl Iterator<Item = u64> + '_ {
        let starts = std::iter::once(0).chain(self.0.iter().map(|(_, end)| *end));
        let ends = self.0.iter().map(|(start, _)| *start).chain([count]);
        starts.zip(ends).flat_map(|(start, end)| start..end)
    }
}

impl Manifest {
    /// Reads what a shard is a part of, and nothing more of it.
    fn of(path: &Path) -> Result<Self, FileError> {
        let mut lines = BufReader::new(File::open(path).map_err(FileError::read(path))?.take(MOST)).lines();
        let mut line = || lines.next()?.ok();
        let found = line().filter(|line| line == MAGIC).and_then(|_| serde_json::from_str(&line()?).ok());
        found.ok_or_else(|| FileError::damaged(path, STRANGE))
    }
}

impl Shard {
    /// Reads a shard, and what it is a part of.
    ///
    /// # Errors
    /// If it cannot be read, or is not what was written.
    pub(crate) fn read(path: &Path) -> Result<(Manifest, Self), FileError> {
        let content = read_file(path, MOST).map_err(FileError::read(path))?;
        let damaged = |what: &str| FileError::damaged(path, what);
        let strange = || damaged(STRANGE);
        let rest = content.strip_prefix(MAGIC.as_bytes()).and_then(|rest| rest.strip_prefix(b"\n"));
        let rest = rest.ok_or_else(strange)?;
        let end = rest.iter().position(|byte| *byte == b'\n').ok_or_else(strange)?;
        let parse = || {
            let (sum, saved) = rest[end + 1..].split_first_chunk::<4>()?;
            let mut hasher = crc32fast::Hasher::new();
            hasher.update(&rest[..end]);
            hasher.update(saved);
            let is_whole = hasher.finalize() == u32::from_le_bytes(*sum);
            let manifest = serde_json::from_slice(&rest[..end]).ok().filter(|_| is_whole)?;
            Some((manifest, Self::from_bytes(saved)?))
        };
        parse().ok_or_else(|| damaged("is damaged: without it, its blocks have to be run again"))
    }

    /// Writes it, without what it is a part of.
    pub(crate) fn to_bytes(&self) -> Vec<u8> {
        let Self { done, tally, seconds, width } = self;
        let saved =
            Saved { done: done.clone(), tally: Bytes(tally.to_bytes()), seconds: *seconds, width: *width };
        // writing to memory does not fail
        postcard::to_stdvec(&saved).unwrap_or_default()
    }

    /// Reads what [`to_bytes`](Self::to_bytes) wrote; none if that is not what these bytes are.
    pub(crate) fn from_bytes(bytes: &[u8]) -> Option<Self> {
        let Saved { done, tally, seconds, width } = postcard::from_bytes(bytes).ok()?;
        Some(Self { done, tally: Tally::from_bytes(&tally.0)?, seconds, width })
    }

    fn content(&self, manifest: &Manifest) -> Vec<u8> {
        let (manifest, saved) = (json!(manifest).to_string(), self.to_bytes());
        let mut hasher = crc32fast::Hasher::new();
        hasher.update(manifest.as_bytes());
        hasher.update(&saved);
        [format!("{MAGIC}\n{manifest}\n").as_bytes(), &hasher.finalize().to_le_bytes(), &saved].concat()
    }

    /// Adds another one.
    ///
    /// # Errors
    /// If both have a block, or they are of other quantities: says so.
    pub(crate) fn merge(&mut self, other: &Self) -> Result<(), SetupError> {
        if !self.tally.is_alike(&other.tally) {
            return Err(SetupError::new("shards are of other quantities or looks than said"));
        }
        if let Some(block) = self.done.merge(&other.done) {
            return Err(SetupError::new(format!(
                "two shards both have block {block}: one of them is left over"
            )));
        }
        self.tally.merge(&other.tally);
        self.seconds += other.seconds;
        self.width = self.width.max(other.width);
        Ok(())
    }
}

/// A directory with shards of one ensemble.
#[derive(Debug)]
pub(crate) struct ShardStore {
    directory: PathBuf,
    manifest: Manifest,
    /// Held until it is dropped.
    locks: Vec<File>,
}

impl ShardStore {
    /// Opens the directory, and makes it where it is missing.
    ///
    /// # Errors
    /// If that cannot be done, or there are shards of another ensemble.
    pub(crate) fn open(directory: &Path, manifest: Manifest) -> Result<Self, Error> {
        fs::create_dir_all(directory).map_err(FileError::write(directory))?;
        let store = Self { directory: directory.to_owned(), manifest, locks: Vec::new() };
        if let Some(first) = store.shards()?.first() {
            store.check(first, &Manifest::of(first)?)?;
        }
        if let Some(rows) = store.manifest.rows {
            let rows = store.rows_directory(rows);
            fs::create_dir_all(&rows).map_err(FileError::write(&rows))?;
        }
        Ok(store)
    }

    /// Checks that a shard is of this ensemble.
    fn check(&self, path: &Path, found: &Manifest) -> Result<(), Error> {
        if *found == self.manifest {
            return Ok(());
        }
        let how = match found.origin == self.manifest.origin {
            true => "is of blocks of another size, or with other rows".to_owned(),
            false => self.manifest.origin.difference(&found.origin),
        };
        Err(FileError::Damaged(path.to_owned(), format!("{how}: take another directory, or remove it"))
            .into())
    }

    /// Keeps other processes from the directory, but for those that share it, each with a name of its own.
    ///
    /// # Errors
    /// If another process has it.
    pub(crate) fn lock(&mut self, own: Option<&str>) -> Result<(), Error> {
        let mut names = vec![(LOCK.to_owned(), own.is_some())];
        names.extend(own.map(|own| (format!("{own}.lock"), false)));
        for (name, is_shared) in names {
            let path = self.directory.join(name);
            let file = OpenOptions::new().create(true).truncate(false).write(true).open(&path);
            let file = file.map_err(FileError::write(&path))?;
            let locked = if is_shared { file.try_lock_shared() } else { file.try_lock() };
            match locked {
                Err(TryLockError::WouldBlock) => return Err(FileError::InUse(self.directory.clone()).into()),
                // file systems without locks are used all the same
                Err(TryLockError::Error(_)) | Ok(()) => self.locks.push(file),
            }
        }
        Ok(())
    }

    /// The place of the shard of this name.
    pub(crate) fn place(&self, name: &str) -> PathBuf {
        self.directory.join(format!("{name}.{SHARD}"))
    }

    /// Lists the shards.
    ///
    /// # Errors
    /// If the directory cannot be read.
    pub(crate) fn shards(&self) -> Result<Vec<PathBuf>, FileError> {
        shards_in(&self.directory)
    }

    /// Reads a shard of this ensemble; none where it is not there.
    ///
    /// # Errors
    /// If it cannot be read, or is of another one.
    pub(crate) fn read(&self, path: &Path) -> Result<Option<Shard>, Error> {
        if !path.exists() {
            return Ok(None);
        }
        let (manifest, shard) = Shard::read(path)?;
        self.check(path, &manifest)?;
        Ok(Some(shard))
    }

    /// Saves a shard in the place of what it was.
    ///
    /// # Errors
    /// If it cannot be written.
    pub(crate) fn save(&self, name: &str, shard: &Shard) -> Result<(), FileError> {
        NewFile::with(&self.place(name), &shard.content(&self.manifest))?.finish(true)
    }

    fn rows_directory(&self, rows: Rows) -> PathBuf {
        let looks = if rows.looks == RowLooks::End { "end" } else { "all" };
        self.directory.join(format!("rows-{looks}"))
    }

    /// Writes the rows of a block, if they are asked for.
    ///
    /// # Errors
    /// If they cannot be written.
    pub(crate) fn write_rows(
        &self,
        spec: &EnsembleSpec,
        quantities: &[String],
        block: &Block,
    ) -> Result<(), FileError> {
        let Some(rows) = self.manifest.rows else { return Ok(()) };
        let path = self.rows_directory(rows).join(rows_name(block.range.start, rows.format));
        let file = NewFile::begin(&path)?;
        let write = || -> io::Result<NewFile> {
            let drawn: Vec<String> =
                block.end.drawn.iter().map(|drawn| format!("drawn_{}", drawn.name)).collect();
            let columns = ["member".to_owned(), "time".to_owned()].into_iter().chain(drawn.iter().cloned());
            let columns: Vec<String> = columns.chain(quantities.iter().cloned()).collect();
            let mut file = rows_file(file, rows.format, columns, &self.manifest.origin)?;
            let looks: Vec<u64> = spec.looks().collect();
            let mut row = Vec::new();
            for (look, taken) in looks.iter().enumerate() {
                if rows.looks == RowLooks::End && look + 1 < looks.len() {
                    continue;
                }
                let values = &block.values[look * quantities.len()..(look + 1) * quantities.len()];
                for (k, member) in block.range.clone().enumerate() {
                    row.clear();
                    row.extend([member as f64, *taken as f64 * spec.job.step]);
                    row.extend(&block.end.drawn_values[k * drawn.len()..(k + 1) * drawn.len()]);
                    row.extend(values.iter().map(|values| values[k]));
                    file.row(&row)?;
                }
            }
            file.finish(&serde_json::Map::new())
        };
        write().map_err(FileError::write(&path))?.finish(true)
    }

    /// Moves the rows of all blocks, some of which are beside other shards, to the place where they are looked for.
    ///
    /// # Errors
    /// If one is missing, or cannot be moved, or something else is there.
    pub(crate) fn publish_rows(
        &self,
        spec: &EnsembleSpec,
        others: &[PathBuf],
        to: &Path,
        force: bool,
    ) -> Result<Option<PathBuf>, Error> {
        let Some(rows) = self.manifest.rows else { return Ok(None) };
        check_rows(to, &self.manifest.origin, force)?;
        let from = self.rows_directory(rows);
        let first = from.join(rows_name(0, rows.format));
        if !first.exists() && about(to).is_some_and(|found| found == self.manifest) {
            // before a kill they were moved
            let _ = fs::remove_dir(&from);
            return Ok(Some(to.to_owned()));
        }
        for block in 0..spec.blocks() {
            let name = rows_name(spec.range(block).start, rows.format);
            let place = from.join(&name);
            let inner = from.file_name().unwrap_or_default();
            let there = others.iter().map(|other| other.join(inner).join(&name)).find(|path| path.is_file());
            match there.filter(|_| !place.is_file()) {
                Some(there) => fs::rename(&there, &place).map_err(FileError::write(&place))?,
                None if place.is_file() => {}
                None => {
                    let missing = io::Error::new(io::ErrorKind::NotFound, "the rows of a block are missing");
                    return Err(FileError::read(&place)(missing).into());
                }
            }
        }
        remove_temporary(&from);
        let about = from.join(ABOUT);
        NewFile::with(&about, format!("{:#}\n", json!(self.manifest)).as_bytes())?.finish(true)?;
        if to.exists() {
            // of the same ensemble, or by force
            fs::remove_dir_all(to).map_err(FileError::write(to))?;
        }
        fs::rename(&from, to).map_err(FileError::write(to))?;
        Ok(Some(to.to_owned()))
    }

    /// Removes all shards and the directory: what they were for is written.
    pub(crate) fn remove(self) {
        for path in self.shards().unwrap_or_default() {
            let _ = fs::remove_file(path);
        }
        remove_temporary(&self.directory);
        for path in entries(&self.directory).unwrap_or_default() {
            if path.extension().is_some_and(|extension| extension == "lock") {
                let _ = fs::remove_file(path);
            }
        }
        // others' files stay, and it with them
        let _ = fs::remove_dir(&self.directory);
    }
}

/// Checks that no other directory of rows is replaced.
///
/// # Errors
/// If one is there that this ensemble did not make.
pub(crate) fn check_rows(to: &Path, origin: &FileOrigin, force: bool) -> Result<(), FileError> {
    if fs::symlink_metadata(to).is_err() {
        return Ok(());
    }
    match about(to) {
        Some(found) if force || found.origin == *origin => Ok(()),
        Some(found) => Err(FileError::Taken(to.to_owned(), origin.difference(&found.origin))),
        // a directory of others is not removed, whatever is said
        None => Err(FileError::damaged(to, "exists and was not made by this program")),
    }
}

/// Reads what a directory of rows is of.
fn about(rows: &Path) -> Option<Manifest> {
    serde_json::from_slice(&read_file(&rows.join(ABOUT), MOST).ok()?).ok()
}

/// Lists the shards in a directory, by their names.
///
/// # Errors
/// If it cannot be read.
pub(crate) fn shards_in(directory: &Path) -> Result<Vec<PathBuf>, FileError> {
    let mut found = entries(directory).map_err(FileError::read(directory))?;
    let is_hidden =
        |path: &Path| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'));
    found.retain(|path| path.extension().is_some_and(|extension| extension == SHARD) && !is_hidden(path));
    found.sort();
    Ok(found)
}

fn entries(directory: &Path) -> io::Result<Vec<PathBuf>> {
    fs::read_dir(directory)?.map(|entry| Ok(entry?.path())).collect()
}

/// Removes what killed processes left half-written.
fn remove_temporary(directory: &Path) {
    for path in entries(directory).unwrap_or_default() {
        if path.to_string_lossy().ends_with(super::write::TEMPORARY) {
            let _ = fs::remove_file(path);
        }
    }
}

fn rows_name(first: usize, format: Format) -> String {
    let extension = if format == Format::Csv { "csv" } else { "parquet" };
    format!("members-{first:012}.{extension}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_that_are_done_are_counted_once() {
        let mut done = Done::default();
        for block in [3, 4, 0, 9, 5, 1] {
            done.add(block);
        }
        assert_eq!(done, Done(vec![(0, 2), (3, 6), (9, 10)]));
        assert_eq!((done.count(), done.has(4), done.has(2)), (6, true, false));
        assert_eq!(done.left(12).collect::<Vec<_>>(), [2, 6, 7, 8, 10, 11]);
        assert_eq!(Done::default().left(2).collect::<Vec<_>>(), [0, 1]);
        assert_eq!(done.merge(&Done(vec![(2, 3), (7, 8)])), None);
        assert_eq!(done, Done(vec![(0, 6), (7, 8), (9, 10)]));
        assert_eq!(done.clone().merge(&Done(vec![(6, 10)])), Some(7));
        assert_eq!(done.merge(&Done(vec![(1, 2)])), Some(1));
        assert_eq!(done.left(10).collect::<Vec<_>>(), [6, 8]);
    }
}
