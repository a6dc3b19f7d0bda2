//! A trajectory as one JSON object, written as it comes:
//!
//! ```json
//! {
//!   "system": "heavy_top", "retraction": "exponential", "method": "standard", "order": 2, "step": 0.01,
//!   "parameters": {"inertia": [1.0, 10.0, 100.0], "weight": 1.0, "chi": [0.0, 0.0, 1.0]},
//!   "columns": ["time", "attitude_w", …],
//!   "rows": [[0.0, 1.0, …], …],
//!   "invariants": {"energy": {"initial": …, "largest_error": …}, …}
//! }
//! ```

use std::io::{self, Write as _};

use serde_json::{Map, Value, json};

use super::{WholeFile, Write};
use crate::catalogue::Entry;
use crate::setting::laid_out;
use crate::simulation::{Job, Outcome, Sample, Setup};

pub(super) struct Json {
    file: WholeFile,
    entry: &'static Entry,
    rows: u64,
    row: Vec<f64>,
}

impl Json {
    pub(super) fn new(
        mut file: WholeFile,
        entry: &'static Entry,
        setup: &Setup,
        job: &Job,
    ) -> io::Result<Self> {
        writeln!(file, "{{")?;
        for (name, value) in [
            ("system", json!(entry.name)),
            ("retraction", json!(job.retraction.name())),
            ("method", json!(job.method.name())),
            ("order", json!(job.order.number())),
            ("step", json!(job.step)),
            ("parameters", parameters(entry, setup)),
            ("columns", json!(entry.columns())),
        ] {
            writeln!(file, "  {}: {value},", json!(name))?;
        }
        write!(file, "  \"rows\": [")?;
        Ok(Self { file, entry, rows: 0, row: Vec::new() })
    }
}

fn parameters(entry: &Entry, setup: &Setup) -> Value {
    let parameters = laid_out(entry.parameters).map(|(quantity, slots)| {
        let value = match &setup.parameters[slots] {
            [scalar] => json!(scalar),
            components => json!(components),
        };
        (quantity.name.to_owned(), value)
    });
    Value::Object(parameters.collect())
}

impl Write for Json {
    fn row(&mut self, sample: &Sample<'_>) -> io::Result<()> {
        self.row.clear();
        self.row.push(sample.time);
        self.row.extend(sample.state);
        self.row.push(sample.energy);
        self.file.write_all(if self.rows == 0 { b"\n    " } else { b",\n    " })?;
        self.rows += 1;
        Ok(serde_json::to_writer(&mut self.file, &self.row)?)
    }

    fn finish(mut self: Box<Self>, outcome: &Outcome) -> io::Result<()> {
        let mut invariants = Map::new();
        let mut add = |name: &str, initial: f64, error: f64| {
            invariants.insert(name.to_owned(), json!({ "initial": initial, "largest_error": error }))
        };
        if self.entry.autonomous {
            add("energy", outcome.energy, outcome.energy_error);
        }
        for ((name, initial), drift) in
            self.entry.casimirs.iter().zip(&outcome.casimirs).zip(&outcome.casimir_drifts)
        {
            add(name, *initial, *drift);
        }
        writeln!(self.file, "\n  ],\n  \"invariants\": {}\n}}", Value::Object(invariants))?;
        self.file.finish()
    }
}
