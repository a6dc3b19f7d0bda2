//! The applications of exact derivatives: what the textbook promises of each.

use coadjoint::prelude::*;
use coadjoint_systems::applications::{Spacecraft, estimation, identification, steering};
use nalgebra::SVector;

#[test]
fn the_inertia_is_found_within_its_own_error_bars() {
    let (truth, momentum) = (Spacecraft::small(), vector![0.4, -0.5, 0.3]);
    let guess = Matrix3::from_diagonal_element(2.0);
    let mut normalized = Vec::new();
    for seed in 0..8 {
        let samples = identification::experiment(&truth, momentum, seed).expect("solvable");
        let estimates = identification::identify(&samples, guess).expect("determined");
        let last = estimates.last().expect("an estimate");
        assert!(estimates[0].residual > 50.0 * identification::NOISE, "{}", estimates[0].residual);
        // nine numbers were fitted to three times as many samples: what is left is noise
        let freedom = 1.0 - 9.0 / (3.0 * samples.len() as f64);
        let noise = last.residual / freedom.sqrt();
        assert!((noise / identification::NOISE - 1.0).abs() < 0.1, "{noise}");

        let entry = |m: &Matrix3<f64>| [m[(0, 0)], m[(1, 1)], m[(2, 2)], m[(0, 1)], m[(0, 2)], m[(1, 2)]];
        let difference = last.inertia - truth.inertia;
        let error = SVector::<f64, 9>::from_iterator(
            entry(&difference).into_iter().chain((last.momentum - momentum).iter().copied()),
        );
        let inverse = last.covariance.cholesky().expect("positive definite");
        normalized.push(error.dot(&inverse.solve(&error)));
        assert!(difference.amax() < 0.008, "{difference}");

        // Gauss and Newton's method, with exact derivatives and small residuals: in the end each iteration is as good as a hundred times the one before
        let changes: Vec<f64> =
            estimates.windows(2).map(|pair| (pair[1].inertia - pair[0].inertia).norm()).collect();
        let end = changes.iter().rev().take_while(|change| **change < 0.05).count();
        for pair in changes[changes.len() - end..].windows(2).filter(|pair| pair[1] > 1e-12) {
            assert!(pair[1] < 0.02 * pair[0], "{changes:?}");
        }
    }
    // χ² with nine degrees of freedom, its mean over eight: 9 ± 1.5
    let mean = normalized.iter().sum::<f64>() / normalized.len() as f64;
    assert!((4.5..13.5).contains(&mean), "{mean}: {normalized:?}");
}

#[test]
fn the_manoeuvre_ends_where_it_should_with_least_effort() {
    let craft = Spacecraft::small();
    let target = UnitQuaternion::from_scaled_axis(vector![1.2, -0.8, 1.5]);
    let manoeuvres = steering::steer(&craft, &target).expect("reachable");
    let best = manoeuvres.last().expect("a manoeuvre");
    assert!(manoeuvres[0].terminal_error.norm() > 2.0);
    assert!(best.terminal_error.norm() < 1e-12, "{}", best.terminal_error);

    // effort falls in no direction that keeps the end: the pulses are in the range of Eᵀ
    let (u, e) = (best.stacked(), &best.wrt_pulses);
    let across = &u - e.transpose() * (e * e.transpose()).cholesky().expect("full rank").solve(&(e * &u));
    assert!(across.norm() < 1e-10 * u.norm(), "{}", across.norm());
    // and not because there is no other way: one after the other about fixed axes, it takes more
    let end = |pulses: &[Vector3<f64>]| steering::trajectory(&craft, &target, pulses).expect("solvable");
    let (_, left) = end(&best.pulses).last().copied().expect("a trajectory");
    assert!(left.norm() < 1e-12, "{left}");
    let mut other = best.pulses.clone();
    other.reverse();
    assert!(end(&other).last().is_some_and(|(_, left)| left.norm() > 1e-3));
}

#[test]
fn the_filter_is_consistent() {
    let craft = Spacecraft::small();
    let (mut normalized, mut turned, mut flights) = (0.0, 0.0, 0.0);
    for seed in 0..60 {
        let updates = estimation::simulate(&craft, seed).expect("solvable");
        let last = updates.last().expect("an update");
        normalized += last.nees().expect("positive definite");
        turned += last.error.fixed_rows::<3>(0).norm_squared();
        flights += 1.0;
        // the momentum is not measured, and is estimated all the same
        let momentum = last.error.fixed_rows::<3>(3).norm();
        assert!(momentum < 0.05 * estimation::MOMENTUM_DEVIATION, "{momentum}");
    }
    // χ² with six degrees of freedom, its mean over 60 flights: 6 ± 0.45
    let mean = normalized / flights;
    assert!((4.7..7.3).contains(&mean), "{mean}");
    // better than one measurement of the stars
    let attitude = (turned / flights / 3.0).sqrt();
    assert!(attitude < 0.6 * estimation::STAR_NOISE, "{attitude}");
}
