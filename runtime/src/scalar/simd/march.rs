//! Steps that machine code takes, which was made at run time.
#![allow(unsafe_code, reason = "nobody but who made machine code knows what it does")]

use core::marker::PhantomData;
use std::any::Any;
use std::sync::Arc;
use std::vec::Vec;

use super::frame::{Framed, MACHINE_LANES};
use crate::scalar::Components;
use crate::scalar::rows::Row;

/// How many solutions are remembered.
pub(crate) const WINDOW: usize = 16;

/// What machine code goes on from in one stage of its steps, and where it has led to: of one member, or of
/// [`MACHINE_LANES`] whose numbers are side by side.
#[repr(C)]
#[derive(Debug)]
pub struct Marching {
    /// The frame.
    pub frame: *mut f64,
    /// The solutions that are remembered, in a ring, from one to the next as many numbers as
    /// [`row_length`](crate::erased::dynamic::row_length) says.
    pub ring: *mut f64,
    /// Where the solutions point.
    pub next: *mut f64,
    /// The latest solution, of Newton's method.
    pub solution: *mut f64,
    /// The relative change of an iteration that may be the last, of each member.
    pub tolerance: [f64; MACHINE_LANES],
    /// The weights of differences of solutions, of each member.
    pub weights: [[f64; MACHINE_LANES]; 5],
    /// Steps start at `start + taken · step`.
    pub start: f64,
    /// As above.
    pub step: f64,
    /// As above.
    pub taken: u64,
    /// How many steps to take at most.
    pub most: u64,
    /// The place of the oldest solution.
    pub oldest: u64,
    /// How many steps were taken.
    pub steps: u64,
    /// The stage of the next step that is left to the solver, of the first stage alone.
    pub halted: u64,
    /// Iterations more than one a step, all together.
    pub more: u64,
    /// The same in one step at most.
    pub most_more: u64,
    /// Whether an iteration of the stage that is left was made, which led to where results go.
    pub has_first: u64,
}

/// Machine code that takes steps as nearly all are: what the solver's fast path does, again and again. It may leave any step to that.
#[derive(Clone)]
pub struct March {
    /// It is given what there is for each stage.
    code: unsafe extern "C" fn(*mut Marching),
    /// How many numbers frames have at least, and rows, for each stage.
    lengths: Vec<[usize; 2]>,
    /// What the code is a part of.
    _owner: Arc<dyn Any + Send + Sync>,
}

impl core::fmt::Debug for March {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("March").field("lengths", &self.lengths).finish_non_exhaustive()
    }
}

/// What is remembered of the solutions before.
pub(crate) struct Remembered<'a, T, U> {
    pub(crate) ring: &'a mut [Row<T, U, 1>; WINDOW],
    pub(crate) next: &'a mut U,
    pub(crate) solution: &'a mut U,
    pub(crate) oldest: u32,
}

/// What is lent to machine code for one stage.
pub(crate) struct Lent<'a> {
    marching: Marching,
    lengths: [usize; 2],
    _lent: PhantomData<&'a mut f64>,
}

/// How a stage went.
#[derive(Clone, Copy)]
pub(crate) struct Marched {
    /// Steps that were taken.
    pub(crate) steps: u64,
    /// The place of the oldest solution.
    pub(crate) oldest: u32,
    /// The stage of the next step that is left to the solver.
    pub(crate) halted: usize,
    /// Iterations more than one a step, all together, and in one step at most.
    pub(crate) more: (u64, u32),
    /// Whether an iteration of the stage that is left was made, which led to where results go.
    pub(crate) has_first: bool,
}

/// A number of each member.
fn of_each<T: Framed>(number: &T) -> [f64; MACHINE_LANES] {
    core::array::from_fn(|lane| number.lane(lane % T::LANES))
}

impl<'a> Lent<'a> {
    /// For up to so many steps from the state in a frame on.
    pub(crate) fn new<T: Framed, U: Components<T>>(
        frame: &'a mut [T::Row],
        remembered: Remembered<'a, T, U>,
        tolerance: T,
        weights: &[T; 5],
        (start, step, taken): (f64, f64, u64),
        most: u64,
    ) -> Self {
        let Remembered { ring, next, solution, oldest } = remembered;
        let row = size_of::<Row<T, U, 1>>() / size_of::<f64>();
        let marching = Marching {
            ring: ring.as_mut_ptr().cast(),
            next: next.as_mut().as_mut_ptr().cast(),
            solution: solution.as_mut().as_mut_ptr().cast(),
            tolerance: of_each(&tolerance),
            weights: weights.each_ref().map(of_each),
            start,
            step,
            taken,
            most,
            oldest: oldest.into(),
            steps: 0,
            halted: 0,
            more: 0,
            most_more: 0,
            has_first: 0,
            frame: frame.as_mut_ptr().cast(),
        };
        Self { marching, lengths: [frame.len() * T::LANES, row], _lent: PhantomData }
    }
}

/// How many numbers there are from one solution that is remembered to the next, with room for so many unknowns.
pub(crate) const fn row_length<T, const U: usize>() -> usize {
    size_of::<Row<T, [T; U], 1>>() / size_of::<f64>()
}

impl March {
    /// Code for steps of so many stages, each with how many numbers its frame has at least, and its rows, with room for its unknowns.
    ///
    /// # Safety
    /// The code is there as long as the owner is. Of each stage it reads and writes what it is given, and no more: a frame, a ring of 16 rows, and two
    /// unknowns.
    pub unsafe fn new(
        code: unsafe extern "C" fn(*mut Marching),
        lengths: Vec<[usize; 2]>,
        owner: Arc<dyn Any + Send + Sync>,
    ) -> Self {
        Self { code, lengths, _owner: owner }
    }

    /// Takes steps.
    pub(crate) fn take<const N: usize>(&self, lent: [Lent<'_>; N]) -> [Marched; N] {
        let mut stages = self.lengths.iter().zip(&lent);
        let are_right = self.lengths.len() == N
            && stages.all(|([frame, row], lent)| *frame <= lent.lengths[0] && *row == lent.lengths[1]);
        let mut all = lent.map(|lent| lent.marching);
        if are_right {
            // SAFETY: what the pointers lead to is lent to this call, and as long as the code expects
            unsafe { (self.code)(all.as_mut_ptr()) };
        }
        let [steps, halted] = all.first().map_or([0; 2], |first| [first.steps, first.halted]);
        all.map(|marching| Marched {
            steps,
            halted: halted as usize,
            oldest: marching.oldest as u32,
            more: (marching.more, marching.most_more as u32),
            has_first: marching.has_first != 0,
        })
    }
}
