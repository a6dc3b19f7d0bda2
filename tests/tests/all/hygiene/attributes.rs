//! The user's attributes, derives and documentation stay.

use coadjoint::nalgebra::{SMatrix, SVector};
use coadjoint::prelude::*;
use serde::{Deserialize, Serialize};

/// A body.
///
/// With a second paragraph.
#[lie_poisson_system(group = SO3, advected(gamma: R3), potential = gamma.dot(&chi))]
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd, Serialize, Deserialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
#[must_use]
#[repr(C)]
pub struct Decorated {
    /// The inertia.
    #[inertia]
    #[serde(rename = "I")]
    pub inertia: f64,
    /// Where the mass is.
    #[serde(default)]
    pub chi: Vector3<f64>,
    /// One entry.
    #[allow(deprecated)]
    pub single_entry: SMatrix<f64, 1, 1>,
    /// Long.
    #[allow(deprecated)]
    pub long: SVector<f64, 7>,
}

#[test]
fn derives_and_their_attributes_work() {
    let body = Decorated { inertia: 2.0, ..Decorated::default() };
    let text = serde_json::to_string(&body).expect("to JSON");
    assert_eq!(
        text,
        r#"{"I":2.0,"chi":[0.0,0.0,0.0],"single-entry":[0.0],"long":[0.0,0.0,0.0,0.0,0.0,0.0,0.0]}"#
    );
    assert_eq!(serde_json::from_str::<Decorated>(&text).expect("from JSON"), body);

    let state = DecoratedState { attitude: super::rotation(), momentum: Vector3::x(), gamma: Vector3::z() };
    let text = serde_json::to_string(&state).expect("to JSON");
    // as an object of its fields, in their order
    let attitude = serde_json::to_string(&state.attitude).expect("to JSON");
    assert_eq!(text, format!(r#"{{"attitude":{attitude},"momentum":[1.0,0.0,0.0],"gamma":[0.0,0.0,1.0]}}"#));
    assert_eq!(serde_json::from_str::<DecoratedState>(&text).expect("from JSON"), state);
    let wrong = serde_json::from_str::<DecoratedState>("{}").expect_err("nothing is there");
    assert!(wrong.to_string().starts_with("missing field `attitude`"), "{wrong}");
    super::drive(&body, &state);
}

#[test]
fn documentation_reaches_the_quantities() {
    let docs: Vec<_> = Decorated::PARAMETERS.iter().map(|quantity| quantity.doc).collect();
    assert_eq!(docs, ["The inertia.", "Where the mass is.", "One entry.", "Long."]);
}
