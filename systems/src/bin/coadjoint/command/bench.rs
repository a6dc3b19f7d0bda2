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
    /// Write them to this file too
    #[arg(long, value_name = "FILE")]
    pub(crate) json: Option<PathBuf>,
}

pub(crate) fn bench(_: Catalogue, arguments: &Arguments, console: &mut dyn Write) -> Result<(), Error> {
    #[cfg(feature = "bench")]
    return timing::bench(arguments, console);
    #[cfg(not(feature = "bench"))]
    {
        let Arguments { json: _ } = arguments;
        let _ = console;
        Err(Error::Input(
            "this program was built without its benchmarks: `cargo run --profile bench --features bench -- bench` builds and runs them"
                .to_owned(),
        ))
    }
}
