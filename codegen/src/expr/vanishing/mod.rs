//! Derivatives where a root is zero.
//!
//! A root `r = √s` has no derivative where `s` vanishes: `ds / 2r` is bounded there, but has no limit. What it is
//! multiplied by decides. `|v| v` has a derivative at rest, though the rules of differentiation write `v vᵀ / |v|`;
//! `|v|` alone has none. Every factor of a term is given the order to which it vanishes with `s`, in powers of `s`, or
//! a lower bound of it:
//!
//! * `s` has the order 1, its powers have their exponents, and `xᵢ` has 1/2 where `s = x₁² + x₂² + …`, since
//!   `|xᵢ| ≤ √s`;
//! * a product has the sum of its factors' orders, a sum the least of its terms';
//! * where a sum's terms add up to zero with the root, as in `1 − e⁻ʳ`, it has the least order of their changes.
//!
//! A term of positive order has the limit 0. There the negative power of the root is one that [is
//! zero](Function::RecipOrZero) with the root. If all terms are like this, the derivative of a continuous function has
//! a limit where `s` vanishes, and by the mean value theorem that is its derivative there. Every other term stays as it
//! is, and what is divided by zero in it is infinite or not a number: a derivative that does not exist is not made up.
//!
//! Before that, roots are taken out of denominators where algebra can do it: powers of `s` are put together, and an odd
//! function of a root over that root is a smooth function of `s`: `sin(r)/r = c₁(s)`, `atan2(r, w)/r = a(w/ρ)/ρ` with
//! `ρ² = s + w²` and `a(cos θ) = θ / sin θ`. What is smooth though it is written with roots, as the square of an angle,
//! has derivatives of all orders then.
//!
//! What is bounded and has no limit, `xᵢ vⱼ / r`, has the limit 0 where another factor is zero by its value: in
//! derivatives that are [not taken again](super::Derivative::last). A root that a parameter `l` is subtracted from, in
//! `(r − l)²`, [is of a little more](Expr::with_lengths) where `l` is zero.

mod corrections;
mod odd;
mod order;
mod sums;

use std::collections::BTreeMap;

use rustc_hash::FxHashMap;

use super::arena::Arena;
use super::expression::Expr;
use super::node::{Function, Id, Node, Stage, Sum};
use super::number::Number;

/// An order that is positive, and not by rounding.
const POSITIVE: f64 = 1e-9;
/// The terms of a sum that is multiplied out, at most: those of a product of vectors.
const FEW: usize = 6;
/// Of what may be infinite faster than anything else vanishes.
const UNBOUNDED: f64 = -1e6;

/// The exponents of a root, and of its reciprocal.
fn half() -> Number {
    Number::ratio(1, 2)
}

impl<'a> Expr<'a> {
    /// The same value, and its limit where that of a root is zero and the expression has one.
    pub fn with_limits(self) -> Self {
        Limits::default().of(self)
    }

    /// The same of a force, which has one, too, where a parameter that it is a multiple of is zero. If it is to have a power `series`, it is made of
    /// no function that has none.
    pub fn with_limits_of_force(self, series: bool) -> Self {
        Limits { bases: Vec::new(), chosen: Chosen::Parameters { series } }.of(self)
    }
}

/// What is added under a root that has no derivative at zero but where a parameter is zero, if that is: less than what
/// rounding leaves of any other square.
const LEAST: [f64; 2] = [1e-300, 1e-37];

impl<'a> Expr<'a> {
    /// The same value where a length `l` that roots are compared with, as in `(r − l)²`, is not zero. Where it is, the root
    /// is of a little more, so that the whole has the derivatives that it has without it, at zero, too.
    pub fn with_lengths(self, is_single: bool) -> Self {
        let arena = self.arena;
        let mut lengths: BTreeMap<Id, Expr<'a>> = BTreeMap::new();
        for id in arena.post_order([self.id], |_| false) {
            let Node::Sum(Sum { constant, terms }) = arena.node(id) else { continue };
            let is_constant = |id: Id| arena.expr(id).stage() <= Stage::Parameters;
            let (others, changing): (Vec<_>, Vec<_>) = terms.iter().partition(|(term, _)| is_constant(*term));
            let length = arena.expr(arena.sum(constant, others));
            if let [(root, _)] = changing[..]
                && length.as_number().is_none()
                && let Some(square) = arena.radicand_of_factor(root)
            {
                lengths.entry(square).and_modify(|all| *all = *all * length).or_insert(length);
            }
        }
        if lengths.is_empty() {
            return self;
        }
        let mut known: FxHashMap<Id, Id> = FxHashMap::default();
        for id in arena.post_order([self.id], |_| false) {
            let mut image = arena.rebuild(id, |operand| known[&operand]);
            if let Node::Function(Function::Sqrt, square) = arena.node(id)
                && let Some(&length) = lengths.get(&square)
            {
                let least = arena.number(Number::Float(LEAST[usize::from(is_single)]));
                let more = length.choose(length, -length).choose(arena.zero(), least).hold();
                image = (arena.expr(known[&square]) + more).sqrt().id;
            }
            known.insert(id, image);
        }
        arena.expr(known[&self.id])
    }
}

/// Gives derivatives their limits where roots are zero.
#[derive(Default)]
pub(super) struct Limits<'a> {
    bases: Vec<Vanishing<'a>>,
    chosen: Chosen,
}

/// What limits may be chosen by: whether it is zero.
#[derive(Clone, Copy, Default, PartialEq, Eq)]
enum Chosen {
    #[default]
    Nothing,
    /// The size of a force.
    Parameters {
        /// Whether that is to have a power series.
        series: bool,
    },
    /// What is not differentiated again.
    State,
}

impl<'a> Limits<'a> {
    /// For derivatives that are not differentiated again.
    pub(super) fn of_last_derivatives() -> Self {
        Self { bases: Vec::new(), chosen: Chosen::State }
    }

    /// Of one expression.
    pub(super) fn of(&mut self, expr: Expr<'a>) -> Expr<'a> {
        let arena = expr.arena;
        let (mut id, mut place) = (expr.id, 0);
        // one base after the other; what is made for one can have another
        while let Some(base) = arena.radicand(place) {
            if self.bases.len() == place {
                self.bases.push(Vanishing::new(arena, base, self.chosen));
            }
            id = self.bases[place].limit(id, 0.0);
            place += 1;
        }
        if id != expr.id {
            arena.pass_role(expr.id, id);
        }
        arena.expr(id)
    }
}

impl Arena {
    /// Takes note of what a root is taken of, if it can be zero and depends on the state.
    pub(super) fn note_radicand(&self, mut radicand: Id) {
        while let Node::Function(Function::Sqrt, inner) | Node::Power(inner, _) = self.node(radicand) {
            radicand = inner;
        }
        let is_constant = matches!(self.node(radicand), Node::Number(_));
        if !is_constant && !self.is_positive(radicand) && self.expr(radicand).stage() > Stage::Parameters {
            self.insert_radicand(radicand);
        }
    }

    /// What the root is taken of that this is a multiple of.
    fn radicand_of_factor(&self, id: Id) -> Option<Id> {
        match self.node(id) {
            Node::Function(Function::Sqrt, x) => (!self.is_positive(x)).then_some(x),
            Node::Product(factors) => {
                let roots = factors.iter().filter(|(_, e)| *e == 1);
                roots.filter_map(|&(factor, _)| self.radicand_of_factor(factor)).next()
            }
            _ => None,
        }
    }

    /// Whether it is positive for all values of its symbols, as far as signs and squares tell.
    fn is_positive(&self, id: Id) -> bool {
        match self.node(id) {
            Node::Number(number) => !number.is_negative() && !number.is_zero(),
            Node::Sum(Sum { constant, terms }) => {
                let is_more = || !constant.is_zero() || terms.iter().any(|&(term, _)| self.is_positive(term));
                self.is_nonnegative(id) && is_more()
            }
            Node::Product(factors) => factors.iter().all(|&(factor, _)| self.is_positive(factor)),
            Node::Function(Function::Exp | Function::Cosh | Function::AngleOverSine(0), _) => true,
            Node::Function(Function::Sqrt, x) | Node::Held(x) | Node::Power(x, _) => self.is_positive(x),
            Node::Choice([_, y, z]) => self.is_positive(y) && self.is_positive(z),
            _ => false,
        }
    }

    /// Whether it is not negative where it is real.
    pub(super) fn is_nonnegative(&self, id: Id) -> bool {
        match self.node(id) {
            Node::Number(number) => !number.is_negative(),
            Node::Sum(Sum { constant, terms }) => {
                let is_no_less = |&(term, c): &(Id, Number)| !c.is_negative() && self.is_nonnegative(term);
                !constant.is_negative() && terms.iter().all(is_no_less)
            }
            Node::Product(factors) => {
                factors.iter().all(|&(factor, e)| e % 2 == 0 || self.is_nonnegative(factor))
            }
            Node::Function(
                Function::Exp | Function::Cosh | Function::Sqrt | Function::Acos | Function::AngleOverSine(0),
                _,
            ) => true,
            Node::Power(..) => true,
            Node::Held(x) => self.is_nonnegative(x),
            Node::Choice([x, y, z]) => {
                self.absolute(id).is_some() || self.is_nonnegative(y) && (z == x || self.is_nonnegative(z))
            }
            _ => false,
        }
    }
}

/// Factors with their exponents.
type Factors = Vec<(Id, i32)>;

/// What vanishes with the base of a root, and what becomes of derivatives there.
struct Vanishing<'a> {
    arena: &'a Arena,
    base: Id,
    chosen: Chosen,
    /// The base as a product of powers.
    factors: Vec<(Id, i32)>,
    /// Nodes that vanish with it, with their orders.
    orders: FxHashMap<Id, f64>,
    /// What nodes are where it is zero, and lower bounds of the orders of what they are more.
    values: FxHashMap<Id, (Option<Id>, f64)>,
    /// Those sums among them as rows in echelon form, each with the least of the orders that it is made of.
    rows: Vec<(BTreeMap<Id, Number>, f64)>,
    /// Whether nodes have negative powers of the base in them.
    divided: FxHashMap<Id, bool>,
    /// Whether nodes are odd.
    odd: FxHashMap<Id, bool>,
    /// Sums whose terms cancel, multiplied out to some that all vanish.
    cancelled: FxHashMap<Id, Option<Id>>,
    /// What has become of nodes that are multiplied by something of an order.
    limits: FxHashMap<(Id, u64), Id>,
}

impl<'a> Vanishing<'a> {
    fn new(arena: &'a Arena, base: Id, chosen: Chosen) -> Self {
        let factors = match arena.node(base) {
            Node::Product(factors) => factors.to_vec(),
            _ => Vec::new(),
        };
        let (orders, values, rows) = Default::default();
        let (divided, odd, cancelled, limits) = Default::default();
        let mut vanishing =
            Self { arena, base, chosen, factors, orders, values, rows, divided, odd, cancelled, limits };
        vanishing.learn(base, 1.0);
        vanishing
    }

    /// Takes note of what vanishes with a node that vanishes to an order.
    fn learn(&mut self, id: Id, order: f64) {
        self.orders.insert(id, order);
        match self.arena.node(id) {
            Node::Held(inner) => self.learn(inner, order),
            Node::Choice(_) => {
                if let Some(x) = self.arena.absolute(id) {
                    self.learn(x, order);
                }
            }
            Node::Product(_) => {
                if let &[(factor, e)] = &others(self.arena, id)[..]
                    && e > 0
                {
                    self.learn(factor, order / f64::from(e));
                }
            }
            Node::Sum(sum) => {
                let is_positive =
                    |&(term, c): &(Id, Number)| !c.is_negative() && square(self.arena, term).is_some();
                if sum.constant.is_zero() && sum.terms.iter().all(is_positive) {
                    // none of them is more than the sum
                    sum.terms.iter().for_each(|&(term, _)| self.learn_square(term, order));
                } else if sum.constant.is_zero() {
                    // it stands for itself, and together with others for all that they span
                    let (row, order) = self.reduced(sum.terms.iter().copied().collect(), order);
                    self.rows.extend((!row.is_empty()).then_some((row, order)));
                }
            }
            _ => {}
        }
    }

    /// Of a square times what is positive.
    fn learn_square(&mut self, term: Id, order: f64) {
        self.orders.insert(term, order);
        if let Some(Some((factor, exponent))) = square(self.arena, term) {
            self.learn(factor, order / f64::from(exponent));
        }
    }

    /// What is left of a sum without multiples of those known, and the least order of these.
    fn reduced(&self, mut row: BTreeMap<Id, Number>, mut order: f64) -> (BTreeMap<Id, Number>, f64) {
        for (known, of_known) in &self.rows {
            let Some((pivot, leading)) = known.first_key_value() else { continue };
            let Some(&entry) = row.get(pivot) else { continue };
            let factor = -(entry * leading.powi(-1));
            for (&term, &c) in known {
                let sum = row.get(&term).copied().unwrap_or(Number::ZERO) + factor * c;
                row.insert(term, sum);
            }
            row.retain(|_, c| !c.is_zero());
            order = order.min(*of_known);
        }
        (row, order)
    }

    /// The exponent of a power of the base.
    fn exponent(&self, id: Id) -> Option<Number> {
        if id == self.base {
            return Some(Number::ONE);
        }
        match self.arena.node(id) {
            Node::Function(Function::Sqrt, x) => Some(self.exponent(x)? * half()),
            Node::Function(Function::RecipOrZero, x) => Some(-self.exponent(x)?),
            Node::Power(x, exponent) => match self.arena.node(exponent) {
                Node::Number(number) => Some(self.exponent(x)? * number),
                _ => None,
            },
            Node::Product(factors) => factors.iter().try_fold(Number::ZERO, |sum, &(factor, e)| {
                Some(sum + self.exponent(factor)? * Number::from(i64::from(e)))
            }),
            _ => None,
        }
    }

    /// The base to a power.
    fn power(&self, exponent: Number) -> Id {
        let quarters = exponent * Number::from(4);
        if let (Some((_, 1)), Some((_, 4))) = (quarters.fraction(), exponent.fraction()) {
            return self.arena.power(
                self.arena.function(Function::Sqrt, self.base),
                self.arena.number(exponent * Number::from(2)).id,
            );
        }
        self.arena.power(self.base, self.arena.number(exponent).id)
    }

    /// Whether there is a negative power of the base in it, in a term of a sum or a factor of a product.
    fn is_divided(&mut self, root: Id) -> bool {
        for id in self.arena.unknown(root, &self.divided) {
            let is_divided = match self.arena.node(id) {
                Node::Product(factors) => factors.iter().any(|&(factor, e)| match self.exponent(factor) {
                    Some(exponent) => exponent.is_negative() != (e < 0),
                    None => self.divided[&factor],
                }),
                Node::Sum(sum) => sum.terms.iter().any(|(term, _)| self.divided[term]),
                Node::Held(inner) => self.divided[&inner],
                Node::Choice([_, y, z]) => !self.is_guarded(id) && (self.divided[&y] || self.divided[&z]),
                _ => {
                    self.exponent(id).is_some_and(Number::is_negative)
                        || self.uncertain_exponent(id).is_some()
                }
            };
            self.divided.insert(id, is_divided);
        }
        self.divided[&root]
    }

    /// The exponent of a power of the base that is known before a step begins, and may be negative: `n − 1`.
    fn uncertain_exponent(&self, id: Id) -> Option<Expr<'a>> {
        let Node::Power(x, exponent) = self.arena.node(id) else { return None };
        let of_base = self.exponent(x)?;
        let is_less = matches!(self.arena.node(exponent), Node::Sum(sum) if sum.constant.is_negative());
        let exponent = self.arena.expr(exponent);
        (is_less && exponent.stage() == Stage::Parameters).then(|| exponent.scale(of_base))
    }

    /// A node that is multiplied by something of an order.
    fn limit(&mut self, id: Id, around: f64) -> Id {
        if !self.is_divided(id) || self.arena.is_exhausted() {
            return id;
        }
        let key = (id, around.to_bits());
        if let Some(&known) = self.limits.get(&key) {
            return known;
        }
        let limit = match self.arena.node(id) {
            Node::Sum(sum) => {
                if self.may_be_base(&sum) {
                    let Monomial { power, mut rest, is_simpler, .. } = self.simplified(&[(id, 1)]);
                    rest.push((self.power(power), 1));
                    let whole = self.arena.product(Number::ONE, rest);
                    if is_simpler && !self.is_divided(whole) {
                        return whole;
                    }
                }
                let terms = self.together(&sum.terms, around);
                let terms: Vec<_> = terms.into_iter().map(|(x, c)| (self.limit(x, around), c)).collect();
                self.arena.sum(sum.constant, terms)
            }
            Node::Held(inner) => self.arena.held(self.limit(inner, around)),
            Node::Choice([x, y, z]) => self.arena.choice([x, self.limit(y, around), self.limit(z, around)]),
            Node::Product(factors) => self.limit_of_product(&factors, around),
            _ => self.limit_of_product(&[(id, 1)], around),
        };
        if limit != id {
            self.arena.pass_role(id, limit);
        }
        self.limits.insert(key, limit);
        limit
    }

    fn limit_of_product(&mut self, factors: &[(Id, i32)], around: f64) -> Id {
        // what is divided by a root in one branch is multiplied by what the others are there
        let divided = |&(factor, e): &(Id, i32)| {
            let branches = self.branches(factor).filter(|_| e == 1 && factors.len() > 1)?;
            self.is_divided(factor).then_some((factor, branches))
        };
        if let Some((choice, [x, y, z])) = factors.iter().find_map(divided) {
            let [y, z] = [(0, y), (1, z)].map(|(place, branch)| {
                let others = factors.iter().filter(|(factor, _)| *factor != choice);
                let there = others.map(|&(factor, e)| match self.branches(factor) {
                    Some([same, y, z]) if same == x => ([y, z][place], e),
                    _ => (factor, e),
                });
                let product: Vec<_> = there.chain([(branch, 1)]).collect();
                // of others nothing may be left to divide by there
                if product.iter().any(|&(factor, e)| e > 0 && self.is_zero(factor)) {
                    return self.arena.zero().id;
                }
                self.limit_of_product(&product, around)
            });
            return self.arena.choice([x, y, z]);
        }
        let Monomial { power, mut rest, is_simpler, .. } = self.simplified(factors);
        if power.is_negative()
            && let Some((place, sum)) = self.cancelled(&rest)
        {
            rest[place].0 = sum;
            rest.push((self.power(power), 1));
            return self.limit_of_product(&rest, around);
        }
        let mut total = around + power.to_f64();
        for &(factor, e) in &rest {
            total += powered(self.order(factor), f64::from(e));
        }
        let has_limit = power.is_negative() && total > POSITIVE;
        if let Some(chosen) = self.of_any_power(factors, power, &rest, total) {
            return chosen;
        }
        if power.is_negative() {
            // of what is chosen one branch may cancel the root, or vanish, and another not: each has its own limit, or none
            for (place, &(factor, e)) in rest.iter().enumerate() {
                let Some([x, y, z]) = self.branches(factor).filter(|_| e == 1) else { continue };
                let others = total - self.order(factor);
                let with = |branch: Id| {
                    let mut factors = rest.clone();
                    factors[place].0 = branch;
                    factors.push((self.power(power), 1));
                    factors
                };
                let products = [y, z].map(with);
                let is_better = |(branch, factors): (Id, &Vec<(Id, i32)>)| {
                    let cancels = !self.simplified(factors).power.is_negative();
                    cancels || !has_limit && others + self.order(branch) > POSITIVE
                };
                if [y, z].into_iter().zip(&products).any(is_better) {
                    let limits = products.map(|factors| self.limit_of_product(&factors, around));
                    return self.arena.choice([x, limits[0], limits[1]]);
                }
            }
        }
        let is_bounded = power.is_negative() && !has_limit && total > -POSITIVE;
        if is_bounded
            && matches!(self.chosen, Chosen::Parameters { .. })
            && let Some(chosen) = self.by_parameter(&rest, power)
        {
            return chosen;
        }
        let zero = if is_bounded && self.chosen == Chosen::State { self.zero_with(&rest) } else { None };
        if is_bounded
            && zero.is_none()
            && self.chosen == Chosen::State
            && let Some(sum) = self.multiplied_out(&rest, power, around)
        {
            return sum;
        }
        if !is_simpler && !has_limit && zero.is_none() {
            // as it was, but for the sums among the factors
            rest = factors.to_vec();
        }
        for (factor, e) in &mut rest {
            if *e > 0 && self.exponent(*factor).is_none() {
                let others = total - self.order(*factor);
                *factor = self.limit(*factor, others);
            }
        }
        let limit = self.arena.function(Function::RecipOrZero, self.power(-power));
        if has_limit {
            rest.push((limit, 1));
        } else if let Some(zero) = zero {
            // below zero where it is not zero
            let zero = self.arena.expr(zero);
            let negative = zero.choose(zero, -zero);
            rest.push((self.arena.choice([negative.id, self.power(power), limit]), 1));
        } else if is_simpler {
            rest.push((self.power(power), 1));
        }
        self.arena.product(Number::ONE, rest)
    }

    /// Of a force of constant size, `c x/r`: nothing where `c`, known before a step begins, is zero.
    fn by_parameter(&mut self, rest: &[(Id, i32)], power: Number) -> Option<Id> {
        let (mut small, mut size) = (vec![(self.power(power), 1)], Vec::new());
        for &(factor, e) in rest {
            let is_constant = self.arena.expr(factor).stage() <= Stage::Parameters;
            if is_constant { size.push((factor, e)) } else { small.push((factor, e)) }
        }
        let is_uncertain = size.iter().any(|&(factor, e)| e > 0 && self.is_uncertain(factor));
        if !is_uncertain || small[1..].iter().any(|&(factor, _)| self.order(factor) <= POSITIVE) {
            return None;
        }
        let size = self.arena.expr(self.arena.product(Number::ONE, size));
        let whole = self.arena.product(Number::ONE, small.into_iter().chain([(size.id, 1)]));
        Some(self.arena.choice([size.choose(size, -size).id, whole, self.arena.zero().id]))
    }

    /// Whether it may be zero or not.
    fn is_uncertain(&self, value: Id) -> bool {
        !matches!(self.arena.node(value), Node::Number(_)) && !self.arena.is_positive(value)
    }

    /// What is to be zero, where the base is, for a product with these factors to have the limit zero: all others are bounded.
    fn zero_with(&mut self, rest: &[(Id, i32)]) -> Option<Id> {
        // what is divided by something else that may be zero has no bound
        let is_bounded = |&(factor, e): &(Id, i32)| {
            let is_constant = self.arena.expr(factor).stage() <= Stage::Parameters;
            is_constant || self.arena.is_positive(factor) || e > 0 && self.branches(factor).is_none()
        };
        if !rest.iter().all(is_bounded) {
            return None;
        }
        let mut zero = Vec::new();
        for &(factor, e) in rest {
            let value = self.value(factor).0.filter(|&value| e > 0 && self.is_uncertain(value));
            if let Some(value) = value.filter(|&value| self.arena.expr(value).stage() <= Stage::Iteration) {
                zero.push((value, 1));
            }
        }
        (!zero.is_empty()).then(|| self.arena.product(Number::ONE, zero))
    }

    /// Of a power of the base with an exponent that is known before a step begins: whether there is a limit depends on that.
    fn of_any_power(
        &mut self,
        factors: &[(Id, i32)],
        power: Number,
        rest: &[(Id, i32)],
        total: f64,
    ) -> Option<Id> {
        let (place, exponent) = rest.iter().enumerate().find_map(|(place, &(factor, e))| {
            Some((place, self.uncertain_exponent(factor).filter(|_| e == 1)?))
        })?;
        // the order of the others is a multiple of a half, or is not known as well
        let others = Number::ratio((total * 4.0).floor() as i128, 4);
        let order = exponent + self.arena.number(others);
        let inverse = -(exponent + self.arena.number(power));
        let mut limit = rest.to_vec();
        limit[place].0 = self.arena.function(Function::RecipOrZero, self.arena.power(self.base, inverse.id));
        let limit = self.arena.product(Number::ONE, limit);
        let whole = self.arena.product(Number::ONE, factors.to_vec());
        // what is a multiple of `n − 2` is nothing for `n = 2`
        let constants: Vec<_> = rest
            .iter()
            .copied()
            .filter(|&(factor, e)| {
                e > 0 && self.arena.expr(factor).stage() <= Stage::Parameters && self.is_uncertain(factor)
            })
            .collect();
        let whole = match constants.is_empty() {
            true => whole,
            false => {
                let size = self.arena.expr(self.arena.product(Number::ONE, constants));
                self.arena.choice([size.choose(size, -size).id, whole, self.arena.zero().id])
            }
        };
        Some(self.arena.choice([(-order).id, limit, whole]))
    }

    /// The condition and the branches of a choice.
    fn branches(&self, id: Id) -> Option<[Id; 3]> {
        match self.arena.node(id) {
            Node::Choice(branches) => Some(branches),
            Node::Held(inner) => self.branches(inner),
            _ => None,
        }
    }

    /// A product with as few powers of the base in the denominator as there can be.
    fn simplified(&mut self, factors: &[(Id, i32)]) -> Monomial {
        let mut monomial = self.monomial(factors);
        let takes_all = monomial.has_positive || self.odd_factor(&monomial).is_some();
        self.take_denominators_out(&mut monomial, takes_all);
        // what the base is a product of
        while monomial.power.is_negative() && !self.factors.is_empty() && monomial.divide(&self.factors) {
            monomial.power = monomial.power + Number::ONE;
            monomial.is_simpler = true;
        }
        while monomial.power.is_negative() {
            let Some(place) = self.odd_factor(&monomial) else { break };
            let factor = monomial.rest[place].0;
            monomial.rest[place].1 -= 1;
            monomial.rest.retain(|&(_, e)| e != 0);
            let quotient = self.over_root(factor);
            let more = self.monomial(&[(quotient, 1)]);
            monomial.power = monomial.power + half() + more.power;
            monomial.rest.extend(more.rest);
            monomial.is_simpler = true;
        }
        monomial
    }

    /// The place of a factor that is odd.
    fn odd_factor(&mut self, monomial: &Monomial) -> Option<usize> {
        monomial.rest.iter().position(|&(factor, e)| e > 0 && self.is_odd(factor))
    }

    /// A product, with all powers of the base together.
    fn monomial(&self, factors: &[(Id, i32)]) -> Monomial {
        let (mut power, mut rest) = (Number::ZERO, Vec::new());
        let (mut has_positive, mut has_negative, mut is_simpler) = (false, false, false);
        let mut pending = factors.to_vec();
        while let Some((factor, e)) = pending.pop() {
            match (self.exponent(factor), self.arena.node(factor)) {
                (Some(exponent), node) => {
                    let exponent = exponent * Number::from(i64::from(e));
                    power = power + exponent;
                    has_positive |= !exponent.is_negative();
                    has_negative |= exponent.is_negative();
                    // whether its limit is zero is to be found anew
                    is_simpler |= matches!(node, Node::Function(Function::RecipOrZero, _));
                }
                (None, Node::Product(inner)) => {
                    pending.extend(inner.iter().map(|&(id, k)| (id, k.saturating_mul(e))));
                }
                (None, Node::Sum(sum)) if sum.is_scaled_term() => {
                    let (term, number) = sum.terms[0];
                    rest.push((self.arena.number(number.powi(e)).id, 1));
                    pending.push((term, e));
                }
                (None, _) => rest.push((factor, e)),
            }
        }
        is_simpler |= has_positive && has_negative;
        Monomial { power, rest, has_positive, is_simpler }
    }

    /// Takes the root out of the denominators in the sums among the factors: `r (x/r + y) = r r⁻¹ (x + y r)`. Not of all of
    /// them, only of those that are a power of the base then: `x²/r + y²/r = r`.
    fn take_denominators_out(&mut self, monomial: &mut Monomial, takes_all: bool) {
        for place in 0..monomial.rest.len() {
            let (factor, e) = monomial.rest[place];
            let inner = match self.arena.node(factor) {
                Node::Held(inner) => inner,
                _ => factor,
            };
            let Node::Sum(sum) = self.arena.node(inner) else { continue };
            if e < 1 || !takes_all && !self.may_be_base(&sum) || !self.is_divided(factor) {
                continue;
            }
            let terms: Vec<(Monomial, Number)> =
                sum.terms.iter().map(|&(term, c)| (self.monomial(&[(term, 1)]), c)).collect();
            let powers = terms.iter().map(|(term, _)| term.power);
            let Some(least) = powers.reduce(|a, b| if b < a { b } else { a }) else { continue };
            if !least.is_negative() {
                continue;
            }
            let terms: Vec<_> = terms
                .into_iter()
                .map(|(Monomial { power, rest, .. }, c)| {
                    let of_base = self.power(power + -least);
                    (self.arena.product(Number::ONE, rest.into_iter().chain([(of_base, 1)])), c)
                })
                .chain((!sum.constant.is_zero()).then(|| (self.power(-least), sum.constant)))
                .collect();
            let sum = self.arena.sum(Number::ZERO, terms);
            let whole = self.exponent(sum);
            if !takes_all && whole.is_none() {
                continue;
            }
            monomial.rest[place] = if whole.is_some() { (self.arena.one().id, 1) } else { (sum, e) };
            let power = least + whole.unwrap_or(Number::ZERO);
            monomial.power = monomial.power + power * Number::from(i64::from(e));
            monomial.is_simpler = true;
        }
    }

    /// Whether a sum may be a multiple of a power of the base.
    fn may_be_base(&self, sum: &Sum) -> bool {
        matches!(self.arena.node(self.base), Node::Sum(base) if base.terms.len() == sum.terms.len())
    }
}

/// A power of the base times other factors.
struct Monomial {
    power: Number,
    rest: Vec<(Id, i32)>,
    /// Whether some of the powers of the base are positive.
    has_positive: bool,
    /// Whether it is simpler than what it was made of.
    is_simpler: bool,
}

impl Monomial {
    /// Divides by a product, if all factors of it are there.
    fn divide(&mut self, by: &[(Id, i32)]) -> bool {
        let exponent =
            |id: Id| self.rest.iter().filter(|(factor, _)| *factor == id).map(|(_, e)| e).sum::<i32>();
        if by.iter().any(|&(id, e)| e > 0 && exponent(id) < e) {
            return false;
        }
        self.rest.extend(by.iter().map(|&(id, e)| (id, -e)));
        let mut merged: BTreeMap<Id, i32> = BTreeMap::new();
        self.rest.iter().for_each(|&(id, e)| *merged.entry(id).or_default() += e);
        self.rest = merged.into_iter().filter(|&(_, e)| e != 0).collect();
        true
    }
}

/// The order of a power of something of an order. What may vanish faster than is known has a reciprocal without bound.
fn powered(order: f64, exponent: f64) -> f64 {
    match (order > 0.0, exponent > 0.0) {
        (_, true) => order * exponent,
        (true, false) => UNBOUNDED,
        (false, false) => 0.0,
    }
}

/// The factors of a term that are neither constant nor positive.
fn others(arena: &Arena, term: Id) -> Vec<(Id, i32)> {
    let mut factors = match arena.node(term) {
        Node::Product(factors) => factors.to_vec(),
        _ => vec![(term, 1)],
    };
    let is_constant = |id: Id| arena.expr(id).stage() == Stage::Parameters;
    factors.retain(|&(id, _)| !is_constant(id) && !arena.is_positive(id));
    factors
}

/// Whether a term is an even power of something times squares, constants and what is positive; and of what, if there is
/// one such power.
fn square(arena: &Arena, term: Id) -> Option<Option<(Id, i32)>> {
    let others = others(arena, term);
    if others.iter().any(|&(id, e)| e % 2 != 0 && !arena.is_nonnegative(id)) {
        return None;
    }
    match others[..] {
        [(factor, e)] if e > 0 => Some(Some((factor, e))),
        _ => Some(None),
    }
}
