//! The matrices of groups that are described by their bases.

use coadjoint::nalgebra::DMatrix;
use coadjoint_codegen::group::family;

/// The basis of a group of the library, of its name and dimension.
pub fn of_family(name: &str, dimension: usize) -> Vec<DMatrix<f64>> {
    let group = family(name).expect("there is one");
    let n = group.size();
    let entry = |axis, i, j| {
        let (numerator, denominator) = group.basis_entry(axis, i, j);
        numerator as f64 / denominator as f64
    };
    (0..dimension).map(|axis| DMatrix::from_fn(n, n, |i, j| entry(axis, i, j))).collect()
}
