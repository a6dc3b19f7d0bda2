//! The free rigid body.

use coadjoint::prelude::*;

/// A rigid body on which nothing acts: it tumbles.
#[lie_poisson_system(group = SO3)]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(crate = "coadjoint::__private::serde")]
pub struct FreeRigidBody {
    /// Principal moments of inertia about the centre of mass, kg m².
    #[inertia]
    pub inertia: Vector3<f64>,
}
