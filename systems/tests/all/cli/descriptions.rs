//! Systems that are described in a file.

use std::fs;

use super::{Scratch, text};

/// The numbers of the paper's top, which is the example of the catalogue's.
const TOP: [&str; 10] = [
    "--set",
    "inertia=1,10,100",
    "--set",
    "weight=1",
    "--set",
    "chi=0,0,1",
    "--set",
    "gamma=0,0,1",
    "--set",
    "momentum=1,1,1",
];

fn with<'a>(command: &[&'a str], more: &[&'a str]) -> Vec<&'a str> {
    [command, more].concat()
}

#[test]
fn a_description_to_begin_with_is_run_as_the_catalogue_runs_its_own() {
    let scratch = Scratch::new("described");
    assert!(scratch.prints(&["init", "--description", "my_top.rs"]).contains("list --description my_top.rs"));
    let refused = scratch.coadjoint(&["init", "--description", "my_top.rs"]);
    assert_eq!(refused.status.code(), Some(2));

    let listed = scratch.prints(&["list", "--description", "my_top.rs"]);
    for words in [
        "my_top: A rigid body that turns",
        "weight  N",
        "|gamma|²",
        "midpoint",
        "run --description my_top.rs",
        "it has no example: `--set` gives its parameters",
    ] {
        assert!(listed.contains(words), "{listed}");
    }

    let schemes: [&[&str]; 3] = [&["--retraction", "cayley"], &["--order", "4"], &["--method", "midpoint"]];
    for scheme in schemes {
        let steps = with(scheme, &["--step", "0.01", "--duration", "2", "--out"]);
        let own = with(&["run", "--description", "my_top.rs"], &steps);
        scratch.prints(&with(&with(&own, &["-"]), &TOP));
        let own = scratch.prints(&with(&with(&own, &["-"]), &TOP));
        let compiled = scratch.prints(&with(&with(&["run", "heavy_top"], &steps), &["-"]));
        assert!(own == compiled && own.lines().count() == 202, "{scheme:?}");
    }
}

#[test]
fn files_of_a_described_system_say_where_it_is_described() {
    let scratch = Scratch::new("described_files");
    scratch.prints(&["init", "--description", "my_top.rs"]);
    let run = ["run", "--description", "my_top.rs", "--duration", "1", "--plot", "--html", "top.html"];
    scratch.prints(&with(&run, &TOP));
    let table = scratch.read("out/my_top-exponential.csv");
    let made = scratch.path("out/my_top-exponential.csv").display().to_string();
    assert!(fs::metadata(scratch.path("top.html")).expect("a page").len() > 1000);
    scratch.prints(&["run", "--again", &made, "--force"]);
    assert_eq!(scratch.read("out/my_top-exponential.csv"), table);

    // a file of the run, to be edited
    let said = scratch.prints(&["init", "my_top", "--description", "my_top.rs", "--out", "run.toml"]);
    assert!(said.contains("run --config run.toml --description my_top.rs"), "{said}");
    let begun = scratch.read("run.toml");
    assert!(begun.contains("--description my_top.rs"));
    // what has no value by itself is asked for
    let run = ["run", "--description", "my_top.rs", "--config", "run.toml"];
    let refused = text(&scratch.coadjoint(&run).stderr);
    assert!(refused.contains("--set inertia=…,…,…") && refused.contains("--set gamma=…,…,…"), "{refused}");
    let filled = begun.replace("# inertia = […, …, …]", "inertia = [1, 10, 100]");
    let filled = filled.replace("# weight = …", "weight = 1").replace("# chi = […, …, …]", "chi = [0, 0, 1]");
    fs::write(scratch.path("run.toml"), filled.replace("# gamma = […, …, …]", "gamma = [0, 0, 1]"))
        .expect("written");
    scratch.prints(&[
        "run",
        "--description",
        "my_top.rs",
        "--config",
        "run.toml",
        "--duration",
        "0.1",
        "--out",
        "of_file",
    ]);
}

#[test]
fn ensembles_and_certificates_are_made_of_described_systems() {
    let scratch = Scratch::new("described_ensembles");
    scratch.prints(&["init", "--description", "my_top.rs"]);
    let own = ["ensemble", "--description", "my_top.rs", "--members", "20", "--duration", "1"];
    let said = scratch.prints(&with(&own, &TOP));
    assert!(said.contains("20"), "{said}");
    let report =
        scratch.prints(&with(&["certify", "--description", "my_top.rs", "--retraction", "cayley"], &TOP));
    assert!(report.contains("order") && !report.contains("FAILED"), "{report}");
    let code = scratch.prints(&["show", "--description", "my_top.rs", "--retraction", "cayley"]);
    assert!(code.contains("struct MyTop"));
}

#[test]
fn what_is_wrong_with_a_description_is_said_at_its_place() {
    let scratch = Scratch::new("described_wrongly");
    let refused = |arguments: &[&str]| {
        let output = scratch.coadjoint(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        text(&output.stderr)
    };
    let run = ["run", "--description", "my_top.rs"];
    assert!(refused(&run).contains("cannot read my_top.rs"));
    scratch.prints(&["init", "--description", "my_top.rs"]);
    let missing = refused(&run);
    assert!(
        missing.contains("give `--set inertia=…,…,…`") && missing.contains("`--set gamma=…,…,…`"),
        "{missing}"
    );
    let description = scratch.read("my_top.rs").replace("&chi", "&xhi").replace("inertia:", "inertia");
    fs::write(scratch.path("my_top.rs"), description).expect("a file");
    let said = refused(&run);
    assert!(said.starts_with("error: expected `:`\n  --> my_top.rs:16:13\n"), "{said}");
    assert!(said.contains("^^^^"), "{said}");
    let deep = format!("#[lie_poisson_system(group = R1, potential = {}1.0", "(".repeat(100_000));
    fs::write(scratch.path("my_top.rs"), deep).expect("a file");
    assert!(refused(&run).contains("error: "));
}

/// A planet on an ellipse of eccentricity 0.9, which is fast where it is near.
const PLANET: &str = "
#[lie_poisson_system(
    group = R3,
    hamiltonian = momentum.norm_squared() / (2.0 * mass) - strength / position.norm(),
    event(near = position.dot(&momentum), rising, axis = position.y),
    taylor
)]
struct Planet {
    mass: f64,
    strength: f64,
}
";

/// In the time of a step the planet goes around three times: between states that are looked at it is near and gone.
#[test]
fn taylor_steps_miss_no_event_between_the_times_of_steps() {
    let scratch = Scratch::new("described_events");
    fs::write(scratch.path("planet.rs"), PLANET).expect("a file");
    let run = ["run", "--description", "planet.rs", "--set", "mass=1", "--set", "strength=1"];
    let speed = 19_f64.sqrt().to_string();
    let start = ["--set", "position=0.1,0,0", "--set", &format!("momentum=0,{speed},0")];
    let run = with(&with(&run, &start), &["--tolerance", "1e-13", "--step", "20"]);
    scratch.prints(&with(&run, &["--duration", "100", "--event", "near", "--event", "axis"]));
    let name = scratch.files("out").into_iter().find(|name| name.ends_with(".events.csv")).expect("a table");
    let table = scratch.read(&format!("out/{name}"));
    let times = |name: &str| -> Vec<f64> {
        let rows = table.lines().map(|line| line.split(',').collect::<Vec<_>>());
        rows.filter(|row| row[0] == name).map(|row| row[2].parse().expect("a number")).collect()
    };
    let orbit = std::f64::consts::TAU;
    for (name, period) in [("near", orbit), ("axis", 0.5 * orbit)] {
        let times = times(name);
        assert_eq!(times.len(), (100.0 / period) as usize, "{table}");
        for (k, time) in times.iter().enumerate() {
            let exact = (k + 1) as f64 * period;
            assert!((time - exact).abs() < 1e-9, "{name}: {time} instead of {exact}");
        }
    }
    // and the run ends at one
    let said = scratch.prints(&with(&run, &["--duration", "100", "--until", "near", "--out", "until"]));
    assert!(said.contains("`near` comes at 6.28318530"), "{said}");
    let table = scratch.read("until/planet-taylor-1e-13.csv");
    assert!(table.lines().last().is_some_and(|row| row.starts_with("6.28318530")), "{table}");
    let never = with(&run, &["--duration", "2", "--until", "near, falling", "--out", "never"]);
    let never = scratch.prints(&never);
    assert!(never.contains("comes in none of 1 steps"), "{never}");
}

#[test]
fn a_name_that_the_file_does_not_describe_is_refused() {
    let scratch = Scratch::new("described_otherwise");
    scratch.prints(&["init", "--description", "my_top.rs"]);
    for command in [&["run", "heavy_top"][..], &["init", "boat"], &["show", "kepler"]] {
        let refused = scratch.coadjoint(&with(command, &["--description", "my_top.rs"]));
        let (said, name) = (text(&refused.stderr), command[1]);
        assert_eq!(refused.status.code(), Some(2), "{said}");
        assert!(said.contains(&format!("my_top.rs describes my_top, and no `{name}`")), "{said}");
    }
}

#[test]
fn headers_know_what_stands_beside_the_struct() {
    let scratch = Scratch::new("described_beside");
    let described = "const G: f64 = 2.0 * 4.905;
#[expression]
fn density(z: f64) -> f64 { 1.2 * (-z / 50.0).exp() }
lie_group! { pub Areas = matrices { a: [1, 0; 0, -1], b: [0, 1; 0, 0], c: [0, 0; 1, 0] } }
#[lie_poisson_system(group = R1, potential = m * G * position.x, force = -k * density(position.x) * velocity)]
struct Falling { #[inertia] m: f64, k: f64 }
#[lie_poisson_system(group = Areas!)]
struct Turning { #[inertia] inertia: Vector3<f64> }
";
    fs::write(scratch.path("beside.rs"), described).expect("written");
    for name in ["falling", "turning"] {
        for language in ["c", "cuda", "rust"] {
            let show = ["show", name, "--description", "beside.rs", "--language", language];
            let code = scratch.prints(&show);
            assert!(code.len() > 2_000, "{code}");
            assert!(language != "c" || name != "falling" || code.contains("= 9.81;"), "{code}");
        }
    }
}

#[test]
fn friction_that_jumps_is_said_to() {
    let scratch = Scratch::new("described_friction");
    let described = "#[lie_poisson_system(group = R1, potential = 0.5 * k * position.x.powi(2), force = -(f * velocity.x.signum()), taylor)]
struct Rubbing { #[inertia] m: f64, k: f64, f: f64 }
";
    fs::write(scratch.path("rubbing.rs"), described).expect("written");
    let run = ["run", "--description", "rubbing.rs", "--set", "m=1", "--set", "k=1", "--set", "f=0.3"];
    let run = with(&run, &["--set", "position=1", "--duration", "5", "--step", "1e-2"]);
    let refused = text(&scratch.coadjoint(&run).stderr);
    assert!(refused.contains("Where a force jumps") && refused.contains("take Taylor steps"), "{refused}");
    // where it turns round, it goes on
    let last = scratch.prints(&with(&run, &["--tolerance", "1e-12", "--out", "-", "-q"]));
    let position = last.lines().next_back().and_then(|line| line.split(',').nth(1)?.parse::<f64>().ok());
    // half a turn about 0.3, then about -0.3
    let exact = -0.3 - 0.1 * (5.0 - std::f64::consts::PI).cos();
    assert!((position.expect("a number") - exact).abs() < 1e-9, "{position:?} of {exact}");
}
