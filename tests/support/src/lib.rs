//! What the tests share: systems to test on, deterministic random numbers, measures of what comes out.

pub mod dual;
pub mod measure;
pub mod precise;
pub mod random;
pub mod systems;

use coadjoint::__private::Components;
use coadjoint::__private::Scalar;

/// The array of what `value` gives for each index.
pub fn array<T: Scalar, C: Components<T>>(mut value: impl FnMut(usize) -> T) -> C {
    let mut array = C::splat(T::of(0.0));
    array.as_mut().iter_mut().enumerate().for_each(|(index, entry)| *entry = value(index));
    array
}
