//! What is known from elsewhere of the systems on other groups than the rotations, on the right side, and of two bodies.

use coadjoint::SchemeType;
use coadjoint::prelude::*;
use coadjoint_app::Example;
use coadjoint_systems::ellipsoidal_fluid::{EllipsoidalFluid, EllipsoidalFluidState};
use coadjoint_systems::free_rigid_body::{FreeRigidBody, FreeRigidBodyState};
use coadjoint_systems::hanging_plate::{HangingPlate, HangingPlateState};
use coadjoint_systems::heavy_top::HeavyTop;
use coadjoint_systems::heavy_top_on_se3::{HeavyTopOnSE3, HeavyTopOnSE3State};
use coadjoint_systems::kepler::{Kepler, KeplerState};
use coadjoint_systems::nuclear_spin::{NuclearSpin, NuclearSpinState};
use coadjoint_systems::two_bodies::{TwoBodies, TwoBodiesState};

use crate::physics::{after, drift, motion};

#[test]
fn two_bodies_keep_their_momenta_and_their_centre_moves_uniformly() {
    fn check<M: SchemeType>() {
        let (bodies, start) = TwoBodies::example();
        let drifting = vector![1e-4, -2e-4, 5e-5];
        let start = TwoBodiesState {
            first_momentum: start.first_momentum + drifting * bodies.first_mass,
            second_momentum: start.second_momentum + drifting * bodies.second_mass,
            ..start
        };
        let states = motion::<_, M>(&bodies, &start, 100.0, 2_000);
        let total = |state: &TwoBodiesState| (state.first_momentum + state.second_momentum).into();
        assert!(drift(&states, total) < 1e-14);
        assert!(drift(&states, |state| TwoBodies::angular_momentum(state).into()) < 1e-12);
        // (1.14)
        for (k, state) in states.iter().enumerate() {
            let expected = bodies.centre(&start) + drifting * (100.0 * k as f64);
            assert!((bodies.centre(state) - expected).norm() < 1e-10);
        }
    }
    check::<Exponential>();
    check::<Midpoint>();
    check::<SymplecticEulerA<Cayley>>();
}

/// (1.15): the distance is that of a satellite of both masses.
#[test]
fn two_bodies_move_about_each_other_as_a_satellite_does() {
    let (bodies, start) = TwoBodies::example();
    let reduced = bodies.first_mass * bodies.second_mass / (bodies.first_mass + bodies.second_mass);
    let satellite =
        Kepler { mass: reduced, attraction: bodies.gravitation * (bodies.first_mass + bodies.second_mass) };
    let relative = KeplerState {
        position: start.second - start.first,
        momentum: (start.second_momentum / bodies.second_mass - start.first_momentum / bodies.first_mass)
            * reduced,
    };
    // the steps themselves agree, as the method is linear in what is split off
    let two = motion::<_, Exponential>(&bodies, &start, 100.0, 1_000);
    let one = motion::<_, Exponential>(&satellite, &relative, 100.0, 1_000);
    for (two, one) in two.iter().zip(&one) {
        assert!((two.second - two.first - one.position).norm() < 1e-11);
    }
    // (1.16) is the energy of both
    assert!((bodies.energy(&start) - satellite.energy(&relative)).abs() < 1e-15);
    let end = after::<_, Order8<Exponential>>(&bodies, &start, bodies.period(2.0), 1_000);
    assert!((end.first - start.first).norm() < 1e-6 && (end.second - start.second).norm() < 1e-6, "{end:?}");
}

#[test]
fn a_top_on_se3_moves_as_a_top_and_keeps_what_it_should() {
    let (top, start) = HeavyTopOnSE3::example();
    let reduced = HeavyTop { inertia: top.inertia, weight: top.weight, chi: top.chi };
    let (attitude, momentum) = (start.pose.rotation, start.momentum.fixed_rows::<3>(0).into_owned());
    let states = motion::<_, Exponential>(&top, &start, 0.01, 6_000);
    let end = after::<_, Exponential>(&reduced, &HeavyTop::start(attitude, momentum), 60.0, 6_000);
    let last = &states[6_000];
    assert!((last.momentum.fixed_rows::<3>(0) - end.momentum).norm() < 1e-10);
    assert!((last.momentum.fixed_rows::<3>(3) - end.gamma).norm() < 1e-10);
    // the vertical in space, and the angular momentum with what the weight has taken of it
    let in_space = |state: &HeavyTopOnSE3State| {
        let turned = |at: usize| state.pose.rotation * state.momentum.fixed_rows::<3>(at).into_owned();
        let (momentum, vertical) = (turned(0), turned(3));
        let kept = momentum + state.pose.translation.vector.cross(&vertical);
        [vertical.x, vertical.y, vertical.z, kept.x, kept.y, kept.z]
    };
    assert!(drift(&states, in_space) < 1e-12);
    assert!(last.pose.translation.vector.z > 1.0, "x is no constant");
}

#[test]
fn a_plate_that_hangs_where_the_band_bears_its_weight_stays_there() {
    let (plate, _) = HangingPlate::example();
    let length = plate.length + plate.weight / plate.stiffness;
    // the centre of mass straight below the eye
    let angle = std::f64::consts::FRAC_PI_2 - plate.eye.y.atan2(plate.eye.x);
    let rest = HangingPlate::at_rest(vector![0.0, -length - plate.eye.norm()], angle);
    let states = motion::<_, Exponential>(&plate, &rest, 0.002, 5_000);
    let place = |state: &HangingPlateState| {
        let at = state.pose.translation.vector;
        [at.x, at.y, state.pose.rotation.angle()]
    };
    assert!(drift(&states, place) < 1e-10, "{}", drift(&states, place));
}

#[test]
fn a_plate_tied_at_its_centre_bounces_as_a_mass_and_turns_as_it_will() {
    let plate = HangingPlate { eye: Vector2::zeros(), ..HangingPlate::rectangle(0.2, 0.2, 0.1) };
    let bottom = -plate.length - plate.weight / plate.stiffness;
    let start = HangingPlateState {
        momentum: vector![plate.inertia.x * 3.0, 0.0, 0.0],
        ..HangingPlate::at_rest(vector![0.0, bottom - 0.02], 0.0)
    };
    let period = std::f64::consts::TAU * (plate.inertia.y / plate.stiffness).sqrt();
    for (part, place) in [(0.25, bottom), (0.5, bottom + 0.02), (1.0, bottom - 0.02)] {
        let state = after::<_, Order6<Exponential>>(&plate, &start, part * period, 200);
        let at = state.pose.translation.vector;
        assert!(at.x.abs() < 1e-12 && (at.y - place).abs() < 1e-10, "{part}: {state:?}");
        let turned = UnitComplex::new(3.0 * part * period);
        assert!((state.pose.rotation.inverse() * turned).angle().abs() < 1e-12, "{part}: {state:?}");
    }
}

#[test]
fn a_fluid_keeps_its_circulation_where_its_particles_are() {
    fn check<M: SchemeType>() {
        let (fluid, start) = EllipsoidalFluid::example();
        let states = motion::<_, M>(&fluid, &start, 0.02, 6_000);
        let size = start.momentum.norm();
        assert!(drift(&states, |state| EllipsoidalFluid::circulation(state).into()) < 1e-11 * size);
        // in space the vorticity goes elsewhere
        assert!(states.iter().any(|state| fluid.vorticity(state).y < 0.0));
    }
    check::<Exponential>();
    check::<Cayley>();
    check::<Midpoint>();
}

/// Helmholtz: `ζ' = (ζ·∇) v` with `v = A ω^ A⁻¹ x`, and the vorticity is the curl of that.
#[test]
fn the_vorticity_of_a_fluid_goes_with_its_flow() {
    let (fluid, start) = EllipsoidalFluid::example();
    let velocity = fluid.velocity(&start);
    let axes = Matrix3::from_diagonal(&fluid.semi_axes);
    let flow = axes * velocity.cross_matrix() * axes.try_inverse().expect("a vessel");
    let curl = vector![flow.m32 - flow.m23, flow.m13 - flow.m31, flow.m21 - flow.m12];
    assert!((fluid.vorticity(&start) - curl).norm() < 1e-14);
    let h = 1e-3;
    let at = |time: f64| fluid.vorticity(&after::<_, Order4<Exponential>>(&fluid, &start, time, 1));
    let rate = ((at(h) - at(-h)) * 8.0 - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h);
    assert!((rate - flow * curl).norm() < 1e-10, "{}", rate - flow * curl);
    // and the energy is that of the flow: of a ball of particles, |u|² is 3/5 on the average
    let energy = 0.5 * fluid.mass / 5.0 * (flow * axes).norm_squared();
    assert!((fluid.energy(&start) - energy).abs() < 1e-12 * energy);
}

#[test]
fn a_fluid_turns_as_a_rigid_body_backwards() {
    let (fluid, start) = EllipsoidalFluid::example();
    let body = FreeRigidBody { inertia: fluid.moments() };
    let turned = FreeRigidBodyState { attitude: start.attitude.inverse(), momentum: -start.momentum };
    let fluid_end: EllipsoidalFluidState = after::<_, Exponential>(&fluid, &start, 4.0, 200);
    let body_end = after::<_, Exponential>(&body, &turned, 4.0, 200);
    assert!((fluid_end.momentum + body_end.momentum).norm() < 1e-11 * start.momentum.norm());
    assert!((fluid_end.attitude * body_end.attitude).angle() < 1e-7);
}

#[test]
fn spins_in_resonance_are_turned_over_and_back() {
    let (spins, start) = NuclearSpin::example();
    let size = start.momentum.z;
    for (flips, along) in [(0.5, 0.0), (1.0, -1.0), (2.0, 1.0)] {
        let end = after::<_, Order4<Exponential>>(&spins, &start, flips * spins.flip(), 20_000);
        assert!((end.momentum.z / size - along).abs() < 1e-7, "{flips}: {}", end.momentum.z / size);
    }
}

/// Rabi: `U(t) = exp(½iωt σ₃) exp(½iγt ((B₀ − ω/γ) σ₃ + b σ₁))`, out of resonance too. After a whole turn in the turning axes it is −1 there.
#[test]
fn the_spins_states_are_those_of_rabi() {
    let resonant = NuclearSpin::in_resonance(5e-5, 5e-7);
    let detuned = NuclearSpin { frequency: 1.004 * resonant.frequency, ..resonant.clone() };
    for spins in [resonant, detuned] {
        let time = 2.0 * spins.flip();
        let along = spins.along_field - spins.frequency / spins.gyromagnetic_ratio;
        let turning = vector![spins.across_field, 0.0, along] * (-spins.gyromagnetic_ratio * time);
        // −i x·σ/2 is the pure quaternion x/2
        let exp = |x: Vector3<f64>| {
            let (sine, cosine) = (x.norm() / 2.0).sin_cos();
            Quaternion::from_parts(cosine, x.normalize() * sine)
        };
        let expected = exp(Vector3::z() * (-spins.frequency * time)) * exp(turning);
        let start = NuclearSpin::aligned(1.2e-14);
        let error = |steps: u64| {
            let end: NuclearSpinState = after::<_, Exponential>(&spins, &start, time, steps);
            (end.spin.into_inner() - expected).norm()
        };
        let (coarse, fine) = (error(20_000), error(40_000));
        assert!(coarse < 1e-3 && (3.9..4.1).contains(&(coarse / fine)), "{coarse} {fine}");
    }
}
