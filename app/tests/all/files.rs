//! Files one can trust: they say what made them, can be made again, and take no other's place.

use std::fs;

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
fn every_file_says_what_made_it_and_can_be_made_again() {
    let scratch = Scratch::new("again");
    scratch.prints(&[&ODD[..], &["--plot", "--html", "out/page.html"]].concat());
    for format in ["json", "parquet"] {
        if cfg!(feature = "parquet") || format == "json" {
            scratch.prints(&[&ODD[..], &["--format", format]].concat());
        }
    }
    let files = scratch.files("out");
    let kinds: Vec<&str> =
        files.iter().filter_map(|name| name.rsplit_once('.')).map(|(_, kind)| kind).collect();
    assert_eq!(kinds.len(), if cfg!(feature = "parquet") { 6 } else { 5 }, "{files:?}");
    let stem = files.iter().find_map(|name| name.strip_suffix(".csv")).expect("a table").to_owned();
    let hash = stem.strip_prefix("driven_pendulum-midpoint-cayley-").expect("settings are not the example's");
    assert!(hash.len() == 6 && hash.chars().all(|digit| digit.is_ascii_hexdigit()), "{stem}");

    let csv = scratch.read(&format!("out/{stem}.csv"));
    let mut lines = csv.lines();
    assert_eq!(lines.next(), Some(concat!("# coadjoint ", env!("CARGO_PKG_VERSION"))));
    let run = lines.next().and_then(|line| line.strip_prefix("# run: ")).expect("a run");
    for part in [
        "\"system\":\"driven_pendulum\"",
        "\"weight\":9.806649999999998",
        "\"motor\":-0.001",
        "\"method\":\"midpoint\"",
        "\"retraction\":\"cayley\"",
        "\"step\":0.0031415926535897933",
        "\"every\":7",
        "\"state\":{",
        "\"inertia\":\"kg m²\"",
        concat!("\"version\":\"", env!("CARGO_PKG_VERSION"), "\""),
    ] {
        assert!(run.contains(part), "{part} in {run}");
    }
    assert!(lines.next().is_some_and(|header| header.starts_with("time,angle_re,")), "a header");

    for name in &files {
        scratch.prints(&["run", "--again", &format!("out/{name}"), "--out", "again"]);
    }
    for name in files.iter().filter(|name| *name != "page.html") {
        assert!(scratch.bytes(&format!("out/{name}")) == scratch.bytes(&format!("again/{name}")), "{name}");
    }
    assert!(scratch.bytes("out/page.html") == scratch.bytes(&format!("again/{stem}.html")));
    assert!(scratch.read("out/page.html").contains("<script id=\"coadjoint-run\""));
    let refused = scratch.fails(2, &["run", "--again", "out/page.html", "--step", "1"]);
    assert!(refused.contains("cannot be used with"), "{refused}");
    scratch.write("stranger.csv", b"time,x\n0,1\n");
    let refused = scratch.fails(2, &["run", "--again", "stranger.csv"]);
    assert!(refused.contains("does not say what made it"), "{refused}");
    // a system that computes something else
    scratch.write("other.csv", csv.replacen("\"digest\":\"", "\"digest\":\"0", 1).as_bytes());
    let refused = scratch.fails(2, &["run", "--again", "other.csv"]);
    assert!(refused.contains("whose digits differ"), "{refused}");
}

#[test]
fn an_ensemble_is_made_again() {
    let scratch = Scratch::new("ensemble");
    let some = ["ensemble", "heavy_top", "--members", "5", "--duration", "1", "--spread", "inertia=1%"];
    scratch.prints(&[&some[..], &["--set", "momentum_x=0.1", "--seed", "3"]].concat());
    let files = scratch.files("out");
    assert!(
        files.len() == 3 && files.iter().all(|name| name.starts_with("heavy_top-ensemble-")),
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
    assert_eq!(files.len(), 3, "{files:?}");
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
    scratch.prints(&[&long[..], &["--force"]].concat());
    assert!(scratch.read("out/driven_pendulum-cayley.csv").starts_with("# coadjoint"));
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
        &["--html", "c", "--checkpoint", "c"],
        &["--html", "c.rows", "--checkpoint", "c"],
        &["--html", "c.lock", "--checkpoint", "c"],
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
    assert_eq!(scratch.files("elsewhere"), ["page.html"]);
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
    let output =
        scratch.run(&["run", "driven_pendulum", "--duration", "1e12", "--long", "--html", "file/page.html"]);
    assert_eq!(output.status.code(), Some(4), "{}", text(&output.stderr));
    assert!(text(&output.stderr).starts_with("error: cannot write"), "{}", text(&output.stderr));
}

#[test]
fn what_describes_a_run_is_read_to_a_bound() {
    let scratch = Scratch::new("bound");
    if cfg!(unix) {
        let refused = scratch.fails(2, &["run", "--config", "/dev/zero"]);
        assert!(refused.contains("longer than a megabyte"), "{refused}");
    }
    let toml = "system = \"driven_pendulum\"\n[parameters]\nweight = ";
    scratch.write("run.toml", format!("{toml}9007199254740993\n").as_bytes());
    let refused = scratch.fails(2, &["run", "--config", "run.toml"]);
    assert!(refused.contains("would be rounded"), "{refused}");
    scratch.write("run.toml", format!("{toml}9007199254740992\n").as_bytes());
    scratch.prints(&["run", "--config", "run.toml", "--duration", "0"]);
}

#[test]
fn files_that_a_killed_run_left_are_told() {
    let scratch = Scratch::new("stale");
    let stale = ".driven_pendulum-exponential.csv.0123abcd.coadjoint-tmp";
    scratch.write(&format!("out/{stale}"), b"half");
    let printed = scratch.says(&["run", "driven_pendulum"]);
    assert!(printed.contains(&format!("out/{stale}` removes it")), "{printed}");
    assert_eq!(scratch.read(&format!("out/{stale}")), "half");
    // one that is being written is not
    let file = fs::File::open(scratch.path(&format!("out/{stale}"))).expect("there");
    file.lock().expect("locked");
    let printed = scratch.says(&["run", "driven_pendulum"]);
    assert!(!printed.contains(stale), "{printed}");
}

#[test]
fn a_trajectory_goes_to_the_standard_output() {
    let scratch = Scratch::new("stdout");
    scratch.prints(&["run", "driven_pendulum", "--duration", "1"]);
    let name = scratch.files("out").pop().expect("a file");
    let printed = scratch.says(&["run", "driven_pendulum", "--duration", "1", "--out", "-"]);
    assert!(printed.contains(&scratch.read(&format!("out/{name}"))), "{printed}");
    assert_eq!(scratch.files("."), ["out"], "no directory named `-`");
}
