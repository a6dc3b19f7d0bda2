//! Steps made of others, one after the other.

use std::boxed::Box;
use std::vec::Vec;

use super::method::Method;
use crate::memory::visit_flag;
use crate::method::{Clock, Counted, Course, Marched};
use crate::scalar::Batch;

/// Parts of a step, each a part of its length.
pub(super) struct Composition<T: Batch> {
    parts: Vec<Part<T>>,
    /// The whole step.
    step: T,
    /// The state between two parts.
    between: Vec<T>,
    /// Whether all parts remember solutions of one and the same step.
    whole: bool,
}

/// A part of a step.
struct Part<T> {
    method: Box<dyn Method<T>>,
    /// How much of the whole it is.
    gamma: f64,
}

impl<T: Batch> Composition<T> {
    /// Parts of a step, which `part` makes of each one's place and length.
    pub(super) fn new<E>(
        gamma: &[f64],
        step: T,
        mut part: impl FnMut(usize, T) -> Result<Box<dyn Method<T>>, E>,
    ) -> Result<Self, E> {
        let parts = gamma
            .iter()
            .enumerate()
            .map(|(place, &gamma)| part(place, step * T::of(gamma)).map(|method| Part { method, gamma }));
        Ok(Self { parts: parts.collect::<Result<_, E>>()?, step, between: Vec::new(), whole: false })
    }
}

impl<T: Batch> Method<T> for Composition<T> {
    fn rebuild(&mut self, parameters: &[T], step: T) {
        self.step = step;
        for part in &mut self.parts {
            part.method.rebuild(parameters, step * T::of(part.gamma));
        }
    }

    fn advance(&mut self, state: &[T], next: &mut [T], time: T, control: &[T], known: bool) -> Counted<T> {
        let known = known && self.whole;
        // until all are through
        self.whole = false;
        self.between.resize(state.len(), T::of(0.0));
        // from one to the other, so that nothing is copied; the last part writes to `next`
        let (mut to, mut other) = match self.parts.len() % 2 {
            0 => (&mut self.between[..], next),
            _ => (next, &mut self.between[..]),
        };
        // how much of the whole step is done
        let mut done = 0.0;
        let mut course = Course::<T>::new();
        for (place, part) in self.parts.iter_mut().enumerate() {
            let from = if place == 0 { state } else { &*other };
            let start = time + T::of(done) * self.step;
            let outcome = part.method.advance(from, to, start, control, known);
            course.count(outcome)?;
            done += part.gamma;
            core::mem::swap(&mut to, &mut other);
        }
        self.whole = true;
        course.outcome()
    }

    fn march(&mut self, _: &mut [T], _: Clock, _: &[T], _: u64) -> Marched<T> {
        Marched::default()
    }

    fn memory(&mut self, visit: &mut dyn FnMut(&mut [T])) {
        visit_flag(&mut self.whole, visit);
        self.parts.iter_mut().for_each(|part| part.method.memory(visit));
    }
}
