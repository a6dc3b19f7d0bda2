//! Ensembles of any system.

use core::fmt;
use std::boxed::Box;
use std::vec::Vec;

use super::scheme::NotGenerated;
use super::system::System;
use crate::ensemble::members::{Member, Members};
use crate::ensemble::{EnsembleError, Failed, Instructions};
use crate::error::StepError;
use crate::stepper::{check_deviation, check_step};

/// Many states of one system that move at the same time, each with parameters of its own, by the system's standard step on the Cayley map:
/// [`Ensemble`](crate::Ensemble) with its types erased.
pub struct Ensemble {
    systems: Vec<Box<dyn System>>,
    members: Members,
}

impl Ensemble {
    /// An ensemble of as many members as there are states, the first with the first system, and so on: the same system with other parameters.
    ///
    /// # Errors
    /// If there are fewer systems than states, a member's parameters, the step or a state are not what a stepper takes, or there is no standard
    /// step on the Cayley map.
    pub fn new(
        systems: Vec<Box<dyn System>>,
        states: Vec<Vec<f64>>,
        step: f64,
    ) -> Result<Self, EnsembleError> {
        let mut members = Vec::new();
        for (member, state) in states.into_iter().enumerate() {
            let system = systems.get(member).ok_or(EnsembleError::TooFewSystems { systems: member })?;
            system
                .validate()
                .and_then(|()| check_step(step))
                .map_err(|source| EnsembleError::Parameters { member, source })?;
            let is_finite = state.iter().all(|x| x.is_finite());
            let is_state =
                if is_finite { check_deviation(system.deviation(&state)) } else { Err(StepError::NotFinite) };
            is_state.map_err(|source| EnsembleError::State { member, source })?;
            members.push(Member { parameters: system.parameters(), state });
        }
        let widest = Instructions::available().next_back().unwrap_or(Instructions::Portable);
        let Some(first) = systems.first() else { return Err(EnsembleError::TooFewSystems { systems: 0 }) };
        let members = first
            .members(&members, step, widest)
            .ok_or_else(|| NotGenerated { scheme: "Cayley".into(), system: first.description().name })?;
        Ok(Self { systems, members })
    }

    /// All members that have not failed take so many steps. Returns the steps of all together.
    pub fn run(&mut self, steps: u64) -> u64 {
        self.members.march(steps)
    }

    /// The time.
    pub fn time(&self) -> f64 {
        self.members.time()
    }

    /// How many members are stepped side by side: that depends on the processor.
    pub fn width(&self) -> usize {
        self.members.width()
    }

    /// The members that failed, in order.
    pub fn failed(&self) -> &[Failed] {
        &self.members.failed
    }

    /// The system and the state of each member that has not failed, with its number.
    pub fn members(&self) -> impl Iterator<Item = (usize, &dyn System, Vec<f64>)> + '_ {
        let alive = self.systems.iter().enumerate().filter(|(member, _)| self.members.is_alive(*member));
        alive.map(|(member, system)| (member, &**system, self.members.state(member)))
    }

    /// Chooses the controls of all members, to be held until they are chosen anew; before, they are zero.
    pub fn control(&mut self, mut choose: impl FnMut(&dyn System, &[f64]) -> Vec<f64>) {
        for (member, system) in self.systems.iter().enumerate() {
            let control = choose(&**system, &self.members.state(member));
            self.members.set_control(member, &control);
        }
    }
}

impl fmt::Debug for Ensemble {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Ensemble")
            .field("members", &self.systems.len())
            .field("failed", &self.members.failed.len())
            .field("step", &self.members.step)
            .finish_non_exhaustive()
    }
}
