//! What observers are shown.

use core::fmt;

use crate::stepper::StepReport;
use crate::system::Dynamics;

/// One moment of a run: the initial state, or the state after a step.
#[non_exhaustive]
pub struct Tick<'a, S: Dynamics + ?Sized> {
    /// Steps taken so far; 0 for the initial state.
    pub index: u64,
    /// The run's start plus `index` steps, in f64 whatever the scalar: not accumulated, so that it does not drift.
    pub time: f64,
    /// The system that moves.
    pub system: &'a S,
    /// Its state at this time.
    pub state: &'a S::State,
    /// How the step that led here went; none for the initial state.
    pub report: Option<StepReport>,
    /// The control held over the step that led here; none for the initial state.
    pub control: Option<&'a S::Control>,
    #[cfg(feature = "std")]
    pub(crate) snapshot: Option<&'a dyn Fn() -> std::vec::Vec<f64>>,
}

impl<'a, S: Dynamics + ?Sized> Tick<'a, S> {
    /// A moment that no run led to: an observer can be tested with it alone.
    ///
    /// ```
    /// use coadjoint::prelude::*;
    /// use coadjoint::{Invariants, Observer, Tick};
    ///
    /// #[lie_poisson_system(group = SO3)]
    /// struct Body {
    ///     #[inertia]
    ///     inertia: Vector3<f64>,
    /// }
    ///
    /// let body = Body { inertia: vector![1.0, 2.0, 2.5] };
    /// let mut state = BodyState { attitude: UnitQuaternion::identity(), momentum: vector![1.0, 0.0, 0.0] };
    /// let mut invariants = Invariants::new();
    /// invariants.observe(&Tick::new(&body, 0, 0.0, &state));
    /// state.momentum.x = 2.0;
    /// invariants.observe(&Tick::new(&body, 1, 0.1, &state));
    /// assert_eq!(invariants.energy_error(), 1.5);
    /// ```
    pub fn new(system: &'a S, index: u64, time: f64, state: &'a S::State) -> Self {
        let (report, control) = (None, None);
        Self {
            index,
            time,
            system,
            state,
            report,
            control,
            #[cfg(feature = "std")]
            snapshot: None,
        }
    }
}

#[cfg(feature = "std")]
impl<S: Dynamics + ?Sized> Tick<'_, S> {
    /// What the stepper carries at this moment: written down with the state, the run can go on from here later, to the last bit the same.
    /// See [`Stepper::snapshot`](crate::Stepper::snapshot). Empty if no run led here.
    pub fn snapshot(&self) -> std::vec::Vec<f64> {
        self.snapshot.map_or_else(std::vec::Vec::new, |snapshot| snapshot())
    }
}

impl<S: Dynamics + ?Sized> fmt::Debug for Tick<'_, S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Tick")
            .field("index", &self.index)
            .field("time", &self.time)
            .field("state", self.state)
            .field("report", &self.report)
            .finish_non_exhaustive()
    }
}

impl<S: Dynamics + ?Sized> Clone for Tick<'_, S> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<S: Dynamics + ?Sized> Copy for Tick<'_, S> {}
