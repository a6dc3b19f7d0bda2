//! Kinds of processors that code is compiled for besides the one that the program is built for: numbers side by side, and steps taken together.
//! Which of them it runs on is found out when it runs.
//!
//! Their instructions are named one by one. The compiler would find them by itself, but has to look for them in code that is as many times as
//! long as there are lanes, and takes as many times as long.
#![allow(unsafe_code, reason = "instructions of one processor must not be used on another")]

use core::arch::x86_64::*;
use core::mem::transmute;

use crate::scalar::rows::{Formula, Piece, Row};
use crate::scalar::simd::lanes::{Portable, Processor};
use crate::scalar::{Batch, Components, FUSED, LongWork, On, OutOfLine, Real, Work};

/// The operations of a [`Processor`] on so many doubles in a vector, or in several vectors.
///
/// Each is one function between the operator and the instruction: all of them are inlined wherever there is an operation, which takes a third of
/// the time of the compiler if they are many.
macro_rules! operations {
    ($vector:ident of $lanes:literal doubles, fuses: $fuses:expr, fours: $fours:expr;
        numbers { $($name:ident($($operand:ident),*) = $operation:expr;)* }
        truths { $($test:ident($($of:ident),*) = $truth:expr;)* }
        select($mask:ident, $yes:ident, $no:ident) = $chosen:expr;
    ) => {
        const DOUBLES: usize = $lanes;
        const FUSES: bool = $fuses;
        const FOURS: bool = $fours;

        $(#[inline(always)]
        fn $name<X: Real, const N: usize>($($operand: &[X; N]),*) -> [X; N] {
            operations! { of $lanes doubles: [X; N] = $operation, $($operand: [X; N] as $vector),* }
        })*
        $(#[inline(always)]
        fn $test<X: Real, const N: usize>($($of: &[X; N]),*) -> [u64; N] {
            operations! { of $lanes doubles: [u64; N] = $truth, $($of: [X; N] as $vector),* }
        })*
        #[inline(always)]
        fn select<X: Real, const N: usize>($mask: &[u64; N], $yes: &[X; N], $no: &[X; N]) -> [X; N] {
            operations! {
                of $lanes doubles: [X; N] = $chosen, $mask: [u64; N] as $vector, $yes: [X; N] as $vector, $no: [X; N] as $vector
            }
        }
    };
    (of $lanes:literal doubles: $result:ty = $operation:expr, $($operand:ident: $array:ty as $vector:ident),*) => {{
        if const { !(X::IS_DOUBLE && N.is_multiple_of($lanes)) } {
            unreachable!("as many doubles as there are in vectors");
        }
        // SAFETY: as many bits, all of which have a meaning in doubles, truths and vectors; and the type of the processor is named nowhere but where
        // it was looked whether it is of the kind
        unsafe {
            $(let $operand = $operand as *const $array as *const Unaligned<$vector>;)*
            if const { N == $lanes } {
                $(let $operand = (*$operand).0;)*
                let result = $operation;
                return *(&raw const result as *const $result);
            }
            let mut result: $result = core::mem::zeroed();
            let vectors = &raw mut result as *mut Unaligned<_>;
            let mut k = 0;
            while k < N / $lanes {
                $(let $operand = (*$operand.add(k)).0;)*
                *vectors.add(k) = Unaligned($operation);
                k += 1;
            }
            result
        }
    }};
}

/// Read from where an array is.
#[derive(Clone, Copy)]
#[repr(C, packed)]
struct Unaligned<V>(V);

macro_rules! processors {
    ($(
        $(#[$doc:meta])*
        $name:ident in $function:ident for $first:tt $(, $feature:tt)*: $alignment:ident of $bytes:literal bytes { $($operations:tt)* }
    )*) => {
        /// As [`OutOfLine`], compiled for kinds of processors.
        trait Wide: Sized + 'static {
            $(
                /// Does the work.
                ///
                /// # Safety
                /// Only where the processor is of the kind.
                #[target_feature(enable = $first $(, enable = $feature)*)]
                #[inline(never)]
                unsafe fn $function<W: Work<CallSite = Self>>(work: W) -> W::Result {
                    work.done()
                }
            )*
        }

        impl<CallSite: 'static> Wide for CallSite {}

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
            #[derive(Clone, Copy, Debug, PartialEq, Eq)]
            #[repr(align($bytes))]
            pub(crate) struct $alignment;

            impl Processor for $name {
                type Alignment = $alignment;
                const ALIGNMENT: $alignment = $alignment;

                #[inline(always)]
                fn dispatch<W: Work>(work: W) -> W::Result {
                    debug_assert!(Self::is_here());
                    // SAFETY: the type is named nowhere but where it was looked whether the processor is of the kind
                    unsafe { <W::CallSite as Wide>::$function(work) }
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
        numbers {
            fma(a, b, c) = _mm256_fmadd_pd(a, b, c);
            add(a, b) = _mm256_add_pd(a, b);
            sub(a, b) = _mm256_sub_pd(a, b);
            mul(a, b) = _mm256_mul_pd(a, b);
            mul_add(a, b, c) = if FUSED { _mm256_fmadd_pd(a, b, c) } else { _mm256_add_pd(c, _mm256_mul_pd(a, b)) };
            neg_mul_add(a, b, c) = if FUSED { _mm256_fnmadd_pd(a, b, c) } else { _mm256_sub_pd(c, _mm256_mul_pd(a, b)) };
            div(a, b) = _mm256_div_pd(a, b);
            sqrt(a) = _mm256_sqrt_pd(a);
            neg(a) = _mm256_xor_pd(a, _mm256_set1_pd(-0.0));
            abs(a) = _mm256_andnot_pd(_mm256_set1_pd(-0.0), a);
        }
        truths {
            le(a, b) = _mm256_cmp_pd::<_CMP_LE_OQ>(a, b);
            lt(a, b) = _mm256_cmp_pd::<_CMP_LT_OQ>(a, b);
        }
        select(mask, yes, no) = _mm256_blendv_pd(no, yes, mask);
    }

    /// x86-64 with eight doubles in a register.
    Avx512 in avx512 for "avx512f", "avx512dq", "avx512vl": Bytes64 of 64 bytes {
        __m512d of 8 doubles, fuses: true, fours: true;
        numbers {
            fma(a, b, c) = _mm512_fmadd_pd(a, b, c);
            add(a, b) = _mm512_add_pd(a, b);
            sub(a, b) = _mm512_sub_pd(a, b);
            mul(a, b) = _mm512_mul_pd(a, b);
            mul_add(a, b, c) = if FUSED { _mm512_fmadd_pd(a, b, c) } else { _mm512_add_pd(c, _mm512_mul_pd(a, b)) };
            neg_mul_add(a, b, c) = if FUSED { _mm512_fnmadd_pd(a, b, c) } else { _mm512_sub_pd(c, _mm512_mul_pd(a, b)) };
            div(a, b) = _mm512_div_pd(a, b);
            sqrt(a) = _mm512_sqrt_pd(a);
            neg(a) = _mm512_xor_pd(a, _mm512_set1_pd(-0.0));
            abs(a) = _mm512_andnot_pd(_mm512_set1_pd(-0.0), a);
        }
        truths {
            le(a, b) = _mm512_castsi512_pd(_mm512_movm_epi64(_mm512_cmp_pd_mask::<_CMP_LE_OQ>(a, b)));
            lt(a, b) = _mm512_castsi512_pd(_mm512_movm_epi64(_mm512_cmp_pd_mask::<_CMP_LT_OQ>(a, b)));
        }
        select(mask, yes, no) = _mm512_mask_blend_pd(_mm512_movepi64_mask(_mm512_castpd_si512(mask)), no, yes);
    }
}

impl Processor for Portable {
    type Alignment = ();
    const ALIGNMENT: () = ();

    #[inline(always)]
    fn dispatch<W: Work>(work: W) -> W::Result {
        W::CallSite::portable(work)
    }

    operations! {
        __m128d of 2 doubles, fuses: FUSED, fours: false;
        numbers {
            fma(a, b, c) = if FUSED {
                _mm_fmadd_pd(a, b, c)
            } else {
                // not asked for
                a
            };
            add(a, b) = _mm_add_pd(a, b);
            sub(a, b) = _mm_sub_pd(a, b);
            mul(a, b) = _mm_mul_pd(a, b);
            mul_add(a, b, c) = if FUSED { _mm_fmadd_pd(a, b, c) } else { _mm_add_pd(c, _mm_mul_pd(a, b)) };
            neg_mul_add(a, b, c) = if FUSED { _mm_fnmadd_pd(a, b, c) } else { _mm_sub_pd(c, _mm_mul_pd(a, b)) };
            div(a, b) = _mm_div_pd(a, b);
            sqrt(a) = _mm_sqrt_pd(a);
            neg(a) = _mm_xor_pd(a, _mm_set1_pd(-0.0));
            abs(a) = _mm_andnot_pd(_mm_set1_pd(-0.0), a);
        }
        truths {
            le(a, b) = _mm_cmple_pd(a, b);
            lt(a, b) = _mm_cmplt_pd(a, b);
        }
        select(mask, yes, no) = _mm_or_pd(_mm_and_pd(mask, yes), _mm_andnot_pd(mask, no));
    }
}

/// Of a [`Formula`] of doubles alone as many components at a time as `P`, for which the caller is compiled, has instructions for. Returns how
/// many there are then.
#[inline(always)]
pub(crate) fn compute<P: Processor, T: Batch, F: Formula<T>>(formula: &mut F, components: &mut [T]) -> usize {
    let mut done = 0;
    if const { P::FOURS } {
        while done + 4 <= components.len() + F::SPARE {
            // SAFETY: the bits are those of four doubles
            let [x, y, z, w]: [f64; 4] = unsafe { transmute(formula.at::<__m256d>(done)) };
            (components[done], components[done + 1], components[done + 2]) = (T::of(x), T::of(y), T::of(z));
            if done + 3 < components.len() {
                components[done + 3] = T::of(w);
            }
            done = components.len().min(done + 4);
        }
    }
    while done + 2 <= components.len() {
        // SAFETY: the bits are those of two doubles
        let [x, y]: [f64; 2] = unsafe { transmute(formula.at::<__m128d>(done)) };
        (components[done], components[done + 1]) = (T::of(x), T::of(y));
        done += 2;
    }
    done
}

/// Whether there are doubles alone, and so many of them from `i` on.
#[inline(always)]
fn are_doubles<T: Batch, U: Components<T>, const SPARE: usize>(i: usize, many: usize) -> bool {
    T::PAIRS && size_of::<U>() == size_of::<f64>() * U::LENGTH && i + many <= U::LENGTH + SPARE
}

/// The components from `i` on, two or, with zero after the last, four.
#[inline(always)]
fn gathered<T: Batch, const N: usize>(components: &[T], i: usize) -> [f64; N] {
    let mut doubles = [0.0; N];
    let mut k = 0;
    while k < N && i + k < components.len() {
        doubles[k] = components[i + k].lane(0).to_f64();
        k += 1;
    }
    doubles
}

/// Pieces of so many doubles, of which the last may be the spare one of a [`Row`].
macro_rules! pieces {
    ($($vector:ident: $lanes:literal doubles, $load:ident, $store:ident, $set:expr, $splat:ident, $add:ident, $sub:ident, $mul:ident, $fmadd:ident;)*) => {
        $(
            // SAFETY: the processor has these instructions, for the caller is compiled for it: two at a time any x86-64, four at a time where
            // `P::FOURS`, and rounded once where `P::FOURS` too or where the program is built for them.
            impl<T: Batch> Piece<T> for $vector {
                #[inline(always)]
                fn of<U: Components<T>, const SPARE: usize>(row: &Row<T, U, SPARE>, i: usize) -> Self {
                    assert!(are_doubles::<T, U, SPARE>(i, $lanes));
                    // SAFETY: so many doubles from `i` on, the spare one included
                    unsafe { $load((&raw const *row).cast::<f64>().add(i)) }
                }
                #[inline(always)]
                fn gathered(components: &[T], i: usize) -> Self {
                    unsafe { $set(gathered(components, i)) }
                }
                #[inline(always)]
                fn put<U: Components<T>, const SPARE: usize>(self, row: &mut Row<T, U, SPARE>, i: usize) {
                    assert!(are_doubles::<T, U, SPARE>(i, $lanes));
                    // SAFETY: so many doubles from `i` on, the spare one included
                    unsafe { $store((&raw mut *row).cast::<f64>().add(i), self) }
                }
                #[inline(always)]
                fn and(self, x: Self) -> Self {
                    unsafe { $add(self, x) }
                }
                #[inline(always)]
                fn less(self, x: Self) -> Self {
                    unsafe { $sub(self, x) }
                }
                #[inline(always)]
                fn times(self, a: T) -> Self {
                    unsafe { $mul($splat(a.lane(0).to_f64()), self) }
                }
                #[inline(always)]
                fn plus(self, a: T, x: Self) -> Self {
                    unsafe {
                        let a = $splat(a.lane(0).to_f64());
                        if T::IS_FUSED { $fmadd(a, x, self) } else { $add(self, $mul(a, x)) }
                    }
                }
            }
        )*
    };
}
pieces! {
    __m128d: 2 doubles, _mm_loadu_pd, _mm_storeu_pd, |[x, y]: [f64; 2]| _mm_set_pd(y, x), _mm_set1_pd,
        _mm_add_pd, _mm_sub_pd, _mm_mul_pd, _mm_fmadd_pd;
    __m256d: 4 doubles, _mm256_loadu_pd, store_whole, |[x, y, z, w]: [f64; 4]| _mm256_set_pd(w, z, y, x), _mm256_set1_pd,
        _mm256_add_pd, _mm256_sub_pd, _mm256_mul_pd, _mm256_fmadd_pd;
}

/// Stores four doubles by one instruction. The compiler would store what it has put together in two pieces, and a load of all four then has to wait
/// until both are in the cache.
///
/// # Safety
/// Only where the processor has the instructions, and four doubles may be written.
#[inline(always)]
unsafe fn store_whole(at: *mut f64, doubles: __m256d) {
    // SAFETY: as said above
    unsafe {
        let [low, high] = [_mm256_castpd256_pd128(doubles), _mm256_extractf128_pd::<1>(doubles)];
        core::arch::asm!(
            "vinsertf128 {low:y}, {low:y}, {high}, 1",
            "vmovupd [{at}], {low:y}",
            low = inout(xmm_reg) low => _,
            high = in(xmm_reg) high,
            at = in(reg) at,
            options(nostack, preserves_flags)
        );
    }
}

/// Does the work in a function of its own, compiled for [`fma`](Batch::fma) where the processor has an instruction
/// for it.
#[inline]
pub(crate) fn dispatch_fused<W: Work>(work: W) -> W::Result {
    if Avx2::is_here() { Avx2::dispatch(work) } else { Portable::dispatch(work) }
}

/// [`Batch::dispatch_wide`] of numbers alone.
#[inline]
pub(crate) fn dispatch_wide<W: LongWork>(work: W) -> W::Result {
    if Avx512::is_here() {
        Avx512::dispatch(On::<Avx512, W>::new(work))
    } else if Avx2::is_here() {
        Avx2::dispatch(On::<Avx2, W>::new(work))
    } else {
        Portable::dispatch(On::<Portable, W>::new(work))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fused::FusedScalar;
    use crate::method::{AdvanceN, Clock, Method};
    use crate::scalar::Mask;
    use crate::scalar::rows::computed;
    use crate::scalar::simd::lanes::Portable;
    use crate::solve::step::OneStep;
    use crate::tests::Midpoint;
    use std::vec::Vec;

    /// All that can be done with pieces.
    struct Mixed<T: Batch, const N: usize, const SPARE: usize>([Row<T, [T; N], SPARE>; 2], [T; N]);

    impl<T: Batch, const N: usize, const SPARE: usize> Formula<T> for Mixed<T, N, SPARE> {
        const SPARE: usize = SPARE;

        #[inline(always)]
        fn at<X: Piece<T>>(&mut self, i: usize) -> X {
            let Self([first, second], other) = self;
            let sum = X::of(first, i).plus(T::of(0.3), X::gathered(other, i)).and(X::of(second, i));
            sum.put(first, i);
            sum
        }
    }

    /// What the processor makes of what it has kept, against what it makes of one component after the other.
    fn computes<P: Processor, T: Batch<Number = f64>, const N: usize, const SPARE: usize>() {
        let numbers = |j: usize| core::array::from_fn(|i| T::of((1.0 + (7 * j + i) as f64).sqrt() - 2.0));
        let mixed = Mixed::<T, N, SPARE>([Row::new(numbers(0)), Row::new(numbers(1))], numbers(2));
        let mut together = Mixed::<T, N, SPARE>(mixed.0, mixed.1);
        // what was put there the first time is found there the second time
        for _ in 0..2 {
            let all = computed::<P, T, [T; N], _>(&mut together, &[T::of(0.0); N]);
            assert_eq!(all, together.0[0].components);
        }
        let mut alone = mixed;
        for (i, together) in together.0[0].components.into_iter().enumerate() {
            let _: T = alone.at(i);
            let alone: T = alone.at(i);
            assert!(together.is_same(alone).all() && together.is_finite().all(), "{i} of {N}");
        }
    }

    fn computes_all<P: Processor, T: Batch<Number = f64>>() {
        computes::<P, T, 1, 0>();
        computes::<P, T, 1, 1>();
        computes::<P, T, 2, 0>();
        computes::<P, T, 2, 1>();
        computes::<P, T, 3, 0>();
        computes::<P, T, 3, 1>();
        computes::<P, T, 4, 0>();
        computes::<P, T, 4, 1>();
        computes::<P, T, 5, 0>();
        computes::<P, T, 5, 1>();
        computes::<P, T, 6, 0>();
        computes::<P, T, 6, 1>();
        computes::<P, T, 7, 0>();
        computes::<P, T, 7, 1>();
        computes::<P, T, 8, 0>();
        computes::<P, T, 8, 1>();
        computes::<P, T, 11, 0>();
        computes::<P, T, 11, 1>();
    }

    #[test]
    fn pieces_are_computed_as_single_components_are() {
        computes_all::<Portable, f64>();
        if Avx2::is_here() {
            computes_all::<Avx2, f64>();
            computes_all::<Avx2, FusedScalar<f64>>();
        }
        if Avx512::is_here() {
            computes_all::<Avx512, f64>();
            computes_all::<Avx512, FusedScalar<f64>>();
        }
    }

    /// Where steps compiled for a processor lead to, and what is remembered of them.
    fn walked<P: Processor, T: Batch<Number = f64>>() -> Vec<f64> {
        const STEPS: u64 = 3_000;
        let mut method = OneStep::<T, Midpoint<T>>::new(&[1.0, 2.0, 2.5].map(T::of), T::of(0.01));
        let mut state = [0.4, -0.8, 1.5].map(T::of);
        let advanced = method.advance(&state, T::of(0.0), &[], false);
        state = advanced.map_err(|failure| failure.first()).expect("a small step").state;
        let clock = Clock { start: 0.0, step: 0.01, taken: 1 };
        let (method_of, control) = (&mut method, &[]);
        let work = AdvanceN {
            method: method_of,
            state: &mut state,
            clock,
            control,
            most: STEPS,
            known: true,
            failed: None,
        };
        assert_eq!(P::dispatch(On::<P, _>::new(work)).steps, STEPS);
        let mut all: Vec<f64> = state.iter().map(|x| x.lane(0)).collect();
        method.memory(&mut |numbers| all.extend(numbers.iter().map(|x| x.lane(0))));
        all
    }

    #[test]
    fn steps_are_the_same_on_every_processor() {
        let (plain, fused) = (walked::<Portable, f64>(), walked::<Portable, FusedScalar<f64>>());
        assert_ne!(plain, fused);
        if Avx2::is_here() {
            assert_eq!(plain, walked::<Avx2, f64>());
            assert_eq!(fused, walked::<Avx2, FusedScalar<f64>>());
        }
        if Avx512::is_here() {
            assert_eq!(plain, walked::<Avx512, f64>());
            assert_eq!(fused, walked::<Avx512, FusedScalar<f64>>());
        }
    }
}
