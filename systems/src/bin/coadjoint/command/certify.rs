//! `coadjoint certify`

use std::io::Write;

use coadjoint::system::Quantity;

use crate::cli::CertifyArguments;
use crate::error::Error;
use crate::setting::laid_out;
use coadjoint_systems::catalogue::Entry;
use coadjoint_systems::simulation::{Method, Retraction};

/// Measures what the schemes claim of their steps of a system, on the system's example, or near it where that rests; fails if a claim is
/// wrong.
pub(crate) fn certify(arguments: &CertifyArguments, console: &mut dyn Write) -> Result<(), Error> {
    let entry = crate::suggest::system(&arguments.system)?;
    let methods = match arguments.method {
        Some(method) => vec![method],
        None => vec![Method::Standard, Method::Midpoint],
    };
    let retractions = match arguments.retraction {
        Some(retraction) => vec![retraction],
        None => Retraction::ALL.to_vec(),
    };
    let (states, rests) = entry.states_in_motion(&(entry.example)())?;
    if rests {
        writeln!(console, "note: the example rests; measured at states near it, chosen at random:")?;
        for state in states {
            writeln!(console, "  {}", assignments(entry.description.state, &state))?;
        }
        writeln!(console)?;
    }
    let mut wrong = 0;
    for &method in &methods {
        for &retraction in &retractions {
            wrong += usize::from(!one(entry, method, retraction, console)?);
        }
    }
    match wrong {
        0 => Ok(()),
        _ => Err(Error::Claim { system: entry.name, wrong }),
    }
}

/// A state as `--set` takes it, to three digits.
fn assignments(quantities: &[Quantity], state: &[f64]) -> String {
    let quantity = |(quantity, slots): (&Quantity, std::ops::Range<usize>)| {
        // adding zero leaves no −0
        let rounded = |x: &f64| ((x * 1e3).round() / 1e3 + 0.0).to_string();
        format!("{}={}", quantity.name, state[slots].iter().map(rounded).collect::<Vec<_>>().join(","))
    };
    laid_out(quantities).map(quantity).collect::<Vec<_>>().join(" ")
}

/// One scheme's report; whether all of its claims hold.
fn one(
    entry: &Entry,
    method: Method,
    retraction: Retraction,
    console: &mut dyn Write,
) -> Result<bool, Error> {
    let report = entry.certify(&(entry.example)(), method, retraction)?;
    writeln!(console, "{report}\n")?;
    Ok(report.passed())
}
