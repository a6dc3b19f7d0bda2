//! The paper's numbered methods of chapters 3, 5 and 6, as they are generated, against the same methods from definitions alone: five steps, both
//! retractions, and five members of every family. What the definitions know of a system is its energy and its force, as plain functions.

use coadjoint::nalgebra::{Matrix4, SMatrix, SVector};
use coadjoint::prelude::*;
use coadjoint::{Control, Discretized, Family, RightLift, State, System};
use coadjoint_support::dual::AnyStep;
use coadjoint_support::random::Random;
use coadjoint_systems::classical::generic::{
    GenericStepper, MatrixGroup, MatrixRetraction, Mechanics, Phase, Product, SE2, SO3, SO3Semidirect, SU2,
    Side, Translations,
};

/// The largest difference after five steps, of values of the size of 1.
const AGREE: f64 = 1e-13;
const STEPS: u32 = 5;
const STEP: f64 = 0.1;

/// A configuration as a matrix, and its momentum.
type Matrices<const N: usize, const D: usize> = (SMatrix<f64, N, N>, SVector<f64, D>);

/// Calls `check::<M, R>(s)` for every member of the family with both retractions.
macro_rules! for_each_member {
    ($check:ident) => {
        for_each_member!($check: Exponential, Cayley);
    };
    ($check:ident: $($retraction:ident),+) => {$(
        $check::<SymplecticEulerA<$retraction>, $retraction>(0.0);
        $check::<Family<$retraction, 1, 4>, $retraction>(0.25);
        $check::<Midpoint<$retraction>, $retraction>(0.5);
        $check::<Family<$retraction, 3, 4>, $retraction>(0.75);
        $check::<SymplecticEulerB<$retraction>, $retraction>(1.0);
    )+};
}

/// A scheme that can be compared with the generic stepper.
trait Steps<S: System> {
    /// The state after a step.
    fn after(system: &S, state: &S::State, control: &S::Control, time: f64) -> S::State;
}

/// By the step's equation alone, as generated: steppers that solve it are compared with it elsewhere, and take longer to compile.
impl<S, R, const N: u32, const D: u32> Steps<S> for Family<R, N, D>
where
    S: System<Scalar = f64>,
    Self: AnyStep<S>,
{
    fn after(system: &S, state: &S::State, control: &S::Control, time: f64) -> S::State {
        let (parameters, state) = (system.to_parameters(), state.to_components());
        S::State::from_components(&Self::step(&parameters, STEP, &state, time, &control.to_components()))
    }
}

impl<S, M> Steps<S> for RightLift<M>
where
    S: System<Scalar = f64> + Discretized<Self>,
{
    fn after(system: &S, state: &S::State, control: &S::Control, _: f64) -> S::State {
        let mut state = state.clone();
        system.stepper::<Self>(STEP).expect("valid").step_with(&mut state, control).expect("solvable");
        state
    }
}

/// Five steps of the scheme `M`, each with a control of its own, beside those of the generic stepper.
fn follow<S, M, G, R, H, const N: usize, const D: usize>(
    of: (&S, S::State),
    controls: &[S::Control],
    oracle: (G, H, Side),
    s: f64,
    matrices: impl Fn(&S::State) -> Matrices<N, D>,
) where
    S: System<Scalar = f64>,
    M: Steps<S>,
    S::State: Clone,
    G: MatrixGroup<N, D>,
    R: MatrixRetraction<G, N, D> + Default,
    H: Mechanics<G, N, D, Control = S::Control>,
{
    follow_columns::<S, M, G, R, H, N, D>(of, controls, oracle, s, N, matrices);
}

/// The same where only the first columns of the configuration's matrix are known of the state.
fn follow_columns<S, M, G, R, H, const N: usize, const D: usize>(
    (system, mut state): (&S, S::State),
    controls: &[S::Control],
    (group, mechanics, side): (G, H, Side),
    s: f64,
    columns: usize,
    matrices: impl Fn(&S::State) -> Matrices<N, D>,
) where
    S: System<Scalar = f64>,
    M: Steps<S>,
    S::State: Clone,
    G: MatrixGroup<N, D>,
    R: MatrixRetraction<G, N, D> + Default,
    H: Mechanics<G, N, D, Control = S::Control>,
{
    let generic = GenericStepper::new(group, R::default(), mechanics, STEP).expect("valid");
    let generic = generic.at(s).expect("finite").on(side);
    let mut states = vec![matrices(&state)];
    for k in 0..STEPS {
        state = M::after(system, &state, &controls[k as usize % controls.len()], f64::from(k) * STEP);
        states.push(matrices(&state));
    }
    let worst = furthest(generic, controls, columns, &states);
    let what = format!("{} with {}, s = {s}", std::any::type_name::<S>(), std::any::type_name::<M>());
    println!("{what}: {worst:.1e}");
    assert!(worst < AGREE, "{what}: {worst:e}");
}

/// How far the generic stepper goes from these states, each after a step more. Apart from the scheme that takes them, so that it is compiled once for all.
fn furthest<G, R, H, const N: usize, const D: usize>(
    mut generic: GenericStepper<G, R, H, N, D>,
    controls: &[H::Control],
    columns: usize,
    states: &[Matrices<N, D>],
) -> f64
where
    G: MatrixGroup<N, D>,
    R: MatrixRetraction<G, N, D>,
    H: Mechanics<G, N, D>,
{
    let (start, mut mu) = states[0];
    let (mut g, mut worst, mut time) = (start, 0.0_f64, 0.0);
    for (k, (of_g, of_mu)) in states[1..].iter().enumerate() {
        generic.step_with(&mut g, &mut mu, &controls[k % controls.len()], time).expect("solvable");
        worst = worst.max((of_g - g).columns(0, columns).amax()).max((of_mu - mu).amax());
        time = (k + 1) as f64 * STEP;
    }
    assert!((g - start).amax() > 0.01, "it moves");
    worst
}

fn no_control<S: System>() -> [S::Control; 1] {
    [S::Control::default()]
}

fn rotation(attitude: &UnitQuaternion<f64>) -> Matrix3<f64> {
    attitude.to_rotation_matrix().into_inner()
}

const INERTIA: Vector3<f64> = vector![1.0, 2.0, 2.5];
const ARM: Vector3<f64> = vector![0.3, -0.2, 0.9];

fn attitude() -> UnitQuaternion<f64> {
    UnitQuaternion::from_euler_angles(0.4, -0.7, 0.2)
}

// ------------------------------------------------------------------------------------------------ (3.1), (3.2)

/// A vector field on the rotations, `R' = R X(R)^`, as the Hamiltonian that is linear in the momentum.
#[lie_poisson_system(
    group = SO3,
    hamiltonian = {
        let seen = attitude.inverse() * target;
        momentum.dot(&(drift + gain * axis.cross(&seen)))
    },
    methods(Family(1, 4), Midpoint, Family(3, 4), SymplecticEulerB),
)]
struct Aimed {
    target: Vector3<f64>,
    axis: Vector3<f64>,
    drift: Vector3<f64>,
    gain: f64,
}

/// The same in space, `R' = X(R)^ R`.
#[lie_poisson_system(
    group = SO3,
    invariance = right,
    hamiltonian = {
        let seen = attitude.inverse() * target;
        momentum.dot(&(drift + gain * axis.cross(&seen)))
    },
    methods(Family(1, 4), Midpoint, Family(3, 4), SymplecticEulerB),
)]
struct AimedInSpace {
    target: Vector3<f64>,
    axis: Vector3<f64>,
    drift: Vector3<f64>,
    gain: f64,
}

const TARGET: Vector3<f64> = vector![0.2, 0.9, -0.4];
const AXIS: Vector3<f64> = vector![0.5, -0.3, 0.8];
const DRIFT: Vector3<f64> = vector![-0.2, 0.6, 0.3];

/// `h X̃(ḡ) = η` with `(g_k, g_{k+1}) = D(ḡ, η)`, for `D(ḡ, η) = (ḡ τ(−sη), ḡ τ((1−s)η))` or the factors the other way round.
fn discretized_field<R: MatrixRetraction<SO3, 3, 3>>(g: &Matrix3<f64>, s: f64, side: Side) -> Matrix3<f64> {
    let compose = |g: &Matrix3<f64>, h: &Matrix3<f64>| match side {
        Side::Left => g * h,
        Side::Right => h * g,
    };
    let tau = |x: &Vector3<f64>| R::retract(x).expect("inside of the domain");
    let middle = |eta: &Vector3<f64>| compose(g, &tau(&(eta * -s)).transpose());
    let mut eta = Vector3::zeros();
    for _ in 0..100 {
        eta = (DRIFT + 0.8 * AXIS.cross(&(middle(&eta).transpose() * TARGET))) * STEP;
    }
    compose(&middle(&eta), &tau(&(eta * (1.0 - s))))
}

#[test]
fn vector_fields_on_a_group_3_2() {
    fn check<M, R>(s: f64)
    where
        M: Steps<Aimed>,
        M: Steps<AimedInSpace>,
        R: MatrixRetraction<SO3, 3, 3>,
    {
        let (target, axis, drift, gain) = (TARGET, AXIS, DRIFT, 0.8);
        let (body, space) = (Aimed { target, axis, drift, gain }, AimedInSpace { target, axis, drift, gain });
        // where the momentum is 0 it stays so, and the motion does not depend on it
        for momentum in [Vector3::zeros(), vector![0.4, -0.9, 0.7]] {
            let mut left = AimedState { attitude: attitude(), momentum };
            let mut right = AimedInSpaceState { attitude: attitude(), momentum };
            let (mut g, mut h) = (rotation(&attitude()), rotation(&attitude()));
            for _ in 0..STEPS {
                left = <M as Steps<Aimed>>::after(&body, &left, &NoControl::default(), 0.0);
                right = <M as Steps<AimedInSpace>>::after(&space, &right, &NoControl::default(), 0.0);
                g = discretized_field::<R>(&g, s, Side::Left);
                h = discretized_field::<R>(&h, s, Side::Right);
            }
            let errors = [(rotation(&left.attitude) - g).amax(), (rotation(&right.attitude) - h).amax()];
            assert!(errors.iter().all(|error| *error < AGREE), "s = {s}: {errors:?}");
            assert!((g - h).amax() > 0.1, "the sides differ");
            if momentum == Vector3::zeros() {
                assert_eq!((left.momentum, right.momentum), (momentum, momentum));
            }
        }
    }
    for_each_member!(check);
}

// ------------------------------------------------------------------------------------------------ (5.2), (5.4)

/// A particle whose energy is not a sum of a kinetic and a potential one.
#[lie_poisson_system(
    group = R2,
    hamiltonian = {
        let stretched = 1.0 + softness * position.norm_squared();
        stretched * momentum.norm_squared() / 2.0 + position.x.powi(4) + position.x * momentum.y
    },
    methods(Family(1, 4), Midpoint, Family(3, 4), SymplecticEulerB),
)]
struct Bent {
    softness: f64,
}

impl Mechanics<Translations<2>, 3, 2> for Bent {
    type Control = NoControl<f64>;

    fn energy(&self, at: &Phase<3, 2>) -> f64 {
        let (x, y, p) = (at.g[(0, 2)], at.g[(1, 2)], at.mu);
        (1.0 + self.softness * (x * x + y * y)) * (p.x * p.x + p.y * p.y) / 2.0 + x.powi(4) + x * p.y
    }
}

#[test]
fn cotangent_lifts_on_a_vector_space_5_4() {
    fn check<M, R>(s: f64)
    where
        M: Steps<Bent>,
        R: MatrixRetraction<Translations<2>, 3, 2> + Default,
    {
        let bent = || Bent { softness: 0.3 };
        let state = BentState { position: vector![0.4, -0.7], momentum: vector![0.9, 0.2] };
        let oracle = (Translations::<2>, bent(), Side::Left);
        follow::<_, M, _, R, _, 3, 2>((&bent(), state), &no_control::<Bent>(), oracle, s, |state| {
            let mut g = Matrix3::identity();
            g.fixed_view_mut::<2, 1>(0, 2).copy_from(&state.position);
            (g, state.momentum)
        });
    }
    for_each_member!(check);
}

// ------------------------------------------------------------------------------------------------ (5.6), (5.8)

/// A body whose energy depends on where it is, on both sides, and in which momentum and attitude do not separate.
#[lie_poisson_system(
    group = SO3,
    hamiltonian = {
        let lever = attitude * arm;
        let kinetic = momentum.dot(&momentum.component_div(&moments)) / 2.0;
        kinetic * (1.0 + 0.2 * lever.x) + lever.z + 0.3 * lever.y.powi(2)
    },
    methods(Family(1, 4), Midpoint, Family(3, 4), SymplecticEulerB),
)]
struct Swaying {
    moments: Vector3<f64>,
    arm: Vector3<f64>,
}

/// The same function of the momentum in space.
#[lie_poisson_system(
    group = SO3,
    invariance = right,
    hamiltonian = {
        let lever = attitude * arm;
        let kinetic = momentum.dot(&momentum.component_div(&moments)) / 2.0;
        kinetic * (1.0 + 0.2 * lever.x) + lever.z + 0.3 * lever.y.powi(2)
    },
    methods(Family(1, 4), Midpoint, Family(3, 4), SymplecticEulerB),
)]
struct SwayingInSpace {
    moments: Vector3<f64>,
    arm: Vector3<f64>,
}

/// The energy of both.
struct SwayingEnergy;

impl Mechanics<SO3, 3, 3> for SwayingEnergy {
    type Control = NoControl<f64>;

    fn energy(&self, at: &Phase<3, 3>) -> f64 {
        let lever = at.g * ARM;
        let kinetic = at.mu.component_div(&INERTIA).dot(&at.mu) / 2.0;
        kinetic * (1.0 + 0.2 * lever.x) + lever.z + 0.3 * lever.y.powi(2)
    }
}

#[test]
fn cotangent_lifts_on_the_rotations_5_8() {
    fn check<M, R>(s: f64)
    where
        M: Steps<Swaying>,
        R: MatrixRetraction<SO3, 3, 3> + Default,
    {
        let swaying = Swaying { moments: INERTIA, arm: ARM };
        let state = SwayingState { attitude: attitude(), momentum: vector![0.9, -0.4, 1.2] };
        let oracle = (SO3, SwayingEnergy, Side::Left);
        follow::<_, M, _, R, _, 3, 3>((&swaying, state), &no_control::<Swaying>(), oracle, s, |state| {
            (rotation(&state.attitude), state.momentum)
        });
    }
    for_each_member!(check);
}

#[test]
fn right_cotangent_lifts_on_the_rotations_5_8() {
    fn check<M, R>(s: f64)
    where
        M: Steps<SwayingInSpace>,
        R: MatrixRetraction<SO3, 3, 3> + Default,
    {
        let swaying = SwayingInSpace { moments: INERTIA, arm: ARM };
        let state = SwayingInSpaceState { attitude: attitude(), momentum: vector![0.9, -0.4, 1.2] };
        let (controls, oracle) = (no_control::<SwayingInSpace>(), (SO3, SwayingEnergy, Side::Right));
        follow::<_, M, _, R, _, 3, 3>((&swaying, state), &controls, oracle, s, |state| {
            (rotation(&state.attitude), state.momentum)
        });
    }
    for_each_member!(check);
}

/// A body in the plane, its centre of mass off the origin, on a spring and under gravity.
#[lie_poisson_system(
    group = SE2,
    potential = {
        let eye = pose.transform_point(&Point2::from(eye)) - Point2::origin();
        0.7 * eye.norm_squared() + 0.4 * eye.y.powi(3) + weight * pose.translation.y
    },
    methods(Family(1, 4), Midpoint, Family(3, 4)),
)]
struct Plate {
    #[inertia]
    inertia: Matrix3<f64>,
    eye: Vector2<f64>,
    weight: f64,
}

impl Mechanics<SE2, 3, 3> for Plate {
    type Control = NoControl<f64>;

    fn energy(&self, at: &Phase<3, 3>) -> f64 {
        let eye = at.g * self.eye.push(1.0);
        let velocity = self.inertia.lu().solve(&at.mu).expect("regular");
        at.mu.dot(&velocity) / 2.0
            + 0.7 * (eye.x.powi(2) + eye.y.powi(2))
            + 0.4 * eye.y.powi(3)
            + self.weight * at.g.m23
    }
}

#[test]
fn cotangent_lifts_on_the_motions_of_the_plane_5_8() {
    fn check<M, R>(s: f64)
    where
        M: Steps<Plate>,
        R: MatrixRetraction<SE2, 3, 3> + Default,
    {
        let inertia = matrix![2.0, 0.1, 0.3; 0.1, 1.5, 0.2; 0.3, 0.2, 1.2];
        let plate = || Plate { inertia, eye: vector![0.3, -0.4], weight: 0.8 };
        let pose = Isometry2::new(vector![0.3, -0.2], 0.4);
        let state = PlateState { pose, momentum: vector![0.5, -0.4, 0.8] };
        let oracle = (SE2, plate(), Side::Left);
        follow::<_, M, _, R, _, 3, 3>((&plate(), state), &no_control::<Plate>(), oracle, s, |state| {
            (state.pose.to_homogeneous(), state.momentum)
        });
    }
    for_each_member!(check);
}

/// A body that knows how often it has turned: its energy is another one after a whole turn.
#[lie_poisson_system(
    group = SU2,
    potential = twist * spin.w + 0.5 * spin.i * spin.j,
    methods(Family(1, 4), Midpoint, Family(3, 4)),
)]
struct Twisted {
    #[inertia]
    inertia: Vector3<f64>,
    twist: f64,
}

impl Mechanics<SU2, 4, 3> for Twisted {
    type Control = NoControl<f64>;

    fn energy(&self, at: &Phase<4, 3>) -> f64 {
        let [w, x, y] = [0, 1, 2].map(|row| at.g[(row, 0)]);
        at.mu.component_div(&self.inertia).dot(&at.mu) / 2.0 + self.twist * w + 0.5 * x * y
    }
}

#[test]
fn cotangent_lifts_on_the_unit_quaternions_5_8() {
    fn check<M, R>(s: f64)
    where
        M: Steps<Twisted>,
        R: MatrixRetraction<SU2, 4, 3> + Default,
    {
        let twisted = || Twisted { inertia: INERTIA, twist: 0.8 };
        let state = TwistedState { spin: attitude(), momentum: vector![0.9, -0.4, 1.2] };
        let oracle = (SU2, twisted(), Side::Left);
        follow::<_, M, _, R, _, 4, 3>((&twisted(), state), &no_control::<Twisted>(), oracle, s, |state| {
            let q = state.spin;
            let (w, x, y, z) = (q.w, q.i, q.j, q.k);
            let g = matrix![w, -x, -y, -z; x, w, -z, y; y, z, w, -x; z, -y, x, w];
            (g, state.momentum)
        });
    }
    for_each_member!(check);
}

/// A buoy on an elastic rope.
#[lie_poisson_system(
    group = SE3,
    potential = {
        let eye = pose.transform_point(&Point3::from(eye)) - Point3::origin();
        0.7 * eye.norm_squared() - lift * pose.translation.z
    },
    methods(Family(1, 4)),
)]
struct Buoy {
    #[inertia]
    inertia: Vector6<f64>,
    eye: Vector3<f64>,
    lift: f64,
}

impl Mechanics<SO3Semidirect<1>, 4, 6> for Buoy {
    type Control = NoControl<f64>;

    fn energy(&self, at: &Phase<4, 6>) -> f64 {
        let eye = at.g * self.eye.push(1.0);
        let kinetic = at.mu.component_div(&self.inertia).dot(&at.mu) / 2.0;
        kinetic + 0.7 * (eye.x.powi(2) + eye.y.powi(2) + eye.z.powi(2)) - self.lift * at.g.m34
    }
}

#[test]
fn cotangent_lifts_on_the_motions_of_space_5_8() {
    fn check<M, R>(s: f64)
    where
        M: Steps<Buoy>,
        R: MatrixRetraction<SO3Semidirect<1>, 4, 6> + Default,
    {
        let inertia = vector![1.0, 1.2, 0.8, 1.5, 1.4, 1.1];
        let buoy = || Buoy { inertia, eye: vector![0.3, -0.4, 0.5], lift: 0.8 };
        let pose = Isometry3::from_parts(vector![0.3, -0.2, 0.1].into(), attitude());
        let state = BuoyState { pose, momentum: vector![0.9, -0.4, 1.2, 0.5, -0.4, 0.8] };
        let oracle = (SO3Semidirect::<1>, buoy(), Side::Left);
        follow::<_, M, _, R, _, 4, 6>((&buoy(), state), &no_control::<Buoy>(), oracle, s, |state| {
            (state.pose.to_homogeneous(), state.momentum)
        });
    }
    check::<SymplecticEulerA<Exponential>, Exponential>(0.0);
    check::<SymplecticEulerA<Cayley>, Cayley>(0.0);
    check::<Family<Exponential, 1, 4>, Exponential>(0.25);
    check::<Family<Cayley, 1, 4>, Cayley>(0.25);
    check::<SymplecticEulerB<Exponential>, Exponential>(1.0);
    check::<SymplecticEulerB<Cayley>, Cayley>(1.0);
}

// ------------------------------------------------------------------------------------------------ (6.5) to (6.13)

#[lie_poisson_system(group = SO3, methods(Family(1, 4), Midpoint, Family(3, 4), SymplecticEulerB))]
struct Body {
    #[inertia]
    inertia: Matrix3<f64>,
}

impl Mechanics<SO3, 3, 3> for Body {
    type Control = NoControl<f64>;

    fn energy(&self, at: &Phase<3, 3>) -> f64 {
        at.mu.dot(&self.inertia.lu().solve(&at.mu).expect("regular")) / 2.0
    }
}

#[test]
fn the_rigid_body_6_5_6_8_6_11_6_13_and_the_right_lift_6_6_6_9() {
    fn check<M, R>(s: f64)
    where
        M: Steps<Body>,
        RightLift<SymplecticEulerA<R>>: Steps<Body>,
        R: MatrixRetraction<SO3, 3, 3> + Default,
    {
        let inertia = Random::new(61).inertia();
        let (body, oracle) = (Body { inertia }, || (SO3, Body { inertia }, Side::Left));
        let state = || BodyState { attitude: attitude(), momentum: vector![0.9, -0.4, 1.2] };
        let matrices = |state: &BodyState| (rotation(&state.attitude), state.momentum);
        let controls = no_control::<Body>();
        follow::<_, M, _, R, _, 3, 3>((&body, state()), &controls, oracle(), s, matrices);
        // the momentum in space, which is constant, leads to the same steps
        if s == 0.0 {
            type Lift<R> = RightLift<SymplecticEulerA<R>>;
            follow::<_, Lift<R>, _, R, _, 3, 3>((&body, state()), &controls, oracle(), s, matrices);
        }
    }
    for_each_member!(check);
}

// ------------------------------------------------------------------------------------------------ (6.15) to (6.18)

#[lie_poisson_system(
    group = SO3,
    advected(gamma: R3),
    potential = weight * gamma.dot(&chi),
    methods(Family(1, 4), Midpoint, Family(3, 4), SymplecticEulerB),
)]
struct Top {
    #[inertia]
    inertia: Matrix3<f64>,
    weight: f64,
    chi: Vector3<f64>,
}

impl Mechanics<SO3Semidirect<1>, 4, 6> for Top {
    type Control = NoControl<f64>;

    fn energy(&self, at: &Phase<4, 6>) -> f64 {
        let (momentum, gamma) = (at.mu.fixed_rows::<3>(0), at.mu.fixed_rows::<3>(3));
        let velocity = self.inertia.lu().solve(&momentum).expect("regular");
        momentum.dot(&velocity) / 2.0 + self.weight * gamma.dot(&self.chi)
    }
}

#[test]
fn the_heavy_top_6_15_6_17() {
    fn check<M, R>(s: f64)
    where
        M: Steps<Top>,
        R: MatrixRetraction<SO3Semidirect<1>, 4, 6> + Default,
    {
        let inertia = Random::new(62).inertia();
        let top = || Top { inertia, weight: 1.3, chi: ARM };
        let gamma = attitude().inverse() * Vector3::z();
        let state = TopState { attitude: attitude(), momentum: vector![0.9, -0.4, 1.2], gamma };
        follow_columns::<_, M, _, R, _, 4, 6>(
            (&top(), state),
            &no_control::<Top>(),
            (SO3Semidirect::<1>, top(), Side::Left),
            s,
            // the auxiliary x is not followed here
            3,
            |state| {
                let mut g = Matrix4::identity();
                g.fixed_view_mut::<3, 3>(0, 0).copy_from(&rotation(&state.attitude));
                let (m, a) = (state.momentum, state.gamma);
                (g, vector![m.x, m.y, m.z, a.x, a.y, a.z])
            },
        );
    }
    for_each_member!(check);
}

// ------------------------------------------------------------------------------------------------ (6.20) to (6.22)

/// The quadrotor (6.19), with the drag of air for the second of its tests.
#[lie_poisson_system(
    group(attitude: SO3, position: R3),
    control(moment: R3, thrust: f64),
    potential = mass * gravity * position.z,
    force(
        attitude = moment,
        position = thrust * (attitude * Vector3::z()) - drag * position_velocity * (1.0 + t),
    ),
    methods(Family(1, 4), Midpoint, Family(3, 4), SymplecticEulerB),
)]
struct Quadrotor {
    #[inertia(attitude)]
    inertia: Matrix3<f64>,
    #[inertia(position)]
    mass: f64,
    gravity: f64,
    drag: f64,
}

/// Rotations, then positions.
type Flight = Product<SO3, Translations<3>, 3, 3, 4, 3>;

impl Mechanics<Flight, 7, 6> for Quadrotor {
    type Control = QuadrotorControl;

    fn energy(&self, at: &Phase<7, 6>) -> f64 {
        let (turning, moving) = (at.mu.fixed_rows::<3>(0), at.mu.fixed_rows::<3>(3));
        let velocity = self.inertia.lu().solve(&turning).expect("regular");
        turning.dot(&velocity) / 2.0
            + moving.norm_squared() / (2.0 * self.mass)
            + self.mass * self.gravity * at.g[(5, 6)]
    }

    fn slope(&self, _at: &Phase<7, 6>, _side: Side) -> SVector<f64, 6> {
        vector![0.0, 0.0, 0.0, 0.0, 0.0, self.mass * self.gravity]
    }

    fn force(&self, at: &Phase<7, 6>, control: &QuadrotorControl) -> SVector<f64, 6> {
        let pull = at.g.fixed_view::<3, 1>(0, 2) * control.thrust;
        let push = pull - at.mu.fixed_rows::<3>(3) * (self.drag * (1.0 + at.time) / self.mass);
        SVector::from_iterator(control.moment.iter().chain(&push).copied())
    }
}

#[test]
fn the_quadrotor_6_20_6_21_6_22() {
    fn check<M, R>(s: f64)
    where
        M: Steps<Quadrotor>,
        R: MatrixRetraction<Flight, 7, 6> + Default,
    {
        let random = &mut Random::new(63);
        let inertia = random.inertia();
        let controls: Vec<_> = (0..STEPS)
            .map(|_| QuadrotorControl { moment: random.vector(), thrust: random.between(-1.0, 1.0) })
            .collect();
        // the paper's, and one whose force depends on momentum and time
        for drag in [0.0, 0.4] {
            let quadrotor = || Quadrotor { inertia, mass: 1.4, gravity: 0.981, drag };
            let state = QuadrotorState {
                attitude: attitude(),
                attitude_momentum: vector![0.9, -0.4, 1.2],
                position: vector![0.3, -0.2, 0.1],
                position_momentum: vector![0.5, -0.4, 0.8],
            };
            let oracle = (Product::of(SO3, Translations::<3>), quadrotor(), Side::Left);
            follow::<_, M, _, R, _, 7, 6>((&quadrotor(), state), &controls, oracle, s, |state| {
                let mut g = SMatrix::<f64, 7, 7>::identity();
                g.fixed_view_mut::<3, 3>(0, 0).copy_from(&rotation(&state.attitude));
                g.fixed_view_mut::<3, 1>(3, 6).copy_from(&state.position);
                let momenta = state.attitude_momentum.iter().chain(&state.position_momentum);
                (g, SVector::from_iterator(momenta.copied()))
            });
        }
    }
    for_each_member!(check);
}
