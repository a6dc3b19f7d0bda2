//! A satellite with reaction wheels.

use coadjoint::prelude::*;
use coadjoint_app::Example;
use coadjoint_app::scene::Scene;
use coadjoint_app::shape::{Shape, Solid};
use serde::{Deserialize, Serialize};

/// A satellite that turns by what its three wheels are turned: one along each principal axis, each with a motor.
///
/// Hamiltonian: `H = ½ (Π − ℓ)·𝓘⁻¹(Π − ℓ) + |ℓ|²/2j`, with the angular momentum `Π` of satellite and wheels together in the axes of the satellite, the
/// angular momenta `ℓ = (ℓ₁, ℓ₂, ℓ₃)` of the wheels about their axes, a wheel's moment of inertia `j` about its axis, and the moments of inertia `𝓘` of
/// all that does not turn with the wheels: the satellite, and the wheels across their axes.
///
/// Motion: with the angular velocity `ω = 𝓘⁻¹(Π − ℓ)` of the satellite, `Π̇ = Π × ω`, `ℓ̇ = u`, `Ṙ = R ω^`, and the wheels turn by `ℓ/j − ω` against the
/// satellite. The controls `u` are the torques of the motors on the wheels.
///
/// Invariants: the angular momentum in space, `RΠ`, whatever the motors do. The energy is what they put in and take out.
///
/// Wheels turn by more than a radian in a step that suits the satellite. By the exponential they turn exactly, while the Cayley map would need short steps:
/// there are none with it.
///
/// The equations are those of F. L. Markley and J. L. Crassidis, *Fundamentals of Spacecraft Attitude Determination and Control* (2014); the control law,
/// [`slew`](Self::slew), is that of B. Wie, H. Weiss and A. Arapostathis, *Quaternion feedback regulator for spacecraft eigenaxis rotations* (1989).
#[lie_poisson_system(
    group(attitude: SO3, wheel_x: SO2, wheel_y: SO2, wheel_z: SO2),
    control(torque: R3),
    hamiltonian = {
        let wheels = vector![wheel_x_momentum.x, wheel_y_momentum.x, wheel_z_momentum.x];
        let of_satellite = attitude_momentum - wheels;
        of_satellite.dot(&of_satellite.component_div(&inertia)) / 2.0 + wheels.norm_squared() / (2.0 * wheel_inertia)
    },
    force(wheel_x = torque.x, wheel_y = torque.y, wheel_z = torque.z),
    methods(Midpoint),
    retractions(Exponential),
    units(
        attitude_momentum = "kg m²/s",
        wheel_x_momentum = "kg m²/s",
        wheel_y_momentum = "kg m²/s",
        wheel_z_momentum = "kg m²/s",
        torque = "N m",
    ),
)]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SatelliteWithWheels {
    /// Principal moments of inertia without those of the wheels about their axes, kg m².
    #[inertia]
    #[unit("kg m²")]
    pub inertia: Vector3<f64>,
    /// Moment of inertia of a wheel about its axis, kg m².
    #[inertia]
    #[unit("kg m²")]
    pub wheel_inertia: f64,
}

impl SatelliteWithWheels {
    /// Mass of what the pictures show, kg: no motion depends on it.
    const MASS: f64 = 150.0;
    /// How fast the control law turns the satellite back, rad/s: a slew settles within some ten times its inverse.
    const BANDWIDTH: f64 = 0.03;

    /// At rest at this attitude, with wheels that have these angular momenta, kg m²/s.
    pub fn at_rest(attitude: UnitQuaternion<f64>, wheels: Vector3<f64>) -> SatelliteWithWheelsState {
        SatelliteWithWheelsState {
            attitude,
            attitude_momentum: wheels,
            wheel_x: UnitComplex::identity(),
            wheel_x_momentum: vector![wheels.x],
            wheel_y: UnitComplex::identity(),
            wheel_y_momentum: vector![wheels.y],
            wheel_z: UnitComplex::identity(),
            wheel_z_momentum: vector![wheels.z],
        }
    }

    /// The angular velocity of the satellite in its axes, rad/s.
    pub fn angular_velocity(&self, state: &SatelliteWithWheelsState) -> Vector3<f64> {
        (state.attitude_momentum - Self::wheels(state)).component_div(&self.inertia)
    }

    /// The angular momenta of the wheels, kg m²/s.
    pub fn wheels(state: &SatelliteWithWheelsState) -> Vector3<f64> {
        vector![state.wheel_x_momentum.x, state.wheel_y_momentum.x, state.wheel_z_momentum.x]
    }

    /// The torques on the wheels that turn the satellite, about one axis, to where its axes are those of space: `u = Π × ω + 𝓘 (2b² q + 2b ω)`, with the
    /// vector part `q` of its quaternion and the bandwidth `b`.
    pub fn slew(&self, state: &SatelliteWithWheelsState) -> SatelliteWithWheelsControl {
        let attitude = state.attitude;
        // the quaternion and its negative are one attitude: the nearer one is the short way
        let axis = attitude.imag() * attitude.w.signum();
        let rate = self.angular_velocity(state);
        let slowing = axis * (2.0 * Self::BANDWIDTH.powi(2)) + rate * (2.0 * Self::BANDWIDTH);
        SatelliteWithWheelsControl {
            torque: state.attitude_momentum.cross(&rate) + slowing.component_mul(&self.inertia),
        }
    }
}

impl Example for SatelliteWithWheels {
    const ABOUT: &'static str = "a satellite that three reaction wheels turn to where it should look";
    const STEP: f64 = 0.1;
    const DURATION: f64 = 300.0;
    const CASIMIR_UNITS: &'static [&'static str] = &["kg² m⁴/s²"];

    /// A satellite at rest, turned by 150° about an axis that is none of its own, with wheels that spin: they keep what they have taken over before.
    fn example() -> (Self, SatelliteWithWheelsState) {
        let satellite = SatelliteWithWheels { inertia: vector![60.0, 80.0, 100.0], wheel_inertia: 0.05 };
        let turn = vector![1.0, 2.0, -1.5].normalize() * 150_f64.to_radians();
        (satellite, Self::at_rest(UnitQuaternion::new(turn), vector![0.6, -0.9, 0.4]))
    }

    fn control(&self, state: &SatelliteWithWheelsState, _: f64) -> SatelliteWithWheelsControl {
        self.slew(state)
    }

    fn scene(&self, by_state: Scene) -> Scene {
        let all = Matrix3::from_diagonal(&self.inertia.add_scalar(self.wheel_inertia));
        let scene = by_state.named(0, "satellite").solid(0, Solid::of_mass(&all, Self::MASS));
        // outside, so that they are seen
        let wheel = |axis: Vector3<f64>| {
            Solid::new(Shape::Disc { radius: 0.4, thickness: 0.1 }).along(axis).at(axis * 1.3)
        };
        let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
        (1..)
            .zip(axes)
            .fold(scene, |scene, (k, axis)| scene.mount(k, 0, Vector3::zeros(), axis).solid(k, wheel(axis)))
    }
}
