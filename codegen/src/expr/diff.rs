//! Differentiation and substitution: both walk the graph once, remembering what they have seen.

use std::sync::Arc;

use rustc_hash::{FxHashMap, FxHashSet};

use super::arena::{Arena, RuleApplied};
use super::expression::Expr;
use super::linear::{Matrix, Vector};
use super::node::{Function, Id, Node, Symbol};
use super::number::Number;
use super::vanishing::Limits;

impl<'a> Expr<'a> {
    /// The partial derivative with respect to a symbol.
    pub fn derivative(self, symbol: Symbol) -> Expr<'a> {
        Derivative::new(self.arena, symbol).of(self)
    }

    /// The expression with symbols replaced.
    pub fn substitute(self, replacements: &[(Symbol, Expr<'a>)]) -> Expr<'a> {
        Substitution::new(self.arena, replacements).of(self)
    }
}

impl<'a> Vector<'a> {
    /// `Σ ∂self/∂symbol_j direction_j`
    pub fn derivative_along(&self, symbols: &[Symbol], direction: &Self) -> Self {
        let Some(first) = self.0.first() else { return self.clone() };
        let direction: Vec<_> = symbols.iter().copied().zip(direction.iter()).collect();
        let mut derivative = Derivative::along(first.arena, &direction);
        self.map(|x| derivative.of(x))
    }

    /// Each component with symbols replaced.
    pub fn substitute(&self, replacements: &[(Symbol, Expr<'a>)]) -> Self {
        let Some(first) = self.0.first() else { return self.clone() };
        let mut substitution = Substitution::new(first.arena, replacements);
        self.map(|x| substitution.of(x))
    }

    /// The value where these symbols are zero.
    pub fn at_zero(&self, symbols: &[Symbol]) -> Self {
        let Some(first) = self.0.first() else { return self.clone() };
        let zero = first.arena.zero();
        self.substitute(&symbols.iter().map(|&symbol| (symbol, zero)).collect::<Vec<_>>())
    }

    /// The symbols' values where this vanishes, an affine function of them with this Jacobian; none if that is
    /// singular.
    pub fn affine_root(&self, jacobian: &Matrix<'a>, symbols: &[Symbol]) -> Option<Self> {
        jacobian.try_solve(&self.at_zero(symbols)).map(|root| -&root)
    }

    /// `∂self_i / ∂symbol_j`
    pub fn jacobian(&self, symbols: &[Symbol]) -> Matrix<'a> {
        let columns: Vec<Vec<Expr<'a>>> = symbols
            .iter()
            .map(|&symbol| match self.0.first() {
                Some(first) => {
                    let mut derivative = Derivative::new(first.arena, symbol);
                    self.iter().map(|x| derivative.of(x)).collect()
                }
                None => Vec::new(),
            })
            .collect();
        let entries = (0..self.len()).flat_map(|i| columns.iter().map(move |column| column[i])).collect();
        Matrix::new(self.len(), symbols.len(), entries)
    }
}

/// Differentiates many expressions in one direction, sharing the work.
pub struct Derivative<'a> {
    arena: &'a Arena,
    direction: FxHashMap<Symbol, Id>,
    known: FxHashMap<Id, Id>,
    limits: Limits,
}

impl<'a> Derivative<'a> {
    /// By one symbol.
    pub fn new(arena: &'a Arena, symbol: Symbol) -> Self {
        Self::along(arena, &[(symbol, arena.one())])
    }

    /// Along a direction: `Σ ∂/∂symbol · component`.
    pub fn along(arena: &'a Arena, direction: &[(Symbol, Expr<'a>)]) -> Self {
        let direction = direction.iter().map(|&(symbol, component)| (symbol, component.id)).collect();
        Self { arena, direction, known: FxHashMap::default(), limits: Limits::default() }
    }

    /// Takes the derivative of one expression as known, wherever it occurs.
    pub fn know(&mut self, expr: Expr<'a>, derivative: Expr<'a>) {
        self.known.insert(expr.id, derivative.id);
    }

    /// Of one expression.
    pub fn of(&mut self, expr: Expr<'a>) -> Expr<'a> {
        let id = self.visit(expr.id);
        self.limits.of(self.arena.expr(id))
    }

    /// Walks along the operands with a stack of its own. A product's terms are made as soon as the derivative of their
    /// factor is known.
    fn visit(&mut self, root: Id) -> Id {
        let zero = self.arena.zero().id;
        let mut open = vec![Visit::of(self.arena, root)];
        while let Some(visit) = open.last_mut() {
            let next = visit.operands.get(visit.done).copied();
            match next {
                _ if self.known.contains_key(&visit.id) => drop(open.pop()),
                Some(operand) => match self.known.get(&operand) {
                    Some(&inner) => {
                        if let Node::Product(factors) = &visit.node
                            && inner != zero
                        {
                            visit.terms.push(self.term(factors, visit.done, inner));
                        }
                        visit.done += 1;
                    }
                    None => open.push(Visit::of(self.arena, operand)),
                },
                None => {
                    let Some(Visit { id, node, terms, known, .. }) = open.pop() else { break };
                    let derivative = match known {
                        Some(known) => self.in_closed_form(id, &known, zero),
                        None => self.derivative(id, &node, &terms, zero),
                    };
                    self.known.insert(id, derivative);
                }
            }
        }
        self.known[&root]
    }

    /// The derivative of a value of which it is known; those of the values beside it, too.
    fn in_closed_form(&mut self, id: Id, of: &RuleApplied, zero: Id) -> Id {
        let changes: Vec<Id> = of.arguments.iter().map(|argument| self.known[argument]).collect();
        if changes.iter().all(|&change| change == zero) {
            return zero;
        }
        let changes = of.rule.along(self.arena, &of.values, &of.given, &changes);
        for (&value, change) in of.values.iter().zip(changes) {
            self.known.entry(value).or_insert(change);
        }
        self.known[&id]
    }

    /// A product with a factor replaced by its derivative.
    fn term(&self, factors: &[(Id, i32)], place: usize, inner: Id) -> (Id, Number) {
        let exponent = factors[place].1;
        let mut rest = factors.to_vec();
        rest[place].1 -= 1;
        rest.push((inner, 1));
        (self.arena.product(Number::from(i64::from(exponent)), rest), Number::ONE)
    }

    /// The derivative of a node, when those of its operands are known.
    fn derivative(&self, id: Id, node: &Node, terms: &[(Id, Number)], zero: Id) -> Id {
        let arena = self.arena;
        let known = |operand: Id| self.known[&operand];
        match node {
            Node::Number(_) => zero,
            Node::Symbol(symbol) => self.direction.get(symbol).copied().unwrap_or(zero),
            Node::Held(inner) => match quotient(arena.expr(*inner)) {
                // (c/u)' = −(c/u)² u'/c, which needs no other quotient
                Some((number, divisor)) => {
                    let slope = arena.expr(known(divisor.id)).scale(-number.powi(-1));
                    arena.held((slope * arena.expr(id).powi(2)).id)
                }
                None => arena.held(known(*inner)),
            },
            Node::Sum(sum) => {
                let terms: Vec<_> = sum.terms.iter().map(|&(term, c)| (known(term), c)).collect();
                arena.sum(Number::ZERO, terms)
            }
            Node::Product(_) => arena.sum(Number::ZERO, terms.iter().copied()),
            Node::Function(_, argument) if known(*argument) == zero => zero,
            Node::Function(function, argument) => {
                (function.derivative(arena.expr(*argument)) * arena.expr(known(*argument))).id
            }
            Node::Power(base, exponent) => {
                // d(b^e) = e b^(e−1) db + ln(b) b^e de
                let (b, e) = (arena.expr(*base), arena.expr(*exponent));
                let (db, de) = (arena.expr(known(*base)), arena.expr(known(*exponent)));
                let mut total = e * b.pow(e - 1) * db;
                if !de.is_zero() {
                    total = total + b.apply(Function::Ln) * arena.expr(id) * de;
                }
                total.id
            }
            Node::Atan2(y, x) => {
                let (dy, dx) = (arena.expr(known(*y)), arena.expr(known(*x)));
                let (y, x) = (arena.expr(*y), arena.expr(*x));
                ((x * dy - y * dx) / (x * x + y * y)).id
            }
        }
    }
}

/// A node whose derivative is under way.
struct Visit {
    id: Id,
    node: Node,
    /// Those whose derivatives are needed.
    operands: Vec<Id>,
    /// How many operands' derivatives are known.
    done: usize,
    /// Of a product's derivative.
    terms: Vec<(Id, Number)>,
    /// Its derivative in closed form.
    known: Option<Arc<RuleApplied>>,
}

impl Visit {
    fn of(arena: &Arena, id: Id) -> Self {
        let node = arena.node(id);
        let known = arena.rule(id);
        let divisor = match node {
            Node::Held(inner) => quotient(arena.expr(inner)).map(|(_, divisor)| divisor.id),
            _ => None,
        };
        let operands = match (&known, divisor) {
            (Some(known), _) => known.arguments.clone(),
            (None, Some(divisor)) => vec![divisor],
            (None, None) => node.operands().collect(),
        };
        Self { id, operands, node, done: 0, terms: Vec::new(), known }
    }
}

/// `(c, u)` with `expr = c/u`, for a number `c`.
fn quotient(expr: Expr<'_>) -> Option<(Number, Expr<'_>)> {
    let (number, rest) = expr.split_number();
    match rest.arena.node(rest.id) {
        Node::Product(factors) => match *factors {
            [(divisor, -1)] => Some((number, rest.arena.expr(divisor))),
            _ => None,
        },
        _ => None,
    }
}

impl Function {
    /// The derivative, at `x`.
    fn derivative<'a>(self, x: Expr<'a>) -> Expr<'a> {
        let one = x.arena.one();
        match self {
            Self::Sqrt => (x.sqrt() * 2).recip(),
            Self::Exp => x.apply(Self::Exp),
            Self::Ln => x.recip(),
            Self::Sin => x.apply(Self::Cos),
            Self::Cos => -x.apply(Self::Sin),
            Self::Tan => one + x.apply(Self::Tan).powi(2),
            Self::Asin => (one - x * x).sqrt().recip(),
            Self::Acos => -(one - x * x).sqrt().recip(),
            Self::Atan => (one + x * x).recip(),
            Self::Sinh => x.apply(Self::Cosh),
            Self::Cosh => x.apply(Self::Sinh),
            Self::Tanh => one - x.apply(Self::Tanh).powi(2),
            // c_k' = (k c_{k+2} − c_{k+1}) / 2
            Self::Stumpff(k) => (x.stumpff(k + 2) * i64::from(k) - x.stumpff(k + 1)) / 2,
            // away from zero; what holds there is decided of the whole
            Self::RecipOrZero => -x.powi(-2),
            Self::AngleOverSine(k) => x.apply(Self::AngleOverSine(k + 1)),
        }
    }
}

/// `∂expr / ∂symbol_j` for many symbols at once.
///
/// The reverse mode: one sweep from the expression down to its symbols. It keeps the structure of transposed formulas —
/// the gradient of `a · x × (x × u)` by `u` comes out as two cross products, not as a matrix — where differentiating by
/// one symbol after the other would multiply it out.
pub fn gradient<'a>(expr: Expr<'a>, symbols: &[Symbol]) -> Vector<'a> {
    let arena = expr.arena;
    let mut adjoints: FxHashMap<Id, Vec<Id>> = FxHashMap::default();
    let mut found: FxHashMap<Symbol, Id> = FxHashMap::default();
    adjoints.insert(expr.id, vec![arena.one().id]);
    // operands are older than what is made of them: going from young to old, every adjoint is complete when it is used
    for id in reachable(expr) {
        let Some(parts) = adjoints.remove(&id) else { continue };
        let adjoint = arena.sum(Number::ZERO, parts.into_iter().map(|part| (part, Number::ONE)));
        let of = |rest: Expr<'a>| (rest * arena.expr(adjoint)).id;
        let mut give = |operand: Id, part: Id| adjoints.entry(operand).or_default().push(part);
        match arena.node(id) {
            Node::Number(_) => {}
            Node::Symbol(symbol) => {
                found.insert(symbol, adjoint);
            }
            Node::Sum(sum) => {
                for &(term, coefficient) in sum.terms.iter() {
                    give(term, arena.expr(adjoint).scale(coefficient).id);
                }
            }
            Node::Product(factors) => {
                for (i, &(factor, exponent)) in factors.iter().enumerate() {
                    let mut rest = factors.to_vec();
                    rest[i].1 -= 1;
                    let rest = arena.product(Number::from(i64::from(exponent)), rest);
                    give(factor, of(arena.expr(rest)));
                }
            }
            Node::Held(inner) => give(inner, adjoint),
            Node::Function(function, argument) => {
                give(argument, of(function.derivative(arena.expr(argument))));
            }
            Node::Power(base, exponent) => {
                let (b, e) = (arena.expr(base), arena.expr(exponent));
                give(base, of(e * b.pow(e - 1)));
                if e.as_number().is_none() {
                    give(exponent, of(b.apply(Function::Ln) * arena.expr(id)));
                }
            }
            Node::Atan2(y, x) => {
                let (u, v) = (arena.expr(y), arena.expr(x));
                let squared = u * u + v * v;
                give(y, of(v / squared));
                give(x, of(-u / squared));
            }
        }
    }
    let of = |symbol| found.get(symbol).map_or_else(|| arena.zero(), |&id| arena.expr(id));
    let mut limits = Limits::default();
    Vector(symbols.iter().map(|symbol| limits.of(of(symbol))).collect())
}

/// The nodes an expression is made of, youngest first.
fn reachable(expr: Expr<'_>) -> Vec<Id> {
    let mut nodes = expr.arena.post_order([expr.id], |_| false);
    nodes.sort_by_key(|&id| std::cmp::Reverse(id));
    nodes
}

/// Replaces symbols in many expressions, sharing the work.
pub struct Substitution<'a> {
    arena: &'a Arena,
    replacements: FxHashMap<Symbol, Id>,
    known: FxHashMap<Id, Id>,
    /// The first ones of values with derivatives in closed form that have been carried over.
    carried: FxHashSet<Id>,
}

impl<'a> Substitution<'a> {
    /// Replaces each symbol by the expression beside it.
    pub fn new(arena: &'a Arena, replacements: &[(Symbol, Expr<'a>)]) -> Self {
        let replacements = replacements.iter().map(|&(symbol, expr)| (symbol, expr.id)).collect();
        Self { arena, replacements, known: FxHashMap::default(), carried: FxHashSet::default() }
    }

    /// Of one expression.
    pub fn of(&mut self, expr: Expr<'a>) -> Expr<'a> {
        let id = self.visit(expr.id);
        self.arena.expr(id)
    }

    fn visit(&mut self, root: Id) -> Id {
        let arena = self.arena;
        let mut known = Vec::new();
        for id in arena.post_order([root], |id| self.known.contains_key(&id)) {
            let replaced = arena.with_node(id, |node| match node {
                Node::Symbol(symbol) => Some(self.replacements.get(symbol).copied().unwrap_or(id)),
                // most of a graph stays as it is: nodes are canonical, and need not be made anew of the same operands
                node => node.operands().all(|operand| self.known[&operand] == operand).then_some(id),
            });
            let result = replaced.unwrap_or_else(|| arena.rebuild(id, |operand| self.known[&operand]));
            if result != id {
                arena.pass_role(id, result);
                known.extend(arena.rule(id));
            }
            self.known.insert(id, result);
        }
        for known in known {
            // once for all the values that it is of
            if self.carried.insert(known.values[0]) {
                let image = known.image(|id| self.visit(id));
                arena.insert_rule(image);
            }
        }
        self.known[&root]
    }
}
