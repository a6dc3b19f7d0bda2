//! Opening a page in the system's browser.

use std::path::Path;
use std::process::{Command, Stdio};

/// The programs that open a file with what the user chose for it, the first one that is there.
const OPENERS: &[(&str, &[&str])] = if cfg!(target_os = "macos") {
    &[("open", &[])]
} else if cfg!(windows) {
    // `start` is one of its commands; the empty title keeps a quoted path from being taken for one
    &[("cmd", &["/C", "start", ""])]
} else {
    &[("xdg-open", &[]), ("wslview", &[])]
};

/// Opens a page, and does not wait for it.
///
/// # Errors
/// If nothing is there that could; the message says what to do.
pub(crate) fn open(path: &Path) -> Result<(), String> {
    open_with(OPENERS, path)
}

fn open_with(openers: &[(&str, &[&str])], path: &Path) -> Result<(), String> {
    for (program, arguments) in openers {
        let mut command = Command::new(program);
        command.args(*arguments).arg(path).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        if command.spawn().is_ok() {
            return Ok(());
        }
    }
    let names: Vec<&str> = openers.iter().map(|(program, _)| *program).collect();
    Err(format!("cannot open {} ({} not found): open it in a browser", path.display(), names.join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_an_opener_the_message_says_what_to_do() {
        let message = open_with(&[("coadjoint-no-such-opener", &[])], Path::new("out/top.html"))
            .expect_err("there is none");
        assert_eq!(
            message,
            "cannot open out/top.html (coadjoint-no-such-opener not found): open it in a browser"
        );
    }
}
