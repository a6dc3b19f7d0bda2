//! A step's equation as the solver has it: in line, of a kernel that is known, or through a table, in code that is compiled once for all kernels
//! with as many unknowns.

use super::memory::Convergence;
use super::predictor::Continuation;
use crate::kernel::{self, AtState, Equation, Evaluation, Kernel, finite};
use crate::scalar::{Batch, Scalar, Work};

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
    /// What is known of a point where it was evaluated.
    type Evaluation: Copy;
    /// See [`Kernel::start`].
    fn start(&self) -> U;
    /// See [`Kernel::fixed_point_update`], and the evaluation that it is of.
    fn iterate(&self, unknown: &U) -> (U, Self::Evaluation);
    /// The Newton correction at an unknown, where it is seldom asked for.
    fn correction_apart(&self, unknown: &U) -> U;
}

impl<T: Batch, K: Kernel<T>> Iterated<T, K::Unknown> for AtState<'_, T, K> {
    type Evaluation = Evaluation<K::Unknown, K::Iterate>;

    #[inline(always)]
    fn start(&self) -> K::Unknown {
        self.kernel.start(self.state, self.step)
    }
    #[inline(always)]
    fn iterate(&self, unknown: &K::Unknown) -> (K::Unknown, Self::Evaluation) {
        let evaluation = self.evaluate(unknown);
        (self.kernel.fixed_point_update(self.state, self.step, unknown, &evaluation), evaluation)
    }
    #[inline(always)]
    fn correction_apart(&self, unknown: &K::Unknown) -> K::Unknown {
        self.corrected(unknown, None).iterate
    }
}

/// The equation of a step that was begun, through a table.
///
/// `extern "C"`, as [`Equation`].
pub(super) trait Begun<T: Batch, U>: Equation<T, U> {
    /// See [`Kernel::start`].
    extern "C" fn first(&self) -> U;
    /// See [`Kernel::fixed_point_update`].
    extern "C" fn update(&self, unknown: &U) -> U;
    /// Ends the step with this solution, so near to the point where the equation is evaluated that it makes no difference.
    extern "C" fn finish(&mut self, point: &U, unknown: &U) -> Ended<T>;
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
    type Evaluation = ();

    #[inline(always)]
    fn start(&self) -> U {
        self.first()
    }
    #[inline(always)]
    fn iterate(&self, unknown: &U) -> (U, ()) {
        (self.update(unknown), ())
    }
    #[inline(always)]
    fn correction_apart(&self, unknown: &U) -> U {
        self.corrected(unknown, None).iterate
    }
}

/// A kernel's step that was begun.
pub(super) struct BegunStep<'a, T: Batch, K: Kernel<T>> {
    pub(super) at: AtState<'a, T, K>,
    pub(super) time: T,
    pub(super) control: &'a K::Control,
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
    extern "C" fn first(&self) -> K::Unknown {
        T::dispatch(First(&self.at))
    }

    extern "C" fn update(&self, unknown: &K::Unknown) -> K::Unknown {
        T::dispatch(Update { equation: &self.at, unknown })
    }

    extern "C" fn finish(&mut self, point: &K::Unknown, unknown: &K::Unknown) -> Ended<T> {
        let Self { at, time, control, next } = self;
        T::dispatch(Finish { equation: at, point, unknown, time: *time, control, next })
    }
}

struct First<'a, T: Scalar, K: Kernel<T>>(&'a AtState<'a, T, K>);

impl<T: Batch, K: Kernel<T>> Work for First<'_, T, K> {
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
}

impl<T: Batch, K: Kernel<T>> Work for Update<'_, T, K> {
    type CallSite = K;
    type Result = K::Unknown;

    #[inline(always)]
    fn done(self) -> K::Unknown {
        let Self { equation: AtState { kernel, state, step }, unknown } = self;
        let evaluation = self.equation.evaluate_apart(unknown);
        kernel.fixed_point_update(state, step, unknown, &evaluation)
    }
}

struct Finish<'a, T: Batch, K: Kernel<T>> {
    equation: &'a AtState<'a, T, K>,
    point: &'a K::Unknown,
    unknown: &'a K::Unknown,
    time: T,
    control: &'a K::Control,
    next: &'a mut K::State,
}

impl<T: Batch, K: Kernel<T>> Work for Finish<'_, T, K> {
    type CallSite = K;
    type Result = Ended<T>;

    #[inline(always)]
    fn done(self) -> Ended<T> {
        let Self { equation, point, unknown, time, control, next } = self;
        let evaluation = equation.evaluate_apart(point);
        *next = equation.kernel.finish(equation.state, equation.step, unknown, &evaluation);
        ended(equation, unknown, &evaluation, time, control, next)
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
