//! Classical methods on the systems of the catalogue, and everything else that a run may be made with beside the standard steps.

use std::ops::ControlFlow;
use std::sync::Arc;

use coadjoint::Scheme;
use coadjoint::composition::{KahanLi8, SofroniouSpaletta10};
use coadjoint::erased::{RetractionKind, Stepper};
use coadjoint::prelude::*;
use coadjoint::scheme::Rule;
use coadjoint::system::Role;
use coadjoint_app::Entry;
use coadjoint_app::Example;
use coadjoint_app::setup::{Classical, Job, Method, Order, Retraction, Setup};
use coadjoint_app::simulate::{Sample, classical_stepper, simulate, states_in_motion};
use coadjoint_systems::catalogue::CATALOGUE;
use coadjoint_systems::classical::{AttitudeState, Rkmk4, bodies, integrate};
use coadjoint_systems::heavy_top::HeavyTop;
use nalgebra::Vector6;

/// The states of a run, the initial one included.
fn states(entry: &Entry, setup: &Setup, method: Method, (step, steps): (f64, u64)) -> Vec<Vec<f64>> {
    let job = Job { method, retraction: Retraction::Exponential, order: Order::Two, step, steps, rest: 0.0 };
    let mut states = Vec::new();
    simulate(entry, setup, &job, None, &|index| index + 1, &mut |sample| {
        states.push(sample.state.to_vec());
        ControlFlow::Continue(())
    })
    .unwrap_or_else(|error| panic!("{}, {method}: {error}", entry.name));
    states
}

/// The last state of a run.
fn end(entry: &Entry, setup: &Setup, method: Method, run: (f64, u64)) -> Vec<f64> {
    states(entry, setup, method, run).pop().expect("there is one")
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
}

entries!(the_vector_field_is_the_motion_of_generated_steps);

/// The derivative by the step, at 0, of steps of order 10: what they have in common with the vector field is the description.
fn the_vector_field_is_the_motion_of_generated_steps(name: &str) {
    let entry = CATALOGUE.find(name).expect("it is there");
    let setup = entry.example.clone();
    let system = entry.system(&setup.parameters);
    let law = entry.law(&setup);
    let is_exponential = Retraction::of(entry).contains(&Retraction::Exponential);
    let map = if is_exponential { RetractionKind::Exponential } else { RetractionKind::Cayley };
    let scheme = Scheme::composed::<SofroniouSpaletta10>(Scheme::Standard(map));
    let (states, _) = states_in_motion(entry, &setup).expect("solvable");
    let small = entry.step / 16.0;
    for state in states {
        let mut control = vec![0.0; setup.controls.len()];
        if let Some(law) = &law {
            law(&state, 0.0, &mut control);
        }
        let moved = |step: f64| {
            let mut state = state.clone();
            let mut stepper = Stepper::new(system.clone(), &scheme, step).expect("valid");
            stepper.step(&mut state, &control).expect("solvable");
            state
        };
        let mut measured = vec![0.0; state.len()];
        for (k, weight) in (1..).zip([4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0]) {
            let step = f64::from(k) * small;
            for (sum, (after, before)) in measured.iter_mut().zip(moved(step).iter().zip(moved(-step))) {
                *sum += (after - before) * weight / small;
            }
        }
        let field = system.vector_field(&state, 0.0, &control);
        // of each quantity in its own unit; what is lost is rounding of the state over the step
        let mut place = 0;
        for quantity in entry.description.state {
            let slots = place..place + quantity.components.len();
            let (got, expected) = (&field[slots.clone()], &measured[slots.clone()]);
            let size = distance(expected, &vec![0.0; expected.len()]);
            let rounding = (1.0 + distance(&state[slots.clone()], &vec![0.0; slots.len()])) * 1e-14 / small;
            let off = distance(got, expected);
            assert!(off < 1e-8 * size + rounding, "{name}, {}: {got:?} {expected:?}", quantity.name);
            place = slots.end;
        }
    }
}

/// Each method has its order on the Lie groups of the catalogue, with forces, controls and time: three steps, against steps of ours of order 6.
#[test]
fn classical_methods_have_their_orders_on_every_kind_of_system() {
    for (name, duration) in [
        ("harmonic_oscillator", 2.0),
        ("driven_pendulum", 1.0),
        ("heavy_top", 4.0),
        ("quadrotor", 4.0),
        ("rigid_body_in_space", 1.0),
        ("coupled_bodies", 1.0),
        ("kepler", 3000.0),
    ] {
        let entry = CATALOGUE.find(name).expect("it is there");
        let setup = entry.example.clone();
        let reference = {
            let (method, retraction) = (Method::Standard, Retraction::Exponential);
            let job = Job {
                method,
                retraction,
                order: Order::Eight,
                step: duration / 400.0,
                steps: 400,
                rest: 0.0,
            };
            let mut last = Vec::new();
            let mut observe = |sample: &Sample<'_>| {
                last = sample.state.to_vec();
                ControlFlow::Continue(())
            };
            simulate(entry, &setup, &job, None, &|_| u64::MAX, &mut observe).expect("solvable");
            last
        };
        let size = distance(&reference, &vec![0.0; reference.len()]);
        for classical in Classical::ALL {
            let coarse = match classical.order() {
                1 => 400,
                2 => 80,
                4 => 20,
                _ => 8,
            };
            let error = |count: u64| {
                let run = (duration / count as f64, count);
                distance(&end(entry, &setup, Method::Classical(classical), run), &reference) / size
            };
            let errors = [coarse, 2 * coarse, 4 * coarse].map(error);
            let slopes = [errors[0] / errors[1], errors[1] / errors[2]].map(f64::log2);
            println!("{name}, {}: {errors:?}, {slopes:?}", classical.name());
            assert!(errors[2] > 1e-13, "{name}, {}: too close to roundoff: {errors:?}", classical.name());
            let order = f64::from(classical.order());
            assert!((slopes[1] - order).abs() < 0.35, "{name}, {}: {errors:?} {slopes:?}", classical.name());
        }
    }
}

/// RK4 on the numbers as they are stored, and RKMK4, are those that are written by hand for bodies.
#[test]
fn rk4_and_rkmk4_take_the_steps_of_those_written_by_hand() {
    let entry = CATALOGUE.find("heavy_top").expect("it is there");
    let mut setup = entry.example.clone();
    let attitude = UnitQuaternion::from_scaled_axis(vector![0.5, -0.3, 0.8]);
    let gamma = attitude.inverse() * Vector3::z();
    setup.parameters = vec![1.0, 2.0, 2.5, 1.5, 0.2, 0.0, 0.9];
    let q = attitude.quaternion();
    setup.state = vec![q.w, q.i, q.j, q.k, 0.6, 0.9, 2.1, gamma.x, gamma.y, gamma.z];
    let top = bodies::HeavyTop::new(vector![1.0, 2.0, 2.5], 1.5, vector![0.2, 0.0, 0.9]);
    let start = AttitudeState { attitude, y: Vector6::new(0.6, 0.9, 2.1, gamma.x, gamma.y, gamma.z) };
    let run = (0.05, 100);
    let by_hand = integrate(&Rkmk4, &top, 0.0, start, run.0, run.1, |_, _, _| {}).expect("finite");
    let rk4 = end(entry, &setup, Method::Classical(Classical::Rk4), run);
    let rkmk4 = end(entry, &setup, Method::Classical(Classical::Rkmk4), run);
    // the motion of momentum and vertical does not depend on the attitude
    assert!(distance(&rk4[4..], by_hand.y.as_slice()) < 1e-12, "{rk4:?} {by_hand:?}");
    let q = by_hand.attitude.quaternion();
    let expected = [&[q.w, q.i, q.j, q.k][..], by_hand.y.as_slice()].concat();
    assert!(distance(&rkmk4, &expected) < 1e-12, "{rkmk4:?} {by_hand:?}");

    // the quaternion as coordinates: RK4 of q' = ½ q ω without projection leaves the sphere, RKMK4 does not
    let off = |state: &[f64]| ((state[..4].iter().map(|x| x * x).sum::<f64>()).sqrt() - 1.0).abs();
    assert!(off(&rk4) > 1e-8 && off(&rkmk4) < 1e-14, "{} {}", off(&rk4), off(&rkmk4));
    // and neither keeps energy or Casimirs, while ours do
    let system = entry.system(&setup.parameters);
    let drift = |state: &[f64]| {
        let casimirs = system.casimirs(state).into_iter().zip(system.casimirs(&setup.state));
        casimirs.map(|(now, then)| (now - then).abs()).fold(0.0, f64::max)
    };
    let ours = end(entry, &setup, Method::Standard, run);
    assert!(drift(&rk4) > 1e-9 && drift(&rkmk4) > 1e-9 && drift(&ours) < 1e-13);
}

/// Gauss's methods keep quadratic invariants: the implicit midpoint in stored numbers keeps the length of quaternions, and what is quadratic of
/// the invariants.
#[test]
fn implicit_midpoint_keeps_quadratic_invariants_in_stored_numbers() {
    let entry = CATALOGUE.find("free_rigid_body").expect("it is there");
    let setup = entry.example.clone();
    let system = entry.system(&setup.parameters);
    for classical in [Classical::ImplicitMidpoint, Classical::Gauss4] {
        let state = end(entry, &setup, Method::Classical(classical), (0.1, 300));
        let energy = (system.energy(&state, 0.0, &[]) - system.energy(&setup.state, 0.0, &[])).abs();
        assert!(system.deviation(&state) < 1e-13 && energy < 1e-13, "{}: {energy:e}", classical.name());
    }
}

/// The right lift takes the same steps, and carries the momentum in space; of the fluid, a right-invariant system, that on the other side.
#[test]
fn the_right_lift_takes_the_steps_of_symplectic_euler() {
    for name in ["free_rigid_body", "full_rigid_body", "gyrostat", "rigid_body_in_space", "ellipsoidal_fluid"]
    {
        let entry = CATALOGUE.find(name).expect("it is there");
        let setup = entry.example.clone();
        let run = (entry.step, 1_000);
        let (plain, lifted) =
            (states(entry, &setup, Method::EULER_A, run), states(entry, &setup, Method::RightLift, run));
        assert_eq!(plain.len(), lifted.len());
        let size = distance(&setup.state, &vec![0.0; setup.state.len()]);
        let off = plain.iter().zip(&lifted).map(|(a, b)| distance(a, b)).fold(0.0, f64::max);
        assert!(off < 1e-11 * size, "{name}: {off:e}");
        assert!(plain.iter().zip(&lifted).any(|(a, b)| a != b), "{name}: not another computation");
    }
    let error = {
        let (entry, method) = (CATALOGUE.find("heavy_top").expect("it is there"), Method::RightLift);
        let job =
            Job { method, retraction: Retraction::Cayley, order: Order::Two, step: 0.1, steps: 1, rest: 0.0 };
        let ignore = &mut |_: &Sample<'_>| ControlFlow::Continue(());
        simulate(entry, &entry.example, &job, None, &|_| u64::MAX, ignore).expect_err("gravity acts")
    };
    assert!(error.to_string().contains("`heavy_top` has no steps with the method right-lift"), "{error}");
}

/// The members of the family that were generated beside the usual ones have their orders: all 2 for a left-invariant system, 1 for a potential.
#[test]
fn members_of_the_family_and_the_tangent_lift_have_their_orders() {
    for (name, method, order) in [
        ("free_rigid_body", Method::Step(Rule::Family(1, 4)), 2.0),
        ("free_rigid_body", Method::Step(Rule::TangentLift(0, 1)), 1.0),
        ("free_rigid_body", Method::Step(Rule::TangentLift(1, 2)), 2.0),
        ("harmonic_oscillator", Method::Step(Rule::Family(1, 4)), 1.0),
        ("harmonic_oscillator", Method::Step(Rule::TangentLift(0, 1)), 1.0),
    ] {
        let entry = CATALOGUE.find(name).expect("it is there");
        let setup = entry.example.clone();
        let exact = end(entry, &setup, Method::Classical(Classical::Gauss6), (0.01, 130));
        let errors = [100, 200, 400]
            .map(|count: u64| distance(&end(entry, &setup, method, (1.3 / count as f64, count)), &exact));
        let measured = (errors[1] / errors[2]).log2();
        assert!((measured - order).abs() < 0.1, "{name}, {method}: {errors:?}");
        let job = Job {
            method,
            retraction: Retraction::Exponential,
            order: Order::Two,
            step: 0.01,
            steps: 1,
            rest: 0.0,
        };
        assert_eq!(f64::from(job.order_of_step(entry)), order, "{name}, {method}");
    }
}

/// A control that is set is held; the others stay with the system's own law.
#[test]
fn controls_that_are_set_take_the_place_of_the_law() {
    let entry = CATALOGUE.find("hovering_quadrotor").expect("it is there");
    let mut setup = entry.example.clone();
    let fallen = |setup: &Setup, method| end(entry, setup, method, (0.01, 100));
    let height = |state: &[f64]| state[9];
    // hover
    assert_eq!(height(&fallen(&setup, Method::Standard)), 1.0);
    // free fall for a second, from 1 m: Störmer–Verlet has it exactly, and Euler A is half a step ahead
    setup.controls[3] = Some(0.0);
    for (method, expected) in [
        (Method::Verlet, 1.0 - 9.81 / 2.0),
        (Method::EULER_A, 1.0 - 9.81 / 2.0 * 1.01),
        (Method::Classical(Classical::Rk4), 1.0 - 9.81 / 2.0),
    ] {
        let height = height(&fallen(&setup, method));
        assert!((height - expected).abs() < 1e-12, "{method}: {height}");
    }
    // a moment about the third axis, and hover's thrust by its own law
    let mut setup = entry.example.clone();
    setup.controls[..3].copy_from_slice(&[Some(0.0), Some(0.0), Some(0.5)]);
    let state = fallen(&setup, Method::Standard);
    assert!((state[6] - 0.5).abs() < 1e-13 && (height(&state) - 1.0).abs() < 1e-13, "{state:?}");
    // all of them, which are then held
    setup.controls[3] = Some(4.34 * 9.81);
    assert!(distance(&fallen(&setup, Method::Standard), &state) < 1e-12);
}

/// Of a configuration, tangent vectors have as many numbers as its momentum has; of stored numbers, the field has all.
#[test]
fn tangent_vectors_have_as_many_numbers_as_momenta() {
    let (top, state) = HeavyTop::example();
    let system: &dyn coadjoint::erased::System = &top;
    let components = coadjoint::State::to_components(&state);
    let motion = system.motion(&components, 0.0, &[]);
    let count = |role| {
        let of = system.description().state.iter().filter(move |quantity| quantity.role == role);
        of.map(|quantity| quantity.components.len()).sum::<usize>()
    };
    assert_eq!(motion.len(), 2 * count(Role::Momentum) + count(Role::Advected));
    // q' = ½ q ω at the identity
    let field = system.vector_field(&components, 0.0, &[]);
    let expected = [0.0, 0.5, 0.05, 0.005];
    assert!(distance(&field[..4], &expected) < 1e-15, "{field:?}");
}

/// A body whose energy is a function of momentum and attitude in space.
#[lie_poisson_system(
    group = SO3,
    invariance = right,
    hamiltonian = 0.5 * momentum.dot(&momentum.component_div(&inertia)) + weight * (attitude * Vector3::z()).x,
    retractions(Exponential),
)]
struct InSpace {
    inertia: Vector3<f64>,
    weight: f64,
}

/// A sledge on a plane that is tied to the origin.
#[lie_poisson_system(
    group = SE2,
    potential = 0.5 * stiffness * pose.translation.vector.norm_squared() + stiffness * pose.rotation.cos_angle(),
    retractions(Exponential),
)]
struct Sledge {
    #[inertia]
    inertia: Vector3<f64>,
    stiffness: f64,
}

/// The same with its momentum in space.
#[lie_poisson_system(
    group = SE2,
    invariance = right,
    hamiltonian = 0.5 * momentum.dot(&momentum.component_div(&inertia)) + stiffness * pose.translation.vector.x,
    retractions(Exponential),
)]
struct Plate {
    inertia: Vector3<f64>,
    stiffness: f64,
}

/// A body that moves on unit quaternions.
#[lie_poisson_system(group = SU2, retractions(Exponential))]
struct Spinner {
    #[inertia]
    inertia: Vector3<f64>,
}

/// What is asked of the groups and sides that the catalogue has not, of steps of order 8 and of the two kinds of classical methods.
fn keeps_its_order(system: impl coadjoint::erased::System, start: &[f64]) {
    let system: Arc<dyn coadjoint::erased::System> = Arc::new(system);
    let duration = 2.0;
    let run = |stepper: Result<Stepper, coadjoint::ParameterError>, steps: u64| {
        let mut state = start.to_vec();
        stepper.expect("valid").steps(&mut state, &[], steps).expect("solvable");
        state
    };
    let scheme = Scheme::composed::<KahanLi8>(Scheme::Standard(RetractionKind::Exponential));
    let mut exact = start.to_vec();
    let mut stepper = Stepper::new(system.clone(), &scheme, duration / 400.0).expect("generated");
    stepper.steps(&mut exact, &[], 400).expect("solvable");
    let name = system.description().name;
    for classical in [Classical::Rk4, Classical::Rkmk4, Classical::Gauss4, Classical::ImplicitMidpoint] {
        let errors = [40, 80, 160].map(|steps: u64| {
            let step = duration / steps as f64;
            distance(&run(classical_stepper(system.clone(), classical, None, step), steps), &exact)
        });
        let measured = (errors[1] / errors[2]).log2();
        println!("{name}, {}: {errors:?}, {measured}", classical.name());
        assert!(
            (measured - f64::from(classical.order())).abs() < 0.2,
            "{name}, {}: {errors:?}",
            classical.name()
        );
        let rests_on_group =
            system.deviation(&run(classical_stepper(system.clone(), classical, None, 0.05), 40)) < 1e-13;
        assert!(rests_on_group || classical == Classical::Rk4, "{name}, {}", classical.name());
    }
}

#[test]
fn classical_methods_have_their_orders_on_other_groups_and_sides() {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    keeps_its_order(
        InSpace { inertia: vector![1.0, 2.0, 2.5], weight: 1.5 },
        &[half, 0.0, half, 0.0, 0.4, -0.8, 1.5],
    );
    keeps_its_order(
        Sledge { inertia: vector![1.0, 2.0, 3.0], stiffness: 2.0 },
        &[0.6, 0.8, 0.3, -0.5, 0.7, 1.0, -1.2],
    );
    keeps_its_order(
        Plate { inertia: vector![1.0, 2.0, 3.0], stiffness: 2.0 },
        &[0.6, 0.8, 0.3, -0.5, 0.7, 1.0, -1.2],
    );
    keeps_its_order(Spinner { inertia: vector![1.0, 2.0, 2.5] }, &[half, 0.0, half, 0.0, 0.4, -0.8, 1.5]);
}
