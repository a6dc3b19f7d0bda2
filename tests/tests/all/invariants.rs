//! What symmetry keeps, over many steps; and the quadrotor, on which forces act.

use coadjoint::nalgebra::{Matrix6, Translation3};
use coadjoint::prelude::*;
use coadjoint::{Discretized, Run, System};

/// What is left of an invariant of the size of 1 after so many steps: rounding, which grows like the root of their number.
const KEPT: f64 = 5e-12;
const STEPS: u64 = 25_000;

/// A top described by its attitude alone: gravity is a potential on the group.
#[lie_poisson_system(group = SO3, potential = weight * (attitude * chi).z, methods(Midpoint))]
struct Top {
    #[inertia]
    inertia: Vector3<f64>,
    weight: f64,
    chi: Vector3<f64>,
}

/// Two bodies that pull at each other's axes.
#[lie_poisson_system(
    group(first: SO3, second: SO3),
    potential = -stiffness * (first * axis).dot(&(second * axis)),
    methods(Midpoint),
)]
struct Pair {
    #[inertia(first)]
    first_inertia: Vector3<f64>,
    #[inertia(second)]
    second_inertia: Vector3<f64>,
    stiffness: f64,
    axis: Vector3<f64>,
}

#[lie_poisson_system(group = R3, potential = -strength / position.norm(), methods(Midpoint))]
struct Kepler {
    #[inertia]
    mass: f64,
    strength: f64,
}

/// A rigid body whose reference point is not its centre of mass.
#[lie_poisson_system(group = SE3)]
struct FreeBody {
    #[inertia]
    inertia: Matrix6<f64>,
}

/// The largest change of `quantity` over many steps.
fn drift<S, M>(system: &S, start: S::State, step: f64, quantity: impl Fn(&S, &S::State) -> Vec<f64>) -> f64
where
    S: System<Scalar = f64> + Discretized<M>,
{
    let mut state = start;
    let first = quantity(system, &state);
    let mut worst: f64 = 0.0;
    let mut stepper = system.stepper::<M>(step).expect("valid");
    Run::new(&mut stepper, &mut state)
        .every(100, |tick| {
            for (now, then) in quantity(system, tick.state).iter().zip(&first) {
                worst = worst.max((now - then).abs());
            }
        })
        .steps(STEPS)
        .expect("solvable");
    worst
}

#[test]
fn the_vertical_angular_momentum_of_a_top() {
    let top = || Top { inertia: vector![1.0, 1.4, 0.8], weight: 1.0, chi: vector![0.1, 0.2, 0.9] };
    let start = TopState {
        attitude: UnitQuaternion::from_euler_angles(0.4, 0.3, 0.2),
        momentum: vector![0.3, -0.2, 1.1],
    };
    let vertical = |top: &Top, state: &TopState| vec![top.spatial_momentum(state).z];
    for worst in [
        drift::<_, Exponential>(&top(), start, 0.01, vertical),
        drift::<_, Cayley>(&top(), start, 0.01, vertical),
        drift::<_, SymplecticEulerA>(&top(), start, 0.01, vertical),
        drift::<_, Midpoint<Cayley>>(&top(), start, 0.01, vertical),
    ] {
        assert!(worst < KEPT, "{worst:e}");
    }
    // the horizontal part does change
    let horizontal = |top: &Top, state: &TopState| vec![top.spatial_momentum(state).x];
    assert!(drift::<_, Exponential>(&top(), start, 0.01, horizontal) > 0.1);
}

#[test]
fn the_total_angular_momentum_of_two_bodies() {
    let pair = || Pair {
        first_inertia: vector![1.0, 2.0, 2.5],
        second_inertia: vector![0.5, 0.6, 0.7],
        stiffness: 0.8,
        axis: vector![0.0, 0.6, 0.8],
    };
    let start = PairState {
        first: UnitQuaternion::from_euler_angles(0.4, 0.3, 0.2),
        first_momentum: vector![0.3, -0.2, 1.1],
        second: UnitQuaternion::identity(),
        second_momentum: vector![-0.1, 0.5, 0.2],
    };
    let total = |pair: &Pair, state: &PairState| {
        let both = pair.spatial_momentum(state);
        (0..3).map(|i| both[i] + both[i + 3]).collect()
    };
    for worst in [
        drift::<_, Exponential>(&pair(), start, 0.01, total),
        drift::<_, Cayley>(&pair(), start, 0.01, total),
        drift::<_, Midpoint>(&pair(), start, 0.01, total),
    ] {
        assert!(worst < KEPT, "{worst:e}");
    }
    let first = |pair: &Pair, state: &PairState| vec![pair.spatial_momentum(state)[0]];
    assert!(drift::<_, Exponential>(&pair(), start, 0.01, first) > 0.1);
}

#[test]
fn keplers_angular_momentum() {
    let kepler = || Kepler { mass: 1.0, strength: 1.0 };
    let start = KeplerState { position: vector![0.4, 0.0, 0.0], momentum: vector![0.0, 1.8, 0.6] };
    let angular = |_: &Kepler, state: &KeplerState| {
        state.position.cross(&state.momentum).iter().copied().collect::<Vec<f64>>()
    };
    for worst in [
        drift::<_, Exponential>(&kepler(), start, 0.01, angular),
        drift::<_, SymplecticEulerA>(&kepler(), start, 0.01, angular),
        drift::<_, Midpoint>(&kepler(), start, 0.01, angular),
    ] {
        assert!(worst < KEPT, "{worst:e}");
    }
}

#[test]
fn linear_and_angular_momentum_of_a_free_body() {
    let mut inertia = Matrix6::from_diagonal(&vector![1.0, 1.5, 2.0, 1.2, 1.2, 1.2]);
    // mass times the centre of mass couples turning and moving
    for (i, j, coupling) in [(0, 4, -0.3), (0, 5, 0.2), (1, 3, 0.3), (2, 3, -0.2)] {
        inertia[(i, j)] = coupling;
        inertia[(j, i)] = coupling;
    }
    let body = || FreeBody { inertia };
    let start = FreeBodyState {
        pose: Isometry3::from_parts(
            Translation3::new(0.1, 0.2, -0.3),
            UnitQuaternion::from_euler_angles(0.4, 0.3, 0.2),
        ),
        momentum: vector![0.3, -0.2, 0.6, 0.02, 0.01, -0.03],
    };
    let momentum =
        |body: &FreeBody, state: &FreeBodyState| body.spatial_momentum(state).iter().copied().collect();
    for worst in [
        drift::<_, Exponential>(&body(), start, 0.01, momentum),
        drift::<_, Cayley>(&body(), start, 0.01, momentum),
    ] {
        assert!(worst < 2.0 * KEPT, "{worst:e}");
    }
}

/// A quadrotor: moment in the body, thrust along its third axis, drag at its velocity.
#[lie_poisson_system(
    group(attitude: SO3, position: R3),
    control(moment: R3, thrust: f64),
    potential = mass * gravity * position.z,
    force(
        attitude = moment - damping * attitude_velocity,
        position = thrust * (attitude * Vector3::z()) - drag * position_velocity,
    ),
    methods(Midpoint),
)]
#[derive(Clone)]
struct Quadrotor {
    #[inertia(attitude)]
    inertia: Vector3<f64>,
    #[inertia(position)]
    mass: f64,
    gravity: f64,
    damping: f64,
    drag: f64,
}

impl Quadrotor {
    fn example() -> Self {
        Self { inertia: vector![0.02, 0.021, 0.04], mass: 1.3, gravity: 9.81, damping: 0.0, drag: 0.0 }
    }

    fn at_rest() -> QuadrotorState {
        QuadrotorState {
            attitude: UnitQuaternion::identity(),
            attitude_momentum: Vector3::zeros(),
            position: vector![0.0, 0.0, 1.0],
            position_momentum: Vector3::zeros(),
        }
    }

    fn hover(&self) -> QuadrotorControl {
        QuadrotorControl { moment: Vector3::zeros(), thrust: self.mass * self.gravity }
    }
}

#[test]
fn a_quadrotor_in_hover_stays_where_it_is() {
    fn check<M>()
    where
        Quadrotor: Discretized<M>,
    {
        let quadrotor = Quadrotor::example();
        let start = Quadrotor::at_rest();
        let mut state = start;
        let mut stepper = quadrotor.stepper::<M>(0.01).expect("valid");
        let hover = quadrotor.hover();
        Run::new(&mut stepper, &mut state).controlled_by(|_, _| hover).steps(50_000).expect("solvable");
        assert_eq!(state, start);
    }
    check::<Exponential>();
    check::<Cayley>();
    check::<Midpoint>();
}

#[test]
fn a_turning_quadrotor_stays_on_the_group_for_half_an_hour() {
    let quadrotor = Quadrotor::example();
    let mut state = QuadrotorState { attitude_momentum: vector![0.01, 0.02, 0.01], ..Quadrotor::at_rest() };
    let mut stepper = quadrotor.stepper::<Exponential>(0.01).expect("valid");
    let mut worst: f64 = 0.0;
    Run::new(&mut stepper, &mut state)
        .controlled_by(|state: &QuadrotorState, time| QuadrotorControl {
            moment: vector![0.001 * time.sin(), 0.0, -0.0005 * time.cos()],
            thrust: 10.0 + state.attitude.w,
        })
        .each(|tick| worst = worst.max((tick.state.attitude.coords.norm() - 1.0).abs()))
        .steps(180_000)
        .expect("solvable");
    assert!(worst < 1e-14, "{worst:e}");
}

#[test]
fn the_forced_response_converges_with_the_methods_order() {
    fn order<M>() -> f64
    where
        Quadrotor: Discretized<M>,
    {
        let quadrotor = Quadrotor { damping: 0.01, drag: 0.3, ..Quadrotor::example() };
        let control = QuadrotorControl { moment: vector![0.01, -0.02, 0.03], thrust: 14.0 };
        let end = |steps: u32| {
            let mut state = Quadrotor::at_rest();
            let mut stepper = quadrotor.stepper::<M>(1.0 / f64::from(steps)).expect("valid");
            for _ in 0..steps {
                stepper.step_with(&mut state, &control).expect("solvable");
            }
            let mut components = state.to_components().to_vec();
            components.truncate(11);
            components
        };
        let ends: Vec<_> = [32, 64, 128, 256].map(end).into();
        let changes: Vec<f64> = ends
            .windows(2)
            .map(|pair| pair[0].iter().zip(&pair[1]).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt())
            .collect();
        (changes[1] / changes[2]).log2()
    }
    for (order, expected) in [
        (order::<SymplecticEulerA>(), 1.0),
        (order::<SymplecticEulerB<Cayley>>(), 1.0),
        (order::<Exponential>(), 2.0),
        (order::<Cayley>(), 2.0),
        (order::<Midpoint>(), 2.0),
        (order::<Order4<Exponential>>(), 4.0),
    ] {
        assert!((order - expected).abs() < 0.1, "{order} for {expected}");
    }
}
