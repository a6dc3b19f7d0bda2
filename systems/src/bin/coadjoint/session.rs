//! A run as the program makes it: what is to be done, what is gathered along the way, and what is written at the end.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use crate::checkpoint::{self, Journal};
use crate::error::Error;
use crate::film::Film;
use crate::interrupt;
use crate::output::{Format, Trajectory, name};
use crate::portrait::Portrait;
use crate::progress::Progress;
use coadjoint_systems::catalogue::Entry;
use coadjoint_systems::ledger::Ledger;
use coadjoint_systems::simulation::{Job, Method, Order, Sample, Setup, Whereabouts};

/// Between two checkpoints.
const PAUSE: Duration = Duration::from_secs(10);
/// Looking at the clock costs more than a step: do so once in this many.
const INTERVAL: u64 = 1024;

/// What is to be done.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Plan {
    /// The system's name.
    pub(crate) system: String,
    /// Parameters and initial state.
    pub(crate) setup: Setup,
    /// How far to go, and how.
    pub(crate) job: Job,
    /// Write the state after every so many steps.
    pub(crate) every: u64,
    /// The format of the trajectory; none writes none.
    pub(crate) format: Option<Format>,
    /// Whether to draw the run.
    pub(crate) plot: bool,
    /// Where to write the page that shows it moving.
    pub(crate) html: Option<PathBuf>,
    /// The directory to write to.
    pub(crate) out: PathBuf,
}

/// What was gathered so far.
#[derive(Debug, Default, Serialize, Deserialize)]
struct Record {
    /// Begins with the first sample.
    ledger: Option<Ledger>,
    portrait: Option<Portrait>,
    film: Option<Film>,
}

/// All of a run that was interrupted.
#[derive(Debug, Serialize, Deserialize)]
struct Saved {
    plan: Plan,
    record: Record,
    rows: u64,
    whereabouts: Whereabouts,
    /// What the steps depend on besides: the program's version, and the system's description.
    version: u32,
}

impl Saved {
    /// Whether it is of a run of this system: whoever wrote it, its lists are as long as they must be.
    fn fits(&self, entry: &Entry) -> bool {
        let Setup { parameters, state } = (entry.example)();
        let Self { plan, record, whereabouts, .. } = self;
        plan.setup.parameters.len() == parameters.len()
            && plan.every > 0
            && [&plan.setup.state, &whereabouts.state].iter().all(|list| list.len() == state.len())
            && record.portrait.as_ref().is_none_or(|portrait| portrait.is_of(entry))
            && record.film.as_ref().is_none_or(|film| film.is_of(entry))
    }
}

/// A run that is being made.
#[derive(Debug)]
pub(crate) struct Session {
    entry: &'static Entry,
    plan: Plan,
    record: Record,
    rows: Rows,
    from: Option<Whereabouts>,
    checkpoint: Option<PathBuf>,
}

/// Where rows go as they come.
#[derive(Debug)]
enum Rows {
    /// Nowhere.
    Dropped,
    /// Into the file.
    Written(Trajectory),
    /// To be put into the file at the end.
    Kept(Journal),
}

/// A run that was made.
#[derive(Debug)]
pub(crate) struct Done {
    pub(crate) entry: &'static Entry,
    pub(crate) plan: Plan,
    pub(crate) ledger: Ledger,
    /// Newton iterations and the like, of the steps since it was begun or gone on with.
    pub(crate) report: coadjoint::RunReport,
    pub(crate) written: Vec<PathBuf>,
    /// Ctrl-C ended it.
    pub(crate) interrupted: bool,
}

impl Session {
    /// Begins a run; with a checkpoint, one that can be gone on with later.
    pub(crate) fn begin(plan: Plan, checkpoint: Option<PathBuf>) -> Result<Self, Error> {
        let entry = crate::suggest::system(&plan.system)?;
        let rows = match (&checkpoint, plan.format) {
            (Some(path), _) if path.exists() => {
                return Err(Error::Input(format!(
                    "{0} is there already: `coadjoint resume {0}` goes on with it",
                    path.display()
                )));
            }
            (_, None) => Rows::Dropped,
            (Some(path), Some(_)) => Rows::Kept(Journal::create(Journal::beside(path), width(entry))?),
            (None, Some(format)) => {
                Rows::Written(Trajectory::create(&plan.out, format, entry, &plan.setup, &plan.job)?)
            }
        };
        let record = Record {
            ledger: None,
            portrait: plan.plot.then(|| Portrait::new(entry, &plan.job)),
            film: plan.html.is_some().then(|| Film::new(entry, &plan.job)),
        };
        Ok(Self { entry, plan, record, rows, from: None, checkpoint })
    }

    /// Goes on with a run.
    pub(crate) fn resume(path: &Path) -> Result<Self, Error> {
        let saved: Saved = checkpoint::load(path)?;
        let entry = crate::suggest::system(&saved.plan.system)?;
        if saved.version != version(entry) {
            return Err(Error::Input(format!(
                "{} was made by another version of coadjoint, whose steps may differ in their last digits: \
                 go on with that one, or begin anew",
                path.display()
            )));
        }
        if !saved.fits(entry) {
            return Err(Error::Input(format!("{} is a damaged checkpoint", path.display())));
        }
        let Saved { plan, record, rows, whereabouts, .. } = saved;
        let rows = match plan.format {
            Some(_) => Rows::Kept(Journal::resume(Journal::beside(path), width(entry), rows)?),
            None => Rows::Dropped,
        };
        Ok(Self { entry, plan, record, rows, from: Some(whereabouts), checkpoint: Some(path.to_owned()) })
    }

    /// Makes the run, and writes what is to be written.
    pub(crate) fn run(mut self) -> Result<Done, Error> {
        interrupt::listen();
        let (entry, from) = (self.entry, self.from.take());
        let Plan { setup, job, .. } = self.plan.clone();
        let mut progress = Progress::new(entry.name, job.steps);
        let mut saved = Instant::now();
        // the sample that a run goes on from was seen before
        let mut is_new = from.is_none();
        let mut failure = None;
        // `every` thins what is written and nothing else: an error's peak may be as short as one step, so every step is looked at
        let next = |index: u64| index + 1;
        let report = entry.simulate(&setup, &job, from.as_ref(), &next, &mut |sample| {
            progress.at(sample.index);
            let seen = if is_new { self.push(sample) } else { Ok(()) };
            is_new = true;
            let stop = interrupt::requested() && sample.index < job.steps;
            let due = sample.index.is_multiple_of(INTERVAL) && saved.elapsed() > PAUSE;
            let kept = seen.and_then(|()| {
                if self.checkpoint.is_some() && (stop || due) {
                    self.save(sample)?;
                    saved = Instant::now();
                }
                Ok(())
            });
            failure = kept.err();
            if stop || failure.is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })?;
        if let Some(failure) = failure {
            return Err(failure);
        }
        drop(progress);
        self.finish(report)
    }

    fn push(&mut self, sample: &Sample<'_>) -> Result<(), Error> {
        let Record { ledger, portrait, film } = &mut self.record;
        ledger.get_or_insert_with(|| Ledger::new(sample)).push(sample);
        if let Some(portrait) = portrait {
            portrait.push(self.entry, sample);
        }
        if let Some(film) = film {
            film.push(sample);
        }
        if sample.index.is_multiple_of(self.plan.every) {
            let mut row = Vec::with_capacity(sample.state.len() + 2);
            row.push(sample.time);
            row.extend(sample.state);
            row.push(sample.energy);
            match &mut self.rows {
                Rows::Dropped => {}
                Rows::Written(trajectory) => trajectory.row(&row)?,
                Rows::Kept(journal) => journal.row(&row)?,
            }
        }
        Ok(())
    }

    fn save(&mut self, sample: &Sample<'_>) -> Result<(), Error> {
        let Some(path) = &self.checkpoint else { return Ok(()) };
        let rows = if let Rows::Kept(journal) = &mut self.rows { journal.sync()? } else { 0 };
        let saved = Saved {
            plan: self.plan.clone(),
            record: std::mem::take(&mut self.record),
            rows,
            whereabouts: Whereabouts::at(sample),
            version: version(self.entry),
        };
        checkpoint::save(path, &saved)?;
        self.record = saved.record;
        Ok(())
    }

    fn finish(self, report: coadjoint::RunReport) -> Result<Done, Error> {
        let Self { entry, plan, record, rows, checkpoint, .. } = self;
        let Some(ledger) = record.ledger else {
            return Err(Error::Input("the run has no moments".to_owned()));
        };
        let Plan { setup, job, out, .. } = &plan;
        let mut written = Vec::new();
        match (rows, plan.format) {
            (Rows::Written(trajectory), _) => written.push(trajectory.finish(&ledger)?),
            (Rows::Kept(mut journal), Some(format)) => {
                let mut trajectory = Trajectory::create(out, format, entry, setup, job)?;
                journal.replay(|row| trajectory.row(row))?;
                written.push(trajectory.finish(&ledger)?);
            }
            _ => {}
        }
        if let Some(portrait) = &record.portrait {
            crate::output::make_directory(out)?;
            let figure = portrait.figure(entry, title(entry, job));
            written.extend(figure.write(&out.join(name(entry, job)))?);
        }
        if let (Some(film), Some(path)) = (&record.film, &plan.html) {
            film.write(path, entry, &plan)?;
            written.push(path.clone());
        }
        let interrupted = ledger.steps < job.steps;
        if let (Some(path), false) = (&checkpoint, interrupted) {
            checkpoint::remove(path);
        }
        Ok(Done { entry, plan, ledger, report, written, interrupted })
    }
}

/// Of a row: time, the state's components, energy.
fn width(entry: &Entry) -> usize {
    entry.columns().len()
}

/// Changes with all that the digits of a step depend on.
fn version(entry: &Entry) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    hasher.update(env!("CARGO_PKG_VERSION").as_bytes());
    hasher.update(entry.source.as_bytes());
    hasher.finalize()
}

/// What stands above a run's picture: `heavy_top, midpoint, cayley, order 4, h = 0.01 s`
pub(crate) fn title(entry: &Entry, job: &Job) -> String {
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

#[cfg(test)]
mod tests {
    use super::*;
    use coadjoint_systems::simulation::Retraction;

    fn saved(of: &str) -> Saved {
        let entry = crate::suggest::system(of).expect("it is there");
        let setup = (entry.example)();
        let job = Job {
            method: Method::Standard,
            retraction: Retraction::Cayley,
            order: Order::Two,
            step: 0.01,
            steps: 10,
        };
        let record = Record {
            ledger: None,
            portrait: Some(Portrait::new(entry, &job)),
            film: Some(Film::new(entry, &job)),
        };
        let whereabouts = Whereabouts { state: setup.state.clone(), memory: Vec::new() };
        let out = PathBuf::from("out");
        let plan =
            Plan { system: of.to_owned(), setup, job, every: 1, format: None, plot: true, html: None, out };
        Saved { plan, record, rows: 0, whereabouts, version: version(entry) }
    }

    #[test]
    fn a_checkpoint_that_was_tampered_with_is_damaged() {
        let path = std::env::temp_dir().join(format!("coadjoint-tampered-{}.ck", std::process::id()));
        let resumed = |tamper: &dyn Fn(&mut Saved)| {
            let mut saved = saved("heavy_top");
            tamper(&mut saved);
            checkpoint::save(&path, &saved).expect("writable");
            let resumed = Session::resume(&path);
            checkpoint::remove(&path);
            resumed.map(|_| ()).map_err(|error| error.to_string())
        };
        assert_eq!(resumed(&|_| {}), Ok(()));
        let damaged = Err(format!("{} is a damaged checkpoint", path.display()));
        assert_eq!(resumed(&|saved| saved.plan.every = 0), damaged);
        assert_eq!(resumed(&|saved| saved.plan.setup.parameters.truncate(1)), damaged);
        assert_eq!(resumed(&|saved| saved.plan.setup.state.push(0.0)), damaged);
        assert_eq!(resumed(&|saved| saved.whereabouts.state.clear()), damaged);
        assert_eq!(resumed(&|saved| saved.record.portrait = self::saved("kepler").record.portrait), damaged);
    }
}
