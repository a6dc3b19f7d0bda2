//! Every entry of the catalogue, run for a while with everything that the program offers.

use std::ops::ControlFlow;

use coadjoint_systems::catalogue::{CATALOGUE, Entry, find};
use coadjoint_systems::ledger::Ledger;
use coadjoint_systems::simulation::{Job, Method, Order, Retraction, Whereabouts};

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
    let run = |method, retraction, order| -> Ledger {
        let job = Job { method, retraction, order, step: entry.step, steps: 500 };
        let mut ledger = None;
        let mut samples = 0;
        let report = (entry.simulate)(&setup, &job, None, &mut |sample| {
            samples += 1;
            assert!(sample.state.iter().all(|x| x.is_finite()), "{name}, {job:?}");
            ledger.get_or_insert_with(|| Ledger::new(sample)).push(sample);
            Ok(ControlFlow::Continue(()))
        })
        .unwrap_or_else(|error| panic!("{name}, {job:?}: {error}"));
        assert_eq!((report.steps, samples), (500, 501), "{name}, {job:?}");
        let ledger = ledger.expect("samples");
        for kept in &ledger.casimirs {
            assert!(kept.error <= 1e-12 * kept.initial.abs().max(1.0), "{name}, {job:?}: {}", kept.error);
        }
        ledger
    };
    for retraction in Retraction::ALL {
        for method in Method::ALL {
            let energy = run(method, retraction, Order::Two).energy;
            let (error, energy) = (energy.error, energy.initial.abs());
            if !entry.autonomous {
                continue;
            }
            let is_standard = (entry.standard)() == method;
            let bound = if method.is_symmetric() || is_standard { SECOND } else { FIRST };
            assert!(error <= bound * energy, "{name}, {method:?}, {retraction:?}: {error} of {energy}");
            if method.is_symmetric() {
                let fourth = run(method, retraction, Order::Four).energy.error;
                // up to roundoff
                let bound = 0.3 * error + 1e-12 * energy;
                assert!(fourth <= bound, "{name}, {method:?}, {retraction:?}: {fourth} instead of {error}");
            }
        }
    }
    for order in [Order::Six, Order::Eight, Order::Ten] {
        run(Method::Standard, Retraction::Exponential, order);
    }
    for (method, order) in [(Method::Standard, Order::Two), (Method::Midpoint, Order::Four)] {
        let job = Job { method, retraction: Retraction::Cayley, order, step: entry.step, steps: 60 };
        comes_to_the_same(entry, &job);
    }
}

/// A run that is interrupted and gone on with, twice, comes to the last bit to where one that was not does, and sees the same.
fn comes_to_the_same(entry: &Entry, job: &Job) {
    let setup = (entry.example)();
    // the samples from `from` to the step `until`, as their bits, and where the run is then
    let run = |from: Option<&Whereabouts>, until: u64| {
        let mut seen = Vec::new();
        let mut whereabouts = Whereabouts::default();
        (entry.simulate)(&setup, job, from, &mut |sample| {
            let numbers = sample.state.iter().chain(sample.casimirs).chain([&sample.time, &sample.energy]);
            seen.push((sample.index, numbers.map(|x| x.to_bits()).collect::<Vec<u64>>()));
            whereabouts = sample.whereabouts();
            Ok(if sample.index < until { ControlFlow::Continue(()) } else { ControlFlow::Break(()) })
        })
        .expect("solvable");
        (seen, whereabouts)
    };
    let (whole, _) = run(None, job.steps);
    let (mut pieces, first) = run(None, 1);
    let (second, middle) = run(Some(&first), 37);
    let (third, _) = run(Some(&middle), job.steps);
    for piece in [second, third] {
        // where it goes on was seen before
        assert_eq!(pieces.last(), piece.first(), "{}, {job:?}", entry.name);
        pieces.extend(piece.into_iter().skip(1));
    }
    assert!(pieces == whole, "{}, {job:?}", entry.name);
}

#[test]
fn compositions_need_symmetric_steps() {
    for entry in CATALOGUE {
        let setup = (entry.example)();
        for method in [Method::EulerA, Method::EulerB] {
            let job =
                Job { method, retraction: Retraction::Cayley, order: Order::Four, step: 0.01, steps: 1 };
            let error = (entry.simulate)(&setup, &job, None, &mut |_| Ok(ControlFlow::Continue(())))
                .expect_err("not symmetric");
            let message = error.to_string();
            assert!(
                message.contains(method.name()) && message.contains("standard, midpoint, verlet"),
                "{message}"
            );
        }
    }
}
