//! Local coordinates of a system's states and derivatives in them, from [`Geometry`] alone.

use nalgebra::allocator::Allocator;
use nalgebra::{DMatrix, DVector, DefaultAllocator, Dim, Dyn, OMatrix};

use crate::erased::Geometry;
use crate::retraction::RetractionKind;
use crate::system::{Kind, Quantity, Role};

/// What cannot be measured: there are no local coordinates, a matrix has no inverse, or a series does not converge.
pub(super) struct Degenerate;

/// The larger of two numbers; not-a-number if one is.
pub(super) fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || b <= a { a } else { b }
}

/// The worst of several figures; none if there is nothing to measure in any case.
pub(super) fn worst<E>(figures: impl Iterator<Item = Result<Option<f64>, E>>) -> Result<Option<f64>, E> {
    let figures = figures.collect::<Result<Vec<_>, E>>()?;
    Ok(figures.into_iter().flatten().reduce(larger))
}

/// An error next to the size of what it is the error of.
pub(super) fn relative(error: f64, size: f64) -> f64 {
    if error == 0.0 { 0.0 } else { error / size }
}

/// The derivative at 0 of a curve, by central differences of order 8.
///
/// With `e` a hundredth of the curve's scale, truncation and roundoff are both about 1e-14.
pub(super) fn derivative<E>(
    e: f64,
    curve: &mut dyn FnMut(f64) -> Result<DVector<f64>, E>,
) -> Result<DVector<f64>, E> {
    const WEIGHTS: [f64; 4] = [4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0];
    let mut sum = DVector::zeros(0);
    for (k, weight) in (1..).zip(WEIGHTS) {
        let at = f64::from(k) * e;
        let term = (curve(at)? - curve(-at)?) * (weight / e);
        sum = if sum.is_empty() { term } else { sum + term };
    }
    Ok(sum)
}

/// [`derivative`] of a curve that does not fail.
pub(super) fn slope(e: f64, curve: &dyn Fn(f64) -> DVector<f64>) -> DVector<f64> {
    let Ok(slope) = derivative(e, &mut |at| Ok::<_, core::convert::Infallible>(curve(at)));
    slope
}

/// The matrix of the [derivatives](derivative) of curves, of which there is one for each of these scales.
pub(super) fn jacobian<E>(
    scales: impl Iterator<Item = f64>,
    curve: &mut dyn FnMut(usize, f64) -> Result<DVector<f64>, E>,
) -> Result<DMatrix<f64>, E> {
    let column = |(i, scale): (usize, f64)| derivative(1e-2 * scale, &mut |at| curve(i, at));
    Ok(DMatrix::from_columns(&scales.enumerate().map(column).collect::<Result<Vec<_>, E>>()?))
}

/// The matrix of so many columns.
pub(super) fn columns(count: usize, column: impl Fn(usize) -> DVector<f64>) -> DMatrix<f64> {
    DMatrix::from_columns(&(0..count).map(column).collect::<Vec<_>>())
}

/// Momentum or an advected parameter: one number of the state, changed by one component of a tangent vector.
#[derive(Clone, Copy, Debug)]
pub struct Linear {
    /// Its place in tangent vectors.
    pub tangent: usize,
    /// Its place in the state's array.
    pub component: usize,
}

/// What the components of states and tangent vectors are.
#[derive(Clone)]
pub struct Frame<'a> {
    pub(super) system: &'a dyn Geometry,
    /// The places of the configurations' components in tangent vectors.
    pub configuration: Vec<usize>,
    /// The momenta, in the order of the configurations' components that they belong to, then the advected parameters.
    pub linear: Vec<Linear>,
    /// The places of the configurations in the state's array.
    stored: Vec<usize>,
    /// How far a component of a tangent vector leads to something else entirely.
    pub scale: Vec<f64>,
    /// The same for the components of states.
    weight: Vec<f64>,
    /// One over the time in which the motion leads to something else entirely; 0 at rest.
    pub rate: f64,
}

impl<'a> Frame<'a> {
    /// `None` if the geometry is not that of the quantities which the state consists of.
    pub fn new(system: &'a dyn Geometry, first: &[f64], control: &[f64], time: f64) -> Option<Self> {
        let n = system.differential(first, time, control).len();
        let (mut configuration, mut stored, mut momenta, mut advected) =
            (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for (quantity, places) in Quantity::with_ranges(system.description().state) {
            let linear = quantity.tangent().zip(places.clone());
            let linear = linear.map(|(tangent, component)| Linear { tangent, component });
            match quantity.role {
                Role::Configuration => {
                    configuration.extend(quantity.tangent());
                    stored.extend(places);
                }
                Role::Momentum => momenta.extend(linear),
                _ => advected.extend(linear),
            }
        }
        let is_whole = !configuration.is_empty()
            && momenta.len() == configuration.len()
            && configuration.len() + momenta.len() + advected.len() == n
            && system.displace(first, RetractionKind::Exponential, &vec![0.0; n]).len() == first.len();
        if !is_whole {
            return None;
        }
        let mut frame = Self {
            system,
            configuration,
            linear: momenta.into_iter().chain(advected).collect(),
            stored,
            scale: vec![1.0; n],
            weight: vec![1.0; first.len()],
            rate: 0.0,
        };
        frame.measure(first, control, time);
        Some(frame)
    }

    /// Scales and rate.
    fn measure(&mut self, state: &[f64], control: &[f64], time: f64) {
        let usable = |size: f64, least: f64| if size > least && size.is_finite() { size } else { 1.0 };
        let components = state;
        let basis = self.basis(state);
        // turns count in radians, positions in their distance from the origin
        for (column, &i) in basis.column_iter().zip(&self.configuration) {
            let moved = self.stored.iter().zip(column.iter()).filter(|(_, change)| change.abs() > 1e-9);
            let size = moved.fold(0.0, |size: f64, (&c, _)| size.max(components[c].abs()));
            self.scale[i] = usable(size / (2.0 * column.amax()), 1e-6);
        }
        let motion = self.motion(state, time, control);
        self.rate = self.rate_at(state, control, time);
        for (_, places) in Quantity::with_ranges(self.system.description().state) {
            let part: Vec<Linear> =
                self.linear.iter().filter(|l| places.contains(&l.component)).copied().collect();
            let norm = |f: &dyn Fn(&Linear) -> f64| part.iter().map(|l| f(l).powi(2)).sum::<f64>().sqrt();
            let change = if self.rate > 0.0 { norm(&|l| motion[l.tangent]) / self.rate } else { 0.0 };
            let size = usable(norm(&|l| components[l.component]).max(change), 0.0);
            for linear in &part {
                self.weight[linear.component] = size;
                self.scale[linear.tangent] =
                    size.min(self.gentle(state, linear.tangent, size, time, control));
            }
        }
        for (row, &c) in basis.row_iter().zip(&self.stored) {
            let reach = row.iter().zip(&self.configuration).map(|(change, &i)| change.abs() * self.scale[i]);
            self.weight[c] = usable(reach.fold(components[c].abs(), f64::max), 0.0);
        }
    }

    /// One over the time in which the motion from a state leads to something else entirely.
    pub(super) fn rate_at(&self, state: &[f64], control: &[f64], time: f64) -> f64 {
        let motion = self.motion(state, time, control);
        // of a body at rest, how fast it is going to be is in the velocity's change
        let change = slope(1e-4 / (1.0 + motion.amax()), &|at| {
            let there = self.displace(state, RetractionKind::Exponential, (&motion * at).as_slice());
            self.motion(&there, time + at, control)
        });
        let rates = self
            .configuration
            .iter()
            .map(|&i| (motion[i] / self.scale[i]).abs().max((change[i] / self.scale[i]).abs().sqrt()));
        // what is not a number is for the certificates to find
        rates.fold(0.0, f64::max)
    }

    /// How far a momentum or an advected parameter may be changed before the configuration moves at another rate than it does: of a slender
    /// body the momentum about its axis by far less than the others.
    fn gentle(&self, state: &[f64], tangent: usize, size: f64, time: f64, control: &[f64]) -> f64 {
        let change = slope(1e-3 * size, &|at| {
            let there = self.displace(state, RetractionKind::Exponential, &self.unit(tangent, at));
            self.motion(&there, time, control)
        });
        let rates = self.configuration.iter().map(|&i| (change[i] / self.scale[i]).abs());
        let gentle = self.rate / rates.fold(0.0, f64::max);
        if gentle > 0.0 && gentle.is_finite() { gentle } else { size }
    }

    /// The number of components of a tangent vector.
    pub(super) fn dimension(&self) -> usize {
        self.scale.len()
    }

    /// `length` along one component.
    pub(super) fn unit(&self, component: usize, length: f64) -> Vec<f64> {
        let mut unit = vec![0.0; self.dimension()];
        unit[component] = length;
        unit
    }

    /// The state, displaced.
    pub fn displace(&self, state: &[f64], map: RetractionKind, by: &[f64]) -> Vec<f64> {
        self.system.displace(state, map, by)
    }

    pub(super) fn motion(&self, state: &[f64], time: f64, control: &[f64]) -> DVector<f64> {
        self.system.motion(state, time, control).into()
    }

    /// The matrix of the Poisson structure.
    pub(super) fn poisson(&self, state: &[f64]) -> DMatrix<f64> {
        columns(self.dimension(), |j| self.system.hamiltonian_vector(state, &self.unit(j, 1.0)).into())
    }

    /// A tensor of two tangent vectors with every component in units of its scale.
    pub(super) fn scaled(&self, tensor: &DMatrix<f64>) -> DMatrix<f64> {
        DMatrix::from_fn(tensor.nrows(), tensor.ncols(), |i, j| {
            tensor[(i, j)] / (self.scale[i] * self.scale[j])
        })
    }

    /// How far two states are apart, relative to their size.
    pub(super) fn distance(&self, a: &[f64], b: &[f64]) -> f64 {
        self.difference(a, b).into_iter().fold(0.0, |distance, part| larger(distance, part.abs()))
    }

    /// What one state has more than another, in each component relative to its size.
    pub(super) fn difference(&self, a: &[f64], b: &[f64]) -> Vec<f64> {
        a.iter().zip(b).zip(&self.weight).map(|((a, b), weight)| (a - b) / weight).collect()
    }

    /// Momenta and advected parameters.
    pub(super) fn linear_part(&self, state: &[f64]) -> DVector<f64> {
        DVector::from_iterator(self.linear.len(), self.linear.iter().map(|linear| state[linear.component]))
    }

    /// The state with these momenta and advected parameters.
    pub(super) fn with_linear_part(&self, state: &[f64], values: &DVector<f64>) -> Vec<f64> {
        let mut state = state.to_vec();
        for (linear, value) in self.linear.iter().zip(values.iter()) {
            state[linear.component] = *value;
        }
        state
    }

    /// The linear components of a tangent or a cotangent vector.
    pub(super) fn linear_of(&self, tangent: &[f64]) -> DVector<f64> {
        DVector::from_iterator(self.linear.len(), self.linear.iter().map(|linear| tangent[linear.tangent]))
    }

    /// The configurations' components of a tangent or a cotangent vector.
    pub(super) fn configuration_of(&self, tangent: &[f64]) -> DVector<f64> {
        DVector::from_iterator(self.configuration.len(), self.configuration.iter().map(|&i| tangent[i]))
    }

    /// An element of the algebra, of each axis as much of its scale as the function says of its number.
    pub(super) fn element(&self, part: impl Fn(f64) -> f64) -> DVector<f64> {
        let n = self.configuration.len();
        DVector::from_fn(n, |k, _| self.scale[self.configuration[k]] * part(k as f64))
    }

    /// How far `τ(−x) τ(x)` is off the unit.
    pub(super) fn not_inverse(&self, state: &[f64], map: RetractionKind, x: &DVector<f64>) -> f64 {
        self.distance(state, &self.moved(&self.moved(state, map, x), map, &-x))
    }

    /// `dR exp_x`, by differences of displacements, and `φ₁(ad_x)`, from the Poisson structure.
    pub(super) fn d_right_exponential(
        &self,
        state: &[f64],
        x: &DVector<f64>,
    ) -> Result<[DMatrix<f64>; 2], Degenerate> {
        let (n, all) = (x.len(), self.linear.len());
        let ad = self.coadjoint(state, &x.clone().resize_vertically(all, 0.0));
        let expected = series(&ad, &DMatrix::identity(all, n))?.rows(0, n).transpose();
        Ok([self.logarithmic_derivative(state, RetractionKind::Exponential, &-x)?, expected])
    }

    /// The state with its configurations displaced.
    pub(super) fn moved(&self, state: &[f64], map: RetractionKind, by: &DVector<f64>) -> Vec<f64> {
        let mut tangent = vec![0.0; self.dimension()];
        for (&i, by) in self.configuration.iter().zip(by.iter()) {
            tangent[i] = *by;
        }
        self.displace(state, map, &tangent)
    }

    /// The places of the state's components, by blocks that have a unit in common: each quantity, but that a rigid motion and its momentum are of
    /// turns and of positions.
    pub fn blocks(&self) -> Vec<Vec<usize>> {
        let mut blocks = Vec::new();
        let mut kind = Kind::Scalar;
        for (quantity, places) in Quantity::with_ranges(self.system.description().state) {
            // a momentum stands behind its configuration
            if quantity.role != Role::Momentum {
                kind = quantity.kind;
            }
            let turns = match (kind, quantity.role) {
                (Kind::RigidMotion2, Role::Configuration) => 2,
                (Kind::RigidMotion2, _) => 1,
                (Kind::RigidMotion3, Role::Configuration) => 4,
                (Kind::RigidMotion3, _) => 3,
                _ => places.len(),
            };
            let middle = places.start + turns;
            blocks.extend([places.start..middle, middle..places.end].map(|block| block.collect::<Vec<_>>()));
        }
        blocks.retain(|block| !block.is_empty());
        blocks
    }

    fn stored_part(&self, state: &[f64]) -> DVector<f64> {
        DVector::from_iterator(self.stored.len(), self.stored.iter().map(|&c| state[c]))
    }

    /// The derivative of a configuration's stored numbers by its displacement, at the displacement `by`.
    fn basis_at(&self, state: &[f64], map: RetractionKind, by: &DVector<f64>) -> DMatrix<f64> {
        let Ok(basis) = jacobian(self.element(|_| 1.0).iter().copied(), &mut |k, at| {
            let mut there = by.clone();
            there[k] += at;
            Ok::<_, core::convert::Infallible>(self.stored_part(&self.moved(state, map, &there)))
        });
        basis
    }

    fn basis(&self, state: &[f64]) -> DMatrix<f64> {
        self.basis_at(state, RetractionKind::Exponential, &DVector::zeros(self.configuration.len()))
    }

    /// The tangent vectors at a state that change its stored numbers like this.
    pub(super) fn local(&self, state: &[f64], changes: &DMatrix<f64>) -> Result<DMatrix<f64>, Degenerate> {
        let rows = DMatrix::from_fn(self.stored.len(), changes.ncols(), |r, c| changes[(self.stored[r], c)]);
        let turned = least_squares(&self.basis(state), &rows)?;
        let mut local = DMatrix::zeros(self.dimension(), changes.ncols());
        for (row, &i) in self.configuration.iter().enumerate() {
            local.row_mut(i).copy_from(&turned.row(row));
        }
        for linear in &self.linear {
            local.row_mut(linear.tangent).copy_from(&changes.row(linear.component));
        }
        Ok(local)
    }

    /// The derivative of a displacement in local coordinates of the displaced configuration: `dL τ_δ`, or `dR τ_δ` where the
    /// displacement is from the right side of `τ`.
    pub(super) fn logarithmic_derivative(
        &self,
        state: &[f64],
        map: RetractionKind,
        by: &DVector<f64>,
    ) -> Result<DMatrix<f64>, Degenerate> {
        let change = self.basis_at(state, map, by);
        least_squares(&self.basis(&self.moved(state, map, by)), &change)
    }

    /// The matrix of `m ↦ ad*_η m` on momenta and advected parameters, the Lie–Poisson part of the Hamiltonian vector, linear in the
    /// state. On the right side of an invariance it comes with the sign that makes `η` the displacement's.
    pub(super) fn coadjoint(&self, state: &[f64], eta: &DVector<f64>) -> DMatrix<f64> {
        let mut covector = vec![0.0; self.dimension()];
        for (linear, eta) in self.linear.iter().zip(eta.iter()) {
            covector[linear.tangent] = *eta;
        }
        columns(self.linear.len(), |k| {
            let m = axis(self.linear.len(), k, 1.0);
            self.linear_of(&self.system.hamiltonian_vector(&self.with_linear_part(state, &m), &covector))
        })
    }
}

/// The solution of `a x = b` for more equations than unknowns.
fn least_squares(a: &DMatrix<f64>, b: &DMatrix<f64>) -> Result<DMatrix<f64>, Degenerate> {
    let qr = a.clone().qr();
    qr.r().solve_upper_triangular(&(qr.q().transpose() * b)).ok_or(Degenerate)
}

/// A vector with one component of this length, and no other.
pub(super) fn axis(dimension: usize, i: usize, length: f64) -> DVector<f64> {
    let mut axis = DVector::zeros(dimension);
    axis[i] = length;
    axis
}

/// `φ₁(A) M = Σ A^k M / (k+1)!`
pub(super) fn series<C: Dim>(
    a: &DMatrix<f64>,
    m: &OMatrix<f64, Dyn, C>,
) -> Result<OMatrix<f64, Dyn, C>, Degenerate>
where
    DefaultAllocator: Allocator<Dyn, C>,
{
    let (mut sum, mut term) = (m.clone(), m.clone());
    for k in 1..80_u32 {
        term = a * term / f64::from(k + 1);
        let done = term.amax() <= 1e-18 * sum.amax();
        sum += &term;
        if done {
            return Ok(sum);
        }
    }
    // as for arguments so large that the series has no digits left
    Err(Degenerate)
}

/// `exp A = 1 + A φ₁(A)`
pub(super) fn exponential(a: &DMatrix<f64>) -> Result<DMatrix<f64>, Degenerate> {
    let one = DMatrix::identity(a.nrows(), a.nrows());
    Ok(&one + a * series(a, &one)?)
}
