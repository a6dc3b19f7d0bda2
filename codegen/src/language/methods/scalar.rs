//! Methods of scalars, as `f64` has them.

use super::super::choice::{greatest, least};
use super::super::value::Value;
use super::{Call, Method, method};
use crate::expr::{Expr, Function, Number};
use crate::limits;

pub(super) static METHODS: &[Method] = &[
    method("sqrt", &[], |call| elementary(call, Function::Sqrt)),
    method("powi", &["n"], |call| {
        let exponent = call.integer(0, "; for other exponents there is `powf`")?;
        integer_power(call, exponent)
    }),
    method("powf", &["x"], powf),
    method("recip", &[], |call| integer_power(call, -1)),
    method("exp", &[], |call| elementary(call, Function::Exp)),
    method("ln", &[], |call| elementary(call, Function::Ln)),
    method("sin", &[], |call| elementary(call, Function::Sin)),
    method("cos", &[], |call| elementary(call, Function::Cos)),
    method("sin_cos", &[], |call| {
        let angle = receiver(call)?;
        let values = [Function::Sin, Function::Cos].map(|function| Value::Scalar(angle.apply(function)));
        Some(Value::Tuple(values.to_vec()))
    }),
    method("tan", &[], |call| elementary(call, Function::Tan)),
    method("asin", &[], |call| elementary(call, Function::Asin)),
    method("acos", &[], |call| elementary(call, Function::Acos)),
    method("atan", &[], |call| elementary(call, Function::Atan)),
    method("atan2", &["x"], |call| Some(Value::Scalar(receiver(call)?.atan2(call.scalar(0)?)))),
    method("sinh", &[], |call| elementary(call, Function::Sinh)),
    method("cosh", &[], |call| elementary(call, Function::Cosh)),
    method("tanh", &[], |call| elementary(call, Function::Tanh)),
    method("hypot", &["x"], |call| {
        let (a, b) = (receiver(call)?, call.scalar(0)?);
        Some(Value::Scalar((a * a + b * b).sqrt()))
    }),
    method("abs", &[], |call| {
        let x = receiver(call)?;
        Some(Value::Scalar(x.choose(-x, x)))
    }),
    method("signum", &[], |call| {
        let (x, one) = (receiver(call)?, call.arena.one());
        Some(Value::Scalar(x.choose(-one, one)))
    }),
    method("min", &["x"], |call| Some(Value::Scalar(least(receiver(call)?, call.scalar(0)?)))),
    method("max", &["x"], |call| Some(Value::Scalar(greatest(receiver(call)?, call.scalar(0)?)))),
    method("clamp", &["min", "max"], |call| {
        let (lower, upper) = (call.scalar(0), call.scalar(1));
        let (lower, upper) = (lower?, upper?);
        if (upper - lower).as_number().is_some_and(|room| room.is_negative()) {
            return call.fail(call.method, "the lower limit is above the upper one");
        }
        Some(Value::Scalar(least(greatest(receiver(call)?, lower), upper)))
    }),
    method("mul_add", &["a", "b"], |call| {
        let (factor, summand) = (call.scalar(0), call.scalar(1));
        Some(Value::Scalar(receiver(call)? * factor? + summand?))
    }),
];

fn receiver<'a>(call: &Call<'_, 'a>) -> Option<Expr<'a>> {
    call.receiver.as_scalar(call.arena)
}

fn elementary<'a>(call: &mut Call<'_, 'a>, function: Function) -> Option<Value<'a>> {
    let argument = receiver(call)?;
    if let Some(number) = argument.as_number()
        && !defined(function, number)
    {
        return call.fail(call.method, format!("`{}` is not a real number at {number}", call.method));
    }
    Some(Value::Scalar(argument.apply(function)))
}

/// Whether a function has a finite real value at a constant.
fn defined(function: Function, at: Number) -> bool {
    let at = at.to_f64();
    match function {
        Function::Sqrt => at >= 0.0,
        Function::Ln => at > 0.0,
        Function::Asin | Function::Acos => at.abs() <= 1.0,
        _ => true,
    }
}

fn powf<'a>(call: &mut Call<'_, 'a>) -> Option<Value<'a>> {
    let (base, exponent) = (receiver(call)?, call.scalar(0)?);
    let Some(number) = exponent.as_number() else { return Some(Value::Scalar(base.pow(exponent))) };
    let value = number.to_f64();
    if value.fract() == 0.0 && value.abs() <= f64::from(i32::MAX) {
        return integer_power(call, value as i64);
    }
    if value.abs() > f64::from(limits::EXPONENT) {
        return too_high(call);
    }
    if base.as_number().is_some_and(|base| base.is_negative() || base.is_zero()) {
        return call.fail(call.method, "a power that is not whole needs a positive base");
    }
    Some(Value::Scalar(base.pow(exponent)))
}

fn integer_power<'a>(call: &mut Call<'_, 'a>, exponent: i64) -> Option<Value<'a>> {
    let base = receiver(call)?;
    match i32::try_from(exponent) {
        Ok(exponent) if exponent.unsigned_abs() <= limits::EXPONENT => {
            if base.is_zero() && exponent < 0 {
                return call.fail(call.method, "this divides by zero");
            }
            Some(Value::Scalar(base.powi(exponent)))
        }
        _ => too_high(call),
    }
}

fn too_high<'a>(call: &mut Call<'_, 'a>) -> Option<Value<'a>> {
    let message = format!("this exponent is too large; the largest is {}", limits::EXPONENT);
    call.fail(call.arguments[0].1, message)
}
