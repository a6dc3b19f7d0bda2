//! Methods of vectors and matrices, as nalgebra has them.

use super::super::operators::scaled;
use super::super::value::Value;
use super::{Call, Method, method};
use crate::expr::{Expr, Matrix, Vector};
use crate::limits::DETERMINANT;

pub(super) static VECTOR_METHODS: &[Method] = &[
    method("dot", &["&other"], dot),
    method("cross", &["&other"], |call| {
        let vector = three(call)?;
        let other = Vector(call.like_receiver(0)?.entries);
        Some(Value::Vector(vector.cross(&other)))
    }),
    method("norm", &[], norm),
    method("norm_squared", &[], norm_squared),
    method("magnitude", &[], norm),
    method("magnitude_squared", &[], norm_squared),
    method("normalize", &[], |call| {
        let entries = entries(call)?;
        divided(call, entries.dot(&entries).sqrt())
    }),
    method("component_mul", &["&other"], component_mul),
    method("component_div", &["&other"], component_div),
    method("sum", &[], sum),
    method("scale", &["factor"], scale),
    method("unscale", &["divisor"], unscale),
    method("transpose", &[], transpose),
    method("tr_mul", &["&other"], tr_mul),
    method("cross_matrix", &[], |call| {
        let zero = call.arena.zero();
        let [x, y, z] = three(call)?.0[..] else { return None };
        Some(Value::Matrix(Matrix::new(3, 3, vec![zero, -z, y, z, zero, -x, -y, x, zero])))
    }),
];

pub(super) static MATRIX_METHODS: &[Method] = &[
    method("transpose", &[], transpose),
    method("tr_mul", &["&other"], tr_mul),
    method("trace", &[], |call| {
        let matrix = square(call)?;
        let zero = call.arena.zero();
        Some(Value::Scalar((0..matrix.rows).fold(zero, |sum, i| sum + matrix.at(i, i))))
    }),
    method("determinant", &[], |call| {
        let matrix = square(call)?;
        if matrix.rows > DETERMINANT {
            let message = format!("determinants are supported up to {DETERMINANT} rows");
            return call.fail(call.method, message);
        }
        Some(Value::Scalar(matrix.determinant()))
    }),
    method("try_inverse", &[], try_inverse),
    method("diagonal", &[], |call| {
        let matrix = call.receiver.as_matrix()?;
        let length = matrix.rows.min(matrix.columns);
        Some(Value::Vector(Vector((0..length).map(|i| matrix.at(i, i)).collect())))
    }),
    method("row", &["i"], |call| {
        let matrix = call.receiver.as_matrix()?;
        let i = place(call, matrix.rows)?;
        Some(Value::of_matrix(Matrix::new(1, matrix.columns, matrix.row(i).0)))
    }),
    method("column", &["j"], |call| {
        let matrix = call.receiver.as_matrix()?;
        let j = place(call, matrix.columns)?;
        Some(Value::Vector(matrix.column(j)))
    }),
    method("dot", &["&other"], dot),
    method("norm", &[], norm),
    method("norm_squared", &[], norm_squared),
    method("component_mul", &["&other"], component_mul),
    method("component_div", &["&other"], component_div),
    method("sum", &[], sum),
    method("scale", &["factor"], scale),
    method("unscale", &["divisor"], unscale),
];

fn entries<'a>(call: &Call<'_, 'a>) -> Option<Vector<'a>> {
    call.receiver.as_matrix().map(|matrix| Vector(matrix.entries))
}

fn dot<'a>(call: &mut Call<'_, 'a>) -> Option<Value<'a>> {
    let other = Vector(call.like_receiver(0)?.entries);
    Some(Value::Scalar(entries(call)?.dot(&other)))
}

/// The receiver, which must be a vector of three.
fn three<'a>(call: &mut Call<'_, 'a>) -> Option<Vector<'a>> {
    match call.receiver {
        Value::Vector(vector) if vector.len() == 3 => Some(vector.clone()),
        other => {
            let (method, found) = (call.method, other.describe());
            call.fail(method, format!("`{method}` is for vectors of 3; this is {found}"))
        }
    }
}

fn norm_squared<'a>(call: &mut Call<'_, 'a>) -> Option<Value<'a>> {
    let entries = entries(call)?;
    Some(Value::Scalar(entries.dot(&entries)))
}

fn norm<'a>(call: &mut Call<'_, 'a>) -> Option<Value<'a>> {
    let entries = entries(call)?;
    Some(Value::Scalar(entries.dot(&entries).sqrt()))
}

fn unscale<'a>(call: &mut Call<'_, 'a>) -> Option<Value<'a>> {
    let divisor = call.scalar(0)?;
    divided(call, divisor)
}

fn divided<'a>(call: &mut Call<'_, 'a>, divisor: Expr<'a>) -> Option<Value<'a>> {
    if divisor.is_zero() {
        return call.fail(call.method, "this divides by zero");
    }
    scaled(call.receiver, divisor.recip())
}

fn scale<'a>(call: &mut Call<'_, 'a>) -> Option<Value<'a>> {
    let factor = call.scalar(0)?;
    scaled(call.receiver, factor)
}

fn component_mul<'a>(call: &mut Call<'_, 'a>) -> Option<Value<'a>> {
    let other = call.like_receiver(0)?;
    Some(Value::of_matrix(call.receiver.as_matrix()?.zip(&other, |a, b| a * b)))
}

fn component_div<'a>(call: &mut Call<'_, 'a>) -> Option<Value<'a>> {
    let other = call.like_receiver(0)?;
    if other.entries.iter().any(|entry| entry.is_zero()) {
        return call.fail(call.arguments[0].1, "a component of this is zero");
    }
    Some(Value::of_matrix(call.receiver.as_matrix()?.zip(&other, |a, b| a / b)))
}

fn sum<'a>(call: &mut Call<'_, 'a>) -> Option<Value<'a>> {
    let zero = call.arena.zero();
    Some(Value::Scalar(entries(call)?.iter().fold(zero, |sum, entry| sum + entry)))
}

fn transpose<'a>(call: &mut Call<'_, 'a>) -> Option<Value<'a>> {
    Some(Value::of_matrix(call.receiver.as_matrix()?.transpose()))
}

/// `selfᵀ · other`
fn tr_mul<'a>(call: &mut Call<'_, 'a>) -> Option<Value<'a>> {
    let left = call.receiver.as_matrix()?.transpose();
    let (value, expr) = &call.arguments[0];
    match value.as_matrix() {
        Some(right) if right.rows == left.columns => Some(Value::of_matrix(left.times_matrix(&right))),
        _ => {
            let (rows, found) = (left.columns, value.describe());
            let message =
                format!("`tr_mul` takes a vector or matrix of {rows} rows here, but this is {found}");
            call.fail(expr, message)
        }
    }
}

/// The receiver, which must be a square matrix.
fn square<'a>(call: &mut Call<'_, 'a>) -> Option<Matrix<'a>> {
    match call.receiver.as_matrix() {
        Some(matrix) if matrix.rows == matrix.columns => Some(matrix),
        _ => {
            let found = call.receiver.describe();
            call.fail(call.method, format!("`{}` is for square matrices; this is {found}", call.method))
        }
    }
}

/// The inverse by cofactors, as nalgebra computes it: the adjugate over the determinant. Where the determinant is zero,
/// the entries are not finite.
fn try_inverse<'a>(call: &mut Call<'_, 'a>) -> Option<Value<'a>> {
    let matrix = square(call)?;
    let n = matrix.rows;
    if n > DETERMINANT {
        let message = format!("inverses are supported up to {DETERMINANT} rows");
        return call.fail(call.method, message);
    }
    let adjugate = Matrix::from_fn(n, n, |i, j| cofactor(&matrix, j, i));
    let determinant = matrix.row(0).dot(&adjugate.column(0));
    if determinant.is_zero() {
        return call.fail(call.method, "this matrix is singular");
    }
    Some(Value::Optional(Box::new(Value::of_matrix(adjugate.scale(determinant.recip())))))
}

/// The determinant of what is left of a matrix without a row and a column, with the sign that belongs to their place.
/// Smaller minors that several cofactors have in common are one expression.
fn cofactor<'a>(matrix: &Matrix<'a>, row: usize, column: usize) -> Expr<'a> {
    let kept = |without: usize| (0..matrix.rows).filter(|&k| k != without).collect::<Vec<_>>();
    let minor = matrix.minor(&kept(row), &kept(column));
    if (row + column).is_multiple_of(2) { minor } else { -minor }
}

/// The argument, which must be an index below a bound.
fn place(call: &mut Call<'_, '_>, bound: usize) -> Option<usize> {
    let index = call.integer(0, "")?;
    match usize::try_from(index) {
        Ok(index) if index < bound => Some(index),
        _ => {
            let message = format!("this index is out of range: it goes from 0 to {}", bound - 1);
            call.fail(call.arguments[0].1, message)
        }
    }
}
