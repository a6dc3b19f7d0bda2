//! Equations of steps, for certificates.

use std::boxed::Box;
use std::vec::Vec;

use super::system::At;
use crate::bytecode::{Machine, Wide};
use crate::flat::array;
use crate::kernel::{self, AtState, Corrected, Evaluation, Kernel, Program};
use crate::solve::Solver;

/// A step's equation at one state, on slices, for those who look at it closely.
pub trait Equation {
    /// A first approximation of the unknown; empty if the step is explicit.
    fn start(&self) -> Vec<f64>;
    /// The lengths of the blocks of unknowns, each of one unit.
    fn blocks(&self) -> &'static [usize];
    /// The residual at a value of the unknown, or the one given in its place, and the Newton correction for it.
    fn correction(&self, unknown: &[f64], residual: Option<&[f64]>) -> [Vec<f64>; 2];
    /// The solution. None if it is not found.
    fn solution(&self) -> Option<Vec<f64>>;
    /// The step as data, in which it can be taken in twice the digits.
    fn program(&self) -> Program;
}

/// Newton corrections in twice the digits: each of them adds nearly as many digits as a number has.
const REFINEMENTS: [u32; 2] = [3, 12];
/// A correction this small changes no digit that counts.
const NOTHING: f64 = 1e-26;

/// The state after the step and what its numbers leave out, from the equation solved in twice the digits; `rest` is what the numbers of the
/// state before it leave out. None if there is no solution to be found.
///
/// Residuals in twice the digits, corrections from Jacobians in one number: of the solver's rules of when to stop, this knows none.
pub(crate) fn converged(
    equation: &dyn Equation,
    parameters: &[f64],
    at: &At<'_>,
    rest: &[f64],
) -> Option<[Vec<f64>; 2]> {
    let blocks = equation.blocks();
    let state = widened(at.state, rest);
    let mut machine = Machine::new(equation.program(), &widened(parameters, &[]), Wide::exactly(at.step));
    machine.begin(&state, Wide::exactly(at.time), &widened(at.control, &[]));
    let mut unknown = widened(&equation.solution()?, &[]);
    let mut last = f64::INFINITY;
    for refinement in 0..REFINEMENTS[1] {
        let [residual, next] = machine.evaluate(&state, &unknown);
        if next.len() != state.len() {
            // there is no program
            return None;
        }
        let mut change = 0.0;
        if !unknown.is_empty() {
            let (here, residual) = (parts(&unknown, 0), parts(&residual, 0));
            let [_, correction] = equation.correction(&here, Some(&residual));
            change = relative(blocks, &correction, &here);
            for (x, correction) in unknown.iter_mut().zip(&correction) {
                *x = *x - Wide::exactly(*correction);
            }
        }
        // a block that is zero but for rounding never comes to rest relative to itself
        let rests = refinement >= REFINEMENTS[0] && change >= 0.25 * last;
        if change <= NOTHING || rests {
            return Some([parts(&next, 0), parts(&next, 1)]);
        }
        last = change;
    }
    None
}

/// Numbers with what they leave out, which is nothing where it is missing.
fn widened(numbers: &[f64], rest: &[f64]) -> Vec<Wide> {
    let rest = rest.iter().copied().chain(core::iter::repeat(0.0));
    numbers.iter().zip(rest).map(|(number, rest)| Wide::from_parts([*number, rest])).collect()
}

/// The nearest numbers, or what they leave out.
fn parts(wide: &[Wide], part: usize) -> Vec<f64> {
    wide.iter().map(|x| x.parts()[part]).collect()
}

/// How large numbers are next to others, in the block of these lengths where they are largest.
fn relative(blocks: &[usize], mut of: &[f64], mut to: &[f64]) -> f64 {
    let mut worst = 0.0_f64;
    for length in blocks {
        let (block, size);
        ((block, of), (size, to)) = (of.split_at(*length), to.split_at(*length));
        let norm = |numbers: &[f64]| numbers.iter().fold(f64::MIN_POSITIVE, |sum, x| sum + x.abs());
        worst = worst.max(norm(block) / norm(size));
    }
    worst
}

/// A kernel's equation, at a state.
struct KernelEquation<K: Kernel<f64>> {
    kernel: K,
    state: K::State,
    begun: K::Step,
}

/// The equation of a kernel at a state.
pub(crate) fn equation<K: Kernel<f64>>(
    parameters: &[f64],
    step: f64,
    state: &[f64],
    time: f64,
    control: &[f64],
) -> Box<dyn Equation> {
    let kernel: K = kernel::new(&array(parameters), step);
    let (state, control) = (array(state), array(control));
    let begun = kernel.begin(&state, time, &control);
    Box::new(([], KernelEquation { kernel, state, begun }))
}

impl<K: Kernel<f64>> Equation for ([K; 0], KernelEquation<K>) {
    fn start(&self) -> Vec<f64> {
        let (_, KernelEquation { kernel, state, begun }) = self;
        kernel.start(state, begun).as_ref().to_vec()
    }

    fn blocks(&self) -> &'static [usize] {
        K::BLOCKS
    }

    fn program(&self) -> Program {
        K::PROGRAM
    }

    fn correction(&self, unknown: &[f64], residual: Option<&[f64]>) -> [Vec<f64>; 2] {
        let (_, KernelEquation { kernel, state, begun: step }) = self;
        let residual = residual.map(array);
        let Evaluation { residual, iterate: correction, .. } =
            AtState { kernel, state, step }.corrected(&array(unknown), residual.as_ref());
        [residual.as_ref().to_vec(), correction.as_ref().to_vec()]
    }

    fn solution(&self) -> Option<Vec<f64>> {
        let (_, KernelEquation { kernel, state, begun }) = self;
        Solver::cold(kernel, state, begun).map(|unknown| unknown.as_ref().to_vec())
    }
}
