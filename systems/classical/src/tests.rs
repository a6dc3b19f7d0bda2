use nalgebra::{
    Matrix2, Matrix3, Quaternion, SMatrix, SVector, UnitQuaternion, Vector1, Vector2, Vector3, Vector4,
    Vector6,
};

use super::attitude::{exp, inverse_exp_derivative};
use super::bodies::{HeavyTop, RigidBody};
use super::stages;
use super::*;

/// A step at which an error of any order shows.
const LARGE: f64 = 0.3;

fn explicit_euler() -> RungeKutta {
    Tableau::explicit_euler().into()
}

fn implicit_euler() -> RungeKutta {
    Tableau::implicit_euler().into()
}

fn rk2() -> RungeKutta {
    Tableau::rk2().into()
}

fn rk4() -> RungeKutta {
    Tableau::rk4().into()
}

fn euler_a() -> PartitionedRungeKutta {
    PartitionedTableau::symplectic_euler_a().into()
}

fn euler_b() -> PartitionedRungeKutta {
    PartitionedTableau::symplectic_euler_b().into()
}

fn verlet() -> PartitionedRungeKutta {
    PartitionedTableau::stormer_verlet().into()
}

fn lobatto() -> PartitionedRungeKutta {
    PartitionedTableau::lobatto3().into()
}

/// The slope of `log error` over `log h`, by least squares.
fn slope(points: &[(f64, f64)]) -> f64 {
    let logarithms = || points.iter().map(|(h, error)| (h.ln(), error.ln()));
    let count = points.len() as f64;
    let (x, y) = logarithms().fold((0.0, 0.0), |(x, y), (a, b)| (x + a / count, y + b / count));
    let (above, below) =
        logarithms().fold((0.0, 0.0), |(s, t), (a, b)| (s + (a - x) * (b - y), t + (a - x).powi(2)));
    above / below
}

/// Measures the order on `[time, time + duration]` with these numbers of steps.
fn assert_order<I: Integrator<S, X>, S, X: Copy>(
    method: &I,
    system: &S,
    (time, duration): (f64, f64),
    start: X,
    steps: [u64; 4],
    error: impl Fn(&X) -> f64,
) {
    let points = steps.map(|count| {
        let h = duration / count as f64;
        let end = integrate(method, system, time, start, h, count, |_, _, _| {}).expect("a solvable step");
        (h, error(&end))
    });
    let measured = slope(&points);
    println!("{}: order {measured:.3}, errors {:?}", method.name(), points.map(|(_, error)| error));
    assert!(
        points.iter().all(|(_, error)| *error > 1e-11),
        "{}: too close to roundoff: {points:?}",
        method.name()
    );
    assert!(
        (measured - f64::from(method.order())).abs() < 0.1,
        "{}: {measured} from {points:?}",
        method.name()
    );
}

const COARSE: [u64; 4] = [100, 200, 400, 800];
const FINE: [u64; 4] = [2_000, 4_000, 8_000, 16_000];

// The Kepler problem with attraction 1, semi-major axis 1 and this eccentricity, from its pericentre.
const ECCENTRICITY: f64 = 0.5;

/// The solution: `E − e sin E = t`, `q = (cos E − e, √(1 − e²) sin E)`.
fn kepler(time: f64) -> PhasePoint<2> {
    let mut anomaly = time;
    for _ in 0..50 {
        anomaly -= (anomaly - ECCENTRICITY * anomaly.sin() - time) / (1.0 - ECCENTRICITY * anomaly.cos());
    }
    let (sine, cosine) = anomaly.sin_cos();
    let minor = (1.0 - ECCENTRICITY * ECCENTRICITY).sqrt();
    let rate = 1.0 / (1.0 - ECCENTRICITY * cosine);
    PhasePoint {
        q: Vector2::new(cosine - ECCENTRICITY, minor * sine),
        p: Vector2::new(-sine, minor * cosine) * rate,
    }
}

fn attraction(q: &Vector2<f64>) -> Vector2<f64> {
    -q / q.norm().powi(3)
}

fn kepler_field(_: f64, x: &Vector4<f64>) -> Vector4<f64> {
    let force = attraction(&Vector2::new(x[0], x[1]));
    Vector4::new(x[2], x[3], force.x, force.y)
}

fn kepler_split() -> impl Partitioned<2> {
    Split { velocity: |p: &Vector2<f64>| *p, force: |_: f64, q: &Vector2<f64>| attraction(q) }
}

fn flat(point: &PhasePoint<2>) -> Vector4<f64> {
    Vector4::new(point.q.x, point.q.y, point.p.x, point.p.y)
}

/// The Kepler problem for the order in the state, and `x' = 3 (x − x²) cos 3t` for that in time.
fn assert_orders_of_field<I>(method: I, steps: [u64; 4])
where
    I: Integrator<fn(f64, &Vector4<f64>) -> Vector4<f64>, Vector4<f64>>
        + Integrator<fn(f64, &Vector1<f64>) -> Vector1<f64>, Vector1<f64>>,
{
    let (duration, start) = (2.0, flat(&kepler(0.0)));
    let exact = flat(&kepler(duration));
    let field: fn(f64, &Vector4<f64>) -> Vector4<f64> = kepler_field;
    assert_order(&method, &field, (0.0, duration), start, steps, |x| (x - exact).norm());

    let logistic: fn(f64, &Vector1<f64>) -> Vector1<f64> =
        |t, x| (x - x.component_mul(x)) * (3.0 * (3.0 * t).cos());
    // x / (1 − x) = C exp(sin 3t)
    let solution = |time: f64| 1.0 / (1.0 + (-(3.0 * time).sin()).exp() * 1.5);
    let (from, duration) = (0.3, 1.5);
    assert_order(
        &method,
        &logistic,
        (from, duration),
        Vector1::new(solution(from)),
        steps.map(|n| n / 4),
        |x| (x[0] - solution(from + duration)).abs(),
    );
}

#[test]
fn methods_for_vector_fields_have_their_orders() {
    assert_orders_of_field(explicit_euler(), FINE);
    assert_orders_of_field(implicit_euler(), FINE);
    assert_orders_of_field(rk2(), COARSE.map(|n| 8 * n));
    assert_orders_of_field(RungeKutta::from(Tableau::heun()), COARSE.map(|n| 8 * n));
    assert_orders_of_field(RungeKutta::from(Tableau::ralston()), COARSE.map(|n| 8 * n));
    assert_orders_of_field(RungeKutta::from(Tableau::implicit_midpoint()), COARSE.map(|n| 8 * n));
    assert_orders_of_field(rk4(), COARSE);
    assert_orders_of_field(RungeKutta::from(Tableau::three_eighths()), COARSE);
    assert_orders_of_field(RungeKutta::from(Tableau::gauss2()), COARSE);
    assert_orders_of_field(RungeKutta::from(Tableau::gauss3()), [32, 48, 64, 96]);
}

#[test]
fn partitioned_methods_have_their_orders() {
    let (duration, start) = (2.0, kepler(0.0));
    let exact = flat(&kepler(duration));
    let error = |x: &PhasePoint<2>| (flat(x) - exact).norm();
    assert_order(&euler_a(), &kepler_split(), (0.0, duration), start, FINE, error);
    assert_order(&euler_b(), &kepler_split(), (0.0, duration), start, FINE, error);
    assert_order(&verlet(), &kepler_split(), (0.0, duration), start, COARSE.map(|n| 8 * n), error);
    assert_order(&lobatto(), &kepler_split(), (0.0, duration), start, COARSE, error);

    // q'' = −q + cos 2t, solved by q = cos t − ⅓ cos 2t
    let driven = Split {
        velocity: |p: &Vector1<f64>| *p,
        force: |t: f64, q: &Vector1<f64>| Vector1::new((2.0 * t).cos()) - q,
    };
    let solution = |t: f64| PhasePoint {
        q: Vector1::new(t.cos() - (2.0 * t).cos() / 3.0),
        p: Vector1::new(-t.sin() + (2.0 * t).sin() * 2.0 / 3.0),
    };
    let (from, duration) = (0.3, 2.0);
    let (start, end) = (solution(from), solution(from + duration));
    let error = |x: &PhasePoint<1>| (x.q - end.q).norm() + (x.p - end.p).norm();
    assert_order(&euler_a(), &driven, (from, duration), start, FINE, error);
    assert_order(&euler_b(), &driven, (from, duration), start, FINE, error);
    assert_order(&verlet(), &driven, (from, duration), start, COARSE, error);
    assert_order(&lobatto(), &driven, (from, duration), start, [10, 20, 40, 80], error);
}

/// `∂f/∂x` at the time 0, by differences.
fn jacobian(field: &impl VectorField<2>, x: &Vector2<f64>) -> Matrix2<f64> {
    let mut rate = |time: f64, x: &[f64], rate: &mut [f64]| {
        rate.copy_from_slice(field.at(time, &Vector2::from_column_slice(x)).as_slice());
    };
    let matrix = stages::jacobian(&mut rate, 0.0, x.as_slice());
    Matrix2::from_column_slice(matrix.as_slice())
}

fn embedded_pendulum(_: f64, x: &Vector3<f64>) -> Vector3<f64> {
    Vector3::new(-x.y * x.z, x.x * x.z, -x.y)
}

#[test]
fn projection_keeps_the_order_and_the_cylinder() {
    let duration = 3.0;
    let pendulum = |_: f64, x: &Vector2<f64>| Vector2::new(x.y, -x.x.sin());
    let end = integrate(&rk4(), &pendulum, 0.0, Vector2::new(1.0, 0.0), duration / 2e4, 20_000, |_, _, _| {})
        .expect("a finite motion");
    let exact = Vector3::new(end.x.cos(), end.x.sin(), end.y);
    let start = Vector3::new(1_f64.cos(), 1_f64.sin(), 0.0);
    let method = Projected { method: rk2(), projection: unit_leading::<2, 3> };
    assert_order(&method, &embedded_pendulum, (0.0, duration), start, COARSE, |x| (x - exact).norm());

    let off = |x: &Vector3<f64>| (x.x.hypot(x.y) - 1.0).abs();
    let mut worst: f64 = 0.0;
    integrate(&method, &embedded_pendulum, 0.0, start, 0.1, 1_000, |_, _, x| worst = worst.max(off(x)))
        .expect("finite");
    assert!(worst < 1e-15, "{worst}");
    let free = integrate(&rk2(), &embedded_pendulum, 0.0, start, 0.1, 1_000, |_, _, _| {}).expect("finite");
    assert!(off(&free) > 1e-3, "without projection it drifts off: {free}");
}

#[test]
fn the_projection_is_orthogonal_and_changes_only_what_leads() {
    let x = SVector::from([3.0, -1.0, 2.0, 0.5, 7.0, -8.0]);
    let projected = unit_leading::<4, 6>(&x);
    assert!((projected.fixed_rows::<4>(0).norm() - 1.0).abs() < 1e-15);
    assert!((projected.fixed_rows::<4>(0) * 14.25_f64.sqrt() - x.fixed_rows::<4>(0)).norm() < 1e-14);
    assert_eq!(projected.fixed_rows::<2>(4), x.fixed_rows::<2>(4));
    assert!((unit_leading::<4, 6>(&projected) - projected).norm() < 1e-15);

    let vanishing = |_: f64, x: &Vector2<f64>| -x;
    let method = Projected { method: explicit_euler(), projection: unit_leading::<2, 2> };
    assert_eq!(method.step(&vanishing, 0.0, &Vector2::new(1.0, 0.0), 1.0), Err(Diverged::NotFinite));
}

/// The update matrix of a step at `x`, by central differences.
fn update_matrix<S, const N: usize, const D: usize>(
    method: &PartitionedRungeKutta,
    system: &S,
    x: &PhasePoint<N>,
    h: f64,
) -> SMatrix<f64, D, D>
where
    S: Partitioned<N>,
{
    let moved = |j: usize, by: f64| {
        let mut x = *x;
        if j < N {
            x.q[j] += by
        } else {
            x.p[j - N] += by
        }
        let x = method.step(system, 0.4, &x, h).expect("a finite step");
        SVector::<f64, D>::from_iterator(x.q.iter().chain(x.p.iter()).copied())
    };
    let offset = 1e-5;
    let mut matrix = SMatrix::<f64, D, D>::zeros();
    for j in 0..D {
        matrix.set_column(j, &((moved(j, offset) - moved(j, -offset)) / (2.0 * offset)));
    }
    matrix
}

/// `H = ½ (1 + q²/3) p² − cos q + ½ q p`: not separable.
struct Coupled;

impl Partitioned<1> for Coupled {
    fn velocity(&self, _: f64, q: &Vector1<f64>, p: &Vector1<f64>) -> Vector1<f64> {
        p * (1.0 + q.x * q.x / 3.0) + q * 0.5
    }

    fn force(&self, _: f64, q: &Vector1<f64>, p: &Vector1<f64>) -> Vector1<f64> {
        Vector1::new(-q.x * p.x * p.x / 3.0 - q.x.sin() - 0.5 * p.x)
    }
}

/// What `Aᵀ J A − J` is of the update matrix: of one degree of freedom, and the Kepler problem.
fn symplectic_defect<S: Partitioned<1>>(method: &PartitionedRungeKutta, system: &S) -> [f64; 2] {
    let x = PhasePoint { q: Vector1::new(1.1), p: Vector1::new(0.7) };
    let area: Matrix2<f64> = update_matrix(method, system, &x, LARGE);

    let x = PhasePoint { q: Vector2::new(1.1, -0.4), p: Vector2::new(0.3, 0.7) };
    let matrix: SMatrix<f64, 4, 4> = update_matrix(method, &kepler_split(), &x, LARGE);
    let mut form = SMatrix::<f64, 4, 4>::zeros();
    form.fixed_view_mut::<2, 2>(0, 2).fill_with_identity();
    form -= form.transpose();
    [(area.determinant() - 1.0).abs(), (matrix.transpose() * form * matrix - form).norm()]
}

#[test]
fn partitioned_methods_are_symplectic_where_their_tableaux_say_so() {
    let pendulum = Split {
        velocity: |p: &Vector1<f64>| p / 1.3,
        force: |t: f64, q: &Vector1<f64>| q.map(|angle| -angle.sin()) * (1.0 + t),
    };
    for method in [euler_a(), euler_b(), verlet(), lobatto()] {
        let defects = [symplectic_defect(&method, &pendulum), symplectic_defect(&method, &Coupled)];
        assert!(defects.iter().flatten().all(|defect| *defect < 1e-9), "{}: {defects:?}", method.name());
    }
    // as the paper prints it
    let half = Rational::fraction(1, 2);
    let (zero, one) = (Rational::zero(), Rational::fraction(1, 1));
    let positions = Tableau::new("printed", [[zero, zero], [one, zero]], [half, half]);
    let momenta = PartitionedTableau::stormer_verlet().momenta().clone();
    let printed = PartitionedTableau::new("printed", positions, momenta).expect("two stages");
    assert!(!printed.is_symplectic());
    let [defect, _] = symplectic_defect(&printed.into(), &Coupled);
    assert!(defect > 1e-3, "{defect:e}");
}

/// The defect of the update matrix of a method for vector fields.
fn defect_of_field(method: &RungeKutta) -> f64 {
    let field = |_: f64, x: &Vector2<f64>| {
        let (q, p) = (Vector1::new(x.x), Vector1::new(x.y));
        Vector2::new(Coupled.velocity(0.0, &q, &p).x, Coupled.force(0.0, &q, &p).x)
    };
    let moved = |by: Vector2<f64>| {
        method.step(&field, 0.0, &(Vector2::new(1.1, 0.7) + by), LARGE).expect("a solvable step")
    };
    let column = |by: Vector2<f64>| (moved(by) - moved(-by)) / (2.0 * by.norm());
    let matrix = Matrix2::from_columns(&[column(Vector2::x() * 1e-5), column(Vector2::y() * 1e-5)]);
    (matrix.determinant() - 1.0).abs()
}

#[test]
fn methods_for_vector_fields_are_symplectic_where_their_tableaux_say_so() {
    fn check<const D: u32>(tableau: Tableau<D>) {
        let symplectic = tableau.is_symplectic();
        let method = RungeKutta::from(tableau);
        let defect = defect_of_field(&method);
        println!("{}: {defect:e}", method.name());
        assert_eq!(symplectic, defect < 1e-9, "{}: {defect:e}", method.name());
        assert!(symplectic || defect > 1e-5, "{}: {defect:e}", method.name());
    }
    check(Tableau::explicit_euler());
    check(Tableau::implicit_euler());
    check(Tableau::rk2());
    check(Tableau::heun());
    check(Tableau::ralston());
    check(Tableau::rk4());
    check(Tableau::three_eighths());
    check(Tableau::implicit_midpoint());
    check(Tableau::gauss2());
    check(Tableau::gauss3());
}

/// Steps of each are what their formulas say, written out.
#[test]
fn tableaux_take_the_steps_of_the_textbooks() {
    let field = |t: f64, x: &Vector2<f64>| Vector2::new(x.y + t.sin(), -x.x.sin() - 0.1 * x.y * t);
    let (t, x, h) = (0.4, Vector2::new(0.8, -0.3), 0.1);
    let f1 = field(t, &x);
    let f2 = field(t + h / 2.0, &(x + f1 * (h / 2.0)));
    let f3 = field(t + h / 2.0, &(x + f2 * (h / 2.0)));
    let f4 = field(t + h, &(x + f3 * h));
    let heun = field(t + h, &(x + f1 * h));
    let ralston = field(t + 2.0 * h / 3.0, &(x + f1 * (2.0 * h / 3.0)));
    for (method, expected) in [
        (rk2(), x + f2 * h),
        (RungeKutta::from(Tableau::heun()), x + (f1 + heun) * (h / 2.0)),
        (RungeKutta::from(Tableau::ralston()), x + (f1 + ralston * 3.0) * (h / 4.0)),
        (rk4(), x + (f1 + (f2 + f3) * 2.0 + f4) * (h / 6.0)),
    ] {
        let got = method.step(&field, t, &x, h).expect("finite");
        assert!((got - expected).norm() < 3e-16, "{}: {got} {expected}", method.name());
    }
    // at the mean of both ends, and the mean of the gradients
    let midpoint = RungeKutta::from(Tableau::implicit_midpoint());
    let got = midpoint.step(&field, t, &x, h).expect("solvable");
    assert!((got - x - field(t + h / 2.0, &((x + got) / 2.0)) * h).norm() < 3e-16, "{got}");

    let split = kepler_split();
    let x = kepler(0.7);
    let middle = x.p + attraction(&x.q) * (h / 2.0);
    let q = x.q + middle * h;
    let expected = PhasePoint { q, p: middle + attraction(&q) * (h / 2.0) };
    let got = verlet().step(&split, 0.0, &x, h).expect("finite");
    assert!((flat(&got) - flat(&expected)).norm() < 5e-16, "{got:?}");
}

/// Stages that do not follow one from the other are solved for by Newton's iteration where the step is too large for sweeps.
#[test]
fn stiff_systems_are_solved_for_by_newton() {
    // x' = A x with eigenvalues −1 and −1e5: Gauss's method is a rational function of the matrix
    let stiff = Matrix2::new(-1.0, 1.0, 0.0, -1e5);
    let field = |_: f64, x: &Vector2<f64>| stiff * x;
    let x = Vector2::new(1.0, 1.0);
    let got = RungeKutta::from(Tableau::gauss2()).step(&field, 0.0, &x, 0.1).expect("solvable");
    let z = stiff * 0.1;
    let (one, square) = (Matrix2::identity(), z * z / 12.0);
    let below = (one - z * 0.5 + square).try_inverse().expect("regular");
    let expected = below * (one + z * 0.5 + square) * x;
    assert!((got - expected).norm() < 1e-9, "{got} {expected}");
}

#[test]
fn the_oscillator_has_the_papers_update_matrices() {
    let (h, ratio) = (0.1, 1.7);
    let field = |_: f64, x: &Vector2<f64>| Vector2::new(x.y, -ratio * x.x);
    let split = Split { velocity: |p: &Vector1<f64>| *p, force: |_: f64, q: &Vector1<f64>| -ratio * q };
    let x = Vector2::new(0.8, -0.3);
    let point = PhasePoint { q: Vector1::new(x.x), p: Vector1::new(x.y) };
    let flat = |x: PhasePoint<1>| Vector2::new(x.q[0], x.p[0]);
    let square = h * h * ratio;
    let expected = [
        Matrix2::new(1.0, h, -h * ratio, 1.0),
        Matrix2::new(1.0, h, -h * ratio, 1.0) / (1.0 + square),
        Matrix2::new(1.0 - square, h, -h * ratio, 1.0),
        Matrix2::new(1.0, h, -h * ratio, 1.0 - square),
    ];
    let got = [
        explicit_euler().step(&field, 0.0, &x, h),
        implicit_euler().step(&field, 0.0, &x, h),
        euler_a().step(&split, 0.0, &point, h).map(flat),
        euler_b().step(&split, 0.0, &point, h).map(flat),
    ];
    for (matrix, got) in expected.iter().zip(got) {
        let got = got.expect("a solvable step");
        assert!((matrix * x - got).norm() < 1e-15, "{matrix}: {got}");
    }
}

#[test]
fn forces_act_at_the_times_the_formulas_say() {
    let split = Split {
        velocity: |_: &Vector1<f64>| Vector1::zeros(),
        force: |t: f64, _: &Vector1<f64>| Vector1::new(t * t),
    };
    let start = PhasePoint { q: Vector1::zeros(), p: Vector1::zeros() };
    let (a, b) = (4.0, 4.41);
    for (got, expected) in [
        (euler_a().step(&split, 2.0, &start, 0.1), a),
        (euler_b().step(&split, 2.0, &start, 0.1), b),
        (verlet().step(&split, 2.0, &start, 0.1), (a + b) / 2.0),
    ] {
        assert!((got.expect("finite").p[0] - 0.1 * expected).abs() < 1e-15);
    }
    let field = |t: f64, _: &Vector1<f64>| Vector1::new(t * t);
    let implicit = implicit_euler().step(&field, 2.0, &Vector1::zeros(), 0.1).expect("finite");
    assert!((implicit[0] - 0.1 * b).abs() < 1e-15);
}

#[test]
fn adjoint_methods_undo_each_other() {
    let (system, start) = (kepler_split(), kepler(0.7));
    let there = euler_a().step(&system, 0.0, &start, LARGE).expect("finite");
    let back = euler_b().step(&system, LARGE, &there, -LARGE).expect("finite");
    assert!((flat(&back) - flat(&start)).norm() < 1e-14);
    let there = verlet().step(&system, 0.0, &start, LARGE).expect("finite");
    let back = verlet().step(&system, LARGE, &there, -LARGE).expect("finite");
    assert!((flat(&back) - flat(&start)).norm() < 1e-14);
}

#[test]
fn implicit_euler_solves_its_equation_to_roundoff() {
    // van der Pol with a large parameter, from states of very different sizes of components
    for stiffness in [1.0, 1e3, 1e6] {
        let field = |_: f64, x: &Vector2<f64>| Vector2::new(x.y, stiffness * (1.0 - x.x * x.x) * x.y - x.x);
        let start = Vector2::new(2.0, 1e-3);
        for h in [1e-4, 1e-2, 0.1] {
            let x = implicit_euler().step(&field, 0.0, &start, h).expect("a solvable step");
            let residual = x - start - field(h, &x) * h;
            let terms = 1.0 + h * (1.0 + stiffness * (x.x * x.x + 1.0) * x.y.abs());
            assert!(residual.norm() < 32.0 * f64::EPSILON * terms, "{stiffness} {h}: {residual}");
        }
    }
    // (1 + h λ)⁻¹ for any λ, and a state at rest
    let linear = |_: f64, x: &Vector1<f64>| x * -1e9;
    let x = implicit_euler().step(&linear, 0.0, &Vector1::new(1e-8), 1.0).expect("a solvable step");
    assert!((x[0] * (1.0 + 1e9) / 1e-8 - 1.0).abs() < 1e-12);
    assert_eq!(implicit_euler().step(&linear, 0.0, &Vector1::zeros(), 1.0), Ok(Vector1::zeros()));
}

#[test]
fn jacobians_are_right_for_components_of_any_size() {
    let field = |_: f64, x: &Vector2<f64>| Vector2::new(x.x + x.y, x.x * 1e-6 - x.y.sin());
    for y in [0.0, 1e-30, 1e-3, 1.0] {
        for x in [0.0, 1.0, 1e6] {
            let difference =
                jacobian(&field, &Vector2::new(x, y)) - Matrix2::new(1.0, 1.0, 1e-6, -f64::cos(y));
            assert!(difference.norm() < 1e-5, "{x} {y}: {difference}");
        }
    }
}

#[test]
fn implicit_euler_says_when_there_is_no_solution() {
    // x = 1 + h x² has the discriminant 1 − 4h
    let square = |_: f64, x: &Vector1<f64>| x.component_mul(x);
    let start = Vector1::new(1.0);
    let x = implicit_euler().step(&square, 0.0, &start, 0.24).expect("a solvable step");
    assert!((x[0] - (1.0 - 0.04_f64.sqrt()) / 0.48).abs() < 1e-13);
    let error = implicit_euler().step(&square, 0.0, &start, 0.3);
    assert!(matches!(error, Err(Diverged::NoConvergence { .. })), "{error:?}");
    // x = 1 + x
    let identity = |_: f64, x: &Vector1<f64>| *x;
    let error = implicit_euler().step(&identity, 0.0, &start, 1.0);
    assert!(matches!(error, Err(Diverged::NoConvergence { iterations: 0, .. })), "{error:?}");
    let broken = |_: f64, x: &Vector1<f64>| x * f64::NAN;
    assert_eq!(implicit_euler().step(&broken, 0.0, &start, 1.0), Err(Diverged::NotFinite));
}

#[test]
fn states_that_are_not_finite_are_errors() {
    let wild = |_: f64, x: &Vector2<f64>| x.map(|component| component * component * 1e200);
    let start = Vector2::new(1.0, 1e100);
    assert_eq!(explicit_euler().step(&wild, 0.0, &start, 1.0), Err(Diverged::NotFinite));
    assert_eq!(rk2().step(&wild, 0.0, &start, 1.0), Err(Diverged::NotFinite));
    assert_eq!(rk4().step(&wild, 0.0, &start, 1.0), Err(Diverged::NotFinite));
    let split =
        Split { velocity: |p: &Vector1<f64>| *p, force: |_: f64, _: &Vector1<f64>| Vector1::new(1e300) };
    let start = PhasePoint { q: Vector1::zeros(), p: Vector1::zeros() };
    assert_eq!(lobatto().step(&split, 0.0, &start, 1e9), Err(Diverged::NotFinite));
    assert_eq!(euler_a().step(&split, 0.0, &start, 1e9), Err(Diverged::NotFinite));
    assert_eq!(euler_b().step(&split, 0.0, &start, 1e9), Err(Diverged::NotFinite));
    assert_eq!(verlet().step(&split, 0.0, &start, 1e9), Err(Diverged::NotFinite));
    let body = RigidBody::new(Vector3::new(0.0, 1.0, 1.0));
    let start = AttitudeState { attitude: UnitQuaternion::identity(), y: Vector3::new(1.0, 1.0, 1.0) };
    assert_eq!(Rk4Quaternion.step(&body, 0.0, &start, 0.1), Err(Diverged::NotFinite));
    assert_eq!(Rkmk4.step(&body, 0.0, &start, 0.1), Err(Diverged::NotFinite));
}

#[test]
fn the_driver_visits_every_state_once_and_stops_at_the_first_error() {
    let constant = |_: f64, _: &Vector1<f64>| Vector1::new(1.0);
    let mut seen = Vec::new();
    let end =
        integrate(&rk4(), &constant, 5.0, Vector1::zeros(), 0.5, 3, |k, time, x| seen.push((k, time, x[0])));
    assert_eq!(end, Ok(Vector1::new(1.5)));
    assert_eq!(seen, [(0, 5.0, 0.0), (1, 5.5, 0.5), (2, 6.0, 1.0), (3, 6.5, 1.5)]);

    let until = |t: f64, _: &Vector1<f64>| Vector1::new(if t < 1.2 { 1.0 } else { f64::NAN });
    let mut last = 0;
    let end = integrate(&explicit_euler(), &until, 0.0, Vector1::zeros(), 0.5, 10, |k, _, _| last = k);
    assert_eq!((end, last), (Err(Diverged::NotFinite), 3));
}

#[test]
fn the_exponential_is_that_of_its_power_series_and_smooth_across_its_switch() {
    let axis = Vector3::new(0.48, -0.6, 0.64);
    for angle in [0.0, 1e-200, 1e-9, 0.1, 0.5, 0.707, 0.708, 1.2, 1.9, 3.0, 6.0] {
        let matrix = (axis * angle).cross_matrix();
        let (mut sum, mut term) = (Matrix3::identity(), Matrix3::identity());
        for k in 1..60 {
            term = term * matrix / f64::from(k);
            sum += term;
        }
        let got = exp(&(axis * angle));
        assert!((got.norm() - 1.0).abs() < 1e-15, "{angle}");
        assert!((got.to_rotation_matrix().matrix() - sum).norm() < 1e-13, "{angle}");
        let (sine, cosine) = (angle / 2.0).sin_cos();
        let expected = Quaternion::from_parts(cosine, axis * sine);
        assert!((got.quaternion() - expected).norm() < 4e-16, "{angle}: {got}");
    }
}

#[test]
fn the_derivative_of_the_exponential_is_inverted_by_definition() {
    let theta = Vector3::new(0.012, -0.02, 0.009);
    let velocity = Vector3::new(0.7, 0.5, -1.1);
    let slope = inverse_exp_derivative(&theta, &velocity);
    // exp(θ)⁻¹ exp(θ + ε θ') turns by ε ω
    let offset = 1e-5;
    let turn = |by: f64| (exp(&theta).inverse() * exp(&(theta + slope * by))).scaled_axis();
    let measured = (turn(offset) - turn(-offset)) / (2.0 * offset);
    // |θ|⁴ |ω| / 720, and differences
    assert!((measured - velocity).norm() < 1e-9, "{measured}");
}

/// A body that uses all arguments: driven in time, with a spring that pulls its attitude back, and a bit of friction.
struct Driven;

impl Driven {
    fn angular_velocity(time: f64, y: &Vector3<f64>) -> Vector3<f64> {
        Vector3::new(y.x, y.y / 2.0, y.z / 3.0) + Vector3::new(0.0, 0.3, 0.1) * time.sin()
    }

    /// From the rotation matrix, for the reference to share.
    fn torque(time: f64, matrix: &Matrix3<f64>, y: &Vector3<f64>) -> Vector3<f64> {
        let vertical = matrix.row(2).transpose();
        y.cross(&Self::angular_velocity(time, y)) + vertical.cross(&Vector3::new(0.4, 0.0, 1.0)) - y * 0.1
            + Vector3::x() * (2.0 * time).cos()
    }
}

impl OnSo3<3> for Driven {
    fn velocity(&self, time: f64, attitude: &UnitQuaternion<f64>, y: &Vector3<f64>) -> Vector3<f64> {
        Self::angular_velocity(time, y) + attitude.inverse() * Vector3::new(0.2, 0.0, 0.0)
    }

    fn rate(&self, time: f64, attitude: &UnitQuaternion<f64>, y: &Vector3<f64>) -> Vector3<f64> {
        assert!((attitude.norm() - 1.0).abs() < 1e-12, "a system is asked at rotations only");
        Self::torque(time, attitude.to_rotation_matrix().matrix(), y)
    }
}

/// `R' = R ω̂` with the matrix's nine entries, by small steps of RK4: shares nothing with the methods under test. `N = 9 + M`.
fn reference<const N: usize, const M: usize>(
    derivative: impl Fn(f64, &Matrix3<f64>, &SVector<f64, M>) -> (Vector3<f64>, SVector<f64, M>),
    start: &AttitudeState<M>,
    (time, duration): (f64, f64),
) -> (Matrix3<f64>, SVector<f64, M>) {
    let join = |matrix: &Matrix3<f64>, y: &SVector<f64, M>| {
        SVector::<f64, N>::from_iterator(matrix.iter().chain(y.iter()).copied())
    };
    let split = |x: &SVector<f64, N>| {
        (
            Matrix3::from_iterator(x.iter().copied()),
            SVector::<f64, M>::from_iterator(x.iter().skip(9).copied()),
        )
    };
    let field = |time: f64, x: &SVector<f64, N>| {
        let (matrix, y) = split(x);
        let (velocity, rate) = derivative(time, &matrix, &y);
        join(&(matrix * velocity.cross_matrix()), &rate)
    };
    let steps = 4_000;
    let start = join(start.attitude.to_rotation_matrix().matrix(), &start.y);
    let end = integrate(&rk4(), &field, time, start, duration / steps as f64, steps, |_, _, _| {});
    split(&end.expect("a finite motion"))
}

fn assert_attitude_orders<S: OnSo3<M>, const M: usize>(
    system: &S,
    start: AttitudeState<M>,
    span: (f64, f64),
    end: &(Matrix3<f64>, SVector<f64, M>),
) {
    let steps = [32, 64, 128, 256];
    let attitude = |x: &AttitudeState<M>| (x.attitude.to_rotation_matrix().matrix() - end.0).norm();
    let error = |x: &AttitudeState<M>| attitude(x) + (x.y - end.1).norm();
    assert_order(&Rk4Quaternion, system, span, start, steps, attitude);
    assert_order(&Rk4Quaternion, system, span, start, steps, error);
    assert_order(&Rkmk4, system, span, start, steps, attitude);
    assert_order(&Rkmk4, system, span, start, steps, error);
}

fn tilted() -> UnitQuaternion<f64> {
    UnitQuaternion::from_scaled_axis(Vector3::new(0.5, -0.3, 0.8))
}

#[test]
fn attitude_methods_have_order_4_for_the_rigid_body() {
    let start = AttitudeState { attitude: tilted(), y: Vector3::new(0.6, 1.9, 1.1) };
    let span = (0.0, 3.0);
    let end = reference::<12, 3>(
        |_, _, y| {
            let velocity = Vector3::new(y.x, y.y / 2.0, y.z / 3.0);
            (velocity, y.cross(&velocity))
        },
        &start,
        span,
    );
    assert_attitude_orders(&RigidBody::new(Vector3::new(1.0, 2.0, 3.0)), start, span, &end);
}

#[test]
fn attitude_methods_have_order_4_for_the_heavy_top() {
    let start = AttitudeState { attitude: tilted(), y: Vector6::new(0.6, 0.9, 2.1, 0.48, -0.6, 0.64) };
    let span = (0.0, 2.0);
    let end = reference::<15, 6>(
        |_, _, y| {
            let (momentum, gamma) = (y.fixed_rows::<3>(0), y.fixed_rows::<3>(3));
            let velocity = momentum.component_div(&Vector3::new(2.0, 2.5, 1.0));
            let first = momentum.cross(&velocity) + gamma.cross(&Vector3::new(0.2, 0.0, 0.9)) * 1.5;
            let mut rate = Vector6::zeros();
            rate.fixed_rows_mut::<3>(0).copy_from(&first);
            rate.fixed_rows_mut::<3>(3).copy_from(&gamma.cross(&velocity));
            (velocity, rate)
        },
        &start,
        span,
    );
    let top = HeavyTop::new(Vector3::new(2.0, 2.5, 1.0), 1.5, Vector3::new(0.2, 0.0, 0.9));
    assert_attitude_orders(&top, start, span, &end);
}

#[test]
fn attitude_methods_have_order_4_where_attitude_and_time_act() {
    let start = AttitudeState { attitude: tilted(), y: Vector3::new(0.6, 0.9, 1.1) };
    let span = (0.4, 3.0);
    let end = reference::<12, 3>(
        |time, matrix, y| {
            let velocity =
                Driven::angular_velocity(time, y) + matrix.transpose() * Vector3::new(0.2, 0.0, 0.0);
            (velocity, Driven::torque(time, matrix, y))
        },
        &start,
        span,
    );
    assert_attitude_orders(&Driven, start, span, &end);
}

#[test]
fn attitude_methods_stay_on_the_group() {
    fn check<I: Integrator<RigidBody, AttitudeState<3>>>(method: I, bound: f64) {
        let body = RigidBody::new(Vector3::new(1.0, 2.0, 3.0));
        let start = AttitudeState { attitude: tilted(), y: Vector3::new(0.6, 1.9, 1.1) };
        let mut worst: f64 = 0.0;
        integrate(&method, &body, 0.0, start, 0.05, 20_000, |_, _, x| {
            worst = worst.max((x.attitude.norm() - 1.0).abs());
        })
        .expect("finite");
        println!("{}: |q| − 1 up to {worst:e}", method.name());
        assert!(worst < bound, "{}: {worst:e}", method.name());
    }
    check(Rk4Quaternion, 1e-15);
    check(Rkmk4, 1e-13);
}

#[test]
fn bodies_preserve_what_they_should() {
    let body = RigidBody::new(Vector3::new(1.0, 2.0, 3.0));
    let start = AttitudeState { attitude: tilted(), y: Vector3::new(0.6, 1.9, 1.1) };
    let energy = 0.5 * (0.36 + 1.9 * 1.9 / 2.0 + 1.1 * 1.1 / 3.0);
    assert!((body.energy(&start.y) - energy).abs() < 1e-15);
    let end = integrate(&Rkmk4, &body, 0.0, start, 0.002, 1_000, |_, _, _| {}).expect("finite");
    assert!((body.energy(&end.y) - energy).abs() < 1e-11);
    assert!((end.attitude * end.y - start.attitude * start.y).norm() < 1e-11);

    let top = HeavyTop::new(Vector3::new(2.0, 2.5, 1.0), 1.5, Vector3::new(0.2, 0.0, 0.9));
    let vertical = tilted().inverse() * Vector3::z();
    let y = Vector6::new(0.6, 0.9, 2.1, vertical.x, vertical.y, vertical.z);
    let start = AttitudeState { attitude: tilted(), y };
    let energy = 0.5 * (0.18 + 0.81 / 2.5 + 4.41) + 1.5 * (tilted() * Vector3::new(0.2, 0.0, 0.9)).z;
    assert!((top.energy(&y) - energy).abs() < 1e-14);
    let end = integrate(&Rk4Quaternion, &top, 0.0, start, 0.002, 1_000, |_, _, _| {}).expect("finite");
    let (momentum, gamma) = (end.y.fixed_rows::<3>(0), end.y.fixed_rows::<3>(3));
    assert!((top.energy(&end.y) - energy).abs() < 1e-11);
    assert!((gamma - end.attitude.inverse() * Vector3::z()).norm() < 1e-11);
    assert!((momentum.dot(&gamma) - start.y.fixed_rows::<3>(0).dot(&vertical)).abs() < 1e-11);
}
