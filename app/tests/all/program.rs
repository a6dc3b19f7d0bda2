//! The program of `examples/two_systems.rs`, started in a directory of its own.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};

use serde_json::Value;

/// A directory of its own for a test, removed afterwards.
pub(crate) struct Scratch(pub(crate) PathBuf);

impl Scratch {
    pub(crate) fn new(test: &str) -> Self {
        static COUNT: AtomicUsize = AtomicUsize::new(0);
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        let name = format!("{test}-{}-{count}", std::process::id());
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
        fs::create_dir_all(&path).expect("a writable target directory");
        Self(path)
    }

    /// The program with these arguments, to be started in this directory.
    pub(crate) fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(program());
        command.args(arguments).current_dir(&self.0).stdin(Stdio::null());
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    /// Runs the program in this directory.
    pub(crate) fn run(&self, arguments: &[&str]) -> Output {
        self.command(arguments)
            .output()
            .expect("the program starts; `cargo test` and `cargo build --example two_systems` build it")
    }

    /// Runs the program, which must succeed, and gives what it printed.
    pub(crate) fn prints(&self, arguments: &[&str]) -> String {
        let output = self.run(arguments);
        assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
        text(&output.stdout)
    }

    /// Runs the program, which must succeed, and gives what it printed and what it remarked.
    pub(crate) fn says(&self, arguments: &[&str]) -> String {
        let output = self.run(arguments);
        assert!(output.status.success(), "{arguments:?}: {}", text(&output.stderr));
        text(&output.stdout) + &text(&output.stderr)
    }

    /// Runs the program, which must succeed, and gives the JSON object that it printed.
    pub(crate) fn object(&self, arguments: &[&str]) -> Value {
        let printed = self.prints(&[arguments, &["--json"]].concat());
        serde_json::from_str(&printed).expect("one JSON object")
    }

    /// Runs the program, which must fail with this exit code, and gives what it says.
    pub(crate) fn fails(&self, code: i32, arguments: &[&str]) -> String {
        let output = self.run(arguments);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {message}");
        assert!(!message.contains("panicked"), "{arguments:?}: {message}");
        message
    }

    pub(crate) fn path(&self, path: &str) -> PathBuf {
        self.0.join(path)
    }

    pub(crate) fn bytes(&self, path: &str) -> Vec<u8> {
        fs::read(self.path(path)).expect(path)
    }

    pub(crate) fn read(&self, path: &str) -> String {
        text(&self.bytes(path))
    }

    pub(crate) fn write(&self, path: &str, content: &[u8]) {
        let path = self.path(path);
        fs::create_dir_all(path.parent().expect("in here")).expect("writable");
        fs::write(path, content).expect("writable");
    }

    /// The one file in a directory whose name begins and ends so: settings of one's own have a checksum between.
    pub(crate) fn named(&self, directory: &str, begins: &str, ends: &str) -> String {
        let names = self.files(directory);
        let is_it = |name: &&String| name.starts_with(begins) && name.ends_with(ends);
        let found: Vec<&String> = names.iter().filter(is_it).collect();
        assert_eq!(found.len(), 1, "{begins}…{ends} among {names:?}");
        format!("{directory}/{}", found[0])
    }

    /// The names of the files in a directory, hidden ones too; none if it does not exist.
    pub(crate) fn files(&self, directory: &str) -> Vec<String> {
        let Ok(entries) = fs::read_dir(self.0.join(directory)) else { return Vec::new() };
        let names = entries.map(|entry| entry.expect("readable").file_name().to_string_lossy().into_owned());
        let mut names: Vec<String> = names.collect();
        names.sort();
        names
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// As text; files of bytes too, to be searched.
pub(crate) fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// `cargo test` builds the examples beside its tests: `debug/deps/all-…`, `debug/examples/two_systems`.
fn program() -> PathBuf {
    let test = std::env::current_exe().expect("it is running");
    let profile = test.parent().and_then(Path::parent).expect("in deps of a profile");
    profile.join("examples").join(format!("two_systems{}", std::env::consts::EXE_SUFFIX))
}
