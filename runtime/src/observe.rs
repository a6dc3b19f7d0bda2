//! Observers: what observes a [`Run`](crate::run::Run), and may end it.
//!
//! Any type with an [`Observer`] implementation can observe a run. Observers combine: a tuple shows every tick to both of its
//! members, an `Option` only to what it holds; [`Run::observe_every`](crate::run::Run::observe_every) shows every n-th tick.

use core::fmt;
use core::ops::ControlFlow;

use crate::scalar::{Batch, Real, Scalar};
use crate::system::{Dynamics, System};
use crate::tick::Tick;

/// Observes a run.
pub trait Observer<S: Dynamics + ?Sized> {
    /// Looks at one tick. [`ControlFlow::Break`] ends the run there.
    fn observe(&mut self, tick: &Tick<'_, S>) -> ControlFlow<()>;
    /// Returns the index of the next tick after `index` that it needs; it may be shown others, too. Ticks that no observer needs are not shown, but
    /// the last one of a run, and steps to them are taken [together](crate::stepper::Stepper::steps_with) where the control is constant.
    #[inline]
    fn next(&self, index: u64) -> u64 {
        index + 1
    }
}

impl<S: Dynamics + ?Sized, O: Observer<S> + ?Sized> Observer<S> for &mut O {
    #[inline]
    fn observe(&mut self, tick: &Tick<'_, S>) -> ControlFlow<()> {
        (**self).observe(tick)
    }
    #[inline]
    fn next(&self, index: u64) -> u64 {
        (**self).next(index)
    }
}

/// No observer.
impl<S: Dynamics + ?Sized> Observer<S> for () {
    #[inline]
    fn observe(&mut self, _: &Tick<'_, S>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
    #[inline]
    fn next(&self, _: u64) -> u64 {
        u64::MAX
    }
}

/// Both see every tick, also when the first ends the run.
impl<S: Dynamics + ?Sized, A: Observer<S>, B: Observer<S>> Observer<S> for (A, B) {
    #[inline]
    fn observe(&mut self, tick: &Tick<'_, S>) -> ControlFlow<()> {
        let first = self.0.observe(tick);
        let second = self.1.observe(tick);
        if first.is_break() { first } else { second }
    }
    #[inline]
    fn next(&self, index: u64) -> u64 {
        self.0.next(index).min(self.1.next(index))
    }
}

impl<S: Dynamics + ?Sized, O: Observer<S>> Observer<S> for Option<O> {
    #[inline]
    fn observe(&mut self, tick: &Tick<'_, S>) -> ControlFlow<()> {
        self.as_mut().map_or(ControlFlow::Continue(()), |observer| observer.observe(tick))
    }
    #[inline]
    fn next(&self, index: u64) -> u64 {
        self.as_ref().map_or(u64::MAX, |observer| observer.next(index))
    }
}

#[doc(hidden)]
/// Calls a closure at every tick: [`Run::each`](crate::run::Run::each).
#[derive(Clone, Copy, Debug)]
pub struct Each<F>(pub F);

impl<S: Dynamics + ?Sized, F: FnMut(&Tick<'_, S>)> Observer<S> for Each<F> {
    #[inline]
    fn observe(&mut self, tick: &Tick<'_, S>) -> ControlFlow<()> {
        (self.0)(tick);
        ControlFlow::Continue(())
    }
}

#[doc(hidden)]
/// Ends the run at the first tick for which a closure says so: [`Run::until`](crate::run::Run::until).
#[derive(Clone, Copy, Debug)]
pub struct Until<F>(pub F);

impl<S: Dynamics + ?Sized, F: FnMut(&Tick<'_, S>) -> bool> Observer<S> for Until<F> {
    #[inline]
    fn observe(&mut self, tick: &Tick<'_, S>) -> ControlFlow<()> {
        if (self.0)(tick) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

#[doc(hidden)]
/// Shows only every n-th tick to another observer, the initial state included.
#[derive(Clone, Copy, Debug)]
pub struct Every<O> {
    interval: u64,
    observer: O,
}

impl<O> Every<O> {
    /// Shows ticks 0, `interval`, 2 `interval`, … to `observer`; an interval of 0 counts as 1.
    pub fn new(interval: u64, observer: O) -> Self {
        Self { interval: interval.max(1), observer }
    }
}

impl<S: Dynamics + ?Sized, O: Observer<S>> Observer<S> for Every<O> {
    #[inline]
    fn observe(&mut self, tick: &Tick<'_, S>) -> ControlFlow<()> {
        if tick.index.is_multiple_of(self.interval) {
            self.observer.observe(tick)
        } else {
            ControlFlow::Continue(())
        }
    }
    #[inline]
    fn next(&self, index: u64) -> u64 {
        next_multiple(index, self.interval)
    }
}

/// The multiple of an interval after an index.
#[inline]
fn next_multiple(index: u64, interval: u64) -> u64 {
    (index / interval + 1).saturating_mul(interval)
}

/// Measures how well energy and Casimirs are kept, against the first state it sees.
///
/// Energy is that of the tick's time, with all controls zero. Only where the system is [`AUTONOMOUS`](System::AUTONOMOUS), and no energy names a
/// control, is its change an error of the scheme; elsewhere it is part of the motion.
///
/// Shown a second run, it goes on with the same reference: a long run may be made in pieces.
pub struct Invariants<S: System> {
    reference: Option<Reference<S::Scalar, S::Casimirs>>,
    energy_error: f64,
}

#[derive(Clone)]
struct Reference<T, C> {
    energy: T,
    casimirs: C,
    drifts: C,
}

impl<S: System> Invariants<S> {
    /// Has seen nothing yet.
    pub fn new() -> Self {
        Self { reference: None, energy_error: 0.0 }
    }

    /// The energy of the first state; none before it was seen.
    pub fn initial_energy(&self) -> Option<S::Scalar> {
        self.reference.as_ref().map(|reference| reference.energy)
    }

    /// The largest distance of the energy from its initial value; not-a-number once the energy was.
    pub fn energy_error(&self) -> f64 {
        self.energy_error
    }

    /// The Casimirs of the first state, in the order of [`System::CASIMIRS`]; empty before it was seen.
    pub fn initial_casimirs(&self) -> &[S::Scalar] {
        self.reference.as_ref().map_or(&[], |reference| reference.casimirs.as_ref())
    }

    /// The largest distance of each Casimir from its initial value; empty before anything was seen.
    pub fn casimir_drifts(&self) -> &[S::Scalar] {
        self.reference.as_ref().map_or(&[], |reference| reference.drifts.as_ref())
    }
}

impl<S: System> Observer<S> for Invariants<S> {
    fn observe(&mut self, tick: &Tick<'_, S>) -> ControlFlow<()> {
        let energy = tick.system.energy_at(tick.state, S::Scalar::of(tick.time), &S::Control::default());
        let casimirs = tick.system.casimirs(tick.state);
        let reference = self.reference.get_or_insert_with(|| {
            let mut drifts = casimirs;
            drifts.as_mut().fill(S::Scalar::of(0.0));
            Reference { energy, casimirs, drifts }
        });
        self.energy_error = larger(self.energy_error, (energy - reference.energy).abs().to_f64());
        let values = casimirs.as_ref().iter().zip(reference.casimirs.as_ref());
        for (drift, (now, initially)) in reference.drifts.as_mut().iter_mut().zip(values) {
            *drift = larger(*drift, (*now - *initially).abs());
        }
        ControlFlow::Continue(())
    }
}

/// The larger of the two; not-a-number if either is.
fn larger<T: PartialOrd + Copy>(so_far: T, value: T) -> T {
    // a comparison with not-a-number is false: the first keeps one that came earlier, the second takes a new one
    #[allow(clippy::eq_op)]
    if so_far != so_far || value <= so_far { so_far } else { value }
}

impl<S: System> Default for Invariants<S> {
    fn default() -> Self {
        Self::new()
    }
}

impl<S: System> Clone for Invariants<S> {
    fn clone(&self) -> Self {
        Self { reference: self.reference.clone(), energy_error: self.energy_error }
    }
}

impl<S: System> fmt::Debug for Invariants<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Invariants")
            .field("energy_error", &self.energy_error)
            .field("casimir_drifts", &self.casimir_drifts())
            .finish_non_exhaustive()
    }
}

#[cfg(feature = "std")]
pub use record::Record;

#[cfg(feature = "std")]
mod record {
    use super::{ControlFlow, Dynamics, Observer, Tick, fmt};
    use std::vec::Vec;

    /// Keeps every n-th state with its time, the initial one included.
    pub struct Record<S: Dynamics + ?Sized> {
        interval: u64,
        times: Vec<f64>,
        states: Vec<S::State>,
    }

    impl<S: Dynamics + ?Sized> Record<S> {
        /// Keeps the states of ticks 0, `interval`, 2 `interval`, …; an interval of 0 counts as 1.
        pub fn every(interval: u64) -> Self {
            Self { interval: interval.max(1), times: Vec::new(), states: Vec::new() }
        }

        /// The times, in order.
        pub fn times(&self) -> &[f64] {
            &self.times
        }

        /// The states, in order.
        pub fn states(&self) -> &[S::State] {
            &self.states
        }

        /// Times and states together.
        pub fn iter(&self) -> impl ExactSizeIterator<Item = (f64, &S::State)> {
            self.times.iter().copied().zip(&self.states)
        }
    }

    impl<S: Dynamics + ?Sized> Observer<S> for Record<S> {
        fn observe(&mut self, tick: &Tick<'_, S>) -> ControlFlow<()> {
            if tick.index.is_multiple_of(self.interval) {
                self.times.push(tick.time);
                self.states.push(tick.state.clone());
            }
            ControlFlow::Continue(())
        }
        fn next(&self, index: u64) -> u64 {
            super::next_multiple(index, self.interval)
        }
    }

    impl<S: Dynamics + ?Sized> Clone for Record<S> {
        fn clone(&self) -> Self {
            Self { interval: self.interval, times: self.times.clone(), states: self.states.clone() }
        }
    }

    impl<S: Dynamics + ?Sized> fmt::Debug for Record<S> {
        fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.debug_struct("Record")
                .field("interval", &self.interval)
                .field("times", &self.times)
                .field("states", &self.states)
                .finish()
        }
    }
}

#[cfg(all(test, feature = "std"))]
mod tests {
    use super::*;
    use crate::retraction::Cayley;
    use crate::run::Run;
    use crate::tests::{Body, BodyState};
    use nalgebra::{UnitQuaternion, Vector3};
    use std::vec::Vec;

    fn body() -> Body {
        Body { inertia: Vector3::new(1.0, 2.0, 3.0) }
    }

    fn start() -> BodyState {
        BodyState { attitude: UnitQuaternion::identity(), momentum: Vector3::new(0.3, -0.5, 0.8) }
    }

    fn run<O: Observer<Body>>(observer: O, steps: u64) {
        let mut state = start();
        let mut stepper = body().stepper::<Cayley>(0.1).expect("valid");
        Run::new(&mut stepper, &mut state).observe(observer).steps(steps).expect("solvable");
    }

    #[test]
    fn a_record_keeps_every_nth_state() {
        let mut all = Record::every(1);
        let mut some = Record::every(4);
        let mut zero = Record::every(0);
        run((&mut all, (&mut some, &mut zero)), 10);
        assert_eq!(all.times().len(), 11);
        assert_eq!(all.states()[0], start());
        assert_eq!(some.times(), [0.0, 0.4, 0.8]);
        assert_eq!(some.states(), [all.states()[0], all.states()[4], all.states()[8]]);
        assert_eq!(zero.states(), all.states());
        assert_eq!(some.iter().map(|(time, _)| time).collect::<Vec<_>>(), some.times());
    }

    #[test]
    fn invariants_are_measured_against_the_first_state() {
        let mut record = Record::every(1);
        let mut invariants = Invariants::new();
        assert_eq!(invariants.initial_energy(), None);
        assert!(invariants.casimir_drifts().is_empty() && invariants.initial_casimirs().is_empty());
        run((&mut record, &mut invariants), 200);

        let energies: Vec<f64> = record.states().iter().map(|state| body().energy(state)).collect();
        let casimirs: Vec<f64> = record.states().iter().map(|state| body().casimirs(state)[0]).collect();
        let largest = |values: &[f64]| values.iter().map(|x| (x - values[0]).abs()).fold(0.0, f64::max);
        assert_eq!(invariants.initial_energy(), Some(energies[0]));
        assert_eq!(invariants.initial_casimirs(), [casimirs[0]]);
        assert_eq!(invariants.energy_error(), largest(&energies));
        assert_eq!(invariants.casimir_drifts(), [largest(&casimirs)]);
        // the motion does exchange energy with the scheme's error, and does keep the Casimir
        assert!(invariants.energy_error() > 1e-9 && invariants.energy_error() < 1e-3);
        assert!(invariants.casimir_drifts()[0] < 1e-13);
    }

    #[test]
    fn a_run_in_pieces_keeps_its_reference() {
        let mut whole = Invariants::new();
        run(&mut whole, 100);

        let mut pieces = Invariants::new();
        let mut state = start();
        let mut stepper = body().stepper::<Cayley>(0.1).expect("valid");
        for _ in 0..4 {
            Run::new(&mut stepper, &mut state).observe(&mut pieces).steps(25).expect("solvable");
        }
        assert_eq!(pieces.initial_energy(), whole.initial_energy());
        assert_eq!(pieces.energy_error(), whole.energy_error());
    }

    #[test]
    fn not_a_number_is_kept_as_the_largest() {
        assert!(larger(larger(1.0, f64::NAN), 2.0_f64).is_nan());
        assert!(larger(f64::NAN, 2.0).is_nan());
        assert_eq!(larger(1.0, 2.0), 2.0);
        assert_eq!(larger(2.0, 1.0), 2.0);
    }

    #[test]
    fn observers_combine() {
        let mut every = Vec::new();
        let mut optional = 0;
        let mut absent = 0;
        run(
            (
                Every::new(3, Each(|tick: &Tick<'_, Body>| every.push(tick.index))),
                (
                    Some(Each(|_: &Tick<'_, Body>| optional += 1)),
                    (
                        None::<Each<fn(&Tick<'_, Body>)>>,
                        Every::new(0, Each(|_: &Tick<'_, Body>| absent += 1)),
                    ),
                ),
            ),
            7,
        );
        assert_eq!(every, [0, 3, 6]);
        assert_eq!(optional, 8);
        assert_eq!(absent, 8);
    }

    #[test]
    fn all_see_the_tick_that_ends_the_run() {
        let mut before = 0;
        let mut after = 0;
        let mut state = start();
        let mut stepper = body().stepper::<Cayley>(0.1).expect("valid");
        let report = Run::new(&mut stepper, &mut state)
            .each(|_| before += 1)
            .until(|tick| tick.index == 3)
            .every(1, |_| after += 1)
            .steps(10)
            .expect("solvable");
        assert_eq!((before, after, report.steps, report.stopped), (4, 4, 3, true));
    }
}
