//! Determinants of blocks of rows, real or complex, that are 1 for all elements of a group: of blocks that are found
//! easily, not of all.

use super::algebra::symbolic;
use super::constraints::{AssociativeEnvelope, InvariantForm};
use crate::expr::{Expr, Matrix, Number, uncoupled};
use crate::group::exact::{Rational, RationalMatrix};

/// The most rows: a determinant is expanded row by row.
const LARGEST: usize = 6;

/// The determinant of a block of rows and columns.
#[derive(Clone, Debug)]
pub(super) struct Determinant {
    rows: Vec<usize>,
    /// `J` with `J² = −1` that commutes with all elements on these rows, if there is one: the determinant is that of
    /// half as many complex rows.
    imaginary_unit: Option<ImaginaryUnit>,
    /// Whether the form lets its modulus change, and its phase.
    has_free_modulus: bool,
    has_free_phase: bool,
}

/// A matrix `J` with `J² = −1`.
#[derive(Clone, Debug)]
struct ImaginaryUnit {
    matrix: RationalMatrix,
    /// Columns `v`, `J v` that span all, and the inverse.
    basis: RationalMatrix,
    inverse: RationalMatrix,
}

impl Determinant {
    /// Of each set of rows that the others do not act on, or that do not act on the others; rows of a form and rows
    /// without one are apart.
    pub(super) fn all(
        basis: &[RationalMatrix],
        hull: &AssociativeEnvelope,
        form: Option<&InvariantForm>,
    ) -> Vec<Self> {
        let has_form =
            |&i: &usize| form.is_some_and(|form| !form.matrix.row(i).iter().all(Rational::is_zero));
        let moves = |&i: &usize| basis.iter().any(|e| !e.row(i).iter().all(Rational::is_zero));
        let coupled =
            |i: usize, j: usize| basis.iter().any(|e| !e.at(i, j).is_zero() || !e.at(j, i).is_zero());
        let parts = uncoupled(basis[0].rows, coupled).into_iter().flat_map(|rows| {
            let (kept, free): (Vec<usize>, Vec<usize>) = rows.into_iter().filter(moves).partition(has_form);
            [kept, free]
        });
        parts.filter_map(|rows| Self::of(rows, basis, hull, form)).collect()
    }

    fn of(
        rows: Vec<usize>,
        basis: &[RationalMatrix],
        hull: &AssociativeEnvelope,
        form: Option<&InvariantForm>,
    ) -> Option<Self> {
        let n = basis[0].rows;
        let unit = RationalMatrix::identity(rows.len()).embedded(n, &rows);
        let others: Vec<usize> = (0..n).filter(|i| !rows.contains(i)).collect();
        let is_zero = |from: &[usize], to: &[usize]| {
            basis.iter().all(|e| from.iter().all(|&j| to.iter().all(|&i| e.at(i, j).is_zero())))
        };
        let is_invariant = is_zero(&rows, &others) || is_zero(&others, &rows);
        let is_traceless = |unit: &RationalMatrix| basis.iter().all(|e| unit.times(e).trace().is_zero());
        let fits = (1..=LARGEST).contains(&rows.len()) && is_invariant && hull.contains(&unit);
        if !fits || !is_traceless(&unit) {
            return None;
        }
        // a multiple of the block is free if it keeps the form
        let is_free = |unit: &RationalMatrix| {
            form.is_none_or(|InvariantForm { matrix, .. }| {
                unit.times(matrix).plus(&matrix.times(&unit.transpose()), Rational::one()).is_zero()
            })
        };
        let imaginary_unit = ImaginaryUnit::of(&rows, basis, hull);
        let imaginary_unit = imaginary_unit.filter(|ImaginaryUnit { matrix, .. }| is_traceless(matrix));
        // of what no multiple changes, only a symmetric form of this block leaves open the sign
        let is_reflected = form.is_some_and(|InvariantForm { matrix, .. }| {
            let of_block = unit.times(matrix);
            of_block == matrix.times(&unit) && of_block == of_block.transpose()
        });
        let has_free_phase = imaginary_unit.as_ref().is_some_and(|imaginary| is_free(&imaginary.matrix));
        let determinant = Self { has_free_modulus: is_free(&unit), has_free_phase, imaginary_unit, rows };
        (determinant.is_free() || is_reflected).then_some(determinant)
    }

    /// The determinant less 1, as one number or as real and imaginary part.
    pub(super) fn deviation<'a>(&self, g: &Matrix<'a>) -> Vec<Expr<'a>> {
        let n = self.rows.len();
        let block = g.block(&self.rows);
        let Some(ImaginaryUnit { basis, inverse, .. }) = &self.imaginary_unit else {
            return vec![block.determinant() - 1];
        };
        let arena = g.entries[0].arena();
        let block = symbolic(arena, inverse).times_matrix(&block).times_matrix(&symbolic(arena, basis));
        let all: Vec<usize> = (0..n / 2).collect();
        let (re, im) = complex_determinant(&block, &all, &all);
        vec![re - 1, im]
    }

    /// What a Newton step adds to an element, by which its determinant becomes 1.
    pub(super) fn correction<'a>(&self, g: &Matrix<'a>, share: Expr<'a>) -> Vec<Expr<'a>> {
        let (n, arena) = (g.rows, share.arena());
        let mut correction = vec![arena.zero(); n * n];
        let deviation = self.deviation(g);
        let rows = self.rows.len() / deviation.len();
        let factor = |part: Expr<'a>| share * part.scale(Number::ratio(-1, rows as i128));
        if self.has_free_modulus {
            let factor = factor(deviation[0]);
            for k in self.rows.iter().flat_map(|&i| i * n..(i + 1) * n) {
                correction[k] = correction[k] + g.entries[k] * factor;
            }
        }
        if let (true, Some(unit)) = (self.has_free_phase, &self.imaginary_unit) {
            let (turned, factor) = (symbolic(arena, &unit.matrix).times_matrix(g), factor(deviation[1]));
            for (sum, entry) in correction.iter_mut().zip(turned.entries) {
                *sum = *sum + entry * factor;
            }
        }
        correction
    }

    /// Whether there is something that a form does not do.
    pub(super) fn is_free(&self) -> bool {
        self.has_free_modulus || self.has_free_phase
    }
}

impl ImaginaryUnit {
    /// The one that commutes with these rows of all matrices of a basis and is zero elsewhere, if elements of the group
    /// may be multiplied by it; none if there is none, or more. Multiples of 1 on these rows are in the hull.
    fn of(rows: &[usize], basis: &[RationalMatrix], hull: &AssociativeEnvelope) -> Option<Self> {
        let (n, size) = (basis[0].rows, rows.len());
        let mut blocks = RationalMatrix::from_fn(hull.rows.len(), size * size, |r, k| {
            hull.rows[r].1[rows[k / size] * n + rows[k % size]]
        });
        let count = blocks.reduce().len();
        // complex matrices are half of all
        if size % 2 != 0 || 2 * count > size * size {
            return None;
        }
        let element = |r: usize| RationalMatrix::new(size, size, blocks.row(r).to_vec());
        let elements: Vec<RationalMatrix> = (0..count).map(element).collect();
        let of_basis: Vec<RationalMatrix> = basis.iter().map(|e| e.block(rows)).collect();
        let commutators =
            |element: &RationalMatrix| of_basis.iter().flat_map(|e| element.commutator(e).entries).collect();
        let centre =
            RationalMatrix::from_columns(&elements.iter().map(commutators).collect::<Vec<_>>()).kernel();
        // 1 and the unit, or a sum of both
        let [first, second] = centre.as_slice() else { return None };
        let without_trace = |solution: &Vec<Rational>| {
            let element = RationalMatrix::combination(&elements, solution);
            let share = element.trace() / (size as i128).into();
            element.plus(&RationalMatrix::identity(size), -share)
        };
        let multiple = [first, second].map(without_trace).into_iter().find(|element| !element.is_zero())?;
        let root = (-multiple.times(&multiple).at(0, 0)).square_root()?;
        let unit = multiple.scaled(Rational::one() / root);
        if !unit.times(&unit).plus(&RationalMatrix::identity(size), Rational::one()).is_zero() {
            return None;
        }
        let mut columns: Vec<Vec<Rational>> = Vec::new();
        for k in 0..size {
            let mut more = columns.clone();
            more.extend([RationalMatrix::identity(size).column(k), unit.column(k)]);
            if RationalMatrix::from_columns(&more).reduce().len() == more.len() {
                columns = more;
            }
        }
        let basis = RationalMatrix::from_columns(&columns);
        let inverse = basis.inverse().filter(RationalMatrix::is_exact)?;
        Some(Self { matrix: unit.embedded(n, rows), basis, inverse })
    }
}

/// The determinant of rows and columns of complex numbers, `a + ib` as the first column of `[[a, −b], [b, a]]`: real
/// and imaginary part.
fn complex_determinant<'a>(matrix: &Matrix<'a>, rows: &[usize], columns: &[usize]) -> (Expr<'a>, Expr<'a>) {
    let arena = matrix.entries[0].arena();
    let Some((&row, others)) = rows.split_first() else { return (arena.one(), arena.zero()) };
    columns.iter().enumerate().fold((arena.zero(), arena.zero()), |(re, im), (k, &column)| {
        let rest: Vec<usize> = columns.iter().copied().filter(|&other| other != column).collect();
        let (a, b) = (matrix.at(2 * row, 2 * column), matrix.at(2 * row + 1, 2 * column));
        let (c, d) = complex_determinant(matrix, others, &rest);
        let (x, y) = (a * c - b * d, a * d + b * c);
        if k % 2 == 0 { (re + x, im + y) } else { (re - x, im - y) }
    })
}
