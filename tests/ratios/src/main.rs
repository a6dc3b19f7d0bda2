//! Nanoseconds a step of the standard cases, with the library of the checkout that this crate lies in.
//!
//! `coadjoint-ratios REPETITIONS [WORD]` prints a line for each case whose name has the word: its name, a tab, and the fastest of the
//! repetitions, or `failed`. `.ci/ratios` compiles it in several checkouts and runs the programs by turns.
//!
//! Old commits compile this too. So it keeps to what they have: names at the root of the library and in its prelude, no error is printed, and
//! each description of another kind has a file of its own in `later/`.

mod bodies;
mod case;
mod later {
    #[cfg(feature = "lagrangian")]
    pub(crate) mod lagrangian;
    #[cfg(feature = "matrix_group")]
    pub(crate) mod matrix_group;
}

use std::time::Instant;

fn main() {
    let mut arguments = std::env::args().skip(1);
    let repetitions: u32 = arguments.next().and_then(|number| number.parse().ok()).unwrap_or(20);
    let word = arguments.next().unwrap_or_default();

    let mut cases = bodies::cases();
    #[cfg(feature = "lagrangian")]
    cases.extend(later::lagrangian::cases());
    #[cfg(feature = "matrix_group")]
    cases.extend(later::matrix_group::cases());
    cases.retain(|case| case.name.contains(&word));

    // the first time warms caches, and says what fails
    let mut fastest: Vec<_> = cases.iter_mut().map(|case| (case.run)().then_some(f64::INFINITY)).collect();
    // by turns, so that what else the machine does for a while is not one case's alone
    for _ in 0..repetitions {
        for (case, fastest) in cases.iter_mut().zip(&mut fastest) {
            let Some(least) = fastest else { continue };
            let start = Instant::now();
            let solved = (case.run)();
            let nanoseconds = start.elapsed().as_secs_f64() * 1e9 / case.steps as f64;
            *fastest = solved.then_some(least.min(nanoseconds));
        }
    }
    for (case, fastest) in cases.iter().zip(fastest) {
        match fastest {
            Some(nanoseconds) => println!("{}\t{nanoseconds:.3}", case.name),
            None => println!("{}\tfailed", case.name),
        }
    }
}
