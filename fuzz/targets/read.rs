//! Parsing, checking and lowering: what a description with a mistake gets. Many inputs a second.
#![no_main]

use coadjoint_fuzz::{Description, cross, input, mutate};
use libfuzzer_sys::{Corpus, fuzz_crossover, fuzz_mutator, fuzz_target};
use proc_macro2::TokenStream;

/// A mistake after which everything is still looked at, but nothing is derived.
const MISTAKE: &str = ", mistake";

fuzz_target!(|data: &[u8]| -> Corpus {
    let Some(Description { attribute, item }) = input(data) else { return Corpus::Reject };
    let mistake: TokenStream = MISTAKE.parse().expect("two tokens");
    let attribute = attribute.into_iter().chain(mistake).collect();
    let output = coadjoint_codegen::lie_poisson_system(attribute, item);
    assert!(!output.is_empty(), "the mistake was not reported");
    Corpus::Keep
});

fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    mutate(data, size, max_size, seed)
});

fuzz_crossover!(|first: &[u8], second: &[u8], out: &mut [u8], seed: u32| { cross(first, second, out, seed) });
