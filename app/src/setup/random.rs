//! Random numbers that are the same for the same seed, on every machine.

/// A stream of random numbers: splitmix64, started from a hash of a seed and the stream's number.
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// One of a seed's streams: they have nothing to do with each other.
    pub fn new(seed: u64, stream: u64) -> Self {
        Self(mixed(mixed(seed).wrapping_add(stream)))
    }

    /// Evenly distributed between −1 and 1, never either of them.
    pub fn even(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        ((mixed(self.0) >> 12) as f64 + 0.5) * 2_f64.powi(-51) - 1.0
    }

    /// Normally distributed with deviation 1, by Box and Muller's transformation.
    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (0.5 + 0.5 * self.even()).ln()).sqrt();
        radius * (std::f64::consts::PI * self.even()).cos()
    }
}

/// A number all of whose bits depend on all bits of the given one; no two give the same.
fn mixed(bits: u64) -> u64 {
    let bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ (bits >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Means of powers of the numbers, and of products of neighbours and of neighbouring streams, are what they should
    /// be.
    #[test]
    fn numbers_are_even_and_have_nothing_to_do_with_each_other() {
        const COUNT: usize = 100_000;
        let drawn = |seed, stream| {
            let mut random = Random::new(seed, stream);
            (0..COUNT).map(|_| random.even()).collect::<Vec<f64>>()
        };
        let mean = |numbers: &mut dyn Iterator<Item = f64>| numbers.sum::<f64>() / COUNT as f64;
        let (here, beside) = (drawn(7, 0), drawn(7, 1));
        assert_eq!(here, drawn(7, 0));
        assert!(here.iter().all(|x| x.abs() < 1.0));
        // five standard deviations
        let near = |value: f64, expected: f64| (value - expected).abs() < 5.0 / (COUNT as f64).sqrt();
        for (power, expected) in [(1, 0.0), (2, 1.0 / 3.0), (3, 0.0), (4, 0.2)] {
            assert!(near(mean(&mut here.iter().map(|x| x.powi(power))), expected), "{power}");
        }
        assert!(near(mean(&mut here.iter().zip(&here[1..]).map(|(x, y)| x * y)), 0.0));
        assert!(near(mean(&mut here.iter().zip(&beside).map(|(x, y)| x * y)), 0.0));
        let mut random = Random::new(7, 2);
        let normal: Vec<f64> = (0..COUNT).map(|_| random.normal()).collect();
        for (power, expected) in [(1, 0.0), (2, 1.0)] {
            assert!((mean(&mut normal.iter().map(|x| x.powi(power))) - expected).abs() < 0.02, "{power}");
        }
    }
}
