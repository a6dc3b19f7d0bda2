//! `coadjoint run` and `coadjoint resume`

use std::io::Write;
use std::path::{Path, PathBuf};

use clap::Args;

use crate::cli::program;
use crate::command::play;
use crate::config::Config;
use crate::entry::Catalogue;
use crate::error::Error;
use crate::output::{Format, name};
use crate::report::{RunSummary, Table};
use crate::session::{FinishedRun, Plan, Session};
use crate::setting;
use crate::simulation::{Job, Method, Order, Retraction};

/// Which run to make, and where to write it.
#[derive(Debug, Args)]
pub(crate) struct RunArguments {
    /// The system; `coadjoint list` shows all
    pub(crate) system: Option<String>,
    /// A TOML file that describes the run; options given here take precedence
    #[arg(long, value_name = "FILE")]
    pub(crate) config: Option<PathBuf>,
    /// The map that the step is built on; `exp` for short [default: exponential]
    #[arg(long, value_enum)]
    pub(crate) retraction: Option<Retraction>,
    /// What the step makes of it [default: standard], or a classical method to compare with, by the system's vector field: these have no
    /// retraction and an order of their own, and are not fast; with most of those in stored numbers rotations drift off their group
    #[arg(long)]
    pub(crate) method: Option<Method>,
    /// The order: steps of order 2, or symmetric compositions of them [default: 2]
    #[arg(long, value_enum)]
    pub(crate) order: Option<Order>,
    #[command(flatten)]
    pub(crate) motion: MotionArguments,
    /// Write the state after every N-th step [default: 1]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) every: Option<u64>,
    /// Draw the run too: what moves, and the errors of what is conserved
    #[arg(long)]
    pub(crate) plot: bool,
    /// Write a page that shows the run moving, to be opened in a browser
    #[arg(long, value_name = "FILE")]
    pub(crate) html: Option<PathBuf>,
    /// Open the page in a browser
    #[arg(long)]
    pub(crate) open: bool,
    /// Keep a checkpoint here, so that `coadjoint resume FILE` can go on if the run is interrupted
    #[arg(long, value_name = "FILE")]
    pub(crate) checkpoint: Option<PathBuf>,
    /// The format of the trajectory [default: csv]
    #[arg(long, value_enum)]
    pub(crate) format: Option<Format>,
}

/// What every motion needs.
#[derive(Debug, Args)]
pub(crate) struct MotionArguments {
    /// Set a parameter or a part of the initial state: `weight=9.81`, `chi=0,0,0.3`, `momentum_z=5`; or a control, to be held in place of
    /// what the system's own law chooses: `thrust=9`
    #[arg(long, value_name = "NAME=VALUE")]
    pub(crate) set: Vec<String>,
    /// The step, s; negative to go back in time [default: the system's own]
    #[arg(long, value_name = "H", allow_negative_numbers = true)]
    pub(crate) step: Option<f64>,
    /// How long to run, s [default: the system's own]
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    pub(crate) duration: Option<f64>,
    /// The directory to write to
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub(crate) out: PathBuf,
}

/// Which run to go on with.
#[derive(Debug, Args)]
pub(crate) struct ResumeArguments {
    /// Its checkpoint
    pub(crate) checkpoint: PathBuf,
}

pub(crate) fn run(
    catalogue: Catalogue,
    arguments: &RunArguments,
    console: &mut dyn Write,
) -> Result<(), Error> {
    if arguments.open && arguments.html.is_none() {
        return Err(Error::Input("`--open` opens a page: say where to write it by `--html`".to_owned()));
    }
    let plan = plan(catalogue, arguments, console)?;
    let checkpoint = arguments.checkpoint.clone();
    let go_on = checkpoint.clone();
    let page = plan.html.clone().filter(|_| arguments.open);
    finish(Session::begin(catalogue, plan, checkpoint)?.run()?, go_on.as_deref(), console)?;
    page.map_or(Ok(()), |page| play::show(&page, console))
}

pub(crate) fn resume(
    catalogue: Catalogue,
    arguments: &ResumeArguments,
    console: &mut dyn Write,
) -> Result<(), Error> {
    let path = &arguments.checkpoint;
    finish(Session::resume(catalogue, path)?.run()?, Some(path), console)
}

/// `coadjoint view`: a run of which nothing is written but the page.
pub(crate) fn view(
    catalogue: Catalogue,
    arguments: &RunArguments,
    console: &mut dyn Write,
) -> Result<(), Error> {
    let mut plan = plan(catalogue, arguments, console)?;
    if plan.html.is_none() {
        let entry = catalogue.system(&plan.system)?;
        plan.html = Some(plan.out.join(format!("{}.html", name(entry, &plan.job))));
    }
    plan.format = None;
    let page = plan.html.clone().filter(|_| arguments.open);
    finish(Session::begin(catalogue, plan, None)?.run()?, None, console)?;
    page.map_or(Ok(()), |page| play::show(&page, console))
}

/// The plan from the arguments and the configuration file; the arguments take precedence.
fn plan(catalogue: Catalogue, arguments: &RunArguments, console: &mut dyn Write) -> Result<Plan, Error> {
    let file = arguments.config.as_deref();
    let config = file.map(Config::read).transpose()?.unwrap_or_default();
    let system = match (&arguments.system, &config.system) {
        (Some(asked), Some(described))
            if catalogue.system(asked)?.name != catalogue.system(described)?.name =>
        {
            return Err(Error::Input(format!(
                "{} describes a run of `{described}`, not of `{asked}`",
                file.unwrap_or(Path::new("")).display()
            )));
        }
        (Some(system), _) | (None, Some(system)) => system,
        (None, None) => {
            let example = catalogue.entries().first().map_or("…", |entry| entry.name);
            return Err(Error::Input(format!(
                "no system: name one, as in `{0} run {example}`, or give `system = \"…\"` in a file by \
                 `--config` (`{0} list` shows all)",
                program()
            )));
        }
    };
    let entry = catalogue.system(system)?;
    let mut setup = entry.example.clone();
    let mut order = arguments.order;
    if let Some(path) = file {
        config.apply(path, entry, &mut setup)?;
        order = order.or(config.order(path)?);
    }
    setting::apply(entry, &mut setup, &arguments.motion.set)?;
    let mut notes = setting::validate(entry, &mut setup)?;
    let step = arguments.motion.step.or(config.run.step).unwrap_or(entry.step);
    let duration = arguments.motion.duration.or(config.run.duration).unwrap_or(entry.duration);
    let (steps, note) = steps(step, duration)?;
    notes.extend(note);
    for note in notes {
        writeln!(console, "note: {note}")?;
    }
    console.flush()?;
    let method = arguments.method.or(config.run.method).unwrap_or(Method::Standard);
    check_scheme(method, arguments.order.is_some(), arguments.retraction.is_some())?;
    let every = arguments.every.or(config.run.every).unwrap_or(1);
    if every == 0 {
        return Err(Error::Input("`every` must be 1 or more, got 0".to_owned()));
    }
    Ok(Plan {
        system: entry.name.to_owned(),
        setup,
        job: Job {
            method,
            retraction: arguments.retraction.or(config.run.retraction).unwrap_or(Retraction::Exponential),
            order: order.unwrap_or(Order::Two),
            step,
            steps,
        },
        every,
        format: Some(arguments.format.or(config.run.format).unwrap_or(Format::Csv)),
        plot: arguments.plot,
        html: arguments.html.clone(),
        out: arguments.motion.out.clone(),
    })
}

/// Whether what was asked for beside a method means anything to it.
fn check_scheme(method: Method, order: bool, retraction: bool) -> Result<(), Error> {
    let Some(classical) = method.classical() else { return Ok(()) };
    if order {
        return Err(Error::Input(format!(
            "`--order` composes steps of ours; method {method} has its own order, {}",
            classical.order()
        )));
    }
    if retraction {
        return Err(Error::Input(format!("`--retraction` is for methods of ours; method {method} has none")));
    }
    Ok(())
}

/// How many steps to take, with a note if they do not add up to the duration asked for.
pub(crate) fn steps(step: f64, duration: f64) -> Result<(u64, Option<String>), Error> {
    /// Beyond this, step numbers are no longer exact in f64, and no run would finish.
    const MOST: f64 = 9e15;

    if !(step.is_finite() && step != 0.0) {
        return Err(Error::Input(format!("`--step` must be finite and not zero, got {step}")));
    }
    if !(duration.is_finite() && duration >= 0.0) {
        return Err(Error::Input(format!(
            "`--duration` must be finite and not negative, got {duration} (a negative `--step` goes back in time)"
        )));
    }
    let exact = duration / step.abs();
    if exact > MOST {
        return Err(Error::Input(format!(
            "{duration} s in steps of {step} s are {exact:.1e} steps: too many"
        )));
    }
    let steps = exact.round();
    let note = ((exact - steps).abs() > 1e-6).then(|| {
        format!(
            "{duration} s are not a whole number of steps of {step} s: the run ends at {} s",
            steps * step
        )
    });
    Ok((steps as u64, note))
}

/// Prints the report.
fn finish(done: FinishedRun, checkpoint: Option<&Path>, console: &mut dyn Write) -> Result<(), Error> {
    let FinishedRun { entry, plan, conservation, off_group, report, written, interrupted } = done;
    let time_per_step = if interrupted { None } else { entry.time_per_step(&plan.setup, &plan.job)? };
    let end = conservation.time;
    let summary = RunSummary { job: plan.job, report, conservation, off_group, time_per_step };
    let conclusions = summary.conclusions(entry);
    write!(console, "{}", Table::new(entry, vec![summary]))?;
    for line in conclusions {
        writeln!(console, "{line}")?;
    }
    for path in written {
        writeln!(console, "wrote {}", path.display())?;
    }
    if !interrupted {
        return Ok(());
    }
    writeln!(console, "interrupted at {end} s")?;
    if let Some(path) = checkpoint {
        writeln!(console, "`{} resume {}` resumes it", program(), path.display())?;
    }
    Err(Error::Interrupted)
}
