//! Numbers and their units, as people read them.

use std::fmt;

/// `1.5e-6 J`
pub(crate) fn with_unit_behind(value: f64, unit: &str) -> String {
    format!("{} {unit}", magnitude(value)).trim_end().to_owned()
}

/// `energy, J`, or only the name of a pure number.
pub fn with_unit(name: &str, unit: &str) -> String {
    if unit.is_empty() { name.to_owned() } else { format!("{name}, {unit}") }
}

/// `180 000`
pub fn grouped(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

/// `4.5 M`, `320 k`, `17`: so many a second.
pub(crate) fn rate_in_words(rate: f64) -> String {
    match rate {
        rate if rate >= 1e9 => format!("{:.1} G", rate / 1e9),
        rate if rate >= 1e6 => format!("{:.1} M", rate / 1e6),
        rate if rate >= 1e4 => format!("{:.0} k", rate / 1e3),
        rate if rate >= 10.0 => format!("{rate:.0}"),
        rate => format!("{rate:.1}"),
    }
}

/// `12 s`, `3 min`, `5.1 h`, `80 days`, `3.2 years`
pub(crate) fn seconds_in_words(seconds: f64) -> String {
    const UNITS: [(f64, &str); 4] =
        [(60.0, "min"), (3600.0, "h"), (86_400.0, "days"), (365.25 * 86_400.0, "years")];
    let unit = UNITS.iter().rev().find(|(unit, _)| seconds >= 1.5 * unit);
    let (value, unit) = unit.map_or((seconds, "s"), |(length, unit)| (seconds / length, *unit));
    match value {
        value if value >= 1e7 => format!("{value:.1e} {unit}"),
        value if value >= 10.0 || unit == "s" => format!("{} {unit}", grouped(value.round() as u64)),
        value => format!("{value:.1} {unit}"),
    }
}

/// A number with so many digits behind the first, written out where that is short.
pub(crate) struct Figures(pub(crate) f64);

impl fmt::Display for Figures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let digits = f.precision().unwrap_or(2);
        let exponent = self.0.abs().log10().floor();
        if self.0 == 0.0 || (-2.0..5.0).contains(&exponent) {
            let behind = (digits as f64 - exponent.max(-2.0)).clamp(0.0, 9.0);
            let text = format!("{:.*}", if self.0 == 0.0 { 0 } else { behind as usize }, self.0);
            let short =
                if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
            f.write_str(short)
        } else {
            write!(f, "{:.digits$e}", self.0)
        }
    }
}

/// A text in lines of at most so many letters, broken between words.
pub(crate) fn wrapped(text: &str, width: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// Six digits, without zeros at the end.
pub(crate) fn short(value: f64) -> String {
    format!("{:.5}", Figures(value))
}

/// All digits: `0.01`, but `2e-9`.
pub(crate) fn exact(value: f64) -> String {
    // adding zero leaves no −0
    let (plain, power) = ((value + 0.0).to_string(), format!("{value:e}"));
    let is_usual = value == 0.0 || (1e-4..1e7).contains(&value.abs());
    if is_usual || plain.len() < power.len() { plain } else { power }
}

/// Two digits say how large an error is.
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
        assert_eq!(grouped(180_000), "180 000");
        assert_eq!(grouped(1_234_567), "1 234 567");
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
            assert_eq!(format!("{:.4}", Figures(number)), text);
        }
        for (seconds, text) in [
            (0.2, "0 s"),
            (80.0, "80 s"),
            (100.0, "1.7 min"),
            (3000.0, "50 min"),
            (18_000.0, "5.0 h"),
            (7e6, "81 days"),
            (1e8, "3.2 years"),
            (1e13, "316 881 years"),
        ] {
            assert_eq!(seconds_in_words(seconds), text);
        }
        for (rate, text) in [(4_500_768.1, "4.5 M"), (320_400.0, "320 k"), (17.2, "17"), (0.25, "0.2")] {
            assert_eq!(rate_in_words(rate), text);
        }
        assert_eq!(wrapped("one two three, four", 9), ["one two", "three,", "four"]);
        assert_eq!(wrapped("longer-than-that", 3), ["longer-than-that"]);
        assert_eq!(wrapped("", 3), [""; 0]);
        assert_eq!(with_unit("time", "s"), "time, s");
        assert_eq!(with_unit("|Γ|²", ""), "|Γ|²");
    }
}
