//! Texts that are no descriptions: they are refused, whatever they are.

use std::fs;
use std::path::Path;

use coadjoint_dynamic::Model;

/// How many texts are drawn.
const DRAWN: [usize; 2] = [400, 5_000];

/// How many: with `COADJOINT_CAMPAIGN=1` more, with another number so many. `COADJOINT_SEED` draws others.
fn campaign() -> (usize, u64) {
    let number = |name| std::env::var(name).ok().and_then(|number| number.parse::<u64>().ok());
    let drawn = match number("COADJOINT_CAMPAIGN") {
        None | Some(0) => DRAWN[0],
        Some(1) => DRAWN[1],
        Some(more) => more as usize,
    };
    (drawn, number("COADJOINT_SEED").unwrap_or(0))
}

/// Takes steps with a scheme of a model, as machine code and interpreted: the same to the last bit, whatever they are.
#[cfg(feature = "jit")]
fn moves(model: &Model, random: &mut Random) {
    use super::machine::{Motion, schemes};

    let schemes = schemes(model);
    let scheme = &schemes[random.below(schemes.len())];
    let step = [1e-3, 0.02, 0.5][random.below(3)];
    Motion::some(model, scheme, step).check(model, 40);
}

#[cfg(not(feature = "jit"))]
fn moves(_: &Model, _: &mut Random) {}

#[test]
fn what_is_nested_deeply_is_refused() {
    for depth in [100, 100_000] {
        let [open, close] = ["(", ")"].map(|bracket| bracket.repeat(depth));
        let inside = [
            format!("potential = {open}position.x{close}"),
            format!("potential = {}position.x", "-".repeat(depth)),
            format!("potential = position.x{}", " + position.x".repeat(10 * depth)),
            format!("potential = {open}position.x"),
        ];
        for potential in inside {
            let text =
                format!("#[lie_poisson_system(group = R1, {potential})] struct A {{ #[inertia] m: f64 }}");
            assert!(Model::from_text(&text).is_err(), "{depth}");
        }
        // beside the struct it is no matter, but where it is looked at
        let beside = format!(
            "fn f() {{ {open}{close} }}
             #[lie_poisson_system(group = R1)] struct A {{ #[inertia] m: f64 }}"
        );
        assert!(Model::from_text(&beside).is_ok(), "{depth}");
        for looked_at in [
            format!("const C: f64 = {open}1.0{close};"),
            format!("#[expression] fn f(x: f64) -> f64 {{ {open}x{close} }}"),
            format!("lie_group! {{ G = {open}{close} }}"),
            format!("{}const C: f64 = 1.0;{}", "mod m { ".repeat(depth), "}".repeat(depth)),
        ] {
            let text = format!(
                "{looked_at}
                 #[lie_poisson_system(group = R1, potential = C * position.x)] struct A {{ #[inertia] m: f64 }}"
            );
            assert!(Model::from_text(&text).is_err(), "{depth}");
        }
    }
    // a chain of constants that does not end
    let circle = "const A: f64 = B; const B: f64 = A;
                  #[lie_poisson_system(group = R1, potential = A * position.x)] struct S { #[inertia] m: f64 }";
    assert!(Model::from_text(circle).unwrap_err().to_string().contains("too many"));
}

/// Numbers that look random.
struct Random(u64);

impl Random {
    fn below(&mut self, end: usize) -> usize {
        // xorshift
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % end as u64) as usize
    }
}

/// The catalogue's texts up to the end of the struct: small ones, whose derivation is short.
fn texts() -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../systems/src");
    let names = ["planar_pendulum", "heavy_top", "free_rigid_body", "harmonic_oscillator", "kepler"];
    let text = |name| fs::read_to_string(folder.join(format!("{name}.rs"))).expect("a text");
    let upto = |text: String| text.split("\nimpl").next().unwrap_or_default().to_owned();
    names.map(text).map(upto).to_vec()
}

/// Words that descriptions have, and others.
const WORDS: [&str; 28] = [
    "group",
    "=",
    "(",
    ")",
    "{",
    "}",
    "[",
    "]",
    "SO3",
    "R3",
    "SE(3)",
    "#",
    "::",
    "<",
    ">",
    "f64",
    "Vector3",
    "momentum",
    "'a",
    "\"",
    "1e999",
    "0",
    "-",
    "let",
    "//",
    "/*",
    "ü",
    "matrices { a: [0, 1; 0, 0] }",
];

#[test]
fn texts_that_are_drawn_never_panic() {
    let texts = texts();
    let (drawn, seed) = campaign();
    let mut random = Random(0x9e37_79b9_7f4a_7c15 ^ seed << 20);
    let mut good = 0;
    for _ in 0..drawn {
        let mut text: Vec<char> = texts[random.below(texts.len())].chars().collect();
        for _ in 0..=random.below(3) {
            let at = random.below(text.len());
            let until = (at + random.below(12)).min(text.len());
            match random.below(4) {
                0 => drop(text.drain(at..until)),
                1 => {
                    let word = WORDS[random.below(WORDS.len())];
                    text.splice(at..at, word.chars());
                }
                2 => {
                    let word = WORDS[random.below(WORDS.len())];
                    text.splice(at..until, word.chars());
                }
                _ => {
                    let copy = text[at..until].to_vec();
                    let to = random.below(text.len());
                    text.splice(to..to, copy);
                }
            }
        }
        let text: String = text.into_iter().collect();
        match Model::from_text(&text) {
            Ok(model) => {
                good += 1;
                moves(&model, &mut random);
            }
            // it can be shown
            Err(error) => assert!(!error.to_string().is_empty()),
        }
    }
    assert!(good > drawn / 20 && good < drawn, "{good} of {drawn}");
}
