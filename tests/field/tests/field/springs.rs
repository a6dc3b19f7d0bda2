//! Lagrangian systems in free flight: in the equation of one velocity, products of others cancel that are zero for a
//! unit vector, but not in rounding.

use coadjoint::prelude::*;
use coadjoint::{Discretized, System};
use coadjoint_support::random::Random;

use crate::campaign::Subject;
use crate::runs::{Runs, scheme, walk};

/// A satellite with a mass on a spring, along an axis of its own.
#[lie_poisson_system(
    group(attitude: SO3, slider: R1),
    lagrangian = {
        let velocity = attitude_velocity.cross(&(slider.x * axis)) + slider_velocity.x * axis;
        let turning = attitude_velocity.dot(&attitude_velocity.component_mul(&inertia)) / 2.0;
        turning + mass * velocity.norm_squared() / 2.0 - stiffness * (slider.x - rest).powi(2) / 2.0
    },
    derivatives(state),
)]
struct Sprung {
    #[inertia]
    inertia: Vector3<f64>,
    mass: f64,
    stiffness: f64,
    rest: f64,
    axis: Vector3<f64>,
}

/// A base that floats in the plane, with an arm that turns freely.
#[lie_poisson_system(
    group(base: SE2, arm: SO2),
    lagrangian = {
        let (turn, v) = (base_angular_velocity, base_linear_velocity);
        let both = turn + arm_velocity.x;
        let tip = vector![
            v.x - turn * at.y - length * both * arm.sin_angle(),
            v.y + turn * at.x + length * both * arm.cos_angle()
        ];
        mass * v.norm_squared() / 2.0 + inertia * turn.powi(2) / 2.0 + tip_mass * tip.norm_squared() / 2.0
            + arm_inertia * both.powi(2) / 2.0
    },
)]
struct FreeArm {
    mass: f64,
    inertia: f64,
    tip_mass: f64,
    arm_inertia: f64,
    length: f64,
    at: Vector2<f64>,
}

/// How many starts, which step, and how many of them.
type Plan = (u64, f64, u64);

/// Runs from random states: none fails, energy is kept to `energy` of itself, and what `momenta` gives to rounding.
fn check<M, S>(
    runs: &mut Runs,
    system: &S,
    start: impl Fn(&mut Random) -> S::State,
    momenta: impl Fn(&S::State) -> Vector3<f64>,
    (starts, step, steps): Plan,
    energy: f64,
) where
    S: System<Scalar = f64> + Discretized<M>,
{
    let mut random = Random::new(7);
    for index in 0..starts {
        let what = format!("{}, {}, step {step}, start {index}", S::NAME, scheme::<M>());
        let start = start(&mut random);
        let Some(end) = runs.end(&what, walk::<M, S>(system, &start, step, steps)) else { continue };
        let (before, after) = (system.energy(&start), system.energy(&end));
        runs.close(format!("{what}, energy"), after, before, energy * before.abs());
        let off = (momenta(&end) - momenta(&start)).norm() / momenta(&start).norm();
        runs.close(format!("{what}, momenta"), off, 0.0, 4.0 * f64::EPSILON * steps as f64);
    }
}

fn check_spring<M>(plans: &[(Plan, f64)])
where
    Sprung: Discretized<M>,
{
    // the axis is of length 1, but for rounding
    let sprung = Sprung {
        inertia: vector![1.0, 2.0, 2.5],
        mass: 0.4,
        stiffness: 5.0,
        rest: 0.3,
        axis: vector![0.6, 0.0, 0.8],
    };
    let start = |random: &mut Random| {
        let rest = SprungState {
            attitude: UnitQuaternion::identity(),
            attitude_momentum: Vector3::zeros(),
            slider: vector![random.between(-0.2, 0.8)],
            slider_momentum: vector![0.0],
        };
        let turning = 2.0 * random.vector();
        let velocity = vector![turning.x, turning.y, turning.z, random.between(-1.0, 1.0)];
        sprung.with_velocity(&rest, &velocity).expect("it is regular")
    };
    let mut runs = Runs::default();
    for &(plan, energy) in plans {
        check::<M, _>(
            &mut runs,
            &sprung,
            start,
            |state| state.attitude * state.attitude_momentum,
            plan,
            energy,
        );
    }
    runs.assert();
}

#[test]
fn a_mass_on_a_spring_along_a_slanted_axis() {
    check_spring::<Exponential>(&[
        ((500, 0.01, 5_000), 1e-2),
        ((50, 0.001, 5_000), 1e-4),
        ((50, 0.05, 2_000), 0.1),
        ((50, 0.1, 2_000), 0.3),
    ]);
}

#[test]
fn a_mass_on_a_spring_by_the_cayley_map() {
    check_spring::<Cayley>(&[
        ((50, 0.01, 5_000), 1e-2),
        ((50, 0.001, 5_000), 1e-4),
        ((50, 0.05, 2_000), 0.1),
    ]);
}

#[test]
fn a_mass_on_a_spring_to_sixth_order() {
    check_spring::<Order6<Exponential>>(&[((50, 0.01, 2_000), 1e-6)]);
}

#[test]
fn an_arm_on_a_floating_base() {
    let arm = FreeArm {
        mass: 5.0,
        inertia: 1.0,
        tip_mass: 0.7,
        arm_inertia: 0.02,
        length: 0.8,
        at: vector![0.3, 0.2],
    };
    let start = |random: &mut Random| {
        let rest = FreeArmState {
            base: Isometry2::identity(),
            base_momentum: Vector3::zeros(),
            arm: UnitComplex::new(random.between(-3.0, 3.0)),
            arm_momentum: vector![0.0],
        };
        let v = 0.5 * random.vector();
        let velocity = vector![2.0 * v.x, v.y, v.z, random.between(-2.0, 2.0)];
        arm.with_velocity(&rest, &velocity).expect("it is regular")
    };
    // the linear momentum in space
    let momenta = |state: &FreeArmState| {
        let linear = state.base.rotation * state.base_momentum.yz();
        vector![linear.x, linear.y, 0.0]
    };
    let mut runs = Runs::default();
    check::<Order4<Cayley>, _>(&mut runs, &arm, start, momenta, (200, 0.01, 3_000), 1e-6);
    runs.assert();
}

/// For the [campaign](crate::campaign).
pub(crate) fn subjects() -> Vec<Subject> {
    vec![Subject::of(
        Sprung {
            inertia: vector![1.0, 2.0, 2.5],
            mass: 0.4,
            stiffness: 5.0,
            rest: 0.3,
            axis: vector![0.6, 0.0, 0.8],
        },
        &SprungState {
            attitude: UnitQuaternion::identity(),
            attitude_momentum: vector![0.4, -0.2, 0.3],
            slider: vector![0.4],
            slider_momentum: vector![0.1],
        },
    )]
}
