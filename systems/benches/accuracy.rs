//! What accuracy costs: `cargo bench --features bench --bench accuracy`.
//!
//! The free rigid body of the paper over 1800 s, attitude included: compositions of high order against DOP853, the method of order 8 with a
//! variable step of Hairer, Nørsett and Wanner, as the crate `ode_solvers` has it. Errors are those of all components at the end, against
//! a step a third as long with the composition of order 10.
// a benchmark that cannot be made is to say so
#![allow(clippy::unwrap_used)]

use std::time::Instant;

use coadjoint::nalgebra::SVector;
use coadjoint::prelude::*;
use coadjoint::{Discretized, Run};
use coadjoint_systems::free_rigid_body::{FreeRigidBody, FreeRigidBodyState};
use ode_solvers::dop_shared::OutputType;
use ode_solvers::{Dop853, SVector as Column};

/// How long, s.
const DURATION: f64 = 1800.0;
/// The error that is asked for.
const ERROR: f64 = 1e-8;
/// How often each is timed; the best counts.
const ROUNDS: usize = 10;

type State = SVector<f64, 7>;

const INERTIA: [f64; 3] = [1.0, 10.0, 100.0];

/// The quaternion, scalar part first, and the momentum.
struct Euler;

impl ode_solvers::System<f64, Column<f64, 7>> for Euler {
    fn system(&self, _: f64, y: &Column<f64, 7>, rate: &mut Column<f64, 7>) {
        let ([a, b, c, d], [x, y, z]) = ([y[0], y[1], y[2], y[3]], [y[4], y[5], y[6]]);
        const INVERSE: [f64; 3] = [1.0 / INERTIA[0], 1.0 / INERTIA[1], 1.0 / INERTIA[2]];
        let [u, v, w] = [x * INVERSE[0], y * INVERSE[1], z * INVERSE[2]];
        rate[0] = -0.5 * (b * u + c * v + d * w);
        rate[1] = 0.5 * (a * u + c * w - d * v);
        rate[2] = 0.5 * (a * v + d * u - b * w);
        rate[3] = 0.5 * (a * w + b * v - c * u);
        rate[4] = y * w - z * v;
        rate[5] = z * u - x * w;
        rate[6] = x * v - y * u;
    }
}

fn dop853(tolerance: f64) -> State {
    let start = Column::from([1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
    let mut stepper = Dop853::from_param(
        Euler,
        0.0,
        DURATION,
        DURATION,
        start,
        tolerance,
        tolerance,
        0.9,
        0.0,
        0.333,
        6.0,
        DURATION,
        0.0,
        u32::MAX,
        u32::MAX,
        // its interpolation would cost accuracy
        OutputType::Sparse,
    );
    stepper.integrate().unwrap();
    State::from_column_slice(stepper.y_out().last().unwrap().as_slice())
}

fn composed<M>(step: f64) -> State
where
    FreeRigidBody: Discretized<M>,
{
    let body = FreeRigidBody { inertia: INERTIA.into() };
    let mut state =
        FreeRigidBodyState { attitude: UnitQuaternion::identity(), momentum: vector![1.0, 1.0, 1.0] };
    let steps = (DURATION / step).round();
    let mut stepper = body.stepper::<M>(DURATION / steps).unwrap();
    Run::new(&mut stepper, &mut state).steps(steps as u64).unwrap();
    let (q, m) = (state.attitude, state.momentum);
    State::from([q.w, q.i, q.j, q.k, m.x, m.y, m.z])
}

/// The distance, where a quaternion is as good as its opposite.
fn distance(a: &State, b: &State) -> f64 {
    let mut opposite = *b;
    opposite.fixed_rows_mut::<4>(0).neg_mut();
    (a - b).norm().min((a - opposite).norm())
}

fn main() {
    let exact = composed::<Order10<Exponential>>(0.05);
    println!(
        "to an error of {ERROR:e} after {DURATION} s\n{:28} {:>10} {:>9} {:>9} {:>9}",
        "", "step", "error", "Casimir", "ms"
    );
    let tolerances = (0..).map(|k| 1e-9 * 0.8_f64.powi(k));
    let dop = report("DOP853", tolerances, &exact, dop853);
    // backwards from where the error is too large
    let steps = || (0..).map(|k| 1.2 * 0.97_f64.powi(k));
    for (name, run) in [
        ("order 6, exponential", composed::<Order6<Exponential>> as fn(f64) -> State),
        ("order 8, exponential", composed::<Order8<Exponential>>),
        ("order 10, exponential", composed::<Order10<Exponential>>),
        ("order 8, Cayley", composed::<Order8<Cayley>>),
        ("order 8, exponential, fused", composed::<Fused<Order8<Exponential>>>),
        ("order 10, exponential, fused", composed::<Fused<Order10<Exponential>>>),
    ] {
        let time = report(name, steps(), &exact, run);
        println!("{:28} {:.1} × DOP853", "", time / dop);
    }
}

/// The first of the settings that reaches the error; the time that it takes.
fn report(
    name: &str,
    mut settings: impl Iterator<Item = f64>,
    exact: &State,
    run: impl Fn(f64) -> State,
) -> f64 {
    let setting = settings.find(|&setting| distance(&run(setting), exact) <= ERROR).unwrap();
    let mut best = f64::INFINITY;
    let mut end = *exact;
    for _ in 0..ROUNDS {
        let clock = Instant::now();
        end = run(setting);
        best = best.min(clock.elapsed().as_secs_f64());
    }
    let casimir = (end.fixed_rows::<3>(4).norm_squared() / 3.0 - 1.0).abs();
    let (error, ms) = (distance(&end, exact), best * 1e3);
    println!("{name:24} {setting:10.2e} {error:9.1e} {casimir:9.1e} {ms:9.2}");
    best
}
