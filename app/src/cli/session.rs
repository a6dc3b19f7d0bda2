//! A run of the program: its plan, the files it claims, the recorders it feeds, and the files it writes at the end.

use std::cell::Cell;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use coadjoint::RunReport;
use coadjoint::erased;
use serde::{Deserialize, Serialize};

use super::console::Console;
use super::description::described;
use super::interrupt;
use super::progress::Progress;
use super::report::RunSummary;
use crate::catalogue::{Catalogue, Entry};
use crate::error::{Error, FileError, SetupError};
use crate::files::{
    CheckpointStore, NewFile, OverwriteGuard, PlannedFile, Provenance, Status, TrajectoryWriter, Written,
    digest, file_in, is_stdout, rows_of, table,
};
use crate::page::{PageHeading, page};
use crate::picture::{Kind, run_figure};
use crate::record::{Curves, PageRecorder, RecordedEvent, Recorders};
use crate::scene;
use crate::setup::{Column, Format, Job, Moments, Setup, Until, observables};
use crate::simulate::{
    Checkpoint, ErrorEstimate, Sample, Seen, Within, beyond_series, conserves_energy, energy_size,
    error_estimate, simulate_within, slowed,
};

/// Reading the clock costs more than a step: it is read once in this many.
const INTERVAL: u64 = 1024;

/// The plan of a run.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Plan {
    /// The system's name.
    pub system: String,
    /// The file that describes it, if it is none of the program's.
    pub description: Option<PathBuf>,
    /// Parameters and initial state.
    pub setup: Setup,
    /// Scheme, step and number of steps.
    pub job: Job,
    /// Steps between two rows; the last state has one too.
    pub every: u64,
    /// Further columns of the trajectory.
    pub columns: Vec<Column>,
    /// Quantities of a user's own, as expressions.
    pub quantity: Vec<String>,
    /// What ends it: a condition, at the moment from which on it holds, or an event of the description.
    pub until: Option<String>,
    /// What is looked at within its steps.
    pub moments: Moments,
    /// Whether every step is looked at, whatever is written.
    pub watch: bool,
    /// The format of the trajectory; none writes none.
    pub format: Option<Format>,
    /// Whether to draw the run.
    pub plot: bool,
    /// The page that shows it moving.
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
    /// Describes what makes the files of the run.
    pub fn provenance(&self, entry: &Entry) -> Provenance {
        // where every step is written, every step is looked at
        let watch = self.watch && self.every != 1;
        let (columns, quantity, until) = (self.columns.clone(), self.quantity.clone(), self.until.clone());
        let Moments { at, every_seconds, event } = self.moments.clone();
        Provenance {
            watch,
            columns,
            quantity,
            until,
            at,
            every_seconds,
            event,
            ..Provenance::of_run(entry, &self.setup, &self.job, self.every)
        }
    }

    /// Names the columns of the trajectory.
    fn columns(&self, entry: &Entry) -> Result<Vec<String>, SetupError> {
        let further = self.columns.iter().map(|column| column.names(entry));
        let further = further.collect::<Result<Vec<_>, _>>()?;
        Ok([entry.columns(), further.concat()].concat())
    }
}

/// The files that a run writes beside its page.
#[derive(Clone, Debug)]
struct RunFiles {
    trajectory: Option<(Format, PathBuf)>,
    /// The table of its events.
    events: Option<PathBuf>,
    pictures: Vec<(Kind, PathBuf)>,
}

/// The content of a checkpoint: all that is needed to resume a run.
#[derive(Debug, Serialize, Deserialize)]
struct Saved<P = Plan, R = Recorders> {
    plan: P,
    /// A checksum of the program's version, the system's description, and its first steps.
    version: u32,
    recorders: R,
    /// None before the first step.
    checkpoint: Option<Checkpoint>,
}

/// A run in progress.
pub struct Session {
    entry: Entry,
    system: Arc<dyn erased::System>,
    plan: Plan,
    files: RunFiles,
    guard: OverwriteGuard,
    recorders: Recorders,
    rows: Rows,
    from: Option<Checkpoint>,
    /// The last sample's state.
    end: Vec<f64>,
    /// Whether its condition ended it.
    ended: bool,
}

/// The destination of the trajectory's rows.
enum Rows {
    /// Nowhere.
    Discarded,
    /// Into the file.
    File(TrajectoryWriter),
    /// To be put into the file at the end.
    Checkpoint(CheckpointStore),
}

/// A finished or interrupted run.
#[derive(Debug)]
pub struct FinishedRun {
    /// Its system.
    pub entry: Entry,
    /// Its plan.
    pub plan: Plan,
    /// The findings of the steps since it was started or resumed; none is timed.
    pub summary: RunSummary,
    /// The files that it wrote.
    pub written: Vec<PathBuf>,
    /// Whether Ctrl-C ended it.
    pub interrupted: bool,
    /// Notes for people.
    pub notes: Vec<String>,
}

impl Session {
    /// Starts a run; with a checkpoint file, one that can be resumed later. All its files are looked at first: none
    /// takes the place of another.
    ///
    /// # Errors
    /// If that is not so, or a file cannot be written.
    pub fn begin(entry: &Entry, plan: Plan, checkpoint: Option<&Path>) -> Result<Self, Error> {
        // before there is a file that a signal could leave behind
        interrupt::listen();
        let entry = &observed(entry, &plan)?;
        let columns = plan.columns(entry)?;
        plan.html.as_ref().map_or(Ok(()), |_| scene::check(entry, &plan.setup.parameters))?;
        let (files, guard) = claimed(entry, &plan, checkpoint)?;
        let (step, steps) = (plan.job.step, plan.job.total());
        // of what is drawn, the last one of times that were asked for
        let drawn = plan.moments.times(&plan.job)?.map_or(steps, |times| times.count().saturating_sub(1));
        let step =
            if drawn == steps { step } else { plan.job.duration().copysign(step) / drawn.max(1) as f64 };
        let curves = plan.plot.then(|| Curves::new(entry, (step, drawn)));
        let recorders = Recorders::of(curves, plan.html.is_some().then(|| PageRecorder::new(drawn)));
        let rows = match (checkpoint, &files.trajectory) {
            (Some(path), _) => {
                let saved = saved(entry, &plan, &recorders, None);
                Rows::Checkpoint(CheckpointStore::begin(path, columns, &saved)?)
            }
            (None, Some((format, path))) => {
                Rows::File(TrajectoryWriter::create(path, *format, columns, guard.origin())?)
            }
            (None, None) => Rows::Discarded,
        };
        let system = entry.system(&plan.setup.parameters);
        let (entry, end) = (entry.clone(), plan.setup.state.clone());
        Ok(Self { entry, system, plan, files, guard, recorders, rows, from: None, end, ended: false })
    }

    /// Resumes a run from its checkpoint. The file that describes its system is this one, or the one that it began with.
    ///
    /// # Errors
    /// If it is in use, is not what was written, is of other steps than those taken here, the system's description cannot be read, or a
    /// file of the run cannot be written.
    pub fn resume(catalogue: &Catalogue, path: &Path, description: Option<&Path>) -> Result<Self, Error> {
        interrupt::listen();
        let (store, saved) = CheckpointStore::open::<Saved>(path)?;
        let Saved { plan, recorders, checkpoint: from, version } = saved;
        let file = description.or(plan.description.as_deref());
        let described = file.map(|file| described(file, Some(&plan.system))).transpose()?;
        let entry = match &described {
            Some(entry) => entry,
            None => catalogue.system(&plan.system)?,
        };
        let lengths = |setup: &Setup| (setup.parameters.len(), setup.state.len(), setup.controls.len());
        if lengths(&plan.setup) != lengths(&entry.example) || version != self::version(entry, &plan) {
            let what = "was made by another version of the program or the system, whose steps may differ in their \
                        last digits: use that version, or start again";
            return Err(FileError::damaged(path, what).into());
        }
        let entry = &observed(entry, &plan)?;
        let (files, guard) = claimed(entry, &plan, Some(path))?;
        let system = entry.system(&plan.setup.parameters);
        let (entry, end) = (entry.clone(), plan.setup.state.clone());
        let rows = Rows::Checkpoint(store);
        Ok(Self { entry, system, plan, files, guard, recorders, rows, from, end, ended: false })
    }

    /// Tells whether the trajectory goes to standard output.
    pub(crate) fn is_for_stdout(&self) -> bool {
        is_stdout(&self.plan.out)
    }

    /// Makes the run, shows its progress, and writes its files. Ctrl-C ends it.
    ///
    /// # Errors
    /// If a step cannot be taken, or a file not be written.
    pub fn run(mut self, console: &Console<'_>) -> Result<FinishedRun, Error> {
        let mut progress = console.progress(&self.entry.name, self.plan.job.total(), "step");
        let report = self.simulate(&mut progress)?;
        drop(progress);
        self.write(report)
    }

    /// Takes the steps and records them.
    fn simulate(&mut self, progress: &mut Progress) -> Result<RunReport, Error> {
        let (entry, from) = (self.entry.clone(), self.from.take());
        let (setup, job) = (self.plan.setup.clone(), self.plan.job);
        let pause = Duration::try_from_secs_f64(self.plan.pause).unwrap_or_default();
        let mut saved = Instant::now();
        // a resumed run has recorded its first sample before
        let mut is_new = from.is_none();
        let mut failure = None;
        // an error's peak may be as short as one step, but to look at a step takes several times as long as the step
        let until = self.plan.until.as_deref().map(|text| Until::parse(&entry, text)).transpose()?;
        let events = self.plan.moments.events(&entry)?;
        let times = self.plan.moments.times(&job)?;
        let is_watched = self.plan.watch || until.is_some() || times.is_some();
        let interval = if is_watched { 1 } else { self.plan.every };
        let next = |index: u64| {
            let after = |interval: u64| (index / interval + 1).saturating_mul(interval);
            after(interval).min(after(INTERVAL))
        };
        let ended = Cell::new(false);
        let until_event = until.as_ref().map(|until| &until.event);
        let within = Within { until: until_event, events: &events, times: times.as_ref(), ended: &ended };
        let simulated =
            simulate_within(&entry, &setup, &job, from.as_ref(), &next, &within, &mut |seen, sample| {
                match seen {
                    Seen::Step => {}
                    Seen::Time => {
                        failure = self.save_moment(sample).err();
                        return if failure.is_some() {
                            ControlFlow::Break(())
                        } else {
                            ControlFlow::Continue(())
                        };
                    }
                    Seen::Event(event, crossing) => {
                        let (name, row) = (event.name().to_owned(), self.row(sample));
                        let crossing = RecordedEvent::word(crossing);
                        self.recorders.events.push(RecordedEvent { name, crossing, time: sample.time, row });
                        return ControlFlow::Continue(());
                    }
                }
                let is_due = sample.index.is_multiple_of(INTERVAL);
                if is_due {
                    progress.show(sample.index);
                }
                // at the start, or by a jump
                let controls = &sample.numbers[sample.state.len()..];
                let condition = until.as_ref().and_then(|until| until.condition.as_ref());
                let holds = condition.is_some_and(|condition| {
                    condition.value(&*self.system, sample.state, sample.time, controls) != 0.0
                });
                ended.set(ended.get() || holds);
                self.ended = ended.get();
                let pushed = if is_new { self.push(sample) } else { Ok(()) };
                is_new = true;
                let stop = interrupt::requested() && sample.index < job.total();
                if self.ended || sample.index == job.total() {
                    self.end.copy_from_slice(sample.state);
                }
                let result = pushed.and_then(|()| {
                    if stop || (is_due && saved.elapsed() > pause) {
                        self.save(sample)?;
                        saved = Instant::now();
                    }
                    Ok(())
                });
                failure = failure.take().or(result.err());
                if stop || self.ended || failure.is_some() {
                    ControlFlow::Break(())
                } else {
                    ControlFlow::Continue(())
                }
            });
        if let Some(failure) = failure {
            return Err(failure);
        }
        if simulated.is_err()
            && let Rows::Checkpoint(store) = std::mem::replace(&mut self.rows, Rows::Discarded)
        {
            // resumed, it would fail again
            store.remove();
        }
        Ok(simulated?)
    }

    /// Records a step, and writes it, where steps are written.
    fn push(&mut self, sample: &Sample<'_>) -> Result<(), Error> {
        self.recorders.watch(&*self.system, sample);
        if self.plan.moments.are_rows() {
            return Ok(());
        }
        self.recorders.show(&self.entry, &*self.system, sample);
        let is_last = self.ended || sample.index == self.plan.job.total();
        if sample.index.is_multiple_of(self.plan.every) || is_last { self.write_row(sample) } else { Ok(()) }
    }

    /// Records and writes the state at a time that was asked for.
    fn save_moment(&mut self, sample: &Sample<'_>) -> Result<(), Error> {
        // they are counted for themselves
        let sample = &Sample { index: self.recorders.saved, ..*sample };
        self.recorders.saved += 1;
        self.recorders.show(&self.entry, &*self.system, sample);
        self.write_row(sample)
    }

    fn row(&self, sample: &Sample<'_>) -> Vec<f64> {
        let mut row = sample.row(&self.entry);
        let (state, controls) = (sample.state, &sample.numbers[sample.state.len()..]);
        for column in &self.plan.columns {
            column.push((&self.entry, &*self.system), (state, sample.time, controls), &mut row);
        }
        row
    }

    fn write_row(&mut self, sample: &Sample<'_>) -> Result<(), Error> {
        if matches!(self.rows, Rows::Discarded) {
            return Ok(());
        }
        let row = self.row(sample);
        match &mut self.rows {
            Rows::Discarded => {}
            Rows::File(trajectory) => trajectory.row(&row)?,
            Rows::Checkpoint(store) => store.row(&row)?,
        }
        Ok(())
    }

    fn save(&mut self, sample: &Sample<'_>) -> Result<(), Error> {
        if let Rows::Checkpoint(store) = &mut self.rows {
            let checkpoint = Some(Checkpoint::at(sample));
            store.save(&saved(&self.entry, &self.plan, &self.recorders, checkpoint))?;
        }
        Ok(())
    }

    /// Writes the trajectory, the pictures and the page.
    fn write(self, report: RunReport) -> Result<FinishedRun, Error> {
        let Self { entry, mut plan, files, guard, mut recorders, rows, end, ended, .. } = self;
        let Some(conservation) = recorders.conservation.take() else {
            return Err(SetupError::new("the run has no samples").into());
        };
        let (steps, time) = (conservation.steps, conservation.time);
        let interrupted = (steps < plan.job.total() && !ended).then_some(steps);
        if let (true, Some(curves)) = (ended, &mut recorders.curves) {
            curves.span = (time.min(0.0), time.max(0.0));
        }
        if ended {
            // what is said of the run is said of the steps that it took
            plan.job = ended_at(&plan.job, steps, time);
        }
        let mut contents = Vec::new();
        let mut store = None;
        match (rows, &files.trajectory) {
            (Rows::File(trajectory), _) => {
                contents.push(trajectory.finish(&entry, &conservation, interrupted)?)
            }
            (Rows::Checkpoint(mut rows), Some((format, path))) => {
                let columns = plan.columns(&entry)?;
                let mut trajectory = TrajectoryWriter::create(path, *format, columns, guard.origin())?;
                rows.replay(|row| trajectory.row(row))?;
                contents.push(trajectory.finish(&entry, &conservation, interrupted)?);
                store = Some(rows);
            }
            _ => {}
        }
        if let Some(path) = &files.events {
            contents
                .push((path.clone(), NewFile::with(path, &event_table(&entry, &plan, &recorders.events)?)?));
        }
        contents.extend(shown(&entry, &plan, steps, &recorders, &files)?);
        let status = interrupted.map_or(Status::Complete, Status::Interrupted);
        let estimate = match interrupted {
            None => error_estimate(&entry, &plan.setup, &plan.job, &interrupt::requested)?,
            Some(_) => None,
        };
        let guard = guard.with_error_estimate(estimate.as_ref().map(ErrorEstimate::words));
        let guard = guard.with_end(ended.then_some((steps, time)));
        let Written { files: written, kept } = guard.put(contents, status)?;
        if let (Some(store), None) = (store, interrupted) {
            store.remove();
        }
        let states: Vec<_> = recorders.some.states().chain([(time, end.clone())]).collect();
        let too_far = [
            slowed(&entry, &plan.setup, &plan.job, (time, &end)),
            beyond_series(&entry, &plan.setup, &plan.job, &states),
        ];
        let kept = kept.iter().map(|path| format!("{} holds the whole run, and stays", path.display()));
        let is_event = |until: &str| Until::parse(&entry, until).is_ok_and(|until| until.condition.is_none());
        let until = plan.until.iter().map(|until| match (is_event(until), ended) {
            (false, true) => format!("`{until}` holds from {time} s on, in step {steps}: there the run ends"),
            (false, false) => format!("`{until}` holds after none of {steps} steps"),
            (true, true) => format!("`{until}` comes at {time} s, in step {steps}: there the run ends"),
            (true, false) => format!("`{until}` comes in none of {steps} steps"),
        });
        let notes = kept.chain(too_far.into_iter().flatten()).chain(until).collect();
        let events = recorders.events;
        let off_group = recorders.off_group;
        let conserves_energy = conserves_energy(&entry, &plan.setup, (time, &end));
        let energy_size = energy_size(&entry, &plan.setup, (time, &end));
        let summary = RunSummary {
            job: plan.job,
            report,
            conservation,
            estimate,
            conserves_energy,
            energy_size,
            off_group,
            time_per_step: None,
            events,
        };
        Ok(FinishedRun { entry, plan, summary, written, interrupted: interrupted.is_some(), notes })
    }
}

/// The steps of a run that ended at a time within the last of them.
fn ended_at(job: &Job, steps: u64, time: f64) -> Job {
    let whole = steps.saturating_sub(1);
    let rest = time.abs() - whole as f64 * job.step.abs();
    // no more than roundoff
    let is_whole = (rest - job.step.abs()).abs() <= 4.0 * f64::EPSILON * (time.abs() + job.step.abs());
    if steps == 0 || is_whole { Job { steps, rest: 0.0, ..*job } } else { Job { steps: whole, rest, ..*job } }
}

/// A table of events: its first columns name them, the others are those of the trajectory.
fn event_table(entry: &Entry, plan: &Plan, events: &[RecordedEvent]) -> Result<Vec<u8>, SetupError> {
    let header = ["event", "crossing"].map(str::to_owned).into_iter().chain(plan.columns(entry)?);
    let mut records: Vec<Vec<String>> = vec![header.collect()];
    for RecordedEvent { name, crossing, row, .. } in events {
        let numbers = row.iter().map(|number| format!("{number:?}"));
        records.push([name.clone(), crossing.clone()].into_iter().chain(numbers).collect());
    }
    Ok(table(&records))
}

/// Adds the quantities asked for to those of the system, and looks at the condition.
fn observed(entry: &Entry, plan: &Plan) -> Result<Entry, SetupError> {
    let own = observables(entry, &plan.quantity)?;
    let is_known = |column: &&String| own.iter().any(|own| own.name == **column);
    if let Some(name) = entry.columns().iter().find(is_known) {
        return Err(SetupError::new(format!(
            "`{name}` is a column already: name it otherwise, as in `own = {name}`"
        )));
    }
    let entry = entry.clone().with_observables(own);
    plan.until.as_deref().map_or(Ok(()), |text| Until::parse(&entry, text).map(|_| ()))?;
    plan.moments.events(&entry)?;
    plan.moments.times(&plan.job)?;
    Ok(entry)
}

/// Lists the files of a run, looked at before it starts, and what guards them.
fn claimed(
    entry: &Entry,
    plan: &Plan,
    checkpoint: Option<&Path>,
) -> Result<(RunFiles, OverwriteGuard), Error> {
    if is_stdout(&plan.out) && plan.plot {
        return Err(SetupError::new("`--plot` writes pictures: `--out` has to name a directory").into());
    }
    let run = plan.provenance(entry);
    let stem = run.stem(entry, &plan.job);
    let place = |extension: &str| file_in(&plan.out, &format!("{stem}.{extension}"));
    let trajectory = plan.format.map(|format| (format, place(format.extension())));
    let kinds = if plan.plot { Kind::ALL } else { &[] };
    let pictures: Vec<_> = kinds.iter().map(|kind| (*kind, place(kind.extension()))).collect();

    let has_events = trajectory.is_some() && !plan.moments.event.is_empty() && !is_stdout(&plan.out);
    let events = has_events.then(|| place("events.csv"));

    let file = |what, path: &Path, written| PlannedFile { what, path: path.to_owned(), written };
    let inputs = plan.inputs.iter().map(|path| file("what describes the run", path, false));
    let mut planned: Vec<PlannedFile> = inputs.collect();
    planned.extend(checkpoint.map(|path| file("the checkpoint", path, false)));
    planned.extend(checkpoint.map(|path| file("the checkpoint's rows", &rows_of(path), false)));
    planned.extend(trajectory.iter().map(|(_, path)| file("the trajectory", path, true)));
    planned.extend(events.iter().map(|path| file("the table of events", path, true)));
    planned.extend(plan.html.iter().map(|path| file("the page", path, true)));
    planned.extend(pictures.iter().map(|(_, path)| file("the picture", path, true)));
    let guard = OverwriteGuard::new(run.origin(), plan.force);
    guard.check_all(&planned)?;
    Ok((RunFiles { trajectory, events, pictures }, guard))
}

/// Collects what a run is to be resumed with.
fn saved<'a>(
    entry: &Entry,
    plan: &'a Plan,
    recorders: &'a Recorders,
    checkpoint: Option<Checkpoint>,
) -> Saved<&'a Plan, &'a Recorders> {
    Saved { plan, version: version(entry, plan), recorders, checkpoint }
}

/// Writes pictures and the page, not yet in their places.
fn shown(
    entry: &Entry,
    plan: &Plan,
    steps: u64,
    recorders: &Recorders,
    files: &RunFiles,
) -> Result<Vec<(PathBuf, NewFile)>, FileError> {
    let Plan { setup, job, .. } = plan;
    let mut shown = Vec::new();
    if let (Some(recorder), Some(path)) = (&recorders.page, &plan.html) {
        let (title, parameters) = (job.title(entry), &setup.parameters[..]);
        let heading = PageHeading { title, parameters, step: job.step, steps };
        let html = page(recorder, entry, &heading).to_html();
        shown.push((path.clone(), NewFile::with(path, html.as_bytes())?));
    }
    if let Some(curves) = &recorders.curves {
        let figure = run_figure(curves, entry, job.title(entry));
        for (kind, path) in &files.pictures {
            shown.push((path.clone(), NewFile::with(path, &figure.picture(*kind))?));
        }
    }
    Ok(shown)
}

/// Computes a checksum of all that the digits of a step depend on: also of the first steps, as a system's text may not
/// be known.
fn version(entry: &Entry, plan: &Plan) -> u32 {
    let mut hasher = crc32fast::Hasher::new();
    hasher.update(env!("CARGO_PKG_VERSION").as_bytes());
    hasher.update(entry.source.as_bytes());
    hasher.update(&digest(entry, &plan.setup, &plan.job).to_le_bytes());
    hasher.finalize()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::setup::{Method, Order, Retraction};
    use crate::tests::catalogue;

    fn file(of: &str) -> Saved {
        let entry = catalogue().system(of).expect("it is there");
        let setup = entry.example.clone();
        let job = Job {
            method: Method::Standard,
            retraction: Retraction::Cayley,
            order: Order::Two,
            step: 0.01,
            steps: 10,
            rest: 0.0,
        };
        let recorders = Recorders::of(Some(Curves::new(entry, (0.01, 10))), Some(PageRecorder::new(10)));
        let checkpoint = Some(Checkpoint { state: setup.state.clone(), memory: Vec::new() });
        let plan = Plan {
            system: of.to_owned(),
            description: None,
            setup,
            job,
            every: 1,
            columns: Vec::new(),
            quantity: Vec::new(),
            until: None,
            moments: Moments::default(),
            watch: true,
            format: None,
            plot: true,
            html: None,
            out: std::env::temp_dir(),
            pause: 10.0,
            force: false,
            inputs: Vec::new(),
        };
        Saved { version: version(entry, &plan), plan, recorders, checkpoint }
    }

    #[test]
    fn a_checkpoint_of_other_steps_is_refused() {
        let path = std::env::temp_dir().join(format!("coadjoint-other-{}.ck", std::process::id()));
        let resumed = |change: &dyn Fn(&mut Saved)| {
            let mut file = self::file("heavy_top");
            change(&mut file);
            drop(CheckpointStore::begin(&path, Vec::new(), &file).expect("writable"));
            let resumed = Session::resume(catalogue(), &path, None);
            let _ = std::fs::remove_file(&path);
            let _ = std::fs::remove_file(rows_of(&path));
            resumed.map(|_| ()).map_err(|error| error.to_string())
        };
        assert_eq!(resumed(&|_| {}), Ok(()));
        // a system with other quantities, and one with another potential, of whatever text
        let changes: [&dyn Fn(&mut Saved); 3] = [
            &|file| file.plan.setup.parameters.truncate(1),
            &|file| file.plan.setup.state.push(0.0),
            &|file| file.plan.setup.parameters[3] = 2.0,
        ];
        for change in changes {
            let other = resumed(change).expect_err("other steps");
            assert!(other.contains("another version of the program or the system"), "{other}");
        }
    }
}
