//! Systems described by a Lagrangian: the same steps as by the Hamiltonian that belongs to it, with 71 digits and in doubles, and the motion that
//! Newton's and Euler's laws say, written in another way.

use coadjoint::composition::Order6;
use coadjoint::nalgebra::{Matrix3, SMatrix, SVector, Vector1, Vector3, Vector6};
use coadjoint::prelude::*;
use coadjoint::{Discretized, LegendreError, System};
use coadjoint_codegen::expr::{Arena, Vector};
use coadjoint_codegen::group::Retraction;
use coadjoint_codegen::method::family;
use coadjoint_codegen::scheme::Member;
use coadjoint_support::precise::descriptions::{Description, random_point};
use coadjoint_support::precise::matrix::Column;
use coadjoint_support::precise::newton::Solver;
use coadjoint_support::precise::real::Real;
use coadjoint_support::precise::residuals::Residuals;
use quote::quote;

use crate::reference::reference;

/// Systems by their Lagrangian and by the energy that belongs to it, inverted by hand.
fn pairs() -> Vec<[Description; 2]> {
    let top = quote! { struct Top { #[inertia] inertia: Vector3<f64>, chi: Vector3<f64> } };
    let quadrotor = |attitude, position| {
        quote! {
            struct Quadrotor { #[inertia #attitude] inertia: Vector3<f64>, #[inertia #position] mass: f64, gravity: f64 }
        }
    };
    let forces = quote! {
        group(attitude: SO3, position: R3),
        control(moment: R3, thrust: f64),
        force(attitude = moment - attitude_velocity / 4.0, position = attitude * (thrust * Vector3::z()))
    };
    let double = quote! { struct Double { ratio: f64, weight: f64 } };
    let slider = quote! {
        struct Body { #[inertia] inertia: Vector3<f64>, #[inertia] mass: f64, direction: Vector3<f64>, stiffness: f64 }
    };
    vec![
        [
            Description::new(
                "top by its lagrangian",
                quote! {
                    group = SO3, advected(gamma: R3),
                    lagrangian = velocity.dot(&velocity.component_mul(&inertia)) / 2.0 - gamma.dot(&chi).sin()
                },
                top.clone(),
            ),
            Description::new(
                "top",
                quote! { group = SO3, advected(gamma: R3), potential = gamma.dot(&chi).sin() },
                top,
            ),
        ],
        [
            Description::new(
                "quadrotor by its lagrangian",
                quote! {
                    #forces,
                    lagrangian = (attitude_velocity.dot(&attitude_velocity.component_mul(&inertia))
                        + mass * position_velocity.norm_squared()) / 2.0 - mass * gravity * position.z
                },
                quadrotor(quote! {}, quote! {}),
            ),
            Description::new(
                "quadrotor",
                quote! { #forces, potential = mass * gravity * position.z },
                quadrotor(quote! { (attitude) }, quote! { (position) }),
            ),
        ],
        [
            Description::new(
                "double pendulum by its lagrangian",
                quote! {
                    group(angles: R2),
                    lagrangian = {
                        let w = angles_velocity;
                        w.x.powi(2) + w.y.powi(2) / 2.0 + w.x * w.y * ratio * (angles.x - angles.y).cos()
                            + weight * (2.0 * angles.x.cos() + angles.y.cos())
                    }
                },
                double.clone(),
            ),
            Description::new(
                "double pendulum",
                quote! {
                    group(angles: R2),
                    hamiltonian = {
                        let (p, c) = (angles_momentum, ratio * (angles.x - angles.y).cos());
                        (p.x.powi(2) / 2.0 - c * p.x * p.y + p.y.powi(2)) / (2.0 - c * c)
                            - weight * (2.0 * angles.x.cos() + angles.y.cos())
                    }
                },
                double,
            ),
        ],
        [
            Description::new(
                "moving mass by its lagrangian",
                quote! {
                    group(attitude: SO3, slider: R1),
                    lagrangian = {
                        let at = slider.x * direction;
                        let v = attitude_velocity.cross(&at) + slider_velocity.x * direction;
                        (attitude_velocity.dot(&attitude_velocity.component_mul(&inertia)) + mass * v.norm_squared()) / 2.0
                            - stiffness * slider.x.powi(2)
                    }
                },
                slider.clone(),
            ),
            Description::new(
                "moving mass",
                quote! {
                    group(attitude: SO3, slider: R1),
                    hamiltonian = {
                        let at = slider.x * direction;
                        let body = Matrix3::from_diagonal(&inertia)
                            + mass * (Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 1.0)) * at.norm_squared() - at * at.transpose());
                        attitude_momentum.dot(&(body.try_inverse().unwrap() * attitude_momentum)) / 2.0
                            + slider_momentum.x.powi(2) / (2.0 * mass * direction.norm_squared())
                            + stiffness * slider.x.powi(2)
                    }
                },
                slider,
            ),
        ],
    ]
}

/// The state after a step, and the energy and the velocity at its start.
fn step_of(description: &Description, retraction: Retraction, s: Member, seed: u64) -> [Column; 3] {
    let arena = Arena::new();
    let system = description.system(&arena);
    let step = family::step(&arena, &system, retraction, s);
    let mut point = random_point(&system, seed);
    point.set(&Vector(vec![step.h]).symbols(), &Column(vec![Real::ratio(1, 10)]));
    let solver = Solver::new(&step);
    let next = solver.next(&solver.solve(&point));
    [next, Column(vec![point.scalar(system.energy())]), point.vector(&system.velocity())]
}

#[test]
fn steps_are_those_of_the_hamiltonian() {
    let mut residuals = Residuals::new();
    for (seed, [lagrangian, hamiltonian]) in (7..).zip(pairs()) {
        for retraction in Retraction::ALL {
            for (numerator, denominator) in [(0, 1), (1, 4), (1, 2), (3, 4), (1, 1)] {
                let s = Member::new(numerator, denominator).expect("between 0 and 1");
                let [ours, theirs] =
                    [&lagrangian, &hamiltonian].map(|description| step_of(description, retraction, s, seed));
                for (what, (ours, theirs)) in
                    ["step", "energy", "velocity"].iter().zip(ours.iter().zip(&theirs))
                {
                    residuals.agree(&format!("{}: {what}", hamiltonian.name), ours, theirs, 2e-70);
                }
            }
        }
    }
}

/// A mass that a spring holds at the middle of a rod through a body in space.
#[lie_poisson_system(
    group(attitude: SO3, slider: R1),
    lagrangian = {
        let at = slider.x * direction;
        let v = attitude_velocity.cross(&at) + slider_velocity.x * direction;
        attitude_velocity.dot(&attitude_velocity.component_mul(&inertia)) / 2.0 + mass * v.norm_squared() / 2.0
            - stiffness * slider.x.powi(2) / 2.0
    },
)]
struct Shaker {
    inertia: Vector3<f64>,
    mass: f64,
    direction: Vector3<f64>,
    stiffness: f64,
}

/// Two rods, the first about a fixed point, the second at its end; attitudes of both, with the moments about fixed point and centre of mass.
#[lie_poisson_system(
    group(first: SO3, second: SO3),
    lagrangian = {
        let joint = first * first_velocity.cross(&(length * Vector3::z()));
        let centre = joint + second * second_velocity.cross(&(half * Vector3::z()));
        first_velocity.dot(&first_velocity.component_mul(&first_inertia)) / 2.0
            + second_velocity.dot(&second_velocity.component_mul(&second_inertia)) / 2.0
            + mass * centre.norm_squared() / 2.0
            - weight * (first * Vector3::z()).z
            - mass * gravity * (length * (first * Vector3::z()).z + half * (second * Vector3::z()).z)
    },
)]
struct Rods {
    first_inertia: Vector3<f64>,
    second_inertia: Vector3<f64>,
    length: f64,
    half: f64,
    mass: f64,
    weight: f64,
    gravity: f64,
}

/// `q'` of an attitude `q` that turns with a velocity in the body.
fn turning(q: &[f64], velocity: &Vector3<f64>) -> [f64; 4] {
    let q = coadjoint::nalgebra::Quaternion::new(q[0], q[1], q[2], q[3]);
    let change = q * coadjoint::nalgebra::Quaternion::from_imag(*velocity) * 0.5;
    [change.w, change.i, change.j, change.k]
}

/// The slope of the error against the step, and the smallest error; `error` of a number of steps.
fn order(counts: [u32; 3], error: impl Fn(u32) -> f64) -> (f64, f64) {
    let errors = counts.map(error);
    println!("{errors:?}");
    let ratio = f64::from(counts[2]) / f64::from(counts[0]);
    ((errors[0] / errors[2]).ln() / ratio.ln(), errors[2])
}

/// After a time, by steps of a scheme.
fn after<S, M>(system: &S, start: &S::State, time: f64, steps: u32) -> Vec<f64>
where
    S: System<Scalar = f64> + Discretized<M>,
{
    let mut state = start.clone();
    let mut stepper = system.stepper::<M>(time / f64::from(steps)).expect("a stepper");
    for _ in 0..steps {
        stepper.step(&mut state).expect("a step");
    }
    state.to_components().as_ref().to_vec()
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn a_body_with_a_moving_mass_obeys_newton_and_euler() {
    let shaker = Shaker {
        inertia: vector![1.0, 1.4, 2.0],
        mass: 0.6,
        direction: vector![0.6, 0.0, 0.8],
        stiffness: 5.0,
    };
    let rest = ShakerState {
        attitude: UnitQuaternion::identity(),
        attitude_momentum: Vector3::zeros(),
        slider: Vector1::new(0.3),
        slider_momentum: Vector1::zeros(),
    };
    let velocity = vector![0.4, 1.1, -0.7, 0.5];
    let start = shaker.with_velocity(&rest, &velocity).expect("a momentum");
    assert!((shaker.velocity(&start) - velocity).norm() < 1e-14);

    // Π = 𝓘ω + m r × (ω × r) in the body, and the mass on its rod by Newton's law along it: m (s'' − s |ω × d|²) = −k s
    let along = |s: f64| {
        let at = shaker.direction * s;
        Matrix3::from_diagonal(&shaker.inertia)
            + (Matrix3::identity() * at.norm_squared() - at * at.transpose()) * shaker.mass
    };
    let field = |y: &SVector<f64, 9>| {
        let (momentum, s, speed) = (Vector3::new(y[4], y[5], y[6]), y[7], y[8]);
        let omega = along(s).lu().solve(&momentum).expect("an inertia");
        let q = turning(&y.as_slice()[..4], &omega);
        let turned = momentum.cross(&omega);
        let pulled = s * omega.cross(&shaker.direction).norm_squared() - shaker.stiffness / shaker.mass * s;
        SVector::from([q[0], q[1], q[2], q[3], turned.x, turned.y, turned.z, speed, pulled])
    };
    let Vector3 { data, .. } = start.attitude_momentum;
    let [m] = data.0;
    let y = SVector::from([1.0, 0.0, 0.0, 0.0, m[0], m[1], m[2], 0.3, 0.5]);
    let time = 2.0;
    let y = reference(&y, time, 250, field);
    // in the order of the state: attitude, its momentum, the slider, its momentum
    let expected = [y[0], y[1], y[2], y[3], y[4], y[5], y[6], y[7], shaker.mass * y[8]];
    let expected = [&expected[..4], &expected[4..7], &expected[7..]].concat();
    let error = |state: Vec<f64>| distance(&state, &expected);

    let (slope, _) =
        order([40, 80, 160], |steps| error(after::<_, Exponential>(&shaker, &start, time, steps)));
    assert!((slope - 2.0).abs() < 0.05, "{slope}");
    let (slope, _) = order([40, 80, 160], |steps| error(after::<_, Cayley>(&shaker, &start, time, steps)));
    assert!((slope - 2.0).abs() < 0.05, "{slope}");
    let (slope, smallest) =
        order([20, 40, 80], |steps| error(after::<_, Order6<Exponential>>(&shaker, &start, time, steps)));
    assert!((slope - 6.0).abs() < 0.4 && smallest < 1e-8, "{slope}, {smallest:e}");
}

#[test]
fn a_spherical_double_pendulum_obeys_newton_and_euler() {
    let rods = Rods {
        first_inertia: vector![0.5, 0.5, 0.02],
        second_inertia: vector![0.1, 0.1, 0.01],
        length: 1.0,
        half: 0.4,
        mass: 0.8,
        weight: 3.0,
        gravity: 9.81,
    };
    let hanging = |x: f64, y: f64| UnitQuaternion::from_euler_angles(std::f64::consts::PI + x, y, 0.0);
    let rest = RodsState {
        first: hanging(0.5, 0.2),
        first_momentum: Vector3::zeros(),
        second: hanging(-0.4, 0.6),
        second_momentum: Vector3::zeros(),
    };
    let velocity = vector![0.3, -0.5, 0.8, 0.4, 0.9, -0.2];
    let start = rods.with_velocity(&rest, &velocity).expect("a momentum");

    // each rod by Euler's law, and the force F of the joint on the first one by the second one's centre of mass
    let field = |y: &SVector<f64, 14>| {
        let rotation = |q: &[f64]| {
            UnitQuaternion::new_unchecked(coadjoint::nalgebra::Quaternion::new(q[0], q[1], q[2], q[3]))
        };
        let (r1, r2) = (rotation(&y.as_slice()[..4]), rotation(&y.as_slice()[4..8]));
        let (w1, w2) = (Vector3::new(y[8], y[9], y[10]), Vector3::new(y[11], y[12], y[13]));
        let [r1, r2] = [r1, r2].map(|r| r.to_rotation_matrix().into_inner());
        let (l, c) = (Vector3::z() * rods.length, Vector3::z() * rods.half);
        let down = -Vector3::z();
        let (j1, j2) =
            (Matrix3::from_diagonal(&rods.first_inertia), Matrix3::from_diagonal(&rods.second_inertia));
        let mut matrix = SMatrix::<f64, 9, 9>::zeros();
        let mut right = SVector::<f64, 9>::zeros();
        // 𝓘₁ω₁' = 𝓘₁ω₁ × ω₁ + weight e₃ × R₁ᵀ(−e₃) + l × R₁ᵀF
        matrix.fixed_view_mut::<3, 3>(0, 0).copy_from(&j1);
        matrix.fixed_view_mut::<3, 3>(0, 6).copy_from(&(-l.cross_matrix() * r1.transpose()));
        let gravity = Vector3::z().cross(&(r1.transpose() * down)) * rods.weight;
        right.fixed_rows_mut::<3>(0).copy_from(&((j1 * w1).cross(&w1) + gravity));
        // 𝓘₂ω₂' = 𝓘₂ω₂ × ω₂ + (−c) × R₂ᵀ(−F)
        matrix.fixed_view_mut::<3, 3>(3, 3).copy_from(&j2);
        matrix.fixed_view_mut::<3, 3>(3, 6).copy_from(&(-c.cross_matrix() * r2.transpose()));
        right.fixed_rows_mut::<3>(3).copy_from(&(j2 * w2).cross(&w2));
        // m (joint's acceleration + R₂(ω₂' × c + ω₂ × (ω₂ × c))) = m g − F
        matrix.fixed_view_mut::<3, 3>(6, 0).copy_from(&(-(r1 * l.cross_matrix()) * rods.mass));
        matrix.fixed_view_mut::<3, 3>(6, 3).copy_from(&(-(r2 * c.cross_matrix()) * rods.mass));
        matrix.fixed_view_mut::<3, 3>(6, 6).copy_from(&Matrix3::identity());
        let centripetal = r1 * w1.cross(&w1.cross(&l)) + r2 * w2.cross(&w2.cross(&c));
        right.fixed_rows_mut::<3>(6).copy_from(&((down * rods.gravity - centripetal) * rods.mass));
        let solution = matrix.lu().solve(&right).expect("two rods");
        let (q1, q2) = (turning(&y.as_slice()[..4], &w1), turning(&y.as_slice()[4..8], &w2));
        SVector::from_iterator(q1.into_iter().chain(q2).chain(solution.iter().take(6).copied()))
    };
    let coordinates = |q: &UnitQuaternion<f64>| [q.w, q.i, q.j, q.k];
    let y =
        coordinates(&rest.first).into_iter().chain(coordinates(&rest.second)).chain(velocity.iter().copied());
    let time = 1.0;
    let y = reference(&SVector::from_iterator(y), time, 500, field);
    // the same coordinates from a state: attitudes and velocities
    let error = |state: Vec<f64>| {
        let components: [f64; 14] = state.try_into().expect("two attitudes and momenta");
        let state = RodsState::from_components(&components);
        let attitudes = coordinates(&state.first).into_iter().chain(coordinates(&state.second));
        let all: Vec<f64> = attitudes.chain(rods.velocity(&state).iter().copied()).collect();
        distance(&all, y.as_slice())
    };
    let (slope, _) =
        order([80, 160, 320], |steps| error(after::<_, Exponential>(&rods, &start, time, steps)));
    assert!((slope - 2.0).abs() < 0.1, "{slope}");
    let (slope, smallest) =
        order([40, 80, 160], |steps| error(after::<_, Order6<Exponential>>(&rods, &start, time, steps)));
    assert!((slope - 6.0).abs() < 0.5 && smallest < 1e-6, "{slope}, {smallest:e}");
}

/// A point whose momentum is that of special relativity, in units of the speed of light.
#[lie_poisson_system(
    group = R2,
    lagrangian = -mass * (1.0 - velocity.norm_squared()).sqrt() - stiffness * position.norm_squared() / 2.0,
)]
struct Relativistic {
    mass: f64,
    stiffness: f64,
}

/// A point that has no mass where it starts.
#[lie_poisson_system(group = R1, lagrangian = position.x * velocity.x.powi(2) / 2.0)]
struct Growing {}

#[test]
fn velocities_without_a_closed_form_are_found() {
    let point = Relativistic { mass: 2.0, stiffness: 1.0 };
    let rest = RelativisticState { position: vector![0.3, -0.1], momentum: vector![0.0, 0.0] };
    for velocity in [vector![0.0, 0.0], vector![1e-9, 0.0], vector![0.3, -0.6], vector![0.9, 0.43]] {
        let state = point.with_velocity(&rest, &velocity).expect("slower than light");
        let gamma = 1.0 / (1.0 - velocity.norm_squared()).sqrt();
        assert!((state.momentum - velocity * (2.0 * gamma)).norm() <= 1e-14 * state.momentum.norm());
        let back = point
            .velocity_of(&state.momentum, &rest, 0.0, &Default::default())
            .expect("every momentum has one");
        assert!((back - velocity).norm() <= 1e-14 * velocity.norm(), "{velocity}: {back}");
        let energy = 2.0 * gamma + rest.position.norm_squared() / 2.0;
        assert!((point.energy(&state) - energy).abs() < 1e-14 * energy);
    }
    assert!(matches!(
        point.momentum_of(&vector![1.0, 0.0], &rest, 0.0, &Default::default()),
        Err(LegendreError { .. })
    ));
}

/// Though no closed form tells where to begin.
#[test]
fn newtons_iteration_begins_where_earlier_solutions_point() {
    let point = Relativistic { mass: 2.0, stiffness: 1.0 };
    let rest = RelativisticState { position: vector![0.3, -0.1], momentum: vector![0.0, 0.0] };
    let mut state = point.with_velocity(&rest, &vector![0.1, 0.4]).expect("slower than light");
    let mut stepper = point.stepper::<Exponential>(0.02).expect("a stepper");
    let each: Vec<u32> = (0..221).map(|_| stepper.step(&mut state).expect("a step").iterations).collect();
    // but where the rate of convergence is measured: twice
    let more = each[21..].iter().filter(|iterations| **iterations > 2).count();
    assert!(each[0] > 3 && more <= 2 && each.iter().all(|iterations| *iterations <= each[0]), "{each:?}");
}

/// Two rods in a plane, of a metre and with a kilogram at each end.
#[lie_poisson_system(
    group(first: SO2, second: SO2),
    lagrangian = {
        let (upper, lower) = (first_velocity.x, second_velocity.x);
        let between = first.inverse() * second;
        upper.powi(2) + lower.powi(2) / 2.0 + upper * lower * between.cos_angle()
            + gravity * (2.0 * first.cos_angle() + second.cos_angle())
    },
)]
struct Pendulums {
    gravity: f64,
}

/// Steps so large that their equation has several solutions: what is remembered does not choose among them.
#[test]
fn warm_and_cold_steps_of_newtons_method_are_the_same() {
    let rods = Pendulums { gravity: 9.81 };
    for step in [0.021, 0.025, 0.029] {
        let new = || rods.stepper::<SymplecticEulerA<Exponential>>(step).expect("a stepper");
        let (first, second) =
            (UnitComplex::new(100_f64.to_radians()), UnitComplex::new(150_f64.to_radians()));
        let (mut state, mut stepper) = (PendulumsState { first, second, ..Default::default() }, new());
        for count in 0..4_000 {
            let mut cold = state;
            new().step(&mut cold).expect("a step");
            stepper.step(&mut state).expect("a step");
            let away = distance(&state.to_components(), &cold.to_components());
            assert!(away < 1e-13, "{count} steps of {step}: {away:e}");
        }
        assert!((rods.energy(&state) - 11.9).abs() < 2.0, "{step}: {}", rods.energy(&state));
    }
}

#[test]
fn a_singular_transform_is_an_error() {
    let (growing, momentum) = (Growing {}, vector![1.0]);
    let state = GrowingState { position: vector![0.0], momentum };
    assert!(matches!(
        growing.velocity_of(&momentum, &state, 0.0, &Default::default()),
        Err(LegendreError { .. })
    ));
    let kept = state;
    let mut state = state;
    let mut stepper = growing.stepper::<Cayley>(0.1).expect("a stepper");
    assert!(stepper.step(&mut state).is_err());
    assert_eq!(state, kept);
    // a momentum for the velocity is there, and elsewhere all is well
    assert_eq!(growing.momentum_of(&momentum, &state, 0.0, &Default::default()), Ok(vector![0.0]));
    let state = GrowingState { position: vector![2.0], momentum };
    assert_eq!(growing.velocity_of(&momentum, &state, 0.0, &Default::default()), Ok(vector![0.5]));
}

/// Momenta of six components in one piece, and a state by its velocity.
#[test]
fn velocities_and_momenta_have_the_order_of_the_factors() {
    let rods = Rods {
        first_inertia: vector![1.0, 2.0, 3.0],
        second_inertia: vector![4.0, 5.0, 6.0],
        length: 0.0,
        half: 0.0,
        mass: 1.0,
        weight: 0.0,
        gravity: 0.0,
    };
    let state = RodsState {
        first: UnitQuaternion::identity(),
        first_momentum: vector![1.0, 2.0, 3.0],
        second: UnitQuaternion::identity(),
        second_momentum: vector![4.0, 5.0, 6.0],
    };
    assert_eq!(rods.momentum(&state), Vector6::new(1.0, 2.0, 3.0, 4.0, 5.0, 6.0));
    assert_eq!(rods.velocity(&state), Vector6::repeat(1.0));
    let twice = rods.with_velocity(&state, &Vector6::repeat(2.0)).expect("a momentum");
    assert_eq!(
        twice,
        RodsState {
            first_momentum: vector![2.0, 4.0, 6.0],
            second_momentum: vector![8.0, 10.0, 12.0],
            ..state
        }
    );
}
