//! The same of steppers whose types are known, and of a body of `f32`.

use super::*;

use coadjoint::prelude::*;
use coadjoint::taylor::PowerSeries;
use coadjoint::{Control, Discretized, State};
use coadjoint_app::Example;
use coadjoint_systems::double_pendulum::DoublePendulum;
use coadjoint_systems::heavy_top::HeavyTop;
use coadjoint_systems::three_level_atom::ThreeLevelAtom;

/// A body of single precision.
#[lie_poisson_system(group = SO3, control(torque: R3), force = torque)]
#[derive(Clone)]
struct Single {
    #[inertia]
    inertia: Vector3<f32>,
}

fn doubles<T: Copy + Into<f64>>(numbers: &[T]) -> Vec<f64> {
    numbers.iter().map(|x| (*x).into()).collect()
}

/// These numbers with one or two others among them; of all that fit.
fn drawn<T: Copy + Into<f64>>(hostile: &mut Hostile, sound: &mut [T], of: impl Fn(f64) -> T) {
    let others = hostile.slice(&doubles(sound));
    for (to, from) in sound.iter_mut().zip(others) {
        *to = of(from);
    }
}

/// What numbers of a system are made of doubles by.
type Of<T> = fn(f64) -> T;

fn steps<S, M>(system: &S, sound: &S::State, step: f64, of: Of<S::Scalar>, hostile: &mut Hostile)
where
    S: Discretized<M> + 'static,
    S::Scalar: Into<f64>,
    M: 'static,
{
    let state = |hostile: &mut Hostile| {
        let mut numbers = sound.to_components();
        drawn(hostile, numbers.as_mut(), of);
        S::State::from_components(&numbers)
    };
    let other = |hostile: &mut Hostile| {
        let mut parameters = system.to_parameters();
        drawn(hostile, parameters.as_mut(), of);
        S::from_parameters(&parameters)
    };
    let control = |hostile: &mut Hostile| {
        let mut numbers = S::Control::default().to_components();
        drawn(hostile, numbers.as_mut(), of);
        S::Control::from_components(&numbers)
    };
    let bits = |state: &S::State| bits(&doubles(state.to_components().as_ref()));
    let Ok(mut stepper) = other(hostile).stepper::<M>(of(hostile.near(step))) else { return };
    let mut now = sound.clone();
    for _ in 0..12 {
        match hostile.below(12) {
            0 => now = state(hostile),
            1 => drop(stepper.set_step_size(of(hostile.number()))),
            2 => drop(stepper.set_system(&other(hostile))),
            3 => stepper.set_time(hostile.number()),
            4 => {
                let memory = hostile.slice(&stepper.snapshot());
                let _ = stepper.restore(&memory);
            }
            5 => stepper.reset(),
            _ => {}
        }
        let held = control(hostile);
        let before = (bits(&now), stepper.time().to_bits(), stepper.steps_taken());
        let is_taken = match hostile.below(4) {
            0 => stepper.step_driven(&mut now, |_| control(hostile)).is_ok(),
            1 => match stepper.steps_with(&mut now, &held, 3) {
                Ok(_) => true,
                Err(error) => error.report.steps > 0,
            },
            2 => stepper.step(&mut now).is_ok(),
            _ => stepper.step_with(&mut now, &held).is_ok(),
        };
        if !is_taken {
            let after = (bits(&now), stepper.time().to_bits(), stepper.steps_taken());
            assert_eq!(before, after, "a step that failed changed something");
            now = sound.clone();
        }
        assert!(is_finite(&doubles(now.to_components().as_ref())), "a step led to no numbers");
    }
}

fn series<S: PowerSeries<Scalar = f64> + 'static>(system: &S, sound: &S::State, hostile: &mut Hostile) {
    let mut parameters = system.to_parameters();
    drawn(hostile, parameters.as_mut(), |x| x);
    let Ok(steps) = S::from_parameters(&parameters).adaptive(hostile.near(1e-9)) else { return };
    let mut steps = steps.with_order(hostile.below(50)).with_max_step(hostile.near(1.0));
    let mut now = sound.clone();
    for _ in 0..6 {
        let mut numbers = sound.to_components();
        if hostile.one_in(2) {
            drawn(hostile, numbers.as_mut(), |x| x);
            now = S::State::from_components(&numbers);
        }
        if hostile.one_in(3) {
            steps.set_time(hostile.number());
        }
        let before = (bits(now.to_components().as_ref()), steps.time().to_bits());
        let taken = match hostile.below(2) {
            0 => steps.step(&mut now).map(|_| ()),
            _ => steps.step_toward(&mut now, &S::Control::default(), hostile.number()).map(|_| ()),
        };
        if taken.is_err() {
            assert_eq!(before, (bits(now.to_components().as_ref()), steps.time().to_bits()));
            now = sound.clone();
        }
        drop(steps.at(hostile.number()));
    }
}

#[test]
fn hostile_calls_of_known_types_are_answered() {
    let ((top, leaning), (atom, dark)) = (HeavyTop::example(), ThreeLevelAtom::example());
    let (pendulum, hanging) = DoublePendulum::example();
    let single = Single { inertia: vector![1.0, 2.0, 2.5] };
    let spinning = SingleState { momentum: vector![0.1, 2.0, 0.1], ..SingleState::default() };
    let double: Of<f64> = |x| x;
    campaign(
        100,
        &[
            ("HeavyTop", &|hostile| steps::<_, Cayley>(&top, &leaning, 0.01, double, hostile)),
            ("ThreeLevelAtom", &|hostile| steps::<_, Exponential>(&atom, &dark, 2e-9, double, hostile)),
            ("f32", &|hostile| steps::<_, Cayley>(&single, &spinning, 0.01, |x| x as f32, hostile)),
            ("series of DoublePendulum", &|hostile| series(&pendulum, &hanging, hostile)),
        ],
    );
}
