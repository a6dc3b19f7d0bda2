//! `coadjoint play`

use std::io::Write;
use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Value, json};

use super::console::Console;
use super::console::OutputMode;
use super::open::open;
use crate::error::{Error, FileError, SetupError};
use crate::files::{FileOrigin, OverwriteGuard, PlannedFile, is_stdout, path::read_file, read};
use crate::page::Page;

/// The arguments of `play`.
#[derive(Debug, Args)]
pub(crate) struct PlayArguments {
    /// Data in the format of pages, which any program can write, or pages; what moves in the later ones is drawn over
    /// the first
    #[arg(required = true, value_name = "FILE")]
    pub(crate) files: Vec<PathBuf>,
    /// Where to write the page [default: the first file with the extension `html`]
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    /// Replace a file that is there
    #[arg(long)]
    pub(crate) force: bool,
    /// Open it
    #[arg(long)]
    pub(crate) open: bool,
}

pub(crate) fn play(arguments: &PlayArguments, stdout: &mut dyn Write) -> Result<(), Error> {
    // there is a first file: it is required
    let beside = arguments.files.first().map(|first| first.with_extension("html"));
    let out = arguments.out.clone().or(beside).unwrap_or_default();
    let mut console = OutputMode::default().on(stdout, is_stdout(&out))?;
    let guard = OverwriteGuard::new(origin(&arguments.files)?, arguments.force);
    let read = arguments.files.iter().map(|path| PlannedFile {
        what: "what is shown",
        path: path.clone(),
        written: false,
    });
    let page = PlannedFile { what: "the page", path: out.clone(), written: true };
    guard.check_all(&read.chain([page]).collect::<Vec<_>>())?;
    let page = shown(&arguments.files)?;
    guard.write_all(&[(out.clone(), page.to_html().into_bytes())])?;
    if !is_stdout(&out) {
        console.wrote(std::slice::from_ref(&out))?;
    }
    if arguments.open {
        show(&out, &mut console)?;
    }
    Ok(())
}

/// No data that a browser shows are longer.
const MOST: u64 = 1 << 30;

/// Describes the origin of the page: the files by their names and checksums.
fn origin(files: &[PathBuf]) -> Result<FileOrigin, FileError> {
    let described = files.iter().map(|path| {
        let content = read_file(path, MOST).map_err(FileError::read(path))?;
        let mut file = json!({ "name": path.file_name().unwrap_or_default().to_string_lossy() });
        file["crc32"] = format!("{:08x}", crc32fast::hash(&content)).into();
        if let Some((made, _)) = read(path)? {
            file["made_by"] = Value::Object(made.fields().clone());
        }
        Ok(file)
    });
    let described = described.collect::<Result<Vec<Value>, FileError>>()?;
    let names = files.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(" ");
    Ok(FileOrigin::of_command(&format!("play {names}")).with("input", described.into()))
}

/// The page with the runs of all files.
fn shown(files: &[PathBuf]) -> Result<Page, Error> {
    let mut all: Option<Page> = None;
    for path in files {
        let mut page = Page::read(path)?;
        if files.len() > 1 {
            name_runs(&mut page, path);
        }
        match &mut all {
            Some(all) => all.overlay(page),
            None => all = Some(page),
        }
    }
    let mut page = all.unwrap_or_default();
    page.check().map_err(|error| SetupError::new(error.to_string()))?;
    Ok(page)
}

/// Runs that are shown together are told apart by their files.
fn name_runs(page: &mut Page, path: &Path) {
    let file = path.file_stem().unwrap_or_default().to_string_lossy();
    for run in &mut page.runs {
        run.name = if run.name.is_empty() { file.to_string() } else { format!("{file} ({})", run.name) };
    }
}

/// Opens a page, or says why it cannot be opened.
pub(crate) fn show(path: &Path, console: &mut Console<'_>) -> Result<(), Error> {
    open(path).map_or_else(|notice| console.note(notice), Ok)
}

#[cfg(test)]
mod tests {
    use super::*;

    const DATA: &str = r#"{"format": "coadjoint page 1", "title": "</script>", "time": [0, 1],
        "runs": [{"bodies": [{"rotation": [[1, 0, 0, 0], [0, 1, 0, 0]]}]}]}"#;

    /// A directory with some data.
    fn directory(test: &str) -> PathBuf {
        let directory = std::env::temp_dir().join(format!("coadjoint-play-{test}-{}", std::process::id()));
        std::fs::create_dir_all(&directory).expect("writable");
        std::fs::write(directory.join("top.json"), DATA).expect("writable");
        directory
    }

    fn played(directory: &Path, files: &[&str], out: Option<&str>) -> Result<String, String> {
        let files = files.iter().map(|file| directory.join(file)).collect();
        let out = out.map(|out| directory.join(out));
        let arguments = PlayArguments { files, out, force: false, open: false };
        let mut console = Vec::new();
        play(&arguments, &mut console).map_err(|error| error.to_string())?;
        Ok(String::from_utf8_lossy(&console).replace(&*directory.to_string_lossy(), "…"))
    }

    #[test]
    fn data_become_a_page_and_pages_are_data() {
        let directory = directory("data");
        std::fs::write(directory.join("bad.json"), DATA.replace("[0, 1]", "[0, 1, 2]")).expect("writable");

        assert_eq!(played(&directory, &["top.json"], None).expect("a page"), "wrote …/top.html\n");
        let read = |name: &str| Page::read(&directory.join(name)).expect("a page");
        assert_eq!(read("top.html"), read("top.json"));
        let html = std::fs::read_to_string(directory.join("top.html")).expect("a page");
        assert_eq!(html.matches("</script>").count(), 2, "no data end a script");

        played(&directory, &["top.html", "top.json"], Some("both.html")).expect("a page");
        let names: Vec<String> = read("both.html").runs.into_iter().map(|run| run.name).collect();
        assert_eq!(names, ["top", "top"]);
        assert!(!directory.join("bad.html").exists());
        let message = played(&directory, &["bad.json"], None).expect_err("no page");
        assert!(message.contains("`runs[0].bodies[0].rotation`: has 2 entries for 3 moments"), "{message}");
        std::fs::remove_dir_all(&directory).expect("removable");
    }

    #[test]
    fn a_page_takes_the_place_of_itself_alone() {
        let directory = directory("place");
        played(&directory, &["top.json"], None).expect("a page");
        let made =
            |page: &str| std::fs::read_to_string(directory.join(page)).expect("it is said what made it");
        assert!(made("top.run.json").contains("\"name\": \"top.json\""), "{}", made("top.run.json"));
        played(&directory, &["top.json"], None).expect("the same page");
        played(&directory, &["top.html"], Some("again.html")).expect("a page of a page");
        let again: Value = serde_json::from_str(&made("again.run.json")).expect("JSON");
        let first: Value = serde_json::from_str(&made("top.run.json")).expect("JSON");
        // what made the page that is shown is said too
        assert_eq!(again["input"][0]["made_by"]["input"], first["input"]);

        let refused = |files: &[&str], out| played(&directory, files, out).expect_err("refused");
        std::fs::write(directory.join("top.json"), DATA.replace("script", "other")).expect("writable");
        let message = refused(&["top.json"], None);
        assert!(message.contains("top.html exists and was made by `play"), "{message}");
        let message = refused(&["top.html"], None);
        assert!(message.contains("would be both what is shown and the page"), "{message}");
        let message = refused(&["top.json", "top.json"], Some("two.html"));
        assert!(message.contains("top.json is named twice"), "{message}");
        std::fs::write(directory.join("notes.html"), "mine").expect("writable");
        let message = refused(&["top.json"], Some("notes.html"));
        assert!(message.contains("was not made by this program"), "{message}");
        assert_eq!(std::fs::read(directory.join("notes.html")).expect("there"), b"mine");
        std::fs::remove_dir_all(&directory).expect("removable");
    }
}
