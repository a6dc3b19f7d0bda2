//! `coadjoint certify`

use std::io::Write;

use clap::Args;
use coadjoint::certify::Report;
use coadjoint::system::Quantity;
use serde_json::json;

use super::console::OutputMode;
use super::description::DescriptionArguments;
use super::motion::check_scheme;
use crate::catalogue::Catalogue;
use crate::catalogue::casimir::symbols;
use crate::error::Error;
use crate::setup::{Changes, Method, MethodParser, Order, Retraction};
use crate::simulate::{self, has_method, states_in_motion, usual_method};
use crate::units::listed;

/// The arguments of `certify`.
#[derive(Debug, Args)]
pub(crate) struct CertifyArguments {
    /// The system; `list` shows all
    #[cfg_attr(feature = "description", arg(required_unless_present = "description"))]
    #[cfg_attr(not(feature = "description"), arg(required = true))]
    pub(crate) system: Option<String>,
    #[command(flatten)]
    pub(crate) described: DescriptionArguments,
    /// Only this method [default: the standard one and the midpoint]
    #[arg(long, value_parser = MethodParser)]
    pub(crate) method: Option<Method>,
    /// Steps of this order, as `run` takes them: from one equation where they are there, or composed [default: 2]
    #[arg(long, value_enum)]
    pub(crate) order: Option<Order>,
    /// Only the steps built on this map; `exp` and `cay` for short
    #[arg(long, value_enum)]
    pub(crate) retraction: Option<Retraction>,
    /// A parameter, a part of the state or a control in place of the example's, as `run` takes them: `weight=9.81`
    #[arg(long, value_name = "NAME=VALUE")]
    pub(crate) set: Vec<String>,
    #[command(flatten)]
    pub(crate) output: OutputMode,
}

/// Measures what the schemes claim of their steps of a system, on the system's example, or near it where that rests;
/// fails if a claim is wrong.
pub(crate) fn certify(
    catalogue: &Catalogue,
    arguments: &CertifyArguments,
    stdout: &mut dyn Write,
) -> Result<(), Error> {
    let mut console = arguments.output.on(stdout, false)?;
    let entry = arguments.described.system(catalogue, arguments.system.as_deref())?;
    let mut changes = Changes::of(entry);
    changes.apply(&arguments.set)?;
    let setup = match entry.has_example && arguments.set.is_empty() {
        true => entry.example.clone(),
        false => {
            let (setup, notes) = changes.finish()?;
            notes.into_iter().try_for_each(|note| console.note(note))?;
            setup
        }
    };
    check_scheme(arguments.method, arguments.order, None)?;
    let order = arguments.order.unwrap_or_default();
    let methods = match arguments.method {
        Some(method) => vec![method],
        // what is usual of that order
        None if order != Order::Two => vec![Method::Standard],
        None => [Method::Standard, Method::MIDPOINT]
            .into_iter()
            .filter(|&method| has_method(entry, method))
            .collect(),
    };
    let is_taylor = matches!(arguments.method, Some(Method::Taylor(_)));
    let retractions = match arguments.retraction {
        None if is_taylor => vec![Retraction::Exponential],
        Some(retraction) => vec![retraction],
        None => Retraction::of(entry),
    };
    let (states, rests) = states_in_motion(entry, &setup)?;
    if rests {
        console.note("the example rests; measured at states near it, chosen at random:".to_owned())?;
        for state in &states {
            writeln!(console.words(), "  {}", assignments(entry.description.state, state))?;
        }
        writeln!(console.words())?;
    }
    let mut reports = Vec::new();
    for &method in &methods {
        for &retraction in &retractions {
            let method = match arguments.method {
                None if order != Order::Two => usual_method(entry, retraction, order),
                _ => method,
            };
            let report = simulate::certify(entry, &setup, method, retraction, order)?;
            writeln!(console.words(), "{}\n", in_short(&report))?;
            reports.push(report);
        }
    }
    for line in legend(&reports) {
        writeln!(console.words(), "{line}")?;
    }
    let passed = reports.iter().all(Report::passed);
    if !passed && entry.description.piecewise {
        let kink = format!(
            "`{}` is written piece by piece, and claims are of states away from kinks: its example may be at one, as friction is at rest; \
             an example that moves there shows what holds",
            entry.name
        );
        console.note(kink)?;
    }
    let notes = console.notes.clone();
    console.object(|| json!({ "passed": passed, "states": states, "reports": reports, "notes": notes }))?;
    match reports.iter().filter(|report| !report.passed()).count() {
        0 => Ok(()),
        wrong => Err(Error::Claim { system: entry.name.clone(), wrong }),
    }
}

/// With the Casimirs of many terms in symbols.
fn in_short(report: &Report) -> Report {
    let mut report = report.clone();
    for row in report.certificates.iter_mut().filter(|row| row.name.chars().count() > 40) {
        row.name = symbols(&row.name);
    }
    report
}

/// The meaning of the rows, one line each.
const LEGEND: [(&str, &str); 23] = [
    ("order", "the error falls with this power of the step"),
    ("series", "how much of its reach the series of a step uses"),
    ("group", "how far states are off it, at every tolerance"),
    ("error by tolerance", "of each step, in units of the tolerance"),
    ("energy by tolerance", "the energy's, likewise"),
    ("consistency", "short steps follow the equations of motion"),
    ("Poisson map", "a step keeps the Poisson structure: it is symplectic"),
    (CASIMIRS, "how far steps are from keeping each, under its name"),
    ("energy drift", "how much of the energy's error is a straight line's"),
    ("energy order", "the energy's error falls with this power of the step"),
    ("reversibility", "steps, and as many back, lead to where they started"),
    ("Newton correction", "the solver's, against one by finite differences"),
    ("definition", "the generated step, against the scheme as defined"),
    ("warm steps", "steps that remember earlier ones, against single steps"),
    ("restarts", "the same from states that no step has led to"),
    ("control jumps", "the same where controls jump from step to step"),
    ("long steps", "the same with steps as long as can be taken"),
    ("zeros", "the same from states where momenta are zero"),
    ("energy differential", "the generated one, against finite differences"),
    ("antisymmetry", "of the Poisson structure"),
    ("Jacobi identity", "of the Poisson structure"),
    ("exponential", "displacements and Poisson structure are of one group"),
    ("inverse", "the map of the opposite displacement is its inverse"),
];

/// The Casimirs' line of the legend.
const CASIMIRS: &str = "Casimirs";

/// The lines of the legend for the rows that there are.
fn legend(reports: &[Report]) -> Vec<String> {
    let names = || reports.iter().flat_map(|report| &report.certificates).map(|row| row.name.as_str());
    let is_there = |name: &str| match name {
        CASIMIRS => names().any(|row| LEGEND.iter().all(|(known, _)| *known != row)),
        _ => names().any(|row| row == name),
    };
    let lines = LEGEND.iter().filter(|(name, _)| is_there(name));
    lines.map(|(name, meaning)| format!("{name:19}  {meaning}")).collect()
}

/// A state as `--set` takes it, to three digits.
fn assignments(quantities: &[Quantity], state: &[f64]) -> String {
    let quantity = |(quantity, slots): (&Quantity, std::ops::Range<usize>)| {
        format!("{}={}", quantity.name, listed(&state[slots]))
    };
    Quantity::with_ranges(quantities).map(quantity).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use coadjoint::prelude::*;

    use super::*;
    use crate::Example;
    use crate::tests::catalogue;

    /// A mass on a spring that rubs.
    #[lie_poisson_system(
        group = R1,
        potential = stiffness * position.norm_squared() / 2.0,
        force = -friction * momentum.x.signum()
    )]
    struct Rubbing {
        #[inertia]
        mass: f64,
        stiffness: f64,
        friction: f64,
    }

    impl Example for Rubbing {
        fn example() -> (Self, RubbingState) {
            let rubbing = Self { mass: 1.0, stiffness: 4.0, friction: 0.5 };
            (rubbing, RubbingState { position: vector![1.0], momentum: vector![0.0] })
        }
    }

    #[test]
    fn claims_that_fail_at_a_kink_are_explained() {
        let arguments = CertifyArguments {
            system: Some("rubbing".to_owned()),
            described: Default::default(),
            set: Vec::new(),
            order: None,
            method: None,
            retraction: None,
            output: OutputMode::default(),
        };
        let mut printed = Vec::new();
        let result = certify(&Catalogue::new([Rubbing::entry()]), &arguments, &mut printed);
        let printed = String::from_utf8(printed).expect("UTF-8");
        assert!(result.is_err() && printed.contains("FAILED"), "{printed}");
        assert!(printed.contains("note: `rubbing` is written piece by piece"), "{printed}");
    }

    #[test]
    fn every_row_is_explained_in_a_line() {
        for entry in catalogue().entries() {
            let report =
                simulate::certify(entry, &entry.example, Method::Standard, Retraction::Cayley, Order::Two);
            let reports = [report.expect("measured")];
            let lines = legend(&reports);
            assert!(lines.iter().all(|line| line.chars().count() <= 80), "{lines:#?}");
            for row in &reports[0].certificates {
                let is_casimir = entry.description.casimirs.contains(&row.name.as_str());
                let name = if is_casimir { CASIMIRS } else { row.name.as_str() };
                assert!(lines.iter().any(|line| line.starts_with(name)), "{name} of {}", entry.name);
            }
            assert!(reports[0].to_string().lines().all(|line| line.chars().count() <= 80));
        }
    }
}
