//! What steps cost: `cargo bench --features bench --bench steps`, with `-- free_rigid_body` for one system. The same cases as `coadjoint bench`,
//! each with its spread.
// a benchmark that cannot be made is to say so
#![allow(clippy::unwrap_used)]

use coadjoint_systems::cases;
use divan::Bencher;
use divan::counter::ItemsCount;

fn main() {
    divan::main();
}

fn names() -> Vec<String> {
    cases::all().unwrap().iter().map(|case| format!("{}: {}", case.problem, case.method)).collect()
}

#[divan::bench(args = names())]
fn step(bencher: Bencher<'_, '_>, name: &String) {
    let all = cases::all().unwrap();
    let mut case =
        all.into_iter().find(|case| *name == format!("{}: {}", case.problem, case.method)).unwrap();
    // whole runs from new states, and so many that waking a thread does not count
    let steps = case.steps / 8;
    assert!(case.run(steps), "a step failed");
    bencher.counter(ItemsCount::new(steps)).bench_local(|| case.run(steps));
}
