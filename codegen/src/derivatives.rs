//! Which derivatives of a step are wanted.

/// Which derivatives of a step are wanted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Derivatives {
    /// The matrix with respect to the state.
    pub state: bool,
    /// The matrix with respect to the controls.
    pub controls: bool,
    /// The matrix with respect to the parameters.
    pub parameters: bool,
    /// The product with a perturbation of all three.
    pub tangent: bool,
    /// The transposed product.
    pub adjoint: bool,
}

impl Derivatives {
    /// All of them.
    pub const ALL: Self =
        Self { state: true, controls: true, parameters: true, tangent: true, adjoint: true };

    /// Whether there is anything to derive.
    pub fn any(self) -> bool {
        self != Self::default()
    }

    /// Whether the parameters have a part in any of them.
    pub fn of_parameters(self) -> bool {
        self.parameters || self.tangent || self.adjoint
    }
}
