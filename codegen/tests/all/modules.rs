//! What the modules of the generator, and of the library, use of each other, read from their sources.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// For each top-level module those that it names.
type Uses = BTreeMap<String, BTreeSet<String>>;

/// The modules that each one uses, lower ones first: mathematics knows neither syntax nor code, and emission no mathematics.
const USES: &[(&str, &[&str])] = &[
    ("diagnostics", &[]),
    ("expr", &[]),
    ("identifiers", &[]),
    ("limits", &[]),
    ("quantity", &[]),
    ("group", &["expr", "quantity"]),
    ("scheme", &["expr", "group"]),
    ("parse", &["diagnostics", "group", "limits", "quantity", "scheme"]),
    ("check", &["diagnostics", "group", "identifiers", "limits", "parse", "quantity"]),
    ("lie_group", &["check", "diagnostics", "limits", "parse"]),
    ("source", &["diagnostics", "lie_group", "parse"]),
    ("language", &["diagnostics", "expr", "group", "limits", "parse", "quantity"]),
    ("model", &["check", "diagnostics", "expr", "group", "identifiers", "language", "parse", "quantity"]),
    ("method", &["expr", "group", "model", "quantity", "scheme"]),
    ("feasible", &["check", "diagnostics", "expr", "limits", "method", "model", "parse"]),
    ("library", &["group", "method", "scheme"]),
    ("program", &["expr", "quantity", "scheme"]),
    ("kernel", &["expr", "method", "model", "program", "scheme"]),
    (
        "derive",
        &[
            "expr",
            "group",
            "identifiers",
            "kernel",
            "language",
            "limits",
            "method",
            "model",
            "program",
            "quantity",
            "scheme",
        ],
    ),
    // it gives words to what was derived: neither groups nor methods nor differentiation
    ("emit", &["diagnostics", "expr", "identifiers", "model", "parse", "program", "quantity", "scheme"]),
];

/// Folders whose files use each other in no circle either.
const FOLDERS: [&str; 13] = [
    "check",
    "derive",
    "emit/c99",
    "emit/rust",
    "expr",
    "group",
    "group/matrix",
    "kernel",
    "language",
    "method",
    "model",
    "parse",
    "program",
];

fn sources(directory: &Path, found: &mut Vec<PathBuf>) {
    let entries = std::fs::read_dir(directory).expect("a directory of sources");
    for path in entries.map(|entry| entry.expect("an entry").path()) {
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

/// The modules behind each `start` in the code of a file, whose comments and texts may name anything.
fn named(source: &str, start: &str) -> Vec<String> {
    let code: Vec<&str> = source.lines().filter(|line| !line.trim_start().starts_with("//")).collect();
    let is_name = |name: &String| name.starts_with(|first: char| first.is_ascii_lowercase());
    let first = |text: &str| text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
    let behind = code.join("\n");
    let behind = behind.split(start).skip(1).flat_map(|text| match text.strip_prefix('{') {
        Some(list) => {
            list.split('}').next().unwrap_or_default().split(',').map(str::trim).map(first).collect()
        }
        None => vec![first(text)],
    });
    behind.filter(is_name).collect()
}

/// What is compiled for users: tests, which stand at a file's end, may use anything.
fn without_tests(source: &str) -> &str {
    ["#[cfg(test)]", "#[cfg(all(test"]
        .iter()
        .fold(source, |source, start| source.split_once(start).map_or(source, |(before, _)| before))
}

/// Of the modules in a folder of sources, each with the files below it. The folder's own root joins them all; a prelude is for users.
fn uses(folder: &Path, starts: &[&str]) -> Uses {
    let mut files = Vec::new();
    sources(folder, &mut files);
    let mut uses = Uses::new();
    for file in files {
        let place = file.strip_prefix(folder).expect("within the sources");
        let depth = place.components().count();
        let first = place.components().next().expect("a name").as_os_str().to_string_lossy().into_owned();
        let module = first.trim_end_matches(".rs").to_owned();
        if ["lib", "mod", "guide", "prelude", "tests"].contains(&module.as_str()) {
            continue;
        }
        let text = std::fs::read_to_string(&file).expect("a source");
        let text = without_tests(&text);
        // in folders below, `super` is another one
        let starts = starts.iter().filter(|start| depth == 1 || **start != "super::");
        let names = starts.flat_map(|start| named(text, start)).filter(|name| *name != module);
        uses.entry(module.clone()).or_default().extend(names);
    }
    uses
}

/// Of the package in this folder.
fn uses_of_package(package: &str) -> Uses {
    uses(&Path::new(env!("CARGO_MANIFEST_DIR")).join(package).join("src"), &["crate::"])
}

/// A circle of modules each of which uses the next one, if there is one.
fn circle(uses: &Uses) -> Option<Vec<String>> {
    fn walk(uses: &Uses, path: &mut Vec<String>, done: &mut BTreeSet<String>) -> Option<Vec<String>> {
        let last = path.last()?.clone();
        for next in uses.get(&last).into_iter().flatten() {
            if let Some(start) = path.iter().position(|module| module == next) {
                return Some(path[start..].to_vec());
            }
            if !done.contains(next) {
                path.push(next.clone());
                if let Some(found) = walk(uses, path, done) {
                    return Some(found);
                }
                path.pop();
            }
        }
        done.insert(last);
        None
    }
    let mut done = BTreeSet::new();
    uses.keys().find_map(|module| walk(uses, &mut vec![module.clone()], &mut done))
}

#[test]
fn modules_use_each_other_in_no_circle() {
    for (package, uses_of, used) in [("", "emit", "model"), ("../runtime", "stepper", "system")] {
        let uses = uses_of_package(package);
        assert!(uses[uses_of].contains(used), "{uses:?}");
        assert_eq!(circle(&uses), None, "{package}: each of these uses the next, and the last one the first");
    }
}

#[test]
fn files_of_a_folder_use_each_other_in_no_circle() {
    for folder in FOLDERS {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src").join(folder);
        let path = format!("crate::{}::", folder.replace('/', "::"));
        let uses = uses(&root, &["super::", &path]);
        assert!(uses.len() >= 3, "{folder}: {uses:?}");
        assert_eq!(circle(&uses), None, "{folder}: each of these uses the next, and the last one the first");
    }
}

/// Every module is in the list, with what it uses and nothing else, and uses those before it alone.
#[test]
fn modules_use_what_they_may() {
    let uses = uses_of_package("");
    let listed: BTreeSet<&str> = USES.iter().map(|&(module, _)| module).collect();
    assert_eq!(uses.keys().map(String::as_str).collect::<BTreeSet<_>>(), listed);
    for (place, (module, allowed)) in USES.iter().enumerate() {
        let used: Vec<&str> = uses[*module].iter().map(String::as_str).collect();
        assert_eq!(used, *allowed, "`{module}`");
        let above = allowed.iter().find(|name| !USES[..place].iter().any(|(lower, _)| lower == *name));
        assert_eq!(above, None, "`{module}` uses what stands above it");
    }
}

/// Of expressions emission knows the constants alone, and of the model what quantities are called.
#[test]
fn emission_derives_nothing() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/emit");
    let mut files = Vec::new();
    sources(&root, &mut files);
    for file in files {
        let text = std::fs::read_to_string(&file).expect("a source");
        for used in text.lines().filter(|line| line.starts_with("use crate::expr")) {
            assert_eq!(used, "use crate::expr::Number;", "{}", file.display());
        }
        for derived in [
            "gradient",
            "Arena",
            ".jacobian(",
            ".equations()",
            ".casimirs()",
            "_relation()",
            "depends_on",
            "crate::group",
        ] {
            assert!(!text.contains(derived), "{} derives: `{derived}`", file.display());
        }
    }
}

/// What a quantity is stored as in Rust is the emitter's to say, and the parser's to read.
#[test]
fn types_of_nalgebra_are_named_by_syntax_alone() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    sources(&root, &mut files);
    let words = ["UnitQuaternion\"", "UnitComplex\"", "Isometry2\"", "Isometry3\"", "SVector<", "SMatrix<"];
    for file in files {
        let place = file.strip_prefix(&root).expect("within the sources").to_string_lossy().into_owned();
        let text = std::fs::read_to_string(&file).expect("a source");
        let code = text.lines().filter(|line| !line.trim_start().starts_with("//"));
        let named = code.filter(|line| words.iter().any(|word| line.contains(word))).count();
        let may = ["emit/", "parse/", "language/"].iter().any(|folder| place.starts_with(folder));
        assert!(may || named == 0, "{place}");
    }
}

/// The files whose code, of the generator or of what stands on it, has one of these words.
fn files_with(words: &[&str]) -> Vec<String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let has = |file: &PathBuf| {
        let text = std::fs::read_to_string(file).expect("a source");
        let mut code = without_tests(&text).lines().filter(|line| !line.trim_start().starts_with("//"));
        code.any(|line| words.iter().any(|word| line.contains(word)))
    };
    let mut found = Vec::new();
    for folder in ["codegen", "macros", "runtime", "dynamic", "app", "python", "mpi"] {
        let mut files = Vec::new();
        sources(&root.join(folder).join("src"), &mut files);
        let place = |file: PathBuf| file.strip_prefix(&root).expect("within").to_string_lossy().into_owned();
        found.extend(files.into_iter().filter(has).map(place));
    }
    found.sort();
    found
}

/// A retraction for all groups is one file and its row: beside them certificates alone know of coordinates of the second
/// kind, by a definition of their own.
#[test]
fn a_retraction_is_one_file_and_a_row() {
    let expected = [
        "codegen/src/group/retraction/mod.rs",
        "codegen/src/group/retraction/second_kind.rs",
        "runtime/src/certify/definition.rs",
        "runtime/src/certify/neighbourhood.rs",
    ];
    assert_eq!(files_with(&["SecondKind", "second_kind", "second-kind", "second kind"]), expected);
}

/// A method is one file and its row: nothing else knows of tangent lifts.
#[test]
fn a_method_is_one_file_and_a_row() {
    let words = ["TangentLift", "TangentMidpoint", "tangent_lift", "tangent-lift", "tangent lift"];
    assert_eq!(files_with(&words), ["codegen/src/method/mod.rs", "codegen/src/method/tangent_lift.rs"]);
}

#[test]
fn a_circle_is_found() {
    let of = |pairs: &[(&str, &[&str])]| -> Uses {
        let names = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect();
        pairs.iter().map(|(module, used)| ((*module).to_owned(), names(used))).collect()
    };
    assert_eq!(circle(&of(&[("a", &["b", "c"]), ("b", &["c"]), ("c", &[])])), None);
    let round = of(&[("a", &["b"]), ("b", &["c", "d"]), ("c", &[]), ("d", &["b"])]);
    assert_eq!(circle(&round), Some(vec!["b".to_owned(), "d".to_owned()]));
    let source = "use crate::model::System;\n// crate::emit\nlet x = crate::group::f();\nuse crate::{\n    a::B,\n    C,\n};";
    assert_eq!(named(source, "crate::"), ["model", "group", "a"]);
}
