//! A headless Chromium, where one is installed.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::{Value, json};

/// A browser, and a directory of pages for it.
#[derive(Clone)]
pub(super) struct Browser {
    program: PathBuf,
    directory: PathBuf,
    webgl: bool,
}

impl Browser {
    /// The browser that is installed. None is said loudly, and fails where `COADJOINT_REQUIRE_CHROMIUM` is set.
    pub(super) fn find(test: &str) -> Option<Self> {
        let names = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];
        let path = std::env::var_os("PATH").unwrap_or_default();
        let mut programs =
            std::env::split_paths(&path).flat_map(|directory| names.map(|name| directory.join(name)));
        let Some(program) = programs.find(|program| program.is_file()) else {
            assert!(
                std::env::var_os("COADJOINT_REQUIRE_CHROMIUM").is_none(),
                "COADJOINT_REQUIRE_CHROMIUM is set, and there is no Chromium"
            );
            // past the capture of what tests print
            let notice = format!(
                "\nSKIPPED: {test}: no Chromium is installed, so what the page draws is NOT TESTED\n"
            );
            std::io::stderr().write_all(notice.as_bytes()).expect("writable");
            return None;
        };
        let directory = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("page-{test}"));
        std::fs::create_dir_all(&directory).expect("writable");
        Some(Self { program, directory, webgl: true })
    }

    /// The same browser without WebGL.
    pub(super) fn without_webgl(self) -> Self {
        Self { webgl: false, ..self }
    }

    /// Where a page of this name is.
    pub(super) fn path(&self, name: &str) -> PathBuf {
        self.directory.join(name)
    }

    /// The value of an expression, or of its promise, once a page is shown in a window of this size, after checking that nothing went wrong.
    pub(super) fn ask(&self, name: &str, size: (u32, u32), expression: &str) -> Value {
        // a machine that is busy may be asked before the page is drawn, or have no time left for its answer
        let mut answer = Value::Null;
        for budget in [1_500, 1_500, 3_000, 6_000, 12_000] {
            answer = self.ask_once(name, size, expression, budget);
            if answer["errors"] == Value::Array(Vec::new()) {
                return answer["value"].take();
            }
        }
        panic!("{name}: {}", answer["errors"]);
    }

    /// What the page answers within so many milliseconds of its time, or what went wrong.
    fn ask_once(&self, name: &str, (width, height): (u32, u32), expression: &str, budget: u32) -> Value {
        let page = std::fs::read_to_string(self.path(name)).expect("a page");
        assert!(page.contains("</body>") && page.contains("default-src 'none'"), "{name}");
        // a canvas has its size only after the first layout, and shows nothing that could be asked about before
        let question = format!(
            "<script nonce=\"ask\">(async function ask(tries) {{
               const sized = [...document.querySelectorAll('canvas')].every(canvas =>
                 canvas.width === Math.max(1, Math.round(canvas.clientWidth * devicePixelRatio)));
               const drawn = sized
                 && coadjoint.scene().runs.every(({{ bodies }}) => bodies.every(({{ screen }}) => screen));
               if (!drawn && tries > 0) return setTimeout(ask, 50, tries - 1);
               let answer;
               try {{
                 if (!drawn) throw new Error('the page is not drawn yet');
                 answer = {{ value: await ({expression}), errors: coadjoint.errors }};
               }}
               catch (error) {{ answer = {{ errors: [String(error.stack)] }}; }}
               const text = JSON.stringify(answer).replace(/[<>&]/g, c => '\\\\u00' + c.charCodeAt().toString(16));
               document.body.append(Object.assign(document.createElement('pre'), {{ id: 'answer', textContent: text }}));
             }})(20);</script></body>"
        );
        let asked = self.path(&format!("asked-{name}"));
        // the page's own scripts run by their hashes, and this question by its nonce
        let page = page.replace("script-src ", "script-src 'nonce-ask' ").replace("</body>", &question);
        // no frame of the screen comes by itself while time is virtual
        let frames = "<script nonce=\"ask\">requestAnimationFrame = drawn => setTimeout(drawn, 50, performance.now());</script></head>";
        let page = page.replace("</head>", frames);
        std::fs::write(&asked, page).expect("writable");
        let drawing: &[&str] = if self.webgl {
            &["--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
        } else {
            &["--disable-gpu", "--disable-3d-apis"]
        };
        let output = Command::new(&self.program)
            .args(["--headless", "--no-sandbox", "--disable-background-networking", "--hide-scrollbars"])
            .args(drawing)
            .args(["--enable-logging=stderr", "--dump-dom"])
            .arg(format!("--virtual-time-budget={budget}"))
            .arg(format!("--user-data-dir={}", self.directory.join("profile").display()))
            .arg(format!("--window-size={width},{height}"))
            .arg(format!("file://{}", asked.display()))
            .output()
            .expect("Chromium can be started");
        let (shown, log) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
        let said: Vec<&str> = log.lines().filter(|line| line.contains("CONSOLE")).collect();
        assert!(said.is_empty(), "{name}: {said:#?}");
        let answer = shown.split_once("<pre id=\"answer\">").and_then(|(_, rest)| rest.split_once("</pre>"));
        answer.map_or_else(
            || json!({ "errors": [format!("no answer:\n{log}")] }),
            |(answer, _)| serde_json::from_str(answer).expect("an answer"),
        )
    }
}
