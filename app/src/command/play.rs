//! `coadjoint play`

use std::io::Write;
use std::path::PathBuf;

use clap::Args;

use crate::error::Error;
use crate::page::{Page, open};

/// What to show.
#[derive(Debug, Args)]
pub(crate) struct PlayArguments {
    /// Data in the format of pages, which any program can write, or pages; what moves in the later ones is drawn over the first
    #[arg(required = true, value_name = "FILE")]
    pub(crate) files: Vec<PathBuf>,
    /// Where to write the page [default: the first file with the extension `html`]
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    /// Open it
    #[arg(long)]
    pub(crate) open: bool,
}

pub(crate) fn play(arguments: &PlayArguments, console: &mut dyn Write) -> Result<(), Error> {
    let mut pages = arguments.files.iter().map(|path| Page::read(path));
    let Some(page) = pages.next() else {
        return Err(Error::Input("no file: give one with data to be shown".to_owned()));
    };
    let mut page = page?;
    for other in pages {
        page.overlay(other?);
    }
    page.check().map_err(|error| Error::Input(error.to_string()))?;
    let out = arguments.out.clone().unwrap_or_else(|| arguments.files[0].with_extension("html"));
    if arguments.out.is_none() && out.exists() {
        return Err(Error::Input(format!("{} exists already: say by `--out` where to write", out.display())));
    }
    page.write(&out)?;
    writeln!(console, "wrote {}", out.display())?;
    if arguments.open {
        show(&out, console)?;
    }
    Ok(())
}

/// Opens a page, or says why it cannot be opened.
pub(crate) fn show(path: &std::path::Path, console: &mut dyn Write) -> Result<(), Error> {
    if let Err(notice) = open(path) {
        writeln!(console, "note: {notice}")?;
    }
    Ok(())
}
