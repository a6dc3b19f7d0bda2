//! Takes steps, so that their instructions can be counted: `steps <case> <number>`.
//!
//! That this links proves that no step on the Cayley map can panic: `#[no_panic]` refers to a function that does not exist wherever one could, and the
//! optimizer has removed all such references. Without optimization nothing is proved; the workspace compiles this package with it. Nor is there anything proved
//! under Clippy, which leaves out optimizations of rustc's own: `cargo test -p coadjoint-instructions` proves. Steps on
//! the exponential are only counted: that the Stumpff functions far from zero cannot panic the optimizer finds out too late to say so.

use std::hint::black_box;
use std::process::ExitCode;

use coadjoint::StepReport;
use coadjoint::prelude::*;
#[cfg(not(any(debug_assertions, clippy)))]
use no_panic::no_panic;

macro_rules! cases {
    ($($(#[$proof:meta])* $name:literal: $step:ident, $system:ty, $state:ty, $control:ty, $scheme:ty, $example:expr;)*) => {
        $(
            $(#[cfg_attr(not(any(debug_assertions, clippy)), $proof)])*
            #[inline(never)]
            fn $step(
                stepper: &mut Stepper<$system, $scheme>,
                state: &mut $state,
                control: &$control,
            ) -> Result<StepReport, StepError> {
                stepper.step_with(state, control)
            }
        )*

        /// The names of all cases.
        const NAMES: &[&str] = &[$($name),*];

        fn walk(name: &str, steps: u64) -> Result<(), Box<dyn std::error::Error>> {
            match name {
                $($name => {
                    let (system, mut state, control) = $example;
                    let mut stepper = system.stepper::<$scheme>(0.01)?;
                    for _ in 0..steps {
                        $step(&mut stepper, black_box(&mut state), &control)?;
                    }
                    black_box(&state);
                    Ok(())
                })*
                _ => Err(format!("no case `{name}`; there are {NAMES:?}").into()),
            }
        }
    };
}
cases! {
    #[no_panic]
    "free body, Cayley": free_cayley, FreeBody, FreeBodyState, NoControl<f64>, Cayley, free();
    "free body, exponential": free_exponential, FreeBody, FreeBodyState, NoControl<f64>, Exponential, free();
    #[no_panic]
    "free body, full inertia, Cayley": full_cayley, FullBody, FullBodyState, NoControl<f64>, Cayley, full();
    #[no_panic]
    "heavy top, Cayley": top_cayley, Top, TopState, NoControl<f64>, Cayley, top();
    "heavy top, exponential": top_exponential, Top, TopState, NoControl<f64>, Exponential, top();
    #[no_panic]
    "heavy top, Cayley, order 4": top_order4, Top, TopState, NoControl<f64>, Order4<Cayley>, top();
    #[no_panic]
    "quadrotor, Cayley": quadrotor_cayley, Quadrotor, QuadrotorState, QuadrotorControl, Cayley, quadrotor();
    #[no_panic]
    "coupled bodies, Cayley": coupled_cayley, Coupled, CoupledState, NoControl<f64>, Cayley, coupled();
    "coupled bodies, exponential": coupled_exponential, Coupled, CoupledState, NoControl<f64>, Exponential, coupled();
}

// The systems are described here again, and not taken from the catalogue, so that all of their code is compiled here, with optimization.

/// Nothing acts on it.
#[lie_poisson_system(group = SO3)]
struct FreeBody {
    #[inertia]
    inertia: Vector3<f64>,
}

/// Nothing acts on it, and its frame is not that of its principal axes.
#[lie_poisson_system(group = SO3)]
struct FullBody {
    #[inertia]
    inertia: Matrix3<f64>,
}

/// The vertical is advected.
#[lie_poisson_system(group = SO3, advected(gamma: R3), potential = weight * gamma.dot(&chi))]
struct Top {
    #[inertia]
    inertia: Vector3<f64>,
    weight: f64,
    chi: Vector3<f64>,
}

/// Controlled, on a product of groups.
#[lie_poisson_system(
    group(attitude: SO3, position: R3),
    control(moment: R3, thrust: f64),
    potential = mass * gravity * position.z,
    force(attitude = moment, position = attitude * (thrust * Vector3::z())),
)]
struct Quadrotor {
    #[inertia(attitude)]
    inertia: Vector3<f64>,
    #[inertia(position)]
    mass: f64,
    gravity: f64,
}

/// A potential on the group.
#[lie_poisson_system(
    group(first: SO3, second: SO3),
    potential = {
        let between = first.inverse() * second;
        2.0 * stiffness * (1.0 - between.w.powi(2))
    },
)]
struct Coupled {
    #[inertia(first)]
    first_inertia: Vector3<f64>,
    #[inertia(second)]
    second_inertia: Vector3<f64>,
    stiffness: f64,
}

fn free() -> (FreeBody, FreeBodyState, NoControl<f64>) {
    let state = FreeBodyState { attitude: UnitQuaternion::identity(), momentum: vector![1.0, 1.0, 1.0] };
    (FreeBody { inertia: vector![1.0, 10.0, 100.0] }, state, NoControl::default())
}

/// The body of [`free`] in axes that are turned by 0.5 about `(1, 2, 2)`.
fn full() -> (FullBody, FullBodyState, NoControl<f64>) {
    let (body, state, control) = free();
    let turned = UnitQuaternion::from_scaled_axis(vector![1.0, 2.0, 2.0] / 6.0);
    let rotation = turned.to_rotation_matrix();
    let inertia = rotation * Matrix3::from_diagonal(&body.inertia) * rotation.transpose();
    let state = FullBodyState { attitude: state.attitude, momentum: turned * state.momentum };
    (FullBody { inertia }, state, control)
}

fn top() -> (Top, TopState, NoControl<f64>) {
    let state = TopState {
        attitude: UnitQuaternion::identity(),
        momentum: vector![1.0, 1.0, 1.0],
        gamma: Vector3::z(),
    };
    let top = Top { inertia: vector![1.0, 10.0, 100.0], weight: 1.0, chi: vector![0.3, 0.2, 1.0] };
    (top, state, NoControl::default())
}

fn quadrotor() -> (Quadrotor, QuadrotorState, QuadrotorControl) {
    let state = QuadrotorState {
        attitude: UnitQuaternion::identity(),
        attitude_momentum: vector![0.01, 0.02, 0.03],
        position: Vector3::zeros(),
        position_momentum: Vector3::zeros(),
    };
    let quadrotor = Quadrotor { inertia: vector![0.03, 0.03, 0.04], mass: 1.0, gravity: 9.81 };
    (quadrotor, state, QuadrotorControl { moment: Vector3::zeros(), thrust: 9.81 })
}

fn coupled() -> (Coupled, CoupledState, NoControl<f64>) {
    let state = CoupledState {
        first: UnitQuaternion::identity(),
        first_momentum: vector![0.3, 1.0, -0.5],
        second: UnitQuaternion::identity(),
        second_momentum: vector![-0.4, 0.2, 1.0],
    };
    let coupled = Coupled {
        first_inertia: vector![1.0, 2.0, 2.5],
        second_inertia: vector![2.0, 1.5, 1.0],
        stiffness: 1.0,
    };
    (coupled, state, NoControl::default())
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().collect();
    let done = match &arguments[..] {
        [_, name, steps] => match steps.parse() {
            Ok(steps) => walk(name, steps),
            Err(_) => Err(format!("`{steps}` is not a number of steps").into()),
        },
        _ => Err("usage: steps <case> <number>".into()),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
