//! Mutations of a text as tokens: brackets stay in pairs, so that most of what comes out is still looked into.

use libfuzzer_sys::fuzzer_mutate;
use proc_macro2::{Delimiter, Spacing, TokenStream, TokenTree};

/// What is put in: words of the language, and what has been too much for others.
const PIECES: &[&str] = &[
    "group = SO3",
    "group = SE3",
    "group = SE2",
    "group = SO2",
    "group = SU2",
    "group = R3",
    "group = (a: SO3, b: R3)",
    "group = SO(4)",
    "group = SL(2)",
    "group = GL(2)",
    "group = SP(4)",
    "group = SU(2)",
    "group = SE2(3)",
    "group = SGal(3)",
    "group = SO(2, 1)",
    "group = Heisenberg",
    "group = Aff(1)",
    "group = matrices { h: [1, 0; 0, -1], e: [0, 1; 0, 0], f: [0, 0; 1, 0] }",
    "group = matrices { a: [1, 0; 0, 2], b: [0, 1; 0, 0] }",
    "matrices { a: [0, 1, 0; 0, 0, 0; 0, 0, 0] }",
    "a: [0, 1; -1, 0]",
    "b: [1]",
    "; 1, 0",
    "group = product(a: SO3, b: SO2)",
    "group = product(a: SL(2), b: product(c: R2, d: Heisenberg))",
    "group = semidirect(a: SO3, v: R3, w: dual(R3))",
    "group = semidirect(a: SL(2), v: matrices { h: [1, 0; 0, -1], e: [0, 1; 0, 0], f: [0, 0; 1, 0] })",
    "group = tangent(SO3)",
    "group = tangent(tangent(SO2))",
    "group = [SO3; 3]",
    "group(a: [SO2; 4])",
    "advected(v: adjoint)",
    "advected(v: coadjoint, w: dual(R2))",
    "advected(v: matrices { h: [2], e: [0], f: [0] })",
    "advected(v: a[0]::R3)",
    ".iter()",
    ".map(|x| x)",
    ".windows(2)",
    ".zip(b.iter())",
    ".sum::<f64>()",
    "(0..3)",
    "[0]",
    "-2147483648",
    "2147483647",
    "advected(gamma: R3)",
    "advected(v: R3, p: AffineR3)",
    "potential = 1.0",
    "hamiltonian = 1.0",
    "lagrangian = 1.0",
    "lagrangian = velocity.norm_squared() / 2.0",
    "lagrangian = (1.0 + velocity.norm_squared()).sqrt()",
    "control(u: f64)",
    "control(u: Vector3<f64>)",
    "force = velocity",
    "force(a = velocity)",
    "invariance = left",
    "invariance = right",
    "scalar = f32",
    "methods(Midpoint)",
    "methods(Family(1, 3))",
    "methods(Family(2147483647, 4294967295))",
    "methods(TangentLift)",
    "methods(TangentMidpoint)",
    "derivatives",
    "derivatives(tangent)",
    "retractions(Cayley)",
    "retractions(Exponential)",
    "retractions(SecondKind)",
    "crate = x",
    "#[inertia]",
    "#[inertia(a, b)]",
    "struct",
    "enum",
    "pub",
    "f64",
    "f32",
    "Vector2<f64>",
    "Vector3<f64>",
    "Matrix3<f64>",
    "SVector<f64, 6>",
    "SMatrix<f64, 6, 6>",
    "Vector3",
    "Matrix3",
    "gamma",
    "chi",
    "momentum",
    "velocity",
    "attitude",
    "position",
    "angle",
    "pose",
    "element",
    "inertia",
    "t",
    "time",
    "self",
    "G",
    "std::f64::consts::PI",
    "<f64 as A>::B",
    ".dot(&chi)",
    ".cross(&chi)",
    ".normalize()",
    ".norm()",
    ".norm_squared()",
    ".sin()",
    ".cos()",
    ".sin_cos()",
    ".sqrt()",
    ".angle()",
    ".scaled_axis()",
    ".exp()",
    ".ln()",
    ".recip()",
    ".powi(1024)",
    ".powi(-3)",
    ".powf(0.5)",
    ".powf(x)",
    ".atan2(y)",
    ".hypot(y)",
    ".mul_add(2.0, y)",
    ".transpose()",
    ".tr_mul(&m)",
    ".determinant()",
    ".try_inverse()",
    ".diagonal()",
    ".row(0)",
    ".column(1)",
    ".component_mul(&chi)",
    ".component_div(&chi)",
    ".inverse()",
    ".translation",
    ".vector",
    ".x",
    ".y",
    ".z",
    ".w",
    ".m12",
    ".0",
    "[0]",
    "[(0, 1)]",
    "vector![1.0, 2.0, 3.0]",
    "matrix![1.0, 2.0; 3.0, 4.0]",
    "Vector3::new(1.0, x, y)",
    "Vector3::x()",
    "Matrix3::identity()",
    "Matrix3::from_diagonal(&chi)",
    "f64::sin(x)",
    "f64::from(2)",
    "let a = 3.9 * a * (1.0 - a);",
    "let v = v.cross(&chi).normalize();",
    "let (s, c) = a.sin_cos();",
    "let a = a.sin() * a.cos();",
    "{ let a = x; a }",
    "+ x",
    "- x",
    "* x",
    "/ x",
    "% x",
    "-x",
    "&x",
    "*x",
    "!x",
    "x as f64",
    "if x { y } else { z }",
    "match x { _ => y }",
    "return x",
    "|x| y",
    "x = y",
    "x += y",
    "..",
    "?",
    "=",
    ",",
    ";",
    ":",
    "::",
    "_",
    "'a",
    "\"text\"",
    "#",
    "!",
    "<",
    ">",
    "->",
    "=>",
    "0",
    "1",
    "2",
    "1024",
    "-1",
    "0.0",
    "0.5",
    "1.5",
    "1e308",
    "1e-308",
    "1e999",
    "9007199254740993.0",
    "9223372036854775807",
    "340282366920938463463374607431768211455",
    "1.0e-2147483648",
    "0.1f32",
    "0x1f",
    "1_000.0",
];

/// A linear congruential generator, which libFuzzer seeds.
struct Random(u64);

impl Random {
    fn new(seed: u32) -> Self {
        Self(u64::from(seed).wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % bound.max(1)
    }

    fn piece(&mut self) -> Vec<String> {
        tokens(PIECES[self.below(PIECES.len())]).unwrap_or_default()
    }

    /// Small most of the time, and sometimes not.
    fn times(&mut self) -> usize {
        let bits = self.below(8);
        1 + self.below(1 << bits)
    }
}

/// A text as flat tokens, brackets among them; none if they do not match.
fn tokens(text: &str) -> Option<Vec<String>> {
    let mut flat = Vec::new();
    flatten(text.parse().ok()?, &mut flat);
    Some(flat)
}

fn flatten(stream: TokenStream, flat: &mut Vec<String>) {
    let mut joint = false;
    for token in stream {
        let mut text = match &token {
            TokenTree::Group(group) => {
                let (open, close) = match group.delimiter() {
                    Delimiter::Parenthesis => ("(", ")"),
                    Delimiter::Bracket => ("[", "]"),
                    Delimiter::Brace => ("{", "}"),
                    Delimiter::None => ("", ""),
                };
                flat.push(open.to_owned());
                flatten(group.stream(), flat);
                flat.push(close.to_owned());
                joint = false;
                continue;
            }
            other => other.to_string(),
        };
        if joint && let Some(last) = flat.pop() {
            text = last + &text;
        }
        joint = matches!(&token, TokenTree::Punct(punct) if punct.spacing() == Spacing::Joint);
        flat.push(text);
    }
}

/// How deep each token lies.
fn end_of(flat: &[String], start: usize) -> usize {
    let mut depth = 0usize;
    for (i, token) in flat.iter().enumerate().skip(start) {
        match token.as_str() {
            "(" | "[" | "{" => depth += 1,
            ")" | "]" | "}" => match depth {
                0 => return i,
                _ => depth -= 1,
            },
            _ => {}
        }
        if depth == 0 {
            return i + 1;
        }
    }
    flat.len()
}

/// A run of tokens with its brackets in pairs.
fn run(flat: &[String], random: &mut Random) -> std::ops::Range<usize> {
    let start = random.below(flat.len());
    let mut end = start;
    for _ in 0..random.times().min(12) {
        let next = end_of(flat, end);
        if next == end || next > flat.len() {
            break;
        }
        end = next;
    }
    start..end
}

fn change(flat: &mut Vec<String>, other: &[String], random: &mut Random) {
    let range = run(flat, random);
    let copied: Vec<String> = flat[range.clone()].to_vec();
    match random.below(9) {
        0 => drop(flat.drain(range)),
        1 => {
            let times = random.times();
            let copies: Vec<String> = (0..times).flat_map(|_| copied.clone()).collect();
            drop(flat.splice(range.start..range.start, copies));
        }
        2 => {
            let piece = random.piece();
            drop(flat.splice(range, piece));
        }
        3 => {
            let piece = random.piece();
            drop(flat.splice(range.end..range.end, piece));
        }
        4 => {
            let to = random.below(flat.len() + 1);
            drop(flat.splice(to..to, copied));
        }
        5 => {
            let target = run(flat, random);
            drop(flat.splice(target, copied));
        }
        6 => {
            let from = run(other, random);
            let taken = other[from].to_vec();
            drop(flat.splice(range, taken));
        }
        7 => {
            let (open, close) = [("(", ")"), ("[", "]"), ("{", "}")][random.below(3)];
            let times = if random.below(8) == 0 { random.times() } else { 1 };
            drop(flat.splice(range.end..range.end, vec![close.to_owned(); times]));
            drop(flat.splice(range.start..range.start, vec![open.to_owned(); times]));
        }
        _ => {
            let piece = random.piece();
            let times = random.times();
            let copies: Vec<String> = (0..times).flat_map(|_| piece.clone()).collect();
            drop(flat.splice(range.end..range.end, copies));
        }
    }
}

fn write(flat: &[String], out: &mut [u8], limit: usize) -> Option<usize> {
    let text = flat.join(" ");
    let fits = text.len() <= limit.min(out.len());
    fits.then(|| {
        out[..text.len()].copy_from_slice(text.as_bytes());
        text.len()
    })
}

/// Replaces the text in `data` by a mutated one, and returns its length.
pub fn mutate(data: &mut [u8], size: usize, limit: usize, seed: u32) -> usize {
    let mut random = Random::new(seed);
    let text = std::str::from_utf8(&data[..size]).ok().and_then(tokens);
    match text {
        Some(mut flat) if !flat.is_empty() && random.below(16) > 0 => {
            let before = flat.clone();
            for _ in 0..random.times().min(6) {
                change(&mut flat, &before, &mut random);
                if flat.is_empty() {
                    break;
                }
            }
            write(&flat, data, limit).unwrap_or_else(|| fuzzer_mutate(data, size, limit))
        }
        _ => fuzzer_mutate(data, size, limit),
    }
}

/// Puts parts of the second text into the first, and returns the length of what comes out.
pub fn cross(first: &[u8], second: &[u8], out: &mut [u8], seed: u32) -> usize {
    let mut random = Random::new(seed);
    let read =
        |data| std::str::from_utf8(data).ok().and_then(tokens).filter(|flat: &Vec<String>| !flat.is_empty());
    let (Some(mut flat), Some(other)) = (read(first), read(second)) else { return 0 };
    for _ in 0..random.times().min(4) {
        if flat.is_empty() {
            break;
        }
        let (to, from) = (run(&flat, &mut random), run(&other, &mut random));
        drop(flat.splice(to, other[from].to_vec()));
    }
    let limit = out.len();
    write(&flat, out, limit).unwrap_or(0)
}
