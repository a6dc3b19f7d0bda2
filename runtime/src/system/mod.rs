//! The traits that generated code implements.

pub(crate) mod adaptive;
mod description;
mod dynamics;
mod geometry;
pub(crate) mod input;
pub(crate) mod length;
pub(crate) mod pace;
mod right_lift;
pub(crate) mod series;
pub(crate) mod stepper;

use core::fmt;
use core::marker::PhantomData;

use nalgebra::{
    Complex, ComplexField, Isometry2, Isometry3, Quaternion, RealField, SMatrix, Translation2, Translation3,
    UnitComplex, UnitQuaternion,
};

use crate::crossing::Event;
use crate::error::ParameterError;
use crate::kernel::Kernel;
use crate::legendre::LegendreError;
use crate::method::{AdjointPair, Method};
use crate::retraction::{self, RetractionKind};
use crate::scalar::{Batch, Components, Real, Scalar};
use crate::scheme::{self, Base, Rule, StormerVerlet, SymplecticEulerA, SymplecticEulerB};
use crate::solve::step::OneStep;
use adaptive::Adaptive;
pub use description::Description;
pub use dynamics::Dynamics;
pub use geometry::{Geometry, Isolated};
pub(crate) use right_lift::ConservedMomentum;
use series::{PowerSeries, SeriesVisitor};
use stepper::Stepper;

/// A named quantity of one or more components: a parameter, a part of the state or a control.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Quantity {
    /// The field's name; of an element of an array with its number, `spins_0`.
    pub name: &'static str,
    /// What it is to the system.
    pub role: Role,
    /// What it is mathematically, which says how it is stored.
    pub kind: Kind,
    /// The components' suffixes in storage order, `[""]` for a scalar: `["x", "y", "z"]`, `["w", "x", "y", "z"]`.
    pub components: &'static [&'static str],
    /// Where its perturbation starts and ends within those of all quantities of the state, all parameters or all controls. The perturbation of a
    /// configuration is an element of the Lie algebra.
    pub tangent: (usize, usize),
    /// Its unit, if the description says one: `#[unit("kg m²")]` on the field.
    pub unit: Option<&'static str>,
    /// The first line of the field's documentation, empty if there is none.
    pub doc: &'static str,
}

/// A quantity with this perturbation, of a unit that is empty where none is known: called by generated code, which is then shorter.
#[doc(hidden)]
#[allow(clippy::too_many_arguments, reason = "a record without the names of its fields")]
pub const fn quantity(
    name: &'static str,
    role: Role,
    kind: Kind,
    components: &'static [&'static str],
    start: usize,
    end: usize,
    unit: &'static str,
    doc: &'static str,
) -> Quantity {
    let unit = if unit.is_empty() { None } else { Some(unit) };
    Quantity { name, role, kind, components, tangent: (start, end), unit, doc }
}

impl Quantity {
    /// The range of its perturbation within those of all quantities beside it.
    pub fn tangent(&self) -> core::ops::Range<usize> {
        self.tangent.0..self.tangent.1
    }

    /// Each quantity with the range of its numbers in a list of all of them.
    pub fn with_ranges(quantities: &[Self]) -> impl Iterator<Item = (&Self, core::ops::Range<usize>)> {
        quantities.iter().scan(0, |end, quantity| {
            let start = *end;
            *end += quantity.components.len();
            Some((quantity, start..*end))
        })
    }
}

/// What a [`Quantity`] is mathematically.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Kind {
    /// A number.
    Scalar,
    /// A vector of so many numbers.
    Vector(usize),
    /// A symmetric matrix of so many rows, all of it stored, row by row.
    SymmetricMatrix(usize),
    /// A matrix of so many rows and columns, row by row.
    Matrix(usize, usize),
    /// A rotation of the plane: cosine and sine.
    UnitComplex,
    /// A rotation of space, from the body: `w, x, y, z`.
    UnitQuaternion,
    /// A motion of the plane: its rotation, then its translation.
    RigidMotion2,
    /// A motion of space: its rotation, then its translation.
    RigidMotion3,
}

/// On which side of the configuration velocities and momenta are taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// In the body: `g' = g ξ`.
    Left,
    /// In space: `g' = ξ g`.
    Right,
}

/// What a [`Quantity`] is to its system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Role {
    /// A parameter: constant.
    Parameter,
    /// An element of the group: where the system is.
    Configuration,
    /// An element of the dual of its Lie algebra: how it moves.
    Momentum,
    /// Something fixed in space that the system sees from the body, or the other way round.
    Advected,
    /// Something chosen from outside, for each step.
    Control,
}

/// The state of a [`System`]: configuration, momentum, advected parameters.
///
/// A plain struct of nalgebra types, and arrays of them; this trait also shows it as a flat array, in the order of its fields. Of an array of factors each
/// configuration is followed by its momentum.
/// Rotations are stored as `w, x, y, z` in space and `re, im` in the plane, isometries as their rotation, then their translation.
pub trait State: Clone + PartialEq + fmt::Debug {
    /// `f64` or `f32`.
    type Scalar: Real;
    /// The flat array.
    type Components: Components<Self::Scalar>;
    /// The fields in order, each element of an array by itself.
    const QUANTITIES: &'static [Quantity];
    /// The state as a flat array.
    fn to_components(&self) -> Self::Components;
    /// The state from a flat array. What must be of unit length is taken as it is.
    fn from_components(components: &Self::Components) -> Self;
    /// How far the configuration is off its group: for a rotation, the difference from 1 of the length of its
    /// quaternion or complex number.
    fn deviation(&self) -> Self::Scalar;
}

/// The controls of a [`System`]: inputs you pass to each step, such as thrusts and torques. They are constant during it.
///
/// A plain struct whose default is all zeros; this trait also shows it as a flat array, in the order of its fields.
pub trait Control: Clone + PartialEq + fmt::Debug + Default {
    /// `f64` or `f32`.
    type Scalar: Real;
    /// The flat array.
    type Components: Components<Self::Scalar>;
    /// The fields in order, each element of an array by itself.
    const QUANTITIES: &'static [Quantity];
    /// The controls as a flat array.
    fn to_components(&self) -> Self::Components;
    /// The controls from a flat array.
    fn from_components(components: &Self::Components) -> Self;
}

/// The controls of a system that has none.
#[derive(Clone, Copy, PartialEq)]
pub struct NoControl<T>(PhantomData<T>);

impl<T: Real> Control for NoControl<T> {
    type Scalar = T;
    type Components = [T; 0];
    const QUANTITIES: &'static [Quantity] = &[];

    #[inline(always)]
    fn to_components(&self) -> [T; 0] {
        []
    }
    #[inline(always)]
    fn from_components(_: &[T; 0]) -> Self {
        Self::default()
    }
}

// written out, because derived they would ask the same of `T`
impl<T> Default for NoControl<T> {
    fn default() -> Self {
        Self(PhantomData)
    }
}

impl<T> fmt::Debug for NoControl<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("NoControl")
    }
}

/// A mechanical system described with [`lie_poisson_system`](crate::lie_poisson_system).
pub trait System: Sized {
    /// The scalar of its fields, `f64` or `f32`.
    type Scalar: Real;
    /// Its state.
    type State: State<Scalar = Self::Scalar, Components = Self::StateComponents<Self::Scalar>>;
    /// The state's flat array, over any scalar.
    type StateComponents<T: Scalar>: Components<T>;
    /// Its controls, [`NoControl`] if it has none.
    type Control: Control<Scalar = Self::Scalar, Components = Self::ControlComponents<Self::Scalar>>;
    /// The controls' flat array, over any scalar.
    type ControlComponents<T: Scalar>: Components<T>;
    /// The parameters' flat array, over any scalar.
    type Parameters<T: Scalar>: Components<T>;
    /// The Casimirs' flat array.
    type Casimirs: Components<Self::Scalar>;
    /// Momentum: an element of the dual of the Lie algebra.
    type Momentum: Clone + PartialEq + fmt::Debug;
    /// The scheme of order 2 that a bare retraction `R` stands for: [`SymplecticEulerA<R>`] for left-invariant systems (the paper's
    /// reduced step (6.5)), [`StormerVerlet<R>`] where a potential on the group or a force acts. For [`SecondKind`](coadjoint::SecondKind), which is not odd, it is
    /// [`StormerVerlet`] for every system.
    type Standard<R>;

    /// The struct's name.
    const NAME: &'static str;
    /// The parameters, in the order of the struct's fields, each element of an array by itself.
    const PARAMETERS: &'static [Quantity];
    /// The names of the Casimirs: functions of the state that every Hamiltonian with this bracket keeps.
    const CASIMIRS: &'static [&'static str];
    /// Whether the Hamiltonian does not depend on time and no force acts: then energy is an invariant of the motion, if an energy names controls
    /// as long as these are the same.
    const AUTONOMOUS: bool;
    /// Whether momentum, advected parameters and controls alone have a part in the motion: no force acts, and the Hamiltonian depends
    /// neither on the configuration nor on time.
    const INVARIANT: bool;
    /// Whether a force acts: then neither the motion nor a step is symplectic.
    const FORCED: bool;
    /// Whether energy or forces are written piece by piece: an `if`, `abs` or `max` in them goes by state or time. Then derivatives may jump, and
    /// what is proved of smooth systems holds between kinks.
    const PIECEWISE: bool = false;
    /// The events of the description: their names, and which of their zeros count.
    const EVENTS: &'static [(&'static str, Event)] = &[];
    /// On which side of the configuration velocities and momenta are taken.
    const SIDE: Side;

    /// The parameters as a flat array.
    fn to_parameters(&self) -> Self::Parameters<Self::Scalar>;
    /// The system with the parameters of a flat array.
    fn from_parameters(parameters: &Self::Parameters<Self::Scalar>) -> Self;
    /// Checks the parameters.
    ///
    /// # Errors
    /// If one is not finite, or an inertia not symmetric positive definite.
    fn validate(&self) -> Result<(), ParameterError>;

    /// The Hamiltonian at a time and with controls: kinetic plus potential energy.
    fn energy_at(&self, state: &Self::State, time: Self::Scalar, control: &Self::Control) -> Self::Scalar;
    /// The Hamiltonian at time 0 with all controls zero; the same at all times and with all controls unless an energy names them.
    fn energy(&self, state: &Self::State) -> Self::Scalar {
        self.energy_at(state, Self::Scalar::of(0.0), &Self::Control::default())
    }
    /// The quantity that is zero at an event of the description, by its place in [`EVENTS`](Self::EVENTS); not a number if there is none there.
    fn event_at(
        &self,
        _event: usize,
        _state: &Self::State,
        _time: Self::Scalar,
        _control: &Self::Control,
    ) -> Self::Scalar {
        Self::Scalar::of(f64::NAN)
    }
    /// The body velocity `∂h/∂μ` at a time and with controls, of all factors one after the other: `𝕀⁻¹ μ` for a mechanical system. Not a number
    /// if there is none: see [`velocity_of`](Self::velocity_of).
    fn velocity_at(&self, state: &Self::State, time: Self::Scalar, control: &Self::Control)
    -> Self::Momentum;
    /// The body velocity at time 0 with all controls zero; the same at all times and with all controls unless an energy names them.
    fn velocity(&self, state: &Self::State) -> Self::Momentum {
        self.velocity_at(state, Self::Scalar::of(0.0), &Self::Control::default())
    }
    /// The momentum of a state, of all factors one after the other.
    fn momentum(&self, state: &Self::State) -> Self::Momentum;
    /// The state with another momentum.
    fn with_momentum(&self, state: &Self::State, momentum: &Self::Momentum) -> Self::State;
    /// The momentum that belongs to a velocity, where configuration and advected parameters are those of the state: `𝕀 ξ`, or `∂l/∂ξ` of a
    /// Lagrangian (4.7), or what solves `∂h/∂μ = ξ`.
    ///
    /// # Errors
    /// If there is none.
    fn momentum_of(
        &self,
        velocity: &Self::Momentum,
        state: &Self::State,
        time: Self::Scalar,
        control: &Self::Control,
    ) -> Result<Self::Momentum, LegendreError>;
    /// The velocity that belongs to a momentum, where configuration and advected parameters are those of the state.
    ///
    /// # Errors
    /// If there is none, as where `∂²l/∂ξ²` is singular.
    fn velocity_of(
        &self,
        momentum: &Self::Momentum,
        state: &Self::State,
        time: Self::Scalar,
        control: &Self::Control,
    ) -> Result<Self::Momentum, LegendreError>;
    /// The state with the momentum that belongs to a velocity at time 0 with all controls zero: an initial state by its velocity.
    ///
    /// # Errors
    /// If there is none.
    fn with_velocity(
        &self,
        state: &Self::State,
        velocity: &Self::Momentum,
    ) -> Result<Self::State, LegendreError> {
        let momentum = self.momentum_of(velocity, state, Self::Scalar::of(0.0), &Self::Control::default())?;
        Ok(self.with_momentum(state, &momentum))
    }
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

    /// Takes Taylor steps that are as long as a tolerance allows: the local error of a step is about as large, relative to the largest of what has the same
    /// unit.
    ///
    /// # Errors
    /// If the parameters are not valid ([`validate`](Self::validate)), or the tolerance is not between 0 and 1.
    fn adaptive(&self, tolerance: f64) -> Result<Adaptive<Self>, ParameterError>
    where
        Self: PowerSeries,
    {
        Adaptive::new(self, tolerance)
    }

    /// Shows the power series of the motion, if they were generated.
    #[doc(hidden)]
    fn visit_series<V: SeriesVisitor<Self>>(_: V) -> Option<V::Output> {
        None
    }
}

/// A system with a step of the scheme `M`: a [retraction](RetractionKind), a [scheme] on one, or a
/// [composition](crate::composition) of steps.
#[diagnostic::on_unimplemented(
    message = "there is no step of the scheme `{M}` for `{Self}`",
    note = "steps are generated with the retractions that `retractions(…)` names in the description, without it with `Exponential` and `Cayley`, on some groups of matrices with one of the two; a scheme other than the standard one is asked for with `methods(Midpoint, …)`",
    note = "`SymplecticEulerA<R>` is `Family<R, 0, 1>`, `Midpoint<R>` is `Family<R, 1, 2>` and `SymplecticEulerB<R>` is `Family<R, 1, 1>`; without the rest, `Family` is `Family<Exponential, 0, 1>`"
)]
pub trait Discretized<M>: System {
    /// What takes the steps, over a number or several side by side.
    type Method<T: Batch>: Method<
            Scalar = T,
            Parameters = Self::Parameters<T>,
            State = Self::StateComponents<T>,
            Control = Self::ControlComponents<T>,
        >;
}

/// A method for the arrays of a system.
#[doc(hidden)]
pub trait MethodOf<S: System>:
    Method<
        Scalar = S::Scalar,
        Parameters = S::Parameters<S::Scalar>,
        State = S::StateComponents<S::Scalar>,
        Control = S::ControlComponents<S::Scalar>,
    >
{
}

impl<S: System, D> MethodOf<S> for D where
    D: Method<
            Scalar = S::Scalar,
            Parameters = S::Parameters<S::Scalar>,
            State = S::StateComponents<S::Scalar>,
            Control = S::ControlComponents<S::Scalar>,
        >
{
}

/// A system for which the macro has generated the straight-line code of a step of the scheme `M`, a member of the
/// [family](coadjoint::Family).
#[diagnostic::on_unimplemented(
    message = "there is no step of the scheme `{M}` for `{Self}`",
    note = "steps are generated with the retractions that `retractions(…)` names in the description, without it with `Exponential` and `Cayley`, on some groups of matrices with one of the two; a scheme other than the standard one is asked for with `methods(Midpoint, …)`",
    note = "`SymplecticEulerA<R>` is `Family<R, 0, 1>`, `Midpoint<R>` is `Family<R, 1, 2>` and `SymplecticEulerB<R>` is `Family<R, 1, 1>`; without the rest, `Family` is `Family<Exponential, 0, 1>`"
)]
#[doc(hidden)]
pub trait Generated<M>: System {
    /// The generated code, over any scalar.
    type Kernel<T: Scalar>: Kernel<
            T,
            Parameters = Self::Parameters<T>,
            State = Self::StateComponents<T>,
            Control = Self::ControlComponents<T>,
        >;
}

/// A system whose steps were generated with the retraction `R`. Implemented by the macro.
#[diagnostic::on_unimplemented(
    message = "there are no steps with the retraction `{R}` for `{Self}`",
    note = "steps are generated with the retractions that `retractions(…)` names in the description, without it with `Exponential` and `Cayley`, on some groups of matrices with one of the two"
)]
#[doc(hidden)]
pub trait Retracted<R>: System {
    /// The scheme of order 2 that the bare retraction stands for: the [standard](System::Standard) one, or
    /// [`StormerVerlet`] where that is not symmetric.
    type Scheme;
}

/// The steps that were generated for a system, to be chosen from while the program runs. Implemented by the macro.
#[doc(hidden)]
pub trait Schemes: System {
    /// Shows the visitor the type that stands for a generated step; none if it was not generated.
    #[doc(hidden)]
    fn visit<V: Visitor<Self>>(map: RetractionKind, rule: Rule, visitor: V) -> Option<V::Output>;
}

/// Makes something of a generated step of the system `S`.
#[doc(hidden)]
pub trait Visitor<S: System> {
    /// What comes of it.
    type Output;
    /// Makes it of the scheme `M`.
    fn visit<M: Base>(self) -> Self::Output
    where
        S: Generated<M>;
}

#[diagnostic::do_not_recommend]
impl<S, R> Discretized<StormerVerlet<R>> for S
where
    S: Discretized<SymplecticEulerA<R>> + Discretized<SymplecticEulerB<R>>,
{
    type Method<T: Batch> = AdjointPair<
        <S as Discretized<SymplecticEulerA<R>>>::Method<T>,
        <S as Discretized<SymplecticEulerB<R>>>::Method<T>,
    >;
}

/// Generated steps.
macro_rules! methods {
    (
        share { $($(#[$_share_doc:meta])* $share:ident { $($_share:tt)* })* }
        order { $($(#[$_order_doc:meta])* $order:ident { $($_order:tt)* })* }
    ) => {
        $(#[diagnostic::do_not_recommend]
        impl<S: Generated<scheme::$share<R, N, D>>, R, const N: u32, const D: u32> Discretized<scheme::$share<R, N, D>>
            for S
        {
            type Method<T: Batch> = OneStep<T, S::Kernel<T>>;
        })*
        $(#[diagnostic::do_not_recommend]
        impl<S: Generated<scheme::$order<R, P>>, R, const P: u32> Discretized<scheme::$order<R, P>> for S {
            type Method<T: Batch> = OneStep<T, S::Kernel<T>>;
        })*
    };
}
coadjoint_macros::methods!(methods);

/// The bare retractions.
macro_rules! retractions {
    ($($(#[$_doc:meta])* $name:ident { $($_row:tt)* })*) => {
        $(#[diagnostic::do_not_recommend]
        impl<S> Discretized<retraction::$name> for S
        where
            S: Retracted<retraction::$name> + Discretized<<S as Retracted<retraction::$name>>::Scheme>,
        {
            type Method<T: Batch> = <S as Discretized<<S as Retracted<retraction::$name>>::Scheme>>::Method<T>;
        })*
    };
}
coadjoint_macros::retractions!(retractions);

/// A value stored in a struct's field, as `N` scalars: scalars, vectors, matrices (by rows), unit quaternions (`w, x, y, z`), unit
/// complex numbers (`re, im`), isometries (the rotation's scalars, then the translation's).
#[doc(hidden)]
pub trait Stored<T, const N: usize>: Sized {
    /// Its scalars.
    fn to_array(&self) -> [T; N];
    /// The value of these scalars. What must be of unit length is taken as it is.
    fn from_array(array: [T; N]) -> Self;
    /// How far it is from what its type promises, as nalgebra's unchecked constructors and deserializers may leave it: the
    /// difference of a rotation's length from 1, otherwise `zero`.
    fn deviation(&self, zero: T) -> T {
        zero
    }
}

/// The larger number; one that is none, if there is one.
#[doc(hidden)]
#[inline]
pub fn larger<T: Real>(a: T, b: T) -> T {
    if b > a || b.partial_cmp(&b).is_none() { b } else { a }
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
        // a loop: `array::from_fn` is four functions more to compile for each size
        let mut array = [self[(0, 0)]; N];
        for (k, number) in array.iter_mut().enumerate() {
            *number = self[(k / C, k % C)];
        }
        array
    }
    #[inline(always)]
    fn from_array(array: [T; N]) -> Self {
        const { assert!(N == R * C, "an array of as many scalars as the matrix has") };
        let mut columns = [[array[0]; R]; C];
        for (k, number) in array.into_iter().enumerate() {
            columns[k % C][k / C] = number;
        }
        SMatrix::from_data(nalgebra::ArrayStorage(columns))
    }
}

impl<T: RealField + Copy> Stored<T, 4> for UnitQuaternion<T> {
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
        ComplexField::abs(self.as_ref().norm() - T::one())
    }
}

impl<T: RealField + Copy> Stored<T, 2> for UnitComplex<T> {
    #[inline(always)]
    fn to_array(&self) -> [T; 2] {
        [self.re, self.im]
    }
    #[inline(always)]
    fn from_array([re, im]: [T; 2]) -> Self {
        UnitComplex::new_unchecked(Complex::new(re, im))
    }
    #[inline]
    fn deviation(&self, _zero: T) -> T {
        ComplexField::abs(ComplexField::hypot(self.re, self.im) - T::one())
    }
}

macro_rules! isometries {
    ($($isometry:ident, $translation:ident, $n:literal: [$($turn:ident),*], [$($place:ident),*];)*) => {
        $(impl<T: RealField + Copy> Stored<T, $n> for $isometry<T> {
            #[inline(always)]
            fn to_array(&self) -> [T; $n] {
                let [$($turn),*] = self.rotation.to_array();
                let [$($place),*] = self.translation.vector.to_array();
                [$($turn,)* $($place),*]
            }
            #[inline(always)]
            fn from_array([$($turn,)* $($place),*]: [T; $n]) -> Self {
                Self::from_parts($translation::new($($place),*), Stored::from_array([$($turn),*]))
            }
            #[inline]
            fn deviation(&self, zero: T) -> T {
                self.rotation.deviation(zero)
            }
        })*
    };
}
isometries! {
    Isometry3, Translation3, 7: [w, i, j, k], [x, y, z];
    Isometry2, Translation2, 4: [re, im], [x, y];
}

#[cfg(all(test, feature = "std"))]
mod tests {
    use super::*;
    use crate::tests::{Oscillator, OscillatorControl, OscillatorState};
    use nalgebra::{Matrix2, Vector2, Vector3};

    /// There and back, both ways.
    fn round_trip<V, const N: usize>(value: V, scalars: [f64; N], deviation: f64)
    where
        V: Stored<f64, N> + PartialEq + fmt::Debug,
    {
        assert_eq!(value.to_array(), scalars);
        let back = V::from_array(scalars);
        assert_eq!((back.to_array(), &back), (scalars, &value));
        let is = value.deviation(0.0);
        assert!((is - deviation).abs() < 1e-15, "{is} instead of {deviation}");
    }

    #[test]
    fn stored_values_survive_the_array() {
        round_trip(2.5, [2.5], 0.0);
        round_trip(Vector2::new(1.0, 2.0), [1.0, 2.0], 0.0);
        round_trip(Matrix2::new(1.0, 2.0, 3.0, 4.0), [1.0, 2.0, 3.0, 4.0], 0.0);

        let turn = UnitComplex::new_unchecked(Complex::new(0.6, -0.8));
        let place = Translation2::new(5.0, 7.0);
        round_trip(turn, [0.6, -0.8], 0.0);
        round_trip(Isometry2::from_parts(place, turn), [0.6, -0.8, 5.0, 7.0], 0.0);
        let long = UnitComplex::new_unchecked(Complex::new(3.0, 4.0));
        round_trip(long, [3.0, 4.0], 4.0);
        round_trip(Isometry2::from_parts(place, long), [3.0, 4.0, 5.0, 7.0], 4.0);

        let turn = UnitQuaternion::new_unchecked(Quaternion::new(0.1, 0.7, -0.1, 0.7));
        let place = Translation3::new(5.0, 7.0, -2.0);
        round_trip(turn, [0.1, 0.7, -0.1, 0.7], 0.0);
        round_trip(Isometry3::from_parts(place, turn), [0.1, 0.7, -0.1, 0.7, 5.0, 7.0, -2.0], 0.0);
        let short = UnitQuaternion::new_unchecked(Quaternion::new(0.5, 0.0, 0.0, 0.0));
        round_trip(short, [0.5, 0.0, 0.0, 0.0], 0.5);
        round_trip(Isometry3::from_parts(place, short), [0.5, 0.0, 0.0, 0.0, 5.0, 7.0, -2.0], 0.5);
    }

    #[test]
    fn an_isometry_is_stored_as_what_it_does() {
        let isometry = Isometry3::new(Vector3::new(1.0, 2.0, 3.0), Vector3::new(0.3, -0.2, 0.9));
        let [w, i, j, k, x, y, z] = isometry.to_array();
        let rotation = UnitQuaternion::new_normalize(Quaternion::new(w, i, j, k));
        let point = nalgebra::Point3::new(0.2, 0.5, -0.4);
        let moved = rotation * point + Vector3::new(x, y, z);
        assert!((moved - isometry * point).norm() < 1e-15);
    }

    #[test]
    fn controls_default_to_zero() {
        assert_eq!(OscillatorControl::default().to_components(), [0.0]);
        assert_eq!(OscillatorControl::from_components(&[2.0]), OscillatorControl::new(2.0));
        assert_eq!(NoControl::<f32>::default().to_components(), [0.0_f32; 0]);
        assert_eq!(NoControl::<f32>::from_components(&[]), NoControl::default());
        assert_eq!(std::format!("{:?}", NoControl::<f64>::default()), "NoControl");
        assert_eq!(size_of::<NoControl<f64>>(), 0);
    }

    #[test]
    fn energy_without_a_time_is_that_of_time_0() {
        let system = Oscillator { mass: 1.5, stiffness: 4.0, drive: 0.7 };
        let state = OscillatorState::new(1.0, 3.0);
        assert_eq!(system.energy(&state), 5.0);
        assert_eq!(system.energy_at(&state, 2.0, &Default::default()), 5.0 - 0.7 * 2.0_f64.sin());
    }
}
