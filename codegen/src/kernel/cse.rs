//! Common subexpressions within sums and products: pairs of operands that occur in several of them become nodes of
//! their own.

use std::collections::{BTreeMap, BTreeSet};

use rustc_hash::FxHashMap;

use super::dag::{Dag, Op, Operation};

/// Operations of more operands than this are left as they are: the number of pairs grows with the square of it, and the
/// catalogue's have at most some twenty.
const LONGEST: usize = 64;

impl Dag<'_> {
    /// Makes pairs of operands that occur in several sums or products nodes of their own, the most frequent first.
    pub(super) fn eliminate_common_pairs(&mut self) {
        let mut index = PairIndex::default();
        for op in self.ops() {
            index.count(op, self.operation(op), &|_| true);
        }
        while let Some(pair) = index.most_frequent() {
            let before = self.ops().len();
            let shared = match pair {
                Pair::Factors(a, b) => self.intern(Operation::Product(vec![a, b])),
                Pair::Addends(a, b, opposed) => self.intern(Operation::Sum(vec![(false, a), (opposed, b)])),
            };
            if self.ops().len() > before {
                index.count(shared, self.operation(shared), &|_| true);
            }
            // no other pairs come or go
            let [a, b] = pair.operands();
            let changed = |op: Op| op == a || op == b || op == shared;
            for holder in index.holders(&pair) {
                if holder != shared {
                    let mut operation = self.operation(holder).clone();
                    index.forget(holder, &operation, &changed);
                    while pair.replace(&mut operation, shared) {}
                    index.count(holder, &operation, &changed);
                    self.replace(holder, operation);
                }
            }
        }
    }
}

/// Which pairs occur in which operations.
#[derive(Default)]
struct PairIndex {
    /// The operations a pair occurs in, `true` for those of more than two operands, which it would shorten.
    holders: FxHashMap<Pair, BTreeMap<Op, bool>>,
    /// The pairs worth a node: those that occur twice and would shorten something, by how often they occur, the oldest
    /// last.
    candidates: BTreeSet<(usize, std::cmp::Reverse<Pair>)>,
}

impl PairIndex {
    /// Takes note of the pairs of an operation that hold one of some operands.
    fn count(&mut self, op: Op, operation: &Operation, held: &dyn Fn(Op) -> bool) {
        let long = operation.operands().len() > 2;
        for pair in Pair::all(operation, held) {
            self.change(pair, |holders| {
                holders.insert(op, long);
            });
        }
    }

    fn forget(&mut self, op: Op, operation: &Operation, held: &dyn Fn(Op) -> bool) {
        for pair in Pair::all(operation, held) {
            self.change(pair, |holders| {
                holders.remove(&op);
            });
        }
    }

    fn change(&mut self, pair: Pair, change: impl FnOnce(&mut BTreeMap<Op, bool>)) {
        let holders = self.holders.entry(pair).or_default();
        self.candidates.remove(&(holders.len(), std::cmp::Reverse(pair)));
        change(holders);
        if holders.len() >= 2 && holders.values().any(|&long| long) {
            self.candidates.insert((holders.len(), std::cmp::Reverse(pair)));
        }
    }

    fn most_frequent(&self) -> Option<Pair> {
        self.candidates.last().map(|&(_, std::cmp::Reverse(pair))| pair)
    }

    fn holders(&self, pair: &Pair) -> Vec<Op> {
        self.holders.get(pair).map(|holders| holders.keys().copied().collect()).unwrap_or_default()
    }
}

/// Two operands that occur together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
enum Pair {
    Factors(Op, Op),
    /// `true` if the signs differ.
    Addends(Op, Op, bool),
}

impl Pair {
    fn of_addends((m, a): (bool, Op), (n, b): (bool, Op)) -> Self {
        Self::Addends(a.min(b), a.max(b), m != n)
    }

    fn operands(self) -> [Op; 2] {
        match self {
            Self::Factors(a, b) | Self::Addends(a, b, _) => [a, b],
        }
    }

    /// The pairs of an operation's operands with at least one that is `held`, each once. A node of two operands is the
    /// pair itself: it counts as an occurrence of it.
    fn all(operation: &Operation, held: &dyn Fn(Op) -> bool) -> Vec<Self> {
        let mut pairs: Vec<Self> = Vec::new();
        if operation.operands().len() > LONGEST {
            return pairs;
        }
        match operation {
            Operation::Product(factors) => {
                for (i, &a) in factors.iter().enumerate() {
                    let rest = factors[i + 1..].iter().filter(|&&b| held(a) || held(b));
                    pairs.extend(rest.map(|&b| Self::Factors(a.min(b), a.max(b))));
                }
            }
            Operation::Sum(addends) => {
                for (i, &a) in addends.iter().enumerate() {
                    let rest = addends[i + 1..].iter().filter(|b| held(a.1) || held(b.1));
                    pairs.extend(rest.map(|&b| Self::of_addends(a, b)));
                }
            }
            _ => {}
        }
        pairs.sort_unstable();
        pairs.dedup();
        pairs
    }

    /// Where two addends make the pair. An operand may occur more than once, so places count, not operands.
    fn places(&self, addends: &[(bool, Op)]) -> Option<(usize, usize)> {
        let [a, b] = self.operands();
        let first = (0..addends.len()).filter(|&i| addends[i].1 == a || addends[i].1 == b);
        let mut places = first.flat_map(|i| (i + 1..addends.len()).map(move |j| (i, j)));
        places.find(|&(i, j)| Self::of_addends(addends[i], addends[j]) == *self)
    }

    fn occurs(&self, operation: &Operation) -> bool {
        match (self, operation) {
            (Self::Factors(a, b), Operation::Product(factors)) => {
                let count = |op: &Op| factors.iter().filter(|factor| *factor == op).count();
                if a == b { count(a) >= 2 } else { count(a) >= 1 && count(b) >= 1 }
            }
            (Self::Addends(..), Operation::Sum(addends)) => self.places(addends).is_some(),
            _ => false,
        }
    }

    /// Puts `shared` in the place of one occurrence, if there is one.
    fn replace(&self, operation: &mut Operation, shared: Op) -> bool {
        if operation.operands().len() <= 2 || !self.occurs(operation) {
            return false;
        }
        match (self, operation) {
            (Self::Factors(a, b), Operation::Product(factors)) => {
                for op in [a, b] {
                    if let Some(at) = factors.iter().position(|factor| factor == op) {
                        factors.remove(at);
                    }
                }
                factors.push(shared);
                factors.sort();
            }
            (Self::Addends(first, ..), Operation::Sum(addends)) => {
                let Some((i, j)) = self.places(addends) else { return false };
                let later = addends.remove(j);
                let earlier = addends.remove(i);
                // the pair has the sign of its first operand
                let sign = if earlier.1 == *first { earlier.0 } else { later.0 };
                addends.push((sign, shared));
                addends.sort_by_key(|&(_, op)| op);
            }
            _ => return false,
        }
        true
    }
}
