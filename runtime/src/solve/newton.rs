//! Newton's method on a step's equation.

use super::constants::{FAR, NEAR, PROGRESS, REGULAR, RESIDUAL, TOWARDS};
use super::equation::{Begun, Facts, Iterated};
use super::{Solution, count, go_on};
use crate::kernel::Evaluation;
use crate::scalar::blocks::{change, is_below, less, plus, relative, select};
use crate::scalar::{Batch, Components, Mask, Work};

/// The lanes that were not solved `before`, solved from `from` on; in others all stays as it is. Lanes in which the corrections do not lead to a
/// solution, or to one that may not be the one that they lead to from the equation's own first approximation if they begin `elsewhere`, stay
/// unsolved.
pub(super) struct Newton<'a, T: Batch, U> {
    pub(super) equation: &'a dyn Begun<T, U>,
    pub(super) facts: &'a Facts<'a>,
    pub(super) before: Option<&'a Solution<T, U, ()>>,
    pub(super) from: &'a U,
    pub(super) elsewhere: T::Mask,
    pub(super) rate: T,
}

/// Out of line: once for all equations with as many unknowns.
impl<T: Batch, U: Components<T>> Work for Newton<'_, T, U> {
    type CallSite = ();
    type Result = Solution<T, U, ()>;

    #[inline(always)]
    fn done(self) -> Solution<T, U, ()> {
        let Self { equation, facts, before, from, elsewhere, rate } = self;
        let (blocks, is_true) = (facts.blocks, facts.has_true_jacobian);
        let (mut point, mut solved) = (*from, T::Mask::splat(false));
        let (mut iterations, mut residual) = (T::all(0), T::of(0.0));
        if let Some(before) = before {
            (solved, iterations, residual) = (before.solved, before.iterations, before.residual);
            point = select(solved, &before.point, from);
        }
        let (mut open, first_solved) = (!solved, solved);
        let (mut last, mut moved) = (T::of(FAR), T::of(1.0));
        let mut round = 0;
        loop {
            let Evaluation { residual: left, right, iterate: correction } = equation.corrected(&point, None);
            let now = relative::<T, _>(blocks, &left, &right);
            let mut done = open & is_rounding(now, moved, is_true);
            residual = T::select(open, now, residual);
            let stalls = open & !done & !now.le(T::of(PROGRESS) * last);
            if stalls.any() {
                let rounding = roundoff(equation, &point, stalls);
                done = done | (stalls & is_below::<T, _>(blocks, &left, &rounding));
                // relative to the terms
                let of_terms = T::of(T::EPSILON) * relative::<T, _>(blocks, &left, &rounding);
                residual = T::select(stalls, of_terms, residual);
            }
            solved = solved | done;
            open = open & !done & !stalls & T::Mask::splat(round < REGULAR);
            if !open.any() {
                break;
            }
            (last, moved) = (now, relative::<T, _>(blocks, &correction, &point));
            point = go_on::<T, _>(open, &less(&point, &correction), &point);
            round += 1;
            count::<T>(&mut iterations, open);
        }
        let doubtful = elsewhere & solved & !first_solved;
        if doubtful.any() {
            let start = Iterated::start(equation);
            solved = solved & is_found_from_start(equation, blocks, &start, &point, doubtful);
        }
        let unknown = before.map_or(point, |before| select(first_solved, &before.unknown, &point));
        let quick = before.map_or(T::Mask::splat(false), |before| before.quick);
        Solution { point, unknown, evaluation: (), solved, quick, iterations, residual, rate }
    }
}

/// Whether a residual is rounding, after a correction that moved the unknown by so much. Of a matrix that is not the Jacobian a correction leaves
/// more than its square.
#[inline(always)]
fn is_rounding<T: Batch>(residual: T, moved: T, is_true: bool) -> T::Mask {
    let (unit, square) = (T::of(T::EPSILON), moved * moved);
    let [[exact, _], [near, little], [far, much]] = RESIDUAL;
    residual.le(T::of(exact) * unit)
        | (residual.le(T::of(near) * unit) & (T::of(little) * square).le(unit))
        | (residual.le(T::of(far) * unit) & (T::of(much) * square).le(unit) & T::Mask::splat(is_true))
}

/// What rounding leaves of the residual in these lanes.
#[inline(always)]
fn roundoff<T: Batch, U: Components<T>>(equation: &dyn Begun<T, U>, unknown: &U, lanes: T::Mask) -> U {
    let mut all = U::splat(T::of(0.0));
    let mut lane = 0;
    while lane < T::LANES {
        if lanes.lane(lane) {
            all = plus(&all, T::of(1.0), &equation.roundoff(unknown, lane));
        }
        lane += 1;
    }
    all
}

/// Whether Newton's method leads to a solution from the equation's first approximation, too, in the lanes in which it is asked: there it is near,
/// or the first correction leads nearer to it. Where steps are so large that the equation has several solutions, which of them a step takes must not
/// depend on what is remembered.
#[inline(always)]
pub(super) fn is_found_from_start<T: Batch, U: Components<T>, E: Iterated<T, U> + ?Sized>(
    equation: &E,
    blocks: &[usize],
    start: &U,
    solution: &U,
    asked: T::Mask,
) -> T::Mask {
    let away = change::<T, _>(blocks, start, solution);
    let is_near = away.le(T::of(NEAR)) | !asked;
    if is_near.all() {
        return is_near;
    }
    // most are near
    let there = less(start, &equation.correction_apart(start));
    is_near | change::<T, _>(blocks, &there, solution).le(T::of(TOWARDS) * away)
}
