//! What exact derivatives of steps are for, worked out on one spacecraft: [identification] of its inertia, [steering] to another attitude,
//! [estimation] of where it points and how it turns.
//!
//! Each is the textbook's algorithm with the linearization of the step that is really taken: Gauss–Newton, shooting and the Kalman filter get
//! exact derivatives of the motion, so that they converge as they should, at any step size.

pub mod estimation;
pub mod identification;
pub mod steering;

use coadjoint::prelude::*;
use coadjoint::{ParameterError, StepError};
use coadjoint_app::setup::random::Random;

/// A spacecraft that thrusters turn.
///
/// ```text
/// Π' = Π × 𝓘⁻¹Π + τ,   R' = R (𝓘⁻¹Π)^
/// ```
#[lie_poisson_system(
    group = SO3,
    control(torque: R3),
    force = torque,
    retractions(Cayley),
    derivatives(state, controls, parameters),
)]
#[derive(Clone, Debug, PartialEq)]
pub struct Spacecraft {
    /// Tensor of inertia about the centre of mass, body frame, kg m².
    #[inertia]
    pub inertia: Matrix3<f64>,
}

impl Spacecraft {
    /// A small one, with axes that are not those of its inertia.
    pub fn small() -> Self {
        Self { inertia: matrix![1.8, 0.12, -0.2; 0.12, 2.4, 0.15; -0.2, 0.15, 1.2] }
    }
}

/// Why something could not be computed.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Failure {
    /// A stepper could not be built.
    #[error("invalid spacecraft parameters")]
    Parameters(#[from] ParameterError),
    /// A step could not be taken.
    #[error("a step could not be taken")]
    Step(#[from] StepError),
    /// The equations do not determine the unknowns: they are singular.
    #[error("the measurements or controls do not determine the unknowns")]
    Singular,
}

impl From<Failure> for coadjoint_app::Error {
    fn from(failure: Failure) -> Self {
        Self::other(failure)
    }
}

/// Noise that is the same for the same seed.
struct Noise(Random);

impl Noise {
    fn new(seed: u64) -> Self {
        Self(Random::new(seed, 0))
    }

    /// Normally distributed, each component with this standard deviation.
    fn vector(&mut self, deviation: f64) -> Vector3<f64> {
        Vector3::from_fn(|_, _| deviation * self.0.normal())
    }
}
