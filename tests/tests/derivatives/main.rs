//! Derivatives of steps, systems with controls in their energies, and steps by tangent lifts: apart from [other systems](../systems), so that both
//! are compiled side by side.

mod controlled;
mod derivatives;
mod tangent_lifts;
mod vanishing;
