//! How the members of an ensemble lie in memory: side by side in blocks that fill registers.

use std::boxed::Box;
use std::vec::Vec;

use super::Failed;
use crate::kernel::Components;
use crate::lanes::{Lanes, Portable};
use crate::method::{Clock, Failure, Method};
#[cfg(target_arch = "x86_64")]
use crate::processor::{Avx2, Avx512};
use crate::scalar::{Batch, Real, Work};
use crate::system::{Discretized, System};

/// What came of some steps.
pub(super) struct Marched {
    pub failed: Vec<Failed>,
    pub member_steps: u64,
}

/// All members, some side by side; how many, and on what kind of processor, is hidden behind it.
pub(super) trait Blocks<S: System>: Send + Sync {
    fn march(&mut self, clock: Clock, steps: u64) -> Marched;
    fn width(&self) -> usize;
    fn is_alive(&self, member: usize) -> bool;
    fn state(&self, member: usize) -> S::StateComponents<S::Scalar>;
    fn set_control(&mut self, member: usize, control: &S::ControlComponents<S::Scalar>);
}

/// Parameters and state of a member.
type Member<S> =
    (<S as System>::Parameters<<S as System>::Scalar>, <S as System>::StateComponents<<S as System>::Scalar>);

/// What an ensemble's arithmetic is compiled for. It makes no difference to what comes out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Instructions {
    /// What the program was built for: two registers of two doubles on any x86-64.
    Portable,
    /// Four doubles in a register.
    #[cfg(target_arch = "x86_64")]
    Avx2,
    /// Eight doubles in a register.
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

impl Instructions {
    /// Those that the processor has, the widest last.
    pub fn available() -> impl DoubleEndedIterator<Item = Self> {
        [
            Some(Self::Portable),
            #[cfg(target_arch = "x86_64")]
            Avx2::is_here().then_some(Self::Avx2),
            #[cfg(target_arch = "x86_64")]
            Avx512::is_here().then_some(Self::Avx512),
        ]
        .into_iter()
        .flatten()
    }

    /// The members in blocks that fill registers.
    pub(super) fn blocks<S, M>(self, members: &[Member<S>], step: S::Scalar) -> Box<dyn Blocks<S>>
    where
        S: Discretized<M> + 'static,
        M: 'static,
    {
        macro_rules! side {
            ($double:literal, $single:literal, $processor:ident) => {
                if const { size_of::<S::Scalar>() == size_of::<f64>() } {
                    Box::new(Side::<S, M, Lanes<S::Scalar, $double, $processor>>::new(members, step))
                } else {
                    Box::new(Side::<S, M, Lanes<S::Scalar, $single, $processor>>::new(members, step))
                }
            };
        }
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 if Avx512::is_here() => side!(8, 16, Avx512),
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 if Avx2::is_here() => side!(4, 8, Avx2),
            _ => side!(4, 8, Portable),
        }
    }
}

/// Blocks of members side by side.
struct Side<S: Discretized<M>, M, T: Batch>(Vec<Block<S, M, T>>);

impl<S, M, T> Side<S, M, T>
where
    S: Discretized<M>,
    T: Batch<Number = S::Scalar>,
{
    fn new(members: &[Member<S>], step: S::Scalar) -> Self {
        let blocks = members.chunks(T::LANES).enumerate();
        Self(blocks.map(|(index, members)| Block::new(index * T::LANES, members, step)).collect())
    }
}

impl<S, M, T> Blocks<S> for Side<S, M, T>
where
    S: Discretized<M>,
    T: Batch<Number = S::Scalar>,
{
    fn march(&mut self, clock: Clock, steps: u64) -> Marched {
        let march = |block: &mut Block<S, M, T>| T::outline(March { block, clock, steps });
        #[cfg(feature = "parallel")]
        let marched: Vec<Marched> = {
            use rayon::prelude::*;
            self.0.par_iter_mut().map(march).collect()
        };
        #[cfg(not(feature = "parallel"))]
        let marched: Vec<Marched> = self.0.iter_mut().map(march).collect();
        let mut all = Marched { failed: Vec::new(), member_steps: 0 };
        for mut marched in marched {
            all.failed.append(&mut marched.failed);
            all.member_steps += marched.member_steps;
        }
        all
    }

    fn width(&self) -> usize {
        T::LANES
    }

    fn is_alive(&self, member: usize) -> bool {
        let (block, lane) = (&self.0[member / T::LANES], member % T::LANES);
        matches!(block.lanes.as_ref()[lane], Lane::Alive)
    }

    fn state(&self, member: usize) -> S::StateComponents<S::Scalar> {
        let (block, lane) = (&self.0[member / T::LANES], member % T::LANES);
        match block.lanes.as_ref()[lane] {
            Lane::Failed(state) => state,
            Lane::Alive | Lane::Empty => taken::<T, _, _>(&block.state, lane),
        }
    }

    fn set_control(&mut self, member: usize, control: &S::ControlComponents<S::Scalar>) {
        let (block, lane) = (&mut self.0[member / T::LANES], member % T::LANES);
        put(&mut block.control, lane, control);
    }
}

/// A few members side by side.
struct Block<S: Discretized<M>, M, T: Batch> {
    method: S::Method<T>,
    parameters: S::Parameters<T>,
    step: T,
    state: S::StateComponents<T>,
    control: S::ControlComponents<T>,
    lanes: T::Each<Lane<S::StateComponents<S::Scalar>>>,
    /// The number of the first.
    first: usize,
    /// Whether the state is one that the method led to.
    known: bool,
}

/// What a lane is used for.
#[derive(Clone, Copy)]
enum Lane<C> {
    /// A member.
    Alive,
    /// A member that failed, with its last state. What is in the lane is a copy of a member that did not.
    Failed(C),
    /// No member: there were not enough of them. A copy too.
    Empty,
}

impl<S, M, T> Block<S, M, T>
where
    S: Discretized<M>,
    T: Batch<Number = S::Scalar>,
{
    /// At least one member, and at most as many as there are lanes.
    fn new(first: usize, members: &[Member<S>], step: S::Scalar) -> Self {
        let member = |lane: usize| &members[if lane < members.len() { lane } else { 0 }];
        let parameters = side_by_side(|lane| member(lane).0);
        let state = side_by_side(|lane| member(lane).1);
        let step = T::of(step.to_f64());
        Self {
            method: S::Method::new(&parameters, step),
            parameters,
            step,
            state,
            control: S::ControlComponents::from_fn(|_| T::of(0.0)),
            lanes: T::each(|lane| if lane < members.len() { Lane::Alive } else { Lane::Empty }),
            first,
            known: false,
        }
    }

    /// Members that failed stay where they are, and others take their lanes.
    #[cold]
    fn bury(&mut self, failure: &Failure<T, S::StateComponents<T>>, step: u64, failed: &mut Vec<Failed>) {
        let errors = failure.errors.as_ref();
        for (lane, error) in errors.iter().enumerate() {
            if let (Some(source), Lane::Alive) = (*error, self.lanes.as_ref()[lane]) {
                failed.push(Failed { member: self.first + lane, step, source });
                self.lanes.as_mut()[lane] = Lane::Failed(taken::<T, _, _>(&self.state, lane));
            }
        }
        let Some(other) = self.lanes.as_ref().iter().position(|lane| matches!(lane, Lane::Alive)) else {
            return;
        };
        self.state = failure.advanced.state;
        let mut memory = Vec::new();
        self.method.memory(&mut |piece| memory.extend_from_slice(piece));
        for (lane, _) in errors.iter().enumerate().filter(|(_, error)| error.is_some()) {
            let copy = |numbers: &mut [T]| {
                numbers.iter_mut().for_each(|number| number.set_lane(lane, number.lane(other)));
            };
            copy(&mut memory);
            copy(self.state.as_mut());
            copy(self.parameters.as_mut());
            copy(self.control.as_mut());
        }
        self.method = S::Method::new(&self.parameters, self.step);
        let mut memory = memory.into_iter();
        self.method.memory(&mut |piece| piece.iter_mut().zip(&mut memory).for_each(|(x, value)| *x = value));
    }
}

/// Steps of a block.
struct March<'a, S: Discretized<M>, M, T: Batch> {
    block: &'a mut Block<S, M, T>,
    clock: Clock,
    steps: u64,
}

impl<S, M, T> Work for March<'_, S, M, T>
where
    S: Discretized<M>,
    T: Batch<Number = S::Scalar>,
{
    type Result = Marched;

    #[inline(always)]
    fn done(self) -> Marched {
        let Self { block, clock, steps } = self;
        let alive = |lanes: &T::Each<Lane<_>>| {
            lanes.as_ref().iter().filter(|lane| matches!(lane, Lane::Alive)).count() as u64
        };
        let mut marched = Marched { failed: Vec::new(), member_steps: 0 };
        let mut members = alive(&block.lanes);
        let mut taken = 0;
        while taken < steps && members > 0 {
            // at no time in particular the step is not one like the last
            let known = block.known && clock.start.is_finite();
            if known {
                let now = Clock { taken: clock.taken + taken, ..clock };
                let together = block.method.march(&mut block.state, now, &block.control, steps - taken);
                taken += together.steps;
                marched.member_steps += together.steps * members;
                if taken == steps {
                    break;
                }
            }
            let time = T::of(clock.after(taken));
            taken += 1;
            match block.method.advance(&block.state, time, &block.control, known) {
                Ok(advanced) => block.state = advanced.state,
                Err(failure) => {
                    block.bury(&failure, clock.taken + taken, &mut marched.failed);
                    members = alive(&block.lanes);
                }
            }
            block.known = true;
            marched.member_steps += members;
        }
        marched
    }
}

/// One array of several.
fn side_by_side<T, C, L>(of: impl Fn(usize) -> C) -> L
where
    T: Batch,
    C: Components<T::Number>,
    L: Components<T>,
{
    let mut all = L::from_fn(|_| T::of(0.0));
    (0..T::LANES).for_each(|lane| put(&mut all, lane, &of(lane)));
    all
}

/// Puts an array into a lane.
fn put<T, C, L>(all: &mut L, lane: usize, one: &C)
where
    T: Batch,
    C: Components<T::Number>,
    L: Components<T>,
{
    for (numbers, number) in all.as_mut().iter_mut().zip(one.as_ref()) {
        numbers.set_lane(lane, *number);
    }
}

/// The array in a lane.
fn taken<T, C, L>(all: &L, lane: usize) -> C
where
    T: Batch,
    C: Components<T::Number>,
    L: Components<T>,
{
    C::from_fn(|k| all.as_ref()[k].lane(lane))
}
