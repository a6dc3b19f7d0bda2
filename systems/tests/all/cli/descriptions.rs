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
    scratch.prints(&["init", "my_top", "--description", "my_top.rs", "--out", "run.toml"]);
    assert!(scratch.read("run.toml").contains("--description my_top.rs"));
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
