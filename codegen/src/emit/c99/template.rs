//! Text with places to be filled: C, with words in capital letters for what differs from system to system.
//!
//! `S_` before a name stands for the system, `U_` for the same in capitals, `K_` for the kernel of a scheme. What stands between `//if word` and
//! `//end` is there where the word holds, or, after `//else`, where it does not; `//each word` repeats lines.

use std::collections::BTreeMap;

/// What fills the places.
#[derive(Clone, Default)]
pub(super) struct Words {
    words: BTreeMap<&'static str, String>,
    prefixes: BTreeMap<&'static str, String>,
    holds: Vec<&'static str>,
    lists: BTreeMap<&'static str, Vec<Words>>,
}

impl Words {
    /// With a word for a place.
    pub(super) fn with(mut self, place: &'static str, text: impl Into<String>) -> Self {
        self.words.insert(place, text.into());
        self
    }

    /// With what stands for the beginnings of names.
    pub(super) fn prefix(mut self, place: &'static str, text: impl Into<String>) -> Self {
        self.prefixes.insert(place, text.into());
        self
    }

    /// With a word that holds, or not.
    pub(super) fn holds(mut self, word: &'static str, holds: bool) -> Self {
        if holds {
            self.holds.push(word);
        }
        self
    }

    /// With lines for each of a list.
    pub(super) fn each(mut self, word: &'static str, list: Vec<Self>) -> Self {
        self.lists.insert(word, list);
        self
    }

    /// The text with all places filled.
    pub(super) fn fill(&self, template: &str) -> String {
        let lines: Vec<&str> = template.lines().collect();
        let mut filled = String::new();
        self.lines(&lines, &mut filled);
        filled
    }

    fn lines(&self, lines: &[&str], filled: &mut String) {
        let mut at = 0;
        while let Some(line) = lines.get(at) {
            let Some((command, word)) = line.trim().strip_prefix("//").and_then(|line| line.split_once(' '))
            else {
                filled.push_str(&self.line(line));
                filled.push('\n');
                at += 1;
                continue;
            };
            let (otherwise, end) = parts(&lines[at + 1..]);
            let (first, second) =
                (at + 1..at + 1 + otherwise, (at + 2 + otherwise).min(at + 1 + end)..at + 1 + end);
            match command {
                "each" => {
                    for words in self.lists.get(word).into_iter().flatten() {
                        let mut all = self.clone();
                        all.words.extend(words.words.clone());
                        all.prefixes.extend(words.prefixes.clone());
                        all.lists.extend(words.lists.clone());
                        all.holds.extend(&words.holds);
                        all.lines(&lines[first.clone()], filled);
                    }
                }
                _ => {
                    let holds = word.split('|').any(|word| self.holds.contains(&word.trim()));
                    self.lines(&lines[if holds { first } else { second }], filled);
                }
            }
            at += 2 + end;
        }
    }

    /// A line, name by name.
    fn line(&self, line: &str) -> String {
        let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let (mut filled, mut rest) = (String::new(), line);
        while let Some(start) = rest.find(is_part) {
            filled.push_str(&rest[..start]);
            let end = rest[start..].find(|c| !is_part(c)).map_or(rest.len(), |length| start + length);
            filled.push_str(&self.name(&rest[start..end]));
            rest = &rest[end..];
        }
        filled += rest;
        // where nothing fills a place of arguments
        let mut filled = filled.trim_end().to_owned();
        for (before, after) in [(" ,", ","), (" )", ")"), (" ;", ";")] {
            while let Some(at) = filled.trim_start().contains(before).then(|| filled.rfind(before)).flatten()
            {
                filled.replace_range(at..at + before.len(), after);
            }
        }
        filled
    }

    fn name(&self, name: &str) -> String {
        if let Some(word) = self.words.get(name) {
            return word.clone();
        }
        let prefixed =
            self.prefixes.iter().find_map(|(place, text)| Some((text.as_str(), name.strip_prefix(place)?)));
        let (prefix, rest) = prefixed.unwrap_or(("", name));
        let part = |part| self.words.get(part).map_or(part, String::as_str);
        let parts: Vec<&str> = rest.split('_').map(part).collect();
        format!("{prefix}{}", parts.join("_"))
    }
}

/// How many lines there are before `//else` and before `//end`, of what has begun before these.
fn parts(lines: &[&str]) -> (usize, usize) {
    let (mut depth, mut otherwise) = (0, None);
    for (at, line) in lines.iter().enumerate() {
        match line.trim() {
            "//end" if depth == 0 => return (otherwise.unwrap_or(at), at),
            "//else" if depth == 0 => otherwise = Some(at),
            "//end" => depth -= 1,
            line if line.starts_with("//if ") || line.starts_with("//each ") => depth += 1,
            _ => {}
        }
    }
    (lines.len(), lines.len())
}
