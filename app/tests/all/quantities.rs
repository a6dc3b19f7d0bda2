//! Controls, and quantities of one's own, in all that is written.

use crate::program::Scratch;

const RUN: [&str; 12] = [
    "run",
    "driven_pendulum",
    "--step",
    "0.01",
    "--duration",
    "1",
    "--set",
    "motor=0.5",
    "--quantity",
    "L = 2 * momentum",
    "--quantity",
    "momentum_x * t",
];

#[test]
fn they_stand_in_tables_plots_and_pages() {
    let scratch = Scratch::new("own");
    scratch.prints(&[&RUN[..], &["--plot", "--html", "out/page.html"]].concat());
    let name = scratch.named("out", "driven_pendulum-", ".csv");
    let table = scratch.read(&name);
    let mut lines = table.lines();
    let columns = "time,angle_re,angle_im,momentum_x,motor_x,energy,power,L,momentum_x * t";
    assert_eq!(lines.next(), Some(columns));
    let mut count = 0;
    for line in lines {
        let row: Vec<f64> = line.split(',').map(|number| number.parse().expect("a number")).collect();
        let [time, _, _, momentum, motor, _, power, twice, product] = row[..] else { panic!("{line}") };
        assert_eq!((motor, twice, product), (0.5, 2.0 * momentum, momentum * time));
        assert!((power - 0.5 * momentum / 0.1).abs() < 1e-14, "{line}");
        count += 1;
    }
    assert_eq!(count, 101);
    let plot = scratch.read(&name.replace(".csv", ".svg"));
    for label in ["motor, N m", "power, W", ">L<", "momentum x * t"] {
        assert!(plot.contains(label), "{label}");
    }
    let page = scratch.read("out/page.html");
    for plot in ["\"name\":\"motor\"", "\"name\":\"power\"", "\"name\":\"L\""] {
        assert!(page.contains(plot), "{plot}");
    }
    // the run is made again with them, and on from a checkpoint
    scratch.prints(&["run", "--again", &name, "--out", "again"]);
    assert_eq!(scratch.read(&name.replace("out", "again")), table);
    scratch.prints(&[&RUN[..], &["--checkpoint", "run.ck", "--out", "kept"]].concat());
    assert_eq!(scratch.read(&name.replace("out", "kept")), table);
}

#[test]
fn their_distributions_are_drawn() {
    let scratch = Scratch::new("own-ensemble");
    let few = ["ensemble", "driven_pendulum", "--members", "5", "--duration", "0.1"];
    let object = scratch.object(&[&few[..], &["--quantity", "height, m = -angle.cos_angle()"]].concat());
    let mean = object["end"]["height"]["mean"].as_f64().expect("a number");
    assert!((mean + 1_f64.cos()).abs() < 0.3 && mean != -1_f64.cos(), "{mean}");
    let plot = scratch.read(&scratch.named("out", "driven_pendulum-ensemble-", ".svg"));
    assert!(plot.contains("height, m"));
    // the system's own are among those that are shown unasked
    assert!(scratch.object(&few)["end"]["power"]["mean"].is_number());
}

#[test]
fn a_table_drives_every_run_of_a_scan_and_leaves_no_control_to_others() {
    let scratch = Scratch::new("driven-scan");
    scratch.write("motor.csv", b"time,motor_x\n0,0.3\n1,-0.2\n");
    let run = ["run", "driven_pendulum", "--duration", "1", "--step", "0.01"];
    let driven = [&run[..], &["--input", "motor.csv"]].concat();
    let table = scratch.prints(&[&driven[..], &["--out", "-"]].concat());
    let last = table.lines().last().expect("rows").split(',').map(|number| number.parse().expect("a number"));
    let last: Vec<f64> = last.collect();
    for scan in ["step=0.02,0.01", "weight=2,3"] {
        let runs = scratch.object(&[&driven[..], &["--scan", scan]].concat());
        let end = &runs["runs"][1]["end"];
        assert_eq!(
            serde_json::json!([end["angle"][0], end["angle"][1], end["momentum"]]),
            serde_json::json!(last[1..4])
        );
    }
    for more in [&["--set", "motor=0.5"][..], &["--scan", "motor=0,1"]] {
        let error = scratch.fails(2, &[&driven[..], more].concat());
        assert!(error.contains("is a column of motor.csv, and cannot be set too"), "{error}");
    }
}

#[test]
fn an_error_as_large_as_the_energy_is_not_called_bounded() {
    let scratch = Scratch::new("lost");
    let said = |more: &[&str]| {
        let run = ["run", "driven_pendulum", "--set", "motor=0", "--set", "momentum=0", "--force"];
        scratch.prints(&[&run[..], more].concat()).split_whitespace().collect::<Vec<_>>().join(" ")
    };
    let lost = said(&["--step", "0.8", "--duration", "500"]);
    assert!(lost.contains("energy: lost: its error is up to"), "{lost}");
    // from rest, where the energy is zero
    let kept = said(&["--step", "0.01", "--set", "angle=1.5707963267948966"]);
    assert!(kept.contains("energy: bounded: its error stays from"), "{kept}");
}

#[test]
fn a_run_ends_where_a_condition_holds() {
    let scratch = Scratch::new("until");
    let run = ["run", "heavy_top", "--step", "0.01", "--duration", "20", "--every", "7", "--plot"];
    let said = scratch.says(&[&run[..], &["--until", "gamma_z < 0.5 && t > 0"]].concat());
    let name = scratch.named("out", "heavy_top-", ".csv");
    let table = scratch.read(&name);
    let column = table.split(',').position(|name| name == "gamma_z").expect("a column");
    let value = |line: &str| line.split(',').nth(column).and_then(|text| text.parse::<f64>().ok());
    let heights: Vec<f64> = table.lines().skip(1).map(|line| value(line).expect("a number")).collect();
    let (last, before) = heights.split_last().expect("rows");
    assert!((last - 0.5).abs() < 1e-14 && before.iter().all(|height| *height >= 0.5), "{heights:?}");
    // the moment within a step
    let told =
        said.split("holds from ").nth(1).expect("a note").split_whitespace().collect::<Vec<_>>().join(" ");
    let (time, rest) = told.split_once(" s on, in step ").expect("a note");
    let time: f64 = time.parse().expect("a time");
    let step: f64 = rest.split(':').next().and_then(|step| step.parse().ok()).expect("a step");
    assert!((step - 1.0) * 0.01 < time && time < step * 0.01, "{time} in {step}");
    assert!(
        table.trim_end().lines().last().is_some_and(|row| row.starts_with(&format!("{time},"))),
        "{table}"
    );
    // the step before, it did not hold
    let all = ["run", "heavy_top", "--step", "0.01", "--duration", "20", "--out", "all"];
    scratch.prints(&all);
    let all = scratch.read(&scratch.named("all", "heavy_top-", ".csv"));
    let first = all.lines().skip(1).position(|line| value(line).is_some_and(|height| height < 0.5));
    assert_eq!(first.map(|first| first as f64), Some(step));
    // it is complete, and made again as it is
    let made = scratch.read(&name.replace(".csv", ".run.json"));
    assert!(made.contains("\"complete\"") && !made.contains("interrupted"), "{made}");
    scratch.prints(&["run", "--again", &name, "--out", "again"]);
    assert_eq!(scratch.read(&name.replace("out", "again")), table);
    // what is told of it is of the steps that it took
    let told = scratch.object(&["run", "heavy_top", "--until", "t >= 0.055", "--out", "told"]);
    let beside: serde_json::Value =
        serde_json::from_str(&scratch.read(&scratch.named("told", "heavy_top-", ".run.json"))).expect("JSON");
    assert_eq!((&told["steps"], &told["duration"], &told["time"]), (&6.into(), &0.055.into(), &0.055.into()));
    assert_eq!(told["error_estimate"]["time"], 0.05);
    assert_eq!(beside["ended"], serde_json::json!({ "steps": 6, "time": 0.055 }));
    let start = scratch.object(&["run", "heavy_top", "--until", "gamma_z > 0.5", "--out", "start"]);
    assert_eq!((&start["steps"], &start["time"]), (&0.into(), &0.0.into()));
    let never = scratch.says(&["run", "heavy_top", "--duration", "1", "--until", "t > 2", "--out", "never"]);
    assert!(never.contains("holds after none of 100 steps"), "{never}");
}

#[test]
fn events_are_told_with_their_moments() {
    let scratch = Scratch::new("events");
    let run = ["run", "driven_pendulum", "--step", "0.01", "--duration", "5", "--set", "motor=0"];
    let events =
        ["--event", "down = angle.angle(), rising", "--event", "turn = momentum.x", "--until", "t > 4.1234"];
    let said = scratch.says(&[&run[..], &events[..]].concat());
    let name = scratch.named("out", "driven_pendulum-", ".events.csv");
    let table = scratch.read(&name);
    let mut lines = table.lines();
    assert_eq!(lines.next(), Some("event,crossing,time,angle_re,angle_im,momentum_x,motor_x,energy,power"));
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    let number = |row: &[&str], k: usize| row[k].parse::<f64>().expect("a number");
    assert!(rows.iter().any(|row| row[0] == "down") && rows.iter().any(|row| row[1] == "falling"), "{table}");
    assert!(rows.windows(2).all(|pair| number(&pair[0], 2) < number(&pair[1], 2)), "{table}");
    for row in &rows {
        let zero = if row[0] == "down" { number(row, 4) } else { number(row, 5) };
        assert!(zero.abs() < 1e-14, "{row:?}");
        assert!(row[0] != "down" || row[1] == "rising", "{row:?}");
        assert!(said.split_whitespace().any(|word| word == row[2]), "{} in {said}", row[2]);
    }
    // made again, and for programs
    scratch.prints(&["run", "--again", &name.replace(".events.csv", ".run.json"), "--out", "again"]);
    assert_eq!(scratch.read(&name.replace("out", "again")), table);
    let object = scratch.object(&[&run[..], &events[..], &["--out", "told"]].concat());
    assert_eq!(object["events"].as_array().map(Vec::len), Some(rows.len()));
    assert_eq!(object["events"][0]["time"].as_f64(), Some(number(&rows[0], 2)));
    // and with a checkpoint
    scratch.prints(&[&run[..], &events[..], &["--checkpoint", "run.ck", "--out", "kept"]].concat());
    assert_eq!(scratch.read(&name.replace("out", "kept")), table);
    let meant = "`driven_pendulum` has no event `pases`; did you mean `passes`? (events: `passes`;";
    for (event, reason) in [
        ("angle", "a number is asked for"),
        ("up = momntum.x, rising", "did you mean `momentum`"),
        ("up = momentum.x, upwards", "unexpected token"),
        ("pases", meant),
        ("pases, falling", meant),
        ("zenith", "there is no quantity `zenith` of `driven_pendulum`"),
        ("zenith", "and their components); events: `passes`"),
    ] {
        let refused = scratch.fails(2, &["run", "driven_pendulum", "--event", event]);
        let refused = refused.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(refused.contains(reason), "{event}: {refused}");
    }
    let twice =
        scratch.fails(2, &["run", "driven_pendulum", "--event", "e = t", "--event", "e = momentum.x"]);
    assert!(twice.contains("there are two events `e`"), "{twice}");
}

#[test]
fn states_are_written_at_times_of_ones_own() {
    let scratch = Scratch::new("times");
    let run = ["run", "heavy_top", "--step", "0.04", "--duration", "0.5"];
    let column = |table: &str, place: usize| -> Vec<f64> {
        table.lines().skip(1).filter_map(|line| line.split(',').nth(place)?.parse().ok()).collect()
    };
    scratch.prints(
        &[&run[..], &["--at", "0,0.1,0.25,0.5", "--plot", "--html", "at/page.html", "--out", "at"]].concat(),
    );
    let name = scratch.named("at", "heavy_top-", ".csv");
    let table = scratch.read(&name);
    assert_eq!(column(&table, 0), [0.0, 0.1, 0.25, 0.5]);
    scratch.prints(&["run", "--again", &name, "--out", "again"]);
    assert_eq!(scratch.read(&name.replace("at/", "again/")), table);
    scratch.prints(
        &[&run[..], &["--every-seconds", "0.1", "--checkpoint", "run.ck", "--out", "every"]].concat(),
    );
    let every = scratch.read(&scratch.named("every", "heavy_top-", ".csv"));
    assert_eq!(column(&every, 0), [0.0, 0.1, 0.2, 0.30000000000000004, 0.4, 0.5]);
    // the end is one of the times where it is that but for rounding
    for (of, step, duration, times, expected) in [
        ("thirds", "0.03", "0.3", ["--every-seconds", "0.1"], &[0.0, 0.1, 0.2, 0.3][..]),
        (
            "sevenths",
            "0.07",
            "0.35",
            ["--every-seconds", "0.07"],
            &[0.0, 0.07, 0.14, 0.21000000000000002, 0.28, 0.35],
        ),
        ("beyond", "0.05", "1", ["--at", "0.5,1.0000000000000002"], &[0.5, 1.0]),
    ] {
        let run = ["run", "heavy_top", "--step", step, "--duration", duration, "--out", of];
        scratch.prints(&[&run[..], &times].concat());
        let table = scratch.read(&scratch.named(of, "heavy_top-", ".csv"));
        let (times, expected) = (column(&table, 0), expected.to_vec());
        assert!(times.len() == expected.len(), "{of}: {times:?}");
        assert!(times.iter().zip(&expected).all(|(a, b)| (a - b).abs() <= 1e-16), "{of}: {times:?}");
    }
    // the end is that of the run without
    scratch.prints(&[&run[..], &["--out", "steps"]].concat());
    let steps = scratch.read(&scratch.named("steps", "heavy_top-", ".csv"));
    assert_eq!(table.lines().last(), steps.lines().last());
    assert_eq!(table.lines().nth(1), steps.lines().nth(1));
    // back in time
    let back = [
        "run",
        "heavy_top",
        "--step",
        "-0.04",
        "--duration",
        "0.5",
        "--every-seconds",
        "0.25",
        "--out",
        "back",
    ];
    scratch.prints(&back);
    assert_eq!(column(&scratch.read(&scratch.named("back", "heavy_top-", ".csv")), 0), [0.0, -0.25, -0.5]);
    for (arguments, reason) in [
        (["--at", "0.1,0.6"], "the run goes from 0 to 0.5 s"),
        (["--at", "0.2,0.1"], "times stand in the order of the run"),
        (["--at=-0.1", "--quiet"], "the run goes from 0 to 0.5 s"),
        (["--every-seconds", "0"], "must be finite and positive"),
        (["--every-seconds", "1e-300"], "are too many times"),
    ] {
        let refused = scratch.fails(2, &[&run[..], &arguments[..]].concat());
        assert!(refused.contains(reason), "{refused}");
    }
}

#[test]
fn what_is_none_is_told_with_what_there_is() {
    let scratch = Scratch::new("own-mistakes");
    for (quantity, reason) in [
        (
            "momentm",
            "did you mean `momentum`? (t, energy, inertia, weight, angle, momentum, motor, velocity, power, and their components)",
        ),
        ("momentum_x", "is a column already"),
        ("power = t", "is a column already"),
        ("sin(angle)", "`sin` is a function of a number"),
    ] {
        let error = scratch.fails(2, &["run", "driven_pendulum", "--quantity", quantity]);
        assert!(error.contains(reason), "{quantity}: {error}");
    }
}

/// What a run is, in a file and on the command line: the same bytes. The file's input is found beside it.
#[test]
fn options_are_keys_of_a_file() {
    let scratch = Scratch::new("keys");
    scratch.write("there/motor.csv", b"time,motor_x\n0,0.1\n1,-0.2\n2,0.3\n");
    scratch.write(
        "there/run.toml",
        b"system = \"driven_pendulum\"\n[run]\nduration = 1.0\nstep = 0.01\ntolerance = 1e-9\nevery_seconds = 0.125\n\
          quantity = [\"turned, rad = angle.angle()\"]\nevent = [\"passes\"]\ninput = \"motor.csv\"\ninterpolation = \"linear\"\n\
          plot = true\nwatch_every_step = true\n",
    );
    let line = "run driven_pendulum --duration 1 --step 0.01 --tolerance 1e-9 --every-seconds 0.125 --event passes \
                --input there/motor.csv --interpolation linear --plot --watch-every-step --quantity";
    let line: Vec<&str> = line.split(' ').chain(["turned, rad = angle.angle()", "--out", "line"]).collect();
    scratch.prints(&line);
    scratch.prints(&["run", "--config", "there/run.toml", "--out", "file"]);
    let files = scratch.files("line");
    assert_eq!(scratch.files("file"), files);
    for ends in [".csv", ".events.csv", ".svg"] {
        let file = files.iter().find(|file| file.ends_with(ends)).expect(ends);
        assert_eq!(scratch.read(&format!("file/{file}")), scratch.read(&format!("line/{file}")), "{file}");
    }
    let table = scratch.read(&scratch.named("file", "driven_pendulum-", ".events.csv"));
    assert!(table.starts_with("event,crossing,time,") && table.contains("passes,"), "{table}");
    // options come in the place of keys
    scratch.prints(&[
        "run",
        "--config",
        "there/run.toml",
        "--quantity",
        "fast = momentum.x",
        "--out",
        "both",
    ]);
    let both = scratch.read(&scratch.named("both", "driven_pendulum-", ".events.csv"));
    assert!(both.lines().next().is_some_and(|header| header.ends_with("fast")), "{both}");
}

/// Columns may be chosen in a file; those of the command line come in their place.
#[test]
fn columns_of_a_file() {
    let scratch = Scratch::new("columns");
    scratch.write(
        "run.toml",
        b"system = \"heavy_top\"\n[run]\nduration = 0.1\ncolumns = [\"velocity\", \"mrp\"]\n",
    );
    let table = |arguments: &[&str], out: &str| {
        scratch.prints(&[&["run"], arguments, &["--out", out]].concat());
        scratch.read(&scratch.named(out, "heavy_top-", ".csv"))
    };
    let of_file = table(&["--config", "run.toml"], "file");
    assert!(
        of_file.starts_with("time,") && of_file.contains("velocity_x") && of_file.contains("attitude_mrp_x")
    );
    let of_line = |columns| ["heavy_top", "--duration", "0.1", "--columns", columns];
    assert_eq!(of_file, table(&of_line("velocity,mrp"), "line"));
    let both = table(&["--config", "run.toml", "--columns", "euler"], "both");
    assert_eq!(both, table(&of_line("euler"), "euler"));
    scratch.write("run.toml", b"system = \"heavy_top\"\n[run]\ncolumns = [\"speed\"]\n");
    let message = scratch.fails(2, &["run", "--config", "run.toml"]);
    assert!(message.contains("unknown variant `speed`, expected one of `velocity`"), "{message}");
}
