//! Every entry of the catalogue, run for a while with everything that the program offers.

use std::ops::ControlFlow;

use coadjoint::scheme::Rule;
use coadjoint::system::{Quantity, Role};
use coadjoint_app::Entry;
use coadjoint_app::record::ConservationReport;
use coadjoint_app::setup::{Classical, Job, Method, Order, Retraction, check, standard};
use coadjoint_app::simulate::{Checkpoint, Sample, simulate};
use coadjoint_systems::catalogue::CATALOGUE;

use crate::cli::{Scratch, table};
use crate::is_asked_for;

/// The largest energy error relative to the energy that steps of order 2 may make.
const SECOND: f64 = 5e-3;
/// Every sample is to be seen.
const EVERY: fn(u64) -> u64 = |index| index + 1;
/// That steps of order 1 may make.
const FIRST: f64 = 0.1;

entries!(examine);

fn examine(name: &str) {
    let entry = CATALOGUE.find(name).expect("it is there");
    let setup = entry.example.clone();
    let run = |method, retraction, order| -> ConservationReport {
        let job = Job { method, retraction, order, step: entry.step, steps: 500, rest: 0.0 };
        let mut conservation = None;
        let mut samples = 0;
        let report = simulate(entry, &setup, &job, None, &EVERY, &mut |sample| {
            samples += 1;
            assert!(sample.state.iter().all(|x| x.is_finite()), "{name}, {job:?}");
            conservation.get_or_insert_with(|| ConservationReport::new(sample)).push(sample);
            ControlFlow::Continue(())
        });
        let report = report.unwrap_or_else(|error| panic!("{name}, {job:?}: {error}"));
        assert_eq!((report.steps, samples), (500, 501), "{name}, {job:?}");
        let conservation = conservation.expect("samples");
        for stats in &conservation.casimirs {
            assert!(stats.error <= 1e-12 * stats.initial.abs().max(1.0), "{name}, {job:?}: {}", stats.error);
        }
        conservation
    };
    let retractions = Retraction::of(entry);
    for &retraction in &retractions {
        for method in Method::COMMON.into_iter().filter(|method| is_asked_for(entry, *method)) {
            let energy = run(method, retraction, Order::Two).energy;
            let (error, energy) = (energy.error, energy.initial.abs());
            if !entry.description.autonomous {
                continue;
            }
            let is_standard = standard(entry, retraction) == method;
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
        run(Method::Standard, retractions[0], order);
    }
    let cayley = retractions.iter().copied().find(|retraction| *retraction == Retraction::Cayley);
    let retraction = cayley.unwrap_or(retractions[0]);
    for (method, order) in [
        (Method::Standard, Order::Two),
        (Method::MIDPOINT, Order::Four),
        (Method::Classical(Classical::Rk4), Order::Two),
        (Method::Classical(Classical::ImplicitMidpoint), Order::Two),
        (Method::Classical(Classical::Rkmk4), Order::Two),
    ] {
        if is_asked_for(entry, method) {
            comes_to_the_same(
                entry,
                &Job { method, retraction, order, step: entry.step, steps: 60, rest: 0.25 * entry.step },
            );
        }
    }
    every_command_runs(entry);
    if entry.has_right_lift() {
        // what it carries is the momentum in space
        let (method, order) = (Method::RightLift, Order::Two);
        let job = Job {
            method,
            retraction: Retraction::Exponential,
            order,
            step: entry.step,
            steps: 60,
            rest: 0.0,
        };
        comes_to_the_same(entry, &job);
    }
}

/// Each command takes each system as it stands in the catalogue.
fn every_command_runs(entry: &Entry) {
    let (name, scratch) = (&entry.name[..], Scratch::new(&format!("commands-{}", entry.name)));
    let duration = (4.5 * entry.step).to_string();
    let short = ["--duration", &duration];
    scratch.prints(&[&["run", name, "--every", "3", "--columns", "velocity"], &short[..]].concat());
    let file = scratch.files("out").pop().expect("a trajectory");
    let path = scratch.path(&format!("out/{file}"));
    let again = scratch.prints(&["run", "--again", &path.to_string_lossy(), "--out", "again"]);
    assert!(again.contains("trajectory: "), "{again}");
    let csv = scratch.read(&format!("out/{file}"));
    assert_eq!(csv, scratch.read(&format!("again/{file}")));
    // a header of names that differ, then numbers alone, as NumPy reads them
    let (header, rows) = table(&csv);
    assert!(header.iter().enumerate().all(|(k, column)| !header[..k].contains(column)), "{header:?}");
    assert!(header.iter().all(|column| column.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_')));
    assert!(rows.iter().all(|row| row.len() == header.len()), "{csv}");
    let times: Vec<f64> = rows.iter().map(|row| row[0]).collect();
    assert_eq!(times, [0.0, 3.0 * entry.step, duration.parse().expect("a number")]);

    scratch.prints(&["init", name]);
    let config = format!("{name}.toml");
    scratch.prints(&[&["run", "--config", &config, "--out", "described"], &short[..]].concat());
    scratch.prints(&[&["view", name], &short[..]].concat());
    scratch.prints(&[&["ensemble", name, "--members", "9"], &short[..]].concat());
    scratch.prints(
        &[&["run", name, "--scan", &format!("step={0},{1}", entry.step, 0.5 * entry.step)], &short[..]]
            .concat(),
    );
}

/// A run that is interrupted and gone on with, twice, comes to the last bit to where one that was not does, and sees the same.
fn comes_to_the_same(entry: &Entry, job: &Job) {
    let setup = entry.example.clone();
    // the samples from `from` to the step `until`, as their bits, and where the run is then
    let run = |from: Option<&Checkpoint>, until: u64| {
        let mut seen = Vec::new();
        let mut checkpoint = Checkpoint::default();
        let watch = &mut |sample: &Sample<'_>| {
            let numbers = sample.state.iter().chain(sample.casimirs).chain([&sample.time, &sample.energy]);
            seen.push((sample.index, numbers.map(|x| x.to_bits()).collect::<Vec<u64>>()));
            checkpoint = Checkpoint::at(sample);
            if sample.index < until { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        };
        simulate(entry, &setup, job, from, &EVERY, watch).expect("solvable");
        (seen, checkpoint)
    };
    let (whole, _) = run(None, job.total());
    let (mut pieces, first) = run(None, 1);
    let (second, middle) = run(Some(&first), 37);
    let (third, _) = run(Some(&middle), job.total());
    for piece in [second, third] {
        // the sample it resumes from was recorded before
        assert_eq!(pieces.last(), piece.first(), "{}, {job:?}", entry.name);
        pieces.extend(piece.into_iter().skip(1));
    }
    assert!(pieces == whole, "{}, {job:?}", entry.name);
}

#[test]
fn compositions_need_symmetric_steps() {
    for entry in CATALOGUE.entries() {
        let setup = entry.example.clone();
        for method in [
            Method::EULER_A,
            Method::EULER_B,
            Method::Step(Rule::TangentLift(0, 1)),
            Method::Classical(Classical::Gauss4),
        ] {
            let job = Job {
                method,
                retraction: Retraction::Cayley,
                order: Order::Four,
                step: 0.01,
                steps: 1,
                rest: 0.0,
            };
            let ran = simulate(entry, &setup, &job, None, &EVERY, &mut |_| ControlFlow::Continue(()));
            let error = ran.expect_err("not symmetric");
            let message = error.to_string();
            assert!(
                message.contains(&method.to_string()) && message.contains("standard, midpoint, verlet"),
                "{message}"
            );
        }
    }
}

#[test]
fn entries_are_complete_and_consistent() {
    for entry in CATALOGUE.entries() {
        assert!(!entry.about.is_empty() && !entry.about.ends_with('.'), "{}", entry.name);
        assert!(entry.step > 0.0 && entry.duration > entry.step, "{}", entry.name);
        let setup = entry.example.clone();
        let count = |quantities: &[Quantity]| quantities.iter().map(|q| q.components.len()).sum::<usize>();
        // constants of the description follow the parameters
        assert!(setup.parameters.len() >= count(entry.description.parameters), "{}", entry.name);
        assert_eq!(setup.state.len(), count(entry.description.state), "{}", entry.name);
        assert_eq!(setup.controls, vec![None; count(entry.description.controls)], "{}", entry.name);
        assert_eq!(entry.columns().len(), setup.state.len() + setup.controls.len() + 2, "{}", entry.name);
        assert!(
            entry.description.parameters.iter().all(|quantity| quantity.role == Role::Parameter),
            "{}",
            entry.name
        );
        assert!(
            entry.description.controls.iter().all(|quantity| quantity.role == Role::Control),
            "{}",
            entry.name
        );
        let roles = |role| entry.description.state.iter().filter(|quantity| quantity.role == role).count();
        assert!(roles(Role::Configuration) > 0, "{}", entry.name);
        assert_eq!(roles(Role::Configuration), roles(Role::Momentum), "{}", entry.name);
        check(entry, &setup).expect("an example with valid parameters");
    }
}

#[test]
fn names_are_found_however_they_are_written() {
    for name in ["heavy_top", "heavy-top", "HeavyTop", "heavytop"] {
        assert_eq!(CATALOGUE.find(name).expect("it is there").name, "heavy_top");
    }
    assert!(CATALOGUE.find("heavy_tip").is_none());
}

#[test]
fn the_triangle_inequality_is_noticed() {
    let entry = CATALOGUE.find("free_rigid_body").expect("it is there");
    let note = |inertia: [f64; 3]| {
        let mut setup = entry.example.clone();
        setup.parameters.copy_from_slice(&inertia);
        check(entry, &setup).expect("positive definite")
    };
    assert_eq!(note([1.0, 2.0, 2.5]), None);
    // a flat plate lies on the border
    assert_eq!(note([1.0, 2.0, 3.0]), None);
    let text = note([1.0, 100.0, 10.0]).expect("not a body");
    assert!(text.contains("moments of inertia 1, 10, 100:"), "{text}");
}

#[test]
fn schemes_have_the_names_that_the_command_line_takes() {
    use clap::ValueEnum;
    for retraction in Retraction::ALL {
        assert_eq!(Retraction::from_str(retraction.name(), false), Ok(retraction));
    }
    assert_eq!(Retraction::from_str("exp", false), Ok(Retraction::Exponential));
    let lifts = [
        Method::RightLift,
        Method::Step(Rule::TangentLift(0, 1)),
        Method::Step(Rule::TangentLift(1, 2)),
        Method::Step(Rule::Family(1, 4)),
        Method::Step(Rule::Family(2, 3)),
    ];
    let classical = Classical::ALL.map(Method::Classical);
    for method in Method::COMMON.into_iter().chain(lifts).chain(classical) {
        assert_eq!(method.to_string().parse(), Ok(method));
        assert!(!method.stem().contains(['/', '=']), "{method}");
    }
    for (name, method) in [("family=2/8", Method::Step(Rule::Family(1, 4))), ("family=0", Method::EULER_A)] {
        assert_eq!(name.parse(), Ok(method));
    }
    assert_eq!(
        ["family=2/4", "family=1", "family=3/3"].map(str::parse),
        [Ok(Method::MIDPOINT), Ok(Method::EULER_B), Ok(Method::EULER_B)]
    );
    for name in [
        "family=5/4",
        "family=1/0",
        "family=-1/2",
        "family=",
        "family=0.25",
        "tangent-lift=2",
        "rk5=1/2",
        "rk5",
        "",
    ] {
        assert!(name.parse::<Method>().is_err(), "{name}");
    }
    for order in Order::ALL {
        assert_eq!(Order::from_str(&order.number().to_string(), false), Ok(order));
    }
}
