//! A trajectory as one JSON object, written as it comes:
//!
//! ```json
//! {
//!   "program": "coadjoint", "version": "0.2.0", "coadjoint": "0.2.0",
//!   "system": "heavy_top", "retraction": "exponential", "method": "standard", "order": 2, "step": 0.01, "steps": 6000, "every": 1,
//!   "parameters": {"inertia": [1.0, 10.0, 100.0], "weight": 1.0, "chi": [0.0, 0.0, 1.0]},
//!   "state": {"attitude": [1.0, 0.0, 0.0, 0.0], …},
//!   "controls": {"thrust": 9.0, …},
//!   "units": {"weight": "N", …},
//!   "columns": ["time", "attitude_w", …],
//!   "rows": [[0.0, 1.0, …], …],
//!   "invariants": {"energy": {"initial": …, "largest_error": …, "slope": …}, …},
//!   "interrupted": 17
//! }
//! ```
//!
//! Controls are there where any are held in place of the system's own law, and null where it chooses; the retraction is
//! null for a classical method. Steps taken until an interruption are there of an interrupted run alone.

use std::io::{self, Write as _};

use serde_json::{Map, Value, json};

use super::NewFile;
use super::run_json::FileOrigin;
use super::table::Rows;
use crate::catalogue::Entry;
use crate::record::ConservationReport;

pub(super) struct Json {
    file: NewFile,
    rows: u64,
}

impl Json {
    pub(super) fn new(mut file: NewFile, columns: &[String], origin: &FileOrigin) -> io::Result<Self> {
        writeln!(file, "{{")?;
        for (name, value) in origin.fields() {
            writeln!(file, "  {}: {value},", json!(name))?;
        }
        writeln!(file, "  \"columns\": {},", json!(columns))?;
        write!(file, "  \"rows\": [")?;
        Ok(Self { file, rows: 0 })
    }
}

/// Writes the conservation of the invariants.
pub(crate) fn invariants(entry: &Entry, conservation: &ConservationReport) -> Value {
    let energy = entry.conserves_energy().then_some(("energy", &conservation.energy));
    let casimirs = entry.description.casimirs.iter().copied().zip(&conservation.casimirs);
    let invariants = energy.into_iter().chain(casimirs).map(|(name, stats)| {
        let stats_json =
            json!({ "initial": stats.initial, "largest_error": stats.error, "slope": stats.slope() });
        (name.to_owned(), stats_json)
    });
    Value::Object(invariants.collect())
}

impl Rows for Json {
    fn row(&mut self, row: &[f64]) -> io::Result<()> {
        self.file.write_all(if self.rows == 0 { b"\n    " } else { b",\n    " })?;
        self.rows += 1;
        Ok(serde_json::to_writer(&mut self.file, row)?)
    }

    fn finish(mut self: Box<Self>, known: &Map<String, Value>) -> io::Result<NewFile> {
        write!(self.file, "\n  ]")?;
        // the order of names is that of the format
        for (name, value) in
            ["invariants", "interrupted"].iter().filter_map(|name| known.get_key_value(*name))
        {
            write!(self.file, ",\n  {}: {value}", json!(name))?;
        }
        writeln!(self.file, "\n}}")?;
        Ok(self.file)
    }
}
