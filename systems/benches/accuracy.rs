//! What accuracy costs: `cargo bench --features bench --bench accuracy`, and a part of a name behind `--` for some systems only.
//!
//! Motions of six systems, attitude included: Hamilton–Jacobi steps, compositions and Taylor steps; for the free rigid body and the heavy top,
//! with moments 1, 10, 100 kg m² over 1800 s, also RK4 written by hand on quaternions, and DOP853, the method of order 8 with a variable step
//! of Hairer, Nørsett and Wanner, as the crate `ode_solvers` has it. Each row is nanoseconds for a simulated second at some errors of the end
//! state, between the two settings that enclose the error, and in brackets the step. An error is the distance of all components, relative to
//! the size of the state, from a composition of order 10.
// a benchmark that cannot be made is to say so
#![allow(clippy::unwrap_used)]

use std::time::Instant;

use coadjoint::prelude::*;
use coadjoint::taylor::PowerSeries;
use coadjoint::{Discretized, NoControl, System};
use ode_solvers::dop_shared::OutputType;
use ode_solvers::{Dop853, SVector as Column};

/// How often each is timed; the best counts.
const ROUNDS: usize = 3;
/// The errors that are asked for.
const ERRORS: [f64; 5] = [1e-3, 1e-4, 1e-6, 1e-8, 1e-10];

/// How long a body and a top are followed, s.
const DURATION: f64 = 1800.0;
const INERTIA: [f64; 3] = [1.0, 10.0, 100.0];
const CHI: [f64; 3] = [0.3, 0.2, 1.0];

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

/// A body with four propellers, whose forces are held.
#[lie_poisson_system(
    group(attitude: SO3, position: R3),
    control(moment: R3, thrust: f64),
    potential = mass * gravity * position.z,
    force(attitude = moment, position = attitude * (thrust * Vector3::z())),
    retractions(Exponential),
    methods(HamiltonJacobi(4), HamiltonJacobi(6))
)]
struct Quadrotor {
    #[inertia(attitude)]
    inertia: Vector3<f64>,
    #[inertia(position)]
    mass: f64,
    gravity: f64,
}

/// Two bodies on a spring of torsion.
#[lie_poisson_system(
    group(first: SO3, second: SO3),
    potential = {
        let between = first.inverse() * second;
        2.0 * stiffness * (1.0 - between.w.powi(2))
    },
    retractions(Exponential),
    methods(HamiltonJacobi(4), HamiltonJacobi(6))
)]
struct Coupled {
    #[inertia(first)]
    first_inertia: Vector3<f64>,
    #[inertia(second)]
    second_inertia: Vector3<f64>,
    stiffness: f64,
}

/// Two masses on rods of the same length, one hung from the other.
#[lie_poisson_system(
    group(first: SO2, second: SO2),
    lagrangian = {
        let (upper, lower) = (first_velocity.x, second_velocity.x);
        let between = first.inverse() * second;
        let kinetic = upper.powi(2) + lower.powi(2) / 2.0 + upper * lower * between.cos_angle();
        kinetic + gravity * (2.0 * first.cos_angle() + second.cos_angle())
    },
    retractions(Exponential),
    methods(HamiltonJacobi(4), HamiltonJacobi(6))
)]
struct DoublePendulum {
    gravity: f64,
}

/// A satellite.
#[lie_poisson_system(
    group = R3,
    potential = -attraction * mass / position.norm(),
    retractions(Exponential),
    methods(HamiltonJacobi(4), HamiltonJacobi(6)),
    taylor
)]
struct Kepler {
    #[inertia]
    mass: f64,
    attraction: f64,
}

/// A motion: of what, from where, with which controls, and how long, s.
struct Motion<S: System> {
    system: S,
    start: S::State,
    control: S::Control,
    duration: f64,
}

impl<S: System<Scalar = f64>> Motion<S> {
    /// Where steps lead; what is not a number if one cannot be taken.
    fn run<M>(&self, step: f64) -> Vec<f64>
    where
        S: Discretized<M>,
    {
        let steps = (self.duration / step).round();
        let mut stepper = self.system.stepper::<M>(self.duration / steps).unwrap();
        let mut state = self.start.clone();
        match stepper.steps_with(&mut state, &self.control, steps as u64) {
            Ok(_) => state.to_components().as_ref().to_vec(),
            Err(_) => vec![f64::NAN],
        }
    }

    /// Where Taylor steps lead.
    fn taylor(&self, tolerance: f64) -> Vec<f64>
    where
        S: PowerSeries,
    {
        let mut state = self.start.clone();
        self.system.adaptive(tolerance).unwrap().to(&mut state, self.duration).unwrap();
        state.to_components().as_ref().to_vec()
    }
}

fn start() -> [f64; 10] {
    [1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 1.0]
}

/// How many components a body has, or a top.
const fn length(top: bool) -> usize {
    if top { 10 } else { 7 }
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

fn dop853<const TOP: bool>(tolerance: f64) -> Vec<f64> {
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
    stepper.y_out().last().unwrap().as_slice()[..length(TOP)].to_vec()
}

fn rk4<const TOP: bool>(step: f64) -> Vec<f64> {
    let steps = (DURATION / step).round();
    let (h, length) = (DURATION / steps, length(TOP));
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
    state[..length].to_vec()
}

/// The distance, relative to the size of the second.
fn distance(a: &[f64], b: &[f64]) -> f64 {
    let norm = |numbers: &mut dyn Iterator<Item = f64>| numbers.map(|x| x * x).sum::<f64>().sqrt();
    norm(&mut a.iter().zip(b).map(|(a, b)| a - b)) / norm(&mut b.iter().copied())
}

/// Settings from one that is too large to one that is too small.
fn settings(from: f64, to: f64, factor: f64) -> impl Iterator<Item = f64> {
    (0..).map(move |k| from * factor.powi(k)).take_while(move |&setting| setting >= to)
}

/// A row: the cost at each of the errors.
fn row(
    name: &str,
    exact: &[f64],
    duration: f64,
    settings: impl Iterator<Item = f64>,
    run: impl Fn(f64) -> Vec<f64>,
) {
    let measure = |setting: f64| {
        let (mut best, mut end) = (f64::INFINITY, Vec::new());
        for _ in 0..ROUNDS {
            let clock = Instant::now();
            end = run(setting);
            best = best.min(clock.elapsed().as_secs_f64());
        }
        [distance(&end, exact), best * 1e9 / duration, setting].map(f64::ln)
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

/// The rows of a motion: those of compositions and of steps from one equation begin with this step, s; that of the exact end is a twentieth.
macro_rules! rows {
    ($name:literal, $motion:expr, $step:literal, [$($order:literal),*] $(, $others:expr)?) => {{
        let motion = $motion;
        if std::env::args().skip(1).all(|part| part.starts_with("--") || $name.contains(&part)) {
            let exact = motion.run::<Order10<Exponential>>($step / 20.0);
            let row = |name: &str, from: f64, to: f64, factor, run: &dyn Fn(f64) -> Vec<f64>| {
                row(name, &exact, motion.duration, settings(from, to, factor), run);
            };
            println!("{:16}{}", $name, ERRORS.map(|error| format!("{error:>16e}")).concat());
            $($others(&motion, &row);)?
            row("composed, 4", $step / 2.0, $step / 250.0, 0.7, &|step| motion.run::<Order4<Exponential>>(step));
            row("composed, 6", $step, $step / 50.0, 0.8, &|step| motion.run::<Order6<Exponential>>(step));
            row("composed, 8", $step, $step / 20.0, 0.8, &|step| motion.run::<Order8<Exponential>>(step));
            $({
                let last = $step / if $order == 4 { 250.0 } else { 50.0 };
                row(concat!("one equation, ", $order), 1.5 * $step, last, 0.8, &|step| {
                    motion.run::<HamiltonJacobi<Exponential, $order>>(step)
                });
                row(concat!("same, fused, ", $order), 1.5 * $step, last, 0.8, &|step| {
                    motion.run::<Fused<HamiltonJacobi<Exponential, $order>>>(step)
                });
            })*
        }
    }};
}

/// Writes a row: its name, settings from one to another by a factor, and what is run with them.
type Row<'a> = &'a dyn Fn(&str, f64, f64, f64, &dyn Fn(f64) -> Vec<f64>);

/// The rows of what others take, and of Taylor steps.
fn others<const TOP: bool, S: PowerSeries + System<Scalar = f64>>(motion: &Motion<S>, row: Row<'_>) {
    row("RK4", 0.2, 1e-3, 0.7, &rk4::<TOP>);
    row("DOP853", 1e-3, 1e-14, 0.5, &dop853::<TOP>);
    taylor(motion, row);
}

fn taylor<S: PowerSeries + System<Scalar = f64>>(motion: &Motion<S>, row: Row<'_>) {
    row("Taylor", 1e-2, 1e-15, 0.5, &|tolerance| motion.taylor(tolerance));
}

fn main() {
    let (attitude, momentum) = (UnitQuaternion::identity(), vector![1.0, 1.0, 1.0]);
    let none = NoControl::default();
    let body = Motion {
        system: Body { inertia: INERTIA.into() },
        start: BodyState { attitude, momentum },
        control: none,
        duration: DURATION,
    };
    rows!("free body", body, 1.0, [4, 6, 8, 10], others::<false, _>);
    let top = Motion {
        system: Top { inertia: INERTIA.into(), chi: CHI.into() },
        start: TopState { attitude, momentum, gamma: Vector3::z() },
        control: none,
        duration: DURATION,
    };
    rows!("heavy top", top, 1.0, [4, 6, 8], others::<true, _>);
    let quadrotor = Motion {
        system: Quadrotor { inertia: vector![0.082, 0.0845, 0.1377], mass: 4.34, gravity: 9.81 },
        start: QuadrotorState {
            attitude,
            attitude_momentum: vector![0.04, 0.02, 0.1],
            position: Vector3::zeros(),
            position_momentum: Vector3::zeros(),
        },
        control: QuadrotorControl { moment: vector![0.01, -0.01, 0.005], thrust: 43.0 },
        duration: 20.0,
    };
    rows!("quadrotor", quadrotor, 0.5, [4, 6]);
    let coupled = Motion {
        system: Coupled {
            first_inertia: vector![2.0, 3.0, 4.0],
            second_inertia: vector![1.5, 1.0, 0.8],
            stiffness: 2.0,
        },
        start: CoupledState {
            first: attitude,
            first_momentum: vector![0.5, 2.0, 1.0],
            second: UnitQuaternion::from_axis_angle(&Vector3::x_axis(), 1.0),
            second_momentum: vector![-0.3, 0.2, 0.6],
        },
        control: none,
        duration: 60.0,
    };
    rows!("coupled bodies", coupled, 1.0, [4, 6]);
    // it swings: after it has turned over, errors grow by chance
    let pendulum = Motion {
        system: DoublePendulum { gravity: 9.81 },
        start: DoublePendulumState {
            first: UnitComplex::new(0.5),
            first_momentum: vector![0.0],
            second: UnitComplex::new(0.8),
            second_momentum: vector![0.0],
        },
        control: none,
        duration: 60.0,
    };
    rows!("double pendulum", pendulum, 0.3, [4, 6]);
    // ten times round an ellipse of eccentricity 0.6
    let kepler = Motion {
        system: Kepler { mass: 1.0, attraction: 1.0 },
        start: KeplerState { position: vector![0.4, 0.0, 0.0], momentum: vector![0.0, 2.0, 0.0] },
        control: none,
        duration: 20.0 * std::f64::consts::PI,
    };
    rows!("Kepler", kepler, 0.3, [4, 6], taylor);
}
