//! Special functions, and numbers that carry bounds of their errors: what straight-line code calls.

use super::code::{Special, Spelling};
use super::template::Words;
use crate::program::stumpff;
use crate::quantity::ScalarType;

const SPECIAL: &str = include_str!("text/special.c");
const BOUNDED: &str = include_str!("text/bounded.c");

/// The root of the least normal number.
const NEGLIGIBLE: [f64; 2] = [f64::from_bits((1023 - 511) << 52), f64::from_bits((1023 - 63) << 52)];

/// Functions of numbers that carry bounds, by their derivatives at `x.value`, where they are `value`.
const DERIVATIVES: &[(&str, &str, &str)] = &[
    ("exp", "exp", "value"),
    ("ln", "log", "ONE / S_certain(x)"),
    ("sin", "sin", "COS(x.value)"),
    ("cos", "cos", "SIN(x.value)"),
    ("tan", "tan", "ONE + value * value"),
    ("asin", "asin", "ONE / SQRT(ONE - x.value * x.value)"),
    ("acos", "acos", "ONE / SQRT(ONE - x.value * x.value)"),
    ("atan", "atan", "ONE / (ONE + x.value * x.value)"),
    ("sinh", "sinh", "COSH(x.value)"),
    ("cosh", "cosh", "SINH(x.value)"),
    ("tanh", "tanh", "ONE - value * value"),
];

/// All that some code calls, on numbers and on bounded ones.
pub(super) fn special(spelling: &Spelling<'_>, special: &Special, is_bounded: bool, words: &Words) -> String {
    let has = |name: &str| special.functions.contains(name);
    let words = words
        .clone()
        .with("NEGLIGIBLE", spelling.number(NEGLIGIBLE[usize::from(spelling.scalar == ScalarType::F32)]))
        .with("STUMPFF_ERROR", spelling.number(4.2))
        .holds("choose", has("choose"))
        .holds("recip_or_zero", has("recip_or_zero"))
        .holds("sqrt", has("sqrt"))
        .holds("powf", has("powf"))
        .holds("atan2", has("atan2"))
        .holds("functions", has("powf") || DERIVATIVES.iter().any(|(name, ..)| has(name)))
        .each("angle", special.angles.iter().map(|order| angle(spelling, *order)).collect())
        .each("family", special.families.iter().map(|members| family(spelling, *members)).collect());
    let functions = DERIVATIVES.iter().filter(|(name, ..)| has(name)).map(|(name, called, derivative)| {
        let derivative = words.fill(derivative).trim_end().to_owned();
        Words::default()
            .with("FUNCTION", *name)
            .with("CALLED", spelling.math(called))
            .with("DERIVATIVE", derivative)
    });
    let words = words.clone().each("function", functions.collect());
    words.fill(SPECIAL) + &if is_bounded { words.fill(BOUNDED) } else { String::new() }
}

fn angle(spelling: &Spelling<'_>, order: u32) -> Words {
    let first = (1..=order).map(f64::from).fold(1.0, |first, j| -first * j * j / (2.0 * j + 1.0));
    Words::default()
        .with("ORDER", order.to_string())
        .with("AFTER", spelling.number(f64::from(order + 1)))
        .with("MANY", (28 + 2 * order).to_string())
        .with("FEW", (12 + 2 * order).to_string())
        .with("SIXTYFOURTH", spelling.number(1.0 / 64.0))
        .with("FIRST", spelling.number(first))
}

fn family(spelling: &Spelling<'_>, members: usize) -> Words {
    let number = |x: f64| spelling.number(x);
    let inverse = |m: usize| number(stumpff::inverse_factorial(m));
    let [even, odd] = stumpff::highest(members);
    let quartet = |k: usize| {
        let [first, second, third, fourth] = [k, k + 2, k + 4, k + 6].map(inverse);
        format!("(({first} - z * {second}) + z2 * ({third} - z * {fourth}))")
    };
    let mut downward = match members {
        1 => vec!["f.c[0] = odd;".to_owned(), "(void)even;".to_owned()],
        _ => vec![format!("f.c[{}] = even;", members - 2), format!("f.c[{}] = odd;", members - 1)],
    };
    downward.extend(
        (0..members.saturating_sub(2))
            .rev()
            .map(|k| format!("f.c[{k}] = {} - z * f.c[{}];", inverse(k), k + 2)),
    );
    let upward = (3..members).map(|k| {
        Words::default()
            .with("MEMBER", k.to_string())
            .with("LESS", (k - 2).to_string())
            .with("INVERSE", inverse(k - 2))
    });
    let inverses: Vec<String> = (0..members).map(inverse).collect();
    Words::default()
        .with("MEMBERS", members.to_string())
        .with("BRIEF", number(stumpff::brief(members)))
        .with("SHORT", number(stumpff::SHORT))
        .with("LONG", number(stumpff::LONG))
        .with("EVEN_1", quartet(even))
        .with("ODD_1", quartet(odd))
        .with("EVEN_2", quartet(even + 8))
        .with("ODD_2", quartet(odd + 8))
        .with("EVEN_3", quartet(even + 16))
        .with("ODD_3", quartet(odd + 16))
        .with("EVEN", even.to_string())
        .with("ODD", odd.to_string())
        .with("EVEN_FACTOR", inverse(even))
        .with("ODD_FACTOR", inverse(odd))
        .with("DOWNWARD", downward.join("\n    "))
        .with("TERMS", stumpff::TERMS.to_string())
        .with("CHANGE_OVER", number(0.9375))
        .with("INVERSES", inverses.join(", "))
        .holds("second", members > 1)
        .holds("third", members > 2)
        .holds("upward", members > 3)
        .each("member", upward.collect())
}
