//! Literals, and integers turned into scalars.

use syn::{ExprCast, Lit, Type};

use super::choice;
use super::lowering::Lowering;
use super::value::Value;
use crate::expr::Number;
use crate::parse::scalar_named;
use crate::quantity::ScalarType;

impl<'a> Lowering<'a, '_> {
    pub(super) fn literal(&mut self, literal: &Lit) -> Option<Value<'a>> {
        // a compiler says so too, but there is none where a text is read
        if let Some((digits, suffix)) = unknown_suffix(literal) {
            let message = format!(
                "`{suffix}` is no suffix of a number: a product is written `{digits} * {suffix}`; units stand in `#[unit(\"…\")]`"
            );
            return self.fail(literal, message);
        }
        match literal {
            Lit::Int(integer) if scalar_named(integer.suffix()).is_some() => {
                self.decimal(integer.base10_digits(), literal)
            }
            Lit::Int(integer) => {
                let message = "this integer is too large; write it as a float, such as `1e30`";
                integer.base10_parse().ok().map(Value::Integer).or_else(|| self.fail(integer, message))
            }
            Lit::Float(float) => self.decimal(float.base10_digits(), float),
            Lit::Bool(truth) => Some(Value::Truth(choice::known(self.arena, truth.value))),
            _ => self.fail(literal, "only numbers can be written here"),
        }
    }

    fn decimal(&mut self, digits: &str, literal: impl quote::ToTokens) -> Option<Value<'a>> {
        let number = match digits.parse::<f64>() {
            // so small or so large that the exact value is beyond representation
            Ok(0.0) => Some(Number::ZERO),
            Ok(value) if !value.is_finite() => None,
            _ => Number::parse(digits),
        };
        let value = number.map(|number| Value::Scalar(self.arena.number(number)));
        value.or_else(|| self.fail(literal, "this number is too large"))
    }

    /// `integer as f64`, `integer as i32`
    pub(super) fn cast(&mut self, cast: &ExprCast) -> Option<Value<'a>> {
        let value = self.lower(&cast.expr)?;
        match (value, float_type(&cast.ty)) {
            (Value::Integer(integer), Some(_)) => Some(Value::Scalar(self.arena.number(integer))),
            (Value::Integer(integer), None) if holds(&cast.ty, integer) => Some(Value::Integer(integer)),
            (_, Some(_)) => {
                // a cast between f32 and f64 rounds, which has no symbolic meaning
                self.fail(cast.as_token, "only integers can be cast; this needs no cast")
            }
            (_, None) => {
                let message =
                    "only casts to `f64` and `f32` are supported, and of integers to `i32` and `usize`";
                self.fail(&cast.ty, message)
            }
        }
    }
}

/// The digits and the suffix of a number of which no type has the name of its suffix.
fn unknown_suffix(literal: &Lit) -> Option<(&str, &str)> {
    let (digits, suffix) = match literal {
        Lit::Int(number) => (number.base10_digits(), number.suffix()),
        Lit::Float(number) => (number.base10_digits(), number.suffix()),
        _ => return None,
    };
    let is_integer = matches!(literal, Lit::Int(_)) && INTEGERS.contains(&suffix);
    (!suffix.is_empty() && !is_integer && scalar_named(suffix).is_none()).then_some((digits, suffix))
}

/// The types of integers that Rust has.
const INTEGERS: [&str; 12] =
    ["i8", "i16", "i32", "i64", "i128", "isize", "u8", "u16", "u32", "u64", "u128", "usize"];

/// Whether a type of integers holds this one.
fn holds(ty: &Type, integer: i64) -> bool {
    let Type::Path(path) = ty else { return false };
    match path.path.get_ident().map(ToString::to_string).as_deref() {
        Some("i32") => i32::try_from(integer).is_ok(),
        Some("usize") => integer >= 0,
        _ => false,
    }
}

fn float_type(ty: &Type) -> Option<ScalarType> {
    match ty {
        Type::Path(path) if path.qself.is_none() => scalar_named(&path.path.get_ident()?.to_string()),
        _ => None,
    }
}
