//! A trajectory as one JSON object, written as it comes:
//!
//! ```json
//! {
//!   "system": "heavy_top", "retraction": "exponential", "method": "standard", "order": 2, "step": 0.01,
//!   "parameters": {"inertia": [1.0, 10.0, 100.0], "weight": 1.0, "chi": [0.0, 0.0, 1.0]},
//!   "columns": ["time", "attitude_w", …],
//!   "rows": [[0.0, 1.0, …], …],
//!   "invariants": {"energy": {"initial": …, "largest_error": …, "slope": …}, …}
//! }
//! ```

use std::io::{self, Write as _};

use serde_json::{Value, json};

use super::{AtomicFile, Write};
use crate::setting::laid_out;
use coadjoint_systems::catalogue::Entry;
use coadjoint_systems::conservation::ConservationReport;
use coadjoint_systems::simulation::{Job, Setup};

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
pub(super) fn run(entry: &Entry, setup: &Setup, job: &Job) -> [(&'static str, Value); 6] {
    [
        ("system", json!(entry.name)),
        ("retraction", json!(job.retraction.name())),
        ("method", json!(job.method.name())),
        ("order", json!(job.order.number())),
        ("step", json!(job.step)),
        ("parameters", parameters(entry, setup)),
    ]
}

/// The conservation of the invariants.
pub(super) fn invariants(entry: &Entry, conservation: &ConservationReport) -> Value {
    let energy = entry.description.autonomous.then_some(("energy", &conservation.energy));
    let casimirs = entry.description.casimirs.iter().copied().zip(&conservation.casimirs);
    let invariants = energy.into_iter().chain(casimirs).map(|(name, stats)| {
        let stats_json =
            json!({ "initial": stats.initial, "largest_error": stats.error, "slope": stats.slope() });
        (name.to_owned(), stats_json)
    });
    Value::Object(invariants.collect())
}

fn parameters(entry: &Entry, setup: &Setup) -> Value {
    let parameters = laid_out(entry.description.parameters).map(|(quantity, slots)| {
        let value = match &setup.parameters[slots] {
            [scalar] => json!(scalar),
            components => json!(components),
        };
        (quantity.name.to_owned(), value)
    });
    Value::Object(parameters.collect())
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
