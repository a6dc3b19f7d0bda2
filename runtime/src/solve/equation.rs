//! A step's equation as the solver has it: in line, of a kernel that is known, or through a table, in code that is compiled once for all kernels
//! with as many unknowns.

use super::memory::Convergence;
use super::predictor::Continuation;
use crate::kernel::{self, AtState, Equation, Evaluation, Kernel, finite};
use crate::scalar::{Batch, Mask, Scalar, Work};

/// What is known of a kernel's equation.
#[derive(Clone, Copy)]
pub(super) struct Facts<'a> {
    /// The lengths of the blocks of unknowns.
    pub(super) blocks: &'a [usize],
    pub(super) convergence: Convergence,
    pub(super) by: Continuation,
    /// [`Kernel::finds_any`]
    pub(super) finds_any: bool,
    /// [`Kernel::has_true_jacobian`]
    pub(super) has_true_jacobian: bool,
}

impl<'a> Facts<'a> {
    /// Those of a kernel.
    #[inline(always)]
    pub(super) fn of<T: Batch, K: Kernel<T>>(kernel: &'a K) -> Self {
        Self {
            blocks: kernel.blocks(),
            convergence: Convergence::of(kernel),
            by: Continuation::of(kernel),
            finds_any: kernel.finds_any(),
            has_true_jacobian: kernel.has_true_jacobian(),
        }
    }
}

/// An equation that iterations are made on.
pub(super) trait Iterated<T, U> {
    /// What an evaluation leaves for the update.
    type Iterate: Copy;
    /// See [`Kernel::start`].
    fn start(&self) -> U;
    /// See [`Kernel::evaluate`].
    fn evaluate(&mut self, unknown: &U) -> Evaluation<U, Self::Iterate>;
    /// See [`Kernel::fixed_point_update`], of the last evaluation.
    fn update(&self, unknown: &U, evaluation: &Evaluation<U, Self::Iterate>) -> U;
    /// The Newton correction at an unknown that nothing else is evaluated at.
    fn correction_at(&self, unknown: &U) -> U;
}

impl<T: Batch, K: Kernel<T>> Iterated<T, K::Unknown> for AtState<'_, T, K> {
    type Iterate = K::Iterate;

    #[inline(always)]
    fn start(&self) -> K::Unknown {
        self.kernel.start(self.state, self.step)
    }
    #[inline(always)]
    fn evaluate(&mut self, unknown: &K::Unknown) -> Evaluation<K::Unknown, K::Iterate> {
        self.kernel.evaluate(self.state, self.step, unknown)
    }
    #[inline(always)]
    fn update(&self, unknown: &K::Unknown, evaluation: &Evaluation<K::Unknown, K::Iterate>) -> K::Unknown {
        self.kernel.fixed_point_update(self.state, self.step, unknown, evaluation)
    }
    #[inline(always)]
    fn correction_at(&self, unknown: &K::Unknown) -> K::Unknown {
        self.corrected(unknown, None).iterate
    }
}

/// The equation of a step that was begun, through a table. It keeps what was evaluated last.
///
/// `extern "C"`, as [`Equation`].
pub(super) trait Begun<T: Batch, U>: Equation<T, U> {
    /// See [`Iterated::start`].
    extern "C" fn start(&self) -> U;
    /// See [`Iterated::evaluate`].
    extern "C" fn evaluate(&mut self, unknown: &U) -> Evaluation<U, ()>;
    /// See [`Iterated::update`].
    extern "C" fn update(&self, unknown: &U) -> U;
    /// See [`Kernel::correction`], of the last evaluation.
    extern "C" fn correction(&self, unknown: &U) -> U;
    /// Ends the step with what was evaluated last, near this solution.
    extern "C" fn finish(&mut self, unknown: &U) -> Ended<T>;
}

/// The lanes in which a step ended well.
#[derive(Clone, Copy)]
pub(super) struct Ended<T: Batch> {
    /// Where the solution is inside the retraction's domain.
    pub(super) inside: T::Mask,
    /// Where the next state is finite.
    pub(super) finite: T::Mask,
    /// Where all that was given is.
    pub(super) given: T::Mask,
}

impl<T: Batch, U> Iterated<T, U> for dyn Begun<T, U> + '_ {
    type Iterate = ();

    #[inline(always)]
    fn start(&self) -> U {
        Begun::start(self)
    }
    #[inline(always)]
    fn evaluate(&mut self, unknown: &U) -> Evaluation<U, ()> {
        Begun::evaluate(self, unknown)
    }
    #[inline(always)]
    fn update(&self, unknown: &U, _: &Evaluation<U, ()>) -> U {
        Begun::update(self, unknown)
    }
    #[inline(always)]
    fn correction_at(&self, unknown: &U) -> U {
        self.corrected(unknown, None).iterate
    }
}

/// A kernel's step that was begun.
pub(super) struct BegunStep<'a, T: Batch, K: Kernel<T>> {
    pub(super) at: AtState<'a, T, K>,
    pub(super) time: T,
    pub(super) control: &'a K::Control,
    /// What was evaluated last.
    pub(super) last: Option<Evaluation<K::Unknown, K::Iterate>>,
    /// The state after the step, once it has ended.
    pub(super) next: K::State,
}

// called from here alone
#[allow(improper_ctypes_definitions)]
impl<T: Batch, K: Kernel<T>> Equation<T, K::Unknown> for BegunStep<'_, T, K> {
    extern "C" fn corrected(
        &self,
        unknown: &K::Unknown,
        residual: Option<&K::Unknown>,
    ) -> Evaluation<K::Unknown, K::Unknown> {
        self.at.corrected(unknown, residual)
    }

    extern "C" fn roundoff(&self, unknown: &K::Unknown, lane: usize) -> K::Unknown {
        self.at.roundoff(unknown, lane)
    }
}

#[allow(improper_ctypes_definitions)]
impl<T: Batch, K: Kernel<T>> Begun<T, K::Unknown> for BegunStep<'_, T, K> {
    extern "C" fn start(&self) -> K::Unknown {
        T::dispatch(Start(&self.at))
    }

    extern "C" fn evaluate(&mut self, unknown: &K::Unknown) -> Evaluation<K::Unknown, ()> {
        let evaluation = self.last.insert(self.at.evaluate_apart(unknown));
        Evaluation { residual: evaluation.residual, right: evaluation.right, iterate: () }
    }

    extern "C" fn update(&self, unknown: &K::Unknown) -> K::Unknown {
        let update = |evaluation| T::dispatch(Update { equation: &self.at, unknown, evaluation });
        self.last.as_ref().map_or(*unknown, update)
    }

    extern "C" fn correction(&self, unknown: &K::Unknown) -> K::Unknown {
        let correction = |evaluation| self.at.correction_apart(unknown, evaluation);
        self.last.as_ref().map_or(*unknown, correction)
    }

    extern "C" fn finish(&mut self, unknown: &K::Unknown) -> Ended<T> {
        let Self { at, time, control, last, next } = self;
        // where nothing was evaluated, nothing is known
        let Some(evaluation) = last else {
            let none = T::Mask::splat(false);
            return Ended { inside: none, finite: none, given: none };
        };
        T::dispatch(Finish { equation: at, unknown, evaluation, time: *time, control, next })
    }
}

struct Start<'a, T: Scalar, K: Kernel<T>>(&'a AtState<'a, T, K>);

impl<T: Batch, K: Kernel<T>> Work for Start<'_, T, K> {
    type CallSite = K;
    type Result = K::Unknown;

    #[inline(always)]
    fn done(self) -> K::Unknown {
        self.0.start()
    }
}

struct Update<'a, T: Batch, K: Kernel<T>> {
    equation: &'a AtState<'a, T, K>,
    unknown: &'a K::Unknown,
    evaluation: &'a Evaluation<K::Unknown, K::Iterate>,
}

impl<T: Batch, K: Kernel<T>> Work for Update<'_, T, K> {
    type CallSite = K;
    type Result = K::Unknown;

    #[inline(always)]
    fn done(self) -> K::Unknown {
        self.equation.update(self.unknown, self.evaluation)
    }
}

struct Finish<'a, T: Batch, K: Kernel<T>> {
    equation: &'a AtState<'a, T, K>,
    unknown: &'a K::Unknown,
    evaluation: &'a Evaluation<K::Unknown, K::Iterate>,
    time: T,
    control: &'a K::Control,
    next: &'a mut K::State,
}

impl<T: Batch, K: Kernel<T>> Work for Finish<'_, T, K> {
    type CallSite = K;
    type Result = Ended<T>;

    #[inline(always)]
    fn done(self) -> Ended<T> {
        let Self { equation, unknown, evaluation, time, control, next } = self;
        *next = equation.kernel.finish(equation.state, equation.step, unknown, evaluation);
        ended(equation, unknown, evaluation, time, control, next)
    }
}

/// Tells how a step has ended.
#[inline(always)]
pub(super) fn ended<T: Batch, K: Kernel<T>>(
    equation: &AtState<'_, T, K>,
    unknown: &K::Unknown,
    evaluation: &Evaluation<K::Unknown, K::Iterate>,
    time: T,
    control: &K::Control,
    next: &K::State,
) -> Ended<T> {
    let AtState { kernel, state, step } = *equation;
    let inside = kernel::is_inside(kernel, state, step, unknown, evaluation);
    // a component that is not finite before the step is not finite after it
    let control = finite(control) & time.is_finite();
    Ended { inside, finite: finite(next) & control, given: finite(state) & control }
}
