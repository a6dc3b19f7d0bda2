//! Members of an ensemble side by side in the registers of the processor, each with steps of its own length.

use std::vec::Vec;

use super::{Adaptive, EXPLICIT, PowerSeries};
use crate::error::StepError;
use crate::run::Run;
use crate::scalar::instructions::Instructions;
use crate::scalar::simd::lanes::Lanes;
use crate::scalar::simd::processor::{Avx2, Avx512};
use crate::scalar::{Batch, Components as _, Real, Scalar};
use crate::stepper::report::{RunError, RunReport};
use crate::system::State;
use crate::system::length::{Checked, Length};
use crate::system::pace::Wanted;
use crate::system::series::{Advance, Heap, Series, Start};

/// Takes each member to a time, as if it were taken alone, to the last bit.
pub(super) fn some_to<S: PowerSeries>(
    members: &mut [(Adaptive<S>, S::State)],
    time: f64,
    instructions: Instructions,
) -> Vec<Result<RunReport, RunError>> {
    match instructions {
        Instructions::Avx512 if S::Scalar::IS_DOUBLE && Avx512::is_here() => {
            side_by_side::<S, Lanes<f64, 8, Avx512>>(members, time)
        }
        Instructions::Avx2 if S::Scalar::IS_DOUBLE && Avx2::is_here() => {
            side_by_side::<S, Lanes<f64, 4, Avx2>>(members, time)
        }
        _ => members.iter_mut().map(|(trajectory, state)| Run::new(trajectory, state).to(time)).collect(),
    }
}

fn side_by_side<S: PowerSeries, T: Batch<Number = f64>>(
    members: &mut [(Adaptive<S>, S::State)],
    time: f64,
) -> Vec<Result<RunReport, RunError>> {
    let mut reports = std::vec![Ok(RunReport::default()); members.len()];
    // those of one order are side by side; steps of one length are taken as a run takes them
    let (fixed, mut queue): (Vec<usize>, Vec<usize>) =
        (0..members.len()).partition(|&member| members[member].0.pace.fixed.is_some());
    for member in fixed {
        let (trajectory, state) = &mut members[member];
        reports[member] = Run::new(trajectory, state).to(time);
    }
    queue.sort_by_key(|&member| members[member].0.order());
    let mut rest = &queue[..];
    while let Some(&first) = rest.first() {
        let order = members[first].0.order();
        let count = rest.partition_point(|&member| members[member].0.order() <= order);
        let (queue, others) = rest.split_at(count);
        rest = others;
        let mut together = Together::<S, T> {
            members: &mut *members,
            reports: &mut reports,
            time,
            lanes: T::all(None),
            series: Series::new(order),
            parameters: S::Parameters::splat(T::of(0.0)),
            state: S::StateComponents::splat(T::of(0.0)),
            velocity: S::Velocity::splat(T::of(0.0)),
            now: T::of(0.0),
        };
        together.run(queue.iter().copied());
    }
    reports
}

/// A step of eight lanes takes as long as some two and a half by themselves: lanes pay where more than one in so many has a member.
const WORTH: usize = 3;

/// A member in a lane.
#[derive(Clone, Copy)]
struct Lane {
    member: usize,
    /// Its next step.
    wanted: Wanted,
}

/// Members side by side, and what their next steps start from.
struct Together<'m, S: PowerSeries, T: Batch> {
    members: &'m mut [(Adaptive<S>, S::State)],
    reports: &'m mut [Result<RunReport, RunError>],
    /// Where they are going.
    time: f64,
    lanes: T::Each<Option<Lane>>,
    series: Series<S, T, Heap>,
    parameters: S::Parameters<T>,
    state: S::StateComponents<T>,
    velocity: S::Velocity<T>,
    now: T,
}

impl<S: PowerSeries, T: Batch<Number = f64>> Together<'_, S, T> {
    /// Takes them all there, each in the next lane that is free.
    fn run(&mut self, mut queue: impl Iterator<Item = usize>) {
        loop {
            for lane in 0..T::LANES {
                while self.lanes.as_ref()[lane].is_none() {
                    let Some(member) = queue.next() else { break };
                    self.enter(lane, member);
                }
            }
            let left = self.lanes.as_ref().iter().flatten().count();
            if WORTH * left <= T::LANES {
                return self.finish();
            }
            self.step();
        }
    }

    /// Takes those that are left one by one.
    fn finish(&mut self) {
        for lane in 0..T::LANES {
            let Some(Lane { member, .. }) = self.lanes.as_ref()[lane] else { continue };
            self.leave(lane, member, None);
            let (trajectory, state) = &mut self.members[member];
            let rest = Run::new(trajectory, state).to(self.time);
            let Ok(before) = self.reports[member] else { continue };
            let whole = |rest: RunReport| {
                let mut whole = before;
                whole.add(&rest);
                whole
            };
            self.reports[member] = rest
                .map(whole)
                .map_err(|error| RunError::new(error.step, error.time, whole(error.report), error.cause));
        }
    }

    /// Puts a member into a lane, if it has a way to go.
    fn enter(&mut self, lane: usize, member: usize) {
        let (trajectory, state) = &self.members[member];
        Batch::put(self.parameters.as_mut(), lane, trajectory.system.to_parameters().as_ref());
        Batch::put(self.state.as_mut(), lane, state.to_components().as_ref());
        self.prepare(lane, member);
    }

    /// Makes ready for the next step from the state in a lane, if there is one.
    fn prepare(&mut self, lane: usize, member: usize) {
        let (trajectory, _) = &mut self.members[member];
        trajectory.pace.end = f64::INFINITY;
        let state = state_in::<S, T>(&self.state, lane);
        let next = match trajectory.pace.toward(self.time) {
            Ok(Some(wanted)) => trajectory.check(&state, &S::Control::default()).map(|()| Some(wanted)),
            other => other,
        };
        let now = S::Scalar::of(trajectory.time());
        self.now.set_lane(lane, now.to_f64());
        if S::Velocity::<T>::LENGTH > 0 {
            let velocity = trajectory.system.start_velocity(&state, now, &S::Control::default());
            Batch::put(self.velocity.as_mut(), lane, velocity.as_ref());
        }
        match next {
            Ok(Some(wanted)) => self.lanes.as_mut()[lane] = Some(Lane { member, wanted }),
            Ok(None) => self.leave(lane, member, None),
            Err(cause) => self.leave(lane, member, Some(cause)),
        }
    }

    /// Takes the member out of a lane, with the state that is there.
    fn leave(&mut self, lane: usize, member: usize, cause: Option<StepError>) {
        let (trajectory, state) = &mut self.members[member];
        *state = state_in::<S, T>(&self.state, lane);
        self.lanes.as_mut()[lane] = None;
        if let (Some(cause), Ok(report)) = (cause, self.reports[member]) {
            let (step, time) = (trajectory.steps_taken() + 1, trajectory.time());
            self.reports[member] = Err(RunError::new(step, time, report, cause));
        }
    }

    /// Takes a step of each member.
    fn step(&mut self) {
        let (mut before, mut length) = (T::all(None), T::all(Length::Exactly(0.0)));
        for (lane, taken) in self.lanes.as_ref().iter().enumerate() {
            let Some(taken) = taken else { continue };
            before.as_mut()[lane] = self.members[taken.member].0.pace.begin();
            length.as_mut()[lane] = taken.wanted.length;
        }
        let start = Start {
            parameters: &self.parameters,
            state: &self.state,
            time: self.now,
            control: &S::ControlComponents::splat(T::of(0.0)),
            velocity: &self.velocity,
            input: None,
        };
        let advance = Advance { series: &mut self.series, start, before, length };
        let (Checked { steps, shares }, next) = T::dispatch_wide(advance);
        for lane in 0..T::LANES {
            let Some(Lane { member, wanted }) = self.lanes.as_ref()[lane] else { continue };
            let is_finite = next.as_ref().iter().all(|x| Batch::is_finite(x.lane(lane)));
            let (trajectory, _) = &mut self.members[member];
            let step = (steps.as_ref()[lane], shares.as_ref()[lane]);
            if let Err(cause) = trajectory.pace.took(step, is_finite, wanted.end) {
                self.leave(lane, member, Some(cause));
                continue;
            }
            if let Ok(report) = &mut self.reports[member] {
                report.count(&EXPLICIT);
            }
            for (to, from) in self.state.as_mut().iter_mut().zip(next.as_ref()) {
                to.set_lane(lane, from.lane(lane));
            }
            self.prepare(lane, member);
            if self.lanes.as_ref()[lane].is_none() {
                self.members[member].0.series.take_lane(&self.series, lane);
            }
        }
    }
}

/// The state in a lane.
fn state_in<S: PowerSeries, T: Batch<Number = f64>>(state: &S::StateComponents<T>, lane: usize) -> S::State {
    let mut one = S::StateComponents::splat(S::Scalar::of(0.0));
    for (to, from) in one.as_mut().iter_mut().zip(state.as_ref()) {
        *to = S::Scalar::of(from.lane(lane));
    }
    S::State::from_components(&one)
}
