//! What friction has brought to rest: forces balance, nothing moves, and it can be computed for ever.

use coadjoint::prelude::*;
use coadjoint::{Discretized, System};

use crate::campaign::Subject;
use crate::runs::{Runs, scheme, steer, walk};

/// A top with friction; without weight it is a body that comes to rest anywhere.
#[lie_poisson_system(
    group = SO3,
    advected(up: R3),
    potential = weight * up.dot(&chi),
    force = -friction * momentum,
    methods(Midpoint),
    derivatives(state),
)]
struct Top {
    #[inertia]
    inertia: Vector3<f64>,
    weight: f64,
    chi: Vector3<f64>,
    friction: f64,
}

/// A buoy on a rope.
#[lie_poisson_system(
    group = SE3,
    potential = {
        let rope = pose.transform_point(&Point3::from(eye)) - Point3::origin();
        stiffness * rope.norm_squared() / 2.0 - lift * pose.translation.z
    },
    force = (-drag * angular_momentum, -drag * linear_momentum),
    methods(Midpoint),
    derivatives(state),
)]
struct Buoy {
    #[inertia]
    inertia: Vector6<f64>,
    eye: Vector3<f64>,
    stiffness: f64,
    lift: f64,
    drag: f64,
}

/// A double pendulum with friction in its joints, by its Lagrangian.
#[lie_poisson_system(
    group(upper: SO2, lower: SO2),
    lagrangian = {
        let (a, b) = (upper_velocity.x, lower_velocity.x);
        let between = upper.inverse() * lower;
        a.powi(2) + b.powi(2) / 2.0 + a * b * between.cos_angle()
            + gravity * (2.0 * upper.cos_angle() + lower.cos_angle())
    },
    force(upper = -friction * upper_velocity, lower = -friction * lower_velocity),
    methods(Midpoint),
    derivatives(state),
)]
struct Double {
    gravity: f64,
    friction: f64,
}

/// A crane whose cart is held by a spring, by its Lagrangian.
#[lie_poisson_system(
    group(cart: R1, load: SO2),
    lagrangian = {
        let (v, w) = (cart_velocity.x, load_velocity.x);
        1.5 * v.powi(2) + v * w * load.cos_angle() + w.powi(2) / 2.0 + gravity * load.cos_angle()
            - stiffness * cart.x.powi(2) / 2.0
    },
    force(cart = -friction * cart_velocity, load = -friction * load_velocity),
    methods(Midpoint),
)]
struct Crane {
    gravity: f64,
    stiffness: f64,
    friction: f64,
}

/// Two magnets that draw each other along, and a field that draws one of them upright.
#[lie_poisson_system(
    group(first: SO3, second: SO3),
    potential = -stiffness * (first * axis).dot(&(second * axis)) - (first * axis).z,
    force(first = -friction * first_velocity, second = -friction * second_velocity),
    methods(Midpoint),
)]
struct Pair {
    #[inertia(first, second)]
    inertia: Vector3<f64>,
    stiffness: f64,
    axis: Vector3<f64>,
    friction: f64,
}

/// A quadrotor in still air.
#[lie_poisson_system(
    group(attitude: SO3, position: R3),
    control(moment: R3, thrust: f64),
    potential = mass * gravity * position.z,
    force(attitude = moment, position = thrust * (attitude * Vector3::z()) - drag * position_velocity),
    methods(Midpoint),
)]
struct Quad {
    #[inertia(attitude)]
    inertia: Matrix3<f64>,
    #[inertia(position)]
    mass: f64,
    gravity: f64,
    drag: f64,
}

/// Steps of a hundredth and of a tenth of a second: what they are for has settled after a fraction of so many.
const PLANS: [(f64, u64); 2] = [(0.01, 20_000), (0.1, 20_000)];
/// How far from rest rounding may keep them.
const REST: f64 = 1e-12;

fn attitude() -> UnitQuaternion<f64> {
    UnitQuaternion::new(vector![0.4, 0.3, 0.2])
}

/// Runs by both plans, and says of the end how far it is from rest.
fn settles<M, S>(
    runs: &mut Runs,
    what: &str,
    (system, start): (&S, &S::State),
    plans: &[(f64, u64)],
    off: impl Fn(&S::State) -> Vec<f64>,
) where
    S: System<Scalar = f64> + Discretized<M>,
{
    for &(step, count) in plans {
        let what = format!("{what}, {}, step {step}", scheme::<M>());
        let Some(end) = runs.end(&what, walk::<M, S>(system, start, step, count)) else { continue };
        let off = off(&end);
        runs.all_close(what, &off, &vec![0.0; off.len()], REST);
    }
}

/// Hangs with its centre of mass below, or rests anywhere.
fn top<M>(runs: &mut Runs)
where
    Top: Discretized<M>,
{
    for weight in [9.0, 0.0] {
        let chi = vector![0.1, 0.2, -1.0];
        let top = Top { inertia: vector![1.0, 2.0, 2.5], weight, chi, friction: 0.5 };
        let up = attitude().inverse() * Vector3::z();
        let start = TopState { attitude: attitude(), momentum: vector![0.3, 0.2, 0.5], up };
        settles::<M, _>(runs, &format!("weight {weight}"), (&top, &start), &PLANS, |end| {
            let hangs = if weight > 0.0 { end.up + chi.normalize() } else { Vector3::zeros() };
            [end.momentum, hangs].iter().flatten().copied().collect()
        });
    }
}

#[test]
fn a_top_that_hangs() {
    let mut runs = Runs::default();
    top::<Exponential>(&mut runs);
    top::<Cayley>(&mut runs);
    top::<Midpoint>(&mut runs);
    top::<Order4<Exponential>>(&mut runs);
    runs.assert();
}

/// Floats upright above where it is tied: its rope pulls with all of the lift.
fn buoy<M>(runs: &mut Runs)
where
    Buoy: Discretized<M>,
{
    for eye in [vector![0.0, 0.0, -0.5], vector![0.1, 0.05, -0.5]] {
        let (stiffness, lift) = (20.0, 10.0);
        let buoy = Buoy { inertia: vector![0.1, 0.1, 0.2, 1.0, 1.0, 1.0], eye, stiffness, lift, drag: 1.0 };
        let start = BuoyState { pose: Isometry3::rotation(0.3 * Vector3::x()), momentum: Vector6::zeros() };
        settles::<M, _>(runs, &format!("{eye:?}"), (&buoy, &start), &PLANS, |end| {
            let place = end.pose.translation.vector - (lift / stiffness + eye.norm()) * Vector3::z();
            let upright = end.pose.rotation * eye + eye.norm() * Vector3::z();
            end.momentum.iter().chain(&place).chain(&upright).copied().collect()
        });
    }
}

#[test]
fn a_buoy_that_floats() {
    let mut runs = Runs::default();
    buoy::<Exponential>(&mut runs);
    buoy::<Cayley>(&mut runs);
    buoy::<Midpoint>(&mut runs);
    buoy::<Order4<Exponential>>(&mut runs);
    runs.assert();
}

fn pendulums<M>(runs: &mut Runs)
where
    Double: Discretized<M>,
    Crane: Discretized<M>,
{
    let double = Double { gravity: 9.81, friction: 0.3 };
    let start = DoubleState {
        upper: UnitComplex::new(1.0),
        upper_momentum: vector![0.1],
        lower: UnitComplex::new(-0.5),
        lower_momentum: vector![0.2],
    };
    settles::<M, _>(runs, "double pendulum", (&double, &start), &PLANS[1..], |end| {
        vec![end.upper.angle(), end.lower.angle(), end.upper_momentum.x, end.lower_momentum.x]
    });
    let crane = Crane { gravity: 9.81, stiffness: 3.0, friction: 0.3 };
    let start = CraneState {
        cart: vector![0.5],
        cart_momentum: vector![0.1],
        load: UnitComplex::new(-0.5),
        load_momentum: vector![0.2],
    };
    settles::<M, _>(runs, "crane", (&crane, &start), &PLANS[1..], |end| {
        vec![end.cart.x, end.load.angle(), end.cart_momentum.x, end.load_momentum.x]
    });
}

#[test]
fn pendulums_that_hang() {
    let mut runs = Runs::default();
    pendulums::<Exponential>(&mut runs);
    pendulums::<Midpoint>(&mut runs);
    runs.assert();
}

fn pair<M>(runs: &mut Runs)
where
    Pair: Discretized<M>,
{
    let axis = vector![0.1, 0.2, 1.0];
    let pair = Pair { inertia: vector![1.0, 2.0, 2.5], stiffness: 4.0, axis, friction: 0.4 };
    let start = PairState {
        first: attitude(),
        first_momentum: vector![0.1, 0.0, 0.2],
        second: UnitQuaternion::identity(),
        second_momentum: vector![0.0, 0.3, 0.0],
    };
    settles::<M, _>(runs, "pair", (&pair, &start), &PLANS[1..], |end| {
        let off = |turn: UnitQuaternion<f64>| turn * axis - axis.norm() * Vector3::z();
        let off = [end.first_momentum, end.second_momentum, off(end.first), off(end.second)];
        off.iter().flatten().copied().collect()
    });
}

#[test]
fn magnets_that_point_up() {
    let mut runs = Runs::default();
    pair::<Exponential>(&mut runs);
    pair::<Midpoint>(&mut runs);
    runs.assert();
}

/// Goes to two metres above the origin, and hovers there.
fn quad<M>(runs: &mut Runs)
where
    Quad: Discretized<M>,
{
    let inertia = matrix![0.02, 0.001, 0.0; 0.001, 0.02, 0.0005; 0.0, 0.0005, 0.04];
    let quad = Quad { inertia, mass: 1.3, gravity: 9.81, drag: 0.2 };
    let start = QuadState {
        attitude: UnitQuaternion::new(vector![0.2, 0.1, 0.3]),
        attitude_momentum: Vector3::zeros(),
        position: vector![1.0, -0.5, 1.0],
        position_momentum: Vector3::zeros(),
    };
    let law = |state: &QuadState, _: f64| {
        let (place, momentum) = (state.position, state.position_momentum);
        let up = vector![-0.3 * place.x - 0.4 * momentum.x, -0.3 * place.y - 0.4 * momentum.y, 9.81];
        let up = state.attitude.inverse() * up.normalize();
        QuadControl {
            moment: 0.8 * Vector3::z().cross(&up) - 6.0 * state.attitude_momentum,
            thrust: 1.3 * 9.81 + 2.0 * (2.0 - place.z) - 2.0 * momentum.z,
        }
    };
    for (step, count) in PLANS {
        let what = format!("{}, step {step}", scheme::<M>());
        let Some(end) = runs.end(&what, steer::<M, _>(&quad, &start, (step, count), law)) else { continue };
        let off = [end.attitude_momentum, end.position - 2.0 * Vector3::z(), end.position_momentum];
        let off: Vec<f64> = off.iter().flatten().copied().collect();
        runs.all_close(what, &off, &vec![0.0; off.len()], REST);
    }
}

#[test]
fn a_quadrotor_that_hovers() {
    let mut runs = Runs::default();
    quad::<Exponential>(&mut runs);
    quad::<Midpoint>(&mut runs);
    runs.assert();
}

/// For the [campaign](crate::campaign).
pub(crate) fn subjects() -> Vec<Subject> {
    vec![Subject::of(
        Crane { gravity: 9.81, stiffness: 3.0, friction: 0.3 },
        &CraneState {
            cart: vector![0.5],
            cart_momentum: vector![0.1],
            load: UnitComplex::new(-0.5),
            load_momentum: vector![0.2],
        },
    )]
}
