//! Steps in compensated arithmetic: the same steps, with roundoff of the second order.
// in a test, a panic is the report
#![allow(clippy::unwrap_used)]

use coadjoint::prelude::*;
use coadjoint::{Discretized, Ensemble};

use crate::systems::{Single, SingleState, Top, TopState};

/// With an elementary function in its potential.
#[lie_poisson_system(group = R1, potential = -weight * position.x.cos())]
#[derive(Clone)]
struct Pendulum {
    #[inertia]
    inertia: f64,
    weight: f64,
}

/// The same in double precision.
#[lie_poisson_system(group = SO3)]
#[derive(Clone)]
struct Twice {
    #[inertia]
    inertia: Vector3<f64>,
}

fn top() -> (Top, TopState) {
    let top = Top { inertia: vector![1.0, 10.0, 100.0], weight: 1.0, chi: vector![0.3, 0.2, 1.0] };
    let state = TopState {
        attitude: UnitQuaternion::identity(),
        momentum: vector![1.0, 1.0, 1.0],
        gamma: vector![0.0, 0.6, 0.8],
    };
    (top, state)
}

/// `|Γ|²`, `Π·Γ`, the vertical in space, and the momentum about it.
fn invariants(state: &TopState) -> [f64; 5] {
    let vertical = state.attitude * state.gamma;
    [state.gamma.norm_squared(), state.momentum.dot(&state.gamma), vertical.x, vertical.y, vertical.z]
}

/// The largest difference.
fn largest<const N: usize>(a: [f64; N], b: [f64; N]) -> f64 {
    a.iter().zip(b).fold(0.0, |largest, (a, b)| (a - b).abs().max(largest))
}

#[test]
fn invariants_hold_to_one_rounding() {
    fn drift<M>() -> f64
    where
        Top: Discretized<M>,
    {
        let (top, start) = top();
        let mut state = start;
        let mut stepper = top.stepper::<M>(0.01).unwrap();
        let mut drift: f64 = 0.0;
        for _ in 0..20_000 {
            stepper.step(&mut state).unwrap();
            drift = drift.max(largest(invariants(&state), invariants(&start)));
        }
        drift
    }
    // measured: 4e-16 to 6e-16 against 1e-14 to 3e-14
    for (plain, compensated) in [
        (drift::<Cayley>(), drift::<Compensated<Cayley>>()),
        (drift::<Exponential>(), drift::<Compensated<Exponential>>()),
        (drift::<Order4<Cayley>>(), drift::<Compensated<Order4<Cayley>>>()),
    ] {
        println!("{plain:.1e} {compensated:.1e}");
        assert!(compensated < 1e-15, "{compensated:e}");
        assert!(plain > 3e-15, "{plain:e}");
    }
}

#[test]
fn steps_are_the_same_but_for_rounding() {
    let (top, mut state) = top();
    let mut stepper = top.stepper::<Exponential>(0.02).unwrap();
    for _ in 0..200 {
        let mut other = state;
        top.stepper::<Compensated<Exponential>>(0.02).unwrap().step(&mut other).unwrap();
        stepper.step(&mut state).unwrap();
        let difference = (state.momentum - other.momentum).norm()
            + (state.gamma - other.gamma).norm()
            + (state.attitude.coords - other.attitude.coords).norm();
        assert!(difference < 3e-15, "{difference:e}");
    }
    let pendulum = Pendulum { inertia: 1.0, weight: 2.0 };
    let mut plain = PendulumState { position: vector![1.0], momentum: vector![0.3] };
    let mut compensated = plain;
    let mut stepper = pendulum.stepper::<Cayley>(0.05).unwrap();
    let mut other = pendulum.stepper::<Compensated<Cayley>>(0.05).unwrap();
    for _ in 0..1_000 {
        stepper.step(&mut plain).unwrap();
        other.step(&mut compensated).unwrap();
    }
    let difference =
        (plain.position - compensated.position).norm() + (plain.momentum - compensated.momentum).norm();
    assert!(difference > 0.0 && difference < 1e-12, "{difference:e}");
}

/// In single precision double precision is the judge.
#[test]
fn single_precision_comes_to_the_nearest_number() {
    let start = vector![0.3_f32, -0.5, 0.8];
    let inertia = vector![1.0_f32, 2.0, 2.5];
    let single = Single { inertia };
    let twice = Twice { inertia: inertia.cast() };
    let mut plain = SingleState { attitude: UnitQuaternion::identity(), momentum: start };
    let mut compensated = plain;
    let mut exact = TwiceState { attitude: UnitQuaternion::identity(), momentum: start.cast() };
    // a step that is the same number in both
    let mut steppers = (
        single.stepper::<Exponential>(0.125).unwrap(),
        single.stepper::<Compensated<Exponential>>(0.125).unwrap(),
        twice.stepper::<Exponential>(0.125).unwrap(),
    );
    for _ in 0..5_000 {
        steppers.0.step(&mut plain).unwrap();
        steppers.1.step(&mut compensated).unwrap();
        steppers.2.step(&mut exact).unwrap();
    }
    let error = |state: &SingleState| {
        let attitude = state.attitude.coords.cast::<f64>() - exact.attitude.coords;
        (state.momentum.cast::<f64>() - exact.momentum).amax().max(attitude.amax())
    };
    println!("{:.1e} {:.1e}", error(&plain), error(&compensated));
    assert!(error(&compensated) < 1e-7, "{:e}", error(&compensated));
    assert!(error(&plain) > 1e-6, "{:e}", error(&plain));
}

#[test]
fn what_is_carried_can_be_written_down() {
    let (top, mut state) = top();
    let mut stepper = top.stepper::<Compensated<Cayley>>(0.01).unwrap();
    for _ in 0..100 {
        stepper.step(&mut state).unwrap();
    }
    let (memory, mut saved) = (stepper.snapshot(), state);
    let mut other = top.stepper::<Compensated<Cayley>>(0.01).unwrap();
    other.restore(&memory).unwrap();
    for _ in 0..50 {
        stepper.step(&mut state).unwrap();
        other.step(&mut saved).unwrap();
        assert_eq!(state, saved);
    }
}

#[test]
fn another_state_starts_anew_and_bad_ones_are_refused() {
    let (top, start) = top();
    let mut stepper = top.stepper::<Compensated<Cayley>>(0.01).unwrap();
    let mut state = start;
    for _ in 0..20 {
        stepper.step(&mut state).unwrap();
    }
    let mut again = start;
    stepper.step(&mut again).unwrap();
    let mut fresh = start;
    top.stepper::<Compensated<Cayley>>(0.01).unwrap().step(&mut fresh).unwrap();
    assert_eq!(again, fresh);

    let mut bad = TopState { momentum: vector![f64::NAN, 0.0, 0.0], ..start };
    assert_eq!(stepper.step(&mut bad), Err(StepError::NotFinite));
    // and goes on as if nothing had been
    let mut expected = again;
    stepper.step(&mut again).unwrap();
    top.stepper::<Compensated<Cayley>>(0.01).unwrap().step(&mut expected).unwrap();
    assert!((again.momentum - expected.momentum).norm() < 3e-16);
}

#[test]
fn members_of_an_ensemble_are_compensated_too() {
    let (top, start) = top();
    let states: Vec<_> = (0..11)
        .map(|k| TopState { momentum: start.momentum * (1.0 + 0.01 * f64::from(k)), ..start })
        .collect();
    let mut ensemble =
        Ensemble::<Top, Compensated<Cayley>>::new(std::iter::repeat(&top), states.clone(), 0.01).unwrap();
    ensemble.run(300);
    assert!(ensemble.failed().is_empty());
    for (mut state, together) in states.into_iter().zip(ensemble.states()) {
        let mut stepper = top.stepper::<Compensated<Cayley>>(0.01).unwrap();
        for _ in 0..300 {
            stepper.step(&mut state).unwrap();
        }
        assert_eq!(state, together);
    }
}
