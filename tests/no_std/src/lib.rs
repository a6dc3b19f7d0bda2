//! A system as embedded software has it: no standard library, no allocation, elementary functions in the potential.
#![no_std]

use coadjoint::prelude::*;
use coadjoint::serde::{Deserialize, Serialize};
use coadjoint::{Run, RunError, RunReport};

/// The gravitational acceleration, m/s².
pub const GRAVITY: f32 = 9.81;

/// A body in a field that is not uniform.
#[lie_poisson_system(
    group = SO3,
    advected(gamma: R3),
    potential = {
        let height = gamma.dot(&chi);
        mass * GRAVITY * height.sin() + stiffness * (1.0 + height.powi(2)).sqrt() + gamma.z.atan2(2.0)
    },
)]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(crate = "coadjoint::serde", deny_unknown_fields)]
pub struct Body {
    /// Moments and products of inertia, kg m².
    #[inertia]
    pub inertia: Matrix3<f32>,
    /// kg
    pub mass: f32,
    /// To the centre of mass, m.
    pub chi: Vector3<f32>,
    /// J
    pub stiffness: f32,
}

/// So many steps from a start.
///
/// # Errors
/// If a step cannot be taken.
pub fn advance(
    stepper: &mut Stepper<Body, Cayley>,
    state: &mut BodyState,
    steps: u64,
) -> Result<RunReport, RunError> {
    Run::new(stepper, state).until(|tick| tick.state.gamma.z < 0.0).steps(steps)
}

/// What hangs on a spring that is not linear.
#[lie_poisson_system(
    group = R1,
    potential = stiffness * position.x.powi(4) / 4.0,
    event(middle = position.x, rising),
    taylor,
)]
pub struct Hanging {
    /// kg
    #[inertia]
    pub mass: f64,
    /// N/m³
    pub stiffness: f64,
}

/// Counts the passes until a time, by Taylor steps.
///
/// # Errors
/// If a step cannot be taken.
pub fn passes(
    trajectory: &mut coadjoint::taylor::Adaptive<Hanging>,
    state: &mut HangingState,
    time: f64,
) -> Result<u32, RunError> {
    let mut passes = 0;
    Run::new(trajectory, state).on("middle", |_| passes += 1).to(time)?;
    Ok(passes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_runs() {
        let inertia = matrix![2.0, 0.1, 0.0; 0.1, 1.5, 0.2; 0.0, 0.2, 1.0];
        let body = Body { inertia, mass: 0.1, chi: vector![0.0, 0.1, 0.3], stiffness: 0.2 };
        let attitude = UnitQuaternion::identity();
        let mut state = BodyState { attitude, momentum: vector![0.1, 0.0, 1.0], gamma: Vector3::z() };
        let before = body.energy(&state);
        let mut stepper = body.stepper::<Cayley>(0.01).expect("valid parameters");
        let report = advance(&mut stepper, &mut state, 400).expect("an easy motion");
        assert_eq!(report.steps, 400);
        // the motion's own error at this step, and f32's roundoff
        assert!((body.energy(&state) - before).abs() < 2e-5, "{} {before}", body.energy(&state));
    }

    #[test]
    fn it_takes_taylor_steps() {
        let hanging = Hanging { mass: 1.0, stiffness: 1.0 };
        let mut state = HangingState { position: vector![1.0], momentum: vector![0.0] };
        let mut trajectory = hanging.adaptive(1e-12).expect("valid parameters");
        // a period is 7.4163 s
        assert_eq!(passes(&mut trajectory, &mut state, 74.163).expect("an easy motion"), 10);
        let error = hanging.energy(&state) - 0.25;
        assert!(error.abs() < 1e-11, "{error:e}");
    }
}
