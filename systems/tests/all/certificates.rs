//! What the schemes claim, measured on every system of the catalogue.

use coadjoint_systems::catalogue::CATALOGUE;
use coadjoint_systems::simulation::{Method, Retraction};

#[test]
fn every_claim_holds_for_every_system() {
    let mut failures = String::new();
    let mut measured = 0;
    for entry in CATALOGUE {
        for method in [Method::Standard, Method::EulerA, Method::EulerB, Method::Midpoint] {
            for retraction in Retraction::ALL {
                let what = format!("{} {} {}", entry.name, method.name(), retraction.name());
                match entry.certify(&(entry.example)(), method, retraction) {
                    Ok(report) if report.passed() => {
                        measured += report.certificates.len();
                    }
                    Ok(report) => failures += &format!("{what}\n{report}\n"),
                    Err(error) => failures += &format!("{what}: {error}\n"),
                }
            }
        }
    }
    assert!(failures.is_empty(), "{failures}");
    // eight reports for each entry, of ten certificates or more
    assert!(measured > CATALOGUE.len() * 80, "{measured}");
}
