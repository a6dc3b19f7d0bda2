//! Errors at system calls: each call by which a command touches files fails once, as on a disk that is full, broken, or not one's own. Then an
//! exit code says so and a message why, and under each name is the whole file, or what was there before.
//!
//! The calls are counted and made to fail by `strace`; where there is none, or it may not trace, nothing is tried. `COADJOINT_CAMPAIGN=1` makes
//! each of them fail, `COADJOINT_SEED` chooses others.

use std::collections::BTreeMap;
use std::fs;
use std::process::{Command, Output, Stdio};

use crate::program::{Scratch, text};
use crate::reliability::{Foreign, Random, times};

const CALLS: &str = "trace=openat,write,fsync,fdatasync,ftruncate,/^(rename|link|unlink|mkdir)";
const ERRORS: [&str; 3] = ["ENOSPC", "EIO", "EACCES"];
/// More of a kind would be rows of one file.
const MOST: usize = 60;

/// All that write files. The first few take milliseconds.
const COMMANDS: [&[&str]; 6] = [
    &["run", "heavy_top", "--duration", "0.05", "--checkpoint", "run.ck", "--save-every", "0.001"],
    &["run", "driven_pendulum", "--duration", "0.05", "--format", "json"],
    &["init", "heavy_top", "--force"],
    &["run", "heavy_top", "--duration", "0.05", "--plot", "--html", "page.html"],
    &["view", "heavy_top", "--duration", "0.05"],
    &["ensemble", "heavy_top", "--members", "4", "--duration", "0.05"],
];

/// Contents by name.
type Files = BTreeMap<String, Vec<u8>>;

/// A command, what it makes where nothing fails, and the calls that it makes for that.
struct Case {
    arguments: &'static [&'static str],
    whole: Files,
    /// `("openat", 3)`
    calls: Vec<(String, usize)>,
}

/// Runs a command under `strace`, which notes its calls in `calls.log`.
fn traced(scratch: &Scratch, arguments: &[&str], inject: Option<&str>) -> Output {
    let command = scratch.command(arguments);
    let mut strace = Command::new("strace");
    strace.args(["-qq", "-o", "calls.log", "-e", CALLS]);
    strace.args(inject.into_iter().flat_map(|inject| ["-e", inject]));
    strace.arg(command.get_program()).args(command.get_args()).current_dir(&scratch.0);
    // else the libraries that Rust's own would come from are looked for first
    strace.env_remove("LD_LIBRARY_PATH").stdin(Stdio::null()).output().expect("it starts")
}

/// The files of the program, in `out` and beside it.
fn files(scratch: &Scratch) -> Files {
    let in_out = scratch.files("out").into_iter().map(|name| format!("out/{name}"));
    let beside = scratch.files(".").into_iter().filter(|name| name != "calls.log");
    let names = in_out.chain(beside).filter(|name| scratch.path(name).is_file());
    names.map(|name| (name.clone(), scratch.bytes(&name))).collect()
}

impl Case {
    fn new(arguments: &'static [&'static str]) -> Self {
        let scratch = Scratch::new("uninjected");
        let output = traced(&scratch, arguments, None);
        assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
        let whole = files(&scratch);
        assert!(!whole.is_empty(), "{arguments:?} writes nothing");
        let mut counts = BTreeMap::<String, usize>::new();
        let mut calls = Vec::new();
        for line in scratch.read("calls.log").lines() {
            let Some((name, _)) = line.split_once('(') else { continue };
            let count = counts.entry(name.to_owned()).or_default();
            *count += 1;
            // what is read before the program begins is none of its files
            let is_systems = ["\"/etc", "\"/proc", "\"/sys", ".so"].iter().any(|part| line.contains(part));
            if *count <= MOST && !is_systems {
                calls.push((name.to_owned(), *count));
            }
        }
        Self { arguments, whole, calls }
    }

    /// Lets one of the calls fail. Before, nothing is there, or older files of the same run. Returns whether it has failed for that.
    fn fails_at(&self, (name, when): &(String, usize), error: &str, is_again: bool) -> bool {
        let what = format!(
            "{:?}, {error} at {name} {when}, {}",
            self.arguments,
            if is_again { "again" } else { "new" }
        );
        let scratch = Scratch::new("injected");
        let foreign = Foreign::plant(&scratch);
        // that of the run says that it may be replaced
        let is_of_run = |name: &str| name.ends_with(".run.json");
        let old = |name: &str| format!("before: {name}").into_bytes();
        for (name, content) in self.whole.iter().filter(|_| is_again) {
            scratch.write(name, &if is_of_run(name) { content.clone() } else { old(name) });
        }
        let output =
            traced(&scratch, self.arguments, Some(&format!("inject={name}:error={error}:when={when}")));
        let (said, log) = (text(&output.stderr), scratch.read("calls.log"));
        let injected = log.lines().find(|line| line.ends_with("(INJECTED)")).unwrap_or_default();
        let what = format!("{what}: {injected}: {said}");

        assert!(!said.contains("panicked"), "{what}");
        let code = output.status.code().unwrap_or_else(|| panic!("{what}"));
        let is_said = said.contains("error: ") || injected.starts_with("write(2,");
        assert!(code == 0 || !injected.is_empty() && is_said, "{what}");
        // what is only looked for may be missing
        let must_succeed = !name.starts_with("open") && !name.starts_with("unlink");
        assert!(code != 0 || injected.is_empty() || !must_succeed, "{what}: it is not told");
        foreign.check();
        for (name, whole) in &self.whole {
            let found = fs::read(scratch.path(name)).ok();
            let is_whole = found.as_ref() == Some(whole);
            let is_as_before = code != 0 && found == is_again.then(|| old(name));
            // it may say of files that they are not there yet
            assert!(is_whole || is_as_before || code != 0 && is_of_run(name), "{what}: {name} is {found:?}");
        }
        // one of others; one that could not be removed, or that is said to hold what could not be put in its place
        let may_stay = name.starts_with("unlink") || said.contains("what was to be written is in");
        let left = files(&scratch).into_keys().filter(|name| name.ends_with("coadjoint-tmp")).count();
        assert!(left == 1 || left == 2 && may_stay, "{what}: {left} temporary files");
        if scratch.path("run.ck").exists() {
            assert!(code != 0 || name.starts_with("unlink"), "{what}");
            scratch.prints(&["resume", "run.ck"]);
            for (name, whole) in self.whole.iter().filter(|(name, _)| !is_of_run(name)) {
                assert!(scratch.bytes(name) == *whole, "{what}: {name} after going on");
            }
        }
        code != 0
    }
}

#[test]
fn a_call_that_fails_leaves_nothing_half_written() {
    let may_trace = Command::new("strace").args(["-o", "/dev/null", "true"]).output();
    if !may_trace.is_ok_and(|output| output.status.success()) {
        println!("nothing was tried: there is no strace, or it may not trace");
        return;
    }
    let mut random = Random::new(8);
    let (mut tried, mut failed) = (0, 0);
    for arguments in COMMANDS.into_iter().take(times(3, COMMANDS.len())) {
        let case = Case::new(arguments);
        let each = case.calls.iter().flat_map(|call| ERRORS.map(|error| (call, error)));
        let mut chosen: Vec<_> =
            each.flat_map(|(call, error)| [(call, error, false), (call, error, true)]).collect();
        if times(0, 1) == 0 {
            chosen = (0..3).map(|_| chosen[random.below(chosen.len())]).collect();
        }
        for (call, error, is_again) in chosen {
            tried += 1;
            failed += usize::from(case.fails_at(call, error, is_again));
        }
    }
    println!("{tried} calls failed: {failed} commands ended with an error");
    assert!(failed > tried / 3, "{failed} of {tried}");
}
