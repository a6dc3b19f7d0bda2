//! What unchecked code relies on cannot be implemented outside.

use coadjoint::__private::Components;

/// Says that it is made of numbers, and is made of references.
#[derive(Clone, Copy, PartialEq, Debug)]
struct Mine([&'static u64; 3]);

impl AsRef<[f64]> for Mine {
    fn as_ref(&self) -> &[f64] {
        &[]
    }
}

impl AsMut<[f64]> for Mine {
    fn as_mut(&mut self) -> &mut [f64] {
        &mut []
    }
}

impl Components<f64> for Mine {
    const LENGTH: usize = 3;

    fn splat(_: f64) -> Self {
        Self([&0; 3])
    }
}

fn main() {}
