//! Derivatives of whole runs.

use core::fmt;
use std::vec::Vec;

use super::blocks::{all_finite, dense};
use super::{
    Adjoint, Dense, Derives, Differentiable, Gradient, Linearizable, Parts, Perturbation, StepStart, Tangent,
    add, to_array,
};
use crate::error::StepError;
use crate::run::{RunError, RunReport};
use crate::scalar::Scalar;
use crate::stepper::Stepper;
use crate::system::{Control, Discretized, State};

/// A run of some steps, recorded so that its derivative can be taken forwards and backwards.
///
/// What is kept grows like the square root of the number of steps: some states on the way, from which the steps between them are taken once
/// more when the derivative is. The steps come out the same, to the last bit.
///
/// ```
/// use coadjoint::derivative::CheckpointedTape;
/// use coadjoint::prelude::*;
///
/// #[lie_poisson_system(group = SO3, derivatives)]
/// struct Body {
///     #[inertia]
///     inertia: Vector3<f64>,
/// }
///
/// let body = Body { inertia: vector![1.0, 2.0, 2.5] };
/// let mut state = BodyState { attitude: UnitQuaternion::identity(), momentum: vector![0.4, -0.8, 1.5] };
/// let mut stepper = body.stepper::<Cayley>(0.01)?;
/// let run = CheckpointedTape::new(&mut stepper, &mut state, 1_000, |_| Default::default())?;
///
/// // how the momentum's x component at the end depends on the initial state and the moments of inertia
/// let mut costate = nalgebra::SVector::zeros();
/// costate[3] = 1.0;
/// let gradient = run.gradient(&costate)?;
/// // all is well where the moments grow and the momentum with them: the motion is the same
/// let along = gradient.parameters.dot(&body.inertia) + gradient.state.fixed_rows::<3>(3).dot(&vector![0.4, -0.8, 1.5]);
/// assert!((along - state.momentum.x).abs() < 1e-12);
/// # use coadjoint::nalgebra;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct CheckpointedTape<S, M, C>
where
    S: Discretized<M> + Differentiable,
{
    /// The stepper and the state at the start of each segment.
    checkpoints: Vec<(Stepper<S, M>, S::State)>,
    /// Steps in a segment; in the last one there may be fewer.
    spacing: u64,
    steps: u64,
    control: C,
}

/// A step as it was taken: state, time and controls at its start, and the solutions of its equations.
type Taken<S, M> = (
    <<S as crate::system::System>::State as State>::Components,
    <S as crate::system::System>::Scalar,
    <S as crate::system::System>::ControlComponents<<S as crate::system::System>::Scalar>,
    <<S as Discretized<M>>::Method<<S as crate::system::System>::Scalar> as Linearizable<S>>::Trace,
);

impl<S, M, C> CheckpointedTape<S, M, C>
where
    S: Discretized<M> + Differentiable,
    S::Method<S::Scalar>: Linearizable<S>,
    C: Fn(u64) -> S::Control,
{
    /// Takes `steps` steps, each with the controls that are given for it, counted from 0. They will be asked for again.
    ///
    /// # Errors
    /// If a step cannot be taken: stepper and state are then at its start.
    pub fn new(
        stepper: &mut Stepper<S, M>,
        state: &mut S::State,
        steps: u64,
        control: C,
    ) -> Result<Self, RunError> {
        let spacing = steps.isqrt().max(1);
        let mut checkpoints = Vec::new();
        let mut report = RunReport::default();
        for step in 0..steps {
            if step % spacing == 0 {
                checkpoints.push((stepper.clone(), state.clone()));
            }
            match stepper.step_with(state, &control(step)) {
                Ok(taken) => report.count(&taken),
                Err(cause) => return Err(RunError::new(step + 1, stepper.time(), report, cause)),
            }
        }
        Ok(Self { checkpoints, spacing, steps, control })
    }

    /// The number of steps.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// How many checkpoints are kept: about the square root of the number of steps.
    pub fn checkpoint_count(&self) -> usize {
        self.checkpoints.len()
    }

    /// The perturbation of the last state that follows from one of the first state, with perturbations of the parameters and of the
    /// controls over all steps.
    ///
    /// # Errors
    /// If a step cannot be taken, which it was when the tape was recorded, or has
    /// [no derivative](StepError::NoDerivative).
    pub fn tangent(&self, perturbation: &Perturbation<S>) -> Result<S::StateVector, StepError>
    where
        S: Derives<Tangent>,
    {
        let mut perturbation = *perturbation;
        let Some((stepper, state)) = self.checkpoints.first() else { return Ok(perturbation.state) };
        let (mut stepper, mut state) = (stepper.clone(), state.clone());
        for step in 0..self.steps {
            let (derivative, _) = stepper.step_with_derivative(&mut state, &(self.control)(step))?;
            perturbation.state = derivative.tangent(&perturbation);
        }
        Ok(perturbation.state)
    }

    /// The derivatives of a function of the last state, whose derivative there is `costate`: with respect to the first state, the parameters and
    /// the controls, of all steps together.
    ///
    /// # Errors
    /// If a step cannot be taken, which it was when the tape was recorded, or has
    /// [no derivative](StepError::NoDerivative).
    pub fn gradient(&self, costate: &S::StateVector) -> Result<Gradient<S>, StepError>
    where
        S: Derives<Adjoint>,
    {
        self.gradient_with(costate, |_, _, _, _| {})
    }

    /// As [`gradient`](Self::gradient), of a function that depends on states on the way, too.
    ///
    /// `each` is shown every step, the last one first: its number from 0, the state at its start, the derivative with respect to the controls
    /// of this step alone, and the costate at its start, to which it adds what depends on the state there on its own account.
    ///
    /// # Errors
    /// If a step cannot be taken, which it was when the tape was recorded, or has
    /// [no derivative](StepError::NoDerivative).
    pub fn gradient_with(
        &self,
        costate: &S::StateVector,
        mut each: impl FnMut(u64, &S::State, &S::ControlVector, &mut S::StateVector),
    ) -> Result<Gradient<S>, StepError>
    where
        S: Derives<Adjoint>,
    {
        let mut total = Gradient::<S> { state: *costate, ..Parts::default() };
        let mut taken: Vec<Taken<S, M>> = Vec::new();
        for (segment, (stepper, state)) in self.checkpoints.iter().enumerate().rev() {
            let first = segment as u64 * self.spacing;
            let (mut stepper, mut state) = (stepper.clone(), state.clone());
            taken.clear();
            for step in first..self.steps.min(first + self.spacing) {
                let control = (self.control)(step);
                let (start, time) = (state.to_components(), S::Scalar::of(stepper.time()));
                stepper.step_with(&mut state, &control)?;
                taken.push((start, time, control.to_components(), stepper.method.trace()));
            }
            let parameters = &stepper.system.to_parameters();
            for (k, (start, time, control, trace)) in taken.iter().enumerate().rev() {
                let step = first + k as u64;
                let (step_size, time) = (stepper.step, *time);
                let start_of_step = StepStart { parameters, step: step_size, state: start, time, control };
                let derivative = stepper.method.derivative(&start_of_step, trace);
                let (state, control, parameters) =
                    S::Method::<S::Scalar>::adjoint(&derivative, &to_array(&total.state));
                if ![state.as_ref(), control.as_ref(), parameters.as_ref()].into_iter().all(all_finite) {
                    return Err(StepError::NoDerivative);
                }
                total.state = dense(&[state]);
                add(total.control.as_mut_slice(), control.as_ref());
                add(total.parameters.as_mut_slice(), parameters.as_ref());
                let control = dense(&[control]);
                let state = S::State::from_components(start);
                each(step, &state, &control, &mut total.state);
            }
        }
        Ok(total)
    }
}

impl<S: Discretized<M> + Differentiable, M, C> fmt::Debug for CheckpointedTape<S, M, C> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { spacing, steps, .. } = self;
        f.debug_struct("CheckpointedTape")
            .field("steps", steps)
            .field("spacing", spacing)
            .finish_non_exhaustive()
    }
}
