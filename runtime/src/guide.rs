//! A guide, one page for each notion. Every example is compiled and run by the tests.
//!
//! 1. [Describing a system](describing)
//! 2. [Choosing retraction and method](choosing)
//! 3. [Forces and controls](forces)
//! 4. [Reading the generated code](reading)

pub mod describing {
    //! # Describing a system
    //!
    //! A description says *what* the system is: where it moves, what its energy is, what acts on it.
    //!
    //! **The group** is where the configuration lives: `R1` … `R6` (also `R(3)`), the circle `SO2`, rotations `SO3`, rigid motions
    //! `SE2` and `SE3`, unit quaternions `SU2`. A single group gives the state the fields `attitude` (or `position`, `angle`, `pose`,
    //! `spin`) and `momentum`; factors have names of their own, and momenta after them.
    //!
    //! ```
    //! use coadjoint::prelude::*;
    //!
    //! /// Two bodies whose axes attract each other.
    //! #[lie_poisson_system(
    //!     group(first: SO3, second: SO3),
    //!     potential = -stiffness * (first * axis).dot(&(second * axis)),
    //! )]
    //! struct Pair {
    //!     #[inertia(first)]
    //!     first_inertia: Vector3<f64>,
    //!     #[inertia(second)]
    //!     second_inertia: Matrix3<f64>,
    //!     stiffness: f64,
    //!     axis: Vector3<f64>,
    //! }
    //!
    //! let state = PairState {
    //!     first: UnitQuaternion::identity(),
    //!     first_momentum: vector![0.1, 0.2, 0.3],
    //!     second: UnitQuaternion::from_euler_angles(0.1, 0.2, 0.3),
    //!     second_momentum: Vector3::zeros(),
    //! };
    //! # let _ = state;
    //! ```
    //!
    //! **The inertia** is one field, or one for each factor (`#[inertia(first)]`), or one matrix for several
    //! (`#[inertia(first, second)]`): a number, the principal moments, or a symmetric positive definite matrix.
    //!
    //! **The potential** is an expression or block in the fields, the configuration (`attitude * v`, `attitude.inverse() * v`,
    //! `position.x`, `angle.cos_angle()`, `pose.translation.vector`) and the time `t`. It is ordinary Rust, and also emitted as a method,
    //! so that rustc checks its types at your own tokens.
    //!
    //! **Advected parameters** are vectors fixed in space and seen from the body, as the vertical of a heavy top. Where an energy
    //! depends on the configuration only through such vectors, declare them rather than reading the attitude: the system is then
    //! left-invariant, its step of order 2 costs half, and the Casimirs are kept.
    //!
    //! ```
    //! use coadjoint::prelude::*;
    //!
    //! #[lie_poisson_system(group = SO3, advected(gamma: R3), potential = weight * gamma.dot(&chi))]
    //! struct Top {
    //!     #[inertia]
    //!     inertia: Vector3<f64>,
    //!     weight: f64,
    //!     chi: Vector3<f64>,
    //! }
    //!
    //! let attitude = UnitQuaternion::from_euler_angles(0.3, 0.0, 0.0);
    //! let state = TopState { attitude, momentum: vector![0.0, 0.0, 5.0], gamma: attitude.inverse() * Vector3::z() };
    //! let top = Top { inertia: vector![1.0, 1.0, 0.5], weight: 1.0, chi: Vector3::z() };
    //! assert_eq!(Top::CASIMIRS, ["|gamma|²", "momentum·gamma"]);
    //! assert!((top.casimirs(&state)[0] - 1.0).abs() < 1e-15);
    //! ```
    //!
    //! **Any other Hamiltonian** is written out, in the momentum too, and takes the place of inertia and potential:
    //!
    //! ```
    //! use coadjoint::prelude::*;
    //!
    //! /// A body with a rotor that spins at a constant rate.
    //! #[lie_poisson_system(
    //!     group = SO3,
    //!     hamiltonian = {
    //!         let body = momentum - rotor;
    //!         body.dot(&body.component_div(&inertia)) / 2.0
    //!     },
    //! )]
    //! struct Gyrostat {
    //!     inertia: Vector3<f64>,
    //!     /// Angular momentum of the rotor, in the body.
    //!     rotor: Vector3<f64>,
    //! }
    //!
    //! let gyrostat = Gyrostat { inertia: vector![1.0, 2.0, 2.5], rotor: vector![0.0, 0.0, 0.4] };
    //! let mut state = GyrostatState { attitude: UnitQuaternion::identity(), momentum: vector![0.5, 0.1, 0.9] };
    //! let energy = gyrostat.energy(&state);
    //! let mut stepper = gyrostat.stepper::<Exponential>(0.05)?;
    //! for _ in 0..1_000 {
    //!     stepper.step(&mut state)?;
    //! }
    //! assert!((gyrostat.energy(&state) - energy).abs() < 1e-3);
    //! # Ok::<(), Box<dyn std::error::Error>>(())
    //! ```
    //!
    //! `invariance = right` takes momentum and velocity in space, `g' = ξ g`, for energies that are functions of these.
}

pub mod choosing {
    //! # Choosing retraction and method
    //!
    //! A bare retraction is the step to take unless another is wanted for itself: `stepper::<Exponential>(h)` or
    //! `stepper::<Cayley>(h)`, symmetric and of order 2 for every system. [`Exponential`](crate::Exponential) is far more accurate at
    //! equal step; [`Cayley`](crate::Cayley) is rational and has no limit on the angle turned in a step.
    //!
    //! | scheme | order | symmetric | Poisson map | remarks |
    //! |---|---|---|---|---|
    //! | `Exponential`, `Cayley` | 2 | yes | yes, without forces | `SymplecticEulerA` or `StormerVerlet`, whichever is of order 2 |
    //! | [`SymplecticEulerA`](crate::SymplecticEulerA), [`B`](crate::SymplecticEulerB) | 1; 2 for left-invariant systems | then | yes, without forces | often explicit |
    //! | [`Midpoint`](crate::Midpoint) | 2 | yes | yes, without forces | implicit; `methods(Midpoint)` |
    //! | [`Family<R, N, D>`](crate::Family) | as `SymplecticEulerA` | as `SymplecticEulerA` | yes, without forces | `methods(Family(1, 4))` |
    //! | [`StormerVerlet`](crate::StormerVerlet) | 2 | yes | yes, without forces | half a step of A, then half a step of B |
    //! | [`Order4`](crate::composition::Order4) … `Order10` | 4 to 10 | yes | as its base | 5, 9, 17, 35 steps of a symmetric base |
    //! | [`RightLift`](crate::RightLift) | as its base | as its base | as its base | carries the momentum in space, where nothing acts |
    //! | [`TangentLift`](crate::TangentLift) | 1 | no | **no** | explicit, to compare with; `methods(TangentLift)` |
    //!
    //! ```
    //! use coadjoint::certify;
    //! use coadjoint::prelude::*;
    //!
    //! #[lie_poisson_system(group = SO2, potential = -weight * angle.cos_angle(), methods(Midpoint))]
    //! struct Pendulum {
    //!     #[inertia]
    //!     inertia: f64,
    //!     weight: f64,
    //! }
    //!
    //! let pendulum = Pendulum { inertia: 1.0, weight: 9.81 };
    //! let start = PendulumState { angle: UnitComplex::new(1.0), momentum: vector![0.2] };
    //! let mut state = start;
    //! let mut stepper = pendulum.stepper::<Order6<Midpoint<Cayley>>>(0.05)?;
    //! for _ in 0..100 {
    //!     stepper.step(&mut state)?;
    //! }
    //! assert!((pendulum.energy(&state) - pendulum.energy(&start)).abs() < 1e-4);
    //!
    //! // whether a step is what it claims to be can be measured
    //! let report = certify::<Midpoint<Cayley>, _>(&pendulum, &[start])?;
    //! assert!(report.passed(), "{report}");
    //! # Ok::<(), Box<dyn std::error::Error>>(())
    //! ```
    //!
    //! Structure pays over long times, at large steps, where Casimirs must hold exactly, and in the statistics of many states. For one
    //! short trajectory to many digits, a good adaptive method that knows nothing of structure is faster.
}

pub mod forces {
    //! # Forces and controls
    //!
    //! A force is what changes the momentum beside the energy: an expression in all that a potential may use, the momentum, the
    //! velocity and the controls, in the body (in space where `invariance = right`). Controls are given with every step and held over it.
    //!
    //! ```
    //! use coadjoint::prelude::*;
    //!
    //! /// A quadrotor: moment in the body, thrust along its third axis, drag against its velocity.
    //! #[lie_poisson_system(
    //!     group(attitude: SO3, position: R3),
    //!     control(moment: R3, thrust: f64),
    //!     potential = mass * gravity * position.z,
    //!     force(
    //!         attitude = moment,
    //!         position = thrust * (attitude * Vector3::z()) - drag * position_velocity,
    //!     ),
    //! )]
    //! struct Quadrotor {
    //!     #[inertia(attitude)]
    //!     inertia: Vector3<f64>,
    //!     #[inertia(position)]
    //!     mass: f64,
    //!     gravity: f64,
    //!     drag: f64,
    //! }
    //!
    //! let quadrotor = Quadrotor { inertia: vector![0.02, 0.02, 0.04], mass: 1.3, gravity: 9.81, drag: 0.2 };
    //! let mut state = QuadrotorState {
    //!     attitude: UnitQuaternion::identity(),
    //!     attitude_momentum: Vector3::zeros(),
    //!     position: vector![0.0, 0.0, 1.0],
    //!     position_momentum: Vector3::zeros(),
    //! };
    //! let weight = quadrotor.mass * quadrotor.gravity;
    //! let mut stepper = quadrotor.stepper::<Exponential>(0.01)?;
    //!
    //! // a step at a time: hover stays where it is
    //! let hover = QuadrotorControl { thrust: weight, ..Default::default() };
    //! stepper.step_with(&mut state, &hover)?;
    //! assert_eq!(state.position.z, 1.0);
    //!
    //! // or a run with a law: rise to 2 m
    //! Run::new(&mut stepper, &mut state)
    //!     .controlled_by(|state: &QuadrotorState, _time| QuadrotorControl {
    //!         moment: -0.2 * state.attitude_momentum,
    //!         thrust: weight + 2.0 * (2.0 - state.position.z) - 2.0 * state.position_momentum.z,
    //!     })
    //!     .steps(2_000)?;
    //! assert!((state.position.z - 2.0).abs() < 1e-3);
    //! # Ok::<(), Box<dyn std::error::Error>>(())
    //! ```
    //!
    //! `step` without a control means all zeros. The stepper knows the time ([`Stepper::time`](crate::Stepper::time)), for
    //! descriptions that name `t`; a run starts at 0 unless it says [`starting_at`](crate::Run::starting_at).
    //!
    //! With forces no step is symplectic, as the motion is not; the order is that of the scheme, and advected parameters keep their
    //! Casimirs.
}

pub mod reading {
    //! # Reading the generated code
    //!
    //! `cargo run --release -- show heavy_top` prints what the macro makes of a system of the catalogue; for your own,
    //! `cargo expand`. There is, in this order:
    //!
    //! * your struct, with the equations of motion, the invariants and the number of operations of each step in its documentation;
    //! * the state, and the controls if there are any;
    //! * your expressions as methods (`potential`, `hamiltonian`, `force`), for rustc to check;
    //! * [`System`](crate::System): parameters, energy, velocity, Casimirs, and the checks of an inertia;
    //! * [`Geometry`](crate::geometry::Geometry): local coordinates, differential and Poisson structure;
    //! * a [`Kernel`](crate::kernel::Kernel) for each scheme and retraction.
    //!
    //! A kernel has one function for each stage, and every value is computed in the earliest one that can:
    //!
    //! | function | when | what |
    //! |---|---|---|
    //! | `new` | once | what depends on parameters and step |
    //! | `begin` | once a step | what depends on state, time and controls |
    //! | `start` | once a step | a first approximation of the unknown |
    //! | `evaluate` | once an iteration | `left(x) − right(x)` |
    //! | `correction` | once an iteration | Newton's, with the closed-form Jacobian |
    //! | `domain`, `finish` | once a step | the retraction's margin; the next state |
    //!
    //! Names follow the mathematics: `eta` is the step times the velocity, `momentum_mean` the mean momentum `μ̄`, `turn` the retraction
    //! of `eta`, `kick` what potential and forces add to the momentum, `gamma_mean` and `gamma_next` an advected parameter at the
    //! intermediate point and after the step. `Stumpff` functions `c0, c1, …` take the place of sines and cosines.
    //!
    //! Where the equation is explicit or linear, there is no unknown (`[T; 0]`), and `evaluate` and `correction` are empty.
}
