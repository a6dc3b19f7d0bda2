//! Systems written out by hand, as the macro would emit them, for this crate's own tests: a free rigid body with the Cayley map,
//! and a driven oscillator whose steps are explicit; and the code of a step that is solved by fixed-point iteration.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use crate::error::ParameterError;
use crate::inertia::{require_finite, require_positive_definite};
use crate::kernel::{Evaluation, Kernel};
use crate::legendre::LegendreError;
use crate::retraction::{Cayley, Exponential};
use crate::scalar::Scalar;
use crate::scheme::{StormerVerlet, SymplecticEulerA, SymplecticEulerB};
use crate::system::{Control, Generated, NoControl, Quantity, Retracted, Role, State, System};

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Body {
    pub(crate) inertia: Vector3<f64>,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct BodyState {
    pub(crate) attitude: UnitQuaternion<f64>,
    pub(crate) momentum: Vector3<f64>,
}

impl State for BodyState {
    type Scalar = f64;
    type Components = [f64; 7];
    const QUANTITIES: &'static [Quantity] = &[
        Quantity { name: "attitude", role: Role::Configuration, components: &["w", "x", "y", "z"], doc: "" },
        Quantity { name: "momentum", role: Role::Momentum, components: &["x", "y", "z"], doc: "" },
    ];

    fn to_components(&self) -> [f64; 7] {
        let (q, p) = (&self.attitude, &self.momentum);
        [q.w, q.i, q.j, q.k, p.x, p.y, p.z]
    }

    fn deviation(&self) -> f64 {
        (self.attitude.as_ref().norm() - 1.0).abs()
    }

    fn from_components(&[w, i, j, k, x, y, z]: &[f64; 7]) -> Self {
        Self {
            attitude: UnitQuaternion::new_unchecked(Quaternion::new(w, i, j, k)),
            momentum: Vector3::new(x, y, z),
        }
    }
}

impl<R> Retracted<R> for Body {
    type Scheme = SymplecticEulerA<R>;
}

impl System for Body {
    type Scalar = f64;
    type State = BodyState;
    type StateComponents<T: Scalar> = [T; 7];
    type Control = NoControl<f64>;
    type ControlComponents<T: Scalar> = [T; 0];
    type Parameters<T: Scalar> = [T; 3];
    type Casimirs = [f64; 1];
    type Momentum = Vector3<f64>;
    type Standard<R> = SymplecticEulerA<R>;

    const NAME: &'static str = "Body";
    const PARAMETERS: &'static [Quantity] =
        &[Quantity { name: "inertia", role: Role::Parameter, components: &["x", "y", "z"], doc: "" }];
    const CASIMIRS: &'static [&'static str] = &["|momentum|²"];
    const AUTONOMOUS: bool = true;
    const INVARIANT: bool = true;
    const FORCED: bool = false;

    fn to_parameters(&self) -> [f64; 3] {
        self.inertia.into()
    }

    fn from_parameters(parameters: &[f64; 3]) -> Self {
        Self { inertia: (*parameters).into() }
    }

    fn validate(&self) -> Result<(), ParameterError> {
        require_finite("inertia", &self.to_parameters())?;
        require_positive_definite("inertia", &self.to_parameters())
    }

    fn energy_at(&self, state: &BodyState, _: f64, _: &NoControl<f64>) -> f64 {
        0.5 * state.momentum.dot(&state.momentum.component_div(&self.inertia))
    }

    fn velocity_at(&self, state: &BodyState, _: f64, _: &NoControl<f64>) -> Vector3<f64> {
        state.momentum.component_div(&self.inertia)
    }

    fn momentum(&self, state: &BodyState) -> Vector3<f64> {
        state.momentum
    }

    fn with_momentum(&self, state: &BodyState, momentum: &Vector3<f64>) -> BodyState {
        BodyState { momentum: *momentum, ..state.clone() }
    }

    fn momentum_of(
        &self,
        velocity: &Vector3<f64>,
        _: &BodyState,
        _: f64,
        _: &NoControl<f64>,
    ) -> Result<Vector3<f64>, LegendreError> {
        Ok(velocity.component_mul(&self.inertia))
    }

    fn velocity_of(
        &self,
        momentum: &Vector3<f64>,
        _: &BodyState,
        _: f64,
        _: &NoControl<f64>,
    ) -> Result<Vector3<f64>, LegendreError> {
        Ok(momentum.component_div(&self.inertia))
    }

    fn casimirs(&self, state: &BodyState) -> [f64; 1] {
        [state.momentum.norm_squared()]
    }

    fn spatial_momentum(&self, state: &BodyState) -> Vector3<f64> {
        state.attitude * state.momentum
    }
}

impl Generated<SymplecticEulerA<Cayley>> for Body {
    type Kernel<T: Scalar> = BodyKernel<T>;
}

/// Solves `μ = m + ½ η × m + ¼ (η·m) η` with `m = 𝓘η/h`; then `μ' = cay(η)ᵀ μ`.
#[derive(Clone, Copy)]
pub(crate) struct BodyKernel<T> {
    /// `𝓘/h`
    scaled: [T; 3],
}

impl<T: Scalar> Kernel<T> for BodyKernel<T> {
    type Parameters = [T; 3];
    type State = [T; 7];
    type Control = [T; 0];
    type Unknown = [T; 3];
    type Step = [T; 0];
    type Iterate = ();
    type Places<X: Scalar> = [X; 1];

    const BLOCKS: &'static [usize] = &[3];
    const HAS_FIXED_POINT_UPDATE: bool = false;

    fn new(parameters: &[T; 3], step: T) -> Self {
        Self { scaled: parameters.map(|moment| moment / step) }
    }

    fn begin(&self, _: &[T; 7], _: T, _: &[T; 0]) -> [T; 0] {
        []
    }

    fn start(&self, &[.., x, y, z]: &[T; 7], _: &[T; 0]) -> [T; 3] {
        let [a, b, c] = self.scaled;
        [x / a, y / b, z / c]
    }

    fn evaluate(&self, &[.., x, y, z]: &[T; 7], _: &[T; 0], eta: &[T; 3]) -> Evaluation<[T; 3], ()> {
        let half = T::of(0.5);
        let m: [T; 3] = core::array::from_fn(|i| self.scaled[i] * eta[i]);
        let turn = cross(eta, &m);
        let along = T::of(0.25) * dot(eta, &m);
        let right = [x, y, z];
        let residual = core::array::from_fn(|i| m[i] + half * turn[i] + along * eta[i] - right[i]);
        Evaluation { residual, right, iterate: () }
    }

    fn correction(
        &self,
        _: &[T; 7],
        _: &[T; 0],
        eta: &[T; 3],
        evaluation: &Evaluation<[T; 3], ()>,
    ) -> [T; 3] {
        // column j of the Jacobian is the derivative of the left side in direction e_j
        let half = T::of(0.5);
        let m: [T; 3] = core::array::from_fn(|i| self.scaled[i] * eta[i]);
        let column = |j: usize| -> [T; 3] {
            let e: [T; 3] = core::array::from_fn(|i| T::of(if i == j { 1.0 } else { 0.0 }));
            let dm: [T; 3] = core::array::from_fn(|i| self.scaled[i] * e[i]);
            let (first, second) = (cross(&e, &m), cross(eta, &dm));
            let product = dot(eta, &m);
            let dproduct = dot(&e, &m) + dot(eta, &dm);
            core::array::from_fn(|i| {
                dm[i] + half * (first[i] + second[i]) + T::of(0.25) * (dproduct * eta[i] + product * e[i])
            })
        };
        let (a, b, c) = (column(0), column(1), column(2));
        let r = &evaluation.residual;
        let determinant = dot(&a, &cross(&b, &c));
        [
            dot(r, &cross(&b, &c)) / determinant,
            dot(&a, &cross(r, &c)) / determinant,
            dot(&a, &cross(&b, r)) / determinant,
        ]
    }

    fn finish(
        &self,
        &[w, i, j, k, x, y, z]: &[T; 7],
        _: &[T; 0],
        eta: &[T; 3],
        _: &Evaluation<[T; 3], ()>,
    ) -> [T; 7] {
        let half = eta.map(|component| T::of(0.5) * component);
        let length = (T::of(1.0) + dot(&half, &half)).sqrt();
        let s = T::of(1.0) / length;
        let v = half.map(|component| component / length);
        // q' = q (s, v)
        let u = [i, j, k];
        let turn = cross(&u, &v);
        let w1 = w * s - dot(&u, &v);
        let [i1, j1, k1] = core::array::from_fn(|n| w * v[n] + s * u[n] + turn[n]);
        // μ' = μ − 2 v × (s μ − v × μ)
        let p = [x, y, z];
        let inner = cross(&v, &p);
        let inner: [T; 3] = core::array::from_fn(|n| s * p[n] - inner[n]);
        let outer = cross(&v, &inner);
        let [x1, y1, z1] = core::array::from_fn(|n| p[n] - T::of(2.0) * outer[n]);
        [w1, i1, j1, k1, x1, y1, z1]
    }
}

fn dot<T: Scalar>(a: &[T; 3], b: &[T; 3]) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross<T: Scalar>(a: &[T; 3], b: &[T; 3]) -> [T; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// `q' = p/m`, `p' = −k q + a sin t + u` on the line, with the control `u`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Oscillator {
    pub(crate) mass: f64,
    pub(crate) stiffness: f64,
    pub(crate) drive: f64,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct OscillatorState {
    pub(crate) position: f64,
    pub(crate) momentum: f64,
}

#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct OscillatorControl {
    pub(crate) force: f64,
}

impl Oscillator {
    /// The motion without control that starts from rest at time 0.
    pub(crate) fn exact(&self, time: f64) -> OscillatorState {
        let own = (self.stiffness / self.mass).sqrt();
        let amplitude = self.drive / (self.stiffness - self.mass);
        OscillatorState {
            position: amplitude * (time.sin() - (own * time).sin() / own),
            momentum: self.mass * amplitude * (time.cos() - (own * time).cos()),
        }
    }
}

impl OscillatorState {
    pub(crate) const REST: Self = Self { position: 0.0, momentum: 0.0 };

    pub(crate) fn distance(&self, other: &Self) -> f64 {
        (self.position - other.position).abs().max((self.momentum - other.momentum).abs())
    }
}

impl State for OscillatorState {
    type Scalar = f64;
    type Components = [f64; 2];
    const QUANTITIES: &'static [Quantity] = &[
        Quantity { name: "position", role: Role::Configuration, components: &[""], doc: "" },
        Quantity { name: "momentum", role: Role::Momentum, components: &[""], doc: "" },
    ];

    fn to_components(&self) -> [f64; 2] {
        [self.position, self.momentum]
    }

    fn from_components(&[position, momentum]: &[f64; 2]) -> Self {
        Self { position, momentum }
    }

    fn deviation(&self) -> f64 {
        0.0
    }
}

impl Control for OscillatorControl {
    type Scalar = f64;
    type Components = [f64; 1];
    const QUANTITIES: &'static [Quantity] =
        &[Quantity { name: "force", role: Role::Control, components: &[""], doc: "" }];

    fn to_components(&self) -> [f64; 1] {
        [self.force]
    }

    fn from_components(&[force]: &[f64; 1]) -> Self {
        Self { force }
    }
}

impl<R> Retracted<R> for Oscillator {
    type Scheme = StormerVerlet<R>;
}

impl System for Oscillator {
    type Scalar = f64;
    type State = OscillatorState;
    type StateComponents<T: Scalar> = [T; 2];
    type Control = OscillatorControl;
    type ControlComponents<T: Scalar> = [T; 1];
    type Parameters<T: Scalar> = [T; 3];
    type Casimirs = [f64; 0];
    type Momentum = f64;
    type Standard<R> = StormerVerlet<R>;

    const NAME: &'static str = "Oscillator";
    const PARAMETERS: &'static [Quantity] = &[
        Quantity { name: "mass", role: Role::Parameter, components: &[""], doc: "" },
        Quantity { name: "stiffness", role: Role::Parameter, components: &[""], doc: "" },
        Quantity { name: "drive", role: Role::Parameter, components: &[""], doc: "" },
    ];
    const CASIMIRS: &'static [&'static str] = &[];
    const AUTONOMOUS: bool = false;
    const INVARIANT: bool = false;
    const FORCED: bool = true;

    fn to_parameters(&self) -> [f64; 3] {
        [self.mass, self.stiffness, self.drive]
    }

    fn from_parameters(&[mass, stiffness, drive]: &[f64; 3]) -> Self {
        Self { mass, stiffness, drive }
    }

    fn validate(&self) -> Result<(), ParameterError> {
        require_positive_definite("mass", &[self.mass])
    }

    fn energy_at(
        &self,
        &OscillatorState { position, momentum }: &OscillatorState,
        time: f64,
        _: &OscillatorControl,
    ) -> f64 {
        0.5 * momentum * momentum / self.mass + 0.5 * self.stiffness * position * position
            - self.drive * time.sin() * position
    }

    fn velocity_at(&self, state: &OscillatorState, _: f64, _: &OscillatorControl) -> f64 {
        state.momentum / self.mass
    }

    fn momentum(&self, state: &OscillatorState) -> f64 {
        state.momentum
    }

    fn with_momentum(&self, state: &OscillatorState, &momentum: &f64) -> OscillatorState {
        OscillatorState { momentum, ..state.clone() }
    }

    fn momentum_of(
        &self,
        velocity: &f64,
        _: &OscillatorState,
        _: f64,
        _: &OscillatorControl,
    ) -> Result<f64, LegendreError> {
        Ok(velocity * self.mass)
    }

    fn velocity_of(
        &self,
        momentum: &f64,
        _: &OscillatorState,
        _: f64,
        _: &OscillatorControl,
    ) -> Result<f64, LegendreError> {
        Ok(momentum / self.mass)
    }

    fn casimirs(&self, _: &OscillatorState) -> [f64; 0] {
        []
    }

    fn spatial_momentum(&self, state: &OscillatorState) -> f64 {
        state.momentum
    }
}

impl Generated<SymplecticEulerA> for Oscillator {
    type Kernel<T: Scalar> = OscillatorKernel<T, false>;
}

impl Generated<SymplecticEulerB<Exponential>> for Oscillator {
    type Kernel<T: Scalar> = OscillatorKernel<T, true>;
}

/// The force acts at the start of the step, or `LATE` at its end; nothing is to be solved.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OscillatorKernel<T, const LATE: bool> {
    parameters: [T; 3],
    step: T,
}

impl<T: Scalar, const LATE: bool> OscillatorKernel<T, LATE> {
    /// The momentum that the force at `position` and `time` gives in a step.
    fn kick(&self, position: T, time: T, &[control]: &[T; 1]) -> T {
        let [_, stiffness, drive] = self.parameters;
        self.step * (drive * time.sin() + control - stiffness * position)
    }
}

impl<T: Scalar, const LATE: bool> Kernel<T> for OscillatorKernel<T, LATE> {
    type Parameters = [T; 3];
    type State = [T; 2];
    type Control = [T; 1];
    type Unknown = [T; 0];
    /// The state after the step.
    type Step = [T; 2];
    type Iterate = ();
    type Places<X: Scalar> = [X; 1];

    const BLOCKS: &'static [usize] = &[];
    const HAS_FIXED_POINT_UPDATE: bool = false;

    fn new(parameters: &[T; 3], step: T) -> Self {
        Self { parameters: *parameters, step }
    }

    fn begin(&self, &[position, momentum]: &[T; 2], time: T, control: &[T; 1]) -> [T; 2] {
        let [mass, ..] = self.parameters;
        if LATE {
            let position = position + self.step * momentum / mass;
            [position, momentum + self.kick(position, time + self.step, control)]
        } else {
            let momentum = momentum + self.kick(position, time, control);
            [position + self.step * momentum / mass, momentum]
        }
    }

    fn start(&self, _: &[T; 2], _: &[T; 2]) -> [T; 0] {
        []
    }

    fn evaluate(&self, _: &[T; 2], _: &[T; 2], _: &[T; 0]) -> Evaluation<[T; 0], ()> {
        Evaluation { residual: [], right: [], iterate: () }
    }

    fn correction(&self, _: &[T; 2], _: &[T; 2], _: &[T; 0], _: &Evaluation<[T; 0], ()>) -> [T; 0] {
        []
    }

    fn finish(&self, _: &[T; 2], next: &[T; 2], _: &[T; 0], _: &Evaluation<[T; 0], ()>) -> [T; 2] {
        *next
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
