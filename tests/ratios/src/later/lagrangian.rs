//! A system with a Lagrangian, whose mass matrix depends on the configuration: the double pendulum.

use crate::case::{Case, ensembles, three_ways};
use coadjoint::prelude::*;

#[lie_poisson_system(
    group(first: SO2, second: SO2),
    lagrangian = {
        let (upper, lower) = (first_velocity.x, second_velocity.x);
        let between = first.inverse() * second;
        let kinetic = (upper_mass + lower_mass) * upper_length.powi(2) * upper.powi(2) / 2.0
            + lower_mass * lower_length.powi(2) * lower.powi(2) / 2.0
            + lower_mass * upper_length * lower_length * upper * lower * between.cos_angle();
        let potential = -(upper_mass + lower_mass) * gravity * upper_length * first.cos_angle()
            - lower_mass * gravity * lower_length * second.cos_angle();
        kinetic - potential
    },
)]
#[derive(Clone, Debug, PartialEq)]
struct DoublePendulum {
    upper_mass: f64,
    lower_mass: f64,
    upper_length: f64,
    lower_length: f64,
    gravity: f64,
}

pub(crate) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    let pendulum = DoublePendulum {
        upper_mass: 1.0,
        lower_mass: 0.8,
        upper_length: 1.0,
        lower_length: 0.7,
        gravity: 9.81,
    };
    let state = DoublePendulumState {
        first: UnitComplex::new(1.2),
        first_momentum: vector![0.0],
        second: UnitComplex::new(0.4),
        second_momentum: vector![0.3],
    };
    let none = NoControl::default();
    three_ways!(cases, "double pendulum, Cayley", Cayley, &pendulum, &state, &none);
    three_ways!(cases, "double pendulum, exponential", Exponential, &pendulum, &state, &none);
    let member = |k| {
        let second_momentum = vector![0.3 + 1e-3 * k as f64];
        DoublePendulumState { second_momentum, ..state.clone() }
    };
    cases.extend(ensembles::<_, Cayley>("double pendulum, Cayley", &pendulum, member, 0.01));
    cases
}
