//! What the values of a step are called in generated code.

use crate::expr::{Arena, Expr, Stage, Vector};
use crate::model::{Factor, System};

/// The names of the values that belong to one factor. Each function gives its argument a name and returns it.
pub(super) struct ValueNames<'s, 'a> {
    factor: &'s Factor<'a>,
    /// What tells these from the other factors' values, where there are others.
    prefix: String,
    /// The number `k` for which the unknown is `η/k`.
    unknown_scale: i128,
}

impl<'s, 'a> ValueNames<'s, 'a> {
    pub(super) fn new(system: &System<'a>, factor: &'s Factor<'a>, unknown_scale: i128) -> Self {
        let prefix = match system.factors.len() {
            1 => String::new(),
            _ => format!("{}_", factor.name.plain()),
        };
        Self { factor, prefix, unknown_scale }
    }

    /// `η`, or the part of it that is the unknown.
    pub(super) fn unknown(&self) -> &'static str {
        match self.unknown_scale {
            1 => "eta",
            2 => "half_eta",
            _ => "quarter_eta",
        }
    }

    /// What is said of a value that is a multiple by the unknown's scale.
    fn multiple(&self) -> &'static str {
        match self.unknown_scale {
            1 => "",
            2 => "twice_",
            _ => "four_times_",
        }
    }

    /// The names of the components of an element of the algebra or of its dual.
    pub(super) fn components(&self, what: &str) -> Vec<String> {
        let axes = self.factor.algebra.group.axes().iter();
        axes.map(|axis| format!("{}{what}_{axis}", self.prefix)).collect()
    }

    /// Symbols of an element of the algebra or of its dual, of stage *iteration*.
    pub(super) fn symbols(&self, arena: &'a Arena, what: &str) -> Vector<'a> {
        let names = self.components(what).into_iter();
        Vector(names.map(|name| arena.symbol(name, Stage::Iteration)).collect())
    }

    /// A number.
    pub(super) fn scalar(&self, what: &str, value: Expr<'a>) -> Expr<'a> {
        value.named(format!("{}{what}", self.prefix))
    }

    /// An element of the algebra or of its dual.
    pub(super) fn algebra(&self, what: &str, value: &Vector<'a>) -> Vector<'a> {
        value.named(&format!("{}{what}", self.prefix), self.factor.algebra.group.axes())
    }

    /// An element of the algebra or of its dual that is a multiple by the unknown's scale.
    pub(super) fn multiple_of(&self, what: &str, value: &Vector<'a>) -> Vector<'a> {
        self.algebra(&format!("{}{what}", self.multiple()), value)
    }

    /// An element of the group.
    pub(super) fn group(&self, what: &str, value: &Vector<'a>) -> Vector<'a> {
        value.named(&format!("{}{what}", self.prefix), self.factor.algebra.group.coordinates())
    }

    /// What becomes of the configuration.
    pub(super) fn configuration(&self, what: &str, value: &Vector<'a>) -> Vector<'a> {
        value.named(&format!("{}_{what}", self.factor.name.plain()), self.factor.algebra.group.coordinates())
    }

    /// What becomes of the advected parameters, or belongs to them.
    pub(super) fn advected(&self, what: &str, values: &[Vector<'a>]) {
        let parameters = self.factor.advected.iter().zip(&self.factor.algebra.spaces);
        for ((advected, space), value) in parameters.zip(values) {
            value.named(&format!("{}_{what}", advected.name.plain()), space.coordinates());
        }
    }
}
