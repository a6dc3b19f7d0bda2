//! A campaign against files: pairs of runs on one checkpoint, kills at random moments, flipped bits, full disks. After each there is no wrong
//! result with exit code 0, no half-written file, and no file of others has changed.
//!
//! `COADJOINT_CAMPAIGN=1 cargo test -p coadjoint-app --all-features --test all reliability` is the whole of it; without, the same in small.
//! `COADJOINT_SEED` chooses other moments and bits.

use std::fs;
use std::path::PathBuf;
use std::process::{Child, Command, Output, Stdio};
use std::time::Duration;

use serde_json::Value;

use crate::program::{Scratch, text};

/// How often each test tries: in small, and in the campaign.
pub(crate) fn times(small: usize, campaign: usize) -> usize {
    if std::env::var_os("COADJOINT_CAMPAIGN").is_some() { campaign } else { small }
}

/// Random numbers: SplitMix64.
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(test: u64) -> Self {
        let seed = std::env::var("COADJOINT_SEED").ok().and_then(|seed| seed.parse().ok()).unwrap_or(1_u64);
        Self(seed << 8 | test)
    }

    pub(crate) fn below(&mut self, bound: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = self.0;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((bits ^ (bits >> 31)) % bound as u64) as usize
    }
}

/// A run of about half a second, which saves its checkpoint all the time.
const LONG: [&str; 9] = ["run", "heavy_top", "--duration", "600", "--step", "0.01", "--every", "5", "--set"];
const CHECKPOINT: [&str; 4] = ["--checkpoint", "run.ck", "--save-every", "0.005"];

fn long<'a>(momentum: &'a str, rest: &[&'a str]) -> Vec<&'a str> {
    [&LONG[..], &[momentum], rest].concat()
}

/// Files of others, beside those of the runs and under names like theirs.
pub(crate) struct Foreign(Vec<(PathBuf, Vec<u8>)>);

impl Foreign {
    pub(crate) fn plant(scratch: &Scratch) -> Self {
        let names = [
            "out/data.csv",
            "out/.x.coadjoint-tmp",
            "run.ck.old",
            "run.ck.rows.bak",
            "notes",
            "out/heavy_top-cayley.csv",
        ];
        let plant = |name: &str| {
            let content = format!("of others: {name}").into_bytes();
            scratch.write(name, &content);
            (scratch.path(name), content)
        };
        Self(names.into_iter().map(plant).collect())
    }

    pub(crate) fn check(&self) {
        for (path, content) in &self.0 {
            assert!(fs::read(path).is_ok_and(|now| now == *content), "{} changed", path.display());
        }
    }
}

/// The trajectory of a run that nobody disturbed, and its name.
fn undisturbed(momentum: &str) -> (String, Vec<u8>) {
    let scratch = Scratch::new("undisturbed");
    scratch.prints(&long(momentum, &[]));
    let path = scratch.named("out", "heavy_top-", ".csv");
    let name = path.strip_prefix("out/").expect("in there").to_owned();
    (name, scratch.bytes(&path))
}

pub(crate) fn signal(child: &Child, name: &str) {
    let sent = Command::new("kill").args([name, &child.id().to_string()]).status();
    assert!(sent.expect("kill").success());
}

/// Starts a run and kills it when so many bytes of its rows are saved; false if it was over before.
fn is_killed(scratch: &Scratch, momentum: &str, bytes: u64) -> bool {
    let mut child = scratch.command(&long(momentum, &CHECKPOINT)).spawn().expect("it starts");
    let is_saved = || fs::metadata(scratch.path("run.ck.rows")).is_ok_and(|file| file.len() >= bytes);
    while child.try_wait().expect("waits").is_none() {
        if is_saved() {
            signal(&child, "-KILL");
            break;
        }
        std::thread::sleep(Duration::from_millis(1));
    }
    let output = child.wait_with_output().expect("it ends");
    assert!(output.status.code().is_none_or(|code| code == 0), "{}", text(&output.stderr));
    scratch.path("run.ck").exists()
}

/// The trajectory is the whole one, or it is its beginning and is not said to be whole; or there is none.
fn is_whole_or_honest(scratch: &Scratch, name: &str, whole: &[u8]) -> bool {
    let Ok(found) = fs::read(scratch.path(&format!("out/{name}"))) else { return false };
    if found == whole {
        return true;
    }
    let run = scratch.read(&format!("out/{}.run.json", name.strip_suffix(".csv").expect("a table")));
    let run: Value = serde_json::from_str(&run).expect("JSON");
    assert_ne!(run["files"][name], "complete", "a file that is not whole is said to be");
    // the last row of an interrupted run may be of a step that is written anyway
    let (found, whole) = (text(&found), text(whole));
    let (rows, _) = found.trim_end().rsplit_once('\n').expect("lines");
    assert!(whole.starts_with(rows), "an interrupted file has other rows");
    false
}

#[test]
fn two_runs_do_not_share_a_checkpoint() {
    let momenta = ["momentum=0.01,1,0.01", "momentum=0.02,1,0.01"];
    let whole = momenta.map(undisturbed);
    let (mut random, mut refused) = (Random::new(1), 0);
    for pair in 0..times(4, 24) {
        let begin = || {
            let scratch = Scratch::new("pair");
            let foreign = Foreign::plant(&scratch);
            (scratch, foreign)
        };
        let (mut scratch, mut foreign) = begin();
        let run = |momentum| long(momentum, &CHECKPOINT);
        let resume = || vec!["resume", "run.ck"];
        // the same run twice, two different ones, a run that is resumed while it goes on, and one that is resumed twice
        let both = match pair % 4 {
            0 => [run(momenta[0]), run(momenta[0])],
            1 => [run(momenta[0]), run(momenta[1])],
            2 => [run(momenta[0]), resume()],
            _ => {
                while !is_killed(&scratch, momenta[0], random.below(100_000) as u64) {
                    (scratch, foreign) = begin();
                }
                [resume(), resume()]
            }
        };
        let children = both.map(|arguments| {
            let child = scratch.command(&arguments).spawn().expect("it starts");
            std::thread::sleep(Duration::from_millis(random.below(30) as u64));
            child
        });
        let before = refused;
        for (i, child) in children.into_iter().enumerate() {
            let output = child.wait_with_output().expect("it ends");
            let message = text(&output.stderr);
            match output.status.code() {
                Some(0) => {
                    let (name, whole) = &whole[usize::from(pair % 4 == 1 && i == 1)];
                    assert!(
                        scratch.bytes(&format!("out/{name}")) == *whole,
                        "pair {pair}: wrong, with exit code 0"
                    );
                }
                Some(2) => {
                    let expected = ["in use by another run", "exists already", "cannot read run.ck"];
                    assert!(expected.iter().any(|part| message.contains(part)), "pair {pair}: {message}");
                    refused += 1;
                }
                code => panic!("pair {pair}: {code:?} {message}"),
            }
        }
        foreign.check();
        assert!(refused < before + 2, "pair {pair}: neither ran");
        assert!(
            scratch
                .files(".")
                .iter()
                .all(|name| !name.starts_with("run.ck.r") && name != "run.ck" || name == "run.ck.rows.bak")
        );
    }
    assert!(refused > 0, "no two ran at the same time");
}

/// Chains of runs that are killed and resumed until they are complete.
#[test]
fn runs_that_are_killed_go_on_to_the_same_bytes() {
    let momentum = "momentum=0.01,1,0.01";
    let (name, whole) = undisturbed(momentum);
    let mut random = Random::new(2);
    let (mut kills, mut resumed, mut in_the_midst) = (0, 0, 0);
    let enough = times(12, 200);
    // until enough of them came when there was something to resume, which nobody can promise of a single one
    while kills < enough || resumed.min(in_the_midst) < enough / 4 {
        assert!(kills < 50 * enough, "{kills} kills, {resumed} resumed, {in_the_midst} in the midst");
        let scratch = Scratch::new("killed");
        let foreign = Foreign::plant(&scratch);
        let mut left = 4;
        loop {
            let go_on = scratch.path("run.ck").exists();
            let mut child = match go_on {
                true => scratch.command(&["resume", "run.ck"]).spawn().expect("it starts"),
                false => scratch.command(&long(momentum, &CHECKPOINT)).spawn().expect("it starts"),
            };
            resumed += usize::from(go_on);
            if left > 0 {
                wait_for_a_moment(&scratch, &mut child, &name, &mut random);
                left -= 1;
                if child.try_wait().expect("waits").is_none() {
                    signal(&child, ["-KILL", "-TERM", "-HUP"][random.below(8).saturating_sub(5)]);
                    kills += 1;
                }
            }
            let output = child.wait_with_output().expect("it ends");
            in_the_midst += usize::from(output.status.code() != Some(0));
            check_end(&scratch, &output, &name, &whole);
            foreign.check();
            if output.status.success() {
                break;
            }
            // killed between the last file and the removal of the journal, or between checkpoint and journal
            if !scratch.path("run.ck").exists() {
                let _ = fs::remove_file(scratch.path("run.ck.rows"));
            }
        }
        let rest: Vec<String> =
            scratch.files(".").into_iter().filter(|name| name.starts_with("run.ck")).collect();
        assert!(
            rest.iter().all(|name| ["run.ck.old", "run.ck.rows.bak"].contains(&name.as_str())),
            "{rest:?}"
        );
    }
    println!("{kills} kills, {in_the_midst} in the midst of a run, {resumed} runs resumed");
}

/// Times that steps do not lead to, some that they do, and events.
#[test]
fn times_and_events_go_on_to_the_same_bytes() {
    let run = ["run", "heavy_top", "--duration", "400", "--step", "0.02", "--every-seconds", "0.05"];
    let events =
        ["--event", "up = gamma_z - 0.5, rising", "--event", "gamma_x", "--plot", "--html", "out/page.html"];
    let (whole, scratch) = (Scratch::new("whole-times"), Scratch::new("killed-times"));
    whole.prints(&[&run[..], &events[..]].concat());
    let (mut begun, mut resumed) = (false, 0);
    for bytes in (0..).map(|k| 200_000 * k) {
        let arguments = match begun {
            true => vec!["resume", "run.ck"],
            false => [&run[..], &events[..], &CHECKPOINT[..]].concat(),
        };
        resumed += usize::from(begun);
        let mut child = scratch.command(&arguments).spawn().expect("it starts");
        let is_saved = || fs::metadata(scratch.path("run.ck.rows")).is_ok_and(|file| file.len() >= bytes);
        while child.try_wait().expect("waits").is_none() {
            if is_saved() {
                signal(&child, ["-KILL", "-TERM"][usize::from(bytes % 400_000 == 0)]);
                break;
            }
            std::thread::sleep(Duration::from_micros(100));
        }
        if child.wait().expect("it ends").success() {
            break;
        }
        begun = scratch.path("run.ck").exists();
        if !begun {
            let _ = fs::remove_file(scratch.path("run.ck.rows"));
        }
    }
    assert!(resumed > 1, "{resumed}");
    for (begins, ends) in
        [("heavy_top-", ".events.csv"), ("heavy_top-", ".csv"), ("heavy_top-", ".svg"), ("page", ".html")]
    {
        let names = |scratch: &Scratch| -> Vec<String> {
            let all = scratch.files("out").into_iter();
            let is_other = |name: &str| ends == ".csv" && name.ends_with(".events.csv");
            all.filter(|name| name.starts_with(begins) && name.ends_with(ends) && !is_other(name)).collect()
        };
        assert_eq!((names(&whole), names(&whole).len()), (names(&scratch), 1));
        let place = format!("out/{}", names(&whole)[0]);
        assert!(whole.bytes(&place) == scratch.bytes(&place), "{place}");
    }
}

/// Half of the kills come within milliseconds of the end of a run, when the trajectory's file is begun; the others when some of its rows are
/// saved, and a few at any moment.
fn wait_for_a_moment(scratch: &Scratch, child: &mut Child, name: &str, random: &mut Random) {
    let kind = random.below(8);
    if kind == 0 {
        return std::thread::sleep(Duration::from_micros(random.below(160_000) as u64));
    }
    // a tenth more than all
    let rows = random.below(2_600_000) as u64;
    let is_due = || match kind < 4 {
        true => fs::metadata(scratch.path("run.ck.rows")).is_ok_and(|file| file.len() >= rows),
        false => scratch.files("out").iter().any(|file| file.starts_with(&format!(".{name}."))),
    };
    while !is_due() && child.try_wait().expect("waits").is_none() {
        std::thread::sleep(Duration::from_micros(50));
    }
    std::thread::sleep(Duration::from_micros(random.below(12_000) as u64));
}

fn check_end(scratch: &Scratch, output: &Output, name: &str, whole: &[u8]) {
    use std::os::unix::process::ExitStatusExt;
    let message = text(&output.stderr);
    let is_whole = is_whole_or_honest(scratch, name, whole);
    match (output.status.code(), output.status.signal()) {
        (Some(0), _) => assert!(is_whole, "exit code 0, and not the whole run"),
        (Some(129 | 143), _) => {}
        // by SIGKILL; by the others before they are listened to
        (None, Some(9 | 15 | 1)) => {}
        status => panic!("{status:?}: {message}"),
    }
}

#[test]
fn flipped_bits_are_refused_or_of_no_effect() {
    let momentum = "momentum=0.01,1,0.01";
    let (name, whole) = undisturbed(momentum);
    let mut interrupted = Scratch::new("to-flip");
    while !is_killed(&interrupted, momentum, 300_000) {
        interrupted = Scratch::new("to-flip");
    }
    let mut random = Random::new(3);
    for file in ["run.ck", "run.ck.rows"] {
        let (mut refused, mut harmless) = (0, 0);
        for _ in 0..times(15, 500) {
            let scratch = Scratch::new("flipped");
            for name in ["run.ck", "run.ck.rows"] {
                fs::copy(interrupted.path(name), scratch.path(name)).expect("copied");
            }
            let foreign = Foreign::plant(&scratch);
            let mut bytes = scratch.bytes(file);
            let bit = random.below(8 * bytes.len());
            bytes[bit / 8] ^= 1 << (bit % 8);
            scratch.write(file, &bytes);
            let output = scratch.run(&["resume", "run.ck"]);
            match output.status.code() {
                Some(0) => {
                    assert!(
                        scratch.bytes(&format!("out/{name}")) == whole,
                        "bit {bit} of {file}: wrong, with exit code 0"
                    );
                    harmless += 1;
                }
                Some(2) => {
                    let message = text(&output.stderr);
                    assert!(
                        message.contains("run.ck") && !scratch.path(&format!("out/{name}")).exists(),
                        "{message}"
                    );
                    assert!(
                        scratch.bytes(file) == bytes,
                        "bit {bit} of {file}: what was refused has changed"
                    );
                    refused += 1;
                }
                code => panic!("bit {bit} of {file}: {code:?} {}", text(&output.stderr)),
            }
            foreign.check();
        }
        println!("{file}: {refused} flipped bits refused, {harmless} of no effect");
        assert!(refused > 0);
        // what comes after the checkpoint is of no effect
        assert!(file == "run.ck.rows" || harmless == 0);
    }
}

/// Disks that are full at each of many points: small ones, and files that cannot grow beyond a size.
#[test]
fn a_full_disk_leaves_nothing_half_written() {
    let page = ["--html", "page.html"];
    let arguments = long("momentum=0.01,1,0.01", &page);
    let whole = Scratch::new("undisturbed");
    whole.prints(&arguments);
    let name = whole.named("out", "heavy_top-", ".csv");
    let sizes = [&name[..], "page.html"].map(|name| whole.bytes(name).len());
    let mut random = Random::new(4);
    let points = times(4, 50);
    let (mut failed, mut resumed) = (0, 0);
    for point in 0..points {
        let scratch = Scratch::new("full");
        let foreign = Foreign::plant(&scratch);
        let with_checkpoint = if point % 2 == 1 { &CHECKPOINT[..] } else { &[] };
        let command = scratch.command(&[&arguments[..], with_checkpoint].concat());
        // now and then more than is needed
        let mut full = if point % 4 < 2 {
            let needed = sizes.iter().sum::<usize>() * (1 + with_checkpoint.len() / 4);
            on_a_disk(&command, random.below(needed * 11 / 10))
        } else {
            with_limited_files(&command, random.below(sizes[0] * 11 / 10))
        };
        let output = full.current_dir(&scratch.0).output().expect("it starts");
        let message = text(&output.stderr);
        match output.status.code() {
            Some(0) => {}
            Some(4) => {
                failed += 1;
                assert!(message.contains("error: cannot write"), "{message}");
            }
            code => panic!("{code:?} {message}"),
        }
        for name in [&name[..], "page.html"] {
            let found = fs::read(scratch.path(name)).ok();
            assert!(found.is_some() || !output.status.success(), "no {name}, with exit code 0");
            assert!(found.is_none_or(|found| found == whole.bytes(name)), "{name} is not whole");
        }
        let left = |directory: &str| {
            scratch.files(directory).into_iter().filter(|name| name.ends_with("tmp")).count()
        };
        assert_eq!((left("out"), left(".")), (1, 0), "only that of others");
        if scratch.path("run.ck").exists() {
            // with room, it goes on
            resumed += 1;
            scratch.prints(&["resume", "run.ck"]);
            for name in [&name[..], "page.html"] {
                assert!(scratch.bytes(name) == whole.bytes(name), "{name} is wrong after going on");
            }
        }
        foreign.check();
    }
    println!("{points} full disks: {failed} runs failed, {resumed} went on");
    assert!(failed > points / 2 && resumed > 0, "{failed} failed, {resumed} went on");
}

/// Runs a command in its directory, on a disk of this size: a file system in memory, which this process alone sees, so that what is in the directory
/// goes there and comes back. Where processes may not mount, only files are limited.
pub(crate) fn on_a_disk(command: &Command, size: usize) -> Command {
    let may_mount =
        Command::new("unshare").args(["-rm", "true"]).status().is_ok_and(|status| status.success());
    if !may_mount {
        return with_limited_files(command, size);
    }
    // what is there takes a page each
    let script = format!(
        "mkdir disk && mount -t tmpfs -o size={}k tmpfs disk && mv [!d]* disk/ && cd disk && {{ \"$0\" \"$@\"; code=$?; }}; \
         find . -mindepth 1 -maxdepth 1 -exec mv {{}} .. \\; && cd .. && umount disk && rmdir disk && exit $code",
        64 + size / 1024
    );
    let mut on_a_disk = Command::new("unshare");
    on_a_disk.args(["-rm", "sh", "-c", &script]).arg(command.get_program()).args(command.get_args());
    on_a_disk
}

/// Runs a command that cannot write more to a file.
fn with_limited_files(command: &Command, size: usize) -> Command {
    let script = format!("trap '' XFSZ; ulimit -f {}; exec \"$0\" \"$@\"", size / 512);
    let mut limited = Command::new("sh");
    limited.arg("-c").arg(script).arg(command.get_program()).args(command.get_args());
    limited
}

/// Waits until something is so; a minute is too long.
fn wait_for(otherwise: &str, mut is_so: impl FnMut() -> bool) {
    let start = std::time::Instant::now();
    while !is_so() {
        assert!(start.elapsed() < Duration::from_secs(60), "{otherwise}");
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Whether this process ignores SIGHUP, and with it all that it starts.
fn hangups_are_ignored() -> bool {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let ignored = ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    ignored.is_some_and(|mask| mask & 1 == 1)
}

/// Waits until a run writes.
fn wait_for_output(scratch: &Scratch) {
    wait_for("the run does not write", || scratch.files("out").iter().any(|name| name.ends_with("tmp")));
}

/// Without a checkpoint, what was computed until a signal is written, and says so; it does not take the place of all of it.
#[test]
fn signals_end_a_run_cleanly() {
    for (name, code) in [("-INT", 130), ("-TERM", 143), ("-HUP", 129)] {
        if name == "-HUP" && hangups_are_ignored() {
            // as under `nohup`: what the tests start ignores it too
            continue;
        }
        let scratch = Scratch::new("signal");
        let endless = ["run", "heavy_top", "--duration", "1e9", "--every", "1000", "--plot"];
        let end = |limit: &[&str]| {
            let child = scratch.command(&[&endless[..], limit].concat()).spawn().expect("it starts");
            wait_for_output(&scratch);
            std::thread::sleep(Duration::from_millis(100));
            signal(&child, name);
            child.wait_with_output().expect("it ends")
        };
        let output = end(&[]);
        assert_eq!(output.status.code(), Some(code), "{}", text(&output.stderr));
        let files = scratch.files("out");
        assert_eq!(files.len(), 4, "{files:?}");
        let csv = files.iter().find(|name| name.ends_with("csv")).expect("a table");
        let json = scratch.named("out", "heavy_top-", ".run.json");
        let run: Value = serde_json::from_str(&scratch.read(&json)).expect("JSON");
        for file in files.iter().filter(|name| !name.ends_with(".run.json")) {
            let status = run["files"][file.as_str()].as_str().expect("it is told");
            assert!(
                status.starts_with("interrupted after ") && status.ends_with(" of 100000000000 steps"),
                "{status}"
            );
        }
        // another time it comes as far as it comes
        assert_eq!(end(&[]).status.code(), Some(code));
        // but a whole run stays
        let mut run: Value = serde_json::from_str(&scratch.read(&json)).expect("JSON");
        run["files"][csv.as_str()] = "complete".into();
        scratch.write(&json, run.to_string().as_bytes());
        let whole = scratch.read(&format!("out/{csv}"));
        let output = end(&[]);
        assert_eq!(output.status.code(), Some(code));
        assert!(text(&output.stdout).contains("holds the whole run, and stays"), "{}", text(&output.stdout));
        assert_eq!(scratch.read(&format!("out/{csv}")), whole);
    }
}

/// Who asked that a run goes on when they log out is heard: it writes after the signal, until another ends it.
#[test]
#[cfg(target_os = "linux")]
fn a_run_under_nohup_goes_on() {
    let scratch = Scratch::new("nohup");
    let endless = ["run", "heavy_top", "--duration", "1e9", "--every", "10"];
    let command = scratch.command(&endless);
    let mut nohup = Command::new("sh");
    nohup.args(["-c", "trap '' HUP; exec \"$0\" \"$@\""]).arg(command.get_program()).args(command.get_args());
    let child = nohup
        .current_dir(&scratch.0)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("it starts");
    wait_for_output(&scratch);
    let written = || {
        let files = scratch.files("out");
        let of =
            |name: &String| fs::metadata(scratch.path(&format!("out/{name}"))).map_or(0, |file| file.len());
        files.iter().map(of).max().unwrap_or_default()
    };
    signal(&child, "-HUP");
    // more than is written at once
    let begun = written();
    wait_for("it does not go on", || written() > begun + 1_000_000);
    signal(&child, "-INT");
    let output = child.wait_with_output().expect("it ends");
    assert_eq!(output.status.code(), Some(130), "{}", text(&output.stderr));
}

/// The second signal ends the program at once, and no temporary file stays.
#[test]
fn a_second_signal_leaves_no_temporary_file() {
    let scratch = Scratch::new("second");
    // the output goes into a pipe that nobody reads: after the first signal the program waits for ever
    assert!(Command::new("mkfifo").arg(scratch.path("page")).status().expect("mkfifo").success());
    let mut child = scratch
        .command(&["run", "heavy_top", "--duration", "1e9", "--every", "1000", "--plot", "--html", "page"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("it starts");
    wait_for_output(&scratch);
    // two that come before the program looks are one
    let mut status = None;
    wait_for("signals do not end it", || {
        signal(&child, "-TERM");
        std::thread::sleep(Duration::from_millis(50));
        status = child.try_wait().expect("waits");
        status.is_some()
    });
    assert_eq!(status.and_then(|status| status.code()), Some(143));
    assert!(scratch.files("out").iter().all(|name| !name.ends_with("tmp")), "{:?}", scratch.files("out"));
}

/// What has nothing to finish ends at the first signal, and is not killed by it: what it began is removed.
#[test]
fn a_signal_ends_what_runs_nothing() {
    let scratch = Scratch::new("play");
    scratch.write("data.json", br#"{"format": "coadjoint page 1", "time": [0, 1], "runs": []}"#);
    // nobody reads the page: it cannot be written
    assert!(Command::new("mkfifo").arg(scratch.path("page")).status().expect("mkfifo").success());
    let mut child = scratch.command(&["play", "data.json", "--out", "page"]).spawn().expect("it starts");
    std::thread::sleep(Duration::from_millis(300));
    assert!(child.try_wait().expect("waits").is_none(), "it waits for a reader");
    signal(&child, "-INT");
    let output = child.wait_with_output().expect("it ends");
    assert_eq!(output.status.code(), Some(130), "{}", text(&output.stderr));
    assert_eq!(scratch.files("."), ["data.json", "page"]);
}
