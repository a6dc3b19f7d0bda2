//! Figure 1.1: the harmonic oscillator with four methods of Euler's kind.

use coadjoint::prelude::*;
use nalgebra::Vector2;

use coadjoint_app::Error;
use coadjoint_app::plot::{Axis, Figure, Key, Panel, Series, Style};
use coadjoint_app::simulation::{Method, Order, Retraction, each_step};
use coadjoint_systems::classical::{Method as _, RungeKutta, Tableau, integrate};
use coadjoint_systems::harmonic_oscillator::{HarmonicOscillator, HarmonicOscillatorState};

/// The step, in standard units.
pub(crate) const STEP: f64 = 0.1;
/// How many.
pub(crate) const STEPS: u64 = 50;

/// The trajectory of one method: position and momentum at every step.
#[derive(Clone, Debug)]
pub(crate) struct Orbit {
    /// The method's name.
    pub(crate) method: String,
    /// `(q, p)`.
    pub(crate) points: Vec<(f64, f64)>,
}

impl Orbit {
    /// The energy at every step, by its initial value.
    pub(crate) fn energies(&self) -> Vec<f64> {
        let energy = |&(q, p): &(f64, f64)| q * q + p * p;
        let initial = self.points.first().map_or(1.0, energy);
        self.points.iter().map(|point| energy(point) / initial).collect()
    }
}

/// Explicit Euler, implicit Euler, symplectic Euler A (1.9) and B (1.10), from `(1, 0)` with `k/m = 1`, `h = 0.1`.
#[derive(Clone, Debug)]
pub(crate) struct Oscillator {
    /// In this order.
    pub(crate) orbits: [Orbit; 4],
}

impl Oscillator {
    /// Makes the runs.
    ///
    /// # Errors
    /// If a step cannot be taken.
    pub(crate) fn measure() -> Result<Self, Error> {
        Ok(Self {
            orbits: [
                classical(Tableau::explicit_euler())?,
                classical(Tableau::implicit_euler())?,
                ours(Method::EulerA, "symplectic Euler A (1.9)")?,
                ours(Method::EulerB, "symplectic Euler B (1.10)")?,
            ],
        })
    }

    /// Phase plane and energy.
    pub(crate) fn figure(&self) -> Figure {
        let turn = |k: u32| f64::from(k) * std::f64::consts::TAU / 200.0;
        let circle = (0..=200).map(|k| (turn(k).cos(), turn(k).sin())).collect();
        let exact = |points| Series { label: "exact".to_owned(), points, style: Style::Reference };
        let mut plane = vec![exact(circle)];
        let mut energy = vec![exact(vec![(0.0, 1.0), (STEPS as f64, 1.0)])];
        for orbit in &self.orbits {
            let marked = |points| Series { label: orbit.method.clone(), points, style: Style::Marked };
            plane.push(marked(orbit.points.clone()));
            energy.push(marked((0..).map(f64::from).zip(orbit.energies()).collect()));
        }
        let [explicit, implicit, a, b] = self.orbits.each_ref().map(Orbit::energies);
        let last = |energies: &[f64]| energies.last().copied().unwrap_or(f64::NAN);
        let extremes = |energies: &[f64]| {
            let (least, greatest) =
                energies.iter().fold((1.0_f64, 1.0_f64), |(l, g), &e| (l.min(e), g.max(e)));
            format!("between {least:.3} and {greatest:.3}")
        };
        Figure {
            title: "1.1  Harmonic oscillator, k/m = 1, h = 0.1, from (1, 0)".to_owned(),
            caption: vec![
                format!(
                    "After {STEPS} steps explicit Euler has {:.3} times the energy, (1 + h²)^{STEPS}; implicit Euler {:.3} times. The \
                     symplectic methods do not keep the energy, but keep it in bounds: A {}, B {} of its initial value.",
                    last(&explicit),
                    last(&implicit),
                    extremes(&a),
                    extremes(&b),
                ),
                "(b) is logarithmic, as in the paper; here the energy is divided by its initial value. Implicit Euler is the method, not the matrix \
                 printed in (1.8), whose off-diagonal signs follow the motion backwards."
                    .to_owned(),
            ],
            columns: 2,
            cell: (520.0, 460.0),
            key: Key::Below,
            panels: vec![
                Panel {
                    equal: true,
                    ..Panel::new(Axis::linear("q"), Axis::linear("p"), plane).titled("(a) phase plane")
                },
                Panel::new(Axis::linear("step"), Axis::logarithmic("H / H₀").within(0.5, 2.0), energy)
                    .titled("(b) energy"),
            ],
        }
    }
}

fn classical(tableau: Tableau) -> Result<Orbit, Error> {
    let method = RungeKutta::from(tableau);
    let field = |_: f64, x: &Vector2<f64>| Vector2::new(x[1], -x[0]);
    let mut points = Vec::new();
    integrate(&method, &field, 0.0, Vector2::new(1.0, 0.0), STEP, STEPS, |_, _, x| {
        points.push((x[0], x[1]))
    })?;
    Ok(Orbit { method: method.name().to_owned(), points })
}

fn ours(method: Method, name: &str) -> Result<Orbit, Error> {
    let oscillator = HarmonicOscillator { mass: 1.0, stiffness: 1.0 };
    let start = HarmonicOscillatorState { position: vector![1.0], momentum: vector![0.0] };
    let mut points = Vec::new();
    let scheme = (method, Retraction::Exponential, Order::Two);
    each_step(&oscillator, &start, scheme, (STEP, STEPS), |_, _, state| {
        points.push((state.position.x, state.momentum.x));
    })?;
    Ok(Orbit { method: name.to_owned(), points })
}
