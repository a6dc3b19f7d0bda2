//! `vector!` and `matrix!`: as nalgebra's, but finding nalgebra through this crate, so that who depends on `coadjoint`
//! need not depend on nalgebra too.

/// A column vector from its components: `vector![1.0, 10.0, 100.0]`.
///
/// ```
/// use coadjoint::prelude::*;
/// const AXIS: Vector3<f64> = vector![0.0, 0.0, 1.0];
/// assert_eq!(AXIS, Vector3::z());
/// ```
#[macro_export]
macro_rules! vector {
    ($($component:expr),+ $(,)?) => {
        $crate::nalgebra::SVector::from_array_storage($crate::nalgebra::ArrayStorage([[$($component),+]]))
    };
}

/// A matrix from its rows: `matrix![1.0, 0.0; 0.0, 1.0]`.
///
/// ```
/// use coadjoint::prelude::*;
/// let shear = matrix![
///     1.0, 2.0, 0.0;
///     0.0, 1.0, 0.0;
///     0.0, 0.0, 1.0;
/// ];
/// assert_eq!(shear, Matrix3::new(1.0, 2.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0));
/// ```
#[macro_export]
macro_rules! matrix {
    ($($($entry:expr),+);+ $(;)?) => {
        // nalgebra stores columns
        $crate::nalgebra::SMatrix::from_array_storage($crate::nalgebra::ArrayStorage([$([$($entry),+]),+]))
            .transpose()
    };
}
