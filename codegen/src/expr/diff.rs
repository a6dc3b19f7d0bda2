//! Differentiation and substitution: both walk the graph once, remembering what they have seen.

use rustc_hash::{FxHashMap, FxHashSet};

use super::arena::{Arena, RuleApplied};
use super::expression::Expr;
use super::linear::{Matrix, Vector};
use super::node::{Function, Id, Node, Stage, Symbol};
use super::number::Number;
use super::vanishing::Limits;

impl<'a> Expr<'a> {
    /// The partial derivative with respect to a symbol.
    pub fn derivative(self, symbol: Symbol) -> Expr<'a> {
        Derivative::new(self.arena, symbol).of(self)
    }

    /// The expression with Stumpff functions replaced by the first two terms of their series.
    pub fn with_short_stumpff(self) -> Expr<'a> {
        let arena = self.arena;
        let mut known: FxHashMap<Id, Id> = FxHashMap::default();
        for id in arena.post_order([self.id], |_| false) {
            let image = match arena.node(id) {
                Node::Function(Function::Stumpff(k), z) => {
                    let at_zero = |k| arena.zero().stumpff(k);
                    (at_zero(k) - at_zero(k + 2) * arena.expr(known[&z])).id
                }
                _ => arena.rebuild(id, |operand| known[&operand]),
            };
            known.insert(id, image);
        }
        arena.expr(known[&self.id])
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

    /// About how many operations it takes in each iteration.
    pub fn operations(&self) -> usize {
        let Some(first) = self.0.first() else { return 0 };
        let arena = first.arena;
        let of = |id: &Id| match arena.node(*id) {
            _ if arena.expr(*id).stage() <= Stage::Parameters => 0,
            Node::Sum(sum) => {
                let multiples = sum.terms.iter().filter(|(_, c)| !c.abs().is_one()).count();
                sum.terms.len() + multiples - usize::from(sum.constant.is_zero())
            }
            Node::Product(factors) => {
                factors.iter().map(|(_, exponent)| exponent.unsigned_abs() as usize).sum::<usize>() - 1
            }
            _ => 0,
        };
        arena.post_order(self.iter().map(|x| x.id), |_| false).iter().map(of).sum()
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

    /// Whether these symbols bear on a choice in it: a constant derivative does not make it affine then.
    pub fn chooses_by(&self, symbols: &[Symbol]) -> bool {
        let Some(first) = self.0.first() else { return false };
        let arena = first.arena;
        arena.post_order(self.iter().map(|x| x.id), |_| false).into_iter().any(|id| match arena.node(id) {
            Node::Choice([x, ..]) => arena.expr(x).depends_on(symbols),
            _ => false,
        })
    }

    /// The symbols' values where this vanishes, an affine function of them with this Jacobian; none if that is
    /// singular, or it is no such function.
    pub fn affine_root(&self, jacobian: &Matrix<'a>, symbols: &[Symbol]) -> Option<Self> {
        if self.chooses_by(symbols) {
            return None;
        }
        jacobian.try_solve(&self.at_zero(symbols)).map(|root| -&root)
    }

    /// `∂self_i / ∂symbol_j`
    pub fn jacobian(&self, symbols: &[Symbol]) -> Matrix<'a> {
        self.jacobian_by(symbols, Derivative::new)
    }

    /// The same, for what is [not differentiated again](Derivative::last).
    pub fn last_jacobian(&self, symbols: &[Symbol]) -> Matrix<'a> {
        self.jacobian_by(symbols, |arena, symbol| Derivative::new(arena, symbol).last())
    }

    fn jacobian_by(
        &self,
        symbols: &[Symbol],
        derivative: impl Fn(&'a Arena, Symbol) -> Derivative<'a>,
    ) -> Matrix<'a> {
        let columns: Vec<Vec<Expr<'a>>> = symbols
            .iter()
            .map(|&symbol| match self.0.first() {
                Some(first) => {
                    let mut derivative = derivative(first.arena, symbol);
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
    limits: Limits<'a>,
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

    /// For derivatives that are not differentiated again: where something of the state is zero they may have a limit that they have not elsewhere.
    #[must_use]
    pub fn last(self) -> Self {
        Self { limits: Limits::of_last_derivatives(), ..self }
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

    /// Differentiates a node after all that it is made of, with a stack of its own. A node that lacks the derivative of
    /// an operand is tried again behind it; a product's terms are made as soon as the derivative of their factor is
    /// known, and kept.
    fn visit(&mut self, root: Id) -> Id {
        let mut open: Vec<(Id, Vec<Option<Id>>)> = vec![(root, Vec::new())];
        while let Some((id, terms)) = open.last_mut() {
            match self.node(*id, terms) {
                Ok(derivative) => {
                    self.known.insert(*id, derivative);
                    open.pop();
                }
                Err(operand) => open.push((operand, Vec::new())),
            }
        }
        self.known[&root]
    }

    /// The derivative of a node, when those of its operands are known.
    ///
    /// # Errors
    /// The first operand of which it is not.
    fn node(&mut self, id: Id, terms: &mut Vec<Option<Id>>) -> Result<Id, Id> {
        let arena = self.arena;
        if let Some(&known) = self.known.get(&id) {
            return Ok(known);
        }
        if let Some(rule) = arena.rule(id) {
            return self.in_closed_form(id, &rule);
        }
        let known = |operand: Id| match self.known.get(&operand) {
            Some(&known) => Ok(arena.expr(known)),
            None => Err(operand),
        };
        let derivative = match arena.node(id) {
            Node::Number(_) => arena.zero(),
            Node::Symbol(symbol) => {
                self.direction.get(&symbol).map_or_else(|| arena.zero(), |&id| arena.expr(id))
            }
            Node::Held(inner) => match quotient(arena.expr(inner)) {
                // (c/u)' = −(c/u)² u'/c, which needs no other quotient
                Some((number, divisor)) => {
                    let slope = known(divisor.id)?.scale(-number.powi(-1));
                    (slope * arena.expr(id).powi(2)).hold()
                }
                None => known(inner)?.hold(),
            },
            Node::Sum(sum) => {
                let terms = sum.terms.iter().map(|&(term, c)| Ok((known(term)?.id, c)));
                arena.expr(arena.sum(Number::ZERO, terms.collect::<Result<Vec<_>, Id>>()?))
            }
            Node::Product(factors) => {
                for place in terms.len()..factors.len() {
                    let (factor, exponent) = factors[place];
                    let inner = known(factor)?;
                    // the product with this factor replaced by its derivative
                    let mut rest = factors.to_vec();
                    rest[place].1 -= 1;
                    rest.push((inner.id, 1));
                    let term = || arena.product(Number::from(i64::from(exponent)), rest);
                    terms.push((!inner.is_zero()).then(term));
                }
                let terms = terms.iter().flatten().map(|&term| (term, Number::ONE));
                arena.expr(arena.sum(Number::ZERO, terms))
            }
            Node::Function(function, argument) => match known(argument)? {
                inner if inner.is_zero() => inner,
                inner => function.derivative(arena.expr(argument)) * inner,
            },
            Node::Power(base, exponent) => {
                // d(b^e) = e b^(e−1) db + ln(b) b^e de
                let (b, e) = (arena.expr(base), arena.expr(exponent));
                let (db, de) = (known(base)?, known(exponent)?);
                let by_base = e * b.pow(e - 1) * db;
                match de.is_zero() {
                    true => by_base,
                    false => by_base + b.apply(Function::Ln) * arena.expr(id) * de,
                }
            }
            Node::Atan2(y, x) => {
                let (dy, dx) = (known(y)?, known(x)?);
                let (y, x) = (arena.expr(y), arena.expr(x));
                (x * dy - y * dx) / (x * x + y * y)
            }
            // that of the branch that is taken; the other may have none
            Node::Choice([x, y, z]) => arena.expr(x).choose(known(y)?, known(z)?),
        };
        Ok(derivative.id)
    }

    /// The derivative of a value of which it is known; those of the values beside it, too.
    fn in_closed_form(&mut self, id: Id, of: &RuleApplied) -> Result<Id, Id> {
        let change = |argument: &Id| self.known.get(argument).copied().ok_or(*argument);
        let changes: Vec<Id> = of.arguments.iter().map(change).collect::<Result<_, Id>>()?;
        let zero = self.arena.zero().id;
        if changes.iter().all(|&change| change == zero) {
            return Ok(zero);
        }
        let changes = (of.along)(self.arena, of, &changes);
        for (&value, change) in of.values.iter().zip(changes) {
            self.known.entry(value).or_insert(change);
        }
        Ok(self.known[&id])
    }
}

impl<'a> Expr<'a> {
    /// The operands of a function, a power or an arc tangent, each with the derivative with respect to it.
    pub(super) fn partial_derivatives(self) -> Vec<(Id, Expr<'a>)> {
        let arena = self.arena;
        match arena.node(self.id) {
            Node::Function(function, x) => vec![(x, function.derivative(arena.expr(x)))],
            Node::Power(base, exponent) => {
                let (b, e) = (arena.expr(base), arena.expr(exponent));
                let by_base = (base, e * b.pow(e - 1));
                match e.as_number() {
                    Some(_) => vec![by_base],
                    None => vec![by_base, (exponent, b.apply(Function::Ln) * self)],
                }
            }
            Node::Atan2(y, x) => {
                let (u, v) = (arena.expr(y), arena.expr(x));
                let squared = u * u + v * v;
                vec![(y, v / squared), (x, -u / squared)]
            }
            _ => Vec::new(),
        }
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
    // of choices first, branch by branch: the derivative of one that is not taken may be no number, and is multiplied
    // by nothing
    let mut of_choices: FxHashMap<Id, Vector<'a>> = FxHashMap::default();
    for id in arena.unknown(expr.id, &of_choices) {
        if let Node::Choice([x, y, z]) = arena.node(id) {
            let [y, z] = [y, z].map(|branch| reverse(arena, branch, symbols, &of_choices));
            of_choices.insert(id, y.zip(&z, |y, z| arena.expr(x).choose(y, z)));
        }
    }
    let mut limits = Limits::default();
    reverse(arena, expr.id, symbols, &of_choices).map(|derivative| limits.of(derivative))
}

/// The gradient, where those of the choices in it are known.
fn reverse<'a>(
    arena: &'a Arena,
    root: Id,
    symbols: &[Symbol],
    of_choices: &FxHashMap<Id, Vector<'a>>,
) -> Vector<'a> {
    let mut adjoints: FxHashMap<Id, Vec<Id>> = FxHashMap::default();
    let mut found: FxHashMap<Symbol, Id> = FxHashMap::default();
    adjoints.insert(root, vec![arena.one().id]);
    let sum = |parts: Vec<Id>| arena.sum(Number::ZERO, parts.into_iter().map(|part| (part, Number::ONE)));
    // operands are older than what is made of them: going from young to old, every adjoint is complete when it is used
    for id in arena.unknown(root, of_choices).into_iter().rev() {
        let Some(parts) = adjoints.remove(&id) else { continue };
        let adjoint = sum(parts);
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
            Node::Function(..) | Node::Power(..) | Node::Atan2(..) => {
                for (operand, slope) in arena.expr(id).partial_derivatives() {
                    give(operand, of(slope));
                }
            }
            // they are known, and left over
            Node::Choice(_) => {}
        }
    }
    let mut choices: Vec<(Id, Vec<Id>)> = adjoints.into_iter().collect();
    choices.sort_unstable();
    let of = |symbol| found.get(symbol).map_or_else(|| arena.zero(), |&id| arena.expr(id));
    choices.into_iter().fold(Vector(symbols.iter().map(of).collect()), |gradient, (id, parts)| {
        let adjoint = arena.expr(sum(parts));
        gradient.zip(&of_choices[&id], |sum, derivative| sum + derivative * adjoint)
    })
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
