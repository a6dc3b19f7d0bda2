//! Ensembles of two systems of one's own on the processes of an MPI job:
//! `mpirun -n 4 target/release/examples/two_bodies ensemble heavy_top --members 1e6`.

use coadjoint::prelude::*;
use coadjoint_app::Example;

/// A rigid body on which nothing acts.
#[lie_poisson_system(group = SO3, retractions(Cayley))]
struct FreeBody {
    /// Principal moments of inertia, kg m².
    #[inertia]
    inertia: Vector3<f64>,
}

impl Example for FreeBody {
    const ABOUT: &'static str = "a rigid body on which nothing acts";

    fn example() -> (Self, FreeBodyState) {
        let start =
            FreeBodyState { attitude: UnitQuaternion::identity(), momentum: vector![0.01, 1.0, 0.01] };
        (FreeBody { inertia: vector![1.0, 2.0, 3.0] }, start)
    }
}

/// A rigid body that turns about a fixed point under gravity.
#[lie_poisson_system(group = SO3, retractions(Cayley), advected(gamma: R3), potential = weight * gamma.dot(&chi))]
struct HeavyTop {
    /// Principal moments of inertia about the point, kg m².
    #[inertia]
    inertia: Vector3<f64>,
    /// N.
    weight: f64,
    /// From the point to the centre of mass, m.
    chi: Vector3<f64>,
}

impl Example for HeavyTop {
    const ABOUT: &'static str = "a rigid body that turns about a fixed point under gravity";

    fn example() -> (Self, HeavyTopState) {
        let top = HeavyTop { inertia: vector![1.0, 10.0, 100.0], weight: 1.0, chi: Vector3::z() };
        let attitude = UnitQuaternion::identity();
        (top, HeavyTopState { attitude, momentum: vector![1.0, 1.0, 1.0], gamma: Vector3::z() })
    }
}

fn main() -> std::process::ExitCode {
    coadjoint_mpi::main([FreeBody::entry(), HeavyTop::entry()])
}
