//! Figure 6.3: the quadrotor with the thrust of hover.

use coadjoint::prelude::*;

use super::bodies::STEP;
use super::invariant_errors::panel;
use super::{InvariantErrors, figures};
use crate::error::Error;
use crate::plot::{Axis, Envelope, Figure, Key, Panel, Series};
use coadjoint_systems::quadrotor::{Quadrotor, QuadrotorState};
use coadjoint_systems::simulation::{Method, Order, Retraction, each_step};

/// Both retractions: `𝓘 = diag(1, 10, 100)`, `Π₀ = (1, 1, 1)`, `R₀ = 1`, `p₀ = 0`, `q₀ = (0, 0, 1)`, with thrust `mg` along the third axis
/// and no moment. The paper leaves mass and gravity open: ours are 1 kg and 9.81 m/s².
#[derive(Clone, Debug)]
pub(crate) struct Hover {
    /// Exponential and Cayley; of each `|R Π − R₀ Π₀|`, `|Π|` and `|q|`, the length of the attitude's quaternion.
    pub(crate) runs: [InvariantErrors; 2],
    /// How the height goes, of each.
    heights: [Vec<(f64, f64)>; 2],
    steps: u64,
}

impl Hover {
    /// Makes the runs.
    ///
    /// # Errors
    /// If a step cannot be taken.
    pub(crate) fn measure(steps: u64) -> Result<Self, Error> {
        let (exponential, first) = run("exponential", Retraction::Exponential, steps)?;
        let (cayley, second) = run("Cayley", Retraction::Cayley, steps)?;
        Ok(Self { runs: [exponential, cayley], heights: [first, second], steps })
    }

    /// The errors over time, and the height.
    pub(crate) fn figure(&self) -> Figure {
        let time = "time, s";
        let mut panels: Vec<Panel> = ["|RΠ − R₀Π₀|, kg m²/s", "| |Π| − |Π₀| |, kg m²/s", "| |q| − 1 |"]
            .into_iter()
            .enumerate()
            .map(|(i, label)| panel(&self.runs, i, time, label))
            .collect();
        let heights = self.runs.iter().zip(&self.heights);
        panels.push(Panel::new(
            Axis::linear(time),
            Axis::linear("height, m"),
            heights.map(|(run, height)| Series::line(&run.method, height.clone())).collect(),
        ));
        let title = "6.3  Quadrotor with the thrust of hover for 30 minutes";
        let given = "I = diag(1, 10, 100) kg m², Π₀ = (1, 1, 1) kg m²/s, R₀ = 1, p₀ = 0, q₀ = (0, 0, 1) m, h = 0.01 s; mass and gravity, \
                     which the paper leaves open, are 1 kg and 9.81 m/s²; thrust mg along the third body axis, no moment.";
        let caption = self.runs.iter().map(|run| {
            let errors: Vec<String> =
                run.invariants.iter().map(|series| figures(series.stats.error)).collect();
            format!(
                "{}: the angular momentum in space is kept to {} kg m²/s and its length to {} kg m²/s, the attitude is on its group to {}.",
                run.method,
                errors.first().map_or("", String::as_str),
                errors.get(1).map_or("", String::as_str),
                errors.get(2).map_or("", String::as_str),
            )
        });
        let caption = [given.to_owned()].into_iter().chain(caption).chain([
            "The body tumbles, and its thrust with it: it does not hover, but falls. Energy is not conserved, the thrust works. At rest \
             upright it stays where it is."
                .to_owned(),
        ]);
        Figure {
            caption: caption.collect(),
            ..Figure::over_time(title.to_owned(), time, (0.0, self.steps as f64 * STEP), Key::Below, panels)
        }
    }
}

fn run(name: &str, retraction: Retraction, steps: u64) -> Result<(InvariantErrors, Vec<(f64, f64)>), Error> {
    let quadrotor = Quadrotor { inertia: vector![1.0, 10.0, 100.0], mass: 1.0, gravity: 9.81 };
    let start = QuadrotorState { attitude_momentum: vector![1.0, 1.0, 1.0], ..Quadrotor::at_rest(1.0) };
    let in_space = |state: &QuadrotorState| state.attitude * state.attitude_momentum;
    let initially = in_space(&start);
    let mut run = InvariantErrors::new(name, steps);
    let mut height = Envelope::new(steps + 1, 450);
    // its own control law is that of hover
    let scheme = (Method::Standard, retraction, Order::Two);
    each_step(&quadrotor, &start, scheme, (STEP, steps), |index, time, state| {
        let QuadrotorState { attitude, attitude_momentum, position, .. } = state;
        let turned = (in_space(state) - initially).norm();
        let length = attitude.quaternion().norm();
        run.push(index, time, [turned, attitude_momentum.norm(), length]);
        height.push(index, time, position.z);
    })?;
    Ok((run, height.both()))
}
