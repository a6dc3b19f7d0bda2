//! When does a spinning top touch the table? `cargo run --example heavy_top_stops`
//!
//! A run ends at the first step after the event. One shorter step from the state before finds the moment itself.

use coadjoint::Run;
use coadjoint::prelude::*;

/// A disc on a stem whose point stays in place; air slows it down: `L' = r × F − friction L` in space.
#[lie_poisson_system(
    group = SO3,
    advected(up: R3),
    potential = weight * length * up.z,
    force = -friction * momentum,
    retractions(Exponential),
)]
struct Top {
    /// About the point of the stem, kg m².
    #[inertia]
    inertia: Vector3<f64>,
    /// N
    weight: f64,
    /// From the point to the disc, m.
    length: f64,
    /// 1/s
    friction: f64,
}

/// Radius of the disc, m.
const RADIUS: f64 = 0.04;

/// How high the lowest point of the rim is above the table, m.
fn clearance(top: &Top, state: &TopState) -> f64 {
    let (cosine, sine) = (state.up.z, state.up.x.hypot(state.up.y));
    top.length * cosine - RADIUS * sine
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (mass, length) = (0.2, 0.05);
    let about = mass * RADIUS * RADIUS / 2.0;
    let across = about / 2.0 + mass * length * length;
    let top = Top { inertia: vector![across, across, about], weight: mass * 9.81, length, friction: 0.02 };
    let attitude = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), 5_f64.to_radians());
    let momentum = vector![0.0, 0.0, about * 200.0];
    let mut state = TopState { attitude, momentum, up: attitude.inverse() * Vector3::z() };

    // until the first step after the touch, but at most a minute
    let step = 1e-3;
    let mut stepper = top.stepper::<Exponential>(step)?;
    let (mut now, mut before) = (state, state);
    let report = Run::new(&mut stepper, &mut state)
        .each(|tick| (before, now) = (now, *tick.state))
        .until(|tick| clearance(tick.system, tick.state) < 0.0)
        .to(60.0)?;
    assert!(report.stopped, "it falls within a minute");

    // the part of a step after which the rim is at the table, by bisection
    let (mut least, mut most) = (0.0, step);
    for _ in 0..50 {
        let part = (least + most) / 2.0;
        now = before;
        top.stepper::<Exponential>(part)?.step(&mut now)?;
        if clearance(&top, &now) > 0.0 { least = part } else { most = part }
    }
    let time = stepper.time() - step + most;
    assert!(clearance(&top, &before) > 0.0 && clearance(&top, &state) < 0.0);
    assert!(clearance(&top, &now).abs() < 1e-12);

    println!("the rim touches the table after {time:.6} s, in step {}", report.steps);
    println!("leaning by {:.2}°", now.up.z.acos().to_degrees());
    println!("turning about its axis by {:.1} rad/s", now.momentum.z / about);
    Ok(())
}

#[test]
fn runs() -> Result<(), Box<dyn std::error::Error>> {
    main()
}
