//! Small dense matrices of [`Real`] numbers: what definitions are stated with.

use std::ops::{Add, Index, Mul, Neg, Sub};

use crate::evaluate::Value;

use super::real::Real;
use crate::random::Random;

/// A column of numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Column(pub Vec<Real>);

/// A matrix, by rows.
#[derive(Clone, Debug, PartialEq)]
pub struct Matrix {
    rows: usize,
    columns: usize,
    entries: Vec<Real>,
}

impl Column {
    /// All zeros.
    pub fn zeros(dimension: usize) -> Self {
        Self(vec![Real::from(0); dimension])
    }

    /// The `i`-th unit vector.
    pub fn unit(dimension: usize, i: usize) -> Self {
        Self((0..dimension).map(|j| Real::from(i64::from(i == j))).collect())
    }

    /// Components between −1 and 1.
    pub fn random(dimension: usize, random: &mut Random) -> Self {
        Self((0..dimension).map(|_| Real::random(random)).collect())
    }

    /// The number of components.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// Whether there are no components.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// `factor · self`
    pub fn scale(&self, factor: &Real) -> Self {
        Self(self.0.iter().map(|x| factor * x).collect())
    }

    /// The dot product.
    pub fn dot(&self, other: &Self) -> Real {
        sum(self.0.iter().zip(&other.0))
    }

    /// The components from `start` on, `count` of them.
    pub fn part(&self, start: usize, count: usize) -> Self {
        Self(self.0[start..start + count].to_vec())
    }

    /// The columns one below the other.
    pub fn stack<'c>(columns: impl IntoIterator<Item = &'c Self>) -> Self {
        Self(columns.into_iter().flat_map(|column| column.0.clone()).collect())
    }

    /// The largest magnitude of a component.
    pub fn norm(&self) -> Real {
        largest(&self.0)
    }
}

impl Index<usize> for Column {
    type Output = Real;
    fn index(&self, i: usize) -> &Real {
        &self.0[i]
    }
}

/// Not a number counts as infinitely large.
fn largest(numbers: &[Real]) -> Real {
    numbers.iter().map(Real::abs).fold(Real::from(0), |largest, x| if x <= largest { largest } else { x })
}

/// The sum of products. Most matrices here are sparse, and a product with zero costs as much as any other.
fn sum<'r>(products: impl Iterator<Item = (&'r Real, &'r Real)>) -> Real {
    let nothing = |a: &Real, b: &Real| a.is_zero() && b.is_finite();
    let nonzero = products.filter(|(a, b)| !nothing(a, b) && !nothing(b, a));
    nonzero.map(|(a, b)| a * b).reduce(|sum, product| sum + product).unwrap_or_else(|| Real::from(0))
}

fn zip(a: &[Real], b: &[Real], f: impl Fn(&Real, &Real) -> Real) -> Vec<Real> {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| f(a, b)).collect()
}

impl Add for &Column {
    type Output = Column;
    fn add(self, other: Self) -> Column {
        Column(zip(&self.0, &other.0, |a, b| a + b))
    }
}

impl Sub for &Column {
    type Output = Column;
    fn sub(self, other: Self) -> Column {
        Column(zip(&self.0, &other.0, |a, b| a - b))
    }
}

impl Neg for &Column {
    type Output = Column;
    fn neg(self) -> Column {
        Column(self.0.iter().map(|x| -x).collect())
    }
}

impl Matrix {
    /// The matrix with these rows.
    pub fn from_rows<const ROWS: usize, const COLUMNS: usize>(rows: [[Real; COLUMNS]; ROWS]) -> Self {
        Self { rows: ROWS, columns: COLUMNS, entries: rows.into_iter().flatten().collect() }
    }

    /// The matrix with these columns.
    pub fn from_columns(columns: &[Column]) -> Self {
        let rows = columns.first().map_or(0, Column::len);
        Self::from_fn(rows, columns.len(), |i, j| columns[j][i].clone())
    }

    /// The matrix of a linear map on columns of so many components.
    pub fn of_linear(dimension: usize, map: impl Fn(&Column) -> Column) -> Self {
        let columns: Vec<Column> = (0..dimension).map(|j| map(&Column::unit(dimension, j))).collect();
        Self::from_columns(&columns)
    }

    /// The matrix with entries `entry(row, column)`.
    pub fn from_fn(rows: usize, columns: usize, entry: impl Fn(usize, usize) -> Real) -> Self {
        Self {
            rows,
            columns,
            entries: (0..rows * columns).map(|k| entry(k / columns, k % columns)).collect(),
        }
    }

    /// The unit matrix.
    pub fn identity(dimension: usize) -> Self {
        Self::from_fn(dimension, dimension, |i, j| Real::from(i64::from(i == j)))
    }

    /// The number of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// The entry in row `i` and column `j`.
    pub fn at(&self, i: usize, j: usize) -> &Real {
        &self.entries[i * self.columns + j]
    }

    /// The `j`-th column.
    pub fn column(&self, j: usize) -> Column {
        Column((0..self.rows).map(|i| self.at(i, j).clone()).collect())
    }

    /// All entries, row by row.
    pub fn entries(&self) -> Column {
        Column(self.entries.clone())
    }

    /// `factor · self`
    pub fn scale(&self, factor: &Real) -> Self {
        Self { entries: self.entries.iter().map(|x| factor * x).collect(), ..*self }
    }

    /// The transpose.
    pub fn transpose(&self) -> Self {
        Self::from_fn(self.columns, self.rows, |i, j| self.at(j, i).clone())
    }

    /// The largest magnitude of an entry.
    pub fn norm(&self) -> Real {
        largest(&self.entries)
    }

    /// `Σ coefficient(k) self^k`, until terms no longer count: in blocks of eight terms, which need a product for each power and each block.
    pub fn series(&self, coefficient: impl Fn(usize) -> Real) -> Self {
        const BLOCK: usize = 8;
        let mut powers = vec![Self::identity(self.rows)];
        for k in 0..BLOCK {
            powers.push(&powers[k] * self);
        }
        // how large terms may be
        let size = |i: usize| (0..self.columns).fold(Real::from(0), |sum, j| sum + self.at(i, j).abs());
        let sizes: Vec<Real> = (0..self.rows).map(size).collect();
        let (norm, mut bound, mut blocks) = (largest(&sizes).powi(BLOCK as i32), Real::from(1), 0);
        while blocks == 0 || !(&bound * coefficient(BLOCK * blocks)).is_negligible() {
            (bound, blocks) = (bound * &norm, blocks + 1);
        }
        (0..blocks).rev().fold(powers[0].scale(&Real::from(0)), |sum, block| {
            let terms = (0..BLOCK).map(|k| powers[k].scale(&coefficient(BLOCK * block + k)));
            terms.fold(&sum * &powers[BLOCK], |sum, term| &sum + &term)
        })
    }

    /// `exp self = Σ self^k / k!`
    pub fn exp(&self) -> Self {
        self.series(Real::inverse_factorial)
    }

    /// `φ₁(self) = Σ self^k / (k + 1)!`
    pub fn phi1(&self) -> Self {
        self.series(|k| Real::inverse_factorial(k + 1))
    }

    /// `(1 − self/2)⁻¹ (1 + self/2)`
    pub fn cayley(&self) -> Self {
        let (one, half) = (Self::identity(self.rows), self.scale(&Real::ratio(1, 2)));
        (&one - &half).solve_all(&(&one + &half))
    }

    /// The inverse.
    pub fn inverse(&self) -> Self {
        self.solve_all(&Self::identity(self.rows))
    }

    /// The solution of `self · x = right`.
    pub fn solve(&self, right: &Column) -> Column {
        self.solve_all(&Self::from_columns(std::slice::from_ref(right))).column(0)
    }

    /// The solution of `self · X = right`.
    pub fn solve_all(&self, right: &Self) -> Self {
        let (n, width) = (self.rows, right.columns);
        let extended = Self::from_fn(n, n + width, |i, j| {
            if j < n { self.at(i, j).clone() } else { right.at(i, j - n).clone() }
        });
        let (reduced, pivots) = extended.eliminate(n, Pivots::OfRows);
        let columns: Vec<Column> = (n..n + width)
            .map(|column| {
                let mut x = Column::zeros(n);
                for i in (0..n).rev() {
                    let known = sum((i + 1..n).map(|j| (reduced.at(i, j), &x[j])));
                    x.0[i] = (reduced.at(i, column) - known) / &pivots[i];
                }
                x
            })
            .collect();
        Self::from_columns(&columns)
    }

    /// The determinant, but for its sign.
    pub fn determinant_magnitude(&self) -> Real {
        self.eliminate(self.columns, Pivots::OfAll)
            .1
            .iter()
            .fold(Real::from(1), |product, pivot| product * pivot.abs())
    }

    /// How many pivots of the elimination are larger than `threshold`.
    pub fn rank(&self, threshold: &Real) -> usize {
        let (_, pivots) = self.eliminate(self.columns, Pivots::OfAll);
        pivots.iter().filter(|pivot| &pivot.abs() > threshold).count()
    }

    /// Gauss's elimination on the first `width` columns: what is left, and the pivots.
    fn eliminate(&self, width: usize, choice: Pivots) -> (Self, Vec<Real>) {
        let mut m = self.clone();
        let mut pivots = Vec::new();
        for k in 0..self.rows.min(width) {
            let end = match choice {
                Pivots::OfRows => k + 1,
                Pivots::OfAll => width,
            };
            let candidates = (k..self.rows).flat_map(|i| (k..end).map(move |j| (i, j)));
            let (row, column) = candidates
                .reduce(|a, b| if m.at(b.0, b.1).abs() > m.at(a.0, a.1).abs() { b } else { a })
                .expect("something is left to eliminate");
            for j in 0..m.columns {
                m.entries.swap(k * m.columns + j, row * m.columns + j);
            }
            for i in 0..m.rows {
                m.entries.swap(i * m.columns + k, i * m.columns + column);
            }
            let pivot = m.at(k, k).clone();
            if pivot != Real::from(0) {
                for i in k + 1..m.rows {
                    let factor = m.at(i, k) / &pivot;
                    if factor.is_zero() {
                        continue;
                    }
                    for j in k..m.columns {
                        m.entries[i * m.columns + j] = m.at(i, j) - &factor * m.at(k, j);
                    }
                }
            }
            pivots.push(pivot);
        }
        (m, pivots)
    }
}

/// Where pivots are taken from.
#[derive(Clone, Copy)]
enum Pivots {
    /// Their own column: solutions stay in order.
    OfRows,
    /// All that is left, which makes the rank reliable.
    OfAll,
}

impl Add for &Matrix {
    type Output = Matrix;
    fn add(self, other: Self) -> Matrix {
        Matrix { entries: zip(&self.entries, &other.entries, |a, b| a + b), ..*self }
    }
}

impl Sub for &Matrix {
    type Output = Matrix;
    fn sub(self, other: Self) -> Matrix {
        Matrix { entries: zip(&self.entries, &other.entries, |a, b| a - b), ..*self }
    }
}

impl Mul for &Matrix {
    type Output = Matrix;
    fn mul(self, other: Self) -> Matrix {
        assert_eq!(self.columns, other.rows);
        Matrix::from_fn(self.rows, other.columns, |i, j| {
            sum((0..self.columns).map(|k| (self.at(i, k), other.at(k, j))))
        })
    }
}

impl Mul<&Column> for &Matrix {
    type Output = Column;
    fn mul(self, column: &Column) -> Column {
        assert_eq!(self.columns, column.len());
        let row = |i| sum((0..self.columns).map(|k| (self.at(i, k), &column[k])));
        Column((0..self.rows).map(row).collect())
    }
}

/// The step of central differences: `ε²` and `2^−237/ε` are both about 1e-48.
pub fn epsilon() -> Real {
    Real::ten_to(-24)
}

/// `∂f/∂x` by central differences: column `j` is `(f(x + ε e_j) − f(x − ε e_j)) / 2ε`.
pub fn jacobian(x: &Column, f: impl Fn(&Column) -> Column) -> Matrix {
    let n = x.len();
    Matrix::of_linear(n, |direction| derivative(x, direction, &f))
}

/// `Df(x) · direction` by a central difference.
pub fn derivative(x: &Column, direction: &Column, f: impl Fn(&Column) -> Column) -> Column {
    let shift = direction.scale(&epsilon());
    let per_width = Real::from(1) / (Real::from(2) * epsilon());
    (&f(&(x + &shift)) - &f(&(x - &shift))).scale(&per_width)
}
