//! Explicit symplectic methods for separable Hamiltonians.

use nalgebra::SVector;

use super::{Diverged, Integrator, Method, is_finite};

/// A system with the Hamiltonian `H = T(p) + V(t, q)`: `q' = ∇T(p)`, `p' = −∇V(t, q)`.
pub trait Separable<const N: usize> {
    /// `∇T(p)`.
    fn velocity(&self, p: &SVector<f64, N>) -> SVector<f64, N>;

    /// `−∇V(t, q)`.
    fn force(&self, time: f64, q: &SVector<f64, N>) -> SVector<f64, N>;
}

/// A [`Separable`] system given by two closures, `velocity(p)` and `force(t, q)`.
#[derive(Clone, Copy, Debug)]
pub struct Split<V, F> {
    /// `∇T(p)`.
    pub velocity: V,
    /// `−∇V(t, q)`.
    pub force: F,
}

impl<const N: usize, V, F> Separable<N> for Split<V, F>
where
    V: Fn(&SVector<f64, N>) -> SVector<f64, N>,
    F: Fn(f64, &SVector<f64, N>) -> SVector<f64, N>,
{
    #[inline]
    fn velocity(&self, p: &SVector<f64, N>) -> SVector<f64, N> {
        (self.velocity)(p)
    }

    #[inline]
    fn force(&self, time: f64, q: &SVector<f64, N>) -> SVector<f64, N> {
        (self.force)(time, q)
    }
}

/// A point of phase space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhasePoint<const N: usize> {
    /// Position.
    pub q: SVector<f64, N>,
    /// Momentum.
    pub p: SVector<f64, N>,
}

impl<const N: usize> PhasePoint<N> {
    #[inline]
    fn finite(self) -> Result<Self, Diverged> {
        if is_finite(&self.q) & is_finite(&self.p) { Ok(self) } else { Err(Diverged::NotFinite) }
    }
}

/// Symplectic Euler A, (1.9): the momentum first, and the position with the new momentum,
///
/// ```text
/// p_{k+1} = p_k − h ∇V(t_k, q_k),   q_{k+1} = q_k + h ∇T(p_{k+1})
/// ```
///
/// On `R^N` the member `s = 0` of the family of which [`SymplecticEulerB`] is `s = 1`. Symplectic, order 1. HLW, I.1.2.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SymplecticEulerA;

/// Symplectic Euler B, (1.10), the adjoint of [`SymplecticEulerA`]: the position first, and the momentum with the new position,
///
/// ```text
/// q_{k+1} = q_k + h ∇T(p_k),   p_{k+1} = p_k − h ∇V(t_k + h, q_{k+1})
/// ```
///
/// Symplectic, order 1. HLW, I.1.2.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SymplecticEulerB;

/// Störmer–Verlet, kick–drift–kick: half a step of [`SymplecticEulerA`], then half a step of [`SymplecticEulerB`],
///
/// ```text
/// p_{k+½} = p_k − (h/2) ∇V(t_k, q_k)
/// q_{k+1} = q_k + h ∇T(p_{k+½})
/// p_{k+1} = p_{k+½} − (h/2) ∇V(t_k + h, q_{k+1})
/// ```
///
/// Symplectic, symmetric, order 2. HLW, I.1.4.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StormerVerlet;

impl Method for SymplecticEulerA {
    const NAME: &'static str = "symplectic Euler A";
    const ORDER: u32 = 1;
}

impl Method for SymplecticEulerB {
    const NAME: &'static str = "symplectic Euler B";
    const ORDER: u32 = 1;
}

impl Method for StormerVerlet {
    const NAME: &'static str = "Störmer–Verlet";
    const ORDER: u32 = 2;
}

impl<const N: usize, S: Separable<N> + ?Sized> Integrator<S, PhasePoint<N>> for SymplecticEulerA {
    #[inline]
    fn step(&self, system: &S, time: f64, x: &PhasePoint<N>, h: f64) -> Result<PhasePoint<N>, Diverged> {
        let p = x.p + system.force(time, &x.q) * h;
        let q = x.q + system.velocity(&p) * h;
        PhasePoint { q, p }.finite()
    }
}

impl<const N: usize, S: Separable<N> + ?Sized> Integrator<S, PhasePoint<N>> for SymplecticEulerB {
    #[inline]
    fn step(&self, system: &S, time: f64, x: &PhasePoint<N>, h: f64) -> Result<PhasePoint<N>, Diverged> {
        let q = x.q + system.velocity(&x.p) * h;
        let p = x.p + system.force(time + h, &q) * h;
        PhasePoint { q, p }.finite()
    }
}

impl<const N: usize, S: Separable<N> + ?Sized> Integrator<S, PhasePoint<N>> for StormerVerlet {
    #[inline]
    fn step(&self, system: &S, time: f64, x: &PhasePoint<N>, h: f64) -> Result<PhasePoint<N>, Diverged> {
        let half = 0.5 * h;
        let middle = x.p + system.force(time, &x.q) * half;
        let q = x.q + system.velocity(&middle) * h;
        let p = middle + system.force(time + h, &q) * half;
        PhasePoint { q, p }.finite()
    }
}
