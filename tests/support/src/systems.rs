//! Systems to test on: inertias of every shape, up to three advected vectors, linear and nonlinear potentials.

pub use coadjoint_systems::free_rigid_body::{FreeRigidBody, FreeRigidBodyState};
pub use coadjoint_systems::heavy_top::{HeavyTop, HeavyTopState};

use core::fmt::Debug;

use coadjoint::prelude::*;
use coadjoint::{Discretized, System};

use crate::random::Random;

/// A system with random instances, and with its potential's gradient worked out by hand.
pub trait Sample:
    System<Scalar = f64> + Discretized<Exponential> + Discretized<Cayley> + Clone + Debug + 'static
{
    /// A system and a state of the size of 1.
    fn sample(random: &mut Random) -> (Self, Self::State);

    /// The inertia as a matrix.
    fn inertia_matrix(&self) -> Matrix3<f64>;

    /// The potential energy, in the advected vectors.
    fn potential_energy(&self, advected: &[Vector3<f64>]) -> f64;

    /// Its gradient by each advected vector.
    fn potential_gradient(&self, advected: &[Vector3<f64>]) -> Vec<Vector3<f64>>;
}

/// A rigid body whose axes are not the coordinate axes.
#[lie_poisson_system(group = SO3)]
#[derive(Clone, Debug, PartialEq)]
pub struct TiltedBody {
    /// Tensor of inertia about the centre of mass.
    #[inertia]
    pub inertia: Matrix3<f64>,
}

/// A ball with its mass off the centre.
#[lie_poisson_system(
    group = SO3,
    advected(vertical: R3),
    potential = weight * offset * vertical.z,
)]
#[derive(Clone, Debug, PartialEq)]
pub struct Ball {
    /// The moment of inertia about every axis.
    #[inertia]
    pub inertia: f64,
    /// Mass times gravity.
    pub weight: f64,
    /// From the centre to the centre of mass.
    pub offset: f64,
}

/// A top held by a spring that hardens and drawn into a smooth hollow.
#[lie_poisson_system(
    group = SO3,
    advected(gamma: R3),
    potential = {
        let tilt = gamma.dot(&axis);
        let away = gamma - rest;
        stiffness * tilt.powi(4) / 4.0 - depth * (-away.norm_squared()).exp()
    },
)]
#[derive(Clone, Debug, PartialEq)]
pub struct SprungTop {
    /// Tensor of inertia about the fixed point.
    #[inertia]
    pub inertia: Matrix3<f64>,
    /// Of the spring.
    pub stiffness: f64,
    /// Along which the spring acts.
    pub axis: Vector3<f64>,
    /// Of the hollow.
    pub depth: f64,
    /// Where the hollow is.
    pub rest: Vector3<f64>,
}

/// A heavy magnet with induced magnetization, in fields of two directions that also twist it.
#[lie_poisson_system(
    group = SO3,
    advected(gamma: R3, field: R3),
    potential = weight * gamma.dot(&chi) - field.dot(&moment) - 0.5 * field.dot(&(response * field))
        + twist * axis.dot(&gamma.cross(&field)).sin(),
)]
#[derive(Clone, Debug, PartialEq)]
pub struct Compass {
    /// Tensor of inertia about the fixed point.
    #[inertia]
    pub inertia: Matrix3<f64>,
    /// Mass times gravity.
    pub weight: f64,
    /// From the fixed point to the centre of mass.
    pub chi: Vector3<f64>,
    /// The permanent magnetic moment.
    pub moment: Vector3<f64>,
    /// Induced moment for each component of the field; need not be symmetric.
    pub response: Matrix3<f64>,
    /// How strongly the fields twist the body.
    pub twist: f64,
    /// About which they do.
    pub axis: Vector3<f64>,
}

/// A body that sees three directions of space.
#[lie_poisson_system(
    group = SO3,
    advected(a: R3, b: R3, c: R3),
    potential = a.dot(&(coupling * b)) + (1.0 + c.norm_squared() + c.x * a.y).sqrt(),
)]
#[derive(Clone, Debug, PartialEq)]
pub struct Beholder {
    /// Principal moments of inertia.
    #[inertia]
    pub inertia: Vector3<f64>,
    /// Between the first two directions.
    pub coupling: Matrix3<f64>,
}

impl Sample for FreeRigidBody {
    fn sample(random: &mut Random) -> (Self, FreeRigidBodyState) {
        let state = FreeRigidBodyState { attitude: random.rotation(), momentum: random.vector() };
        (Self { inertia: random.moments() }, state)
    }

    fn inertia_matrix(&self) -> Matrix3<f64> {
        Matrix3::from_diagonal(&self.inertia)
    }

    fn potential_energy(&self, _advected: &[Vector3<f64>]) -> f64 {
        0.0
    }

    fn potential_gradient(&self, _advected: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        vec![]
    }
}

impl Sample for TiltedBody {
    fn sample(random: &mut Random) -> (Self, TiltedBodyState) {
        let state = TiltedBodyState { attitude: random.rotation(), momentum: random.vector() };
        (Self { inertia: random.inertia() }, state)
    }

    fn inertia_matrix(&self) -> Matrix3<f64> {
        self.inertia
    }

    fn potential_energy(&self, _advected: &[Vector3<f64>]) -> f64 {
        0.0
    }

    fn potential_gradient(&self, _advected: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        vec![]
    }
}

impl Sample for HeavyTop {
    fn sample(random: &mut Random) -> (Self, HeavyTopState) {
        let top = Self { inertia: random.moments(), weight: random.between(0.5, 2.0), chi: random.vector() };
        let state = HeavyTopState {
            attitude: random.rotation(),
            momentum: random.vector(),
            gamma: random.direction(),
        };
        (top, state)
    }

    fn inertia_matrix(&self) -> Matrix3<f64> {
        Matrix3::from_diagonal(&self.inertia)
    }

    fn potential_energy(&self, advected: &[Vector3<f64>]) -> f64 {
        self.weight * advected[0].dot(&self.chi)
    }

    fn potential_gradient(&self, _advected: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        vec![self.weight * self.chi]
    }
}

impl Sample for Ball {
    fn sample(random: &mut Random) -> (Self, BallState) {
        let ball = Self {
            inertia: random.between(0.5, 3.0),
            weight: random.between(0.5, 2.0),
            offset: random.between(-1.0, 1.0),
        };
        let state = BallState {
            attitude: random.rotation(),
            momentum: random.vector(),
            vertical: random.direction(),
        };
        (ball, state)
    }

    fn inertia_matrix(&self) -> Matrix3<f64> {
        Matrix3::from_diagonal_element(self.inertia)
    }

    fn potential_energy(&self, advected: &[Vector3<f64>]) -> f64 {
        self.weight * self.offset * advected[0].z
    }

    fn potential_gradient(&self, _advected: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        vec![Vector3::z() * (self.weight * self.offset)]
    }
}

impl Sample for SprungTop {
    fn sample(random: &mut Random) -> (Self, SprungTopState) {
        let top = Self {
            inertia: random.inertia(),
            stiffness: random.between(0.5, 2.0),
            axis: random.vector(),
            depth: random.between(0.5, 2.0),
            rest: random.direction(),
        };
        let state = SprungTopState {
            attitude: random.rotation(),
            momentum: random.vector(),
            gamma: random.direction(),
        };
        (top, state)
    }

    fn inertia_matrix(&self) -> Matrix3<f64> {
        self.inertia
    }

    fn potential_energy(&self, advected: &[Vector3<f64>]) -> f64 {
        let away = advected[0] - self.rest;
        self.stiffness * advected[0].dot(&self.axis).powi(4) / 4.0 - self.depth * (-away.norm_squared()).exp()
    }

    fn potential_gradient(&self, advected: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        let away = advected[0] - self.rest;
        let spring = self.stiffness * advected[0].dot(&self.axis).powi(3) * self.axis;
        vec![spring + 2.0 * self.depth * (-away.norm_squared()).exp() * away]
    }
}

impl Sample for Compass {
    fn sample(random: &mut Random) -> (Self, CompassState) {
        let compass = Self {
            inertia: random.inertia(),
            weight: random.between(0.5, 2.0),
            chi: random.vector(),
            moment: random.vector(),
            response: random.matrix(),
            twist: random.between(0.5, 2.0),
            axis: random.vector(),
        };
        let state = CompassState {
            attitude: random.rotation(),
            momentum: random.vector(),
            gamma: random.direction(),
            field: random.vector(),
        };
        (compass, state)
    }

    fn inertia_matrix(&self) -> Matrix3<f64> {
        self.inertia
    }

    fn potential_energy(&self, advected: &[Vector3<f64>]) -> f64 {
        let (gamma, field) = (advected[0], advected[1]);
        let twisted = self.axis.dot(&gamma.cross(&field));
        self.weight * gamma.dot(&self.chi)
            - field.dot(&self.moment)
            - field.dot(&(self.response * field)) / 2.0
            + self.twist * twisted.sin()
    }

    fn potential_gradient(&self, advected: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        let (gamma, field) = (advected[0], advected[1]);
        let torsion = self.twist * self.axis.dot(&gamma.cross(&field)).cos();
        let induced = (self.response + self.response.transpose()) * field / 2.0;
        vec![
            self.weight * self.chi + torsion * field.cross(&self.axis),
            torsion * self.axis.cross(&gamma) - self.moment - induced,
        ]
    }
}

impl Sample for Beholder {
    fn sample(random: &mut Random) -> (Self, BeholderState) {
        let state = BeholderState {
            attitude: random.rotation(),
            momentum: random.vector(),
            a: random.direction(),
            b: random.vector(),
            c: random.vector(),
        };
        (Self { inertia: random.moments(), coupling: random.matrix() }, state)
    }

    fn inertia_matrix(&self) -> Matrix3<f64> {
        Matrix3::from_diagonal(&self.inertia)
    }

    fn potential_energy(&self, advected: &[Vector3<f64>]) -> f64 {
        let (a, b, c) = (advected[0], advected[1], advected[2]);
        a.dot(&(self.coupling * b)) + (1.0 + c.norm_squared() + c.x * a.y).sqrt()
    }

    fn potential_gradient(&self, advected: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        let (a, b, c) = (advected[0], advected[1], advected[2]);
        let root = (1.0 + c.norm_squared() + c.x * a.y).sqrt();
        vec![
            self.coupling * b + Vector3::y() * c.x / (2.0 * root),
            self.coupling.transpose() * a,
            (2.0 * c + Vector3::x() * a.y) / (2.0 * root),
        ]
    }
}

/// Calls a generic function for each system, with both retractions: `check::<System, Retraction>(name)`.
#[macro_export]
macro_rules! for_each_system_and_retraction {
    ($check:ident) => {
        $crate::for_each_system_and_retraction!(
            $check: FreeRigidBody, TiltedBody, HeavyTop, Ball, SprungTop, Compass, Beholder
        );
    };
    ($check:ident: $($system:ident),*) => {
        $(
            $check::<$crate::systems::$system, ::coadjoint::Exponential>(concat!(stringify!($system), ", exponential"));
            $check::<$crate::systems::$system, ::coadjoint::Cayley>(concat!(stringify!($system), ", Cayley"));
        )*
    };
}
