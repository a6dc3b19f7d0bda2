//! What is carried from step to step, and where a march ends.

use std::mem::offset_of;

use coadjoint::erased::dynamic::Marching;
use coadjoint_codegen::program::{Input, StepProgram, StepRole};
use cranelift_codegen::ir::{self, Block, BlockArg, InstBuilder, types};

use super::super::emit::{Number, block_args};
use super::{March, Stage};

/// What a stage remembers, as it is carried from step to step: parameters of a block.
#[derive(Clone)]
pub(super) struct Remembered {
    /// The place of the oldest solution.
    pub(super) oldest: ir::Value,
    /// Iterations more than one a step: all, and in one at most. Of Newton's method.
    pub(super) more: Vec<ir::Value>,
    /// Where the solutions point.
    pub(super) next: Vec<Number>,
}

impl Remembered {
    fn all(&self) -> impl Iterator<Item = BlockArg> + '_ {
        let first = std::iter::once(&self.oldest).chain(&self.more).map(|value| BlockArg::from(*value));
        first.chain(block_args(&self.next))
    }
}

/// What is carried from step to step.
#[derive(Clone)]
pub(super) struct Carried {
    /// Steps taken.
    pub(super) steps: ir::Value,
    /// The address of the state, and where the next one goes.
    pub(super) at: ir::Value,
    pub(super) to: ir::Value,
    /// Zero, always: nobody knows, so that what is read where it is needed is not read once and kept for all steps.
    pub(super) nothing: ir::Value,
    /// Components of the state that the equation waits for: what goes through memory takes longer.
    pub(super) state: Vec<Number>,
    pub(super) stages: Vec<Remembered>,
}

impl Carried {
    pub(super) fn all(&self) -> Vec<BlockArg> {
        let first = [self.steps, self.at, self.to, self.nothing];
        let first = first.map(BlockArg::from).into_iter().chain(block_args(&self.state));
        first.chain(self.stages.iter().flat_map(Remembered::all)).collect()
    }
}

/// The most components of the state that are carried in registers.
const CARRIED: usize = 8;

/// The places of the components that an equation waits for; none if there are too many.
pub(super) fn awaited(step: &StepProgram) -> Vec<usize> {
    let before = [StepRole::Begin, StepRole::Start, StepRole::Evaluate, StepRole::FixedPointUpdate];
    let functions = before.iter().filter_map(|role| step.module.function(*role));
    let arguments = functions.flat_map(|function| &function.arguments);
    let states: Vec<_> =
        arguments.filter(|given| given.input == Input::State).map(|given| &given.values).collect();
    let length = states.iter().map(|values| values.len()).max().unwrap_or(0);
    let is_used = |i: usize| states.iter().any(|values| values.get(i).is_some_and(Option::is_some));
    let awaited: Vec<_> = (0..length).filter(|i| is_used(*i)).collect();
    if awaited.len() > CARRIED { Vec::new() } else { awaited }
}

/// Where a march ends: with so many steps, a stage that is left, the address of the state, and what is remembered.
pub(super) struct Exit {
    pub(super) block: Block,
    pub(super) steps: ir::Value,
    pub(super) halted: ir::Value,
    pub(super) at: ir::Value,
    pub(super) stages: Vec<Remembered>,
}

impl March<'_, '_, '_> {
    /// What a stage remembers at first.
    pub(super) fn remembered(&mut self, stage: usize) -> Remembered {
        let (next, unknowns) = (self.stages[stage].next, self.stages[stage].layout.unknown.len());
        let zero = self.e.builder.ins().iconst(types::I64, 0);
        Remembered {
            oldest: self.get(stage, types::I64, field!(oldest)),
            more: if self.stages[stage].step.is_newton { vec![zero; 2] } else { Vec::new() },
            next: (0..unknowns).map(|i| self.read(next, i)).collect(),
        }
    }

    /// Parameters of a block like these.
    fn parameters(&mut self, block: Block, like: &[Remembered]) -> Vec<Remembered> {
        let of = |remembered: &Remembered| Remembered {
            oldest: self.e.builder.append_block_param(block, types::I64),
            more: remembered
                .more
                .iter()
                .map(|_| self.e.builder.append_block_param(block, types::I64))
                .collect(),
            next: remembered.next.iter().map(|_| self.e.parameter(block)).collect(),
        };
        like.iter().map(of).collect()
    }

    pub(super) fn carried(&mut self, block: Block, like: &Carried) -> Carried {
        let pointer = self.e.pointer;
        let [steps, at, to, nothing] =
            [types::I64, pointer, pointer, pointer].map(|ty| self.e.builder.append_block_param(block, ty));
        let state = like.state.iter().map(|_| self.e.parameter(block)).collect();
        Carried { steps, at, to, nothing, state, stages: self.parameters(block, &like.stages) }
    }

    pub(super) fn exit(&mut self, like: &Carried) -> Exit {
        let (block, pointer) = (self.e.builder.create_block(), self.e.pointer);
        let [steps, halted, at] =
            [types::I64, types::I64, pointer].map(|ty| self.e.builder.append_block_param(block, ty));
        Exit { block, steps, halted, at, stages: self.parameters(block, &like.stages) }
    }

    /// What the end is told that leaves this stage to the solver.
    pub(super) fn leave(&mut self, _: &Exit, carried: &Carried, stage: usize) -> Vec<BlockArg> {
        let halted = self.e.builder.ins().iconst(types::I64, stage as i64);
        let first = [carried.steps, halted, carried.at].map(BlockArg::from).into_iter();
        first.chain(carried.stages.iter().flat_map(Remembered::all)).collect()
    }

    /// The end: all is where the solver finds it.
    pub(super) fn end(&mut self, exit: &Exit) {
        self.e.builder.switch_to_block(exit.block);
        self.put(0, field!(steps), exit.steps);
        self.put(0, field!(halted), exit.halted);
        for (stage, remembered) in exit.stages.iter().enumerate() {
            self.put(stage, field!(oldest), remembered.oldest);
            if let [more, most] = remembered.more[..] {
                self.put(stage, field!(more), more);
                self.put(stage, field!(most_more), most);
            }
            let next = self.stages[stage].next;
            self.e.store_all(next, 0, &remembered.next);
        }
        let Stage { frame, layout, .. } = self.stages[0];
        let state: Vec<_> = (0..layout.state.len()).map(|i| self.read(exit.at, i)).collect();
        self.e.store_all(frame, layout.state.start, &state);
        self.e.builder.ins().return_(&[]);
    }
}
