//! Derivatives to be chosen from while the program runs.

use super::{Differentiable, Linearized};
use crate::kernel::Kernel;
use crate::retraction::RetractionKind;
use crate::scheme::Rule;
use crate::system::System;

/// The steps whose derivatives were generated. Implemented by the macro for every system.
#[doc(hidden)]
pub trait LinearizedSchemes: System {
    /// Shows the visitor a step's kernel with its derivative; none if that was not generated.
    fn visit_linearized<V: LinearizedVisitor<Self>>(
        _map: RetractionKind,
        _rule: Rule,
        _visitor: V,
    ) -> Option<V::Output> {
        None
    }
}

/// Makes something of a step's derivative.
#[doc(hidden)]
pub trait LinearizedVisitor<S: System> {
    /// What comes of it.
    type Output;
    /// Makes it of this kernel.
    fn visit<K>(self) -> Self::Output
    where
        S: Differentiable,
        K: Linearized<S::Scalar, S>
            + Kernel<
                S::Scalar,
                Parameters = S::Parameters<S::Scalar>,
                State = S::StateComponents<S::Scalar>,
                Control = S::ControlComponents<S::Scalar>,
            >;
}
