//! Symmetric compositions: the orders they claim, the structure they keep.
#![allow(clippy::unwrap_used, reason = "in a test, a panic is the report")]

use coadjoint::Discretized;
use coadjoint::composition::{Coefficients, KahanLi6, KahanLi8, SofroniouSpaletta10, Suzuki4};
use coadjoint::prelude::*;
use coadjoint_systems::heavy_top::{HeavyTop, HeavyTopState};
use serde_json::Value;

/// A compact top of the reference file, its start, and its state at `t = 1`.
fn compact_top() -> (HeavyTop, HeavyTopState, Vec<f64>) {
    let file: Value = serde_json::from_str(include_str!("../../data/reference.json")).unwrap();
    let case =
        file["cases"].as_array().unwrap().iter().find(|case| case["name"] == "heavy_top_compact").unwrap();
    let numbers =
        |value: &Value| value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect::<Vec<f64>>();
    let vector = |value: &Value| Vector3::from_column_slice(&numbers(value));
    let top = HeavyTop { inertia: vector(&case["inertia"]), weight: 1.0, chi: vector(&case["weight_chi"]) };
    let start = HeavyTopState {
        attitude: UnitQuaternion::identity(),
        momentum: vector(&case["initial"]["momentum"]),
        gamma: vector(&case["initial"]["gamma"]),
    };
    let end = &case["states"][0];
    assert_eq!(end["time"], 1);
    let end = ["attitude_wxyz", "momentum", "gamma"].map(|part| numbers(&end[part])).concat();
    (top, start, end)
}

/// The largest error at `t = 1` with so many steps.
fn error<M>(steps: u32) -> f64
where
    HeavyTop: Discretized<M>,
{
    let (top, mut state, end) = compact_top();
    let mut stepper = top.stepper::<M>(1.0 / f64::from(steps)).unwrap();
    for _ in 0..steps {
        stepper.step(&mut state).unwrap();
    }
    state.to_components().iter().zip(&end).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// The order of a scheme, for at least three numbers of steps whose errors are well above
/// roundoff.
fn order<M>(steps: &[u32]) -> f64
where
    HeavyTop: Discretized<M>,
{
    assert!(steps.len() >= 3);
    let points: Vec<(f64, f64)> = steps
        .iter()
        .map(|&n| {
            let error = error::<M>(n);
            assert!(error > 3e-14, "{n} steps leave only roundoff: {error:e}");
            (1.0 / f64::from(n), error)
        })
        .collect();
    coadjoint_support::measure::order(&points)
}

/// Bounds on measured orders: what the first terms of the error leave at these steps, measured, and some room.
#[test]
fn orders_are_as_claimed() {
    let measured = [
        (order::<Order4<Exponential>>(&[8, 16, 32]), 4.0, 0.02),
        (order::<Order4<Cayley>>(&[16, 32, 64]), 4.0, 0.03),
        (order::<Order6<Exponential>>(&[3, 4, 6, 8]), 6.0, 0.05),
        (order::<Order6<Cayley>>(&[12, 16, 24]), 6.0, 0.1),
        (order::<Order8<Exponential>>(&[3, 4, 5]), 8.0, 0.15),
        (order::<Order8<Cayley>>(&[6, 8, 10, 12]), 8.0, 0.2),
        (order::<Order10<Cayley>>(&[3, 4, 5, 6]), 10.0, 0.4),
    ];
    for (measured, claimed, room) in measured {
        println!("order {claimed}: measured {measured:.4}");
        assert!((measured - claimed).abs() < room, "order {claimed}: measured {measured}");
    }
    // with the exponential, order 10 is at roundoff before three step sizes show a slope; two show this much
    let (one, two) = (error::<Order10<Exponential>>(1), error::<Order10<Exponential>>(2));
    assert!(one / two > 2f64.powf(9.5), "order 10, exponential: {one:e}, {two:e}");
}

/// What makes them what they are called: a step in all, the same forwards as backwards, and the odd power sums that order 4
/// asks for.
#[test]
fn coefficients_are_consistent() {
    fn check<C: Coefficients>() {
        let gamma = C::GAMMA;
        assert!((gamma.iter().sum::<f64>() - 1.0).abs() < 1e-15, "order {}", C::ORDER);
        assert!((gamma.iter().map(|g| g.powi(3)).sum::<f64>()).abs() < 1e-15, "order {}", C::ORDER);
        assert!(gamma.iter().eq(gamma.iter().rev()), "order {}", C::ORDER);
        assert_eq!(gamma.len(), C::steps(|_| ()).as_mut().len());
        if C::ORDER >= 6 {
            assert!((gamma.iter().map(|g| g.powi(5)).sum::<f64>()).abs() < 1e-15, "order {}", C::ORDER);
        }
    }
    check::<Suzuki4>();
    check::<KahanLi6>();
    check::<KahanLi8>();
    check::<SofroniouSpaletta10>();
}

/// A composition of symmetric steps that keep the Casimirs is symmetric and keeps them.
#[test]
fn compositions_are_reversible_and_keep_casimirs() {
    fn check<M>()
    where
        HeavyTop: Discretized<M>,
    {
        let (top, start, _) = compact_top();
        let mut state = start;
        let mut forth = top.stepper::<M>(0.2).unwrap();
        let mut back = top.stepper::<M>(-0.2).unwrap();
        for _ in 0..50 {
            forth.step(&mut state).unwrap();
        }
        for (now, before) in top.casimirs(&state).iter().zip(top.casimirs(&start)) {
            assert!((now - before).abs() < 2e-14, "{now} {before}");
        }
        for _ in 0..50 {
            back.step(&mut state).unwrap();
        }
        let (here, there) = (state.to_components(), start.to_components());
        let gap = here.iter().zip(&there).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(gap < 2e-12, "{gap:e}");
    }
    check::<Order4<Exponential>>();
    check::<Order6<Cayley>>();
    check::<Order8<Exponential>>();
    check::<Order10<Cayley>>();
}

/// Where a step within fails, the state is as before.
#[test]
fn a_failing_composition_leaves_the_state() {
    let (top, start, _) = compact_top();
    let mut state = start;
    let mut stepper = top.stepper::<Order8<Exponential>>(100.0).unwrap();
    assert!(stepper.step(&mut state).is_err());
    assert_eq!(state, start);
}
