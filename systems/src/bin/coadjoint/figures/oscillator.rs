//! Figure 1.1: the harmonic oscillator with four methods of Euler's kind.

use coadjoint::prelude::*;
use nalgebra::Vector2;

use super::Data;
use super::caption::{Caption, given, paragraph, with_places};
use super::each_step::each_step;
use super::methods::{EULER_A, EULER_B, EXPLICIT_EULER, IMPLICIT_EULER, marked};
use coadjoint_app::Error;
use coadjoint_app::picture::{Axis, Figure, Key, Panel, Series};
use coadjoint_app::setup::{Method, Order, Retraction};
use coadjoint_systems::classical::{RungeKutta, Tableau, integrate};
use coadjoint_systems::harmonic_oscillator::{HarmonicOscillator, HarmonicOscillatorState};

/// The step, in standard units.
pub(crate) const STEP: f64 = 0.1;
/// How many.
pub(crate) const STEPS: u64 = 50;

/// The trajectory of one method: position and momentum at every step.
#[derive(Clone, Debug)]
pub(crate) struct Orbit {
    /// The method's name.
    pub(crate) method: &'static str,
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
                classical(Tableau::explicit_euler(), EXPLICIT_EULER)?,
                classical(Tableau::implicit_euler(), IMPLICIT_EULER)?,
                ours(Method::EULER_A, EULER_A)?,
                ours(Method::EULER_B, EULER_B)?,
            ],
        })
    }

    /// Phase plane and energy.
    pub(crate) fn figure(&self) -> Figure {
        let turn = |k: u32| f64::from(k) * std::f64::consts::TAU / 200.0;
        let circle = (0..=200).map(|k| (turn(k).cos(), turn(k).sin())).collect();
        let mut plane = vec![Series::reference("exact", circle)];
        let mut energy = vec![Series::reference("exact", vec![(0.0, 1.0), (STEPS as f64, 1.0)])];
        for orbit in &self.orbits {
            plane.push(marked(orbit.method, orbit.points.clone()));
            energy.push(marked(orbit.method, (0..).map(f64::from).zip(orbit.energies()).collect()));
        }
        Figure {
            title: "1.1  Harmonic oscillator".to_owned(),
            columns: 2,
            cell: (440.0, 400.0),
            key: Key::Above,
            shared: (false, false),
            panels: vec![
                Panel {
                    equal: true,
                    ..Panel::new(Axis::linear("position q, m"), Axis::linear("momentum p, kg m/s"), plane)
                        .titled("(a) phase plane")
                },
                Panel::new(
                    Axis::counts("step"),
                    Axis::logarithmic("energy H / H₀ (no unit)").within(0.5, 2.0),
                    energy,
                )
                .titled("(b) energy"),
            ],
        }
    }
}

/// What the methods do to the energy.
pub(crate) fn caption(data: &Data) -> Caption {
    let energy = |method| data.curve(2, method);
    let ([least_a, least_b], [greatest_a, greatest_b]) = {
        let [a, b] = [EULER_A, EULER_B].map(|method| energy(method).range());
        ([a.0, b.0], [a.1, b.1])
    };
    vec![
        paragraph![
            "From ",
            given("q = 1 m, p = 0"),
            " with ",
            given("k = 1 N/m, m = 1 kg, h = 0.1 s"),
            ". After ",
            given(STEPS),
            " steps explicit Euler has ",
            with_places(energy(EXPLICIT_EULER).last(), 3),
            " times the energy, one plus h² to the power of the number of steps; implicit Euler ",
            with_places(energy(IMPLICIT_EULER).last(), 3),
            " times. The symplectic methods do not keep the energy, but keep it in bounds: A, ",
            given("(1.9)"),
            ", between ",
            with_places(least_a, 3),
            " and ",
            with_places(greatest_a, 3),
            " of its initial value, B, ",
            given("(1.10)"),
            ", between ",
            with_places(least_b, 3),
            " and ",
            with_places(greatest_b, 3),
            "."
        ],
        paragraph![
            "(b) is logarithmic, as in the paper; here the energy is divided by its initial value. Implicit Euler is the method, not the \
             matrix printed in ",
            given("(1.8)"),
            ", whose off-diagonal signs follow the motion backwards."
        ],
    ]
}

fn classical(tableau: Tableau, name: &'static str) -> Result<Orbit, Error> {
    let method = RungeKutta::from(tableau);
    let field = |_: f64, x: &Vector2<f64>| Vector2::new(x[1], -x[0]);
    let mut points = Vec::new();
    integrate(&method, &field, 0.0, Vector2::new(1.0, 0.0), STEP, STEPS, |_, _, x| {
        points.push((x[0], x[1]))
    })?;
    Ok(Orbit { method: name, points })
}

fn ours(method: Method, name: &'static str) -> Result<Orbit, Error> {
    let oscillator = HarmonicOscillator { mass: 1.0, stiffness: 1.0 };
    let start = HarmonicOscillatorState { position: vector![1.0], momentum: vector![0.0] };
    let mut points = Vec::new();
    let scheme = (method, Retraction::Exponential, Order::Two);
    each_step(&oscillator, &start, scheme, (STEP, STEPS), |_, _, state| {
        points.push((state.position.x, state.momentum.x));
    })?;
    Ok(Orbit { method: name, points })
}
