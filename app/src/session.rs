//! A run of the program: its plan, the recorders it feeds, and the files it writes at the end.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use coadjoint::erased;
use serde::{Deserialize, Serialize};

use crate::checkpoint::{self, Journal};
use crate::conservation::ConservationReport;
use crate::entry::{Catalogue, Entry};
use crate::error::Error;
use crate::interrupt;
use crate::output::{Format, Trajectory, name};
use crate::page::HtmlPlayer;
use crate::progress::Progress;
use crate::run_plot::RunPlot;
use crate::simulation::{Checkpoint, Job, Method, Order, Sample, Setup};

/// The time between two checkpoints.
const PAUSE: Duration = Duration::from_secs(10);
/// Reading the clock costs more than a step: it is read once in this many.
const INTERVAL: u64 = 1024;

/// The plan of a run.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Plan {
    /// The system's name.
    pub system: String,
    /// Parameters and initial state.
    pub setup: Setup,
    /// How far to go, and how.
    pub job: Job,
    /// Write the state after every so many steps.
    pub every: u64,
    /// The format of the trajectory; none writes none.
    pub format: Option<Format>,
    /// Whether to draw the run.
    pub plot: bool,
    /// Where to write the page that shows it moving.
    pub html: Option<PathBuf>,
    /// The directory to write to.
    pub out: PathBuf,
}

/// What has been recorded so far.
#[derive(Debug, Default, Serialize, Deserialize)]
struct Record {
    /// Begins with the first sample.
    conservation: Option<ConservationReport>,
    /// How far the configuration was off its group, at most.
    off_group: f64,
    run_plot: Option<RunPlot>,
    html_player: Option<HtmlPlayer>,
}

/// The content of a checkpoint file: all that is needed to resume a run.
#[derive(Debug, Serialize, Deserialize)]
struct CheckpointFile {
    plan: Plan,
    record: Record,
    rows: u64,
    checkpoint: Checkpoint,
    /// What the steps depend on besides: the program's version, and the system's description.
    version: u32,
}

impl CheckpointFile {
    /// Whether it fits this system: all lists have the required lengths.
    fn fits(&self, entry: &Entry) -> bool {
        let Setup { parameters, state, controls } = entry.example.clone();
        let Self { plan, record, checkpoint, .. } = self;
        plan.setup.parameters.len() == parameters.len()
            && plan.setup.controls.len() == controls.len()
            && plan.every > 0
            && [&plan.setup.state, &checkpoint.state].iter().all(|list| list.len() == state.len())
            && record.run_plot.as_ref().is_none_or(|run_plot| run_plot.is_of(entry))
            && record.html_player.as_ref().is_none_or(|html_player| html_player.is_of(entry))
    }
}

/// A run in progress.
pub struct Session {
    entry: &'static Entry,
    system: Box<dyn erased::System>,
    plan: Plan,
    record: Record,
    rows: Rows,
    from: Option<Checkpoint>,
    checkpoint_path: Option<PathBuf>,
}

/// The destination of the trajectory's rows.
#[derive(Debug)]
enum Rows {
    /// Nowhere.
    Discarded,
    /// Into the file.
    File(Trajectory),
    /// To be put into the file at the end.
    Journal(Journal),
}

/// A finished or interrupted run.
#[derive(Debug)]
pub struct FinishedRun {
    /// Of which system.
    pub entry: &'static Entry,
    /// How it was planned.
    pub plan: Plan,
    /// How well energy and Casimirs were kept.
    pub conservation: ConservationReport,
    /// How far the configuration was off its group, at most.
    pub off_group: f64,
    /// Newton iterations and the like, of the steps since it was started or resumed.
    pub report: coadjoint::RunReport,
    /// The files that it wrote.
    pub written: Vec<PathBuf>,
    /// Ctrl-C ended it.
    pub interrupted: bool,
}

impl Session {
    /// Starts a run; with a checkpoint file, one that can be resumed later.
    pub fn begin(catalogue: Catalogue, plan: Plan, checkpoint_path: Option<PathBuf>) -> Result<Self, Error> {
        let entry = catalogue.system(&plan.system)?;
        let rows = match (&checkpoint_path, plan.format) {
            (Some(path), _) if path.exists() => {
                return Err(Error::Input(format!(
                    "{0} exists already: `coadjoint resume {0}` resumes it",
                    path.display()
                )));
            }
            (_, None) => Rows::Discarded,
            (Some(path), Some(_)) => Rows::Journal(Journal::create(Journal::beside(path), width(entry))?),
            (None, Some(format)) => {
                Rows::File(Trajectory::create(&plan.out, format, entry, &plan.setup, &plan.job)?)
            }
        };
        let record = Record {
            conservation: None,
            off_group: 0.0,
            run_plot: plan.plot.then(|| RunPlot::new(entry, &plan.job)),
            html_player: plan.html.is_some().then(|| HtmlPlayer::new(entry, &plan.job)),
        };
        let system = entry.system(&plan.setup.parameters);
        Ok(Self { entry, system, plan, record, rows, from: None, checkpoint_path })
    }

    /// Resumes a run from its checkpoint file.
    pub fn resume(catalogue: Catalogue, path: &Path) -> Result<Self, Error> {
        let file: CheckpointFile = checkpoint::load(path)?;
        let entry = catalogue.system(&file.plan.system)?;
        if file.version != version(entry) {
            return Err(Error::Input(format!(
                "{} was made by another version of coadjoint, whose steps may differ in their last digits: \
                 use that version, or start again",
                path.display()
            )));
        }
        if !file.fits(entry) {
            return Err(Error::Input(format!("{} is a damaged checkpoint", path.display())));
        }
        let CheckpointFile { plan, record, rows, checkpoint, .. } = file;
        let rows = match plan.format {
            Some(_) => Rows::Journal(Journal::resume(Journal::beside(path), width(entry), rows)?),
            None => Rows::Discarded,
        };
        let (system, checkpoint_path) = (entry.system(&plan.setup.parameters), Some(path.to_owned()));
        Ok(Self { entry, system, plan, record, rows, from: Some(checkpoint), checkpoint_path })
    }

    /// Whether the trajectory goes to standard output.
    pub(crate) fn is_for_stdout(&self) -> bool {
        crate::output::path::is_stdout(&self.plan.out)
    }

    /// Runs to the end, and writes the output.
    pub fn run(mut self) -> Result<FinishedRun, Error> {
        interrupt::listen();
        let (entry, from) = (self.entry, self.from.take());
        let Plan { setup, job, .. } = self.plan.clone();
        let mut progress = Progress::new(entry.name, job.steps);
        let mut saved = Instant::now();
        // a resumed run has recorded its first sample before
        let mut is_new = from.is_none();
        let mut failure = None;
        // `every` thins what is written and nothing else: an error's peak may be as short as one step, so every step is recorded
        let next = |index: u64| index + 1;
        let report = entry.simulate(&setup, &job, from.as_ref(), &next, &mut |sample| {
            progress.at(sample.index);
            let pushed = if is_new { self.push(sample) } else { Ok(()) };
            is_new = true;
            let stop = interrupt::requested() && sample.index < job.steps;
            let due = sample.index.is_multiple_of(INTERVAL) && saved.elapsed() > PAUSE;
            let result = pushed.and_then(|()| {
                if self.checkpoint_path.is_some() && (stop || due) {
                    self.save(sample)?;
                    saved = Instant::now();
                }
                Ok(())
            });
            failure = result.err();
            if stop || failure.is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })?;
        if let Some(failure) = failure {
            return Err(failure);
        }
        drop(progress);
        self.finish(report)
    }

    fn push(&mut self, sample: &Sample<'_>) -> Result<(), Error> {
        let Record { conservation, off_group, run_plot, html_player } = &mut self.record;
        conservation.get_or_insert_with(|| ConservationReport::new(sample)).push(sample);
        *off_group = off_group.max(self.system.deviation(sample.state));
        if let Some(run_plot) = run_plot {
            run_plot.push(self.entry, sample);
        }
        if let Some(html_player) = html_player {
            html_player.push(sample);
        }
        if sample.index.is_multiple_of(self.plan.every) {
            let mut row = Vec::with_capacity(sample.state.len() + 2);
            row.push(sample.time);
            row.extend(sample.state);
            row.push(sample.energy);
            match &mut self.rows {
                Rows::Discarded => {}
                Rows::File(trajectory) => trajectory.row(&row)?,
                Rows::Journal(journal) => journal.row(&row)?,
            }
        }
        Ok(())
    }

    fn save(&mut self, sample: &Sample<'_>) -> Result<(), Error> {
        let Some(path) = &self.checkpoint_path else { return Ok(()) };
        let rows = if let Rows::Journal(journal) = &mut self.rows { journal.sync()? } else { 0 };
        let file = CheckpointFile {
            plan: self.plan.clone(),
            record: std::mem::take(&mut self.record),
            rows,
            checkpoint: Checkpoint::at(sample),
            version: version(self.entry),
        };
        checkpoint::save(path, &file)?;
        self.record = file.record;
        Ok(())
    }

    fn finish(self, report: coadjoint::RunReport) -> Result<FinishedRun, Error> {
        let Self { entry, plan, record, rows, checkpoint_path, .. } = self;
        let Some(conservation) = record.conservation else {
            return Err(Error::Input("the run has no samples".to_owned()));
        };
        let Plan { setup, job, out, .. } = &plan;
        let mut written = Vec::new();
        match (rows, plan.format) {
            (Rows::File(trajectory), _) => written.push(trajectory.finish(&conservation)?),
            (Rows::Journal(mut journal), Some(format)) => {
                let mut trajectory = Trajectory::create(out, format, entry, setup, job)?;
                journal.replay(|row| trajectory.row(row))?;
                written.push(trajectory.finish(&conservation)?);
            }
            _ => {}
        }
        if let Some(run_plot) = &record.run_plot {
            crate::output::make_directory(out)?;
            let figure = run_plot.figure(entry, title(entry, job));
            written.extend(figure.write(&out.join(name(entry, job)))?);
        }
        if let (Some(html_player), Some(path)) = (&record.html_player, &plan.html) {
            html_player.write(path, entry, &plan)?;
            written.push(path.clone());
        }
        let interrupted = conservation.steps < job.steps;
        if let (Some(path), false) = (&checkpoint_path, interrupted) {
            checkpoint::remove(path);
        }
        let off_group = record.off_group;
        Ok(FinishedRun { entry, plan, conservation, off_group, report, written, interrupted })
    }
}

/// Of a row: time, the state's components, energy.
fn width(entry: &Entry) -> usize {
    entry.columns().len()
}

/// A checksum of all that the digits of a step depend on.
fn version(entry: &Entry) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    hasher.update(env!("CARGO_PKG_VERSION").as_bytes());
    hasher.update(entry.source.as_bytes());
    hasher.finalize()
}

/// The title of a run's plot: `heavy_top, midpoint, cayley, order 4, h = 0.01 s`
pub fn title(entry: &Entry, job: &Job) -> String {
    let mut parts = vec![entry.name.to_owned()];
    if job.method != Method::Standard {
        parts.push(job.method.to_string());
    }
    if job.method.classical().is_none() {
        parts.push(job.retraction.name().to_owned());
    }
    if job.order != Order::Two {
        parts.push(format!("order {}", job.order.number()));
    }
    parts.push(format!("h = {} s", job.step));
    parts.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulation::Retraction;
    use crate::test_systems::catalogue;

    fn checkpoint_file(of: &str) -> CheckpointFile {
        let entry = catalogue().system(of).expect("it is there");
        let setup = entry.example.clone();
        let job = Job {
            method: Method::Standard,
            retraction: Retraction::Cayley,
            order: Order::Two,
            step: 0.01,
            steps: 10,
        };
        let record = Record {
            conservation: None,
            off_group: 0.0,
            run_plot: Some(RunPlot::new(entry, &job)),
            html_player: Some(HtmlPlayer::new(entry, &job)),
        };
        let checkpoint = Checkpoint { state: setup.state.clone(), memory: Vec::new() };
        let out = PathBuf::from("out");
        let plan =
            Plan { system: of.to_owned(), setup, job, every: 1, format: None, plot: true, html: None, out };
        CheckpointFile { plan, record, rows: 0, checkpoint, version: version(entry) }
    }

    #[test]
    fn a_checkpoint_that_was_tampered_with_is_damaged() {
        let path = std::env::temp_dir().join(format!("coadjoint-tampered-{}.ck", std::process::id()));
        let resumed = |tamper: &dyn Fn(&mut CheckpointFile)| {
            let mut file = checkpoint_file("heavy_top");
            tamper(&mut file);
            checkpoint::save(&path, &file).expect("writable");
            let resumed = Session::resume(catalogue(), &path);
            checkpoint::remove(&path);
            resumed.map(|_| ()).map_err(|error| error.to_string())
        };
        assert_eq!(resumed(&|_| {}), Ok(()));
        let damaged = Err(format!("{} is a damaged checkpoint", path.display()));
        assert_eq!(resumed(&|file| file.plan.every = 0), damaged);
        assert_eq!(resumed(&|file| file.plan.setup.parameters.truncate(1)), damaged);
        assert_eq!(resumed(&|file| file.plan.setup.state.push(0.0)), damaged);
        assert_eq!(resumed(&|file| file.checkpoint.state.clear()), damaged);
        assert_eq!(
            resumed(&|file| file.record.run_plot = checkpoint_file("kepler").record.run_plot),
            damaged
        );
    }
}
