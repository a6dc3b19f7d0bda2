//! The kernel of a step that is made at run time: everything but the unknown is in a frame.

use std::sync::Arc;
use std::vec::Vec;

use super::step::{Called, Step, StepFunction};
use crate::bytecode::{self, Function, Given};
use crate::kernel::{Blocks, Evaluation, Kernel};
use crate::scalar::blocks::less;
use crate::scalar::bounded::Bounded;
use crate::scalar::simd::frame::{Handle, MACHINE_LANES, MachineLanes};
use crate::scalar::simd::march;
use crate::scalar::{Batch, Scalar};

/// The numbers of a step.
pub(super) struct Frame<T: Called> {
    pub(super) rows: Vec<T::Row>,
    /// Which evaluation of the equation the values are of that depend on the unknown.
    evaluation: u64,
    /// The values of the step's bytes, where they were asked for.
    places: Vec<Bounded<f64>>,
}

impl<T: Called> Frame<T> {
    /// A frame for these parameters and a step of this length.
    pub(super) fn new(step: &Step, parameters: &[T], length: T) -> Self {
        let rows = step.frame.iter().map(|number| T::of(*number).row()).collect();
        let mut frame = Self { rows, evaluation: 0, places: Vec::new() };
        frame.rebuild(step, parameters, length);
        frame
    }

    /// Takes other parameters and another length.
    pub(super) fn rebuild(&mut self, step: &Step, parameters: &[T], length: T) {
        self.write(step.layout.parameters.clone(), parameters);
        self.rows[step.layout.step_size] = length.row();
        self.call(step, StepFunction::New);
    }

    /// Writes numbers to their places; what is missing is zero.
    pub(super) fn write(&mut self, to: core::ops::Range<usize>, numbers: &[T]) {
        let rows = &mut self.rows[to];
        let (given, missing) = rows.split_at_mut(numbers.len().min(rows.len()));
        given.iter_mut().zip(numbers).for_each(|(row, number)| *row = number.row());
        missing.fill(T::of(0.0).row());
    }

    /// Shows numbers.
    pub(super) fn read(&self, from: core::ops::Range<usize>) -> impl Iterator<Item = T> + '_ {
        self.rows[from].iter().map(|row| T::of_row(*row))
    }

    pub(super) fn call(&mut self, step: &Step, function: StepFunction) {
        T::call(&*step.functions, function, &mut self.rows);
    }

    pub(super) fn array<const U: usize>(&self, from: core::ops::Range<usize>) -> [T; U] {
        let mut array = [T::of(0.0); U];
        array.iter_mut().zip(self.read(from)).for_each(|(to, number)| *to = number);
        array
    }
}

/// An evaluation of the equation: its number, and where that was. Values that depend on the unknown are in the frame, and those of an earlier
/// evaluation are computed once more.
#[derive(Clone, Copy)]
pub(super) struct Iterate<T, const U: usize> {
    number: u64,
    point: [T; U],
}

/// How kernels reach their frame and their step.
pub(super) type Handled<T> = Handle<Frame<T>, Step>;

/// The kernel. `U` numbers have room for the unknown; those that are too many are zero, which changes no sum.
pub(super) struct DynamicKernel<T: Called, const U: usize>(pub(super) Handled<T>);

impl<T: Called, const U: usize> Clone for DynamicKernel<T, U> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T: Called, const U: usize> Copy for DynamicKernel<T, U> {}

impl<T: Called, const U: usize> DynamicKernel<T, U> {
    fn step(&self) -> &Step {
        self.0.data()
    }

    /// Calls a function of the solution, with the values of this evaluation in the frame.
    fn call(&self, function: StepFunction, unknown: &[T; U], evaluation: &Evaluation<[T; U], Iterate<T, U>>) {
        let (step, Iterate { number, point }) = (self.step(), &evaluation.iterate);
        self.0.with(|frame| {
            if frame.evaluation != *number {
                frame.write(step.layout.unknown.clone(), point);
                frame.call(step, StepFunction::Evaluate);
                frame.evaluation = *number;
            }
            frame.write(step.layout.unknown.clone(), unknown);
            frame.write(step.layout.residual.clone(), &evaluation.residual);
            frame.write(step.layout.right.clone(), &evaluation.right);
            frame.call(step, function);
        });
    }

    /// The same with the unknown that it returns.
    fn returned(
        &self,
        function: StepFunction,
        unknown: &[T; U],
        evaluation: &Evaluation<[T; U], Iterate<T, U>>,
    ) -> [T; U] {
        self.call(function, unknown, evaluation);
        self.0.with(|frame| frame.array(self.step().layout.out.clone()))
    }
}

impl<T: Called, const U: usize> Kernel<T> for DynamicKernel<T, U> {
    type Parameters = [T; 0];
    type State = [T; 0];
    type Control = [T; 0];
    type Unknown = [T; U];
    type Step = [T; 0];
    type Iterate = Iterate<T, U>;
    // never asked for: what rounding leaves is computed by a function of its own
    type Places<X: Scalar> = [X; 0];

    const BLOCKS: Blocks = &[];
    // what is compiled once more takes long, and a call is nothing beside what is interpreted
    const IS_LONG: bool = true;

    #[inline(always)]
    fn blocks(&self) -> &[usize] {
        &self.step().blocks
    }
    #[inline(always)]
    fn has_true_jacobian(&self) -> bool {
        self.step().has_true_jacobian
    }
    #[inline(always)]
    fn is_newton(&self) -> bool {
        self.step().is_newton
    }
    #[inline(always)]
    fn is_chord(&self) -> bool {
        self.step().is_chord
    }
    #[inline(always)]
    fn is_long(&self) -> bool {
        self.step().is_long
    }

    fn new(_: &[T; 0], _: T) -> Self {
        // `OneStep::of` is the only way to such a step, and a frame needs numbers that are not there
        unreachable!("it is made of its frame")
    }

    fn begin(&self, _: &[T; 0], time: T, _: &[T; 0]) -> [T; 0] {
        self.0.with(|frame| {
            frame.rows[self.step().layout.time] = time.row();
            frame.call(self.step(), StepFunction::Begin);
        });
        []
    }

    fn start(&self, _: &[T; 0], _: &[T; 0]) -> [T; U] {
        self.0.with(|frame| {
            frame.call(self.step(), StepFunction::Start);
            frame.array(self.step().layout.out.clone())
        })
    }

    fn evaluate(&self, _: &[T; 0], _: &[T; 0], unknown: &[T; U]) -> Evaluation<[T; U], Iterate<T, U>> {
        let layout = &self.step().layout;
        self.0.with(|frame| {
            frame.write(layout.unknown.clone(), unknown);
            frame.call(self.step(), StepFunction::Evaluate);
            frame.evaluation += 1;
            Evaluation {
                residual: frame.array(layout.residual.clone()),
                right: frame.array(layout.right.clone()),
                iterate: Iterate { number: frame.evaluation, point: *unknown },
            }
        })
    }

    fn correction(
        &self,
        _: &[T; 0],
        _: &[T; 0],
        unknown: &[T; U],
        evaluation: &Evaluation<[T; U], Iterate<T, U>>,
    ) -> [T; U] {
        self.returned(StepFunction::Correction, unknown, evaluation)
    }

    fn fixed_point_update(
        &self,
        _: &[T; 0],
        _: &[T; 0],
        unknown: &[T; U],
        evaluation: &Evaluation<[T; U], Iterate<T, U>>,
    ) -> [T; U] {
        if self.is_newton() && self.has_true_jacobian() {
            return less(unknown, &self.correction(&[], &[], unknown, evaluation));
        }
        self.returned(StepFunction::FixedPointUpdate, unknown, evaluation)
    }

    /// Not a number, too, where the state after the step is not finite: it is in the frame, where nobody else looks.
    fn domain(
        &self,
        _: &[T; 0],
        _: &[T; 0],
        unknown: &[T; U],
        evaluation: &Evaluation<[T; U], Iterate<T, U>>,
    ) -> Option<T> {
        let layout = &self.step().layout;
        if self.step().has_domain {
            self.call(StepFunction::Domain, unknown, evaluation);
        }
        self.0.with(|frame| {
            let margin =
                if self.step().has_domain { T::of_row(frame.rows[layout.margin]) } else { T::of(1.0) };
            // times zero first: a sum of finite numbers may not be finite
            let ends = frame.read(layout.next.clone()).chain(frame.read(layout.control.clone()));
            Some(ends.fold(margin, |margin, number| margin + T::of(0.0) * number))
        })
    }

    fn finish(
        &self,
        _: &[T; 0],
        _: &[T; 0],
        unknown: &[T; U],
        evaluation: &Evaluation<[T; U], Iterate<T, U>>,
    ) -> [T; 0] {
        self.call(StepFunction::Finish, unknown, evaluation);
        []
    }

    fn rounding(&self, unknown: &[T; U], lane: usize) -> Option<[T; U]> {
        let step = self.step();
        let mut bound = [T::of(0.0); U];
        self.0.with(|frame| {
            let mut places = core::mem::take(&mut frame.places);
            places.resize(step.places, Bounded::of(0.0));
            let exactly = |of: &core::ops::Range<usize>, i: usize| {
                let row = frame.rows.get(of.start + i).filter(|_| i < of.len())?;
                Some(Bounded::exactly(T::of_row(*row).lane(lane)))
            };
            let given = |given, i: usize| match given {
                Given::Constants => exactly(&step.layout.constants, i),
                Given::Step => exactly(&step.layout.step, i),
                Given::State => exactly(&step.layout.state, i),
                Given::Unknown => Some(Bounded::nearest(unknown.get(i)?.lane(lane))),
                _ => None,
            };
            let code = &step.program[Function::Evaluate as usize];
            bytecode::run(code, &mut places, &given, &mut |array, i, residual: Bounded<f64>| {
                if let (0, Some(bound)) = (array, bound.get_mut(i)) {
                    bound.set_lane(lane, residual.error);
                    *bound = T::of(T::EPSILON) * *bound;
                }
            });
            frame.places = places;
        });
        Some(bound)
    }
}

/// A kernel whose type has room for the step's unknowns, in one of a few sizes, with what is made of it.
pub(super) trait OfKernel<T: Called> {
    /// What is made.
    type Made;
    /// Makes it of the kernel with this room.
    fn made<const U: usize>(self, step: &Arc<Step>) -> Self::Made;
}

/// How many numbers there are from one solution to the next where those of so many unknowns are remembered, of one member or of [`MACHINE_LANES`].
pub const fn row_length(unknowns: usize, members: usize) -> usize {
    if members == MACHINE_LANES { length_of::<MachineLanes>(unknowns) } else { length_of::<f64>(unknowns) }
}

const fn length_of<T: Batch>(unknowns: usize) -> usize {
    // as below
    match unknowns {
        0 => march::row_length::<T, 0>(),
        1..=3 => march::row_length::<T, 3>(),
        4..=6 => march::row_length::<T, 6>(),
        7..=MOST_IN_LANES => march::row_length::<T, MOST_IN_LANES>(),
        13..=24 => march::row_length::<T, 24>(),
        _ => march::row_length::<T, MOST_UNKNOWNS>(),
    }
}

/// Whether steps of so many unknowns each have the same room for them.
pub(super) const fn have_the_same_room(one: usize, other: usize) -> bool {
    // with room for none, rows are as long as with room for some
    length_of::<f64>(one) == length_of::<f64>(other) && (one == 0) == (other == 0)
}

/// Makes something of a step's kernel.
pub(super) fn of_kernel<T: Called, O: OfKernel<T>>(step: &Arc<Step>, of: O) -> O::Made {
    match step.layout.unknown.len() {
        0 => of.made::<0>(step),
        1..=3 => of.made::<3>(step),
        4..=6 => of.made::<6>(step),
        // side by side there are none that are larger
        7..=MOST_IN_LANES => of.made::<MOST_IN_LANES>(step),
        unknowns => {
            if const { T::LANES > 1 } {
                of.made::<MOST_IN_LANES>(step)
            } else if unknowns <= 24 {
                of.made::<24>(step)
            } else {
                of.made::<MOST_UNKNOWNS>(step)
            }
        }
    }
}

/// How many unknowns a step may have that is taken side by side with others.
pub(super) const MOST_IN_LANES: usize = 12;

/// How many unknowns a step may have.
pub const MOST_UNKNOWNS: usize = 96;
