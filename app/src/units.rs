//! Numbers and their units, as people read them.

use indicatif::HumanCount;
use textwrap::{Options, WordSplitter};

/// Writes an error with its unit: `1.5e-6 J`.
pub(crate) fn with_unit_behind(value: f64, unit: &str) -> String {
    format!("{} {unit}", magnitude(value)).trim_end().to_owned()
}

/// Joins a name and its unit: `energy, J`, or only the name of a pure number.
pub fn with_unit(name: &str, unit: &str) -> String {
    if unit.is_empty() { name.to_owned() } else { format!("{name}, {unit}") }
}

/// Writes a whole number for reading: `180,000`.
pub fn grouped(number: u64) -> String {
    HumanCount(number).to_string()
}

/// Writes a number with some digits behind the first, in full where that is short.
pub(crate) fn figures(value: f64, digits: usize) -> String {
    let exponent = value.abs().log10().floor();
    if value != 0.0 && !(-2.0..5.0).contains(&exponent) {
        return format!("{value:.digits$e}");
    }
    let behind = if value == 0.0 { 0.0 } else { (digits as f64 - exponent.max(-2.0)).clamp(0.0, 9.0) };
    let text = format!("{value:.*}", behind as usize);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// Finds the least and the greatest of some numbers: infinite ones where there are none.
pub(crate) fn range(numbers: impl IntoIterator<Item = f64>) -> (f64, f64) {
    let none = (f64::INFINITY, f64::NEG_INFINITY);
    numbers.into_iter().fold(none, |(low, high), x| (low.min(x), high.max(x)))
}

/// Breaks a text between words into lines of at most this width.
pub(crate) fn wrapped(text: &str, width: usize) -> Vec<String> {
    let options = Options::new(width).break_words(false).word_splitter(WordSplitter::NoHyphenation);
    if text.is_empty() {
        return Vec::new();
    }
    textwrap::wrap(text, options).into_iter().map(|line| line.into_owned()).collect()
}

/// Writes a text for a terminal, which obeys control characters: they are shown as what they are. Of a text without
/// end the beginning.
pub(crate) fn printable(text: &str) -> String {
    /// Longer than any message.
    const LONGEST: usize = 10_000;

    let mut shown = String::new();
    for (at, letter) in text.char_indices() {
        if at > LONGEST {
            shown += &format!("… ({} bytes)", text.len());
            break;
        }
        match letter {
            '\n' | '\t' => shown.push(letter),
            letter if letter.is_control() => shown.extend(letter.escape_unicode()),
            letter => shown.push(letter),
        }
    }
    shown
}

/// Writes six digits, without zeros at the end.
pub(crate) fn short(value: f64) -> String {
    figures(value, 5)
}

/// Writes six digits at most, as all of a number is written: `0.004`.
pub(crate) fn rounded(value: f64) -> String {
    exact(format!("{value:.5e}").parse().unwrap_or(value))
}

/// Writes numbers to three digits behind the point: `0.5,0.866`.
pub(crate) fn listed(numbers: &[f64]) -> String {
    // adding zero leaves no −0
    let rounded = |x: &f64| ((x * 1e3).round() / 1e3 + 0.0).to_string();
    numbers.iter().map(rounded).collect::<Vec<_>>().join(",")
}

/// Writes all digits: `0.01`, but `2e-9`.
pub(crate) fn exact(value: f64) -> String {
    // adding zero leaves no −0
    let (plain, power) = ((value + 0.0).to_string(), format!("{value:e}"));
    let is_usual = value == 0.0 || (1e-4..1e7).contains(&value.abs());
    if is_usual || plain.len() < power.len() { plain } else { power }
}

/// Writes two digits, which say how large an error is.
pub(crate) fn magnitude(value: f64) -> String {
    if value == 0.0 { "0".to_owned() } else { format!("{value:.1e}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_set_for_reading() {
        assert_eq!(grouped(0), "0");
        assert_eq!(grouped(999), "999");
        assert_eq!(grouped(180_000), "180,000");
        assert_eq!(grouped(1_234_567), "1,234,567");
        assert_eq!(magnitude(0.0), "0");
        for (number, text) in [
            (0.01, "0.01"),
            (2e-9, "2e-9"),
            (-0.0, "0"),
            (2.5e-6, "2.5e-6"),
            (1e6, "1000000"),
            (12_345_678.25, "12345678.25"),
            (3e9, "3e9"),
        ] {
            assert_eq!(exact(number), text);
        }
        assert_eq!(magnitude(1.26e-14), "1.3e-14");
        for (number, text) in [
            (0.0, "0"),
            (1.555, "1.555"),
            (-12.5, "-12.5"),
            (0.012_345_67, "0.012346"),
            (98_765.432, "98765"),
            (-9.965_011e9, "-9.9650e9"),
            (1e-7, "1.0000e-7"),
        ] {
            assert_eq!(figures(number, 4), text);
        }
        assert_eq!(printable("a\n\u{1b}]0;title\u{7}\u{9b}"), "a\n\\u{1b}]0;title\\u{7}\\u{9b}");
        let long = printable(&"é".repeat(1_000_000));
        assert!(long.len() < 10_100 && long.ends_with("é… (2000000 bytes)"), "{}", long.len());
        assert_eq!([1.004 - 1.0, 60.0, 1.0 / 3.0, 1e-7].map(rounded), ["0.004", "60", "0.333333", "1e-7"]);
        assert_eq!(wrapped("one two three, four", 9), ["one two", "three,", "four"]);
        assert_eq!(wrapped("longer-than-that", 3), ["longer-than-that"]);
        assert_eq!(wrapped("", 3), [""; 0]);
        assert_eq!(with_unit("time", "s"), "time, s");
        assert_eq!(with_unit("|Γ|²", ""), "|Γ|²");
    }
}
