//! The integrators that the paper displays, in their corrected forms, as special cases of what is generated.
//!
//! Where a display is an equation to solve, the generated step is put into it: the velocity is read off the turn that was made.

use coadjoint::nalgebra::{Matrix2, Matrix3};
use coadjoint::prelude::*;
use coadjoint::{Discretized, Family, RightLift};
use coadjoint_support::random::Random;
use coadjoint_systems::heavy_top_on_se3::{HeavyTopOnSE3, HeavyTopOnSE3State};

/// Nothing but rounding, for values of the size of 1.
const ROUNDING: f64 = 4e-15;
/// Where the velocity is read off a turn of a hundredth or so, which costs two digits.
const READ_OFF: f64 = 2e-13;

#[lie_poisson_system(
    group = R1,
    potential = 0.5 * stiffness * position.x.powi(2),
    methods(Midpoint, Family(1, 4), Family(3, 4)),
)]
struct Oscillator {
    #[inertia]
    mass: f64,
    stiffness: f64,
}

/// The step as a matrix on `(q, v)`.
fn matrix<M>(oscillator: &Oscillator, h: f64) -> Matrix2<f64>
where
    Oscillator: Discretized<M>,
{
    let mass = oscillator.mass;
    let column = |q: f64, v: f64| {
        let mut state = OscillatorState { position: vector![q], momentum: vector![mass * v] };
        oscillator.stepper::<M>(h).expect("valid").step(&mut state).expect("explicit");
        vector![state.position.x, state.momentum.x / mass]
    };
    Matrix2::from_columns(&[column(1.0, 0.0), column(0.0, 1.0)])
}

#[test]
fn the_symplectic_euler_methods_of_the_oscillator() {
    let oscillator = Oscillator { mass: 1.7, stiffness: 2.9 };
    let (h, ratio) = (0.3, 2.9 / 1.7);
    let a = Matrix2::new(1.0 - h * h * ratio, h, -h * ratio, 1.0); // (1.9)
    let b = Matrix2::new(1.0, h, -h * ratio, 1.0 - h * h * ratio); // (1.10)
    assert!((matrix::<SymplecticEulerA>(&oscillator, h) - a).amax() < ROUNDING);
    assert!((matrix::<SymplecticEulerB>(&oscillator, h) - b).amax() < ROUNDING);
    // Störmer–Verlet: half a step of the one, then half a step of the other
    let half = |h: f64| Matrix2::new(1.0 - h * h * ratio, h, -h * ratio, 1.0);
    let other = |h: f64| Matrix2::new(1.0, h, -h * ratio, 1.0 - h * h * ratio);
    assert!((matrix::<StormerVerlet>(&oscillator, h) - other(h / 2.0) * half(h / 2.0)).amax() < ROUNDING);
    assert!((a - b).amax() > 0.01, "the two are told apart");
}

#[test]
fn the_theta_family_of_5_3_on_the_oscillator() {
    // q⁺ = q + h v̄, v⁺ = v − h (k/m) q̄ with q̄ = (1−θ) q + θ q⁺, v̄ = θ v + (1−θ) v⁺
    let oscillator = Oscillator { mass: 1.7, stiffness: 2.9 };
    let (h, ratio) = (0.3, 2.9 / 1.7);
    let family = |theta: f64| {
        let left = Matrix2::new(1.0, -h * (1.0 - theta), h * ratio * theta, 1.0);
        let right = Matrix2::new(1.0, h * theta, -h * ratio * (1.0 - theta), 1.0);
        left.try_inverse().expect("regular") * right
    };
    assert!((matrix::<SymplecticEulerA>(&oscillator, h) - family(0.0)).amax() < ROUNDING);
    assert!((matrix::<Family<Exponential, 1, 4>>(&oscillator, h) - family(0.25)).amax() < ROUNDING);
    assert!((matrix::<Midpoint>(&oscillator, h) - family(0.5)).amax() < ROUNDING);
    assert!((matrix::<Family<Exponential, 3, 4>>(&oscillator, h) - family(0.75)).amax() < ROUNDING);
    assert!((matrix::<SymplecticEulerB<Cayley>>(&oscillator, h) - family(1.0)).amax() < ROUNDING);
}

/// A vector field, lifted to the cotangent bundle by `h = p · f(q)`: predator and prey.
#[lie_poisson_system(
    group = R2,
    hamiltonian = momentum.x * position.x * (1.0 - position.y) + momentum.y * rate * position.y * (position.x - 1.0),
    methods(Family(1, 4), Midpoint, Family(3, 4), SymplecticEulerB),
)]
struct Lifted {
    rate: f64,
}

/// The oscillator (1.4) in the same way, in place and velocity.
#[lie_poisson_system(
    group = R2,
    hamiltonian = momentum.x * position.y - momentum.y * ratio * position.x,
    methods(SymplecticEulerB),
)]
struct LiftedOscillator {
    ratio: f64,
}

#[test]
fn the_explicit_and_the_implicit_euler_method_of_the_oscillator() {
    fn check<M>(expected: &Matrix2<f64>)
    where
        LiftedOscillator: Discretized<M>,
    {
        let mut state = LiftedOscillatorState { position: vector![0.4, -0.9], momentum: Vector2::zeros() };
        let mut stepper = LiftedOscillator { ratio: 2.9 / 1.7 }.stepper::<M>(0.3).expect("valid");
        let mut x = state.position;
        for _ in 0..10 {
            stepper.step(&mut state).expect("solvable");
            x = expected * x;
            assert!((state.position - x).amax() < ROUNDING * (1.0 + x.norm()), "{}", state.position - x);
        }
    }
    let (h, ratio) = (0.3, 2.9 / 1.7);
    let determinant = 1.0 + h * h * ratio;
    // (1.7), and (1.8) with the signs outside of the diagonal as they should be
    check::<SymplecticEulerA>(&Matrix2::new(1.0, h, -h * ratio, 1.0));
    check::<SymplecticEulerB>(&(Matrix2::new(1.0, h, -h * ratio, 1.0) / determinant));
}

#[test]
fn the_theta_family_of_3_3_for_a_vector_field() {
    // (3.1): x⁺ = x + h f((1−θ) x + θ x⁺): explicit Euler, implicit midpoint, implicit Euler
    fn check<M>(theta: f64)
    where
        Lifted: Discretized<M>,
    {
        let (lifted, h) = (Lifted { rate: 0.8 }, 0.1);
        let mut state = LiftedState { position: vector![0.5, 1.7], momentum: vector![0.3, -0.4] };
        let mut stepper = lifted.stepper::<M>(h).expect("valid");
        let f = |x: &Vector2<f64>| vector![x.x * (1.0 - x.y), 0.8 * x.y * (x.x - 1.0)];
        let mut x = state.position;
        for _ in 0..10 {
            stepper.step(&mut state).expect("solvable");
            let mut next = x;
            for _ in 0..200 {
                next = x + f(&(x * (1.0 - theta) + next * theta)) * h;
            }
            x = next;
            assert!((state.position - x).amax() < 10.0 * ROUNDING, "θ = {theta}: {}", state.position - x);
        }
    }
    check::<SymplecticEulerA>(0.0);
    check::<Family<Exponential, 1, 4>>(0.25);
    check::<Midpoint>(0.5);
    check::<Family<Cayley, 3, 4>>(0.75);
    check::<SymplecticEulerB>(1.0);
}

#[lie_poisson_system(group = SO3)]
struct Body {
    #[inertia]
    inertia: Matrix3<f64>,
}

#[lie_poisson_system(group = SO3, advected(gamma: R3), potential = weight * gamma.dot(&chi))]
struct Top {
    #[inertia]
    inertia: Matrix3<f64>,
    weight: f64,
    chi: Vector3<f64>,
}

/// The quadrotor (6.19); moment in the body, thrust along its third axis.
#[lie_poisson_system(
    group(attitude: SO3, position: R3),
    control(moment: R3, thrust: f64),
    potential = mass * gravity * position.z,
    force(attitude = moment, position = thrust * (attitude * Vector3::z())),
)]
struct Quadrotor {
    #[inertia(attitude)]
    inertia: Matrix3<f64>,
    #[inertia(position)]
    mass: f64,
    gravity: f64,
}

/// A retraction, by its definitions with matrices.
trait Definition {
    /// `x` of `τ(x) = turn`.
    fn inverse(turn: &UnitQuaternion<f64>) -> Vector3<f64>;
    /// `τ(x̂)`
    fn turn(x: &Vector3<f64>) -> Matrix3<f64>;
    /// `dR τ_x`
    fn d_right(x: &Vector3<f64>) -> Matrix3<f64>;
    /// The translation of `τ(x̂, w)` on SE(3).
    fn translation(x: &Vector3<f64>) -> Matrix3<f64>;
}

fn hat(x: &Vector3<f64>) -> Matrix3<f64> {
    x.cross_matrix()
}

/// `Σ Xᵏ/(k + shift)!`
fn series(x: &Matrix3<f64>, shift: u32) -> Matrix3<f64> {
    let first: f64 = (1..=shift).map(f64::from).product();
    let mut term = Matrix3::identity() / first;
    let mut sum = term;
    for k in 1..40 {
        term = term * x / f64::from(k + shift);
        sum += term;
    }
    sum
}

impl Definition for Exponential {
    fn inverse(turn: &UnitQuaternion<f64>) -> Vector3<f64> {
        turn.scaled_axis()
    }
    fn turn(x: &Vector3<f64>) -> Matrix3<f64> {
        series(&hat(x), 0)
    }
    fn d_right(x: &Vector3<f64>) -> Matrix3<f64> {
        series(&hat(x), 1)
    }
    fn translation(x: &Vector3<f64>) -> Matrix3<f64> {
        series(&hat(x), 1)
    }
}

impl Definition for Cayley {
    fn inverse(turn: &UnitQuaternion<f64>) -> Vector3<f64> {
        // cay x is the turn by 2 atan(|x|/2)
        turn.imag() * (2.0 / turn.w)
    }
    fn turn(x: &Vector3<f64>) -> Matrix3<f64> {
        let half = hat(x) / 2.0;
        (Matrix3::identity() - half).try_inverse().expect("regular") * (Matrix3::identity() + half)
    }
    fn d_right(x: &Vector3<f64>) -> Matrix3<f64> {
        (Matrix3::identity() + hat(x) / 2.0) / (1.0 + x.norm_squared() / 4.0)
    }
    fn translation(x: &Vector3<f64>) -> Matrix3<f64> {
        (Matrix3::identity() - hat(x) / 2.0).try_inverse().expect("regular")
    }
}

fn rotation(attitude: &UnitQuaternion<f64>) -> Matrix3<f64> {
    attitude.to_rotation_matrix().into_inner()
}

/// The rigid body: (6.8) with the exponential (6.11) and Cayley (6.13), and with the momentum carried in space (6.9).
fn rigid_body<R: Definition>()
where
    Body: Discretized<R> + Discretized<RightLift<SymplecticEulerA<R>>>,
{
    let random = &mut Random::new(61);
    let t = 0.05;
    for _ in 0..50 {
        let body = Body { inertia: random.inertia() };
        let before = BodyState { attitude: random.rotation(), momentum: random.vector() };
        let mut after = before;
        body.stepper::<R>(t).expect("valid").step(&mut after).expect("solvable");
        let (r, r_next) = (rotation(&before.attitude), rotation(&after.attitude));
        let x = R::inverse(&(before.attitude.inverse() * after.attitude));
        let velocity = x / t;
        // dL* Π_{k+1} = 𝕀 Ω, with dL = dRᵀ on SO(3), and Π_{k+1} = τ⁻¹ Π_k
        let left = R::d_right(&x) * after.momentum;
        assert!((left - body.inertia * velocity).amax() < READ_OFF, "{}", left - body.inertia * velocity);
        assert!((after.momentum - R::turn(&x).transpose() * before.momentum).amax() < ROUNDING);

        let mut carried = before;
        let mut stepper = body.stepper::<RightLift<SymplecticEulerA<R>>>(t).expect("valid");
        stepper.step(&mut carried).expect("solvable");
        let spatial = r * before.momentum;
        assert!((carried.attitude.coords - after.attitude.coords).amax() < ROUNDING);
        assert!((carried.momentum - r_next.transpose() * spatial).amax() < ROUNDING);
    }
}

#[test]
fn the_rigid_body_with_the_exponential() {
    rigid_body::<Exponential>();
}

#[test]
fn the_rigid_body_with_cayley() {
    rigid_body::<Cayley>();
}

/// The heavy top on SE(3): (6.15), (6.16) and (6.17), (6.18), with `v = mgχ`.
fn heavy_top<R: Definition>()
where
    Top: Discretized<R>,
{
    let random = &mut Random::new(62);
    let t = 0.05;
    for _ in 0..50 {
        let top = Top { inertia: random.inertia(), weight: 1.3, chi: random.vector() };
        let before =
            TopState { attitude: random.rotation(), momentum: random.vector(), gamma: random.vector() };
        let mut after = before;
        top.stepper::<R>(t).expect("valid").step(&mut after).expect("solvable");
        let x = R::inverse(&(before.attitude.inverse() * after.attitude));
        let w = top.chi * (top.weight * t);
        let moved = R::translation(&x) * w;
        // Ad*_(R,p) (Π, Γ) = (Rᵀ(Π + Γ × p), Rᵀ Γ)
        let momentum = R::turn(&x).transpose() * (before.momentum + before.gamma.cross(&moved));
        assert!((after.momentum - momentum).amax() < ROUNDING);
        assert!((after.gamma - R::turn(&x).transpose() * before.gamma).amax() < ROUNDING);
        // (dR τ_(x,w))* (Π, Γ) = dR*Π + Q(x, w)ᵀ Γ = 𝕀 Ω, where Q y is what the translation changes by when τ is turned by y: the
        // derivative of τ(x + εy, w) τ(x, w)⁻¹, here by differences of the matrices
        let q_transposed = Vector3::from_fn(|i, _| {
            let y = Vector3::ith(i, 1.0);
            let rotated = R::d_right(&x) * y;
            let derivative = central(|e| R::translation(&(x + y * e)) * w);
            before.gamma.dot(&(derivative - rotated.cross(&moved)))
        });
        let left = R::d_right(&x).transpose() * before.momentum + q_transposed;
        let right = top.inertia * x / t;
        assert!((left - right).amax() < 10.0 * READ_OFF, "{}", left - right);
    }
}

/// A derivative at 0 by differences of order 8.
fn central(f: impl Fn(f64) -> Vector3<f64>) -> Vector3<f64> {
    let h = 0.02;
    let weights = [4.0 / 5.0, -1.0 / 5.0, 4.0 / 105.0, -1.0 / 280.0];
    let pair = |(k, weight): (usize, &f64)| (f(h * (k + 1) as f64) - f(-h * (k + 1) as f64)) * *weight;
    weights.iter().enumerate().map(pair).sum::<Vector3<f64>>() / h
}

#[test]
fn the_heavy_top_with_the_exponential() {
    heavy_top::<Exponential>();
}

#[test]
fn the_heavy_top_with_cayley() {
    heavy_top::<Cayley>();
}

/// (6.16), the logarithmic derivative `J` and what `t mgχ = z` adds to it, `Q`, in their right forms.
fn j_and_q(y: &Vector3<f64>, z: &Vector3<f64>) -> (Matrix3<f64>, Matrix3<f64>) {
    let (angle, y_hat, z_hat) = (y.norm(), hat(y), hat(z));
    let (sine, cosine) = angle.sin_cos();
    let c2 = (angle / 2.0).sin().powi(2) / (2.0 * (angle / 2.0).powi(2));
    let c3 = (angle - sine) / angle.powi(3);
    let first = (angle * sine + 2.0 * cosine - 2.0) / angle.powi(4);
    let second = (3.0 * sine - angle * cosine - 2.0 * angle) / angle.powi(5);
    let j = Matrix3::identity() + y_hat * c2 + y_hat * y_hat * c3;
    let q = z_hat * c2
        + (y_hat * z_hat + z_hat * y_hat) * c3
        + (y_hat * first + y_hat * y_hat * second) * y.dot(z);
    (j, q)
}

/// A step of the heavy top with the auxiliary `x`, as the paper writes it, in its right form; `(R, x, Π, Γ)`.
type TopStep = fn(&HeavyTopOnSE3, f64, &OnSE3) -> OnSE3;
type OnSE3 = (Matrix3<f64>, Vector3<f64>, Vector3<f64>, Vector3<f64>);

/// (6.16), with the exponential.
fn top_by_6_16(top: &HeavyTopOnSE3, t: f64, (r, x, pi, gamma): &OnSE3) -> OnSE3 {
    let z = top.chi * (top.weight * t);
    let mut y = pi.component_div(&top.inertia) * t;
    for _ in 0..100 {
        let (j, q) = j_and_q(&y, &z);
        y = (j.transpose() * pi + q.transpose() * gamma).component_div(&top.inertia) * t;
    }
    let (j, _) = j_and_q(&y, &z);
    let turn = Exponential::turn(&y);
    let moved = j * z;
    (r * turn, x + r * moved, turn.transpose() * (pi + gamma.cross(&moved)), turn.transpose() * gamma)
}

/// (6.18), with the Cayley map throughout.
fn top_by_6_18(top: &HeavyTopOnSE3, t: f64, (r, x, pi, gamma): &OnSE3) -> OnSE3 {
    let z = top.chi * (top.weight * t);
    let mut y = pi.component_div(&top.inertia) * t;
    for _ in 0..100 {
        // (1 + |y|²/4) 𝓘Ω = (1 − ŷ/2)(Π + ½ Γ × t mgχ)
        let left = (Matrix3::identity() - hat(&y) / 2.0) * (pi + gamma.cross(&z) / 2.0);
        y = (left / (1.0 + y.norm_squared() / 4.0)).component_div(&top.inertia) * t;
    }
    let turn = Cayley::turn(&y);
    let moved = Cayley::translation(&y) * z;
    (r * turn, x + r * moved, turn.transpose() * (pi + gamma.cross(&moved)), turn.transpose() * gamma)
}

fn parts_on_se3(state: &HeavyTopOnSE3State) -> OnSE3 {
    let (pi, gamma) = (state.momentum.fixed_rows::<3>(0), state.momentum.fixed_rows::<3>(3));
    let x = state.pose.translation.vector;
    (rotation(&state.pose.rotation), x, pi.into_owned(), gamma.into_owned())
}

/// Ten steps of the system of the catalogue, and of the heavy top with the vertical advected.
fn top_with_x<R>(by_display: TopStep)
where
    HeavyTopOnSE3: Discretized<R>,
    coadjoint_systems::heavy_top::HeavyTop: Discretized<R>,
{
    use coadjoint_systems::heavy_top::HeavyTop;
    let random = &mut Random::new(64);
    let t = 0.05;
    let top = HeavyTopOnSE3 { inertia: random.moments(), weight: 1.3, chi: random.vector() };
    let reduced = HeavyTop { inertia: top.inertia, weight: top.weight, chi: top.chi };
    let (attitude, momentum) = (random.rotation(), random.vector());
    let mut state = HeavyTopOnSE3::start(attitude, momentum);
    let mut reduced_state = HeavyTop::start(attitude, momentum);
    let mut expected = parts_on_se3(&state);
    let mut stepper = top.stepper::<R>(t).expect("valid");
    let mut reduced_stepper = reduced.stepper::<R>(t).expect("valid");
    for _ in 0..10 {
        stepper.step(&mut state).expect("solvable");
        reduced_stepper.step(&mut reduced_state).expect("solvable");
        expected = by_display(&top, t, &expected);
        let (r, x, pi, gamma) = parts_on_se3(&state);
        assert!((r - expected.0).amax() < 1e-14 && (x - expected.1).amax() < 1e-14);
        assert!((pi - expected.2).amax() < 1e-13 && (gamma - expected.3).amax() < 1e-14);
        assert!((r - rotation(&reduced_state.attitude)).amax() < 1e-14);
        assert!((pi - reduced_state.momentum).amax() < 1e-14);
        assert!((gamma - reduced_state.gamma).amax() < 1e-14);
    }
    // what the weight has pulled the angular momentum in space by
    let pulled = expected.1.cross(&Vector3::z());
    assert!((expected.0 * expected.2 - attitude * momentum + pulled).amax() < 1e-14);
    assert!(pulled.norm() > 0.05);
}

#[test]
fn the_heavy_tops_auxiliary_x_with_the_exponential() {
    top_with_x::<Exponential>(top_by_6_16);
}

#[test]
fn the_heavy_tops_auxiliary_x_with_cayley() {
    top_with_x::<Cayley>(top_by_6_18);
}

/// (6.20) with (6.21) and (6.22): the moment acts at `g_k`, so that `Π_{k+1} = τ⁻¹ (Π_k + t M_k)`; without a moment it is the display
/// as it stands.
fn quadrotor<R: Definition>()
where
    Quadrotor: Discretized<SymplecticEulerA<R>>,
{
    let random = &mut Random::new(63);
    let t = 0.05;
    for trial in 0..50 {
        let quadrotor = Quadrotor { inertia: random.inertia(), mass: 1.4, gravity: 9.81 };
        let before = QuadrotorState {
            attitude: random.rotation(),
            attitude_momentum: random.vector(),
            position: random.vector(),
            position_momentum: random.vector(),
        };
        let moment = if trial % 2 == 0 { Vector3::zeros() } else { random.vector() };
        let control = QuadrotorControl { moment, thrust: random.between(-1.0, 1.0) };
        let mut after = before;
        let mut stepper = quadrotor.stepper::<SymplecticEulerA<R>>(t).expect("valid");
        stepper.step_with(&mut after, &control).expect("solvable");

        let r = rotation(&before.attitude);
        let x = R::inverse(&(before.attitude.inverse() * after.attitude));
        let kicked = before.attitude_momentum + moment * t;
        let momentum = R::turn(&x).transpose() * kicked;
        assert!((after.attitude_momentum - momentum).amax() < ROUNDING);
        let left = R::d_right(&x) * after.attitude_momentum;
        assert!((left - quadrotor.inertia * x / t).amax() < READ_OFF);
        let p = before.position_momentum - Vector3::z() * (t * 1.4 * 9.81)
            + r * Vector3::z() * (t * control.thrust);
        assert!((after.position_momentum - p).amax() < ROUNDING);
        assert!((after.position - (before.position + p * (t / 1.4))).amax() < ROUNDING);
    }
}

#[test]
fn the_quadrotor_with_both_retractions() {
    quadrotor::<Exponential>();
    quadrotor::<Cayley>();
}
