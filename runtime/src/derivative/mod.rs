//! Derivatives of the step that is taken, for control, estimation and identification. They are exact; no finite differences.
//!
//! The description asks for them: `derivatives` for all, `derivatives(state)` for the matrix with respect to the state alone, likewise
//! `controls`, `parameters`, and the products `tangent` and `adjoint`. The macro then writes the derivative of each step in closed form. It
//! follows from the implicit function theorem, with all second derivatives of potentials and forces.
//!
//! # Coordinates
//!
//! Perturbations are the tangent vectors of [`Geometry`](crate::system::Geometry), in the order of the state's fields: a configuration `g` changes
//! by an element `δ` of the Lie algebra, from `g` to `g exp(δ)`, or to `exp(δ) g` where `invariance = right`, as velocities are in the body or in
//! space; momenta and advected parameters change by what is added to them. Controls and parameters change by what is added to their components,
//! constants of the description excepted. The entries of an inertia matrix count one by one, as the step reads them: perturbations are meant to
//! leave it symmetric.
//!
//! Jacobians are named, and their blocks taken, output first, then input: the block (`MOMENTUM`, `ATTITUDE`) is the derivative of the next
//! momentum with respect to the attitude.
//!
//! ```
//! use coadjoint::prelude::*;
//! use coadjoint::derivative::{WrtParameters, WrtState, block};
//!
//! #[lie_poisson_system(
//!     group = SO3,
//!     advected(gamma: R3),
//!     potential = weight * gamma.dot(&chi),
//!     derivatives,
//! )]
//! struct Top {
//!     #[inertia]
//!     inertia: Vector3<f64>,
//!     weight: f64,
//!     chi: Vector3<f64>,
//! }
//!
//! let top = Top { inertia: vector![1.0, 2.0, 2.5], weight: 1.0, chi: Vector3::z() };
//! let mut state = TopState { attitude: UnitQuaternion::identity(), momentum: vector![0.4, -0.8, 1.5], gamma: Vector3::z() };
//! let mut stepper = top.stepper::<Cayley>(0.01)?;
//!
//! let blocks = (WrtState, WrtParameters);
//! let ((wrt_state, wrt_parameters), _) = stepper.step_with_jacobian(&mut state, &Default::default(), blocks)?;
//! assert_eq!(wrt_state.shape(), (9, 9));
//! // more momentum, more turn: about h / inertia
//! let turn = block(&wrt_state, TopIndices::ATTITUDE, TopIndices::MOMENTUM);
//! assert!((turn[(0, 0)] - 0.01).abs() < 1e-4);
//! // more weight, more moment: about h gamma × chi, which is nothing for a top that stands upright
//! assert!(block(&wrt_parameters, TopIndices::MOMENTUM, TopIndices::WEIGHT).norm() < 1e-3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Products without a matrix
//!
//! [`step_with_derivative`](crate::Stepper::step_with_derivative) gives the derivative as a linear map, to be applied to
//! [perturbations](StepDerivative::tangent), or [backwards](StepDerivative::adjoint) to the derivatives of a function of the next state. Over a
//! whole run these are those of a `CheckpointedTape`, which keeps few states and takes the steps between them a second time.

mod blocks;
mod choice;
mod method;
#[cfg(feature = "std")]
mod run;
mod stepper;

use core::fmt;

use num_traits::Zero;

use blocks::dense;
pub use blocks::{
    Dense, IndexRange, JacobianBlocks, JacobianBlocksOf, WrtControl, WrtParameters, WrtState, block,
};
#[doc(hidden)]
pub use choice::{LinearizedSchemes, LinearizedVisitor};
#[doc(hidden)]
pub use method::{AllColumns, DerivativeSelection, HasDerivative, Linearizable, StartOf, StepStart};
#[cfg(feature = "std")]
pub use run::CheckpointedTape;

use crate::kernel::Kernel;
use crate::scalar::{Components, Scalar, mapped};
use crate::system::{Discretized, MethodOf, System};

/// A system whose steps have derivatives, and the spaces that these act between.
#[diagnostic::on_unimplemented(
    message = "there are no derivatives of the steps of `{Self}`",
    note = "derivatives are asked for in the description, with `derivatives`"
)]
pub trait Differentiable: System {
    /// A perturbation of the state, in the order of its fields.
    type StatePerturbation<V: Entry>: Components<V>;
    /// A perturbation of the controls.
    type ControlPerturbation<V: Entry>: Components<V>;
    /// A perturbation of the parameters.
    type ParameterPerturbation<V: Entry>: Components<V>;
    /// A perturbation of the state as nalgebra's vector.
    type StateVector: Dense<Self::Scalar>;
    /// A perturbation of the controls.
    type ControlVector: Dense<Self::Scalar>;
    /// A perturbation of the parameters.
    type ParameterVector: Dense<Self::Scalar>;
    /// The derivative of the next state with respect to the state.
    type WrtState: Dense<Self::Scalar>;
    /// The derivative of the next state with respect to the controls.
    type WrtControl: Dense<Self::Scalar>;
    /// The derivative of the next state with respect to the parameters.
    type WrtParameters: Dense<Self::Scalar>;
}

/// A system of whose steps the derivative `D` was generated: [`WrtState`], [`WrtControl`], [`WrtParameters`], [`Tangent`] or [`Adjoint`].
/// Implemented by the macro.
#[diagnostic::on_unimplemented(
    message = "the derivative `{D}` of the steps of `{Self}` was not generated",
    note = "`derivatives` in the description generates all of them, `derivatives(state, controls, parameters, tangent, adjoint)` those named"
)]
#[doc(hidden)]
pub trait Derives<D>: Differentiable {}

/// The product of a step's derivative with a perturbation: [`StepDerivative::tangent`].
#[doc(hidden)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tangent;
/// The transposed product: [`StepDerivative::adjoint`].
#[doc(hidden)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Adjoint;

/// The derivative of a generated step of the system `S`, as generated: straight-line code in two stages, the point and then linear maps
/// of perturbations.
///
/// A map that was not asked for has the body that stands here and gives zeros. These are never visible: everything public that applies a
/// map requires a system that [`Derives`] it.
#[diagnostic::on_unimplemented(
    message = "there are no derivatives of the steps of `{S}`",
    note = "derivatives are asked for in the description, with `derivatives`"
)]
#[doc(hidden)]
pub trait Linearized<T: Scalar, S: Differentiable>: Kernel<T> {
    /// What the derivative is made of at one point.
    type Point: Copy + Send + Sync;
    /// The columns of the derivative of the next state with respect to the unknown.
    type Through;
    /// Which of the matrices are there: with respect to the state, the controls and the parameters.
    const MATRICES: [bool; 3] = [false; 3];

    /// At the solution `unknown` of the step's equation.
    fn point(
        parameters: &Self::Parameters,
        step: T,
        state: &Self::State,
        time: T,
        control: &Self::Control,
        unknown: &Self::Unknown,
    ) -> Self::Point;

    /// The perturbation of the next state.
    fn tangent(
        _point: &Self::Point,
        _state: &StatePerturbation<S, T>,
        _control: &ControlPerturbation<S, T>,
        _parameters: &ParameterPerturbation<S, T>,
    ) -> StatePerturbation<S, T> {
        zeros()
    }

    /// The derivatives with respect to state, controls and parameters of a function of the next state, from its own there: the transpose.
    fn adjoint(_point: &Self::Point, _costate: &StatePerturbation<S, T>) -> PerturbationArrays<S, T> {
        (zeros(), zeros(), zeros())
    }

    /// The derivative with respect to the unknown, column by column, which the matrices have in common.
    fn through(point: &Self::Point) -> Self::Through;

    /// The derivative with respect to the state as a matrix, column by column.
    fn wrt_state(
        _point: &Self::Point,
        _through: &Self::Through,
    ) -> StatePerturbation<S, StatePerturbation<S, T>> {
        no_columns::<T, _, _>()
    }
    /// The derivative with respect to the controls.
    fn wrt_control(
        _point: &Self::Point,
        _through: &Self::Through,
    ) -> ControlPerturbation<S, StatePerturbation<S, T>> {
        no_columns::<T, _, _>()
    }
    /// The derivative with respect to the parameters.
    fn wrt_parameters(
        _point: &Self::Point,
        _through: &Self::Through,
    ) -> ParameterPerturbation<S, StatePerturbation<S, T>> {
        no_columns::<T, _, _>()
    }
}

/// Columns of zeros.
fn no_columns<T: Scalar, V: Components<T> + Entry, C: Components<V>>() -> C {
    C::splat(zeros())
}

fn zeros<T: Scalar, C: Components<T>>() -> C {
    C::splat(T::of(0.0))
}

/// What the entries of a perturbation can be: numbers, or columns of them.
#[doc(hidden)]
pub trait Entry: Copy + PartialEq + fmt::Debug + Send + Sync + 'static {}

impl<V: Copy + PartialEq + fmt::Debug + Send + Sync + 'static> Entry for V {}

type StatePerturbation<S, V> = <S as Differentiable>::StatePerturbation<V>;
type ControlPerturbation<S, V> = <S as Differentiable>::ControlPerturbation<V>;
type ParameterPerturbation<S, V> = <S as Differentiable>::ParameterPerturbation<V>;

/// Perturbations of state, controls and parameters; or the columns of derivatives with respect to them.
#[doc(hidden)]
pub type PerturbationArrays<S, V> = (
    <S as Differentiable>::StatePerturbation<V>,
    <S as Differentiable>::ControlPerturbation<V>,
    <S as Differentiable>::ParameterPerturbation<V>,
);

/// A matrix, column by column, from perturbations of the state to such.
#[doc(hidden)]
pub type Columns<S, T> = StatePerturbation<S, StatePerturbation<S, T>>;

/// Adds one perturbation to another.
fn add<T: Scalar>(sum: &mut [T], part: &[T]) {
    sum.iter_mut().zip(part).for_each(|(sum, part)| *sum = *sum + *part);
}

/// Adds `Σ columns[k] · coefficients[k]`.
#[doc(hidden)]
#[inline(always)]
pub fn add_product<T: Scalar, const N: usize, const K: usize>(
    sum: &mut [T; N],
    columns: &[[T; N]; K],
    coefficients: &[T; K],
) {
    #[cfg(feature = "std")]
    {
        use core::any::Any;
        // known when it is compiled: doubles are worked on side by side, which the compiler does not see by itself
        let doubles = (
            (sum as &mut dyn Any).downcast_mut::<[f64; N]>(),
            (columns as &dyn Any).downcast_ref::<[[f64; N]; K]>(),
            (coefficients as &dyn Any).downcast_ref::<[f64; K]>(),
        );
        if let (Some(sum), Some(columns), Some(coefficients)) = doubles {
            return crate::scalar::simd::lanes::add_product(sum, columns, coefficients);
        }
    }
    for (column, coefficient) in columns.iter().zip(coefficients) {
        for (sum, entry) in sum.iter_mut().zip(column) {
            *sum = entry.mul_add(*coefficient, *sum);
        }
    }
}

/// One for the state, one for the controls, and one for the parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parts<X, U = X, P = X> {
    /// Of the state, or with respect to it.
    pub state: X,
    /// Of the controls.
    pub control: U,
    /// Of the parameters, without the description's constants.
    pub parameters: P,
}

impl<X: Zero, U: Zero, P: Zero> Default for Parts<X, U, P> {
    fn default() -> Self {
        Self { state: X::zero(), control: U::zero(), parameters: P::zero() }
    }
}

/// A perturbation of the state, the controls and the parameters of a system. None by default.
pub type Perturbation<S> = Parts<
    <S as Differentiable>::StateVector,
    <S as Differentiable>::ControlVector,
    <S as Differentiable>::ParameterVector,
>;

/// The derivatives of a function with respect to the state, the controls and the parameters of a system.
pub type Gradient<S> = Perturbation<S>;

fn to_array<T: Scalar, C: Components<T>>(vector: &impl Dense<T>) -> C {
    mapped(vector.as_slice(), T::of(0.0), |entry| entry)
}

/// The derivative of a step of the scheme `M` as a linear map.
pub type DerivativeOf<S, M> = StepDerivative<S, <S as Discretized<M>>::Method<<S as System>::Scalar>>;

/// The derivative of one step, of the method `D`, as a linear map.
pub struct StepDerivative<S, D, P = <D as HasDerivative<S>>::Point> {
    derivative: P,
    of: core::marker::PhantomData<fn() -> (S, D)>,
}

impl<S, D, P> StepDerivative<S, D, P> {
    pub(crate) fn new(derivative: P) -> Self {
        Self { derivative, of: core::marker::PhantomData }
    }
}

impl<S, D> StepDerivative<S, D>
where
    S: Differentiable,
    D: MethodOf<S> + Linearizable<S>,
{
    /// The perturbation of the next state that follows from this perturbation.
    pub fn tangent(&self, perturbation: &Perturbation<S>) -> S::StateVector
    where
        S: Derives<Tangent>,
    {
        let Parts { state, control, parameters } = perturbation;
        let (state, control, parameters) = (to_array(state), to_array(control), to_array(parameters));
        let next = D::tangent(&self.derivative, &state, &control, &parameters);
        dense(&[next])
    }

    /// The derivatives with respect to state, controls and parameters of a function of the next state whose derivative there is `costate`: the
    /// transpose of [`tangent`](Self::tangent).
    pub fn adjoint(&self, costate: &S::StateVector) -> Gradient<S>
    where
        S: Derives<Adjoint>,
    {
        let (state, control, parameters) = D::adjoint(&self.derivative, &to_array(costate));
        Parts { state: dense(&[state]), control: dense(&[control]), parameters: dense(&[parameters]) }
    }

    /// As matrices: the blocks that are asked for.
    pub fn jacobian<B: JacobianBlocks<S>>(&self, _: B) -> B::Jacobian {
        blocks::jacobian::<S, D, B>(&self.derivative)
    }
}

// written out, because derived it would ask the same of `S` and `D`
impl<S: Differentiable, D: MethodOf<S> + Linearizable<S>> Clone for StepDerivative<S, D> {
    fn clone(&self) -> Self {
        Self { derivative: self.derivative.clone(), of: self.of }
    }
}

impl<S: Differentiable, D: MethodOf<S> + Linearizable<S>> fmt::Debug for StepDerivative<S, D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("StepDerivative").field("system", &S::NAME).finish_non_exhaustive()
    }
}
