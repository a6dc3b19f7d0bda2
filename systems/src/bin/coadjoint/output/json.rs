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

use super::{WholeFile, Write};
use crate::setting::laid_out;
use coadjoint_systems::catalogue::Entry;
use coadjoint_systems::ledger::Ledger;
use coadjoint_systems::simulation::{Job, Setup};

pub(super) struct Json {
    file: WholeFile,
    entry: &'static Entry,
    rows: u64,
}

impl Json {
    pub(super) fn new(
        mut file: WholeFile,
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

/// What a run is, by name.
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

/// What a run found of the invariants.
pub(super) fn invariants(entry: &Entry, ledger: &Ledger) -> Value {
    let energy = entry.description.autonomous.then_some(("energy", &ledger.energy));
    let casimirs = entry.description.casimirs.iter().copied().zip(&ledger.casimirs);
    let courses = energy.into_iter().chain(casimirs).map(|(name, kept)| {
        let course = json!({ "initial": kept.initial, "largest_error": kept.error, "slope": kept.slope() });
        (name.to_owned(), course)
    });
    Value::Object(courses.collect())
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

    fn finish(mut self: Box<Self>, ledger: &Ledger) -> io::Result<()> {
        let invariants = invariants(self.entry, ledger);
        writeln!(self.file, "\n  ],\n  \"invariants\": {invariants}\n}}")?;
        self.file.finish()
    }
}
