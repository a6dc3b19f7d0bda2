//! The runtime may be found anywhere.

use renamed::prelude::{Vector3, vector};

/// By its new name.
#[renamed::lie_poisson_system(
    crate = renamed,
    group = SO3,
    advected(gamma: R3),
    potential = weight * gamma.z,
)]
pub struct Renamed {
    #[inertia]
    inertia: Vector3<f64>,
    weight: f64,
}

/// By an absolute path.
#[renamed::lie_poisson_system(crate = ::renamed, group = SO3, derivatives)]
pub struct Absolute {
    #[inertia]
    inertia: Vector3<f64>,
}

mod facade {
    pub(crate) use renamed as mechanics;
}

/// As another crate passes it on.
#[facade::mechanics::lie_poisson_system(
    crate = crate::hygiene::the_crate_under_another_name::facade::mechanics,
    group = SO3,
)]
pub struct PassedOn {
    #[inertia]
    inertia: Vector3<f64>,
}

/// From nearby.
#[facade::mechanics::lie_poisson_system(crate = self::facade::mechanics, group = SO3)]
pub struct Nearby {
    #[inertia]
    inertia: Vector3<f64>,
}

#[test]
fn works() {
    let (attitude, momentum) = (super::rotation(), vector![1.0, 2.0, 3.0]);
    let inertia = vector![1.0, 2.0, 3.0];
    super::drive(
        &Renamed { inertia, weight: 1.0 },
        &RenamedState { attitude, momentum, gamma: Vector3::x() },
    );
    super::drive(&Absolute { inertia }, &AbsoluteState { attitude, momentum });
    super::drive(&PassedOn { inertia }, &PassedOnState { attitude, momentum });
    super::drive(&Nearby { inertia }, &NearbyState { attitude, momentum });
}

/// The name by which it is found otherwise is not used.
#[test]
fn the_usual_name_is_not_used() {
    let expansion = coadjoint_codegen::expand(
        quote::quote! { crate = other::name, group = SO3, advected(a: R3), potential = weight * a.x },
        quote::quote! { struct Top { #[inertia] inertia: Matrix3<f64>, weight: f64 } },
    )
    .expect("an expansion");
    let output = expansion.into_tokens().to_string();
    assert!(output.contains("other :: name"), "{output}");
    assert!(!output.contains("coadjoint"), "{output}");
}
