//! Methods: from a system and a retraction to the equations of one step. They make expressions, never tokens.

pub mod elimination;
pub mod family;
pub mod linearization;
pub mod tangent_lift;

use crate::expr::{Arena, Expr, Number, Symbol, Vector};
use crate::group::Retraction;
use crate::model::System;

/// One step: solve `left(x) = right(x)` for the unknown `x`, then update the state.
pub struct Step<'a> {
    /// The step size, a symbol.
    pub h: Expr<'a>,
    /// Symbols of stage *step* that are given at the beginning of a step and not kept by the caller: time and controls.
    pub given: Vec<Symbol>,
    /// The symbols `x`, of stage *iteration*; none if the step is explicit.
    pub unknown: Vector<'a>,
    /// The lengths of the blocks of `x` that have a unit in common.
    pub blocks: Vec<usize>,
    /// A first approximation of `x` from the state.
    pub start: Vector<'a>,
    /// `left(x)`
    pub left: Vector<'a>,
    /// `right(x)`
    pub right: Vector<'a>,
    /// Each positive while `x` is inside a retraction's domain.
    pub domain: Vec<Expr<'a>>,
    /// How the configuration of each factor is moved, one turn after the other.
    pub turns: Vec<Vec<Turn<'a>>>,
    /// The state after the step, in the order of storage.
    pub next: Vector<'a>,
    /// What of it is bounded if the unknown is: rotations.
    pub bounded: Vec<bool>,
}

/// One move of a configuration: from `g` to `g τ(x)`, on the other side to `τ(x) g`.
pub struct Turn<'a> {
    /// `g`, in stored coordinates.
    pub from: Vector<'a>,
    /// `x`
    pub by: Vector<'a>,
}

/// What a step is made by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Rule {
    /// A member of the [`family`].
    Family(Member),
    /// The [tangent lift](tangent_lift).
    TangentLift,
}

impl Rule {
    /// The rule of which this one is another name for the system: `s = 1` is `s = 0` where nothing but momentum and advected parameters has
    /// a part in the motion, for `(dR τ_{−η})* Ad*_{τ(η)} = (dR τ_η)*`.
    pub fn original(self, system: &System<'_>) -> Self {
        if self == Self::Family(Member::SYMPLECTIC_EULER_B) && system.is_left_invariant() {
            return Self::Family(Member::SYMPLECTIC_EULER_A);
        }
        self
    }
}

/// A rule with a retraction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Scheme {
    /// The retraction `τ`.
    pub retraction: Retraction,
    /// What makes the step.
    pub rule: Rule,
}

impl Scheme {
    /// Its name in generated code: `ExponentialMidpoint`; the retraction's alone for the first member.
    pub fn name(self) -> String {
        let retraction = self.retraction.name();
        match self.rule {
            Rule::Family(Member::SYMPLECTIC_EULER_A) => retraction.to_owned(),
            Rule::Family(member) => format!("{retraction}{}", member.name()),
            Rule::TangentLift => format!("{retraction}TangentLift"),
        }
    }

    /// The step that it makes of a system.
    pub fn step<'a>(self, arena: &'a Arena, system: &System<'a>) -> Step<'a> {
        match self.rule {
            Rule::Family(member) => family::step(arena, system, self.retraction, member),
            Rule::TangentLift => tangent_lift::step(arena, system, self.retraction),
        }
    }

    /// Its type in the runtime, as users write it: `Midpoint<Cayley>`.
    pub fn type_name(self) -> String {
        let Self { retraction, rule } = self;
        let member = match rule {
            Rule::Family(member) => member,
            Rule::TangentLift => return format!("TangentLift<{}>", retraction.name()),
        };
        match Member::NAMED.iter().find(|&&(_, named)| named == member) {
            Some((name, _)) => format!("{name}<{}>", retraction.name()),
            None => format!("Family<{}, {}, {}>", retraction.name(), member.numerator, member.denominator),
        }
    }
}

/// The step size as a symbol.
pub fn step_symbol(arena: &Arena) -> Expr<'_> {
    arena.symbol("h", crate::expr::Stage::Parameters)
}

/// A member of the [`family`]: its parameter `s` as a fraction in lowest terms.
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

    /// Those with names of their own.
    pub const NAMED: [(&'static str, Self); 3] = [
        ("SymplecticEulerA", Self::SYMPLECTIC_EULER_A),
        ("Midpoint", Self::MIDPOINT),
        ("SymplecticEulerB", Self::SYMPLECTIC_EULER_B),
    ];

    /// The member with this `s`, if it lies between 0 and 1.
    pub fn new(numerator: u32, denominator: u32) -> Option<Self> {
        if denominator == 0 || numerator > denominator {
            return None;
        }
        let (mut a, mut b) = (numerator, denominator);
        while b != 0 {
            (a, b) = (b, a % b);
        }
        Some(Self { numerator: numerator / a, denominator: denominator / a })
    }

    /// The member of this name.
    pub fn named(name: &str) -> Option<Self> {
        Self::NAMED.iter().find(|(known, _)| *known == name).map(|&(_, member)| member)
    }

    /// Its name, or `Family1Over4`.
    pub fn name(self) -> String {
        match Self::NAMED.iter().find(|&&(_, member)| member == self) {
            Some((name, _)) => (*name).to_owned(),
            None => format!("Family{}Over{}", self.numerator, self.denominator),
        }
    }

    /// `s`
    pub fn s(self) -> Number {
        Number::ratio(i128::from(self.numerator), i128::from(self.denominator))
    }
}
