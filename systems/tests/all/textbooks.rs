//! Systems against the equations of their textbooks, which are typed here once more and integrated by other means.

use std::f64::consts::{PI, TAU};

use coadjoint::certify::certify_erased;
use coadjoint::nalgebra::{DVector, Matrix4, SMatrix, Vector6};
use coadjoint::prelude::*;
use coadjoint::{SchemeType, System};
use coadjoint_app::Example;
use coadjoint_app::setup::{Method, Order, Retraction};
use coadjoint_app::simulate::{scheme, states_in_motion};
use coadjoint_systems::affine_body::{AffineBody, AffineBodyState};
use coadjoint_systems::catalogue::CATALOGUE;
use coadjoint_systems::four_dimensional_body::{FourDimensionalBody, FourDimensionalBodyState};
use coadjoint_systems::navigation::{Navigation, NavigationControl, NavigationState};
use coadjoint_systems::satellite_with_wheels::{
    SatelliteWithWheels, SatelliteWithWheelsControl, SatelliteWithWheelsState,
};
use coadjoint_systems::spin_chain::{SpinChain, SpinChainState};

use crate::physics::{after, controlled, drift, motion};

/// What is compared: numbers of the textbook's own.
type Numbers = DVector<f64>;

/// A system beside its textbook.
struct Beside<'a, S: System> {
    system: &'a S,
    start: &'a S::State,
    /// Held all the time.
    control: S::Control,
    /// The textbook's numbers of a state.
    read: fn(&S, &S::State) -> Numbers,
    /// The textbook's equations.
    rate: &'a dyn Fn(&Numbers) -> Numbers,
    time: f64,
}

impl<S: Example> Beside<'_, S> {
    /// By RK4 and Richardson's extrapolation.
    fn exact(&self, steps: u32) -> Numbers {
        let integrated = |steps: u32| {
            let h = self.time / f64::from(steps);
            (0..steps).fold((self.read)(self.system, self.start), |x, _| {
                let k1 = (self.rate)(&x);
                let k2 = (self.rate)(&(&x + &k1 * (h / 2.0)));
                let k3 = (self.rate)(&(&x + &k2 * (h / 2.0)));
                let k4 = (self.rate)(&(&x + &k3 * h));
                x + (k1 + (k2 + k3) * 2.0 + k4) * (h / 6.0)
            })
        };
        let [coarse, fine] = [steps, 2 * steps].map(integrated);
        &fine + (&fine - coarse) / 15.0
    }

    fn error<M: SchemeType>(&self, exact: &Numbers, steps: u64) -> f64 {
        let step = self.time / steps as f64;
        let states = controlled::<S, M>(self.system, self.start, step, steps, |_, _| self.control.clone());
        ((self.read)(self.system, &states[steps as usize]) - exact).norm()
    }

    /// The orders of the standard scheme and of a composition of order 6, from so many steps.
    fn orders<R: SchemeType>(&self, exact: &Numbers, [second, sixth]: [u64; 2])
    where
        Order6<R>: SchemeType,
    {
        let order = |coarse: f64, fine: f64| (coarse / fine).log2();
        let standard = order(self.error::<R>(exact, second), self.error::<R>(exact, 2 * second));
        assert!((standard - 2.0).abs() < 0.05, "{standard}");
        let of_sixth = [sixth, 2 * sixth].map(|steps| self.error::<Order6<R>>(exact, steps));
        let composed = order(of_sixth[0], of_sixth[1]);
        assert!((composed - 6.0).abs() < 0.3, "{composed}: {of_sixth:?}");
    }
}

/// What the program certifies are steps of order 2; here are those of order 6 that are composed of them.
#[test]
fn compositions_of_order_six_keep_what_they_claim() {
    for (name, retraction) in [
        ("four_dimensional_body", Retraction::Cayley),
        ("affine_body", Retraction::Cayley),
        ("navigation", Retraction::Cayley),
        ("satellite_with_wheels", Retraction::Exponential),
        ("spin_chain", Retraction::Cayley),
    ] {
        let entry = CATALOGUE.find(name).expect("it is there");
        let scheme = scheme(Method::Standard, retraction, Order::Six).expect("symmetric");
        let setup = &entry.example;
        let (states, _) = states_in_motion(entry, setup).expect("solvable");
        let law = entry.law(setup);
        let control = |state: &Vec<f64>| {
            let mut control = vec![0.0; setup.controls.len()];
            law.as_ref().expect("controls").as_ref()(state, 0.0, &mut control);
            control
        };
        let controls: Vec<Vec<f64>> =
            if law.is_some() { states.iter().map(control).collect() } else { Vec::new() };
        let system = entry.system(&setup.parameters);
        let report = certify_erased(&*system, &scheme, &states, &controls, 0.0, entry.certified_step);
        let report = report.expect("measured");
        assert!(report.passed(), "{report}");
        assert!(report.certificates.len() >= 10, "{report}");
    }
}

/// `x^`: the matrix of the cross product.
fn hat(x: &[f64]) -> Matrix3<f64> {
    Vector3::from_column_slice(x).cross_matrix()
}

fn numbers<'a>(parts: impl IntoIterator<Item = &'a [f64]>) -> Numbers {
    DVector::from_vec(parts.into_iter().flatten().copied().collect())
}

/// `L` or `Ω` of its components 12, 13, 14, 23, 24, 34: positive from the first axis towards the second.
fn antisymmetric(x: &Vector6<f64>) -> Matrix4<f64> {
    let [a, b, c, d, e, f]: [f64; 6] = (*x).into();
    matrix![0.0, -a, -b, -c; a, 0.0, -d, -e; b, d, 0.0, -f; c, e, f, 0.0]
}

#[test]
fn a_body_of_four_dimensions_moves_as_manakov_says() {
    let (body, _) = FourDimensionalBody::example();
    let start = body.turning(Vector6::new(0.7, 0.9, -0.4, 0.3, 0.5, -0.6));
    let read = |_: &FourDimensionalBody, state: &FourDimensionalBodyState| {
        numbers([state.element.as_slice(), antisymmetric(&state.momentum).as_slice()])
    };
    // L = ΛΩ + ΩΛ entry by entry
    let moments = body.second_moments;
    let rate = |x: &Numbers| {
        let (element, momentum) = x.as_slice().split_at(16);
        let (element, momentum) = (Matrix4::from_column_slice(element), Matrix4::from_column_slice(momentum));
        let velocity = Matrix4::from_fn(|i, j| momentum[(i, j)] / (moments[i] + moments[j]));
        numbers([(element * velocity).as_slice(), (momentum * velocity - velocity * momentum).as_slice()])
    };
    let beside =
        Beside { system: &body, start: &start, control: NoControl::default(), read, rate: &rate, time: 2.0 };
    beside.orders::<Cayley>(&beside.exact(800), [40, 8]);
}

#[test]
fn a_body_of_four_dimensions_keeps_what_makes_it_integrable() {
    let (body, start) = FourDimensionalBody::example();
    let states = motion::<_, Cayley>(&body, &start, 0.02, 100_000);
    let in_space = |state: &FourDimensionalBodyState| {
        let momentum = state.element * antisymmetric(&state.momentum) * state.element.transpose();
        [(1, 0), (2, 0), (3, 0), (2, 1), (3, 1), (3, 2)].map(|place| momentum[place])
    };
    assert!(drift(&states, in_space) < 1e-11, "{}", drift(&states, in_space));
    let casimirs = |state: &FourDimensionalBodyState| body.casimirs(state);
    assert!(drift(&states, casimirs) < 1e-11, "{}", drift(&states, casimirs));
    let off = (states[100_000].element.tr_mul(&states[100_000].element) - Matrix4::identity()).norm();
    assert!(off < 1e-14, "{off}");
    // it turns over, both ways
    assert!(states.iter().any(|state| state.momentum[1] < -3.9));
    assert!(states[50_000..].iter().any(|state| state.momentum[1] > 3.9));
    // energy and Manakov's integral swing with the square of the step
    let error = |step: f64, steps: u64| {
        let states = motion::<_, Cayley>(&body, &start, step, steps);
        let of =
            |quantity: &dyn Fn(&FourDimensionalBodyState) -> f64| drift(&states, |state| [quantity(state)]);
        [of(&|state| body.energy(state)), of(&|state| body.manakov(state))]
    };
    for (coarse, fine) in error(0.04, 2_500).into_iter().zip(error(0.02, 5_000)) {
        assert!((3.8..4.2).contains(&(coarse / fine)), "{coarse} {fine}");
    }
}

/// `tr (L + zΛ²)³` is `−3z Σ (λᵢ² + λⱼ²) L_ij²` and what does not depend on `L`.
#[test]
fn manakovs_integral_is_that_of_his_matrix() {
    let (body, start) = FourDimensionalBody::example();
    let squares = Matrix4::from_diagonal(&body.second_moments.component_mul(&body.second_moments));
    let with = antisymmetric(&start.momentum) + squares;
    let cube = |matrix: Matrix4<f64>| (matrix * matrix * matrix).trace();
    let expected = (cube(squares) - cube(with)) / 3.0;
    assert!((body.manakov(&start) - expected).abs() < 1e-10, "{expected}");
}

/// `F` and `Ḟ` of a state.
fn deformation(body: &AffineBody, state: &AffineBodyState) -> (Matrix2<f64>, Matrix2<f64>) {
    let [a, b, c, d]: [f64; 4] = body.velocity(state).into();
    (state.element, state.element * Matrix2::new(a, b, c, d))
}

#[test]
fn a_body_of_rubber_moves_as_its_stress_says() {
    let (body, start) = AffineBody::example();
    let read = |body: &AffineBody, state: &AffineBodyState| {
        let (deformation, rate) = deformation(body, state);
        numbers([deformation.as_slice(), (rate / 100.0).as_slice()])
    };
    // J F̈ = −A (μ (F − F⁻ᵀ) + λ ln det F F⁻ᵀ)
    let area = PI * body.radius * body.radius;
    let moment = body.mass * body.radius * body.radius / 4.0;
    let rate = |x: &Numbers| {
        let (deformation, rate) = x.as_slice().split_at(4);
        let deformation = Matrix2::from_column_slice(deformation);
        let pulled = deformation.try_inverse().expect("not flat").transpose();
        let stress = (deformation - pulled) * body.shear_modulus
            + pulled * (body.lame_modulus * deformation.determinant().ln());
        let rate = Matrix2::from_column_slice(rate) * 100.0;
        numbers([rate.as_slice(), (stress * (-area / moment / 100.0)).as_slice()])
    };
    let beside =
        Beside { system: &body, start: &start, control: NoControl::default(), read, rate: &rate, time: 0.02 };
    beside.orders::<Cayley>(&beside.exact(2_000), [160, 16]);
}

#[test]
fn a_body_of_rubber_keeps_its_momenta_and_its_energy() {
    let (body, start) = AffineBody::example();
    let states = motion::<_, Cayley>(&body, &start, 2e-4, 100_000);
    let momenta =
        |state: &AffineBodyState| [AffineBody::angular_momentum(state), AffineBody::circulation(state)];
    assert!(momenta(&start)[0] > 0.04 && momenta(&start)[1] > 0.04, "{:?}", momenta(&start));
    assert!(drift(&states, momenta) < 1e-12, "{}", drift(&states, momenta));
    // as a textbook has them
    let last = &states[100_000];
    let (deformation, rate) = deformation(&body, last);
    let turning = deformation * rate.transpose() * body.moment();
    assert!((turning.m12 - turning.m21 - momenta(last)[0]).abs() < 1e-12, "{turning}");
    let dilation = deformation.determinant().ln();
    let strain = body.shear_modulus / 2.0 * (deformation.norm_squared() - 2.0 - 2.0 * dilation)
        + body.lame_modulus / 2.0 * dilation * dilation;
    let energy = body.moment() / 2.0 * rate.norm_squared() + PI * body.radius * body.radius * strain;
    assert!((energy - body.energy(last)).abs() < 1e-12, "{energy}");
    let error = drift(&states, |state| [body.energy(state)]);
    assert!(error < 1e-3 * energy, "{error} of {energy}");
}

#[test]
fn small_strains_have_the_frequencies_of_linear_elasticity() {
    let body = AffineBody::silicone();
    let (size, still) = (1e-6, Matrix2::zeros());
    let breathing = (size * Matrix2::identity(), body.breathing());
    let stretching = (matrix![size, 0.0; 0.0, -size], body.shearing());
    let shearing = (matrix![0.0, size; size, 0.0], body.shearing());
    for (strain, frequency) in [breathing, stretching, shearing] {
        let start = body.start(Matrix2::identity() + strain, still);
        // what is left of second order in the strain is 1e-12
        for (part, expected) in [(0.25, 0.0), (0.5, -1.0), (1.0, 1.0)] {
            let end = after::<_, Order6<Cayley>>(&body, &start, part * TAU / frequency, 40);
            let off = (end.element - Matrix2::identity() - strain * expected).norm();
            assert!(off < 2e-5 * size, "{part} of {strain}: {off}");
        }
    }
    // ω² = 2A (μ + λ)/J and 2Aμ/J
    let ratio = 2.0 * PI * body.radius.powi(2) / body.moment();
    assert!(
        (body.breathing().powi(2) / (ratio * (body.shear_modulus + body.lame_modulus)) - 1.0).abs() < 1e-14
    );
    assert!((body.shearing().powi(2) / (ratio * body.shear_modulus) - 1.0).abs() < 1e-14);
}

/// The costates of velocity and position in space; that of the attitude is the vehicle's.
fn costates(state: &NavigationState) -> [Vector3<f64>; 3] {
    let part = |at: usize| state.momentum.fixed_rows::<3>(at).into_owned();
    let attitude = Navigation::attitude(state);
    [part(0), attitude * part(3), attitude * part(6)]
}

/// Lengths and costates are brought to numbers of about one.
const SCALES: [f64; 5] = [20.0, 200.0, 300.0, 15.0, 0.25];

#[test]
fn the_likeliest_path_is_that_of_pontryagins_equations() {
    let (navigation, start) = Navigation::example();
    let NavigationControl { gyroscope, accelerometer } = Navigation::bend();
    let read = |_: &Navigation, state: &NavigationState| {
        let [turning, moving, placing] = costates(state);
        let [v, p, a, b, c] = SCALES;
        numbers([
            Navigation::attitude(state).as_slice(),
            (Navigation::velocity_in_space(state) / v).as_slice(),
            (Navigation::position(state) / p).as_slice(),
            (turning / a).as_slice(),
            (moving / b).as_slice(),
            (placing / c).as_slice(),
        ])
    };
    // in space: p' = v, v' = R f + g, P_v' = −P_p, P_p' = 0; in the vehicle λ' = λ × ω + RᵀP_v × f_m
    let rate = |x: &Numbers| {
        let part = |at: usize| Vector3::from_column_slice(&x.as_slice()[at..at + 3]);
        let [v, p, a, b, c] = SCALES;
        let attitude = Matrix3::from_column_slice(&x.as_slice()[..9]);
        let (velocity, turning, moving, placing) = (part(9) * v, part(15) * a, part(18) * b, part(21) * c);
        let seen = attitude.tr_mul(&moving);
        let turned = gyroscope + turning * navigation.gyroscope_noise;
        let force = accelerometer + seen * navigation.accelerometer_noise;
        numbers([
            (attitude * hat(turned.as_slice())).as_slice(),
            ((attitude * force + navigation.gravity) / v).as_slice(),
            (velocity / p).as_slice(),
            ((turning.cross(&turned) + seen.cross(&accelerometer)) / a).as_slice(),
            (-placing / b).as_slice(),
            &[0.0; 3],
        ])
    };
    let control = Navigation::bend();
    let beside = Beside { system: &navigation, start: &start, control, read, rate: &rate, time: 20.0 };
    beside.orders::<Cayley>(&beside.exact(1_000), [80, 4]);
}

/// That of the likeliest path: dead reckoning and the fix are where they were said to be, and attitude and velocity at the end are free.
#[test]
fn the_likeliest_path_leads_to_the_fix() {
    let (navigation, start) = Navigation::example();
    let still = NavigationState { momentum: SMatrix::zeros(), ..start };
    let reckoned = after::<_, Order6<Cayley>>(&navigation, &still, 60.0, 600);
    assert_eq!(reckoned.momentum, still.momentum);
    // a circle of 200 m that is not quite closed
    let circle = vector![6.0_f64.sin(), 1.0 - 6.0_f64.cos(), 0.0] * 200.0;
    assert!((Navigation::position(&reckoned) - circle).norm() < 1e-9, "{reckoned:?}");
    let end = after::<_, Order6<Cayley>>(&navigation, &start, 60.0, 600);
    let fix = circle + vector![40.0, -30.0, 15.0];
    assert!((Navigation::position(&end) - fix).norm() < 1e-6, "{end:?}");
    let [turning, moving, _] = costates(&end);
    assert!(turning.norm() < 1e-6 && moving.norm() < 1e-8, "{turning} {moving}");
}

#[test]
fn the_costate_of_a_position_is_constant_in_space_and_that_of_a_velocity_falls_evenly() {
    let (navigation, start) = Navigation::example();
    let states = motion::<_, Cayley>(&navigation, &start, 0.05, 1_200);
    let of = |which: usize| move |state: &NavigationState| costates(state)[which].into();
    assert!(drift(&states, of(2)) < 1e-14, "{}", drift(&states, of(2)));
    // to the order of the step
    let [_, moving, placing] = costates(&start);
    let error = |h: f64, steps: u64| {
        let states = motion::<_, Cayley>(&navigation, &start, h, steps);
        let off = |(k, state): (usize, &NavigationState)| {
            (costates(state)[1] - moving + placing * (h * k as f64)).norm()
        };
        states.iter().enumerate().map(off).fold(0.0, f64::max)
    };
    let (coarse, fine) = (error(0.1, 600), error(0.05, 1_200));
    assert!(coarse < 0.01 && (3.9..4.1).contains(&(coarse / fine)), "{coarse} {fine}");
}

/// A flight whose readings change: each is held over a step, at the value in its middle.
#[test]
fn dead_reckoning_follows_a_flight_whose_readings_change() {
    let (navigation, _) = Navigation::example();
    // p = (100 sin φ, −100 cos φ, 3 t), φ = 0.1 t + 0.002 t², its first axis along the circle
    let angle = |t: f64| (0.1 * t + 0.002 * t * t, 0.1 + 0.004 * t);
    let true_state = |t: f64| {
        let (angle, rate) = angle(t);
        let along = vector![angle.cos(), angle.sin(), 0.0] * 100.0;
        let attitude = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle);
        let position = vector![along.y, -along.x, 3.0 * t];
        Navigation::start(attitude, along * rate + Vector3::z() * 3.0, position)
    };
    let error = |steps: u32| {
        let h = 30.0 / f64::from(steps);
        let readings = |_: &NavigationState, time: f64| {
            let (_, rate) = angle(time + 0.5 * h);
            NavigationControl {
                gyroscope: vector![0.0, 0.0, rate],
                accelerometer: vector![0.4, 100.0 * rate * rate, 9.81],
            }
        };
        let states = controlled::<_, Cayley>(&navigation, &true_state(0.0), h, steps.into(), readings);
        let state = &states[steps as usize];
        (state.element - true_state(30.0).element).norm()
    };
    let (coarse, fine) = (error(300), error(600));
    assert!(coarse < 0.1 && (3.9..4.1).contains(&(coarse / fine)), "{coarse} {fine}");
}

#[test]
fn a_satellite_turns_as_its_wheels_say() {
    let (satellite, _) = SatelliteWithWheels::example();
    let attitude = UnitQuaternion::from_euler_angles(0.3, -0.5, 1.2);
    let start = SatelliteWithWheelsState {
        attitude_momentum: vector![8.0, -6.0, 9.0],
        ..SatelliteWithWheels::at_rest(attitude, vector![0.6, -0.9, 0.4])
    };
    let torque = vector![0.04, 0.03, -0.05];
    let read = |satellite: &SatelliteWithWheels, state: &SatelliteWithWheelsState| {
        numbers([
            state.attitude.to_rotation_matrix().matrix().as_slice(),
            satellite.angular_velocity(state).as_slice(),
            SatelliteWithWheels::wheels(state).as_slice(),
        ])
    };
    // 𝓘 ω' = (𝓘ω + ℓ) × ω − u, ℓ' = u
    let rate = |x: &Numbers| {
        let part = |at: usize| Vector3::from_column_slice(&x.as_slice()[at..at + 3]);
        let attitude = Matrix3::from_column_slice(&x.as_slice()[..9]);
        let (turning, wheels) = (part(9), part(12));
        let momentum = turning.component_mul(&satellite.inertia) + wheels;
        numbers([
            (attitude * hat(turning.as_slice())).as_slice(),
            (momentum.cross(&turning) - torque).component_div(&satellite.inertia).as_slice(),
            torque.as_slice(),
        ])
    };
    let control = SatelliteWithWheelsControl { torque };
    let beside = Beside { system: &satellite, start: &start, control, read, rate: &rate, time: 20.0 };
    beside.orders::<Exponential>(&beside.exact(4_000), [40, 8]);
    // against the satellite
    let spins =
        SatelliteWithWheels::wheels(&start) / satellite.wheel_inertia - satellite.angular_velocity(&start);
    assert!((satellite.velocity(&start).fixed_rows::<3>(3) - spins).norm() < 1e-12);
}

#[test]
fn a_slew_ends_where_it_should_and_takes_no_momentum() {
    let (satellite, start) = SatelliteWithWheels::example();
    let states = motion::<_, Exponential>(&satellite, &start, 0.1, 6_000);
    let in_space = |state: &SatelliteWithWheelsState| (state.attitude * state.attitude_momentum).into();
    assert!(drift(&states, in_space) < 1e-13, "{}", drift(&states, in_space));
    // about one axis all the way, but for torques that are held over a step
    let axis = start.attitude.axis().expect("it is turned");
    let off = |state: &SatelliteWithWheelsState| state.attitude.imag().cross(&axis).norm();
    let off = states.iter().map(off).fold(0.0, f64::max);
    assert!(off < 1e-3, "{off}");
    let end = &states[6_000];
    assert!(end.attitude.angle() < 1e-5, "{}", end.attitude.angle());
    assert!(satellite.angular_velocity(end).norm() < 1e-6, "{end:?}");
    // the wheels have the momentum now, along other axes
    let wheels = SatelliteWithWheels::wheels(end);
    assert!((wheels - Vector3::from(in_space(&start))).norm() < 1e-5, "{wheels}");
    assert!((wheels - SatelliteWithWheels::wheels(&start)).norm() > 0.5, "{wheels}");
}

#[test]
fn a_chain_of_spins_moves_as_landau_and_lifshitz_say() {
    let (chain, start) = SpinChain::example();
    let read = |_: &SpinChain, state: &SpinChainState| {
        numbers(state.spins_momentum.iter().map(|spin| spin.as_slice()))
    };
    let rate = |x: &Numbers| {
        let spin = |k: usize| Vector3::from_column_slice(&x.as_slice()[3 * k..3 * k + 3]);
        let beside = |k: usize| {
            let neighbours = (0..4_usize).filter(|other| other.abs_diff(k) == 1);
            neighbours.map(spin).sum::<Vector3<f64>>() * chain.exchange + chain.field
        };
        let turned: Vec<Vector3<f64>> = (0..4).map(|k| spin(k).cross(&beside(k))).collect();
        numbers(turned.iter().map(|rate| rate.as_slice()))
    };
    let control = NoControl::default();
    let beside = Beside { system: &chain, start: &start, control, read, rate: &rate, time: 3.0 };
    beside.orders::<Cayley>(&beside.exact(2_000), [120, 24]);
}

#[test]
fn a_chain_of_spins_keeps_their_lengths_and_their_sum_along_the_field() {
    let (chain, start) = SpinChain::example();
    let states = motion::<_, Cayley>(&chain, &start, 0.05, 100_000);
    let casimirs = |state: &SpinChainState| chain.casimirs(state);
    assert!(drift(&states, casimirs) < 1e-12, "{}", drift(&states, casimirs));
    let along = |state: &SpinChainState| [state.spins_momentum.iter().sum::<Vector3<f64>>().z];
    assert!(drift(&states, along) < 1e-12, "{}", drift(&states, along));
    let energy = |state: &SpinChainState| [chain.energy(state)];
    assert!(drift(&states, energy) < 1e-2 * chain.energy(&start).abs(), "{}", drift(&states, energy));
    // what the first leaned by arrives at the last
    assert!(states.iter().any(|state| state.spins_momentum[3].z < 0.2));
}

#[test]
fn small_deviations_of_spins_are_waves() {
    let (chain, _) = SpinChain::example();
    for k in 0..4 {
        let (frequency, leans) = chain.wave(k);
        let size = 1e-6;
        let at = |phase: f64| {
            leans.map(|lean| vector![lean * phase.cos(), -lean * phase.sin(), 0.0] * size + Vector3::z())
        };
        let end = after::<_, Order6<Cayley>>(&chain, &SpinChain::with_spins(at(0.0)), 2.0 / frequency, 400);
        for (spin, expected) in end.spins_momentum.into_iter().zip(at(2.0)) {
            assert!((spin - expected).norm() < 1e-6 * size, "{k}: {spin} {expected}");
        }
    }
}
