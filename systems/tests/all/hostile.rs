//! A campaign of hostile library calls, drawn at random, for every system of the catalogue: slices of any length, numbers of any kind, steps and
//! memories that nobody would take. A call that fails says so, and leaves the state as it was; none panics.
//!
//! `COADJOINT_CAMPAIGN=1` tries more, `COADJOINT_SEED` chooses others.

use std::panic::{AssertUnwindSafe, catch_unwind};

use coadjoint::Scheme;
use coadjoint::erased::{self, RetractionKind};
use coadjoint_app::Entry;
use coadjoint_app::setup::random::Random;
use coadjoint_systems::catalogue::CATALOGUE;

const ODD: [f64; 12] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    1e300,
    -1e-300,
    5e-324,
    1e16,
    std::f64::consts::PI,
];

struct Hostile(Random);

impl Hostile {
    fn below(&mut self, bound: usize) -> usize {
        // never 1
        ((0.5 * (self.0.even() + 1.0)) * bound as f64) as usize
    }

    fn number(&mut self) -> f64 {
        ODD[self.below(ODD.len())]
    }

    /// These numbers with one or two others among them, or some of any length.
    fn slice(&mut self, sound: &[f64]) -> Vec<f64> {
        if self.below(4) == 0 {
            let length = self.below(2 * sound.len() + 2);
            return (0..length).map(|_| self.number()).collect();
        }
        let mut numbers = sound.to_vec();
        for _ in 0..self.below(3) {
            if !numbers.is_empty() {
                let place = self.below(numbers.len());
                numbers[place] = self.number();
            }
        }
        numbers
    }
}

/// Calls whatever a system on slices can be asked.
fn ask(entry: &Entry, hostile: &mut Hostile) {
    let example = &entry.example;
    let system = entry.system(&hostile.slice(&example.parameters));
    let controls = vec![0.0; example.controls.len()];
    let (state, by) = (hostile.slice(&example.state), hostile.slice(&example.state));
    let (time, control) = (hostile.number(), hostile.slice(&controls));
    let map =
        [RetractionKind::Exponential, RetractionKind::Cayley, RetractionKind::SecondKind][hostile.below(3)];
    let lengths = [
        system.casimirs(&state).len(),
        system.displace(&state, map, &by).len(),
        system.differential(&state, time, &control).len(),
        system.hamiltonian_vector(&state, &by).len(),
        system.force(&state, time, &control).len(),
        system.motion(&state, time, &control).len(),
        system.vector_field(&state, time, &control).len(),
        system.with_velocity(&state, time, &control).map_or(example.state.len(), |moving| moving.len()),
    ];
    assert!([1, 6, 7].iter().all(|&k| lengths[k] == example.state.len()), "{lengths:?}");
    let _ = (system.energy(&state, time, &control), system.deviation(&state), system.validate());
}

/// Takes steps from sound and hostile states; a step that is taken leads to finite numbers.
fn step(entry: &Entry, hostile: &mut Hostile) {
    let example = &entry.example;
    let schemes =
        ["Exponential", "Cayley", "Midpoint<Cayley>", "Order4<Exponential>", "StormerVerlet<Cayley>"];
    let scheme: Scheme = schemes[hostile.below(schemes.len())].parse().expect("a scheme");
    let length = if hostile.below(3) == 0 { hostile.number() } else { entry.step };
    let parameters =
        if hostile.below(3) == 0 { hostile.slice(&example.parameters) } else { example.parameters.clone() };
    let Ok(mut stepper) = erased::Stepper::new(entry.system(&parameters), &scheme, length) else { return };
    let mut state = example.state.clone();
    for _ in 0..12 {
        match hostile.below(8) {
            0 => state = hostile.slice(&example.state),
            1 => drop(stepper.set_step_size(hostile.number())),
            2 => drop(stepper.set_parameters(&hostile.slice(&example.parameters))),
            3 => stepper.set_time(hostile.number()),
            4 => {
                let memory = hostile.slice(&stepper.snapshot());
                let _ = stepper.restore(&memory);
            }
            _ => {}
        }
        let control = match hostile.below(3) {
            0 => hostile.slice(&vec![0.0; example.controls.len()]),
            _ => vec![0.0; example.controls.len()],
        };
        let before = state.clone();
        if stepper.step(&mut state, &control).is_err() {
            let bits = |numbers: &[f64]| numbers.iter().map(|x| x.to_bits()).collect::<Vec<u64>>();
            assert_eq!(bits(&before), bits(&state), "a step that failed changed the state");
            state.clone_from(&example.state);
        }
    }
}

#[test]
fn hostile_calls_are_answered() {
    let is_campaign = std::env::var_os("COADJOINT_CAMPAIGN").is_some();
    let seed = std::env::var("COADJOINT_SEED").ok().and_then(|seed| seed.parse().ok()).unwrap_or(1);
    for (entry, stream) in CATALOGUE.entries().iter().zip(0..) {
        let mut hostile = Hostile(Random::new(seed, stream));
        for round in 0..if is_campaign { 3000 } else { 20 } {
            for call in [ask, step] {
                let called = catch_unwind(AssertUnwindSafe(|| call(entry, &mut hostile)));
                assert!(called.is_ok(), "{}, round {round}", entry.name);
            }
        }
    }
}
