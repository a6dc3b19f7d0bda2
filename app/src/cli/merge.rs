//! `coadjoint merge`

use std::collections::BTreeSet;
use std::io::Write;
use std::path::{Path, PathBuf};

use clap::Args;

use super::console::OutputMode;
use super::ensemble::{Ensemble, Runners};
use super::{Command, program};
use crate::catalogue::Catalogue;
use crate::error::{Error, FileError, SetupError};
use crate::files::{Shard, ShardStore, is_stdout, shards_in};
use crate::units::grouped;

/// The arguments of `merge`.
#[derive(Debug, Args)]
pub(crate) struct MergeArguments {
    /// Shards, or directories of them
    #[arg(required = true)]
    pub(crate) shards: Vec<PathBuf>,
    /// The directory to write to; `-` writes the table to standard output
    #[arg(short, long, value_name = "DIR", default_value = "out", allow_hyphen_values = true)]
    pub(crate) out: PathBuf,
    /// Replace files of other runs, and of others
    #[arg(long)]
    pub(crate) force: bool,
    #[command(flatten)]
    pub(crate) output: OutputMode,
}

/// Makes one ensemble of its shards, and writes what one process would have written.
pub(crate) fn merge(
    catalogue: &Catalogue,
    arguments: &MergeArguments,
    stdout: &mut dyn Write,
) -> Result<(), Error> {
    let mut console = arguments.output.on(stdout, is_stdout(&arguments.out))?;
    let mut paths = Vec::new();
    for path in &arguments.shards {
        paths.extend(if path.is_dir() { shards_in(path)? } else { vec![path.clone()] });
    }
    let Some(first) = paths.first() else {
        let named =
            arguments.shards.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(", ");
        return Err(SetupError::new(format!("there are no shards in {named}")).into());
    };
    let (manifest, _) = Shard::read(first)?;
    let words = super::parsed(manifest.origin.words()).map_err(|error| SetupError::new(error.to_string()))?;
    let catalogue = &words.catalogue(catalogue)?;
    let Command::Ensemble(mut made) = words else {
        return Err(FileError::damaged(first, "is of no ensemble").into());
    };
    (made.motion.out, made.motion.force) = (arguments.out.clone(), arguments.force);
    made.block = manifest.block;
    made.rows = manifest.rows.map(|rows| rows.looks);
    made.format = manifest.rows.map(|rows| rows.format);
    if made.rows.is_some() && is_stdout(&arguments.out) {
        return Err(SetupError::new("rows are a directory of files: `--out DIR` says where they go").into());
    }
    let ensemble = Ensemble::of(catalogue, &made, Some(&manifest.origin), &mut console)?;
    ensemble.check_files()?;

    let here = |path: &'_ Path| {
        if path.as_os_str().is_empty() { Path::new(".").to_owned() } else { path.to_owned() }
    };
    let directories: BTreeSet<PathBuf> = paths.iter().filter_map(|path| path.parent()).map(here).collect();
    let directories: Vec<PathBuf> = directories.into_iter().collect();
    let mut store = ShardStore::open(&directories[0], ensemble.manifest.clone())?;
    store.lock(None)?;
    let (mut all, mut count) = (ensemble.nothing(), 0);
    let mut progress = console.progress("merge", paths.len() as u64, "shard");
    for path in &paths {
        let Some(shard) = store.read(path)? else {
            let missing = std::io::ErrorKind::NotFound.into();
            return Err(FileError::read(path)(missing).into());
        };
        let within = |error: SetupError| FileError::Damaged(path.clone(), error.to_string());
        all.merge(&shard).map_err(within)?;
        count += 1;
        progress.show(count as u64);
    }
    drop(progress);
    let blocks = ensemble.spec.blocks();
    let missing: Vec<u64> = all.done.left(blocks).take(1).collect();
    if let Some(first) = missing.first() {
        let members = grouped(ensemble.spec.range(*first).start as u64);
        return Err(SetupError::new(format!(
            "{} of {} blocks are missing, the first one from member {members} on: `{} {} --shard K/N --checkpoint {}` goes on",
            grouped(blocks - all.done.count()),
            grouped(blocks),
            program(),
            ensemble.manifest.origin.command(),
            directories[0].display()
        ))
        .into());
    }
    ensemble.finish(
        all,
        &Runners::Shards(count),
        Some((store, directories[1..].to_vec(), false)),
        &mut console,
    )
}
