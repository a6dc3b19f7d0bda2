//! Groups of matrices, from a basis of their algebra alone.
//!
//! With linearly independent matrices `E₁ … E_d` of exact numbers, closed under the commutator, everything that a step
//! needs follows:
//!
//! * [`Algebra`]: `x` stands for `X = Σ xᵢ Eᵢ`; `[E_i, E_j] = Σ c_ij^k E_k` by exact linear algebra,
//!   `(ad*_x m)_j = Σ c_ij^k xᵢ m_k`.
//! * Storage: the matrix `g` by rows; `g' = g X`. What all elements have in common is taken from the
//!   [`AssociativeEnvelope`], not from storage.
//! * `exp x` and `dR exp_x = φ₁(ad_x)`, [ideal](Ideal) by ideal, where `X` and `ad_x` are annihilated by a polynomial
//!   `λᵃ (λ² + z)^q` with `z` quadratic in `x`: then their power series are finite sums with Stumpff functions of `z`.
//!   Otherwise the series are summed up to the rounding of a double within [a ball](RADIUS) about zero.
//! * `cay x = 2 (1 − X/2)⁻¹ − 1`, `dR cay_x y = (1 − X/2)⁻¹ Y (1 + X/2)⁻¹`, which stays on the group if and only if
//!   `E_i E_j E_k + E_k E_j E_i` is in the algebra for all `i`, `j`, `k`.
//! * Most groups keep a [form](InvariantForm), `g J gᵀ = J`. Where `J` is regular `g⁻¹ = J gᵀ J⁻¹`; one Newton step of
//!   that equation takes an error of rounding away, and one of `det g = 1`, of blocks of rows, where that does not
//!   follow from it.

mod algebra;
mod basis;
mod cayley;
mod constraints;
mod determinants;
mod ideals;
mod powers;
mod spaces;

pub use algebra::BasisError;
pub use basis::{Basis, NamedMatrix};
pub(super) use powers::TERMS;
pub use spaces::{Linear, LinearError};

use std::sync::Arc;

use num_rational::Ratio;

use super::calculus::transposed;
use super::{Group, GroupNames, MatrixFunction, Moved, Representation, Retraction, Side};
use crate::expr::{Expr, Matrix, Number, Vector};
use crate::quantity::Kind;
use algebra::{Algebra, symbolic};
use cayley::Cayley;
use constraints::{AssociativeEnvelope, InvariantForm};
use determinants::Determinant;
use ideals::Ideal;
use powers::LinearMatrix;

/// Where series of powers are summed: `|ad_x|² + |X|²` is at most the square of this, `3/2`.
const RADIUS: (i128, i128) = (3, 2);
/// The largest dimension of an algebra: what is found of it takes seconds then, and its steps are thousands of
/// operations.
pub const LARGEST_BASIS: usize = 16;
/// The most rows of a matrix.
const LARGEST_MATRIX: usize = 12;
/// The largest dimension of an algebra whose series are summed.
const LARGEST_SUMMED: usize = 10;

/// A group of matrices.
pub struct MatrixGroup {
    names: GroupNames,
    algebra: Algebra,
    ideals: Vec<Ideal>,
    hull: AssociativeEnvelope,
    form: Option<InvariantForm>,
    /// Those of blocks that are 1 for all elements.
    determinants: Vec<Determinant>,
    has_cayley: bool,
    cayley: Arc<Cayley>,
    /// The space of columns that it acts on.
    standard: [&'static dyn Representation; 1],
}

impl std::fmt::Debug for MatrixGroup {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("MatrixGroup").field("name", &self.names.name).finish_non_exhaustive()
    }
}

impl MatrixGroup {
    /// The largest dimension.
    pub const LARGEST: usize = LARGEST_BASIS;

    /// The group of a basis.
    ///
    /// # Errors
    /// If the matrices are dependent or not closed under the commutator, or if there are too many.
    pub fn new(name: &str, basis: &Basis) -> Result<&'static Self, BasisError> {
        Self::with_terms(name, basis, TERMS)
    }

    /// The same with so many terms of series that have no closed form: for numbers of more digits than a double's.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn with_terms(name: &str, basis: &Basis, terms: usize) -> Result<&'static Self, BasisError> {
        let size = basis.size();
        basis::bounded(basis.dimension(), size)?;
        let algebra = Algebra::new(basis.matrices.clone())?;
        let (hull, form) = (AssociativeEnvelope::of(&algebra.basis), InvariantForm::of(&algebra.basis));
        let ideals = Ideal::all(&algebra, terms);
        let is_exact = hull.is_exact()
            && form.as_ref().is_none_or(InvariantForm::is_exact)
            && ideals.iter().all(Ideal::is_exact);
        if !is_exact {
            return Err(BasisError::TooLarge);
        }
        // names live as long as the groups that they are of, which is as long as the process
        let names = GroupNames {
            name: name.to_owned().leak(),
            conventions: "element: matrix from body to space coordinates; momentum and velocity: coordinates with respect to the basis",
            configuration: "element",
            kind: Kind::Matrix(size, size),
            coordinates: leaked((0..size * size).map(|k| entry_name(k / size, k % size))),
            unit_coordinates: 0,
            axes: leaked(basis.axes.iter().cloned()),
            blocks: basis.blocks.clone().leak(),
            parts: leaked(basis.parts.iter().cloned()),
            components: &[],
        };
        let rho = match ideals.as_slice() {
            [whole] => whole.matrix().clone(),
            _ => LinearMatrix::new(algebra.basis.clone(), terms),
        };
        let is_definite = form.as_ref().is_some_and(|form| form.is_definite);
        let has_cayley = algebra.has_cayley();
        let standard = Linear::new(format!("R{size}").leak(), rho, has_cayley, is_definite);
        Ok(Box::leak(Box::new(Self {
            names,
            determinants: Determinant::all(&algebra.basis, &hull, form.as_ref()),
            has_cayley,
            cayley: Arc::new(Cayley::new(&algebra, form.as_ref())),
            algebra,
            ideals,
            hull,
            form,
            standard: [standard],
        })))
    }

    /// Rows and columns of the matrices.
    pub fn size(&self) -> usize {
        self.algebra.size()
    }

    /// The entry of a basis matrix, as a fraction.
    pub fn basis_entry(&self, axis: usize, row: usize, column: usize) -> (i128, i128) {
        let entry = self.algebra.basis[axis].at(row, column);
        entry.parts().unwrap_or((0, 1))
    }

    /// Whether the exponential and its logarithmic derivative are finite sums.
    fn is_closed(&self) -> bool {
        self.ideals.iter().all(Ideal::is_closed)
    }

    /// The entries of `f(x)`.
    fn function<'a>(&self, f: MatrixFunction, x: &Vector<'a>) -> Matrix<'a> {
        let one = Matrix::identity(x.0[0].arena(), self.size());
        match f {
            MatrixFunction::Exponential | MatrixFunction::Coarse => {
                let column = |j: usize| {
                    self.ideals.iter().fold(one.column(j), |column, ideal| ideal.exponential(f, x, &column))
                };
                Matrix::from_columns(&(0..self.size()).map(column).collect::<Vec<_>>())
            }
            MatrixFunction::Cayley => {
                self.cayley.resolvent(x).zip(&one, |inverse, one| inverse.scale(2) - one)
            }
        }
    }

    /// `g` with this share of one Newton step of `g J gᵀ = J` on what `J` acts on, and of `det g = 1` where no form
    /// says so.
    fn normalized<'a>(&self, g: &Vector<'a>, share: Expr<'a>) -> Vector<'a> {
        let (arena, matrix) = (share.arena(), self.hull.matrix(g));
        let mut next = matrix.clone();
        if let Some(form) = &self.form {
            let (j, back) = (symbolic(arena, &form.matrix), symbolic(arena, &form.inverse));
            let defect = matrix.times_matrix(&j).times_matrix(&matrix.transpose()).zip(&j, |a, b| a - b);
            let acted_on = matrix.times_matrix(&j).times_matrix(&back);
            let correction = defect.times_matrix(&back).times_matrix(&acted_on);
            let half = share / 2;
            next = next.zip(&correction, |g, correction| g - half * correction);
        }
        for determinant in self.determinants.iter().filter(|determinant| determinant.is_free()) {
            let correction = determinant.correction(&matrix, share);
            next.entries =
                next.entries.iter().zip(correction).map(|(&g, correction)| g + correction).collect();
        }
        Vector(self.hull.matrix(&Vector(next.entries)).entries)
    }
}

/// `11`, `12`, …: row and column, from 1 on.
fn entry_name(row: usize, column: usize) -> String {
    format!("{}{}", row + 1, column + 1)
}

/// Names live as long as the groups that they are of, which is as long as the process.
fn leaked(names: impl Iterator<Item = String>) -> &'static [&'static str] {
    let names: Vec<&'static str> = names.map(|name| &*name.leak()).collect();
    names.leak()
}

impl Group for MatrixGroup {
    fn names(&self) -> &GroupNames {
        &self.names
    }

    fn simple_basis(&self) -> Option<Vec<Vec<Ratio<i64>>>> {
        self.algebra.echelon()
    }

    fn bracket<'a>(&self, x: &Vector<'a>, y: &Vector<'a>) -> Vector<'a> {
        self.algebra.bracket(x, y)
    }

    fn closed_form<'a>(&self, f: MatrixFunction, x: &Vector<'a>) -> Vector<'a> {
        Vector(self.function(f, x).entries)
    }

    fn closed_d_right_dual<'a>(&self, f: MatrixFunction, x: &Vector<'a>, m: &Vector<'a>) -> Vector<'a> {
        match f {
            MatrixFunction::Exponential | MatrixFunction::Coarse => {
                let parts = self.ideals.iter().map(|ideal| ideal.d_right_dual(f, x, m));
                parts.reduce(|sum, part| &sum + &part).unwrap_or_else(|| m.clone())
            }
            MatrixFunction::Cayley => self.cayley.d_right_dual(x, m),
        }
    }

    fn closed_d_right<'a>(&self, f: MatrixFunction, x: &Vector<'a>, y: &Vector<'a>) -> Vector<'a> {
        match f {
            MatrixFunction::Exponential | MatrixFunction::Coarse => {
                let parts = self.ideals.iter().map(|ideal| ideal.d_right(f, x, y));
                parts.reduce(|sum, part| &sum + &part).unwrap_or_else(|| y.clone())
            }
            MatrixFunction::Cayley => transposed(y, y.len(), |m| self.closed_d_right_dual(f, x, m)),
        }
    }

    fn has_function(&self, f: MatrixFunction) -> bool {
        match f {
            MatrixFunction::Cayley => self.has_cayley,
            _ => self.is_closed() || self.dimension() <= LARGEST_SUMMED,
        }
    }

    fn is_summed(&self, retraction: Retraction) -> bool {
        retraction == Retraction::Exponential && !self.is_closed()
    }

    fn closed_domain<'a>(&self, f: MatrixFunction, x: &Vector<'a>) -> Vec<Expr<'a>> {
        let arena = x.0[0].arena();
        match f {
            MatrixFunction::Exponential | MatrixFunction::Coarse => {
                let edge = |ideal: &Ideal| {
                    let (x, adjoint, matrix) = (ideal.part(x), ideal.adjoint(), ideal.matrix());
                    if !ideal.is_closed() {
                        let size = adjoint.squared_norm(&x) + matrix.squared_norm(&x);
                        return Some(arena.number(Number::ratio(RADIUS.0, RADIUS.1).powi(2)) - size);
                    }
                    // dR exp is singular where ad_x has the eigenvalue 2πi
                    Some(arena.number(Number::FOUR_PI_SQUARED) - adjoint.argument(&x)?)
                };
                self.ideals.iter().filter_map(edge).collect()
            }
            // the eigenvalue 2 of X is that of no element that is skew with respect to a definite form, or nilpotent
            MatrixFunction::Cayley => {
                let is_elliptic = self.ideals.iter().all(|ideal| ideal.matrix().is_elliptic());
                let is_definite = self.form.as_ref().is_some_and(|form| form.is_definite);
                let edge = || self.algebra.one_plus(x, Number::ratio(-1, 2)).determinant();
                if is_elliptic || is_definite { Vec::new() } else { vec![edge()] }
            }
        }
    }

    fn compose<'a>(&self, g: &Vector<'a>, h: &Vector<'a>) -> Vector<'a> {
        let product = Vector(self.hull.matrix(g).times_matrix(&self.hull.matrix(h)).entries);
        Vector(self.hull.matrix(&product).entries)
    }

    fn inverse<'a>(&self, g: &Vector<'a>) -> Vector<'a> {
        let g = self.hull.matrix(g);
        let inverse = match &self.form {
            Some(form) if form.is_regular => form.adjoint(&g),
            _ => g.inverse(),
        };
        Vector(self.hull.matrix(&Vector(inverse.entries)).entries)
    }

    /// One Newton step of `g J gᵀ = J` on what `J` acts on, and of `det g = 1` where no form says so.
    fn normalize<'a>(&self, g: &Vector<'a>) -> Vector<'a> {
        self.normalized(g, g.0[0].arena().one())
    }

    /// What does not move is not normalized either. Products of its entries are off by their rounding, so that each
    /// step would make another element of it: `|x|²/(|x|² + ε)` is 0 at rest, and 1 where it moves by more than
    /// rounding.
    fn moved<'a>(&self, side: Side, retraction: Retraction, g: &Vector<'a>, x: &Vector<'a>) -> Moved<'a> {
        let increment = self.retract(retraction, x).hold();
        let moved = side.compose(self, g, &increment).hold();
        let (size, small) = (x.squared_norm().hold(), x.0[0].arena().number(Number::ratio(1, 1 << 120)));
        let next = self.normalized(&moved, (size / (size + small)).hold());
        Moved { increment, moved, next }
    }

    fn deviation<'a>(&self, g: &Vector<'a>) -> Option<Vector<'a>> {
        let (next, matrix) = (&self.normalize(g) - g, self.hull.matrix(g));
        let determinants = self.determinants.iter().flat_map(|determinant| determinant.deviation(&matrix));
        let parts: Vec<Expr<'a>> = next.iter().chain(determinants).filter(|part| !part.is_zero()).collect();
        (!parts.is_empty()).then_some(Vector(parts))
    }

    fn to_space<'a>(&self, g: &Vector<'a>, m: &Vector<'a>) -> Vector<'a> {
        let back = self.hull.matrix(&self.inverse(g));
        self.algebra.pulled_back(&back, m, &self.hull.matrix(g))
    }

    /// The standard one.
    fn representations(&self) -> &[&'static dyn Representation] {
        &self.standard
    }

    fn act<'a>(&self, g: &Vector<'a>, v: &Vector<'a>) -> Option<Vector<'a>> {
        (v.len() == self.size()).then(|| self.hull.matrix(g).times(v))
    }

    fn basis(&self) -> Option<Basis> {
        let owned = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect();
        let (axes, parts) = (owned(self.names.axes), owned(self.names.parts));
        Some(Basis { axes, matrices: self.algebra.basis.clone(), blocks: self.blocks(), parts })
    }

    fn matrix_rows(&self) -> Option<usize> {
        Some(self.size())
    }

    /// `1 + D`, to first order.
    fn near<'a>(&self, side: Side, g: &Vector<'a>, delta: &Vector<'a>) -> Vector<'a> {
        let increment = Vector(self.algebra.one_plus(delta, Number::ONE).entries);
        side.compose(self, g, &increment)
    }
}
