//! The catalogue of groups: a file for each kind, with its conventions.
//!
//! A group states its closed forms as symbolic expressions; everything else is derived from them. Each typed-in form is
//! tested against its definition (power series, matrix products, differences).

mod calculus;
pub mod casimirs;
mod definition;
mod euclidean;
mod exact;
mod families;
mod matrix;
mod product;
mod representation;
mod retraction;
mod rigid;
mod semidirect;
mod side;
mod so2;
mod so3;
mod structure;

pub use definition::{
    AsGroup, Component, ComponentValue, EquationNames, Equations, Group, GroupNames, Moved,
};
pub use euclidean::R;
pub use families::{FAMILIES, LARGEST, family, family_meant, family_with_terms, one_word, sizes};
pub use matrix::{Basis, BasisError, LARGEST_BASIS, Linear, LinearError, MatrixGroup, NamedMatrix};
pub(crate) use product::consecutive;
pub use product::{Place, Product};
pub use representation::{Adjoint, Dual, Representation, SpaceNames, Translation};
pub(crate) use retraction::Law;
pub use retraction::{MatrixFunction, Retraction};
pub use rigid::{Rigid, SE2, SE3};
pub use semidirect::{Acted, Semidirect, SemidirectVector};
pub use side::Side;
pub use so2::SO2;
pub use so3::{SO3, SU2, UnitQuaternions};
pub use structure::Structure;

/// The name of a part of a momentum or velocity of this name: `angular_momentum`, `hull_linear_velocity`.
pub fn part_name(whole: &str, part: &str) -> String {
    let at = whole.rfind('_').map_or(0, |underscore| underscore + 1);
    let (factor, quantity) = whole.split_at(at);
    format!("{factor}{part}_{quantity}")
}

/// Whether these are one group: a name stands for one alone, but those of a user's own have none.
pub(crate) fn is_same(one: &dyn Group, other: &dyn Group) -> bool {
    one.name() == other.name() && (one.matrix_rows().is_none() || one.basis() == other.basis())
}

/// The groups a description may name.
pub fn catalogue() -> &'static [&'static dyn Group] {
    static ALL: [&dyn Group; 11] = [&R(1), &R(2), &R(3), &R(4), &R(5), &R(6), &SO2, &SO3, &SE2, &SE3, &SU2];
    &ALL
}
