//! The update of the fixed-point iteration on a step's equation `L x = right(x)`.

use crate::expr::{Expr, Matrix, Vector};
use crate::method::Step;

/// The next iterate: `L⁻¹ right`, or that of the equation without denominators, if there are any. `L` is constant: its inverse is computed once, when
/// the stepper is built.
pub(super) fn update<'a>(step: &Step<'a>, right: &Vector<'a>) -> Vector<'a> {
    let inverse = step.left.jacobian(&step.unknown.symbols()).inverse();
    cleared_update(step, &inverse).unwrap_or_else(|| inverse.map(Expr::hold).times(right))
}

/// The next iterate of the simplified Newton iteration, `x − M⁻¹ (left(x) − right)` with this matrix.
pub(super) fn simplified_newton<'a>(step: &Step<'a>, matrix: &Matrix<'a>, right: &Vector<'a>) -> Vector<'a> {
    &step.unknown - &matrix.clone().map(Expr::hold).solve_apart(&(&step.left - right))
}

/// The next iterate on the equation without denominators, if there are any. Where the right side is `n/(1 + d)`, and
/// `d` zero where the unknown is, so that `(1 + d) L x = n`, it is `L⁻¹ n − d x`. If the derivative of the other update
/// is `J`, its own is `(1 + d) J − d` at the solution, and `d` mostly of the second order: it contracts as strongly,
/// and does not wait for a division, which takes as long as all else. Rows of the equation that `L` couples are to have
/// the same denominator.
fn cleared_update<'a>(step: &Step<'a>, inverse: &Matrix<'a>) -> Option<Vector<'a>> {
    let arena = step.h.arena();
    let symbols = step.unknown.symbols();
    let quotients = step.right.iter().map(|right| right.as_quotient(&symbols));
    let quotients: Vec<(Expr<'a>, Expr<'a>)> = quotients.collect::<Option<_>>()?;
    if quotients.iter().all(|(_, denominator)| *denominator == arena.one()) {
        return None;
    }
    let row = |i: usize| {
        let (_, denominator) = quotients[i];
        let mut sum = arena.zero();
        for (j, (numerator, other)) in quotients.iter().enumerate() {
            if inverse.at(i, j).is_zero() {
                continue;
            }
            if *other != denominator {
                return None;
            }
            let (number, numerator) = numerator.split_number();
            sum = sum + inverse.at(i, j).scale(number).hold() * numerator.hold();
        }
        let is_one_at_zero = Vector(vec![denominator]).at_zero(&symbols).0[0] == arena.one();
        is_one_at_zero.then(|| sum - (denominator - 1).hold() * step.unknown.0[i])
    };
    Some(Vector((0..symbols.len()).map(row).collect::<Option<_>>()?))
}
