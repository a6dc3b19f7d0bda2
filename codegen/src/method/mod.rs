//! Methods: from a system and a retraction to the equations of one step. They make expressions, never tokens.

pub mod lie_poisson;

use crate::expr::{Arena, Expr, Id, Vector};
use rustc_hash::FxHashMap;

/// One step: solve `left(x) = right(x)` for the unknown `x`, then update the state.
pub struct Step<'a> {
    /// The step size, a symbol.
    pub h: Expr<'a>,
    /// The symbols `x`, of stage *iteration*.
    pub unknown: Vector<'a>,
    /// A first approximation of `x` from the state.
    pub start: Vector<'a>,
    /// `left(x)`
    pub left: Vector<'a>,
    /// `right(x)`
    pub right: Vector<'a>,
    /// Positive while `x` is inside the retraction's domain.
    pub domain: Option<Expr<'a>>,
    /// The state after the step, in the order of storage.
    pub next: Vector<'a>,
    /// Role names for intermediate values, to read the emitted code by.
    pub names: Names,
}

/// Role names of expressions.
#[derive(Default)]
pub struct Names {
    index: FxHashMap<Id, usize>,
    names: Vec<(Id, String)>,
}

impl Names {
    /// Names an expression, unless it already has a name or is a plain symbol or constant.
    pub fn name(&mut self, expr: Expr<'_>, name: impl Into<String>) {
        if expr.as_symbol().is_none() && expr.as_number().is_none() {
            self.index.entry(expr.id()).or_insert_with(|| {
                self.names.push((expr.id(), name.into()));
                self.names.len() - 1
            });
        }
    }

    /// Names the components of a vector.
    pub fn name_vector(&mut self, vector: &Vector<'_>, name: &str, components: &[&str]) {
        for (component, suffix) in vector.iter().zip(components) {
            self.name(component, format!("{name}_{suffix}"));
        }
    }

    /// The names in the order they were given.
    pub fn iter(&self) -> impl Iterator<Item = (Id, &str)> {
        self.names.iter().map(|(id, name)| (*id, name.as_str()))
    }
}

/// The step size as a symbol.
pub fn step_symbol(arena: &Arena) -> Expr<'_> {
    arena.symbol("h", crate::expr::Stage::Parameters)
}
