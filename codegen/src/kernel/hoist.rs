//! Where each value is computed: in the earliest function that can, and stored in a record where later ones need it
//! again.

use std::collections::BTreeSet;

use rustc_hash::{FxHashMap, FxHashSet};

use super::dag::{Dag, Op, Operation, Signed};
use crate::expr::{Function, Stage, Symbol};
use crate::program::{RecordKind, StepRole};

/// Where a value is computed: in the function that returns this record, or in each function that uses it.
type Home = Option<RecordKind>;

/// The outline of a function: its role, and what it must return.
pub(super) struct Outline<R> {
    pub role: R,
    /// The record that it returns.
    pub record: Option<RecordKind>,
    /// Whether it computes what depends on the unknown itself, for another value of that than the record is of, but for
    /// what is slow.
    pub is_apart: bool,
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
    /// What changes little from one value of the unknown to the next.
    slow: FxHashSet<Op>,
}

impl Homes {
    /// For functions that stand alone: each computes all that it needs.
    pub(super) fn alone() -> Self {
        Self { places: FxHashMap::default(), stored: BTreeSet::new(), slow: FxHashSet::default() }
    }

    /// Of a step: what depends on parameters, state and unknown alone is computed once they are known. `given` are the
    /// symbols that only the beginning of a step is given, and functions that are apart find what is `slow`.
    pub(super) fn of_step(
        dag: &Dag<'_>,
        functions: &[Outline<StepRole>],
        given: &[Symbol],
        slow: &FxHashSet<Op>,
    ) -> Self {
        let roots = |roles: &[StepRole]| -> Vec<Op> {
            let wanted = functions.iter().filter(|function| roles.contains(&function.role));
            wanted.flat_map(|function| function.results()).map(|signed| signed.op).collect()
        };
        let reachable = |roles: &[StepRole]| dag.reachable_from(roots(roles));
        let evaluating = reachable(&[StepRole::Evaluate]);
        let (update, domain) = (StepRole::FixedPointUpdate, StepRole::Domain);
        let solving = reachable(&[StepRole::Evaluate, StepRole::Correction, update, domain]);
        let arguments: FxHashSet<Op> = evaluating.iter().filter_map(|&op| dag.stumpff_argument(op)).collect();
        let is_given = |op: Op| matches!(dag.operation(op), Operation::Symbol(s) if given.contains(s));
        let place = |op: Op| match dag.stage(op) {
            Stage::Parameters => Some(RecordKind::Constants),
            Stage::Perturbation => None,
            // What only the next state is made of is computed there, once a step too: the solution is not to wait
            // behind it.
            Stage::Step if solving.contains(&op) || is_given(op) => Some(RecordKind::Step),
            Stage::Iteration if evaluating.contains(&op) => Some(RecordKind::Iterate),
            // Stumpff functions of one argument are computed together
            Stage::Iteration => {
                let argument = dag.stumpff_argument(op).filter(|argument| arguments.contains(argument));
                argument.map(|_| RecordKind::Iterate)
            }
            _ => None,
        };
        let places = dag.ops().map(|op| (op, place(op))).collect();
        let is_kept = |op: &&Op| evaluating.contains(*op) && dag.stage(**op) == Stage::Iteration;
        let slow = slow.iter().filter(is_kept).copied().collect();
        let mut placement = Self { places, stored: BTreeSet::new(), slow };

        // everything that some function computes
        let (apart, others): (Vec<_>, Vec<_>) = functions.iter().partition(|function| function.is_apart);
        let results = |functions: &[&Outline<StepRole>]| {
            functions.iter().flat_map(|function| function.results()).map(|signed| signed.op).collect()
        };
        let used = dag.reachable_from(results(&others));
        for op in dag.ops() {
            if used.contains(&op) || placement.places[&op] == Some(RecordKind::Iterate) {
                for operand in dag.operation(op).operands() {
                    placement.store_if_used_elsewhere(dag, operand, placement.places[&op], &is_given);
                }
            }
        }
        for function in others {
            for signed in function.results() {
                placement.store_if_used_elsewhere(dag, signed.op, function.record, &is_given);
            }
        }
        let results = results(&apart);
        let slow = placement.slow.clone();
        for op in dag.reachable_without(results.clone(), &slow) {
            let is_local = |op: Op| {
                matches!(placement.places[&op], None | Some(RecordKind::Iterate)) && !slow.contains(&op)
            };
            let operands = dag.operation(op).operands().into_iter();
            // of a result that is known before, there is no operand to be looked at
            let known = operands.filter(|&known| is_local(op) && !is_local(known));
            let known = known.chain((results.contains(&op) && !is_local(op)).then_some(op));
            for operand in known.collect::<Vec<_>>() {
                placement.store_if_used_elsewhere(dag, operand, None, &is_given);
            }
        }
        placement
    }

    /// For a function that finds nothing that depends on the unknown but what is slow.
    pub(super) fn apart(&self) -> Self {
        let is_found = |op: &Op| self.places[op] != Some(RecordKind::Iterate) || self.slow.contains(op);
        let stored = self.stored.iter().copied().filter(is_found).collect();
        Self { places: self.places.clone(), stored, slow: self.slow.clone() }
    }

    /// Stores a value that is used in another place than it is computed in, unless it is at hand there.
    fn store_if_used_elsewhere(&mut self, dag: &Dag<'_>, op: Op, user: Home, is_given: &impl Fn(Op) -> bool) {
        let place = self.places[&op];
        let is_constant = matches!(dag.operation(op), Operation::Number(_));
        // symbols of the state and the unknown are given everywhere
        let at_hand = dag.operation(op).is_leaf() && dag.stage(op) != Stage::Parameters && !is_given(op);
        if place.is_some() && place != user && !is_constant && !at_hand {
            self.stored.insert(op);
        }
    }

    /// Of maps of what is known at the last stage: all that they are made of is computed before, once for all of them,
    /// and kept in a record.
    pub(super) fn of_maps<R>(dag: &Dag<'_>, maps: &[Outline<R>], last: Stage, record: RecordKind) -> Self {
        let results: Vec<Op> = maps.iter().flat_map(Outline::results).map(|signed| signed.op).collect();
        let all = dag.reachable_from(results.clone());
        let is_linear = |op: Op| dag.stage(op) == last;
        let coefficients: Vec<Op> = {
            let linear = dag.ops().filter(|op| all.contains(op) && is_linear(*op));
            linear.flat_map(|op| dag.operation(op).operands()).filter(|&op| !is_linear(op)).collect()
        };
        let at_point = dag.reachable_from(coefficients);
        let place = |op: Op| {
            let is_symbol = matches!(dag.operation(op), Operation::Symbol(_));
            (!is_linear(op) && (is_symbol || at_point.contains(&op))).then_some(record)
        };
        let places: FxHashMap<Op, Home> = dag.ops().map(|op| (op, place(op))).collect();
        let local = dag.ops().filter(|op| all.contains(op) && places[op].is_none());
        let used = results.iter().copied().chain(local.flat_map(|op| dag.operation(op).operands()));
        let is_number = |op: Op| matches!(dag.operation(op), Operation::Number(_));
        let stored = used.filter(|&op| places[&op].is_some() && !is_number(op)).collect();
        Self { places, stored, slow: FxHashSet::default() }
    }

    /// All that is stored in some record, in the order of creation.
    pub(super) fn stored(&self) -> impl Iterator<Item = Op> + '_ {
        self.stored.iter().copied()
    }

    /// The values that a record stores, in the order of creation.
    pub(super) fn stored_in(&self, kind: RecordKind) -> Vec<Op> {
        let here = |op: &Op| self.places.get(op) == Some(&Some(kind));
        self.stored.iter().copied().filter(here).collect()
    }

    /// Whether a function that returns `record`, if any, finds the value rather than computing it.
    pub(super) fn is_given(&self, dag: &Dag<'_>, record: Option<RecordKind>, op: Op) -> bool {
        dag.operation(op).is_leaf() || self.stored.contains(&op) && self.places[&op] != record
    }
}

impl Dag<'_> {
    /// The nodes needed for `outputs`.
    pub(super) fn reachable_from(&self, outputs: Vec<Op>) -> FxHashSet<Op> {
        self.reachable_without(outputs, &FxHashSet::default())
    }

    /// The same, but for those that only these known ones need.
    fn reachable_without(&self, outputs: Vec<Op>, known: &FxHashSet<Op>) -> FxHashSet<Op> {
        let mut seen = FxHashSet::default();
        let mut pending = outputs;
        while let Some(op) = pending.pop() {
            if seen.insert(op) && !known.contains(&op) {
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
