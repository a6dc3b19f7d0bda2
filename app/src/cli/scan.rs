//! `coadjoint run --scan`: one run for each value of a parameter or two, in parallel.

use std::path::PathBuf;
use std::sync::Mutex;
use std::time::Instant;

use comfy_table::CellAlignment;
use serde_json::{Value, json};

use super::console::Console;
use super::interrupt;
use super::motion::{Motion, MotionArguments};
use super::report::laid_out;
use super::run::RunArguments;
use crate::catalogue::Entry;
use crate::catalogue::quantities::components;
use crate::error::Error;
use crate::files::{OverwriteGuard, PlannedFile, Provenance, by_name, file_in, invariants, is_stdout, table};
use crate::setup::Scan;
use crate::simulate::scan::{self, Outcome, ScanRow};
use crate::simulate::{Distance, stepper, threads};
use crate::units::{exact, figures, grouped, magnitude, rounded, with_unit, wrapped};

/// Columns that a terminal has.
const WIDTH: usize = 80;

/// Makes all runs; prints a table and writes it.
pub(super) fn scan(
    motion: &Motion<'_>,
    asked: &[String],
    arguments: &RunArguments,
    console: &mut Console<'_>,
) -> Result<(), Error> {
    let Motion { entry, changes, job, setup } = motion;
    let scans = asked.iter().map(|text| Scan::parse(entry, setup.input.as_deref(), text));
    let scans = scans.collect::<Result<Vec<_>, _>>()?;
    let points = Scan::grid(&scans)?;
    // else all of them would fail in the same way
    stepper(entry, entry.system(&setup.parameters), setup.input.clone(), job)?;
    let threads = threads::start()?;
    let MotionArguments { out, force, .. } = &arguments.chosen.motion;
    let run = Provenance { scan: asked.to_owned(), ..Provenance::of_run(entry, setup, job, 1) };
    let file = file_in(out, &format!("{}.csv", run.stem(entry, job)));
    let guard = OverwriteGuard::new(run.origin(), *force);
    guard.check_all(&[PlannedFile { what: "the table", path: file.clone(), written: true }])?;
    interrupt::listen();
    let start = Instant::now();
    let count = points.len() as u64;
    let progress = Mutex::new(console.progress(&entry.name, count, "run"));
    // whoever shows it now, shows enough
    let show = |count| progress.try_lock().into_iter().for_each(|mut progress| progress.show(count));
    let rows = scan::scan((entry, changes, job), &scans, points, &show, &interrupt::requested);
    drop(progress);
    let seconds = start.elapsed().as_secs_f64();
    if interrupt::requested() {
        return Err(Error::Interrupted);
    }
    guard.write_all(&[(file.clone(), table(&records(entry, &scans, &rows)))])?;
    let written: Vec<PathBuf> = Some(file).into_iter().filter(|file| !is_stdout(file)).collect();
    console.summary(&written, || {
        let described = |row: &ScanRow| object(entry, &scans, row);
        let mut object = Value::Object(run.fields());
        object["runs"] = rows.iter().map(described).collect();
        object
    })?;
    let words = console.words();
    write!(words, "{}", shown(entry, &scans, &rows))?;
    let runs = match rows.len() {
        1 => "1 run".to_owned(),
        many => format!("{} runs", grouped(many as u64)),
    };
    let length = match scans.iter().any(|scan| scan.is_step) {
        true => format!("{} s", exact(job.duration())),
        false => format!("{} steps", grouped(job.total())),
    };
    writeln!(words, "{runs} of {length} in {seconds:.2} s on {threads} threads")?;
    console.wrote(&written)?;
    Ok(scan::none_left(&rows)?)
}

/// The names and units of the errors.
fn errors(entry: &Entry, rows: &[ScanRow]) -> Vec<(String, &'static str)> {
    let is_conserved = rows.iter().flat_map(|row| &row.outcome).all(|outcome| outcome.conserves_energy);
    let energy = if is_conserved { "error of energy" } else { "change of energy" };
    let casimirs = entry.casimirs().map(|(name, unit)| (format!("error of {name}"), unit));
    std::iter::once((energy.to_owned(), entry.energy_unit)).chain(casimirs).collect()
}

/// Lays out the table for the terminal: the columns that fit.
fn shown(entry: &Entry, scans: &[Scan], rows: &[ScanRow]) -> String {
    let mut columns: Vec<(String, Vec<String>)> = Vec::new();
    for (i, scan) in scans.iter().enumerate() {
        let cells = rows.iter().map(|row| rounded(row.values[i])).collect();
        columns.push((with_unit(&scan.name, scan.unit), cells));
    }
    let of = |name: String, cell: &dyn Fn(&Outcome) -> String| {
        let cells = rows.iter().map(|row| row.outcome.as_ref().map_or_else(|_| "–".to_owned(), cell));
        (name, cells.collect::<Vec<_>>())
    };
    for (i, (name, unit)) in errors(entry, rows).into_iter().enumerate() {
        let cell = |outcome: &Outcome| magnitude(outcome.errors().nth(i).unwrap_or(f64::NAN));
        columns.push(of(with_unit(&name, unit), &cell));
    }
    if scans.iter().any(|scan| scan.is_step) {
        let cell = |outcome: &Outcome| match &outcome.difference {
            Some(Distance { distance, .. }) if *distance == 0.0 => "0".to_owned(),
            Some(difference) => difference.words(),
            None => "–".to_owned(),
        };
        let time = of("time, s".to_owned(), &|outcome| figures(outcome.seconds, 2));
        columns.splice(scans.len()..scans.len(), [of("end state off by".to_owned(), &cell), time]);
    }
    columns.push(of("iterations".to_owned(), &|outcome| format!("{:.2}", outcome.iterations)));
    columns.push(of("ns/step".to_owned(), &|outcome| format!("{:.0}", outcome.ns_per_step)));
    // as many columns as fit
    let width = |(name, cells): &(String, Vec<String>)| {
        cells.iter().chain([name]).map(|cell| cell.chars().count()).max().unwrap_or(0) + 2
    };
    let mut taken = 0;
    columns.retain(|column| {
        taken += width(column);
        taken <= WIDTH + 2
    });
    let header = columns.iter().map(|(name, _)| name.clone()).collect();
    let line = |i: usize| columns.iter().map(|(_, cells)| cells[i].clone()).collect();
    let table =
        laid_out(std::iter::once(header).chain((0..rows.len()).map(line)).collect(), CellAlignment::Right);
    let mut text = String::new();
    // below the header and its line
    for (i, line) in table.lines().enumerate() {
        text += &format!("{line}\n");
        if let Some(ScanRow { outcome: Err(reason), .. }) = i.checked_sub(2).and_then(|i| rows.get(i)) {
            text += &format!("    {}\n", wrapped(reason, 74).join("\n    "));
        }
    }
    text
}

/// All of it: values, errors, iterations, times, the end state, the reason of a failure.
fn records(entry: &Entry, scans: &[Scan], rows: &[ScanRow]) -> Vec<Vec<String>> {
    let mut header: Vec<String> = scans.iter().map(|scan| scan.name.clone()).collect();
    header.extend(errors(entry, rows).into_iter().map(|(name, _)| name));
    let is_step = scans.iter().any(|scan| scan.is_step);
    header.extend(
        ["difference of end state", "its unit"].iter().filter(|_| is_step).map(|name| (*name).to_owned()),
    );
    header.extend(["seconds", "iterations per step", "ns per step"].map(str::to_owned));
    header.extend(components(entry.description.state).map(|component| format!("end {}", component.name)));
    header.push("failure".to_owned());
    let record = |row: &ScanRow| {
        let mut record: Vec<String> = row.values.iter().map(|value| format!("{value:?}")).collect();
        match &row.outcome {
            Ok(outcome) => {
                let written = |number: f64| format!("{number:?}");
                record.extend(outcome.errors().map(written));
                let difference = outcome.difference.iter();
                record.extend(
                    difference.flat_map(|difference| [written(difference.distance), difference.unit()]),
                );
                let costs = [outcome.seconds, outcome.iterations, outcome.ns_per_step];
                record.extend(costs.into_iter().chain(outcome.end.iter().copied()).map(written));
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
fn object(entry: &Entry, scans: &[Scan], row: &ScanRow) -> Value {
    let mut object = json!({});
    for (scan, value) in scans.iter().zip(&row.values) {
        object["values"][&scan.name] = json!(value);
    }
    match &row.outcome {
        Ok(outcome) => {
            let Outcome { conservation, iterations, seconds, ns_per_step, end, difference, .. } = outcome;
            object["invariants"] = invariants(entry, conservation);
            object["iterations_per_step"] = json!(iterations);
            object["ns_per_step"] = json!(ns_per_step);
            object["seconds"] = json!(seconds);
            if let Some(difference) = difference {
                object["difference"] = json!(difference);
            }
            object["end"] = by_name(entry.description.state, end).into();
        }
        Err(reason) => object["failure"] = json!(reason),
    }
    object
}
