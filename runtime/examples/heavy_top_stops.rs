//! When does a spinning top touch the table? `cargo run --example heavy_top_stops`
//!
//! A terminal event ends the run at that moment, within a step.

use coadjoint::prelude::*;
use coadjoint::{Event, Run};

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

    // until the rim is at the table, but at most a minute
    let mut stepper = top.stepper::<Exponential>(1e-3)?;
    let report = Run::new(&mut stepper, &mut state)
        .event(Event::falling().terminal(), |state, _| clearance(&top, state), |_| {})
        .to(60.0)?;
    assert!(report.stopped, "it falls within a minute");
    assert!(clearance(&top, &state).abs() < 1e-12);

    let (time, now) = (stepper.time(), state);
    println!("the rim touches the table after {time:.6} s, in step {}", report.steps);
    println!("leaning by {:.2}°", now.up.z.acos().to_degrees());
    println!("turning about its axis by {:.1} rad/s", now.momentum.z / about);
    Ok(())
}

#[test]
fn runs() -> Result<(), Box<dyn std::error::Error>> {
    main()
}
