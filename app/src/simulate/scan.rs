//! One run for each value of a number or two, in parallel.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use rayon::prelude::*;

use super::{Distance, conserves_energy, simulate};
use crate::catalogue::Entry;
use crate::error::{Error, RunError};
use crate::record::ConservationReport;
use crate::setup::{Changes, Job, Names, Scan};

/// A run of a scan, and its result.
pub(crate) struct ScanRow {
    /// The values of the scanned numbers.
    pub(crate) values: Vec<f64>,
    pub(crate) outcome: Result<Outcome, String>,
}

/// The result of one run.
pub(crate) struct Outcome {
    pub(crate) conservation: ConservationReport,
    pub(crate) conserves_energy: bool,
    pub(crate) iterations: f64,
    pub(crate) seconds: f64,
    pub(crate) ns_per_step: f64,
    pub(crate) start: Vec<f64>,
    pub(crate) end: Vec<f64>,
    /// Where steps are scanned, the distance of its end state from that of the shortest step, which is 0.
    pub(crate) difference: Option<Distance>,
}

impl Outcome {
    /// Lists the errors of energy and Casimirs.
    pub(crate) fn errors(&self) -> impl Iterator<Item = f64> + '_ {
        std::iter::once(&self.conservation.energy).chain(&self.conservation.casimirs).map(|stats| stats.error)
    }
}

/// Makes the runs, in the order of the points. The callback gets the number of finished ones; it may be asked whether
/// to stop.
pub(crate) fn scan(
    (entry, changes, job): (&Entry, &Changes<'_>, &Job),
    scans: &[Scan],
    points: Vec<Vec<f64>>,
    progress: &(dyn Fn(u64) + Sync),
    stop: &(dyn Fn() -> bool + Sync),
) -> Vec<ScanRow> {
    let finished = AtomicU64::new(0);
    let row = |values: Vec<f64>| {
        let (mut changes, mut job) = (changes.clone(), *job);
        let assigned = scans.iter().zip(&values).try_for_each(|(scan, &value)| match scan.is_step {
            true => Job::steps_to(job.duration(), value).map(|(steps, rest)| {
                job = Job { step: value, steps, rest, ..job };
            }),
            false => changes.assign(Names::ALL, &scan.name, &[value]),
        });
        let outcome = assigned.map_err(Error::from).and_then(|()| one(entry, changes, &job, stop));
        progress(finished.fetch_add(1, Ordering::Relaxed) + 1);
        ScanRow { values, outcome: outcome.map_err(|error| error.to_string()) }
    };
    let mut rows: Vec<ScanRow> = points.into_par_iter().map(row).collect();
    if let Some(place) = scans.iter().position(|scan| scan.is_step) {
        compare(entry, place, &mut rows);
    }
    rows
}

/// Measures the distance of each end state from that of the shortest step, where all else is the same.
fn compare(entry: &Entry, place: usize, rows: &mut [ScanRow]) {
    let others = |row: &ScanRow| {
        let mut values = row.values.clone();
        values.swap_remove(place);
        values
    };
    for i in 0..rows.len() {
        let alike = rows.iter().filter(|row| others(row) == others(&rows[i]));
        let ended = alike.filter_map(|row| Some((row.values[place].abs(), row.outcome.as_ref().ok()?)));
        let finest = ended.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, finest)| finest.end.clone());
        if let (Some(finest), Ok(outcome)) = (finest, &mut rows[i].outcome) {
            outcome.difference = Some(Distance::between(entry, [&outcome.end, &finest], &outcome.start));
        }
    }
}

/// Makes one run.
fn one(
    entry: &Entry,
    changes: Changes<'_>,
    job: &Job,
    stop: &(dyn Fn() -> bool + Sync),
) -> Result<Outcome, Error> {
    let (setup, _) = changes.finish()?;
    let (mut conservation, mut end, start_state) = (None, Vec::new(), setup.state.clone());
    let start = Instant::now();
    let report = simulate(entry, &setup, job, None, &|index| index + 1, &mut |sample| {
        conservation.get_or_insert_with(|| ConservationReport::new(sample)).push(sample);
        if sample.index == job.total() {
            end = sample.state.to_vec();
        }
        if stop() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    })?;
    let seconds = start.elapsed().as_secs_f64();
    let ns_per_step = seconds * 1e9 / job.total().max(1) as f64;
    let conservation = conservation.ok_or(Error::Interrupted)?;
    let conserves_energy = conserves_energy(entry, &setup, (conservation.time, &end));
    let (iterations, start) = (report.iterations_per_step(), start_state);
    Ok(Outcome {
        conservation,
        conserves_energy,
        iterations,
        seconds,
        ns_per_step,
        start,
        end,
        difference: None,
    })
}

/// Says that all runs failed, if they did.
pub(crate) fn none_left(rows: &[ScanRow]) -> Result<(), RunError> {
    match rows.first().map(|row| &row.outcome) {
        Some(Err(first)) if rows.iter().all(|row| row.outcome.is_err()) => {
            Err(RunError::NoneLeft { count: rows.len(), what: "runs", first: first.clone() })
        }
        _ => Ok(()),
    }
}
