//! Controls in energies: what a system of them does is what one does whose parameters they are, set anew before each step.

use coadjoint::SchemeType;
use coadjoint::certify::Certification;
use coadjoint::derivative::LinearizedSchemes;
use coadjoint::derivative::{WrtControl, WrtParameters};
use coadjoint::erased;
use coadjoint::nalgebra::SVector;
use coadjoint::prelude::*;
use coadjoint::system::{Control, Geometry, Schemes, State};
use coadjoint::{Discretized, RightLift, System, TangentLift};
use coadjoint_support::array;
use coadjoint_support::random::Random;

/// Relative to the largest number: the two are computed in another order.
const ROUNDING: f64 = 5e-15;

/// Two descriptions of one system: the last fields of the second are controls of the first.
macro_rules! twins {
    ($controlled:ident, $known:ident, [$($description:tt)*], control($($control:ident: $shape:ident = $field:ty),+), $fields:tt) => {
        twins! { @one $controlled, [$($description)*, control($($control: $shape),+)], $fields, }
        twins! { @one $known, [$($description)*], $fields, $($control: $field,)+ }
    };
    (@one $name:ident, [$($description:tt)*], { $($(#[$inertia:meta])? $field:ident: $type:ty),* }, $($control:ident: $known:ty,)*) => {
        #[lie_poisson_system($($description)*)]
        #[derive(Clone, Debug)]
        struct $name {
            $($(#[$inertia])? $field: $type,)*
            $($control: $known,)*
        }
    };
}

// In a field that turns it: left-invariant, so that nothing acts on the momentum in space.
twins! {
    Spin, KnownSpin,
    [
        group = SO3,
        hamiltonian = momentum.dot(&momentum.component_mul(&mobility)) / 2.0 + field.dot(&momentum)
            + bending * momentum.x.powi(3) * tilt,
        methods(Midpoint, SymplecticEulerB, TangentLift),
        derivatives(controls, parameters)
    ],
    control(field: R3 = Vector3<f64>, tilt: f64 = f64),
    { mobility: Vector3<f64>, bending: f64 }
}

// On a moving belt, with a force by the velocity, which the control and the time have a part in.
twins! {
    Cart, KnownCart,
    [
        group = SE2,
        hamiltonian = momentum.component_mul(&momentum).dot(&mobility) / 2.0 + belt * t.cos() * momentum.y
            + belt * pose.translation.x.powi(2) + mass * pose.translation.y,
        force = -drag * velocity,
        methods(Midpoint, SymplecticEulerB, TangentLift),
        derivatives(controls, parameters)
    ],
    control(belt: f64 = f64),
    { mobility: Vector3<f64>, mass: f64, drag: f64 }
}

// A top whose weight changes: a potential of the advected vector.
twins! {
    Top, KnownTop,
    [
        group = SO3,
        advected(gamma: R3),
        potential = weight * gamma.dot(&chi),
        methods(Midpoint, SymplecticEulerB, TangentLift),
        derivatives(controls, parameters)
    ],
    control(weight: f64 = f64),
    { #[inertia] inertia: Vector3<f64>, chi: Vector3<f64> }
}

// A point near the speed of light, whose velocity has no closed form, in a field that is switched.
twins! {
    Point, KnownPoint,
    [
        group = R2,
        lagrangian = -mass * (1.0 - velocity.norm_squared()).sqrt()
            + field * (position.x * velocity.y - position.y * velocity.x) - position.norm_squared() / 2.0
            - field * position.x,
        methods(Midpoint, SymplecticEulerB, TangentLift),
        derivatives(controls, parameters)
    ],
    control(field: f64 = f64),
    { mass: f64 }
}

/// A system with controls in its energy, and the one whose parameters they are.
trait Controlled<const D: usize>:
    System<Scalar = f64, Momentum = SVector<f64, D>>
    + Geometry
    + Schemes
    + LinearizedSchemes
    + Clone
    + Send
    + Sync
    + 'static
{
    type Known: System<Scalar = f64, Momentum = SVector<f64, D>, Control = NoControl<f64>>
        + Geometry
        + Schemes
        + LinearizedSchemes
        + Clone
        + Send
        + Sync
        + 'static;

    fn example(random: &mut Random) -> (Self, Self::State);

    /// For steps whose energy drifts.
    fn example_with_drift(random: &mut Random) -> (Self, Self::State) {
        Self::example(random)
    }

    /// With the controls as parameters.
    fn known(&self, control: &Self::Control) -> Self::Known {
        let (own, others) = (self.to_parameters(), control.to_components());
        let all = [own.as_ref(), others.as_ref()].concat();
        Self::Known::from_parameters(&array(|index| all[index]))
    }
}

/// The same state of the other system.
fn other<S: Controlled<D>, const D: usize>(state: &S::State) -> <S::Known as System>::State {
    let numbers = state.to_components();
    State::from_components(&array(|index| numbers.as_ref()[index]))
}

fn control<S: System<Scalar = f64>>(random: &mut Random) -> S::Control {
    Control::from_components(&array(|_| random.between(-0.5, 0.5)))
}

/// That numbers agree to rounding.
fn assert_same(one: &[f64], other: &[f64]) {
    assert_eq!(one.len(), other.len());
    let size = other.iter().fold(1.0, |size: f64, x| size.max(x.abs()));
    let error = one.iter().zip(other).fold(0.0, |error: f64, (x, y)| error.max((x - y).abs()));
    assert!(error <= ROUNDING * size, "{one:?} {other:?}");
}

/// Ten steps, each with controls of its own.
fn steps_agree<M, S: Controlled<D> + Discretized<M>, const D: usize>(seed: u64)
where
    S::Known: Discretized<M>,
{
    let mut random = Random::new(seed);
    let (system, mut state) = S::example(&mut random);
    let mut beside = other::<S, D>(&state);
    let mut stepper = system.stepper::<M>(0.05).expect("valid");
    let mut reference = system.known(&S::Control::default()).stepper::<M>(0.05).expect("valid");
    let start = beside.clone();
    for _ in 0..10 {
        let control = control::<S>(&mut random);
        stepper.step_with(&mut state, &control).expect("solvable");
        reference.set_system(&system.known(&control)).expect("valid");
        reference.step(&mut beside).expect("solvable");
        assert_same(state.to_components().as_ref(), beside.to_components().as_ref());
    }
    assert!(start != beside);
}

/// Energy, its differential, velocity, momentum, force and motion.
fn functions_agree<S: Controlled<D>, const D: usize>(seed: u64) {
    let mut random = Random::new(seed);
    let (system, state) = S::example(&mut random);
    let there = other::<S, D>(&state);
    let (none, time) = (NoControl::default(), 0.3);
    for _ in 0..3 {
        let control = control::<S>(&mut random);
        let known = system.known(&control);
        let velocity = system.velocity_at(&state, time, &control);
        assert_same(velocity.as_slice(), known.velocity_at(&there, time, &none).as_slice());
        let momentum = system.momentum(&state);
        let one = [
            system.momentum_of(&velocity, &state, time, &control),
            system.velocity_of(&momentum, &state, time, &control),
        ];
        let two = [
            known.momentum_of(&velocity, &there, time, &none),
            known.velocity_of(&momentum, &there, time, &none),
        ];
        for (one, two) in one.iter().zip(&two) {
            assert_same(one.as_ref().expect("one").as_slice(), two.as_ref().expect("one").as_slice());
        }
        assert_same(one[0].as_ref().expect("one").as_slice(), momentum.as_slice());

        let (numbers, control) = (state.to_components(), control.to_components());
        let (numbers, control) = (numbers.as_ref(), control.as_ref());
        let (one, two): (&dyn erased::System, &dyn erased::System) = (&system, &known);
        assert_same(&[one.energy(numbers, time, control)], &[two.energy(numbers, time, &[])]);
        assert_same(&one.differential(numbers, time, control), &two.differential(numbers, time, &[]));
        assert_same(&one.force(numbers, time, control), &two.force(numbers, time, &[]));
        assert_same(&one.motion(numbers, time, control), &two.motion(numbers, time, &[]));
        // the controls have a part in it
        assert!(one.energy(numbers, time, control) != one.energy(numbers, time, &[]));
    }
    // without controls, all are zero
    let nothing = S::Control::default();
    assert_eq!(system.energy(&state), system.energy_at(&state, 0.0, &nothing));
    assert_eq!(system.velocity(&state), system.velocity_at(&state, 0.0, &nothing));
}

/// The derivative with respect to the controls is that with respect to the parameters that they are.
macro_rules! derivatives_agree {
    ($system:ident, $($scheme:ty),+) => {$({
        let mut random = Random::new(5);
        let (system, mut state) = $system::example(&mut random);
        let mut beside = other::<$system, _>(&state);
        let control = control::<$system>(&mut random);
        let mut stepper = system.stepper::<$scheme>(0.05).expect("valid");
        let mut reference = system.known(&control).stepper::<$scheme>(0.05).expect("valid");
        let taken = stepper.step_with_jacobian(&mut state, &control, WrtControl).expect("solvable");
        let known =
            reference.step_with_jacobian(&mut beside, &NoControl::default(), WrtParameters).expect("solvable");
        let (one, all) = (taken.0, known.0);
        let fields = all.ncols() - one.ncols();
        assert_same(one.as_slice(), all.columns(fields, one.ncols()).into_owned().as_slice());
        assert!(one.amax() > 1e-3, "{one}");
    })+};
}

/// Every claim, with controls that are held, and that change.
fn certified<M, S: Controlled<D> + Discretized<M>, const D: usize>(example: fn(&mut Random) -> (S, S::State))
where
    M: SchemeType,
{
    let mut random = Random::new(6);
    let (system, state) = example(&mut random);
    let controls: Vec<S::Control> = (0..2).map(|_| control::<S>(&mut random)).collect();
    let states = vec![state; 2];
    let report = Certification::new(&system)
        .states(&states)
        .controls(&controls)
        .run::<M>()
        .unwrap_or_else(|error| panic!("{}, {controls:?}: {error}", S::NAME));
    assert!(report.passed(), "{report}");
    // where no force acts and the time has no part, the energy with these controls is one of the claims
    let has_energy = report.certificates.iter().any(|certificate| certificate.name == "energy drift");
    assert_eq!(has_energy, S::AUTONOMOUS);
}

impl Controlled<3> for Spin {
    type Known = KnownSpin;

    fn example(random: &mut Random) -> (Self, SpinState) {
        let spin = Spin { mobility: vector![1.0, 0.6, 0.4], bending: 0.2 };
        (spin, SpinState { attitude: random.rotation(), momentum: random.vector() })
    }
}

impl Controlled<3> for Cart {
    type Known = KnownCart;

    fn example(random: &mut Random) -> (Self, CartState) {
        let pose = coadjoint::nalgebra::Isometry2::new(vector![0.3, -0.2], 0.7);
        (
            Cart { mobility: vector![2.0, 0.5, 0.9], mass: 0.3, drag: 0.2 },
            CartState { pose, momentum: random.vector() },
        )
    }
}

impl Controlled<3> for Top {
    type Known = KnownTop;

    fn example(random: &mut Random) -> (Self, TopState) {
        let top = Top { inertia: random.moments(), chi: random.direction() };
        let attitude = random.rotation();
        let gamma = attitude.inverse() * Vector3::z();
        (top, TopState { attitude, momentum: random.vector(), gamma })
    }
}

impl Controlled<2> for Point {
    type Known = KnownPoint;

    fn example(_: &mut Random) -> (Self, PointState) {
        (Point { mass: 1.2 }, PointState { position: vector![0.4, -0.3], momentum: vector![0.5, 0.6] })
    }

    /// As fast, but so heavy that steps which do not keep the energy make it hardly faster: nearer to the speed of light, a last digit of the
    /// velocity is many of the momentum.
    fn example_with_drift(_: &mut Random) -> (Self, PointState) {
        (Point { mass: 6.0 }, PointState { position: vector![0.4, -0.3], momentum: vector![2.5, 3.0] })
    }
}

/// Steps, functions, derivatives and claims.
macro_rules! is_as_with_parameters {
    ($name:ident, $system:ident) => {
        #[test]
        fn $name() {
            functions_agree::<$system, _>(1);
            is_as_with_parameters!(@ $system, Cayley);
            is_as_with_parameters!(@ $system, Exponential);
        }
    };
    (@ $system:ident, $retraction:ty) => {
        steps_agree::<$retraction, $system, _>(2);
        steps_agree::<Midpoint<$retraction>, $system, _>(3);
        steps_agree::<SymplecticEulerB<$retraction>, $system, _>(3);
        steps_agree::<TangentLift<$retraction>, $system, _>(4);
        derivatives_agree!($system, $retraction, Midpoint<$retraction>, TangentLift<$retraction>);
        certified::<$retraction, $system, _>(Controlled::example);
        certified::<Midpoint<$retraction>, $system, _>(Controlled::example);
        certified::<TangentLift<$retraction>, $system, _>(Controlled::example_with_drift);
    };
}
is_as_with_parameters!(controls_of_a_left_invariant_hamiltonian, Spin);
is_as_with_parameters!(controls_of_a_hamiltonian_with_a_force, Cart);
is_as_with_parameters!(controls_of_a_potential, Top);
is_as_with_parameters!(controls_of_a_lagrangian, Point);

/// Whatever turns a spin, its momentum in space is constant; so it is, up to the rounding of its turning back, with steps that carry it.
#[test]
fn what_controls_do_to_a_left_invariant_energy_keeps_the_momentum_in_space() {
    const { assert!(Spin::INVARIANT && Spin::AUTONOMOUS && !Spin::FORCED) };
    const { assert!(Top::INVARIANT && !Cart::INVARIANT && !Cart::AUTONOMOUS && Cart::FORCED) };
    let mut random = Random::new(11);
    let (spin, mut state) = Spin::example(&mut random);
    let before = spin.spatial_momentum(&state);
    let mut stepper = spin.stepper::<RightLift<Cayley>>(0.05).expect("valid");
    let mut beside = state;
    let mut plain = spin.stepper::<Cayley>(0.05).expect("valid");
    for _ in 0..1000 {
        let control = control::<Spin>(&mut random);
        stepper.step_with(&mut state, &control).expect("solvable");
        plain.step_with(&mut beside, &control).expect("solvable");
    }
    let change = (spin.spatial_momentum(&state) - before).norm();
    assert!(change < 2e-15 * before.norm(), "{change:e}");
    let apart = (spin.momentum(&state) - spin.momentum(&beside)).norm();
    assert!(apart < 1e-11, "{apart:e}");
}

/// The force method sees the velocity that there is with these controls at that time.
#[test]
fn forces_by_the_velocity_see_controls_and_time() {
    let mut random = Random::new(12);
    let (cart, state) = Cart::example(&mut random);
    let control = CartControl { belt: 0.8 };
    let velocity = cart.velocity_at(&state, 0.4, &control);
    let expected = state.momentum.component_mul(&cart.mobility) + Vector3::y() * (0.8 * 0.4_f64.cos());
    assert!((velocity - expected).norm() < 1e-15);
    assert_eq!(cart.force(&state, &control, 0.4), -cart.drag * velocity);
    let energy = cart.hamiltonian(&state, &control, 0.4);
    assert!((cart.energy_at(&state, 0.4, &control) - energy).abs() < 1e-15);
}
