//! Runs of any system, with parameters and states as flat lists of numbers.

mod advice;
mod certify;
mod classical;
pub mod ensemble;
mod estimate;
pub(crate) mod scan;
mod taylor;
pub(crate) mod threads;

use std::cell::{Cell, RefCell};
use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::Instant;

use coadjoint::RunReport;
use coadjoint::composition::{KahanLi6, KahanLi8, SofroniouSpaletta10, Suzuki4};
use coadjoint::erased::{self, StepperError};
use coadjoint::observe::Observer;
use coadjoint::system::{Quantity, Role};
use coadjoint::{Crossing, Run, Scheme, Tick};
use serde::{Deserialize, Serialize};

pub(crate) use advice::{beyond_series, slowed};
pub use certify::{certify, states_in_motion};
pub use classical::stepper as classical_stepper;
pub use estimate::{Distance, ErrorEstimate, error_estimate};

use crate::catalogue::{ControlLaw, Entry, Input, Observable, Setup};
use crate::error::{RunError, SetupError};
pub use crate::record::Sample;
use crate::setup::{Job, Method, Order, Retraction, Times, WatchedEvent};

/// The state of a run from which it can be resumed, bit for bit.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Checkpoint {
    /// The state's components.
    pub state: Vec<f64>,
    /// The stepper's memory.
    pub memory: Vec<f64>,
}

impl Checkpoint {
    /// The checkpoint at a sample.
    pub fn at(sample: &Sample<'_>) -> Self {
        Self { state: sample.state.to_vec(), memory: (sample.snapshot)() }
    }
}

/// Observes samples; may end the run.
pub type SampleObserver<'a> = dyn FnMut(&Sample<'_>) -> ControlFlow<()> + 'a;

/// Composes the scheme of a method with a retraction, of an order.
///
/// # Errors
/// If an order above 2 is asked for of a method whose steps are not symmetric, or the method is no scheme.
pub fn scheme(method: Method, retraction: Retraction, order: Order) -> Result<Scheme, SetupError> {
    let map = retraction.map();
    let base = match method.base(map, order) {
        Some(base) => base,
        None if method.is_of_order() => return Err(without_order(method)),
        None => return Err(not_certified(method)),
    };
    if method.is_of_order() {
        return Ok(base);
    }
    check_order(method, order)?;
    Ok(match order {
        Order::Two => base,
        Order::Four => Scheme::composed::<Suzuki4>(base),
        Order::Six => Scheme::composed::<KahanLi6>(base),
        Order::Eight => Scheme::composed::<KahanLi8>(base),
        Order::Ten => Scheme::composed::<SofroniouSpaletta10>(base),
    })
}

/// Chooses the usual method of this order: a Hamilton–Jacobi step where it was generated, else the standard step, or what
/// is composed of it.
pub(crate) fn usual_method(entry: &Entry, retraction: Retraction, order: Order) -> Method {
    let system = entry.system(&entry.example.parameters);
    let is_there = scheme(Method::HAMILTON_JACOBI, retraction, order)
        .is_ok_and(|scheme| erased::Stepper::new(system, &scheme, entry.step).is_ok());
    if is_there { Method::HAMILTON_JACOBI } else { Method::Standard }
}

fn without_order(method: Method) -> SetupError {
    SetupError::new(format!("method {method} takes an order above 2: `--order 6`"))
}

/// Checks that steps of this order can be composed of the method's.
fn check_order(method: Method, order: Order) -> Result<(), SetupError> {
    if method.is_of_order() {
        return if order == Order::Two { Err(without_order(method)) } else { Ok(()) };
    }
    if order == Order::Two || method.is_symmetric() {
        return Ok(());
    }
    let symmetric = Method::COMMON.into_iter().filter(|method| method.is_symmetric());
    let symmetric = symmetric.map(|method| method.to_string()).collect::<Vec<_>>().join(", ");
    Err(SetupError::new(format!(
        "order {} is composed of symmetric steps, which method {method} does not make for every system; take one of {symmetric}",
        order.number()
    )))
}

/// Says why no claims of a method can be measured.
fn not_certified(method: Method) -> SetupError {
    let why = match method {
        Method::RightLift => "takes the steps of euler-a: certify these",
        _ => "claims nothing that a certificate could measure",
    };
    SetupError::new(format!("method {method} {why}"))
}

/// Builds the stepper of a run.
///
/// # Errors
/// If parameters or step are not valid, or there are no such steps.
pub(crate) fn stepper(
    entry: &Entry,
    system: Arc<dyn erased::System>,
    input: Option<Arc<Input>>,
    job: &Job,
) -> Result<erased::Stepper, RunError> {
    let &Job { method, retraction, order, step, .. } = job;
    let stepper = match method {
        Method::Taylor(tolerance) => return taylor::stepper(system, tolerance, input, step),
        Method::Classical(classical) => {
            check_order(method, order)?;
            classical_stepper(system, classical, input, step)
        }
        Method::RightLift => {
            check_order(method, order)?;
            let lifted = entry.right_lift.clone().ok_or_else(|| {
                SetupError::new(format!(
                    "`{}` has no steps with the method right-lift, which carries the momentum in space: something acts on it",
                    entry.name
                ))
            })?;
            let make = move |system: &Arc<dyn erased::System>, step| {
                lifted(&system.parameters(), retraction.map(), step)
            };
            make(&system, step).ok_or_else(|| {
                SetupError::new(format!(
                    "there are no steps of the method right-lift with the retraction {}; take one of exponential, cayley",
                    retraction.name()
                ))
            })?;
            erased::Stepper::with_methods(system, step, make)
        }
        _ => return Ok(erased::Stepper::new(system, &scheme(method, retraction, order)?, step)?),
    };
    Ok(stepper.map_err(StepperError::from)?)
}

/// Makes a run, with the controls of the setup: from the setup's state at time 0, or on from a checkpoint. The observer
/// sees the initial state, the samples whose indices `next` gives, and the last one.
///
/// # Errors
/// If parameters or step are not valid, or a step cannot be taken.
pub fn simulate(
    entry: &Entry,
    setup: &Setup,
    job: &Job,
    from: Option<&Checkpoint>,
    next: &dyn Fn(u64) -> u64,
    observer: &mut SampleObserver<'_>,
) -> Result<RunReport, RunError> {
    let nothing = Within { until: None, events: &[], times: None, ended: &Cell::new(false) };
    let observer = &mut |seen: Seen<'_>, sample: &Sample<'_>| match seen {
        Seen::Step => observer(sample),
        _ => ControlFlow::Continue(()),
    };
    simulate_within(entry, setup, job, from, next, &nothing, observer)
}

/// What is looked at within the steps of a run.
pub(crate) struct Within<'a> {
    /// What ends the run.
    pub(crate) until: Option<&'a WatchedEvent>,
    pub(crate) events: &'a [WatchedEvent],
    /// Times at which there are samples besides those of steps.
    pub(crate) times: Option<&'a Times>,
    /// Whether `until` has ended it.
    pub(crate) ended: &'a Cell<bool>,
}

/// What a sample is of.
#[derive(Clone, Copy)]
pub(crate) enum Seen<'a> {
    /// The initial state, or a step.
    Step,
    /// A time that was asked for.
    Time,
    /// An event.
    Event(&'a WatchedEvent, Crossing),
}

/// Observes samples, and what they are of; may end the run.
pub(crate) type SeenObserver<'a> = dyn FnMut(Seen<'_>, &Sample<'_>) -> ControlFlow<()> + 'a;

/// Makes a run as [`simulate`] does, and looks at what is within its steps.
///
/// # Errors
/// As there.
pub(crate) fn simulate_within(
    entry: &Entry,
    setup: &Setup,
    job: &Job,
    from: Option<&Checkpoint>,
    next: &dyn Fn(u64) -> u64,
    within: &Within<'_>,
    observer: &mut SeenObserver<'_>,
) -> Result<RunReport, RunError> {
    let system = entry.system(&setup.parameters);
    let mut stepper = stepper(entry, system.clone(), setup.input.clone(), job)?;
    let mut state = setup.state.clone();
    if let Some(from) = from {
        state.clone_from(&from.state);
        stepper.restore(&from.memory).map_err(StepperError::from)?;
    }
    let held: Option<Vec<f64>> = setup.controls.iter().copied().collect();
    let law = if held.is_some() && setup.input.is_none() { None } else { entry.law(setup) };
    let held = held.unwrap_or_default();
    let looker = Looker { entry, law: law.as_ref(), held: &held, observer: RefCell::new(observer) };
    let mut watched = Watched { looker: &looker, next, due: 0, last: job.total(), ended: within.ended };
    let mut walk = |stepper: &mut erased::Stepper, state: &mut Vec<f64>, steps: u64, is_rest: bool| {
        let (start, is_forward) = (stepper.time(), stepper.step_size() > 0.0);
        // where the shorter step starts, the steps before it have ended
        let is_ahead = |time: &f64| !is_rest || if is_forward { *time > start } else { *time < start };
        let times =
            within.times.into_iter().flat_map(Times::iter).map(|time| job.within(time)).filter(is_ahead);
        let value = |of: &Observable, state: &[f64], time: f64| {
            of.value(&*system, state, time, &looker.controls(state, time))
        };
        let until = within.until.map(|until| (true, until));
        let all = until.into_iter().chain(within.events.iter().map(|event| (false, event)));
        let (described, others): (Vec<_>, Vec<_>) = all.partition(|(_, event)| event.place.is_some());
        let action = |is_until: bool, event: &'_ WatchedEvent| {
            let (looker, event) = (&looker, event.clone());
            move |occurrence: &mut coadjoint::Occurrence<'_, dyn erased::System>| {
                if is_until {
                    within.ended.set(true);
                    occurrence.stop();
                    return;
                }
                let seen = Seen::Event(&event, occurrence.crossing());
                let tick = Tick::new(occurrence.system(), 0, occurrence.time(), occurrence.state());
                if looker.look(seen, &tick).is_break() {
                    occurrence.stop();
                }
            }
        };
        let others = others.into_iter().map(|(is_until, watched)| {
            let (value, of) = (&value, &watched.quantity);
            let condition = move |state: &Vec<f64>, time: f64| value(of, state, time);
            (watched.event, condition, action(is_until, watched))
        });
        let described = described.into_iter().filter_map(|(is_until, watched)| {
            Some((watched.place?, watched.event, action(is_until, watched)))
        });
        let run = Run::new(stepper, state).save_at(times, AtTimes(&looker));
        let run = run.events(others).on_each(described).observe(&mut watched);
        match &law {
            Some(law) if setup.input.is_some() => {
                run.driven_by(|time| entry.chosen(law, (&[], time))).steps(steps)
            }
            Some(law) => run.controlled_by(|state, time| entry.chosen(law, (state, time))).steps(steps),
            None => run.with_control(held.clone()).steps(steps),
        }
    };
    let explained = |error, state: &[f64]| advice::explained(error, &*system, state, job);
    let steps = job.steps.saturating_sub(stepper.steps_taken());
    let mut report =
        walk(&mut stepper, &mut state, steps, false).map_err(|error| explained(error, &state))?;
    if job.rest == 0.0 || report.stopped || stepper.steps_taken() != job.steps {
        return Ok(report);
    }
    stepper.set_step_size(job.rest.copysign(job.step)).map_err(StepperError::from)?;
    let last = walk(&mut stepper, &mut state, 1, true).map_err(|error| explained(error, &state))?;
    report.steps += last.steps;
    report.stopped = last.stopped;
    report.iterations += last.iterations;
    report.max_iterations = report.max_iterations.max(last.max_iterations);
    report.max_residual = report.max_residual.max(last.max_residual);
    Ok(report)
}

/// Makes samples of ticks, and shows them to an observer.
struct Looker<'a, 'o> {
    entry: &'a Entry,
    law: Option<&'a ControlLaw>,
    held: &'a [f64],
    observer: RefCell<&'a mut SeenObserver<'o>>,
}

impl Looker<'_, '_> {
    /// The controls of a step that starts here.
    fn controls(&self, state: &[f64], time: f64) -> Vec<f64> {
        self.law.map_or_else(|| self.held.to_vec(), |law| self.entry.chosen(law, (state, time)))
    }

    fn look(&self, seen: Seen<'_>, tick: &Tick<'_, dyn erased::System>) -> ControlFlow<()> {
        let (index, time, state) = (tick.index, tick.time, &tick.state[..]);
        let chosen = self.law.map(|law| self.entry.chosen(law, (state, time)));
        let controls = chosen.as_deref().unwrap_or(self.held);
        let energy = tick.system.energy(state, time, controls);
        let numbers = self.entry.shown(tick.system, (state, time), controls);
        let casimirs = tick.system.casimirs(state);
        let (numbers, casimirs, snapshot) = (&numbers[..], &casimirs[..], &|| tick.snapshot());
        let sample = Sample { index, time, state, numbers, energy, casimirs, snapshot };
        // an observer looks at one sample after the other
        self.observer
            .try_borrow_mut()
            .map_or(ControlFlow::Continue(()), |mut observer| observer(seen, &sample))
    }
}

/// Shows the samples of times to an observer.
struct AtTimes<'a, 'b, 'o>(&'a Looker<'b, 'o>);

impl Observer<dyn erased::System> for AtTimes<'_, '_, '_> {
    fn observe(&mut self, tick: &Tick<'_, dyn erased::System>) -> ControlFlow<()> {
        self.0.look(Seen::Time, tick)
    }
}

/// Shows the samples that are needed to an observer.
struct Watched<'a, 'b, 'o> {
    looker: &'a Looker<'b, 'o>,
    next: &'a dyn Fn(u64) -> u64,
    /// The sample that is shown next.
    due: u64,
    /// The one at the end of the run.
    last: u64,
    /// Whether it has ended before.
    ended: &'a Cell<bool>,
}

impl Observer<dyn erased::System> for Watched<'_, '_, '_> {
    fn observe(&mut self, tick: &Tick<'_, dyn erased::System>) -> ControlFlow<()> {
        let index = tick.index;
        // where the last, shorter step starts there are two ticks, and perhaps nothing to be seen
        if index < self.due && index != self.last && !self.ended.get() {
            return ControlFlow::Continue(());
        }
        self.due = (self.next)(index);
        self.looker.look(Seen::Step, tick)
    }

    fn next(&self, index: u64) -> u64 {
        (self.next)(index)
    }
}

/// Measures the time that a step takes without an observer, ns: the best of three short runs; none without steps.
///
/// # Errors
/// If parameters or step are not valid, or a step cannot be taken.
pub fn time_per_step(entry: &Entry, setup: &Setup, job: &Job) -> Result<Option<f64>, RunError> {
    /// Enough to tell nanoseconds, and still short; those of methods that are written to be right, not to be fast, take
    /// longer.
    const STEPS: [u64; 2] = [50_000, 500];
    let most = STEPS[usize::from(!job.method.has_retraction())];
    let job = Job { steps: job.steps.min(most), rest: 0.0, ..*job };
    if job.steps == 0 {
        return Ok(None);
    }
    let mut best = f64::INFINITY;
    for _ in 0..3 {
        let start = Instant::now();
        simulate(entry, setup, &job, None, &|_| u64::MAX, &mut |_| ControlFlow::Continue(()))?;
        best = best.min(start.elapsed().as_secs_f64());
    }
    Ok(Some(best / job.steps as f64 * 1e9))
}

/// Tells whether there are steps of a method on the exponential map or the Cayley map.
pub(crate) fn has_method(entry: &Entry, method: Method) -> bool {
    let system = entry.system(&entry.example.parameters);
    let is_there = |retraction: Retraction| {
        let job = Job { method, retraction, order: Order::Two, step: entry.step, steps: 0, rest: 0.0 };
        stepper(entry, system.clone(), None, &job).is_ok()
    };
    Retraction::COMMON.into_iter().any(is_there)
}

/// Tells whether a run keeps its energy: with controls that are held, where neither a force nor time has a part in it at
/// its start and at its end.
pub(crate) fn conserves_energy(entry: &Entry, setup: &Setup, (time, end): (f64, &[f64])) -> bool {
    let held: Option<Vec<f64>> = setup.controls.iter().copied().collect();
    let Some(held) = held else { return false };
    let system = entry.system(&setup.parameters);
    let acts = |time: f64, state: &[f64]| {
        let energy = |time| system.energy(state, time, &held);
        let force = system.force(state, time, &held);
        force.iter().any(|component| *component != 0.0) || energy(time) != energy(time + 0.618)
    };
    entry.description.autonomous || !(acts(0.0, &setup.state) || acts(time, end))
}

/// Tells how large energies of a motion are: the largest of the energy at its start, and of the kinetic energies there and at
/// its end.
pub(crate) fn energy_size(entry: &Entry, setup: &Setup, (time, end): (f64, &[f64])) -> f64 {
    let (system, law) = (entry.system(&setup.parameters), entry.law(setup));
    let kinetic = |(time, state): (f64, &[f64])| {
        let control = law.as_ref().map(|law| entry.chosen(law, (state, time))).unwrap_or_default();
        let velocities = system.differential(state, time, &control);
        let momenta = Quantity::with_ranges(entry.description.state)
            .filter(|(quantity, _)| quantity.role == Role::Momentum);
        let products =
            momenta.flat_map(|(quantity, slots)| state[slots].iter().zip(&velocities[quantity.tangent()]));
        0.5 * products.map(|(momentum, velocity)| momentum * velocity).sum::<f64>().abs()
    };
    let start = entry.energy(&*system, law.as_ref(), (&setup.state, 0.0)).abs();
    start.max(kinetic((0.0, &setup.state))).max(kinetic((time, end)))
}
