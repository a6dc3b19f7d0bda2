//! Trajectories against references of 40 digits: the methods have the order they claim, and nothing but roundoff besides.

use std::sync::LazyLock;

use coadjoint::prelude::*;
use coadjoint::{Discretized, System};
use coadjoint_support::measure::{largest, order};
use coadjoint_support::systems::{FreeRigidBody, FreeRigidBodyState, HeavyTop, HeavyTopState};
use serde::Deserialize;

/// The file of references.
#[derive(Deserialize)]
struct References {
    cases: Vec<Case>,
}

#[derive(Deserialize)]
struct Case {
    name: String,
    inertia: [f64; 3],
    weight_chi: [f64; 3],
    initial: Point,
    states: Vec<Point>,
}

/// A state of the reference, with its time unless it is the initial one.
#[derive(Deserialize)]
struct Point {
    #[serde(default)]
    time: f64,
    momentum: [f64; 3],
    gamma: [f64; 3],
    attitude_wxyz: [f64; 4],
}

static REFERENCES: LazyLock<References> = LazyLock::new(|| {
    serde_json::from_str(include_str!("../../data/reference.json")).expect("the references can be read")
});

impl Point {
    fn attitude(&self) -> UnitQuaternion<f64> {
        let [w, x, y, z] = self.attitude_wxyz;
        UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z))
    }
}

/// A case of the file as a system, with which part of the reference its state shows.
trait Referenced: System<Scalar = f64> + Discretized<Exponential> + Discretized<Cayley> {
    fn of(case: &Case) -> Self;
    fn state(point: &Point) -> Self::State;
}

impl Referenced for FreeRigidBody {
    fn of(case: &Case) -> Self {
        assert_eq!(case.weight_chi, [0.0; 3], "{} is not free", case.name);
        Self { inertia: case.inertia.into() }
    }

    fn state(point: &Point) -> FreeRigidBodyState {
        FreeRigidBodyState { attitude: point.attitude(), momentum: point.momentum.into() }
    }
}

impl Referenced for HeavyTop {
    fn of(case: &Case) -> Self {
        // the weight in a parameter of its own, so that both take part
        Self { inertia: case.inertia.into(), weight: 0.5, chi: Vector3::from(case.weight_chi) * 2.0 }
    }

    fn state(point: &Point) -> HeavyTopState {
        HeavyTopState {
            attitude: point.attitude(),
            momentum: point.momentum.into(),
            gamma: point.gamma.into(),
        }
    }
}

/// The error of every component of the state at `t = 1`, after `n` steps.
fn error<S: Referenced + Discretized<M>, M>(case: &Case, n: u32) -> Vec<f64> {
    let end = case.states.iter().find(|state| state.time == 1.0).expect("a reference at t = 1");
    let mut stepper = S::of(case).stepper::<M>(1.0 / f64::from(n)).expect("a stepper");
    let mut state = S::state(&case.initial);
    for _ in 0..n {
        stepper.step(&mut state).expect("a step");
    }
    let (reached, expected) = (state.to_components(), S::state(end).to_components());
    let (reached, expected) = (reached.as_ref(), expected.as_ref());
    // a rotation is two unit quaternions: take the one on the same side
    let dot: f64 = (0..4).map(|k| reached[k] * expected[k]).sum();
    let sign = |k: usize| if k < 4 { dot.signum() } else { 1.0 };
    (0..reached.len()).map(|k| reached[k] * sign(k) - expected[k]).collect()
}

fn size(error: &[f64]) -> f64 {
    largest(error.iter().copied())
}

fn each_case(check: fn(&Case)) {
    assert!(REFERENCES.cases.len() >= 4, "free rigid body and heavy tops");
    REFERENCES.cases.iter().for_each(check);
}

/// Calls a check for one case with both retractions, for the top and, where nothing pulls, also for the free body.
macro_rules! with_both_retractions {
    ($check:ident, $case:expr) => {{
        let case: &Case = $case;
        if case.weight_chi == [0.0; 3] {
            $check::<FreeRigidBody, Exponential>(case, "free body, exponential");
            $check::<FreeRigidBody, Cayley>(case, "free body, Cayley");
        }
        $check::<HeavyTop, Exponential>(case, "top, exponential");
        $check::<HeavyTop, Cayley>(case, "top, Cayley");
    }};
}

/// The error falls with the square of the step.
#[test]
fn the_measured_order_is_two() {
    fn check<S: Referenced + Discretized<M>, M>(case: &Case, what: &str) {
        let points: Vec<_> =
            [32_u32, 64, 128, 256, 512].map(|n| (1.0 / f64::from(n), size(&error::<S, M>(case, n)))).to_vec();
        let order = order(&points);
        println!(
            "{}, {what}: order {order:.4}, errors {:.2e} to {:.2e}",
            case.name, points[0].1, points[4].1
        );
        // far enough from roundoff, which would flatten the slope
        assert!(points[4].1 > 1e-10, "{}, {what}: {points:?}", case.name);
        assert!((order - 2.0).abs() < 0.05, "{}, {what}: order {order}, {points:?}", case.name);
    }
    each_case(|case| with_both_retractions!(check, case));
}

/// At `h = 1e-3` the error is what larger steps predict, component by component.
///
/// The step is symmetric, so its error has an expansion in even powers of `h`: three step sizes determine the coefficients of `h²`,
/// `h⁴` and `h⁶`. What the prediction misses is not an error of the method; a floor would show there.
#[test]
fn the_error_at_a_thousandth_is_what_the_order_predicts() {
    fn check<S: Referenced + Discretized<M>, M>(case: &Case, what: &str) {
        let coarse = [125_u32, 250, 500].map(|n| (1.0 / f64::from(n), error::<S, M>(case, n)));
        let actual = error::<S, M>(case, 1000);
        let predicted: Vec<f64> = (0..actual.len())
            .map(|k| {
                let points = coarse.each_ref().map(|(h, error)| (h * h, error[k] / (h * h)));
                1e-6 * extrapolate(&points, 1e-6)
            })
            .collect();
        let unexplained = largest(actual.iter().zip(&predicted).map(|(a, b)| a - b));

        // and in size, what the next larger step says by the order alone
        let ratio = size(&coarse[2].1) / size(&actual);
        println!(
            "{}, {what}: error {:.3e}, unexplained {unexplained:.1e}, ratio to twice the step {ratio:.4}",
            case.name,
            size(&actual)
        );
        assert!((ratio / 4.0 - 1.0).abs() < 0.01, "{}, {what}: ratio {ratio}", case.name);
        assert!(unexplained < 1e-13, "{}, {what}: floor of {unexplained:e}", case.name);
    }
    each_case(|case| with_both_retractions!(check, case));
}

/// Extrapolated to `h = 0`, nothing is left: four levels remove `h²`, `h⁴` and `h⁶`, and what remains is roundoff.
#[test]
fn nothing_is_left_at_step_zero() {
    fn check<S: Referenced + Discretized<M>, M>(case: &Case, what: &str) {
        let levels = [250_u32, 500, 1000, 2000].map(|n| (1.0 / f64::from(n).powi(2), error::<S, M>(case, n)));
        let components = levels[0].1.len();
        let limit = (0..components).map(|k| {
            let points = levels.each_ref().map(|(h2, error)| (*h2, error[k]));
            extrapolate(&points, 0.0)
        });
        let floor = largest(limit);
        println!("{}, {what}: {floor:.1e} at step zero", case.name);
        assert!(floor < 1e-13, "{}, {what}: floor of {floor:e}", case.name);
    }
    each_case(|case| with_both_retractions!(check, case));
}

/// The polynomial through points `(x, y)`, at `x`.
fn extrapolate(points: &[(f64, f64)], x: f64) -> f64 {
    let basis = |i: usize| -> f64 {
        let others = points.iter().enumerate().filter(|(j, _)| *j != i);
        others.map(|(_, (xj, _))| (x - xj) / (points[i].0 - xj)).product()
    };
    (0..points.len()).map(|i| points[i].1 * basis(i)).sum()
}
