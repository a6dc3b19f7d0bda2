//! Lagrangians in which a conserved momentum is zero: carts and poles that are let go, arms and fuel that move in a
//! craft that floats.

use coadjoint::nalgebra::{Isometry2, SMatrix, SVector, Vector6};
use coadjoint::prelude::*;
use coadjoint::{Discretized, System};
use coadjoint_support::random::Random;

use crate::campaign::Subject;
use crate::runs::{Runs, scheme, steer, walk};

/// A cart with a pole.
#[lie_poisson_system(
    group(cart: R1, pole: SO2),
    control(push: f64),
    lagrangian = {
        let (v, w) = (cart_velocity.x, pole_velocity.x);
        let turning = (4.0 / 3.0) * small * (length * w).powi(2) / 2.0;
        (big + small) * v.powi(2) / 2.0 + turning + small * length * v * w * pole.cos_angle()
            - small * gravity * length * pole.cos_angle()
    },
    force(cart = vector![push]),
    methods(Midpoint),
    derivatives(state),
)]
struct CartPole {
    big: f64,
    small: f64,
    length: f64,
    gravity: f64,
}

/// The same as one group of matrices.
#[lie_poisson_system(
    group = product(cart: R1, pole: SO2),
    lagrangian = {
        let (v, w) = (velocity[0], velocity[1]);
        let cos = element[(2, 2)];
        let turning = (4.0 / 3.0) * small * (length * w).powi(2) / 2.0;
        (big + small) * v.powi(2) / 2.0 + turning + small * length * v * w * cos - small * gravity * length * cos
    },
)]
struct Product {
    big: f64,
    small: f64,
    length: f64,
    gravity: f64,
}

/// A cart with a pole on its pole.
#[lie_poisson_system(
    group(cart: R1, first: SO2, second: SO2),
    lagrangian = {
        let (v, a, b) = (cart_velocity.x, first_velocity.x, second_velocity.x);
        let between = first.inverse() * second;
        let squares = own.x * v.powi(2) + own.y * a.powi(2) + own.z * b.powi(2);
        let products = shared.x * v * a * first.cos_angle() + shared.y * v * b * second.cos_angle()
            + shared.z * a * b * between.cos_angle();
        squares / 2.0 + products - weights.x * first.cos_angle() - weights.y * second.cos_angle()
    },
    methods(Midpoint),
)]
struct TwoPoles {
    own: Vector3<f64>,
    shared: Vector3<f64>,
    weights: Vector2<f64>,
}

/// A base that floats in the plane, and a joint with a motor.
#[lie_poisson_system(
    group(base: SO2, joint: SO2),
    control(motor: f64),
    lagrangian = {
        let (w, u) = (base_velocity.x, joint_velocity.x);
        (j0 + j1 + 2.0 * c * joint.cos_angle()) * w.powi(2) / 2.0 + (j1 + c * joint.cos_angle()) * w * u
            + j1 * u.powi(2) / 2.0
    },
    force(joint = vector![motor]),
    derivatives(state),
)]
struct Arm {
    j0: f64,
    j1: f64,
    c: f64,
}

/// A body with a mass of fuel on a spring.
#[lie_poisson_system(
    group(place: R3, slosh: R3),
    lagrangian = {
        let v = place_velocity + slosh_velocity;
        body * place_velocity.norm_squared() / 2.0 + fuel * v.norm_squared() / 2.0
            - stiffness * slosh.norm_squared() / 2.0
    },
)]
struct Slosh {
    body: f64,
    fuel: f64,
    stiffness: f64,
}

/// A hull whose centre of mass is not where its place is measured.
#[lie_poisson_system(
    group = SE3,
    lagrangian = {
        let v = linear_velocity + angular_velocity.cross(&centre);
        let height = pose.transform_point(&Point3::from(centre)).coords.z;
        mass * v.norm_squared() / 2.0 + angular_velocity.dot(&angular_velocity.component_mul(&inertia)) / 2.0
            - weight * height + lift * pose.translation.z
    },
)]
struct Hull {
    inertia: Vector3<f64>,
    mass: f64,
    centre: Vector3<f64>,
    weight: f64,
    lift: f64,
}

/// The cart that everyone trains on.
const CART: CartPole = CartPole { big: 1.0, small: 0.1, length: 0.5, gravity: 9.8 };

/// At rest, with the pole at this angle.
fn at_rest(angle: f64) -> CartPoleState {
    CartPoleState {
        cart: vector![0.0],
        cart_momentum: vector![0.0],
        pole: UnitComplex::new(angle),
        pole_momentum: vector![0.0],
    }
}

/// Let go at 0.05 rad: where it is after a second, with steps that are off by `bound`, and with those of a microsecond.
fn let_go<M>(runs: &mut Runs, step: f64, bound: f64)
where
    CartPole: Discretized<M>,
{
    let what = format!("{}, step {step}", scheme::<M>());
    let count = (1.0 / step).round() as u64;
    if let Some(end) = runs.end(&what, walk::<M, _>(&CART, &at_rest(0.05), step, count)) {
        let velocity = CART.velocity(&end);
        let is = [end.cart.x, end.pole.angle(), velocity[0], velocity[1]];
        runs.all_close(&what, &is, &[-0.0409223, 1.2541012, -0.0638454, 4.5101882], bound);
        runs.close(format!("{what}, momentum"), end.cart_momentum.x, 0.0, 1e-14);
    }
    let shortest = walk::<M, _>(&CART, &at_rest(0.05), 1e-6, 50);
    if let Some(end) = runs.end(format!("{what}, microseconds"), shortest) {
        // at rest the pole falls with θ̈ = (M + m) g sin θ / l ((4/3) (M + m) − m cos² θ)
        let (sin, cos) = 0.05_f64.sin_cos();
        let fall = 1.1 * 9.8 * sin / (0.5 * (4.0 / 3.0 * 1.1 - 0.1 * cos * cos));
        runs.close(format!("{what}, microseconds"), CART.velocity(&end)[1], 5e-5 * fall, 1e-12);
    }
}

#[test]
fn a_cart_and_its_pole() {
    let mut runs = Runs::default();
    for (step, bound) in [(0.02, 0.02), (1e-3, 5e-5)] {
        let_go::<Exponential>(&mut runs, step, bound);
        let_go::<Cayley>(&mut runs, step, bound);
        let_go::<Midpoint>(&mut runs, step, bound);
    }
    let_go::<Order4<Exponential>>(&mut runs, 0.01, 1e-6);
    let_go::<Order4<Exponential>>(&mut runs, 1e-3, 1e-7);
    runs.assert();
}

#[test]
fn a_cart_and_its_pole_as_one_group() {
    let product = Product { big: 1.0, small: 0.1, length: 0.5, gravity: 9.8 };
    let mut element = SMatrix::<f64, 4, 4>::identity();
    let turn = UnitComplex::new(0.05).to_rotation_matrix();
    element.fixed_view_mut::<2, 2>(2, 2).copy_from(turn.matrix());
    let start = ProductState { element, momentum: SVector::zeros() };
    let mut runs = Runs::default();
    for step in [1e-6, 1e-3, 0.02] {
        let what = format!("step {step}");
        let together = walk::<Exponential, _>(&product, &start, step, 50);
        let apart = walk::<Exponential, _>(&CART, &at_rest(0.05), step, 50);
        let (Some(together), Some(apart)) = (runs.end(&what, together), runs.end(&what, apart)) else {
            continue;
        };
        let is = [together.element[(0, 1)], together.element[(3, 2)], together.element[(2, 2)]];
        runs.all_close(what, &is, &[apart.cart.x, apart.pole.im, apart.pole.re], 1e-11);
    }
    runs.assert();
}

/// Episodes from random angles, without pushes and with those of a law that holds the pole up, until it has fallen.
fn trains<M>(runs: &mut Runs, step: f64, episodes: u64)
where
    CartPole: Discretized<M>,
{
    let mut random = Random::new(11);
    for episode in 0..episodes {
        let start = at_rest(random.between(-0.05, 0.05));
        for is_held in [false, true] {
            let what = format!("{}, step {step}, episode {episode}, held up: {is_held}", scheme::<M>());
            let mut pushed = 0.0;
            let law = |state: &CartPoleState, _| {
                let velocity = CART.velocity(state);
                let push = 30.0 * state.pole.angle() + 6.0 * velocity[1] + state.cart.x + 2.0 * velocity[0];
                let push = if is_held { push } else { 0.0 };
                pushed += step * push;
                CartPoleControl { push }
            };
            let end = steer::<M, _>(&CART, &start, (step, (2.0 / step) as u64), law);
            let Some(end) = runs.end(&what, end) else { continue };
            runs.close(format!("{what}, momentum"), end.cart_momentum.x, pushed, 1e-12);
            if is_held {
                assert!(end.pole.angle().abs() < 0.05, "{what}: it falls");
            } else {
                let (before, after) = (CART.energy(&start), CART.energy(&end));
                runs.close(format!("{what}, energy"), after, before, 2e-3);
            }
        }
    }
}

#[test]
fn a_cart_and_its_pole_in_many_episodes() {
    let mut runs = Runs::default();
    trains::<Exponential>(&mut runs, 0.02, 200);
    trains::<Cayley>(&mut runs, 0.02, 200);
    trains::<Midpoint>(&mut runs, 0.02, 200);
    trains::<Order4<Exponential>>(&mut runs, 0.02, 100);
    trains::<Exponential>(&mut runs, 0.002, 20);
    trains::<Midpoint>(&mut runs, 0.002, 20);
    runs.assert();
}

/// From rest, and with a momentum that is small beside those of the poles, which become fast.
fn two_poles<M>(runs: &mut Runs, step: f64, bound: f64)
where
    TwoPoles: Discretized<M>,
{
    let poles = TwoPoles {
        own: vector![1.0, 0.2 * 0.0625 * 4.0 / 3.0 + 0.05, 0.2 * 0.0625 * 4.0 / 3.0],
        shared: vector![0.15, 0.05, 0.025],
        weights: vector![0.15 * 9.80665, 0.05 * 9.80665],
    };
    for (momentum, should) in
        [(0.0, [0.19154093, 5.47949228, -7.67017432]), (1.5e-4, [0.19164246, 5.47927639, -7.66256600])]
    {
        let what = format!("{}, step {step}, momentum {momentum}", scheme::<M>());
        let start = TwoPolesState {
            cart: vector![0.0],
            cart_momentum: vector![momentum],
            first: UnitComplex::new(0.3),
            first_momentum: vector![0.0],
            second: UnitComplex::new(-0.2),
            second_momentum: vector![0.0],
        };
        let end = walk::<M, _>(&poles, &start, step, (1.0 / step).round() as u64);
        let Some(end) = runs.end(&what, end) else { continue };
        let turns = |angle: f64| UnitComplex::new(angle);
        runs.close(&what, end.cart.x, should[0], bound);
        runs.close(&what, end.first.angle_to(&turns(should[1])), 0.0, 10.0 * bound);
        runs.close(&what, end.second.angle_to(&turns(should[2])), 0.0, 10.0 * bound);
        runs.close(format!("{what}, momentum"), end.cart_momentum.x, momentum, 1e-14);
    }
}

#[test]
fn a_cart_and_two_poles() {
    let mut runs = Runs::default();
    two_poles::<Exponential>(&mut runs, 1e-3, 1e-4);
    two_poles::<Midpoint>(&mut runs, 1e-3, 1e-4);
    two_poles::<Order4<Exponential>>(&mut runs, 1e-3, 2e-8);
    runs.assert();
}

/// A motor of 0.2 N m for a second, and four more: base and joint turn against each other.
#[test]
fn an_arm_whose_momentum_is_zero() {
    let arm = Arm { j0: 2.0, j1: 0.5, c: 0.3 };
    let start = ArmState {
        base: UnitComplex::new(0.0),
        base_momentum: vector![0.0],
        joint: UnitComplex::new(0.2),
        joint_momentum: vector![0.0],
    };
    fn check<M>(runs: &mut Runs, arm: &Arm, start: &ArmState, bound: f64)
    where
        Arm: Discretized<M>,
    {
        let what = scheme::<M>();
        let end = steer::<M, _>(arm, start, (0.01, 100), |_, _| ArmControl { motor: 0.2 })
            .and_then(|pushed| walk::<M, _>(arm, &pushed, 0.01, 400));
        let Some(end) = runs.end(&what, end) else { return };
        runs.all_close(&what, &[end.base.angle(), end.joint.angle()], &[-0.51595414, 2.83883075], bound);
        runs.close(format!("{what}, momentum"), end.base_momentum.x, 0.0, 1e-15);
    }
    let mut runs = Runs::default();
    check::<Exponential>(&mut runs, &arm, &start, 1e-4);
    check::<Order4<Exponential>>(&mut runs, &arm, &start, 1e-8);
    runs.assert();
}

/// A body as heavy in all directions, dropped in air: no torque of air or weight, and `p × v` is rounding.
#[lie_poisson_system(
    group = SE2,
    potential = gravity * inertia.y * pose.translation.y,
    force = (0.0, -drag * linear_velocity.norm() * linear_velocity),
)]
struct Dropped {
    #[inertia]
    inertia: Vector3<f64>,
    gravity: f64,
    drag: f64,
}

/// It falls straight, `v = (g/c)^½ tanh((g c)^½ t)`, however it is turned.
#[test]
fn bodies_of_one_mass_that_are_dropped_fall_straight_however_they_are_turned() {
    fn falls<M>(runs: &mut Runs, step: f64, bound: f64)
    where
        Dropped: Discretized<M>,
    {
        let body = Dropped { inertia: vector![0.02, 1.0, 1.0], gravity: 9.81, drag: 0.2 };
        let (falling, rate) = ((9.81_f64 / 0.2).sqrt(), (9.81_f64 * 0.2).sqrt());
        for k in 0..100 {
            let angle = -3.0 + 0.06 * f64::from(k);
            let start = DroppedState { pose: Isometry2::new(vector![0.0, 0.0], angle), ..Default::default() };
            let what = format!("{} by {step}, turned by {angle}", scheme::<M>());
            let end = walk::<M, _>(&body, &start, step, (0.5 / step).round() as u64);
            let Some(end) = runs.end(&what, end) else { continue };
            let speed = -falling * (0.5 * rate).tanh();
            let momentum = [0.0, speed * angle.sin(), speed * angle.cos()];
            runs.all_close(&what, end.momentum.as_slice(), &momentum, bound);
            runs.close(format!("{what}, spin"), end.momentum.x, 0.0, 1e-15);
        }
    }
    let mut runs = Runs::default();
    for step in [0.1, 0.05, 0.01, 0.005] {
        falls::<Exponential>(&mut runs, step, 2.0 * step * step);
        falls::<Cayley>(&mut runs, step, 2.0 * step * step);
    }
    falls::<Order4<Exponential>>(&mut runs, 0.05, 1e-5);
    runs.assert();
}

/// The same in a well, `¼ k |x|⁴`.
#[lie_poisson_system(
    group = SE2,
    potential = 0.25 * stiffness * pose.translation.vector.norm_squared().powi(2),
    methods(Midpoint, HamiltonJacobi(4)),
)]
struct InWell {
    #[inertia]
    inertia: Vector3<f64>,
    stiffness: f64,
}

/// It goes to and fro on a line through the bottom, and does not turn.
#[test]
fn bodies_of_one_mass_in_a_well_go_to_and_fro_on_a_line() {
    fn swings<M>(runs: &mut Runs, bound: f64)
    where
        InWell: Discretized<M>,
    {
        let body = InWell { inertia: vector![0.02, 1.0, 1.0], stiffness: 1.0 };
        for k in 0..100 {
            let angle = -3.0 + 0.06 * f64::from(k);
            let start = InWellState { pose: Isometry2::new(vector![1.0, 0.5], angle), ..Default::default() };
            let what = format!("{}, turned by {angle}", scheme::<M>());
            let Some(end) = runs.end(&what, walk::<M, _>(&body, &start, 0.1, 50)) else { continue };
            let at = end.pose.translation.vector;
            runs.close(format!("{what}, off the line"), at.x - 2.0 * at.y, 0.0, 1e-13);
            runs.close(
                format!("{what}, turned"),
                end.pose.rotation.angle() - start.pose.rotation.angle(),
                0.0,
                1e-12,
            );
            runs.close(format!("{what}, energy"), body.energy(&end), body.energy(&start), bound);
        }
    }
    let mut runs = Runs::default();
    swings::<Exponential>(&mut runs, 1e-2);
    swings::<Midpoint<Exponential>>(&mut runs, 1e-2);
    swings::<Midpoint<Cayley>>(&mut runs, 1e-2);
    swings::<HamiltonJacobi<Exponential, 4>>(&mut runs, 1e-4);
    runs.assert();
}

/// The fuel swings with `ω² = k (1/M + 1/m)`, and the body the other way; the centre of mass goes on as it does.
#[test]
fn fuel_that_sloshes() {
    let slosh = Slosh { body: 100.0, fuel: 5.0, stiffness: 8.0 };
    let frequency = (8.0_f64 * (1.0 / 100.0 + 1.0 / 5.0)).sqrt();
    let stretch = vector![0.1, 0.0, 0.05];
    let mut runs = Runs::default();
    for step in [0.01, 0.1] {
        for momentum in [0.0, 1e-12, 1e-6, 1e-3] {
            let what = format!("step {step}, momentum {momentum:e}");
            let (place, zero) = (Vector3::zeros(), Vector3::zeros());
            // the momentum of the whole; the fuel is at rest against the body
            let whole = vector![momentum, 0.0, 0.0];
            let start = SloshState {
                place,
                place_momentum: whole,
                slosh: stretch,
                slosh_momentum: whole * (5.0 / 105.0),
            };
            let Some(end) =
                runs.end(&what, walk::<Exponential, _>(&slosh, &start, step, (10.0 / step) as u64))
            else {
                continue;
            };
            let swung = stretch * (frequency * 10.0).cos();
            let bound = 0.1 * (step * frequency).powi(2);
            runs.all_close(&what, end.slosh.as_slice(), swung.as_slice(), bound);
            let moved = whole * (10.0 / 105.0) - (end.slosh - stretch) * (5.0 / 105.0);
            runs.all_close(&what, end.place.as_slice(), moved.as_slice(), 1e-13);
            runs.all_close(&what, end.place_momentum.as_slice(), (whole + zero).as_slice(), 1e-15);
        }
    }
    runs.assert();
}

/// At rest, turning, moving, with no linear momentum; in balance, falling and free: its centre of mass falls as a stone
/// does.
#[test]
fn a_hull_whose_centre_is_elsewhere() {
    let (mass, centre, inertia) = (10.0, vector![0.1, 0.0, -0.2], vector![0.5, 0.6, 0.7]);
    let turn = vector![0.3, 0.2, -0.5];
    let none = Vector3::zeros();
    let mut runs = Runs::default();
    for (weight, lift) in [(98.1, 98.1), (98.1, 0.0), (0.0, 0.0)] {
        let hull = Hull { inertia, mass, centre, weight, lift };
        for (angular, linear) in
            [(none, none), (turn, none), (none, vector![1.0, 0.0, 0.0]), (turn, -turn.cross(&centre))]
        {
            for step in [1e-4, 0.01] {
                let what =
                    format!("weight {weight}, lift {lift}, velocity {angular:?}, {linear:?}, step {step}");
                let pose = Isometry3::rotation(vector![0.3, 0.1, 0.0]);
                let rest = HullState { pose, momentum: Vector6::zeros() };
                let velocity = vector![angular.x, angular.y, angular.z, linear.x, linear.y, linear.z];
                let start = hull.with_velocity(&rest, &velocity).expect("it is regular");
                let Some(end) = runs.end(&what, walk::<Exponential, _>(&hull, &start, step, 500)) else {
                    continue;
                };
                let time = 500.0 * step;
                let of = |pose: &Isometry3<f64>| pose.transform_point(&Point3::from(centre)).coords;
                let begin = pose.rotation * (linear + angular.cross(&centre));
                let fall = vector![0.0, 0.0, (lift - weight) / mass];
                let should = of(&pose) + begin * time + fall * time * time / 2.0;
                runs.all_close(
                    &what,
                    of(&end.pose).as_slice(),
                    should.as_slice(),
                    0.05 * step * time + 1e-13,
                );
                let of = |state: &HullState| hull.energy(state);
                runs.close(format!("{what}, energy"), of(&end), of(&start), 1e3 * step * step);
            }
        }
    }
    runs.assert();
}

/// For the [campaign](crate::campaign).
pub(crate) fn subjects() -> Vec<Subject> {
    vec![Subject::of(
        CART,
        &CartPoleState { cart_momentum: vector![0.3], pole_momentum: vector![0.1], ..at_rest(0.4) },
    )]
}
