//! Random expressions as plain trees, evaluated as written: an oracle that simplifies nothing.

use std::cell::Cell;
use std::fmt::Debug;

use coadjoint_codegen::expr::{Expr, Function, Number};

use crate::evaluate::Value;
use proptest::prelude::*;
use proptest::sample::select;
use proptest::test_runner::{Config, RngAlgorithm, RngSeed, TestCaseError, TestRunner};

use super::matrix::Column;
use super::real::Real;
use crate::random::Random;

/// An expression as a user might write it.
#[derive(Clone, Debug)]
pub enum Tree {
    /// `numerator / denominator`
    Number(i64, i64),
    /// One of the variables, by its place among them.
    Variable(usize),
    /// `−x`
    Negative(Box<Tree>),
    /// `x + y`
    Sum(Box<Tree>, Box<Tree>),
    /// `x − y`
    Difference(Box<Tree>, Box<Tree>),
    /// `x y`
    Product(Box<Tree>, Box<Tree>),
    /// `x / y`
    Quotient(Box<Tree>, Box<Tree>),
    /// `numerator / denominator · x`
    Scaled(i64, i64, Box<Tree>),
    /// `x^n`
    Integer(Box<Tree>, i32),
    /// `x^y`
    Power(Box<Tree>, Box<Tree>),
    /// `atan2(y, x)`
    Atan2(Box<Tree>, Box<Tree>),
    /// `f(x)`
    Function(Function, Box<Tree>),
    /// `y` where `x < 0`, `z` elsewhere
    Choice(Box<Tree>, Box<Tree>, Box<Tree>),
    /// `x`, kept whole
    Held(Box<Tree>),
}

impl Tree {
    /// The expression, through the operators that formulas are written with.
    pub fn build<'a>(&self, variables: &[Expr<'a>]) -> Expr<'a> {
        let arena = variables[0].arena();
        let of = |tree: &Tree| tree.build(variables);
        let ratio = |n: &i64, d: &i64| Number::ratio((*n).into(), (*d).into());
        match self {
            Self::Number(n, d) => arena.number(ratio(n, d)),
            Self::Variable(i) => variables[*i],
            Self::Negative(x) => -of(x),
            Self::Sum(x, y) => of(x) + of(y),
            Self::Difference(x, y) => of(x) - of(y),
            Self::Product(x, y) => of(x) * of(y),
            Self::Quotient(x, y) => of(x) / of(y),
            Self::Scaled(n, d, x) => of(x).scale(ratio(n, d)),
            Self::Integer(x, n) => of(x).powi(*n),
            Self::Power(x, y) => of(x).pow(of(y)),
            Self::Atan2(y, x) => of(y).atan2(of(x)),
            Self::Function(function, x) => of(x).apply(*function),
            Self::Choice(x, y, z) => of(x).choose(of(y), of(z)),
            Self::Held(x) => of(x).hold(),
        }
    }

    /// The value, or none where the expression is not defined, near such a place, or huge: there roundoff and differences say little.
    pub fn value(&self, variables: &Column) -> Option<Real> {
        let of = |tree: &Tree| tree.value(variables);
        let away_from_zero = |x: Real| (x.abs() >= Real::ratio(1, 20)).then_some(x);
        let positive = |x: Real| (x >= Real::ratio(1, 20)).then_some(x);
        let value = match self {
            Self::Number(n, d) => Real::ratio(*n, *d),
            Self::Variable(i) => variables[*i].clone(),
            Self::Negative(x) => -of(x)?,
            Self::Sum(x, y) => of(x)? + of(y)?,
            Self::Difference(x, y) => of(x)? - of(y)?,
            Self::Product(x, y) => of(x)? * of(y)?,
            Self::Quotient(x, y) => of(x)? / away_from_zero(of(y)?)?,
            Self::Scaled(n, d, x) => Real::ratio(*n, *d) * of(x)?,
            Self::Integer(x, n) => {
                let x = if *n < 0 { away_from_zero(of(x)?)? } else { of(x)? };
                let power = (0..n.unsigned_abs()).fold(Real::from(1), |power, _| power * &x);
                if *n < 0 { Real::from(1) / power } else { power }
            }
            Self::Power(x, y) => positive(of(x)?)?.power(&of(y)?),
            Self::Atan2(y, x) => {
                let (y, x) = (of(y)?, of(x)?);
                // not on the cut along the negative axis, nor at the origin
                if x < Real::ratio(1, 20) { away_from_zero(y)?.atan2(&x) } else { y.atan2(&x) }
            }
            Self::Function(function, x) => {
                let x = of(x)?;
                let allowed = match function {
                    Function::Sqrt | Function::Ln => x >= Real::ratio(1, 20),
                    Function::Asin | Function::Acos => x.abs() <= Real::ratio(19, 20),
                    Function::Tan => x.apply(Function::Cos).abs() >= Real::ratio(1, 20),
                    Function::Exp | Function::Sinh | Function::Cosh => x.abs() <= Real::from(6),
                    _ => x.abs() <= Real::from(60),
                };
                allowed.then_some(x)?.apply(*function)
            }
            Self::Choice(x, y, z) => {
                // both are computed
                let (y, z) = (of(y)?, of(z)?);
                if away_from_zero(of(x)?)? < Real::from(0) { y } else { z }
            }
            Self::Held(x) => of(x)?,
        };
        (value.abs() <= Real::from(1000)).then_some(value)
    }
}

fn boxed(tree: Tree) -> Box<Tree> {
    Box::new(tree)
}

/// Trees of so many variables, of a dozen operations or a few.
pub fn trees(variables: usize) -> BoxedStrategy<Tree> {
    deep(variables, 6)
}

fn deep(variables: usize, depth: usize) -> BoxedStrategy<Tree> {
    let leaf = prop_oneof![
        6 => (0..variables).prop_map(Tree::Variable),
        1 => (-6..=6i64, 1..=4i64).prop_map(|(n, d)| Tree::Number(n, d)),
    ]
    .boxed();
    let deeper = |inner, _| prop_oneof![1 => leaf.clone(), 6 => node(inner)].boxed();
    node((1..depth).fold(leaf.clone(), deeper))
}

/// One operation on trees.
fn node(inner: BoxedStrategy<Tree>) -> BoxedStrategy<Tree> {
    let pair = || (inner.clone(), inner.clone());
    // what must be positive or small is so by construction in half of the cases, or else little would be left
    let positive = |x| Tree::Sum(boxed(Tree::Integer(boxed(x), 2)), boxed(Tree::Number(1, 4)));
    let positives = prop_oneof![inner.clone(), inner.clone().prop_map(positive)].boxed();
    let small = |x| Tree::Scaled(3, 4, boxed(Tree::Function(Function::Sin, boxed(x))));
    let small = inner.clone().prop_map(small);
    let anywhere = select(vec![
        Function::Exp,
        Function::Sin,
        Function::Cos,
        Function::Tan,
        Function::Atan,
        Function::Sinh,
        Function::Cosh,
        Function::Tanh,
    ]);
    let exponents = prop_oneof![
        select(vec![(1, 2), (-1, 2), (3, 2), (2, 1), (-3, 1), (1, 3), (-5, 4)])
            .prop_map(|(n, d)| Tree::Number(n, d)),
        inner.clone(),
    ];
    let function = |function| move |x| Tree::Function(function, boxed(x));
    prop_oneof![
        5 => pair().prop_map(|(x, y)| Tree::Sum(boxed(x), boxed(y))),
        5 => pair().prop_map(|(x, y)| Tree::Difference(boxed(x), boxed(y))),
        7 => pair().prop_map(|(x, y)| Tree::Product(boxed(x), boxed(y))),
        3 => (inner.clone(), positives.clone()).prop_map(|(x, y)| Tree::Quotient(boxed(x), boxed(y))),
        1 => inner.clone().prop_map(|x| Tree::Negative(boxed(x))),
        2 => (-4..=4i64, 1..=3i64, inner.clone()).prop_map(|(n, d, x)| Tree::Scaled(n, d, boxed(x))),
        2 => (inner.clone(), 0..=3i32).prop_map(|(x, n)| Tree::Integer(boxed(x), n)),
        1 => (positives.clone(), -3..=-1i32).prop_map(|(x, n)| Tree::Integer(boxed(x), n)),
        1 => (positives.clone(), exponents).prop_map(|(x, y)| Tree::Power(boxed(x), boxed(y))),
        1 => pair().prop_map(|(y, x)| Tree::Atan2(boxed(y), boxed(x))),
        2 => (anywhere, inner.clone()).prop_map(|(f, x)| Tree::Function(f, boxed(x))),
        2 => (0..6u32, inner.clone()).prop_map(|(k, x)| Tree::Function(Function::Stumpff(k), boxed(x))),
        2 => positives.clone().prop_map(function(Function::Sqrt)),
        1 => positives.prop_map(function(Function::Ln)),
        1 => small.clone().prop_map(function(Function::Asin)),
        1 => small.prop_map(function(Function::Acos)),
        2 => (inner.clone(), inner.clone(), inner.clone())
            .prop_map(|(x, y, z)| Tree::Choice(boxed(x), boxed(y), boxed(z))),
        3 => inner.prop_map(|x| Tree::Held(boxed(x))),
    ]
    .boxed()
}

/// Trees with parts in common: each part may use the variables and the parts before it.
#[derive(Clone, Debug)]
pub struct Forest {
    parts: Vec<Tree>,
    trees: Vec<Tree>,
}

impl Forest {
    /// The expressions.
    pub fn build<'a>(&self, variables: &[Expr<'a>]) -> Vec<Expr<'a>> {
        let mut known = variables.to_vec();
        for part in &self.parts {
            known.push(part.build(&known));
        }
        self.trees.iter().map(|tree| tree.build(&known)).collect()
    }

    /// The values, if all are defined.
    pub fn values(&self, variables: &Column) -> Option<Column> {
        let mut known = variables.clone();
        for part in &self.parts {
            let value = part.value(&known)?;
            known.0.push(value);
        }
        self.trees.iter().map(|tree| tree.value(&known)).collect::<Option<Vec<Real>>>().map(Column)
    }
}

/// So many trees with so many parts in common. The trees are small: all of a forest must be defined at some point.
pub fn forests(variables: usize, parts: usize, count: usize) -> BoxedStrategy<Forest> {
    let part: Vec<_> = (0..parts).map(|i| deep(variables + i, 3)).collect();
    let tree = deep(variables + parts, 3);
    (part, proptest::collection::vec(tree, count)).prop_map(|(parts, trees)| Forest { parts, trees }).boxed()
}

/// Numbers for variables, in `(−1, 2)`: of both signs, more of them positive.
pub fn numbers(count: usize) -> BoxedStrategy<Column> {
    any::<u64>()
        .prop_map(move |seed| {
            let random = &mut Random::new(seed);
            let number = |_| Real::random(random) * Real::ratio(3, 2) + Real::ratio(1, 2);
            Column((0..count).map(number).collect())
        })
        .boxed()
}

/// Checks that a residual stays below a bound on random inputs, the same in every run, and shows the simplest input where it does
/// not. Inputs that have no residual do not count.
pub fn for_all<S: Strategy>(
    what: &str,
    cases: u32,
    strategy: S,
    bound: f64,
    residual: impl Fn(&S::Value) -> Option<Real>,
) where
    S::Value: Clone + Debug,
{
    let config = Config {
        cases,
        // the default takes a sixteenth of all tests of this crate: a new stream for each part of a tree
        rng_algorithm: RngAlgorithm::XorShift,
        rng_seed: RngSeed::Fixed(1),
        failure_persistence: None,
        max_global_rejects: 100 * cases,
        max_shrink_iters: 5_000,
        ..Config::default()
    };
    let worst = Cell::new(0.0);
    let outcome = TestRunner::new(config).run(&strategy, |input| {
        let residual = residual(&input).ok_or_else(|| TestCaseError::reject("not defined"))?.to_f64();
        if residual <= bound {
            worst.set(residual.max(worst.get()));
            Ok(())
        } else {
            Err(TestCaseError::fail(format!("{residual:e} exceeds {bound:e}")))
        }
    });
    println!("{what}: at most {:.1e}, bound {bound:e}", worst.get());
    if let Err(failure) = outcome {
        panic!("{what}: {failure}");
    }
}

/// The difference of two columns, relative to their size where that exceeds one.
pub fn relative(a: &Column, b: &Column) -> Real {
    let scale = Real::from(1) + a.norm() + b.norm();
    (a - b).norm() / scale
}
