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
