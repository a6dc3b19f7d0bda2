//! Warm steps are converged steps: a stepper that is kept, as users keep it, takes the steps that the equations say, at random states of random
//! systems and where the catalogue's motion is sudden or of several scales.

use coadjoint::prelude::*;
use coadjoint::{Discretized, System};
use coadjoint_app::Example;
use coadjoint_support::for_each_system_and_retraction;
use coadjoint_support::random::Random;
use coadjoint_support::systems::Sample;
use coadjoint_systems::gyrostat::Gyrostat;
use coadjoint_systems::kepler::Kepler;
use coadjoint_systems::quadrotor::{Quadrotor, QuadrotorControl};

/// The largest error of warm steps, in units of epsilon.
const LIMIT: f64 = 8.0;

/// The parts of a state, by its quantities.
fn parts<S: System>() -> impl Iterator<Item = usize> {
    S::State::QUANTITIES.iter().map(|quantity| quantity.components.len())
}

/// How far a state is from the one that a step should have led to, in the part where that is most, in units of epsilon: of the part, or of
/// what the step adds to it if that is more.
fn error<S: System<Scalar = f64>>(before: &S::State, is: &S::State, should: &S::State) -> f64 {
    let [before, is, should] = [before, is, should].map(|state| state.to_components());
    let (before, is, should) = (before.as_ref(), is.as_ref(), should.as_ref());
    let (mut worst, mut from) = (0.0_f64, 0);
    for length in parts::<S>() {
        let places = from..from + length;
        from += length;
        let largest =
            |of: &dyn Fn(usize) -> f64| places.clone().fold(0.0, |size: f64, i| size.max(of(i).abs()));
        let size = largest(&|i| before[i]).max(largest(&|i| should[i])).max(f64::MIN_POSITIVE / f64::EPSILON);
        worst = worst.max(largest(&|i| is[i] - should[i]) / size / f64::EPSILON);
    }
    worst
}

/// The largest error of so many steps of one stepper, at the states that it comes to.
fn worst_error<S, M>(
    system: &S,
    start: &S::State,
    step: f64,
    steps: usize,
    mut control: impl FnMut(usize) -> S::Control,
) -> f64
where
    S: System<Scalar = f64> + Discretized<M>,
{
    let mut state = start.clone();
    let mut warm = system.stepper::<M>(step).expect("a stepper");
    let (mut worst, mut compared) = (0.0_f64, 0);
    for k in 0..steps {
        let (before, mut converged, control) = (state.clone(), state.clone(), control(k));
        let mut fresh = system.stepper::<Compensated<M>>(step).expect("a stepper");
        fresh.set_time(warm.time());
        let is_converged = fresh.step_with(&mut converged, &control);
        warm.step_with(&mut state, &control).expect("a warm step");
        // elementary functions have the digits of one number, and now and then that is too few to converge
        if let Err(error) = is_converged {
            println!("{}, {}, step {step}, from {before:?}: {error}", S::NAME, core::any::type_name::<M>());
            continue;
        }
        worst = worst.max(error::<S>(&before, &state, &converged));
        compared += 1;
    }
    assert!(20 * compared >= 19 * steps, "{compared} of {steps} steps compared");
    worst
}

#[test]
fn at_random_states_of_random_systems() {
    fn check<S: Sample + Discretized<M>, M>(what: &str) {
        let mut random = Random::new(7);
        for _ in 0..4 {
            let (system, state) = S::sample(&mut random);
            let step = random.between(0.01, 0.2);
            let worst = worst_error::<S, M>(&system, &state, step, 150, |_| S::Control::default());
            assert!(worst < LIMIT, "{what}, step {step}: {worst} eps");
        }
    }
    for_each_system_and_retraction!(check);
}

/// One stepper there, one back.
#[test]
fn back_from_where_they_led_to() {
    fn check<S: Sample + Discretized<M>, M>(what: &str) {
        let mut random = Random::new(8);
        for _ in 0..10 {
            let (system, start) = S::sample(&mut random);
            let step = random.between(0.01, 0.2);
            let mut state = start.clone();
            for step in [step, -step] {
                let mut stepper = system.stepper::<M>(step).expect("a stepper");
                stepper.steps_with(&mut state, &S::Control::default(), 60).expect("steps");
            }
            let missed = error::<S>(&start, &state, &start) * f64::EPSILON;
            assert!(missed < 2e-13, "{what}: sixty steps back miss by {missed:e}");
        }
    }
    for_each_system_and_retraction!(check);
}

/// On a long ellipse nearly nothing happens for long, and then everything.
#[test]
fn where_a_satellite_comes_near() {
    let (kepler, _) = Kepler::example();
    let start = kepler.at_pericentre(2e7, 0.9);
    let steps = (1.1 * kepler.period(2e7) / 20.0) as usize;
    let free = |_| NoControl::default();
    let verlet = worst_error::<_, StormerVerlet>(&kepler, &start, 20.0, steps, free);
    let midpoint = worst_error::<_, Midpoint>(&kepler, &start, 20.0, steps, free);
    assert!(verlet < LIMIT && midpoint < LIMIT, "{verlet} and {midpoint} eps");
}

/// A slender rotor is quick where its carrier is slow.
#[test]
fn where_scales_are_mixed() {
    let (gyrostat, start) = Gyrostat::example();
    let free = |_| NoControl::default();
    let cayley = worst_error::<_, Cayley>(&gyrostat, &start, 4e-3, 1_300, free);
    let midpoint = worst_error::<_, Midpoint>(&gyrostat, &start, 4e-3, 1_300, free);
    assert!(cayley < LIMIT && midpoint < LIMIT, "{cayley} and {midpoint} eps");
}

/// It glides along upright, which needs no solving at all, until somebody takes the sticks.
#[test]
fn where_a_quadrotor_is_suddenly_steered() {
    let (quadrotor, mut start) = Quadrotor::example();
    // next to it, what is left of weight and thrust is a number with all its digits
    start.position_momentum = vector![3.0, 2.0, 5.0];
    for size in [1e-9, 1e-3, 1.0] {
        let mut random = Random::new(9);
        let hover = quadrotor.hover();
        let mut sticks = |k: usize| match k {
            0..200 => hover,
            _ => QuadrotorControl {
                moment: 0.02 * size * random.vector(),
                thrust: hover.thrust * (1.0 + size * random.between(-0.5, 0.5)),
            },
        };
        let cayley = worst_error::<_, Cayley>(&quadrotor, &start, 0.01, 400, &mut sticks);
        let midpoint = worst_error::<_, Midpoint>(&quadrotor, &start, 0.01, 400, &mut sticks);
        assert!(cayley < LIMIT && midpoint < LIMIT, "{size:e}: {cayley} and {midpoint} eps");
    }
}

/// What is remembered makes no step fail that can be taken without.
#[test]
fn steps_fail_only_where_they_fail_cold() {
    fn check<S: Sample + Discretized<M>, M>(what: &str) {
        let mut random = Random::new(9);
        for _ in 0..4 {
            let (system, start) = S::sample(&mut random);
            let mut step = 0.1;
            while step < 10.0 {
                let mut state = start.clone();
                let mut warm = system.stepper::<M>(step).expect("a stepper");
                for k in 0..60 {
                    let (mut fresh, mut alone) =
                        (system.stepper::<M>(step).expect("a stepper"), state.clone());
                    fresh.set_time(warm.time());
                    let control = S::Control::default();
                    let (warm, cold) =
                        (warm.step_with(&mut state, &control), fresh.step_with(&mut alone, &control));
                    if let (Err(error), Ok(_)) = (warm, cold) {
                        panic!("{what}, step {step}, after {k} steps: {error}");
                    }
                    if warm.is_err() {
                        break;
                    }
                }
                step *= 1.4;
            }
        }
    }
    for_each_system_and_retraction!(check);
}
