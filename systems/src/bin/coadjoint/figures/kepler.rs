//! Figure 1.2: the Kepler problem with RK2 and Störmer–Verlet.

use coadjoint::prelude::*;
use nalgebra::Vector4;

use super::{ErrorSeries, figures};
use coadjoint_app::Error;
use coadjoint_app::plot::{Axis, Figure, Key, Panel, Series, Style};
use coadjoint_app::simulation::{Method, Order, Retraction, each_step};
use coadjoint_systems::classical::{RungeKutta, Tableau, integrate};
use coadjoint_systems::kepler::{Kepler, KeplerState};

/// The step, in standard units.
pub(crate) const STEP: f64 = 0.01;
/// How many.
pub(crate) const STEPS: u64 = 3000;

/// One method's orbit.
#[derive(Clone, Debug)]
pub(crate) struct Orbit {
    /// The method's name.
    pub(crate) method: String,
    /// Positions in the plane.
    pub(crate) path: Vec<(f64, f64)>,
    /// `½|p|² − 1/|q|`.
    pub(crate) energy: ErrorSeries,
    /// `q₁p₂ − q₂p₁`.
    pub(crate) angular_momentum: ErrorSeries,
}

impl Orbit {
    fn new(method: &str) -> Self {
        let [energy, angular_momentum] = invariants(&START).map(|value| ErrorSeries::new(value, STEPS + 1));
        Self { method: method.to_owned(), path: Vec::new(), energy, angular_momentum }
    }

    fn push(&mut self, index: u64, time: f64, x: &Vector4<f64>) {
        self.path.push((x[0], x[1]));
        let [energy, angular_momentum] = invariants(x);
        self.energy.push(index, time, energy);
        self.angular_momentum.push(index, time, angular_momentum);
    }
}

/// The runs: `G(m₁ + m₂) = 1`, from `q = (1, 0)` with `p = (0, 0.5)`.
#[derive(Clone, Debug)]
pub(crate) struct Orbits {
    /// Explicit midpoint method.
    pub(crate) rk2: Orbit,
    /// Our step.
    pub(crate) verlet: Orbit,
}

const START: Vector4<f64> = Vector4::new(1.0, 0.0, 0.0, 0.5);

/// Energy and angular momentum of `(q, p)`.
fn invariants(x: &Vector4<f64>) -> [f64; 2] {
    [0.5 * (x[2] * x[2] + x[3] * x[3]) - 1.0 / x[0].hypot(x[1]), x[0] * x[3] - x[1] * x[2]]
}

impl Orbits {
    /// Makes the runs.
    ///
    /// # Errors
    /// If a step cannot be taken.
    pub(crate) fn measure() -> Result<Self, Error> {
        let field = |_: f64, x: &Vector4<f64>| {
            let pull = (x[0] * x[0] + x[1] * x[1]).powf(-1.5);
            Vector4::new(x[2], x[3], -x[0] * pull, -x[1] * pull)
        };
        let mut rk2 = Orbit::new("RK2 (explicit midpoint)");
        let method = RungeKutta::from(Tableau::rk2());
        integrate(&method, &field, 0.0, START, STEP, STEPS, |k, time, x| rk2.push(k, time, x))?;

        let kepler = Kepler { mass: 1.0, attraction: 1.0 };
        let start = KeplerState { position: vector![1.0, 0.0, 0.0], momentum: vector![0.0, START[3], 0.0] };
        let mut verlet = Orbit::new("Störmer–Verlet");
        let scheme = (Method::Verlet, Retraction::Exponential, Order::Two);
        each_step(&kepler, &start, scheme, (STEP, STEPS), |index, time, state| {
            let KeplerState { position, momentum } = state;
            let x = Vector4::new(position.x, position.y, momentum.x, momentum.y);
            verlet.push(index, time, &x);
        })?;
        Ok(Self { rk2, verlet })
    }

    /// The exact ellipse, RK2's orbit, Störmer–Verlet's first and last revolutions, and the centre.
    fn plane(&self) -> Vec<Series> {
        // a = 1/(2 − v²), e = 1 − v² at the point farthest away, where the run starts
        let (axis, eccentricity) = (1.0 / (2.0 - START[3] * START[3]), 1.0 - START[3] * START[3]);
        let across = axis * (1.0 - eccentricity * eccentricity).sqrt();
        let ellipse = (0..=400).map(|k| {
            let anomaly = f64::from(k) * std::f64::consts::TAU / 400.0;
            (axis * (anomaly.cos() + eccentricity), across * anomaly.sin())
        });
        let exact = Series { label: "exact".to_owned(), points: ellipse.collect(), style: Style::Reference };
        // T = 2π √a³, in steps
        let revolution = (std::f64::consts::TAU * axis.powf(1.5) / STEP).ceil() as usize;
        let path = &self.verlet.path;
        let (first, last) = (path.iter().take(revolution), path.iter().rev().take(revolution).rev());
        vec![
            exact,
            Series::line(&self.rk2.method, self.rk2.path.clone()),
            Series::line(&self.verlet.method, first.copied().collect()),
            Series::line("Störmer–Verlet, last revolution", last.copied().collect()),
            Series { label: "centre".to_owned(), points: vec![(0.0, 0.0)], style: Style::Marks },
        ]
    }

    /// Orbit, energy and angular momentum.
    pub(crate) fn figure(&self) -> Figure {
        let orbits = [&self.rk2, &self.verlet];
        let errors = |series: fn(&Orbit) -> &ErrorSeries| -> Vec<Series> {
            orbits.iter().map(|orbit| Series::line(&orbit.method, series(orbit).upper())).collect()
        };
        let (rk2, verlet) = (&self.rk2, &self.verlet);
        Figure {
            title: "1.2  Kepler problem, G(m₁ + m₂) = 1, h = 0.01, from q = (1, 0), p = (0, 0.5)".to_owned(),
            caption: vec![
                format!(
                    "Within {STEPS} steps RK2's energy error comes to {} and that of its angular momentum to {}, and both grow. \
                     Störmer–Verlet's energy error comes to {} at every passage close to the centre, and goes back each time; its angular \
                     momentum is kept to {}, which is roundoff. Its ellipse keeps its size and turns slowly.",
                    figures(rk2.energy.stats.error),
                    figures(rk2.angular_momentum.stats.error),
                    figures(verlet.energy.stats.error),
                    figures(verlet.angular_momentum.stats.error),
                ),
                "Unlike the paper's: of Störmer–Verlet (a) shows the first revolution and the last; (b) and (c) show errors on a logarithmic \
                 scale, where the paper has the quantities themselves. RK2 is the explicit midpoint rule; the paper does not say which it takes. \
                 Störmer–Verlet is the right one: the tableau that the paper prints is not symplectic."
                    .to_owned(),
            ],
            columns: 3,
            cell: (460.0, 400.0),
            key: Key::Below,
            panels: vec![
                Panel {
                    equal: true,
                    ..Panel::new(Axis::linear("q₁"), Axis::linear("q₂"), self.plane()).titled("(a) orbit")
                },
                Panel::new(
                    Axis::linear("time"),
                    Axis::logarithmic("|H − H₀|"),
                    errors(|orbit| &orbit.energy),
                )
                .titled("(b) energy"),
                Panel::new(
                    Axis::linear("time"),
                    Axis::logarithmic("|L − L₀|"),
                    errors(|orbit| &orbit.angular_momentum),
                )
                .titled("(c) angular momentum"),
            ],
        }
    }
}
