//! `coadjoint` without a command: the paper's heavy top, 30 minutes of its motion with both retractions.

use std::io::Write;
use std::path::Path;

use crate::catalogue::{self, Entry};
use crate::error::Error;
use crate::output::{Format, Trajectory};
use crate::plot::{Envelope, Figure, Key, Panel, Scale, Series};
use crate::portrait::symbols;
use crate::progress::Progress;
use crate::report::{Finding, Table, grouped, with_unit};
use crate::simulation::{Job, Method, Order, Outcome, Retraction, Sample, Setup};

const SYSTEM: &str = "heavy_top";
const STEP: f64 = 0.01;
const STEPS: u64 = 180_000;
/// Trajectories of every step would fill 100 MB.
const EVERY: u64 = 10;
/// The picture shows the largest error in each of this many parts of the run.
const PARTS: usize = 450;

pub(crate) fn paper(console: &mut dyn Write) -> Result<(), Error> {
    let entry = catalogue::find(SYSTEM)?;
    let setup = (entry.example)();
    let directory = Path::new("out");
    writeln!(
        console,
        "The heavy top with principal moments of inertia 1, 10, 100 kg m², {} steps of {STEP} s",
        grouped(STEPS)
    )?;
    if let Some(note) = (entry.check)(&setup)? {
        writeln!(console, "note: {note}")?;
    }
    console.flush()?;

    let mut findings = Vec::new();
    let mut courses = Vec::new();
    let mut written = Vec::new();
    for retraction in Retraction::ALL {
        let job = Job { method: Method::Standard, retraction, order: Order::Two, step: STEP, steps: STEPS };
        let mut course = Course::new(retraction, entry);
        let mut trajectory = Trajectory::create(directory, Format::Csv, entry, &setup, &job)?;
        let mut progress = Progress::new(retraction.name(), job.steps);
        let outcome = (entry.simulate)(&setup, &job, &mut |sample| {
            progress.at(sample.index);
            course.push(sample);
            if sample.index.is_multiple_of(EVERY) { trajectory.row(sample) } else { Ok(()) }
        })?;
        drop(progress);
        written.push(trajectory.finish(&outcome)?);
        findings.push(finding(entry, &setup, &job, outcome)?);
        courses.push(course);
    }
    write!(console, "\n{}\n", Table::new(entry, findings))?;
    written.extend(figure(entry, &courses).write(&directory.join(SYSTEM))?);
    for path in written {
        writeln!(console, "wrote {}", path.display())?;
    }
    Ok(())
}

fn finding(entry: &Entry, setup: &Setup, job: &Job, outcome: Outcome) -> Result<Finding, Error> {
    let time_per_step = (entry.time_per_step)(setup, job)?;
    Ok(Finding { job: *job, outcome, time_per_step })
}

/// The errors of one run over time.
struct Course {
    retraction: Retraction,
    reference: Option<(f64, Vec<f64>)>,
    energy: Envelope,
    casimirs: Vec<Envelope>,
}

impl Course {
    fn new(retraction: Retraction, entry: &Entry) -> Self {
        let envelope = Envelope::new(STEPS + 1, PARTS);
        Self {
            retraction,
            reference: None,
            energy: envelope.clone(),
            casimirs: vec![envelope; entry.casimirs.len()],
        }
    }

    fn push(&mut self, sample: &Sample<'_>) {
        let (energy, casimirs) =
            self.reference.get_or_insert_with(|| (sample.energy, sample.casimirs.to_vec()));
        self.energy.push(sample.index, sample.time, (sample.energy - *energy).abs());
        for ((envelope, now), initially) in self.casimirs.iter_mut().zip(sample.casimirs).zip(casimirs) {
            envelope.push(sample.index, sample.time, (now - *initially).abs());
        }
    }

    fn series(&self, envelope: &Envelope) -> Series {
        Series { label: self.retraction.name().to_owned(), points: envelope.upper() }
    }
}

fn figure(entry: &Entry, courses: &[Course]) -> Figure {
    let panel = |name: &str, unit: &str, envelope: &dyn Fn(&Course) -> Series| Panel {
        label: with_unit(&format!("error of {name}"), unit),
        scale: Scale::Logarithmic,
        series: courses.iter().map(envelope).collect(),
    };
    let mut panels = vec![panel("H", "J", &|course| course.series(&course.energy))];
    for (i, (name, unit)) in entry.casimirs.iter().zip(entry.casimir_units).enumerate() {
        panels.push(panel(&symbols(name), unit, &|course| course.series(&course.casimirs[i])));
    }
    Figure {
        title: format!("Heavy top, I = diag(1, 10, 100) kg m², h = {STEP} s: errors of energy and Casimirs"),
        time: format!(
            "time, s (each point is the largest error of {} s)",
            STEPS as f64 * STEP / PARTS as f64
        ),
        span: (0.0, STEPS as f64 * STEP),
        key: Key::First,
        panels,
    }
}
