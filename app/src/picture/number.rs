//! Numbers as texts of pictures have them: with the sign for minus, and large and small ones by their power of ten.

/// `0.25`, but `2·10⁷`: large and small numbers by their power of ten.
pub fn short(value: f64) -> String {
    // ticks are round up to roundoff
    let (digits, exponent) = scientific(value, 9);
    let digits =
        if digits.contains('.') { digits.trim_end_matches('0').trim_end_matches('.') } else { &digits };
    if value == 0.0 {
        "0".to_owned()
    } else if (-3..5).contains(&exponent) {
        let places = digits.trim_start_matches('−').len().saturating_sub(2) as i32 - exponent;
        with_minus(&format!("{value:.*}", places.max(0) as usize))
    } else {
        let power = power_of_ten(f64::from(exponent));
        match digits.strip_suffix('1') {
            Some(sign @ ("" | "−")) => format!("{sign}{power}"),
            _ => format!("{digits}·{power}"),
        }
    }
}

/// Two digits of a magnitude: `3.1·10⁻⁹`; between 0.01 and 1000 without a power of ten.
pub fn two_digits(value: f64) -> String {
    let (digits, exponent) = scientific(value, 1);
    if value == 0.0 {
        "0".to_owned()
    } else if (-2..3).contains(&exponent) {
        with_minus(&format!("{value:.*}", (1 - exponent).max(0) as usize))
    } else {
        format!("{digits}·{}", power_of_ten(f64::from(exponent)))
    }
}

/// Splits a number into its digits, with so many behind the point, and its power of ten.
fn scientific(value: f64, places: usize) -> (String, i32) {
    let text = format!("{value:.places$e}");
    let (digits, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    (with_minus(digits), exponent.parse().unwrap_or(0))
}

/// `10⁻¹²` for −12.
pub fn power_of_ten(exponent: f64) -> String {
    let digits = format!("{exponent:.0}").chars().map(superscript).collect::<String>();
    format!("10{digits}")
}

/// The sign in the place of the hyphen.
pub fn with_minus(number: &str) -> String {
    number.replace('-', "−")
}

fn superscript(digit: char) -> char {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    match digit.to_digit(10) {
        Some(value) => DIGITS[value as usize],
        None => '⁻',
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_of_ten() {
        assert_eq!(power_of_ten(-12.0), "10⁻¹²");
        assert_eq!(power_of_ten(0.0), "10⁰");
        assert_eq!(power_of_ten(305.0), "10³⁰⁵");
    }

    #[test]
    fn ticks_are_short() {
        for (value, text) in [
            (0.0, "0"),
            (0.25, "0.25"),
            (0.1 + 0.2, "0.3"),
            (-10.0, "−10"),
            (2_000.0, "2000"),
            (0.005, "0.005"),
            (1.25, "1.25"),
            (-2e7, "−2·10⁷"),
            (1e7, "10⁷"),
            (-1e7, "−10⁷"),
            (2.5e-4, "2.5·10⁻⁴"),
        ] {
            assert_eq!(short(value), text);
        }
    }

    #[test]
    fn numbers_of_captions_have_two_digits() {
        for (value, text) in [
            (3.14e-9, "3.1·10⁻⁹"),
            (-2.5e5, "−2.5·10⁵"),
            (0.0, "0"),
            (0.1748, "0.17"),
            (0.0123, "0.012"),
            (5.678, "5.7"),
            (-56.78, "−57"),
            (567.8, "568"),
        ] {
            assert_eq!(two_digits(value), text);
        }
    }
}
