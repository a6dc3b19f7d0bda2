//! Quantities of a system: what they are to it, and of what kind, in the words of mathematics.

/// The role of a quantity in its system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// A field of the user's struct.
    Parameter,
    /// A factor's configuration.
    Configuration,
    /// A factor's momentum.
    Momentum,
    /// An advected parameter.
    Advected,
    /// A control.
    Control,
}

/// The mathematical kind of a quantity, which says what is stored of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A number.
    Scalar,
    /// A column of so many numbers.
    Vector(usize),
    /// A symmetric matrix of so many rows, all of it stored.
    Symmetric(usize),
    /// A matrix of so many rows and columns.
    Matrix(usize, usize),
    /// A rotation of the plane: cosine and sine.
    UnitComplex,
    /// A rotation of space: the real part, then the imaginary ones.
    UnitQuaternion,
    /// A rotation of the plane and a translation.
    RigidMotion2,
    /// A rotation of space and a translation.
    RigidMotion3,
}

/// The shape of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// One number.
    Scalar,
    /// A column of so many numbers.
    Vector(usize),
    /// So many rows and columns.
    Matrix(usize, usize),
}

/// The numbers that a system is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ScalarType {
    /// 64 bits.
    F64,
    /// 32 bits.
    F32,
}

/// Where momentum and velocity are taken: the trivialization of the cotangent bundle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// In the body: `g' = g ξ`, for left-invariant energies.
    Left,
    /// In space: `g' = ξ g`, for right-invariant energies.
    Right,
}

/// Which zeros of a quantity count, in the direction of the run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// From below to above.
    Rising,
    /// From above to below.
    Falling,
    /// All of them, also where the quantity touches zero.
    Both,
}

impl Direction {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Rising, Self::Falling, Self::Both];

    /// The word for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Rising => "rising",
            Self::Falling => "falling",
            Self::Both => "both",
        }
    }
}

impl From<Shape> for Kind {
    fn from(shape: Shape) -> Self {
        match shape {
            Shape::Scalar => Self::Scalar,
            Shape::Vector(n) => Self::Vector(n),
            Shape::Matrix(rows, columns) => Self::Matrix(rows, columns),
        }
    }
}

impl Shape {
    /// How many numbers it takes.
    pub fn size(self) -> usize {
        match self {
            Self::Scalar => 1,
            Self::Vector(n) => n,
            Self::Matrix(rows, columns) => rows * columns,
        }
    }

    /// In words, with the article.
    pub fn describe(self) -> String {
        match self {
            Self::Scalar => "a scalar".to_owned(),
            Self::Vector(n) => format!("a vector of {n}"),
            Self::Matrix(rows, columns) => format!("a {rows}×{columns} matrix"),
        }
    }
}
