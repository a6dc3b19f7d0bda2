//! Forces and potentials that are smooth, of parts that are not: `|v| v`, `|v|²`, `|x|³` where v and x are zero.

use coadjoint::derivative::{WrtControl, WrtState};
use coadjoint::prelude::*;
use coadjoint::{Discretized, System};

use crate::campaign::Subject;
use crate::runs::{Runs, scheme, steer, walk};

/// A ball in the air.
#[lie_poisson_system(
    group = R3,
    potential = mass * gravity * position.z,
    force = -drag * velocity.norm() * velocity,
    methods(Midpoint),
)]
struct Ball {
    #[inertia]
    mass: f64,
    gravity: f64,
    drag: f64,
}

/// A quadrotor with drag on all that moves.
#[lie_poisson_system(
    group(attitude: SO3, position: R3),
    control(moment: R3, thrust: f64),
    potential = mass * gravity * position.z,
    force(
        attitude = moment - spin_drag * attitude_velocity.norm() * attitude_velocity,
        position = thrust * (attitude * Vector3::z()) - drag * position_velocity.norm() * position_velocity
    ),
    derivatives(state),
)]
struct Quad {
    #[inertia(attitude)]
    inertia: Vector3<f64>,
    #[inertia(position)]
    mass: f64,
    gravity: f64,
    drag: f64,
    spin_drag: f64,
}

/// A vehicle under water that goes to and fro.
#[lie_poisson_system(
    group = R1,
    control(push: f64),
    force = vector![push - drag * (velocity.x * velocity.x).sqrt() * velocity.x],
    derivatives,
)]
struct Surge {
    #[inertia]
    mass: f64,
    drag: f64,
}

/// A boat, with drag along each of its axes.
#[lie_poisson_system(
    group = SE2,
    force = {
        let (r, v) = (angular_velocity, linear_velocity);
        (
            -turning * (r * r).sqrt() * r,
            vector![-ahead * (v.x * v.x).sqrt() * v.x, -aside * (v.y * v.y).sqrt() * v.y]
        )
    },
    methods(Midpoint),
)]
struct Boat {
    #[inertia]
    inertia: Vector3<f64>,
    turning: f64,
    ahead: f64,
    aside: f64,
}

/// A disc, with drag that has no direction of its own.
#[lie_poisson_system(
    group = SE2,
    force = (
        -turning * (angular_velocity * angular_velocity).sqrt() * angular_velocity,
        -drag * linear_velocity.norm() * linear_velocity
    ),
)]
struct Disc {
    #[inertia]
    inertia: Vector3<f64>,
    turning: f64,
    drag: f64,
}

/// A body that turns in the air.
#[lie_poisson_system(group = SO3, force = -drag * velocity.norm() * velocity)]
struct Spinner {
    #[inertia]
    inertia: Vector3<f64>,
    drag: f64,
}

/// A mass in a hollow that is flat in its middle.
#[lie_poisson_system(group = R3, potential = stiffness * position.norm().powi(3) / 3.0, methods(Midpoint), derivatives(state))]
struct Cubic {
    #[inertia]
    mass: f64,
    stiffness: f64,
}

/// A mass in a hollow, by its Lagrangian.
#[lie_poisson_system(
    group = R3,
    lagrangian = mass * velocity.norm().powi(2) / 2.0 - stiffness * position.norm().powi(2) / 2.0,
)]
struct Trap {
    mass: f64,
    stiffness: f64,
}

/// Two balls that press on each other, after Hertz: the force is as `|x|^(3/2)`.
#[lie_poisson_system(group = R1, potential = stiffness * (position.x * position.x).powf(1.25) / 2.5, methods(Midpoint))]
struct Hertz {
    #[inertia]
    mass: f64,
    stiffness: f64,
}

/// A crane with drag, by its Lagrangian.
#[lie_poisson_system(
    group(cart: R1, load: SO2),
    control(push: f64),
    lagrangian = {
        let (v, w) = (cart_velocity.x, load_velocity.x);
        let turning = (4.0 / 3.0) * small * (length * w).powi(2) / 2.0;
        (big + small) * v.powi(2) / 2.0 + turning + small * length * v * w * load.cos_angle()
            + small * gravity * length * load.cos_angle()
    },
    force(
        cart = vector![push - drag * cart_velocity.norm() * cart_velocity.x],
        load = vector![-drag * load_velocity.norm() * load_velocity.x]
    ),
)]
struct Crane {
    big: f64,
    small: f64,
    length: f64,
    gravity: f64,
    drag: f64,
}

/// A body with a mass on a spring, and drag on both, by its Lagrangian.
#[lie_poisson_system(
    group(body: SO3, slider: R1),
    lagrangian = {
        let velocity = body_velocity.cross(&(slider.x * Vector3::x())) + slider_velocity.x * Vector3::x();
        let turning = body_velocity.dot(&body_velocity.component_mul(&inertia)) / 2.0;
        turning + mass * velocity.norm_squared() / 2.0 - stiffness * slider.x.powi(2) / 2.0
    },
    force(
        body = -drag * body_velocity.norm() * body_velocity,
        slider = vector![-drag * slider_velocity.norm() * slider_velocity.x]
    ),
)]
struct Slide {
    inertia: Vector3<f64>,
    mass: f64,
    stiffness: f64,
    drag: f64,
}

/// After so long, what drag of `c |v| v` on a mass has left of a speed.
fn slowed(speed: f64, drag: f64, mass: f64, time: f64) -> f64 {
    speed / (1.0 + drag * speed * time / mass)
}

/// Dropped, it falls at `v = u tanh(g t/u)`, with the speed `u = √(m g/c)` that it comes to; thrown up at v₀, it rises
/// with `v = u tan(atan(v₀/u) − g t/u)`, and falls after that. Without gravity it stays.
fn ball<M>(runs: &mut Runs)
where
    Ball: Discretized<M>,
{
    let ball = Ball { mass: 1.0, gravity: 9.81, drag: 0.1 };
    let at = |speed: f64| BallState { position: Vector3::zeros(), momentum: speed * Vector3::z() };
    let (limit, time) = ((9.81_f64 / 0.1).sqrt(), 2.0);
    let rises = limit / 9.81 * (5.0 / limit).atan();
    for (step, bound) in [(0.01, 1e-4), (0.1, 2e-2)] {
        for (start, fallen) in [(0.0, time), (-1e-300, time), (5.0, time - rises)] {
            let what = format!("{}, step {step}, from {start:e} m/s", scheme::<M>());
            let Some(end) =
                runs.end(&what, walk::<M, _>(&ball, &at(start), step, (time / step).round() as u64))
            else {
                continue;
            };
            runs.close(what, end.momentum.z, -limit * (9.81 * fallen / limit).tanh(), bound);
        }
    }
    let weightless = Ball { gravity: 0.0, ..ball };
    let what = format!("{}, weightless", scheme::<M>());
    if let Some(end) = runs.end(&what, walk::<M, _>(&weightless, &at(0.0), 0.01, 200)) {
        runs.all_close(what, end.momentum.as_slice(), &[0.0; 3], 0.0);
    }
}

#[test]
fn a_ball_falls_from_rest() {
    let mut runs = Runs::default();
    ball::<Exponential>(&mut runs);
    ball::<Midpoint>(&mut runs);
    runs.assert();
}

/// Nothing moves where thrust is weight; a moment about one axis turns it about that axis, to the speed at which drag
/// holds the balance.
fn hovers<M>(runs: &mut Runs)
where
    Quad: Discretized<M>,
{
    let quad =
        Quad { inertia: vector![0.02, 0.02, 0.04], mass: 1.3, gravity: 9.81, drag: 0.05, spin_drag: 0.001 };
    let start = QuadState {
        attitude: UnitQuaternion::identity(),
        attitude_momentum: Vector3::zeros(),
        position: Vector3::zeros(),
        position_momentum: Vector3::zeros(),
    };
    for moment in [0.0, 1e-3] {
        let what = format!("{}, moment {moment}", scheme::<M>());
        let held = QuadControl { moment: moment * Vector3::z(), thrust: 1.3 * 9.81 };
        let end = steer::<M, _>(&quad, &start, (0.01, 2_000), |_, _| held);
        let Some(end) = runs.end(&what, end) else { continue };
        runs.all_close(&what, end.position_momentum.as_slice(), &[0.0; 3], 1e-12);
        let limit = (moment / quad.spin_drag).sqrt();
        let speed = limit * (moment.sqrt() * quad.spin_drag.sqrt() * 20.0 / 0.04).tanh();
        runs.all_close(what, end.attitude_momentum.as_slice(), &[0.0, 0.0, 0.04 * speed], 1e-5);
    }
}

#[test]
fn a_quadrotor_hovers_from_rest() {
    let mut runs = Runs::default();
    hovers::<Exponential>(&mut runs);
    hovers::<Cayley>(&mut runs);
    runs.assert();
}

/// Pulled from rest it goes with `v = u tanh(√(p c) t/m)`, `u = √(p/c)`.
#[test]
fn a_vehicle_is_pulled_from_rest() {
    let mut runs = Runs::default();
    let (mass, drag, push): (f64, f64, f64) = (11.4, 141.0, 40.0);
    let start = SurgeState { position: vector![0.0], momentum: vector![0.0] };
    let should = (push / drag).sqrt() * ((push * drag).sqrt() / mass).tanh();
    for (step, bound) in [(0.01, 1e-4), (0.001, 1e-6)] {
        let count = (1.0_f64 / step).round() as u64;
        let held = SurgeControl { push };
        let end = steer::<Exponential, _>(&Surge { mass, drag }, &start, (step, count), |_, _| held);
        let Some(end) = runs.end(step, end) else { continue };
        runs.close(step, end.momentum.x / mass, should, bound);
    }
    runs.assert();
}

/// At rest drag has no derivative, so that the step's are those of a mass that is pushed; as slow as that, too; and
/// faster those that differences say.
#[test]
fn derivatives_of_a_step_from_rest() {
    let mut runs = Runs::default();
    let (step, surge) = (0.01, Surge { mass: 2.0, drag: 3.0 });
    let jacobians = |momentum: f64| {
        let mut state = SurgeState { position: vector![0.0], momentum: vector![momentum] };
        let mut stepper = surge.stepper::<Exponential>(step).expect("a stepper");
        let report =
            stepper.step_with_jacobian(&mut state, &SurgeControl { push: 0.0 }, (WrtState, WrtControl));
        report.map(|(jacobians, _)| jacobians)
    };
    for momentum in [0.0, 1e-200, 1e-12] {
        let what = format!("momentum {momentum:e}");
        let Some((by_state, by_control)) = runs.end(&what, jacobians(momentum)) else { continue };
        // column by column
        runs.all_close(
            format!("{what}, by the state"),
            by_state.as_slice(),
            &[1.0, 0.0, step / 2.0, 1.0],
            1e-12,
        );
        runs.all_close(
            format!("{what}, by the control"),
            by_control.as_slice(),
            &[step * step / 4.0, step],
            1e-14,
        );
    }
    let after = |momentum: f64, push: f64| {
        let start = SurgeState { position: vector![0.0], momentum: vector![momentum] };
        let end = steer::<Exponential, _>(&surge, &start, (step, 1), |_, _| SurgeControl { push });
        end.map(|end| vector![end.position.x, end.momentum.x]).expect("a step")
    };
    for momentum in [0.1, -0.3] {
        let what = format!("momentum {momentum}");
        let Some((by_state, by_control)) = runs.end(&what, jacobians(momentum)) else { continue };
        let d = 1e-6;
        let difference = (after(momentum + d, 0.0) - after(momentum - d, 0.0)) / (2.0 * d);
        runs.all_close(&what, &by_state.as_slice()[2..], difference.as_slice(), 1e-8);
        let difference = (after(momentum, d) - after(momentum, -d)) / (2.0 * d);
        runs.all_close(&what, by_control.as_slice(), difference.as_slice(), 1e-8);
    }
    runs.assert();
}

/// Straight ahead and turning on the spot, speeds fall as `v/(1 + c v t/m)`; both at once, and askew, it gets slower.
fn boat<M>(runs: &mut Runs)
where
    Boat: Discretized<M>,
{
    let boat = Boat { inertia: vector![2.76, 25.8, 33.8], turning: 1.0, ahead: 141.0, aside: 217.0 };
    let ahead = slowed(1.0, 141.0, 25.8, 1.0);
    assert!((ahead - 0.154676).abs() < 1e-6);
    for (step, bound) in [(0.001, 1e-5), (0.01, 1e-3), (0.1, 0.1)] {
        for (velocity, should) in [
            (vector![0.0, 1.0, 0.0], Some([0.0, ahead, 0.0])),
            (vector![1.0, 0.0, 0.0], Some([slowed(1.0, 1.0, 2.76, 1.0), 0.0, 0.0])),
            (vector![0.0, 0.0, -1.0], Some([0.0, 0.0, -slowed(1.0, 217.0, 33.8, 1.0)])),
            (Vector3::zeros(), Some([0.0; 3])),
            (vector![0.5, 1.0, 0.0], None),
            (vector![0.5, 1.0, 0.1], None),
        ] {
            let what = format!("{}, step {step}, from {:?}", scheme::<M>(), velocity.as_slice());
            let momentum = velocity.component_mul(&boat.inertia);
            let start = BoatState { pose: Isometry2::identity(), momentum };
            let end = walk::<M, _>(&boat, &start, step, (1.0_f64 / step).round() as u64);
            let Some(end) = runs.end(&what, end) else { continue };
            match should {
                Some(should) => {
                    let is = end.momentum.component_div(&boat.inertia);
                    runs.all_close(what, is.as_slice(), &should, bound);
                }
                None => {
                    let (before, after) = (boat.energy(&start), boat.energy(&end));
                    runs.close(what, after, 0.25 * before, 0.24 * before);
                }
            }
        }
    }
}

#[test]
fn a_boat_goes_straight_ahead() {
    let mut runs = Runs::default();
    boat::<Exponential>(&mut runs);
    boat::<Midpoint>(&mut runs);
    runs.assert();
}

#[test]
fn a_disc_goes_straight_ahead() {
    let disc = Disc { inertia: vector![2.76, 25.8, 25.8], turning: 1.0, drag: 141.0 };
    let mut runs = Runs::default();
    for (step, bound) in [(0.001, 1e-5), (0.01, 1e-3), (0.1, 0.1)] {
        for (turning, ahead) in [(0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (0.5, 1.0)] {
            let what = format!("step {step}, from {turning} rad/s, {ahead} m/s");
            let momentum = vector![turning, ahead, 0.0].component_mul(&disc.inertia);
            let start = DiscState { pose: Isometry2::identity(), momentum };
            let end = walk::<Exponential, _>(&disc, &start, step, (1.0_f64 / step).round() as u64);
            let Some(end) = runs.end(&what, end) else { continue };
            // it goes straight in space while it turns
            let is = end.momentum.component_div(&disc.inertia);
            let should = [slowed(turning, 1.0, 2.76, 1.0), slowed(ahead, 141.0, 25.8, 1.0)];
            runs.all_close(what, &[is.x, is.yz().norm()], &should, bound);
        }
    }
    runs.assert();
}

/// About an axis of its own, and not at all.
#[test]
fn a_spinning_body_slows_down() {
    let inertia = vector![1.0, 2.0, 2.5];
    let spinner = Spinner { inertia, drag: 0.5 };
    let mut runs = Runs::default();
    for (step, count, bound) in [(0.01, 1_000, 1e-6), (1.0, 10, 2e-2)] {
        for rate in [vector![0.0, 0.0, 0.0], vector![0.1, 0.0, 0.0], vector![0.0, 0.0, -0.4]] {
            let what = format!("step {step}, from {:?}", rate.as_slice());
            let momentum = rate.component_mul(&inertia);
            let start = SpinnerState { attitude: UnitQuaternion::identity(), momentum };
            let Some(end) = runs.end(&what, walk::<Exponential, _>(&spinner, &start, step, count)) else {
                continue;
            };
            let moments = inertia.iter();
            let should = rate
                .iter()
                .zip(moments)
                .map(|(rate, of)| of * rate.signum() * slowed(rate.abs(), 0.5, *of, 10.0));
            runs.all_close(what, end.momentum.as_slice(), &should.collect::<Vec<_>>(), bound);
        }
    }
    runs.assert();
}

/// From its middle, where `|x|` has no derivative, with a velocity of 1; and at rest there.
fn hollows<M>(runs: &mut Runs)
where
    Cubic: Discretized<M>,
    Hertz: Discretized<M>,
{
    let what = scheme::<M>();
    let cubic = Cubic { mass: 1.0, stiffness: 4.0 };
    let hertz = Hertz { mass: 1.0, stiffness: 10.0 };
    for (speed, cubed, pressed) in
        [(1.0, [0.72099553, 0.02318656], [0.26794814, -0.83826307]), (0.0, [0.0; 2], [0.0; 2])]
    {
        let momentum = speed * Vector3::x();
        let start = CubicState { position: Vector3::zeros(), momentum };
        let what = format!("{what}, from {speed} m/s");
        if let Some(end) = runs.end(&what, walk::<M, _>(&cubic, &start, 1e-3, 1_000)) {
            runs.all_close(&what, &[end.position.x, end.momentum.x], &cubed, 1e-6);
            runs.all_close(&what, &[end.position.y, end.momentum.z], &[0.0; 2], 0.0);
        }
        let start = HertzState { position: vector![0.0], momentum: vector![speed] };
        if let Some(end) = runs.end(&what, walk::<M, _>(&hertz, &start, 1e-3, 1_000)) {
            runs.all_close(what, &[end.position.x, end.momentum.x], &pressed, 1e-5);
        }
    }
}

#[test]
fn hollows_are_smooth_in_their_middle() {
    let mut runs = Runs::default();
    hollows::<Exponential>(&mut runs);
    hollows::<Midpoint>(&mut runs);
    runs.assert();
}

/// Swings as `cos 2t` from where it is let go, and as `½ sin 2t` through the middle.
#[test]
fn a_lagrangian_of_squared_norms() {
    let trap = Trap { mass: 1.0, stiffness: 4.0 };
    let mut runs = Runs::default();
    for (place, speed) in [(0.1, 0.0), (0.0, 1.0), (0.0, 0.0)] {
        let what = format!("from {place} m, {speed} m/s");
        let start = TrapState { position: place * Vector3::x(), momentum: speed * Vector3::x() };
        let Some(end) = runs.end(&what, walk::<Exponential, _>(&trap, &start, 0.01, 100)) else { continue };
        let (sin, cos) = 2.0_f64.sin_cos();
        runs.close(what, end.position.x, place * cos + speed * sin / 2.0, 1e-4);
    }
    runs.assert();
}

/// Two seconds from rest, hanging or let go, pushed or not.
fn crane<M>(runs: &mut Runs, plans: &[(f64, f64)])
where
    Crane: Discretized<M>,
{
    let crane = Crane { big: 2.0, small: 1.0, length: 3.0, gravity: 9.81, drag: 0.3 };
    for &(step, bound) in plans {
        for (angle, push, should) in [
            (0.0, 0.0, [0.0, 0.0]),
            (0.0, 1.0, [0.70910326, -0.06052463]),
            (0.3, 0.0, [0.53276091, -0.26634599]),
            (0.3, 1.0, [1.20330929, -0.32374426]),
        ] {
            let what = format!("{}, step {step}, from {angle} rad, push {push}", scheme::<M>());
            let start = CraneState {
                cart: vector![0.0],
                cart_momentum: vector![0.0],
                load: UnitComplex::new(angle),
                load_momentum: vector![0.0],
            };
            let held = CraneControl { push };
            let end = steer::<M, _>(&crane, &start, (step, (2.0 / step).round() as u64), |_, _| held);
            let Some(end) = runs.end(&what, end) else { continue };
            runs.all_close(what, &[end.cart.x, end.load.angle()], &should, bound);
        }
    }
}

#[test]
fn a_crane_with_drag() {
    let mut runs = Runs::default();
    crane::<Exponential>(&mut runs, &[(0.001, 1e-6), (0.02, 5e-4), (0.1, 1e-2)]);
    crane::<Order4<Exponential>>(&mut runs, &[(0.001, 1e-7), (0.02, 1e-4)]);
    runs.assert();
}

/// At rest; on its spring alone; and turning about the slider's axis or across it.
#[test]
fn a_mass_on_a_spring_with_drag() {
    let slide = Slide { inertia: vector![1.0, 2.0, 2.5], mass: 0.3, stiffness: 4.0, drag: 0.1 };
    let mut runs = Runs::default();
    for (step, bound) in [(0.001, 1e-6), (0.02, 1e-3), (0.1, 2e-2)] {
        for (turning, place, should) in [
            (Vector3::zeros(), 0.0, Some((0.0, 0.0))),
            (Vector3::zeros(), 0.2, Some((0.0, 0.09017422))),
            (vector![0.1, 0.0, 0.0], 0.0, Some((slowed(0.1, 0.1, 1.0, 2.0), 0.0))),
            (vector![0.0, 0.5, 0.0], 0.0, None),
        ] {
            let what = format!("step {step}, from {:?}, {place}", turning.as_slice());
            let start = SlideState {
                body: UnitQuaternion::identity(),
                body_momentum: turning,
                slider: vector![place],
                slider_momentum: vector![0.0],
            };
            let end = walk::<Exponential, _>(&slide, &start, step, (2.0_f64 / step).round() as u64);
            let Some(end) = runs.end(&what, end) else { continue };
            match should {
                Some((rate, place)) => {
                    runs.all_close(&what, &[end.body_momentum.x, end.slider.x], &[rate, place], bound);
                    runs.all_close(what, &[end.body_momentum.y, end.body_momentum.z], &[0.0; 2], 1e-14);
                }
                // the slider in its middle has no part in it
                None => runs.close(what, end.body_momentum.y, 2.0 * slowed(0.25, 0.1, 2.0, 2.0), bound),
            }
        }
    }
    runs.assert();
}

/// For the [campaign](crate::campaign).
pub(crate) fn subjects() -> Vec<Subject> {
    vec![
        Subject::of(
            Quad {
                inertia: vector![0.02, 0.02, 0.04],
                mass: 1.3,
                gravity: 9.81,
                drag: 0.05,
                spin_drag: 0.001,
            },
            &QuadState {
                attitude: UnitQuaternion::identity(),
                attitude_momentum: vector![0.01, -0.02, 0.01],
                position: vector![1.0, -0.5, 1.0],
                position_momentum: vector![0.3, 1.0, -0.4],
            },
        ),
        Subject::of(
            Cubic { mass: 1.0, stiffness: 4.0 },
            &CubicState { position: vector![0.4, -0.3, 0.2], momentum: vector![0.1, 0.3, -0.2] },
        ),
    ]
}
