//! Expressions as text, for the intermediate representation and for messages.

use std::fmt;

use super::arena::{Expr, Node};

/// How tightly the surroundings bind.
#[derive(Clone, Copy, PartialEq, PartialOrd)]
enum Binding {
    Sum,
    Product,
    Power,
}

impl fmt::Display for Expr<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write(*self, f, Binding::Sum)
    }
}

fn write(expr: Expr<'_>, f: &mut fmt::Formatter<'_>, around: Binding) -> fmt::Result {
    let arena = expr.arena;
    let parenthesized =
        |f: &mut fmt::Formatter<'_>, needed: bool, inner: &dyn Fn(&mut fmt::Formatter<'_>) -> fmt::Result| {
            if needed {
                f.write_str("(")?;
            }
            inner(f)?;
            if needed { f.write_str(")") } else { Ok(()) }
        };
    match arena.node(expr.id) {
        Node::Number(number) => {
            let needed = around > Binding::Sum && (number.is_negative() || number.to_string().contains('/'));
            parenthesized(f, needed, &|f| write!(f, "{number}"))
        }
        Node::Symbol(symbol) => f.write_str(&arena.symbol_info(symbol).name),
        Node::Sum(sum) => {
            let lone = sum.is_scaled_term();
            let needed = around > if lone { Binding::Product } else { Binding::Sum }
                || (lone && around > Binding::Sum && sum.terms[0].1.is_negative());
            parenthesized(f, needed, &|f| {
                for (i, &(id, coefficient)) in sum.terms.iter().enumerate() {
                    match (i, coefficient.is_negative()) {
                        (0, false) => {}
                        (0, true) => f.write_str("-")?,
                        (_, false) => f.write_str(" + ")?,
                        (_, true) => f.write_str(" - ")?,
                    }
                    let magnitude = coefficient.abs();
                    if !magnitude.is_one() {
                        write!(f, "{magnitude} ")?;
                    }
                    write(arena.expr(id), f, Binding::Product)?;
                }
                if sum.constant.is_zero() {
                    Ok(())
                } else if sum.constant.is_negative() {
                    write!(f, " - {}", sum.constant.abs())
                } else {
                    write!(f, " + {}", sum.constant)
                }
            })
        }
        Node::Product(factors) => parenthesized(f, around > Binding::Product, &|f| {
            for (i, &(id, exponent)) in factors.iter().enumerate() {
                if i > 0 {
                    f.write_str(" ")?;
                }
                write(arena.expr(id), f, Binding::Power)?;
                if exponent != 1 {
                    write!(f, "^{exponent}")?;
                }
            }
            Ok(())
        }),
        Node::Held(inner) => {
            f.write_str("[")?;
            write(arena.expr(inner), f, Binding::Sum)?;
            f.write_str("]")
        }
        Node::Function(function, argument) => {
            write!(f, "{}(", function.name())?;
            write(arena.expr(argument), f, Binding::Sum)?;
            f.write_str(")")
        }
        Node::Power(base, exponent) => {
            write(arena.expr(base), f, Binding::Power)?;
            f.write_str("^(")?;
            write(arena.expr(exponent), f, Binding::Sum)?;
            f.write_str(")")
        }
        Node::Atan2(y, x) => {
            f.write_str("atan2(")?;
            write(arena.expr(y), f, Binding::Sum)?;
            f.write_str(", ")?;
            write(arena.expr(x), f, Binding::Sum)?;
            f.write_str(")")
        }
    }
}
