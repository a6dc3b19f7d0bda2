//! Ensembles of any system.

use core::fmt;
use std::sync::Arc;
use std::vec::Vec;

use super::system::{EnsembleSystem, System, check, length};
use crate::ensemble::members::{Choose, Law, Member, MemberInput, MemberLaw, Members};
use crate::ensemble::{EnsembleError, Failed, Instructions, check_member};
use crate::error::ParameterError;
use crate::schemes::Scheme;

/// Many states of one system that move at the same time, each with parameters of its own: [`Ensemble`](crate::Ensemble) with its types erased.
///
/// Compiled for states side by side are the standard steps on the exponential and on the Cayley map, and what is composed of them; those on the
/// exponential, which take longer to compile, for registers of four doubles at most, unless all configurations are vectors.
pub struct Ensemble {
    /// The system with each member's parameters.
    systems: Vec<Arc<dyn System>>,
    members: Members,
    controls: usize,
}

impl Ensemble {
    /// An ensemble of the system with these parameters and initial states, one of each for a member; what the parameters of `system` itself are
    /// makes no difference.
    ///
    /// # Errors
    /// If a list of parameters or a state has not as many numbers as the system's, the parameters, the step or a state are not what a stepper
    /// takes, or the scheme is not made of standard steps on the exponential or the Cayley map that were generated.
    pub fn new(
        system: &dyn EnsembleSystem,
        scheme: &Scheme,
        members: impl IntoIterator<Item = (Vec<f64>, Vec<f64>)>,
        step: f64,
    ) -> Result<Self, EnsembleError> {
        Self::with_instructions(system, scheme, members, step, Instructions::widest())
    }

    /// As [`new`](Self::new), with steps compiled for certain instructions: see
    /// [`Ensemble::with_instructions`](crate::Ensemble::with_instructions). Those of a system [from a text](crate::guide::at_run_time) stay what they are.
    ///
    /// # Errors
    /// As there.
    pub fn with_instructions(
        system: &dyn EnsembleSystem,
        scheme: &Scheme,
        members: impl IntoIterator<Item = (Vec<f64>, Vec<f64>)>,
        step: f64,
        instructions: Instructions,
    ) -> Result<Self, EnsembleError> {
        let description = system.description();
        let (expected, mut systems, mut checked) = (system.parameters().len(), Vec::new(), Vec::new());
        for (member, (parameters, state)) in members.into_iter().enumerate() {
            let got = parameters.len();
            if got != expected {
                let source = ParameterError::Length { expected, got };
                return Err(EnsembleError::Parameters { member, source });
            }
            let system = system.with_parameters(&parameters);
            check_member(member, system.validate(), step, check(&*system, &state))?;
            systems.push(system);
            checked.push(Member { parameters, state });
        }
        let members = system.members(scheme, &checked, step, instructions)?;
        Ok(Self { systems, members, controls: length(description.controls) })
    }

    /// All members that have not failed take so many steps, with the controls that they [have](Self::control). Returns the steps of all together.
    pub fn run(&mut self, steps: u64) -> u64 {
        self.members.advance_n(steps, None)
    }

    /// The same with inputs, functions of time, asked in the middle of each step or of each of its parts: see
    /// [`Run::driven_by`](crate::Run::driven_by).
    pub fn run_driven(&mut self, steps: u64, input: &MemberInput<'_>) -> u64 {
        self.members.advance_n(steps, Some(&Law { controls: self.controls, choose: Choose::Driven(input) }))
    }

    /// The same with controls that are chosen anew before each step. The last ones are held on.
    pub fn run_controlled(&mut self, steps: u64, choose: &MemberLaw<'_>) -> u64 {
        self.members.advance_n(steps, Some(&Law { controls: self.controls, choose: Choose::Held(choose) }))
    }

    /// The time.
    pub fn time(&self) -> f64 {
        self.members.clock.after(0)
    }

    /// How many members there are.
    pub fn len(&self) -> usize {
        self.systems.len()
    }

    /// Whether there is no member.
    pub fn is_empty(&self) -> bool {
        self.systems.is_empty()
    }

    /// How many members are stepped side by side: that depends on the processor.
    pub fn width(&self) -> usize {
        self.members.width
    }

    /// The members that failed, in order.
    pub fn failed(&self) -> &[Failed] {
        &self.members.failed
    }

    /// The system and the state of each member that has not failed, with its number.
    pub fn members(&self) -> impl Iterator<Item = (usize, &dyn System, Vec<f64>)> + '_ {
        let alive = self.systems.iter().enumerate().filter(|(member, _)| self.members.is_alive(*member));
        alive.map(|(member, system)| {
            let mut state = Vec::new();
            self.members.state(member, &mut state);
            (member, &**system, state)
        })
    }

    /// Chooses the controls of all members, to be held until they are chosen anew; before, they are zero. `choose` sees the number of a member
    /// and its state, and writes to numbers that are zero.
    pub fn control(&mut self, mut choose: impl FnMut(usize, &[f64], &mut [f64])) {
        let (mut state, mut control) = (Vec::new(), std::vec![0.0; self.controls]);
        for member in 0..self.systems.len() {
            self.members.state(member, &mut state);
            control.fill(0.0);
            choose(member, &state, &mut control);
            self.members.set_control(member, &control);
        }
    }
}

impl fmt::Debug for Ensemble {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Ensemble")
            .field("members", &self.systems.len())
            .field("failed", &self.members.failed.len())
            .field("step", &self.members.clock.step)
            .finish_non_exhaustive()
    }
}
