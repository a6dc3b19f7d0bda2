//! What the layers of the crate use of each other, read from their sources.

use std::path::{Path, PathBuf};

/// From the top; each uses those above it alone.
const LAYERS: [&str; 11] = [
    "error",
    "units",
    "catalogue",
    "setup",
    "record",
    "simulate",
    "picture",
    "scene",
    "page",
    "files",
    "cli",
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

/// All sources of a crate but its root and its tests, without the tests at their ends and without comments.
fn code(root: &Path) -> Vec<(String, String)> {
    let mut files = Vec::new();
    sources(root, &mut files);
    let code = |file: PathBuf| {
        let text = std::fs::read_to_string(&file).expect("a source");
        let text = ["#[cfg(test)]", "#[cfg(all(test"]
            .iter()
            .fold(&text[..], |text, start| text.split_once(start).map_or(text, |(before, _)| before));
        let lines = text.lines().filter(|line| !line.trim_start().starts_with("//"));
        let name = file.strip_prefix(root).expect("within the sources").to_string_lossy().into_owned();
        (name, lines.collect::<Vec<_>>().join("\n"))
    };
    let is_test = |name: &str| name.ends_with("tests.rs");
    files.into_iter().map(code).filter(|(name, _)| !is_test(name)).collect()
}

/// The names behind each `crate::`.
fn named(code: &str) -> impl Iterator<Item = String> {
    let name = |text: &str| text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
    code.split("crate::").skip(1).map(name)
}

#[test]
fn each_layer_uses_those_above_it_alone() {
    let mut uses = 0;
    for (name, code) in code(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src")) {
        if name == "lib.rs" {
            continue;
        }
        let layer = name.split(['/', '\\', '.']).next().expect("a name");
        let own = LAYERS.iter().position(|known| *known == layer);
        let own = own.unwrap_or_else(|| panic!("{name} is in no layer"));
        for used in named(&code) {
            let above = LAYERS[..own].contains(&used.as_str());
            assert!(above, "{name} uses `crate::{used}`, which is not above it");
            uses += 1;
        }
    }
    assert!(uses > 100, "{uses} uses");
}

/// Only the command line prints: the others return what is to be said.
#[test]
fn only_the_command_line_prints() {
    for (name, code) in code(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src")) {
        let prints = ["println!", "print!", "stderr()"].iter().any(|word| code.contains(word));
        assert!(!prints || name.starts_with("cli"), "{name} prints");
    }
}

/// What users of the library cannot see, the program does without.
#[test]
fn nothing_private_is_used() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for source in ["src", "../systems/src"] {
        for (name, code) in code(&root.join(source)) {
            assert!(!code.contains("__private"), "{source}/{name}");
        }
    }
}
