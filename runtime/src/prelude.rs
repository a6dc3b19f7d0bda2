//! Everything a description and its use need: `use coadjoint::prelude::*;`

#[cfg(feature = "std")]
pub use crate::compensated::Compensated;
pub use crate::composition::{Order4, Order6, Order8, Order10};
#[cfg(feature = "std")]
pub use crate::ensemble::{Distribution, Ensemble};
pub use crate::error::{ParameterError, StepError};
#[cfg(feature = "std")]
pub use crate::fused::Fused;
pub use crate::lie_poisson_system;
#[cfg(feature = "std")]
pub use crate::observe::Record;
pub use crate::observe::{Every, Invariants, Observer};
pub use crate::retraction::{Cayley, Exponential};
pub use crate::run::{Run, RunError, RunReport, Tick};
pub use crate::scheme::{
    Family, Midpoint, RightLift, StormerVerlet, SymplecticEulerA, SymplecticEulerB, TangentLift,
};
pub use crate::stepper::{StepReport, Stepper};
pub use crate::system::{Control, Discretized, NoControl, State, System};
pub use crate::{matrix, vector};
pub use nalgebra::{
    Isometry2, Isometry3, Matrix1, Matrix2, Matrix3, Matrix6, Quaternion, Rotation3, Unit, UnitComplex,
    UnitQuaternion, Vector1, Vector2, Vector3, Vector4, Vector5, Vector6,
};
pub use serde::{Deserialize, Serialize};
