//! The staged straight-line code of one step, as plain data: what emitters print.
//!
//! A [`Kernel`] has one [`Section`] for each function of the runtime's `Kernel` trait. Every value is computed in the
//! earliest section that can; values that later sections need again are kept in named fields.

mod derivative;
mod factor;
mod plan;
mod schedule;
mod text;

use rustc_hash::FxHashMap;

use crate::expr::{Arena, Function, Matrix, Number, Stage, Symbol, Vector};
use crate::method::Step;
pub use derivative::Derivative;
use factor::Factoring;
use plan::{Plan, Signed};
use schedule::{Namer, Schedule};

/// One function's worth of straight-line code.
#[derive(Clone, Debug, Default)]
pub struct Section {
    /// What is computed, in order.
    pub statements: Vec<Statement>,
    /// The results, in the order the function returns them.
    pub results: Vec<Term>,
    /// Leaf symbols and fields of earlier sections that are used.
    pub inputs: Vec<String>,
}

/// One line of code.
#[derive(Clone, Debug)]
pub enum Statement {
    /// `let name = value;`
    Let {
        /// What the value is called.
        name: String,
        /// The value.
        value: Term,
    },
    /// `let [names…] = argument.stumpff();`, `None` for members not used.
    Stumpff {
        /// What `c_k` is called, if it is used.
        names: Vec<Option<String>>,
        /// `z`
        argument: Term,
    },
}

/// A value, as a tree of operations on named values.
#[derive(Clone, Debug)]
pub enum Term {
    /// A constant.
    Number(Number),
    /// A named value.
    Name(String),
    /// `−x`
    Negative(Box<Term>),
    /// Addends, `true` for those subtracted; the first is not.
    Sum(Vec<(bool, Term)>),
    /// Factors.
    Product(Vec<Term>),
    /// `x / y`
    Quotient(Box<Term>, Box<Term>),
    /// `function(x)`
    Function(Function, Box<Term>),
    /// `x^y`
    Power(Box<Term>, Box<Term>),
    /// The angle of the point `(second, first)`.
    Atan2(Box<Term>, Box<Term>),
}

/// The arithmetic of one step.
#[derive(Clone, Debug)]
pub struct Kernel {
    /// Names of the values that depend on the parameters and the step alone, and are used later.
    pub constants: Vec<String>,
    /// Names of the values that depend on the state too, and are used later.
    pub step: Vec<String>,
    /// Names of the values that depend on the unknown too, and are used in the correction or the update.
    pub iterate: Vec<String>,
    /// The components of the unknown.
    pub unknown: Vec<String>,
    /// The lengths of the blocks of these that have a unit in common.
    pub blocks: Vec<usize>,
    /// The names that the residual's components have within the correction.
    pub residual: Vec<String>,
    /// The names that the right side's components have within the sweep.
    pub right: Vec<String>,
    /// The name of the step size, if it is used.
    pub h: Option<String>,
    /// The names of all symbols, which differ from what they are called where that is taken.
    pub symbols: SymbolNames,
    /// Computes the constants.
    pub new: Section,
    /// Computes what depends on the state.
    pub begin: Section,
    /// Approximates the unknown.
    pub start: Section,
    /// Evaluates residual and right side (results in this order), and the iterate.
    pub evaluate: Section,
    /// Computes the Newton correction from the residual.
    pub correction: Section,
    /// Computes the next iterate of the fixed-point iteration, `left(x) = right(previous x)`, from the right side; without results if the
    /// left side is not linear with constant coefficients.
    pub sweep: Section,
    /// Computes the distances to the edges of the domain; without results if there is no edge.
    pub domain: Section,
    /// Computes the next state.
    pub finish: Section,
    /// Which of its components are bounded if the unknown is.
    pub bounded: Vec<bool>,
}

/// What symbols are called in some code.
#[derive(Clone, Debug, Default)]
pub struct SymbolNames(FxHashMap<Symbol, String>);

impl SymbolNames {
    /// The name of a symbol; `_` for one that is not used, as another may have the name that this one is called by.
    pub fn get(&self, symbol: Symbol) -> String {
        self.0.get(&symbol).cloned().unwrap_or_else(|| "_".to_owned())
    }

    /// The names of the symbols that a vector's components are.
    pub fn of(&self, vector: &Vector<'_>) -> Vec<String> {
        vector.iter().filter_map(|x| Some(self.get(x.as_symbol()?))).collect()
    }
}

impl Kernel {
    /// Derives Newton's correction for the step's equation, and lays all of it out in sections.
    pub fn new<'a>(arena: &'a Arena, step: &Step<'a>) -> Self {
        let unknown = step.unknown.symbols();
        let numbered = |name: &str| {
            let symbol = |i: usize| arena.symbol(format!("{name}_{i}"), Stage::Iteration);
            Vector((1..=unknown.len()).map(symbol).collect::<Vec<_>>())
        };
        let (residual, given_right) = (numbered("residual"), numbered("right"));
        let symbols = (step.unknown.clone(), residual.clone(), given_right.clone(), step.h);
        let sweep = fixed_point(step, &given_right).unwrap_or_else(|| Vector(Vec::new()));
        let jacobian = (&step.left - &step.right).jacobian(&unknown);
        let places =
            (0..jacobian.entries.len()).map(|k| (k / jacobian.columns + 1, k % jacobian.columns + 1));
        let entries = jacobian.entries.iter().zip(places);
        let entries = entries.map(|(entry, (i, j))| entry.hold().named(format!("jacobian_{i}{j}"))).collect();
        let jacobian = Matrix::new(jacobian.rows, jacobian.columns, entries);
        let correction = if unknown.is_empty() { residual.clone() } else { jacobian.solve(&residual) };

        let domain = Vector(step.domain.clone());
        let groups = [&step.start, &step.left, &step.right, &correction, &sweep, &domain, &step.next];
        let mut factoring = Factoring::new(arena, groups.into_iter().flat_map(Vector::iter));
        let mut plan = Plan::new(arena);
        let mut names = Namer::new();
        let planned = groups.map(|group| {
            let signed: Vec<Signed> = group.iter().map(|expr| plan.plan(factoring.of(expr))).collect();
            signed
        });
        names.carry_over(arena, &factoring, &plan);
        let [start, left, right, correction, sweep, domain, next] = planned;
        let difference: Vec<Signed> = left.iter().zip(&right).map(|(&l, &r)| plan.difference(l, r)).collect();
        plan.share_pairs();
        plan.shorten_divisions();

        let evaluation = [difference, right].concat();
        let outputs = schedule::Outputs { start, evaluation, correction, sweep, domain, next };
        let mut kernel = Schedule::new(arena, &plan, names).kernel(outputs, &step.given);
        let (unknown, residual, right, h) = symbols;
        kernel.right = kernel.symbols.of(&right);
        kernel.unknown = kernel.symbols.of(&unknown);
        kernel.blocks = step.blocks.clone();
        kernel.residual = kernel.symbols.of(&residual);
        kernel.bounded = step.bounded.clone();
        kernel.h = h.as_symbol().map(|h| kernel.symbols.get(h)).filter(|h| kernel.new.inputs.contains(h));
        kernel
    }
}

/// The solution `x` of `left(x) = right`, where the left side is linear in the unknown with coefficients that depend on parameters and step
/// alone: their inverse is then computed once, when the stepper is built.
fn fixed_point<'a>(step: &Step<'a>, right: &Vector<'a>) -> Option<Vector<'a>> {
    let arena = step.h.arena();
    let symbols = step.unknown.symbols();
    if symbols.is_empty() {
        return None;
    }
    let matrix = step.left.jacobian(&symbols);
    let is_constant = matrix.entries.iter().all(|entry| entry.stage() <= Stage::Parameters);
    let is_linear = (&step.left - &matrix.times(&step.unknown)).iter().all(|x| x.is_zero());
    if !(is_constant && is_linear) {
        return None;
    }
    let unit = |j: usize| {
        let entry = |i: usize| if i == j { arena.one() } else { arena.zero() };
        Vector((0..symbols.len()).map(entry).collect::<Vec<_>>())
    };
    let columns: Vec<Vector<'a>> = (0..symbols.len()).map(|j| matrix.solve(&unit(j))).collect();
    let row = |i: usize| {
        let products = columns.iter().zip(right.iter()).map(|(column, x)| column.0[i].hold() * x);
        products.fold(arena.zero(), |sum, product| sum + product)
    };
    Some(Vector((0..symbols.len()).map(row).collect()))
}

/// Straight-line code for expressions of parameters and state that stand for themselves (energy, Casimirs, …), and what it calls
/// its symbols.
pub fn function<'a>(arena: &'a Arena, outputs: &Vector<'a>) -> (Section, SymbolNames) {
    let mut factoring = Factoring::new(arena, outputs.iter());
    let mut plan = Plan::new(arena);
    let outputs: Vec<Signed> = outputs.iter().map(|expr| plan.plan(factoring.of(expr))).collect();
    plan.share_pairs();
    Schedule::new(arena, &plan, Namer::new()).function(&outputs)
}

/// How many operations of each kind some code takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Operations {
    /// Additions and subtractions.
    pub additions: usize,
    /// Multiplications.
    pub multiplications: usize,
    /// Divisions.
    pub divisions: usize,
    /// Square roots.
    pub roots: usize,
    /// Evaluations of Stumpff functions, all those of one argument together.
    pub stumpff: usize,
    /// Calls of other functions.
    pub functions: usize,
}

impl Section {
    /// How many operations it takes.
    pub fn operations(&self) -> Operations {
        let mut count = Operations::default();
        for statement in &self.statements {
            match statement {
                Statement::Let { value, .. } => count.add(value),
                Statement::Stumpff { argument, .. } => {
                    count.stumpff += 1;
                    count.add(argument);
                }
            }
        }
        self.results.iter().for_each(|result| count.add(result));
        count
    }
}

impl Operations {
    fn add(&mut self, term: &Term) {
        match term {
            Term::Number(_) | Term::Name(_) => {}
            Term::Negative(x) => self.add(x),
            Term::Sum(addends) => {
                self.additions += addends.len() - 1;
                addends.iter().for_each(|(_, addend)| self.add(addend));
            }
            Term::Product(factors) => {
                self.multiplications += factors.len() - 1;
                factors.iter().for_each(|factor| self.add(factor));
            }
            Term::Quotient(x, y) => {
                self.divisions += 1;
                self.add(x);
                self.add(y);
            }
            Term::Function(function, x) => {
                *(if *function == Function::Sqrt { &mut self.roots } else { &mut self.functions }) += 1;
                self.add(x);
            }
            Term::Power(x, y) | Term::Atan2(x, y) => {
                self.functions += 1;
                self.add(x);
                self.add(y);
            }
        }
    }
}

impl std::ops::Add for Operations {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            additions: self.additions + other.additions,
            multiplications: self.multiplications + other.multiplications,
            divisions: self.divisions + other.divisions,
            roots: self.roots + other.roots,
            stumpff: self.stumpff + other.stumpff,
            functions: self.functions + other.functions,
        }
    }
}

impl std::fmt::Display for Operations {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let kinds = [
            (self.additions, "addition", "additions"),
            (self.multiplications, "multiplication", "multiplications"),
            (self.divisions, "division", "divisions"),
            (self.roots, "square root", "square roots"),
            (self.stumpff, "evaluation of Stumpff functions", "evaluations of Stumpff functions"),
            (self.functions, "function call", "function calls"),
        ];
        let present: Vec<String> = kinds
            .into_iter()
            .filter(|&(count, ..)| count > 0)
            .map(|(count, one, many)| format!("{count} {}", if count == 1 { one } else { many }))
            .collect();
        f.write_str(&if present.is_empty() { "no operation".to_owned() } else { present.join(", ") })
    }
}
