//! The ways in which steps are taken.

use coadjoint::ensemble::Instructions;
use coadjoint::{Discretized, Ensemble, Stepper, System};
use std::hint::black_box;

/// Steps that are timed together. All are short, about a millisecond: of many repetitions some are not interrupted.
pub(crate) struct Case {
    pub(crate) name: String,
    /// The steps of one run.
    pub(crate) steps: u64,
    /// Takes them, the same ones each time, and says whether all were solved.
    pub(crate) run: Box<dyn FnMut() -> bool>,
}

/// Steps in one call, as a run takes them.
pub(crate) fn long<S, M>(
    name: &str,
    mut stepper: Stepper<S, M>,
    start: &S::State,
    control: &S::Control,
    steps: u64,
) -> Case
where
    S: System<Scalar = f64, State: Clone, Control: Clone> + Discretized<M> + 'static,
    M: 'static,
{
    let (start, control) = (start.clone(), control.clone());
    let run = move || {
        let mut state = start.clone();
        let solved = stepper.steps_with(&mut state, &control, steps).is_ok();
        black_box(&state);
        solved
    };
    Case { name: name.to_owned(), steps, run: Box::new(run) }
}

/// A call for each step.
pub(crate) fn one_by_one<S, M>(
    name: &str,
    mut stepper: Stepper<S, M>,
    start: &S::State,
    control: impl Fn(u64) -> S::Control + 'static,
    steps: u64,
) -> Case
where
    S: System<Scalar = f64, State: Clone> + Discretized<M> + 'static,
    M: 'static,
{
    let start = start.clone();
    let run = move || {
        let mut state = start.clone();
        let solved = (0..steps).all(|step| stepper.step_with(&mut state, &control(step)).is_ok());
        black_box(&state);
        solved
    };
    Case { name: name.to_owned(), steps, run: Box::new(run) }
}

/// Each step from a state that the last one has not led to: nothing is there to extrapolate from.
pub(crate) fn cold<S, M>(
    name: &str,
    mut stepper: Stepper<S, M>,
    start: &S::State,
    control: &S::Control,
) -> Case
where
    S: System<Scalar = f64, State: Clone, Control: Clone> + Discretized<M> + 'static,
    M: 'static,
{
    const STATES: usize = 64;
    const STEPS_BETWEEN: usize = 7;
    let control = control.clone();
    let mut state = start.clone();
    let mut has_failed = false;
    let states: Vec<_> = (0..STATES)
        .map(|_| {
            for _ in 0..STEPS_BETWEEN {
                has_failed |= stepper.step_with(&mut state, &control).is_err();
            }
            state.clone()
        })
        .collect();
    let steps = 20_000;
    let run = move || {
        !has_failed
            && states.iter().cycle().take(steps).all(|state| {
                let mut state = state.clone();
                let solved = stepper.step_with(&mut state, &control).is_ok();
                black_box(&state);
                solved
            })
    };
    Case { name: name.to_owned(), steps: steps as u64, run: Box::new(run) }
}

/// Members that differ a little, with each set of instructions that the processor has. They go on where the last repetition has ended.
pub(crate) fn ensembles<S, M>(
    name: &str,
    system: &S,
    member: impl Fn(usize) -> S::State,
    step: f64,
) -> Vec<Case>
where
    S: System<Scalar = f64, State: Clone> + Discretized<M> + 'static,
    M: 'static,
{
    const MEMBERS: usize = 64;
    const STEPS: u64 = 500;
    Instructions::available()
        .map(|instructions| {
            let (systems, states) = (std::iter::repeat(system), (0..MEMBERS).map(&member));
            let mut ensemble = Ensemble::<S, M>::with_instructions(systems, states, step, instructions).ok();
            let run = move || {
                ensemble.as_mut().is_some_and(|ensemble| {
                    // what it returns has changed, and a member that fails is no error
                    let _ = ensemble.run(STEPS);
                    true
                })
            };
            Case {
                name: format!("{name}, ensemble, {instructions:?}"),
                steps: MEMBERS as u64 * STEPS,
                run: Box::new(run),
            }
        })
        .collect()
}

/// A scheme's three ways, at a hundredth of a second: long, one by one, cold.
macro_rules! three_ways {
    ($cases:expr, $name:literal, $scheme:ty, $system:expr, $state:expr, $control:expr) => {{
        let stepper = || $system.stepper::<$scheme>(0.01).expect("a system that can be stepped");
        let (state, control) = ($state, $control);
        let always = control.clone();
        $cases.push(crate::case::long($name, stepper(), state, control, 40_000));
        $cases.push(crate::case::one_by_one(
            concat!($name, ", one by one"),
            stepper(),
            state,
            move |_| always.clone(),
            20_000,
        ));
        $cases.push(crate::case::cold(concat!($name, ", cold"), stepper(), state, control));
    }};
}
pub(crate) use three_ways;
