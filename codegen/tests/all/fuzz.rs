//! No input brings the front end down: token soup, half-sensible expressions, absurd nesting.

use coadjoint_codegen::check;
use coadjoint_codegen::diagnostics::Diagnostics;
use coadjoint_codegen::expr::{Arena, Stage};
use coadjoint_codegen::language::{Scope, Value, lower, lower_scalar};
use coadjoint_codegen::model::System;
use coadjoint_codegen::parse::{Attribute, EnergyKey, Item, without_helpers};
use coadjoint_codegen::quantity::Shape;
use proc_macro2::TokenStream;

use crate::common::Random;

/// Pieces of input; those that matter to the language appear most.
const PIECES: [&str; 128] = [
    "group",
    "hamiltonian",
    "control",
    "force",
    "invariance",
    "methods",
    "left",
    "right",
    "attitude",
    "position",
    "angle",
    "momentum",
    "velocity",
    "inverse",
    "translation",
    "SO2",
    "SE2",
    "SE3",
    "SU2",
    "R7",
    "Midpoint",
    "Family",
    "TangentLift",
    "advected",
    "potential",
    "crate",
    "SO3",
    "R3",
    "gamma",
    "chi",
    "a",
    "m",
    "x",
    "y",
    "let",
    "if",
    "else",
    "match",
    "return",
    "for",
    "in",
    "unsafe",
    "self",
    "struct",
    "enum",
    "pub",
    "fn",
    "inertia",
    "f64",
    "f32",
    "Vector3",
    "Matrix3",
    "SVector",
    "PI",
    "G",
    "dot",
    "cross",
    "norm",
    "powi",
    "powf",
    "sin",
    "sin_cos",
    "sqrt",
    "new",
    "zeros",
    "identity",
    "row",
    "column",
    "transpose",
    "determinant",
    "vector",
    "matrix",
    "as",
    "mut",
    "ref",
    "_",
    "spins: [SO3; 2]",
    "spins[0]",
    "spins_momentum",
    "[f64; 3]",
    "[R3; 2]",
    "map(|i|",
    ".iter()",
    ".sum::<f64>()",
    "windows(2)",
    "(0..2)",
    "=",
    "=",
    "=",
    ",",
    ",",
    ",",
    ";",
    ";",
    ":",
    "::",
    ".",
    ".",
    ".",
    "+",
    "-",
    "*",
    "/",
    "%",
    "&",
    "!",
    "<",
    ">",
    "|",
    "?",
    "#",
    "@",
    "..",
    "->",
    "=>",
    "0",
    "1",
    "2",
    "-1",
    "0.0",
    "1.5",
    "1e999",
    "1e-400",
    "9223372036854775807",
    "1.0e-2147483648",
    "0.1f32",
    "\"text\"",
    "'a",
];

impl Random {
    /// Tokens without sense, with balanced brackets.
    fn soup(&mut self, length: usize) -> String {
        let mut text = String::new();
        let mut left = length;
        while left > 0 {
            if self.below(5) == 0 {
                let inner = self.below(left);
                left -= inner;
                let (open, close) = [("(", ")"), ("[", "]"), ("{", "}")][self.below(3)];
                text += &format!("{open}{}{close} ", self.soup(inner));
            } else {
                text += self.choose(&PIECES);
                text += " ";
            }
            left -= 1;
        }
        text
    }

    /// An expression that parses, of parts that may or may not fit together.
    fn expression(&mut self, depth: usize) -> String {
        let leaves = [
            "a",
            "a",
            "gamma",
            "chi",
            "m",
            "p",
            "PI",
            "0.0",
            "1.0",
            "2.5",
            "1e300",
            "2",
            "-1",
            "nothing",
            "broken",
            "spins",
            "spins[1]",
            "spins.iter()",
            "(0..2)",
            "i",
            "Vector3::x()",
            "Matrix3::identity()",
            "i64::MAX",
            "9223372036854775807",
        ];
        if depth == 0 {
            return self.choose(&leaves).to_owned();
        }
        let e = |random: &mut Self| random.expression(depth - 1);
        match self.below(19) {
            0..4 => {
                format!("({} {} {})", e(self), self.choose(&["+", "-", "*", "/", "%", "<", "^"]), e(self))
            }
            4 => format!("(-{})", e(self)),
            5 => {
                let unary = [
                    "sqrt",
                    "sin",
                    "ln",
                    "norm",
                    "normalize",
                    "transpose",
                    "trace",
                    "determinant",
                    "recip",
                    "try_inverse().unwrap",
                ];
                format!("{}.{}()", e(self), self.choose(&unary))
            }
            6 => {
                let binary =
                    ["dot", "cross", "powi", "powf", "atan2", "component_div", "tr_mul", "row", "unscale"];
                format!("{}.{}({})", e(self), self.choose(&binary), e(self))
            }
            7 => format!("{}.{}", e(self), self.choose(&["x", "z", "w", "m12", "0", "1", "q"])),
            8 => format!("{}[{}]", e(self), e(self)),
            9 if self.below(2) == 0 => format!("{}.fixed_view::<2, 1>({}, {})", e(self), e(self), e(self)),
            9 => format!("{}[({}, {})]", e(self), e(self), e(self)),
            10 => format!("{{ let b = {}; {} }}", e(self), e(self)),
            11 => format!("{{ let (b, c) = {}.sin_cos(); {} }}", e(self), e(self)),
            12 => format!("Vector3::new({}, {}, {})", e(self), e(self), e(self)),
            13 => format!("vector![{}, {}]", e(self), e(self)),
            15 => format!("{}.map(|{}| {})", e(self), self.choose(&["i", "a", "(a, i)", "_"]), e(self)),
            16 => {
                let method = [
                    "sum::<f64>()",
                    "sum::<Vector3<f64>>()",
                    "iter()",
                    "windows(2)",
                    "enumerate()",
                    "rev()",
                    "len()",
                ];
                format!("{}.{}", e(self), self.choose(&method))
            }
            17 => format!("{}.{}({})", e(self), self.choose(&["zip", "skip", "take", "windows"]), e(self)),
            18 if self.below(2) == 0 => format!("({}..{})", e(self), e(self)),
            18 => format!("[{}, {}]", e(self), e(self)),
            14 if self.below(2) == 0 => format!("(Point3::from({}) - Point3::origin())", e(self)),
            14 => format!("matrix![{}, {}; {}, {}]", e(self), e(self), e(self), e(self)),
            _ => format!("f64::{}({})", self.choose(&["from", "sin", "powi", "abs"]), e(self)),
        }
    }
}

/// Runs the whole front end.
fn read(attribute: TokenStream, item: TokenStream) {
    let mut diagnostics = Diagnostics::new();
    let attribute = Attribute::parse(attribute, &coadjoint_codegen::method::known(), &mut diagnostics);
    without_helpers(item.clone());
    if let Some(item) = Item::parse(item, &mut diagnostics) {
        let description = check::resolve(&attribute, &item, &mut diagnostics);
        System::build(&Arena::new(), &description, &mut diagnostics);
    }
    if let Some(potential) = attribute.energy(EnergyKey::Potential) {
        let (arena, mut scope) = (Arena::new(), Scope::new());
        define(&mut scope, &arena);
        lower_scalar("the potential", potential, &mut scope, &arena, &mut diagnostics);
    }
    diagnostics.into_tokens();
}

fn define<'a>(scope: &mut Scope<'a>, arena: &'a Arena) {
    let shapes = [
        ("a", Shape::Scalar),
        ("gamma", Shape::Vector(3)),
        ("chi", Shape::Vector(3)),
        ("p", Shape::Vector(2)),
        ("m", Shape::Matrix(3, 3)),
    ];
    for (name, shape) in shapes {
        scope.define(name, Value::symbols(arena, name, shape, Stage::Step));
    }
    for k in 0..3 {
        scope.define_element(
            "spins",
            Value::symbols(arena, &format!("spins_{k}"), Shape::Vector(3), Stage::Step),
        );
    }
    scope.define_unknown("broken");
}

fn parsed(text: &str) -> Option<TokenStream> {
    text.parse().ok()
}

#[test]
fn token_soup() {
    let mut random = Random(1);
    for _ in 0..5_000 {
        let length = 1 + random.below(30);
        let (attribute, item) = (random.soup(length), random.soup(length));
        if let (Some(attribute), Some(item)) = (parsed(&attribute), parsed(&item)) {
            read(attribute, item);
        }
    }
}

#[test]
fn soup_with_a_key_in_front() {
    let mut random = Random(2);
    for _ in 0..5_000 {
        let key = random.choose(&[
            "group",
            "potential",
            "advected",
            "crate",
            "hamiltonian",
            "control",
            "force",
            "invariance",
            "methods",
        ]);
        let separator = random.choose(&["=", "", "=="]);
        let length = 1 + random.below(12);
        let attribute =
            format!("{key} {separator} {}, potential = {}", random.soup(length), random.soup(length));
        let item = format!("struct A {{ #[inertia] a: {}, b: {} }}", random.soup(3), random.soup(2));
        if let (Some(attribute), Some(item)) = (parsed(&attribute), parsed(&item)) {
            read(attribute, item);
        }
    }
}

#[test]
fn random_expressions() {
    let mut random = Random(3);
    let (mut sound, mut tried) = (0, 0);
    for _ in 0..5_000 {
        let depth = random.below(5);
        let text = random.expression(depth);
        let expr = syn::parse_str::<syn::Expr>(&text).unwrap_or_else(|error| panic!("{text}: {error}"));
        let (arena, mut scope, mut diagnostics) = (Arena::new(), Scope::new(), Diagnostics::new());
        define(&mut scope, &arena);
        let value = lower(&expr, &mut scope, &arena, &mut diagnostics);
        // a value or a problem, unless the problem was reported elsewhere
        assert!(value.is_some() == diagnostics.is_empty() || text.contains("broken"), "{text}");
        sound += usize::from(value.is_some());
        tried += 1;
        for scalar in value.iter().flat_map(Value::scalars) {
            for symbol in scope.get("chi").into_iter().flatten().flat_map(Value::scalars) {
                symbol.as_symbol().map(|symbol| scalar.derivative(symbol));
            }
        }
    }
    assert!(sound * 10 > tried, "most of the language was out of reach: {sound} of {tried}");
}

/// What may be repeated around or before an expression, and how it ends.
const NESTINGS: [(&str, &str, &str); 18] = [
    ("(", "a", ")"),
    ("{", "a", "}"),
    ("vector![", "a", "]"),
    ("-", "a", ""),
    ("- (", "a", ")"),
    ("&", "a", ""),
    ("*", "a", ""),
    ("!", "a", ""),
    ("&mut ", "a", ""),
    ("return ", "a", ""),
    ("|x| ", "a", ""),
    ("move || ", "a", ""),
    ("a = ", "a", ""),
    ("if a {} else ", "{ a }", ""),
    ("", "a", ".sin()"),
    ("", "a", " + a"),
    ("", "a", "[0]"),
    ("a..", "a", ""),
];

#[test]
fn absurd_nesting() {
    for count in [10, 30, 40, 120, 140, 3_000, 30_000] {
        for (before, inner, after) in NESTINGS {
            let text = format!("potential = {}{inner}{}", before.repeat(count), after.repeat(count));
            if let Some(attribute) = parsed(&text) {
                read(attribute, TokenStream::new());
            }
        }
        for (before, inner, after) in
            [("&", "f64", ""), ("(", "f64", ")"), ("Vec<", "f64", ">"), ("fn() -> ", "f64", "")]
        {
            let text = format!(
                "struct A {{ #[inertia] a: {}{inner}{} }}",
                before.repeat(count),
                after.repeat(count)
            );
            if let Some(item) = parsed(&text) {
                read(TokenStream::new(), item);
            }
        }
    }
}
