//! `clamp` in the methods that are emitted for users' expressions.

/// As Rust's `clamp`, but where the limits cross it is the upper one, as in a step, and no panic.
pub trait Clamp {
    /// The number, or the limit that it is beyond.
    #[must_use]
    fn __clamp(self, lower: Self, upper: Self) -> Self;
}

impl<T: nalgebra::RealField + Copy> Clamp for T {
    fn __clamp(self, lower: T, upper: T) -> T {
        let raised = if self < lower { lower } else { self };
        if upper < raised { upper } else { raised }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_rusts_but_for_limits_that_cross() {
        let numbers = [f64::NEG_INFINITY, -2.0, -0.0, 0.0, 0.5, 2.0, f64::INFINITY];
        for x in numbers {
            for (lower, upper) in [(-1.0, 1.0), (0.0, 0.0), (-2.0, 0.5), (0.0, f64::INFINITY)] {
                assert_eq!(x.__clamp(lower, upper).to_bits(), x.clamp(lower, upper).to_bits(), "{x}");
            }
            assert_eq!(x.__clamp(1.0, -1.0), -1.0);
        }
        assert!(f64::NAN.__clamp(-1.0, 1.0).is_nan());
    }
}
