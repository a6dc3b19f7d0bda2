//! `coadjoint paper`: the paper's heavy top, 30 minutes of its motion with both retractions, and its figure.

use std::io::Write;
use std::path::PathBuf;

use clap::Args;
use coadjoint_app::cli::console::OutputMode;
use coadjoint_app::cli::report::{RunSummary, table};
use coadjoint_app::cli::session::{Plan, Session};
use coadjoint_app::error::SetupError;
use coadjoint_app::setup::{Format, Job, Method, Order, Retraction};
use coadjoint_app::simulate::time_per_step;
use coadjoint_app::units::grouped;
use coadjoint_app::{Catalogue, Error};

use crate::figures::{Drawing, chosen};

/// Where to write it.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// The directory to write to
    #[arg(long, value_name = "DIR", default_value = "out")]
    pub(crate) out: PathBuf,
    /// Replace files that are there, whatever they are
    #[arg(long)]
    pub(crate) force: bool,
}

const SYSTEM: &str = "heavy_top";
const FIGURE: &str = "6.2";
const STEP: f64 = 0.01;
const STEPS: u64 = 180_000;
/// Trajectories of every step would fill 100 MB.
const EVERY: u64 = 10;

pub(crate) fn paper(
    catalogue: &Catalogue,
    arguments: &Arguments,
    console: &mut dyn Write,
) -> Result<(), Error> {
    let entry = catalogue.system(SYSTEM)?;
    let setup = entry.example.clone();
    let out = &arguments.out;
    if out.as_os_str() == "-" {
        return Err(SetupError::new("these are many files: give `--out` a directory").into());
    }
    let guarded = |drawing: &'static Drawing| Ok((drawing, drawing.guard(out, arguments.force)?));
    let figure = chosen(&[FIGURE.to_owned()])?.into_iter().map(guarded).collect::<Result<Vec<_>, Error>>()?;
    writeln!(
        console,
        "The heavy top with principal moments of inertia 1, 10, 100 kg m², {} steps of {STEP} s",
        grouped(STEPS)
    )?;
    console.flush()?;

    let mut summaries = Vec::new();
    let mut written = Vec::new();
    for retraction in Retraction::COMMON {
        let job = Job {
            method: Method::Standard,
            retraction,
            order: Order::Two,
            step: STEP,
            steps: STEPS,
            rest: 0.0,
        };
        let plan = Plan {
            system: SYSTEM.to_owned(),
            description: None,
            setup: setup.clone(),
            job,
            columns: Vec::new(),
            every: EVERY,
            quantity: Vec::new(),
            until: None,
            moments: Default::default(),
            watch: true,
            format: Some(Format::Csv),
            plot: false,
            html: None,
            out: out.clone(),
            pause: 10.0,
            force: arguments.force,
            inputs: Vec::new(),
        };
        let done = Session::begin(entry, plan, None)?.run(&OutputMode::default().on(console, false)?)?;
        written.extend(done.written);
        if done.interrupted {
            return Err(Error::Interrupted);
        }
        let time_per_step = time_per_step(entry, &setup, &job)?;
        summaries.push(RunSummary { time_per_step, ..done.summary });
    }
    write!(console, "\n{}\n", table(entry, &summaries))?;
    for (drawing, guard) in figure {
        let drawn = drawing.write(out, &guard)?;
        written.extend(drawn.written);
        for paragraph in drawn.caption {
            writeln!(console, "{paragraph}")?;
        }
    }
    for path in written {
        writeln!(console, "wrote {}", path.display())?;
    }
    writeln!(console, "`coadjoint figures` draws all figures, `coadjoint list` shows what else there is")?;
    Ok(())
}
