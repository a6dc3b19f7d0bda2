//! One run for each value of a number or two, in parallel.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use rayon::prelude::*;

use super::simulate;
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
    pub(crate) iterations: f64,
    pub(crate) ns_per_step: f64,
    pub(crate) end: Vec<f64>,
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
        let mut changes = changes.clone();
        let assigned = scans
            .iter()
            .zip(&values)
            .try_for_each(|(scan, value)| changes.assign(Names::ALL, &scan.name, &[*value]));
        let outcome = assigned.map_err(Error::from).and_then(|()| one(entry, changes, job, stop));
        progress(finished.fetch_add(1, Ordering::Relaxed) + 1);
        ScanRow { values, outcome: outcome.map_err(|error| error.to_string()) }
    };
    points.into_par_iter().map(row).collect()
}

/// Makes one run.
fn one(
    entry: &Entry,
    changes: Changes<'_>,
    job: &Job,
    stop: &(dyn Fn() -> bool + Sync),
) -> Result<Outcome, Error> {
    let (setup, _) = changes.finish()?;
    let (mut conservation, mut end) = (None, Vec::new());
    let start = Instant::now();
    let report = simulate(entry, &setup, job, None, &|index| index + 1, &mut |sample| {
        conservation.get_or_insert_with(|| ConservationReport::new(sample)).push(sample);
        if sample.index == job.steps {
            end = sample.state.to_vec();
        }
        if stop() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    })?;
    let ns_per_step = start.elapsed().as_secs_f64() * 1e9 / job.steps.max(1) as f64;
    let conservation = conservation.ok_or(Error::Interrupted)?;
    Ok(Outcome { conservation, iterations: report.iterations_per_step(), ns_per_step, end })
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
