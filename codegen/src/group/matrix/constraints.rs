//! What all elements of a group of matrices have in common: linear relations between their entries, and forms that they
//! keep.

use super::algebra::{number, symbolic};
use crate::expr::{Matrix, Vector};
use crate::group::exact::{Rational, RationalMatrix};

/// The affine space of matrices `1 + A`, with the algebra `A` that is spanned by all products of the basis: elements of
/// the group lie in it, so that some of their entries tell all others.
#[derive(Clone, Debug)]
pub(super) struct AssociativeEnvelope {
    /// The entries that tell all, each with what it adds to every entry.
    pub(super) rows: Vec<(usize, Vec<Rational>)>,
}

impl AssociativeEnvelope {
    pub(super) fn of(basis: &[RationalMatrix]) -> Self {
        let n = basis[0].rows;
        let mut span: Vec<RationalMatrix> = Vec::new();
        let mut new = basis.to_vec();
        loop {
            // what has grown too large is an error at the end, and no reason to go on
            let is_exact = new.iter().all(RationalMatrix::is_exact);
            span.append(&mut new);
            let mut rows = RationalMatrix::from_fn(span.len(), n * n, |i, k| span[i].entries[k]);
            let pivots = rows.reduce();
            let row = |r: usize| RationalMatrix::from_fn(n, n, |i, j| rows.at(r, i * n + j));
            let reduced: Vec<RationalMatrix> = (0..pivots.len()).map(row).collect();
            let is_new = |product: &RationalMatrix| {
                let known = reduced.iter().zip(&pivots);
                !known
                    .fold(product.clone(), |rest, (row, &pivot)| rest.plus(row, -product.entries[pivot]))
                    .is_zero()
            };
            let products = reduced.iter().flat_map(|a| basis.iter().map(move |e| a.times(e)));
            new = products.filter(is_new).collect();
            span = reduced;
            if new.is_empty() || !is_exact {
                let entries = span.into_iter().map(|row| row.entries);
                return Self { rows: pivots.into_iter().zip(entries).collect() };
            }
        }
    }

    /// Whether it is a sum of products of the basis.
    pub(super) fn contains(&self, matrix: &RationalMatrix) -> bool {
        let mut rest = matrix.entries.clone();
        for (pivot, row) in &self.rows {
            let factor = rest[*pivot];
            rest.iter_mut().zip(row).for_each(|(entry, &x)| *entry = *entry - factor * x);
        }
        rest.iter().all(Rational::is_zero)
    }

    pub(super) fn is_exact(&self) -> bool {
        self.rows.iter().all(|(_, row)| row.iter().all(Rational::is_exact))
    }

    /// An element of the group as a matrix, with what is known of its entries.
    pub(super) fn matrix<'a>(&self, g: &Vector<'a>) -> Matrix<'a> {
        let (n, arena) = (g.len().isqrt(), g.0[0].arena());
        let one = |k: usize| i64::from(k / n == k % n);
        let entry = |k: usize| {
            let terms = self.rows.iter().filter(|(_, row)| !row[k].is_zero());
            terms.fold(arena.number(one(k)), |sum, (pivot, row)| {
                let change = if *pivot == k && one(k) == 0 { g.0[k] } else { g.0[*pivot] - one(*pivot) };
                sum + change.scale(number(row[k]))
            })
        };
        Matrix::new(n, n, (0..n * n).map(entry).collect())
    }
}

/// A form `J` with `g J gᵀ = J` for all elements, symmetric on some rows and antisymmetric on others.
#[derive(Clone, Debug)]
pub(super) struct InvariantForm {
    pub(super) matrix: RationalMatrix,
    /// `J⁻¹` on the rows on which it acts, zero on others.
    pub(super) inverse: RationalMatrix,
    pub(super) is_regular: bool,
    pub(super) is_definite: bool,
}

impl InvariantForm {
    /// A symmetric form on the rows that are not constant, and an antisymmetric one on those that it leaves.
    pub(super) fn of(basis: &[RationalMatrix]) -> Option<Self> {
        let n = basis[0].rows;
        let moves = |i: &usize| basis.iter().any(|e| (0..n).any(|j| !e.at(*i, j).is_zero()));
        let rows: Vec<usize> = (0..n).filter(moves).collect();
        let symmetric = Self::of_kind(basis, &rows, true);
        let is_left = |i: &usize| {
            symmetric.as_ref().is_none_or(|form| form.matrix.row(*i).iter().all(Rational::is_zero))
        };
        let left: Vec<usize> = rows.into_iter().filter(is_left).collect();
        let antisymmetric = Self::of_kind(basis, &left, false);
        match (symmetric, antisymmetric) {
            (Some(symmetric), Some(antisymmetric)) => Some(symmetric.beside(&antisymmetric)),
            (symmetric, antisymmetric) => symmetric.or(antisymmetric),
        }
    }

    pub(super) fn is_exact(&self) -> bool {
        self.matrix.is_exact() && self.inverse.is_exact()
    }

    /// `J Aᵀ J⁻¹`
    pub(super) fn adjoint<'a>(&self, a: &Matrix<'a>) -> Matrix<'a> {
        let arena = a.entries[0].arena();
        let (j, inverse) = (symbolic(arena, &self.matrix), symbolic(arena, &self.inverse));
        j.times_matrix(&a.transpose()).times_matrix(&inverse)
    }

    /// Both, which act on different rows.
    fn beside(&self, other: &Self) -> Self {
        let matrix = self.matrix.plus(&other.matrix, Rational::one());
        let inverse = self.inverse.plus(&other.inverse, Rational::one());
        let is_regular = (0..matrix.rows).all(|i| matrix.row(i).iter().any(|entry| !entry.is_zero()));
        Self { matrix, inverse, is_regular, is_definite: false }
    }

    fn of_kind(basis: &[RationalMatrix], rows: &[usize], symmetric: bool) -> Option<Self> {
        let n = basis[0].rows;
        // unknowns: the entries of J on or above the diagonal
        let places: Vec<(usize, usize)> = rows
            .iter()
            .flat_map(|&i| rows.iter().map(move |&j| (i, j)))
            .filter(|(i, j)| if symmetric { i <= j } else { i < j })
            .collect();
        let unit = |(i, j): (usize, usize)| {
            let sign = if symmetric { Rational::one() } else { -Rational::one() };
            RationalMatrix::from_fn(n, n, |k, l| match ((k, l) == (i, j), (k, l) == (j, i)) {
                (true, _) => Rational::one(),
                (_, true) => sign,
                _ => Rational::zero(),
            })
        };
        let units: Vec<RationalMatrix> = places.iter().map(|&place| unit(place)).collect();
        // E J + J Eᵀ = 0 for each E
        let columns: Vec<Vec<Rational>> = units
            .iter()
            .map(|j| {
                basis
                    .iter()
                    .flat_map(|e| e.times(j).plus(&j.times(&e.transpose()), Rational::one()).entries)
                    .collect()
            })
            .collect();
        columns.first()?;
        let equations = RationalMatrix::from_columns(&columns);
        let forms: Vec<RationalMatrix> =
            equations.kernel().iter().map(|kernel| RationalMatrix::combination(&units, kernel)).collect();
        let zero = RationalMatrix::zero(n, n);
        let all = forms.iter().fold(zero, |sum, form| sum.plus(form, Rational::one()));
        forms.into_iter().chain([all]).rev().find_map(|form| Self::with(form, n))
    }

    /// With its inverse on the rows on which it acts.
    fn with(matrix: RationalMatrix, n: usize) -> Option<Self> {
        let acts = |i: &usize| (0..n).any(|j| !matrix.at(*i, j).is_zero());
        let rows: Vec<usize> = (0..n).filter(acts).collect();
        if rows.is_empty() {
            return None;
        }
        let block = matrix.block(&rows);
        let inverse = block.inverse()?.embedded(n, &rows);
        let definite =
            |block: &RationalMatrix| block.transpose() == *block && block.is_positive_semidefinite();
        let is_regular = rows.len() == n;
        let is_definite = is_regular && (definite(&block) || definite(&block.map(|entry| -entry)));
        Some(Self { matrix, inverse, is_regular, is_definite })
    }
}
