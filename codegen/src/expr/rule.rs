//! Vectors whose derivatives follow a rule in closed form.
//!
//! What an inverse is computed from is long, and its derivative by the chain rule is longer; `(A⁻¹)' = −A⁻¹ A' A⁻¹` is
//! short. [`Vector::with_rule`] attaches such a rule to a vector; [`Derivative`](super::Derivative) uses it in place of
//! the chain rule. The [gradient](super::gradient()) does not.

use std::rc::Rc;
use std::sync::Arc;

use super::arena::{Arena, RuleApplied};
use super::linear::Vector;
use super::node::Id;

/// A derivative in closed form.
pub trait DerivativeRule: Send + Sync {
    /// The change of values along changes of their arguments; `given` is what else it needs.
    fn along<'a>(&self, values: &Vector<'a>, given: &Vector<'a>, changes: &Vector<'a>) -> Vector<'a>;
}

impl<'a> Vector<'a> {
    /// The same, each component kept whole, with a rule for its derivative by these arguments, made of what is given.
    pub fn with_rule(
        &self,
        arguments: &Self,
        given: &Self,
        rule: Arc<impl DerivativeRule + 'static>,
    ) -> Self {
        let values = self.hold();
        let ids = |vector: &Self| vector.iter().map(|component| component.id).collect();
        let along = move |arena: &Arena, of: &RuleApplied, changes: &[Id]| {
            let vector = |ids: &[Id]| Vector(ids.iter().map(|&id| arena.expr(id)).collect());
            let change = rule.along(&vector(&of.values), &vector(&of.given), &vector(changes));
            change.iter().map(|change| change.id).collect()
        };
        if let Some(first) = values.iter().next() {
            let (values, arguments, given) = (ids(&values), ids(arguments), ids(given));
            first.arena.insert_rule(RuleApplied { values, arguments, given, along: Rc::new(along) });
        }
        values
    }
}
