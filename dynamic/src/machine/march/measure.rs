//! How large numbers are, and changes of them.

use cranelift_codegen::ir::condcodes::FloatCC;
use cranelift_codegen::ir::{self, InstBuilder};

use super::{March, Stage};

impl March<'_, '_, '_> {
    /// The places of the blocks of unknowns.
    pub(super) fn blocks(&self, stage: usize) -> Vec<std::ops::Range<usize>> {
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
    pub(super) fn change(&mut self, stage: usize, from: &[ir::Value], to: &[ir::Value]) -> ir::Value {
        let moved = self.each(to, from, |e, to, from| e.builder.ins().fsub(to, from));
        self.relative(stage, &moved, to)
    }

    /// The sizes of blocks relative to those of another unknown, together.
    pub(super) fn relative(&mut self, stage: usize, of: &[ir::Value], to: &[ir::Value]) -> ir::Value {
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

    pub(super) fn and_magnitude(&mut self, sum: Option<ir::Value>, x: ir::Value) -> ir::Value {
        // in one instruction, where the absolute value takes three
        let all_but_sign = self.e.number(f64::from_bits(u64::MAX >> 1));
        let magnitude = self.e.builder.ins().band(x, all_but_sign);
        match sum {
            None => magnitude,
            Some(sum) => self.e.builder.ins().fadd(sum, magnitude),
        }
    }

    /// Whether the numbers are finite, and their sum; none if there are none.
    pub(super) fn are_finite(&mut self, numbers: &[ir::Value]) -> Option<ir::Value> {
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
}
