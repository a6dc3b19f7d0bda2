//! Systems that are wrong in a way, to see that it is found.

use std::marker::PhantomData;

use coadjoint::__private::{Evaluation, Geometry, Kernel, RetractionKind, Scalar};
use coadjoint::system::{Quantity, Side};
use coadjoint::{LegendreError, ParameterError, System};

/// What is wrong with a kernel: nothing, unless it says so.
pub(crate) trait Fault: Copy + Send + Sync + 'static {
    /// What becomes of the right side of the equation.
    fn right<T: Scalar>(_right: &mut [T]) {}
    /// What becomes of Newton's correction.
    fn correction<T: Scalar>(_correction: &mut [T]) {}
    /// What becomes of the state after the step.
    fn next<T: Scalar>(_next: &mut [T]) {}
}

impl Fault for () {}

/// A kernel with a fault.
#[derive(Clone, Copy)]
pub(crate) struct FaultyKernel<K, F>(K, PhantomData<F>);

impl<T: Scalar, K: Kernel<T>, F: Fault> Kernel<T> for FaultyKernel<K, F> {
    type Parameters = K::Parameters;
    type State = K::State;
    type Control = K::Control;
    type Unknown = K::Unknown;
    type Step = K::Step;
    type Iterate = K::Iterate;
    type Places<X: Scalar> = K::Places<X>;

    const BLOCKS: &'static [usize] = K::BLOCKS;
    const PROGRAM: [&'static [u8]; 4] = K::PROGRAM;

    fn constants(&self) -> &[T] {
        self.0.constants()
    }

    fn new(parameters: &K::Parameters, step: T) -> Self {
        Self(K::new(parameters, step), PhantomData)
    }

    fn begin(&self, state: &K::State, time: T, control: &K::Control) -> K::Step {
        self.0.begin(state, time, control)
    }

    fn start(&self, state: &K::State, step: &K::Step) -> K::Unknown {
        self.0.start(state, step)
    }

    fn evaluate(
        &self,
        state: &K::State,
        step: &K::Step,
        x: &K::Unknown,
    ) -> Evaluation<K::Unknown, K::Iterate> {
        let mut evaluation = self.0.evaluate(state, step, x);
        F::right(evaluation.right.as_mut());
        evaluation
    }

    fn correction(
        &self,
        state: &K::State,
        step: &K::Step,
        x: &K::Unknown,
        evaluation: &Evaluation<K::Unknown, K::Iterate>,
    ) -> K::Unknown {
        let mut correction = self.0.correction(state, step, x, evaluation);
        F::correction(correction.as_mut());
        correction
    }

    fn fixed_point_update(
        &self,
        state: &K::State,
        step: &K::Step,
        x: &K::Unknown,
        evaluation: &Evaluation<K::Unknown, K::Iterate>,
    ) -> K::Unknown {
        self.0.fixed_point_update(state, step, x, evaluation)
    }

    fn domain(
        &self,
        state: &K::State,
        step: &K::Step,
        x: &K::Unknown,
        evaluation: &Evaluation<K::Unknown, K::Iterate>,
    ) -> Option<T> {
        self.0.domain(state, step, x, evaluation)
    }

    fn finish(
        &self,
        state: &K::State,
        step: &K::Step,
        x: &K::Unknown,
        evaluation: &Evaluation<K::Unknown, K::Iterate>,
    ) -> K::State {
        let mut next = self.0.finish(state, step, x, evaluation);
        F::next(next.as_mut());
        next
    }
}

type Displace<S> =
    fn(&S, &<S as System>::State, RetractionKind, &<S as Geometry>::Tangent) -> <S as System>::State;
type Vector<S> = fn(&S, &<S as System>::State, &<S as Geometry>::Tangent) -> <S as Geometry>::Tangent;
type Casimirs<S> = fn(&S, &<S as System>::State) -> <S as System>::Casimirs;

/// A system whose geometry is wrong in a way, and kernels, if it has any, in the way `F`.
pub(crate) struct Faulty<S: Geometry<Scalar = f64>, F = ()> {
    system: S,
    energy: f64,
    displace: Displace<S>,
    vector: Vector<S>,
    casimirs: Casimirs<S>,
    fault: PhantomData<F>,
}

impl<S: Geometry<Scalar = f64>, F> Faulty<S, F> {
    /// As it is.
    pub(crate) fn new(system: S) -> Self {
        let (displace, vector) = (S::displace, S::hamiltonian_vector);
        Self { system, energy: 0.0, displace, vector, casimirs: S::casimirs, fault: PhantomData }
    }

    /// With an energy that is so much too large.
    pub(crate) fn with_energy(self, energy: f64) -> Self {
        Self { energy, ..self }
    }

    /// With other displacements.
    pub(crate) fn with_displacement(self, displace: Displace<S>) -> Self {
        Self { displace, ..self }
    }

    /// With other Hamiltonian vectors.
    pub(crate) fn with_vector(self, vector: Vector<S>) -> Self {
        Self { vector, ..self }
    }

    /// With other Casimirs.
    pub(crate) fn with_casimirs(self, casimirs: Casimirs<S>) -> Self {
        Self { casimirs, ..self }
    }
}

impl<S: Geometry<Scalar = f64>, F> System for Faulty<S, F> {
    type Scalar = f64;
    type State = S::State;
    type StateComponents<T: Scalar> = S::StateComponents<T>;
    type Control = S::Control;
    type ControlComponents<T: Scalar> = S::ControlComponents<T>;
    type Parameters<T: Scalar> = S::Parameters<T>;
    type Casimirs = S::Casimirs;
    type Momentum = S::Momentum;
    type Standard<R> = S::Standard<R>;

    const NAME: &'static str = "Bent";
    const PARAMETERS: &'static [Quantity] = S::PARAMETERS;
    const CASIMIRS: &'static [&'static str] = S::CASIMIRS;
    const AUTONOMOUS: bool = S::AUTONOMOUS;
    const INVARIANT: bool = S::INVARIANT;
    const FORCED: bool = S::FORCED;
    const SIDE: Side = S::SIDE;

    fn to_parameters(&self) -> S::Parameters<f64> {
        self.system.to_parameters()
    }
    fn from_parameters(parameters: &S::Parameters<f64>) -> Self {
        Self::new(S::from_parameters(parameters))
    }
    fn validate(&self) -> Result<(), ParameterError> {
        self.system.validate()
    }
    fn energy_at(&self, state: &S::State, time: f64, control: &S::Control) -> f64 {
        self.system.energy_at(state, time, control) * (1.0 + self.energy)
    }
    fn velocity_at(&self, state: &S::State, time: f64, control: &S::Control) -> S::Momentum {
        self.system.velocity_at(state, time, control)
    }
    fn momentum(&self, state: &S::State) -> S::Momentum {
        self.system.momentum(state)
    }
    fn with_momentum(&self, state: &S::State, momentum: &S::Momentum) -> S::State {
        self.system.with_momentum(state, momentum)
    }
    fn momentum_of(
        &self,
        velocity: &S::Momentum,
        state: &S::State,
        time: f64,
        control: &S::Control,
    ) -> Result<S::Momentum, LegendreError> {
        self.system.momentum_of(velocity, state, time, control)
    }
    fn velocity_of(
        &self,
        momentum: &S::Momentum,
        state: &S::State,
        time: f64,
        control: &S::Control,
    ) -> Result<S::Momentum, LegendreError> {
        self.system.velocity_of(momentum, state, time, control)
    }
    fn casimirs(&self, state: &S::State) -> S::Casimirs {
        (self.casimirs)(&self.system, state)
    }
    fn spatial_momentum(&self, state: &S::State) -> S::Momentum {
        self.system.spatial_momentum(state)
    }
}

impl<S: Geometry<Scalar = f64>, F> Geometry for Faulty<S, F> {
    type Tangent = S::Tangent;

    fn displace(&self, state: &S::State, map: RetractionKind, by: &S::Tangent) -> S::State {
        (self.displace)(&self.system, state, map, by)
    }
    fn differential(&self, state: &S::State, time: f64, control: &S::Control) -> S::Tangent {
        self.system.differential(state, time, control)
    }
    fn hamiltonian_vector(&self, state: &S::State, covector: &S::Tangent) -> S::Tangent {
        (self.vector)(&self.system, state, covector)
    }
    fn force(&self, state: &S::State, time: f64, control: &S::Control) -> S::Tangent {
        self.system.force(state, time, control)
    }
}
