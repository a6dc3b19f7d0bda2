//! `coadjoint play`

use std::io::Write;
use std::path::{Path, PathBuf};

use clap::Args;

use crate::error::Error;
use crate::page::{Page, open};

/// What to show.
#[derive(Debug, Args)]
pub(crate) struct PlayArguments {
    /// Data in the format of pages, which any program can write, or pages; what moves in the later ones is drawn over the first
    #[arg(required = true, value_name = "FILE")]
    pub(crate) files: Vec<PathBuf>,
    /// Where to write the page [default: the first file with the extension `html`]
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    /// Open it
    #[arg(long)]
    pub(crate) open: bool,
}

pub(crate) fn play(arguments: &PlayArguments, console: &mut dyn Write) -> Result<(), Error> {
    let [first, others @ ..] = arguments.files.as_slice() else {
        return Err(Error::Input("no file: give one with data to be shown".to_owned()));
    };
    let mut page = Page::read(first)?;
    if !others.is_empty() {
        name_runs(&mut page, first);
    }
    for path in others {
        let mut other = Page::read(path)?;
        name_runs(&mut other, path);
        page.overlay(other);
    }
    page.check().map_err(|error| Error::Input(error.to_string()))?;
    let out = arguments.out.clone().unwrap_or_else(|| first.with_extension("html"));
    if arguments.out.is_none() && out.exists() {
        return Err(Error::Input(format!("{} exists already: say by `--out` where to write", out.display())));
    }
    page.write(&out)?;
    writeln!(console, "wrote {}", out.display())?;
    if arguments.open {
        show(&out, console)?;
    }
    Ok(())
}

/// Runs that are shown together are told apart by their files.
fn name_runs(page: &mut Page, path: &Path) {
    let file = path.file_stem().unwrap_or_default().to_string_lossy();
    for run in &mut page.runs {
        run.name = if run.name.is_empty() { file.to_string() } else { format!("{file} ({})", run.name) };
    }
}

/// Opens a page, or says why it cannot be opened.
pub(crate) fn show(path: &Path, console: &mut dyn Write) -> Result<(), Error> {
    if let Err(notice) = open(path) {
        writeln!(console, "note: {notice}")?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    const DATA: &str = r#"{"format": "coadjoint page 1", "title": "</script>", "time": [0, 1],
        "runs": [{"bodies": [{"rotation": [[1, 0, 0, 0], [0, 1, 0, 0]]}]}]}"#;

    fn played(directory: &Path, files: &[&str], out: Option<&str>) -> Result<String, String> {
        let files = files.iter().map(|file| directory.join(file)).collect();
        let arguments = PlayArguments { files, out: out.map(|out| directory.join(out)), open: false };
        let mut console = Vec::new();
        play(&arguments, &mut console).map_err(|error| error.to_string())?;
        Ok(String::from_utf8_lossy(&console).replace(&*directory.to_string_lossy(), "…"))
    }

    #[test]
    fn data_become_a_page_and_pages_are_data() {
        let directory = std::env::temp_dir().join(format!("coadjoint-play-{}", std::process::id()));
        std::fs::create_dir_all(&directory).expect("writable");
        std::fs::write(directory.join("top.json"), DATA).expect("writable");
        std::fs::write(directory.join("bad.json"), DATA.replace("[0, 1]", "[0, 1, 2]")).expect("writable");

        assert_eq!(played(&directory, &["top.json"], None).expect("a page"), "wrote …/top.html\n");
        let read = |name: &str| Page::read(&directory.join(name)).expect("a page");
        assert_eq!(read("top.html"), read("top.json"));
        let html = std::fs::read_to_string(directory.join("top.html")).expect("a page");
        assert_eq!(html.matches("</script>").count(), 2, "no data end a script");

        assert!(played(&directory, &["top.json"], None).expect_err("there").contains("exists already"));
        played(&directory, &["top.html", "top.json"], Some("both.html")).expect("a page");
        let names: Vec<String> = read("both.html").runs.into_iter().map(|run| run.name).collect();
        assert_eq!(names, ["top", "top"]);
        assert!(!directory.join("bad.html").exists());
        let message = played(&directory, &["bad.json"], None).expect_err("no page");
        assert!(message.contains("`runs[0].bodies[0].rotation`: has 2 entries for 3 moments"), "{message}");
        std::fs::remove_dir_all(&directory).expect("removable");
    }
}
