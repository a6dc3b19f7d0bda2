//! From tokens to a description: what the user wrote, with spans, and nothing concluded from it.

mod attribute;
mod item;
mod nesting;
mod shape;

pub use attribute::{
    ADVECTED, Advected, Attribute, BasisMatrix, CONTROL, CRATE, Control, DERIVATIVES, FORCE, Factor, Force,
    GROUP, HAMILTONIAN, INVARIANCE, KEYS, Key, LAGRANGIAN, METHODS, POTENTIAL,
};
pub use item::{Field, Inertia, Item, Unreadable, without_helpers};
pub use shape::{ScalarType, Shape, of_segment};
