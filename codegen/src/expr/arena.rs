//! The hash-consed arena of expressions.
//!
//! Nodes are immutable, identified by small integers, and canonical by construction: sums are flat with like terms
//! collected, products are flat with like factors collected and carry no constant, constants are folded exactly.
//! Equal expressions built in any order are therefore the same node, and a subexpression that occurs twice is stored
//! once. Nothing is ever multiplied out.

use std::cell::{Cell, RefCell};
use std::collections::BTreeSet;
use std::rc::Rc;

use rustc_hash::{FxHashMap, FxHashSet};

use super::node::{Function, Id, Node, Stage, Sum, Symbol, SymbolInfo};
use super::number::Number;

#[derive(Default)]
struct Store {
    nodes: Vec<Node>,
    /// The stage of each node: asked of one after the other, it would take as long as all that they are made of.
    stages: Vec<Stage>,
    index: FxHashMap<Node, Id>,
    symbols: Vec<SymbolInfo>,
    /// Role names of nodes, and in which order they were given.
    roles: Vec<(Id, String)>,
    named: FxHashSet<Id>,
    rules: Vec<Rc<RuleApplied>>,
    /// For each value the place of its rule.
    rule_of: FxHashMap<Id, usize>,
    /// Radicands that can be zero, in the order in which they were made.
    radicands: Vec<Id>,
}

/// The changes of a rule's values along these changes of their arguments.
type Along = dyn Fn(&Arena, &RuleApplied, &[Id]) -> Vec<Id>;

/// Values with what they are functions of, and the rule of their derivative.
pub(super) struct RuleApplied {
    pub(super) values: Vec<Id>,
    pub(super) arguments: Vec<Id>,
    /// Further ingredients of the derivative, beside the values.
    pub(super) given: Vec<Id>,
    pub(super) along: Rc<Along>,
}

impl RuleApplied {
    /// The same of what takes the place of all that it is of and made of.
    pub(super) fn image(&self, mut image: impl FnMut(Id) -> Id) -> Self {
        let mut images = |ids: &[Id]| ids.iter().map(|&id| image(id)).collect();
        let (arguments, given) = (images(&self.arguments), images(&self.given));
        Self { values: images(&self.values), arguments, given, along: Rc::clone(&self.along) }
    }
}

/// Where expressions live.
pub struct Arena {
    store: RefCell<Store>,
    /// How many operands the sums and products have that were made, whether they were new or not.
    work: Cell<usize>,
    limit: usize,
    /// Whether all constants are finite.
    finite: Cell<bool>,
}

impl Default for Arena {
    fn default() -> Self {
        Self::limited(usize::MAX)
    }
}

impl Arena {
    /// An empty arena.
    pub fn new() -> Self {
        Self::default()
    }

    /// An empty arena in which the sums and products that are made may have so many operands. Once they have more, the
    /// arena is exhausted: everything made from then on is the constant 0, so that whatever goes on soon comes to its
    /// end.
    pub fn limited(limit: usize) -> Self {
        Self { store: RefCell::default(), work: Cell::new(0), limit, finite: Cell::new(true) }
    }

    /// How many operands the sums and products have that were made.
    pub fn work(&self) -> usize {
        self.work.get()
    }

    /// Whether more was made than the limit allows. What was made is of no use then.
    pub fn is_exhausted(&self) -> bool {
        self.work.get() > self.limit
    }

    /// Whether no constant that was made is infinite or not a number.
    pub fn is_finite(&self) -> bool {
        self.finite.get()
    }

    /// Takes note of work.
    pub(crate) fn charge(&self, operands: usize) {
        self.work.set(self.work.get().saturating_add(operands));
    }

    /// A node.
    pub fn node(&self, id: Id) -> Node {
        self.store.borrow().nodes[id.0 as usize].clone()
    }

    /// Reads a node, without making others.
    pub(super) fn with_node<R>(&self, id: Id, of: impl FnOnce(&Node) -> R) -> R {
        of(&self.store.borrow().nodes[id.0 as usize])
    }

    /// A symbol's name and stage.
    pub fn symbol_info(&self, symbol: Symbol) -> SymbolInfo {
        self.store.borrow().symbols[symbol.0 as usize].clone()
    }

    /// The node that an exhausted arena makes.
    fn exhausted(&self) -> Id {
        self.intern(Node::Number(Number::ZERO))
    }

    pub(super) fn intern(&self, node: Node) -> Id {
        let mut store = self.store.borrow_mut();
        if let Some(&id) = store.index.get(&node) {
            return id;
        }
        if !node.is_finite() {
            self.finite.set(false);
        }
        let id = Id(store.nodes.len() as u32);
        let stage = match &node {
            Node::Symbol(symbol) => store.symbols[symbol.0 as usize].stage,
            node => {
                let stages = node.operands().map(|operand| store.stages[operand.0 as usize]);
                stages.max().unwrap_or(Stage::Parameters)
            }
        };
        store.nodes.push(node.clone());
        store.stages.push(stage);
        store.index.insert(node, id);
        id
    }

    /// A new symbol, different from all others whatever its name.
    pub(super) fn new_symbol(&self, info: SymbolInfo) -> Id {
        let symbol = {
            let mut store = self.store.borrow_mut();
            store.symbols.push(info);
            Symbol(store.symbols.len() as u32 - 1)
        };
        self.intern(Node::Symbol(symbol))
    }

    /// `constant + Σ coefficient · term`, canonical.
    pub(crate) fn sum(&self, mut constant: Number, addends: impl IntoIterator<Item = (Id, Number)>) -> Id {
        let mut terms: Vec<(Id, Number)> = Vec::new();
        for (id, coefficient) in addends {
            self.charge(1);
            if self.is_exhausted() {
                return self.exhausted();
            }
            match self.node(id) {
                Node::Number(number) => constant = constant + coefficient * number,
                // a scaled term, or a sum added or subtracted as it is; a sum scaled otherwise stays factored
                Node::Sum(sum) if sum.is_scaled_term() || coefficient.abs().is_one() => {
                    self.charge(sum.terms.len());
                    constant = constant + coefficient * sum.constant;
                    terms.extend(sum.terms.iter().map(|&(id, c)| (id, coefficient * c)));
                }
                _ => terms.push((id, coefficient)),
            }
        }
        terms.sort_by_key(|&(id, _)| id);
        let mut collected: Vec<(Id, Number)> = Vec::with_capacity(terms.len());
        for (id, coefficient) in terms {
            match collected.last_mut() {
                Some((last, total)) if *last == id => *total = *total + coefficient,
                _ => collected.push((id, coefficient)),
            }
        }
        collected.retain(|(_, coefficient)| !coefficient.is_zero());
        match collected.as_slice() {
            [] => self.intern(Node::Number(constant)),
            [(id, coefficient)] if constant.is_zero() && coefficient.is_one() => *id,
            _ => self.intern(Node::Sum(Sum { constant, terms: collected.into() })),
        }
    }

    /// `coefficient · Π factor^exponent`, canonical.
    pub(crate) fn product(
        &self,
        mut coefficient: Number,
        factors: impl IntoIterator<Item = (Id, i32)>,
    ) -> Id {
        let mut collected: Vec<(Id, i32)> = Vec::new();
        let mut pending: Vec<(Id, i32)> = factors.into_iter().collect();
        while let Some((id, exponent)) = pending.pop() {
            self.charge(1);
            if self.is_exhausted() {
                return self.exhausted();
            }
            match self.node(id) {
                _ if exponent == 0 => {}
                Node::Number(number) => coefficient = coefficient * number.powi(exponent),
                Node::Product(inner) => {
                    pending.extend(inner.iter().map(|&(id, e)| (id, e.saturating_mul(exponent))))
                }
                Node::Sum(sum) => {
                    self.charge(sum.terms.len());
                    // scale and sign go outside, so that 2x, (a − b) and (b − a) are known for what they are
                    let content = sum.content();
                    if content.is_one() {
                        collected.push((id, exponent));
                    } else {
                        coefficient = coefficient * content.powi(exponent);
                        let rest = sum.terms.iter().map(|&(id, c)| (id, c.without(content)));
                        pending.push((self.sum(sum.constant.without(content), rest), exponent));
                    }
                }
                Node::Function(Function::Sqrt, radicand) if exponent % 2 == 0 => {
                    pending.push((radicand, exponent / 2));
                }
                _ => collected.push((id, exponent)),
            }
        }
        if coefficient.is_zero() {
            return self.intern(Node::Number(Number::ZERO));
        }
        let merged = merged(collected);
        // merging can make a root's exponent even
        if merged
            .iter()
            .any(|&(id, e)| e % 2 == 0 && matches!(self.node(id), Node::Function(Function::Sqrt, _)))
        {
            return self.product(coefficient, merged);
        }
        if let Some(merged) = self.with_whole_powers(&merged) {
            return self.product(coefficient, merged);
        }
        let base = match merged.as_slice() {
            [] => return self.intern(Node::Number(coefficient)),
            [(id, 1)] => *id,
            _ => self.intern(Node::Product(merged.into())),
        };
        self.sum(Number::ZERO, [(base, coefficient)])
    }

    /// `xⁿ x = xⁿ⁺¹`, and `xⁿ/x = xⁿ⁻¹`, where n is no number: where x is zero the left sides may be no numbers where the others are.
    fn with_whole_powers(&self, factors: &[(Id, i32)]) -> Option<Vec<(Id, i32)>> {
        let is_root = |id: Id, of: Id| self.node(id) == Node::Function(Function::Sqrt, of);
        let times = |exponent: Id, e: i32| self.expr(exponent).scale(Number::from(i64::from(e)));
        factors.iter().enumerate().find_map(|(place, &(factor, e))| {
            let Node::Power(base, exponent) = self.node(factor) else { return None };
            if matches!(self.node(exponent), Node::Number(_)) {
                return None;
            }
            let (other, more) = factors.iter().enumerate().find_map(|(other, &(id, k))| {
                let more = match self.node(id) {
                    _ if id == base => self.number(Number::from(i64::from(k))),
                    _ if is_root(base, id) => self.number(Number::from(2 * i64::from(k))),
                    _ if is_root(id, base) => self.number(Number::ratio(i128::from(k), 2)),
                    Node::Power(x, exponent) if x == base && other > place => times(exponent, k),
                    _ => return None,
                };
                Some((other, more))
            })?;
            let mut factors = factors.to_vec();
            factors[place] = (self.power(base, (times(exponent, e) + more).id), 1);
            factors.remove(other);
            Some(factors)
        })
    }

    /// `function(argument)`, folded where the value is exactly known.
    pub(crate) fn function(&self, function: Function, argument: Id) -> Id {
        self.charge(1);
        if self.is_exhausted() {
            return self.exhausted();
        }
        if let Node::Number(number) = self.node(argument)
            && let Some(value) = function.exact(number)
        {
            return self.intern(Node::Number(value));
        }
        if function == Function::Sqrt {
            if let Some(root) = self.root_of_squares(argument) {
                return root;
            }
            if let Some(root) = self.in_branches(argument, |x| self.function(Function::Sqrt, x)) {
                return root;
            }
        }
        let before = self.len();
        let id = self.intern(Node::Function(function, argument));
        if function == Function::Sqrt && self.len() > before {
            self.note_radicand(argument);
        }
        id
    }

    /// The root of what squares are a factor of: `√(s²) = s`, where `s` is no less than zero, `√(x⁴) = x²`, and
    /// `√(f² x + f² y) = |f| √(x + y)`.
    fn root_of_squares(&self, argument: Id) -> Option<Id> {
        let half = |&(factor, e): &(Id, i32)| match self.is_nonnegative(factor) {
            true => (factor, e / 2),
            false => (self.function(Function::Sqrt, self.product(Number::ONE, [(factor, 2)])), e / 2),
        };
        let sum = match self.node(argument) {
            Node::Product(factors) => {
                let [(square, e)] = factors[..] else { return None };
                let is_square = e % 2 == 0 && matches!(self.node(square), Node::Sum(_));
                return (e % 4 == 0 || is_square && self.is_nonnegative(square))
                    .then(|| self.product(Number::ONE, [(square, e / 2)]));
            }
            Node::Sum(sum) if sum.terms.len() > 1 && sum.constant.is_zero() => sum,
            _ => return None,
        };
        let factors = |term: Id| match self.node(term) {
            Node::Product(factors) => factors.to_vec(),
            _ => Vec::new(),
        };
        let mut common = factors(sum.terms[0].0);
        // of parameters powers are not to be taken apart, of a velocity for example
        common.retain(|&(factor, e)| e % 2 == 0 && self.expr(factor).stage() > Stage::Parameters);
        for &(term, _) in &sum.terms[1..] {
            if common.is_empty() {
                return None;
            }
            let other = factors(term);
            common.retain(|factor| other.contains(factor));
        }
        if common.is_empty() {
            return None;
        }
        let (_, first) = sum.terms[0];
        let size = first.exact_sqrt().filter(|_| sum.terms.iter().all(|&(_, c)| c == first));
        let (size, per_size) = size.map_or((Number::ONE, Number::ONE), |size| (size, first.powi(-1)));
        let inverse: Vec<_> = common.iter().map(|&(factor, e)| (factor, -e)).collect();
        let rest = |&(term, c): &(Id, Number)| {
            (self.product(Number::ONE, inverse.iter().copied().chain([(term, 1)])), c * per_size)
        };
        let rest = self.sum(Number::ZERO, sum.terms.iter().map(rest).collect::<Vec<_>>());
        // where it is less than zero the whole has a root at the zeros of the factors alone
        if !self.is_nonnegative(rest) {
            return None;
        }
        let root = self.function(Function::Sqrt, rest);
        Some(self.product(size, common.iter().map(half).chain([(root, 1)]).collect::<Vec<_>>()))
    }

    pub(crate) fn power(&self, base: Id, exponent: Id) -> Id {
        match self.node(exponent) {
            Node::Number(Number::Rational(r)) if r.is_integer() && i32::try_from(*r.numer()).is_ok() => {
                self.product(Number::ONE, [(base, *r.numer() as i32)])
            }
            Node::Number(Number::Rational(r)) if *r.denom() == 2 && i32::try_from(*r.numer()).is_ok() => {
                let root = self.function(Function::Sqrt, base);
                self.product(Number::ONE, [(root, *r.numer() as i32)])
            }
            _ => {
                let of_zero = |x: Id| match self.node(x) {
                    // with what a derivative by the exponent is there
                    Node::Number(number) if number.is_zero() => {
                        let [zero, below] = [self.zero(), self.expr(exponent).scale(-1)];
                        below.choose(zero, self.expr(self.intern(Node::Power(x, exponent)))).id
                    }
                    _ => self.power(x, exponent),
                };
                if let Some(power) = self.in_branches(base, of_zero) {
                    return power;
                }
                let before = self.len();
                let id = self.intern(Node::Power(base, exponent));
                if self.len() > before {
                    self.note_radicand(base);
                }
                id
            }
        }
    }

    /// A root or a power of a choice one branch of which is a number, no less than zero, or of a multiple of a choice between something and zero: in
    /// each branch, for where that number is zero the derivatives are zero, and those of the root are not.
    fn in_branches(&self, choice: Id, of: impl Fn(Id) -> Id) -> Option<Id> {
        let is_number = |id: Id| matches!(self.node(id), Node::Number(number) if !number.is_negative());
        let [x, y, z] = self.multiple_of_choice(choice)?;
        (is_number(y) || is_number(z)).then(|| self.choice([x, of(y), of(z)]))
    }

    /// The condition and the branches of a choice, or of a multiple of one between something and zero.
    fn multiple_of_choice(&self, id: Id) -> Option<[Id; 3]> {
        let is_zero = |id: Id| matches!(self.node(id), Node::Number(number) if number.is_zero());
        match self.node(id) {
            Node::Choice(branches) => Some(branches),
            Node::Product(factors) => factors.iter().enumerate().find_map(|(place, &(factor, e))| {
                let Node::Choice([x, y, z]) = self.node(factor) else { return None };
                let with = |branch: Id| {
                    let mut factors = factors.to_vec();
                    factors[place].0 = branch;
                    self.product(Number::ONE, factors)
                };
                (e == 1 && (is_zero(y) || is_zero(z))).then(|| [x, with(y), with(z)])
            }),
            Node::Sum(sum) if sum.is_scaled_term() => {
                let (term, number) = sum.terms[0];
                let [x, y, z] = self.multiple_of_choice(term)?;
                let scaled = |branch: Id| self.sum(Number::ZERO, [(branch, number)]);
                Some([x, scaled(y), scaled(z)])
            }
            _ => None,
        }
    }

    /// How many nodes there are.
    fn len(&self) -> usize {
        self.store.borrow().nodes.len()
    }

    /// One of those of which roots are taken that can be zero.
    pub(super) fn radicand(&self, place: usize) -> Option<Id> {
        self.store.borrow().radicands.get(place).copied()
    }

    pub(super) fn insert_radicand(&self, radicand: Id) {
        let mut store = self.store.borrow_mut();
        if !store.radicands.contains(&radicand) {
            store.radicands.push(radicand);
        }
    }

    /// The nodes that some are made of, and these themselves, in the order in which a walk along the operands is done
    /// with them: operands before what is made of them. What `skipped` admits is left out, with all that only it is
    /// made of.
    ///
    /// Whoever goes through a graph goes through this list: a graph may be deeper than any stack.
    pub fn post_order(&self, from: impl IntoIterator<Item = Id>, skipped: impl Fn(Id) -> bool) -> Vec<Id> {
        let store = self.store.borrow();
        let mut seen = vec![false; store.nodes.len()];
        let mut order = Vec::new();
        // with how many of their operands were gone through
        let mut open: Vec<(Id, usize)> = Vec::new();
        let mut is_new = |id: Id| !skipped(id) && !std::mem::replace(&mut seen[id.0 as usize], true);
        for root in from {
            if is_new(root) {
                open.push((root, 0));
            }
            while let Some((id, gone)) = open.last_mut() {
                let next = store.nodes[id.0 as usize].operand(*gone);
                *gone += 1;
                match next {
                    Some(next) if is_new(next) => open.push((next, 0)),
                    Some(_) => {}
                    None => {
                        order.push(*id);
                        open.pop();
                    }
                }
            }
        }
        order
    }

    /// The earliest stage at which a node's value is known.
    pub(super) fn stage(&self, id: Id) -> Stage {
        self.store.borrow().stages[id.0 as usize]
    }

    /// Whether any symbol that occurs in these nodes is one that is looked for.
    pub(super) fn any_symbol(
        &self,
        nodes: impl IntoIterator<Item = Id>,
        mut is_wanted: impl FnMut(Symbol) -> bool,
    ) -> bool {
        let store = self.store.borrow();
        let mut seen = FxHashSet::default();
        let mut pending: Vec<Id> = nodes.into_iter().collect();
        while let Some(id) = pending.pop() {
            if seen.insert(id) {
                match &store.nodes[id.0 as usize] {
                    Node::Symbol(symbol) if is_wanted(*symbol) => return true,
                    node => pending.extend(node.operands()),
                }
            }
        }
        false
    }

    /// The nodes that one is made of and that nothing is known of, itself included, in the order of creation: operands
    /// before what is made of them.
    pub(crate) fn unknown<T>(&self, id: Id, known: &FxHashMap<Id, T>) -> BTreeSet<Id> {
        let store = self.store.borrow();
        let mut unknown = BTreeSet::new();
        let mut pending = vec![id];
        while let Some(id) = pending.pop() {
            if !known.contains_key(&id) && unknown.insert(id) {
                pending.extend(store.nodes[id.0 as usize].operands());
            }
        }
        unknown
    }

    /// The role names that were given, in that order.
    pub fn roles(&self) -> Vec<(Id, String)> {
        self.store.borrow().roles.clone()
    }

    /// Gives a node a role name. The first one stays; symbols and constants have names enough.
    pub(super) fn name(&self, id: Id, name: String) {
        let mut store = self.store.borrow_mut();
        let is_leaf = matches!(store.nodes[id.0 as usize], Node::Symbol(_) | Node::Number(_));
        if !is_leaf && store.named.insert(id) {
            store.roles.push((id, name));
        }
    }

    /// Gives the role of a node to the node that takes its place.
    pub(crate) fn pass_role(&self, from: Id, to: Id) {
        let role = {
            let store = self.store.borrow();
            if !store.named.contains(&from) {
                return;
            }
            store.roles.iter().find(|(id, _)| *id == from).map(|(_, name)| name.clone())
        };
        if let Some(role) = role {
            self.name(to, role);
        }
    }

    /// The rule that a value's derivative follows.
    pub(super) fn rule(&self, id: Id) -> Option<Rc<RuleApplied>> {
        let store = self.store.borrow();
        store.rule_of.get(&id).map(|&place| Rc::clone(&store.rules[place]))
    }

    /// Gives values a rule; the first one of a value stays. Constants and symbols have derivatives of their own; and
    /// what is older than an argument, such as the argument itself where a value is the same, may be what that is made
    /// of.
    pub(super) fn insert_rule(&self, rule: RuleApplied) {
        let is_whole = |&id: &Id| matches!(self.node(id), Node::Held(_));
        let is_newer = |id: &Id| rule.arguments.iter().all(|argument| argument < id);
        if rule.values.iter().all(|id| is_whole(id) && is_newer(id)) {
            let mut store = self.store.borrow_mut();
            let place = store.rules.len();
            for &value in &rule.values {
                store.rule_of.entry(value).or_insert(place);
            }
            store.rules.push(Rc::new(rule));
        }
    }

    /// The node made anew of the images of its operands.
    pub(crate) fn rebuild(&self, id: Id, mut image: impl FnMut(Id) -> Id) -> Id {
        match self.node(id) {
            Node::Number(_) | Node::Symbol(_) => id,
            Node::Sum(sum) => {
                let terms: Vec<_> = sum.terms.iter().map(|&(term, c)| (image(term), c)).collect();
                self.sum(sum.constant, terms)
            }
            Node::Product(factors) => {
                let factors: Vec<_> = factors.iter().map(|&(factor, e)| (image(factor), e)).collect();
                self.product(Number::ONE, factors)
            }
            Node::Function(function, argument) => self.function(function, image(argument)),
            Node::Power(base, exponent) => self.power(image(base), image(exponent)),
            Node::Atan2(y, x) => self.atan2(image(y), image(x)),
            Node::Choice(operands) => self.choice(operands.map(image)),
            Node::Held(inner) => self.held(image(inner)),
        }
    }

    /// The value kept whole; constants, symbols and what is whole already stay as they are.
    pub(crate) fn held(&self, id: Id) -> Id {
        match self.node(id) {
            Node::Sum(_) | Node::Product(_) => self.intern(Node::Held(id)),
            _ => id,
        }
    }

    pub(crate) fn atan2(&self, y: Id, x: Id) -> Id {
        self.intern(Node::Atan2(y, x))
    }

    /// `y` where `x < 0`, `z` elsewhere, folded where it is known which.
    pub(crate) fn choice(&self, [x, y, z]: [Id; 3]) -> Id {
        self.charge(1);
        if self.is_exhausted() {
            return self.exhausted();
        }
        if y == z {
            return z;
        }
        let taken = |number: Number| if number.is_negative() { y } else { z };
        match self.node(x) {
            Node::Number(number) => return taken(number),
            // of truths, as a negation is
            Node::Choice([x, a, b]) => {
                if let (Node::Number(a), Node::Number(b)) = (self.node(a), self.node(b)) {
                    return self.choice([x, taken(a), taken(b)]);
                }
            }
            _ => {}
        }
        self.intern(Node::Choice([x, y, z]))
    }

    /// What a node is the absolute value of, if it is one.
    pub(super) fn absolute(&self, id: Id) -> Option<Id> {
        match self.node(id) {
            Node::Choice([x, y, z]) if x == z && y == self.sum(Number::ZERO, [(x, Number::MINUS_ONE)]) => {
                Some(x)
            }
            _ => None,
        }
    }
}

/// Factors sorted, each once, without those that cancel.
fn merged(mut factors: Vec<(Id, i32)>) -> Vec<(Id, i32)> {
    factors.sort_by_key(|&(id, _)| id);
    let mut merged: Vec<(Id, i32)> = Vec::with_capacity(factors.len());
    for (id, exponent) in factors {
        match merged.last_mut() {
            Some((last, total)) if *last == id => *total = total.saturating_add(exponent),
            _ => merged.push((id, exponent)),
        }
    }
    merged.retain(|&(_, exponent)| exponent != 0);
    merged
}
