//! Steps with a retraction that is neither odd nor equivariant: which claims hold with it, and which do not.
// in a test, a panic is the report
#![allow(clippy::unwrap_used)]

use coadjoint::__private::{Geometry, Isolated};
use coadjoint::certify::{Certification, Claimed, Report, Verdict};
use coadjoint::erased::{Description, NotGenerated, RetractionKind};
use coadjoint::prelude::*;
use coadjoint::{
    Discretized, Family, RightLift, Scheme, SchemeType, SecondKind, System, TangentLift, TangentMidpoint,
    erased,
};
use coadjoint_systems::classical::generic::{GenericStepper, Hamiltonian, MatrixRetraction, SO3};

/// Nothing acts on it.
#[lie_poisson_system(
    group = SO3,
    methods(Midpoint, TangentLift, TangentMidpoint, Family(1, 4), Family(3, 4)),
    retractions(SecondKind, Exponential, Cayley),
)]
struct Body {
    #[inertia]
    inertia: Vector3<f64>,
}

/// Nothing acts on it, seen from space.
#[lie_poisson_system(
    group = SO3,
    invariance = right,
    methods(Midpoint, Family(1, 4)),
    retractions(SecondKind, Exponential, Cayley),
)]
struct Mirrored {
    #[inertia]
    inertia: Vector3<f64>,
}

/// A body in a fluid, with a vector that is fixed in space.
#[lie_poisson_system(
    group = SE3,
    advected(gamma: R3),
    potential = gamma.dot(&chi) + gamma.x * gamma.y,
    methods(Midpoint, Family(1, 4)),
    retractions(SecondKind),
)]
struct Fish {
    #[inertia]
    inertia: Matrix6<f64>,
    chi: Vector3<f64>,
}

/// Right-invariant, with a potential on the group and a friction.
#[lie_poisson_system(
    group = SO3,
    potential = strength * (attitude * chi).z,
    control(moment: R3),
    force = moment - friction * momentum,
    invariance = right,
    methods(Midpoint),
    retractions(SecondKind),
)]
struct Drop {
    #[inertia]
    inertia: Vector3<f64>,
    strength: f64,
    chi: Vector3<f64>,
    friction: f64,
}

/// A potential on a group whose axes do not commute.
#[lie_poisson_system(
    group = SE2,
    potential = strength * (pose.translation.vector.norm_squared() + pose.translation.x),
    methods(Midpoint),
    retractions(SecondKind),
)]
struct Disk {
    #[inertia]
    inertia: Matrix3<f64>,
    strength: f64,
}

fn passes<M, S>(system: &S, state: S::State, controls: &[S::Control]) -> Report
where
    S: Geometry<Scalar = f64> + Discretized<M> + erased::System,
    M: SchemeType,
{
    let report = Certification::new(system).states(&[state]).controls(controls).time(0.4).run::<M>().unwrap();
    println!("{report}\n");
    assert!(report.passed(), "{report}");
    assert_eq!(report.certificate("definition").unwrap().verdict, Verdict::Passed);
    report
}

/// Of a step that is neither symmetric nor of order 2: that this is so is measured, and not claimed.
fn is_of_order_one(report: &Report) {
    let properties = report.properties.unwrap();
    assert_eq!((properties.order, properties.symmetric), (1, false));
    let order = report.certificate("order").unwrap();
    assert!((order.figure - 1.0).abs() < 0.15, "{report}");
    let reversibility = report.certificate("reversibility").unwrap();
    assert_eq!((reversibility.verdict, reversibility.bound), (Verdict::NotClaimed, None));
    assert!(reversibility.figure > 1e-6, "{report}");
}

fn turned() -> UnitQuaternion<f64> {
    UnitQuaternion::from_euler_angles(0.3, -0.7, 1.1)
}

fn body() -> (Body, BodyState) {
    let state = BodyState { attitude: turned(), momentum: vector![0.4, -0.8, 1.5] };
    (Body { inertia: vector![1.0, 2.0, 2.5] }, state)
}

fn mirrored() -> (Mirrored, MirroredState) {
    let state = MirroredState { attitude: turned(), momentum: vector![0.4, -0.8, 1.5] };
    (Mirrored { inertia: vector![1.0, 2.0, 2.5] }, state)
}

#[test]
fn a_free_body() {
    let (body, state) = body();
    is_of_order_one(&passes::<SymplecticEulerA<SecondKind>, _>(&body, state, &[]));
    is_of_order_one(&passes::<SymplecticEulerB<SecondKind>, _>(&body, state, &[]));
    is_of_order_one(&passes::<Family<SecondKind, 1, 4>, _>(&body, state, &[]));
    // of functions of a matrix each member is symmetric
    for report in [
        passes::<Family<Exponential, 1, 4>, _>(&body, state, &[]),
        passes::<Family<Cayley, 1, 4>, _>(&body, state, &[]),
        passes::<Midpoint<SecondKind>, _>(&body, state, &[]),
        passes::<SecondKind, _>(&body, state, &[]),
        passes::<RightLift<SecondKind>, _>(&body, state, &[]),
    ] {
        let properties = report.properties.unwrap();
        assert_eq!((properties.order, properties.symmetric), (2, true), "{report}");
        assert!((report.certificate("order").unwrap().figure - 2.0).abs() < 0.15, "{report}");
    }
    assert_eq!(passes::<Order4<SecondKind>, _>(&body, state, &[]).properties.unwrap().order, 4);
    for report in [
        Certification::new(&body).states(&[state]).run::<TangentLift<SecondKind>>(),
        Certification::new(&body).states(&[state]).run::<TangentMidpoint<SecondKind>>(),
    ] {
        let report = report.unwrap();
        assert!(report.passed(), "{report}");
    }
}

#[test]
fn the_right_side() {
    let (system, state) = mirrored();
    is_of_order_one(&passes::<SymplecticEulerA<SecondKind>, _>(&system, state, &[]));
    is_of_order_one(&passes::<Family<SecondKind, 1, 4>, _>(&system, state, &[]));
    passes::<Midpoint<SecondKind>, _>(&system, state, &[]);
    let drop =
        Drop { inertia: vector![1.0, 2.0, 2.5], strength: 1.5, chi: vector![0.1, 0.2, 0.4], friction: 0.1 };
    let state = DropState { attitude: turned(), momentum: vector![0.4, -0.8, 1.5] };
    let control = [DropControl { moment: vector![0.2, 0.1, -0.3] }];
    passes::<SymplecticEulerA<SecondKind>, _>(&drop, state, &control);
    passes::<SymplecticEulerB<SecondKind>, _>(&drop, state, &control);
    passes::<Midpoint<SecondKind>, _>(&drop, state, &control);
}

#[test]
fn motions_and_a_vector_that_is_fixed_in_space() {
    let mut inertia = Matrix6::from_diagonal(&vector![1.0, 2.0, 2.5, 1.5, 1.2, 0.8]);
    (inertia[(0, 4)], inertia[(4, 0)]) = (0.2, 0.2);
    let fish = Fish { inertia, chi: vector![0.1, 0.2, 1.0] };
    let state = FishState {
        pose: Isometry3::from_parts(vector![0.3, -0.2, 0.5].into(), turned()),
        momentum: vector![0.4, -0.8, 1.5, 0.7, 0.1, -0.4],
        gamma: turned().inverse() * Vector3::z(),
    };
    is_of_order_one(&passes::<SymplecticEulerA<SecondKind>, _>(&fish, state, &[]));
    is_of_order_one(&passes::<Family<SecondKind, 1, 4>, _>(&fish, state, &[]));
    passes::<Midpoint<SecondKind>, _>(&fish, state, &[]);
    passes::<SecondKind, _>(&fish, state, &[]);

    let disk = Disk { inertia: matrix![1.0, 0.1, 0.0; 0.1, 1.5, 0.2; 0.0, 0.2, 0.8], strength: 1.3 };
    let pose = Isometry2::new(vector![0.4, -0.3], 0.7);
    let state = DiskState { pose, momentum: vector![0.5, -0.4, 0.9] };
    is_of_order_one(&passes::<SymplecticEulerB<SecondKind>, _>(&disk, state, &[]));
    passes::<SecondKind, _>(&disk, state, &[]);
}

#[test]
fn what_holds_for_odd_retractions_fails_for_others() {
    let (body, state) = body();
    let certification = Certification::new(&body).states(&[state]);
    // the step of a symplectic Euler method under the claims that it has with a retraction that is odd
    let odd = SymplecticEulerA::<Cayley>::scheme().properties(&Description::of::<Body>());
    let claimed = Claimed {
        name: "odd".to_owned(),
        properties: odd,
        definition: Some(SymplecticEulerA::<SecondKind>::scheme()),
        method: &certification.method::<SymplecticEulerA<SecondKind>>(),
        kernels: &|_, _| None,
    };
    let report = certification.run_as(&claimed).unwrap();
    let wrong: Vec<_> = report.failures().map(|certificate| certificate.name.as_str()).collect();
    assert_eq!(wrong, ["order", "energy order", "reversibility"], "{report}");
}

fn step<M, S>(system: &S, h: f64, mut state: S::State) -> S::State
where
    S: Discretized<M, Scalar = f64>,
{
    system.stepper::<M>(h).unwrap().step(&mut state).unwrap();
    state
}

/// `s = 1` undoes `s = 0`, which with this retraction is another map, and the bare retraction is both in turn.
#[test]
fn the_ends_of_the_family_are_adjoints_of_each_other() {
    let (body, state) = body();
    let off = |a: &BodyState, b: &BodyState| {
        (a.attitude.coords - b.attitude.coords).amax().max((a.momentum - b.momentum).amax())
    };
    let there = step::<SymplecticEulerA<SecondKind>, _>(&body, 0.1, state);
    assert!(off(&step::<SymplecticEulerB<SecondKind>, _>(&body, -0.1, there), &state) < 1e-15);
    assert!(off(&step::<SymplecticEulerA<SecondKind>, _>(&body, -0.1, there), &state) > 1e-4);
    assert!(off(&step::<SymplecticEulerB<SecondKind>, _>(&body, 0.1, state), &there) > 1e-4);
    let quarter = step::<Family<SecondKind, 1, 4>, _>(&body, 0.1, state);
    assert!(off(&step::<Family<SecondKind, 3, 4>, _>(&body, -0.1, quarter), &state) < 1e-15);

    let verlet = step::<StormerVerlet<SecondKind>, _>(&body, 0.1, state);
    assert_eq!(step::<SecondKind, _>(&body, 0.1, state), verlet);
    let scheme = Scheme::Standard(RetractionKind::SecondKind);
    assert_eq!(scheme.resolved(true), Scheme::StormerVerlet(RetractionKind::SecondKind));
    let mut components = coadjoint::State::to_components(&state);
    erased::Stepper::new(erased::System::with_parameters(&body, &[]), &scheme, 0.1)
        .unwrap()
        .step(&mut components, &[])
        .unwrap();
    assert_eq!(components, coadjoint::State::to_components(&verlet));
}

#[test]
fn without_being_asked_for_there_is_none() {
    #[lie_poisson_system(group = SO3)]
    struct Plain {
        #[inertia]
        inertia: Vector3<f64>,
    }

    let plain = Plain { inertia: vector![1.0, 2.0, 2.5] };
    let error = erased::Stepper::new(
        erased::System::with_parameters(&plain, &[]),
        &Scheme::Standard(RetractionKind::SecondKind),
        0.1,
    )
    .unwrap_err();
    let erased::StepperError::NotGenerated(NotGenerated { key, .. }) = error else { panic!("{error}") };
    assert_eq!(key, "retractions");
    assert!(
        erased::Stepper::new(
            erased::System::with_parameters(&plain, &[]),
            &Scheme::Standard(RetractionKind::Cayley),
            0.1
        )
        .is_ok()
    );
}

/// `½ Π·𝕀⁻¹Π`
struct Kinetic(Vector3<f64>);

impl Hamiltonian<3> for Kinetic {
    fn energy(&self, mu: &Vector3<f64>) -> f64 {
        0.5 * mu.dot(&self.gradient(mu))
    }

    fn gradient(&self, mu: &Vector3<f64>) -> Vector3<f64> {
        mu.component_div(&self.0)
    }
}

/// The generated step against one by matrices alone.
#[test]
fn the_generic_stepper_takes_the_same_steps() {
    let (body, state) = body();
    let mut generic = GenericStepper::new(SO3, SecondKind, Kinetic(body.inertia), 0.1).unwrap();
    let (mut g, mut mu) = (state.attitude.to_rotation_matrix().into_inner(), state.momentum);
    let mut stepper = body.stepper::<SymplecticEulerA<SecondKind>>(0.1).unwrap();
    let mut state = state;
    for _ in 0..10 {
        generic.step(&mut g, &mut mu).unwrap();
        stepper.step(&mut state).unwrap();
    }
    assert!((state.momentum - mu).amax() < 1e-13, "{}", state.momentum - mu);
    assert!((state.attitude.to_rotation_matrix().into_inner() - g).amax() < 1e-13);

    // the second turn is less than a quarter, whatever the others are
    let is_regular = |x: Vector3<f64>| <SecondKind as MatrixRetraction<SO3, 3, 3>>::is_regular(&x);
    for (first, second, third) in [(3.0, 1.57, -2.0), (0.1, -1.57, 5.0)] {
        assert!(
            is_regular(vector![first, second, third]) && !is_regular(vector![first, 1.001 * second, third])
        );
    }
}

/// What nothing acts on keeps its momentum on the other side of the configuration, to the last bit where it is carried: a left-invariant
/// system that in space, a right-invariant one that in the body.
#[test]
fn the_constant_momentum_is_carried_on_both_sides() {
    fn body_momentum(state: &MirroredState) -> Vector3<f64> {
        state.attitude.inverse() * state.momentum
    }

    fn check<M>()
    where
        Mirrored: Discretized<M> + Discretized<RightLift<M>>,
    {
        let (system, start) = mirrored();
        let (mut plain, mut carried) = (start, start);
        let mut stepper = system.stepper::<M>(0.05).unwrap();
        let mut lift = system.stepper::<RightLift<M>>(0.05).unwrap();
        for _ in 0..1000 {
            stepper.step(&mut plain).unwrap();
            lift.step(&mut carried).unwrap();
        }
        // the same map, but for rounding
        assert!((plain.momentum - carried.momentum).amax() < 1e-12);
        assert!((plain.attitude.coords - carried.attitude.coords).amax() < 1e-12);
        // the momentum in space moves, that in the body does not: what is carried is what it was at the start
        assert!((start.momentum - carried.momentum).amax() > 0.1);
        assert!((body_momentum(&start) - body_momentum(&carried)).amax() < 1e-15);
        // the state follows from it: the rotation by the attitude, exactly as it is computed
        let momentum = <Mirrored as Isolated>::conserved(&coadjoint::State::to_components(&start));
        let here = coadjoint::State::to_components(&carried);
        assert_eq!(<Mirrored as Isolated>::with_conserved(&here, &momentum), here);
    }

    check::<SymplecticEulerA<Exponential>>();
    check::<Midpoint<Cayley>>();
    check::<SecondKind>();
    let (system, state) = mirrored();
    passes::<RightLift<SymplecticEulerA<Cayley>>, _>(&system, state, &[]);
    passes::<RightLift<SymplecticEulerA<SecondKind>>, _>(&system, state, &[]);
}
