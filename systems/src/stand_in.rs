//! PROVISIONAL: the two systems by hand (momentum kicks around a free Cayley step), until the macro makes them.

use crate::catalogue::Catalogued;
use coadjoint::__private::{Evaluation, Kernel, Quantity, Scalar};
use coadjoint::prelude::*;

#[derive(Clone, Debug, PartialEq)]
pub struct HeavyTop {
    pub inertia: Vector3<f64>,
    pub weight: f64,
    pub chi: Vector3<f64>,
}
#[derive(Clone, Debug, PartialEq)]
pub struct HeavyTopState {
    pub attitude: UnitQuaternion<f64>,
    pub momentum: Vector3<f64>,
    pub gamma: Vector3<f64>,
}
#[derive(Clone, Debug, PartialEq)]
pub struct FreeRigidBody {
    pub inertia: Vector3<f64>,
}
#[derive(Clone, Debug, PartialEq)]
pub struct FreeRigidBodyState {
    pub attitude: UnitQuaternion<f64>,
    pub momentum: Vector3<f64>,
}

const XYZ: &[&str] = &["x", "y", "z"];
const ATTITUDE: Quantity = Quantity { name: "attitude", components: &["w", "x", "y", "z"], doc: "" };
const MOMENTUM: Quantity = Quantity { name: "momentum", components: XYZ, doc: "" };
const INERTIA: Quantity = Quantity {
    name: "inertia",
    components: XYZ,
    doc: "Principal moments of inertia about the fixed point, kg m².",
};

impl State for HeavyTopState {
    type Scalar = f64;
    type Components = [f64; 10];
    const QUANTITIES: &'static [Quantity] =
        &[ATTITUDE, MOMENTUM, Quantity { name: "gamma", components: XYZ, doc: "the vertical" }];
    fn to_components(&self) -> [f64; 10] {
        let (q, p, g) = (&self.attitude, &self.momentum, &self.gamma);
        [q.w, q.i, q.j, q.k, p.x, p.y, p.z, g.x, g.y, g.z]
    }
    fn from_components(&[w, i, j, k, x, y, z, a, b, c]: &[f64; 10]) -> Self {
        Self {
            attitude: UnitQuaternion::new_unchecked(Quaternion::new(w, i, j, k)),
            momentum: Vector3::new(x, y, z),
            gamma: Vector3::new(a, b, c),
        }
    }
}
impl State for FreeRigidBodyState {
    type Scalar = f64;
    type Components = [f64; 7];
    const QUANTITIES: &'static [Quantity] = &[ATTITUDE, MOMENTUM];
    fn to_components(&self) -> [f64; 7] {
        let (q, p) = (&self.attitude, &self.momentum);
        [q.w, q.i, q.j, q.k, p.x, p.y, p.z]
    }
    fn from_components(&[w, i, j, k, x, y, z]: &[f64; 7]) -> Self {
        Self {
            attitude: UnitQuaternion::new_unchecked(Quaternion::new(w, i, j, k)),
            momentum: Vector3::new(x, y, z),
        }
    }
}
impl System for HeavyTop {
    type Scalar = f64;
    type State = HeavyTopState;
    type StateComponents<T: Scalar> = [T; 10];
    type Parameters<T: Scalar> = [T; 7];
    type Casimirs = [f64; 2];
    type Momentum = Vector3<f64>;
    const NAME: &'static str = "HeavyTop";
    const PARAMETERS: &'static [Quantity] = &[
        INERTIA,
        Quantity { name: "weight", components: &[""], doc: "Mass times gravitational acceleration, N." },
        Quantity {
            name: "chi",
            components: XYZ,
            doc: "From the fixed point to the centre of mass, in body axes, m.",
        },
    ];
    const CASIMIRS: &'static [&'static str] = &["|gamma|²", "momentum·gamma"];
    fn to_parameters(&self) -> [f64; 7] {
        let (i, c) = (&self.inertia, &self.chi);
        [i.x, i.y, i.z, self.weight, c.x, c.y, c.z]
    }
    fn from_parameters(&[a, b, c, weight, x, y, z]: &[f64; 7]) -> Self {
        Self { inertia: vector![a, b, c], weight, chi: vector![x, y, z] }
    }
    fn validate(&self) -> Result<(), ParameterError> {
        coadjoint::inertia::require_positive_definite("inertia", self.inertia.as_slice())
    }
    fn energy(&self, s: &HeavyTopState) -> f64 {
        0.5 * s.momentum.dot(&s.momentum.component_div(&self.inertia)) + self.weight * s.gamma.dot(&self.chi)
    }
    fn casimirs(&self, s: &HeavyTopState) -> [f64; 2] {
        [s.gamma.norm_squared(), s.momentum.dot(&s.gamma)]
    }
    fn spatial_momentum(&self, s: &HeavyTopState) -> Vector3<f64> {
        s.attitude * s.momentum
    }
}
impl System for FreeRigidBody {
    type Scalar = f64;
    type State = FreeRigidBodyState;
    type StateComponents<T: Scalar> = [T; 7];
    type Parameters<T: Scalar> = [T; 3];
    type Casimirs = [f64; 1];
    type Momentum = Vector3<f64>;
    const NAME: &'static str = "FreeRigidBody";
    const PARAMETERS: &'static [Quantity] = &[INERTIA];
    const CASIMIRS: &'static [&'static str] = &["|momentum|²"];
    fn to_parameters(&self) -> [f64; 3] {
        self.inertia.into()
    }
    fn from_parameters(p: &[f64; 3]) -> Self {
        Self { inertia: (*p).into() }
    }
    fn validate(&self) -> Result<(), ParameterError> {
        coadjoint::inertia::require_positive_definite("inertia", self.inertia.as_slice())
    }
    fn energy(&self, s: &FreeRigidBodyState) -> f64 {
        0.5 * s.momentum.dot(&s.momentum.component_div(&self.inertia))
    }
    fn casimirs(&self, s: &FreeRigidBodyState) -> [f64; 1] {
        [s.momentum.norm_squared()]
    }
    fn spatial_momentum(&self, s: &FreeRigidBodyState) -> Vector3<f64> {
        s.attitude * s.momentum
    }
}

/// Any state beginning with attitude and momentum, perhaps gamma after them.
#[derive(Clone, Copy)]
pub struct Splitting<T, const P: usize, const N: usize> {
    scaled: [T; 3],
    kick: [T; 3],
    symmetric: bool,
    marker: core::marker::PhantomData<([T; P], [T; N])>,
}
impl<T: Scalar, const P: usize, const N: usize> Splitting<T, P, N> {
    fn kicked(&self, s: &[T; N]) -> [T; 3] {
        let p = [s[4], s[5], s[6]];
        if N < 10 {
            return p;
        }
        let k = cross(&[s[N - 3], s[N - 2], s[N - 1]], &self.kick);
        core::array::from_fn(|i| p[i] + k[i])
    }
}
impl<T: Scalar, const P: usize, const N: usize> Kernel<T> for Splitting<T, P, N> {
    type Parameters = [T; P];
    type State = [T; N];
    type Unknown = [T; 3];
    type Step = [T; 3];
    type Iterate = ();
    fn new(p: &[T; P], h: T) -> Self {
        let kick =
            if P > 3 { core::array::from_fn(|i| T::of(0.5) * h * p[P - 4] * p[P - 3 + i]) } else { [h; 3] };
        Self { scaled: core::array::from_fn(|i| p[i] / h), kick, symmetric: true, marker: Default::default() }
    }
    fn begin(&self, s: &[T; N]) -> [T; 3] {
        self.kicked(s)
    }
    fn start(&self, s: &[T; N]) -> [T; 3] {
        core::array::from_fn(|i| s[4 + i] / self.scaled[i])
    }
    fn evaluate(&self, _: &[T; N], right: &[T; 3], eta: &[T; 3]) -> Evaluation<[T; 3], ()> {
        let m: [T; 3] = core::array::from_fn(|i| self.scaled[i] * eta[i]);
        let turn = cross(eta, &m);
        let along = T::of(0.25) * dot(eta, &m);
        let residual = core::array::from_fn(|i| m[i] + T::of(0.5) * turn[i] + along * eta[i] - right[i]);
        Evaluation { residual, right: *right, iterate: () }
    }
    fn correction(&self, _: &[T; N], _: &[T; 3], eta: &[T; 3], e: &Evaluation<[T; 3], ()>) -> [T; 3] {
        let m: [T; 3] = core::array::from_fn(|i| self.scaled[i] * eta[i]);
        let column = |j: usize| -> [T; 3] {
            let e: [T; 3] = core::array::from_fn(|i| T::of(if i == j { 1.0 } else { 0.0 }));
            let dm: [T; 3] = core::array::from_fn(|i| self.scaled[i] * e[i]);
            let (first, second) = (cross(&e, &m), cross(eta, &dm));
            let (product, dproduct) = (dot(eta, &m), dot(&e, &m) + dot(eta, &dm));
            core::array::from_fn(|i| {
                dm[i]
                    + T::of(0.5) * (first[i] + second[i])
                    + T::of(0.25) * (dproduct * eta[i] + product * e[i])
            })
        };
        let (a, b, c, r) = (column(0), column(1), column(2), &e.residual);
        let d = dot(&a, &cross(&b, &c));
        [dot(r, &cross(&b, &c)) / d, dot(&a, &cross(r, &c)) / d, dot(&a, &cross(&b, r)) / d]
    }
    fn domain(&self, _: &[T; 3], _: &Evaluation<[T; 3], ()>) -> T {
        T::of(1.0)
    }
    fn finish(&self, s: &[T; N], p: &[T; 3], eta: &[T; 3], _: &Evaluation<[T; 3], ()>) -> [T; N] {
        let half = eta.map(|component| T::of(0.5) * component);
        let length = (T::of(1.0) + dot(&half, &half)).sqrt();
        let (c, v) = (T::of(1.0) / length, half.map(|component| component / length));
        let u = [s[1], s[2], s[3]];
        let turn = cross(&u, &v);
        let mut next = *s;
        next[0] = s[0] * c - dot(&u, &v);
        let back = |p: &[T; 3]| -> [T; 3] {
            let inner = cross(&v, p);
            let inner: [T; 3] = core::array::from_fn(|n| c * p[n] - inner[n]);
            let outer = cross(&v, &inner);
            core::array::from_fn(|n| p[n] - T::of(2.0) * outer[n])
        };
        let p = back(p);
        for n in 0..3 {
            next[1 + n] = s[0] * v[n] + c * u[n] + turn[n];
            next[4 + n] = p[n];
        }
        if N >= 10 {
            let g = back(&[s[N - 3], s[N - 2], s[N - 1]]);
            next[N - 3..].copy_from_slice(&g);
        }
        let p = self.kicked(&next);
        next[4..7].copy_from_slice(&p);
        let _ = self.symmetric;
        next
    }
}
fn dot<T: Scalar>(a: &[T; 3], b: &[T; 3]) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
fn cross<T: Scalar>(a: &[T; 3], b: &[T; 3]) -> [T; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
impl Discretized<Cayley> for HeavyTop {
    type Kernel<T: Scalar> = Splitting<T, 7, 10>;
}
impl Discretized<Exponential> for HeavyTop {
    type Kernel<T: Scalar> = Splitting<T, 7, 10>;
}
impl Discretized<Cayley> for FreeRigidBody {
    type Kernel<T: Scalar> = Splitting<T, 3, 7>;
}
impl Discretized<Exponential> for FreeRigidBody {
    type Kernel<T: Scalar> = Splitting<T, 3, 7>;
}
impl Catalogued for HeavyTop {
    const ABOUT: &'static str = "a rigid body that turns about a fixed point under gravity";
    const STEP: f64 = 0.01;
    const DURATION: f64 = 60.0;
    const CASIMIR_UNITS: &'static [&'static str] = &["", "kg m²/s"];

    /// The top of the paper's figure 6.2.
    fn example() -> (Self, HeavyTopState) {
        let top = HeavyTop { inertia: vector![1.0, 10.0, 100.0], weight: 1.0, chi: Vector3::z() };
        let start = HeavyTopState {
            attitude: UnitQuaternion::identity(),
            momentum: vector![1.0, 1.0, 1.0],
            gamma: Vector3::z(),
        };
        (top, start)
    }

    fn body_inertia(&self) -> Option<Matrix3<f64>> {
        Some(Matrix3::from_diagonal(&self.inertia))
    }
}

impl Catalogued for FreeRigidBody {
    const ABOUT: &'static str = "a rigid body on which nothing acts";
    const STEP: f64 = 0.01;
    const DURATION: f64 = 60.0;
    const CASIMIR_UNITS: &'static [&'static str] = &["kg² m⁴/s²"];

    /// A brick turning close to its middle axis: it flips over, again and again.
    fn example() -> (Self, FreeRigidBodyState) {
        let body = FreeRigidBody { inertia: vector![1.0, 2.0, 2.5] };
        let start =
            FreeRigidBodyState { attitude: UnitQuaternion::identity(), momentum: vector![0.01, 2.0, 0.01] };
        (body, start)
    }

    fn body_inertia(&self) -> Option<Matrix3<f64>> {
        Some(Matrix3::from_diagonal(&self.inertia))
    }
}
