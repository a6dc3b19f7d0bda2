//! `coadjoint run`, `coadjoint view` and `coadjoint resume`

use std::io::Write;
use std::path::{Path, PathBuf};

use clap::Args;

use super::motion::{ChosenRun, Motion};
use super::scan;
use crate::cli::program;
use crate::command::play;
use crate::console::{Console, Telling};
use crate::entry::{Catalogue, Entry};
use crate::error::Error;
use crate::estimate;
use crate::output::Format;
use crate::output::path::is_stdout;
use crate::provenance::{self, Provenance};
use crate::report::{RunSummary, Table, wrapped};
use crate::session::{FinishedRun, Plan, Session};
use crate::setting::{Changes, assignments};

/// Which run to make, and where to write it.
#[derive(Debug, Args)]
pub(crate) struct RunArguments {
    #[command(flatten)]
    pub(crate) chosen: ChosenRun,
    /// A file that a run wrote: the run is made again, to the last byte
    #[arg(
        long,
        value_name = "FILE",
        conflicts_with_all = [
            "system", "config", "retraction", "method", "order", "set", "step", "duration", "every", "format", "plot", "scan"
        ]
    )]
    pub(crate) again: Option<PathBuf>,
    /// Write the state after every N-th step [default: 1]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) every: Option<u64>,
    /// The format of the trajectory [default: csv]
    ///
    /// Lines of a CSV that begin with `#` say what made it: pandas skips them with `comment="#"`.
    #[arg(long, value_enum)]
    pub(crate) format: Option<Format>,
    /// Draw the run too: what moves, and the errors of what is conserved
    #[arg(long)]
    pub(crate) plot: bool,
    /// Write a page that shows the run moving, to be opened in a browser
    #[arg(long, value_name = "FILE")]
    pub(crate) html: Option<PathBuf>,
    /// Open the page in a browser
    #[arg(long)]
    pub(crate) open: bool,
    /// Keep a checkpoint here, for `resume FILE` after an interruption
    #[arg(long, value_name = "FILE")]
    pub(crate) checkpoint: Option<PathBuf>,
    /// How often the checkpoint is brought up to date, s
    #[arg(long = "save-every", value_name = "S", default_value_t = PAUSE, requires = "checkpoint", value_parser = pause)]
    pub(crate) checkpoint_every: f64,
    /// One run for each value, in parallel: `weight=1:10:20`, `weight=1,2,5`
    ///
    /// `weight=1:10:20` are twenty values from 1 to 10. Two of them make a grid. Of each run a row is printed and written, with its largest
    /// errors and its end state; no trajectories.
    #[arg(
        long,
        value_name = "NAME=VALUES",
        conflicts_with_all = ["plot", "html", "checkpoint", "format", "every"]
    )]
    pub(crate) scan: Vec<String>,
    /// Start even a run of hours or of gigabytes
    #[arg(long)]
    pub(crate) long: bool,
    #[command(flatten)]
    pub(crate) telling: Telling,
}

/// Which run to show.
#[derive(Debug, Args)]
pub(crate) struct ViewArguments {
    #[command(flatten)]
    pub(crate) chosen: ChosenRun,
    /// The page to write [default: `<DIR>/<name of the run>.html`]
    #[arg(long, value_name = "FILE")]
    pub(crate) html: Option<PathBuf>,
    /// Open the page in a browser
    #[arg(long)]
    pub(crate) open: bool,
    /// Start even a run of hours
    #[arg(long)]
    pub(crate) long: bool,
    #[command(flatten)]
    pub(crate) telling: Telling,
}

/// The time between two checkpoints unless another is asked for, s.
const PAUSE: f64 = 10.0;

/// A time between two checkpoints.
fn pause(text: &str) -> Result<f64, String> {
    let seconds: f64 = text.parse().map_err(|_| format!("`{text}` is not a number"))?;
    match seconds {
        0.0..=1e9 => Ok(seconds),
        _ => Err(format!("the time between two checkpoints cannot be {seconds} s")),
    }
}

/// Which run to go on with.
#[derive(Debug, Args)]
pub(crate) struct ResumeArguments {
    /// Its checkpoint
    pub(crate) checkpoint: PathBuf,
    #[command(flatten)]
    pub(crate) telling: Telling,
}

pub(crate) fn run(
    catalogue: Catalogue,
    arguments: &RunArguments,
    stdout: &mut dyn Write,
) -> Result<(), Error> {
    let is_taken = is_stdout(&arguments.chosen.motion.out);
    let mut console = arguments.telling.on(stdout, is_taken)?;
    if is_taken && arguments.plot {
        return Err(Error::Input("`--plot` writes pictures: `--out` has to name a directory".to_owned()));
    }
    if arguments.open && arguments.html.is_none() {
        return Err(Error::Input("`--open` opens a page: say where to write it by `--html`".to_owned()));
    }
    let plan = match &arguments.again {
        Some(file) => {
            let (made, interrupted) = made(file)?;
            if interrupted {
                let file = file.display();
                console.note(format!("the run of {file} was interrupted; now it goes to its end"))?;
            }
            if !made.scan.is_empty() {
                return scan::scan(&motion_of(catalogue, &made)?, &made.scan, arguments, &mut console);
            }
            if made.ensemble.is_some() {
                drop(console);
                return super::ensemble::again(catalogue, &made, arguments, stdout);
            }
            again(catalogue, &made, file, arguments)?
        }
        None if arguments.scan.is_empty() => plan(catalogue, arguments, &mut console)?,
        None => {
            let (motion, _) = arguments.chosen.motion(catalogue, &mut console)?;
            return scan::scan(&motion, &arguments.scan, arguments, &mut console);
        }
    };
    let checkpoint = arguments.checkpoint.clone();
    let go_on = checkpoint.clone();
    let page = plan.html.clone().filter(|_| arguments.open);
    finish(Session::begin(catalogue, plan, checkpoint)?.run()?, go_on.as_deref(), &mut console)?;
    page.map_or(Ok(()), |page| play::show(&page, console.words()))
}

pub(crate) fn resume(
    catalogue: Catalogue,
    arguments: &ResumeArguments,
    stdout: &mut dyn Write,
) -> Result<(), Error> {
    let path = &arguments.checkpoint;
    let session = Session::resume(catalogue, path)?;
    let mut console = arguments.telling.on(stdout, session.is_for_stdout())?;
    finish(session.run()?, Some(path), &mut console)
}

/// A run of which nothing is written but the page.
pub(crate) fn view(
    catalogue: Catalogue,
    arguments: &ViewArguments,
    stdout: &mut dyn Write,
) -> Result<(), Error> {
    let mut console = arguments.telling.on(stdout, false)?;
    if is_stdout(&arguments.chosen.motion.out) {
        return Err(Error::Input("a page is a file: `--html FILE` says where it goes".to_owned()));
    }
    let (motion, _) = arguments.chosen.motion(catalogue, &mut console)?;
    check_length(&motion, 1, None, arguments.long)?;
    let Motion { entry, setup, job, .. } = motion;
    let out = arguments.chosen.motion.out.clone();
    let mut plan = Plan {
        system: entry.name.to_owned(),
        setup,
        job,
        every: 1,
        format: None,
        plot: false,
        html: None,
        out,
        pause: PAUSE,
        force: arguments.chosen.motion.force,
        inputs: arguments.chosen.config.iter().cloned().collect(),
    };
    let html = arguments.html.clone().unwrap_or_else(|| page_of(entry, &plan));
    plan.html = Some(html.clone());
    let page = Some(html).filter(|_| arguments.open);
    finish(Session::begin(catalogue, plan, None)?.run()?, None, &mut console)?;
    page.map_or(Ok(()), |page| play::show(&page, console.words()))
}

/// Where the page of a run is, unless it is said.
fn page_of(entry: &Entry, plan: &Plan) -> PathBuf {
    plan.out.join(format!("{}.html", plan.provenance(entry).stem(entry, &plan.job)))
}

/// The run that made a file, and whether it was interrupted.
fn made(file: &Path) -> Result<(Provenance, bool), Error> {
    let found = provenance::read(file).map_err(|source| Error::Read { path: file.to_owned(), source })?;
    let found = found.ok_or_else(|| Error::Input(format!("{} does not say what made it", file.display())))?;
    found.run().map(|run| (run, found.interrupted().is_some())).ok_or_else(|| {
        let (file, program) = (file.display(), crate::cli::program());
        let command = found.command().unwrap_or_default();
        Error::Input(format!("{file} is of no run: `{program} {command}` makes it again"))
    })
}

/// The run about which a scan was made.
fn motion_of(catalogue: Catalogue, made: &Provenance) -> Result<Motion, Error> {
    let entry = made.entry(catalogue)?;
    let mut changes = Changes::of(entry);
    changes.apply(&assignments(entry, &made.setup(entry)?))?;
    let (setup, _) = changes.clone().finish()?;
    Ok(Motion { entry, changes, setup, job: made.job()? })
}

/// The plan of the run that made a file, for a file of the same kind.
fn again(
    catalogue: Catalogue,
    made: &Provenance,
    file: &Path,
    arguments: &RunArguments,
) -> Result<Plan, Error> {
    let entry = made.entry(catalogue)?;
    let extension = file.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let format = Format::of_extension(&extension);
    let mut plan = Plan {
        system: entry.name.to_owned(),
        setup: made.setup(entry)?,
        job: made.job()?,
        every: made.every,
        format,
        plot: matches!(extension.as_str(), "svg" | "png"),
        html: arguments.html.clone(),
        out: arguments.chosen.motion.out.clone(),
        pause: arguments.checkpoint_every,
        force: arguments.chosen.motion.force,
        inputs: Vec::new(),
    };
    if plan.html.is_none() && matches!(extension.as_str(), "html" | "htm") {
        plan.html = Some(page_of(entry, &plan));
    }
    if plan.format.is_none() && !plan.plot && plan.html.is_none() {
        return Err(Error::Input(format!("{} has an extension of no kind of output", file.display())));
    }
    Ok(plan)
}

/// The plan from the arguments and the configuration file; the arguments take precedence.
fn plan(catalogue: Catalogue, arguments: &RunArguments, console: &mut Console<'_>) -> Result<Plan, Error> {
    let (motion, config) = arguments.chosen.motion(catalogue, console)?;
    let every = arguments.every.or(config.every).unwrap_or(1);
    if every == 0 {
        return Err(Error::Input("`every` must be 1 or more, got 0".to_owned()));
    }
    let format = Some(arguments.format.or(config.format).unwrap_or(Format::Csv));
    check_length(&motion, every, format, arguments.long)?;
    let Motion { entry, setup, job, .. } = motion;
    Ok(Plan {
        system: entry.name.to_owned(),
        setup,
        job,
        every,
        format,
        plot: arguments.plot,
        html: arguments.html.clone(),
        out: arguments.chosen.motion.out.clone(),
        pause: arguments.checkpoint_every,
        force: arguments.chosen.motion.force,
        inputs: arguments.chosen.config.iter().cloned().collect(),
    })
}

/// Runs of hours or gigabytes have to be asked for.
fn check_length(motion: &Motion, every: u64, format: Option<Format>, long: bool) -> Result<(), Error> {
    let Motion { entry, setup, job, .. } = motion;
    match estimate::of_run(entry, setup, job, every, format) {
        Some(estimate) if !long => estimate.check(job.steps, every),
        _ => Ok(()),
    }
}

/// Prints the report.
fn finish(done: FinishedRun, checkpoint: Option<&Path>, console: &mut Console<'_>) -> Result<(), Error> {
    let FinishedRun { entry, plan, conservation, off_group, report, written, interrupted } = done;
    let time_per_step = if interrupted { None } else { entry.time_per_step(&plan.setup, &plan.job)? };
    let end = conservation.time;
    let summary = RunSummary { job: plan.job, report, conservation, off_group, time_per_step };
    let conclusions = summary.conclusions(entry);
    let notes = console.notes().to_vec();
    let files = || written.iter().filter(|path| !is_stdout(path));
    console.object(|| {
        let mut object = summary.object(entry, &plan.setup);
        object["notes"] = notes.into();
        object["written"] = files().map(|path| path.display().to_string()).collect();
        object["interrupted"] = interrupted.into();
        object
    })?;
    let words = console.words();
    write!(words, "{}", Table::new(entry, vec![summary]))?;
    for line in conclusions {
        writeln!(words, "{}", wrapped(&line, 78).join("\n  "))?;
    }
    for path in files() {
        writeln!(words, "wrote {}", path.display())?;
    }
    if !interrupted {
        return Ok(());
    }
    writeln!(words, "interrupted at {end} s")?;
    if let Some(path) = checkpoint {
        writeln!(words, "`{} resume {}` resumes it", program(), path.display())?;
    }
    Err(Error::Interrupted)
}
