//! Runge–Kutta methods by their tableaux: explicit, implicit and partitioned ones.

use nalgebra::SVector;

use super::stages::{Equations, Rate, Table};
use super::tableau::{PartitionedTableau, Tableau};
use super::{Diverged, Integrator, Method, VectorField, is_finite};

/// The Runge–Kutta method of a [`Tableau`], for vector fields.
///
/// Stages of an implicit method are solved for by fixed-point iteration as long as that contracts, else by Newton's, with a Jacobian of central
/// differences; to roundoff in the norm of the state. A step that is not solved is an error, never an inaccurate state. Written to be right for
/// any tableau, not to be fast.
#[derive(Clone, Debug, PartialEq)]
pub struct RungeKutta {
    name: &'static str,
    order: u32,
    symplectic: bool,
    table: Table,
}

impl<const D: u32> From<Tableau<D>> for RungeKutta {
    fn from(tableau: Tableau<D>) -> Self {
        let (name, order, symplectic) = (tableau.name(), tableau.order(), tableau.is_symplectic());
        Self { name, order, symplectic, table: Table::of(&tableau) }
    }
}

impl Method for RungeKutta {
    fn name(&self) -> &'static str {
        self.name
    }

    fn order(&self) -> u32 {
        self.order
    }
}

impl RungeKutta {
    /// Whether it is [symplectic](Tableau::is_symplectic), and keeps quadratic invariants: lengths of quaternions, too.
    pub fn is_symplectic(&self) -> bool {
        self.symplectic
    }

    /// Takes a step of a system whose states are lists of numbers: `field` writes `f(t, x)` to numbers that it is given. The answer is the new
    /// state, and the iterations that its stages took.
    ///
    /// # Errors
    /// As [`Integrator::step`].
    pub fn advance(
        &self,
        field: &mut Rate<'_>,
        time: f64,
        state: &[f64],
        h: f64,
    ) -> Result<(Vec<f64>, u32), Diverged> {
        Equations { tables: &[&self.table], part: &|_| 0, field, time, start: state, h }.solve()
    }
}

impl<const N: usize, F: VectorField<N> + ?Sized> Integrator<F, SVector<f64, N>> for RungeKutta {
    fn step(&self, field: &F, time: f64, x: &SVector<f64, N>, h: f64) -> Result<SVector<f64, N>, Diverged> {
        let mut rate = |time: f64, x: &[f64], rate: &mut [f64]| {
            rate.copy_from_slice(field.at(time, &SVector::from_column_slice(x)).as_slice());
        };
        let (next, _) = self.advance(&mut rate, time, x.as_slice(), h)?;
        Ok(SVector::from_column_slice(&next))
    }
}

/// A system `q' = f₁(t, q, p)`, `p' = f₂(t, q, p)`.
pub trait Partitioned<const N: usize> {
    /// `f₁`, `∂H/∂p` of a Hamiltonian system.
    fn velocity(&self, time: f64, q: &SVector<f64, N>, p: &SVector<f64, N>) -> SVector<f64, N>;

    /// `f₂`, `−∂H/∂q` of a Hamiltonian system.
    fn force(&self, time: f64, q: &SVector<f64, N>, p: &SVector<f64, N>) -> SVector<f64, N>;
}

/// A [`Partitioned`] system that is separable, `H = T(p) + V(t, q)`, given by two closures, `velocity(p)` and `force(t, q)`.
#[derive(Clone, Copy, Debug)]
pub struct Split<V, F> {
    /// `∇T(p)`.
    pub velocity: V,
    /// `−∇V(t, q)`.
    pub force: F,
}

impl<const N: usize, V, F> Partitioned<N> for Split<V, F>
where
    V: Fn(&SVector<f64, N>) -> SVector<f64, N>,
    F: Fn(f64, &SVector<f64, N>) -> SVector<f64, N>,
{
    fn velocity(&self, _: f64, _: &SVector<f64, N>, p: &SVector<f64, N>) -> SVector<f64, N> {
        (self.velocity)(p)
    }

    fn force(&self, time: f64, q: &SVector<f64, N>, _: &SVector<f64, N>) -> SVector<f64, N> {
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

/// The Runge–Kutta method of a [`PartitionedTableau`], for [`Partitioned`] systems. Its stages are solved for as those of [`RungeKutta`];
/// where they follow one from the other, as those of Störmer–Verlet do for separable systems, fixed-point iteration comes to rest at exactly
/// them.
#[derive(Clone, Debug, PartialEq)]
pub struct PartitionedRungeKutta {
    name: &'static str,
    order: u32,
    positions: Table,
    momenta: Table,
}

impl<const D: u32> From<PartitionedTableau<D>> for PartitionedRungeKutta {
    fn from(tableau: PartitionedTableau<D>) -> Self {
        let (positions, momenta) = (Table::of(tableau.positions()), Table::of(tableau.momenta()));
        Self { name: tableau.name(), order: tableau.order(), positions, momenta }
    }
}

impl Method for PartitionedRungeKutta {
    fn name(&self) -> &'static str {
        self.name
    }

    fn order(&self) -> u32 {
        self.order
    }
}

impl<const N: usize, S: Partitioned<N> + ?Sized> Integrator<S, PhasePoint<N>> for PartitionedRungeKutta {
    fn step(&self, system: &S, time: f64, x: &PhasePoint<N>, h: f64) -> Result<PhasePoint<N>, Diverged> {
        let halves = |x: &[f64]| {
            let (q, p) = x.split_at(N);
            (SVector::<f64, N>::from_column_slice(q), SVector::<f64, N>::from_column_slice(p))
        };
        let mut rate = |time: f64, x: &[f64], rate: &mut [f64]| {
            let (q, p) = halves(x);
            let (first, second) = rate.split_at_mut(N);
            first.copy_from_slice(system.velocity(time, &q, &p).as_slice());
            second.copy_from_slice(system.force(time, &q, &p).as_slice());
        };
        let start: Vec<f64> = x.q.iter().chain(x.p.iter()).copied().collect();
        let tables = &[&self.positions, &self.momenta];
        let part = &|component| usize::from(component >= N);
        let equations = Equations { tables, part, field: &mut rate, time, start: &start, h };
        let (q, p) = halves(&equations.solve()?.0);
        if is_finite(&q) & is_finite(&p) { Ok(PhasePoint { q, p }) } else { Err(Diverged::NotFinite) }
    }
}
