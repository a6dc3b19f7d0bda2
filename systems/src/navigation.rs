//! Inertial navigation.

use coadjoint::nalgebra::{SMatrix, SVector};
use coadjoint::prelude::*;
use coadjoint_app::Example;
use coadjoint_app::scene::{Arrow, Body, Scene};
use coadjoint_app::shape::{Shape, Solid};
use serde::{Deserialize, Serialize};

/// A vehicle that finds its way by a gyroscope and an accelerometer, and the paths that are likeliest if their readings are not exact.
///
/// Its attitude `R`, velocity `v` and position `p` are an element of `SE₂(3)`. What turns and moves it is kinematics: `Ṙ = R ω^`, `v̇ = R f + g`,
/// `ṗ = v`, with the angular velocity `ω` and the specific force `f` in its own axes and the gravity `g`. The sensors, controls here, read `ω_m` and `f_m`,
/// held over each step, with white noise of the densities `q_ω` and `q_f`. Of all paths between what is known now and what is known later the likeliest has the least
/// `∫ |ω − ω_m|²/2q_ω + |f − f_m|²/2q_f dt`. Such paths are Hamiltonian (L. S. Pontryagin), with a costate `λ` for each of `R`, `v` and `p`, in the axes of
/// the vehicle:
///
/// Hamiltonian: `H = λ_R·ω_m + λ_v·(f_m + Rᵀg) + λ_p·Rᵀv + ½ q_ω |λ_R|² + ½ q_f |λ_v|²`.
///
/// Motion: that of the vehicle with `ω = ω_m + q_ω λ_R`, `f = f_m + q_f λ_v`; in space, `R λ_p` is constant and `R λ_v` changes by `−R λ_p`. Without a costate
/// this is dead reckoning: the path that the sensors tell. A later fix says what the costate is.
///
/// Invariants: `H` as long as the readings are the same, and `R λ_p`.
///
/// The state is that of A. Barrau and S. Bonnabel, *The invariant extended Kalman filter as a stable observer* (2017); paths of least noise are those of
/// R. E. Mortensen, *Maximum-likelihood recursive nonlinear filtering* (1968).
#[lie_poisson_system(
    group = SE2(3),
    control(gyroscope: R3, accelerometer: R3),
    hamiltonian = {
        let attitude = element.fixed_view::<3, 3>(0, 0);
        let velocity = element.fixed_view::<3, 1>(0, 3);
        let of_attitude = momentum.fixed_rows::<3>(0);
        let of_velocity = momentum.fixed_rows::<3>(3);
        let of_position = momentum.fixed_rows::<3>(6);
        let dead_reckoning = of_attitude.dot(&gyroscope)
            + of_velocity.dot(&(accelerometer + attitude.tr_mul(&gravity)))
            + of_position.dot(&attitude.tr_mul(&velocity));
        dead_reckoning + gyroscope_noise / 2.0 * of_attitude.norm_squared()
            + accelerometer_noise / 2.0 * of_velocity.norm_squared()
    },
    retractions(Cayley),
    units(
        element = "1, 1, 1, m/s, m",
        momentum = "1, 1, 1, s/m, s/m, s/m, 1/m, 1/m, 1/m",
        gyroscope = "rad/s",
        accelerometer = "m/s²",
    ),
)]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Navigation {
    /// Gravitational acceleration in space, m/s².
    #[unit("m/s²")]
    pub gravity: Vector3<f64>,
    /// Density of the gyroscope's noise, rad²/s.
    #[unit("rad²/s")]
    pub gyroscope_noise: f64,
    /// Density of the accelerometer's noise, m²/s³.
    #[unit("m²/s³")]
    pub accelerometer_noise: f64,
}

impl Navigation {
    /// What the sensors of a car read in a bend of 200 m at 20 m/s.
    pub fn bend() -> NavigationControl {
        NavigationControl { gyroscope: vector![0.0, 0.0, 0.1], accelerometer: vector![0.0, 2.0, 9.81] }
    }

    /// The state of this attitude, velocity, m/s, and position, m, where nothing is known better: dead reckoning.
    pub fn start(
        attitude: UnitQuaternion<f64>,
        velocity: Vector3<f64>,
        position: Vector3<f64>,
    ) -> NavigationState {
        let mut element = SMatrix::<f64, 5, 5>::identity();
        element.fixed_view_mut::<3, 3>(0, 0).copy_from(attitude.to_rotation_matrix().matrix());
        element.fixed_view_mut::<3, 1>(0, 3).copy_from(&velocity);
        element.fixed_view_mut::<3, 1>(0, 4).copy_from(&position);
        NavigationState { element, momentum: SVector::zeros() }
    }

    /// The attitude, as a matrix.
    pub fn attitude(state: &NavigationState) -> Matrix3<f64> {
        state.element.fixed_view::<3, 3>(0, 0).into()
    }

    /// The velocity in space, m/s.
    pub fn velocity_in_space(state: &NavigationState) -> Vector3<f64> {
        state.element.fixed_view::<3, 1>(0, 3).into()
    }

    /// The position, m.
    pub fn position(state: &NavigationState) -> Vector3<f64> {
        state.element.fixed_view::<3, 1>(0, 4).into()
    }
}

impl Example for Navigation {
    const ABOUT: &'static str =
        "a vehicle that finds its way by gyroscope and accelerometer, and by a later fix";
    const STEP: f64 = 0.05;
    const DURATION: f64 = 60.0;
    /// The vehicle turns slowly.
    const CERTIFIED_STEP: Option<f64> = Some(0.1);
    const ENERGY_UNIT: &'static str = "1/s";

    /// A car with the sensors of a telephone, once around a bend of 200 m: a fix after a minute says that it is by 40 m, −30 m and 15 m elsewhere than
    /// dead reckoning says. The costate is that of the likeliest path there, with any velocity and attitude at its end, found by shooting.
    fn example() -> (Self, NavigationState) {
        let navigation = Navigation {
            gravity: vector![0.0, 0.0, -9.81],
            gyroscope_noise: 3e-6,
            accelerometer_noise: 1e-4,
        };
        let start = Self::start(UnitQuaternion::identity(), vector![20.0, 0.0, 0.0], Vector3::zeros());
        let momentum = [
            327.189_357_188,
            189.388_918_394,
            22.746_393_720_3,
            -0.428_688_131_187,
            -1.130_231_485_51,
            15.576_777_440_6,
            -0.007_144_802_189_44,
            -0.018_837_191_432_6,
            0.259_612_957_343,
        ];
        (navigation, NavigationState { momentum: momentum.into(), ..start })
    }

    fn control(&self, _: &NavigationState, _: f64) -> NavigationControl {
        Self::bend()
    }

    fn scene(&self, _: Scene) -> Scene {
        let solid = Solid::new(Shape::Box { size: [4.0, 1.8, 1.4] });
        let vehicle = Body::turning("element_rotation").and_moving("element_p").named("vehicle").with(solid);
        Scene::default().body(vehicle).arrow(Arrow::quantity("element_v").named("velocity").symbol("v"))
    }
}
