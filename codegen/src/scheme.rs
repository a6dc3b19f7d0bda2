//! What a step is made by: the names of methods, as users write them and as generated code has them.

use crate::expr::Number;
pub use crate::group::Retraction;

/// What a step is made by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Rule {
    /// A member of the [`family`](crate::method::family).
    Family(Member),
    /// A member of the family of [tangent lifts](crate::method::tangent_lift).
    TangentLift(Member),
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
            Rule::TangentLift(Member::SYMPLECTIC_EULER_A) => format!("{retraction}TangentLift"),
            Rule::TangentLift(member) => {
                format!("{retraction}TangentLift{}Over{}", member.numerator, member.denominator)
            }
        }
    }

    /// Its type in the runtime, as users write it: `Midpoint<Cayley>`.
    pub fn type_name(self) -> String {
        let Self { retraction, rule } = self;
        let (name, Member { numerator, denominator }) = match rule {
            Rule::Family(member) => match member.known_name() {
                Some(name) => return format!("{name}<{}>", retraction.name()),
                None => ("Family", member),
            },
            Rule::TangentLift(Member::SYMPLECTIC_EULER_A) => {
                return format!("TangentLift<{}>", retraction.name());
            }
            Rule::TangentLift(Member::MIDPOINT) => return format!("TangentMidpoint<{}>", retraction.name()),
            Rule::TangentLift(member) => ("TangentLift", member),
        };
        format!("{name}<{}, {numerator}, {denominator}>", retraction.name())
    }
}

/// Whether a bare retraction stands for the step of Störmer and Verlet whatever the system: what is not odd makes no symmetric step of
/// [the first member](Member::SYMPLECTIC_EULER_A).
pub fn stands_for_verlet(retraction: Retraction) -> bool {
    !retraction.is_odd()
}

/// A member of the [`family`](crate::method::family): its parameter `s` as a fraction in lowest terms.
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

    /// Its name, if it has one.
    fn known_name(self) -> Option<&'static str> {
        Self::NAMED.iter().find(|&&(_, member)| member == self).map(|&(name, _)| name)
    }

    /// Its name, or `Family1Over4`.
    pub fn name(self) -> String {
        match self.known_name() {
            Some(name) => name.to_owned(),
            None => format!("Family{}Over{}", self.numerator, self.denominator),
        }
    }

    /// `s`
    pub fn s(self) -> Number {
        Number::ratio(i128::from(self.numerator), i128::from(self.denominator))
    }
}
