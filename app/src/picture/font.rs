//! The letters of pictures: a part of the font DejaVu Sans Condensed, whose licence stands beside it.
//!
//! Layout and pixels take it from here; a picture as SVG names it, and is drawn with what its reader has.

use std::sync::LazyLock;

#[cfg(feature = "png")]
use ttf_parser::OutlineBuilder;
use ttf_parser::{Face, GlyphId};
#[cfg(feature = "png")]
use zeno::{Command, PathBuilder, Transform};

/// The fonts that an SVG asks for.
pub(super) const FAMILIES: &str =
    "DejaVu Sans Condensed, DejaVu Sans, Segoe UI, Roboto, Helvetica, Arial, sans-serif";

static FACE: LazyLock<Option<Face<'static>>> =
    LazyLock::new(|| Face::parse(include_bytes!("font/dejavu-sans-condensed.ttf"), 0).ok());

/// How far a text of this size reaches.
pub(super) fn width(text: &str, size: f64) -> f64 {
    glyphs(text, size).map(|glyph| glyph.advance).sum()
}

struct Glyph {
    #[cfg_attr(not(feature = "png"), expect(dead_code))]
    id: GlyphId,
    advance: f64,
}

fn glyphs(text: &str, size: f64) -> impl Iterator<Item = Glyph> {
    let face = FACE.as_ref();
    text.chars().filter_map(move |letter| {
        let face = face?;
        // an empty box for a letter that the font does not have
        let id = face.glyph_index(letter).unwrap_or(GlyphId(0));
        let units = f64::from(face.glyph_hor_advance(id)?) / f64::from(face.units_per_em());
        Some(Glyph { id, advance: units * size })
    })
}

/// Draws the outlines of a text of this size, from its start to the right; up is negative.
#[cfg(feature = "png")]
pub(super) fn outline(text: &str, size: f64) -> Vec<Command> {
    let Some(face) = FACE.as_ref() else { return Vec::new() };
    let unit = (size / f64::from(face.units_per_em())) as f32;
    let (mut path, mut x) = (Vec::new(), 0.0);
    for Glyph { id, advance } in glyphs(text, size) {
        let mut letter = Letter(Vec::new());
        // a space has no outline
        let _ = face.outline_glyph(id, &mut letter);
        let place = Transform::scale(unit, -unit).then_translate(x as f32, 0.0);
        path.extend(letter.0.iter().map(|command| command.transform(&place)));
        x += advance;
    }
    path
}

/// The outline of a letter, in the font's units.
#[cfg(feature = "png")]
struct Letter(Vec<Command>);

#[cfg(feature = "png")]
impl OutlineBuilder for Letter {
    fn move_to(&mut self, x: f32, y: f32) {
        self.0.move_to([x, y]);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.0.line_to([x, y]);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.0.quad_to([x1, y1], [x, y]);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.0.curve_to([x1, y1], [x2, y2], [x, y]);
    }

    fn close(&mut self) {
        self.0.close();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_have_their_widths() {
        // digits below each other are aligned
        assert!((width("0", 2048.0) - width("8", 2048.0)).abs() < 1e-9);
        assert!(width("W", 10.0) > width("i", 10.0));
        assert!((width("Πω₀⁻¹²−·χ", 20.0) - 2.0 * width("Πω₀⁻¹²−·χ", 10.0)).abs() < 1e-9);
        assert_eq!(width("", 10.0), 0.0);
    }

    #[test]
    fn it_has_all_signs_of_pictures() {
        let face = FACE.as_ref().expect("it is a font");
        for sign in "0123456789 ABCxyz ⁰¹²³⁴⁵⁶⁷⁸⁹⁻₀₁₂₃₄₅₆₇₈₉−–·×°±≤√½|ΠΓΔΣΩΛδθφψωχτσℓµöéĐж′ᵀ".chars()
        {
            assert!(face.glyph_index(sign).is_some(), "{sign}");
        }
    }
}
