//! A few states of a run, however long it is.

use super::Sample;
use serde::{Deserialize, Serialize};

/// As many are kept at most.
const MOST: usize = 32;

/// States along a run, with their times: of all that are shown those after a multiple of steps, which is doubled when there are too many.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct SomeStates {
    doublings: u32,
    /// Each behind the number of steps before.
    kept: Vec<(u64, f64, Vec<f64>)>,
}

impl SomeStates {
    /// Adds a sample of the run, or leaves it out.
    pub(crate) fn push(&mut self, sample: &Sample<'_>) {
        let is_due = |index: u64, doublings: u32| index.is_multiple_of(1 << doublings);
        if !is_due(sample.index, self.doublings) {
            return;
        }
        self.kept.push((sample.index, sample.time, sample.state.to_vec()));
        while self.kept.len() > MOST {
            self.doublings += 1;
            self.kept.retain(|(index, ..)| is_due(*index, self.doublings));
        }
    }

    /// Those that are left.
    pub(crate) fn states(&self) -> impl Iterator<Item = (f64, Vec<f64>)> {
        self.kept.iter().map(|(_, time, state)| (*time, state.clone()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn they_are_few_and_from_all_of_the_run() {
        for (steps, every) in [(0_u64, 1_u64), (20, 1), (1_000, 1), (5_000, 10), (100_000, 1024)] {
            let mut some = SomeStates::default();
            for index in (0..=steps).filter(|index| index.is_multiple_of(every)) {
                let sample = Sample { index, time: index as f64, ..Sample::of_state(&[1.0]) };
                some.push(&sample);
            }
            let times: Vec<f64> = some.states().map(|(time, _)| time).collect();
            let seen = (steps / every + 1) as usize;
            assert!(times.len() <= MOST && times.len() >= seen.min(MOST / 4), "{steps}: {times:?}");
            assert_eq!(times[0], 0.0);
            assert!(times.last() >= Some(&(0.7 * steps as f64)), "{steps}: {times:?}");
        }
    }
}
