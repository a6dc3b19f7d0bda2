//! The order of storage, and how vectors in this order are cut into what they are made of, and joined again.

use std::ops::Range;

use super::{Factor, System};
use crate::expr::Vector;
use crate::group::Place;

/// A place in the order of storage: configuration and momentum of each factor, then the advected parameters in the
/// order declared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slot {
    /// The configuration of the factor of this index.
    Configuration(usize),
    /// Its momentum.
    Momentum(usize),
    /// One of its advected parameters.
    Advected {
        /// The index of the factor.
        factor: usize,
        /// The index among the advected parameters of the factor.
        place: usize,
    },
}

/// What a vector in the order of storage is made of, each part that of the group's factors one after the other.
#[derive(Clone, Debug, PartialEq)]
pub struct Parts<'a> {
    /// In a state the stored coordinates of the configuration; in a tangent vector an element of the algebra, in a
    /// cotangent vector one of its dual.
    pub configuration: Vector<'a>,
    /// The momentum's part.
    pub momentum: Vector<'a>,
    /// The part of each advected parameter, in the order of the group's spaces.
    pub advected: Vec<Vector<'a>>,
}

impl<'a> System<'a> {
    /// The parts of the state in the order of storage.
    pub fn slots(&self) -> Vec<Slot> {
        let factors = 0..self.factors.len();
        let pairs = factors.flat_map(|factor| [Slot::Configuration(factor), Slot::Momentum(factor)]);
        pairs.chain(self.advected.iter().map(|&(factor, place)| Slot::Advected { factor, place })).collect()
    }

    /// The symbols of a part of the state.
    pub fn part(&self, slot: Slot) -> &Vector<'a> {
        match slot {
            Slot::Configuration(factor) => &self.factors[factor].configuration,
            Slot::Momentum(factor) => &self.factors[factor].momentum,
            Slot::Advected { factor, place } => &self.factors[factor].advected[place].value,
        }
    }

    /// The symbols of the state.
    pub fn state(&self) -> Parts<'a> {
        Parts {
            configuration: self.configuration(),
            momentum: self.momentum(),
            advected: self.advected_values(),
        }
    }

    /// What a vector of stored coordinates, in the order of storage, is made of.
    pub fn split_state(&self, vector: &Vector<'a>) -> Parts<'a> {
        self.split(vector, |factor| factor.configuration.len())
    }

    /// What a tangent or cotangent vector, in the order of storage, is made of.
    pub fn split_tangent(&self, vector: &Vector<'a>) -> Parts<'a> {
        // the algebra in the place of the group
        self.split(vector, |factor| factor.momentum.len())
    }

    fn split(&self, vector: &Vector<'a>, of_configuration: impl Fn(&Factor<'a>) -> usize) -> Parts<'a> {
        let (mut configuration, mut momentum, mut advected) =
            (Vec::new(), Vec::new(), self.advected_values());
        let places = self.group.places();
        let mut rest = vector.iter();
        let mut take = |length: usize| rest.by_ref().take(length).collect::<Vec<_>>();
        for slot in self.slots() {
            match slot {
                Slot::Configuration(factor) => {
                    configuration.extend(take(of_configuration(&self.factors[factor])));
                }
                Slot::Momentum(_) => momentum.extend(take(self.part(slot).len())),
                Slot::Advected { factor, place } => {
                    advected[places[factor].spaces.start + place] = Vector(take(self.part(slot).len()));
                }
            }
        }
        Parts { configuration: Vector(configuration), momentum: Vector(momentum), advected }
    }

    /// A state in the order of storage.
    pub fn join_state(&self, parts: &Parts<'a>) -> Vector<'a> {
        self.join(parts, |place| place.stored.clone())
    }

    /// A tangent or cotangent vector in the order of storage.
    pub fn join_tangent(&self, parts: &Parts<'a>) -> Vector<'a> {
        self.join(parts, |place| place.algebra.clone())
    }

    fn join(&self, parts: &Parts<'a>, of_configuration: impl Fn(&Place) -> Range<usize>) -> Vector<'a> {
        let places = self.group.places();
        let part = |slot| match slot {
            Slot::Configuration(factor) => parts.configuration.part(of_configuration(&places[factor])).0,
            Slot::Momentum(factor) => places[factor].algebra(&parts.momentum).0,
            Slot::Advected { factor, place } => places[factor].spaces(&parts.advected)[place].0.clone(),
        };
        Vector(self.slots().into_iter().flat_map(part).collect())
    }
}
