//! `coadjoint certify`

use std::io::Write;

use crate::cli::CertifyArguments;
use crate::error::Error;
use coadjoint_systems::catalogue::Entry;
use coadjoint_systems::simulation::{Method, Retraction};

/// Measures what the schemes claim of their steps of a system, on the system's example; fails if a claim is wrong.
pub(crate) fn certify(arguments: &CertifyArguments, console: &mut dyn Write) -> Result<(), Error> {
    let entry = crate::suggest::system(&arguments.system)?;
    let methods = match arguments.method {
        Some(method) => vec![method],
        None => vec![Method::Standard, Method::Midpoint],
    };
    let retractions = match arguments.retraction {
        Some(retraction) => vec![retraction],
        None => Retraction::of(entry),
    };
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
