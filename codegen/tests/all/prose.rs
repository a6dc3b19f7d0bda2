//! What the front page and the other pages of the repository are held to: short sentences, few words, links that lead somewhere.

use std::fs;
use std::path::{Path, PathBuf};

/// Words of the front page, code and tables included.
const MOST_WORDS: usize = 1_200;
/// Words of a sentence.
const LONGEST_SENTENCE: usize = 30;

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The pages beside the sources, and those of the guide but for the one that is generated.
fn pages() -> Vec<PathBuf> {
    let named = ["README.md", "BENCHMARKS.md", "CONTRIBUTING.md", "CHANGELOG.md", "docs/registry.md"]
        .map(|name| root().join(name));
    let guide = fs::read_dir(root().join("runtime/src/guide")).expect("the guide is beside the generator");
    let mut pages: Vec<_> = guide.map(|page| page.expect("a file").path()).collect();
    pages.retain(|page| !page.ends_with("language.md"));
    pages.extend(named);
    pages.sort();
    pages
}

fn text(page: &Path) -> String {
    fs::read_to_string(page).expect("text")
}

/// The text between blocks of code.
fn outside_of_code(text: &str) -> impl Iterator<Item = &str> {
    let mut is_code = false;
    text.lines().filter(move |line| {
        let fence = line.trim_start().starts_with("```");
        is_code ^= fence;
        !is_code && !fence
    })
}

/// Paragraphs, items of lists and cells of tables, each in one line.
fn blocks(text: &str) -> Vec<String> {
    let mut blocks = vec![String::new()];
    for line in outside_of_code(text) {
        let line = line.trim();
        if let Some(row) = line.strip_prefix('|') {
            blocks.extend(row.split(" | ").map(str::to_owned));
            blocks.push(String::new());
            continue;
        }
        let numbered = line.split_once(". ").is_some_and(|(number, _)| number.parse::<u32>().is_ok());
        if line.is_empty() || numbered || ["#", "* ", "- ", "<"].iter().any(|mark| line.starts_with(mark)) {
            blocks.push(String::new());
        }
        if let Some(block) = blocks.last_mut() {
            block.push(' ');
            block.push_str(line);
        }
        if line.starts_with('#') || line.ends_with(':') {
            blocks.push(String::new());
        }
    }
    blocks
}

/// The sentences of a block: what lies between full stops, question and exclamation marks. What a link leads to is no word of them.
fn sentences(block: &str) -> Vec<Vec<&str>> {
    let mut sentences = vec![Vec::new()];
    for word in block.split_whitespace() {
        let word = word.split_once("](").map_or(word, |(shown, _)| shown);
        // marks and operators are no words
        if word.chars().any(char::is_alphanumeric) {
            sentences.last_mut().expect("there is one").push(word);
        }
        if word.trim_end_matches(['*', ')', '`', '_', ']']).ends_with(['.', '?', '!']) {
            sentences.push(Vec::new());
        }
    }
    sentences
}

#[test]
fn sentences_are_short() {
    let mut long = Vec::new();
    for page in pages() {
        for block in blocks(&text(&page)) {
            for sentence in sentences(&block).iter().filter(|sentence| sentence.len() > LONGEST_SENTENCE) {
                let name = page.file_name().unwrap_or_default().display().to_string();
                long.push(format!("{name}, {} words: {}", sentence.len(), sentence.join(" ")));
            }
        }
    }
    assert!(long.is_empty(), "\n{}", long.join("\n"));
}

#[test]
fn the_front_page_is_short() {
    let words = text(&root().join("README.md")).split_whitespace().count();
    assert!(words <= MOST_WORDS, "{words} words");
}

#[test]
fn links_lead_to_files() {
    let mut broken = Vec::new();
    for name in ["README.md", "BENCHMARKS.md", "CONTRIBUTING.md", "CHANGELOG.md"] {
        let page = text(&root().join(name));
        let page = outside_of_code(&page).collect::<Vec<_>>().join("\n");
        let targets = |before: &str, after: char| -> Vec<String> {
            page.split(before).skip(1).filter_map(|rest| Some(rest.split_once(after)?.0.to_owned())).collect()
        };
        let all = [targets("](", ')'), targets("src=\"", '"')].concat();
        assert!(name != "README.md" || all.len() > 10, "README has links: {all:?}");
        for target in all.iter().filter(|target| !target.starts_with("http")) {
            let (path, heading) = target.split_once('#').unwrap_or((target, ""));
            let file = root().join(if path.is_empty() { name } else { path });
            let has_heading = || {
                let slug = |line: &str| line.trim_start_matches(['#', ' ']).to_lowercase().replace(' ', "-");
                text(&file).lines().any(|line| line.starts_with('#') && slug(line) == heading)
            };
            if !file.exists() || !heading.is_empty() && !has_heading() {
                broken.push(format!("{name}: {target}"));
            }
        }
    }
    assert!(broken.is_empty(), "{broken:?}");
}
