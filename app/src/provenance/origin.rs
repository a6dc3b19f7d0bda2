//! What a file says made it, as it stands there: by the names of its fields.

use serde_json::{Map, Value, json};

use super::{PROGRAM, Provenance};

/// What made a file: a run of a system ([`Provenance`]), or a command. Files of one origin may take each other's place.
#[derive(Clone, Debug, PartialEq)]
pub struct Origin(pub(super) Map<String, Value>);

/// The field that says that a run was interrupted, and after how many steps.
const INTERRUPTED: &str = "interrupted";
/// The field that says which command it was, as it can be typed again.
const COMMAND: &str = "command";

impl Origin {
    /// Of a command, as it can be typed again behind the program's name: `figures 6.2`.
    pub fn of_command(command: &str) -> Self {
        let fields = json!({ "program": PROGRAM, "version": env!("CARGO_PKG_VERSION"), COMMAND: command });
        Self(super::fields(fields))
    }

    /// With one more thing to know of it.
    #[must_use]
    pub fn with(mut self, name: &str, value: Value) -> Self {
        self.0.insert(name.to_owned(), value);
        self
    }

    /// Of a file with these fields, if they are this program's.
    pub(super) fn of_fields(fields: Map<String, Value>) -> Option<Self> {
        let origin = Self(fields);
        let is_ours = origin.0.get("program").is_some_and(|program| program == PROGRAM);
        (is_ours && (origin.command().is_some() || origin.run().is_some())).then_some(origin)
    }

    /// By the names of its fields.
    pub fn fields(&self) -> &Map<String, Value> {
        &self.0
    }

    /// As JSON on one line; numbers are the shortest text that reads back as the same.
    pub fn line(&self) -> String {
        json!(self.0).to_string()
    }

    /// The run, if it was one.
    pub(crate) fn run(&self) -> Option<Provenance> {
        serde_json::from_value(Value::Object(self.0.clone())).ok()
    }

    /// The command, if it was no run.
    pub(crate) fn command(&self) -> Option<&str> {
        self.0.get(COMMAND)?.as_str()
    }

    /// The steps that the whole run has.
    pub(crate) fn steps(&self) -> u64 {
        self.0.get("steps").and_then(Value::as_u64).unwrap_or(0)
    }

    /// The steps taken when the run was interrupted; nothing of a complete one.
    pub(crate) fn interrupted(&self) -> Option<u64> {
        self.0.get(INTERRUPTED)?.as_u64()
    }

    /// The same, of a run that was interrupted after so many steps.
    #[must_use]
    pub(crate) fn interrupted_after(&self, steps: Option<u64>) -> Self {
        let mut origin = self.clone();
        match steps {
            Some(steps) => origin.0.insert(INTERRUPTED.to_owned(), steps.into()),
            None => origin.0.remove(INTERRUPTED),
        };
        origin
    }

    /// The fields in which two differ, complete or not.
    pub(crate) fn differences(&self, other: &Self) -> Vec<String> {
        let mut names: Vec<&String> = self.0.keys().chain(other.0.keys()).collect();
        names.sort();
        names.dedup();
        names.retain(|name| *name != INTERRUPTED && self.0.get(*name) != other.0.get(*name));
        names.into_iter().cloned().collect()
    }
}
