//! Systems that are made of the catalogue's texts against those that the compiler makes: the same in every bit.

use std::sync::Arc;

use coadjoint::certify::certify_erased;
use coadjoint::erased::dynamic::Rule;
use coadjoint::erased::{self, EnsembleSystem, RetractionKind, System};
use coadjoint_app::Entry;
use coadjoint_dynamic::Model;
use coadjoint_systems::catalogue::CATALOGUE;

/// How many steps are taken with each scheme.
const STEPS: usize = 200;

entries! { check }

/// The same system, compiled and made of its text: as machine code where the processor is one that it is for, and interpreted.
struct Same {
    entry: Entry,
    typed: Arc<dyn EnsembleSystem>,
    dynamic: [Arc<dyn EnsembleSystem>; 2],
    /// The schemes of one stage, and some that are made of these.
    schemes: Vec<String>,
}

fn same(name: &str) -> Same {
    let entry = CATALOGUE.system(name).expect("it is there").clone();
    let typed = entry.system(&entry.example.parameters);
    let model = Model::from_text(entry.source).unwrap_or_else(|error| panic!("{error}"));
    let all = model.definition().steps.iter().flat_map(|step| &step.schemes);
    let mut schemes: Vec<String> = all.map(|(map, rule)| spelt(*map, *rule)).collect();
    schemes.extend(["Cayley", "Exponential", "Order4<Cayley>"].map(str::to_owned));
    let dynamic = [&model, &model.interpreted()]
        .map(|model| Arc::new(model.system(&typed.parameters())) as Arc<dyn EnsembleSystem>);
    Same { entry, typed, dynamic, schemes }
}

fn spelt(map: RetractionKind, rule: Rule) -> String {
    match rule {
        Rule::Family(n, d) => format!("Family<{map:?}, {n}, {d}>"),
        Rule::TangentLift(n, d) => format!("TangentLift<{map:?}, {n}, {d}>"),
        Rule::HamiltonJacobi(order) => format!("HamiltonJacobi<{map:?}, {order}>"),
        other => panic!("{other:?} has no name here"),
    }
}

fn check(name: &str) {
    let same = same(name);
    let Same { typed, dynamic, schemes, .. } = &same;
    for dynamic in dynamic {
        assert_eq!(typed.description(), dynamic.description());
        assert_eq!(bits(&typed.parameters()), bits(&dynamic.parameters()));
        assert_eq!(typed.validate(), dynamic.validate());
    }
    let mut taken = 0;
    for scheme in schemes {
        let typed = same.run(typed, scheme);
        for dynamic in dynamic {
            assert_eq!(typed, same.run(dynamic, scheme), "{name}: {scheme}");
        }
        taken += usize::from(typed.is_ok());
        if let Ok((state, _)) = typed {
            same.compare_geometry(&state.iter().map(|bits| f64::from_bits(*bits)).collect::<Vec<_>>());
        }
    }
    assert!(taken >= 2, "{name}: {taken} schemes");
}

fn bits(numbers: &[f64]) -> Vec<u64> {
    numbers.iter().map(|x| x.to_bits()).collect()
}

impl Same {
    /// The state after some steps, and how they went; or why there are none.
    fn run(&self, system: &Arc<dyn EnsembleSystem>, scheme: &str) -> Result<(Vec<u64>, String), String> {
        let (entry, system) = (&self.entry, system.clone() as Arc<dyn System>);
        let scheme = scheme.parse().expect("a scheme");
        let mut stepper =
            erased::Stepper::new(system, &scheme, entry.step).map_err(|error| error.to_string())?;
        let (mut state, law) = (entry.example.state.clone(), entry.law(&entry.example));
        let mut control = vec![0.0; entry.description.controls.iter().map(|one| one.components.len()).sum()];
        let mut reports = String::new();
        for k in 0..STEPS {
            if let Some(law) = &law {
                control.fill(0.0);
                law(&state, stepper.time(), &mut control);
            }
            let count = if law.is_some() || k < 20 { 1 } else { STEPS - k };
            let report =
                stepper.steps(&mut state, &control, count as u64).map_err(|error| error.to_string())?;
            reports += &format!("{report:?}");
            if count > 1 {
                break;
            }
        }
        Ok((bits(&state), reports))
    }

    /// What all say of a state.
    fn compare_geometry(&self, state: &[f64]) {
        let Self { entry, typed, dynamic, .. } = self;
        let tangent = entry.description.state.last().map_or(0, |last| last.tangent().end);
        let by: Vec<f64> = (0..tangent).map(|k| 0.01 * (k as f64 - 2.5)).collect();
        let control: Vec<f64> =
            entry.description.controls.iter().flat_map(|one| one.components).map(|_| 0.3).collect();
        let said = |system: &Arc<dyn EnsembleSystem>| {
            let velocity = system.with_velocity(state, 0.7, &control).map_err(|error| error.to_string());
            let mut all = vec![
                vec![system.deviation(state), system.energy(state, 0.7, &control)],
                system.casimirs(state),
                system.differential(state, 0.7, &control),
                system.hamiltonian_vector(state, &by),
                system.force(state, 0.7, &control),
                system.motion(state, 0.7, &control),
                system.vector_field(state, 0.7, &control),
            ];
            all.extend(RetractionKind::ALL.map(|map| system.displace(state, map, &by)));
            (all.iter().map(|one| bits(one)).collect::<Vec<_>>(), velocity.map(|state| bits(&state)))
        };
        for dynamic in dynamic {
            assert_eq!(said(typed), said(dynamic), "{}", entry.name);
        }
    }
}

#[test]
fn members_of_ensembles_move_alike() {
    for name in ["heavy_top", "double_pendulum", "quadrotor", "free_rigid_body"] {
        let Same { entry, typed, dynamic, .. } = same(name);
        let run = |system: &dyn EnsembleSystem| {
            let members = (0..11).map(|k| {
                let mut state = entry.example.state.clone();
                // a momentum, which may be anything
                *state.last_mut().expect("a number") += 1e-3 * f64::from(k);
                (entry.example.parameters.clone(), state)
            });
            let scheme = "Cayley".parse().expect("a scheme");
            let mut ensemble = erased::Ensemble::new(system, &scheme, members, entry.step).expect("members");
            let steps = ensemble.run(300);
            let states: Vec<_> =
                ensemble.members().map(|(member, _, state)| (member, bits(&state))).collect();
            (steps, states, format!("{:?}", ensemble.failed()))
        };
        for dynamic in dynamic {
            assert_eq!(run(&*typed), run(&*dynamic), "{name}");
        }
    }
}

#[test]
fn certificates_are_the_same() {
    for name in ["heavy_top", "double_pendulum", "coupled_bodies"] {
        let Same { entry, typed, dynamic, .. } = same(name);
        for scheme in ["Cayley", "Exponential"] {
            let scheme = scheme.parse().expect("a scheme");
            let certificate = |system: &Arc<dyn EnsembleSystem>| {
                let states = [entry.example.state.clone()];
                let report = certify_erased(&**system, &scheme, &states, &[], 0.0, Some(entry.step));
                report.expect("certificates").to_string()
            };
            for dynamic in &dynamic {
                assert_eq!(certificate(&typed), certificate(dynamic), "{name}");
            }
        }
    }
}
