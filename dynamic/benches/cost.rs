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
const NAVIGATION: &str = include_str!("../../systems/src/navigation.rs");

/// The least time that something takes, s.
fn least(times: usize, mut of: impl FnMut()) -> f64 {
    let time = |_| {
        let start = Instant::now();
        of();
        start.elapsed().as_secs_f64()
    };
    (0..times).map(time).fold(f64::INFINITY, f64::min)
}

/// Parameters, and a state in which the configuration is the identity and everything else moves.
fn start(model: &Model) -> (Vec<f64>, Vec<f64>) {
    let description = model.description();
    let parameters = description.parameters.iter().flat_map(|one| one.components);
    let parameters: Vec<f64> = parameters.zip(1..).map(|(_, k)| 1.0 + 0.1 * f64::from(k)).collect();
    let system = model.system(&parameters);
    let length = description.state.iter().map(|one| one.components.len()).sum();
    let mut state = vec![0.0; length];
    let mut place = 0;
    for quantity in description.state {
        for k in 0..quantity.components.len() {
            state[place + k] = match (quantity.role, quantity.kind) {
                (coadjoint::Role::Configuration, coadjoint::Kind::Matrix(_, n)) => {
                    f64::from(u8::from(k % (n + 1) == 0))
                }
                (coadjoint::Role::Configuration, _) => f64::from(u8::from(k == 0)),
                _ => 0.1 + 0.05 * k as f64,
            };
        }
        place += quantity.components.len();
    }
    let system: &dyn System = &system;
    assert!(system.deviation(&state) < 1e-12);
    (parameters, state)
}

fn main() {
    for (name, text, schemes) in
        [("heavy top", HEAVY_TOP, &["Cayley", "Exponential"][..]), ("navigation", NAVIGATION, &["Cayley"])]
    {
        let model = Model::from_text(text).unwrap();
        let (parameters, first) = start(&model);
        let controls = vec![0.1; model.description().controls.iter().map(|one| one.components.len()).sum()];
        let scheme = schemes[0].parse().unwrap();
        let to_first = least(9, || {
            let model = Model::from_text(text).unwrap();
            let system: Arc<dyn System> = Arc::new(model.system(&parameters));
            let mut stepper = Stepper::new(system, &scheme, 0.01).unwrap();
            stepper.step(&mut first.clone(), &controls).unwrap();
        });
        println!("{name}: text to first step {:.1} ms", 1e3 * to_first);
        for scheme in schemes {
            let scheme = scheme.parse().unwrap();
            let system: Arc<dyn System> = Arc::new(model.system(&parameters));
            let mut stepper = Stepper::new(system, &scheme, 0.01).unwrap();
            let mut state = first.clone();
            stepper.steps(&mut state, &controls, 1_000).unwrap();
            let time = least(20, || _ = stepper.steps(&mut state, &controls, 5_000).unwrap());
            println!("{name}, {scheme}: {:.0} ns a step", 1e9 * time / 5e3);
            let members = (0..10_000).map(|k| {
                let mut state = first.clone();
                *state.last_mut().unwrap() += 1e-5 * f64::from(k);
                (parameters.clone(), state)
            });
            let mut ensemble = Ensemble::new(&model.system(&parameters), &scheme, members, 0.01).unwrap();
            ensemble.control(|_, _, to| to.copy_from_slice(&controls));
            ensemble.run(30);
            let time = least(5, || _ = ensemble.run(20));
            println!("{name}, {scheme}: {:.1} ns a step of one of 10,000 members", 1e9 * time / 20.0 / 1e4);
        }
    }
}
