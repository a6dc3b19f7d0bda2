//! `coadjoint run`

use std::io::Write;

use crate::catalogue::{self, Entry};
use crate::cli::RunArguments;
use crate::error::Error;
use crate::output::{Trajectory, name};
use crate::portrait::Portrait;
use crate::progress::Progress;
use crate::report::{Finding, Table};
use crate::setting;
use crate::simulation::{Job, Method, Order};

pub(crate) fn run(arguments: &RunArguments, console: &mut dyn Write) -> Result<(), Error> {
    let entry = catalogue::find(&arguments.system)?;
    let mut setup = (entry.example)();
    let mut notes = setting::apply(entry, &mut setup, &arguments.set)?;
    let (job, note) = job(entry, arguments)?;
    notes.extend(note);
    for note in notes {
        writeln!(console, "note: {note}")?;
    }

    let mut trajectory = Trajectory::create(&arguments.out, arguments.format, entry, &setup, &job)?;
    let mut portrait = arguments.plot.then(|| Portrait::new(entry, &job));
    let mut progress = Progress::new(entry.name, job.steps);
    let outcome = (entry.simulate)(&setup, &job, &mut |sample| {
        progress.at(sample.index);
        if let Some(portrait) = &mut portrait {
            portrait.push(sample);
        }
        if sample.index.is_multiple_of(arguments.every) { trajectory.row(sample) } else { Ok(()) }
    })?;
    drop(progress);
    let path = trajectory.finish(&outcome)?;

    let time_per_step = (entry.time_per_step)(&setup, &job)?;
    write!(console, "{}", Table::new(entry, vec![Finding { job, outcome, time_per_step }]))?;
    writeln!(console, "wrote {}", path.display())?;
    if let Some(portrait) = portrait {
        let figure = portrait.figure(title(entry, &job));
        for path in figure.write(&arguments.out.join(name(entry, &job)))? {
            writeln!(console, "wrote {}", path.display())?;
        }
    }
    Ok(())
}

/// What stands above a run's picture: `heavy_top, midpoint, cayley, order 4, h = 0.01 s`
fn title(entry: &Entry, job: &Job) -> String {
    let mut parts = vec![entry.name.to_owned()];
    if job.method != Method::Standard {
        parts.push(job.method.name().to_owned());
    }
    parts.push(job.retraction.name().to_owned());
    if job.order != Order::Two {
        parts.push(format!("order {}", job.order.number()));
    }
    parts.push(format!("h = {} s", job.step));
    parts.join(", ")
}

/// The steps to take, with a note if they do not add up to the duration asked for.
fn job(entry: &Entry, arguments: &RunArguments) -> Result<(Job, Option<String>), Error> {
    /// Beyond this, step numbers are no longer exact in f64, nor is any run ever finished.
    const MOST: f64 = 9e15;

    let step = arguments.step.unwrap_or(entry.step);
    if !(step.is_finite() && step != 0.0) {
        return Err(Error::Input(format!("`--step` must be finite and not zero, got {step}")));
    }
    let duration = arguments.duration.unwrap_or(entry.duration);
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
    let RunArguments { method, retraction, order, .. } = *arguments;
    Ok((Job { method, retraction, order, step, steps: steps as u64 }, note))
}
