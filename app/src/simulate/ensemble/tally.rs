//! What is known of members that have been run.

use coadjoint::ensemble::Statistics;
use rayon::prelude::*;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::{Block, EnsembleSpec, EnsembleSummary, Failure};
use crate::catalogue::{Entry, Setup};

/// What is known of some members of an ensemble, whatever their order: merged, it is that of all.
#[derive(Clone, Debug, PartialEq)]
pub struct Tally {
    members: u64,
    member_steps: u64,
    failures: u64,
    /// The first that failed, by their numbers.
    failed: Vec<Failure>,
    /// For each number that was drawn the least and the greatest.
    drawn: Vec<(f64, f64)>,
    /// For each look and each quantity.
    statistics: Vec<Statistics>,
}

/// The byte form.
#[derive(Serialize, Deserialize)]
struct Saved {
    members: u64,
    member_steps: u64,
    failures: u64,
    failed: Vec<Failure>,
    drawn: Vec<(f64, f64)>,
    statistics: Vec<Bytes>,
}

/// Bytes that are written and read in one piece: as a list they would be one by one.
pub(crate) struct Bytes(pub(crate) Vec<u8>);

impl Serialize for Bytes {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.serialize_bytes(&self.0)
    }
}

impl<'de> Deserialize<'de> for Bytes {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        <&[u8]>::deserialize(from).map(|bytes| Self(bytes.to_vec()))
    }
}

impl Tally {
    /// Failed members that are told by name.
    pub(crate) const FIRST: usize = 3;

    /// Of no members yet.
    pub(crate) fn new(spec: &EnsembleSpec, entry: &Entry, setup: &Setup, quantities: usize) -> Self {
        let drawn = spec.variation.ranges(entry, setup).finish().iter().map(|drawn| drawn.range).collect();
        let statistics = vec![Statistics::default(); spec.looks().count() * quantities];
        Self { members: 0, member_steps: 0, failures: 0, failed: Vec::new(), drawn, statistics }
    }

    /// How many members have been run.
    pub fn members(&self) -> u64 {
        self.members
    }

    /// Adds a block.
    pub(crate) fn add(&mut self, block: &Block) {
        let Block { range, values, end } = block;
        self.members += range.len() as u64;
        self.member_steps += end.member_steps;
        self.fail(end.failed.len() as u64, &end.failed);
        self.widen(end.drawn.iter().map(|drawn| drawn.range));
        self.statistics.par_iter_mut().zip(values).for_each(|(statistics, values)| {
            statistics.merge(&Statistics::of(values.iter().copied()));
        });
    }

    /// Adds what is known of other members of the same ensemble.
    pub fn merge(&mut self, other: &Self) {
        self.members += other.members;
        self.member_steps += other.member_steps;
        self.fail(other.failures, &other.failed);
        self.widen(other.drawn.iter().copied());
        let both = self.statistics.par_iter_mut().zip(&other.statistics);
        both.for_each(|(statistics, other)| statistics.merge(other));
    }

    fn fail(&mut self, failures: u64, first: &[Failure]) {
        self.failures += failures;
        self.failed.extend_from_slice(first);
        self.failed.sort_by_key(|failure| failure.member);
        self.failed.truncate(Self::FIRST);
    }

    fn widen(&mut self, ranges: impl Iterator<Item = (f64, f64)>) {
        for (range, other) in self.drawn.iter_mut().zip(ranges) {
            // of the two zeros the one that is not negative, whatever the order
            *range = (range.0.min(other.0) + 0.0, range.1.max(other.1) + 0.0);
        }
    }

    /// Writes it: of the same members always the same bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        let Self { members, member_steps, failures, failed, drawn, statistics } = self;
        let saved = Saved {
            members: *members,
            member_steps: *member_steps,
            failures: *failures,
            failed: failed.clone(),
            drawn: drawn.clone(),
            statistics: statistics.par_iter().map(|statistics| Bytes(statistics.to_bytes())).collect(),
        };
        // writing to memory does not fail
        postcard::to_stdvec(&saved).unwrap_or_default()
    }

    /// Reads what [`to_bytes`](Self::to_bytes) wrote; none if that is not what these bytes are.
    pub fn from_bytes(bytes: &[u8]) -> Option<Self> {
        let Saved { members, member_steps, failures, failed, drawn, statistics } =
            postcard::from_bytes(bytes).ok()?;
        let statistics =
            statistics.par_iter().map(|bytes| Statistics::from_bytes(&bytes.0)).collect::<Option<_>>()?;
        Some(Self { members, member_steps, failures, failed, drawn, statistics })
    }

    /// Tells whether another one is of the same quantities at as many looks.
    pub(crate) fn is_alike(&self, other: &Self) -> bool {
        (self.drawn.len(), self.statistics.len()) == (other.drawn.len(), other.statistics.len())
    }

    /// Sums it up, with how many members were stepped side by side and how long that took.
    pub(crate) fn summary(
        self,
        spec: &EnsembleSpec,
        entry: &Entry,
        setup: &Setup,
        (width, seconds): (usize, f64),
    ) -> EnsembleSummary {
        let Self { members, member_steps, failures, failed, drawn: ranges, statistics } = self;
        let mut drawn = spec.variation.ranges(entry, setup).finish();
        drawn.iter_mut().zip(ranges).for_each(|(drawn, range)| drawn.range = range);
        let times: Vec<f64> = spec.looks().map(|taken| taken as f64 * spec.job.step).collect();
        let quantities = statistics.len() / times.len().max(1);
        let quantile_error = statistics.iter().map(Statistics::relative_error).fold(0.0, f64::max);
        let found: Vec<_> = statistics
            .par_iter()
            .enumerate()
            .map(|(k, statistics)| statistics.spread(times[k / quantities.max(1)]))
            .collect();
        let of = |quantity| found.iter().skip(quantity).step_by(quantities.max(1)).copied().collect();
        let spreads = (0..quantities).map(of).collect();
        EnsembleSummary {
            spreads,
            drawn,
            quantile_error,
            failures,
            failed,
            members,
            member_steps,
            width,
            seconds,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_in_one_piece_are_those_one_by_one() {
        for length in [0, 1, 127, 128, 100_000] {
            let list: Vec<u8> = (0..length).map(|k: u32| k as u8).collect();
            let written = postcard::to_stdvec(&Bytes(list.clone())).expect("in memory");
            assert_eq!(written, postcard::to_stdvec(&list).expect("in memory"));
            assert_eq!(postcard::from_bytes::<Bytes>(&written).expect("what was written").0, list);
            assert!(postcard::from_bytes::<Bytes>(&written[..written.len() - 1]).is_err());
        }
    }
}
