//! What roundoff does to invariants in long runs: `cargo bench --bench roundoff`, with a number of steps behind `--` for longer ones.
//!
//! Prints the largest relative error so far of what the step conserves but for rounding, in plain and in compensated arithmetic. A random
//! walk grows tenfold while the steps grow a hundredfold.
// a benchmark that cannot be made is to say so
#![allow(clippy::unwrap_used)]

use std::time::Instant;

use coadjoint::prelude::*;
use coadjoint::{Discretized, System};
use coadjoint_systems::free_rigid_body::{FreeRigidBody, FreeRigidBodyState};
use coadjoint_systems::heavy_top::{HeavyTop, HeavyTopState};

/// Unless asked otherwise.
const STEPS: u64 = 1_000_000;

fn main() {
    let asked = std::env::args().skip(1).find_map(|argument| argument.parse().ok());
    let steps = asked.unwrap_or(STEPS);
    let body = FreeRigidBody { inertia: vector![1.0, 10.0, 100.0] };
    let start = FreeRigidBodyState { attitude: UnitQuaternion::identity(), momentum: vector![1.0, 1.0, 1.0] };
    let of_body = |state: &FreeRigidBodyState| {
        let spatial = state.attitude * state.momentum;
        [state.momentum.norm_squared(), spatial.x, spatial.y, spatial.z]
    };
    let names = ["|Π|²", "RΠ, x", "RΠ, y", "RΠ, z"];
    run::<_, Cayley, 4>("free body, Cayley", names, &body, &start, of_body, steps);
    run::<_, Compensated<Cayley>, 4>("free body, Cayley, compensated", names, &body, &start, of_body, steps);
    run::<_, Exponential, 4>("free body, exponential", names, &body, &start, of_body, steps);
    run::<_, Compensated<Exponential>, 4>(
        "free body, exponential, compensated",
        names,
        &body,
        &start,
        of_body,
        steps,
    );

    let top = HeavyTop { inertia: vector![1.0, 10.0, 100.0], weight: 1.0, chi: vector![0.3, 0.2, 1.0] };
    let start = HeavyTopState {
        attitude: UnitQuaternion::identity(),
        momentum: vector![1.0, 1.0, 1.0],
        gamma: vector![0.0, 0.6, 0.8],
    };
    let of_top = |state: &HeavyTopState| {
        let vertical = state.attitude * state.gamma;
        [state.gamma.norm_squared(), state.momentum.dot(&state.gamma), vertical.y, vertical.z]
    };
    let names = ["|Γ|²", "Π·Γ", "RΓ, y", "RΓ, z"];
    run::<_, Cayley, 4>("heavy top, Cayley", names, &top, &start, of_top, steps);
    run::<_, Compensated<Cayley>, 4>("heavy top, Cayley, compensated", names, &top, &start, of_top, steps);
}

fn run<S, M, const N: usize>(
    title: &str,
    names: [&str; N],
    system: &S,
    start: &S::State,
    invariants: impl Fn(&S::State) -> [f64; N],
    steps: u64,
) where
    S: System<Scalar = f64> + Discretized<M>,
    S::State: Clone,
{
    println!("\n{title}\n{:>12} {}", "steps", names.map(|name| format!("{name:>9}")).join(" "));
    let mut state = start.clone();
    let initial = invariants(start);
    let mut stepper = system.stepper::<M>(0.01).unwrap();
    let mut largest = [0.0_f64; N];
    let mut next = 100;
    let clock = Instant::now();
    for step in 1..=steps {
        stepper.step(&mut state).unwrap();
        // now and then, and at every step around what is printed
        if step % 97 == 0 || step + 100 > next {
            for ((largest, now), initial) in largest.iter_mut().zip(invariants(&state)).zip(initial) {
                *largest = largest.max(((now - initial) / initial).abs());
            }
        }
        if step == next {
            println!("{step:>12} {}", largest.map(|error| format!("{error:9.1e}")).join(" "));
            next *= 10;
        }
    }
    println!("{:.0} ns per step", clock.elapsed().as_secs_f64() / steps as f64 * 1e9);
}
