//! The traits that generated code implements.

use nalgebra::{Quaternion, SMatrix, UnitQuaternion};

use crate::error::ParameterError;
use crate::kernel::{Components, Kernel};
use crate::method::{Method, OneStep};
use crate::retraction::{Cayley, Exponential};
use crate::scalar::{Real, Scalar};
use crate::stepper::Stepper;

/// A named quantity of one or more components: a parameter or a part of the state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Quantity {
    /// The field's name.
    pub name: &'static str,
    /// The components' suffixes in storage order, `[""]` for a scalar: `["x", "y", "z"]`, `["w", "x", "y", "z"]`.
    pub components: &'static [&'static str],
    /// The first line of the field's documentation, empty if there is none.
    pub doc: &'static str,
}

/// The state of a [`System`]: configuration, momentum, advected parameters.
///
/// A plain struct of nalgebra types; this trait also shows it as a flat array, in the order of its fields.
/// Unit quaternions are stored as `w, x, y, z`.
pub trait State: Clone + PartialEq + core::fmt::Debug {
    /// `f64` or `f32`.
    type Scalar: Real;
    /// The flat array.
    type Components: Components<Self::Scalar>;
    /// The fields, in order.
    const QUANTITIES: &'static [Quantity];
    /// The state as a flat array.
    fn to_components(&self) -> Self::Components;
    /// The state from a flat array. What must be of unit length is taken as it is.
    fn from_components(components: &Self::Components) -> Self;
    /// How far the configuration is off its group: for an attitude, the difference of its quaternion's length from 1.
    fn deviation(&self) -> Self::Scalar;
}

/// A mechanical system described with [`lie_poisson_system`](crate::lie_poisson_system).
pub trait System: Sized {
    /// The scalar of its fields, `f64` or `f32`.
    type Scalar: Real;
    /// Its state.
    type State: State<Scalar = Self::Scalar, Components = Self::StateComponents<Self::Scalar>>;
    /// The state's flat array, over any scalar.
    type StateComponents<T: Scalar>: Components<T>;
    /// The parameters' flat array, over any scalar.
    type Parameters<T: Scalar>: Components<T>;
    /// The Casimirs' flat array.
    type Casimirs: Components<Self::Scalar>;
    /// Momentum: an element of the dual of the Lie algebra.
    type Momentum: Clone + PartialEq + core::fmt::Debug;

    /// The struct's name.
    const NAME: &'static str;
    /// The parameters, in the order of the struct's fields.
    const PARAMETERS: &'static [Quantity];
    /// The names of the Casimirs: functions of the state that every Hamiltonian with this bracket keeps.
    const CASIMIRS: &'static [&'static str];

    /// The parameters as a flat array.
    fn to_parameters(&self) -> Self::Parameters<Self::Scalar>;
    /// The system with the parameters of a flat array.
    fn from_parameters(parameters: &Self::Parameters<Self::Scalar>) -> Self;
    /// Checks the parameters.
    ///
    /// # Errors
    /// If one is not finite, or an inertia not symmetric positive definite.
    fn validate(&self) -> Result<(), ParameterError>;

    /// The Hamiltonian: kinetic plus potential energy.
    fn energy(&self, state: &Self::State) -> Self::Scalar;
    /// The Casimirs, in the order of [`CASIMIRS`](Self::CASIMIRS).
    fn casimirs(&self, state: &Self::State) -> Self::Casimirs;
    /// The momentum in space coordinates, `Ad*_{g⁻¹} μ`: constant if nothing acts on the system.
    fn spatial_momentum(&self, state: &Self::State) -> Self::Momentum;

    /// A stepper with the given step (negative steps go back in time).
    ///
    /// # Errors
    /// If the parameters are not valid ([`validate`](Self::validate)) or the step is zero or not finite.
    fn stepper<M>(&self, step: Self::Scalar) -> Result<Stepper<Self, M>, ParameterError>
    where
        Self: Discretized<M>,
    {
        Stepper::new(self, step)
    }
}

/// A system with a step of the scheme `M`: a [retraction](crate::retraction), or a [composition](crate::composition) of steps.
#[diagnostic::on_unimplemented(
    message = "there is no step of the scheme `{M}` for `{Self}`",
    note = "schemes are `Exponential`, `Cayley`, and compositions of them such as `Order6<Exponential>`"
)]
pub trait Discretized<M>: System {
    /// What takes the steps.
    type Method: Method<
            Scalar = Self::Scalar,
            Parameters = Self::Parameters<Self::Scalar>,
            State = Self::StateComponents<Self::Scalar>,
        >;
}

/// A system for which the macro has generated the straight-line code of a step with the retraction `R`.
pub trait Generated<R>: System {
    /// The generated code, over any scalar.
    type Kernel<T: Scalar>: Kernel<T, Parameters = Self::Parameters<T>, State = Self::StateComponents<T>>;
}

impl<S: Generated<Exponential>> Discretized<Exponential> for S {
    type Method = OneStep<S::Scalar, S::Kernel<S::Scalar>>;
}

impl<S: Generated<Cayley>> Discretized<Cayley> for S {
    type Method = OneStep<S::Scalar, S::Kernel<S::Scalar>>;
}

/// A value stored in a struct's field, as `N` scalars: scalars, vectors, matrices (by rows), unit quaternions (`w, x, y, z`).
pub trait Stored<T, const N: usize>: Sized {
    /// Its scalars.
    fn to_array(&self) -> [T; N];
    /// The value of these scalars. What must be of unit length is taken as it is.
    fn from_array(array: [T; N]) -> Self;
    /// How far it is from what its type promises, as nalgebra's unchecked constructors and deserializers may leave it: the
    /// difference of a unit quaternion's length from 1, otherwise `zero`.
    fn deviation(&self, zero: T) -> T {
        zero
    }
}

impl<T: Real> Stored<T, 1> for T {
    #[inline(always)]
    fn to_array(&self) -> [T; 1] {
        [*self]
    }
    #[inline(always)]
    fn from_array([x]: [T; 1]) -> Self {
        x
    }
}

impl<T: nalgebra::Scalar + Copy, const R: usize, const C: usize, const N: usize> Stored<T, N>
    for SMatrix<T, R, C>
{
    #[inline(always)]
    fn to_array(&self) -> [T; N] {
        const { assert!(N == R * C, "an array of as many scalars as the matrix has") };
        core::array::from_fn(|k| self[(k / C, k % C)])
    }
    #[inline(always)]
    fn from_array(array: [T; N]) -> Self {
        const { assert!(N == R * C, "an array of as many scalars as the matrix has") };
        SMatrix::from_fn(|i, j| array[i * C + j])
    }
}

impl<T: nalgebra::RealField + Copy> Stored<T, 4> for UnitQuaternion<T> {
    #[inline(always)]
    fn to_array(&self) -> [T; 4] {
        [self.w, self.i, self.j, self.k]
    }
    #[inline(always)]
    fn from_array([w, x, y, z]: [T; 4]) -> Self {
        UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z))
    }
    #[inline]
    fn deviation(&self, _zero: T) -> T {
        nalgebra::ComplexField::abs(self.as_ref().norm() - T::one())
    }
}
