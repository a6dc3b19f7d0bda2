//! What is done for a step that neither iterations nor Newton's method solve: a lane at a time, from nothing that is remembered.

use super::constants::{
    APART, DAMPED, EVALUATIONS, NEARLY, ON_THE_WAY, PARTS, ROUNDINGS, SHORTEST, STRIDE, WANDERING,
};
use crate::error::StepError;
use crate::kernel::{Equation, Evaluation, finite};
use crate::scalar::blocks::{beyond, is_below, less, plus, relative};
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

/// The larger of each two sizes that are finite.
fn larger<T: Batch, U: Components<T>>(a: &U, b: &U) -> U {
    let mut larger = *a;
    for (a, b) in larger.as_mut().iter_mut().zip(b.as_ref()) {
        let is_larger = a.abs().lt(b.abs()) & b.is_finite();
        *a = T::select(is_larger, *b, *a);
    }
    larger
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

    /// The equation at an unknown with Newton's correction for the blocks of its residual that are more than what rounding
    /// leaves of their terms, and these. A correction for the others would be one at random, and it is the next residual
    /// of those that depend on what it changes.
    fn corrected(&self, unknown: &U) -> (Evaluation<U, U>, U) {
        let Evaluation { residual, right, .. } = self.equation.corrected(unknown, None);
        let beyond = beyond::<T, _>(self.blocks, &residual, &self.rounding(unknown));
        let iterate = self.equation.corrected(unknown, Some(&beyond)).iterate;
        (Evaluation { residual, right, iterate }, beyond)
    }

    /// What rounding leaves of the residual.
    fn rounding(&self, unknown: &U) -> U {
        self.equation.roundoff(unknown, self.lane)
    }

    /// Newton's method with corrections that are halved where the residual, relative to its terms, does not become smaller; and whether none was.
    fn damped(&self) -> (Result<Rescued<T, U>, StepError>, bool) {
        let mut terms = self.rounding(self.start);
        if !finite::<T, _>(&terms).lane(self.lane) {
            let Evaluation { residual, right, .. } = self.equation.corrected(self.start, None);
            let left = self.size(relative::<T, _>(self.blocks, &residual, &right));
            if left == 0.0 {
                let unknown = *self.start;
                return (Ok(Rescued { unknown, residual: T::of(left), evaluations: 1 }), true);
            }
            // or rounding may leave anything of them, which nothing solves
            let error = if left.is_finite() {
                StepError::NoSolution { residual: left }
            } else {
                StepError::NotFinite
            };
            return (Err(error), false);
        }
        let (mut unknown, mut trial, mut correction) = (*self.start, *self.start, *self.start);
        let (mut best, mut left, mut scale, mut is_direct) = (None, f64::INFINITY, 1.0, true);
        for evaluations in 1..=DAMPED {
            let (Evaluation { residual, right, iterate: newest }, beyond) = self.corrected(&trial);
            if let Some(residual) = self.solved(&residual, &trial) {
                return (Ok(Rescued { unknown: trial, residual, evaluations }), is_direct);
            }
            // the largest so far: at rest there are none in the beginning
            terms = larger(&terms, &self.rounding(&trial));
            let size = |residual: &U| self.size(relative::<T, _>(self.blocks, residual, &terms));
            // near a solution, what becomes larger is what rounding of some unknowns leaves of terms of others that cancel
            if size(&beyond) < best.as_ref().map_or(f64::INFINITY, size).max(NEARLY) {
                (unknown, best, correction, scale) = (trial, Some(beyond), newest, 1.0);
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
            let (Evaluation { residual, iterate: correction, .. }, _) = self.corrected(&unknown);
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
