//! The program as people meet it: the real binary, its output, its files, its exit codes.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use serde_json::Value;

/// A directory of its own for a test, removed afterwards.
struct Scratch(PathBuf);

impl Scratch {
    fn new(test: &str) -> Self {
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{test}-{}", std::process::id()));
        fs::create_dir_all(&path).expect("a writable target directory");
        Self(path)
    }

    /// Runs the program in this directory.
    fn coadjoint(&self, arguments: &[&str]) -> Output {
        Command::new(env!("CARGO_BIN_EXE_coadjoint"))
            .args(arguments)
            .current_dir(&self.0)
            .stdin(Stdio::null())
            .output()
            .expect("the program starts")
    }

    /// Runs the program, which must succeed, and gives what it printed.
    fn prints(&self, arguments: &[&str]) -> String {
        let output = self.coadjoint(arguments);
        assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
        text(&output.stdout)
    }

    fn read(&self, path: &str) -> String {
        fs::read_to_string(self.0.join(path)).expect(path)
    }

    /// The names of the files in a directory, hidden ones too; none if it does not exist.
    fn files(&self, directory: &str) -> Vec<String> {
        let Ok(entries) = fs::read_dir(self.0.join(directory)) else { return Vec::new() };
        let mut names: Vec<_> = entries
            .map(|entry| entry.expect("readable").file_name().to_string_lossy().into_owned())
            .collect();
        names.sort();
        names
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// What a page shows.
fn shown(page: &str) -> Value {
    let (_, rest) = page.split_once("type=\"application/json\">").expect("data");
    let (data, _) = rest.split_once("</script>").expect("data end");
    serde_json::from_str(data).expect("JSON")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("UTF-8")
}

/// The header and the numbers of a CSV file.
fn table(csv: &str) -> (Vec<&str>, Vec<Vec<f64>>) {
    let mut lines = csv.lines();
    let header = lines.next().expect("a header").split(',').collect();
    let rows = lines.map(|line| line.split(',').map(|field| field.parse().expect("a number")).collect());
    (header, rows.collect())
}

#[test]
fn list_names_systems_parameters_and_defaults() {
    let listing = Scratch::new("list").prints(&["list"]);
    for expected in [
        "free_rigid_body: ",
        "heavy_top: ",
        "inertia=1,10,100",
        "weight=1",
        "momentum=1,1,1",
        "kg m²",
        "kovalevskaya_top: ",
        "kirchhoff: ",
        "controls       moment",
        "conserved      energy, |gamma|², momentum·gamma",
        "conserved      nothing",
    ] {
        assert!(listing.contains(expected), "{expected} in\n{listing}");
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

/// What is found of a run does not depend on how much of it is written.
#[test]
fn every_thins_what_is_written_and_nothing_else() {
    let found = |every: u64| {
        let scratch = Scratch::new(&format!("every-{every}"));
        let (number, rows) = (every.to_string(), 6000 / every as usize + 1);
        let run = ["run", "planar_pendulum", "--step", "0.01", "--duration", "60", "--every", &number];
        let printed =
            scratch.prints(&[&run[..], &["--plot", "--html", "view.html", "--format", "json"]].concat());
        let told: Vec<String> =
            printed.lines().filter(|line| !line.starts_with("time per step")).map(str::to_owned).collect();
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
    let steps: u64 = value("steps").replace(' ', "").parse().expect("a number");
    assert!(steps >= step.parse().expect("a number"), "{line}{printed}");
    let time: f64 = value("interrupted at").trim_end_matches(" s").parse().expect("a number");
    assert!((time - steps as f64 * 0.01).abs() < 1e-6, "{printed}");
    assert!(value("largest energy error, J").parse::<f64>().expect("a number") > 1e-7, "{printed}");
}

#[test]
fn csv_and_json_hold_the_same_numbers_to_the_last_digit() {
    let scratch = Scratch::new("run-json");
    let arguments =
        ["run", "heavy_top", "--retraction", "cayley", "--duration", "0.3", "--set", "chi=0,0.25,1"];
    scratch.prints(&arguments);
    scratch.prints(&[&arguments[..], &["--format", "json", "--out", "deep/er"]].concat());

    let csv = scratch.read("out/heavy_top-cayley.csv");
    let (header, rows) = table(&csv);
    assert_eq!(rows.len(), 31);
    let json: Value = serde_json::from_str(&scratch.read("deep/er/heavy_top-cayley.json")).expect("JSON");
    assert_eq!(json["columns"], serde_json::json!(header));
    assert!(json["rows"] == serde_json::json!(rows), "the files differ");
    assert_eq!(json["system"], "heavy_top");
    assert_eq!(json["retraction"], "cayley");
    assert_eq!((&json["method"], &json["order"]), (&"standard".into(), &2.into()));
    assert_eq!(json["step"], 0.01);
    assert_eq!(
        json["parameters"],
        serde_json::json!({ "inertia": [1.0, 10.0, 100.0], "weight": 1.0, "chi": [0.0, 0.25, 1.0] })
    );
    let energy = &json["invariants"]["energy"];
    assert_eq!(energy["initial"].as_f64(), Some(rows[0][11]));
    assert!(energy["largest_error"].as_f64().expect("a number") < 1e-3);
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
    assert!(scratch.0.join("out/harmonic_oscillator-family-1-4-exponential.csv").exists());
}

/// Controls are held in place of what the system's own law chooses, and recorded.
#[test]
fn controls_are_set_by_name_and_component() {
    let scratch = Scratch::new("controls");
    let json = |name: &str| -> Value { serde_json::from_str(&scratch.read(name)).expect("JSON") };
    let run = ["run", "quadrotor", "--duration", "1", "--every", "100", "--format", "json"];
    scratch.prints(&[&run[..], &["--set", "thrust=0", "--set", "moment_z=0.25"]].concat());
    let free = json("out/quadrotor-exponential.json");
    assert_eq!(free["controls"], serde_json::json!({ "moment": [null, null, 0.25], "thrust": 0.0 }));
    let last = free["rows"][1].as_array().expect("two rows");
    let number = |column: &str| {
        let columns = free["columns"].as_array().expect("a list");
        let index = columns.iter().position(|name| name == column).expect(column);
        last[index].as_f64().expect("a number")
    };
    assert!((number("position_z") - (1.0 - 9.81 / 2.0)).abs() < 1e-12);
    assert!((number("attitude_momentum_z") - 0.25).abs() < 1e-13);

    // described by a file, the same
    fs::write(
        scratch.0.join("fall.toml"),
        "system = \"quadrotor\"\n[controls]\nthrust = 0\nmoment = [0, 0, 0.25]",
    )
    .expect("writable");
    scratch.prints(&[
        "run",
        "--config",
        "fall.toml",
        "--duration",
        "1",
        "--every",
        "100",
        "--format",
        "json",
    ]);
    let described = json("out/quadrotor-exponential.json");
    assert_eq!(described["controls"], serde_json::json!({ "moment": [0.0, 0.0, 0.25], "thrust": 0.0 }));
    assert_eq!(described["rows"], free["rows"]);

    // its own law, of which nothing is said
    scratch.prints(&run);
    let hover = json("out/quadrotor-exponential.json");
    assert!(hover.get("controls").is_none() && hover["rows"] != free["rows"]);

    let spread = scratch.prints(&[
        "ensemble",
        "quadrotor",
        "--members",
        "8",
        "--duration",
        "1",
        "--set",
        "thrust=0",
        "--spread",
        "attitude_momentum=0.001",
        "--quantity",
        "position_z",
    ]);
    assert!(spread.contains("8 members"), "{spread}");
    let csv = scratch.read("out/quadrotor-ensemble.csv");
    let last = table(&csv).1.pop().expect("rows");
    assert!(last.iter().any(|number| (number - (1.0 - 9.81 / 2.0)).abs() < 1e-9), "{last:?}");
}

#[test]
fn energy_that_is_not_conserved_is_not_called_an_error() {
    let scratch = Scratch::new("driven");
    let printed = scratch.prints(&["run", "driven_pendulum", "--duration", "1"]);
    assert!(printed.contains("largest change of energy, J (it is not conserved)"), "{printed}");
    assert!(!printed.contains("error"), "{printed}");
}

#[test]
fn a_run_is_drawn_where_that_is_asked_for() {
    let scratch = Scratch::new("plot");
    for system in ["kepler", "quadrotor", "rigid_body_in_space"] {
        let printed = scratch
            .prints(&["run", system, "--every", "1000", "--plot", "--out", system, "--method", "midpoint"]);
        let stem = format!("{system}-midpoint-exponential");
        assert!(printed.contains(&format!("{stem}.png")), "{printed}");
        assert_eq!(scratch.files(system), ["csv", "png", "svg"].map(|end| format!("{stem}.{end}")));
        let svg = scratch.read(&format!("{system}/{stem}.svg"));
        assert!(svg.contains("</svg>") && !svg.contains("NaN"));
    }
}

#[test]
fn parameters_and_state_are_set_by_name_and_component() {
    let scratch = Scratch::new("set");
    let printed = scratch.prints(&[
        "run",
        "free-rigid-body",
        "--duration",
        "0.01",
        "--set",
        "inertia=2,3,4",
        "--set",
        "momentum=0.5,-1,2",
        "--set",
        "momentum_y=7",
        "--set",
        "attitude=2,0,0,0",
    ]);
    assert!(printed.contains("note: `attitude` had length 2 and was normalised"), "{printed}");
    let csv = scratch.read("out/free_rigid_body-exponential.csv");
    let (_, rows) = table(&csv);
    let energy = 0.5 * (0.25 / 2.0 + 49.0 / 3.0 + 4.0 / 4.0);
    assert_eq!(rows[0][..8], [0.0, 1.0, 0.0, 0.0, 0.0, 0.5, 7.0, 2.0]);
    assert!((rows[0][8] - energy).abs() < 1e-14);
}

#[test]
fn an_impossible_body_is_noted_but_run() {
    let scratch = Scratch::new("note");
    let flat = scratch.prints(&["run", "free_rigid_body", "--duration", "0.1", "--set", "inertia=1,1,3"]);
    assert!(flat.contains("note: no body of mass has principal moments of inertia 1, 1, 3"), "{flat}");
    let plain = scratch.prints(&["run", "free_rigid_body", "--duration", "0.1"]);
    assert!(!plain.contains("note"), "{plain}");
}

#[test]
fn a_negative_step_goes_back() {
    let scratch = Scratch::new("back");
    scratch.prints(&["run", "heavy_top", "--duration", "1", "--step", "-0.01", "--every", "100"]);
    let csv = scratch.read("out/heavy_top-exponential.csv");
    assert_eq!(table(&csv).1.iter().map(|row| row[0]).collect::<Vec<_>>(), [0.0, -1.0]);
}

#[test]
fn a_duration_that_is_no_whole_number_of_steps_is_noted() {
    let printed = Scratch::new("fraction").prints(&["run", "heavy_top", "--duration", "1.004"]);
    assert!(printed.contains("note: 1.004 s are not a whole number of steps of 0.01 s"), "{printed}");
}

#[test]
fn show_prints_code_that_parses() {
    let scratch = Scratch::new("show");
    for system in ["heavy_top", "free_rigid_body", "quadrotor", "lagrange_top"] {
        for retraction in [&[][..], &["--retraction", "exp"], &["--retraction", "cayley"]] {
            let code = scratch.prints(&[&["show", system], retraction].concat());
            syn::parse_file(&code).expect("Rust");
            assert!(code.lines().count() > 10, "{code}");
        }
    }
}

#[test]
fn the_papers_heavy_top_runs_without_arguments() {
    let scratch = Scratch::new("paper");
    let printed = scratch.prints(&[]);
    for expected in [
        "exponential",
        "cayley",
        "180 000",
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

#[test]
fn nobody_reading_is_no_mistake() {
    let mut child = Command::new(env!("CARGO_BIN_EXE_coadjoint"))
        .args(["show", "heavy_top"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    drop(child.stdout.take());
    let output = child.wait_with_output().expect("it ends");
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert_eq!(text(&output.stderr), "");
}

/// Bad input gets a message, a non-zero exit code, and leaves no file.
#[test]
fn bad_input_is_refused_with_a_message() {
    let cases: &[(&[&str], i32, &str)] = &[
        (&["run", "heavy_tpo"], 2, "did you mean `heavy_top`?"),
        (&["run", "pendulum-on-the-moon"], 2, "there is no system `pendulum-on-the-moon`"),
        (&["show", "heavytop2"], 2, "did you mean `heavy_top`?"),
        (&["run"], 2, "no system: name one"),
        (&["rum", "heavy_top"], 2, "similar subcommand"),
        (&["run", "heavy_top", "--set", "wieght=2"], 2, "did you mean `weight`?"),
        (&["run", "heavy_top", "--set", "temperature=2"], 2, "parameters: inertia, weight, chi"),
        (&["run", "heavy_top", "--set", "weight"], 2, "has no `=`"),
        (&["run", "heavy_top", "--set", "chi=1,2"], 2, "takes 3 numbers separated by commas, got 2"),
        (&["run", "heavy_top", "--set", "weight=1,2,3"], 2, "takes one number, got 3"),
        (&["run", "heavy_top", "--set", "weight=heavy"], 2, "`heavy` is not a number"),
        (&["run", "heavy_top", "--set", "momentum=1,nan,1"], 2, "`momentum` must be finite"),
        (&["run", "heavy_top", "--set", "momentum_x=inf"], 2, "`momentum_x` must be finite"),
        (&["run", "heavy_top", "--set", "inertia=1,-10,100"], 2, "`inertia` is not positive definite"),
        (&["run", "heavy_top", "--set", "inertia_z=0"], 2, "`inertia` is not positive definite"),
        (&["run", "heavy_top", "--set", "attitude=0,0,0,0"], 2, "cannot be zero"),
        (&["run", "heavy_top", "--step", "0"], 2, "`--step` must be finite and not zero"),
        (&["run", "heavy_top", "--step", "NaN"], 2, "`--step` must be finite and not zero"),
        (&["run", "heavy_top", "--step", "small"], 2, "invalid value 'small'"),
        (&["run", "heavy_top", "--duration", "-5"], 2, "`--duration` must be finite and not negative"),
        (&["run", "heavy_top", "--duration", "inf"], 2, "`--duration` must be finite"),
        (&["run", "heavy_top", "--duration", "1e300"], 2, "too many"),
        (&["run", "heavy_top", "--every", "0"], 2, "0 is not in"),
        (&["run", "heavy_top", "--retraction", "euler"], 2, "possible values: exponential, cayley"),
        (
            &["run", "heavy_top", "--method", "leapfrog"],
            2,
            "possible values: standard, euler-a, euler-b, midpoint, verlet",
        ),
        (
            &["run", "heavy_top", "--method", "euler-a", "--order", "4"],
            2,
            "take one of standard, midpoint, verlet",
        ),
        (&["run", "heavy_top", "--method", "rk5"], 2, "similar value exists: 'rk4'"),
        (&["run", "heavy_top", "--method", "family=5/4"], 2, "`5/4` is not a fraction from 0 to 1"),
        (&["run", "heavy_top", "--method", "family=1/4"], 2, "`methods(…)` in its description asks for it"),
        (&["run", "heavy_top", "--method", "right-lift"], 2, "something acts on it; free_rigid_body"),
        (
            &["run", "free_rigid_body", "--method", "right-lift", "--retraction", "second-kind"],
            2,
            "no steps of the method right-lift with the retraction second-kind",
        ),
        (
            &["run", "kepler", "--retraction", "second-kind"],
            2,
            "of the scheme `SecondKind` was generated for `Kepler`; `retractions(…)` in its description asks for it",
        ),
        (&["run", "heavy_top", "--method", "rk4", "--order", "4"], 2, "method rk4 has its own order, 4"),
        (&["run", "heavy_top", "--method", "rkmk4", "--order", "2"], 2, "method rkmk4 has its own order, 4"),
        (
            &["run", "heavy_top", "--method", "rk4", "--retraction", "exp"],
            2,
            "`--retraction` is for methods of ours",
        ),
        (&["run", "heavy_top", "--method", "tangent-lift", "--order", "4"], 2, "take one of standard"),
        (&["run", "--config", "rk4.toml", "--order", "6"], 2, "method rk4 has its own order, 4"),
        (&["run", "--config", "rk4-order.toml"], 2, "order 4 is composed of symmetric steps"),
        (&["run", "--config", "method.toml"], 2, "there is no method `leapfrog`"),
        (&["run", "quadrotor", "--set", "thrst=9"], 2, "did you mean `thrust`?"),
        (&["run", "quadrotor", "--set", "lift=9"], 2, "controls: moment, thrust"),
        (&["run", "quadrotor", "--set", "thrust=1,2"], 2, "takes one number, got 2"),
        (&["run", "quadrotor", "--set", "moment_y=inf"], 2, "`moment_y` must be finite"),
        (&["run", "--config", "thrust.toml"], 2, "[controls]: `heavy_top` has no control `thrust`"),
        (
            &["ensemble", "quadrotor", "--spread", "thrust=1"],
            2,
            "has no parameter or state quantity `thrust`",
        ),
        (&["certify", "heavy_top", "--method", "rk4"], 2, "claims nothing that a certificate could measure"),
        (&["certify", "free_rigid_body", "--method", "right-lift"], 2, "takes the steps of euler-a"),
        (&["run", "heavy_top", "--order", "3"], 2, "possible values: 2, 4, 6, 8, 10"),
        (&["run", "planar_pendulum", "--set", "angle=0,0"], 2, "no rotation is 1,0"),
        (&["run", "heavy_top", "--format", "xml"], 2, "possible values: csv, json, parquet"),
        (&["run", "--config", "missing.toml"], 2, "cannot read missing.toml"),
        (&["run", "--config", "."], 2, "cannot read ."),
        (&["run", "--config", "malformed.toml"], 2, "line 2"),
        (
            &["run", "--config", "misspelt.toml"],
            2,
            "[parameters]: `heavy_top` has no parameter `wieght`; did you mean `weight`?",
        ),
        (&["run", "--config", "negative.toml"], 2, "`inertia` is not positive definite"),
        (&["run", "--config", "text.toml"], 2, "`weight` takes numbers, got string `\"heavy\"`"),
        (
            &["run", "--config", "few.toml"],
            2,
            "[state]: `momentum` takes 3 numbers separated by commas, got 2",
        ),
        (&["run", "--config", "nan.toml"], 2, "[state]: `momentum` must be finite"),
        (&["run", "--config", "order.toml"], 2, "order must be 2, 4, 6, 8 or 10, got 5"),
        (&["run", "--config", "key.toml"], 2, "unknown field `stpe`"),
        (&["run", "--config", "every.toml"], 2, "`every` must be 1 or more"),
        (&["run", "kepler", "--config", "order.toml"], 2, "describes a run of `heavy_top`, not of `kepler`"),
        (&["run", "--config", "system.toml"], 2, "did you mean `heavy_top`?"),
        (&["init", "heavy_tpo"], 2, "did you mean `heavy_top`?"),
        (
            &["init", "heavy_top", "--out", "order.toml"],
            2,
            "order.toml exists already; `--force` replaces it",
        ),
        (&["figures", "6.4"], 2, "there is no figure `6.4`"),
        (&["resume", "missing.ck"], 2, "cannot read missing.ck"),
        (&["resume", "order.toml"], 2, "order.toml is not a checkpoint"),
        (&["resume", "damaged.ck"], 2, "damaged.ck is a damaged checkpoint"),
        (&["run", "heavy_top", "--checkpoint", "order.toml"], 2, "`coadjoint resume order.toml` resumes it"),
        (
            &["run", "heavy_top", "--duration", "1", "--set", "momentum=1e200,1e200,1e200"],
            3,
            "step 1, from time 0",
        ),
    ];
    let scratch = Scratch::new("bad-input");
    for (name, content) in [
        ("malformed", "system = \"heavy_top\"\n[run\nstep = 1"),
        ("misspelt", "system = \"heavy_top\"\n[parameters]\nwieght = 2.0"),
        ("negative", "system = \"heavy_top\"\n[parameters]\ninertia = [1.0, -10.0, 100.0]"),
        ("text", "system = \"heavy_top\"\n[parameters]\nweight = \"heavy\""),
        ("few", "system = \"heavy_top\"\n[state]\nmomentum = [1, 2]"),
        ("nan", "system = \"heavy_top\"\n[state]\nmomentum = [1, nan, 2]"),
        ("order", "system = \"heavy_top\"\n[run]\norder = 5"),
        ("key", "system = \"heavy_top\"\n[run]\nstpe = 0.1"),
        ("every", "system = \"heavy_top\"\n[run]\nevery = 0"),
        ("system", "system = \"heavy_tpo\""),
        ("rk4", "system = \"heavy_top\"\n[run]\nmethod = \"rk4\""),
        ("rk4-order", "system = \"heavy_top\"\n[run]\nmethod = \"rk4\"\norder = 4"),
        ("method", "system = \"heavy_top\"\n[run]\nmethod = \"leapfrog\""),
        ("thrust", "system = \"heavy_top\"\n[controls]\nthrust = 1"),
    ] {
        fs::write(scratch.0.join(format!("{name}.toml")), content).expect("writable");
    }
    fs::write(scratch.0.join("damaged.ck"), "coadjoint checkpoint 1\nabcdefgh").expect("writable");
    for (arguments, code, expected) in cases {
        let output = scratch.coadjoint(arguments);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(*code), "{arguments:?}: {message}");
        assert!(message.contains(expected), "{arguments:?}: {message}");
        assert!(message.starts_with("error: ") && !message.contains("panicked"), "{arguments:?}: {message}");
        assert_eq!(scratch.files("out"), [""; 0], "{arguments:?}");
    }
}

#[test]
fn directories_that_cannot_be_written_are_named() {
    let scratch = Scratch::new("unwritable");
    fs::write(scratch.0.join("file"), "in the way").expect("writable");
    fs::create_dir_all(scratch.0.join("taken/heavy_top-exponential.csv")).expect("writable");
    for (directory, named) in
        [("file", "file"), ("file/below", "below"), ("taken", "heavy_top-exponential.csv")]
    {
        let output = scratch.coadjoint(&["run", "heavy_top", "--duration", "1", "--out", directory]);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(4), "{directory}: {message}");
        assert!(
            message.starts_with("error: cannot write") && message.contains(named),
            "{directory}: {message}"
        );
    }
    assert_eq!(scratch.files("taken"), ["heavy_top-exponential.csv"], "nothing is left behind");
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

#[test]
fn a_run_that_fails_leaves_an_earlier_file_alone() {
    let scratch = Scratch::new("earlier");
    scratch.prints(&["run", "heavy_top", "--duration", "0.1"]);
    let before = scratch.read("out/heavy_top-exponential.csv");
    let output = scratch.coadjoint(&["run", "heavy_top", "--set", "momentum=1e200,1e200,1e200"]);
    assert_eq!(output.status.code(), Some(3), "{}", text(&output.stderr));
    assert_eq!(scratch.read("out/heavy_top-exponential.csv"), before);
    assert_eq!(scratch.files("out"), ["heavy_top-exponential.csv"]);
}

/// A full disk: no file, a message, and the exit code of what cannot be written.
#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_is_reported() {
    use std::os::unix::fs::symlink;
    let scratch = Scratch::new("full");
    fs::create_dir_all(scratch.0.join("out")).expect("writable");
    // what is written to the temporary name of the process that will run goes to a device that is always full
    let journal = scratch.0.join("run.ck.rows");
    symlink("/dev/full", &journal).expect("writable");
    let output = scratch.coadjoint(&["run", "heavy_top", "--checkpoint", "run.ck"]);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(4), "{message}");
    assert!(message.starts_with("error: cannot write run.ck.rows: No space left"), "{message}");
    assert_eq!(scratch.files("out"), [""; 0]);
}

#[test]
fn a_run_is_described_by_a_file() {
    let scratch = Scratch::new("config");
    let printed = scratch.prints(&["init", "heavy_top"]);
    assert!(printed.contains("coadjoint run --config heavy_top.toml"), "{printed}");
    let described = scratch.read("heavy_top.toml");
    assert!(described.contains("# Principal moments of inertia"), "{described}");

    // as it is, the file says what is usual
    let short = ["--duration", "0.5"];
    scratch.prints(&[&["run", "heavy_top", "--out", "usual"][..], &short].concat());
    scratch.prints(&[&["run", "--config", "heavy_top.toml", "--out", "described"][..], &short].concat());
    let file = "heavy_top-exponential.csv";
    assert_eq!(scratch.read(&format!("usual/{file}")), scratch.read(&format!("described/{file}")));

    // what it says counts, and what is given beside it counts more
    let changed = described
        .replace("retraction = \"exponential\"", "retraction = \"cayley\"")
        .replace("weight = 1.0", "weight = 2.5")
        .replace("duration = 60.0", "duration = 0.3")
        .replace("every = 1", "every = 10")
        .replace("format = \"csv\"", "format = \"json\"");
    fs::write(scratch.0.join("heavy_top.toml"), changed).expect("writable");
    scratch.prints(&["run", "--config", "heavy_top.toml", "--set", "chi=0,0.5,1", "--every", "15"]);
    let json: Value = serde_json::from_str(&scratch.read("out/heavy_top-cayley.json")).expect("JSON");
    assert_eq!(json["parameters"]["weight"], 2.5);
    assert_eq!(json["parameters"]["chi"], serde_json::json!([0.0, 0.5, 1.0]));
    assert_eq!(json["rows"].as_array().map(Vec::len), Some(3));
    scratch.prints(&["init", "heavy_top", "--force"]);
    assert_eq!(scratch.read("heavy_top.toml"), described);
}

#[test]
fn parquet_holds_what_csv_holds() {
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::Field;
    let scratch = Scratch::new("parquet");
    let arguments = ["run", "gyrostat", "--duration", "300", "--step", "0.01"];
    scratch.prints(&arguments);
    scratch.prints(&[&arguments[..], &["--format", "parquet"]].concat());
    let csv = scratch.read("out/gyrostat-exponential.csv");
    let (header, rows) = table(&csv);
    // more than one row group
    assert_eq!(rows.len(), 30_001);
    let file = fs::File::open(scratch.0.join("out/gyrostat-exponential.parquet")).expect("written");
    let reader = SerializedFileReader::new(file).expect("Parquet");
    assert_eq!(reader.metadata().num_row_groups(), 2);
    let metadata = reader.metadata().file_metadata().key_value_metadata().expect("there is");
    let value = |key: &str| metadata.iter().find(|pair| pair.key == key).and_then(|pair| pair.value.clone());
    assert_eq!(value("system").as_deref(), Some("\"gyrostat\""));
    assert!(value("invariants").expect("there").contains("largest_error"));
    for (row, expected) in reader.get_row_iter(None).expect("rows").zip(&rows) {
        let row = row.expect("readable");
        let names: Vec<&String> = row.get_column_iter().map(|(name, _)| name).collect();
        assert_eq!(names, header);
        let numbers: Vec<f64> = row
            .get_column_iter()
            .map(|(_, field)| if let Field::Double(number) = field { *number } else { panic!("{field}") })
            .collect();
        assert_eq!(&numbers, expected);
    }
}

/// Ctrl-C ends a run cleanly; gone on with, it writes the same bytes as one that was not interrupted.
#[test]
#[cfg(unix)]
fn an_interrupted_run_goes_on_to_the_same_bytes() {
    let (top, quadrotor) =
        (&["heavy_top"][..], &["quadrotor", "--set", "thrust=20", "--set", "moment_x=1e-6"][..]);
    for (format, of) in [("csv", top), ("json", top), ("parquet", top), ("json", quadrotor)] {
        let (system, stem) = (of[0], format!("{}-cayley", of[0]));
        let scratch = Scratch::new(&format!("resume-{system}-{format}"));
        let run = ["--retraction", "cayley", "--duration", "4000", "--every", "100", "--plot", "--format"];
        let run = [&["run"], of, &run[..], &[format]].concat();
        scratch.prints(&[&run[..], &["--html", "whole/view.html", "--out", "whole"]].concat());

        let mut child = Command::new(env!("CARGO_BIN_EXE_coadjoint"))
            .args([&run[..], &["--html", "out/view.html", "--checkpoint", "run.ck"]].concat())
            .current_dir(&scratch.0)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program starts");
        let journal = scratch.0.join("run.ck.rows");
        // it has begun when there are rows
        while fs::metadata(&journal).map_or(0, |file| file.len()) == 0
            && child.try_wait().expect("waits").is_none()
        {
            std::thread::sleep(std::time::Duration::from_millis(2));
        }
        Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill");
        let output = child.wait_with_output().expect("it ends");
        assert_eq!(output.status.code(), Some(130), "{}", text(&output.stderr));
        let printed = text(&output.stdout);
        assert!(
            printed.contains("interrupted at") && printed.contains("`coadjoint resume run.ck` resumes it"),
            "{printed}"
        );
        // what was computed is written
        assert!(scratch.0.join(format!("out/{stem}.{format}")).exists());

        scratch.prints(&["resume", "run.ck"]);
        assert_eq!(scratch.files("out"), scratch.files("whole"));
        for name in scratch.files("out") {
            let read = |directory: &str| fs::read(scratch.0.join(directory).join(&name)).expect("readable");
            assert!(read("out") == read("whole"), "{name} differs");
        }
        // nothing is left to resume
        assert_eq!(scratch.files(".").iter().filter(|name| name.starts_with("run.ck")).count(), 0);
    }
}

#[test]
fn a_view_is_one_page_that_needs_nothing_else() {
    let scratch = Scratch::new("view");
    for system in
        ["heavy_top", "kepler", "planar_pendulum", "coupled_bodies", "rigid_body_in_space", "quadrotor"]
    {
        scratch.prints(&["view", system]);
        let page = scratch.read(&format!("out/{system}-exponential.html"));
        assert!(
            !page.contains("__COADJOINT_DATA__") && !page.contains("http://") && !page.contains("https://"),
            "{system}"
        );
        let data = shown(&page);
        assert_eq!(data["title"], system);
        let moments = data["time"].as_array().expect("a list").len();
        assert!((1001..=8192).contains(&moments), "{system}: {moments}");
        let page = coadjoint_app::page::Page::from_json(&data.to_string()).expect(system);
        assert_eq!(page.runs.len(), 1, "{system}");
        assert!(!page.runs[0].bodies.is_empty() && !page.runs[0].plots.is_empty(), "{system}");
    }
    assert_eq!(scratch.files("out").len(), 6, "pages alone");
}

#[test]
fn a_figure_is_a_picture_and_its_data() {
    let scratch = Scratch::new("figures");
    let printed = scratch.prints(&["figures", "1.1", "1.2", "1.3"]);
    assert!(printed.contains("1.645 times the energy"), "{printed}");
    assert_eq!(
        scratch.files("out/figures"),
        [
            "figure-1.1.csv",
            "figure-1.1.png",
            "figure-1.1.svg",
            "figure-1.2.csv",
            "figure-1.2.png",
            "figure-1.2.svg",
            "figure-1.3.csv",
            "figure-1.3.png",
            "figure-1.3.svg",
            "index.html",
        ]
    );
    let csv = scratch.read("out/figures/figure-1.1.csv");
    assert_eq!(csv.lines().next(), Some("panel,horizontal,vertical,series,x,y"));
    assert!(csv.contains("\n1,\"q\",\"p\",\"explicit Euler\",1.0,0.0\n"), "{csv}");
}

#[test]
fn an_ensemble_spreads() {
    let scratch = Scratch::new("ensemble");
    let run = |extra: &[&str]| {
        let arguments =
            ["ensemble", "free_rigid_body", "--members", "50", "--duration", "20", "--every", "100"];
        scratch.prints(&[&arguments[..], extra].concat())
    };
    let printed = run(&["--spread", "inertia=2%", "--quantity", "energy", "--quantity", "momentum_y"]);
    assert!(printed.contains("50 members, 100 000 steps"), "{printed}");
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
        (&["--spread", "attitude=1%"], "cannot vary one by one"),
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
