//! What a step is made by: the names of methods, as users write them and as generated code has them.

use num_rational::Ratio;

use crate::expr::Number;
pub use crate::group::Retraction;

/// A method, as users and generated code name it: a family of steps with a parameter.
#[derive(Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Method {
    /// Its name in descriptions, and that of its type and its rule in the runtime.
    pub name: &'static str,
    /// Its name on command lines, for those of its steps that have no name of their own.
    pub word: &'static str,
    /// Describes these for people who choose one.
    pub about: &'static str,
    /// The documentation of its type.
    pub doc: &'static str,
    /// The orders that its parameter is one of; none where that is a share `s` of the step.
    pub orders: &'static [u32],
    /// The order of steps that do not say one.
    pub usual_order: Option<u32>,
    /// The members with names of their own.
    pub named: &'static [Named],
    /// The member that a retraction alone stands for.
    pub bare: Option<Member>,
    /// Who needs a momentum for each velocity; none if the method does not.
    pub needs_momentum: Option<&'static str>,
    /// Whether its steps are symplectic, for left-invariant systems Poisson maps that keep all Casimirs, where no force acts.
    pub is_symplectic: bool,
    /// Whether its members `s` and `1 − s` are one map, for left-invariant systems without forces and potentials on the
    /// group, if the retraction is a function of one matrix; of the ends, if it is odd.
    pub is_one_map: bool,
}

/// A member of a method with a name of its own.
#[derive(Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Named {
    /// Its name, in descriptions and that of its type in the runtime.
    pub name: &'static str,
    /// Its name on command lines.
    pub word: &'static str,
    /// Describes it for people who choose one.
    pub about: &'static str,
    /// The member.
    pub member: Member,
    /// The documentation of its type; empty where the type has the method's name.
    pub doc: &'static str,
}

impl Method {
    /// The member of this name.
    pub fn named(&'static self, name: &str) -> Option<Rule> {
        self.named.iter().find(|known| known.name == name).map(|known| self.member(known.member))
    }

    /// A member as a rule.
    pub const fn member(&'static self, member: Member) -> Rule {
        Rule { method: self, parameter: Parameter::Share(member) }
    }

    /// The step of this order as a rule.
    pub const fn of_order(&'static self, order: u32) -> Rule {
        Rule { method: self, parameter: Parameter::Order(order) }
    }
}

/// What tells a method's steps from each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Parameter {
    /// The share `s` of the step before the intermediate point.
    Share(Member),
    /// The order.
    Order(u32),
}

/// The rule of a step: a member of a method.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Rule {
    /// The method.
    pub method: &'static Method,
    /// Which of its steps.
    pub parameter: Parameter,
}

impl Rule {
    /// Whether its parameter is an order: a derivation by power series, for retractions that are functions of one matrix.
    pub fn is_of_order(self) -> bool {
        matches!(self.parameter, Parameter::Order(_))
    }

    /// Its name, if it has one.
    pub fn name(self) -> Option<&'static str> {
        let mut named = self.method.named.iter();
        named.find(|named| Parameter::Share(named.member) == self.parameter).map(|named| named.name)
    }
}

/// A rule with a retraction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Scheme {
    /// The retraction `τ`.
    pub retraction: Retraction,
    /// The rule that makes the step.
    pub rule: Rule,
}

impl Scheme {
    /// Its name in generated code: `ExponentialMidpoint`, `CayleyFamily1Over4`; the retraction's alone for the member
    /// that this stands for.
    pub fn name(self) -> String {
        let (retraction, Rule { method, parameter }) = (self.retraction.name(), self.rule);
        match (self.rule.name(), parameter) {
            (_, Parameter::Share(member)) if method.bare == Some(member) => retraction.to_owned(),
            (Some(name), _) => format!("{retraction}{name}"),
            (None, Parameter::Share(Member { numerator, denominator })) => {
                format!("{retraction}{}{numerator}Over{denominator}", method.name)
            }
            (None, Parameter::Order(order)) => format!("{retraction}{}{order}", method.name),
        }
    }

    /// Its type in the runtime, as users write it: `Midpoint<Cayley>`.
    pub fn type_name(self) -> String {
        let (retraction, Rule { method, parameter }) = (self.retraction.name(), self.rule);
        match (self.rule.name(), parameter) {
            (Some(name), _) => format!("{name}<{retraction}>"),
            (None, Parameter::Share(Member { numerator, denominator })) => {
                format!("{}<{retraction}, {numerator}, {denominator}>", method.name)
            }
            (None, Parameter::Order(order)) => format!("{}<{retraction}, {order}>", method.name),
        }
    }
}

/// A member of a [method](Method): its parameter `s` as a fraction in lowest terms.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Member {
    /// The numerator of `s`.
    pub numerator: u32,
    /// The denominator of `s`.
    pub denominator: u32,
}

impl Member {
    /// `s = 0`
    pub const SYMPLECTIC_EULER_A: Self = Self { numerator: 0, denominator: 1 };
    /// `s = ½`
    pub const MIDPOINT: Self = Self { numerator: 1, denominator: 2 };
    /// `s = 1`
    pub const SYMPLECTIC_EULER_B: Self = Self { numerator: 1, denominator: 1 };

    /// The member with this `s`, if it lies between 0 and 1.
    pub fn new(numerator: u32, denominator: u32) -> Option<Self> {
        if denominator == 0 || numerator > denominator {
            return None;
        }
        let (numerator, denominator) = Ratio::new(numerator, denominator).into_raw();
        Some(Self { numerator, denominator })
    }

    /// `s`
    pub fn s(self) -> Number {
        Number::ratio(i128::from(self.numerator), i128::from(self.denominator))
    }
}

/// Which derivatives of a step are wanted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Derivatives {
    /// The matrix with respect to the state.
    pub state: bool,
    /// The matrix with respect to the controls.
    pub controls: bool,
    /// The matrix with respect to the parameters.
    pub parameters: bool,
    /// The product with a perturbation of all three.
    pub tangent: bool,
    /// The transposed product.
    pub adjoint: bool,
}

impl Derivatives {
    /// All of them.
    pub const ALL: Self =
        Self { state: true, controls: true, parameters: true, tangent: true, adjoint: true };

    /// Whether there is anything to derive.
    pub fn any(self) -> bool {
        self != Self::default()
    }

    /// Whether the parameters have a part in any of them.
    pub fn of_parameters(self) -> bool {
        self.parameters || self.tangent || self.adjoint
    }
}
