//! Orders, trends and other figures that are measured rather than claimed.

/// The slope of the straight line that fits points `(x, y)` best.
pub fn slope(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let mean_x = points.iter().map(|(x, _)| x).sum::<f64>() / n;
    let mean_y = points.iter().map(|(_, y)| y).sum::<f64>() / n;
    let covariance: f64 = points.iter().map(|(x, y)| (x - mean_x) * (y - mean_y)).sum();
    let variance: f64 = points.iter().map(|(x, _)| (x - mean_x).powi(2)).sum();
    covariance / variance
}

/// The order of a method: how fast `log(error)` falls with `log(step)`.
pub fn order(steps_and_errors: &[(f64, f64)]) -> f64 {
    let logarithms: Vec<_> = steps_and_errors.iter().map(|(h, error)| (h.ln(), error.ln())).collect();
    slope(&logarithms)
}

/// The largest absolute value.
pub fn largest(values: impl IntoIterator<Item = f64>) -> f64 {
    values
        .into_iter()
        .map(f64::abs)
        .fold(0.0, |largest, value| if value <= largest { largest } else { value })
}

/// How a quantity changes in the long run.
#[derive(Clone, Copy, Debug)]
pub struct Trend {
    /// Change per unit of time.
    pub slope: f64,
    /// The slope's standard error.
    pub error: f64,
}

/// The trend of a time series sampled every `dt`.
///
/// What oscillates is correlated with itself, so that single values say less than their number suggests. Means over blocks much
/// longer than an oscillation are independent; the line is fitted to them and its error told from their scatter.
pub fn trend(values: &[f64], dt: f64, blocks: usize) -> Trend {
    let length = values.len() / blocks;
    let means: Vec<(f64, f64)> = values
        .chunks_exact(length)
        .enumerate()
        .map(|(k, block)| {
            let time = (k as f64 + 0.5) * length as f64 * dt;
            (time, block.iter().sum::<f64>() / length as f64)
        })
        .collect();
    let n = means.len() as f64;
    let slope = slope(&means);
    let mean_x = means.iter().map(|(x, _)| x).sum::<f64>() / n;
    let mean_y = means.iter().map(|(_, y)| y).sum::<f64>() / n;
    let scatter: f64 = means.iter().map(|(x, y)| (y - mean_y - slope * (x - mean_x)).powi(2)).sum();
    let spread: f64 = means.iter().map(|(x, _)| (x - mean_x).powi(2)).sum();
    Trend { slope, error: (scatter / (n - 2.0) / spread).sqrt() }
}

/// The mean of a time series, weighted by a smooth bump that vanishes at both ends. Of a quasi-periodic series it converges
/// faster than any power of its length, while a plain mean only does with the first.
pub fn smooth_mean(values: &[f64]) -> f64 {
    let weight = |k: usize| {
        let s = (k as f64 + 0.5) / values.len() as f64;
        (-1.0 / (s * (1.0 - s))).exp()
    };
    let sum: f64 = values.iter().enumerate().map(|(k, value)| weight(k) * value).sum();
    sum / (0..values.len()).map(weight).sum::<f64>()
}
