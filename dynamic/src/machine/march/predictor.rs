//! The predictor: where the solutions before point, as `runtime/src/solve/predictor.rs` has it.

use std::mem::offset_of;

use coadjoint::erased::dynamic::{MACHINE_LANES, Marching, row_length};
use cranelift_codegen::ir::{self, InstBuilder, types};

use super::super::emit::Number;
use super::{Emitter, March, Stage, numbers};

/// How many solutions are remembered: a power of two.
const WINDOW: usize = 16;

/// Of which solutions before the next there are differences `x_j − x_{16 − j}`.
const PAIRS: [usize; 5] = [1, 2, 3, 5, 7];

impl March<'_, '_, '_> {
    /// The address of the solution so many steps before the next.
    fn row(&mut self, stage: usize, oldest: ir::Value, back: usize) -> ir::Value {
        let Stage { ring, layout, .. } = self.stages[stage];
        let bytes = row_length(layout.unknown.len(), self.e.members) * size_of::<f64>();
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

    /// The components of an unknown, each of all members, or of one member two at a time as far as there are two.
    fn pieces(&self, stage: usize) -> Vec<(usize, ir::Type)> {
        let unknowns = self.stages[stage].layout.unknown.len();
        if self.e.wide {
            return (0..unknowns).map(|i| (i, types::F64X2)).collect();
        }
        let type_at = |i| if i + 1 < unknowns { types::F64X2 } else { types::F64 };
        (0..unknowns).step_by(2).map(|i| (i, type_at(i))).collect()
    }

    /// Takes the solution of this step.
    pub(super) fn keep(&mut self, stage: usize, oldest: ir::Value, kept: &[Number]) {
        let row = self.row(stage, oldest, WINDOW);
        for (i, ty) in self.pieces(stage) {
            let mut piece = kept[i];
            if ty != self.e.ty() {
                piece = self.e.in_each([piece, kept[i + 1]], |builder, [first, second]| {
                    let first = builder.ins().scalar_to_vector(ty, first);
                    builder.ins().insertlane(first, second, 1)
                });
            }
            self.e.store(piece, row, i);
        }
    }

    /// Where the solutions point, of which this is the latest.
    pub(super) fn then(&mut self, stage: usize, oldest: ir::Value, kept: &[Number]) -> Vec<Number> {
        // a step from now the solutions are one place newer
        let is_newton = self.stages[stage].step.is_newton;
        let used: Vec<usize> = match is_newton {
            true => (2..=WINDOW / 2).collect(),
            false => PAIRS.iter().flat_map(|j| [*j, WINDOW - j]).skip(1).chain([WINDOW]).collect(),
        };
        let rows: Vec<_> = used.into_iter().map(|j| (j, self.row(stage, oldest, j - 1))).collect();
        let mut then = Vec::new();
        for (i, ty) in self.pieces(stage) {
            // none of them is the one that this step writes over
            let at = |(j, row): &(usize, ir::Value)| {
                let offset = self.e.offset(i);
                (*j, self.e.load_as(ty, Emitter::lasting(), *row, offset))
            };
            let at: Vec<_> = rows.iter().map(at).collect();
            let begun = if is_newton { self.eighth(ty, &at) } else { self.earlier(stage, ty, &at) };
            let lanes = if ty == self.e.ty() { 1 } else { 2 };
            for lane in 0..lanes {
                let begun = match lanes {
                    2 => self.e.in_each([begun], |builder, [both]| builder.ins().extractlane(both, lane)),
                    _ => begun,
                };
                let weight = match is_newton {
                    true => self.e.number(numbers::<1>("BINOMIAL")[0]),
                    false => self.weight(stage, self.e.ty(), 0),
                };
                let product = self.e.mul(weight, kept[i + usize::from(lane)]);
                then.push(self.e.add(begun, product));
            }
        }
        then
    }

    fn constant(&mut self, ty: ir::Type, x: f64) -> Number {
        let register = if ty == types::F64X2 { self.e.twice(x) } else { self.e.scalar(x) };
        self.e.same(register)
    }

    fn times(&mut self, ty: ir::Type, a: f64, x: Number) -> Number {
        let a = self.constant(ty, a);
        self.e.mul(a, x)
    }

    fn plus(&mut self, ty: ir::Type, to: Number, a: f64, x: Number) -> Number {
        let a = self.constant(ty, a);
        self.e.mul_add(false, a, x, to)
    }

    /// `eighth` of the solver's predictor.
    fn eighth(&mut self, ty: ir::Type, at: &[(usize, Number)]) -> Number {
        let [b0, b1, b2, b3] = numbers("BINOMIAL");
        let sum = |e: &mut Emitter<'_, '_>, i, j| {
            let [a, b] = [i, j].map(|j| found(at, j));
            e.add(a, b)
        };
        let inner = self.times(ty, b3, found(at, 4));
        let both = sum(self.e, 3, 5);
        let inner = self.plus(ty, inner, b2, both);
        let outer = self.times(ty, b0, found(at, 7));
        let both = sum(self.e, 2, 6);
        let outer = self.plus(ty, outer, b1, both);
        let outer = self.e.sub(outer, found(at, 8));
        self.e.add(inner, outer)
    }

    /// The weight of a difference: always the same, or the one that was chosen.
    fn weight(&mut self, stage: usize, ty: ir::Type, place: usize) -> Number {
        let Stage { step, marching, .. } = self.stages[stage];
        if !step.is_long {
            return self.constant(ty, numbers::<5>("WEIGHTS")[place]);
        }
        let (own, offset) =
            (self.e.ty(), field!(weights) + (place * size_of::<[f64; MACHINE_LANES]>()) as i32);
        let weight = self.e.load_as(own, Emitter::lasting(), marching, offset);
        if ty == own {
            return weight;
        }
        self.e.in_each([weight], |builder, [weight]| builder.ins().splat(ty, weight))
    }

    /// `earlier` of the solver's predictor.
    fn earlier(&mut self, stage: usize, ty: ir::Type, at: &[(usize, Number)]) -> Number {
        let [w0, w1, w2, w3, w4] = [0, 1, 2, 3, 4].map(|place| self.weight(stage, ty, place));
        let difference = |e: &mut Emitter<'_, '_>, pair: usize| {
            let j = PAIRS[pair];
            let [a, b] = [j, WINDOW - j].map(|j| found(at, j));
            e.sub(a, b)
        };
        let fourth = difference(self.e, 4);
        let inner = self.e.mul(w4, fourth);
        let third = difference(self.e, 3);
        let inner = self.e.mul_add(false, w3, third, inner);
        let second = difference(self.e, 2);
        let outer = self.e.mul(w2, second);
        let first = difference(self.e, 1);
        let outer = self.e.mul_add(false, w1, first, outer);
        let last = self.e.mul_add(true, w0, found(at, WINDOW - PAIRS[0]), found(at, WINDOW));
        let both = self.e.add(inner, outer);
        self.e.add(last, both)
    }
}

/// The solution so many steps before.
fn found(at: &[(usize, Number)], j: usize) -> Number {
    at.iter().find(|(known, _)| *known == j).map_or(at[0].1, |(_, value)| *value)
}
