//! The report of a run, for the user.

use coadjoint::RunReport;
use comfy_table::{CellAlignment, ContentArrangement, LineStyle, TableStyle};
use serde_json::{Value, json};

use crate::catalogue::{Entry, casimir};
use crate::files::{Provenance, invariants};
use crate::record::{ConservationReport, DriftStats, RecordedEvent};
use crate::setup::{Job, Method, Setup, standard};
use crate::simulate::ErrorEstimate;
use crate::units::{figures, grouped, magnitude, rounded, with_unit, with_unit_behind};

/// One run's column.
#[derive(Clone, Debug)]
pub struct RunSummary {
    /// The job.
    pub job: Job,
    /// Steps and iterations.
    pub report: RunReport,
    /// The conservation of energy and Casimirs.
    pub conservation: ConservationReport,
    /// The estimated error of the trajectory; none of a run that was interrupted.
    pub estimate: Option<ErrorEstimate>,
    /// Whether its energy is an invariant.
    pub conserves_energy: bool,
    /// How large energies of the motion are.
    pub energy_size: f64,
    /// How far the configuration was off its group, at most.
    pub off_group: f64,
    /// The time of a step without an observer, ns; none if there were no steps.
    pub time_per_step: Option<f64>,
    /// The events that came.
    pub events: Vec<RecordedEvent>,
}

impl RunSummary {
    /// The conservation of energy and Casimirs, in words.
    pub fn conclusions(&self, entry: &Entry) -> Vec<String> {
        let mut lines = Vec::new();
        let energy = &self.conservation.energy;
        lines.push(if self.conserves_energy && energy.error > 0.5 * self.energy_size {
            format!(
                "energy: lost: its error is up to {}, as large as the energy itself; take a shorter step",
                with_unit_behind(energy.error, entry.energy_unit)
            )
        } else if self.conserves_energy {
            format!("energy: {}", self.describe(energy, entry.energy_unit))
        } else if entry.description.autonomous {
            "energy: conserved only while the controls are the same".to_owned()
        } else {
            "energy: not conserved by this system".to_owned()
        });
        for ((name, unit), stats) in casimir::names(entry).zip(&self.conservation.casimirs) {
            lines.push(format!("{name}: {}", self.describe(stats, unit)));
        }
        lines.extend(self.estimate.as_ref().map(ErrorEstimate::words));
        lines
    }

    /// The moments of events, in words.
    pub fn moments(&self) -> Vec<String> {
        /// More are told by their number.
        const MOST: usize = 8;
        let mut names: Vec<&str> = Vec::new();
        for event in &self.events {
            if !names.contains(&event.name.as_str()) {
                names.push(&event.name);
            }
        }
        let told = |name: &&str| {
            let all: Vec<&RecordedEvent> = self.events.iter().filter(|event| event.name == **name).collect();
            let shown = all.iter().take(MOST).map(|event| format!("{} s ({})", event.time, event.crossing));
            let shown = shown.collect::<Vec<_>>().join(", ");
            match all.len() {
                more if more > MOST => format!("{name}: {more} times, at first {shown}"),
                _ => format!("{name}: {shown}"),
            }
        };
        names.iter().map(told).collect()
    }

    /// Describes how well a quantity was conserved.
    fn describe(&self, stats: &DriftStats, unit: &str) -> String {
        let steps = self.conservation.steps;
        // roundoff of every step, adding up like the steps of a walk, and some factor for the few operations of each
        let roundoff =
            16.0 * f64::EPSILON * (steps.max(1) as f64).sqrt() * stats.initial.abs().max(stats.error);
        let (least, greatest) = stats.range;
        if stats.error.is_nan() {
            "became not a number".to_owned()
        } else if stats.error <= roundoff {
            "kept to roundoff".to_owned()
        } else if steps < 100 {
            format!("kept to {}; too few steps for a trend", with_unit_behind(stats.error, unit))
        } else if stats.drift() < 0.5 {
            let range = format!("from {} to {}", magnitude(least), with_unit_behind(greatest, unit));
            // of a method that promises nothing a short run tells nothing of a longer one
            match self.job.method.keeps_structure() {
                true => format!("bounded: its error stays {range} and does not grow"),
                false => {
                    format!("its error is {range} in this run; the method does not keep it from growing")
                }
            }
        } else {
            format!(
                "drifts: by {} per second, or swings more slowly than this run shows",
                with_unit_behind(stats.slope(), unit)
            )
        }
    }

    /// All of it as a JSON object.
    pub(crate) fn object(&self, entry: &Entry, setup: &Setup) -> Value {
        let mut object = Provenance::of_run(entry, setup, &self.job, 1).fields();
        object.insert("steps".to_owned(), json!(self.conservation.steps));
        object.insert("time".to_owned(), json!(self.conservation.time));
        object.insert("ns_per_step".to_owned(), json!(self.time_per_step));
        object.insert("iterations_per_step".to_owned(), json!(self.report.iterations_per_step()));
        object.insert("max_iterations".to_owned(), json!(self.report.max_iterations));
        object.insert("max_residual".to_owned(), json!(self.report.max_residual));
        object.insert("off_group".to_owned(), json!(self.off_group));
        object.insert("error_estimate".to_owned(), json!(self.estimate));
        object.insert("invariants".to_owned(), invariants(entry, &self.conservation));
        object.insert("conclusions".to_owned(), json!(self.conclusions(entry)));
        if !self.events.is_empty() {
            let told = self
                .events
                .iter()
                .map(|event| json!({ "name": event.name, "crossing": event.crossing, "time": event.time }));
            object.insert("events".to_owned(), told.collect());
        }
        Value::Object(object)
    }
}

/// Lays out a table of runs of one system, with a column for each.
pub fn table(entry: &Entry, runs: &[RunSummary]) -> String {
    let mut rows: Vec<Vec<String>> = Vec::new();
    let mut row = |name: &str, cell: &dyn Fn(&RunSummary) -> String| {
        rows.push(std::iter::once(name.to_owned()).chain(runs.iter().map(cell)).collect());
    };
    let of = |energy: &str| with_unit(energy, entry.energy_unit);
    row("retraction", &|run| match run.job.method.classical() {
        None => run.job.retraction.name().to_owned(),
        Some(_) => "–".to_owned(),
    });
    row("method", &|run| match run.job.method {
        Method::Standard => format!("standard ({})", standard(entry, run.job.retraction)),
        method => method.to_string(),
    });
    row("order", &|run| run.job.order_of_step(entry).to_string());
    row("steps", &|run| grouped(run.conservation.steps));
    if runs.iter().any(|run| run.job.rest != 0.0) {
        row("last step, s", &|run| rounded(if run.job.rest == 0.0 { run.job.step } else { run.job.rest }));
    }
    row("time per step, ns", &|run| match (run.time_per_step, run.job.method.classical()) {
        (None, _) => "–".to_owned(),
        (Some(time), None) => format!("{time:.0}"),
        (Some(time), Some(_)) => format!("{time:.0} (generic)"),
    });
    row("iterations per step", &|run| format!("{:.2}", run.report.iterations_per_step()));
    let start = |run: &RunSummary| figures(run.conservation.energy.initial + 0.0, 4);
    row(&of("energy at the start"), &start);
    let error = match runs.iter().all(|run| run.conserves_energy) {
        true => of("largest energy error"),
        // forces act, or time or controls have a part in it
        false => of("largest change of energy") + " (it is not conserved)",
    };
    row(&error, &|run| magnitude(run.conservation.energy.error));
    for (i, (name, unit)) in casimir::names(entry).enumerate() {
        row(&with_unit(&format!("drift of {name}"), unit), &|run| {
            magnitude(run.conservation.casimirs.get(i).map_or(f64::NAN, |stats| stats.error))
        });
    }
    if runs.iter().any(|run| run.job.method.classical().is_some()) {
        row("largest distance from the group", &|run| magnitude(run.off_group));
    }
    laid_out(rows, CellAlignment::Left)
}

/// Lays out a table whose first row is its header; numbers stand to the right, the first column as it is asked.
pub(crate) fn laid_out(rows: Vec<Vec<String>>, first: CellAlignment) -> String {
    let mut table = comfy_table::Table::new();
    let line = LineStyle::none().fill('─').junction('─');
    table
        .load_style(TableStyle::new().header_separator(line))
        .set_content_arrangement(ContentArrangement::Disabled);
    let mut rows = rows.into_iter();
    table.set_header(rows.next().unwrap_or_default()).add_rows(rows);
    for (k, column) in table.column_iter_mut().enumerate() {
        column.set_padding((u16::from(k > 0), 0));
        column.set_cell_alignment(if k == 0 { first } else { CellAlignment::Right });
    }
    table.trim_fmt() + "\n"
}
