//! Kinds of processors that code is compiled for besides the one that the program is built for. Which of them it runs on is found out when it
//! runs.
//!
//! Their instructions are named one by one. The compiler would find them by itself, but has to look for them in code that is as many times as
//! long as there are lanes, and takes as many times as long.
#![allow(unsafe_code, reason = "instructions of one processor must not be used on another")]

use core::arch::x86_64::*;
use core::mem::transmute_copy;

use crate::kernel::Components;
use crate::lanes::{Portable, Processor};
use crate::scalar::{Batch, FUSED, Real, Work, combination};

/// The operations of a [`Processor`] on so many doubles in a vector, or in something made of vectors.
macro_rules! operations {
    ($vector:ident of $lanes:literal doubles, fuses: $fuses:expr; $($name:ident($($operand:ident),*) = $operation:expr;)*) => {
        type Vector = $vector;
        const DOUBLES: usize = $lanes;
        const FUSES: bool = $fuses;

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
        __m256d of 4 doubles, fuses: true;
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
        __m512d of 8 doubles, fuses: true;
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
        Two of 4 doubles, fuses: FUSED;
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

/// [`Batch::combined`] of numbers alone: two components at a time. None if the processor has no instructions for it.
#[inline(always)]
pub(crate) fn combined<T: Batch, U: Components<T>>(a: &[T], x: &[U], b: &[T], y: &[U]) -> Option<U> {
    // if the program was not built for one that has them, it is looked for
    if T::ONCE != FUSED && !std::is_x86_feature_detected!("fma") {
        return None;
    }
    let mut combined = x[0];
    let components = combined.as_mut();
    let mut i = 0;
    while i + 2 <= components.len() {
        let [low, high] = numbers(add(pairs(a, x, i), pairs(b, y, i)));
        (components[i], components[i + 1]) = (T::of(low), T::of(high));
        i += 2;
    }
    if i < components.len() {
        components[i] = combination(a, x, i) + combination(b, y, i);
    }
    Some(combined)
}

/// [`Batch::keep`] of numbers alone.
#[inline(always)]
pub(crate) fn keep<T: Batch, U: Components<T>>(place: &mut U, term: &U) {
    assert!(T::PAIRS, "a double");
    let (place, term) = (place.as_mut(), term.as_ref());
    let mut i = 0;
    while i + 2 <= place.len() {
        // SAFETY: two numbers from `i` on, as just compared, that are doubles
        unsafe { _mm_storeu_pd(place.as_mut_ptr().add(i).cast(), pair(term, i)) };
        i += 2;
    }
    if i < place.len() {
        place[i] = term[i];
    }
}

/// `Σ_j weights[j] terms[j]`, of the components `i` and `i + 1`.
#[inline(always)]
fn pairs<T: Batch, U: Components<T>>(weights: &[T], terms: &[U], i: usize) -> __m128d {
    let mut sum: Option<__m128d> = None;
    for (weight, term) in weights.iter().zip(terms) {
        let weight = weight.lane(0).to_f64();
        // SAFETY: the processor has these instructions: the caller has looked
        sum = Some(unsafe {
            let (weight, term) = (_mm_set1_pd(weight), pair(term.as_ref(), i));
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
