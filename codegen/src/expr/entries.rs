//! Matrices, whatever their entries are.

/// A matrix of anything, by rows.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Entries<T> {
    /// How many rows.
    pub rows: usize,
    /// How many columns.
    pub columns: usize,
    /// The entries, row by row.
    pub entries: Vec<T>,
}

impl<T: Copy> Entries<T> {
    /// A matrix of entries given row by row.
    pub fn new(rows: usize, columns: usize, entries: Vec<T>) -> Self {
        debug_assert_eq!(entries.len(), rows * columns);
        Self { rows, columns, entries }
    }

    /// A matrix of entries by row and column.
    pub fn from_fn(rows: usize, columns: usize, mut entry: impl FnMut(usize, usize) -> T) -> Self {
        Self::new(rows, columns, (0..rows * columns).map(|k| entry(k / columns, k % columns)).collect())
    }

    /// The entry in row `i` and column `j`.
    pub fn at(&self, i: usize, j: usize) -> T {
        self.entries[i * self.columns + j]
    }

    /// The image of each entry.
    pub fn map(&self, f: impl FnMut(T) -> T) -> Self {
        Self::new(self.rows, self.columns, self.entries.iter().copied().map(f).collect())
    }

    /// Combines entries in the same places.
    pub fn zip(&self, other: &Self, f: impl Fn(T, T) -> T) -> Self {
        let entries = self.entries.iter().zip(&other.entries).map(|(&a, &b)| f(a, b)).collect();
        Self::new(self.rows, self.columns, entries)
    }

    /// The transposed matrix.
    pub fn transpose(&self) -> Self {
        Self::from_fn(self.columns, self.rows, |i, j| self.at(j, i))
    }

    /// The rows and columns of these indices.
    pub fn block(&self, indices: &[usize]) -> Self {
        Self::from_fn(indices.len(), indices.len(), |i, j| self.at(indices[i], indices[j]))
    }
}
