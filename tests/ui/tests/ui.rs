//! What the compiler tells a user: descriptions that must fail, with their messages. What must pass is in `ok/`, each a test of its own.
//!
//! Each case is compiled as Cargo would, with the library that this test is linked with: nothing of it is compiled once more. After a deliberate
//! change, `INSTA_UPDATE=always cargo test -p coadjoint-ui` writes the messages anew; read them as a user would before committing them.

use std::path::{Path, PathBuf};
use std::process::Command;

// linked, so that it is there
use coadjoint as _;

/// A test of each file in `fail/`.
macro_rules! cases {
    ($($case:ident)*) => {
        $(#[test]
        fn $case() {
            check(stringify!($case));
        })*

        #[test]
        fn every_file_is_a_case() {
            let files = std::fs::read_dir(directory().join("fail")).expect("a directory");
            let names = files.map(|file| file.expect("readable").path());
            let mut names: Vec<String> = names
                .filter(|path| path.extension().is_some_and(|it| it == "rs"))
                .map(|path| path.file_stem().expect("a name").to_string_lossy().into_owned())
                .collect();
            names.sort();
            assert_eq!(names, [$(stringify!($case)),*]);
        }
    };
}

cases! {
    advected_collisions arrays basis derivatives dimension_mismatch duplicate_advected duplicate_key energies enumeration factors
    generic_struct group_with_parentheses inertia_of_wrong_size integer_division left_to_rustc methods missing_commas missing_group
    missing_inertia missing_values mixed_scalars not_smooth nothing_follows own_function own_groups retractions schemes sealed
    several_problems tuple_struct two_inertias unknown_group unknown_key unknown_method unknown_name unsupported_construct
    vector_valued_potential without_effect wrong_field_type
}

/// Compares what the compiler tells about a case with what it told.
fn check(case: &str) {
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path("../fail");
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    // lines of the library change with every edit, a dependency's version with every update
    settings.add_filter(r"--> (runtime/src/\S+\.rs):\d+:\d+", "--> $1");
    settings.add_filter(r"--> \S*/([a-z0-9_-]+)-\d+\.\d+\.\d+/(src/\S+\.rs):\d+:\d+", "--> $1/$2");
    settings.add_filter(r"written to '.*'", "written to '…'");
    settings.bind(|| insta::assert_snapshot!(case, messages(case)));
}

fn directory() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The library that is there for tests beside this one: the latest, if there are several.
fn library() -> PathBuf {
    let own = std::env::current_exe().expect("a program");
    let beside = own.parent().expect("a directory").read_dir().expect("readable");
    let libraries = beside.map(|file| file.expect("readable").path()).filter(|path| {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        name.starts_with("libcoadjoint-") && name.ends_with(".rlib")
    });
    let changed = |path: &PathBuf| path.metadata().and_then(|of| of.modified()).expect("a time");
    libraries.max_by_key(changed).expect("the library is compiled before its tests")
}

/// What the compiler tells about a case that it refuses.
fn messages(case: &str) -> String {
    let library = library();
    let mut rustc = Command::new(std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into()));
    rustc.current_dir(directory()).args(["--edition", "2024", "--crate-type", "bin", "--emit", "metadata"]);
    rustc.args(["--diagnostic-width", "140", "--allow", "dead_code", "--out-dir"]);
    rustc.arg(env!("CARGO_TARGET_TMPDIR"));
    rustc.arg("-L").arg(format!("dependency={}", library.parent().expect("a directory").display()));
    rustc.arg("--extern").arg(format!("coadjoint={}", library.display()));
    let output = rustc.arg(format!("fail/{case}.rs")).output().expect("a compiler");
    assert!(!output.status.success(), "it compiles");
    let told = String::from_utf8(output.stderr).expect("text");
    // the last paragraphs only count
    let (told, _) = told.split_once("error: aborting due to").expect("an end");
    told.trim_end().to_owned()
}
