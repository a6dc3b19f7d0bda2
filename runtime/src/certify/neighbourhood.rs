//! Elements of a group about one of them: what its [laws](super::laws) are measured with.

use nalgebra::{DMatrix, DVector, Dyn};

use super::CertifyError;
use super::frame::{Degenerate, Frame, axis, exponential, jacobian, larger};
use crate::erased::{array, check};
use crate::kernel::Kernel;
use crate::retraction::RetractionKind;
use crate::scalar::Components;
use crate::scheme::Base;
use crate::system::{Generated, Kind, Quantity, Role, System, Visitor};

/// A vector that follows from a state.
type OfState<'a> = &'a dyn Fn(&[f64]) -> Result<DVector<f64>, Degenerate>;

/// What a kernel says of a value of its unknown.
pub(super) struct KernelValue {
    /// The right side of the equation: of a mechanical system `(dR τ_x)* m`, times the number that the unknown is to be multiplied by.
    pub(super) right: Vec<f64>,
    /// The state that the unknown leads to.
    pub(super) next: Vec<f64>,
    /// Whether the retraction is regular there, with something to spare.
    pub(super) is_inside: bool,
}

/// Asks a kernel; with an unknown that is too short, at zero.
pub(super) struct EvaluateKernel<'a> {
    pub(super) parameters: &'a [f64],
    pub(super) state: &'a [f64],
    pub(super) unknown: &'a [f64],
}

impl<S: System> Visitor<S> for EvaluateKernel<'_> {
    type Output = KernelValue;

    fn visit<M: Base>(self) -> KernelValue
    where
        S: Generated<M>,
    {
        let Self { parameters, state, unknown } = self;
        let kernel = <S::Kernel<f64> as Kernel<f64>>::new(&array(parameters), 1.0);
        let (state, unknown) = (array(state), array(unknown));
        let begun = kernel.begin(&state, 0.0, &Components::splat(0.0));
        let evaluation = kernel.evaluate(&state, &begun, &unknown);
        let edge =
            |unknown| kernel.domain(&state, &begun, unknown, &kernel.evaluate(&state, &begun, unknown));
        let (here, centre) = (edge(&unknown), edge(&Components::splat(0.0)));
        KernelValue {
            right: evaluation.right.as_ref().to_vec(),
            next: kernel.finish(&state, &begun, &unknown, &evaluation).as_ref().to_vec(),
            is_inside: here.zip(centre).is_none_or(|(here, centre)| here > 0.2 * centre),
        }
    }
}

pub(super) type Kernels<'a> = &'a dyn Fn(RetractionKind, &[f64], &[f64]) -> Option<KernelValue>;

/// A configuration that is stored as a matrix, by rows.
pub(super) struct Stored {
    /// Where its first entry is in the state's array.
    from: usize,
    rows: usize,
}

/// Elements of a group about one of them, and what its laws are measured with.
pub(super) struct Neighbourhood<'a> {
    pub(super) frame: Frame<'a>,
    pub(super) state: Vec<f64>,
    kernels: Kernels<'a>,
    /// Elements of the algebra, within the domains of all retractions.
    pub(super) points: Vec<DVector<f64>>,
    /// Whether nothing but the bracket changes momenta and advected parameters.
    pub(super) is_invariant: bool,
}

impl<'a> Neighbourhood<'a> {
    pub(super) fn new(
        system: &'a dyn crate::erased::Geometry,
        state: &[f64],
        control: &[f64],
        kernels: Kernels<'a>,
    ) -> Result<Self, CertifyError> {
        let description = system.description();
        check(system, state).map_err(|source| CertifyError::Step {
            certificate: "state".to_owned(),
            state: 0,
            source,
        })?;
        let frame = Frame::new(system, state, control, 0.0)
            .ok_or(CertifyError::Structure { system: description.name })?;
        let (state, is_invariant) = (state.to_vec(), description.invariant);
        let about = Self { frame, state, kernels, points: Vec::new(), is_invariant };
        Ok(Self { points: about.elements(), ..about })
    }

    /// Whether there are steps with a retraction.
    pub(super) fn has(&self, map: RetractionKind) -> bool {
        (self.kernels)(map, &self.state, &[]).is_some()
    }

    /// What a kernel says.
    pub(super) fn value(
        &self,
        map: RetractionKind,
        state: &[f64],
        unknown: &DVector<f64>,
    ) -> Result<KernelValue, Degenerate> {
        (self.kernels)(map, state, unknown.as_slice()).ok_or(Degenerate)
    }

    /// The dimension of the group.
    pub(super) fn dimension(&self) -> usize {
        self.frame.configuration.len()
    }

    /// Two elements of the algebra of about half a radian, or smaller ones where a retraction would be singular.
    fn elements(&self) -> Vec<DVector<f64>> {
        let is_inside = |x: &DVector<f64>| {
            RetractionKind::ALL
                .into_iter()
                .all(|map| (self.kernels)(map, &self.state, x.as_slice()).is_none_or(|value| value.is_inside))
        };
        let small = |mut x: DVector<f64>| {
            for _ in 0..20 {
                if is_inside(&x) {
                    break;
                }
                x *= 0.8;
            }
            x
        };
        let one = self.frame.element(|i| 0.5 * (2.0 * i + 1.0).sin());
        let other = self.frame.element(|i| 0.4 * (3.0 * i + 2.0).cos());
        vec![small(one), small(other)]
    }

    /// Elements of the algebra with the spaces beside it, in general position.
    pub(super) fn general(&self) -> [DVector<f64>; 3] {
        [1.0, 2.3, 3.1]
            .map(|seed| DVector::from_fn(self.frame.linear.len(), |i, _| 0.2 + (seed * (i + 1) as f64).sin()))
    }

    /// `[x, y]`, from the Poisson structure: `⟨ad*_x m, y⟩ = ⟨m, [x, y]⟩`.
    pub(super) fn bracket(&self, x: &DVector<f64>, y: &DVector<f64>) -> DVector<f64> {
        self.frame.coadjoint(&self.state, x).tr_mul(y)
    }

    /// The configurations that are stored as matrices.
    pub(super) fn matrices(&self) -> Vec<Stored> {
        let quantities = Quantity::with_ranges(self.frame.system.description().state);
        let matrices = quantities.filter_map(|(quantity, places)| match (quantity.role, quantity.kind) {
            (Role::Configuration, Kind::Matrix(rows, _)) => Some(Stored { from: places.start, rows }),
            _ => None,
        });
        matrices.collect()
    }

    /// The matrices that belong to the axes of the algebra: those that displacements are made of, whatever the element is that is displaced.
    pub(super) fn basis(&self, stored: &Stored) -> Result<Basis, Degenerate> {
        let at = |state: &[f64]| -> Result<[Vec<DMatrix<f64>>; 2], Degenerate> {
            let inverse = stored.matrix(state).try_inverse().ok_or(Degenerate)?;
            let changes = jacobian(self.scales(), &mut |i, t| {
                let there = self.frame.moved(state, RetractionKind::Exponential, &self.axis(i, t));
                Ok(DVector::from_column_slice(stored.matrix(&there).as_slice()))
            })?;
            let changes = changes
                .column_iter()
                .map(|change| change.into_owned().reshape_generic(Dyn(stored.rows), Dyn(stored.rows)));
            let (left, right) = changes.map(|change| (&inverse * &change, change * &inverse)).unzip();
            Ok([left, right])
        };
        let there = self.frame.moved(&self.state, RetractionKind::Exponential, &self.points[0]);
        let ([left, right], [left_there, right_there]) = (at(&self.state)?, at(&there)?);
        let off = |a: &[DMatrix<f64>], b: &[DMatrix<f64>]| {
            a.iter().zip(b).fold(0.0, |off, (a, b)| larger(off, (a - b).amax()))
        };
        let (of_left, of_right) = (off(&left, &left_there), off(&right, &right_there));
        // where the group acts from the other side, the order of products is the other one
        Ok(match of_left <= of_right {
            true => Basis { basis: left, sign: 1.0, off: of_left },
            false => Basis { basis: right, sign: -1.0, off: of_right },
        })
    }

    /// The scales of the algebra's axes.
    fn scales(&self) -> impl Iterator<Item = f64> + '_ {
        self.frame.configuration.iter().map(|&i| self.frame.scale[i])
    }

    /// A multiple of an axis of the algebra.
    pub(super) fn axis(&self, i: usize, length: f64) -> DVector<f64> {
        axis(self.dimension(), i, length)
    }

    /// An element of the algebra, with nothing of the spaces beside it.
    pub(super) fn zero_padded(&self, x: &DVector<f64>) -> DVector<f64> {
        x.clone().resize_vertically(self.frame.linear.len(), 0.0)
    }

    /// `dR τ_x`, by differences: `dL τ_{−x}` of what is odd, else `Ad_{τ(x)} dL τ_x`.
    pub(super) fn d_right(&self, map: RetractionKind, x: &DVector<f64>) -> Result<DMatrix<f64>, Degenerate> {
        let d_left = |x: &DVector<f64>| self.frame.logarithmic_derivative(&self.state, map, x);
        if map.is_matrix_function() { d_left(&-x) } else { Ok(self.adjoint(map, x)? * d_left(x)?) }
    }

    /// `Ad_{τ(x)}`, by differences: of `z` it makes the direction in which `g τ(x) exp(tz) τ(x)⁻¹` leaves.
    pub(super) fn adjoint(&self, map: RetractionKind, x: &DVector<f64>) -> Result<DMatrix<f64>, Degenerate> {
        let there = self.frame.moved(&self.state, map, x);
        // τ(−x) is the way back where τ is odd, the exponential always is
        let (odd, x) = match map.is_matrix_function() {
            true => (map, x.clone()),
            false => (RetractionKind::Exponential, self.logarithm(map, x)?),
        };
        let changes = jacobian(self.scales(), &mut |i, t| {
            let beside = self.frame.moved(&there, RetractionKind::Exponential, &self.axis(i, t));
            Ok::<_, Degenerate>(self.frame.moved(&beside, odd, &-&x).into())
        })?;
        self.in_the_algebra(&self.state, &changes)
    }

    /// The elements of the algebra that change a state's numbers like these.
    fn in_the_algebra(&self, state: &[f64], changes: &DMatrix<f64>) -> Result<DMatrix<f64>, Degenerate> {
        Ok(self.frame.local(state, changes)?.select_rows(&self.frame.configuration))
    }

    /// `z` with `exp z = τ(x)`.
    pub(super) fn logarithm(
        &self,
        map: RetractionKind,
        x: &DVector<f64>,
    ) -> Result<DVector<f64>, Degenerate> {
        match map {
            RetractionKind::Exponential => Ok(x.clone()),
            _ => self.displacement(RetractionKind::Exponential, &self.frame.moved(&self.state, map, x)),
        }
    }

    /// `x` with `g τ(x)` the configuration of a state, by Newton's method.
    fn displacement(&self, map: RetractionKind, target: &[f64]) -> Result<DVector<f64>, Degenerate> {
        let (mut x, target) = (DVector::zeros(self.dimension()), DVector::from_column_slice(target));
        for _ in 0..10 {
            let here = self.frame.moved(&self.state, map, &x);
            let off = &target - DVector::from_column_slice(&here);
            let direction = self.in_the_algebra(&here, &DMatrix::from_columns(&[off]))?;
            let derivative = self.frame.logarithmic_derivative(&self.state, map, &x)?;
            x += (derivative.try_inverse().ok_or(Degenerate)? * direction).column(0);
        }
        Ok(x)
    }

    /// The unknown of a kernel that moves the configuration by `τ(x)`. Nothing of one that has others too.
    pub(super) fn unknown(
        &self,
        map: RetractionKind,
        x: &DVector<f64>,
    ) -> Result<Option<Unknown>, Degenerate> {
        let here = self.value(map, &self.state, x)?;
        if here.right.is_empty() {
            return Ok(Some(Unknown::None { next: here.next }));
        }
        if here.right.len() != x.len() {
            return Ok(None);
        }
        let changes = jacobian(self.scales(), &mut |i, t| {
            self.value(map, &self.state, &self.axis(i, t)).map(|value| value.next.into())
        })?;
        // whole numbers, but for the digits that differences leave
        let factor = self.in_the_algebra(&self.state, &changes)?.map(f64::round);
        let unknown = factor.clone().try_inverse().ok_or(Degenerate)? * x;
        Ok(Some(Unknown::Of { factor, unknown }))
    }

    /// What a kernel makes of momenta where it moves the configuration by `τ(x)`; by another `x` than was asked for if it has no unknown.
    pub(super) fn carried(
        &self,
        map: RetractionKind,
        x: &DVector<f64>,
    ) -> Result<Option<Carried>, Degenerate> {
        let n = self.dimension();
        let momentum = |state: &[f64]| self.frame.linear_part(state).rows(0, n).into_owned();
        match self.unknown(map, x)? {
            Some(Unknown::Of { unknown, .. }) => {
                let of = |state: &[f64]| Ok(momentum(&self.value(map, state, &unknown)?.next));
                let after = self.by_momentum(&of)?;
                Ok(Some(Carried { x: x.clone(), before: DMatrix::identity(n, n), after }))
            }
            Some(Unknown::None { next }) if self.is_invariant && self.frame.linear.len() == n => {
                let column = |state: &[f64]| DMatrix::from_columns(&[momentum(state)]);
                let x = self.displacement(map, &next)?;
                Ok(Some(Carried { x, before: column(&self.state), after: column(&next) }))
            }
            _ => Ok(None),
        }
    }

    /// The matrix of what is linear in the momentum but for a constant.
    pub(super) fn by_momentum(&self, of: OfState<'_>) -> Result<DMatrix<f64>, Degenerate> {
        let (start, here) = (self.frame.linear_part(&self.state), of(&self.state)?);
        let column = |i: usize| {
            let mut there = start.clone();
            there[i] += 1.0;
            Ok(of(&self.frame.with_linear_part(&self.state, &there))? - &here)
        };
        let columns: Vec<_> = (0..self.dimension()).map(column).collect::<Result<_, Degenerate>>()?;
        Ok(DMatrix::from_columns(&columns))
    }
}

/// What a kernel is asked with.
pub(super) enum Unknown {
    /// Its unknown, and the matrix that makes an element of the algebra of it.
    Of { factor: DMatrix<f64>, unknown: DVector<f64> },
    /// It is explicit, and leads to this state.
    None { next: Vec<f64> },
}

/// Momenta before and after a move by `τ(x)`, as columns.
pub(super) struct Carried {
    pub(super) x: DVector<f64>,
    pub(super) before: DMatrix<f64>,
    pub(super) after: DMatrix<f64>,
}

/// The matrices of an algebra's axes.
pub(super) struct Basis {
    pub(super) basis: Vec<DMatrix<f64>>,
    /// Of the bracket: −1 where elements are displaced from the left.
    pub(super) sign: f64,
    /// How much it differs from one element to another.
    pub(super) off: f64,
}

impl Stored {
    pub(super) fn matrix(&self, state: &[f64]) -> DMatrix<f64> {
        DMatrix::from_row_slice(self.rows, self.rows, &state[self.from..self.from + self.rows * self.rows])
    }
}

/// `Σ xᵢ Eᵢ`
pub(super) fn combined(basis: &[DMatrix<f64>], x: &DVector<f64>) -> DMatrix<f64> {
    let zero = DMatrix::zeros(basis[0].nrows(), basis[0].ncols());
    basis.iter().zip(x.iter()).fold(zero, |sum, (e, x)| sum + e * *x)
}

/// Tells whether certificates have a definition of a retraction, to hold it against.
pub(super) const fn is_defined(map: RetractionKind) -> bool {
    matches!(map, RetractionKind::Exponential | RetractionKind::Cayley | RetractionKind::SecondKind)
}

/// `exp X`, or `(1 − X/2)⁻¹(1 + X/2)`.
pub(super) fn function(map: RetractionKind, x: &DMatrix<f64>) -> Result<DMatrix<f64>, Degenerate> {
    let one = DMatrix::identity(x.nrows(), x.nrows());
    match map {
        RetractionKind::Exponential => exponential(x),
        RetractionKind::Cayley => (&one - x * 0.5).lu().solve(&(&one + x * 0.5)).ok_or(Degenerate),
        _ => Err(Degenerate),
    }
}
