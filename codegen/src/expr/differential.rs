//! Values whose derivatives are known in closed form.
//!
//! What an inverse is computed from is long, and its derivative by the chain rule is longer; `(A⁻¹)' = −A⁻¹ A' A⁻¹` is short. A vector can be given such
//! a rule: wherever it is differentiated, the rule is asked. Nothing changes in what it is.

use std::sync::Arc;

use rustc_hash::FxHashMap;

use super::arena::Arena;
use super::linear::Vector;
use super::node::Id;

/// A derivative in closed form.
pub trait Differential: Send + Sync {
    /// The change of values along changes of their arguments; `given` is what else it needs.
    fn along<'a>(&self, values: &Vector<'a>, given: &Vector<'a>, changes: &Vector<'a>) -> Vector<'a>;
}

/// Values with what they are functions of, and the derivative.
pub(super) struct Known {
    pub(super) values: Vec<Id>,
    pub(super) arguments: Vec<Id>,
    /// What the derivative is made of, beside the values.
    given: Vec<Id>,
    differential: Arc<dyn Differential>,
}

/// All that are known in an arena.
#[derive(Default)]
pub(super) struct Differentials {
    known: Vec<Arc<Known>>,
    of: FxHashMap<Id, usize>,
}

impl Differentials {
    /// The one of a value.
    pub(super) fn of(&self, id: Id) -> Option<Arc<Known>> {
        self.of.get(&id).map(|&place| Arc::clone(&self.known[place]))
    }

    /// The first one of a value stays.
    pub(super) fn insert(&mut self, known: Known) {
        let place = self.known.len();
        known.values.iter().for_each(|&value| {
            self.of.entry(value).or_insert(place);
        });
        self.known.push(Arc::new(known));
    }
}

impl Known {
    /// Of the values along changes of the arguments.
    pub(super) fn along(&self, arena: &Arena, changes: impl Iterator<Item = Id>) -> Vec<Id> {
        let vector = |ids: &[Id]| Vector(ids.iter().map(|&id| arena.expr(id)).collect());
        let changes = Vector(changes.map(|id| arena.expr(id)).collect());
        let change = self.differential.along(&vector(&self.values), &vector(&self.given), &changes);
        change.iter().map(|change| change.id).collect()
    }

    /// The same of what takes the place of all that it is of and made of.
    pub(super) fn image(&self, mut image: impl FnMut(Id) -> Id) -> Self {
        let mut images = |ids: &[Id]| ids.iter().map(|&id| image(id)).collect();
        let (arguments, given) = (images(&self.arguments), images(&self.given));
        Self { values: images(&self.values), arguments, given, differential: Arc::clone(&self.differential) }
    }
}

impl<'a> Vector<'a> {
    /// The same, each component kept whole, with its derivative in closed form, by these arguments and of what is given.
    pub fn with_differential(
        &self,
        arguments: &Self,
        given: &Self,
        differential: Arc<dyn Differential>,
    ) -> Self {
        let values = self.hold();
        let ids = |vector: &Self| vector.iter().map(|component| component.id).collect();
        if let Some(first) = values.iter().next() {
            let (values, arguments, given) = (ids(&values), ids(arguments), ids(given));
            first.arena.insert_differential(Known { values, arguments, given, differential });
        }
        values
    }
}
