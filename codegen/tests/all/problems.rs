//! What is said about expressions without a meaning: each problem at its own tokens, and all of them at once.

use coadjoint_codegen::diagnostics::Diagnostics;
use coadjoint_codegen::expr::{Arena, Stage};
use coadjoint_codegen::language::{Scope, Value, lower_scalar};
use coadjoint_codegen::quantity::Shape;

use crate::common::{compare, told};

/// The problems of a potential, each as the text it underlines and the message.
fn problems(text: &str) -> Vec<(String, String)> {
    let expr = syn::parse_str::<syn::Expr>(text).unwrap_or_else(|error| panic!("{text}: {error}"));
    let arena = Arena::new();
    let mut scope = Scope::new();
    let shapes = [
        ("weight", Shape::Scalar),
        ("a", Shape::Scalar),
        ("chi", Shape::Vector(3)),
        ("gamma", Shape::Vector(3)),
        ("p", Shape::Vector(2)),
        ("m", Shape::Matrix(3, 3)),
        ("r", Shape::Matrix(2, 3)),
        ("big", Shape::Matrix(5, 5)),
    ];
    for (name, shape) in shapes {
        scope.define(name, Value::symbols(&arena, name, shape, Stage::Step));
    }
    for (name, shape) in [("spins", Shape::Vector(3)), ("lengths", Shape::Scalar)] {
        for k in 0..3 {
            scope.define_element(name, Value::symbols(&arena, &format!("{name}_{k}"), shape, Stage::Step));
        }
    }
    scope.define_unknown("broken");
    let mut diagnostics = Diagnostics::new();
    let value = lower_scalar("the potential", &expr, &mut scope, &arena, &mut diagnostics);
    let broken = !diagnostics.is_empty() || text.contains("broken");
    assert_eq!(value.is_none(), broken, "{text}");
    told(diagnostics)
}

/// Asserts the problems of an expression: what is underlined, and how the message begins.
#[track_caller]
fn complains(text: &str, expected: &[(&str, &str)]) {
    compare(text, &problems(text), expected);
}

#[test]
fn names() {
    complains("wieght * a", &[("wieght", "there is no `wieght` here; did you mean `weight`?")]);
    complains(
        "zeta",
        &[(
            "zeta",
            "there is no `zeta` here; known: `weight`, `a`, `chi`, `gamma`, `p`, `m`, `r`, `big`, `spins`, `lengths` and \
             `broken`",
        )],
    );
    complains(
        "self.weight",
        &[("self.weight", "parameters are known by their names alone; leave out `self.`")],
    );
    complains("self", &[("self", "parameters are known by their names alone; leave out `self.`")]);
    complains(
        "{ let longish = a; longisch }",
        &[("longisch", "there is no `longisch` here; did you mean `longish`?")],
    );
    complains("{ let b = a; b } + b", &[("b", "there is no `b` here")]);
}

#[test]
fn names_in_error_elsewhere_bring_no_further_problems() {
    complains("broken.norm() * weight + broken", &[]);
    complains("{ let b = broken; b + b.sin() }", &[]);
    complains("{ let b = nothing; b + b.sin() }", &[("nothing", "there is no `nothing` here")]);
    complains("{ let (b, c) = nothing; b + c }", &[("nothing", "there is no `nothing` here")]);
}

#[test]
fn operators() {
    complains(
        "chi * gamma",
        &[("*", "a vector of 3 cannot be multiplied by a vector of 3; write `a.dot(&b)`, `a.cross(&b)`")],
    );
    complains(
        "p * p",
        &[(
            "*",
            "a vector of 2 cannot be multiplied by a vector of 2; write `a.dot(&b)` or `a.component_mul(&b)`",
        )],
    );
    complains(
        "chi.norm() + (a + chi).norm()",
        &[(
            "+",
            "a vector of 3 cannot be added to a scalar; a vector with the scalar in every component is `Vector3::repeat(s)`",
        )],
    );
    complains("(chi - p).norm()", &[("-", "a vector of 2 cannot be subtracted from a vector of 3")]);
    complains(
        "(chi * m).norm()",
        &[("*", "a vector of 3 cannot be multiplied by a 3×3 matrix; a vector is a column")],
    );
    complains("(m * p).norm()", &[("*", "a 3×3 matrix cannot be multiplied by a vector of 2")]);
    complains("(m + r).norm()", &[("+", "a 2×3 matrix cannot be added to a 3×3 matrix")]);
    complains("a / chi", &[("/", "a scalar cannot be divided by a vector of 3")]);
    complains(
        "(chi / gamma).norm()",
        &[("/", "a vector of 3 cannot be divided by a vector of 3; write `a.component_div(&b)`")],
    );
    complains("a.sin_cos() + 1.0", &[("+", "a scalar cannot be added to a tuple of 2")]);
    complains("-a.sin_cos()", &[("-", "a tuple of 2 has no negative")]);
    complains("a < 1.0", &[("a < 1.0", "the potential must be a scalar, but this is a condition")]);
    complains("a < chi", &[("<", "numbers are compared, but these are a scalar and a vector of 3")]);
    complains(
        "(a < 1.0) == (a > 0.0)",
        &[("==", "numbers are compared, but these are a condition and a condition")],
    );
    complains("a % 1.0", &[("%", "a remainder jumps again and again, which no step resolves")]);
    complains("a ^ 2", &[("^", "`^` is not a power in Rust; write `x.powi(2)`")]);
    complains(
        "a && a > 0.0",
        &[(
            "&&",
            "this stands between conditions, such as `x < 1.0`, but these are a scalar and a condition",
        )],
    );
    complains("!a", &[("!", "`!` is for conditions, such as `x < 1.0`; this is a scalar")]);
    complains("a | a", &[("|", "this operator is not supported here")]);
}

#[test]
fn divisions_that_mean_something_else() {
    complains("1 / 2 * a", &[("/", "a division of integers drops the remainder; write `1.0 / 2.0`")]);
    complains("f64::from(1 / 2) * a", &[("/", "a division of integers drops the remainder")]);
    complains("a.powi(1 / 2)", &[("/", "a division of integers drops the remainder")]);
    complains("a / 0.0", &[("/", "this divides by zero")]);
    complains("a / (a - a)", &[("/", "this divides by zero")]);
    complains("(chi / 0.0).norm()", &[("/", "this divides by zero")]);
    complains("0.0.recip()", &[("recip", "this divides by zero")]);
    complains("a * 0.0.powi(-1)", &[("powi", "this divides by zero")]);
    complains("(chi - chi).normalize().x", &[("normalize", "this divides by zero")]);
    complains("chi.component_div(&Vector3::x()).x", &[("&Vector3::x()", "a component of this is zero")]);
}

#[test]
fn casts() {
    complains("0.1f32 as f64", &[("as", "only integers can be cast; this needs no cast")]);
    complains("a as f32 as f64", &[("as", "only integers can be cast")]);
    complains("2 as u8 as f64", &[("u8", "only casts to `f64` and `f32` are supported")]);
    complains("f64::from(0.1f32)", &[("0.1f32", "only integers can be converted")]);
    complains("f64::from(1, 2)", &[("from", "`from` takes one integer")]);
}

#[test]
fn numbers() {
    complains("99999999999999999999999 * a", &[("99999999999999999999999", "this integer is too large")]);
    complains("a * (9223372036854775807 + 1) as f64", &[("+", "this integer is too large")]);
    complains("1e999", &[("1e999", "")]);
    complains("1e300 * 1e300", &[("1e300 * 1e300", "this constant is too large or not a number")]);
    complains("1e300 * a * 1e300", &[("1e300 * a * 1e300", "this constant is too large")]);
    complains("\"a\"", &[("\"a\"", "only numbers can be written here")]);
    complains("true", &[("true", "the potential must be a scalar, but this is a condition")]);
    complains("(-1.0).sqrt()", &[("sqrt", "`sqrt` is not a real number at -1")]);
    complains(
        "0.0.ln() + 2.0.acos()",
        &[("ln", "`ln` is not a real number at 0"), ("acos", "`acos` is not a real number at 2")],
    );
    complains("(-2.0).powf(0.3)", &[("powf", "a power that is not whole needs a positive base")]);
}

#[test]
fn powers() {
    complains("a.powi(b)", &[("b", "there is no `b` here")]);
    complains("a.powi(a)", &[("a", "`powi` takes an integer literal; for other exponents there is `powf`")]);
    complains("a.powi(2000000000)", &[("2000000000", "this exponent is too large; the largest is 1024")]);
    complains("a.powi(-2147483648)", &[("-2147483648", "this exponent is too large")]);
    complains("2.0.powf(2e9)", &[("2e9", "this exponent is too large")]);
    complains("a.powf(1e300)", &[("1e300", "this exponent is too large")]);
    complains("a.powi(1000).powi(1000)", &[("a.powi(1000).powi(1000)", "this holds a power of 1000000")]);
    complains(
        "{ let b = a.powi(1000); vector![b, 1.0].dot(&vector![b, a]) }",
        &[("vector![b, 1.0].dot(&vector![b, a])", "this holds a power of 2000")],
    );
}

#[test]
fn components() {
    complains("chi.w", &[("w", "a vector of 3 has no component `w`, but `x`, `y` and `z`")]);
    complains("a.x", &[("x", "a scalar has no components")]);
    complains("m.m44", &[("m44", "a 3×3 matrix has no component `m44`")]);
    complains("chi.0", &[("0", "write `[0]` for a component by number")]);
    complains("a.sin_cos().2", &[("2", "a tuple of 2 ends before this")]);
    complains("chi[3]", &[("3", "this index is out of range: a vector of 3 has 0 to 2")]);
    complains("chi[-1]", &[("-1", "this index is out of range")]);
    complains("m[(3, 0)]", &[("(3, 0)", "this index is out of range: a 3×3 matrix has (0, 0) to (2, 2)")]);
    complains("r[6]", &[("6", "this index is out of range: a 2×3 matrix has 0 to 5")]);
    complains("chi[a]", &[("a", "an index is an integer, `v[0]`, or a pair")]);
    complains("m[(0, a)]", &[("(0, a)", "an index is an integer, `v[0]`, or a pair")]);
    complains("a[0]", &[("a[0]", "a scalar cannot be indexed")]);
}

#[test]
fn methods() {
    complains("chi.dott(&gamma)", &[("dott", "a vector of 3 has no method `dott`")]);
    assert!(problems("chi.dott(&gamma)")[0].1.contains("did you mean `dot`?"));
    assert!(problems("a.frobnicate()")[0].1.contains("`sqrt`, `powi`"));
    complains(
        "a.floor()",
        &[("floor", "`floor` jumps again and again, which no step resolves; give such a value as a control")],
    );
    complains("chi.abs().x", &[("abs", "a vector of 3 has no method `abs` here; it is one of numbers")]);
    complains("a.clamp(1.0, 0.5)", &[("clamp", "the lower limit is above the upper one")]);
    complains("a.clamp(weight, weight - 1.0)", &[("clamp", "the lower limit is above the upper one")]);
    complains("a.max(chi)", &[("chi", "`max` takes a scalar here, but this is a vector of 3")]);
    complains(
        "chi.dot(&p)",
        &[("&p", "`dot` takes a vector of 3 here, as its receiver is, but this is a vector of 2")],
    );
    complains("chi.dot()", &[("dot", "`dot` takes 1 argument, not 0")]);
    complains("a.mul_add(a)", &[("mul_add", "`mul_add` takes 2 arguments, not 1")]);
    complains("a.atan2(chi)", &[("chi", "`atan2` takes a scalar here, but this is a vector of 3")]);
    complains(
        "a.mul_add(chi, p)",
        &[
            ("chi", "`mul_add` takes a scalar here, but this is a vector of 3"),
            ("p", "`mul_add` takes a scalar here, but this is a vector of 2"),
        ],
    );
    complains("p.cross(&p).norm()", &[("cross", "`cross` is for vectors of 3; this is a vector of 2")]);
    complains("r.trace()", &[("trace", "`trace` is for square matrices; this is a 2×3 matrix")]);
    complains("big.determinant()", &[("determinant", "determinants are supported up to 4 rows")]);
    complains("m.row(3).norm()", &[("3", "this index is out of range: it goes from 0 to 2")]);
    complains("r.tr_mul(&chi).norm()", &[("&chi", "`tr_mul` takes a vector or matrix of 2 rows here, but")]);
    complains("2.sqrt()", &[("sqrt", "methods of integers are not supported; write the number as a float")]);
    complains("a.sin_cos().sin()", &[("sin", "a tuple of 2 has no methods")]);
    complains("m.trace::<f64>()", &[("::<f64>", "leave out the types")]);
    // a suggestion takes the place of the list, and no number is a slip of another
    assert!(!problems("chi.dott(&gamma)")[0].1.contains("Its methods"));
    complains("Vector2::z().x", &[("z", "there is no `Vector2::z` here")]);
    complains(
        "chi.cos()",
        &[(
            "cos",
            "a vector of 3 has no method `cos` here; it is one of numbers, such as the component `.x`: write `.x.cos()`",
        )],
    );
}

#[test]
fn inverses() {
    complains(
        "big.try_inverse().unwrap().trace()",
        &[("try_inverse", "inverses are supported up to 4 rows")],
    );
    complains(
        "r.try_inverse().unwrap().trace()",
        &[("try_inverse", "`try_inverse` is for square matrices; this is a 2×3 matrix")],
    );
    complains("(m - m).try_inverse().unwrap().trace()", &[("try_inverse", "this matrix is singular")]);
    complains(
        "matrix![a, a; a, a].try_inverse().unwrap().trace()",
        &[("try_inverse", "this matrix is singular")],
    );
    complains(
        "m.try_inverse().trace()",
        &[("trace", "an option of a 3×3 matrix is taken with `.unwrap()` or `.expect(\"…\")`")],
    );
    complains(
        "m.try_inverse()",
        &[(
            "m.try_inverse()",
            "the potential must be a scalar, but this is an option of a 3×3 matrix (take it with `.unwrap()`)",
        )],
    );
    complains(
        "(m.try_inverse() * chi).x",
        &[(
            "*",
            "an option of a 3×3 matrix (take it with `.unwrap()`) cannot be multiplied by a vector of 3",
        )],
    );
    complains("m.try_inverse().expect().trace()", &[("expect", "`expect` takes a message")]);
    complains("m.try_inverse().unwrap(1).trace()", &[("unwrap", "`unwrap` takes no argument")]);
}

#[test]
fn blocks_of_matrices() {
    complains(
        "chi.fixed_rows(0).norm()",
        &[("fixed_rows", "a vector of 3 has no method `fixed_rows` here; write `fixed_rows::<3>(0)`")],
    );
    complains("chi.fixed_rows::<2>(2).norm()", &[("fixed_rows", "this goes beyond a vector of 3")]);
    complains("chi.fixed_rows::<2>(-1).norm()", &[("fixed_rows", "this goes beyond a vector of 3")]);
    complains("chi.fixed_rows::<0>(0).norm()", &[("fixed_rows", "this goes beyond a vector of 3")]);
    complains(
        "chi.fixed_rows::<9223372036854775807>(9223372036854775807).norm()",
        &[("fixed_rows", "this goes beyond a vector of 3")],
    );
    complains("chi.fixed_rows::<N>(0).norm()", &[("fixed_rows", "write `fixed_rows::<R>(i)`")]);
    complains("m.fixed_view::<2, 2>(0).norm()", &[("fixed_view", "write `fixed_rows::<R>(i)`")]);
    complains("m.fixed_columns::<4>(0).norm()", &[("fixed_columns", "this goes beyond a 3×3 matrix")]);
    complains("a.fixed_rows::<1>(0)", &[("::<1>", "leave out the types")]);
}

#[test]
fn functions() {
    // nobody is asked for it as for a function of a user's own
    let body = crate::common::tokens("struct Body { #[inertia] inertia: f64 }");
    let attribute = crate::common::tokens("group = SO2, potential = -cos(inertia)");
    let expanded = coadjoint_codegen::lie_poisson_system(attribute, body).to_string();
    assert!(expanded.contains("`cos` is a method of numbers") && !expanded.contains("cos !"), "{expanded}");
    complains("height(a)", &[("height", "this function is not known here; known are functions of `f64`")]);
    complains("cos(a)", &[("cos", "`cos` is a method of numbers, as in `x.sin()` or `x.powi(2)`$")]);
    complains("physics::height(a)", &[("physics::height", "this function is not known here")]);
    complains("<f64 as Float>::sin(a)", &[("<f64 as Float>::sin", "this function is not known here")]);
    complains("f64::round(a)", &[("round", "`round` jumps again and again")]);
    complains("f64::sin(chi)", &[("chi", "`f64::sin` takes a scalar first, but this is a vector of 3")]);
    complains("f64::epsilon()", &[("epsilon", "`f64::epsilon` has no symbolic meaning here")]);
    complains("Vector3::new(a, a).x", &[("new", "`Vector3::new` takes 3 arguments, not 2")]);
    complains(
        "Vector3::new(a, chi, p).x",
        &[
            ("chi", "this entry must be a scalar, but it is a vector of 3"),
            ("p", "this entry must be a scalar, but it is a vector of 2"),
        ],
    );
    complains("Vector2::z().x", &[("z", "there is no `Vector2::z` here")]);
    complains("Vector3::zero().x", &[("zero", "there is no `Vector3::zero` here; did you mean `zeros`?")]);
    complains("Vector2::dot(&chi, &p)", &[("&chi", "`Vector2::dot` takes a vector of 2 first")]);
    complains(
        "Matrix3::from_diagonal(&p).trace()",
        &[("&p", "`Matrix3::from_diagonal` takes a vector of 3")],
    );
    complains("(|x| x)(a)", &[("(|x| x)", "calling this is not supported here")]);
    complains(
        "format!(\"a\")",
        &[("format", "the only macros with a symbolic meaning are `vector!` and `matrix!`")],
    );
    complains("vector![].x", &[("vector", "this `vector!` is empty")]);
    complains("vector![a; a].x", &[("a", "a vector has one row of components")]);
    complains("matrix![a, a; a].trace()", &[("a", "this row has 1 component, but the first has 2")]);
    complains("vector![a a].x", &[("a", "expected `,`")]);
}

#[test]
fn constructs() {
    complains(
        "if a { a } else { a }",
        &[("a", "a condition compares numbers, as in `x < 1.0`, but this is a scalar")],
    );
    complains("if a < 1.0 { a }", &[("if", "this `if` is a value, and needs an `else`")]);
    complains("if let b = a { b } else { a }", &[("let", "a condition compares numbers here")]);
    complains(
        "(if a < 1.0 { chi } else { p }).x",
        &[("if", "the values to choose from are a vector of 3 and a vector of 2")],
    );
    complains(
        "if a < 1.0 { nothing } else { none }",
        &[("nothing", "there is no `nothing`"), ("none", "there is no `none`")],
    );
    complains("if a < 1.0 { let b = a; b } else { b }", &[("b", "there is no `b` here")]);
    complains(
        "a.powi(if a < 1.0 { 2 } else { 3 })",
        &[("if a < 1.0 { 2 } else { 3 }", "`powi` takes an integer literal")],
    );
    complains(
        "lengths.spline(0.0, 1.0, chi)",
        &[("chi", "`spline` takes numbers, but this is a vector of 3")],
    );
    complains("lengths.spline(1.0, 1.0, a)", &[("1.0", "the last knot lies where the first one does")]);
    complains(
        "spins.spline(0.0, 1.0, a)",
        &[("spline", "a spline goes through an array of two numbers or more")],
    );
    complains("match a { _ => a }", &[("match", "write `if … else …` in the place of `match`")]);
    complains("for x in y { }", &[("for", "a loop is not supported here")]);
    complains("loop { }", &[("loop", "a loop is not supported here")]);
    complains("while y { }", &[("while", "a loop is not supported here")]);
    complains("|x| x", &[("|x| x", "a closure is not supported here")]);
    complains("[a; 2][0]", &[("[a; 2]", "write out the elements, as in `[a, b]`, or `vector![…]`")]);
    complains("a?", &[("?", "`?` is not supported here")]);
    complains("return a", &[("return", "leave out `return`")]);
    complains("a = 2.0", &[("=", "assignments are not supported")]);
    complains("unsafe { a }", &[("unsafe { a }", "this is not supported here")]);
}

#[test]
fn blocks() {
    complains("{ }", &[("{ }", "this block is empty")]);
    complains("{ let b = a; }", &[("let b = a;", "the block must end with a value after this")]);
    complains("{ a; }", &[(";", "the block must end with a value; leave out this semicolon")]);
    complains("{ a; a }", &[("a", "this value is not used; give it a name with `let`")]);
    complains("{ let b; a }", &[("let b;", "this variable needs a value")]);
    complains("{ let mut b = a; b += a; b }", &[("+=", "assignments are not supported")]);
    complains("{ let (b, c) = a; b }", &[("(b, c)", "a scalar cannot be taken apart like this")]);
    complains(
        "{ let Some(b) = a else { return }; a }",
        &[
            ("else", "`let … else` is not supported here"),
            ("Some(b)", "a pattern is a name, or names in parentheses"),
        ],
    );
    complains("{ #[cfg(test)] let b = a; b }", &[("#[cfg(test)]", "attributes are not supported")]);
    complains(
        "{ const B: f64 = 1.0; a }",
        &[("const B: f64 = 1.0;", "items are not supported in expressions")],
    );
    complains("{ println!(); a }", &[("println!();", "this has no value; leave it out")]);
    complains("'a: { a }", &[("'a:", "a label is not supported here")]);
}

#[test]
fn arrays() {
    complains("spins[3].x", &[("3", "this index is out of range: an array of 3 has 0 to 2")]);
    complains("lengths[1 - 2]", &[("1 - 2", "this index is out of range: an array of 3")]);
    complains("spins[a].x", &[("a", "the index of an array is an integer that is known now")]);
    complains("spins[1.0].x", &[("1.0", "the index of an array is an integer that is known now")]);
    complains("spins[0..2].x", &[("0..2", "the index of an array is an integer that is known now")]);
    complains("spins[(0, 1)]", &[("(0, 1)", "the index of an array is an integer that is known now")]);
    complains("spins.x", &[("x", "an array of 3 has no components")]);
    complains("spins.0.x", &[("0", "an array of 3 has no fields")]);
    complains("spins + spins", &[("+", "an array of 3 cannot be added to an array of 3")]);
    complains("-lengths", &[("-", "an array of 3 (a vector is written `vector![…]`) has no negative")]);
    complains(
        "chi.dot(&lengths)",
        &[(
            "&lengths",
            "`dot` takes a vector of 3 here, as its receiver is, but this is an array of 3 (a vector is written `vector![…]`)",
        )],
    );
    complains("lengths", &[("lengths", "the potential must be a scalar, but this is an array of 3")]);
    complains("[][0]", &[("[]", "this array is empty")]);
    complains(
        "spins.sum::<f64>()",
        &[("sum", "an array of 3 has no method `sum`; write `.iter().sum::<f64>()`")],
    );
    complains("spins.norm()", &[("norm", "an array of 3 has no method `norm` here; known: `len`, `iter`")]);
    complains(
        "lengths.maps(|x| x)[0]",
        &[("maps", "an array of 3 (a vector is written `vector![…]`) has no method")],
    );
    complains("lengths.windows()", &[("windows", "write `windows(n)`")]);
    complains("lengths.windows(0).map(|x| x[0]).sum::<f64>()", &[("0", "a window has one element or more")]);
    complains("lengths.iter::<f64>()", &[("::<f64>", "leave out the types")]);
}

#[test]
fn iterators() {
    let empty = "there is nothing to sum: this has no elements";
    for nothing in [
        "(0..0).map(|i| lengths[i])",
        "(2..1).map(|_| a)",
        "lengths.windows(4).map(|x| x[0])",
        "lengths.iter().skip(3)",
    ] {
        complains(&format!("{nothing}.sum::<f64>()"), &[("sum", empty)]);
    }
    complains("(0..4).map(|i| lengths[i]).sum::<f64>()", &[("i", "this index is out of range")]);
    complains("(0..3).map(|i| lengths[i - 1]).sum::<f64>()", &[("i - 1", "this index is out of range")]);
    complains("(0..257).map(|_| a).sum::<f64>()", &[("0..257", "a range has 256 integers at most here")]);
    for absurd in
        ["0..9223372036854775807", "-9223372036854775807..=9223372036854775807", "0..=9223372036854775807"]
    {
        complains(
            &format!("({absurd}).map(|_| a).sum::<f64>()"),
            &[(absurd, "a range has 256 integers at most here")],
        );
    }
    complains("(0..).map(|i| lengths[i]).sum::<f64>()", &[("0..", "a range needs both its ends here")]);
    complains(
        "(0.0..a).map(|x| x).sum::<f64>()",
        &[("0.0..a", "the ends of a range are integers that are known now")],
    );
}

#[test]
fn closures() {
    complains("lengths.iter().map(f64::sin).sum::<f64>()", &[("f64::sin", "`map` takes a closure here")]);
    complains(
        "lengths.iter().map(|x, y| x).sum::<f64>()",
        &[("|x, y| x", "this closure takes one argument")],
    );
    complains("lengths.iter().map(|| a).sum::<f64>()", &[("|| a", "this closure takes one argument")]);
    complains(
        "lengths.iter().map(|(x, y)| x).sum::<f64>()",
        &[("(x, y)", "a scalar cannot be taken apart like this")],
    );
    complains(
        "lengths.iter().map(|Some(x)| a).sum::<f64>()",
        &[("Some(x)", "a pattern is a name, or names in parentheses")],
    );
    // once, not for each element
    complains(
        "lengths.iter().map(|x| x * nothing).sum::<f64>()",
        &[("nothing", "there is no `nothing` here")],
    );
    complains("(0..3).map(|i| chi * spins[i]).sum::<f64>()", &[("*", "a vector of 3 cannot be multiplied")]);
    complains("lengths.iter().map(|x| x.floor()).sum::<f64>()", &[("floor", "`floor` jumps")]);
    complains("lengths.iter().map(|x| broken * x).sum::<f64>()", &[]);
    complains("broken.iter().map(|x| x).sum::<f64>()", &[]);
    complains("lengths.iter().map(|x| x).sum::<f64>() + x", &[("x", "there is no `x` here")]);
    complains(
        "lengths.iter().norm()",
        &[("norm", "an iterator has no method `norm` here; known: `map`, `sum`")],
    );
    complains("lengths.iter().zip()", &[("zip", "write `zip(other)`")]);
    complains(
        "lengths.iter().zip(a).map(|(x, y)| x * y).sum::<f64>()",
        &[("a", "`zip` takes an iterator or an array, but this is a scalar")],
    );
    complains("lengths.iter().skip(a).sum::<f64>()", &[("a", "this is a number of elements")]);
    complains("lengths.iter().skip(-1).sum::<f64>()", &[("-1", "this is a number of elements")]);
    complains("lengths.iter().max()", &[("max", "an iterator has no method `max` here")]);
    complains(
        "lengths.iter().enumerate().sum::<f64>()",
        &[("sum", "a tuple of 2 cannot be added to another")],
    );
    complains("lengths.iter() + a", &[("+", "a scalar cannot be added to an iterator")]);
    complains(
        "lengths.iter()",
        &[("lengths.iter()", "the potential must be a scalar, but this is an iterator")],
    );
    complains("[chi, p].iter().sum::<f64>()", &[("sum", "a vector of 2 cannot be added to a vector of 3")]);
    complains("chi.map(|x| x).x", &[("map", "a vector of 3 has no method `map` here that takes a closure")]);
    complains(
        "{ let f = |x| x; a }",
        &[("|x| x", "a closure is not supported here; it is an argument of `map`")],
    );
    complains("7 % 0 * a", &[("%", "this divides by zero")]);
    complains("(0 - 1) as usize as f64", &[("usize", "only casts to `f64` and `f32` are supported")]);
}

/// What is said again and again within what is said again and again is an error before it takes time.
#[test]
fn nested_iterations_have_a_bound() {
    // of numbers, and of integers alone
    for inner in ["a", "1"] {
        let again = |text: String| format!("(0..256).map(|_| {text}).sum::<f64>()");
        let text = (0..8).fold(inner.to_owned(), |text, _| again(text));
        let found = problems(&text);
        assert_eq!(found.len(), 1, "{found:?}");
        assert!(found[0].1.starts_with("up to here, expressions make sums and products"), "{found:?}");
    }
    // copies of copies
    let copies = "let x = [x, x, x, x];".repeat(16);
    let found = problems(&format!("{{ let x = a; {copies} a }}"));
    assert!(found[0].1.starts_with("up to here"), "{found:?}");
    let windows = "let x = x.windows(3).map(|x| x).zip(&spins).map(|x| [x, x]).len();";
    assert!(problems(&format!("{{ let x = spins; {windows} a }}")).is_empty());
}

#[test]
fn the_result_must_be_a_scalar() {
    complains(
        "weight * chi",
        &[("weight * chi", "the potential must be a scalar, but this is a vector of 3")],
    );
    complains("{ let b = chi; b }", &[("b", "the potential must be a scalar, but this is a vector of 3")]);
    complains("a.sin_cos()", &[("a.sin_cos()", "the potential must be a scalar, but this is a tuple of 2")]);
}

#[test]
fn all_problems_are_reported() {
    complains(
        "{ let b = wieght * chi.dott(&gamma); let c = a.floor(); (if b { c } else { b }) + chi * p - nothing }",
        &[
            ("wieght", "there is no `wieght` here"),
            ("dott", "a vector of 3 has no method `dott`"),
            ("floor", "`floor` jumps again and again"),
            ("*", "a vector of 3 cannot be multiplied by a vector of 2"),
            ("nothing", "there is no `nothing` here"),
        ],
    );
}

#[test]
fn problems_know_their_line_and_column() {
    let expr = syn::parse_str::<syn::Expr>("{\n    let b = 1.0;\n    b + nothing\n}").expect("an expression");
    let (arena, mut scope, mut diagnostics) = (Arena::new(), Scope::new(), Diagnostics::new());
    lower_scalar("the potential", &expr, &mut scope, &arena, &mut diagnostics);
    let error = diagnostics.finish().expect_err("there is no `nothing`");
    let (start, end) = (error.span().start(), error.span().end());
    assert_eq!((start.line, start.column, end.line, end.column), (3, 8, 3, 15));
}

#[test]
fn what_a_compiler_would_refuse_is_refused() {
    // read as products with what a reference leads to
    let no_reference = "`*` stands between two factors; a power is `x.powi(2)`";
    for (text, at) in [
        ("a ** 2", "*"),
        ("a ** 2.0 * weight", "*"),
        ("a ** weight", "*"),
        ("a * *2", "*"),
        ("a * *weight", "*"),
        ("a * *chi.x", "*"),
        ("a + *weight", "*"),
        ("**a", "*"),
        ("a ** -2.0", "*"),
        ("a * *(2)", "*"),
        ("{ let r = gamma.norm(); r ** 2 }", "*"),
        ("{ let (r, n) = (a, 2.0); r ** n }", "*"),
    ] {
        complains(text, &[(at, no_reference)]);
    }
    // suffixes of types that there are not
    complains(
        "2weight * a",
        &[("2weight", "`weight` is no suffix of a number: a product is written `2 * weight`")],
    );
    complains(
        "2.5e3kg * a",
        &[("2.5e3kg", "`kg` is no suffix of a number: a product is written `2.5e3 * kg`")],
    );
    complains("a.powi(2k)", &[("2k", "`k` is no suffix of a number")]);
    complains("chi[0k]", &[("0k", "`k` is no suffix of a number")]);
    complains("a.abs", &[("abs", "`abs` is a method: write `.abs(…)`")]);
    complains("gamma.norm", &[("norm", "`norm` is a method: write `.norm(…)`")]);
    complains("2.e3 * a", &[("2.e3", "a number has a digit behind its point: `2.0e3`")]);
    // and what it would take
    complains(
        "lengths.iter().map(|l| a * *l + **l).sum::<f64>() + 2f64 * a + a.powi(2i32) + chi[0usize]",
        &[],
    );
}
