//! A satellite turns by 60° with its reaction wheels: `cargo run --example satellite_with_wheels`
//!
//! Only motors act, between body and wheels. The total angular momentum in space is constant, whatever the control law does.

use coadjoint::Run;
use coadjoint::prelude::*;

/// A satellite with three reaction wheels along its principal axes.
///
/// `attitude_momentum` is the momentum of body and wheels together. `wheels` are the angles of the wheels, `wheels_momentum` the angular
/// momenta of the wheels about their axes: `Π = I ω + h` and `h' = motors`, while `R Π` is constant.
#[lie_poisson_system(
    group(attitude: SO3, wheels: R3),
    hamiltonian = {
        let body = attitude_momentum - wheels_momentum;
        body.dot(&body.component_div(&inertia)) / 2.0 + wheels_momentum.norm_squared() / (2.0 * wheel_inertia)
    },
    control(motors: R3),
    force(wheels = motors),
    retractions(Exponential),
)]
struct Satellite {
    /// Of all but the turning of the wheels about their axes, kg m².
    inertia: Vector3<f64>,
    /// Of a wheel about its axis, kg m².
    wheel_inertia: f64,
}

impl Satellite {
    /// The angular velocity of the body, rad/s.
    fn rate(&self, state: &SatelliteState) -> Vector3<f64> {
        (state.attitude_momentum - state.wheels_momentum).component_div(&self.inertia)
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let satellite = Satellite { inertia: vector![12.0, 14.0, 9.0], wheel_inertia: 2e-3 };
    let mut state = SatelliteState {
        attitude: UnitQuaternion::identity(),
        attitude_momentum: vector![0.03, -0.05, 0.04],
        wheels: Vector3::zeros(),
        wheels_momentum: vector![0.03, -0.05, 0.04], // the body is at rest, the wheels turn
    };
    let target = UnitQuaternion::new(60_f64.to_radians() * vector![0.6, 0.0, 0.8]);
    let error = |state: &SatelliteState| (target.inverse() * state.attitude).scaled_axis();
    let momentum_in_space = state.attitude * state.attitude_momentum;

    // proportional to angle and rate; what the wheels gain, the body loses
    let law = |state: &SatelliteState, _time: f64| SatelliteControl {
        motors: (0.02 * error(state) + 0.2 * satellite.rate(state)).component_mul(&satellite.inertia),
    };

    println!("   time     angle to go         rate     wheel speeds about x, y, z");
    let mut stepper = satellite.stepper::<Exponential>(0.1)?;
    Run::new(&mut stepper, &mut state)
        .controlled_by(law)
        .every(100, |tick| {
            let angle = error(tick.state).norm().to_degrees();
            let rate = satellite.rate(tick.state).norm().to_degrees();
            let speeds = tick.state.wheels_momentum / satellite.wheel_inertia;
            println!(
                "{:5.0} s {angle:13.4}° {rate:10.4}°/s {:8.1} {:8.1} {:8.1} rad/s",
                tick.time, speeds.x, speeds.y, speeds.z
            );
        })
        .to(120.0)?;

    let drift = (state.attitude * state.attitude_momentum - momentum_in_space).norm();
    println!("total angular momentum in space: changed by {drift:.0e} kg m²/s");
    assert!(error(&state).norm() < 1e-3);
    assert!(satellite.rate(&state).norm() < 1e-4);
    assert!(drift < 1e-14);
    Ok(())
}

#[test]
fn runs() -> Result<(), Box<dyn std::error::Error>> {
    main()
}
