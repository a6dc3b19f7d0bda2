//! Power series of the solutions of differential equations, coefficient by coefficient.
//!
//! The coefficients of order `k` of everything that the right sides are made of follow from those of the unknowns, and
//! these from the right sides' of order `k − 1`. What is not linear is a Cauchy product of two series, a *lane*. Its sum
//! without both ends, `Σ_j a_j b_{k−j}` from 1 to `k − 1`, is made of lower orders alone, so that all of them are summed
//! side by side; the ends are added where they are known.
//!
//! | node | coefficient |
//! |---|---|
//! | `x y` | `Σ x_j y_{k−j} + x_0 y_k + x_k y_0` |
//! | `r = 1/x` | `−r_0 (Σ x_j r_{k−j} + x_k r_0)` |
//! | `r = √x` | `(x_k − Σ r_j r_{k−j})/(2 r_0)` |
//! | `r = x^c` | `((c + 1)/k (Σ j x_j r_{k−j} + k x_k r_0) − (Σ x_j r_{k−j} + x_k r_0))/x_0` |
//! | `f(x, …)` | `(Σ j x_j f'_{k−j} + k x_k f'_0)/k` with `f' = ∂f/∂x`, and so for each argument |
//!
//! Jorba and Zou, Experimental Mathematics 14 (2005) 99.

use rustc_hash::FxHashMap;

use super::arena::Arena;
use super::diff::Substitution;
use super::expression::Expr;
use super::linear::Vector;
use super::node::{Function, Id, Node, Stage, Symbol};
use super::number::Number;

/// An unknown of a differential equation.
#[derive(Clone, Copy)]
pub struct Unknown<'a> {
    /// Stands for it.
    pub symbol: Expr<'a>,
    /// Where it starts.
    pub start: Expr<'a>,
    /// Its derivative by time.
    pub change: Expr<'a>,
}

/// How the coefficients of order `k` follow from those before.
pub struct Recurrences<'a> {
    /// Stands for `k`.
    pub order: Expr<'a>,
    /// Stand for the unknowns' coefficients of order `k`.
    pub coefficients: Vector<'a>,
    /// Stand for the lanes' sums without both ends.
    pub sums: Vector<'a>,
    /// The operands of order `k` of all lanes.
    pub operands: [Vector<'a>; 2],
    /// The coefficients of the changes of order 0, and of order `k`.
    pub change: [Vector<'a>; 2],
    /// Those of what else there is a series of.
    pub outputs: [Vector<'a>; 2],
}

/// More lanes than a system has whose functions have closed recurrences.
const MOST_LANES: usize = 2_000;

impl<'a> Recurrences<'a> {
    /// Those of a differential equation, and of functions of its unknowns. None where a function has no closed recurrence.
    pub fn new(arena: &'a Arena, unknowns: &[Unknown<'a>], outputs: &[Expr<'a>]) -> Option<Self> {
        let order = arena.symbol("order", Stage::Iteration);
        let named = |unknown: &Unknown<'a>| {
            let symbol = unknown.symbol.as_symbol()?;
            Some(arena.symbol(format!("{}_k", arena.symbol_info(symbol).name), Stage::Iteration))
        };
        let coefficients = Vector(unknowns.iter().map(named).collect::<Option<Vec<_>>>()?);
        let mut known = FxHashMap::default();
        for (unknown, coefficient) in unknowns.iter().zip(coefficients.iter()) {
            known.insert(unknown.symbol.id, Some(coefficient));
        }
        let starts: Vec<(Symbol, Expr<'a>)> = unknowns
            .iter()
            .filter_map(|unknown| Some((unknown.symbol.as_symbol()?, unknown.start)))
            .collect();
        let mut all = Builder {
            arena,
            order,
            starts: Substitution::new(arena, &starts),
            known,
            sums: Vec::new(),
            operands: Default::default(),
            slopes: Vec::new(),
        };
        let first = unknowns.iter().map(|unknown| all.first(unknown.change.id));
        let first = Vector(first.collect());
        let next: Option<Vec<_>> = unknowns.iter().map(|unknown| all.part(unknown.change.id)).collect();
        let first_outputs = Vector(outputs.iter().map(|output| all.first(output.id)).collect());
        let next_outputs: Option<Vec<_>> = outputs.iter().map(|output| all.part(output.id)).collect();
        while let Some((lane, slope)) = all.slopes.pop() {
            all.operands[1][lane] = all.part(slope)?;
        }
        let (sums, operands) = (Vector(all.sums), all.operands.map(Vector));
        let (change, outputs) = ([first, Vector(next?)], [first_outputs, Vector(next_outputs?)]);
        Some(Self { order, coefficients, sums, operands, change, outputs })
    }
}

struct Builder<'a> {
    arena: &'a Arena,
    order: Expr<'a>,
    starts: Substitution<'a>,
    /// The coefficients of order `k`, from 1 on, of what has been looked at; nothing of what is constant.
    known: FxHashMap<Id, Option<Expr<'a>>>,
    sums: Vec<Expr<'a>>,
    operands: [Vec<Expr<'a>>; 2],
    /// Lanes whose second operand is a derivative that has not been looked at.
    slopes: Vec<(usize, Id)>,
}

impl<'a> Builder<'a> {
    /// The coefficient of order 0.
    fn first(&mut self, id: Id) -> Expr<'a> {
        self.starts.of(self.arena.expr(id))
    }

    /// The coefficient of order `k`. None if there is no recurrence for it.
    fn part(&mut self, id: Id) -> Option<Expr<'a>> {
        for id in self.arena.post_order([id], |id| self.known.contains_key(&id)) {
            if !self.known.contains_key(&id) {
                let node = self.arena.node(id);
                let changes = node.operands().any(|operand| self.changes(operand));
                let part = if changes { Some(self.changing(&node, id)?) } else { None };
                self.known.insert(id, part);
            }
        }
        Some(self.known_part(id))
    }

    fn changes(&self, id: Id) -> bool {
        matches!(self.known.get(&id), Some(Some(_)))
    }

    fn known_part(&self, id: Id) -> Expr<'a> {
        self.known.get(&id).copied().flatten().unwrap_or(self.arena.zero())
    }

    /// The coefficient of a node that changes, whose operands are known.
    fn changing(&mut self, node: &Node, id: Id) -> Option<Expr<'a>> {
        let arena = self.arena;
        match node {
            Node::Number(_) | Node::Symbol(_) => None,
            Node::Held(inner) => Some(self.known_part(*inner).hold()),
            Node::Sum(sum) => {
                let terms = sum.terms.iter().map(|&(term, c)| (self.known_part(term).id, c));
                Some(arena.expr(arena.sum(Number::ZERO, terms.collect::<Vec<_>>())))
            }
            Node::Product(factors) => self.product(factors, id),
            Node::Choice([x, y, z]) => {
                let [y, z] = [*y, *z].map(|branch| self.known_part(branch));
                Some(self.first(*x).choose(y, z))
            }
            Node::Function(Function::Sqrt, x) => {
                let half = self.first(id).apply(Function::RecipOrZero).scale(Number::ratio(1, 2));
                let (lane, sum) = self.lane([arena.zero(); 2])?;
                let part = ((self.known_part(*x) - sum) * half).hold();
                for operand in &mut self.operands {
                    operand[lane] = part;
                }
                Some(part)
            }
            Node::Function(Function::RecipOrZero, x) => self.reciprocal(*x, id),
            Node::Function(Function::Stumpff(_) | Function::AngleOverSine(_), _) => None,
            Node::Power(x, exponent) if !self.changes(*exponent) => {
                let (first, exponent, x0) = (self.first(id), self.first(*exponent), self.first(*x));
                let x = self.known_part(*x);
                let lanes =
                    [self.order * x, x].map(|x| self.lane([x, arena.zero()]).map(|lane| (lane, x * first)));
                let [((slope, slope_sum), slope_end), ((plain, plain_sum), plain_end)] =
                    [lanes[0]?, lanes[1]?];
                let slopes = (slope_sum + slope_end) * (exponent + arena.one()) / self.order;
                let part = ((slopes - (plain_sum + plain_end)) / x0).hold();
                for lane in [slope, plain] {
                    self.operands[1][lane] = part;
                }
                Some(part)
            }
            Node::Power(x, exponent) => {
                let (x, exponent) = (arena.expr(*x), arena.expr(*exponent));
                self.part((x.apply(Function::Ln) * exponent).apply(Function::Exp).id)
            }
            Node::Function(..) | Node::Atan2(..) => {
                let mut sum = arena.zero();
                for (operand, slope) in arena.expr(id).partial_derivatives() {
                    if self.changes(operand) {
                        let x = self.order * self.known_part(operand);
                        let (lane, inner) = self.lane([x, arena.zero()])?;
                        self.slopes.push((lane, slope.id));
                        sum = sum + inner + x * self.first(slope.id);
                    }
                }
                Some((sum / self.order).hold())
            }
        }
    }

    /// A lane, and the symbol of its sum.
    fn lane(&mut self, operands: [Expr<'a>; 2]) -> Option<(usize, Expr<'a>)> {
        let place = self.sums.len();
        let sum = self.arena.symbol(format!("sum_{}", place + 1), Stage::Iteration);
        self.sums.push(sum);
        for (all, operand) in self.operands.iter_mut().zip(operands) {
            all.push(operand);
        }
        (place < MOST_LANES).then_some((place, sum))
    }

    fn reciprocal(&mut self, x: Id, id: Id) -> Option<Expr<'a>> {
        let (x, first) = (self.part(x)?, self.first(id));
        let (lane, sum) = self.lane([x, self.arena.zero()])?;
        let part = (-(first * (sum + x * first))).hold();
        self.operands[1][lane] = part;
        Some(part)
    }

    /// A product: constant factors, then one factor after the other.
    fn product(&mut self, factors: &[(Id, i32)], id: Id) -> Option<Expr<'a>> {
        let arena = self.arena;
        let (changing, constant): (Vec<_>, Vec<_>) =
            factors.iter().copied().partition(|&(factor, _)| self.changes(factor));
        let whole = |factors: &[(Id, i32)]| arena.expr(arena.product(Number::ONE, factors.iter().copied()));
        if !constant.is_empty() {
            return Some(whole(&constant) * self.part(whole(&changing).id)?);
        }
        match *changing {
            [(x, -1)] => self.reciprocal(x, id),
            [(x, exponent)] if exponent < 0 => {
                let root = arena.expr(x).recip();
                self.part(root.id)?;
                self.power(root, exponent.unsigned_abs())
            }
            [(x, exponent)] => self.power(arena.expr(x), exponent.unsigned_abs()),
            _ => self.times(whole(&changing[..1]), whole(&changing[1..])),
        }
    }

    /// `x^n`, by halves: squares are there for others, too.
    fn power(&mut self, x: Expr<'a>, n: u32) -> Option<Expr<'a>> {
        let of = |n: u32| x.powi(n.try_into().unwrap_or(i32::MAX));
        if n == 1 { self.part(x.id) } else { self.times(of(n.div_ceil(2)), of(n / 2)) }
    }

    fn times(&mut self, x: Expr<'a>, y: Expr<'a>) -> Option<Expr<'a>> {
        let [first_x, first_y] = [x, y].map(|factor| self.first(factor.id));
        let (x, y) = (self.part(x.id)?, self.part(y.id)?);
        let (_, sum) = self.lane([x, y])?;
        Some((sum + (first_x * y + x * first_y)).hold())
    }
}
