//! What is done for a step that neither iterations nor Newton's method solve: a lane at a time, from nothing that is remembered.

use super::constants::{
    APART, DAMPED, EVALUATIONS, ON_THE_WAY, PARTS, ROUNDINGS, SHORTEST, STRIDE, WANDERING,
};
use crate::error::StepError;
use crate::kernel::{Equation, Evaluation, finite};
use crate::scalar::blocks::{is_below, less, plus, relative};
use crate::scalar::{Batch, Components, Mask, Real, Work};

/// A solution, what is left of its terms, and how many evaluations it took.
#[derive(Clone, Copy)]
pub(super) struct Rescued<T, U> {
    pub(super) unknown: U,
    pub(super) residual: T,
    pub(super) evaluations: u32,
}

/// Solves the equation in one lane from its first approximation.
pub(super) struct Rescue<'a, T, U> {
    pub(super) equation: &'a dyn Equation<T, U>,
    pub(super) blocks: &'a [usize],
    pub(super) start: &'a U,
    pub(super) lane: usize,
}

/// Out of line: once for all equations with as many unknowns.
impl<T: Batch, U: Components<T>> Work for Rescue<'_, T, U> {
    type CallSite = ();
    type Result = Result<Rescued<T, U>, StepError>;

    #[inline(always)]
    fn done(self) -> Self::Result {
        let (damped, is_direct) = self.damped();
        if let (Ok(solution), true) = (&damped, is_direct) {
            return Ok(*solution);
        }
        // on the way from the first approximation, whose solution it is, to the equation
        match (damped, PARTS.iter().find_map(|parts| self.continued(*parts, Newton::Contracting))) {
            (Ok(Rescued { unknown, .. }), Some(continued)) if !self.is_same(&unknown, &continued.unknown) => {
                self.agreed().ok_or(StepError::SeveralSolutions)
            }
            (_, Some(continued)) => Ok(continued),
            (Err(error), None) => self.agreed().ok_or(error),
            (damped, None) => damped,
        }
    }
}

/// How far Newton's method goes.
#[derive(Clone, Copy, PartialEq)]
enum Newton {
    /// As long as corrections become smaller.
    Contracting,
    /// Wherever corrections lead.
    Wandering,
}

impl<T: Batch, U: Components<T>> Rescue<'_, T, U> {
    /// The number in the lane.
    fn size(&self, x: T) -> f64 {
        x.lane(self.lane).to_f64()
    }

    /// Whether two solutions are one, but for what rounding leaves of the residual.
    fn is_same(&self, a: &U, b: &U) -> bool {
        let mut bound = self.equation.corrected(a, Some(&self.rounding(a))).iterate;
        let mut i = 0;
        while i < U::LENGTH {
            let [rounding, size] = [&bound, a].map(|x| x.as_ref()[i].abs());
            bound.as_mut()[i] = T::of(ROUNDINGS) * rounding + T::of(APART) * size;
            i += 1;
        }
        is_below::<T, _>(self.blocks, &less(a, b), &bound).lane(self.lane)
    }

    /// What is left of the terms of a residual, if that is what rounding leaves.
    fn solved(&self, residual: &U, unknown: &U) -> Option<T> {
        let rounding = &self.rounding(unknown);
        let left = T::of(T::EPSILON) * relative::<T, _>(self.blocks, residual, rounding);
        is_below::<T, _>(self.blocks, residual, rounding).lane(self.lane).then_some(left)
    }

    /// What rounding leaves of the residual.
    fn rounding(&self, unknown: &U) -> U {
        self.equation.roundoff(unknown, self.lane)
    }

    /// Newton's method with corrections that are halved where the residual, relative to its terms, does not become smaller; and whether none was.
    fn damped(&self) -> (Result<Rescued<T, U>, StepError>, bool) {
        // fixed weights: how large the terms are in the beginning
        let terms = self.rounding(self.start);
        if !finite::<T, _>(&terms).lane(self.lane) {
            let Evaluation { residual, right, .. } = self.equation.corrected(self.start, None);
            let left = self.size(relative::<T, _>(self.blocks, &residual, &right));
            // or rounding may leave anything of them, which nothing solves
            let error = if left.is_finite() {
                StepError::NoSolution { residual: left }
            } else {
                StepError::NotFinite
            };
            return (Err(error), false);
        }
        let (mut unknown, mut trial, mut correction) = (*self.start, *self.start, *self.start);
        let (mut smallest, mut left, mut scale, mut is_direct) = (f64::INFINITY, f64::INFINITY, 1.0, true);
        for evaluations in 1..=DAMPED {
            let Evaluation { residual, right, iterate: newest } = self.equation.corrected(&trial, None);
            let now = self.size(relative::<T, _>(self.blocks, &residual, &terms));
            if let Some(residual) = self.solved(&residual, &trial) {
                return (Ok(Rescued { unknown: trial, residual, evaluations }), is_direct);
            }
            if now < smallest {
                (unknown, smallest, correction, scale) = (trial, now, newest, 1.0);
                // what an error tells, next to the right side as it is there
                left = self.size(relative::<T, _>(self.blocks, &residual, &right));
                if !self.size(relative::<T, _>(self.blocks, &correction, &unknown)).is_finite() {
                    return (Err(StepError::SingularJacobian), false);
                }
            } else {
                (scale, is_direct) = (0.5 * scale, false);
                if !(scale > SHORTEST) {
                    return (Err(StepError::NoSolution { residual: left }), false);
                }
            }
            trial = plus(&unknown, T::of(-scale), &correction);
        }
        (Err(StepError::NoConvergence { iterations: DAMPED, residual: left }), false)
    }

    /// The solution to which Newton's method and a path in many parts both lead, wherever corrections lead between.
    fn agreed(&self) -> Option<Rescued<T, U>> {
        let direct = self.newton(*self.start, 0, false, Newton::Wandering)?;
        // finer than before, as nothing else has led there
        let continued = PARTS.iter().find_map(|parts| self.continued(4 * parts, Newton::Wandering))?;
        self.is_same(&direct.unknown, &continued.unknown).then_some(direct)
    }

    /// The solution by continuation: of equations whose residuals at the first approximation are ever smaller parts of what it is there.
    fn continued(&self, parts: u32, last: Newton) -> Option<Rescued<T, U>> {
        let Evaluation { residual: first, .. } = self.equation.corrected(self.start, None);
        let (mut unknown, mut evaluations) = (*self.start, 1);
        for part in 1..parts {
            let left = 1.0 - f64::from(part) / f64::from(parts);
            let mut last = f64::INFINITY;
            loop {
                let Evaluation { residual, .. } = self.equation.corrected(&unknown, None);
                let residual = plus(&residual, T::of(-left), &first);
                let correction = self.equation.corrected(&unknown, Some(&residual)).iterate;
                let moves = self.size(relative::<T, _>(self.blocks, &correction, &unknown));
                evaluations += 1;
                // nor is it on its way where corrections do not become smaller
                if !(moves < last || moves <= ON_THE_WAY) || evaluations > EVALUATIONS * parts {
                    return None;
                }
                unknown = less(&unknown, &correction);
                last = moves;
                if moves <= ON_THE_WAY {
                    break;
                }
            }
        }
        self.newton(unknown, evaluations, parts > 1, last)
    }

    /// The solution to which Newton's method leads from there, after so many evaluations: from its first approximation,
    /// or as the last part of a path.
    fn newton(&self, from: U, before: u32, is_part: bool, way: Newton) -> Option<Rescued<T, U>> {
        let mut unknown = from;
        let mut last = f64::INFINITY;
        for evaluations in 1..=WANDERING {
            let Evaluation { residual, iterate: correction, .. } = self.equation.corrected(&unknown, None);
            if let Some(residual) = self.solved(&residual, &unknown) {
                // what leads farther than a part of a path does may have come to another one
                let far = self.size(relative::<T, _>(self.blocks, &less(&unknown, &from), &unknown));
                let is_on_path = !is_part || far <= STRIDE;
                return is_on_path.then_some(Rescued {
                    unknown,
                    residual,
                    evaluations: before + evaluations,
                });
            }
            let moves = self.size(relative::<T, _>(self.blocks, &correction, &unknown));
            let contracts = moves < last || moves <= ON_THE_WAY;
            if !(contracts || way == Newton::Wandering && moves.is_finite()) {
                return None;
            }
            unknown = less(&unknown, &correction);
            last = moves;
        }
        None
    }
}
