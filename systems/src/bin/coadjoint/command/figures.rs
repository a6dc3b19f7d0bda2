//! `coadjoint figures`

use std::fmt::Write as _;
use std::io::Write;
use std::path::PathBuf;

use clap::Args;
use coadjoint_app::output::write_text;
use coadjoint_app::{Catalogue, Error};

use crate::figures::{Drawing, chosen};

/// Which figures to draw.
#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// By number or name [default: all]
    pub(crate) figures: Vec<String>,
    /// The directory to write to
    #[arg(long, value_name = "DIR", default_value = "out/figures")]
    pub(crate) out: PathBuf,
}

/// Draws figures, each with its data, and a page with all of them and their captions.
pub(crate) fn figures(_: Catalogue, arguments: &Arguments, console: &mut dyn Write) -> Result<(), Error> {
    let drawings = chosen(&arguments.figures)?;
    let mut drawn = Vec::new();
    for drawing in drawings {
        writeln!(console, "{:5} {}", drawing.name, drawing.about)?;
        console.flush()?;
        let (written, caption) = drawing.write(&arguments.out)?;
        for paragraph in &caption {
            writeln!(console, "      {paragraph}")?;
        }
        for path in written {
            writeln!(console, "      wrote {}", path.display())?;
        }
        drawn.push((drawing, caption));
    }
    let page = arguments.out.join("index.html");
    write_text(&page, &index(&drawn))?;
    writeln!(console, "wrote {}, a page with all of them", page.display())?;
    Ok(())
}

/// All figures on one page.
fn index(drawn: &[(&Drawing, Vec<String>)]) -> String {
    let escape = |text: &str| text.replace('&', "&amp;").replace('<', "&lt;");
    let mut page = String::from(
        "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n<title>coadjoint: figures</title>\n\
         <style>body { font: 16px/1.5 sans-serif; max-width: 72rem; margin: 2rem auto; padding: 0 1rem; } \
         img { max-width: 100%; } figure { margin: 0 0 3rem; }</style>\n<h1>Figures</h1>\n",
    );
    for (drawing, caption) in drawn {
        let name = drawing.name;
        // the caption stands in the picture; here it can be searched and copied
        let alt = escape(&caption.join(" ")).replace('"', "&quot;");
        // writing to a string does not fail
        let _ = write!(
            page,
            "<figure id=\"{name}\">\n<h2>{name}: {about}</h2>\n\
             <img src=\"figure-{name}.svg\" alt=\"{alt}\">\n\
             <figcaption><a href=\"figure-{name}.png\">PNG</a>, <a href=\"figure-{name}.csv\">data</a></figcaption>\n</figure>\n",
            about = escape(drawing.about),
        );
    }
    page.push_str("</html>\n");
    page
}
