//! How fast ensembles could be at most: `cargo bench --features bench --bench ceiling`.
//!
//! Prints what a member's step takes beside what its multiplications and additions alone take, all independent of one another and in registers,
//! with no load, store, division, root or comparison, and how many times as fast as the scalar step, one of many taken together, each is. All in
//! one run.
// a benchmark that cannot be made is to say so; instructions for registers of a width are asked for by their names
#![allow(clippy::unwrap_used, unsafe_code)]
#![cfg_attr(not(target_arch = "x86_64"), allow(dead_code, unused_imports))]

use std::time::Instant;

use coadjoint_systems::cases;

/// How often what is timed takes turns.
const ROUNDS: usize = 40;

/// Multiplications and additions of a step of order 2 with all attitudes, as the compiler emits them for several members side by side: those of
/// the kernel's `evaluate` (without the residual, which no update needs), `fixed_point_update` and `finish`, the change of the update, what is extrapolated,
/// and whether all is finite.
const STEPS: [(&str, &str, u64, u64); 4] = [
    ("free_rigid_body", "Cayley", 73, 80),
    ("free_rigid_body", "exponential", 106, 102),
    ("heavy_top", "Cayley", 112, 116),
    ("heavy_top", "exponential", 182, 163),
];

/// What many operations took: pairs of a multiplication and an addition, multiplications alone, additions alone.
type Timed = [f64; 3];

/// Does so many of each.
type Run = fn(u64, u64, u64);

/// Seconds for a multiplication with an addition, for one alone, and for the other, the best of many.
fn best(timed: &mut Timed, run: Run) {
    const MANY: u64 = 400_000;
    for (best, [both, products, sums]) in timed.iter_mut().zip([[MANY, 0, 0], [0, MANY, 0], [0, 0, MANY]]) {
        let start = Instant::now();
        run(both, products, sums);
        *best = best.min(start.elapsed().as_secs_f64() / MANY as f64);
    }
}

#[cfg(target_arch = "x86_64")]
mod registers {
    use std::arch::x86_64::{__m256d, __m512d};
    use std::arch::x86_64::{_mm256_add_pd, _mm256_mul_pd, _mm256_set1_pd};
    use std::arch::x86_64::{_mm512_add_pd, _mm512_mul_pd, _mm512_set1_pd};
    use std::hint::black_box;

    macro_rules! run {
        ($name:ident, $feature:literal, $vector:ty, $mul:ident, $add:ident, $splat:ident, $chains:literal) => {
            /// So many operations, of which these many do not wait for one another: more than are under way at once, and no more than there
            /// are registers for.
            #[target_feature(enable = $feature)]
            pub(super) fn $name(both: u64, products: u64, sums: u64) {
                let (factor, addend) = (black_box($splat(0.999_999)), black_box($splat(0.5)));
                let mut p: [$vector; $chains] = [black_box($splat(1.0)); $chains];
                let mut s = p;
                for _ in 0..both / $chains {
                    for k in 0..$chains {
                        (p[k], s[k]) = ($mul(p[k], factor), $add(s[k], addend));
                    }
                }
                for _ in 0..products / $chains {
                    for p in &mut p {
                        *p = $mul(*p, factor);
                    }
                }
                for _ in 0..sums / $chains {
                    for s in &mut s {
                        *s = $add(*s, addend);
                    }
                }
                black_box((p, s));
            }
        };
    }
    run!(fours, "avx2", __m256d, _mm256_mul_pd, _mm256_add_pd, _mm256_set1_pd, 7);
    run!(eights, "avx512f", __m512d, _mm512_mul_pd, _mm512_add_pd, _mm512_set1_pd, 14);
}

#[cfg(not(target_arch = "x86_64"))]
fn main() {
    println!("for x86-64 alone");
}

#[cfg(target_arch = "x86_64")]
fn main() {
    let mut cases = cases::all().unwrap();
    let mut widths: Vec<(&str, f64, Run, Timed)> = Vec::new();
    if std::is_x86_feature_detected!("avx2") {
        // SAFETY: it was just looked for
        widths.push(("avx2", 4.0, |a, b, c| unsafe { registers::fours(a, b, c) }, [f64::INFINITY; 3]));
    }
    if std::is_x86_feature_detected!("avx512f") {
        // SAFETY: it was just looked for
        widths.push(("avx512", 8.0, |a, b, c| unsafe { registers::eights(a, b, c) }, [f64::INFINITY; 3]));
    }
    let names: Vec<String> = widths.iter().map(|(name, ..)| format!(", ensemble, {name}")).collect();
    // the scalar step and its ensembles, for each of the steps
    cases.retain(|case| {
        STEPS.iter().any(|(problem, method, ..)| {
            let is_one = |end: &str| case.method == format!("{method}{end}");
            case.problem == *problem && (is_one("") || names.iter().any(|name| is_one(name)))
        })
    });
    let mut times = vec![f64::INFINITY; cases.len()];
    for _ in 0..ROUNDS {
        for (case, time) in cases.iter_mut().zip(&mut times) {
            let start = Instant::now();
            assert!(case.run(case.steps), "a step failed");
            *time = time.min(start.elapsed().as_secs_f64() / case.steps as f64);
        }
        for (_, _, run, timed) in &mut widths {
            best(timed, *run);
        }
    }
    let time = |problem: &str, method: &str| {
        let of = cases.iter().position(|case| case.problem == problem && case.method == method);
        times[of.unwrap()] * 1e9
    };
    println!("ns for a step, and how many times as fast as the scalar step");
    for (problem, method, products, sums) in STEPS {
        let scalar = time(problem, method);
        println!("{problem}, {method}: {scalar:.1}");
        for ((name, lanes, _, [both, product, sum]), end) in widths.iter().zip(&names) {
            let ensemble = time(problem, &format!("{method}{end}"));
            let pairs = products.min(sums);
            let alone =
                both * pairs as f64 + product * (products - pairs) as f64 + sum * (sums - pairs) as f64;
            let ceiling = alone * 1e9 / lanes;
            println!(
                "  {name:8} a member {ensemble:5.2}, {:4.2} times; {products} products and {sums} sums alone {ceiling:5.2}, {:4.2} times",
                scalar / ensemble,
                scalar / ceiling
            );
        }
    }
}
