//! Constants: exact while they fit, rounded once beyond.

use std::collections::HashSet;

use coadjoint_codegen::expr::Number;

const LARGEST: i128 = 1 << 53;

fn ratio(numerator: i128, denominator: i128) -> Number {
    Number::ratio(numerator, denominator)
}

fn parsed(text: &str) -> Number {
    Number::parse(text).unwrap_or_else(|| panic!("{text}"))
}

#[test]
fn literals_are_exact_if_they_fit() {
    for (text, numerator, denominator) in [
        ("0", 0, 1),
        ("12", 12, 1),
        ("1_000.5", 2001, 2),
        ("0.1", 1, 10),
        ("1e-3", 1, 1000),
        ("2.5E3", 2500, 1),
        ("0.125e1", 5, 4),
        ("9007199254740992", LARGEST, 1),
    ] {
        assert_eq!(parsed(text).fraction(), Some((numerator, denominator)), "{text}");
    }
    // what does not fit is the double that Rust makes of it
    for text in ["3.141592653589793238", "1e-17", "1.7976931348623157e308", "9007199254740993.5", "5e-324"] {
        let number = parsed(text);
        assert_eq!((number.fraction(), number.to_f64()), (None, text.parse().expect("a number")), "{text}");
    }
    assert!(!parsed("1e400").is_finite() && parsed("1e300").is_finite() && parsed("7").is_finite());
    for text in ["", "x", "1e", "1e99999999999", "0x10"] {
        assert!(Number::parse(text).is_none(), "{text}");
    }
}

#[test]
fn arithmetic_is_exact_until_it_has_to_be_rounded() {
    let third = ratio(1, 3);
    assert_eq!((third + third + third).fraction(), Some((1, 1)));
    assert_eq!((ratio(2, 3) * ratio(3, 4)).fraction(), Some((1, 2)));
    assert_eq!((-third).fraction(), Some((-1, 3)));
    assert_eq!((third + -third).fraction(), Some((0, 1)));
    assert_eq!(ratio(6, -4).fraction(), Some((-3, 2)));
    // one more than the largest numerator or denominator
    assert_eq!(ratio(LARGEST, 1).fraction(), Some((LARGEST, 1)));
    assert_eq!(ratio(LARGEST + 2, 1).fraction(), None);
    assert_eq!(ratio(1, LARGEST + 2).fraction(), None);
    let large = ratio(LARGEST, 1);
    assert_eq!((large + large).to_f64(), 2.0 * LARGEST as f64);
    assert_eq!((large + large).fraction(), None);
    // a numerator that is too large; what it is rounded to is whole
    assert_eq!((large * ratio(1, 2) + ratio(1, 2)).fraction(), Some((LARGEST / 2, 1)));
    assert_eq!((ratio(1, 3) * ratio(1, LARGEST)).to_f64(), 1.0 / 3.0 / LARGEST as f64);
    // rounded ones stay rounded, but for those that come out whole
    let tenth = parsed("0.1000000000000000055511151231257827");
    assert_eq!((tenth + third).to_f64(), 0.1 + 1.0 / 3.0);
    assert_eq!((tenth * third).to_f64(), 0.1 * (1.0 / 3.0));
    assert_eq!((tenth + tenth * Number::MINUS_ONE).fraction(), Some((0, 1)));
    assert_eq!((-tenth).to_f64(), -0.1);
    assert_eq!((Number::FOUR_PI_SQUARED.to_f64() / 39.478_417_604_357_43 - 1.0).abs(), 0.0);
}

#[test]
fn signs_and_magnitudes() {
    let negative = parsed("3.141592653589793238") * Number::MINUS_ONE;
    for (number, is_negative) in [
        (ratio(-1, 3), true),
        (ratio(1, 3), false),
        (Number::ZERO, false),
        (negative, true),
        (-negative, false),
        (Number::FOUR_PI_SQUARED, false),
    ] {
        assert_eq!(number.is_negative(), is_negative, "{number}");
        assert!(!number.abs().is_negative(), "{number}");
        assert_eq!(number.abs().to_f64(), number.to_f64().abs(), "{number}");
        assert_eq!(number.is_zero(), number == Number::ZERO, "{number}");
        assert_eq!(number.is_one(), number.to_f64() == 1.0, "{number}");
    }
    assert!(Number::ONE.is_one() && !Number::MINUS_ONE.is_one());
    assert!(ratio(1, 3) < ratio(1, 2) && negative < Number::ZERO && Number::FOUR_PI_SQUARED > ratio(39, 1));
}

#[test]
fn powers_and_roots() {
    assert_eq!(ratio(-2, 3).powi(3).fraction(), Some((-8, 27)));
    assert_eq!(ratio(-2, 3).powi(-2).fraction(), Some((9, 4)));
    assert_eq!(ratio(2, 3).powi(0).fraction(), Some((1, 1)));
    assert_eq!(Number::ZERO.powi(2).fraction(), Some((0, 1)));
    assert!(!Number::ZERO.powi(-1).is_finite());
    let large = ratio(3, 1).powi(200);
    assert!(large.fraction().is_none() && (large.to_f64() / 2.656_139_888_758_747_7e95 - 1.0).abs() < 1e-14);
    assert_eq!(Number::FOUR_PI_SQUARED.powi(2).to_f64(), Number::FOUR_PI_SQUARED.to_f64().powi(2));
    assert_eq!(ratio(9, 16).exact_sqrt().and_then(Number::fraction), Some((3, 4)));
    assert_eq!(Number::ZERO.exact_sqrt().and_then(Number::fraction), Some((0, 1)));
    for number in [ratio(2, 1), ratio(9, 2), ratio(-4, 1), ratio(LARGEST - 1, 1), Number::FOUR_PI_SQUARED] {
        assert_eq!(number.exact_sqrt(), None, "{number}");
    }
}

#[test]
fn numbers_that_are_equal_are_the_same() {
    assert_eq!(ratio(2, 4), ratio(1, 2));
    assert_ne!(ratio(1, 3), ratio(2, 3));
    assert_ne!(ratio(1, 3), ratio(1, 4));
    // a rounded third is not a third, and not-a-number is itself
    let (rounded, nothing) = (parsed("0.333333333333333333333333333333333333333"), parsed("1e400"));
    assert_ne!(rounded, ratio(1, 3));
    let nothing = nothing + -nothing;
    assert!(nothing.to_f64().is_nan() && nothing == nothing);
    let all = [ratio(2, 4), ratio(1, 2), ratio(1, 3), rounded, rounded, nothing, nothing];
    assert_eq!(all.into_iter().collect::<HashSet<_>>().len(), 4);
}

#[test]
fn numbers_read_as_they_are_written() {
    for (number, text) in [
        (ratio(-1, 2), "-1/2"),
        (ratio(7, 1), "7"),
        (Number::FOUR_PI_SQUARED, "4π²"),
        (parsed("1e-17"), "1e-17"),
        (parsed("3.141592653589793238"), "3.141592653589793"),
    ] {
        assert_eq!(number.to_string(), text);
    }
}

/// What multiplies without rounding: 2, 4, 8, …, and 1/2, 1/4, 1/8, …
#[test]
fn powers_of_two_scale_exactly() {
    for (numerator, denominator, is_power) in [
        (2, 1, true),
        (8, 1, true),
        (1, 4, true),
        (1, 1, false),
        (0, 1, false),
        (-2, 1, false),
        (3, 1, false),
        (6, 1, false),
        (3, 4, false),
        (2, 3, false),
    ] {
        assert_eq!(ratio(numerator, denominator).scales_exactly(), is_power, "{numerator}/{denominator}");
    }
    assert!(!parsed("1e-17").scales_exactly());
}
