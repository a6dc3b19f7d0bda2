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
    // the system's own are among those that are shown unasked
    assert!(scratch.object(&few)["end"]["power"]["mean"].is_number());
    let plot = scratch.read(&scratch.named("out", "driven_pendulum-ensemble-", ".svg"));
    assert!(plot.contains("height, m"));
}

#[test]
fn what_is_none_is_told_with_what_there_is() {
    let scratch = Scratch::new("own-mistakes");
    for (quantity, reason) in [
        (
            "momentm",
            "did you mean `momentum`? (t, energy, inertia, weight, angle, momentum, motor, power, and their components)",
        ),
        ("momentum_x", "is a column already"),
        ("power = t", "is a column already"),
        ("sin(angle)", "`sin` is a function of a number"),
    ] {
        let error = scratch.fails(2, &["run", "driven_pendulum", "--quantity", quantity]);
        assert!(error.contains(reason), "{quantity}: {error}");
    }
}
