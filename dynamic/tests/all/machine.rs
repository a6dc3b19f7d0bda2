//! Machine code against the interpreter: the same in every bit, which the interpreter has in common with the macro's steps.

use std::fs;
use std::path::Path;
use std::sync::Arc;

use coadjoint::erased::dynamic::{MACHINE_LANES, Rule};
use coadjoint::erased::{Ensemble, EnsembleSystem, RetractionKind, Stepper, System};
use coadjoint::{Kind, Quantity, Role};
use coadjoint_dynamic::{DynamicSystem, Model};

/// Steps of a system.
pub(crate) struct Motion {
    pub(crate) scheme: String,
    pub(crate) step: f64,
    pub(crate) parameters: Vec<f64>,
    pub(crate) state: Vec<f64>,
    pub(crate) control: Vec<f64>,
}

impl Motion {
    /// From some parameters, and a state that is near to nothing in particular.
    pub(crate) fn some(model: &Model, scheme: &str, step: f64) -> Self {
        let description = model.description();
        let mut parameters = Vec::new();
        for quantity in description.parameters {
            let from = parameters.len();
            parameters.extend((0..quantity.components.len()).map(|k| 1.0 + 0.25 * k as f64));
            if let Kind::SymmetricMatrix(rows) | Kind::Matrix(rows, _) = quantity.kind {
                parameters[from..].iter_mut().enumerate().for_each(|(k, x)| {
                    *x = if k % (rows + 1) == 0 { 1.0 + 0.1 * k as f64 } else { 0.0 };
                });
            }
        }
        let system: &dyn System = &model.system(&parameters);
        let mut state: Vec<f64> =
            (0..length(description.state)).map(|k| 0.7 * (1.3 * k as f64 + 0.4).sin()).collect();
        for (quantity, range) in Quantity::with_ranges(description.state) {
            if quantity.role != Role::Configuration {
                continue;
            }
            state[range.clone()].fill(0.0);
            if let Kind::Matrix(rows, _) = quantity.kind {
                range.clone().step_by(rows + 1).for_each(|place| state[place] = 1.0);
            } else if system.deviation(&state) > 0.5 {
                // where a rotation is at rest
                for place in range {
                    state[place] = 1.0;
                    if system.deviation(&state) < 0.5 {
                        break;
                    }
                    state[place] = 0.0;
                }
            }
        }
        let tangent = description.state.last().map_or(0, |last| last.tangent().end);
        let by: Vec<f64> = (0..tangent).map(|k| 0.2 * (k as f64 + 0.3).cos()).collect();
        state = system.displace(&state, RetractionKind::Exponential, &by);
        let control = (0..length(description.controls)).map(|k| 0.1 + 0.05 * k as f64).collect();
        Self { scheme: scheme.to_owned(), step, parameters, state, control }
    }

    /// States to the last bit after steps one by one and many, reports, and what is remembered; or why there are none.
    pub(crate) fn run(&self, system: DynamicSystem, steps: u64) -> Result<(Vec<u64>, String), String> {
        let scheme = self.scheme.parse().expect("a scheme");
        let mut stepper =
            Stepper::new(Arc::new(system), &scheme, self.step).map_err(|error| error.to_string())?;
        let mut state = self.state.clone();
        let mut said = String::new();
        for _ in 0..25 {
            said += &format!("{:?}", stepper.step(&mut state, &self.control));
        }
        said += &format!("{:?}", stepper.steps(&mut state, &self.control, steps));
        // a control that jumps
        let other: Vec<f64> = self.control.iter().map(|x| x + 0.3).collect();
        for _ in 0..3 {
            said += &format!("{:?}", stepper.step(&mut state, &other));
        }
        said += &format!("{:?}", stepper.steps(&mut state, &self.control, 30));
        Ok((bits(state.into_iter().chain(stepper.snapshot())), said))
    }

    /// Both ways. Whether steps could be taken.
    pub(crate) fn check(&self, model: &Model, steps: u64) -> bool {
        let [machine, interpreted] =
            [model.clone(), model.interpreted()].map(|model| self.run(model.system(&self.parameters), steps));
        assert_eq!(machine, interpreted, "{}: {}", model.name(), self.scheme);
        machine.is_ok_and(|(_, said)| !said.contains("Err"))
    }
}

fn length(quantities: &[Quantity]) -> usize {
    quantities.iter().map(|quantity| quantity.components.len()).sum()
}

fn bits(numbers: impl IntoIterator<Item = f64>) -> Vec<u64> {
    // not-a-number is one, whatever its sign and payload
    numbers.into_iter().map(|x| if x.is_nan() { f64::NAN.to_bits() } else { x.to_bits() }).collect()
}

/// All schemes of one stage, and some that are made of these.
pub(crate) fn schemes(model: &Model) -> Vec<String> {
    let all = model.definition().steps.iter().flat_map(|step| &step.schemes);
    let spelt = all.map(|(map, rule)| match rule {
        Rule::Family(n, d) => format!("Family<{map:?}, {n}, {d}>"),
        Rule::TangentLift(n, d) => format!("TangentLift<{map:?}, {n}, {d}>"),
        Rule::HamiltonJacobi(order) => format!("HamiltonJacobi<{map:?}, {order}>"),
        other => panic!("{other:?} has no name here"),
    });
    spelt.chain(["Cayley", "Order4<Exponential>"].map(str::to_owned)).collect()
}

/// The texts of the catalogue.
fn texts() -> Vec<(String, String)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../systems/src");
    let files = fs::read_dir(folder).unwrap().map(|file| file.unwrap().path());
    let texts = files.filter(|file| file.extension().is_some_and(|extension| extension == "rs"));
    let named = texts.map(|file| {
        (file.file_stem().unwrap().to_string_lossy().into_owned(), fs::read_to_string(file).unwrap())
    });
    let mut texts: Vec<_> = named.filter(|(_, text)| text.contains("#[lie_poisson_system")).collect();
    texts.sort();
    texts
}

#[test]
fn every_scheme_of_the_catalogue_is_the_interpreters() {
    let mut taken = [0; 2];
    for (name, text) in texts() {
        let model = Model::from_text(&text).unwrap_or_else(|error| panic!("{name}: {error}"));
        for scheme in schemes(&model) {
            for step in [0.002, 0.05] {
                taken[usize::from(Motion::some(&model, &scheme, step).check(&model, 60))] += 1;
            }
        }
    }
    println!("{taken:?}");
    // some have no steps as large, or no such parameters
    let [failed, moved] = taken;
    assert!(moved > 300 && failed < moved / 3, "{taken:?}");
}

/// The first half of a step has nothing to solve, the second has: the vector potential depends on the position in two directions alone.
#[test]
fn halves_with_and_without_unknowns_are_the_interpreters() {
    let model = Model::from_text(
        "#[lie_poisson_system(group = R3, hamiltonian = {
            let grow = 1.0 + shape * (position.x.powi(2) + position.y.powi(2));
            let a = vector![-position.y, position.x, 0.0] * (0.5 * field * grow);
            (momentum - charge * a).norm_squared() / (2.0 * mass) + charge * push * position.x
        })]
        struct Particle { mass: f64, charge: f64, field: f64, shape: f64, push: f64 }",
    )
    .unwrap();
    let halves = [Rule::Family(0, 1), Rule::Family(1, 1)];
    let unknowns = halves.map(|half| {
        let steps = &model.definition().steps;
        let step = steps.iter().find(|step| step.schemes.contains(&(RetractionKind::Exponential, half)));
        step.unwrap().layout.unknown.len()
    });
    assert!(unknowns.contains(&0) && unknowns.iter().any(|count| *count > 0), "{unknowns:?}");
    for scheme in schemes(&model).iter().map(String::as_str).chain(["Exponential"]) {
        assert!(Motion::some(&model, scheme, 0.05).check(&model, 200), "{scheme}");
    }
}

const TOP: &str =
    "#[lie_poisson_system(group = SO3, advected(gamma: R3), potential = weight * gamma.dot(&chi))]
struct HeavyTop {
    #[inertia]
    inertia: Vector3<f64>,
    weight: f64,
    chi: Vector3<f64>,
}";

#[test]
fn there_is_machine_code_that_takes_many_steps() {
    let model = Model::from_text(TOP).unwrap();
    assert!(model.definition().steps.iter().all(|step| step.functions.march(None).is_some()));
    assert!(model.interpreted().definition().steps.iter().all(|step| step.functions.march(None).is_none()));
    // each of the ways of one iteration, and of several
    for (scheme, step) in [("Cayley", 0.01), ("Exponential", 0.01), ("Exponential", 0.3), ("Cayley", 0.3)] {
        assert!(Motion::some(&model, scheme, step).check(&model, 5_000), "{scheme}");
    }
}

/// An ensemble: several members, the last of which do not fill a block, and each with parameters, a state and controls of its own.
struct Several {
    motion: Motion,
    members: Vec<(Vec<f64>, Vec<f64>)>,
}

/// Steps that are taken one after the other, each with controls of its own.
const PARTS: [u64; 4] = [40, 70, 1, 33];

impl Several {
    /// Members near to a motion; in each block one that moves so fast that its steps are harder to take, or cannot be taken.
    fn of(model: &Model, motion: Motion) -> Self {
        let description = model.description();
        let member = |k: usize| {
            let (mut parameters, mut state) = (motion.parameters.clone(), motion.state.clone());
            parameters.iter_mut().take(1).for_each(|x| *x *= 1.0 + 0.01 * k as f64);
            for (quantity, range) in Quantity::with_ranges(description.state) {
                if quantity.role == Role::Momentum {
                    let factor = if [3, 5].contains(&k) { 30.0 } else { 1.0 + 0.2 * k as f64 };
                    state[range].iter_mut().for_each(|x| *x *= factor);
                }
            }
            (parameters, state)
        };
        let members = (0..2 * MACHINE_LANES - 1).map(member).collect();
        Self { motion, members }
    }

    /// The controls of a member in a part. Those of one member end to be numbers in the midst.
    fn control(&self, member: usize, part: usize) -> Vec<f64> {
        let factor = if (member, part) == (1, 2) { f64::NAN } else { 1.0 + 0.1 * (member + part) as f64 };
        self.motion.control.iter().map(|x| x * factor).collect()
    }

    /// Where members are in the end, and when and why some of them failed, as an ensemble; none if they cannot be taken.
    fn together(&self, model: &Model) -> Option<Vec<(Vec<u64>, Option<String>)>> {
        let system: &dyn EnsembleSystem = &model.system(&self.motion.parameters);
        let scheme = self.motion.scheme.parse().unwrap();
        let mut ensemble =
            Ensemble::new(system, &scheme, self.members.iter().cloned(), self.motion.step).ok()?;
        for (part, steps) in PARTS.into_iter().enumerate() {
            ensemble.control(|member, _, control| control.copy_from_slice(&self.control(member, part)));
            if part == 1 {
                let law = |member: usize, _: &[f64], _: f64, control: &mut [f64]| {
                    control.copy_from_slice(&self.control(member, part));
                };
                ensemble.run_controlled(steps, &law);
            } else {
                ensemble.run(steps);
            }
        }
        let mut ends = vec![(Vec::new(), None); self.members.len()];
        ensemble.control(|member, state, _| ends[member].0 = bits(state.iter().copied()));
        for failed in ensemble.failed() {
            ends[failed.member].1 = Some(format!("{}: {}", failed.step, failed.source));
        }
        Some(ends)
    }

    /// The same of each member alone.
    fn alone(&self, model: &Model) -> Vec<(Vec<u64>, Option<String>)> {
        let scheme = self.motion.scheme.parse().unwrap();
        let end = |(member, (parameters, state)): (usize, &(Vec<f64>, Vec<f64>))| {
            let system = Arc::new(model.system(parameters));
            let mut stepper = Stepper::new(system, &scheme, self.motion.step).unwrap();
            let (mut state, mut taken) = (state.clone(), 0);
            for (part, steps) in PARTS.into_iter().enumerate() {
                for _ in 0..steps {
                    taken += 1;
                    if let Err(error) = stepper.step(&mut state, &self.control(member, part)) {
                        return (bits(state), Some(format!("{taken}: {error}")));
                    }
                }
            }
            (bits(state), None)
        };
        self.members.iter().enumerate().map(end).collect()
    }
}

#[test]
fn members_of_ensembles_move_as_each_does_alone() {
    let (mut failed, mut moved) = (0, 0);
    for (name, text) in texts() {
        let model = Model::from_text(&text).unwrap();
        for scheme in schemes(&model) {
            for step in [0.004, 0.05] {
                let several = Several::of(&model, Motion::some(&model, &scheme, step));
                let Some(together) = several.together(&model) else { continue };
                assert_eq!(together, several.alone(&model), "{name}, {scheme}, {step}");
                if name == "heavy_top" {
                    assert_eq!(Some(&together), several.together(&model.interpreted()).as_ref(), "{scheme}");
                }
                moved += together.len();
                failed += together.iter().filter(|(_, error)| error.is_some()).count();
            }
        }
    }
    // of those with controls one at least fails
    assert!(moved > 2100 && failed > 40, "{failed} of {moved}");
}

#[test]
fn systems_outlive_their_models_in_any_thread() {
    let motion = Motion::some(&Model::from_text(TOP).unwrap(), "Exponential", 0.01);
    let alone = motion.run(Model::from_text(TOP).unwrap().system(&motion.parameters), 500).unwrap();
    let system = Model::from_text(TOP).unwrap().system(&motion.parameters);
    std::thread::scope(|scope| {
        let threads: Vec<_> =
            (0..4).map(|_| scope.spawn(|| motion.run(system.clone(), 500).unwrap())).collect();
        threads.into_iter().for_each(|thread| assert_eq!(thread.join().unwrap(), alone));
    });
    drop(system);
}

/// How many bytes of memory may be executed and are of no file.
#[cfg(target_os = "linux")]
fn executable() -> usize {
    let maps = fs::read_to_string("/proc/self/maps").unwrap();
    let code = maps
        .lines()
        .filter(|line| line.contains(" r-xp ") && line.contains(" 00:00 0") && !line.contains('['));
    let size = |line: &str| {
        let (from, to) = line.split_whitespace().next()?.split_once('-')?;
        let [from, to] = [from, to].map(|address| usize::from_str_radix(address, 16));
        Some(to.ok()? - from.ok()?)
    };
    code.filter_map(size).sum()
}

/// In a process of its own, where no other test makes code: see below.
#[cfg(target_os = "linux")]
#[test]
#[ignore = "the test below starts it"]
fn memory_goes_with_the_last_system() {
    let before = executable();
    let mut systems = Vec::new();
    for _ in 0..10 {
        let model = Model::from_text(TOP).unwrap();
        let motion = Motion::some(&model, "Cayley", 0.01);
        motion.run(model.system(&motion.parameters), 100).unwrap();
        systems.push(model.system(&motion.parameters));
    }
    assert!(executable() >= before + 10 * 4096, "{} {before}", executable());
    systems.clear();
    assert_eq!(executable(), before);
}

#[cfg(target_os = "linux")]
#[test]
fn memory_is_freed() {
    let mut own = std::process::Command::new(std::env::current_exe().unwrap());
    let output = own
        .args(["--ignored", "--exact", "machine::memory_goes_with_the_last_system", "--test-threads=1"])
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success() && said.contains("1 passed"), "{said}");
}
