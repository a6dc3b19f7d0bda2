//! Symmetric compositions: steps of a higher order from steps of order 2.
//!
//! A step of the symmetric base method of order 2 is replaced by steps of `γ₁h, γ₂h, …, γ_s h` with `γᵢ = γ_{s+1−i}` and
//! `Σ γᵢ = 1`, each starting at the time at which the one before it ends. Where the base method is a Poisson map and keeps the Casimirs, so does the composition; it is symmetric again.
//! The order is even, and rises by two for each further set of conditions on the `γᵢ`.
//!
//! The base must be symmetric and of order 2: a bare retraction, [`Midpoint`](crate::scheme::Midpoint) or
//! [`StormerVerlet`](crate::scheme::StormerVerlet). [`SymplecticEulerA`](crate::scheme::SymplecticEulerA) and the other members of
//! the [family](crate::scheme::Family) are that for left-invariant systems only; composed where they are of order 1, they stay so.
//!
//! ```
//! use coadjoint::prelude::*;
//!
//! #[lie_poisson_system(group = SO3)]
//! struct Body {
//!     #[inertia]
//!     inertia: Vector3<f64>,
//! }
//!
//! let body = Body { inertia: vector![1.0, 2.0, 2.5] };
//! let mut state = BodyState { attitude: UnitQuaternion::identity(), momentum: vector![0.1, 2.0, 0.1] };
//! let energy = body.energy(&state);
//! let mut stepper = body.stepper::<Order6<Exponential>>(0.05)?;
//! for _ in 0..1_000 {
//!     stepper.step(&mut state)?;
//! }
//! assert!((body.energy(&state) - energy).abs() < 1e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Coefficients as collected in Hairer, Lubich, Wanner, *Geometric Numerical Integration*, 2nd ed., section V.3.2. Tests check
//! their sums and the order that is measured.

#![allow(clippy::excessive_precision, reason = "coefficients as published")]

use core::marker::PhantomData;

use crate::method::{Method, Outcome, StageAccumulator, sum};
use crate::scalar::simd::lanes::Processor;
use crate::scalar::{Batch, Scalar};
use crate::snapshot::visit_flag;
use crate::system::Discretized;

/// The coefficients of a symmetric composition.
pub trait Coefficients {
    /// One `X` for each of its steps.
    type Steps<X: Clone + Send + Sync>: Clone + AsRef<[X]> + AsMut<[X]> + Send + Sync;
    /// The order of the composition of symmetric steps of order 2.
    const ORDER: u32;
    /// The `γᵢ`, of which those after the middle repeat those before it, and the sum is 1 up to roundoff; others do not compile where a step
    /// is composed of them.
    ///
    /// ```compile_fail
    /// use coadjoint::composition::{Coefficients, Composed};
    /// use coadjoint::prelude::*;
    ///
    /// #[lie_poisson_system(group = SO3)]
    /// struct Body {
    ///     #[inertia]
    ///     inertia: Vector3<f64>,
    /// }
    ///
    /// struct TooShort;
    /// impl Coefficients for TooShort {
    ///     type Steps<X: Clone + Send + Sync> = [X; 2];
    ///     const ORDER: u32 = 2;
    ///     const GAMMA: &'static [f64] = &[0.3, 0.3]; // [0.5, 0.5] compiles
    ///     fn steps<X: Clone + Send + Sync>(make: impl FnMut(usize) -> X) -> [X; 2] {
    ///         std::array::from_fn(make)
    ///     }
    /// }
    /// let body = Body { inertia: vector![1.0, 2.0, 2.5] };
    /// let stepper = body.stepper::<Composed<TooShort, Cayley>>(0.1);
    /// ```
    const GAMMA: &'static [f64];
    /// One `X` for each step, made one after the other, of its number.
    fn steps<X: Clone + Send + Sync>(make: impl FnMut(usize) -> X) -> Self::Steps<X>;
}

/// The symmetric composition with coefficients `C` of steps with the symmetric scheme `M` of order 2.
#[derive(Clone, Copy, Debug, Default)]
pub struct Composed<C, M>(PhantomData<(C, M)>);

/// Order 4, five steps: `γ = 1/(4 − 4^{1/3})` and `1 − 4γ` in the middle. M. Suzuki, Phys. Lett. A 146 (1990).
pub type Order4<M> = Composed<Suzuki4, M>;
/// Order 6, nine steps. W. Kahan, R.-C. Li, Math. Comp. 66 (1997), s9odr6a.
pub type Order6<M> = Composed<KahanLi6, M>;
/// Order 8, seventeen steps. W. Kahan, R.-C. Li, Math. Comp. 66 (1997), s17odr8a.
pub type Order8<M> = Composed<KahanLi8, M>;
/// Order 10, thirty-five steps. M. Sofroniou, G. Spaletta, J. Optim. Methods Softw. 20 (2005).
pub type Order10<M> = Composed<SofroniouSpaletta10, M>;

/// `γ₁, …` up to the middle one, made symmetric.
const fn symmetric<const N: usize>(half: &[f64]) -> [f64; N] {
    let mut gamma = [0.0; N];
    let mut i = 0;
    while i < half.len() {
        gamma[i] = half[i];
        gamma[N - 1 - i] = half[i];
        i += 1;
    }
    gamma
}

macro_rules! coefficients {
    ($(#[$doc:meta])* $name:ident, order $order:literal, $n:literal steps, $half:expr) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        pub struct $name;

        impl Coefficients for $name {
            type Steps<X: Clone + Send + Sync> = [X; $n];
            const ORDER: u32 = $order;
            const GAMMA: &'static [f64] = &symmetric::<$n>(&$half);

            fn steps<X: Clone + Send + Sync>(make: impl FnMut(usize) -> X) -> [X; $n] {
                core::array::from_fn(make)
            }
        }
    };
}

coefficients! {
    /// Coefficients of [`Order4`].
    Suzuki4, order 4, 5 steps,
    [0.414490771794375737142354062860, 0.414490771794375737142354062860, -0.657963087177502948569416251440]
}
coefficients! {
    /// Coefficients of [`Order6`].
    KahanLi6, order 6, 9 steps,
    [
        0.39216144400731413927925056,
        0.33259913678935943859974864,
        -0.70624617255763935980996482,
        0.08221359629355080023149045,
        0.79854399093482996339895035,
    ]
}
coefficients! {
    /// Coefficients of [`Order8`].
    KahanLi8, order 8, 17 steps,
    [
        0.13020248308889008087881763,
        0.56116298177510838456196441,
        -0.38947496264484728640807860,
        0.15884190655515560089621075,
        -0.39590389413323757733623154,
        0.18453964097831570709183254,
        0.25837438768632204729397911,
        0.29501172360931029887096624,
        -0.60550853383003451169892108,
    ]
}
coefficients! {
    /// Coefficients of [`Order10`].
    SofroniouSpaletta10, order 10, 35 steps,
    [
        0.07879572252168641926390768,
        0.31309610341510852776481247,
        0.02791838323507806610952027,
        -0.22959284159390709415121340,
        0.13096206107716486317465686,
        -0.26973340565451071434460973,
        0.07497334315589143566613711,
        0.11199342399981020488957508,
        0.36613344954622675119314812,
        -0.39910563013603589787862981,
        0.10308739852747107731580277,
        0.41143087395589023782070412,
        -0.00486636058313526176219566,
        -0.39203335370863990644808194,
        0.05194250296244964703718290,
        0.05066509075992449633587434,
        0.04967437063972987905456880,
        0.04931773575959453791768001,
    ]
}

/// Coefficients that are those of a symmetric composition.
pub(crate) const fn checked(gamma: &'static [f64]) -> &'static [f64] {
    assert!(!gamma.is_empty(), "a composition has steps");
    let (mut sum, mut size) = (0.0, 0.0);
    let mut i = 0;
    while i < gamma.len() {
        assert!(gamma[i] == gamma[gamma.len() - 1 - i], "a composition is symmetric");
        sum += gamma[i];
        size += gamma[i].abs();
        i += 1;
    }
    // of each sum half a unit of roundoff, and as much of each coefficient
    let off = (sum - 1.0).abs();
    assert!(
        off <= gamma.len() as f64 * size * f64::EPSILON,
        "the steps of a composition are one step together"
    );
    gamma
}

/// The composed method: a base method for each step, each with a memory of its own.
#[derive(Debug)]
#[doc(hidden)]
pub struct Composition<C: Coefficients, B: Method> {
    pub(crate) steps: C::Steps<B>,
    /// The composed step.
    pub(crate) step: B::Scalar,
    /// Whether all steps remember solutions of one and the same composed step.
    whole: bool,
    /// The control over each step, where it is driven.
    inputs: Option<C::Steps<B::Control>>,
}

impl<C: Coefficients, B: Method> Clone for Composition<C, B> {
    #[inline]
    fn clone(&self) -> Self {
        let Self { steps, step, whole, inputs } = self;
        Self { steps: steps.clone(), step: *step, whole: *whole, inputs: inputs.clone() }
    }
}

impl<C: Coefficients, B: Method> Method for Composition<C, B> {
    type CallSite = B::CallSite;
    type Scalar = B::Scalar;
    type Parameters = B::Parameters;
    type State = B::State;
    type Control = B::Control;

    #[inline]
    fn new(parameters: &B::Parameters, step: B::Scalar) -> Self {
        let gamma = const { checked(C::GAMMA) };
        // of as many steps as there are coefficients
        let part = |k: usize| gamma.get(k).copied().unwrap_or(0.0);
        let steps = C::steps(|k| B::new(parameters, step * B::Scalar::of(part(k))));
        Self { steps, step, whole: false, inputs: None }
    }

    const STAGES: usize = C::GAMMA.len() * B::STAGES;
    const HAS_FAST_PATH: bool = B::HAS_FAST_PATH;
    /// Those of all steps: there are some wherever steps are [ready](Method::ready_for).
    type FastPath = Option<C::Steps<B::FastPath>>;

    #[inline(always)]
    fn ready_for(&self) -> u64 {
        // where it is driven, each step has a control of its own
        if !self.whole || self.inputs.is_some() {
            return 0;
        }
        self.steps.as_ref().iter().fold(u64::MAX, |all, step| all.min(step.ready_for()))
    }

    #[inline(always)]
    fn enter(&self) -> Self::FastPath {
        let steps = self.steps.as_ref();
        Some(C::steps(|k| steps.get(k).map(B::enter).unwrap_or_default()))
    }

    #[inline(always)]
    fn advance_fast<P: Processor>(
        &mut self,
        path: &mut Self::FastPath,
        state: &B::State,
        time: B::Scalar,
        control: &B::Control,
    ) -> (B::State, Option<usize>) {
        let Some(paths) = path else { return (*state, Some(0)) };
        let (mut state, mut done, mut stages, whole) = (*state, 0.0, 0, self.step);
        let steps = self.steps.as_mut().iter_mut().zip(paths.as_mut());
        for ((step, path), gamma) in steps.zip(C::GAMMA) {
            let start = time + B::Scalar::of(done) * whole;
            let (next, halted) = step.advance_fast::<P>(path, &state, start, control);
            if let Some(stage) = halted {
                return (next, Some(stages + stage));
            }
            state = next;
            done += gamma;
            stages += B::STAGES;
        }
        (state, None)
    }

    #[inline(always)]
    fn leave(&mut self, path: &mut Self::FastPath, steps: u64, stages: usize) -> (u64, u32) {
        let (mut left, mut more) = (stages, (0, 0));
        let Some(paths) = path else { return more };
        for (step, path) in self.steps.as_mut().iter_mut().zip(paths.as_mut()) {
            let is_through = left >= B::STAGES;
            let (all, most) =
                step.leave(path, steps + u64::from(is_through), if is_through { 0 } else { left });
            more = (more.0.wrapping_add(all), more.1.wrapping_add(most));
            left = left.saturating_sub(B::STAGES);
        }
        more
    }

    #[inline(always)]
    fn on_fast_path(&self) -> (<B::Scalar as Batch>::Each<u32>, B::Scalar) {
        let mut all = (B::Scalar::all(0), B::Scalar::of(0.0));
        for step in self.steps.as_ref() {
            let (iterations, residual) = step.on_fast_path();
            all.0 = sum::<B::Scalar>(all.0, iterations);
            all.1 = B::Scalar::select(all.1.lt(residual), residual, all.1);
        }
        all
    }

    #[inline(always)]
    fn advance_from(
        &mut self,
        from: Option<usize>,
        state: &B::State,
        time: B::Scalar,
        control: &B::Control,
        known: bool,
    ) -> Outcome<B::Scalar, B::State> {
        let known = known && self.whole;
        // until all are through
        self.whole = false;
        let mut state = *state;
        // how much of the composed step is done
        let (mut done, mut stages) = (0.0, 0);
        let mut accumulator = StageAccumulator::new();
        for (k, (step, gamma)) in self.steps.as_mut().iter_mut().zip(C::GAMMA).enumerate() {
            let start = time + B::Scalar::of(done) * self.step;
            let input = self.inputs.as_ref().and_then(|inputs| inputs.as_ref().get(k));
            let control = input.unwrap_or(control);
            let is_done = from.is_some_and(|from| from >= stages + B::STAGES);
            if !is_done {
                let within = from.and_then(|from| from.checked_sub(stages));
                state = accumulator.stage(step, within, &state, start, control, known)?;
            }
            done += gamma;
            stages += B::STAGES;
        }
        self.whole = true;
        accumulator.end(state)
    }

    fn set_inputs(&mut self, mut inputs: Option<&mut dyn FnMut(f64) -> B::Control>) {
        let mut done = 0.0;
        for (step, gamma) in self.steps.as_mut().iter_mut().zip(C::GAMMA) {
            match &mut inputs {
                Some(at) => step.set_inputs(Some(&mut |share| at(done + gamma * share))),
                None => step.set_inputs(None),
            }
            done += gamma;
        }
        let mut done = 0.0;
        self.inputs = inputs.map(|at| {
            C::steps(|k| {
                let gamma = C::GAMMA.get(k).copied().unwrap_or(0.0);
                done += gamma;
                at(done - 0.5 * gamma)
            })
        });
    }

    #[inline]
    fn memory(&mut self, visit: &mut dyn FnMut(&mut [B::Scalar])) {
        visit_flag(&mut self.whole, visit);
        self.steps.as_mut().iter_mut().for_each(|step| step.memory(visit));
    }
}

#[diagnostic::do_not_recommend]
impl<S, C, M> Discretized<Composed<C, M>> for S
where
    S: Discretized<M>,
    C: Coefficients,
{
    type Method<T: Batch> = Composition<C, <S as Discretized<M>>::Method<T>>;
}

#[cfg(all(test, feature = "std"))]
mod tests {
    use super::*;
    use crate::method::{AdjointPair, Advanced};
    use crate::retraction::Exponential;
    use crate::scheme::{StormerVerlet, SymplecticEulerA, SymplecticEulerB};
    use crate::stepper::Stepper;
    use crate::system::System;
    use crate::tests::{Oscillator, OscillatorState};

    /// `q' = t` by the midpoint rule, without error: what stages of wrong times give is not `½ t²`.
    #[derive(Clone)]
    struct Clock(f64);

    impl Method for Clock {
        type CallSite = ();
        type Scalar = f64;
        type Parameters = [f64; 0];
        type State = [f64; 1];
        type Control = [f64; 0];

        fn new(_: &[f64; 0], step: f64) -> Self {
            Self(step)
        }

        type FastPath = ();

        fn advance_from(
            &mut self,
            _: Option<usize>,
            &[q]: &[f64; 1],
            time: f64,
            _: &[f64; 0],
            _: bool,
        ) -> Outcome<f64, [f64; 1]> {
            let step = self.0;
            Ok(Advanced { state: [q + step * (time + 0.5 * step)], iterations: [0], residual: 0.0 })
        }

        fn memory(&mut self, _: &mut dyn FnMut(&mut [f64])) {}
    }

    fn integrates_the_time<M>()
    where
        M: Method<Scalar = f64, Parameters = [f64; 0], State = [f64; 1], Control = [f64; 0]>,
    {
        let (start, step) = (3.0, 0.75);
        let outcome = M::new(&[], step).advance(&[0.0], start, &[], false);
        let [q] = outcome.map_err(|failure| failure.first()).expect("explicit").state;
        let end: f64 = start + step;
        let exact = 0.5 * (end * end - start * start);
        assert!((q - exact).abs() < 1e-14 * exact, "{q} instead of {exact}");
    }

    #[test]
    fn stages_start_when_the_ones_before_them_end() {
        integrates_the_time::<Clock>();
        integrates_the_time::<AdjointPair<Clock, Clock>>();
        integrates_the_time::<Composition<Suzuki4, Clock>>();
        integrates_the_time::<Composition<KahanLi6, AdjointPair<Clock, Clock>>>();
        integrates_the_time::<Composition<KahanLi8, Clock>>();
        integrates_the_time::<Composition<SofroniouSpaletta10, Composition<Suzuki4, Clock>>>();
    }

    const DRIVEN: Oscillator = Oscillator { mass: 1.5, stiffness: 4.0, drive: 0.7 };

    /// The distance from the exact motion at time 6 after so many steps.
    fn error<M>(steps: u32) -> f64
    where
        Oscillator: Discretized<M>,
    {
        let mut state = OscillatorState::REST;
        let mut stepper: Stepper<_, M> = DRIVEN.stepper(6.0 / f64::from(steps)).expect("valid");
        for _ in 0..steps {
            stepper.step(&mut state).expect("explicit");
        }
        state.distance(&DRIVEN.exact(6.0))
    }

    /// The order between steps and steps half as long, three times.
    fn assert_order<M>(order: f64, steps: u32)
    where
        Oscillator: Discretized<M>,
    {
        let errors = [1, 2, 4].map(|times| error::<M>(times * steps));
        for pair in errors.windows(2) {
            let measured = (pair[0] / pair[1]).log2();
            assert!((measured - order).abs() < 0.2, "order {measured} instead of {order}: {errors:?}");
        }
    }

    #[test]
    fn a_driven_system_has_the_order_of_its_scheme() {
        assert_order::<SymplecticEulerA>(1.0, 400);
        assert_order::<SymplecticEulerB>(1.0, 400);
        assert_order::<StormerVerlet>(2.0, 40);
        assert_order::<Exponential>(2.0, 40);
        assert_order::<Order4<StormerVerlet>>(4.0, 20);
        assert_order::<Order6<Exponential>>(6.0, 10);
        assert_order::<Order8<Exponential>>(8.0, 8);
        // and not that of a composition of symmetric ones
        assert_order::<Order4<SymplecticEulerA>>(1.0, 400);
    }
}
