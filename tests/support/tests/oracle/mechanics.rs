//! The generic stepper on systems that are not left-invariant: potentials on the group, forces, controls, time, the right side, products.
// in a test, a panic is the report
#![allow(clippy::unwrap_used)]

use coadjoint::nalgebra::{Matrix2, Matrix3, SMatrix, SVector, Vector2, Vector3};
use coadjoint::vector;
use coadjoint::{Cayley, Exponential, StepError};
use coadjoint_systems::classical::generic::{
    GenericStepper, MatrixGroup, MatrixRetraction, Mechanics, Phase, Product, SO3, SO3Semidirect, Side,
    Translations,
};

const MEMBERS: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

/// A body that depends on where it is, on both sides and on itself: no symmetry is left.
struct Bent;

impl Mechanics<SO3, 3, 3> for Bent {
    type Control = ();

    fn energy(&self, at: &Phase<3, 3>) -> f64 {
        let lever = at.g * vector![0.3, -0.2, 0.9];
        let kinetic = at.mu.dot(&at.mu.component_div(&vector![1.0, 2.0, 2.5])) / 2.0;
        kinetic * (1.0 + 0.2 * lever.x) - 0.3 * at.mu.y + lever.z + 0.3 * lever.y.powi(2)
    }
}

fn stepped<G, R, H, const N: usize, const D: usize>(
    (group, retraction, system): (G, R, H),
    (h, s, side): (f64, f64, Side),
    (mut g, mut mu): (SMatrix<f64, N, N>, SVector<f64, D>),
) -> (SMatrix<f64, N, N>, SVector<f64, D>)
where
    G: MatrixGroup<N, D>,
    R: MatrixRetraction<G, N, D>,
    H: Mechanics<G, N, D>,
{
    let mut stepper = GenericStepper::new(group, retraction, system, h).unwrap().at(s).unwrap().on(side);
    stepper.step(&mut g, &mut mu).unwrap();
    (g, mu)
}

fn start() -> (Matrix3<f64>, Vector3<f64>) {
    (SO3::exp(&vector![0.4, -0.7, 0.2]), vector![0.9, -0.4, 1.2])
}

#[test]
fn the_adjoint_of_s_is_its_complement() {
    fn check<R: MatrixRetraction<SO3, 3, 3> + Copy>(retraction: R) {
        for side in [Side::Left, Side::Right] {
            for s in MEMBERS {
                let there = stepped((SO3, retraction, Bent), (0.2, s, side), start());
                let back = stepped((SO3, retraction, Bent), (-0.2, 1.0 - s, side), there);
                let (g, mu) = start();
                assert!((there.1 - mu).amax() > 0.01, "s = {s}, {side:?}: {:e}", (there.1 - mu).amax());
                let errors = [(back.0 - g).amax(), (back.1 - mu).amax()];
                assert!(errors.iter().all(|error| *error < 2e-14), "s = {s}, {side:?}: {errors:?}");
                // and no other is
                let other = stepped((SO3, retraction, Bent), (-0.2, 0.9 - s, side), there);
                assert!((other.1 - mu).amax() > 1e-5, "s = {s}, {side:?}: {:e}", (other.1 - mu).amax());
            }
        }
    }
    check(Exponential);
    check(Cayley);
}

/// By `γ = g⁻¹` a system on the one side is a system on the other, with the momentum `−μ`.
struct Inverted;

impl Mechanics<SO3, 3, 3> for Inverted {
    type Control = ();

    fn energy(&self, at: &Phase<3, 3>) -> f64 {
        Bent.energy(&Phase { g: at.g.transpose(), mu: -at.mu, time: at.time })
    }
}

#[test]
fn inversion_leads_from_one_side_to_the_other() {
    fn check<R: MatrixRetraction<SO3, 3, 3> + Copy>(retraction: R) {
        for s in MEMBERS {
            let (g, mu) = start();
            let right = stepped((SO3, retraction, Bent), (0.2, s, Side::Right), (g, mu));
            let left = stepped((SO3, retraction, Inverted), (0.2, s, Side::Left), (g.transpose(), -mu));
            assert!(
                (right.0 - left.0.transpose()).amax() < 5e-15,
                "s = {s}: {:e}",
                (right.0 - left.0.transpose()).amax()
            );
            assert!((right.1 + left.1).amax() < 1e-14, "s = {s}: {:e}", (right.1 + left.1).amax());
            // the sides differ
            let other = stepped((SO3, retraction, Bent), (0.2, s, Side::Left), (g, mu));
            assert!((right.1 - other.1).amax() > 0.01, "s = {s}: {:e}", (right.1 - other.1).amax());
        }
    }
    check(Exponential);
    check(Cayley);
}

/// The step's derivative `D` at the momentum and at `g exp(δ)` keeps the symplectic form of `T*SO(3)` in body coordinates.
#[test]
fn steps_are_symplectic() {
    fn check<R: MatrixRetraction<SO3, 3, 3> + Copy>(retraction: R, s: f64) {
        let (g, mu) = start();
        let image = |x: SVector<f64, 6>| {
            let moved = g * SO3::exp(&x.fixed_rows::<3>(0).into_owned());
            stepped((SO3, retraction, Bent), (0.2, s, Side::Left), (moved, mu + x.fixed_rows::<3>(3)))
        };
        let end = image(SVector::zeros());
        let mut derivative = SMatrix::<f64, 6, 6>::zeros();
        for j in 0..6 {
            let along = |d: f64| {
                let (g, mu) = image(SVector::from_fn(|i, _| if i == j { d } else { 0.0 }));
                let turned = SO3::vee(&(end.0.transpose() * g));
                SVector::<f64, 6>::from_iterator(turned.iter().chain(&mu).copied())
            };
            let central = |d: f64| (along(d) - along(-d)) / (2.0 * d);
            derivative.set_column(j, &((central(1e-3) * 4.0 - central(2e-3)) / 3.0));
        }
        // ω(x, y) = δx·νy − δy·νx + μ·[δx, δy] up to its sign
        let form = |mu: &Vector3<f64>| {
            let mut form = SMatrix::<f64, 6, 6>::zeros();
            form.fixed_view_mut::<3, 3>(0, 3).copy_from(&Matrix3::identity());
            form.fixed_view_mut::<3, 3>(3, 0).copy_from(&-Matrix3::identity());
            form.fixed_view_mut::<3, 3>(0, 0).copy_from(&-mu.cross_matrix());
            form
        };
        let error = (derivative.transpose() * form(&end.1) * derivative - form(&mu)).amax();
        assert!(error < 1e-10, "s = {s}: {error:e}");
    }
    for s in MEMBERS {
        check(Exponential, s);
        check(Cayley, s);
    }
}

/// A heavy top, its vertical not advected but seen from its attitude.
#[derive(Clone, Copy)]
struct HeavyTop;

const INERTIA: Vector3<f64> = vector![1.0, 2.0, 2.5];
const LEVER: Vector3<f64> = vector![0.3, -0.2, 0.9];

impl Mechanics<SO3, 3, 3> for HeavyTop {
    type Control = ();

    fn energy(&self, at: &Phase<3, 3>) -> f64 {
        at.mu.dot(&at.mu.component_div(&INERTIA)) / 2.0 + (at.g * LEVER).z
    }
}

/// The same, with it advected.
struct Reduced;

impl coadjoint_systems::classical::generic::Hamiltonian<6> for Reduced {
    fn energy(&self, mu: &SVector<f64, 6>) -> f64 {
        let momentum = mu.fixed_rows::<3>(0);
        momentum.dot(&momentum.component_div(&INERTIA)) / 2.0 + mu.fixed_rows::<3>(3).dot(&LEVER)
    }
}

#[test]
fn a_top_with_a_potential_on_the_group_follows_the_reduced_one() {
    let (g, mu) = start();
    let reference = {
        let mut big = SMatrix::<f64, 4, 4>::identity();
        big.fixed_view_mut::<3, 3>(0, 0).copy_from(&g);
        let gamma = g.transpose() * Vector3::z();
        let mut all = SVector::<f64, 6>::from_iterator(mu.iter().chain(&gamma).copied());
        let mut stepper = GenericStepper::new(SO3Semidirect::<1>, Exponential, Reduced, 1.0 / 800.0).unwrap();
        for _ in 0..800 {
            stepper.step(&mut big, &mut all).unwrap();
        }
        all.fixed_rows::<3>(0).into_owned()
    };
    let error = |s: f64, steps: u32| {
        let stepper = GenericStepper::new(SO3, Cayley, HeavyTop, 1.0 / f64::from(steps)).unwrap();
        let mut stepper = stepper.at(s).unwrap();
        let (mut g, mut mu) = start();
        for _ in 0..steps {
            stepper.step(&mut g, &mut mu).unwrap();
        }
        // gravity acts, and the angular momentum about the vertical is kept
        assert!(((g * mu).z - (start().0 * start().1).z).abs() < 1e-12);
        (mu - reference).amax()
    };
    for (s, expected) in [(0.0, 1.0), (0.5, 2.0), (1.0, 1.0)] {
        let order = (error(s, 20) / error(s, 40)).log2();
        assert!((order - expected).abs() < 0.1, "s = {s}: order {order}");
    }
}

/// A mass on a spring, pushed by the control and by something that grows with the time, and braked by friction.
struct Driven;

impl Mechanics<Translations<1>, 2, 1> for Driven {
    type Control = f64;

    fn energy(&self, at: &Phase<2, 1>) -> f64 {
        at.mu.x.powi(2) / 3.0 + 0.7 * at.g[(0, 1)].powi(2)
    }

    fn force(&self, at: &Phase<2, 1>, control: &f64) -> SVector<f64, 1> {
        vector![control + 0.4 * at.time - 0.3 * at.mu.x]
    }
}

/// `q⁺ = q + t v̄`, `p⁺ = p + t f̄` with `q̄ = (1−s) q + s q⁺`, `p̄ = s p + (1−s) p⁺` and the time `t_k + s t`.
#[test]
fn on_a_line_it_is_the_theta_family_with_forces() {
    for s in MEMBERS {
        let (h, control, time) = (0.1, 0.6, 2.0);
        let (q, p) = (0.3, -0.8);
        // linear: (1 − h A M) x⁺ = (1 + h A N) x + h b
        let a = Matrix2::new(0.0, 2.0 / 3.0, -1.4, -0.3);
        let [early, late] = [[1.0 - s, s], [s, 1.0 - s]].map(|d| Matrix2::from_diagonal(&Vector2::from(d)));
        let pushed = vector![0.0, control + 0.4 * (time + s * h)] * h;
        let left = Matrix2::identity() - a * late * h;
        let expected =
            left.try_inverse().unwrap() * ((Matrix2::identity() + a * early * h) * vector![q, p] + pushed);

        let mut g = Matrix2::new(1.0, q, 0.0, 1.0);
        let mut mu = vector![p];
        let stepper = GenericStepper::new(Translations::<1>, Exponential, Driven, h).unwrap();
        stepper.at(s).unwrap().step_with(&mut g, &mut mu, &control, time).unwrap();
        let error = (vector![g[(0, 1)], mu.x] - expected).amax();
        assert!(error < 2e-15, "s = {s}: {error:e}");
    }
}

/// A top and a driven mass that know nothing of each other.
struct Both;

impl Mechanics<Product<SO3, Translations<1>, 3, 3, 2, 1>, 5, 4> for Both {
    type Control = ();

    fn energy(&self, at: &Phase<5, 4>) -> f64 {
        let (top, mass) = split(&(at.g, at.mu));
        let phase = |(g, mu)| Phase { g, mu, time: at.time };
        HeavyTop.energy(&phase(top)) + Driven.energy(&Phase { g: mass.0, mu: mass.1, time: at.time })
    }

    fn force(&self, at: &Phase<5, 4>, (): &()) -> SVector<f64, 4> {
        let (_, (g, mu)) = split(&(at.g, at.mu));
        let force = Driven.force(&Phase { g, mu, time: at.time }, &0.0);
        vector![0.0, 0.0, 0.0, force.x]
    }
}

type State<const N: usize, const D: usize> = (SMatrix<f64, N, N>, SVector<f64, D>);

fn split((g, mu): &State<5, 4>) -> (State<3, 3>, State<2, 1>) {
    let first = (g.fixed_view::<3, 3>(0, 0).into_owned(), mu.fixed_rows::<3>(0).into_owned());
    (first, (g.fixed_view::<2, 2>(3, 3).into_owned(), mu.fixed_rows::<1>(3).into_owned()))
}

#[test]
fn parts_of_a_product_that_are_not_coupled_move_as_they_would_alone() {
    fn check<R>(retraction: R)
    where
        R: MatrixRetraction<SO3, 3, 3>
            + MatrixRetraction<Translations<1>, 2, 1>
            + MatrixRetraction<Product<SO3, Translations<1>, 3, 3, 2, 1>, 5, 4>
            + Copy,
    {
        for s in MEMBERS {
            let (g, mu) = start();
            let mass = (Matrix2::new(1.0, 0.3, 0.0, 1.0), vector![-0.8]);
            let mut both = (SMatrix::<f64, 5, 5>::identity(), vector![mu.x, mu.y, mu.z, -0.8]);
            both.0.fixed_view_mut::<3, 3>(0, 0).copy_from(&g);
            both.0.fixed_view_mut::<2, 2>(3, 3).copy_from(&mass.0);

            let set = (0.1, s, Side::Left);
            let product = Product::of(SO3, Translations::<1>);
            let (top_end, mass_end) = split(&stepped((product, retraction, Both), set, both));
            let top = stepped((SO3, retraction, HeavyTop), set, (g, mu));
            let mass = stepped((Translations::<1>, retraction, Driven), set, mass);
            let errors = [(top_end.0 - top.0).amax(), (top_end.1 - top.1).amax()];
            assert!(errors.iter().all(|error| *error < 1e-14), "s = {s}: {errors:?}");
            let errors = [(mass_end.0 - mass.0).amax(), (mass_end.1 - mass.1).amax()];
            assert!(errors.iter().all(|error| *error < 1e-14), "s = {s}: {errors:?}");
        }
    }
    check(Exponential);
    check(Cayley);
}

/// What a system says of its derivatives is taken in place of difference quotients.
struct ByHand;

impl Mechanics<SO3, 3, 3> for ByHand {
    type Control = ();

    fn energy(&self, _: &Phase<3, 3>) -> f64 {
        f64::NAN
    }

    fn velocity(&self, at: &Phase<3, 3>) -> Vector3<f64> {
        at.mu.component_div(&INERTIA)
    }

    fn slope(&self, at: &Phase<3, 3>, side: Side) -> Vector3<f64> {
        let turned = LEVER.cross(&(at.g.transpose() * Vector3::z()));
        match side {
            Side::Left => turned,
            Side::Right => at.g * turned,
        }
    }
}

#[test]
fn differences_are_as_good_as_derivatives_by_hand() {
    for side in [Side::Left, Side::Right] {
        let (g, mu) = start();
        let by_hand = stepped((SO3, Exponential, ByHand), (0.1, 0.25, side), (g, mu));
        let by_differences = stepped((SO3, Exponential, HeavyTop), (0.1, 0.25, side), (g, mu));
        assert!((by_hand.1 - by_differences.1).amax() < 5e-15, "{:e}", (by_hand.1 - by_differences.1).amax());
    }
}

/// A brake that is stronger than the step can bear.
struct Braked;

impl Mechanics<Translations<1>, 2, 1> for Braked {
    type Control = ();

    fn energy(&self, at: &Phase<2, 1>) -> f64 {
        at.mu.x.powi(2) / 2.0
    }

    fn force(&self, at: &Phase<2, 1>, (): &()) -> SVector<f64, 1> {
        at.mu * -30.0
    }
}

#[test]
fn a_kick_that_cannot_be_solved_for_is_an_error() {
    let mut stepper = GenericStepper::new(Translations::<1>, Exponential, Braked, 0.1).unwrap();
    let (mut g, mut mu) = (Matrix2::identity(), vector![1.0]);
    let outcome = stepper.step(&mut g, &mut mu);
    assert!(matches!(outcome, Err(StepError::NoConvergence { .. })), "{outcome:?}");
    assert_eq!((g, mu), (Matrix2::identity(), vector![1.0]));
    let mut shorter = GenericStepper::new(Translations::<1>, Exponential, Braked, 0.01).unwrap();
    shorter.step(&mut g, &mut mu).unwrap();
    assert!((mu.x - 1.0 / 1.3).abs() < 1e-15);
}
