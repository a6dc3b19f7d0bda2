//! Random numbers that are the same for the same seed, on every machine.

use rand::SeedableRng;
use rand::rngs::ChaCha8Rng;
use rand_distr::{Distribution, Open01, StandardNormal};

/// A stream of random numbers: one of those that ChaCha has for a seed.
#[derive(Debug)]
pub struct Random(ChaCha8Rng);

impl Random {
    /// Starts one of a seed's streams: they have nothing to do with each other.
    pub fn new(seed: u64, stream: u64) -> Self {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        random.set_stream(stream);
        Self(random)
    }

    /// Draws a number evenly between −1 and 1, never either of them.
    pub fn even(&mut self) -> f64 {
        let drawn: f64 = Open01.sample(&mut self.0);
        2.0 * drawn - 1.0
    }

    /// Draws a normally distributed number of deviation 1.
    pub fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }
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
