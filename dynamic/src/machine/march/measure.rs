//! How large numbers are, and changes of them.

use cranelift_codegen::ir::condcodes::FloatCC;

use super::super::emit::Number;
use super::{Emitter, March, Stage};

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
    pub(super) fn change(&mut self, stage: usize, from: &[Number], to: &[Number]) -> Number {
        let moved = self.each(to, from, Emitter::sub);
        self.relative(stage, &moved, to)
    }

    /// The sizes of blocks relative to those of another unknown, together.
    pub(super) fn relative(&mut self, stage: usize, of: &[Number], to: &[Number]) -> Number {
        let mut ratios = self.e.number(0.0);
        for block in self.blocks(stage) {
            let mut change = self.e.number(0.0);
            let mut size = self.e.number(f64::MIN_POSITIVE / f64::EPSILON);
            for i in block {
                change = self.and_magnitude(Some(change), of[i]);
                size = self.and_magnitude(Some(size), to[i]);
            }
            let ratio = self.e.div(change, size);
            ratios = self.e.add(ratios, ratio);
        }
        ratios
    }

    pub(super) fn and_magnitude(&mut self, sum: Option<Number>, x: Number) -> Number {
        // in one instruction, where the absolute value takes three
        let all_but_sign = self.e.number(f64::from_bits(u64::MAX >> 1));
        let magnitude = self.e.and(x, all_but_sign);
        match sum {
            None => magnitude,
            Some(sum) => self.e.add(sum, magnitude),
        }
    }

    /// Whether the numbers are finite, and their sum; none if there are none.
    pub(super) fn are_finite(&mut self, numbers: &[Number]) -> Option<Number> {
        let mut sums = [None; 4];
        for (place, number) in numbers.iter().enumerate() {
            let sum = &mut sums[place % 4];
            *sum = Some(match *sum {
                None => *number,
                Some(sum) => self.e.add(sum, *number),
            });
        }
        let sum = sums.into_iter().flatten().reduce(|a, b| self.e.add(a, b))?;
        let zero = self.e.number(0.0);
        let nothing = self.e.mul(zero, sum);
        Some(self.e.compare(FloatCC::LessThanOrEqual, nothing, zero))
    }
}
