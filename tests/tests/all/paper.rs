//! The integrators that the paper displays, in their corrected forms, as special cases of what is generated.
//!
//! Where a display is an equation to solve, the generated step is put into it: the velocity is read off the turn that was made.

use coadjoint::nalgebra::{Matrix2, Matrix3};
use coadjoint::prelude::*;
use coadjoint::{Discretized, Family, RightLift};
use coadjoint_tests::random::Random;

/// Nothing but rounding, for values of the size of 1.
const ROUNDING: f64 = 4e-15;
/// Where the velocity is read off a turn of a hundredth or so, which costs two digits.
const READ_OFF: f64 = 2e-13;

#[lie_poisson_system(
    group = R1,
    potential = 0.5 * stiffness * position.x.powi(2),
    methods(Midpoint, Family(1, 4)),
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
    assert!((matrix::<SymplecticEulerB<Cayley>>(&oscillator, h) - family(1.0)).amax() < ROUNDING);
}

/// A particle whose energy is not a sum of a kinetic and a potential one.
#[lie_poisson_system(
    group = R2,
    hamiltonian = {
        let stretched = 1.0 + softness * position.norm_squared();
        stretched * momentum.norm_squared() / 2.0 + position.x.powi(4) + position.x * momentum.y
    },
    methods(Midpoint, SymplecticEulerB, Family(1, 4)),
)]
struct Bent {
    softness: f64,
}

#[test]
fn the_theta_family_of_5_3_for_a_hamiltonian_that_is_not_separable() {
    fn check<M>(theta: f64)
    where
        Bent: Discretized<M>,
    {
        let (bent, h) = (Bent { softness: 0.3 }, 0.1);
        let mut state = BentState { position: vector![0.4, -0.7], momentum: vector![0.9, 0.2] };
        let (q, p) = (state.position, state.momentum);
        bent.stepper::<M>(h).expect("valid").step(&mut state).expect("solvable");
        // ∂h/∂p and −∂h/∂q by hand
        let f1 = |q: &Vector2<f64>, p: &Vector2<f64>| p * (1.0 + 0.3 * q.norm_squared()) + vector![0.0, q.x];
        let f2 = |q: &Vector2<f64>, p: &Vector2<f64>| {
            -(q * (0.3 * p.norm_squared()) + vector![4.0 * q.x.powi(3) + p.y, 0.0])
        };
        let (mut q_next, mut p_next) = (q, p);
        for _ in 0..200 {
            let q_bar = q * (1.0 - theta) + q_next * theta;
            let p_bar = p * theta + p_next * (1.0 - theta);
            (q_next, p_next) = (q + f1(&q_bar, &p_bar) * h, p + f2(&q_bar, &p_bar) * h);
        }
        assert!((state.position - q_next).amax() < ROUNDING, "θ = {theta}: {}", state.position - q_next);
        assert!((state.momentum - p_next).amax() < ROUNDING, "θ = {theta}: {}", state.momentum - p_next);
    }
    check::<SymplecticEulerA>(0.0);
    check::<Family<Exponential, 1, 4>>(0.25);
    check::<Midpoint<Cayley>>(0.5);
    check::<SymplecticEulerB>(1.0);
}

/// A vector field, lifted to the cotangent bundle by `h = p · f(q)`: predator and prey.
#[lie_poisson_system(
    group = R2,
    hamiltonian = momentum.x * position.x * (1.0 - position.y) + momentum.y * rate * position.y * (position.x - 1.0),
    methods(Midpoint, SymplecticEulerB, Family(1, 4)),
)]
struct Lifted {
    rate: f64,
}

#[test]
fn the_theta_family_of_3_3_for_a_vector_field() {
    // x⁺ = x + h f((1−θ) x + θ x⁺): explicit Euler, implicit midpoint, implicit Euler
    fn check<M>(theta: f64)
    where
        Lifted: Discretized<M>,
    {
        let (lifted, h) = (Lifted { rate: 0.8 }, 0.1);
        let mut state = LiftedState { position: vector![0.5, 1.7], momentum: vector![0.3, -0.4] };
        let x = state.position;
        lifted.stepper::<M>(h).expect("valid").step(&mut state).expect("solvable");
        let f = |x: &Vector2<f64>| vector![x.x * (1.0 - x.y), 0.8 * x.y * (x.x - 1.0)];
        let mut next = x;
        for _ in 0..200 {
            next = x + f(&(x * (1.0 - theta) + next * theta)) * h;
        }
        assert!((state.position - next).amax() < ROUNDING, "θ = {theta}: {}", state.position - next);
    }
    check::<SymplecticEulerA>(0.0);
    check::<Family<Exponential, 1, 4>>(0.25);
    check::<Midpoint>(0.5);
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
