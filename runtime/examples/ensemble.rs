//! A thousand satellites that tumble: `cargo run --release --example ensemble`
//!
//! The inertia is known to a percent and the release is not quite clean. How well is it known where the satellite points?

use std::ops::ControlFlow;

use coadjoint::Ensemble;
use coadjoint::ensemble::normal;
use coadjoint::prelude::*;

/// A satellite on which nothing acts.
#[lie_poisson_system(group = SO3, retractions(Exponential))]
struct Satellite {
    /// Principal moments of inertia, kg m².
    #[inertia]
    inertia: Vector3<f64>,
}

const MEMBERS: usize = 1_000;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let nominal = Satellite { inertia: vector![8.0, 12.0, 15.0] };
    let release = SatelliteState {
        attitude: UnitQuaternion::identity(),
        momentum: nominal.inertia.component_mul(&vector![0.001, 0.1, 0.001]), // about the middle axis, rad/s
    };

    // each member has an inertia of its own, up to a percent to either side …
    let percent = |member: usize, axis: usize| ((member * [7, 11, 13][axis]) % 201) as f64 / 100.0 - 1.0;
    let members: Vec<_> = (0..MEMBERS)
        .map(|member| {
            let factor = Vector3::from_fn(|axis, _| 1.0 + 0.01 * percent(member, axis));
            Satellite { inertia: nominal.inertia.component_mul(&factor) }
        })
        .collect();
    // … and a release of its own: half a degree and 0.01 kg m²/s about each axis
    let half_a_degree = 0.5_f64.to_radians();
    let deviations = [half_a_degree, half_a_degree, half_a_degree, 0.01, 0.01, 0.01];
    let releases = (0..MEMBERS).map(normal(&nominal, release, deviations, 2026));

    let mut ensemble = Ensemble::<_, Exponential>::new(&members, releases, 0.05)?;
    let before: Vec<_> = ensemble.states().map(|state| state.attitude * state.momentum).collect();

    // the angle between the antenna, along the third axis, and where it pointed first
    let angle = |_: &Satellite, state: &SatelliteState| {
        (state.attitude * Vector3::z()).dot(&Vector3::z()).clamp(-1.0, 1.0).acos().to_degrees()
    };
    let mut antenna = Vec::new();
    ensemble.run_observed(2_400, 300, |satellites| {
        antenna.push(satellites.spread(angle));
        ControlFlow::Continue(())
    });

    println!("   time      median     from 5 %     to 95 %   of {MEMBERS} satellites: the antenna's angle");
    for spread in antenna {
        let [_, low, _, median, _, high, _] = spread.quantiles;
        println!("{:5.0} s {median:10.1}° {low:11.1}° {high:10.1}°", spread.time);
    }
    let drift = ensemble
        .states()
        .zip(&before)
        .map(|(state, momentum)| (state.attitude * state.momentum - momentum).norm())
        .fold(0.0, f64::max);
    println!("angular momentum in space, the worst member: changed by {drift:.0e} kg m²/s");
    assert!(ensemble.failed().is_empty());
    assert!(drift < 1e-12);
    Ok(())
}

#[test]
fn runs() -> Result<(), Box<dyn std::error::Error>> {
    main()
}
