//! Methods on slices.

use std::boxed::Box;
use std::string::String;
use std::vec::Vec;

use thiserror::Error;

use crate::method::{self, Advanced, Clock, Counted, Failure, StepsReport};
use crate::scalar::{Batch, Components, Scalar};

/// Writes the control at a share of a step.
pub(crate) type WriteInput<'a, T> = dyn FnMut(f64, &mut [T]) + 'a;

/// What takes a step of one system with one scheme, on slices: [`method::Method`] with its type erased.
///
/// Slices have the lengths of the system's arrays.
pub trait Method<T: Batch>: Send + Sync {
    /// Takes other parameters and another step of numbers side by side; what is remembered of earlier steps stays.
    fn rebuild(&mut self, _parameters: &[T], _step: T) {}

    /// Writes the state after a step to `next`: see [`method::Method::advance`].
    ///
    /// # Errors
    /// As there; what stands in `next` then counts in the lanes that did not fail.
    fn advance(&mut self, state: &[T], next: &mut [T], time: T, control: &[T], known: bool) -> Counted<T>;

    /// Takes steps for as long as they are as most steps are, if any: see [`method::Method::advance_n`]. A step that fails in some lanes, and
    /// is not to be taken again, is returned; `next` is the state after it.
    fn advance_n(
        &mut self,
        _state: &mut [T],
        _next: &mut [T],
        _clock: Clock,
        _control: &[T],
        _most: u64,
    ) -> (StepsReport<T>, Option<Failure<T, ()>>) {
        (StepsReport::default(), None)
    }

    /// Holds over each step that it is made of its own control, as many numbers as there are `controls`, which the function writes to zeros: see
    /// [`method::Method::set_inputs`].
    fn set_inputs(&mut self, _controls: usize, _inputs: Option<&mut WriteInput<'_, T>>) {}

    /// Shows what is carried from step to step: see [`method::Method::memory`].
    fn memory(&mut self, visit: &mut dyn FnMut(&mut [T]));
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

/// Writes the state after a step.
#[inline(always)]
fn written<T: Batch, C: Components<T>>(next: &mut [T], advanced: Advanced<T, C>) -> Advanced<T, ()> {
    let Advanced { state, iterations, residual } = advanced;
    write(next, &state);
    Advanced { state: (), iterations, residual }
}

/// Writes the state after a step that failed in some lanes.
#[inline(always)]
fn failed<T: Batch, C: Components<T>>(next: &mut [T], failure: Failure<T, C>) -> Failure<T, ()> {
    let Failure { errors, advanced } = failure;
    Failure { errors, advanced: written(next, advanced) }
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

// with an empty array of its home, so that the compiler puts it there: see `OutOfLine`
impl<M: method::Method, const BATCHES: bool> Method<M::Scalar> for ([M::CallSite; 0], Flat<M, BATCHES>) {
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
        // in code that is there for many steps, too
        match self.1.0.advance_apart::<BATCHES>(&array(state), time, &array(control), known) {
            Ok(advanced) => Ok(written(next, advanced)),
            Err(failure) => Err(failed(next, failure)),
        }
    }

    fn advance_n(
        &mut self,
        state: &mut [M::Scalar],
        next: &mut [M::Scalar],
        clock: Clock,
        control: &[M::Scalar],
        most: u64,
    ) -> (StepsReport<M::Scalar>, Option<Failure<M::Scalar, ()>>) {
        if const { !BATCHES } {
            return (StepsReport::default(), None);
        }
        let (mut now, mut failure) = (array(state), None);
        let in_lanes = const { M::Scalar::LANES > 1 }.then_some(&mut failure);
        let marched = self.1.0.advance_n::<true>(&mut now, clock, &array(control), true, most, in_lanes);
        write(state, &now);
        (marched, failure.map(|failure| failed(next, failure)))
    }

    fn set_inputs(&mut self, _: usize, inputs: Option<&mut WriteInput<'_, M::Scalar>>) {
        match inputs {
            Some(write) => self.1.0.set_inputs(Some(&mut |share| {
                let mut control = M::Control::splat(M::Scalar::of(0.0));
                write(share, control.as_mut());
                control
            })),
            None => self.1.0.set_inputs(None),
        }
    }

    fn memory(&mut self, visit: &mut dyn FnMut(&mut [M::Scalar])) {
        self.1.0.memory(visit);
    }
}

/// A step that a scheme is made of and that was not generated.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error(
    "no step of the scheme `{scheme}` was generated for `{system}`; `{key}{}` in its description asks for it",
    if *key == "taylor" { "" } else { "(…)" }
)]
#[non_exhaustive]
pub struct NotGenerated {
    /// The scheme.
    pub scheme: String,
    /// The system's name.
    pub system: &'static str,
    /// The key of the description that asks for it: `methods`, `retractions` where it names another one, or `taylor`.
    pub key: &'static str,
}
