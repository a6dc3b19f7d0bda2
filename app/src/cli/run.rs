//! `coadjoint run`, `coadjoint view` and `coadjoint resume`

use std::io::Write;
use std::path::{Path, PathBuf};

use clap::Args;

use super::console::{Console, OutputMode};
use super::description::DescriptionArguments;
use super::motion::{ChosenRun, Motion, MotionArguments};
use super::program;
use super::report::{RunSummary, table};
use super::session::{FinishedRun, Plan, Session};
use super::{Command, ensemble, play, scan};
use crate::catalogue::{Catalogue, Entry};
use crate::error::{Error, SetupError};
use crate::files::{self, FileOrigin, is_stdout};
use crate::setup::config::RunConfig;
use crate::setup::{Column, Format, Moments};
use crate::simulate::time_per_step;
use crate::units::wrapped;

/// The arguments of `run`.
#[derive(Debug, Args)]
pub(crate) struct RunArguments {
    #[command(flatten)]
    pub(crate) chosen: ChosenRun,
    /// A file that a run wrote, or its `.run.json`: the run is made again, to the last byte
    #[arg(
        long,
        value_name = "FILE",
        conflicts_with_all = [
            "system", "config", "retraction", "method", "order", "set", "step", "duration", "every",
            "columns", "watch_every_step", "format", "plot", "quantity", "until", "event", "at", "every_seconds", "scan"
        ]
    )]
    pub(crate) again: Option<PathBuf>,
    /// Look at the state after every N-th step, and write it [default: 1]
    ///
    /// The last state is written too.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) every: Option<u64>,
    /// Write the states at these times, s, in place of steps: `0.1,0.25`
    ///
    /// Within a step the state is where a shorter step leads to; the steps themselves stay as they are.
    #[arg(long, value_name = "TIMES", value_delimiter = ',', allow_hyphen_values = true, conflicts_with_all = ["every", "every_seconds"])]
    pub(crate) at: Vec<f64>,
    /// Write the states at 0, S, 2 S, …, s, in place of steps
    #[arg(long, value_name = "S", conflicts_with = "every")]
    pub(crate) every_seconds: Option<f64>,
    /// Further columns of the table, behind the others
    ///
    /// Velocities belong to the momenta: of a body the angular velocity, rad/s. Attitudes lead from the axes of the body
    /// to those of space.
    #[arg(long, value_enum, value_name = "NAMES", value_delimiter = ',')]
    pub(crate) columns: Vec<Column>,
    /// Look at every step, whatever is written of them
    ///
    /// An error's peak may be as short as one step; a look takes several times as long.
    #[arg(long)]
    pub(crate) watch_every_step: bool,
    /// The format of the trajectory [default: csv]
    ///
    /// What made it stands beside it, in a file that ends in `.run.json`.
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
    /// `weight=1:10:20` are twenty values from 1 to 10. Two of them make a grid. Of each run a row is printed and
    /// written, with its largest errors and its end state; no trajectories.
    #[arg(
        long,
        value_name = "NAME=VALUES",
        conflicts_with_all = ["plot", "html", "checkpoint", "format", "every", "columns", "quantity", "until", "event", "at", "every_seconds", "watch_every_step"]
    )]
    pub(crate) scan: Vec<String>,
    #[command(flatten)]
    pub(crate) output: OutputMode,
}

/// The arguments of `view`.
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
    #[command(flatten)]
    pub(crate) output: OutputMode,
}

/// The time between two checkpoints unless another is asked for, s.
const PAUSE: f64 = 10.0;

/// A time between two checkpoints.
pub(super) fn pause(text: &str) -> Result<f64, String> {
    let seconds: f64 = text.parse().map_err(|_| format!("`{text}` is not a number"))?;
    match seconds {
        0.0..=1e9 => Ok(seconds),
        _ => Err(format!("the time between two checkpoints cannot be {seconds} s")),
    }
}

/// The arguments of `resume`.
#[derive(Debug, Args)]
pub(crate) struct ResumeArguments {
    /// Its checkpoint
    pub(crate) checkpoint: PathBuf,
    #[command(flatten)]
    pub(crate) described: DescriptionArguments,
    #[command(flatten)]
    pub(crate) output: OutputMode,
}

pub(crate) fn run(
    catalogue: &Catalogue,
    arguments: &RunArguments,
    stdout: &mut dyn Write,
) -> Result<(), Error> {
    let mut console = arguments.output.on(stdout, is_stdout(&arguments.chosen.motion.out))?;
    if arguments.open && arguments.html.is_none() {
        return Err(SetupError::new("`--open` opens a page: say where to write it by `--html`").into());
    }
    if let Some(file) = &arguments.again {
        return again(catalogue, file, arguments, &mut console);
    }
    described(catalogue, arguments, None, &mut console)
}

/// Makes the run that the arguments describe; again, if it made files of this origin.
fn described(
    catalogue: &Catalogue,
    arguments: &RunArguments,
    again: Option<&FileOrigin>,
    console: &mut Console<'_>,
) -> Result<(), Error> {
    let (motion, config) = arguments.chosen.motion(catalogue, console)?;
    again.map_or(Ok(()), |made| made.check_digits(motion.entry, &motion.setup, &motion.job))?;
    if !arguments.scan.is_empty() {
        return scan::scan(&motion, &arguments.scan, arguments, console);
    }
    // what is written is said once, by the options or by the file
    let is_asked = arguments.every.is_some() || !arguments.at.is_empty() || arguments.every_seconds.is_some();
    let (every, at, every_seconds) = match is_asked {
        true => (arguments.every, arguments.at.clone(), arguments.every_seconds),
        false => (config.every, config.at.clone(), config.every_seconds),
    };
    let every = every.unwrap_or(1);
    if every == 0 {
        return Err(SetupError::new("`every` must be 1 or more, got 0").into());
    }
    let format = Some(arguments.format.or(config.format).unwrap_or(Format::Csv).checked()?);
    let pause = arguments.checkpoint_every;
    let (plot, watch) =
        (arguments.plot || config.plot, arguments.watch_every_step || config.watch_every_step);
    let html = arguments.html.clone();
    let plan = planned(&motion, &arguments.chosen, &config);
    let columns = if arguments.columns.is_empty() { config.columns } else { arguments.columns.clone() };
    let moments = Moments { at, every_seconds, ..plan.moments };
    let plan = Plan { every, columns, moments, watch, format, plot, html, pause, ..plan };
    execute(motion.entry, plan, arguments.open, arguments.checkpoint.as_deref(), console)
}

/// Plans a run that looks at every step and writes nothing.
fn planned(motion: &Motion<'_>, chosen: &ChosenRun, config: &RunConfig) -> Plan {
    let given =
        |own: &Vec<String>, described: &Vec<String>| if own.is_empty() { described } else { own }.clone();
    Plan {
        system: motion.entry.name.clone(),
        description: motion.entry.file.clone(),
        setup: motion.setup.clone(),
        job: motion.job,
        every: 1,
        columns: Vec::new(),
        quantity: given(&chosen.quantity, &config.quantity),
        until: chosen.until.clone().or_else(|| config.until.clone()),
        moments: Moments { event: given(&chosen.event, &config.event), ..Moments::default() },
        watch: true,
        format: None,
        plot: false,
        html: None,
        out: chosen.motion.out.clone(),
        pause: PAUSE,
        force: chosen.motion.force,
        inputs: chosen
            .config
            .iter()
            .chain(motion.setup.input.iter().map(|input| &input.file))
            .cloned()
            .collect(),
    }
}

/// Makes a run: claims its files, prepares its recorders, takes its steps, writes its files and reports it.
fn execute(
    entry: &Entry,
    plan: Plan,
    open: bool,
    checkpoint: Option<&Path>,
    console: &mut Console<'_>,
) -> Result<(), Error> {
    let page = plan.html.clone().filter(|_| open);
    let done = Session::begin(entry, plan, checkpoint)?.run(console)?;
    report(done, checkpoint, console)?;
    page.map_or(Ok(()), |page| play::show(&page, console))
}

pub(crate) fn resume(
    catalogue: &Catalogue,
    arguments: &ResumeArguments,
    stdout: &mut dyn Write,
) -> Result<(), Error> {
    let path = &arguments.checkpoint;
    let description = arguments.described.file().map(PathBuf::as_path);
    let session = Session::resume(catalogue, path, description)?;
    let mut console = arguments.output.on(stdout, session.is_for_stdout())?;
    report(session.run(&console)?, Some(path), &mut console)
}

/// Makes a run of which nothing is written but the page.
pub(crate) fn view(
    catalogue: &Catalogue,
    arguments: &ViewArguments,
    stdout: &mut dyn Write,
) -> Result<(), Error> {
    let ViewArguments { chosen, html, open, output } = arguments;
    if is_stdout(&chosen.motion.out) {
        return Err(SetupError::new("a page is a file: `--html FILE` says where it goes").into());
    }
    let mut console = output.on(stdout, false)?;
    let (motion, config) = chosen.motion(catalogue, &mut console)?;
    let mut plan = planned(&motion, chosen, &config);
    let stem = plan.provenance(motion.entry).stem(motion.entry, &plan.job);
    plan.html = Some(html.clone().unwrap_or_else(|| plan.out.join(format!("{stem}.html"))));
    execute(motion.entry, plan, *open, None, &mut console)
}

/// Makes the run again that made a file, with a file of the same kind: by the command that stands beside it.
fn again(
    catalogue: &Catalogue,
    file: &Path,
    arguments: &RunArguments,
    console: &mut Console<'_>,
) -> Result<(), Error> {
    let name = file.display().to_string();
    let (origin, interrupted) = files::read(file)?
        .ok_or_else(|| SetupError::new(format!("nothing beside {name} says what made it")))?;
    if !origin.is_run() {
        let command = origin.command();
        return Err(SetupError::new(format!(
            "{name} is of no run: `{} {command}` makes it again",
            program()
        ))
        .into());
    }
    if interrupted {
        console.note(format!("the run of {name} was interrupted; now it goes to its end"))?;
    }
    let MotionArguments { out, force, .. } = &arguments.chosen.motion;
    let extension = file.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let command = super::parsed(origin.words()).map_err(|error| SetupError::new(error.to_string()))?;
    let catalogue = &command.catalogue(catalogue)?;
    match command {
        Command::Run(mut made) => {
            (made.chosen.motion.out, made.chosen.motion.force) = (out.clone(), *force);
            (made.checkpoint, made.checkpoint_every) =
                (arguments.checkpoint.clone(), arguments.checkpoint_every);
            made.format = Format::of_extension(&extension).filter(|_| !name.ends_with(".run.json"));
            made.plot = matches!(extension.as_str(), "svg" | "png");
            made.open = arguments.open;
            let is_page = matches!(extension.as_str(), "html" | "htm");
            let page = is_page.then(|| out.join(file.file_name().unwrap_or_default()));
            made.html = arguments.html.clone().or(page);
            described(catalogue, &made, Some(&origin), console)
        }
        Command::Ensemble(mut made) => {
            (made.motion.out, made.motion.force) = (out.clone(), *force);
            ensemble::described(catalogue, &made, Some(&origin), console)
        }
        _ => Err(SetupError::new(format!("{name} is of no run")).into()),
    }
}

/// Reports a run.
fn report(done: FinishedRun, checkpoint: Option<&Path>, console: &mut Console<'_>) -> Result<(), Error> {
    let FinishedRun { ref entry, plan, summary, written, interrupted, notes } = done;
    notes.into_iter().try_for_each(|note| console.note(note))?;
    let time_per_step = if interrupted { None } else { time_per_step(entry, &plan.setup, &plan.job)? };
    let end = summary.conservation.time;
    let summary = RunSummary { time_per_step, ..summary };
    let (conclusions, moments) = (summary.conclusions(entry), summary.moments());
    console.summary(&written, || {
        let mut object = summary.object(entry, &plan.setup);
        object["interrupted"] = interrupted.into();
        object
    })?;
    let words = console.words();
    write!(words, "{}", table(entry, &[summary]))?;
    for line in conclusions.into_iter().chain(moments) {
        writeln!(words, "{}", wrapped(&line, 78).join("\n  "))?;
    }
    console.wrote(&written)?;
    if !interrupted {
        return Ok(());
    }
    let words = console.words();
    writeln!(words, "interrupted at {end} s")?;
    if let Some(path) = checkpoint {
        writeln!(words, "`{} resume {}` resumes it", program(), path.display())?;
    }
    Err(Error::Interrupted)
}
