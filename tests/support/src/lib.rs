//! What the tests share: systems to test on, deterministic random numbers, measures of what comes out.

/// The front page and the page of a registry: their code is compiled and run as a test.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
#[doc = include_str!("../../../docs/registry.md")]
mod pages {}

pub mod dual;
#[path = "../../../codegen/tests/all/evaluate.rs"]
pub mod evaluate;
pub mod families;
#[path = "../../../codegen/tests/all/interpret.rs"]
pub mod interpret;
pub mod measure;
pub mod precise;
pub mod random;
pub mod systems;

use coadjoint::__private::Components;
use coadjoint::__private::Scalar;

/// The array of what `value` gives for each index.
pub fn array<T: Scalar, C: Components<T>>(mut value: impl FnMut(usize) -> T) -> C {
    let (mut array, mut index) = (C::splat(T::of(0.0)), 0);
    // a loop over places: chains of iterators take longer to compile than all else here, and this is compiled for each use
    while index < C::LENGTH {
        array.as_mut()[index] = value(index);
        index += 1;
    }
    array
}
