//! The HTML page that shows motions in three dimensions: one self-contained file, and its data format.
//!
//! `coadjoint view SYSTEM` writes such a page; `coadjoint play DATA.json` makes one of data that any program wrote. The
//! least data are the moments and one body's attitudes, as quaternions `[w, x, y, z]`:
//!
//! ```json
//! { "format": "coadjoint page 1",
//!   "time": [0.0, 0.1, 0.2],
//!   "runs": [{ "bodies": [{ "rotation": [[1, 0, 0, 0], [0.995, 0, 0, 0.0998], [0.980, 0, 0, 0.199]] }] }] }
//! ```
//!
//! `PAGE_FORMAT.md` beside this crate's manifest describes the whole format; [`Page`] is the same as Rust types.
//! [`Page::from_json`] reads and checks data, [`Page::write`] writes the page.
//!
//! In a browser's console, `coadjoint.scene()` tells what the page shows, in numbers, and `coadjoint.seek(t)` goes to a
//! moment; so does `#t=…` after the page's address.

mod format;
mod run;
mod validate;

use std::path::Path;

pub use self::format::*;
pub(crate) use self::run::{PageHeading, page};
pub use self::validate::PageError;
use crate::error::{Error, FileError, SetupError};

/// The page; its parts go where their places stand.
const PAGE: &str = include_str!("page/page.html");
const STYLE: &str = include_str!("page/page.css");
const SCRIPTS: [&str; 7] = [
    // the part of three.js that the others use
    include_str!("../vendor/three/three-subset.min.js"),
    include_str!("page/data.js"),
    include_str!("page/mesh.js"),
    include_str!("page/view.js"),
    include_str!("page/scene.js"),
    include_str!("page/plot.js"),
    include_str!("page/player.js"),
];
/// The tags around the data in a page.
const DATA: [&str; 2] = ["<script id=\"data\" type=\"application/json\">", "</script>"];

impl Page {
    /// The page as HTML.
    pub fn to_html(&self) -> String {
        // a `<` inside a script could end it
        let data = serde_json::to_string(self).unwrap_or_default().replace('<', "\\u003c");
        let page = PAGE.replacen("__COADJOINT_STYLE__", STYLE, 1);
        let page = page.replacen("__COADJOINT_SCRIPT__", &SCRIPTS.concat(), 1);
        // at the end: nothing in the data is a place
        page.replacen("__COADJOINT_DATA__", &data, 1)
    }

    /// Reads data, or those of a page.
    ///
    /// # Errors
    /// If there is no such file, or it is no page; the message names the place.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let text = std::fs::read_to_string(path).map_err(FileError::read(path))?;
        let in_page = text.split_once(DATA[0]).and_then(|(_, rest)| rest.split_once(DATA[1]));
        let wrong = |error: PageError| SetupError::new(error.to_string()).within(path.display());
        Ok(Self::from_json(in_page.map_or(text.as_str(), |(data, _)| data)).map_err(wrong)?)
    }

    /// Shows another page's runs over those of this one.
    pub fn overlay(&mut self, other: Self) {
        for run in &mut self.runs {
            name_run(run, &self.time, &self.subtitle);
        }
        for mut run in other.runs {
            name_run(&mut run, &other.time, &other.subtitle);
            self.runs.push(run);
        }
    }
}

/// A run with its own moments and a name.
fn name_run(run: &mut Run, time: &[f64], name: &str) {
    if run.time.is_empty() {
        time.clone_into(&mut run.time);
    }
    if run.name.is_empty() {
        name.clone_into(&mut run.name);
    }
}
