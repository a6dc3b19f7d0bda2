//! The derivatives of the principal function `R(ḡ, η, t)`, from the motion itself.
//!
//! They are the mean of the momenta at both ends, carried to `ḡ`, and their difference there. So there is a step with
//! forces, too, where there is no such function.

use super::Derivatives;
use super::path::{Given, Motion};
use crate::expr::{Number, Series, Vector};
use crate::method::discretization::Discretization;
use crate::model::System;
use crate::quantity::ScalarType;

pub(super) fn derivatives<'a>(discretization: &Discretization<'_, 'a>, order: usize) -> Derivatives<'a> {
    let Discretization { system, carrying, step, .. } = discretization;
    let (arena, group) = (step.arena(), &system.group);
    let kicked = kicked_rows(system);
    let is_kicked = kicked.contains(&true);
    let top = if is_kicked { order - 1 } else { order - 2 };
    let mut motion = Motion::new(discretization, Given::Velocity);
    // both ends are one function of the step: the other one at `−t`
    let mut end = Series::new(arena);
    for weight in 0..=top {
        motion.advance();
        for (y, velocity) in motion.chart.iter().zip(system.velocity_symbols().iter()) {
            let half = velocity.scale(Number::ratio(1, 2));
            end.push(y, if weight == 1 { vec![half] } else { Vec::new() });
        }
        let momentum = motion.momentum_at_end(weight);
        for (symbol, value) in system.momentum().iter().zip(momentum.iter()) {
            end.push(symbol, vec![value]);
        }
    }
    let back = motion.chart.scale(arena.number(-system.side.sign()));
    let [x, m] = [&back, &system.momentum()].map(|base| discretization.on_the_group(base));
    let mean = group.d_right_dual(carrying.before, &x, &m);
    let carried = group.carry_momentum(carrying.before, &x, &m, &mean).base;
    let zero = arena.zero();
    let mut part = |vector: &Vector<'a>, k: usize| {
        vector.map(|component| end.part(component, k).first().copied().unwrap_or(zero).hold())
    };
    let means: Vec<Vector<'a>> = (0..order - 1).step_by(2).map(|k| part(&mean.base, k)).collect();
    let twice = arena.number(2);
    let mut kick = |k: usize| {
        let carried = part(&carried, k);
        let rows = carried.iter().zip(&kicked);
        Vector(rows.map(|(row, &kicked)| if kicked { row * twice } else { zero }).collect())
    };
    let kicks: Vec<Vector<'a>> = (1..=top).step_by(2).filter(|_| is_kicked).map(&mut kick).collect();
    let square = *step * *step;
    let first: Vec<_> = means.first().into_iter().chain(kicks.first()).collect();
    let is_single = system.scalar == ScalarType::F32;
    let rest = |all: &[Vector<'a>]| {
        let rest: Vec<_> = all.get(1..)?.iter().map(|terms| terms.without_poles(&first, is_single)).collect();
        polynomial(&rest, square).map(|rest| rest.scale(square))
    };
    Derivatives::OfVelocity {
        momentum: means[0].clone(),
        correction: rest(&means),
        kick: kicks.first().cloned(),
        kick_correction: rest(&kicks),
    }
}

/// `c_0 + x c_1 + x² c_2 + …`, if there is anything of it.
fn polynomial<'a>(coefficients: &[Vector<'a>], x: crate::expr::Expr<'a>) -> Option<Vector<'a>> {
    let mut highest_first = coefficients.iter().rev();
    let last = highest_first.next()?.clone();
    Some(highest_first.fold(last, |sum, c| c + &sum.scale(x)))
}

/// The rows of the momentum that something beside the bracket changes.
fn kicked_rows(system: &System<'_>) -> Vec<bool> {
    let mut rows = Vec::new();
    for factor in &system.factors {
        let mut advected = factor.advected.iter();
        let by_advected = advected.any(|a| system.potential().depends_on(&a.value.symbols()));
        rows.extend(vec![by_advected || system.is_kicked(factor); factor.momentum.len()]);
    }
    rows
}
