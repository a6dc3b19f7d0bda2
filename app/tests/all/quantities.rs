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
    assert!(*last < 0.5 && before.iter().all(|height| *height >= 0.5), "{heights:?}");
    let steps = said.split("holds after ").nth(1).and_then(|rest| rest.split(' ').next()).expect("a note");
    // the step before, it did not hold
    let all = ["run", "heavy_top", "--step", "0.01", "--duration", "20", "--out", "all"];
    scratch.prints(&all);
    let all = scratch.read(&scratch.named("all", "heavy_top-", ".csv"));
    let first = all.lines().skip(1).position(|line| value(line).is_some_and(|height| height < 0.5));
    assert_eq!(first.map(|first| first.to_string()).as_deref(), Some(steps));
    // it is complete, and made again as it is
    let made = scratch.read(&name.replace(".csv", ".run.json"));
    assert!(made.contains("\"complete\"") && !made.contains("interrupted"), "{made}");
    scratch.prints(&["run", "--again", &name, "--out", "again"]);
    assert_eq!(scratch.read(&name.replace("out", "again")), table);
    // what is told of it is of the steps that it took
    let told = scratch.object(&["run", "heavy_top", "--until", "t >= 0.055", "--out", "told"]);
    let beside: serde_json::Value =
        serde_json::from_str(&scratch.read(&scratch.named("told", "heavy_top-", ".run.json"))).expect("JSON");
    assert_eq!((&told["steps"], &told["duration"], &told["time"]), (&6.into(), &0.06.into(), &0.06.into()));
    assert_eq!(told["error_estimate"]["time"], 0.06);
    assert_eq!(beside["ended"], serde_json::json!({ "steps": 6, "time": 0.06 }));
    let never = scratch.says(&["run", "heavy_top", "--duration", "1", "--until", "t > 2", "--out", "never"]);
    assert!(never.contains("holds after none of 100 steps"), "{never}");
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
