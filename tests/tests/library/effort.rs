//! What steps take: their iterations, and what becomes of hard ones. No number of the solver changes unseen.
//!
//! The numbers in `runtime/src/solve/constants.rs`, four times as large or as small, change lines of this table. Nothing in it asks the operating
//! system for a sine.

use coadjoint::error::StepError;
use coadjoint::nalgebra::{Complex, Quaternion};
use coadjoint::prelude::*;
use coadjoint::{Discretized, Stepper, System};
use coadjoint_app::Example;
use coadjoint_systems::navigation::Navigation;

use crate::systems::{Body, BodyState, Links, LinksState, Sensors, SensorsControl, SensorsState};

#[lie_poisson_system(group = SO3, advected(gamma: R3), potential = weight * gamma.dot(&chi))]
#[derive(Clone, Debug, PartialEq)]
struct Top {
    #[inertia]
    inertia: Vector3<f64>,
    weight: f64,
    chi: Vector3<f64>,
}

#[lie_poisson_system(
    group(attitude: SO3, position: R3),
    control(moment: R3, thrust: f64),
    potential = mass * gravity * position.z,
    force(attitude = moment, position = attitude * (thrust * Vector3::z())),
    retractions(Cayley),
)]
#[derive(Clone, Debug, PartialEq)]
struct Craft {
    #[inertia(attitude)]
    inertia: Vector3<f64>,
    #[inertia(position)]
    mass: f64,
    gravity: f64,
}

/// Numbers from −1 to 1, the same ones each time.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn attitude(&mut self) -> UnitQuaternion<f64> {
        let imaginary = self.vector();
        UnitQuaternion::from_quaternion(Quaternion::from_parts(self.next(), imaginary))
    }

    fn angle(&mut self) -> UnitComplex<f64> {
        UnitComplex::from_complex(Complex::new(self.next(), self.next()))
    }

    fn vector(&mut self) -> Vector3<f64> {
        Vector3::from_fn(|_, _| self.next())
    }
}

/// Steps one after the other: their iterations.
fn run<S, M>(
    name: &str,
    mut stepper: Stepper<S, M>,
    mut state: S::State,
    steps: u32,
    mut control: impl FnMut(u32) -> S::Control,
) -> String
where
    S: System<Scalar = f64> + Discretized<M> + 'static,
    M: 'static,
{
    let (mut all, mut most, mut ones) = (0_u64, 0, 0_u32);
    let mut ended = String::new();
    for step in 0..steps {
        match stepper.step_with(&mut state, &control(step)) {
            Ok(report) => {
                all += u64::from(report.iterations);
                most = most.max(report.iterations);
                ones += u32::from(report.iterations == 1);
            }
            Err(error) => {
                ended = format!(", step {step}: {error:?}");
                break;
            }
        }
    }
    format!("{name}: {all} iterations, {most} at most, {ones} times one{ended}")
}

/// Steps from states that have nothing to do with each other: what becomes of them.
fn cold<S, M>(
    name: &str,
    mut stepper: Stepper<S, M>,
    mut states: impl FnMut() -> S::State,
    count: u32,
) -> String
where
    S: System<Scalar = f64> + Discretized<M> + 'static,
    S::Control: Default,
    M: 'static,
{
    let mut outcomes = [0_u32; 7];
    let mut all = 0_u64;
    for _ in 0..count {
        stepper.reset();
        let place = match stepper.step_with(&mut states(), &S::Control::default()) {
            Ok(report) => {
                all += u64::from(report.iterations);
                0
            }
            Err(StepError::NoConvergence { .. }) => 1,
            Err(StepError::NoSolution { .. }) => 2,
            Err(StepError::SeveralSolutions) => 3,
            Err(StepError::SingularJacobian) => 4,
            Err(StepError::OutsideDomain) => 5,
            Err(_) => 6,
        };
        outcomes[place] += 1;
    }
    format!("{name}: {outcomes:?}, {all} iterations")
}

fn table() -> Vec<String> {
    let mut table = Vec::new();
    let body = Body { inertia: vector![1.0, 10.0, 100.0] };
    let spinning = BodyState { attitude: UnitQuaternion::identity(), momentum: vector![1.0, 1.0, 1.0] };
    for step in [0.003, 0.01, 0.02, 0.03, 0.05, 0.1, 0.2, 0.3, 0.5, 1.0] {
        let stepper = body.stepper::<Cayley>(step).expect("a body");
        table.push(run(&format!("body, h = {step}"), stepper, spinning, 3000, |_| NoControl::default()));
    }
    for step in [0.01, 0.1, 0.3, 1.0] {
        let stepper = body.stepper::<HamiltonJacobi<Exponential, 8>>(step).expect("a body");
        let name = format!("body at order 8, h = {step}");
        table.push(run(&name, stepper, spinning, 3000, |_| NoControl::default()));
    }
    let top = Top { inertia: vector![1.0, 2.0, 3.0], weight: 2.0, chi: vector![0.3, 0.2, 1.0] };
    let start = TopState {
        attitude: UnitQuaternion::identity(),
        momentum: vector![1.0, 2.0, 3.0],
        gamma: Vector3::z(),
    };
    for step in [0.01, 0.1, 0.3, 0.6] {
        let stepper = top.stepper::<Cayley>(step).expect("a top");
        table.push(run(&format!("top, h = {step}"), stepper, start, 1000, |_| NoControl::default()));
    }
    let craft = Craft { inertia: vector![0.03, 0.03, 0.04], mass: 1.0, gravity: 9.81 };
    let hover = CraftState {
        attitude: UnitQuaternion::identity(),
        attitude_momentum: vector![0.01, 0.02, 0.03],
        position: Vector3::zeros(),
        position_momentum: Vector3::zeros(),
    };
    for size in [0.0, 1e-12, 1e-11, 1e-10, 1e-9, 1e-6, 1e-3, 0.1, 10.0] {
        let mut numbers = Numbers(1);
        let stepper = craft.stepper::<Cayley>(0.01).expect("a craft");
        // jumps for a while, and then no more
        table.push(run(&format!("craft, jumps of {size}"), stepper, hover, 1000, |step| CraftControl {
            moment: if step < 500 { 0.01 * size * numbers.vector() } else { Vector3::zeros() },
            thrust: 9.81,
        }));
    }
    let links = Links { gravity: 9.81 };
    let hanging = LinksState {
        first: UnitComplex::from_complex(Complex::new(0.36, 0.93)),
        first_momentum: vector![0.0],
        second: UnitComplex::from_complex(Complex::new(0.92, 0.39)),
        second_momentum: vector![0.3],
    };
    for step in [0.001, 0.01, 0.05, 0.1, 0.2] {
        let stepper = links.stepper::<Cayley>(step).expect("links");
        table.push(run(&format!("links, h = {step}"), stepper, hanging, 1000, |_| NoControl::default()));
    }
    let sensors = Sensors { gravity: vector![0.0, 0.0, -9.81] };
    let mut element = SMatrix::<f64, 5, 5>::identity();
    element[(0, 3)] = 20.0;
    let momentum = SVector::<f64, 9>::from_fn(|k, _| 0.03 * k as f64 - 0.1);
    let stepper = sensors.stepper::<Cayley>(0.01).expect("sensors");
    let felt = SensorsControl { gyroscope: vector![0.0, 0.0, 0.1], accelerometer: vector![0.0, 2.0, 9.81] };
    table.push(run("sensors", stepper, SensorsState { element, momentum }, 3000, |_| felt));

    // a long step, of slow motion and of faster one
    for step in [0.01, 0.5] {
        let (navigation, start) = Navigation::example();
        let stepper = navigation.stepper::<Cayley>(step).expect("navigation");
        table.push(run(&format!("navigation, h = {step}"), stepper, start, 1000, |_| Navigation::bend()));
    }

    for (name, inertia) in [
        ("thick", vector![1.0, 2.0, 2.5]),
        ("flat", vector![1.0, 10.0, 10.9]),
        ("thin", vector![1.0, 1.0, 1e-4]),
    ] {
        for step in [0.3, 1.0, 3.0] {
            let top = Top { inertia, weight: 2.0, chi: vector![0.3, 0.2, 1.0] };
            let mut numbers = Numbers(2);
            let mut states = move || {
                let attitude = numbers.attitude();
                let mut momentum = 2.0 * numbers.vector();
                momentum.z *= if inertia.z < 1e-2 { 1e-3 } else { 1.0 };
                TopState { attitude, momentum, gamma: attitude.inverse() * Vector3::z() }
            };
            let stepper = top.stepper::<Cayley>(step).expect("a top");
            table.push(cold(&format!("{name} tops by Cayley, h = {step}"), stepper, &mut states, 1000));
            let stepper = top.stepper::<Exponential>(step).expect("a top");
            table.push(cold(&format!("{name} tops by exponential, h = {step}"), stepper, &mut states, 1000));
        }
    }
    let mut numbers = Numbers(3);
    let mut states = move || LinksState {
        first: numbers.angle(),
        first_momentum: vector![4.0 * numbers.next()],
        second: numbers.angle(),
        second_momentum: vector![4.0 * numbers.next()],
    };
    for step in [0.1, 0.3, 0.6] {
        let stepper = links.stepper::<Cayley>(step).expect("links");
        table.push(cold(&format!("links, h = {step}"), stepper, &mut states, 1000));
    }
    table
}

#[test]
#[cfg_attr(target_feature = "fma", ignore = "products and sums are rounded otherwise")]
fn no_number_of_the_solver_changes_unseen() {
    let mut settings = insta::Settings::clone_current();
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.bind(|| insta::assert_snapshot!("effort", table().join("\n")));
}
