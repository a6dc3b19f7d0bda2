//! What derivatives cost: `cargo bench --bench derivatives`.
//!
//! The heavy top of the paper: a step with its 9 × 9 Jacobian against a step of RK4 written by hand, and against the same step with dual
//! numbers in nine directions; the derivative of a run of 10,000 steps, backwards, against the run. All in turn, the best of many rounds
//! each.
// a benchmark that cannot be made is to say so
#![allow(clippy::unwrap_used)]

use std::hint::black_box;
use std::time::Instant;

use coadjoint::__private::Kernel;
use coadjoint::derivative::{CheckpointedTape, Parts, WrtParameters, WrtState};
use coadjoint::nalgebra::{SMatrix, SVector, Vector6};
use coadjoint::prelude::*;
use coadjoint::system::Generated;
use coadjoint::{Discretized, Run};
use coadjoint_systems::classical::{AttitudeState, Rk4Quaternion, Timed, bodies};
use num_dual::DualSVec64;

/// The catalogue's, which is described without derivatives.
#[lie_poisson_system(group = SO3, advected(gamma: R3), potential = weight * gamma.dot(&chi), derivatives)]
struct HeavyTop {
    #[inertia]
    inertia: Vector3<f64>,
    weight: f64,
    chi: Vector3<f64>,
}

const STEP: f64 = 0.01;
/// Steps of a run whose derivative is taken.
const RUN: u64 = 10_000;
/// Steps that are timed together, otherwise.
const STEPS: u64 = 4_000;
const ROUNDS: usize = 40;

type Dual = DualSVec64<9>;

/// What is timed: so many steps.
type Walk<'a> = Box<dyn FnMut(u64) + 'a>;

fn main() {
    let top = HeavyTop { inertia: vector![1.0, 10.0, 100.0], weight: 1.0, chi: Vector3::z() };
    let start = HeavyTopState {
        attitude: UnitQuaternion::identity(),
        momentum: vector![1.0, 1.0, 1.0],
        gamma: Vector3::z(),
    };
    let heavy = bodies::HeavyTop::new(top.inertia, top.weight, top.chi);
    let (m, gamma) = (start.momentum, start.gamma);
    let y: Vector6<f64> = vector![m.x, m.y, m.z, gamma.x, gamma.y, gamma.z];
    let at = AttitudeState { attitude: start.attitude, y };

    let mut cases: Vec<(&str, u64, Walk<'_>)> = vec![
        ("RK4 by hand", STEPS, {
            let mut state = at;
            Box::new(move |steps| {
                state = Rk4Quaternion.run(&heavy, state, STEP, steps).unwrap();
                black_box(&state);
            })
        }),
        ("Cayley", STEPS, plain::<Cayley>(&top, start)),
        ("Cayley, by the state", STEPS, {
            let (mut stepper, mut state) = (top.stepper::<Cayley>(STEP).unwrap(), start);
            Box::new(move |steps| {
                for _ in 0..steps {
                    let step = stepper.step_with_jacobian(&mut state, &NoControl::default(), WrtState);
                    black_box(step.unwrap().0);
                }
            })
        }),
        ("Cayley, by state and parameters", STEPS, {
            let (mut stepper, mut state) = (top.stepper::<Cayley>(STEP).unwrap(), start);
            let blocks = (WrtState, WrtParameters);
            Box::new(move |steps| {
                for _ in 0..steps {
                    let step = stepper.step_with_jacobian(&mut state, &NoControl::default(), blocks);
                    black_box(step.unwrap().0);
                }
            })
        }),
        ("Cayley, by dual numbers", STEPS / 8, dual(&top, start)),
        ("Cayley, one direction", STEPS, {
            let (mut stepper, mut state) = (top.stepper::<Cayley>(STEP).unwrap(), start);
            let perturbation = Parts { state: SVector::repeat(1.0), ..Parts::default() };
            Box::new(move |steps| {
                for _ in 0..steps {
                    let step = stepper.step_with_derivative(&mut state, &NoControl::default());
                    black_box(step.unwrap().0.tangent(black_box(&perturbation)));
                }
            })
        }),
        ("Cayley, backwards", STEPS, {
            let (mut stepper, mut state) = (top.stepper::<Cayley>(STEP).unwrap(), start);
            let costate = SVector::repeat(1.0);
            Box::new(move |steps| {
                for _ in 0..steps {
                    let step = stepper.step_with_derivative(&mut state, &NoControl::default());
                    black_box(step.unwrap().0.adjoint(black_box(&costate)));
                }
            })
        }),
        ("exponential", STEPS, plain::<Exponential>(&top, start)),
        ("exponential, by the state", STEPS, {
            let (mut stepper, mut state) = (top.stepper::<Exponential>(STEP).unwrap(), start);
            Box::new(move |steps| {
                for _ in 0..steps {
                    let step = stepper.step_with_jacobian(&mut state, &NoControl::default(), WrtState);
                    black_box(step.unwrap().0);
                }
            })
        }),
        ("a run, Cayley", RUN, {
            let top = &top;
            Box::new(move |steps| {
                let (mut stepper, mut state) = (top.stepper::<Cayley>(STEP).unwrap(), start);
                Run::new(&mut stepper, &mut state).steps(steps).unwrap();
                black_box(state);
            })
        }),
        ("a run, and its derivative backwards", RUN, {
            let top = &top;
            let costate = SVector::repeat(1.0);
            Box::new(move |steps| {
                let (mut stepper, mut state) = (top.stepper::<Cayley>(STEP).unwrap(), start);
                let run = CheckpointedTape::new(&mut stepper, &mut state, steps, |_| NoControl::default());
                black_box(run.unwrap().gradient(black_box(&costate)).unwrap());
            })
        }),
    ];

    let mut best = vec![f64::INFINITY; cases.len()];
    for _ in 0..ROUNDS {
        for (best, (_, steps, walk)) in best.iter_mut().zip(&mut cases) {
            let clock = Instant::now();
            walk(*steps);
            *best = best.min(clock.elapsed().as_secs_f64() * 1e9 / *steps as f64);
        }
    }
    println!("{:38} {:>8} {:>8}", "heavy top", "ns/step", "× RK4");
    for ((name, ..), time) in cases.iter().zip(&best) {
        println!("{name:38} {time:8.1} {:8.2}", time / best[0]);
    }
    let of = |name: &str| best[cases.iter().position(|(known, ..)| *known == name).unwrap()];
    println!(
        "dual numbers take {:.1} times as long as the Jacobian in closed form",
        of("Cayley, by dual numbers") / of("Cayley, by the state")
    );
    let ratio = of("a run, and its derivative backwards") / of("a run, Cayley");
    let (mut stepper, mut state) = (top.stepper::<Cayley>(STEP).unwrap(), start);
    let run = CheckpointedTape::new(&mut stepper, &mut state, RUN, |_| NoControl::default()).unwrap();
    println!(
        "backwards through {RUN} steps: {ratio:.1} times the run, {} states kept",
        run.checkpoint_count()
    );
}

fn plain<'a, M: 'a>(top: &HeavyTop, start: HeavyTopState) -> Walk<'a>
where
    HeavyTop: Discretized<M>,
{
    let (mut stepper, mut state) = (top.stepper::<M>(STEP).unwrap(), start);
    Box::new(move |steps| {
        for _ in 0..steps {
            stepper.step(&mut state).unwrap();
        }
        black_box(&state);
    })
}

/// The step in real numbers as it is taken otherwise, then once with dual numbers: one of Newton's corrections from the solution gives the
/// derivative of the solution.
fn dual<'a>(top: &HeavyTop, start: HeavyTopState) -> Walk<'a> {
    type Step<T> = <HeavyTop as Generated<SymplecticEulerA<Cayley>>>::Kernel<T>;
    let (mut stepper, mut state) = (top.stepper::<Cayley>(STEP).unwrap(), start);
    let parameters = top.to_parameters();
    let kernel = Step::<Dual>::new(&parameters.map(Dual::from_re), Dual::from_re(STEP));
    let zero = Dual::from_re(0.0);
    Box::new(move |steps| {
        for _ in 0..steps {
            let place = state.to_components();
            // the attitude along δ, and each number of the rest along itself
            let [w, x, y, z, ..] = place.map(|value| 0.5 * value);
            let turns = [[-x, -y, -z], [w, -z, y], [z, w, -x], [-y, x, w]];
            let seeded: [Dual; 10] = std::array::from_fn(|i| match turns.get(i) {
                Some(turn) => Dual::new(
                    place[i],
                    num_dual::Derivative::some(SVector::from_fn(|j, _| turn.get(j).copied().unwrap_or(0.0))),
                ),
                None => Dual::from_re(place[i]).derivative(i - 1),
            });
            // the solution, which is known once the step is taken: from the next attitude, by the map's inverse
            stepper.step(&mut state).unwrap();
            let turn = UnitQuaternion::new_unchecked(Quaternion::new(place[0], place[1], place[2], place[3]))
                .inverse()
                * state.attitude;
            let unknown = turn.imag() * (2.0 / turn.w);
            let begun = kernel.begin(&seeded, zero, &[]);
            let mut solution = [unknown.x, unknown.y, unknown.z].map(Dual::from_re);
            let evaluation = kernel.evaluate(&seeded, &begun, &solution);
            let correction = kernel.correction(&seeded, &begun, &solution, &evaluation);
            for (x, correction) in solution.iter_mut().zip(correction) {
                *x -= correction;
            }
            let evaluation = kernel.evaluate(&seeded, &begun, &solution);
            let end = kernel.finish(&seeded, &begun, &solution, &evaluation);
            let row = |i: usize| {
                end[i].eps.unwrap_generic(coadjoint::nalgebra::Const::<9>, coadjoint::nalgebra::U1)
            };
            black_box(SMatrix::<f64, 10, 9>::from_fn(|i, j| row(i)[j]));
        }
    })
}
