//! Classical integrators, to compare structure-preserving ones with.
//!
//! A crate of their own, because they are timed. What is generic is compiled with the crate that calls it; where that is done
//! incrementally, functions are inlined by LLVM alone, and these steps take up to 1.8 times as long. The runs of [`Timed`] are
//! compiled here, and not incrementally.
//!
//! All are one-step methods of constant step `h` behind one trait, [`Integrator`], for three kinds of systems:
//!
//! | system | state | methods |
//! |---|---|---|
//! | [`VectorField`], `x' = f(t, x)` | `SVector<f64, N>` | [`RungeKutta`] of any [`Tableau`], also [`Projected`] |
//! | [`Partitioned`], `q' = f₁`, `p' = f₂` | [`PhasePoint`] | [`PartitionedRungeKutta`] of any [`PartitionedTableau`] |
//! | [`OnSo3`], `R' = R ω̂`, `y' = f` | [`AttitudeState`] | [`Rk4Quaternion`], [`Rkmk4`], written by hand |
//!
//! [`generic`] is the yardstick of another kind: coadjoint's own discrete steps on any matrix Lie group, written the ordinary way.
//!
//! Tableaux are exact: they know their order, whether they are symplectic, symmetric or explicit.
//!
//! The sources cited as HNW and HLW are E. Hairer, S. P. Nørsett and G. Wanner, *Solving Ordinary Differential Equations I* (1993),
//! and E. Hairer, C. Lubich and G. Wanner, *Geometric Numerical Integration* (2006). Numbers of equations are those of V. Vivek,
//! D. Martín de Diego and R. N. Banavar, *A Geometric Approach to Structure-Preserving Integrators for Mechanical Systems* (2026).

pub mod bodies;
pub mod generic;

mod attitude;
mod exact;
mod projected;
mod runge_kutta;
mod stages;
mod tableau;
#[cfg(test)]
mod tests;

use nalgebra::SVector;
use thiserror::Error;

pub use attitude::{AttitudeState, OnSo3, Rk4Quaternion, Rkmk4};
pub use exact::{Exact, Rational};
pub use projected::{Projected, unit_leading};
pub use runge_kutta::{Partitioned, PartitionedRungeKutta, PhasePoint, RungeKutta, Split};
pub use tableau::{PartitionedTableau, Tableau};

/// The right-hand side `f` of `x' = f(t, x)` on `R^N`. Closures are vector fields.
pub trait VectorField<const N: usize> {
    /// `f(t, x)`.
    fn at(&self, time: f64, x: &SVector<f64, N>) -> SVector<f64, N>;
}

impl<const N: usize, F: Fn(f64, &SVector<f64, N>) -> SVector<f64, N>> VectorField<N> for F {
    #[inline]
    fn at(&self, time: f64, x: &SVector<f64, N>) -> SVector<f64, N> {
        self(time, x)
    }
}

/// What can be said of a method without a system.
pub trait Method {
    /// Its usual name.
    fn name(&self) -> &'static str;
    /// Its order `p`: the error at a fixed time is `O(h^p)` for smooth systems.
    fn order(&self) -> u32;
}

/// A one-step method, for systems `S` with states `X`.
pub trait Integrator<S: ?Sized, X>: Method {
    /// The state at `time + h`, from that at `time`. The step may be negative.
    ///
    /// # Errors
    /// If the new state is not finite, or an implicit equation could not be solved.
    fn step(&self, system: &S, time: f64, state: &X, h: f64) -> Result<X, Diverged>;
}

/// A step that did not lead to a state.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum Diverged {
    /// The new state is infinite somewhere or not a number.
    #[error("the state after the step is not finite")]
    NotFinite,
    /// Newton's iteration did not solve the stages' equations: the step is too large, or there is no solution.
    #[error(
        "no convergence after {iterations} iterations, last correction {correction:e}; try a smaller step"
    )]
    NoConvergence {
        /// Corrections made.
        iterations: u32,
        /// Size of the last one, relative to the state; not a number if none led to a finite state.
        correction: f64,
    },
}

/// Takes `steps` steps from `state` at `time`, and returns the last state.
///
/// `visit(k, time + k h, state)` is called for the initial state and after every step; times are not accumulated, so that they do not
/// drift.
///
/// # Errors
/// Those of the first step that fails; `visit` has seen all states before it.
///
/// ```
/// use coadjoint_classical::{RungeKutta, Tableau, integrate};
/// use nalgebra::Vector2;
///
/// let oscillator = |_: f64, x: &Vector2<f64>| Vector2::new(x[1], -x[0]);
/// let mut worst: f64 = 0.0;
/// let rk4 = RungeKutta::from(Tableau::rk4());
/// integrate(&rk4, &oscillator, 0.0, Vector2::new(1.0, 0.0), 0.01, 1_000, |_, time, x| {
///     worst = worst.max((x[0] - time.cos()).abs());
/// })?;
/// assert!(worst < 1e-8);
/// # Ok::<(), coadjoint_classical::Diverged>(())
/// ```
#[inline]
pub fn integrate<I, S, X>(
    method: &I,
    system: &S,
    time: f64,
    mut state: X,
    h: f64,
    steps: u64,
    mut visit: impl FnMut(u64, f64, &X),
) -> Result<X, Diverged>
where
    I: Integrator<S, X> + ?Sized,
    S: ?Sized,
{
    visit(0, time, &state);
    for k in 0..steps {
        state = method.step(system, time + k as f64 * h, &state, h)?;
        visit(k + 1, time + (k + 1) as f64 * h, &state);
    }
    Ok(state)
}

/// A method for a system that does not depend on time, with its runs compiled in this crate: these can be timed.
pub trait Timed<S, X>: Integrator<S, X> {
    /// Takes `steps` steps from `state`, and returns the last state.
    ///
    /// # Errors
    /// Those of the first step that fails.
    fn run(&self, system: &S, state: X, h: f64, steps: u64) -> Result<X, Diverged>;
}

macro_rules! runs {
    ($($Method:ty, $System:ty, $State:ty;)*) => {$(
        impl Timed<$System, $State> for $Method {
            #[inline(never)]
            fn run(&self, system: &$System, state: $State, h: f64, steps: u64) -> Result<$State, Diverged> {
                integrate(self, system, 0.0, state, h, steps, |_, _, _| {})
            }
        }
    )*};
}

runs! {
    Rk4Quaternion, bodies::RigidBody, AttitudeState<3>;
    Rk4Quaternion, bodies::HeavyTop, AttitudeState<6>;
    Rkmk4, bodies::RigidBody, AttitudeState<3>;
    Rkmk4, bodies::HeavyTop, AttitudeState<6>;
}

/// Whether all components are finite. Without branches: this is on the path of steps of few nanoseconds.
#[inline]
fn is_finite<const N: usize>(x: &SVector<f64, N>) -> bool {
    x.iter().fold(true, |finite, component| finite & component.is_finite())
}

/// The state, if it is finite.
#[inline]
fn finite<const N: usize>(x: SVector<f64, N>) -> Result<SVector<f64, N>, Diverged> {
    if is_finite(&x) { Ok(x) } else { Err(Diverged::NotFinite) }
}
