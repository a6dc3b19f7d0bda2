//! Spaces of columns on which matrices act: the standard one of a group of matrices, and those that are given by
//! matrices.

use super::algebra::Algebra;
use super::basis::bounded;
use super::constraints::InvariantForm;
use super::powers::{LinearMatrix, TERMS};
use super::{Basis, RADIUS, leaked};
use crate::expr::{Expr, Matrix, Number, Vector};
use crate::group::exact::{Rational, RationalMatrix};
use crate::group::{MatrixFunction, Representation, Retraction, SpaceNames, Translation};

/// Why matrices are no representation.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum LinearError {
    /// Those of these two axes do not commute as the axes do.
    NoRepresentation(usize, usize),
    /// There are too many, or exact numbers grow too large on the way.
    TooLarge,
}

/// Columns with `ρ_x v = (Σ xᵢ ρᵢ) v`, for matrices `ρᵢ` that belong to the axes of the algebra.
///
/// A retraction acts on them as the same function of `ρ_x`: `ρ(exp x) = exp ρ_x` always, `ρ(cay x) = cay ρ_x` where
/// Cayley's map stays on the group of the matrices `diag(Eᵢ, ρᵢ)`.
#[derive(Clone, Debug)]
pub struct Linear {
    name: &'static str,
    coordinates: &'static [&'static str],
    rho: LinearMatrix,
    has_cayley: bool,
    /// Whether Cayley's map is regular everywhere.
    is_regular: bool,
}

impl Linear {
    /// Columns on which the algebra of a basis acts by these matrices.
    ///
    /// # Errors
    /// If they are no representation, or if numbers grow too large.
    pub fn given(basis: &Basis, rho: &Basis) -> Result<&'static Self, LinearError> {
        bounded(basis.dimension(), rho.size()).map_err(|_| LinearError::TooLarge)?;
        let algebra = Algebra::new(basis.matrices.clone()).map_err(|_| LinearError::TooLarge)?;
        let matrices = &rho.matrices;
        for i in 0..matrices.len() {
            for j in 0..i {
                let zero = RationalMatrix::zero(rho.size(), rho.size());
                let constants = algebra.structure.bracket(j, i).iter();
                let bracket = constants.fold(zero, |sum, (k, c)| sum.plus(&matrices[*k], Rational::from(*c)));
                if matrices[j].commutator(&matrices[i]) != bracket {
                    return Err(LinearError::NoRepresentation(j, i));
                }
            }
        }
        // the graph of the representation
        let both = basis.matrices.iter().zip(matrices).map(|(e, rho)| e.beside(rho)).collect();
        let has_cayley = Algebra::new(both).is_ok_and(|graph| graph.has_cayley());
        let space = Self::of("matrices", matrices.clone(), has_cayley, TERMS);
        if space.rho.is_exact() { Ok(space) } else { Err(LinearError::TooLarge) }
    }

    /// Columns on which the axes act by these matrices.
    fn of(
        name: &'static str,
        matrices: Vec<RationalMatrix>,
        has_cayley: bool,
        terms: usize,
    ) -> &'static Self {
        let is_definite = InvariantForm::of(&matrices).is_some_and(|form| form.is_definite);
        Self::new(name, LinearMatrix::new(matrices, terms), has_cayley, is_definite)
    }

    /// Columns on which the algebra acts by `ρ`, skew with respect to a definite form or not. Names and spaces live as
    /// long as the process.
    pub(super) fn new(
        name: &'static str,
        rho: LinearMatrix,
        has_cayley: bool,
        is_definite: bool,
    ) -> &'static Self {
        let n = rho.matrices[0].rows;
        let coordinates: &'static [&'static str] =
            if n <= 4 { &["x", "y", "z", "w"][..n] } else { leaked((1..=n).map(|i| i.to_string())) };
        // the eigenvalue 2 is that of no matrix that is skew with respect to a definite form, or nilpotent
        let is_regular = rho.is_elliptic() || is_definite;
        Box::leak(Box::new(Self { name, coordinates, rho, has_cayley, is_regular }))
    }

    /// `1 − ρ_x/2`
    fn one_minus_half<'a>(&self, x: &Vector<'a>) -> Matrix<'a> {
        let one = Matrix::identity(x.0[0].arena(), self.coordinates.len());
        one.zip(&self.rho.at(x), |one, rho| one - rho.scale(Number::ratio(1, 2)))
    }
}

impl Representation for Linear {
    fn names(&self) -> SpaceNames {
        let (name, coordinates) = (self.name, self.coordinates);
        SpaceNames { name, coordinates, algebra_dimension: self.rho.matrices.len() }
    }

    fn act_infinitesimally<'a>(&self, x: &Vector<'a>, v: &Vector<'a>) -> Vector<'a> {
        self.rho.at(x).times(v)
    }

    /// `φ₁(ρ_x) w`; for the Cayley map half the way before the rest, half of it after.
    fn translation<'a>(&self, f: MatrixFunction, x: &Vector<'a>, w: &Vector<'a>) -> Translation<'a> {
        match f {
            MatrixFunction::Cayley => Translation::halves(w),
            _ => Translation::before(self.rho.series((f, 1), x, w)),
        }
    }

    /// `exp(ρ_x) v`, or `2 (1 − ρ_x/2)⁻¹ v − v`
    fn transport<'a>(&self, f: MatrixFunction, x: &Vector<'a>, v: &Vector<'a>) -> Vector<'a> {
        match f {
            MatrixFunction::Cayley => {
                let solved = self.one_minus_half(x).solve(v);
                &solved.map(|component| component.scale(2)) - v
            }
            _ => self.rho.series((f, 0), x, v),
        }
    }

    fn has(&self, retraction: Retraction) -> bool {
        retraction != Retraction::Cayley || self.has_cayley
    }

    fn is_summed(&self, retraction: Retraction) -> bool {
        retraction == Retraction::Exponential && !self.rho.is_closed()
    }

    fn domain<'a>(&self, retraction: Retraction, x: &Vector<'a>) -> Vec<Expr<'a>> {
        match retraction {
            Retraction::Exponential | Retraction::Coarse if !self.rho.is_closed() => {
                let edge = Number::ratio(RADIUS.0, RADIUS.1).powi(2);
                vec![x.0[0].arena().number(edge) - self.rho.squared_norm(x)]
            }
            Retraction::Cayley if !self.is_regular => vec![self.one_minus_half(x).determinant()],
            _ => Vec::new(),
        }
    }

    fn dual(&self) -> Option<&'static dyn Representation> {
        let negative = |matrix: &RationalMatrix| matrix.transpose().scaled(-Rational::one());
        let matrices = self.rho.matrices.iter().map(negative).collect();
        let name = match self.name.strip_prefix("dual(").and_then(|name| name.strip_suffix(')')) {
            Some(name) => name,
            None => format!("dual({})", self.name).leak(),
        };
        Some(Self::of(name, matrices, self.has_cayley, self.rho.terms))
    }
}
