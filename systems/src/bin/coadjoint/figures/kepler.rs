//! Figure 1.2: the Kepler problem with RK2 and Störmer–Verlet.

use coadjoint::prelude::*;
use nalgebra::Vector4;

use super::caption::{Caption, given, measured, paragraph, with_places};
use super::each_step::each_step;
use super::methods::{RK2, VERLET, line};
use super::{Data, ErrorSeries};
use coadjoint_app::Error;
use coadjoint_app::picture::{Axis, Color, Figure, Key, Mark, Panel, Series, Style};
use coadjoint_app::setup::{Method, Order, Retraction};
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
    pub(crate) method: &'static str,
    /// Positions in the plane.
    pub(crate) path: Vec<(f64, f64)>,
    /// `½|p|² − 1/|q|`.
    pub(crate) energy: ErrorSeries,
    /// `q₁p₂ − q₂p₁`.
    pub(crate) angular_momentum: ErrorSeries,
}

impl Orbit {
    fn new(method: &'static str) -> Self {
        let [energy, angular_momentum] = invariants(&START).map(|value| ErrorSeries::new(value, STEPS + 1));
        Self { method, path: Vec::new(), energy, angular_momentum }
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

const FIRST: &str = "Störmer–Verlet, first revolution";

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
        let mut rk2 = Orbit::new(RK2);
        let method = RungeKutta::from(Tableau::rk2());
        integrate(&method, &field, 0.0, START, STEP, STEPS, |k, time, x| rk2.push(k, time, x))?;

        let kepler = Kepler { mass: 1.0, attraction: 1.0 };
        let start = KeplerState { position: vector![1.0, 0.0, 0.0], momentum: vector![0.0, START[3], 0.0] };
        let mut verlet = Orbit::new(VERLET);
        let scheme = (Method::Verlet, Retraction::Exponential, Order::Two);
        each_step(&kepler, &start, scheme, (STEP, STEPS), |index, time, state| {
            let KeplerState { position, momentum } = state;
            let x = Vector4::new(position.x, position.y, momentum.x, momentum.y);
            verlet.push(index, time, &x);
        })?;
        Ok(Self { rk2, verlet })
    }

    /// Each orbit, with the exact ellipse and the centre.
    fn planes(&self) -> [Panel; 2] {
        // a = 1/(2 − v²), e = 1 − v² at the point farthest away, where the run starts
        let (axis, eccentricity) = (1.0 / (2.0 - START[3] * START[3]), 1.0 - START[3] * START[3]);
        let across = axis * (1.0 - eccentricity * eccentricity).sqrt();
        let ellipse = (0..=400).map(|k| {
            let anomaly = f64::from(k) * std::f64::consts::TAU / 400.0;
            (axis * (anomaly.cos() + eccentricity), across * anomaly.sin())
        });
        let exact = Series::reference("exact", ellipse.collect());
        let centre =
            Series::new("centre of attraction", Color::Ink, Style::Marks(Mark::Dot), vec![(0.0, 0.0)]);
        // T = 2π √a³, in steps
        let revolution = (std::f64::consts::TAU * axis.powf(1.5) / STEP).ceil() as usize;
        let path = &self.verlet.path;
        let (first, last) = (path.iter().take(revolution), path.iter().rev().take(revolution).rev());
        let panel = |title, series| Panel {
            equal: true,
            ..Panel::new(
                Axis::linear("q₁, dimensionless").within(-0.55, 1.25),
                Axis::linear("q₂, dimensionless").within(-0.75, 0.75),
                series,
            )
            .titled(title)
        };
        [
            panel(
                "(a) RK2, all revolutions",
                vec![line(RK2, self.rk2.path.clone()), exact.clone(), centre.clone()],
            ),
            panel(
                "(b) Störmer–Verlet, first and last revolution",
                vec![
                    Series::line(FIRST, Color::EulerB, first.copied().collect()),
                    line(VERLET, last.copied().collect()),
                    exact,
                    centre,
                ],
            ),
        ]
    }

    /// Orbits, energy and angular momentum.
    pub(crate) fn figure(&self) -> Figure {
        let errors = |label: &str, title, series: fn(&Orbit) -> &ErrorSeries| {
            let lines = [&self.rk2, &self.verlet].map(|orbit| line(orbit.method, series(orbit).upper()));
            let time = Axis::linear("time, dimensionless").within(0.0, STEPS as f64 * STEP);
            Panel::new(time, Axis::logarithmic(label), lines.into()).titled(title)
        };
        let [rk2, verlet] = self.planes();
        let panels = vec![
            rk2,
            verlet,
            errors("energy |H − H₀|, dimensionless", "(c) error of the energy", |orbit| &orbit.energy),
            errors("|L − L₀|, dimensionless", "(d) error of the angular momentum", |orbit| {
                &orbit.angular_momentum
            }),
        ];
        Figure {
            title: "1.2  Kepler problem".to_owned(),
            columns: 2,
            cell: (440.0, 366.0),
            key: Key::Above,
            shared: (false, false),
            panels,
        }
    }
}

/// What the two methods do to the orbit.
pub(crate) fn caption(data: &Data) -> Caption {
    let [rk2, verlet] = [RK2, VERLET].map(|method| [data.curve(3, method), data.curve(4, method)]);
    // where an orbit is farthest out
    let farthest = |curve: super::Curve<'_>| {
        let points = curve.points().iter().copied();
        points.max_by(|a, b| a.0.hypot(a.1).total_cmp(&b.0.hypot(b.1))).unwrap_or((f64::NAN, f64::NAN))
    };
    let (first, last) = (farthest(data.curve(2, FIRST)), farthest(data.curve(2, VERLET)));
    let turned = (last.1.atan2(last.0) - first.1.atan2(first.0)).to_degrees();
    let size = last.0.hypot(last.1) / first.0.hypot(first.1);
    vec![
        paragraph![
            given("G(m₁ + m₂) = 1, q = (1, 0), p = (0, 0.5), h = 0.01, "),
            given(STEPS),
            " steps. RK2's energy error comes to ",
            measured(rk2[0].largest()),
            ", and is ",
            measured(rk2[0].last()),
            " at the end; that of its angular momentum to ",
            measured(rk2[1].largest()),
            " and ",
            measured(rk2[1].last()),
            ". Störmer–Verlet's energy error comes to ",
            measured(verlet[0].largest()),
            " at a passage close to the centre, and goes back each time, to ",
            measured(verlet[0].last()),
            " at the end; its angular momentum is kept to ",
            measured(verlet[1].largest()),
            ", which is roundoff. Its last ellipse reaches ",
            with_places(size, 4),
            " times as far as the first, and has turned by ",
            with_places(turned, 1),
            "°."
        ],
        paragraph![
            "Unlike the paper's: (b) shows the first revolution and the last; (c) and (d) show errors on a logarithmic scale, where the \
             paper has the quantities themselves. RK2 is the explicit midpoint rule; the paper does not say which it takes. \
             Störmer–Verlet is the right one: the tableau that the paper prints is not symplectic."
        ],
    ]
}
