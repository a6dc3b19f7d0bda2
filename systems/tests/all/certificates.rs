//! What the schemes claim, measured on every system of the catalogue.

use coadjoint::prelude::*;
use coadjoint_app::Example;
use coadjoint_app::setup::{Method, Order, Retraction};
use coadjoint_app::simulate::{certify, states_in_motion};
use coadjoint_systems::catalogue::CATALOGUE;

use crate::is_asked_for;

entries!(every_claim_holds);

fn every_claim_holds(name: &str) {
    let entry = CATALOGUE.find(name).expect("it is there");
    let retractions = Retraction::of(entry);
    let (mut failures, mut reports, mut measured) = (String::new(), 0, 0);
    let methods = [Method::Standard, Method::EULER_A, Method::EULER_B, Method::MIDPOINT];
    let methods: Vec<Method> = methods.into_iter().filter(|method| is_asked_for(entry, *method)).collect();
    for &method in &methods {
        for &retraction in &retractions {
            let what = format!("{name} {method} {}", retraction.name());
            match certify(entry, &entry.example, method, retraction, Order::Two) {
                Ok(report) if report.passed() => {
                    reports += 1;
                    measured += report.certificates.len();
                }
                Ok(report) => failures += &format!("{what}\n{report}\n"),
                Err(error) => failures += &format!("{what}: {error}\n"),
            }
        }
    }
    assert!(failures.is_empty(), "{failures}");
    // of ten certificates or more
    let all = methods.len() * retractions.len();
    assert!(reports == all && measured >= 10 * all, "{name}: {measured} certificates in {reports} reports");
}

/// A charge as fast as a tenth of light in a magnetic field, by its Lagrangian: there are no velocities beyond that of light.
#[lie_poisson_system(
    group = R3,
    lagrangian = {
        let v = velocity;
        -mass * light * light * (1.0 - v.dot(&v) / (light * light)).sqrt()
            + charge * 0.5 * field.dot(&position.cross(&v))
    },
)]
struct FastCharge {
    mass: f64,
    light: f64,
    charge: f64,
    field: Vector3<f64>,
}

impl Example for FastCharge {
    fn example() -> (Self, FastChargeState) {
        let system = Self { mass: 1.0, light: 1.0, charge: 1.0, field: vector![0.0, 0.0, 2.0] };
        let position = vector![0.1, 0.2, 0.3];
        let at_rest = FastChargeState { position, momentum: Vector3::zeros() };
        let start = system.with_velocity(&at_rest, &vector![0.95, 0.1, -0.2]).expect("slower than light");
        (system, start)
    }
}

#[test]
fn probes_stay_where_the_energy_is_defined() {
    let entry = FastCharge::entry();
    for retraction in [Retraction::Exponential, Retraction::Cayley] {
        let report =
            certify(&entry, &entry.example, Method::Standard, retraction, Order::Two).expect("measured");
        assert!(report.passed(), "{report}");
    }
}

/// What rests shows nothing: a quadrotor in hover is certified where it moves.
#[test]
fn a_system_whose_example_rests_is_certified_in_motion() {
    for (name, at_rest) in [("hovering_quadrotor", true), ("quadrotor", false), ("heavy_top", false)] {
        let entry = CATALOGUE.find(name).expect("it is there");
        let setup = entry.example.clone();
        let (states, rests) = states_in_motion(entry, &setup).expect("solvable");
        assert_eq!((states.len(), rests), (3, at_rest), "{name}");
        let system = entry.system(&setup.parameters);
        for state in &states {
            assert!(system.deviation(state) < 1e-14, "{name}");
            let motion = system.motion(state, 0.0, &[]);
            assert!(motion.iter().filter(|rate| rate.abs() > 1e-4).count() >= 6, "{name}: {motion:?}");
        }
        assert_ne!(states[0], states[1], "{name}");
    }
    // a rate of up to 1 rad/s and 1 m/s: momenta of 0.1 kg m²/s and of some kg m/s
    let entry = CATALOGUE.find("hovering_quadrotor").expect("it is there");
    let setup = entry.example.clone();
    let (states, _) = states_in_motion(entry, &setup).expect("solvable");
    let [inertia_x, inertia_y, inertia_z, mass, _] = setup.parameters[..] else { panic!("five parameters") };
    for state in states {
        let momenta = state[4..7].iter().zip([inertia_x, inertia_y, inertia_z]);
        let rates =
            momenta.chain(state[10..13].iter().zip([mass; 3])).map(|(momentum, inertia)| momentum / inertia);
        let rates: Vec<f64> = rates.collect();
        assert!(rates.iter().all(|rate| rate.abs() <= 1.0), "{rates:?}");
        assert!(rates.iter().any(|rate| rate.abs() > 0.3), "{rates:?}");
    }
}
