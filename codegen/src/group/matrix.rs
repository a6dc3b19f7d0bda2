//! Groups of matrices, from a basis of their algebra alone.
//!
//! With linearly independent matrices `E₁ … E_d` of exact numbers, closed under the commutator, everything that a step needs follows:
//!
//! * Algebra: `x` stands for `X = Σ xᵢ Eᵢ`; `[E_i, E_j] = Σ c_ij^k E_k` by exact linear algebra, `(ad*_x m)_j = Σ c_ij^k xᵢ m_k`.
//! * Storage: the matrix `g` by rows; `g' = g X`. What all elements have in common is taken from the [`Hull`], not from storage.
//! * `exp x` and `dR exp_x = φ₁(ad_x)`, where `X` and `ad_x` are [annihilated](Annihilator) by a polynomial `λᵃ (λ² + z)^q` with `z` quadratic in
//!   `x`: then their power series are finite sums with Stumpff functions of `z`. Otherwise the series are summed up to the rounding of a double within
//!   [a ball](RADIUS) about zero.
//! * `cay x = 2 (1 − X/2)⁻¹ − 1`, `dR cay_x y = (1 − X/2)⁻¹ Y (1 + X/2)⁻¹`, which stays on the group if and only if
//!   `E_i E_j E_k + E_k E_j E_i` is in the algebra for all `i`, `j`, `k`.
//! * Most groups keep a form, `g J gᵀ = J`. Where `J` is regular `g⁻¹ = J gᵀ J⁻¹`; one Newton step of that equation takes an error of rounding away.

use std::sync::OnceLock;

use super::exact::{Exact, Fraction};
use super::{
    EquationNames, Equations, Group, MatrixFunction, Representation, Retraction, Side, StorageType,
    Structure, Translation,
};
use crate::expr::{Arena, Expr, Matrix, Number, Vector};

/// A group of matrices.
pub struct MatrixGroup {
    name: &'static str,
    configuration_type: &'static str,
    coordinates: &'static [&'static str],
    axes: &'static [&'static str],
    /// `E₁ … E_d`
    basis: Vec<Exact>,
    structure: Structure,
    readout: Readout,
    hull: Hull,
    form: Option<Form>,
    /// Whether all elements have determinant 1, and no form says so.
    is_special: bool,
    /// Of `X`.
    powers: Powers,
    /// Of `ad_x`.
    adjoint_powers: Powers,
    /// `|ad_x|² + |X|²` in Frobenius' norm, as a quadratic form in `x`.
    size: Exact,
    has_cayley: bool,
    /// Set when it is [leaked](Self::leaked).
    spaces: OnceLock<[&'static dyn Representation; 1]>,
}

impl std::fmt::Debug for MatrixGroup {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("MatrixGroup")
            .field("name", &self.name)
            .field("basis", &self.basis)
            .finish_non_exhaustive()
    }
}

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
    /// Exact numbers grow too large on the way.
    TooLarge,
}

/// Where coordinates are read off the entries of a matrix of the algebra.
#[derive(Debug)]
struct Readout {
    /// As many entries as there are coordinates, that tell all of them.
    entries: Vec<usize>,
    /// The coordinates from those.
    inverse: Exact,
}

/// The affine space of matrices `1 + A`, with the algebra `A` that is spanned by all products of the basis: elements of the group lie in it, so
/// that some of their entries tell all others.
#[derive(Debug)]
struct Hull {
    /// The entries that tell all, each with what it adds to every entry.
    rows: Vec<(usize, Vec<Fraction>)>,
}

impl Hull {
    fn of(basis: &[Exact]) -> Self {
        let n = basis[0].rows;
        let mut span: Vec<Exact> = Vec::new();
        let mut new = basis.to_vec();
        loop {
            // what has grown too large is an error at the end, and no reason to go on
            let is_known = new.iter().all(Exact::is_known);
            span.append(&mut new);
            let mut rows = Exact::from_fn(span.len(), n * n, |i, k| span[i].entries[k]);
            let pivots = rows.reduce();
            let row = |r: usize| Exact::from_fn(n, n, |i, j| rows.at(r, i * n + j));
            let reduced: Vec<Exact> = (0..pivots.len()).map(row).collect();
            let is_new = |product: &Exact| {
                let known = reduced.iter().zip(&pivots);
                !known
                    .fold(product.clone(), |rest, (row, &pivot)| rest.plus(row, -product.entries[pivot]))
                    .is_zero()
            };
            let products = reduced.iter().flat_map(|a| basis.iter().map(move |e| a.times(e)));
            new = products.filter(is_new).collect();
            span = reduced;
            if new.is_empty() || !is_known {
                let entries = span.into_iter().map(|row| row.entries);
                return Self { rows: pivots.into_iter().zip(entries).collect() };
            }
        }
    }
}

/// A form `J` with `g J gᵀ = J` for all elements, symmetric or antisymmetric.
#[derive(Debug)]
struct Form {
    matrix: Exact,
    /// `J⁻¹` on the rows on which it acts, zero on others.
    inverse: Exact,
    is_regular: bool,
    is_definite: bool,
}

/// Where series of powers are summed: `|ad_x|² + |X|²` is at most the square of this, `3/2`.
const RADIUS: (i128, i128) = (3, 2);
/// So many powers of a matrix as large as that, over their factorials, are below half an ulp of the sum.
pub(super) const TERMS: usize = 20;

/// The largest dimension of an algebra: what is found of it takes seconds then, and its steps are thousands of operations.
const LARGEST_BASIS: usize = 16;
/// The largest dimension of an algebra whose series are summed: Newton's correction has their derivative, which is ten thousand operations in eight
/// dimensions.
const LARGEST_SUMMED: usize = 6;

/// How power series of a matrix linear in `x` are summed.
#[derive(Debug)]
enum Powers {
    /// As finite sums.
    Closed(Annihilator),
    /// So many terms of them.
    Series(usize),
}

/// A polynomial `λᵃ (λ² + z)^q`, or `λᵃ` where there is no `z`, that annihilates a matrix linear in `x`; `z` is quadratic in `x`.
#[derive(Debug)]
struct Annihilator {
    /// `a`
    power: usize,
    /// `q`
    multiplicity: usize,
    /// `z = Σ z_ij xᵢ x_j`
    quadratic: Option<Exact>,
}

impl Annihilator {
    /// Of `Σ xᵢ Eᵢ`; none if there is none of this kind. With the eigenvalues `±√−z`, each `m` times, `tr X² = −2 m z`.
    fn of(matrices: &[Exact]) -> Option<Self> {
        /// Points at which a polynomial that is not zero is not zero either: as good as any.
        const POINTS: [[i128; 5]; 2] = [[3, -7, 11, 2, -5], [-1, 4, 9, -13, 6]];
        let n = matrices[0].rows;
        let at = |point: &[i128; 5]| {
            matrices.iter().enumerate().fold(Exact::from_fn(n, n, |_, _| Fraction::zero()), |sum, (i, e)| {
                sum.plus(e, Fraction::from(point[i % 5] + 17 * (i / 5) as i128))
            })
        };
        // what annihilates a vector like any other annihilates all of them
        let vector =
            Exact::from_fn(n, 1, |i, _| Fraction::from([2, -3, 5, 7, -11][i % 5] + 13 * (i / 5) as i128));
        let points = POINTS.map(|point| at(&point));
        let powers = points.each_ref().map(|x| {
            let mut powers = vec![vector.clone()];
            (0..n).for_each(|k| powers.push(x.times(&powers[k])));
            powers
        });
        if let Some(power) = (1..=n).find(|&a| powers.iter().all(|powers| powers[a].is_zero())) {
            return Some(Self { power, multiplicity: 0, quadratic: None });
        }
        let is_annihilated = |&(a, m, q): &(usize, usize, usize)| {
            points.iter().zip(&powers).all(|(x, powers)| {
                let z = -x.times(x).trace() / Fraction::from(2 * m as i128);
                let factor = |v: &Exact| x.times(&x.times(v)).plus(v, z);
                (0..q).fold(powers[a].clone(), |v, _| factor(&v)).is_zero()
            })
        };
        let kinds = (1..=3).flat_map(|q| (0..n).map(move |a| (q, a)));
        let mut kinds = kinds.flat_map(|(q, a)| (1..=n / 2).map(move |m| (a, m, q)));
        let (power, m, multiplicity) = kinds.find(is_annihilated)?;
        let d = matrices.len();
        let quadratic = Exact::from_fn(d, d, |i, j| {
            -matrices[i].times(&matrices[j]).trace() / Fraction::from(2 * m as i128)
        });
        Some(Self { power, multiplicity, quadratic: Some(quadratic) })
    }

    /// `z`, if there is one.
    fn argument<'a>(&self, x: &Vector<'a>) -> Option<Expr<'a>> {
        Some(quadratic(self.quadratic.as_ref()?, x))
    }

    /// `Σ_k Aᵏ v / (k + shift)!` for a linear map `A` that it annihilates.
    fn sum<'a>(
        &self,
        x: &Vector<'a>,
        shift: u32,
        v: &Vector<'a>,
        map: impl Fn(&Vector<'a>) -> Vector<'a>,
    ) -> Vector<'a> {
        let mut power = v.clone();
        let mut sum = Vector::zeros(x.0[0].arena(), v.len());
        for k in 0..self.power {
            sum = &sum + &power.map(|entry| entry.scale(reciprocal_factorial(k as u32 + shift)));
            power = map(&power);
        }
        let Some(z) = self.argument(x) else { return sum };
        // A^{k+2j} = Aᵏ (N − z)ʲ with N = A² + z, of which the q-th power is zero on Aᵏ: Taylor's series of the Stumpff function
        for k in [self.power as u32 + shift, self.power as u32 + shift + 1] {
            let next = map(&power);
            let mut term = power;
            for i in 0..self.multiplicity {
                if i > 0 {
                    term = &map(&map(&term)) + &term.scale(z);
                }
                sum = &sum + &term.scale(taylor(z, k, i));
            }
            power = next;
        }
        sum
    }

    /// Whether `z` is never negative.
    fn is_elliptic(&self) -> bool {
        self.quadratic.as_ref().is_none_or(Exact::is_positive_semidefinite)
    }
}

impl Powers {
    fn of(matrices: &[Exact], terms: usize) -> Self {
        Annihilator::of(matrices).map_or(Self::Series(terms), Self::Closed)
    }

    /// `Σ_k Aᵏ v / (k + shift)!`
    fn series<'a>(
        &self,
        x: &Vector<'a>,
        shift: u32,
        v: &Vector<'a>,
        map: impl Fn(&Vector<'a>) -> Vector<'a>,
    ) -> Vector<'a> {
        match self {
            Self::Closed(annihilator) => annihilator.sum(x, shift, v, map),
            // v + A/(s+1) (v + A/(s+2) (v + …)), over s!
            Self::Series(terms) => {
                let sum = (1..=*terms as u32).rev().fold(v.clone(), |sum, k| {
                    let next = map(&sum).map(|entry| entry.scale(Number::ratio(1, i128::from(k + shift))));
                    (v + &next).hold()
                });
                sum.map(|entry| entry.scale(reciprocal_factorial(shift)))
            }
        }
    }

    fn is_closed(&self) -> bool {
        matches!(self, Self::Closed(_))
    }

    /// Whether no element has a real eigenvalue but zero.
    fn is_elliptic(&self) -> bool {
        matches!(self, Self::Closed(annihilator) if annihilator.is_elliptic())
    }
}

/// `(−1)ⁱ c_k⁽ⁱ⁾(z) / i!`, by `2 c_k′ = k c_{k+2} − c_{k+1}`.
fn taylor(z: Expr<'_>, k: u32, i: usize) -> Expr<'_> {
    if i == 0 {
        return z.stumpff(k);
    }
    let (first, second) = (taylor(z, k + 1, i - 1), taylor(z, k + 2, i - 1));
    (first - second.scale(i64::from(k))).scale(Number::ratio(1, 2 * i as i128))
}

/// `1/k!`
fn reciprocal_factorial(k: u32) -> Number {
    Number::ratio(1, (1..=i128::from(k)).product())
}

/// `Σ q_ij xᵢ x_j`
fn quadratic<'a>(form: &Exact, x: &Vector<'a>) -> Expr<'a> {
    let terms = (0..x.len()).flat_map(|i| (0..x.len()).map(move |j| (i, j)));
    let terms = terms.map(|(i, j)| (x.0[i] * x.0[j]).scale(number(form.at(i, j))));
    terms.fold(x.0[0].arena().zero(), |sum, term| sum + term)
}

/// `tr EᵢᵀE_j`
fn frobenius(matrices: &[Exact]) -> Exact {
    let d = matrices.len();
    Exact::from_fn(d, d, |i, j| matrices[i].transpose().times(&matrices[j]).trace())
}

fn number(fraction: Fraction) -> Number {
    // a group is made of known numbers alone
    let (numerator, denominator) = fraction.parts().unwrap_or((0, 1));
    Number::ratio(numerator, denominator)
}

impl MatrixGroup {
    /// The group of a basis: the matrices by rows, each with the name of its coordinate.
    ///
    /// # Errors
    /// If the matrices are dependent or not closed under the commutator.
    pub fn new(
        name: &'static str,
        size: usize,
        basis: &[(&'static str, Vec<i64>)],
    ) -> Result<Self, BasisError> {
        Self::with_terms(name, size, basis, TERMS)
    }

    /// The same with so many terms of series that have no closed form: for numbers of more digits than a double's.
    ///
    /// # Errors
    /// If the matrices are dependent or not closed under the commutator.
    pub fn with_terms(
        name: &'static str,
        size: usize,
        basis: &[(&'static str, Vec<i64>)],
        terms: usize,
    ) -> Result<Self, BasisError> {
        let is_square = size > 0 && basis.iter().all(|(_, entries)| entries.len() == size * size);
        if basis.is_empty() || !is_square {
            return Err(BasisError::Shape);
        }
        if basis.len() > LARGEST_BASIS {
            return Err(BasisError::TooLarge);
        }
        let matrices: Vec<Exact> = basis
            .iter()
            .map(|(_, entries)| {
                Exact::from_fn(size, size, |i, j| Fraction::from(i128::from(entries[i * size + j])))
            })
            .collect();
        let readout = Readout::of(&matrices)?;
        let structure = structure(&matrices, &readout)?;
        let form = Form::of(&matrices);
        let hull = Hull::of(&matrices);
        let is_traceless = matrices.iter().all(|matrix| matrix.trace().is_zero());
        let is_special = form.is_none() && is_traceless && hull.rows.len() == size * size;
        let adjoint: Vec<Exact> = (0..matrices.len()).map(|i| structure.adjoint(i)).collect();
        let known =
            [&readout.inverse, &frobenius(&matrices), &frobenius(&adjoint)].into_iter().all(Exact::is_known);
        let hull_is_known = hull.rows.iter().all(|(_, row)| row.iter().all(Fraction::is_known));
        let form_is_known =
            form.as_ref().is_none_or(|form| form.matrix.is_known() && form.inverse.is_known());
        if !(known && hull_is_known && form_is_known) {
            return Err(BasisError::TooLarge);
        }
        Ok(Self {
            name,
            configuration_type: ["Matrix1", "Matrix2", "Matrix3", "Matrix4", "Matrix5", "Matrix6"]
                .get(size - 1)
                .copied()
                .ok_or(BasisError::TooLarge)?,
            coordinates: leaked((0..size * size).map(|k| entry_name(k / size, k % size))),
            axes: leaked(basis.iter().map(|(name, _)| (*name).to_owned())),
            powers: Powers::of(&matrices, terms),
            adjoint_powers: Powers::of(&adjoint, terms),
            size: frobenius(&matrices).plus(&frobenius(&adjoint), Fraction::one()),
            has_cayley: has_cayley(&matrices, &readout),
            basis: matrices,
            structure,
            readout,
            hull,
            form,
            is_special,
            spaces: OnceLock::new(),
        })
    }

    /// The same for as long as the process lives, with the spaces that it acts on.
    pub fn leaked(self) -> &'static Self {
        let group: &'static Self = Box::leak(Box::new(self));
        let standard: &'static Standard = Box::leak(Box::new(Standard::of(group)));
        // it is new: nothing has been set
        let _ = group.spaces.set([standard]);
        group
    }

    /// Rows and columns of the matrices.
    pub fn size(&self) -> usize {
        self.basis[0].rows
    }

    /// The entry of a basis matrix.
    pub fn basis_entry(&self, axis: usize, row: usize, column: usize) -> (i128, i128) {
        let entry = self.basis[axis].at(row, column);
        entry.parts().unwrap_or((0, 1))
    }

    /// `X`
    fn hat<'a>(&self, x: &Vector<'a>) -> Matrix<'a> {
        let (n, arena) = (self.size(), x.0[0].arena());
        let entry = |k: usize| {
            let terms = self.basis.iter().zip(x.iter()).filter(|(e, _)| !e.entries[k].is_zero());
            terms.fold(arena.zero(), |sum, (e, x)| sum + x.scale(number(e.entries[k])))
        };
        Matrix::new(n, n, (0..n * n).map(entry).collect())
    }

    /// An element of the group as a matrix, with what is known of its entries.
    fn matrix<'a>(&self, g: &Vector<'a>) -> Matrix<'a> {
        let (n, arena) = (self.size(), g.0[0].arena());
        let one = |k: usize| i64::from(k / n == k % n);
        let entry = |k: usize| {
            let terms = self.hull.rows.iter().filter(|(_, row)| !row[k].is_zero());
            terms.fold(arena.number(one(k)), |sum, (pivot, row)| {
                let change = if *pivot == k && one(k) == 0 { g.0[k] } else { g.0[*pivot] - one(*pivot) };
                sum + change.scale(number(row[k]))
            })
        };
        Matrix::new(n, n, (0..n * n).map(entry).collect())
    }

    /// `1 ∓ X/2` and its like.
    fn one_plus<'a>(&self, x: &Vector<'a>, factor: Number) -> Matrix<'a> {
        let one = identity(x.0[0].arena(), self.size());
        one.zip(&self.hat(x), |one, x| one + x.scale(factor))
    }

    /// `(1 − X/2)⁻¹`
    fn resolvent<'a>(&self, x: &Vector<'a>) -> Matrix<'a> {
        inverse(&self.one_plus(x, Number::ratio(-1, 2))).map(Expr::hold)
    }

    /// `(1 + X/2)⁻¹`, from `(1 − X/2)⁻¹` by the form where there is one: `X J = −J Xᵀ`.
    fn other_resolvent<'a>(&self, x: &Vector<'a>, resolvent: &Matrix<'a>) -> Matrix<'a> {
        match &self.form {
            Some(form) if form.is_regular => {
                let arena = x.0[0].arena();
                let (j, inverse) = (symbolic(arena, &form.matrix), symbolic(arena, &form.inverse));
                j.times_matrix(&resolvent.transpose()).times_matrix(&inverse)
            }
            _ => inverse(&self.one_plus(x, Number::ratio(1, 2))).map(Expr::hold),
        }
    }

    /// The matrix `W` with `⟨W, Z⟩ = m · z` for all matrices `Z` of the algebra, of coordinates `z`.
    fn covector<'a>(&self, m: &Vector<'a>) -> Matrix<'a> {
        let (n, arena) = (self.size(), m.0[0].arena());
        let mut entries = vec![arena.zero(); n * n];
        for (column, &entry) in self.readout.entries.iter().enumerate() {
            let terms =
                m.iter().enumerate().map(|(i, m)| m.scale(number(self.readout.inverse.at(i, column))));
            entries[entry] = terms.fold(arena.zero(), |sum, term| sum + term);
        }
        Matrix::new(n, n, entries)
    }

    /// `⟨V, E_j⟩` for each `j`.
    fn pairings<'a>(&self, v: &Matrix<'a>) -> Vector<'a> {
        let arena = v.entries[0].arena();
        let pairing = |e: &Exact| {
            let terms = e.entries.iter().zip(&v.entries).filter(|(e, _)| !e.is_zero());
            terms.fold(arena.zero(), |sum, (e, v)| sum + v.scale(number(*e)))
        };
        Vector(self.basis.iter().map(pairing).collect())
    }

    /// `m · coordinates(A E_j B)` for each `j`: the pairings of `Aᵀ W Bᵀ`.
    fn pulled_back<'a>(&self, a: &Matrix<'a>, m: &Vector<'a>, b: &Matrix<'a>) -> Vector<'a> {
        self.pairings(&a.transpose().times_matrix(&self.covector(m)).times_matrix(&b.transpose()))
    }

    /// `ad*_x m`
    fn coadjoint<'a>(&self, x: &Vector<'a>, m: &Vector<'a>) -> Vector<'a> {
        let arena = x.0[0].arena();
        let component = |j: usize| {
            let mut sum = arena.zero();
            for (i, x) in x.iter().enumerate() {
                for (k, c) in self.structure.bracket(i, j) {
                    sum = sum + (x * m.0[*k]).scale(Number::ratio((*c.numer()).into(), (*c.denom()).into()));
                }
            }
            sum
        };
        Vector((0..x.len()).map(component).collect())
    }

    /// The entries of `f(x)`.
    fn function<'a>(&self, f: MatrixFunction, x: &Vector<'a>) -> Matrix<'a> {
        let (n, arena) = (self.size(), x.0[0].arena());
        match f {
            MatrixFunction::Exponential => {
                let hat = self.hat(x);
                let column = |j: usize| {
                    let unit = Vector((0..n).map(|i| arena.number(i64::from(i == j))).collect());
                    self.powers.series(x, 0, &unit, |v| hat.times(v))
                };
                from_columns(&(0..n).map(column).collect::<Vec<_>>())
            }
            MatrixFunction::Cayley => {
                let resolvent = self.resolvent(x);
                resolvent.zip(&identity(arena, n), |inverse, one| inverse.scale(2) - one)
            }
        }
    }
}

/// The structure constants.
fn structure(basis: &[Exact], readout: &Readout) -> Result<Structure, BasisError> {
    let d = basis.len();
    let mut constants = Vec::with_capacity(d * d);
    for (i, first) in basis.iter().enumerate() {
        for (j, second) in basis.iter().enumerate() {
            let bracket = first.commutator(second);
            let coordinates = readout.coordinates(basis, &bracket).ok_or(BasisError::NotClosed(i, j))?;
            let mut row = Vec::new();
            for (k, c) in coordinates.into_iter().enumerate().filter(|(_, c)| !c.is_zero()) {
                let part = |part: i128| i64::try_from(part).map_err(|_| BasisError::TooLarge);
                let (numerator, denominator) = c.parts().ok_or(BasisError::TooLarge)?;
                row.push((k, num_rational::Ratio::new(part(numerator)?, part(denominator)?)));
            }
            constants.push(row);
        }
    }
    Ok(Structure::new(d, |i, j| constants[i * d + j].clone()))
}

impl Structure {
    /// The matrix of `ad_{E_i}`.
    fn adjoint(&self, i: usize) -> Exact {
        let d = self.dimension();
        let mut matrix = Exact::from_fn(d, d, |_, _| Fraction::zero());
        for j in 0..d {
            for (k, c) in self.bracket(i, j) {
                matrix.entries[k * d + j] = Fraction::new((*c.numer()).into(), (*c.denom()).into());
            }
        }
        matrix
    }
}

impl Readout {
    fn of(basis: &[Exact]) -> Result<Self, BasisError> {
        let d = basis.len();
        let rows = Exact::from_fn(d, basis[0].entries.len(), |i, k| basis[i].entries[k]);
        let dependent = rows.transpose().independent_columns();
        if let Some(i) = (0..d).find(|i| !dependent.contains(i)) {
            return Err(BasisError::Dependent(i));
        }
        let entries = rows.independent_columns();
        let square = Exact::from_fn(d, d, |k, i| basis[i].entries[entries[k]]);
        let inverse = square.inverse().ok_or(BasisError::Dependent(0))?;
        Ok(Self { entries, inverse })
    }

    /// The coordinates of a matrix; none if it is not in the algebra.
    fn coordinates(&self, basis: &[Exact], matrix: &Exact) -> Option<Vec<Fraction>> {
        let d = basis.len();
        let coordinate =
            |i: usize| (0..d).map(|k| self.inverse.at(i, k) * matrix.entries[self.entries[k]]).sum();
        let coordinates: Vec<Fraction> = (0..d).map(coordinate).collect();
        let difference =
            basis.iter().zip(&coordinates).fold(matrix.clone(), |rest, (e, c)| rest.plus(e, -*c));
        difference.is_zero().then_some(coordinates)
    }
}

impl Form {
    /// The form on the rows that are not constant: a symmetric one, or else an antisymmetric one.
    fn of(basis: &[Exact]) -> Option<Self> {
        let n = basis[0].rows;
        let moves = |i: &usize| basis.iter().any(|e| (0..n).any(|j| !e.at(*i, j).is_zero()));
        let rows: Vec<usize> = (0..n).filter(moves).collect();
        [true, false].into_iter().find_map(|symmetric| Self::of_kind(basis, &rows, symmetric))
    }

    fn of_kind(basis: &[Exact], rows: &[usize], symmetric: bool) -> Option<Self> {
        let n = basis[0].rows;
        // unknowns: the entries of J on or above the diagonal
        let places: Vec<(usize, usize)> = rows
            .iter()
            .flat_map(|&i| rows.iter().map(move |&j| (i, j)))
            .filter(|(i, j)| if symmetric { i <= j } else { i < j })
            .collect();
        let unit = |(i, j): (usize, usize)| {
            let sign = if symmetric { Fraction::one() } else { -Fraction::one() };
            Exact::from_fn(n, n, |k, l| match ((k, l) == (i, j), (k, l) == (j, i)) {
                (true, _) => Fraction::one(),
                (_, true) => sign,
                _ => Fraction::zero(),
            })
        };
        let units: Vec<Exact> = places.iter().map(|&place| unit(place)).collect();
        // E J + J Eᵀ = 0 for each E
        let columns: Vec<Vec<Fraction>> = units
            .iter()
            .map(|j| {
                basis
                    .iter()
                    .flat_map(|e| e.times(j).plus(&j.times(&e.transpose()), Fraction::one()).entries)
                    .collect()
            })
            .collect();
        let equations = Exact::from_fn(columns.first()?.len(), columns.len(), |i, j| columns[j][i]);
        let zero = Exact::from_fn(n, n, |_, _| Fraction::zero());
        let combine = |coefficients: &[Fraction]| {
            units.iter().zip(coefficients).fold(zero.clone(), |sum, (unit, c)| sum.plus(unit, *c))
        };
        let forms: Vec<Exact> = equations.kernel().iter().map(|kernel| combine(kernel)).collect();
        let all = forms.iter().fold(zero.clone(), |sum, form| sum.plus(form, Fraction::one()));
        forms.into_iter().chain([all]).rev().find_map(|form| Self::with(form, n))
    }

    /// With its inverse on the rows on which it acts.
    fn with(matrix: Exact, n: usize) -> Option<Self> {
        let acts = |i: &usize| (0..n).any(|j| !matrix.at(*i, j).is_zero());
        let rows: Vec<usize> = (0..n).filter(acts).collect();
        if rows.is_empty() {
            return None;
        }
        let block = Exact::from_fn(rows.len(), rows.len(), |i, j| matrix.at(rows[i], rows[j]));
        let block_inverse = block.inverse()?;
        let place = |i: usize| rows.iter().position(|&row| row == i);
        let inverse = Exact::from_fn(n, n, |i, j| match (place(i), place(j)) {
            (Some(i), Some(j)) => block_inverse.at(i, j),
            _ => Fraction::zero(),
        });
        let definite = |block: &Exact| block.transpose() == *block && block.is_positive_semidefinite();
        let negative = Exact::from_fn(block.rows, block.rows, |i, j| -block.at(i, j));
        let is_regular = rows.len() == n;
        let is_definite = is_regular && (definite(&block) || definite(&negative));
        Some(Self { matrix, inverse, is_regular, is_definite })
    }
}

/// Whether the Cayley map stays on the group: `E_i E_j E_k + E_k E_j E_i` is in the algebra for all `i`, `j`, `k`.
fn has_cayley(basis: &[Exact], readout: &Readout) -> bool {
    let d = basis.len();
    let is_inside = |i: usize, j: usize, k: usize| {
        let first = basis[i].times(&basis[j]).times(&basis[k]);
        let second = basis[k].times(&basis[j]).times(&basis[i]);
        readout.coordinates(basis, &first.plus(&second, Fraction::one())).is_some()
    };
    (0..d).all(|i| (i..d).all(|k| (0..d).all(|j| is_inside(i, j, k))))
}

fn identity(arena: &Arena, n: usize) -> Matrix<'_> {
    Matrix::new(n, n, (0..n * n).map(|k| arena.number(i64::from(k / n == k % n))).collect())
}

fn symbolic<'a>(arena: &'a Arena, matrix: &Exact) -> Matrix<'a> {
    Matrix::new(
        matrix.rows,
        matrix.columns,
        matrix.entries.iter().map(|&e| arena.number(number(e))).collect(),
    )
}

fn from_columns<'a>(columns: &[Vector<'a>]) -> Matrix<'a> {
    let (rows, count) = (columns[0].len(), columns.len());
    Matrix::new(rows, count, (0..rows * count).map(|k| columns[k % count].0[k / count]).collect())
}

/// The inverse of a matrix near the identity.
fn inverse<'a>(matrix: &Matrix<'a>) -> Matrix<'a> {
    let one = identity(matrix.entries[0].arena(), matrix.rows);
    from_columns(&(0..matrix.rows).map(|j| matrix.solve(&one.column(j))).collect::<Vec<_>>())
}

/// By expansion along the first row.
fn determinant<'a>(matrix: &Matrix<'a>) -> Expr<'a> {
    let n = matrix.rows;
    if n == 1 {
        return matrix.at(0, 0);
    }
    let minor = |j: usize| {
        let kept = (n..n * n).filter(|k| k % n != j).map(|k| matrix.entries[k]);
        determinant(&Matrix::new(n - 1, n - 1, kept.collect()))
    };
    let terms = (0..n).filter(|&j| !matrix.at(0, j).is_zero()).map(|j| {
        let term = matrix.at(0, j) * minor(j);
        if j % 2 == 0 { term } else { -term }
    });
    terms.fold(matrix.entries[0].arena().zero(), |sum, term| sum + term)
}

/// `11`, `12`, …: row and column, from 1 on.
fn entry_name(row: usize, column: usize) -> String {
    format!("{}{}", row + 1, column + 1)
}

/// Names live as long as the groups that they are of, which is as long as the process.
fn leaked(names: impl Iterator<Item = String>) -> &'static [&'static str] {
    let names: Vec<&'static str> = names.map(|name| &*name.leak()).collect();
    names.leak()
}

impl Group for MatrixGroup {
    fn name(&self) -> &'static str {
        self.name
    }

    fn conventions(&self) -> &'static str {
        "element: matrix from body to space coordinates; momentum and velocity: coordinates with respect to the basis"
    }

    fn configuration_name(&self) -> &'static str {
        "element"
    }

    fn configuration_type(&self) -> &'static str {
        self.configuration_type
    }

    fn coordinates(&self) -> &'static [&'static str] {
        self.coordinates
    }

    fn momentum_type(&self) -> StorageType {
        StorageType::Vector(self.dimension())
    }

    fn equations(&self, names: &EquationNames<'_>) -> Equations {
        let EquationNames { configuration, momentum, velocity, advected } = names;
        let mut terms = vec![format!("ad*({velocity}) {momentum}")];
        terms.extend(advected.iter().map(|a| format!("{a} ⋄ ∂V/∂{a}")));
        Equations {
            configuration: format!("{configuration}' = {configuration} hat({velocity})"),
            momentum: terms,
            advected: advected.iter().map(|a| format!("{a}' = ad*({velocity}) {a}")).collect(),
        }
    }

    fn dimension(&self) -> usize {
        self.basis.len()
    }

    fn axes(&self) -> &'static [&'static str] {
        self.axes
    }

    fn bracket<'a>(&self, x: &Vector<'a>, y: &Vector<'a>) -> Vector<'a> {
        let arena = x.0[0].arena();
        let mut bracket = vec![arena.zero(); x.len()];
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

    fn closed_form<'a>(&self, f: MatrixFunction, x: &Vector<'a>) -> Vector<'a> {
        Vector(self.function(f, x).entries)
    }

    fn closed_d_right_dual<'a>(&self, f: MatrixFunction, x: &Vector<'a>, m: &Vector<'a>) -> Vector<'a> {
        match f {
            MatrixFunction::Exponential => self.adjoint_powers.series(x, 1, m, |m| self.coadjoint(x, m)),
            MatrixFunction::Cayley => {
                let resolvent = self.resolvent(x);
                self.pulled_back(&resolvent, m, &self.other_resolvent(x, &resolvent))
            }
        }
    }

    fn has(&self, retraction: Retraction) -> bool {
        match retraction {
            Retraction::Exponential => {
                self.adjoint_powers.is_closed() && self.powers.is_closed()
                    || self.dimension() <= LARGEST_SUMMED
            }
            Retraction::Cayley => self.has_cayley,
            // where it is singular is not known
            Retraction::SecondKind | Retraction::ReversedSecondKind => false,
        }
    }

    fn domain<'a>(&self, retraction: Retraction, x: &Vector<'a>) -> Option<Expr<'a>> {
        match retraction {
            Retraction::Exponential => match &self.adjoint_powers {
                // dR exp is singular where ad_x has the eigenvalue 2πi
                Powers::Closed(annihilator) if self.powers.is_closed() => {
                    let z = annihilator.argument(x)?;
                    Some(z.arena().number(Number::FOUR_PI_SQUARED) - z)
                }
                _ => Some(
                    x.0[0].arena().number(Number::ratio(RADIUS.0, RADIUS.1).powi(2))
                        - quadratic(&self.size, x),
                ),
            },
            // the eigenvalue 2 of X is that of no element that is skew with respect to a definite form, or nilpotent
            Retraction::Cayley => {
                let is_elliptic = self.powers.is_elliptic();
                let is_definite = self.form.as_ref().is_some_and(|form| form.is_definite);
                (!is_elliptic && !is_definite).then(|| determinant(&self.one_plus(x, Number::ratio(-1, 2))))
            }
            Retraction::SecondKind | Retraction::ReversedSecondKind => None,
        }
    }

    fn compose<'a>(&self, g: &Vector<'a>, h: &Vector<'a>) -> Vector<'a> {
        let product = Vector(self.matrix(g).times_matrix(&self.matrix(h)).entries);
        Vector(self.matrix(&product).entries)
    }

    fn inverse<'a>(&self, g: &Vector<'a>) -> Vector<'a> {
        let (arena, g) = (g.0[0].arena(), self.matrix(g));
        let inverse = match &self.form {
            Some(form) if form.is_regular => {
                let (j, back) = (symbolic(arena, &form.matrix), symbolic(arena, &form.inverse));
                j.times_matrix(&g.transpose()).times_matrix(&back)
            }
            _ => inverse(&g),
        };
        Vector(self.matrix(&Vector(inverse.entries)).entries)
    }

    /// One Newton step of `g J gᵀ = J` on what `J` acts on, or of `det g = 1`.
    fn normalize<'a>(&self, g: &Vector<'a>) -> Vector<'a> {
        let (arena, matrix) = (g.0[0].arena(), self.matrix(g));
        if self.is_special {
            let correction = (determinant(&matrix) - 1).scale(Number::ratio(-1, self.size() as i128));
            return g + &g.scale(correction);
        }
        let Some(form) = &self.form else { return Vector(matrix.entries) };
        let (j, back) = (symbolic(arena, &form.matrix), symbolic(arena, &form.inverse));
        let defect = matrix.times_matrix(&j).times_matrix(&matrix.transpose()).zip(&j, |a, b| a - b);
        let acted_on = matrix.times_matrix(&j).times_matrix(&back);
        let correction = defect.times_matrix(&back).times_matrix(&acted_on);
        let next = matrix.zip(&correction, |g, correction| g - correction / 2);
        Vector(self.matrix(&Vector(next.entries)).entries)
    }

    fn to_space<'a>(&self, g: &Vector<'a>, m: &Vector<'a>) -> Vector<'a> {
        let back = self.matrix(&self.inverse(g));
        self.pulled_back(&back, m, &self.matrix(g))
    }

    /// The standard one.
    fn representations(&self) -> &[&'static dyn Representation] {
        self.spaces.get().map_or(&[], |spaces| spaces)
    }

    fn matrix_rows(&self) -> Option<usize> {
        Some(self.size())
    }

    /// `1 + D`, to first order.
    fn near<'a>(&self, side: Side, g: &Vector<'a>, delta: &Vector<'a>) -> Vector<'a> {
        let increment = Vector(self.one_plus(delta, Number::ONE).entries);
        side.compose(self, g, &increment)
    }
}

/// Columns of as many numbers as the matrices have rows, `ρ_x v = X v`.
struct Standard {
    group: &'static MatrixGroup,
    name: &'static str,
    type_name: StorageType,
    coordinates: &'static [&'static str],
}

impl Standard {
    fn of(group: &'static MatrixGroup) -> Self {
        let n = group.size();
        let coordinates =
            if n <= 4 { &["x", "y", "z", "w"][..n] } else { leaked((1..=n).map(|i| i.to_string())) };
        Self { group, name: format!("R{n}").leak(), type_name: StorageType::Vector(n), coordinates }
    }
}

impl Representation for Standard {
    fn name(&self) -> &'static str {
        self.name
    }

    fn storage(&self) -> StorageType {
        self.type_name
    }

    fn coordinates(&self) -> &'static [&'static str] {
        self.coordinates
    }

    fn algebra_dimension(&self) -> usize {
        self.group.dimension()
    }

    fn act_infinitesimally<'a>(&self, x: &Vector<'a>, v: &Vector<'a>) -> Vector<'a> {
        self.group.hat(x).times(v)
    }

    /// `φ₁(X) w`; for the Cayley map half the way before the rest, half of it after.
    fn translation<'a>(&self, f: MatrixFunction, x: &Vector<'a>, w: &Vector<'a>) -> Translation<'a> {
        match f {
            MatrixFunction::Exponential => {
                let hat = self.group.hat(x);
                Translation {
                    body_part: self.group.powers.series(x, 1, w, |v| hat.times(v)),
                    rotated_part: Vector::zeros(x.0[0].arena(), w.len()),
                    is_tangent_group: false,
                }
            }
            MatrixFunction::Cayley => {
                let half = w.map(|component| component / 2);
                Translation { body_part: half.clone(), rotated_part: half, is_tangent_group: false }
            }
        }
    }

    fn act<'a>(&self, g: &Vector<'a>, v: &Vector<'a>) -> Vector<'a> {
        self.group.matrix(g).times(v)
    }

    /// `exp(X) v`, or `2 (1 − X/2)⁻¹ v − v`
    fn transport<'a>(&self, f: MatrixFunction, x: &Vector<'a>, v: &Vector<'a>) -> Vector<'a> {
        let hat = self.group.hat(x);
        match f {
            MatrixFunction::Exponential => self.group.powers.series(x, 0, v, |v| hat.times(v)),
            MatrixFunction::Cayley => {
                let solved = self.group.one_plus(x, Number::ratio(-1, 2)).solve(v);
                &solved.map(|component| component.scale(2)) - v
            }
        }
    }
}
