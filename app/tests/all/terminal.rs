//! What is printed, and where.

use serde_json::json;

use crate::program::{Scratch, text};

/// The width of a terminal.
const WIDTH: usize = 80;

fn fits(printed: &str) {
    for line in printed.lines() {
        assert!(line.chars().count() <= WIDTH, "{line}");
    }
}

#[test]
fn everything_fits_a_terminal() {
    let scratch = Scratch::new("width");
    for arguments in [
        &["list"][..],
        &["list", "heavy_top"],
        &["list", "driven_pendulum"],
        &[
            "run",
            "heavy_top",
            "--duration",
            "1.0041",
            "--set",
            "attitude=1,2,3,4",
            "--set",
            "gamma_x=0.0012345",
        ],
        &["run", "heavy_top", "--duration", "1", "--scan", "inertia_x=-1,1"],
        &["run", "heavy_top", "--duration", "1", "--scan", "weight=1:2:3", "--scan", "chi_x=0,0.1"],
        &["run", "heavy_top", "--duration", "1", "--scan", "step=0.013,0.01,0.005"],
        &["ensemble", "heavy_top", "--members", "10", "--duration", "1", "--spread", "inertia=1%"],
        &["certify", "heavy_top"],
        &["init", "heavy_top"],
    ] {
        fits(&scratch.prints(arguments));
    }
    let manual: &[&str] = if cfg!(feature = "manual") { &["completions", "man"] } else { &[] };
    for command in ["list", "run", "resume", "view", "init", "ensemble", "certify"].iter().chain(manual) {
        let short =
            text(&scratch.command(&[command, "-h"]).env("COLUMNS", "80").output().expect("starts").stdout);
        fits(&short);
        // an option's line, and no essay
        assert!(short.lines().count() < 96, "{command}: {short}");
        fits(&text(
            &scratch.command(&[command, "--help"]).env("COLUMNS", "80").output().expect("starts").stdout,
        ));
    }
}

#[test]
fn a_run_is_told_as_one_object() {
    let scratch = Scratch::new("json");
    let run = scratch.object(&["run", "heavy_top", "--duration", "2", "--set", "attitude=0.6,0.8,0,0"]);
    assert_eq!(
        (&run["system"], &run["steps"], &run["time"]),
        (&json!("heavy_top"), &json!(200), &json!(2.0))
    );
    assert_eq!(run["parameters"]["inertia"], json!([1.0, 10.0, 100.0]));
    assert!(run["invariants"]["energy"]["largest_error"].as_f64().expect("a number") < 1e-3);
    assert!(run["invariants"]["|gamma|²"]["largest_error"].as_f64().expect("a number") < 1e-14);
    assert!(run["ns_per_step"].as_f64().expect("a number") > 0.0);
    assert_eq!(
        (&run["interrupted"], &run["written"]),
        (&json!(false), &json!([scratch.named("out", "heavy_top-exponential-", ".csv")]))
    );
    let notes = run["notes"].to_string();
    assert!(notes.contains("`gamma` is fixed in space and turns with `attitude`"), "{notes}");

    let list = scratch.object(&["list"]);
    assert_eq!(list["systems"][1]["controls"][0]["name"], "motor");
    let one = scratch.object(&["list", "heavy-top"]);
    assert_eq!((&one["name"], &one["conserved"][0]["unit"]), (&json!("heavy_top"), &json!("J")));
    assert_eq!(one["methods"], json!(["standard", "euler-a", "euler-b", "midpoint", "verlet"]));
    let certified = scratch.object(&["certify", "heavy_top", "--retraction", "cay"]);
    assert_eq!(
        (&certified["passed"], certified["reports"].as_array().map(Vec::len)),
        (&json!(true), Some(2))
    );
    // of a higher order: what `run` takes
    let composed = scratch.object(&["certify", "heavy_top", "--retraction", "cay", "--order", "4"]);
    assert_eq!(
        (&composed["passed"], &composed["reports"][0]["scheme"]),
        (&json!(true), &json!("Order4<Cayley>"))
    );
}

#[test]
fn quiet_says_nothing() {
    let scratch = Scratch::new("quiet");
    let output = scratch.run(&["run", "heavy_top", "--duration", "1.004", "--quiet"]);
    assert!(output.status.success() && output.stdout.is_empty(), "{output:?}");
    assert_eq!(text(&output.stderr), "");
    assert_eq!(scratch.files("out").len(), 2);
    scratch.named("out", "heavy_top-exponential-", ".csv");
    assert!(scratch.fails(2, &["run", "heavy_tpo", "--quiet"]).contains("did you mean `heavy_top`?"));
    let object = scratch.run(&["run", "heavy_top", "--duration", "1.004", "--quiet", "--json"]);
    assert!(object.stderr.is_empty() && object.stdout.starts_with(b"{"));
}

#[test]
fn a_trajectory_goes_to_standard_output() {
    let scratch = Scratch::new("stdout");
    let run = ["run", "heavy_top", "--duration", "1", "--out"];
    scratch.prints(&[&run[..], &["there"]].concat());
    let output = scratch.run(&[&run[..], &["-"]].concat());
    assert!(output.status.success());
    assert_eq!(text(&output.stdout), scratch.read(&scratch.named("there", "heavy_top-exponential-", ".csv")));
    assert!(text(&output.stderr).contains("largest energy error"), "the table goes elsewhere");
    let json = scratch.prints(&[&run[..], &["-", "--format", "json", "--quiet"]].concat());
    assert!(serde_json::from_str::<serde_json::Value>(&json).is_ok());
    let scan = scratch.prints(&[&run[..], &["-", "--scan", "weight=1,2"]].concat());
    assert_eq!(records(&scan).count(), 3, "{scan}");
    let members =
        scratch.prints(&["ensemble", "heavy_top", "--members", "5", "--duration", "1", "--out", "-"]);
    assert!(
        records(&members).next().is_some_and(|header| header.starts_with("time,momentum_x_members")),
        "{members}"
    );
    assert_eq!(scratch.files("."), ["there"]);
    assert!(scratch.fails(2, &[&run[..], &["-", "--json"]].concat()).contains("takes one of them"));
    assert!(scratch.fails(2, &[&run[..], &["-", "--plot"]].concat()).contains("has to name a directory"));
    assert!(scratch.fails(2, &["view", "heavy_top", "--out", "-"]).contains("`--html FILE`"));
}

#[cfg(feature = "manual")]
#[test]
fn shells_complete_systems_and_options() {
    let scratch = Scratch::new("completions");
    for (shell, expected) in
        [("bash", "heavy_top"), ("zsh", "heavy_top"), ("fish", "scan"), ("powershell", "scan")]
    {
        let script = scratch.prints(&["completions", shell]);
        assert!(script.contains(expected) && script.contains("two_systems"), "{shell}: {script}");
    }
    let bash = scratch.prints(&["completions", "bash"]);
    assert!(bash.contains("driven_pendulum") && bash.contains("--spread"));
    let manual = scratch.prints(&["man"]);
    assert!(manual.starts_with(".ie") || manual.starts_with(".TH"), "{manual}");
    for expected in [".TH TWO_SYSTEMS", "RUN", "\\-\\-scan", "\\-\\-spread", "Exit codes"] {
        assert!(manual.contains(expected), "{expected} in {manual}");
    }
}

#[test]
fn exit_codes_are_as_they_are_documented() {
    let scratch = Scratch::new("exit-codes");
    let help = scratch.prints(&["--help"]);
    for line in
        ["0    all went well", "2    the input is wrong", "3    the motion cannot", "4    the output cannot"]
    {
        assert!(help.contains(line), "{line} in {help}");
    }
    // without a command, the help
    let bare = scratch.fails(2, &[]);
    assert!(bare.contains("Usage: two_systems <COMMAND>") && scratch.files(".").is_empty(), "{bare}");
    scratch.fails(2, &["run", "heavy_top", "--set", "weight=x"]);
    scratch.fails(3, &["run", "heavy_top", "--step", "1000", "--duration", "1000"]);
    std::fs::write(scratch.path("file"), "in the way").expect("writable");
    scratch.fails(4, &["run", "heavy_top", "--out", "file"]);
}

#[test]
fn what_cannot_be_is_refused() {
    let scratch = Scratch::new("refused");
    for (arguments, expected) in [
        (&["view", "heavy_top", "--format", "json"][..], "unexpected argument '--format'"),
        (&["view", "heavy_top", "--checkpoint", "a"], "unexpected argument '--checkpoint'"),
        (&["view", "heavy_top", "--every", "2"], "there is `run --every`, `ensemble --every`"),
        (&["run", "heavy_top", "--spread", "a=1"], "found\n\n  tip: there is `ensemble --spread`\n\nUsage"),
        (&["plot", "heavy_top"], "unrecognized subcommand 'plot'\n\n  tip: there is `run --plot`\n\nUsage"),
        #[cfg(not(feature = "parquet"))]
        (&["run", "heavy_top", "--format", "parquet"], "built without `--features parquet`"),
        (&["run", "heavy_top", "--scan", "weight=1,2", "--plot"], "cannot be used with"),
        (&["run", "heavy_top", "--scan", "wieght=1,2"], "did you mean `weight`?"),
        (&["run", "heavy_top", "--long"], "unexpected argument '--long'"),
        (&["list", "heavytop2"], "did you mean `heavy_top`?"),
        (&["ensemble", "heavy_top", "--members", "9223372036854775807"], "is not in 1..=1000000000000"),
        (&["ensemble", "heavy_top", "--members", "1e14"], "is not in 1..=1000000000000"),
        (&["ensemble", "heavy_top", "--shard", "3/2"], "a part is written as `2/7`"),
        (
            &["ensemble", "heavy_top", "--rows", "end", "--out", "-", "--checkpoint", "c"],
            "rows are a directory of files",
        ),
    ] {
        let message = scratch.fails(2, arguments);
        assert!(message.contains(expected), "{arguments:?}: {message}");
    }
    assert!(scratch.files(".").is_empty());
}

/// What files and arguments say is shown, and not obeyed.
#[test]
fn messages_do_not_command_the_terminal() {
    let scratch = Scratch::new("controls");
    scratch.write("a.toml", b"system = \"heavy_top\"\n\"\\u001b]0;title\\u0007\" = 1\n");
    let name = format!("heavy_top{}", "x".repeat(50_000));
    for arguments in [&["run", "--config", "a.toml"][..], &["run", "\u{1b}[31mred"], &["run", &name]] {
        let message = scratch.fails(2, arguments);
        assert!(!message.contains(['\u{1b}', '\u{7}']) && message.len() < 20_000, "{message:?}");
    }
}

/// A motor that is held at nothing does nothing: the energy is an invariant.
#[test]
fn energy_is_conserved_where_nothing_acts() {
    let scratch = Scratch::new("motor");
    let run =
        |more: &[&str]| scratch.prints(&[&["run", "driven_pendulum", "--duration", "20"][..], more].concat());
    assert!(run(&[]).contains("energy: not conserved by this system"));
    let free = run(&["--set", "motor=0"]);
    assert!(free.contains("energy: bounded") && free.contains("largest energy error"), "{free}");
    assert!(run(&["--set", "motor=0.1"]).contains("energy: not conserved by this system"));
    // of a method that promises nothing a short run tells nothing
    let rk4 = run(&["--set", "motor=0", "--method", "gauss4", "--step", "0.1"]);
    assert!(rk4.contains("and does not grow") || rk4.contains("roundoff"), "{rk4}");
    let heun = run(&["--set", "motor=0", "--method", "heun", "--step", "0.1"]);
    assert!(!heun.contains("does not grow"), "{heun}");
}

/// A step that turns farther than the exponential map reaches says so.
#[test]
fn steps_that_turn_too_far_are_explained() {
    let scratch = Scratch::new("too-far");
    let body =
        ["run", "heavy_top", "--set", "inertia=1,1,1", "--set", "momentum=0,0,3.7", "--set", "weight=0.001"];
    let far = scratch.fails(3, &[&body[..], &["--step", "10", "--duration", "20"]].concat());
    assert!(far.contains("it turns by about 37.0 rad, and the exponential map reaches 2π"), "{far}");
    assert!(far.contains("a step below 8.5e-1 s turns by less than π"), "{far}");
}

/// A long run starts unasked, says how far it has come, and ends at a signal with what was computed.
#[test]
#[cfg(unix)]
fn a_long_run_starts_and_says_how_far_it_is() {
    use std::io::{BufRead, BufReader};
    let scratch = Scratch::new("long");
    for command in [&["run", "--every", "1000000"][..], &["ensemble", "--members", "1000"]] {
        let arguments = [command, &["heavy_top", "--duration", "1e12"]].concat();
        let mut child = scratch.command(&arguments).spawn().expect("it starts");
        let mut line = String::new();
        BufReader::new(child.stderr.as_mut().expect("piped")).read_line(&mut line).expect("readable");
        assert!(line.starts_with("heavy_top: step ") && line.contains(" of 100000000000000 (0 %)"), "{line}");
        std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill");
        let output = child.wait_with_output().expect("it ends");
        assert_eq!(output.status.code(), Some(130), "{}", text(&output.stderr));
        assert!(text(&output.stdout).contains("wrote out/heavy_top-"), "{}", text(&output.stdout));
    }
}

/// The lines of a table.
fn records(csv: &str) -> impl Iterator<Item = &str> {
    csv.lines()
}

#[test]
fn a_scan_makes_a_row_of_each_run() {
    let scratch = Scratch::new("scan");
    let run = ["run", "driven_pendulum", "--duration", "2", "--step", "0.01"];
    let scan = ["--scan", "weight=1:4:4", "--scan", "momentum_x=0.1,0.2"];
    let printed = scratch.prints(&[&run[..], &scan].concat());
    assert!(printed.contains("8 runs of 200 steps"), "{printed}");
    let csv = scratch.read(&scratch.named("out", "driven_pendulum-exponential-scan-", ".csv"));
    let rows: Vec<Vec<&str>> = records(&csv).map(|line| line.split(',').collect()).collect();
    assert_eq!(rows.len(), 9);
    assert_eq!(rows[0][..3], ["weight", "momentum_x", "change of energy"]);
    assert_eq!(rows[8][..2], ["4.0", "0.2"]);

    // each is the run that it stands for
    scratch.prints(
        &[&run[..], &["--set", "weight=3", "--set", "momentum_x=0.2", "--every", "200", "--out", "alone"]]
            .concat(),
    );
    let alone = scratch.read(&scratch.named("alone", "driven_pendulum-exponential-", ".csv"));
    let last: Vec<&str> = alone.lines().last().expect("rows").split(',').collect();
    let index = |name: &str| rows[0].iter().position(|column| *column == name).expect(name);
    assert_eq!(rows[6][..2], ["3.0", "0.2"]);
    for (column, expected) in ["end angle_re", "end angle_im", "end momentum_x"].into_iter().zip(&last[1..4])
    {
        assert_eq!(&rows[6][index(column)], expected, "{column}");
    }
    // where nothing acts there is an error, and the distance of ends has a unit
    let steps = ["--set", "motor=0", "--scan", "step=0.02,0.01", "--out", "-"];
    let table = scratch.prints(&[&run[..], &steps].concat());
    let rows: Vec<Vec<&str>> = records(&table).map(|line| line.split(',').collect()).collect();
    assert_eq!(rows[0][..4], ["step", "error of energy", "difference of end state", "its unit"]);
    assert!(["|momentum|", "rad of angle"].contains(&rows[1][3]), "{table}");
    assert_eq!(rows[2][2], "0.0");
    let object = scratch.object(&[&run[..], &scan].concat());
    assert_eq!(object["runs"][5]["values"], json!({ "weight": 3.0, "momentum_x": 0.2 }));
    assert_eq!(object["runs"][5]["end"]["momentum"].to_string(), last[3]);
}

#[test]
fn runs_of_a_scan_that_fail_are_rows_too() {
    let scratch = Scratch::new("scan-fails");
    let run = ["run", "heavy_top", "--duration", "1", "--scan"];
    let printed = scratch.prints(&[&run[..], &["inertia_x=-1,1"]].concat());
    assert!(printed.contains("not positive definite"), "{printed}");
    let csv = scratch.read(&scratch.named("out", "heavy_top-exponential-scan-", ".csv"));
    assert!(records(&csv).nth(1).is_some_and(|line| line.contains("not positive definite")), "{csv}");
    assert!(records(&csv).nth(2).is_some_and(|line| line.ends_with(',')), "{csv}");
    let all = scratch.fails(3, &[&run[..], &["inertia_x=-1,-2"]].concat());
    assert!(all.contains("all 2 runs failed"), "{all}");
}
