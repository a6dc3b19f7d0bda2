//! Steps that turn by radians: what is remembered of earlier steps makes no difference, and what has a solution is
//! solved.

use coadjoint::Discretized;
use coadjoint::prelude::*;
use coadjoint_support::random::Random;

use crate::runs::scheme;

/// A free body.
#[lie_poisson_system(group = SO3, methods(Midpoint))]
struct Body {
    #[inertia]
    inertia: Vector3<f64>,
}

/// How many bodies are thrown, unless `COADJOINT_STATES` says it; each takes 50 steps.
const BODIES: usize = 200;
const STEPS: usize = 50;

fn bodies() -> usize {
    std::env::var("COADJOINT_STATES").ok().and_then(|states| states.parse().ok()).unwrap_or(BODIES)
}

/// A body of mass that turns by up to so many radians a step: its system, its state, the step.
fn thrown(random: &mut Random, least: f64, most: f64, thin: f64) -> (Body, BodyState, f64) {
    let mut length = || 10_f64.powf(random.between(thin, 0.0));
    let [a, b, c] = [length(), length(), length()];
    let body = Body { inertia: vector![b + c, c + a, a + b] };
    let velocity = random.direction().component_div(&body.inertia.map(f64::sqrt));
    let momentum = body.inertia.component_mul(&velocity);
    let step = random.between(least, most) / velocity.norm();
    (body, BodyState { attitude: random.rotation(), momentum }, step)
}

/// How many steps were taken, how many of a stepper that remembers were other ones than a new stepper's, and how many
/// were refused by both.
#[derive(Debug, Default, PartialEq)]
struct Counts {
    taken: usize,
    other: usize,
    refused: usize,
}

fn compared<M>(least: f64, most: f64) -> Counts
where
    Body: Discretized<M>,
{
    let (mut counts, mut random) = (Counts::default(), Random::new(5));
    for _ in 0..bodies() {
        let (body, mut state, step) = thrown(&mut random, least, most, -3.0);
        let start = state;
        let mut warm = body.stepper::<M>(step).expect("a stepper");
        for k in 0..STEPS {
            let before = state;
            let mut new = body.stepper::<M>(step).expect("a stepper");
            let (mut cold, is_warm) = (state, warm.step(&mut state));
            let is_cold = new.step(&mut cold);
            counts.taken += 1;
            let is_same = match (is_warm, is_cold) {
                (Ok(_), Ok(_)) => (state.momentum - cold.momentum).norm() <= 1e-9 * cold.momentum.norm(),
                (Err(warm), Err(cold)) => {
                    assert_eq!((state, warm), (before, cold), "the state is as it was");
                    counts.refused += 1;
                    break;
                }
                _ => false,
            };
            if !is_same {
                if counts.other < 10 {
                    println!(
                        "{}: inertia {:?}, step {step:?}, from {start:?} after {k} at {before:?}: warm {is_warm:?} {:?}, cold {is_cold:?} {:?}",
                        scheme::<M>(),
                        body.inertia,
                        state.momentum,
                        cold.momentum
                    );
                }
                counts.other += 1;
                break;
            }
        }
    }
    println!("{}, {least} to {most} rad: {counts:?}", scheme::<M>());
    counts
}

#[test]
fn what_is_remembered_makes_no_difference() {
    let mut other = 0;
    for (least, most) in [(0.1, 1.0), (1.0, 2.0), (2.0, 3.0)] {
        other += compared::<Midpoint<Exponential>>(least, most).other;
        other += compared::<Midpoint<Cayley>>(least, most).other;
        other += compared::<Exponential>(least, most).other;
        other += compared::<Cayley>(least, most).other;
    }
    assert_eq!(other, 0);
}

#[test]
fn a_body_that_once_went_two_ways() {
    let body = Body { inertia: vector![77.41284590812963, 0.10643955810373879, 77.45194463953506] };
    let momentum = vector![62.52318215599677, -0.06269836007107048, 2.0572153086487885];
    let mut state = BodyState { attitude: UnitQuaternion::identity(), momentum };
    let step = 1.395619633208926;
    let mut warm = body.stepper::<Midpoint>(step).expect("a stepper");
    for k in 0..100 {
        let mut cold = state;
        let mut new = body.stepper::<Midpoint>(step).expect("a stepper");
        let (is_warm, is_cold) = (warm.step(&mut state), new.step(&mut cold));
        match (is_warm, is_cold) {
            (Ok(_), Ok(_)) => {
                let off = (state.momentum - cold.momentum).norm() / cold.momentum.norm();
                assert!(off < 1e-12, "step {k}: {state:?} and {cold:?}");
            }
            (warm, cold) => {
                assert_eq!((warm, state), (cold, state), "step {k}");
                return;
            }
        }
    }
}

/// A thin rod that turns by a third of a radian: a new stepper takes its step too.
#[test]
fn a_thin_rod_begins() {
    let body = Body { inertia: vector![0.04104427659996794, 39.23006911466342, 39.223053757840454] };
    let momentum = vector![-0.004626676865169908, 0.18830287015202424, 38.97260433369649];
    let mut state = BodyState { attitude: UnitQuaternion::identity(), momentum };
    body.stepper::<Cayley>(0.49252971536412776).expect("a stepper").step(&mut state).expect("a step");
    assert!((state.momentum.norm() / momentum.norm() - 1.0).abs() < 1e-13);
}

#[test]
fn thin_rods_begin() {
    let (mut refused, mut random) = (Vec::new(), Random::new(9));
    let count = 25 * bodies();
    for _ in 0..count {
        let (body, mut state, step) = thrown(&mut random, 0.0, 0.5, -4.0);
        let start = state;
        if let Err(error) = body.stepper::<Cayley>(step).expect("a stepper").step(&mut state) {
            refused.push(format!("inertia {:?}, step {step:?}, {start:?}: {error}", body.inertia));
        }
    }
    println!("{} of {count} refused", refused.len());
    assert!(refused.is_empty(), "{} of {count} refused:\n{}", refused.len(), refused.join("\n"));
}
