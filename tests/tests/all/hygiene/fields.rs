//! Fields and advected parameters may be called what the generated code calls something else.

use super::{drive, rotation};
use coadjoint::nalgebra::Vector3;
use coadjoint::{State, System, vector};

/// Names of the generated functions' arguments and of values in them.
#[coadjoint::lie_poisson_system(
    group = SO3,
    advected(state: R3, r#type: R3, eta: R3),
    potential = step * state.dot(&unknown) + h * r#type.x.powi(2) + c2 * t0 * eta_x
        + x0 * r#type.y * eta.z + r#fn * u0.dot(&eta),
    derivatives,
)]
#[derive(Clone, Debug)]
pub struct Awkward {
    #[inertia]
    pub eta_squared: Vector3<f64>,
    pub step: f64,
    pub unknown: Vector3<f64>,
    pub h: f64,
    pub c2: f64,
    pub t0: f64,
    pub eta_x: f64,
    pub x0: f64,
    pub r#fn: f64,
    pub u0: Vector3<f64>,
}

#[test]
fn names_of_values_do_not_matter() {
    let system = Awkward {
        eta_squared: vector![1.0, 2.0, 3.0],
        step: 0.5,
        unknown: vector![0.1, 0.2, 0.3],
        h: 0.25,
        c2: 2.0,
        t0: 3.0,
        eta_x: 5.0,
        x0: 0.75,
        r#fn: 1.5,
        u0: vector![0.4, 0.5, 0.6],
    };
    let state = AwkwardState {
        attitude: rotation(),
        momentum: Vector3::zeros(),
        state: vector![0.7, 0.8, 0.9],
        r#type: vector![1.1, 1.2, 1.3],
        eta: vector![1.4, 1.5, 1.6],
    };
    drive(&system, &AwkwardState { momentum: vector![1.0, 2.0, 3.0], ..state });
    let expected = 0.5 * 0.5 + 0.25 * 1.21 + 30.0 + 0.75 * 1.2 * 1.6 + 1.5 * (0.56 + 0.75 + 0.96);
    assert!((system.energy(&state) - expected).abs() < 1e-13);
    assert!((system.potential(&state) - expected).abs() < 1e-13);
}

/// A raw identifier is a way to write a name, not part of it.
#[test]
fn raw_names_are_shown_without_their_mark() {
    let names: Vec<_> = AwkwardState::QUANTITIES.iter().map(|quantity| quantity.name).collect();
    assert_eq!(names, ["attitude", "momentum", "state", "type", "eta"]);
    let names: Vec<_> = Awkward::PARAMETERS.iter().map(|quantity| quantity.name).collect();
    assert_eq!(names, ["eta_squared", "step", "unknown", "h", "c2", "t0", "eta_x", "x0", "fn", "u0"]);
    let casimirs: Vec<_> = Awkward::CASIMIRS.to_vec();
    assert!(casimirs.contains(&"|type|²"), "{casimirs:?}");
}

/// More names, and scalars called like components of vectors; some of them not used by the potential.
#[coadjoint::lie_poisson_system(
    group = SO3,
    advected(parameters: R3, evaluation: R3, residual: R3),
    potential = parameters_x * parameters.x + chi_y * evaluation.dot(&energy) + iterate * residual.z
        + momentum_x * residual.x * attitude_w,
    derivatives,
)]
#[derive(Clone, Debug)]
#[allow(deprecated)]
pub struct Clashing {
    #[inertia]
    pub constants: Vector3<f64>,
    pub parameters_x: f64,
    pub chi: Vector3<f64>,
    pub chi_y: f64,
    pub energy: Vector3<f64>,
    pub iterate: f64,
    pub momentum_x: f64,
    pub attitude_w: f64,
    pub evaluation_x: f64,
    pub none: f64,
    pub right: f64,
    pub left: f64,
    pub margin: f64,
    pub constants_x: f64,
    pub residual_z: f64,
    pub eta_x: f64,
    pub h: f64,
    pub system: f64,
    pub casimirs: f64,
    pub pivots: f64,
}

#[test]
fn names_may_coincide_with_components() {
    let (mut random, mut parameters) = (crate::hygiene::Random::new(5), [0.0; 26]);
    parameters.iter_mut().for_each(|x| *x = random.between(0.5, 1.5));
    let system = Clashing::from_parameters(&parameters);
    let state = ClashingState {
        attitude: rotation(),
        momentum: Vector3::zeros(),
        parameters: random.vector(),
        evaluation: random.vector(),
        residual: random.vector(),
    };
    drive(&system, &ClashingState { momentum: vector![1.0, 2.0, 3.0], ..state });
    let expected = system.parameters_x * state.parameters.x
        + system.chi_y * state.evaluation.dot(&system.energy)
        + system.iterate * state.residual.z
        + system.momentum_x * state.residual.x * system.attitude_w;
    assert!((system.energy(&state) - expected).abs() < 1e-14);
}

/// Vectors name their components after their place.
#[test]
fn quantities_name_their_components() {
    let shown = |quantities: &[crate::renamed::system::Quantity], name: &str| {
        let quantity = quantities.iter().find(|quantity| quantity.name == name);
        quantity.map(|quantity| quantity.components.to_vec()).unwrap_or_default()
    };
    assert_eq!(shown(Awkward::PARAMETERS, "u0"), ["x", "y", "z"]);
    assert_eq!(shown(Awkward::PARAMETERS, "fn"), [""]);
    assert_eq!(shown(AwkwardState::QUANTITIES, "type"), ["x", "y", "z"]);
    assert_eq!(shown(AwkwardState::QUANTITIES, "attitude"), ["w", "x", "y", "z"]);
    assert_eq!(
        shown(coadjoint_support::systems::TiltedBody::PARAMETERS, "inertia"),
        ["xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz"]
    );
}
