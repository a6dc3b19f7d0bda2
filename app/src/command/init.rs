//! `init`: a file that describes a run.

use std::io::Write;
use std::path::PathBuf;

use clap::Args;

use crate::cli::program;
use crate::entry::Catalogue;
use crate::error::Error;
use crate::output::Guard;
use crate::output::path::is_stdout;
use crate::provenance::{Origin, embed};

/// Which file to write.
#[derive(Debug, Args)]
pub(crate) struct InitArguments {
    /// The system; `list` shows all
    pub(crate) system: String,
    /// Where to write it [default: `<system>.toml`]
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    /// Replace a file that is there
    #[arg(long)]
    pub(crate) force: bool,
}

pub(crate) fn init(
    catalogue: Catalogue,
    arguments: &InitArguments,
    console: &mut dyn Write,
) -> Result<(), Error> {
    let entry = catalogue.system(&arguments.system)?;
    let path = arguments.out.clone().unwrap_or_else(|| format!("{}.toml", entry.name).into());
    let origin = Origin::of_command(&format!("init {}", entry.name));
    // it is written to be edited
    let guard = Guard::new(origin, arguments.force).unrepeatable();
    guard.check(&path)?;
    guard.write(&path, &embed("toml", crate::config::example(entry).into_bytes(), guard.origin()))?;
    if !is_stdout(&path) {
        writeln!(console, "wrote {}; run it with `{} run --config {0}`", path.display(), program())?;
    }
    Ok(())
}
