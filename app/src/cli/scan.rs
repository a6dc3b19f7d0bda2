//! `coadjoint run --scan`: one run for each value of a parameter or two, in parallel.

use std::ops::ControlFlow;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use comfy_table::CellAlignment;
use rayon::prelude::*;
use serde_json::{Value, json};

use super::console::Console;
use super::interrupt;
use super::motion::{Motion, MotionArguments};
use super::progress::Progress;
use super::report::laid_out;
use super::run::RunArguments;
use crate::catalogue::Entry;
use crate::error::{Error, RunError};
use crate::files::{OverwriteGuard, PlannedFile, Provenance, by_name, file_in, invariants, is_stdout, table};
use crate::record::ConservationReport;
use crate::setup::{Names, Scan};
use crate::simulate::{simulate, stepper, threads};
use crate::units::{grouped, magnitude, short, with_unit, wrapped};

/// Columns that a terminal has.
const WIDTH: usize = 80;

/// The result of one run.
struct Row {
    values: Vec<f64>,
    outcome: Result<Outcome, String>,
}

struct Outcome {
    conservation: ConservationReport,
    iterations: f64,
    ns_per_step: f64,
    end: Vec<f64>,
}

/// Makes all runs; prints a table and writes it.
pub(super) fn scan(
    motion: &Motion<'_>,
    asked: &[String],
    arguments: &RunArguments,
    console: &mut Console<'_>,
) -> Result<(), Error> {
    let Motion { entry, job, setup, .. } = motion;
    let scans = asked.iter().map(|text| Scan::parse(entry, text)).collect::<Result<Vec<_>, _>>()?;
    let points = Scan::grid(&scans)?;
    // else all of them would fail in the same way
    stepper(entry, entry.system(&setup.parameters), job)?;
    let threads = threads::start()?;
    let MotionArguments { out, force, .. } = &arguments.chosen.motion;
    let run = Provenance { scan: asked.to_owned(), ..Provenance::of_run(entry, setup, job, 1) };
    let file = file_in(out, &format!("{}.csv", run.stem(entry, job)));
    let guard = OverwriteGuard::new(run.origin(entry), *force);
    guard.check_all(&[PlannedFile { what: "the table", path: file.clone(), written: true }])?;
    interrupt::listen();
    let start = Instant::now();
    let count = points.len() as u64;
    let rows = rows(motion, &scans, points, console.progress(&entry.name, count, "run"));
    let seconds = start.elapsed().as_secs_f64();
    if interrupt::requested() {
        return Err(Error::Interrupted);
    }
    guard.write_all(&[(file.clone(), table(&records(entry, &scans, &rows)))])?;
    let written = Some(file).filter(|file| !is_stdout(file));
    let notes = console.notes().to_vec();
    console.object(|| {
        let described = |row: &Row| object(entry, &scans, row);
        let mut object = Value::Object(run.fields());
        object["steps"] = motion.job.steps.into();
        object["runs"] = rows.iter().map(described).collect();
        object["notes"] = notes.into();
        object["written"] = written.iter().map(|path| path.display().to_string()).collect();
        object
    })?;
    let words = console.words();
    write!(words, "{}", shown(entry, &scans, &rows))?;
    writeln!(
        words,
        "{} runs of {} steps in {seconds:.2} s on {threads} threads",
        grouped(rows.len() as u64),
        grouped(job.steps)
    )?;
    if let Some(path) = &written {
        writeln!(words, "wrote {}", path.display())?;
    }
    match rows.iter().find_map(|row| row.outcome.as_ref().err()) {
        Some(first) if rows.iter().all(|row| row.outcome.is_err()) => {
            Err(RunError::NoneLeft { count: rows.len(), what: "runs", first: first.clone() }.into())
        }
        _ => Ok(()),
    }
}

/// Makes the runs, in the order of the points.
fn rows(motion: &Motion<'_>, scans: &[Scan], points: Vec<Vec<f64>>, progress: Progress) -> Vec<Row> {
    let progress = Mutex::new(progress);
    let finished = AtomicU64::new(0);
    let row = |values: Vec<f64>| {
        let outcome = one(motion, scans, &values).map_err(|error| error.to_string());
        let count = finished.fetch_add(1, Ordering::Relaxed) + 1;
        // whoever shows it now, shows enough
        if let Ok(mut progress) = progress.try_lock() {
            progress.show(count);
        }
        Row { values, outcome }
    };
    points.into_par_iter().map(row).collect()
}

/// Makes one run.
fn one(motion: &Motion<'_>, scans: &[Scan], values: &[f64]) -> Result<Outcome, Error> {
    let Motion { entry, changes, job, .. } = motion;
    let mut changes = changes.clone();
    for (scan, value) in scans.iter().zip(values) {
        changes.assign(Names::All, &scan.name, &[*value])?;
    }
    let (setup, _) = changes.finish()?;
    let (mut conservation, mut end) = (None, Vec::new());
    let start = Instant::now();
    let report = simulate(entry, &setup, job, None, &|index| index + 1, &mut |sample| {
        conservation.get_or_insert_with(|| ConservationReport::new(sample)).push(sample);
        if sample.index == job.steps {
            end = sample.state.to_vec();
        }
        if interrupt::requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    })?;
    let ns_per_step = start.elapsed().as_secs_f64() * 1e9 / job.steps.max(1) as f64;
    let conservation = conservation.ok_or(Error::Interrupted)?;
    Ok(Outcome { conservation, iterations: report.iterations_per_step(), ns_per_step, end })
}

impl Outcome {
    /// Lists the errors of energy and Casimirs.
    fn errors(&self) -> impl Iterator<Item = f64> + '_ {
        let Self { conservation, .. } = self;
        std::iter::once(&conservation.energy).chain(&conservation.casimirs).map(|stats| stats.error)
    }
}

/// The names and units of the errors.
fn conserved(entry: &Entry) -> Vec<(&'static str, &'static str)> {
    std::iter::once(("energy", entry.unit("energy"))).chain(entry.casimirs()).collect()
}

/// Lays out the table for the terminal: the columns that fit.
fn shown(entry: &Entry, scans: &[Scan], rows: &[Row]) -> String {
    let mut columns: Vec<(String, Vec<String>)> = Vec::new();
    for (i, scan) in scans.iter().enumerate() {
        let cells = rows.iter().map(|row| short(row.values[i])).collect();
        columns.push((with_unit(&scan.name, scan.unit), cells));
    }
    let of = |name: String, cell: &dyn Fn(&Outcome) -> String| {
        let cells = rows.iter().map(|row| row.outcome.as_ref().map_or_else(|_| "–".to_owned(), cell));
        (name, cells.collect::<Vec<_>>())
    };
    for (i, (name, unit)) in conserved(entry).into_iter().enumerate() {
        let cell = |outcome: &Outcome| magnitude(outcome.errors().nth(i).unwrap_or(f64::NAN));
        columns.push(of(with_unit(&format!("error of {name}"), unit), &cell));
    }
    columns.push(of("iterations".to_owned(), &|outcome| format!("{:.2}", outcome.iterations)));
    columns.push(of("ns/step".to_owned(), &|outcome| format!("{:.0}", outcome.ns_per_step)));
    // as many columns as fit
    let width = |(name, cells): &(String, Vec<String>)| {
        cells.iter().chain([name]).map(|cell| cell.chars().count()).max().unwrap_or(0) + 2
    };
    let mut taken = 0;
    let fit = columns.iter().map(width).take_while(|width| {
        taken += width;
        taken <= WIDTH + 2
    });
    let fit = fit.count();
    columns.truncate(fit);
    let header = columns.iter().map(|(name, _)| name.clone()).collect();
    let line = |i: usize| columns.iter().map(|(_, cells)| cells[i].clone()).collect();
    let table =
        laid_out(std::iter::once(header).chain((0..rows.len()).map(line)).collect(), CellAlignment::Right);
    let mut text = String::new();
    // below the header and its line
    for (i, line) in table.lines().enumerate() {
        text += &format!("{line}\n");
        if let Some(Row { outcome: Err(reason), .. }) = i.checked_sub(2).and_then(|i| rows.get(i)) {
            text += &format!("    {}\n", wrapped(reason, 74).join("\n    "));
        }
    }
    text
}

/// All of it: values, errors, iterations, times, the end state, the reason of a failure.
fn records(entry: &Entry, scans: &[Scan], rows: &[Row]) -> Vec<Vec<String>> {
    let mut header: Vec<String> = scans.iter().map(|scan| scan.name.clone()).collect();
    header.extend(conserved(entry).into_iter().map(|(name, _)| format!("error of {name}")));
    header.extend(["iterations per step", "ns per step"].map(str::to_owned));
    let columns = entry.columns();
    let ends = &columns[1..columns.len() - 1];
    header.extend(ends.iter().map(|column| format!("end {column}")));
    header.push("failure".to_owned());
    let record = |row: &Row| {
        let mut record: Vec<String> = row.values.iter().map(|value| format!("{value:?}")).collect();
        match &row.outcome {
            Ok(outcome) => {
                let numbers = outcome.errors().chain([outcome.iterations, outcome.ns_per_step]);
                record.extend(numbers.chain(outcome.end.iter().copied()).map(|number| format!("{number:?}")));
                record.push(String::new());
            }
            Err(reason) => {
                record.resize(header.len() - 1, String::new());
                record.push(reason.clone());
            }
        }
        record
    };
    std::iter::once(header.clone()).chain(rows.iter().map(record)).collect()
}

/// A run of the scan as a JSON object.
fn object(entry: &Entry, scans: &[Scan], row: &Row) -> Value {
    let mut object = json!({});
    for (scan, value) in scans.iter().zip(&row.values) {
        object["values"][&scan.name] = json!(value);
    }
    match &row.outcome {
        Ok(outcome) => {
            let Outcome { conservation, iterations, ns_per_step, end } = outcome;
            object["invariants"] = invariants(entry, conservation);
            object["iterations_per_step"] = json!(iterations);
            object["ns_per_step"] = json!(ns_per_step);
            object["end"] = by_name(entry.description.state, end).into();
        }
        Err(reason) => object["failure"] = json!(reason),
    }
    object
}
