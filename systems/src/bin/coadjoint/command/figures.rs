//! `coadjoint figures`

use std::fmt::Write as _;
use std::io::Write;
use std::path::PathBuf;

use clap::Args;
use coadjoint_app::error::SetupError;
use coadjoint_app::files::{FileOrigin, OverwriteGuard, PlannedFile};
use coadjoint_app::{Catalogue, Error};

use crate::figures::{DRAWINGS, Drawing, chosen};

/// Which figures to draw.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// By number or name [default: all]
    pub(crate) figures: Vec<String>,
    /// The directory to write to
    #[arg(long, value_name = "DIR", default_value = "out/figures")]
    pub(crate) out: PathBuf,
    /// Replace files that are there, whatever they are
    #[arg(long)]
    pub(crate) force: bool,
}

/// Draws figures, each with its data and its caption, and a page with all that are in the directory.
pub(crate) fn figures(_: &Catalogue, arguments: &Arguments, console: &mut dyn Write) -> Result<(), Error> {
    let Arguments { figures, out, force } = arguments;
    if out.as_os_str() == "-" {
        return Err(SetupError::new("figures are many files: give `--out` a directory").into());
    }
    let drawings = chosen(figures)?;
    let page = out.join("index.html");
    let page_guard = OverwriteGuard::new(FileOrigin::of_command("figures"), *force);
    page_guard.check_all(&[PlannedFile { what: "the page", path: page.clone(), written: true }])?;
    // all places are looked at before the first figure takes its time
    let guarded = |drawing: &'static Drawing| Ok((drawing, drawing.guard(out, *force)?));
    let drawings = drawings.into_iter().map(guarded).collect::<Result<Vec<_>, Error>>()?;
    for (drawing, guard) in drawings {
        writeln!(console, "{:8} {}", drawing.name, drawing.about)?;
        console.flush()?;
        let drawn = drawing.write(out, &guard)?;
        for paragraph in &drawn.caption {
            writeln!(console, "         {paragraph}")?;
        }
        for path in drawn.written {
            writeln!(console, "         wrote {}", path.display())?;
        }
    }
    let there = DRAWINGS.iter().filter_map(|drawing| Some((drawing, drawing.caption_in(out)?)));
    let content = index(&there.collect::<Vec<_>>()).into_bytes();
    page_guard.write_all(&[(page.clone(), content)])?;
    writeln!(console, "wrote {}, a page with all that are there", page.display())?;
    Ok(())
}

/// What the page looks like: pictures follow its colours, and on a phone they are moved sideways rather than made illegible.
const STYLE: &str = "\
:root { color-scheme: light dark; --ink: #1c1f23; --paper: #fff; --faint: #5d646c; --link: #0a5fa0 }
@media (prefers-color-scheme: dark) { :root { --ink: #e6e8ea; --paper: #14171a; --faint: #9aa2aa; --link: #6db3f2 } }
body { font: 1rem/1.55 system-ui, sans-serif; max-width: 74rem; margin: 2rem auto; padding: 0 1rem; color: var(--ink); background: var(--paper) }
a { color: var(--link) }
nav ol { padding-left: 0; list-style: none }
nav li { display: flex; gap: .75rem }
nav a { flex: 0 0 4.5rem }
figure { margin: 0 0 4rem }
.picture { overflow-x: auto }
.picture img { display: block; max-width: 100%; min-width: 40rem; height: auto; margin: 0 auto }
figcaption { max-width: 46rem; margin: 0 auto }
figcaption .files { color: var(--faint) }
";

/// All figures on one page, with contents.
fn index(drawn: &[(&Drawing, Vec<String>)]) -> String {
    let mut page = format!(
        "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>coadjoint: figures</title>\n<style>\n{STYLE}</style>\n<h1>Figures</h1>\n<nav>\n<ol>\n"
    );
    // writing to a string does not fail
    for (Drawing { name, about, .. }, _) in drawn {
        let _ = writeln!(page, "<li><a href=\"#{name}\">{name}</a><span>{}</span></li>", escape(about));
    }
    page.push_str("</ol>\n</nav>\n");
    for (drawing, caption) in drawn {
        let _ = write_figure(&mut page, drawing, caption);
    }
    page.push_str("</html>\n");
    page
}

fn write_figure(
    page: &mut String,
    Drawing { name, about, .. }: &Drawing,
    caption: &[String],
) -> std::fmt::Result {
    let about = escape(about);
    writeln!(page, "<figure id=\"{name}\">\n<div class=\"picture\">")?;
    writeln!(
        page,
        "<a href=\"figure-{name}.svg\"><img src=\"figure-{name}.svg\" alt=\"{about}\"></a>\n</div>\n<figcaption>"
    )?;
    for paragraph in caption {
        writeln!(page, "<p>{}</p>", escape(paragraph))?;
    }
    write!(page, "<p class=\"files\">")?;
    for (k, (extension, what)) in
        [("png", "PNG"), ("svg", "SVG"), ("csv", "data"), ("txt", "text")].iter().enumerate()
    {
        let separate = if k > 0 { " · " } else { "" };
        write!(page, "{separate}<a href=\"figure-{name}.{extension}\">{what}</a>")?;
    }
    writeln!(page, "</p>\n</figcaption>\n</figure>")
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}
