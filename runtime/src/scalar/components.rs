//! Arrays of numbers.

/// A flat array of scalars. Sealed: code that is not checked relies on its being one.
pub trait Components<T>:
    Copy + PartialEq + core::fmt::Debug + AsRef<[T]> + AsMut<[T]> + Send + Sync + sealed::Array<T> + 'static
{
    /// How many there are.
    const LENGTH: usize;
    /// The array of `value` in all places.
    fn splat(value: T) -> Self;
}

/// The array of what a function makes of each number; `empty` where there are no more of them.
#[inline(always)]
pub(crate) fn mapped<T: Copy, U, C: Components<U>>(numbers: &[T], empty: U, of: impl Fn(T) -> U) -> C {
    let mut mapped = C::splat(empty);
    for (to, number) in mapped.as_mut().iter_mut().zip(numbers) {
        *to = of(*number);
    }
    mapped
}

mod sealed {
    pub trait Array<T> {}

    impl<T, const N: usize> Array<T> for [T; N] {}
}

impl<T, const N: usize> Components<T> for [T; N]
where
    T: Copy + PartialEq + core::fmt::Debug + Send + Sync + 'static,
{
    const LENGTH: usize = N;

    #[inline(always)]
    fn splat(value: T) -> Self {
        [value; N]
    }
}
