//! What the schemes claim, measured on every system of the catalogue.

use coadjoint_systems::catalogue::find;
use coadjoint_systems::simulation::{Method, Retraction};

entries!(every_claim_holds);

fn every_claim_holds(name: &str) {
    let entry = find(name).expect("it is there");
    let retractions = Retraction::of(entry);
    let (mut failures, mut reports, mut measured) = (String::new(), 0, 0);
    for method in [Method::Standard, Method::EulerA, Method::EulerB, Method::Midpoint] {
        for &retraction in &retractions {
            let what = format!("{name} {} {}", method.name(), retraction.name());
            match entry.certify(&(entry.example)(), method, retraction) {
                Ok(report) if report.passed() => {
                    reports += 1;
                    measured += report.certificates.len();
                }
                Ok(report) => failures += &format!("{what}\n{report}\n"),
                Err(error) => failures += &format!("{what}: {error}\n"),
            }
        }
    }
    assert!(failures.is_empty(), "{failures}");
    // of ten certificates or more
    let all = 4 * retractions.len();
    assert!(reports == all && measured >= 10 * all, "{name}: {measured} certificates in {reports} reports");
}
