//! A guide, one page for each notion. Every example is compiled and run by the tests.
//!
//! 1. [From nothing to a system of one's own](beginning), in ten minutes
//! 2. [Describing a system](describing), and [all that may be written there](language)
//! 3. [Choosing retraction and method](choosing)
//! 4. [Forces and controls](forces)
//! 5. [Running](running): to a time, on from there, with observers, from a snapshot
//! 6. [Many at once](ensembles)
//! 7. [Derivatives](derivatives): control, estimation, identification
//! 8. [Chosen while the program runs](erased): any system, any scheme, in lists of numbers
//! 9. [Reading the generated code](reading)
//! 10. [The mathematics](mathematics)
//! 11. [The paper's equations](paper): where each of its methods is, its misprints, and recipes
//!
//! The figures, and what each shows, are in the documentation of the crate `coadjoint-systems`: `coadjoint_systems::figures`.

pub mod beginning {
    //! # From nothing to a system of one's own
    //!
    //! **1. See it run.** In a clone of the repository:
    //!
    //! ```sh
    //! cargo run --release -- paper                         # the paper's heavy top: a table, trajectories and a figure under out/
    //! cargo run --release -- list                          # the systems that are there
    //! cargo run --release -- view lagrange_top             # a page for the browser that plays a motion
    //! cargo run --release -- figures                       # all figures of the paper, and five more
    //! ```
    //!
    //! **2. Make a crate**, with this in its `Cargo.toml`:
    //!
    //! ```toml
    //! [dependencies]
    //! coadjoint = { path = "../coadjoint/runtime" }
    //! ```
    //!
    //! Nothing else is needed. Two features are there when asked for, `features = ["parallel", "serde"]`: `parallel` moves
    //! [ensembles](super::ensembles) on all cores, `serde` [writes and reads](super::describing#written-and-read) states.
    //!
    //! **3. Say what the system is.** A wheel on the end of a rod that hangs from a ball joint, say. It turns about a fixed point, so the
    //! group is `SO3`; its weight acts along the vertical, which is fixed in space and seen from the body: an advected parameter.
    //!
    //! ```
    //! use coadjoint::prelude::*;
    //! use coadjoint::{Invariants, Record, Run};
    //!
    //! /// A wheel on the end of a rod that hangs from a ball joint.
    //! #[lie_poisson_system(group = SO3, advected(up: R3), potential = weight * length * up.z)]
    //! struct Wheel {
    //!     /// Principal moments of inertia about the joint, kg m².
    //!     #[inertia]
    //!     inertia: Vector3<f64>,
    //!     /// N.
    //!     weight: f64,
    //!     /// From the joint to the hub, m.
    //!     length: f64,
    //! }
    //!
    //! fn main() -> Result<(), Box<dyn std::error::Error>> {
    //!     let wheel = Wheel { inertia: vector![0.05, 0.05, 0.01], weight: 10.0, length: 0.15 };
    //!     // leaning by 60°, spinning 20 times a second
    //!     let attitude = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), 60_f64.to_radians());
    //!     let mut state = WheelState {
    //!         attitude,
    //!         momentum: vector![0.0, 0.0, 0.01 * 125.0],
    //!         up: attitude.inverse() * Vector3::z(),
    //!     };
    //!     let start = state;
    //!
    //!     let mut stepper = wheel.stepper::<Exponential>(1e-3)?;
    //!     let mut invariants = Invariants::new();
    //!     let mut record = Record::every(10);
    //!     Run::new(&mut stepper, &mut state)
    //!         .observe(&mut invariants)
    //!         .observe(&mut record)
    //!         .steps(10_000)?;
    //!
    //!     // ten seconds later it has not fallen over
    //!     assert!(state.up.z > 0.3);
    //!     assert!((wheel.energy(&state) - wheel.energy(&start)).abs() < 1e-3);
    //!     println!("energy within {:.1e} J", invariants.energy_error());
    //!     println!("Casimirs within {:?}", invariants.casimir_drifts());
    //!     assert_eq!(record.states().len(), 1001);
    //!     Ok(())
    //! }
    //! ```
    //!
    //! The names `WheelState`, `potential`, `energy` and so on come from the macro; `cargo doc --open` shows them with their
    //! documentation, and what a step costs. A mistake in the description is an error at your own words.
    //!
    //! **4. Have it certified.** One line in a test measures what the steps claim: order, Poisson map, Casimirs, reversibility,
    //! and that a stepper that is kept takes the steps of a new one.
    //!
    //! ```
    //! # use coadjoint::prelude::*;
    //! # #[lie_poisson_system(group = SO3, advected(up: R3), potential = weight * length * up.z)]
    //! # struct Wheel { #[inertia] inertia: Vector3<f64>, weight: f64, length: f64 }
    //! # fn main() -> Result<(), Box<dyn std::error::Error>> {
    //! # let wheel = Wheel { inertia: vector![0.05, 0.05, 0.01], weight: 10.0, length: 0.15 };
    //! # let state = WheelState { attitude: UnitQuaternion::identity(), momentum: vector![0.3, -0.2, 1.1], up: vector![0.6, 0.0, 0.8] };
    //! let report = coadjoint::certify::certify::<Exponential, _>(&wheel, &[state])?;
    //! assert!(report.passed(), "{report}");
    //! # Ok(())
    //! # }
    //! ```
    //!
    //! **5. Go on** with [describing](super::describing), [choosing](super::choosing) and [forces](super::forces).
}

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
    //! **The inertia** is one field, or one for each factor (`#[inertia(first)]`), or one for several (`#[inertia(first, second)]`): a
    //! number, the principal moments, or a symmetric positive definite matrix. A field for several factors is their joint inertia, and as long as
    //! all of them together. If it is only as long as each, and they all move on the same group, it is the inertia of each: `Vector3` for two
    //! bodies alike.
    //!
    //! **The potential** is an expression or block in the fields, the configuration (`attitude * v`, `attitude.inverse() * v`,
    //! `position.x`, `angle.cos_angle()`, `pose.translation.vector`) and the time `t`. It is ordinary Rust, and also emitted as a method,
    //! so that rustc checks its types at your own tokens. [All that has a meaning](super::language) is listed; a field or control that is used
    //! nowhere is warned of, which `#[allow(deprecated)]` on it or on the struct silences.
    //!
    //! **Rigid motions.** The momentum of `SE3` and `SE2` is the angular part, then the linear one, in the body. Expressions have the parts by name,
    //! `angular_momentum` and `linear_momentum`, in forces also `angular_velocity` and `linear_velocity`; a force may be a pair. A point of the
    //! body is moved by `pose.transform_point`; a vector is only turned.
    //!
    //! ```
    //! use coadjoint::prelude::*;
    //!
    //! /// A buoy on an elastic rope, in water that resists.
    //! #[lie_poisson_system(
    //!     group = SE3,
    //!     potential = {
    //!         let rope = pose.transform_point(&Point3::from(eye)) - Point3::origin();
    //!         0.5 * stiffness * rope.norm_squared() - lift * pose.translation.z
    //!     },
    //!     force = (-drag * angular_momentum, -drag * linear_momentum),
    //! )]
    //! struct Buoy {
    //!     #[inertia]
    //!     inertia: Vector6<f64>,
    //!     /// Where the rope is tied, in the body.
    //!     eye: Vector3<f64>,
    //!     stiffness: f64,
    //!     lift: f64,
    //!     drag: f64,
    //! }
    //!
    //! let buoy = Buoy {
    //!     inertia: vector![0.1, 0.1, 0.2, 1.0, 1.0, 1.0],
    //!     eye: vector![0.0, 0.0, -0.5],
    //!     stiffness: 20.0,
    //!     lift: 10.0,
    //!     drag: 1.0,
    //! };
    //! let mut state = BuoyState { pose: Isometry3::rotation(0.3 * Vector3::x()), momentum: Vector6::zeros() };
    //! let mut stepper = buoy.stepper::<Exponential>(0.01)?;
    //! for _ in 0..5_000 {
    //!     stepper.step(&mut state)?;
    //! }
    //! // at rest above where the rope is held, upright
    //! let rest = vector![0.0, 0.0, 1.0];
    //! assert!((state.pose.translation.vector - rest).norm() < 1e-6 && state.pose.rotation.angle() < 1e-6);
    //! # Ok::<(), Box<dyn std::error::Error>>(())
    //! ```
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
    //! **Any other Hamiltonian** is written out, in the momentum too, and takes the place of inertia and potential. A field marked `#[inertia]` is
    //! then a parameter like any other, but checked to be positive, or a symmetric positive definite matrix, of whatever size:
    //!
    //! ```
    //! use coadjoint::prelude::*;
    //!
    //! /// A body with a rotor that spins at a constant rate.
    //! #[lie_poisson_system(
    //!     group = SO3,
    //!     hamiltonian = {
    //!         let body = momentum - rotor;
    //!         body.dot(&(inertia.try_inverse().unwrap() * body)) / 2.0
    //!     },
    //! )]
    //! struct Gyrostat {
    //!     #[inertia]
    //!     inertia: Matrix3<f64>,
    //!     /// Angular momentum of the rotor, in the body.
    //!     rotor: Vector3<f64>,
    //! }
    //!
    //! let gyrostat = Gyrostat { inertia: matrix![1.0, 0.1, 0.0; 0.1, 2.0, 0.2; 0.0, 0.2, 2.5], rotor: vector![0.0, 0.0, 0.4] };
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
    //! **A Lagrangian** of configuration, velocity, advected parameters and time takes their place too, as it stands in a textbook: a mass matrix
    //! may depend on the configuration, and nothing is inverted by hand. The state has the momentum `∂l/∂ξ`; begin with a velocity:
    //!
    //! ```
    //! use coadjoint::prelude::*;
    //!
    //! /// A satellite with a mass on a spring that slides along its first axis.
    //! #[lie_poisson_system(
    //!     group(attitude: SO3, slider: R1),
    //!     lagrangian = {
    //!         let at = slider.x * Vector3::x();
    //!         let velocity = attitude_velocity.cross(&at) + slider_velocity.x * Vector3::x();
    //!         let turning = attitude_velocity.dot(&attitude_velocity.component_mul(&inertia)) / 2.0;
    //!         turning + mass * velocity.norm_squared() / 2.0 - stiffness * slider.x.powi(2) / 2.0
    //!     },
    //! )]
    //! struct Satellite {
    //!     #[inertia]
    //!     inertia: Vector3<f64>,
    //!     mass: f64,
    //!     stiffness: f64,
    //! }
    //!
    //! let satellite = Satellite { inertia: vector![1.0, 2.0, 2.5], mass: 0.3, stiffness: 4.0 };
    //! let rest = SatelliteState {
    //!     attitude: UnitQuaternion::identity(),
    //!     attitude_momentum: Vector3::zeros(),
    //!     slider: vector![0.2],
    //!     slider_momentum: vector![0.0],
    //! };
    //! let velocity = vector![0.1, 0.4, -0.2, 0.0];
    //! let mut state = satellite.with_velocity(&rest, &velocity, 0.0)?;
    //! assert!((satellite.velocity(&state) - velocity).norm() < 1e-14);
    //! let energy = satellite.energy(&state);
    //! let mut stepper = satellite.stepper::<Exponential>(0.01)?;
    //! for _ in 0..1_000 {
    //!     stepper.step(&mut state)?;
    //! }
    //! assert!((satellite.energy(&state) - energy).abs() < 1e-4);
    //! # Ok::<(), Box<dyn std::error::Error>>(())
    //! ```
    //!
    //! Every component of the velocity needs a kinetic energy: where `∂²l/∂ξ²` is singular whatever the values, the description is an error; where it
    //! is at a state, [`velocity_of`](crate::System::velocity_of) and steps fail there.
    //!
    //! `invariance = right` takes momentum and velocity in space, `g' = ξ g`, for energies that are functions of these.
    //!
    //! # Written and read
    //!
    //! With the feature `serde` of `coadjoint`, states and controls have serde's `Serialize` and `Deserialize`. If the compiler says that
    //! a state, or a `Matrix` in your own struct, has them not, this feature is missing:
    //!
    //! ```toml
    //! [dependencies]
    //! coadjoint = { path = "../coadjoint/runtime", features = ["serde"] }
    //! serde = { version = "1", features = ["derive"] }
    //! serde_json = { version = "1", features = ["float_roundtrip"] } # reads numbers back to the last digit
    //! ```
    //!
    //! The description itself is your own struct: it derives what you want of it.
    //!
    //! ```
    //! # #[cfg(feature = "serde")] mod example {
    //! use coadjoint::prelude::*;
    //! use serde::{Deserialize, Serialize};
    //!
    //! #[lie_poisson_system(group = SO3)]
    //! #[derive(Serialize, Deserialize)]
    //! struct Body {
    //!     #[inertia]
    //!     inertia: Vector3<f64>,
    //! }
    //!
    //! # pub fn run() -> Result<(), Box<dyn std::error::Error>> {
    //! let body: Body = serde_json::from_str(r#"{ "inertia": [1.0, 2.0, 2.5] }"#)?;
    //! assert_eq!(body.inertia, vector![1.0, 2.0, 2.5]);
    //! let state = BodyState { attitude: UnitQuaternion::identity(), momentum: vector![0.1, 2.0, 0.1] };
    //! let text = serde_json::to_string(&state)?;
    //! assert_eq!(text, r#"{"attitude":[0.0,0.0,0.0,1.0],"momentum":[0.1,2.0,0.1]}"#);
    //! assert_eq!(serde_json::from_str::<BodyState>(&text)?, state);
    //! # Ok(())
    //! # }
    //! # }
    //! # #[cfg(feature = "serde")] example::run().unwrap();
    //! ```
    //!
    //! In a crate that does not depend on serde itself, its traits are `coadjoint::serde::{Deserialize, Serialize}`, and the struct says
    //! `#[serde(crate = "coadjoint::serde")]`.
}

pub mod language {
    //! All that may be written in a description. What it is for is in [describing](super::describing).
    //!
    #![doc = include_str!("guide/language.md")]
}

pub mod choosing {
    //! # Choosing retraction and method
    //!
    //! A bare retraction is the step to take unless another is wanted for itself: `stepper::<Exponential>(h)` or
    //! `stepper::<Cayley>(h)`, symmetric and of order 2 for every system. [`Exponential`](crate::Exponential) is far more accurate at
    //! equal step; [`Cayley`](crate::Cayley) is rational and has no limit on the angle turned in a step. [`SecondKind`](crate::SecondKind),
    //! turns about the axes one after the other, is there to compare with: asked for by `retractions(SecondKind)`.
    //!
    //! | scheme | order | symmetric | Poisson map | remarks |
    //! |---|---|---|---|---|
    //! | `Exponential`, `Cayley` | 2 | yes | yes, without forces | `SymplecticEulerA` or `StormerVerlet`, whichever is of order 2 |
    //! | `SecondKind` | 2 | yes | yes, without forces | `StormerVerlet` for every system |
    //! | [`SymplecticEulerA`](crate::SymplecticEulerA), [`B`](crate::SymplecticEulerB) | 1; 2 for left-invariant systems, but with `SecondKind` | then | yes, without forces | often explicit |
    //! | [`Midpoint`](crate::Midpoint) | 2 | yes | yes, without forces | implicit; `methods(Midpoint)` |
    //! | [`Family<R, N, D>`](crate::Family) | as `SymplecticEulerA` | as `SymplecticEulerA` | yes, without forces | `methods(Family(1, 4))` |
    //! | [`StormerVerlet`](crate::StormerVerlet) | 2 | yes | yes, without forces | half a step of A, then half a step of B |
    //! | [`Order4`](crate::composition::Order4) … `Order10` | 4 to 10 | yes | as its base | 5, 9, 17, 35 steps of a symmetric base |
    //! | [`RightLift`](crate::RightLift) | as its base | as its base | as its base | carries the momentum in space, where nothing acts; with `invariance = right` that in the body |
    //! | [`TangentLift`](crate::TangentLift) | 1 | no | **no** | explicit, to compare with; `methods(TangentLift)` |
    //! | [`TangentLift<R, N, D>`](crate::TangentLift) | 1; 2 for [`TangentMidpoint`](crate::TangentMidpoint), `s = ½` | then | **no** | implicit; `methods(TangentLift(1, 4), TangentMidpoint)` |
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
    //! With `Exponential` and `Cayley` the standard steps are generated. `retractions(Cayley)` leaves it at those named, which halves what the
    //! description costs to compile; a scheme on another one is then an error of the compiler. What else is wanted is named in `methods(…)`.
    //!
    //! ```
    //! use coadjoint::prelude::*;
    //!
    //! #[lie_poisson_system(group = SO3, retractions(Cayley), methods(Midpoint))]
    //! struct Body {
    //!     #[inertia]
    //!     inertia: Vector3<f64>,
    //! }
    //!
    //! let body = Body { inertia: vector![1.0, 2.0, 2.5] };
    //! assert!(body.stepper::<Cayley>(0.1).is_ok() && body.stepper::<Midpoint<Cayley>>(0.1).is_ok());
    //! ```
    //!
    //! # Fast
    //!
    //! * Steps taken together take less time than one by one, with the same result: [`steps_with`](crate::Stepper::steps_with), and with it a
    //!   [`Run`](crate::Run) between two ticks that an observer needs. `Record::every(100)` and `run.every(100, …)` see every hundredth;
    //!   an observer of your own says by [`next`](crate::Observer::next) which one it waits for, and a controller is asked before each.
    //! * [`Fused<M>`](crate::Fused) takes the steps of `M` with products and sums rounded once, by an instruction that is looked for when
    //!   the program runs: the same on every machine, and other last digits than those of `M`.
    //! * Many at once: [`ensembles`](super::ensembles).
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
    //! use coadjoint::Run;
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
    //! descriptions that name `t`; a run goes on at the stepper's time, at first 0, unless it says
    //! [`starting_at`](crate::Run::starting_at).
    //!
    //! With forces no step is symplectic, as the motion is not; the order is that of the scheme, and advected parameters keep their
    //! Casimirs.
}

pub mod running {
    //! # Running
    //!
    //! A stepper takes steps of one size and counts the time. A state is yours, and a step changes it in place:
    //!
    //! ```
    //! use coadjoint::Run;
    //! use coadjoint::prelude::*;
    //!
    //! #[lie_poisson_system(group = SO3)]
    //! #[derive(Clone)]
    //! struct Body {
    //!     #[inertia]
    //!     inertia: Vector3<f64>,
    //! }
    //!
    //! let body = Body { inertia: vector![1.0, 2.0, 2.5] };
    //! let start = BodyState { attitude: UnitQuaternion::identity(), momentum: vector![0.1, 2.0, 0.1] };
    //! let mut stepper = body.stepper::<Cayley>(0.1)?;
    //!
    //! // to a time: the last step is shortened; a run goes on where the last one ended
    //! let mut state = start;
    //! Run::new(&mut stepper, &mut state).to(2.25)?;
    //! Run::new(&mut stepper, &mut state).every(10, |tick| println!("{:5.2} s", tick.time)).to(10.0)?;
    //! assert_eq!(stepper.time(), 10.0);
    //! // in whole steps, until the time is reached or passed
    //! let report = Run::new(&mut stepper, &mut state).past(11.05)?;
    //! assert_eq!(report.steps, 11);
    //!
    //! // as an iterator
    //! stepper.reset();
    //! for sample in stepper.trajectory(start).take(3) {
    //!     let (time, state) = sample?;
    //!     println!("{time:4.1} s {:9.6}", state.momentum.y);
    //! }
    //!
    //! // written down, and gone on with to the last bit
    //! let (snapshot, mut saved) = (stepper.snapshot(), state);
    //! stepper.step(&mut state)?;
    //! let mut other = body.stepper::<Cayley>(0.1)?;
    //! other.restore(&snapshot)?;
    //! other.step(&mut saved)?;
    //! assert_eq!(saved, state);
    //! # Ok::<(), Box<dyn std::error::Error>>(())
    //! ```
    //!
    //! * [`set_step_size`](crate::Stepper::set_step_size) and [`set_system`](crate::Stepper::set_system) change the step and the parameters. Time and
    //!   count go on.
    //! * Any state may be handed in at any time. What the stepper remembers saves time and changes no result beyond rounding.
    //! * [`until`](crate::Run::until) ends a run on a condition. An [`Observer`](crate::Observer) of your own is tested with
    //!   [`Tick::new`](crate::Tick::new), without a run.
    //! * A step that fails leaves the state as it was. The [`RunError`](crate::RunError) says which step it was, at what time, and why.
    //! * A stepper with three unknowns takes 1.5 to 1.8 kB, most of it the solutions before; a composition has one for each of its steps:
    //!   `Order4` 8 kB, `Order10` 52 kB. On a small machine keep them in place.
}

pub mod ensembles {
    //! # Many at once
    //!
    //! An [`Ensemble`](crate::Ensemble) is one description and many states, each with parameters of its own: a body whose inertia is known to
    //! a percent, thrown a thousand times; a grid of initial conditions; a swarm.
    //!
    //! ```
    //! use coadjoint::prelude::*;
    //! use coadjoint::Ensemble;
    //!
    //! /// A pendulum with a motor in its bearing.
    //! #[lie_poisson_system(group = SO2, potential = -weight * angle.cos_angle(), force = motor, control(motor: R1))]
    //! struct Pendulum {
    //!     #[inertia]
    //!     inertia: f64,
    //!     weight: f64,
    //! }
    //!
    //! let pendulums: Vec<Pendulum> =
    //!     (0..100).map(|k| Pendulum { inertia: 1.0, weight: 9.0 + 0.02 * f64::from(k) }).collect();
    //! let hanging = PendulumState { angle: UnitComplex::new(0.5), momentum: vector![0.0] };
    //! let mut ensemble = Ensemble::<_, Cayley>::new(&pendulums, vec![hanging; 100], 0.01)?;
    //!
    //! // all brake, each by what it sees of itself, anew after every tenth step
    //! for _ in 0..100 {
    //!     ensemble.control(|_, state| PendulumControl { motor: -2.0 * state.momentum });
    //!     ensemble.run(10);
    //! }
    //! let fastest = ensemble.states().map(|state| state.momentum.norm()).fold(0.0, f64::max);
    //! assert!(fastest < 0.7 && ensemble.failed().is_empty());
    //! # Ok::<(), Box<dyn std::error::Error>>(())
    //! ```
    //!
    //! * The feature `parallel` moves them on all cores. Without it one core does all the work, with the same digits.
    //! * [`InitialStates`](crate::ensemble::InitialStates) draws states at random about a given one, on the group.
    //! * [`run_observed`](crate::Ensemble::run_observed) shows the members to an [`EnsembleObserver`](crate::ensemble::EnsembleObserver) now and then;
    //!   [`Distribution`](crate::ensemble::Distribution) records how a quantity spreads. Nothing else is kept.
    //! * A member that cannot take a step stays where it was and is listed with its step and the reason; the others go on.
    //! * Members move exactly as they would alone: neither the processor, nor the number of threads, nor their order makes a difference.
    //!   So a member that is odd can be run again by itself, with a [`Stepper`](crate::Stepper) and all its observers.
    //! * All schemes and compositions work, in `f64` and in `f32`, where twice as many go side by side.
    //!
    //! # Very long
    //!
    //! In 10⁷ steps and more the roundings of single steps begin to add up. [`Compensated<M>`](crate::Compensated) takes the steps
    //! of any scheme `M` with twice as many digits: invariants then hold to one rounding, however long the run. It is slow, and for one
    //! trajectory or many alike.
}

pub mod derivatives {
    //! # Derivatives
    //!
    //! Control, estimation and identification need to know how the motion changes where something else does: the state, a control, a
    //! parameter. With `derivatives` in the description, or `derivatives(state)` for a part of them, that is generated with the steps: the
    //! derivative of the step that is really taken, not of the continuous equations, exact to rounding at any step size.
    //!
    //! | call | needs `derivatives(…)` with |
    //! |---|---|
    //! | [`step_with_jacobian`](crate::Stepper::step_with_jacobian), [`jacobian`](crate::derivative::StepDerivative::jacobian) with [`WrtState`](crate::derivative::WrtState) | `state` |
    //! | the same with [`WrtControl`](crate::derivative::WrtControl) | `controls` |
    //! | the same with [`WrtParameters`](crate::derivative::WrtParameters) | `parameters` |
    //! | [`tangent`](crate::derivative::StepDerivative::tangent) of a step, or of a [`CheckpointedTape`](crate::derivative::CheckpointedTape::tangent) | `tangent` |
    //! | [`adjoint`](crate::derivative::StepDerivative::adjoint) of a step, [`gradient`](crate::derivative::CheckpointedTape::gradient) and [`gradient_with`](crate::derivative::CheckpointedTape::gradient_with) of a tape | `adjoint` |
    //! | [`step_with_derivative`](crate::Stepper::step_with_derivative), [`CheckpointedTape::new`](crate::derivative::CheckpointedTape::new) | any of them |
    //!
    //! **What changes.** A configuration `g` becomes `g exp(δ)`, with `δ` in the algebra: three numbers for a rotation, in body axes, whatever it
    //! is stored as. Momenta, advected parameters, controls and parameters change by what is added to them. All parts of a state lie one after
    //! the other, as its fields do; `TopIndices::MOMENTUM` says where.
    //!
    //! **As matrices**, where they are small and all of them is wanted:
    //!
    //! ```
    //! use coadjoint::derivative::{Block, WrtControl, WrtParameters, WrtState};
    //! use coadjoint::prelude::*;
    //!
    //! #[lie_poisson_system(group = SO3, control(torque: R3), force = torque - drag * momentum, derivatives)]
    //! struct Craft {
    //!     #[inertia]
    //!     inertia: Vector3<f64>,
    //!     drag: f64,
    //! }
    //!
    //! let craft = Craft { inertia: vector![1.0, 2.0, 2.5], drag: 0.01 };
    //! let mut state = CraftState { attitude: UnitQuaternion::identity(), momentum: vector![0.3, -0.2, 0.5] };
    //! let mut stepper = craft.stepper::<Cayley>(0.1)?;
    //! let control = CraftControl { torque: vector![0.1, 0.0, 0.0] };
    //!
    //! // only what is asked for is computed
    //! let blocks = (WrtState, WrtControl, WrtParameters);
    //! let (a, b, p) = stepper.step_with_jacobian(&mut state, &control, blocks)?.jacobian;
    //! assert_eq!((a.shape(), b.shape(), p.shape()), ((6, 6), (6, 3), (6, 4)));
    //! // output first, then input: the momentum with respect to the drag
    //! let wrt_drag = p.block(CraftIndices::MOMENTUM, CraftIndices::DRAG);
    //! assert!((wrt_drag + 0.1 * state.momentum).norm() < 2e-2);
    //! # Ok::<(), Box<dyn std::error::Error>>(())
    //! ```
    //!
    //! **As products**, where one direction is wanted, or one function of the result. Forwards, along a run:
    //!
    //! ```
    //! use coadjoint::derivative::Perturbation;
    //! use coadjoint::prelude::*;
    //!
    //! #[lie_poisson_system(group = SO3, derivatives)]
    //! struct Body {
    //!     #[inertia]
    //!     inertia: Vector3<f64>,
    //! }
    //!
    //! let body = Body { inertia: vector![1.0, 2.0, 2.5] };
    //! let mut state = BodyState { attitude: UnitQuaternion::identity(), momentum: vector![0.01, 2.0, 0.01] };
    //! let mut stepper = body.stepper::<Exponential>(0.05)?;
    //! let mut perturbation = Perturbation::<Body>::default();
    //! perturbation.state[3] = 1.0;
    //! for _ in 0..200 {
    //!     let (derivative, _) = stepper.step_with_derivative(&mut state, &NoControl::default())?;
    //!     perturbation.state = derivative.tangent(&perturbation);
    //! }
    //! // about its middle axis a body is unstable
    //! assert!(perturbation.state.norm() > 10.0);
    //! # Ok::<(), Box<dyn std::error::Error>>(())
    //! ```
    //!
    //! Backwards, a [`CheckpointedTape`](crate::derivative::CheckpointedTape) gives the derivatives of one function of the end of a run, and of states on
    //! the way, with respect to the start, every control and all parameters. Run and derivative take about four times as long as the run alone with its
    //! steps one by one; six times as long as one whose steps are taken [together](crate::Stepper::steps_with), where that is faster.
    //!
    //! What is worked out with these: `coadjoint_systems::applications`.
    //!
    //! **What must hold** and is tested: every block agrees with dual numbers through the same step; `D P(x) Dᵀ = P(x')` with the Poisson tensor
    //! `P`, and `det D = 1`, where no force acts; the product backwards is the transpose of that forwards.
    //!
    //! Steps of [`Compensated`](crate::Compensated) and [`Fused`](crate::Fused) schemes have none of their own: take those of the scheme itself.
}

pub mod erased {
    //! # Chosen while the program runs
    //!
    //! A program that takes system, scheme and parameters from a file or a command line has no types for them.
    //! [`coadjoint::erased`](crate::erased) has systems behind a `dyn` [`System`](crate::erased::System), schemes as a value of
    //! [`Scheme`](crate::erased::Scheme), and parameters, states and controls as lists of numbers, in the order of the struct's fields. Steps are
    //! the same to the last bit, and take about the same time. What is compiled for each system is its arithmetic alone.
    //!
    //! ```
    //! use coadjoint::erased::{self, Controls, Scheme, RunOptions};
    //! use coadjoint::erased::Map;
    //! use coadjoint::prelude::*;
    //! use std::ops::ControlFlow;
    //!
    //! #[lie_poisson_system(group = SO2, potential = -weight * angle.cos_angle(), control(motor: R1), force = motor)]
    //! struct Pendulum {
    //!     #[inertia]
    //!     inertia: f64,
    //!     weight: f64,
    //! }
    //!
    //! #[lie_poisson_system(group = SO3)]
    //! struct Body {
    //!     #[inertia]
    //!     inertia: Vector3<f64>,
    //! }
    //!
    //! fn system(name: &str) -> Option<Box<dyn erased::System>> {
    //!     Some(match name {
    //!         "pendulum" => Box::new(Pendulum { inertia: 1.0, weight: 9.81 }),
    //!         "body" => Box::new(Body { inertia: vector![1.0, 2.0, 2.5] }),
    //!         _ => return None,
    //!     })
    //! }
    //!
    //! let pendulum = system("pendulum").ok_or("no such system")?.with_parameters(&[2.0, 9.81]);
    //! assert_eq!(pendulum.description().parameters[0].name, "inertia");
    //! let mut stepper = erased::Stepper::new(&*pendulum, &Scheme::Standard(Map::Cayley), 0.01)?;
    //! // the angle's cosine and sine, and the momentum
    //! let mut state = [1.0, 0.0, 3.0];
    //! // a brake, asked anew before each step; `Controls::Held` where nothing changes
    //! let brake = |state: &[f64], _time: f64, motor: &mut [f64]| motor[0] = -2.0 * state[2];
    //! let run = RunOptions { steps: 1_000, controls: Controls::Chosen(&brake), next: &|index| index + 100 };
    //! let mut energies = Vec::new();
    //! erased::run(&mut stepper, &mut state, &run, &mut |sample| {
    //!     energies.push(sample.energy);
    //!     ControlFlow::Continue(())
    //! })?;
    //! assert_eq!(energies.len(), 11);
    //! assert!(energies[10] < energies[0]);
    //! # Ok::<(), Box<dyn std::error::Error>>(())
    //! ```
    //!
    //! A scheme that was not generated is then an error when the stepper is built, [`NotGenerated`](crate::erased::NotGenerated), which names the
    //! key of the description that asks for it. [`Ensemble`](crate::erased::Ensemble) and [`certify_erased`](crate::certify::certify_erased) are
    //! the same for ensembles and certificates. There are no derivatives.
}

pub mod reading {
    //! # Reading the generated code
    //!
    //! `cargo run --release -- show heavy_top` prints what the macro makes of a system of the catalogue; for your own,
    //! `cargo expand`. There is, in this order:
    //!
    //! * your struct, with the equations of motion, the invariants and the number of operations of each step in its documentation;
    //! * the state, and the controls if there are any; `serialization!` gives them serde's traits where the feature `serde` is on, else nothing;
    //! * your expressions as methods (`potential`, `hamiltonian`, `force`), for rustc to check;
    //! * [`System`](crate::System): parameters, energy, velocity, Casimirs, and the checks of an inertia;
    //! * [`Geometry`](crate::geometry::Geometry): local coordinates, differential and Poisson structure;
    //! * a [`Kernel`](crate::kernel::Kernel) for each scheme and retraction.
    //!
    //! A kernel has one function for each stage, and every value is computed in the earliest one that can, but what only the next state is
    //! made of, at the end:
    //!
    //! | function | when | what |
    //! |---|---|---|
    //! | `new` | once | what depends on parameters and step |
    //! | `begin` | once a step | what depends on state, time and controls |
    //! | `start` | at the first step | a first approximation of the unknown; later ones are predicted from earlier ones |
    //! | `evaluate` | once an iteration | `left(x) − right(x)` |
    //! | `fixed_point_update` | once an iteration | the solution of `left(x) = right`, where `left` is linear |
    //! | `correction` | once a Newton iteration | Newton's, with the closed-form Jacobian |
    //! | `domain`, `finish` | once a step | the retraction's margin; the next state |
    //!
    //! Names follow the mathematics: `eta` is the step times the velocity (`half_eta` half of it, the unknown where the Cayley map turns),
    //! `momentum_mean` the mean momentum `μ̄` (`twice_momentum_mean` twice that), `increment` the retraction of `eta`, `kick` what potential and
    //! forces add to the momentum, `gamma_mean` and `gamma_next` an advected parameter at the intermediate point and after the step.
    //! `Stumpff` functions `c0, c1, …` take the place of sines and cosines.
    //!
    //! What has no such name is called by what it is made of, if that is short (`half_h_per_inertia_x`), else by what it is computed for, with
    //! a number: `jacobian_12_1`. `minus_` stands before the negative of what the mathematics names, and `sum_1` is the beginning of a long sum.
    //! `a.mul_add(b, c)` is `a b + c`, and `a.neg_mul_add(b, c)` is `c − a b`, each one operation where processors have it.
    //!
    //! Where the equation is explicit or linear, there is no unknown (`[T; 0]`), and `evaluate` and `correction` are empty.
}

pub mod mathematics {
    //! # The mathematics
    //!
    //! Numbers in parentheses are those of the paper: V. Vivek, D. Martín de Diego and R. N. Banavar, *A Geometric Approach to
    //! Structure-Preserving Integrators for Mechanical Systems*.
    //!
    //! **Conventions.** `x̂ y = x × y`. The configuration `g` takes body to space coordinates; velocities are left-trivialized, `g' = g ξ̂`, with
    //! `ξ` the body velocity and `μ` the body momentum. `Ad*_g` is the transpose of `Ad_g`: on so(3)*, `Ad*_R Π = R⁻¹Π` and
    //! `ad*_Ω Π = Π × Ω`. The equations of motion with the Hamiltonian `h` are `μ' = ad*_{∂h/∂μ} μ − g⁻¹ ∂h/∂g + F`.
    //!
    //! **Retractions.** A map `τ` from the Lie algebra to the group with `τ(0) = e` and `τ'(0) = 1`. Its logarithmic derivatives are `dL τ_ξ η = τ(ξ)⁻¹ Dτ(ξ) η` and `dR τ_ξ η = Dτ(ξ) η τ(ξ)⁻¹`, so that `dR = Ad_τ dL`. On SO(3), with the Stumpff functions
    //! `c_k(z) = Σ (−z)^j/(k + 2j)!` of `z = |x|²`:
    //!
    //! | | exponential | Cayley |
    //! |---|---|---|
    //! | `τ(x)` | `1 + c₁ x̂ + c₂ x̂²` | `1 + (x̂ + x̂²/2)/(1 + z/4)` |
    //! | as a quaternion | `(cos ½|x|, c₁(z/4) x/2)` | `(1, x/2)/√(1 + z/4)` |
    //! | `dR τ_x` | `1 + c₂ x̂ + c₃ x̂²` | `(1 + x̂/2)/(1 + z/4)` |
    //! | domain | a turn of less than 2π | everything |
    //!
    //! Both are functions of one matrix, therefore odd, `τ(−ξ) = τ(ξ)⁻¹`, and equivariant, `τ(Ad_g ξ) = g τ(ξ) g⁻¹`, so that
    //! `Ad*_{τ(ξ)} m = m + ad*_ξ (dR τ_ξ)* m`. Coordinates of the second kind, `τ(ξ) = exp(ξ₁E₁) exp(ξ₂E₂) ⋯`, are neither: `τ̄(ξ) = τ(−ξ)⁻¹` has
    //! the factors in the opposite order. The columns of `dR τ_ξ` are `Ad` of the factors before on the axes; on SO(3) it is singular where the
    //! second turn is a quarter.
    //!
    //! The Stumpff functions are entire and closed under differentiation, `c_k' = (k c_{k+2} − c_{k+1})/2`: no formula has a special case at 0,
    //! and derivatives of any order stay among them.
    //!
    //! **Advected parameters** make the group a semidirect product `G ⋉ V`, and the system a Lie–Poisson system on `(g ⋉ V)*`. Everything
    //! about the product follows from the group and its representation `ρ`: `exp(ξ, w) = (exp ξ, φ₁(ρ_ξ) w)`,
    //! `cay(ξ, w) = (cay ξ, (1 − ρ_ξ/2)⁻¹ w)`, in coordinates of the second kind `(τ(ξ), τ(ξ) w)`, and their logarithmic derivatives by
    //! differentiation. Casimirs: of a body with vectors `Γᵢ`, all
    //! `Γᵢ·Γⱼ`, and with one vector `Π·Γ`.
    //!
    //! **The steps.** One family, for `s` from 0 to 1, with the unknown `η = t ζ`, where `t` is the step and `ζ` the velocity:
    //!
    //! ```text
    //! m⁻ = Ad*_{τ(−sη)⁻¹} μ_k                                  the momentum, carried to the intermediate point
    //! ḡ  = g_k τ(−sη)⁻¹
    //! m⁺ = m⁻ − t ḡ⁻¹ ∂h/∂g(ḡ, μ̄) + t F                         the kick; none for a left-invariant system
    //! μ̄  = (1−s) (dR τ_{(1−s)η})* m⁺ + s (dR τ_{−sη})* m⁻
    //! η  = t ∂h/∂μ(ḡ, μ̄)                                       the equation to be solved
    //! μ_{k+1} = Ad*_{τ((1−s)η)} m⁺,   g_{k+1} = ḡ τ((1−s)η)
    //! ```
    //!
    //! With any retraction the step is symplectic for every `s`, for a left-invariant `h` a Poisson map that keeps all Casimirs; the adjoint of `s`
    //! is `1 − s`, and the order is 1 but for `s = ½`, where it is 2. For a left-invariant `h` and a function of one matrix it is for every `s` its
    //! own adjoint and of order 2. Half a step with `s = 0`, then half a step with `s = 1`, is the Störmer–Verlet method of the group, of order 2. Symmetric steps of order 2 compose to
    //! those of orders 4, 6, 8 and 10.
    //!
    //! **A Lagrangian** `l(g, ξ, a)` needs no inverse. By Legendre's transform `μ = ∂l/∂ξ`, `h = ⟨μ, ξ⟩ − l`, and where the momentum is kept
    //! `∂h/∂g = −∂l/∂g`, `∂h/∂a = −∂l/∂a`: the equation to be solved is `∂l/∂ξ(ḡ, η/t, ā) = μ̄`, and all else stays. Energy and velocity of a state
    //! are in closed form where `l` is quadratic in the velocity, else found by Newton's iteration.
    //!
    //! **The tangent lifts** are the tangent maps of the same discretization of the configuration, along the motion `ξ' = ξ'(g, ξ)`: solve
    //! `ξ_k = Ad_{τ(−sη)⁻¹} η/t − s dL τ_{−sη} t ξ'(ḡ, η/t)` for `η`, and take `ξ_{k+1} = Ad_{τ((1−s)η)⁻¹} η/t + (1−s) dL τ_{(1−s)η} t ξ'(ḡ, η/t)`.
    //!
    //! Which of the paper's methods is which of these is in [the paper's equations](super::paper).
}

pub mod paper {
    //! # The paper's equations
    //!
    //! V. Vivek, D. Martín de Diego and R. N. Banavar, *A Geometric Approach to Structure-Preserving Integrators for Mechanical Systems*: every
    //! numbered method of its chapters 1, 3, 5 and 6, the type that takes its steps, and what runs it; each command after
    //! `cargo run --release --`. All are held against the same methods from definitions, ten steps long, with both retractions and at several `s`
    //! where they have one: `tests/tests/all/paper.rs` and `numbered.rs`, with the [generic stepper](crate::generic) as the definition.
    //!
    //! | in the paper | here | run by | misprint |
    //! |---|---|---|---|
    //! | (1.7), (1.8) Euler's explicit and implicit method | `SymplecticEulerA`, `SymplecticEulerB` of a [vector field](#vector-fields-on-a-group-32) on `R2` | `run harmonic_oscillator --method explicit-euler`, `implicit-euler` | (1.8) |
    //! | (1.9), (1.10) symplectic Euler A and B | [`SymplecticEulerA`](crate::SymplecticEulerA), [`SymplecticEulerB`](crate::SymplecticEulerB) on `R1` … `R6` | `run harmonic_oscillator --method euler-a`, `euler-b` | |
    //! | (1.12)–(1.18) two bodies | [a recipe](#two-bodies-112118) | `run two_bodies` | (1.12) |
    //! | Runge–Kutta methods of 1.2.2 | the crate `coadjoint-classical` | `run kepler --method rk2`, `rk4` | |
    //! | Störmer–Verlet of 1.2.2 | [`StormerVerlet`](crate::StormerVerlet) | `run kepler --method verlet` | tableau |
    //! | (1.19), (1.20) planar pendulum; (1.21) with projection | `group = SO2` | `run planar_pendulum`, `figures 1.3` | |
    //! | (3.1) a discretization map, the θ-family of 3.3 | [`Family<_, N, D>`](crate::Family) of a [vector field](#vector-fields-on-a-group-32) on `R1` … `R6`, `θ = s` | | |
    //! | (3.2) the same on a group, left and right | [a recipe](#vector-fields-on-a-group-32) | | |
    //! | (4.6)–(4.10) Legendre's transform | `lagrangian = …`; [`momentum_of`](crate::System::momentum_of), [`velocity_of`](crate::System::velocity_of) | `run double_pendulum` | (4.5) |
    //! | (5.1), (5.3) tangent lifts, the θ-family on TQ | [`TangentLift<_, N, D>`](crate::TangentLift) on `R1` … `R6`, `θ = s` | `run harmonic_oscillator --method tangent-lift` | |
    //! | (5.2), (5.4) cotangent lifts, the θ-family of 5.3 | `Family<_, N, D>` on `R1` … `R6`, `θ = s` | `run harmonic_oscillator --method family=1/4` | |
    //! | (5.5), (5.7) trivialized tangent lifts | `TangentLift<_, N, D>`, [`TangentMidpoint`](crate::TangentMidpoint) | `run free_rigid_body --method tangent-lift`, `tangent-lift=1/2` | |
    //! | (5.6), (5.8) trivialized cotangent lifts | `Family<_, N, D>` on every group: of velocities in the body, and with `invariance = right` of those in space | `run free_rigid_body --method family=1/4`, `run coupled_bodies --method midpoint`, `run ellipsoidal_fluid` | |
    //! | (6.1), (6.3)–(6.5), (6.7), (6.8) a quadratic energy, the rigid body | `SymplecticEulerA`, which is what a retraction alone means | `run free_rigid_body --method euler-a` | right sides |
    //! | (6.2), (6.6), (6.9) the right lift | [`RightLift`](crate::RightLift), which carries `π = Ad*_{g⁻¹} μ`, a constant | `run free_rigid_body --method right-lift` | (6.2), right sides |
    //! | (6.10), (6.11) with the exponential | [`Exponential`](crate::Exponential) | `run free_rigid_body` | (6.11) |
    //! | (6.12), (6.13) with the Cayley map | [`Cayley`](crate::Cayley) | `run free_rigid_body --retraction cayley` | (6.13), and before it |
    //! | (6.14) the heavy top | `advected(gamma: R3)` | `run heavy_top` | |
    //! | (6.15), (6.16) with the exponential and `x` | [a recipe](#the-heavy-tops-auxiliary-x-615618) | `run heavy_top_on_se3` | (6.16), `J`, `Q` |
    //! | (6.17), (6.18) with the Cayley map and `x` | the same | `run heavy_top_on_se3 --retraction cayley` | (6.18) |
    //! | (6.19), (6.20) the quadrotor | [forces and controls](super::forces), `SymplecticEulerA` | `run loose_quadrotor --method euler-a` | (6.20) |
    //! | (6.21), (6.22) with either retraction | `SymplecticEulerA<Exponential>`, `SymplecticEulerA<Cayley>` | the same with `--retraction cayley` | both |
    //!
    //! **Trivializations.** The discretization map may stand on the left of the algebra, `ḡ τ(η)`, or on the right, `τ(ω) ḡ` with `ω = Ad_ḡ η`, and its
    //! lift may have momenta in the body or in space: LL, LR, RL and RR.
    //!
    //! | map, lift | functions of one matrix | coordinates of the second kind |
    //! |---|---|---|
    //! | LL | the family | the family |
    //! | LR | the same map, `π = Ad*_{g⁻¹} μ` in place of `μ`: [`RightLift`](crate::RightLift) carries it where it is constant | the same map |
    //! | RL, RR | the same maps as LL and LR, for `τ(Ad_ḡ η) ḡ = ḡ τ(η)` | other maps |
    //!
    //! With `invariance = right` all is mirrored: RR is the family, and RL is the one that carries a constant momentum, in the body. A map on the
    //! side on which the system is not invariant is not generated: it moves with the configuration, `D(h ḡ, Ad_h ω) ≠ h D(ḡ, ω)`, so that there is
    //! no reduced step, no Poisson map, and no constant momentum. By inversion of the configuration it is the map of `τ̄` on the other side.
    //!
    //! **Misprints.** These displays cannot be used as they are printed. Each was compared with its definition or its own equations of motion:
    //!
    //! | display | printed | should be | what the printed one does |
    //! |---|---|---|---|
    //! | (1.8) | `[[1, −h], [hk/m, 1]]/(1 + h²k/m)` | both signs off the diagonal the other way | runs backwards |
    //! | (1.12) | `G m₁m₁` | `G m₁m₂` | contradicts (1.13) |
    //! | Störmer–Verlet's tableau | `a = [[0, 0], [1, 0]]` | `a = [[0, 0], [½, ½]]` | breaks the condition of symplecticity that is printed above it |
    //! | (4.5) | a sign | that of Definition 1.9 | |
    //! | (6.2) | a parenthesis that closes too late | `τ⁻¹(g_k⁻¹ g_{k+1}), μ_{k+1} − μ_k` | |
    //! | (6.5)–(6.12), right side of the momentum relation | `𝕀(tξ_k)` | `𝕀(ξ_k)` | velocity off by the factor 1/t |
    //! | (6.11), first bracket and last line | `1 − … tΩ̂ …`, `Π_{k+1} = exp(tΩ̂) Π_k` | both with `−t` | follows the flow backwards |
    //! | Cayley map before (6.13) | `(1 − x̂)⁻¹(1 + x̂)⁻¹` | `(1 − x̂/2)⁻¹(1 + x̂/2)` | is no rotation; without the halves `τ'(0) ≠ 1` |
    //! | (6.13) | halves missing, signs as in (6.11) | [the table of retractions](super::mathematics) | follows the flow at −4t |
    //! | (6.16), updates of `x` and `Π` | `R_k J(tΩ_k) mgχ`; `exp(tΩ̂)(Π_k − Γ_k × J mgχ)` | with the step `t` before `J`; `exp(−tΩ̂)(Π_k + Γ_k × t J mgχ)` | the step is missing; signs |
    //! | (6.16), third line; so are (6.15), (6.17) and (6.18) to be read | `Jᵀ R_kᵀ(Π_k + Γ_k × x_k) + Qᵀ R_kᵀ Γ_k` | `JᵀΠ_k + QᵀΓ_k`, with `Q` at `t mgχ` | the right lift's data with momenta of the body: the error does not shrink with the step |
    //! | `J` below (6.16) | first coefficient `sin²(θ/2)/(θ/2)²`, of `x̂` | half of it, of `ŷ` | twice too large |
    //! | `Q` below (6.16) | the same; `c₃(ŷẑ − ẑŷ)` | `c₂ ẑ`; `c₃(ŷẑ + ẑŷ)` | is not the logarithmic derivative |
    //! | (6.18) | `x` with `R_kᵀ`; exponential and `J` in its last two lines | Cayley throughout: with `y = tΩ_k` and `z = t mgχ`, `(1 + ¼&#124;y&#124;²) 𝓘Ω_k = (1 − ½ŷ)(Π_k + ½ Γ_k × z)` and `x` moved by `R_k (1 − ½ŷ)⁻¹ z` | mixes two retractions: Casimirs are only nearly kept |
    //! | (6.20)–(6.22) | `… + M_k`; `p_{k+1} = −p_k + t m g e₃ − t F R e₃` | the moment acts with `t`, at the start of the step; `p_{k+1} = p_k − t m g e₃ + t F R e₃` | contradicts (6.19) |
    //!
    //! # Vector fields on a group: (3.2)
    //!
    //! `g' = g X(g)^` needs no mechanics. It is the motion of the configuration under the Hamiltonian `⟨μ, X(g)⟩`, whatever the momentum is; a
    //! momentum of 0 stays 0. Every member of the family then takes the steps of (3.2), and on `Rⁿ` those of (3.1): `s = 0` is Euler's explicit
    //! method, `s = 1` the implicit one, `s = ½` the midpoint rule of order 2. (The equation of a step is solved to rounding next to the velocity's
    //! size. Where the field vanishes that is rounding itself, so that an implicit step may fail at an equilibrium.)
    //!
    //! ```
    //! use coadjoint::prelude::*;
    //!
    //! /// Spins about its third axis, and turns that towards a star.
    //! #[lie_poisson_system(
    //!     group = SO3,
    //!     hamiltonian = {
    //!         let seen = attitude.inverse() * star;
    //!         momentum.dot(&(gain * Vector3::z().cross(&seen) + spin * Vector3::z()))
    //!     },
    //!     methods(Midpoint),
    //! )]
    //! struct Pointing {
    //!     star: Vector3<f64>,
    //!     gain: f64,
    //!     spin: f64,
    //! }
    //!
    //! let pointing = Pointing { star: vector![0.6, 0.0, 0.8], gain: 0.5, spin: 1.0 };
    //! let mut state = PointingState { attitude: UnitQuaternion::identity(), momentum: Vector3::zeros() };
    //! let mut stepper = pointing.stepper::<Midpoint<Cayley>>(0.1)?;
    //! for _ in 0..500 {
    //!     stepper.step(&mut state)?;
    //! }
    //! assert!((state.attitude * Vector3::z() - pointing.star).norm() < 1e-9);
    //! assert_eq!(state.momentum, Vector3::zeros());
    //! # Ok::<(), Box<dyn std::error::Error>>(())
    //! ```
    //!
    //! With `invariance = right` the field is one in space, `g' = X(g)^ g`, and the discretization map the right one. A momentum that is not 0
    //! is carried as the gradient of something that the motion's end is judged by: backwards in time it is what the adjoint equation asks for.
    //!
    //! # Two bodies: (1.12)–(1.18)
    //!
    //! Each body is a factor with a momentum of its own, and they meet in the potential. What the paper splits off, the centre of mass (1.14), moves
    //! uniformly in every step too, and the rest moves as (1.18).
    //!
    //! ```
    //! use coadjoint::prelude::*;
    //!
    //! #[lie_poisson_system(
    //!     group(first: R3, second: R3),
    //!     potential = -gravitation * first_mass * second_mass / (second - first).norm(),
    //! )]
    //! struct TwoBodies {
    //!     #[inertia(first)]
    //!     first_mass: f64,
    //!     #[inertia(second)]
    //!     second_mass: f64,
    //!     gravitation: f64,
    //! }
    //!
    //! let bodies = TwoBodies { first_mass: 2.0, second_mass: 1.0, gravitation: 1.0 };
    //! let mut state = TwoBodiesState {
    //!     first: vector![-1.0, 0.0, 0.0],
    //!     first_momentum: vector![0.0, -0.8, 0.3],
    //!     second: vector![2.0, 0.0, 0.0],
    //!     second_momentum: vector![0.0, 0.8, 0.0],
    //! };
    //! let angular_momentum =
    //!     |s: &TwoBodiesState| s.first.cross(&s.first_momentum) + s.second.cross(&s.second_momentum);
    //! let before = angular_momentum(&state);
    //! let mut stepper = bodies.stepper::<Exponential>(0.01)?;
    //! for _ in 0..1_000 {
    //!     stepper.step(&mut state)?;
    //! }
    //! // after 10 s: their momentum together is 0.3, their mass 3
    //! let centre = (2.0 * state.first + state.second) / 3.0;
    //! assert!((centre - vector![0.0, 0.0, 1.0]).norm() < 1e-12);
    //! assert!((angular_momentum(&state) - before).norm() < 1e-12);
    //! # Ok::<(), Box<dyn std::error::Error>>(())
    //! ```
    //!
    //! # The heavy top's auxiliary x: (6.15)–(6.18)
    //!
    //! An advected vertical needs no `x`. Who wants the paper's variables takes all of SE(3) as the configuration, the vertical as the linear momentum,
    //! and a Hamiltonian that is linear in it: `v = mgχ`, and `x` moves with it. Attitude, momentum and vertical are those of the top with the vertical
    //! advected.
    //!
    //! ```
    //! use coadjoint::prelude::*;
    //!
    //! #[lie_poisson_system(
    //!     group = SE3,
    //!     hamiltonian = 0.5 * angular_momentum.dot(&angular_momentum.component_div(&inertia))
    //!         + weight * linear_momentum.dot(&chi),
    //! )]
    //! struct Top {
    //!     #[inertia]
    //!     inertia: Vector3<f64>,
    //!     weight: f64,
    //!     chi: Vector3<f64>,
    //! }
    //!
    //! let top = Top { inertia: vector![1.0, 10.0, 100.0], weight: 1.0, chi: Vector3::z() };
    //! // no rotation and x = 0; Π = (1, 1, 1) and Γ = (0, 0, 1)
    //! let mut state = TopState { pose: Isometry3::identity(), momentum: vector![1.0, 1.0, 1.0, 0.0, 0.0, 1.0] };
    //! let mut stepper = top.stepper::<Exponential>(0.01)?;
    //! for _ in 0..1_000 {
    //!     stepper.step(&mut state)?;
    //! }
    //! // the torque of the weight has changed the angular momentum in space by e₃ × x
    //! let momentum = state.pose.rotation * vector![state.momentum.x, state.momentum.y, state.momentum.z];
    //! let x = state.pose.translation.vector;
    //! assert!((momentum - vector![1.0, 1.0, 1.0] - Vector3::z().cross(&x)).norm() < 1e-12);
    //! # Ok::<(), Box<dyn std::error::Error>>(())
    //! ```
}
