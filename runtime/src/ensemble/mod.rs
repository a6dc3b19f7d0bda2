//! Ensembles: one description, many states, each with parameters of its own.
//!
//! Members are stepped several at a time, side by side in the registers of the processor, and on all its cores. The result is bit-identical to
//! running each member alone with a [`Stepper`](crate::stepper::Stepper), on any processor and with any number of threads. A member that fails
//! is frozen and reported; the rest go on.
//!
//! ```
//! use coadjoint::prelude::*;
//! use coadjoint::Ensemble;
//! use std::ops::ControlFlow;
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
//! let mut series = Vec::new();
//! ensemble.run_observed(2_000, 500, |bodies| {
//!     series.push(bodies.spread(|_, state| state.momentum.y));
//!     ControlFlow::Continue(())
//! });
//! assert!(ensemble.failed().is_empty());
//! assert_eq!(series.len(), 5);
//! assert_eq!(series[0].deviation, 0.0);
//! assert!(series[4].deviation > 0.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Threads are [rayon](https://docs.rs/rayon)'s: `RAYON_NUM_THREADS` in the environment, or a pool of one's own around the call, says how many.
//! That is the feature `parallel`. Without it there is one thread: the same steps, to the last digit, on one core.

mod exact;
mod initial;
pub(crate) mod members;
mod sketch;
mod spread;
mod statistics;

use core::convert::Infallible;
use core::fmt;
use core::marker::PhantomData;
use core::ops::ControlFlow;
use std::boxed::Box;
use std::string::String;
use std::vec::Vec;

use thiserror::Error;

use crate::error::{ParameterError, StepError};
use crate::flat::{Flat, Method, NotGenerated};
pub use crate::scalar::instructions::Instructions;
use crate::scalar::{Batch, Components, Real, Scalar, mapped};
use crate::stepper::{check_state, check_step};
use crate::system::{Control, Discretized, State, System};
pub use initial::{normal, uniform};
use members::{Builder, Choose, Law, Member, Members};
pub use spread::Spread;
pub use statistics::Statistics;

/// Many states that move at the same time, with the scheme `M`.
pub struct Ensemble<S: Discretized<M>, M> {
    parameters: Vec<S::Parameters<S::Scalar>>,
    members: Members,
    scheme: PhantomData<fn() -> M>,
}

/// A member that failed. Its state is the last one that it reached.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[error("member {member} could not take step {step}")]
#[non_exhaustive]
pub struct Failed {
    /// Which member, from 0.
    pub member: usize,
    /// The step that it could not take, counted from 1.
    pub step: u64,
    /// What went wrong.
    pub source: StepError,
}

/// An error building an ensemble.
#[derive(Clone, Debug, PartialEq, Error)]
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
    /// There is no such step of the system.
    #[error(transparent)]
    NotGenerated(#[from] NotGenerated),
    /// Of systems whose types are erased, only standard steps are compiled for several states side by side.
    #[error(
        "the scheme `{scheme}` is not made of standard steps, with which alone ensembles of systems chosen at run time move; \
         take `Exponential`, `Cayley`, or a composition of one"
    )]
    NotStandard {
        /// The scheme.
        scheme: String,
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

/// Whatever a stepper refuses, as a member.
pub(crate) fn check_member(
    member: usize,
    parameters: Result<(), ParameterError>,
    step: f64,
    state: Result<(), StepError>,
) -> Result<(), EnsembleError> {
    let parameters = parameters.and_then(|()| check_step(step));
    parameters.map_err(|source| EnsembleError::Parameters { member, source })?;
    state.map_err(|source| EnsembleError::State { member, source })
}

/// The state of a member, by way of these numbers.
fn state_of<S: System>(members: &Members, member: usize, numbers: &mut Vec<f64>) -> S::State {
    members.state(member, numbers);
    S::State::from_components(&mapped(numbers, S::Scalar::of(0.0), S::Scalar::of))
}

/// The steps of the scheme `M`, for as many members as there are lanes.
struct Typed<S, M>(PhantomData<fn() -> (S, M)>);

impl<S: Discretized<M> + 'static, M: 'static> Builder for Typed<S, M> {
    type Error = Infallible;

    fn method<T: Batch>(&self, parameters: &[T], step: T) -> Result<Box<dyn Method<T>>, Infallible> {
        Ok(Flat::<S::Method<T>, true>::boxed(parameters, step))
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
        let widest = Instructions::widest();
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
        let (mut members, mut all_parameters) = (Vec::new(), Vec::new());
        let numbers = |scalars: &[S::Scalar]| scalars.iter().map(|x| x.to_f64()).collect();
        for (member, state) in states.into_iter().enumerate() {
            let system = systems.next().ok_or(EnsembleError::TooFewSystems { systems: member })?;
            let (parameters, deviation) = (system.to_parameters(), state.deviation().to_f64());
            let state: Vec<f64> = numbers(state.to_components().as_ref());
            check_member(member, system.validate(), step.to_f64(), check_state(&state, deviation))?;
            members.push(Member { parameters: numbers(parameters.as_ref()), state });
            all_parameters.push(parameters);
        }
        let builder = Typed::<S, M>(PhantomData);
        let Ok(members) = Members::new::<S::Scalar, _>(instructions, &members, step.to_f64(), &builder);
        Ok(Self { parameters: all_parameters, members, scheme: PhantomData })
    }

    /// Takes `steps` steps, and counts those of all members. See [`failed`](Self::failed) for members that could not.
    pub fn run(&mut self, steps: u64) -> u64 {
        self.members.advance_n(steps, None)
    }

    /// Takes `steps` steps with inputs, functions of the member's number and the time, and counts those of all members. Where they are asked:
    /// see [`Run::driven_by`](crate::Run::driven_by).
    pub fn run_driven(&mut self, steps: u64, input: impl Fn(usize, f64) -> S::Control + Sync) -> u64 {
        let write = |member: usize, time: f64, numbers: &mut [f64]| {
            let control = input(member, time).to_components();
            numbers.iter_mut().zip(control.as_ref()).for_each(|(number, x)| *number = x.to_f64());
        };
        let controls = <S::ControlComponents<S::Scalar> as Components<S::Scalar>>::LENGTH;
        self.members.advance_n(steps, Some(&Law { controls, choose: Choose::Driven(&write) }))
    }

    /// Takes `steps` steps and shows the ensemble to the observer at the start, after each `interval` steps, and at the end. An interval of 0
    /// counts as 1; [`ControlFlow::Break`] ends the run. Counts the steps of all members.
    pub fn run_observed(
        &mut self,
        steps: u64,
        interval: u64,
        mut observer: impl FnMut(&Self) -> ControlFlow<()>,
    ) -> u64 {
        let (mut taken, mut member_steps) = (0, 0);
        while observer(self).is_continue() && taken < steps {
            let stretch = interval.max(1).min(steps - taken);
            member_steps += self.run(stretch);
            taken += stretch;
        }
        member_steps
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
        S::Scalar::of(self.members.clock.step)
    }

    /// The time, in f64 whatever the scalar.
    pub fn time(&self) -> f64 {
        self.members.clock.after(0)
    }

    /// Sets the time: the next step starts at `time`.
    pub fn set_time(&mut self, time: f64) {
        (self.members.clock.start, self.members.clock.taken) = (time, 0);
    }

    /// The steps taken since the start, or since the time was set.
    pub fn steps_taken(&self) -> u64 {
        self.members.clock.taken
    }

    /// The system of a member; none if there are not so many.
    pub fn system(&self, member: usize) -> Option<S> {
        self.parameters.get(member).map(S::from_parameters)
    }

    /// The state of a member: of one that failed, the last that it reached; none if there are not so many.
    pub fn state(&self, member: usize) -> Option<S::State> {
        (member < self.len()).then(|| state_of::<S>(&self.members, member, &mut Vec::new()))
    }

    /// The states of all members, in order.
    pub fn states(&self) -> impl Iterator<Item = S::State> + '_ {
        (0..self.len()).map(|member| state_of::<S>(&self.members, member, &mut Vec::new()))
    }

    /// The system and the state of each member that has not failed, with its number.
    pub fn members(&self) -> impl Iterator<Item = (usize, S, S::State)> + '_ {
        let alive = (0..self.len()).filter(|&member| self.members.is_alive(member));
        alive.map(|member| {
            let system = S::from_parameters(&self.parameters[member]);
            (member, system, state_of::<S>(&self.members, member, &mut Vec::new()))
        })
    }

    /// How a quantity is distributed over the members that have not failed.
    pub fn spread(&self, mut quantity: impl FnMut(&S, &S::State) -> f64) -> Spread {
        let values = self.members().map(|(_, system, state)| quantity(&system, &state));
        Spread::of(self.time(), &mut values.filter(|value| !value.is_nan()).collect::<Vec<_>>())
    }

    /// The members that failed, in order.
    pub fn failed(&self) -> &[Failed] {
        &self.members.failed
    }

    /// How many members are stepped side by side: that depends on the processor.
    pub fn width(&self) -> usize {
        self.members.width
    }

    /// Chooses the controls of all members, to be held until they are chosen anew; before, they are zero.
    pub fn control(&mut self, mut choose: impl FnMut(usize, &S::State) -> S::Control) {
        let (mut state, mut held) = (Vec::new(), Vec::new());
        for member in 0..self.len() {
            let control = choose(member, &state_of::<S>(&self.members, member, &mut state)).to_components();
            held.clear();
            held.extend(control.as_ref().iter().map(|x| x.to_f64()));
            self.members.set_control(member, &held);
        }
    }
}

impl<S: Discretized<M>, M> fmt::Debug for Ensemble<S, M> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Ensemble")
            .field("system", &S::NAME)
            .field("scheme", &core::any::type_name::<M>())
            .field("members", &self.parameters.len())
            .field("failed", &self.members.failed.len())
            .field("step", &self.members.clock.step)
            .finish_non_exhaustive()
    }
}
