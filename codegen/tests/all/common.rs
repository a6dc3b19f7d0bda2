//! What several tests need: descriptions from texts, and numbers that look random.

use coadjoint_codegen::check;
use coadjoint_codegen::diagnostics::Diagnostics;
use coadjoint_codegen::expr::Arena;
use coadjoint_codegen::model::System;
use coadjoint_codegen::parse::{Attribute, Item};
use proc_macro2::TokenStream;

#[track_caller]
pub(crate) fn tokens(text: &str) -> TokenStream {
    text.parse().unwrap_or_else(|error| panic!("{text}: {error}"))
}

/// The system of a description without problems: what stands in the attribute, and the struct.
#[track_caller]
pub(crate) fn system<'a>(arena: &'a Arena, (attribute, item): (&str, &str)) -> System<'a> {
    let mut diagnostics = Diagnostics::new();
    let attribute =
        Attribute::parse(tokens(attribute), &coadjoint_codegen::method::known(), &mut diagnostics);
    let item = Item::parse(tokens(item), &mut diagnostics).expect("a struct");
    let description = check::resolve(&attribute, &item, &mut diagnostics);
    let system = System::build(arena, &description, &mut diagnostics);
    diagnostics.finish().unwrap_or_else(|error| panic!("{error}"));
    system.expect("a system")
}

/// The problems found, each as the text it underlines and the message.
pub(crate) fn told(diagnostics: Diagnostics) -> Vec<(String, String)> {
    let errors = diagnostics.finish().err().into_iter().flatten();
    errors.map(|error| (error.span().source_text().unwrap_or_default(), error.to_string())).collect()
}

/// Asserts what is underlined and how the messages begin; or all of one, where what is expected ends with `$`.
#[track_caller]
pub(crate) fn compare(text: &str, problems: &[(String, String)], expected: &[(&str, &str)]) {
    assert_eq!(problems.len(), expected.len(), "{text}: {problems:#?}");
    for ((place, message), (expected_place, beginning)) in problems.iter().zip(expected) {
        assert_eq!(place, expected_place, "{text}: {message}");
        match beginning.strip_suffix('$') {
            Some(whole) => assert_eq!(message, whole, "{text}"),
            None => assert!(message.starts_with(beginning), "{text}: {message}"),
        }
    }
}

/// A linear congruential generator: the same numbers on every run.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        self.0
    }

    pub(crate) fn below(&mut self, bound: usize) -> usize {
        ((self.next() >> 33) as usize) % bound
    }

    pub(crate) fn choose<'t>(&mut self, texts: &[&'t str]) -> &'t str {
        texts[self.below(texts.len())]
    }

    /// From 0 to 1.
    pub(crate) fn unit(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1_u64 << 53) as f64
    }
}
