//! Parameters, states, controls, steps and durations of one's own.

use std::fs;

use serde_json::Value;

use super::{Scratch, table};

/// Controls are held in place of what the system's own law chooses, and recorded.
#[test]
fn controls_are_set_by_name_and_component() {
    let scratch = Scratch::new("controls");
    let json = |name: &str| -> Value { serde_json::from_str(&scratch.read(name)).expect("JSON") };
    // from where nothing turns
    let run = ["run", "quadrotor", "--duration", "1", "--every", "100", "--format", "json"];
    let run = [&run[..], &["--set", "attitude_momentum=0,0,0"]].concat();
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
        "system = \"quadrotor\"\n[state]\nattitude_momentum = [0, 0, 0]\n[controls]\nthrust = 0\nmoment = [0, 0, 0.25]",
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
fn an_array_is_set_as_a_whole_or_by_element() {
    let scratch = Scratch::new("array");
    let start = |set: &[&str]| {
        let run = ["run", "spin_chain", "--duration", "0.02", "--out", "-"];
        let printed = scratch.prints(&[&run[..], set].concat());
        let (header, rows) = table(&printed);
        let is_momentum = |(name, _): &(&&str, &f64)| name.starts_with("spins_momentum");
        header.iter().zip(&rows[0]).filter(is_momentum).map(|(_, value)| *value).collect::<Vec<_>>()
    };
    let whole =
        start(&["--set", "spins_momentum=1,0,0,0,1,0,0,0,1,1,0,0", "--set", "spins_momentum_3=0,2,0"]);
    assert_eq!(whole, [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 2.0, 0.0]);
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
    for step in ["-0.01", "-1e-2"] {
        scratch.prints(&["run", "heavy_top", "--duration", "1", "--step", step, "--every", "100"]);
        let csv = scratch.read("out/heavy_top-exponential.csv");
        assert_eq!(table(&csv).1.iter().map(|row| row[0]).collect::<Vec<_>>(), [0.0, -1.0]);
    }
}

#[test]
fn a_run_ends_where_it_should() {
    let scratch = Scratch::new("fraction");
    let end = |more: &[&str]| {
        let run = ["run", "heavy_top", "--duration", "1.004", "--every", "1000", "--format", "json"];
        let printed = scratch.prints(&[&run[..], more].concat());
        let json: Value =
            serde_json::from_str(&scratch.read("out/heavy_top-exponential.json")).expect("JSON");
        let numbers = json["rows"][1].as_array().expect("two rows").iter();
        (numbers.map(|x| x.as_f64().expect("a number")).collect::<Vec<f64>>(), printed)
    };
    let (last, printed) = end(&[]);
    let words = printed.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.contains("not a whole number of steps of 0.01 s: the last step is 0.004 s"), "{printed}");
    assert_eq!(last[0], 1.004);
    // so accurate that the step makes no difference
    let ((last, _), (fine, printed)) = (end(&["--order", "8"]), end(&["--order", "8", "--step", "0.004"]));
    assert!(!printed.contains("whole number"), "{printed}");
    let difference = last.iter().zip(&fine).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(difference < 1e-11, "{difference:e}");
}

/// What a run says of its error is what it is: the end is compared with that of steps of a higher order.
#[test]
fn the_error_of_a_trajectory_is_estimated() {
    let scratch = Scratch::new("estimate");
    let run = |more: &[&str]| {
        let run = ["run", "heavy_top", "--duration", "10", "--json", "--every", "1000"];
        let told = scratch.prints(&[&run[..], more].concat());
        let (_, rows) = table(&scratch.read("out/heavy_top-exponential.csv"));
        (serde_json::from_str::<Value>(&told).expect("JSON"), rows.into_iter().next_back().expect("rows"))
    };
    let (told, end) = run(&[]);
    let estimate = &told["error_estimate"];
    assert_eq!((&estimate["time"], &estimate["quantity"]), (&10.0.into(), &"attitude".into()), "{told}");
    let stated = estimate["distance"].as_f64().expect("a number");
    let beside = scratch.path("out/heavy_top-exponential.csv").with_extension("run.json");
    let beside = fs::read_to_string(beside).expect("it is there");
    assert!(
        beside.contains("trajectory: error of about") && beside.contains("rad of attitude after 10 s"),
        "{beside}"
    );
    scratch.prints(&["run", "heavy_top", "--duration", "10", "--order", "8", "--every", "1000"]);
    let (_, rows) = table(&scratch.read("out/heavy_top-order8-exponential.csv"));
    let norm = |numbers: &[f64]| numbers.iter().map(|x| x * x).sum::<f64>().sqrt();
    // the angle between two attitudes
    let apart: Vec<f64> = end[1..5].iter().zip(&rows[1][1..5]).map(|(a, b)| a - b).collect();
    let right = 4.0 * (0.5 * norm(&apart)).asin();
    assert!((stated / right - 1.0).abs() < 0.05, "{stated:e} for {right:e}");
    // what a scan shows is the difference: half the step leaves a quarter of the error
    let scan =
        scratch.prints(&["run", "heavy_top", "--duration", "10", "--scan", "step=0.01,0.005", "--json"]);
    let scan: Value = serde_json::from_str(&scan).expect("JSON");
    let difference = scan["runs"][0]["difference"]["distance"].as_f64().expect("a number");
    assert!((difference / stated - 0.75).abs() < 1e-12, "{difference:e} of {stated:e}");
    assert_eq!(scan["runs"][1]["difference"]["distance"], 0.0);
}

/// A rotor that turns by η = 0.6283 rad a step counts as 1/(1 + η²/4) of its momentum.
#[test]
fn a_turn_that_the_cayley_map_slows_is_noted() {
    let scratch = Scratch::new("slowed");
    let run = |more: &[&str]| {
        let fast =
            ["run", "gyrostat", "--set", "rotor_momentum=31.4159", "--set", "attitude_momentum=1,35,2"];
        scratch.prints(&[&fast[..], &["--step", "0.001", "--duration", "0.1"], more].concat())
    };
    let printed = run(&["--retraction", "cayley"]);
    let words = printed.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(words.contains("counts as 91.0 % of its momentum: take `--retraction exponential`"), "{printed}");
    assert!(!run(&[]).contains("counts as"));
}

/// The body begins with 1 rad/s: with the exponential its series follows by more than a radian, with the Cayley map by less.
#[test]
fn a_step_that_no_series_follows_is_noted() {
    let scratch = Scratch::new("series");
    let noted = |step: &str, more: &[&str]| {
        let body = ["run", "free_rigid_body", "--order", "6", "--duration", "4", "--step", step];
        let printed = scratch.prints(&[&body[..], more].concat());
        let printed = printed.split_whitespace().collect::<Vec<_>>().join(" ");
        printed.contains(
            "of `momentum`, more than the series of Hamilton–Jacobi steps allows: take a step below",
        )
    };
    let [exponential, cayley] = [["--retraction", "exponential"], ["--retraction", "cayley"]];
    assert!(noted("2.2", &exponential) && !noted("1.2", &exponential));
    assert!(noted("1", &cayley) && !noted("0.6", &cayley));
    assert!(!noted("2.2", &["--method", "standard"]));
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
