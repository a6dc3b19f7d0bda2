//! The order of storage, and how vectors of a whole system are cut into what they have for each factor, and joined again.

use std::ops::Range;

use super::System;
use crate::expr::Vector;

/// A place in the order of storage: configuration and momentum of each factor, then the advected parameters in the order declared.
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

/// What a vector in the order of storage has for one factor.
#[derive(Clone, Debug, PartialEq)]
pub struct FactorPart<'a> {
    /// In a state the stored coordinates of the configuration; in a tangent vector an element of the algebra, in a cotangent vector one of
    /// its dual.
    pub configuration: Vector<'a>,
    /// The momentum's part.
    pub momentum: Vector<'a>,
    /// The part of each advected parameter of the factor.
    pub advected: Vec<Vector<'a>>,
}

impl<'a> System<'a> {
    /// The parts of the state in the order of storage.
    pub fn slots(&self) -> Vec<Slot> {
        let factors = 0..self.factors.len();
        let pairs = factors.flat_map(|factor| [Slot::Configuration(factor), Slot::Momentum(factor)]);
        pairs.chain(self.advected.iter().map(|&(factor, place)| Slot::Advected { factor, place })).collect()
    }

    /// The symbols of the state, factor by factor.
    pub fn state(&self) -> Vec<FactorPart<'a>> {
        let of = |factor: &super::Factor<'a>| FactorPart {
            configuration: factor.configuration.clone(),
            momentum: factor.momentum.clone(),
            advected: factor.advected_values(),
        };
        self.factors.iter().map(of).collect()
    }

    /// What a vector of stored coordinates, in the order of storage, has for each factor.
    pub fn split_state(&self, vector: &Vector<'a>) -> Vec<FactorPart<'a>> {
        self.split(vector, self.state())
    }

    /// What a tangent or cotangent vector, in the order of storage, has for each factor.
    pub fn split_tangent(&self, vector: &Vector<'a>) -> Vec<FactorPart<'a>> {
        let mut shape = self.state();
        for part in &mut shape {
            // the algebra in the place of the group
            part.configuration = part.momentum.clone();
        }
        self.split(vector, shape)
    }

    /// Cuts a vector into parts of the lengths of these.
    fn split(&self, vector: &Vector<'a>, mut parts: Vec<FactorPart<'a>>) -> Vec<FactorPart<'a>> {
        let mut rest = vector.iter();
        for slot in self.slots() {
            let part = slot.of_mut(&mut parts);
            *part = Vector(rest.by_ref().take(part.len()).collect());
        }
        parts
    }

    /// The parts of all factors in the order of storage.
    pub fn join(&self, parts: &[FactorPart<'a>]) -> Vector<'a> {
        Vector(self.slots().iter().flat_map(|slot| slot.of(parts).iter()).collect())
    }

    /// Where the momentum of a factor stands among all momenta.
    pub fn momentum_range(&self, factor: usize) -> Range<usize> {
        let start = self.factors[..factor].iter().map(|factor| factor.momentum.len()).sum();
        start..start + self.factors[factor].momentum.len()
    }

    /// What a vector with the components of all momenta, or of all velocities, has for each factor.
    pub fn split_momentum(&self, vector: &Vector<'a>) -> Vec<Vector<'a>> {
        let of = |factor| Vector(vector.0[self.momentum_range(factor)].to_vec());
        (0..self.factors.len()).map(of).collect()
    }
}

impl Slot {
    /// What stands here.
    pub fn of<'p, 'a>(self, parts: &'p [FactorPart<'a>]) -> &'p Vector<'a> {
        match self {
            Self::Configuration(factor) => &parts[factor].configuration,
            Self::Momentum(factor) => &parts[factor].momentum,
            Self::Advected { factor, place } => &parts[factor].advected[place],
        }
    }

    fn of_mut<'p, 'a>(self, parts: &'p mut [FactorPart<'a>]) -> &'p mut Vector<'a> {
        match self {
            Self::Configuration(factor) => &mut parts[factor].configuration,
            Self::Momentum(factor) => &mut parts[factor].momentum,
            Self::Advected { factor, place } => &mut parts[factor].advected[place],
        }
    }
}
