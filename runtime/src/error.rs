//! What can go wrong, typed.

use core::fmt;

use thiserror::Error;

use crate::crossing::Event;

/// A parameter, or the step size, with which no stepper can be built.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ParameterError {
    /// A parameter is infinite or not a number.
    #[error("parameter `{name}` is not finite")]
    NotFinite {
        /// The field's name.
        name: &'static str,
    },
    /// An inertia matrix is not symmetric: mirrored entries differ by more than 1e-6 of the largest. One that is closer is made symmetric.
    #[error(
        "inertia `{name}` is not symmetric: entries mirrored at the diagonal differ by {difference:e}, which is more than 1e-6 of the \
         largest; its symmetric part is `({name} + {name}.transpose()) / 2.0`"
    )]
    NotSymmetric {
        /// The field's name.
        name: &'static str,
        /// The largest difference between mirrored entries.
        difference: f64,
    },
    /// An inertia is not positive definite: some motion would have no or negative kinetic energy.
    #[error(
        "inertia `{name}` is not positive definite: its moment {index}, or of a matrix pivot {index} of its LDLᵀ factorization, counted from 0, is {pivot}"
    )]
    NotPositiveDefinite {
        /// The field's name.
        name: &'static str,
        /// Which pivot, from 0; for principal moments, which moment.
        index: usize,
        /// Its value.
        pivot: f64,
    },
    /// The step is zero, infinite or not a number.
    #[error("the step must be finite and not zero, got {step}")]
    Step {
        /// The step asked for.
        step: f64,
    },
    /// A tolerance that is not between 0 and 1.
    #[error("the tolerance must be between 0 and 1, such as 1e-9, got {tolerance}")]
    Tolerance {
        /// The tolerance asked for.
        tolerance: f64,
    },
    /// A list of numbers is not one of the system's parameters.
    #[error("there are {got} parameters in place of {expected}: they are of another system")]
    Length {
        /// How many numbers the parameters are.
        expected: usize,
        /// How many were given.
        got: usize,
    },
    /// What a stepper is to restore is the snapshot of a stepper for another system or scheme.
    #[error("the snapshot has {got} numbers in place of {expected}: it is of another system or scheme")]
    Snapshot {
        /// How many numbers the stepper carries.
        expected: usize,
        /// How many were given.
        got: usize,
    },
}

/// A step that could not be taken. The state is as before the call.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum StepError {
    /// The state, time or control handed in, the state after the step, or what moves it is infinite somewhere or not a number: as at a pole of the
    /// potential.
    #[error(
        "the state, its time, a control or what moves it is not finite, as at a pole, or the direction of a zero vector"
    )]
    NotFinite,
    /// The list of numbers handed in is no state of the system.
    #[error("the state must have {expected} numbers: it is of another system")]
    Length {
        /// How many numbers a state has.
        expected: usize,
    },
    /// The configuration handed in is not on its group: a rotation whose quaternion or complex number is not of unit length
    /// (nalgebra's `new_unchecked` and its deserializer do not look), or a matrix that is no element.
    #[error(
        "the configuration is off its group by {deviation:.1e}: rotations have unit length, matrices satisfy the equations of their group"
    )]
    NotOnGroup {
        /// How far off it is.
        deviation: f64,
    },
    /// A run cannot end at a time that is not finite, behind its start, or farther away than steps can be counted.
    #[error("no number of steps leads to the time {time}")]
    OutOfReach {
        /// The time asked for.
        time: f64,
    },
    /// The description has no event of the name that [`Run::on`](crate::Run::on) was given.
    #[error("the description has no event of this name; it has {}", named(known))]
    NoEvent {
        /// The events that it has.
        known: &'static [(&'static str, Event)],
    },
    /// Events come ever closer to each other, as those of a ball that bounces and comes to rest, or never stop coming.
    #[error(
        "there are more than {most} events within the step, the last one at the time {time}: they come ever closer to each other; let the \
         callback of one of them stop the run, or hold what moves"
    )]
    TooManyEvents {
        /// As many there may be.
        most: u32,
        /// The time of the last one.
        time: f64,
    },
    /// The step's equation was not solved in as many iterations as there may be; a smaller step helps.
    #[error(
        "no convergence after {iterations} iterations, relative residual {residual:e}; try a smaller step"
    )]
    NoConvergence {
        /// Iterations made.
        iterations: u32,
        /// The smallest residual reached, relative to the right side of the equation there.
        residual: f64,
    },
    /// The step's equation has no solution near the state: the residual is smallest where it is not zero. The step is longer than the motion
    /// can be continued by it.
    #[error(
        "the step's equation has no solution near the state: its residual becomes no smaller than {residual:e} of its right side; the step is too \
         long for this motion, take a smaller one"
    )]
    NoSolution {
        /// The smallest residual reached, relative to the right side of the equation there.
        residual: f64,
    },
    /// The step's equation has several solutions near the state, and none of them is the one that the motion goes on with.
    #[error("the step's equation has several solutions near the state; a smaller step has one")]
    SeveralSolutions,
    /// The Jacobian of the step's equation is singular, or not finite, where the equation is to be solved.
    #[error(
        "the Jacobian of the step's equation is singular or not finite: the energy has no regular second derivative by the momentum or velocity \
         here, a force has no derivative, or the step is too long"
    )]
    SingularJacobian,
    /// The solution lies outside the retraction's domain (for the exponential on SO(3): a turn of 2π or more in one
    /// step); take a smaller step or the Cayley map.
    #[error("the step leaves the retraction's domain; try a smaller step or the Cayley map")]
    OutsideDomain,
    /// A Taylor step would be so short that time does not go on: the motion ends in a singularity there.
    #[error(
        "the step would be no longer than {step:e}, so that time does not go on: there is a singularity ahead"
    )]
    NoProgress {
        /// The step that the series would allow.
        step: f64,
    },
    /// Taylor steps get no farther than their tolerance allows: what moves the system jumps to and fro where the motion is held by it, as dry friction
    /// does at rest; or all that moves it is what rounding leaves of terms that cancel.
    #[error(
        "what moves the system jumps back and forth over steps as short as {step:e}, as dry friction does at rest, or what rounding leaves of terms \
         that cancel: make it smooth, as `tanh` is, start with what is more than rounding, or take steps of one length, whose error is not looked at"
    )]
    Jumps {
        /// The last step.
        step: f64,
    },
    /// A Taylor step would have no end, for the motion is a polynomial in time, as it is at rest.
    #[error(
        "the motion is a polynomial in time, so that a step of any length is exact: say to which time, or bound the step"
    )]
    NoEnd,
    /// The step has no derivative, or an infinite one: somewhere in the description a root, a norm or a power is zero
    /// that has no derivative there, as the norm of a velocity has none at rest. Times the velocity it has one, and its
    /// square has.
    #[error(
        "the step has no finite derivative here: a root, a norm or a power in the description is zero; add a small number under the root"
    )]
    NoDerivative,
}

/// Names in a row, or none.
fn named(events: &'static [(&'static str, Event)]) -> impl fmt::Display {
    struct Names(&'static [(&'static str, Event)]);
    impl fmt::Display for Names {
        fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            for (place, (name, _)) in self.0.iter().enumerate() {
                write!(f, "{}`{name}`", if place == 0 { "" } else { ", " })?;
            }
            if self.0.is_empty() { f.write_str("none: write `event(name = …)`") } else { Ok(()) }
        }
    }
    Names(events)
}
