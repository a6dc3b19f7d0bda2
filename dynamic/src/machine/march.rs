//! The fast path of many steps as one function: what `fast_path` in `runtime/src/solve/step.rs` does, to the last bit, with the predictor beside it.
//! Of a step that needs more it changes nothing, and leaves it to the solver.

use std::mem::offset_of;

use coadjoint::erased::dynamic::{Layout, Marching, row_length};
use coadjoint_codegen::program::{Input, RecordKind, StepProgram, StepRole, solver};
use cranelift_codegen::ir::condcodes::{FloatCC, IntCC};
use cranelift_codegen::ir::{self, Block, BlockArg, InstBuilder, types};
use cranelift_module::FuncId;

use super::Compiler;
use super::emit::{Arrays, Emitter};

/// Whether there is a fast path.
pub(super) fn has_path(step: &StepProgram, layout: &Layout) -> bool {
    layout.unknown.is_empty() || step.module.function(StepRole::FixedPointUpdate).is_some()
}

/// The function of these stages, each of which has a fast path.
pub(super) fn defined(compiler: &mut Compiler, stages: &[(&StepProgram, &Layout)]) -> Option<FuncId> {
    compiler.define(0, |emitter| March { e: emitter, stages: Vec::new() }.all(stages))
}

/// The function of a step by Newton's method, from where the solutions before point: `Newton` in `runtime/src/solve/newton.rs`, as long as nothing
/// stalls.
pub(super) fn newton_defined(compiler: &mut Compiler, step: &StepProgram, layout: &Layout) -> Option<FuncId> {
    compiler.define(0, |emitter| March { e: emitter, stages: Vec::new() }.by_newton(step, layout))
}

/// How many solutions are remembered: a power of two.
const WINDOW: usize = 16;

/// Of which solutions before the next there are differences `x_j − x_{16 − j}`.
const PAIRS: [usize; 5] = [1, 2, 3, 5, 7];

/// The solver's numbers of this name.
fn numbers<const N: usize>(name: &str) -> [f64; N] {
    let mut numbers = [f64::NAN; N];
    numbers.iter_mut().zip(solver::values(name)).for_each(|(to, value)| *to = *value);
    numbers
}

/// A field of [`Marching`].
macro_rules! field {
    ($name:ident) => {
        offset_of!(Marching, $name) as i32
    };
}

/// What is written.
struct March<'a, 'e, 'f> {
    e: &'a mut Emitter<'e, 'f>,
    stages: Vec<Stage<'a>>,
}

/// A stage.
struct Stage<'a> {
    step: &'a StepProgram,
    layout: &'a Layout,
    /// The address of what there is to go on from.
    marching: ir::Value,
    /// Those of the frame, for what is written to it and for what is only read, and of the remembered solutions.
    frame: ir::Value,
    constant: ir::Value,
    ring: ir::Value,
    /// Where it puts where the solutions point.
    next: ir::Value,
    tolerance: ir::Value,
    /// What functions are given.
    given: Given,
}

#[derive(Default)]
struct Given {
    state: State,
    time: Vec<ir::Value>,
    unknown: Vec<ir::Value>,
    residual: Vec<ir::Value>,
    right: Vec<ir::Value>,
    step: Vec<ir::Value>,
    iterate: Vec<ir::Value>,
}

/// A state: numbers, or from this address on.
#[derive(Clone)]
enum State {
    Numbers(Vec<ir::Value>),
    /// But for some, which are there.
    At(ir::Value, Vec<(usize, ir::Value)>),
}

impl Default for State {
    fn default() -> Self {
        Self::Numbers(Vec::new())
    }
}

/// What a stage remembers, as it is carried from step to step: parameters of a block.
#[derive(Clone)]
struct Remembered {
    /// The place of the oldest solution.
    oldest: ir::Value,
    /// Iterations more than one a step: all, and in one at most. Of Newton's method.
    more: Vec<ir::Value>,
    /// Where the solutions point.
    next: Vec<ir::Value>,
}

impl Remembered {
    fn all(&self) -> impl Iterator<Item = ir::Value> + '_ {
        std::iter::once(self.oldest).chain(self.more.iter().chain(&self.next).copied())
    }
}

/// What is carried from step to step.
#[derive(Clone)]
struct Carried {
    /// Steps taken.
    steps: ir::Value,
    /// The address of the state, and where the next one goes.
    at: ir::Value,
    to: ir::Value,
    /// Zero, always: nobody knows, so that what is read where it is needed is not read once and kept for all steps.
    nothing: ir::Value,
    /// Components of the state that the equation waits for: what goes through memory takes longer.
    state: Vec<ir::Value>,
    stages: Vec<Remembered>,
}

impl Carried {
    fn all(&self) -> Vec<BlockArg> {
        let first = [self.steps, self.at, self.to, self.nothing];
        let first = first.iter().chain(&self.state).copied();
        first.chain(self.stages.iter().flat_map(Remembered::all)).map(BlockArg::from).collect()
    }
}

/// The most components of the state that are carried in registers.
const CARRIED: usize = 8;

/// The places of the components that an equation waits for; none if there are too many.
fn awaited(step: &StepProgram) -> Vec<usize> {
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
struct Exit {
    block: Block,
    steps: ir::Value,
    halted: ir::Value,
    at: ir::Value,
    stages: Vec<Remembered>,
}

impl<'a> March<'a, '_, '_> {
    fn get(&mut self, stage: usize, ty: ir::Type, offset: i32) -> ir::Value {
        let marching = self.stages[stage].marching;
        self.e.builder.ins().load(ty, Emitter::memory(), marching, offset)
    }

    fn put(&mut self, stage: usize, offset: i32, value: ir::Value) {
        let marching = self.stages[stage].marching;
        self.e.builder.ins().store(Emitter::memory(), value, marching, offset);
    }

    /// Reads what there is for each stage.
    fn begin(&mut self, stages: &[(&'a StepProgram, &'a Layout)]) {
        let pointer = self.e.pointer;
        let first = self.e.frame;
        for (place, (step, layout)) in stages.iter().enumerate() {
            let offset = (place * size_of::<Marching>()) as i64;
            let marching = self.e.builder.ins().iadd_imm_s(first, offset);
            let (frame, given) = (first, Given::default());
            let [constant, ring, next, tolerance] = [frame; 4];
            self.stages.push(Stage { step, layout, marching, frame, constant, ring, next, tolerance, given });
            let [frame, ring, next] =
                [field!(frame), field!(ring), field!(next)].map(|at| self.get(place, pointer, at));
            let tolerance = self.get(place, types::F64, field!(tolerance));
            let stage = &mut self.stages[place];
            (stage.frame, stage.ring, stage.next, stage.tolerance) = (frame, ring, next, tolerance);
        }
    }

    /// Many steps on the fast path.
    fn all(mut self, stages: &[(&'a StepProgram, &'a Layout)]) {
        self.begin(stages);
        let pointer = self.e.pointer;
        let [start, length] = [field!(start), field!(step)].map(|at| self.get(0, types::F64, at));
        let [taken, most] = [field!(taken), field!(most)].map(|at| self.get(0, types::I64, at));
        let nothing = self.get(0, pointer, field!(has_first));
        let zero = self.e.builder.ins().iconst(types::I64, 0);
        let layout = self.stages[0].layout;
        let [at, to] =
            [layout.state.start, layout.next.start].map(|place| self.address(self.stages[0].frame, place));
        let awaited = awaited(stages[0].0);
        let carried = Carried {
            steps: zero,
            at,
            to,
            nothing,
            state: awaited.iter().map(|i| self.read(types::F64, at, *i)).collect(),
            stages: (0..stages.len()).map(|stage| self.remembered(stage)).collect(),
        };
        let [head, body] = std::array::from_fn(|_| self.e.builder.create_block());
        let exit = self.exit(&carried);
        // controls that are not finite are left to the solver, which says so
        let frame = self.stages[0].frame;
        let controls: Vec<_> = layout.control.clone().map(|place| self.e.load(frame, place)).collect();
        match self.are_finite(&controls) {
            None => _ = self.e.builder.ins().jump(head, &carried.all()),
            Some(good) => {
                let halt = self.leave(&exit, &carried, 0);
                self.e.builder.ins().brif(good, head, &carried.all(), exit.block, &halt);
            }
        }

        let mut carried = self.carried(head, &carried);
        self.e.builder.switch_to_block(head);
        let is_more = self.e.builder.ins().icmp(IntCC::UnsignedLessThan, carried.steps, most);
        let done = self.leave(&exit, &carried, 0);
        self.e.builder.ins().brif(is_more, body, &[], exit.block, &done);

        self.e.builder.switch_to_block(body);
        let now = self.e.builder.ins().iadd(taken, carried.steps);
        let now = self.e.builder.ins().fcvt_from_uint(types::F64, now);
        let since = self.e.builder.ins().fmul(now, length);
        let mut time = self.e.builder.ins().fadd(start, since);
        let there = awaited.iter().copied().zip(carried.state.iter().copied());
        let mut state = State::At(carried.at, there.collect());
        for stage in 0..stages.len() {
            if stage > 0 {
                // two halves of a step
                let half = self.e.number(0.5);
                let half = self.e.builder.ins().fmul(half, length);
                time = self.e.builder.ins().fadd(time, half);
            }
            let constant = self.e.builder.ins().iadd(self.stages[stage].frame, carried.nothing);
            self.stages[stage].constant = constant;
            self.stages[stage].given = Given { state: state.clone(), time: vec![time], ..Given::default() };
            self.e.forget(self.stages[stage].step.module.values.places());
            let next = self.stage(stage, &mut carried, &exit);
            state = State::Numbers(next);
        }
        if let State::Numbers(next) = state {
            self.e.store_all(carried.to, 0, &next);
            carried.state = awaited.iter().map(|i| next[*i]).collect();
        }
        let first_nothing = self.e.builder.ins().iadd(carried.nothing, nothing);
        let steps = self.e.builder.ins().iadd_imm_s(carried.steps, 1);
        let again = Carried { steps, at: carried.to, to: carried.at, nothing: first_nothing, ..carried };
        self.e.builder.ins().jump(head, &again.all());
        self.end(&exit);
    }

    /// One step by Newton's method.
    fn by_newton(mut self, step: &'a StepProgram, layout: &'a Layout) {
        self.begin(&[(step, layout)]);
        let Stage { frame, next, .. } = self.stages[0];
        let time = self.get(0, types::F64, field!(start));
        let at = self.address(frame, layout.state.start);
        self.stages[0].constant = frame;
        self.stages[0].given =
            Given { state: State::At(at, Vec::new()), time: vec![time], ..Given::default() };
        self.e.forget(step.module.values.places());
        let leave = self.e.builder.create_block();
        self.e.lost = Some(leave);
        let guess: Vec<_> = (0..layout.unknown.len()).map(|i| self.read(types::F64, next, i)).collect();
        self.function(0, StepRole::Begin);

        let [again, solved, not_yet, on] = std::array::from_fn(|_| self.e.builder.create_block());
        let round = self.e.builder.append_block_param(again, types::I64);
        let [last, moved] = [0; 2].map(|_| self.e.builder.append_block_param(again, types::F64));
        let point: Vec<_> =
            guess.iter().map(|_| self.e.builder.append_block_param(again, types::F64)).collect();
        let zero = self.e.builder.ins().iconst(types::I64, 0);
        let [far, one] = [numbers::<1>("FAR")[0], 1.0].map(|x| self.e.number(x));
        let first: Vec<BlockArg> = [zero, far, one].iter().chain(&guess).map(|x| (*x).into()).collect();
        self.e.builder.ins().jump(again, &first);

        self.e.builder.switch_to_block(again);
        self.stages[0].given.unknown = point.clone();
        self.evaluate(0);
        let (residual, right) = (self.stages[0].given.residual.clone(), self.stages[0].given.right.clone());
        let now = self.relative(0, &residual, &right);
        let is_rounding = self.is_rounding(now, moved, step.has_true_jacobian);
        self.e.builder.ins().brif(is_rounding, solved, &[], not_yet, &[]);

        self.e.builder.switch_to_block(not_yet);
        let progress = self.e.number(numbers::<1>("PROGRESS")[0]);
        let enough = self.e.builder.ins().fmul(progress, last);
        let leads = self.e.builder.ins().fcmp(FloatCC::LessThanOrEqual, now, enough);
        let most = numbers::<1>("REGULAR")[0] as i64;
        let is_open = self.e.builder.ins().icmp_imm_s(IntCC::SignedLessThan, round, most);
        let goes_on = self.e.builder.ins().band(leads, is_open);
        self.e.builder.ins().brif(goes_on, on, &[], leave, &[]);
        self.e.builder.switch_to_block(on);
        let known = self.e.known();
        let correction = self.function(0, StepRole::Correction).concat();
        self.e.know_again(known);
        let moves = self.relative(0, &correction, &point);
        let to = self.each(&point, &correction, |e, point, by| e.builder.ins().fsub(point, by));
        let round_after = self.e.builder.ins().iadd_imm_s(round, 1);
        let next: Vec<BlockArg> = [round_after, now, moves].iter().chain(&to).map(|x| (*x).into()).collect();
        self.e.builder.ins().jump(again, &next);

        // where the equation has several solutions, it is the one that the method leads to from the start
        self.e.builder.switch_to_block(solved);
        let start = self.function(0, StepRole::Start).concat();
        let away = self.change(0, &start, &point);
        let near = self.e.number(numbers::<1>("NEAR")[0]);
        let is_near = self.e.builder.ins().fcmp(FloatCC::LessThanOrEqual, away, near);
        let [from_start, found] = std::array::from_fn(|_| self.e.builder.create_block());
        self.e.builder.ins().brif(is_near, found, &[], from_start, &[]);
        self.e.builder.switch_to_block(from_start);
        let (known, iterate) = (self.e.known(), self.stages[0].given.iterate.clone());
        self.stages[0].given.unknown = start.clone();
        self.evaluate(0);
        let correction = self.function(0, StepRole::Correction).concat();
        self.e.know_again(known);
        let given = &mut self.stages[0].given;
        (given.unknown, given.residual, given.right, given.iterate) =
            (point.clone(), residual, right, iterate);
        let to = self.each(&start, &correction, |e, start, by| e.builder.ins().fsub(start, by));
        let left = self.change(0, &to, &point);
        let towards = self.e.number(numbers::<1>("TOWARDS")[0]);
        let bound = self.e.builder.ins().fmul(towards, away);
        let is_found = self.e.builder.ins().fcmp(FloatCC::LessThanOrEqual, left, bound);
        self.e.builder.ins().brif(is_found, found, &[], leave, &[]);

        self.e.builder.switch_to_block(found);
        let (next, good) = self.finish(0);
        let controls: Vec<_> = layout.control.clone().map(|place| self.e.load(frame, place)).collect();
        let good = good.into_iter().chain(self.are_finite(&controls));
        let good = good.collect::<Vec<_>>().into_iter().reduce(|a, b| self.e.builder.ins().band(a, b));
        if let Some(good) = good {
            let on = self.e.builder.create_block();
            self.e.builder.ins().brif(good, on, &[], leave, &[]);
            self.e.builder.switch_to_block(on);
        }
        self.e.store_all(frame, layout.next.start, &next);
        self.e.store_all(frame, layout.out.start, &point);
        let taken = self.e.builder.ins().iconst(types::I64, 1);
        for (offset, value) in [(field!(steps), taken), (field!(more), round), (field!(tolerance), now)] {
            self.put(0, offset, value);
        }
        self.e.builder.ins().jump(leave, &[]);
        self.e.builder.switch_to_block(leave);
        self.e.builder.ins().return_(&[]);
    }

    /// Whether a residual is rounding, after a correction that moved the unknown by so much.
    fn is_rounding(&mut self, residual: ir::Value, moved: ir::Value, is_true: bool) -> ir::Value {
        let [exact, _, near, little, far, much] = numbers("RESIDUAL");
        let square = self.e.builder.ins().fmul(moved, moved);
        let mut any = self.is_at_most(residual, exact * f64::EPSILON);
        let farther = [(near, little), (far, much)].into_iter().take(if is_true { 2 } else { 1 });
        for (units, factor) in farther {
            let is_small = self.is_at_most(residual, units * f64::EPSILON);
            let factor = self.e.number(factor);
            let left = self.e.builder.ins().fmul(factor, square);
            let is_nothing = self.is_at_most(left, f64::EPSILON);
            let both = self.e.builder.ins().band(is_small, is_nothing);
            any = self.e.builder.ins().bor(any, both);
        }
        any
    }

    fn is_at_most(&mut self, x: ir::Value, bound: f64) -> ir::Value {
        let bound = self.e.number(bound);
        self.e.builder.ins().fcmp(FloatCC::LessThanOrEqual, x, bound)
    }

    /// The address of a place in a frame.
    fn address(&mut self, frame: ir::Value, place: usize) -> ir::Value {
        self.e.builder.ins().iadd_imm_s(frame, (place * size_of::<f64>()) as i64)
    }

    /// What a stage remembers at first.
    fn remembered(&mut self, stage: usize) -> Remembered {
        let (next, unknowns) = (self.stages[stage].next, self.stages[stage].layout.unknown.len());
        let zero = self.e.builder.ins().iconst(types::I64, 0);
        Remembered {
            oldest: self.get(stage, types::I64, field!(oldest)),
            more: if self.stages[stage].step.is_newton { vec![zero; 2] } else { Vec::new() },
            next: (0..unknowns).map(|i| self.read(types::F64, next, i)).collect(),
        }
    }

    /// Parameters of a block like these.
    fn parameters(&mut self, block: Block, like: &[Remembered]) -> Vec<Remembered> {
        let builder = &mut self.e.builder;
        let mut like_this = |value: &ir::Value| {
            let ty = builder.func.dfg.value_type(*value);
            builder.append_block_param(block, ty)
        };
        let of = |remembered: &Remembered| Remembered {
            oldest: like_this(&remembered.oldest),
            more: remembered.more.iter().map(&mut like_this).collect(),
            next: remembered.next.iter().map(&mut like_this).collect(),
        };
        like.iter().map(of).collect()
    }

    fn carried(&mut self, block: Block, like: &Carried) -> Carried {
        let pointer = self.e.pointer;
        let [steps, at, to, nothing] =
            [types::I64, pointer, pointer, pointer].map(|ty| self.e.builder.append_block_param(block, ty));
        let state = like.state.iter().map(|_| self.e.builder.append_block_param(block, types::F64)).collect();
        Carried { steps, at, to, nothing, state, stages: self.parameters(block, &like.stages) }
    }

    fn exit(&mut self, like: &Carried) -> Exit {
        let (block, pointer) = (self.e.builder.create_block(), self.e.pointer);
        let [steps, halted, at] =
            [types::I64, types::I64, pointer].map(|ty| self.e.builder.append_block_param(block, ty));
        Exit { block, steps, halted, at, stages: self.parameters(block, &like.stages) }
    }

    /// What the end is told that leaves this stage to the solver.
    fn leave(&mut self, _: &Exit, carried: &Carried, stage: usize) -> Vec<BlockArg> {
        let halted = self.e.builder.ins().iconst(types::I64, stage as i64);
        let first = [carried.steps, halted, carried.at].into_iter();
        first.chain(carried.stages.iter().flat_map(Remembered::all)).map(BlockArg::from).collect()
    }

    /// The end: all is where the solver finds it.
    fn end(&mut self, exit: &Exit) {
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
            remembered.next.iter().enumerate().for_each(|(i, value)| self.write(next, i, *value));
        }
        let Stage { frame, layout, .. } = self.stages[0];
        let state: Vec<_> = (0..layout.state.len()).map(|i| self.read(types::F64, exit.at, i)).collect();
        self.e.store_all(frame, layout.state.start, &state);
        self.e.builder.ins().return_(&[]);
    }

    /// A branch that leaves a stage to the solver where the condition does not hold, after what `before` does.
    fn check(
        &mut self,
        good: ir::Value,
        stage: usize,
        carried: &Carried,
        exit: &Exit,
        before: impl FnOnce(&mut Self),
    ) {
        let [on, halt] = std::array::from_fn(|_| self.e.builder.create_block());
        self.e.builder.ins().brif(good, on, &[], halt, &[]);
        self.e.builder.switch_to_block(halt);
        self.halt(stage, carried, exit, before);
        self.e.builder.switch_to_block(on);
    }

    fn halt(&mut self, stage: usize, carried: &Carried, exit: &Exit, before: impl FnOnce(&mut Self)) {
        if let Some(block) = self.e.builder.current_block() {
            self.e.builder.set_cold_block(block);
        }
        before(self);
        if let State::Numbers(state) = self.stages[stage].given.state.clone() {
            let Stage { frame, layout, .. } = self.stages[stage];
            self.e.store_all(frame, layout.state.start, &state);
        }
        let left = self.leave(exit, carried, stage);
        self.e.builder.ins().jump(exit.block, &left);
    }

    /// Lets a stage be left to the solver from anywhere.
    fn may_get_lost(&mut self, stage: usize, carried: &Carried, exit: &Exit) {
        let here = self.e.builder.current_block();
        let lost = self.e.builder.create_block();
        self.e.builder.switch_to_block(lost);
        self.halt(stage, carried, exit, |_| {});
        if let Some(here) = here {
            self.e.builder.switch_to_block(here);
        }
        self.e.lost = Some(lost);
    }

    /// The stage from its state: the next one. What it remembers is carried on.
    fn stage(&mut self, stage: usize, carried: &mut Carried, exit: &Exit) -> Vec<ir::Value> {
        let Stage { step, layout, .. } = self.stages[stage];
        let (is_newton, unknowns) = (step.is_newton, layout.unknown.len());
        self.may_get_lost(stage, carried, exit);
        self.function(stage, StepRole::Begin);
        let before = carried.stages[stage].clone();
        let mut point = before.next.clone();
        let mut start = Vec::new();
        if is_newton {
            start = self.function(stage, StepRole::Start).concat();
            point = self.each(&start, &point, |e, start, apart| e.builder.ins().fadd(start, apart));
        }
        let mut more = None;
        self.stages[stage].given.unknown = point;
        if unknowns == 0 {
            self.function(stage, StepRole::Evaluate);
        } else if is_newton {
            more = Some(self.newton(stage, carried, exit));
        } else {
            self.fixed_point(stage, carried, exit);
        }
        // where an iteration leads to
        let unknown = self.stages[stage].given.unknown.clone();
        let mut kept = unknown.clone();
        if is_newton {
            kept = self.each(&unknown, &start, |e, unknown, start| e.builder.ins().fsub(unknown, start));
        }
        let (next, good) = self.finish(stage);
        if let Some(good) = good {
            self.check(good, stage, carried, exit, |_| {});
        }
        // it is taken; what the next step begins with waits for less than what it goes on with
        let then = self.then(stage, before.oldest, &kept);
        let remembered = &mut carried.stages[stage];
        remembered.next = then;
        if unknowns > 0 {
            self.keep(stage, before.oldest, &kept);
            remembered.oldest = self.e.builder.ins().iadd_imm_s(before.oldest, 1);
        }
        if let (Some(more), [all, most]) = (more, &before.more[..]) {
            let pointer = self.e.pointer;
            let solution = self.get(stage, pointer, field!(solution));
            unknown.iter().enumerate().for_each(|(i, value)| self.write(solution, i, *value));
            carried.stages[stage].more =
                vec![self.e.builder.ins().iadd(*all, more), self.e.builder.ins().umax(*most, more)];
        }
        next
    }

    /// The state after a step, and whether all is well with it, if anything may not be.
    fn finish(&mut self, stage: usize) -> (Vec<ir::Value>, Option<ir::Value>) {
        let step = self.stages[stage].step;
        let next = self.function(stage, StepRole::Finish).concat();
        let bounded = step.bounded.iter().chain(std::iter::repeat(&false));
        let unbounded: Vec<_> =
            next.iter().zip(bounded).filter(|(_, is_bounded)| !**is_bounded).map(|(x, _)| *x).collect();
        let mut checks: Vec<_> = self.are_finite(&unbounded).into_iter().collect();
        if step.module.function(StepRole::Domain).is_some() {
            let zero = self.e.number(0.0);
            for margin in self.function(stage, StepRole::Domain).concat() {
                checks.push(self.e.builder.ins().fcmp(FloatCC::LessThan, zero, margin));
            }
        }
        (next, checks.into_iter().reduce(|a, b| self.e.builder.ins().band(a, b)))
    }

    /// One iteration, which changes the unknown by little, or the solver goes on from it.
    fn fixed_point(&mut self, stage: usize, carried: &Carried, exit: &Exit) {
        let (point, unknown) = self.iteration(stage);
        let mut within = None;
        for block in self.blocks(stage) {
            let [mut change, mut size] = [None; 2];
            for i in block {
                let moved = self.e.builder.ins().fsub(unknown[i], point[i]);
                change = Some(self.and_magnitude(change, moved));
                size = Some(self.and_magnitude(size, unknown[i]));
            }
            let (Some(change), Some(size)) = (change, size) else { continue };
            let bound = self.e.builder.ins().fmul(self.stages[stage].tolerance, size);
            let is_within = self.e.builder.ins().fcmp(FloatCC::LessThanOrEqual, change, bound);
            within = Some(match within {
                None => is_within,
                Some(all) => self.e.builder.ins().band(all, is_within),
            });
        }
        if let Some(within) = within {
            self.check(within, stage, carried, exit, |march| march.hand_on(stage, &unknown));
        }
        self.stages[stage].given.unknown = unknown;
    }

    /// A few iterations. How many they are more than one.
    fn newton(&mut self, stage: usize, carried: &Carried, exit: &Exit) -> ir::Value {
        let tolerance = self.stages[stage].tolerance;
        let guess = self.stages[stage].given.unknown.clone();
        let [again, on, not_yet, halt] = std::array::from_fn(|_| self.e.builder.create_block());
        let more = self.e.builder.append_block_param(again, types::I64);
        let last = self.e.builder.append_block_param(again, types::F64);
        let point: Vec<_> =
            guess.iter().map(|_| self.e.builder.append_block_param(again, types::F64)).collect();
        let zero = self.e.builder.ins().iconst(types::I64, 0);
        let far = self.e.number(numbers::<1>("FAR")[0]);
        let first: Vec<BlockArg> = [zero, far].iter().chain(&guess).map(|x| (*x).into()).collect();
        self.e.builder.ins().jump(again, &first);
        self.e.builder.switch_to_block(again);
        self.stages[stage].given.unknown = point;
        let (point, unknown) = self.iteration(stage);
        let now = self.change(stage, &point, &unknown);
        let (square, bound) = {
            let left = self.e.number(numbers::<1>("LEFT")[0] * f64::EPSILON);
            (self.e.builder.ins().fmul(now, now), self.e.builder.ins().fmul(left, last))
        };
        let is_small = self.e.builder.ins().fcmp(FloatCC::LessThanOrEqual, now, tolerance);
        let contracts = self.e.builder.ins().fcmp(FloatCC::LessThanOrEqual, square, bound);
        let is_last = self.e.builder.ins().band(is_small, contracts);
        self.e.builder.ins().brif(is_last, on, &[], not_yet, &[]);
        self.e.builder.switch_to_block(not_yet);
        let are_enough = self.e.builder.ins().icmp_imm_s(IntCC::Equal, more, numbers::<1>("FEW")[0] as i64);
        let one_more = self.e.builder.ins().iadd_imm_s(more, 1);
        let next: Vec<BlockArg> = [one_more, now].iter().chain(&unknown).map(|x| (*x).into()).collect();
        self.e.builder.ins().brif(are_enough, halt, &[], again, &next);
        self.e.builder.switch_to_block(halt);
        self.halt(stage, carried, exit, |_| ());
        self.e.builder.switch_to_block(on);
        self.stages[stage].given.unknown = unknown;
        more
    }

    /// Gives the solver an iterate to go on from.
    fn hand_on(&mut self, stage: usize, unknown: &[ir::Value]) {
        let Stage { frame, layout, .. } = self.stages[stage];
        self.e.store_all(frame, layout.out.start, unknown);
        let one = self.e.builder.ins().iconst(types::I64, 1);
        self.put(stage, field!(has_first), one);
    }

    /// An iteration: where it starts, and where it leads to.
    fn iteration(&mut self, stage: usize) -> (Vec<ir::Value>, Vec<ir::Value>) {
        self.evaluate(stage);
        let point = self.stages[stage].given.unknown.clone();
        (point, self.function(stage, StepRole::FixedPointUpdate).concat())
    }

    /// The equation at an unknown.
    fn evaluate(&mut self, stage: usize) {
        let mut arrays = self.function(stage, StepRole::Evaluate).into_iter();
        let given = &mut self.stages[stage].given;
        given.residual = arrays.next().unwrap_or_default();
        given.right = arrays.next().unwrap_or_default();
    }

    /// A function of a stage, with what it is given.
    fn function(&mut self, stage: usize, role: StepRole) -> Arrays {
        let Stage { step, layout, constant, given, .. } = &mut self.stages[stage];
        let module = &step.module;
        let Some(function) = module.function(role) else { return Vec::new() };
        for argument in &function.arguments {
            let values = &argument.values;
            let numbers = match argument.input {
                Input::State => match &given.state {
                    State::Numbers(numbers) => numbers,
                    State::At(address, there) => {
                        self.e.bind_memory(values, *address, 0);
                        for (place, number) in there {
                            self.e.bind(values.get(*place..=*place).unwrap_or_default(), [number]);
                        }
                        continue;
                    }
                },
                Input::Time => &given.time,
                Input::Unknown => &given.unknown,
                Input::Residual => &given.residual,
                Input::Right => &given.right,
                Input::Record(RecordKind::Step) => &given.step,
                Input::Record(RecordKind::Iterate) => &given.iterate,
                lasting => {
                    let first = match lasting {
                        Input::Record(_) => layout.constants.start,
                        Input::Control => layout.control.start,
                        Input::Parameters => layout.parameters.start,
                        // the step size, and no more: see `InStep`
                        _ => layout.step_size,
                    };
                    self.e.bind_memory(values, *constant, first);
                    continue;
                }
            };
            self.e.bind(values, numbers);
        }
        self.e.body(function);
        let results = self.e.results(function);
        if let Some(kind) = function.record {
            let fields = module.values.fields(kind).iter().map(|field| self.e.value(*field)).collect();
            match kind {
                RecordKind::Step => given.step = fields,
                _ => given.iterate = fields,
            }
        }
        results
    }

    /// The places of the blocks of unknowns.
    fn blocks(&self, stage: usize) -> Vec<std::ops::Range<usize>> {
        let Stage { step, layout, .. } = &self.stages[stage];
        let (mut end, most) = (0_usize, layout.unknown.len());
        let range = |length: &usize| {
            let start = end;
            end = end.saturating_add(*length).min(most);
            start..end
        };
        step.blocks.iter().map(range).collect()
    }

    /// The change of the unknown, relative to what it becomes.
    fn change(&mut self, stage: usize, from: &[ir::Value], to: &[ir::Value]) -> ir::Value {
        let moved = self.each(to, from, |e, to, from| e.builder.ins().fsub(to, from));
        self.relative(stage, &moved, to)
    }

    /// The sizes of blocks relative to those of another unknown, together.
    fn relative(&mut self, stage: usize, of: &[ir::Value], to: &[ir::Value]) -> ir::Value {
        let mut ratios = self.e.number(0.0);
        for block in self.blocks(stage) {
            let mut change = self.e.number(0.0);
            let mut size = self.e.number(f64::MIN_POSITIVE / f64::EPSILON);
            for i in block {
                change = self.and_magnitude(Some(change), of[i]);
                size = self.and_magnitude(Some(size), to[i]);
            }
            let ratio = self.e.builder.ins().fdiv(change, size);
            ratios = self.e.builder.ins().fadd(ratios, ratio);
        }
        ratios
    }

    fn and_magnitude(&mut self, sum: Option<ir::Value>, x: ir::Value) -> ir::Value {
        // in one instruction, where the absolute value takes three
        let all_but_sign = self.e.number(f64::from_bits(u64::MAX >> 1));
        let magnitude = self.e.builder.ins().band(x, all_but_sign);
        match sum {
            None => magnitude,
            Some(sum) => self.e.builder.ins().fadd(sum, magnitude),
        }
    }

    /// Whether the numbers are finite, and their sum; none if there are none.
    fn are_finite(&mut self, numbers: &[ir::Value]) -> Option<ir::Value> {
        let mut sums = [None; 4];
        for (place, number) in numbers.iter().enumerate() {
            let sum = &mut sums[place % 4];
            *sum = Some(match *sum {
                None => *number,
                Some(sum) => self.e.builder.ins().fadd(sum, *number),
            });
        }
        let sum = sums.into_iter().flatten().reduce(|a, b| self.e.builder.ins().fadd(a, b))?;
        let zero = self.e.number(0.0);
        let nothing = self.e.builder.ins().fmul(zero, sum);
        Some(self.e.builder.ins().fcmp(FloatCC::LessThanOrEqual, nothing, zero))
    }

    fn each(
        &mut self,
        a: &[ir::Value],
        b: &[ir::Value],
        of: impl Fn(&mut Emitter<'_, '_>, ir::Value, ir::Value) -> ir::Value,
    ) -> Vec<ir::Value> {
        a.iter().zip(b).map(|(a, b)| of(self.e, *a, *b)).collect()
    }

    fn read(&mut self, ty: ir::Type, address: ir::Value, i: usize) -> ir::Value {
        self.e.builder.ins().load(ty, Emitter::memory(), address, (i * size_of::<f64>()) as i32)
    }

    fn write(&mut self, address: ir::Value, i: usize, value: ir::Value) {
        self.e.builder.ins().store(Emitter::memory(), value, address, (i * size_of::<f64>()) as i32);
    }

    /// The address of the solution so many steps before the next.
    fn row(&mut self, stage: usize, oldest: ir::Value, back: usize) -> ir::Value {
        let Stage { ring, layout, .. } = self.stages[stage];
        let bytes = row_length(layout.unknown.len()) * size_of::<f64>();
        let builder = &mut self.e.builder;
        let offset = if bytes.is_power_of_two() {
            let scaled = builder.ins().ishl_imm_u(oldest, i64::from(bytes.trailing_zeros()));
            let offset = builder.ins().iadd_imm_s(scaled, ((WINDOW - back) * bytes) as i64);
            builder.ins().band_imm_u(offset, (WINDOW * bytes - 1) as i64)
        } else {
            let place = builder.ins().iadd_imm_s(oldest, (WINDOW - back) as i64);
            let place = builder.ins().band_imm_u(place, WINDOW as i64 - 1);
            builder.ins().imul_imm_s(place, bytes as i64)
        };
        builder.ins().iadd(ring, offset)
    }

    /// The components of an unknown, two at a time as far as there are two.
    fn pieces(&self, stage: usize) -> Vec<(usize, ir::Type)> {
        let unknowns = self.stages[stage].layout.unknown.len();
        let type_at = |i| if i + 1 < unknowns { types::F64X2 } else { types::F64 };
        (0..unknowns).step_by(2).map(|i| (i, type_at(i))).collect()
    }

    /// Takes the solution of this step.
    fn keep(&mut self, stage: usize, oldest: ir::Value, kept: &[ir::Value]) {
        let row = self.row(stage, oldest, WINDOW);
        for (i, ty) in self.pieces(stage) {
            let mut piece = kept[i];
            if ty == types::F64X2 {
                let first = self.e.builder.ins().scalar_to_vector(ty, kept[i]);
                piece = self.e.builder.ins().insertlane(first, kept[i + 1], 1);
            }
            self.write(row, i, piece);
        }
    }

    /// Where the solutions point, of which this is the latest.
    fn then(&mut self, stage: usize, oldest: ir::Value, kept: &[ir::Value]) -> Vec<ir::Value> {
        // a step from now the solutions are one place newer
        let is_newton = self.stages[stage].step.is_newton;
        let used: Vec<usize> = match is_newton {
            true => (2..=WINDOW / 2).collect(),
            false => PAIRS.iter().flat_map(|j| [*j, WINDOW - j]).skip(1).chain([WINDOW]).collect(),
        };
        let rows: Vec<_> = used.into_iter().map(|j| (j, self.row(stage, oldest, j - 1))).collect();
        let [latest] = numbers(if is_newton { "BINOMIAL" } else { "WEIGHTS" });
        let mut then = Vec::new();
        for (i, ty) in self.pieces(stage) {
            // none of them is the one that this step writes over
            let at = |(j, row): &(usize, ir::Value)| {
                let offset = (i * size_of::<f64>()) as i32;
                (*j, self.e.builder.ins().load(ty, Emitter::lasting(), *row, offset))
            };
            let at: Vec<_> = rows.iter().map(at).collect();
            let begun = if is_newton { self.eighth(ty, &at) } else { self.earlier(ty, &at) };
            let lanes = if ty == types::F64X2 { 2 } else { 1 };
            for lane in 0..lanes {
                let begun = if lanes == 2 { self.e.builder.ins().extractlane(begun, lane) } else { begun };
                let weight = self.e.number(latest);
                let product = self.e.builder.ins().fmul(weight, kept[i + usize::from(lane)]);
                then.push(self.e.builder.ins().fadd(begun, product));
            }
        }
        then
    }

    fn constant(&mut self, ty: ir::Type, x: f64) -> ir::Value {
        let x = self.e.builder.ins().f64const(x);
        if ty == types::F64X2 { self.e.builder.ins().splat(ty, x) } else { x }
    }

    fn times(&mut self, ty: ir::Type, a: f64, x: ir::Value) -> ir::Value {
        let a = self.constant(ty, a);
        self.e.builder.ins().fmul(a, x)
    }

    fn plus(&mut self, ty: ir::Type, to: ir::Value, a: f64, x: ir::Value) -> ir::Value {
        let a = self.constant(ty, a);
        self.e.mul_add(false, a, x, to)
    }

    /// `eighth` of the solver's predictor.
    fn eighth(&mut self, ty: ir::Type, at: &[(usize, ir::Value)]) -> ir::Value {
        let [b0, b1, b2, b3] = numbers("BINOMIAL");
        let sum = |e: &mut Emitter<'_, '_>, i, j| {
            let [a, b] = [i, j].map(|j| found(at, j));
            e.builder.ins().fadd(a, b)
        };
        let inner = self.times(ty, b3, found(at, 4));
        let both = sum(self.e, 3, 5);
        let inner = self.plus(ty, inner, b2, both);
        let outer = self.times(ty, b0, found(at, 7));
        let both = sum(self.e, 2, 6);
        let outer = self.plus(ty, outer, b1, both);
        let outer = self.e.builder.ins().fsub(outer, found(at, 8));
        self.e.builder.ins().fadd(inner, outer)
    }

    /// `earlier` of the solver's predictor.
    fn earlier(&mut self, ty: ir::Type, at: &[(usize, ir::Value)]) -> ir::Value {
        let [w0, w1, w2, w3, w4] = numbers("WEIGHTS");
        let difference = |e: &mut Emitter<'_, '_>, pair: usize| {
            let j = PAIRS[pair];
            let [a, b] = [j, WINDOW - j].map(|j| found(at, j));
            e.builder.ins().fsub(a, b)
        };
        let fourth = difference(self.e, 4);
        let inner = self.times(ty, w4, fourth);
        let third = difference(self.e, 3);
        let inner = self.plus(ty, inner, w3, third);
        let second = difference(self.e, 2);
        let outer = self.times(ty, w2, second);
        let first = difference(self.e, 1);
        let outer = self.plus(ty, outer, w1, first);
        let last = self.plus(ty, found(at, WINDOW), -w0, found(at, WINDOW - PAIRS[0]));
        let both = self.e.builder.ins().fadd(inner, outer);
        self.e.builder.ins().fadd(last, both)
    }
}

/// The solution so many steps before.
fn found(at: &[(usize, ir::Value)], j: usize) -> ir::Value {
    at.iter().find(|(known, _)| *known == j).map_or(at[0].1, |(_, value)| *value)
}
