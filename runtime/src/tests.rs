//! Systems for this crate's own tests: a free rigid body, a driven oscillator whose steps are explicit, and the code of a step that is solved by
//! fixed-point iteration.

use nalgebra::{Vector1, Vector3};

use crate::kernel::{Evaluation, Kernel};
use crate::lie_poisson_system;
use crate::scalar::Scalar;

/// A free rigid body.
#[lie_poisson_system(group = SO3)]
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Body {
    #[inertia]
    pub(crate) inertia: Vector3<f64>,
}

/// `q' = p/m`, `p' = −k q + a sin t + u` on the line, with the control `u`.
#[lie_poisson_system(
    group = R1,
    potential = stiffness * position.x.powi(2) / 2.0 - drive * t.sin() * position.x,
    control(push: R1),
    force = push,
)]
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Oscillator {
    #[inertia]
    pub(crate) mass: f64,
    pub(crate) stiffness: f64,
    pub(crate) drive: f64,
}

impl Oscillator {
    /// The motion without control that starts from rest at time 0.
    pub(crate) fn exact(&self, time: f64) -> OscillatorState {
        let own = (self.stiffness / self.mass).sqrt();
        let amplitude = self.drive / (self.stiffness - self.mass);
        OscillatorState::new(
            amplitude * (time.sin() - (own * time).sin() / own),
            self.mass * amplitude * (time.cos() - (own * time).cos()),
        )
    }
}

impl OscillatorState {
    pub(crate) const REST: Self = Self::new(0.0, 0.0);

    pub(crate) const fn new(position: f64, momentum: f64) -> Self {
        Self { position: Vector1::new(position), momentum: Vector1::new(momentum) }
    }

    pub(crate) fn distance(&self, other: &Self) -> f64 {
        (self.position - other.position).amax().max((self.momentum - other.momentum).amax())
    }
}

impl OscillatorControl {
    pub(crate) const fn new(push: f64) -> Self {
        Self { push: Vector1::new(push) }
    }
}

/// Euler's equations `m' = m × v`, `v = 𝓘⁻¹ m`, by the midpoint rule; the unknown is the change of `m`.
#[derive(Clone, Copy)]
pub(crate) struct Midpoint<T> {
    step: T,
    inverse: [T; 3],
}

impl<T: Scalar> Kernel<T> for Midpoint<T> {
    type Parameters = [T; 3];
    type State = [T; 3];
    type Control = [T; 0];
    type Unknown = [T; 3];
    type Step = [T; 0];
    type Iterate = ();
    type Places<X: Scalar> = [X; 1];

    const BLOCKS: &'static [usize] = &[3];

    fn new(parameters: &[T; 3], step: T) -> Self {
        Self { step, inverse: parameters.map(|moment| T::of(1.0) / moment) }
    }

    fn begin(&self, _: &[T; 3], _: T, _: &[T; 0]) -> [T; 0] {
        []
    }

    fn start(&self, _: &[T; 3], _: &[T; 0]) -> [T; 3] {
        [T::of(0.0); 3]
    }

    #[inline(always)]
    fn evaluate(&self, state: &[T; 3], _: &[T; 0], change: &[T; 3]) -> Evaluation<[T; 3], ()> {
        let half = T::of(0.5);
        let [a, b, c]: [T; 3] = [0, 1, 2].map(|i| half.mul_add(change[i], state[i]));
        let [u, v, w] = [a * self.inverse[0], b * self.inverse[1], c * self.inverse[2]];
        let turned = [c.neg_mul_add(v, b * w), a.neg_mul_add(w, c * u), b.neg_mul_add(u, a * v)];
        let right = turned.map(|x| self.step * x);
        Evaluation { residual: [0, 1, 2].map(|i| change[i] - right[i]), right, iterate: () }
    }

    fn correction(&self, _: &[T; 3], _: &[T; 0], _: &[T; 3], evaluation: &Evaluation<[T; 3], ()>) -> [T; 3] {
        evaluation.residual
    }

    #[inline(always)]
    fn fixed_point_update(
        &self,
        _: &[T; 3],
        _: &[T; 0],
        _: &[T; 3],
        evaluation: &Evaluation<[T; 3], ()>,
    ) -> [T; 3] {
        evaluation.right
    }

    #[inline(always)]
    fn finish(&self, state: &[T; 3], _: &[T; 0], change: &[T; 3], _: &Evaluation<[T; 3], ()>) -> [T; 3] {
        [0, 1, 2].map(|i| state[i] + change[i])
    }
}
