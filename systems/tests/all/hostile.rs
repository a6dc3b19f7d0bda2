//! A campaign of hostile library calls, drawn at random, for every system of the catalogue, compiled and read from its text: slices of any length,
//! numbers of any kind, steps, tolerances, times, events, members, bytes and memories that nobody would take. A call that fails says so, and leaves
//! the state as it was; none panics.
//!
//! `COADJOINT_CAMPAIGN=1` tries more, `COADJOINT_SEED` chooses others.

mod compiled;

use std::cell::{Cell, RefCell};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

use coadjoint::ensemble::Statistics;
use coadjoint::erased::{self, EnsembleSystem, RetractionKind, System};
use coadjoint::stepper::Stepping;
use coadjoint::{Event, Interval, Record, Run, Scheme};
use coadjoint_app::setup::random::Random;
use coadjoint_dynamic::Model;
use coadjoint_systems::catalogue::CATALOGUE;

const ODD: [f64; 14] = [
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
    f64::MAX,
    f64::EPSILON,
    1e16,
    std::f64::consts::PI,
];

struct Hostile(Random);

impl Hostile {
    fn below(&mut self, bound: usize) -> usize {
        // never 1
        ((0.5 * (self.0.even() + 1.0)) * bound as f64) as usize
    }

    fn one_in(&mut self, bound: usize) -> bool {
        self.below(bound) == 0
    }

    fn number(&mut self) -> f64 {
        ODD[self.below(ODD.len())]
    }

    /// This number, or another one.
    fn near(&mut self, sound: f64) -> f64 {
        if self.one_in(3) { self.number() } else { sound }
    }

    /// These numbers with one or two others among them, or some of any length.
    fn slice(&mut self, sound: &[f64]) -> Vec<f64> {
        if self.one_in(4) {
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

    /// These bytes with some others, or without some.
    fn bytes(&mut self, sound: &[u8]) -> Vec<u8> {
        let mut bytes = sound.to_vec();
        for _ in 0..=self.below(3) {
            let place = self.below(bytes.len().max(1));
            match self.below(4) {
                0 => bytes.truncate(place),
                1 => bytes.insert(place.min(bytes.len()), self.below(256) as u8),
                2 => bytes.extend_from_within(place.min(bytes.len())..),
                _ => {
                    if let Some(byte) = bytes.get_mut(place) {
                        *byte ^= 1 << self.below(8);
                    }
                }
            }
        }
        bytes
    }

    fn scheme(&mut self) -> Scheme {
        const SCHEMES: [&str; 7] = [
            "Exponential",
            "Cayley",
            "Midpoint<Cayley>",
            "Order4<Exponential>",
            "StormerVerlet<Cayley>",
            "HamiltonJacobi<Exponential, 6>",
            "TangentLift<Cayley>",
        ];
        SCHEMES[self.below(SCHEMES.len())].parse().expect("a scheme")
    }
}

/// Makes a system of its parameters.
type Make<'a> = &'a dyn Fn(&[f64]) -> Arc<dyn EnsembleSystem>;

/// A system, and numbers that it takes.
struct Tried<'a> {
    make: Make<'a>,
    parameters: Vec<f64>,
    state: Vec<f64>,
    control: Vec<f64>,
    step: f64,
}

impl Tried<'_> {
    /// The system with its parameters, or with others.
    fn system(&self, hostile: &mut Hostile) -> Arc<dyn EnsembleSystem> {
        match hostile.one_in(3) {
            true => (self.make)(&hostile.slice(&self.parameters)),
            false => (self.make)(&self.parameters),
        }
    }

    fn stepper(&self, hostile: &mut Hostile) -> Option<erased::Stepper> {
        let (system, scheme) = (self.system(hostile) as Arc<dyn System>, hostile.scheme());
        erased::Stepper::new(system, &scheme, hostile.near(self.step)).ok()
    }

    fn adaptive(&self, hostile: &mut Hostile) -> Option<erased::Adaptive> {
        let system = self.system(hostile) as Arc<dyn System>;
        let steps = erased::Adaptive::new(system, hostile.near(1e-9)).ok()?;
        Some(if hostile.one_in(4) { steps.with_order(hostile.below(50)) } else { steps })
    }

    fn control(&self, hostile: &mut Hostile) -> Vec<f64> {
        if hostile.one_in(3) { hostile.slice(&self.control) } else { self.control.clone() }
    }
}

fn bits(numbers: &[f64]) -> Vec<u64> {
    numbers.iter().map(|x| x.to_bits()).collect()
}

fn is_finite(numbers: &[f64]) -> bool {
    numbers.iter().all(|x| x.is_finite())
}

/// Calls whatever a system on slices can be asked.
fn ask(tried: &Tried<'_>, hostile: &mut Hostile) {
    let system = (tried.make)(&hostile.slice(&tried.parameters));
    let (state, by) = (hostile.slice(&tried.state), hostile.slice(&tried.state));
    let (time, control) = (hostile.number(), hostile.slice(&tried.control));
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
        system.with_velocity(&state, time, &control).map_or(tried.state.len(), |moving| moving.len()),
    ];
    assert!([1, 6, 7].iter().all(|&k| lengths[k] == tried.state.len()), "{lengths:?}");
    let _ = (system.energy(&state, time, &control), system.deviation(&state), system.validate());
    let _ = system.event(hostile.below(4), &state, time, &control);
}

/// Takes steps from sound and hostile states; one that cannot be taken leaves everything as it was, and one that is taken leads to numbers.
fn step(tried: &Tried<'_>, hostile: &mut Hostile) {
    let Some(mut stepper) = tried.stepper(hostile) else { return };
    let mut state = tried.state.clone();
    for _ in 0..12 {
        match hostile.below(10) {
            0 => state = hostile.slice(&tried.state),
            1 => drop(stepper.set_step_size(hostile.number())),
            2 => drop(stepper.set_parameters(&hostile.slice(&tried.parameters))),
            3 => stepper.set_time(hostile.number()),
            4 => {
                let memory = hostile.slice(&stepper.snapshot());
                let _ = stepper.restore(&memory);
            }
            5 => stepper.reset(),
            _ => {}
        }
        let control = tried.control(hostile);
        let (before, moment) = (state.clone(), (stepper.time().to_bits(), stepper.steps_taken()));
        let is_taken = match hostile.below(6) {
            0 => stepper.step_with_jacobian(&mut state, &control).is_ok(),
            1 => stepper.step_driven(&mut state, &mut |_| tried.control(hostile)).is_ok(),
            2 => {
                let costate = hostile.slice(&tried.state);
                drop(stepper.gradient(hostile.number(), &[&state], |_| control.clone(), &costate));
                false
            }
            _ => stepper.step(&mut state, &control).is_ok(),
        };
        if !is_taken {
            assert_eq!(bits(&before), bits(&state), "a step that failed changed the state");
            assert_eq!(moment, (stepper.time().to_bits(), stepper.steps_taken()));
            state.clone_from(&tried.state);
        }
        assert!(is_finite(&state), "a step led to no numbers");
    }
}

/// Takes Taylor steps likewise, and looks within them.
fn expand(tried: &Tried<'_>, hostile: &mut Hostile) {
    let Some(mut steps) = tried.adaptive(hostile) else { return };
    let mut state = tried.state.clone();
    for _ in 0..6 {
        match hostile.below(6) {
            0 => state = hostile.slice(&tried.state),
            1 => Stepping::set_time(&mut steps, hostile.number()),
            2 => {
                let memory = hostile.slice(&steps.snapshot());
                let _ = Stepping::restore(&mut steps, &memory);
            }
            3 => drop(Stepping::set_parameters(&mut steps, &hostile.slice(&tried.parameters))),
            4 => drop(Stepping::set_step_size(&mut steps, hostile.number())),
            _ => {}
        }
        let control = tried.control(hostile);
        let before = (bits(&state), steps.time().to_bits());
        if steps.step_with(&mut state, &control).is_err() {
            assert_eq!(
                before,
                (bits(&state), steps.time().to_bits()),
                "a step that failed changed the state"
            );
            state.clone_from(&tried.state);
        }
        assert!(is_finite(&state), "a step led to no numbers");
        drop(steps.at(hostile.number()));
    }
}

/// Makes runs with any laws, events, times and ends.
fn run(tried: &Tried<'_>, hostile: &mut Hostile) {
    match (tried.stepper(hostile), tried.adaptive(hostile)) {
        (Some(stepper), Some(series)) if hostile.one_in(2) => {
            run_with(&mut stepper.with_series(series), tried, hostile);
        }
        (Some(mut stepper), None) => run_with(&mut stepper, tried, hostile),
        (_, Some(mut steps)) => run_with(&mut steps, tried, hostile),
        (None, None) => {}
    }
}

fn run_with(stepper: &mut impl Stepping<System = dyn System>, tried: &Tried<'_>, hostile: &mut Hostile) {
    let mut state = if hostile.one_in(4) { hostile.slice(&tried.state) } else { tried.state.clone() };
    let before = state.clone();
    if hostile.one_in(4) {
        stepper.set_time(hostile.number());
    }
    let (mut seen, is_touched) = (0, Cell::new(false));
    let times = [(); 4].map(|()| hostile.near(2.0 * tried.step));
    let (end, place, control) = (hostile.near(4.5 * tried.step), hostile.below(4), tried.control(hostile));
    let (law, interval) = (hostile.below(5), hostile.below(4) as u64);
    let hostile = RefCell::new(hostile);
    let draw = || tried.control(&mut hostile.borrow_mut());
    let run = Run::new(stepper, &mut state)
        .until(|_| {
            seen += 1;
            seen > 6
        })
        .event(
            Event::any(),
            |state: &Vec<f64>, _| {
                let mut hostile = hostile.borrow_mut();
                if hostile.one_in(8) { hostile.number() } else { state.last().copied().unwrap_or(0.0) }
            },
            |event| {
                let mut hostile = hostile.borrow_mut();
                is_touched.set(true);
                match hostile.below(5) {
                    0 => *event.state_mut() = hostile.slice(&tried.state),
                    1 => {
                        if let Some(control) = event.control_mut() {
                            *control = hostile.slice(&tried.control);
                        }
                    }
                    2 => drop(event.set_parameters(&hostile.slice(&tried.parameters))),
                    3 => event.stop(),
                    _ => {}
                }
            },
        )
        .on_each([(place, Event::rising(), |_: &mut coadjoint::Occurrence<'_, dyn System>| {})])
        .save_at(times, Record::every(1));
    let outcome = match law {
        0 => run.controlled_by(|_, _| draw()).to(end),
        1 => run.controlled_every(interval, |_, _| draw()).starting_at(end).steps(5),
        2 => run.driven_by(|_| draw()).to(end),
        3 => run.with_control(control.clone()).past(end),
        _ => run.with_control(control.clone()).to(end),
    };
    if let Err(error) = outcome
        && error.report.steps == 0
        && !is_touched.get()
    {
        assert_eq!(bits(&before), bits(&state), "a run without a step changed the state: {error}");
    }
    let mut hostile = hostile.borrow_mut();
    let mut state = tried.state.clone();
    if let Ok(interval) = Interval::step(stepper, &mut state, control) {
        drop(interval.at(hostile.number()));
        drop(interval.at_time(hostile.number()));
    }
}

/// Runs members of which some are hostile; the others move as they do alone.
fn members(tried: &Tried<'_>, hostile: &mut Hostile) {
    let (system, scheme, step) =
        ((tried.make)(&tried.parameters), hostile.scheme(), hostile.near(tried.step));
    let all: Vec<(Vec<f64>, Vec<f64>)> = (0..hostile.below(20))
        .map(|_| match hostile.below(8) {
            0 => (hostile.slice(&tried.parameters), hostile.slice(&tried.state)),
            // numbers that are taken, with which no step may be possible
            1 => (tried.parameters.clone(), tried.state.iter().map(|x| x * 1e150).collect()),
            _ => (tried.parameters.clone(), tried.state.clone()),
        })
        .collect();
    drop(erased::Ensemble::new(&*system, &scheme, all.clone(), step));
    // those that are taken
    let taken = |member: &(Vec<f64>, Vec<f64>)| {
        erased::Ensemble::new(&*system, &scheme, [member.clone()], step).is_ok()
    };
    let all: Vec<_> = all.into_iter().filter(taken).collect();
    let inputs: Vec<Vec<f64>> = all.iter().map(|_| tried.control(hostile)).collect();
    let (kind, steps) = (hostile.below(3), hostile.below(6) as u64);
    let moved = |which: &[usize]| {
        let chosen = which.iter().map(|member| all[*member].clone());
        let mut ensemble = erased::Ensemble::new(&*system, &scheme, chosen, step).expect("each is taken");
        let copy = |member: usize, control: &mut [f64]| {
            control.iter_mut().zip(&inputs[which[member]]).for_each(|(to, from)| *to = *from);
        };
        ensemble.control(|member, _, control| copy(member, control));
        match kind {
            0 => ensemble.run(steps),
            1 => ensemble.run_driven(steps, &|member, _, control| copy(member, control)),
            _ => ensemble.run_controlled(steps, &|member, _, _, control| copy(member, control)),
        };
        let left = ensemble.members().map(|(member, _, state)| (which[member], bits(&state)));
        let left: Vec<(usize, Vec<u64>)> = left.collect();
        assert_eq!(left.len() + ensemble.failed().len(), which.len());
        assert!(left.iter().all(|(_, state)| state.iter().all(|x| f64::from_bits(*x).is_finite())));
        left
    };
    let together = moved(&(0..all.len()).collect::<Vec<_>>());
    let alone: Vec<_> = (0..all.len()).flat_map(|member| moved(&[member])).collect();
    assert_eq!(together, alone);
}

/// Reads statistics from bytes that were changed, merges and writes them.
fn read(hostile: &mut Hostile) {
    let of = |hostile: &mut Hostile| {
        let values: Vec<f64> = (0..hostile.below(40)).map(|_| hostile.number()).collect();
        Statistics::of(values)
    };
    let (one, mut other) = (of(hostile), of(hostile));
    let sound = one.to_bytes();
    assert_eq!(Statistics::from_bytes(&sound).map(|one| one.to_bytes()), Some(sound.clone()));
    if let Some(read) = Statistics::from_bytes(&hostile.bytes(&sound)) {
        other.merge(&read);
        let _ = (other.spread(hostile.number()), other.relative_error(), other.to_bytes(), read.spread(0.0));
    }
}

/// What is called, by the names of what it is called of.
type Calls<'a> = [(&'a str, &'a dyn Fn(&mut Hostile))];

/// Calls each some times, with numbers of its own, from this stream of them on.
fn campaign(first: u64, calls: &Calls<'_>) {
    let is_campaign = std::env::var_os("COADJOINT_CAMPAIGN").is_some();
    let seed = std::env::var("COADJOINT_SEED").ok().and_then(|seed| seed.parse().ok()).unwrap_or(1);
    for ((name, call), stream) in calls.iter().zip(first..) {
        let mut hostile = Hostile(Random::new(seed, stream));
        for round in 0..if is_campaign { 600 } else { 6 } {
            let called = catch_unwind(AssertUnwindSafe(|| call(&mut hostile)));
            assert!(called.is_ok(), "{name}, round {round}");
        }
    }
}

#[test]
fn hostile_calls_are_answered() {
    for (stream, entry) in (0..).zip(CATALOGUE.entries()) {
        let model = Model::from_text(entry.source).unwrap_or_else(|error| panic!("{error}")).interpreted();
        let makers: [Make<'_>; 2] =
            [&|parameters| entry.system(parameters), &|parameters| Arc::new(model.system(parameters))];
        let example = &entry.example;
        let tried = makers.map(|make| Tried {
            make,
            parameters: example.parameters.clone(),
            state: example.state.clone(),
            control: vec![0.0; example.controls.len()],
            step: entry.step,
        });
        let call = |hostile: &mut Hostile| {
            for call in [ask, step, expand, run, members] {
                call(&tried[hostile.below(2)], hostile);
            }
            read(hostile);
        };
        campaign(stream, &[(entry.name.as_str(), &call)]);
    }
}
