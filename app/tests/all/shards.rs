//! Ensembles in parts: shards, merged or gone on with, have the bytes of one process.

use std::fs;
use std::path::Path;

use coadjoint::ensemble::Statistics;
use f256::f256;

use crate::program::{Scratch, text};
use crate::reliability::{Foreign, Random, signal, times};

/// Members in 25 blocks, some of which fail.
const SOME: [&str; 14] = [
    "ensemble",
    "heavy_top",
    "--members",
    "500",
    "--duration",
    "1",
    "--every",
    "40",
    "--spread",
    "momentum=5%",
    "--spread",
    "attitude=3deg",
    "--block",
    "20",
];

fn some<'a>(rest: &[&'a str]) -> Vec<&'a str> {
    [&SOME[..], rest].concat()
}

/// All files of a directory and below, with their contents.
fn contents(directory: &Path) -> Vec<(String, Vec<u8>)> {
    let mut found = Vec::new();
    let mut directories = vec![directory.to_owned()];
    while let Some(inner) = directories.pop() {
        for entry in fs::read_dir(&inner).expect("readable") {
            let path = entry.expect("readable").path();
            match path.is_dir() {
                true => directories.push(path),
                false => {
                    let name = path.strip_prefix(directory).expect("in it").to_string_lossy().into_owned();
                    found.push((name, fs::read(&path).expect("readable")));
                }
            }
        }
    }
    found.sort();
    found
}

/// What one process writes.
fn whole(rest: &[&str]) -> Vec<(String, Vec<u8>)> {
    written(&some(rest))
}

fn written(command: &[&str]) -> Vec<(String, Vec<u8>)> {
    let scratch = Scratch::new("one");
    scratch.prints(command);
    let found = contents(&scratch.path("out"));
    assert!(found.iter().any(|(name, _)| name.ends_with(".csv")) && found.len() >= 4);
    found
}

fn same(found: &[(String, Vec<u8>)], expected: &[(String, Vec<u8>)], of: &str) {
    let names = |files: &[(String, Vec<u8>)]| files.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>();
    assert_eq!(names(found), names(expected), "{of}");
    for ((name, found), (_, expected)) in found.iter().zip(expected) {
        assert!(found == expected, "{of}: {name} differs");
    }
}

#[test]
fn shards_are_merged_to_the_bytes_of_one_process() {
    let rows = ["--rows", "all", "--format", "csv"];
    let expected = whole(&rows);
    assert_eq!(expected.iter().filter(|(name, _)| name.contains("members-")).count(), 25);
    // without rows, and in blocks of another size
    let without = written(&[&SOME[..12], &["--block", "500"]].concat());
    let is_of_rows = |name: &str| name.contains(".rows");
    let table: Vec<_> = expected.iter().filter(|(name, _)| !is_of_rows(name)).cloned().collect();
    same(&table, &without, "blocks of another size");
    for parts in ["7", "1", "3"] {
        let scratch = Scratch::new("shards");
        for k in 1..=parts.parse::<u64>().expect("a number") {
            let shard = format!("{k}/{parts}");
            let printed = scratch.prints(&some(&[&rows[..], &["--shard", &shard]].concat()));
            assert!(printed.contains(&format!("part {k} of {parts}")), "{printed}");
        }
        let blocks = scratch.named("out", "heavy_top-ensemble-", ".blocks");
        for _ in 0..2 {
            scratch.prints(&["merge", &blocks, "-o", "merged"]);
            same(&contents(&scratch.path("merged")), &expected, "merged");
        }
    }
}

/// What the guide has for Slurm, with Slurm's part done by hand: a smaller ensemble in three jobs, and the job after them.
#[cfg(unix)]
#[test]
fn the_guides_job_array_has_the_bytes_of_one_process() {
    use std::os::unix::fs::PermissionsExt as _;
    use std::process::Command;

    let guide = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../runtime/src/guide/clusters.md"));
    let guide = guide.expect("the guide is beside the app");
    let scripts: Vec<&str> =
        guide.split("```sh\n").skip(1).filter_map(|rest| rest.split("```").next()).collect();
    let with = |word: &str| *scripts.iter().find(|script| script.contains(word)).expect(word);
    let scratch = Scratch::new("slurm");
    for script in &scripts {
        let checked = Command::new("bash").args(["-n", "-c", script]).output().expect("bash starts");
        assert!(checked.status.success(), "{script}: {}", text(&checked.stderr));
    }
    let program = scratch.command(&[]).get_program().to_string_lossy().into_owned();
    for (name, script) in [
        ("srun", "exec \"$@\"".to_owned()),
        ("sbatch", "for wrapped; do :; done; exec sh -c \"$wrapped\"".to_owned()),
        ("coadjoint", format!("exec '{program}' \"$@\"")),
    ] {
        let name = format!("bin/{name}");
        scratch.write(&name, format!("#!/bin/sh\n{script}\n").as_bytes());
        let executable = fs::Permissions::from_mode(0o755);
        fs::set_permissions(scratch.path(&name), executable).expect("its own");
    }
    let run = |script: &str, task: &str| {
        let path = format!("{}:{}", scratch.path("bin").display(), std::env::var("PATH").unwrap_or_default());
        let mut bash = Command::new("bash");
        bash.args(["-euc", script]).current_dir(&scratch.0);
        bash.envs([("PATH", &path[..]), ("USER", "me"), ("SLURM_CPUS_PER_TASK", "1"), ("ARRAY", "7")]);
        let output = bash.env("SLURM_ARRAY_TASK_ID", task).output().expect("bash starts");
        assert!(output.status.success(), "{script}: {}", text(&output.stderr));
    };
    let asked = "ensemble heavy_top --members 1e8";
    let array = with("#SBATCH --array=1-100");
    assert!(array.contains(asked) && array.contains("$SLURM_ARRAY_TASK_ID/100"), "{array}");
    let array = array.replace(asked, &SOME.join(" ")).replace("/100", "/3").replace("/scratch", "scratch");
    for task in ["2", "3", "1"] {
        run(&array, task);
    }
    run(&with("coadjoint merge").replace("/scratch", "scratch"), "");
    same(&contents(&scratch.path("results")), &whole(&[]), "merged");
}

/// Parts of directories of their own, in any order.
#[test]
fn shards_of_several_directories_are_merged() {
    let rows = ["--rows", "end", "--format", "csv"];
    let expected = whole(&rows);
    let scratch = Scratch::new("apart");
    for k in ["3", "1", "2"] {
        let (shard, directory) = (format!("{k}/3"), format!("d{k}"));
        scratch.prints(&some(&[&rows[..], &["--shard", &shard, "--checkpoint", &directory]].concat()));
    }
    let refused = scratch.fails(2, &["merge", "d2", "d3"]);
    assert!(
        refused.contains("9 of 25 blocks are missing, the first one from member 0 on")
            || refused.contains("8 of 25"),
        "{refused}"
    );
    scratch.write("d1x/part-1-of-3.shard", &scratch.bytes("d1/part-1-of-3.shard"));
    let refused = scratch.fails(2, &["merge", "d1", "d1x", "d2", "d3"]);
    assert!(refused.contains("two shards both have block 0"), "{refused}");
    let last = "d1/part-1-of-3.shard";
    scratch.prints(&["merge", "d3", "d2/part-2-of-3.shard", last, "-o", "merged"]);
    same(&contents(&scratch.path("merged")), &expected, "merged");
}

/// Killed processes, in parts of varying number, and at last one process for all that is left.
#[test]
fn shards_that_are_killed_go_on_to_the_same_bytes() {
    let rows = ["--rows", "end", "--format", "csv", "--checkpoint", "blocks", "--save-every", "0"];
    let expected = whole(&rows);
    let mut random = Random::new(51);
    let (mut kills, mut gone_on) = (0, 0);
    for _ in 0..times(3, 25) {
        let scratch = Scratch::new("killed-shards");
        let foreign = Foreign::plant(&scratch);
        for parts in ["2", "3", ""] {
            let shards: Vec<String> = match parts.parse::<usize>() {
                Ok(count) => (1..=count).map(|k| format!("{k}/{parts}")).collect(),
                Err(_) => vec![String::new()],
            };
            for shard in &shards {
                let part = if shard.is_empty() { vec![] } else { vec!["--shard", shard] };
                let command = some(&[&rows[..], &part].concat());
                let mut child = scratch.command(&command).spawn().expect("it starts");
                std::thread::sleep(std::time::Duration::from_millis(random.below(250) as u64));
                if child.try_wait().expect("waits").is_none() {
                    signal(&child, ["-KILL", "-TERM"][random.below(2)]);
                    kills += 1;
                }
                let code = child.wait().expect("it ends").code();
                assert!(matches!(code, None | Some(0 | 143)), "{code:?}");
            }
            gone_on += usize::from(scratch.files("blocks").iter().any(|name| name.ends_with(".shard")));
        }
        scratch.prints(&some(&rows));
        let found: Vec<_> = contents(&scratch.path("out"))
            .into_iter()
            .filter(|(name, _)| name.starts_with("heavy_top-ensemble"))
            .collect();
        same(&found, &expected, "gone on with");
        assert!(!scratch.path("blocks").exists(), "{:?}", scratch.files("blocks"));
        foreign.check();
    }
    println!("{kills} kills, {gone_on} times something was there to go on with");
    assert!(kills > 0 && gone_on > 0);
}

/// Flipped bits of shards are told, shards of other ensembles refused, and no two processes have one shard.
#[test]
fn shards_that_are_not_what_they_were_are_refused() {
    let scratch = Scratch::new("flipped-shards");
    scratch.prints(&some(&["--shard", "1/1"]));
    let blocks = scratch.named("out", "heavy_top-ensemble-", ".blocks");
    let shard = format!("{blocks}/part-1-of-1.shard");
    let good = scratch.bytes(&shard);
    let mut random = Random::new(52);
    for _ in 0..times(10, 300) {
        let mut bytes = good.clone();
        let bit = random.below(8 * bytes.len());
        bytes[bit / 8] ^= 1 << (bit % 8);
        scratch.write(&shard, &bytes);
        let refused = scratch.fails(2, &["merge", &blocks, "-o", "merged"]);
        assert!(refused.contains("part-1-of-1.shard is "), "bit {bit}: {refused}");
    }
    assert!(!scratch.path("merged").exists() || scratch.files("merged").is_empty());
    scratch.write(&shard, &good);
    // of another seed
    let refused = scratch.fails(2, &some(&["--seed", "2", "--shard", "1/2", "--checkpoint", &blocks]));
    assert!(refused.contains("of a run with another") && refused.contains("ensemble"), "{refused}");
    let refused = scratch
        .fails(2, &[&SOME[..12], &["--block", "10", "--shard", "1/2", "--checkpoint", &blocks]].concat());
    assert!(refused.contains("blocks of another size"), "{refused}");
    // two at once
    let long = [
        "ensemble",
        "heavy_top",
        "--duration",
        "1e6",
        "--block",
        "9",
        "--shard",
        "1/2",
        "--checkpoint",
        "two",
    ];
    let mut child = scratch.command(&long).spawn().expect("it starts");
    while !scratch.path("two/part-1-of-2.lock").exists() {
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    std::thread::sleep(std::time::Duration::from_millis(50));
    let refused = scratch.fails(2, &long);
    assert!(refused.contains("in use by another run"), "{refused}");
    signal(&child, "-KILL");
    child.wait().expect("it ends");
    assert_eq!(scratch.fails(2, &["merge", "nowhere.shard"]).lines().count(), 1);
}

/// A disk that is full leaves what is whole, and with room it goes on.
#[test]
fn a_full_disk_leaves_shards_that_go_on() {
    let rows = ["--rows", "all", "--format", "csv", "--checkpoint", "blocks", "--save-every", "0"];
    let expected = whole(&rows);
    let all: usize = expected.iter().map(|(_, content)| content.len()).sum();
    let mut random = Random::new(53);
    let mut failed = 0;
    for _ in 0..times(3, 25) {
        let scratch = Scratch::new("full-shards");
        scratch.write("notes", b"of others");
        let command = scratch.command(&some(&rows));
        let mut full = crate::reliability::on_a_disk(&command, random.below(all));
        let output = full.current_dir(&scratch.0).output().expect("it starts");
        match output.status.code() {
            Some(0) => {}
            Some(4) => {
                failed += 1;
                assert!(text(&output.stderr).contains("cannot write"), "{}", text(&output.stderr));
            }
            code => panic!("{code:?} {}", text(&output.stderr)),
        }
        scratch.prints(&some(&rows));
        same(&contents(&scratch.path("out")), &expected, "with room");
    }
    assert!(failed > 0);
}

/// Sums with 71 digits, of numbers that are far apart, in parts of all sizes.
#[test]
fn moments_are_exact_and_quantiles_as_near_as_they_say() {
    let mut random = Random::new(54);
    let mut inexact = 0;
    for count in [1, 2, 3, 10, 1_000, 30_000] {
        for (exponents, offset) in [(1, 0.0), (20, 0.0), (20, 1e6), (60, 0.0)] {
            let mut values: Vec<f64> = (0..count)
                .map(|_| {
                    let size = random.below(1 << 52) as f64 * 2_f64.powi(random.below(exponents) as i32 - 52);
                    offset + if random.below(2) == 0 { size } else { -size }
                })
                .collect();
            // in parts that are merged from both ends
            let mut parts: Vec<Statistics> = Vec::new();
            let mut rest = &values[..];
            while !rest.is_empty() {
                let (part, after) = rest.split_at(1 + random.below(rest.len()).min(7_000));
                parts.push(Statistics::of(part.iter().copied()));
                rest = after;
            }
            let mut all = Statistics::default();
            while !parts.is_empty() {
                let part = parts.swap_remove(random.below(parts.len()));
                all.merge(&Statistics::from_bytes(&part.to_bytes()).expect("its own bytes"));
            }
            assert_eq!(all.to_bytes(), Statistics::of(values.iter().copied()).to_bytes(), "{count}");
            let spread = all.spread(0.0);
            let wide = |x: f64| f256::from(x);
            let n = wide(count as f64);
            let sum = values.iter().fold(f256::ZERO, |sum, x| sum + wide(*x));
            let squares = values.iter().fold(f256::ZERO, |sum, x| sum + wide(*x) * wide(*x));
            assert_eq!(spread.mean, narrow(sum / n), "mean of {count}");
            assert_eq!(
                spread.deviation,
                narrow((n * squares - sum * sum) / (n * n)).sqrt(),
                "deviation of {count}"
            );
            values.sort_by(f64::total_cmp);
            let error = all.relative_error();
            // with a digit more there were too many of them
            let finer = |x: &f64| x.to_bits() >> (error.log2() as i32 + 52).clamp(0, 52);
            let mut different: Vec<u64> = values.iter().map(finer).collect();
            different.dedup();
            assert!(error == 0.0 || different.len() > 4096, "{} of {count}", different.len());
            inexact += usize::from(error > 0.0);
            assert!(error < 0.02 && (count > 4096 || error == 0.0), "{error} of {count}");
            for (level, found) in [0.0, 0.05, 0.25, 0.5, 0.75, 0.95, 1.0].iter().zip(spread.quantiles) {
                let place = level * (count - 1) as f64;
                let (below, above) = (values[place as usize], values[(place as usize + 1).min(count - 1)]);
                let expected =
                    if place.fract() == 0.0 { below } else { below + place.fract() * (above - below) };
                let bound = error * below.abs().max(above.abs()) + 4.0 * f64::EPSILON * expected.abs();
                let bound = if *level == 0.0 || *level == 1.0 { 0.0 } else { bound };
                assert!((found - expected).abs() <= bound, "{level} of {count}: {found} {expected} {bound}");
            }
        }
    }
    assert!(inexact >= 3, "{inexact}");
}

/// The nearest double.
fn narrow(wide: f256) -> f64 {
    let near = wide.to_string().parse::<f64>();
    near.expect("digits")
}

/// Numbers at the ends of the doubles.
#[test]
fn sums_do_not_overflow() {
    let spread = |values: &[f64]| Statistics::of(values.iter().copied()).spread(0.0);
    let least = f64::from_bits(1);
    let found = spread(&[f64::MAX, f64::MAX, -f64::MAX, -f64::MAX, 5.0 * least]);
    assert_eq!(found.mean, least);
    assert_eq!(spread(&[f64::MAX, f64::MAX, f64::MAX]).mean, f64::MAX);
    assert_eq!(spread(&[f64::MAX, f64::MAX]).deviation, 0.0);
    assert_eq!(spread(&[f64::MAX, -f64::MAX]).deviation, f64::INFINITY);
    // halves round to even
    assert_eq!(spread(&[least, 0.0]).mean, 0.0);
    assert_eq!(spread(&[3.0 * least, 0.0]).mean, 2.0 * least);
    assert_eq!(spread(&[-least, -2.0 * least]).mean, -2.0 * least);
    assert_eq!(spread(&[1e-200, -1e-200]).deviation, 0.0);
    assert_eq!(spread(&[2_f64.powi(-530), -(2_f64.powi(-530))]).deviation, 2_f64.powi(-530));
    let found = spread(&[f64::INFINITY, 1.0, f64::NAN]);
    assert_eq!((found.members, found.mean), (2, f64::INFINITY));
    assert!(found.deviation.is_nan() && found.quantiles[6] == f64::INFINITY && found.quantiles[0] == 1.0);
    assert!(spread(&[f64::INFINITY, f64::NEG_INFINITY]).mean.is_nan());
    // in a bucket of its own, where digits are dropped
    let many = (0..5_000).map(f64::from);
    let many = many.chain([f64::INFINITY; 5_000]).chain([f64::NEG_INFINITY; 5_000]);
    let many = Statistics::of(many);
    let found = many.spread(0.0).quantiles;
    assert!(many.relative_error() > 0.0);
    assert_eq!((found[2], found[4]), (f64::NEG_INFINITY, f64::INFINITY));
    assert!((found[3] / 2_500.0 - 1.0).abs() < 2.0 * many.relative_error());
    let nothing = spread(&[f64::NAN]);
    assert!(nothing.members == 0 && nothing.mean.is_nan());
    // all exponents, with both signs
    let all: Vec<f64> =
        (0..2047_u64).flat_map(|e| (0..64).map(move |k| f64::from_bits(e << 52 | k << 46))).collect();
    let both = Statistics::of(all.iter().copied().chain(all.iter().map(|x| -x)).chain([f64::INFINITY]));
    assert_eq!(both.relative_error(), 0.5);
    let found = both.spread(0.0);
    assert_eq!((found.quantiles[0], found.quantiles[6]), (-all[all.len() - 1], f64::INFINITY));
    let bytes = both.to_bytes();
    assert_eq!(Statistics::from_bytes(&bytes).expect("its own").to_bytes(), bytes);
    for end in 0..bytes.len() {
        assert!(Statistics::from_bytes(&bytes[..end]).is_none(), "{end}");
    }
}

/// With the same seed a member is the same, however many there are and whatever they are run with.
#[test]
fn members_do_not_depend_on_each_other() {
    let scratch = Scratch::new("alone");
    let rows = |members: &str, block: &str, extra: &[&str]| -> Vec<String> {
        let few = [
            "ensemble",
            "heavy_top",
            "--duration",
            "1",
            "--rows",
            "end",
            "--format",
            "csv",
            "--members",
            members,
        ];
        scratch.prints(&[&few[..], &["--block", block, "--out", members], extra].concat());
        let found = contents(&scratch.path(members));
        let rows = found.iter().filter(|(name, _)| name.contains("members-"));
        let lines =
            rows.flat_map(|(_, rows)| text(rows).lines().skip(1).map(str::to_owned).collect::<Vec<_>>());
        lines.collect()
    };
    let (few, many) = (rows("3", "1", &[]), rows("40", "16", &[]));
    assert_eq!((few.len(), many.len()), (3, 40));
    assert_eq!(few, many[..3]);
    assert!(few[0].starts_with("0,1.0,") && few[2].starts_with("2,1.0,"), "{few:?}");
}
