//! What generating a step is worth: `cargo bench --no-default-features --features divan --bench generic`, with `-- quadrotor` for one system. Each system's generated steps, and the same
//! steps taken by the generic stepper, which has its derivatives by hand but no closed form of anything else. Both are compared first.
// a benchmark that cannot be made is to say so
#![allow(clippy::unwrap_used)]

use coadjoint::nalgebra::{SMatrix, SVector};
use coadjoint::prelude::*;
use coadjoint::{Discretized, System};
use coadjoint_app::Example;
use coadjoint_systems::classical::generic::{
    GenericStepper, MatrixGroup, MatrixRetraction, Mechanics, Phase, Product, SO3, Side, Translations,
};
use coadjoint_systems::coupled_bodies::{CoupledBodies, CoupledBodiesState};
use coadjoint_systems::quadrotor::{Quadrotor, QuadrotorControl, QuadrotorState};
use divan::Bencher;
use divan::counter::ItemsCount;

fn main() {
    divan::main();
}

const STEP: f64 = 0.01;
/// Generated steps in a sample's iteration: enough that a look at the clock does not count.
const STEPS: u64 = 256;

type Flight = Product<SO3, Translations<3>, 3, 3, 4, 3>;
type Pair = Product<SO3, SO3, 3, 3, 3, 3>;

/// The quadrotor with its derivatives by hand.
struct FlyingByHand(Quadrotor);

impl Mechanics<Flight, 7, 6> for FlyingByHand {
    type Control = QuadrotorControl;

    fn energy(&self, at: &Phase<7, 6>) -> f64 {
        let weight = self.0.mass * self.0.gravity;
        at.mu.dot(&self.velocity(at)) / 2.0 + weight * at.g[(5, 6)]
    }

    fn velocity(&self, at: &Phase<7, 6>) -> Vector6<f64> {
        let turning = at.mu.fixed_rows::<3>(0).component_div(&self.0.inertia);
        let moving = at.mu.fixed_rows::<3>(3) / self.0.mass;
        SVector::from_iterator(turning.iter().chain(&moving).copied())
    }

    fn slope(&self, _: &Phase<7, 6>, _: Side) -> Vector6<f64> {
        vector![0.0, 0.0, 0.0, 0.0, 0.0, self.0.mass * self.0.gravity]
    }

    fn force(&self, at: &Phase<7, 6>, control: &QuadrotorControl) -> Vector6<f64> {
        let pull = at.g.fixed_view::<3, 1>(0, 2) * control.thrust;
        SVector::from_iterator(control.moment.iter().chain(&pull).copied())
    }
}

/// The coupled bodies with their derivatives by hand.
struct CoupledByHand(CoupledBodies);

impl Mechanics<Pair, 6, 6> for CoupledByHand {
    type Control = NoControl<f64>;

    /// `cos θ` is half of the trace of `Q = R₁ᵀR₂`, less a half.
    fn energy(&self, at: &Phase<6, 6>) -> f64 {
        let cosine = (self.between(at).trace() - 1.0) / 2.0;
        at.mu.dot(&self.velocity(at)) / 2.0 + self.0.stiffness * (1.0 - cosine)
    }

    fn velocity(&self, at: &Phase<6, 6>) -> Vector6<f64> {
        let first = at.mu.fixed_rows::<3>(0).component_div(&self.0.first_inertia);
        let second = at.mu.fixed_rows::<3>(3).component_div(&self.0.second_inertia);
        SVector::from_iterator(first.iter().chain(&second).copied())
    }

    /// `∓k sin θ n`, with `2 sin θ n^ = Q − Qᵀ`.
    fn slope(&self, at: &Phase<6, 6>, _: Side) -> Vector6<f64> {
        let torque = SO3::vee(&self.between(at)) * self.0.stiffness;
        SVector::from_iterator((-torque).iter().chain(&torque).copied())
    }
}

impl CoupledByHand {
    fn between(&self, at: &Phase<6, 6>) -> Matrix3<f64> {
        at.g.fixed_view::<3, 3>(0, 0).tr_mul(&at.g.fixed_view::<3, 3>(3, 3))
    }
}

fn rotation(attitude: &UnitQuaternion<f64>) -> Matrix3<f64> {
    attitude.to_rotation_matrix().into_inner()
}

fn of_flight(state: &QuadrotorState) -> (SMatrix<f64, 7, 7>, Vector6<f64>) {
    let mut g = SMatrix::<f64, 7, 7>::identity();
    g.fixed_view_mut::<3, 3>(0, 0).copy_from(&rotation(&state.attitude));
    g.fixed_view_mut::<3, 1>(3, 6).copy_from(&state.position);
    let momenta = state.attitude_momentum.iter().chain(&state.position_momentum);
    (g, SVector::from_iterator(momenta.copied()))
}

fn of_pair(state: &CoupledBodiesState) -> (Matrix6<f64>, Vector6<f64>) {
    let mut g = Matrix6::zeros();
    g.fixed_view_mut::<3, 3>(0, 0).copy_from(&rotation(&state.first));
    g.fixed_view_mut::<3, 3>(3, 3).copy_from(&rotation(&state.second));
    let momenta = state.first_momentum.iter().chain(&state.second_momentum);
    (g, SVector::from_iterator(momenta.copied()))
}

fn generated<S, M>(bencher: Bencher<'_, '_>, system: &S, mut state: S::State, control: &S::Control)
where
    S: Discretized<M> + System<Scalar = f64>,
{
    let mut stepper = system.stepper::<M>(STEP).unwrap();
    bencher
        .counter(ItemsCount::new(STEPS))
        .bench_local(|| stepper.steps_with(&mut state, control, STEPS).unwrap());
}

/// The first steps are those of the generated stepper, and one after the other is timed.
fn generic<S, M, G, R, H, const N: usize, const D: usize>(
    bencher: Bencher<'_, '_>,
    (system, mut state, control): (&S, S::State, &S::Control),
    mut generic: GenericStepper<G, R, H, N, D>,
    matrices: impl Fn(&S::State) -> (SMatrix<f64, N, N>, SVector<f64, D>),
) where
    S: Discretized<M> + System<Scalar = f64>,
    S::State: Clone,
    G: MatrixGroup<N, D>,
    R: MatrixRetraction<G, N, D>,
    H: Mechanics<G, N, D, Control = S::Control>,
{
    let (mut g, mut mu) = matrices(&state);
    let mut stepper = system.stepper::<M>(STEP).unwrap();
    for _ in 0..10 {
        stepper.step_with(&mut state, control).unwrap();
        generic.step_with(&mut g, &mut mu, control, 0.0).unwrap();
        let (of_g, of_mu) = matrices(&state);
        assert!((of_g - g).amax() < 1e-12 && (of_mu - mu).amax() < 1e-12);
    }
    bencher
        .counter(ItemsCount::new(1_u64))
        .bench_local(|| generic.step_with(&mut g, &mut mu, control, 0.0).unwrap());
}

#[divan::bench(types = [Cayley, Exponential])]
fn quadrotor_generated<R>(bencher: Bencher<'_, '_>)
where
    Quadrotor: Discretized<SymplecticEulerA<R>>,
{
    let (quadrotor, start) = Quadrotor::example();
    generated::<_, SymplecticEulerA<R>>(bencher, &quadrotor, start, &quadrotor.hover());
}

#[divan::bench(types = [Cayley, Exponential])]
fn quadrotor_generic<R>(bencher: Bencher<'_, '_>)
where
    Quadrotor: Discretized<SymplecticEulerA<R>>,
    R: MatrixRetraction<Flight, 7, 6> + Default,
{
    let (quadrotor, start) = Quadrotor::example();
    let group = Product::of(SO3, Translations::<3>);
    let stepper = GenericStepper::new(group, R::default(), FlyingByHand(quadrotor.clone()), STEP).unwrap();
    let (system, control) = (&quadrotor, &quadrotor.hover());
    generic::<_, SymplecticEulerA<R>, _, _, _, 7, 6>(bencher, (system, start, control), stepper, of_flight);
}

#[divan::bench(types = [Cayley, Exponential])]
fn coupled_bodies_generated<R>(bencher: Bencher<'_, '_>)
where
    CoupledBodies: Discretized<SymplecticEulerA<R>>,
{
    let (bodies, start) = CoupledBodies::example();
    generated::<_, SymplecticEulerA<R>>(bencher, &bodies, start, &NoControl::default());
}

#[divan::bench(types = [Cayley, Exponential])]
fn coupled_bodies_generic<R>(bencher: Bencher<'_, '_>)
where
    CoupledBodies: Discretized<SymplecticEulerA<R>>,
    R: MatrixRetraction<Pair, 6, 6> + Default,
{
    let (bodies, start) = CoupledBodies::example();
    let group = Product::of(SO3, SO3);
    let stepper = GenericStepper::new(group, R::default(), CoupledByHand(bodies.clone()), STEP).unwrap();
    let system = (&bodies, start, &NoControl::default());
    generic::<_, SymplecticEulerA<R>, _, _, _, 6, 6>(bencher, system, stepper, of_pair);
}
