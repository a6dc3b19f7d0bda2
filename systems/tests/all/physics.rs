//! What is known of each system from elsewhere: periods, conserved quantities, motions that can be written down.

use coadjoint::prelude::*;
use coadjoint::{Control, Record, Run, SchemeType, State, System, erased};
use coadjoint_app::Example;
use coadjoint_systems::catalogue::CATALOGUE;
use coadjoint_systems::coupled_bodies::CoupledBodies;
use coadjoint_systems::driven_pendulum::{DrivenPendulum, DrivenPendulumState};
use coadjoint_systems::free_rigid_body::{FreeRigidBody, FreeRigidBodyState};
use coadjoint_systems::full_rigid_body::{FullRigidBody, FullRigidBodyState};
use coadjoint_systems::gyrostat::{Gyrostat, GyrostatState};
use coadjoint_systems::harmonic_oscillator::HarmonicOscillator;
use coadjoint_systems::heavy_top::{HeavyTop, HeavyTopState};
use coadjoint_systems::kepler::Kepler;
use coadjoint_systems::kirchhoff::{Kirchhoff, KirchhoffState};
use coadjoint_systems::magnetic_top::MagneticTop;
use coadjoint_systems::planar_pendulum::PlanarPendulum;
use coadjoint_systems::quadrotor::{Quadrotor, QuadrotorControl};
use coadjoint_systems::rigid_body_in_space::{RigidBodyInSpace, RigidBodyInSpaceState};
use coadjoint_systems::spherical_pendulum::SphericalPendulum;

/// The states of so many steps with the scheme `M` under the system's own control law, the initial one included.
pub(crate) fn motion<S: Example, M: SchemeType>(
    system: &S,
    start: &S::State,
    step: f64,
    steps: u64,
) -> Vec<S::State> {
    controlled::<S, M>(system, start, step, steps, |state, time| system.control(state, time))
}

/// The states of so many steps under a control law. Steps are taken with types erased: such are compiled with the catalogue, not once more here.
pub(crate) fn controlled<S: Example, M: SchemeType>(
    system: &S,
    start: &S::State,
    step: f64,
    steps: u64,
    law: impl Fn(&S::State, f64) -> S::Control,
) -> Vec<S::State> {
    let typed = |state: &[f64]| {
        let mut components = start.to_components();
        components.as_mut().copy_from_slice(state);
        S::State::from_components(&components)
    };
    let entry = CATALOGUE.entries().iter().find(|entry| entry.description.name == S::NAME);
    let erased = entry.expect("in the catalogue").system(system.to_parameters().as_ref());
    let mut stepper = erased::Stepper::new(erased, &M::scheme(), step).expect("valid");
    let mut state = start.to_components().as_ref().to_vec();
    let mut record = Record::every(1);
    Run::new(&mut stepper, &mut state)
        .controlled_by(|state, time| law(&typed(state), time).to_components().as_ref().to_vec())
        .observe(&mut record)
        .steps(steps)
        .expect("solvable");
    record.states().iter().map(|state| typed(state)).collect()
}

/// The state after a time, in so many steps.
pub(crate) fn after<S: Example, M: SchemeType>(
    system: &S,
    start: &S::State,
    time: f64,
    steps: u64,
) -> S::State {
    motion::<S, M>(system, start, time / steps as f64, steps).pop().expect("there is one")
}

/// The largest distance from the first of a quantity along a motion.
pub(crate) fn drift<X, const N: usize>(states: &[X], quantity: impl Fn(&X) -> [f64; N]) -> f64 {
    let first = quantity(&states[0]);
    let far =
        |now: [f64; N]| now.iter().zip(first).fold(0.0_f64, |far, (x, first)| far.max((x - first).abs()));
    states.iter().map(|state| far(quantity(state))).fold(0.0, f64::max)
}

#[test]
fn an_oscillator_comes_back_after_its_period() {
    let (oscillator, start) = HarmonicOscillator::example();
    let half = after::<_, Order8<Exponential>>(&oscillator, &start, oscillator.period() / 2.0, 50);
    assert!((half.position + start.position).norm() < 1e-12 && half.momentum.norm() < 1e-11, "{half:?}");
    let whole = after::<_, Order8<Midpoint>>(&oscillator, &start, oscillator.period(), 100);
    assert!((whole.position - start.position).norm() < 1e-12 && whole.momentum.norm() < 1e-11, "{whole:?}");
}

#[test]
fn the_midpoint_keeps_an_oscillators_energy() {
    let (oscillator, start) = HarmonicOscillator::example();
    let states = motion::<_, Midpoint>(&oscillator, &start, 0.1, 10_000);
    assert!(drift(&states, |state| [oscillator.energy(state)]) < 1e-13);
}

#[test]
fn a_satellite_keeps_its_angular_momentum() {
    fn check<M: SchemeType>() {
        let (kepler, start) = Kepler::example();
        let size = Kepler::angular_momentum(&start).norm();
        let states = motion::<_, M>(&kepler, &start, 30.0, 5_000);
        let drift = drift(&states, |state| Kepler::angular_momentum(state).into());
        assert!(drift < 1e-12 * size, "{} of {size}", drift);
        assert!(states.iter().all(|state| state.position.z == 0.0));
    }
    check::<Exponential>();
    check::<SymplecticEulerA<Cayley>>();
    check::<Midpoint>();
}

#[test]
fn a_satellite_comes_back_after_keplers_period() {
    let (kepler, start) = Kepler::example();
    let axis = 2e7;
    let end = after::<_, Order8<Exponential>>(&kepler, &start, kepler.period(axis), 1000);
    assert!((end.position - start.position).norm() < 1e-7 * axis, "{end:?}");
    let half = after::<_, Order8<Exponential>>(&kepler, &start, kepler.period(axis) / 2.0, 500);
    assert!((half.position + Vector3::x() * 1.6 * axis).norm() < 1e-7 * axis, "{half:?}");
    assert!((kepler.energy(&start) + kepler.attraction * kepler.mass / (2.0 * axis)).abs() < 1e-5);
}

#[test]
fn small_swings_of_a_pendulum_have_the_period_of_the_books() {
    let pendulum = PlanarPendulum::simple(2.0, 0.7);
    let period = pendulum.small_period();
    assert!((period - std::f64::consts::TAU * (0.7_f64 / 9.81).sqrt()).abs() < 1e-14);
    let start = PlanarPendulum::at_rest(1e-3);
    for (part, angle) in [(0.25, 0.0), (0.5, -1e-3), (1.0, 1e-3)] {
        let state = after::<_, Order4<Exponential>>(&pendulum, &start, part * period, 200);
        // larger swings take longer, by the square of the angle over 16
        assert!((state.angle.angle() - angle).abs() < 1e-3 * 4e-7, "{part}: {state:?}");
    }
}

#[test]
fn large_swings_of_a_pendulum_take_longer() {
    // 2π/M(1, cos ½θ), with the arithmetic-geometric mean, of a pendulum of angular frequency 1
    let angle: f64 = 2.5;
    let (mut a, mut g) = (1.0, (angle / 2.0).cos());
    for _ in 0..8 {
        (a, g) = ((a + g) / 2.0, f64::sqrt(a * g));
    }
    let pendulum = PlanarPendulum { inertia: 1.0, weight: 1.0, length: 1.0 };
    let start = PlanarPendulum::at_rest(angle);
    let end = after::<_, Order8<Cayley>>(&pendulum, &start, std::f64::consts::TAU / a, 400);
    assert!((end.angle.angle() - angle).abs() < 1e-9, "{end:?}");
    assert!(end.momentum.norm() < 1e-9, "{end:?}");
}

#[test]
fn friction_takes_what_a_pendulum_loses() {
    let pendulum = DrivenPendulum { torque: 0.0, ..DrivenPendulum::example().0 };
    let start = DrivenPendulumState { angle: UnitComplex::new(2.0), momentum: vector![0.0] };
    let states = motion::<_, Exponential>(&pendulum, &start, 0.002, 2_000);
    let lost = pendulum.energy(&start) - pendulum.energy(&states[2_000]);
    let power = |state: &DrivenPendulumState| pendulum.damping * pendulum.velocity(state).norm_squared();
    let friction: f64 = states.windows(2).map(|pair| 0.001 * (power(&pair[0]) + power(&pair[1]))).sum();
    assert!(lost > 1.0 && (lost - friction).abs() < 1e-4 * lost, "{lost} {friction}");
    assert!(states.windows(2).all(|pair| pendulum.energy(&pair[1]) < pendulum.energy(&pair[0]) + 1e-6));
}

#[test]
fn the_motor_acts_at_its_own_time() {
    // without gravity and friction: I θ' = T sin(ωt)/ω, from rest
    let pendulum =
        DrivenPendulum { inertia: 2.0, weight: 0.0, length: 1.0, damping: 0.0, torque: 0.5, frequency: 3.0 };
    let start = DrivenPendulumState { angle: UnitComplex::identity(), momentum: vector![0.0] };
    let end = after::<_, Order4<Midpoint>>(&pendulum, &start, 0.7, 100);
    assert!((end.momentum.x - 0.5 * 2.1_f64.sin() / 3.0).abs() < 1e-9, "{end:?}");
    assert!((end.angle.angle() - 0.5 * (1.0 - 2.1_f64.cos()) / 18.0).abs() < 1e-9, "{end:?}");
}

#[test]
fn a_rod_that_does_not_spin_never_does_and_swings_in_a_plane() {
    let (pendulum, start) = SphericalPendulum::example();
    let states = motion::<_, Exponential>(&pendulum, &start, 0.01, 2_000);
    assert!(drift(&states, |state| [state.momentum.z]) < 1e-15);
    // let go without a push, it swings in the plane of y = 0
    let start = pendulum.sideways(1.0, 0.0);
    let states = motion::<_, Cayley>(&pendulum, &start, 0.01, 2_000);
    let end = |k: usize| states[k].attitude * Vector3::z();
    assert!((0..=2_000).all(|k| end(k).y.abs() < 1e-13));
    assert!((0..=2_000).all(|k| (end(k) + Vector3::z()).norm() < 1.0));
    assert!((0..=2_000).any(|k| end(k).x < -0.8) && (0..=2_000).any(|k| end(k).x > 0.8));
}

#[test]
fn a_free_body_keeps_its_momentum_in_space() {
    let (body, start) = FreeRigidBody::example();
    let states = motion::<_, Cayley>(&body, &start, 0.02, 5_000);
    assert!(drift(&states, |state| body.spatial_momentum(state).into()) < 1e-12);
    // turning about its middle axis, it flips over
    assert!(states.iter().any(|state| state.momentum.y < -1.9));
}

#[test]
fn a_body_does_not_know_the_axes_it_is_described_in() {
    let (body, start) = FreeRigidBody::example();
    let axes = Rotation3::from_euler_angles(0.3, -0.7, 1.1);
    let turn = UnitQuaternion::from_rotation_matrix(&axes);
    let full = FullRigidBody { inertia: axes * Matrix3::from_diagonal(&body.inertia) * axes.inverse() };
    let turned = FullRigidBodyState { attitude: turn.inverse(), momentum: axes * start.momentum };
    let free: FreeRigidBodyState = after::<_, Exponential>(&body, &start, 5.0, 250);
    let full = after::<_, Exponential>(&full, &turned, 5.0, 250);
    assert!((full.momentum - axes * free.momentum).norm() < 1e-11);
    assert!((full.attitude * turn).angle_to(&free.attitude) < 1e-11);
}

#[test]
fn lagranges_top_keeps_the_momentum_about_its_axis() {
    let (top, start) = HeavyTop::lagrange_top();
    let states = motion::<_, Exponential>(&top, &start, 0.001, 5_000);
    assert!(drift(&states, |state| [state.momentum.z]) < 1e-15 * start.momentum.z.abs().max(1.0));
    // it leans by no more and no less than a fast top does: it nods between 30° and a little more
    let lean = |state: &HeavyTopState| state.gamma.z.acos().to_degrees();
    let (least, most) = states.iter().map(lean).fold((90.0_f64, 0.0_f64), |(a, b), x| (a.min(x), b.max(x)));
    assert!(least > 29.9 && most > 35.0 && most < 90.0, "{least}° to {most}°");
}

#[test]
fn kovalevskayas_integral_is_kept_to_the_order_of_the_step() {
    let (top, start) = HeavyTop::kovalevskaya_top();
    assert!(top.kovalevskaya(&start) > 0.05);
    let error = |step: f64, steps: u64| {
        drift(&motion::<_, Exponential>(&top, &start, step, steps), |state| [top.kovalevskaya(state)])
    };
    let (coarse, fine) = (error(0.02, 1_000), error(0.01, 2_000));
    assert!(coarse < 1e-3, "{coarse}");
    assert!((3.5..4.5).contains(&(coarse / fine)), "{coarse} {fine}");
    // no other top has it
    let other = HeavyTop { inertia: vector![2.0, 2.0, 1.3], ..top.clone() };
    assert!(
        drift(&motion::<_, Exponential>(&other, &start, 0.01, 2_000), |state| [other.kovalevskaya(state)])
            > 0.05
    );
}

#[test]
fn a_magnetic_top_sees_both_fields_where_they_are() {
    let (top, start) = MagneticTop::example();
    let states = motion::<_, Cayley>(&top, &start, 0.001, 3_000);
    let in_space =
        |field: fn(&_) -> Vector3<f64>| drift(&states, |state| (state.attitude * field(state)).into());
    assert!(in_space(|state| state.gamma) < 1e-12);
    assert!(in_space(|state| state.field) < 1e-14);
}

#[test]
fn without_a_magnetic_field_a_magnetic_top_is_a_heavy_top() {
    let (magnetic, start) = MagneticTop::example();
    let heavy = HeavyTop { inertia: magnetic.inertia, weight: magnetic.weight, chi: magnetic.chi };
    let field = MagneticTop::start(start.attitude, start.momentum, Vector3::zeros());
    let end = after::<_, Exponential>(&magnetic, &field, 0.5, 500);
    let same = after::<_, Exponential>(&heavy, &HeavyTop::start(start.attitude, start.momentum), 0.5, 500);
    assert!((end.momentum - same.momentum).norm() < 1e-13);
    assert!(end.attitude.angle_to(&same.attitude) < 1e-9);
}

#[test]
fn hover_stays_put() {
    fn check<M: SchemeType>() {
        let (quadrotor, start) = Quadrotor::hovering();
        let states = motion::<_, M>(&quadrotor, &start, 0.01, 2_000);
        let end = &states[2_000];
        assert_eq!(end.attitude, start.attitude);
        assert_eq!(end.attitude_momentum, start.attitude_momentum);
        assert!((end.position - start.position).norm() < 1e-13, "{end:?}");
        assert!(end.position_momentum.norm() < 1e-13, "{end:?}");
    }
    check::<Exponential>();
    check::<Cayley>();
    check::<Midpoint>();
    check::<SymplecticEulerA>();
    check::<SymplecticEulerB>();
    check::<Order6<Exponential>>();
}

#[test]
fn without_thrust_a_quadrotor_falls_and_thrust_lifts_it() {
    let quadrotor = Quadrotor::lee();
    for (thrust, acceleration) in [(0.0, -9.81), (2.0, 9.81)] {
        let control =
            QuadrotorControl { thrust: thrust * quadrotor.mass * quadrotor.gravity, ..Default::default() };
        let mut start = Quadrotor::at_rest(50.0);
        start.attitude_momentum = vector![0.0, 0.0, 0.1];
        start.position_momentum = vector![quadrotor.mass, 0.0, 0.0];
        let states = controlled::<_, Exponential>(&quadrotor, &start, 0.01, 200, |_, _| control);
        let state = &states[200];
        // parabolas are exact
        let expected = vector![2.0, 0.0, 50.0 + 0.5 * acceleration * 4.0];
        assert!((state.position - expected).norm() < 1e-11, "{state:?}");
    }
}

#[test]
fn the_inertia_of_a_body_off_its_centre_is_that_of_its_centre() {
    let (mass, centre) = (0.8, vector![0.1, 0.02, 0.25]);
    let about = matrix![0.012, 0.001, 0.0; 0.001, 0.0125, 0.0; 0.0, 0.0, 0.0012];
    let body = RigidBodyInSpace::new(mass, centre, about);
    assert!((body.centre() - centre).norm() < 1e-15 && body.mass() == mass);
    let (turn, velocity) = (vector![0.3, 8.0, 0.2], vector![-1.0, 0.3, 0.5]);
    let all = vector![turn.x, turn.y, turn.z, velocity.x, velocity.y, velocity.z];
    let momentum = body.inertia * all;
    let state = RigidBodyInSpaceState { pose: Isometry3::identity(), momentum };
    let of_centre = velocity + turn.cross(&centre);
    let energy = 0.5 * turn.dot(&(about * turn)) + 0.5 * mass * of_centre.norm_squared();
    assert!((body.energy(&state) - energy).abs() < 1e-14);
    assert!((body.velocity(&state) - all).norm() < 1e-12);
}

#[test]
fn a_body_in_space_keeps_its_momenta_and_its_centre_moves_uniformly() {
    let (body, start) = RigidBodyInSpace::example();
    let momentum = body.spatial_momentum(&start);
    let velocity = Vector3::from(momentum.fixed_rows::<3>(3)) / body.mass();
    let centre =
        |state: &RigidBodyInSpaceState| state.pose.rotation * body.centre() + state.pose.translation.vector;
    let error = |step: f64, steps: u64| {
        let states = motion::<_, Exponential>(&body, &start, step, steps);
        assert!(drift(&states, |state| body.spatial_momentum(state).into()) < 1e-12);
        let off = |(k, state): (usize, &RigidBodyInSpaceState)| {
            (centre(state) - centre(&start) - velocity * (k as f64 * step)).norm()
        };
        states.iter().enumerate().map(off).fold(0.0, f64::max)
    };
    let (coarse, fine) = (error(0.01, 500), error(0.005, 1_000));
    assert!(coarse < 1e-2 && (3.5..4.5).contains(&(coarse / fine)), "{coarse} {fine}");
}

#[test]
fn a_rotor_keeps_its_momentum_and_steadies_a_body() {
    let (gyrostat, start) = Gyrostat::example();
    let run = |start: &GyrostatState| motion::<_, Exponential>(&gyrostat, start, 0.02, 15_000);
    let states = run(&start);
    assert_eq!(drift(&states, |state| state.rotor_momentum.into()), 0.0);
    let in_space = |state: &GyrostatState| (state.attitude * state.attitude_momentum).into();
    assert!(drift(&states, in_space) < 1e-11);
    assert!(states.iter().all(|state| state.attitude_momentum.y > 9.9));
    // at rest it lets the body turn over
    let states = run(&GyrostatState { rotor_momentum: vector![0.0], ..start });
    assert!(states.iter().any(|state| state.attitude_momentum.y < -9.9));
}

#[test]
fn coupled_bodies_keep_their_momentum_together() {
    fn check<M: SchemeType>() {
        let (bodies, start) = CoupledBodies::example();
        let states = motion::<_, M>(&bodies, &start, 0.02, 3_000);
        let drift = drift(&states, |state| CoupledBodies::total_momentum(state).into());
        assert!(drift < 1e-12, "{drift}");
        // each alone does not
        let first = |state: &<CoupledBodies as System>::State| state.first * state.first_momentum;
        assert!((first(&states[1_500]) - first(&start)).norm() > 0.1);
    }
    check::<Exponential>();
    check::<Cayley>();
    check::<Midpoint>();
    check::<SymplecticEulerB<Cayley>>();
    check::<Order4<Exponential>>();
}

#[test]
fn a_body_in_a_fluid_keeps_its_impulse_in_space() {
    let (body, start) = Kirchhoff::example();
    let states = motion::<_, Exponential>(&body, &start, 0.02, 3_000);
    assert!(drift(&states, |state| (state.attitude * state.impulse).into()) < 1e-12);
    // along its long axis it does not stay
    assert!(states.iter().any(|state| state.impulse.z.abs() < 1.0));
}

#[test]
fn a_body_as_heavy_in_all_directions_turns_as_in_empty_space() {
    let inertia = vector![1.0, 2.0, 2.5];
    let (body, in_space) = FreeRigidBody::example();
    assert_eq!(body.inertia, inertia);
    let fluid = Kirchhoff { inertia, mass: vector![3.0, 3.0, 3.0], screw: Vector3::zeros() };
    let KirchhoffState { attitude, momentum, impulse } =
        Kirchhoff::start(in_space.attitude, in_space.momentum, vector![0.0, 0.0, 1.0]);
    let start = KirchhoffState { attitude, momentum, impulse };
    // what impulse and velocity along each other add to a step vanishes with it
    let end = after::<_, Order6<Exponential>>(&fluid, &start, 4.0, 200);
    let same = after::<_, Order6<Exponential>>(&body, &in_space, 4.0, 200);
    assert!((end.momentum - same.momentum).norm() < 1e-10);
}
