//! Reading the attribute and the struct, and the rules between them.

mod arrays;
mod attributes;
mod energies;
mod groups;
mod names;
mod rules;
mod structs;
mod units;
mod warnings;

use crate::common::{compare, tokens, told};
use coadjoint_codegen::check;
use coadjoint_codegen::diagnostics::Diagnostics;
use coadjoint_codegen::expr::Arena;
use coadjoint_codegen::model::System;
use coadjoint_codegen::parse::{Attribute, Item};

#[track_caller]
fn attribute(text: &str, expected: &[(&str, &str)]) -> Attribute {
    let mut diagnostics = Diagnostics::new();
    let attribute = Attribute::parse(tokens(text), &coadjoint_codegen::method::known(), &mut diagnostics);
    compare(text, &told(diagnostics), expected);
    attribute
}

#[track_caller]
fn item(text: &str, expected: &[(&str, &str)]) -> Option<Item> {
    let mut diagnostics = Diagnostics::new();
    let item = Item::parse(tokens(text), &mut diagnostics);
    compare(text, &told(diagnostics), expected);
    item
}

fn advected(attribute: &Attribute) -> Vec<String> {
    attribute.advected.iter().map(|parameter| format!("{}: {}", parameter.name, parameter.space)).collect()
}

/// Everything that is wrong with a description as a whole.
fn problems(attribute: &Attribute, item: &Item) -> Diagnostics {
    let mut found = Diagnostics::new();
    let description = check::resolve(attribute, item, &mut found);
    let arena = Arena::new();
    let system = System::build(&arena, &description, &mut found);
    assert_eq!(system.is_some(), description.is_sound);
    found
}

/// Asserts the rules that a description breaks.
#[track_caller]
fn breaks(attribute: &str, item: &str, expected: &[(&str, &str)]) {
    let mut diagnostics = Diagnostics::new();
    let attribute =
        Attribute::parse(tokens(attribute), &coadjoint_codegen::method::known(), &mut diagnostics);
    let text = item;
    let item = Item::parse(tokens(item), &mut diagnostics).expect("a struct");
    assert!(diagnostics.is_empty() || text.contains("Broken"), "{text}");
    let found = problems(&attribute, &item);
    compare(text, &told(found), expected);
}

/// What the whole of the macro says.
#[track_caller]
fn expands(attribute: &str, item: &str, expected: &[(&str, &str)]) {
    let error = coadjoint_codegen::expand(tokens(attribute), tokens(item)).err();
    let told = error.into_iter().flatten();
    let told = told.map(|error| (error.span().source_text().unwrap_or_default(), error.to_string()));
    compare(attribute, &told.collect::<Vec<_>>(), expected);
}
