//! Captions: words, what was given, and what is measured, which comes from the figure's [`Data`](super::Data) alone.

use std::fmt;

use coadjoint_app::picture::{two_digits, with_minus};

/// The paragraphs below a figure.
pub(crate) type Caption = Vec<Paragraph>;

/// One of them.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Paragraph(pub(crate) Vec<Piece>);

/// A part of a paragraph.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Piece {
    /// Words, without a number.
    Words(&'static str),
    /// What was given: parameters, steps, names of methods and of equations.
    Given(String),
    /// What comes from the figure's data.
    Measured(String),
}

impl From<&'static str> for Piece {
    fn from(words: &'static str) -> Self {
        Piece::Words(words)
    }
}

/// A number or a name that the runs are made with.
pub(crate) fn given(what: impl fmt::Display) -> Piece {
    Piece::Given(what.to_string())
}

/// A measured magnitude, with two digits.
pub(crate) fn measured(value: f64) -> Piece {
    Piece::Measured(two_digits(value))
}

/// A measured number, with so many digits behind the point.
pub(crate) fn with_places(value: f64, places: usize) -> Piece {
    Piece::Measured(with_minus(&format!("{value:.places$}")))
}

/// What is said of measured numbers: which is larger, and whether they grow.
pub(crate) fn verdict(words: impl Into<String>) -> Piece {
    Piece::Measured(words.into())
}

impl fmt::Display for Paragraph {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|piece| match piece {
            Piece::Words(words) => f.write_str(words),
            Piece::Given(text) | Piece::Measured(text) => f.write_str(text),
        })
    }
}

/// Pieces one after the other.
macro_rules! paragraph {
    ($($piece:expr),* $(,)?) => {
        $crate::figures::caption::Paragraph(vec![$($crate::figures::caption::Piece::from($piece)),*])
    };
}
pub(crate) use paragraph;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_make_a_text() {
        let text =
            paragraph!["From h = ", given(0.1), " on, ", measured(-3.14e-9), "; ", with_places(-2.0, 1)];
        assert_eq!(text.to_string(), "From h = 0.1 on, −3.1·10⁻⁹; −2.0");
    }
}
