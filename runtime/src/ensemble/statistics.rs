//! What is known of a quantity over many members, from parts in any order.

use std::vec::Vec;

use super::Spread;
use super::exact::{ExactSum, moments};
use super::sketch::{Sketch, read_number, write_number};

/// How a quantity is distributed over members that come in parts: blocks of an ensemble, shards of it, ranks of a
/// cluster.
///
/// Parts are [merged](Self::merge) in any order, to the same [bytes](Self::to_bytes). Mean and variance are the exact
/// ones, rounded once. Quantiles are exact for as long as there are no more than 4,096 different values, and thereafter
/// off by at most [`relative_error`](Self::relative_error) of their size; least and greatest value stay exact.
///
/// ```
/// use coadjoint::ensemble::Statistics;
///
/// let all = Statistics::of([1e100, 3.0, -1e100, 5.0]);
/// let mut merged = Statistics::of([-1e100, 5.0]);
/// let sent = Statistics::of([1e100, 3.0]).to_bytes();
/// merged.merge(&Statistics::from_bytes(&sent).expect("what was written"));
/// assert_eq!(merged.to_bytes(), all.to_bytes());
/// assert_eq!(merged.spread(0.0).mean, 2.0);
/// ```
#[derive(Clone, PartialEq)]
pub struct Statistics {
    members: u64,
    /// Values of −∞ and ∞ among them, which no sum holds.
    infinite: [u64; 2],
    sum: ExactSum,
    squares: ExactSum,
    least: f64,
    greatest: f64,
    sketch: Sketch,
}

impl Default for Statistics {
    fn default() -> Self {
        Self::of([])
    }
}

impl Statistics {
    /// Of these values; not-a-number is left out.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Self {
        Self::of_numbers(values.into_iter().filter(|value| !value.is_nan()).collect())
    }

    // not generic, so that it is compiled in this crate
    fn of_numbers(mut values: Vec<f64>) -> Self {
        values.sort_unstable_by(f64::total_cmp);
        let (mut sum, mut squares, mut infinite) = (ExactSum::ZERO, ExactSum::ZERO, [0; 2]);
        for &value in &values {
            if value.is_finite() {
                sum.add(value);
                squares.add_square(value);
            } else {
                infinite[usize::from(value > 0.0)] += 1;
            }
        }
        sum.carry();
        squares.carry();
        Self {
            members: values.len() as u64,
            infinite,
            sum,
            squares,
            least: values.first().copied().unwrap_or(f64::INFINITY),
            greatest: values.last().copied().unwrap_or(f64::NEG_INFINITY),
            sketch: Sketch::of_sorted(&values),
        }
    }

    /// Adds what is known of other members.
    pub fn merge(&mut self, other: &Self) {
        self.members += other.members;
        self.infinite[0] += other.infinite[0];
        self.infinite[1] += other.infinite[1];
        self.sum.merge(&other.sum);
        self.squares.merge(&other.squares);
        self.least = [self.least, other.least].into_iter().min_by(f64::total_cmp).unwrap_or(self.least);
        self.greatest =
            [self.greatest, other.greatest].into_iter().max_by(f64::total_cmp).unwrap_or(self.greatest);
        self.sketch.merge(&other.sketch);
    }

    /// How many values there are.
    pub fn members(&self) -> u64 {
        self.members
    }

    /// How far a quantile may be off, relative to the size of the values next to it; 0 where they are exact.
    pub fn relative_error(&self) -> f64 {
        self.sketch.relative_error()
    }

    /// The distribution, as at this time.
    pub fn spread(&self, time: f64) -> Spread {
        let members = usize::try_from(self.members).unwrap_or(usize::MAX);
        if members == 0 {
            return Spread::of(time, &mut []);
        }
        let (mean, deviation) = match self.infinite {
            [0, 0] => {
                let (mean, variance) = moments(self.members, &self.sum, &self.squares);
                (mean, variance.sqrt())
            }
            [_, 0] => (f64::NEG_INFINITY, f64::NAN),
            [0, _] => (f64::INFINITY, f64::NAN),
            _ => (f64::NAN, f64::NAN),
        };
        let last = self.members - 1;
        // between two values in proportion, as of values that are all there
        let quantile = |level: f64| match level {
            0.0 => self.least,
            1.0 => self.greatest,
            _ => {
                let place = level * last as f64;
                let part = place.fract();
                let at = |place: u64| self.sketch.at(place).clamp(self.least, self.greatest);
                let (below, above) = (at(place as u64), at((place as u64 + 1).min(last)));
                if part == 0.0 || below == above { below } else { below + part * (above - below) }
            }
        };
        Spread { time, members, mean, deviation, quantiles: Spread::LEVELS.map(quantile) }
    }

    /// Writes what is known; of the same members always the same bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        for number in [self.members, self.infinite[0], self.infinite[1]] {
            write_number(&mut bytes, number);
        }
        bytes.extend([self.least, self.greatest].iter().flat_map(|value| value.to_bits().to_le_bytes()));
        self.sum.write(&mut bytes);
        self.squares.write(&mut bytes);
        self.sketch.write(&mut bytes);
        bytes
    }

    /// Reads what [`to_bytes`](Self::to_bytes) wrote; none if that is not what these bytes are.
    pub fn from_bytes(mut bytes: &[u8]) -> Option<Self> {
        let from = &mut bytes;
        let (members, infinite) = (read_number(from)?, [read_number(from)?, read_number(from)?]);
        let mut value = || {
            let (bits, rest) = from.split_first_chunk::<8>()?;
            *from = rest;
            Some(f64::from_bits(u64::from_le_bytes(*bits)))
        };
        let (least, greatest) = (value()?, value()?);
        let (sum, squares) = (ExactSum::read(from)?, ExactSum::read(from)?);
        let sketch = Sketch::read(from, members)?;
        let are_numbers = !least.is_nan() && !greatest.is_nan() && (members == 0 || least <= greatest);
        (from.is_empty() && are_numbers).then_some(Self {
            members,
            infinite,
            sum,
            squares,
            least,
            greatest,
            sketch,
        })
    }
}

impl core::fmt::Debug for Statistics {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Statistics")
            .field("members", &self.members)
            .field("least", &self.least)
            .field("greatest", &self.greatest)
            .finish_non_exhaustive()
    }
}
