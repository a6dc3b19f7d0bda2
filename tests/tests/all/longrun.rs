//! Half an hour of motion in 180,000 steps of 0.01: what the mathematics keeps is kept to roundoff, and the energy error stays
//! bounded without trend.

use coadjoint::prelude::*;
use coadjoint::{Discretized, System};
use coadjoint_support::measure::{largest, smooth_mean, trend};
use coadjoint_support::systems::{FreeRigidBody, FreeRigidBodyState, HeavyTop, HeavyTopState};

const STEPS: usize = 180_000;
const STEP: f64 = 0.01;
/// Steps from one look at it to the next.
const EVERY: usize = 10;

/// Roundoff may wander this far in 180,000 steps.
const DRIFT: f64 = 1e-12;

/// What a run did to the quantities that matter, each the largest deviation from the start.
#[derive(Debug)]
struct Run {
    casimirs: Vec<f64>,
    spatial_momentum: Vector3<f64>,
    attitude_off_unit: f64,
    /// Of the first advected vector, in space.
    vertical: f64,
    energy_errors: Vec<f64>,
}

fn run<S, M>(system: &S, mut state: S::State) -> Run
where
    S: System<Scalar = f64, Momentum = Vector3<f64>> + Discretized<M>,
{
    let attitude = |state: &S::State| {
        let q = state.to_components();
        let q = q.as_ref();
        Quaternion::new(q[0], q[1], q[2], q[3])
    };
    // the vertical as the attitude carries it into space
    let vertical = |state: &S::State| {
        let components = state.to_components();
        let gamma = components.as_ref().get(7..10)?;
        let gamma = Vector3::new(gamma[0], gamma[1], gamma[2]);
        Some(UnitQuaternion::new_unchecked(attitude(state)) * gamma)
    };
    let casimirs: Vec<f64> = system.casimirs(&state).as_ref().to_vec();
    let (spatial, energy, up) = (system.spatial_momentum(&state), system.energy(&state), vertical(&state));

    let mut run = Run {
        casimirs: vec![0.0; casimirs.len()],
        spatial_momentum: Vector3::zeros(),
        attitude_off_unit: 0.0,
        vertical: 0.0,
        energy_errors: Vec::with_capacity(STEPS / EVERY),
    };
    let mut stepper = system.stepper::<M>(STEP).expect("a stepper");
    for _ in 0..STEPS / EVERY {
        stepper.steps_with(&mut state, &S::Control::default(), EVERY as u64).expect("steps");
        for ((drift, now), start) in
            run.casimirs.iter_mut().zip(system.casimirs(&state).as_ref()).zip(&casimirs)
        {
            *drift = largest([*drift, now - start]);
        }
        run.spatial_momentum = run.spatial_momentum.sup(&(system.spatial_momentum(&state) - spatial).abs());
        run.attitude_off_unit = largest([run.attitude_off_unit, attitude(&state).norm() - 1.0]);
        if let (Some(up), Some(now)) = (up, vertical(&state)) {
            run.vertical = largest([run.vertical, (now - up).amax()]);
        }
        run.energy_errors.push(system.energy(&state) - energy);
    }
    run
}

/// The energy error oscillates, but goes nowhere.
fn assert_energy_has_no_trend(errors: &[f64], what: &str) {
    let bound = largest(errors.iter().copied());
    let duration = STEPS as f64 * STEP;
    // blocks of 36 s and of 18 s: several oscillations each
    for blocks in [50, 100] {
        let trend = trend(errors, EVERY as f64 * STEP, blocks);
        println!(
            "{what}: |energy error| ≤ {bound:.2e}, trend over the run {:.1e} ± {:.1e} ({:.2} standard errors, {blocks} blocks)",
            trend.slope * duration,
            trend.error * duration,
            trend.slope / trend.error,
        );
        assert!(trend.slope.abs() <= 2.0 * trend.error, "{what}: energy drifts: {trend:?}");
        // the fit is sharp enough to see a drift by a few hundredths of the oscillation
        assert!(trend.error * duration < 0.03 * bound, "{what}: the fit says nothing: {trend:?}");
    }
    // the second half is no worse than the first
    let (first, second) = errors.split_at(errors.len() / 2);
    let shift = smooth_mean(second) - smooth_mean(first);
    println!("{what}: mean energy of second half − of first half {shift:.1e}");
    // the motion is quasi-periodic: smooth means see through the oscillation, down to the wandering of roundoff
    assert!(shift.abs() < DRIFT, "{what}: the mean energy changes by {shift:e}");
    let worse = largest(second.iter().copied()) / largest(first.iter().copied());
    assert!(worse < 1.2, "{what}: the energy error grows by {worse}");
}

fn free_body<M>(what: &str)
where
    FreeRigidBody: Discretized<M>,
{
    let body = FreeRigidBody { inertia: vector![1.0, 10.0, 100.0] };
    let start = FreeRigidBodyState { attitude: UnitQuaternion::identity(), momentum: vector![1.0, 1.0, 1.0] };
    let run = run::<_, M>(&body, start);
    println!(
        "{what}: |Π|² {:.1e}, spatial momentum {:.1e}, |q| − 1 {:.1e}",
        run.casimirs[0],
        run.spatial_momentum.amax(),
        run.attitude_off_unit
    );
    assert!(run.casimirs[0] < DRIFT, "{what}: |Π|² drifts by {:e}", run.casimirs[0]);
    assert!(run.spatial_momentum.amax() < DRIFT, "{what}: RΠ drifts by {:?}", run.spatial_momentum);
    assert!(run.attitude_off_unit < 1e-14, "{what}: |q| is off by {:e}", run.attitude_off_unit);
    assert_energy_has_no_trend(&run.energy_errors, what);
}

fn top<M>(chi: Vector3<f64>, what: &str)
where
    HeavyTop: Discretized<M>,
{
    let top = HeavyTop { inertia: vector![1.0, 10.0, 100.0], weight: 1.0, chi };
    let start = HeavyTopState {
        attitude: UnitQuaternion::identity(),
        momentum: vector![1.0, 1.0, 1.0],
        gamma: Vector3::z(),
    };
    let run = run::<_, M>(&top, start);
    println!(
        "{what}: |Γ|² {:.1e}, Π·Γ {:.1e}, RΓ {:.1e}, vertical momentum {:.1e}, |q| − 1 {:.1e}",
        run.casimirs[0], run.casimirs[1], run.vertical, run.spatial_momentum.z, run.attitude_off_unit
    );
    assert!(run.casimirs[0] < DRIFT, "{what}: |Γ|² drifts by {:e}", run.casimirs[0]);
    assert!(run.casimirs[1] < DRIFT, "{what}: Π·Γ drifts by {:e}", run.casimirs[1]);
    // gravity has no torque about the vertical; attitude and vertical go separate ways, but by roundoff only
    assert!(run.spatial_momentum.z < DRIFT, "{what}: (RΠ)_z drifts by {:e}", run.spatial_momentum.z);
    assert!(run.vertical < DRIFT, "{what}: RΓ drifts by {:e}", run.vertical);
    assert!(run.attitude_off_unit < 1e-14, "{what}: |q| is off by {:e}", run.attitude_off_unit);
    assert_energy_has_no_trend(&run.energy_errors, what);
}

#[test]
fn a_free_body_keeps_its_momentum() {
    free_body::<Exponential>("free body, exponential");
    free_body::<Cayley>("free body, Cayley");
}

#[test]
fn the_top_of_the_paper_keeps_its_casimirs() {
    top::<Exponential>(Vector3::z(), "top, exponential");
    top::<Cayley>(Vector3::z(), "top, Cayley");
}

#[test]
fn a_lopsided_top_keeps_its_casimirs() {
    let chi = vector![0.3, 0.2, 1.0];
    top::<Exponential>(chi, "lopsided top, exponential");
    top::<Cayley>(chi, "lopsided top, Cayley");
}
