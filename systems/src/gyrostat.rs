//! The gyrostat.

use coadjoint::prelude::*;
use coadjoint_app::Example;
use coadjoint_app::scene::Scene;
use coadjoint_app::shape::{Shape, Solid};
use serde::{Deserialize, Serialize};

/// A rigid body that carries a rotor on a bearing without friction, and nothing acts on the two: a satellite with a flywheel.
///
/// Hamiltonian: `H = ½ (Π − ℓa)·𝓘⁻¹(Π − ℓa) + ℓ²/2j`, with the angular momentum `Π` of both together in body axes, the rotor's angular
/// momentum `ℓ` about its axis `a`, the rotor's moment of inertia `j` about it, and the tensor of inertia `𝓘` of all that does not turn with the
/// rotor: the body, and the rotor across its axis.
///
/// Motion: with the body's angular velocity `ω = 𝓘⁻¹(Π − ℓa)`, `Π̇ = Π × ω`, `ℓ̇ = 0`, `Ṙ = R ω^`, and the rotor turns by `ℓ/j − a·ω`
/// against the body.
///
/// Invariants: the energy `H`, the Casimirs `|Π|²` and `ℓ`, and the angular momentum in space, `RΠ`. A rotor that turns fast enough
/// makes every axis stable that it lies along, also the middle one.
#[lie_poisson_system(
    group(attitude: SO3, rotor: SO2),
    hamiltonian = {
        let of_body = attitude_momentum - rotor_momentum.x * axis;
        0.5 * of_body.dot(&of_body.component_div(&inertia)) + rotor_momentum.norm_squared() / (2.0 * rotor_inertia)
    },
    methods(Midpoint),
    units(attitude_momentum = "kg m²/s", rotor_momentum = "kg m²/s"),
)]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gyrostat {
    /// Principal moments of inertia without that of the rotor about its axis, kg m².
    #[unit("kg m²")]
    pub inertia: Vector3<f64>,
    /// Moment of inertia of the rotor about its axis, kg m².
    #[unit("kg m²")]
    pub rotor_inertia: f64,
    /// Direction of the rotor's axis in body axes, of length 1.
    pub axis: Vector3<f64>,
}

impl Example for Gyrostat {
    const ABOUT: &'static str = "a rigid body with a rotor: a satellite and its flywheel";
    const STEP: f64 = 0.01;
    /// The energy's error swings slowly.
    const CERTIFIED_STEP: Option<f64> = Some(4e-3);
    const DURATION: f64 = 300.0;
    const CASIMIR_UNITS: &'static [&'static str] = &["kg² m⁴/s²", "kg m²/s"];

    /// A satellite turning about its middle axis, which a flywheel along that axis makes stable: below 2 kg m²/s it would turn over.
    fn example() -> (Self, GyrostatState) {
        let gyrostat =
            Gyrostat { inertia: vector![60.0, 80.0, 100.0], rotor_inertia: 0.05, axis: Vector3::y() };
        let start = GyrostatState {
            attitude: UnitQuaternion::identity(),
            attitude_momentum: vector![0.1, 10.0, 0.1],
            rotor: UnitComplex::identity(),
            rotor_momentum: vector![2.5],
        };
        (gyrostat, start)
    }

    fn scene(&self, by_state: Scene) -> Scene {
        let all =
            Matrix3::from_diagonal(&self.inertia) + self.rotor_inertia * self.axis * self.axis.transpose();
        let rotor = Solid::new(Shape::Disc { radius: 1.0, thickness: 0.2 }).along(self.axis).of_any_size();
        let scene = by_state.named(0, "body").solid(0, Solid::of_inertia(&all));
        scene.mount(1, 0, Vector3::zeros(), self.axis).solid(1, rotor)
    }
}
