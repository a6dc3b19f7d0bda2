//! Many members at once.

use super::{Scratch, text};

#[test]
fn an_ensemble_spreads() {
    let scratch = Scratch::new("ensemble");
    let run = |extra: &[&str]| {
        let arguments =
            ["ensemble", "free_rigid_body", "--members", "50", "--duration", "20", "--every", "100"];
        scratch.prints(&[&arguments[..], extra].concat())
    };
    let printed = run(&["--spread", "inertia=2%", "--quantity", "energy", "--quantity", "momentum_y"]);
    assert!(printed.contains("50 members, 100,000 steps"), "{printed}");
    let stem = "free_rigid_body-ensemble";
    assert_eq!(scratch.files("out"), ["csv", "png", "svg"].map(|extension| format!("{stem}.{extension}")));

    let table = scratch.read(&format!("out/{stem}.csv"));
    let rows: Vec<Vec<f64>> = table
        .lines()
        .skip(1)
        .map(|line| line.split(',').map(|cell| cell.parse().expect("a number")).collect())
        .collect();
    let columns: Vec<&str> = table.lines().next().expect("a header").split(',').collect();
    let column = |name: &str| {
        let index = columns.iter().position(|column| *column == name).expect(name);
        rows.iter().map(|row| row[index]).collect::<Vec<f64>>()
    };
    assert_eq!(column("time").len(), 21);
    assert!(column("momentum_y_members").iter().all(|&members| members == 50.0));
    // all start with the same momentum, and none keeps it
    let deviations = column("momentum_y_deviation");
    assert_eq!(deviations[0], 0.0);
    assert!(deviations[20] > 1e-3, "{deviations:?}");
    // of different bodies the energies differ, and stay what they are
    let (min, max) = (column("energy_min"), column("energy_max"));
    assert!(max[0] - min[0] > 0.01, "{min:?} {max:?}");
    let drift = (max[20] - max[0]).abs().max((min[20] - min[0]).abs());
    assert!(drift < 1e-4, "{drift:e}");

    // the same seed draws the same members
    run(&["--spread", "inertia=2%", "--quantity", "energy", "--quantity", "momentum_y"]);
    assert_eq!(scratch.read(&format!("out/{stem}.csv")), table);
    run(&["--spread", "inertia=2%", "--quantity", "energy", "--quantity", "momentum_y", "--seed", "2"]);
    assert_ne!(scratch.read(&format!("out/{stem}.csv")), table);
}

#[test]
fn an_ensemble_that_cannot_be_is_refused() {
    let scratch = Scratch::new("no-ensemble");
    for (arguments, expected) in [
        (&["--spread", "momentun=1"][..], "did you mean `momentum`?"),
        (&["--spread", "momentum"], "has no `=`"),
        (&["--spread", "momentum=-1"], "must be finite and not negative"),
        (&["--spread", "momentum=1,2"], "takes 3 numbers separated by commas or one, got 2"),
        (&["--spread", "attitude=1%"], "write `attitude=5deg` or `attitude=0.1rad`"),
        (&["--quantity", "enrgy"], "did you mean `energy`?"),
        (&["--members", "0"], "0 is not in"),
        (&["--spread", "inertia=300%"], "not positive definite"),
    ] {
        let output = scratch.coadjoint(&[&["ensemble", "heavy_top", "--duration", "1"], arguments].concat());
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(message.contains(expected), "{arguments:?}: {message}");
    }
    assert!(scratch.files("out").is_empty());
}

/// A system whose own law chooses the controls.
#[test]
fn an_ensemble_is_controlled() {
    let scratch = Scratch::new("controlled-ensemble");
    let arguments =
        ["ensemble", "quadrotor", "--members", "9", "--quantity", "position_z", "--duration", "2"];
    let printed = scratch.prints(&[&arguments[..], &["--spread", "attitude_momentum=0.001"]].concat());
    assert!(printed.contains("9 members"), "{printed}");
    assert!(scratch.read("out/quadrotor-ensemble.csv").lines().count() > 20);
}

/// The tensor of a body in axes of any direction stays symmetric, and positive definite where it varies little.
#[test]
fn a_full_inertia_spreads() {
    let scratch = Scratch::new("full-inertia");
    let spread = ["ensemble", "full_rigid_body", "--members", "200", "--duration", "5", "--spread"];
    let printed = scratch.prints(&[&spread[..], &["inertia=1%"]].concat());
    assert!(printed.contains("inertia_xy") && !printed.contains("inertia_yx"), "{printed}");
    let refused = scratch.coadjoint(&[&spread[..], &["inertia=200%"]].concat());
    let message = text(&refused.stderr);
    assert!(message.starts_with("error: member ") && message.contains("not positive definite"), "{message}");
}
