//! The maps from the algebra to the group that steps are made with.
//!
//! A retraction is a file and its row in [`Retraction::row`]: parsing, messages, displacements, schemes, and the types of
//! the libraries follow from the row.

mod second_kind;

use super::{Group, Representation, Translation};
use crate::expr::{Expr, Vector};
use second_kind::{ASCENDING, DESCENDING};

/// A map `τ: g → G` with `τ(0) = e`, `τ'(0) = id`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Retraction {
    /// The group's exponential map.
    Exponential,
    /// The Cayley map `(1 − ξ/2)⁻¹(1 + ξ/2)`.
    Cayley,
    /// Canonical coordinates of the second kind, `exp(x₁E₁) ⋯ exp(x_d E_d)`.
    SecondKind,
    /// `exp(x_d E_d) ⋯ exp(x₁E₁)`: what [`SecondKind`](Self::SecondKind) is backwards.
    ReversedSecondKind,
    /// The exponential map up to a few terms of series that are not finite sums: close enough for Newton's matrix, and
    /// much shorter.
    Coarse,
}

/// A retraction that is a function `f` of one matrix, with `f(−X) = f(X)⁻¹`.
///
/// As `f(A X A⁻¹) = A f(X) A⁻¹`, it is `Ad`-equivariant: `τ(Ad_g x) = g τ(x) g⁻¹`. Hence
/// `Ad*_{τ(x)} m = m + ad*_x (dR τ_x)* m`, and `τ(x)` commutes with `exp x`. It is odd as well, `τ(−x) = τ(x)⁻¹`, so
/// that `dL τ_x = dR τ_{−x}`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MatrixFunction {
    /// [`Retraction::Exponential`]
    Exponential,
    /// [`Retraction::Cayley`]
    Cayley,
    /// [`Retraction::Coarse`]
    Coarse,
}

/// How a retraction is made for any group.
#[derive(Clone, Copy)]
pub(crate) enum Law {
    /// By the group's closed forms.
    Function(MatrixFunction),
    /// From the group's exponential, in a file of its own.
    Composite(&'static dyn Composite),
}

/// A retraction that is made for all groups at once.
pub(crate) trait Composite: Sync {
    /// `τ(x)`
    fn retract<'a>(&self, group: &dyn Group, x: &Vector<'a>) -> Vector<'a>;
    /// `(dR τ_x)* m`
    fn d_right_dual<'a>(&self, group: &dyn Group, x: &Vector<'a>, m: &Vector<'a>) -> Vector<'a>;
    /// `Ad*_{τ(x)} m`
    fn coadjoint<'a>(&self, group: &dyn Group, x: &Vector<'a>, m: &Vector<'a>) -> Vector<'a>;
    /// `τ(x)` acting on a vector `v` of one of the group's spaces.
    fn transport<'a>(
        &self,
        group: &dyn Group,
        space: &dyn Representation,
        x: &Vector<'a>,
        v: &Vector<'a>,
    ) -> Vector<'a>;
    /// The `V` part of `τ(x, w)` on the semidirect product.
    fn translation<'a>(&self, w: &Vector<'a>) -> Translation<'a>;
    /// Whether it is known of a group where the retraction is singular. There are no steps with it elsewhere.
    fn is_for(&self, group: &dyn Group) -> bool;
    /// Positive, all of them, where the retraction is a local diffeomorphism.
    fn domain<'a>(&self, group: &dyn Group, x: &Vector<'a>) -> Vec<Expr<'a>>;
}

/// The row of a retraction.
pub(crate) struct Row {
    name: &'static str,
    /// Its name among those of functions: `second_kind`.
    pub(crate) snake_name: &'static str,
    /// Its name in sentences.
    pub(crate) spoken: &'static str,
    /// Its short name on command lines.
    pub(crate) short: &'static str,
    /// Describes it for people who choose one.
    pub(crate) about: &'static str,
    /// The documentation of its type.
    pub(crate) doc: &'static str,
    pub(crate) law: Law,
    reversed: Retraction,
    /// Whether steps are generated with it unless others are asked for.
    is_default: bool,
    /// Why some groups have no steps with it.
    pub(crate) absence: &'static str,
}

impl Retraction {
    /// Those that steps are asked for by.
    pub const ALL: [Self; 3] = [Self::Exponential, Self::Cayley, Self::SecondKind];

    pub(crate) fn row(self) -> Row {
        const UNKNOWN: &str = "where they are singular is not known";
        match self {
            Self::Exponential => Row {
                name: "Exponential",
                snake_name: "exponential",
                spoken: "exponential",
                short: "exp",
                about: "The exponential map: the most accurate step of a given size",
                doc: "The group's exponential map.\n\n\
                      On SO(3) it needs angles per step below 2π. At equal step it is far more accurate than [`Cayley`]\n\
                      (it follows steady rotations exactly), for some more arithmetic per step: the better default.",
                law: Law::Function(MatrixFunction::Exponential),
                reversed: Self::Exponential,
                is_default: true,
                absence: "it has no closed form and too many coordinates to be summed",
            },
            Self::Cayley => Row {
                name: "Cayley",
                snake_name: "cayley",
                spoken: "Cayley",
                short: "cay",
                about: "The Cayley map: rational, and defined for every angle",
                doc: "The Cayley map `(1 − ξ/2)⁻¹(1 + ξ/2)`: rational, no transcendental function, defined for every argument.",
                law: Law::Function(MatrixFunction::Cayley),
                reversed: Self::Cayley,
                is_default: true,
                absence: "(1 − X/2)⁻¹(1 + X/2) leaves the group",
            },
            Self::SecondKind => Row {
                name: "SecondKind",
                snake_name: "second_kind",
                spoken: "second kind",
                short: "ccsk",
                about: "Canonical coordinates of the second kind: turns about the axes, one after the other. Not odd, to \
                        compare with; there for some systems",
                doc: second_kind::DOC,
                law: Law::Composite(&ASCENDING),
                reversed: Self::ReversedSecondKind,
                is_default: false,
                absence: UNKNOWN,
            },
            Self::ReversedSecondKind => Row {
                name: "ReversedSecondKind",
                snake_name: "reversed_second_kind",
                spoken: "reversed second kind",
                law: Law::Composite(&DESCENDING),
                reversed: Self::SecondKind,
                ..Self::SecondKind.row()
            },
            Self::Coarse => Row {
                law: Law::Function(MatrixFunction::Coarse),
                reversed: Self::Coarse,
                is_default: false,
                ..Self::Exponential.row()
            },
        }
    }

    /// The name of the runtime's marker type; what is backwards has none of its own.
    pub fn name(self) -> &'static str {
        self.row().name
    }

    /// Those with which steps are generated unless others are asked for.
    pub fn defaults() -> impl Iterator<Item = Self> {
        Self::ALL.into_iter().filter(|retraction| retraction.is_default())
    }

    /// Whether steps are generated with it unless others are asked for.
    pub fn is_default(self) -> bool {
        self.row().is_default
    }

    /// `τ̄(x) = τ(−x)⁻¹`, a retraction with `dR τ̄_x = dL τ_{−x}`.
    #[must_use]
    pub fn reversed(self) -> Self {
        self.row().reversed
    }

    /// Whether `τ(−x) = τ(x)⁻¹`.
    pub fn is_odd(self) -> bool {
        self == self.reversed()
    }

    /// Whether `τ(Ad_g x) = g τ(x) g⁻¹`.
    pub fn is_equivariant(self) -> bool {
        matches!(self.row().law, Law::Function(_))
    }
}

impl From<MatrixFunction> for Retraction {
    fn from(f: MatrixFunction) -> Self {
        match f {
            MatrixFunction::Exponential => Self::Exponential,
            MatrixFunction::Cayley => Self::Cayley,
            MatrixFunction::Coarse => Self::Coarse,
        }
    }
}
