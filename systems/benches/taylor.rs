//! What Taylor steps cost: `cargo bench --bench taylor`.
//!
//! Free bodies and heavy tops with moments 1, 10, 100 kg m², 64 of each, to a common time: one after the other, and side by side by each of the
//! processor's instructions, in turns. Nanoseconds for a step of a member, the least of many rounds, and how many times as fast that is as one
//! after the other.
//!
//! `cargo bench --bench taylor -- body 1e-9 20` takes one body for 1800 s, as often as that, and prints the least seconds, the steps, and the
//! numbers of the state at the end: `python/benchmarks/heyoka.py` compares them.
// a benchmark that cannot be made is to say so
#![allow(clippy::unwrap_used)]

use std::time::Instant;

use coadjoint::ensemble::Instructions;
use coadjoint::prelude::*;
use coadjoint::taylor::{self, PowerSeries};
use coadjoint::{State, System};

/// How many members there are, and how long they take part in a round, s: a few milliseconds.
const MEMBERS: usize = 64;
const SPAN: f64 = 10.0;
const ROUNDS: usize = 300;

/// A free rigid body.
#[lie_poisson_system(group = SO3, retractions(Exponential), taylor)]
struct Body {
    #[inertia]
    inertia: Vector3<f64>,
}

/// A heavy top.
#[lie_poisson_system(
    group = SO3,
    advected(gamma: R3),
    potential = gamma.dot(&chi),
    retractions(Exponential),
    taylor
)]
struct Top {
    #[inertia]
    inertia: Vector3<f64>,
    chi: Vector3<f64>,
}

fn body() -> (Body, impl Fn(usize) -> BodyState) {
    let start = |k: usize| BodyState {
        attitude: UnitQuaternion::identity(),
        momentum: vector![1.0 + 1e-3 * k as f64, 1.0, 1.0],
    };
    (Body { inertia: vector![1.0, 10.0, 100.0] }, start)
}

fn top() -> (Top, impl Fn(usize) -> TopState) {
    let start = |k: usize| TopState {
        attitude: UnitQuaternion::identity(),
        momentum: vector![1.0 + 1e-3 * k as f64, 1.0, 1.0],
        gamma: Vector3::z(),
    };
    (Top { inertia: vector![1.0, 10.0, 100.0], chi: vector![0.3, 0.2, 1.0] }, start)
}

/// The rows of a tolerance.
fn together<S>(name: &str, (system, start): &(S, impl Fn(usize) -> S::State), tolerance: f64)
where
    S: PowerSeries + System<Scalar = f64>,
    taylor::Adaptive<S>: Send,
    S::State: Send,
{
    let mut best: Vec<_> =
        Instructions::available().map(|instructions| (instructions, f64::INFINITY)).collect();
    let mut steps = 0;
    for _ in 0..ROUNDS {
        for (instructions, best) in &mut best {
            let member = |k| (system.adaptive(tolerance).unwrap(), start(k));
            let mut members: Vec<_> = (0..MEMBERS).map(member).collect();
            let clock = Instant::now();
            let reports = taylor::all_to_with(&mut members, SPAN, *instructions);
            *best = best.min(clock.elapsed().as_secs_f64());
            steps = reports.into_iter().map(|report| report.unwrap().steps).sum();
        }
    }
    let alone = best[0].1;
    let cells = best.iter().map(|(instructions, time)| {
        format!("{instructions:?} {:.0} ns ({:.2})", time * 1e9 / steps as f64, alone / time)
    });
    println!("{name}, {tolerance:e}: {}", cells.collect::<Vec<_>>().join(", "));
}

/// One motion.
fn alone<S>((system, start): &(S, impl Fn(usize) -> S::State), tolerance: f64, rounds: usize)
where
    S: PowerSeries + System<Scalar = f64>,
{
    let (mut best, mut end, mut steps) = (f64::INFINITY, start(0), 0);
    for _ in 0..rounds {
        end = start(0);
        let clock = Instant::now();
        steps = system.adaptive(tolerance).unwrap().to(&mut end, 1800.0).unwrap().steps;
        best = best.min(clock.elapsed().as_secs_f64());
    }
    let numbers = end.to_components().as_ref().iter().map(f64::to_string).collect::<Vec<_>>();
    println!("{best} {steps} {}", numbers.join(" "));
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|argument| argument != "--bench").collect();
    if let [name, tolerance, rounds] = &arguments[..] {
        let (tolerance, rounds) = (tolerance.parse().unwrap(), rounds.parse().unwrap());
        match &name[..] {
            "body" => alone(&body(), tolerance, rounds),
            _ => alone(&top(), tolerance, rounds),
        }
        return;
    }
    for tolerance in [1e-9, 1e-12, 1e-15] {
        together("free body", &body(), tolerance);
        together("heavy top", &top(), tolerance);
    }
}
