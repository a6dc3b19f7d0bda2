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
        while let Some(&(_, std::cmp::Reverse(pair))) = index.candidates.last() {
            let before = self.ops().len();
            let shared = self.intern(pair.operation());
            if self.ops().len() > before {
                index.count(shared, self.operation(shared), &|_| true);
            }
            // no other pairs come or go
            let changed = |op: Op| [pair.a, pair.b, shared].contains(&op);
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
            self.change(pair, |holders| _ = holders.insert(op, long));
        }
    }

    fn forget(&mut self, op: Op, operation: &Operation, held: &dyn Fn(Op) -> bool) {
        for pair in Pair::all(operation, held) {
            self.change(pair, |holders| _ = holders.remove(&op));
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

    fn holders(&self, pair: &Pair) -> Vec<Op> {
        self.holders.get(pair).map(|holders| holders.keys().copied().collect()).unwrap_or_default()
    }
}

/// Two operands that occur together, in a product or in a sum.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
struct Pair {
    of_sum: bool,
    a: Op,
    b: Op,
    /// Whether their signs differ.
    opposed: bool,
}

/// The operands of a product, which have no signs, or of a sum; none of others.
fn signed(operation: &Operation) -> (bool, Vec<(bool, Op)>) {
    match operation {
        Operation::Product(factors) => (false, factors.iter().map(|&factor| (false, factor)).collect()),
        Operation::Sum(addends) => (true, addends.clone()),
        _ => (false, Vec::new()),
    }
}

impl Pair {
    fn of(of_sum: bool, (m, a): (bool, Op), (n, b): (bool, Op)) -> Self {
        Self { of_sum, a: a.min(b), b: a.max(b), opposed: m != n }
    }

    /// The operation that makes it.
    fn operation(self) -> Operation {
        match self.of_sum {
            true => Operation::Sum(vec![(false, self.a), (self.opposed, self.b)]),
            false => Operation::Product(vec![self.a, self.b]),
        }
    }

    /// The pairs of an operation's operands with at least one that is `held`, each once. A node of two operands is the
    /// pair itself: it counts as an occurrence of it.
    fn all(operation: &Operation, held: &dyn Fn(Op) -> bool) -> Vec<Self> {
        let (of_sum, operands) = signed(operation);
        let mut pairs: Vec<Self> = Vec::new();
        if operands.len() <= LONGEST {
            for (i, &a) in operands.iter().enumerate() {
                let rest = operands[i + 1..].iter().filter(|b| held(a.1) || held(b.1));
                pairs.extend(rest.map(|&b| Self::of(of_sum, a, b)));
            }
        }
        pairs.sort_unstable();
        pairs.dedup();
        pairs
    }

    /// Puts `shared` in the place of one occurrence, if there is one. An operand may occur more than once, so places
    /// count, not operands.
    fn replace(self, operation: &mut Operation, shared: Op) -> bool {
        let (of_sum, mut operands) = signed(operation);
        if operands.len() <= 2 || of_sum != self.of_sum {
            return false;
        }
        let first = (0..operands.len()).filter(|&i| [self.a, self.b].contains(&operands[i].1));
        let mut places = first.flat_map(|i| (i + 1..operands.len()).map(move |j| (i, j)));
        let Some((i, j)) = places.find(|&(i, j)| Self::of(of_sum, operands[i], operands[j]) == self) else {
            return false;
        };
        let later = operands.remove(j);
        let earlier = operands.remove(i);
        // the pair has the sign of its first operand
        let sign = if earlier.1 == self.a { earlier.0 } else { later.0 };
        operands.push((sign, shared));
        operands.sort_by_key(|&(_, op)| op);
        *operation = match of_sum {
            true => Operation::Sum(operands),
            false => Operation::Product(operands.into_iter().map(|(_, op)| op).collect()),
        };
        true
    }
}
