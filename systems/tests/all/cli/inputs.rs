//! Controls from tables.

use super::{Scratch, text};

#[test]
fn a_run_is_driven_by_a_table_and_made_again() {
    let scratch = Scratch::new("input");
    let table = |thrust: f64| {
        let rows = (0..5).map(|k| format!("{},{}\n", f64::from(k) * 0.25, thrust + f64::from(k)));
        format!("time,thrust\n{}", rows.collect::<String>())
    };
    std::fs::write(scratch.0.join("thrust.csv"), table(12.0)).expect("written");
    let run = ["run", "quadrotor", "--duration", "1", "--step", "0.05", "--input", "thrust.csv"];
    let printed = scratch.prints(&run);
    let words = printed.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        words.contains("no column for `moment_x`, `moment_y`, `moment_z`: each is 0 unless"),
        "{printed}"
    );
    let name = scratch.files("out").into_iter().find(|name| name.ends_with(".csv")).expect("a table");
    let written = scratch.read(&format!("out/{name}"));
    let thrust = written.lines().next().expect("a header").split(',').position(|column| column == "thrust");
    let column: Vec<f64> = written
        .lines()
        .skip(1)
        .map(|row| row.split(',').nth(thrust.expect("a column")).expect("a cell").parse().expect("a number"))
        .collect();
    // linear in the table, and so in the spline
    for (k, thrust) in column.iter().enumerate() {
        assert!((thrust - (12.0 + 0.2 * k as f64)).abs() < 1e-12, "{column:?}");
    }
    let made = scratch.path(&format!("out/{name}")).with_extension("run.json");
    let beside = std::fs::read_to_string(made).expect("what made it");
    assert!(beside.contains("--input thrust.csv"), "{beside}");

    let made = scratch.path(&format!("out/{name}")).display().to_string();
    scratch.prints(&["run", "--again", &made, "--out", "again"]);
    assert_eq!(scratch.read(&format!("again/{name}")), written);
    // with another table it is another run
    std::fs::write(scratch.0.join("thrust.csv"), table(12.5)).expect("written");
    let output = scratch.coadjoint(&["run", "--again", &made, "--out", "third"]);
    assert_ne!(output.status.code(), Some(0), "{}", text(&output.stderr));
    scratch.prints(&run);
    assert_eq!(scratch.files("out").iter().filter(|name| name.ends_with(".csv")).count(), 2);

    scratch.prints(&["ensemble", "quadrotor", "--members", "9", "--duration", "1", "--input", "thrust.csv"]);
}

#[test]
fn a_table_that_is_none_is_refused() {
    let scratch = Scratch::new("no-input");
    std::fs::write(scratch.0.join("thrust.csv"), "time,trust\n0,1\n1,2\n").expect("written");
    for (arguments, expected) in [
        (&["run", "quadrotor", "--input", "thrust.csv"][..], "has no control `trust`: it has"),
        (&["run", "heavy_top", "--input", "thrust.csv"], "it has none"),
        (&["run", "quadrotor", "--input", "missing.csv"], "missing.csv"),
        (&["run", "quadrotor", "--interpolation", "linear"], "--input"),
    ] {
        let output = scratch.coadjoint(arguments);
        let message = text(&output.stderr);
        assert!(!output.status.success() && message.contains(expected), "{message}");
    }
    assert!(scratch.files("out").is_empty());
}

#[test]
fn an_order_is_kept_with_a_table() {
    let scratch = Scratch::new("input-order");
    let description = "#[lie_poisson_system(
        group = R1, control(push: f64), force = push, potential = 0.5 * position.x.powi(2), methods(HamiltonJacobi(4))
    )]
    struct Mass { #[inertia] mass: f64 }";
    std::fs::write(scratch.0.join("mass.rs"), description).expect("written");
    let rows = (0..=40).map(|k| f64::from(k) * 0.05).map(|time| format!("{time},{}\n", (2.0 * time).sin()));
    std::fs::write(scratch.0.join("push.csv"), format!("time,push\n{}", rows.collect::<String>()))
        .expect("written");
    let run = [
        "run",
        "--description",
        "mass.rs",
        "--duration",
        "2",
        "--step",
        "0.1",
        "--set",
        "mass=1",
        "--order",
        "4",
    ];
    let with = |more: &[&str]| {
        let printed = scratch.prints(&[&run[..], &["--out", "-", "--format", "csv"], more].concat());
        let output = scratch.coadjoint(&[&run[..], &["--out", "-", "--format", "csv"], more].concat());
        (printed, text(&output.stderr))
    };
    let end = |printed: &str| -> f64 {
        let last = printed.lines().rfind(|line| line.starts_with("2.0,")).expect("the last row");
        last.split(',').nth(1).expect("a position").parse().expect("a number")
    };
    // x'' = sin 2t − x from rest at zero
    let exact = 2.0 / 3.0 * 2.0_f64.sin() - 4.0_f64.sin() / 3.0;
    let (composed, said) = with(&["--input", "push.csv"]);
    assert!((end(&composed) - exact).abs() < 1e-6, "{} {exact}", end(&composed));
    assert!(!said.contains("of order 2 then"), "{said}");
    let (held, said) = with(&["--input", "push.csv", "--method", "hamilton-jacobi"]);
    assert!((end(&held) - exact).abs() > 1e-5, "{} {exact}", end(&held));
    assert!(said.contains("of order 2 then"), "{said}");
    let (_, said) = with(&["--method", "hamilton-jacobi"]);
    assert!(!said.contains("of order 2 then"), "{said}");
}
