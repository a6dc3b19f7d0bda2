//! Figure 6.3: the quadrotor with the thrust of hover.

use coadjoint::prelude::*;

use super::bodies::STEP;
use super::invariant_errors::panel;
use super::{InvariantErrors, figures};
use coadjoint_app::Error;
use coadjoint_app::plot::{Axis, Envelope, Figure, Key, Panel, Series};
use coadjoint_app::simulation::{Method, Order, Retraction, each_step};
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
    fn new(name: &str, steps: u64) -> Self {
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
        let fly = |name: &str, method, retraction| flight(name, (method, retraction), steps, &reference);
        Ok(Self {
            flights: [
                fly("Störmer–Verlet, exponential", Method::Verlet, Retraction::Exponential)?,
                fly("Störmer–Verlet, Cayley", Method::Verlet, Retraction::Cayley)?,
                fly("(6.21), exponential", Method::EulerA, Retraction::Exponential)?,
                fly("(6.22), Cayley", Method::EulerA, Retraction::Cayley)?,
            ],
            steps,
        })
    }

    /// The errors over time, and the height.
    pub(crate) fn figure(&self) -> Figure {
        let time = "time, s";
        let runs: Vec<InvariantErrors> = self.flights.iter().map(|flight| flight.run.clone()).collect();
        let series = |points: &dyn Fn(&Flight) -> Vec<(f64, f64)>| {
            self.flights.iter().map(|flight| Series::line(&flight.run.method, points(flight))).collect()
        };
        let panels = vec![
            panel(&runs, 0, time, "|RΠ − R₀Π₀|, kg m²/s"),
            panel(&runs, 1, time, "| |Π| − |Π₀| |, kg m²/s"),
            Panel::new(Axis::linear(time), Axis::linear("height, m"), series(&|flight| flight.height.both())),
            Panel::new(
                Axis::linear(time),
                Axis::logarithmic("error of p, kg m/s"),
                series(&|flight| flight.momentum.upper()),
            ),
        ];
        let title = "6.3  Quadrotor with the thrust of hover for 30 minutes";
        let span = (0.0, self.steps as f64 * STEP);
        let figure = Figure::over_time(title.to_owned(), time, span, Key::Below, panels);
        Figure { caption: self.caption(), ..figure }
    }

    fn caption(&self) -> Vec<String> {
        let given = "I = diag(1, 10, 100) kg m², Π₀ = (1, 1, 1) kg m²/s, R₀ = 1, p₀ = 0, q₀ = (0, 0, 1) m, h = 0.01 s; mass and gravity, \
                     which the paper leaves open, are 1 kg and 9.81 m/s²; thrust mg along the third body axis, no moment.";
        let methods = "(6.21) and (6.22) are the paper's, of order 1, with symplectic Euler for the position; read with the moment times the step \
                       and p' = p − h m g e₃ + h F R e₃, as its own equations of motion (6.19) have it, not with the signs that are printed. \
                       Störmer–Verlet, of order 2, is what its text recommends for the position; here it takes the whole step. Its attitude \
                       is that of two half steps. Between the two is half a kick at both ends of the run: p is off by up to h/2 times the \
                       force in (6.21), but not the position, as no force acts at the start. Unlike the paper's, the figure shows errors on a \
                       logarithmic scale, the height (of all four the same, at this scale), and how far p is from that of a composition of order 6.";
        let measured = self.flights.iter().map(|Flight { run, largest, .. }| {
            let [turned, length, quaternion] = [0, 1, 2]
                .map(|i| run.invariants.get(i).map_or_else(String::new, |series| figures(series.stats.error)));
            format!(
                "{}: the angular momentum in space is kept to {turned} kg m²/s and its length to {length} kg m²/s, the attitude's quaternion is of \
                 unit length to {quaternion}; p is off by up to {} kg m/s.",
                run.method,
                figures(*largest),
            )
        });
        let tumbles = "The body tumbles, and its thrust with it: it does not hover, but falls. Energy is not conserved, the thrust works. At rest \
                       upright it stays where it is.";
        let last = [tumbles.to_owned()];
        [given.to_owned(), methods.to_owned()].into_iter().chain(measured).chain(last).collect()
    }
}

/// The states of a run.
fn each_of(
    scheme: (Method, Retraction, Order),
    steps: u64,
    observe: impl FnMut(u64, f64, &QuadrotorState),
) -> Result<(), Error> {
    let quadrotor = Quadrotor { inertia: vector![1.0, 10.0, 100.0], mass: 1.0, gravity: 9.81 };
    // its own control law is that of hover
    Ok(each_step(&quadrotor, &start(), scheme, (STEP, steps), observe)?)
}

fn start() -> QuadrotorState {
    QuadrotorState { attitude_momentum: vector![1.0, 1.0, 1.0], ..Quadrotor::at_rest(1.0) }
}

fn flight(
    name: &str,
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
