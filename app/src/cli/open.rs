//! Opening a page in the system's browser.

use std::io;
use std::path::Path;

/// Opens a page, and does not wait for it.
///
/// # Errors
/// If nothing is there that could; the message says what to do.
pub(crate) fn open(path: &Path) -> Result<(), String> {
    opened(path, open::that_detached(path))
}

fn opened(path: &Path, by_program: io::Result<()>) -> Result<(), String> {
    by_program.map_err(|error| format!("cannot open {} ({error}): open it in a browser", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_an_opener_the_message_says_what_to_do() {
        let page = Path::new("out/top.html");
        let message =
            opened(page, open::with_detached(page, "coadjoint-no-such-opener")).expect_err("there is none");
        assert!(
            message.starts_with("cannot open out/top.html (") && message.ends_with("open it in a browser")
        );
        assert_eq!(opened(page, Ok(())), Ok(()));
    }
}
