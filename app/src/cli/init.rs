//! `init`: a file that describes a run.

use std::io::Write;
use std::path::PathBuf;

use clap::Args;

use super::description::DescriptionArguments;
use super::program;
use crate::catalogue::Catalogue;
use crate::error::Error;
use crate::files::{is_stdout, write_new};
use crate::setup::config;

/// The arguments of `init`.
#[derive(Debug, Args)]
pub(crate) struct InitArguments {
    /// The system; `list` shows all
    ///
    /// Without one, `--description FILE` writes a description to begin with.
    #[cfg_attr(feature = "description", arg(required_unless_present = "description"))]
    #[cfg_attr(not(feature = "description"), arg(required = true))]
    pub(crate) system: Option<String>,
    #[command(flatten)]
    pub(crate) described: DescriptionArguments,
    /// Where to write it [default: `<system>.toml`]
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    /// Replace a file that is there
    #[arg(long)]
    pub(crate) force: bool,
}

pub(crate) fn init(
    catalogue: &Catalogue,
    arguments: &InitArguments,
    console: &mut dyn Write,
) -> Result<(), Error> {
    #[cfg(feature = "description")]
    if let (None, Some(file)) = (&arguments.system, arguments.described.file()) {
        write_new(file, super::description::TEMPLATE.as_bytes(), arguments.force)?;
        if !is_stdout(file) {
            let (file, program) = (file.display(), program());
            writeln!(console, "wrote {file}; `{program} list --description {file}` tells what it is")?;
        }
        return Ok(());
    }
    let entry = arguments.described.system(catalogue, arguments.system.as_deref())?;
    let path = arguments.out.clone().unwrap_or_else(|| format!("{}.toml", entry.name).into());
    // it is written to be edited: the same one would be a loss too
    write_new(&path, config::example(entry).as_bytes(), arguments.force)?;
    if !is_stdout(&path) {
        let described = entry.file.as_ref().map(|file| format!(" --description {}", file.display()));
        let (path, described) = (path.display(), described.unwrap_or_default());
        writeln!(console, "wrote {path}; run it with `{} run --config {path}{described}`", program())?;
    }
    Ok(())
}
