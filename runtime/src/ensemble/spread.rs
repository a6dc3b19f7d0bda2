//! How a quantity is distributed over an ensemble.

/// How a quantity is distributed at one time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Spread {
    /// The time.
    pub time: f64,
    /// How many members there are to ask: those that have not failed and whose quantity is a number.
    pub members: usize,
    /// The mean.
    pub mean: f64,
    /// The standard deviation of the members from their mean.
    pub deviation: f64,
    /// The quantiles of [`Spread::LEVELS`]: the least value, …, the median, …, the greatest.
    pub quantiles: [f64; 7],
}

impl Spread {
    /// Of which quantiles are recorded.
    pub const LEVELS: [f64; 7] = [0.0, 0.05, 0.25, 0.5, 0.75, 0.95, 1.0];

    /// Of values in any order, none of which is not-a-number.
    pub fn of(time: f64, values: &mut [f64]) -> Self {
        let members = values.len();
        if members == 0 {
            let nothing = f64::NAN;
            return Self { time, members, mean: nothing, deviation: nothing, quantiles: [nothing; 7] };
        }
        values.sort_unstable_by(f64::total_cmp);
        let mean = values.iter().sum::<f64>() / members as f64;
        let variance = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / members as f64;
        // between two values in proportion
        let quantile = |level: f64| {
            let place = level * (members - 1) as f64;
            let (below, part) = (place as usize, place.fract());
            let above = (below + 1).min(members - 1);
            if part == 0.0 { values[below] } else { values[below] + part * (values[above] - values[below]) }
        };
        Self { time, members, mean, deviation: variance.sqrt(), quantiles: Self::LEVELS.map(quantile) }
    }
}
