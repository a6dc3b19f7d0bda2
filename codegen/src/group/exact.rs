//! Small matrices of exact fractions.

use crate::expr::Entries;
pub(super) use crate::expr::Rational;

/// A matrix of exact fractions.
pub(super) type RationalMatrix = Entries<Rational>;

impl RationalMatrix {
    pub(super) fn zero(rows: usize, columns: usize) -> Self {
        Self { rows, columns, entries: vec![Rational::zero(); rows * columns] }
    }

    pub(super) fn identity(rows: usize) -> Self {
        Self::from_fn(rows, rows, |i, j| Rational::from(i128::from(i == j)))
    }

    /// With these columns, all of one length.
    pub(super) fn from_columns(columns: &[Vec<Rational>]) -> Self {
        Self::from_fn(columns.first().map_or(0, Vec::len), columns.len(), |i, j| columns[j][i])
    }

    pub(super) fn row(&self, i: usize) -> &[Rational] {
        &self.entries[i * self.columns..(i + 1) * self.columns]
    }

    pub(super) fn column(&self, j: usize) -> Vec<Rational> {
        (0..self.rows).map(|i| self.at(i, j)).collect()
    }

    /// Whether no number has grown too large.
    pub(super) fn is_exact(&self) -> bool {
        self.entries.iter().all(Rational::is_exact)
    }

    pub(super) fn is_zero(&self) -> bool {
        self.entries.iter().all(Rational::is_zero)
    }

    pub(super) fn times(&self, other: &Self) -> Self {
        let mut product = Self::zero(self.rows, other.columns);
        // most entries are zero
        for (place, factor) in self.entries.iter().enumerate().filter(|(_, factor)| !factor.is_zero()) {
            let (i, k) = (place / self.columns, place % self.columns);
            let row = &mut product.entries[i * other.columns..(i + 1) * other.columns];
            for (entry, other) in row.iter_mut().zip(other.row(k)).filter(|(_, other)| !other.is_zero()) {
                *entry = *entry + *factor * *other;
            }
        }
        product
    }

    pub(super) fn plus(&self, other: &Self, factor: Rational) -> Self {
        let mut sum = self.clone();
        for (entry, other) in sum.entries.iter_mut().zip(&other.entries).filter(|(_, other)| !other.is_zero())
        {
            *entry = *entry + factor * *other;
        }
        sum
    }

    pub(super) fn scaled(&self, factor: Rational) -> Self {
        Self::zero(self.rows, self.columns).plus(self, factor)
    }

    /// `Σ xᵢ Aᵢ`
    pub(super) fn combination<'m>(matrices: &'m [Self], x: impl IntoIterator<Item = &'m Rational>) -> Self {
        let zero = Self::zero(matrices[0].rows, matrices[0].columns);
        let terms = matrices.iter().zip(x).filter(|(_, x)| !x.is_zero());
        terms.fold(zero, |sum, (matrix, x)| sum.plus(matrix, *x))
    }

    /// A matrix of `size` rows and columns with these blocks at these places.
    pub(super) fn placed<'m>(
        size: usize,
        blocks: impl IntoIterator<Item = (usize, usize, &'m Self)>,
    ) -> Self {
        let mut whole = Self::zero(size, size);
        for (row, column, block) in blocks {
            for i in 0..block.rows {
                for j in 0..block.columns {
                    whole.entries[(row + i) * size + column + j] = block.at(i, j);
                }
            }
        }
        whole
    }

    /// Both as blocks on the diagonal.
    pub(super) fn beside(&self, other: &Self) -> Self {
        Self::placed(self.rows + other.rows, [(0, 0, self), (self.rows, self.rows, other)])
    }

    /// As the block of these rows and columns of a matrix that is zero elsewhere.
    pub(super) fn embedded(&self, size: usize, rows: &[usize]) -> Self {
        let place = |i: usize| rows.iter().position(|&row| row == i);
        Self::from_fn(size, size, |i, j| match (place(i), place(j)) {
            (Some(i), Some(j)) => self.at(i, j),
            _ => Rational::zero(),
        })
    }

    pub(super) fn trace(&self) -> Rational {
        (0..self.rows).map(|i| self.at(i, i)).sum()
    }

    /// `self · other − other · self`
    pub(super) fn commutator(&self, other: &Self) -> Self {
        self.times(other).plus(&other.times(self), -Rational::one())
    }

    /// Reduced to echelon form by rows; the columns of the pivots, which come first and span all.
    pub(super) fn reduce(&mut self) -> Vec<usize> {
        let mut pivots = Vec::new();
        for column in 0..self.columns {
            let row = pivots.len();
            let Some(found) = (row..self.rows).find(|&i| !self.at(i, column).is_zero()) else { continue };
            let n = self.columns;
            (0..n).for_each(|j| self.entries.swap(row * n + j, found * n + j));
            let pivot = self.at(row, column);
            // most entries are zero
            let filled: Vec<usize> = (0..n).filter(|&j| !self.at(row, j).is_zero()).collect();
            filled.iter().for_each(|j| self.entries[row * n + j] = self.at(row, *j) / pivot);
            for i in (0..self.rows).filter(|&i| i != row) {
                let factor = self.at(i, column);
                if !factor.is_zero() {
                    filled.iter().for_each(|j| {
                        let change = factor * self.at(row, *j);
                        self.entries[i * n + j] = self.entries[i * n + j] - change;
                    });
                }
            }
            pivots.push(column);
        }
        pivots
    }

    /// The inverse; none if there is none, as where there are more rows than columns or fewer.
    pub(super) fn inverse(&self) -> Option<Self> {
        let n = self.rows;
        if self.columns != n {
            return None;
        }
        let one = Self::identity(n);
        let mut both = Self::from_fn(n, 2 * n, |i, j| if j < n { self.at(i, j) } else { one.at(i, j - n) });
        let is_regular = both.reduce().into_iter().eq(0..n);
        is_regular.then(|| Self::from_fn(n, n, |i, j| both.at(i, n + j)))
    }

    /// A basis of the vectors `v` with `self · v = 0`.
    pub(super) fn kernel(&self) -> Vec<Vec<Rational>> {
        let mut reduced = self.clone();
        let pivots = reduced.reduce();
        let free = (0..self.columns).filter(|column| !pivots.contains(column));
        let vector = |free: usize| {
            let mut vector = vec![Rational::zero(); self.columns];
            vector[free] = Rational::one();
            for (row, &pivot) in pivots.iter().enumerate() {
                vector[pivot] = -reduced.at(row, free);
            }
            vector
        };
        free.map(vector).collect()
    }

    /// Whether a symmetric matrix has no negative direction.
    pub(super) fn is_positive_semidefinite(&self) -> bool {
        let (mut m, n) = (self.clone(), self.rows);
        for k in 0..n {
            let pivot = m.at(k, k);
            if pivot.is_negative() || (pivot.is_zero() && (k..n).any(|j| !m.at(k, j).is_zero())) {
                return false;
            }
            if pivot.is_zero() {
                continue;
            }
            let row = m.row(k).to_vec();
            for i in k + 1..n {
                let factor = row[i] / pivot;
                (0..n).for_each(|j| m.entries[i * n + j] = m.at(i, j) - factor * row[j]);
            }
        }
        true
    }
}
