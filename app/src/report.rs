//! The report of a run, for the user.

use std::fmt;

use coadjoint::RunReport;
use serde_json::{Value, json};

use crate::casimir;
use crate::conservation::{ConservationReport, DriftStats};
use crate::entry::Entry;
use crate::provenance::Provenance;
use crate::simulation::{Job, Method, Setup};

/// A table with a column for each run.
#[derive(Debug)]
pub struct Table<'a> {
    entry: &'a Entry,
    runs: Vec<RunSummary>,
}

/// One run's column.
#[derive(Clone, Debug)]
pub struct RunSummary {
    /// The job.
    pub job: Job,
    /// Steps and iterations.
    pub report: RunReport,
    /// The conservation of energy and Casimirs.
    pub conservation: ConservationReport,
    /// How far the configuration was off its group, at most.
    pub off_group: f64,
    /// The time of a step without an observer, ns; none if there were no steps.
    pub time_per_step: Option<f64>,
}

impl RunSummary {
    /// The conservation of energy and Casimirs, in words.
    pub fn conclusions(&self, entry: &Entry) -> Vec<String> {
        let mut lines = Vec::new();
        let energy = &self.conservation.energy;
        lines.push(if entry.conserves_energy() {
            format!("energy: {}", describe(energy, self.conservation.steps, entry.unit("energy")))
        } else if entry.description.autonomous {
            "energy: conserved only while the controls are the same".to_owned()
        } else {
            "energy: not conserved by this system".to_owned()
        });
        for ((name, unit), stats) in casimir::names(entry).zip(&self.conservation.casimirs) {
            lines.push(format!("{name}: {}", describe(stats, self.conservation.steps, unit)));
        }
        lines
    }
}

impl RunSummary {
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
        object.insert("invariants".to_owned(), crate::output::invariants(entry, &self.conservation));
        object.insert("conclusions".to_owned(), json!(self.conclusions(entry)));
        Value::Object(object)
    }
}

/// How well a quantity was conserved, in words.
fn describe(stats: &DriftStats, steps: u64, unit: &str) -> String {
    // roundoff of every step, adding up like the steps of a walk, and some factor for the few operations of each
    let roundoff = 16.0 * f64::EPSILON * (steps.max(1) as f64).sqrt() * stats.initial.abs().max(stats.error);
    let (least, greatest) = stats.range;
    if stats.error.is_nan() {
        "became not a number".to_owned()
    } else if stats.error <= roundoff {
        "kept to roundoff".to_owned()
    } else if steps < 100 {
        format!("kept to {}; too few steps for a trend", with_unit_behind(stats.error, unit))
    } else if stats.drift() < 0.5 {
        format!(
            "bounded: its error stays from {} to {} and does not grow",
            magnitude(least),
            with_unit_behind(greatest, unit)
        )
    } else {
        format!(
            "drifts: by {} per second, or swings more slowly than this run shows",
            with_unit_behind(stats.slope(), unit)
        )
    }
}

impl<'a> Table<'a> {
    /// A table of runs of one system.
    pub fn new(entry: &'a Entry, runs: Vec<RunSummary>) -> Self {
        Self { entry, runs }
    }

    fn rows(&self) -> Vec<(String, Vec<String>)> {
        let row = |name: &str, cell: &dyn Fn(&RunSummary) -> String| {
            (name.to_owned(), self.runs.iter().map(cell).collect::<Vec<_>>())
        };
        let of = |energy: &str| with_unit(energy, self.entry.unit("energy"));
        let mut rows = vec![
            row("retraction", &|run| match run.job.method.classical() {
                None => run.job.retraction.name().to_owned(),
                Some(_) => "–".to_owned(),
            }),
            row("method", &|run| self.method(&run.job)),
            row("order", &|run| self.entry.order(&run.job).to_string()),
            row("steps", &|run| grouped(run.conservation.steps)),
            row("time per step, ns", &|run| {
                run.time_per_step.map_or("–".to_owned(), |time| format!("{time:.0}"))
            }),
            row("iterations per step", &|run| format!("{:.2}", run.report.iterations_per_step())),
            row(&of("energy at the start"), &|run| {
                format!("{:.4}", Figures(run.conservation.energy.initial + 0.0))
            }),
            row(
                &if self.entry.conserves_energy() {
                    of("largest energy error")
                } else {
                    // forces act, or time or controls have a part in it
                    of("largest change of energy") + " (it is not conserved)"
                },
                &|run| magnitude(run.conservation.energy.error),
            ),
        ];
        for (i, (name, unit)) in casimir::names(self.entry).enumerate() {
            let name = with_unit(&format!("drift of {name}"), unit);
            rows.push(row(&name, &|run| {
                magnitude(run.conservation.casimirs.get(i).map_or(f64::NAN, |stats| stats.error))
            }));
        }
        if self.runs.iter().any(|run| run.job.method.classical().is_some()) {
            rows.push(row("largest distance from the group", &|run| magnitude(run.off_group)));
        }
        rows
    }
}

impl Table<'_> {
    /// `midpoint`, or `standard (verlet)`
    fn method(&self, job: &Job) -> String {
        match job.method {
            Method::Standard => format!("standard ({})", self.entry.standard(job.retraction)),
            method => method.to_string(),
        }
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

/// `1.5e-6 J`
fn with_unit_behind(value: f64, unit: &str) -> String {
    format!("{} {unit}", magnitude(value)).trim_end().to_owned()
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

/// `4.5 M`, `320 k`, `17`: so many a second.
pub(crate) fn rate_in_words(rate: f64) -> String {
    match rate {
        rate if rate >= 1e9 => format!("{:.1} G", rate / 1e9),
        rate if rate >= 1e6 => format!("{:.1} M", rate / 1e6),
        rate if rate >= 1e4 => format!("{:.0} k", rate / 1e3),
        rate if rate >= 10.0 => format!("{rate:.0}"),
        rate => format!("{rate:.1}"),
    }
}

/// `12 s`, `3 min`, `5.1 h`, `80 days`, `3.2 years`
pub(crate) fn seconds_in_words(seconds: f64) -> String {
    const UNITS: [(f64, &str); 4] =
        [(60.0, "min"), (3600.0, "h"), (86_400.0, "days"), (365.25 * 86_400.0, "years")];
    let unit = UNITS.iter().rev().find(|(unit, _)| seconds >= 1.5 * unit);
    let (value, unit) = unit.map_or((seconds, "s"), |(length, unit)| (seconds / length, *unit));
    match value {
        value if value >= 1e7 => format!("{value:.1e} {unit}"),
        value if value >= 10.0 || unit == "s" => format!("{} {unit}", grouped(value.round() as u64)),
        value => format!("{value:.1} {unit}"),
    }
}

/// `350 kB`, `2.5 GB`
pub(crate) fn bytes_in_words(bytes: f64) -> String {
    const UNITS: [&str; 6] = ["bytes", "kB", "MB", "GB", "TB", "PB"];
    let mut value = bytes;
    let mut unit = 0;
    while value >= 999.5 && unit + 1 < UNITS.len() {
        value /= 1e3;
        unit += 1;
    }
    let digits = usize::from(value < 9.95 && unit > 0);
    if value >= 1e6 {
        format!("{value:.1e} {}", UNITS[unit])
    } else {
        format!("{value:.digits$} {}", UNITS[unit])
    }
}

/// A number with so many digits behind the first, written out where that is short.
struct Figures(f64);

impl fmt::Display for Figures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let digits = f.precision().unwrap_or(2);
        let exponent = self.0.abs().log10().floor();
        if self.0 == 0.0 || (-2.0..5.0).contains(&exponent) {
            let behind = (digits as f64 - exponent.max(-2.0)).clamp(0.0, 9.0);
            let text = format!("{:.*}", if self.0 == 0.0 { 0 } else { behind as usize }, self.0);
            let short =
                if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
            f.write_str(short)
        } else {
            write!(f, "{:.digits$e}", self.0)
        }
    }
}

/// A text in lines of at most so many letters, broken between words.
pub(crate) fn wrapped(text: &str, width: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// Six digits, without zeros at the end.
pub(crate) fn short(value: f64) -> String {
    format!("{:.5}", Figures(value))
}

/// All digits: `0.01`, but `2e-9`.
pub(crate) fn exact(value: f64) -> String {
    // adding zero leaves no −0
    let (plain, power) = ((value + 0.0).to_string(), format!("{value:e}"));
    let is_usual = value == 0.0 || (1e-4..1e7).contains(&value.abs());
    if is_usual || plain.len() < power.len() { plain } else { power }
}

/// Two digits say how large an error is.
pub(crate) fn magnitude(value: f64) -> String {
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
        for (number, text) in [
            (0.01, "0.01"),
            (2e-9, "2e-9"),
            (-0.0, "0"),
            (2.5e-6, "2.5e-6"),
            (1e6, "1000000"),
            (12_345_678.25, "12345678.25"),
            (3e9, "3e9"),
        ] {
            assert_eq!(exact(number), text);
        }
        assert_eq!(magnitude(1.26e-14), "1.3e-14");
        for (number, text) in [
            (0.0, "0"),
            (1.555, "1.555"),
            (-12.5, "-12.5"),
            (0.012_345_67, "0.012346"),
            (98_765.432, "98765"),
            (-9.965_011e9, "-9.9650e9"),
            (1e-7, "1.0000e-7"),
        ] {
            assert_eq!(format!("{:.4}", Figures(number)), text);
        }
        for (seconds, text) in [
            (0.2, "0 s"),
            (80.0, "80 s"),
            (100.0, "1.7 min"),
            (3000.0, "50 min"),
            (18_000.0, "5.0 h"),
            (7e6, "81 days"),
            (1e8, "3.2 years"),
            (1e13, "316 881 years"),
        ] {
            assert_eq!(seconds_in_words(seconds), text);
        }
        for (rate, text) in [(4_500_768.1, "4.5 M"), (320_400.0, "320 k"), (17.2, "17"), (0.25, "0.2")] {
            assert_eq!(rate_in_words(rate), text);
        }
        for (bytes, text) in [(12.0, "12 bytes"), (9.96e3, "10 kB"), (2.52e9, "2.5 GB"), (9.999e5, "1.0 MB")]
        {
            assert_eq!(bytes_in_words(bytes), text);
        }
        assert_eq!(wrapped("one two three, four", 9), ["one two", "three,", "four"]);
        assert_eq!(wrapped("longer-than-that", 3), ["longer-than-that"]);
        assert_eq!(wrapped("", 3), [""; 0]);
        assert_eq!(bytes_in_words(1e30), "1.0e15 PB");
        assert_eq!(with_unit("time", "s"), "time, s");
        assert_eq!(with_unit("|Γ|²", ""), "|Γ|²");
    }
}
