//! How well quantities are conserved, measured.

use coadjoint_app::record::DriftStats;

fn drift_stats(value: impl Fn(f64) -> f64) -> DriftStats {
    let mut stats = DriftStats::new(value(0.0));
    for k in 0..=10_000 {
        let time = 1e6 + f64::from(k) * 0.01;
        stats.push(time, value(time - 1e6));
    }
    stats
}

#[test]
fn a_drift_is_told_from_an_oscillation() {
    let drifting = drift_stats(|t| 5.0 - 2e-6 * t + 1e-7 * t.sin());
    assert!((drifting.slope() + 2e-6).abs() < 1e-8, "{}", drifting.slope());
    assert!(drifting.drift() > 0.99 && drifting.drift() < 1.01, "{}", drifting.drift());
    assert!((drifting.error - 2e-4).abs() < 1e-6);

    let swinging = drift_stats(|t| 5.0 + 1e-6 * (3.0 * t).sin());
    assert!(swinging.drift() < 0.02, "{}", swinging.drift());
    assert!((swinging.error - 1e-6).abs() < 1e-9);
    assert!(swinging.range.0 < -0.99e-6 && swinging.range.1 > 0.99e-6);

    let constant = drift_stats(|_| 5.0);
    assert_eq!((constant.error, constant.slope(), constant.drift()), (0.0, 0.0, 0.0));
}

#[test]
fn what_is_not_a_number_stays_so() {
    let mut stats = DriftStats::new(1.0);
    for value in [1.5, f64::NAN, 1.25] {
        stats.push(0.0, value);
    }
    assert!(stats.error.is_nan());
}
