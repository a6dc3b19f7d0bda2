//! The files of a run: which they are, and what is in them.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::{Plan, Record, title};
use crate::checkpoint::beside;
use crate::entry::Entry;
use crate::error::Error;
use crate::output::path::is_stdout;
use crate::output::{Claim, Format, Guard};
use crate::plot::Kind;
use crate::provenance::{Origin, Provenance, embed};

/// The files of a run.
#[derive(Clone, Debug, Default)]
pub(super) struct Files {
    pub(super) trajectory: Option<PathBuf>,
    pictures: Vec<(Kind, PathBuf)>,
    html: Option<PathBuf>,
}

impl Files {
    fn of(entry: &Entry, plan: &Plan, run: &Provenance) -> Result<Self, Error> {
        let to_stdout = is_stdout(&plan.out);
        if to_stdout && plan.plot {
            return Err(Error::Input("`--plot` writes files: give `--out` a directory".to_owned()));
        }
        let stem = run.stem(entry, &plan.job);
        let named = |extension: &str| plan.out.join(format!("{stem}.{extension}"));
        let trajectory = |format: Format| {
            if to_stdout { plan.out.clone() } else { named(format.extension()) }
        };
        Ok(Self {
            trajectory: plan.format.map(trajectory),
            pictures: match plan.plot {
                true => Kind::ALL.iter().map(|kind| (*kind, named(kind.extension()))).collect(),
                false => Vec::new(),
            },
            html: plan.html.clone(),
        })
    }

    /// Those to be written: what was computed until an interruption does not take the place of a whole run.
    pub(super) fn without_complete(self, guard: &Guard, interrupted: bool) -> Self {
        let is_to_be_written = |path: &PathBuf| {
            let stays = interrupted && !is_stdout(path) && guard.is_complete(path);
            if stays {
                note(&format!("{} holds the whole run, and stays", path.display()));
            }
            !stays
        };
        let Self { trajectory, mut pictures, html } = self;
        let [trajectory, html] = [trajectory, html].map(|path| path.filter(is_to_be_written));
        pictures.retain(|(_, path)| is_to_be_written(path));
        Self { trajectory, pictures, html }
    }

    /// What each is to the run.
    fn claims(&self, plan: &Plan, checkpoint: Option<&Path>) -> Vec<Claim> {
        let claim = |what, path: &PathBuf, written| Claim { what, path: path.clone(), written };
        let mut claims: Vec<Claim> =
            plan.inputs.iter().map(|path| claim("what describes the run", path, false)).collect();
        if let Some(path) = checkpoint {
            claims.push(claim("the checkpoint", &path.to_owned(), false));
            claims.push(claim("the checkpoint's journal", &beside(path, "rows"), false));
            claims.push(claim("the checkpoint's lock", &beside(path, "lock"), false));
        }
        let pictures = self.pictures.iter().map(|(_, path)| ("the picture", path));
        let written = [("the trajectory", &self.trajectory), ("the page", &self.html)];
        let written =
            written.into_iter().filter_map(|(what, path)| Some((what, path.as_ref()?))).chain(pictures);
        claims.extend(written.map(|(what, path)| claim(what, path, true)));
        claims
    }
}

/// Pictures and the page, with what made them.
pub(super) fn shown(
    entry: &Entry,
    plan: &Plan,
    record: &Record,
    files: &Files,
    run: &Origin,
) -> Result<Vec<(PathBuf, Vec<u8>)>, Error> {
    let mut shown = Vec::new();
    let figure = record.run_plot.as_ref().map(|run_plot| run_plot.figure(entry, title(entry, &plan.job)));
    for (figure, (kind, path)) in
        figure.iter().flat_map(|figure| files.pictures.iter().map(move |file| (figure, file)))
    {
        shown.push((path.clone(), embed(kind.extension(), figure.picture(*kind), run)));
    }
    if let (Some(html_player), Some(path)) = (&record.html_player, &files.html) {
        shown.push((path.clone(), embed("html", html_player.html(entry, plan).into_bytes(), run)));
    }
    Ok(shown)
}

/// The files of a run, looked at before it starts, and what guards them.
pub(super) fn prepared(
    entry: &Entry,
    plan: &Plan,
    checkpoint: Option<&Path>,
) -> Result<(Files, Guard), Error> {
    let run = plan.provenance(entry);
    let files = Files::of(entry, plan, &run)?;
    let guard = Guard::new(run.origin(), plan.force);
    for path in guard.check_all(&files.claims(plan, checkpoint))? {
        note(&format!("a run that was killed left {0}: `rm {0}` removes it", path.display()));
    }
    Ok((files, guard))
}

/// Tells people something; the run goes on even if standard error is closed.
fn note(text: &str) {
    let _ = writeln!(io::stderr(), "note: {text}");
}
