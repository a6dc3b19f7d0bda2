//! The geometry of the states: displacements in local coordinates, the Poisson structure, and the motion as a vector field.
//!
//! A tangent vector at a state has, in the order of the state's parts, `δ` for a configuration — the displaced one is `g τ(δ)`, or
//! `τ(δ) g` where `invariance = right` — and the change of a momentum or an advected parameter.
//!
//! Integrators that know nothing of the structure, certificates and linearizations work with these; a
//! [stepper](crate::stepper::Stepper) needs none of them.

use super::System;
use crate::retraction::RetractionKind;
use crate::scalar::{Components, Scalar};

/// The local coordinates and the Poisson structure of a system's states. Implemented by the macro.
pub trait Geometry: System {
    /// A tangent or a cotangent vector.
    type Tangent: Components<Self::Scalar>;

    /// The state displaced by a tangent vector.
    fn displace(&self, state: &Self::State, map: RetractionKind, by: &Self::Tangent) -> Self::State;

    /// The differential `dh` of the energy at a time and with controls: its derivative along each component of a tangent vector.
    fn differential(&self, state: &Self::State, time: Self::Scalar, control: &Self::Control)
    -> Self::Tangent;

    /// The Hamiltonian vector `P(x) α` of a covector `α`: with `α = dh` the motion that the energy `h` makes,
    /// `g' = g ξ`, `(μ, a)' = ad*_(ξ, w) (μ, a) − (∂h/∂g, 0)`, `ξ = ∂h/∂μ`, `w = ∂h/∂a`.
    fn hamiltonian_vector(&self, state: &Self::State, covector: &Self::Tangent) -> Self::Tangent;

    /// The forces, as a tangent vector.
    fn force(&self, state: &Self::State, time: Self::Scalar, control: &Self::Control) -> Self::Tangent;

    /// The motion: the Hamiltonian vector of the energy, and the forces.
    fn motion(&self, state: &Self::State, time: Self::Scalar, control: &Self::Control) -> Self::Tangent {
        let mut motion = self.hamiltonian_vector(state, &self.differential(state, time, control));
        let force = self.force(state, time, control);
        for (component, force) in motion.as_mut().iter_mut().zip(force.as_ref()) {
            *component = *component + *force;
        }
        motion
    }
}

/// A system on which nothing acts: without a potential on the group, advected parameters and forces, so that its momentum on the other side
/// of the configuration is constant: in space if velocities are those of the body, in the body where `invariance = right`. Implemented by
/// the macro.
#[doc(hidden)]
pub trait Isolated: System {
    /// The constant momentum, over any scalar.
    type Conserved<T: Scalar>: Components<T>;
    /// The constant momentum of a state: `Ad*_{g⁻¹} μ`, or `Ad*_g μ` where `invariance = right`.
    fn conserved<T: Scalar>(state: &Self::StateComponents<T>) -> Self::Conserved<T>;
    /// The state with the momentum that belongs to a constant one: `Ad*_g π`, or `Ad*_{g⁻¹} π`.
    fn with_conserved<T: Scalar>(
        state: &Self::StateComponents<T>,
        conserved: &Self::Conserved<T>,
    ) -> Self::StateComponents<T>;
}
