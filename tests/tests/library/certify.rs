//! What steps claim is certified, and wrong claims are found out.
// in a test, a panic is the report
#![allow(clippy::unwrap_used)]

use std::sync::atomic::AtomicUsize;
use std::sync::atomic::Ordering::Relaxed;

use coadjoint::__private::OneStep;
use coadjoint::__private::{Batch, Scalar};
use coadjoint::__private::{Geometry, RetractionKind};
use coadjoint::__private::{Method, Outcome};
use coadjoint::certify;
use coadjoint::certify::{
    Certification, CertifyError, Claimed, KernelPart, Report, Verdict, certify_erased, kernel,
};
use coadjoint::derivative::LinearizedSchemes;
use coadjoint::erased::{self, At, Description};
use coadjoint::prelude::*;
use coadjoint::scheme::Rule;
use coadjoint::system::{Generated, Schemes, Visitor};
use coadjoint::{
    ConservedCasimirs, Discretized, Family, Properties, RightLift, Scheme, SchemeType, TangentLift,
};

use crate::faulty::{Fault, Faulty, FaultyKernel};

/// Nothing acts on it.
#[lie_poisson_system(group = SO3, methods(Midpoint, TangentLift, Family(1, 4)))]
struct Body {
    #[inertia]
    inertia: Vector3<f64>,
}

/// The vertical is advected.
#[lie_poisson_system(
    group = SO3,
    advected(gamma: R3),
    potential = weight * gamma.dot(&chi),
    methods(Midpoint, SymplecticEulerB, TangentLift),
)]
struct Top {
    #[inertia]
    inertia: Matrix3<f64>,
    weight: f64,
    chi: Vector3<f64>,
}

/// A potential on the group.
#[lie_poisson_system(
    group = SO3,
    potential = mass * gravity * (attitude * chi).z,
    methods(Midpoint, SymplecticEulerB, TangentLift, Family(1, 3)),
)]
struct Pendulum {
    #[inertia]
    inertia: Vector3<f64>,
    mass: f64,
    gravity: f64,
    chi: Vector3<f64>,
}

/// Right-invariant, with a vector that is fixed in the body.
#[lie_poisson_system(
    group = SO3,
    advected(director: R3),
    potential = strength * director.z * director.x,
    invariance = right,
    methods(Midpoint, SymplecticEulerB, TangentLift),
)]
struct Fluid {
    #[inertia]
    inertia: Vector3<f64>,
    strength: f64,
}

/// Right-invariant, with a potential on the group.
#[lie_poisson_system(
    group = SO3,
    potential = strength * (attitude * chi).z,
    invariance = right,
    methods(Midpoint, SymplecticEulerB),
)]
struct Drop {
    #[inertia]
    inertia: Vector3<f64>,
    strength: f64,
    chi: Vector3<f64>,
}

/// A body with a rotor in it.
#[lie_poisson_system(
    group = SO3,
    hamiltonian = 0.5 * (momentum - rotor).dot(&(mobility * (momentum - rotor))),
    methods(Midpoint),
)]
struct Gyrostat {
    mobility: Matrix3<f64>,
    rotor: Vector3<f64>,
}

/// Pushed and damped.
#[lie_poisson_system(
    group = SO3,
    potential = weight * (attitude * chi).z,
    control(moment: R3),
    force = moment - friction * momentum + attitude.inverse() * wind * (2.0 * t).sin(),
    methods(Midpoint, SymplecticEulerB),
)]
struct Craft {
    #[inertia]
    inertia: Vector3<f64>,
    weight: f64,
    chi: Vector3<f64>,
    friction: f64,
    wind: Vector3<f64>,
}

/// Depends on time, but no force acts.
#[lie_poisson_system(
    group = SO3,
    potential = weight * (1.0 + 0.5 * t.cos()) * (attitude * chi).z,
    methods(Midpoint),
)]
struct Shaken {
    #[inertia]
    inertia: Vector3<f64>,
    weight: f64,
    chi: Vector3<f64>,
}

/// Two bodies that draw each other along.
#[lie_poisson_system(
    group(first: SO3, second: SO3),
    potential = coupling * (first * chi).dot(&(second * chi)),
    methods(Midpoint, SymplecticEulerB),
)]
struct Pair {
    #[inertia(first)]
    one: Vector3<f64>,
    #[inertia(second)]
    other: Vector3<f64>,
    coupling: f64,
    chi: Vector3<f64>,
}

fn passes<M, S>(system: &S, states: &[S::State], controls: &[S::Control]) -> Report
where
    S: Geometry<Scalar = f64> + Discretized<M> + erased::System,
    M: SchemeType,
{
    let report = Certification::new(system).states(states).controls(controls).time(0.4).run::<M>().unwrap();
    println!("{report}\n");
    assert!(report.passed(), "{report}");
    report
}

fn turned(roll: f64, pitch: f64, yaw: f64) -> UnitQuaternion<f64> {
    UnitQuaternion::from_euler_angles(roll, pitch, yaw)
}

fn body() -> (Body, [BodyState; 2]) {
    let states = [
        BodyState { attitude: turned(0.3, -0.7, 1.1), momentum: vector![0.4, -0.8, 1.5] },
        BodyState { attitude: turned(-1.3, 0.2, 0.5), momentum: vector![10.0, 7.0, -3.0] },
    ];
    (Body { inertia: vector![1.0, 2.0, 2.5] }, states)
}

fn top() -> (Top, [TopState; 2]) {
    let top = Top {
        inertia: matrix![1.0, 0.2, 0.1; 0.2, 2.0, -0.3; 0.1, -0.3, 2.4],
        weight: 1.5,
        chi: vector![0.1, 0.2, 1.0],
    };
    let state = |attitude: UnitQuaternion<f64>, momentum| TopState {
        attitude,
        momentum,
        gamma: attitude.inverse() * Vector3::z(),
    };
    let states = [
        state(turned(0.3, -0.7, 1.1), vector![0.4, -0.8, 1.5]),
        state(turned(-1.0, 0.2, 2.1), vector![-0.2, 0.5, 0.1]),
    ];
    (top, states)
}

#[test]
fn a_free_body() {
    let (body, states) = body();
    passes::<Exponential, _>(&body, &states, &[]);
    passes::<Cayley, _>(&body, &states, &[]);
    passes::<Midpoint, _>(&body, &states, &[]);
    passes::<Family<Cayley, 1, 4>, _>(&body, &states, &[]);
    passes::<Order4<Cayley>, _>(&body, &states, &[]);
    passes::<Order6<Midpoint>, _>(&body, &states, &[]);
    passes::<Order8<Exponential>, _>(&body, &states, &[]);
    passes::<Order10<Exponential>, _>(&body, &states, &[]);
    passes::<TangentLift, _>(&body, &states, &[]);
    passes::<RightLift, _>(&body, &states, &[]);
    passes::<RightLift<Order4<Cayley>>, _>(&body, &states, &[]);
}

#[test]
fn a_heavy_top() {
    let (top, states) = top();
    passes::<Exponential, _>(&top, &states, &[]);
    passes::<Cayley, _>(&top, &states, &[]);
    passes::<Midpoint<Cayley>, _>(&top, &states, &[]);
    passes::<StormerVerlet<Cayley>, _>(&top, &states, &[]);
    passes::<Order4<Exponential>, _>(&top, &states, &[]);
    passes::<TangentLift<Cayley>, _>(&top, &states, &[]);
}

#[test]
fn a_potential_on_the_group() {
    let system =
        Pendulum { inertia: vector![1.0, 2.0, 2.5], mass: 0.5, gravity: 9.81, chi: vector![0.1, 0.2, 0.4] };
    let states = [
        PendulumState { attitude: turned(0.3, -0.7, 1.1), momentum: vector![0.4, -0.8, 1.5] },
        PendulumState { attitude: turned(-1.3, 0.2, 0.5), momentum: Vector3::zeros() },
    ];
    passes::<Exponential, _>(&system, &states, &[]);
    passes::<Cayley, _>(&system, &states, &[]);
    passes::<Midpoint, _>(&system, &states, &[]);
    passes::<SymplecticEulerA, _>(&system, &states, &[]);
    passes::<SymplecticEulerB<Cayley>, _>(&system, &states, &[]);
    passes::<Family<Exponential, 1, 3>, _>(&system, &states, &[]);
    passes::<Order4<StormerVerlet>, _>(&system, &states, &[]);
    passes::<Order4<SymplecticEulerA>, _>(&system, &states, &[]);
    passes::<TangentLift, _>(&system, &states, &[]);
}

#[test]
fn the_right_side() {
    let fluid = Fluid { inertia: vector![1.0, 2.0, 2.5], strength: 1.5 };
    let state = FluidState {
        attitude: turned(0.3, -0.7, 1.1),
        momentum: vector![0.4, -0.8, 1.5],
        director: vector![0.5, 0.1, -0.9],
    };
    let states = [state];
    passes::<Exponential, _>(&fluid, &states, &[]);
    passes::<Cayley, _>(&fluid, &states, &[]);
    passes::<Midpoint<Cayley>, _>(&fluid, &states, &[]);
    passes::<Order4<SymplecticEulerB>, _>(&fluid, &states, &[]);
    // another name for the member `s = 0`; on the exponential map every member is the same step
    let report = passes::<SymplecticEulerB<Cayley>, _>(&fluid, &states, &[]);
    assert_eq!(report.certificate("definition").unwrap().verdict, Verdict::Passed);
    passes::<TangentLift, _>(&fluid, &states, &[]);

    let drop = Drop { inertia: vector![1.0, 2.0, 2.5], strength: 1.5, chi: vector![0.1, 0.2, 0.4] };
    let states = [DropState { attitude: turned(0.3, -0.7, 1.1), momentum: vector![0.4, -0.8, 1.5] }];
    passes::<Exponential, _>(&drop, &states, &[]);
    passes::<Cayley, _>(&drop, &states, &[]);
    passes::<Midpoint, _>(&drop, &states, &[]);
    passes::<SymplecticEulerB<Cayley>, _>(&drop, &states, &[]);
}

#[test]
fn a_gyrostat() {
    let system = Gyrostat {
        mobility: matrix![1.0, 0.1, 0.0; 0.1, 0.5, 0.05; 0.0, 0.05, 0.3],
        rotor: vector![0.2, -0.1, 0.5],
    };
    let states = [GyrostatState { attitude: turned(0.3, -0.7, 1.1), momentum: vector![0.4, -0.8, 1.5] }];
    passes::<Exponential, _>(&system, &states, &[]);
    passes::<Cayley, _>(&system, &states, &[]);
    passes::<Midpoint, _>(&system, &states, &[]);
    passes::<RightLift<Cayley>, _>(&system, &states, &[]);
}

#[test]
fn forces_and_time() {
    let craft = Craft {
        inertia: vector![1.0, 2.0, 2.5],
        weight: 1.5,
        chi: vector![0.1, 0.2, 0.4],
        friction: 0.2,
        wind: vector![0.3, 0.1, -0.2],
    };
    let states = [CraftState { attitude: turned(0.3, -0.7, 1.1), momentum: vector![0.4, -0.8, 1.5] }];
    let controls = [CraftControl { moment: vector![0.3, -0.2, 0.5] }];
    passes::<Exponential, _>(&craft, &states, &controls);
    passes::<Cayley, _>(&craft, &states, &controls);
    passes::<Midpoint, _>(&craft, &states, &controls);
    passes::<Order4<Midpoint<Cayley>>, _>(&craft, &states, &controls);

    let shaken = Shaken { inertia: vector![1.0, 2.0, 2.5], weight: 1.5, chi: vector![0.1, 0.2, 0.4] };
    let states = [ShakenState { attitude: turned(0.3, -0.7, 1.1), momentum: vector![0.4, -0.8, 1.5] }];
    passes::<Exponential, _>(&shaken, &states, &[]);
    passes::<Midpoint<Cayley>, _>(&shaken, &states, &[]);
    passes::<SymplecticEulerA, _>(&shaken, &states, &[]);
}

/// Every function that a description may name, in the equation of a step.
#[lie_poisson_system(
    group(position: R1),
    force = {
        let x = position.x;
        let roots = (2.0 + x).sqrt() + (2.0 + x).ln() + (2.0 + x).powf(0.3) + x.atan2(2.0 + x);
        let circular = x.sin() + 2.0 * x.cos() + 3.0 * x.tan() + 5.0 * x.asin() + 7.0 * x.acos() + 11.0 * x.atan();
        let hyperbolic = 13.0 * x.exp() + 17.0 * x.sinh() + 19.0 * x.cosh() + 23.0 * x.tanh();
        vector![scale * (roots + circular + hyperbolic)]
    },
    methods(Midpoint),
)]
struct Functions {
    #[inertia]
    mass: f64,
    scale: f64,
}

/// What the generator calls a function in the bytes of a program, the library takes for that function.
#[test]
fn functions_of_programs_are_those_of_steps() {
    let system = Functions { mass: 1.0, scale: 1e-3 };
    let state = FunctionsState { position: vector![0.3], position_momentum: vector![0.2] };
    let report = certify::<Midpoint<Exponential>, _>(&system, &[state]).unwrap();
    assert!(report.passed(), "{report}");
    assert_eq!(report.certificate("warm steps").unwrap().verdict, Verdict::Passed);
}

#[test]
fn two_bodies() {
    let pair = Pair {
        one: vector![1.0, 2.0, 2.5],
        other: vector![0.7, 0.8, 0.9],
        coupling: 1.5,
        chi: vector![0.1, 0.2, 0.4],
    };
    let states = [PairState {
        first: turned(0.3, -0.7, 1.1),
        first_momentum: vector![0.4, -0.8, 1.5],
        second: turned(-1.3, 0.2, 0.5),
        second_momentum: vector![0.2, 0.7, -0.3],
    }];
    passes::<Exponential, _>(&pair, &states, &[]);
    passes::<Cayley, _>(&pair, &states, &[]);
    passes::<Midpoint<Cayley>, _>(&pair, &states, &[]);
    passes::<Order4<Midpoint>, _>(&pair, &states, &[]);
}

/// What steps are certified for that are not what they claim to be.
struct Boast<'a> {
    properties: Properties,
    definition: Option<Scheme>,
    kernels: &'a dyn Fn(usize, &At<'_>) -> Option<KernelPart>,
}

impl<'a> Boast<'a> {
    /// With all that a scheme promises of a body's steps, and no kernels to show.
    fn of<C: SchemeType>() -> Self {
        let properties = C::scheme().properties(&Description::of::<Body>());
        Self { properties, definition: Some(C::scheme()), kernels: &|_, _| None }
    }

    fn report<M, S>(self, system: &S, states: &[S::State]) -> Result<Report, CertifyError>
    where
        S: Geometry<Scalar = f64> + Discretized<M> + 'static,
        M: 'static,
    {
        let Self { properties, definition, kernels } = self;
        let certification = Certification::new(system).states(states);
        let method = &certification.method::<M>();
        let report = certification.run_as(&Claimed {
            name: "boast".into(),
            properties,
            definition,
            method,
            kernels,
        })?;
        println!("{report}\n");
        Ok(report)
    }

    fn failing<M, S>(self, system: &S, states: &[S::State]) -> Vec<String>
    where
        S: Geometry<Scalar = f64> + Discretized<M> + 'static,
        M: 'static,
    {
        let report = self.report::<M, S>(system, states).unwrap();
        report.failures().map(|certificate| certificate.name.clone()).collect()
    }
}

#[test]
fn claims_of_other_schemes_fail() {
    let (body, states) = body();
    let wrong = Boast::of::<Midpoint>().failing::<TangentLift, _>(&body, &states);
    // its energy drifts only until it has found a steady rotation
    assert_eq!(wrong, ["order", "Poisson map", "|momentum|²", "reversibility", "definition"]);
    // another step with the same properties
    assert_eq!(Boast::of::<Midpoint>().failing::<Cayley, _>(&body, &states), ["definition"]);
    let wrong = Boast::of::<Order4<Midpoint>>().failing::<Midpoint, _>(&body, &states);
    assert_eq!(wrong, ["order", "energy order", "definition"]);
    // the same step
    assert!(Boast::of::<Midpoint>().failing::<RightLift<Midpoint>, _>(&body, &states).is_empty());
}

/// A step of the midpoint rule that loses a hundred-millionth of the momentum.
struct Leaky;

#[derive(Clone)]
struct Leak<T: Batch>(<Body as Discretized<Midpoint>>::Method<T>);

impl<T: Batch> Method for Leak<T> {
    type CallSite = ();
    type Scalar = T;
    type Parameters = [T; 3];
    type State = [T; 7];
    type Control = [T; 0];

    fn new(parameters: &[T; 3], step: T) -> Self {
        Self(Method::new(parameters, step))
    }

    type FastPath = ();

    fn advance_from(
        &mut self,
        _: Option<usize>,
        state: &[T; 7],
        time: T,
        control: &[T; 0],
        known: bool,
    ) -> Outcome<T, [T; 7]> {
        let mut advanced = self.0.advance(state, time, control, known)?;
        advanced.state[4..].iter_mut().for_each(|x| *x = *x * T::of(1.0 - 1e-8));
        Ok(advanced)
    }

    fn memory(&mut self, visit: &mut dyn FnMut(&mut [T])) {
        self.0.memory(visit);
    }
}

impl Discretized<Leaky> for Body {
    type Method<T: Batch> = Leak<T>;
}

/// All that the midpoint rule promises, of a step that nothing defines.
fn leaky() -> Boast<'static> {
    let properties =
        Properties { order: 2, symmetric: true, poisson: true, casimirs: ConservedCasimirs::All };
    Boast { properties, definition: None, kernels: &|_, _| None }
}

#[test]
fn a_small_leak_is_found() {
    let (body, states) = body();
    let wrong = leaky().failing::<Leaky, _>(&body, &states);
    for name in ["Poisson map", "|momentum|²", "reversibility"] {
        assert!(wrong.iter().any(|wrong| wrong == name), "{name}: {wrong:?}");
    }
}

/// How often a stepper that has something wrong with its memory errs: a step from where the last one led to, after so many of them.
const STALE: u32 = 1_100;

/// Steps of the midpoint rule that go wrong after a while, and only where a step follows the last one.
struct Stale;
/// Such steps cannot be taken then.
struct Stuck;

#[derive(Clone)]
struct Aged<T: Batch, const STUCK: bool> {
    base: <Body as Discretized<Midpoint>>::Method<T>,
    follows: u32,
}

impl<T: Batch, const STUCK: bool> Method for Aged<T, STUCK> {
    type CallSite = ();
    type Scalar = T;
    type Parameters = [T; 3];
    type State = [T; 7];
    type Control = [T; 0];

    fn new(parameters: &[T; 3], step: T) -> Self {
        Self { base: Method::new(parameters, step), follows: 0 }
    }

    type FastPath = ();

    fn advance_from(
        &mut self,
        _: Option<usize>,
        state: &[T; 7],
        time: T,
        control: &[T; 0],
        known: bool,
    ) -> Outcome<T, [T; 7]> {
        self.follows = if known { self.follows + 1 } else { 0 };
        if STUCK && self.follows >= STALE {
            return self.base.advance(&[T::of(f64::NAN); 7], time, control, known);
        }
        let mut advanced = self.base.advance(state, time, control, known)?;
        if self.follows >= STALE {
            // to and fro, so that nothing else shows it
            let by = if self.follows.is_multiple_of(2) { 1e-13 } else { -1e-13 };
            advanced.state[4..].iter_mut().for_each(|x| *x = *x * T::of(1.0 + by));
        }
        Ok(advanced)
    }

    fn memory(&mut self, visit: &mut dyn FnMut(&mut [T])) {
        self.base.memory(visit);
    }
}

macro_rules! aged {
    ($($scheme:ident, $stuck:literal;)*) => {
        $(
            impl Discretized<$scheme> for Body {
                type Method<T: Batch> = Aged<T, $stuck>;
            }
        )*
    };
}
aged! {
    Stale, false;
    Stuck, true;
}

#[test]
fn a_step_that_depends_on_what_is_remembered_is_found() {
    let (body, states) = body();
    // the midpoint rule's kernels, and hardly a promise
    let midpoint = |index: usize, at: &At<'_>| kernel::<_, Midpoint>(&body, index, at);
    let aged = || Boast { definition: None, kernels: &midpoint, ..Boast::of::<TangentLift>() };
    assert_eq!(aged().failing::<Stale, _>(&body, &states), ["warm steps"]);
    let report = aged().report::<Stuck, _>(&body, &states).unwrap();
    let warm = report.certificate("warm steps").unwrap();
    assert_eq!((warm.figure, warm.verdict), (f64::INFINITY, Verdict::Failed), "{report}");
}

#[test]
fn warm_steps_are_those_of_equations_solved_in_twice_the_digits() {
    let (body, states) = body();
    let report = certify::<Cayley, _>(&body, &states).unwrap();
    for name in ["warm steps", "restarts", "long steps"] {
        let certificate = report.certificate(name).unwrap();
        assert_eq!(certificate.verdict, Verdict::Passed, "{report}");
        // they are not the same to the last digit: the figure is measured
        assert!((0.2..4.0).contains(&certificate.figure), "{report}");
    }
    // where nothing is controlled, nothing jumps
    assert!(report.certificate("control jumps").is_none());
    // of what has no kernels to show, nothing is known
    let report = leaky().report::<Leaky, _>(&body, &states).unwrap();
    assert_eq!(report.certificate("warm steps").unwrap().verdict, Verdict::NotMeasured);
}

/// The midpoint rule with a Newton correction that is a little off: it converges, but no longer with the square of the error.
#[derive(Clone, Copy)]
struct Slow;

impl Fault for Slow {
    fn correction<T: Scalar>(correction: &mut [T]) {
        correction[0] = correction[0] * T::of(1.0001);
    }
}

impl Generated<Slow> for Body {
    type Kernel<T: Scalar> = FaultyKernel<<Self as Generated<Midpoint>>::Kernel<T>, Slow>;
}

impl Discretized<Slow> for Body {
    type Method<T: Batch> = OneStep<T, <Self as Generated<Slow>>::Kernel<T>>;
}

#[test]
fn a_wrong_correction_is_found() {
    let (body, states) = body();
    let kernels = |index: usize, at: &At<'_>| kernel::<_, Slow>(&body, index, at);
    let slow = Boast { kernels: &kernels, ..Boast::of::<Midpoint>() };
    let wrong = slow.failing::<Slow, _>(&body, &states);
    assert_eq!(wrong[0], "Newton correction");
    // iterations end before they are through
    assert!(
        wrong[1..].iter().all(|name| ["warm steps", "restarts", "long steps"].contains(&&**name)),
        "{wrong:?}"
    );
}

/// A body whose geometry is wrong in a way.
type Bent = Faulty<Body>;

#[test]
fn a_wrong_geometry_is_found() {
    let (good, states) = body();
    let bent = || Bent::new(Body { inertia: good.inertia });
    assert!(Boast::of::<Midpoint>().failing::<Plain, _>(&bent(), &states).is_empty());
    assert_eq!(
        Boast::of::<Midpoint>().failing::<Plain, _>(&bent().with_energy(1e-6), &states),
        ["energy differential"]
    );
    let bracket = bent().with_vector(|body, state, covector| {
        let mut vector = body.hamiltonian_vector(state, covector);
        vector[3..].iter_mut().zip(&covector[..3]).for_each(|(x, y)| *x += y);
        vector[3..].iter_mut().for_each(|x| *x *= 1.0 + 1e-6);
        vector[3..].iter_mut().zip(&covector[..3]).for_each(|(x, y)| *x -= y);
        vector
    });
    let wrong = Boast::of::<Midpoint>().failing::<Plain, _>(&bracket, &states);
    assert_eq!(wrong, ["consistency", "Poisson map", "definition", "Jacobi identity", "exponential"]);
}

/// The midpoint rule's steps for a system of no kernels.
struct Plain;

impl Discretized<Plain> for Bent {
    type Method<T: Batch> = <Body as Discretized<Midpoint>>::Method<T>;
}

/// How often the generated steps of [`Bent`] are still there.
static LEFT: AtomicUsize = AtomicUsize::new(0);

impl Generated<Midpoint> for Bent {
    type Kernel<T: Scalar> = <Body as Generated<Midpoint>>::Kernel<T>;
}

impl LinearizedSchemes for Bent {}

impl Schemes for Bent {
    fn visit<V: Visitor<Self>>(_: RetractionKind, _: Rule, visitor: V) -> Option<V::Output> {
        let less = |left: usize| left.checked_sub(1);
        LEFT.fetch_update(Relaxed, Relaxed, less).is_ok().then(|| visitor.visit::<Midpoint>())
    }
}

#[test]
fn a_step_that_vanishes_is_an_error() {
    let (good, states) = body();
    let bent = Bent::new(good);
    let states: Vec<_> = states.iter().map(|state| state.to_components().to_vec()).collect();
    let scheme = Scheme::member(RetractionKind::Exponential, 1, 2);
    for left in [0, 1, 2, 10, 100] {
        LEFT.store(left, Relaxed);
        let error = certify_erased(&bent, &scheme, &states, &[], 0.0, None).unwrap_err();
        let CertifyError::NotGenerated(missing) = error else { panic!("{left}: {error}") };
        assert_eq!(
            (missing.scheme.as_str(), missing.system, missing.key),
            ("Midpoint<Exponential>", "Bent", "retractions"),
            "{left}"
        );
    }
    LEFT.store(usize::MAX, Relaxed);
    assert!(certify_erased(&bent, &scheme, &states, &[], 0.0, None).unwrap().passed());
}

#[test]
fn errors_name_what_failed() {
    let (good, states) = body();
    assert_eq!(certify::<Cayley, _>(&good, &[]), Err(CertifyError::NoStates));
    let error = Certification::new(&good).states(&states).step(0.0).run::<Cayley>().unwrap_err();
    assert_eq!(error, CertifyError::Parameter(ParameterError::Step { step: 0.0 }));
    let broken = Body { inertia: vector![1.0, -2.0, 2.5] };
    assert!(matches!(certify::<Cayley, _>(&broken, &states), Err(CertifyError::Parameter(_))));

    let error = Certification::new(&good).states(&states).step(20.0).run::<Exponential>().unwrap_err();
    let CertifyError::Step { certificate, .. } = &error else { panic!("{error}") };
    assert!(error.to_string().starts_with(&format!("certificate `{certificate}`, state ")), "{error}");

    let lost = BodyState { momentum: vector![f64::NAN, 0.0, 0.0], ..states[0] };
    let error = certify::<Cayley, _>(&good, &[states[1], lost]).unwrap_err();
    assert_eq!(
        error,
        CertifyError::Step { certificate: "sample".into(), state: 1, source: StepError::NotFinite }
    );
}

#[test]
fn reports_are_tables() {
    let (body, states) = body();
    let report = certify::<TangentLift<Cayley>, _>(&body, &states).unwrap();
    let text = report.to_string();
    assert!(text.starts_with("Body, TangentLift<Cayley>, step "), "{text}");
    assert!(
        text.lines().any(|line| line.starts_with("Poisson map ") && line.ends_with("not claimed")),
        "{text}"
    );
    assert!(
        text.lines().any(|line| line.starts_with("definition ") && line.ends_with("not measured")),
        "{text}"
    );
    assert_eq!(report.certificate("order").unwrap().verdict, Verdict::Passed);
}

#[test]
fn reports_are_written_as_json() {
    let (body, states) = body();
    let report = certify::<TangentLift<Cayley>, _>(&body, &states).unwrap();
    let json: serde_json::Value = serde_json::to_value(&report).unwrap();
    assert_eq!(json["certificates"][0]["name"], "order");
    assert_eq!(json["certificates"][0]["bound"]["AtLeast"], 0.85);
}

/// A charge that is nearly as fast as light: where it would be faster its Lagrangian is not a number.
#[lie_poisson_system(
    group(position: R3),
    lagrangian = {
        let v = position_velocity;
        charge * v.dot(&field.cross(&position)) / 2.0 - mass * light.powi(2) * (1.0 - v.norm_squared() / light.powi(2)).sqrt()
    },
    methods(Midpoint),
)]
#[derive(Clone)]
struct FastCharge {
    mass: f64,
    light: f64,
    charge: f64,
    field: Vector3<f64>,
}

/// What moves with these parts of the speed of light.
fn fast_charges() -> (FastCharge, Vec<FastChargeState>) {
    let charge = FastCharge { mass: 1.5, light: 2.0, charge: 0.7, field: vector![0.1, -0.4, 1.2] };
    let states = [[0.3, 0.1, -0.2], [0.7, 0.5, 0.1], [0.6, -0.7, 0.3], [0.55, 0.6, 0.58]]
        .map(|part| {
            let (velocity, position) = (charge.light * Vector3::from(part), vector![0.4, -0.3, 0.8]);
            let factor = 1.0 / (1.0 - Vector3::from(part).norm_squared()).sqrt();
            let potential = charge.charge * charge.field.cross(&position) / 2.0;
            FastChargeState { position, position_momentum: charge.mass * factor * velocity + potential }
        })
        .to_vec();
    (charge, states)
}

#[test]
fn an_energy_with_an_edge() {
    let (charge, states) = fast_charges();
    for state in &states {
        for report in [
            passes::<Midpoint, _>(&charge, &[*state], &[]),
            passes::<Order4<Midpoint>, _>(&charge, &[*state], &[]),
        ] {
            assert_eq!(report.certificate("Newton correction").unwrap().verdict, Verdict::Passed);
        }
    }
}

/// A Lagrangian that is a number at no velocity near the one that its momentum asks for: the edge of its domain is nowhere passed.
#[test]
fn what_is_nowhere_a_number_is_not_measured() {
    let (charge, _) = fast_charges();
    // lighter than nothing, and slower than everything
    let none = FastCharge { light: 1e-160, ..charge };
    let state =
        FastChargeState { position: vector![0.4, -0.3, 0.8], position_momentum: vector![0.1, 0.2, 0.3] };
    // there are no steps to measure anything else with
    match certify::<Midpoint, _>(&none, &[state]) {
        Ok(report) => {
            let correction = report.certificate("Newton correction").unwrap();
            assert_ne!(correction.verdict, Verdict::Failed, "{report}");
        }
        Err(error) => println!("{error}"),
    }
}

/// A rotor whose momentum is what keeps the body turning: its first steps from zeros are solved, and compared.
#[test]
fn states_with_zeros_are_measured() {
    let (top, states) = top();
    let report = passes::<Midpoint, _>(&top, &states, &[]);
    let zeros = report.certificate("zeros").unwrap();
    assert_eq!(zeros.verdict, Verdict::Passed);
    let gyrostat = Gyrostat {
        mobility: Matrix3::from_diagonal(&vector![1.0, 0.5, 0.4]),
        rotor: vector![0.3, 0.0, -2.0],
    };
    let states = [GyrostatState { attitude: turned(0.3, -0.7, 1.1), momentum: vector![0.4, -0.8, 1.5] }];
    assert_eq!(
        passes::<Midpoint, _>(&gyrostat, &states, &[]).certificate("zeros").unwrap().verdict,
        Verdict::Passed
    );
}

#[test]
fn no_figure_passes_by_a_hair() {
    let (body, states) = body();
    let (top, of_top) = top();
    let mut reports = vec![
        certify::<Exponential, _>(&body, &states).unwrap(),
        certify::<Midpoint, _>(&body, &states).unwrap(),
        certify::<Order4<Cayley>, _>(&body, &states).unwrap(),
        certify::<Cayley, _>(&top, &of_top).unwrap(),
        certify::<Midpoint<Cayley>, _>(&top, &of_top).unwrap(),
    ];
    let (charge, of_charge) = fast_charges();
    reports.push(certify::<Midpoint, _>(&charge, &of_charge).unwrap());
    for report in reports {
        for name in ["warm steps", "restarts", "long steps", "zeros"] {
            let Some(certificate) = report.certificate(name) else { continue };
            let Some(coadjoint::certify::Bound::AtMost(most)) = certificate.bound else { panic!("{report}") };
            assert!(certificate.figure <= 0.5 * most, "{name}\n{report}");
        }
    }
}

/// A servo whose damping settles within some steps: back in time it grows, and rounding with it.
#[lie_poisson_system(
    group = SO2,
    force = vector![-stiffness * angle.angle() - damping * velocity.x],
    retractions(Exponential),
    methods(Midpoint)
)]
struct Servo {
    #[inertia]
    inertia: f64,
    stiffness: f64,
    damping: f64,
}

#[test]
fn what_is_damped_there_grows_on_the_way_back() {
    for damping in [1.0, 8.0, 12.0, 30.0] {
        let servo = Servo { inertia: 0.05, stiffness: 60.0, damping };
        let state = ServoState { angle: UnitComplex::new(0.3), momentum: vector![0.025] };
        let report = passes::<Midpoint, _>(&servo, &[state], &[]);
        let back = report.certificate("reversibility").unwrap();
        assert_eq!(back.verdict, Verdict::Passed, "{damping}");
    }
}
