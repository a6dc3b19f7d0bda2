//! Schemes as values.

use core::any::type_name;
use core::fmt;
use core::str::FromStr;
use std::boxed::Box;
use std::string::{String, ToString};
use std::vec::Vec;

use thiserror::Error;

use crate::composition::{Coefficients, Composed, KahanLi6, KahanLi8, SofroniouSpaletta10, Suzuki4, checked};
use crate::retraction::{Retraction, RetractionKind};
use crate::scheme::{Base, Parameter, RightLift, Rule, Rules, StormerVerlet};
use crate::system::Description;

/// A scheme as a value: what [`Stepper`](crate::Stepper) has as a type.
///
/// It is written as its type is, and read so: `Midpoint<Cayley>`; serde writes and reads it as that text.
///
/// ```
/// use coadjoint::prelude::*;
/// use coadjoint::{Scheme, SchemeType};
///
/// let scheme: Scheme = "Order4<Midpoint<Cayley>>".parse()?;
/// assert_eq!(scheme, Order4::<Midpoint<Cayley>>::scheme());
/// assert_eq!(scheme.to_string(), "Order4<Midpoint<Cayley>>");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Scheme {
    /// The bare retraction: the system's [standard](crate::System::Standard) step of order 2.
    Standard(RetractionKind),
    /// A step that the macro generated.
    Step(RetractionKind, Rule),
    /// [`StormerVerlet`]
    StormerVerlet(RetractionKind),
    /// A symmetric [composition](crate::composition) of steps with another scheme.
    Composed(CoefficientSet, Box<Scheme>),
    /// [`RightLift`]; steppers whose types are erased take the steps of the scheme that it lifts, which are the same map.
    RightLift(Box<Scheme>),
}

/// The coefficients of a symmetric composition, as a value.
#[doc(hidden)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoefficientSet {
    /// The name of their type.
    name: &'static str,
    /// The order of the composition of symmetric steps of order 2.
    order: u32,
    /// The `γᵢ`, one for each step.
    pub(crate) gamma: &'static [f64],
}

impl CoefficientSet {
    fn of<C: Coefficients>() -> Self {
        Self { name: type_name::<C>(), order: C::ORDER, gamma: const { checked(C::GAMMA) } }
    }

    /// Those that have a name of their own, with the name of compositions with them.
    fn named() -> [(&'static str, Self); 4] {
        [
            ("Order4", Self::of::<Suzuki4>()),
            ("Order6", Self::of::<KahanLi6>()),
            ("Order8", Self::of::<KahanLi8>()),
            ("Order10", Self::of::<SofroniouSpaletta10>()),
        ]
    }
}

/// A scheme as a type.
pub trait SchemeType: 'static {
    /// Returns the scheme as a value.
    fn scheme() -> Scheme;
}

impl<M: Base> SchemeType for M {
    fn scheme() -> Scheme {
        Scheme::Step(M::MAP, M::RULE)
    }
}

impl<R: Retraction + 'static> SchemeType for StormerVerlet<R> {
    fn scheme() -> Scheme {
        Scheme::StormerVerlet(R::MAP)
    }
}

impl<M: SchemeType> SchemeType for RightLift<M> {
    fn scheme() -> Scheme {
        Scheme::RightLift(Box::new(M::scheme()))
    }
}

impl<C: Coefficients + 'static, M: SchemeType> SchemeType for Composed<C, M> {
    fn scheme() -> Scheme {
        Scheme::composed::<C>(M::scheme())
    }
}

/// A generated step that a scheme is made of: its retraction, its rule, and its length.
pub(crate) type Part = (RetractionKind, Rule, f64);

impl Scheme {
    /// Returns the member `s = numerator/denominator` of the [family](crate::scheme::Family).
    pub const fn member(map: RetractionKind, numerator: u32, denominator: u32) -> Self {
        Self::Step(map, Rule::Family(numerator, denominator))
    }

    /// Returns the symmetric composition with coefficients `C` of steps with another scheme. Coefficients that are none do not compile: see
    /// [`Coefficients::GAMMA`].
    pub fn composed<C: Coefficients>(base: Self) -> Self {
        Self::Composed(CoefficientSet::of::<C>(), Box::new(base))
    }

    /// Replaces bare retractions by what they stand for, for systems that are [invariant](crate::System::INVARIANT) or not.
    pub fn resolved(&self, invariant: bool) -> Self {
        match self {
            Self::Standard(map) if invariant && map.is_odd() => Self::member(*map, 0, 1),
            Self::Standard(map) => Self::StormerVerlet(*map),
            Self::Composed(set, base) => Self::Composed(*set, Box::new(base.resolved(invariant))),
            Self::RightLift(base) => Self::RightLift(Box::new(base.resolved(invariant))),
            other => other.clone(),
        }
    }

    /// The generated steps that a step of this length is made of, one after the other.
    pub(crate) fn parts(&self, invariant: bool, step: f64) -> Vec<Part> {
        let halves =
            |map| std::vec![(map, Rule::Family(0, 1), 0.5 * step), (map, Rule::Family(1, 1), 0.5 * step)];
        match self.resolved(invariant) {
            Self::Step(map, rule) => std::vec![(map, rule, step)],
            Self::StormerVerlet(map) | Self::Standard(map) => halves(map),
            Self::RightLift(base) => base.parts(invariant, step),
            // rounded as steps of the composition are
            Self::Composed(set, base) => {
                set.gamma.iter().flat_map(|gamma| base.parts(invariant, gamma * step)).collect()
            }
        }
    }

    /// Returns what it promises of its steps of a system.
    pub fn properties(&self, system: &Description) -> Properties {
        match self.resolved(system.invariant) {
            Self::Step(map, rule) => {
                let (row, parameter) = rule.row();
                let (order, symmetric) = match parameter {
                    Parameter::Share(numerator, denominator) => {
                        // its adjoint is `1 − s` with any retraction; that `s` and `1 − s` are one map, where momentum and advected parameters
                        // alone have a part in the motion, follows from the retraction's being a function of one matrix, for the ends
                        // from its being odd
                        let is_middle = 2 * u64::from(numerator) == u64::from(denominator);
                        let is_end = numerator == 0 || numerator == denominator;
                        let is_own = map.is_matrix_function() || is_end && map.is_odd();
                        let is_one_map = row.is_one_map && system.invariant && is_own;
                        let symmetric = is_middle || is_one_map;
                        (if symmetric { 2 } else { 1 }, symmetric)
                    }
                    Parameter::Order(order) => (order, true),
                };
                let casimirs = match row.is_symplectic {
                    true => ConservedCasimirs::All,
                    false => ConservedCasimirs::Advected,
                };
                Properties { order, symmetric, poisson: row.is_symplectic && !system.forced, casimirs }
            }
            // half of the first member, then half of its adjoint
            Self::StormerVerlet(map) | Self::Standard(map) => {
                Properties { order: 2, symmetric: true, ..Self::member(map, 0, 1).properties(system) }
            }
            Self::Composed(set, base) => {
                let base = base.properties(system);
                let rises = base.symmetric && base.order == 2;
                Properties { order: if rises { set.order } else { base.order }, ..base }
            }
            Self::RightLift(base) => base.properties(system),
        }
    }
}

/// What a scheme promises of its steps of a system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Properties {
    /// The order.
    pub order: u32,
    /// Whether the step `−h` undoes the step `h`.
    pub symmetric: bool,
    /// Whether steps keep the Poisson structure, on the cotangent bundle the symplectic form.
    pub poisson: bool,
    /// Which Casimirs they keep.
    pub casimirs: ConservedCasimirs,
}

/// Which of a system's Casimirs a step keeps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub enum ConservedCasimirs {
    /// All of them.
    All,
    /// Those that are functions of advected parameters alone.
    Advected,
    /// None.
    None,
}

/// As users write its type.
impl fmt::Display for Scheme {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Standard(map) => f.write_str(map.name()),
            Self::Step(map, rule) => {
                let ((row, parameter), map) = (rule.row(), map.name());
                let named = row.named().iter().find(|(_, n, d)| Parameter::Share(*n, *d) == parameter);
                match (named, parameter) {
                    (Some((name, ..)), _) => write!(f, "{name}<{map}>"),
                    (None, Parameter::Share(n, d)) => write!(f, "{}<{map}, {n}, {d}>", row.name),
                    (None, Parameter::Order(order)) => write!(f, "{}<{map}, {order}>", row.name),
                }
            }
            Self::StormerVerlet(map) => write!(f, "StormerVerlet<{}>", map.name()),
            Self::RightLift(base) => write!(f, "RightLift<{base}>"),
            Self::Composed(set, base) => match CoefficientSet::named().iter().find(|(_, named)| named == set)
            {
                Some((name, _)) => write!(f, "{name}<{base}>"),
                None => write!(f, "Composed<{}, {base}>", without_paths(set.name)),
            },
        }
    }
}

/// A text that names no scheme.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("`{text}` names no scheme: {}", known())]
#[non_exhaustive]
pub struct ParseSchemeError {
    /// The text.
    pub text: String,
}

/// What names a scheme.
fn known() -> String {
    let quoted = |names: &mut dyn Iterator<Item = &'static str>| {
        names.map(|name| std::format!("`{name}`")).collect::<Vec<_>>().join(", ")
    };
    let retractions = quoted(&mut RetractionKind::ALL.into_iter().map(RetractionKind::name));
    let named = quoted(&mut Rule::METHODS.iter().flat_map(|row| row.named()).map(|named| named.0));
    let with_numbers = Rule::METHODS.map(|row| match row.rules {
        Rules::Share { .. } => std::format!("`{}<Cayley, 1, 4>`", row.name),
        Rules::Order { usual, .. } => std::format!("`{}<Cayley, {usual}>`", row.name),
    });
    let composed = quoted(&mut CoefficientSet::named().into_iter().map(|(name, _)| name));
    std::format!(
        "one is a retraction ({retractions}), or {named} or `StormerVerlet` on one (`Midpoint<Cayley>`), {}, or {composed} or \
         `RightLift` of another scheme (`Order4<Cayley>`)",
        with_numbers.join(", ")
    )
}

impl FromStr for Scheme {
    type Err = ParseSchemeError;

    fn from_str(text: &str) -> Result<Self, ParseSchemeError> {
        parsed(text.trim(), MOST_STEPS).ok_or_else(|| ParseSchemeError { text: text.to_string() })
    }
}

/// How many steps a text may compose to one: compositions of compositions multiply, and nobody waits for more.
const MOST_STEPS: usize = 10_000;

/// The greatest common divisor.
const fn gcd(mut a: u32, mut b: u32) -> u32 {
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}

/// The scheme that a text names, if it is composed of so many steps at most. Each composition divides their number, and nothing is lifted twice:
/// texts are not followed for ever.
fn parsed(text: &str, most: usize) -> Option<Scheme> {
    let (name, inner) = match text.split_once('<') {
        Some((name, rest)) => (name.trim(), rest.strip_suffix('>')?.trim()),
        None => (text, ""),
    };
    match name {
        "StormerVerlet" => Some(Scheme::StormerVerlet(on(inner)?)),
        "RightLift" if !inner.contains("RightLift") => {
            let base = if inner.is_empty() { step("SymplecticEulerA", "") } else { parsed(inner, most) };
            Some(Scheme::RightLift(Box::new(base?)))
        }
        _ if Rule::METHODS.iter().any(|row| row.has(name)) => step(name, inner),
        _ => match CoefficientSet::named().into_iter().find(|(order, _)| *order == name) {
            Some((_, set)) => {
                let most = most / set.gamma.len();
                (most > 0).then(|| parsed(inner, most))?.map(|base| Scheme::Composed(set, Box::new(base)))
            }
            None if inner.is_empty() && !text.contains('<') => retraction(name).map(Scheme::Standard),
            None => None,
        },
    }
}

fn retraction(name: &str) -> Option<RetractionKind> {
    RetractionKind::ALL.into_iter().find(|map| map.name() == name)
}

/// The retraction of this name; what is left out is the types' default.
fn on(name: &str) -> Option<RetractionKind> {
    if name.is_empty() { Some(RetractionKind::Exponential) } else { retraction(name.trim()) }
}

/// The generated step of this name, on what stands between `<` and `>`.
fn step(name: &str, inner: &str) -> Option<Scheme> {
    let row = Rule::METHODS.iter().find(|row| row.has(name))?;
    let (map, parameter) = match inner.split_once(',') {
        Some((map, parameter)) if name == row.name => (map, Some(parameter)),
        _ => (inner, None),
    };
    let rule = match (&row.rules, parameter) {
        (Rules::Share { rule, named }, None) => {
            // the method by itself is its first member
            named.iter().find(|named| named.0 == name).map_or_else(|| rule(0, 1), |&(_, n, d)| rule(n, d))
        }
        (Rules::Share { rule, .. }, Some(share)) => {
            let (n, d) = share.split_once(',')?;
            let (n, d): (u32, u32) = (n.trim().parse().ok()?, d.trim().parse().ok()?);
            if d == 0 || n > d {
                return None;
            }
            let common = gcd(n, d);
            rule(n / common, d / common)
        }
        (Rules::Order { rule, usual }, order) => {
            rule(order.map_or(Some(*usual), |order| order.trim().parse().ok())?)
        }
    };
    Some(Scheme::Step(on(map)?, rule))
}

#[cfg(feature = "serde")]
impl serde::Serialize for Scheme {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

#[cfg(feature = "serde")]
impl<'de> serde::Deserialize<'de> for Scheme {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = <String as serde::Deserialize>::deserialize(deserializer)?;
        text.parse().map_err(serde::de::Error::custom)
    }
}

/// `Family<Cayley, 1, 2>` of `coadjoint::scheme::Family<coadjoint::retraction::Cayley, 1, 2>`.
fn without_paths(name: &str) -> String {
    let is_path = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
    let mut short = String::new();
    let mut rest = name;
    while let Some(next) = rest.chars().next() {
        let end = rest.find(|c| is_path(c) != is_path(next)).unwrap_or(rest.len());
        let (token, others) = rest.split_at(end);
        short.push_str(token.rsplit("::").next().unwrap_or(token));
        rest = others;
    }
    short
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::composition::{Order4, Order10};
    use crate::retraction::{Cayley, Exponential, SecondKind};
    use crate::scheme::{
        Family, HamiltonJacobi, Midpoint, SymplecticEulerA, SymplecticEulerB, TangentLift, TangentMidpoint,
    };

    #[test]
    fn schemes_are_read_as_they_are_written() {
        let all = [
            Exponential::scheme(),
            Cayley::scheme(),
            SecondKind::scheme(),
            SymplecticEulerA::<Cayley>::scheme(),
            Midpoint::<SecondKind>::scheme(),
            SymplecticEulerB::<Exponential>::scheme(),
            Family::<Cayley, 1, 4>::scheme(),
            TangentLift::<Cayley>::scheme(),
            TangentMidpoint::<Exponential>::scheme(),
            TangentLift::<Cayley, 2, 3>::scheme(),
            HamiltonJacobi::<Cayley, 8>::scheme(),
            StormerVerlet::<Cayley>::scheme(),
            RightLift::<Midpoint>::scheme(),
            Order4::<StormerVerlet<Cayley>>::scheme(),
            Order10::<Order4<Exponential>>::scheme(),
        ];
        for scheme in all {
            let text = scheme.to_string();
            assert_eq!(text.parse(), Ok(scheme.clone()), "{text}");
            assert_eq!(text.replace(' ', "").parse(), Ok(scheme), "{text}");
        }
        // with what is left out as types have it, and in lowest terms
        assert_eq!("Midpoint".parse(), Ok(Midpoint::<Exponential>::scheme()));
        assert_eq!("Family".parse(), Ok(Family::<Exponential>::scheme()));
        assert_eq!("HamiltonJacobi<Cayley>".parse(), Ok(HamiltonJacobi::<Cayley>::scheme()));
        assert_eq!("RightLift".parse(), Ok(RightLift::<SymplecticEulerA>::scheme()));
        assert_eq!("Family<Cayley, 2, 4>".parse(), Ok(Midpoint::<Cayley>::scheme()));
        assert_eq!("Family<Cayley, 0, 7>".parse(), Ok(SymplecticEulerA::<Cayley>::scheme()));
        // a prime, and no time for it
        let prime = "Family<Cayley, 1, 4294967291>".parse();
        assert_eq!(prime, Ok(Family::<Cayley, 1, 4_294_967_291>::scheme()));
    }

    #[test]
    fn what_names_no_scheme_is_refused() {
        let wrong = [
            "",
            "cayley",
            "Midpoint<",
            "Midpoint<Cayley",
            "Midpoint<Midpoint>",
            "HamiltonJacobi<Cayley, six>",
            "HamiltonJacobi<6>",
            "Cayley<>",
            "Order4",
            "Order4<>",
            "Order5<Cayley>",
            "Family<Cayley, 5, 4>",
            "Family<Cayley, 0, 0>",
            "Family<Cayley, 1, 2, 3>",
            "Family<Cayley, 1, 99999999999>",
            "Midpoint<Cayley>>",
            "RightLift<RightLift<Cayley>>",
            // a step of 35⁶ others
            "Order10<Order10<Order10<Order10<Order10<Order10<Cayley>>>>>>",
        ];
        for text in wrong {
            let error = text.parse::<Scheme>().expect_err(text);
            assert_eq!(error.text, text);
        }
    }
}
