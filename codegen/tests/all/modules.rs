//! What the modules of the generator, and of the library, use of each other, read from their sources.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// For each top-level module those that it names.
type Uses = BTreeMap<String, BTreeSet<String>>;

/// What a module may use at most: mathematics knows neither syntax nor code, and emission no mathematics.
const MAY_USE: &[(&str, &[&str])] = &[
    ("derivatives", &[]),
    ("diagnostics", &[]),
    ("expr", &[]),
    ("identifiers", &[]),
    ("limits", &[]),
    ("group", &["expr"]),
    ("scheme", &["expr", "group"]),
    ("geometry", &["expr", "group", "identifiers", "model"]),
    ("method", &["derivatives", "expr", "geometry", "group", "identifiers", "model", "scheme"]),
    ("parse", &["derivatives", "diagnostics", "group", "limits", "scheme"]),
    ("program", &["expr", "model", "scheme"]),
    // it gives words to what was derived: neither groups nor methods nor differentiation
    ("emit", &["derivatives", "diagnostics", "expr", "identifiers", "model", "parse", "program", "scheme"]),
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

/// What stands behind each `crate::` in the code of a file, whose comments may name anything.
fn named(source: &str) -> impl Iterator<Item = String> {
    let code = source.lines().filter(|line| !line.trim_start().starts_with("//"));
    let behind = code.flat_map(|line| line.split("crate::").skip(1));
    let name = |text: &str| text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
    behind.map(name)
}

/// What is compiled for users: tests, which stand at a file's end, may use anything.
fn without_tests(source: &str) -> &str {
    ["#[cfg(test)]", "#[cfg(all(test"]
        .iter()
        .fold(source, |source, start| source.split_once(start).map_or(source, |(before, _)| before))
}

/// Of the package in this folder.
fn uses(package: &str) -> Uses {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join(package).join("src");
    let mut files = Vec::new();
    sources(&root, &mut files);
    let mut uses = Uses::new();
    for file in files {
        let place = file.strip_prefix(&root).expect("within the sources");
        let first = place.components().next().expect("a name").as_os_str().to_string_lossy().into_owned();
        let module = first.trim_end_matches(".rs").to_owned();
        // the root joins them all; a prelude is for users
        if !["lib", "guide", "prelude", "test_system"].contains(&module.as_str()) {
            let text = std::fs::read_to_string(&file).expect("a source");
            let names = named(without_tests(&text)).filter(|name| *name != module);
            uses.entry(module.clone()).or_default().extend(names);
        }
    }
    uses
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
        let uses = uses(package);
        assert!(uses[uses_of].contains(used), "{uses:?}");
        assert_eq!(circle(&uses), None, "{package}: each of these uses the next, and the last one the first");
    }
}

#[test]
fn modules_use_what_they_may() {
    let uses = uses("");
    for (module, allowed) in MAY_USE {
        let beyond: Vec<&String> =
            uses[*module].iter().filter(|name| !allowed.contains(&name.as_str())).collect();
        assert!(beyond.is_empty(), "`{module}` uses {beyond:?}");
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
        for derived in ["gradient", "Arena", ".jacobian(", ".equations()", ".casimirs()"] {
            assert!(!text.contains(derived), "{} derives: `{derived}`", file.display());
        }
    }
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
    let names: Vec<String> =
        named("use crate::model::System;\n// crate::emit\nlet x = crate::group::f();").collect();
    assert_eq!(names, ["model", "group"]);
}
