//! A Lie algebra by its structure constants.

use num_rational::Ratio;

use super::Semidirect;
use super::exact::{Rational, RationalMatrix};
use super::representation::{matrices_of, matrices_of_action};

/// `[E_i, E_j] = Σ_k c_ij^k E_k`, exact.
#[derive(Clone, Debug)]
pub struct Structure {
    /// The dimension of the algebra.
    pub dimension: usize,
    /// For `i` and `j` the `k` with the constants that are not zero, at `i · dimension + j`.
    constants: Vec<Vec<(usize, Ratio<i64>)>>,
}

impl Structure {
    /// With these constants: `constant(i, j)` are the `k` with a `c_ij^k` that is not zero.
    pub fn new(dimension: usize, constant: impl Fn(usize, usize) -> Vec<(usize, Ratio<i64>)>) -> Self {
        let pairs = (0..dimension).flat_map(|i| (0..dimension).map(move |j| (i, j)));
        Self { dimension, constants: pairs.map(|(i, j)| constant(i, j)).collect() }
    }

    /// Of a semidirect algebra: first the group's own axes, then the spaces' coordinates. The brackets are derived from
    /// the group's bracket and the spaces' actions; none if a constant of theirs is not exact.
    pub fn of(algebra: &Semidirect) -> Option<Self> {
        let base = algebra.group.dimension();
        let mut actions = vec![(0, matrices_of_action(base, base, |x, y| algebra.group.bracket(x, y))?)];
        let mut dimension = base;
        for space in &algebra.spaces {
            // [(x, 0), (0, u)] = (0, ρ_x u)
            actions.push((dimension, matrices_of(*space)?));
            dimension += space.coordinates().len();
        }
        let mut structure = Self { dimension, constants: vec![Vec::new(); dimension * dimension] };
        for (first, matrices) in actions {
            for (i, matrix) in matrices.iter().enumerate() {
                for (place, entry) in matrix.entries.iter().enumerate().filter(|(_, entry)| !entry.is_zero())
                {
                    let (k, j) = (first + place / matrix.columns, first + place % matrix.columns);
                    let constant = entry.ratio()?;
                    structure.add(i, j, k, constant);
                    if first > 0 {
                        structure.add(j, i, k, -constant);
                    }
                }
            }
        }
        Some(structure)
    }

    fn add(&mut self, i: usize, j: usize, k: usize, constant: Ratio<i64>) {
        self.constants[i * self.dimension + j].push((k, constant));
    }

    /// The `k` with the `c_ij^k` that are not zero.
    pub fn bracket(&self, i: usize, j: usize) -> &[(usize, Ratio<i64>)] {
        &self.constants[i * self.dimension + j]
    }

    /// The same algebra with the combinations of `E_1, …` that these rows are instead of as many; the others stay. None
    /// if numbers grow too large.
    pub(super) fn in_basis(&self, rows: &[Vec<Ratio<i64>>]) -> Option<Self> {
        let (d, n) = (rows.len(), self.dimension);
        let basis =
            RationalMatrix::from_fn(d, d, |i, j| rows[i][j].into()).beside(&RationalMatrix::identity(n - d));
        let inverse = basis.inverse()?;
        let filled = |row: &[Rational]| -> Vec<(usize, Rational)> {
            row.iter().copied().enumerate().filter(|(_, x)| !x.is_zero()).collect()
        };
        let vectors: Vec<_> = (0..n).map(|i| filled(basis.row(i))).collect();
        let mut structure = Self { dimension: n, constants: vec![Vec::new(); n * n] };
        for i in 0..n {
            for j in 0..n {
                let mut bracket = RationalMatrix::zero(1, n);
                let pairs = vectors[i].iter().flat_map(|x| vectors[j].iter().map(move |y| (x, y)));
                for (&(a, x), &(b, y)) in pairs {
                    for &(k, constant) in self.bracket(a, b) {
                        bracket.entries[k] = bracket.entries[k] + x * y * constant.into();
                    }
                }
                for (k, constant) in filled(bracket.times(&inverse).row(0)) {
                    structure.add(i, j, k, constant.ratio()?);
                }
            }
        }
        Some(structure)
    }

    /// How many binary digits its constants have.
    pub(super) fn digits(&self) -> u32 {
        let digits = |part: &i64| part.unsigned_abs().checked_ilog2().unwrap_or(0);
        let constants = self.constants.iter().flatten();
        constants.map(|(_, constant)| 1 + digits(constant.numer()) + digits(constant.denom())).sum()
    }
}
