//! Methods on slices.

use std::boxed::Box;
use std::vec::Vec;

use crate::double::Double;
use crate::error::StepError;
use crate::kernel::{Components, Kernel};
use crate::method::{self, Advanced, Clock, Counted, Outcome, StepsReport};
use crate::scalar::{Batch, Mask, Scalar, Work};
use crate::solve::Solver;

/// What takes a step of one system with one scheme, on slices: [`method::Method`] with its type erased.
///
/// Slices have the lengths of the system's arrays.
pub trait Method<T: Batch>: Send + Sync {
    /// Takes other parameters and another step of numbers side by side; what is remembered of earlier steps stays.
    fn rebuild(&mut self, parameters: &[T], step: T);

    /// Writes the state after a step to `next`: see [`method::Method::advance`].
    ///
    /// # Errors
    /// As there; what stands in `next` then counts in the lanes that did not fail.
    fn advance(&mut self, state: &[T], next: &mut [T], time: T, control: &[T], known: bool) -> Counted<T>;

    /// Takes steps for as long as they are as most steps are: see [`method::Method::advance_n`].
    fn advance_n(&mut self, state: &mut [T], clock: Clock, control: &[T], most: u64) -> StepsReport<T>;

    /// Shows what is carried from step to step: see [`method::Method::memory`].
    fn memory(&mut self, visit: &mut dyn FnMut(&mut [T]));
}

/// The error of a step of one state that could not be taken.
pub(crate) fn of_only_lane(errors: [Option<StepError>; 1]) -> StepError {
    // it has failed
    errors.into_iter().flatten().next().unwrap_or(StepError::NotFinite)
}

/// The array of these numbers. What is missing is zero.
#[inline(always)]
pub(crate) fn array<T: Scalar, C: Components<T>>(numbers: &[T]) -> C {
    let mut array = C::splat(T::of(0.0));
    match numbers.get(..C::LENGTH) {
        // as many as the compiler knows: a few moves of whole registers
        Some(numbers) => array.as_mut().copy_from_slice(numbers),
        None => copy(array.as_mut(), numbers),
    }
    array
}

/// Copies as many numbers as there is room for. Not inlined: it is not called where the lengths are the same.
#[inline(never)]
pub(crate) fn copy<T: Copy>(to: &mut [T], from: &[T]) {
    to.iter_mut().zip(from).for_each(|(to, from)| *to = *from);
}

/// Writes the array to as many numbers, or to as many as there is room for.
#[inline(always)]
fn write<T: Scalar, C: Components<T>>(to: &mut [T], array: &C) {
    match to.get_mut(..C::LENGTH) {
        Some(to) => to.copy_from_slice(array.as_ref()),
        None => copy(to, array.as_ref()),
    }
}

/// A method on arrays as one on slices. `BATCHES`: whether steps are also compiled to be taken together, for what the processor turns out
/// to have; without, they are taken one by one.
pub struct Flat<M, const BATCHES: bool>(M);

impl<M: method::Method, const BATCHES: bool> Flat<M, BATCHES> {
    /// The method for these parameters and this step.
    pub fn boxed(parameters: &[M::Scalar], step: M::Scalar) -> Box<dyn Method<M::Scalar>>
    where
        M: 'static,
    {
        Box::new(([], Self(M::new(&array(parameters), step))))
    }
}

/// A step of a method.
struct Step<'a, M: method::Method> {
    method: &'a mut M,
    state: &'a M::State,
    time: M::Scalar,
    control: &'a M::Control,
    known: bool,
}

impl<M: method::Method> Work for Step<'_, M> {
    type Home = M::Home;
    type Result = Outcome<M::Scalar, M::State>;

    #[inline(always)]
    fn done(self) -> Self::Result {
        let Self { method, state, time, control, known } = self;
        method.advance(state, time, control, known)
    }
}

// with an empty array of its home, so that the compiler puts it there: see `OutOfLine`
impl<M: method::Method, const BATCHES: bool> Method<M::Scalar> for ([M::Home; 0], Flat<M, BATCHES>) {
    fn rebuild(&mut self, parameters: &[M::Scalar], step: M::Scalar) {
        if const { M::Scalar::LANES == 1 } {
            // where there is one member, none takes another's place
            return;
        }
        let mut new = M::new(&array(parameters), step);
        // the memory of the old one, piece by piece
        let mut memory = Vec::new();
        self.1.0.memory(&mut |piece| memory.extend_from_slice(piece));
        let mut memory = memory.into_iter();
        new.memory(&mut |piece| piece.iter_mut().zip(&mut memory).for_each(|(x, value)| *x = value));
        self.1.0 = new;
    }

    fn advance(
        &mut self,
        state: &[M::Scalar],
        next: &mut [M::Scalar],
        time: M::Scalar,
        control: &[M::Scalar],
        known: bool,
    ) -> Counted<M::Scalar> {
        let step =
            Step { method: &mut self.1.0, state: &array(state), time, control: &array(control), known };
        // numbers side by side need the instructions that they are made for
        let outcome = if const { M::Scalar::LANES > 1 } { M::Scalar::dispatch(step) } else { step.done() };
        match outcome {
            Ok(Advanced { state, iterations, residual }) => {
                write(next, &state);
                Ok((iterations, residual))
            }
            Err(failure) => {
                write(next, &failure.advanced.state);
                Err(failure.errors)
            }
        }
    }

    fn advance_n(
        &mut self,
        state: &mut [M::Scalar],
        clock: Clock,
        control: &[M::Scalar],
        most: u64,
    ) -> StepsReport<M::Scalar> {
        if const { !BATCHES } {
            return StepsReport::default();
        }
        let mut now = array(state);
        let marched = self.1.0.advance_n(&mut now, clock, &array(control), most);
        write(state, &now);
        marched
    }

    fn memory(&mut self, visit: &mut dyn FnMut(&mut [M::Scalar])) {
        self.1.0.memory(visit);
    }
}

/// A step's equation at one state, on slices, for those who look at it closely.
pub trait Equation {
    /// A first approximation of the unknown; empty if the step is explicit.
    fn start(&self) -> Vec<f64>;
    /// The residual at a value of the unknown.
    fn residual(&self, unknown: &[f64]) -> Vec<f64>;
    /// The Newton correction there.
    fn correction(&self, unknown: &[f64]) -> Vec<f64>;
    /// The state after the step and what its numbers leave out, from the equation solved in twice the digits; `rest` is what the numbers of the
    /// state before it leave out. None if there is no solution to be found.
    fn converged(&self, rest: &[f64]) -> Option<[Vec<f64>; 2]>;
}

/// Newton corrections in twice the digits: each of them adds nearly as many digits as a number has.
const REFINEMENTS: [u32; 2] = [3, 12];
/// A correction this small changes no digit that counts.
const NOTHING: f64 = 1e-26;

/// A kernel's equation, at a state; `W` is the same kernel over twice the digits.
struct KernelEquation<K: Kernel<f64>, W: Kernel<Double<f64>>> {
    kernel: K,
    state: K::State,
    begun: K::Step,
    time: f64,
    control: K::Control,
    wide: W,
}

/// The equation of a kernel at a state.
pub(crate) fn equation<K, W>(
    parameters: &[f64],
    step: f64,
    state: &[f64],
    time: f64,
    control: &[f64],
) -> Box<dyn Equation>
where
    K: Kernel<f64> + 'static,
    W: Kernel<Double<f64>> + 'static,
{
    let (kernel, state, control) = (K::new(&array(parameters), step), array(state), array(control));
    let begun = kernel.begin(&state, time, &control);
    let wide = W::new(&widened(parameters, &[]), Double::exactly(step));
    Box::new(([], KernelEquation { kernel, state, begun, time, control, wide }))
}

/// The sums of numbers and what they leave out, as an array. What is missing is zero.
fn widened<C: Components<Double<f64>>>(numbers: &[f64], rest: &[f64]) -> C {
    let mut wide = C::splat(Double::exactly(0.0));
    let rest = rest.iter().copied().chain(core::iter::repeat(0.0));
    for ((wide, number), rest) in wide.as_mut().iter_mut().zip(numbers).zip(rest) {
        *wide = Double::from_parts([*number, rest]);
    }
    wide
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

/// The nearest numbers.
fn nearest<C: Components<f64>>(wide: &[Double<f64>]) -> C {
    let mut nearest = C::splat(0.0);
    for (number, wide) in nearest.as_mut().iter_mut().zip(wide) {
        [*number, _] = wide.parts();
    }
    nearest
}

impl<K: Kernel<f64>, W: Kernel<Double<f64>>> Equation for ([K; 0], KernelEquation<K, W>) {
    fn start(&self) -> Vec<f64> {
        let (_, KernelEquation { kernel, state, begun, .. }) = self;
        kernel.start(state, begun).as_ref().to_vec()
    }

    fn residual(&self, unknown: &[f64]) -> Vec<f64> {
        let (_, KernelEquation { kernel, state, begun, .. }) = self;
        kernel.evaluate(state, begun, &array(unknown)).residual.as_ref().to_vec()
    }

    fn correction(&self, unknown: &[f64]) -> Vec<f64> {
        let (_, KernelEquation { kernel, state, begun, .. }) = self;
        let unknown = array(unknown);
        let evaluation = kernel.evaluate(state, begun, &unknown);
        kernel.correction(state, begun, &unknown, &evaluation).as_ref().to_vec()
    }

    // Residuals in twice the digits, corrections from Jacobians in one number: of the solver's rules of when to stop, it knows none.
    fn converged(&self, rest: &[f64]) -> Option<[Vec<f64>; 2]> {
        let (_, KernelEquation { kernel, state, begun, time, control, wide }) = self;
        let cold = Solver::<f64, K::Unknown>::default();
        let solution = cold.solve(kernel, state, begun, None);
        if solution.unsolved.any() {
            return None;
        }
        let wide_state: W::State = widened(state.as_ref(), rest);
        let wide_begun = wide.begin(&wide_state, Double::exactly(*time), &widened(control.as_ref(), &[]));
        let mut unknown: W::Unknown = widened(solution.unknown.as_ref(), &[]);
        let mut last = f64::INFINITY;
        for refinement in 0..REFINEMENTS[1] {
            let evaluation = wide.evaluate(&wide_state, &wide_begun, &unknown);
            let here: K::Unknown = nearest(unknown.as_ref());
            let mut there = kernel.evaluate(state, begun, &here);
            there.residual = nearest(evaluation.residual.as_ref());
            let mut change = 0.0;
            if K::Unknown::LENGTH > 0 {
                let correction = kernel.correction(state, begun, &here, &there);
                change = relative(K::BLOCKS, correction.as_ref(), here.as_ref());
                for (x, correction) in unknown.as_mut().iter_mut().zip(correction.as_ref()) {
                    *x = *x - Double::exactly(*correction);
                }
            }
            // a block that is zero but for rounding never comes to rest relative to itself
            let rests = refinement >= REFINEMENTS[0] && change >= 0.25 * last;
            if change <= NOTHING || rests {
                let next = wide.finish(&wide_state, &wide_begun, &unknown, &evaluation);
                let parts = |k: usize| next.as_ref().iter().map(|x| x.parts()[k]).collect();
                return Some([parts(0), parts(1)]);
            }
            last = change;
        }
        None
    }
}
