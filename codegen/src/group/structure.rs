//! A Lie algebra by its structure constants.

use num_rational::Ratio;

use super::Semidirect;
use super::exact::{Rational, RationalMatrix};
use crate::expr::{Arena, Stage, Vector};

/// `[E_i, E_j] = Σ_k c_ij^k E_k`, exact.
#[derive(Clone, Debug)]
pub struct Structure {
    dimension: usize,
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
        let arena = Arena::new();
        let symbols = |name: &str, dimension: usize| {
            Vector((0..dimension).map(|i| arena.symbol(format!("{name}{i}"), Stage::Step)).collect())
        };
        let base = algebra.group.dimension();
        let (x, y) = (symbols("x", base), symbols("y", base));
        let mut dimension = base;
        let mut constants = vec![(0, 0, algebra.group.bracket(&x, &y), x.clone(), y)];
        for (number, space) in algebra.spaces.iter().enumerate() {
            // [(x, 0), (0, u)] = (0, ρ_x u)
            let u = symbols(&format!("u{number}_"), space.coordinates().len());
            constants.push((dimension, dimension, space.act_infinitesimally(&x, &u), x.clone(), u.clone()));
            dimension += u.len();
        }
        let mut structure = Self { dimension, constants: vec![Vec::new(); dimension * dimension] };
        for (second, result, value, x, y) in constants {
            for (i, x) in x.symbols().into_iter().enumerate() {
                for (j, y) in y.symbols().into_iter().enumerate() {
                    for (k, component) in value.iter().enumerate() {
                        let (numerator, denominator) =
                            component.derivative(x).derivative(y).as_number()?.fraction()?;
                        let constant =
                            Ratio::new(i64::try_from(numerator).ok()?, i64::try_from(denominator).ok()?);
                        if numerator != 0 {
                            structure.add(i, second + j, result + k, constant);
                            if second > 0 {
                                structure.add(second + j, i, result + k, -constant);
                            }
                        }
                    }
                }
            }
        }
        Some(structure)
    }

    fn add(&mut self, i: usize, j: usize, k: usize, constant: Ratio<i64>) {
        self.constants[i * self.dimension + j].push((k, constant));
    }

    /// The dimension of the algebra.
    pub fn dimension(&self) -> usize {
        self.dimension
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
                for &(a, x) in &vectors[i] {
                    for &(b, y) in &vectors[j] {
                        for &(k, constant) in self.bracket(a, b) {
                            bracket.entries[k] = bracket.entries[k] + x * y * constant.into();
                        }
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
