//! The fast path of many steps as one function: what `fast_path` in `runtime/src/solve/step.rs` does, to the last bit, with the predictor beside it.
//! Of a step that needs more it changes nothing, and leaves it to the solver.

/// A field of [`Marching`].
macro_rules! field {
    ($name:ident) => {
        offset_of!(Marching, $name) as i32
    };
}

mod carried;
mod measure;
mod predictor;

use std::mem::offset_of;

use coadjoint::erased::dynamic::{Layout, Marching};
use coadjoint_codegen::program::{Input, RecordKind, StepProgram, StepRole, solver};
use cranelift_codegen::ir::condcodes::{FloatCC, IntCC};
use cranelift_codegen::ir::{self, BlockArg, InstBuilder, types};
use cranelift_module::FuncId;

use self::carried::{Carried, Exit, awaited};
use super::Compiler;
use super::emit::{Arrays, Emitter, Number, block_args};

/// The function of these stages.
pub(super) fn defined(compiler: &mut Compiler, stages: &[(&StepProgram, &Layout)]) -> Option<FuncId> {
    compiler.define(0, |emitter| March { e: emitter, stages: Vec::new(), before: None }.all(stages))
}

/// The solver's numbers of this name.
fn numbers<const N: usize>(name: &str) -> [f64; N] {
    let mut numbers = [f64::NAN; N];
    numbers.iter_mut().zip(solver::values(name)).for_each(|(to, value)| *to = *value);
    numbers
}

/// What is written.
struct March<'a, 'e, 'f> {
    e: &'a mut Emitter<'e, 'f>,
    stages: Vec<Stage<'a>>,
    /// What was carried before a step of several members: all of it is left where one of its stages is, for it may fail for one of them alone.
    before: Option<Carried>,
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
    tolerance: Number,
    /// What functions are given.
    given: Given,
}

#[derive(Default)]
struct Given {
    state: State,
    time: Vec<Number>,
    unknown: Vec<Number>,
    residual: Vec<Number>,
    right: Vec<Number>,
    step: Vec<Number>,
    iterate: Vec<Number>,
}

/// A state: numbers, or from this address on.
#[derive(Clone)]
enum State {
    Numbers(Vec<Number>),
    /// But for some, which are there.
    At(ir::Value, Vec<(usize, Number)>),
}

impl Default for State {
    fn default() -> Self {
        Self::Numbers(Vec::new())
    }
}

impl<'a, 'e, 'f> March<'a, 'e, 'f> {
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
            let [constant, ring, next] = [frame; 3];
            let (memory, ty) = (Emitter::memory(), self.e.ty());
            let tolerance = self.e.load_as(ty, memory, marching, field!(tolerance));
            self.stages.push(Stage { step, layout, marching, frame, constant, ring, next, tolerance, given });
            let [frame, ring, next] =
                [field!(frame), field!(ring), field!(next)].map(|at| self.get(place, pointer, at));
            let stage = &mut self.stages[place];
            (stage.frame, stage.ring, stage.next) = (frame, ring, next);
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
            state: awaited.iter().map(|i| self.read(at, *i)).collect(),
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
                let good = self.e.all(good);
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
        self.before = self.e.wide.then(|| carried.clone());
        let now = self.e.builder.ins().iadd(taken, carried.steps);
        let now = self.e.builder.ins().fcvt_from_uint(types::F64, now);
        let since = self.e.builder.ins().fmul(now, length);
        let mut time = self.e.builder.ins().fadd(start, since);
        let there = awaited.iter().copied().zip(carried.state.iter().copied());
        let mut state = State::At(carried.at, there.collect());
        for stage in 0..stages.len() {
            if stage > 0 {
                // two halves of a step
                let half = self.e.scalar(0.5);
                let half = self.e.builder.ins().fmul(half, length);
                time = self.e.builder.ins().fadd(time, half);
            }
            let constant = self.e.builder.ins().iadd(self.stages[stage].frame, carried.nothing);
            self.stages[stage].constant = constant;
            let both = self.e.in_all_lanes(time);
            self.stages[stage].given = Given { state: state.clone(), time: vec![both], ..Given::default() };
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

    /// The address of a place in a frame.
    fn address(&mut self, frame: ir::Value, place: usize) -> ir::Value {
        let offset = i64::from(self.e.offset(place));
        self.e.builder.ins().iadd_imm_s(frame, offset)
    }

    /// A branch that leaves a stage to the solver where the condition does not hold, after what `before` does.
    fn check(
        &mut self,
        good: Number,
        stage: usize,
        carried: &Carried,
        exit: &Exit,
        before: impl FnOnce(&mut Self),
    ) {
        let [on, halt] = std::array::from_fn(|_| self.e.builder.create_block());
        let good = self.e.all(good);
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
        if let Some(all) = self.before.clone() {
            let left = self.leave(exit, &all, 0);
            self.e.builder.ins().jump(exit.block, &left);
            return;
        }
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
    fn stage(&mut self, stage: usize, carried: &mut Carried, exit: &Exit) -> Vec<Number> {
        let Stage { step, layout, .. } = self.stages[stage];
        let (is_newton, unknowns) = (step.is_newton, layout.unknown.len());
        self.may_get_lost(stage, carried, exit);
        self.function(stage, StepRole::Begin);
        let before = carried.stages[stage].clone();
        let mut point = before.next.clone();
        let mut start = Vec::new();
        if is_newton {
            start = self.function(stage, StepRole::Start).concat();
            point = self.each(&start, &point, Emitter::add);
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
            if !step.is_chord {
                // it may be another solution
                let away = self.change(stage, &start, &unknown);
                let near = self.e.number(numbers::<1>("NEAR")[0]);
                let is_near = self.e.compare(FloatCC::LessThanOrEqual, away, near);
                self.check(is_near, stage, carried, exit, |_| {});
            }
            kept = self.each(&unknown, &start, Emitter::sub);
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
            self.e.store_all(solution, 0, &unknown);
            carried.stages[stage].more =
                vec![self.e.builder.ins().iadd(*all, more), self.e.builder.ins().umax(*most, more)];
        }
        next
    }

    /// The state after a step, and whether all is well with it, if anything may not be.
    fn finish(&mut self, stage: usize) -> (Vec<Number>, Option<Number>) {
        let step = self.stages[stage].step;
        let next = self.function(stage, StepRole::Finish).concat();
        let bounded = step.bounded.iter().chain(std::iter::repeat(&false));
        let unbounded: Vec<_> =
            next.iter().zip(bounded).filter(|(_, is_bounded)| !**is_bounded).map(|(x, _)| *x).collect();
        let mut checks: Vec<_> = self.are_finite(&unbounded).into_iter().collect();
        if step.module.function(StepRole::Domain).is_some() {
            let zero = self.e.number(0.0);
            for margin in self.function(stage, StepRole::Domain).concat() {
                checks.push(self.e.compare(FloatCC::LessThan, zero, margin));
            }
        }
        (next, checks.into_iter().reduce(|a, b| self.e.and(a, b)))
    }

    /// One iteration, which changes the unknown by little, or the solver goes on from it.
    fn fixed_point(&mut self, stage: usize, carried: &Carried, exit: &Exit) {
        let (point, unknown) = self.iteration(stage);
        let mut within = None;
        for block in self.blocks(stage) {
            let [mut change, mut size] = [None; 2];
            for i in block {
                let moved = self.e.sub(unknown[i], point[i]);
                change = Some(self.and_magnitude(change, moved));
                size = Some(self.and_magnitude(size, unknown[i]));
            }
            let (Some(change), Some(size)) = (change, size) else { continue };
            let bound = self.e.mul(self.stages[stage].tolerance, size);
            let is_within = self.e.compare(FloatCC::LessThanOrEqual, change, bound);
            within = Some(match within {
                None => is_within,
                Some(all) => self.e.and(all, is_within),
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
        let last = self.e.parameter(again);
        let point: Vec<_> = guess.iter().map(|_| self.e.parameter(again)).collect();
        let zero = self.e.builder.ins().iconst(types::I64, 0);
        let far = self.e.number(numbers::<1>("FAR")[0]);
        let first = [vec![zero.into()], block_args(std::iter::once(&far).chain(&guess))].concat();
        self.e.builder.ins().jump(again, &first);
        self.e.builder.switch_to_block(again);
        self.stages[stage].given.unknown = point;
        let (point, unknown) = self.iteration(stage);
        let now = self.change(stage, &point, &unknown);
        let left = self.e.number(numbers::<1>("LEFT")[0] * f64::EPSILON);
        let (mut square, mut bound) = (self.e.mul(now, now), self.e.mul(left, last));
        if self.stages[stage].step.has_true_jacobian {
            (square, bound) = (self.e.mul(square, now), self.e.mul(bound, last));
        }
        let is_small = self.e.compare(FloatCC::LessThanOrEqual, now, tolerance);
        let contracts = self.e.compare(FloatCC::LessThanOrEqual, square, bound);
        let is_last = self.e.and(is_small, contracts);
        let are_last = self.e.all(is_last);
        self.e.builder.ins().brif(are_last, on, &[], not_yet, &[]);
        self.e.builder.switch_to_block(not_yet);
        let are_enough = self.e.builder.ins().icmp_imm_s(IntCC::Equal, more, numbers::<1>("FEW")[0] as i64);
        let one_more = self.e.builder.ins().iadd_imm_s(more, 1);
        let mut next = [vec![now], unknown.clone()].concat();
        if self.e.wide {
            // of a member that has ended nothing changes
            for (next, before) in next.iter_mut().zip(std::iter::once(&last).chain(&point)) {
                *next = self.e.select(is_last, *before, *next);
            }
        }
        let next = [vec![BlockArg::from(one_more)], block_args(&next)].concat();
        self.e.builder.ins().brif(are_enough, halt, &[], again, &next);
        self.e.builder.switch_to_block(halt);
        self.halt(stage, carried, exit, |_| ());
        self.e.builder.switch_to_block(on);
        self.stages[stage].given.unknown = unknown;
        more
    }

    /// Gives the solver an iterate to go on from.
    fn hand_on(&mut self, stage: usize, unknown: &[Number]) {
        let Stage { frame, layout, .. } = self.stages[stage];
        self.e.store_all(frame, layout.out.start, unknown);
        let one = self.e.builder.ins().iconst(types::I64, 1);
        self.put(stage, field!(has_first), one);
    }

    /// An iteration: where it starts, and where it leads to.
    fn iteration(&mut self, stage: usize) -> (Vec<Number>, Vec<Number>) {
        self.evaluate(stage);
        let Stage { step, given, .. } = &self.stages[stage];
        let (point, is_newton) = (given.unknown.clone(), step.is_newton && step.has_true_jacobian);
        if !is_newton {
            return (point, self.function(stage, StepRole::FixedPointUpdate).concat());
        }
        let correction = self.function(stage, StepRole::Correction).concat();
        let next = self.each(&point, &correction, Emitter::sub);
        (point, next)
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

    fn each(
        &mut self,
        a: &[Number],
        b: &[Number],
        of: impl Fn(&mut Emitter<'e, 'f>, Number, Number) -> Number,
    ) -> Vec<Number> {
        a.iter().zip(b).map(|(a, b)| of(self.e, *a, *b)).collect()
    }

    fn read(&mut self, address: ir::Value, i: usize) -> Number {
        let (ty, offset) = (self.e.ty(), self.e.offset(i));
        self.e.load_as(ty, Emitter::memory(), address, offset)
    }
}
