//! Methods of order 4 on SO(3) × R^M.

use nalgebra::{Quaternion, SVector, UnitQuaternion, Vector3, Vector4};

use super::{Diverged, Integrator, Method, is_finite};

/// A system `R' = R ω̂`, `y' = f` on SO(3) × R^M, where both `ω` and `f` may depend on `t`, `R` and `y`.
///
/// What an implementation does not use costs nothing once it is inlined: methods make attitudes between steps for it alone.
pub trait OnSo3<const M: usize> {
    /// The angular velocity in body axes, `ω(t, R, y)`.
    fn velocity(&self, time: f64, attitude: &UnitQuaternion<f64>, y: &SVector<f64, M>) -> Vector3<f64>;

    /// `f(t, R, y)`.
    fn rate(&self, time: f64, attitude: &UnitQuaternion<f64>, y: &SVector<f64, M>) -> SVector<f64, M>;
}

/// A state of a system [`OnSo3`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AttitudeState<const M: usize> {
    /// `R`, from body axes to those of space.
    pub attitude: UnitQuaternion<f64>,
    /// All other variables.
    pub y: SVector<f64, M>,
}

impl<const M: usize> AttitudeState<M> {
    #[inline]
    fn finite(self) -> Result<Self, Diverged> {
        let finite = is_finite(&self.attitude.coords) & is_finite(&self.y);
        if finite { Ok(self) } else { Err(Diverged::NotFinite) }
    }
}

/// The [classical Runge–Kutta method](super::Tableau::rk4) in the variables `(q, y)` of `R⁴ × R^M`, with `q' = ½ q ω`, and `q` divided by its
/// norm after each step. Order 4.
///
/// The system is asked at `q/|q|` where a stage leaves the sphere.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rk4Quaternion;

impl Rk4Quaternion {
    /// Its usual name.
    pub const NAME: &'static str = "RK4 on unit quaternions";
}

impl Method for Rk4Quaternion {
    fn name(&self) -> &'static str {
        Self::NAME
    }

    fn order(&self) -> u32 {
        4
    }
}

impl<const M: usize, S: OnSo3<M> + ?Sized> Integrator<S, AttitudeState<M>> for Rk4Quaternion {
    #[inline]
    fn step(
        &self,
        system: &S,
        time: f64,
        state: &AttitudeState<M>,
        h: f64,
    ) -> Result<AttitudeState<M>, Diverged> {
        let slopes = |time, q: &Vector4<f64>, y: &SVector<f64, M>| {
            let attitude = UnitQuaternion::new_normalize(Quaternion::from_vector(*q));
            (twice_rate(q, &system.velocity(time, &attitude, y)), system.rate(time, &attitude, y))
        };
        // the ½ of q' = ½ q ω is in the steps for q
        let (half, quarter, middle) = (0.5 * h, 0.25 * h, time + 0.5 * h);
        let (q, y) = (&state.attitude.coords, &state.y);
        let (q1, y1) = slopes(time, q, y);
        let (q2, y2) = slopes(middle, &(q + q1 * quarter), &(y + y1 * half));
        let (q3, y3) = slopes(middle, &(q + q2 * quarter), &(y + y2 * half));
        let (q4, y4) = slopes(time + h, &(q + q3 * half), &(y + y3 * h));
        let q = q + (q1 + (q2 + q3) * 2.0 + q4) * (h / 12.0);
        let y = y + (y1 + (y2 + y3) * 2.0 + y4) * (h / 6.0);
        AttitudeState { attitude: UnitQuaternion::new_normalize(Quaternion::from_vector(q)), y }.finite()
    }
}

/// `q ω`, with the quaternion's scalar part last. Written out, for the compiler must not drop products with zero.
#[inline]
fn twice_rate(q: &Vector4<f64>, velocity: &Vector3<f64>) -> Vector4<f64> {
    let [x, y, z, w] = [q.x, q.y, q.z, q.w];
    let [a, b, c] = [velocity.x, velocity.y, velocity.z];
    Vector4::new(
        w * a + y * c - z * b,
        w * b + z * a - x * c,
        w * c + x * b - y * a,
        -(x * a + y * b + z * c),
    )
}

/// The Runge–Kutta–Munthe-Kaas method on the tableau of [`rk4`](super::Tableau::rk4): in the coordinates `R = R_k exp(θ̂)` about the start of
/// each step, the classical method for `(θ, y)` with
///
/// ```text
/// θ' = (dL exp_θ)⁻¹ ω = ω + ½ θ × ω + (1/12) θ × (θ × ω) + O(|θ|⁴ |ω|)
/// ```
///
/// The attitude stays on its group up to rounding. Order 4.
///
/// The series is cut off after the term of 1/12. That changes `θ'` by `O(h⁴)` where the stages are, `θ = O(h)`, and so a step by `O(h⁵)`,
/// which is the size of its error anyway. (The series has no term of third degree.)
///
/// H. Munthe-Kaas, *High order Runge–Kutta methods on manifolds*, Appl. Numer. Math. 29 (1999); HLW, IV.8.2. Signs there are for
/// `R' = ω̂ R`; with the velocity in body axes `θ̂` changes sign.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rkmk4;

impl Method for Rkmk4 {
    fn name(&self) -> &'static str {
        "RKMK4"
    }

    fn order(&self) -> u32 {
        4
    }
}

impl<const M: usize, S: OnSo3<M> + ?Sized> Integrator<S, AttitudeState<M>> for Rkmk4 {
    #[inline]
    fn step(
        &self,
        system: &S,
        time: f64,
        state: &AttitudeState<M>,
        h: f64,
    ) -> Result<AttitudeState<M>, Diverged> {
        let (start, y) = (&state.attitude, &state.y);
        let slopes = |time, theta: &Vector3<f64>, y: &SVector<f64, M>| {
            let attitude = start * exp(theta);
            let velocity = system.velocity(time, &attitude, y);
            (inverse_exp_derivative(theta, &velocity), system.rate(time, &attitude, y))
        };
        let (half, middle) = (0.5 * h, time + 0.5 * h);
        let (theta1, y1) = (system.velocity(time, start, y), system.rate(time, start, y));
        let (theta2, y2) = slopes(middle, &(theta1 * half), &(y + y1 * half));
        let (theta3, y3) = slopes(middle, &(theta2 * half), &(y + y2 * half));
        let (theta4, y4) = slopes(time + h, &(theta3 * h), &(y + y3 * h));
        let theta = (theta1 + (theta2 + theta3) * 2.0 + theta4) * (h / 6.0);
        let y = y + (y1 + (y2 + y3) * 2.0 + y4) * (h / 6.0);
        AttitudeState { attitude: start * exp(&theta), y }.finite()
    }
}

/// `(dL exp_θ)⁻¹ ω` to second degree in `θ`.
#[inline]
pub(super) fn inverse_exp_derivative(theta: &Vector3<f64>, velocity: &Vector3<f64>) -> Vector3<f64> {
    let once = theta.cross(velocity);
    velocity + once * 0.5 + theta.cross(&once) * (1.0 / 12.0)
}

/// `1/(2k)!` and `1/(2k+1)!` with alternating signs: `cos α` and `sin α / α` in powers of `α²`.
const COSINE: [f64; 7] =
    [1.0, -1.0 / 2.0, 1.0 / 24.0, -1.0 / 720.0, 1.0 / 40_320.0, -1.0 / 3_628_800.0, 1.0 / 479_001_600.0];
const SINC: [f64; 7] = [
    1.0,
    -1.0 / 6.0,
    1.0 / 120.0,
    -1.0 / 5_040.0,
    1.0 / 362_880.0,
    -1.0 / 39_916_800.0,
    1.0 / 6_227_020_800.0,
];

/// Below this `α²`, the polynomials miss less than 1e-17.
const SMALL: f64 = 0.125;

/// The quaternion of `exp(θ̂)`, `(cos α, sin α / α · θ/2)` with `α = |θ|/2`.
#[inline]
pub(super) fn exp(theta: &Vector3<f64>) -> UnitQuaternion<f64> {
    let half = theta * 0.5;
    let square = half.norm_squared();
    let (cosine, sinc) = if square < SMALL {
        let horner = |series: &[f64; 7]| series.iter().rev().fold(0.0, |sum, term| sum * square + term);
        (horner(&COSINE), horner(&SINC))
    } else {
        let angle = square.sqrt();
        let (sine, cosine) = angle.sin_cos();
        (cosine, sine / angle)
    };
    UnitQuaternion::new_unchecked(Quaternion::from_parts(cosine, half * sinc))
}
