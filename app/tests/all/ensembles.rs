//! Many members at once.

use serde_json::json;

use crate::program::{Scratch, text};

const FEW: [&str; 4] = ["ensemble", "heavy_top", "--members", "20"];

#[test]
fn the_ranges_drawn_are_told() {
    let scratch = Scratch::new("ranges");
    let spread = ["--spread", "inertia=1%", "--spread", "attitude=5deg"];
    let printed = scratch.prints(&[&FEW[..], &spread].concat());
    for expected in ["drawn: inertia_x", "inertia_z        from 99.", "attitude         from", "°"] {
        assert!(printed.contains(expected), "{expected} in {printed}");
    }
    let object = scratch.object(&[&FEW[..], &spread].concat());
    for (component, size) in [("inertia_x", 1.0), ("inertia_y", 10.0), ("inertia_z", 100.0)] {
        let of = |end: &str| object["drawn"][component][end].as_f64().expect("a number") / size;
        assert!(of("min") >= 0.99 && of("min") < 0.995 && of("max") <= 1.01 && of("max") > 1.005);
    }
    assert_eq!((&object["members"], &object["failed"]), (&json!(20), &json!(0)));
    // the picture says it in the same words
    assert!(
        scratch.read(&scratch.named("out", "heavy_top-ensemble-", ".svg")).contains("1 % of each component")
    );
}

/// Members with another scheme, side by side where they are made of standard steps, else one by one, move as with the usual one.
#[test]
fn schemes_agree() {
    let scratch = Scratch::new("schemes");
    let few = ["ensemble", "heavy_top", "--members", "5", "--duration", "2"];
    let mean = |extra: &[&str]| {
        let object =
            scratch.object(&[&few[..], &["--quantity", "energy", "--step", "0.0025"], extra].concat());
        assert_eq!(object["member_steps"], json!(5 * 800));
        (object["end"]["energy"]["mean"].as_f64().expect("a number"), object["side_by_side"].clone())
    };
    let (usual, four) = mean(&[]);
    // with the exponential four at most
    let (cayley, eight) = mean(&["--retraction", "cayley"]);
    assert_eq!(four, json!(eight.as_u64().expect("a number").min(4)));
    assert!((cayley - usual).abs() < 1e-4 && cayley != usual, "{cayley} {usual}");
    for (scheme, width) in [
        (&["--order", "4"][..], &four),
        (&["--retraction", "exp", "--order", "6"], &four),
        (&["--retraction", "cayley", "--order", "4"], &eight),
        (&["--method", "midpoint"], &json!(1)),
        (&["--method", "rk4"], &json!(1)),
        (&["--method", "verlet", "--order", "6", "--retraction", "cayley"], &json!(1)),
    ] {
        let (energy, found) = mean(scheme);
        assert!((energy - usual).abs() < 1e-4, "{scheme:?}: {energy} {usual}");
        assert_eq!(&found, width, "{scheme:?}");
    }
    scratch.named("out", "heavy_top-order4-cayley-ensemble-", ".csv");
    // without being asked, members take the steps of a run
    let one = ["--members", "1", "--spread", "momentum=0", "--quantity", "momentum_x", "--duration", "2"];
    let end = scratch.object(&[&["ensemble", "heavy_top"][..], &one].concat())["end"]["momentum_x"].clone();
    scratch.prints(&["run", "heavy_top", "--duration", "2"]);
    let table = scratch.read(&scratch.named("out", "heavy_top-exponential-", ".csv"));
    let column = |row: &str| {
        let columns = table.lines().next().expect("a header").split(',');
        let place = columns.into_iter().position(|column| column == "momentum_x").expect("it is there");
        row.split(',').nth(place).expect("a number").parse::<f64>().expect("a number")
    };
    assert_eq!(end["mean"], json!(column(table.lines().last().expect("a row"))));
    assert!(
        scratch
            .fails(2, &[&few[..], &["--method", "rk4", "--order", "4"]].concat())
            .contains("its own order")
    );
    assert!(scratch.fails(2, &[&few[..], &["--method", "family=1/4"]].concat()).contains("was generated"),);
}

#[test]
fn controls_act_on_members_one_by_one() {
    let scratch = Scratch::new("driven");
    let end = |extra: &[&str]| {
        let run = ["ensemble", "driven_pendulum", "--members", "6", "--duration", "3", "--set", "motor=0.5"];
        let object = scratch.object(&[&run[..], extra].concat());
        object["end"]["momentum_x"]["mean"].as_f64().expect("a number")
    };
    // both of order 2: with steps of a quarter they are closer by its square
    let difference = |step: &str| end(&["--step", step]) - end(&["--step", step, "--method", "midpoint"]);
    let ratio = difference("0.01") / difference("0.0025");
    assert!((ratio / 16.0 - 1.0).abs() < 0.05, "{ratio}");
}

#[test]
fn members_that_all_fail_leave_no_picture() {
    let scratch = Scratch::new("all-fail");
    let message =
        scratch.fails(3, &[&FEW[..], &["--step", "10", "--duration", "100", "--retraction", "exp"]].concat());
    assert!(message.contains("all 20 members failed"), "{message}");
    let files = scratch.files("out");
    assert!(files.iter().all(|file| file.ends_with(".csv") || file.ends_with(".run.json")), "{files:?}");
}

#[test]
fn a_member_that_cannot_be_is_named() {
    let scratch = Scratch::new("no-member");
    for extra in [&[][..], &["--order", "4"]] {
        let message = scratch.fails(2, &[&FEW[..], &["--spread", "inertia=300%"], extra].concat());
        assert!(
            message.starts_with("error: member ") && message.contains("not positive definite"),
            "{message}"
        );
    }
    assert!(scratch.files("out").is_empty());
}

/// Threads that cannot be had are an error: here, by a bound on the memory that they would lie in. There are few, and large ones.
#[test]
#[cfg(target_os = "linux")]
fn threads_that_cannot_be_had_are_an_error() {
    let scratch = Scratch::new("threads");
    let program = scratch.command(&[]);
    let program = program.get_program().to_string_lossy().into_owned();
    let script = format!("ulimit -v 2000000; exec {program} ensemble heavy_top --members 4 --duration 1");
    let output = std::process::Command::new("sh")
        .args(["-c", &script])
        .current_dir(&scratch.0)
        .env("RAYON_NUM_THREADS", "8")
        .env("RUST_MIN_STACK", "300000000")
        .output()
        .expect("starts");
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("threads cannot be started (RAYON_NUM_THREADS=8)"), "{message}");
    assert!(!message.contains("panicked"), "{message}");
}
