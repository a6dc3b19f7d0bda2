//! Figure 1.3: the planar pendulum on its cylinder, RK2 with and without projection.

use nalgebra::Vector3;

use super::{ErrorSeries, figures};
use coadjoint_app::Error;
use coadjoint_app::plot::{Axis, Figure, Key, Panel, Series, Style};
use coadjoint_app::simulation::{Method, Order, Retraction, each_step};
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
    pub(crate) method: String,
    /// Angle and momentum.
    pub(crate) path: Vec<(f64, f64)>,
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
    fn new(method: &str) -> Self {
        let start = start();
        Self {
            method: method.to_owned(),
            path: Vec::new(),
            energy: ErrorSeries::new(energy(&start), STEPS + 1),
            radius: ErrorSeries::new(1.0, STEPS + 1),
        }
    }

    fn push(&mut self, index: u64, time: f64, x: &Vector3<f64>) {
        self.path.push((x[1].atan2(x[0]), x[2]));
        self.energy.push(index, time, energy(x));
        self.radius.push(index, time, x[0].hypot(x[1]));
    }

    fn embedded(name: &str, method: &impl Integrator<Field, Vector3<f64>>) -> Result<Self, Error> {
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
        let mut verlet = Swing::new("Störmer–Verlet on the circle");
        let scheme = (Method::Verlet, Retraction::Exponential, Order::Two);
        each_step(&pendulum, &start, scheme, (STEP, STEPS), |index, time, state| {
            let PlanarPendulumState { angle, momentum } = state;
            verlet.push(index, time, &Vector3::new(angle.re, angle.im, momentum.x));
        })?;
        Ok(Self {
            free: Swing::embedded("RK2", &rk2)?,
            projected: Swing::embedded(
                "RK2 with projection",
                &Projected { method: rk2.clone(), projection: unit_leading::<2, 3> },
            )?,
            verlet,
        })
    }

    /// The motion on the unrolled cylinder, the energy, and the distance from the cylinder.
    pub(crate) fn figure(&self) -> Figure {
        let swings = [&self.free, &self.projected, &self.verlet];
        let exact = {
            // p = ±√(2 (cos θ − cos 1))
            let height = |theta: f64| (2.0 * (theta.cos() - 1_f64.cos())).max(0.0).sqrt();
            let upper = (-100..=100).map(|k| f64::from(k) / 100.0).map(|theta| (theta, height(theta)));
            let lower = (-100..=100).rev().map(|k| f64::from(k) / 100.0).map(|theta| (theta, -height(theta)));
            upper.chain(lower).collect()
        };
        let exact = Series { label: "exact".to_owned(), points: exact, style: Style::Reference };
        // of many swings only the last can be seen
        let path = |swing: &Swing| Series {
            label: swing.method.clone(),
            points: swing.path[swing.path.len().saturating_sub(SWING)..].to_vec(),
            style: Style::Marked,
        };
        let plane = [exact].into_iter().chain(swings.iter().map(|swing| path(swing))).collect();
        let errors = |series: fn(&Swing) -> &ErrorSeries| -> Vec<Series> {
            swings.iter().map(|swing| Series::line(&swing.method, series(swing).upper())).collect()
        };
        let [free, projected, verlet] = swings.map(|swing| swing.energy.stats.error);
        Figure {
            title: "1.3  Planar pendulum, ml² = mgl = 1, h = 0.1, from θ = 1, p = 0".to_owned(),
            caption: vec![
                format!(
                "Within {STEPS} steps RK2 leaves the cylinder by up to {}, and its energy error comes to {}; with projection it is on the \
                 cylinder to {}, and its energy error is {}: projection keeps the constraint, and not the energy, which grows with \
                 either. Störmer–Verlet on the circle itself needs no projection, and its energy error stays below {}.",
                figures(self.free.radius.stats.error),
                figures(free),
                figures(self.projected.radius.stats.error),
                figures(projected),
                figures(verlet),
            ),
                "Unlike the paper's: (a) shows the last swing of a thousand steps, (b) the error of the energy on a logarithmic scale; (c) and \
                 Störmer–Verlet on the circle are ours. RK2 is the explicit midpoint rule; the paper does not say which it takes."
                    .to_owned(),
            ],
            columns: 3,
            cell: (460.0, 400.0),
            key: Key::Below,
            panels: vec![
                Panel::new(Axis::linear("θ, rad"), Axis::linear("p"), plane)
                    .titled("(a) last swing on the unrolled cylinder"),
                Panel::new(
                    Axis::linear("time"),
                    Axis::logarithmic("|H − H₀|"),
                    errors(|swing| &swing.energy),
                )
                .titled("(b) energy"),
                Panel::new(
                    Axis::linear("time"),
                    Axis::logarithmic("|√(x² + y²) − 1|"),
                    errors(|swing| &swing.radius),
                )
                .titled("(c) distance from the cylinder"),
            ],
        }
    }
}
