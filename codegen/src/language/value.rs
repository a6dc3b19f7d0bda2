//! Values of expressions.

use crate::expr::{Arena, Expr, Matrix, Number, Stage, Vector};
use crate::group::{ComponentValue, Group};
use crate::quantity::Shape;

/// The symbolic value of an expression.
///
/// As in nalgebra, a vector is a matrix of one column. [`Value::of_matrix`] keeps the representation unique.
#[derive(Clone, Debug, PartialEq)]
pub enum Value<'a> {
    /// An integer, as indices and exponents are. Where it stands for a scalar, rustc has the last word.
    Integer(i64),
    /// A number.
    Scalar(Expr<'a>),
    /// A number that is below zero where something is true.
    Truth(Expr<'a>),
    /// A column.
    Vector(Vector<'a>),
    /// A matrix of more than one column.
    Matrix(Matrix<'a>),
    /// Several values, as `sin_cos` returns them.
    Tuple(Vec<Value<'a>>),
    /// Several values of one type, by numbers.
    Array(Vec<Value<'a>>),
    /// Values that come one after the other.
    Iterator(Vec<Value<'a>>),
    /// A configuration.
    Element(Element<'a>),
    /// A point of space: a place, where a vector is a direction and a length.
    Point(Vector<'a>),
    /// What is not there for every argument, such as the inverse of a matrix.
    Optional(Box<Value<'a>>),
}

/// An element of a group that is not a vector space.
#[derive(Clone)]
pub struct Element<'a> {
    /// The group.
    pub group: &'static dyn Group,
    /// Its stored coordinates.
    pub coordinates: Vector<'a>,
}

impl PartialEq for Element<'_> {
    fn eq(&self, other: &Self) -> bool {
        self.group.name() == other.group.name() && self.coordinates == other.coordinates
    }
}

impl std::fmt::Debug for Element<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple(self.group.name()).field(&self.coordinates).finish()
    }
}

impl<'a> Value<'a> {
    /// A value made of new symbols, named after their place: `chi`, `chi_x`, `inertia_xy`.
    pub fn symbols(arena: &'a Arena, name: &str, shape: Shape, stage: Stage) -> Self {
        let symbol = |suffix: String| arena.symbol(format!("{name}_{suffix}"), stage);
        match shape {
            Shape::Scalar => Self::Scalar(arena.symbol(name, stage)),
            Shape::Vector(n) => Self::Vector(Vector((0..n).map(|i| symbol(component(i, n))).collect())),
            Shape::Matrix(rows, columns) => {
                let largest = rows.max(columns);
                Self::of_matrix(Matrix::from_fn(rows, columns, |i, j| symbol(entry(i, j, largest))))
            }
        }
    }

    /// An element of a group: a vector, if the group is a vector space.
    pub fn element(group: &'static dyn Group, coordinates: Vector<'a>) -> Self {
        if let Some(rows) = group.matrix_rows() {
            Self::of_matrix(Matrix::new(rows, rows, coordinates.0))
        } else if group.is_linear() {
            Self::Vector(coordinates)
        } else {
            Self::Element(Element { group, coordinates })
        }
    }

    /// Some components of a vector: one of them is a number.
    pub fn of_part(components: &[Expr<'a>]) -> Self {
        match components {
            [one] => Self::Scalar(*one),
            several => Self::Vector(Vector(several.to_vec())),
        }
    }

    /// A component of an element of a group, as a value.
    pub fn of_component(component: ComponentValue<'a>) -> Self {
        match component {
            ComponentValue::Scalar(scalar) => Self::Scalar(scalar),
            ComponentValue::Vector(vector) => Self::Vector(vector),
            ComponentValue::Element(group, coordinates) => Self::element(group, coordinates),
        }
    }

    /// A matrix, or the vector that it is if it has one column.
    pub fn of_matrix(matrix: Matrix<'a>) -> Self {
        if matrix.columns == 1 { Self::Vector(Vector(matrix.entries)) } else { Self::Matrix(matrix) }
    }

    /// The scalar, if it is one or an integer that stands for one.
    pub fn as_scalar(&self, arena: &'a Arena) -> Option<Expr<'a>> {
        match self {
            Self::Scalar(scalar) => Some(*scalar),
            Self::Integer(integer) => Some(arena.number(Number::from(*integer))),
            _ => None,
        }
    }

    /// The matrix, if it is one or a vector, which is a matrix of one column.
    pub fn as_matrix(&self) -> Option<Matrix<'a>> {
        match self {
            Self::Vector(vector) => Some(Matrix::new(vector.len(), 1, vector.0.clone())),
            Self::Matrix(matrix) => Some(matrix.clone()),
            _ => None,
        }
    }

    /// Its shape, if it has one.
    pub fn shape(&self) -> Option<Shape> {
        match self {
            Self::Integer(_) | Self::Scalar(_) => Some(Shape::Scalar),
            Self::Vector(vector) => Some(Shape::Vector(vector.len())),
            Self::Matrix(matrix) => Some(Shape::Matrix(matrix.rows, matrix.columns)),
            Self::Truth(_) | Self::Tuple(_) | Self::Array(_) | Self::Iterator(_) => None,
            Self::Element(_) | Self::Point(_) | Self::Optional(_) => None,
        }
    }

    /// Describes it in words, with the article.
    pub fn describe(&self) -> String {
        match self {
            Self::Integer(_) => "an integer".to_owned(),
            Self::Truth(_) => "a condition".to_owned(),
            Self::Tuple(values) => format!("a tuple of {}", values.len()),
            Self::Array(values) if values.iter().all(|value| value.shape() == Some(Shape::Scalar)) => {
                format!("an array of {} (a vector is written `vector![…]`)", values.len())
            }
            Self::Array(values) => format!("an array of {}", values.len()),
            Self::Iterator(_) => "an iterator".to_owned(),
            Self::Element(element) => format!("an element of {}", element.group.name()),
            Self::Point(point) => format!("a point in {} dimensions", point.len()),
            Self::Optional(value) => format!("an option of {} (take it with `.unwrap()`)", value.describe()),
            _ => self.shape().map(Shape::describe).unwrap_or_default(),
        }
    }

    /// How much there is of it: its scalars, and one for all that has none.
    pub(super) fn size(&self) -> usize {
        match self {
            Self::Tuple(values) | Self::Array(values) | Self::Iterator(values) => {
                values.iter().map(Self::size).sum::<usize>() + 1
            }
            _ => self.scalars().len().max(1),
        }
    }

    /// All scalars it is made of.
    pub fn scalars(&self) -> Vec<Expr<'a>> {
        match self {
            Self::Integer(_) => Vec::new(),
            Self::Scalar(scalar) | Self::Truth(scalar) => vec![*scalar],
            Self::Vector(vector) => vector.0.clone(),
            Self::Matrix(matrix) => matrix.entries.clone(),
            Self::Tuple(values) | Self::Array(values) | Self::Iterator(values) => {
                values.iter().flat_map(Self::scalars).collect()
            }
            Self::Element(element) => element.coordinates.0.clone(),
            Self::Point(point) => point.0.clone(),
            Self::Optional(value) => value.scalars(),
        }
    }
}

/// nalgebra's names of a vector's components.
pub(crate) const COMPONENTS: [&str; 6] = ["x", "y", "z", "w", "a", "b"];

/// How the name of a vector's component ends.
fn component(i: usize, n: usize) -> String {
    match COMPONENTS.get(i) {
        Some(name) if n <= COMPONENTS.len() => (*name).to_owned(),
        _ => i.to_string(),
    }
}

/// How the name of a matrix' entry ends.
fn entry(i: usize, j: usize, largest: usize) -> String {
    if largest <= COMPONENTS.len() {
        format!("{}{}", component(i, largest), component(j, largest))
    } else {
        format!("{i}_{j}")
    }
}
