//! Projection methods.

use nalgebra::SVector;

use super::{Diverged, Integrator, Method, VectorField, finite};

/// A method on `R^N`, and a projection onto a submanifold after each of its steps: `x_{k+1} = P(Φ_h(x_k))`.
///
/// The order is that of the method, since the projection moves a point by no more than a multiple of its error: HLW, IV.4. The
/// states stay on the submanifold; nothing else is preserved by that.
///
/// ```
/// use coadjoint_classical::{Projected, RungeKutta, Tableau, integrate, unit_leading};
/// use nalgebra::Vector3;
///
/// // the planar pendulum on the cylinder of (cos θ, sin θ, p), (1.21)
/// let pendulum = |_: f64, x: &Vector3<f64>| Vector3::new(-x[1] * x[2], x[0] * x[2], -x[1]);
/// let method = Projected { method: RungeKutta::from(Tableau::rk2()), projection: unit_leading::<2, 3> };
/// let start = Vector3::new(1_f64.cos(), 1_f64.sin(), 0.0);
/// let end = integrate(&method, &pendulum, 0.0, start, 0.1, 1_000, |_, _, _| {})?;
/// assert!((end.x.hypot(end.y) - 1.0).abs() < 1e-15);
/// # Ok::<(), coadjoint_classical::Diverged>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Projected<I, P> {
    /// The method on `R^N`.
    pub method: I,
    /// `P`, with `P(x) = x` on the submanifold.
    pub projection: P,
}

impl<I: Method, P> Method for Projected<I, P> {
    fn name(&self) -> &'static str {
        "projected"
    }

    fn order(&self) -> u32 {
        self.method.order()
    }
}

impl<const N: usize, F, I, P> Integrator<F, SVector<f64, N>> for Projected<I, P>
where
    F: VectorField<N> + ?Sized,
    I: Integrator<F, SVector<f64, N>>,
    P: Fn(&SVector<f64, N>) -> SVector<f64, N>,
{
    #[inline]
    fn step(&self, field: &F, time: f64, x: &SVector<f64, N>, h: f64) -> Result<SVector<f64, N>, Diverged> {
        let free = self.method.step(field, time, x, h)?;
        finite((self.projection)(&free))
    }
}

/// The orthogonal projection onto `S^{K−1} × R^{N−K}`: divides the first `K` components by their norm.
///
/// `unit_leading::<2, 3>` is that onto the cylinder `(cos θ, sin θ, p)`, and `unit_leading::<4, N>` normalizes a quaternion with
/// which the state begins. Where the norm is zero there is no projection, and the result is not finite.
#[inline]
pub fn unit_leading<const K: usize, const N: usize>(x: &SVector<f64, N>) -> SVector<f64, N> {
    const { assert!(K <= N, "more components than there are") };
    let norm = x.iter().take(K).map(|component| component * component).sum::<f64>().sqrt();
    let mut projected = *x;
    projected.iter_mut().take(K).for_each(|component| *component /= norm);
    projected
}
