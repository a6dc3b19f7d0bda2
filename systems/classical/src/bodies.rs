//! Rigid bodies written by hand, with principal moments of inertia.

use nalgebra::{UnitQuaternion, Vector3, Vector6};

use super::OnSo3;

/// The free rigid body: `Π' = Π × ω` with `ω = 𝓘⁻¹Π`, and `y = Π`, the angular momentum in body axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidBody {
    inverse_inertia: Vector3<f64>,
}

impl RigidBody {
    /// The body with these principal moments of inertia, which must not be zero.
    pub fn new(inertia: Vector3<f64>) -> Self {
        Self { inverse_inertia: inertia.map(f64::recip) }
    }

    /// `½ Π·𝓘⁻¹Π`. With `|Π|²`, all that the motion of `Π` preserves.
    pub fn energy(&self, momentum: &Vector3<f64>) -> f64 {
        0.5 * momentum.dot(&momentum.component_mul(&self.inverse_inertia))
    }
}

impl OnSo3<3> for RigidBody {
    #[inline]
    fn velocity(&self, _: f64, _: &UnitQuaternion<f64>, y: &Vector3<f64>) -> Vector3<f64> {
        y.component_mul(&self.inverse_inertia)
    }

    #[inline]
    fn rate(&self, _: f64, _: &UnitQuaternion<f64>, y: &Vector3<f64>) -> Vector3<f64> {
        y.cross(&y.component_mul(&self.inverse_inertia))
    }
}

/// The heavy top: `Π' = Π × ω + w Γ × χ`, `Γ' = Γ × ω` with `ω = 𝓘⁻¹Π`, and `y = (Π, Γ)`, the angular momentum and the vertical in body
/// axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeavyTop {
    inverse_inertia: Vector3<f64>,
    weight_chi: Vector3<f64>,
}

impl HeavyTop {
    /// The top with these principal moments of inertia about the fixed point, which must not be zero, this weight `w = mg`, and the
    /// vector `χ` from the fixed point to the centre of mass.
    pub fn new(inertia: Vector3<f64>, weight: f64, chi: Vector3<f64>) -> Self {
        Self { inverse_inertia: inertia.map(f64::recip), weight_chi: chi * weight }
    }

    /// `½ Π·𝓘⁻¹Π + w Γ·χ`. With `|Γ|²` and `Π·Γ`, all that the motion of every top preserves.
    pub fn energy(&self, y: &Vector6<f64>) -> f64 {
        let (momentum, gamma) = halves(y);
        0.5 * momentum.dot(&momentum.component_mul(&self.inverse_inertia)) + gamma.dot(&self.weight_chi)
    }
}

impl OnSo3<6> for HeavyTop {
    #[inline]
    fn velocity(&self, _: f64, _: &UnitQuaternion<f64>, y: &Vector6<f64>) -> Vector3<f64> {
        halves(y).0.component_mul(&self.inverse_inertia)
    }

    #[inline]
    fn rate(&self, _: f64, _: &UnitQuaternion<f64>, y: &Vector6<f64>) -> Vector6<f64> {
        let (momentum, gamma) = halves(y);
        let velocity = momentum.component_mul(&self.inverse_inertia);
        let a = momentum.cross(&velocity) + gamma.cross(&self.weight_chi);
        let b = gamma.cross(&velocity);
        Vector6::new(a.x, a.y, a.z, b.x, b.y, b.z)
    }
}

/// `(Π, Γ)`.
#[inline]
fn halves(y: &Vector6<f64>) -> (Vector3<f64>, Vector3<f64>) {
    (Vector3::new(y[0], y[1], y[2]), Vector3::new(y[3], y[4], y[5]))
}
