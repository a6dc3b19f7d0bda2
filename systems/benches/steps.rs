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

/// Steps in a sample's iteration: enough that a look at the clock does not count.
const STEPS: u64 = 256;

fn names() -> Vec<String> {
    cases::all().unwrap().iter().map(|case| format!("{}: {}", case.problem, case.method)).collect()
}

#[divan::bench(args = names())]
fn step(bencher: Bencher<'_, '_>, name: &String) {
    let all = cases::all().unwrap();
    let mut case =
        all.into_iter().find(|case| *name == format!("{}: {}", case.problem, case.method)).unwrap();
    assert!(case.run(case.steps.min(2_000)), "a step failed");
    bencher.counter(ItemsCount::new(STEPS)).bench_local(|| case.run(STEPS));
}
