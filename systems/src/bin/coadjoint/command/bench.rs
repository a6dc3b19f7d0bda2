//! `coadjoint bench`

#[cfg(feature = "bench")]
mod timing;

use std::io::Write;
use std::path::PathBuf;

use clap::Args;
use coadjoint_app::{Catalogue, Error};

/// What to do with the times.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Only cases whose problem or method contains this text
    #[arg(long, value_name = "TEXT")]
    pub(crate) filter: Option<String>,
    /// Print one JSON object in place of the table, or write it to a file
    #[arg(long, value_name = "FILE", num_args = 0..=1, default_missing_value = "-")]
    pub(crate) json: Option<PathBuf>,
    /// Replace the file, if it is there
    #[arg(long)]
    pub(crate) force: bool,
    /// Show no progress
    #[arg(short, long)]
    pub(crate) quiet: bool,
}

pub(crate) fn bench(_: &Catalogue, arguments: &Arguments, console: &mut dyn Write) -> Result<(), Error> {
    #[cfg(feature = "bench")]
    return timing::bench(arguments, console);
    #[cfg(not(feature = "bench"))]
    {
        let Arguments { filter: _, json: _, force: _, quiet: _ } = arguments;
        let _ = console;
        let reason = "this program was built without its benchmarks: `cargo run --profile bench --features bench -- bench` \
                      builds and runs them";
        Err(coadjoint_app::error::SetupError::new(reason).into())
    }
}
