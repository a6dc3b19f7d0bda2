//! Ensembles: one description, many states, each with parameters of its own.
//!
//! Members are stepped several at a time, side by side in the registers of the processor, and on all its cores. Each moves exactly as it would
//! alone, with a [`Stepper`](crate::stepper::Stepper): to the last bit the same, whatever the processor, the number of threads, and the
//! members beside it. One that fails stays where it was; the others go on.
//!
//! ```
//! use coadjoint::prelude::*;
//!
//! #[lie_poisson_system(group = SO3)]
//! struct Body {
//!     #[inertia]
//!     inertia: Vector3<f64>,
//! }
//!
//! // the same body, thrown in a hundred slightly different ways
//! let body = Body { inertia: vector![1.0, 2.0, 2.5] };
//! let states = (0..100).map(|k| BodyState {
//!     attitude: UnitQuaternion::identity(),
//!     momentum: vector![0.01, 2.0, 1e-4 * f64::from(k)],
//! });
//! let mut ensemble = Ensemble::<_, Cayley>::new(std::iter::repeat(&body), states, 0.01)?;
//!
//! // how far its middle axis has turned over
//! let mut spread = Distribution::of(|_: &Body, state: &BodyState| state.momentum.y);
//! let report = ensemble.run_watched(2_000, 500, &mut spread);
//! assert_eq!((report.steps, report.failures), (2_000, 0));
//! assert_eq!(spread.moments().len(), 5);
//! assert_eq!(spread.moments()[0].deviation, 0.0);
//! assert!(spread.moments()[4].deviation > 0.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Threads are [rayon](https://docs.rs/rayon)'s: `RAYON_NUM_THREADS` in the environment, or a pool of one's own around the call, says how many.
//! Without the feature `parallel` there is one.

use core::fmt;
use core::marker::PhantomData;
use core::ops::ControlFlow;
use std::boxed::Box;
use std::vec::Vec;

use thiserror::Error;

use crate::error::{ParameterError, StepError};
use crate::kernel::Components;
use crate::lanes::{Lanes, Portable};
use crate::method::{Failure, Method};
#[cfg(target_arch = "x86_64")]
use crate::processor::{Avx2, Avx512};
use crate::scalar::{Batch, Real, Work};
use crate::stepper::on_group;
use crate::system::{Control, Discretized, State, System};

/// Many states that move at the same time, with the scheme `M`.
pub struct Ensemble<S: Discretized<M>, M> {
    parameters: Vec<S::Parameters<S::Scalar>>,
    blocks: Box<dyn Blocks<S>>,
    /// Those that failed, in the order of their numbers.
    failed: Vec<Failed>,
    step: S::Scalar,
    start: f64,
    taken: u64,
    scheme: PhantomData<fn() -> M>,
}

/// A member that failed. Its state is the last one that it reached.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("member {member} could not take step {step}")]
pub struct Failed {
    /// Which member, from 0.
    pub member: usize,
    /// The step that it could not take, counted from 1.
    pub step: u64,
    /// What went wrong.
    pub source: StepError,
}

/// An ensemble that cannot be.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum EnsembleError {
    /// A member's parameters, or the step, are not valid.
    #[error("member {member}")]
    Parameters {
        /// Which member, from 0.
        member: usize,
        /// What is wrong with them.
        source: ParameterError,
    },
    /// A member's state is not finite, or its configuration not on its group.
    #[error("member {member}")]
    State {
        /// Which member, from 0.
        member: usize,
        /// What is wrong with it.
        source: StepError,
    },
    /// There are more states than systems.
    #[error(
        "there are only {systems} systems for the states; `std::iter::repeat(&system)` gives all the same"
    )]
    TooFewSystems {
        /// How many systems there are.
        systems: usize,
    },
}

/// How a run of an ensemble went.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct EnsembleReport {
    /// Steps that every member took, or failed at.
    pub steps: u64,
    /// Steps of all members together.
    pub member_steps: u64,
    /// Members that failed in this run.
    pub failures: usize,
    /// Whether an observer ended the run.
    pub stopped: bool,
}

/// An ensemble at one time, for those who [watch](Watcher) it.
pub struct Moment<'a, S: System> {
    /// Steps taken in this run.
    pub index: u64,
    /// The time, in f64 whatever the scalar.
    pub time: f64,
    parameters: &'a [S::Parameters<S::Scalar>],
    blocks: &'a dyn Blocks<S>,
    failed: &'a [Failed],
}

impl<S: System> Moment<'_, S> {
    /// How many members there are, those that failed included.
    pub fn len(&self) -> usize {
        self.parameters.len()
    }

    /// Whether there is no member.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Those that have failed so far.
    pub fn failed(&self) -> &[Failed] {
        self.failed
    }

    /// The system and the state of each member that has not failed, with its number.
    pub fn members(&self) -> impl Iterator<Item = (usize, S, S::State)> + '_ {
        let alive = (0..self.len()).filter(|&member| self.blocks.is_alive(member));
        alive.map(|member| {
            let system = S::from_parameters(&self.parameters[member]);
            (member, system, S::State::from_components(&self.blocks.state(member)))
        })
    }
}

impl<S: System> fmt::Debug for Moment<'_, S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Moment").field("index", &self.index).field("time", &self.time).finish_non_exhaustive()
    }
}

/// Watches an ensemble. Closures do, and pairs show every moment to both.
pub trait Watcher<S: System> {
    /// Looks at one moment. [`ControlFlow::Break`] ends the run there.
    fn watch(&mut self, moment: &Moment<'_, S>) -> ControlFlow<()>;
}

impl<S: System, F: FnMut(&Moment<'_, S>) -> ControlFlow<()>> Watcher<S> for F {
    fn watch(&mut self, moment: &Moment<'_, S>) -> ControlFlow<()> {
        self(moment)
    }
}

impl<S: System, A: Watcher<S>, B: Watcher<S>> Watcher<S> for (A, B) {
    fn watch(&mut self, moment: &Moment<'_, S>) -> ControlFlow<()> {
        let first = self.0.watch(moment);
        let second = self.1.watch(moment);
        if first.is_break() { first } else { second }
    }
}

impl<S: Discretized<M> + 'static, M: 'static> Ensemble<S, M> {
    /// An ensemble of as many members as there are states, the first with the first system, and so on; `std::iter::repeat(&system)` gives all
    /// the same system. All take steps of the same size.
    ///
    /// # Errors
    /// If there are fewer systems than states, or a member's parameters, the step or a state are not what a stepper takes.
    pub fn new<'s>(
        systems: impl IntoIterator<Item = &'s S>,
        states: impl IntoIterator<Item = S::State>,
        step: S::Scalar,
    ) -> Result<Self, EnsembleError> {
        let widest = Instructions::available().next_back().unwrap_or(Instructions::Portable);
        Self::with_instructions(systems, states, step, widest)
    }

    /// As [`new`](Self::new), with arithmetic compiled for certain instructions; those that the processor has not are replaced by the portable
    /// ones.
    ///
    /// # Errors
    /// As there.
    pub fn with_instructions<'s>(
        systems: impl IntoIterator<Item = &'s S>,
        states: impl IntoIterator<Item = S::State>,
        step: S::Scalar,
        instructions: Instructions,
    ) -> Result<Self, EnsembleError> {
        let mut systems = systems.into_iter();
        let mut members = Vec::new();
        for (member, state) in states.into_iter().enumerate() {
            let system = systems.next().ok_or(EnsembleError::TooFewSystems { systems: member })?;
            // whatever a stepper refuses
            if let Err(source) = system.stepper::<M>(step) {
                return Err(EnsembleError::Parameters { member, source });
            }
            let components = state.to_components();
            let is_finite = components.as_ref().iter().all(|x| x.is_finite());
            let is_state = if is_finite { on_group(&state) } else { Err(StepError::NotFinite) };
            is_state.map_err(|source| EnsembleError::State { member, source })?;
            members.push((system.to_parameters(), components));
        }
        let blocks = instructions.blocks::<S, M>(&members, step);
        let parameters = members.iter().map(|(parameters, _)| *parameters).collect();
        Ok(Self { parameters, blocks, failed: Vec::new(), step, start: 0.0, taken: 0, scheme: PhantomData })
    }

    /// Takes `steps` steps. See [`failed`](Self::failed) for members that could not.
    pub fn run(&mut self, steps: u64) -> EnsembleReport {
        self.run_watched(steps, u64::MAX, &mut |_: &Moment<'_, S>| ControlFlow::Continue(()))
    }

    /// Takes `steps` steps and shows the ensemble to the watcher at the start, after each `interval` steps, and at the end. An interval of 0
    /// counts as 1.
    pub fn run_watched(
        &mut self,
        steps: u64,
        interval: u64,
        watcher: &mut impl Watcher<S>,
    ) -> EnsembleReport {
        let mut report = EnsembleReport::default();
        let before = self.failed.len();
        report.stopped = watcher.watch(&self.moment(0)).is_break();
        while report.steps < steps && !report.stopped {
            let stretch = interval.max(1).min(steps - report.steps);
            let clock = Clock { start: self.start, step: self.step.to_f64(), taken: self.taken };
            let Marched { mut failed, member_steps } = self.blocks.march(clock, stretch);
            self.failed.append(&mut failed);
            self.failed.sort_unstable_by_key(|failed| failed.member);
            self.taken += stretch;
            report.steps += stretch;
            report.member_steps += member_steps;
            report.stopped = watcher.watch(&self.moment(report.steps)).is_break();
        }
        report.failures = self.failed.len() - before;
        report
    }

    fn moment(&self, index: u64) -> Moment<'_, S> {
        Moment {
            index,
            time: self.time(),
            parameters: &self.parameters,
            blocks: &*self.blocks,
            failed: &self.failed,
        }
    }

    /// How many members there are.
    pub fn len(&self) -> usize {
        self.parameters.len()
    }

    /// Whether there is no member.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The step size.
    pub fn step_size(&self) -> S::Scalar {
        self.step
    }

    /// The time, in f64 whatever the scalar.
    pub fn time(&self) -> f64 {
        self.start + self.taken as f64 * self.step.to_f64()
    }

    /// Sets the time: the next step starts at `time`.
    pub fn set_time(&mut self, time: f64) {
        (self.start, self.taken) = (time, 0);
    }

    /// The system of a member; none if there are not so many.
    pub fn system(&self, member: usize) -> Option<S> {
        self.parameters.get(member).map(S::from_parameters)
    }

    /// The state of a member: of one that failed, the last that it reached; none if there are not so many.
    pub fn state(&self, member: usize) -> Option<S::State> {
        (member < self.len()).then(|| S::State::from_components(&self.blocks.state(member)))
    }

    /// The states of all members, in order.
    pub fn states(&self) -> impl Iterator<Item = S::State> + '_ {
        (0..self.len()).map(|member| S::State::from_components(&self.blocks.state(member)))
    }

    /// The members that failed, in order.
    pub fn failed(&self) -> &[Failed] {
        &self.failed
    }

    /// How many members are stepped side by side: that depends on the processor.
    pub fn width(&self) -> usize {
        self.blocks.width()
    }

    /// Chooses the controls of all members, to be held until they are chosen anew; before, they are zero.
    pub fn control(&mut self, mut choose: impl FnMut(usize, &S::State) -> S::Control) {
        for member in 0..self.len() {
            let state = S::State::from_components(&self.blocks.state(member));
            self.blocks.set_control(member, &choose(member, &state).to_components());
        }
    }
}

impl<S: Discretized<M>, M> fmt::Debug for Ensemble<S, M> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Ensemble")
            .field("system", &S::NAME)
            .field("scheme", &core::any::type_name::<M>())
            .field("members", &self.parameters.len())
            .field("failed", &self.failed.len())
            .field("step", &self.step)
            .finish_non_exhaustive()
    }
}

/// When a step takes place.
#[derive(Clone, Copy)]
struct Clock {
    start: f64,
    step: f64,
    taken: u64,
}

/// What came of some steps.
struct Marched {
    failed: Vec<Failed>,
    member_steps: u64,
}

/// All members, some side by side; how many, and on what kind of processor, is hidden here.
trait Blocks<S: System>: Send + Sync {
    fn march(&mut self, clock: Clock, steps: u64) -> Marched;
    fn width(&self) -> usize;
    fn is_alive(&self, member: usize) -> bool;
    fn state(&self, member: usize) -> S::StateComponents<S::Scalar>;
    fn set_control(&mut self, member: usize, control: &S::ControlComponents<S::Scalar>);
}

/// Parameters and state of a member.
type Member<S> =
    (<S as System>::Parameters<<S as System>::Scalar>, <S as System>::StateComponents<<S as System>::Scalar>);

/// What an ensemble's arithmetic is compiled for. It makes no difference to what comes out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Instructions {
    /// What the program was built for: two registers of two doubles on any x86-64.
    Portable,
    /// Four doubles in a register.
    #[cfg(target_arch = "x86_64")]
    Avx2,
    /// Eight doubles in a register.
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

impl Instructions {
    /// Those that the processor has, the widest last.
    pub fn available() -> impl DoubleEndedIterator<Item = Self> {
        [
            Some(Self::Portable),
            #[cfg(target_arch = "x86_64")]
            Avx2::is_here().then_some(Self::Avx2),
            #[cfg(target_arch = "x86_64")]
            Avx512::is_here().then_some(Self::Avx512),
        ]
        .into_iter()
        .flatten()
    }

    /// The members in blocks that fill registers.
    fn blocks<S, M>(self, members: &[Member<S>], step: S::Scalar) -> Box<dyn Blocks<S>>
    where
        S: Discretized<M> + 'static,
        M: 'static,
    {
        macro_rules! side {
            ($double:literal, $single:literal, $processor:ident) => {
                if const { size_of::<S::Scalar>() == size_of::<f64>() } {
                    Box::new(Side::<S, M, Lanes<S::Scalar, $double, $processor>>::new(members, step))
                } else {
                    Box::new(Side::<S, M, Lanes<S::Scalar, $single, $processor>>::new(members, step))
                }
            };
        }
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 if Avx512::is_here() => side!(8, 16, Avx512),
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 if Avx2::is_here() => side!(4, 8, Avx2),
            _ => side!(4, 8, Portable),
        }
    }
}

/// Blocks of members side by side.
struct Side<S: Discretized<M>, M, T: Batch>(Vec<Block<S, M, T>>);

impl<S, M, T> Side<S, M, T>
where
    S: Discretized<M>,
    T: Batch<Number = S::Scalar>,
{
    fn new(members: &[Member<S>], step: S::Scalar) -> Self {
        let blocks = members.chunks(T::LANES).enumerate();
        Self(blocks.map(|(index, members)| Block::new(index * T::LANES, members, step)).collect())
    }
}

impl<S, M, T> Blocks<S> for Side<S, M, T>
where
    S: Discretized<M>,
    T: Batch<Number = S::Scalar>,
{
    fn march(&mut self, clock: Clock, steps: u64) -> Marched {
        let march = |block: &mut Block<S, M, T>| T::outline(March { block, clock, steps });
        #[cfg(feature = "parallel")]
        let marched: Vec<Marched> = {
            use rayon::prelude::*;
            self.0.par_iter_mut().map(march).collect()
        };
        #[cfg(not(feature = "parallel"))]
        let marched: Vec<Marched> = self.0.iter_mut().map(march).collect();
        let mut all = Marched { failed: Vec::new(), member_steps: 0 };
        for mut marched in marched {
            all.failed.append(&mut marched.failed);
            all.member_steps += marched.member_steps;
        }
        all
    }

    fn width(&self) -> usize {
        T::LANES
    }

    fn is_alive(&self, member: usize) -> bool {
        let (block, lane) = (&self.0[member / T::LANES], member % T::LANES);
        matches!(block.lanes.as_ref()[lane], Lane::Alive)
    }

    fn state(&self, member: usize) -> S::StateComponents<S::Scalar> {
        let (block, lane) = (&self.0[member / T::LANES], member % T::LANES);
        match block.lanes.as_ref()[lane] {
            Lane::Failed(state) => state,
            Lane::Alive | Lane::Empty => taken::<T, _, _>(&block.state, lane),
        }
    }

    fn set_control(&mut self, member: usize, control: &S::ControlComponents<S::Scalar>) {
        let (block, lane) = (&mut self.0[member / T::LANES], member % T::LANES);
        put(&mut block.control, lane, control);
    }
}

/// A few members side by side.
struct Block<S: Discretized<M>, M, T: Batch> {
    method: S::Method<T>,
    parameters: S::Parameters<T>,
    step: T,
    state: S::StateComponents<T>,
    control: S::ControlComponents<T>,
    lanes: T::Each<Lane<S::StateComponents<S::Scalar>>>,
    /// The number of the first.
    first: usize,
    /// Whether the state is one that the method led to.
    known: bool,
}

/// What a lane is used for.
#[derive(Clone, Copy)]
enum Lane<C> {
    /// A member.
    Alive,
    /// A member that failed, with its last state. What is in the lane is a copy of a member that did not.
    Failed(C),
    /// No member: there were not enough of them. A copy too.
    Empty,
}

impl<S, M, T> Block<S, M, T>
where
    S: Discretized<M>,
    T: Batch<Number = S::Scalar>,
{
    /// At least one member, and at most as many as there are lanes.
    fn new(first: usize, members: &[Member<S>], step: S::Scalar) -> Self {
        let member = |lane: usize| &members[if lane < members.len() { lane } else { 0 }];
        let parameters = side_by_side(|lane| member(lane).0);
        let state = side_by_side(|lane| member(lane).1);
        let step = T::of(step.to_f64());
        Self {
            method: S::Method::new(&parameters, step),
            parameters,
            step,
            state,
            control: S::ControlComponents::from_fn(|_| T::of(0.0)),
            lanes: T::each(|lane| if lane < members.len() { Lane::Alive } else { Lane::Empty }),
            first,
            known: false,
        }
    }

    /// Members that failed stay where they are, and others take their lanes.
    #[cold]
    fn bury(&mut self, failure: &Failure<T, S::StateComponents<T>>, step: u64, failed: &mut Vec<Failed>) {
        let errors = failure.errors.as_ref();
        for (lane, error) in errors.iter().enumerate() {
            if let (Some(source), Lane::Alive) = (*error, self.lanes.as_ref()[lane]) {
                failed.push(Failed { member: self.first + lane, step, source });
                self.lanes.as_mut()[lane] = Lane::Failed(taken::<T, _, _>(&self.state, lane));
            }
        }
        let Some(other) = self.lanes.as_ref().iter().position(|lane| matches!(lane, Lane::Alive)) else {
            return;
        };
        self.state = failure.advanced.state;
        let mut memory = Vec::new();
        self.method.memory(&mut |piece| memory.extend_from_slice(piece));
        for (lane, _) in errors.iter().enumerate().filter(|(_, error)| error.is_some()) {
            let copy = |numbers: &mut [T]| {
                numbers.iter_mut().for_each(|number| number.set_lane(lane, number.lane(other)));
            };
            copy(&mut memory);
            copy(self.state.as_mut());
            copy(self.parameters.as_mut());
            copy(self.control.as_mut());
        }
        self.method = S::Method::new(&self.parameters, self.step);
        let mut memory = memory.into_iter();
        self.method.memory(&mut |piece| piece.iter_mut().zip(&mut memory).for_each(|(x, value)| *x = value));
    }
}

/// Steps of a block.
struct March<'a, S: Discretized<M>, M, T: Batch> {
    block: &'a mut Block<S, M, T>,
    clock: Clock,
    steps: u64,
}

impl<S, M, T> Work for March<'_, S, M, T>
where
    S: Discretized<M>,
    T: Batch<Number = S::Scalar>,
{
    type Result = Marched;

    #[inline(always)]
    fn done(self) -> Marched {
        let Self { block, clock, steps } = self;
        let alive = |lanes: &T::Each<Lane<_>>| {
            lanes.as_ref().iter().filter(|lane| matches!(lane, Lane::Alive)).count() as u64
        };
        let mut marched = Marched { failed: Vec::new(), member_steps: 0 };
        let mut members = alive(&block.lanes);
        for k in 0..steps {
            if members == 0 {
                break;
            }
            let step = clock.taken + k;
            let time = T::of(clock.start + step as f64 * clock.step);
            match block.method.advance(&block.state, time, &block.control, block.known) {
                Ok(advanced) => block.state = advanced.state,
                Err(failure) => {
                    block.bury(&failure, step + 1, &mut marched.failed);
                    members = alive(&block.lanes);
                }
            }
            block.known = true;
            marched.member_steps += members;
        }
        marched
    }
}

/// One array of several.
fn side_by_side<T, C, L>(of: impl Fn(usize) -> C) -> L
where
    T: Batch,
    C: Components<T::Number>,
    L: Components<T>,
{
    let mut all = L::from_fn(|_| T::of(0.0));
    (0..T::LANES).for_each(|lane| put(&mut all, lane, &of(lane)));
    all
}

/// Puts an array into a lane.
fn put<T, C, L>(all: &mut L, lane: usize, one: &C)
where
    T: Batch,
    C: Components<T::Number>,
    L: Components<T>,
{
    for (numbers, number) in all.as_mut().iter_mut().zip(one.as_ref()) {
        numbers.set_lane(lane, *number);
    }
}

/// The array in a lane.
fn taken<T, C, L>(all: &L, lane: usize) -> C
where
    T: Batch,
    C: Components<T::Number>,
    L: Components<T>,
{
    C::from_fn(|k| all.as_ref()[k].lane(lane))
}

/// Records how a quantity is distributed over an ensemble as time goes by.
#[derive(Clone, Debug)]
pub struct Distribution<F> {
    quantity: F,
    moments: Vec<Spread>,
    values: Vec<f64>,
}

/// How a quantity is distributed at one time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spread {
    /// The time.
    pub time: f64,
    /// How many members there are to ask: those that have not failed and whose quantity is a number.
    pub members: usize,
    /// The mean.
    pub mean: f64,
    /// The standard deviation of the members from their mean.
    pub deviation: f64,
    /// The quantiles of [`Spread::LEVELS`]: the least value, …, the median, …, the greatest.
    pub quantiles: [f64; 7],
}

impl Spread {
    /// Of which quantiles are recorded.
    pub const LEVELS: [f64; 7] = [0.0, 0.05, 0.25, 0.5, 0.75, 0.95, 1.0];

    /// Of values in any order.
    fn of(time: f64, values: &mut [f64]) -> Self {
        let members = values.len();
        if members == 0 {
            let nothing = f64::NAN;
            return Self { time, members, mean: nothing, deviation: nothing, quantiles: [nothing; 7] };
        }
        values.sort_unstable_by(f64::total_cmp);
        let mean = values.iter().sum::<f64>() / members as f64;
        let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / members as f64;
        // between two values in proportion
        let quantile = |level: f64| {
            let place = level * (members - 1) as f64;
            let (below, part) = (place as usize, place.fract());
            let above = (below + 1).min(members - 1);
            if part == 0.0 { values[below] } else { values[below] + part * (values[above] - values[below]) }
        };
        Self { time, members, mean, deviation: variance.sqrt(), quantiles: Self::LEVELS.map(quantile) }
    }
}

impl<F> Distribution<F> {
    /// The distribution of a quantity of a system in a state.
    pub fn of<S: System>(quantity: F) -> Self
    where
        F: FnMut(&S, &S::State) -> f64,
    {
        Self { quantity, moments: Vec::new(), values: Vec::new() }
    }

    /// What has been recorded, in the order of time.
    pub fn moments(&self) -> &[Spread] {
        &self.moments
    }
}

impl<S: System, F: FnMut(&S, &S::State) -> f64> Watcher<S> for Distribution<F> {
    fn watch(&mut self, moment: &Moment<'_, S>) -> ControlFlow<()> {
        self.values.clear();
        let quantity = &mut self.quantity;
        let values = moment.members().map(|(_, system, state)| quantity(&system, &state));
        self.values.extend(values.filter(|value| !value.is_nan()));
        self.moments.push(Spread::of(moment.time, &mut self.values));
        ControlFlow::Continue(())
    }
}
