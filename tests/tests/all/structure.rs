//! Every step is what the theory says it is: a Poisson map, symplectic on the cotangent bundle, its own adjoint, equivariant.

use coadjoint::__private::{Generated, Kernel};
use coadjoint::nalgebra::{DMatrix, DVector};
use coadjoint::prelude::*;
use coadjoint::{Discretized, System};
use coadjoint_app::Example;
use coadjoint_support::for_each_system_and_retraction;
use coadjoint_support::measure::largest;
use coadjoint_support::random::Random;
use coadjoint_support::systems::{FreeRigidBody, FreeRigidBodyState, HeavyTop, HeavyTopState, Sample};
use coadjoint_systems::quadrotor::{Quadrotor, QuadrotorControl};

/// Random systems and states per kind of system and retraction.
const SAMPLES: usize = 25;

/// A state as one column: attitude, then momentum and advected vectors.
fn components<S: System<Scalar = f64>>(state: &S::State) -> Vec<f64> {
    state.to_components().as_ref().to_vec()
}

fn with_components<S: Sample>(like: &S::State, components: &[f64]) -> S::State {
    let mut array = like.to_components();
    array.as_mut().copy_from_slice(components);
    S::State::from_components(&array)
}

/// Momentum and advected vectors: a point of the dual of the semidirect algebra.
fn reduced<S: Sample>(state: &S::State) -> DVector<f64> {
    DVector::from_column_slice(&components::<S>(state)[4..])
}

fn attitude<S: Sample>(state: &S::State) -> UnitQuaternion<f64> {
    let q = components::<S>(state);
    UnitQuaternion::new_unchecked(Quaternion::new(q[0], q[1], q[2], q[3]))
}

fn momentum<S: Sample>(state: &S::State) -> Vector3<f64> {
    reduced::<S>(state).fixed_rows::<3>(0).into_owned()
}

fn advected<S: Sample>(state: &S::State) -> Vec<Vector3<f64>> {
    let mu = reduced::<S>(state);
    (1..mu.len() / 3).map(|k| mu.fixed_rows::<3>(3 * k).into_owned()).collect()
}

fn step<S: Sample + Discretized<M>, M>(system: &S, h: f64, state: &S::State) -> S::State {
    let mut state = state.clone();
    system.stepper::<M>(h).expect("a stepper").step(&mut state).expect("a step");
    state
}

/// The largest difference of two states' components; attitudes as quaternions.
fn distance<S: System<Scalar = f64>>(a: &S::State, b: &S::State) -> f64 {
    largest(components::<S>(a).iter().zip(components::<S>(b)).map(|(a, b)| a - b))
}

/// The derivative at 0 of a curve, by central differences of fourth order.
fn derivative(curve: impl Fn(f64) -> DVector<f64>) -> DVector<f64> {
    // as much error from the fifth derivative as from roundoff, about 1e-12
    const D: f64 = 5e-4;
    let difference = |d: f64| curve(d) - curve(-d);
    (difference(D) * 8.0 - difference(2.0 * D)) / (12.0 * D)
}

/// The Poisson tensor `P(μ)` of the dual of so(3) ⋉ (R³)^k: `μ' = P(μ) ∇h(μ)` reads `Π' = Π × ∂h/∂Π + Σ a × ∂h/∂a`,
/// `a' = a × ∂h/∂Π`.
fn poisson_tensor(mu: &DVector<f64>) -> DMatrix<f64> {
    let n = mu.len();
    let mut tensor = DMatrix::zeros(n, n);
    for k in 0..n / 3 {
        let hat = mu.fixed_rows::<3>(3 * k).into_owned().cross_matrix();
        tensor.fixed_view_mut::<3, 3>(0, 3 * k).copy_from(&hat);
        tensor.fixed_view_mut::<3, 3>(3 * k, 0).copy_from(&hat);
    }
    tensor
}

/// `D P(μ) Dᵀ = P(μ')`, with `D` the derivative of the step.
#[test]
fn the_step_is_a_poisson_map() {
    fn check<S: Sample + Discretized<M>, M>(what: &str) {
        let mut random = Random::new(1);
        let mut worst: f64 = 0.0;
        for _ in 0..SAMPLES {
            let (system, state) = S::sample(&mut random);
            let h = random.between(0.05, 0.3);
            let stepped = |mu: &DVector<f64>| {
                let mut start = components::<S>(&state);
                start[4..].copy_from_slice(mu.as_slice());
                reduced::<S>(&step::<S, M>(&system, h, &with_components::<S>(&state, &start)))
            };
            let mu = reduced::<S>(&state);
            let n = mu.len();
            let columns: Vec<_> = (0..n)
                .map(|k| {
                    derivative(|d| {
                        let mut mu = mu.clone();
                        mu[k] += d;
                        stepped(&mu)
                    })
                })
                .collect();
            let d = DMatrix::from_columns(&columns);
            let defect = &d * poisson_tensor(&mu) * d.transpose() - poisson_tensor(&stepped(&mu));
            worst = worst.max(defect.amax());
        }
        println!("{what}: D P Dᵀ − P' = {worst:.1e}");
        assert!(worst < 1e-11, "{what}: not a Poisson map: {worst:e}");
    }
    for_each_system_and_retraction!(check);
}

/// With the advected vectors fixed in space, the step on T*SO(3) is symplectic: attitude and momentum together, not only what
/// the reduced equations see.
///
/// In the left trivialization, `(R exp(ξ), Π + π)`, the canonical bracket's tensor is `[[0, 1], [−1, hat(Π)]]`.
#[test]
fn the_step_is_symplectic_on_the_cotangent_bundle() {
    fn tensor(momentum: &Vector3<f64>) -> DMatrix<f64> {
        let mut tensor = DMatrix::zeros(6, 6);
        tensor.fixed_view_mut::<3, 3>(0, 3).fill_with_identity();
        tensor.fixed_view_mut::<3, 3>(3, 0).copy_from(&-Matrix3::identity());
        tensor.fixed_view_mut::<3, 3>(3, 3).copy_from(&momentum.cross_matrix());
        tensor
    }
    fn check<S: Sample + Discretized<M>, M>(what: &str) {
        let mut random = Random::new(2);
        let mut worst: f64 = 0.0;
        for _ in 0..SAMPLES {
            let (system, state) = S::sample(&mut random);
            let h = random.between(0.05, 0.3);
            let end = step::<S, M>(&system, h, &state);
            let moved = |direction: usize, d: f64| {
                let mut start = components::<S>(&state);
                if direction < 3 {
                    // the body turns; what is fixed in space turns the other way in it
                    let turn = UnitQuaternion::from_scaled_axis(Vector3::ith(direction, d));
                    let turned = attitude::<S>(&state) * turn;
                    start[..4].copy_from_slice(&[turned.w, turned.i, turned.j, turned.k]);
                    for (k, a) in advected::<S>(&state).iter().enumerate() {
                        start[7 + 3 * k..10 + 3 * k].copy_from_slice((turn.inverse() * a).as_slice());
                    }
                } else {
                    start[4 + direction - 3] += d;
                }
                let reached = step::<S, M>(&system, h, &with_components::<S>(&state, &start));
                let turn = (attitude::<S>(&end).inverse() * attitude::<S>(&reached)).scaled_axis();
                let change = momentum::<S>(&reached) - momentum::<S>(&end);
                DVector::from_iterator(6, turn.iter().chain(change.iter()).copied())
            };
            let columns: Vec<_> = (0..6).map(|k| derivative(|d| moved(k, d))).collect();
            let d = DMatrix::from_columns(&columns);
            let defect = &d * tensor(&momentum::<S>(&state)) * d.transpose() - tensor(&momentum::<S>(&end));
            worst = worst.max(defect.amax());
        }
        println!("{what}: symplectic to {worst:.1e}");
        assert!(worst < 1e-11, "{what}: not symplectic: {worst:e}");
    }
    for_each_system_and_retraction!(check);
}

/// A step back undoes a step.
#[test]
fn the_step_is_its_own_adjoint() {
    fn check<S: Sample + Discretized<M>, M>(what: &str) {
        let mut random = Random::new(3);
        let mut worst: f64 = 0.0;
        for _ in 0..40 * SAMPLES {
            let (system, start) = S::sample(&mut random);
            let h = random.between(0.01, 0.3);
            let there = step::<S, M>(&system, h, &start);
            let back = step::<S, M>(&system, -h, &there);
            worst = worst.max(distance::<S>(&start, &back));
            assert!(distance::<S>(&start, &there) > 1e-6, "{what}: the step does nothing");
        }
        println!("{what}: there and back again to {worst:.1e}");
        assert!(worst < 2e-15, "{what}: a step back misses by {worst:e}");
    }
    for_each_system_and_retraction!(check);
}

/// Casimirs, and what is fixed in space, over a few thousand steps of random systems.
#[test]
fn casimirs_and_directions_in_space_are_kept() {
    fn check<S: Sample + Discretized<M>, M>(what: &str) {
        let mut random = Random::new(4);
        let (mut casimirs, mut directions): (f64, f64) = (0.0, 0.0);
        for _ in 0..4 {
            let (system, mut state) = S::sample(&mut random);
            let kept = system.casimirs(&state).as_ref().to_vec();
            let in_space = |state: &S::State| -> Vec<f64> {
                let attitude = attitude::<S>(state);
                let turned = advected::<S>(state).into_iter().map(|a| attitude * a);
                turned.flat_map(|a| [a.x, a.y, a.z]).collect()
            };
            let fixed = in_space(&state);
            let mut stepper = system.stepper::<M>(0.1).expect("a stepper");
            for _ in 0..2_500 {
                stepper.step(&mut state).expect("a step");
            }
            casimirs =
                largest(system.casimirs(&state).as_ref().iter().zip(&kept).map(|(a, b)| a - b)).max(casimirs);
            directions = largest(in_space(&state).iter().zip(&fixed).map(|(a, b)| a - b)).max(directions);
        }
        println!("{what}: Casimirs drift {casimirs:.1e}, directions {directions:.1e}");
        assert!(casimirs < 5e-14, "{what}: Casimirs drift by {casimirs:e}");
        assert!(directions < 5e-14, "{what}: advected vectors turn in space by {directions:e}");
    }
    for_each_system_and_retraction!(check);
}

/// Space has no preferred direction but the advected ones: a trajectory turned in space is a trajectory.
#[test]
fn the_step_does_not_know_where_space_is() {
    fn check<S: Sample + Discretized<M>, M>(what: &str) {
        let mut random = Random::new(5);
        for _ in 0..SAMPLES {
            let (system, state) = S::sample(&mut random);
            let turn = random.rotation();
            let turned = |state: &S::State| {
                let mut start = components::<S>(state);
                let q = turn * attitude::<S>(state);
                start[..4].copy_from_slice(&[q.w, q.i, q.j, q.k]);
                with_components::<S>(state, &start)
            };
            let (before, after) =
                (step::<S, M>(&system, 0.1, &turned(&state)), turned(&step::<S, M>(&system, 0.1, &state)));
            let distance = distance::<S>(&before, &after);
            assert!(distance < 1e-15, "{what}: turned before and after differ by {distance:e}");
        }
    }
    for_each_system_and_retraction!(check);
}

/// Without torques the momentum is fixed in space, whatever the shape of the body.
#[test]
fn a_free_body_keeps_its_momentum_in_space() {
    fn check<S: Sample + Discretized<M>, M>(what: &str) {
        let mut random = Random::new(6);
        let mut worst: f64 = 0.0;
        for _ in 0..SAMPLES {
            let (system, mut state) = S::sample(&mut random);
            let in_space = |state: &S::State| attitude::<S>(state) * momentum::<S>(state);
            let before = in_space(&state);
            let mut stepper = system.stepper::<M>(0.2).expect("a stepper");
            for _ in 0..500 {
                stepper.step(&mut state).expect("a step");
            }
            worst = worst.max((in_space(&state) - before).amax());
        }
        println!("{what}: momentum in space drifts {worst:.1e}");
        assert!(worst < 2e-14, "{what}: momentum in space drifts by {worst:e}");
    }
    for_each_system_and_retraction!(check: FreeRigidBody, TiltedBody);
}

/// The reported momentum in space is the attitude applied to the body momentum.
#[test]
fn spatial_momentum_is_the_turned_body_momentum() {
    let mut random = Random::new(7);
    for _ in 0..SAMPLES {
        let (top, state) = HeavyTop::sample(&mut random);
        let difference = top.spatial_momentum(&state) - state.attitude * state.momentum;
        assert!(difference.amax() < 1e-15, "{difference:?}");
    }
}

/// A symmetric top that hangs on its axis looks the same from all sides, so it keeps its spin about that axis: Noether's theorem
/// for a symmetry of the body, not of space.
#[test]
fn a_symmetric_top_keeps_its_spin() {
    fn check<M>(what: &str)
    where
        HeavyTop: Discretized<M>,
    {
        let mut random = Random::new(8);
        let mut worst: f64 = 0.0;
        for _ in 0..SAMPLES {
            let (top, start) = HeavyTop::sample(&mut random);
            let (across, along) = (top.inertia.x, top.inertia.z);
            let top = HeavyTop { inertia: vector![across, across, along], chi: Vector3::z(), ..top };
            let mut state = start;
            let mut stepper = top.stepper::<M>(0.1).expect("a stepper");
            for _ in 0..500 {
                stepper.step(&mut state).expect("a step");
            }
            worst = worst.max((state.momentum.z - start.momentum.z).abs());
        }
        println!("{what}: spin drifts {worst:.1e}");
        assert!(worst < 5e-15, "{what}: spin drifts by {worst:e}");
    }
    check::<Exponential>("exponential");
    check::<Cayley>("Cayley");
}

/// With the Cayley map and a uniform field, the step is half a kick by gravity, a free step, and half a kick.
#[test]
fn a_cayley_step_of_the_heavy_top_is_kick_turn_kick() {
    let mut random = Random::new(9);
    let mut worst: f64 = 0.0;
    for _ in 0..40 * SAMPLES {
        let (top, state) = HeavyTop::sample(&mut random);
        let h = random.between(0.01, 0.3);
        let kick = |gamma: Vector3<f64>| (h / 2.0) * gamma.cross(&(top.weight * top.chi));

        let body = FreeRigidBody { inertia: top.inertia };
        let kicked =
            FreeRigidBodyState { attitude: state.attitude, momentum: state.momentum + kick(state.gamma) };
        let free = step::<FreeRigidBody, Cayley>(&body, h, &kicked);
        let gamma = free.attitude.inverse() * (state.attitude * state.gamma);
        let expected =
            HeavyTopState { attitude: free.attitude, momentum: free.momentum + kick(gamma), gamma };

        let reached = step::<HeavyTop, Cayley>(&top, h, &state);
        worst = worst.max(distance::<HeavyTop>(&reached, &expected));
    }
    println!("kick, turn, kick: {worst:.1e}");
    assert!(worst < 5e-15, "the two ways differ by {worst:e}");
}

/// The energy is kinetic plus potential, with the inertia's inverse and potentials worked out by hand.
#[test]
fn energy_is_kinetic_plus_potential() {
    fn check<S: Sample + Discretized<M>, M>(what: &str) {
        let mut random = Random::new(10);
        for _ in 0..40 * SAMPLES {
            let (system, state) = S::sample(&mut random);
            let momentum = momentum::<S>(&state);
            let velocity = system.inertia_matrix().lu().solve(&momentum).expect("an inertia has an inverse");
            let expected = momentum.dot(&velocity) / 2.0 + system.potential_energy(&advected::<S>(&state));
            let defect = (system.energy(&state) - expected).abs();
            assert!(defect < 2e-14, "{what}: off by {defect:e}");
        }
    }
    for_each_system_and_retraction!(check);
}

/// To first order in the step, the motion is that of the equations, written out by hand.
#[test]
fn the_motion_is_that_of_the_equations() {
    fn check<S: Sample + Discretized<M>, M>(what: &str) {
        let mut random = Random::new(11);
        let mut worst: f64 = 0.0;
        for _ in 0..SAMPLES {
            let (system, state) = S::sample(&mut random);
            // the curve of the states after steps of all sizes touches the motion
            let rate = derivative(|h| DVector::from_vec(components::<S>(&step::<S, M>(&system, h, &state))));

            let (momentum, advected) = (momentum::<S>(&state), advected::<S>(&state));
            let velocity = system.inertia_matrix().lu().solve(&momentum).expect("an inertia has an inverse");
            let q = attitude::<S>(&state).into_inner() * Quaternion::from_imag(velocity) * 0.5;
            let gradient = system.potential_gradient(&advected);
            let torque: Vector3<f64> = advected.iter().zip(&gradient).map(|(a, v)| a.cross(v)).sum();
            let mut expected = vec![q.w, q.i, q.j, q.k];
            expected.extend((momentum.cross(&velocity) + torque).iter());
            expected
                .extend(advected.iter().flat_map(|a| a.cross(&velocity).iter().copied().collect::<Vec<_>>()));
            worst = worst.max((rate - DVector::from_vec(expected)).amax());
        }
        println!("{what}: rates of change to {worst:.1e}");
        assert!(worst < 1e-10, "{what}: off by {worst:e}");
    }
    for_each_system_and_retraction!(check);
}

/// The stepper's memory of the last solution speeds Newton up but does not steer the motion.
#[test]
fn a_step_depends_on_the_state_alone() {
    fn check<S: Sample + Discretized<M>, M>(what: &str) {
        let mut random = Random::new(12);
        for _ in 0..SAMPLES {
            let (system, state) = S::sample(&mut random);
            let mut warm = state.clone();
            let mut stepper = system.stepper::<M>(0.1).expect("a stepper");
            for _ in 0..10 {
                let before = warm.clone();
                stepper.step(&mut warm).expect("a step");
                let fresh = step::<S, M>(&system, 0.1, &before);
                let difference = distance::<S>(&warm, &fresh);
                assert!(difference < 2e-14, "{what}: warm and cold starts differ by {difference:e}");
            }
        }
    }
    for_each_system_and_retraction!(check);
}

/// … and so it does in a long run, in which the stepper has settled to its usual ways, across a change of the control or of the state that
/// comes from outside.
#[test]
fn a_settled_stepper_gives_the_same_steps() {
    fn check<S: Sample + Discretized<M>, M>(what: &str) {
        let (system, state) = S::sample(&mut Random::new(14));
        settled::<S, M>(what, &system, state, &[S::Control::default(), S::Control::default()]);
    }
    for_each_system_and_retraction!(check);
    let (quadrotor, loose) = Quadrotor::example();
    let push = |thrust: f64, moment: f64| QuadrotorControl { thrust, moment: vector![moment, 0.1, -moment] };
    let controls = [push(5.0, 0.0), push(-3.0, 0.02)];
    settled::<Quadrotor, Cayley>("quadrotor, Cayley", &quadrotor, loose, &controls);
    settled::<Quadrotor, Exponential>("quadrotor, exponential", &quadrotor, loose, &controls);
}

/// Compares each step of a run with that of a fresh stepper.
fn settled<S: System<Scalar = f64> + Discretized<M>, M>(
    what: &str,
    system: &S,
    mut state: S::State,
    controls: &[S::Control; 2],
) {
    let fresh = |state: &S::State, time: f64, control: &S::Control| {
        let mut stepper = system.stepper::<M>(0.01).expect("a stepper");
        stepper.set_time(time);
        let mut state = state.clone();
        stepper.step_with(&mut state, control).expect("a step");
        state
    };
    let mut stepper = system.stepper::<M>(0.01).expect("a stepper");
    let mut usual = 0;
    for k in 0..600 {
        let control = &controls[usize::from((200..450).contains(&k))];
        if k == 333 {
            // in the midst of usual steps the state is another's
            state = fresh(&state, 0.0, control);
        }
        let expected = fresh(&state, stepper.time(), control);
        let report = stepper.step_with(&mut state, control).expect("a step");
        usual += u32::from(report.iterations <= 6);
        let difference = distance::<S>(&state, &expected);
        assert!(
            difference < 2e-14,
            "{what}: step {k} differs by {difference:e} from that of a fresh stepper"
        );
    }
    println!("{what}: {usual} usual steps");
    assert!(usual > 500, "{what}: only {usual} steps were usual");
}

/// Newton's iteration converges quadratically, as it does with the true Jacobian only: from a first guess that is off by `O(h²)`,
/// three corrections reach roundoff.
#[test]
fn newton_has_the_true_jacobian() {
    fn check<S, M>(what: &str)
    where
        S: Sample + Generated<SymplecticEulerA<M>>,
    {
        let mut random = Random::new(13);
        let mut most = 0;
        for _ in 0..40 * SAMPLES {
            let (system, state) = S::sample(&mut random);
            let kernel = S::Kernel::<f64>::new(&system.to_parameters(), random.between(0.01, 0.1));
            let (state, control) = (state.to_components(), S::Control::default().to_components());
            let step = kernel.begin(&state, 0.0, &control);
            let mut unknown = kernel.start(&state, &step);
            let mut corrections = 0;
            loop {
                let evaluation = kernel.evaluate(&state, &step, &unknown);
                if largest(evaluation.residual.as_ref().iter().copied())
                    < 2e-15 * largest(evaluation.right.as_ref().iter().copied())
                {
                    break;
                }
                assert!(corrections < 20, "{what}: residual {:?}", evaluation.residual);
                let correction = kernel.correction(&state, &step, &unknown, &evaluation);
                for (x, correction) in unknown.as_mut().iter_mut().zip(correction.as_ref()) {
                    *x -= correction;
                }
                corrections += 1;
            }
            most = most.max(corrections);
        }
        println!("{what}: at most {most} corrections");
        assert!((1..=4).contains(&most), "{what}: {most} corrections");
    }
    for_each_system_and_retraction!(check);
}

/// Bodies that do not move stay where they are.
#[test]
fn rest_is_rest() {
    let body = FreeRigidBody { inertia: vector![1.0, 2.0, 3.0] };
    let state = FreeRigidBodyState { attitude: UnitQuaternion::identity(), momentum: Vector3::zeros() };
    assert_eq!(step::<FreeRigidBody, Exponential>(&body, 0.1, &state), state);
    assert_eq!(step::<FreeRigidBody, Cayley>(&body, 0.1, &state), state);

    // a top that stands or hangs
    let top = HeavyTop { inertia: vector![1.0, 2.0, 3.0], weight: 1.0, chi: Vector3::z() };
    for gamma in [Vector3::z(), -Vector3::z()] {
        let state = HeavyTopState { attitude: UnitQuaternion::identity(), momentum: Vector3::zeros(), gamma };
        assert_eq!(step::<HeavyTop, Exponential>(&top, 0.1, &state), state);
        assert_eq!(step::<HeavyTop, Cayley>(&top, 0.1, &state), state);
    }
}
