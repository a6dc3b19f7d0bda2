//! Jacobians as matrices, block by block.

use core::fmt::Debug;

use nalgebra::{ClosedAddAssign, SMatrix};
use num_traits::Zero;

use super::{
    DerivativeSelection, Derives, Differentiable, Linearizable, PerturbationArrays, StartOf,
    StatePerturbation,
};
use crate::scalar::{Real, Scalar};
use crate::system::{MethodOf, System};

/// A matrix whose size is in its type.
#[doc(hidden)]
pub trait Dense<T>: Copy + Zero + PartialEq + Debug {
    /// How many rows it has.
    const ROWS: usize;
    /// All zeros.
    fn zeros() -> Self;
    /// Its entries, column by column.
    fn as_slice(&self) -> &[T];
    /// Its entries, column by column.
    fn as_mut_slice(&mut self) -> &mut [T];
}

impl<T, const R: usize, const C: usize> Dense<T> for SMatrix<T, R, C>
where
    T: Scalar + Zero + ClosedAddAssign,
{
    const ROWS: usize = R;

    #[inline]
    fn zeros() -> Self {
        Self::from_data(nalgebra::ArrayStorage([[T::of(0.0); R]; C]))
    }
    #[inline]
    fn as_slice(&self) -> &[T] {
        SMatrix::as_slice(self)
    }
    #[inline]
    fn as_mut_slice(&mut self) -> &mut [T] {
        SMatrix::as_mut_slice(self)
    }
}

/// The derivatives with respect to the state.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WrtState;
/// The derivatives with respect to the controls.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WrtControl;
/// The derivatives with respect to the parameters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WrtParameters;

/// The derivatives of the next state that are asked for: [`WrtState`], [`WrtControl`], [`WrtParameters`], or several of them, as `(WrtState,
/// WrtControl)`. Others are not computed.
#[diagnostic::on_unimplemented(
    message = "the derivatives `{Self}` of the steps of `{S}` were not generated",
    note = "`derivatives` in the description generates all of them, `derivatives(state, controls, parameters, tangent, adjoint)` those named"
)]
#[doc(hidden)]
pub trait JacobianBlocks<S: System>: DerivativeSelection {
    /// The matrix, or the matrices in the order asked for.
    type Jacobian;

    /// The matrices of these columns.
    #[doc(hidden)]
    fn of(columns: &PerturbationArrays<S, StatePerturbation<S, S::Scalar>>) -> Self::Jacobian
    where
        S: Differentiable;

    /// Whether all entries are finite.
    #[doc(hidden)]
    fn is_finite(jacobian: &Self::Jacobian) -> bool;
}

/// [`JacobianBlocks`] that were generated for the steps of the method `D`.
#[diagnostic::on_unimplemented(
    message = "the derivatives `{Self}` of the steps of `{S}` were not generated",
    note = "`derivatives` in the description generates all of them, `derivatives(state, controls, parameters, tangent, adjoint)` those named"
)]
#[doc(hidden)]
pub trait JacobianBlocksOf<S: System, D: MethodOf<S>>: JacobianBlocks<S> {
    /// Those of the method's last step, which started so.
    #[doc(hidden)]
    fn matrices(method: &D, start: &StartOf<'_, D>) -> Self::Jacobian;
}

#[diagnostic::do_not_recommend]
impl<S, D, B> JacobianBlocksOf<S, D> for B
where
    S: Differentiable,
    D: MethodOf<S> + Linearizable<S>,
    B: JacobianBlocks<S>,
{
    #[inline(always)]
    fn matrices(method: &D, start: &StartOf<'_, D>) -> B::Jacobian {
        let derivative = method.derivative(start, &method.trace());
        jacobian::<S, D, B>(&derivative)
    }
}

/// Whether all numbers are finite, without a branch for each.
#[inline(always)]
pub(super) fn all_finite<T: Real>(numbers: &[T]) -> bool {
    numbers.iter().fold(true, |all, x| all & x.is_finite())
}

/// The matrix of these columns.
#[inline(always)]
pub(super) fn dense<T: Scalar, M: Dense<T>, C: AsRef<[T]>>(columns: &[C]) -> M {
    let mut matrix = M::zeros();
    // plain loops, to be compiled for the processor that this is compiled for
    for (to, column) in matrix.as_mut_slice().chunks_exact_mut(M::ROWS.max(1)).zip(columns) {
        for (entry, number) in to.iter_mut().zip(column.as_ref()) {
            *entry = *number;
        }
    }
    matrix
}

macro_rules! single {
    ($($blocks:ident $part:tt $state:literal $control:literal $parameters:literal,)*) => {
        $(impl DerivativeSelection for $blocks {
            const STATE: bool = $state;
            const CONTROL: bool = $control;
            const PARAMETERS: bool = $parameters;
        }

        #[diagnostic::do_not_recommend]
        impl<S: Derives<$blocks>> JacobianBlocks<S> for $blocks {
            type Jacobian = S::$blocks;

            #[inline(always)]
            fn of(columns: &PerturbationArrays<S, StatePerturbation<S, S::Scalar>>) -> Self::Jacobian {
                dense(columns.$part.as_ref())
            }
            #[inline(always)]
            fn is_finite(jacobian: &Self::Jacobian) -> bool {
                all_finite(Dense::<S::Scalar>::as_slice(jacobian))
            }
        })*
    };
}
single! { WrtState 0 true false false, WrtControl 1 false true false, WrtParameters 2 false false true, }

macro_rules! several {
    ($($blocks:ident),*) => {
        impl<$($blocks: DerivativeSelection),*> DerivativeSelection for ($($blocks,)*) {
            const STATE: bool = $($blocks::STATE)||*;
            const CONTROL: bool = $($blocks::CONTROL)||*;
            const PARAMETERS: bool = $($blocks::PARAMETERS)||*;
        }

        #[diagnostic::do_not_recommend]
        impl<S: Differentiable, $($blocks: JacobianBlocks<S>),*> JacobianBlocks<S> for ($($blocks,)*) {
            type Jacobian = ($($blocks::Jacobian,)*);

            #[inline(always)]
            fn of(columns: &PerturbationArrays<S, StatePerturbation<S, S::Scalar>>) -> Self::Jacobian {
                ($($blocks::of(columns),)*)
            }
            #[inline(always)]
            #[allow(non_snake_case)] // the matrices have the names of their types
            fn is_finite(($($blocks,)*): &Self::Jacobian) -> bool {
                $(<$blocks as JacobianBlocks<S>>::is_finite($blocks))&&*
            }
        }
    };
}
several!(A, B);
several!(A, B, C);

/// The blocks that are asked for.
#[inline(always)]
pub(crate) fn jacobian<S, D, B>(derivative: &D::Derivative) -> B::Jacobian
where
    S: Differentiable,
    D: Linearizable<S, Scalar = S::Scalar>,
    B: JacobianBlocks<S>,
{
    B::of(&D::columns::<B>(derivative))
}

/// Where a part of a state, of controls or of parameters is within a perturbation of these: from which entry on, and how many. Generated, as
/// `TopIndices::MOMENTUM`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[doc(hidden)]
pub struct IndexRange<const START: usize, const LEN: usize>;

/// Takes a block of a Jacobian: output, then input.
///
/// The derivative of a part of the next state with respect to a part of its input. The sizes are checked when it is compiled.
pub fn block<
    T,
    const R: usize,
    const C: usize,
    const I: usize,
    const M: usize,
    const J: usize,
    const N: usize,
>(
    jacobian: &SMatrix<T, R, C>,
    _output: IndexRange<I, M>,
    _input: IndexRange<J, N>,
) -> SMatrix<T, M, N>
where
    T: Real + nalgebra::Scalar,
{
    const { assert!(I + M <= R && J + N <= C, "these parts are not in this matrix") };
    SMatrix::from_fn(|i, j| jacobian[(I + i, J + j)])
}
