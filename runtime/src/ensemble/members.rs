//! How the members of an ensemble lie in memory, side by side in blocks that fill registers, and how they move: once for all systems and
//! schemes, whose arithmetic is behind [`Method`].

use std::boxed::Box;
use std::vec::Vec;

use super::Failed;
use crate::error::StepError;
use crate::flat::Method;
use crate::method::Clock;
use crate::scalar::instructions::Instructions;
use crate::scalar::simd::lanes::{Lanes, Portable};
#[cfg(target_arch = "x86_64")]
use crate::scalar::simd::processor::{Avx2, Avx512};
use crate::scalar::{Batch, Real};

/// Parameters and initial state of a member.
#[derive(Clone, Debug)]
pub struct Member {
    pub(crate) parameters: Vec<f64>,
    pub(crate) state: Vec<f64>,
}

/// What makes the steps of numbers side by side.
pub(crate) trait Builder {
    /// Why there may be none.
    type Error;
    /// Whether steps are compiled for pairs too, which any x86-64 has registers for; processors with no wider ones are rare.
    const PAIRS: bool = true;
    /// What takes the steps for these parameters.
    fn method<T: Batch>(&self, parameters: &[T], step: T) -> Result<Box<dyn Method<T>>, Self::Error>;
}

/// All members of an ensemble.
pub struct Members {
    blocks: Vec<Box<dyn Block>>,
    /// How many there are side by side in a block.
    pub(crate) width: usize,
    /// Those that failed, in the order of their numbers.
    pub(crate) failed: Vec<Failed>,
    /// When steps are taken, and how long they are.
    pub(crate) clock: Clock,
}

impl Members {
    /// These members, numbers of the kind `X` side by side.
    pub(crate) fn new<X: Real, B: Builder>(
        instructions: Instructions,
        members: &[Member],
        step: f64,
        builder: &B,
    ) -> Result<Self, B::Error> {
        // of the method alone there is one for each system and scheme; all else is compiled here
        let mut error = None;
        macro_rules! blocks {
            ($numbers:ty) => {{
                let mut method = |parameters: &[$numbers], step| {
                    builder.method(parameters, step).map_err(|reason| error = Some(reason)).ok()
                };
                (<$numbers>::LANES, <$numbers as BlockBuilder>::blocks(members, step, &mut method))
            }};
            ($double:ty, $single:ty) => {
                if const { X::IS_DOUBLE } { blocks!($double) } else { blocks!($single) }
            };
        }
        let (width, blocks) = match instructions {
            #[cfg(target_arch = "x86_64")]
            Instructions::Avx512 if Avx512::is_here() => {
                blocks!(Lanes<f64, 8, Avx512>, Lanes<f32, 16, Avx512>)
            }
            #[cfg(target_arch = "x86_64")]
            Instructions::Avx2 if Avx2::is_here() => blocks!(Lanes<f64, 4, Avx2>, Lanes<f32, 8, Avx2>),
            #[cfg(target_arch = "x86_64")]
            _ if const { B::PAIRS } => blocks!(Lanes<f64, 2, Portable>, f32),
            #[cfg(target_arch = "x86_64")]
            _ => blocks!(f64, f32),
            #[cfg(not(target_arch = "x86_64"))]
            _ => blocks!(Lanes<f64, 4, Portable>, Lanes<f32, 8, Portable>),
        };
        match error {
            Some(error) => Err(error),
            None => {
                let clock = Clock { start: 0.0, step, taken: 0 };
                Ok(Self { blocks, width, failed: Vec::new(), clock })
            }
        }
    }

    /// These members, numbers of the kind `T` side by side.
    #[cfg(feature = "dynamic")]
    pub(crate) fn of<T: BlockBuilder, E>(
        members: &[Member],
        step: f64,
        mut make: impl FnMut(&[T], T) -> Result<Box<dyn Method<T>>, E>,
    ) -> Result<Self, E> {
        let mut error = None;
        let mut method =
            |parameters: &[T], step| make(parameters, step).map_err(|reason| error = Some(reason)).ok();
        let blocks = T::blocks(members, step, &mut method);
        match error {
            Some(error) => Err(error),
            None => {
                let clock = Clock { start: 0.0, step, taken: 0 };
                Ok(Self { blocks, width: T::LANES, failed: Vec::new(), clock })
            }
        }
    }

    /// All take so many steps, with the controls that they have, or those of a law; returns the steps of all together.
    pub(crate) fn advance_n(&mut self, steps: u64, law: Option<&Law<'_>>) -> u64 {
        let clock = self.clock;
        let advance = |block: &mut Box<dyn Block>| block.advance_n(clock, steps, law);
        #[cfg(feature = "parallel")]
        let taken: Vec<MemberSteps> = {
            use rayon::prelude::*;
            self.blocks.par_iter_mut().map(advance).collect()
        };
        #[cfg(not(feature = "parallel"))]
        let taken: Vec<MemberSteps> = self.blocks.iter_mut().map(advance).collect();
        let mut member_steps = 0;
        for mut taken in taken {
            self.failed.append(&mut taken.failed);
            member_steps += taken.member_steps;
        }
        self.failed.sort_unstable_by_key(|failed| failed.member);
        self.clock.taken = clock.taken.saturating_add(steps);
        member_steps
    }

    fn place(&self, member: usize) -> (&dyn Block, usize) {
        (&*self.blocks[member / self.width], member % self.width)
    }

    pub(crate) fn is_alive(&self, member: usize) -> bool {
        let (block, lane) = self.place(member);
        block.is_alive(lane)
    }

    /// Puts the state of a member in the place of what there is; of one that failed, the last that it reached.
    pub(crate) fn state(&self, member: usize, state: &mut Vec<f64>) {
        let (block, lane) = self.place(member);
        state.clear();
        block.state(lane, state);
    }

    pub(crate) fn set_control(&mut self, member: usize, control: &[f64]) {
        self.blocks[member / self.width].set_control(member % self.width, control);
    }
}

/// Writes the control to be held over the step of a member, by its number, from a state at a time to numbers that are zero.
pub type MemberLaw<'a> = dyn Fn(usize, &[f64], f64, &mut [f64]) + Sync + 'a;

/// Writes the control of a member, by its number, at a time to numbers that are zero.
pub type MemberInput<'a> = dyn Fn(usize, f64, &mut [f64]) + Sync + 'a;

/// Chooses the controls of the members, so many numbers.
pub(crate) struct Law<'a> {
    pub(crate) controls: usize,
    pub(crate) choose: Choose<'a>,
}

/// When controls are chosen.
pub(crate) enum Choose<'a> {
    /// Before each step.
    Held(&'a MemberLaw<'a>),
    /// Where the scheme needs them.
    Driven(&'a MemberInput<'a>),
}

/// What came of some steps.
pub(crate) struct MemberSteps {
    failed: Vec<Failed>,
    member_steps: u64,
}

/// A few members side by side; how many, and on what kind of processor, is hidden behind it.
pub(crate) trait Block: Send + Sync {
    fn advance_n(&mut self, clock: Clock, steps: u64, law: Option<&Law<'_>>) -> MemberSteps;
    fn is_alive(&self, lane: usize) -> bool;
    /// Adds the state in a lane.
    fn state(&self, lane: usize, to: &mut Vec<f64>);
    fn set_control(&mut self, lane: usize, control: &[f64]);
}

/// Makes what takes the steps of numbers side by side; none if that was not generated.
pub(crate) type Make<'a, T> = dyn FnMut(&[T], T) -> Option<Box<dyn Method<T>>> + 'a;

/// Numbers that members can be made of.
pub(crate) trait BlockBuilder: Batch {
    /// Members in blocks of as many as there are lanes.
    fn blocks(members: &[Member], step: f64, method: &mut Make<'_, Self>) -> Vec<Box<dyn Block>>;
}

macro_rules! sides {
    ($($numbers:ty),*) => {
        $(impl BlockBuilder for $numbers {
            // not generic, so that it is compiled in this crate
            #[inline(never)]
            fn blocks(members: &[Member], step: f64, method: &mut Make<'_, Self>) -> Vec<Box<dyn Block>> {
                blocks(members, step, method)
            }
        })*
    };
}
#[cfg(all(feature = "dynamic", target_arch = "x86_64"))]
sides!(Lanes<f64, 4, Portable>, Lanes<f64, 32, Avx2>);
#[cfg(all(feature = "dynamic", not(target_arch = "x86_64")))]
sides!(f64, Lanes<f64, 32, Portable>);
#[cfg(target_arch = "x86_64")]
sides!(f64, f32, Lanes<f64, 2, Portable>, Lanes<f64, 4, Avx2>, Lanes<f32, 8, Avx2>, Lanes<f64, 8, Avx512>, Lanes<f32, 16, Avx512>);
#[cfg(not(target_arch = "x86_64"))]
sides!(Lanes<f64, 4, Portable>, Lanes<f32, 8, Portable>);

fn blocks<T: Batch>(members: &[Member], step: f64, method: &mut Make<'_, T>) -> Vec<Box<dyn Block>> {
    let mut blocks: Vec<Box<dyn Block>> = Vec::new();
    for (index, members) in members.chunks(T::LANES).enumerate() {
        let side_by_side = |of: fn(&Member) -> &[f64]| -> Vec<T> {
            let mut all: Vec<T> = of(&members[0]).iter().map(|_| T::of(0.0)).collect();
            for lane in 0..T::LANES {
                Batch::put(&mut all, lane, of(members.get(lane).unwrap_or(&members[0])));
            }
            all
        };
        let parameters = side_by_side(|member| &member.parameters);
        let state = side_by_side(|member| &member.state);
        let step = T::of(step);
        let Some(method) = method(&parameters, step) else { break };
        blocks.push(Box::new(LaneBlock {
            method,
            parameters,
            step,
            next: state.clone(),
            state,
            control: Vec::new(),
            lanes: (0..T::LANES)
                .map(|lane| if lane < members.len() { Lane::Alive } else { Lane::Empty })
                .collect(),
            first: index * T::LANES,
            known: false,
        }));
    }
    blocks
}

/// A few members, each in a lane.
struct LaneBlock<T: Batch> {
    method: Box<dyn Method<T>>,
    parameters: Vec<T>,
    step: T,
    state: Vec<T>,
    /// Where the next step leads to.
    next: Vec<T>,
    /// None as long as all are zero.
    control: Vec<T>,
    lanes: Vec<Lane>,
    /// The number of the first member.
    first: usize,
    /// Whether the state is one that the method led to.
    known: bool,
}

/// What a lane is used for.
#[derive(Clone)]
enum Lane {
    /// A member.
    Alive,
    /// A member that failed, with its last state. What is in the lane is a copy of a member that did not.
    Failed(Vec<f64>),
    /// No member: there were not enough of them. A copy too.
    Empty,
}

impl<T: Batch> LaneBlock<T> {
    fn alive(&self) -> u64 {
        self.lanes.iter().filter(|lane| matches!(lane, Lane::Alive)).count() as u64
    }

    /// Members that failed stay where they are, and others take their lanes.
    #[cold]
    fn retire(&mut self, errors: &[Option<StepError>], step: u64, failed: &mut Vec<Failed>) {
        for (lane, error) in errors.iter().enumerate() {
            if let (Some(source), Lane::Alive) = (*error, &self.lanes[lane]) {
                failed.push(Failed { member: self.first + lane, step, source });
                self.lanes[lane] = Lane::Failed(taken(&self.state, lane).collect());
            }
        }
        let Some(other) = self.lanes.iter().position(|lane| matches!(lane, Lane::Alive)) else {
            return;
        };
        self.state.copy_from_slice(&self.next);
        for (lane, _) in errors.iter().enumerate().filter(|(_, error)| error.is_some()) {
            let copy = |numbers: &mut [T]| {
                numbers.iter_mut().for_each(|number| number.set_lane(lane, number.lane(other)));
            };
            copy(&mut self.state);
            copy(&mut self.parameters);
            copy(&mut self.control);
            self.method.memory(&mut |piece| copy(piece));
        }
        self.method.rebuild(&self.parameters, self.step);
    }
}

impl<T: Batch> Block for LaneBlock<T> {
    fn advance_n(&mut self, clock: Clock, steps: u64, law: Option<&Law<'_>>) -> MemberSteps {
        let mut taken = MemberSteps { failed: Vec::new(), member_steps: 0 };
        let mut members = self.alive();
        let mut done = 0;
        let (mut state, mut control) = (Vec::new(), Vec::new());
        let is_driven = matches!(law, Some(Law { choose: Choose::Driven(_), .. }));
        while done < steps && members > 0 {
            let mut most = steps - done;
            if let Some(Law { controls, choose }) = law {
                most = 1;
                let time = clock.after(done);
                for lane in 0..T::LANES {
                    if !self.is_alive(lane) {
                        continue;
                    }
                    control.clear();
                    control.resize(*controls, 0.0);
                    match choose {
                        Choose::Held(choose) => {
                            state.clear();
                            self.state(lane, &mut state);
                            choose(self.first + lane, &state, time, &mut control);
                        }
                        Choose::Driven(input) => {
                            input(self.first + lane, time + 0.5 * clock.step, &mut control);
                        }
                    }
                    self.set_control(lane, &control);
                }
                if let Choose::Driven(input) = choose {
                    let Self { method, lanes, first, .. } = self;
                    let mut part = |share: f64, controls: &mut [T]| {
                        for lane in (0..T::LANES).filter(|lane| matches!(lanes[*lane], Lane::Alive)) {
                            control.fill(0.0);
                            input(*first + lane, time + share * clock.step, &mut control);
                            Batch::put(controls, lane, &control);
                        }
                    };
                    method.set_inputs(*controls, Some(&mut part));
                }
            }
            // at no time in particular the step is not one like the last
            let known = self.known && clock.start.is_finite();
            if known && !is_driven {
                let now = Clock { taken: clock.taken + done, ..clock };
                let (batch, failure) =
                    self.method.advance_n(&mut self.state, &mut self.next, now, &self.control, most);
                done += batch.steps;
                taken.member_steps += batch.steps * members;
                if let Some(failure) = failure {
                    // what the others learnt of the step they would learn twice
                    done += 1;
                    self.retire(failure.errors.as_ref(), clock.taken + done, &mut taken.failed);
                    members = self.alive();
                    taken.member_steps += members;
                    continue;
                }
                if batch.steps == most {
                    continue;
                }
            }
            let time = T::of(clock.after(done));
            done += 1;
            match self.method.advance(&self.state, &mut self.next, time, &self.control, known) {
                Ok(_) => core::mem::swap(&mut self.state, &mut self.next),
                Err(failure) => {
                    self.retire(failure.errors.as_ref(), clock.taken + done, &mut taken.failed);
                    members = self.alive();
                }
            }
            self.known = true;
            taken.member_steps += members;
        }
        if let (Some(Law { controls, .. }), true) = (law, is_driven) {
            self.method.set_inputs(*controls, None);
        }
        taken
    }

    fn is_alive(&self, lane: usize) -> bool {
        matches!(self.lanes[lane], Lane::Alive)
    }

    fn state(&self, lane: usize, to: &mut Vec<f64>) {
        match &self.lanes[lane] {
            Lane::Failed(state) => to.extend_from_slice(state),
            Lane::Alive | Lane::Empty => to.extend(taken(&self.state, lane)),
        }
    }

    fn set_control(&mut self, lane: usize, control: &[f64]) {
        self.control.resize(control.len(), T::of(0.0));
        Batch::put(&mut self.control, lane, control);
    }
}

/// The numbers in a lane.
fn taken<T: Batch>(all: &[T], lane: usize) -> impl Iterator<Item = f64> + '_ {
    all.iter().map(move |numbers| numbers.lane(lane).to_f64())
}
