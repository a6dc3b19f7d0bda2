//! Ensembles on several ranks have the bytes of one process; ranks that are killed, or cannot write, end the job, and
//! it goes on later.
//!
//! `COADJOINT_CAMPAIGN=1 cargo test --no-default-features` kills fifty times; `COADJOINT_SEED` at other moments.
#![cfg(target_os = "linux")]
#![allow(clippy::expect_used, clippy::panic, reason = "all of it is tests")]

use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::LazyLock;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// Members in 30 blocks; about a second of one processor.
const SOME: [&str; 16] = [
    "ensemble",
    "heavy_top",
    "--members",
    "3e3",
    "--duration",
    "300",
    "--every",
    "7500",
    "--spread",
    "momentum=5%",
    "--block",
    "100",
    "--rows",
    "end",
    "--save-every",
    "0",
];

type Files = Vec<(String, Vec<u8>)>;

struct Scratch {
    /// Where the program writes.
    path: PathBuf,
    /// Where Open MPI has its own files, of this job alone: a job that ends removes the directory in which another one,
    /// that starts, is about to make its own. Short, for sockets have names of 107 bytes.
    sessions: PathBuf,
}

impl Scratch {
    fn new(test: &str) -> Self {
        static COUNT: AtomicUsize = AtomicUsize::new(0);
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        let name = format!("{test}-{}-{count}", std::process::id());
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
        let sessions = std::env::temp_dir().join(format!("ranks-{}-{count}", std::process::id()));
        for path in [&path, &sessions] {
            let _ = fs::remove_dir_all(path);
            fs::create_dir_all(path).expect("writable");
        }
        Self { path, sessions }
    }

    fn start(&self, ranks: usize, arguments: &[&str]) -> Child {
        self.mpirun(&[&["-n", &ranks.to_string(), program().to_str().expect("UTF-8")], arguments].concat())
    }

    fn mpirun(&self, arguments: &[&str]) -> Child {
        let mut command = self.command(Path::new("mpirun"));
        command.args(is_open_mpi().then_some("--oversubscribe")).args(arguments).stdin(Stdio::null());
        command.env("RAYON_NUM_THREADS", "1").stdout(Stdio::piped()).stderr(Stdio::piped());
        command.spawn().expect("mpirun starts")
    }

    fn command(&self, program: &Path) -> Command {
        let mut command = Command::new(program);
        as_root(&mut command).current_dir(&self.path).env("TMPDIR", &self.sessions);
        command
    }

    fn run(&self, ranks: usize, arguments: &[&str]) -> Output {
        self.start(ranks, arguments).wait_with_output().expect("it ends")
    }

    fn prints(&self, ranks: usize, arguments: &[&str]) -> String {
        let output = self.run(ranks, arguments);
        assert!(output.status.success(), "{ranks} ranks: {}", text(&output.stderr));
        text(&output.stdout)
    }

    /// Tells whether a rank has written what a job that was ended goes on with.
    fn has_shards(&self) -> bool {
        self.files().iter().any(|path| path.extension().is_some_and(|extension| extension == "shard"))
    }

    /// All that is in the directory of results and below.
    fn results(&self) -> Files {
        let root = self.path.join("out");
        let read = |path: PathBuf| {
            let name = path.strip_prefix(&root).expect("in it").to_string_lossy().into_owned();
            (name, fs::read(&path).expect("readable"))
        };
        let mut found: Files = self.files().into_iter().map(read).collect();
        found.sort();
        found
    }

    /// Where the files are, some of which a running job may have renamed since.
    fn files(&self) -> Vec<PathBuf> {
        let (mut found, mut directories) = (Vec::new(), vec![self.path.join("out")]);
        while let Some(directory) = directories.pop() {
            for entry in fs::read_dir(&directory).into_iter().flatten().flatten() {
                let path = entry.path();
                if path.is_dir() { &mut directories } else { &mut found }.push(path);
            }
        }
        found
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.path);
        let _ = fs::remove_dir_all(&self.sessions);
    }
}

/// Tells whether this is Open MPI, which has to be told that there may be more ranks than processors.
fn is_open_mpi() -> bool {
    static IS_IT: LazyLock<bool> = LazyLock::new(|| {
        let version = as_root(&mut Command::new("mpirun")).arg("--version").output().expect("mpirun starts");
        text(&version.stdout).contains("Open MPI")
    });
    *IS_IT
}

/// Containers are run by root.
fn as_root(command: &mut Command) -> &mut Command {
    command.env("OMPI_ALLOW_RUN_AS_ROOT", "1").env("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// `cargo test` builds the examples beside its tests.
fn program() -> PathBuf {
    let test = std::env::current_exe().expect("it is running");
    let profile = test.parent().and_then(Path::parent).expect("in deps of a profile");
    profile.join("examples/two_bodies")
}

/// What one process writes that knows nothing of others.
fn alone(arguments: &[&str]) -> Files {
    alone_with(&program(), arguments)
}

fn alone_with(program: &Path, arguments: &[&str]) -> Files {
    let scratch = Scratch::new("alone");
    let output = scratch.command(program).args(arguments).output().expect("it starts");
    assert!(output.status.success(), "{}: {}", output.status, text(&output.stderr));
    let found = scratch.results();
    assert!(found.len() > 4, "table, picture, rows");
    found
}

fn same(found: &Files, expected: &Files, of: &str) {
    let names = |files: &Files| files.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>();
    assert_eq!(names(found), names(expected), "{of}");
    for ((name, found), (_, expected)) in found.iter().zip(expected) {
        assert!(found == expected, "{of}: {name} differs");
    }
}

/// The ranks of a job: what it started, by itself or by a process of its own on each node.
fn ranks_of(job: &Child) -> Vec<u32> {
    let own = program().file_name().expect("a file").to_string_lossy().into_owned();
    let mut all = HashMap::new();
    for entry in fs::read_dir("/proc").expect("Linux").flatten() {
        let Ok(process) = entry.file_name().to_string_lossy().parse::<u32>() else { continue };
        let stat = fs::read_to_string(entry.path().join("stat")).unwrap_or_default();
        let Some((name, rest)) = stat.rsplit_once(')') else { continue };
        let above = rest.split_whitespace().nth(1).and_then(|above| above.parse::<u32>().ok());
        let is_own = name.split_once('(').is_some_and(|(_, name)| name == own);
        all.extend(above.map(|above| (process, (is_own, above))));
    }
    let above = |process: &u32| all.get(process).map(|(_, above)| *above);
    let is_of_job =
        |process: u32| std::iter::successors(Some(process), above).any(|process| process == job.id());
    let ranks = all.iter().filter(|(process, (is_own, _))| *is_own && is_of_job(**process));
    let mut found: Vec<u32> = ranks.map(|(process, _)| *process).collect();
    found.sort_unstable();
    found
}

/// SplitMix64.
struct Random(u64);

impl Random {
    fn below(&mut self, bound: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (bits ^ (bits >> 31)) % bound
    }
}

#[test]
fn any_number_of_ranks_has_the_bytes_of_one_process() {
    let expected = alone(&SOME);
    for ranks in 1..=4 {
        let scratch = Scratch::new("ranks");
        let printed = scratch.prints(ranks, &SOME);
        same(&scratch.results(), &expected, &format!("{ranks} ranks"));
        assert!(printed.contains("3,000 members, 90,000,000 steps"), "{printed}");
        assert_eq!(printed.matches("wrote out/heavy_top-ensemble-").count(), 4, "once: {printed}");
    }
}

/// The program with all systems, where it is compiled.
#[cfg(feature = "catalogue")]
#[test]
fn ranks_share_the_catalogue_too() {
    let program = env!("CARGO_BIN_EXE_coadjoint-mpi");
    for system in ["free_rigid_body", "quadrotor"] {
        let asked =
            ["ensemble", system, "--members", "300", "--duration", "0.5", "--block", "50", "--rows", "end"];
        let expected = alone_with(Path::new(program), &asked);
        let scratch = Scratch::new("catalogue");
        let output = scratch.mpirun(&[&["-n", "2", program], &asked[..]].concat()).wait_with_output();
        let output = output.expect("it ends");
        assert!(output.status.success(), "{system}: {}", text(&output.stderr));
        same(&scratch.results(), &expected, system);
    }
}

#[test]
fn a_rank_that_is_killed_ends_the_job_and_it_goes_on() {
    let expected = alone(&SOME);
    let times = if std::env::var_os("COADJOINT_CAMPAIGN").is_some() { 50 } else { 3 };
    let mut random =
        Random(std::env::var("COADJOINT_SEED").ok().and_then(|seed| seed.parse().ok()).unwrap_or(1));
    let (mut kills, mut slowest, mut gone_on) = (0, Duration::ZERO, 0);
    while kills < times {
        let (scratch, ranks) = (Scratch::new("killed"), 2 + random.below(3) as usize);
        let mut job = scratch.start(ranks, &SOME);
        while ranks_of(&job).len() < ranks && job.try_wait().expect("waits").is_none() {
            std::thread::sleep(Duration::from_millis(1));
        }
        // one kill in three comes when there is work to go on with, however busy the machine is
        while kills % 3 == 0 && !scratch.has_shards() && job.try_wait().expect("waits").is_none() {
            std::thread::sleep(Duration::from_millis(1));
        }
        std::thread::sleep(Duration::from_millis(random.below(if kills % 3 == 0 { 50 } else { 2_500 })));
        let processes = ranks_of(&job);
        let Some(process) = processes.get(random.below(ranks as u64) as usize) else {
            // it had ended
            assert!(job.wait().expect("waits").success());
            continue;
        };
        let killed = Command::new("kill").args(["-KILL", &process.to_string()]).status();
        let start = Instant::now();
        let output = job.wait_with_output().expect("it ends");
        slowest = slowest.max(start.elapsed());
        assert!(start.elapsed() < Duration::from_secs(10), "{:?}", start.elapsed());
        if output.status.success() {
            // a rank that had done its work
            assert!(killed.is_ok());
            same(&scratch.results(), &expected, "killed at its end");
            continue;
        }
        kills += 1;
        let found = scratch.results();
        for (name, content) in
            found.iter().filter(|(name, _)| !name.contains(".blocks/") && !name.ends_with(".run.json"))
        {
            let whole = expected.iter().find(|(expected, _)| expected == name);
            let is_temporary = name.ends_with(".coadjoint-tmp");
            assert!(
                is_temporary || whole.is_some_and(|(_, whole)| whole == content),
                "{name} is half-written"
            );
        }
        gone_on += usize::from(scratch.has_shards());
        scratch.prints(1 + random.below(4) as usize, &SOME);
        let mut found = scratch.results();
        // of a file that was about to be put in its place
        found.retain(|(name, _)| !name.ends_with(".coadjoint-tmp"));
        same(&found, &expected, "gone on with");
    }
    println!(
        "{kills} ranks killed, the job ended at most {slowest:?} later; {gone_on} times there were shards to go on with"
    );
    assert!(gone_on > 0);
}

/// One rank cannot write more than a little to a file.
#[test]
fn a_disk_that_is_full_for_one_rank_ends_the_job_and_it_goes_on() {
    if !is_open_mpi() {
        println!("not tested: MPICH does not start where files are limited, which its own memory is among");
        return;
    }
    let expected = alone(&SOME);
    let program = program();
    let program = program.to_str().expect("UTF-8");
    for (limited, kilobytes) in [(0, 2), (1, 1), (1, 4)] {
        let scratch = Scratch::new("full");
        let script = format!("trap '' XFSZ; ulimit -f {}; exec \"$0\" \"$@\"", 2 * kilobytes);
        let full = [&["-n", "1", "sh", "-c", &script, program], &SOME[..]].concat();
        let other = [&["-n", "1", program], &SOME[..]].concat();
        let both = if limited == 0 { [&full[..], &[":"], &other] } else { [&other[..], &[":"], &full] };
        let output = scratch.mpirun(&both.concat()).wait_with_output().expect("it ends");
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(4), "{message}");
        assert!(message.contains(&format!("error (rank {} of 2): cannot write", limited + 1)), "{message}");
        let is_result = |name: &str| {
            !name.contains(".blocks/") && [".csv", ".svg", ".png"].iter().any(|end| name.ends_with(end))
        };
        assert!(scratch.results().iter().all(|(name, _)| !is_result(name)));
        scratch.prints(3, &SOME);
        same(&scratch.results(), &expected, "with room");
    }
}

#[test]
fn what_is_wrong_is_said_once_and_is_the_exit_code() {
    let scratch = Scratch::new("wrong");
    for (arguments, code, expected) in [
        (&["ensemble", "heavy_tip"][..], 2, "did you mean `heavy_top`?"),
        (&["ensemble", "heavy_top", "--members", "none"], 2, "invalid value 'none'"),
        (&["ensemble", "heavy_top", "--spread", "inertia=300%"], 2, "not positive definite"),
        (&["ensemble", "heavy_top", "--shard", "1/2"], 2, "`--shard` is for jobs without MPI"),
    ] {
        let output = scratch.run(3, arguments);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {message}");
        assert!(message.contains(expected), "{arguments:?}: {message}");
        assert!(message.matches("error").count() <= 3, "{arguments:?}: {message}");
    }
    for arguments in [&["list"][..], &["--help"], &["--version"]] {
        let output = scratch.run(3, arguments);
        assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
        assert_eq!(
            text(&output.stdout)
                .matches(if arguments[0] == "list" { "free_body" } else { "two_bodies" })
                .count()
                .min(2),
            1
        );
    }
}
