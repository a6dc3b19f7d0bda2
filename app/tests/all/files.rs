//! Files one can trust: beside them it says what made them, can be made again, and take no other's place.

use std::fs;

use serde_json::{Value, json};

use crate::program::{Scratch, text};

/// Of a run with every kind of setting, in numbers of many digits.
const ODD: [&str; 14] = [
    "run",
    "driven_pendulum",
    "--method",
    "midpoint",
    "--retraction",
    "cayley",
    "--set",
    "weight=9.806649999999998",
    "--set",
    "motor=-1e-3",
    "--step",
    "0.0031415926535897933",
    "--every",
    "7",
];

#[test]
fn beside_every_file_it_says_what_made_it_and_it_can_be_made_again() {
    let scratch = Scratch::new("again");
    scratch.prints(&[&ODD[..], &["--plot", "--html", "out/page.html"]].concat());
    for format in ["json", "parquet"] {
        if cfg!(feature = "parquet") || format == "json" {
            scratch.prints(&[&ODD[..], &["--format", format]].concat());
        }
    }
    let all = scratch.files("out");
    let files: Vec<&String> = all.iter().filter(|name| !name.ends_with(".run.json")).collect();
    assert_eq!(files.len(), if cfg!(feature = "parquet") { 6 } else { 5 }, "{files:?}");
    let stem = files.iter().find_map(|name| name.strip_suffix(".csv")).expect("a table").to_owned();
    let hash = stem.strip_prefix("driven_pendulum-midpoint-cayley-").expect("settings are not the example's");
    assert!(hash.len() == 6 && hash.chars().all(|digit| digit.is_ascii_hexdigit()), "{stem}");

    // a plain table: a header and numbers
    let csv = scratch.read(&format!("out/{stem}.csv"));
    let mut lines = csv.lines();
    assert!(lines.next().is_some_and(|header| header.starts_with("time,angle_re,")), "a header");
    assert!(lines.flat_map(|line| line.split(',')).all(|cell| cell.parse::<f64>().is_ok()), "numbers");

    let run: Value = serde_json::from_str(&scratch.read(&format!("out/{stem}.run.json"))).expect("JSON");
    assert_eq!((&run["program"], &run["version"]), (&json!("two_systems"), &json!("1.2.3")));
    assert_eq!(run["coadjoint"], json!(env!("CARGO_PKG_VERSION")));
    assert!(scratch.read("out/page.html").contains("two_systems 1.2.3"));
    assert!(scratch.prints(&["--version"]).contains("1.2.3"));
    assert!(scratch.prints(&["--help"]).starts_with("A heavy top and a driven pendulum."));
    assert_eq!((&run["system"], &run["method"]), (&json!("driven_pendulum"), &json!("midpoint")));
    assert_eq!((&run["retraction"], &run["every"]), (&json!("cayley"), &json!(7)));
    assert_eq!(run["step"].to_string(), "0.0031415926535897933");
    assert_eq!(run["parameters"]["weight"].to_string(), "9.806649999999998");
    assert_eq!((&run["controls"]["motor"], &run["units"]["inertia"]), (&json!(-0.001), &json!("kg m²")));
    // an observable's own, and that of the energy, which the description leaves to the library
    assert_eq!((&run["units"]["power"], &run["units"]["energy"]), (&json!("W"), &json!("J")));
    assert_eq!(run["state"]["momentum"], json!(0.1));
    for name in files.iter().filter(|name| **name != "page.html") {
        assert_eq!(run["files"][name.as_str()], "complete", "{name}");
    }
    // the command that it says makes it
    let command = run["command"].as_str().expect("a command");
    let words: Vec<&str> = command.split(' ').collect();
    assert_eq!(words[..4], ["run", "driven_pendulum", "--method", "midpoint"]);
    scratch.prints(&[&words[..], &["--out", "typed"]].concat());
    assert_eq!(scratch.files("typed"), [format!("{stem}.csv"), format!("{stem}.run.json")]);
    assert!(scratch.read(&format!("typed/{stem}.csv")) == csv);

    for name in &files {
        scratch.prints(&["run", "--again", &format!("out/{name}"), "--out", "again"]);
    }
    for name in files.iter().filter(|name| **name != "page.html") {
        assert!(scratch.bytes(&format!("out/{name}")) == scratch.bytes(&format!("again/{name}")), "{name}");
    }
    assert!(scratch.bytes("out/page.html") == scratch.bytes("again/page.html"));
    scratch.prints(&["run", "--again", &format!("out/{stem}.run.json"), "--out", "described"]);
    assert!(scratch.read(&format!("described/{stem}.csv")) == csv);
    let page: Value = serde_json::from_str(&scratch.read("out/page.run.json")).expect("JSON");
    assert_eq!((&page["files"], &page["step"]), (&json!({ "page.html": "complete" }), &run["step"]));
    let refused = scratch.fails(2, &["run", "--again", "out/page.html", "--step", "1"]);
    assert!(refused.contains("cannot be used with"), "{refused}");
    scratch.write("stranger.csv", b"time,x\n0,1\n");
    let refused = scratch.fails(2, &["run", "--again", "stranger.csv"]);
    assert!(refused.contains("nothing beside stranger.csv says what made it"), "{refused}");
    // a system that computes something else
    let other = scratch.read(&format!("out/{stem}.run.json"));
    scratch.write("other.run.json", other.replacen("\"digest\": \"", "\"digest\": \"0", 1).as_bytes());
    let refused = scratch.fails(2, &["run", "--again", "other.run.json"]);
    assert!(refused.contains("whose digits differ"), "{refused}");
}

#[test]
fn an_ensemble_is_made_again() {
    let scratch = Scratch::new("ensemble");
    let some = ["ensemble", "heavy_top", "--members", "5", "--duration", "1", "--spread", "inertia=1%"];
    scratch.prints(&[&some[..], &["--set", "momentum_x=0.1", "--seed", "3"]].concat());
    let files = scratch.files("out");
    assert!(
        files.len() == 4 && files.iter().all(|name| name.starts_with("heavy_top-ensemble-")),
        "{files:?}"
    );
    for name in &files {
        let directory = &format!("again-{name}");
        scratch.prints(&["run", "--again", &format!("out/{name}"), "--out", directory]);
        assert_eq!(scratch.files(directory), files);
        assert!(
            scratch.bytes(&format!("out/{name}")) == scratch.bytes(&format!("{directory}/{name}")),
            "{name}"
        );
    }
}

#[test]
fn names_tell_runs_apart_and_nothing_is_replaced_unasked() {
    let scratch = Scratch::new("names");
    scratch.prints(&["run", "driven_pendulum"]);
    scratch.prints(&["run", "driven_pendulum", "--step", "0.02"]);
    scratch.prints(&["run", "driven_pendulum", "--set", "weight=9"]);
    let files = scratch.files("out");
    assert_eq!(files.iter().filter(|name| name.ends_with(".csv")).count(), 3, "{files:?}");
    assert!(files.contains(&"driven_pendulum-exponential.csv".to_owned()), "{files:?}");
    // the same run takes the place of itself
    scratch.prints(&["run", "driven_pendulum"]);

    let page = ["--html", "page.html", "--duration", "0.5"];
    scratch.prints(&[&["view", "driven_pendulum"], &page[..]].concat());
    let before = scratch.bytes("page.html");
    let refused = scratch.fails(2, &[&["view", "heavy_top"], &page[..]].concat());
    assert!(
        refused.contains("page.html exists and is of a run with another") && refused.contains("system"),
        "{refused}"
    );
    assert!(scratch.bytes("page.html") == before);
    scratch.write("notes.txt", b"mine");
    let refused = scratch.fails(2, &["run", "driven_pendulum", "--html", "notes.txt"]);
    assert!(refused.contains("notes.txt exists and was not made by this program"), "{refused}");
    scratch.write("notes.run.json", b"{\"mine\": true}");
    let refused = scratch.fails(2, &["run", "driven_pendulum", "--html", "notes.html"]);
    assert!(refused.contains("notes.run.json exists and was not made by this program"), "{refused}");
    scratch.write("out/driven_pendulum-cayley.csv", b"mine");
    // before the run starts: this one would take days
    let long =
        ["run", "driven_pendulum", "--retraction", "cayley", "--duration", "10", "--html", "page.html"];
    let refused = scratch.fails(2, &long);
    assert!(refused.contains("driven_pendulum-cayley.csv exists"), "{refused}");
    assert_eq!(
        (scratch.read("out/driven_pendulum-cayley.csv"), scratch.read("notes.txt")),
        ("mine".into(), "mine".into())
    );
    assert_eq!(scratch.read("notes.run.json"), "{\"mine\": true}");
    scratch.prints(&[&long[..], &["--force"]].concat());
    assert!(scratch.read("out/driven_pendulum-cayley.csv").starts_with("time,angle_re,"));
    // what was taken by force is the run's now
    scratch.prints(&long);
}

/// Also through links and `..`.
#[test]
fn no_two_files_of_a_command_are_one() {
    let scratch = Scratch::new("collisions");
    scratch.write("run.toml", b"system = \"driven_pendulum\"\n");
    scratch.write("data.rows", b"foreign");
    scratch.write("sub/x", b"");
    let cases: &[&[&str]] = &[
        &["--html", "out/driven_pendulum-exponential.csv"],
        &["--html", "sub/../out/driven_pendulum-exponential.csv"],
        &["--html", "new/../out/./driven_pendulum-exponential.csv"],
        &["--html", "out/driven_pendulum-exponential.run.json"],
        &["--checkpoint", "out/driven_pendulum-exponential.run.json"],
        &["--html", "c", "--checkpoint", "c"],
        &["--html", "c.rows", "--checkpoint", "c"],
        &["--checkpoint", "out/driven_pendulum-exponential.csv"],
        &["--html", "run.toml"],
        &["--html", "out/driven_pendulum-exponential.svg", "--plot"],
        &["--checkpoint", "run.toml"],
    ];
    for case in cases {
        let refused = scratch.fails(2, &[&["run", "--config", "run.toml", "--force"], *case].concat());
        assert!(refused.contains(" would be both "), "{case:?}: {refused}");
    }
    let refused = scratch.fails(2, &["run", "driven_pendulum", "--checkpoint", "data"]);
    assert!(refused.contains("data.rows exists already"), "{refused}");
    let refused = scratch.fails(2, &["run", "driven_pendulum", "--checkpoint", "sub/x"]);
    assert!(refused.contains("sub/x exists already, and is no checkpoint"), "{refused}");
    assert_eq!(
        (scratch.read("data.rows"), scratch.read("run.toml")),
        ("foreign".into(), "system = \"driven_pendulum\"\n".into())
    );
    assert_eq!(scratch.files("."), ["data.rows", "out", "run.toml", "sub"]);
    assert!(scratch.files("out").is_empty());
}

#[test]
#[cfg(unix)]
fn links_and_devices_are_written_to() {
    use std::os::unix::fs::{FileTypeExt, symlink};
    use std::process::Command;
    let scratch = Scratch::new("links");
    fs::create_dir_all(scratch.path("elsewhere")).expect("writable");
    let view = |page: &str| scratch.run(&["view", "driven_pendulum", "--html", page]);
    // to a file that is not there yet, and again
    symlink("elsewhere/page.html", scratch.path("link")).expect("writable");
    symlink("link", scratch.path("link-to-link")).expect("writable");
    for _ in 0..2 {
        assert!(view("link-to-link").status.success());
        assert!(scratch.path("link").is_symlink() && scratch.path("link-to-link").is_symlink());
    }
    assert_eq!(scratch.files("elsewhere"), ["page.html", "page.run.json"]);
    let page = scratch.bytes("link");
    // through another link it is the same file
    let refused = scratch
        .fails(2, &["run", "driven_pendulum", "--html", "link", "--checkpoint", "elsewhere/page.html"]);
    assert!(refused.contains("would be both"), "{refused}");
    // a directory that is a link
    symlink("elsewhere", scratch.path("out")).expect("writable");
    let refused =
        scratch.fails(2, &["run", "driven_pendulum", "--html", "elsewhere/driven_pendulum-exponential.csv"]);
    assert!(refused.contains("would be both"), "{refused}");
    // a pipe
    assert!(Command::new("mkfifo").arg(scratch.path("pipe")).status().expect("mkfifo").success());
    let pipe = scratch.path("pipe");
    let reader = std::thread::spawn(move || fs::read(pipe).expect("readable"));
    assert!(view("pipe").status.success());
    // before the devices: this one is not missed
    assert!(fs::metadata(scratch.path("pipe")).expect("there").file_type().is_fifo());
    assert!(reader.join().expect("read") == page);
    // devices
    assert!(view("/dev/null").status.success());
    assert!(fs::metadata("/dev/null").expect("there").file_type().is_char_device());
    if cfg!(target_os = "linux") {
        let shown = view("/dev/stdout");
        assert!(shown.status.success() && text(&shown.stdout).contains("</html>"), "{}", text(&shown.stderr));
        let full = view("/dev/full");
        assert_eq!(full.status.code(), Some(4), "{}", text(&full.stderr));
        symlink("/dev/full", scratch.path("elsewhere/driven_pendulum-cayley.csv")).expect("writable");
        let full = scratch.run(&["run", "driven_pendulum", "--retraction", "cayley"]);
        assert_eq!(full.status.code(), Some(4), "{}", text(&full.stderr));
        assert!(scratch.path("elsewhere/driven_pendulum-cayley.csv").is_symlink());
    }
}

#[test]
fn a_page_that_cannot_be_written_is_told_before_the_run() {
    let scratch = Scratch::new("before");
    scratch.write("file", b"in the way");
    // long enough that it would not end
    let output = scratch.run(&["run", "driven_pendulum", "--duration", "1e12", "--html", "file/page.html"]);
    assert_eq!(output.status.code(), Some(4), "{}", text(&output.stderr));
    assert!(text(&output.stderr).starts_with("error: cannot write"), "{}", text(&output.stderr));
    scratch.fails(4, &["run", "driven_pendulum", "--duration", "1e12", "--html", "missing/"]);
    assert!(!scratch.path("missing").exists());
}

#[test]
fn what_describes_a_run_is_read_to_a_bound() {
    let scratch = Scratch::new("bound");
    if cfg!(unix) {
        let refused = scratch.fails(2, &["run", "--config", "/dev/zero"]);
        assert!(refused.contains("longer than a megabyte"), "{refused}");
        assert!(
            std::process::Command::new("mkfifo")
                .arg(scratch.path("pipe"))
                .status()
                .is_ok_and(|it| it.success())
        );
        for arguments in
            [["resume", "/dev/zero"], ["resume", "pipe"], ["play", "/dev/zero"], ["play", "pipe"]]
        {
            // of a checkpoint the rows are missed first where they are not there
            let refused = scratch.fails(2, &arguments);
            assert!(refused.contains("a device or a pipe"), "{arguments:?}: {refused}");
        }
        let taken =
            scratch.fails(2, &["run", "driven_pendulum", "--duration", "1", "--checkpoint", "/dev/zero"]);
        assert!(taken.contains("is no checkpoint"), "{taken}");
    }
    let toml = "system = \"driven_pendulum\"\n[parameters]\nweight = ";
    scratch.write("run.toml", format!("{toml}9007199254740993\n").as_bytes());
    let refused = scratch.fails(2, &["run", "--config", "run.toml"]);
    assert!(refused.contains("would be rounded"), "{refused}");
    scratch.write("run.toml", format!("{toml}9007199254740992\n").as_bytes());
    scratch.prints(&["run", "--config", "run.toml", "--duration", "0"]);
}

/// What a killed run left half-written is nobody's: other runs neither take it for theirs nor touch it.
#[test]
fn files_that_a_killed_run_left_are_not_touched() {
    let scratch = Scratch::new("stale");
    let stale = ".driven_pendulum-exponential.csv.0123abcd.coadjoint-tmp";
    scratch.write(&format!("out/{stale}"), b"half");
    scratch.prints(&["run", "driven_pendulum"]);
    assert_eq!(scratch.read(&format!("out/{stale}")), "half");
    let files = scratch.files("out");
    assert_eq!(files, [stale, "driven_pendulum-exponential.csv", "driven_pendulum-exponential.run.json"]);
}

#[test]
fn a_trajectory_goes_to_the_standard_output() {
    let scratch = Scratch::new("stdout");
    scratch.prints(&["run", "driven_pendulum", "--duration", "1"]);
    let name = scratch.named("out", "driven_pendulum", ".csv");
    let printed = scratch.says(&["run", "driven_pendulum", "--duration", "1", "--out", "-"]);
    assert!(printed.contains(&scratch.read(&name)), "{printed}");
    assert_eq!(scratch.files("."), ["out"], "no directory named `-`");
}
