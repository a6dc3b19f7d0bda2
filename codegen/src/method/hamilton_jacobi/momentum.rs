//! The derivatives of `S(ḡ, m̄, t)`, by differentiation.
//!
//! `S` is the extreme value of
//!
//! ```text
//! ⟨m̄, η⟩ − ∫ ⟨μ, dL τ_y y'⟩ − h(ḡ τ(y), μ) dτ
//! ```
//!
//! over paths `y`, `μ` with `y(±t/2) = ±η/2`. So a path that is off by a term of weight `k` gives an `S` that is off by one
//! of twice that: for order `p` it needs the motion up to weight `(p − 2)/2`.

use super::Derivatives;
use super::path::{Given, Motion, mean_over_step};
use crate::expr::{Expr, Vector, gradient};
use crate::group::SemidirectVector;
use crate::method::discretization::{Discretization, bind};

pub(super) fn derivatives<'a>(discretization: &Discretization<'_, 'a>, order: usize) -> Derivatives<'a> {
    let Discretization { system, step, .. } = discretization;
    let (arena, group) = (step.arena(), &system.group);
    let by_momentum = system.by_momentum();
    let h = function(&Discretization { system: &by_momentum, ..discretization.clone() }, order);
    let h = h.multiplied_out().unwrap_or(h);
    let velocity = gradient(h, &system.momentum().symbols());
    let g = system.configuration();
    let by_configuration = h.depends_on(&g.symbols()).then(|| {
        let df = gradient(h, &g.symbols());
        -&group.trivialized_gradient(system.side, &g, &df)
    });
    let spaces: Vec<Vector<'a>> = system.advected().map(|a| gradient(h, &a.value.symbols())).collect();
    let by_advected = spaces.iter().any(|a| a.iter().any(|a| !a.is_zero())).then(|| {
        let velocity = SemidirectVector { base: Vector::zeros(arena, system.dimension()), spaces };
        let velocity = velocity.scale(arena.number(system.side.sign()));
        group.coadjoint(&velocity, &system.momentum_and_advected()).base
    });
    let kick = match (by_configuration, by_advected) {
        (Some(one), Some(other)) => Some(&one + &other),
        (one, other) => one.or(other),
    };
    Derivatives::OfMomentum { velocity, kick }
}

/// `S/t`
fn function<'a>(discretization: &Discretization<'_, 'a>, order: usize) -> Expr<'a> {
    let Discretization { system, moving, carrying, step, .. } = discretization;
    let (arena, group) = (step.arena(), &system.group);
    let zero = arena.zero();
    let mut motion = Motion::new(discretization, Given::Momentum);
    for _ in 0..order / 2 {
        motion.advance();
    }
    let top = order - 2;
    motion.stop(top);

    // along the path, where configuration and advected parameters are what `y` makes of them
    let g = system.configuration();
    let mut along = Vec::new();
    let increment = group.retract(moving.behind, &motion.chart);
    // in symbols of their own, for those of the state change along the path
    let copies =
        |vector: &Vector<'a>| vector.map(|x| arena.symbol(x.to_string(), crate::expr::Stage::Iteration));
    let (fixed_g, fixed_m) = (copies(&g), copies(&system.momentum()));
    bind(&mut along, &g, &group.compose(system.side, &fixed_g, &increment));
    let signed = motion.chart.scale(arena.number(system.side.sign()));
    let fixed_a: Vec<Vector<'a>> = system.advected_values().iter().map(copies).collect();
    let a = group.carry(carrying.behind, &signed, &fixed_a);
    for (advected, value) in system.advected().zip(&a) {
        bind(&mut along, &advected.value, value);
    }
    let energy = system.energy().substitute(&along);
    let momentum = system.momentum();
    let turned = &discretization.carried_velocity(&motion.chart, &motion.rate) - &motion.rate;
    let integrand = energy - (&momentum - &fixed_m).dot(&motion.rate) - momentum.dot(&turned);
    let mut back = Vec::new();
    bind(&mut back, &fixed_g, &g);
    bind(&mut back, &fixed_m, &momentum);
    for (fixed, advected) in fixed_a.iter().zip(system.advected()) {
        bind(&mut back, fixed, &advected.value);
    }
    let terms = (0..=top).step_by(2).map(|weight| {
        let part = motion.series.part(integrand, weight);
        mean_over_step(&part, weight, zero).substitute(&back).hold()
    });
    let terms: Vec<Expr<'a>> = terms.collect();
    let square = *step * *step;
    let mut highest_first = terms.into_iter().rev();
    let last = highest_first.next().unwrap_or(zero);
    highest_first.fold(last, |sum, term| term + sum * square)
}
