//! Figures 6.1 and 6.2: the free rigid body and the heavy top, over 30 minutes, with four methods.

use coadjoint::prelude::*;
use nalgebra::Vector6;

use super::caption::{Caption, Paragraph, Piece, given, measured, paragraph, verdict};
use super::each_step::each_step;
use super::invariant_errors::{BINS, panel};
use super::methods::{CAYLEY, EXPONENTIAL, RK4, RKMK4};
use super::{Data, InvariantErrors};
use coadjoint_app::Error;
use coadjoint_app::Example;
use coadjoint_app::picture::{Figure, Key};
use coadjoint_app::setup::{Method, Order, Retraction};
use coadjoint_systems::classical::{
    AttitudeState, Integrator, OnSo3, Rk4Quaternion, Rkmk4, bodies, integrate,
};
use coadjoint_systems::free_rigid_body::{FreeRigidBody, FreeRigidBodyState};
use coadjoint_systems::heavy_top::HeavyTop;

/// The step, s.
pub(crate) const STEP: f64 = 0.01;
/// How many: 30 minutes.
pub(crate) const STEPS: u64 = 180_000;

/// Four methods: exponential and Cayley, RK4 on unit quaternions with projection, RKMK4.
#[derive(Clone, Debug)]
pub(crate) struct Bodies {
    /// In this order; of each, the energy first, then the Casimirs.
    pub(crate) runs: [InvariantErrors; 4],
    title: &'static str,
    /// The quantities' names.
    labels: &'static [&'static str],
    steps: u64,
}

impl Bodies {
    /// The free rigid body: `𝓘 = diag(1, 10, 100)`, `Π₀ = (1, 1, 1)`, `R₀ = 1`.
    ///
    /// # Errors
    /// If a step cannot be taken.
    pub(crate) fn free(steps: u64) -> Result<Self, Error> {
        let body = FreeRigidBody { inertia: vector![1.0, 10.0, 100.0] };
        let start =
            FreeRigidBodyState { attitude: UnitQuaternion::identity(), momentum: vector![1.0, 1.0, 1.0] };
        let quantities = |system: &FreeRigidBody, state: &FreeRigidBodyState| {
            [system.energy(state), state.momentum.norm_squared()]
        };
        let by_hand = bodies::RigidBody::new(body.inertia);
        let measured = |y: &Vector3<f64>| [by_hand.energy(y), y.norm_squared()];
        let from = AttitudeState { attitude: start.attitude, y: start.momentum };
        Ok(Self {
            runs: [
                ours(EXPONENTIAL, Retraction::Exponential, &body, &start, steps, quantities)?,
                ours(CAYLEY, Retraction::Cayley, &body, &start, steps, quantities)?,
                theirs(RK4, Rk4Quaternion, &by_hand, from, steps, measured)?,
                theirs(RKMK4, Rkmk4, &by_hand, from, steps, measured)?,
            ],
            title: "6.1  Free rigid body, 30 minutes",
            labels: &["energy |H − H₀|, J", "| |Π|² − |Π₀|² |, kg² m⁴/s²"],
            steps,
        })
    }

    /// The heavy top with the same data; the paper leaves its centre of mass open, ours is `mgχ = (0, 0, 1)` N m.
    ///
    /// # Errors
    /// If a step cannot be taken.
    pub(crate) fn top(steps: u64) -> Result<Self, Error> {
        let (top, start) = HeavyTop::example();
        let quantities = |system: &HeavyTop, state: &_| {
            let [length, product] = system.casimirs(state);
            [system.energy(state), length, product]
        };
        let by_hand = bodies::HeavyTop::new(top.inertia, top.weight, top.chi);
        let halves = |y: &Vector6<f64>| (vector![y[0], y[1], y[2]], vector![y[3], y[4], y[5]]);
        let measured = |y: &Vector6<f64>| {
            let (momentum, gamma) = halves(y);
            [by_hand.energy(y), gamma.norm_squared(), momentum.dot(&gamma)]
        };
        let mut y = Vector6::zeros();
        y.fixed_rows_mut::<3>(0).copy_from(&start.momentum);
        y.fixed_rows_mut::<3>(3).copy_from(&start.gamma);
        let from = AttitudeState { attitude: start.attitude, y };
        Ok(Self {
            runs: [
                ours(EXPONENTIAL, Retraction::Exponential, &top, &start, steps, quantities)?,
                ours(CAYLEY, Retraction::Cayley, &top, &start, steps, quantities)?,
                theirs(RK4, Rk4Quaternion, &by_hand, from, steps, measured)?,
                theirs(RKMK4, Rkmk4, &by_hand, from, steps, measured)?,
            ],
            title: "6.2  Heavy top, 30 minutes",
            labels: &["energy |H − H₀|, J", "| |Γ|² − 1 |, no unit", "|Π·Γ − Π₀·Γ₀|, kg m²/s"],
            steps,
        })
    }

    /// The errors over time.
    pub(crate) fn figure(&self) -> Figure {
        const TIME: &str = "time, s";
        let panels =
            self.labels.iter().enumerate().map(|(i, label)| panel(&self.runs, i, TIME, label)).collect();
        let span = (0.0, self.steps as f64 * STEP);
        Figure {
            cell: (760.0, 220.0),
            ..Figure::over_time(self.title.to_owned(), TIME, span, Key::Above, panels)
        }
    }
}

/// Below figure 6.1.
pub(crate) fn free_caption(data: &Data) -> Caption {
    let body = given("I = diag(1, 10, 100) kg m², Π₀ = (1, 1, 1) kg m²/s, R₀ = 1, h = 0.01 s");
    let units = [" kg² m⁴/s²"];
    caption(data, paragraph![body, ". Each point is the largest error of ", bin(), " s."], &units)
}

/// Below figure 6.2.
pub(crate) fn top_caption(data: &Data) -> Caption {
    let top = given("I = diag(1, 10, 100) kg m², Π₀ = (1, 1, 1) kg m²/s, R₀ = 1, Γ₀ = (0, 0, 1), h = 0.01 s");
    let open = paragraph![
        top,
        "; mgχ, which the paper leaves open, is ",
        given("(0, 0, 1) N m"),
        ". Each point is the largest error of ",
        bin(),
        " s."
    ];
    caption(data, open, &["", " kg m²/s"])
}

/// How long a run is of which one point is the largest error, s.
fn bin() -> Piece {
    given(STEPS as f64 * STEP / BINS as f64)
}

fn caption(data: &Data, body: Paragraph, units: &[&'static str]) -> Caption {
    let mut caption = vec![body];
    for method in [EXPONENTIAL, CAYLEY, RK4] {
        let energy = data.curve(1, method);
        let (first, last) = energy.ends();
        let Paragraph(mut pieces) = paragraph![
            given(method),
            ": energy error up to ",
            measured(first),
            " J in the first fifth of the time, ",
            measured(last),
            " J in the last: it ",
            verdict(if energy.grows() { "grows" } else { "does not grow" }),
            ". Casimir error up to ",
        ];
        for (k, (unit, panel)) in units.iter().zip(2..).enumerate() {
            let separate = if k > 0 { " and " } else { "" };
            let error = measured(data.curve(panel, method).largest());
            pieces.extend([separate.into(), error, (*unit).into()]);
        }
        pieces.push(".".into());
        caption.push(Paragraph(pieces));
    }
    caption.push(paragraph![
        "RK4 is on quaternions, brought to unit length after each step. RKMK4 differs from it in the attitude alone, which is not shown. \
         Both are of order four: their errors are small at a step as small as this, and grow with the time."
    ]);
    caption.push(paragraph![
        "Unlike the paper's, the figure shows errors on a logarithmic scale, of all methods in one panel. Ours are the paper's reduced \
         steps with the signs and factors of its definitions, not those that are printed."
    ]);
    caption
}

/// A run of ours.
fn ours<S: Example, const N: usize>(
    name: &'static str,
    retraction: Retraction,
    system: &S,
    start: &S::State,
    steps: u64,
    quantities: impl Fn(&S, &S::State) -> [f64; N],
) -> Result<InvariantErrors, Error> {
    let mut run = InvariantErrors::new(name, steps);
    let scheme = (Method::Standard, retraction, Order::Two);
    each_step(system, start, scheme, (STEP, steps), |index, time, state| {
        run.push(index, time, quantities(system, state));
    })?;
    Ok(run)
}

/// A run of a classical method.
fn theirs<I, S, const M: usize, const N: usize>(
    name: &'static str,
    method: I,
    system: &S,
    start: AttitudeState<M>,
    steps: u64,
    quantities: impl Fn(&nalgebra::SVector<f64, M>) -> [f64; N],
) -> Result<InvariantErrors, Error>
where
    I: Integrator<S, AttitudeState<M>>,
    S: OnSo3<M>,
{
    let mut run = InvariantErrors::new(name, steps);
    integrate(&method, system, 0.0, start, STEP, steps, |k, time, state| {
        run.push(k, time, quantities(&state.y));
    })?;
    Ok(run)
}
