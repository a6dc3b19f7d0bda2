//! Differentiation, evaluation and factorization against their definitions, in doubles.

use crate::evaluate::{Evaluate as _, Value};
use coadjoint_codegen::expr::{Arena, Expr, Function, Matrix, Number, Stage, Symbol, Vector, gradient};

const FUNCTIONS: [Function; 12] = [
    Function::Sqrt,
    Function::Exp,
    Function::Ln,
    Function::Sin,
    Function::Cos,
    Function::Tan,
    Function::Asin,
    Function::Acos,
    Function::Atan,
    Function::Sinh,
    Function::Cosh,
    Function::Tanh,
];

/// Expressions of two symbols, one for each rule of differentiation, and some of several.
fn expressions<'a>(x: Expr<'a>, y: Expr<'a>) -> Vec<Expr<'a>> {
    let mut all: Vec<Expr<'a>> = FUNCTIONS.into_iter().map(|function| (x * y).apply(function)).collect();
    all.extend((0..6).map(|k| (x * 3 - y).stumpff(k)));
    all.extend([
        x.pow(y),
        y.atan2(x),
        x / y,
        (x * x + y).powi(-3),
        (x - y * 2).powi(5) * x,
        (x + y).hold() * (x * y).hold(),
        ((x / (y + 2)).hold() * y).sqrt() - (y * x).apply(Function::Sin) * 7,
        (x + y).recip().hold() * x,
    ]);
    all
}

fn symbols(arena: &Arena) -> [Expr<'_>; 2] {
    ["x", "y"].map(|name| arena.symbol(name, Stage::Step))
}

const AT: [f64; 2] = [0.7, 0.9];

fn value(expr: Expr<'_>, symbols: &[Symbol], at: [f64; 2]) -> f64 {
    expr.evaluate(&|symbol| at[usize::from(symbol == symbols[1])])
}

#[test]
fn derivatives_are_limits_of_differences() {
    let arena = Arena::new();
    let [x, y] = symbols(&arena);
    let symbols = Vector(vec![x, y]).symbols();
    for expr in expressions(x, y) {
        for place in 0..2 {
            let shifted = |by: f64| {
                let mut at = AT;
                at[place] += by;
                value(expr, &symbols, at)
            };
            // of fourth order: errors of 1e-11 from the step and from roundoff
            let difference = |h: f64| shifted(h) - shifted(-h);
            let h = 1e-3;
            let limit = (8.0 * difference(h) - difference(2.0 * h)) / (12.0 * h);
            let mut direction = vec![arena.zero(); 2];
            direction[place] = arena.one();
            let forward = Vector(vec![expr]).derivative_along(&symbols, &Vector(direction)).0[0];
            let reverse = gradient(expr, &symbols).0[place];
            for derivative in [forward, reverse] {
                let derivative = value(derivative, &symbols, AT);
                let bound = 1e-8 * limit.abs().max(1.0);
                assert!((derivative - limit).abs() < bound, "{expr}: {derivative} instead of {limit}");
            }
        }
    }
}

/// Second derivatives are the derivatives of derivatives, and do not depend on the order.
#[test]
fn second_derivatives_commute() {
    let arena = Arena::new();
    let [x, y] = symbols(&arena);
    let symbols = Vector(vec![x, y]).symbols();
    for expr in expressions(x, y) {
        let hessian = gradient(expr, &symbols).jacobian(&symbols);
        let [one, other] = [hessian.at(0, 1), hessian.at(1, 0)].map(|entry| value(entry, &symbols, AT));
        assert!((one - other).abs() < 1e-9 * one.abs().max(1.0), "{expr}: {one} and {other}");
    }
}

/// `c₀ = cos √z`, `c₁ = sin √z / √z`, and `c_k = 1/k! − z c_{k+2}`; with hyperbolic functions for negative arguments.
#[test]
fn stumpff_functions_are_their_closed_forms() {
    for z in [-9.0_f64, -0.5, 0.0, 1e-3, 2.0, 30.0] {
        let r = z.abs().sqrt();
        let (c0, c1) = match z {
            z if z > 0.0 => (r.cos(), r.sin() / r),
            z if z < 0.0 => (r.cosh(), r.sinh() / r),
            _ => (1.0, 1.0),
        };
        let c = |k: u32| z.apply(Function::Stumpff(k));
        assert!((c(0) - c0).abs() < 1e-12 * c0.abs().max(1.0), "c0({z})");
        assert!((c(1) - c1).abs() < 1e-12 * c1.abs().max(1.0), "c1({z})");
        let mut factorial = 1.0;
        for k in 0..6 {
            factorial *= f64::from(k.max(1));
            let recurrence = 1.0 / factorial - z * c(k + 2);
            assert!((c(k) - recurrence).abs() < 1e-12 * c(k).abs().max(1.0), "c{k}({z})");
        }
    }
}

#[test]
fn doubles_have_the_usual_functions() {
    let at = 0.3_f64;
    let usual = [
        at.sqrt(),
        at.exp(),
        at.ln(),
        at.sin(),
        at.cos(),
        at.tan(),
        at.asin(),
        at.acos(),
        at.atan(),
        at.sinh(),
        at.cosh(),
        at.tanh(),
    ];
    assert_eq!(FUNCTIONS.map(|function| at.apply(function)), usual);
    assert_eq!((Value::add(&at, &2.0), Value::mul(&at, &2.0)), (2.3, 0.6));
    assert!((Value::powi(&at, -2) - 1.0 / (at * at)).abs() < 1e-14);
    assert_eq!(at.power(&0.5), at.powf(0.5));
    assert_eq!(Value::atan2(&at, &-2.0), at.atan2(-2.0));
}

/// `L D Lᵀ` is the matrix, and solving by it inverts it.
#[test]
fn symmetric_matrices_are_factored_and_inverted() {
    let arena = Arena::new();
    for n in 1..=5 {
        let name = |i: usize, j: usize| format!("a{}{}", i.min(j), i.max(j));
        let entries: Vec<Expr<'_>> =
            (0..n * n).map(|k| arena.symbol(name(k / n, k % n), Stage::Step)).collect();
        // symbols of the lower triangle stand for both
        let lower = |i: usize, j: usize| entries[i.max(j) * n + i.min(j)];
        let matrix = Matrix::new(n, n, (0..n * n).map(|k| lower(k / n, k % n)).collect());
        let at = |symbol: Symbol| {
            let place = entries.iter().position(|entry| entry.as_symbol() == Some(symbol)).expect("an entry");
            let (i, j) = (place / n, place % n);
            if i == j { 3.0 + i as f64 } else { 0.3 / (1.0 + i as f64) - 0.1 * j as f64 }
        };
        let number = |expr: Expr<'_>| expr.evaluate(&at);
        let (l, d) = matrix.ldl();
        for i in 0..n {
            for j in 0..n {
                let terms = (0..n).map(|k| number(l.at(i, k)) * number(d.0[k]) * number(l.at(j, k)));
                let product: f64 = terms.sum();
                assert!(
                    (product - number(matrix.at(i, j))).abs() < 1e-13,
                    "{n}: entry {i}, {j} is {product}"
                );
            }
        }
        let right = Vector((0..n).map(|i| arena.number(i as i64 + 1)).collect());
        for solution in [matrix.solve_symmetric(&right), matrix.solve(&right)] {
            for i in 0..n {
                let image: f64 = (0..n).map(|j| number(matrix.at(i, j)) * number(solution.0[j])).sum();
                assert!((image - (i as f64 + 1.0)).abs() < 1e-12, "{n}: component {i} is {image}");
            }
        }
    }
}

/// Formulas as they are written by hand, with parentheses where they are needed and nowhere else.
#[test]
fn formulas_are_written_as_usual() {
    let arena = Arena::new();
    let [x, y] = symbols(&arena);
    for (expr, text) in [
        (x + y, "x + y"),
        (x - y, "x - y"),
        (-x, "-x"),
        (-x - y, "-x - y"),
        (x * y, "x y"),
        ((x + y) * x, "x (x + y)"),
        (x * 2 + 1, "2 x + 1"),
        (x * 2 - 3, "2 x - 3"),
        (x.powi(2), "x^2"),
        (x / y, "x y^-1"),
        ((x + y).powi(2), "(x + y)^2"),
        ((x * 2).apply(Function::Sin), "sin(2 x)"),
        (x.pow(y), "x^(y)"),
        ((x + y).pow(y + 1), "(x + y)^(y + 1)"),
        (y.atan2(x), "atan2(y, x)"),
        ((x + y).hold() * x, "x [x + y]"),
        (x / 2, "1/2 x"),
        (x * y / 2 + x, "x + 1/2 x y"),
        (x.stumpff(2), "c2(x)"),
        (arena.number(2).pow(x), "2^(x)"),
        (arena.number(-2).pow(x), "(-2)^(x)"),
        (arena.number(Number::ratio(1, 2)).pow(x), "(1/2)^(x)"),
    ] {
        assert_eq!(expr.to_string(), text);
    }
}

#[test]
fn quotients_have_one_denominator() {
    let arena = Arena::new();
    let [x, y] = symbols(&arena);
    let symbols = Vector(vec![x, y]).symbols();
    let of_x = &symbols[..1];
    let denominator = x * x + 1;
    let per = denominator.recip();
    let quotients = [
        y * per,
        (y - x) / denominator * 3,
        ((y + x).hold() * (per * 2).hold()).hold() / 5,
        y * per - (x * 7) * per.hold(),
        ((y * per).hold() + x / denominator).hold() * (y + 3),
        y.recip() * per,
        x.apply(Function::Sin) * per,
    ];
    for expr in quotients {
        let (numerator, by) = expr.as_quotient(of_x).expect("a quotient");
        assert!(by == denominator, "{expr}: {by}");
        let [whole, numerator, by] = [expr, numerator, by].map(|expr| value(expr, &symbols, AT));
        assert!((numerator / by - whole).abs() < 1e-15, "{expr}: {numerator} / {by}");
    }
    // where nothing is divided by what depends on x, by 1
    for expr in [x * y, x / y, (x + y).hold() * x - 2, arena.number(3)] {
        let (numerator, denominator) = expr.as_quotient(of_x).expect("whole");
        assert!(numerator == expr && denominator == arena.one(), "{expr}");
    }
    let others = [
        y * per + 1,
        y * per + x,
        x / (x + y) + y * per,
        per * per * y,
        per * (x + y).recip(),
        (per + 1).hold() * per,
        per.sqrt() * x,
        per.hold().recip() * y * per,
        (y * per).apply(Function::Cos),
    ];
    for expr in others {
        assert!(expr.as_quotient(of_x).is_none(), "{expr}");
    }
}

/// A function multiplied out is the same function; a power that there is no room for is left as it is.
#[test]
fn what_is_multiplied_out_is_the_same() {
    let arena = Arena::new();
    let [x, y, a] = [("x", Stage::Step), ("y", Stage::Iteration), ("a", Stage::Parameters)]
        .map(|(n, s)| arena.symbol(n, s));
    let value = |expr: Expr<'_>| {
        let values = [(x, 1.25), (y, -0.75), (a, 3.0)];
        let of = |symbol| {
            values.iter().find(|(known, _)| known.as_symbol() == Some(symbol)).expect("one of them").1
        };
        Vector(vec![expr]).evaluate(&of)[0]
    };
    let sum = (x * a + y).hold() * (x - y / a).powi(3) + (x + y).powi(2) * (x - y).hold() - x.powi(3);
    let out = sum.multiplied_out().expect("a polynomial");
    assert!((value(out) - value(sum)).abs() < 1e-12, "{} instead of {}", value(out), value(sum));
    assert!((value(x.powi(31).multiplied_out().expect("room")) - 1.25_f64.powi(31)).abs() < 1e-9);
    for without in [x.powi(32), (x * y).powi(40), x.powi(20).hold() * x.powi(20).hold(), x.sqrt(), x.recip()]
    {
        assert!(without.multiplied_out().is_none(), "{without}");
    }
}
