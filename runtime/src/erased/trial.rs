//! Steps on trial: their equations solved in twice the digits, and what rounding may leave of where they lead.
//!
//! That an equation has a solution, and which, is found here by other rules than the solver's: residuals in twice the
//! digits, corrections until they are nothing next to what rounding moves the solution by.
//!
//! What rounding may leave is a bound to first order. Of the residual it is the sum of what each operation rounds away,
//! magnified by those after it, from the parameters on; of the solution the inverse Jacobian's magnitude times that;
//! and of the next state what the solution's error brings, and what the operations do that lead there. A step that ends
//! within it is as good as one that is computed with these operations can be.

use std::vec::Vec;

use super::equation::{Equation, Machine, Wide, parts, widened};
use super::system::At;
use crate::scalar::Scalar;
use crate::scalar::bounded::Bounded;

/// Newton corrections from one place, at most.
const MOST: u32 = 60;
/// What is left of a correction, in units of what rounding moves the solution by, when it is one.
const NOTHING: f64 = 1e-6;
/// The same where corrections become no smaller: elementary functions have the digits of one number.
const LITTLE: f64 = 1.0;
/// In how many parts the step is continued.
const PARTS: [u32; 4] = [4, 16, 64, 256];
/// What is left of a correction, relative to the unknown, on the way.
const ON_THE_WAY: f64 = 1e-4;
/// How far a part of the way leads, relative to the unknown, at most: one that leads farther may have come to another
/// path.
const STRIDE: f64 = 0.25;
/// By how much more than rounding the unknown is moved, for its effect to stand out.
const MAGNIFIED: f64 = 65_536.0;
/// What is smaller has not its full precision.
const LEAST: f64 = f64::MIN_POSITIVE / f64::EPSILON;

/// A step from a state, on trial.
pub struct Trial<'a> {
    equation: &'a dyn Equation,
    state: Vec<Wide>,
    wide: Machine<'a, Wide>,
    bounded: Machine<'a, Bounded<f64>>,
}

/// A solution of a step's equation in twice the digits.
#[derive(Clone, Debug)]
pub struct Solved {
    unknown: Vec<Wide>,
    next: Vec<Wide>,
    /// Whether it is inside the retraction's domain, and the state that it leads to is finite.
    pub is_good: bool,
}

impl Solved {
    /// The state that it leads to, and what its numbers leave out.
    pub fn next(&self) -> [Vec<f64>; 2] {
        [parts(&self.next, 0), parts(&self.next, 1)]
    }
}

/// How far a step has ended from where it should have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Units {
    /// In units of what rounding may leave, in the block where that is most.
    pub of_rounding: f64,
    /// The number of that block.
    pub block: usize,
    /// What rounding may leave of it, relative to its largest number.
    pub allowed: f64,
}

/// How far a state is from the one to which a solution leads, in these blocks of numbers of one unit each: the digits of
/// a block are those of its largest number.
pub fn units(next: &[f64], [end, left]: &[Vec<f64>; 2], allowed: &[f64], blocks: &[Vec<usize>]) -> Units {
    let mut worst = Units { of_rounding: 0.0, block: 0, allowed: 0.0 };
    for (block, places) in blocks.iter().enumerate() {
        let most = |of: &dyn Fn(usize) -> f64| {
            places.iter().fold(0.0, |most: f64, i| if of(*i) <= most { most } else { of(*i) })
        };
        let off = most(&|i| ((next[i] - end[i]) - left[i]).abs());
        let (allowed, size) = (most(&|i| allowed[i]), most(&|i| next[i].abs()));
        let of_rounding = off / allowed.max(f64::EPSILON * LEAST);
        if !(of_rounding <= worst.of_rounding) {
            worst = Units { of_rounding, block, allowed: allowed / size.max(LEAST) };
        }
    }
    worst
}

fn exactly(numbers: &[f64]) -> Vec<Bounded<f64>> {
    numbers.iter().map(|x| Bounded::exactly(*x)).collect()
}

impl<'a> Trial<'a> {
    /// Of the step that solves this equation; `rest` is what the numbers of the state leave out.
    pub fn new(equation: &'a dyn Equation, parameters: &[f64], at: &At<'_>, rest: &[f64]) -> Self {
        let At { step, state, time, control } = *at;
        let mut wide = Machine::new(equation.program(), &widened(parameters, &[]), Wide::exactly(step));
        let from = widened(state, rest);
        wide.begin(&from, Wide::exactly(time), &widened(control, &[]));
        let mut bounded = Machine::new(equation.program(), &exactly(parameters), Bounded::exactly(step));
        bounded.begin(&exactly(state), Bounded::exactly(time), &exactly(control));
        Self { equation, state: from, wide, bounded }
    }

    /// The solution to which Newton's method leads from the first approximation.
    pub fn directly(&mut self) -> Option<Solved> {
        let start = widened(&self.equation.start(), &[]);
        self.solved(start)
    }

    /// The solution to which a path leads along which the residual at the first approximation is taken away, part by
    /// part.
    pub fn continued(&mut self) -> Option<Solved> {
        PARTS.into_iter().find_map(|count| {
            let end = self.path(count)?;
            let solved = self.solved(end.clone())?;
            let [before, after] = [&end, &solved.unknown].map(|unknown| parts(unknown, 0));
            let by: Vec<f64> = after.iter().zip(&before).map(|(after, before)| after - before).collect();
            (stride(self.equation.blocks(), &by, &before, &after) <= STRIDE).then_some(solved)
        })
    }

    /// The solution that the solver finds from nothing that is remembered, with the digits that it leaves out.
    pub fn as_solver(&mut self) -> Option<Solved> {
        let unknown = widened(&self.equation.solution()?, &[]);
        self.solved(unknown)
    }

    /// What rounding may leave of each number of the state to which a solution leads.
    pub fn allowed(&mut self, solved: &Solved) -> Vec<f64> {
        let here = parts(&solved.unknown, 0);
        let [_, mut allowed] = self.rounding(&here);
        let Some(moved) = self.moved(&here) else { return std::vec![f64::INFINITY; allowed.len()] };
        for moved in moved {
            let there = plus(&solved.unknown, MAGNIFIED, &moved);
            let [_, end] = self.wide.evaluate(&self.state, &there);
            for ((allowed, end), next) in allowed.iter_mut().zip(end).zip(&solved.next) {
                *allowed += (end - *next).parts()[0].abs() / MAGNIFIED;
            }
        }
        allowed
    }

    /// Whether two solutions are the same, as far as rounding lets them be told apart.
    pub fn is_same(&mut self, one: &Solved, other: &Solved) -> bool {
        let [a, b] = [one, other].map(|solved| parts(&solved.unknown, 0));
        let Some(uncertain) = self.uncertain(&a) else { return false };
        let off: Vec<f64> = a.iter().zip(&b).map(|(a, b)| a - b).collect();
        let blocks = self.equation.blocks();
        let (off, size, uncertain) = (sums(blocks, &off), sums(blocks, &a), sums(blocks, &uncertain));
        off.iter().zip(&size).zip(&uncertain).all(|((off, size), u)| *off <= (1e-9 * size).max(8.0 * u))
    }

    /// What rounding may leave of the residual, and of the next state, if the unknown has no more digits than a number.
    fn rounding(&mut self, unknown: &[f64]) -> [Vec<f64>; 2] {
        let unknown: Vec<_> = unknown.iter().map(|x| Bounded::nearest(*x)).collect();
        let state = exactly(&parts(&self.state, 0));
        let ends = self.bounded.evaluate(&state, &unknown);
        ends.map(|end| end.iter().map(|x| f64::EPSILON * x.error).collect())
    }

    /// Where the rounding of each component of the residual, as much as in its whole block, moves the solution, and
    /// that of each component of the unknown: blocks are solved to the digits of their largest numbers. None where the
    /// Jacobian is singular.
    fn moved(&mut self, unknown: &[f64]) -> Option<Vec<Vec<f64>>> {
        let [residual, _] = self.rounding(unknown);
        let blocks = self.equation.blocks();
        let (residual, sizes) = (sums(blocks, &residual), sums(blocks, unknown));
        let mut moved = Vec::new();
        let mut from = 0;
        for (length, (residual, size)) in blocks.iter().zip(residual.iter().zip(sizes)) {
            for i in from..from + length {
                let mut one = std::vec![0.0; unknown.len()];
                one[i] = *residual;
                let [_, by] = self.equation.correction(unknown, Some(&one));
                if !by.iter().all(|x| x.is_finite()) {
                    return None;
                }
                moved.push(by);
                one[i] = 0.5 * f64::EPSILON * size;
                moved.push(one);
            }
            from += length;
        }
        Some(moved)
    }

    /// How far rounding moves each component of the solution.
    fn uncertain(&mut self, unknown: &[f64]) -> Option<Vec<f64>> {
        let mut sum = std::vec![0.0; unknown.len()];
        for moved in self.moved(unknown)? {
            sum.iter_mut().zip(moved).for_each(|(sum, x)| *sum += x.abs());
        }
        Some(sum)
    }

    /// The solution by Newton's method, from there.
    fn solved(&mut self, mut unknown: Vec<Wide>) -> Option<Solved> {
        let blocks = self.equation.blocks();
        let mut last = f64::INFINITY;
        for _ in 0..MOST {
            let [residual, next] = self.wide.evaluate(&self.state, &unknown);
            if next.len() != self.state.len() {
                // there is no program
                return None;
            }
            let here = parts(&unknown, 0);
            let [_, correction] = self.equation.correction(&here, Some(&parts(&residual, 0)));
            if !correction.iter().chain(&here).all(|x| x.is_finite()) {
                return None;
            }
            let uncertain = sums(blocks, &self.uncertain(&here)?);
            let left = sums(blocks, &correction)
                .iter()
                .zip(&uncertain)
                .fold(0.0_f64, |left, (correction, u)| left.max(correction / u.max(f64::EPSILON * LEAST)));
            unknown = plus(&unknown, -1.0, &correction);
            if left <= NOTHING || (left <= LITTLE && left >= 0.25 * last) || here.is_empty() {
                let [_, next] = self.wide.evaluate(&self.state, &unknown);
                let is_finite = parts(&next, 0).iter().all(|x| x.is_finite());
                let is_good = is_finite && self.equation.is_inside(&parts(&unknown, 0));
                return Some(Solved { unknown, next, is_good });
            }
            last = left;
        }
        None
    }

    /// Where so many parts of a path lead to.
    fn path(&mut self, count: u32) -> Option<Vec<Wide>> {
        let blocks = self.equation.blocks();
        let mut unknown = widened(&self.equation.start(), &[]);
        let [first, _] = self.wide.evaluate(&self.state, &unknown);
        let first = parts(&first, 0);
        for part in 1..count {
            let left = 1.0 - f64::from(part) / f64::from(count);
            let (mut last, mut is_first) = (f64::INFINITY, true);
            loop {
                let [residual, _] = self.wide.evaluate(&self.state, &unknown);
                let residual = parts(&plus(&residual, -left, &first), 0);
                let here = parts(&unknown, 0);
                let [_, correction] = self.equation.correction(&here, Some(&residual));
                unknown = plus(&unknown, -1.0, &correction);
                let moves = stride(blocks, &correction, &here, &parts(&unknown, 0));
                let strides = is_first && part > 1 && moves > STRIDE;
                if strides || !(moves < last || moves <= ON_THE_WAY) {
                    return None;
                }
                (last, is_first) = (moves, false);
                if moves <= ON_THE_WAY {
                    break;
                }
            }
        }
        Some(unknown)
    }
}

/// `x + factor · by`
fn plus(x: &[Wide], factor: f64, by: &[f64]) -> Vec<Wide> {
    x.iter().zip(by).map(|(x, by)| *x + Wide::exactly(*by) * Wide::of(factor)).collect()
}

/// How far a correction leads, relative to the larger one of the unknowns before and after it, in the block where that is most.
fn stride(blocks: &[usize], by: &[f64], before: &[f64], after: &[f64]) -> f64 {
    let sizes = sums(blocks, before).into_iter().zip(sums(blocks, after));
    sums(blocks, by)
        .iter()
        .zip(sizes)
        .fold(0.0_f64, |most, (by, (before, after))| most.max(by / before.max(after).max(LEAST)))
}

/// The sums of magnitudes in blocks of these lengths.
fn sums(blocks: &[usize], mut numbers: &[f64]) -> Vec<f64> {
    let block = |length: &usize| {
        let (block, rest) = numbers.split_at((*length).min(numbers.len()));
        numbers = rest;
        block.iter().fold(0.0, |sum, x| sum + x.abs())
    };
    blocks.iter().map(block).collect()
}
