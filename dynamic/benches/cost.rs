//! What a system from a text costs: `cargo bench -p coadjoint-dynamic`. From the text to the end of the first step, a step, and a step of a member of
//! an ensemble. The least of several times, on one thread but for ensembles.
#![allow(clippy::unwrap_used)]

use std::sync::Arc;
use std::time::Instant;

use coadjoint::erased::{Ensemble, Stepper, System};
use coadjoint_dynamic::Model;

const HEAVY_TOP: &str =
    "#[lie_poisson_system(group = SO3, advected(gamma: R3), potential = weight * gamma.dot(&chi))]
struct HeavyTop {
    #[inertia]
    inertia: Vector3<f64>,
    weight: f64,
    chi: Vector3<f64>,
}";

/// What this thread has computed for, s: on Linux, of which others on the machine are no part.
fn time(since: Instant) -> f64 {
    let scheduled = std::fs::read_to_string("/proc/thread-self/schedstat");
    let computed = scheduled.ok().and_then(|numbers| numbers.split(' ').next()?.parse::<f64>().ok());
    computed.map_or_else(|| since.elapsed().as_secs_f64(), |time| 1e-9 * time)
}

/// The least time that something takes, s.
fn least(times: usize, mut of: impl FnMut()) -> f64 {
    let since = Instant::now();
    let time = |_| {
        let start = time(since);
        of();
        time(since) - start
    };
    (0..times).map(time).fold(f64::INFINITY, f64::min)
}

/// A system, where it starts, and what is held.
struct Case {
    name: &'static str,
    text: &'static str,
    schemes: &'static [&'static str],
    step: f64,
    parameters: &'static [f64],
    state: &'static [f64],
    control: &'static [f64],
}

const CASES: [Case; 2] = [
    Case {
        name: "heavy top",
        text: HEAVY_TOP,
        schemes: &["Cayley", "Exponential"],
        step: 0.01,
        parameters: &[1.0, 10.0, 100.0, 1.0, 0.0, 0.0, 1.0],
        state: &[1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 1.0],
        control: &[],
    },
    Case {
        name: "navigation",
        text: include_str!("../../systems/src/navigation.rs"),
        schemes: &["Cayley"],
        step: 0.05,
        parameters: &[0.0, 0.0, -9.81, 3e-6, 1e-4],
        #[rustfmt::skip]
        state: &[
            1.0, 0.0, 0.0, 20.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0,
            327.189357188, 189.388918394, 22.7463937203, -0.428688131187, -1.13023148551, 15.5767774406, -0.00714480218944,
            -0.0188371914326, 0.259612957343,
        ],
        control: &[0.0, 0.0, 0.1, 0.0, 2.0, 9.81],
    },
];

fn main() {
    for Case { name, text, schemes, step, parameters, state: first, control } in CASES {
        let first_scheme = schemes[0].parse().unwrap();
        // in a thread of its own the text is read, which this one waits for
        let to_first = (0..9).map(|_| {
            let start = Instant::now();
            let model = Model::from_text(text).unwrap();
            let system: Arc<dyn System> = Arc::new(model.system(parameters));
            let mut stepper = Stepper::new(system, &first_scheme, step).unwrap();
            stepper.step(&mut first.to_vec(), control).unwrap();
            start.elapsed().as_secs_f64()
        });
        println!("{name}: text to first step {:.1} ms", 1e3 * to_first.fold(f64::INFINITY, f64::min));
        let model = Model::from_text(text).unwrap();
        for scheme in schemes {
            let scheme = scheme.parse().unwrap();
            let system: Arc<dyn System> = Arc::new(model.system(parameters));
            let mut stepper = Stepper::new(system, &scheme, step).unwrap();
            let mut state = first.to_vec();
            stepper.steps(&mut state, control, 1_000).unwrap();
            let time = least(8, || _ = stepper.steps(&mut state, control, 200_000).unwrap());
            println!("{name}, {scheme}: {:.0} ns a step", 1e9 * time / 2e5);
            let members = (0..10_000).map(|k| {
                let mut state = first.to_vec();
                *state.last_mut().unwrap() += 1e-5 * f64::from(k);
                (parameters.to_vec(), state)
            });
            let mut ensemble = Ensemble::new(&model.system(parameters), &scheme, members, step).unwrap();
            ensemble.control(|_, _, to| to.copy_from_slice(control));
            ensemble.run(500);
            let time = least(10, || _ = ensemble.run(100));
            println!("{name}, {scheme}: {:.1} ns a step of one of 10,000 members", 1e9 * time / 100.0 / 1e4);
        }
    }
}
