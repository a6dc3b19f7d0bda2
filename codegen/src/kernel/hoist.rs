//! Where each value is computed: in the earliest function that can, and stored in a record where later ones need it
//! again.

use std::collections::BTreeSet;

use rustc_hash::{FxHashMap, FxHashSet};

use super::dag::{Dag, Op, Operation, Signed};
use crate::expr::{Function, Stage, Symbol};
use crate::program::{DerivativeRole, RecordKind, StepRole};

/// Where a value is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Home {
    /// In the function that returns this record.
    Record(RecordKind),
    /// In each function that uses it.
    Local,
}

/// The outline of a function: its role, and what it must return.
pub(super) struct Outline<R> {
    pub role: R,
    /// The record that it returns.
    pub record: Option<RecordKind>,
    pub results: Vec<Vec<Signed>>,
}

impl<R> Outline<R> {
    /// All results, one after the other.
    pub(super) fn results(&self) -> impl Iterator<Item = Signed> + '_ {
        self.results.iter().flatten().copied()
    }
}

/// The place of every value, and which of them are stored.
pub(super) struct Homes {
    places: FxHashMap<Op, Home>,
    stored: BTreeSet<Op>,
}

impl Homes {
    /// For functions that stand alone: each computes all that it needs.
    pub(super) fn alone() -> Self {
        Self { places: FxHashMap::default(), stored: BTreeSet::new() }
    }

    /// Of a step: what depends on parameters, state and unknown alone is computed once they are known. `given` are the
    /// symbols that only the beginning of a step is given.
    pub(super) fn of_step(dag: &Dag<'_>, functions: &[Outline<StepRole>], given: &[Symbol]) -> Self {
        let roots = |roles: &[StepRole]| -> Vec<Op> {
            let wanted = functions.iter().filter(|function| roles.contains(&function.role));
            wanted.flat_map(|function| function.results()).map(|signed| signed.op).collect()
        };
        let reachable = |roles: &[StepRole]| dag.reachable_from(roots(roles));
        let evaluating = reachable(&[StepRole::Evaluate]);
        let solving = reachable(&[
            StepRole::Evaluate,
            StepRole::Correction,
            StepRole::FixedPointUpdate,
            StepRole::Domain,
        ]);
        let arguments: FxHashSet<Op> = evaluating.iter().filter_map(|&op| dag.stumpff_argument(op)).collect();
        let is_given = |op: Op| matches!(dag.operation(op), Operation::Symbol(s) if given.contains(s));
        let place = |op: Op| match dag.stage(op) {
            Stage::Parameters => Home::Record(RecordKind::Constants),
            Stage::Perturbation => Home::Local,
            // What only the next state is made of is computed there, once a step too: the solution is not to wait
            // behind it.
            Stage::Step if solving.contains(&op) || is_given(op) => Home::Record(RecordKind::Step),
            Stage::Iteration if evaluating.contains(&op) => Home::Record(RecordKind::Iterate),
            // Stumpff functions of one argument are computed together
            Stage::Iteration if dag.stumpff_argument(op).is_some_and(|z| arguments.contains(&z)) => {
                Home::Record(RecordKind::Iterate)
            }
            _ => Home::Local,
        };
        let places = dag.ops().map(|op| (op, place(op))).collect();
        let mut placement = Self { places, stored: BTreeSet::new() };

        // everything that some function computes
        let used = dag.reachable_from(functions.iter().flat_map(Outline::results).map(|s| s.op).collect());
        for op in dag.ops() {
            if used.contains(&op) || placement.places[&op] == Home::Record(RecordKind::Iterate) {
                for operand in dag.operation(op).operands() {
                    placement.store_if_used_elsewhere(dag, operand, placement.places[&op], &is_given);
                }
            }
        }
        for function in functions {
            let place = function.record.map_or(Home::Local, Home::Record);
            for signed in function.results() {
                placement.store_if_used_elsewhere(dag, signed.op, place, &is_given);
            }
        }
        placement
    }

    /// Stores a value that is used in another place than it is computed in, unless it is at hand there.
    fn store_if_used_elsewhere(&mut self, dag: &Dag<'_>, op: Op, user: Home, is_given: &impl Fn(Op) -> bool) {
        let place = self.places[&op];
        let is_constant = matches!(dag.operation(op), Operation::Number(_));
        // symbols of the state and the unknown are given everywhere
        let at_hand = dag.operation(op).is_leaf() && dag.stage(op) != Stage::Parameters && !is_given(op);
        if place != Home::Local && place != user && !is_constant && !at_hand {
            self.stored.insert(op);
        }
    }

    /// Of linear maps of perturbations: all that they are made of is computed at the point, once for all of them.
    pub(super) fn of_maps(dag: &Dag<'_>, maps: &[Outline<DerivativeRole>]) -> Self {
        let results: Vec<Op> = maps.iter().flat_map(Outline::results).map(|signed| signed.op).collect();
        let all = dag.reachable_from(results.clone());
        let is_linear = |op: Op| dag.stage(op) == Stage::Perturbation;
        let coefficients: Vec<Op> = {
            let linear = dag.ops().filter(|op| all.contains(op) && is_linear(*op));
            linear.flat_map(|op| dag.operation(op).operands()).filter(|&op| !is_linear(op)).collect()
        };
        let at_point = dag.reachable_from(coefficients);
        let place = |op: Op| {
            let is_symbol = matches!(dag.operation(op), Operation::Symbol(_));
            match !is_linear(op) && (is_symbol || at_point.contains(&op)) {
                true => Home::Record(RecordKind::Point),
                false => Home::Local,
            }
        };
        let places: FxHashMap<Op, Home> = dag.ops().map(|op| (op, place(op))).collect();
        let local = dag.ops().filter(|op| all.contains(op) && places[op] == Home::Local);
        let used = results.iter().copied().chain(local.flat_map(|op| dag.operation(op).operands()));
        let stored = used
            .filter(|op| places[op] != Home::Local && !matches!(dag.operation(*op), Operation::Number(_)));
        let stored = stored.collect();
        Self { places, stored }
    }

    /// All that is stored in some record, in the order of creation.
    pub(super) fn stored(&self) -> impl Iterator<Item = Op> + '_ {
        self.stored.iter().copied()
    }

    /// The values that a record stores, in the order of creation.
    pub(super) fn stored_in(&self, kind: RecordKind) -> Vec<Op> {
        let here = |op: &Op| self.places.get(op) == Some(&Home::Record(kind));
        self.stored.iter().copied().filter(here).collect()
    }

    /// Whether a function that returns `record`, if any, finds the value rather than computing it.
    pub(super) fn is_given(&self, dag: &Dag<'_>, record: Option<RecordKind>, op: Op) -> bool {
        match dag.operation(op) {
            Operation::Symbol(_) | Operation::Number(_) => true,
            _ => {
                let here = record.map_or(Home::Local, Home::Record);
                self.stored.contains(&op) && self.places[&op] != here
            }
        }
    }
}

impl Dag<'_> {
    /// The nodes needed for `outputs`.
    pub(super) fn reachable_from(&self, outputs: Vec<Op>) -> FxHashSet<Op> {
        let mut seen = FxHashSet::default();
        let mut pending = outputs;
        while let Some(op) = pending.pop() {
            if seen.insert(op) {
                pending.extend(self.operation(op).operands());
            }
        }
        seen
    }

    /// The argument, if the node is a Stumpff function.
    pub(super) fn stumpff_argument(&self, op: Op) -> Option<Op> {
        match self.operation(op) {
            Operation::Function(Function::Stumpff(_), argument) => Some(*argument),
            _ => None,
        }
    }
}
