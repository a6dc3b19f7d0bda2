//! Lie algebras of matrices: which sets of matrices are the basis of one, and the coordinates of its elements.

use num_rational::Ratio;

use crate::expr::{Arena, Expr, Matrix, Number, Vector};
use crate::group::Structure;
use crate::group::exact::{Rational, RationalMatrix};

/// Why matrices are no basis of a group.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum BasisError {
    /// This matrix is a combination of those before it.
    Dependent(usize),
    /// The commutator of these two is not a combination of the basis.
    NotClosed(usize, usize),
    /// The matrices are not square, not all of one size, or there is none.
    Shape,
    /// There are too many matrices, they are too large, or exact numbers grow too large on the way.
    TooLarge,
}

/// Linearly independent matrices `E₁ … E_d`, closed under the commutator.
#[derive(Clone, Debug)]
pub(super) struct Algebra {
    /// `E₁ … E_d`
    pub(super) basis: Vec<RationalMatrix>,
    pub(super) structure: Structure,
    readout: Readout,
}

/// Where coordinates are read off the entries of a matrix of the algebra.
#[derive(Clone, Debug)]
struct Readout {
    /// As many entries as there are coordinates, that tell all of them.
    entries: Vec<usize>,
    /// The coordinates from those.
    inverse: RationalMatrix,
}

impl Algebra {
    pub(super) fn new(basis: Vec<RationalMatrix>) -> Result<Self, BasisError> {
        let readout = Readout::of(&basis)?;
        if !readout.inverse.is_exact() {
            return Err(BasisError::TooLarge);
        }
        let structure = structure(&basis, &readout)?;
        Ok(Self { basis, structure, readout })
    }

    pub(super) fn dimension(&self) -> usize {
        self.basis.len()
    }

    /// Rows and columns of the matrices.
    pub(super) fn size(&self) -> usize {
        self.basis[0].rows
    }

    /// The coordinates of the basis in reduced echelon form, which is the same whatever basis the algebra is given by:
    /// of most algebras its matrices have few entries. None if numbers grow too large.
    pub(super) fn echelon(&self) -> Option<Vec<Vec<Ratio<i64>>>> {
        let inverse = &self.readout.inverse;
        (0..inverse.columns).map(|k| inverse.column(k).iter().map(Rational::ratio).collect()).collect()
    }

    /// The matrices of `ad_{E_1}, …`
    pub(super) fn adjoint(&self) -> Vec<RationalMatrix> {
        let d = self.dimension();
        let entry = |i: usize, k: usize, j: usize| {
            let constant = self.structure.bracket(i, j).iter().find(|(row, _)| *row == k);
            constant.map_or(Rational::zero(), |&(_, constant)| Rational::from(constant))
        };
        (0..d).map(|i| RationalMatrix::from_fn(d, d, |k, j| entry(i, k, j))).collect()
    }

    /// Whether the Cayley map stays on the group: `E_i E_j E_k + E_k E_j E_i` is in the algebra for all `i`, `j`, `k`.
    pub(super) fn has_cayley(&self) -> bool {
        let (d, e) = (self.dimension(), &self.basis);
        let products: Vec<RationalMatrix> = (0..d * d).map(|ij| e[ij / d].times(&e[ij % d])).collect();
        let is_inside = |i: usize, j: usize, k: usize| {
            let (first, second) = (products[i * d + j].times(&e[k]), products[k * d + j].times(&e[i]));
            let sum = first.plus(&second, Rational::one());
            sum.is_zero() || matches!(self.readout.coordinates(e, &sum), Ok(Some(_)))
        };
        (0..d).all(|i| (i..d).all(|k| (0..d).all(|j| is_inside(i, j, k))))
    }

    /// `X = Σ xᵢ Eᵢ`
    pub(super) fn hat<'a>(&self, x: &Vector<'a>) -> Matrix<'a> {
        combination(&self.basis, x)
    }

    /// `[x, y]`
    pub(super) fn bracket<'a>(&self, x: &Vector<'a>, y: &Vector<'a>) -> Vector<'a> {
        let mut bracket = vec![x.0[0].arena().zero(); x.len()];
        for (i, x) in x.iter().enumerate() {
            for (j, y) in y.iter().enumerate() {
                for (k, c) in self.structure.bracket(i, j) {
                    let c = Number::ratio((*c.numer()).into(), (*c.denom()).into());
                    bracket[*k] = bracket[*k] + (x * y).scale(c);
                }
            }
        }
        Vector(bracket)
    }

    /// `1 + c X`
    pub(super) fn one_plus<'a>(&self, x: &Vector<'a>, factor: Number) -> Matrix<'a> {
        let one = Matrix::identity(x.0[0].arena(), self.size());
        one.zip(&self.hat(x), |one, x| one + x.scale(factor))
    }

    /// `m · coordinates(A E_j B)` for each `j`.
    pub(super) fn pulled_back<'a>(&self, a: &Matrix<'a>, m: &Vector<'a>, b: &Matrix<'a>) -> Vector<'a> {
        self.pairings(&self.pulled_matrix(a, m, b))
    }

    /// `Aᵀ W Bᵀ`
    pub(super) fn pulled_matrix<'a>(&self, a: &Matrix<'a>, m: &Vector<'a>, b: &Matrix<'a>) -> Matrix<'a> {
        let w = combination(&self.covectors(), m);
        a.transpose().times_matrix(&w).times_matrix(&b.transpose())
    }

    /// `⟨A, E_j⟩` for each `j`.
    pub(super) fn pairings<'a>(&self, a: &Matrix<'a>) -> Vector<'a> {
        let entries = Vector(a.entries.clone());
        Vector(self.basis.iter().map(|e| weighted(&e.entries, &entries)).collect())
    }

    /// The matrices `W_i` with `⟨W_i, Z⟩ = z_i` for all matrices `Z` of the algebra, of coordinates `z`.
    pub(super) fn covectors(&self) -> Vec<RationalMatrix> {
        let (d, n) = (self.dimension(), self.size());
        let of = |i: usize| {
            let mut matrix = RationalMatrix::zero(n, n);
            for (k, &entry) in self.readout.entries.iter().enumerate() {
                matrix.entries[entry] = self.readout.inverse.at(i, k);
            }
            matrix
        };
        (0..d).map(of).collect()
    }
}

/// The structure constants.
fn structure(basis: &[RationalMatrix], readout: &Readout) -> Result<Structure, BasisError> {
    let d = basis.len();
    let mut constants = Vec::with_capacity(d * d);
    for (i, first) in basis.iter().enumerate() {
        for (j, second) in basis.iter().enumerate() {
            let bracket = first.commutator(second);
            let coordinates = readout.coordinates(basis, &bracket)?.ok_or(BasisError::NotClosed(i, j))?;
            let filled = coordinates.into_iter().enumerate().filter(|(_, c)| !c.is_zero());
            let row = filled.map(|(k, c)| Ok((k, c.ratio().ok_or(BasisError::TooLarge)?)));
            constants.push(row.collect::<Result<Vec<_>, BasisError>>()?);
        }
    }
    Ok(Structure::new(d, |i, j| constants[i * d + j].clone()))
}

impl Readout {
    fn of(basis: &[RationalMatrix]) -> Result<Self, BasisError> {
        let d = basis.len();
        let rows = RationalMatrix::from_fn(d, basis[0].entries.len(), |i, k| basis[i].entries[k]);
        let mut columns = rows.transpose();
        let independent = columns.reduce();
        if !columns.is_exact() {
            return Err(BasisError::TooLarge);
        }
        if let Some(i) = (0..d).find(|i| !independent.contains(i)) {
            return Err(BasisError::Dependent(i));
        }
        let entries = rows.clone().reduce();
        let square = RationalMatrix::from_fn(d, d, |k, i| basis[i].entries[entries[k]]);
        let inverse = square.inverse().ok_or(BasisError::Dependent(0))?;
        Ok(Self { entries, inverse })
    }

    /// The coordinates of a matrix; none if it is not in the algebra, and an error if that cannot be told.
    fn coordinates(
        &self,
        basis: &[RationalMatrix],
        matrix: &RationalMatrix,
    ) -> Result<Option<Vec<Rational>>, BasisError> {
        let d = basis.len();
        let entries = RationalMatrix::from_fn(d, 1, |k, _| matrix.entries[self.entries[k]]);
        let coordinates = self.inverse.times(&entries).entries;
        let parts = basis.iter().zip(&coordinates).filter(|(_, c)| !c.is_zero());
        let difference = parts.fold(matrix.clone(), |rest, (e, c)| rest.plus(e, -*c));
        if !difference.is_exact() {
            return Err(BasisError::TooLarge);
        }
        Ok(difference.is_zero().then_some(coordinates))
    }
}

/// `Σ xᵢ Aᵢ`
pub(super) fn combination<'a>(matrices: &[RationalMatrix], x: &Vector<'a>) -> Matrix<'a> {
    let (rows, columns) = (matrices[0].rows, matrices[0].columns);
    let entry = |k: usize| {
        let coefficients: Vec<Rational> = matrices.iter().map(|matrix| matrix.entries[k]).collect();
        weighted(&coefficients, x)
    };
    Matrix::new(rows, columns, (0..rows * columns).map(entry).collect())
}

/// `A x`
pub(super) fn image<'a>(matrix: &RationalMatrix, x: &Vector<'a>) -> Vector<'a> {
    Vector((0..matrix.rows).map(|i| weighted(matrix.row(i), x)).collect())
}

/// `Σ cᵢ xᵢ`
fn weighted<'a>(coefficients: &[Rational], x: &Vector<'a>) -> Expr<'a> {
    let terms = coefficients.iter().zip(x.iter()).filter(|(c, _)| !c.is_zero());
    terms.fold(x.0[0].arena().zero(), |sum, (c, x)| sum + x.scale(number(*c)))
}

pub(super) fn symbolic<'a>(arena: &'a Arena, matrix: &RationalMatrix) -> Matrix<'a> {
    let entries = matrix.entries.iter().map(|&entry| arena.number(number(entry)));
    Matrix::new(matrix.rows, matrix.columns, entries.collect())
}

pub(super) fn number(fraction: Rational) -> Number {
    // a group is made of known numbers alone
    let (numerator, denominator) = fraction.parts().unwrap_or((0, 1));
    Number::ratio(numerator, denominator)
}
