//! Functions of the user's own in expressions mean what they would mean written out, and tables what the library makes of them.
// in a test, a panic is the report
#![allow(clippy::unwrap_used)]

use coadjoint::certify::Certification;
use coadjoint::derivative::{WrtParameters, WrtState};
use coadjoint::prelude::*;
use coadjoint::{Ensemble, Run, StepError};

mod air {
    use coadjoint::expression;
    use coadjoint::nalgebra::{self, Vector2, Vector3};

    pub(super) const SCALE: f64 = 8.5;

    /// Calls nothing.
    #[expression]
    pub(crate) fn density(height: f64) -> f64 {
        let above = height.max(0.0);
        1.2 * (-above / SCALE).exp()
    }

    /// Calls another one of its module, with names that stand for other things outside.
    #[expression]
    pub(super) fn drag(position: &Vector3<f64>, mass: f64, (v, _): (Vector3<f64>, f64)) -> Vector3<f64> {
        let velocity = -mass * v;
        density(position.z) * v.norm() * velocity
    }

    /// Of a number of whole turns, and two values at once.
    #[expression]
    pub(super) fn waves(n: i32, x: f64) -> (f64, Vector2<f64>) {
        (x.powi(n), nalgebra::Vector2::new(x.sin(), std::f64::consts::PI))
    }
}

use air::SCALE;
use air::density;

#[lie_poisson_system(
    group = R3,
    potential = {
        let (power, pair) = air::waves(2, position.x / SCALE);
        mass * (position.z + power + pair.dot(&vector![1.0, density(position.y)]))
    },
    force = air::drag(&position, size, (velocity, 0.0)),
    methods(Midpoint),
    derivatives(state),
)]
struct Called {
    #[inertia]
    mass: f64,
    size: f64,
}

#[lie_poisson_system(
    group = R3,
    potential = {
        let x = position.x / SCALE;
        let rare = 1.2 * (-position.y.max(0.0) / SCALE).exp();
        mass * (position.z + x.powi(2) + (x.sin() + std::f64::consts::PI * rare))
    },
    force = {
        let v = velocity;
        1.2 * (-position.z.max(0.0) / air::SCALE).exp() * v.norm() * (-size * v)
    },
    methods(Midpoint),
    derivatives(state),
)]
struct Written {
    #[inertia]
    mass: f64,
    size: f64,
}

#[test]
fn a_call_is_what_it_would_be_written_out() {
    let (called, written) = (Called { mass: 2.0, size: 0.3 }, Written { mass: 2.0, size: 0.3 });
    for position in [vector![0.3, 0.7, 2.0], vector![-0.3, -0.7, -2.0]] {
        let momentum = vector![1.0, -2.0, 3.0];
        let (mut one, mut other) = (CalledState { position, momentum }, WrittenState { position, momentum });
        assert!((called.energy(&one) - written.energy(&other)).abs() < 1e-14);
        assert!((called.potential(&one) - written.potential(&other)).abs() < 1e-14);
        assert!((called.force(&one) - written.force(&other)).norm() < 1e-14);
        let mut steps =
            (called.stepper::<Midpoint>(0.05).unwrap(), written.stepper::<Midpoint>(0.05).unwrap());
        for _ in 0..50 {
            let none = NoControl::default();
            let one = steps.0.step_with_jacobian(&mut one, &none, WrtState).unwrap().0;
            let other = steps.1.step_with_jacobian(&mut other, &none, WrtState).unwrap().0;
            assert!((one - other).amax() < 1e-13);
        }
        assert!((one.position - other.position).norm() < 1e-12 && one.position != position);
    }
}

/// Declared where it is used, in a function of Rust.
#[test]
fn a_function_may_be_local() {
    #[expression]
    fn well(x: f64, depth: f64) -> f64 {
        if x.abs() < 1.0 { -depth * (1.0 - x * x).powi(2) } else { 0.0 }
    }

    // in an event alone
    #[expression]
    fn right(x: f64) -> f64 {
        2.0 * x
    }

    #[lie_poisson_system(group = R1, potential = well(position.x, depth), event(middle = right(position.x)))]
    struct Trap {
        #[inertia]
        mass: f64,
        depth: f64,
    }

    let trap = Trap { mass: 1.0, depth: 2.0 };
    let mut state = TrapState { position: vector![0.5], momentum: vector![0.0] };
    let start = trap.energy(&state);
    assert_eq!(start, well(0.5, 2.0));
    let mut stepper = trap.stepper::<Order4<Exponential>>(0.01).unwrap();
    let (mut passes, mut last) = (0, state.position.x);
    Run::new(&mut stepper, &mut state)
        .on("middle", |event| {
            assert!(event.state().position.x.abs() < 1e-12);
            passes += 1;
        })
        .to(10.0)
        .unwrap();
    let mut again = (TrapState { position: vector![0.5], momentum: vector![0.0] }, 0);
    let mut stepper = trap.stepper::<Order4<Exponential>>(0.01).unwrap();
    for _ in 0..1000 {
        stepper.step(&mut again.0).unwrap();
        again.1 += u32::from(again.0.position.x * last < 0.0);
        last = again.0.position.x;
    }
    assert!(passes == again.1 && passes > 3, "{passes} instead of {}", again.1);
    assert!((trap.energy(&state) - start).abs() < 1e-7);
}

/// A bead on a wire whose height is known at some places, in wind that is known at some times.
#[lie_poisson_system(
    group = R1,
    potential = mass * gravity * height.spline(-length, length, position.x),
    force = vector![wind.spline(0.0, 3.0, t) - drag * velocity.x],
    methods(Midpoint),
    derivatives(state, parameters),
)]
#[derive(Clone)]
struct Bead {
    #[inertia]
    mass: f64,
    gravity: f64,
    length: f64,
    height: [f64; 8],
    wind: [f64; 3],
    drag: f64,
}

fn bead() -> Bead {
    let height = [1.0, 0.3, 0.1, -0.2, 0.0, 0.3, 0.8, 0.9];
    Bead { mass: 2.0, gravity: 9.81, length: 1.4, height, wind: [0.3, -0.5, 0.2], drag: 0.1 }
}

#[test]
fn tables_are_splines() {
    let bead = bead();
    let at = |x: f64| BeadState { position: vector![x], momentum: vector![0.7] };
    for k in -40..=40 {
        // knots among them, and places before and behind
        let x = 0.05 * f64::from(k);
        let expected = 2.0 * 9.81 * bead.height.spline(-1.4, 1.4, x) + 0.49 / 4.0;
        assert!((bead.energy(&at(x)) - expected).abs() < 1e-13, "{x}");
        assert!((bead.potential(&at(x)) + 0.49 / 4.0 - expected).abs() < 1e-13, "{x}");
    }
    // forces, second derivatives and all else between knots, and with controls of time
    let states = [0.31, -0.67, 1.1].map(at);
    let report = Certification::new(&bead).states(&states).time(0.2).run::<Midpoint>().unwrap();
    assert!(report.passed(), "{report}");
}

/// A table that is read from its end gives what it gives turned round; one without length, an error, and the state stays.
#[test]
fn a_table_has_a_length() {
    let start = BeadState { position: vector![0.3], momentum: vector![0.7] };
    let step = |length: f64, turned: bool| {
        let (mut bead, mut state) = (Bead { length, ..bead() }, start);
        if turned {
            bead.height.reverse();
        }
        let stepped = bead.stepper::<Exponential>(0.01).unwrap().step(&mut state);
        stepped.map(|_| state).map_err(|error| (error, state))
    };
    let (forward, backward) = (step(1.4, false).unwrap(), step(-1.4, true).unwrap());
    assert!((forward.momentum - backward.momentum).norm() < 1e-14);
    assert!((forward.momentum - start.momentum).norm() > 1e-3);
    assert_eq!(step(0.0, false).unwrap_err(), (StepError::NotFinite, start));
}

#[test]
fn members_look_up_tables_as_alone() {
    let starts: Vec<_> = (0..9)
        .map(|k| BeadState { position: vector![0.4 * f64::from(k) - 1.6], momentum: vector![0.0] })
        .collect();
    let mut ensemble = Ensemble::<_, Exponential>::new(&vec![bead(); 9], starts.clone(), 0.01).unwrap();
    ensemble.run(300);
    for (together, mut alone) in ensemble.states().zip(starts) {
        let mut stepper = bead().stepper::<Exponential>(0.01).unwrap();
        (0..300).for_each(|_| _ = stepper.step(&mut alone).unwrap());
        assert_eq!(together, alone);
    }
}

#[test]
fn derivatives_by_the_values_of_a_table() {
    let step = |bead: Bead| {
        let mut state = BeadState { position: vector![0.33], momentum: vector![0.7] };
        let mut stepper = bead.stepper::<Midpoint>(0.2).unwrap();
        stepper
            .step_with_jacobian(&mut state, &NoControl::default(), WrtParameters)
            .map(|step| (state, step.0))
            .unwrap()
    };
    let (_, by) = step(bead());
    let h = 1e-5;
    for k in 0..8 {
        let momentum = |change: f64| {
            let mut bead = bead();
            bead.height[k] += change;
            step(bead).0.momentum.x
        };
        let difference = (momentum(h) - momentum(-h)) / (2.0 * h);
        // mass, gravity and length come first
        assert!((by[(1, 3 + k)] - difference).abs() < 1e-8, "{k}: {} for {difference}", by[(1, 3 + k)]);
    }
}
