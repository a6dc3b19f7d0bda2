//! The maps from the algebra to the group that steps are made with.

/// A map `τ: g → G` with `τ(0) = e`, `τ'(0) = id`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Retraction {
    /// The group's exponential map.
    Exponential,
    /// The Cayley map `(1 − ξ/2)⁻¹(1 + ξ/2)`.
    Cayley,
    /// Canonical coordinates of the second kind, `exp(x₁E₁) ⋯ exp(x_d E_d)`.
    SecondKind,
    /// `exp(x_d E_d) ⋯ exp(x₁E₁)`: what [`SecondKind`](Self::SecondKind) is backwards.
    ReversedSecondKind,
}

/// A retraction that is a function `f` of one matrix, with `f(−X) = f(X)⁻¹`.
///
/// As `f(A X A⁻¹) = A f(X) A⁻¹`, it is `Ad`-equivariant: `τ(Ad_g x) = g τ(x) g⁻¹`. Hence `Ad*_{τ(x)} m = m + ad*_x (dR τ_x)* m`, and `τ(x)`
/// commutes with `exp x`. It is odd as well, `τ(−x) = τ(x)⁻¹`, so that `dL τ_x = dR τ_{−x}`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MatrixFunction {
    /// [`Retraction::Exponential`]
    Exponential,
    /// [`Retraction::Cayley`]
    Cayley,
}

impl Retraction {
    /// Those that steps are asked for by.
    pub const ALL: [Retraction; 3] = [Retraction::Exponential, Retraction::Cayley, Retraction::SecondKind];
    /// Those with which steps are generated unless others are asked for.
    pub const DEFAULT: [Retraction; 2] = [Retraction::Exponential, Retraction::Cayley];

    /// The name of the runtime's marker type; what is backwards has none of its own.
    pub fn name(self) -> &'static str {
        match self {
            Self::Exponential => "Exponential",
            Self::Cayley => "Cayley",
            Self::SecondKind => "SecondKind",
            Self::ReversedSecondKind => "ReversedSecondKind",
        }
    }

    /// Its name among those of functions: `second_kind`.
    pub fn snake_name(self) -> String {
        let mut name = String::new();
        for letter in self.name().chars() {
            if letter.is_uppercase() && !name.is_empty() {
                name.push('_');
            }
            name.extend(letter.to_lowercase());
        }
        name
    }

    /// `τ̄(x) = τ(−x)⁻¹`, a retraction with `dR τ̄_x = dL τ_{−x}`.
    #[must_use]
    pub fn reversed(self) -> Self {
        match self {
            Self::Exponential | Self::Cayley => self,
            Self::SecondKind => Self::ReversedSecondKind,
            Self::ReversedSecondKind => Self::SecondKind,
        }
    }

    /// Whether `τ(−x) = τ(x)⁻¹`.
    pub fn is_odd(self) -> bool {
        self == self.reversed()
    }

    /// Whether `τ(Ad_g x) = g τ(x) g⁻¹`.
    pub fn is_equivariant(self) -> bool {
        matches!(self.law(), Law::Function(_))
    }

    /// By what law it is made.
    pub(crate) fn law(self) -> Law {
        match self {
            Self::Exponential => Law::Function(MatrixFunction::Exponential),
            Self::Cayley => Law::Function(MatrixFunction::Cayley),
            Self::SecondKind => Law::Product(Order::Ascending),
            Self::ReversedSecondKind => Law::Product(Order::Descending),
        }
    }
}

impl From<MatrixFunction> for Retraction {
    fn from(f: MatrixFunction) -> Self {
        match f {
            MatrixFunction::Exponential => Self::Exponential,
            MatrixFunction::Cayley => Self::Cayley,
        }
    }
}

/// How a retraction is made for any group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Law {
    /// By the group's closed forms.
    Function(MatrixFunction),
    /// As a [product of one-parameter groups](super::second_kind).
    Product(Order),
}

/// In which order the axes of an algebra come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Order {
    /// From the first one to the last one.
    Ascending,
    /// From the last one to the first one.
    Descending,
}
