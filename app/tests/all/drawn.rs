//! A campaign of command lines drawn at random, sound and absurd, under sound and absurd conditions: there is an exit code and a message,
//! never a panic, and what is not the program's stays as it is.
//!
//! `COADJOINT_CAMPAIGN=1` and `COADJOINT_SEED` are those of the [campaign against files](crate::reliability).

use std::fs;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use crate::program::{Scratch, text};
use crate::reliability::{Random, times};

/// Numbers as people, scripts and accidents write them.
const NUMBERS: [&str; 24] = [
    "1", "0.01", "-1e-3", "1e-3", "3", "0", "-0", "7.25", "-2", "1e300", "-1e300", "1e-300", "5e-324", "NaN",
    "inf", "-inf", "", "x", "1,2", "1,2,3", "1,2,3,4", "0x10", "1_000", "٣",
];
/// What any run or page of either system takes, or most do.
const SOUND: [&str; 16] = [
    "--set momentum=0.2",
    "--set momentum=1,2,3",
    "--set velocity_z=0.5",
    "--set attitude=euler:0.1,0.2,0.3",
    "--set attitude=mrp:0,0,1.5",
    "--set angle=0.7",
    "--set weight=2",
    "--set motor=-1e-3",
    "--step -1e-3",
    "--step 0.007",
    "--retraction cayley",
    "--method midpoint",
    "--method rk4",
    "--order 6",
    "--force",
    "--quiet",
];
const NAMES: [&str; 14] = [
    "inertia",
    "inertia_x",
    "weight",
    "chi",
    "attitude",
    "momentum",
    "momentum_z",
    "velocity",
    "velocity_y",
    "gamma",
    "angle",
    "motor",
    "step",
    "wieght",
];
const PATHS: [&str; 10] = [
    "out",
    "-",
    "a/b/c",
    "missing/",
    "taken",
    "taken/x",
    "/dev/null",
    "/dev/full",
    "link",
    "name\u{1b}[31m\u{7}",
];

fn any<'a>(random: &mut Random, of: &[&'a str]) -> &'a str {
    of[random.below(of.len())]
}

/// A command line that ends soon, if it is one at all.
fn drawn(random: &mut Random) -> Vec<String> {
    let commands =
        ["run", "run", "run", "view", "ensemble", "list", "init", "certify", "play", "resume", "rum"];
    let systems =
        ["heavy_top", "driven_pendulum", "heavy-top", "driven-pendulum", "heavy_top", "heavy_tpo", ""];
    let command = any(random, &commands);
    let mut line = vec![command.to_owned()];
    line.push(match command {
        "play" | "resume" => {
            any(random, &["data.json", "taken", "/dev/zero", "pipe", "missing.json", "run.ck"]).to_owned()
        }
        _ => any(random, &systems).to_owned(),
    });
    let number = |random: &mut Random| any(random, &NUMBERS).to_owned();
    for _ in 0..random.below(5) {
        // most lines are sound but for a word or two
        if random.below(4) > 0 && matches!(command, "run" | "view" | "ensemble") {
            line.extend(any(random, &SOUND).split(' ').map(str::to_owned));
            continue;
        }
        let option = any(
            random,
            &[
                "--set",
                "--set",
                "--step",
                "--every",
                "--scan",
                "--members",
                "--spread",
                "--retraction",
                "--method",
                "--order",
                "--columns",
                "--out",
                "--html",
                "--checkpoint",
                "--format",
                "--plot",
                "--json",
                "--quiet",
                "--force",
                "--config",
                "--again",
                "--seed",
                "--quantity",
                "--no-such-thing",
            ],
        );
        line.push(option.to_owned());
        match option {
            "--set" | "--scan" | "--spread" => {
                let (name, form) = (any(random, &NAMES), any(random, &["", "", "euler:", "mrp:", "what:"]));
                line.push(format!("{name}={form}{}", number(random)));
            }
            "--step" | "--every" | "--order" | "--seed" => line.push(number(random)),
            "--members" => {
                line.push(any(random, &["1", "5", "0", "-1", "x", "99999999999999999999"]).to_owned())
            }
            "--retraction" => line.push(any(random, &["exp", "cayley", "second-kind", "none"]).to_owned()),
            "--method" => {
                line.push(any(random, &["midpoint", "rk4", "family=1/4", "family=1/0", "rk5"]).to_owned())
            }
            "--columns" => {
                line.push(any(random, &["velocity", "euler,mrp", "angle", "rotvec,rotvec", "x"]).to_owned())
            }
            "--out" | "--html" | "--checkpoint" | "--config" | "--again" => {
                line.push(any(random, &PATHS).to_owned())
            }
            "--format" => line.push(any(random, &["csv", "json", "xml"]).to_owned()),
            "--quantity" => line.push(any(random, &["energy", "momentum_x", "enrgy"]).to_owned()),
            _ => {}
        }
    }
    // of whatever step it is, it ends
    if matches!(command, "run" | "view" | "ensemble") {
        line.extend(
            ["--duration", any(random, &["0", "0.05", "0.1", "0.05", "0.1", "-1", "1e300"])]
                .map(str::to_owned),
        );
    }
    line
}

/// The end of a program, which has to come soon, or at Ctrl-C.
fn end_of(command: &mut Command) -> Output {
    let mut child = command.stdin(Stdio::null()).spawn().expect("it starts");
    let start = Instant::now();
    let mut asked = false;
    while child.try_wait().expect("waits").is_none() {
        if start.elapsed() > Duration::from_secs(20) && !asked {
            crate::reliability::signal(&child, "-INT");
            asked = true;
        }
        assert!(start.elapsed() < Duration::from_secs(120), "it does not end");
        std::thread::sleep(Duration::from_millis(2));
    }
    child.wait_with_output().expect("it ended")
}

/// A directory with files of others, a link, a pipe that nobody writes to.
fn prepared() -> Scratch {
    let scratch = Scratch::new("drawn");
    scratch.write("taken", b"of others");
    scratch.write("target", b"of others");
    let _ = std::os::unix::fs::symlink("target", scratch.path("link"));
    let _ = Command::new("mkfifo").arg(scratch.path("pipe")).status();
    scratch
}

#[test]
fn any_command_line_has_an_answer() {
    let mut random = Random::new(7);
    let mut codes = std::collections::BTreeMap::<i32, usize>::new();
    for _ in 0..times(40, 3000) {
        let scratch = prepared();
        let line = drawn(&mut random);
        let words: Vec<&str> = line.iter().map(String::as_str).collect();
        let output = end_of(&mut scratch.command(&words));
        let (said, told) = (text(&output.stderr), text(&output.stdout));
        let code = output.status.code().unwrap_or_else(|| panic!("{line:?} was killed: {said}"));
        assert!([0, 2, 3, 4, 130].contains(&code), "{line:?}: {code} {said}");
        assert!(!said.contains("panicked") && !told.contains("panicked"), "{line:?}: {said}");
        assert!(code == 0 || !said.is_empty(), "{line:?}: {code} without a word");
        let forced = line.iter().any(|word| word == "--force");
        assert!(forced || scratch.bytes("taken") == b"of others", "{line:?} replaced a file");
        assert!(forced || scratch.bytes("target") == b"of others", "{line:?} replaced a file");
        let left = scratch.files("out").into_iter().filter(|name| name.contains("coadjoint-tmp"));
        assert_eq!(left.count(), 0, "{line:?} left a temporary file");
        *codes.entry(code).or_default() += 1;
    }
    println!("exit codes: {codes:?}");
    assert!(codes.contains_key(&0) && codes.contains_key(&2), "{codes:?}");
}

/// What can fail does: descriptors, memory, streams, directories. The result is whole, or an exit code says that it is not.
#[test]
fn what_the_system_refuses_is_told() {
    let scratch = Scratch::new("refused");
    let program = scratch.command(&[]).get_program().to_string_lossy().into_owned();
    let run = format!("{program} run heavy_top --duration 1 --plot --html page.html");
    let ensemble = format!("{program} ensemble heavy_top --members 100 --duration 1");
    let mut scripts = Vec::new();
    for command in [&run, &ensemble] {
        for limit in (4..=16).step_by(if times(0, 1) == 1 { 1 } else { 4 }) {
            scripts.push(format!("ulimit -n {limit}; {command}"));
        }
        for kilobytes in [40_000, 80_000, 160_000, 320_000].into_iter().skip(times(2, 0)) {
            scripts.push(format!("ulimit -v {kilobytes}; {command}"));
        }
        for streams in [">/dev/full", "2>/dev/full", ">&-", "2>&-", ">&- 2>&-", "</dev/null >/dev/full 2>&1"]
        {
            scripts.push(format!("{command} {streams}"));
        }
        scripts.push(format!("mkdir out; chmod 500 out; {command}; code=$?; chmod 700 out; exit $code"));
    }
    for script in scripts {
        let scratch = Scratch::new("refused");
        let output = end_of(
            Command::new("sh")
                .args(["-c", &script])
                .current_dir(&scratch.0)
                .stdout(Stdio::piped())
                .stderr(Stdio::piped()),
        );
        let said = text(&output.stderr);
        // where there is no memory, Rust's own runtime ends the program
        let is_memory = script.contains("ulimit -v");
        assert!(is_memory || !said.contains("panicked"), "{script}: {said}");
        assert!(is_memory || output.status.code().is_some_and(|code| code <= 4), "{script}: {output:?}");
        // each file that is there is whole, and is said to be
        for name in scratch.files("out").into_iter().filter(|name| name.ends_with(".run.json")) {
            let made: serde_json::Value =
                serde_json::from_str(&scratch.read(&format!("out/{name}"))).expect("whole");
            let complete = made["files"]
                .as_object()
                .expect("by name")
                .iter()
                .filter(|(_, status)| *status == "complete");
            for (file, _) in complete {
                let content = fs::read(scratch.path(&format!("out/{file}")))
                    .expect("what is said to be complete is there");
                assert!(!content.is_empty(), "{script}: {file} is empty");
                if file.ends_with(".csv") {
                    assert!(content.ends_with(b"\n"), "{script}: {file} is cut");
                }
            }
        }
    }
}
