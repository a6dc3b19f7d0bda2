//! Timing, in turns.

use std::io::Write;
use std::time::Instant;

use coadjoint_app::Error;
use coadjoint_app::cli::console::OutputMode;
use coadjoint_app::error::SetupError;
use coadjoint_app::files::{FileOrigin, check_new, write_new};
use coadjoint_systems::cases::{self, BASELINE, Case};
use serde::Serialize;
use serde_json::json;

/// Rounds of measurement; the cases alternate.
const ROUNDS: usize = 40;

/// The results.
struct Results {
    processor: String,
    /// The best time of each case.
    cases: Vec<Timed>,
}

#[derive(Serialize)]
struct Timed {
    problem: &'static str,
    method: String,
    ns_per_step: f64,
    /// Relative to the time of the baseline; none where that is not timed.
    ratio: Option<f64>,
}

/// Times the standard cases in turns, so that a slow machine slows all of them alike.
pub(super) fn bench(arguments: &super::Arguments, console: &mut dyn Write) -> Result<(), Error> {
    // times are other ones each time: they are not to be lost
    if let Some(path) = &arguments.json {
        check_new(path, arguments.force)?;
    }
    let mut cases = cases::all().map_err(|error| Error::other(error.to_string()))?;
    keep(&mut cases, arguments.filter.as_deref().unwrap_or(""))?;
    let mut best = vec![f64::INFINITY; cases.len()];
    let mut progress = {
        let mode = OutputMode { quiet: arguments.quiet, json: false };
        mode.on(console, false)?.progress("bench", ROUNDS as u64 + 1, "round")
    };
    for round in 0..=ROUNDS {
        progress.show(round as u64);
        for (case, best) in cases.iter_mut().zip(&mut best) {
            let start = Instant::now();
            if !case.run(case.steps) {
                return Err(Error::Command(
                    format!("{}, {}: a step failed", case.problem, case.method).into(),
                ));
            }
            // the first time is for warming up
            if round > 0 {
                *best = best.min(start.elapsed().as_secs_f64() / case.steps as f64 * 1e9);
            }
        }
    }
    drop(progress);
    let baseline = |problem: &str| {
        let is = |case: &Case| case.problem == problem && case.method == BASELINE;
        cases.iter().position(is).map(|index| best[index])
    };
    let timed = cases.iter().zip(&best).map(|(case, &ns_per_step)| Timed {
        problem: case.problem,
        method: case.method.clone(),
        ns_per_step,
        ratio: baseline(case.problem).map(|other| ns_per_step / other),
    });
    let results = Results { processor: processor(), cases: timed.collect() };
    match &arguments.json {
        Some(path) if path.as_os_str() == "-" => write!(console, "{}", object(&results, arguments)?)?,
        Some(path) => {
            print(&results, console)?;
            write_new(path, object(&results, arguments)?.as_bytes(), arguments.force)?;
            writeln!(console, "wrote {}", path.display())?;
        }
        None => print(&results, console)?,
    }
    Ok(())
}

/// The results as one object, which begins with what made it.
fn object(results: &Results, arguments: &super::Arguments) -> Result<String, Error> {
    let filter = arguments.filter.as_ref().map_or(String::new(), |filter| format!(" --filter {filter}"));
    let mut text = String::from("{\n");
    for (name, value) in FileOrigin::of_command(&format!("bench{filter}")).fields() {
        text += &format!("  {}: {value},\n", json!(name));
    }
    let cases = serde_json::to_string_pretty(&results.cases).map_err(Error::other)?;
    text += &format!(
        "  \"processor\": {},\n  \"cases\": {}\n}}\n",
        json!(results.processor),
        cases.replace('\n', "\n  ")
    );
    Ok(text)
}

/// Keeps the cases that a text names, in small letters or capitals, and what they are compared with.
fn keep(cases: &mut Vec<Case>, filter: &str) -> Result<(), Error> {
    let filter = filter.to_lowercase();
    let is_named =
        |case: &Case| [case.problem, &case.method].iter().any(|name| name.to_lowercase().contains(&filter));
    let problems: Vec<&str> = cases.iter().filter(|case| is_named(case)).map(|case| case.problem).collect();
    if problems.is_empty() {
        let mut known: Vec<&str> = cases.iter().map(|case| case.problem).collect();
        known.dedup();
        let reason = format!("no case has `{filter}` in its name (problems: {})", known.join("; "));
        return Err(SetupError::new(reason).into());
    }
    cases.retain(|case| is_named(case) || (case.method == BASELINE && problems.contains(&case.problem)));
    Ok(())
}

fn print(results: &Results, console: &mut dyn Write) -> Result<(), Error> {
    writeln!(console, "{}", results.processor)?;
    writeln!(console, "best of {ROUNDS} rounds, steps of 0.01 s, ratios to {BASELINE}")?;
    let mut problem = "";
    for timed in &results.cases {
        if timed.problem != problem {
            problem = timed.problem;
            writeln!(console, "\n{problem:50} {:>8} {:>8}", "ns/step", "ratio")?;
        }
        let ratio = timed.ratio.map_or(String::new(), |ratio| format!("{ratio:8.2}"));
        writeln!(console, "  {:48} {:8.1} {ratio}", timed.method, timed.ns_per_step)?;
    }
    Ok(())
}

/// The name of the processor, where it is known.
fn processor() -> String {
    let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = info.lines().find_map(|line| line.strip_prefix("model name")?.split_once(':'));
    name.map_or_else(|| std::env::consts::ARCH.to_owned(), |(_, name)| name.trim().to_owned())
}
