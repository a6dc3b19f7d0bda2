//! The symbolic engine against plain evaluation with 71 digits: canonical form, derivatives, substitution, small linear algebra.

use coadjoint_codegen::expr::{
    Arena, Expr, Function, Matrix as Symbolic, Node, Number, Stage, Symbol, Vector, gradient,
};
use coadjoint_support::precise::formula::{Formula, Point, symbols};
use coadjoint_support::precise::matrix::{Column, Matrix, jacobian};
use coadjoint_support::precise::real::Real;
use coadjoint_support::precise::trees::{Tree, for_all, numbers, relative, trees};
use coadjoint_support::random::Random;

/// Variables of random expressions.
const VARIABLES: usize = 4;

/// Symbols and the point where they have these values.
fn at<'a>(arena: &'a Arena, values: &Column) -> (Vector<'a>, Point) {
    let variables = symbols(arena, "x", values.len(), Stage::Step);
    let mut point = Point::default();
    point.set(&variables.symbols(), values);
    (variables, point)
}

fn one(x: Real) -> Column {
    Column(vec![x])
}

/// Whether some constant no longer fit an exact fraction.
fn is_rounded(expr: Expr<'_>) -> bool {
    let arena = expr.arena();
    let rounded = |number: Number| number.fraction().is_none();
    let here = match arena.node(expr.id()) {
        Node::Number(number) => rounded(number),
        Node::Sum(sum) => rounded(sum.constant) || sum.terms.iter().any(|&(_, c)| rounded(c)),
        _ => false,
    };
    here || arena.node(expr.id()).operands().into_iter().any(|id| is_rounded(arena.expr(id)))
}

#[test]
fn canonical_form_keeps_the_value() {
    for_all("canonical form", 600, (trees(VARIABLES), numbers(VARIABLES)), 5e-70, |(tree, x)| {
        let plain = tree.value(x)?;
        let arena = Arena::new();
        let (variables, point) = at(&arena, x);
        let expr = tree.build(&variables.0);
        if is_rounded(expr) {
            return None;
        }
        Some(relative(&one(point.scalar(expr)), &one(plain)))
    });
}

#[test]
fn rounded_constants_keep_the_value_to_double_precision() {
    for_all("rounded constants", 300, (trees(VARIABLES), numbers(VARIABLES)), 1e-15, |(tree, x)| {
        let pi = std::f64::consts::PI;
        let mut x = x.clone();
        x.0[0] = Real::from(pi);
        let plain = tree.value(&x)?;
        let arena = Arena::new();
        let (mut variables, point) = at(&arena, &x);
        variables.0[0] = arena.number(Number::Float(pi));
        Some(relative(&one(point.scalar(tree.build(&variables.0))), &one(plain)))
    });
}

/// `∂tree/∂x` by central differences.
fn differences(tree: &Tree, x: &Column) -> Option<Column> {
    // defined here means defined nearby, by the distance that values keep from where they are not
    tree.value(x)?;
    let value = |x: &Column| tree.value(x).map_or_else(|| one(Real::from(0) / Real::from(0)), one);
    let gradient = jacobian(x, value).transpose().column(0);
    gradient.norm().is_finite().then_some(gradient)
}

#[test]
fn derivatives_agree_with_differences() {
    for_all("derivatives", 300, (trees(VARIABLES), numbers(VARIABLES)), 5e-43, |(tree, x)| {
        let numerical = differences(tree, x)?;
        let arena = Arena::new();
        let (variables, point) = at(&arena, x);
        let expr = tree.build(&variables.0);
        let symbolic = Vector(variables.symbols().into_iter().map(|x| expr.derivative(x)).collect());
        Some(relative(&point.vector(&symbolic), &numerical))
    });
}

#[test]
fn both_modes_of_differentiation_agree() {
    for_all("gradient", 300, (trees(VARIABLES), numbers(VARIABLES)), 5e-70, |(tree, x)| {
        tree.value(x)?;
        let arena = Arena::new();
        let (variables, point) = at(&arena, x);
        let expr = tree.build(&variables.0);
        let x = variables.symbols();
        let forward = Vector(x.iter().map(|&x| expr.derivative(x)).collect());
        Some(relative(&point.vector(&forward), &point.vector(&gradient(expr, &x))))
    });
}

#[test]
fn jacobians_and_directional_derivatives_are_made_of_partial_derivatives() {
    let arena = Arena::new();
    let x = symbols(&arena, "x", 3, Stage::Step);
    let [a, b, c] = [x.0[0], x.0[1], x.0[2]];
    let f = Vector(vec![a * b.sqrt() + c.stumpff(2), (a / c).atan2(b), a.pow(b)]);
    let symbols = x.symbols();
    let jacobian = f.jacobian(&symbols);
    for i in 0..3 {
        for (j, &symbol) in symbols.iter().enumerate() {
            assert_eq!(jacobian.at(i, j), f.0[i].derivative(symbol));
        }
    }
    let direction = Vector(vec![c, a * a, arena.number(3)]);
    let along = f.derivative_along(&symbols, &direction);
    let mut point = Point::default();
    point.set(&symbols, &Column([3, 5, 7].map(|n| Real::ratio(n, 4)).to_vec()));
    let difference = relative(&point.vector(&along), &point.vector(&jacobian.times(&direction)));
    assert!(difference < Real::ten_to(-68), "{difference:?}");
}

#[test]
fn substitution_is_evaluation_elsewhere() {
    let strategy = (trees(VARIABLES), trees(VARIABLES), numbers(VARIABLES));
    for_all("substitution", 300, strategy, 5e-70, |(tree, replacement, x)| {
        let mut replaced = x.clone();
        replaced.0[1] = replacement.value(x)?;
        let plain = tree.value(&replaced)?;
        let arena = Arena::new();
        let (variables, point) = at(&arena, x);
        let expr = tree.build(&variables.0);
        let replacement = (variables.symbols()[1], replacement.build(&variables.0));
        let substituted = expr.substitute(&[replacement]);
        if is_rounded(substituted) {
            return None;
        }
        Some(relative(&one(point.scalar(substituted)), &one(plain)))
    });
}

#[test]
fn substitution_is_simultaneous() {
    let arena = Arena::new();
    let [x, y] = ["x", "y"].map(|name| arena.symbol(name, Stage::Step));
    let [from_x, from_y] = [x, y].map(|symbol| symbol.as_symbol().expect("a symbol"));
    assert_eq!((x - y * 2).substitute(&[(from_x, y), (from_y, x)]), y - x * 2);
}

/// A random matrix `M Mᵀ + 1/10`, symmetric and positive definite.
fn positive_definite(n: usize, random: &mut Random) -> Matrix {
    let columns: Vec<Column> = (0..n).map(|_| Column::random(n, random)).collect();
    let m = Matrix::from_columns(&columns);
    &(&m * &m.transpose()) + &Matrix::identity(n).scale(&Real::ratio(1, 10))
}

#[test]
fn symmetric_matrices_factor_into_l_d_l() {
    let random = &mut Random::new(11);
    for n in 1..=4 {
        let arena = Arena::new();
        let factors = Formula::new(&arena, [n * n], |[entries]| {
            let (l, d) = Symbolic::new(n, n, entries.0).ldl();
            Vector([l.entries, d.0].concat())
        });
        for _ in 0..5 {
            let a = positive_definite(n, random);
            let values = factors.at([&a.entries()]);
            let l = Matrix::from_fn(n, n, |i, j| values[i * n + j].clone());
            let d = values.part(n * n, n);
            let diagonal = Matrix::from_fn(n, n, |i, j| if i == j { d[i].clone() } else { Real::from(0) });
            let error = (&(&(&l * &diagonal) * &l.transpose()) - &a).norm();
            assert!(error < Real::ten_to(-69), "{error:?}");
            assert!(d.0.iter().all(|pivot| pivot > &Real::from(0)), "{d:?}");
            for i in 0..n {
                assert_eq!(l.at(i, i), &Real::from(1));
                assert!((i + 1..n).all(|j| l.at(i, j) == &Real::from(0)));
            }
        }
    }
}

#[test]
fn a_matrix_that_is_not_positive_definite_has_a_pivot_that_is_not_positive() {
    let arena = Arena::new();
    let pivots = Formula::new(&arena, [9], |[entries]| Symbolic::new(3, 3, entries.0).ldl().1);
    let (one, two, zero) = (|| Real::from(1), || Real::from(2), || Real::from(0));
    // positive on the diagonal, and yet (1, −1, 0) has a negative square
    let a = Matrix::from_rows([[one(), two(), zero()], [two(), one(), zero()], [zero(), zero(), one()]]);
    let d = pivots.at([&a.entries()]);
    assert!(d.0.iter().any(|pivot| pivot < &zero()), "{d:?}");
}

#[test]
fn small_systems_are_solved() {
    let random = &mut Random::new(12);
    for n in 1..=3 {
        let arena = Arena::new();
        let solution =
            Formula::new(&arena, [n * n, n], |[entries, right]| Symbolic::new(n, n, entries.0).solve(&right));
        for _ in 0..20 {
            let a = Matrix::from_columns(&(0..n).map(|_| Column::random(n, random)).collect::<Vec<_>>());
            let right = Column::random(n, random);
            let x = solution.at([&a.entries(), &right]);
            let error = (&(&a * &x) - &right).norm() / (Real::from(1) + x.norm());
            assert!(error < Real::ten_to(-68), "{n} unknowns: {error:?}");
        }
    }
}

#[test]
fn rounded_constants_behave_like_exact_ones() {
    facts(|arena, x, y, z| {
        let pi = arena.number(Number::Float(std::f64::consts::PI));
        assert_eq!((pi * x) * y, pi * (x * y));
        assert_eq!((pi * x + pi * y) * z, z * (x * pi + y * pi));
        assert_eq!((pi * x) / (pi * x), arena.one());
        assert_eq!(pi * x - pi * x, arena.zero());
        assert_eq!(pi / pi * x, x);
        assert_eq!((pi * x - pi * y) * z, -((pi * y - pi * x) * z));
    });
}

/// Checks facts about three symbols.
fn facts(check: impl for<'a> FnOnce(&'a Arena, Expr<'a>, Expr<'a>, Expr<'a>)) {
    let arena = Arena::new();
    let [x, y, z] = ["x", "y", "z"].map(|name| arena.symbol(name, Stage::Step));
    check(&arena, x, y, z);
}

#[test]
fn equal_expressions_are_one_node() {
    facts(|_, x, y, z| {
        assert_eq!(x + y - x, y);
        assert_eq!(x + y + z, z + (y + x));
        assert_eq!(x * y * z, z * (y * x));
        assert_eq!(x + x + x, x * 3);
        assert_eq!(x * 2 - x - x, x - x);
        assert_eq!((x * y + z) - (y * x), z);
        assert_eq!(-(x - y), y - x);
        assert_eq!((x - y) / (x - y), x / x);
        assert_eq!((x * 2 + y * 2) / (x + y), x.arena().number(2));
        assert_eq!(((x - y) / 3).powi(2), (y - x).powi(2) / 9);
        assert_eq!((x * y).powi(3) / y.powi(2), x * x * x * y);
        assert_eq!((x + y).powi(2).powi(-1), (x + y).powi(-2));
        assert_eq!(x.pow(x.arena().number(3)), x * x * x);
        assert_eq!(x.pow(x.arena().number(Number::ratio(-1, 2))), x.sqrt().recip());
    });
}

#[test]
fn trivial_operations_vanish() {
    facts(|arena, x, y, _| {
        let (zero, one) = (arena.zero(), arena.one());
        assert_eq!(x - x, zero);
        assert_eq!(zero * x, zero);
        assert_eq!(x * y * zero, zero);
        assert_eq!(x.scale(0), zero);
        assert_eq!(zero + x, x);
        assert_eq!(one * x, x);
        assert_eq!(x / 1, x);
        assert_eq!(x / x, one);
        assert_eq!(x.powi(0), one);
        assert_eq!(x.powi(1), x);
        assert_eq!(-(-x), x);
        assert_eq!(x.recip().recip(), x);
        assert_eq!(x.sqrt() * x.sqrt(), x);
        assert_eq!(x.sqrt().powi(-4), x.powi(-2));
        assert_eq!((x + y).sqrt() * (x + y).sqrt(), x + y);
    });
}

#[test]
fn scale_and_sign_of_a_factor_go_outside() {
    facts(|arena, x, y, z| {
        // (a − b)(b − a) = −(a − b)²: one sum and its square, scaled
        let product = (x - y) * (y - x);
        assert_eq!(product, -((x - y) * (x - y)));
        let Node::Sum(sum) = arena.node(product.id()) else { panic!("{product} is a scaled square") };
        assert!(sum.is_scaled_term());
        assert_eq!(arena.node(sum.terms[0].0), Node::Product([((x - y).id(), 2)].into()));
        // nothing is multiplied out
        assert_eq!(((x + y) * z).to_string(), "z (x + y)");
    });
}

#[test]
fn constants_are_exact() {
    facts(|arena, x, _, _| {
        let third = || arena.number(Number::ratio(1, 3));
        assert_eq!(third() + third() + third(), arena.one());
        assert_eq!(x / 3 + x / 6 + x / 2, x);
        assert_eq!(arena.number(Number::ratio(4, 9)).sqrt(), arena.number(Number::ratio(2, 3)));
        assert_eq!(arena.number(2).sqrt().powi(2), arena.number(2));
        assert_eq!(arena.number(Number::ratio(2, 3)).powi(-3), arena.number(Number::ratio(27, 8)));
        assert_eq!(arena.zero().stumpff(5), arena.number(Number::ratio(1, 120)));
        assert_eq!(arena.zero().apply(Function::Cos), arena.one());
        assert_eq!(arena.one().apply(Function::Ln), arena.zero());
        // 0.1 + 0.2 = 0.3, unlike in doubles
        let [tenth, fifth, sum] = ["0.1", "0.2", "0.3"].map(|text| Number::parse(text).expect("a number"));
        assert_eq!(tenth + fifth, sum);
    });
}

#[test]
fn what_is_kept_whole_is_not_merged() {
    facts(|_, x, y, z| {
        let whole = (x + y).hold();
        assert_ne!(whole + z, x + y + z);
        assert_eq!(whole.hold(), whole);
        assert_eq!(x.hold(), x);
        assert_eq!(whole - whole, x - x);
    });
}

/// `value` to the accuracy of doubles.
fn is_near(number: Number, value: f64) -> bool {
    (number.to_f64() - value).abs() <= 4.0 * f64::EPSILON * value.abs()
}

#[test]
fn constants_that_do_not_fit_are_rounded() {
    let large = Number::from(1 << 50);
    assert!(is_near(large * large, 2f64.powi(100)));
    assert!(is_near(large.powi(19), 2f64.powi(950)));
    assert!(is_near(large.powi(-19), 2f64.powi(-950)));
    assert_eq!(large.powi(100).to_f64(), f64::INFINITY);
    let fine = Number::ratio(1, (1 << 52) - 1);
    assert!(is_near(fine + Number::ratio(1, 3), 1.0 / 3.0 + 2f64.powi(-52)));
    assert!(is_near(fine * fine, 2f64.powi(-104)));
    assert!(is_near(Number::ratio(i128::MAX, i128::MAX - 1), 1.0));
    assert!((Number::ratio(7, 5).powi(300).to_f64() / 1.4f64.powi(300) - 1.0).abs() < 1e-13);
    facts(|arena, x, _, _| {
        // and expressions with them still mean the same
        let mut product = x;
        let mut exact = Real::from(1);
        for prime in [1009, 1013, 1019, 1021, 1031, 1033, 1039, 1049] {
            product = product * prime + x / prime;
            exact = exact * Real::from(prime) + Real::ratio(1, prime);
        }
        let symbols: Vec<Symbol> = x.as_symbol().into_iter().collect();
        let mut point = Point::default();
        point.set(&symbols, &Column(vec![Real::ratio(1, 3)]));
        let error = point.scalar(product) / (exact / Real::from(3)) - Real::from(1);
        assert!(error.abs() < Real::ratio(1, 1 << 50), "{error:?}");
        // zero stays zero
        assert_eq!(arena.number(large * large) * arena.zero(), arena.zero());
        assert_eq!((x * 3).powi(50).scale(0), arena.zero());
        assert_eq!((x * 3).powi(50) - (x * 3).powi(50), arena.zero());
    });
}

#[test]
fn literals_are_exact_where_they_fit() {
    for (literal, numerator, denominator) in [
        ("0", 0, 1),
        ("1", 1, 1),
        ("1.", 1, 1),
        ("0.1", 1, 10),
        ("0.50", 1, 2),
        ("9.81", 981, 100),
        ("1e3", 1000, 1),
        ("1E3", 1000, 1),
        ("1e+3", 1000, 1),
        ("1e-3", 1, 1000),
        ("2.5e10", 25_000_000_000, 1),
        ("2.5e-1", 1, 4),
        ("1_000.000_5", 2_000_001, 2000),
        ("9007199254740992", 1 << 53, 1),
    ] {
        let parsed = Number::parse(literal).expect(literal);
        assert_eq!(parsed, Number::ratio(numerator, denominator), "{literal}");
        assert_eq!(parsed.fraction(), Some((numerator, denominator)), "{literal}");
    }
    for literal in
        ["9007199254740994", "0.1234567890123456789", "1e-30", "6.02214076e23", "1e300", "4.9e-324"]
    {
        let parsed = Number::parse(literal).expect(literal);
        // rounded once, as the compiler rounds it
        assert_eq!(parsed.to_f64(), literal.parse::<f64>().expect(literal), "{literal}");
        assert_eq!(parsed.fraction(), None, "{literal}");
    }
    for literal in ["", ".", "x", "1e", "1.0.0", "0x10", "1e1.5", "--1"] {
        assert_eq!(Number::parse(literal), None, "{literal}");
    }
}
