//! Ideals: `g = g₁ ⊕ … ⊕ g_k` with `[g_i, g_j] = 0`, where the exponential and its logarithmic derivative are those of
//! the parts.
//!
//! The elements of `g_i` and `g_j` commute, so that `exp x = exp x₁ ⋯ exp x_k`, and `dR exp_x = φ₁(ad_x)` acts on each
//! ideal by itself. SO(4) has no polynomial of the kind that [`LinearMatrix`] knows, but its two ideals have, each that
//! of SO(3).
//!
//! A linear map that commutes with all `ad_x`, an element of the centroid, has ideals as its generalized eigenspaces.

use super::algebra::{Algebra, image};
use super::powers::LinearMatrix;
use crate::expr::Vector;
use crate::group::exact::{Rational, RationalMatrix};
use crate::group::{MatrixFunction, consecutive};

/// An ideal with coordinates of its own.
#[derive(Clone, Debug)]
pub(super) struct Ideal {
    /// The coordinates of an element's part in it.
    coordinates: RationalMatrix,
    /// The coordinates in the whole of its basis, as columns.
    vectors: RationalMatrix,
    /// `ad_x`, of its elements on itself.
    adjoint: LinearMatrix,
    /// `X`
    matrix: LinearMatrix,
}

impl Ideal {
    /// Those of an algebra: itself where power series are finite sums, or where there are no others.
    pub(super) fn all(algebra: &Algebra, terms: usize) -> Vec<Self> {
        let whole = RationalMatrix::identity(algebra.dimension());
        let adjoint = algebra.adjoint();
        let new = |vectors: RationalMatrix, coordinates: RationalMatrix| {
            let on_itself = |matrix: &RationalMatrix| coordinates.times(matrix).times(&vectors);
            let along = |matrices: &[RationalMatrix]| -> Vec<RationalMatrix> {
                (0..vectors.columns)
                    .map(|j| RationalMatrix::combination(matrices, &vectors.column(j)))
                    .collect()
            };
            let adjoint = along(&adjoint).iter().map(on_itself).collect();
            let matrix = LinearMatrix::new(along(&algebra.basis), terms);
            Self { adjoint: LinearMatrix::new(adjoint, terms), matrix, coordinates, vectors }
        };
        let itself = new(whole.clone(), whole.clone());
        let parts = if itself.is_closed() { Vec::new() } else { split(&adjoint) };
        let all: Vec<Vec<Rational>> = parts.concat();
        let Some(inverse) = RationalMatrix::from_columns(&all).inverse().filter(|_| parts.len() > 1) else {
            return vec![itself];
        };
        let rows = consecutive(parts.iter().map(Vec::len));
        let ideals = parts.iter().zip(rows).map(|(part, rows)| {
            let coordinates =
                RationalMatrix::from_fn(part.len(), inverse.columns, |i, j| inverse.at(rows.start + i, j));
            new(RationalMatrix::from_columns(part), coordinates)
        });
        ideals.collect()
    }

    /// Whether the exponential and its logarithmic derivative are finite sums.
    pub(super) fn is_closed(&self) -> bool {
        self.adjoint.is_closed() && self.matrix.is_closed()
    }

    pub(super) fn is_exact(&self) -> bool {
        self.coordinates.is_exact() && self.adjoint.is_exact() && self.matrix.is_exact()
    }

    /// `exp(X) v`, of the part of `x` in it.
    pub(super) fn exponential<'a>(&self, f: MatrixFunction, x: &Vector<'a>, v: &Vector<'a>) -> Vector<'a> {
        self.matrix.series((f, 0), &self.part(x), v)
    }

    /// What `φ₁(ad_x)* m` has from it.
    pub(super) fn d_right_dual<'a>(&self, f: MatrixFunction, x: &Vector<'a>, m: &Vector<'a>) -> Vector<'a> {
        let m = image(&self.vectors.transpose(), m);
        image(&self.coordinates.transpose(), &self.adjoint.transposed_series((f, 1), &self.part(x), &m))
    }

    /// What `φ₁(ad_x) y` has from it.
    pub(super) fn d_right<'a>(&self, f: MatrixFunction, x: &Vector<'a>, y: &Vector<'a>) -> Vector<'a> {
        image(&self.vectors, &self.adjoint.series((f, 1), &self.part(x), &self.part(y)))
    }

    /// Its part of `x`, in its own coordinates.
    pub(super) fn part<'a>(&self, x: &Vector<'a>) -> Vector<'a> {
        image(&self.coordinates, x)
    }

    /// `ad_x` on itself.
    pub(super) fn adjoint(&self) -> &LinearMatrix {
        &self.adjoint
    }

    /// `X`
    pub(super) fn matrix(&self) -> &LinearMatrix {
        &self.matrix
    }
}

/// Bases of ideals that make up the algebra with these `ad`, as small as eigenvalues in fractions tell them.
fn split(adjoint: &[RationalMatrix]) -> Vec<Vec<Vec<Rational>>> {
    let d = adjoint.len();
    let whole = || (0..d).map(|i| RationalMatrix::identity(d).column(i)).collect();
    for map in centroid(adjoint) {
        let spaces = eigenspaces(&map);
        let all: Vec<Vec<Rational>> = spaces.concat();
        let inverse = RationalMatrix::from_columns(&all).inverse().filter(RationalMatrix::is_exact);
        let Some(inverse) = inverse.filter(|_| spaces.len() > 1) else { continue };
        let rows = consecutive(spaces.iter().map(Vec::len));
        let mut ideals = Vec::new();
        for (space, rows) in spaces.into_iter().zip(rows) {
            let vectors = RationalMatrix::from_columns(&space);
            let coordinates = RationalMatrix::from_fn(space.len(), d, |i, j| inverse.at(rows.start + i, j));
            let of = |vector: &Vec<Rational>| {
                coordinates.times(&RationalMatrix::combination(adjoint, vector)).times(&vectors)
            };
            let own: Vec<RationalMatrix> = space.iter().map(of).collect();
            let in_the_whole =
                |part: Vec<Rational>| vectors.times(&RationalMatrix::from_columns(&[part])).entries;
            ideals.extend(split(&own).into_iter().map(|ideal| ideal.into_iter().map(in_the_whole).collect()));
        }
        return ideals;
    }
    vec![whole()]
}

/// A basis of the maps `φ` with `φ ad_x = ad_x φ`.
fn centroid(adjoint: &[RationalMatrix]) -> Vec<RationalMatrix> {
    let d = adjoint.len();
    let unit = |k: usize| RationalMatrix::from_fn(d, d, |i, j| Rational::from(i128::from(i * d + j == k)));
    let all = (0..d * d).map(unit).collect();
    // of the maps that commute with those before, what commutes with this one too
    adjoint.iter().fold(all, |maps: Vec<RationalMatrix>, ad| {
        let columns: Vec<_> = maps.iter().map(|map| map.commutator(ad).entries).collect();
        let kernel = RationalMatrix::from_columns(&columns).kernel();
        kernel.iter().map(|coefficients| RationalMatrix::combination(&maps, coefficients)).collect()
    })
}

/// Bases of the generalized eigenspaces of the eigenvalues that are small whole numbers or their quotients, and of what
/// all others make up.
fn eigenspaces(map: &RationalMatrix) -> Vec<Vec<Vec<Rational>>> {
    const LARGEST: i128 = 4;
    let d = map.rows;
    let fractions =
        (1..=LARGEST).flat_map(|q| (-LARGEST * q..=LARGEST * q).map(move |p| Rational::new(p, q)));
    let mut values: Vec<Rational> = Vec::new();
    for value in fractions {
        if !values.contains(&value) {
            values.push(value);
        }
    }
    let mut others = RationalMatrix::identity(d);
    let mut spaces = Vec::new();
    for value in values {
        let shifted = map.plus(&RationalMatrix::identity(d), -value);
        let mut power = shifted.clone();
        if power.kernel().is_empty() {
            continue;
        }
        (1..d).for_each(|_| power = power.times(&shifted));
        spaces.push(power.kernel());
        others = others.times(&power);
    }
    // Fitting's lemma: the image of these powers is the sum of the eigenspaces that were not found
    spaces.push(others.clone().reduce().into_iter().map(|j| others.column(j)).collect());
    spaces.retain(|space: &Vec<Vec<Rational>>| !space.is_empty());
    spaces
}
