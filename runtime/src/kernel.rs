//! The interface between generated straight-line code and the runtime that drives it.
//!
//! One step of any scheme solves `left(x) = right(x)` for the unknown `x` (the family's `η = t ζ`, with `t` the step
//! and `ζ` the velocity, or half of it where the retraction is a function of the half) and then updates the state. Every intermediate value is computed at the earliest of three
//! stages: when the stepper is built, once a step, once a Newton iteration.
//!
//! A step that is explicit has nothing to solve for: its unknown is `[T; 0]`.

use crate::bytecode::{self, Function, Given};
use crate::scalar::bounded::Bounded;
use crate::scalar::{Batch, Components, Mask, OutOfLine, Scalar, Work};

/// The step's equation `left(x) = right(x)`, evaluated at one `x`.
#[derive(Clone, Copy, Debug)]
pub struct Evaluation<U, I> {
    /// `left(x) − right(x)`.
    pub residual: U,
    /// `right(x)`
    pub right: U,
    /// Values that the Newton correction and the update need again.
    pub iterate: I,
}

/// The functions [`new`](Kernel::new), [`begin`](Kernel::begin), [`evaluate`](Kernel::evaluate) and [`finish`](Kernel::finish) as bytes that the
/// generator has written.
pub type Program = [&'static [u8]; 4];

/// The lengths of a kernel's blocks of unknowns.
pub type Blocks = &'static [usize];

/// `Copy` for a struct of numbers. `derive` would clone each field of a generic struct by itself: a twentieth of all that there is to compile.
#[doc(hidden)]
#[macro_export]
macro_rules! __copied {
    ($name:ident) => {
        #[automatically_derived]
        impl<T: ::core::marker::Copy> ::core::clone::Clone for $name<T> {
            #[inline]
            fn clone(&self) -> Self {
                *self
            }
        }

        #[automatically_derived]
        impl<T: ::core::marker::Copy> ::core::marker::Copy for $name<T> {}
    };
}

/// One step's arithmetic for one system and one scheme; `self` holds what depends on parameters and step alone.
pub trait Kernel<T: Scalar>: Copy + Send + Sync + 'static {
    /// The system's parameters.
    type Parameters: Components<T>;
    /// The state.
    type State: Components<T>;
    /// The controls, held from the start of the step to its end; `[T; 0]` if there are none.
    type Control: Components<T>;
    /// The unknown of the step's equation; `[T; 0]` if the step is explicit.
    type Unknown: Components<T>;
    /// What depends on state, time and control, but not on the unknown.
    type Step: Components<T>;
    /// What depends on the unknown and is needed again.
    type Iterate: Copy;
    /// A place for each value of the step's [program](Self::PROGRAM), and one that is nobody's.
    type Places<X: Scalar>: Components<X>;

    /// The lengths of the blocks of unknowns, each of one unit: what is solved for in one is solved to the digits of that.
    const BLOCKS: Blocks;
    /// [`BLOCKS`](Self::BLOCKS). Of a kernel that is made at run time they are known then, as is all that follows.
    #[inline(always)]
    fn blocks(&self) -> &[usize] {
        Self::BLOCKS
    }
    /// The step's functions once more, as data.
    const PROGRAM: Program = [&[]; 4];

    /// What depends on parameters and step alone.
    #[inline(always)]
    fn constants(&self) -> &[T] {
        &[]
    }
    /// Stage *parameters*: once, when the stepper is built.
    fn new(parameters: &Self::Parameters, step: T) -> Self;
    /// Stage *step*: once a step. `time` is the time at the start of the step.
    fn begin(&self, state: &Self::State, time: T, control: &Self::Control) -> Self::Step;
    /// A first approximation of the unknown, from no earlier solution.
    fn start(&self, state: &Self::State, step: &Self::Step) -> Self::Unknown;
    /// Stage *iteration*: the equation at one value of the unknown.
    fn evaluate(
        &self,
        state: &Self::State,
        step: &Self::Step,
        unknown: &Self::Unknown,
    ) -> Evaluation<Self::Unknown, Self::Iterate>;
    /// The Newton correction: the solution `d` of `(∂residual/∂x) d = residual`.
    fn correction(
        &self,
        state: &Self::State,
        step: &Self::Step,
        unknown: &Self::Unknown,
        evaluation: &Evaluation<Self::Unknown, Self::Iterate>,
    ) -> Self::Unknown;
    /// Whether the Newton [correction](Self::correction) is of the residual's Jacobian, not of one of fewer terms.
    const HAS_TRUE_JACOBIAN: bool = true;
    /// [`HAS_TRUE_JACOBIAN`](Self::HAS_TRUE_JACOBIAN)
    #[inline(always)]
    fn has_true_jacobian(&self) -> bool {
        Self::HAS_TRUE_JACOBIAN
    }
    /// Whether the update is a Newton step, or a simplified one with nearly the true Jacobian, and the state after the step is made of the unknown itself,
    /// not of an evaluation near it, but for terms that the Jacobian leaves out.
    const IS_NEWTON: bool = false;
    /// [`IS_NEWTON`](Self::IS_NEWTON)
    #[inline(always)]
    fn is_newton(&self) -> bool {
        Self::IS_NEWTON
    }
    /// Whether Newton's matrix is that of the beginning of a step: what such steps contract to strongly is one solution alone.
    const IS_CHORD: bool = false;
    /// [`IS_CHORD`](Self::IS_CHORD)
    #[inline(always)]
    fn is_chord(&self) -> bool {
        Self::IS_CHORD
    }
    /// Whether iterations may contract to any solution, for their matrix is taken where they have come to.
    #[inline(always)]
    fn finds_any(&self) -> bool {
        self.is_newton() && !self.is_chord()
    }
    /// Whether a step is long: a call for it does not count, to compile it once more takes long, and what rounding leaves in the solution of its equation
    /// is some units.
    const IS_LONG: bool = false;
    /// [`IS_LONG`](Self::IS_LONG)
    #[inline(always)]
    fn is_long(&self) -> bool {
        Self::IS_LONG
    }
    /// The next iterate of the fixed-point iteration: with `left(x) = L x` it is `L⁻¹ right(x)`, or, where `right` is `n/(1 + d)`, `L⁻¹ n − d x`,
    /// which has the same fixed point and waits for no division. Where `left` is not linear with constant coefficients it is Newton's, `x` less the
    /// [correction](Self::correction).
    #[inline(always)]
    fn fixed_point_update(
        &self,
        state: &Self::State,
        step: &Self::Step,
        unknown: &Self::Unknown,
        evaluation: &Evaluation<Self::Unknown, Self::Iterate>,
    ) -> Self::Unknown {
        let mut next = *unknown;
        let correction = self.correction(state, step, unknown, evaluation);
        let mut i = 0;
        while i < Self::Unknown::LENGTH {
            next.as_mut()[i] = next.as_mut()[i] - correction.as_ref()[i];
            i += 1;
        }
        next
    }
    /// Positive inside the retraction's domain, zero on its edge. None if there is no edge.
    #[inline(always)]
    fn domain(
        &self,
        _state: &Self::State,
        _step: &Self::Step,
        _unknown: &Self::Unknown,
        _evaluation: &Evaluation<Self::Unknown, Self::Iterate>,
    ) -> Option<T> {
        None
    }
    /// The state after the step, from the solution of the equation.
    fn finish(
        &self,
        state: &Self::State,
        step: &Self::Step,
        unknown: &Self::Unknown,
        evaluation: &Evaluation<Self::Unknown, Self::Iterate>,
    ) -> Self::State;
    /// Whether a component of the state after the step is finite if the state before it and the unknown are.
    #[inline(always)]
    fn is_bounded(_component: usize) -> bool {
        false
    }
    /// What rounding leaves of the residual, in units of the last place, where that is not to be found from the [program](Self::PROGRAM) that is
    /// known when the code is compiled.
    #[inline(always)]
    fn rounding(&self, _unknown: &Self::Unknown, _lane: usize) -> Option<Self::Unknown> {
        None
    }
}

/// A kernel: [`Kernel::new`], compiled once, and for the processor that the kernel is for.
pub(crate) fn new<T: Batch, K: Kernel<T>>(parameters: &K::Parameters, step: T) -> K {
    T::dispatch(New { parameters, step })
}

struct New<'a, T: Batch, K: Kernel<T>> {
    parameters: &'a K::Parameters,
    step: T,
}

impl<T: Batch, K: Kernel<T>> Work for New<'_, T, K> {
    type CallSite = K;
    type Result = K;

    #[inline(always)]
    fn done(self) -> K {
        K::new(self.parameters, self.step)
    }
}

/// A kernel's equation at a state, to be solved for its unknown.
pub(crate) struct AtState<'a, T: Scalar, K: Kernel<T>> {
    pub(crate) kernel: &'a K,
    pub(crate) state: &'a K::State,
    pub(crate) step: &'a K::Step,
}

impl<T: Scalar, K: Kernel<T>> AtState<'_, T, K> {
    /// See [`Kernel::start`].
    #[inline(always)]
    pub(crate) fn start(&self) -> K::Unknown {
        self.kernel.start(self.state, self.step)
    }

    /// See [`Kernel::evaluate`].
    #[inline(always)]
    pub(crate) fn evaluate(&self, unknown: &K::Unknown) -> Evaluation<K::Unknown, K::Iterate> {
        self.kernel.evaluate(self.state, self.step, unknown)
    }

    /// The same, out of line: where it comes rarely, and in lanes, where it is long.
    #[inline(always)]
    pub(crate) fn evaluate_apart(&self, unknown: &K::Unknown) -> Evaluation<K::Unknown, K::Iterate>
    where
        T: Batch,
    {
        T::dispatch(Evaluate { equation: self, unknown })
    }

    /// See [`Kernel::correction`].
    #[inline(always)]
    pub(crate) fn correction(
        &self,
        unknown: &K::Unknown,
        evaluation: &Evaluation<K::Unknown, K::Iterate>,
    ) -> K::Unknown {
        self.kernel.correction(self.state, self.step, unknown, evaluation)
    }

    /// The same, out of line.
    #[inline(always)]
    pub(crate) fn correction_apart(
        &self,
        unknown: &K::Unknown,
        evaluation: &Evaluation<K::Unknown, K::Iterate>,
    ) -> K::Unknown
    where
        T: Batch,
    {
        T::dispatch(Correct { equation: self, unknown, evaluation })
    }
}

/// An equation through a table: for code that is compiled once for all kernels with as many unknowns.
///
/// `extern "C"`, for such functions do not unwind: steps are without panics, which a call through a table would hide.
pub(crate) trait Equation<T, U> {
    /// The equation at a value of the unknown, and the Newton correction there as what is needed again: for the residual there, or for the one
    /// that is given.
    extern "C" fn corrected(&self, unknown: &U, residual: Option<&U>) -> Evaluation<U, U>;
    /// A bound of what rounding leaves of each component of the residual, in one lane, of the unknown's own rounding too.
    extern "C" fn roundoff(&self, unknown: &U, lane: usize) -> U;
}

// called from here alone
#[allow(improper_ctypes_definitions)]
impl<T: Batch, K: Kernel<T>> Equation<T, K::Unknown> for AtState<'_, T, K> {
    extern "C" fn corrected(
        &self,
        unknown: &K::Unknown,
        residual: Option<&K::Unknown>,
    ) -> Evaluation<K::Unknown, K::Unknown> {
        let mut evaluation = self.evaluate_apart(unknown);
        evaluation.residual = *residual.unwrap_or(&evaluation.residual);
        let iterate = self.correction_apart(unknown, &evaluation);
        Evaluation { residual: evaluation.residual, right: evaluation.right, iterate }
    }

    extern "C" fn roundoff(&self, unknown: &K::Unknown, lane: usize) -> K::Unknown {
        K::portable(Roundoff { equation: self, unknown, lane })
    }
}

/// [`AtState::evaluate_apart`].
struct Evaluate<'a, T: Batch, K: Kernel<T>> {
    equation: &'a AtState<'a, T, K>,
    unknown: &'a K::Unknown,
}

impl<T: Batch, K: Kernel<T>> Work for Evaluate<'_, T, K> {
    type CallSite = K;
    type Result = Evaluation<K::Unknown, K::Iterate>;

    #[inline(always)]
    fn done(self) -> Self::Result {
        self.equation.evaluate(self.unknown)
    }
}

/// [`AtState::correction_apart`].
struct Correct<'a, T: Batch, K: Kernel<T>> {
    equation: &'a AtState<'a, T, K>,
    unknown: &'a K::Unknown,
    evaluation: &'a Evaluation<K::Unknown, K::Iterate>,
}

impl<T: Batch, K: Kernel<T>> Work for Correct<'_, T, K> {
    type CallSite = K;
    type Result = K::Unknown;

    #[inline(always)]
    fn done(self) -> Self::Result {
        self.equation.correction(self.unknown, self.evaluation)
    }
}

/// [`Equation::roundoff`]: the residual once more, from its bytes, over numbers that carry their errors.
///
/// What depends on the state alone counts as exact: it is the same for every value of the unknown, and moves the solution, not the residual.
struct Roundoff<'a, T: Batch, K: Kernel<T>> {
    equation: &'a AtState<'a, T, K>,
    unknown: &'a K::Unknown,
    lane: usize,
}

impl<T: Batch, K: Kernel<T>> Work for Roundoff<'_, T, K> {
    type CallSite = K;
    type Result = K::Unknown;

    #[inline(always)]
    fn done(self) -> K::Unknown {
        let Self { equation: &AtState { kernel, state, step }, unknown, lane } = self;
        if let Some(bound) = kernel.rounding(unknown, lane) {
            return bound;
        }
        let exactly = |numbers: &[T], i: usize| Some(Bounded::exactly(numbers.get(i)?.lane(lane)));
        let given = |given, i: usize| match given {
            Given::Constants => exactly(kernel.constants(), i),
            Given::Step => exactly(step.as_ref(), i),
            Given::State => exactly(state.as_ref(), i),
            Given::Unknown => Some(Bounded::nearest(unknown.as_ref().get(i)?.lane(lane))),
            _ => None,
        };
        let mut places = K::Places::splat(Bounded::of(0.0));
        let mut bound = K::Unknown::splat(T::of(0.0));
        let code = K::PROGRAM[Function::Evaluate as usize];
        bytecode::run(code, places.as_mut(), &given, &mut |array, i, residual: Bounded<T::Number>| {
            if let (0, Some(bound)) = (array, bound.as_mut().get_mut(i)) {
                bound.set_lane(lane, residual.error);
                *bound = T::of(T::EPSILON) * *bound;
            }
        });
        bound
    }
}

/// Whether a solution is inside the retraction's domain.
#[inline(always)]
pub(crate) fn is_inside<T: Batch, K: Kernel<T>>(
    kernel: &K,
    state: &K::State,
    step: &K::Step,
    unknown: &K::Unknown,
    evaluation: &Evaluation<K::Unknown, K::Iterate>,
) -> T::Mask {
    match kernel.domain(state, step, unknown, evaluation) {
        Some(margin) => T::of(0.0).lt(margin),
        None => T::Mask::splat(true),
    }
}
/// Whether all numbers of a lane are finite after a step, of which state and solution were; not so if their sum is too large.
#[inline(always)]
pub(crate) fn is_surely_finite<T: Batch, K: Kernel<T>>(state: &K::State, control: &K::Control) -> T::Mask {
    // four sums, for each has to wait for itself; the compiler knows that −0 is nothing to add
    let mut sums = [T::of(-0.0); 4];
    let mut terms = 0;
    let mut k = 0;
    while k < K::State::LENGTH {
        if !K::is_bounded(k) {
            sums[terms % 4] = sums[terms % 4] + state.as_ref()[k];
            terms += 1;
        }
        k += 1;
    }
    k = 0;
    while k < K::Control::LENGTH {
        sums[terms % 4] = sums[terms % 4] + control.as_ref()[k];
        (terms, k) = (terms + 1, k + 1);
    }
    (T::of(0.0) * ((sums[0] + sums[1]) + (sums[2] + sums[3]))).le(T::of(0.0))
}

/// Whether all numbers of a lane are finite.
#[inline(always)]
pub(crate) fn finite<T: Batch, C: Components<T>>(components: &C) -> T::Mask {
    // four sums, for each has to wait for itself; the compiler knows that −0 is nothing to add
    let mut sums = [T::of(-0.0); 4];
    let mut k = 0;
    while k < C::LENGTH {
        sums[k % 4] = sums[k % 4] + components.as_ref()[k];
        k += 1;
    }
    let mut are_finite = ((sums[0] + sums[1]) + (sums[2] + sums[3])).is_finite();
    if !are_finite.all() {
        // the sum may be too large
        are_finite = T::Mask::splat(true);
        k = 0;
        while k < C::LENGTH {
            are_finite = are_finite & components.as_ref()[k].is_finite();
            k += 1;
        }
    }
    are_finite
}
