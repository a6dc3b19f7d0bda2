//! Steps need no more instructions than they did.
//!
//! Counted by valgrind, which sees the same number every time. Where valgrind is not installed nothing is counted, and the test says so.
//! `INSTRUCTIONS=renew cargo test -p coadjoint-instructions` writes the present counts to `counts.txt`.
// in a test, a panic is the report
#![allow(clippy::unwrap_used)]

use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

/// What the counts may grow by before it is noticed, and shrink by before it is to be written down.
const TOLERANCE: f64 = 0.05;

/// Instructions of so many steps.
fn counted(case: &str, steps: u64) -> f64 {
    let output = Command::new("valgrind")
        .args(["--tool=callgrind", "--callgrind-out-file=/dev/null"])
        .args([env!("CARGO_BIN_EXE_steps"), case, &steps.to_string()])
        .output()
        .unwrap();
    let report = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{case}: {report}");
    let collected = report.lines().find_map(|line| line.split_once("Collected : "));
    collected.unwrap_or_else(|| panic!("no count in\n{report}")).1.trim().parse().unwrap()
}

#[test]
fn steps_need_no_more_instructions() {
    if Command::new("valgrind").arg("--version").output().is_err() {
        println!("valgrind is not installed: nothing is counted");
        return;
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("counts.txt");
    let before = std::fs::read_to_string(&path).unwrap_or_default();
    let mut now = String::new();
    let mut differences = Vec::new();
    let cases = before.lines().map(|line| line.rsplit_once(": ").unwrap());
    // what comes before the steps, and the first of them, are in both
    let count = |case| (counted(case, 5_000) - counted(case, 1_000)) / 4_000.0;
    let presents: Vec<f64> = std::thread::scope(|scope| {
        let counts: Vec<_> = cases.clone().map(|(case, _)| scope.spawn(move || count(case))).collect();
        counts.into_iter().map(|count| count.join().unwrap()).collect()
    });
    for ((case, count), present) in cases.zip(presents) {
        let count: f64 = count.parse().unwrap();
        println!("{case}: {present:.1} instructions per step, {count:.1} before");
        writeln!(now, "{case}: {present:.1}").unwrap();
        let growth = present / count - 1.0;
        if growth.abs() > TOLERANCE {
            differences.push(format!("{case}: {count:.1} → {present:.1} ({:+.1} %)", 100.0 * growth));
        }
    }
    if std::env::var("INSTRUCTIONS").is_ok_and(|value| value == "renew") {
        std::fs::write(&path, now).unwrap();
        return;
    }
    assert!(!now.is_empty(), "no cases in {}", path.display());
    assert!(differences.is_empty(), "renew counts.txt if that is meant:\n{}", differences.join("\n"));
}
