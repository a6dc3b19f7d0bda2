//! `coadjoint certify`

use std::io::Write;

use clap::Args;
use coadjoint::system::Quantity;

use crate::entry::{Catalogue, Entry};
use crate::error::Error;
use crate::setting::laid_out;
use crate::simulation::{Method, Retraction};

/// Which steps to certify.
#[derive(Debug, Args)]
pub(crate) struct CertifyArguments {
    /// The system; `coadjoint list` shows all
    pub(crate) system: String,
    /// Only this method, in place of the standard one and the midpoint
    #[arg(long)]
    pub(crate) method: Option<Method>,
    /// Only the steps built on this map; `exp` for short
    #[arg(long, value_enum)]
    pub(crate) retraction: Option<Retraction>,
}

/// Measures what the schemes claim of their steps of a system, on the system's example, or near it where that rests; fails if a claim is
/// wrong.
pub(crate) fn certify(
    catalogue: Catalogue,
    arguments: &CertifyArguments,
    console: &mut dyn Write,
) -> Result<(), Error> {
    let entry = catalogue.system(&arguments.system)?;
    let methods = match arguments.method {
        Some(method) => vec![method],
        None => vec![Method::Standard, Method::Midpoint],
    };
    let retractions = match arguments.retraction {
        Some(retraction) => vec![retraction],
        None => Retraction::of(entry),
    };
    let (states, rests) = entry.states_in_motion(&entry.example.clone())?;
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
    let report = entry.certify(&entry.example.clone(), method, retraction)?;
    writeln!(console, "{report}\n")?;
    Ok(report.passed())
}
