//! Lie groups, as the generator knows them.

use num_rational::Ratio;

use super::{Basis, Law, MatrixFunction, Representation, Retraction, Side, calculus, families};
use crate::expr::{Expr, Vector};
use crate::quantity::Kind;

/// A Lie group, left-trivialized: `g' = g ξ`.
///
/// Elements `x`, `y` of the algebra and `m` of its dual are vectors of [`dimension`](Self::dimension) coordinates,
/// paired by the dot product; elements `g`, `h` of the group are vectors of the stored coordinates.
pub trait Group: AsGroup + Sync {
    /// Names, kinds and lengths.
    fn names(&self) -> &GroupNames;
    /// The name users write.
    fn name(&self) -> &'static str {
        self.names().name
    }
    /// Suffixes of the stored coordinates.
    fn coordinates(&self) -> &'static [&'static str] {
        self.names().coordinates
    }
    /// Suffixes of the algebra's coordinates.
    fn axes(&self) -> &'static [&'static str] {
        self.names().axes
    }
    /// Dimension of the algebra.
    fn dimension(&self) -> usize {
        self.axes().len()
    }
    /// The lengths of the blocks of coordinates of the algebra that have a unit in common: angles, then lengths.
    fn blocks(&self) -> Vec<usize> {
        match self.names().blocks {
            [] => vec![self.dimension()],
            blocks => blocks.to_vec(),
        }
    }
    /// The equations of motion of a left-invariant system, for generated documentation: Lie–Poisson, with the coadjoint
    /// action, unless they read better otherwise.
    fn equations(&self, names: &EquationNames<'_>) -> Equations {
        let EquationNames { configuration, momentum, velocity, advected, energy } = names;
        Equations {
            configuration: format!("{configuration} hat({velocity})"),
            bracket: Some(format!("ad*({velocity}) {momentum}")),
            by_energy: advected.iter().map(|a| format!("{a} ⋄ ∂{energy}/∂{a}")).collect(),
            advected: advected.iter().map(|a| format!("ad*({velocity}) {a}")).collect(),
        }
    }
    /// The coordinates of a basis that may have simpler constants, a row for each of its elements; none if no other one
    /// is known.
    fn simple_basis(&self) -> Option<Vec<Vec<Ratio<i64>>>> {
        None
    }
    /// The bracket `[x, y]`.
    fn bracket<'a>(&self, x: &Vector<'a>, y: &Vector<'a>) -> Vector<'a>;
    /// `f(x)`
    fn closed_form<'a>(&self, f: MatrixFunction, x: &Vector<'a>) -> Vector<'a>;
    /// `(dR f_x)* m`
    fn closed_d_right_dual<'a>(&self, f: MatrixFunction, x: &Vector<'a>, m: &Vector<'a>) -> Vector<'a>;
    /// `dR f_x y`
    fn closed_d_right<'a>(&self, f: MatrixFunction, x: &Vector<'a>, y: &Vector<'a>) -> Vector<'a> {
        calculus::transposed(y, y.len(), |m| self.closed_d_right_dual(f, x, m))
    }
    /// `τ(x)`
    fn retract<'a>(&self, retraction: Retraction, x: &Vector<'a>) -> Vector<'a> {
        match retraction.row().law {
            Law::Function(f) => self.closed_form(f, x),
            Law::Composite(map) => map.retract(self.as_group(), x),
        }
    }
    /// `(dR τ_x)* m`, the dual of the right logarithmic derivative `dR τ_x y = Dτ(x)y · τ(x)⁻¹`.
    fn d_right_dual<'a>(&self, retraction: Retraction, x: &Vector<'a>, m: &Vector<'a>) -> Vector<'a> {
        match retraction.row().law {
            Law::Function(f) => self.closed_d_right_dual(f, x, m),
            Law::Composite(map) => map.d_right_dual(self.as_group(), x, m),
        }
    }
    /// Whether there are steps with a function: not with a map that leaves the group, or of which no closed form is
    /// known.
    fn has_function(&self, _f: MatrixFunction) -> bool {
        true
    }
    /// Whether there are steps with a retraction.
    fn has(&self, retraction: Retraction) -> bool {
        match retraction.row().law {
            Law::Function(f) => self.has_function(f),
            Law::Composite(map) => map.is_for(self.as_group()),
        }
    }
    /// Whether it is summed as a series, term by term, for want of a closed form.
    fn is_summed(&self, _retraction: Retraction) -> bool {
        false
    }
    /// Positive, all of them, where `f` is a local diffeomorphism, one of them zero on the edge; none if that is
    /// everywhere.
    fn closed_domain<'a>(&self, f: MatrixFunction, x: &Vector<'a>) -> Vec<Expr<'a>>;
    /// The same of a retraction.
    fn domain<'a>(&self, retraction: Retraction, x: &Vector<'a>) -> Vec<Expr<'a>> {
        match retraction.row().law {
            Law::Function(f) => self.closed_domain(f, x),
            Law::Composite(map) => map.domain(self.as_group(), x),
        }
    }
    /// `g h`
    fn compose<'a>(&self, g: &Vector<'a>, h: &Vector<'a>) -> Vector<'a>;
    /// `g⁻¹`
    fn inverse<'a>(&self, g: &Vector<'a>) -> Vector<'a>;
    /// `g`, which roundoff has taken an ulp or two off the group, back on it.
    fn normalize<'a>(&self, g: &Vector<'a>) -> Vector<'a>;
    /// The defect of an element, to first order the way back to it; none where the type of what is stored has told
    /// already.
    fn deviation<'a>(&self, _g: &Vector<'a>) -> Option<Vector<'a>> {
        None
    }
    /// `g τ(x)`, on the other side `τ(x) g`.
    fn moved<'a>(&self, side: Side, retraction: Retraction, g: &Vector<'a>, x: &Vector<'a>) -> Moved<'a> {
        let increment = self.retract(retraction, x).hold();
        let moved = side.compose(self.as_group(), g, &increment).hold();
        let next = self.normalize(&moved);
        Moved { increment, moved, next }
    }
    /// `Ad*_{g⁻¹} m`: a body momentum in space coordinates.
    fn to_space<'a>(&self, g: &Vector<'a>, m: &Vector<'a>) -> Vector<'a>;
    /// The linear spaces the group acts on, by names of their own, beside its [algebra](super::Adjoint) and what is
    /// [dual](super::Dual) to them.
    fn representations(&self) -> &[&'static dyn Representation];
    /// What an element does to a vector in a user's expressions, as those of the type it is stored as do, if it acts on
    /// such vectors.
    fn act<'a>(&self, g: &Vector<'a>, v: &Vector<'a>) -> Option<Vector<'a>> {
        let mut spaces = self.representations().iter();
        spaces.find(|space| space.coordinates().len() == v.len())?.act(g, v)
    }
    /// Its algebra as one of matrices, with the same axes: that of the family of its name, unless that has others.
    fn basis(&self) -> Option<Basis> {
        families::basis(self.name())
    }
    /// The number `k` for which the unknown of a step is `η/k`: 2 where the retraction is a function of `η/2`.
    fn unknown_scale(&self, _retraction: Retraction) -> i128 {
        1
    }
    /// Whether the group is a vector space, and its elements are vectors to a user's expressions.
    fn is_linear(&self) -> bool {
        false
    }
    /// The rows of the matrix that an element is stored as, which is then a matrix to a user's expressions.
    fn matrix_rows(&self) -> Option<usize> {
        None
    }
    /// `g τ(δ)`, on the other side `τ(δ) g`, to first order in `δ`.
    fn near<'a>(&self, side: Side, g: &Vector<'a>, delta: &Vector<'a>) -> Vector<'a> {
        side.compose(self.as_group(), g, &self.retract(Retraction::Exponential, delta))
    }
}

/// What a group and its coordinates are called, and what is stored of an element.
#[derive(Clone, Copy)]
pub struct GroupNames {
    /// The name users write.
    pub name: &'static str,
    /// One line on coordinates and conventions, for generated documentation.
    pub conventions: &'static str,
    /// The field of the state that holds the configuration of a system with this one group.
    pub configuration: &'static str,
    /// The kind of the configuration.
    pub kind: Kind,
    /// Suffixes of the stored coordinates.
    pub coordinates: &'static [&'static str],
    /// How many of the stored coordinates, from the first one on, make something of unit length: a rotation leaves them
    /// bounded, however far it goes.
    pub unit_coordinates: usize,
    /// Suffixes of the algebra's coordinates.
    pub axes: &'static [&'static str],
    /// The lengths of the blocks of the algebra's coordinates that have a unit in common; none where all have.
    pub blocks: &'static [usize],
    /// The names of the blocks, where a momentum is made of several: angular and linear.
    pub parts: &'static [&'static str],
    /// What a user's expressions can take from an element: fields, and methods without arguments, of the type it is
    /// stored as.
    pub components: &'static [Component],
}

/// A group as one of any kind.
pub trait AsGroup {
    /// The same.
    fn as_group(&self) -> &dyn Group;
}

impl<G: Group> AsGroup for G {
    fn as_group(&self) -> &dyn Group {
        self
    }
}

/// An element of a group moved along a retraction, and what it was computed from.
pub struct Moved<'a> {
    /// `τ(x)`, up to a scalar factor.
    pub increment: Vector<'a>,
    /// The product, up to a scalar factor.
    pub moved: Vector<'a>,
    /// The product, on the group.
    pub next: Vector<'a>,
}

/// Names for the equations of motion.
pub struct EquationNames<'n> {
    /// The configuration.
    pub configuration: &'n str,
    /// The momentum.
    pub momentum: &'n str,
    /// The velocity.
    pub velocity: &'n str,
    /// The advected parameters.
    pub advected: &'n [&'n str],
    /// The letter of the energy that is differentiated.
    pub energy: &'static str,
}

/// The right sides of equations of motion, as text.
pub struct Equations {
    /// `attitude hat(velocity)`
    pub configuration: String,
    /// What the bracket with the momentum makes of the momentum's change, if anything.
    pub bracket: Option<String>,
    /// The terms of the momentum's change that are linear in the energy's derivative by an advected parameter.
    pub by_energy: Vec<String>,
    /// `gamma × velocity`, for each advected parameter.
    pub advected: Vec<String>,
}

/// Something that an expression can take from an element of a group, as `pose.rotation` or `angle.cos_angle()`.
pub struct Component {
    /// As the user writes it.
    pub name: &'static str,
    /// Whether it is a method, called without arguments.
    pub called: bool,
    /// Its value.
    pub of: for<'a> fn(&Vector<'a>) -> ComponentValue<'a>,
}

/// A component of an element, as an expression takes it.
pub enum ComponentValue<'a> {
    /// A number.
    Scalar(Expr<'a>),
    /// A vector.
    Vector(Vector<'a>),
    /// An element of another group.
    Element(&'static dyn Group, Vector<'a>),
}
