//! Where files of each format carry what made them, and how it is found there again.
//!
//! | format | where |
//! |---|---|
//! | CSV, text | comments before the header, `# coadjoint 0.1.0` and `# run: {…}`; last `# interrupted: 17 of 1000 steps` |
//! | JSON | its first fields; last `"interrupted": 17` |
//! | Parquet | keys of the file's metadata |
//! | SVG | `<metadata id="coadjoint-run">` |
//! | HTML | `<script id="coadjoint-run" type="application/json">` |
//! | PNG | a text chunk, `iTXt`, named `coadjoint` |

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;

use serde_json::{Map, Value};

use super::{Origin, PROGRAM};

/// What a file begins with is searched up to here.
const HEAD: u64 = 1 << 20;
/// The end of a file in which it says that it was interrupted.
const TAIL: u64 = 200;
/// What the data begin with behind the fields of a JSON object that say what made it.
const DATA: [&str; 2] = [",\n  \"columns\":", ",\n  \"processor\":"];
/// The key of a Parquet file's metadata under which stands what the run found of the invariants.
#[cfg(feature = "parquet")]
pub(crate) const INVARIANTS: &str = "invariants";
/// Names the element of a picture or page.
const ID: &str = "id=\"coadjoint-run\"";
/// What a chunk of a PNG begins with: its name, and that what follows is not compressed and in no language in particular.
const CHUNK: &[u8] = b"coadjoint\0\0\0\0\0";
/// A PNG's signature and its first chunk, which must stay the first.
const PNG: (&[u8], usize) = (b"\x89PNG\r\n\x1a\n", 33);

/// The comments at the top of a table.
pub(crate) fn comment(origin: &Origin) -> String {
    format!("# {PROGRAM} {}\n# run: {}\n", env!("CARGO_PKG_VERSION"), origin.line())
}

/// The comment at the end of a table of an interrupted run.
pub(crate) fn interruption(steps: u64, of: u64) -> String {
    format!("# interrupted: {steps} of {of} steps\n")
}

/// The content of a file with what made it, in the way of files with this extension: pictures (`svg`, `png`), pages (`html`), and texts and
/// tables, which take comments.
pub fn embed(extension: &str, content: Vec<u8>, origin: &Origin) -> Vec<u8> {
    match extension {
        "png" => in_png(&content, origin),
        "svg" => in_markup(&content, "metadata", b"<svg", origin),
        "html" | "htm" => in_markup(&content, "script", b"<meta charset", origin),
        _ => [comment(origin).into_bytes(), content].concat(),
    }
}

/// A page or a picture with one more element of this name, behind the first tag that begins like this.
fn in_markup(markup: &[u8], element: &str, behind: &[u8], origin: &Origin) -> Vec<u8> {
    // in a text of JSON only, so that no tag begins or ends in it
    let mut json = origin.line();
    for (character, escaped) in [('<', "\\u003c"), ('>', "\\u003e"), ('&', "\\u0026")] {
        json = json.replace(character, escaped);
    }
    let kind = if element == "script" { " type=\"application/json\"" } else { "" };
    let insert = format!("<{element} {ID}{kind}>{json}</{element}>\n");
    let tag = markup.windows(behind.len()).position(|window| window == behind).unwrap_or(0);
    let end = markup[tag..].iter().position(|&byte| byte == b'>').map_or(0, |length| tag + length + 1);
    [&markup[..end], insert.as_bytes(), &markup[end..]].concat()
}

/// A PNG with one more chunk.
fn in_png(png: &[u8], origin: &Origin) -> Vec<u8> {
    let Some((first, rest)) = png.split_at_checked(PNG.1) else { return png.to_vec() };
    let data = [CHUNK, origin.line().as_bytes()].concat();
    let length = (data.len() as u32).to_be_bytes();
    let typed = [b"iTXt", &data[..]].concat();
    [first, &length, &typed, &crc32fast::hash(&typed).to_be_bytes(), rest].concat()
}

/// What made a file, if it says so; `None` of a file that is not the program's.
///
/// # Errors
/// If the file cannot be read.
pub(crate) fn read(path: &Path) -> io::Result<Option<Origin>> {
    let mut file = File::open(path)?;
    let mut head = Vec::new();
    Read::by_ref(&mut file).take(HEAD).read_to_end(&mut head)?;
    if head.starts_with(b"PAR1") {
        return Ok(fields_of_parquet(file).and_then(Origin::of_fields));
    }
    if head.starts_with(PNG.0) {
        return Ok(chunk(&head).and_then(of_json));
    }
    let text = String::from_utf8_lossy(&head);
    let found = if let Some(rest) = text.strip_prefix('#') {
        rest.lines().find_map(|line| line.strip_prefix("# run: ")).and_then(of_json)
    } else if let Some((fields, _)) = DATA.iter().find_map(|data| text.split_once(data)) {
        of_json(&format!("{fields}}}"))
    } else {
        let element = text.split_once(ID).and_then(|(_, rest)| rest.split_once('>'));
        element.and_then(|(_, rest)| rest.split_once("</")).and_then(|(json, _)| of_json(json))
    };
    let Some(found) = found else { return Ok(None) };
    let length = file.seek(SeekFrom::End(0))?;
    file.seek(SeekFrom::Start(length.saturating_sub(TAIL)))?;
    let mut tail = Vec::new();
    file.take(TAIL).read_to_end(&mut tail)?;
    let steps = found.interrupted().or_else(|| steps_at_the_end(&String::from_utf8_lossy(&tail)));
    Ok(Some(found.interrupted_after(steps)))
}

/// After how many steps a table or an object says that it was interrupted.
fn steps_at_the_end(tail: &str) -> Option<u64> {
    let line = tail.lines().rev().map(str::trim_start);
    let mut steps = line.filter_map(|line| {
        line.strip_prefix("# interrupted: ").or_else(|| line.strip_prefix("\"interrupted\": "))
    });
    let digits = steps.next()?;
    digits.split(|letter: char| !letter.is_ascii_digit()).next()?.parse().ok()
}

fn of_json(json: &str) -> Option<Origin> {
    Origin::of_fields(serde_json::from_str(json).ok()?)
}

/// The text of the chunk of a PNG that is ours.
fn chunk(png: &[u8]) -> Option<&str> {
    let mut rest = png.strip_prefix(PNG.0)?;
    loop {
        let (length, after) = rest.split_first_chunk::<4>()?;
        let (data, after) = after.split_at_checked((u32::from_be_bytes(*length) as usize).checked_add(4)?)?;
        if let Some(text) = data.strip_prefix(b"iTXt").and_then(|data| data.strip_prefix(CHUNK)) {
            return std::str::from_utf8(text).ok();
        }
        rest = after.get(4..)?;
    }
}

#[cfg(feature = "parquet")]
fn fields_of_parquet(file: File) -> Option<Map<String, Value>> {
    use parquet::file::reader::{FileReader, SerializedFileReader};
    let reader = SerializedFileReader::new(file).ok()?;
    let pairs = reader.metadata().file_metadata().key_value_metadata()?;
    let parsed = pairs.iter().filter_map(|pair| {
        let value = serde_json::from_str(pair.value.as_deref()?).ok()?;
        // what the run found says nothing of what made it
        (pair.key != INVARIANTS).then(|| (pair.key.clone(), value))
    });
    Some(parsed.collect())
}

#[cfg(not(feature = "parquet"))]
fn fields_of_parquet(_: File) -> Option<Map<String, Value>> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::provenance::Provenance;
    use crate::simulation::{Job, Method, Order, Retraction};
    use crate::test_systems::catalogue;

    fn provenance() -> Provenance {
        let entry = catalogue().system("heavy_top").expect("it is there");
        let (retraction, order) = (Retraction::Cayley, Order::Four);
        let job = Job { method: Method::Midpoint, retraction, order, step: 0.1 + 0.2, steps: 9 };
        let mut setup = entry.example.clone();
        setup.parameters[3] = 9.806_650_000_000_001;
        setup.state[4] = -0.0;
        let mut provenance = Provenance::of_run(entry, &setup, &job, 3);
        // as a stranger might have called it
        provenance.units.insert("</script> & -->".to_owned(), "kg m²".into());
        provenance
    }

    /// What a file of this content says.
    fn found(name: &str, content: &[u8]) -> Option<Origin> {
        let path = std::env::temp_dir().join(format!("coadjoint-{}-{name}", std::process::id()));
        std::fs::write(&path, content).expect("writable");
        let found = read(&path).expect("readable");
        let _ = std::fs::remove_file(path);
        found
    }

    #[test]
    fn what_is_put_in_is_found() {
        let provenance = provenance();
        let entry = catalogue().system("heavy_top").expect("it is there");
        let setup = provenance.setup(entry).expect("of this system");
        assert_eq!(
            (setup.parameters[3], setup.state[4].to_bits()),
            (9.806_650_000_000_001, (-0.0_f64).to_bits())
        );
        assert_eq!(provenance.job().expect("a job").step.to_bits(), (0.1_f64 + 0.2).to_bits());

        let origin = provenance.origin();
        assert_eq!(origin.run(), Some(provenance));
        let table = comment(&origin) + "time,x\n0,1\n";
        assert_eq!(found("table", table.as_bytes()), Some(origin.clone()));
        let interrupted = origin.interrupted_after(Some(4));
        assert_eq!(found("cut", (table + &interruption(4, 9)).as_bytes()), Some(interrupted.clone()));
        let picture = "<?xml version=\"1.0\"?>\n<svg width=\"1\"><g/></svg>";
        let page = "<!DOCTYPE html>\n<head>\n<meta charset=\"utf-8\">\n</head>";
        for (kind, markup) in [("svg", picture), ("html", page)] {
            let with = embed(kind, markup.into(), &interrupted);
            assert_eq!(found(kind, &with), Some(interrupted.clone()));
            let with = String::from_utf8(with).expect("UTF-8");
            assert_eq!(with.matches("</").count(), markup.matches("</").count() + 1, "{with}");
        }
        // a signature, a first chunk of 13 bytes, and the last one
        let png = [PNG.0, b"\0\0\0\x0dIHDR", &[0; 17], b"\0\0\0\0IEND\xae\x42\x60\x82"].concat();
        let with = embed("png", png, &interrupted);
        assert_eq!(found("png", &with), Some(interrupted));
        let added = &with[PNG.1..with.len() - 12];
        let (typed, sum) = added[4..].split_at(added.len() - 8);
        assert_eq!(sum, crc32fast::hash(typed).to_be_bytes());
        assert_eq!(added[..4], (typed.len() as u32 - 4).to_be_bytes());
    }

    #[test]
    fn what_a_command_made_says_so() {
        let origin = Origin::of_command("figures 6.2").with("note", "<b>".into());
        assert_eq!((origin.command(), origin.run()), (Some("figures 6.2"), None));
        let content = |kind: &str| embed(kind, b"<svg>\n<meta charset>\nwords\n".to_vec(), &origin);
        for kind in ["txt", "csv", "svg", "html"] {
            assert_eq!(found(kind, &content(kind)), Some(origin.clone()), "{kind}");
        }
        let object = format!("{},\n  \"processor\": \"\"\n}}", origin.line().trim_end_matches('}'));
        assert_eq!(found("object-of-a-command", object.as_bytes()), Some(origin.clone()));
        assert_eq!(origin.differences(&Origin::of_command("figures 6.1")), ["command", "note"]);
    }

    #[test]
    fn files_of_others_say_nothing() {
        let origin = provenance().origin();
        let strangers = origin.line().replace("\"program\":\"coadjoint\"", "\"program\":\"another\"");
        for (name, content) in [
            ("empty", &b""[..]),
            ("comment", b"# run: {}\n1,2\n"),
            ("stranger", format!("# run: {strangers}\n").as_bytes()),
            ("object", b"{\n  \"program\": \"coadjoint\",\n  \"columns\": []}"),
            ("parquet", b"PAR1 and no more"),
            ("png", &[PNG.0, &[0xff; 40]].concat()),
            ("short-png", PNG.0),
            ("markup", b"<p id=\"coadjoint-run\""),
            ("bytes", &[0x80; 100]),
        ] {
            assert_eq!(found(name, content), None, "{name}");
        }
        assert_eq!(embed("png", b"short".to_vec(), &origin), b"short");
    }
}
