//! Generated code lives in users' code: under any name for the crate, without a prelude, beside any names, under any lints.

// Most of what is defined here only has to compile, or to be in the way.
#![allow(dead_code, unreachable_pub, unused_macros)]

use coadjoint::prelude::*;
use coadjoint::{Discretized, System};
use coadjoint_tests::random::Random;

/// Takes one step with each retraction, so that generated code is compiled to the end, and checks it a little: the energy is almost
/// kept.
fn drive<S>(system: &S, start: &S::State)
where
    S: System<Scalar = f64> + Discretized<Exponential> + Discretized<Cayley>,
{
    let before = system.energy(start);
    let (mut a, mut b) = (start.clone(), start.clone());
    system.stepper::<Exponential>(1e-3).expect("a stepper").step(&mut a).expect("a step");
    system.stepper::<Cayley>(1e-3).expect("a stepper").step(&mut b).expect("a step");
    assert!((system.energy(&a) - before).abs() < 1e-6 * (1.0 + before.abs()));
    assert!((system.energy(&b) - before).abs() < 1e-6 * (1.0 + before.abs()));
    assert_ne!(&a, start, "nothing moves");
    // parameters and state survive being flattened
    let again = S::from_parameters(&system.to_parameters());
    assert_eq!(again.to_parameters(), system.to_parameters());
    assert_eq!(&S::State::from_components(&start.to_components()), start);
}

fn rotation() -> UnitQuaternion<f64> {
    Random::new(0).rotation()
}

mod the_crate_under_another_name {
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
}

#[no_implicit_prelude]
mod without_a_prelude {
    /// A top.
    #[::coadjoint::lie_poisson_system(
        group = SO3,
        advected(gamma: R3, field: R3),
        potential = {
            let tilt = gamma.dot(&chi);
            weight * tilt + tilt.sin() * field.cross(&gamma).norm_squared() + (response * field).x
        },
        derivatives,
    )]
    #[derive(::core::clone::Clone)]
    pub struct Bare {
        #[inertia]
        pub inertia: ::coadjoint::nalgebra::Matrix3<f64>,
        pub weight: f64,
        pub chi: ::coadjoint::nalgebra::Vector3<f64>,
        pub response: ::coadjoint::nalgebra::Matrix3<f64>,
    }

    /// A body.
    #[::coadjoint::lie_poisson_system(group = SO3)]
    pub struct BareBody {
        #[inertia]
        pub inertia: f64,
    }
}

#[test]
fn no_prelude_is_needed() {
    let momentum = vector![1.0, 2.0, 3.0];
    let bare = without_a_prelude::Bare {
        inertia: Matrix3::from_diagonal(&vector![1.0, 2.0, 3.0]),
        weight: 1.0,
        chi: Vector3::x(),
        response: Matrix3::identity(),
    };
    drive(
        &bare,
        &without_a_prelude::BareState {
            attitude: rotation(),
            momentum,
            gamma: Vector3::z(),
            field: Vector3::y(),
        },
    );
    drive(
        &without_a_prelude::BareBody { inertia: 2.0 },
        &without_a_prelude::BareBodyState { attitude: rotation(), momentum },
    );
}

/// Users may call their own things what they like.
mod shadowed {
    use super::{drive, rotation};
    use coadjoint::nalgebra::{Matrix3 as M3, Vector3 as V3};

    mod core {}
    mod std {}
    mod nalgebra {}
    mod serde {}
    mod __private {}

    pub struct Result;
    pub struct Option;
    pub struct Some;
    pub struct None;
    pub struct Ok;
    pub struct Err;
    pub struct Vec;
    pub struct Box;
    pub struct String;
    pub struct T;
    pub struct Self_;
    pub struct Step;
    pub struct Iterate;
    pub struct Kernel;
    pub struct Evaluation;
    pub struct State;
    pub struct System;
    pub struct Stepper;
    pub struct Stored;
    pub struct Quantity;
    pub struct Discretized;
    pub struct Components;
    pub struct ParameterError;
    pub struct Cayley;
    pub struct Exponential;
    pub struct Vector3;
    pub struct Matrix3;
    pub struct UnitQuaternion;
    pub struct Scalar;
    pub trait Clone {}
    pub trait Copy {}
    pub trait Debug {}
    pub trait PartialEq {}
    pub trait From {}
    pub trait Into {}
    pub trait Iterator {}
    pub trait Add {}
    pub trait Mul {}
    pub type SO3 = u8;
    pub type R3 = u8;
    #[allow(non_camel_case_types)]
    pub type f64 = u8;
    #[allow(non_camel_case_types)]
    pub type f32 = u8;
    // (not `usize` and `str`: serde's derive macros trip over them)

    pub fn energy() {}
    pub fn casimirs() {}
    pub fn spatial_momentum() {}
    pub fn pivots() {}
    pub fn potential() {}

    macro_rules! stringify {
        ($($x:tt)*) => {
            compile_error!("a user's macro was called")
        };
    }
    macro_rules! assert {
        ($($x:tt)*) => {
            compile_error!("a user's macro was called")
        };
    }

    #[coadjoint::lie_poisson_system(
        group = SO3,
        advected(gamma: R3),
        potential = weight * gamma.dot(&chi) + gamma.norm_squared().sqrt(),
        derivatives,
    )]
    pub struct Top {
        #[inertia]
        pub inertia: M3ofDoubles::Matrix3<::core::primitive::f64>,
        pub weight: ::core::primitive::f64,
        pub chi: M3ofDoubles::Vector3<::core::primitive::f64>,
    }

    #[allow(non_snake_case)]
    mod M3ofDoubles {
        pub(super) use coadjoint::nalgebra::{Matrix3, Vector3};
    }

    #[test]
    fn names_of_the_user_do_not_matter() {
        let top = Top { inertia: M3::from_diagonal(&V3::new(1.0, 2.0, 3.0)), weight: 1.0, chi: V3::x() };
        let state = TopState { attitude: rotation(), momentum: V3::new(1.0, 2.0, 3.0), gamma: V3::z() };
        drive(&top, &state);
    }
}

/// A system may be called what the generated code calls something else, and come out of a user's own macro.
mod called {
    macro_rules! system {
        ($module:ident, $name:ident, $state:ident $(, $derivatives:ident)?) => {
            mod $module {
                use coadjoint::nalgebra::Vector3;

                #[coadjoint::lie_poisson_system(
                                                                                group = SO3,
                                                                                advected(gamma: R3),
                                                                                potential = weight * gamma.x
                    $(, $derivatives)?
                )]
                #[derive(Clone, Debug)]
                pub struct $name {
                    #[inertia]
                    pub inertia: Vector3<f64>,
                    pub weight: f64,
                }

                #[test]
                fn works() {
                    let system = $name { inertia: Vector3::new(1.0, 2.0, 3.0), weight: 1.0 };
                    let state = $state {
                        attitude: crate::hygiene::rotation(),
                        momentum: Vector3::new(1.0, 2.0, 3.0),
                        gamma: Vector3::z(),
                    };
                    crate::hygiene::drive(&system, &state);
                    assert_eq!(<$name as coadjoint::System>::NAME, stringify!($name).trim_start_matches("r#"));
                }
            }
        };
    }
    system!(step, Step, StepState, derivatives);
    system!(iterate, Iterate, IterateState);
    system!(kernel, Kernel, KernelState, derivatives);
    system!(scalar, Scalar, ScalarState, derivatives);
    system!(evaluation, Evaluation, EvaluationState);
    system!(state, State, StateState);
    system!(the_system, System, SystemState, derivatives);
    system!(discretized, Discretized, DiscretizedState);
    system!(t, T, TState, derivatives);
    system!(point, Point, PointState, derivatives);
    system!(linearized, Linearized, LinearizedState, derivatives);
    system!(result, Result, ResultState);
    system!(vector, Vec, VecState);
    system!(cayley, Cayley, CayleyState);
    system!(raw, r#Self_, Self_State);
}

/// Fields and advected parameters may be called what the generated code calls something else.
mod fields {
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
            shown(coadjoint_tests::systems::TiltedBody::PARAMETERS, "inertia"),
            ["xx", "xy", "xz", "yx", "yy", "yz", "zx", "zy", "zz"]
        );
    }
}

/// Users deny lints, and what we write for them must pass. (Clippy's only speak when clippy runs.)
#[deny(
    missing_docs,
    missing_debug_implementations,
    unused,
    nonstandard_style,
    rust_2018_idioms,
    let_underscore,
    keyword_idents,
    warnings,
    elided_lifetimes_in_paths,
    explicit_outlives_requirements,
    single_use_lifetimes,
    trivial_casts,
    trivial_numeric_casts,
    unnameable_types,
    unreachable_pub,
    unsafe_code,
    unused_import_braces,
    unused_lifetimes,
    unused_qualifications,
    unused_results,
    variant_size_differences,
    clippy::all,
    clippy::pedantic,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::indexing_slicing,
    clippy::float_arithmetic,
    clippy::missing_docs_in_private_items
)]
#[allow(dead_code)]
pub mod strict {
    use coadjoint::prelude::*;

    /// A top.
    #[lie_poisson_system(
        group = SO3,
        advected(gamma: R3, field: R3),
        potential = {
            let tilt = gamma.dot(&chi);
            weight * tilt + (strength * field).dot(&gamma).powi(3) * LENGTH + std::f64::consts::PI
        },
    )]
    #[derive(Clone, Debug, PartialEq)]
    pub struct Top {
        /// Tensor of inertia.
        #[inertia]
        pub inertia: Matrix3<f64>,
        /// Mass times gravity.
        pub weight: f64,
        /// To the centre of mass.
        pub chi: Vector3<f64>,
        /// Of the field.
        pub strength: f64,
        /// Not used at all.
        #[allow(deprecated)]
        pub unused: f64,
    }

    /// Of the string.
    const LENGTH: f64 = 1.5;

    /// A body.
    #[lie_poisson_system(group = SO3)]
    #[derive(Clone, Debug, PartialEq)]
    pub struct Body {
        /// Principal moments of inertia.
        #[inertia]
        pub inertia: Vector3<f64>,
    }

    /// Seen in the crate.
    #[lie_poisson_system(group = SO3, advected(gamma: R3), potential = gamma.x)]
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) struct Inner {
        /// Moment of inertia.
        #[inertia]
        pub(crate) inertia: f64,
    }

    /// Seen here.
    #[lie_poisson_system(group = SO3, advected(gamma: R3), potential = gamma.x, derivatives)]
    #[derive(Clone, Debug, PartialEq)]
    struct Private {
        /// Moment of inertia.
        #[inertia]
        inertia: f64,
    }
}

/// Systems are as visible as their authors say, and can be anywhere items can.
mod visibilities {
    use coadjoint::prelude::*;

    #[lie_poisson_system(group = SO3)]
    pub struct Public {
        #[inertia]
        pub inertia: f64,
    }

    #[lie_poisson_system(group = SO3)]
    pub(crate) struct Crate {
        #[inertia]
        pub(crate) inertia: f64,
    }

    #[lie_poisson_system(group = SO3, advected(gamma: R3), potential = gamma.x, derivatives)]
    struct Private {
        #[inertia]
        inertia: f64,
    }

    mod inner {
        use coadjoint::prelude::*;

        #[lie_poisson_system(group = SO3, advected(gamma: R3), potential = gamma.x, derivatives)]
        pub(super) struct Super {
            #[inertia]
            pub(super) inertia: f64,
        }

        #[lie_poisson_system(group = SO3)]
        pub(in crate::hygiene::visibilities) struct Within {
            #[inertia]
            pub(in crate::hygiene::visibilities) inertia: f64,
        }
    }

    #[test]
    fn systems_of_every_visibility_work() {
        let (attitude, momentum, gamma) = (super::rotation(), vector![1.0, 2.0, 3.0], Vector3::z());
        super::drive(&Public { inertia: 1.0 }, &PublicState { attitude, momentum });
        super::drive(&Crate { inertia: 1.0 }, &CrateState { attitude, momentum });
        super::drive(&Private { inertia: 1.0 }, &PrivateState { attitude, momentum, gamma });
        super::drive(&inner::Super { inertia: 1.0 }, &inner::SuperState { attitude, momentum, gamma });
        super::drive(&inner::Within { inertia: 1.0 }, &inner::WithinState { attitude, momentum });
    }

    #[test]
    #[deny(warnings)]
    fn systems_live_in_functions() {
        const LOCAL: f64 = 0.5;

        #[lie_poisson_system(group = SO3, advected(gamma: R3), potential = LOCAL * gamma.x, derivatives)]
        #[derive(Debug)]
        struct Inside {
            #[inertia]
            inertia: Vector3<f64>,
        }

        let system = Inside { inertia: vector![1.0, 2.0, 3.0] };
        let state = InsideState {
            attitude: super::rotation(),
            momentum: Vector3::zeros(),
            gamma: vector![2.0, 0.0, 0.0],
        };
        assert_eq!(system.energy(&state), 1.0);
        super::drive(&system, &InsideState { momentum: vector![1.0, 2.0, 3.0], ..state });
        assert_eq!(format!("{system:?}"), "Inside { inertia: [[1.0, 2.0, 3.0]] }");
    }
}

/// The prelude goes together with those of other crates: names that are theirs are not ours.
mod preludes {
    use coadjoint::prelude::*;

    use theirs::*;

    /// What bevy, log, rand, serde and others call things.
    mod theirs {
        #[derive(Debug, PartialEq)]
        pub struct State(pub u8);
        pub struct Control;
        pub struct Distribution;
        pub struct Every;
        pub struct Family;
        pub struct Record;
        pub struct Run;
        pub struct Tick;
        pub struct Unit;
        pub trait Deserialize {}
        pub trait Observer {}
        pub trait Serialize {}
        pub trait System {
            fn name(&self) -> &'static str;
        }
    }

    #[lie_poisson_system(group = SO3)]
    struct Body {
        #[inertia]
        inertia: Vector3<f64>,
    }

    impl Deserialize for (Control, Distribution, Every, Family) {}
    impl Serialize for (Record, Run, Tick, Unit) {}
    impl Observer for Body {}

    impl System for Body {
        fn name(&self) -> &'static str {
            "theirs"
        }
    }

    #[test]
    fn common_names_are_left_to_others() {
        let body = Body { inertia: vector![1.0, 2.0, 4.0] };
        let mut state = BodyState { attitude: UnitQuaternion::identity(), momentum: vector![1.0, 0.0, 2.0] };
        assert_eq!((body.name(), State(1)), ("theirs", State(1)));
        // of ours there are the methods
        assert_eq!(body.energy(&state), 1.0);
        assert_eq!(state.to_components()[4..], [1.0, 0.0, 2.0]);
        let mut stepper = body.stepper::<Cayley>(0.1).expect("a stepper");
        stepper.step_with(&mut state, &NoControl::default()).expect("a step");
    }
}

/// The user's attributes, derives and documentation stay.
mod attributes {
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

        let state =
            DecoratedState { attitude: super::rotation(), momentum: Vector3::x(), gamma: Vector3::z() };
        let text = serde_json::to_string(&state).expect("to JSON");
        // as an object of its fields, in their order
        let attitude = serde_json::to_string(&state.attitude).expect("to JSON");
        assert_eq!(
            text,
            format!(r#"{{"attitude":{attitude},"momentum":[1.0,0.0,0.0],"gamma":[0.0,0.0,1.0]}}"#)
        );
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
}

/// The potential is read twice: symbolically, for the mathematics, and by rustc, as a method. Both must mean the same.
mod potentials {
    use coadjoint::System;
    use coadjoint::nalgebra::{Matrix2, Matrix3, RowVector3, Vector2, Vector3};
    use coadjoint::prelude::{UnitQuaternion, matrix, vector};

    use super::Random;

    const GRAVITY: f64 = 9.81;

    struct Planet;

    impl Planet {
        const RADIUS: f64 = 6.4;
    }

    mod units {
        pub(super) const LENGTH: f64 = 0.3;

        pub(super) mod other {
            pub(in super::super) const LENGTH: f64 = 0.7;
        }
    }

    macro_rules! potentials {
        (
            [$a:ident, $b:ident, $chi:ident, $m:ident, $p:ident, $q:ident, $r:ident, $gamma:ident, $beta:ident]
            $($name:ident: $potential:expr;)*
        ) => {
            $(mod $name {
                use super::*;

                #[coadjoint::lie_poisson_system(
                    group = SO3,
                    advected($gamma: R3, $beta: R3),
                    potential = $potential,
                )]
                #[allow(deprecated)]
                pub(super) struct Tested {
                    #[inertia]
                    inertia: f64,
                    $a: f64,
                    $b: f64,
                    $chi: Vector3<f64>,
                    $m: Matrix3<f64>,
                    $p: Vector2<f64>,
                    $q: Matrix2<f64>,
                    $r: RowVector3<f64>,
                }

                #[test]
                fn means_the_same_to_both_readers() {
                    let mut random = Random::new(31);
                    for _ in 0..200 {
                        let system = Tested {
                            inertia: random.between(0.5, 2.0),
                            $a: random.between(0.1, 2.0),
                            $b: random.between(0.1, 2.0),
                            $chi: random.vector(),
                            $m: random.matrix(),
                            $p: random.vector().xy(),
                            $q: random.matrix().fixed_view::<2, 2>(0, 0).into_owned(),
                            $r: random.vector().transpose(),
                        };
                        let state = TestedState {
                            attitude: UnitQuaternion::identity(),
                            momentum: random.vector(),
                            $gamma: random.vector(),
                            $beta: random.vector(),
                        };
                        let potential = system.potential(&state);
                        let kinetic = state.momentum.norm_squared() / (2.0 * system.inertia);
                        let defect = (system.energy(&state) - kinetic - potential).abs();
                        assert!(
                            defect <= 1e-14 * (1.0 + kinetic + potential.abs()),
                            "off by {defect:e}: {potential:e}"
                        );
                    }
                }
            })*
        };
    }

    // names of a potential must come from where the potential is written, as with any macro
    potentials! {
        [a, b, chi, m, p, q, r, gamma, beta]
        product: a * gamma.dot(&chi);
        whole: 2.0 * gamma.x;
        constant: GRAVITY * gamma.z;
        constant_of_a_type: Planet::RADIUS * gamma.z + Planet::RADIUS;
        constant_of_std: (gamma.x * std::f64::consts::PI).sin() + core::f64::consts::E;
        constants_of_one_name: units::LENGTH * gamma.z + units::other::LENGTH * beta.z;
        components: gamma.x * beta.y - gamma[1] * beta[0] + m[(0, 2)] * m.m31 + p.x * p[1] + q[(1, 0)];
        columns_first: m[1] * gamma.x + m[3] * gamma.y;
        triple: a * chi.dot(&gamma.cross(&beta));
        cross_of_references: (&gamma).cross(&beta).norm_squared();
        norms: gamma.norm() + beta.norm_squared() + (gamma - beta).magnitude() + m.norm_squared();
        unit: chi.dot(&gamma.normalize());
        matrices: gamma.dot(&(m * beta)) + (m * m.transpose()).trace() + m.determinant() * a;
        quadratic: 0.5 * (m.transpose() * gamma).dot(&(m * gamma));
        transposed: m.tr_mul(&gamma).dot(&beta) + (gamma.transpose() * m * beta)[0];
        row: (r * gamma)[(0, 0)] + r.x;
        small: (q * p).dot(&p) + q.determinant() * gamma.x;
        built: Vector3::new(a, b, 1.0).dot(&gamma) + vector![a, 2.0 * b, gamma.x].dot(&beta);
        built_matrix: (matrix![a, 1.0, 0.0; 0.0, b, 1.0; gamma.x, 0.0, a] * beta).dot(&gamma);
        unit_vectors: Vector3::x().dot(&gamma) + Vector3::z().cross(&beta).dot(&chi)
            + (Matrix3::identity() * gamma).sum();
        diagonal: (Matrix3::from_diagonal(&chi) * gamma).dot(&beta) + m.diagonal().dot(&chi);
        outer: (gamma * beta.transpose() * chi).dot(&chi);
        by_component: gamma.component_mul(&beta).sum() + chi.component_mul(&gamma).dot(&chi);
        scaled: gamma.scale(a).dot(&chi.unscale(b)) + (gamma * a / b).x + (-beta).y;
        powers: gamma.x.powi(3) + a.powi(-2) * gamma.y.powi(2) + a.powf(1.5) * b.powf(gamma.z);
        roots: (1.0 + gamma.norm_squared()).sqrt() + a.sqrt().recip() * gamma.x;
        circular: (a * gamma.x).sin() * (b * gamma.y).cos() + (gamma.z * 0.5).tan();
        inverse_circular: (gamma.x * 0.9).asin() + (gamma.y * 0.9).acos() + (a * gamma.z).atan()
            + gamma.x.atan2(a + gamma.y.powi(2));
        hyperbolic: gamma.x.sinh() + gamma.y.cosh() + (a * gamma.z).tanh();
        exponential: (-a * gamma.norm_squared()).exp() + (1.0 + gamma.x.powi(2)).ln();
        both_at_once: {
            let (s, c) = (a * gamma.x).sin_cos();
            s * beta.x + c * beta.y
        };
        block: {
            let tilt = gamma.dot(&chi);
            let lifted = tilt + 1.0;
            let tilt = lifted * lifted;
            let scale: f64 = 0.5;
            tilt * { let inner = scale * tilt; inner + a }
        };
        functions: f64::sin(gamma.x) + Vector3::dot(&gamma, &chi) + f64::hypot(a, gamma.x);
        fused: a.mul_add(gamma.x, b) + gamma.x.hypot(beta.y);
        integers: f64::from(3) * gamma.x + gamma.y.powi(2 + 1);
        literals: 1e-3 * gamma.x + 0.1 * gamma.y + 1_000.5 * gamma.z / 3.0 - 2f64 * beta.x;
        signs: -(gamma.x - -beta.x) - (-(a - b)) * -gamma.y;
        references: { let g = &gamma; let c = &chi; (*g).dot(c) + (*g - *c).norm_squared() };
        nothing_advected: a * b + chi.norm_squared();
        quotient: gamma.x / (1.0 + beta.norm_squared()) / a - chi.z / b;
        nested: ((a * gamma.x).sin() + (b * beta.y).cos()).exp().sqrt().ln() * (1.0 + gamma.x.cos().powi(2)).ln();
    }
}

/// The output is a function of the input, byte for byte: whatever was expanded before, on whatever thread, and however it is laid out.
mod determinism {
    use coadjoint_codegen::expand;
    use proc_macro2::TokenStream;

    const ATTRIBUTE: &str = "group = SO3, advected(gamma: R3, field: R3), \
                             potential = weight * gamma.dot(&chi) + (response * field).norm_squared().sin()";
    const ITEM: &str = "struct Top { #[inertia] inertia: Matrix3<f64>, weight: f64, chi: Vector3<f64>, \
                        response: Matrix3<f64> }";

    fn tokens(text: &str) -> TokenStream {
        text.parse().expect("tokens")
    }

    /// The code and its intermediate representations, as text.
    fn output(attribute: &str, item: &str) -> String {
        let expansion = expand(tokens(attribute), tokens(item)).expect("an expansion");
        let kernels: String = expansion.steps.iter().map(|step| step.program.module.to_string()).collect();
        kernels + &expansion.into_tokens().to_string()
    }

    #[test]
    fn the_same_input_gives_the_same_output() {
        let first = output(ATTRIBUTE, ITEM);
        assert!(first.len() > 10_000, "{first}");
        assert!(first == output(ATTRIBUTE, ITEM), "a second expansion differs");
        output("group = SO3", "struct Other { #[inertia] gamma: Vector3<f32> }");
        assert!(first == output(ATTRIBUTE, ITEM), "an expansion in between leaves traces");
    }

    #[test]
    fn threads_do_not_matter() {
        let first = output(ATTRIBUTE, ITEM);
        let threads: Vec<_> = (0..3).map(|_| std::thread::spawn(|| output(ATTRIBUTE, ITEM))).collect();
        for thread in threads {
            assert!(first == thread.join().expect("no panic"), "another thread's expansion differs");
        }
    }

    #[test]
    fn layout_and_comments_do_not_matter() {
        let spread = |text: &str| text.replace(", ", " /* a comment */ ,\n\n    ");
        assert!(output(ATTRIBUTE, ITEM) == output(&spread(ATTRIBUTE), &spread(ITEM)));
    }

    /// What the macro emits is what `expand` says.
    #[test]
    fn the_macro_emits_the_expansion() {
        let expansion = expand(tokens(ATTRIBUTE), tokens(ITEM)).expect("an expansion");
        let emitted = coadjoint_codegen::lie_poisson_system(tokens(ATTRIBUTE), tokens(ITEM));
        assert_eq!(emitted.to_string(), expansion.into_tokens().to_string());
    }
}

/// Parts of perturbations have constants of their own, whatever the fields are called.
mod parts {
    use coadjoint::derivative::{Block, IndexRange, WrtParameters};
    use coadjoint::prelude::*;

    #[lie_poisson_system(
        group = SO3,
        advected(point: R3),
        potential = (through + 2.0 * Through + columns) * point.x,
        derivatives,
    )]
    #[allow(non_snake_case)]
    struct Alike {
        #[inertia]
        inertia: Vector3<f64>,
        through: f64,
        Through: f64,
        columns: f64,
    }

    #[test]
    fn names_that_differ_by_their_cases_do() {
        const LOWER: IndexRange<3, 1> = AlikeIndices::THROUGH;
        const UPPER: IndexRange<4, 1> = AlikeIndices::THROUGH_;
        let alike = Alike { inertia: vector![1.0, 2.0, 3.0], through: 0.3, Through: 0.5, columns: 0.7 };
        let mut state =
            AlikeState { attitude: super::rotation(), momentum: vector![1.0, 2.0, 3.0], point: Vector3::z() };
        let mut stepper = alike.stepper::<Cayley>(0.1).expect("valid");
        let step = stepper.step_with_jacobian(&mut state, &NoControl::default(), WrtParameters);
        let by = step.expect("solvable").jacobian;
        let [lower, upper, columns] = [
            by.block(AlikeIndices::MOMENTUM, LOWER),
            by.block(AlikeIndices::MOMENTUM, UPPER),
            by.block(AlikeIndices::MOMENTUM, AlikeIndices::COLUMNS),
        ];
        assert!(lower.norm() > 1e-2);
        assert!((upper - 2.0 * lower).norm() < 1e-14 && (columns - lower).norm() < 1e-14, "{by}");
    }
}
