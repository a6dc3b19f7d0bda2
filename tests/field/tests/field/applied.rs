//! What people simulate with packages of this kind: vehicles, spacecraft, asteroids, particles and spins, to the digits that other methods give
//! them. Systems are described in texts here, which takes no compiler: their steps are those of the compiled ones, to the last bit.

use std::sync::Arc;

use coadjoint::erased::{Stepper, System};
use coadjoint::prelude::*;
use coadjoint::system::Quantity;
use coadjoint::{Event, Occurrence, Run};
use coadjoint_dynamic::Model;

use crate::runs::Runs;

/// A system, and where it is.
struct Motion {
    system: Arc<dyn System>,
    state: Vec<f64>,
}

impl Motion {
    /// A system of a description with parameters in its order; states likewise.
    fn of(text: &str, parameters: &[f64], state: &[f64]) -> Self {
        let model = Model::from_text(text).unwrap_or_else(|error| panic!("{error}"));
        let motion = Self { system: Arc::new(model.system(parameters)), state: state.to_vec() };
        assert_eq!(motion.system.parameters().len(), parameters.len());
        motion
    }

    /// Goes on to a time, with controls that are functions of it.
    fn to(mut self, scheme: &str, step: f64, time: f64, law: impl FnMut(f64) -> Vec<f64>) -> Self {
        let scheme = scheme.parse().expect(scheme);
        let mut stepper = Stepper::new(self.system.clone(), &scheme, step).expect("a stepper");
        Run::new(&mut stepper, &mut self.state).driven_by(law).to(time).expect("steps");
        self
    }

    /// The same without controls.
    fn alone(self, scheme: &str, step: f64, time: f64) -> Self {
        self.to(scheme, step, time, |_| Vec::new())
    }

    /// The numbers of a quantity.
    fn at(&self, name: &str) -> &[f64] {
        let mut all = Quantity::with_ranges(self.system.description().state);
        let (_, slots) = all.find(|(quantity, _)| quantity.name == name).expect(name);
        &self.state[slots]
    }

    fn energy(&self, time: f64) -> f64 {
        self.system.energy(&self.state, time, &[])
    }
}

/// At rest at the unit element of SO(3).
const UPRIGHT: [f64; 7] = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];

/// Asteroid 1999 KW4: two bodies of four points of mass each, on the corners of a tetrahedron, which attract one another in pairs.
const ASTEROID: &str = "
    #[lie_poisson_system(group(first: SO3, place: R3, second: SO3, other: R3), potential = {
        let pairs = (0..4).map(|i| (0..4).map(|j| {
            let d = place + first * first_size.component_mul(&corners[i])
                - other - second * second_size.component_mul(&corners[j]);
            1.0 / d.norm()
        }).sum::<f64>()).sum::<f64>();
        -gravity * (first_mass / 4.0) * (second_mass / 4.0) * pairs
    })]
    struct Binary {
        #[inertia(first)] first_inertia: Vector3<f64>,
        #[inertia(place)] first_mass: f64,
        #[inertia(second)] second_inertia: Vector3<f64>,
        #[inertia(other)] second_mass: f64,
        first_size: Vector3<f64>,
        second_size: Vector3<f64>,
        corners: [Vector3<f64>; 4],
        gravity: f64,
    }";

/// After a day, in SI units and in kilometres, hours and 10¹² kg.
#[test]
fn a_binary_asteroid() {
    let mut runs = Runs::default();
    let corners = [1.0, 1.0, 1.0, 1.0, -1.0, -1.0, -1.0, 1.0, -1.0, -1.0, -1.0, 1.0];
    for (units, length, time, mass) in [("SI", 1.0, 1.0, 1.0), ("km, h, 1e12 kg", 1000.0, 3600.0, 1e12)] {
        let (m1, m2) = (2.353e12 / mass, 0.135e12 / mass);
        let size = |axes: Vector3<f64>| axes / length / 5_f64.sqrt();
        let (first, second) = (size(vector![760.0, 740.0, 670.0]), size(vector![285.0, 232.0, 175.0]));
        let moments = |m: f64, s: Vector3<f64>| {
            let [x, y, z] = [s.x, s.y, s.z].map(|s| s * s);
            vector![y + z, x + z, x + y] * m
        };
        let gravity = 6.6743e-11 / length.powi(3) * mass * time * time;
        let (inertia, other) = (moments(m1, first), moments(m2, second));
        let parameters: Vec<f64> = (inertia.iter().chain([&m1]).chain(&other).chain([&m2]))
            .chain(first.iter().chain(&second).chain(&corners).chain([&gravity]))
            .copied()
            .collect();
        let distance = 2540.0 / length;
        let rate = (gravity * (m1 + m2) / distance.powi(3)).sqrt();
        let push = m1 * m2 / (m1 + m2) * rate * distance;
        let spin = std::f64::consts::TAU / (2.7645 * 3600.0 / time) * inertia.z;
        let state = [
            [1.0, 0.0, 0.0, 0.0, 0.0, 0.1 * spin, spin],
            [-m2 / (m1 + m2) * distance, 0.0, 0.0, 0.0, -push, 0.0, 0.05_f64.cos()],
            [0.0, 0.0, 0.05_f64.sin(), 0.0, 0.0, rate * other.z, m1 / (m1 + m2) * distance],
            [0.0, 0.0, 0.0, push, 0.0, 0.0, 0.0],
        ];
        let state = &state.concat()[..26];
        let end = Motion::of(ASTEROID, &parameters, state).alone(
            "Order6<Exponential>",
            60.0 / time,
            86_400.0 / time,
        );
        let between: Vec<f64> = end
            .at("other")
            .iter()
            .zip(end.at("place"))
            .map(|(other, place)| (other - place) * length)
            .collect();
        let expected = [-2_070.117_330_4, 1_410.448_488_2, -5.835_429_97];
        runs.all_close(format!("{units}: between them"), &between, &expected, 1e-6);
        let turned = [-0.241_905_593, -0.006_266_348, -0.017_470_596, -0.970_122_258];
        let sign = -end.at("second")[3].signum();
        let second: Vec<f64> = end.at("second").iter().map(|x| x * sign).collect();
        runs.all_close(format!("{units}: the second"), &second, &turned, 2e-9);
    }
    runs.assert();
}

/// The BlueROV2 in its heavy configuration, after Fossen: added mass, weight, buoyancy, linear and quadratic damping.
const VEHICLE: &str = "
    #[lie_poisson_system(
        group = SE3,
        control(push: R3, moment: R3),
        potential = weight * pose.transform_point(&Point3::origin()).coords.z
            - lift * pose.transform_point(&Point3::from(lift_at)).coords.z,
        force = {
            let (w, v) = (angular_velocity, linear_velocity);
            let turning = vector![w.x.abs() * w.x, w.y.abs() * w.y, w.z.abs() * w.z];
            let moving = vector![v.x.abs() * v.x, v.y.abs() * v.y, v.z.abs() * v.z];
            (
                moment - linear_moment.component_mul(&w) - square_moment.component_mul(&turning),
                push - linear_push.component_mul(&v) - square_push.component_mul(&moving),
            )
        },
    )]
    struct Rov {
        #[inertia] inertia: Vector6<f64>,
        weight: f64,
        lift: f64,
        lift_at: Vector3<f64>,
        linear_moment: Vector3<f64>,
        square_moment: Vector3<f64>,
        linear_push: Vector3<f64>,
        square_push: Vector3<f64>,
    }";

#[test]
fn an_underwater_vehicle() {
    let mut runs = Runs::default();
    let parameters = [
        [0.449, 0.365, 0.592, 19.86, 20.62, 32.18],
        [13.5 * 9.82, 1000.0 * 0.0134 * 9.82, 0.0, 0.0, 0.01, 0.0],
        [0.8, 0.0, 1.19, 0.47, 1.5, 13.7],
        [0.0, 33.0, 141.0, 217.0, 190.0, 0.0],
    ];
    let start = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let control = vec![40.0, 10.0, 0.0, 0.0, 0.0, 1.0];
    let vehicle = Motion::of(VEHICLE, &parameters.concat()[..23], &start);
    let end = vehicle.to("Order4<Exponential>", 0.01, 10.0, |_| control.clone());
    let pose = end.at("pose");
    runs.all_close("turned", &pose[..4], &[-0.716_508_84, -0.050_874_84, 0.046_436_71, -0.694_168_9], 1e-7);
    runs.all_close("at", &pose[4..], &[0.577_166_57, 0.753_947_58, 0.340_920_33], 1e-7);
    runs.assert();
}

/// A boat after Fossen, with its centre of mass before the reference point.
const BOAT: &str = "
    #[lie_poisson_system(group = SE2, control(surge: f64, yaw: f64), force = {
        let (r, v) = (angular_velocity, linear_velocity);
        (
            yaw - nr * r - nrr * r.abs() * r,
            vector![surge - xu * v.x - xuu * v.x.abs() * v.x, -yv * v.y - yvv * v.y.abs() * v.y],
        )
    })]
    struct Boat { #[inertia] inertia: Matrix3<f64>, nr: f64, nrr: f64, xu: f64, xuu: f64, yv: f64, yvv: f64 }";

#[test]
fn a_boat_that_turns() {
    let mut runs = Runs::default();
    let off = 23.8 * 0.046;
    let parameters = [
        [2.76, 0.0, off, 0.0, 25.8, 0.0, off, 0.0, 33.8],
        [1.9, 0.75, 0.7225, 1.3274, 0.8612, 36.2823, 0.0, 0.0, 0.0],
    ];
    let boat = Motion::of(BOAT, &parameters.concat()[..15], &[1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let end =
        boat.to("Order4<Exponential>", 0.01, 30.0, |time| vec![2.0, if time < 10.0 { 0.5 } else { -0.3 }]);
    let pose = end.at("pose");
    let heading = pose[1].atan2(pose[0]);
    let expected = [-5.997_670_76, -0.243_726_34, -0.640_005_86];
    runs.all_close("place and heading", &[pose[2], pose[3], heading], &expected, 1e-7);
    runs.assert();
}

/// A quadrotor whose rotors take time to follow, with crazyflie's numbers.
const QUADROTOR: &str = "
    #[lie_poisson_system(
        group(attitude: SO3, position: R3, rotors: R4),
        control(command: R4),
        hamiltonian = attitude_momentum.dot(&attitude_momentum.component_div(&inertia)) / 2.0
            + position_momentum.norm_squared() / (2.0 * mass) + mass * gravity * position.z,
        force(
            attitude = {
                let f = thrust * rotors_momentum.component_mul(&rotors_momentum);
                let spin = rotor_inertia
                    * (rotors_momentum.x - rotors_momentum.y + rotors_momentum.z - rotors_momentum.w);
                vector![arm * (f.x - f.y - f.z + f.w), arm * (-f.x - f.y + f.z + f.w), yaw * (f.x - f.y + f.z - f.w)]
                    - attitude_velocity.cross(&(spin * Vector3::z()))
            },
            position = attitude * (thrust * rotors_momentum.norm_squared() * Vector3::z()) - drag * position_velocity,
            rotors = (command - rotors_momentum) / lag,
        ),
    )]
    struct Fly {
        inertia: Vector3<f64>,
        mass: f64,
        gravity: f64,
        thrust: f64,
        yaw: f64,
        arm: f64,
        rotor_inertia: f64,
        drag: f64,
        lag: f64,
    }";

#[test]
fn a_quadrotor_whose_motors_lag() {
    let mut runs = Runs::default();
    let (thrust, arm) = (2.3e-8, 0.043 / 2_f64.sqrt());
    let parameters =
        [1.43e-5, 1.43e-5, 2.89e-5, 0.03, 9.81, thrust, 7.8e-10 / thrust, arm, 1e-8, 0.01, 0.072];
    let hover = (0.03 * 9.81 / 4.0 / thrust).sqrt();
    let start = [&UPRIGHT[..], &[0.0; 10], &[hover; 4]].concat();
    let law = |time: f64| {
        let d = if time < 0.5 { 5.0 } else { -5.0 };
        vec![hover + d, hover - 2.0 * d, hover - d, hover + 2.5 * d]
    };
    let end = Motion::of(QUADROTOR, &parameters, &start).to("Order4<Exponential>", 1e-3, 1.0, law);
    runs.all_close("place", end.at("position"), &[0.457_190_79, -1.313_339_08, -0.611_537_07], 1e-8);
    let turned = [0.733_873_81, 0.640_830_61, 0.222_200_96, -0.037_310_78];
    runs.all_close("turned", end.at("attitude"), &turned, 1e-8);
    let rotors = [1_783.560_178, 1_798.531_272, 1_793.540_908, 1_776.074_630];
    runs.all_close("rotors", end.at("rotors_momentum"), &rotors, 1e-6);
    runs.assert();
}

/// A Furuta pendulum: an arm that turns about the vertical, and a rod at its end.
const FURUTA: &str = "
    #[lie_poisson_system(
        group(arm: SO2, rod: SO2),
        lagrangian = {
            let (a, b) = (arm_velocity.x, rod_velocity.x);
            let (c, s) = (rod.cos_angle(), rod.sin_angle());
            let swing = mass * length.powi(2) + rod_inertia;
            0.5 * (arm_inertia + mass * radius.powi(2) + swing * s.powi(2)) * a.powi(2) + 0.5 * swing * b.powi(2)
                + mass * radius * length * a * b * c + mass * gravity * length * c
        },
        force(arm = -arm_friction * arm_velocity, rod = -rod_friction * rod_velocity),
    )]
    struct Furuta {
        arm_inertia: f64,
        rod_inertia: f64,
        mass: f64,
        radius: f64,
        length: f64,
        gravity: f64,
        arm_friction: f64,
        rod_friction: f64,
    }";

#[test]
fn a_furuta_pendulum() {
    let mut runs = Runs::default();
    for (friction, expected) in
        [([0.0, 0.0], [-2.635_145_418, 2.994_868_112]), ([1e-4, 2.8e-5], [-2.867_839_779, -0.467_293_874])]
    {
        let parameters =
            [&[0.000_940_57, 0.000_217_5, 0.029, 0.115, 0.075, 9.81][..], &friction[..]].concat();
        let velocities = [1.0, 0.0, 2.0, 3_f64.cos(), 3_f64.sin(), 0.1];
        let mut start = Motion::of(FURUTA, &parameters, &velocities);
        start.state = start.system.with_velocity(&velocities, 0.0, &[]).expect("momenta");
        let end = start.alone("Order6<Exponential>", 0.002, 2.0);
        let angle = |name: &str| end.at(name)[1].atan2(end.at(name)[0]);
        runs.all_close(format!("{friction:?}"), &[angle("arm"), angle("rod")], &expected, 5e-9);
    }
    runs.assert();
}

/// A satellite that the gradient of gravity turns: on a given circle, and on an orbit that it moves along itself.
const ON_A_CIRCLE: &str = "
    #[lie_poisson_system(group = SO3, potential = {
        let nadir = attitude.inverse() * vector![(rate * t).cos(), (rate * t).sin(), 0.0];
        1.5 * rate.powi(2) * nadir.dot(&nadir.component_mul(&inertia))
    })]
    struct OnCircle { #[inertia] inertia: Vector3<f64>, rate: f64 }";
const IN_ORBIT: &str = "
    #[lie_poisson_system(group(attitude: SO3, position: R3), potential = {
        let r = position.norm();
        let nadir = attitude.inverse() * (position / r);
        -mu * mass / r + 1.5 * mu / r.powi(3) * nadir.dot(&nadir.component_mul(&inertia)) - mu / (2.0 * r.powi(3)) * inertia.sum()
    })]
    struct InOrbit { #[inertia(attitude)] inertia: Vector3<f64>, #[inertia(position)] mass: f64, mu: f64 }";

/// The Earth's, m³/s².
const EARTH: f64 = 3.986_004_418e14;

#[test]
fn a_satellite_under_the_gradient_of_gravity() {
    let mut runs = Runs::default();
    let radius = 7.0e6;
    let rate = (EARTH / f64::powi(radius, 3)).sqrt();
    // libration about the normal of the orbit is that of a pendulum for twice the angle
    let half = 0.005_f64;
    let start = [half.cos(), 0.0, 0.0, half.sin(), 0.0, 0.0, 900.0 * rate];
    let mut satellite = Motion::of(ON_A_CIRCLE, &[350.0, 800.0, 900.0, rate], &start);
    let scheme = "Order4<Exponential>".parse().expect("a scheme");
    let mut stepper = Stepper::new(satellite.system.clone(), &scheme, 10.0).expect("a stepper");
    let mut crossings = Vec::new();
    let pitch = |state: &Vec<f64>, time: f64| (2.0 * state[3].atan2(state[0]) - rate * time).sin();
    let note = |event: &mut Occurrence<'_, dyn System>| crossings.push(event.time());
    Run::new(&mut stepper, &mut satellite.state)
        .event(Event::rising(), pitch, note)
        .to(60_000.0)
        .expect("steps");
    let turns = crossings.len() - 1;
    let period = (crossings[turns] - crossings[0]) / turns as f64;
    let small = std::f64::consts::TAU / (rate * (3.0_f64 * 450.0 / 900.0).sqrt());
    runs.close("linear theory", small, 4_758.96, 5e-3);
    runs.close("period", period, small * (1.0 + 0.02_f64.powi(2) / 16.0), 1e-3);

    let parameters = [0.1, 0.2, -0.3];
    let square: f64 = parameters.iter().map(|x| x * x).sum();
    let speed = 100.0 * (EARTH / radius).sqrt();
    let imaginary = parameters.map(|x| 2.0 * x / (1.0 + square));
    let start = [
        &[(1.0 - square) / (1.0 + square)],
        &imaginary[..],
        &[0.0, 0.0, 0.0, radius, 0.0, 0.0, 0.0, 0.8 * speed, 0.6 * speed],
    ];
    let craft = Motion::of(IN_ORBIT, &[500.0, 800.0, 350.0, 100.0, EARTH], &start.concat());
    let end = craft.alone("Order6<Exponential>", 10.0, 3600.0);
    let turned = [0.061_716_203, -0.937_875_453, 0.289_281_632, -0.181_374_975];
    runs.all_close("turned", end.at("attitude"), &turned, 2e-9);
    let momentum = [-0.065_617_946, -0.029_597_603, -0.420_892_192];
    runs.all_close("momentum", end.at("attitude_momentum"), &momentum, 2e-9);
    let place = [-5_172_890.376, -3_772_846.578, -2_829_634.934];
    runs.all_close("place", end.at("position"), &place, 2e-3);
    runs.assert();
}

/// An orbit of transfer about the Earth, with its apogee.
const TRANSFER: &str = "
    #[lie_poisson_system(
        group = R3,
        potential = -mu * mass / position.norm(),
        event(apogee = position.dot(&momentum), falling),
    )]
    struct Orbit { #[inertia] mass: f64, mu: f64 }";

#[test]
fn the_apogee_of_a_transfer() {
    let mut runs = Runs::default();
    let (radius, speed) = (6.678e6, 1.02e4);
    let mut orbit = Motion::of(TRANSFER, &[1.0, EARTH], &[radius, 0.0, 0.0, 0.0, speed, 0.0]);
    let scheme = "Order6<Exponential>".parse().expect("a scheme");
    let mut stepper = Stepper::new(orbit.system.clone(), &scheme, 30.0).expect("a stepper");
    let mut apogees = Vec::new();
    let note = |event: &mut Occurrence<'_, dyn System>| {
        apogees.push(event.time());
        event.stop();
    };
    Run::new(&mut stepper, &mut orbit.state).on("apogee", note).to(1e5).expect("steps");
    let axis = 1.0 / (2.0 / radius - speed * speed / EARTH);
    let half = std::f64::consts::PI * (axis.powi(3) / EARTH).sqrt();
    runs.close("half the period", half, 20_848.215_905_9, 1e-7);
    runs.all_close("apogee", &apogees, &[half], 5e-6);
    runs.assert();
}

/// Ten turns about a mass of 1 on an orbit as long as it is, which end where they began.
#[test]
fn an_eccentric_orbit_closes() {
    let mut runs = Runs::default();
    let turn = std::f64::consts::TAU;
    for (eccentricity, bound) in [(0.5_f64, 1e-11), (0.9, 3e-9)] {
        let speed = ((1.0 + eccentricity) / (1.0 - eccentricity)).sqrt();
        let start = [1.0 - eccentricity, 0.0, 0.0, 0.0, speed, 0.0];
        let end =
            Motion::of(TRANSFER, &[1.0, 1.0], &start).alone("Order6<Exponential>", turn / 1e4, 10.0 * turn);
        runs.all_close(format!("e = {eccentricity}"), end.at("position"), &start[..3], bound);
    }
    runs.assert();
}

/// An attitude of a given angular velocity, which cones: `(cos ½a, sin ½a cos ωt, sin ½a sin ωt, 0)`.
const CONE: &str = "
    #[lie_poisson_system(group = SO3, hamiltonian = {
        let (s, c) = (rate * t).sin_cos();
        let turning = vector![-s * angle.sin(), c * angle.sin(), -2.0 * (angle / 2.0).sin().powi(2)] * rate;
        turning.dot(&momentum)
    })]
    struct Coning { rate: f64, angle: f64 }";

/// At 10 Hz and 0.02 rad, sampled at 1 kHz for a minute.
#[test]
fn an_attitude_that_cones() {
    let mut runs = Runs::default();
    let (rate, angle, time) = (20.0 * std::f64::consts::PI, 0.02_f64, 60.0);
    let half = (angle / 2.0).sin();
    let exact = |time: f64| {
        let (sine, cosine) = (rate * time).sin_cos();
        [(angle / 2.0).cos(), half * cosine, half * sine, 0.0]
    };
    let start = [&exact(0.0)[..], &[0.0; 3]].concat();
    for (scheme, bound) in [("Order4<Exponential>", 5e-9), ("Order8<Exponential>", 1e-13)] {
        let end = Motion::of(CONE, &[rate, angle], &start).alone(scheme, 1e-3, time);
        runs.all_close(scheme, end.at("attitude"), &exact(time), bound);
        let length = end.at("attitude").iter().map(|x| x * x).sum::<f64>();
        runs.close(format!("{scheme}, length"), length, 1.0, 1e-15);
    }
    runs.assert();
}

/// A charge in a magnetic field that grows outwards, and in an electric one.
const PARTICLE: &str = "
    #[lie_poisson_system(group = R3, hamiltonian = {
        let grow = 1.0 + shape * (position.x.powi(2) + position.y.powi(2));
        let a = vector![-position.y, position.x, 0.0] * (0.5 * field * grow);
        (momentum - charge * a).norm_squared() / (2.0 * mass) + charge * push * position.x
    })]
    struct Particle { mass: f64, charge: f64, field: f64, shape: f64, push: f64 }";

#[test]
fn a_charge_in_a_field() {
    let mut runs = Runs::default();
    let start = [1.0, 0.0, 0.0, 0.5, 0.2 + 0.5 * 1.05, 0.1];
    let end =
        Motion::of(PARTICLE, &[1.0, 1.0, 1.0, 0.05, 0.1], &start).alone("Order6<Exponential>", 0.05, 100.0);
    runs.all_close("place", end.at("position"), &[-1.847_385_15, 5.099_347_1, 10.0], 1e-7);
    runs.assert();
}

/// A rocket whose inertia falls as it burns, where what leaves takes its momentum along, and a skater, who draws in the arms.
const ROCKET: &str = "
    #[lie_poisson_system(
        group = SO3,
        hamiltonian = {
            let now = full - (full - dry) * (t / burn);
            momentum.dot(&momentum.component_div(&now)) / 2.0
        },
        force = -loss * ((full - dry) / burn).component_mul(&velocity),
    )]
    struct Burning { full: Vector3<f64>, dry: Vector3<f64>, burn: f64, loss: f64 }";

#[test]
fn a_rocket_that_burns_and_a_skater() {
    let mut runs = Runs::default();
    let (full, dry) = (vector![60.0, 55.0, 8.0], vector![25.0, 24.0, 3.0]);
    let momentum = vector![0.3, -0.1, 4.0].component_mul(&full);
    let start = [&UPRIGHT[..4], momentum.as_slice()].concat();
    for (loss, rate, turned) in [
        (
            0.0,
            [-0.544_893_555, -0.544_481_425, 10.655_832_576],
            [-0.874_152_639, 0.079_770_627, -0.331_851_518, -0.345_497_295],
        ),
        (
            1.0,
            [0.105_398_158, 0.317_760_973, 3.993_956_817],
            [-0.594_881_028, -0.458_869_984, -0.252_323_703, -0.609_825_917],
        ),
    ] {
        let parameters = [full.as_slice(), dry.as_slice(), &[5.0, loss]].concat();
        let end = Motion::of(ROCKET, &parameters, &start).alone("Order6<Exponential>", 0.01, 5.0);
        let found: Vec<f64> = end.at("momentum").iter().zip(dry.iter()).map(|(p, j)| p / j).collect();
        runs.all_close(format!("rate, loss {loss}"), &found, &rate, 2e-9);
        runs.all_close(format!("turned, loss {loss}"), end.at("attitude"), &turned, 2e-9);
    }
    runs.assert();
}

/// A craft with fuel that sloshes as a pendulum, and rubs.
const FUEL: &str = "
    #[lie_poisson_system(
        group(hub: SO3, bob: SO3),
        lagrangian = {
            let relative = hub * hub_velocity.cross(&anchor) + bob * bob_velocity.cross(&arm);
            0.5 * hub_velocity.dot(&hub_velocity.component_mul(&hub_inertia)) + 0.5 * reduced * relative.norm_squared()
                + 0.5 * small * bob_velocity.norm_squared()
        },
        force(
            hub = -damping * (hub_velocity - hub.inverse() * (bob * bob_velocity)),
            bob = -damping * (bob_velocity - bob.inverse() * (hub * hub_velocity)),
        ),
    )]
    struct Fuel {
        hub_inertia: Vector3<f64>,
        reduced: f64,
        small: f64,
        anchor: Vector3<f64>,
        arm: Vector3<f64>,
        damping: f64,
    }";

#[test]
fn fuel_that_rubs() {
    let mut runs = Runs::default();
    let parameters = [900.0, 800.0, 600.0, 30.0, 0.5, 0.1, 0.0, 0.5, 0.0, 0.0, 0.6, 10.0];
    let bob = UnitQuaternion::new(vector![1.2, 0.3, 0.0]);
    let start = [1.0, 0.0, 0.0, 0.0, 1.0, 0.5, 0.1, bob.w, bob.i, bob.j, bob.k, 0.2, -0.4, 0.0];
    let mut fuel = Motion::of(FUEL, &parameters, &start);
    fuel.state = fuel.system.with_velocity(&start, 0.0, &[]).expect("momenta");
    let in_space = |motion: &Motion| {
        let part = |name: &str| {
            let q = motion.at(name);
            let turn = UnitQuaternion::from_quaternion(Quaternion::new(q[0], q[1], q[2], q[3]));
            turn * Vector3::from_column_slice(motion.at(&format!("{name}_momentum")))
        };
        part("hub") + part("bob")
    };
    let (energy, momentum) = (fuel.energy(0.0), in_space(&fuel));
    let end = fuel.alone("Order4<Exponential>", 0.05, 100.0);
    runs.all_close("energy", &[energy, end.energy(100.0)], &[558.123_716, 542.963_473], 2e-6);
    let turned = [-0.871_031_264, -0.443_249_839, -0.194_420_058, -0.083_874_662];
    runs.all_close("turned", end.at("hub"), &turned, 2e-7);
    runs.close("momentum", (in_space(&end) - momentum).norm() / momentum.norm(), 0.0, 1e-12);
    runs.assert();
}

/// A spin that is damped, after Landau, Lifshitz and Gilbert, with an easy axis.
const SPIN: &str = "
    #[lie_poisson_system(
        group = SO3,
        invariance = right,
        hamiltonian = -field.dot(&momentum) - easy * momentum.z.powi(2),
        force = {
            let b = field + 2.0 * easy * vector![0.0, 0.0, momentum.z];
            -damping * momentum.cross(&momentum.cross(&b))
        },
        methods(Midpoint),
    )]
    struct Spin { field: Vector3<f64>, easy: f64, damping: f64 }";

#[test]
fn a_damped_spin() {
    let mut runs = Runs::default();
    let spin = vector![1.0, 0.0, 0.1].normalize();
    let start = [&UPRIGHT[..4], spin.as_slice()].concat();
    let after = |scheme: &str, step: f64| {
        Motion::of(SPIN, &[0.0, 0.0, 1.0, 0.3, 0.1], &start).alone(scheme, step, 10.0)
    };
    let expected = [0.296_431_622, -0.336_115_815, 0.893_954_390];
    runs.all_close("spin", after("Order4<Midpoint<Cayley>>", 0.02).at("momentum"), &expected, 2e-9);
    // its length to rounding, whatever the step
    let length = Vector3::from_column_slice(after("Midpoint<Cayley>", 0.1).at("momentum")).norm();
    runs.close("length", length, 1.0, 2e-15);
    runs.assert();
}

/// A rod in a bath of heat: on each axis half of `kT`, however unlike its moments are.
const ROD: &str = "
    #[lie_poisson_system(group = SO3, control(noise: R3), force = noise - friction * velocity)]
    struct Rod { #[inertia] inertia: Vector3<f64>, friction: f64 }";

#[test]
fn brownian_rods_share_the_heat() {
    const STEP: f64 = 0.02;
    let mut runs = Runs::default();
    let (heat, friction, inertia) = (1.5, 0.5, [1.0, 2.0, 0.1]);
    let mut seed = 88_172_645_463_325_252_u64;
    let mut uniform = || {
        seed ^= seed << 13;
        seed ^= seed >> 7;
        seed ^= seed << 17;
        ((seed >> 11) as f64 + 0.5) / 2_f64.powi(53)
    };
    let size = (2.0 * friction * heat / STEP).sqrt();
    let mut noise = |_: &Vec<f64>, _: f64| {
        let mut normal = || (-2.0 * uniform().ln()).sqrt() * (std::f64::consts::TAU * uniform()).cos();
        vec![size * normal(), size * normal(), size * normal()]
    };
    let mut rod = Motion::of(ROD, &[&inertia[..], &[friction]].concat(), &UPRIGHT);
    let scheme = "Exponential".parse().expect("a scheme");
    let mut stepper = Stepper::new(rod.system.clone(), &scheme, STEP).expect("a stepper");
    let (mut sums, mut count) = ([0.0; 3], 0.0);
    let add = |tick: &coadjoint::Tick<'_, dyn System>| {
        count += 1.0;
        sums.iter_mut().zip(&tick.state[4..]).for_each(|(sum, p)| *sum += p * p);
    };
    Run::new(&mut stepper, &mut rod.state)
        .controlled_by(&mut noise)
        .each(add)
        .steps(1_000_000)
        .expect("steps");
    for (sum, inertia) in sums.iter().zip(inertia) {
        // of 10⁴ samples that know nothing of one another, or of half as many
        runs.close(format!("about the axis of {inertia}"), sum / count / inertia / heat, 1.0, 0.06);
    }
    runs.assert();
}

/// A body, a top, a pair on a spring of torsion and a mass that slides, each the same from molecules to stars.
const SIZED: [(&str, &str); 4] = [
    ("body", "#[lie_poisson_system(group = SO3)] struct Body { #[inertia] inertia: Vector3<f64> }"),
    (
        "top",
        "#[lie_poisson_system(group = SO3, advected(up: R3), potential = weight * up.z)]
        struct Top { #[inertia] inertia: Vector3<f64>, weight: f64 }",
    ),
    (
        "pair",
        "#[lie_poisson_system(group(first: SO3, second: SO3), potential = -weight * (first * Vector3::z()).dot(&(second * Vector3::z())))]
        struct Pair { #[inertia(first)] inertia: Vector3<f64>, #[inertia(second)] other: Vector3<f64>, weight: f64 }",
    ),
    (
        "slider",
        "#[lie_poisson_system(group(attitude: SO3, slider: R3), lagrangian = {
            let v = slider_velocity + attitude_velocity.cross(&slider);
            0.5 * attitude_velocity.dot(&attitude_velocity.component_mul(&inertia)) + 0.5 * mass * v.norm_squared()
                - 0.5 * stiffness * slider.norm_squared()
        })]
        struct Slider { inertia: Vector3<f64>, mass: f64, stiffness: f64 }",
    ),
];

#[test]
fn sizes_make_no_difference() {
    let mut runs = Runs::default();
    for (name, text) in SIZED {
        let end = |scheme: &str, unit: f64, rate: f64| {
            let (weight, momentum) = (unit * rate * rate, [0.1, 2.0, 0.1].map(|p| p * unit * rate));
            let inertia = [1.0, 2.0, 2.5].map(|j| j * unit);
            let start = |rest: &[f64]| [&UPRIGHT[..4], &momentum[..], rest].concat();
            let (parameters, start) = match name {
                "body" => (inertia.to_vec(), start(&[])),
                "top" => ([&inertia[..], &[weight]].concat(), start(&[0.6, 0.0, 0.8])),
                "pair" => ([&inertia[..], &inertia[..], &[weight]].concat(), {
                    let second = UnitQuaternion::new(vector![0.1, 0.2, 0.3]);
                    start(&[second.w, second.i, second.j, second.k, 0.0, 0.0, 0.0])
                }),
                _ => (
                    [&inertia[..], &[0.3 * unit, 1.2 * weight]].concat(),
                    start(&[0.1, 0.2, 0.0, 0.0, 0.0, 0.0]),
                ),
            };
            let end = Motion::of(text, &parameters, &start).alone(scheme, 0.05 / rate, 20.0 / rate);
            end.state[4..7].iter().map(|p| p / (unit * rate)).collect::<Vec<f64>>()
        };
        for scheme in ["Exponential", "Cayley"] {
            let expected = end(scheme, 1.0, 1.0);
            for (unit, rate) in [
                (1e-9, 10.0),
                (1e-30, 1e5),
                (1e-47, 1e13),
                (1e-80, 1.0),
                (8e37, 7.3e-5),
                (1e47, 1e-6),
                (1e80, 1.0),
            ] {
                runs.all_close(
                    format!("{name}, {scheme}, {unit:e}"),
                    &end(scheme, unit, rate),
                    &expected,
                    2e-12,
                );
            }
        }
    }
    runs.assert();
}

/// A body with the numbers of small processors, from grains to ships.
#[lie_poisson_system(group = SO3, methods(Midpoint))]
struct Single {
    #[inertia]
    inertia: Vector3<f32>,
}

#[test]
fn bodies_in_single_precision() {
    fn kept<M>(runs: &mut Runs, unit: f32, step: f32, rate: f32)
    where
        Single: coadjoint::Discretized<M>,
    {
        let inertia = vector![1.0, 2.0, 2.5] * unit;
        let body = Single { inertia };
        let momentum = vector![0.5, 1.0, 0.3].component_mul(&inertia) * rate;
        let mut state = SingleState { attitude: UnitQuaternion::identity(), momentum };
        let energy = body.energy(&state);
        let mut stepper = body.stepper::<M>(step).expect("a stepper");
        Run::new(&mut stepper, &mut state).steps(200_000).expect("steps");
        let what = format!("{}, {unit:e} kg m²", std::any::type_name::<M>());
        let ratios = [state.momentum.norm() / momentum.norm(), body.energy(&state) / energy];
        runs.all_close(&what, &ratios.map(f64::from), &[1.0; 2], 1e-4);
        let off = (state.attitude * state.momentum - momentum).norm() / momentum.norm();
        runs.close(format!("{what}, in space"), f64::from(off), 0.0, 1e-3);
        runs.close(&what, f64::from(state.attitude.as_ref().norm()), 1.0, 2e-7);
    }
    let mut runs = Runs::default();
    for (unit, step, rate) in
        [(1.0, 1e-3, 5.0), (1e-5, 1e-3, 35.0), (1e-9, 1e-4, 100.0), (1e-15, 1e-6, 1000.0), (1e14, 1e-2, 0.1)]
    {
        kept::<Exponential>(&mut runs, unit, step, rate);
        kept::<Cayley>(&mut runs, unit, step, rate);
        kept::<Midpoint<Cayley>>(&mut runs, unit, step, rate);
    }
    runs.assert();
}
