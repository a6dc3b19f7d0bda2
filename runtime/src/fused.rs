//! Products and sums rounded once, for speed.

use core::marker::PhantomData;

use crate::method::{Advanced, Clock, Failure, Method, Outcome, StepsReport};
use crate::scalar::simd::lanes::{Portable, Processor};
use crate::scalar::simd::loads::one_by_one;
use crate::scalar::{Batch, Components, LongWork, On, Scalar, Work, functions, mapped, operators};
use crate::system::{Discretized, System};

/// The scheme `M` with products and sums rounded once, for speed.
///
/// Processors multiply and add in one instruction, `a + b c`, and round once where two instructions round twice: half of a step's arithmetic
/// is of this kind. A program that is built for any processor cannot count on the instruction. `Fused<M>` takes the steps of the scheme
/// `M` with it all the same: whether the processor has it is found out when the program runs.
///
/// ```
/// use coadjoint::prelude::*;
///
/// #[lie_poisson_system(group = SO3)]
/// struct Body {
///     #[inertia]
///     inertia: Vector3<f64>,
/// }
///
/// let body = Body { inertia: vector![1.0, 2.0, 2.5] };
/// let mut state = BodyState { attitude: UnitQuaternion::identity(), momentum: vector![0.1, 2.0, 0.1] };
/// let momentum = body.spatial_momentum(&state);
/// let mut stepper = body.stepper::<Fused<Cayley>>(0.05)?;
/// stepper.steps_with(&mut state, &NoControl::default(), 10_000)?;
/// assert!((body.spatial_momentum(&state) - momentum).norm() < 1e-13);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// The steps are those of `M` but for roundings, and the same on every machine: where the instruction is missing, as in processors from before
/// 2013, the same result is found by a detour that takes many times as long. Steps taken [together](crate::Stepper::steps_with), as
/// a [`Run`](crate::Run) takes them, gain the most. The wrapper goes outside: `Fused<Order4<Cayley>>`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Fused<M>(PhantomData<M>);

impl<S: Discretized<M>, M> Discretized<Fused<M>> for S {
    type Method<T: Batch> = FusedMethod<S, M, T>;
}

/// A number, or several, of which [`mul_add`](Scalar::mul_add) and [`neg_mul_add`](Scalar::neg_mul_add) round once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FusedScalar<T>(T);

impl<T> From<T> for FusedScalar<T> {
    #[inline(always)]
    fn from(number: T) -> Self {
        Self(number)
    }
}

/// A method with such numbers.
pub struct FusedMethod<S: Discretized<M>, M, T: Batch>(S::Method<FusedScalar<T>>);

impl<S: Discretized<M>, M, T: Batch> Clone for FusedMethod<S, M, T> {
    fn clone(&self) -> Self {
        Self(self.0.clone())
    }
}

#[inline(always)]
fn wrapped<T: Batch, C: Components<T>, W: Components<FusedScalar<T>>>(components: &C) -> W {
    mapped(components.as_ref(), FusedScalar(T::of(0.0)), FusedScalar)
}

#[inline(always)]
fn unwrapped<T: Batch, W: Components<FusedScalar<T>>, C: Components<T>>(components: &W) -> C {
    mapped(components.as_ref(), T::of(0.0), |fused| fused.0)
}

#[inline(always)]
fn without<T: Batch, W, C>(advanced: Advanced<FusedScalar<T>, W>) -> Advanced<T, C>
where
    W: Components<FusedScalar<T>>,
    C: Components<T>,
{
    let Advanced { state, iterations, residual } = advanced;
    Advanced { state: unwrapped(&state), iterations, residual: residual.0 }
}

/// Does the work where the instructions are: wide registers are there already.
#[inline(always)]
fn inside<T: Batch, W: Work>(work: W) -> W::Result {
    if const { T::HAS_FMA } { work.done() } else { T::dispatch_fused(work) }
}

struct Step<'a, B: Method, C> {
    method: &'a mut B,
    from: Option<usize>,
    state: &'a C,
    time: B::Scalar,
    control: &'a B::Control,
    known: bool,
}

impl<T: Batch, B: Method<Scalar = FusedScalar<T>>, C: Components<T>> Work for Step<'_, B, C> {
    type CallSite = B::CallSite;
    type Result = Outcome<T, C>;

    #[inline(always)]
    fn done(self) -> Outcome<T, C> {
        let Self { method, from, state, time, control, known } = self;
        let state = &wrapped(&one_by_one::<T, _>(state));
        match method.advance_in_line(from, state, time, control, known) {
            Ok(advanced) => Ok(without(advanced)),
            Err(Failure { errors, advanced }) => Err(Failure { errors, advanced: without(advanced) }),
        }
    }
}

impl<S: Discretized<M>, M, T: Batch> Method for FusedMethod<S, M, T> {
    type CallSite = <S::Method<FusedScalar<T>> as Method>::CallSite;
    type Scalar = T;
    type Parameters = <S as System>::Parameters<T>;
    type State = S::StateComponents<T>;
    type Control = S::ControlComponents<T>;

    fn new(parameters: &Self::Parameters, step: T) -> Self {
        Self(Method::new(&wrapped(parameters), FusedScalar(step)))
    }

    const STAGES: usize = <S::Method<FusedScalar<T>> as Method>::STAGES;
    const HAS_FAST_PATH: bool = <S::Method<FusedScalar<T>> as Method>::HAS_FAST_PATH;
    type FastPath = <S::Method<FusedScalar<T>> as Method>::FastPath;

    #[inline(always)]
    fn ready_for(&self) -> u64 {
        self.0.ready_for()
    }

    #[inline(always)]
    fn enter(&self) -> Self::FastPath {
        self.0.enter()
    }

    #[inline(always)]
    fn advance_fast<P: Processor>(
        &mut self,
        path: &mut Self::FastPath,
        state: &Self::State,
        time: T,
        control: &Self::Control,
    ) -> (Self::State, Option<usize>) {
        let (time, control) = (FusedScalar(time), wrapped(control));
        let (state, halted) = self.0.advance_fast::<P>(path, &wrapped(state), time, &control);
        (unwrapped(&state), halted)
    }

    #[inline(always)]
    fn leave(&mut self, path: &mut Self::FastPath, steps: u64, stages: usize) -> (u64, u32) {
        self.0.leave(path, steps, stages)
    }

    #[inline(always)]
    fn on_fast_path(&self) -> (T::Each<u32>, T) {
        let (iterations, residual) = self.0.on_fast_path();
        (iterations, residual.0)
    }

    #[inline(always)]
    fn advance_from(
        &mut self,
        from: Option<usize>,
        state: &Self::State,
        time: T,
        control: &Self::Control,
        known: bool,
    ) -> Outcome<T, Self::State> {
        let (time, control) = (FusedScalar(time), &wrapped(control));
        inside::<T, _>(Step { method: &mut self.0, from, state, time, control, known })
    }

    #[inline(always)]
    fn advance_n<const WIDE: bool>(
        &mut self,
        state: &mut Self::State,
        clock: Clock,
        control: &Self::Control,
        known: bool,
        most: u64,
        failed: Option<&mut Option<Failure<T, Self::State>>>,
    ) -> StepsReport<T> {
        let (mut now, mut failure) = (wrapped(state), None);
        let inner = failed.is_some().then_some(&mut failure);
        let StepsReport { steps, iterations, max_iterations, max_residual } =
            self.0.advance_n::<WIDE>(&mut now, clock, &wrapped(control), known, most, inner);
        *state = unwrapped(&now);
        if let (Some(failed), Some(Failure { errors, advanced })) = (failed, failure) {
            *failed = Some(Failure { errors, advanced: without(advanced) });
        }
        StepsReport { steps, iterations, max_iterations, max_residual: max_residual.0 }
    }

    fn set_inputs(&mut self, inputs: Option<&mut dyn FnMut(f64) -> Self::Control>) {
        match inputs {
            Some(at) => self.0.set_inputs(Some(&mut |share| wrapped(&at(share)))),
            None => self.0.set_inputs(None),
        }
    }

    fn memory(&mut self, visit: &mut dyn FnMut(&mut [T])) {
        self.0.memory(&mut |numbers| {
            numbers.iter_mut().for_each(|number| visit(core::slice::from_mut(&mut number.0)));
        });
    }
}

operators! {
    FusedScalar<T: Batch>;
    -x = Self(-x.0);
    Add add(a, b) = Self(a.0 + b.0);
    Sub sub(a, b) = Self(a.0 - b.0);
    Mul mul(a, b) = Self(a.0 * b.0);
    Div div(a, b) = Self(a.0 / b.0);
}

impl<T: Batch> Scalar for FusedScalar<T> {
    #[inline(always)]
    fn of(value: f64) -> Self {
        Self(T::of(value))
    }
    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        Self(self.0.fma(a.0, b.0))
    }
    #[inline(always)]
    fn neg_mul_add(self, a: Self, b: Self) -> Self {
        // of the two, `a` is what comes later: nothing is kept negated
        Self(self.0.fma(-a.0, b.0))
    }
    functions! {
        Self, 0;
        sqrt() exp() ln() sin() cos() tan() asin() acos() atan() sinh() cosh() tanh()
        powf(exponent) atan2(x) min(other) if_negative(negative, otherwise) recip_or_zero()
    }
    #[inline(always)]
    fn stumpff<const N: usize>(self) -> [Self; N] {
        if let Some(family) = crate::scalar::stumpff::near(self) {
            return family;
        }
        self.0.stumpff::<N>().map(Self)
    }
    #[inline(always)]
    fn angle_over_sine<const N: u32>(self) -> Self {
        Self(self.0.angle_over_sine::<N>())
    }
}

impl<T: Batch> crate::scalar::sealed::Sealed for FusedScalar<T> {}

impl<T: Batch> Batch for FusedScalar<T> {
    type Number = T::Number;
    type Mask = T::Mask;
    type Each<X: Copy + Send + Sync> = T::Each<X>;

    const LANES: usize = T::LANES;
    const EPSILON: f64 = T::EPSILON;
    const MIN_POSITIVE: f64 = T::MIN_POSITIVE;
    const PAIRS: bool = T::PAIRS;
    const IS_FUSED: bool = true;

    #[inline(always)]
    fn each<X: Copy + Send + Sync>(value: impl FnMut(usize) -> X) -> T::Each<X> {
        T::each(value)
    }
    #[inline(always)]
    fn lane(&self, lane: usize) -> T::Number {
        self.0.lane(lane)
    }
    #[inline(always)]
    fn set_lane(&mut self, lane: usize, number: T::Number) {
        self.0.set_lane(lane, number);
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(Batch::abs(self.0))
    }
    #[inline(always)]
    fn is_finite(self) -> T::Mask {
        self.0.is_finite()
    }
    #[inline(always)]
    fn is_same(self, other: Self) -> T::Mask {
        self.0.is_same(other.0)
    }
    #[inline(always)]
    fn le(self, limit: Self) -> T::Mask {
        self.0.le(limit.0)
    }
    #[inline(always)]
    fn lt(self, limit: Self) -> T::Mask {
        self.0.lt(limit.0)
    }
    #[inline(always)]
    fn select(mask: T::Mask, yes: Self, no: Self) -> Self {
        Self(T::select(mask, yes.0, no.0))
    }
    #[inline(always)]
    fn fma(self, a: Self, b: Self) -> Self {
        Self(self.0.fma(a.0, b.0))
    }
    #[inline(always)]
    fn dispatch<W: Work>(work: W) -> W::Result {
        T::dispatch_fused(work)
    }
    #[inline(always)]
    fn dispatch_fused<W: Work>(work: W) -> W::Result {
        T::dispatch_fused(work)
    }
    #[inline(always)]
    fn dispatch_wide<W: LongWork>(work: W) -> W::Result {
        if const { T::LANES == 1 } {
            T::dispatch_wide(work)
        } else {
            Self::dispatch(On::<Portable, W>::new(work))
        }
    }
}
