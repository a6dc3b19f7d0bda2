//! Small systems, and runs of them.

use std::ops::ControlFlow;
use std::path::Path;

use coadjoint::prelude::*;
use coadjoint_app::cli::console::OutputMode;
use coadjoint_app::cli::session::{Plan, Session};
use coadjoint_app::scene::Scene;
use coadjoint_app::setup::{Job, Method, Order, Retraction};
use coadjoint_app::simulate::{Sample, simulate};
use coadjoint_app::{Entry, Example};

/// A pendulum.
#[lie_poisson_system(group = SO2, potential = -weight * length * angle.cos_angle())]
struct Pendulum {
    #[inertia]
    inertia: f64,
    weight: f64,
    length: f64,
}

impl Example for Pendulum {
    fn example() -> (Self, PendulumState) {
        let start = PendulumState { angle: UnitComplex::new(2.5), momentum: vector![0.0] };
        (Self { inertia: 0.64, weight: 9.81, length: 0.8 }, start)
    }

    fn scene(&self, by_state: Scene) -> Scene {
        by_state.bob(0, self.length).weight(0, self.weight, vector![0.0, 0.0, -self.length])
    }
}

/// A free rigid body.
#[lie_poisson_system(group = SO3)]
struct Body {
    #[inertia]
    inertia: Vector3<f64>,
}

impl Example for Body {
    fn example() -> (Self, BodyState) {
        let start = BodyState { attitude: UnitQuaternion::identity(), momentum: vector![0.1, 2.0, 0.1] };
        (Self { inertia: vector![1.0, 2.0, 2.5] }, start)
    }

    fn body_inertia(&self) -> Option<Matrix3<f64>> {
        Some(Matrix3::from_diagonal(&self.inertia))
    }
}

pub(super) struct Asked(Entry);

/// A pendulum of 0.8 m.
pub(super) fn pendulum(length: f64) -> Asked {
    let mut entry = Pendulum::entry();
    entry.example.parameters[2] = length;
    Asked(entry)
}

/// A pendulum without weight that turns at this rate, rad/s, from an angle of 2.5 rad on.
pub(super) fn rotor(rate: f64) -> Asked {
    let mut entry = Pendulum::entry();
    entry.example.parameters[1] = 0.0;
    entry.example.state[2] = 0.64 * rate;
    Asked(entry)
}

/// A brick that turns about its middle axis.
pub(super) fn free_body() -> Asked {
    Asked(Body::entry())
}

/// A brick that turns about its first axis at this rate, rad/s.
pub(super) fn spinning_body(rate: f64) -> Asked {
    let mut entry = Body::entry();
    entry.example.state[4..].copy_from_slice(&[rate, 0.0, 0.0]);
    Asked(entry)
}

impl Asked {
    /// Makes a run, and writes its page.
    pub(super) fn run(self, html: &Path, steps: u64, step: f64) -> Run {
        let job = Job {
            method: Method::Standard,
            retraction: Retraction::Exponential,
            order: Order::Two,
            step,
            steps,
            rest: 0.0,
        };
        let plan = Plan {
            system: self.0.name.clone(),
            description: None,
            setup: self.0.example.clone(),
            job,
            watch: true,
            every: 1,
            columns: Vec::new(),
            quantity: Vec::new(),
            until: None,
            moments: Default::default(),
            format: None,
            plot: false,
            html: Some(html.to_owned()),
            out: html.with_extension("out"),
            pause: 10.0,
            force: true,
            inputs: Vec::new(),
        };
        let mut states = Vec::new();
        let keep = &mut |sample: &Sample<'_>| {
            states.push(sample.state.to_vec());
            ControlFlow::Continue(())
        };
        simulate(&self.0, &self.0.example, &job, None, &|index| index + 1, keep).expect("a motion");
        let session = Session::begin(&self.0, plan, None).expect("a run");
        let mode = OutputMode { json: false, quiet: true };
        session.run(&mode.on(&mut std::io::sink(), false).expect("allowed")).expect("a run");
        Run { step, states }
    }
}

/// The states of a run.
pub(super) struct Run {
    step: f64,
    states: Vec<Vec<f64>>,
}

impl Run {
    pub(super) fn state(&self, time: f64) -> &[f64] {
        &self.states[(time / self.step).round() as usize]
    }
}
