//! Velocity and momentum by each other: the Legendre transform (4.6)–(4.10).
//!
//! An inertia says the momentum of a velocity, a Lagrangian does by `μ = ∂l/∂ξ`, a Hamiltonian says the velocity of a
//! momentum by `ξ = ∂h/∂μ`. The other way round there is a closed form where this is linear, as it is for every
//! quadratic energy. Elsewhere it is an equation to solve.

use super::{Energy, System};
use crate::expr::{Expr, Symbol, Vector, gradient};

/// A velocity by the momentum, or a momentum by the velocity.
#[derive(Clone)]
pub enum Relation<'a> {
    /// In closed form.
    Explicit(Vector<'a>),
    /// The residual, a function of its symbols.
    Implicit(Vector<'a>),
    /// There is none, for the energy has a singular second derivative whatever its symbols are.
    Singular,
}

impl<'a> Relation<'a> {
    /// From an equation for these symbols.
    fn solved(residual: Vector<'a>, symbols: &[Symbol]) -> Self {
        let jacobian = residual.jacobian(symbols);
        let jacobian = jacobian.map(Expr::hold);
        if jacobian.is_singular() {
            return Self::Singular;
        }
        if Vector(jacobian.entries.clone()).depends_on(symbols) || residual.chooses_by(symbols) {
            let is_regular = jacobian.try_solve(&residual).is_some();
            return if is_regular { Self::Implicit(residual) } else { Self::Singular };
        }
        residual.affine_root(&jacobian, symbols).map_or(Self::Singular, Self::Explicit)
    }
}

impl<'a> System<'a> {
    /// The symbols of the velocities of all factors, one after the other.
    pub fn velocity_symbols(&self) -> Vector<'a> {
        Vector::concat(self.factors.iter().map(|factor| &factor.velocity))
    }

    /// The velocity at the state.
    pub fn velocity_relation(&self) -> &Relation<'a> {
        self.velocity.get_or_init(|| {
            let momentum = self.momentum();
            match &self.energy {
                Energy::Mechanical { inertia, .. } => Relation::Explicit(inertia.solve_symmetric(&momentum)),
                Energy::Hamiltonian(energy) => Relation::Explicit(gradient(*energy, &momentum.symbols())),
                Energy::Lagrangian(lagrangian) => {
                    let velocity = self.velocity_symbols().symbols();
                    Relation::solved(&gradient(*lagrangian, &velocity) - &momentum, &velocity)
                }
            }
        })
    }

    /// The velocity at the state in closed form; if there is none, its symbols, which something else has to give a
    /// value to.
    pub fn velocity(&self) -> Vector<'a> {
        match self.velocity_relation() {
            Relation::Explicit(value) => value.clone(),
            Relation::Implicit(_) | Relation::Singular => self.velocity_symbols(),
        }
    }

    /// The momentum that belongs to the velocity's symbols, where configuration and advected parameters are those of
    /// the state.
    pub fn momentum_relation(&self) -> Relation<'a> {
        let velocity = self.velocity_symbols();
        match &self.energy {
            Energy::Mechanical { inertia, .. } => Relation::Explicit(inertia.times(&velocity)),
            Energy::Lagrangian(lagrangian) => Relation::Explicit(gradient(*lagrangian, &velocity.symbols())),
            Energy::Hamiltonian(energy) => {
                let momentum = self.momentum().symbols();
                Relation::solved(&gradient(*energy, &momentum) - &velocity, &momentum)
            }
        }
    }

    /// What there is of an expression in the velocity's symbols where these are known by the momentum.
    pub fn at_velocity(&self, vector: &Vector<'a>) -> Vector<'a> {
        match self.velocity_relation() {
            Relation::Implicit(_) | Relation::Singular => vector.clone(),
            Relation::Explicit(velocity) => {
                let symbols = self.velocity_symbols().symbols().into_iter();
                vector.substitute(&symbols.zip(velocity.iter()).collect::<Vec<_>>())
            }
        }
    }
}
