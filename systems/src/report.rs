//! What a person is told after a run.

use std::fmt;

use crate::catalogue::Entry;
use crate::simulation::{Order, Outcome, Retraction};

/// A table with a column for each run.
#[derive(Debug)]
pub struct Table<'a> {
    entry: &'a Entry,
    runs: Vec<Finding>,
}

/// One run's column.
#[derive(Clone, Debug)]
pub struct Finding {
    /// The scheme's retraction.
    pub retraction: Retraction,
    /// The scheme's order.
    pub order: Order,
    /// What the run found.
    pub outcome: Outcome,
    /// The time a step takes with nobody watching, ns; none if there were no steps.
    pub time_per_step: Option<f64>,
}

impl<'a> Table<'a> {
    /// A table of runs of one system.
    pub fn new(entry: &'a Entry, runs: Vec<Finding>) -> Self {
        Self { entry, runs }
    }

    fn rows(&self) -> Vec<(String, Vec<String>)> {
        let row = |name: &str, cell: &dyn Fn(&Finding) -> String| {
            (name.to_owned(), self.runs.iter().map(cell).collect::<Vec<_>>())
        };
        let mut rows = vec![
            row("retraction", &|run| run.retraction.name().to_owned()),
            row("order", &|run| run.order.to_string()),
            row("steps", &|run| grouped(run.outcome.run.steps)),
            row("time per step, ns", &|run| {
                run.time_per_step.map_or("–".to_owned(), |time| format!("{time:.0}"))
            }),
            row("Newton iterations per step", &|run| format!("{:.2}", run.outcome.run.iterations_per_step())),
            row("largest energy error, J", &|run| magnitude(run.outcome.energy_error)),
        ];
        for (i, name) in self.entry.casimirs.iter().enumerate() {
            let name = with_unit(
                &format!("drift of {name}"),
                self.entry.casimir_units.get(i).copied().unwrap_or(""),
            );
            rows.push(row(&name, &|run| {
                magnitude(run.outcome.casimir_drifts.get(i).copied().unwrap_or(f64::NAN))
            }));
        }
        rows
    }
}

impl fmt::Display for Table<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let rows = self.rows();
        let names = rows.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0);
        let cells =
            rows.iter().flat_map(|(_, cells)| cells).map(|cell| cell.chars().count()).max().unwrap_or(0);
        for (i, (name, row)) in rows.iter().enumerate() {
            write!(f, "{name:names$}")?;
            for cell in row {
                write!(f, "  {cell:>cells$}")?;
            }
            writeln!(f)?;
            if i == 0 {
                writeln!(f, "{}", "─".repeat(names + row.len() * (cells + 2)))?;
            }
        }
        Ok(())
    }
}

/// `energy, J`, or only the name of a pure number.
pub fn with_unit(name: &str, unit: &str) -> String {
    if unit.is_empty() { name.to_owned() } else { format!("{name}, {unit}") }
}

/// `180 000`
pub fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

/// Two digits say how large an error is.
fn magnitude(value: f64) -> String {
    if value == 0.0 { "0".to_owned() } else { format!("{value:.1e}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_set_for_reading() {
        assert_eq!(grouped(0), "0");
        assert_eq!(grouped(999), "999");
        assert_eq!(grouped(180_000), "180 000");
        assert_eq!(grouped(1_234_567), "1 234 567");
        assert_eq!(magnitude(0.0), "0");
        assert_eq!(magnitude(1.26e-14), "1.3e-14");
        assert_eq!(with_unit("time", "s"), "time, s");
        assert_eq!(with_unit("|Γ|²", ""), "|Γ|²");
    }
}
