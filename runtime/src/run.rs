//! Runs: many steps, watched by [observers](crate::observe).
//!
//! A stepper takes steps and knows nothing else. Whatever is to happen along the way hangs on a [`Run`]: observers see every
//! state, and a control, or a law for it, says what acts on the system over each step.
//!
//! ```
//! use coadjoint::prelude::*;
//! use coadjoint::{Invariants, Record, Run};
//!
//! /// A rigid body that turns about a fixed point under gravity.
//! #[lie_poisson_system(group = SO3, advected(gamma: R3), potential = weight * gamma.z)]
//! pub struct Top {
//!     #[inertia]
//!     pub inertia: Vector3<f64>,
//!     pub weight: f64,
//! }
//!
//! let top = Top { inertia: vector![2.0, 2.0, 1.0], weight: 0.3 };
//! let mut state = TopState {
//!     attitude: UnitQuaternion::identity(),
//!     momentum: vector![0.1, 0.0, 1.0],
//!     gamma: Vector3::z(),
//! };
//! let mut stepper = top.stepper::<Cayley>(0.01)?;
//!
//! let mut record = Record::every(100);
//! let mut invariants = Invariants::new();
//! let report = Run::new(&mut stepper, &mut state)
//!     .observe(&mut record)
//!     .observe(&mut invariants)
//!     .until(|tick| tick.state.gamma.z < 0.0) // it has fallen over
//!     .steps(2_000)?;
//!
//! assert!(report.stopped);
//! assert_eq!(record.states().len() as u64, report.steps / 100 + 1);
//! assert!(invariants.energy_error() < 1e-4);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod within;

use core::fmt;
use core::ops::ControlFlow;

use crate::error::StepError;
use crate::event::{Described, Event, Occurrence, Samples, Watched, Within};
use crate::observe::{Each, Every, Observer, Until};
#[cfg(doc)]
use crate::stepper::Stepper;
pub use crate::stepper::report::{RunError, RunReport};
use crate::stepper::{Inputs, StepReport, Stepping};
use crate::system::Dynamics;
pub use crate::tick::Tick;

/// What acts on the system while a run is made.
#[doc(hidden)]
pub trait ControlLaw<S: Dynamics + ?Sized> {
    /// Takes a step, or several, at most `most`, and counts them. How the last one went, and the control at its end.
    ///
    /// # Errors
    /// If a step cannot be taken.
    fn advance<T: Stepping<System = S> + ?Sized>(
        &mut self,
        stepper: &mut T,
        state: &mut S::State,
        most: u64,
        report: &mut RunReport,
    ) -> Result<(StepReport, S::Control), RunError>;
    /// What acts over the last step, at whose end there was this control.
    fn input<'a>(&'a mut self, control: &'a S::Control) -> Inputs<'a, S::Control> {
        Inputs::Held(control)
    }
    /// The control at a time within it.
    fn at(&mut self, control: &S::Control, _time: f64) -> S::Control {
        control.clone()
    }
    /// Whether another control can be held, until there is another one by itself.
    const IS_HELD: bool = true;
    /// Holds it.
    fn hold(&mut self, control: &S::Control);
}

/// The same control at all times.
#[doc(hidden)]
#[derive(Clone, Copy, Debug)]
pub struct Constant<C>(C);

impl<S: Dynamics + ?Sized> ControlLaw<S> for Constant<S::Control> {
    #[inline]
    fn advance<T: Stepping<System = S> + ?Sized>(
        &mut self,
        stepper: &mut T,
        state: &mut S::State,
        most: u64,
        report: &mut RunReport,
    ) -> Result<(StepReport, S::Control), RunError> {
        held(stepper, state, self.0.clone(), most, report)
    }

    fn hold(&mut self, control: &S::Control) {
        self.0 = control.clone();
    }
}

/// A control that follows from state and time, chosen anew after some steps.
#[doc(hidden)]
#[derive(Clone, Copy, Debug)]
pub struct Feedback<F, C> {
    law: F,
    /// Steps over which a control is held.
    interval: u64,
    /// The control since the last of them that is a multiple of the interval.
    held: Option<C>,
}

impl<S, F> ControlLaw<S> for Feedback<F, S::Control>
where
    S: Dynamics + ?Sized,
    F: FnMut(&S::State, f64) -> S::Control,
{
    #[inline]
    fn advance<T: Stepping<System = S> + ?Sized>(
        &mut self,
        stepper: &mut T,
        state: &mut S::State,
        most: u64,
        report: &mut RunReport,
    ) -> Result<(StepReport, S::Control), RunError> {
        if self.interval == 1 {
            let control = (self.law)(state, stepper.time());
            return held(stepper, state, control, 1, report);
        }
        let since = stepper.steps_taken() % self.interval;
        let kept = self.held.take().filter(|_| since > 0);
        let control = kept.unwrap_or_else(|| (self.law)(state, stepper.time()));
        self.held = Some(control.clone());
        held(stepper, state, control, most.min(self.interval - since), report)
    }

    fn hold(&mut self, control: &S::Control) {
        self.held = Some(control.clone());
    }
}

/// An input that is a function of time.
#[doc(hidden)]
#[derive(Clone, Copy, Debug)]
pub struct Driven<F>(F);

impl<S: Dynamics + ?Sized, F: FnMut(f64) -> S::Control> ControlLaw<S> for Driven<F> {
    fn advance<T: Stepping<System = S> + ?Sized>(
        &mut self,
        stepper: &mut T,
        state: &mut S::State,
        _: u64,
        report: &mut RunReport,
    ) -> Result<(StepReport, S::Control), RunError> {
        let step = stepper.step_driven(state, &mut self.0);
        let step = counted(stepper, step, report)?;
        Ok((step, (self.0)(stepper.time())))
    }

    fn input<'a>(&'a mut self, _: &'a S::Control) -> Inputs<'a, S::Control> {
        Inputs::Driven(&mut self.0)
    }

    fn at(&mut self, _: &S::Control, time: f64) -> S::Control {
        (self.0)(time)
    }

    const IS_HELD: bool = false;

    fn hold(&mut self, _: &S::Control) {}
}

/// Takes steps over which a control is held; all but the last one together.
#[inline]
fn held<T: Stepping + ?Sized>(
    stepper: &mut T,
    state: &mut StateOf<T>,
    control: ControlOf<T>,
    steps: u64,
    report: &mut RunReport,
) -> Result<(StepReport, ControlOf<T>), RunError> {
    if steps > 1 {
        match stepper.steps_with(state, &control, steps - 1) {
            Ok(steps) => report.add(&steps),
            Err(error) => {
                report.add(&error.report);
                return Err(RunError { report: *report, ..error });
            }
        }
    }
    let step = stepper.step_with(state, &control);
    Ok((counted(stepper, step, report)?, control))
}

/// Counts a step.
#[inline]
fn counted<T: Stepping + ?Sized>(
    stepper: &T,
    step: Result<StepReport, StepError>,
    report: &mut RunReport,
) -> Result<StepReport, RunError> {
    match step {
        Ok(step) => {
            report.count(&step);
            Ok(step)
        }
        // time and count are as before it
        Err(cause) => Err(RunError::new(stepper.steps_taken() + 1, stepper.time(), *report, cause)),
    }
}

/// The state and the control of a stepper's system.
type StateOf<T> = <<T as Stepping>::System as Dynamics>::State;
type ControlOf<T> = <<T as Stepping>::System as Dynamics>::Control;

/// How the last step went, and the control held over it; none before the first.
type Last<S> = Option<(StepReport, <S as Dynamics>::Control)>;

/// A run within whose steps there is one thing more to be done.
#[doc(hidden)]
pub type Doing<'a, T, O, C, W, X> = Run<'a, T, O, C, (W, X)>;

/// A run to be made: a stepper, a state to start from, who watches, and who controls.
///
/// The observers see the initial state and the state after every step, in the order in which they were added.
#[must_use = "a run starts with `steps`"]
pub struct Run<'a, T: Stepping + ?Sized, O = (), C = Constant<ControlOf<T>>, W = ()> {
    stepper: &'a mut T,
    state: &'a mut StateOf<T>,
    /// None to go on at the stepper's own.
    start: Option<f64>,
    /// Times at which steps end, too, in order of time.
    breakpoints: &'a [f64],
    observer: O,
    law: C,
    /// What is done within the steps.
    within: W,
}

impl<'a, T: Stepping + ?Sized> Run<'a, T> {
    /// A run from `state` on, at the stepper's time, that nobody watches or controls yet. It goes on where the stepper is: time and index are
    /// counted on, and the ticks of several runs are those of one that was not interrupted. A new stepper is at time 0.
    pub fn new(stepper: &'a mut T, state: &'a mut StateOf<T>) -> Self {
        let law = Constant(stepper.system().no_control());
        Self { stepper, state, start: None, breakpoints: &[], observer: (), law, within: () }
    }
}

impl<'a, S: Dynamics + ?Sized, T, O, C, W> Run<'a, T, O, C, W>
where
    T: Stepping<System = S> + ?Sized,
    O: Observer<S>,
    C: ControlLaw<S>,
    W: Within<S>,
{
    /// Ends steps at these times too, which are in order: where what drives the system jumps. Of steps that are as long as a tolerance allows,
    /// for these would not see it; steps of one length stay as they are.
    pub fn with_breakpoints(mut self, times: &'a [f64]) -> Self {
        self.breakpoints = times;
        self
    }

    /// Starts at this time instead of the stepper's, with index 0.
    pub fn starting_at(mut self, time: f64) -> Self {
        self.start = Some(time);
        self
    }

    /// Holds `control` over the whole run. Without it all controls are zero; of several laws and inputs the last one counts.
    ///
    /// Steps that no observer needs are taken [together](crate::Stepper::steps_with).
    pub fn with_control(self, control: S::Control) -> Run<'a, T, O, Constant<S::Control>, W> {
        let Self { stepper, state, start, breakpoints, observer, within, .. } = self;
        Run { stepper, state, start, breakpoints, observer, law: Constant(control), within }
    }

    /// Asks `law` before each step, with the state and the time from which it starts, for the control to be held over it.
    ///
    /// A control that is held is a step function: if the law is a continuous function, the motion follows it to order 1, whatever the order
    /// of the scheme. What depends on time alone is better [driven](Self::driven_by).
    pub fn controlled_by<F>(self, law: F) -> Run<'a, T, O, Feedback<F, S::Control>, W>
    where
        F: FnMut(&S::State, f64) -> S::Control,
    {
        self.controlled_every(1, law)
    }

    /// Asks `law` before steps 0, `interval`, 2 `interval`, …, as counted by the stepper, for the control to be held until the next of them, as
    /// a digital controller does that is slower than the steps; an interval of 0 counts as 1. A run that starts between them asks at its start too.
    ///
    /// ```
    /// use coadjoint::Run;
    /// use coadjoint::prelude::*;
    ///
    /// /// A cart that is pushed.
    /// #[lie_poisson_system(group = R1, control(push: f64), force = push)]
    /// struct Cart {
    ///     #[inertia]
    ///     mass: f64,
    /// }
    ///
    /// let (mut state, mut asked) = (CartState { position: vector![1.0], momentum: vector![0.0] }, 0);
    /// let mut stepper = Cart { mass: 1.0 }.stepper::<Exponential>(0.01)?;
    /// Run::new(&mut stepper, &mut state)
    ///     .controlled_every(10, |state, _| {
    ///         asked += 1;
    ///         CartControl { push: -state.position.x - 1.5 * state.momentum.x }
    ///     })
    ///     .to(20.0)?;
    /// assert_eq!(asked, 200);
    /// assert!(state.position.norm() < 1e-5);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn controlled_every<F>(self, interval: u64, law: F) -> Run<'a, T, O, Feedback<F, S::Control>, W>
    where
        F: FnMut(&S::State, f64) -> S::Control,
    {
        let Self { stepper, state, start, breakpoints, observer, within, .. } = self;
        let law = Feedback { law, interval: interval.max(1), held: None };
        Run { stepper, state, start, breakpoints, observer, law, within }
    }

    /// Drives the run by `input`, a function of time: it is asked in the middle of each step, or of each of the steps that a composition is made of,
    /// so that the motion has the order of the scheme wherever the input is smooth enough. [Hamilton–Jacobi](crate::HamiltonJacobi) steps, too, hold
    /// the value at their middle: with an input that changes they are of order 2.
    ///
    /// [Taylor steps](crate::taylor) ask it at points of the step that they try, and follow it as closely as their tolerance says.
    ///
    /// Where it jumps or has a kink, a step of one length should end. Observers are shown the input at the time of the tick. It is asked for the same time more than
    /// once, and within a step of a composition for times that go back and forth.
    ///
    /// ```
    /// use coadjoint::Run;
    /// use coadjoint::prelude::*;
    ///
    /// /// A mass that is pushed.
    /// #[lie_poisson_system(group = R1, control(push: f64), force = push)]
    /// struct Mass {
    ///     #[inertia]
    ///     mass: f64,
    /// }
    ///
    /// let mut state = MassState { position: vector![0.0], momentum: vector![0.0] };
    /// let mut stepper = Mass { mass: 2.0 }.stepper::<Order6<Exponential>>(0.1)?;
    /// Run::new(&mut stepper, &mut state).driven_by(|time| MassControl { push: time.sin() }).to(3.0)?;
    /// // position'' = sin(t) / 2 from rest
    /// assert!((state.position.x - (3.0 - 3.0_f64.sin()) / 2.0).abs() < 1e-9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn driven_by<F: FnMut(f64) -> S::Control>(self, input: F) -> Run<'a, T, O, Driven<F>, W> {
        let Self { stepper, state, start, breakpoints, observer, within, .. } = self;
        Run { stepper, state, start, breakpoints, observer, law: Driven(input), within }
    }

    /// Shows every tick to `observer`; pass it by `&mut` to ask it for its findings afterwards.
    pub fn observe<P: Observer<S>>(self, observer: P) -> Run<'a, T, (O, P), C, W> {
        let Self { stepper, state, start, breakpoints, observer: earlier, law, within } = self;
        Run { stepper, state, start, breakpoints, observer: (earlier, observer), law, within }
    }

    /// Shows ticks 0, `interval`, 2 `interval`, … to `observer`; an interval of 0 counts as 1.
    pub fn observe_every<P: Observer<S>>(
        self,
        interval: u64,
        observer: P,
    ) -> Run<'a, T, (O, Every<P>), C, W> {
        self.observe(Every::new(interval, observer))
    }

    /// Calls `action` at every tick.
    pub fn each<F: FnMut(&Tick<'_, S>)>(self, action: F) -> Run<'a, T, (O, Each<F>), C, W> {
        self.observe(Each(action))
    }

    /// Calls `action` at the initial state and after every `interval` steps; an interval of 0 counts as 1.
    pub fn every<F: FnMut(&Tick<'_, S>)>(
        self,
        interval: u64,
        action: F,
    ) -> Run<'a, T, (O, Every<Each<F>>), C, W> {
        self.observe_every(interval, Each(action))
    }

    /// Ends the run at the first tick for which `condition` holds.
    pub fn until<F: FnMut(&Tick<'_, S>) -> bool>(self, condition: F) -> Run<'a, T, (O, Until<F>), C, W> {
        self.observe(Until(condition))
    }

    /// Calls `action` whenever `condition`, a function of state and time, is zero: at the moment itself, which is located to rounding, and with the
    /// state there. `event` says which zeros count, and whether the first of them ends the run.
    ///
    /// ```
    /// use coadjoint::prelude::*;
    /// use coadjoint::{Event, Run};
    ///
    /// /// A pendulum.
    /// #[lie_poisson_system(group = SO2, potential = -weight * angle.cos_angle())]
    /// struct Pendulum {
    ///     #[inertia]
    ///     inertia: f64,
    ///     weight: f64,
    /// }
    ///
    /// let mut state = PendulumState { angle: UnitComplex::new(1e-4), momentum: vector![0.0] };
    /// let mut stepper = Pendulum { inertia: 1.0, weight: 1.0 }.stepper::<Order4<Exponential>>(0.1)?;
    /// let report = Run::new(&mut stepper, &mut state)
    ///     .event(Event::any().terminal(), |state, _| state.angle.angle(), |_| {})
    ///     .to(10.0)?;
    /// // a quarter of a period
    /// assert_eq!((report.stopped, report.event), (true, Some(0)));
    /// assert!((stepper.time() - std::f64::consts::FRAC_PI_2).abs() < 1e-6);
    /// assert!(state.angle.angle().abs() < 1e-18);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// * What starts at zero is no event; what comes back to it is. A run that goes on from an event does not find it again.
    /// * Events of one moment are called one after the other, in the order in which they were added. All before a terminal one are called, and
    ///   none behind it.
    /// * A [callback](Occurrence) may change state, control and parameters. The rest of the step is then taken from there; steps end
    ///   where they did. What another condition jumps by then is no event.
    /// * Observers see the ends of steps, and the end of the run.
    ///
    /// Without events within them, steps take no longer. With them each is taken by itself, and its end looked at.
    pub fn event<G, F>(self, event: Event, condition: G, action: F) -> Doing<'a, T, O, C, W, Watched<G, F>>
    where
        G: FnMut(&S::State, f64) -> f64,
        F: FnMut(&mut Occurrence<'_, S>),
    {
        self.doing(Watched::new(event, condition, action))
    }

    /// Calls `action` at each event that the description has under this name, in the direction that stands there:
    /// `event(apogee = position.dot(&momentum), falling)`. An [`Occurrence`] that [stops](Occurrence::stop) ends the run.
    ///
    /// ```
    /// use coadjoint::Run;
    /// use coadjoint::prelude::*;
    ///
    /// /// A planet.
    /// #[lie_poisson_system(
    ///     group = R3,
    ///     potential = -mass * strength / position.norm(),
    ///     event(apogee = position.dot(&momentum), falling),
    ///     taylor,
    /// )]
    /// struct Planet {
    ///     #[inertia]
    ///     mass: f64,
    ///     strength: f64,
    /// }
    ///
    /// let planet = Planet { mass: 1.0, strength: 1.0 };
    /// // an ellipse of eccentricity 1/2, from where it is nearest
    /// let mut state = PlanetState { position: vector![0.5, 0.0, 0.0], momentum: vector![0.0, 3_f64.sqrt(), 0.0] };
    /// let (mut trajectory, mut apogees) = (planet.adaptive(1e-12)?, Vec::new());
    /// Run::new(&mut trajectory, &mut state).on("apogee", |event| apogees.push(event.time())).to(20.0)?;
    /// let half = std::f64::consts::PI;
    /// assert!(apogees.len() == 3 && apogees.iter().zip([1.0, 3.0, 5.0]).all(|(time, k)| (time - k * half).abs() < 1e-10));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// With [Taylor steps](crate::taylor) its power series is known within the whole step: none of its zeros is missed. With others it is looked
    /// for as a closure is. It sees the control of the step; where another one makes it jump from one sign to the other, it has its event there.
    ///
    /// The run ends before its first step, with an error, if the description has no such event.
    pub fn on<F>(self, name: &str, action: F) -> Doing<'a, T, O, C, W, Watched<Described, F>>
    where
        F: FnMut(&mut Occurrence<'_, S>),
    {
        let events = self.stepper.system().events();
        let place = events.iter().position(|(known, _)| *known == name);
        let event = place.and_then(|place| events.get(place)).map_or(Event::any(), |(_, event)| *event);
        self.doing(Watched::new(event, Described(place), action))
    }

    /// As [`event`](Self::event), for a list of events, of which there are as many as the program finds out when it runs: each with its condition
    /// and its callback.
    #[cfg(feature = "std")]
    pub fn events<G, F>(
        self,
        events: impl IntoIterator<Item = (Event, G, F)>,
    ) -> Doing<'a, T, O, C, W, std::vec::Vec<Watched<G, F>>>
    where
        G: FnMut(&S::State, f64) -> f64,
        F: FnMut(&mut Occurrence<'_, S>),
    {
        let watched = events.into_iter();
        let watched =
            watched.map(|(event, condition, action)| Watched::new(event, condition, action)).collect();
        self.doing(watched)
    }

    /// As [`on`](Self::on), for a list of events of the description: each with its place among them, which of its zeros count, and its callback.
    #[cfg(feature = "std")]
    pub fn on_each<F>(
        self,
        events: impl IntoIterator<Item = (usize, Event, F)>,
    ) -> Doing<'a, T, O, C, W, std::vec::Vec<Watched<Described, F>>>
    where
        F: FnMut(&mut Occurrence<'_, S>),
    {
        let count = self.stepper.system().events().len();
        let watched = events.into_iter().map(|(place, event, action)| {
            Watched::new(event, Described(Some(place).filter(|place| *place < count)), action)
        });
        self.doing(watched.collect())
    }

    /// Shows the states at these times to `observer`, whatever steps are taken: they are those [within](crate::Interval) the steps, which stay as they are.
    ///
    /// Times are in the order of the run. Those behind its start, or behind others, are left out, and so are those that it does not reach.
    ///
    /// ```
    /// use coadjoint::prelude::*;
    /// use coadjoint::{Record, Run};
    ///
    /// #[lie_poisson_system(group = SO3)]
    /// struct Body {
    ///     #[inertia]
    ///     inertia: Vector3<f64>,
    /// }
    ///
    /// let mut state = BodyState { attitude: UnitQuaternion::identity(), momentum: vector![0.1, 2.0, 0.1] };
    /// let mut stepper = Body { inertia: vector![1.0, 2.0, 2.5] }.stepper::<Order4<Cayley>>(0.1)?;
    /// let mut record = Record::every(1);
    /// Run::new(&mut stepper, &mut state).save_at([0.0, 0.25, 1.0 / 3.0], &mut record).to(1.0)?;
    /// assert_eq!(record.times(), [0.0, 0.25, 1.0 / 3.0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn save_at<I, P>(self, times: I, observer: P) -> Doing<'a, T, O, C, W, Samples<I::IntoIter, P>>
    where
        I: IntoIterator<Item = f64>,
        P: Observer<S>,
    {
        self.doing(Samples::new(times.into_iter(), observer))
    }

    fn doing<X>(self, more: X) -> Doing<'a, T, O, C, W, X> {
        let Self { stepper, state, start, breakpoints, observer, law, within } = self;
        Run { stepper, state, start, breakpoints, observer, law, within: (within, more) }
    }

    /// Takes `count` steps, fewer if an observer or an event ends the run.
    ///
    /// # Errors
    /// If a step cannot be taken; state and stepper's time are then the last ones that were reached.
    #[inline]
    pub fn steps(mut self, count: u64) -> Result<RunReport, RunError> {
        self.begin();
        let mut report = RunReport::default();
        self.walk(count, None, &mut report)?;
        Ok(report)
    }

    /// Takes steps until `time`, fewer if an observer ends the run. The last one is shorter where whole steps do not lead there, and the stepper
    /// has its own step again afterwards.
    ///
    /// ```
    /// use coadjoint::prelude::*;
    /// use coadjoint::Run;
    ///
    /// #[lie_poisson_system(group = SO3)]
    /// struct Body {
    ///     #[inertia]
    ///     inertia: Vector3<f64>,
    /// }
    ///
    /// let mut state = BodyState { attitude: UnitQuaternion::identity(), momentum: vector![0.1, 2.0, 0.1] };
    /// let mut stepper = Body { inertia: vector![1.0, 2.0, 2.5] }.stepper::<Cayley>(0.1)?;
    /// let report = Run::new(&mut stepper, &mut state).to(0.25)?;
    /// assert_eq!((report.steps, stepper.time(), stepper.step_size()), (3, 0.25, 0.1));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// If a step cannot be taken; state and stepper's time are then the last ones that were reached. If no number of steps leads to `time`, since it
    /// is not finite, too far or behind: nothing is done then.
    pub fn to(mut self, time: f64) -> Result<RunReport, RunError> {
        if self.stepper.is_adaptive() {
            return self.adaptively_to(time);
        }
        let (whole, rest) = self.way(time, false)?;
        let mut report = RunReport::default();
        let last = self.walk(whole, None, &mut report)?;
        let step = self.stepper.step_size();
        if rest != 0.0 && !report.stopped && self.stepper.set_step_size(rest).is_ok() {
            let taken = self.walk(1, Some(last), &mut report);
            // as it was: it was a step before
            let _ = self.stepper.set_step_size(step);
            taken?;
        }
        Ok(report)
    }

    /// Takes steps that are as long as a tolerance allows; the last one ends at the time.
    fn adaptively_to(mut self, time: f64) -> Result<RunReport, RunError> {
        let mut report = RunReport::default();
        self.begin();
        if !time.is_finite() {
            let (step, now, cause) =
                (self.stepper.steps_taken() + 1, self.stepper.time(), StepError::OutOfReach { time });
            return Err(RunError::new(step, now, report, cause));
        }
        let taken = self.broken_to(time, &mut report);
        self.stepper.set_end(f64::INFINITY);
        taken.map(|()| report)
    }

    /// Takes steps to the breakpoints on the way, one after the other, and to the time.
    fn broken_to(&mut self, time: f64, report: &mut RunReport) -> Result<(), RunError> {
        let is_forward = self.stepper.time() < time;
        let (mut last, breakpoints) = (None, self.breakpoints);
        for k in 0..=breakpoints.len() {
            // backwards from the last one
            let place = if is_forward { Some(k) } else { breakpoints.len().checked_sub(k + 1) };
            let end = place.and_then(|place| breakpoints.get(place).copied()).unwrap_or(time);
            let [from, to] =
                if is_forward { [self.stepper.time(), time] } else { [time, self.stepper.time()] };
            if end != time && !(from < end && end < to) {
                continue;
            }
            self.stepper.set_end(end);
            last = Some(self.walk(u64::MAX, last, report)?);
            if report.stopped {
                break;
            }
        }
        Ok(())
    }

    /// Takes whole steps until `time` is reached or passed, fewer if an observer ends the run; none if it is behind.
    ///
    /// # Errors
    /// As [`to`](Self::to).
    pub fn past(mut self, time: f64) -> Result<RunReport, RunError> {
        let (whole, rest) = self.way(time, true)?;
        let mut report = RunReport::default();
        self.walk(whole.saturating_add(u64::from(rest != 0.0)), None, &mut report)?;
        Ok(report)
    }

    fn begin(&mut self) {
        if let Some(time) = self.start {
            self.stepper.set_time(time);
        }
    }

    /// How many whole steps it is until a time, and what is left then; nothing if that is no more than roundoff.
    fn way(&mut self, time: f64, may_be_passed: bool) -> Result<(u64, f64), RunError> {
        // above that not every number of steps is a number
        const MOST: f64 = (1_u64 << f64::MANTISSA_DIGITS) as f64;
        let now = self.start.unwrap_or_else(|| self.stepper.time());
        let step = self.stepper.step_size();
        let steps = (time - now) / step;
        // less than half a step, be it ever so far
        let roundoff = (4.0 * f64::EPSILON * (time.abs() + now.abs() + step.abs()) / step.abs()).min(0.25);
        if !time.is_finite() || !(steps <= MOST) || (steps < -roundoff && !may_be_passed) {
            let (step, cause) = (self.stepper.steps_taken() + 1, StepError::OutOfReach { time });
            return Err(RunError::new(step, now, RunReport::default(), cause));
        }
        self.begin();
        if steps <= roundoff {
            return Ok((0, 0.0));
        }
        let nearest = (steps + 0.5) as u64;
        if (steps - nearest as f64).abs() <= roundoff {
            return Ok((nearest, 0.0));
        }
        let whole = steps as u64;
        Ok((whole, (time - now) - whole as f64 * step))
    }

    /// Takes steps. `after` the last one of a walk that this one goes on with; its tick was shown.
    #[inline]
    fn walk(
        &mut self,
        count: u64,
        after: Option<Last<S>>,
        report: &mut RunReport,
    ) -> Result<Last<S>, RunError> {
        if const { !W::IS_IDLE } {
            return self.walk_within(count, after, report);
        }
        let first = report.steps;
        let mut is_shown = after.is_some();
        let mut last = after.flatten();
        loop {
            if !is_shown && self.show(last.as_ref()).is_break() {
                report.stopped = true;
                return Ok(last);
            }
            is_shown = false;
            let taken = report.steps - first;
            if taken >= count || self.stepper.has_ended() {
                return Ok(last);
            }
            let index = self.stepper.steps_taken();
            // a step that is as long as a tolerance allows may be the last one
            let most = if self.stepper.is_adaptive() { 1 } else { count - taken };
            let mut unseen = self.observer.next(index).saturating_sub(index).clamp(1, most);
            while unseen > 0 {
                let before = report.steps;
                last = Some(self.law.advance(self.stepper, self.state, unseen, report)?);
                unseen -= report.steps - before;
            }
        }
    }

    #[inline]
    fn show(&mut self, last: Option<&(StepReport, S::Control)>) -> ControlFlow<()> {
        let stepper = &*self.stepper;
        self.observer.observe(&Tick {
            index: stepper.steps_taken(),
            time: stepper.time(),
            system: stepper.system(),
            state: self.state,
            report: last.map(|(report, _)| *report),
            control: last.map(|(_, control)| control),
            #[cfg(feature = "std")]
            snapshot: Some(&|| stepper.snapshot()),
        })
    }
}

impl<T: Stepping + ?Sized, O, C, W> fmt::Debug for Run<'_, T, O, C, W> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Run")
            .field("system", &self.stepper.system().name())
            .field("state", &self.state)
            .field("start", &self.start)
            .finish_non_exhaustive()
    }
}

#[cfg(all(test, feature = "std"))]
mod tests {
    use super::*;
    use crate::composition::Order4;
    use crate::observe::{Invariants, Record};
    use crate::retraction::{Cayley, Exponential};
    use crate::system::System;
    use crate::tests::{Body, BodyState, Oscillator, OscillatorControl, OscillatorState};
    use nalgebra::{UnitQuaternion, Vector3};
    use std::vec::Vec;

    fn body() -> Body {
        Body { inertia: Vector3::new(1.0, 2.0, 3.0) }
    }

    fn start() -> BodyState {
        BodyState { attitude: UnitQuaternion::identity(), momentum: Vector3::new(0.3, -0.5, 0.8) }
    }

    #[test]
    fn a_run_does_what_a_loop_of_steps_does() {
        let mut by_run = start();
        let mut stepper = body().stepper::<Cayley>(0.1).expect("valid");
        let report = Run::new(&mut stepper, &mut by_run).steps(50).expect("solvable");

        let mut by_loop = start();
        let mut stepper = body().stepper::<Cayley>(0.1).expect("valid");
        let mut expected = RunReport::default();
        for _ in 0..50 {
            expected.count(&stepper.step(&mut by_loop).expect("solvable"));
        }
        assert_eq!(by_run, by_loop);
        assert_eq!(report, expected);
        assert_eq!(report.steps, 50);
        assert!(!report.stopped);
        assert!(report.iterations >= 50 && report.iterations <= 50 * u64::from(report.max_iterations));
        assert!(report.max_residual < 1e-13);
        assert_eq!(report.iterations_per_step(), report.iterations as f64 / 50.0);
    }

    #[test]
    fn ticks_count_from_the_initial_state_and_time_does_not_drift() {
        let mut seen: Vec<(u64, f64, bool)> = Vec::new();
        let mut first = None;
        let mut state = start();
        let mut stepper = body().stepper::<Cayley>(0.1).expect("valid");
        Run::new(&mut stepper, &mut state)
            .starting_at(5.0)
            .each(|tick| {
                seen.push((tick.index, tick.time, tick.report.is_some()));
                first.get_or_insert(*tick.state);
            })
            .steps(1000)
            .expect("solvable");
        assert_eq!(first, Some(start()));
        assert_eq!(seen.len(), 1001);
        assert_eq!(seen[0], (0, 5.0, false));
        assert_eq!(seen[1], (1, 5.1, true));
        assert_eq!(seen[1000], (1000, 105.0, true));
    }

    #[test]
    fn a_run_goes_on_where_the_last_one_ended() {
        let (mut state, mut whole) = (start(), start());
        let mut stepper = body().stepper::<Cayley>(0.1).expect("valid");
        let mut seen = Vec::new();
        for steps in [3, 4] {
            Run::new(&mut stepper, &mut state)
                .each(|tick| seen.push(tick.index))
                .steps(steps)
                .expect("solvable");
        }
        assert_eq!(seen, [0, 1, 2, 3, 3, 4, 5, 6, 7]);
        Run::new(&mut body().stepper::<Cayley>(0.1).expect("valid"), &mut whole).steps(7).expect("solvable");
        assert_eq!((state, stepper.time()), (whole, 0.7000000000000001));
        // and begins anew
        stepper.reset();
        let mut again = start();
        Run::new(&mut stepper, &mut again).steps(7).expect("solvable");
        assert_eq!((again, stepper.time(), stepper.steps_taken()), (whole, 0.7000000000000001, 7));
    }

    #[test]
    fn a_run_ends_at_its_time() {
        for (step, time, steps) in
            [(0.1, 0.25, 3), (0.1, 0.3, 3), (-0.1, -0.25, 3), (0.1, 0.04, 1), (0.1, -1e-17, 0)]
        {
            let mut stepper = body().stepper::<Cayley>(step).expect("valid");
            let (mut state, mut ticks) = (start(), Vec::new());
            let run = Run::new(&mut stepper, &mut state).each(|tick| ticks.push((tick.index, tick.time)));
            let report = run.to(time).expect("solvable");
            assert_eq!((report.steps, stepper.steps_taken(), stepper.step_size()), (steps, steps, step));
            let end = if steps == 0 { 0.0 } else { time };
            assert!((stepper.time() - end).abs() < 1e-15, "{step} {time}: {}", stepper.time());
            assert_eq!(ticks.len() as u64, steps + 1);
            assert!(ticks.iter().enumerate().all(|(k, (index, _))| k as u64 == *index));
            // the same as a step of that size
            let mut other = start();
            let mut whole = body().stepper::<Cayley>(step).expect("valid");
            let before = (time / step + 1e-9).max(0.0) as u64;
            whole.steps_with(&mut other, &crate::system::NoControl::default(), before).expect("solvable");
            if before < steps {
                let rest = time - before as f64 * step;
                body().stepper::<Cayley>(rest).expect("valid").step(&mut other).expect("solvable");
            }
            assert_eq!(state, other);
        }
        let mut stepper = body().stepper::<Cayley>(0.1).expect("valid");
        let mut state = start();
        let report = Run::new(&mut stepper, &mut state).past(0.25).expect("solvable");
        assert_eq!((report.steps, stepper.time()), (3, 0.30000000000000004));
        // whoever ends the run ends it, be it before the short step
        let report =
            Run::new(&mut stepper, &mut state).until(|tick| tick.index == 4).to(0.55).expect("solvable");
        assert_eq!((report.steps, report.stopped), (1, true));
    }

    #[test]
    fn a_time_that_no_steps_lead_to_is_named_and_nothing_is_done() {
        let (mut state, mut ticks) = (start(), 0);
        let mut stepper = body().stepper::<Cayley>(0.1).expect("valid");
        Run::new(&mut stepper, &mut state).steps(3).expect("solvable");
        let (before, memory) = (state, stepper.snapshot());
        for time in [f64::INFINITY, f64::NEG_INFINITY, f64::NAN, 1e300] {
            let run = Run::new(&mut stepper, &mut state).starting_at(2.0).each(|_| ticks += 1);
            let to = run.to(time).expect_err("out of reach");
            let run = Run::new(&mut stepper, &mut state).starting_at(2.0);
            let past = run.past(time).expect_err("out of reach");
            for error in [to, past] {
                assert_eq!((error.step, error.time, error.report), (4, 2.0, RunReport::default()));
                let StepError::OutOfReach { time: named } = error.cause else { panic!("{error}") };
                assert_eq!(named.to_bits(), time.to_bits());
            }
        }
        assert_eq!((ticks, &state, &stepper.snapshot()), (0, &before, &memory));
        let error = Run::new(&mut stepper, &mut state).to(f64::INFINITY).expect_err("out of reach");
        assert!(std::format!("{error}").ends_with("no number of steps leads to the time inf"), "{error}");
        // a time behind is passed, and no end
        for time in [-1.0, -1e300] {
            assert_eq!(Run::new(&mut stepper, &mut state).past(time).expect("passed").steps, 0);
            let error = Run::new(&mut stepper, &mut state).to(time).expect_err("behind");
            assert_eq!((error.cause, &stepper.snapshot()), (StepError::OutOfReach { time }, &memory));
        }
    }

    #[test]
    fn no_steps_still_show_the_initial_state() {
        let mut ticks = 0;
        let mut state = start();
        let mut stepper = body().stepper::<Cayley>(0.1).expect("valid");
        let report =
            Run::new(&mut stepper, &mut state).each(|_| ticks += 1).steps(0).expect("nothing to solve");
        assert_eq!((ticks, report), (1, RunReport::default()));
        assert_eq!(report.iterations_per_step(), 0.0);
    }

    #[test]
    fn an_observer_ends_the_run() {
        let mut state = start();
        let mut stepper = body().stepper::<Cayley>(0.1).expect("valid");
        let report =
            Run::new(&mut stepper, &mut state).until(|tick| tick.time > 0.95).steps(50).expect("solvable");
        assert_eq!((report.steps, report.stopped), (10, true));

        // at the last step too
        let report =
            Run::new(&mut stepper, &mut state).until(|tick| tick.index == 17).steps(7).expect("solvable");
        assert_eq!((report.steps, report.stopped), (7, true));
    }

    #[test]
    fn a_failing_step_is_named_and_leaves_the_state() {
        let mut state = BodyState { momentum: Vector3::new(f64::INFINITY, 0.0, 0.0), ..start() };
        let before = state;
        let mut stepper = body().stepper::<Cayley>(0.25).expect("valid");
        let mut ticks = 0;
        let error = Run::new(&mut stepper, &mut state)
            .starting_at(2.0)
            .each(|_| ticks += 1)
            .steps(10)
            .expect_err("no step from an infinite momentum");
        assert_eq!(
            error,
            RunError { step: 1, time: 2.0, report: RunReport::default(), cause: StepError::NotFinite }
        );
        assert_eq!(ticks, 1);
        assert_eq!(state, before);
        let message = "step 1, from time 2, could not be taken: the state, its time, a control or what moves it is not finite, as at a pole, or \
                       the direction of a zero vector";
        assert_eq!(std::format!("{error}"), message);
    }

    const DRIVEN: Oscillator = Oscillator { mass: 1.5, stiffness: 4.0, drive: 0.7 };

    #[test]
    fn a_controller_is_asked_before_each_step() {
        let damp = |state: &OscillatorState, time: f64| {
            OscillatorControl::new(-0.8 * state.momentum.x - 0.7 * time.sin())
        };
        let begin = OscillatorState::new(1.0, 0.0);
        let mut asked = Vec::new();
        let mut shown = Vec::new();
        let mut record = Record::every(1);
        let mut state = begin;
        let mut stepper = DRIVEN.stepper::<Order4<Exponential>>(0.1).expect("valid");
        Run::new(&mut stepper, &mut state)
            .starting_at(2.0)
            .controlled_by(|state, time| {
                asked.push((time, damp(state, time)));
                damp(state, time)
            })
            .observe(&mut record)
            .each(|tick| shown.push(tick.control.cloned()))
            .steps(100)
            .expect("explicit");

        // what held over the step to a tick is what was asked for at the tick before
        assert_eq!(shown[0], None);
        let held: Vec<_> = asked.iter().map(|(_, control)| Some(*control)).collect();
        assert_eq!(shown[1..], held);
        let from: Vec<_> = record.iter().take(100).map(|(time, state)| (time, damp(state, time))).collect();
        assert_eq!(asked, from);

        // by hand
        let mut by_hand = begin;
        let mut stepper = DRIVEN.stepper::<Order4<Exponential>>(0.1).expect("valid");
        stepper.set_time(2.0);
        for _ in 0..100 {
            let control = damp(&by_hand, stepper.time());
            stepper.step_with(&mut by_hand, &control).expect("explicit");
        }
        assert_eq!(state, by_hand);
        assert_eq!(stepper.time(), 12.0);

        // it has been damped, and the drive compensated
        assert!(state.distance(&OscillatorState::REST) < 0.1, "{state:?}");
    }

    #[test]
    fn without_a_controller_controls_are_zero() {
        let mut controls = Vec::new();
        let mut state = OscillatorState::REST;
        let mut stepper = DRIVEN.stepper::<Exponential>(0.1).expect("valid");
        Run::new(&mut stepper, &mut state)
            .each(|tick| controls.push(tick.control.cloned()))
            .steps(2)
            .expect("explicit");
        let zero = Some(OscillatorControl::new(0.0));
        assert_eq!(controls, [None, zero, zero]);
    }

    #[test]
    fn the_system_sees_the_time_of_the_ticks() {
        let mut state = OscillatorState::REST;
        let mut stepper = DRIVEN.stepper::<Order4<Exponential>>(0.01).expect("valid");
        stepper.set_time(77.0);
        Run::new(&mut stepper, &mut state)
            .starting_at(0.0)
            .each(|tick| assert!(tick.state.distance(&DRIVEN.exact(tick.time)) < 1e-8))
            .steps(200)
            .expect("explicit");
        assert_eq!(stepper.time(), 2.0);
        // a run without a start goes on
        Run::new(&mut stepper, &mut state)
            .each(|tick| assert!(tick.state.distance(&DRIVEN.exact(tick.time)) < 1e-8))
            .steps(200)
            .expect("explicit");
        assert_eq!(stepper.time(), 4.0);
    }

    #[test]
    fn energy_is_measured_at_the_time_of_the_tick() {
        let mut largest = 0.0_f64;
        let mut invariants = Invariants::new();
        let begin = OscillatorState::new(1.0, 0.0);
        let initially = DRIVEN.energy_at(&begin, 2.0, &OscillatorControl::default());
        let mut state = begin;
        let mut stepper = DRIVEN.stepper::<Exponential>(0.1).expect("valid");
        Run::new(&mut stepper, &mut state)
            .starting_at(2.0)
            .observe(&mut invariants)
            .each(|tick| {
                largest = largest.max(
                    (DRIVEN.energy_at(tick.state, tick.time, &OscillatorControl::default()) - initially)
                        .abs(),
                );
            })
            .steps(50)
            .expect("explicit");
        assert_eq!(invariants.initial_energy(), Some(initially));
        assert_eq!(invariants.energy_error(), largest);
    }

    #[test]
    fn a_control_that_is_not_finite_ends_the_run_where_it_is() {
        let mut state = OscillatorState::REST;
        let mut stepper = DRIVEN.stepper::<Exponential>(0.5).expect("valid");
        let mut last = state;
        let error = Run::new(&mut stepper, &mut state)
            .starting_at(1.0)
            .controlled_by(|_, time| OscillatorControl::new(if time > 2.0 { f64::NAN } else { 1.0 }))
            .each(|tick| last = *tick.state)
            .steps(10)
            .expect_err("not a number");
        assert_eq!((error.step, error.time, error.cause), (4, 2.5, StepError::NotFinite));
        assert_eq!((state, stepper.time()), (last, 2.5));
    }
}
