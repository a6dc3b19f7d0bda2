//! Users may call their own things what they like.

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
