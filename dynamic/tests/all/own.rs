//! Groups, functions and constants of a user's own, in the text beside the struct.

use std::sync::Arc;

use coadjoint::erased;
use coadjoint_dynamic::Model;

/// The state after some steps.
fn after(model: &Model, parameters: &[f64], scheme: &str, state: &[f64], steps: u64) -> Vec<f64> {
    let system = Arc::new(model.system(parameters));
    let mut stepper = erased::Stepper::new(system, &scheme.parse().unwrap(), 0.01).unwrap();
    let mut state = state.to_vec();
    stepper.steps(&mut state, &[], steps).unwrap();
    state
}

#[test]
fn a_group_is_found_beside_the_struct() {
    let model = Model::from_text(
        "lie_group! {
             /// Maps of the plane that keep areas.
             pub Areas = matrices { h: [1, 0; 0, -1], e: [0, 1; 0, 0], f: [0, 0; 1, 0] }
         }

         /// A drop that spins and shears.
         ///
         /// It is tied by a spring.
         #[lie_poisson_system(group = Areas!, advected(mark: dual(R2)), potential = stiffness * mark.norm_squared())]
         struct Drop {
             #[inertia]
             inertia: Vector3<f64>,
             stiffness: f64,
         }",
    )
    .unwrap();
    assert_eq!((model.name(), model.about()), ("Drop", "A drop that spins and shears"));
    let start = [1.0, 0.0, 0.0, 1.0, 0.1, 0.5, -0.5, 1.0, 0.0];
    let state = after(&model, &[1.0, 2.0, 2.0, 1.0], "Exponential", &start, 100);
    assert!((state[0] * state[3] - state[1] * state[2] - 1.0).abs() < 1e-14, "{state:?}");
    assert!((state[0] - 1.0).abs() > 1e-3, "{state:?}");
}

#[test]
fn functions_and_constants_are_found_too() {
    let model = |text: &str| Model::from_text(text).unwrap_or_else(|error| panic!("{error}"));
    let own = model(
        "use coadjoint::prelude::*;

         mod air {
             pub const SCALE: f64 = 8_500.0 / 1e3;
             /// Density at a height.
             #[expression]
             pub fn density(height: f64) -> f64 {
                 (-height / SCALE).exp()
             }
         }
         const FACTOR: f64 = -(2.0 + 1.0);
         impl Nothing for Shell { const N: usize = 3; fn f() {} }

         #[derive(Clone)]
         #[coadjoint::lie_poisson_system(group = R1, potential = FACTOR * air::density(position.x) + std::f64::consts::TAU * position.x)]
         struct Shell {
             #[inertia]
             mass: f64,
         }",
    );
    let written = model(
        "#[lie_poisson_system(group = R1, potential = -3.0 * (-position.x / 8.5).exp() + tau * position.x)]
         struct Shell {
             #[inertia]
             mass: f64,
             tau: f64,
         }",
    );
    let start = [0.3, 0.7];
    let [a, b] = [(&own, &[2.0][..]), (&written, &[2.0, std::f64::consts::TAU])]
        .map(|(model, parameters)| after(model, parameters, "Exponential", &start, 50));
    assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-14), "{a:?} {b:?}");
}

#[test]
fn imports_are_followed() {
    let text = |imports: &str, potential: &str| {
        format!(
            "{imports}
             mod far {{ pub const NEAR: f64 = 0.5; pub mod away {{ pub const FAR: f64 = 3.0; }} }}
             #[lie_poisson_system(group = R1, potential = {potential} * position.x)]
             struct A {{ #[inertia] m: f64 }}"
        )
    };
    for (imports, potential) in [
        ("use std::f64::consts::PI;", "PI"),
        ("pub(crate) use std::f64::consts::{PI as P, E};", "(P + E)"),
        ("use std::f64::consts;", "consts::PI"),
        ("use std::f64::{self, consts::*};", "(TAU + f64::EPSILON)"),
        ("use far::NEAR;", "NEAR"),
        ("use crate::far::away::{self, FAR};", "(away::FAR + FAR)"),
    ] {
        let model = Model::from_text(&text(imports, potential));
        assert!(model.is_ok(), "{imports}: {}", model.unwrap_err());
    }
    assert!(Model::from_text(&text("use std::f64::consts::E;", "PI")).is_err());
    let affine = include_str!("../../../systems/src/affine_body.rs");
    let model = Model::from_text(affine).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(model.system(&[]).definition().constants, [std::f64::consts::PI]);
}

#[test]
fn entries_of_inertias_are_called_after_their_axes() {
    let labels = |group: &str, ty: &str| {
        let text = format!("#[lie_poisson_system(group = {group})] struct A {{ #[inertia] inertia: {ty} }}");
        Model::from_text(&text).expect("a description").description().parameters[0].components.join(" ")
    };
    let plane = "angular angular_linear_x angular_linear_y linear_x_angular linear_x linear_x_linear_y \
                 linear_y_angular linear_y_linear_x linear_y";
    assert_eq!(labels("SE2", "Matrix3<f64>"), plane);
    assert_eq!(labels("SE3", "Vector6<f64>"), "angular_x angular_y angular_z linear_x linear_y linear_z");
    assert_eq!(labels("SO3", "Matrix3<f64>"), "xx xy xz yx yy yz zx zy zz");
    assert_eq!(labels("R4", "Vector4<f64>"), "x y z w");
}
