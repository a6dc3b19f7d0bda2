//! Notes on steps that are longer than the series of Hamilton–Jacobi steps allows.

use std::fs;

use crate::program::Scratch;

/// Systems with steps of order 6, and what is set of them.
const SYSTEMS: [(&str, &str, &[&str]); 3] = [
    (
        "Kepler",
        "group(position: R2), potential = -strength / position.norm()",
        // the far end of an orbit with eccentricity ½, where a period later it ends
        &["strength=1", "mass=1", "position=1.5,0", "position_momentum=0,0.57735"],
    ),
    ("Body", "group = SO3", &["mass=1,10,100", "momentum=1,1,1"]),
    (
        "Top",
        "group = SO3, advected(gamma: R3), potential = strength * (0.3 * gamma.x + gamma.z)",
        &["strength=1", "mass=1,2,2.5", "momentum=1,-0.9,1", "gamma=0.3,0.4,0.866"],
    ),
];

/// Runs a system for a time, and gives what is printed in one line.
fn run(scratch: &Scratch, (name, about, set): (&str, &str, &[&str]), more: &[&str]) -> String {
    let kind = if name == "Kepler" { "f64" } else { "Vector3<f64>" };
    let strength = if about.contains("strength") { "strength: f64," } else { "" };
    let text = format!(
        "#[lie_poisson_system({about}, methods(HamiltonJacobi(6)))]\nstruct {name} {{ #[inertia] mass: {kind}, {strength} }}"
    );
    fs::write(scratch.0.join("system.rs"), text).expect("written");
    let mut arguments = vec!["run", "--description", "system.rs", "--order", "6", "--force"];
    arguments.extend(set.iter().flat_map(|set| ["--set", set]));
    arguments.extend(more);
    scratch.prints(&arguments).split_whitespace().collect::<Vec<_>>().join(" ")
}

/// What is said of a series, and the step that is to be taken.
fn noted(printed: &str) -> Option<f64> {
    let (_, note) =
        printed.split_once("more than the series of Hamilton–Jacobi steps allows: take a step below ")?;
    note.split(' ').next()?.parse().ok()
}

#[test]
fn a_step_that_no_series_follows_is_noted_with_one_that_it_does() {
    let scratch = Scratch::new("series");
    for (system, retraction, long, short) in [
        (SYSTEMS[0], "exponential", "0.3", "0.1"),
        (SYSTEMS[1], "exponential", "2.2", "1"),
        (SYSTEMS[1], "cayley", "1.5", "0.5"),
        (SYSTEMS[2], "exponential", "1.4", "0.5"),
        (SYSTEMS[2], "cayley", "1", "0.2"),
    ] {
        let with = |step: &str| {
            run(&scratch, system, &["--retraction", retraction, "--step", step, "--duration", "6.2832"])
        };
        let printed = with(long);
        let step = noted(&printed).unwrap_or_else(|| panic!("{} {retraction}: {printed}", system.0));
        assert!(step < long.parse().expect("a number"), "{}: {step}", system.0);
        let kept = with(&format!("{}", 0.95 * step));
        assert!(noted(&kept).is_none(), "{} {retraction} {step}: {kept}", system.0);
        assert!(noted(&with(short)).is_none(), "{} {retraction}", system.0);
    }
}

/// At the far end of an orbit, where it starts and ends, the step is none too long.
#[test]
fn what_is_fast_in_between_is_seen() {
    let scratch = Scratch::new("series_between");
    let [orbit, ..] = SYSTEMS;
    let step = ["--retraction", "exponential", "--step", "0.3", "--duration"];
    assert!(noted(&run(&scratch, orbit, &[&step[..], &["1.2"]].concat())).is_none());
    let printed = run(&scratch, orbit, &[&step[..], &["6.3"]].concat());
    assert!(noted(&printed).is_some() && printed.contains("`position"), "{printed}");
}

/// Steps that are no series have none.
#[test]
fn other_steps_are_not_noted() {
    let scratch = Scratch::new("series_other");
    let composed = ["--method", "standard", "--step", "0.3", "--duration", "6"];
    assert!(noted(&run(&scratch, SYSTEMS[0], &composed)).is_none());
}
