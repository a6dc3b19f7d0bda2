//! Every entry of the catalogue, run for a while with everything that the program offers.

use coadjoint_systems::catalogue::{CATALOGUE, find};
use coadjoint_systems::simulation::{Job, Method, Order, Outcome, Retraction};

/// The largest energy error relative to the energy that steps of order 2 may make.
const SECOND: f64 = 5e-3;
/// That steps of order 1 may make.
const FIRST: f64 = 0.1;

macro_rules! entries {
    ($($name:ident)*) => {
        $(
            #[test]
            fn $name() {
                examine(stringify!($name));
            }
        )*

        #[test]
        fn no_entry_is_left_out() {
            let names: Vec<&str> = CATALOGUE.iter().map(|entry| entry.name).collect();
            assert_eq!(names, [$(stringify!($name)),*]);
        }
    };
}

entries! {
    harmonic_oscillator
    kepler
    planar_pendulum
    driven_pendulum
    spherical_pendulum
    free_rigid_body
    full_rigid_body
    heavy_top
    lagrange_top
    kovalevskaya_top
    magnetic_top
    quadrotor
    loose_quadrotor
    rigid_body_in_space
    gyrostat
    coupled_bodies
    kirchhoff
}

fn examine(name: &str) {
    let entry = find(name).expect("it is there");
    let setup = (entry.example)();
    let run = |method, retraction, order| -> Outcome {
        let job = Job { method, retraction, order, step: entry.step, steps: 500 };
        let mut samples = 0;
        let outcome = (entry.simulate)(&setup, &job, &mut |sample| {
            samples += 1;
            assert!(sample.state.iter().all(|x| x.is_finite()), "{name}, {job:?}");
            Ok(())
        })
        .unwrap_or_else(|error| panic!("{name}, {job:?}: {error}"));
        assert_eq!((outcome.run.steps, samples), (500, 501), "{name}, {job:?}");
        for (initially, drift) in outcome.casimirs.iter().zip(&outcome.casimir_drifts) {
            assert!(*drift <= 1e-12 * initially.abs().max(1.0), "{name}, {job:?}: {drift}");
        }
        outcome
    };
    for retraction in Retraction::ALL {
        for method in Method::ALL {
            let error = run(method, retraction, Order::Two).energy_error;
            if !entry.autonomous {
                continue;
            }
            let energy = run(method, retraction, Order::Two).energy.abs();
            let is_standard = (entry.standard)() == method;
            let bound = if method.is_symmetric() || is_standard { SECOND } else { FIRST };
            assert!(error <= bound * energy, "{name}, {method:?}, {retraction:?}: {error} of {energy}");
            if method.is_symmetric() {
                let fourth = run(method, retraction, Order::Four).energy_error;
                // up to roundoff
                let bound = 0.3 * error + 1e-12 * energy;
                assert!(fourth <= bound, "{name}, {method:?}, {retraction:?}: {fourth} instead of {error}");
            }
        }
    }
    for order in [Order::Six, Order::Eight, Order::Ten] {
        run(Method::Standard, Retraction::Exponential, order);
    }
}

#[test]
fn compositions_need_symmetric_steps() {
    for entry in CATALOGUE {
        let setup = (entry.example)();
        for method in [Method::EulerA, Method::EulerB] {
            let job =
                Job { method, retraction: Retraction::Cayley, order: Order::Four, step: 0.01, steps: 1 };
            let error = (entry.simulate)(&setup, &job, &mut |_| Ok(())).expect_err("not symmetric");
            let message = error.to_string();
            assert!(
                message.contains(method.name()) && message.contains("standard, midpoint, verlet"),
                "{message}"
            );
        }
    }
}
