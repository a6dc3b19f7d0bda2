//! The types a description knows: scalars, and nalgebra's vectors and matrices of a fixed size.

use syn::{Expr, GenericArgument, Lit, PathArguments, PathSegment, Type};

use crate::quantity::{ScalarType, Shape};

/// The largest number of rows or columns. nalgebra's own names end at 6; beyond this bound is a typing error.
const LARGEST: usize = 32;

/// The scalar type of that name.
pub(crate) fn scalar_named(name: &str) -> Option<ScalarType> {
    [ScalarType::F64, ScalarType::F32].into_iter().find(|scalar| scalar_name(*scalar) == name)
}

/// The name of a scalar type, as Rust writes it.
pub(crate) fn scalar_name(scalar: ScalarType) -> &'static str {
    match scalar {
        ScalarType::F64 => "f64",
        ScalarType::F32 => "f32",
    }
}

/// The shape that nalgebra gives a name: `Vector3`, `Matrix2`, `Matrix2x3`, `RowVector3`.
pub(crate) fn shape_named(name: &str) -> Option<Shape> {
    let size = |digits: &str| match digits.as_bytes() {
        [digit @ b'1'..=b'6'] => Some(usize::from(digit - b'0')),
        _ => None,
    };
    if let Some(digits) = name.strip_prefix("Vector") {
        return size(digits).map(Shape::Vector);
    }
    if let Some(digits) = name.strip_prefix("RowVector") {
        return size(digits).map(|columns| Shape::Matrix(1, columns));
    }
    let digits = name.strip_prefix("Matrix")?;
    match digits.split_once('x') {
        Some((rows, columns)) => Some(Shape::Matrix(size(rows)?, size(columns)?)),
        None => size(digits).map(|n| Shape::Matrix(n, n)),
    }
}

/// The shape and scalar type of a field's type, told by its last path segment, whatever module it comes from.
pub(crate) fn of_type(ty: &Type) -> Option<(Shape, ScalarType)> {
    match ty {
        Type::Path(path) if path.qself.is_none() => of_segment(path.path.segments.last()?),
        Type::Paren(inner) => of_type(&inner.elem),
        Type::Group(inner) => of_type(&inner.elem),
        _ => None,
    }
}

/// The element type and length of an array; the type itself if it is none.
pub(super) fn element(ty: &Type) -> syn::Result<(&Type, Option<usize>)> {
    match ty {
        Type::Array(array) => Ok((&array.elem, Some(array_length(&array.len)?))),
        Type::Paren(inner) => element(&inner.elem),
        Type::Group(inner) => element(&inner.elem),
        _ => Ok((ty, None)),
    }
}

/// The length of an array. What arrays of the standard library are, such as their own default, they are up to this one.
pub(super) fn array_length(length: &Expr) -> syn::Result<usize> {
    size(length).ok_or_else(|| {
        let message = format!("the length of an array is a number from 1 to {LARGEST}");
        syn::Error::new_spanned(length, message)
    })
}

/// A literal number of rows, columns or elements.
fn size(literal: &Expr) -> Option<usize> {
    let Expr::Lit(literal) = literal else { return None };
    let Lit::Int(literal) = &literal.lit else { return None };
    let suffix = literal.suffix();
    literal
        .base10_parse()
        .ok()
        .filter(|_| suffix.is_empty() || suffix == "usize")
        .filter(|size| (1..=LARGEST).contains(size))
}

/// The shape and scalar type that a path's segment names, as `Vector3<f64>` or `SVector::<f64, 4>` do.
pub(crate) fn of_segment(segment: &PathSegment) -> Option<(Shape, ScalarType)> {
    let name = segment.ident.to_string();
    if let Some(scalar) = scalar_named(&name) {
        return segment.arguments.is_none().then_some((Shape::Scalar, scalar));
    }
    let arguments = arguments(segment);
    let Some(GenericArgument::Type(ty)) = arguments.first() else { return None };
    let (Shape::Scalar, scalar) = of_type(ty)? else { return None };
    let shape = match (name.as_str(), &arguments[1..]) {
        ("SVector", &[n]) => Shape::Vector(size_argument(n)?),
        ("SMatrix", &[rows, columns]) => Shape::Matrix(size_argument(rows)?, size_argument(columns)?),
        (_, []) => shape_named(&name)?,
        _ => return None,
    };
    Some((shape, scalar))
}

fn arguments(segment: &PathSegment) -> Vec<&GenericArgument> {
    match &segment.arguments {
        PathArguments::AngleBracketed(arguments) => arguments.args.iter().collect(),
        _ => Vec::new(),
    }
}

fn size_argument(argument: &GenericArgument) -> Option<usize> {
    match argument {
        GenericArgument::Const(literal) => size(literal),
        _ => None,
    }
}
