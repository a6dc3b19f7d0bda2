//! The distribution of numbers in a bounded number of buckets, the same whatever order they come in.

use std::vec::Vec;

/// So many buckets are kept; enough for each exponent with each sign.
pub(crate) const MOST: usize = 4096;

/// Counts of numbers that have the same leading digits: as many digits as there may be for [`MOST`] buckets.
///
/// Up to so many different numbers it holds them themselves. Where there are more, the last binary digit of all is
/// dropped, and the next, until they fit. What is dropped at the end depends on the set of numbers alone: buckets lie
/// within those with a digit less, and of a part of the numbers there are never more than of all.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Sketch {
    /// Digits that are dropped, at most all but sign and exponent.
    dropped: u32,
    /// The digits that are left, in ascending order of the numbers, and how many have them.
    buckets: Vec<(u64, u64)>,
}

/// Digits of a double behind its exponent.
const DIGITS: u32 = 52;

impl Sketch {
    /// Of numbers in ascending order.
    pub(crate) fn of_sorted(values: &[f64]) -> Self {
        let mut sketch = Self { dropped: 0, buckets: Vec::new() };
        for value in values {
            let key = key(*value);
            match sketch.buckets.last_mut() {
                Some((last, count)) if *last == key => *count += 1,
                _ => sketch.buckets.push((key, 1)),
            }
        }
        sketch.fit();
        sketch
    }

    /// Adds the counts of another one.
    pub(crate) fn merge(&mut self, other: &Self) {
        let dropped = self.dropped.max(other.dropped);
        let coarse = |of: &Self| {
            let more = dropped - of.dropped;
            move |(key, count): &(u64, u64)| (key >> more, *count)
        };
        let mut merged: Vec<(u64, u64)> = Vec::with_capacity(self.buckets.len() + other.buckets.len());
        let mut ours = self.buckets.iter().map(coarse(self));
        let mut theirs = other.buckets.iter().map(coarse(other));
        let (mut our, mut their) = (ours.next(), theirs.next());
        loop {
            let next = match (our, their) {
                (Some((a, _)), Some((b, _))) if a <= b => core::mem::replace(&mut our, ours.next()),
                (Some(_), None) => core::mem::replace(&mut our, ours.next()),
                _ => core::mem::replace(&mut their, theirs.next()),
            };
            let Some((key, count)) = next else { break };
            match merged.last_mut() {
                Some((last, all)) if *last == key => *all += count,
                _ => merged.push((key, count)),
            }
        }
        (self.dropped, self.buckets) = (dropped, merged);
        self.fit();
        self.buckets.shrink_to_fit();
    }

    /// Drops digits until there are not too many buckets.
    fn fit(&mut self) {
        let mut left = self.buckets.len();
        if left <= MOST {
            return;
        }
        // neighbours become one where the first digit in which they differ is dropped
        let mut differ = [0; u64::BITS as usize];
        for pair in self.buckets.windows(2) {
            differ[(pair[0].0 ^ pair[1].0).ilog2() as usize] += 1;
        }
        let mut dropped = self.dropped;
        while left > MOST && dropped < DIGITS {
            left -= differ[(dropped - self.dropped) as usize];
            dropped += 1;
        }
        self.coarsen(dropped);
    }

    fn coarsen(&mut self, dropped: u32) {
        let more = dropped - self.dropped;
        if more == 0 {
            return;
        }
        self.dropped = dropped;
        self.buckets.dedup_by(|(key, count), (kept, all)| {
            let is_same = *key >> more == *kept >> more;
            *all += if is_same { *count } else { 0 };
            is_same
        });
        self.buckets.iter_mut().for_each(|(key, _)| *key >>= more);
    }

    /// How far a number may be from the one that stands for it, relative to its size.
    pub(crate) fn relative_error(&self) -> f64 {
        if self.dropped == 0 { 0.0 } else { 2_f64.powi(self.dropped as i32 - 53) }
    }

    /// The number at a place in their ascending order, from 0.
    pub(crate) fn at(&self, place: u64) -> f64 {
        let mut below = 0;
        let bucket = self.buckets.iter().find(|(_, count)| {
            below += count;
            below > place
        });
        bucket.or(self.buckets.last()).map_or(f64::NAN, |(key, _)| self.middle(*key))
    }

    /// The number in the middle of a bucket.
    fn middle(&self, key: u64) -> f64 {
        let least = key << self.dropped;
        let (is_negative, all) = (least >> 63 == 0, (1_u64 << self.dropped) - 1);
        let size = if is_negative { !(least | all) & !(1 << 63) } else { least & !(1 << 63) };
        let half = if self.dropped == 0 { 0 } else { 1 << (self.dropped - 1) };
        // infinity is alone in its bucket; what is in that of zero is less than any normal number
        let is_alone = size == f64::INFINITY.to_bits() || size == 0;
        let size = f64::from_bits(if is_alone { size } else { size + half });
        if is_negative { -size } else { size }
    }

    /// Writes the number of digits that are dropped, that of buckets, and each by its distance from the one before and
    /// its count.
    pub(crate) fn write(&self, to: &mut Vec<u8>) {
        write_number(to, self.dropped.into());
        write_number(to, self.buckets.len() as u64);
        let mut before = 0;
        for &(key, count) in &self.buckets {
            write_number(to, key - before);
            write_number(to, count);
            before = key;
        }
    }

    /// Reads what [`write`](Self::write) wrote, of so many numbers, and leaves what comes behind it.
    pub(crate) fn read(from: &mut &[u8], members: u64) -> Option<Self> {
        let dropped = u32::try_from(read_number(from)?).ok().filter(|dropped| *dropped <= DIGITS)?;
        let length = usize::try_from(read_number(from)?).ok().filter(|length| *length <= MOST)?;
        let mut sketch = Self { dropped, buckets: Vec::with_capacity(length) };
        let (mut key, mut all) = (0_u64, 0_u64);
        for k in 0..length {
            let distance = read_number(from)?;
            key = key.checked_add(distance).filter(|key| *key <= u64::MAX >> dropped)?;
            let count = read_number(from).filter(|count| *count > 0)?;
            all = all.checked_add(count).filter(|_| k == 0 || distance > 0)?;
            sketch.buckets.push((key, count));
        }
        (all == members).then_some(sketch)
    }
}

/// The digits of a number, in an order of integers that is that of the numbers.
fn key(value: f64) -> u64 {
    let bits = value.to_bits();
    if bits >> 63 == 1 { !bits } else { bits | 1 << 63 }
}

/// Writes an integer, seven digits a byte.
pub(crate) fn write_number(to: &mut Vec<u8>, mut number: u64) {
    while number >= 128 {
        to.push(number as u8 | 128);
        number >>= 7;
    }
    to.push(number as u8);
}

/// Reads an integer.
pub(crate) fn read_number(from: &mut &[u8]) -> Option<u64> {
    let mut number = 0;
    for (k, &byte) in from.iter().take(10).enumerate() {
        let digits = u64::from(byte & 127);
        number |= digits << (7 * k);
        if byte < 128 {
            *from = &from[k + 1..];
            // the tenth byte has one digit
            return (k < 9 || digits < 2).then_some(number);
        }
    }
    None
}
