//! Runs: recorded, watched for events, controlled from Python.

use std::cell::{Cell, RefCell};
use std::ops::ControlFlow;

use coadjoint::erased;
use coadjoint::event::Within;
use coadjoint::run::ControlLaw;
use coadjoint::stepper::{Inputs, Stepping};
use coadjoint::{Crossing, Event, Observer, Occurrence, Run, RunError, RunReport, Tick};
use numpy::PyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::error;
use crate::numbers::{Numbers, append, array, check, numbers, returned, rows, slice};
use crate::system::{System, scheme};
use crate::watch::Watch;

/// What acts on the system.
#[derive(FromPyObject)]
enum Law<'py> {
    /// A control that is held, or none.
    Held(Option<Numbers<'py>>),
    /// A kind, and what belongs to it.
    Of((String, Py<PyAny>, Option<Py<PyAny>>)),
}

/// The same, without Python.
enum Acting {
    Held(Vec<f64>),
    /// Controls on a grid of times, each held until the next.
    Grid(Vec<f64>, Vec<f64>),
    /// A function of time.
    Driven(Py<PyAny>),
    /// A function of time and state, asked before each step.
    Feedback(Py<PyAny>),
}

/// What is zero at an event.
#[derive(FromPyObject)]
enum Condition {
    /// The description's event at this place.
    Described(usize),
    /// A function of time and state.
    Own(Py<PyAny>),
}

/// An event: its condition, its direction, after how many occurrences the run ends, how many points are looked at in a step, and what is done.
type Watched = (Condition, f64, u64, Option<u32>, Option<Py<PyAny>>);

impl Law<'_> {
    fn acting(self, py: Python<'_>, controls: usize) -> PyResult<Acting> {
        Ok(match self {
            Self::Held(None) => Acting::Held(vec![0.0; controls]),
            Self::Held(Some(control)) => Acting::Held(numbers(&control, controls, "the controls")?),
            Self::Of((kind, first, second)) => match (kind.as_str(), second) {
                ("driven", _) => Acting::Driven(first),
                ("feedback", _) => Acting::Feedback(first),
                (_, Some(values)) => {
                    let times: Numbers<'_> = first.extract(py)?;
                    let values: Numbers<'_> = values.extract(py)?;
                    let (times, values) = (slice(&times)?, slice(&values)?);
                    check(values, times.len() * controls, "controls on a grid")?;
                    Acting::Grid(times.to_vec(), values.to_vec())
                }
                (kind, None) => return Err(PyValueError::new_err(format!("no law is of the kind {kind}"))),
            },
        })
    }
}

impl Acting {
    /// The control on a grid in a step that starts at a time.
    fn on_grid(times: &[f64], values: &[f64], controls: usize, time: f64, is_forward: bool) -> Vec<f64> {
        // steps end at times that are rounded
        let rounding = 1e-12 * time.abs();
        let within = if is_forward { time + rounding } else { time - rounding };
        let place = times.partition_point(|known| *known <= within).saturating_sub(1);
        values[place * controls..(place + 1) * controls].to_vec()
    }
}

/// What a function of time, or of time and state, returns.
fn asked(watch: &Watch, function: &Py<PyAny>, time: f64, state: Option<&[f64]>, controls: usize) -> Vec<f64> {
    let value = Python::attach(|py| {
        let value = match state {
            Some(state) => function.bind(py).call1((time, PyArray1::from_slice(py, state)))?,
            None => function.bind(py).call1((time,))?,
        };
        returned(&value, controls, "the controls")
    });
    watch.kept(value, vec![f64::NAN; controls])
}

/// What is recorded.
#[derive(Default)]
struct Records {
    times: Vec<f64>,
    states: Vec<f64>,
    controls: Vec<f64>,
}

impl Records {
    fn push(
        &mut self,
        time: f64,
        state: &[f64],
        control: Option<&Vec<f64>>,
        controls: usize,
    ) -> PyResult<()> {
        append(&mut self.times, &[time])?;
        append(&mut self.states, state)?;
        match control {
            Some(control) => append(&mut self.controls, control),
            None => append(&mut self.controls, &vec![0.0; controls]),
        }
    }
}

/// Records every so many steps, and ends the run where something went wrong.
struct Recorder<'a> {
    records: &'a RefCell<Records>,
    watch: &'a Watch,
    every: Option<u64>,
    /// Whether functions of the user's are called between.
    each: bool,
    look_at: Cell<u64>,
    span: (f64, f64),
    controls: usize,
}

impl Observer<dyn erased::System> for Recorder<'_> {
    fn observe(&mut self, tick: &Tick<'_, dyn erased::System>) -> ControlFlow<()> {
        if self.every.is_some_and(|every| tick.index.is_multiple_of(every)) {
            let pushed = self.records.borrow_mut().push(tick.time, tick.state, tick.control, self.controls);
            self.watch.kept(pushed, ());
        }
        if tick.index >= self.look_at.get() {
            let share = (tick.time - self.span.0) / (self.span.1 - self.span.0);
            let interval = self.watch.look(share);
            self.look_at.set(tick.index.saturating_add(interval));
        }
        if self.watch.has_failed() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    fn next(&self, index: u64) -> u64 {
        if self.each {
            return index + 1;
        }
        let record = self.every.map_or(u64::MAX, |every| (index / every + 1).saturating_mul(every));
        record.min(self.look_at.get().max(index + 1))
    }
}

/// Records the states at times that were asked for.
struct Samples<'a> {
    records: &'a RefCell<Records>,
    watch: &'a Watch,
    controls: usize,
}

impl Observer<dyn erased::System> for Samples<'_> {
    fn observe(&mut self, tick: &Tick<'_, dyn erased::System>) -> ControlFlow<()> {
        let pushed = self.records.borrow_mut().push(tick.time, tick.state, tick.control, self.controls);
        self.watch.kept(pushed, ());
        ControlFlow::Continue(())
    }
}

/// An event that came: its number, its time, the state that led there.
type Hit = (usize, f64, Vec<f64>, &'static str);

/// How a run is to be made.
struct Plan<'a> {
    span: (f64, f64),
    every: Option<u64>,
    samples: Option<&'a [f64]>,
    events: &'a [Watched],
    /// Those of the description.
    described: &'static [(&'static str, Event)],
    /// Numbers of a state, and of the controls.
    lengths: (usize, usize),
}

/// What a run is made of, besides its stepper.
struct Made<'a> {
    ticks: &'a RefCell<Records>,
    samples: &'a RefCell<Records>,
    hits: &'a RefCell<Vec<Hit>>,
    watch: &'a Watch,
}

type Outcome = Result<RunReport, RunError>;

fn made(
    stepper: &mut Any,
    state: &mut Vec<f64>,
    acting: &Acting,
    plan: &Plan<'_>,
    made: &Made<'_>,
) -> Outcome {
    let run = Run::new(stepper, state).starting_at(plan.span.0);
    let (watch, controls) = (made.watch, plan.lengths.1);
    match acting {
        Acting::Held(control) => watched(run.with_control(control.clone()), plan, made, false),
        Acting::Grid(times, values) => {
            let is_forward = plan.span.0 <= plan.span.1;
            let law = |_: &Vec<f64>, time: f64| Acting::on_grid(times, values, controls, time, is_forward);
            watched(run.with_breakpoints(times).controlled_by(law), plan, made, false)
        }
        Acting::Driven(function) => {
            watched(run.driven_by(|time| asked(watch, function, time, None, controls)), plan, made, true)
        }
        Acting::Feedback(function) => {
            let law = |state: &Vec<f64>, time: f64| asked(watch, function, time, Some(state), controls);
            watched(run.controlled_by(law), plan, made, true)
        }
    }
}

type Any = dyn Stepping<System = dyn erased::System> + Send;

type Bare<'a, C> = Run<'a, Any, (), C>;

fn watched<C: ControlLaw<dyn erased::System>>(
    run: Bare<'_, C>,
    plan: &Plan<'_>,
    made: &Made<'_>,
    calls: bool,
) -> Outcome {
    let (width, controls) = plan.lengths;
    let recorder = Recorder {
        records: made.ticks,
        watch: made.watch,
        every: plan.every,
        each: calls || !plan.events.is_empty(),
        look_at: Cell::new(64),
        span: plan.span,
        controls,
    };
    if plan.events.is_empty() && plan.samples.is_none() {
        return to(run.observe(recorder), plan);
    }
    let counts: Vec<Cell<u64>> = plan.events.iter().map(|_| Cell::new(0)).collect();
    let happened = |number: usize| {
        let ((_, _, most, _, action), count) = (&plan.events[number], &counts[number]);
        move |at: &mut Occurrence<'_, dyn erased::System>| {
            let how = match at.crossing() {
                Crossing::Rising => "rising",
                Crossing::Falling => "falling",
                Crossing::Touch => "touch",
            };
            made.hits.borrow_mut().push((number, at.time(), at.before().clone(), how));
            count.set(count.get() + 1);
            if let Some(action) = action {
                let state = at.state().clone();
                let next = Python::attach(|py| {
                    let next = action.bind(py).call1((at.time(), PyArray1::from_slice(py, &state)))?;
                    if next.is_none() { Ok(None) } else { returned(&next, width, "the state").map(Some) }
                });
                if let Some(next) = made.watch.kept(next, None) {
                    if plan.every.is_some() {
                        let (time, control) = (at.time(), at.control().clone());
                        let mut ticks = made.ticks.borrow_mut();
                        let pushed = ticks
                            .push(time, &state, Some(&control), controls)
                            .and_then(|()| ticks.push(time, &next, Some(&control), controls));
                        made.watch.kept(pushed, ());
                    }
                    *at.state_mut() = next;
                }
            }
            if count.get() == *most || made.watch.has_failed() {
                at.stop();
            }
        }
    };
    let (mut own, mut described) = (Vec::new(), Vec::new());
    for (number, (condition, direction, _, points, _)) in plan.events.iter().enumerate() {
        let event = match direction {
            direction if *direction > 0.0 => Event::rising(),
            direction if *direction < 0.0 => Event::falling(),
            _ => Event::any(),
        };
        let event = points.map_or(event, |points| event.points(points));
        match condition {
            Condition::Described(place) => {
                let event = plan.described.get(*place).map_or(event, |(_, event)| *event);
                described.push((*place, event, happened(number)));
            }
            Condition::Own(function) => {
                let value = move |state: &Vec<f64>, time: f64| {
                    let value = Python::attach(|py| {
                        function.bind(py).call1((time, PyArray1::from_slice(py, state)))?.extract::<f64>()
                    });
                    made.watch.kept(value, f64::NAN)
                };
                own.push((event, value, happened(number)));
            }
        }
    }
    let run = run.observe(recorder).events(own).on_each(described);
    let times = plan.samples.unwrap_or_default().to_vec();
    to(run.save_at(times, Samples { records: made.samples, watch: made.watch, controls }), plan)
}

fn to<O, C, W>(run: Run<'_, Any, O, C, W>, plan: &Plan<'_>) -> Outcome
where
    O: Observer<dyn erased::System>,
    C: ControlLaw<dyn erased::System>,
    W: Within<dyn erased::System>,
{
    run.to(plan.span.1)
}

/// What takes the steps: of one size, or as long as a tolerance allows.
fn stepping(
    system: &System,
    name: &str,
    step: Option<f64>,
    (tolerance, max_step): (Option<f64>, Option<f64>),
) -> PyResult<Box<Any>> {
    Ok(match (step, tolerance) {
        (_, Some(tolerance)) => {
            let steps = erased::Adaptive::new(system.erased(), tolerance).map_err(error::stepper)?;
            Box::new(steps.with_max_step(max_step.unwrap_or(f64::INFINITY)))
        }
        (Some(step), None) => {
            Box::new(erased::Stepper::new(system.erased(), &scheme(name)?, step).map_err(error::stepper)?)
        }
        (None, None) => return Err(PyValueError::new_err("either a `step` or a `tolerance` is needed")),
    })
}

#[pymethods]
impl System {
    /// Runs from a state: times and states, and how it went.
    #[pyo3(signature = (scheme, state, span, *, step=None, tolerance=None, max_step=None, controls, every=None, samples=None, events, progress=None))]
    #[allow(clippy::too_many_arguments, reason = "Python's own words are on the other side")]
    fn run<'py>(
        &self,
        py: Python<'py>,
        scheme: &str,
        state: Numbers<'py>,
        span: (f64, f64),
        step: Option<f64>,
        tolerance: Option<f64>,
        max_step: Option<f64>,
        controls: Law<'py>,
        every: Option<u64>,
        samples: Option<Numbers<'py>>,
        events: Vec<Watched>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let lengths = self.lengths();
        let mut state = numbers(&state, lengths.0, "the state")?;
        let acting = controls.acting(py, lengths.1)?;
        let samples = samples.as_ref().map(slice).transpose()?;
        let mut stepper = stepping(self, scheme, step, (tolerance, max_step))?;
        let (every, described) = (every.map(|every| every.max(1)), self.of().description().events);
        let plan = Plan { span, every, samples, events: &events, described, lengths };
        let (outcome, ticks, at, hits, time, error) = py.detach(|| {
            let [ticks, samples] = [Records::default(), Records::default()].map(RefCell::new);
            let (hits, watch) = (RefCell::new(Vec::new()), Watch::new(progress));
            let parts = Made { ticks: &ticks, samples: &samples, hits: &hits, watch: &watch };
            let outcome = made(&mut *stepper, &mut state, &acting, &plan, &parts);
            let (mut ticks, time) = (ticks.into_inner(), stepper.time());
            let is_known = ticks.times.last() == Some(&time) && ticks.states.ends_with(&state);
            if plan.every.is_some() && !is_known {
                let held = ticks.controls[ticks.controls.len().saturating_sub(lengths.1)..].to_vec();
                let pushed = ticks.push(time, &state, Some(&held), lengths.1);
                watch.kept(pushed, ());
            }
            (outcome, ticks, samples.into_inner(), hits.into_inner(), time, watch.into_error())
        });
        if let Some(error) = error {
            return Err(error);
        }
        let result = PyDict::new(py);
        let report = match &outcome {
            Ok(report) => report,
            Err(error) => &error.report,
        };
        for (name, records) in [("ticks", ticks), ("samples", at)] {
            let Records { times, states, controls } = records;
            result.set_item(name, (array(py, times), array(py, states), array(py, controls)))?;
        }
        let list = PyList::empty(py);
        for (number, time, state, how) in hits {
            list.append((number, time, array(py, state), how))?;
        }
        result.set_item("events", list)?;
        result.set_item("end", (time, array(py, state.clone())))?;
        result.set_item("steps", report.steps)?;
        result.set_item("iterations", report.iterations)?;
        result.set_item("stopped", report.stopped)?;
        result.set_item("error", outcome.err().map(|error| error::run(py, &error, &state)))?;
        Ok(result)
    }

    /// The states at times within a run whose states are known at some times.
    #[pyo3(signature = (scheme, known, times, *, step=None, tolerance=None, max_step=None, input=None))]
    #[allow(clippy::too_many_arguments, reason = "Python's own words are on the other side")]
    fn dense(
        &self,
        py: Python<'_>,
        scheme: &str,
        known: (Numbers<'_>, Numbers<'_>, Numbers<'_>),
        times: Numbers<'_>,
        step: Option<f64>,
        tolerance: Option<f64>,
        max_step: Option<f64>,
        input: Option<Py<PyAny>>,
    ) -> PyResult<Py<PyArray1<f64>>> {
        let (width, inputs) = self.lengths();
        let (ticks, states, controls) = (slice(&known.0)?, slice(&known.1)?, slice(&known.2)?);
        let (count, times) = (rows(states, width, "states")?, slice(&times)?);
        check(ticks, count, "times")?;
        check(controls, count * inputs, "controls")?;
        let stepper = stepping(self, scheme, step, (tolerance, max_step))?;
        let is_forward = ticks[count - 1] >= ticks[0];
        let watch = Watch::new(None);
        let mut all = Vec::new();
        for &time in times {
            let is_before = |tick: &f64| if is_forward { *tick <= time } else { *tick >= time };
            let place = ticks.partition_point(is_before).saturating_sub(1).min(count - 1);
            let mut state = states[place * width..(place + 1) * width].to_vec();
            let mut from = ticks[place];
            let next = (place + 1).min(count - 1);
            let control = controls[next * inputs..(next + 1) * inputs].to_vec();
            let length = step.unwrap_or(f64::INFINITY);
            while from != time && !watch.has_failed() {
                let rest = time - from;
                // what is left may be a step but for the roundoff of times
                let is_last = rest.abs() <= length.abs() * (1.0 + 1e-9);
                let part = if is_last { rest } else { length };
                let mut ask = |time: f64| match &input {
                    Some(input) => asked(&watch, input, time, None, inputs),
                    None => control.clone(),
                };
                let input = if input.is_some() { Inputs::Driven(&mut ask) } else { Inputs::Held(&control) };
                stepper
                    .step_beside(&mut state, (from, part), input)
                    .map_err(|error| error::step(py, &error, from, &state))?;
                from = if is_last { time } else { from + part };
            }
            append(&mut all, &state)?;
        }
        watch.into_error().map_or_else(|| Ok(array(py, all)), Err)
    }
}
