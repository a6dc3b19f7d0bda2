//! Bases of Lie algebras of matrices, and those that products, semidirect products and tangent groups have.

use std::collections::BTreeMap;

use super::algebra::BasisError;
use super::{LARGEST_BASIS, LARGEST_MATRIX};
use crate::expr::Vector;
use crate::group::exact::{Rational, RationalMatrix};
use crate::group::representation::{matrices_of, matrices_of_action};
use crate::group::{Representation, consecutive};

/// A matrix by rows, with the name of its coordinate.
pub type NamedMatrix = (String, Vec<i64>);

/// Matrices, each with the name of its coordinate. Whether they are the basis of an algebra is told by
/// [`MatrixGroup::new`](super::MatrixGroup::new).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Basis {
    pub(super) axes: Vec<String>,
    pub(super) matrices: Vec<RationalMatrix>,
    /// The lengths of the blocks of coordinates that have a unit in common.
    pub(super) blocks: Vec<usize>,
    /// The names of the blocks; none where they have none.
    pub(super) parts: Vec<String>,
}

impl Basis {
    /// Of square matrices of one size, by rows.
    ///
    /// # Errors
    /// [`BasisError::Shape`]
    pub fn new(size: usize, matrices: &[NamedMatrix]) -> Result<Self, BasisError> {
        let is_square = size > 0 && matrices.iter().all(|(_, entries)| entries.len() == size * size);
        if matrices.is_empty() || !is_square {
            return Err(BasisError::Shape);
        }
        let exact = |entries: &Vec<i64>| {
            let entries = entries.iter().map(|&entry| Rational::from(i128::from(entry)));
            RationalMatrix::new(size, size, entries.collect())
        };
        let (axes, matrices) = matrices.iter().map(|(name, entries)| (name.clone(), exact(entries))).unzip();
        Ok(Self::of(axes, matrices))
    }

    /// One block without a name.
    fn of(axes: Vec<String>, matrices: Vec<RationalMatrix>) -> Self {
        Self { blocks: vec![axes.len()], axes, matrices, parts: Vec::new() }
    }

    /// The matrices by which an algebra with these axes acts on columns of so many numbers; none if they are not exact.
    pub(in crate::group) fn of_action(
        axes: &[&str],
        rows: usize,
        action: impl for<'a> Fn(&Vector<'a>, &Vector<'a>) -> Vector<'a>,
    ) -> Option<Self> {
        let matrices = matrices_of_action(axes.len(), rows, action)?;
        Some(Self::of(axes.iter().map(|&axis| axis.to_owned()).collect(), matrices))
    }

    /// The same with blocks of these lengths, each with a unit of its own.
    #[must_use]
    pub(in crate::group) fn with_blocks(self, blocks: Vec<usize>) -> Self {
        Self { blocks, ..self }
    }

    /// Of a direct product of groups, each with a name: block-diagonal matrices.
    ///
    /// # Errors
    /// [`BasisError::TooLarge`], before anything is made.
    pub fn product(factors: &[(String, Self)]) -> Result<Self, BasisError> {
        let ranges = consecutive(factors.iter().map(|(_, basis)| basis.size()));
        let size = ranges.last().map_or(0, |range| range.end);
        bounded(factors.iter().map(|(_, basis)| basis.dimension()).sum(), size)?;
        let mut product = Self { blocks: Vec::new(), ..Self::of(Vec::new(), Vec::new()) };
        for ((name, factor), rows) in factors.iter().zip(&ranges) {
            product.axes.extend(factor.axes.iter().map(|axis| format!("{name}_{axis}")));
            let placed = |matrix| RationalMatrix::placed(size, [(rows.start, rows.start, matrix)]);
            product.matrices.extend(factor.matrices.iter().map(placed));
            product.blocks.extend(&factor.blocks);
            product.parts.extend(factor.parts_within(name));
        }
        Ok(product)
    }

    /// The names of its parts within another group.
    fn parts_within(&self, name: &str) -> Vec<String> {
        match self.parts.as_slice() {
            [] => numbered(name, self.blocks.len()),
            parts => parts.iter().map(|part| format!("{name}_{part}")).collect(),
        }
    }

    /// Of a semidirect product `G ⋉ (V₁ ⊕ …)` with spaces on which `G` acts, each with a name: `[[ρ(X), v], [0, 0]]`
    /// for each kind of space, with `X` beside it where no kind tells all of `X`.
    ///
    /// # Errors
    /// [`BasisError::TooLarge`]
    pub fn semidirect(
        &self,
        name: &str,
        spaces: &[(String, &'static dyn Representation)],
    ) -> Result<Self, BasisError> {
        let of_spaces: usize = spaces.iter().map(|(_, space)| space.coordinates().len()).sum();
        bounded(self.dimension() + of_spaces, 1)?;
        let mut kinds: Vec<(Vec<RationalMatrix>, Vec<usize>)> = Vec::new();
        for (place, (_, space)) in spaces.iter().enumerate() {
            let rho = matrices_of(*space).ok_or(BasisError::TooLarge)?;
            match kinds.iter_mut().find(|(known, _)| *known == rho) {
                Some((_, places)) => places.push(place),
                None => kinds.push((rho, vec![place])),
            }
        }
        if !kinds.iter().any(|(rho, _)| is_faithful(rho)) {
            kinds.insert(0, (self.matrices.clone(), Vec::new()));
        }
        let ranges = consecutive(kinds.iter().map(|(rho, places)| rho[0].rows + places.len()));
        let size = ranges.last().map_or(0, |range| range.end);
        bounded(self.dimension() + of_spaces, size)?;
        let starts = || kinds.iter().zip(&ranges).map(|((rho, _), range)| (rho, range.start));
        let of_group = (0..self.matrices.len())
            .map(|i| RationalMatrix::placed(size, starts().map(|(rho, start)| (start, start, &rho[i]))));
        let mut product = Self {
            axes: self.axes.clone(),
            matrices: of_group.collect(),
            blocks: self.blocks.clone(),
            parts: self.parts_within(name),
        };
        // for each space its kind, and its place among those of this kind
        let places = kinds.iter().enumerate().flat_map(|(kind, (_, places))| {
            places.iter().enumerate().map(move |(column, &place)| (place, (kind, column)))
        });
        let places: BTreeMap<usize, (usize, usize)> = places.collect();
        for ((name, space), (kind, column)) in spaces.iter().zip(places.into_values()) {
            let (start, n) = (ranges[kind].start, space.coordinates().len());
            let along = |i: usize| {
                RationalMatrix::placed(size, [(start + i, start + n + column, &RationalMatrix::identity(1))])
            };
            product.matrices.extend((0..n).map(along));
            product.axes.extend(space.coordinates().iter().map(|axis| format!("{name}_{axis}")));
            product.blocks.push(n);
            product.parts.push(name.clone());
        }
        Ok(product)
    }

    /// Of the tangent group `TG = G ⋉ g`: `[[X, Y], [0, X]]`.
    ///
    /// # Errors
    /// [`BasisError::TooLarge`]
    pub fn tangent(&self) -> Result<Self, BasisError> {
        let n = self.size();
        bounded(2 * self.dimension(), 2 * n)?;
        let base = self.matrices.iter().map(|e| e.beside(e));
        let tangent = self.matrices.iter().map(|e| RationalMatrix::placed(2 * n, [(0, n, e)]));
        let tangent_axes = self.axes.iter().map(|axis| format!("tangent_{axis}"));
        let parts = match self.parts.as_slice() {
            [] => numbered("base", self.blocks.len()),
            parts => parts.to_vec(),
        };
        Ok(Self {
            axes: self.axes.iter().cloned().chain(tangent_axes).collect(),
            matrices: base.chain(tangent).collect(),
            blocks: self.blocks.repeat(2),
            parts: [parts, self.parts_within("tangent")].concat(),
        })
    }

    /// Rows and columns of the matrices.
    pub(super) fn size(&self) -> usize {
        self.matrices.first().map_or(0, |matrix| matrix.rows)
    }

    /// How many matrices there are.
    pub fn dimension(&self) -> usize {
        self.matrices.len()
    }
}

/// Whether an algebra of so many coordinates and rows may be made.
pub(super) fn bounded(dimension: usize, rows: usize) -> Result<(), BasisError> {
    let is_bounded = dimension <= LARGEST_BASIS && rows <= LARGEST_MATRIX;
    if is_bounded { Ok(()) } else { Err(BasisError::TooLarge) }
}

/// The name where there is one of them, otherwise with numbers.
fn numbered(name: &str, count: usize) -> Vec<String> {
    match count {
        1 => vec![name.to_owned()],
        _ => (1..=count).map(|i| format!("{name}_{i}")).collect(),
    }
}

/// Whether a representation is zero for zero alone.
fn is_faithful(rho: &[RationalMatrix]) -> bool {
    let columns: Vec<Vec<Rational>> = rho.iter().map(|matrix| matrix.entries.clone()).collect();
    RationalMatrix::from_columns(&columns).kernel().is_empty()
}
