//! From tokens to a description: what the user wrote, with spans, and nothing concluded from it.

mod attribute;
mod factor;
mod function;
mod group;
mod item;
mod key;
mod nesting;
mod shape;

pub use attribute::{Advected, Attribute, Control, Definition, Event, Factor, Force, Unit};
pub use factor::{FactorName, Index};
pub use function::{OF_NUMBERS, OwnFunction, calls, seen_from};
pub(crate) use group::group;
pub use group::{BasisMatrix, Group, Space};
pub use item::{Field, Inertia, Item, Unreadable, without_helpers};
pub use key::{EnergyKey, EnergyRow, Key};
pub(crate) use nesting::excess as nested;
pub(crate) use shape::{of_segment, of_type, scalar_name, scalar_named, shape_named};
