//! Checks of parameters, shared by all generated systems.

use crate::error::ParameterError;
use crate::scalar::Real;

/// Every component finite, or an error naming the parameter.
#[doc(hidden)]
pub fn require_finite<T: Real>(name: &'static str, components: &[T]) -> Result<(), ParameterError> {
    if components.iter().all(|x| x.is_finite()) { Ok(()) } else { Err(ParameterError::NotFinite { name }) }
}

/// How far mirrored entries of an inertia may be apart, in units of its largest entry: single precision, and data that were written down
/// with seven digits.
const ASYMMETRY: f64 = 1e-6;

/// The largest difference between mirrored entries of a square matrix (flat, order `dimension`), and whether that is no more than
/// [`ASYMMETRY`] of its largest entry.
fn asymmetry<T: Real>(entries: &[T], dimension: usize) -> (f64, bool) {
    let entry = |i: usize, j: usize| entries.get(i * dimension + j).map_or(f64::NAN, |x| x.to_f64());
    let mut difference: f64 = 0.0;
    let mut largest: f64 = 0.0;
    for i in 0..dimension {
        for j in 0..dimension {
            largest = largest.max(entry(i, j).abs());
            difference = difference.max((entry(i, j) - entry(j, i)).abs());
        }
    }
    (difference, difference <= ASYMMETRY * largest)
}

/// A square matrix (flat, order `dimension`) equal to its transpose up to 1e-6 of its largest entry, or an error naming the parameter.
#[doc(hidden)]
pub fn require_symmetric<T: Real>(
    name: &'static str,
    entries: &[T],
    dimension: usize,
) -> Result<(), ParameterError> {
    match asymmetry(entries, dimension) {
        (_, true) => Ok(()),
        (difference, false) => Err(ParameterError::NotSymmetric { name, difference }),
    }
}

/// The symmetric part of a square matrix (flat, order `dimension`) that is [nearly so](require_symmetric). One that is symmetric, or far
/// from it, stays as it is.
#[doc(hidden)]
pub fn symmetric_part<T: Real, const N: usize>(entries: [T; N], dimension: usize) -> [T; N] {
    let mut symmetric = entries;
    if let (difference, true) = asymmetry(&entries, dimension)
        && difference > 0.0
    {
        for (place, entry) in symmetric.iter_mut().enumerate() {
            let mirrored = entries.get(place % dimension * dimension + place / dimension);
            *entry = T::of(0.5) * (*entry + mirrored.copied().unwrap_or(*entry));
        }
    }
    symmetric
}

/// Writes the [symmetric part](symmetric_part) of a matrix.
#[cfg(feature = "dynamic")]
pub(crate) fn symmetrize(entries: &[f64], to: &mut [f64], dimension: usize) {
    if let (difference, true) = asymmetry(entries, dimension)
        && difference > 0.0
    {
        for (place, to) in to.iter_mut().enumerate() {
            let mirrored = entries.get(place % dimension * dimension + place / dimension);
            *to = 0.5 * (*to + mirrored.copied().unwrap_or(*to));
        }
    }
}

/// All pivots positive, or an error naming the parameter.
#[doc(hidden)]
pub fn require_positive_definite<T: Real>(name: &'static str, pivots: &[T]) -> Result<(), ParameterError> {
    for (index, pivot) in pivots.iter().enumerate() {
        let pivot = pivot.to_f64();
        if !(pivot > 0.0) {
            return Err(ParameterError::NotPositiveDefinite { name, index, pivot });
        }
    }
    Ok(())
}
