//! Everything a description and its use need: `use coadjoint::prelude::*;`

pub use crate::error::{ParameterError, StepError};
pub use crate::lie_poisson_system;
pub use crate::retraction::{Cayley, Exponential};
// (run)
pub use crate::stepper::{StepReport, Stepper};
pub use crate::system::{Discretized, State, System};
pub use crate::{matrix, vector};
pub use nalgebra::{Matrix3, Quaternion, Rotation3, Unit, UnitQuaternion, Vector3};
pub use serde::{Deserialize, Serialize};
