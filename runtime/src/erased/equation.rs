//! Equations of steps, for certificates.

use std::boxed::Box;
use std::vec::Vec;

use super::system::At;
use crate::bytecode::{self, Function, Given};
use crate::double::Double;
use crate::flat::array;
use crate::kernel::{self, AtState, Equation as _, Evaluation, Kernel};
use crate::scalar::{Components, Scalar};
use crate::solve;

/// The functions of a step that lead from one state to the next, as bytes.
pub type Program<'a> = [&'a [u8]; 4];

/// A step's equation at one state, on slices, for those who look at it closely.
pub trait Equation {
    /// A first approximation of the unknown; empty if the step is explicit.
    fn start(&self) -> Vec<f64>;
    /// The lengths of the blocks of unknowns, each of one unit.
    fn blocks(&self) -> &[usize];
    /// The residual at a value of the unknown, or the one given in its place, and the Newton correction for it.
    fn correction(&self, unknown: &[f64], residual: Option<&[f64]>) -> [Vec<f64>; 2];
    /// The solution. None if it is not found.
    fn solution(&self) -> Option<Vec<f64>>;
    /// Whether a value of the unknown is inside the retraction's domain.
    fn is_inside(&self, unknown: &[f64]) -> bool;
    /// The step as data, in which it can be taken in twice the digits, and how many places its values have.
    fn program(&self) -> (Program<'_>, usize);
}

/// A number of twice as many digits.
pub(super) type Wide = Double<f64>;

/// A step's program with all that it has computed so far, in such numbers.
pub(super) struct Machine<'a, N> {
    program: Program<'a>,
    places: Vec<N>,
}

impl<'a, N: Scalar> Machine<'a, N> {
    /// For these parameters and a step of this length.
    pub(super) fn new((program, places): (Program<'a>, usize), parameters: &[N], step: N) -> Self {
        let mut machine = Self { program, places: [N::of(0.0)].repeat(places) };
        machine.call(Function::New, |given, i| match given {
            Given::Parameters => parameters.get(i).copied(),
            Given::StepSize => Some(step),
            _ => None,
        });
        machine
    }

    /// Begins a step from a state.
    pub(super) fn begin(&mut self, state: &[N], time: N, control: &[N]) {
        self.call(Function::Begin, |given, i| match given {
            Given::State => state.get(i).copied(),
            Given::Time => Some(time),
            Given::Control => control.get(i).copied(),
            _ => None,
        });
    }

    /// The residual at a value of the unknown, and the state that this leads to from the one at which the step began.
    pub(super) fn evaluate(&mut self, state: &[N], unknown: &[N]) -> [Vec<N>; 2] {
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
    fn call(&mut self, function: Function, given: impl Fn(Given, usize) -> Option<N>) -> [Vec<N>; 2] {
        let mut results = [Vec::new(), Vec::new()];
        bytecode::run(self.program[function as usize], &mut self.places, &given, &mut |array, _, value| {
            if let Some(result) = results.get_mut(array) {
                result.push(value);
            }
        });
        results
    }
}

/// Numbers with what they leave out, which is nothing where it is missing.
pub(super) fn widened(numbers: &[f64], rest: &[f64]) -> Vec<Wide> {
    let rest = rest.iter().copied().chain(core::iter::repeat(0.0));
    numbers.iter().zip(rest).map(|(number, rest)| Wide::from_parts([*number, rest])).collect()
}

/// The nearest numbers, or what they leave out.
pub(super) fn parts(wide: &[Wide], part: usize) -> Vec<f64> {
    wide.iter().map(|x| x.parts()[part]).collect()
}

/// A kernel's equation, at a state.
struct KernelEquation<K: Kernel<f64>> {
    kernel: K,
    state: K::State,
    begun: K::Step,
}

/// The equation of a kernel at a state.
pub(crate) fn equation<K: Kernel<f64>>(parameters: &[f64], at: &At<'_>) -> Box<dyn Equation> {
    let At { step, state, time, control } = *at;
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

    fn blocks(&self) -> &[usize] {
        K::BLOCKS
    }

    fn program(&self) -> (Program<'_>, usize) {
        (K::PROGRAM, K::Places::<f64>::LENGTH)
    }

    fn correction(&self, unknown: &[f64], residual: Option<&[f64]>) -> [Vec<f64>; 2] {
        let (_, KernelEquation { kernel, state, begun: step }) = self;
        let residual = residual.map(array);
        let Evaluation { residual, iterate: correction, .. } =
            AtState { kernel, state, step }.corrected(&array(unknown), residual.as_ref());
        [residual.as_ref().to_vec(), correction.as_ref().to_vec()]
    }

    fn is_inside(&self, unknown: &[f64]) -> bool {
        let (_, KernelEquation { kernel, state, begun }) = self;
        let unknown = array(unknown);
        let evaluation = kernel.evaluate(state, begun, &unknown);
        kernel.domain(state, begun, &unknown, &evaluation).is_none_or(|margin| margin > 0.0)
    }

    fn solution(&self) -> Option<Vec<f64>> {
        let (_, KernelEquation { kernel, state, begun }) = self;
        solve::cold(&AtState { kernel, state, step: begun }).ok().map(|unknown| unknown.as_ref().to_vec())
    }
}
