//! Sums of numbers and of their squares without any rounding, in whatever order they are added.

use std::vec;
use std::vec::Vec;

/// Binary digits of a limb.
const BITS: i32 = 32;
/// Limbs below the point: the least bit of the square of the least double is 2⁻²¹⁴⁸.
const BELOW: usize = 68;
/// All limbs: above the point squares of the greatest doubles, 2⁶⁴ of them, and a sign.
const LIMBS: usize = BELOW + 67;
/// So many additions later a limb may be full: each adds less than 2³³.
const MOST: u32 = 1 << 29;

/// A sum in fixed point, wide enough for the squares of all doubles.
///
/// Limbs have 32 digits each and room for more, so that carries are passed on once in a while only.
#[derive(Clone, PartialEq, Eq)]
pub(crate) struct ExactSum {
    limbs: [i64; LIMBS],
    /// Additions since carries were passed on.
    pending: u32,
}

impl ExactSum {
    pub(crate) const ZERO: Self = Self { limbs: [0; LIMBS], pending: 0 };

    /// Adds a finite number.
    pub(crate) fn add(&mut self, value: f64) {
        let (digits, exponent) = parts(value);
        self.put(digits.into(), exponent, value.is_sign_negative());
    }

    /// Adds the square of a finite number.
    pub(crate) fn add_square(&mut self, value: f64) {
        let (digits, exponent) = parts(value);
        self.put(u128::from(digits) * u128::from(digits), 2 * exponent, false);
    }

    /// Adds `digits · 2^exponent`, or subtracts it.
    fn put(&mut self, mut digits: u128, exponent: i32, is_negative: bool) {
        if self.pending == MOST {
            self.carry();
        }
        self.pending += 1;
        let place = exponent + BELOW as i32 * BITS;
        let (mut limb, shift) = ((place / BITS) as usize, place % BITS);
        while digits != 0 {
            let chunk = i64::from(digits as u32) << shift;
            let (low, high) = (chunk & 0xffff_ffff, (chunk as u64 >> BITS) as i64);
            match is_negative {
                false => {
                    self.limbs[limb] += low;
                    self.limbs[limb + 1] += high;
                }
                true => {
                    self.limbs[limb] -= low;
                    self.limbs[limb + 1] -= high;
                }
            }
            digits >>= BITS;
            limb += 1;
        }
    }

    /// Passes carries on: all limbs but the last are then between 0 and 2³².
    pub(crate) fn carry(&mut self) {
        let mut carry = 0;
        for limb in &mut self.limbs[..LIMBS - 1] {
            let sum = *limb + carry;
            (*limb, carry) = (sum & 0xffff_ffff, sum >> BITS);
        }
        self.limbs[LIMBS - 1] += carry;
        self.pending = 0;
    }

    /// Adds another sum.
    pub(crate) fn merge(&mut self, other: &Self) {
        let mut other = other.clone();
        other.carry();
        self.carry();
        self.limbs.iter_mut().zip(&other.limbs).for_each(|(limb, more)| *limb += more);
        self.carry();
    }

    /// The size of the sum in limbs from the least, and whether it is negative; after carries were passed on.
    fn size(&self) -> (Vec<u32>, bool) {
        debug_assert_eq!(self.pending, 0);
        let is_negative = self.limbs[LIMBS - 1] < 0;
        let mut carry = i64::from(is_negative);
        let size = self.limbs.iter().map(|&limb| {
            if !is_negative {
                return limb as u32;
            }
            // two's complement
            let flipped = (!limb & 0xffff_ffff) + carry;
            carry = flipped >> BITS;
            flipped as u32
        });
        (size.collect(), is_negative)
    }

    /// Writes the sum: where its limbs begin, how many there are, a sign, and they.
    pub(crate) fn write(&self, to: &mut Vec<u8>) {
        let mut sum = self.clone();
        sum.carry();
        let (size, is_negative) = sum.size();
        let first = size.iter().position(|limb| *limb != 0).unwrap_or(0);
        let end = size.iter().rposition(|limb| *limb != 0).map_or(first, |last| last + 1);
        to.extend([first as u8, (end - first) as u8, u8::from(is_negative)]);
        to.extend(size[first..end].iter().flat_map(|limb| limb.to_le_bytes()));
    }

    /// Reads what [`write`](Self::write) wrote, and leaves what comes behind it.
    pub(crate) fn read(from: &mut &[u8]) -> Option<Self> {
        let (&[first, count, is_negative], rest) = from.split_first_chunk()?;
        let (first, count) = (usize::from(first), usize::from(count));
        let (bytes, rest) = rest.split_at_checked(4 * count)?;
        let mut sum = Self::ZERO;
        let places = sum.limbs.get_mut(first..first + count).filter(|_| first + count < LIMBS)?;
        for (place, limb) in places.iter_mut().zip(bytes.chunks_exact(4)) {
            let limb = i64::from(u32::from_le_bytes(limb.try_into().ok()?));
            *place = if is_negative == 0 { limb } else { -limb };
        }
        sum.carry();
        *from = rest;
        Some(sum)
    }
}

/// The mean of this many numbers with these sums, and their variance, each rounded once.
pub(crate) fn moments(count: u64, sum: &ExactSum, squares: &ExactSum) -> (f64, f64) {
    let (mut sum, mut squares) = (sum.clone(), squares.clone());
    sum.carry();
    squares.carry();
    let ((sum, is_negative), (squares, _)) = (sum.size(), squares.size());
    let mean = quotient(&sum, BELOW, &[count]);
    // n Σx² − (Σx)², over n², both with twice as many limbs below the point
    let mut difference = vec![0; BELOW];
    difference.extend(times(&squares, count));
    let square = product(&sum, &sum);
    difference.resize(difference.len().max(square.len()), 0);
    let mut borrow = 0;
    for (k, limb) in difference.iter_mut().enumerate() {
        let left = i64::from(*limb) - i64::from(square.get(k).copied().unwrap_or(0)) + borrow;
        (*limb, borrow) = (left as u32, left >> BITS);
    }
    let variance = quotient(&difference, 2 * BELOW, &[count, count]);
    (if is_negative { -mean } else { mean }, variance)
}

/// A finite number's digits and the exponent of the last of them.
fn parts(value: f64) -> (u64, i32) {
    let bits = value.to_bits();
    let (exponent, fraction) = ((bits >> 52 & 0x7ff) as i32, bits & ((1 << 52) - 1));
    if exponent == 0 { (fraction, -1074) } else { (fraction | 1 << 52, exponent - 1075) }
}

fn times(size: &[u32], factor: u64) -> Vec<u32> {
    product(size, &[factor as u32, (factor >> BITS) as u32])
}

fn product(a: &[u32], b: &[u32]) -> Vec<u32> {
    let mut product = vec![0_u32; a.len() + b.len()];
    for (i, &a) in a.iter().enumerate().filter(|(_, a)| **a != 0) {
        let mut carry = 0;
        for (place, &b) in product[i..].iter_mut().zip(b) {
            let sum = u64::from(*place) + u64::from(a) * u64::from(b) + carry;
            (*place, carry) = (sum as u32, sum >> BITS);
        }
        product[i + b.len()] = carry as u32;
    }
    product
}

/// The double nearest to a number, so many limbs of which are below the point, over all of these divisors. Below the
/// least double there are limbs enough that no digit of it is missing.
fn quotient(size: &[u32], below: usize, divisors: &[u64]) -> f64 {
    let mut limbs = size.to_vec();
    let mut is_inexact = false;
    for &divisor in divisors {
        let mut rest = 0;
        for limb in limbs.iter_mut().rev() {
            let part = rest << BITS | u128::from(*limb);
            (*limb, rest) = ((part / u128::from(divisor)) as u32, part % u128::from(divisor));
        }
        is_inexact |= rest != 0;
    }
    let Some(top) = limbs.iter().rposition(|limb| *limb != 0) else { return 0.0 };
    // the first three limbs have at least 65 digits, the first of which is not zero; what is below only says whether
    // they are exact
    let digits = (0..3)
        .fold(0, |digits, k| digits << BITS | u128::from(top.checked_sub(k).map_or(0, |place| limbs[place])));
    is_inexact |= limbs[..top.saturating_sub(2)].iter().any(|limb| *limb != 0);
    let exponent = (top as i32 - 2 - below as i32) * BITS;
    let length = 128 - digits.leading_zeros() as i32;
    // of the least doubles fewer digits are kept
    let dropped = (length - 53).max(-1074 - exponent);
    let (kept, half) = match u32::try_from(dropped) {
        Ok(dropped) if dropped < 128 => (digits >> dropped, (digits >> (dropped - 1)) & 1),
        _ => return 0.0,
    };
    let is_more = is_inexact || digits & ((1_u128 << (dropped - 1)) - 1) != 0;
    let is_up = half == 1 && (is_more || kept & 1 == 1);
    scaled(kept as u64 + u64::from(is_up), exponent + dropped)
}

/// `digits · 2^exponent` for at most 2⁵³ and an exponent from −1074 on.
fn scaled(digits: u64, exponent: i32) -> f64 {
    if exponent > 971 {
        return f64::INFINITY;
    }
    let value = digits as f64;
    // two factors, neither of which is beyond the doubles
    let power = |exponent: i32| match exponent {
        -1022.. => f64::from_bits(((exponent + 1023) as u64) << 52),
        _ => f64::from_bits(1 << (exponent + 1074)),
    };
    value * power(exponent)
}
