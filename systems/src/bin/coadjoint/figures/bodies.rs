//! Figures 6.1 and 6.2: the free rigid body and the heavy top, over 30 minutes, with four methods.

use coadjoint::prelude::*;
use nalgebra::Vector6;

use super::invariant_errors::panel;
use super::{ErrorSeries, InvariantErrors, figures};
use coadjoint_app::Error;
use coadjoint_app::Example;
use coadjoint_app::plot::{Figure, Key};
use coadjoint_app::simulation::{Method, Order, Retraction, each_step};
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
    /// Parameters and start.
    given: &'static str,
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
                ours("exponential", Retraction::Exponential, &body, &start, steps, quantities)?,
                ours("Cayley", Retraction::Cayley, &body, &start, steps, quantities)?,
                theirs("RK4 on quaternions, projected", Rk4Quaternion, &by_hand, from, steps, measured)?,
                theirs("RKMK4", Rkmk4, &by_hand, from, steps, measured)?,
            ],
            title: "6.1  Free rigid body for 30 minutes",
            given: "I = diag(1, 10, 100) kg m², Π₀ = (1, 1, 1) kg m²/s, R₀ = 1, h = 0.01 s.",
            labels: &["|H − H₀|, J", "| |Π|² − |Π₀|² |, kg² m⁴/s²"],
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
                ours("exponential", Retraction::Exponential, &top, &start, steps, quantities)?,
                ours("Cayley", Retraction::Cayley, &top, &start, steps, quantities)?,
                theirs("RK4 on quaternions, projected", Rk4Quaternion, &by_hand, from, steps, measured)?,
                theirs("RKMK4", Rkmk4, &by_hand, from, steps, measured)?,
            ],
            title: "6.2  Heavy top for 30 minutes",
            given: "I = diag(1, 10, 100) kg m², Π₀ = (1, 1, 1) kg m²/s, R₀ = 1, Γ₀ = (0, 0, 1), h = 0.01 s; mgχ, which the paper leaves \
                    open, is (0, 0, 1) N m.",
            labels: &["|H − H₀|, J", "| |Γ|² − 1 |", "|Π·Γ − Π₀·Γ₀|, kg m²/s"],
            steps,
        })
    }

    /// The errors over time.
    pub(crate) fn figure(&self) -> Figure {
        let time = format!(
            "time, s (each point is the largest error of {} s)",
            (self.steps as f64 * STEP / 450.0 * 100.0).round() / 100.0
        );
        let panels =
            self.labels.iter().enumerate().map(|(i, label)| panel(&self.runs, i, &time, label)).collect();
        let span = (0.0, self.steps as f64 * STEP);
        let figure = Figure::over_time(self.title.to_owned(), &time, span, Key::Below, panels);
        let drift = |series: &ErrorSeries| {
            let stats = &series.stats;
            if stats.drift() > 0.5 {
                format!("{}, drifting by {}/s", figures(stats.error), figures(stats.slope()))
            } else {
                format!("{}, not drifting", figures(stats.error))
            }
        };
        let lines = self.runs.iter().map(|run| {
            let energy = run.invariants.first().map(drift).unwrap_or_default();
            let casimirs: Vec<String> =
                run.invariants.iter().skip(1).map(|series| figures(series.stats.error)).collect();
            format!("{}: energy error {energy}; Casimir errors {}.", run.method, casimirs.join(" and "))
        });
        let unlike = "Unlike the paper's, the figure shows errors on a logarithmic scale, of all methods in one panel. Ours are the paper's \
                      reduced steps with the signs and factors of its definitions, not those that are printed."
            .to_owned();
        let paragraphs = [self.given.to_owned(), unlike].into_iter().chain(lines).chain([
            "The steps of order 2 keep the Casimirs to roundoff, and their energy errors do not grow; with the methods of order 4 all \
             errors grow steadily, from a level that a step as small as this makes very low. RK4 and RKMK4 differ in the attitude \
             alone, which is not shown."
                .to_owned(),
        ]);
        Figure { caption: paragraphs.collect(), ..figure }
    }
}

/// A run of ours.
fn ours<S: Example, const N: usize>(
    name: &str,
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
    name: &str,
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
