//! A free rigid body written out by hand with the Cayley map: what the macro would emit, for this crate's own tests.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

use crate::error::ParameterError;
use crate::inertia::{require_finite, require_positive_definite};
use crate::kernel::{Evaluation, Kernel};
use crate::retraction::Cayley;
use crate::scalar::Scalar;
use crate::system::{Generated, Quantity, State, System};

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
        Quantity { name: "attitude", components: &["w", "x", "y", "z"], doc: "" },
        Quantity { name: "momentum", components: &["x", "y", "z"], doc: "" },
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

impl System for Body {
    type Scalar = f64;
    type State = BodyState;
    type StateComponents<T: Scalar> = [T; 7];
    type Parameters<T: Scalar> = [T; 3];
    type Casimirs = [f64; 1];
    type Momentum = Vector3<f64>;

    const NAME: &'static str = "Body";
    const PARAMETERS: &'static [Quantity] =
        &[Quantity { name: "inertia", components: &["x", "y", "z"], doc: "" }];
    const CASIMIRS: &'static [&'static str] = &["|momentum|²"];

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

    fn energy(&self, state: &BodyState) -> f64 {
        0.5 * state.momentum.dot(&state.momentum.component_div(&self.inertia))
    }

    fn casimirs(&self, state: &BodyState) -> [f64; 1] {
        [state.momentum.norm_squared()]
    }

    fn spatial_momentum(&self, state: &BodyState) -> Vector3<f64> {
        state.attitude * state.momentum
    }
}

impl Generated<Cayley> for Body {
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
    type Unknown = [T; 3];
    type Step = ();
    type Iterate = ();

    fn new(parameters: &[T; 3], step: T) -> Self {
        Self { scaled: parameters.map(|moment| moment / step) }
    }

    fn begin(&self, _: &[T; 7]) {}

    fn start(&self, &[.., x, y, z]: &[T; 7]) -> [T; 3] {
        let [a, b, c] = self.scaled;
        [x / a, y / b, z / c]
    }

    fn evaluate(&self, &[.., x, y, z]: &[T; 7], _: &(), eta: &[T; 3]) -> Evaluation<[T; 3], ()> {
        let half = T::of(0.5);
        let m: [T; 3] = core::array::from_fn(|i| self.scaled[i] * eta[i]);
        let turn = cross(eta, &m);
        let along = T::of(0.25) * dot(eta, &m);
        let right = [x, y, z];
        let residual = core::array::from_fn(|i| m[i] + half * turn[i] + along * eta[i] - right[i]);
        Evaluation { residual, right, iterate: () }
    }

    fn correction(&self, _: &[T; 7], _: &(), eta: &[T; 3], evaluation: &Evaluation<[T; 3], ()>) -> [T; 3] {
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

    fn domain(&self, _: &[T; 3], _: &Evaluation<[T; 3], ()>) -> T {
        T::of(1.0)
    }

    fn finish(
        &self,
        &[w, i, j, k, x, y, z]: &[T; 7],
        _: &(),
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
