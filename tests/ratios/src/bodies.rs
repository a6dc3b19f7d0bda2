//! Cases that every commit can take: bodies with a kinetic and a potential energy.

use crate::case::{Case, ensembles, long, one_by_one, three_ways};
use coadjoint::prelude::*;

#[lie_poisson_system(group = SO3)]
#[derive(Clone, Debug, PartialEq)]
struct FreeBody {
    #[inertia]
    inertia: Vector3<f64>,
}

#[lie_poisson_system(group = SO3, advected(gamma: R3), potential = weight * gamma.dot(&chi))]
#[derive(Clone, Debug, PartialEq)]
struct Top {
    #[inertia]
    inertia: Vector3<f64>,
    weight: f64,
    chi: Vector3<f64>,
}

#[lie_poisson_system(
    group(attitude: SO3, position: R3),
    control(moment: R3, thrust: f64),
    potential = mass * gravity * position.z,
    force(attitude = moment, position = attitude * (thrust * Vector3::z())),
)]
#[derive(Clone, Debug, PartialEq)]
struct Quadrotor {
    #[inertia(attitude)]
    inertia: Vector3<f64>,
    #[inertia(position)]
    mass: f64,
    gravity: f64,
}

#[lie_poisson_system(
    group(first: SO3, second: SO3),
    potential = {
        let between = first.inverse() * second;
        2.0 * stiffness * (1.0 - between.w.powi(2))
    },
)]
#[derive(Clone, Debug, PartialEq)]
struct Coupled {
    #[inertia(first)]
    first_inertia: Vector3<f64>,
    #[inertia(second)]
    second_inertia: Vector3<f64>,
    stiffness: f64,
}

/// Momenta of a member, some thousandths from those of the one before.
fn spread(momentum: &Vector3<f64>, member: usize) -> Vector3<f64> {
    momentum.component_mul(&vector![1.0, 2.0, 3.0].map(|rate| 1.0 + 1e-3 * rate * member as f64))
}

/// A scheme's ways, long runs with a larger step, and ensembles.
macro_rules! all_ways {
    ($cases:expr, $name:literal, $scheme:ty, $system:expr, $state:expr) => {{
        let (none, state) = (NoControl::default(), $state);
        three_ways!($cases, $name, $scheme, $system, state, &none);
        let large = $system.stepper::<$scheme>(0.1).expect("a system that can be stepped");
        $cases.push(long(concat!($name, ", h = 0.1"), large, state, &none, 40_000));
        let member = |k| {
            let mut member = state.clone();
            member.momentum = spread(&state.momentum, k);
            member
        };
        $cases.extend(ensembles::<_, $scheme>($name, $system, member, 0.01));
    }};
}

pub(crate) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    free_body(&mut cases);
    heavy_top(&mut cases);
    quadrotor(&mut cases);
    coupled_bodies(&mut cases);
    cases
}

fn free_body(cases: &mut Vec<Case>) {
    let body = FreeBody { inertia: vector![1.0, 10.0, 100.0] };
    let state = FreeBodyState { attitude: UnitQuaternion::identity(), momentum: vector![1.0, 1.0, 1.0] };
    all_ways!(cases, "free body, Cayley", Cayley, &body, &state);
    all_ways!(cases, "free body, exponential", Exponential, &body, &state);
    all_ways!(cases, "free body, fused Cayley", Fused<Cayley>, &body, &state);
}

fn heavy_top(cases: &mut Vec<Case>) {
    let top = Top { inertia: vector![1.0, 10.0, 100.0], weight: 1.0, chi: vector![0.0, 0.0, 1.0] };
    let state = TopState {
        attitude: UnitQuaternion::identity(),
        momentum: vector![1.0, 1.0, 1.0],
        gamma: Vector3::z(),
    };
    all_ways!(cases, "heavy top, Cayley", Cayley, &top, &state);
    all_ways!(cases, "heavy top, exponential", Exponential, &top, &state);
    all_ways!(cases, "heavy top, fused Cayley", Fused<Cayley>, &top, &state);
    let (none, step) = (NoControl::default(), 0.01);
    let order_4 = top.stepper::<Order4<Cayley>>(step).expect("a top");
    cases.push(long("heavy top, Cayley of order 4", order_4, &state, &none, 40_000));

    // with no zeros among what it is multiplied with
    let top = Top { chi: vector![0.3, 0.2, 1.0], ..top };
    let stepper = top.stepper::<Cayley>(step).expect("a top");
    cases.push(long("oblique heavy top, Cayley", stepper, &state, &none, 40_000));
    let stepper = top.stepper::<Exponential>(step).expect("a top");
    cases.push(long("oblique heavy top, exponential", stepper, &state, &none, 40_000));
    let stepper = top.stepper::<Fused<Cayley>>(step).expect("a top");
    cases.push(long("oblique heavy top, fused Cayley", stepper, &state, &none, 40_000));
}

fn quadrotor(cases: &mut Vec<Case>) {
    let quadrotor = Quadrotor { inertia: vector![0.03, 0.03, 0.04], mass: 1.0, gravity: 9.81 };
    let state = QuadrotorState {
        attitude: UnitQuaternion::identity(),
        attitude_momentum: vector![0.01, 0.02, 0.03],
        position: Vector3::zeros(),
        position_momentum: Vector3::zeros(),
    };
    let hover = QuadrotorControl { moment: Vector3::zeros(), thrust: 9.81 };
    three_ways!(cases, "quadrotor, Cayley", Cayley, &quadrotor, &state, &hover);
    three_ways!(cases, "quadrotor, exponential", Exponential, &quadrotor, &state, &hover);
    for (jumps, size) in [("0", 0.0), ("1e-9", 1e-9), ("1e-6", 1e-6), ("1e-3", 1e-3), ("0.1", 0.1)] {
        const MOMENTS: u64 = 997;
        // from −1 to 1, and never twice in a row
        let scattered = |number: f64| 2.0 * (number % 1.0) - 1.0;
        let moments: Vec<_> = (0..MOMENTS)
            .map(|k| vector![0.0, 0.414, 0.828].map(|shift| scattered(k as f64 * 0.618_034 + shift)))
            .map(|direction: Vector3<f64>| direction * (0.01 * size))
            .collect();
        let jumping =
            move |step: u64| QuadrotorControl { moment: moments[(step % MOMENTS) as usize], thrust: 9.81 };
        let stepper = quadrotor.stepper::<Cayley>(0.01).expect("a quadrotor");
        cases.push(one_by_one(
            &format!("quadrotor, Cayley, jumps of {jumps}"),
            stepper,
            &state,
            jumping,
            8_000,
        ));
    }
}

fn coupled_bodies(cases: &mut Vec<Case>) {
    let bodies = Coupled {
        first_inertia: vector![1.0, 2.0, 2.5],
        second_inertia: vector![2.0, 1.5, 1.0],
        stiffness: 1.0,
    };
    let state = CoupledState {
        first: UnitQuaternion::identity(),
        first_momentum: vector![0.3, 1.0, -0.5],
        second: UnitQuaternion::identity(),
        second_momentum: vector![-0.4, 0.2, 1.0],
    };
    let none = NoControl::default();
    three_ways!(cases, "coupled bodies, Cayley", Cayley, &bodies, &state, &none);
    three_ways!(cases, "coupled bodies, exponential", Exponential, &bodies, &state, &none);
}
