//! Figure 6.3: the quadrotor with the thrust of hover.

use coadjoint::prelude::*;

use super::bodies::STEP;
use super::caption::{Caption, Paragraph, given, measured, paragraph};
use super::each_step::each_step;
use super::{Data, InvariantErrors};
use coadjoint_app::Error;
use coadjoint_app::picture::{Axis, Color, Figure, Key, Panel, Series, Style};
use coadjoint_app::record::Envelope;
use coadjoint_app::setup::{Method, Order, Retraction};
use coadjoint_systems::quadrotor::{Quadrotor, QuadrotorState};

/// Both retractions, each with the paper's step and with the one that its text recommends: `𝓘 = diag(1, 10, 100)`, `Π₀ = (1, 1, 1)`, `R₀ = 1`,
/// `p₀ = 0`, `q₀ = (0, 0, 1)`, with thrust `mg` along the third axis and no moment. The paper leaves mass and gravity open: ours are 1 kg and
/// 9.81 m/s².
#[derive(Clone, Debug)]
pub(crate) struct Hover {
    /// Störmer–Verlet with the exponential and with Cayley, then (6.21) and (6.22).
    pub(crate) flights: [Flight; 4],
    steps: u64,
}

/// The names of the runs.
const FLIGHTS: [&str; 4] =
    ["Störmer–Verlet, exponential", "Störmer–Verlet, Cayley", "Euler A, exponential", "Euler A, Cayley"];
const HEIGHT: &str = "height";

/// The retraction gives the colour, the order the dashes.
fn look(name: &str) -> (Color, Style) {
    let color = if name.ends_with("Cayley") { Color::Cayley } else { Color::Exponential };
    (color, if name.starts_with("Euler") { Style::Dashed } else { Style::Line })
}

/// A run with one method.
#[derive(Clone, Debug)]
pub(crate) struct Flight {
    /// `|R Π − R₀ Π₀|`, `|Π|` and the length of the attitude's quaternion.
    pub(crate) run: InvariantErrors,
    /// How the height goes.
    height: Envelope,
    /// How far the momentum `p` is from that of order 6.
    momentum: Envelope,
    /// The largest of these distances, kg m/s.
    pub(crate) largest: f64,
}

impl Flight {
    fn new(name: &'static str, steps: u64) -> Self {
        let envelope = Envelope::new(steps + 1, 450);
        let run = InvariantErrors::new(name, steps);
        Self { run, height: envelope.clone(), momentum: envelope, largest: 0.0 }
    }
}

impl Hover {
    /// Makes the runs.
    ///
    /// # Errors
    /// If a step cannot be taken.
    pub(crate) fn measure(steps: u64) -> Result<Self, Error> {
        let mut reference = Vec::with_capacity(steps as usize + 1);
        each_of((Method::Standard, Retraction::Exponential, Order::Six), steps, |_, _, state| {
            reference.push(state.position_momentum);
        })?;
        let fly = |name, method, retraction| flight(name, (method, retraction), steps, &reference);
        Ok(Self {
            flights: [
                fly(FLIGHTS[0], Method::Verlet, Retraction::Exponential)?,
                fly(FLIGHTS[1], Method::Verlet, Retraction::Cayley)?,
                fly(FLIGHTS[2], Method::EULER_A, Retraction::Exponential)?,
                fly(FLIGHTS[3], Method::EULER_A, Retraction::Cayley)?,
            ],
            steps,
        })
    }

    /// The errors over time, and the height.
    pub(crate) fn figure(&self) -> Figure {
        const TIME: &str = "time, s";
        let panel = |axis, points: &dyn Fn(&Flight) -> Vec<(f64, f64)>| {
            let series = self.flights.iter().map(|flight| {
                let (color, style) = look(flight.run.method);
                Series::new(flight.run.method, color, style, points(flight))
            });
            Panel::new(Axis::linear(TIME), axis, series.collect())
        };
        let error = |invariant: usize| {
            move |flight: &Flight| flight.run.invariants.get(invariant).map_or_else(Vec::new, |of| of.upper())
        };
        let [first, ..] = &self.flights;
        let panels = vec![
            panel(Axis::logarithmic("|RΠ − R₀Π₀|, kg m²/s"), &error(0)),
            panel(Axis::logarithmic("| |Π| − |Π₀| |, kg m²/s"), &error(1)),
            panel(Axis::logarithmic("|p − p*|, kg m/s"), &|flight| flight.momentum.upper()),
            Panel::new(
                Axis::linear(TIME),
                Axis::linear("height, km"),
                vec![Series::line(
                    HEIGHT,
                    Color::Ink,
                    first.height.upper().into_iter().map(|(t, z)| (t, 1e-3 * z)).collect(),
                )],
            ),
        ];
        let span = (0.0, self.steps as f64 * STEP);
        Figure {
            cell: (760.0, 190.0),
            ..Figure::over_time("6.3  Quadrotor, 30 minutes".to_owned(), TIME, span, Key::Above, panels)
        }
    }
}

/// What each of the four runs keeps.
pub(crate) fn caption(data: &Data) -> Caption {
    let mut caption = vec![paragraph![
        given(
            "I = diag(1, 10, 100) kg m², Π₀ = (1, 1, 1) kg m²/s, R₀ = 1, p₀ = 0, q₀ = (0, 0, 1) m, h = 0.01 s"
        ),
        "; mass and gravity, which the paper leaves open, are ",
        given("1 kg and 9.81 m/s²"),
        "; the thrust of hover, mg along the third body axis, and no moment. The body tumbles, and its thrust with it: it does not hover, but \
         falls ",
        measured(-data.curve(4, HEIGHT).last()),
        " km, the same with all four at this scale. Energy is not conserved, the thrust works."
    ]];
    let [length, kick] = [2, 3].map(|panel| move |name| measured(data.curve(panel, name).largest()));
    for name in FLIGHTS {
        caption.push(Paragraph(vec![
            given(name),
            ": the angular momentum in space is kept to ".into(),
            measured(data.curve(1, name).largest()),
            " kg m²/s and its length to ".into(),
            length(name),
            " kg m²/s; p is off by up to ".into(),
            kick(name),
            " kg m/s.".into(),
        ]));
    }
    caption.push(paragraph![
        "p* is the momentum by a composition of order ",
        given(6),
        ". Euler A is the paper's, ",
        given("(6.21) and (6.22)"),
        ", of order one, with symplectic Euler for the position; read with the moment times the step and p' = p − h m g e₃ + h F R e₃, as its \
         own equations of motion ",
        given("(6.19)"),
        " have it, not with the signs that are printed. Störmer–Verlet, of order two, is what its text recommends for the position; here it \
         takes the whole step, its attitude that of two half steps. Between the two is half a kick at both ends of the run: p is off by up to \
         half a step times the force, but not the position, as no force acts at the start. Unlike the paper's, the figure shows errors on a \
         logarithmic scale."
    ]);
    caption
}

/// The states of a run.
fn each_of(
    scheme: (Method, Retraction, Order),
    steps: u64,
    observe: impl FnMut(u64, f64, &QuadrotorState),
) -> Result<(), Error> {
    let quadrotor = Quadrotor { inertia: vector![1.0, 10.0, 100.0], mass: 1.0, gravity: 9.81 };
    // its own control law is that of hover
    each_step(&quadrotor, &start(), scheme, (STEP, steps), observe)
}

fn start() -> QuadrotorState {
    QuadrotorState { attitude_momentum: vector![1.0, 1.0, 1.0], ..Quadrotor::at_rest(1.0) }
}

fn flight(
    name: &'static str,
    (method, retraction): (Method, Retraction),
    steps: u64,
    reference: &[Vector3<f64>],
) -> Result<Flight, Error> {
    let in_space = |state: &QuadrotorState| state.attitude * state.attitude_momentum;
    let initially = in_space(&start());
    let mut flight = Flight::new(name, steps);
    each_of((method, retraction, Order::Two), steps, |index, time, state| {
        let QuadrotorState { attitude, attitude_momentum, position, position_momentum } = state;
        let turned = (in_space(state) - initially).norm();
        flight.run.push(index, time, [turned, attitude_momentum.norm(), attitude.quaternion().norm()]);
        flight.height.push(index, time, position.z);
        let error =
            reference.get(index as usize).map_or(f64::NAN, |exact| (position_momentum - exact).norm());
        flight.momentum.push(index, time, error);
        flight.largest = flight.largest.max(error);
    })?;
    Ok(flight)
}
