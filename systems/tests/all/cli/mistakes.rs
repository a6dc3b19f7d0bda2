//! Bad input and output that cannot be written: a message, an exit code, and no file.

use std::fs;
use std::process::{Command, Stdio};

use super::{Scratch, text};

#[test]
fn nobody_reading_is_no_mistake() {
    let mut child = Command::new(env!("CARGO_BIN_EXE_coadjoint"))
        .args(["show", "heavy_top"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    drop(child.stdout.take());
    let output = child.wait_with_output().expect("it ends");
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert_eq!(text(&output.stderr), "");
}

/// Bad input gets a message, a non-zero exit code, and leaves no file.
#[test]
fn bad_input_is_refused_with_a_message() {
    let cases: &[(&[&str], i32, &str)] = &[
        (&["run", "heavy_tpo"], 2, "did you mean `heavy_top`?"),
        (&["run", "pendulum-on-the-moon"], 2, "there is no system `pendulum-on-the-moon`"),
        (&["show", "heavytop2"], 2, "did you mean `heavy_top`?"),
        (&["run"], 2, "no system: name one"),
        (&["rum", "heavy_top"], 2, "similar subcommand"),
        (&["run", "heavy_top", "--set", "wieght=2"], 2, "did you mean `weight`?"),
        (&["run", "heavy_top", "--set", "temperature=2"], 2, "parameters: inertia, weight, chi"),
        (&["run", "heavy_top", "--set", "weight"], 2, "has no `=`"),
        (&["run", "heavy_top", "--set", "chi=1,2"], 2, "takes 3 numbers separated by commas, got 2"),
        (&["run", "heavy_top", "--set", "weight=1,2,3"], 2, "takes one number, got 3"),
        (
            &["run", "spin_chain", "--set", "spins_momentum=1,2"],
            2,
            "takes 12 numbers separated by commas, got 2",
        ),
        (&["run", "heavy_top", "--set", "weight=heavy"], 2, "`heavy` is not a number"),
        (&["run", "heavy_top", "--set", "momentum=1,nan,1"], 2, "`momentum` must be finite"),
        (&["run", "heavy_top", "--set", "momentum_x=inf"], 2, "`momentum_x` must be finite"),
        (&["run", "heavy_top", "--set", "inertia=1,-10,100"], 2, "`inertia` is not positive definite"),
        (&["run", "heavy_top", "--set", "inertia_z=0"], 2, "`inertia` is not positive definite"),
        (&["run", "heavy_top", "--set", "attitude=0,0,0,0"], 2, "cannot be zero"),
        (&["run", "heavy_top", "--step", "0"], 2, "`--step` must be finite and not zero"),
        (&["run", "heavy_top", "--step", "NaN"], 2, "`--step` must be finite and not zero"),
        (&["run", "heavy_top", "--step", "small"], 2, "invalid value 'small'"),
        (&["run", "heavy_top", "--duration", "-5"], 2, "`--duration` must be finite and not negative"),
        (&["run", "heavy_top", "--duration", "inf"], 2, "`--duration` must be finite"),
        (&["run", "heavy_top", "--duration", "1e300"], 2, "too many"),
        (&["run", "heavy_top", "--every", "0"], 2, "0 is not in"),
        (&["run", "heavy_top", "--retraction", "euler"], 2, "possible values: exponential, cayley"),
        (
            &["run", "heavy_top", "--method", "leapfrog"],
            2,
            "possible values: standard, euler-a, euler-b, midpoint, verlet",
        ),
        (
            &["run", "heavy_top", "--method", "euler-a", "--order", "4"],
            2,
            "take one of standard, midpoint, verlet",
        ),
        (&["run", "heavy_top", "--method", "rk5"], 2, "similar value exists: 'rk4'"),
        (
            &["run", "heavy_top", "--method", "hamilton-jacobi=6"],
            2,
            "`hamilton-jacobi` takes no number; orders",
        ),
        (&["run", "heavy_top", "--method", "family=5/4"], 2, "`5/4` is not a fraction from 0 to 1"),
        (&["run", "heavy_top", "--method", "family=1/4"], 2, "`methods(…)` in its description asks for it"),
        (
            &["run", "heavy_top", "--method", "right-lift"],
            2,
            "which carries the momentum in space: something acts on it",
        ),
        (
            &["run", "free_rigid_body", "--method", "right-lift", "--retraction", "second-kind"],
            2,
            "no steps of the method right-lift with the retraction second-kind",
        ),
        (
            &["run", "kepler", "--retraction", "second-kind"],
            2,
            "of the scheme `SecondKind` was generated for `Kepler`; `retractions(…)` in its description asks for it",
        ),
        (&["run", "heavy_top", "--method", "rk4", "--order", "4"], 2, "method rk4 has its own order, 4"),
        (&["run", "heavy_top", "--method", "rkmk4", "--order", "2"], 2, "method rkmk4 has its own order, 4"),
        (
            &["run", "heavy_top", "--method", "rk4", "--retraction", "exp"],
            2,
            "`--retraction` is for methods of ours",
        ),
        (&["run", "heavy_top", "--method", "tangent-lift", "--order", "4"], 2, "take one of standard"),
        (&["run", "free_rigid_body", "--method", "hamilton-jacobi"], 2, "takes an order above 2"),
        (
            &["run", "kepler", "--method", "hamilton-jacobi", "--order", "6"],
            2,
            "HamiltonJacobi<Exponential, 6>",
        ),
        (&["run", "--config", "rk4.toml", "--order", "6"], 2, "method rk4 has its own order, 4"),
        (&["run", "--config", "rk4-order.toml"], 2, "order 4 is composed of symmetric steps"),
        (&["run", "--config", "method.toml"], 2, "there is no method `leapfrog`"),
        (
            &["run", "quadrotor", "--set", "velocity=1,2,3"],
            2,
            "did you mean `attitude_velocity` or `position_velocity`?",
        ),
        (&["run", "quadrotor", "--set", "thrst=9"], 2, "did you mean `thrust`?"),
        (&["run", "quadrotor", "--set", "lift=9"], 2, "controls: moment, thrust"),
        (&["run", "quadrotor", "--set", "thrust=1,2"], 2, "takes one number, got 2"),
        (&["run", "quadrotor", "--set", "moment_y=inf"], 2, "`moment_y` must be finite"),
        (&["run", "--config", "thrust.toml"], 2, "[controls]: `heavy_top` has no control `thrust`"),
        (
            &["ensemble", "quadrotor", "--spread", "thrust=1"],
            2,
            "has no parameter or state quantity `thrust`",
        ),
        (&["certify", "heavy_top", "--method", "rk4"], 2, "claims nothing that a certificate could measure"),
        (&["certify", "free_rigid_body", "--method", "right-lift"], 2, "takes the steps of euler-a"),
        (&["run", "heavy_top", "--order", "3"], 2, "possible values: 2, 4, 6, 8, 10"),
        (&["run", "planar_pendulum", "--set", "angle=0,0"], 2, "no rotation is 1,0"),
        (&["run", "heavy_top", "--format", "xml"], 2, "possible values: csv, json, parquet"),
        (&["run", "--config", "missing.toml"], 2, "cannot read missing.toml"),
        (&["run", "--config", "."], 2, "cannot read ."),
        (&["run", "--config", "malformed.toml"], 2, "line 2"),
        (
            &["run", "--config", "misspelt.toml"],
            2,
            "[parameters]: `heavy_top` has no parameter `wieght`; did you mean `weight`?",
        ),
        (&["run", "--config", "negative.toml"], 2, "`inertia` is not positive definite"),
        (&["run", "--config", "text.toml"], 2, "`weight` takes numbers, got string `\"heavy\"`"),
        (
            &["run", "--config", "few.toml"],
            2,
            "[state]: `momentum` takes 3 numbers separated by commas, got 2",
        ),
        (&["run", "--config", "nan.toml"], 2, "[state]: `momentum` must be finite"),
        (&["run", "--config", "order.toml"], 2, "order must be 2, 4, 6, 8 or 10, got 5"),
        (&["run", "--config", "key.toml"], 2, "unknown field `stpe`"),
        (&["run", "--config", "every.toml"], 2, "`every` must be 1 or more"),
        (&["run", "kepler", "--config", "rk4.toml"], 2, "describes a run of `heavy_top`, not of `kepler`"),
        (&["run", "--config", "system.toml"], 2, "did you mean `heavy_top`?"),
        (&["init", "heavy_tpo"], 2, "did you mean `heavy_top`?"),
        (
            &["init", "heavy_top", "--out", "order.toml"],
            2,
            "order.toml exists and would be lost: `--force` replaces it",
        ),
        (&["figures", "6.4"], 2, "there is no figure `6.4`"),
        (&["resume", "missing.ck"], 2, "cannot read missing.ck"),
        (&["resume", "order.toml"], 2, "order.toml is not a checkpoint"),
        (&["resume", "damaged.ck"], 2, "damaged.ck is a damaged checkpoint"),
        (
            &["run", "heavy_top", "--checkpoint", "order.toml"],
            2,
            "order.toml exists already, and is no checkpoint",
        ),
        (
            &["run", "heavy_top", "--duration", "1", "--set", "momentum=1e200,1e200,1e200"],
            2,
            "the energy of the initial state is inf",
        ),
        (
            &["run", "kepler", "--set", "position=0,0,0", "--duration", "0"],
            2,
            "the energy of the initial state is",
        ),
        (&["run", "heavy_top", "--step", "1000", "--duration", "1000"], 3, "step 1, from time 0"),
        (&["bench", "--filter", "a"], 2, "built without its benchmarks"),
    ];
    let scratch = Scratch::new("bad-input");
    for (name, content) in [
        ("malformed", "system = \"heavy_top\"\n[run\nstep = 1"),
        ("misspelt", "system = \"heavy_top\"\n[parameters]\nwieght = 2.0"),
        ("negative", "system = \"heavy_top\"\n[parameters]\ninertia = [1.0, -10.0, 100.0]"),
        ("text", "system = \"heavy_top\"\n[parameters]\nweight = \"heavy\""),
        ("few", "system = \"heavy_top\"\n[state]\nmomentum = [1, 2]"),
        ("nan", "system = \"heavy_top\"\n[state]\nmomentum = [1, nan, 2]"),
        ("order", "system = \"heavy_top\"\n[run]\norder = 5"),
        ("key", "system = \"heavy_top\"\n[run]\nstpe = 0.1"),
        ("every", "system = \"heavy_top\"\n[run]\nevery = 0"),
        ("system", "system = \"heavy_tpo\""),
        ("rk4", "system = \"heavy_top\"\n[run]\nmethod = \"rk4\""),
        ("rk4-order", "system = \"heavy_top\"\n[run]\nmethod = \"rk4\"\norder = 4"),
        ("method", "system = \"heavy_top\"\n[run]\nmethod = \"leapfrog\""),
        ("thrust", "system = \"heavy_top\"\n[controls]\nthrust = 1"),
    ] {
        fs::write(scratch.0.join(format!("{name}.toml")), content).expect("writable");
    }
    fs::write(scratch.0.join("damaged.ck"), "coadjoint checkpoint 5\nabcdefgh").expect("writable");
    for (arguments, code, expected) in cases {
        let output = scratch.coadjoint(arguments);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(*code), "{arguments:?}: {message}");
        assert!(message.contains(expected), "{arguments:?}: {message}");
        assert!(message.starts_with("error: ") && !message.contains("panicked"), "{arguments:?}: {message}");
        assert_eq!(scratch.files("out"), [""; 0], "{arguments:?}");
    }
}

#[test]
fn directories_that_cannot_be_written_are_named() {
    let scratch = Scratch::new("unwritable");
    fs::write(scratch.0.join("file"), "in the way").expect("writable");
    fs::create_dir_all(scratch.0.join("taken/heavy_top-exponential.csv")).expect("writable");
    for (directory, named) in
        [("file", "file"), ("file/below", "below"), ("taken", "heavy_top-exponential.csv")]
    {
        let output = scratch.coadjoint(&["run", "heavy_top", "--out", directory]);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(4), "{directory}: {message}");
        assert!(
            message.starts_with("error: cannot write") && message.contains(named),
            "{directory}: {message}"
        );
    }
    assert_eq!(scratch.files("taken"), ["heavy_top-exponential.csv"], "nothing is left behind");
}

#[test]
fn a_run_that_fails_leaves_an_earlier_file_alone() {
    let scratch = Scratch::new("earlier");
    scratch.prints(&["run", "heavy_top", "--duration", "0.1"]);
    let before = scratch.read("out/heavy_top-exponential.csv");
    let output = scratch.coadjoint(&["run", "heavy_top", "--step", "1000", "--duration", "1000"]);
    assert_eq!(output.status.code(), Some(3), "{}", text(&output.stderr));
    assert_eq!(scratch.read("out/heavy_top-exponential.csv"), before);
    assert_eq!(scratch.files("out"), ["heavy_top-exponential.csv"]);
}

/// A full disk: no file, a message, and the exit code of what cannot be written.
#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_is_reported() {
    use std::os::unix::fs::symlink;
    let scratch = Scratch::new("full");
    fs::create_dir_all(scratch.0.join("out")).expect("writable");
    // what is written through the link goes to a device that is always full
    symlink("/dev/full", scratch.0.join("out/heavy_top-exponential.csv")).expect("writable");
    let output = scratch.coadjoint(&["run", "heavy_top"]);
    let message = text(&output.stderr);
    assert_eq!(output.status.code(), Some(4), "{message}");
    assert!(
        message.starts_with("error: cannot write out/heavy_top-exponential.csv: No space left"),
        "{message}"
    );
    assert_eq!(scratch.files("out"), ["heavy_top-exponential.csv"]);
}
