//! Schemes as values.

use std::boxed::Box;
use std::string::String;

use super::composition::Composition;
use super::system::{Description, System};
use crate::composition::{self, Coefficients, checked};
use crate::flat::{Method, NotGenerated};
use crate::retraction::Map;
use crate::scalar::Batch;
use crate::scheme::Rule;

/// A scheme as a value: what [`Stepper`](crate::Stepper) has as a type.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Scheme {
    /// The bare retraction: the system's [standard](crate::System::Standard) step of order 2.
    Standard(Map),
    /// A step that the macro generated.
    Step(Map, Rule),
    /// [`StormerVerlet`](crate::scheme::StormerVerlet)
    StormerVerlet(Map),
    /// A symmetric [composition](crate::composition) of steps with another scheme: see [`composed`](Self::composed).
    Composed(Composed),
}

/// A symmetric [composition](crate::composition) of steps with another scheme.
#[derive(Clone, Debug, PartialEq)]
pub struct Composed {
    /// The type of the coefficients.
    coefficients: &'static str,
    pub(crate) order: u32,
    gamma: &'static [f64],
    pub(crate) base: Box<Scheme>,
}

impl Scheme {
    /// The symmetric composition with coefficients `C` of steps with another scheme. Coefficients that are none do not compile: see
    /// [`Coefficients::GAMMA`].
    pub fn composed<C: Coefficients>(base: Self) -> Self {
        let gamma = const { checked(C::GAMMA) };
        let (coefficients, base) = (core::any::type_name::<C>(), Box::new(base));
        Self::Composed(Composed { coefficients, order: C::ORDER, gamma, base })
    }

    /// The member `s = numerator/denominator` of the family.
    pub const fn member(map: Map, numerator: u32, denominator: u32) -> Self {
        Self::Step(map, Rule::Member(numerator, denominator))
    }

    /// The same with what the standard step is of a system that is [invariant](crate::System::INVARIANT) or not: [`StormerVerlet`](Self::StormerVerlet)
    /// where the other one is not symmetric.
    pub fn resolved(&self, invariant: bool) -> Self {
        match self {
            Self::Standard(map) if invariant && map.is_matrix_function() => Self::member(*map, 0, 1),
            Self::Standard(map) => Self::StormerVerlet(*map),
            Self::Composed(composed) => {
                Self::Composed(Composed { base: Box::new(composed.base.resolved(invariant)), ..*composed })
            }
            other => other.clone(),
        }
    }

    /// What takes its steps of a system.
    ///
    /// # Errors
    /// If one that it is made of was not generated.
    pub(crate) fn of(&self, system: &dyn System, step: f64) -> Result<Box<dyn Method<f64>>, NotGenerated> {
        let Description { name, invariant, .. } = system.description();
        self.method(invariant, step, &mut |map, rule, step| {
            system.method(map, rule, step).ok_or_else(|| {
                // with a retraction, this one is generated for every system
                let has_map = system.method(map, Rule::Member(0, 1), step).is_some();
                let key = if has_map { "methods" } else { "retractions" };
                NotGenerated { scheme: self.name(), system: name, key }
            })
        })
    }

    /// What takes its steps; `generated` makes that of steps that the macro generated.
    pub(crate) fn method<T: Batch, E>(
        &self,
        invariant: bool,
        step: T,
        generated: &mut dyn FnMut(Map, Rule, T) -> Result<Box<dyn Method<T>>, E>,
    ) -> Result<Box<dyn Method<T>>, E> {
        match self.resolved(invariant) {
            Self::Step(map, rule) => generated(map, rule, step),
            Self::Composed(Composed { gamma, base, .. }) => {
                let part = |_, step| base.method(invariant, step, generated);
                Ok(Box::new(Composition::new(gamma, step, part)?))
            }
            Self::StormerVerlet(map) | Self::Standard(map) => {
                let halves = [Rule::Member(0, 1), Rule::Member(1, 1)];
                let part = |place: usize, step| generated(map, halves[place], step);
                Ok(Box::new(Composition::new(&[0.5, 0.5], step, part)?))
            }
        }
    }

    /// The generated steps that it is made of, and how long each one is.
    pub(crate) fn parts(&self, invariant: bool, step: f64, each: &mut dyn FnMut(Map, Rule, f64)) {
        match self.resolved(invariant) {
            Self::Step(map, rule) => each(map, rule, step),
            Self::Composed(Composed { gamma, base, .. }) => {
                gamma.iter().for_each(|gamma| base.parts(invariant, gamma * step, each));
            }
            Self::StormerVerlet(map) | Self::Standard(map) => {
                each(map, Rule::Member(0, 1), 0.5 * step);
                each(map, Rule::Member(1, 1), 0.5 * step);
            }
        }
    }

    /// As users write its type: `Midpoint<Cayley>`.
    pub fn name(&self) -> String {
        match self {
            Self::Standard(map) => std::format!("{map:?}"),
            Self::Step(map, Rule::Member(0, 1)) => std::format!("SymplecticEulerA<{map:?}>"),
            Self::Step(map, Rule::Member(1, 2)) => std::format!("Midpoint<{map:?}>"),
            Self::Step(map, Rule::Member(1, 1)) => std::format!("SymplecticEulerB<{map:?}>"),
            Self::Step(map, Rule::Member(n, d)) => std::format!("Family<{map:?}, {n}, {d}>"),
            Self::Step(map, Rule::TangentLift(0, 1)) => std::format!("TangentLift<{map:?}>"),
            Self::Step(map, Rule::TangentLift(1, 2)) => std::format!("TangentMidpoint<{map:?}>"),
            Self::Step(map, Rule::TangentLift(n, d)) => std::format!("TangentLift<{map:?}, {n}, {d}>"),
            Self::StormerVerlet(map) => std::format!("StormerVerlet<{map:?}>"),
            Self::Composed(Composed { coefficients, base, .. }) => {
                composition::name(coefficients, &base.name())
            }
        }
    }
}
