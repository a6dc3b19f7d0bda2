//! The program as people meet it: the real binary, its output, its files, its exit codes.

mod descriptions;
mod ensembles;
mod inputs;
mod mistakes;
mod output;
mod runs;
mod settings;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use serde_json::Value;

/// A directory of its own for a test, removed afterwards.
pub(crate) struct Scratch(PathBuf);

impl Scratch {
    pub(crate) fn new(test: &str) -> Self {
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{test}-{}", std::process::id()));
        fs::create_dir_all(&path).expect("a writable target directory");
        Self(path)
    }

    /// Runs the program in this directory.
    fn coadjoint(&self, arguments: &[&str]) -> Output {
        Command::new(env!("CARGO_BIN_EXE_coadjoint"))
            .args(arguments)
            .current_dir(&self.0)
            .stdin(Stdio::null())
            .output()
            .expect("the program starts")
    }

    /// Runs the program, which must succeed, and gives what it printed.
    pub(crate) fn prints(&self, arguments: &[&str]) -> String {
        let output = self.coadjoint(arguments);
        assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
        text(&output.stdout)
    }

    /// A file whose name may go on with a checksum of the run's settings, the newest of them.
    pub(crate) fn path(&self, path: &str) -> PathBuf {
        let path = self.0.join(path);
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let directory = path.parent().expect("in here");
        let alike = fs::read_dir(directory).into_iter().flatten().flatten();
        let alike = alike.filter(|entry| without_checksum(&entry.file_name().to_string_lossy()) == name);
        let newest = alike.max_by_key(|entry| entry.metadata().and_then(|file| file.modified()).ok());
        newest.map_or(path, |entry| entry.path())
    }

    pub(crate) fn read(&self, path: &str) -> String {
        fs::read_to_string(self.path(path)).expect(path)
    }

    /// The names of the files in a directory, hidden ones too, but those that say what made the others, without checksums;
    /// none if it does not exist.
    pub(crate) fn files(&self, directory: &str) -> Vec<String> {
        let Ok(entries) = fs::read_dir(self.0.join(directory)) else { return Vec::new() };
        let mut names: Vec<_> = entries
            .map(|entry| without_checksum(&entry.expect("readable").file_name().to_string_lossy()))
            .filter(|name| !name.ends_with(".run.json"))
            .collect();
        names.sort();
        names
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// `heavy_top-cayley.csv` for `heavy_top-cayley-3fa9c1.csv`
fn without_checksum(name: &str) -> String {
    let split = name.rsplit_once('.').and_then(|(stem, end)| Some((stem.rsplit_once('-')?, end)));
    match split {
        Some(((stem, sum), end)) if sum.len() == 6 && sum.chars().all(|digit| digit.is_ascii_hexdigit()) => {
            format!("{stem}.{end}")
        }
        _ => name.to_owned(),
    }
}

/// What a page shows.
fn shown(page: &str) -> Value {
    let (_, rest) = page.split_once("<script id=\"data\" type=\"application/json\">").expect("data");
    let (data, _) = rest.split_once("</script>").expect("data end");
    serde_json::from_str(data).expect("JSON")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("UTF-8")
}

/// The header and the numbers of a CSV file.
pub(crate) fn table(csv: &str) -> (Vec<&str>, Vec<Vec<f64>>) {
    let mut lines = csv.lines();
    let header = lines.next().expect("a header").split(',').collect();
    let rows = lines.map(|line| line.split(',').map(|field| field.parse().expect("a number")).collect());
    (header, rows.collect())
}
