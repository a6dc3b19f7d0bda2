//! A momentum that no closed form gives the velocity of: points near the speed of light, over many steps.

use coadjoint::composition::Order6;
use coadjoint::prelude::*;

/// A point whose momentum is that of special relativity, in units of the speed of light.
#[lie_poisson_system(
    group = R2,
    lagrangian = -mass * (1.0 - velocity.norm_squared()).sqrt() - stiffness * position.norm_squared() / 2.0,
)]
struct Relativistic {
    mass: f64,
    stiffness: f64,
}

/// The energy is kept near the speed of light, where the fixed-point iteration has no part in it.
#[test]
fn the_energy_is_kept_near_the_speed_of_light() {
    let point = Relativistic { mass: 2.0, stiffness: 1.0 };
    let rest = RelativisticState { position: vector![0.3, -0.1], momentum: vector![0.0, 0.0] };
    let mut state = point.with_velocity(&rest, &vector![0.0, 0.99]).expect("slower than light");
    let before = point.energy(&state);
    let mut stepper = point.stepper::<Order6<Exponential>>(0.05).expect("a stepper");
    for _ in 0..20_000 {
        stepper.step(&mut state).expect("a step");
    }
    assert!((point.energy(&state) - before).abs() < 1e-6 * before, "{:e}", point.energy(&state) - before);
}
