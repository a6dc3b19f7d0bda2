//! Runs: the table of a motion, methods and orders, and what is told of them.

use std::fs;
use std::process::{Command, Output, Stdio};

use serde_json::Value;

use super::{Scratch, shown, table, text};

#[test]
fn list_names_systems_parameters_and_defaults() {
    let scratch = Scratch::new("list");
    let listing = scratch.prints(&["list"]);
    for expected in ["free_rigid_body ", "heavy_top ", "kovalevskaya_top ", "kirchhoff "] {
        assert!(listing.contains(expected), "{expected} in\n{listing}");
    }
    for (system, all) in [
        (
            "heavy_top",
            &["inertia=1,10,100  kg m²", "weight=1  N", "momentum=1,1,1", "energy, J", "|gamma|²"][..],
        ),
        ("quadrotor", &["controls\n  moment", "chosen by the system's own law"]),
        ("driven_pendulum", &["conserved\n  nothing"]),
        ("navigation", &["conserved\n  energy while the controls are the same"]),
        (
            "free_rigid_body",
            &[
                "methods      standard, euler-a, euler-b, midpoint, verlet, tangent-lift,",
                "             tangent-midpoint, family=1/4, right-lift",
            ],
        ),
        ("harmonic_oscillator", &["verlet, tangent-lift,", "family=1/4"]),
    ] {
        let told = scratch.prints(&["list", system]);
        for expected in all {
            assert!(told.contains(expected), "{expected} in\n{told}");
        }
    }
    // all of it in 80 columns
    let systems = listing.lines().filter_map(|line| line.split(' ').next()).filter(|name| name.contains('_'));
    let told: Vec<String> = systems.map(|system| scratch.prints(&["list", system])).collect();
    for line in told.iter().flat_map(|told| told.lines()).chain(listing.lines()) {
        let is_assignment = line.starts_with("  ") && line.contains('=');
        assert!(line.chars().count() <= 80 || is_assignment, "{line}");
    }
}

#[test]
fn run_writes_a_table_of_the_motion() {
    let scratch = Scratch::new("run-csv");
    let printed = scratch.prints(&["run", "heavy_top", "--duration", "2", "--step", "0.01", "--every", "50"]);
    assert!(printed.contains("largest energy error") && printed.contains("exponential"), "{printed}");
    assert_eq!(scratch.files("out"), ["heavy_top-exponential.csv"]);

    let csv = scratch.read("out/heavy_top-exponential.csv");
    let (header, rows) = table(&csv);
    assert_eq!(
        header,
        [
            "time",
            "attitude_w",
            "attitude_x",
            "attitude_y",
            "attitude_z",
            "momentum_x",
            "momentum_y",
            "momentum_z",
            "gamma_x",
            "gamma_y",
            "gamma_z",
            "energy"
        ]
    );
    assert_eq!(rows.iter().map(|row| row[0]).collect::<Vec<_>>(), [0.0, 0.5, 1.0, 1.5, 2.0]);
    assert_eq!(rows[0][1..], [1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.5 * 1.11 + 1.0]);
    for row in &rows {
        let norm = |range: std::ops::Range<usize>| row[range].iter().map(|x| x * x).sum::<f64>().sqrt();
        assert!((norm(1..5) - 1.0).abs() < 1e-14, "attitude");
        assert!((norm(8..11) - 1.0).abs() < 1e-14, "gamma");
        assert!((row[11] - 1.555).abs() < 1e-3, "energy");
    }
    assert_ne!(rows[4][5..8], rows[0][5..8], "it moves");
}

/// Errors are those of the steps that are looked at, unless all are asked for; and a run is made again as it was.
#[test]
fn every_thins_what_is_looked_at() {
    let error = |more: &[&str]| {
        let scratch = Scratch::new(&format!("looked-at-{}", more.len()));
        let run = ["run", "planar_pendulum", "--step", "0.01", "--duration", "60", "--format", "json"];
        scratch.prints(&[&run[..], more].concat());
        let (name, text) =
            ("planar_pendulum-exponential.json", scratch.read("out/planar_pendulum-exponential.json"));
        let json: Value = serde_json::from_str(&text).expect("JSON");
        let file = scratch.path(&format!("out/{name}"));
        scratch.prints(&["run", "--again", &file.to_string_lossy(), "--out", "again"]);
        assert!(text == scratch.read(&format!("again/{name}")), "{more:?}");
        json["invariants"].clone()
    };
    let all = error(&[]);
    assert_eq!(error(&["--every", "500", "--watch-every-step"]), all);
    assert_ne!(error(&["--every", "500"]), all);
}

/// What is found of a run whose every step is looked at does not depend on how much of it is written.
#[test]
fn every_thins_what_is_written_and_nothing_else() {
    let found = |every: u64| {
        let scratch = Scratch::new(&format!("every-{every}"));
        // the last state is written, too
        let (number, rows) = (every.to_string(), 6000_u64.div_ceil(every) as usize + 1);
        let run = [
            "run",
            "planar_pendulum",
            "--step",
            "0.01",
            "--duration",
            "60",
            "--watch-every-step",
            "--every",
            &number,
        ];
        let printed =
            scratch.prints(&[&run[..], &["--plot", "--html", "view.html", "--format", "json"]].concat());
        let told: Vec<String> = printed
            .lines()
            .filter(|line| !["time per step", "wrote"].iter().any(|told| line.starts_with(told)))
            .map(str::to_owned)
            .collect();
        let stem = "out/planar_pendulum-exponential";
        let json: Value = serde_json::from_str(&scratch.read(&format!("{stem}.json"))).expect("JSON");
        assert_eq!(json["rows"].as_array().map(Vec::len), Some(rows));
        let page = scratch.read("view.html");
        assert_eq!(shown(&page)["time"].as_array().map(Vec::len), Some(3001));
        (told, json["invariants"].clone(), scratch.read(&format!("{stem}.svg")), page)
    };
    let all = found(1);
    assert!(all.0.iter().any(|line| line.ends_with("and does not grow")), "{:?}", all.0);
    for every in [177, 1_000_000] {
        let thinned = found(every);
        assert_eq!((&thinned.0, &thinned.1), (&all.0, &all.1));
        assert!(thinned.2 == all.2, "the picture depends on `--every {every}`");
        assert!(thinned.3 == all.3, "the page depends on `--every {every}`");
    }
}

/// An interrupted run tells of all steps that it took, whatever was written of them.
#[test]
#[cfg(unix)]
fn an_interrupted_run_tells_where_it_stopped() {
    use std::io::{BufRead, BufReader};
    let scratch = Scratch::new("interrupted");
    let mut child = Command::new(env!("CARGO_BIN_EXE_coadjoint"))
        .args(["run", "heavy_top", "--duration", "1e9", "--every", "100000000000"])
        .current_dir(&scratch.0)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    // now and then it tells how far it has come
    let mut line = String::new();
    BufReader::new(child.stderr.as_mut().expect("piped")).read_line(&mut line).expect("readable");
    let words: Vec<&str> = line.split(' ').collect();
    let ["heavy_top:", "step", step, ..] = words[..] else { panic!("{line}") };
    Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill");
    let output = child.wait_with_output().expect("it ends");
    assert_eq!(output.status.code(), Some(130));
    let printed = text(&output.stdout);
    let value = |name: &str| printed.lines().find_map(|line| line.strip_prefix(name)).expect(name).trim();
    let steps: u64 = value("steps").replace(',', "").parse().expect("a number");
    assert!(steps >= step.parse().expect("a number"), "{line}{printed}");
    let time: f64 = value("interrupted at").trim_end_matches(" s").parse().expect("a number");
    assert!((time - steps as f64 * 0.01).abs() < 1e-6, "{printed}");
    assert!(value("largest energy error, J").parse::<f64>().expect("a number") > 1e-7, "{printed}");
}

#[test]
fn methods_and_orders_are_told_apart() {
    let scratch = Scratch::new("methods");
    let run = |arguments: &[&str]| {
        scratch.prints(&[&["run", "coupled-bodies", "--duration", "0.2"], arguments].concat())
    };
    for (arguments, method, order) in [
        (&[][..], "standard (verlet)", "2"),
        (&["--method", "euler-a"], "euler-a", "1"),
        (&["--method", "euler-b"], "euler-b", "1"),
        (&["--method", "midpoint", "--order", "4"], "midpoint", "4"),
        (&["--method", "verlet"], "verlet", "2"),
        (&["--method", "rk4"], "rk4", "4"),
        (&["--method", "gauss6"], "gauss6", "6"),
        (&["--method", "rkmk4"], "rkmk4", "4"),
    ] {
        let printed = run(arguments);
        let value = |name: &str| printed.lines().find_map(|line| line.strip_prefix(name)).map(str::trim);
        assert_eq!((value("method"), value("order")), (Some(method), Some(order)), "{printed}");
        assert!(printed.contains("largest energy error"), "{printed}");
    }
    assert_eq!(
        scratch.files("out"),
        [
            "euler-a-exponential",
            "euler-b-exponential",
            "exponential",
            "gauss6",
            "midpoint-order4-exponential",
            "rk4",
            "rkmk4",
            "verlet-exponential"
        ]
        .map(|name| format!("coupled_bodies-{name}.csv"))
    );
    // from one equation, where that was generated; composed, where it is asked for
    for (arguments, method) in
        [(&[][..], "hamilton-jacobi"), (&["--method", "standard"], "standard (euler-a)")]
    {
        let all = [&["run", "free_rigid_body", "--duration", "0.2", "--order", "6"], arguments].concat();
        let printed = scratch.prints(&all);
        let is_there = |line: &str| line.starts_with("method ") && line.ends_with(method);
        assert!(printed.lines().any(is_there), "{printed}");
        assert!(printed.lines().any(|line| line.starts_with("order ") && line.ends_with(" 6")), "{printed}");
    }
    // with the reduced step as the standard
    let printed = scratch.prints(&["run", "free_rigid_body", "--duration", "0.2", "--method", "euler-b"]);
    assert!(printed.lines().any(|line| line.starts_with("order ") && line.ends_with(" 2")), "{printed}");
}

/// RK4 in the numbers as they are stored and RKMK4 at one's own step, beside ours: what drifts is told.
#[test]
fn classical_methods_are_compared_with_at_ones_own_step() {
    let scratch = Scratch::new("classical");
    let run = |method: &str| {
        scratch.prints(&[
            "run",
            "heavy_top",
            "--step",
            "0.1",
            "--duration",
            "60",
            "--method",
            method,
            "--plot",
        ])
    };
    let value = |printed: &str, name: &str| -> f64 {
        let line = printed.lines().find_map(|line| line.strip_prefix(name)).expect(name);
        line.trim().parse().expect("a number")
    };
    let (rk4, rkmk4, ours) = (run("rk4"), run("rkmk4"), run("standard"));
    let (casimir, group) = ("drift of |gamma|²", "largest distance from the group");
    assert!(value(&rk4, casimir) > 1e-5 && value(&rkmk4, casimir) > 1e-5, "{rk4}{rkmk4}");
    assert!(value(&ours, casimir) < 1e-13 && !ours.contains(group), "{ours}");
    assert!(value(&rk4, group) > 1e-7 && value(&rkmk4, group) < 1e-13, "{rk4}{rkmk4}");
    assert!(rk4.contains("|gamma|²: drifts"), "{rk4}");
    let svg = scratch.read("out/heavy_top-rk4.svg");
    assert!(svg.contains("heavy_top, rk4, h = 0.1 s") && !svg.contains("exponential"));

    let json = ["run", "heavy_top", "--method", "tangent-lift", "--format", "json"];
    let refused = scratch.coadjoint(&json);
    assert_eq!(refused.status.code(), Some(2), "{}", text(&refused.stderr));
    scratch.prints(&["run", "free_rigid_body", "--method", "rk4", "--duration", "1", "--format", "json"]);
    let json: Value = serde_json::from_str(&scratch.read("out/free_rigid_body-rk4.json")).expect("JSON");
    assert_eq!(
        (&json["method"], &json["order"], &json["retraction"]),
        (&"rk4".into(), &4.into(), &Value::Null)
    );
    scratch.prints(&["run", "harmonic_oscillator", "--method", "family=2/8", "--duration", "1"]);
    assert!(scratch.path("out/harmonic_oscillator-family-1-4-exponential.csv").exists());
}

#[test]
fn energy_that_is_not_conserved_is_not_called_an_error() {
    let scratch = Scratch::new("driven");
    let printed = scratch.prints(&["run", "driven_pendulum", "--duration", "1"]);
    assert!(printed.contains("largest change of energy, J (it is not conserved)"), "{printed}");
    let of_energy: Vec<&str> = printed.lines().filter(|line| line.contains("energy")).collect();
    assert!(of_energy.iter().all(|line| !line.contains("error")), "{printed}");
}

#[test]
fn the_papers_heavy_top_is_one_command() {
    let scratch = Scratch::new("paper");
    // it is what is run without a command
    let printed = scratch.prints(&[]);
    for expected in [
        "exponential",
        "cayley",
        "180,000",
        "time per step",
        "largest energy error",
        "drift of",
        "iterations",
    ] {
        assert!(printed.contains(expected), "{expected} in\n{printed}");
    }
    assert_eq!(
        scratch.files("out"),
        [
            "figure-6.2.csv",
            "figure-6.2.png",
            "figure-6.2.svg",
            "figure-6.2.txt",
            "heavy_top-cayley.csv",
            "heavy_top-exponential.csv"
        ]
    );
    let csv = scratch.read("out/heavy_top-cayley.csv");
    let (_, rows) = table(&csv);
    assert_eq!(rows.len(), 18_001);
    assert_eq!(rows.last().expect("rows")[0], 1800.0);
    let svg = scratch.read("out/figure-6.2.svg");
    assert!(svg.len() < 1_000_000 && svg.contains("</svg>") && !svg.contains("NaN"));
    let png = fs::read(scratch.0.join("out/figure-6.2.png")).expect("a picture");
    assert_eq!(png[..8], *b"\x89PNG\r\n\x1a\n");
}

/// Without its motor the pendulum comes to rest, and what does not move can be computed for ever.
#[test]
fn a_motion_that_dies_out_is_computed_to_its_end() {
    let scratch = Scratch::new("rest");
    for (method, retraction) in [
        ("standard", "exponential"),
        ("standard", "cayley"),
        ("midpoint", "exponential"),
        ("midpoint", "cayley"),
    ] {
        let damped = ["run", "driven_pendulum", "--set", "torque=0", "--step", "0.05", "--duration", "5000"];
        let how = ["--method", method, "--retraction", retraction, "--every", "1000", "--out", "rest"];
        let output = scratch.coadjoint(&[&damped[..], &how].concat());
        assert!(output.status.success(), "{method}, {retraction}: {}", text(&output.stderr));
        let file = scratch.files("rest").pop().expect("a trajectory");
        let rows = scratch.read(&format!("rest/{file}"));
        let (_, last) = rows.trim_end().rsplit_once('\n').expect("rows");
        let numbers: Vec<f64> = last.split(',').map(|number| number.parse().expect("a number")).collect();
        let [time, _, angle, momentum, _] = numbers[..] else { panic!("{last}") };
        assert!(time == 5000.0 && angle.abs() < 1e-15 && momentum.abs() < 1e-15, "{last}");
        fs::remove_dir_all(scratch.0.join("rest")).expect("a directory");
    }
}

/// Starts a run that saves a checkpoint, and interrupts it when there are rows; None if it was over before the signal came.
#[cfg(unix)]
fn interrupted(scratch: &Scratch, run: &[&str]) -> Option<Output> {
    let mut child = Command::new(env!("CARGO_BIN_EXE_coadjoint"))
        .args([run, &["--html", "out/view.html", "--checkpoint", "run.ck"]].concat())
        .current_dir(&scratch.0)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let journal = scratch.0.join("run.ck.rows");
    while child.try_wait().expect("waits").is_none() {
        if fs::metadata(&journal).is_ok_and(|file| file.len() >= 1000) {
            Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill");
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    let output = child.wait_with_output().expect("it ends");
    if output.status.success() {
        return None;
    }
    assert_eq!(output.status.code(), Some(130), "{}", text(&output.stderr));
    Some(output)
}

/// The second of two is run.
#[cfg(unix)]
const BODIES: &str = "
#[lie_poisson_system(group = SO3, advected(gamma: R3), potential = gamma.z)] struct Other { #[inertia] inertia: Vector3<f64> }
#[lie_poisson_system(group = SO3)] struct Body { #[inertia] inertia: Vector3<f64> }";

/// Ctrl-C ends a run cleanly; gone on with, it writes the same bytes as one that was not interrupted.
#[test]
#[cfg(unix)]
fn an_interrupted_run_goes_on_to_the_same_bytes() {
    let (top, quadrotor) = (
        &["heavy_top", "--retraction", "cayley"][..],
        &["quadrotor", "--retraction", "cayley", "--set", "thrust=20", "--set", "moment_x=1e-6"][..],
    );
    // steps that are made of several Taylor steps each
    let taylor = &["heavy_top", "--tolerance", "1e-10", "--step", "0.5"][..];
    let described =
        &["body", "--description", "two.rs", "--set", "inertia=1,2,3", "--set", "momentum=1,1,0.1"];
    for (format, of) in [
        ("csv", top),
        ("json", top),
        ("parquet", top),
        ("json", quadrotor),
        ("csv", taylor),
        ("csv", &described[..]),
    ] {
        let (system, scheme) = (of[0], of[1].trim_start_matches('-'));
        // a signal that comes late, as it may where much else is done, finds a longer run in its midst
        let tried = ["300", "3000", "30000", "300000"].into_iter().find_map(|duration| {
            let scratch = Scratch::new(&format!("resume-{system}-{scheme}-{format}-{duration}"));
            fs::write(scratch.path("two.rs"), BODIES).expect("writable");
            let run = ["--duration", duration, "--every", "30", "--format", format];
            // pictures take longer than the run
            let plot = if format == "csv" { &["--plot"][..] } else { &[] };
            let run = [&["run"], of, &run[..], plot].concat();
            scratch.prints(&[&run[..], &["--html", "whole/view.html", "--out", "whole"]].concat());
            interrupted(&scratch, &run).map(|output| (scratch, output))
        });
        let (scratch, output) = tried.expect("all runs were over before the signal came");
        let printed = text(&output.stdout);
        assert!(
            printed.contains("interrupted at") && printed.contains("`coadjoint resume run.ck` resumes it"),
            "{printed}"
        );
        // what was computed is written
        let ending = format!(".{format}");
        assert!(scratch.files("out").iter().any(|name| name.ends_with(&ending)));

        scratch.prints(&["resume", "run.ck"]);
        assert_eq!(scratch.files("out"), scratch.files("whole"));
        for name in scratch.files("out") {
            let read =
                |directory: &str| fs::read(scratch.path(&format!("{directory}/{name}"))).expect("readable");
            assert!(read("out") == read("whole"), "{name} differs");
        }
        // nothing is left to resume
        assert_eq!(scratch.files(".").iter().filter(|name| name.starts_with("run.ck")).count(), 0);
    }
}

/// Steps to a tolerance stay as they are where events are looked for within them.
#[test]
fn events_change_no_step_to_a_tolerance() {
    let scratch = Scratch::new("taylor-events");
    let run = ["run", "heavy_top", "--tolerance", "1e-10", "--step", "0.5", "--duration", "50"];
    scratch.prints(&[&run[..], &["--out", "bare"]].concat());
    scratch.prints(&[&run[..], &["--out", "watched", "--event", "z = gamma_z - 0.123"]].concat());
    let read = |of: &str| {
        let names = scratch.files(of);
        let name =
            names.iter().find(|name| name.ends_with(".csv") && !name.contains(".events.")).expect("a table");
        fs::read(scratch.path(&format!("{of}/{name}"))).expect("readable")
    };
    assert!(scratch.files("watched").iter().any(|name| name.ends_with(".events.csv")));
    assert!(read("bare") == read("watched"), "rows differ");
}
