//! Solutions of differential equations by a method that knows nothing of groups.

use std::ops::{Add, Mul, Sub};

/// The state after a time, by RK4 in so many steps, in twice and in four times as many, without the terms of orders 4 and 5 of the error.
pub(super) fn reference<V>(start: &V, time: f64, steps: u32, field: impl Fn(&V) -> V) -> V
where
    V: Clone + Add<Output = V> + Sub<Output = V> + Mul<f64, Output = V>,
{
    let run = |steps: u32| {
        let h = time / f64::from(steps);
        let along = |x: &V, k: &V, part: f64| x.clone() + k.clone() * (h * part);
        (0..steps).fold(start.clone(), |x, _| {
            let k1 = field(&x);
            let k2 = field(&along(&x, &k1, 0.5));
            let k3 = field(&along(&x, &k2, 0.5));
            let k4 = field(&along(&x, &k3, 1.0));
            x + (k1 + (k2 + k3) * 2.0 + k4) * (h / 6.0)
        })
    };
    let [coarse, middle, fine] = [1, 2, 4].map(|k| run(k * steps));
    let without = |long: &V, short: &V, order: f64| {
        short.clone() + (short.clone() - long.clone()) * (1.0 / (order.exp2() - 1.0))
    };
    without(&without(&coarse, &middle, 4.0), &without(&middle, &fine, 4.0), 5.0)
}
