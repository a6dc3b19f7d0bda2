//! What steppers carry from one step to the next, written down and read back: pieces of numbers, always of the same lengths.

use crate::error::ParameterError;
use crate::scalar::{Batch, Real, Scalar};

/// Shows pieces of a memory to whoever reads or replaces them.
pub(crate) type Show<'a, T> = dyn FnMut(&mut dyn FnMut(&mut [T])) + 'a;

/// A memory written down: the start, the steps since and those before it, and what is shown. A function, like the next, so that it is compiled once for all steppers.
#[cfg(feature = "std")]
pub(crate) fn written<T: Real>(start: f64, steps: [u64; 2], show: &mut Show<'_, T>) -> std::vec::Vec<f64> {
    let mut memory = std::vec![start, steps[0] as f64, steps[1] as f64];
    show(&mut |piece| memory.extend(piece.iter().map(|number| number.to_f64())));
    memory
}

/// Puts back what was written down; the start, and the steps since and before it.
pub(crate) fn read<T: Real>(
    memory: &[f64],
    show: &mut Show<'_, T>,
) -> Result<(f64, [u64; 2]), ParameterError> {
    let mut expected = 3;
    show(&mut |piece| expected += piece.len());
    let [start, taken, before, rest @ ..] = memory else {
        return Err(ParameterError::Snapshot { expected, got: memory.len() });
    };
    if memory.len() != expected {
        return Err(ParameterError::Snapshot { expected, got: memory.len() });
    }
    let mut rest = rest.iter();
    show(&mut |piece| {
        piece.iter_mut().zip(&mut rest).for_each(|(number, value)| *number = T::of(*value));
    });
    Ok((*start, [count(*taken), count(*before)]))
}

/// How many steps a number says that there were.
pub(crate) fn count(steps: f64) -> u64 {
    // above that not every count has its own number
    const MOST: u64 = 1 << f64::MANTISSA_DIGITS;
    (steps as u64).min(MOST)
}

/// Shows a truth as a number.
pub(crate) fn visit_flag<T: Batch>(flag: &mut bool, visit: &mut dyn FnMut(&mut [T])) {
    let mut number = [T::of(if *flag { 1.0 } else { 0.0 })];
    visit(&mut number);
    *flag = number[0].lane(0) != T::Number::of(0.0);
}
