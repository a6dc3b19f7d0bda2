//! A trajectory as one JSON object, written as it comes:
//!
//! ```json
//! {
//!   "system": "heavy_top", "retraction": "exponential", "method": "standard", "order": 2, "step": 0.01,
//!   "parameters": {"inertia": [1.0, 10.0, 100.0], "weight": 1.0, "chi": [0.0, 0.0, 1.0]},
//!   "controls": {"thrust": 9.0, …},
//!   "columns": ["time", "attitude_w", …],
//!   "rows": [[0.0, 1.0, …], …],
//!   "invariants": {"energy": {"initial": …, "largest_error": …, "slope": …}, …}
//! }
//! ```
//!
//! Controls are there where any are held in place of the system's own law, and null where it chooses; the retraction is null for a classical method.

use std::io::{self, Write as _};

use coadjoint::system::Quantity;
use serde::Serialize;
use serde_json::{Value, json};

use super::{AtomicFile, Write};
use crate::conservation::ConservationReport;
use crate::entry::Entry;
use crate::setting::laid_out;
use crate::simulation::{Classical, Job, Setup};

pub(super) struct Json {
    file: AtomicFile,
    entry: &'static Entry,
    rows: u64,
}

impl Json {
    pub(super) fn new(
        mut file: AtomicFile,
        entry: &'static Entry,
        setup: &Setup,
        job: &Job,
    ) -> io::Result<Self> {
        writeln!(file, "{{")?;
        for (name, value) in run(entry, setup, job) {
            writeln!(file, "  {}: {value},", json!(name))?;
        }
        writeln!(file, "  \"columns\": {},", json!(entry.columns()))?;
        write!(file, "  \"rows\": [")?;
        Ok(Self { file, entry, rows: 0 })
    }
}

/// The properties of a run, by name.
pub(crate) fn run(entry: &Entry, setup: &Setup, job: &Job) -> Vec<(&'static str, Value)> {
    let classical = job.method.classical();
    let mut run = vec![
        ("system", json!(entry.name)),
        // a classical method has none
        ("retraction", classical.map_or(json!(job.retraction.name()), |_| Value::Null)),
        ("method", json!(job.method.to_string())),
        ("order", json!(classical.map_or(job.order.number(), Classical::order))),
        ("step", json!(job.step)),
        ("parameters", by_name(entry.description.parameters, &setup.parameters)),
    ];
    if setup.controls.iter().any(Option::is_some) {
        // null where its own law chooses
        run.push(("controls", by_name(entry.description.controls, &setup.controls)));
    }
    run
}

/// The conservation of the invariants.
pub(crate) fn invariants(entry: &Entry, conservation: &ConservationReport) -> Value {
    let energy = entry.description.autonomous.then_some(("energy", &conservation.energy));
    let casimirs = entry.description.casimirs.iter().copied().zip(&conservation.casimirs);
    let invariants = energy.into_iter().chain(casimirs).map(|(name, stats)| {
        let stats_json =
            json!({ "initial": stats.initial, "largest_error": stats.error, "slope": stats.slope() });
        (name.to_owned(), stats_json)
    });
    Value::Object(invariants.collect())
}

pub(crate) fn by_name(quantities: &[Quantity], values: &[impl Serialize]) -> Value {
    let named = laid_out(quantities).map(|(quantity, slots)| {
        let value = match &values[slots] {
            [scalar] => json!(scalar),
            components => json!(components),
        };
        (quantity.name.to_owned(), value)
    });
    Value::Object(named.collect())
}

impl Write for Json {
    fn row(&mut self, row: &[f64]) -> io::Result<()> {
        self.file.write_all(if self.rows == 0 { b"\n    " } else { b",\n    " })?;
        self.rows += 1;
        Ok(serde_json::to_writer(&mut self.file, row)?)
    }

    fn finish(mut self: Box<Self>, conservation: &ConservationReport) -> io::Result<()> {
        let invariants = invariants(self.entry, conservation);
        writeln!(self.file, "\n  ],\n  \"invariants\": {invariants}\n}}")?;
        self.file.finish()
    }
}
