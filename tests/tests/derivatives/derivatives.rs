//! Derivatives of steps, as generated: every block against dual numbers through the same step, and what must hold of them whatever the
//! system.

use coadjoint::composition::{Order4, Order10};
mod described;

use coadjoint::__private::{Geometry, RetractionKind};
use coadjoint::derivative::{
    Adjoint, CheckpointedTape, Dense, Derives, Linearizable, Parts, Perturbation, Tangent, WrtControl,
    WrtParameters, WrtState,
};
use coadjoint::nalgebra::{DMatrix, DVector};
use coadjoint::prelude::*;
use coadjoint::system::Role;
use coadjoint::{Control, Discretized, RightLift, State, System, TangentLift};
use coadjoint_support::array;
use coadjoint_support::dual::{self, AnyStep, Input};
use coadjoint_support::random::Random;
use coadjoint_systems::*;

/// Relative to the largest entry of a block.
const ROUNDING: f64 = 1e-13;

/// A system with something to start from, and a step.
trait Example:
    System<Scalar = f64>
    + Geometry
    + Derives<WrtState>
    + Derives<WrtControl>
    + Derives<WrtParameters>
    + Derives<Tangent>
    + Derives<Adjoint>
{
    const STEP: f64;
    fn example() -> (Self, Self::State, Self::Control);
}

/// The systems that the program knows, described with derivatives, and the program's examples.
macro_rules! examples {
    ($($module:ident::$system:ident $(= $example:expr)?),* $(,)?) => {
        $(impl Example for described::$system {
            const STEP: f64 = <$module::$system as coadjoint_app::Example>::STEP;
            fn example() -> (Self, Self::State, Self::Control) {
                let examples = [$(|| $example,)? <$module::$system as coadjoint_app::Example>::example];
                let (known, start) = examples[0]();
                let control = coadjoint_app::Example::control(&known, &start, 0.0);
                let system = Self::from_parameters(&known.to_parameters());
                let state = <Self as System>::State::from_components(&start.to_components());
                // it is the same system
                assert_eq!(<Self as System>::State::QUANTITIES.len(), start.quantities().len());
                assert_eq!(system.energy_at(&state, 0.3, &Default::default()), known.energy_at(&start, 0.3, &Default::default()));
                assert_eq!(system.casimirs(&state), known.casimirs(&start));
                (system, state, Control::from_components(&control.to_components()))
            }
        })*
    };
}

/// The quantities of a state.
trait Quantities: State {
    fn quantities(&self) -> &'static [coadjoint::system::Quantity] {
        Self::QUANTITIES
    }
}

impl<S: State> Quantities for S {}

/// Not as thin as the program's: about its axis that one has so little inertia that the derivative with respect to this is all rounding.
fn thick_rod() -> (spherical_pendulum::SphericalPendulum, spherical_pendulum::SphericalPendulumState) {
    let pendulum = spherical_pendulum::SphericalPendulum::rod(1.0, 1.0, 0.1);
    let start = pendulum.sideways(60_f64.to_radians(), 0.4);
    (pendulum, start)
}

examples! {
    harmonic_oscillator::HarmonicOscillator, kepler::Kepler, planar_pendulum::PlanarPendulum,
    spherical_pendulum::SphericalPendulum = thick_rod(),
    free_rigid_body::FreeRigidBody, full_rigid_body::FullRigidBody,
    heavy_top::HeavyTop, magnetic_top::MagneticTop, quadrotor::Quadrotor,
    rigid_body_in_space::RigidBodyInSpace, gyrostat::Gyrostat, coupled_bodies::CoupledBodies,
    kirchhoff::Kirchhoff, satellite_with_wheels::SatelliteWithWheels,
}

/// A sledge that is pushed and steered on a slope, with a wind that comes and goes.
#[lie_poisson_system(
    group = SE2,
    control(push: f64, steer: f64),
    potential = weight * pose.translation.x + 0.1 * weight * pose.translation.y.powi(2),
    force = Vector3::new(steer + wind * t.sin(), push - drag * velocity.y, -drag * velocity.z),
    derivatives,
    methods(Midpoint, TangentLift),
)]
#[derive(Clone, Debug)]
struct Sledge {
    #[inertia]
    inertia: Matrix3<f64>,
    weight: f64,
    wind: f64,
    drag: f64,
}

impl Example for Sledge {
    const STEP: f64 = 0.05;
    fn example() -> (Self, SledgeState, SledgeControl) {
        let inertia = matrix![2.0, 0.1, 0.3; 0.1, 1.5, 0.2; 0.3, 0.2, 1.2];
        let pose = Isometry2::new(vector![0.3, -0.2], 0.4);
        let state = SledgeState { pose, momentum: vector![0.5, -0.4, 0.8] };
        let sledge = Self { inertia, weight: 1.5, wind: 0.4, drag: 0.3 };
        (sledge, state, SledgeControl { push: 0.6, steer: -0.2 })
    }
}

impl Example for described::SpinChain {
    const STEP: f64 = <spin_chain::SpinChain as coadjoint_app::Example>::STEP;
    fn example() -> (Self, Self::State, Self::Control) {
        let (known, start) = <spin_chain::SpinChain as coadjoint_app::Example>::example();
        let state = <Self as System>::State::from_components(&start.to_components());
        (Self::from_parameters(&known.to_parameters()), state, Default::default())
    }
}

/// A right-invariant system with a direction that it takes along.
#[lie_poisson_system(
    group = SO3,
    invariance = right,
    advected(field: R3),
    potential = strength * field.dot(&axis) + 0.2 * field.norm_squared().powi(2),
    derivatives,
    methods(Midpoint, SymplecticEulerB),
)]
#[derive(Clone, Debug)]
struct Flow {
    #[inertia]
    inertia: Matrix3<f64>,
    strength: f64,
    axis: Vector3<f64>,
}

impl Example for Flow {
    const STEP: f64 = 0.1;
    fn example() -> (Self, FlowState, <Self as System>::Control) {
        let inertia = matrix![1.0, 0.1, 0.2; 0.1, 2.0, 0.3; 0.2, 0.3, 2.5];
        let state = FlowState {
            attitude: UnitQuaternion::new(vector![0.3, 0.1, -0.4]),
            momentum: vector![0.5, -0.8, 1.1],
            field: vector![0.2, 0.7, -0.3],
        };
        (Self { inertia, strength: 0.7, axis: vector![0.1, -0.5, 0.9] }, state, Default::default())
    }
}

/// A raft on a stream, seen from the bank: its velocity is that of the plane that it carries along, at the origin there.
#[lie_poisson_system(
    group = SE2,
    invariance = right,
    control(push: f64, steer: f64),
    potential = weight * pose.translation.x + 0.1 * weight * pose.translation.y.powi(2) + keel * pose.rotation.re,
    force = Vector3::new(steer + wind * t.sin(), push - drag * velocity.y, -drag * velocity.z),
    derivatives,
    methods(Midpoint, TangentLift),
)]
#[derive(Clone, Debug)]
struct Raft {
    #[inertia]
    inertia: Matrix3<f64>,
    weight: f64,
    keel: f64,
    wind: f64,
    drag: f64,
}

impl Example for Raft {
    const STEP: f64 = 0.05;
    fn example() -> (Self, RaftState, RaftControl) {
        let inertia = matrix![2.0, 0.1, 0.3; 0.1, 1.5, 0.2; 0.3, 0.2, 1.2];
        let pose = Isometry2::new(vector![0.3, -0.2], 0.4);
        let state = RaftState { pose, momentum: vector![0.5, -0.4, 0.8] };
        let raft = Self { inertia, weight: 1.5, keel: 0.7, wind: 0.4, drag: 0.3 };
        (raft, state, RaftControl { push: 0.6, steer: -0.2 })
    }
}

/// A spin in a field along an axis, and in its own.
#[lie_poisson_system(
    group = SU2,
    hamiltonian = field * momentum.z + 0.5 * response * momentum.x.powi(2) + momentum.y.powi(4),
    derivatives,
    methods(Midpoint, SymplecticEulerB),
)]
#[derive(Clone, Debug)]
struct Spin {
    field: f64,
    response: f64,
}

impl Example for Spin {
    const STEP: f64 = 0.1;
    fn example() -> (Self, SpinState, <Self as System>::Control) {
        let spin = UnitQuaternion::new(vector![0.3, 0.1, -0.4]);
        let state = SpinState { spin, momentum: vector![0.5, -0.8, 1.1] };
        (Self { field: 0.7, response: 1.3 }, state, Default::default())
    }
}

/// Near the example: parameters, a state and controls.
fn sample<S: Example>(random: &mut Random) -> (S, S::State, S::Control) {
    let (system, start, control) = S::example();
    // all by one factor, so that what is symmetric stays so
    let factor = random.between(0.8, 1.25);
    let parameters = system.to_parameters();
    let parameters: S::Parameters<f64> = array(|i| factor * parameters.as_ref()[i]);
    let system = S::from_parameters(&parameters);
    system.validate().expect("valid parameters");

    let zero = system.differential(&start, 0.0, &Default::default());
    // momenta and advected parameters change in proportion: few moments are as large along all axes
    let (components, mut sizes, mut stored) = (start.to_components(), Vec::new(), 0);
    for quantity in S::State::QUANTITIES {
        let part = &components.as_ref()[stored..stored + quantity.components.len()];
        stored += part.len();
        match quantity.role {
            Role::Configuration => sizes.extend(vec![0.3; dual::dimension(quantity)]),
            _ => sizes.extend(part.iter().map(|x| 0.3 * x)),
        }
    }
    assert_eq!(zero.as_ref().len(), sizes.len());
    let by: S::Tangent = array(|i| sizes[i] * random.between(-1.0, 1.0));
    let state = system.displace(&start, RetractionKind::Exponential, &by);
    let control = control.to_components();
    let control: <S::Control as Control>::Components =
        array(|i| control.as_ref()[i] + random.between(-0.5, 0.5));
    (system, state, S::Control::from_components(&control))
}

fn matrix<M>(matrix: &M, rows: usize) -> DMatrix<f64>
where
    M: Dense<f64>,
{
    let entries = matrix.as_slice();
    DMatrix::from_column_slice(rows, entries.len() / rows, entries)
}

/// The largest difference, relative to the largest entry.
fn difference(a: &DMatrix<f64>, b: &DMatrix<f64>) -> f64 {
    assert_eq!(a.shape(), b.shape());
    if a.is_empty() {
        return 0.0;
    }
    let size = b.amax();
    if size == 0.0 { a.amax() } else { (a - b).amax() / size }
}

/// The Poisson tensor at a state, column by column.
fn poisson<S: Example>(system: &S, state: &S::State) -> DMatrix<f64> {
    let n = <S::StateVector as Dense<f64>>::ROWS;
    let columns = (0..n).map(|j| {
        let unit: S::Tangent = array(|i| f64::from(u8::from(i == j)));
        DVector::from_column_slice(system.hamiltonian_vector(state, &unit).as_ref())
    });
    DMatrix::from_columns(&columns.collect::<Vec<_>>())
}

/// A step's derivative in all ways that there are, as numbers: what is said of them is compiled once for all systems and schemes.
struct Taken {
    what: String,
    /// By state, controls and parameters.
    blocks: [DMatrix<f64>; 3],
    /// The same, column by column, by dual numbers.
    columns: [Vec<Vec<f64>>; 3],
    /// The same, each block by itself or with another one.
    alone: [Vec<f64>; 3],
    /// The Poisson tensor before and after the step, if the step is a Poisson map.
    poisson: Option<[DMatrix<f64>; 2]>,
    /// A perturbation of state, controls and parameters, and what becomes of it.
    perturbation: [Vec<f64>; 3],
    tangent: Vec<f64>,
    /// A costate, and what becomes of it.
    costate: Vec<f64>,
    gradient: [Vec<f64>; 3],
}

fn taken<S, M>(seed: u64) -> Taken
where
    S: Example + Discretized<M>,
    <S as Discretized<M>>::Method<f64>: Linearizable<S>,
    M: AnyStep<S>,
{
    let what = format!("{} {}", S::NAME, core::any::type_name::<M>());
    let mut random = Random::new(seed + 1);
    let (system, mut start, control) = sample::<S>(&mut random);
    // wherever the motion leads to
    let mut stepper = system.stepper::<M>(<S as Example>::STEP).expect("valid");
    stepper.set_time(random.between(0.0, 3.0));
    for _ in 0..30 {
        stepper.step_with(&mut start, &control).expect("solvable");
    }
    let time = stepper.time();
    let mut state = start.clone();
    let all = (WrtState, WrtControl, WrtParameters);
    let (derivative, _) = stepper
        .step_with_derivative(&mut state, &control)
        .unwrap_or_else(|error| panic!("{what}: {error:?}"));
    let (wrt_state, wrt_control, wrt_parameters) = derivative.jacobian(all);
    let n = wrt_state.as_slice().len().isqrt();
    let blocks = [matrix(&wrt_state, n), matrix(&wrt_control, n), matrix(&wrt_parameters, n)];
    let inputs: [fn(usize) -> Input; 3] = [Input::State, Input::Control, Input::Parameters];
    let column = |input| dual::column::<S, M>(&system, <S as Example>::STEP, &start, time, &control, input);
    let columns = core::array::from_fn(|i| (0..blocks[i].ncols()).map(|j| column(inputs[i](j))).collect());

    let (parameters_alone, control_alone) = derivative.jacobian((WrtParameters, WrtControl));
    let alone = [
        derivative.jacobian(WrtState).as_slice().to_vec(),
        control_alone.as_slice().to_vec(),
        parameters_alone.as_slice().to_vec(),
    ];
    let poisson = (!S::FORCED).then(|| [poisson(&system, &start), poisson(&system, &state)]);

    let mut perturbation = Perturbation::<S>::default();
    let mut fill = |slice: &mut [f64]| slice.iter_mut().for_each(|x| *x = random.between(-1.0, 1.0));
    fill(perturbation.state.as_mut_slice());
    fill(perturbation.control.as_mut_slice());
    fill(perturbation.parameters.as_mut_slice());
    let mut costate = <S::StateVector as Dense<f64>>::zeros();
    fill(costate.as_mut_slice());
    let parts = |of: &Perturbation<S>| {
        [of.state.as_slice().to_vec(), of.control.as_slice().to_vec(), of.parameters.as_slice().to_vec()]
    };
    let (tangent, gradient) = (derivative.tangent(&perturbation), derivative.adjoint(&costate));
    Taken {
        what,
        blocks,
        columns,
        alone,
        poisson,
        perturbation: parts(&perturbation),
        tangent: tangent.as_slice().to_vec(),
        costate: costate.as_slice().to_vec(),
        gradient: parts(&gradient),
    }
}

impl Taken {
    /// The Jacobians against dual numbers, products and transpose against the Jacobians. Returns the largest relative error.
    fn check(&self) -> f64 {
        let Self { what, blocks, columns, .. } = self;
        let mut worst = 0.0_f64;
        for (block, columns) in blocks.iter().zip(columns) {
            let expected = DMatrix::from_fn(block.nrows(), columns.len(), |i, j| columns[j][i]);
            let error = difference(block, &expected);
            assert!(error < ROUNDING, "{what}: {error:e}");
            worst = worst.max(error);
        }
        let [wrt_state, ..] = blocks;
        if let Some([before, after]) = &self.poisson {
            let carried = wrt_state * before * wrt_state.transpose();
            let size = wrt_state.map(f64::abs) * before.map(f64::abs) * wrt_state.transpose().map(f64::abs);
            let error = (carried - after).amax() / size.amax();
            assert!(error < ROUNDING, "{what}: D P Dᵀ is not P, {error:e}");
            let error = (wrt_state.determinant() - 1.0).abs();
            assert!(error < ROUNDING, "{what}: volume changes, {error:e}");
        }
        // blocks one by one are those of all together
        let together = blocks.each_ref().map(|block| block.as_slice().to_vec());
        assert_eq!(self.alone, together, "{what}");

        // products are with the same matrices, and the transpose is one
        let parts = self.perturbation.each_ref().map(|part| DVector::from_column_slice(part));
        let product = blocks.iter().zip(&parts).map(|(block, part)| block * part).sum::<DVector<f64>>();
        let tangent = DVector::from_column_slice(&self.tangent);
        assert!((&tangent - &product).amax() < ROUNDING * product.amax(), "{what}");

        let costate = DVector::from_column_slice(&self.costate);
        let gradients = self.gradient.each_ref().map(|gradient| DVector::from_column_slice(gradient));
        for (block, gradient) in blocks.iter().zip(&gradients) {
            let product = block.tr_mul(&costate);
            if !product.is_empty() {
                let error = (gradient - &product).amax();
                assert!(error <= ROUNDING * product.amax(), "{what}: {error:e}");
            }
        }
        // relative to the terms of the sums
        let forward = costate.dot(&tangent);
        let backward: f64 = gradients.iter().zip(&parts).map(|(g, x)| g.dot(x)).sum();
        let terms: f64 = gradients.iter().zip(&parts).map(|(g, x)| g.abs().dot(&x.abs())).sum();
        let error = (forward - backward).abs() / terms;
        assert!(error < 1e-13, "{what}: {error:e}");
        worst
    }
}

/// A step's derivative at three states.
fn check<S, M>(worst: &mut f64)
where
    S: Example + Discretized<M>,
    <S as Discretized<M>>::Method<f64>: Linearizable<S>,
    M: AnyStep<S>,
{
    for seed in 0..3 {
        *worst = worst.max(taken::<S, M>(seed).check());
    }
}

/// Two schemes of each system with a retraction.
macro_rules! both_schemes {
    ($($system:path: $retraction:ty),* $(,)?) => {{
        let mut worst = 0.0;
        $(
            check::<$system, Midpoint<$retraction>>(&mut worst);
            check::<$system, StormerVerlet<$retraction>>(&mut worst);
        )*
        worst
    }};
}

#[test]
fn every_block_of_every_system_is_that_of_dual_numbers() {
    // one retraction each: what is made of either is compared with differences of many digits for all kinds of systems
    let mut worst = both_schemes!(
        described::HarmonicOscillator: Cayley,
        described::Kepler: Exponential,
        described::PlanarPendulum: Exponential,
        described::SphericalPendulum: Cayley,
        described::FreeRigidBody: Cayley,
        described::FullRigidBody: Exponential,
        described::HeavyTop: Cayley,
        described::MagneticTop: Cayley,
        described::Quadrotor: Cayley,
        described::RigidBodyInSpace: Exponential,
        described::Gyrostat: Cayley,
        described::CoupledBodies: Exponential,
        described::Kirchhoff: Cayley,
        Sledge: Cayley,
        Flow: Cayley,
        Raft: Exponential,
        Spin: Exponential,
    );
    check::<described::SatelliteWithWheels, Midpoint<Exponential>>(&mut worst);
    check::<described::SpinChain, Midpoint<Cayley>>(&mut worst);
    // and both where factors, bodies and spaces differ most
    check::<described::HeavyTop, Midpoint<Exponential>>(&mut worst);
    check::<described::HeavyTop, StormerVerlet<Exponential>>(&mut worst);
    check::<described::RigidBodyInSpace, Midpoint<Cayley>>(&mut worst);
    check::<described::RigidBodyInSpace, StormerVerlet<Cayley>>(&mut worst);
    check::<described::Gyrostat, Midpoint<Exponential>>(&mut worst);
    check::<described::Gyrostat, StormerVerlet<Exponential>>(&mut worst);
    check::<Flow, StormerVerlet<Exponential>>(&mut worst);
    check::<Sledge, StormerVerlet<Exponential>>(&mut worst);
    check::<Sledge, TangentLift<Exponential>>(&mut worst);
    check::<Sledge, TangentLift<Cayley>>(&mut worst);
    check::<Raft, TangentLift<Cayley>>(&mut worst);
    check::<described::Quadrotor, Order4<StormerVerlet<Cayley>>>(&mut worst);
    check::<described::HeavyTop, Order10<SymplecticEulerA<Cayley>>>(&mut worst);
    println!("largest relative error {worst:e}");
}

/// A step and its derivative along random directions of state, control and parameters, on groups of matrices: against differences of steps, to the sixth
/// order, of states that are displaced.
fn agrees_with_differences<S, M>(
    (system, start, control): (S, S::State, S::Control),
    (time, step): (f64, f64),
) where
    S: Geometry<Scalar = f64>
        + Derives<WrtState>
        + Derives<WrtControl>
        + Derives<WrtParameters>
        + Discretized<M>,
    <S as Discretized<M>>::Method<f64>: Linearizable<S>,
{
    let mut random = Random::new(11);
    let numbers = |x: &dyn AsRef<[f64]>| DVector::from_column_slice(x.as_ref());
    let stepped = |system: &S, mut state: S::State, control: &S::Control| {
        let mut stepper = system.stepper::<M>(step).expect("valid");
        stepper.set_time(time);
        stepper.step_with(&mut state, control).expect("solvable");
        state
    };
    let mut after = start.clone();
    let mut stepper = system.stepper::<M>(step).expect("valid");
    stepper.set_time(time);
    let blocks = (WrtState, WrtControl, WrtParameters);
    let taken = stepper.step_with_jacobian(&mut after, &control, blocks).expect("solvable");
    let (wrt_state, wrt_control, wrt_parameters) = taken.0;
    let n = wrt_state.as_slice().len().isqrt();
    let (parameters, controls) = (system.to_parameters(), control.to_components());
    // per 1, of each by its own size
    let mut along =
        |sizes: &[f64]| DVector::from_fn(sizes.len(), |i, _| sizes[i] * random.between(-1.0, 1.0));
    let momentum = numbers(&start.to_components());
    let momentum = momentum.rows(momentum.len() - n / 2, n / 2);
    let sizes: Vec<f64> =
        vec![1.0; n / 2].into_iter().chain(momentum.iter().map(|m| m.abs().max(1e-3))).collect();
    let of_state = along(&sizes);
    let of_control = along(&controls.as_ref().iter().map(|x| x.abs().max(1.0)).collect::<Vec<_>>());
    // constants that the energies name come behind the fields
    let fields = wrt_parameters.as_slice().len() / n;
    let of_parameters = along(&parameters.as_ref()[..fields]);
    let changed = |share: f64| {
        let by = &of_state * share;
        let state = displaced(&system, &start, by.as_slice());
        stepped(&system, state, &control)
    };
    let with_control = |share: f64| {
        let components = array(|i| controls.as_ref()[i] + share * of_control[i]);
        stepped(&system, start.clone(), &S::Control::from_components(&components))
    };
    let with_parameters = |share: f64| {
        let parameters = array(|i| parameters.as_ref()[i] + share * of_parameters.get(i).unwrap_or(&0.0));
        stepped(&S::from_parameters(&parameters), start.clone(), &control)
    };
    // with the same differences of what the derivative says
    let slope = |state: &dyn Fn(f64) -> S::State| slope(|share| numbers(&state(share).to_components()));
    let changed: &dyn Fn(f64) -> S::State = &changed;
    let cases = [
        ("state", changed, matrix(&wrt_state, n) * &of_state),
        ("control", &with_control, matrix(&wrt_control, n) * &of_control),
        ("parameters", &with_parameters, matrix(&wrt_parameters, n) * &of_parameters),
    ];
    for (name, state, derivative) in cases {
        if name == "control" && of_control.is_empty() {
            continue;
        }
        assert!(derivative.amax() > 0.0, "{} {name}", S::NAME);
        let said = |share: f64| displaced(&system, &after, (&derivative * share).as_slice());
        let (found, said) = (slope(state), slope(&said));
        // configuration and momentum each in its own size, or that of the rounding of differences
        let at = found.len() - n / 2;
        let after = numbers(&after.to_components());
        for (from, rows) in [(0, at), (at, n / 2)] {
            let [found, said, after] = [&found, &said, &after].map(|x| x.rows(from, rows).into_owned());
            let error = (&found - said).amax() / found.amax().max(0.01 * after.amax());
            println!("{} {name}: {error:.1e}", S::NAME);
            assert!(error < 5e-11, "{} {name}: {error:e}", S::NAME);
        }
    }
}

/// The systems of the catalogue whose elements are matrices.
#[test]
fn groups_of_matrices_have_derivatives_too() {
    fn known<S: System<Scalar = f64>, T: coadjoint_app::Example<Scalar = f64>>() -> (S, S::State, S::Control)
    {
        let (known, start) = T::example();
        let control = coadjoint_app::Example::control(&known, &start, 0.0);
        let system = S::from_parameters(&array(|i| known.to_parameters().as_ref()[i]));
        let state = S::State::from_components(&array(|i| start.to_components().as_ref()[i]));
        let the_same = S::Control::from_components(&array(|i| control.to_components().as_ref()[i]));
        // it is the same system
        assert_eq!(system.energy_at(&state, 0.9e-6, &the_same), known.energy_at(&start, 0.9e-6, &control));
        (system, state, the_same)
    }
    use described::{AffineBody, FourDimensionalBody, Navigation, ThreeLevelAtom};
    let (body, start, control) = known::<FourDimensionalBody, four_dimensional_body::FourDimensionalBody>();
    agrees_with_differences::<_, SymplecticEulerA<Cayley>>((body, start, control), (0.0, 0.1));
    let (body, start, control) = known::<AffineBody, affine_body::AffineBody>();
    agrees_with_differences::<_, StormerVerlet<Cayley>>((body, start, control), (0.0, 5e-4));
    let (vehicle, start, control) = known::<Navigation, navigation::Navigation>();
    agrees_with_differences::<_, StormerVerlet<Cayley>>((vehicle, start, control), (0.0, 0.05));
    let (atom, start, control) = known::<ThreeLevelAtom, three_level_atom::ThreeLevelAtom>();
    // between the pulses
    let atom = ThreeLevelAtom { detuning: 1e7, two_photon_detuning: 3e6, ..atom };
    agrees_with_differences::<_, StormerVerlet<Exponential>>((atom, start, control), (0.9e-6, 3e-9));
}

/// The state displaced by a tangent vector.
fn displaced<S: Geometry<Scalar = f64>>(system: &S, state: &S::State, by: &[f64]) -> S::State {
    system.displace(state, RetractionKind::Exponential, &array(|i| by[i]))
}

/// The derivative at 0, by differences of order 6.
fn slope(of: impl Fn(f64) -> DVector<f64>) -> DVector<f64> {
    let difference = |k: f64| (of(2e-3 * k) - of(-2e-3 * k)) / (4e-3 * k);
    (difference(1.0) * 15.0 - difference(2.0) * 6.0 + difference(3.0)) / 10.0
}

/// The gradient of a function of the stored numbers of a run's end, attitudes included, by start, controls and parameters: against differences of runs
/// from displaced states.
fn gradient_agrees_with_differences<S: Example + Discretized<M>, M>()
where
    <S as Discretized<M>>::Method<f64>: Linearizable<S>,
{
    let (system, start, control) = sample::<S>(&mut Random::new(17));
    let numbers = |state: &S::State| DVector::from_column_slice(state.to_components().as_ref());
    let run = |system: &S, mut state: S::State, control: &S::Control| {
        let mut stepper = system.stepper::<M>(<S as Example>::STEP).expect("valid");
        let held = control.clone();
        let tape = CheckpointedTape::new(&mut stepper, &mut state, 20, move |_| held.clone());
        (tape.expect("solvable"), state)
    };
    let (tape, end) = run(&system, start.clone(), &control);
    let mut random = Random::new(18);
    let weights = DVector::from_fn(numbers(&end).len(), |_, _| random.between(-1.0, 1.0));
    let loss = |state: &S::State| DVector::from_element(1, weights.dot(&numbers(state)));
    let mut costate = <S::StateVector as Dense<f64>>::zeros();
    let n = costate.as_slice().len();
    let along = |state: &S::State, i: usize, share: f64| {
        let by: Vec<f64> = (0..n).map(|k| if k == i { share } else { 0.0 }).collect();
        displaced(&system, state, &by)
    };
    for (i, entry) in costate.as_mut_slice().iter_mut().enumerate() {
        *entry = slope(|share| loss(&along(&end, i, share)))[0];
    }
    let gradient = tape.gradient(&costate).expect("smooth");
    let agree = |what: &str, found: &[f64], difference: &dyn Fn(usize, f64) -> S::State| {
        for (i, found) in found.iter().enumerate() {
            let expected = slope(|share| loss(&difference(i, share)))[0];
            let error = (found - expected).abs();
            assert!(error < 1e-9, "{} {what} {i}: {found} is not {expected}", S::NAME);
        }
    };
    agree("state", gradient.state.as_slice(), &|i, share| run(&system, along(&start, i, share), &control).1);
    let controls = control.to_components();
    agree("control", gradient.control.as_slice(), &|i, share| {
        let components = array(|k| controls.as_ref()[k] + if k == i { share } else { 0.0 });
        run(&system, start.clone(), &S::Control::from_components(&components)).1
    });
    // all by one factor, so that what is symmetric stays so
    let parameters = system.to_parameters();
    let along = gradient.parameters.as_slice().iter().zip(parameters.as_ref()).map(|(slope, by)| slope * by);
    agree("parameters", &[along.sum()], &|_, share| {
        let parameters = array(|k| parameters.as_ref()[k] * (1.0 + share));
        run(&S::from_parameters(&parameters), start.clone(), &control).1
    });
}

#[test]
fn gradients_of_what_sees_the_attitude_are_those_of_displaced_states() {
    gradient_agrees_with_differences::<Flow, Midpoint<Cayley>>();
    gradient_agrees_with_differences::<Flow, StormerVerlet<Exponential>>();
    gradient_agrees_with_differences::<Raft, StormerVerlet<Exponential>>();
    gradient_agrees_with_differences::<Raft, Midpoint<Cayley>>();
    gradient_agrees_with_differences::<Sledge, StormerVerlet<Exponential>>();
}

/// A run of a quadrotor with controls that change, and with its derivative on the way.
#[test]
fn a_run_backwards_is_the_transpose_of_the_run_forwards() {
    use described::{Quadrotor, QuadrotorControl};
    const STEPS: u64 = 130;
    let mut random = Random::new(7);
    let (system, start, control) = sample::<Quadrotor>(&mut random);
    let control = |step: u64| QuadrotorControl { thrust: control.thrust + (step as f64).sin(), ..control };
    let mut stepper = system.stepper::<Cayley>(0.01).expect("valid");
    stepper.set_time(0.3);

    // all of it by matrices, step by step
    type Columns = coadjoint::nalgebra::SMatrix<f64, 12, 12>;
    let (mut wrt_start, mut wrt_parameters) = (Columns::identity(), None);
    let mut wrt_controls = Vec::new();
    let mut state = start;
    for step in 0..STEPS {
        let blocks = (WrtState, WrtControl, WrtParameters);
        let taken = stepper.step_with_jacobian(&mut state, &control(step), blocks).expect("solvable");
        let (a, b, p) = taken.0;
        wrt_start = a * wrt_start;
        wrt_parameters = Some(wrt_parameters.map_or(p, |earlier| a * earlier + p));
        wrt_controls.iter_mut().for_each(|earlier| *earlier = a * *earlier);
        wrt_controls.push(b);
    }
    let wrt_parameters = wrt_parameters.expect("steps");

    let mut again = system.stepper::<Cayley>(0.01).expect("valid");
    again.set_time(0.3);
    let mut end = start;
    let run = CheckpointedTape::new(&mut again, &mut end, STEPS, control).expect("solvable");
    assert_eq!((end, again.time(), run.steps()), (state, stepper.time(), STEPS));
    // the square root of the steps, and no more
    assert!(run.checkpoint_count() <= 12, "{}", run.checkpoint_count());

    let mut perturbation = Perturbation::<Quadrotor>::default();
    let mut fill = |slice: &mut [f64]| slice.iter_mut().for_each(|x| *x = random.between(-1.0, 1.0));
    fill(perturbation.state.as_mut_slice());
    fill(perturbation.control.as_mut_slice());
    fill(perturbation.parameters.as_mut_slice());
    let mut costate = perturbation.state;
    fill(costate.as_mut_slice());

    let wrt_control = wrt_controls.iter().sum::<coadjoint::nalgebra::SMatrix<f64, 12, 4>>();
    let product = wrt_start * perturbation.state
        + wrt_control * perturbation.control
        + wrt_parameters * perturbation.parameters;
    let tangent = run.tangent(&perturbation).expect("as before");
    assert!((tangent - product).amax() < ROUNDING * product.amax(), "{tangent} {product}");

    let mut visited = Vec::new();
    let gradient = run.gradient_with(&costate, |step, _, control, _| visited.push((step, *control)));
    let gradient = gradient.expect("as before");
    let (forward, backward) = (
        costate.dot(&tangent),
        gradient.state.dot(&perturbation.state)
            + gradient.control.dot(&perturbation.control)
            + gradient.parameters.dot(&perturbation.parameters),
    );
    let terms = gradient.state.component_mul(&perturbation.state).map(f64::abs).sum()
        + gradient.control.component_mul(&perturbation.control).map(f64::abs).sum()
        + gradient.parameters.component_mul(&perturbation.parameters).map(f64::abs).sum();
    assert!((forward - backward).abs() < 1e-13 * terms, "{forward} {backward}");
    // every control by itself, the last one first
    assert_eq!(visited.len() as u64, STEPS);
    for ((step, of_control), expected) in visited.iter().zip((0..STEPS).rev()) {
        assert_eq!(*step, expected);
        let product = wrt_controls[*step as usize].tr_mul(&costate);
        assert!((of_control - product).amax() < ROUNDING * product.amax().max(1.0), "{step}");
    }
    assert_eq!(gradient, Parts { state: gradient.state, ..run.gradient(&costate).expect("as before") });

    // a function of all states on the way: the sum of what each contributes
    let total = run.gradient_with(&costate, |_, _, _, there| *there += costate).expect("as before").state;
    let mut expected = wrt_start.tr_mul(&costate);
    let (mut state, mut stepper) = (start, system.stepper::<Cayley>(0.01).expect("valid"));
    stepper.set_time(0.3);
    let mut so_far = Columns::identity();
    for step in 0..STEPS {
        expected += so_far.tr_mul(&costate);
        let taken = stepper.step_with_jacobian(&mut state, &control(step), WrtState).expect("solvable");
        so_far = taken.0 * so_far;
    }
    assert!((total - expected).amax() < ROUNDING * expected.amax(), "{total} {expected}");

    // no step, no change
    let none = CheckpointedTape::new(&mut stepper, &mut state, 0, control).expect("nothing to do");
    assert_eq!(none.gradient(&costate).expect("nothing to do").state, costate);
    assert_eq!(none.tangent(&perturbation).expect("nothing to do"), perturbation.state);
}

/// What cannot be stepped has no derivative, and is as before.
#[test]
fn an_error_leaves_the_state() {
    let (system, start, _) = sample::<described::FreeRigidBody>(&mut Random::new(3));
    let mut state = start;
    state.momentum.x = f64::NAN;
    let mut stepper = system.stepper::<Cayley>(0.1).expect("valid");
    let error = stepper.step_with_jacobian(&mut state, &NoControl::default(), WrtState);
    assert_eq!(error.map(|step| step.1), Err(StepError::NotFinite));
    assert_eq!((state.attitude, state.momentum.yz()), (start.attitude, start.momentum.yz()));
    let failed = CheckpointedTape::new(&mut stepper, &mut state, 5, |_| NoControl::default());
    assert_eq!(failed.expect_err("no number").step, 1);
    assert_eq!(stepper.time(), 0.0);
}

/// Carrying the momentum in space does not change the map, nor its derivative.
#[test]
fn a_carried_momentum_has_the_same_derivative() {
    let (system, start, control) = sample::<described::FreeRigidBody>(&mut Random::new(4));
    fn jacobian<M>(
        system: &described::FreeRigidBody,
        mut state: described::FreeRigidBodyState,
        control: &NoControl<f64>,
    ) -> coadjoint::nalgebra::Matrix6<f64>
    where
        described::FreeRigidBody: Discretized<M>,
        <described::FreeRigidBody as Discretized<M>>::Method<f64>: Linearizable<described::FreeRigidBody>,
    {
        let mut stepper = system.stepper::<M>(0.05).expect("valid");
        stepper.step_with(&mut state, control).expect("solvable");
        stepper.step_with_jacobian(&mut state, control, WrtState).expect("solvable").0
    }
    let plain = jacobian::<Midpoint<Cayley>>(&system, start, &control);
    let carried = jacobian::<RightLift<Midpoint<Cayley>>>(&system, start, &control);
    assert!((plain - carried).amax() < ROUNDING * plain.amax(), "{plain} {carried}");
    assert!((plain - coadjoint::nalgebra::Matrix6::identity()).amax() > 1e-3);
}

/// A free rigid body in single precision.
#[lie_poisson_system(group = SO3, derivatives)]
#[derive(Clone, Debug)]
struct SmallBody {
    #[inertia]
    inertia: Vector3<f32>,
}

#[test]
fn single_precision_has_derivatives_too() {
    let (body, start, control) = sample::<described::FreeRigidBody>(&mut Random::new(5));
    let small = SmallBody { inertia: body.inertia.cast() };
    let mut small_state = SmallBodyState { attitude: start.attitude.cast(), momentum: start.momentum.cast() };
    let mut state = start;
    let blocks = (WrtState, WrtParameters);
    let mut stepper = body.stepper::<Exponential>(0.05).expect("valid");
    let (a, p) = stepper.step_with_jacobian(&mut state, &control, blocks).expect("solvable").0;
    let mut stepper = small.stepper::<Exponential>(0.05).expect("valid");
    let step = stepper.step_with_jacobian(&mut small_state, &NoControl::default(), blocks);
    let (b, q) = step.expect("solvable").0;
    let of_state = (a - b.cast::<f64>()).amax() / a.amax();
    let of_parameters = (p - q.cast::<f64>()).amax() / p.amax();
    assert!(of_state < 3e-6 && of_parameters < 3e-6, "{of_state:e} {of_parameters:e}");
    assert!(of_state > 1e-10, "as good as double precision: {of_state:e}");
}
