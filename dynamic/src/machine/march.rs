//! The fast path of many steps as one function: what `fast_path` in `runtime/src/solve/step.rs` does, to the last bit, with the predictor beside it.
//! Of a step that needs more it changes nothing, and leaves it to the solver.

use std::mem::offset_of;

use coadjoint::erased::dynamic::{Layout, Marching, row_length};
use coadjoint_codegen::program::{Input, RecordKind, StepProgram, StepRole, solver};
use cranelift_codegen::ir::condcodes::{FloatCC, IntCC};
use cranelift_codegen::ir::{self, Block, BlockArg, InstBuilder, types};
use cranelift_module::{FuncId, ModuleResult};

use super::Compiler;
use super::emit::{Arrays, Emitter};

/// The function, if there is a fast path.
pub(super) fn defined(
    compiler: &mut Compiler,
    step: &StepProgram,
    layout: &Layout,
) -> ModuleResult<Option<FuncId>> {
    let has_path = layout.unknown.is_empty() || step.module.function(StepRole::FixedPointUpdate).is_some();
    if !has_path {
        return Ok(None);
    }
    let define = |emitter: &mut Emitter<'_, '_>| March::new(emitter, step, layout).all();
    compiler.define(step.module.values.places(), define).map(Some)
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
    step: &'a StepProgram,
    layout: &'a Layout,
    /// The address of what there is to go on from.
    marching: ir::Value,
    ring: ir::Value,
    /// What functions are given.
    given: Given,
}

#[derive(Default)]
struct Given {
    state: Vec<ir::Value>,
    time: Vec<ir::Value>,
    unknown: Vec<ir::Value>,
    residual: Vec<ir::Value>,
    right: Vec<ir::Value>,
    step: Vec<ir::Value>,
    iterate: Vec<ir::Value>,
}

/// What is carried from step to step: parameters of a block.
struct Carried {
    /// Steps taken.
    steps: ir::Value,
    /// The place of the oldest solution.
    oldest: ir::Value,
    /// Iterations more than one a step: all, and in one at most.
    more: [ir::Value; 2],
    state: Vec<ir::Value>,
    /// Where the solutions point.
    next: Vec<ir::Value>,
}

impl<'a, 'e, 'f> March<'a, 'e, 'f> {
    fn new(e: &'a mut Emitter<'e, 'f>, step: &'a StepProgram, layout: &'a Layout) -> Self {
        let marching = e.frame;
        Self { e, step, layout, marching, ring: marching, given: Given::default() }
    }

    fn get(&mut self, ty: ir::Type, offset: i32) -> ir::Value {
        let marching = self.marching;
        self.e.builder.ins().load(ty, Emitter::memory(), marching, offset)
    }

    fn put(&mut self, offset: i32, value: ir::Value) {
        let marching = self.marching;
        self.e.builder.ins().store(Emitter::memory(), value, marching, offset);
    }

    fn all(mut self) {
        let (pointer, unknowns) = (self.e.pointer, self.layout.unknown.len());
        self.e.frame = self.get(pointer, field!(frame));
        self.ring = self.get(pointer, field!(ring));
        let next = self.get(pointer, field!(next));
        let [tolerance, start, length] =
            [field!(tolerance), field!(start), field!(step)].map(|at| self.get(types::F64, at));
        let [taken, most, oldest] =
            [field!(taken), field!(most), field!(oldest)].map(|at| self.get(types::I64, at));
        let [head, body, exit] = std::array::from_fn(|_| self.e.builder.create_block());
        let zero = self.e.builder.ins().iconst(types::I64, 0);
        let state: Vec<_> = self.layout.state.clone().map(|place| self.e.load(place)).collect();
        let ahead: Vec<_> = (0..unknowns).map(|i| self.read(types::F64, next, i)).collect();
        // controls that are not finite are left to the solver, which says so
        let controls: Vec<_> = self.layout.control.clone().map(|place| self.e.load(place)).collect();
        let first = Carried { steps: zero, oldest, more: [zero; 2], state, next: ahead };
        let carried = self.carried(head, first.state.len());
        match self.are_finite(&controls) {
            None => self.go_on(head, &first),
            Some(are_finite) => {
                let [good, bad] = std::array::from_fn(|_| self.e.builder.create_block());
                self.e.builder.ins().brif(are_finite, good, &[], bad, &[]);
                self.e.builder.switch_to_block(bad);
                self.e.builder.ins().return_(&[]);
                self.e.builder.switch_to_block(good);
                self.go_on(head, &first);
            }
        }

        self.e.builder.switch_to_block(head);
        let is_more = self.e.builder.ins().icmp(IntCC::UnsignedLessThan, carried.steps, most);
        self.e.builder.ins().brif(is_more, body, &[], exit, &[]);

        self.e.builder.switch_to_block(body);
        let now = self.e.builder.ins().iadd(taken, carried.steps);
        let now = self.e.builder.ins().fcvt_from_uint(types::F64, now);
        let since = self.e.builder.ins().fmul(now, length);
        self.given.time = vec![self.e.builder.ins().fadd(start, since)];
        self.given.state = carried.state.clone();
        self.one_step(tolerance, head, &carried, exit);

        // with what the last step that was taken led to
        self.e.builder.switch_to_block(exit);
        let Carried { steps, oldest, more: [more, most_more], state, next: ahead } = carried;
        for (offset, value) in
            [(field!(steps), steps), (field!(oldest), oldest), (field!(more), more), (field!(most_more), most_more)]
        {
            self.put(offset, value);
        }
        self.e.store_all(self.layout.state.start, &state);
        ahead.iter().enumerate().for_each(|(i, value)| self.write(next, i, *value));
        self.e.builder.ins().return_(&[]);
    }

    /// The step that starts at what is carried, and the way to the next one, or to the end.
    fn one_step(&mut self, tolerance: ir::Value, head: Block, carried: &Carried, exit: Block) {
        let (is_newton, unknowns) = (self.step.is_newton, self.layout.unknown.len());
        self.function(StepRole::Begin);
        let mut point = carried.next.clone();
        let mut start = Vec::new();
        if is_newton {
            start = self.function(StepRole::Start).concat();
            point = self.each(&start, &point, |e, start, apart| e.builder.ins().fadd(start, apart));
        }
        let mut more = None;
        self.given.unknown = point;
        if unknowns == 0 {
            self.function(StepRole::Evaluate);
        } else if is_newton {
            more = Some(self.newton(tolerance, exit));
        } else {
            self.fixed_point(tolerance, exit);
        }
        // where an iteration leads to
        let unknown = self.given.unknown.clone();
        let mut kept = unknown.clone();
        if is_newton {
            kept = self.each(&unknown, &start, |e, unknown, start| e.builder.ins().fsub(unknown, start));
        }
        let then = self.then(carried.oldest, &kept);
        let next = self.function(StepRole::Finish).concat();
        let bounded = self.step.bounded.iter().chain(std::iter::repeat(&false));
        let unbounded: Vec<_> =
            next.iter().zip(bounded).filter(|(_, is_bounded)| !**is_bounded).map(|(x, _)| *x).collect();
        let mut checks: Vec<_> = self.are_finite(&unbounded).into_iter().collect();
        if self.step.module.function(StepRole::Domain).is_some() {
            let zero = self.e.number(0.0);
            for margin in self.function(StepRole::Domain).concat() {
                checks.push(self.e.builder.ins().fcmp(FloatCC::LessThan, zero, margin));
            }
        }
        if let Some(good) = checks.into_iter().reduce(|a, b| self.e.builder.ins().band(a, b)) {
            let on = self.e.builder.create_block();
            self.e.builder.ins().brif(good, on, &[], exit, &[]);
            self.e.builder.switch_to_block(on);
        }
        // the step is taken
        let mut counts = carried.more;
        let mut oldest = carried.oldest;
        if unknowns > 0 {
            self.keep(oldest, &kept);
            oldest = self.e.builder.ins().iadd_imm_s(oldest, 1);
        }
        if let Some(more) = more {
            let pointer = self.e.pointer;
            let solution = self.get(pointer, field!(solution));
            unknown.iter().enumerate().for_each(|(i, value)| self.write(solution, i, *value));
            counts = [self.e.builder.ins().iadd(counts[0], more), self.e.builder.ins().umax(counts[1], more)];
        }
        let steps = self.e.builder.ins().iadd_imm_s(carried.steps, 1);
        self.go_on(head, &Carried { steps, oldest, more: counts, state: next, next: then });
    }

    /// One iteration, which changes the unknown by little, or the solver goes on from it.
    fn fixed_point(&mut self, tolerance: ir::Value, exit: Block) {
        let (point, unknown) = self.iteration();
        let mut within = None;
        for block in self.blocks() {
            let [mut change, mut size] = [None; 2];
            for i in block {
                let moved = self.e.builder.ins().fsub(unknown[i], point[i]);
                change = Some(self.and_magnitude(change, moved));
                size = Some(self.and_magnitude(size, unknown[i]));
            }
            let (Some(change), Some(size)) = (change, size) else { continue };
            let bound = self.e.builder.ins().fmul(tolerance, size);
            let is_within = self.e.builder.ins().fcmp(FloatCC::LessThanOrEqual, change, bound);
            within = Some(match within {
                None => is_within,
                Some(all) => self.e.builder.ins().band(all, is_within),
            });
        }
        if let Some(within) = within {
            let [on, halt] = std::array::from_fn(|_| self.e.builder.create_block());
            self.e.builder.ins().brif(within, on, &[], halt, &[]);
            self.halt_with(halt, &unknown, exit);
            self.e.builder.switch_to_block(on);
        }
        self.given.unknown = unknown;
    }

    /// A few iterations. How many they are more than one.
    fn newton(&mut self, tolerance: ir::Value, exit: Block) -> ir::Value {
        let [again, on, not_yet, halt] = std::array::from_fn(|_| self.e.builder.create_block());
        let more = self.e.builder.append_block_param(again, types::I64);
        let last = self.e.builder.append_block_param(again, types::F64);
        let point: Vec<_> =
            self.given.unknown.iter().map(|_| self.e.builder.append_block_param(again, types::F64)).collect();
        let zero = self.e.builder.ins().iconst(types::I64, 0);
        let far = self.e.number(numbers::<1>("FAR")[0]);
        let first: Vec<BlockArg> = [zero, far].iter().chain(&self.given.unknown).map(|x| (*x).into()).collect();
        self.e.builder.ins().jump(again, &first);
        self.e.builder.switch_to_block(again);
        self.given.unknown = point;
        let (point, unknown) = self.iteration();
        let now = self.change(&point, &unknown);
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
        self.halt_with(halt, &unknown, exit);
        self.e.builder.switch_to_block(on);
        self.given.unknown = unknown;
        more
    }

    /// Leaves the step to the solver, which goes on from this iterate.
    fn halt_with(&mut self, block: Block, unknown: &[ir::Value], exit: Block) {
        self.e.builder.switch_to_block(block);
        self.e.builder.set_cold_block(block);
        self.e.store_all(self.layout.out.start, unknown);
        let one = self.e.builder.ins().iconst(types::I64, 1);
        self.put(field!(has_first), one);
        self.e.builder.ins().jump(exit, &[]);
    }

    /// An iteration: where it starts, and where it leads to.
    fn iteration(&mut self) -> (Vec<ir::Value>, Vec<ir::Value>) {
        let mut arrays = self.function(StepRole::Evaluate).into_iter();
        self.given.residual = arrays.next().unwrap_or_default();
        self.given.right = arrays.next().unwrap_or_default();
        let unknown = self.function(StepRole::FixedPointUpdate).concat();
        (self.given.unknown.clone(), unknown)
    }

    /// A function of the step, with what it is given.
    fn function(&mut self, role: StepRole) -> Arrays {
        let module = &self.step.module;
        let Some(function) = module.function(role) else { return Vec::new() };
        let layout = self.layout;
        for argument in &function.arguments {
            let values = &argument.values;
            let given = match argument.input {
                Input::State => &self.given.state,
                Input::Time => &self.given.time,
                Input::Unknown => &self.given.unknown,
                Input::Residual => &self.given.residual,
                Input::Right => &self.given.right,
                Input::Record(RecordKind::Step) => &self.given.step,
                Input::Record(RecordKind::Iterate) => &self.given.iterate,
                Input::Record(_) => {
                    self.e.bind_frame(values, layout.constants.start);
                    continue;
                }
                Input::Control => {
                    self.e.bind_frame(values, layout.control.start);
                    continue;
                }
                Input::Parameters => {
                    self.e.bind_frame(values, layout.parameters.start);
                    continue;
                }
                // the step size, and no more: see `InStep`
                _ => {
                    self.e.bind_frame(values, layout.step_size);
                    continue;
                }
            };
            self.e.bind(values, given);
        }
        self.e.body(function);
        let results = self.e.results(function);
        if let Some(kind) = function.record {
            let fields = module.values.fields(kind).iter().map(|field| self.e.value(*field)).collect();
            match kind {
                RecordKind::Step => self.given.step = fields,
                _ => self.given.iterate = fields,
            }
        }
        results
    }

    /// The places of the blocks of unknowns.
    fn blocks(&self) -> Vec<std::ops::Range<usize>> {
        let (mut end, most) = (0_usize, self.layout.unknown.len());
        let range = |length: &usize| {
            let start = end;
            end = end.saturating_add(*length).min(most);
            start..end
        };
        self.step.blocks.iter().map(range).collect()
    }

    /// The change of the unknown, relative to what it becomes.
    fn change(&mut self, from: &[ir::Value], to: &[ir::Value]) -> ir::Value {
        let mut ratios = self.e.number(0.0);
        for block in self.blocks() {
            let mut change = self.e.number(0.0);
            let mut size = self.e.number(f64::MIN_POSITIVE / f64::EPSILON);
            for i in block {
                let moved = self.e.builder.ins().fsub(to[i], from[i]);
                change = self.and_magnitude(Some(change), moved);
                size = self.and_magnitude(Some(size), to[i]);
            }
            let ratio = self.e.builder.ins().fdiv(change, size);
            ratios = self.e.builder.ins().fadd(ratios, ratio);
        }
        ratios
    }

    fn and_magnitude(&mut self, sum: Option<ir::Value>, x: ir::Value) -> ir::Value {
        let magnitude = self.e.builder.ins().fabs(x);
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

    /// Parameters of a block for what is carried.
    fn carried(&mut self, block: Block, states: usize) -> Carried {
        let builder = &mut self.e.builder;
        let [steps, oldest, more, most_more] =
            std::array::from_fn(|_| builder.append_block_param(block, types::I64));
        let mut numbers = |count| (0..count).map(|_| builder.append_block_param(block, types::F64)).collect();
        let (state, next) = (numbers(states), numbers(self.layout.unknown.len()));
        Carried { steps, oldest, more: [more, most_more], state, next }
    }

    fn go_on(&mut self, block: Block, with: &Carried) {
        let counts = [with.steps, with.oldest, with.more[0], with.more[1]];
        let given = counts.iter().chain(&with.state).chain(&with.next).map(|value| (*value).into());
        let given: Vec<BlockArg> = given.collect();
        self.e.builder.ins().jump(block, &given);
    }

    fn read(&mut self, ty: ir::Type, address: ir::Value, i: usize) -> ir::Value {
        self.e.builder.ins().load(ty, Emitter::memory(), address, (i * size_of::<f64>()) as i32)
    }

    fn write(&mut self, address: ir::Value, i: usize, value: ir::Value) {
        self.e.builder.ins().store(Emitter::memory(), value, address, (i * size_of::<f64>()) as i32);
    }

    /// The address of the solution so many steps before the next.
    fn row(&mut self, oldest: ir::Value, back: usize) -> ir::Value {
        let bytes = row_length(self.layout.unknown.len()) * size_of::<f64>();
        let builder = &mut self.e.builder;
        let place = builder.ins().iadd_imm_s(oldest, (WINDOW - back) as i64);
        let place = builder.ins().band_imm_u(place, WINDOW as i64 - 1);
        let offset = builder.ins().imul_imm_s(place, bytes as i64);
        builder.ins().iadd(self.ring, offset)
    }

    /// The components of an unknown, two at a time as far as there are two.
    fn pieces(&self) -> Vec<(usize, ir::Type)> {
        let unknowns = self.layout.unknown.len();
        let type_at = |i| if i + 1 < unknowns { types::F64X2 } else { types::F64 };
        (0..unknowns).step_by(2).map(|i| (i, type_at(i))).collect()
    }

    /// Takes the solution of this step.
    fn keep(&mut self, oldest: ir::Value, kept: &[ir::Value]) {
        let row = self.row(oldest, WINDOW);
        for (i, ty) in self.pieces() {
            let mut piece = kept[i];
            if ty == types::F64X2 {
                let both = self.e.builder.ins().splat(ty, kept[i]);
                piece = self.e.builder.ins().insertlane(both, kept[i + 1], 1);
            }
            self.write(row, i, piece);
        }
    }

    /// Where the solutions point, of which this is the latest.
    fn then(&mut self, oldest: ir::Value, kept: &[ir::Value]) -> Vec<ir::Value> {
        // a step from now the solutions are one place newer
        let is_newton = self.step.is_newton;
        let used: Vec<usize> = match is_newton {
            true => (2..=WINDOW / 2).collect(),
            false => PAIRS.iter().flat_map(|j| [*j, WINDOW - j]).skip(1).chain([WINDOW]).collect(),
        };
        let rows: Vec<_> = used.into_iter().map(|j| (j, self.row(oldest, j - 1))).collect();
        let [latest] = numbers(if is_newton { "BINOMIAL" } else { "WEIGHTS" });
        let mut then = Vec::new();
        for (i, ty) in self.pieces() {
            let at: Vec<_> = rows.iter().map(|(j, row)| (*j, self.read(ty, *row, i))).collect();
            let begun = if is_newton { self.eighth(ty, &at) } else { self.earlier(ty, &at) };
            let lanes = if ty == types::F64X2 { 2 } else { 1 };
            for lane in 0..lanes {
                let begun =
                    if lanes == 2 { self.e.builder.ins().extractlane(begun, lane) } else { begun };
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
