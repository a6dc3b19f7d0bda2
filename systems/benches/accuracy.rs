//! What accuracy costs: `cargo bench --features bench --bench accuracy`.
//!
//! A free rigid body and a heavy top with moments 1, 10, 100 kg m² over 1800 s, attitude included. Hamilton–Jacobi steps and compositions
//! against RK4 written by hand on quaternions, and DOP853, the method of order 8 with a variable step of Hairer, Nørsett and Wanner, as the
//! crate `ode_solvers` has it. Each row is nanoseconds for a simulated second at some errors of the end state, between the two settings that
//! enclose the error, and in brackets the step. The errors are those of all components, against a composition of order 10.
// a benchmark that cannot be made is to say so
#![allow(clippy::unwrap_used)]

use std::time::Instant;

use coadjoint::nalgebra::SVector;
use coadjoint::prelude::*;
use coadjoint::taylor::PowerSeries;
use coadjoint::{Discretized, Run, System};
use ode_solvers::dop_shared::OutputType;
use ode_solvers::{Dop853, SVector as Column};

/// How long, s.
const DURATION: f64 = 1800.0;
/// How often each is timed; the best counts.
const ROUNDS: usize = 3;
/// The errors that are asked for.
const ERRORS: [f64; 5] = [1e-3, 1e-4, 1e-6, 1e-8, 1e-10];

const INERTIA: [f64; 3] = [1.0, 10.0, 100.0];
const CHI: [f64; 3] = [0.3, 0.2, 1.0];

/// The quaternion, scalar part first, the momentum, and the vertical.
type State = SVector<f64, 10>;

/// A free rigid body.
#[lie_poisson_system(
    group = SO3,
    retractions(Exponential),
    methods(HamiltonJacobi(4), HamiltonJacobi(6), HamiltonJacobi(8), HamiltonJacobi(10)),
    taylor
)]
struct Body {
    #[inertia]
    inertia: Vector3<f64>,
}

/// A heavy top.
#[lie_poisson_system(
    group = SO3,
    advected(gamma: R3),
    potential = gamma.dot(&chi),
    retractions(Exponential),
    methods(HamiltonJacobi(4), HamiltonJacobi(6), HamiltonJacobi(8)),
    taylor
)]
struct Top {
    #[inertia]
    inertia: Vector3<f64>,
    chi: Vector3<f64>,
}

fn start() -> [f64; 10] {
    [1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 1.0]
}

/// The equations of motion, of a body or a top.
#[inline(always)]
fn rate<const TOP: bool>(state: &[f64; 10], rate: &mut [f64; 10]) {
    const INVERSE: [f64; 3] = [1.0 / INERTIA[0], 1.0 / INERTIA[1], 1.0 / INERTIA[2]];
    let [a, b, c, d, x, y, z, g0, g1, g2] = *state;
    let [u, v, w] = [x * INVERSE[0], y * INVERSE[1], z * INVERSE[2]];
    rate[0] = -0.5 * (b * u + c * v + d * w);
    rate[1] = 0.5 * (a * u + c * w - d * v);
    rate[2] = 0.5 * (a * v + d * u - b * w);
    rate[3] = 0.5 * (a * w + b * v - c * u);
    rate[4] = y * w - z * v;
    rate[5] = z * u - x * w;
    rate[6] = x * v - y * u;
    if TOP {
        rate[4] += g1 * CHI[2] - g2 * CHI[1];
        rate[5] += g2 * CHI[0] - g0 * CHI[2];
        rate[6] += g0 * CHI[1] - g1 * CHI[0];
        rate[7] = g1 * w - g2 * v;
        rate[8] = g2 * u - g0 * w;
        rate[9] = g0 * v - g1 * u;
    }
}

struct Equations<const TOP: bool>;

impl<const TOP: bool> ode_solvers::System<f64, Column<f64, 10>> for Equations<TOP> {
    fn system(&self, _: f64, state: &Column<f64, 10>, out: &mut Column<f64, 10>) {
        let mut change = [0.0; 10];
        rate::<TOP>(&state.as_slice().try_into().unwrap(), &mut change);
        out.copy_from_slice(&change);
    }
}

fn dop853<const TOP: bool>(tolerance: f64) -> State {
    let mut stepper = Dop853::from_param(
        Equations::<TOP>,
        0.0,
        DURATION,
        DURATION,
        Column::from(start()),
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

fn rk4<const TOP: bool>(step: f64) -> State {
    let steps = (DURATION / step).round();
    let (h, length) = (DURATION / steps, if TOP { 10 } else { 7 });
    let mut state = start();
    let [mut a, mut b, mut c, mut d] = [[0.0; 10]; 4];
    for _ in 0..steps as u64 {
        let moved = |by: f64, k: &[f64; 10]| {
            let mut moved = state;
            (0..length).for_each(|i| moved[i] += by * k[i]);
            moved
        };
        rate::<TOP>(&state, &mut a);
        rate::<TOP>(&moved(0.5 * h, &a), &mut b);
        rate::<TOP>(&moved(0.5 * h, &b), &mut c);
        rate::<TOP>(&moved(h, &c), &mut d);
        (0..length).for_each(|i| state[i] += h / 6.0 * (a[i] + 2.0 * (b[i] + c[i]) + d[i]));
    }
    State::from(state)
}

/// A run of ours; what is not a number if a step cannot be taken.
fn run<S: Discretized<M> + System<Scalar = f64>, M>(system: &S, start: S::State, step: f64) -> State {
    let steps = (DURATION / step).round();
    let (mut state, mut end) = (start, State::from_element(f64::NAN));
    let mut stepper = system.stepper::<M>(DURATION / steps).unwrap();
    if Run::new(&mut stepper, &mut state).steps(steps as u64).is_ok() {
        let components = state.to_components();
        // a free body has no vertical to turn
        end = State::from(self::start());
        end.as_mut_slice()[..components.as_ref().len()].copy_from_slice(components.as_ref());
    }
    end
}

/// Taylor steps of ours.
fn taylor<S: PowerSeries + System<Scalar = f64>>(system: &S, mut state: S::State, tolerance: f64) -> State {
    let mut end = State::from(self::start());
    system.adaptive(tolerance).unwrap().to(&mut state, DURATION).unwrap();
    let components = state.to_components();
    end.as_mut_slice()[..components.as_ref().len()].copy_from_slice(components.as_ref());
    end
}

fn a_body() -> (Body, BodyState) {
    let start = BodyState { attitude: UnitQuaternion::identity(), momentum: vector![1.0, 1.0, 1.0] };
    (Body { inertia: INERTIA.into() }, start)
}

fn a_top() -> (Top, TopState) {
    let momentum = vector![1.0, 1.0, 1.0];
    let start = TopState { attitude: UnitQuaternion::identity(), momentum, gamma: Vector3::z() };
    (Top { inertia: INERTIA.into(), chi: CHI.into() }, start)
}

fn body<M>(step: f64) -> State
where
    Body: Discretized<M>,
{
    let (body, start) = a_body();
    run::<_, M>(&body, start, step)
}

fn top<M>(step: f64) -> State
where
    Top: Discretized<M>,
{
    let (top, start) = a_top();
    run::<_, M>(&top, start, step)
}

/// The distance, where a quaternion is as good as its opposite.
fn distance(a: &State, b: &State) -> f64 {
    let mut opposite = *b;
    opposite.fixed_rows_mut::<4>(0).neg_mut();
    (a - b).norm().min((a - opposite).norm())
}

/// Settings from one that is too large to one that is too small.
fn settings(from: f64, to: f64, factor: f64) -> impl Iterator<Item = f64> {
    (0..).map(move |k| from * factor.powi(k)).take_while(move |&setting| setting >= to)
}

/// A row: the cost at each of the errors.
fn row(name: &str, exact: &State, settings: impl Iterator<Item = f64>, run: impl Fn(f64) -> State) {
    let measure = |setting: f64| {
        let (mut best, mut end) = (f64::INFINITY, *exact);
        for _ in 0..ROUNDS {
            let clock = Instant::now();
            end = run(setting);
            best = best.min(clock.elapsed().as_secs_f64());
        }
        [distance(&end, exact), best * 1e9 / DURATION, setting].map(f64::ln)
    };
    let points: Vec<[f64; 3]> = settings.map(measure).filter(|[error, ..]| error.is_finite()).collect();
    let cost = |error: f64| {
        let pair = points.windows(2).find(|pair| pair[0][0] >= error.ln() && pair[1][0] < error.ln())?;
        let share = (error.ln() - pair[0][0]) / (pair[1][0] - pair[0][0]);
        let between = |k: usize| (pair[0][k] + share * (pair[1][k] - pair[0][k])).exp();
        Some(format!("{:.0} ({:.1e})", between(1), between(2)))
    };
    let cells = ERRORS.map(|error| format!("{:>16}", cost(error).unwrap_or_else(|| "–".to_owned())));
    println!("{name:16}{}", cells.concat());
}

/// The rows of a system.
macro_rules! rows {
    ($name:literal, $top:literal, $run:ident, $start:ident, [$($order:literal),*]) => {{
        let exact = $run::<Order10<Exponential>>(0.05);
        let errors = ERRORS.map(|error| format!("{error:>16e}"));
        println!("{:16}{}", $name, errors.concat());
        row("RK4", &exact, settings(0.2, 1e-3, 0.7), rk4::<$top>);
        row("DOP853", &exact, settings(1e-3, 1e-14, 0.5), dop853::<$top>);
        row("Taylor", &exact, settings(1e-2, 1e-15, 0.5), |tolerance| {
            let (system, start) = $start();
            taylor(&system, start, tolerance)
        });
        row("composed, 4", &exact, settings(0.5, 4e-3, 0.7), $run::<Order4<Exponential>>);
        row("composed, 6", &exact, settings(1.0, 0.02, 0.8), $run::<Order6<Exponential>>);
        row("composed, 8", &exact, settings(1.0, 0.05, 0.8), $run::<Order8<Exponential>>);
        $(row(
            concat!("one equation, ", $order),
            &exact,
            settings(1.5, if $order == 4 { 4e-3 } else { 0.02 }, 0.8),
            $run::<HamiltonJacobi<Exponential, $order>>,
        );)*
    }};
}

fn main() {
    rows!("free body", false, body, a_body, [4, 6, 8, 10]);
    rows!("heavy top", true, top, a_top, [4, 6, 8]);
}
