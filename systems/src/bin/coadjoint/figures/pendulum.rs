//! Figure 1.3: the planar pendulum on its cylinder, RK2 with and without projection.

use nalgebra::Vector3;

use super::caption::{Caption, given, measured, paragraph};
use super::each_step::each_step;
use super::methods::{RK2, RK2_PROJECTED, VERLET, line, marked};
use super::{Data, ErrorSeries};
use coadjoint_app::Error;
use coadjoint_app::picture::{Axis, Figure, Key, Panel, Series};
use coadjoint_app::setup::{Method, Order, Retraction};
use coadjoint_systems::classical::{Integrator, Projected, RungeKutta, Tableau, integrate, unit_leading};
use coadjoint_systems::planar_pendulum::{PlanarPendulum, PlanarPendulumState};

/// The step, in standard units.
pub(crate) const STEP: f64 = 0.1;
/// How many.
pub(crate) const STEPS: u64 = 1000;
/// Steps of one swing to and fro.
const SWING: usize = 68;

/// The trajectory of one method.
#[derive(Clone, Debug)]
pub(crate) struct Swing {
    /// The method's name.
    pub(crate) method: &'static str,
    /// Angle and momentum.
    pub(crate) path: Vec<(f64, f64)>,
    /// How far the energy is from where it began.
    error: Vec<(f64, f64)>,
    /// The largest distance from the cylinder until then.
    so_far: Vec<(f64, f64)>,
    /// `½p² − x`, (1.19).
    pub(crate) energy: ErrorSeries,
    /// `√(x² + y²)`, which is 1 on the cylinder.
    pub(crate) radius: ErrorSeries,
}

/// The runs: `ml² = mgl = 1`, from `θ = 1`, `p = 0`.
#[derive(Clone, Debug)]
pub(crate) struct Swings {
    /// Explicit midpoint method for (1.21).
    pub(crate) free: Swing,
    /// The same with projection onto the cylinder after each step.
    pub(crate) projected: Swing,
    /// Our step on the circle.
    pub(crate) verlet: Swing,
}

type Field = fn(f64, &Vector3<f64>) -> Vector3<f64>;

impl Swing {
    fn new(method: &'static str) -> Self {
        let start = start();
        Self {
            method,
            path: Vec::new(),
            error: Vec::new(),
            so_far: Vec::new(),
            energy: ErrorSeries::new(energy(&start), STEPS + 1),
            radius: ErrorSeries::new(1.0, STEPS + 1),
        }
    }

    fn push(&mut self, index: u64, time: f64, x: &Vector3<f64>) {
        self.path.push((x[1].atan2(x[0]), x[2]));
        self.energy.push(index, time, energy(x));
        self.radius.push(index, time, x[0].hypot(x[1]));
        self.error.push((time, energy(x) - self.energy.stats.initial));
        self.so_far.push((time, self.radius.stats.error));
    }

    fn embedded(name: &'static str, method: &impl Integrator<Field, Vector3<f64>>) -> Result<Self, Error> {
        let mut swing = Self::new(name);
        // (1.21)
        let field: Field = |_, x| Vector3::new(-x[1] * x[2], x[0] * x[2], -x[1]);
        integrate(method, &field, 0.0, start(), STEP, STEPS, |k, time, x| swing.push(k, time, x))?;
        Ok(swing)
    }
}

/// `(cos θ, sin θ, p)`
fn start() -> Vector3<f64> {
    Vector3::new(1_f64.cos(), 1_f64.sin(), 0.0)
}

fn energy(x: &Vector3<f64>) -> f64 {
    0.5 * x[2] * x[2] - x[0]
}

impl Swings {
    /// Makes the runs.
    ///
    /// # Errors
    /// If a step cannot be taken.
    pub(crate) fn measure() -> Result<Self, Error> {
        let pendulum = PlanarPendulum { inertia: 1.0, weight: 1.0, length: 1.0 };
        let start = PlanarPendulum::at_rest(1.0);
        let rk2 = RungeKutta::from(Tableau::rk2());
        let mut verlet = Swing::new(VERLET);
        let scheme = (Method::Verlet, Retraction::Exponential, Order::Two);
        each_step(&pendulum, &start, scheme, (STEP, STEPS), |index, time, state| {
            let PlanarPendulumState { angle, momentum } = state;
            verlet.push(index, time, &Vector3::new(angle.re, angle.im, momentum.x));
        })?;
        Ok(Self {
            free: Swing::embedded(RK2, &rk2)?,
            projected: Swing::embedded(
                RK2_PROJECTED,
                &Projected { method: rk2.clone(), projection: unit_leading::<2, 3> },
            )?,
            verlet,
        })
    }

    /// The motion on the unrolled cylinder, the energy, and the distance from the cylinder.
    pub(crate) fn figure(&self) -> Figure {
        let swings = [&self.free, &self.projected, &self.verlet];
        // p = ±√(2 (cos θ − cos 1)), from below to above
        let height = |theta: f64| (2.0 * (theta.cos() - 1_f64.cos())).max(0.0).sqrt();
        let exact = (-100..=100_i32).map(|k| {
            let theta = 1.0 - 0.2 * (f64::from(k) / 100.0).powi(2);
            (theta, f64::from(k.signum()) * height(theta))
        });
        // of many swings only the last can be seen
        let path = |swing: &Swing| {
            let last = swing.path[swing.path.len().saturating_sub(SWING)..].to_vec();
            marked(swing.method, last)
        };
        let plane =
            [Series::reference("exact", exact.collect())].into_iter().chain(swings.map(path)).collect();
        let time = || Axis::linear("time, dimensionless").within(0.0, STEPS as f64 * STEP);
        Figure {
            title: "1.3  Planar pendulum".to_owned(),
            columns: 3,
            cell: (360.0, 340.0),
            key: Key::Above,
            shared: (false, false),
            panels: vec![
                Panel::new(
                    Axis::linear("angle θ, rad").within(0.9, 1.04),
                    Axis::linear("momentum p, dimensionless").within(-0.4, 0.4),
                    plane,
                )
                .titled("(a) last turning point"),
                Panel::new(
                    time(),
                    Axis::linear("energy H − H₀, dimensionless"),
                    swings.map(|swing| line(swing.method, swing.error.clone())).into(),
                )
                .titled("(b) error of the energy"),
                Panel::new(
                    time(),
                    Axis::logarithmic("largest |√(x² + y²) − 1| so far, dimensionless").within(1e-17, 1e-1),
                    swings.map(|swing| line(swing.method, swing.so_far.clone())).into(),
                )
                .titled("(c) distance from the cylinder"),
            ],
        }
    }
}

/// What projection keeps, and what it does not.
pub(crate) fn caption(data: &Data) -> Caption {
    let energy = |method| measured(data.curve(2, method).largest());
    let distance = |method| measured(data.curve(3, method).largest());
    vec![
        paragraph![
            given("ml² = mgl = 1, θ = 1, p = 0, h = 0.1, "),
            given(STEPS),
            " steps. RK2 leaves the cylinder by up to ",
            distance(RK2),
            ", and its energy error comes to ",
            energy(RK2),
            "; with projection it is on the cylinder to ",
            distance(RK2_PROJECTED),
            ", and its energy error is ",
            energy(RK2_PROJECTED),
            ": projection keeps the constraint, and not the energy, which grows with either. Störmer–Verlet on the circle itself needs no \
             projection, its point stays on the circle to ",
            distance(VERLET),
            ", and its energy error below ",
            energy(VERLET),
            "."
        ],
        paragraph![
            "Unlike the paper's: (a) shows the last swing, where it turns; (c) and Störmer–Verlet are ours. RK2 is the explicit midpoint \
             rule; the paper does not say which it takes."
        ],
    ]
}
