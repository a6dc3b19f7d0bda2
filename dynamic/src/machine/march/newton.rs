//! A step by Newton's method alone: `Newton` in `runtime/src/solve/newton.rs`, as long as nothing stalls.

use std::mem::offset_of;

use coadjoint::erased::dynamic::{Layout, Marching};
use coadjoint_codegen::program::{StepProgram, StepRole};
use cranelift_codegen::ir::condcodes::{FloatCC, IntCC};
use cranelift_codegen::ir::{self, BlockArg, InstBuilder, types};

use super::{Given, March, Stage, State, numbers};

impl<'a> March<'a, '_, '_> {
    /// One step by Newton's method.
    pub(super) fn by_newton(mut self, step: &'a StepProgram, layout: &'a Layout) {
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
        let guess: Vec<_> = (0..layout.unknown.len()).map(|i| self.read(next, i)).collect();
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
}
