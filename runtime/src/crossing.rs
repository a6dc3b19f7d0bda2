//! Which zeros of a quantity count: what is said of an event before anything moves.

/// How a quantity meets zero, in the direction of the run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Crossing {
    /// From below to above.
    Rising,
    /// From above to below.
    Falling,
    /// It touches zero but for rounding, and does not change its sign.
    Touch,
}

/// How a quantity is watched: which zeros count, whether they end the run, and how closely one looks.
///
/// A zero is found where values of different signs are seen. They are looked at where steps end, and where the parabola through the last of these does
/// not tell that there is one zero or none in between, at four points within the step. Whatever has two zeros between two of these points, and at
/// them no dip towards zero, can be missed: [`points`](Self::points) says how many to look at in every step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use = "`Run::event` watches it"]
pub struct Event {
    only: Option<Crossing>,
    pub(crate) is_terminal: bool,
    pub(crate) points: Option<u32>,
}

impl Event {
    /// Every zero counts, also where the quantity touches zero and does not change its sign.
    pub const fn any() -> Self {
        Self { only: None, is_terminal: false, points: None }
    }

    /// Zeros count that the quantity passes from below to above, in the direction of the run.
    pub const fn rising() -> Self {
        Self { only: Some(Crossing::Rising), ..Self::any() }
    }

    /// Zeros count that the quantity passes from above to below, in the direction of the run.
    pub const fn falling() -> Self {
        Self { only: Some(Crossing::Falling), ..Self::any() }
    }

    /// The run ends at the first of them: state and stepper are then at that moment, and a next run goes on from there.
    pub const fn terminal(self) -> Self {
        Self { is_terminal: true, ..self }
    }

    /// Looks at so many points within every step, evenly spaced, whatever the values at its ends; 0 for the ends alone, 64 at most. To look at
    /// one of them takes as long as a step from a new state.
    pub const fn points(self, points: u32) -> Self {
        let points = if points > MOST_POINTS { MOST_POINTS } else { points };
        Self { points: Some(points), ..self }
    }

    pub(crate) fn counts(&self, crossing: Crossing) -> bool {
        self.only.is_none_or(|only| only == crossing)
    }
}

/// Points within a step, at most.
pub(crate) const MOST_POINTS: u32 = 64;
