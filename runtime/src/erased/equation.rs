//! Equations of steps, for certificates.

use std::boxed::Box;
use std::vec::Vec;

use super::system::At;
use crate::bytecode::{self, Function, Given};
use crate::double::Double;
use crate::flat::array;
use crate::kernel::{self, AtState, Equation as _, Evaluation, Kernel, Program};
use crate::scalar::{Components, Scalar};
use crate::solve;

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
    /// The step as data, in which it can be taken in twice the digits, and how many places its values have.
    fn program(&self) -> (Program, usize);
}

/// A number of twice as many digits.
type Wide = Double<f64>;

/// A step's program with all that it has computed so far.
struct Machine {
    program: Program,
    places: Vec<Wide>,
}

impl Machine {
    /// For these parameters and a step of this length.
    fn new((program, places): (Program, usize), parameters: &[Wide], step: Wide) -> Self {
        let mut machine = Self { program, places: [Wide::of(0.0)].repeat(places) };
        machine.call(Function::New, |given, i| match given {
            Given::Parameters => parameters.get(i).copied(),
            Given::StepSize => Some(step),
            _ => None,
        });
        machine
    }

    /// Begins a step from a state.
    fn begin(&mut self, state: &[Wide], time: Wide, control: &[Wide]) {
        self.call(Function::Begin, |given, i| match given {
            Given::State => state.get(i).copied(),
            Given::Time => Some(time),
            Given::Control => control.get(i).copied(),
            _ => None,
        });
    }

    /// The residual at a value of the unknown, and the state that this leads to from the one at which the step began.
    fn evaluate(&mut self, state: &[Wide], unknown: &[Wide]) -> [Vec<Wide>; 2] {
        let [residual, right] = self.call(Function::Evaluate, |given, i| match given {
            Given::State => state.get(i).copied(),
            Given::Unknown => unknown.get(i).copied(),
            _ => None,
        });
        let [next, _] = self.call(Function::Finish, |given, i| match given {
            Given::State => state.get(i).copied(),
            Given::Unknown => unknown.get(i).copied(),
            Given::Residual => residual.get(i).copied(),
            Given::Right => right.get(i).copied(),
            _ => None,
        });
        [residual, next]
    }

    /// Calls a function, which returns two arrays at most.
    fn call(&mut self, function: Function, given: impl Fn(Given, usize) -> Option<Wide>) -> [Vec<Wide>; 2] {
        let mut results = [Vec::new(), Vec::new()];
        bytecode::run(self.program[function as usize], &mut self.places, given, |array, _, value| {
            if let Some(result) = results.get_mut(array) {
                result.push(value);
            }
        });
        results
    }
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

    fn program(&self) -> (Program, usize) {
        (K::PROGRAM, K::Places::<f64>::LENGTH)
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
        solve::cold(&AtState { kernel, state, step: begun }).map(|unknown| unknown.as_ref().to_vec())
    }
}
