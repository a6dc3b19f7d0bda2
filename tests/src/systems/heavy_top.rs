//! The heavy top.

use coadjoint::prelude::*;

/// A rigid body that turns about a fixed point under gravity.
#[lie_poisson_system(
    group = SO3,
    advected(gamma: R3),
    potential = weight * gamma.dot(&chi),
)]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(crate = "coadjoint::__private::serde")]
pub struct HeavyTop {
    /// Principal moments of inertia about the fixed point, kg m².
    #[inertia]
    pub inertia: Vector3<f64>,
    /// Mass times gravitational acceleration, N.
    pub weight: f64,
    /// From the fixed point to the centre of mass, in body axes, m.
    pub chi: Vector3<f64>,
}
