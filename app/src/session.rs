//! A run of the program: its plan, the recorders it feeds, and the files it writes at the end.

mod files;

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use coadjoint::erased;
use serde::{Deserialize, Serialize};

use self::files::{Files, prepared, shown};
use crate::checkpoint::Store;
use crate::conservation::ConservationReport;
use crate::entry::{Catalogue, Entry};
use crate::error::Error;
use crate::interrupt;
use crate::output::{Format, Guard, TrajectoryWriter};
use crate::page::HtmlPlayer;
use crate::progress::Progress;
use crate::provenance::{self, Provenance};
use crate::report::exact;
use crate::run_plot::RunPlot;
use crate::simulation::{Checkpoint, Job, Method, Order, Sample, Setup, SimulationError};

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
    /// The directory to write to; `-` writes the trajectory to the standard output.
    pub out: PathBuf,
    /// The time between two checkpoints, s.
    pub pause: f64,
    /// Whether files of other runs may be replaced.
    pub force: bool,
    /// Files that were read, and are not to be replaced.
    pub inputs: Vec<PathBuf>,
}

impl Plan {
    /// What makes the files of the run.
    pub fn provenance(&self, entry: &Entry) -> Provenance {
        Provenance::of_run(entry, &self.setup, &self.job, self.every)
    }
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
    /// What the steps depend on besides: the program's version, the system's description, and what it computes.
    version: u32,
    record: Record,
    /// None before the first step.
    checkpoint: Option<Checkpoint>,
}

impl CheckpointFile {
    /// Whether it fits this system: all lists have the required lengths.
    fn fits(&self, entry: &Entry) -> bool {
        let Setup { parameters, state, controls } = entry.example.clone();
        let Self { plan, record, checkpoint, .. } = self;
        let states = checkpoint.iter().map(|checkpoint| &checkpoint.state).chain([&plan.setup.state]);
        plan.setup.parameters.len() == parameters.len()
            && plan.setup.controls.len() == controls.len()
            && plan.every > 0
            && states.into_iter().all(|list| list.len() == state.len())
            && record.run_plot.as_ref().is_none_or(|run_plot| run_plot.is_of(entry))
            && record.html_player.as_ref().is_none_or(|html_player| html_player.is_of(entry))
    }

    /// The system's entry, if the run can be resumed here.
    fn entry(&self, catalogue: Catalogue, path: &Path) -> Result<&'static Entry, Error> {
        let damaged = |what: &str| Error::Damaged { path: path.to_owned(), what: what.to_owned() };
        let entry = catalogue.system(&self.plan.system)?;
        if !self.fits(entry) {
            return Err(damaged("is a damaged checkpoint"));
        }
        if self.version != version(entry, &self.plan) {
            return Err(damaged(
                "was made by another version of the program or the system, whose steps may differ in their last \
                 digits: use that version, or start again",
            ));
        }
        Ok(entry)
    }
}

/// A run in progress.
pub struct Session {
    entry: &'static Entry,
    system: Arc<dyn erased::System>,
    plan: Plan,
    files: Files,
    guard: Guard,
    record: Record,
    rows: Rows,
    from: Option<Checkpoint>,
}

/// The destination of the trajectory's rows.
#[derive(Debug)]
enum Rows {
    /// Nowhere.
    Discarded,
    /// Into the file.
    File(TrajectoryWriter),
    /// To be put into the file at the end.
    Journal(Store),
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
    /// Starts a run; with a checkpoint file, one that can be resumed later. All its files are looked at first: none takes the place of another.
    ///
    /// # Errors
    /// If that is not so, or a file cannot be written.
    pub fn begin(catalogue: Catalogue, plan: Plan, checkpoint_path: Option<PathBuf>) -> Result<Self, Error> {
        interrupt::listen();
        let entry = catalogue.system(&plan.system)?;
        let (files, guard) = prepared(entry, &plan, checkpoint_path.as_deref())?;
        let record = Record {
            conservation: None,
            off_group: 0.0,
            run_plot: plan.plot.then(|| RunPlot::new(entry, &plan.job)),
            html_player: plan.html.is_some().then(|| HtmlPlayer::new(entry, &plan.job)),
        };
        let (plan, record, rows) = match (checkpoint_path, plan.format, &files.trajectory) {
            (Some(path), ..) => {
                let version = version(entry, &plan);
                let file = CheckpointFile { plan, version, record, checkpoint: None };
                let store = Store::begin(&path, width(entry), &file)?;
                (file.plan, file.record, Rows::Journal(store))
            }
            (None, Some(format), Some(path)) => {
                let trajectory = TrajectoryWriter::create(path, format, entry, &guard)?;
                (plan, record, Rows::File(trajectory))
            }
            _ => (plan, record, Rows::Discarded),
        };
        let system = entry.system(&plan.setup.parameters);
        Ok(Self { entry, system, plan, files, guard, record, rows, from: None })
    }

    /// Resumes a run from its checkpoint file.
    ///
    /// # Errors
    /// If it is in use, is not what was written, or a file of the run cannot be written.
    pub fn resume(catalogue: Catalogue, path: &Path) -> Result<Self, Error> {
        interrupt::listen();
        let wide = |file: &CheckpointFile| file.entry(catalogue, path).map(width);
        let (store, file) = Store::open(path, wide)?;
        let CheckpointFile { plan, record, checkpoint, .. } = file;
        let entry = catalogue.system(&plan.system)?;
        let (files, guard) = prepared(entry, &plan, Some(path))?;
        let (system, rows) = (entry.system(&plan.setup.parameters), Rows::Journal(store));
        Ok(Self { entry, system, plan, files, guard, record, rows, from: checkpoint })
    }

    /// Whether the trajectory goes to standard output.
    pub(crate) fn is_for_stdout(&self) -> bool {
        crate::output::path::is_stdout(&self.plan.out)
    }

    /// Runs to the end, and writes the output.
    pub fn run(mut self) -> Result<FinishedRun, Error> {
        let (entry, from) = (self.entry, self.from.take());
        let pause = Duration::try_from_secs_f64(self.plan.pause).unwrap_or_default();
        let Plan { setup, job, .. } = self.plan.clone();
        let mut progress = Progress::new(entry.name, job.steps);
        let mut saved = Instant::now();
        // a resumed run has recorded its first sample before
        let mut is_new = from.is_none();
        let mut failure = None;
        // `every` thins what is written and nothing else: an error's peak may be as short as one step, so every step is recorded
        let next = |index: u64| index + 1;
        let simulated = entry.simulate(&setup, &job, from.as_ref(), &next, &mut |sample| {
            progress.at(sample.index);
            let pushed = if is_new { self.push(sample) } else { Ok(()) };
            is_new = true;
            let stop = interrupt::requested() && sample.index < job.steps;
            let due = sample.index.is_multiple_of(INTERVAL) && saved.elapsed() > pause;
            let result = pushed.and_then(|()| {
                if stop || due {
                    self.save(sample)?;
                    saved = Instant::now();
                }
                Ok(())
            });
            failure = result.err();
            if stop || failure.is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        if let Some(failure) = failure {
            return Err(failure);
        }
        drop(progress);
        match simulated {
            Ok(report) => self.finish(report),
            Err(failure) => Err(self.give_up(failure)),
        }
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
                Rows::Journal(store) => store.row(&row)?,
            }
        }
        Ok(())
    }

    fn save(&mut self, sample: &Sample<'_>) -> Result<(), Error> {
        let Rows::Journal(store) = &mut self.rows else { return Ok(()) };
        let file = CheckpointFile {
            plan: self.plan.clone(),
            version: version(self.entry, &self.plan),
            record: std::mem::take(&mut self.record),
            checkpoint: Some(Checkpoint::at(sample)),
        };
        let saved = store.save(&file);
        self.record = file.record;
        saved
    }

    /// Ends a run that cannot be computed: resumed, it would fail again.
    fn give_up(self, failure: SimulationError) -> Error {
        if let Rows::Journal(store) = self.rows {
            store.remove();
        }
        failure.into()
    }

    fn finish(self, report: coadjoint::RunReport) -> Result<FinishedRun, Error> {
        let Self { entry, plan, files, guard, mut record, rows, .. } = self;
        let Some(conservation) = record.conservation.take() else {
            return Err(Error::Input("the run has no samples".to_owned()));
        };
        let interrupted = (conservation.steps < plan.job.steps).then_some(conservation.steps);
        let files = files.without_complete(&guard, interrupted.is_some());
        let mut written = Vec::new();
        let mut store = None;
        match (rows, &files.trajectory) {
            (Rows::File(trajectory), Some(_)) => written.push(trajectory.finish(&conservation, interrupted)?),
            (Rows::Journal(mut journal), path) => {
                if let (Some(format), Some(path)) = (plan.format, path) {
                    let mut trajectory = TrajectoryWriter::create(path, format, entry, &guard)?;
                    journal.replay(&mut |row| trajectory.row(row))?;
                    written.push(trajectory.finish(&conservation, interrupted)?);
                }
                store = Some(journal);
            }
            _ => {}
        }
        let run = guard.origin().interrupted_after(interrupted);
        for (path, content) in shown(entry, &plan, &record, &files, &run)? {
            guard.write(&path, &content)?;
            written.push(path);
        }
        if let (Some(store), None) = (store, interrupted) {
            store.remove();
        }
        let (off_group, interrupted) = (record.off_group, interrupted.is_some());
        Ok(FinishedRun { entry, plan, conservation, off_group, report, written, interrupted })
    }
}

/// Of a row: time, the state's components, energy.
fn width(entry: &Entry) -> usize {
    entry.columns().len()
}

/// A checksum of all that the digits of a step depend on: also of the first steps, as a system's text may not be known.
fn version(entry: &Entry, plan: &Plan) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    hasher.update(env!("CARGO_PKG_VERSION").as_bytes());
    hasher.update(entry.source.as_bytes());
    hasher.update(&provenance::digest(entry, &plan.setup, &plan.job).to_le_bytes());
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
    parts.push(format!("h = {} s", exact(job.step)));
    parts.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::checkpoint::beside;
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
        let checkpoint = Some(Checkpoint { state: setup.state.clone(), memory: Vec::new() });
        let plan = Plan {
            system: of.to_owned(),
            setup,
            job,
            every: 1,
            format: None,
            plot: true,
            html: None,
            out: std::env::temp_dir(),
            pause: 10.0,
            force: false,
            inputs: Vec::new(),
        };
        CheckpointFile { version: version(entry, &plan), plan, record, checkpoint }
    }

    #[test]
    fn a_checkpoint_that_was_tampered_with_is_damaged() {
        let path = std::env::temp_dir().join(format!("coadjoint-tampered-{}.ck", std::process::id()));
        let resumed = |tamper: &dyn Fn(&mut CheckpointFile)| {
            let mut file = checkpoint_file("heavy_top");
            tamper(&mut file);
            drop(Store::begin(&path, 12, &file).expect("writable"));
            let resumed = Session::resume(catalogue(), &path);
            let _ = std::fs::remove_file(&path);
            let _ = std::fs::remove_file(beside(&path, "rows"));
            resumed.map(|_| ()).map_err(|error| error.to_string())
        };
        assert_eq!(resumed(&|_| {}), Ok(()));
        let damaged = Err(format!("{} is a damaged checkpoint", path.display()));
        assert_eq!(resumed(&|file| file.plan.every = 0), damaged);
        assert_eq!(resumed(&|file| file.plan.setup.parameters.truncate(1)), damaged);
        assert_eq!(resumed(&|file| file.plan.setup.state.push(0.0)), damaged);
        assert_eq!(resumed(&|file| file.checkpoint.as_mut().expect("there").state.clear()), damaged);
        assert_eq!(
            resumed(&|file| file.record.run_plot = checkpoint_file("kepler").record.run_plot),
            damaged
        );
        // another potential, of whatever text
        let other = resumed(&|file| file.plan.setup.parameters[3] = 2.0).expect_err("other steps");
        assert!(other.contains("another version of the program or the system"), "{other}");
    }
}
