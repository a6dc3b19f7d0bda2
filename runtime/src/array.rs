//! `vector!` and `matrix!`, for users who depend on this crate alone.
//!
//! nalgebra's macros of these names say `nalgebra::` and mean the user's own dependency of that name.

/// A column vector of its components: `vector![1.0, 2.0, 3.0]`.
///
/// ```
/// use coadjoint::prelude::*;
///
/// const UP: Vector3<f64> = vector![0.0, 0.0, 1.0];
/// assert_eq!(UP, Vector3::z());
/// ```
#[macro_export]
macro_rules! vector {
    ($($component:expr),+ $(,)?) => {
        $crate::nalgebra::Matrix::from_array_storage($crate::nalgebra::ArrayStorage([[$($component),+]]))
    };
}

/// A matrix by rows: `matrix![1.0, 2.0; 3.0, 4.0]`.
///
/// ```
/// use coadjoint::prelude::*;
///
/// let turn = matrix![
///     0.0, -1.0, 0.0;
///     1.0,  0.0, 0.0;
///     0.0,  0.0, 1.0;
/// ];
/// assert_eq!(turn * Vector3::x(), Vector3::y());
/// assert_eq!(matrix![1, 2; 3, 4][(0, 1)], 2);
/// ```
#[macro_export]
macro_rules! matrix {
    ($($($entry:expr),+);+ $(;)?) => {
        $crate::nalgebra::Matrix::from_array_storage($crate::nalgebra::ArrayStorage([$([$($entry),+]),+]))
            .transpose()
    };
}
