//! What a stepper remembers of earlier steps saves time, and decides nothing.

use std::sync::Arc;

use coadjoint::certify::certify_erased;
use coadjoint::erased;
use coadjoint_dynamic::{DynamicSystem, Model};

/// How many runs there are of each scheme, and how many steps are taken in one.
const RUNS: usize = 10;
const STEPS: usize = 100;

/// Two masses on rods of the same length, one hung from the other.
const DOUBLE_PENDULUM: &str = "
    #[lie_poisson_system(
        group(a: SO2, b: SO2),
        lagrangian = a_velocity.x.powi(2) + 0.5 * b_velocity.x.powi(2)
            + a_velocity.x * b_velocity.x * (a.angle() - b.angle()).cos()
            + g * (2.0 * a.cos_angle() + b.cos_angle()),
        methods(HamiltonJacobi(4), HamiltonJacobi(6)),
        retractions(Exponential, Cayley),
    )]
    struct DoublePendulum { g: f64 }";

/// A mass on a rod, by angles: near the poles the one about the vertical changes fast.
const SPHERICAL_PENDULUM: &str = "
    #[lie_poisson_system(
        group(th: R1, ph: R1),
        lagrangian = 0.5 * th_velocity.x.powi(2) + 0.5 * (0.05 + th.x.sin().powi(2)) * ph_velocity.x.powi(2)
            + g * th.x.cos(),
        methods(HamiltonJacobi(4)),
        retractions(Exponential, Cayley),
    )]
    struct SphericalPendulum { g: f64 }";

/// Takes steps, each beside one from the same state by a stepper that remembers nothing: both lead to the same state, or neither is taken.
/// Returns how many were taken.
fn warm_as_cold(system: &DynamicSystem, (scheme, step): (&str, f64), start: &[f64]) -> usize {
    let (system, scheme) = (Arc::new(system.clone()), scheme.parse().unwrap());
    let stepper = || erased::Stepper::new(system.clone(), &scheme, step).unwrap();
    let (mut warm, mut state) = (stepper(), start.to_vec());
    for taken in 0..STEPS {
        let mut other = state.clone();
        let cold = stepper().step(&mut other, &[]);
        match (warm.step(&mut state, &[]), cold) {
            (Ok(_), Ok(_)) => {}
            (Err(_), Err(_)) => return taken,
            (warm, cold) => panic!("{scheme}, {start:?}, step {taken}: warm {warm:?}, cold {cold:?}"),
        }
        let size = state.iter().fold(1.0_f64, |size, x| size.max(x.abs()));
        let off = state.iter().zip(&other).fold(0.0_f64, |off, (a, b)| off.max((a - b).abs()));
        assert!(off <= 1e-9 * size, "{scheme}, {start:?}, step {taken}: off by {off:e}");
    }
    STEPS
}

/// The double pendulum's state at these angles and rates.
fn double_pendulum(a: f64, b: f64, u: f64, v: f64) -> [f64; 6] {
    let (p, q) = (2.0 * u + v * (a - b).cos(), v + u * (a - b).cos());
    [a.cos(), a.sin(), p, b.cos(), b.sin(), q]
}

/// An equation of higher order has other solutions near, with energies of their own: here every fourth run of an earlier version came to one.
#[test]
fn steps_take_the_solution_that_they_would_take_from_rest() {
    let [double, spherical] =
        [DOUBLE_PENDULUM, SPHERICAL_PENDULUM].map(|text| Model::from_text(text).unwrap().system(&[9.81]));
    let mut drawn = 0.5_f64;
    let mut draw = |most: f64| {
        drawn = (997.0 * drawn + 0.618_033_988_75).fract();
        most * (2.0 * drawn - 1.0)
    };
    let mut taken = 0;
    for _ in 0..RUNS {
        let [a, b, u, v] = [draw(3.0), draw(3.0), draw(3.0), draw(3.0)];
        for scheme in ["HamiltonJacobi<Cayley, 4>", "HamiltonJacobi<Exponential, 6>"] {
            taken += warm_as_cold(&double, (scheme, 0.05), &double_pendulum(a, b, u, v));
        }
        for scheme in ["HamiltonJacobi<Exponential, 4>", "HamiltonJacobi<Cayley, 4>"] {
            taken += warm_as_cold(&spherical, (scheme, 0.05), &[a, u, 0.3 * b, 0.3 * v]);
        }
    }
    assert!(taken > RUNS * STEPS, "{taken} steps were taken");
}

/// Turns of a radian and more: what iterations do not solve from where they were led to is solved as if nothing were remembered. In each of these
/// runs an earlier version was refused a step that exists, or came to another solution.
#[test]
fn what_is_hard_to_solve_is_solved_as_from_rest() {
    let system = Model::from_text(DOUBLE_PENDULUM).unwrap().system(&[9.81]);
    let runs = [
        (
            "HamiltonJacobi<Cayley, 4>",
            [1.0494134451353148, -0.026591267591356882, 2.393420287834715, 5.656434836211247],
        ),
        (
            "HamiltonJacobi<Cayley, 4>",
            [-2.379989963123762, 0.858210698109076, 2.6885398944968983, -0.10931732159269814],
        ),
        (
            "HamiltonJacobi<Cayley, 4>",
            [-2.045945645662698, -2.0996047932100055, -3.195549795750935, 1.4532615013176837],
        ),
        (
            "HamiltonJacobi<Exponential, 6>",
            [0.8966640518133318, -2.3177364096084148, 5.850007105820964, -4.126507631499408],
        ),
    ];
    for (scheme, [a, b, u, v]) in runs {
        warm_as_cold(&system, (scheme, 0.1), &double_pendulum(a, b, u, v));
    }
}

/// A particle with the speed of light 1, on a spring.
const RELATIVISTIC: &str = "
    #[lie_poisson_system(
        group = R3,
        lagrangian = -(1.0 - velocity.norm_squared()).sqrt() - 0.5 * position.norm_squared(),
        methods(HamiltonJacobi(4)),
    )]
    struct Relativistic;";

/// Where the velocity is no closed form of the momentum, the search begins near it: from rest the equation led to a velocity near that of light, which
/// solves it too.
#[test]
fn steps_from_a_state_take_the_solution_near_its_velocity() {
    let system = Arc::new(Model::from_text(RELATIVISTIC).unwrap().system(&[]));
    let scheme = "HamiltonJacobi<Exponential, 4>".parse().unwrap();
    let start = [-1.05702, 0.37857, -0.45199, 0.94427, 0.19402, -0.24961];
    let energy = |state: &[f64]| {
        let squares = |part: &[f64]| part.iter().map(|x| x * x).sum::<f64>();
        (1.0 + squares(&state[3..])).sqrt() + 0.5 * squares(&state[..3])
    };
    for tick in 80..120 {
        let step = 1e-4 * f64::from(tick);
        let mut state = start;
        erased::Stepper::new(system.clone(), &scheme, step).unwrap().step(&mut state, &[]).unwrap();
        let off = energy(&state) / energy(&start) - 1.0;
        assert!(off.abs() < 1e-12, "{step}: {off:e}");
    }
    let (mut state, mut most) = (start, 0.0_f64);
    let mut stepper = erased::Stepper::new(system, &scheme, 0.01).unwrap();
    for _ in 0..10_000 {
        stepper.step(&mut state, &[]).unwrap();
        most = most.max((energy(&state) / energy(&start) - 1.0).abs());
    }
    assert!(most < 1e-9, "{most:e}");
}

/// A pendulum that is driven, and damped.
const DRIVEN: &str = "
    #[lie_poisson_system(
        group = SO2,
        potential = weight * (1.0 - angle.cos_angle()),
        force = torque * (frequency * t).cos() - damping * velocity.x,
        methods(HamiltonJacobi(6), HamiltonJacobi(8)),
        retractions(Cayley),
    )]
    struct Driven { #[inertia] inertia: f64, weight: f64, damping: f64, torque: f64, frequency: f64 }";

/// How fast Newton's iterations contract changes by more than a step of a long run can know: a few of an earlier version's left 15 units.
#[test]
fn warm_steps_are_solved_to_rounding() {
    let own = 9.81_f64.sqrt();
    let parameters = [1.0, 9.81, own / 2.0, 1.15 * 9.81, own * 2.0 / 3.0];
    let system = Model::from_text(DRIVEN).unwrap().system(&parameters);
    let start = vec![0.2_f64.cos(), 0.2_f64.sin(), 0.0];
    for scheme in ["HamiltonJacobi<Cayley, 6>", "HamiltonJacobi<Cayley, 8>"] {
        let scheme = scheme.parse().unwrap();
        let report =
            certify_erased(&system, &scheme, std::slice::from_ref(&start), &[Vec::new()], 0.0, None).unwrap();
        assert!(report.passed(), "{report}");
    }
}
