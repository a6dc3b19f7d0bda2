//! Numbers modulo a prime: linear algebra, and whether a matrix of expressions is singular.

use std::collections::BTreeMap;

use num_rational::Ratio;
use rustc_hash::FxHashMap;

use super::linear::Matrix;
use super::node::{Id, Node};
use super::number::Number;

/// Modulo this all products fit.
pub(crate) const PRIME: u64 = 2_147_483_629;

/// A sparse vector modulo the prime.
pub(crate) type Sparse<K> = BTreeMap<K, u64>;

/// Rows that are independent, each with a last entry that no other one has.
pub(crate) struct Echelon<K> {
    pub(crate) rows: Vec<Sparse<K>>,
    pivots: BTreeMap<K, usize>,
}

impl<K> Default for Echelon<K> {
    fn default() -> Self {
        Self { rows: Vec::new(), pivots: BTreeMap::new() }
    }
}

impl<K: Ord + Clone> Echelon<K> {
    /// Adds what a row has beside those that there are; says whether there is anything.
    pub(crate) fn insert(&mut self, row: Sparse<K>) -> bool {
        let rest = self.reduce(row);
        self.push(rest)
    }

    /// A row without multiples of those that there are, up to a last entry that none of them has.
    pub(crate) fn reduce(&self, mut row: Sparse<K>) -> Sparse<K> {
        while let Some((pivot, &value)) = row.last_key_value()
            && let Some(&place) = self.pivots.get(pivot)
        {
            subtract(&mut row, value, &self.rows[place]);
        }
        row
    }

    /// Adds a reduced row; says whether there is anything in it.
    pub(crate) fn push(&mut self, mut row: Sparse<K>) -> bool {
        let Some((pivot, &value)) = row.last_key_value() else { return false };
        let scale = inverse(value);
        self.pivots.insert(pivot.clone(), self.rows.len());
        row.values_mut().for_each(|x| *x = *x * scale % PRIME);
        self.rows.push(row);
        true
    }

    /// The rows from this one on, without the last entries of all others; those with the last ones first.
    pub(crate) fn reduced(&self, from: usize) -> Vec<Sparse<K>> {
        let places = self.pivots.iter().rev().filter(|&(_, &place)| place >= from);
        let reduced = |(own, &place): (&K, &usize)| {
            let mut row = self.rows[place].clone();
            for (pivot, &other) in self.pivots.iter().rev().filter(|&(pivot, _)| pivot != own) {
                if let Some(&value) = row.get(pivot) {
                    subtract(&mut row, value, &self.rows[other]);
                }
            }
            row
        };
        places.map(reduced).collect()
    }
}

/// `row −= factor · other`
fn subtract<K: Ord + Clone>(row: &mut Sparse<K>, factor: u64, other: &Sparse<K>) {
    for (key, value) in other {
        let entry = row.entry(key.clone()).or_insert(0);
        *entry = (*entry + PRIME - factor * value % PRIME) % PRIME;
        if *entry == 0 {
            row.remove(key);
        }
    }
}

pub(crate) fn residue(number: Ratio<i64>) -> u64 {
    let prime = PRIME as i64;
    let part = |x: i64| x.rem_euclid(prime) as u64;
    part(*number.numer()) * inverse(part(*number.denom())) % PRIME
}

/// `x⁻¹`, by Fermat's little theorem.
fn inverse(x: u64) -> u64 {
    power(x, PRIME - 2)
}

fn power(x: u64, mut exponent: u64) -> u64 {
    let (mut power, mut result) = (x, 1);
    while exponent > 0 {
        if exponent % 2 == 1 {
            result = result * power % PRIME;
        }
        power = power * power % PRIME;
        exponent /= 2;
    }
    result
}

/// A number without any pattern, for each of these one: the finalizer of SplitMix64.
fn scattered(place: u64) -> u64 {
    let mix = |x: u64, shift: u32, by: u64| (x ^ (x >> shift)).wrapping_mul(by);
    let x = place.wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    mix(mix(mix(x, 30, 0xBF58_476D_1CE4_E5B9), 27, 0x94D0_49BB_1331_11EB), 31, 1) % PRIME
}

impl Matrix<'_> {
    /// Whether it is singular whatever the values of its symbols are: its rank is too small at points chosen at random.
    /// A polynomial that is not zero is zero at one of them with a probability of its degree over the prime (Schwartz
    /// and Zippel). Roots and other functions are taken for symbols of their own: if it is singular for all values of
    /// these, it is for those that they have.
    pub(crate) fn is_singular(&self) -> bool {
        (0..4).all(|point| self.rank_at(point).is_some_and(|rank| rank < self.rows))
    }

    /// The rank at one of these points, if the entries have values there that are known exactly.
    fn rank_at(&self, point: u64) -> Option<usize> {
        let Some(arena) = self.entries.first().map(|entry| entry.arena) else { return Some(0) };
        let mut known: FxHashMap<Id, u64> = FxHashMap::default();
        for id in arena.post_order(self.entries.iter().map(|entry| entry.id), |_| false) {
            let constant = |number: Number| match number {
                Number::Rational(ratio) => (ratio.denom() % PRIME as i64 != 0).then(|| residue(ratio)),
                Number::Float(_) => None,
            };
            let value = match arena.node(id) {
                Node::Number(number) => constant(number)?,
                Node::Sum(sum) => {
                    sum.terms.iter().try_fold(constant(sum.constant)?, |total, (term, c)| {
                        Some((total + constant(*c)? * known[term]) % PRIME)
                    })?
                }
                Node::Product(factors) => factors.iter().try_fold(1, |product, (factor, e)| {
                    let base = if *e < 0 { inverse(known[factor]) } else { known[factor] };
                    (base != 0 || *e > 0).then(|| product * power(base, e.unsigned_abs().into()) % PRIME)
                })?,
                Node::Held(inner) => known[&inner],
                Node::Symbol(_)
                | Node::Function(..)
                | Node::Power(..)
                | Node::Atan2(..)
                | Node::Choice(_) => scattered(u64::from(id.0) << 2 | point),
            };
            known.insert(id, value);
        }
        let mut rank = Echelon::default();
        for i in 0..self.rows {
            let row = (0..self.columns).map(|j| (j, known[&self.at(i, j).id]));
            rank.insert(row.filter(|&(_, value)| value != 0).collect());
        }
        Some(rank.rows.len())
    }
}
