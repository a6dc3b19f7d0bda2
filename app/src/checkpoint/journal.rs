//! The journal of a run: its rows, in blocks with checksums.
//!
//! ```text
//! coadjoint rows 2\n | identity of the run, 16 bytes | numbers in a row, u32 | checksum, u32
//! blocks: number of the block, u64 | rows in it, u32 | rows, f64 each number | checksum, u32
//! ```
//!
//! All numbers in little-endian. Each checksum goes on from the one before it, so that a block counts only in its place, in the journal of its run.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufReader, Read, Seek, SeekFrom, Write};
use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::Identity;
use crate::error::Error;
use crate::output::path::sync_directory;

const MAGIC: &[u8] = b"coadjoint rows 2\n";
/// A block is written when it has so many bytes, or a checkpoint is saved.
const BLOCK: usize = 1 << 16;

/// How far a journal had come at a checkpoint.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Mark {
    rows: u64,
    blocks: u64,
    /// The last block's checksum.
    sum: u32,
}

/// The rows of a run that may be interrupted.
#[derive(Debug)]
pub(super) struct Journal {
    path: PathBuf,
    file: File,
    width: usize,
    header: Vec<u8>,
    /// Of what is in the file.
    mark: Mark,
    /// Rows that are not yet.
    block: Vec<u8>,
}

impl Journal {
    /// Creates a journal with rows of this width, where nothing is.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub(super) fn create(path: PathBuf, width: usize, identity: Identity) -> Result<Self, Error> {
        let header = header(width, identity);
        let create = || {
            let mut file = OpenOptions::new().read(true).write(true).create_new(true).open(&path)?;
            let written = file.write_all(&header).and_then(|()| file.sync_data());
            if written.is_err() {
                let _ = fs::remove_file(&path);
            }
            written.map(|()| file)
        };
        match create().and_then(|file| sync_directory(&path).map(|()| file)) {
            Ok(file) => Ok(Self::at_its_start(path, file, width, header)),
            Err(source) => Err(Error::Write { path, source }),
        }
    }

    /// Opens the journal of a run and verifies all of it up to a mark; what comes later is discarded.
    ///
    /// # Errors
    /// If it is not what was written up to there, or cannot be read or written.
    pub(super) fn open(path: PathBuf, width: usize, identity: Identity, mark: &Mark) -> Result<Self, Error> {
        if !path.exists() && *mark == Mark::default() {
            // the process was killed before it could be created
            return Self::create(path, width, identity);
        }
        let unreadable = |source| Error::Read { path: path.clone(), source };
        let file = OpenOptions::new().read(true).write(true).open(&path).map_err(unreadable)?;
        let mut journal = Self::at_its_start(path.clone(), file, width, header(width, identity));
        journal.mark = *mark;
        if !(*mark == Mark::default() && journal.was_cut_short().map_err(unreadable)?) {
            journal.read(&mut |_| Ok(()))?;
        }
        let mut restart = || {
            let Self { file, header, .. } = &mut journal;
            let end = header.len() as u64 + mark.rows * 8 * width as u64 + 16 * mark.blocks;
            file.set_len(end)?;
            if mark.blocks == 0 {
                file.seek(SeekFrom::Start(0))?;
                file.write_all(header)?;
            }
            file.seek(SeekFrom::End(0))
        };
        restart().map_err(|source| Error::Write { path, source })?;
        Ok(journal)
    }

    fn at_its_start(path: PathBuf, file: File, width: usize, header: Vec<u8>) -> Self {
        Self { path, file, width, header, mark: Mark::default(), block: Vec::new() }
    }

    /// Whether the process was killed while it wrote the header.
    fn was_cut_short(&self) -> io::Result<bool> {
        let mut begin = Vec::new();
        Read::by_ref(&mut &self.file).take(self.header.len() as u64).read_to_end(&mut begin)?;
        Ok(begin.len() < self.header.len() && self.header.starts_with(&begin))
    }

    /// Adds a row.
    ///
    /// # Errors
    /// If it cannot be written.
    pub(super) fn row(&mut self, row: &[f64]) -> Result<(), Error> {
        self.block.extend(row.iter().flat_map(|value| value.to_le_bytes()));
        if self.block.len() >= BLOCK { self.write_block() } else { Ok(()) }
    }

    fn write_block(&mut self) -> Result<(), Error> {
        let rows = self.block.len() / (8 * self.width);
        let Mark { blocks, sum, .. } = self.mark;
        let mut block = [&blocks.to_le_bytes(), &(rows as u32).to_le_bytes()[..], &self.block].concat();
        let sum = checksum(if blocks == 0 { sum_of(&self.header) } else { sum }, &block);
        block.extend(sum.to_le_bytes());
        self.file.write_all(&block).map_err(|source| Error::Write { path: self.path.clone(), source })?;
        self.mark = Mark { rows: self.mark.rows + rows as u64, blocks: blocks + 1, sum };
        self.block.clear();
        Ok(())
    }

    /// Brings all rows to the disk, and tells how far that is.
    ///
    /// # Errors
    /// If they cannot be written.
    pub(super) fn sync(&mut self) -> Result<Mark, Error> {
        if !self.block.is_empty() {
            self.write_block()?;
        }
        self.file.sync_data().map_err(|source| Error::Write { path: self.path.clone(), source })?;
        Ok(self.mark)
    }

    /// Passes all rows to `show`, from the first on.
    ///
    /// # Errors
    /// If they are not what was written, or `show` fails.
    pub(super) fn replay(&mut self, show: &mut dyn FnMut(&[f64]) -> Result<(), Error>) -> Result<(), Error> {
        self.sync()?;
        self.read(show)
    }

    fn read(&mut self, show: &mut dyn FnMut(&[f64]) -> Result<(), Error>) -> Result<(), Error> {
        let Self { path, file, width, header, mark, .. } = self;
        let damaged = || Error::Damaged {
            path: path.clone(),
            what: "is damaged, or the journal of another run: the run cannot be resumed".to_owned(),
        };
        let failed = |source: io::Error| match source.kind() {
            io::ErrorKind::UnexpectedEof => damaged(),
            _ => Error::Read { path: path.clone(), source },
        };
        file.seek(SeekFrom::Start(0)).map_err(failed)?;
        let mut file = BufReader::new(file);
        let mut begin = vec![0; header.len()];
        file.read_exact(&mut begin).map_err(failed)?;
        if begin != *header {
            return Err(damaged());
        }
        let (mut rows, mut sum) = (0, sum_of(header));
        let mut row = Vec::with_capacity(*width);
        for number in 0..mark.blocks {
            let mut block = vec![0; 12];
            file.read_exact(&mut block).map_err(failed)?;
            let count = u32_at(&block, 8);
            // no more than are missing, and than a block has room for
            if u64::from(count) > mark.rows - rows || count as usize > BLOCK / (8 * *width) + 1 {
                return Err(damaged());
            }
            rows += u64::from(count);
            block.resize(12 + count as usize * 8 * *width, 0);
            file.read_exact(&mut block[12..]).map_err(failed)?;
            let mut end = [0; 4];
            file.read_exact(&mut end).map_err(failed)?;
            sum = checksum(sum, &block);
            if block[..8] != number.to_le_bytes() || end != sum.to_le_bytes() {
                return Err(damaged());
            }
            for numbers in block[12..].chunks_exact(8 * *width) {
                row.clear();
                let values = numbers.chunks_exact(8).map(|bytes| bytes.try_into().unwrap_or_default());
                row.extend(values.map(f64::from_le_bytes));
                show(&row)?;
            }
        }
        if rows != mark.rows || (mark.blocks > 0 && sum != mark.sum) {
            return Err(damaged());
        }
        Ok(())
    }
}

fn header(width: usize, identity: Identity) -> Vec<u8> {
    let mut header = [MAGIC, &identity, &(width as u32).to_le_bytes()].concat();
    header.extend(checksum(0, &header).to_le_bytes());
    header
}

/// The checksum at the end of a header.
fn sum_of(header: &[u8]) -> u32 {
    u32_at(header, header.len().saturating_sub(4))
}

/// Of what came before, and these bytes.
fn checksum(before: u32, bytes: &[u8]) -> u32 {
    let mut hasher = crc32fast::Hasher::new_with_initial(before);
    hasher.update(bytes);
    hasher.finalize()
}

fn u32_at(bytes: &[u8], at: usize) -> u32 {
    let bytes = bytes.get(at..at + 4).and_then(|bytes| bytes.try_into().ok());
    bytes.map_or(0, u32::from_le_bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A journal with rows of two numbers, in two blocks; it is removed.
    fn journal(test: &str, identity: Identity) -> (PathBuf, Mark, Vec<u8>) {
        let path = std::env::temp_dir().join(format!("coadjoint-{test}-{}.rows", std::process::id()));
        let _ = fs::remove_file(&path);
        let mut journal = Journal::create(path.clone(), 2, identity).expect("writable");
        for row in [[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]] {
            journal.row(&row).expect("writable");
            journal.sync().expect("writable");
        }
        let content = fs::read(&path).expect("readable");
        let _ = fs::remove_file(&path);
        (path, journal.mark, content)
    }

    /// The rows that a journal of this content has.
    fn rows(path: &PathBuf, content: &[u8], mark: &Mark, identity: Identity) -> Result<Vec<f64>, String> {
        fs::write(path, content).expect("writable");
        let mut rows = Vec::new();
        let opened = Journal::open(path.clone(), 2, identity, mark);
        let read = opened.and_then(|mut journal| {
            journal.replay(&mut |row| {
                rows.extend_from_slice(row);
                Ok(())
            })
        });
        let _ = fs::remove_file(path);
        read.map(|()| rows).map_err(|error| error.to_string())
    }

    #[test]
    fn every_flipped_bit_and_every_cut_is_found() {
        let (path, mark, content) = journal("bits", [7; 16]);
        assert_eq!(rows(&path, &content, &mark, [7; 16]), Ok(vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0]));
        for bit in 0..8 * content.len() {
            let mut flipped = content.clone();
            flipped[bit / 8] ^= 1 << (bit % 8);
            let found = rows(&path, &flipped, &mark, [7; 16]).expect_err("damaged");
            assert!(found.contains("is damaged"), "bit {bit}: {found}");
        }
        for length in 0..content.len() {
            assert!(rows(&path, &content[..length], &mark, [7; 16]).is_err(), "cut to {length} bytes");
        }
        // what comes after the mark is that of steps which will be taken again
        let longer = [&content[..], b"rest"].concat();
        assert_eq!(rows(&path, &longer, &mark, [7; 16]).map(|rows| rows.len()), Ok(6));
    }

    #[test]
    fn blocks_of_another_run_or_place_do_not_count() {
        let (path, mark, content) = journal("other", [7; 16]);
        let (_, other_mark, other) = journal("another", [8; 16]);
        assert!(rows(&path, &content, &mark, [8; 16]).is_err(), "the journal of another run");
        assert!(rows(&path, &content, &other_mark, [7; 16]).is_err(), "the checkpoint of another run");
        let header = MAGIC.len() + 16 + 4 + 4;
        let block = 8 + 4 + 16 + 4;
        let spliced = [&content[..header], &other[header..]].concat();
        assert!(rows(&path, &spliced, &mark, [7; 16]).is_err(), "rows of the same numbers, of another run");
        let mut swapped = content.clone();
        swapped[header..header + 2 * block].rotate_left(block);
        assert!(rows(&path, &swapped, &mark, [7; 16]).is_err(), "blocks out of order");
    }

    #[test]
    fn a_journal_that_was_not_begun_is_begun_again() {
        let (path, _, content) = journal("begun", [7; 16]);
        let header = MAGIC.len() + 16 + 4 + 4;
        for length in [0, 5, header - 1, header, content.len()] {
            assert_eq!(
                rows(&path, &content[..length], &Mark::default(), [7; 16]),
                Ok(Vec::new()),
                "{length}"
            );
        }
        assert!(rows(&path, b"of others", &Mark::default(), [7; 16]).is_err());
    }
}
