//! Tables: cubic splines through the values of an array.
//!
//! Knots are one apart in `u`. With `m` for second derivatives, `m₀ = mₙ = 0` and
//! `m_{k−1} + 4 m_k + m_{k+1} = 6 (y_{k−1} − 2 y_k + y_{k+1})`; between knots, with `w = u − k`,
//! `s = y_k + w (y_{k+1} − y_k − (2 m_k + m_{k+1})/6 + w (m_k/2 + w (m_{k+1} − m_k)/6))`. Since the second derivative is
//! zero at the ends, straight lines go on from there with two continuous derivatives. What is chosen by `u` are the
//! coefficients: these are made of parameters, and computed once.

use syn::{Expr, Ident};

use super::lowering::Lowering;
use super::value::Value;
use crate::expr::{Expr as Symbolic, Number};

/// Where a piece begins, and its coefficients from there on.
type Piece<'a> = [Symbolic<'a>; 5];

impl<'a> Lowering<'a, '_> {
    /// `values.spline(from, to, x)`
    pub(super) fn spline(
        &mut self,
        values: &[Value<'a>],
        arguments: [&Expr; 3],
        method: &Ident,
    ) -> Option<Value<'a>> {
        let scalars: Option<Vec<_>> = values.iter().map(|value| value.as_scalar(self.arena)).collect();
        let Some(y) = scalars.filter(|values| values.len() > 1) else {
            return self.fail(method, "a spline goes through an array of two numbers or more");
        };
        let [from, to, x] = arguments.map(|argument| {
            let value = self.lower(argument)?;
            let message = || format!("`spline` takes numbers, but this is {}", value.describe());
            value.as_scalar(self.arena).or_else(|| self.fail(argument, message()))
        });
        let (from, to, x) = (from?, to?, x?);
        if (to - from).as_number().is_some_and(|length| length.is_zero()) {
            let message = "the last knot lies where the first one does: values stand at equal distances from the one to the other, and straight \
                           lines go on beyond";
            return self.fail(arguments[1], message);
        }
        let u = (x - from) * y.len().saturating_sub(1) as i64 / (to - from);
        let [start, c0, c1, c2, c3] = chosen(u, &pieces(&y), 0);
        let w = u - start;
        Some(Value::Scalar(c0 + w * (c1 + w * (c2 + w * c3))))
    }
}

/// The straight line before the first knot, the cubics between knots, and the straight line behind the last.
fn pieces<'a>(y: &[Symbolic<'a>]) -> Vec<Piece<'a>> {
    let (arena, last) = (y[0].arena(), y.len() - 1);
    let (zero, place) = (arena.zero(), |k: usize| arena.number(k as i64));
    // elimination: m_k + r_k m_{k+1} = d_k
    let (mut r, mut d) = (vec![Number::ZERO], vec![zero]);
    for k in 1..last {
        let factor = (Number::from(4) + -r[k - 1]).powi(-1);
        let rest = (y[k - 1] - y[k] * 2 + y[k + 1]) * 6 - d[k - 1];
        r.push(factor);
        d.push(rest.scale(factor).hold());
    }
    let mut m = vec![zero; y.len()];
    for k in (1..last).rev() {
        m[k] = (d[k] - m[k + 1].scale(r[k])).hold();
    }
    let slope = |k: usize| (y[k + 1] - y[k] - (m[k] * 2 + m[k + 1]) / 6).hold();
    let cubic = |k: usize| [place(k), y[k], slope(k), m[k] / 2, ((m[k + 1] - m[k]) / 6).hold()];
    let end = (y[last] - y[last - 1] + m[last - 1] / 6).hold();
    let lines = [[zero, y[0], slope(0), zero, zero], [place(last), y[last], end, zero, zero]];
    lines[..1].iter().copied().chain((0..last).map(cubic)).chain(lines[1..].iter().copied()).collect()
}

/// The piece that `u` lies in, of some that follow one another; the first ends at a whole number, the others behind it.
fn chosen<'a>(u: Symbolic<'a>, pieces: &[Piece<'a>], end: i64) -> Piece<'a> {
    let middle = pieces.len() / 2;
    if middle == 0 {
        return pieces[0];
    }
    let border = end + middle as i64 - 1;
    let (before, behind) = (chosen(u, &pieces[..middle], end), chosen(u, &pieces[middle..], border + 1));
    std::array::from_fn(|k| (u - border).choose(before[k], behind[k]))
}
