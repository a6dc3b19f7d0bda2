//! Kinds of processors that code is compiled for besides the one that the program is built for: numbers side by side, and steps taken together.
//! Which of them it runs on is found out when it runs.
//!
//! Their instructions are named one by one. The compiler would find them by itself, but has to look for them in code that is as many times as
//! long as there are lanes, and takes as many times as long.
#![allow(unsafe_code, reason = "instructions of one processor must not be used on another")]

use core::arch::x86_64::*;
use core::mem::transmute_copy;

use crate::kernel::Components;
use crate::lanes::{Portable, Processor};
use crate::scalar::{Batch, FUSED, LongWork, On, Real, Term, Work, combination};

/// The operations of a [`Processor`] on so many doubles in a vector, or in something made of vectors.
macro_rules! operations {
    ($vector:ident of $lanes:literal doubles, fuses: $fuses:expr, fours: $fours:expr; $($name:ident($($operand:ident),*) = $operation:expr;)*) => {
        type Vector = $vector;
        const DOUBLES: usize = $lanes;
        const FUSES: bool = $fuses;
        const FOURS: bool = $fours;

        #[inline(always)]
        fn doubles<X: Real, const N: usize>(numbers: &[X; N]) -> $vector {
            assert!(X::IS_DOUBLE && N == $lanes, "as many doubles as there are in the vector");
            // SAFETY: the same size, and all bits have a meaning in both
            unsafe { transmute_copy(numbers) }
        }

        #[inline(always)]
        fn numbers<X: Real, const N: usize>(doubles: $vector) -> [X; N] {
            assert!(X::IS_DOUBLE && N == $lanes, "as many doubles as there are in the vector");
            // SAFETY: the same size, and all bits have a meaning in both
            unsafe { transmute_copy(&doubles) }
        }

        #[inline(always)]
        fn mask<const N: usize>(truths: &[u64; N]) -> $vector {
            assert!(N == $lanes, "as many truths as there are doubles in the vector");
            // SAFETY: the same size, and all bits have a meaning in both
            unsafe { transmute_copy(truths) }
        }

        #[inline(always)]
        fn truths<const N: usize>(mask: $vector) -> [u64; N] {
            assert!(N == $lanes, "as many truths as there are doubles in the vector");
            // SAFETY: the same size, and all bits have a meaning in both
            unsafe { transmute_copy(&mask) }
        }

        $(#[inline(always)]
        fn $name($($operand: $vector),*) -> $vector {
            // SAFETY: the type is named nowhere but where it was looked whether the processor is of the kind
            unsafe { $operation }
        })*
    };
}

macro_rules! processors {
    ($(
        $(#[$doc:meta])*
        $name:ident in $function:ident for $first:tt $(, $feature:tt)*: $alignment:ident of $bytes:literal bytes { $($operations:tt)* }
    )*) => {
        $(
            $(#[$doc])*
            ///
            /// Only to be named where [`is_here`](Self::is_here), which is why this is not public.
            #[derive(Clone, Copy, Debug, PartialEq, Eq)]
            pub(crate) struct $name;

            impl $name {
                /// Whether the program runs on such a processor.
                pub(crate) fn is_here() -> bool {
                    std::is_x86_feature_detected!($first) $(&& std::is_x86_feature_detected!($feature))*
                }
            }

            /// As wide as a register.
            #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
            #[repr(align($bytes))]
            pub(crate) struct $alignment;

            #[target_feature(enable = $first $(, enable = $feature)*)]
            #[inline(never)]
            fn $function<W: Work>(work: W) -> W::Result {
                work.done()
            }

            impl Processor for $name {
                type Alignment = $alignment;

                #[inline(always)]
                fn outline<W: Work>(work: W) -> W::Result {
                    debug_assert!(Self::is_here());
                    // SAFETY: the type is named nowhere but where it was looked whether the processor is of the kind
                    unsafe { $function(work) }
                }

                operations! { $($operations)* }
            }
        )*
    };
}
processors! {
    /// x86-64 with four doubles in a register, and with products and sums rounded once.
    Avx2 in avx2 for "avx2", "fma": Bytes32 of 32 bytes {
        __m256d of 4 doubles, fuses: true, fours: true;
        plus_once(a, b, c) = _mm256_fmadd_pd(b, c, a);
        add(a, b) = _mm256_add_pd(a, b);
        sub(a, b) = _mm256_sub_pd(a, b);
        mul(a, b) = _mm256_mul_pd(a, b);
        plus(a, b, c) = if FUSED { _mm256_fmadd_pd(b, c, a) } else { _mm256_add_pd(a, _mm256_mul_pd(b, c)) };
        minus(a, b, c) = if FUSED { _mm256_fnmadd_pd(b, c, a) } else { _mm256_sub_pd(a, _mm256_mul_pd(b, c)) };
        div(a, b) = _mm256_div_pd(a, b);
        sqrt(a) = _mm256_sqrt_pd(a);
        neg(a) = _mm256_xor_pd(a, _mm256_set1_pd(-0.0));
        abs(a) = _mm256_andnot_pd(_mm256_set1_pd(-0.0), a);
        at_most(a, b) = _mm256_cmp_pd::<_CMP_LE_OQ>(a, b);
        below(a, b) = _mm256_cmp_pd::<_CMP_LT_OQ>(a, b);
        select(mask, yes, no) = _mm256_blendv_pd(no, yes, mask);
    }

    /// x86-64 with eight doubles in a register.
    Avx512 in avx512 for "avx512f", "avx512dq", "avx512vl": Bytes64 of 64 bytes {
        __m512d of 8 doubles, fuses: true, fours: true;
        plus_once(a, b, c) = _mm512_fmadd_pd(b, c, a);
        add(a, b) = _mm512_add_pd(a, b);
        sub(a, b) = _mm512_sub_pd(a, b);
        mul(a, b) = _mm512_mul_pd(a, b);
        plus(a, b, c) = if FUSED { _mm512_fmadd_pd(b, c, a) } else { _mm512_add_pd(a, _mm512_mul_pd(b, c)) };
        minus(a, b, c) = if FUSED { _mm512_fnmadd_pd(b, c, a) } else { _mm512_sub_pd(a, _mm512_mul_pd(b, c)) };
        div(a, b) = _mm512_div_pd(a, b);
        sqrt(a) = _mm512_sqrt_pd(a);
        neg(a) = _mm512_xor_pd(a, _mm512_set1_pd(-0.0));
        abs(a) = _mm512_andnot_pd(_mm512_set1_pd(-0.0), a);
        at_most(a, b) = _mm512_castsi512_pd(_mm512_movm_epi64(_mm512_cmp_pd_mask::<_CMP_LE_OQ>(a, b)));
        below(a, b) = _mm512_castsi512_pd(_mm512_movm_epi64(_mm512_cmp_pd_mask::<_CMP_LT_OQ>(a, b)));
        select(mask, yes, no) = _mm512_mask_blend_pd(_mm512_movepi64_mask(_mm512_castpd_si512(mask)), no, yes);
    }
}

/// Two registers, as every x86-64 has them.
type Two = [__m128d; 2];

impl Processor for Portable {
    type Alignment = ();

    #[inline(never)]
    fn outline<W: Work>(work: W) -> W::Result {
        work.done()
    }

    operations! {
        Two of 4 doubles, fuses: FUSED, fours: false;
        plus_once(a, b, c) = if FUSED {
            [_mm_fmadd_pd(b[0], c[0], a[0]), _mm_fmadd_pd(b[1], c[1], a[1])]
        } else {
            // not asked for
            a
        };
        add(a, b) = [_mm_add_pd(a[0], b[0]), _mm_add_pd(a[1], b[1])];
        sub(a, b) = [_mm_sub_pd(a[0], b[0]), _mm_sub_pd(a[1], b[1])];
        mul(a, b) = [_mm_mul_pd(a[0], b[0]), _mm_mul_pd(a[1], b[1])];
        plus(a, b, c) = if FUSED {
            [_mm_fmadd_pd(b[0], c[0], a[0]), _mm_fmadd_pd(b[1], c[1], a[1])]
        } else {
            [_mm_add_pd(a[0], _mm_mul_pd(b[0], c[0])), _mm_add_pd(a[1], _mm_mul_pd(b[1], c[1]))]
        };
        minus(a, b, c) = if FUSED {
            [_mm_fnmadd_pd(b[0], c[0], a[0]), _mm_fnmadd_pd(b[1], c[1], a[1])]
        } else {
            [_mm_sub_pd(a[0], _mm_mul_pd(b[0], c[0])), _mm_sub_pd(a[1], _mm_mul_pd(b[1], c[1]))]
        };
        div(a, b) = [_mm_div_pd(a[0], b[0]), _mm_div_pd(a[1], b[1])];
        sqrt(a) = [_mm_sqrt_pd(a[0]), _mm_sqrt_pd(a[1])];
        neg(a) = [_mm_xor_pd(a[0], _mm_set1_pd(-0.0)), _mm_xor_pd(a[1], _mm_set1_pd(-0.0))];
        abs(a) = [_mm_andnot_pd(_mm_set1_pd(-0.0), a[0]), _mm_andnot_pd(_mm_set1_pd(-0.0), a[1])];
        at_most(a, b) = [_mm_cmple_pd(a[0], b[0]), _mm_cmple_pd(a[1], b[1])];
        below(a, b) = [_mm_cmplt_pd(a[0], b[0]), _mm_cmplt_pd(a[1], b[1])];
        select(mask, yes, no) = [
            _mm_or_pd(_mm_and_pd(mask[0], yes[0]), _mm_andnot_pd(mask[0], no[0])),
            _mm_or_pd(_mm_and_pd(mask[1], yes[1]), _mm_andnot_pd(mask[1], no[1])),
        ];
    }
}

/// [`Batch::combined`] of doubles alone: as many components at a time as `P`, for which the caller is compiled, has instructions for.
#[inline(always)]
pub(crate) fn combined<P: Processor, T: Batch, U: Components<T>>(
    a: &[T],
    x: &[Term<T, U>],
    b: &[T],
    y: &[Term<T, U>],
) -> U {
    let mut combined = x[0].components;
    let components = combined.as_mut();
    let mut i = 0;
    if const { P::FOURS } {
        while i + 3 <= components.len() {
            // SAFETY: the processor has this instruction, and the bits are those of four doubles
            let [x, y, z, w]: [f64; 4] =
                unsafe { core::mem::transmute(_mm256_add_pd(fours(a, x, i), fours(b, y, i))) };
            (components[i], components[i + 1], components[i + 2]) = (T::of(x), T::of(y), T::of(z));
            if i + 3 < components.len() {
                components[i + 3] = T::of(w);
            }
            i = components.len().min(i + 4);
        }
    }
    while i + 2 <= components.len() {
        let [x, y] = numbers(add(pairs(a, x, i), pairs(b, y, i)));
        (components[i], components[i + 1]) = (T::of(x), T::of(y));
        i += 2;
    }
    if i < components.len() {
        components[i] = combination(a, x, i) + combination(b, y, i);
    }
    combined
}
/// [`Batch::keep`] of doubles alone.
#[inline(always)]
pub(crate) fn keep<P: Processor, T: Batch, U: Components<T>>(place: &mut Term<T, U>, term: &U) {
    let term = term.as_ref();
    let mut i = 0;
    if const { P::FOURS } {
        while i + 3 <= term.len() {
            let w = if i + 3 < term.len() { term[i + 3] } else { T::of(0.0) };
            let [x, y, z, w] = [term[i], term[i + 1], term[i + 2], w].map(|x| x.lane(0).to_f64());
            // SAFETY: the processor has these instructions; there are so many doubles, as in `fours`
            unsafe { _mm256_storeu_pd(doubles_mut(place, i), _mm256_set_pd(w, z, y, x)) };
            i = term.len().min(i + 4);
        }
    }
    while i + 2 <= term.len() {
        // SAFETY: any x86-64 has this instruction; there are two components from `i` on
        unsafe { _mm_storeu_pd(doubles_mut(place, i), pair(term, i)) };
        i += 2;
    }
    if i < term.len() {
        place.components.as_mut()[i] = term[i];
    }
}

/// The components of a term from `i` on.
#[inline(always)]
fn doubles_mut<T: Batch, U: Components<T>>(term: &mut Term<T, U>, i: usize) -> *mut f64 {
    assert!(
        T::PAIRS
            && size_of::<T::Rest>() == size_of::<f64>()
            && size_of::<U>() == size_of::<f64>() * term.components.as_ref().len()
            && i * size_of::<f64>() <= size_of::<U>()
    );
    // SAFETY: the components are doubles, and these are among them
    unsafe { (&raw mut *term).cast::<f64>().add(i) }
}

/// `Σ_j weights[j] terms[j]`, of four components from `i` on, or three and [the rest](Batch::Rest).
#[inline(always)]
fn fours<T: Batch, U: Components<T>>(weights: &[T], terms: &[Term<T, U>], i: usize) -> __m256d {
    let mut sum: Option<__m256d> = None;
    for (weight, term) in weights.iter().zip(terms) {
        assert!(T::PAIRS && size_of::<U>() == size_of::<f64>() * term.components.as_ref().len());
        assert!(size_of::<T::Rest>() == size_of::<f64>() && (i + 3) * size_of::<f64>() <= size_of::<U>());
        let weight = weight.lane(0).to_f64();
        // SAFETY: The processor has these instructions: the caller is compiled for it. There are at least three doubles from `i` on, after which
        // comes the rest, which is one too.
        sum = Some(unsafe {
            let term = _mm256_loadu_pd((&raw const *term).cast::<f64>().add(i));
            let weight = _mm256_set1_pd(weight);
            match sum {
                None => _mm256_mul_pd(weight, term),
                Some(sum) if T::ONCE => _mm256_fmadd_pd(weight, term, sum),
                Some(sum) => _mm256_add_pd(sum, _mm256_mul_pd(weight, term)),
            }
        });
    }
    // there are weights
    sum.unwrap_or_else(|| unsafe { _mm256_setzero_pd() })
}

/// `Σ_j weights[j] terms[j]`, of the components `i` and `i + 1`.
#[inline(always)]
fn pairs<T: Batch, U: Components<T>>(weights: &[T], terms: &[Term<T, U>], i: usize) -> __m128d {
    let mut sum: Option<__m128d> = None;
    for (weight, term) in weights.iter().zip(terms) {
        let weight = weight.lane(0).to_f64();
        // SAFETY: any x86-64 has these instructions, or, of numbers that round once, the processor that the caller is compiled for
        sum = Some(unsafe {
            let (weight, term) = (_mm_set1_pd(weight), pair(term.components.as_ref(), i));
            match sum {
                None => _mm_mul_pd(weight, term),
                Some(sum) if T::ONCE => _mm_fmadd_pd(weight, term, sum),
                Some(sum) => _mm_add_pd(sum, _mm_mul_pd(weight, term)),
            }
        });
    }
    // there are weights
    sum.unwrap_or_else(|| unsafe { _mm_setzero_pd() })
}

/// Two components.
#[inline(always)]
fn pair<T: Batch>(components: &[T], i: usize) -> __m128d {
    // SAFETY: any x86-64 has this instruction
    unsafe { _mm_set_pd(components[i + 1].lane(0).to_f64(), components[i].lane(0).to_f64()) }
}

#[inline(always)]
fn add(a: __m128d, b: __m128d) -> __m128d {
    // SAFETY: any x86-64 has this instruction
    unsafe { _mm_add_pd(a, b) }
}

#[inline(always)]
fn numbers(pair: __m128d) -> [f64; 2] {
    // SAFETY: any x86-64 has these instructions
    unsafe { [_mm_cvtsd_f64(pair), _mm_cvtsd_f64(_mm_unpackhi_pd(pair, pair))] }
}

/// Does the work in a function of its own, compiled for [`plus_once`](Batch::plus_once) where the processor has an instruction
/// for it.
#[inline]
pub(crate) fn outline_fused<W: Work>(work: W) -> W::Result {
    if Avx2::is_here() { Avx2::outline(work) } else { Portable::outline(work) }
}

/// [`Batch::outline_long`] of numbers alone.
#[inline]
pub(crate) fn outline_long<W: LongWork>(work: W) -> Option<W::Result> {
    if Avx512::is_here() {
        Some(Avx512::outline(On::<Avx512, W>::new(work)))
    } else if Avx2::is_here() {
        Some(Avx2::outline(On::<Avx2, W>::new(work)))
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fused::Once;
    use crate::lanes::Portable;
    use crate::method::{Clock, March, Method, OneStep};
    use crate::scalar::Mask;
    use crate::test_system::Midpoint;
    use std::vec::Vec;

    /// Sums of terms, as the processor makes them of what it has kept, against sums component by component.
    fn combines<P: Processor, T: Batch<Number = f64>, const N: usize>() {
        let number = |k: usize| T::of((1.0 + k as f64).sqrt() - 2.0);
        let term = |j: usize| {
            let mut term = Term::new([T::of(f64::NAN); N]);
            keep::<P, T, [T; N]>(&mut term, &core::array::from_fn(|i| number(7 * j + i)));
            term
        };
        let (x, y) = ([term(0), term(1), term(2), term(3)], [term(4), term(5), term(6)]);
        let (a, b) = ([number(50), number(51), number(52), number(53)], [number(54), number(55), number(56)]);
        let together = combined::<P, T, [T; N]>(&a, &x, &b, &y);
        for (i, together) in together.into_iter().enumerate() {
            let alone = combination(&a, &x, i) + combination(&b, &y, i);
            assert!(together.is_same(alone).all() && together.is_finite().all(), "{i} of {N}");
        }
    }

    fn combines_all<P: Processor, T: Batch<Number = f64>>() {
        combines::<P, T, 1>();
        combines::<P, T, 2>();
        combines::<P, T, 3>();
        combines::<P, T, 4>();
        combines::<P, T, 5>();
        combines::<P, T, 6>();
        combines::<P, T, 7>();
        combines::<P, T, 8>();
        combines::<P, T, 11>();
    }

    #[test]
    fn terms_are_combined_component_by_component() {
        combines_all::<Portable, f64>();
        if Avx2::is_here() {
            combines_all::<Avx2, f64>();
            combines_all::<Avx2, Once<f64>>();
        }
        if Avx512::is_here() {
            combines_all::<Avx512, f64>();
            combines_all::<Avx512, Once<f64>>();
        }
    }

    /// Where steps compiled for a processor lead to, and what is remembered of them.
    fn walked<P: Processor, T: Batch<Number = f64>>() -> Vec<f64> {
        const STEPS: u64 = 3_000;
        let mut method = OneStep::<T, Midpoint<T>>::new(&[1.0, 2.0, 2.5].map(T::of), T::of(0.01));
        let mut state = [0.4, -0.8, 1.5].map(T::of);
        let (mut taken, mut together) = (0, 0);
        while taken < STEPS {
            if taken > 0 {
                let clock = Clock { start: 0.0, step: 0.01, taken };
                let march = March::new(&mut method, &mut state, clock, &[], STEPS - taken - 1);
                let marched = P::outline(On::<P, _>::new(march));
                taken += marched.steps;
                together += marched.steps;
            }
            let advanced = method.advance(&state, T::of(0.0), &[], taken > 0);
            state = advanced.map_err(|failure| failure.first()).expect("a small step").state;
            taken += 1;
        }
        assert!(together > STEPS * 9 / 10, "nearly all: {together}");
        let mut all: Vec<f64> = state.iter().map(|x| x.lane(0)).collect();
        method.memory(&mut |numbers| all.extend(numbers.iter().map(|x| x.lane(0))));
        all
    }

    #[test]
    fn steps_are_the_same_on_every_processor() {
        let (plain, fused) = (walked::<Portable, f64>(), walked::<Portable, Once<f64>>());
        assert_ne!(plain, fused);
        if Avx2::is_here() {
            assert_eq!(plain, walked::<Avx2, f64>());
            assert_eq!(fused, walked::<Avx2, Once<f64>>());
        }
        if Avx512::is_here() {
            assert_eq!(plain, walked::<Avx512, f64>());
            assert_eq!(fused, walked::<Avx512, Once<f64>>());
        }
    }
}
