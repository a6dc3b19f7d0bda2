//! What a description and its first steps need: `use coadjoint::prelude::*;`
//!
//! The attribute, the schemes, the stepper with its errors, and the types of nalgebra that fields and states have. Of traits only the methods
//! come along, so that names as common as `System`, `State` and `Control` are left to others: what is written out is imported by its name,
//! `use coadjoint::{Run, System};`.

pub use crate::Spline as _;
#[cfg(feature = "std")]
pub use crate::compensated::Compensated;
pub use crate::composition::{Order4, Order6, Order8, Order10};
pub use crate::error::{ParameterError, StepError};
#[cfg(feature = "std")]
pub use crate::fused::Fused;
pub use crate::retraction::{Cayley, Exponential};
pub use crate::scheme::{HamiltonJacobi, Midpoint, StormerVerlet, SymplecticEulerA, SymplecticEulerB};
pub use crate::stepper::Stepper;
pub use crate::system::{Control as _, NoControl, State as _, System as _};
pub use crate::{expression, lie_group, lie_poisson_system};
pub use crate::{matrix, vector};
pub use nalgebra::{
    Isometry2, Isometry3, Matrix1, Matrix2, Matrix3, Matrix4, Matrix5, Matrix6, Point2, Point3, Quaternion,
    Rotation3, SMatrix, SVector, UnitComplex, UnitQuaternion, Vector1, Vector2, Vector3, Vector4, Vector5,
    Vector6,
};
