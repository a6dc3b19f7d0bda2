//! Steps made of others, one after the other.

use std::boxed::Box;
use std::string::ToString;
use std::vec::Vec;

use super::system::System;
use crate::flat::{Method, NotGenerated, WriteInput};
use crate::method::{Counted, StageAccumulator};
use crate::retraction::RetractionKind;
use crate::scalar::Batch;
use crate::scheme::Rule;
use crate::schemes::Scheme;
use crate::snapshot::visit_flag;
use crate::system::Description;

/// Makes what takes the steps of a system with a scheme.
///
/// # Errors
/// If a step that it is made of was not generated.
pub(crate) fn method(
    scheme: &Scheme,
    system: &dyn System,
    step: f64,
) -> Result<Box<dyn Method<f64>>, NotGenerated> {
    let Description { name, invariant, .. } = system.description();
    let mut generated = |map, rule, step| {
        system.method(map, rule, step).ok_or_else(|| {
            // with a retraction, this one is generated for every system
            let has_map = system.method(map, Rule::Family(0, 1), step).is_some();
            let key = if has_map { "methods" } else { "retractions" };
            NotGenerated { scheme: scheme.to_string(), system: name, key }
        })
    };
    composed(scheme, invariant, step, &mut generated, &mut |map, step| system.pair(map, step))
}

/// The same; `generated` makes what takes steps that the macro generated, and `pair` of two of them, where they are one piece.
pub(super) fn composed<T: Batch, E>(
    scheme: &Scheme,
    invariant: bool,
    step: T,
    generated: &mut dyn FnMut(RetractionKind, Rule, T) -> Result<Box<dyn Method<T>>, E>,
    pair: &mut dyn FnMut(RetractionKind, T) -> Option<Box<dyn Method<T>>>,
) -> Result<Box<dyn Method<T>>, E> {
    match scheme.resolved(invariant) {
        Scheme::Step(map, rule) => generated(map, rule, step),
        Scheme::Composed(set, base) => {
            let part = |_, step| composed(&base, invariant, step, generated, pair);
            Ok(Box::new(Composition::new(set.gamma, step, part)?))
        }
        Scheme::StormerVerlet(map) | Scheme::Standard(map) => {
            if let Some(pair) = pair(map, step) {
                return Ok(pair);
            }
            let halves = [Rule::Family(0, 1), Rule::Family(1, 1)];
            let part = |place: usize, step| generated(map, halves[place], step);
            Ok(Box::new(Composition { is_pair: true, ..Composition::new(&[0.5, 0.5], step, part)? }))
        }
        Scheme::RightLift(base) => composed(&base, invariant, step, generated, pair),
    }
}

/// Stages of a step, each with its share of the length.
pub(super) struct Composition<T: Batch> {
    stages: Vec<Stage<T>>,
    /// The whole step.
    step: T,
    /// The state between two stages.
    between: Vec<T>,
    /// Whether all stages remember solutions of one and the same step.
    whole: bool,
    /// Whether they are a method and its adjoint: one step, over which one control is held.
    is_pair: bool,
}

/// A stage of a composed step.
struct Stage<T> {
    method: Box<dyn Method<T>>,
    /// How much of the whole it is.
    gamma: f64,
    /// The control over it, where the step is driven.
    input: Option<Vec<T>>,
}

impl<T: Batch> Composition<T> {
    /// Stages of a step, which `stage` makes of each one's place and length.
    pub(super) fn new<E>(
        gamma: &[f64],
        step: T,
        mut stage: impl FnMut(usize, T) -> Result<Box<dyn Method<T>>, E>,
    ) -> Result<Self, E> {
        let stages = gamma.iter().enumerate().map(|(place, &gamma)| {
            stage(place, step * T::of(gamma)).map(|method| Stage { method, gamma, input: None })
        });
        let stages = stages.collect::<Result<_, E>>()?;
        Ok(Self { stages, step, between: Vec::new(), whole: false, is_pair: false })
    }
}

impl<T: Batch> Method<T> for Composition<T> {
    fn rebuild(&mut self, parameters: &[T], step: T) {
        self.step = step;
        for stage in &mut self.stages {
            stage.method.rebuild(parameters, step * T::of(stage.gamma));
        }
    }

    fn advance(&mut self, state: &[T], next: &mut [T], time: T, control: &[T], known: bool) -> Counted<T> {
        let known = known && self.whole;
        // until all are through
        self.whole = false;
        self.between.resize(state.len(), T::of(0.0));
        // from one to the other, so that nothing is copied; the last stage writes to `next`
        let (mut to, mut other) = match self.stages.len() % 2 {
            0 => (&mut self.between[..], next),
            _ => (next, &mut self.between[..]),
        };
        // how much of the whole step is done
        let mut done = 0.0;
        let mut accumulator = StageAccumulator::<T>::new();
        for (place, stage) in self.stages.iter_mut().enumerate() {
            let from = if place == 0 { state } else { &*other };
            let start = time + T::of(done) * self.step;
            let control = stage.input.as_deref().unwrap_or(control);
            let outcome = stage.method.advance(from, to, start, control, known);
            accumulator.count(outcome)?;
            done += stage.gamma;
            core::mem::swap(&mut to, &mut other);
        }
        self.whole = true;
        accumulator.end(())
    }

    fn set_inputs(&mut self, controls: usize, mut inputs: Option<&mut WriteInput<'_, T>>) {
        if self.is_pair {
            return;
        }
        let mut done = 0.0;
        for stage in &mut self.stages {
            stage.input = None;
            match &mut inputs {
                Some(write) => {
                    let mut control = std::vec![T::of(0.0); controls];
                    write(done + 0.5 * stage.gamma, &mut control);
                    stage.input = Some(control);
                    let mut part = |share: f64, control: &mut [T]| write(done + stage.gamma * share, control);
                    stage.method.set_inputs(controls, Some(&mut part));
                }
                None => stage.method.set_inputs(controls, None),
            }
            done += stage.gamma;
        }
    }

    fn memory(&mut self, visit: &mut dyn FnMut(&mut [T])) {
        visit_flag(&mut self.whole, visit);
        self.stages.iter_mut().for_each(|stage| stage.method.memory(visit));
    }
}
