//! The generic stepper against what it is made of: group laws, discrete equations at 50 digits, reference trajectories.
// in a test, a panic is the report
#![allow(clippy::unwrap_used)]

use coadjoint::nalgebra::{
    Matrix2, Matrix3, Matrix4, Quaternion, Rotation3, SMatrix, SVector, UnitQuaternion, Vector3,
};
use coadjoint::vector;
use coadjoint::{Cayley, Exponential, StepError};
use coadjoint_systems::classical::generic::{
    GenericStepper, Hamiltonian, MatrixGroup, MatrixRetraction, Product, SE2, SO2, SO3, SO3Semidirect, SU2,
    Translations,
};
use serde::Deserialize;
use serde::de::DeserializeOwned;

/// `h(Π, a₁, …, a_K) = ½ Π·I⁻¹Π + Σ (uᵢ + λ uᵢ²/2)` with `uᵢ = aᵢ·χᵢ`: a body in uniform (and, for `λ ≠ 0`, not so
/// uniform) fields.
#[derive(Clone)]
struct Top {
    inertia: Vector3<f64>,
    chi: [Vector3<f64>; 3],
    lambda: f64,
}

impl<const D: usize> Hamiltonian<D> for Top {
    fn energy(&self, mu: &SVector<f64, D>) -> f64 {
        let momentum = mu.fixed_rows::<3>(0);
        let mut energy = momentum.dot(&momentum.component_div(&self.inertia)) / 2.0;
        for (i, chi) in self.chi.iter().take(D / 3 - 1).enumerate() {
            let u = mu.fixed_rows::<3>(3 + 3 * i).dot(chi);
            energy += u + self.lambda * u * u / 2.0;
        }
        energy
    }

    fn gradient(&self, mu: &SVector<f64, D>) -> SVector<f64, D> {
        let mut velocity = SVector::<f64, D>::zeros();
        velocity.fixed_rows_mut::<3>(0).copy_from(&mu.fixed_rows::<3>(0).component_div(&self.inertia));
        for (i, chi) in self.chi.iter().take(D / 3 - 1).enumerate() {
            let u = mu.fixed_rows::<3>(3 + 3 * i).dot(chi);
            velocity.fixed_rows_mut::<3>(3 + 3 * i).copy_from(&(chi * (1.0 + self.lambda * u)));
        }
        velocity
    }
}

fn compact_top() -> Top {
    Top {
        inertia: vector![1.0, 2.0, 3.0],
        chi: [vector![0.3, 0.2, 1.0], vector![-0.5, 0.7, 0.1], vector![0.4, -0.6, 0.2]],
        lambda: 1.0,
    }
}

/// Numbers that look random, between −1 and 1.
fn sample<const D: usize>(seed: u32) -> SVector<f64, D> {
    let mut state = seed.wrapping_mul(2_654_435_769) ^ 0x9e37_79b9;
    SVector::from_fn(|_, _| {
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        f64::from(state) / f64::from(u32::MAX) * 2.0 - 1.0
    })
}

/// A sample whose first three coordinates, the rotation, have the length `angle`.
fn sample_turn<const D: usize>(seed: u32, angle: f64) -> SVector<f64, D> {
    let mut x = sample::<D>(seed);
    let turn = x.fixed_rows::<3>(0).normalize() * angle;
    x.fixed_rows_mut::<3>(0).copy_from(&turn);
    x
}

const ANGLES: [f64; 7] = [0.0, 1e-9, 1e-3, 0.4, 1.7, 4.0, 6.1];

// ------------------------------------------------------------------------------------------------ group laws

#[test]
fn exponential_on_so3_is_the_rotation_by_the_vector() {
    for (seed, angle) in (1..).zip(ANGLES) {
        let x = sample_turn::<3>(seed, angle);
        let error = (SO3::exp(&x) - Rotation3::new(x).matrix()).amax();
        assert!(error < 3e-15, "angle {angle}: {error:e}");
    }
}

#[test]
fn cayley_on_so3_is_the_rotation_by_twice_the_arc_tangent() {
    for (seed, angle) in (1..).zip(ANGLES) {
        let x = sample_turn::<3>(seed, angle);
        let r = SO3::cayley(&x).expect("every skew X leaves I − X/2 invertible");
        assert!((r.tr_mul(&r) - Matrix3::identity()).amax() < 1e-15);
        if angle > 0.0 {
            let expected = Rotation3::new(x * (2.0 * (angle / 2.0).atan() / angle));
            let error = (r - expected.matrix()).amax();
            assert!(error < 2e-15, "angle {angle}: {error:e}");
        }
    }
}

fn check_laws<G: MatrixGroup<N, D>, const N: usize, const D: usize>() {
    for seed in 0..20 {
        let (x, y, z) = (sample::<D>(3 * seed), sample::<D>(3 * seed + 1), sample::<D>(3 * seed + 2));
        let (g, h) = (G::exp(&x), G::cayley(&y).unwrap());
        let close = |error: f64, law: &str| assert!(error < 1e-14, "{law}: {error:e}");

        close((G::vee(&G::hat(&x)) - x).amax(), "vee hat x = x");
        let jacobi = G::bracket(&x, &G::bracket(&y, &z))
            + G::bracket(&y, &G::bracket(&z, &x))
            + G::bracket(&z, &G::bracket(&x, &y));
        close(jacobi.amax(), "Jacobi identity");
        close((G::ad(&x) * y - G::bracket(&x, &y)).amax(), "ad_x y = [x, y]");
        let product = G::adjoint(&(g * h)).unwrap();
        close((product - G::adjoint(&g).unwrap() * G::adjoint(&h).unwrap()).amax(), "Ad_gh = Ad_g Ad_h");
        close((G::adjoint(&g).unwrap() - series_exp(&G::ad(&x))).amax(), "Ad_exp(x) = exp(ad_x)");
        let pairing = G::coadjoint(&g, &z).unwrap().dot(&y) - z.dot(&(G::adjoint(&g).unwrap() * y));
        close(pairing.abs(), "<Ad*_g z, y> = <z, Ad_g y>");
        close((G::exp(&-x) * g - SMatrix::<f64, N, N>::identity()).amax(), "exp(-x) = exp(x)^-1");
        close((G::cayley(&-y).unwrap() * h - SMatrix::<f64, N, N>::identity()).amax(), "cay(-y) = cay(y)^-1");
    }
}

/// `Σ A^k / k!`, with neither scaling nor doubling: for small `A`.
fn series_exp<const M: usize>(a: &SMatrix<f64, M, M>) -> SMatrix<f64, M, M> {
    let mut sum = SMatrix::<f64, M, M>::identity();
    let mut term = sum;
    for k in 1..40 {
        term = term * a / f64::from(k);
        sum += term;
    }
    sum
}

#[test]
fn group_laws() {
    check_laws::<SO3, 3, 3>();
    check_laws::<SO3Semidirect<1>, 4, 6>();
    check_laws::<SO3Semidirect<2>, 5, 9>();
    check_laws::<SO3Semidirect<3>, 6, 12>();
    check_laws::<Translations<1>, 2, 1>();
    check_laws::<Translations<6>, 7, 6>();
    check_laws::<SO2, 2, 1>();
    check_laws::<SE2, 3, 3>();
    check_laws::<SU2, 4, 3>();
    check_laws::<Product<SO3, Translations<3>, 3, 3, 4, 3>, 7, 6>();
}

#[test]
fn a_unit_quaternion_turns_by_the_angle_of_its_rotation() {
    for (seed, angle) in (1..).zip(ANGLES) {
        let x = sample_turn::<3>(seed, angle);
        // as its matrix multiplies the quaternion 1
        let q = SU2::exp(&x).column(0).into_owned();
        let q = Quaternion::new(q[0], q[1], q[2], q[3]);
        let turn = UnitQuaternion::new_unchecked(q).to_rotation_matrix();
        assert!((turn.matrix() - SO3::exp(&x)).amax() < 3e-15, "angle {angle}");
        // half the angle is that of the quaternion: a whole turn is not the identity
        assert!((q.w - (angle / 2.0).cos()).abs() < 2e-15, "angle {angle}");
    }
}

#[test]
fn a_motion_of_the_plane_turns_and_moves_together() {
    let g = SE2::exp(&vector![1.2, 0.3, -0.4]);
    let turn = Matrix2::new(1.2_f64.cos(), -1.2_f64.sin(), 1.2_f64.sin(), 1.2_f64.cos());
    assert!((g.fixed_view::<2, 2>(0, 0) - turn).amax() < 1e-15);
    // an arc about a fixed point c, with v = ω J (x − c)
    let centre = vector![0.4, 0.3] / 1.2;
    let end = centre - turn * centre;
    assert!((g.fixed_view::<2, 1>(0, 2) - end).amax() < 1e-15);
    assert_eq!(SO2::exp(&vector![1.2]).fixed_view::<2, 2>(0, 0), g.fixed_view::<2, 2>(0, 0));
}

/// `dR τ_x y` against the central difference of `τ`, extrapolated once: error about 1e-12.
fn derivative_error<R, G, const N: usize, const D: usize>(x: SVector<f64, D>, y: SVector<f64, D>) -> f64
where
    G: MatrixGroup<N, D>,
    R: MatrixRetraction<G, N, D>,
{
    let tau = |x: SVector<f64, D>| R::retract(&x).expect("inside the domain");
    let central = |d: f64| (tau(x + y * d) - tau(x - y * d)) / (2.0 * d);
    let difference = (central(1e-3) * 4.0 - central(2e-3)) / 3.0;
    let expected = G::vee(&(difference * G::inverse(&tau(x)).unwrap()));
    (R::right_derivative(&x).unwrap() * y - expected).amax()
}

fn check_derivative<R, G, const N: usize, const D: usize>()
where
    G: MatrixGroup<N, D>,
    R: MatrixRetraction<G, N, D>,
{
    for (seed, angle) in (1..).zip(ANGLES) {
        let error = derivative_error::<R, G, N, D>(sample_turn::<D>(seed, angle), sample::<D>(seed + 100));
        assert!(error < 5e-12, "D = {D}, angle {angle}: {error:e}");
    }
}

fn check_small_derivative<G: MatrixGroup<N, D>, const N: usize, const D: usize>() {
    for seed in 1..20 {
        let (x, y) = (sample::<D>(seed), sample::<D>(seed + 100));
        let [exp, cay] =
            [derivative_error::<Exponential, G, N, D>(x, y), derivative_error::<Cayley, G, N, D>(x, y)];
        assert!(exp < 5e-12 && cay < 5e-12, "N = {N}, D = {D}: {exp:e} {cay:e}");
    }
}

#[test]
fn right_logarithmic_derivatives_on_the_other_groups() {
    check_small_derivative::<Translations<3>, 4, 3>();
    check_small_derivative::<SO2, 2, 1>();
    check_small_derivative::<SE2, 3, 3>();
    check_small_derivative::<SU2, 4, 3>();
    check_small_derivative::<Product<SO3, Translations<2>, 3, 3, 3, 2>, 6, 5>();
}

#[test]
fn right_logarithmic_derivatives_are_those_of_the_retractions() {
    check_derivative::<Exponential, SO3, 3, 3>();
    check_derivative::<Exponential, SO3Semidirect<1>, 4, 6>();
    check_derivative::<Exponential, SO3Semidirect<2>, 5, 9>();
    check_derivative::<Exponential, SO3Semidirect<3>, 6, 12>();
    check_derivative::<Cayley, SO3, 3, 3>();
    check_derivative::<Cayley, SO3Semidirect<1>, 4, 6>();
    check_derivative::<Cayley, SO3Semidirect<2>, 5, 9>();
    check_derivative::<Cayley, SO3Semidirect<3>, 6, 12>();
}

#[test]
fn coadjoint_action_on_body_momentum_and_advected_vectors() {
    let x = sample::<9>(5);
    let g = SO3Semidirect::<2>::exp(&x);
    let mu = sample::<9>(6);
    let rotation = g.fixed_view::<3, 3>(0, 0);
    let [p1, p2] = [3, 4].map(|j| g.fixed_view::<3, 1>(0, j).into_owned());
    let [pi, a1, a2] = [0, 3, 6].map(|i| mu.fixed_rows::<3>(i).into_owned());
    let mut expected = SVector::<f64, 9>::zeros();
    expected.fixed_rows_mut::<3>(0).copy_from(&rotation.tr_mul(&(pi + a1.cross(&p1) + a2.cross(&p2))));
    expected.fixed_rows_mut::<3>(3).copy_from(&rotation.tr_mul(&a1));
    expected.fixed_rows_mut::<3>(6).copy_from(&rotation.tr_mul(&a2));
    assert!((SO3Semidirect::<2>::coadjoint(&g, &mu).unwrap() - expected).amax() < 2e-15);
}

// ------------------------------------------------------------------------------------------------ the step's equations

#[derive(Deserialize)]
struct OneStep {
    inertia: [f64; 3],
    chi: [[f64; 3]; 3],
    momentum: Vec<f64>,
    vectors: [Vec<f64>; 3],
    cases: Vec<OneStepCase>,
}

#[derive(Deserialize)]
struct OneStepCase {
    retraction: String,
    vectors: usize,
    s: f64,
    step: f64,
    g: Vec<Vec<f64>>,
    mu: Vec<f64>,
}

fn load<T: DeserializeOwned>(name: &str) -> T {
    let path = format!("{}/../data/{name}", env!("CARGO_MANIFEST_DIR"));
    serde_json::from_str(&std::fs::read_to_string(path).expect("readable")).expect("well-formed")
}

fn check_one_step<G, R, const N: usize, const D: usize>(
    group: G,
    retraction: R,
    data: &OneStep,
    case: &OneStepCase,
) where
    G: MatrixGroup<N, D>,
    R: MatrixRetraction<G, N, D>,
{
    let top = Top { inertia: data.inertia.into(), chi: data.chi.map(Vector3::from), lambda: 1.0 };
    let start = [data.momentum.clone(), data.vectors[..case.vectors].concat()].concat();
    let mut stepper = GenericStepper::new(group, retraction, top, case.step).unwrap().at(case.s).unwrap();
    let (mut g, mut mu) = (SMatrix::<f64, N, N>::identity(), SVector::from_row_slice(&start));
    let report = stepper.step(&mut g, &mut mu).unwrap();
    let error_mu = (mu - SVector::<f64, D>::from_row_slice(&case.mu)).amax();
    let error_g = (g - SMatrix::<f64, N, N>::from_row_slice(&case.g.concat())).amax();
    println!("{} k={} s={}: {error_mu:.1e} {error_g:.1e} {report:?}", case.retraction, case.vectors, case.s);
    assert!(error_mu < 2e-15 && error_g < 2e-15, "{error_mu:e}, {error_g:e}");
}

#[test]
fn a_step_solves_the_discrete_equations_to_roundoff() {
    let data: OneStep = load("one_step.json");
    assert!(data.cases.len() >= 20);
    for case in &data.cases {
        match (case.retraction.as_str(), case.vectors) {
            ("exponential", 0) => check_one_step(SO3, Exponential, &data, case),
            ("exponential", 1) => check_one_step(SO3Semidirect::<1>, Exponential, &data, case),
            ("exponential", 2) => check_one_step(SO3Semidirect::<2>, Exponential, &data, case),
            ("exponential", 3) => check_one_step(SO3Semidirect::<3>, Exponential, &data, case),
            ("cayley", 0) => check_one_step(SO3, Cayley, &data, case),
            ("cayley", 1) => check_one_step(SO3Semidirect::<1>, Cayley, &data, case),
            ("cayley", 2) => check_one_step(SO3Semidirect::<2>, Cayley, &data, case),
            ("cayley", 3) => check_one_step(SO3Semidirect::<3>, Cayley, &data, case),
            other => panic!("unknown case {other:?}"),
        }
    }
}

fn start_with_two_vectors() -> SVector<f64, 9> {
    SVector::from_row_slice(&[0.9, -0.4, 1.2, 0.36, 0.48, 0.8, 0.8, 0.0, -0.36])
}

/// All `aᵢ·aⱼ`, and `Π·a` if there is only one `a`.
fn casimirs<const D: usize>(mu: &SVector<f64, D>) -> Vec<f64> {
    let parts: Vec<_> = (0..D / 3).map(|i| mu.fixed_rows::<3>(3 * i).into_owned()).collect();
    let first = if parts.len() == 2 { 0 } else { 1 };
    (1..parts.len())
        .flat_map(|i| (first..=i).map(move |j| (i, j)))
        .map(|(i, j)| parts[i].dot(&parts[j]))
        .collect()
}

fn check_casimirs<G, R, const N: usize, const D: usize>(group: G, retraction: R, s: f64, steps: u32)
where
    G: MatrixGroup<N, D>,
    R: MatrixRetraction<G, N, D>,
{
    let mut stepper = GenericStepper::new(group, retraction, compact_top(), 0.1).unwrap().at(s).unwrap();
    let start = SVector::<f64, D>::from_column_slice(&start_with_two_vectors().as_slice()[..D]);
    let (mut g, mut mu) = (SMatrix::<f64, N, N>::identity(), start);
    for _ in 0..steps {
        stepper.step(&mut g, &mut mu).unwrap();
    }
    let drift = casimirs(&mu).iter().zip(casimirs(&start)).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    println!("D={D} s={s}: {:.1e} per step", drift / f64::from(steps));
    // roundings that average out leave about √steps ε = 1e-14; a bias of ε/5 a step does not pass
    let bound = 5e-14;
    assert!(drift < bound, "{drift:e}");
    let rotation = g.fixed_view::<3, 3>(0, 0);
    assert!((rotation.tr_mul(&rotation) - Matrix3::identity()).amax() < bound);
    // what is fixed in space stays there, wherever the body turned
    assert!((rotation * mu.fixed_rows::<3>(3) - start.fixed_rows::<3>(3)).amax() < bound);
}

#[test]
fn casimirs_are_kept_for_every_s() {
    for s in [0.0, 0.3, 0.5, 1.0] {
        check_casimirs(SO3Semidirect::<1>, Exponential, s, 5_000);
        check_casimirs(SO3Semidirect::<1>, Cayley, s, 5_000);
        check_casimirs(SO3Semidirect::<2>, Exponential, s, 500);
        check_casimirs(SO3Semidirect::<2>, Cayley, s, 500);
    }
}

fn check_reversibility<R: MatrixRetraction<SO3Semidirect<1>, 4, 6> + Copy>(retraction: R, s: f64) {
    let stepper =
        |h| GenericStepper::new(SO3Semidirect::<1>, retraction, compact_top(), h).unwrap().at(s).unwrap();
    let start = vector![0.9, -0.4, 1.2, 0.36, 0.48, 0.8];
    let (mut g, mut mu) = (Matrix4::identity(), start);
    stepper(0.5).step(&mut g, &mut mu).unwrap();
    assert!((mu - start).amax() > 0.1);
    stepper(-0.5).step(&mut g, &mut mu).unwrap();
    assert!((mu - start).amax() < 3e-15, "{:e}", (mu - start).amax());
    assert!((g - Matrix4::identity()).amax() < 3e-15, "{:e}", (g - Matrix4::identity()).amax());
}

#[test]
fn the_step_back_undoes_the_step() {
    for s in [0.0, 0.3, 0.5, 1.0] {
        check_reversibility(Exponential, s);
        check_reversibility(Cayley, s);
    }
}

/// The step's derivative `D` carries the Poisson tensor along: `D P(μ_k) Dᵀ = P(μ_{k+1})`, where `P(μ)` is the matrix of
/// `x ↦ ad*_x μ`.
fn check_poisson_map<R: MatrixRetraction<SO3Semidirect<1>, 4, 6> + Copy>(retraction: R, s: f64) {
    type SE3 = SO3Semidirect<1>;
    let image = |mu: SVector<f64, 6>| {
        let mut stepper = GenericStepper::new(SO3Semidirect::<1>, retraction, compact_top(), 0.4).unwrap();
        stepper = stepper.at(s).unwrap();
        let (mut g, mut mu) = (Matrix4::identity(), mu);
        stepper.step(&mut g, &mut mu).unwrap();
        mu
    };
    let poisson = |mu: &SVector<f64, 6>| {
        SMatrix::<f64, 6, 6>::from_fn(|i, j| {
            let [x, y] = [j, i].map(|k| SVector::from_fn(|row, _| f64::from(u8::from(row == k))));
            mu.dot(&SE3::bracket(&x, &y))
        })
    };
    let start = vector![0.9, -0.4, 1.2, 0.36, 0.48, 0.8];
    let mut derivative = SMatrix::<f64, 6, 6>::zeros();
    for j in 0..6 {
        let shift = |d: f64| {
            let mut shifted = start;
            shifted[j] += d;
            image(shifted)
        };
        let central = |d: f64| (shift(d) - shift(-d)) / (2.0 * d);
        derivative.set_column(j, &((central(1e-3) * 4.0 - central(2e-3)) / 3.0));
    }
    let error = (derivative * poisson(&start) * derivative.transpose() - poisson(&image(start))).amax();
    assert!(error < 1e-11, "s = {s}: {error:e}");
}

#[test]
fn the_step_is_a_poisson_map_for_every_s() {
    for s in [0.0, 0.3, 0.5, 1.0] {
        check_poisson_map(Exponential, s);
        check_poisson_map(Cayley, s);
    }
}

// ------------------------------------------------------------------------------------------------ the motion

#[derive(Deserialize)]
struct Reference {
    cases: Vec<ReferenceCase>,
}

#[derive(Deserialize)]
struct ReferenceCase {
    name: String,
    inertia: [f64; 3],
    weight_chi: [f64; 3],
    initial: Initial,
    states: Vec<ReferenceState>,
}

#[derive(Deserialize)]
struct Initial {
    momentum: Vec<f64>,
    gamma: Vec<f64>,
}

#[derive(Deserialize)]
struct ReferenceState {
    time: f64,
    momentum: Vec<f64>,
    gamma: Vec<f64>,
    attitude_wxyz: [f64; 4],
}

/// The largest error of momentum, advected vector and attitude at the case's first time, 1, after `steps` steps.
fn error_at_first_time<R>(retraction: R, case: &ReferenceCase, s: f64, steps: u32) -> f64
where
    R: MatrixRetraction<SO3Semidirect<1>, 4, 6>,
{
    let top = Top { inertia: case.inertia.into(), chi: [case.weight_chi.into(); 3], lambda: 0.0 };
    let end = &case.states[0];
    let mut stepper =
        GenericStepper::new(SO3Semidirect::<1>, retraction, top, end.time / f64::from(steps)).unwrap();
    stepper = stepper.at(s).unwrap();
    let mut g = Matrix4::identity();
    let mut mu = SVector::<f64, 6>::from_row_slice(
        &[case.initial.momentum.clone(), case.initial.gamma.clone()].concat(),
    );
    for _ in 0..steps {
        stepper.step(&mut g, &mut mu).unwrap();
    }
    let expected = SVector::<f64, 6>::from_row_slice(&[end.momentum.clone(), end.gamma.clone()].concat());
    let [w, x, y, z] = end.attitude_wxyz;
    let attitude = UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z)).to_rotation_matrix();
    let error_attitude = (g.fixed_view::<3, 3>(0, 0) - attitude.matrix()).amax();
    (mu - expected).amax().max(error_attitude)
}

#[test]
fn trajectories_have_order_two() {
    let reference: Reference = load("reference.json");
    assert_eq!(reference.cases.len(), 5);
    for case in &reference.cases {
        for s in [0.0, 0.3, 1.0] {
            let exp = [50, 100].map(|steps| error_at_first_time(Exponential, case, s, steps));
            let cay = [50, 100].map(|steps| error_at_first_time(Cayley, case, s, steps));
            for (retraction, [coarse, fine]) in [("exp", exp), ("cay", cay)] {
                let order = (coarse / fine).log2();
                println!("{} {retraction} s={s}: {coarse:.1e} {fine:.1e} order {order:.4}", case.name);
                assert!((order - 2.0).abs() < 0.03, "{} {retraction} s={s}: order {order}", case.name);
            }
        }
    }
}

#[test]
fn gradient_is_the_derivative_of_the_energy() {
    let mu = start_with_two_vectors();
    let top = compact_top();
    let gradient: SVector<f64, 9> = top.gradient(&mu);
    for i in 0..9 {
        let mut shifted = [mu, mu];
        shifted[0][i] += 1e-5;
        shifted[1][i] -= 1e-5;
        let [plus, minus] = shifted.map(|mu| top.energy(&mu));
        assert!(((plus - minus) / 2e-5 - gradient[i]).abs() < 1e-9);
    }
}

// ------------------------------------------------------------------------------------------------ what can go wrong

#[test]
fn a_state_at_rest_stays_there() {
    let top = Top { chi: [Vector3::zeros(); 3], ..compact_top() };
    let mut stepper = GenericStepper::new(SO3, Exponential, top, 0.1).unwrap();
    let (mut g, mut mu) = (Matrix3::identity(), Vector3::zeros());
    let report = stepper.step(&mut g, &mut mu).unwrap();
    assert_eq!((g, mu, report.iterations, report.residual), (Matrix3::identity(), Vector3::zeros(), 0, 0.0));
}

#[test]
fn errors_leave_the_state_alone() {
    let start = vector![0.0, 0.0, 6.0];
    // a steady turn about a principal axis by 2 rad/s
    let step = |h: f64| {
        let (mut g, mut mu) = (Matrix3::identity(), start);
        let outcome = GenericStepper::new(SO3, Exponential, compact_top(), h).unwrap().step(&mut g, &mut mu);
        (outcome.err(), g != Matrix3::identity())
    };
    assert_eq!(step(3.1), (None, true));
    assert_eq!(step(3.2), (Some(StepError::OutsideDomain), false));

    let mut stepper = GenericStepper::new(SO3, Cayley, compact_top(), 0.1).unwrap();
    let (mut g, mut mu) = (Matrix3::identity(), vector![1.0, f64::NAN, 0.0]);
    assert_eq!(stepper.step(&mut g, &mut mu), Err(StepError::NotFinite));
    assert_eq!(g, Matrix3::identity());

    let mut stepper = GenericStepper::new(SO3, Exponential, compact_top(), 50.0).unwrap();
    let (mut g, mut mu) = (Matrix3::identity(), vector![1.0, 2.0, -3.0]);
    let outcome = stepper.step(&mut g, &mut mu);
    assert!(
        matches!(outcome, Err(StepError::NoConvergence { .. } | StepError::OutsideDomain)),
        "{outcome:?}"
    );
    assert_eq!((g, mu), (Matrix3::identity(), vector![1.0, 2.0, -3.0]));
}

#[test]
fn parameters_without_a_stepper() {
    for step in [0.0, f64::NAN, f64::INFINITY] {
        assert!(GenericStepper::new(SO3, Cayley, compact_top(), step).is_err());
    }
    assert!(GenericStepper::new(SO3, Cayley, compact_top(), 0.1).unwrap().at(f64::NAN).is_err());
}
