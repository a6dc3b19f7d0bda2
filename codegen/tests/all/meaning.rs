//! Every construct of the language against Rust and nalgebra themselves: the same tokens are compiled by rustc and
//! lowered by us, and both values must agree.
#![allow(
    clippy::all,
    clippy::unwrap_used,
    reason = "expressions are written in all the ways users write them"
)]

use crate::evaluate::Evaluate as _;
use coadjoint_codegen::diagnostics::Diagnostics;
use coadjoint_codegen::expr::{Arena, Node, Stage};
use coadjoint_codegen::language::{Scope, Value, lower, lower_scalar};
use coadjoint_codegen::quantity::Shape;
use nalgebra::{
    Matrix2, Matrix2x3, Matrix3, Matrix4, Point2, Point3, RowVector3, SMatrix, SVector, Vector1, Vector2,
    Vector3, Vector4, matrix, vector,
};
use std::f64::consts::{PI, TAU};

use crate::common::Random;

/// What the expressions are about.
struct Values {
    a: f64,
    b: f64,
    p: Vector2<f64>,
    v: Vector3<f64>,
    w: Vector3<f64>,
    q: Vector4<f64>,
    m: Matrix3<f64>,
    n: Matrix3<f64>,
    k: Matrix4<f64>,
    r: Matrix2x3<f64>,
    s: [Vector3<f64>; 4],
    l: [f64; 3],
}

/// Some values, all positive and below one, different for different seeds.
fn values(seed: u64) -> Values {
    let mut random = Random(seed);
    let mut next = || 0.1 + 0.8 * random.unit();
    Values {
        a: next(),
        b: next(),
        p: Vector2::from_fn(|_, _| next()),
        v: Vector3::from_fn(|_, _| next()),
        w: Vector3::from_fn(|_, _| next()),
        q: Vector4::from_fn(|_, _| next()),
        m: Matrix3::from_fn(|_, _| next()),
        n: Matrix3::from_fn(|_, _| next()),
        k: Matrix4::from_fn(|_, _| next()),
        r: Matrix2x3::from_fn(|_, _| next()),
        s: std::array::from_fn(|_| Vector3::from_fn(|_, _| next())),
        l: std::array::from_fn(|_| next()),
    }
}

/// The numbers a value is made of, matrices by rows.
trait Flat {
    fn flat(&self) -> Vec<f64>;
}

impl Flat for f64 {
    fn flat(&self) -> Vec<f64> {
        vec![*self]
    }
}

impl<const R: usize, const C: usize> Flat for SMatrix<f64, R, C> {
    fn flat(&self) -> Vec<f64> {
        self.transpose().iter().copied().collect()
    }
}

impl<A: Flat, const N: usize> Flat for [A; N] {
    fn flat(&self) -> Vec<f64> {
        self.iter().flat_map(Flat::flat).collect()
    }
}

impl Flat for usize {
    fn flat(&self) -> Vec<f64> {
        vec![*self as f64]
    }
}

impl<A: Flat, B: Flat> Flat for (A, B) {
    fn flat(&self) -> Vec<f64> {
        [self.0.flat(), self.1.flat()].concat()
    }
}

/// The numbers that the symbolic meaning of some text evaluates to.
fn symbolic(text: &str, values: &Values) -> Vec<f64> {
    let arena = Arena::new();
    let mut scope = Scope::new();
    let mut known: Vec<(String, f64)> =
        vec![("const_pi".into(), PI), ("const_tau".into(), TAU), ("const_gravity".into(), GRAVITY)];
    let inputs: [(&str, Shape, Vec<f64>); 10] = [
        ("a", Shape::Scalar, values.a.flat()),
        ("b", Shape::Scalar, values.b.flat()),
        ("p", Shape::Vector(2), values.p.flat()),
        ("v", Shape::Vector(3), values.v.flat()),
        ("w", Shape::Vector(3), values.w.flat()),
        ("q", Shape::Vector(4), values.q.flat()),
        ("m", Shape::Matrix(3, 3), values.m.flat()),
        ("n", Shape::Matrix(3, 3), values.n.flat()),
        ("k", Shape::Matrix(4, 4), values.k.flat()),
        ("r", Shape::Matrix(2, 3), values.r.flat()),
    ];
    let mut symbols = |name: &str, shape, numbers: Vec<f64>| {
        let value = Value::symbols(&arena, name, shape, Stage::Parameters);
        let names = value.scalars().into_iter().map(|symbol| symbol.to_string());
        known.extend(names.zip(numbers));
        value
    };
    for (name, shape, numbers) in inputs {
        scope.define(name, symbols(name, shape, numbers));
    }
    for (k, vector) in values.s.iter().enumerate() {
        scope.define_element("s", symbols(&format!("s_{k}"), Shape::Vector(3), vector.flat()));
    }
    for (k, number) in values.l.iter().enumerate() {
        scope.define_element("l", symbols(&format!("l_{k}"), Shape::Scalar, number.flat()));
    }
    let expr = syn::parse_str(text).expect("rustc took it");
    let mut diagnostics = Diagnostics::new();
    let value = lower(&expr, &mut scope, &arena, &mut diagnostics);
    if let Err(error) = diagnostics.finish() {
        panic!("{text}: {}", error.into_iter().map(|error| error.to_string()).collect::<Vec<_>>().join("\n"));
    }
    let scalars = match value {
        Some(Value::Integer(integer)) => vec![arena.number(integer)],
        Some(value) => value.scalars(),
        None => panic!("{text}: neither a value nor a problem"),
    };
    let of_symbol = |symbol| {
        let name = arena.symbol_info(symbol).name;
        known
            .iter()
            .find(|(known, _)| *known == name)
            .unwrap_or_else(|| panic!("{text}: no value for {name}"))
            .1
    };
    scalars.into_iter().map(|scalar| scalar.evaluate(&of_symbol)).collect()
}

const GRAVITY: f64 = 9.80665;

/// Asserts that rustc and we agree on an expression in the variables of [`Values`].
macro_rules! agrees {
    ($values:ident; $($expression:tt)*) => {{
        let plain = { $($expression)* }.flat();
        let text = concat!("{", stringify!($($expression)*), "}");
        let ours = symbolic(text, &$values);
        assert_eq!(plain.len(), ours.len(), "{text}");
        for (plain, ours) in plain.iter().zip(&ours) {
            assert!((plain - ours).abs() <= 1e-13 * (1.0 + plain.abs()), "{text}: {plain} is not {ours}");
        }
    }};
}

/// Runs a test over several sets of values, whose fields it names as it needs them.
macro_rules! for_values {
    ($all:ident, { $($name:ident),* }, $body:block) => {
        for seed in 1..5 {
            let $all = values(seed);
            let Values { $($name,)* .. } = $all;
            $body
        }
    };
}

#[test]
fn numbers() {
    for_values!(all, {}, {
        agrees!(all; 1.5);
        agrees!(all; 0.1 + 0.2);
        agrees!(all; 1e-3 * 2.5E2 - 1_000.0);
        agrees!(all; 2f64);
        agrees!(all; 2_f64 + 2.0f64);
        agrees!(all; 3 as f64 / 2.0);
        agrees!(all; f64::from(3) * 0.5);
        agrees!(all; f64::from(2 + 3 * 2 - 1));
        agrees!(all; (-(2 + 1)) as f64);
        agrees!(all; 1e-400);
        agrees!(all; 0.1234567890123456789012345678901234567890);
    });
}

#[test]
fn scalar_arithmetic() {
    for_values!(all, { a, b }, {
        agrees!(all; a + b - a * b / (a + 2.0));
        agrees!(all; -a + b);
        agrees!(all; -(-a));
        agrees!(all; a - b - a);
        agrees!(all; a / b / a);
        agrees!(all; a - (b - a));
        agrees!(all; 2.0 * a * -b);
        agrees!(all; *&a * &b);
        agrees!(all; ((a + b)) * ((a)));
        agrees!(all; 1.0 / 3.0 * a);
    });
}

#[test]
fn functions_of_scalars() {
    for_values!(all, { a, b }, {
        agrees!(all; a.sqrt() + a.exp() * a.ln());
        agrees!(all; a.sin() + a.cos() * a.tan());
        agrees!(all; a.asin() + a.acos() * a.atan());
        agrees!(all; a.sinh() + a.cosh() * a.tanh());
        agrees!(all; a.recip() + a.powi(3) + a.powi(-2) + a.powi(0));
        agrees!(all; a.powi(2 * 2 - 1) + a.powi(-(1 + 1)));
        agrees!(all; a.powf(b) + a.powf(2.0) + a.powf(0.5) + a.powf(-1.5) + a.powf(0.3));
        agrees!(all; a.atan2(b) + b.atan2(-a));
        agrees!(all; a.hypot(b) + a.mul_add(b, 3.0));
        agrees!(all; a.clone());
        agrees!(all; a.sin_cos());
        agrees!(all; a.sin_cos().1);
        agrees!(all; (2.0 * a).sin().powi(2));
        agrees!(all; f64::sin(a) + f64::powi(b, 2) + f64::atan2(a, b) + f64::mul_add(a, b, a));
        agrees!(all; 2.0_f64.sqrt());
    });
}

#[test]
fn choices() {
    for_values!(all, { a, b, p, v, w, m, s, l }, {
        agrees!(all; (a - b).abs() + (b - a).abs() * (a - b).signum());
        agrees!(all; (2.0 * (a - b)).signum() + 0.0_f64.signum() + (-3.0_f64).abs());
        agrees!(all; a.min(b) - 2.0 * a.max(b) + f64::max(a, 0.7));
        agrees!(all; v.x.clamp(-0.5, 0.5) + w.y.clamp(a.min(b), a.max(b)) + 2.0_f64.clamp(0.0, 1.0));
        agrees!(all; if a < b { a } else { 2.0 * b });
        agrees!(all; if a > b { v } else { w });
        agrees!(all; if a <= b && b <= a || v.x >= 0.0 { m } else { m.transpose() });
        agrees!(all; if !(v.x > 0.0) || a == b { 1.0 } else if v.y != w.y && v.z < 0.0 { 2.0 } else { 3.0 });
        agrees!(all; let turns = v.x * w.x < 0.0; let (x, y) = if turns { (a, p) } else { (b, -p) }; x * y);
        agrees!(all; if a == a { 1.0 } else { 2.0 });
        agrees!(all; if a < a || a != a { 1.0 } else { 2.0 });
        agrees!(all; let n = if 1.0 <= 1.0 { 2 } else { 3 }; a.powi(n));
        agrees!(all; let close = if a < b { b - a < 0.1 } else { false }; (if close { [a, b] } else { [b, a] })[0]);
        agrees!(all; l.iter().map(|x| if *x > a { *x } else { x * x }).sum::<f64>());
        agrees!(all; (0..3).map(|i| if i == 2 { s[i].x } else { l[i] }).sum::<f64>());
        // what is not taken need not be a number
        agrees!(all; if a < 0.0 { (a - 10.0).sqrt() } else { (a - b) / (a + 2.0) });
    });
}

#[test]
fn vector_arithmetic() {
    for_values!(all, { a, p, v, w, q }, {
        agrees!(all; v + w - 2.0 * v);
        agrees!(all; v * a);
        agrees!(all; a * v / 3.0);
        agrees!(all; -v);
        agrees!(all; &v + &w);
        agrees!(all; -&v - w);
        agrees!(all; p * a - p / a);
        agrees!(all; v * w.transpose());
        agrees!(all; v.transpose() * w);
        agrees!(all; (v.transpose() * w)[0]);
        agrees!(all; (v.transpose() * w).x);
        agrees!(all; q + Vector4::repeat(a));
    });
}

#[test]
fn methods_of_vectors() {
    for_values!(all, { a, p, v, w, q }, {
        agrees!(all; v.dot(&w) + q.dot(&q));
        agrees!(all; v.cross(&w));
        agrees!(all; v.cross(&w).dot(&v.cross(&(v + w))));
        agrees!(all; v.norm() + v.magnitude() + p.norm());
        agrees!(all; v.norm_squared() - q.magnitude_squared());
        agrees!(all; v.normalize());
        agrees!(all; v.component_mul(&w));
        agrees!(all; v.component_div(&w));
        agrees!(all; v.sum());
        agrees!(all; v.scale(a));
        agrees!(all; v.unscale(a));
        agrees!(all; v.transpose());
        agrees!(all; v.transpose().transpose());
        agrees!(all; v.tr_mul(&w));
        agrees!(all; v.cross_matrix() * w);
        agrees!(all; Vector3::dot(&v, &w) * f64::sqrt(a));
        agrees!(all; v.clone());
    });
}

#[test]
fn matrices() {
    for_values!(all, { a, b, p, v, w, m, n, k, r }, {
        agrees!(all; m * v);
        agrees!(all; m * n);
        agrees!(all; m + n - m * 2.0);
        agrees!(all; a * m / b);
        agrees!(all; -m);
        agrees!(all; r * v);
        agrees!(all; r * m);
        agrees!(all; r.transpose() * p);
        agrees!(all; v.transpose() * m);
        agrees!(all; (v.transpose() * m * w).x);
        agrees!(all; v.dot(&(m * w)));
        agrees!(all; m.transpose());
        agrees!(all; r.transpose());
        agrees!(all; m.trace() + k.trace());
        agrees!(all; m.determinant() + k.determinant());
        agrees!(all; Matrix2::new(a, b, b, 2.0).determinant());
        agrees!(all; m.diagonal());
        agrees!(all; m.row(1) * v);
        agrees!(all; m.column(2).dot(&v));
        agrees!(all; r.tr_mul(&p));
        agrees!(all; m.tr_mul(&n));
        agrees!(all; m.dot(&n) + r.dot(&r));
        agrees!(all; m.norm() + r.norm_squared() + m.sum());
        agrees!(all; m.component_mul(&n) + m.component_div(&n));
        agrees!(all; m.scale(a) - m.unscale(b));
        agrees!(all; m * n * v + n * (m * w));
        agrees!(all; m.fixed_rows::<2>(1) * v);
        agrees!(all; m.fixed_columns::<1>(2).dot(&v) + v.fixed_rows::<2>(1).norm());
        agrees!(all; k.fixed_view::<2, 3>(1, 0) * v);
        agrees!(all; v.fixed_rows::<2>(0).into_owned() + p);
        agrees!(all; 2.0 * v.fixed_rows::<2>(1) - p);
    });
}

#[test]
fn inverses() {
    for_values!(all, { a, b, v, m, n, k, q }, {
        agrees!(all; Matrix2::new(a, 0.5, -b, 2.0).try_inverse().unwrap());
        agrees!(all; (m + Matrix3::identity()).try_inverse().unwrap());
        agrees!(all; (m - n * 2.0 + Matrix3::from_diagonal_element(5.0)).try_inverse().expect("it is regular") * v);
        agrees!(all; (k + Matrix4::from_diagonal_element(3.0)).try_inverse().unwrap());
        agrees!(all; q.dot(&((k - Matrix4::from_diagonal(&q) * 4.0).try_inverse().unwrap() * q)));
        agrees!(all; Matrix3::<f64>::identity().try_inverse().unwrap().trace() + a);
    });
}

#[test]
fn points() {
    for_values!(all, { a, p, v, w }, {
        agrees!(all; Point3::from(v).coords);
        agrees!(all; Point3::from(v) - Point3::from(w));
        agrees!(all; (Point3::from(v) + w).coords);
        agrees!(all; (Point3::from(v) - w).z + Point2::from(p).y);
        agrees!(all; nalgebra::Point3::new(a, 1.0, 2.0 * a).coords.dot(&v));
        agrees!(all; Point3::<f64>::origin() - Point3::from(v));
    });
}

#[test]
fn components() {
    for_values!(all, { p, v, m, k, r, q }, {
        agrees!(all; v.x + v.y * v.z);
        agrees!(all; p.x - p.y + q.w);
        agrees!(all; v[0] * v[1] - v[2]);
        agrees!(all; m[(0, 1)] - m[(1, 0)] * m[(2, 2)]);
        agrees!(all; m[1] - m[3]);
        agrees!(all; r[1] - r[2] + r[(1, 2)]);
        agrees!(all; m.m12 - m.m31 + k.m44 + r.m23);
        agrees!(all; v[(2, 0)]);
        agrees!(all; v.transpose()[1]);
        agrees!(all; v.transpose().y);
        agrees!(all; (m * v).z);
        agrees!(all; v[1 + 1]);
    });
}

#[test]
fn constructors() {
    for_values!(all, { a, b, v }, {
        agrees!(all; Vector3::new(a, b, 1.0));
        agrees!(all; nalgebra::Vector2::new(a, b));
        agrees!(all; Vector3::x() + Vector3::y() * b - Vector3::z() * a);
        agrees!(all; v + Vector3::zeros());
        agrees!(all; Vector4::w() * a);
        agrees!(all; Vector3::<f64>::repeat(2.0));
        agrees!(all; Vector3::from_element(a));
        agrees!(all; SVector::<f64, 3>::zeros() + v);
        agrees!(all; SMatrix::<f64, 2, 3>::repeat(a));
        agrees!(all; vector![a, b, a + b]);
        agrees!(all; nalgebra::vector![a, b,]);
        agrees!(all; matrix![a, b; 1.0, 2.0]);
        agrees!(all; matrix![a, b, 1.0; 2.0, a, b;] * v);
        agrees!(all; Matrix3::identity() * v);
        agrees!(all; Matrix3::<f64>::identity());
        agrees!(all; Matrix3::from_diagonal(&v));
        agrees!(all; Matrix3::from_diagonal(&Vector3::new(1.0, a, b)) * v);
        agrees!(all; Matrix3::from_diagonal_element(a));
        agrees!(all; Matrix2::new(a, b, 3.0, 4.0));
        agrees!(all; Matrix2x3::new(a, b, 3.0, 4.0, 5.0, 6.0));
        agrees!(all; RowVector3::new(a, b, 3.0));
        agrees!(all; Vector1::new(a) * 2.0);
    });
}

#[test]
fn blocks() {
    for_values!(all, { a, b, v, w }, {
        agrees!(all; let c = a + b; c * c);
        agrees!(all; let a = a + 1.0; let a = a * a; a - b);
        agrees!(all; let c: f64 = 2.0; let u: Vector3<f64> = v * c; u.dot(&w));
        agrees!(all; let (s, c) = a.sin_cos(); s * c);
        agrees!(all; let (s, (c, _)) = (a, (b, v)); s - c);
        agrees!(all; let c = { let b = 2.0 * a; b + 1.0 }; b * c);
        agrees!(all; let i = 2; let n = -3; v[i] * a.powi(n + 1));
        agrees!(all; let u = &v; let ref t = w; u.dot(t));
        agrees!(all; let c = { a * b }; let d = { let a = 3.0; a * c }; d + a);
        agrees!(all; let u = vector![a, b]; vector![u.y, u.x]);
    });
}

#[test]
fn arrays() {
    for_values!(all, { a, v, s, l }, {
        agrees!(all; s);
        agrees!(all; s[0] + s[3]);
        agrees!(all; s[1 + 1].dot(&s[2 * 2 - 1]) * l[2]);
        agrees!(all; s[0].x + s[1][2]);
        agrees!(all; l.len() as f64 * a);
        agrees!(all; s.len());
        agrees!(all; s.map(|s| s.dot(&v)));
        agrees!(all; l.map(|l| l * v)[1]);
        agrees!(all; [a, 2.0 * a, l[0]][1]);
        agrees!(all; [s[0], v]);
        agrees!(all; let t = [v, s[1]]; t[0].cross(&t[1]));
        agrees!(all; s.clone()[2]);
        agrees!(all; s[(1 + 3) % 4].x + s[7 % 4].y);
    });
}

#[test]
fn iterators() {
    for_values!(all, { a, v, m, s, l }, {
        agrees!(all; (0..3).map(|i| s[i].dot(&s[i + 1])).sum::<f64>());
        agrees!(all; (0..=3).map(|i| s[i].dot(&s[(i + 1) % 4])).sum::<f64>() * a);
        agrees!(all; let total: f64 = (1..s.len()).map(|i| s[i - 1].x * s[i].y).sum(); total + a);
        agrees!(all; s.iter().sum::<Vector3<f64>>());
        agrees!(all; s.iter().map(|s| s.norm_squared()).sum::<f64>());
        agrees!(all; s.iter().map(|&s| m * s).sum::<Vector3<f64>>());
        agrees!(all; s.into_iter().map(|s: Vector3<f64>| s * 2.0).sum::<Vector3<f64>>());
        agrees!(all; s.iter().map(|s| s * v.transpose()).sum::<Matrix3<f64>>());
        agrees!(all; s.windows(2).map(|pair| pair[0].dot(&pair[1])).sum::<f64>());
        agrees!(all; s.windows(3).map(|three| three[0].cross(&three[1]).dot(&three[2])).sum::<f64>());
        agrees!(all; l.iter().zip(s.iter()).map(|(l, s)| *l * s.x).sum::<f64>());
        agrees!(all; l.iter().zip(&s).map(|(l, s)| *l * s.x).sum::<f64>());
        agrees!(all; l.iter().zip(s).map(|(l, s)| *l * s.x).sum::<f64>());
        agrees!(all; l.iter().zip(1..4).map(|(l, i)| l.powi(i)).sum::<f64>());
        agrees!(all; l.iter().enumerate().map(|(i, l)| *l * (i as f64 + 0.5)).sum::<f64>());
        agrees!(all; l.iter().enumerate().map(|(i, l)| l.powi(i as i32 - 1)).sum::<f64>());
        agrees!(all; l.iter().rev().zip(&l).map(|(x, y)| x * y * y).sum::<f64>());
        agrees!(all; s.iter().skip(1).zip(&s).map(|(x, y)| x.dot(y)).sum::<f64>());
        agrees!(all; s.iter().take(2).map(|s| s.z).sum::<f64>());
        agrees!(all; l.iter().sum::<f64>() + l.iter().copied().sum::<f64>() + l.iter().cloned().sum::<f64>());
        agrees!(all; (0..3).map(|i| (0..i).map(|j| l[i] * l[j]).sum::<f64>() + a).sum::<f64>());
        agrees!(all; (0..4).map(|i| (0..i).map(|j| s[i] - s[j]).sum::<Vector3<f64>>()).sum::<Vector3<f64>>());
        agrees!(all; (0..2).map(|i| (0..i).map(|j| s[j] * v.transpose()).sum::<nalgebra::Matrix3<f64>>()).sum::<Matrix3<f64>>());
        agrees!(all; (0..3).map(|i| { let b = l[i] * a; b * b + b }).sum::<f64>());
        agrees!(all; (0..4).len() as f64 + (1..=4).rev().map(|i| i as f64).sum::<f64>());
        agrees!(all; (0..2).map(|_| a).sum::<f64>());
        agrees!(all; (1..=3).sum::<usize>());
        agrees!(all; let i = 2; (0..i).map(|i| l[i]).sum::<f64>() + l[i]);
    });
}

/// What is computed of each element is the sum of all, however many there are.
#[test]
fn long_ranges_are_unrolled() {
    let found = symbolic("(0..256).map(|i| a * i as f64).sum::<f64>()", &values(1));
    assert!((found[0] / values(1).a - 255.0 * 128.0).abs() < 1e-9);
}

#[test]
fn constants_of_the_users_own() {
    use std::f64::consts;
    for_values!(all, { a }, {
        agrees!(all; GRAVITY * a);
        agrees!(all; std::f64::consts::PI * a + core::f64::consts::PI * 0.0);
        agrees!(all; consts::PI / TAU);
        agrees!(all; let x = GRAVITY; x - GRAVITY + a);
    });
}

#[test]
fn a_constant_is_one_parameter_however_often_it_is_named() {
    let arena = Arena::new();
    let mut scope = Scope::new();
    scope.define("G", Value::Scalar(arena.symbol("G", Stage::Parameters)));
    scope.define("const", Value::symbols(&arena, "const", Shape::Vector(3), Stage::Parameters));
    let expr = syn::parse_quote!(G + M * self::M + M + self::G + a::b::M + (M - PI) + X);
    let mut diagnostics = Diagnostics::new();
    let value = lower_scalar("the potential", &expr, &mut scope, &arena, &mut diagnostics);
    assert!(value.is_some() && diagnostics.is_empty());
    let names: Vec<&str> = scope.constants.iter().map(|constant| constant.name.as_str()).collect();
    assert_eq!(names, ["const_m", "const_m_self", "const_g", "const_m_b", "const_pi", "const_x_"]);
    for constant in &scope.constants {
        let Node::Symbol(symbol) = arena.node(constant.symbol.id()) else { panic!("a constant is a symbol") };
        assert_eq!(arena.symbol_info(symbol).stage, Stage::Parameters);
        assert!(matches!(constant.tokens, syn::Expr::Path(_)));
    }
}

#[test]
fn constants_are_told_by_their_letters() {
    for (name, is_constant) in
        [("G", true), ("EARTH_MASS", true), ("M_2", true), ("Gamma", false), ("gA", false), ("_G", false)]
    {
        let (arena, mut scope, mut diagnostics) = (Arena::new(), Scope::new(), Diagnostics::new());
        let expr = syn::parse_str(name).unwrap();
        let value = lower_scalar("the potential", &expr, &mut scope, &arena, &mut diagnostics);
        assert_eq!((value.is_some(), diagnostics.is_empty()), (is_constant, is_constant), "{name}");
    }
}

#[test]
fn long_sums_are_no_deep_nesting() {
    let text = vec!["a"; 2000].join(" + ");
    assert_eq!(symbolic(&text, &values(1)), [2000.0 * values(1).a]);
}

#[test]
fn symbols_are_named_after_their_place() {
    let arena = Arena::new();
    let named = |shape| format!("{:?}", Value::symbols(&arena, "s", shape, Stage::Step).scalars());
    assert_eq!(named(Shape::Scalar), "[s]");
    assert_eq!(named(Shape::Vector(3)), "[s_x, s_y, s_z]");
    assert_eq!(named(Shape::Vector(7)), "[s_0, s_1, s_2, s_3, s_4, s_5, s_6]");
    assert_eq!(named(Shape::Matrix(2, 2)), "[s_xx, s_xy, s_yx, s_yy]");
    assert_eq!(named(Shape::Matrix(1, 2)), "[s_xx, s_xy]");
}
