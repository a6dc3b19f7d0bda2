//! The whole of the macro.
#![no_main]

use coadjoint_fuzz::{Description, cross, input, mutate};
use libfuzzer_sys::{Corpus, fuzz_crossover, fuzz_mutator, fuzz_target};

fuzz_target!(|data: &[u8]| -> Corpus {
    let Some(Description { attribute, item }) = input(data) else { return Corpus::Reject };
    coadjoint_codegen::lie_poisson_system(attribute, item);
    Corpus::Keep
});

fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    mutate(data, size, max_size, seed)
});

fuzz_crossover!(|first: &[u8], second: &[u8], out: &mut [u8], seed: u32| { cross(first, second, out, seed) });
