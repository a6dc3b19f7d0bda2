//! A package for Python with a system of one's own, compiled ahead: `maturin develop --release` beside an installed `coadjoint`.
//!
//! ```python
//! from my_bodies import HeavyTop
//!
//! top = HeavyTop(inertia=[1, 10, 100], weight=1, chi=[0, 0, 1])
//! sol = top.run({"momentum": [1, 1, 1], "gamma": [0, 0, 1]}, 1800, step=0.01)
//! ```

use coadjoint::prelude::*;

/// A rigid body that turns about a fixed point under gravity.
#[lie_poisson_system(group = SO3, advected(gamma: R3), potential = weight * gamma.dot(&chi))]
pub struct HeavyTop {
    /// Principal moments of inertia about the fixed point.
    #[inertia]
    #[unit("kg m²")]
    pub inertia: Vector3<f64>,
    /// Mass times gravitational acceleration.
    #[unit("N")]
    pub weight: f64,
    /// From the fixed point to the centre of mass, in body axes.
    #[unit("m")]
    pub chi: Vector3<f64>,
}

coadjoint_python::module!(my_bodies: HeavyTop);
