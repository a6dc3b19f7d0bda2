//! Files: trajectories, tables, what made them, and checkpoints. Each appears whole or not at all.

mod checkpoint;
mod json;
mod overwrite;
#[cfg(feature = "parquet")]
mod parquet;
pub(crate) mod path;
mod run_json;
mod shards;
mod table;
mod trajectory;
mod write;

use std::path::{Path, PathBuf};

pub(crate) use self::checkpoint::{CheckpointStore, rows_of};
pub(crate) use self::json::invariants;
pub(crate) use self::overwrite::Written;
pub use self::overwrite::{OverwriteGuard, PlannedFile};
pub(crate) use self::path::is_stdout;
pub use self::run_json::{FileOrigin, Members, Provenance};
pub(crate) use self::run_json::{Status, by_name, digest, read};
pub(crate) use self::shards::{Done, Manifest, RowLooks, Rows, Shard, ShardStore, check_rows, shards_in};
pub(crate) use self::table::TrajectoryWriter;
pub use self::table::table;
pub use self::trajectory::Trajectory;
pub(crate) use self::write::{NewFile, remove_unfinished};
pub use self::write::{check_new, write_new};

/// Names a file in a directory; or standard output, where `-` stands for the directory.
pub(crate) fn file_in(directory: &Path, name: &str) -> PathBuf {
    if is_stdout(directory) { directory.to_owned() } else { directory.join(name) }
}
