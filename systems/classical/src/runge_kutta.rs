//! Explicit Runge–Kutta methods.

use nalgebra::SVector;

use super::{Diverged, Integrator, Method, VectorField, finite};

/// The explicit Euler method, `x_{k+1} = x_k + h f(t_k, x_k)`: (1.7) for the oscillator. Order 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ExplicitEuler;

/// The explicit midpoint rule of C. Runge (1895), `x_{k+1} = x_k + h f(t_k + h/2, x_k + (h/2) f(t_k, x_k))`. Order 2. HNW, II.1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rk2;

/// The classical Runge–Kutta method of W. Kutta (1901): `x_{k+1} = x_k + (h/6)(f₁ + 2f₂ + 2f₃ + f₄)`, with
///
/// ```text
/// f₁ = f(t_k, x_k)                      f₃ = f(t_k + h/2, x_k + (h/2) f₂)
/// f₂ = f(t_k + h/2, x_k + (h/2) f₁)     f₄ = f(t_k + h,   x_k + h f₃)
/// ```
///
/// Order 4. HNW, II.1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Rk4;

impl Method for ExplicitEuler {
    const NAME: &'static str = "explicit Euler";
    const ORDER: u32 = 1;
}

impl Method for Rk2 {
    const NAME: &'static str = "RK2";
    const ORDER: u32 = 2;
}

impl Method for Rk4 {
    const NAME: &'static str = "RK4";
    const ORDER: u32 = 4;
}

impl<const N: usize, F: VectorField<N> + ?Sized> Integrator<F, SVector<f64, N>> for ExplicitEuler {
    #[inline]
    fn step(&self, field: &F, time: f64, x: &SVector<f64, N>, h: f64) -> Result<SVector<f64, N>, Diverged> {
        finite(x + field.at(time, x) * h)
    }
}

impl<const N: usize, F: VectorField<N> + ?Sized> Integrator<F, SVector<f64, N>> for Rk2 {
    #[inline]
    fn step(&self, field: &F, time: f64, x: &SVector<f64, N>, h: f64) -> Result<SVector<f64, N>, Diverged> {
        let middle = x + field.at(time, x) * (0.5 * h);
        finite(x + field.at(time + 0.5 * h, &middle) * h)
    }
}

impl<const N: usize, F: VectorField<N> + ?Sized> Integrator<F, SVector<f64, N>> for Rk4 {
    #[inline]
    fn step(&self, field: &F, time: f64, x: &SVector<f64, N>, h: f64) -> Result<SVector<f64, N>, Diverged> {
        let half = 0.5 * h;
        let f1 = field.at(time, x);
        let f2 = field.at(time + half, &(x + f1 * half));
        let f3 = field.at(time + half, &(x + f2 * half));
        let f4 = field.at(time + h, &(x + f3 * h));
        finite(x + (f1 + (f2 + f3) * 2.0 + f4) * (h / 6.0))
    }
}
